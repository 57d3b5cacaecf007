//! Contents of a packing's folder, as types: `packing.json` and the rows of `constrictions.csv`.

use serde::{Deserialize, Serialize};

pub use voidwalk_core::constrictions::Summary;
pub use voidwalk_core::packing::Measure;

/// A row of `constrictions.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct CurveRow {
    /// Percent of the constrictions that are smaller, by number.
    pub percent_smaller: f64,
    /// Diameter (mm).
    pub diameter_mm: f64,
}

/// Coarse grains float in a finer part of at least this percent of the mass, and carry each other below it:
/// Skempton and Brogan (1994), Geotechnique 44(3), 449-460.
pub const FLOATING_PERCENT: f64 = 35.0;

/// The finer part of a filter that was packed, where the whole was not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct PackedPart {
    /// Percent of the filter's mass that is in it.
    pub percent: f64,
    /// Its largest grain (mm).
    pub largest_mm: f64,
    /// Share of the surface of all grains that the grains left out have.
    pub surface_left_out: f64,
    /// Its constrictions are finer than those of the whole by up to this share of their size.
    pub finer_by: f64,
    /// Whether the filter has next to no grains up to half as large again as the largest.
    pub sizes_missing_above: bool,
}

/// Where a packing was taken from that another scene's filter of the same shape had been packed into.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct SameShape {
    /// Its folder.
    pub folder: String,
    /// What its sizes were multiplied with.
    pub factor: f64,
}

/// The whole of `packing.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
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
    /// What part of the filter was packed, where it is not the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<PackedPart>,
    /// Where the packing was taken from, where it was made for another filter of the same shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub same_shape: Option<SameShape>,
    /// Rows of size (mm) and percent finer by mass of what was packed, ascending.
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
    /// Edge of the periodic cell (mm), or its width where it is taller.
    pub cell_mm: f64,
    /// Height (mm) of a cell that is taller than wide.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_mm: Option<f64>,
    /// Rows of diameter (mm) and percent smaller by number of the curves estimated by inscribed circles:
    /// dense, loose.
    pub inscribed: [Vec<[f64; 2]>; 2],
    /// Grains cut by the plane through the middle of the cell: x, y of the centre, diameter of the cut,
    /// diameter of the grain (mm).
    pub slice: Vec<[f64; 4]>,
}

impl PackingRecord {
    /// The record of the same packing with every length multiplied by `factor`.
    pub fn scaled(mut self, factor: f64) -> Self {
        let sizes = self.gradation.iter_mut().map(|row| &mut row[0]);
        let inscribed = self.inscribed.iter_mut().flatten().map(|row| &mut row[0]);
        let slice = self.slice.iter_mut().flatten();
        sizes
            .chain(inscribed)
            .chain(slice)
            .chain([&mut self.cell_mm])
            .chain(&mut self.height_mm)
            .for_each(|mm| *mm *= factor);
        self
    }
}
