//! What the paper states in numbers, ours beside it, and how the two are judged.

use serde::Deserialize;

use crate::measured::{Measured, Of};
use crate::measures::measure;
use crate::study::{Study, VARIANTS, Variant};
use voidwalk::report::numbers::{significant, whole};

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
    /// Name of the measure that gives ours.
    pub measure: String,
    #[serde(default)]
    of: Of,
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
            v if v.fract() == 0.0 && (0.0..1e18).contains(&v) => whole(v as u64),
            v => significant(v),
        }
    }

    /// A value as this statement shows it.
    pub fn show(&self, value: f64) -> String {
        let number = Self::number(value);
        if self.unit.is_empty() { number } else { format!("{number}\u{202f}{}", self.unit) }
    }
}

/// A statement with ours, for every variant that was walked.
pub struct Judged {
    pub statement: Statement,
    /// Ours and its judgement, the variant that the page is about first; `None` where a measure says nothing
    /// about a variant.
    pub variants: Vec<(&'static Variant, Option<Measured>, Judgement)>,
}

impl Judged {
    /// The variant that the page is about.
    pub fn ours(&self) -> (Option<&Measured>, Judgement) {
        self.variants
            .first()
            .map_or((None, Judgement::Inconclusive), |(_, ours, judgement)| (ours.as_ref(), *judgement))
    }

    /// A sentence of judgement, with the experiments that explain a difference.
    pub fn sentence(&self) -> String {
        match self.ours() {
            (_, Judgement::Agrees) => "agrees".into(),
            (None, _) => "inconclusive: not walked".into(),
            (Some(_), Judgement::Inconclusive) => "inconclusive: the replicates leave both possible".into(),
            (Some(ours), Judgement::Differs(by)) => {
                format!("differs {}{}", self.statement.difference(ours.value, by), self.explained())
            }
        }
    }

    fn explained(&self) -> String {
        let titles = |wanted: fn(&Judgement) -> bool| -> Vec<&str> {
            let others = self.variants.iter().skip(1);
            others
                .filter(|(_, ours, j)| ours.is_some() && wanted(j))
                .map(|(variant, ..)| variant.title)
                .collect()
        };
        let agree = titles(|judgement| *judgement == Judgement::Agrees);
        let tried = titles(|_| true);
        match (agree.is_empty(), tried.is_empty()) {
            (false, _) => format!("; agrees with {}", agree.join("; with ")),
            (true, false) => format!("; so with {}", tried.join(", ")),
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
            let (_, measure) = found.filter(|(over, _)| over.takes(variant.name))?;
            let ours = measure(study, variant.name, &statement.of);
            // A variant that says nothing about it is left out, but never the first.
            (ours.is_some() || variant.name == VARIANTS[0].name).then(|| {
                let judgement = statement.judge(ours.as_ref());
                (variant, ours, judgement)
            })
        });
        let variants = variants.collect();
        Judged { statement, variants }
    };
    statements().into_iter().map(one).collect()
}

/// The statements as a CSV table, one line a statement and variant.
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
        for (variant, ours, judgement) in &judged.variants {
            let (word, by) = match judgement {
                Judgement::Agrees => ("agrees", None),
                Judgement::Differs(by) => ("differs", Some(*by)),
                Judgement::Inconclusive => ("inconclusive", None),
            };
            let interval = ours.as_ref().and_then(|ours| ours.interval);
            let mut row: Vec<String> =
                [&s.id, &s.shown, &s.place, &s.says, &s.states].map(String::clone).to_vec();
            row.extend([number(from), number(to), s.why.clone(), variant.name.to_string()]);
            row.extend(
                [ours.as_ref().map(|o| o.value), interval.map(|i| i.0), interval.map(|i| i.1)]
                    .map(|v| v.map_or(String::new(), number)),
            );
            row.extend([
                ours.as_ref().map_or(String::new(), |o| o.words.clone()),
                word.into(),
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
            let known = ["printed", "exact", "about", "sample", "rerun", "word"];
            assert!(known.iter().any(|kind| s.why.starts_with(kind)), "{}: {}", s.id, s.why);
        }
        let used: BTreeSet<&str> = all.iter().map(|s| s.measure.as_str()).collect();
        for (name, ..) in crate::measures::MEASURES {
            assert!(used.contains(name), "no statement uses `{name}`");
        }
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
