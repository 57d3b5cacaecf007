//! `voidwalk check`: a forecast of a run, or of the cases of a campaign's plan.

use std::path::Path;

use super::options::{SceneArgs, SettingArgs};
use super::print::{answer, counted, labelled, to_copy};
use crate::cases::{self, CaseOptions, CasePlan, PlanCheck};
use crate::run::cost::duration;
use crate::run::{self, Check, PackingCheck, PrepareOptions, RunError};
use crate::scene::Scene;
use crate::words::left_out::left_out;
use crate::words::memory::bytes;
use crate::words::{grading, sentence};
use voidwalk_core::constrictions::shipped;
use voidwalk_core::store::format;
use voidwalk_practice::quantity::{SizeUnit, whole};

impl SettingArgs {
    pub(crate) fn prepare(&self, threads: Option<usize>) -> PrepareOptions {
        PrepareOptions { packings: self.packings.clone(), memory: self.memory, threads }
    }
}

impl SceneArgs {
    pub(crate) fn scene(&self) -> Result<Scene, RunError> {
        let settings = &self.set.settings.assignments;
        Ok(match &self.scene {
            Some(path) => Scene::read(path, settings)?,
            None => Scene::built_in(settings)?,
        })
    }
}

pub(crate) fn check(args: &SceneArgs) -> Result<(), RunError> {
    if let Some(plan) = args.scene.as_deref().filter(|file| CasePlan::is_plan(file)) {
        return check_plan(plan, &args.set);
    }
    let check = run::check(args.scene()?, &args.set.prepare(None))?;
    answer((args.set.json, false), format::CHECK, &check, || words(&check))?;
    check.refusal.map_or(Ok(()), |refusal| Err(refusal.into()))
}

fn words(check: &Check) -> String {
    let (filter, base, network) = (&check.inputs.filter, &check.inputs.base, &check.inputs.network);
    let in_unit = SizeUnit::of(check.inputs.scale_free, false);
    let unit = in_unit.short();
    let mut text = String::new();
    let mut line = |name: &str, value: String| text += &labelled(name, &value);
    line("filter", format!("{}, curve {}", filter.name, filter.curve_name));
    let [d0, d15, d85] = [filter.d0_mm, filter.d15_mm, filter.d85_mm];
    line("  sizes", format!("D0 {d0:.4}, D15 {d15:.4}, D85 {d85:.4} {unit}"));
    let at = |point: Option<&[f64; 2]>| point.map_or(f64::NAN, |[size, _]| *size);
    let (dc0, dc100) = (at(filter.constrictions.first()), at(filter.constrictions.last()));
    line("  constrictions", format!("Dc0 {dc0:.4}, Cu_CSD {:.3}, to {dc100:.4} {unit}", filter.cu_csd));
    let packing = check.packing.as_ref().map(packing_words);
    if let Some([packing, _]) = &packing {
        line("  packing", packing.clone());
    }
    line("base", base.name.clone());
    let [d0, d85, d95, d100] = [base.d0_mm, base.d85_mm, base.d95_mm, base.d100_mm];
    let grading = check.inputs.base_size().map_or(String::new(), |base| format!(", {}", grading(&base)));
    line("  sizes", format!("D0 {d0:.4}, D85 {d85:.4}, D95 {d95:.4}, D100 {d100:.4} {unit}{grading}"));
    if let Some(before) = &base.as_sampled {
        let size = |size: Option<f64>| size.map_or("unknown".into(), |mm| format!("{mm:.4}"));
        let [d85, d95] = [before.d85_mm, before.d95_mm].map(size);
        line("  as sampled", format!("D85 {d85}, D95 {d95}, D100 {:.4} mm", before.d100_mm));
    }
    let ratios = &check.ratios;
    line(
        "ratios",
        format!("D15F/D85B {:.3}, D15F/D95B {:.3}{grading}", ratios.d15f_over_d85b, ratios.d15f_over_d95b),
    );
    let rounded = |grains: f64| (grains * 1e4).round() / 1e4;
    let given = |value: Option<f64>| value.map_or("not given".to_string(), |v| format!("{v}"));
    line(
        "grains per void",
        format!("{} (N_p / N_voids of Eq. 2)", given(check.grains_per_void.map(rounded))),
    );
    line("mass ratio", format!("{} (base over filter)", given(check.mass_ratio)));
    let capped = match check.capped {
        true => format!(", capped from {} by Eq. (2)", whole(check.n_base_eq2.unwrap_or(0))),
        false => String::new(),
    };
    line("base particles", format!("{} a run{capped}", whole(check.n_base)));
    let one_by_one = match check.one_by_one {
        all if all == check.n_base => "all".into(),
        some => format!("at most about {}; the others are passive: their numbers are followed", whole(some)),
    };
    line("  one by one", one_by_one);
    let [voids, constrictions, starts] =
        [network.voids, network.constrictions, network.start_nodes].map(whole);
    let name = &network.name;
    line("network", format!("{name}: {voids} voids, {constrictions} constrictions, {starts} start nodes"));
    let (runs, increments) = (check.runs_to_walk, check.increments);
    line("to walk", format!("{runs} runs, at most {increments} increments of insertion each"));
    line("memory", check.memory.clone());
    if let Some([_, time]) = packing {
        line("time to pack", time);
    }
    line("time to walk", format!("about {} of one core, a rough guess", duration(check.core_seconds)));
    check.left_out.iter().for_each(|part| line("left out", left_out(part, unit)));
    check.notes.iter().for_each(|note| line("note", sentence(note, in_unit)));
    let names: Vec<&str> = shipped().iter().map(|s| s.name.as_str()).collect();
    line("shipped curves", names.join(", "));
    text
}

/// Words for a packing and for the time that it takes.
fn packing_words(packing: &PackingCheck) -> [String; 2] {
    let (grains, folder) = (whole(packing.grains), packing.folder.display());
    if packing.is_made {
        let made = format!("{grains} grains, made already: {folder}");
        return [made, "none: the packing is made already".into()];
    }
    let (time, steps) = (duration(packing.core_seconds), whole(packing.steps));
    let guesses = "until then constrictions and grains per void are guesses";
    [
        format!("{grains} grains, still to be made, in {folder}; {guesses}"),
        format!("about {time} of one core, a rough guess: some {steps} steps, once"),
    ]
}

const LISTED: usize = 20;

fn check_plan(path: &Path, set: &SettingArgs) -> Result<(), RunError> {
    if !set.settings.assignments.is_empty() {
        return Err(RunError::refused(
            "settings go with a scene: a plan has those of all its cases under [set]",
        ));
    }
    let plan = CasePlan::read(path)?;
    // Without a named folder, a campaign keeps packings in its own.
    let is_named = set.packings != PrepareOptions::default().packings;
    let packings = is_named.then(|| set.packings.clone());
    let options = CaseOptions { packings, memory: set.memory, ..CaseOptions::default() };
    let check = cases::check_plan(&plan, &options)?;
    answer((set.json, false), format::PLAN_CHECK, &check, || plan_words(&check))?;
    check.refusal().map_or(Ok(()), Err)
}

fn plan_words(check: &PlanCheck) -> String {
    let mut text = String::new();
    let mut line = |name: &str, value: String| text += &labelled(name, &value);
    let title = if check.title.is_empty() { String::new() } else { format!(": {}", check.title) };
    line("plan", format!("{}{title}", check.plan));
    let factors = check.factors.join(", ");
    let factors = if factors.is_empty() { factors } else { format!(", factors {factors}") };
    line("cases", format!("{}{factors}", check.cases.len()));
    for case in check.cases.iter().take(LISTED) {
        let forecast = match case.problem.is_empty() {
            true => format!(
                "{} base particles a run, {} runs, {}, about {}",
                whole(case.n_base),
                whole(case.runs_to_walk),
                bytes(case.bytes),
                duration(case.core_seconds)
            ),
            false => format!("cannot be walked: {}", case.problem.replace('\n', " ")),
        };
        line(&format!("  {}", case.case), format!(" {forecast}"));
    }
    if check.cases.len() > LISTED {
        line("", format!("and {} more: --json has all", check.cases.len() - LISTED));
    }
    let runs = check.cases.iter().map(|case| case.runs_to_walk).sum();
    line("to walk", format!("{} runs", whole(runs)));
    line(
        "memory",
        format!(
            "{} for the largest case, {} for as many cases as are walked at once ({}), of {}",
            bytes(check.bytes),
            bytes(check.bytes_at_once),
            check.cases_at_once,
            bytes(check.bytes_allowed)
        ),
    );
    if check.packings > 0 {
        let made = check.packings - check.packings_to_make;
        let packings = counted(check.packings, "packing", "packings");
        line("packings", format!("{packings} of filters, {made} made already"));
        line(
            "time to pack",
            format!("about {} of one core, a rough guess", duration(check.packing_core_seconds)),
        );
    }
    line(
        "time to walk",
        format!("about {} of one core for all, a rough guess", duration(check.core_seconds)),
    );
    if check.cases.iter().all(|case| case.problem.is_empty()) {
        line("next", format!("voidwalk campaign {}", to_copy(&check.plan)));
    }
    text
}
