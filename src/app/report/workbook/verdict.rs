//! The workbook of a run: every number as `outcome.json` has it.

use super::sheet::Sheet;
use crate::outcome::record::{Outcome, Replicate, Run, Statistic};
use crate::outcome::table::Columns;
use crate::report::folder::RunFolder;
use crate::report::names::soil_name;
use crate::words::rule::columns;
use crate::words::{first_lines, sentence};
use voidwalk_practice::Decision;
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{Headline, RuleRole};

/// Sheets of the workbook.
pub(super) fn sheets(run: &RunFolder) -> Vec<Sheet> {
    let (outcome, decision) = (&run.outcome, &run.decision);
    vec![
        verdict(outcome, decision),
        inputs(outcome),
        rules(decision),
        runs(outcome),
        gradations(outcome),
        provenance(run),
    ]
}

/// The unit of sizes.
fn unit(outcome: &Outcome) -> &'static str {
    if outcome.inputs.scale_free { "D0F" } else { "mm" }
}

fn verdict(outcome: &Outcome, decision: &Decision) -> Sheet {
    let mut sheet = Sheet::items("Verdict");
    for (line, words) in first_lines(outcome, decision, SizeUnit::Mm) {
        sheet.item(line.name(), words, "");
    }
    let practice = outcome.practice.as_ref();
    sheet.item("Practice", decision.headline.map(Headline::words), "");
    sheet.item("Class of the model", outcome.model.class.words(), "");
    sheet.item("Limit of design of D15F", practice.and_then(|practice| practice.limit_mm), unit(outcome));
    let d15f = practice.and_then(|practice| practice.d15f_mm);
    sheet.item("D15F, at least", d15f.map(|ends| ends[0]), unit(outcome));
    sheet.item("D15F, at most", d15f.map(|ends| ends[1]), unit(outcome));
    sheet.item("D15F/D85B", outcome.ratios.d15f_over_d85b, "-");
    sheet.item("D15F/D95B", outcome.ratios.d15f_over_d95b, "-");
    sheet.item("Mass eroded from which a run erodes", outcome.threshold, "fraction of the base");
    for run in &outcome.summary {
        let name = |what: &str| format!("Mass eroded, run {}, {what}", run.run);
        statistic(&mut sheet, &name, &run.eroded_mass_fraction);
    }
    for (index, note) in outcome.notes.iter().enumerate() {
        sheet.item(&format!("Note {}", index + 1), sentence(note, SizeUnit::Mm), "");
    }
    sheet
}

fn statistic(sheet: &mut Sheet, name: &dyn Fn(&str) -> String, statistic: &Statistic) {
    let unit = "fraction of the base";
    sheet.item(&name("mean"), statistic.mean, unit);
    sheet.item(&name("standard deviation"), statistic.sd, unit);
    sheet.item(&name("lower end of the 95 % interval"), statistic.low, unit);
    sheet.item(&name("upper end of the 95 % interval"), statistic.high, unit);
}

fn inputs(outcome: &Outcome) -> Sheet {
    let mut sheet = Sheet::items("Inputs");
    let (inputs, unit) = (&outcome.inputs, unit(outcome));
    let (filter, base, network) = (&inputs.filter, &inputs.base, &inputs.network);
    sheet.item("Filter", soil_name(&filter.name), "");
    for (name, size) in [
        ("D0F", filter.d0_mm),
        ("D15F", filter.d15_mm),
        ("D50F", filter.d50_mm),
        ("D50F by number", filter.d50_by_number_mm),
        ("D85F", filter.d85_mm),
    ] {
        sheet.item(name, size, unit);
    }
    sheet.item("Cu of the filter", filter.cu, "-");
    sheet.item("Void ratio of the filter", filter.void_ratio, "-");
    sheet.item("Constriction curve", &filter.curve_name, "");
    sheet.item("Cu of the constrictions", filter.cu_csd, "-");
    sheet.item("Base", soil_name(&base.name), "");
    for (name, size) in [
        ("D0B", Some(base.d0_mm)),
        ("D15B", base.d15_mm),
        ("D50B", base.d50_mm),
        ("D85B", Some(base.d85_mm)),
        ("D95B", Some(base.d95_mm)),
        ("D100B", Some(base.d100_mm)),
        ("Base regraded on", base.regraded_at_mm),
    ] {
        sheet.item(name, size, unit);
    }
    sheet.item("Cu of the base", base.cu, "-");
    sheet.item("Pan fraction of the base", base.tail_mass_fraction, "fraction of the mass");
    sheet.item("Network", &network.name, "");
    sheet.item("Voids", network.voids, "");
    sheet.item("Constrictions", network.constrictions, "");
    sheet.item("Layers of voids", network.layers, "");
    sheet.item("Thickness modelled", network.thickness_mm, unit);
    sheet.item("Filter grains per void", outcome.grains_per_void, "-");
    sheet.item("Mass of base / mass of filter", inputs.mass_ratio, "-");
    sheet.item("Base particles in each run", outcome.n_base, "");
    sheet.item("Share inserted in each increment", inputs.inject_share, "fraction of the base");
    sheet
}

fn rules(decision: &Decision) -> Sheet {
    let rules = decision.rules.iter().filter(|rule| rule.role != RuleRole::Walk);
    Sheet::of("Rules", &columns(SizeUnit::Mm), rules)
}

fn runs(outcome: &Outcome) -> Sheet {
    let columns = Columns::default()
        .column("Replicate", |row: &(u64, &Replicate, &Run)| row.0)
        .column("Seed", |(_, replicate, _)| replicate.seed)
        .column("Class of the replicate", |(_, replicate, _)| replicate.verdict)
        .column("Run", |(.., run)| run.run)
        .column("Mass eroded (fraction of the mass inserted)", |(.., run)| run.eroded_mass_fraction)
        .column("Particles eroded (fraction of those inserted)", |(.., run)| run.eroded_number_fraction)
        .column("Largest particle eroded (mm, or D0F without a unit)", |(.., run)| run.largest_eroded_mm)
        .column("Largest particle eroded / D15F (-)", |(.., run)| run.largest_eroded_over_d15f)
        .column("Particles inserted", |(.., run)| run.inserted)
        .column("Particles eroded", |(.., run)| run.eroded)
        .column("Particles retained in constrictions", |(.., run)| run.retained_in_constrictions)
        .column("Particles retained in voids", |(.., run)| run.retained_in_voids)
        .column("Constrictions blocked", |(.., run)| run.blocked)
        .column("Constrictions blocked (fraction of all)", |(.., run)| run.blocked_fraction)
        .column("Increments", |(.., run)| run.increments)
        .column("Particle moves", |(.., run)| run.particle_moves);
    let numbered = (1..).zip(&outcome.replicates);
    let rows = numbered
        .flat_map(|(number, replicate)| replicate.runs.iter().map(move |run| (number, replicate, run)));
    Sheet::of("Runs", &columns, &rows.collect::<Vec<_>>())
}

fn gradations(outcome: &Outcome) -> Sheet {
    let columns = Columns::default()
        .column("Curve", |row: &(&str, [f64; 2], &str)| row.0.to_owned())
        .column("Size (mm, or D0F without a unit)", |row| row.1[0])
        .column("Finer (%)", |row| row.1[1])
        .column("Percent finer by", |row| row.2.to_owned());
    let (filter, base) = (&outcome.inputs.filter, &outcome.inputs.base);
    let sampled = base.as_sampled.as_ref().map_or(&[][..], |before| &before.gradation);
    let curves = [
        ("filter", &filter.gradation[..], "mass"),
        ("constrictions of the filter", &filter.constrictions, "number"),
        ("base as walked", &base.gradation, "mass"),
        ("base as sampled", sampled, "mass"),
    ];
    let rows = curves.into_iter().flat_map(|(curve, rows, by)| rows.iter().map(move |row| (curve, *row, by)));
    Sheet::of("Gradations", &columns, &rows.collect::<Vec<_>>())
}

fn provenance(run: &RunFolder) -> Sheet {
    let mut sheet = Sheet::items("Provenance");
    let manifest = &run.manifest;
    for (name, value) in [
        ("voidwalk", Some(&manifest.version)),
        ("Commit", manifest.commit.as_ref()),
        ("Command", Some(&manifest.command)),
        ("Engine", Some(&run.outcome.engine)),
        ("Machine", Some(&manifest.machine)),
        ("Host", Some(&manifest.host)),
        ("Started", Some(&manifest.started)),
        ("Finished", Some(&manifest.finished)),
    ] {
        sheet.item(name, value, "");
    }
    sheet.item("Seed", run.outcome.seed, "");
    sheet.item("Replicates", run.outcome.replicates.len() as u64, "");
    for input in &manifest.inputs {
        sheet.item(&format!("XXH3 of {}", input.name), &input.xxh3, "");
    }
    sheet
}
