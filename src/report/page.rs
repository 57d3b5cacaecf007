//! The page of a run.

use std::path::Path;

use maud::{Markup, html};

use super::connectivity::by_connectivity;
use super::error::ReportError;
use super::figures::{shorten, visible};
use super::folder::RunFolder;
use super::infiltration::infiltration;
use super::numbers::{
    capital, duration, interval, known, percent, percent_interval, significant, size, size_unit, threshold,
    trimmed, whole,
};
use super::rules::rules;
use super::run_figures::{self, run_name};
use super::shell::{self, Drawn, clean, drawing, fact, whole_page};
use super::table::Table;
use super::written::{Written, write_page};
use super::{packing, shell::leaves_out};
use crate::outcome::packing::PackingRecord;
use crate::outcome::record::{
    Confidence, NetworkKind, Outcome, Replicate, Run, RunSummary, Sensitivity, Statistic, Stopping, Verdict,
};

/// Replicates listed one by one; all are in `outcome.json`.
const LISTED: usize = 100;

/// Characters of `scene.toml` that are shown.
const SCENE: usize = 100_000;

/// Writes `report.html` and `figures/*.svg` into a finished run folder.
///
/// Each file appears whole or not at all, and an older one of the same name is replaced.
///
/// # Errors
/// [`ReportError`] names the file, and where there is one the line and field, that is missing, malformed or
/// contradicts another. Nothing is written then.
pub fn write(folder: &Path) -> Result<Written, ReportError> {
    let run = RunFolder::read(folder)?;
    let verdict = run_figures::verdict(&run);
    let figures: Vec<Drawn> = [
        Some(run_figures::gradations(&run)),
        run_figures::eroded(&run),
        run_figures::layers(&run),
        run_figures::retained(&run),
        run_figures::sensitivity(&run),
        run.packing.as_ref().map(packing::slice),
    ]
    .into_iter()
    .flatten()
    .collect();

    let page = page(&run, &verdict, &figures);
    let all: Vec<Drawn> = std::iter::once(verdict).chain(figures).collect();
    write_page(folder, &all, &page)
}

/// The page as text. `verdict` stands beside the verdict, `figures` below it.
fn page(folder: &RunFolder, verdict: &Drawn, figures: &[Drawn]) -> String {
    let outcome = &folder.outcome;
    let (filter, base) = (&outcome.inputs.filter, &outcome.inputs.base);
    let title = format!(
        "{}: {} on {}",
        outcome.verdict.words(),
        clean(&shorten(&base.name, 60)),
        clean(&shorten(&filter.name, 60))
    );
    let header = html! {
        h1 { "Will this filter hold this soil?" }
        p.names {
            "Base " b { bdi { (clean(&base.name)) } } " against filter " b { bdi { (clean(&filter.name)) } }
        }
    };
    let main = html! {
        div.first {
            (verdict_box(outcome, verdict))
            (leaves_out(&outcome.model_leaves_out, &html! {
                @if outcome.model_leaves_out.is_empty() { p { "outcome.json does not say." } }
                p { "The verdict is the model’s. It does not replace a filter test or a designer’s \
                     judgement." }
            }))
        }
        (reasons(outcome))
        (warnings(outcome))
        h2 { "Figures" }
        (shell::figures(figures))
        (missing(folder, figures))
        (rules(outcome))
        (results(outcome))
        (infiltration(outcome))
        (by_connectivity(outcome))
        (replicates(outcome))
        (sensitivity(outcome))
        (inputs(outcome, folder.packing.as_ref()))
        (provenance(folder))
    };
    whole_page(&title, &header, &main, &citation(outcome))
}

fn verdict_box(outcome: &Outcome, verdict: &Drawn) -> Markup {
    let doubted = outcome.confidence != Confidence::Within;
    let class = match outcome.verdict {
        // Never in green where the model was not checked, or practice does not agree.
        Verdict::None if doubted => "doubted",
        Verdict::None => "none",
        Verdict::Some => "some",
        Verdict::Continuing => "continuing",
        Verdict::Undecided => "undecided",
    };
    let count = outcome.replicates.len();
    let table = Table::of(&outcome.summary)
        .name("Base eroded, by mass", |run| run_heading(run.run))
        .number("mean", |run| percent(run.eroded_mass_fraction.mean))
        .number("95 % interval", |run| {
            percent_interval(&run.eroded_mass_fraction).unwrap_or_else(|| "none".to_owned())
        });
    html! {
        section.verdict.(class) {
            p.word.long[!outcome.reasons.is_empty()] { (clean(&capital(&outcome.headline()))) "." }
            @if doubted { p { "Confidence: " b { (outcome.confidence.words()) } "." } }
            p.lead { (in_words(outcome)) }
            div { (drawing(verdict)) }
            (table)
            @if let Some(stopping) = &outcome.stopping { p { (stopped(stopping)) } }
            p { (tally(outcome)) " Threshold between the classes: " (threshold(outcome.threshold)) "." }
            @if count == 1 {
                p {
                    b { "One replicate: the scatter is unknown." }
                    " Walk more replicates before relying on this."
                }
            }
        }
    }
}

/// "First run", in the colour of the run.
fn run_heading(run: u64) -> Markup {
    html! { span class={ "run-" (run) } { (capital(run_name(run))) } }
}

/// What the rule that added replicates arrived at.
fn stopped(stopping: &Stopping) -> String {
    let mut text = String::new();
    if let Some(percent) = stopping.decide_percent {
        text += &format!(
            "Replicates were added to decide the verdict at the {percent} % confidence level, corrected for \
             repeated looks. "
        );
    }
    if let Some(pp) = stopping.target_error_pp {
        text += &format!("Replicates were added to reach an error of {pp} percentage points. ");
    }
    text += match (&stopping.sentence, stopping.met) {
        (_, true) => "That was reached.",
        (Some(sentence), _) => sentence,
        (None, false) => "That was not reached.",
    };
    text
}

/// What the class means, in a sentence.
fn in_words(outcome: &Outcome) -> String {
    let limit = threshold(outcome.threshold);
    match outcome.verdict {
        Verdict::None => format!(
            "In the model the filter holds this base: less than {limit} of its mass passes in the first run."
        ),
        Verdict::Some => format!(
            "In the model the filter seals after some erosion: {limit} or more of the base passes in the \
             first run, less in the second, on the constrictions that the first left blocked."
        ),
        Verdict::Continuing => format!(
            "In the model the filter does not hold this base: {limit} or more of its mass passes in the \
             first run and again in the second."
        ),
        Verdict::Undecided => {
            let straddles = |run: &&RunSummary| {
                interval(&run.eroded_mass_fraction)
                    .is_some_and(|(low, high)| low < outcome.threshold && outcome.threshold <= high)
            };
            let runs: Vec<&str> =
                outcome.summary.iter().filter(straddles).map(|run| run_name(run.run)).collect();
            if !runs.is_empty() {
                let plural = if runs.len() > 1 { "intervals of the " } else { "interval of the " };
                format!("Inconclusive: the {plural}{} includes {limit}.", runs.join(" and the "))
            } else if outcome.summary.len() == 1 {
                "Inconclusive: some and continuing erosion differ by the second run, and only a first was \
                 asked for."
                    .to_owned()
            } else {
                "Inconclusive: these replicates do not separate the classes.".to_owned()
            }
        }
    }
}

/// The classes of the replicates, counted.
fn tally(outcome: &Outcome) -> String {
    let count = outcome.replicates.len();
    if count == 1 {
        return "1 replicate (one network, one walk).".to_owned();
    }
    let classes = Verdict::ALL.into_iter().filter_map(|class| {
        let found = outcome.replicates.iter().filter(|replicate| replicate.verdict == class).count();
        let of = if found == count { "all".to_owned() } else { found.to_string() };
        (found > 0).then(|| format!("{} in {of}", class.words()))
    });
    let classes = classes.collect::<Vec<_>>().join(", ");
    format!("{count} replicates, each a new network and a new walk: {classes}.")
}

/// Why the verdict cannot be relied on as it stands.
fn reasons(outcome: &Outcome) -> Markup {
    html! {
        @if !outcome.reasons.is_empty() {
            section.warnings {
                @if outcome.confidence == Confidence::Within { h2 { "What else to know of this pair" } }
                @else { h2 { "Why this verdict is in doubt" } }
                ul { @for reason in &outcome.reasons { li { (clean(reason)) } } }
            }
        }
    }
}

fn warnings(outcome: &Outcome) -> Markup {
    let said = |warning: &&String| !outcome.reasons.contains(warning);
    let warnings: Vec<&String> = outcome.warnings.iter().filter(said).collect();
    html! {
        @if !warnings.is_empty() || outcome.capped {
            section.warnings {
                h2 { "Before you rely on this" }
                ul {
                    @if outcome.capped {
                        li {
                            "Capped: " (whole(outcome.n_base)) " base particles were walked; "
                            "Eq. (2) requires " (known(outcome.n_base_eq2, whole)) "."
                        }
                    }
                    @for warning in warnings { li { (clean(warning)) } }
                }
            }
        }
    }
}

/// Says which figures are missing, and why.
fn missing(folder: &RunFolder, figures: &[Drawn]) -> Markup {
    let has = |name: &str| figures.iter().any(|drawn| drawn.name == name);
    let reasons = [
        ("eroded", "series.csv has no rows: the progress of erosion is not drawn."),
        ("layers", "layers.csv has no rows: blocking by layer is not drawn."),
        (
            "retained",
            "retained.csv and eroded.csv have no rows for the first run: size curves are not drawn.",
        ),
        ("sensitivity", "Sensitivity to the number of base particles was not asked for."),
    ];
    html! {
        @for (name, reason) in reasons { @if !has(name) { p.small { (reason) } } }
        @if has("eroded")
            && folder.series.len() != folder.outcome.replicates.len() * folder.outcome.summary.len()
        {
            p.small { "series.csv does not hold every replicate and run: the mean is over those that it \
                       holds." }
        }
    }
}

/// A mean with its interval below it.
fn with_interval(mean: String, interval: Option<String>) -> Markup {
    html! {
        (mean)
        @if let Some(interval) = interval { br; span.small { (interval) } }
    }
}

fn fraction(statistic: &Statistic) -> Markup {
    with_interval(percent(statistic.mean), percent_interval(statistic))
}

fn results(outcome: &Outcome) -> Markup {
    type Row<'a> = (&'static str, &'a dyn Fn(&RunSummary) -> Markup);
    let (filter, scale_free) = (&outcome.inputs.filter, outcome.inputs.scale_free);
    let nothing = || html! { "nothing eroded" };
    let largest_ratio = |run: &RunSummary| match &run.largest_eroded_over_d15f {
        Some(of) => {
            let ends = of.low.zip(of.high);
            let ends = ends.map(|(low, high)| format!("{} to {}", significant(low), significant(high)));
            with_interval(significant(of.mean), ends)
        }
        None => nothing(),
    };
    let largest = |run: &RunSummary| match &run.largest_eroded_over_d15f {
        Some(of) => html! { (size(of.mean * filter.d15_mm, scale_free)) },
        None => nothing(),
    };
    let sd =
        |run: &RunSummary| html! { (run.eroded_mass_fraction.sd.map_or_else(|| "none".to_owned(), percent)) };
    let rows: [Row; 8] = [
        ("Base eroded, by mass", &|run| fraction(&run.eroded_mass_fraction)),
        ("Replicate SD of the base eroded, by mass", &sd),
        ("Base eroded, by number", &|run| fraction(&run.eroded_number_fraction)),
        ("Largest particle eroded, over D15F", &largest_ratio),
        ("Largest particle eroded", &largest),
        ("Constrictions blocked at the end", &|run| fraction(&run.blocked_fraction)),
        ("Blocked in the first three layers", &|run| fraction(&run.blocked_first_three_layers_fraction)),
        ("Backbone: constrictions on an open path", &|run| fraction(&run.backbone_fraction)),
    ];
    let mut table = Table::of(&rows).name("Mean, and 95 % interval", |row| row.0);
    for run in &outcome.summary {
        table = table.number(run_heading(run.run), move |row| (row.1)(run));
    }
    html! {
        h2 { "Results" }
        (table)
    }
}

fn replicates(outcome: &Outcome) -> Markup {
    let unit = size_unit(outcome.inputs.scale_free);
    let of_known = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), significant);
    let listed = outcome.replicates.len().min(LISTED);
    let rows: Vec<(usize, &Replicate, &Run)> = (1..)
        .zip(outcome.replicates.iter().take(LISTED))
        .flat_map(|(number, replicate)| replicate.runs.iter().map(move |run| (number, replicate, run)))
        .collect();
    let table = Table::of(&rows)
        .class("replicates")
        .name("Replicate", |(number, replicate, _)| format!("{number} (seed {})", replicate.seed))
        .text("Verdict", |(_, replicate, _)| replicate.verdict.words())
        .text("Run", |(.., run)| html! { span class={ "run-" (run.run) } { (run.run) } })
        .number("Eroded, mass", |(.., run)| percent(run.eroded_mass_fraction))
        .number("number", |(.., run)| percent(run.eroded_number_fraction))
        .number(format!("largest ({unit})"), |(.., run)| of_known(run.largest_eroded_mm))
        .number("/ D15F", |(.., run)| of_known(run.largest_eroded_over_d15f))
        .number("Blocked", |(.., run)| percent(run.blocked_fraction))
        .number("3 layers", |(.., run)| percent(run.blocked_first_three_layers_fraction))
        .number("Backbone", |(.., run)| percent(run.backbone_fraction))
        .number("Inserted", |(.., run)| whole(run.inserted))
        .number("Eroded", |(.., run)| whole(run.eroded))
        .number("In constrictions", |(.., run)| whole(run.retained_in_constrictions))
        .number("In voids", |(.., run)| whole(run.retained_in_voids))
        .number("Trapped", |(.., run)| whole(run.trapped))
        .number("Per void", |(.., run)| significant(run.retained_per_void))
        .number("Increments", |(.., run)| whole(run.increments))
        .number("Moves", |(.., run)| whole(run.particle_moves))
        .number("Time", |(.., run)| duration(run.seconds));
    html! {
        details {
            summary {
                "Each replicate (" (listed)
                @if listed < outcome.replicates.len() { " of " (outcome.replicates.len()) } ")"
            }
            (table)
            p.small {
                "Inserted, eroded, in constrictions, in voids and trapped count particles; per void is all \
                 retained "
                "particles over voids; trapped particles are trapped in closed loops."
            }
        }
    }
}

fn sensitivity(outcome: &Outcome) -> Markup {
    let mut table = Table::of(&outcome.sensitivity)
        .number("× N_base", |case| trimmed(case.factor))
        .number("N_base", |case| whole(case.n_base))
        .number("Grains per void", |case| known(case.grains_per_void, significant))
        .number("or mass ratio", |case| known(case.mass_ratio, percent))
        .number("Replicates", |case| case.replicates);
    for (index, run) in outcome.summary.iter().enumerate() {
        let of = move |case: &Sensitivity| case.runs.get(index).map_or_else(|| html! { "–" }, fraction);
        table = table.number(capital(run_name(run.run)), of);
    }
    html! {
        @if !outcome.sensitivity.is_empty() { details {
            summary { "Sensitivity to the number of base particles, in numbers" }
            (table.text("Verdict", |case| case.verdict.words()))
        } }
    }
}

fn inputs(outcome: &Outcome, packing: Option<&PackingRecord>) -> Markup {
    let inputs = &outcome.inputs;
    let (filter, base, network) = (&inputs.filter, &inputs.base, &inputs.network);
    let mm = |value: f64| size(value, inputs.scale_free);
    let kind = match (network.kind, network.nx, network.ny, network.nz) {
        (NetworkKind::Cubic, Some(nx), Some(ny), Some(nz)) => {
            format!("directed cubic lattice, {nx} × {ny} × {nz} voids ({nz} along the flow)")
        }
        (NetworkKind::Connected, Some(nx), Some(ny), Some(nz)) => {
            format!(
                "directed lattice, {nx} × {ny} × {nz} voids ({nz} along the flow), diagonals added and \
                 constrictions deleted"
            )
        }
        (NetworkKind::Cubic | NetworkKind::Connected, ..) => "directed lattice".to_owned(),
        (NetworkKind::File, ..) => "read from a file".to_owned(),
        (NetworkKind::Graph, ..) => "the voids of a packing".to_owned(),
    };
    html! {
        h2 { "Filter thickness and inputs" }
        @match network.thickness_mm {
            Some(thickness) => p {
                "Modelled filter thickness: " b { (mm(thickness)) } " along the flow, "
                (whole(network.layers)) " layers, each D50F by number, " (mm(filter.d50_by_number_mm)) "."
            },
            None => p { "Modelled filter thickness: none in particular, the layers of this network have \
                         none." },
        }
        h3 { "Filter" }
        table.facts { tbody {
            (fact("Name", &filter.name))
            (fact("Cu = D60/D10", known(filter.cu, significant)))
            (fact("D0, D15, D50, D85 (by mass)",
                [filter.d0_mm, filter.d15_mm, filter.d50_mm, filter.d85_mm].map(mm).join(", ")))
            (fact("D50 by number", mm(filter.d50_by_number_mm)))
            @if let Some(packing) = packing {
                (fact("Packing", format!(
                    "{} grains, friction {}, {} kPa, mean coordination number {}, seed {}",
                    whole(packing.grains), significant(packing.friction), significant(packing.pressure_kpa),
                    significant(packing.after.coordination), packing.seed)))
            }
            (fact("Void ratio", known(filter.void_ratio, significant)))
            (fact("Grains per void, N_p/N_voids", known(outcome.grains_per_void, significant)))
            (fact("Constriction curve",
                format!("{}, Cu of the curve {}", filter.curve_name, significant(filter.cu_csd))))
            (fact("Credit for the curve",
                if filter.attribution.is_empty() { "the user’s own" } else { &filter.attribution }))
        } }
        h3 { "Base" }
        table.facts { tbody {
            (fact("Name", &base.name))
            (fact("Cu = D60/D10", known(base.cu, significant)))
            (fact("D0, D15, D50 (by mass)",
                [Some(base.d0_mm), base.d15_mm, base.d50_mm].map(|d| known(d, mm)).join(", ")))
            (fact("D85, D95, D100 (by mass)", [base.d85_mm, base.d95_mm, base.d100_mm].map(mm).join(", ")))
            @if base.tail_mass_fraction > 0.0 {
                (fact("Pan fraction (finer than the finest sieve)",
                    format!("{} by mass; passive, counted by mass only", percent(base.tail_mass_fraction))))
            }
            (fact("D15F/D85B, D15F/D95B", format!("{}, {}", significant(outcome.ratios.d15f_over_d85b),
                significant(outcome.ratios.d15f_over_d95b))))
            (fact("Mass of base over mass of filter", known(inputs.mass_ratio, percent)))
            (fact("Base particles in each run, N_base", format!("{}{}", whole(outcome.n_base),
                if Some(outcome.n_base) == outcome.n_base_eq2 { " (Eq. 2)".to_owned() }
                else { format!(" (Eq. 2 gives {})", known(outcome.n_base_eq2, whole)) })))
            (fact("Inserted in each increment", format!("{} of N_base", percent(inputs.inject_share))))
        } }
        h3 { "Network" }
        table.facts { tbody {
            (fact("Kind", &kind))
            @if !network.name.is_empty() { (fact("Name", &network.name)) }
            (fact("Voids, constrictions", [network.voids, network.constrictions].map(whole).join(", ")))
            (fact("Start nodes, layers", [network.start_nodes, network.layers].map(whole).join(", ")))
        } }
    }
}

fn provenance(folder: &RunFolder) -> Markup {
    let (outcome, manifest) = (&folder.outcome, &folder.manifest);
    let cut = folder.scene.chars().count() > SCENE;
    let scene: String = folder.scene.chars().take(SCENE).filter(|c| *c != '\r').map(visible).collect();
    html! {
        h2 { "How this was made" }
        table.facts { tbody {
            (fact("Seed", outcome.seed.to_string()))
            (fact("voidwalk",
                format!("{} (commit {})", manifest.version, manifest.commit.as_deref().unwrap_or("unknown"))))
            (fact("Engine", &outcome.engine))
            (fact("Command", &manifest.command))
            (fact("Started, finished", format!("{}, {}", manifest.started, manifest.finished)))
            (fact("Wall time", duration(outcome.seconds)))
            (fact("Machine",
                format!("{}, {}, {} threads", manifest.host, manifest.machine, manifest.threads)))
            @for input in &manifest.inputs {
                (fact("Input file", format!("{} (XXH3 {})", input.name, input.xxh3)))
            }
            @if !outcome.left_out.is_empty() {
                (fact("Not needed for this scene", outcome.left_out.join("; ")))
            }
        } }
        details open {
            summary { "scene.toml" }
            pre { (scene) }
            @if cut { p.small { "Cut here; the whole is in scene.toml." } }
            p.small { "Running this scene again gives the same results, bit for bit, on any number of \
                       threads." }
        }
    }
}

fn citation(outcome: &Outcome) -> Markup {
    let attribution = &outcome.inputs.filter.attribution;
    html! {
        (shell::citation())
        @if !attribution.is_empty() { p { "The constriction curve: " (clean(attribution)) } }
        p { "The classes: Foster and Fell, as that paper uses them." }
    }
}
