//! Studies: many samples against filters, the specification of a filter; and of the model itself, its
//! boundaries of erosion and the percolation threshold of lattices.

pub mod batch;
pub mod boundary;
mod days;
pub mod designs;
mod file_names;
mod inputs;
mod kept;
mod of_cases;
pub mod percolation;
pub mod specified;

pub(crate) use file_names::{numbered, refuse_twice};
