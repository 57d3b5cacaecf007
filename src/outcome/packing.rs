//! What a packing's folder holds, as types: `packing.json` and the rows of `constrictions.csv`.

use serde::{Deserialize, Serialize};

pub use crate::constrictions::Summary;
pub use crate::packing::Measure;

/// A row of `constrictions.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveRow {
    /// Percent of the constrictions that are smaller, by number.
    pub percent_smaller: f64,
    /// Diameter (mm).
    pub diameter_mm: f64,
}

/// The whole of `packing.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackingRecord {
    /// Fingerprint of everything that the grains follow from: gradation, settings and protocol.
    pub fingerprint: String,
    /// XXH3 of `grains.csv`.
    pub grains_xxh3: String,
    /// The gradation in words.
    pub name: String,
    /// Whether the gradation is linear on semi-log paper.
    pub linear: bool,
    /// D60 / D10 by mass, where known.
    pub cu: Option<f64>,
    /// Rows of size (mm) and percent finer by mass, ascending.
    pub gradation: Vec<[f64; 2]>,
    /// Grains.
    pub grains: u64,
    /// Seed of sizes and start positions.
    pub seed: u64,
    /// Friction between grains during compression, which sets the density.
    pub friction: f64,
    /// Friction in the final state.
    pub final_friction: f64,
    /// Mean pressure that was held (kPa).
    pub pressure_kpa: f64,
    /// Every other setting of the compression, by name.
    pub settings: serde_json::Map<String, serde_json::Value>,
    /// At rest with the friction of the compression.
    pub before: Measure,
    /// At rest with the final friction: the state of the grains.
    pub after: Measure,
    /// Steps of the compression.
    pub steps: u64,
    /// Simulated time (s).
    pub simulated_s: f64,
    /// Wall time, s, over all starts of the program.
    pub seconds: f64,
    /// Edge of the periodic cell (mm).
    pub cell_mm: f64,
    /// Rows of diameter (mm) and percent smaller by number of the curves estimated by inscribed circles:
    /// dense, loose.
    pub inscribed: [Vec<[f64; 2]>; 2],
    /// Grains cut by the plane through the middle of the cell: x, y of the centre, diameter of the cut,
    /// diameter of the grain (mm).
    pub slice: Vec<[f64; 4]>,
}
