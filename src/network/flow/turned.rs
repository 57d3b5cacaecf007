//! Where water has turned.

use std::ops::Range;

/// Voids of which the flow has changed but for a factor that all fluxes have, in groups that follow one
/// another.
#[derive(Clone, Debug, PartialEq)]
pub struct Turned {
    /// By group.
    has_turned: Vec<bool>,
    voids: usize,
}

impl Turned {
    /// Voids of a group: a thread looks at them one after another.
    pub const GROUP: usize = 1 << 13;

    /// None of so many voids.
    pub(super) fn none(voids: usize) -> Self {
        Self { has_turned: vec![false; voids.div_ceil(Self::GROUP)], voids }
    }

    /// All of so many voids.
    pub(super) fn all(voids: usize) -> Self {
        Self { has_turned: vec![true; voids.div_ceil(Self::GROUP)], voids }
    }

    /// Adds the group of a void.
    pub(super) fn add(&mut self, void: u32) {
        self.has_turned[void as usize / Self::GROUP] = true;
    }

    /// Whether the group of a void is among them.
    pub fn contains(&self, void: u32) -> bool {
        self.has_turned[void as usize / Self::GROUP]
    }

    /// The voids, group by group.
    pub fn groups(&self) -> impl Iterator<Item = Range<u32>> {
        let groups = (0..self.voids).step_by(Self::GROUP);
        let of = |first: usize| first as u32..(first + Self::GROUP).min(self.voids) as u32;
        groups.zip(&self.has_turned).filter(|&(_, &turned)| turned).map(move |(first, _)| of(first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_whole_but_for_the_last() {
        let group = Turned::GROUP as u32;
        let mut turned = Turned::none(2 * Turned::GROUP + 5);
        assert_eq!(turned.groups().count(), 0);
        [7, 2 * group + 1].into_iter().for_each(|void| turned.add(void));
        assert!(turned.groups().eq([0..group, 2 * group..2 * group + 5]));
        assert!(turned.contains(0) && !turned.contains(group) && turned.contains(2 * group));
        assert!(Turned::all(5).groups().eq(std::iter::once(0..5)));
    }
}
