//! Studies: the specification of a filter, for one base and for many samples; and of the model itself, its
//! boundaries of erosion and the percolation threshold of lattices.

pub mod boundary;
pub mod percolation;
pub mod specified;
