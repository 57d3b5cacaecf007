//! What a class means, and the headline.

use crate::outcome::record::{Confidence, FindingRecord, Outcome, RunSummary, Verdict};
use crate::outcome::undecided::UndecidedBy;

impl UndecidedBy {
    /// Why, in a sentence without its end.
    pub fn words(self) -> &'static str {
        match self {
            Self::Pan => {
                "the finest part of the base, whose sizes the sieves do not tell, decides between the classes"
            }
            Self::Curve => {
                "the constriction curve is known within a range only, and its ends do not give one class"
            }
            Self::SecondRun => {
                "some and continuing erosion differ by the second run, and only a first was asked for"
            }
            Self::Replicates => "the replicates do not separate the classes; more replicates may decide it",
        }
    }
}

impl Outcome {
    /// The verdict in a line, with the first sentence of what speaks most against it.
    pub fn headline(&self) -> String {
        let verdict = self.verdict.words();
        match (self.verdict, self.confidence, self.reasons.first()) {
            (_, Confidence::Within, _) | (_, _, None) => verdict.to_owned(),
            // No reason of an unfavourable verdict makes the filter a better one; they follow below it.
            (Verdict::Continuing, ..) => format!("{verdict} in the model"),
            (Verdict::None, Confidence::Unstable, _) => {
                format!("{verdict} only while the filter keeps its own fines, which it may lose")
            }
            (.., Some(reason)) => format!("{verdict} in the model; {}", clause(reason)),
        }
    }

    /// What speaks against the verdict and does not stand in the headline.
    pub fn reasons_below(&self) -> Vec<FindingRecord> {
        let is_said = self.verdict != Verdict::Continuing
            && !(self.verdict == Verdict::None && self.confidence == Confidence::Unstable);
        let mut against = self.against();
        if is_said && !against.is_empty() {
            against.remove(0);
        }
        against
    }

    /// How the other points of a study are classed, where their classes know nothing of what leaves the
    /// verdict undecided.
    pub fn points_are(&self) -> Option<&'static str> {
        if self.verdict != Verdict::Undecided && self.class_of_curve() != self.verdict {
            return Some("by the curve itself");
        }
        let level = self.stopping.as_ref().and_then(|stopping| stopping.decide_percent);
        match self.undecided_by()? {
            UndecidedBy::Pan => Some("with the base's finest part finer than every constriction"),
            UndecidedBy::Curve => Some("by the curve itself"),
            UndecidedBy::SecondRun | UndecidedBy::Replicates => level.map(|_| "by their 95 % intervals"),
        }
    }
}

/// The first clause of a sentence, as it stands behind a semicolon; the rest stands where all findings do.
pub fn clause(sentence: &str) -> String {
    let ends = ["; ", ". "].into_iter().filter_map(|end| sentence.find(end));
    within(&sentence[..ends.min().unwrap_or(sentence.len())])
}

/// A text with a capital letter at its beginning.
pub fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

/// A sentence as it stands within another.
pub fn within(sentence: &str) -> String {
    let mut chars = sentence.trim_end_matches('.').chars();
    chars.next().map_or(String::new(), |c| c.to_lowercase().chain(chars).collect())
}

/// What a class means, in a sentence, of runs whose means these are.
pub fn meaning(verdict: Verdict, summary: &[RunSummary], threshold: f64) -> String {
    let limit = format!("{}\u{202f}%", (1e4 * threshold).round() / 1e2);
    let run = if verdict == Verdict::Continuing { 1 } else { 0 };
    let here = summary.get(run).is_none_or(|run| run.eroded_mass_fraction.mean >= threshold);
    let of_range = match verdict {
        Verdict::Some | Verdict::Continuing if !here => {
            " The filter’s constrictions may be coarser than those of the table, and with the coarsest it \
             comes to this class."
        }
        _ => "",
    };
    let class = match verdict {
        Verdict::None => format!(
            "In the model the filter holds this base: less than {limit} of its mass passes in the first run."
        ),
        Verdict::Some => format!(
            "In the model the filter seals after some erosion: {limit} or more of the base passes in the \
             first run, less in the second, on the constrictions that the first left blocked."
        ),
        Verdict::Continuing => format!(
            "In the model the filter does not hold this base: {limit} or more of its mass passes in the \
             first run and again in the second."
        ),
        Verdict::Undecided => undecided(summary, threshold, &limit),
    };
    class + of_range
}

fn undecided(summary: &[RunSummary], threshold: f64, limit: &str) -> String {
    let straddles = |run: &&RunSummary| {
        let eroded = &run.eroded_mass_fraction;
        eroded.low.zip(eroded.high).is_some_and(|(low, high)| low < threshold && threshold <= high)
    };
    let name = |run: &RunSummary| if run.run == 1 { "first run" } else { "second run" };
    let runs: Vec<&str> = summary.iter().filter(straddles).map(name).collect();
    if !runs.is_empty() {
        let plural = if runs.len() > 1 { "intervals of the " } else { "interval of the " };
        return format!("Inconclusive: the {plural}{} includes {limit}.", runs.join(" and the "));
    }
    let by = match summary {
        [first] if first.eroded_mass_fraction.mean >= threshold => UndecidedBy::SecondRun.words(),
        _ => "these replicates do not separate the classes",
    };
    format!("Inconclusive: {by}.")
}
