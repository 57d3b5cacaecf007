//! What was found about a verdict, as it is written.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// A finding about a verdict: what it is about, which way it points, and its sentence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FindingRecord {
    /// Its name for programs, as `cohesive_fines`; empty of folders of earlier versions.
    #[serde(default)]
    pub id: String,
    /// What it is about.
    pub about: Topic,
    /// Its name in a word or two.
    #[serde(default)]
    pub label: String,
    /// Which way the walk errs for it.
    pub direction: Direction,
    /// What it can do to the verdict.
    pub weight: Weight,
    /// Whether it speaks against the verdict beside which it stands.
    pub against: bool,
    /// Its numbers by name, with the unit in the name.
    #[serde(default, skip_serializing_if = "Map::is_empty")]
    pub numbers: Map<String, Value>,
    /// What it says.
    pub sentence: String,
    /// Which setting changes it; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub to_do: String,
}

impl FindingRecord {
    /// The sentence, and which setting changes it.
    pub fn with_to_do(&self) -> String {
        if self.to_do.is_empty() {
            self.sentence.clone()
        } else {
            format!("{} {}", self.sentence, self.to_do)
        }
    }

    /// A sentence of an earlier version, of which nothing else is known.
    pub fn of_earlier(sentence: &str) -> Self {
        Self {
            id: String::new(),
            about: Topic::Walk,
            label: String::new(),
            direction: Direction::Open,
            weight: Weight::Note,
            against: false,
            numbers: Map::new(),
            sentence: sentence.to_owned(),
            to_do: String::new(),
        }
    }
}

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Topic {
    /// The soil to be retained.
    Base,
    /// The filter's grains.
    Filter,
    /// Its constrictions.
    Constrictions,
    /// The network of voids.
    Network,
    /// The number of base particles.
    Amount,
    /// The walk and its replicates.
    Walk,
    /// The flow of water.
    Flow,
    /// Rules of filter practice.
    Practice,
    /// The thickness of the filter.
    Thickness,
    /// Studies beside the verdict, and the search of a design.
    Study,
    /// Files that were read.
    Files,
}

/// Which way a walk errs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// On the safe side: the real filter erodes at most as much.
    Safe,
    /// On the unsafe side: the real filter erodes at least as much.
    Unsafe,
    /// Nobody knows.
    Open,
    /// Both ends of what is not known were looked at, and agree.
    Settled,
}

/// What a finding can do to a verdict, the most first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Weight {
    /// Leaves the class open.
    Decides,
    /// Costs the checked range.
    Limits,
    /// Nothing.
    Note,
}
