//! The noun of this stage: grains in a cell.

/// Where the grains live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// Periodic box from the origin to these lengths along x, y, z (mm).
    Periodic([f64; 3]),
    /// No cell: free boundaries, of which the outer 5 % is ignored in every statistic.
    Free,
}

/// Filter grains as columns; grain `i` is entry `i` of each.
#[derive(Clone, Debug, PartialEq)]
pub struct Packing {
    /// Where the grains live.
    pub cell: Cell,
    /// Centre along x (mm).
    pub x: Vec<f64>,
    /// Centre along y (mm).
    pub y: Vec<f64>,
    /// Centre along z (mm).
    pub z: Vec<f64>,
    /// Diameter (mm).
    pub diameter: Vec<f64>,
}
