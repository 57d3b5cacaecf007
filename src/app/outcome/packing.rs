//! Contents of a packing folder, as types: `packing.json` and the rows of `constrictions.csv`.

use serde::{Deserialize, Serialize};

pub(crate) use voidwalk_core::constrictions::Summary;
pub(crate) use voidwalk_core::packing::Measure;

/// Row of `constrictions.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct CurveRow {
    /// Percent of the constrictions that are smaller, by number.
    pub(crate) percent_smaller: f64,
    /// Diameter (mm).
    pub(crate) diameter_mm: f64,
}

/// Percent of the mass in the finer part from which coarse grains float in it; below it they form a
/// skeleton: Skempton and Brogan (1994), Geotechnique 44(3), 449-460.
pub(crate) const FLOATING_PERCENT: f64 = 35.0;

/// Finer part of a filter that was packed instead of the whole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct PackedPart {
    /// Percent of the filter's mass in this part.
    pub(crate) percent: f64,
    /// Largest grain of this part (mm).
    pub(crate) largest_mm: f64,
    /// Fraction of the surface of all grains that belongs to the omitted grains.
    pub(crate) surface_left_out: f64,
    /// Largest relative difference by which its constrictions are finer than those of the whole filter.
    pub(crate) finer_by: f64,
    /// True if the filter has almost no grains between 1 and 1.5 times the largest grain packed.
    pub(crate) sizes_missing_above: bool,
}

/// Origin of a packing made for another scene's filter of the same shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct SameShape {
    /// Folder of the packing.
    pub(crate) folder: String,
    /// Factor on its sizes.
    pub(crate) factor: f64,
}

/// Contents of `packing.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct PackingRecord {
    /// Fingerprint of all inputs of the grains: gradation, settings and protocol.
    pub(crate) fingerprint: String,
    /// XXH3 of `grains.csv`.
    pub(crate) grains_xxh3: String,
    /// Description of the gradation.
    pub(crate) name: String,
    /// True if the gradation is linear on semi-log paper.
    pub(crate) linear: bool,
    /// D60 / D10 by mass, if known.
    pub(crate) cu: Option<f64>,
    /// Part of the filter that was packed, if it is not the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) part: Option<PackedPart>,
    /// Origin of the packing, if it was made for another filter of the same shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) same_shape: Option<SameShape>,
    /// Rows of size (mm) and percent finer by mass of the packed part, ascending.
    pub(crate) gradation: Vec<[f64; 2]>,
    /// Number of grains.
    pub(crate) grains: u64,
    /// Seed of sizes and start positions.
    pub(crate) seed: u64,
    /// Friction between grains during compression, which sets the density.
    pub(crate) friction: f64,
    /// Friction in the final state.
    pub(crate) final_friction: f64,
    /// Mean pressure held (kPa).
    pub(crate) pressure_kpa: f64,
    /// All other settings of the compression, by name.
    pub(crate) settings: serde_json::Map<String, serde_json::Value>,
    /// State at rest with the friction of the compression.
    pub(crate) before: Measure,
    /// State at rest with the final friction, which is the state of the grains.
    pub(crate) after: Measure,
    /// Number of steps of the compression.
    pub(crate) steps: u64,
    /// Simulated time (s).
    pub(crate) simulated_s: f64,
    /// Wall time, s, summed over all restarts of the program.
    pub(crate) seconds: f64,
    /// Edge of the periodic cell (mm), or its width if it is taller.
    pub(crate) cell_mm: f64,
    /// Height (mm) of a cell that is taller than wide.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) height_mm: Option<f64>,
    /// Rows of diameter (mm) and percent smaller by number of the curves estimated by inscribed circles:
    /// dense, loose.
    pub(crate) inscribed: [Vec<[f64; 2]>; 2],
    /// Grains cut by the plane through the middle of the cell: x, y of the centre, diameter of the cut,
    /// diameter of the grain (mm).
    pub(crate) slice: Vec<[f64; 4]>,
}

impl PackingRecord {
    /// Record of the same packing with every length multiplied by `factor`.
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
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
