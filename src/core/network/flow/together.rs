//! Connected groups.

/// Members in groups, each known by its smallest member. Ways are halved as they are followed, which keeps
/// them short without a count of members (a logarithm on average).
pub(super) struct Together {
    /// A member of the same group that is no larger: the smallest points at itself.
    towards: Vec<u32>,
}

impl Together {
    /// Groups of one: this many members, each by itself.
    pub(super) fn new(members: usize) -> Self {
        Self { towards: (0..members as u32).collect() }
    }

    /// Smallest member of the group of this one.
    pub(super) fn root(&mut self, mut member: u32) -> u32 {
        loop {
            let next = self.towards[member as usize];
            if next == member {
                return member;
            }
            // Halves the way for the next time.
            let after = self.towards[next as usize];
            self.towards[member as usize] = after;
            member = after;
        }
    }

    /// Joins the groups of two members.
    pub(super) fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        self.towards[one.max(other) as usize] = one.min(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_joined_has_one_root() {
        let mut together = Together::new(9);
        for (one, other) in [(8, 3), (3, 5), (5, 8), (2, 7), (7, 4), (6, 4)] {
            together.join(one, other);
        }
        let roots: Vec<u32> = (0..9).map(|void| together.root(void)).collect();
        assert_eq!(roots, [0, 1, 2, 3, 2, 3, 2, 2, 3]);
    }
}
