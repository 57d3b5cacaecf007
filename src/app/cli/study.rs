//! Commands `voidwalk design`, `boundary` and `percolation`: specifications by practice, for one base or for
//! many samples; the boundaries of the model; and the percolation threshold against the size of the lattice.

use std::path::Path;

use super::args::{BoundaryArgs, DesignArgs, PercolationArgs};
use super::options::{CommandSettings, OfSpecification};
use super::print::{self, answer, counted, shown};
use super::progress::{followed, unfollowed};
use super::rules::{aligned, in_notes};
use crate::outcome::boundary::{Boundaries, Boundary, BoundaryRow, Range};
use crate::outcome::percolation::PercolationStudy;
use crate::run::{PrepareOptions, RunError};
use crate::scene::{About, Scene};
use crate::study::boundary::{self, BoundaryOptions};
use crate::study::percolation::{self, PercolationOptions, PercolationPlan};
use crate::study::specified::{SpecifyOptions, specify, specify_each};
use crate::words::boundary::{held, over_networks, row_name};
use crate::words::designed::{columns, lines};
use crate::words::left_out::left_out_line;
use crate::words::products::{products, to_be_checked};
use crate::words::specification::{
    DESIGN_AGAIN, DESIGN_EACH_AGAIN, band, if_dispersive, limit, no_band, raised, still_to_set,
    without_margin,
};
use crate::words::{FOREMOST, base_size, row_note, sentence};
use voidwalk_core::schema::setting_name;
use voidwalk_core::store::format;
use voidwalk_practice::design::Specification;
use voidwalk_practice::quantity::{NumberRole, SizeUnit, significant};
use voidwalk_practice::{DesignedSamples, Note};

pub(crate) fn design(args: &DesignArgs) -> Result<(), RunError> {
    let takes = [About::texts(), OfSpecification::OPTIONS.iter().map(ToString::to_string).collect()].concat();
    let settings = &args.settings.assignments;
    let is_taken = |set: &str| takes.iter().any(|name| setting_name(set) == name);
    if let Some(other) = settings.iter().find(|set| !is_taken(set)) {
        let problem =
            format!("a specification walks nothing, and takes no other settings than {}", takes.join(", "));
        return Err(RunError::Refused(format!("--set {other}: {problem}")));
    }
    let scene = Scene::built_in(settings)?;
    let about = &scene.about;
    let folder = if args.each { "voidwalk-designs" } else { "voidwalk-specification" };
    let options = SpecifyOptions {
        bases: args.bases.clone(),
        dispersive: scene.base.dispersive == Some(true),
        finer: args.finer,
        sieves: args.sieves,
        cover: about.cover(),
        inches: about.shows_inches(),
        out: args.out.clone().unwrap_or_else(|| folder.into()),
        overwrite: args.overwrite,
    };
    if args.each {
        let all = followed(args.quiet, |callbacks| specify_each(&options, callbacks))?;
        return answer((args.json, args.quiet), format::DESIGNS, &all, || designs_words(&all, &options.out));
    }
    let specification = followed(args.quiet, |callbacks| specify(&options, callbacks))?;
    answer((args.json, args.quiet), format::SPECIFICATION, &specification, || {
        let page = shown(&options.out.join("specification.html"));
        format!("{}report: {page}\n", specification_words(&specification))
    })
}

fn specification_words(specification: &Specification) -> String {
    let unit = SizeUnit::of(false, specification.inches);
    let band = band(specification, unit).unwrap_or_else(|| match &specification.no_band {
        Some(why) => format!("no band. {}", no_band(why, unit).trim_end_matches('.')),
        None => "no band".into(),
    });
    let mut lines =
        vec![format!("Specification of a filter for {}, by the rules of practice alone", specification.base)];
    lines.extend([format!("Practice: {band}"), format!("Limit: {}", limit(specification, unit))]);
    lines.extend(raised(specification, unit).map(|raised| format!("  {raised}")));
    let dispersive = if_dispersive(specification, &by_option(DESIGN_AGAIN), unit);
    let beside = without_margin(specification, unit).into_iter().chain(dispersive);
    lines.extend(beside.map(|beside| format!("  {beside}.")));
    lines.extend(specification.notes.iter().map(|row| format!("warning: {}", row_note(row, unit))));
    lines.extend(still_to_set(specification, unit));
    lines.push(products(specification));
    lines.extend(to_be_checked(&specification.products));
    print::lines(lines)
}

fn by_option(again: &str) -> String {
    format!("{again} (--dispersive)")
}

fn designs_words(all: &DesignedSamples, out: &Path) -> String {
    let unit = SizeUnit::of(false, all.inches);
    let table = aligned(columns(unit), &all.rows) + &in_notes(&all.notes) + "\n";
    let files = ["designs.csv", "designs.html"].map(|file| shown(&out.join(file)));
    let files = ["table", "report"].iter().zip(files).map(|(name, file)| format!("{name}: {file}"));
    table + &print::lines(lines(all, &by_option(DESIGN_EACH_AGAIN), unit).into_iter().chain(files))
}

pub(crate) fn boundary(args: &BoundaryArgs) -> Result<(), RunError> {
    let options = BoundaryOptions {
        base: args.base.clone(),
        filter: args.filter.clone(),
        densities: args.densities.clone(),
        pack: args.pack,
        thicknesses: args.thicknesses.iter().flat_map(|list| list.0.clone()).collect(),
        settings: args.settings.assignments.clone(),
        as_sampled: args.as_sampled,
        as_given: args.as_given,
        out: args.out.clone(),
        overwrite: args.overwrite,
        prepare: PrepareOptions {
            packings: args.packings.clone(),
            memory: args.memory,
            threads: args.threads,
        },
    };
    let all = followed(args.quiet, |callbacks| boundary::run(&options, callbacks))?;
    answer((args.json, args.quiet), format::BOUNDARY, &all, || {
        let page = shown(&args.out.join("boundary.html"));
        format!("{}report: {page}\n", boundary_words(&all))
    })
}

fn boundary_words(all: &Boundaries) -> String {
    let Boundaries { base, filter, curve_name, .. } = all;
    let soils = format!("Base {}, filter {filter}, constrictions {curve_name}", base.name);
    let mut lines = vec![format!("Boundaries of the model. {soils}")];
    let unit = SizeUnit::of(false, all.inches);
    lines.push(format!("Model (research): {}", held(all, unit)));
    lines.extend(all.base.size().map(|base| format!("  {}", base_size(&base, unit))));
    lines.extend(all.boundaries.iter().flat_map(|row| of_row(row, unit)));
    lines.extend(all.notes.iter().take(FOREMOST).map(|row| format!("- {}", row_note(row, unit))));
    if all.notes.len() > FOREMOST {
        lines.push(format!("- and {} more on the page", all.notes.len() - FOREMOST));
    }
    lines.push(left_out_line(&all.model_leaves_out));
    lines.push(format!("{:.1} s, {} networks each, seed {}", all.seconds, all.replicates, all.seed));
    print::lines(lines)
}

fn of_row(row: &BoundaryRow, unit: SizeUnit) -> Vec<String> {
    let words = |notes: &[Note]| notes.iter().map(|note| sentence(note, unit)).collect::<Vec<_>>().join(" ");
    let what = ["no erosion up to", "continuing erosion from"];
    let boundaries =
        row.shown().into_iter().zip([words(&row.no_erosion_notes), words(&row.continuing_notes)]);
    let networks = row.networks.len() as u64;
    let mut lines = vec![format!("{}, {}, in the model:", row_name(row), row.thickness)];
    // The boundary of no erosion is given as a limit.
    let sizes: [fn(f64) -> String; 2] =
        [|mm| significant(mm).role(NumberRole::Greatest).number(), |mm| format!("{mm:.3}")];
    for ((what, size), (boundary, note)) in what.into_iter().zip(sizes).zip(boundaries) {
        let text = boundary.map(|boundary| ratio(&boundary, networks, size));
        lines.push(match (text, &*note) {
            (Some(text), "") => format!("  {what} {text}"),
            (Some(text), note) => format!("  {what} {text}. {note}"),
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
    let of_networks = |low: Option<f64>, high: Option<f64>, words: fn(f64) -> String| {
        let end = |value: Option<f64>| value.map_or("unknown".into(), words);
        let span = format!("{} to {}", end(low), end(high));
        low.or(high).map_or(String::new(), |_| format!(" ({})", over_networks(&span, networks)))
    };
    let Boundary { median, low, high, .. } = boundary;
    let size =
        |range: &Range| format!("D15F {} mm{}; ", mm(range.median), of_networks(range.low, range.high, mm));
    let size = boundary.d15f_mm.as_ref().map_or_else(String::new, size);
    format!("{size}D15F/D85B {median:.2}{}", of_networks(*low, *high, |ratio| format!("{ratio:.3}")))
}

pub(crate) fn percolation(args: &PercolationArgs) -> Result<(), RunError> {
    let PercolationArgs { realisations, seed, .. } = *args;
    let plan = PercolationPlan { shapes: args.sizes.clone(), realisations, seed };
    let options =
        PercolationOptions { plan, out: args.out.clone(), overwrite: args.overwrite, threads: args.threads };
    let study = percolation::run(&options, &unfollowed())?;
    answer((args.json, args.quiet), format::PERCOLATION, &study, || {
        format!("{}{}\n", percolation_words(&study), shown(&args.out.join("report.html")))
    })
}

fn percolation_words(study: &PercolationStudy) -> String {
    let mut text = String::from("      size   mean      95 % interval        sd\n");
    let digits = |value: Option<f64>| value.map_or("-".to_string(), |v| format!("{v:.5}"));
    for (size, threshold, _) in study.lattices() {
        let [low, high, sd] = [threshold.low, threshold.high, threshold.sd].map(digits);
        text += &format!("{size:>10}   {:.5}   {low} to {high}   {sd}\n", threshold.mean);
    }
    let fits = [
        study.one_length.as_ref().map(|fit| {
            let error = format!("+- {:.5}", fit.threshold_error);
            ("one length ", fit.threshold, error, fit.chi_squared, fit.degrees)
        }),
        study.many_starts.as_ref().map(|fit| {
            let error = format!("({:.5} to {:.5}, 68 %)", fit.threshold_low, fit.threshold_high);
            ("many starts", fit.threshold, error, fit.chi_squared, fit.degrees)
        }),
    ];
    for (law, threshold, error, chi_squared, degrees) in fits.into_iter().flatten() {
        text += &format!(
            "{law}: infinite lattice {threshold:.5} {error}, chi squared {chi_squared:.1} on {degrees} \
             degrees of freedom\n"
        );
    }
    text += &format!("known: {} for the infinite lattice; {:.1} s\n", study.infinite_lattice, study.seconds);
    text
}
