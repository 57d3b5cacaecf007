//! Grains from files of VTK, as LIGGGHTS, Yade, MercuryDPM, MFIX and ParaView write them.
//!
//! Points with an array called `diameter` or `radius` (`radii` in Yade), perhaps with a unit at the end as
//! `diameter_mm`. [`legacy`] reads files before XML (`.vtk`, ASCII and binary), [`xml`] reads `.vtp` and
//! `.vtu`. Neither format tells if boundaries are periodic.

mod legacy;
mod number;
mod points;
#[cfg(test)]
mod tests;
mod xml;

pub(super) use legacy::legacy;
pub(super) use xml::xml;
