//! The rows of the CSV files of a run folder.

use crate::outcome::table::rows;

rows! {
    /// One row of `flow.csv`: the permeability when the flow was solved.
    pub struct FlowRow {
        /// Counts from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Increments that were done.
        pub increment: u64,
        /// Permeability over that of the clean filter.
        pub k_over_k0: f64,
    }

    /// One row of `series.csv`: the counts after an increment.
    pub struct SeriesRow {
        /// Counts from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Counts from 1.
        pub increment: u64,
        /// Particles inserted so far in this run.
        pub inserted: u64,
        /// Particles still moving.
        pub moving: u64,
        /// Particles eroded so far in this run.
        pub eroded: u64,
        /// Particles stopped by a constriction so far in this run.
        pub retained_in_constrictions: u64,
        /// Particles retained in voids so far in this run.
        pub retained_in_voids: u64,
        /// Particles trapped in closed loops.
        pub trapped: u64,
        /// Constrictions blocked.
        pub blocked: u64,
        /// Mass eroded so far over the mass that the whole run inserts.
        pub eroded_mass_fraction: f64,
    }

    /// One row of `layers.csv`: a layer when a run has ended.
    pub struct LayerRow {
        /// Counts from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Counts from 0 at the start nodes.
        pub layer: u64,
        /// Constrictions that leave the voids of this layer.
        pub constrictions: u64,
        /// Those of them that are blocked.
        pub blocked: u64,
        /// Particles of this run stopped by them.
        pub retained_in_constrictions: u64,
        /// Particles of this run retained in the voids of this layer.
        pub retained_in_voids: u64,
    }

    /// One row of `retained.csv` or `eroded.csv`: a point of the size curve of what is retained, or eroded,
    /// so far.
    pub struct SizeRow {
        /// Counts from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// The increment after which the curve was taken.
        pub increment: u64,
        /// Size.
        pub diameter_mm: f64,
        /// Percent of the mass in particles no larger.
        pub percent_finer_by_mass: f64,
        /// Percent of the number in particles no larger.
        pub percent_finer_by_number: f64,
    }
}
