//! Page of a run.

use super::files::{ReportError, json_of};
use super::first_page::{answer, in_short, rules, sizes, sources};
use super::folder::{RunFolder, checked, walks};
use super::names::{brief_name, file_name, is_named, soil_name};
use super::results::{by_connectivity, infiltration, replicates, results, varied};
use super::section::{Written, write_page};
use super::shell::{Drawn, clean, drawing, fact, leaves_out, page_with_foot, unbroken};
use super::table::{counts, known};
use super::walks::{RunRows, Walks};
use super::{first_page, packing, results, run_figures, shell, soils};
use crate::outcome::packing::PackingRecord;
use crate::outcome::record::{NetworkKind, Outcome, Stopping};
use crate::outcome::verdict::UndecidedBy;
use crate::verdict::RunFiles;
use crate::words::left_out::left_out_words;
use crate::words::{capital, first_lines, foremost, grading, sentence, undecided_by};
use maud::{Markup, html};
use std::path::Path;
use voidwalk_core::text::visible;
use voidwalk_practice::Note;
use voidwalk_practice::quantity::{SizeUnit, length, percent, significant, whole};

/// Maximum number of characters of `scene.toml` shown.
const SCENE: usize = 100_000;

/// Writes `report.html` and `figures/*.svg` into a finished run folder.
///
/// Each file appears complete or not at all, and replaces an older one of the same name.
///
/// # Errors
/// [`ReportError`] names the file that is missing, malformed or contradicts another, with line and field if
/// known. Nothing is written then.
pub fn write(folder: &Path) -> Result<Written, ReportError> {
    let (page, figures) = drawn(&RunFolder::read(folder)?);
    write_page(folder, "report.html", &figures, &page)
}

/// Writes the page of a run that was just walked, like [`write()`] but without reading its files.
pub(crate) fn write_walked(folder: &Path, files: RunFiles) -> Result<Written, ReportError> {
    let (page, figures) = drawn(&RunFolder::from_files(folder, files)?);
    write_page(folder, "report.html", &figures, &page)
}

/// Page of a run whose files would have this content; writes nothing. Errors give the names that the files
/// would have.
pub fn run_page(files: RunFiles) -> Result<String, ReportError> {
    Ok(drawn(&RunFolder::from_files(Path::new(""), files)?).0)
}

/// Verdict of a run whose `outcome.json` holds this text, as a fragment of a page: its numbers, a figure, the
/// omissions of the model. A malformed text is an error.
pub fn run_brief(outcome: &str) -> Result<String, ReportError> {
    let path = Path::new("outcome.json");
    let outcome = checked(path, json_of(path, outcome)?)?;
    let rows = RunRows::default();
    let walks = walks(&outcome, &rows);
    let lines = first_lines(&outcome, &outcome.decision(), SizeUnit::Mm);
    let (meaning, notes) = (in_words(&outcome, &walks), foremost(&outcome).0);
    Ok(results::brief(&walks, &lines, &meaning, notes, replicate(&outcome), &outcome.model_leaves_out))
}

/// Words for the only replicate of a run, or for each of several. Replicates of the ends of a range of
/// constrictions are not counted.
fn replicate(outcome: &Outcome) -> [&'static str; 2] {
    match outcome.curve_range {
        Some(_) => [
            "one network, one walk, of the curve itself",
            "a new network and a new walk, of the curve itself",
        ],
        None => ["one network, one walk", "a new network and a new walk"],
    }
}

fn drawn(run: &RunFolder) -> (String, Vec<Drawn>) {
    let walks = run.walks();
    let verdict = run_figures::verdict(&walks);
    let gradations = run_figures::gradations(run);
    let of_walks = [run_figures::eroded, run_figures::layers, run_figures::retained].map(|draw| draw(&walks));
    let slice = run.packing.as_ref().map(packing::slice);
    let figures: Vec<Drawn> = of_walks.into_iter().chain([slice]).flatten().collect();
    let page = page(run, [&verdict, &gradations], &figures);
    (page, [verdict, gradations].into_iter().chain(figures).collect())
}

/// Page as text. `gradations` is on its first sheet, followed by `verdict` and `figures`.
fn page(folder: &RunFolder, [verdict, gradations]: [&Drawn; 2], figures: &[Drawn]) -> String {
    let RunFolder { outcome, decision, .. } = folder;
    let (filter, base) = (&outcome.inputs.filter, &outcome.inputs.base);
    let (unit, walks) = (folder.about.unit, &folder.walks());
    let soil = |name: &str| brief_name(soil_name(name));
    let title = match is_named("base", &base.name) || is_named("filter", &filter.name) {
        true => format!("{} on {}", soil(&base.name), soil(&filter.name)),
        false => first_page::QUESTION.to_owned(),
    };
    let main = html! {
        section.sheet {
            (answer(outcome, decision, unit))
            (shell::figure(1, gradations))
            div.pair { (in_short(outcome, decision, unit)) (sizes(outcome, unit)) }
        }
        (shell::contents())
        @if !outcome.notes.is_empty() {
            h2 { "Notes" }
            ul { @for note in &outcome.notes { li { (unbroken(&sentence(note, unit))) } } }
        }
        (walk(outcome, walks, verdict))
        (leaves_out(&outcome.model_leaves_out, &html! {
            @if outcome.model_leaves_out.is_empty() { p { "outcome.json does not say." } }
            p { "The model does not replace a filter test or a designer’s judgement." }
        }))
        (rules(decision, unit))
        // Parts that are not for a client appear on screen only.
        section.screen {
            h2 { "Figures" }
            @for (number, drawn) in (2..).zip(figures) { (shell::figure(number, drawn)) }
            (missing(folder, figures))
            (results(walks))
            (infiltration(outcome, walks.unit))
            (by_connectivity(walks))
            (replicates(walks))
            (varied(outcome))
            (inputs(outcome, folder.packing.as_ref(), walks.unit))
        }
        (soils::of_run(outcome, unit))
        (sources(decision))
        (provenance(folder, unit))
    };
    let foot = shell::foot(&folder.about.cover);
    page_with_foot(foot.as_deref(), &title, [&first_page::header(folder), &main, &citation(outcome)])
}

/// Void ratio of the filter: the given one, or else the one in the library.
fn void_ratio(outcome: &Outcome) -> String {
    let is_given = !outcome.notes.iter().any(|note| matches!(note, Note::LibraryOfAnyDensity { .. }));
    match outcome.inputs.filter.void_ratio {
        Some(ratio) if !is_given => {
            format!("not given; {} is that of the packing of the library", significant(ratio))
        }
        ratio => known(ratio, significant),
    }
}

/// Result of the walk: its class, the mass eroded, and why it is undecided, if it is.
fn walk(outcome: &Outcome, walks: &Walks, verdict: &Drawn) -> Markup {
    html! {
        h2 { "What the model found" }
        (shell::model())
        p.lead { b { (capital(outcome.model.class.words())) } ". " (in_words(outcome, walks)) }
        div.drawn { (drawing(verdict)) }
        (results::eroded_table(walks))
        @if let Some(stopping) = &outcome.stopping { p { (stopped(stopping)) } }
        (results::replicates_in_words(walks, replicate(outcome)))
    }
}

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
    text += if stopping.met { "That was reached." } else { "That was not reached." };
    text
}

fn in_words(outcome: &Outcome, walks: &Walks) -> String {
    match outcome.undecided_by() {
        Some(open @ UndecidedBy::Curve) => format!("Inconclusive: {}.", undecided_by(open)),
        _ => results::in_words(walks),
    }
}

fn missing(folder: &RunFolder, figures: &[Drawn]) -> Markup {
    let has = |name: &str| figures.iter().any(|drawn| drawn.name == name);
    let reasons = [
        ("eroded", "series.csv has no rows: the progress of erosion is not drawn."),
        ("layers", "layers.csv has no rows: blocking by layer is not drawn."),
        (
            "retained",
            "retained.csv and eroded.csv have no rows for the first run: size curves are not drawn.",
        ),
    ];
    html! {
        @for (name, reason) in reasons {
            @if !has(name) { p.small { (reason) } }
        }
        @if has("eroded")
            && folder.rows.series.len() != folder.outcome.replicates.len() * folder.outcome.summary.len()
        {
            p.small { "series.csv does not hold every replicate and run: the mean is over those that it \
                       holds." }
        }
    }
}

fn inputs(outcome: &Outcome, packing: Option<&PackingRecord>, unit: SizeUnit) -> Markup {
    let inputs = &outcome.inputs;
    let grading = inputs.base_size().map_or(String::new(), |base| format!(", {}", grading(&base)));
    let (filter, base, network) = (&inputs.filter, &inputs.base, &inputs.network);
    let mm = |value: f64| length(value, unit).to_string();
    let kind = match (network.kind, network.nx, network.ny, network.nz) {
        (NetworkKind::Cubic, Some(nx), Some(ny), Some(nz)) if outcome.network.is_some() => {
            format!(
                "cubic lattice, {nx} × {ny} × {nz} voids ({nz} along the flow), where the flow of water \
                 gives each constriction its direction"
            )
        }
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
        h2 { "Inputs" }
        details {
            summary { "Filter, base and network as walked" }
            h3 { "Filter" }
            table.facts { tbody {
                (fact("Name", file_name(&filter.name)))
                (fact("Cu = D60/D10", known(filter.cu, significant)))
                (fact("D0, D15, D50, D85 (by mass)",
                    [filter.d0_mm, filter.d15_mm, filter.d50_mm, filter.d85_mm].map(mm).join(", ")))
                (fact("D50 by number", mm(filter.d50_by_number_mm)))
                @if let Some(packing) = packing {
                    (fact("Packing", format!(
                        "{} grains, friction {}, {} kPa, mean coordination number {}, seed {}",
                        whole(packing.grains), significant(packing.friction),
                        significant(packing.pressure_kpa), significant(packing.after.coordination),
                        packing.seed)))
                }
                (fact("Void ratio", void_ratio(outcome)))
                (fact("Grains per void, N_p/N_voids", known(outcome.grains_per_void, significant)))
                (fact("Constriction curve",
                    format!("{}; uniformity of its sizes, Dc60/Dc10 by number, {}", filter.curve_name,
                        significant(filter.cu_csd))))
                (fact("Credit for the curve",
                    if filter.attribution.is_empty() { "the user’s own" } else { &filter.attribution }))
            } }
            h3 { "Base" }
            table.facts { tbody {
                (fact("Name", file_name(&base.name)))
                (fact("Cu = D60/D10", known(base.cu, significant)))
                (fact("D0, D15, D50 (by mass)",
                    [Some(base.d0_mm), base.d15_mm, base.d50_mm].map(|d| known(d, mm)).join(", ")))
                (fact(&format!("D85, D95, D100 (by mass){grading}"),
                    [base.d85_mm, base.d95_mm, base.d100_mm].map(mm).join(", ")))
                @if let Some(before) = &base.as_sampled {
                    (fact("D85, D95, D100 as sampled (not walked)",
                        [before.d85_mm, before.d95_mm, Some(before.d100_mm)]
                            .map(|d| known(d, mm)).join(", ")))
                }
                @if base.tail_mass_fraction > 0.0 {
                    (fact("Pan fraction (finer than the finest sieve)",
                        format!("{} by mass; taken as too fine to block any constriction (passive)",
                            percent(base.tail_mass_fraction))))
                }
                (fact(&format!("D15F/D85B, D15F/D95B{grading}"), format!("{}, {}",
                    significant(outcome.ratios.d15f_over_d85b), significant(outcome.ratios.d15f_over_d95b))))
                (fact("Mass of base over mass of filter", known(inputs.mass_ratio, percent)))
                (fact("Base particles in each run, N_base", format!("{}{}", whole(outcome.n_base),
                    if Some(outcome.n_base) == outcome.n_base_eq2 { " (Eq. 2)".to_owned() }
                    else { format!(" (Eq. 2 gives {})", known(outcome.n_base_eq2, whole)) })))
                (fact("Inserted in each increment", format!("{} of N_base", percent(inputs.inject_share))))
            } }
            h3 { "Network" }
            table.facts { tbody {
                (fact("Kind", &kind))
                @if !network.name.is_empty() { (fact("Name", file_name(&network.name))) }
                (fact("Voids, constrictions", counts([network.voids, network.constrictions])))
                (fact("Start nodes, layers", counts([network.start_nodes, network.layers])))
                (fact("Thickness modelled", known(network.thickness_mm, mm)))
            } }
        }
    }
}

fn provenance(folder: &RunFolder, unit: SizeUnit) -> Markup {
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
            @if !outcome.digest.is_empty() { (fact("Digest of the numbers", &outcome.digest)) }
            (soils::input_files(&manifest.inputs))
        } }
        div.screen {
            @if !outcome.left_out.is_empty() {
                table.facts { tbody {
                    (fact("Not needed here", left_out_words(&outcome.left_out, unit.short())))
                } }
            }
            details {
                summary { "Settings (scene.toml)" }
                pre { (scene) }
                @if cut { p.small { "Cut here; the whole is in scene.toml." } }
                p.small { "The same settings give the same results, bit for bit. Machine, command and times \
                           are in manifest.json." }
            }
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
