//! Studies of the model itself: error against run time, and the percolation threshold of lattices.

pub mod percolation;
pub mod precision;
