//! The workbook of a run: every number as `outcome.json` has it.

use super::sheet::{Entry, Sheet};
use crate::outcome::quantity::SizeUnit;
use crate::outcome::record::{AppliedRule, Headline, Outcome, RuleRole, Run, Statistic, ValueBound};
use crate::report::folder::RunFolder;
use crate::report::names::soil_name;
use crate::verdict::Decision;
use crate::verdict::rule_result::{RuleResult, result_of};
use crate::words::rule::result;
use crate::words::rule_note::rule_notes;
use crate::words::{first_lines, sentence};

/// Its sheets.
pub(super) fn sheets(of: &RunFolder) -> Vec<Sheet> {
    let (outcome, decision) = (&of.outcome, &of.decision);
    vec![
        verdict(outcome, decision),
        inputs(outcome),
        rules(decision),
        runs(outcome),
        gradations(outcome),
        provenance(of),
    ]
}

/// The unit of sizes.
fn unit(outcome: &Outcome) -> &'static str {
    if outcome.inputs.scale_free { "D0F" } else { "mm" }
}

fn verdict(outcome: &Outcome, decision: &Decision) -> Sheet {
    let mut sheet = Sheet::new("Verdict", &["Item", "Value", "Unit"]);
    for (line, said) in first_lines(outcome, decision, SizeUnit::Mm) {
        sheet.item(line.name(), said, "");
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
        let of = |what: &str| format!("Mass eroded, run {}, {what}", run.run);
        statistic(&mut sheet, &of, &run.eroded_mass_fraction);
    }
    for (index, note) in outcome.notes.iter().enumerate() {
        sheet.item(&format!("Note {}", index + 1), sentence(note, SizeUnit::Mm), "");
    }
    sheet
}

fn statistic(sheet: &mut Sheet, name: &dyn Fn(&str) -> String, of: &Statistic) {
    let unit = "fraction of the base";
    sheet.item(&name("mean"), of.mean, unit);
    sheet.item(&name("standard deviation"), of.sd, unit);
    sheet.item(&name("lower end of the 95 % interval"), of.low, unit);
    sheet.item(&name("upper end of the 95 % interval"), of.high, unit);
}

fn inputs(outcome: &Outcome) -> Sheet {
    let mut sheet = Sheet::new("Inputs", &["Item", "Value", "Unit"]);
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
    let headings = [
        "Rule",
        "Authority",
        "Quantity",
        "Value",
        "The value is",
        "Limit",
        "Unit of value and limit",
        "The limit is",
        "Applies",
        "Result",
        "Met",
        "Formula",
        "Applies to",
        "Note",
        "Source",
        "Id",
    ];
    let mut sheet = Sheet::new("Rules", &headings);
    for rule in decision.rules.iter().filter(|rule| rule.role != RuleRole::Walk) {
        sheet.row(of_rule(rule, result_of(rule)));
    }
    sheet
}

fn of_rule(rule: &AppliedRule, found: RuleResult) -> [Entry; 16] {
    let notes: Vec<String> = [&rule.notes, &rule.needs].map(|notes| rule_notes(notes, SizeUnit::Mm)).into();
    let notes = notes.into_iter().filter(|note| !note.is_empty()).collect::<Vec<_>>().join("; ");
    let value_is = match rule.value_bound {
        Some(ValueBound::AtMost) => "the most that it can be",
        Some(ValueBound::AtLeast) => "the least that it can be",
        None => "",
    };
    let limit_is = match (rule.limit, rule.at_least, rule.limit_at_most) {
        (None, ..) => "",
        _ if rule.role == RuleRole::Continuation => "a boundary: continuing erosion beyond it",
        (_, true, false) => "the least",
        (_, true, true) => "enough; the least is not known",
        (_, false, false) => "the most",
        (_, false, true) => "the most that it can be",
    };
    [
        (&rule.name).into(),
        rule.authorities().join(", ").into(),
        rule.quantity.name().into(),
        rule.value.into(),
        value_is.into(),
        rule.limit.into(),
        rule.unit.name().into(),
        limit_is.into(),
        rule.applies.into(),
        result(found).into(),
        // A boundary of continuing erosion that is not reached is no limit that is met.
        rule.met.filter(|met| rule.role != RuleRole::Continuation || !met).into(),
        (&rule.formula).into(),
        (&rule.applies_to).into(),
        notes.into(),
        (&rule.source).into(),
        (&rule.id).into(),
    ]
}

fn runs(outcome: &Outcome) -> Sheet {
    let headings = [
        "Replicate",
        "Seed",
        "Class of the replicate",
        "Run",
        "Mass eroded (fraction of the mass inserted)",
        "Particles eroded (fraction of those inserted)",
        "Largest particle eroded (mm, or D0F without a unit)",
        "Largest particle eroded / D15F (-)",
        "Particles inserted",
        "Particles eroded",
        "Particles retained in constrictions",
        "Particles retained in voids",
        "Constrictions blocked",
        "Constrictions blocked (fraction of all)",
        "Increments",
        "Particle moves",
    ];
    let mut sheet = Sheet::new("Runs", &headings);
    for (number, replicate) in (1u64..).zip(&outcome.replicates) {
        for run in &replicate.runs {
            let of_replicate: [Entry; 3] =
                [number.into(), replicate.seed.into(), replicate.verdict.words().into()];
            sheet.row(of_replicate.into_iter().chain(of_run(run)));
        }
    }
    sheet
}

fn of_run(run: &Run) -> [Entry; 13] {
    [
        run.run.into(),
        run.eroded_mass_fraction.into(),
        run.eroded_number_fraction.into(),
        run.largest_eroded_mm.into(),
        run.largest_eroded_over_d15f.into(),
        run.inserted.into(),
        run.eroded.into(),
        run.retained_in_constrictions.into(),
        run.retained_in_voids.into(),
        run.blocked.into(),
        run.blocked_fraction.into(),
        run.increments.into(),
        run.particle_moves.into(),
    ]
}

fn gradations(outcome: &Outcome) -> Sheet {
    let headings = ["Curve", "Size (mm, or D0F without a unit)", "Finer (%)", "Percent finer by"];
    let mut sheet = Sheet::new("Gradations", &headings);
    let (filter, base) = (&outcome.inputs.filter, &outcome.inputs.base);
    let sampled = base.as_sampled.as_ref().map_or(&[][..], |before| &before.gradation);
    for (curve, rows, by) in [
        ("filter", &filter.gradation[..], "mass"),
        ("constrictions of the filter", &filter.constrictions, "number"),
        ("base as walked", &base.gradation, "mass"),
        ("base as sampled", sampled, "mass"),
    ] {
        rows.iter().for_each(|row| sheet.row([curve.into(), row[0].into(), row[1].into(), by.into()]));
    }
    sheet
}

fn provenance(of: &RunFolder) -> Sheet {
    let mut sheet = Sheet::new("Provenance", &["Item", "Value", "Unit"]);
    let manifest = &of.manifest;
    for (name, value) in [
        ("voidwalk", Some(&manifest.version)),
        ("Commit", manifest.commit.as_ref()),
        ("Command", Some(&manifest.command)),
        ("Engine", Some(&of.outcome.engine)),
        ("Machine", Some(&manifest.machine)),
        ("Host", Some(&manifest.host)),
        ("Started", Some(&manifest.started)),
        ("Finished", Some(&manifest.finished)),
    ] {
        sheet.item(name, value, "");
    }
    sheet.item("Seed", of.outcome.seed, "");
    sheet.item("Replicates", of.outcome.replicates.len() as u64, "");
    for input in &manifest.inputs {
        sheet.item(&format!("XXH3 of {}", input.name), &input.xxh3, "");
    }
    sheet
}
