//! What goes with two tables of sieves.

use pyo3::prelude::*;
use voidwalk::scene::TableOptions;

use crate::soil::density_named;

/// What a scene of two tables is given besides them: density, whether it is packed, is quick, is as sampled, is as
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
