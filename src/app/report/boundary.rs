//! Page of the model's boundaries: one table and one figure, made from `boundary.json` and `boundary.csv`
//! alone.

use std::path::Path;

use maud::{Markup, html};

use super::figures::{
    Across, Axis, BLACK, BLUE, Colour, Dash, Figure, GREY, Mark, ORANGE, PURPLE, VERMILLION, positive_range,
};
use super::files::{ReportError, json, rows};
use super::names::{file_name, option_words, titled_by_file};
use super::section::{Sections, Written};
use super::shell::{Drawn, citation, clean, fact, program, unbroken};
use super::soils::input_files;
use super::table::{Table, known};
use crate::outcome::boundary::{Boundaries, Boundary, BoundaryRow, WalkRow};
use crate::outcome::table::{Columns, TableCell};
use crate::words::boundary::{drawn_of_networks, held, row_name, share_of_networks};
use crate::words::left_out::left_out_in_brief;
use crate::words::{FOREMOST, base_size, row_note, sentence};
use voidwalk_practice::Note;
use voidwalk_practice::quantity::{NumberRole, SizeUnit, length, percent, significant, whole};

/// Writes `boundary.html` and its figure into the folder that holds `boundary.json` and `boundary.csv`.
pub(crate) fn write_boundary(folder: &Path) -> Result<Written, ReportError> {
    let all: Boundaries = json(&folder.join("boundary.json"))?;
    let walks: Vec<(u64, WalkRow)> = rows(&folder.join("boundary.csv"))?;
    let walks: Vec<WalkRow> = walks.into_iter().map(|(_, row)| row).collect();
    let title = "Boundaries of the model";
    let names = html! {
        (titled_by_file("Base", "Base", &all.base.name)) ", " (filter_words(&all))
    };
    let unit = size_unit(&all);
    let notes: Vec<String> = all.notes.iter().map(|row| row_note(row, unit)).collect();
    let (foremost, rest) = notes.split_at(notes.len().min(FOREMOST));
    let sheet = html! { section.sheet {
        (model(&all, foremost, rest.len()))
        p.small { (clean(&left_out_in_brief(&all.model_leaves_out))) " The boundaries of the walk are the \
            model’s. They do not replace a filter test or a designer’s judgement." }
    } };
    // They are collapsed on a screen and expanded in print.
    let others = html! { @if !rest.is_empty() {
        details { summary { (rest.len()) " more" } ul { @for note in rest { li { (clean(note)) } } } }
    } };
    let footer = html! {
        (citation())
        p { "The classes: Foster and Fell, as that paper uses them." }
        p.small { "voidwalk " (all.version) "." }
    };
    Sections::new(title, title, &names)
        .model()
        .cover(&all.cover, &program(&all.version, all.commit.as_deref()), Some(all.seed))
        .words(&sheet)
        .figures(erosion(&all, &walks))
        .contents()
        .section("Density and thickness", &boundaries(&all))
        .section("Other notes", &others)
        .section("How this was made", &made(&all, &walks))
        .write(folder, "boundary.html", &footer)
}

/// Soil of the filter with its given sizes, and its curve.
fn filter_words(all: &Boundaries) -> Markup {
    html! {
        (titled_by_file("filter", "filter of the shape", &all.filter))
        @if let Some(facts) = as_given(all) { " (" (facts) ")" }
        ", constrictions " (clean(&file_name(&all.curve_name)))
    }
}

/// D15F and Cu of the given filter; `None` if neither is known.
fn as_given(all: &Boundaries) -> Option<String> {
    let d15 = all.filter_d15_mm.map(|mm| format!("D15F {}", length(mm, size_unit(all))));
    let cu = all.filter_cu.map(|cu| format!("Cu {}", significant(cu)));
    let given = all.filter_d15_mm.map(|_| "as given".to_owned());
    let facts: Vec<String> = d15.into_iter().chain(cu).chain(given).collect();
    (!facts.is_empty()).then(|| facts.join(", "))
}

/// Line of the model, and the most important notes.
fn model(all: &Boundaries, foremost: &[String], more: usize) -> Markup {
    let sentence = unbroken(&held(all, size_unit(all)));
    html! {
        section.verdict {
            p.practice { b { "Model (research)" } ": " (sentence) "." }
            @if let Some(base) = all.base.size() { p { (base_size(&base, size_unit(all))) "." } }
            @if !foremost.is_empty() { ul { @for note in foremost { li { (unbroken(note)) } } } }
            @if more > 0 { p.small { "and " (more) " more below, under “Other notes”" } }
        }
    }
}

/// Figure of the row that holds least; if no row is known to hold, of the first row that has a boundary, else
/// of the first that was walked.
fn erosion(all: &Boundaries, walks: &[WalkRow]) -> Option<Drawn> {
    let is_of = |row: &BoundaryRow, walk: &&WalkRow| {
        walk.density == row.searched() && walk.thickness == row.thickness
    };
    let has_walks = |row: &&BoundaryRow| walks.iter().any(|walk| is_of(row, &walk));
    let with_boundary = |row: &&BoundaryRow| row.no_erosion.is_some();
    let rows = || all.boundaries.iter().filter(has_walks);
    let least = all.least_held().map(|(row, _)| row).filter(has_walks);
    let row = least.or_else(|| rows().find(with_boundary)).or_else(|| rows().next())?;
    let walks: Vec<&WalkRow> = walks.iter().filter(|walk| is_of(row, walk)).collect();
    // Sizes are in mm if the base has a size.
    let (d85, axis) = match all.base.d85_mm {
        Some(d85) => (d85, "D15F (mm)"),
        None => (1.0, "D15F/D85B (–)"),
    };
    let shown = walks.iter().map(|walk| walk.d15f_over_d85b * d85);
    let shown: Vec<f64> = shown.filter(|at| *at > 0.0 && at.is_finite()).collect();
    if shown.is_empty() {
        return None;
    }
    let (low, high) = positive_range(shown.into_iter());
    let x = Axis::log(axis, low, if high > low { high } else { 2.0 * low });
    let ends = (x.low, x.high);
    let what = "Percent of the base eroded against D15F in both runs of every network, with the zones of no, \
                some and continuing erosion in the model";
    let mut figure = Figure::new("Erosion against D15F", what, x, Axis::percent("Base eroded, by mass (%)"))
        .sizes((760.0, 340.0), (358.0, 420.0));
    zones(&mut figure, row, d85, ends);
    figure.add(Mark::rule(Across::Y, 100.0 * all.threshold, BLACK).dash(Dash::Dashed).label("7.5 %"));
    draw_runs(&mut figure, &walks, d85);
    let of_base =
        all.base.size().map_or(String::new(), |base| format!(" {}.", base_size(&base, size_unit(all))));
    let blend = match all.replicates {
        1 => String::new(),
        networks => format!(" The colours blend over the {} of the networks.", drawn_of_networks(networks)),
    };
    let mut caption = format!(
        "Base eroded against D15F: {}, {}. Each thin line is a network: blue its first run, purple its \
         second where it was walked. In the model, grey: no erosion; orange: some erosion; red: continuing \
         erosion.{blend}{of_base}",
        row_name(row),
        row.thickness
    );
    if all.boundaries.len() > 1 {
        if least.is_some() {
            caption += " Of all that were searched this one holds least.";
        }
        caption += " The other densities and thicknesses are in the table.";
    }
    Some(Drawn::new("boundary", figure, caption))
}

/// Zones of the model, over the whole width of the figure. No zone is green: green is reserved for practice.
fn zones(figure: &mut Figure, row: &BoundaryRow, d85: f64, (left, right): (f64, f64)) {
    let edges = |boundary: &Boundary| {
        let at = |ratio: f64| (ratio * d85).clamp(left, right);
        // "Some erosion" begins at the left edge if no ratio is known that nearly all networks hold.
        [at(boundary.cautious().unwrap_or(0.0)), at(boundary.high.unwrap_or(boundary.median))]
    };
    // A row that holds to the end of the search is drawn up to that end.
    let [from, to] = match (&row.no_erosion, row.holds_to) {
        (Some(first), _) => edges(first),
        (None, Some(ratio)) => [right, (ratio * d85).clamp(left, right)],
        (None, None) => return,
    };
    let continuing = row.continuing.as_ref().map(edges);
    let mut zone = |low: f64, high: f64, colour: Colour, opacity: f64, name: &str| {
        if high > low {
            let area =
                Mark::area(vec![(low, 0.0), (high, 0.0), (high, 100.0), (low, 100.0)], colour, opacity);
            figure.add(if name.is_empty() { area } else { area.label(name) });
        }
    };
    zone(left, to, GREY, 0.12, "no erosion");
    if row.no_erosion.is_none() {
        return;
    }
    let [end, most] = continuing.unwrap_or([right, right]);
    zone(from, most, ORANGE, 0.14, if end > 1.05 * to { "some" } else { "" });
    if most < right || continuing.is_some() {
        zone(end, right, VERMILLION, 0.12, "continuing");
    }
}

fn draw_runs(figure: &mut Figure, walks: &[&WalkRow], d85: f64) {
    let mut networks: Vec<u64> = walks.iter().map(|walk| walk.network).collect();
    networks.dedup();
    for (index, network) in networks.iter().enumerate() {
        let of_network = || walks.iter().filter(|walk| walk.network == *network);
        let first = of_network().map(|walk| (walk.d15f_over_d85b * d85, 100.0 * walk.eroded_first));
        let second =
            of_network().filter_map(|walk| Some((walk.d15f_over_d85b * d85, 100.0 * walk.eroded_second?)));
        for (points, colour, name) in
            [(first.collect(), BLUE, "first run"), (second.collect::<Vec<_>>(), PURPLE, "second run")]
        {
            if points.is_empty() {
                continue;
            }
            let line = Mark::line(points, colour).width(1.2).opacity(0.7);
            figure.add(if index == 0 { line.label(name) } else { line });
        }
    }
}

/// Columns of the boundaries, whose cells the page decorates.
fn columns<'a>() -> Columns<'a, BoundaryRow> {
    let thick = |row: &BoundaryRow| {
        let mm = row.thickness_mm.map(|mm| format!(", {} mm", significant(mm))).unwrap_or_default();
        format!("{} layers{mm}", whole(row.layers))
    };
    let median = |boundary: &Option<Boundary>| boundary.as_ref().map(|boundary| ratio(boundary.median));
    Columns::default()
        .name("density", "Density", row_name)
        .text("thickness", "Thickness, at the no-erosion boundary", move |row| {
            row.thickness.as_str().shown().below(thick(row))
        })
        .text("no_erosion", "No erosion in the model up to", move |row| median(&row.shown()[0]))
        .text("continuing", "Continuing erosion from", move |row| median(&row.shown()[1]))
        .number("not_monotone", "Not monotone", |row| {
            format!("{} of {}", row.not_monotone, row.networks.len())
        })
}

/// Boundaries of the model, one row per density and thickness.
fn boundaries(all: &Boundaries) -> Markup {
    let of_base =
        all.base.size().map_or(String::new(), |base| format!(" ({})", base_size(&base, size_unit(all))));
    // A boundary of no erosion is given as a limit.
    let unit = size_unit(all);
    let limit = |mm: f64| length(mm, unit).role(NumberRole::Greatest).to_string();
    let rounded = |mm: f64| length(mm, unit).to_string();
    let cell = |boundary: Option<&Boundary>, notes: &[Note], is_limit: bool| {
        let end = move |value| {
            significant(value).role(if is_limit { NumberRole::Greatest } else { NumberRole::Value }).number()
        };
        html! {
            @match boundary {
                Some(boundary) => {
                    (ratio(boundary.median))
                    (in_band(boundary.low, boundary.high, ratio))
                    @if let Some(range) = &boundary.d15f_mm {
                        br; (if is_limit { limit(range.median) } else { rounded(range.median) })
                        (in_band(range.low, range.high, end))
                    }
                },
                None => "no number",
            }
            @for note in notes { br; span.small { (clean(&sentence(note, unit))) } }
        }
    };
    html! {
        p {
            "Results of the walks alone, without the rules of practice: D15F/D85B" (of_base)
            @if all.replicates == 1 { ", of one network" } @else {
                ", median of " (whole(all.replicates)) " networks (in brackets "
                (share_of_networks(all.replicates)) ")"
            }
            "; below it the D15F in mm if sizes have a unit."
        }
        (Table::new(&all.boundaries, columns()).class("study")
            .showing("no_erosion", |row| cell(row.shown()[0].as_ref(), &row.no_erosion_notes, true))
            .showing("continuing", |row| cell(row.shown()[1].as_ref(), &row.continuing_notes, false)))
        p.small {
            "No erosion: less than " (percent(all.threshold).in_digits(3))
            " of the mass of the base erodes in the first run. Continuing: at least as much in the second, \
             too. Between the two is some erosion."
            @if all.moves_expectation() {
                " Base particles that can block nothing move as their expectation. A run with another engine \
                 draws other random numbers: on a small lattice it may lose "
                (percent(all.threshold).in_digits(3))
                " of the base at a smaller D15F than the boundary."
            }
        }
    }
}

/// Coefficient of uniformity, or words for an unknown one.
fn cu(value: Option<f64>) -> String {
    value.map_or_else(|| "not known".to_owned(), |cu| significant(cu).in_digits(4).to_string())
}

fn made(all: &Boundaries, walks: &[WalkRow]) -> Markup {
    let [low, high] = all.bracket;
    let size = |value: Option<f64>| value.map_or_else(|| "not known".to_owned(), |mm| format!("{mm:.4} mm"));
    let grains = all.boundaries.iter().find_map(|row| row.grains_per_void);
    let asked = all.settings.iter().map(|setting| option_words(setting)).collect::<Vec<_>>().join(" ");
    html! {
        table.facts { tbody {
            (fact("Base", file_name(&all.base.name)))
            (fact("Cu of the base as walked; D15 as sampled, D85 as walked", format!(
                "{}; {}, {}",
                cu(all.base.cu),
                size(all.base.d15_mm),
                size(all.base.d85_mm)
            )))
            @if let Some(base) = all.base.size() { (fact("D85B", base_size(&base, size_unit(all)))) }
            (fact("Filter", file_name(&all.filter)))
            (fact("Constriction curve", file_name(&all.curve_name)))
            @if let Some(mm) = all.filter_d15_mm { (fact("D15F of the filter as given", size(Some(mm)))) }
            (fact("Cu of the filter", cu(all.filter_cu)))
            (fact("Grains per void", known(grains, |grains| significant(grains).in_digits(4))))
            @if !all.engine.is_empty() { (fact("Engine", &all.engine)) }
            (fact("Networks, seed", format!("{}, {}", whole(all.replicates), all.seed)))
            (fact("Searched", format!(
                "D15F/D85B {low} to {high}, outwards to steps of 8 %, in steps of {} %; {} ratios walked \
                 (boundary.csv)",
                significant(100.0 * all.step).in_digits(4),
                whole(walks.len() as u64)
            )))
            (input_files(&all.inputs))
            (fact("Asked for", if asked.is_empty() { "nothing in particular" } else { &asked }))
        } }
    }
}

fn size_unit(all: &Boundaries) -> SizeUnit {
    SizeUnit::of(false, all.inches)
}

fn ratio(value: f64) -> String {
    format!("{value:.2}")
}

/// Band in brackets, if there are enough networks for one.
fn in_band(low: Option<f64>, high: Option<f64>, words: impl Fn(f64) -> String) -> String {
    let end = |value: Option<f64>| value.map_or_else(|| "unknown".to_owned(), &words);
    if low.or(high).is_some() { format!(" ({} to {})", end(low), end(high)) } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::boundary::NetworkBoundaries;
    use crate::outcome::record::ModelLimit;
    use voidwalk_core::store::format::BOUNDARY;

    fn written(all: &Boundaries, csv: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("boundary.json"), BOUNDARY.json(all).unwrap()).unwrap();
        std::fs::write(folder.path().join("boundary.csv"), csv).unwrap();
        let written = write_boundary(folder.path()).unwrap();
        assert!(written.page.ends_with("boundary.html"));
        assert!(written.figures[0].ends_with("figures/boundary.svg"));
        std::fs::read_to_string(written.page).unwrap()
    }

    fn all(no_erosion: Option<Boundary>) -> Boundaries {
        let row = BoundaryRow {
            density: "<loose>".into(),
            thickness: "60 layers".into(),
            layers: 60,
            no_erosion,
            ..BoundaryRow::default()
        };
        Boundaries {
            boundaries: vec![row],
            threshold: 0.075,
            replicates: 3,
            model_leaves_out: vec![ModelLimit::Supply],
            ..Boundaries::default()
        }
    }

    const CSV: &str = "density,thickness,network,d15f_over_d85b,eroded_first,eroded_second,d85b_of\n\
                       <loose>,60 layers,1,4.0,0.01,,\n<loose>,60 layers,1,5.0,0.5,0.4,\n";

    /// With few networks, a percentile would lie between two of them.
    #[test]
    fn of_few_networks_the_page_has_least_and_most() {
        let page_of = |ratios: &[f64]| {
            let networks: Vec<_> = ratios.iter().map(|ratio| Ok(*ratio)).collect();
            let mut all = all(Boundary::of(&networks, Some(0.2)));
            all.base.d85_mm = Some(0.2);
            all.replicates = ratios.len() as u64;
            let network =
                |ratio: &f64| NetworkBoundaries { network: 1, no_erosion: Some(*ratio), continuing: None };
            all.boundaries[0].networks = ratios.iter().map(network).collect();
            written(&all, CSV)
        };
        let few = page_of(&[4.0, 4.4, 6.0]);
        for text in [
            "(4.00 to 6.00)",
            "median of 3 networks (in brackets least and most); below it the D15F",
            "blend over the interpolated 5 to 95 % range of the networks.",
        ] {
            assert!(few.contains(text), "{text}: {few}");
        }
        let one = page_of(&[4.4]);
        assert!(one.contains(", of one network; below it the D15F"), "{one}");
        assert!(!one.contains("least and most") && !one.contains("5 to 95 %"), "{one}");
        let many = page_of(&[4.0, 4.4, 4.8, 5.2].repeat(5));
        let text = "median of 20 networks (in brackets 5 to 95 % range); below it the D15F";
        assert!(many.contains(text), "{many}");
    }

    /// The model's line has no colour, no zone of its figure is green, whatever it says, and names are inert.
    #[test]
    fn nothing_of_the_model_is_green_and_names_are_inert() {
        for no_erosion in [Boundary::of(&[Ok(4.3), Ok(4.5)], Some(0.2)), None] {
            let mut all = all(no_erosion);
            all.base.d85_mm = Some(0.2);
            let page = written(&all, CSV);
            assert!(page.contains("class=\"verdict\"") && !page.contains("class=\"verdict "), "{page}");
            assert!(page.contains("<b>Model (research)</b>: "), "{page}");
            assert!(!page.contains("#009E73\"") && !page.contains(">Limit: "), "{page}");
            assert!(page.contains("&lt;loose&gt;") && !page.contains("<loose>"));
            assert!(page.contains("default-src 'none'"));
            assert!(page.contains("The model leaves out: a limit to what enters"));
        }
    }

    #[test]
    fn the_figure_is_of_the_row_that_holds_least() {
        let boundary = |ratio: f64| Boundary::of(&[Ok(ratio), Ok(ratio)], Some(0.2));
        let mut all = all(boundary(5.0));
        let loose =
            BoundaryRow { density: "loosest".into(), no_erosion: boundary(3.0), ..all.boundaries[0].clone() };
        all.boundaries.push(loose);
        all.base.d85_mm = Some(0.2);
        let page = written(&all, &format!("{CSV}loosest,60 layers,1,3.0,0.01,,\n"));
        assert!(page.contains("Base eroded against D15F: loosest, 60 layers"), "{page}");
        assert!(page.contains("this one holds least"));
    }

    /// The model holds to 0.8068 mm.
    #[test]
    fn a_boundary_of_no_erosion_is_rounded_inward_in_mm_and_inches() {
        let mut all = all(Boundary::of(&[Ok(4.034), Ok(4.034)], Some(0.2)));
        all.base.d85_mm = Some(0.2);
        let csv = CSV.replace("4.0,", "3.9,");
        let page = written(&all, &csv).replace('\u{202f}', " ");
        assert!(page.contains("D15F 0.806 mm") && !page.contains("0.807"), "{page}");
        all.inches = true;
        let page = written(&all, &csv).replace('\u{202f}', " ");
        // 0.806 mm is 0.03173 in.
        let inches = page.matches("0.806 mm (").count();
        assert!(inches > 1 && inches == page.matches("0.0317 in").count(), "{page}");
    }

    #[test]
    fn a_folder_that_was_changed_is_refused_with_file_and_line() {
        let folder = tempfile::tempdir().unwrap();
        let text = BOUNDARY.json(&all(None)).unwrap();
        std::fs::write(folder.path().join("boundary.json"), text).unwrap();
        std::fs::write(folder.path().join("boundary.csv"), CSV.replace("0.01", "much")).unwrap();
        let error = write_boundary(folder.path()).unwrap_err().to_string();
        assert!(error.contains("boundary.csv") && error.contains('2'), "{error}");
        std::fs::remove_file(folder.path().join("boundary.json")).unwrap();
        assert!(write_boundary(folder.path()).unwrap_err().to_string().contains("boundary.json"));
    }
}
