//! Page of a packing, made from its folder alone.

use std::path::Path;

use maud::{Markup, Render, html};

use super::figures::{Axis, BLUE, Dash, Figure, GREY, Mark, Shape, VERMILLION, ramp};
use super::files::{ReportError, json, rows};
use super::section::{Sections, Written};
use super::shell::{Drawn, citation, clean, fact};
use super::table::{Table, known};
use crate::outcome::packing::{CurveRow, Measure, PackingRecord, Summary};
use crate::outcome::paper;
use crate::outcome::table::Columns;
use voidwalk_practice::quantity::{duration, percent, significant, whole};

/// Number of shades by which a slice shows the sizes of its grains.
const SHADES: usize = 6;

/// Contents of a packing's folder, without the grains.
struct Packed {
    record: PackingRecord,
    summary: Summary,
    /// In ascending order.
    curve: Vec<CurveRow>,
}

/// Writes `report.html` and `figures/*.svg` into the folder of a packing. A missing or malformed file is an
/// error, and nothing is written then.
pub(crate) fn write_packing(folder: &Path) -> Result<Written, ReportError> {
    let packed = Packed {
        record: json(&folder.join("packing.json"))?,
        summary: json(&folder.join("constrictions.json"))?,
        curve: rows(&folder.join("constrictions.csv"))?.into_iter().map(|(_, row)| row).collect(),
    };
    page(&packed).write(folder, "report.html", &citation())
}

fn dc(summary: &Summary, percent: f64) -> Option<f64> {
    summary.dc_mm.get(&percent.to_string()).and_then(serde_json::Value::as_f64)
}

fn curves(packed: &Packed) -> Drawn {
    let gradation = &packed.record.gradation;
    let constrictions: Vec<(f64, f64)> =
        packed.curve.iter().map(|row| (row.diameter_mm, row.percent_smaller)).collect();
    let low = constrictions.first().map_or(0.1, |p| p.0);
    let high = gradation.last().map_or(1.0, |row| row[0]);
    let x = Axis::log("Diameter (mm)", low, high);
    let what = "Percent finer against size: the grains by mass, the constrictions by number";
    let mut figure =
        Figure::new("Gradation and constriction curve", what, x, Axis::percent("Percent finer (%)"));
    figure.add(Mark::rows(gradation, BLUE).width(2.5).label("grains, by mass"));
    figure.add(
        Mark::line(constrictions, VERMILLION)
            .width(2.5)
            .dash(Dash::Dashed)
            .label("constrictions,\nby number"),
    );
    for (rows, name) in
        packed.record.inscribed.iter().zip(["inscribed circles, dense", "inscribed circles, loose"])
    {
        figure.add(Mark::rows(rows, GREY).width(1.2).dash(Dash::Dotted).label(name));
    }
    for percent in [5.0, 50.0] {
        if let Some(d) = dc(&packed.summary, percent) {
            let label = format!("Dc{percent} = {} mm", significant(d));
            figure.add(Mark::point(d, percent, VERMILLION, Shape::Circle).label(&label));
        }
    }
    let caption = format!(
        "The filter’s gradation (percent finer by mass) and its constrictions (percent smaller by number). \
         Voids whose inscribed spheres overlap by at least {} of the smaller one’s radius count as one \
         void. Dotted: what circles inscribed between three (dense) and four (loose) touching grains would \
         give without a packing; the wider the gradation, the worse that guess.",
        significant(packed.summary.merge_overlap)
    );
    Drawn::new("curves", figure, caption)
}

/// Plane through the middle of the cell.
pub(super) fn slice(record: &PackingRecord) -> Drawn {
    let edge = record.cell_mm;
    let axis = |label| Axis::linear(label, 0.0, edge).within(0.0, edge);
    let what =
        "Grains cut by the plane through the middle of the periodic cell; the darker, the larger the grain";
    let mut figure = Figure::new("A slice through the packing", what, axis("x (mm)"), axis("y (mm)"))
        .sizes((720.0, 690.0), (358.0, 360.0))
        .square();
    let sizes = || record.gradation.iter().map(|row| row[0]);
    let (low, high) = (sizes().fold(f64::MAX, f64::min), sizes().fold(0.0, f64::max));
    for &[x, y, cut, grain] in &record.slice {
        let share = if high > low { libm::log(grain / low) / libm::log(high / low) } else { 0.5 };
        let shade = (share * SHADES as f64).clamp(0.0, SHADES as f64 - 1.0) as usize;
        figure.add(Mark::disc((x, y), cut, ramp(shade, SHADES)));
    }
    let caption = format!(
        "The plane z = {} mm through the middle of the periodic cell. A circle is the cut of a grain, not \
         its diameter; the darker, the larger the grain.",
        significant(0.5 * record.height_mm.unwrap_or(edge))
    );
    Drawn::new("slice", figure, caption)
}

/// Fraction of the voids by number of their constrictions.
fn connectivity(packed: &Packed) -> Drawn {
    let counts = &packed.summary.connectivity;
    let total = counts.iter().sum::<usize>().max(1) as f64;
    let share = |n: usize| 100.0 * n as f64 / total;
    let last = counts.iter().rposition(|&n| share(n) >= 0.05).unwrap_or(0);
    let highest = counts.iter().copied().map(share).fold(0.0, f64::max);
    let x = Axis::linear("Constrictions of a void (–)", 0.0, last as f64);
    let y = Axis::linear("Voids (%)", 0.0, highest);
    let what = "Percent of the voids against the number of their constrictions";
    let mut figure =
        Figure::new("Connectivity of the voids", what, x, y).sizes((720.0, 320.0), (358.0, 300.0));
    let points: Vec<(f64, f64)> =
        counts.iter().take(last + 1).enumerate().map(|(k, &n)| (k as f64, share(n))).collect();
    figure.add(Mark::line(points.clone(), GREY).width(1.0));
    for (k, percent) in points {
        figure.add(Mark::point(k, percent, BLUE, Shape::Circle));
    }
    let caption = format!(
        "Number of constrictions of a void; {} on average.",
        significant(packed.summary.mean_connectivity)
    );
    Drawn::new("connectivity", figure, caption)
}

fn page(packed: &Packed) -> Sections {
    let (record, summary) = (&packed.record, &packed.summary);
    let names = html! {
        b { bdi { (clean(&record.name)) } }
        ", friction " (significant(record.friction)) " during compression"
    };
    let at = |percent: f64| known(dc(summary, percent), |d| format!("{} mm", significant(d)));
    let lead = html! {
        p.lead {
            "Void ratio " b { (format!("{:.4}", record.after.void_ratio)) } ", "
            (whole(record.grains)) " grains, " (whole(summary.constrictions as u64)) " constrictions with Cu "
            b { (format!("{:.3}", summary.cu_csd)) } ", "
            b { (format!("{:.3}", summary.grains_per_void)) } " grains per void."
        }
    };
    let voids = html! {
        table.facts { tbody {
            (fact("Dc0, Dc5, Dc15", [0.0, 5.0, 15.0].map(at).join(", ")))
            (fact("Dc50, Dc75, Dc99", [50.0, 75.0, 99.0].map(at).join(", ")))
            (fact("Constrictions, tetrahedra",
                format!("{}, {}", whole(summary.constrictions as u64), whole(summary.tetrahedra as u64))))
            (fact("Voids", whole(summary.voids as u64)))
            (fact("Grains per void", significant(summary.grains_per_void)))
            (fact("Mean number of constrictions of a void", significant(summary.mean_connectivity)))
            (fact("Overlap from which tetrahedra are merged into one \
                   void", significant(summary.merge_overlap)))
        } }
    };
    let compression = html! {
        (states(record))
        table.facts { tbody {
            (fact("Mean pressure", format!("{} kPa", significant(record.pressure_kpa))))
            (fact("Edge of the periodic cell", format!("{} mm", significant(record.cell_mm))))
            @if let Some(height) = record.height_mm {
                (fact("Height of the cell", format!("{} mm", significant(height))))
            }
            (fact("Steps", whole(record.steps)))
            (fact("Simulated time", format!("{} s, with masses scaled so that small grains do not set the \
                                             step alone",
                significant(record.simulated_s))))
            (fact("Seed", record.seed.to_string()))
            (fact("Wall time", duration(record.seconds)))
            @for (name, value) in &record.settings { (fact(name, value.to_string())) }
        } }
        p.small { "Spheres, Hertz-Mindlin contacts with Coulomb friction, no gravity, no cohesion, no \
                   breakage." }
    };
    Sections::new(format!("Packing: {}", clean(&record.name)), "The packed filter", &names)
        .words(&lead)
        .figures([curves(packed), slice(record), connectivity(packed)])
        .section("Beside the paper’s Table 2", &beside_the_paper(packed))
        .section("Constrictions and voids", &voids)
        .section("Compression", &compression)
}

fn states(record: &PackingRecord) -> Markup {
    type Row = (&'static str, fn(&Measure) -> String);
    let rows: [Row; 8] = [
        ("Void ratio", |s| format!("{:.4}", s.void_ratio)),
        ("Pressure (kPa)", |s| format!("{:.3}", s.pressure_kpa)),
        ("Mean coordination number (2 N_c / N_p)", |s| format!("{:.3}", s.coordination)),
        ("Mean coordination number without loose grains", |s| format!("{:.3}", s.coordination_held)),
        ("Loose grains (carry no load), by number", |s| percent(s.rattlers).to_string()),
        ("Kinetic over elastic energy", |s| format!("{:.1e}", s.kinetic_ratio)),
        ("Unbalanced force over mean contact force", |s| format!("{:.1e}", s.unbalanced)),
        ("Largest overlap over smaller diameter", |s| format!("{:.1e}", s.largest_overlap)),
    ];
    let columns = Columns::default()
        .name("measure", "At rest with friction", |row: &Row| row.0)
        .number("before", significant(record.friction), |row| (row.1)(&record.before))
        .number("after", significant(record.final_friction), |row| (row.1)(&record.after));
    Table::new(&rows, columns).render()
}

/// The paper's values, if its Table 2 has this filter.
fn beside_the_paper(packed: &Packed) -> Markup {
    let record = &packed.record;
    let paper_filter = record.cu.filter(|_| record.linear).and_then(|cu| paper::filter(cu, record.friction));
    let Some(paper) = paper_filter else { return html! {} };
    let mut rows = vec![("Void ratio", record.after.void_ratio, paper.void_ratio)];
    if record.friction != record.final_friction {
        rows.push(("Void ratio before the final friction", record.before.void_ratio, paper.void_ratio));
    }
    rows.push(("Cu of the constrictions", packed.summary.cu_csd, paper.cu_csd));
    let columns = Columns::default()
        .name("measure", "", |row: &(&'static str, f64, f64)| row.0)
        .number("packing", "this packing", |row| format!("{:.3}", row.1))
        .number("paper", "paper", |row| format!("{:.3}", row.2))
        .number("difference", "difference", |row| format!("{:+.3}", row.1 - row.2));
    Table::new(&rows, columns).render()
}
