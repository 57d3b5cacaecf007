//! Exit codes of the program, and the verdicts that a caller does not accept.

use clap::ValueEnum;

use crate::outcome::record::Verdict;
use crate::run::{Exit, RunError};

/// Every exit code and its meaning; help, manual pages and guide show this table.
pub(crate) const EXIT_CODES: [(u8, &str); 5] = [
    (0, "done"),
    (Exit::Failed.code(), "failed"),
    (
        Exit::Refused.code(),
        "refused before any work, and nothing was written: the message says what to change",
    ),
    (Exit::Stopped.code(), "stopped on request; progress is saved, and the message says how to continue"),
    (Exit::NotAccepted.code(), "done and written, but the verdict is one that `--fail-on` does not accept"),
];

pub(crate) fn in_words() -> String {
    let lines = EXIT_CODES.map(|(code, meaning)| format!("  {code}  {meaning}\n"));
    format!("Exit codes:\n{}", lines.concat())
}

/// Answers that are not accepted, by the worse of practice and model; an unknown answer is never accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FailOn {
    /// Some erosion, continuing erosion, undecided; practice not met or not known
    Some,
    /// Continuing erosion, undecided; practice not known, or not met with continuing erosion not excluded
    Continuing,
}

#[derive(Clone, Copy)]
pub(crate) struct JudgedAnswer {
    pub(crate) model: Verdict,
    /// Class that practice counts as; `None` if no rule was applied.
    pub(crate) practice: Option<Verdict>,
}

impl FailOn {
    fn refused(self, answer: JudgedAnswer) -> Option<String> {
        match answer.practice.filter(|class| self.refuses(*class)) {
            Some(Verdict::Undecided) => Some("practice is not known".into()),
            Some(class) => Some(format!("practice is not met ({} not excluded)", class.words())),
            None => self.refuses(answer.model).then(|| format!("{} in the model", answer.model.words())),
        }
    }

    fn refuses(self, class: Verdict) -> bool {
        match self {
            Self::Some => class != Verdict::None,
            Self::Continuing => matches!(class, Verdict::Continuing | Verdict::Undecided),
        }
    }
}

/// Ends a command by the verdicts of its cases, each with its name. The error names the cases that are not
/// accepted, with the reasons of those that were not walked.
pub(crate) fn accept<'a>(
    fail_on: Option<FailOn>,
    cases: impl IntoIterator<Item = (&'a str, Result<JudgedAnswer, &'a str>)>,
) -> Result<(), RunError> {
    let Some(fail_on) = fail_on else { return Ok(()) };
    let refused = |walked: Result<JudgedAnswer, &str>| match walked {
        Ok(answer) => fail_on.refused(answer),
        Err(why) => Some(format!("not walked ({why})")),
    };
    let line = |name: &str, why: String| {
        if name.is_empty() { why } else { format!("{name}: {why}") }
    };
    let not_accepted: Vec<String> =
        cases.into_iter().filter_map(|(name, walked)| Some(line(name, refused(walked)?))).collect();
    match not_accepted.is_empty() {
        true => Ok(()),
        false => Err(RunError::NotAccepted(format!(
            "{}, with --fail-on {}; the results are written",
            not_accepted.join("; "),
            fail_on.to_possible_value().expect("no value is skipped").get_name()
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worse_of_practice_and_model_decides() {
        let accepted = |class| match class {
            Verdict::None => [true, true],
            Verdict::Some => [false, true],
            Verdict::Continuing | Verdict::Undecided => [false, false],
        };
        let practices = Verdict::ALL.map(Some).into_iter().chain([None]);
        for (model, practice) in practices.flat_map(|practice| Verdict::ALL.map(|model| (model, practice))) {
            let answer = JudgedAnswer { model, practice };
            let by_practice = practice.map_or([true, true], accepted);
            for (index, fail_on) in FailOn::value_variants().iter().enumerate() {
                let wanted = accepted(model)[index] && by_practice[index];
                assert_eq!(
                    accept(Some(*fail_on), [("a", Ok(answer))]).is_ok(),
                    wanted,
                    "{model:?} {practice:?}"
                );
            }
            assert!(accept(None, [("a", Ok(answer))]).is_ok());
        }
    }

    #[test]
    fn a_case_that_was_not_walked_is_not_accepted() {
        let within = Ok(JudgedAnswer { model: Verdict::None, practice: Some(Verdict::None) });
        for choice in FailOn::value_variants() {
            assert!(accept(Some(*choice), [("a", within)]).is_ok());
            let problem = accept(Some(*choice), [("a", within), ("b", Err("no table"))]).unwrap_err();
            assert!(problem.to_string().starts_with("b: not walked (no table), with"), "{problem}");
        }
        assert!(accept(None, [("b", Err("no table"))]).is_ok());
    }

    #[test]
    fn the_guide_shows_every_exit_code() {
        let guide = include_str!("../../docs/stability.md");
        for (code, meaning) in EXIT_CODES {
            assert!(guide.contains(&format!("| {code} | {meaning} |\n")), "{code}: {meaning}");
        }
        let codes = EXIT_CODES.map(|(code, _)| code);
        assert_eq!(codes, [0, 1, 2, 3, 4]);
    }
}
