//! What the walks of a batch say of a filter, in sentences that page and terminal share.

use super::batch::BatchRow;
use super::probability::stated;
use super::walked_batch::{SampleWalk, WalkedBatch, WalkedRow};
use crate::outcome::record::{Confidence, IfDispersive, Verdict};

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
        let mut said = match walk.headline.is_empty() {
            true => format!("{} in the model, {}", walk.verdict.words(), walk.confidence.words()),
            false => walk.headline.clone(),
        };
        if let Some(of) = walk.probability_in_words() {
            said += &format!(". {}", stated(&of, None));
        }
        said
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
        let doubts = [Confidence::Contradicted, Confidence::Unstable];
        let doubted = self.walk.as_ref().is_some_and(|walk| doubts.contains(&walk.confidence));
        doubted || self.rules.met == Some(false) || self.rules.may_lose_fines
    }
}

/// How many samples that the walk holds may be dispersive, and of which of them practice is not met then.
fn of_dispersion(rows: &[&WalkedRow]) -> Option<String> {
    let holds = |walk: &&SampleWalk| matches!(walk.verdict, Verdict::None | Verdict::Undecided);
    let of = |row: &&WalkedRow| Some((row.rules.clone(), row.walk.as_ref().filter(holds)?.if_dispersive?));
    let open: Vec<_> = rows.iter().filter_map(of).collect();
    let is_broken = |(row, of): &&(BatchRow, IfDispersive)| {
        let as_placed = || row.d15f_mm.is_some_and(|d15f| of.is_broken_by(d15f));
        row.breaks_if_dispersive || row.met.is_none() && as_placed()
    };
    let name = |(row, of): &(BatchRow, IfDispersive)| format!("{} ({})", row.sample, of.words());
    let broken: Vec<String> = open.iter().filter(is_broken).map(name).collect();
    let samples = if open.len() == 1 { "sample" } else { "samples" };
    let then = match broken.is_empty() {
        true => String::new(),
        false => format!("; if it is, practice allows less for {}", broken.join(", ")),
    };
    // Those that erode are not held, dispersive or not.
    let is_open = |row: &&&WalkedRow| row.walk.as_ref().is_some_and(|walk| walk.if_dispersive.is_some());
    let beside = match rows.iter().filter(is_open).count() > open.len() {
        true => ", beside those that erode in the walk",
        false => "",
    };
    let said = format!(
        "not known whether dispersive: {} {samples} with 15 % fines or more{beside}{then}",
        open.len()
    );
    (!open.is_empty()).then_some(said)
}

/// How many walks came to each class; of "no erosion" also how far it can be relied on.
fn classes(walks: &[&SampleWalk]) -> String {
    let count = |holds: &dyn Fn(&SampleWalk) -> bool| walks.iter().filter(|walk| holds(walk)).count();
    let mut all = Vec::new();
    for class in Verdict::ALL {
        let of_class = count(&|walk| walk.verdict == class);
        if of_class == 0 {
            continue;
        }
        let labelled = |label: Confidence| {
            let of_label = count(&|walk| (walk.verdict, walk.confidence) == (Verdict::None, label));
            (of_label > 0).then(|| format!("{of_label} {}", label.words()))
        };
        let labels: Vec<String> = match class {
            Verdict::None => Confidence::DOUBTS.into_iter().filter_map(labelled).collect(),
            _ => Vec::new(),
        };
        let of = if labels.is_empty() { String::new() } else { format!(" ({})", labels.join(", ")) };
        all.push(format!("{of_class} {}{of}", class.words()));
    }
    all.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::{Gradation, SoilSample};
    use crate::outcome::record::Ratios;
    use crate::verdict::{BatchFilter, BatchRow, PairOptions};

    fn walked(sample: &str, met: bool, walk: Option<(Verdict, Confidence, bool)>) -> WalkedRow {
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let curve = soil(&[(0.08, 0.0), (0.3, 100.0)]);
        let of = SoilSample { name: sample.into(), path: sample.into(), curve };
        let filter = vec![("F".to_owned(), soil(&[(0.5, 0.0), (2.0, 100.0)]))];
        let rules = BatchRow::of(&of, ("F", &filter), PairOptions::default());
        let walk = walk.map(|(verdict, confidence, in_full)| SampleWalk {
            folder: String::new(),
            in_full,
            headline: String::new(),
            verdict,
            by_practice: None,
            confidence,
            reason: None,
            replicates: 2,
            ratios: Ratios { d15f_over_d85b: 4.0, d15f_over_d95b: 3.0 },
            base: None,
            runs: Vec::new(),
            curve_range: Vec::new(),
            if_dispersive: None,
            probability_no_erosion: Some(0.93),
            probability_bound: None,
            probability_by_tests: Some(0.88),
            beyond_tests: !met,
        });
        let not_walked = if walk.is_none() { "no table".into() } else { String::new() };
        WalkedRow { rules: BatchRow { met: Some(met), ..rules }, governs: None, walk, not_walked }
    }

    #[test]
    fn no_erosion_is_counted_with_what_speaks_against_it() {
        let rows = vec![
            walked("A", true, Some((Verdict::None, Confidence::Within, true))),
            walked("B", false, Some((Verdict::None, Confidence::Contradicted, false))),
            walked("C", true, Some((Verdict::Some, Confidence::Outside, false))),
            walked("D", true, None),
        ];
        let against: Vec<bool> = rows.iter().map(WalkedRow::is_against_practice).collect();
        assert_eq!(against, [false, true, false, false]);
        let doubted: Vec<bool> = rows.iter().map(WalkedRow::is_doubted).collect();
        assert_eq!(doubted, [false, true, true, false]);
        assert_eq!(rows[3].answer_in_words(), "not walked: no table");
        assert_eq!(
            rows[0].answer_in_words(),
            "no erosion in the model, within checked range. Probability of no erosion in a test, not for a \
             risk analysis: 88 % by the published range, 93 % by the walk; boundaries are taken as \
             log-uniform within the published range (Fell et al., Table 9.2)"
        );
        // Outside the checked range no number is to be relied on.
        assert_eq!(rows[1].answer_in_words(), "no erosion in the model, contradicted by practice");
        assert_eq!(rows[2].answer_in_words(), "some erosion in the model, outside checked range");
        // Beyond the boundary that tests saw nothing more favourable than the range is said.
        let beyond = walked("E", false, Some((Verdict::None, Confidence::Within, false))).answer_in_words();
        assert!(
            beyond.contains("risk analysis: 88 % by the published range (the lower of two; "),
            "{beyond}"
        );
        let filter = BatchFilter { name: "F".into(), curves: vec!["F".into()], d15f_mm: None };
        let batch = WalkedBatch::new("s.csv".into(), vec![filter], rows);
        assert_eq!(
            batch.walks_in_words("F"),
            [
                "3 walked (1 in full, 2 first looks): 2 no erosion (1 contradicted by practice), 1 some \
                 erosion; 1 not walked",
                "met by practice, and the walk erodes: C"
            ]
        );
    }

    /// The filter has a D15F of 0.725 mm.
    #[test]
    fn a_sample_that_may_be_dispersive_is_said_with_its_limit() {
        let of = |name: &str, verdict, d15f_max_mm| {
            let mut row = walked(name, true, Some((verdict, Confidence::Within, true)));
            let if_dispersive = Some(IfDispersive { d15f_max_mm, at_most: false, lacks: None });
            row.rules.breaks_if_dispersive = d15f_max_mm < 0.725;
            row.walk = row.walk.map(|walk| SampleWalk { if_dispersive, ..walk });
            row
        };
        let sand = walked("D", true, Some((Verdict::None, Confidence::Within, true)));
        let rows = [
            of("A", Verdict::None, 0.5),
            of("B", Verdict::None, 0.9),
            of("C", Verdict::Some, 0.5),
            sand.clone(),
        ];
        assert_eq!(
            of_dispersion(&rows.each_ref()).unwrap(),
            "not known whether dispersive: 2 samples with 15 % fines or more, beside those that erode in the \
             walk; if it is, practice allows less for A (D15F at most 0.500 mm)"
        );
        let said = of_dispersion(&[&rows[1]]).unwrap();
        assert_eq!(said, "not known whether dispersive: 1 sample with 15 % fines or more");
        assert_eq!(of_dispersion(&[&rows[2], &sand]), None);
        let filter = BatchFilter { name: "F".into(), curves: vec!["F".into()], d15f_mm: None };
        let batch = WalkedBatch::new("s.csv".into(), vec![filter], rows.to_vec());
        let last = batch.walks_in_words("F").pop().unwrap();
        assert!(last.starts_with("not known whether dispersive: 2 samples"), "{last}");
    }
}
