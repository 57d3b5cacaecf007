//! Grains from files of VTK, as LIGGGHTS, Yade, MercuryDPM, MFIX and ParaView write them.
//!
//! Points with an array called `diameter` or `radius` (`radii` of Yade), perhaps with a unit at the end as
//! `diameter_mm`. Files before XML (`.vtk`, ASCII and binary) are read by [`legacy`], `.vtp` and `.vtu` by
//! [`xml`]. Neither says whether boundaries are periodic.

mod legacy;
mod number;
mod points;
#[cfg(test)]
mod tests;
mod xml;

pub(super) use legacy::legacy;
pub(super) use xml::xml;
