//! Progress of a job while it runs.

use super::batches::so_far;
use crate::cases::CaseEvent;
use crate::outcome::verdict::SoFar;
use crate::run::Event;
use crate::verdict::WalkedRow;
use crate::words::sentence;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Minimum number of replicates for a class while more are to come.
const FEW: usize = 4;

const WARNINGS: usize = 50;

#[derive(Clone, Debug, Default)]
pub(crate) struct Live {
    /// Grains of the packing, steps done, and usual number of steps.
    packing: Option<[u64; 3]>,
    waits_for_packing: bool,
    /// Numbers of runs done and to be walked, as far as known.
    runs: [u64; 2],
    walked: SoFar,
    pub(crate) cases: [usize; 2],
    /// Cases being walked, with their numbers of runs done and to be walked.
    walking: BTreeMap<String, [u64; 2]>,
    case: String,
    /// Rows of a batch, with the walks so far; true if they show inches.
    pub(crate) batch: Option<(Vec<WalkedRow>, bool)>,
    pub(crate) warnings: Vec<String>,
}

impl Live {
    pub(crate) fn tell(&mut self, event: Event) {
        match event {
            Event::PackingElsewhere { .. } => self.waits_for_packing = true,
            Event::PackingBegun(plan) => {
                self.waits_for_packing = false;
                self.packing = Some([plan.compression.grains as u64, 0, plan.usual_steps()]);
            }
            Event::Packing(progress) => {
                if let Some(packing) = &mut self.packing {
                    packing[1] = progress.steps;
                }
            }
            Event::PackingEnded => self.packing = None,
            Event::WalkBegun { runs } => {
                self.waits_for_packing = false;
                self.runs = [0, runs];
            }
            Event::MoreRuns { runs } => self.runs[1] += runs,
            Event::RunDone => self.runs[0] += 1,
            Event::RunWalked { replicate, run, eroded_mass_fraction, below_threshold } => {
                self.walked.add(replicate, run, eroded_mass_fraction, below_threshold);
            }
            Event::Noted { notes, unit } => notes.iter().for_each(|note| self.warn(&sentence(note, unit))),
            Event::Studying(_)
            | Event::VerdictNeeds { .. }
            | Event::VerdictStands { .. }
            | Event::Increment { .. } => {}
        }
    }

    pub(crate) fn tell_case(&mut self, case: &str, event: CaseEvent) {
        match event {
            CaseEvent::Begun { .. } | CaseEvent::Waiting => self.case = case.to_owned(),
            CaseEvent::Walked { done, runs } => {
                self.walking.insert(case.to_owned(), [done, runs]);
            }
            CaseEvent::Done(_) => {
                self.walking.remove(case);
                self.cases[0] += 1;
            }
            CaseEvent::Failed(problem) => {
                self.walking.remove(case);
                self.warn(&format!("{case}: {problem}"));
            }
        }
    }

    pub(crate) fn end_batch(&mut self) {
        if let Some((rows, _)) = &mut self.batch {
            *rows = Vec::new();
        }
    }

    pub(crate) fn walked_pair(&mut self, at: usize, row: WalkedRow) {
        if let Some(there) = self.batch.as_mut().and_then(|(rows, _)| rows.get_mut(at)) {
            *there = row;
        }
    }

    pub(crate) fn warn(&mut self, warning: &str) {
        if self.warnings.len() < WARNINGS && !self.warnings.iter().any(|earlier| earlier == warning) {
            self.warnings.push(warning.to_owned());
        }
    }

    /// State for the page, of a case that is walked in `runs` runs.
    pub(crate) fn snapshot(&self, runs: u64) -> Value {
        let table = self.batch.as_ref().filter(|(rows, _)| !rows.is_empty());
        json!({
            "packing": self.packing.map(|[grains, steps, usual]| json!({
                "grains": grains, "steps": steps, "usual": usual
            })),
            "waits_for_packing": self.waits_for_packing,
            "runs_done": self.runs[0],
            "runs": self.runs[1],
            "cases_done": self.cases[0],
            "cases": self.cases[1],
            "case": self.case,
            "walking": self.walking.iter().map(|(case, [done, runs])| json!({
                "case": case, "done": done, "runs": runs
            })).collect::<Vec<_>>(),
            "table": table.map(|(rows, inches)| so_far(rows, *inches)),
            "warnings": self.warnings,
            "so_far": self.so_far(runs),
        })
    }

    /// Results of the finished replicates, without a class if they are few.
    fn so_far(&self, runs: u64) -> Value {
        let Some(look) = self.walked.look(runs) else { return Value::Null };
        let class = Some(look.class.words()).filter(|_| look.replicates >= FEW);
        json!({ "replicates": look.replicates, "class": class, "runs": look.eroded, "few": FEW })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walked(live: &mut Live, replicate: u64, run: u64, eroded_mass_fraction: f64) {
        let below_threshold = eroded_mass_fraction < 0.075;
        live.tell(Event::RunWalked { replicate, run, eroded_mass_fraction, below_threshold });
    }

    #[test]
    fn few_replicates_have_numbers_and_no_class() {
        let mut live = Live::default();
        assert!(live.snapshot(2)["so_far"].is_null());
        walked(&mut live, 1, 1, 0.5);
        assert!(live.snapshot(2)["so_far"].is_null(), "half a replicate");
        for (replicate, eroded) in [(1, 0.50), (2, 0.52), (3, 0.51), (4, 0.49)] {
            walked(&mut live, replicate, 1, eroded);
            walked(&mut live, replicate, 2, 0.01);
            let so_far = live.snapshot(2)["so_far"].clone();
            assert_eq!(so_far["replicates"], replicate);
            assert_eq!(so_far["runs"][0]["low"].is_null(), replicate == 1);
            assert_eq!(so_far["class"].as_str(), (replicate == 4).then_some("some erosion"));
        }
        // An interval that straddles the threshold gives no class either.
        walked(&mut live, 5, 1, 0.0);
        walked(&mut live, 5, 2, 0.9);
        assert_eq!(live.snapshot(2)["so_far"]["class"], "undecided");
    }

    #[test]
    fn the_runs_of_each_case_are_counted_while_it_is_walked() {
        let mut live = Live { cases: [0, 2], ..Live::default() };
        live.tell_case("a.csv", CaseEvent::Begun { resumes: false });
        live.tell_case("a.csv", CaseEvent::Walked { done: 3, runs: 20 });
        live.tell_case("b.csv", CaseEvent::Walked { done: 1, runs: 20 });
        live.tell_case("a.csv", CaseEvent::Walked { done: 4, runs: 22 });
        let walking = |live: &Live| live.snapshot(2)["walking"].clone();
        let case = |case: &str, done: u64, runs: u64| json!({ "case": case, "done": done, "runs": runs });
        assert_eq!(walking(&live), json!([case("a.csv", 4, 22), case("b.csv", 1, 20)]));
        live.tell_case("a.csv", CaseEvent::Failed("it is wrong"));
        assert_eq!(walking(&live), json!([case("b.csv", 1, 20)]));
        assert_eq!(live.warnings, ["a.csv: it is wrong"]);
    }
}
