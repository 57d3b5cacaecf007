//! Studies: specifications of filters for one base or for many samples, the model's boundaries of erosion,
//! and the percolation threshold of lattices.

pub mod boundary;
pub mod percolation;
pub mod specified;
