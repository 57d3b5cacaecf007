//! The lines at the top of every face: practice, the model, and the next step.

use super::next::next;
use super::practice::practice_line;
use crate::outcome::record::{Model, Outcome};
use voidwalk_practice::Decision;
use voidwalk_practice::Note;
use voidwalk_practice::quantity::{SizeUnit, percent};

/// Most notes in a brief verdict of a run, and in the answer on boundaries, which counts the others.
pub const FOREMOST: usize = 3;

/// A line at the top of every face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstLine {
    /// The answer of practice.
    Practice,
    /// The class of the walk.
    Model,
    /// A step to take next.
    Next,
}

impl FirstLine {
    /// The name before the line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Practice => "Practice",
            Self::Model => "Model (research)",
            Self::Next => "Next",
        }
    }
}

/// The lines at the top of every face: without two sieve curves in mm the model's alone.
pub fn first_lines(outcome: &Outcome, decision: &Decision, unit: SizeUnit) -> Vec<(FirstLine, String)> {
    let line = (FirstLine::Model, model(&outcome.model));
    match decision.headline {
        Some(_) => vec![
            (FirstLine::Practice, practice_line(decision, unit)),
            line,
            (FirstLine::Next, next(outcome, decision, unit)),
        ],
        None => vec![line],
    }
}

/// The notes that matter most, at most [`FOREMOST`], and the number of the others.
pub fn foremost(outcome: &Outcome) -> (&[Note], usize) {
    let (first, rest) = outcome.notes.split_at(outcome.notes.len().min(FOREMOST));
    (first, rest.len())
}

/// The class of a walk, and the mass eroded in each run.
pub fn model(model: &Model) -> String {
    let part = |percentage: f64| percent((percentage / 100.0).max(0.0));
    let run = |(run, [low, high]): (usize, &[f64; 2])| {
        let eroded = part(*low).to(part(*high));
        match run {
            0 => format!("{eroded} eroded"),
            1 => format!("second run: {eroded}"),
            _ => format!("run {}: {eroded}", run + 1),
        }
    };
    let runs: Vec<String> = model.eroded_percent.iter().enumerate().map(run).collect();
    format!("{}; {}", model.class.words(), runs.join(", "))
}
