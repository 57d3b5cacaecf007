//! Page of walks on given networks, without a scene.

use super::figures::{Axis, BLUE, Dash, Figure, Mark, VERMILLION};
use super::files::{ReportError, json_of, refused};
use super::results::{
    brief, by_connectivity, eroded_table, in_words, replicates, replicates_in_words, results,
};
use super::run_figures;
use super::run_figures::size_axis;
use super::section::Sections;
use super::shell::{Drawn, citation, clean, drawing, fact, leaves_out};
use super::table::{counts, known};
use super::walks::{RunRows, Walks, check_curve, check_results};
use crate::outcome::Recorded;
use crate::outcome::record::{NetworkWalkRecord, Verdict};
use crate::words::left_out::left_out_words;
use crate::words::{FirstLine, sentence};
use maud::{Markup, html};
use std::path::Path;
use voidwalk_practice::quantity::{SizeUnit, length, percent, significant, whole};

const RECORD: &str = "outcome";

/// Page of walks on given networks, from their record as JSON and the rows of their tables. A malformed
/// record, or rows that do not fit together, are errors.
pub fn network_walk_page(record: &str, recorded: Recorded) -> Result<String, ReportError> {
    let record = checked(record)?;
    let rows = RunRows::read(Path::new(""), Some(recorded), &record.replicates, &record.summary)?;
    let walks = walks(&record, &rows);
    let of_walks = [run_figures::eroded, run_figures::layers, run_figures::retained].map(|draw| draw(&walks));
    let figures = [Some(sizes(&record))].into_iter().chain(of_walks).flatten().collect();
    Ok(page(&record, &walks, figures))
}

/// Verdict of walks on given networks, as a fragment of a page: its numbers, a figure, the omissions of the
/// model. A malformed record is an error.
pub fn network_walk_brief(record: &str) -> Result<String, ReportError> {
    let record = checked(record)?;
    let rows = RunRows::default();
    let walks = walks(&record, &rows);
    let lines = [(FirstLine::Model, record.verdict.words().to_owned())];
    let meaning = in_words(&walks);
    Ok(brief(&walks, &lines, &meaning, &record.notes, replicate(&record), &record.model_leaves_out))
}

fn checked(record: &str) -> Result<NetworkWalkRecord, ReportError> {
    let path = Path::new(RECORD);
    let record: NetworkWalkRecord = json_of(path, record)?;
    check_results(path, &record.replicates, &record.summary, record.threshold)?;
    check_curve(path, "base.gradation", &record.base.gradation)?;
    check_curve(path, "network.diameters", &record.network.diameters)?;
    if record.increments == 0 {
        return Err(refused(path, "increments", "0".into(), "1 or more"));
    }
    Ok(record)
}

fn walks<'a>(record: &'a NetworkWalkRecord, rows: &'a RunRows) -> Walks<'a> {
    Walks {
        verdict: record.verdict,
        summary: &record.summary,
        replicates: &record.replicates,
        threshold: record.threshold,
        inject_share: 1.0 / record.increments as f64,
        base: &record.base.gradation,
        unit: SizeUnit::Mm,
        d15f_mm: record.d15f_mm,
        thickness_mm: None,
        rows,
    }
}

/// Words for the only replicate, and for each of several.
fn replicate(record: &NetworkWalkRecord) -> [&'static str; 2] {
    let of_several = match record.network.networks {
        1 => "a new walk on the same network",
        _ => "a walk on a network of its own",
    };
    ["one network, one walk", of_several]
}

fn sizes(record: &NetworkWalkRecord) -> Drawn {
    let (base, network) = (&record.base.gradation, &record.network.diameters);
    let x = size_axis(SizeUnit::Mm, base.iter().chain(network).map(|row| row[0]));
    let what = "Percent finer against size for the base (by mass) and the constrictions (by number)";
    let y = Axis::percent("Percent finer (%)");
    let mut figure = Figure::new("Base and constrictions", what, x, y).sizes((720.0, 460.0), (358.0, 400.0));
    figure.add(Mark::rows(base, VERMILLION).width(2.6).label("base\n(by mass)"));
    let constrictions = Mark::rows(network, BLUE).dash(Dash::Dashed);
    figure.add(constrictions.label("constrictions\n(by number)"));
    let caption = "Percent finer by mass of the base, and percent smaller by number of the network’s open \
                   constrictions. Base particles pass a constriction that is no smaller than they are.";
    Drawn::new("gradations", figure, caption)
}

fn page(record: &NetworkWalkRecord, walks: &Walks, figures: Vec<Drawn>) -> String {
    let title = format!("{}: walks on a given network", record.verdict.words());
    let names = html! {
        "Base " b { (clean(&record.base.name)) } " on a network of "
        b { (whole(record.network.voids)) " voids" }
    };
    let sheets = html! {
        section.sheet {
            div.first {
                (verdict_section(record, walks))
                (leaves_out(&record.model_leaves_out, &html! {}))
            }
        }
        @if !record.notes.is_empty() {
            section.sheet {
                h2 { "What else to know" }
                ul { @for note in &record.notes { li { (clean(&sentence(note, SizeUnit::Mm))) } } }
            }
        }
    };
    let numbers = html! { (results(walks)) (by_connectivity(walks)) (replicates(walks)) (inputs(record)) };
    Sections::new(title, "Does this base pass this network?", &names)
        .words(&sheets)
        .contents()
        .words(&html! { h2 { "Figures" } })
        .figures(figures)
        .words(&numbers)
        .text(&citation())
}

/// Number of base particles, and the number that Eq. (2) requires.
fn amount(record: &NetworkWalkRecord) -> String {
    let walked = whole(record.n_base);
    match (record.n_base_eq2, record.grains_per_void) {
        (Some(eq2), Some(grains)) => {
            let assumptions =
                format!("{} grains per void and a mass ratio of {}", significant(grains), record.mass_ratio);
            match eq2 == record.n_base {
                true => format!("{walked}, as the model requires with {assumptions}"),
                false => format!("{walked}; the model requires {} with {assumptions}", whole(eq2)),
            }
        }
        _ => format!("{walked}, as given"),
    }
}

fn verdict_section(record: &NetworkWalkRecord, walks: &Walks) -> Markup {
    let class = match record.verdict {
        // Never green without a decision of practice.
        Verdict::None => "doubted",
        Verdict::Some => "some",
        Verdict::Continuing => "continuing",
        Verdict::Undecided => "undecided",
    };
    html! {
        section.verdict.(class) {
            p.word { "Model (research): " (record.verdict.words()) "." }
            p.lead { (in_words(walks)) }
            div { (drawing(&run_figures::verdict(walks))) }
            (eroded_table(walks))
            (replicates_in_words(walks, replicate(record)))
        }
    }
}

fn inputs(record: &NetworkWalkRecord) -> Markup {
    let (base, network) = (&record.base, &record.network);
    let mm = |value: f64| length(value, SizeUnit::Mm);
    let sizes = |sizes: [Option<f64>; 3]| sizes.map(|size| known(size, mm)).join(", ");
    html! {
        h2 { "How this was made" }
        table.facts { tbody {
            (fact("Base", &base.name))
            (fact("D0, D15, D50 of the base (by mass)", sizes([Some(base.d0_mm), base.d15_mm, base.d50_mm])))
            (fact("D85, D95, D100 of the base", sizes([base.d85_mm, base.d95_mm, base.d100_mm].map(Some))))
            @if base.tail_mass_fraction > 0.0 {
                (fact("Pan fraction (finer than the finest sieve)",
                    format!("{} by mass, taken as too fine to block any constriction",
                        percent(base.tail_mass_fraction))))
            }
            (fact("D15 of the filter, D15F", known(record.d15f_mm, mm)))
            (fact("Networks", match network.networks {
                1 => "1, walked again by each replicate".to_owned(),
                n => format!("{}, of the first:", whole(n)),
            }))
            (fact("Voids, constrictions, layers",
                counts([network.voids, network.constrictions, network.layers])))
            (fact("Particles choose an exit by", &network.exit))
            (fact("Base particles in each run", amount(record)))
            (fact("Inserted in equal parts", whole(record.increments)))
            (fact("Threshold between the classes", significant(record.threshold)))
            (fact("Seed", record.seed.to_string()))
            (fact("Engine", &record.engine))
            (fact("voidwalk", &record.version))
            @if !record.left_out.is_empty() {
                (fact("Not needed for this walk", left_out_words(&record.left_out, "mm")))
            }
        } }
    }
}
