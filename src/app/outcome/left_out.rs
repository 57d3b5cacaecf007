//! Parts of the program that a scene does not need.

use serde::{Deserialize, Serialize};

use voidwalk_core::walk::Shortcut;

/// A part of the program that a scene does not need, or a study of which nothing is walked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema), schemars(with = "schema::LeftOut"))]
#[serde(tag = "id", content = "numbers", rename_all = "snake_case")]
pub enum LeftOut {
    /// A lattice, where the voids of a packing are the network.
    Lattice,
    /// All before the network, where that is given.
    BeforeNetwork,
    /// A given curve, where a packing is measured.
    GivenCurve,
    /// Packing, where the curve comes from the library.
    PackingByLibrary,
    /// Packing, where the curve is guessed.
    PackingByGuess,
    /// Packing, where the curve is given.
    PackingByCurve,
    /// Packing, where the packing of this folder has the filter's shape and is taken so many times as large.
    PackingOfShape(String, f64),
    /// The second run.
    SecondRun,
    /// Multiples of that number above the cap, and the cap.
    AmountsAboveCap(Vec<f64>, f64),
    /// Multiples of that number that give a number which is walked already.
    AmountsTheSame(Vec<f64>),
    /// Another thickness of a network from a file.
    ThicknessOfFile,
    /// A multiple of the thickness, and why it cannot be walked.
    ThicknessRefused(f64, String),
    /// A multiple of the thickness that has as many layers, or as many copies of a packing.
    ThicknessTheSame(f64, u64, LayerKind),
    /// A part that the first run of the first replicate did not need.
    Walk(Shortcut),
}

/// Unit of which a network consists along the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LayerKind {
    /// Layers of a lattice.
    Layer,
    /// Copies of a packing.
    Copy,
}

#[cfg(feature = "cli")]
mod schema {
    /// A part of the program that a scene does not need.
    #[derive(schemars::JsonSchema)]
    #[allow(dead_code)]
    pub(super) struct LeftOut {
        /// Its name.
        id: String,
        /// Its numbers; missing without any.
        #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
        numbers: serde_json::Value,
    }
}
