//! What every face says first: the line of practice, the line of the model, and what to do next.

use crate::outcome::digits::percent_span;
use crate::outcome::record::{FindingRecord, Model, Outcome};

/// Findings that stand on the first page and on a terminal; the rest stand further down the page.
pub const FOREMOST: usize = 3;

impl Outcome {
    /// The lines that every face begins with, each under its name: without two sieve curves in mm the model's
    /// alone.
    pub fn first_lines(&self) -> Vec<(&'static str, String)> {
        let model = ("Model (research)", self.model.words());
        match self.headline {
            Some(_) => {
                vec![("Practice", self.practice_in_words()), model, ("Next", self.next_in_words())]
            }
            None => vec![model],
        }
    }

    /// The findings that matter most, at most [`FOREMOST`], and how many more there are.
    pub fn foremost(&self) -> (&[FindingRecord], usize) {
        let (first, rest) = self.findings.split_at(self.findings.len().min(FOREMOST));
        (first, rest.len())
    }
}

impl Model {
    /// The class, and what eroded in each run.
    pub fn words(&self) -> String {
        let spans = self.eroded_percent.iter();
        let spans: Vec<String> =
            spans.map(|ends| percent_span(ends.map(|percent| (percent / 100.0).max(0.0)))).collect();
        format!("{}; {} eroded", self.class.words(), spans.join(" then "))
    }
}
