//! The classes of the model.

use crate::outcome::record::{RunSummary, Verdict};
use crate::outcome::undecided::UndecidedBy;

/// The reason why a class is undecided, in a sentence without its end.
pub fn undecided_by(cause: UndecidedBy) -> &'static str {
    match cause {
        UndecidedBy::Curve => {
            "the constriction curve is known within a range only, and its ends do not give one class"
        }
        UndecidedBy::SecondRun => {
            "some and continuing erosion differ by the second run, and only a first was asked for"
        }
        UndecidedBy::Replicates => {
            "the replicates do not separate the classes; more replicates may decide it"
        }
    }
}

/// A text with a capital letter at its beginning.
pub fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

/// Meaning of a class, in a sentence, for runs with these means.
pub fn meaning(verdict: Verdict, summary: &[RunSummary], threshold: f64) -> String {
    let limit = format!("{}\u{202f}%", (1e4 * threshold).round() / 1e2);
    match verdict {
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
    }
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
        [first] if first.eroded_mass_fraction.mean >= threshold => undecided_by(UndecidedBy::SecondRun),
        _ => "these replicates do not separate the classes",
    };
    format!("Inconclusive: {by}.")
}
