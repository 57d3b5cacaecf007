//! Packings of filter grains, and their compression.
//!
//! # Protocol
//! All gradations and frictions share one protocol ([`compress`]):
//!
//! 1. sizes stratified by number ([`draw`]), random places without overlap ([`random_start`]);
//! 2. squeeze: the cell shrinks at a constant rate to a part of the expected packing fraction;
//! 3. compress: the strain rate is proportional to the lack of pressure, up to a limit, with the friction
//!    that sets the density; once the pressure has come within 2 % the drag on the grains is raised to
//!    `settling_drag`;
//! 4. settle: repeat step 3 with the final friction, if that differs.
//!
//! # End of a stage
//! The state is checked every 100 steps: the pressure within 0.5 %, the root mean square unbalanced force
//! below 5 % of the mean contact force, and the coordination number within 0.05 and the void ratio within
//! 5e-4 of their values `hold_steps` ago; and kinetic below 1 % of elastic energy at the end.
//!
//! The paper's criterion is the coordination number alone, held for 20,000 of its shorter steps. It also
//! holds while a packing still creeps, so the void ratio has to hold too. No packing stops creeping
//! altogether: without friction it goes on by ever rarer avalanches, and a wide grading with high friction by
//! sliding, both about as the logarithm of time (void ratio 0.003 lower for Cu 1.5, and 0.002 for Cu 3, both
//! without friction, when the unbalanced force has to fall to 2 %, which takes two to three times the steps).
//! So some rate has to count as rest; this one is a quarter, per hold, of the 0.002 to which the void ratio
//! is wanted. Grains that touch nothing make the kinetic energy fall slowly and the void ratio not at all, so
//! that limit is wide; [`PackReport`] gives the values reached.
//!
//! If crowded grains are moved as heavier ones (the largest grain 20 times as wide as the smallest or more),
//! steps are longer, and a hold is as many steps as the grains' own masses would take for the same time.

#[cfg(test)]
mod checks;
mod compression;
mod contact;
mod csv;
mod draw;
mod dump;
mod export;
mod fields;
mod found;
mod grains;
mod import;
#[cfg(test)]
mod import_tests;
mod limits;
mod measure;
mod motion;
mod neighbours;
mod observed;
mod place;
mod protocol;
mod renewal;
mod rows;
mod settings;
mod state;
mod unit;
mod vtk;

pub use compression::{Compression, Stage};
pub use draw::{draw, random_start, tall_start};
pub use export::vtp_points;
pub use fields::{ImportError, PACKING_FILE_LIMIT_BYTES};
pub use grains::{Cell, Packing};
pub use import::{CellOption, ReadOptions};
pub use limits::is_wide;
pub use neighbours::Reach;
pub use observed::Measure;
pub use protocol::{CompressionProgress, PackReport, compress};
pub use settings::{Contact, PackingError, Settings};
pub use unit::LengthUnit;
