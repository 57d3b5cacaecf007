//! Gradations of soils: as one figure, as tables of numbers in an appendix, and for a specification; and the
//! files that were read.

use super::figures::{
    Axis, BLACK, BLUE, Dash, Figure, GREEN, GREY, Mark, ORANGE, PURPLE, VERMILLION, positive_range, shorten,
};
use super::names::{input_name, is_named, soil_name};
use super::shell::{Drawn, clean, fact};
use super::table::{SizedSoil, Table, of_few, of_many};
use crate::outcome::CurvePoint;
use crate::outcome::record::Outcome;
use crate::outcome::table::Columns;
use crate::words::grading;
use maud::{Markup, html};
use voidwalk_practice::InputFile;
use voidwalk_practice::design::Specification;
use voidwalk_practice::design::specification::SpecifiedCurve;
use voidwalk_practice::quantity::{SizeUnit, percent, significant};
use voidwalk_sheets::us_sieve;

/// SVG figure of percent finer by mass against size (mm), from the name and points of each soil; with coarse
/// sizes on the left if requested, as in the United States.
pub(crate) fn soils_figure<'a>(
    soils: impl IntoIterator<Item = (&'a str, &'a [CurvePoint])>,
    coarse_left: bool,
) -> String {
    let soils: Vec<(&str, &[CurvePoint])> = soils.into_iter().collect();
    let (low, high) =
        positive_range(soils.iter().flat_map(|(_, points)| points.iter().map(|point| point.size)));
    // A single size still gets a range.
    let high = if high > low { high } else { 2.0 * low };
    let names: Vec<String> = soils.iter().map(|(name, _)| shorten(name, 40)).collect();
    let what = format!("Percent finer by mass against size for {}", names.join(", "));
    let (x, y) = (Axis::log("Size (mm)", low, high), Axis::percent("Percent finer by mass (%)"));
    let x = if coarse_left { x.downward() } else { x };
    let mut figure = Figure::new("Sieve curves", &what, x, y).sieves();
    let colours = [BLACK, VERMILLION, BLUE, GREEN, PURPLE, ORANGE, GREY];
    let dashes = [Dash::Solid, Dash::Dashed];
    for (index, ((_, points), name)) in soils.iter().zip(&names).enumerate() {
        let dash = dashes[index / colours.len() % dashes.len()];
        let points = points.iter().map(|point| (point.size, point.percent)).collect();
        let line = Mark::line(points, colours[index % colours.len()]);
        figure.add(line.dash(dash).label(name));
    }
    figure.file()
}

/// Maximum number of rows shown of each gradation; all are in the record.
const ROWS: usize = 200;

/// Gradation: its kind, such as `Filter`, its name, and its rows of size and percent finer by mass.
struct TabledSoil<'a> {
    kind: &'a str,
    /// Name, which may only repeat the kind.
    name: &'a str,
    rows: &'a [[f64; 2]],
}

/// Filter and base as the walk read them: the values to type in for a check.
pub(super) fn of_run(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let inputs = &outcome.inputs;
    let (filter, base) = (&inputs.filter, &inputs.base);
    let sampled = base.as_sampled.as_ref();
    let mut soils = vec![TabledSoil { kind: "Filter", name: &filter.name, rows: &filter.gradation }];
    let name = if is_named("base", &base.name) { base.name.as_str() } else { "" };
    if let Some(sampled) = sampled {
        soils.push(TabledSoil { kind: "Base, as sampled", name, rows: &sampled.gradation });
    }
    let kind = sampled.map_or("Base".into(), |_| format!("Base, {}", grading(&base.size())));
    soils.push(TabledSoil { kind: &kind, name, rows: &base.gradation });
    let note = html! {
        p.small {
            "Percent finer by mass, as walked and as the rules read them"
            @if sampled.is_some() { ", and of the base as it was sampled: permeability is judged by that" }
            "; " (BETWEEN) " Files that they were \
             read from are kept in the folder " code { "inputs" } " of this run."
        }
    };
    let gradations = gradations(&soils, unit, "outcome.json");
    html! { section.appendix { h2 { "Appendix: the two gradations" } (note) (gradations) } }
}

const BETWEEN: &str = "between two rows straight lines on semi-logarithmic paper.";

/// Gradations side by side; the record holds all of their rows.
fn gradations(soils: &[TabledSoil], unit: SizeUnit, record: &str) -> Markup {
    html! { div.gradations { @for soil in soils { (gradation(soil, unit, record)) } } }
}

/// Every file that was read, as rows of a table of facts.
pub(super) fn input_files(files: &[InputFile]) -> Markup {
    html! { @for file in files {
        (fact("Input file", format!("{} (XXH3 {})", input_name(&file.name), file.xxh3)))
    } }
}

fn gradation(soil: &TabledSoil, unit: SizeUnit, record: &str) -> Markup {
    let TabledSoil { kind, name, rows } = soil;
    let finest = rows.iter().map(|row| row[1]).fold(100.0, f64::min);
    // Coarsest first, as in laboratory reports.
    let shown: Vec<&[f64; 2]> = rows.iter().rev().take(ROWS).collect();
    let mut columns = Columns::default();
    if unit == SizeUnit::MmAndInches {
        columns = columns.name("us_sieve", "US sieve", |row: &[f64; 2]| us_sieve(row[0]).unwrap_or_default());
    }
    let heading = format!("Size ({})", unit.short());
    let percent_finer = |row: &[f64; 2]| significant((row[1] * 100.0).round() / 100.0).in_digits(4);
    let columns = columns.number("size", heading, |row| significant(row[0]).in_digits(4));
    let columns = columns.number("percent_finer", "Percent finer", percent_finer);
    html! {
        div {
            h3 { (kind) @if is_named(kind, name) { ": " bdi { (clean(soil_name(name))) } } }
            (Table::new(shown, columns))
            @if finest > 0.0 {
                p.small {
                    (percent(finest / 100.0)) " are finer than the finest size; how fine is not known."
                }
            }
            @if rows.len() > ROWS { p.small { "The rest is in " (record) "." } }
        }
    }
}

const RECORD: &str = "specification.json";

/// Maximum number of curves of a base drawn with all their rows.
const CURVES: usize = 12;

pub(super) fn curves_heading(design: &Specification) -> &'static str {
    match design.curves.len() {
        1 => "Appendix: the gradation of the base",
        _ => "Appendix: the gradations",
    }
}

/// Sizes and gradations of every known soil; empty without one.
pub(super) fn curves_appendix(design: &Specification) -> Markup {
    let (curves, unit) = (&design.curves, SizeUnit::of(false, design.inches));
    if curves.is_empty() {
        return html! {};
    }
    html! {
        p.small {
            "Percent finer by mass, as sampled"
            @if curves.iter().any(|curve| !curve.regraded.is_empty()) {
                " and as regraded for the rules of practice"
            }
            "; " (BETWEEN)
        }
        @if curves.len() > 1 { (of_many(&sized(design))) } @else { (of_few(&sized(design), unit)) }
        (gradations(&tabled(design), unit, RECORD))
        @if curves.len() > CURVES {
            p.small { "The other " (curves.len() - CURVES) " curves are in " (RECORD) "." }
        }
    }
}

fn sized(design: &Specification) -> Vec<SizedSoil<'_>> {
    let several = design.curves.len() > 1;
    let mut soils = Vec::new();
    for curve in &design.curves {
        let (sampled, regraded) = match (several, curve.regraded.is_empty()) {
            (false, true) => ("Base".into(), String::new()),
            (false, false) => ("Base, sampled".into(), "regraded".into()),
            (true, _) => (curve.curve.clone(), format!("{}, regraded", curve.curve)),
        };
        soils.push((sampled, &*curve.gradation));
        if !curve.regraded.is_empty() {
            soils.push((regraded, &*curve.regraded));
        }
    }
    soils
}

fn tabled(design: &Specification) -> Vec<TabledSoil<'_>> {
    let several = design.curves.len() > 1;
    let mut soils = Vec::new();
    for curve in design.curves.iter().take(CURVES) {
        let name = if several || is_named("base", &curve.curve) { &*curve.curve } else { "" };
        soils.push(TabledSoil { kind: "Base, as sampled", name, rows: &curve.gradation });
        if !curve.regraded.is_empty() {
            soils.push(TabledSoil { kind: "Base, regraded", name, rows: &curve.regraded });
        }
    }
    soils
}

/// The first curves on a gradation chart, with both sides of the band, whose D15F is in `words`; `None`
/// without anything to draw.
pub(super) fn curves_figure(design: &Specification, words: Option<&str>) -> Option<Drawn> {
    let (curves, band) = (&design.curves, design.band.as_ref());
    let sides = band.map(|band| (band.drawn_fine_side(), &band.coarse_side));
    let bases = curves.iter().take(CURVES).flat_map(|curve| curve.gradation.iter().chain(&curve.regraded));
    let of_sides = sides.iter().flat_map(|(fine, coarse)| fine.iter().chain(*coarse));
    let sizes: Vec<f64> = bases.chain(of_sides).map(|row| row[0]).collect();
    if sizes.is_empty() {
        return None;
    }
    let (low, high) = positive_range(sizes.into_iter());
    let (title, what) = match band {
        Some(_) => (
            "Band of the filter",
            "Percent finer against size for the base and for both sides of the band of the filter",
        ),
        None => ("Gradations", "Percent finer against size for the soils that were given"),
    };
    let (x, y) = (Axis::log("Size (mm)", low, high), Axis::percent("Percent finer by mass (%)"));
    let mut figure = Figure::new(title, what, x, y).sizes((720.0, 460.0), (358.0, 400.0)).sieves();
    if let Some((fine, coarse)) = &sides {
        let outline = fine.iter().chain(coarse.iter().rev()).map(|&[x, y]| (x, y)).collect();
        figure.add(Mark::area(outline, GREEN, 0.15).label("band"));
        figure.add(Mark::rows(fine, GREEN).width(2.6).label("fine side"));
        figure.add(Mark::rows(coarse, BLUE).width(2.6).label("coarse side"));
    }
    for curve in curves.iter().take(CURVES) {
        draw(&mut figure, curve, if curves.len() == 1 { "base" } else { &curve.curve });
    }
    let mut caption = match band {
        Some(_) => format!(
            "The band of the filter for this base, as its limits at the sieves have it{}. Its control \
             points are joined by straight lines; above 60 % finer both sides go on straight, and below \
             its D5 the fine side runs level: no more than 5 % may be finer.",
            words.map_or(String::new(), |words| format!(": {words}"))
        ),
        None => "Gradations by mass. There is no band to draw.".to_owned(),
    };
    if curves.len() > CURVES {
        caption += &format!(" {} more curves of the base are not drawn.", curves.len() - CURVES);
    }
    Some(Drawn::new("specification", figure, caption))
}

fn draw(figure: &mut Figure, curve: &SpecifiedCurve, name: &str) {
    let (name, sampled) = (shorten(name, 24), Mark::rows(&curve.gradation, VERMILLION));
    if curve.regraded.is_empty() {
        return figure.add(sampled.label(&name));
    }
    figure.add(sampled.width(1.4).dash(Dash::Dashed).label(&format!("{name},\nas sampled")));
    figure.add(Mark::rows(&curve.regraded, VERMILLION).label(&format!("{name},\nregraded")));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_soil_has_its_curve_and_its_name() {
        let point = |(size, percent)| CurvePoint { size, percent };
        let [fine, coarse] =
            [[(0.1, 0.0), (1.0, 100.0)], [(1.0, 10.0), (20.0, 100.0)]].map(|curve| curve.map(point));
        let text = soils_figure([("fine <side>", &fine[..]), ("coarse", &coarse[..])], false);
        assert!(text.starts_with("<?xml") || text.starts_with("<svg"), "{}", &text[..40]);
        assert!(text.contains(">fine &lt;side&gt;<") && text.contains(">coarse<"));
        // A single size.
        assert!(soils_figure([("one", &[point((2.0, 100.0))][..])], false).contains("</svg>"));
    }
}
