//! Errors of a packing that is to be triangulated.

use thiserror::Error;

/// Reasons why a packing has no triangulation.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TriangulationError {
    /// Fewer than four grains.
    #[error("{grains} grains: a triangulation needs at least 4")]
    TooFew {
        /// Grains in the packing.
        grains: usize,
    },
    /// More grains than a corner can name.
    #[error("{grains} grains: at most 67108863 can be triangulated")]
    TooMany {
        /// Grains in the packing.
        grains: usize,
    },
    /// Columns of different lengths.
    #[error("column {column} has {rows} rows, but there are {grains} diameters")]
    Columns {
        /// Name of the column.
        column: &'static str,
        /// Its rows.
        rows: usize,
        /// Rows of the diameter column.
        grains: usize,
    },
    /// A coordinate that is not a number.
    #[error("grain {grain}: {column} = {value} mm, but a centre must be finite")]
    Centre {
        /// Index of the grain, from 0.
        grain: usize,
        /// Name of the column.
        column: &'static str,
        /// Value of the column.
        value: f64,
    },
    /// A diameter that is not a size.
    #[error("grain {grain}: diameter = {value} mm, but it must be finite and above 0")]
    Diameter {
        /// Index of the grain, from 0.
        grain: usize,
        /// Value of the diameter.
        value: f64,
    },
    /// Lengths so large or so small that their products leave the range of f64.
    #[error("the largest length is {extent_mm} mm, but it must lie between 1e-250 and 1e250")]
    Extent {
        /// The largest length.
        extent_mm: f64,
    },
    /// A cell in which a grain meets its own image.
    #[error(
        "the cell is {length_mm} mm along {axis}, but it must be at least twice the largest grain \
         ({largest_mm} mm)"
    )]
    Narrow {
        /// Axis of the cell.
        axis: &'static str,
        /// Its length.
        length_mm: f64,
        /// The largest diameter.
        largest_mm: f64,
    },
    /// Free grains whose centres lie in one plane.
    #[error("the centres of all {grains} grains lie in one plane: there is nothing to triangulate")]
    Coplanar {
        /// Grains in the packing.
        grains: usize,
    },
    /// A periodic packing so empty that its tetrahedra reach across several cells.
    #[error(
        "{grains} grains are too few to fill this periodic cell: tetrahedra reach across several images of it"
    )]
    Sparse {
        /// Grains in the packing.
        grains: usize,
    },
}
