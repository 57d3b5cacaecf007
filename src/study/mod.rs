//! Studies: many samples against filters, how coarse a filter may be; and of the model itself, the
//! percolation threshold of lattices.

pub mod batch;
mod days;
pub mod design;
pub mod designs;
mod file_names;
mod inputs;
mod kept;
mod of_cases;
pub mod percolation;

pub(crate) use file_names::{numbered, refuse_twice};
