//! Studies: several cases side by side, how coarse a filter may be; and of the model itself, error against
//! run time and the percolation threshold of lattices.

pub mod compare;
pub mod design;
mod kept;
pub mod percolation;
pub(crate) mod precision;
