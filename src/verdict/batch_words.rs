//! What the walks of a batch say of a filter, in sentences that page and terminal share.

use super::batch::BatchRow;
use super::walked_batch::{SampleWalk, WalkedBatch, WalkedRow};
use crate::outcome::record::{IfDispersive, Verdict};

impl WalkedBatch {
    /// What was walked of a filter, sentences without their ends: how many samples, how, and to which
    /// classes; then those for which the walk is stricter than practice.
    pub fn walks_in_words(&self, filter: &str) -> Vec<String> {
        let rows: Vec<&WalkedRow> = self.of_filter(filter).collect();
        let walks: Vec<&SampleWalk> = rows.iter().filter_map(|row| row.walk.as_ref()).collect();
        let not_walked = rows.len() - walks.len();
        let mut said = format!("{} walked", walks.len());
        if !walks.is_empty() {
            let in_full = walks.iter().filter(|walk| walk.in_full).count();
            let looks = walks.len() - in_full;
            let one_or_more = if looks == 1 { "first look" } else { "first looks" };
            said += &format!(" ({in_full} in full, {looks} {one_or_more}): {}", classes(&walks));
        }
        if not_walked > 0 {
            said += &format!("; {not_walked} not walked");
        }
        let erodes = |row: &&&WalkedRow| row.rules.met == Some(true) && row.erodes();
        let stricter: Vec<&str> = rows.iter().filter(erodes).map(|row| row.rules.sample.as_str()).collect();
        let mut all = vec![said];
        if !stricter.is_empty() {
            all.push(format!("met by practice, and the walk erodes: {}", stricter.join(", ")));
        }
        all.extend(of_dispersion(&rows));
        all
    }

    /// The samples that govern a filter, the strictest first.
    pub fn governing(&self, filter: &str) -> Vec<&WalkedRow> {
        let mut rows: Vec<&WalkedRow> = self.of_filter(filter).filter(|row| row.governs.is_some()).collect();
        rows.sort_by_key(|row| row.governs);
        rows
    }
}

impl WalkedRow {
    /// Whether the filter holds the sample by practice and walk; or why it was not walked.
    pub fn answer_in_words(&self) -> String {
        let Some(walk) = &self.walk else { return format!("not walked: {}", self.not_walked) };
        let practice = walk.headline.map(|headline| format!("{}; ", headline.words()));
        format!("{}{} in the model", practice.unwrap_or_default(), walk.verdict.words())
    }

    /// Whether its walk erodes.
    fn erodes(&self) -> bool {
        let class = self.walk.as_ref().map(|walk| walk.verdict);
        matches!(class, Some(Verdict::Some | Verdict::Continuing))
    }

    /// Whether a rule that is met leaves it in doubt whether the filter holds the sample: another is not
    /// kept, or its walk erodes.
    pub fn is_doubted(&self) -> bool {
        self.is_against_practice() || self.erodes()
    }

    /// Whether a rule of retention or of the filter's own stability is not kept.
    pub fn is_against_practice(&self) -> bool {
        let breaks = |walk: &SampleWalk| walk.by_practice.is_some_and(|class| class != Verdict::None);
        self.walk.as_ref().is_some_and(breaks) || self.rules.met == Some(false) || self.rules.may_lose_fines
    }
}

/// The number of samples that may be dispersive, and those of which practice is not met then.
fn of_dispersion(rows: &[&WalkedRow]) -> Option<String> {
    let limit = |row: &&WalkedRow| Some((row.rules.clone(), row.walk.as_ref()?.if_dispersive?));
    let open: Vec<(BatchRow, IfDispersive)> = rows.iter().filter_map(limit).collect();
    let is_broken = |(row, limit): &&(BatchRow, IfDispersive)| {
        let as_placed = || row.d15f_mm.is_some_and(|d15f| limit.is_broken_by(d15f));
        row.breaks_if_dispersive || row.met.is_none() && as_placed()
    };
    let name = |(row, limit): &(BatchRow, IfDispersive)| format!("{} ({})", row.sample, limit.words());
    let broken: Vec<String> = open.iter().filter(is_broken).map(name).collect();
    let samples = if open.len() == 1 { "sample" } else { "samples" };
    let then = match broken.is_empty() {
        true => String::new(),
        false => format!("; if it is, practice allows less for {}", broken.join(", ")),
    };
    let said =
        format!("not known whether dispersive: {} {samples} with 15 % fines or more{then}", open.len());
    (!open.is_empty()).then_some(said)
}

/// How many walks came to each class.
fn classes(walks: &[&SampleWalk]) -> String {
    let count = |class| walks.iter().filter(|walk| walk.verdict == class).count();
    let counted = Verdict::ALL.into_iter().filter(|class| count(*class) > 0);
    counted.map(|class| format!("{} {}", count(class), class.words())).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::{Gradation, SoilSample};
    use crate::outcome::record::Ratios;
    use crate::verdict::{BatchFilter, BatchRow, PairOptions};

    fn walked(sample: &str, met: bool, walk: Option<(Verdict, Verdict, bool)>) -> WalkedRow {
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let curve = soil(&[(0.08, 0.0), (0.3, 100.0)]);
        let of = SoilSample { name: sample.into(), path: sample.into(), curve };
        let filter = vec![("F".to_owned(), soil(&[(0.5, 0.0), (2.0, 100.0)]))];
        let rules = BatchRow::of(&of, ("F", &filter), PairOptions::default());
        let walk = walk.map(|(verdict, by_practice, in_full)| SampleWalk {
            folder: String::new(),
            in_full,
            headline: None,
            verdict,
            by_practice: Some(by_practice),
            replicates: 2,
            ratios: Ratios { d15f_over_d85b: 4.0, d15f_over_d95b: 3.0 },
            base: None,
            runs: Vec::new(),
            curve_range: Vec::new(),
            if_dispersive: None,
        });
        let not_walked = if walk.is_none() { "no table".into() } else { String::new() };
        WalkedRow { rules: BatchRow { met: Some(met), ..rules }, governs: None, walk, not_walked }
    }

    #[test]
    fn walks_are_counted_by_class_and_practice_speaks_against_some() {
        let rows = vec![
            walked("A", true, Some((Verdict::None, Verdict::None, true))),
            walked("B", false, Some((Verdict::None, Verdict::Some, false))),
            walked("C", true, Some((Verdict::Some, Verdict::None, false))),
            walked("D", true, None),
        ];
        let against: Vec<bool> = rows.iter().map(WalkedRow::is_against_practice).collect();
        assert_eq!(against, [false, true, false, false]);
        let doubted: Vec<bool> = rows.iter().map(WalkedRow::is_doubted).collect();
        assert_eq!(doubted, [false, true, true, false]);
        assert_eq!(rows[3].answer_in_words(), "not walked: no table");
        let filter = BatchFilter { name: "F".into(), curves: vec!["F".into()], d15f_mm: None };
        let batch = WalkedBatch::new("s.csv".into(), vec![filter], rows);
        assert!(batch.walks_in_words("F")[0].contains("2 no erosion, 1 some erosion"));
    }

    /// The filter has a D15F of 0.725 mm.
    #[test]
    fn a_sample_that_may_be_dispersive_is_said_with_its_limit() {
        let of = |name: &str, verdict, d15f_max_mm| {
            let mut row = walked(name, true, Some((verdict, Verdict::None, true)));
            let if_dispersive = Some(IfDispersive { d15f_max_mm, at_most: false, lacks: None });
            row.rules.breaks_if_dispersive = d15f_max_mm < 0.725;
            row.walk = row.walk.map(|walk| SampleWalk { if_dispersive, ..walk });
            row
        };
        let sand = walked("D", true, Some((Verdict::None, Verdict::None, true)));
        let rows = [
            of("A", Verdict::None, 0.5),
            of("B", Verdict::None, 0.9),
            of("C", Verdict::Some, 0.5),
            sand.clone(),
        ];
        let words = of_dispersion(&rows.each_ref()).unwrap();
        assert!(words.contains(" 3 samples ") && words.contains("A (D15F at most 0.500 mm)"), "{words}");
        assert!(!words.contains("B ("), "{words}");
        assert_eq!(of_dispersion(&[&sand]), None);
        let filter = BatchFilter { name: "F".into(), curves: vec!["F".into()], d15f_mm: None };
        let batch = WalkedBatch::new("s.csv".into(), vec![filter], rows.to_vec());
        let last = batch.walks_in_words("F").pop().unwrap();
        assert!(last.starts_with("not known whether dispersive: 3 samples"), "{last}");
    }
}
