//! The page of a run.

use maud::{Markup, html};

use super::connectivity::by_connectivity;
use super::figures::{shorten, visible};
use super::folder::RunFolder;
use super::infiltration::infiltration;
use super::numbers::{
    duration, interval, known, percent, percent_interval, significant, size, threshold, whole,
};
use super::rules::rules;
use super::run_figures::{run_name, trimmed};
use super::shell::{Drawn, clean, drawing, fact, figure, whole_page};
use crate::outcome::packing::PackingRecord;
use crate::outcome::record::{NetworkKind, Outcome, Run, RunSummary, Statistic, Stopping, Verdict};

/// Replicates listed one by one; all are in `outcome.json`.
const LISTED: usize = 100;

/// Characters of `scene.toml` that are shown.
const SCENE: usize = 100_000;

/// The page as text. `verdict` stands beside the verdict, `figures` below it.
pub(super) fn page(folder: &RunFolder, verdict: &Drawn, figures: &[Drawn]) -> String {
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
        p.names { "Base " b { bdi { (clean(&base.name)) } } " against filter " b { bdi { (clean(&filter.name)) } } }
    };
    let main = html! {
        div.first {
            (verdict_box(outcome, verdict))
            aside.leaves {
                h2 { "What the model leaves out" }
                @if outcome.model_leaves_out.is_empty() { p { "outcome.json does not say." } }
                ul { @for item in &outcome.model_leaves_out { li { (clean(item)) } } }
                p { "The verdict is the model’s. It does not replace a filter test or a designer’s judgement." }
            }
        }
        (warnings(outcome))
        h2 { "Figures" }
        @for (index, drawn) in figures.iter().enumerate() { (figure(index + 1, drawn)) }
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
    let (class, word) = match outcome.verdict {
        Verdict::None => ("none", "No erosion"),
        Verdict::Some => ("some", "Some erosion"),
        Verdict::Continuing => ("continuing", "Continuing erosion"),
        Verdict::Undecided => ("undecided", "Undecided"),
    };
    let count = outcome.replicates.len();
    html! {
        section.verdict.(class) {
            p.word { (word) }
            p.lead { (in_words(outcome)) }
            div { (drawing(verdict)) }
            table {
                thead { tr { th { "Base eroded, by mass" } th.n { "mean" } th.n { "95 % interval" } } }
                tbody { @for run in &outcome.summary {
                    tr {
                        th { span class={ "run-" (run.run) } { (capital(run_name(run.run))) } }
                        td.n { (percent(run.eroded_mass_fraction.mean)) }
                        td.n { (percent_interval(&run.eroded_mass_fraction).unwrap_or_else(|| "none".to_owned())) }
                    }
                } }
            }
            @if let Some(stopping) = &outcome.stopping { p { (stopped(stopping)) } }
            p { (tally(outcome)) " Threshold between the classes: " (threshold(outcome.threshold)) "." }
            @if count == 1 {
                p { b { "One replicate: the scatter is unknown." } " Walk more replicates before relying on this." }
            }
        }
    }
}

/// What the rule that added replicates came to.
fn stopped(stopping: &Stopping) -> String {
    let mut text = String::new();
    if let Some(percent) = stopping.decide_percent {
        text += &format!("Replicates were added until the verdict would be right with {percent} %. ");
    }
    if let Some(pp) = stopping.target_error_pp {
        text += &format!("Replicates were added until the error would be {pp} percentage points. ");
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
            "In the model the filter seals after some erosion: {limit} or more of the base passes in the first run, less \
             in the second, on the constrictions that the first left blocked."
        ),
        Verdict::Continuing => format!(
            "In the model the filter does not hold this base: {limit} or more of its mass passes in the first run and \
             again in the second."
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
                format!(
                    "The {plural}{} includes {limit}: these replicates cannot tell the classes apart.",
                    runs.join(" and the ")
                )
            } else if outcome.summary.len() == 1 {
                "Only a first run was asked for: it cannot tell some erosion from continuing erosion."
                    .to_owned()
            } else {
                "These replicates cannot tell the classes apart.".to_owned()
            }
        }
    }
}

/// How the replicates voted.
fn tally(outcome: &Outcome) -> String {
    let count = outcome.replicates.len();
    if count == 1 {
        return "1 replicate (one network, one walk).".to_owned();
    }
    let classes = [Verdict::None, Verdict::Some, Verdict::Continuing, Verdict::Undecided];
    let votes = classes.into_iter().filter_map(|class| {
        let votes = outcome.replicates.iter().filter(|replicate| replicate.verdict == class).count();
        let of = if votes == count { "all".to_owned() } else { votes.to_string() };
        (votes > 0).then(|| format!("{} in {of}", class.words()))
    });
    format!(
        "{count} replicates, each a new network and a new walk: {}.",
        votes.collect::<Vec<_>>().join(", ")
    )
}

fn warnings(outcome: &Outcome) -> Markup {
    html! {
        @if !outcome.warnings.is_empty() || outcome.capped {
            section.warnings {
                h2 { "Before you rely on this" }
                ul {
                    @if outcome.capped {
                        li {
                            "A cap cut the number of base particles from " (known(outcome.n_base_eq2, whole)) " (Eq. 2) to "
                            (whole(outcome.n_base)) "."
                        }
                    }
                    @for warning in &outcome.warnings { li { (clean(warning)) } }
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
        @if folder.series.len() as u64 != folder.outcome.replicates.len() as u64 * folder.outcome.summary.len() as u64
            && has("eroded")
        {
            p.small { "series.csv does not hold every replicate and run: the mean is over those that it holds." }
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
    let (filter, scale_free) = (&outcome.inputs.filter, outcome.inputs.scale_free);
    let sd = |statistic: &Statistic| statistic.sd.map_or_else(|| "none".to_owned(), percent);
    let row = |name: &str, cell: &dyn Fn(&RunSummary) -> Markup| {
        html! { tr { th { (name) } @for run in &outcome.summary { td.n { (cell(run)) } } } }
    };
    html! {
        h2 { "Results" }
        table {
            thead { tr {
                th { "Mean, and 95 % interval" }
                @for run in &outcome.summary { th.n { span class={ "run-" (run.run) } { (capital(run_name(run.run))) } } }
            } }
            tbody {
                (row("Base eroded, by mass", &|run| fraction(&run.eroded_mass_fraction)))
                (row("its standard deviation between replicates", &|run| html! { (sd(&run.eroded_mass_fraction)) }))
                (row("Base eroded, by number", &|run| fraction(&run.eroded_number_fraction)))
                (row("Largest particle eroded, over D15F", &|run| match &run.largest_eroded_over_d15f {
                    Some(statistic) => {
                        let ends = statistic.low.zip(statistic.high);
                        let ends = ends.map(|(low, high)| format!("{} to {}", significant(low), significant(high)));
                        with_interval(significant(statistic.mean), ends)
                    }
                    None => html! { "nothing eroded" },
                }))
                (row("Largest particle eroded", &|run| match &run.largest_eroded_over_d15f {
                    Some(statistic) => html! { (size(statistic.mean * filter.d15_mm, scale_free)) },
                    None => html! { "nothing eroded" },
                }))
                (row("Constrictions blocked at the end", &|run| fraction(&run.blocked_fraction)))
                (row("the same, in the first three layers", &|run| fraction(&run.blocked_first_three_layers_fraction)))
                (row("Backbone: constrictions on an open path", &|run| fraction(&run.backbone_fraction)))
            }
        }
    }
}

fn replicates(outcome: &Outcome) -> Markup {
    let scale_free = outcome.inputs.scale_free;
    let unit = super::numbers::size_unit(scale_free);
    let listed = outcome.replicates.len().min(LISTED);
    let cells = |run: &Run| {
        html! {
            td.n { (percent(run.eroded_mass_fraction)) }
            td.n { (percent(run.eroded_number_fraction)) }
            td.n { (run.largest_eroded_mm.map_or_else(|| "–".to_owned(), significant)) }
            td.n { (run.largest_eroded_over_d15f.map_or_else(|| "–".to_owned(), significant)) }
            td.n { (percent(run.blocked_fraction)) }
            td.n { (percent(run.blocked_first_three_layers_fraction)) }
            td.n { (percent(run.backbone_fraction)) }
            td.n { (whole(run.inserted)) }
            td.n { (whole(run.eroded)) }
            td.n { (whole(run.retained_in_constrictions)) }
            td.n { (whole(run.retained_in_voids)) }
            td.n { (whole(run.trapped)) }
            td.n { (significant(run.retained_per_void)) }
            td.n { (whole(run.increments)) }
            td.n { (whole(run.particle_moves)) }
            td.n { (duration(run.seconds)) }
        }
    };
    html! {
        details {
            summary { "Each replicate (" (listed) @if listed < outcome.replicates.len() { " of " (outcome.replicates.len()) } ")" }
            div.scroll { table.replicates {
                thead { tr {
                    th { "Replicate" } th { "Verdict" } th { "Run" }
                    th.n { "Eroded, mass" } th.n { "number" } th.n { "largest (" (unit) ")" } th.n { "/ D15F" }
                    th.n { "Blocked" } th.n { "3 layers" } th.n { "Backbone" } th.n { "Inserted" } th.n { "Eroded" }
                    th.n { "In constrictions" } th.n { "In voids" } th.n { "Trapped" } th.n { "Per void" }
                    th.n { "Increments" } th.n { "Moves" } th.n { "Time" }
                } }
                tbody { @for (index, replicate) in outcome.replicates.iter().take(LISTED).enumerate() {
                    @for run in &replicate.runs {
                        tr {
                            th { (index + 1) " (seed " (replicate.seed) ")" }
                            td { (replicate.verdict.words()) }
                            td { span class={ "run-" (run.run) } { (run.run) } }
                            (cells(run))
                        }
                    }
                } }
            } }
            p.small {
                "Inserted, eroded, in constrictions, in voids and trapped count particles; per void is all retained "
                "particles over voids; trapped particles would circle for ever."
            }
        }
    }
}

fn sensitivity(outcome: &Outcome) -> Markup {
    html! {
        @if !outcome.sensitivity.is_empty() { details {
            summary { "Sensitivity to the number of base particles, in numbers" }
            div.scroll { table {
                thead { tr {
                    th.n { "× N_base" } th.n { "N_base" } th.n { "Grains per void" } th.n { "or mass ratio" }
                    th.n { "Replicates" } @for run in &outcome.summary { th.n { (capital(run_name(run.run))) } } th { "Verdict" }
                } }
                tbody { @for case in &outcome.sensitivity {
                    tr {
                        td.n { (trimmed(case.factor)) }
                        td.n { (whole(case.n_base)) }
                        td.n { (known(case.grains_per_void, significant)) }
                        td.n { (known(case.mass_ratio, percent)) }
                        td.n { (case.replicates) }
                        @for (index, _) in outcome.summary.iter().enumerate() {
                            td.n { @if let Some(run) = case.runs.get(index) {
                                (fraction(run))
                            } @else { "–" } }
                        }
                        td { (case.verdict.words()) }
                    }
                } }
            } }
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
                "directed lattice, {nx} × {ny} × {nz} voids ({nz} along the flow), diagonals added and constrictions deleted"
            )
        }
        (NetworkKind::Cubic | NetworkKind::Connected, ..) => "directed lattice".to_owned(),
        (NetworkKind::File, ..) => "read from a file".to_owned(),
    };
    html! {
        h2 { "Filter thickness and inputs" }
        @match network.thickness_mm {
            Some(thickness) => p {
                "The network stands for " b { (mm(thickness)) } " of filter along the flow: " (whole(network.layers))
                " layers, each D50F by number, " (mm(filter.d50_by_number_mm)) "."
            },
            None => p { "The network stands for no particular thickness of filter: its layers have none." },
        }
        h3 { "Filter" }
        table.facts { tbody {
            (fact("Name", &filter.name))
            (fact("Cu = D60/D10", known(filter.cu, significant)))
            (fact("D0, D15, D50, D85 (by mass)",
                [filter.d0_mm, filter.d15_mm, filter.d50_mm, filter.d85_mm].map(mm).join(", ")))
            (fact("D50 by number", mm(filter.d50_by_number_mm)))
            @if let Some(packing) = packing {
                (fact("Packing", format!("{} grains, friction {}, {} kPa, {} contacts of a grain, seed {}", whole(packing.grains),
                    significant(packing.friction), significant(packing.pressure_kpa), significant(packing.after.coordination), packing.seed)))
            }
            (fact("Void ratio", filter.void_ratio.map_or_else(|| "not given".to_owned(), significant)))
            (fact("Grains per void, N_p/N_voids", known(outcome.grains_per_void, significant)))
            (fact("Constriction curve", format!("{}, Cu of the curve {}", filter.curve_name, significant(filter.cu_csd))))
            (fact("Credit for the curve", if filter.attribution.is_empty() { "the user’s own" } else { &filter.attribution }))
        } }
        h3 { "Base" }
        table.facts { tbody {
            (fact("Name", &base.name))
            (fact("Cu = D60/D10", known(base.cu, significant)))
            (fact("D0, D15, D50 (by mass)", [Some(base.d0_mm), base.d15_mm, base.d50_mm].map(|d| known(d, mm)).join(", ")))
            (fact("D85, D95, D100 (by mass)", [base.d85_mm, base.d95_mm, base.d100_mm].map(mm).join(", ")))
            @if base.tail_mass_fraction > 0.0 {
                (fact("Finer than the finest sieve", format!("{} by mass; taken as passive, counted by mass only",
                    percent(base.tail_mass_fraction))))
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
            (fact("Voids, constrictions", format!("{}, {}", whole(network.voids), whole(network.constrictions))))
            (fact("Start nodes, layers", format!("{}, {}", whole(network.start_nodes), whole(network.layers))))
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
            (fact("voidwalk", format!("{} (commit {})", manifest.version, manifest.commit.as_deref().unwrap_or("unknown"))))
            (fact("Engine", &outcome.engine))
            (fact("Command", &manifest.command))
            (fact("Started, finished", format!("{}, {}", manifest.started, manifest.finished)))
            (fact("Wall time", duration(outcome.seconds)))
            (fact("Machine", format!("{}, {}, {} threads", manifest.host, manifest.machine, manifest.threads)))
            @for input in &manifest.inputs { (fact("Input file", format!("{} (XXH3 {})", input.name, input.xxh3))) }
            @if !outcome.left_out.is_empty() { (fact("Not needed for this scene", outcome.left_out.join("; "))) }
        } }
        details open {
            summary { "scene.toml" }
            pre { (scene) }
            @if cut { p.small { "Cut here; the whole is in scene.toml." } }
            p.small { "Running this scene again gives the same results, bit for bit, on any number of threads." }
        }
    }
}

fn citation(outcome: &Outcome) -> Markup {
    let attribution = &outcome.inputs.filter.attribution;
    html! {
        h2 { "How to cite" }
        p {
            "The model: Shire and O’Sullivan, " cite { "A network model to assess base-filter combinations" }
            ", Computers and Geotechnics."
        }
        @if !attribution.is_empty() { p { "The constriction curve: " (clean(attribution)) } }
        p { "The classes: Foster and Fell, as that paper uses them." }
    }
}

fn capital(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}
