//! A finding, as it is written.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// A finding: what it is about, and its sentence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FindingRecord {
    /// Its name for programs, as `cohesive_fines`.
    pub id: String,
    /// What it is about.
    pub about: Topic,
    /// Its name in a word or two.
    pub label: String,
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
