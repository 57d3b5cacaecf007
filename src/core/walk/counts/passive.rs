//! The moving passive particles of a state.

use super::expected::Expected;

/// Moving passive particles, where they are not walked one by one.
#[derive(Clone, Debug, PartialEq)]
pub enum Passive {
    /// Among the particles, like any other.
    OneByOne,
    /// Number that moves, by void.
    Counts(Vec<u64>),
    /// Number that is expected to move, by void.
    Expected(Box<Expected>),
}

impl Passive {
    /// No particle yet, on a network of `voids` voids.
    pub(in crate::walk) fn none_yet(voids: usize, expected: bool) -> Self {
        match expected {
            true => Passive::Expected(Box::new(Expected::new(voids))),
            false => Passive::Counts(vec![0; voids]),
        }
    }

    /// The counts, where there are any.
    pub(in crate::walk) fn counts(&self) -> &[u64] {
        match self {
            Passive::Counts(moving) => moving,
            _ => &[],
        }
    }

    /// The expectation, where there is one.
    pub fn expected(&self) -> Option<&Expected> {
        match self {
            Passive::Expected(expected) => Some(expected),
            _ => None,
        }
    }
}
