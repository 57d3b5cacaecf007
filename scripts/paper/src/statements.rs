//! What the paper states in numbers, ours beside it, and how the two are judged.

use serde::Deserialize;

use crate::measured::{Measured, Of};
use crate::measures::{Over, measure};
use crate::study::{Curves, Study, VARIANTS, Variant};
use voidwalk::report::quantity::{significant, whole};

const STATEMENTS: &str = include_str!("../data/statements.toml");

/// A number that the paper states, or a word for one.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statement {
    /// Name, unlike that of any other.
    pub id: String,
    /// Figure or table that it stands under.
    pub shown: String,
    /// Where the paper states it.
    pub place: String,
    /// Of what.
    pub says: String,
    /// What the paper states, in its words.
    pub states: String,
    /// `%` or nothing.
    #[serde(default)]
    pub unit: String,
    value: Option<f64>,
    tolerance: Option<f64>,
    at_most: Option<f64>,
    at_least: Option<f64>,
    /// Where the tolerance comes from.
    pub why: String,
    /// Whether it counts.
    #[serde(default)]
    standing: Standing,
    /// Name of the measure that gives ours.
    pub measure: String,
    #[serde(default)]
    of: Of,
}

/// Whether a comparison says anything of the model, and so counts as agreement or disagreement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Standing {
    /// It does.
    #[default]
    Counted,
    /// Ours is what the plan sets, so that it agrees or differs by construction.
    Set,
    /// Ours could hardly be otherwise, whatever the model: it is so vague.
    Always,
    /// Ours follows from a number of our own that was fitted to this one.
    Fitted,
    /// Ours is read off a curve of the authors' own.
    Theirs,
    /// Another reading of a statement that is counted already.
    Reading,
}

impl Standing {
    /// For programs.
    fn name(self) -> &'static str {
        match self {
            Standing::Counted => "counted",
            Standing::Set => "by construction",
            Standing::Always => "always",
            Standing::Fitted => "fitted",
            Standing::Theirs => "theirs",
            Standing::Reading => "reading",
        }
    }

    /// Why it does not count.
    fn reason(self) -> Option<&'static str> {
        match self {
            Standing::Counted => None,
            Standing::Set => Some("the plan sets it"),
            Standing::Always => Some("a spread that falls as any power of the length agrees"),
            Standing::Fitted => Some("fitted: our overlap for merging voids was chosen by Table 2"),
            Standing::Theirs => Some("the curve is the authors’ own"),
            Standing::Reading => Some("another reading of a statement that is counted already"),
        }
    }
}

/// How ours compares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judgement {
    /// Within what is stated, or the interval covers it.
    Agrees,
    /// Outside, by so much, above or below.
    Differs(f64),
    /// Not walked, or left open by the replicates.
    Inconclusive,
}

impl Statement {
    /// What agrees: from, to.
    fn allowed(&self) -> (f64, f64) {
        let around = self.value.zip(self.tolerance);
        let low = around.map(|(value, tolerance)| value - tolerance).or(self.at_least);
        let high = around.map(|(value, tolerance)| value + tolerance).or(self.at_most);
        (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY))
    }

    /// Whether it counts in a variant: what is read off a published curve is the authors' own, and no number
    /// of ours was fitted where voids are merged as the paper states.
    fn standing_with(&self, over: Over, variant: &Variant) -> Standing {
        match (self.standing, over, variant.curves) {
            (Standing::Counted | Standing::Fitted, Over::Curves, Curves::Published) => Standing::Theirs,
            (Standing::Fitted, _, Curves::AsStated) => Standing::Counted,
            (standing, ..) => standing,
        }
    }

    /// The rule: agrees when our value lies within what is stated, or our 95 % interval covers the stated
    /// value; inconclusive when nothing was walked, or when the interval lies on both sides of what decides;
    /// differs otherwise, by the distance to the nearest end.
    pub fn judge(&self, ours: Option<&Measured>) -> Judgement {
        let Some(ours) = ours.filter(|ours| !ours.open && !ours.value.is_nan()) else {
            return Judgement::Inconclusive;
        };
        let ((low, high), (from, to)) = (self.allowed(), ours.interval.unwrap_or((ours.value, ours.value)));
        // Rounding of decimal fractions decides nothing.
        let slack = 1e-9 * ours.value.abs().max(1.0);
        let within = |value: f64| value <= high + slack && value >= low - slack;
        if within(ours.value) || self.value.is_some_and(|stated| from <= stated && stated <= to) {
            return Judgement::Agrees;
        }
        if from <= high && to >= low {
            return Judgement::Inconclusive;
        }
        Judgement::Differs(if ours.value > high { ours.value - high } else { ours.value - low })
    }

    /// By how much a value differs: from what is stated, or from the limit that it breaks by `by`.
    fn difference(&self, value: f64, by: f64) -> String {
        let unit = if self.unit == "%" { "\u{202f}points" } else { "" };
        let from = self.value.map_or(by, |stated| value - stated);
        let number = Self::number(from.abs());
        let sign = if from < 0.0 { "−" } else { "+" };
        let of = if self.value.is_some() { "" } else { " from the limit" };
        format!("by {sign}{number}{unit}{of}")
    }

    fn number(value: f64) -> String {
        match value {
            v if v.fract() == 0.0 && v.abs() < 1e6 => (v as i64).to_string(),
            v if v.fract() == 0.0 && (0.0..1e18).contains(&v) => whole(v as u64).to_string(),
            v => significant(v).to_string(),
        }
    }

    /// A value as this statement shows it.
    pub fn show(&self, value: f64) -> String {
        let number = Self::number(value);
        if self.unit.is_empty() { number } else { format!("{number}\u{202f}{}", self.unit) }
    }
}

/// What a variant has in place of a number of the paper.
pub struct Ours {
    pub variant: &'static Variant,
    /// `None` where the measure says nothing about the variant.
    pub measured: Option<Measured>,
    pub judgement: Judgement,
    pub standing: Standing,
}

impl Ours {
    /// Judgement and standing in a word or two, for programs.
    fn words(&self) -> String {
        let judgement = match self.judgement {
            Judgement::Agrees => "agrees",
            Judgement::Differs(_) => "differs",
            Judgement::Inconclusive => "inconclusive",
        };
        match self.standing {
            Standing::Counted => judgement.into(),
            Standing::Set => self.standing.name().into(),
            other => format!("{}: {judgement}", other.name()),
        }
    }
}

/// A statement with ours, for every variant that was walked.
pub struct Judged {
    pub statement: Statement,
    /// The variant that the page is about first.
    pub variants: Vec<Ours>,
}

impl Judged {
    /// The variant that the page is about.
    pub fn ours(&self) -> (Option<&Measured>, Judgement) {
        self.variants
            .first()
            .map_or((None, Judgement::Inconclusive), |ours| (ours.measured.as_ref(), ours.judgement))
    }

    /// Whether it counts, in the variant that the page is about.
    pub fn standing(&self) -> Standing {
        self.variants.first().map_or(Standing::Counted, |ours| ours.standing)
    }

    /// Whether it counts as this kind of judgement.
    pub fn counts_as(&self, wanted: fn(Judgement) -> bool) -> bool {
        self.standing() == Standing::Counted && wanted(self.ours().1)
    }

    /// A sentence of judgement, with the experiments that explain a difference.
    pub fn sentence(&self) -> String {
        let judgement = match self.ours() {
            (_, Judgement::Agrees) => "agrees".into(),
            (None, _) => "inconclusive: not walked".into(),
            (Some(_), Judgement::Inconclusive) => "inconclusive: what was walked leaves both possible".into(),
            (Some(ours), Judgement::Differs(by)) => {
                format!("differs {}{}", self.statement.difference(ours.value, by), self.explained())
            }
        };
        match (self.standing().reason(), self.standing(), self.ours()) {
            (None, ..) => judgement,
            // That a setting is as in the paper is no agreement, nor is it explained by another setting.
            (Some(reason), Standing::Set, (Some(ours), Judgement::Differs(by))) => {
                format!("not counted: {reason}; differs {}", self.statement.difference(ours.value, by))
            }
            (Some(reason), Standing::Set, _) => format!("not counted: {reason}"),
            (Some(reason), ..) => format!("{judgement}. Not counted: {reason}"),
        }
    }

    /// What the other variants have beside a number that does not count: their title and value.
    pub fn beside(&self) -> Vec<(&'static str, String)> {
        let others = self.variants.iter().skip(1).filter(|_| self.standing() == Standing::Fitted);
        let value =
            |ours: &Ours| Some((ours.variant.title, self.statement.show(ours.measured.as_ref()?.value)));
        others.filter_map(value).collect()
    }

    fn explained(&self) -> String {
        let titles = |wanted: fn(&Judgement) -> bool| -> Vec<&str> {
            let others = self.variants.iter().skip(1);
            others
                .filter(|ours| ours.measured.is_some() && wanted(&ours.judgement))
                .map(|ours| ours.variant.title)
                .collect()
        };
        let agree = titles(|judgement| *judgement == Judgement::Agrees);
        let tried = titles(|_| true);
        match (agree.is_empty(), tried.is_empty()) {
            (false, _) => format!("; agrees with {}", agree.join("; with ")),
            (true, false) => format!("; so with {}", tried.join("; with ")),
            (true, true) => String::new(),
        }
    }
}

/// All statements, in the order of the paper.
///
/// # Panics
/// If the embedded file cannot be read; it is read in a test.
pub fn statements() -> Vec<Statement> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        statement: Vec<Statement>,
    }
    toml::from_str::<File>(STATEMENTS).expect("statements.toml").statement
}

/// Every statement with ours beside it.
pub fn judged(study: &Study) -> Vec<Judged> {
    let one = |statement: Statement| {
        let found = measure(&statement.measure);
        let variants = VARIANTS.iter().filter_map(|variant| {
            let (over, measure) = found.filter(|(over, _)| over.takes(variant))?;
            let measured = measure(study, variant.name, &statement.of);
            // A variant that says nothing about it is left out, but never the first.
            (measured.is_some() || variant.name == VARIANTS[0].name).then(|| {
                let judgement = statement.judge(measured.as_ref());
                Ours { variant, measured, judgement, standing: statement.standing_with(over, variant) }
            })
        });
        let variants = variants.collect();
        Judged { statement, variants }
    };
    statements().into_iter().map(one).collect()
}

/// The statements as a CSV table, one line a statement and variant. `judgement` is agrees, differs or
/// inconclusive where it counts, and begins otherwise with the reason why it does not.
pub fn table(all: &[Judged]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = [
        "id",
        "shown",
        "place",
        "says",
        "states",
        "allowed_from",
        "allowed_to",
        "why",
        "variant",
        "ours",
        "low",
        "high",
        "words",
        "judgement",
        "differs_by",
    ];
    let number = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    let mut rows: Vec<Vec<String>> = vec![header.map(String::from).to_vec()];
    for judged in all {
        let s = &judged.statement;
        let (from, to) = s.allowed();
        for found in &judged.variants {
            let ours = found.measured.as_ref();
            let by = match found.judgement {
                Judgement::Differs(by) => Some(by),
                _ => None,
            };
            let interval = ours.and_then(|ours| ours.interval);
            let mut row: Vec<String> =
                [&s.id, &s.shown, &s.place, &s.says, &s.states].map(String::clone).to_vec();
            row.extend([number(from), number(to), s.why.clone(), found.variant.name.to_string()]);
            row.extend(
                [ours.map(|o| o.value), interval.map(|i| i.0), interval.map(|i| i.1)]
                    .map(|v| v.map_or(String::new(), number)),
            );
            row.extend([
                ours.map_or(String::new(), |o| o.words.clone()),
                found.words(),
                by.map_or(String::new(), number),
            ]);
            rows.push(row);
        }
    }
    // Writing to memory fails only for rows of unequal length, which these are not.
    rows.iter().for_each(|row| writer.write_record(row).expect("rows of equal length"));
    String::from_utf8(writer.into_inner().expect("memory")).expect("UTF-8 in, UTF-8 out")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_statement_can_be_measured_and_judged() {
        let all = statements();
        assert!(all.len() >= 30, "{}", all.len());
        assert_eq!(all.iter().map(|s| &s.id).collect::<BTreeSet<_>>().len(), all.len());
        for s in &all {
            assert!(measure(&s.measure).is_some(), "{}: there is no measure `{}`", s.id, s.measure);
            assert_eq!(s.value.is_some(), s.tolerance.is_some(), "{}", s.id);
            let limits = s.at_most.is_some() || s.at_least.is_some();
            assert!(s.value.is_some() != limits, "{}: either a value or limits", s.id);
            let (low, high) = s.allowed();
            assert!(low <= high, "{}", s.id);
            let known = ["printed", "exact", "about", "derived", "sample", "rerun", "word"];
            assert!(known.iter().any(|kind| s.why.starts_with(kind)), "{}: {}", s.id, s.why);
        }
        let used: BTreeSet<&str> = all.iter().map(|s| s.measure.as_str()).collect();
        for (name, ..) in crate::measures::MEASURES {
            assert!(used.contains(name), "no statement uses `{name}`");
        }
    }

    /// A statement judged for the first variant, whatever was measured.
    fn judged_with(id: &str, value: f64) -> Judged {
        let statement = statements().into_iter().find(|s| s.id == id).unwrap();
        let (variant, measured) = (&VARIANTS[0], Some(Measured::exact(value)));
        let judgement = statement.judge(measured.as_ref());
        let (over, _) = measure(&statement.measure).unwrap();
        let standing = statement.standing_with(over, variant);
        Judged { statement, variants: vec![Ours { variant, measured, judgement, standing }] }
    }

    #[test]
    fn what_is_set_fitted_or_read_twice_does_not_count() {
        let said = |id: &str, value| {
            let judged = judged_with(id, value);
            (judged.counts_as(|_| true), judged.variants[0].words(), judged.sentence())
        };
        let (counts, words, sentence) = said("voids", 96000.0);
        assert_eq!((counts, words.as_str()), (false, "by construction"));
        assert_eq!(sentence, "not counted: the plan sets it");
        let (counts, words, sentence) = said("percolation", 0.13);
        assert_eq!((counts, words.as_str()), (false, "always: agrees"));
        assert!(sentence.starts_with("agrees. Not counted: a spread"), "{sentence}");
        let (counts, words, sentence) = said("combinations", 78.0);
        assert_eq!((counts, words.as_str()), (false, "by construction"));
        assert_eq!(sentence, "not counted: the plan sets it; differs by +12");
        let (counts, words, sentence) = said("csd-cu1.5-loose", 1.6);
        assert_eq!((counts, words.as_str()), (false, "fitted: agrees"));
        assert!(sentence.starts_with("agrees. Not counted: fitted"), "{sentence}");
        let (counts, words, _) = said("per-void-cubic-both", 20.0);
        assert_eq!((counts, words.as_str()), (false, "reading: differs"));
        let (counts, words, sentence) = said("per-void-cubic", 96.0);
        assert_eq!((counts, words.as_str(), sentence.as_str()), (true, "agrees", "agrees"));
    }

    #[test]
    fn whose_a_curve_is_decides_whether_its_numbers_count() {
        let with = |id: &str, name: &str| {
            let s = statements().into_iter().find(|s| s.id == id).unwrap();
            let (over, _) = measure(&s.measure).unwrap();
            s.standing_with(over, crate::study::variant_of(name).unwrap())
        };
        assert_eq!(with("csd-cu1.5-loose", "paper"), Standing::Fitted);
        assert_eq!(with("csd-cu1.5-loose", "paper-hull"), Standing::Theirs);
        assert_eq!(with("csd-cu1.5-loose", "overlap-0.5"), Standing::Counted);
        assert_eq!(with("finer-cu1.5", "paper-hull"), Standing::Theirs);
        assert_eq!(with("43", "paper-hull"), Standing::Counted);
    }

    #[test]
    fn the_rule_of_judgement() {
        let s = statements().into_iter().find(|s| s.id == "43").unwrap();
        assert_eq!(s.difference(36.0, -2.0), "by −7\u{202f}points");
        let of = |value, interval| Measured { interval, ..Measured::exact(value) };
        assert_eq!(s.judge(Some(&of(47.9, None))), Judgement::Agrees);
        assert_eq!(s.judge(Some(&of(50.0, Some((42.0, 58.0))))), Judgement::Agrees);
        assert_eq!(s.judge(Some(&of(50.0, Some((47.0, 53.0))))), Judgement::Inconclusive);
        assert_eq!(s.judge(Some(&of(50.0, Some((49.0, 51.0))))), Judgement::Differs(2.0));
        assert_eq!(s.judge(Some(&of(36.0, None))), Judgement::Differs(-2.0));
        assert_eq!(s.judge(None), Judgement::Inconclusive);
        assert_eq!(s.judge(Measured::exceptions(0, 2, 9).as_ref()), Judgement::Inconclusive);
    }
}
