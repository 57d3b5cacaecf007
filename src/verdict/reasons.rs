//! Why a pair lies outside what the model was checked against, in a few words.

use serde_json::Value as Json;

use super::beside::is_evidence;
use super::entry::COHESIVE_FINES;
use super::finding::ALL;
use super::quantity::FindingValue;
use crate::outcome::record::{Confidence, FindingRecord, Outcome};

/// Id of the finding that the filter is finer than any that eroded in tests, and the base erodes in the walk.
const EVIDENCE_SAFE: &str = "evidence_safe";

/// Reasons that are named in a line.
const REASONS: usize = 3;

impl Outcome {
    /// How far the class can be relied on, in words; outside the checked range with the range, or with what
    /// else was not checked.
    pub fn confidence_in_words(&self) -> String {
        self.labelled(&self.doubts(), usize::MAX)
    }

    /// The same of the model alone, with the foremost of these reasons, and how many more there are: what
    /// practice says of the filter stands elsewhere.
    pub(super) fn confidence_in_brief(&self) -> String {
        let mut of_model = self.doubts();
        of_model.retain(|doubt| doubt.hides_probability());
        self.labelled(&of_model, REASONS)
    }

    fn labelled(&self, doubts: &[Confidence], most: usize) -> String {
        if doubts.is_empty() {
            return self.confidence.words().into();
        }
        let outside = || self.outside_in_words(most);
        let words = |of: &Confidence| if *of == Confidence::Outside { outside() } else { of.words().into() };
        doubts.iter().map(words).collect::<Vec<_>>().join("; ")
    }

    /// That the pair lies outside what the model was checked against, with so many reasons.
    fn outside_in_words(&self, most: usize) -> String {
        let (label, reasons) = (Confidence::Outside.words(), self.reasons_outside());
        let mut said: Vec<String> = reasons.iter().take(most).map(Reason::in_words).collect();
        if said.is_empty() {
            return label.into();
        }
        if reasons.len() > most {
            said.push(format!("{} more", reasons.len() - most));
        }
        format!("{label} ({})", said.join("; "))
    }

    /// Every doubt of the class, the worst first, which is its label: what is known against a pair adds up.
    pub fn doubts(&self) -> Vec<Confidence> {
        let sets = |of: &FindingRecord| ALL.iter().find(|entry| entry.id == of.id).map(|entry| entry.sets);
        let found: Vec<Confidence> = self.against().iter().filter_map(sets).collect();
        let all = Confidence::DOUBTS.into_iter();
        all.filter(|doubt| *doubt == self.confidence || found.contains(doubt)).collect()
    }

    /// Whether a probability would say more than anybody can answer for.
    pub(super) fn hides_probability(&self) -> bool {
        self.doubts().into_iter().any(Confidence::hides_probability)
    }

    /// Why the pair lies outside what the model was checked against, each once; none where it does not.
    pub(super) fn reasons_outside(&self) -> Vec<Reason> {
        let mut reasons: Vec<Reason> = Vec::new();
        if self.doubts().contains(&Confidence::Outside) {
            let is_named = |finding: &&FindingRecord| !is_evidence(finding) || finding.id == EVIDENCE_SAFE;
            for finding in self.against().iter().filter(is_named) {
                reasons.extend(Reason::of(finding).filter(|reason| !reasons.contains(reason)));
            }
        }
        reasons
    }
}

/// Why a pair lies outside what the model was checked against, of one finding.
#[derive(PartialEq)]
pub(super) enum Reason {
    /// What a soil is that the model was not checked for, with the range that was checked, if it is one.
    Soil(String, Option<[String; 2]>),
    /// What else the class hangs on.
    Other(String),
}

impl Reason {
    /// The reason of a finding; `None` of one that is said elsewhere, and of findings of earlier versions.
    fn of(finding: &FindingRecord) -> Option<Self> {
        let text = |name: &str| finding.numbers.get(name).and_then(Json::as_str).unwrap_or_default();
        let number = |name: &str| finding.numbers.get(name).and_then(Json::as_f64).unwrap_or(f64::NAN);
        let percent = |name: &str| FindingValue::Percent(number(name)).shown(None);
        let ratio = |name: &str| FindingValue::Ratio(number(name)).shown(None);
        let least = |name: &str| FindingValue::LeastRatio(number(name)).shown(None);
        let soil = |said: String| Some(Self::Soil(said, None));
        let range = ["low", "high"].map(ratio);
        let of_range = |said: String| Some(Self::Soil(said, Some(range)));
        match finding.id.as_str() {
            COHESIVE_FINES => soil(format!("{} fines", percent("fines_percent"))),
            "fines_not_sieved" => soil(format!("up to {} fines", percent("fines_percent"))),
            "dispersive_base" => soil("dispersive base".into()),
            "broadly_graded" | "not_regraded" => soil("broadly graded base".into()),
            "gap_graded" => soil("gap-graded filter".into()),
            "cu_unchecked" => of_range(format!("Cu of the {} {}", text("soil"), ratio("cu"))),
            "cu_at_least" => of_range(format!("Cu of the {} above {}", text("soil"), least("cu"))),
            "cu_in_doubt" => {
                of_range(format!("Cu of the {} at least {}{}", text("soil"), least("least"), text("how")))
            }
            "cu_unknown" => of_range(format!("Cu of the {} not known", text("soil"))),
            id => other(id).map(|said| Self::Other(said.into())),
        }
    }

    /// With the range, if there is one.
    fn in_words(&self) -> String {
        match self {
            Self::Soil(said, Some([low, high])) => format!("{said}, checked for {low} to {high}"),
            Self::Soil(said, None) | Self::Other(said) => said.clone(),
        }
    }
}

/// What a class hangs on beside the kind of its soils, of one finding; `None` where that is said elsewhere.
fn other(id: &str) -> Option<&'static str> {
    Some(match id {
        "worse_with_amount" => "the class changes with the amount of base",
        "capped_base" | "few_particles" | "more_particles" | "low_mass_ratio" | "amount_unknown"
        | "amount_held" | "guessed_grains" => "the model was not checked with this amount of base",
        "pan_decides" | "pan_taken_as_likely" | "pan_readings_walked" | "pan_erodes" => {
            "the sizes of the base's finest part are not known"
        }
        "coarse_base" => "the unit of the base's sizes is in doubt",
        "regraded_elsewhere" => "the base was regraded in another size",
        "library_of_any_density" => "the filter's density is not known",
        "library_of_density" => "the constrictions are those of filters like this one",
        "curve_range_decides"
        | "curve_range_open"
        | "other_curve"
        | "like_none_of_the_library"
        | "guessed_constrictions" => "the filter's constrictions are only roughly known",
        "part_packed" | "floating_part_packed" | "loose_part_packed" => {
            "the constrictions are those of the filter's finer part"
        }
        "skeleton" => "most grains of the filter lie loose between the coarse ones",
        "layer_thicker" | "layers_thicker" | "copies_thicker" => {
            "the modelled filter is thicker than the real one"
        }
        "thickness_without_unit" | "thickness_of_file" => "the thickness of the modelled filter is not known",
        "given_network" => "the model was not checked with this network of voids",
        "narrow_lattice" => "the modelled filter is too narrow",
        "no_filter" => "the filter's gradation is not given",
        "open_joint" => "an open joint was not walked",
        "one_replicate" => "the walk rests on one network",
        "few_replicates" => "the walk rests on few networks",
        "decided_below_95" => "the class is decided at less than 95 % confidence",
        "clogged_before" | "clogged" => "the filter clogged in the walk",
        "trapped_could_turn" => "trapped particles could change the class",
        "second_run_erodes" => "the base erodes in the second run",
        "all_on_its_way" => "all of the base was inserted before any could be through the filter",
        EVIDENCE_SAFE => "tests held such filters",
        "arches" => "the law of clogging was not checked by filter tests",
        "openings" => "the openings beside blocked particles were not checked by filter tests",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::record::Verdict;

    #[test]
    fn a_pair_is_tested_for_what_its_soils_are() {
        use crate::verdict::finding;
        let said = |finding: crate::verdict::Finding| match Reason::of(&finding.record(true)) {
            Some(Reason::Soil(said, _)) => said,
            Some(Reason::Other(said)) => format!("other: {said}"),
            None => String::new(),
        };
        let soil = [(0.01, 0.0), (0.075, 40.0), (2.0, 60.0), (19.0, 100.0)];
        let regraded = Gradation::from_lines(&soil).unwrap().regraded().why;
        for (of, words) in [
            (finding::cohesive_fines(88.0), "88 % fines"),
            (finding::fines_not_sieved(25.0, 0.3), "up to 25 % fines"),
            (finding::cu_at_least("base", 8.77, 0.002, 1.2, 4.5), "Cu of the base above 8.77"),
            (finding::cu_unchecked("filter", 35.4, 1.2, 6.0), "Cu of the filter 35.4"),
            (
                finding::cu_in_doubt("base", 4.03, " as regraded", 1.2, 4.5),
                "Cu of the base at least 4.03 as regraded",
            ),
            (finding::cu_unknown("base", 1.2, 4.5), "Cu of the base not known"),
            (finding::dispersive_base(), "dispersive base"),
            (finding::broadly_graded(31.0), "broadly graded base"),
            (finding::not_regraded(4.75, &regraded), "broadly graded base"),
            (finding::gap_graded(3.0, 0.5), "gap-graded filter"),
            (
                finding::worse_with_amount("", "", "0.25", "some erosion", ""),
                "other: the class changes with the amount of base",
            ),
            (finding::library_of_any_density(10.0), "other: the filter's density is not known"),
            (finding::few_replicates(3), "other: the walk rests on few networks"),
            (finding::dispersive_would_not_hold("0.500 mm", "0.610 mm"), ""),
        ] {
            assert_eq!(said(of), words);
        }
    }

    /// A finding that is renamed, or a new one, would leave a test without its reason.
    #[test]
    fn whatever_takes_a_class_out_of_the_checked_range_is_a_reason_to_test() {
        use crate::outcome::record::Topic;
        use crate::verdict::entry::DISPERSIVE_WOULD_NOT_HOLD;
        let mut reasons = 0;
        let eroding = [Verdict::Some, Verdict::Continuing];
        for finding in crate::verdict::finding::all_with(12.0, 3, "base") {
            let record = finding.record(true);
            // Of practice and of a search other lines speak; what comes first names the test of dispersion.
            let is_said = matches!(record.about, Topic::Study | Topic::Practice)
                || record.id == DISPERSIVE_WOULD_NOT_HOLD;
            let is_of_erosion = eroding.into_iter().any(|class| finding.is_against(class));
            let is_doubt = finding.entry.sets == Confidence::Outside
                && (finding.is_against(Verdict::None) || is_of_erosion);
            let is_named = record.id == "no_filter" || record.id == EVIDENCE_SAFE;
            if !is_doubt || (is_said && !is_named) {
                continue;
            }
            reasons += 1;
            let of = Reason::of(&record);
            let said = of.as_ref().map(Reason::in_words).unwrap_or_default();
            assert!(!said.is_empty() && !said.contains("NaN"), "{}: {said:?}", record.id);
        }
        assert!(reasons > 30, "{reasons}");
    }

    #[test]
    fn a_range_that_was_checked_stands_behind_what_lies_outside_it() {
        use crate::verdict::finding;
        let said = |finding: crate::verdict::Finding| Reason::of(&finding.record(true)).unwrap().in_words();
        assert_eq!(
            said(finding::cu_unchecked("filter", 35.4, 1.2, 6.0)),
            "Cu of the filter 35.4, checked for 1.2 to 6"
        );
        assert_eq!(said(finding::cohesive_fines(88.0)), "88 % fines");
        assert_eq!(said(finding::library_of_any_density(10.0)), "the filter's density is not known");
    }
}
