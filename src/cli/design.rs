//! `voidwalk design`: the specification of a filter, and the boundaries of the model beside it.

use super::args::DesignArgs;
use super::design_each::design_each;
use super::print::{as_it_is, counted, json, plain, shown, to_stdout};
use super::progress::followed;
use super::specification::{by_option, specification};
use super::values::{of_soils, with_options};
use crate::outcome::design::{Boundary, Design, DesignRow, Range};
use crate::outcome::quantity::{NumberRole, SizeUnit, significant};
use crate::outcome::record::Note;
use crate::run::{PrepareOptions, RunError};
use crate::scene::About;
use crate::store::format;
use crate::study::design::{self, DesignOptions};
use crate::words::base_size;
use crate::words::design::{design_lines, over_networks};
use crate::words::left_out::left_out_line;
use crate::words::products::{products, to_be_checked};
use crate::words::specification::{DESIGN_AGAIN, if_dispersive, raised, still_to_set, without_margin};
use crate::words::{FOREMOST, row_note, sentence};

/// The setting of the sheet besides its cover that a specification takes.
const UNITS: &str = "about.units";

/// Finds the boundaries and writes them into a folder; or the specification by practice alone.
pub fn design(args: &DesignArgs) -> Result<(), RunError> {
    let of_steps = [About::texts(), vec![UNITS.into()]].concat();
    let is_taken = |set: &str| of_steps.iter().any(|name| set.split('=').next().map(str::trim) == Some(name));
    let by_practice = args.steps || args.each;
    if let Some(other) = args.settings.iter().find(|set| by_practice && !is_taken(set)) {
        let takes = of_steps.join(", ");
        let option = if args.each { "--each" } else { "--steps" };
        let problem = format!("{option} walks nothing, and takes no other settings than {takes}");
        return Err(RunError::Refused(format!("--set {other}: {problem}")));
    }
    let seed = args.seed.map(|seed| format!("seed={seed}"));
    let [dispersive, _] = of_soils(args.dispersive, None);
    let units = args.units.map(|units| format!("about.units={}", units.name()));
    let settings = with_options(&args.settings, [("--seed", seed), dispersive, ("--units", units)])?;
    match &args.base {
        Some(samples) if args.each => return design_each(args, samples, &settings),
        Some(base) if args.steps => return specification(args, base, &settings),
        Some(_) | None => {}
    }
    let out = args.out.clone().unwrap_or_else(|| DesignOptions::default().out);
    let options = DesignOptions {
        base: args.base.clone(),
        filter: args.filter.clone(),
        densities: args.densities.clone(),
        pack: args.pack,
        thicknesses: args.thicknesses.iter().flat_map(|list| list.0.clone()).collect(),
        settings,
        as_sampled: args.as_sampled,
        as_given: args.as_given,
        bracket: [args.bracket.0, args.bracket.1],
        sieves: args.sieves,
        out: out.clone(),
        overwrite: args.overwrite,
        prepare: PrepareOptions {
            packings: args.packings.clone(),
            memory: args.memory,
            threads: args.threads,
        },
    };
    let found = followed(args.quiet, |callbacks| design::run(&options, callbacks))?;
    if args.json {
        as_it_is(&json(format::DESIGN, &found)?);
    } else if !args.quiet {
        let page = shown(&out.join("design.html"));
        to_stdout(&format!("{}report: {page}\n", words(&found)));
    }
    Ok(())
}

/// The lines of practice, then those of the model.
fn words(design: &Design) -> String {
    let asked = "How coarse may the filter be?";
    let mut lines = vec![format!("{asked} Base {}, filter {}", design.base.name, design.filter)];
    let unit = SizeUnit::of(false, design.inches);
    let of_model = design_lines(design, unit);
    let (model, practice) = of_model.split_last().expect("a line of the model");
    lines.extend(practice.iter().map(|(name, words)| format!("{name}: {words}")));
    if let Some(of) = &design.specification {
        lines.extend(raised(of, unit).map(|raised| format!("  {raised}")));
        let dispersive = if_dispersive(of, &by_option(DESIGN_AGAIN), unit);
        let beside = without_margin(of, unit).into_iter().chain(dispersive);
        lines.extend(beside.map(|said| format!("  {said}.")));
        lines.extend(of.notes.iter().map(|row| format!("warning: {}", row_note(row, unit))));
        lines.extend(still_to_set(of, unit));
        lines.push(products(of));
        lines.extend(to_be_checked(&of.products));
    }
    lines.push(format!("{}: {}", model.0, model.1));
    lines.extend(design.base.size().map(|base| format!("  {}", base_size(&base, unit))));
    lines.extend(design.boundaries.iter().flat_map(|row| of_row(row, unit)));
    lines.extend(design.notes.iter().take(FOREMOST).map(|row| format!("- {}", row_note(row, unit))));
    if design.notes.len() > FOREMOST {
        lines.push(format!("- and {} more on the page", design.notes.len() - FOREMOST));
    }
    lines.push(left_out_line(&design.model_leaves_out));
    lines.push(format!("{:.1} s, {} networks each, seed {}", design.seconds, design.replicates, design.seed));
    lines.iter().map(|line| plain(line) + "\n").collect()
}

fn of_row(row: &DesignRow, unit: SizeUnit) -> Vec<String> {
    let words = |notes: &[Note]| notes.iter().map(|note| sentence(note, unit)).collect::<Vec<_>>().join(" ");
    let what = ["no erosion up to", "continuing erosion from"];
    let boundaries =
        row.shown().into_iter().zip([words(&row.no_erosion_notes), words(&row.continuing_notes)]);
    let networks = row.networks.len() as u64;
    let mut lines = vec![format!("{}, {}, in the model:", row.name(), row.thickness)];
    // The boundary of no erosion is stated as a limit.
    let sizes: [fn(f64) -> String; 2] =
        [|mm| significant(mm).role(NumberRole::Greatest).number(), |mm| format!("{mm:.3}")];
    for ((what, size), (boundary, note)) in what.into_iter().zip(sizes).zip(boundaries) {
        let said = boundary.map(|boundary| ratio(&boundary, networks, size));
        lines.push(match (said, &*note) {
            (Some(said), "") => format!("  {what} {said}"),
            (Some(said), note) => format!("  {what} {said}. {note}"),
            (None, "") => format!("  {what}: no number. It lies beyond the search."),
            (None, note) => format!("  {what}: no number. {note}"),
        });
    }
    if row.not_monotone > 0 {
        lines.push(format!(
            "  not monotone on {}: the smallest ratio seen to erode counts",
            counted(row.not_monotone, "network", "networks")
        ));
    }
    lines
}

fn ratio(boundary: &Boundary, networks: u64, mm: fn(f64) -> String) -> String {
    let between = |low: Option<f64>, high: Option<f64>, words: fn(f64) -> String| {
        let end = |value: Option<f64>| value.map_or("unknown".into(), words);
        over_networks(&format!("{} to {}", end(low), end(high)), networks)
    };
    let Boundary { median, low, high, .. } = boundary;
    let of_networks = |low: Option<f64>, high: Option<f64>, words| match low.or(high) {
        Some(_) => format!(" ({})", between(low, high, words)),
        None => String::new(),
    };
    let size =
        |range: &Range| format!("D15F {} mm{}; ", mm(range.median), of_networks(range.low, range.high, mm));
    let size = boundary.d15f_mm.as_ref().map_or_else(String::new, size);
    format!("{size}D15F/D85B {median:.2}{}", of_networks(*low, *high, |ratio| format!("{ratio:.3}")))
}
