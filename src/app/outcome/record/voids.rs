//! Rows of the CSV files of a run folder that describe each void of the first replicate.

use crate::outcome::number_rows::rows;

rows! {
    /// One row of `voids.csv`: a void of the filter, and where it lies.
    pub struct VoidRow {
        /// Counts from 0.
        pub void: u64,
        /// Counts from 0 at the start nodes, or at the first voids behind the reservoir.
        pub layer: u64,
        /// Across the flow.
        pub x_mm: f64,
        /// Across the flow.
        pub y_mm: f64,
        /// Along the flow.
        pub z_mm: f64,
    }

    /// One row of `constrictions_of_network.csv`: a constriction between two voids; -1 is the outside, before
    /// the filter as the first of the two and behind it as the second.
    pub struct ConstrictionRow {
        /// Its number in `blocked.csv`.
        pub constriction: u64,
        /// One of the voids that it joins.
        pub from: i64,
        /// The other; where constrictions have a direction, the one that it leads to.
        pub to: i64,
        /// Way from the one to the other, to the nearest of its periodic images; half a layer along the flow
        /// where either is the outside.
        pub dx_mm: f64,
        /// Along y.
        pub dy_mm: f64,
        /// Along z.
        pub dz_mm: f64,
        /// Diameter.
        pub diameter_mm: f64,
        /// Conductance times viscosity: in mm3 between the voids of a packing, in a unit of its own on a
        /// lattice; 0 where no water is reckoned with.
        pub conductance: f64,
    }

    /// One row of `blocked.csv`: a constriction that a base particle blocked.
    pub struct BlockedRow {
        /// 1 or 2.
        pub run: u64,
        /// The increment in which a particle stopped there.
        pub increment: u64,
        /// The constriction, from 0.
        pub constriction: u64,
    }

    /// One row of `retained_by_void.csv`: what a void with retained particles of a run held after an
    /// increment; void 0 has a row after each increment that was kept, whatever it holds.
    pub struct RetainedRow {
        /// 1 or 2.
        pub run: u64,
        /// Increments that were done.
        pub increment: u64,
        /// The void, from 0; -1 is the reservoir before the filter.
        pub void: i64,
        /// Particles stopped by its constrictions so far in this run.
        pub retained_in_constrictions: u64,
        /// Particles retained in it so far in this run for want of an open exit.
        pub retained_in_voids: u64,
    }
}
