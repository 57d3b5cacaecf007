//! A packing: grains in a cell.

/// Cell that holds the grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// Periodic box from the origin to these lengths along x, y, z (mm).
    Periodic([f64; 3]),
    /// No cell: free boundaries; every statistic ignores the outer 5 %.
    Free,
}

/// Filter grains as columns; grain `i` is entry `i` of each.
///
/// ```
/// use voidwalk_core::packing::{Cell, Packing};
/// let packing = Packing {
///     cell: Cell::Periodic([2.0; 3]),
///     x: vec![0.0, 1.0],
///     y: vec![0.0, 1.0],
///     z: vec![0.0, 1.0],
///     diameter: vec![1.0, 0.7],
/// };
/// assert_eq!(Packing::parse("grains.csv", packing.to_csv().as_bytes())?, packing);
/// # Ok::<(), voidwalk_core::packing::ImportError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Packing {
    /// Cell that holds the grains.
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

impl Packing {
    /// Multiplies every length of the packing by `factor`.
    pub fn scaled(mut self, factor: f64) -> Self {
        let columns = [&mut self.x, &mut self.y, &mut self.z, &mut self.diameter];
        columns.into_iter().flatten().for_each(|mm| *mm *= factor);
        if let Cell::Periodic(edges) = &mut self.cell {
            edges.iter_mut().for_each(|mm| *mm *= factor);
        }
        self
    }
}
