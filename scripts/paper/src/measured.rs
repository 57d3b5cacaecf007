//! What a measure gives, and what it is of.

use serde::Deserialize;

use voidwalk::outcome::record::Statistic;

/// What we have in place of a number of the paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// In the units of the statement.
    pub value: f64,
    /// 95 % interval, where there is one.
    pub interval: Option<(f64, f64)>,
    /// Said with the number.
    pub words: String,
    /// Whether the replicates leave it open.
    pub open: bool,
}

impl Measured {
    /// A number without an interval.
    pub fn exact(value: f64) -> Self {
        Self { value, interval: None, words: String::new(), open: false }
    }

    /// A mean with its interval.
    pub fn of(statistic: &Statistic) -> Self {
        let interval = statistic.low.zip(statistic.high);
        Self { value: statistic.mean, interval, words: String::new(), open: false }
    }

    /// With words.
    pub fn saying(self, words: impl Into<String>) -> Self {
        Self { words: words.into(), ..self }
    }

    /// Exceptions to a rule: those that are certain and those that the replicates leave open, of `all`.
    pub fn exceptions(certain: usize, open: usize, all: usize) -> Option<Self> {
        let or_more = if open > 0 { format!(", {open} undecided") } else { String::new() };
        (all > 0).then(|| Self {
            value: certain as f64,
            interval: (open > 0).then_some((certain as f64, (certain + open) as f64)),
            words: format!("of {all}{or_more}"),
            open: certain == 0 && open > 0,
        })
    }
}

/// What a measure is of; each reads what it needs.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Of {
    pub filter: String,
    pub cu_b: String,
    pub d85b: String,
    pub case: String,
    pub class: String,
    pub run: usize,
    /// How many runs are counted together.
    pub runs: usize,
    /// What a spread is to keep within.
    pub within: f64,
    pub connectivity: u64,
    pub at: String,
    pub to: String,
}

impl Of {
    /// The levels that are named.
    pub fn levels(&self) -> Vec<(&str, &str)> {
        [("filter", &self.filter), ("cu_b", &self.cu_b), ("d85b", &self.d85b)]
            .into_iter()
            .filter(|(_, level)| !level.is_empty())
            .map(|(factor, level)| (factor, level.as_str()))
            .collect()
    }
}
