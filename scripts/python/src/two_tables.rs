//! Options of two tables of sieves.

use pyo3::prelude::*;
use voidwalk::scene::TableOptions;

use crate::soil::density_named;

/// Options of a scene of two tables: density, then true if it is packed, is quick, is as sampled, is as
/// given, and settings as `name=value`.
#[derive(FromPyObject)]
pub struct Tables(Option<String>, bool, bool, bool, bool, Vec<String>);

impl Tables {
    pub fn options(self) -> PyResult<TableOptions> {
        let Self(density, pack, quick, as_sampled, as_given, changes) = self;
        let density = density.map(|word| density_named(&word)).transpose()?;
        Ok(TableOptions { density, pack, quick, as_sampled, as_given, changes })
    }
}
