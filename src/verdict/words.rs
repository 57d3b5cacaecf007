//! What a class means.

use crate::outcome::record::{Outcome, RunSummary, Verdict};
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
    /// How the other points of a study are classed, where their classes know nothing of what leaves the
    /// verdict undecided, or of the ends of the constriction curve's range.
    pub fn points_are(&self) -> Option<&'static str> {
        // The ends of a range are walked with the thickness and the base of the scene alone.
        let of_range = self.curve_range.as_ref().map(|_| "by the curve itself");
        let level = self.stopping.as_ref().and_then(|stopping| stopping.decide_percent);
        match self.undecided_by() {
            Some(UndecidedBy::Pan) => Some("with the base's finest part finer than every constriction"),
            Some(UndecidedBy::SecondRun | UndecidedBy::Replicates) if level.is_some() => {
                Some("by their 95 % intervals")
            }
            _ => of_range,
        }
    }
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
            " The table below is of the curve itself. The filter’s constrictions may be coarser, and the \
             coarsest of their range give this class."
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
