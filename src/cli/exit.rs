//! How the program ends: its exit codes, and the verdicts that a caller does not accept.

use clap::ValueEnum;

use crate::outcome::record::{Confidence, Verdict};
use crate::run::{Exit, RunError};

/// Every exit code and what it means: help, manual pages and guide show this table.
pub const EXIT_CODES: [(u8, &str); 5] = [
    (0, "done"),
    (Exit::Failed.code(), "failed; of `voidwalk reproduce` also: not the same"),
    (
        Exit::Refused.code(),
        "refused before any work, and nothing was written: the message says what to change",
    ),
    (Exit::Stopped.code(), "stopped on request; progress is saved, and the message says how to continue"),
    (Exit::NotAccepted.code(), "done and written, but the verdict is one that `--fail-on` does not accept"),
];

/// The table in words, a line a code.
pub fn in_words() -> String {
    let lines = EXIT_CODES.map(|(code, meaning)| format!("  {code}  {meaning}\n"));
    format!("Exit codes:\n{}", lines.concat())
}

/// Which answers are not accepted, by the worse of walk and practice. What nobody can say never is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FailOn {
    /// Some erosion, continuing erosion, undecided; practice not met or not known
    Some,
    /// Continuing erosion, undecided; practice not known, or not met with continuing erosion not excluded
    Continuing,
    /// Anything but practice met and no erosion within the checked range
    Doubt,
}

/// What a walk and practice say of a case.
#[derive(Clone, Copy)]
pub struct JudgedAnswer {
    pub verdict: Verdict,
    pub confidence: Confidence,
    /// The class as which practice counts; `None` where no rule was applied.
    pub by_practice: Option<Verdict>,
}

impl FailOn {
    /// Why an answer is not accepted, by the worse of walk and practice; `None` where it is.
    fn refused(self, answer: JudgedAnswer) -> Option<String> {
        let JudgedAnswer { verdict, confidence, by_practice } = answer;
        if self.refuses(verdict, confidence) {
            return Some(format!("{} ({})", verdict.words(), confidence.words()));
        }
        match by_practice.filter(|of| self.refuses(*of, Confidence::Within))? {
            Verdict::Undecided => Some("nobody can say by practice".into()),
            class => Some(format!("practice is not met ({} not excluded)", class.words())),
        }
    }

    fn refuses(self, verdict: Verdict, confidence: Confidence) -> bool {
        match self {
            Self::Some => verdict != Verdict::None,
            Self::Continuing => matches!(verdict, Verdict::Continuing | Verdict::Undecided),
            Self::Doubt => (verdict, confidence) != (Verdict::None, Confidence::Within),
        }
    }

    /// Its word on the command line.
    fn word(self) -> &'static str {
        match self {
            Self::Some => "some",
            Self::Continuing => "continuing",
            Self::Doubt => "doubt",
        }
    }
}

/// Ends a command by the verdicts of its cases, each with its name.
///
/// # Errors
/// The cases whose verdict is not accepted.
pub fn accept<'a>(
    fail_on: Option<FailOn>,
    cases: impl IntoIterator<Item = (&'a str, JudgedAnswer)>,
) -> Result<(), RunError> {
    accept_walked(fail_on, cases.into_iter().map(|(name, answer)| (name, Ok(answer))))
}

/// As [`accept`], of cases of which some were not walked: why. Those are not accepted.
///
/// # Errors
/// The cases whose verdict is not accepted, or not known.
pub fn accept_walked<'a>(
    fail_on: Option<FailOn>,
    cases: impl IntoIterator<Item = (&'a str, Result<JudgedAnswer, &'a str>)>,
) -> Result<(), RunError> {
    let Some(fail_on) = fail_on else { return Ok(()) };
    let refused = |walked: Result<JudgedAnswer, &str>| match walked {
        Ok(answer) => fail_on.refused(answer),
        Err(why) => Some(format!("not walked ({why})")),
    };
    let said = |name: &str, why: String| {
        if name.is_empty() { why } else { format!("{name}: {why}") }
    };
    let not_accepted: Vec<String> =
        cases.into_iter().filter_map(|(name, walked)| Some(said(name, refused(walked)?))).collect();
    match not_accepted.is_empty() {
        true => Ok(()),
        false => Err(RunError::NotAccepted(format!(
            "{}, with --fail-on {}; the results are written",
            not_accepted.join("; "),
            fail_on.word()
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_undecided_verdict_is_never_accepted_and_doubt_accepts_one_answer_alone() {
        let every = [Confidence::Within, Confidence::MaySegregate, Confidence::Outside]
            .map(|confidence| Verdict::ALL.map(|verdict| (verdict, confidence)));
        for (verdict, confidence) in every.concat() {
            let accepted = FailOn::value_variants()
                .iter()
                .map(|of| accept(Some(*of), [("a", met(verdict, confidence))]).is_ok());
            let expected = match (verdict, confidence) {
                (Verdict::None, Confidence::Within) => [true, true, true],
                (Verdict::None, _) => [true, true, false],
                (Verdict::Some, _) => [false, true, false],
                _ => [false; 3],
            };
            assert_eq!(accepted.collect::<Vec<_>>(), expected, "{verdict:?}, {confidence:?}");
            assert!(accept(None, [("a", met(verdict, confidence))]).is_ok());
        }
    }

    fn met(verdict: Verdict, confidence: Confidence) -> JudgedAnswer {
        JudgedAnswer { verdict, confidence, by_practice: Some(Verdict::None) }
    }

    #[test]
    fn the_worse_of_practice_and_walk_decides() {
        for (by_practice, accepted) in [
            (None, [true; 3]),
            (Some(Verdict::None), [true; 3]),
            (Some(Verdict::Some), [false, true, false]),
            (Some(Verdict::Continuing), [false; 3]),
            (Some(Verdict::Undecided), [false; 3]),
        ] {
            let answer = JudgedAnswer { by_practice, ..met(Verdict::None, Confidence::Within) };
            let each = FailOn::value_variants().iter().map(|of| accept(Some(*of), [("a", answer)]).is_ok());
            assert_eq!(each.collect::<Vec<_>>(), accepted, "{by_practice:?}");
        }
    }

    #[test]
    fn a_case_that_was_not_walked_is_not_accepted() {
        let within = Ok(met(Verdict::None, Confidence::Within));
        for of in FailOn::value_variants() {
            assert!(accept_walked(Some(*of), [("a", within)]).is_ok());
            let problem = accept_walked(Some(*of), [("a", within), ("b", Err("no table"))]).unwrap_err();
            assert!(problem.to_string().starts_with("b: not walked (no table), with"), "{problem}");
        }
        assert!(accept_walked(None, [("b", Err("no table"))]).is_ok());
    }

    #[test]
    fn the_guide_shows_every_exit_code() {
        let guide = include_str!("../docs/stability.md");
        for (code, meaning) in EXIT_CODES {
            assert!(guide.contains(&format!("| {code} | {meaning} |\n")), "{code}: {meaning}");
        }
        let codes = EXIT_CODES.map(|(code, _)| code);
        assert_eq!(codes, [0, 1, 2, 3, 4]);
    }

    #[test]
    fn the_words_are_those_of_the_command_line() {
        for of in FailOn::value_variants() {
            assert_eq!(of.to_possible_value().unwrap().get_name(), of.word());
        }
    }
}
