//! Data that a step on the lattice reads of each void: chosen once for a chunk, so that the loops hold no
//! choice.

/// Ways in which a kernel of the lattice finds out which particles a constriction stops.
pub(super) trait Reads {
    /// By classes of the finest open exit of each void; else, and without widths, by the finest open exit of
    /// the network.
    const CLASSED: bool = false;
    /// By the width of the very exit that a particle has chosen.
    const WIDTHS: bool = false;
    /// Particles that fit may jam.
    const JAMS: bool = false;
}

/// Nearly all particles are as fine as the finest open exit of the network.
pub(super) struct Plain;

/// Coarser ones.
pub(super) struct Classed;

/// Blocked constrictions leave openings, whose widths change.
pub(super) struct Widths;

/// Particles arch; blocked constrictions may leave openings, too.
pub(super) struct Jamming;

impl Reads for Plain {}

impl Reads for Classed {
    const CLASSED: bool = true;
}

impl Reads for Widths {
    const WIDTHS: bool = true;
}

impl Reads for Jamming {
    const WIDTHS: bool = true;
    const JAMS: bool = true;
}
