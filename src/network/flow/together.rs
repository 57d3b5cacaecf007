//! What hangs together.

/// Members in groups, each known by its smallest member. Ways are halved as they are gone, which keeps them
/// short without a count of members (a logarithm on average).
#[derive(Clone)]
pub(super) struct Together {
    /// A member of the same group that is no larger: the smallest points at itself.
    towards: Vec<u32>,
}

/// Some of them that follow one another, and are joined with no others yet.
pub(super) struct Part<'a> {
    first: u32,
    towards: &'a mut [u32],
}

impl Together {
    /// So many, each by itself.
    pub(super) fn of(members: usize) -> Self {
        Self { towards: (0..members as u32).collect() }
    }

    /// The smallest member that hangs together with this one.
    pub(super) fn root(&mut self, member: u32) -> u32 {
        self.all().root(member)
    }

    /// The same, where others look for theirs at the same time.
    pub(super) fn found(&self, mut member: u32) -> u32 {
        while self.towards[member as usize] != member {
            member = self.towards[member as usize];
        }
        member
    }

    /// Joins the groups of two members.
    pub(super) fn join(&mut self, one: u32, other: u32) {
        self.all().join(one, other);
    }

    fn all(&mut self) -> Part<'_> {
        Part { first: 0, towards: &mut self.towards }
    }

    /// Those between each of these, which rise, and the next: parts that are joined each by itself.
    pub(super) fn between(&mut self, begin: &[usize]) -> Vec<Part<'_>> {
        let (mut left, mut parts) = (&mut self.towards[begin.first().copied().unwrap_or(0)..], Vec::new());
        for part in begin.windows(2) {
            let (towards, after) = std::mem::take(&mut left).split_at_mut(part[1] - part[0]);
            parts.push(Part { first: part[0] as u32, towards });
            left = after;
        }
        parts
    }
}

impl Part<'_> {
    /// Takes them apart again.
    pub(super) fn take_apart(&mut self) {
        (self.first..).zip(&mut *self.towards).for_each(|(member, towards)| *towards = member);
    }

    fn root(&mut self, mut member: u32) -> u32 {
        loop {
            let next = self.towards[(member - self.first) as usize];
            if next == member {
                return member;
            }
            // Half as far the next time.
            let after = self.towards[(next - self.first) as usize];
            self.towards[(member - self.first) as usize] = after;
            member = after;
        }
    }

    /// Joins the groups of two members.
    pub(super) fn join(&mut self, one: u32, other: u32) {
        let next = |member: u32| self.towards[(member - self.first) as usize];
        if next(one) == next(other) {
            return;
        }
        let (one, other) = (self.root(one), self.root(other));
        self.towards[(one.max(other) - self.first) as usize] = one.min(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_joined_has_one_root() {
        let mut together = Together::of(9);
        for (one, other) in [(8, 3), (3, 5), (5, 8), (2, 7), (7, 4), (6, 4)] {
            together.join(one, other);
        }
        let roots: Vec<u32> = (0..9).map(|void| together.root(void)).collect();
        assert_eq!(roots, [0, 1, 2, 3, 2, 3, 2, 2, 3]);
    }

    /// Parts by themselves, and then with one another.
    #[test]
    fn parts_are_joined_side_by_side() {
        let mut together = Together::of(9);
        let mut parts = together.between(&[2, 5, 9]);
        parts[1].join(8, 6);
        parts[0].join(4, 2);
        parts[1].join(6, 5);
        together.join(1, 4);
        let roots: Vec<u32> = (0..9).map(|member| together.found(member)).collect();
        assert_eq!(roots, [0, 1, 1, 3, 1, 5, 5, 7, 5]);
    }
}
