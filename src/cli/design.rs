//! `voidwalk design`: how coarse a filter may be.

use super::args::DesignArgs;
use super::design_each::design_each;
use super::print::{counted, json, plain, shown, to_stdout};
use super::progress::followed;
use super::specification::{by_option, specification};
use super::values::{of_soils, with_options};
use crate::outcome::design::products::to_be_checked;
use crate::outcome::design::{Boundary, Design, DesignRow, Range, over_networks};
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::with_inches;
use crate::run::{PrepareOptions, RunError};
use crate::scene::About;
use crate::store::format;
use crate::study::design::{self, DesignOptions};
use crate::verdict::DESIGN_AGAIN;
use crate::verdict::FOREMOST;
use crate::verdict::left_out::left_out_in_brief;
use crate::verdict::words::capital;

/// The setting of the sheet besides its cover that a specification takes.
const UNITS: &str = "about.units";

/// Finds the boundaries and writes them into a folder; or the specification by practice alone.
pub fn design(args: &DesignArgs) -> Result<(), RunError> {
    let of_steps = [About::texts(), vec![UNITS.into()]].concat();
    let is_taken = |set: &str| of_steps.iter().any(|name| set.split('=').next().map(str::trim) == Some(name));
    if let Some(other) = args.settings.iter().find(|set| args.steps && !is_taken(set)) {
        let takes = of_steps.join(", ");
        let problem = format!("--steps walks nothing, and takes no other settings than {takes}");
        return Err(RunError::Refused(format!("--set {other}: {problem}")));
    }
    let seed = args.seed.map(|seed| format!("seed={seed}"));
    let [dispersive, _] = of_soils(args.dispersive, None);
    let units = args.units.map(|units| format!("about.units={}", units.name()));
    let settings = with_options(&args.settings, [("--seed", seed), dispersive, ("--units", units)])?;
    if let (true, false, Some(base)) = (args.steps, args.each, &args.base) {
        return specification(args, base, &settings);
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
        inverse: args.inverse,
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
    if let (true, Some(samples)) = (args.each, &args.base) {
        return design_each(args, samples, options);
    }
    let found = followed(args.quiet, |callbacks| design::run(&options, callbacks))?;
    if args.json {
        to_stdout(&json(format::DESIGN, &found)?);
    } else if !args.quiet {
        let page = shown(&out.join("design.html"));
        to_stdout(&format!("{}report: {page}\n", words(&found)));
    }
    Ok(())
}

/// The answer in some lines.
fn words(design: &Design) -> String {
    let mut lines = vec![match design.inverse {
        false => format!("How coarse may the filter be? Base {}, filter {}", design.base.name, design.filter),
        true => format!(
            "How fine may the base be? Filter {}, base {} in any size",
            design.filter, design.base.name
        ),
    }];
    let answer = design.answer();
    let of_base = design.specification.as_ref();
    let dispersive = of_base.and_then(|of| of.if_dispersive_in_words(&by_option(DESIGN_AGAIN)));
    lines.push(answer.limit);
    lines.extend(design.base.size().map(|base| format!("  {}", base.words())));
    let beside = [answer.washout, answer.margin, answer.walk, dispersive].into_iter().flatten();
    lines.extend(beside.map(|said| format!("  {said}.")));
    for row in &design.boundaries {
        lines.extend(of_row(row, design));
    }
    if let Some(of) = &design.specification {
        lines.extend(of.band_in_words().map(|band| format!("band to specify: {band}")));
        lines.extend(of.raised_in_words().map(|raised| format!("  {raised}")));
        lines.extend(of.findings.iter().map(|found| format!("warning: {}", found.words())));
        lines.extend(of.still_to_set());
    }
    lines.extend(design.findings.iter().take(FOREMOST).map(|found| format!("- {}", found.words())));
    if design.findings.len() > FOREMOST {
        lines.push(format!("- and {} more on the page", design.findings.len() - FOREMOST));
    }
    lines.extend(design.products_in_words());
    let sources = design.products.iter().map(|of| (of.name.as_str(), of.source.as_str()));
    lines.extend(to_be_checked(sources));
    lines.push(left_out_in_brief(&design.model_leaves_out));
    lines.push(format!("{:.1} s, {} networks each, seed {}", design.seconds, design.replicates, design.seed));
    let said = |line: String| if design.inches { with_inches(&line) } else { line };
    lines.into_iter().map(|line| plain(&said(line)) + "\n").collect()
}

fn of_row(row: &DesignRow, design: &Design) -> Vec<String> {
    let what = match design.inverse {
        false => ["no erosion up to", "continuing erosion from"],
        true => ["no erosion down to", "continuing erosion below"],
    };
    let boundaries = row.shown().into_iter().zip([&row.no_erosion_note, &row.continuing_note]);
    let networks = row.networks.len() as u64;
    let mut lines = vec![format!("{}, {}, in the model:", row.name(), row.thickness)];
    // The boundary of no erosion is stated as a limit.
    let limit: fn(f64) -> String = if design.inverse { rounded_up } else { rounded_down };
    let sizes = [limit, |mm| format!("{mm:.3}")];
    for ((what, size), (boundary, note)) in what.into_iter().zip(sizes).zip(boundaries) {
        let said = boundary.map(|boundary| ratio(&boundary, networks, design.inverse, size));
        lines.push(match (said, note) {
            (Some(said), Some(note)) => format!("  {what} {said}. {}", capital(note)),
            (Some(said), None) => format!("  {what} {said}"),
            (None, note) => {
                let note = note.as_deref().unwrap_or("It lies beyond the search.");
                format!("  {what}: no number. {}", capital(note))
            }
        });
    }
    if let Some(band) = &row.band {
        let over_range = design.boundaries.iter().any(|end| end.end_of.as_ref() == Some(&row.density));
        let what = match over_range {
            true => "between drainage and retention, over the whole range of this curve",
            false => "between drainage and retention",
        };
        let practice = band.practice_in_words().map(|said| format!("; {said}"));
        lines.push(format!("  {what}: {}{}", band.said, practice.unwrap_or_default()));
    }
    if let Some(note) = &row.band_note {
        lines.push(format!("  no band. {}", capital(note)));
    }
    if row.not_monotone > 0 {
        lines.push(format!(
            "  not monotone on {}: the smallest ratio seen to erode counts",
            counted(row.not_monotone, "network", "networks")
        ));
    }
    lines
}

fn ratio(boundary: &Boundary, networks: u64, inverse: bool, mm: fn(f64) -> String) -> String {
    let between = |low: Option<f64>, high: Option<f64>, words: fn(f64) -> String| {
        let end = |value: Option<f64>| value.map_or("unknown".into(), words);
        over_networks(&format!("{} to {}", end(low), end(high)), networks)
    };
    let Boundary { median, low, high, .. } = boundary;
    let of_networks = |low: Option<f64>, high: Option<f64>, words| match low.or(high) {
        Some(_) => format!(" ({})", between(low, high, words)),
        None => String::new(),
    };
    let size = |name: &str, range: &Range| {
        format!("{name} {} mm{}; ", mm(range.median), of_networks(range.low, range.high, mm))
    };
    let size = match (&boundary.d15f_mm, &boundary.d85b_mm) {
        (Some(range), _) => size("D15F", range),
        (None, Some(range)) if inverse => size("D85B", range),
        _ => String::new(),
    };
    format!("{size}D15F/D85B {median:.2}{}", of_networks(*low, *high, |ratio| format!("{ratio:.3}")))
}
