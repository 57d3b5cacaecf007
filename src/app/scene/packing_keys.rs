//! The section `packing`, for a filter that is packed.

use serde::Serialize;

use super::keys::FilterPacking;
use voidwalk_core::packing;
use voidwalk_core::schema::{GivenSettings, SceneError};

/// The section `packing`: settings of the measured packing, and of the compression of its grains.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PackingKeys {
    /// Grains and voids.
    #[serde(flatten)]
    pub filter: FilterPacking,
    /// The compression; friction and number of grains are not set here.
    #[serde(flatten)]
    pub compression: packing::Settings,
}

/// The section `packing`, if density or friction asks for a packing.
pub(super) fn packing_keys(s: &GivenSettings) -> Result<Option<PackingKeys>, SceneError> {
    let stated = s.has("filter.density") || s.has("filter.friction");
    match s.first_in("packing.") {
        Some(name) if !stated => Err(s.clash(format!(
            "{name} goes with filter.density or filter.friction: nothing is packed without one of them"
        ))),
        _ if !stated => Ok(None),
        _ => Ok(Some(PackingKeys {
            filter: FilterPacking::read(s)?,
            compression: packing::Settings::read(s)?,
        })),
    }
}
