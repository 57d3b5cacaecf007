//! What a thick network keeps from one solution to the next, so that little but what has changed is looked
//! at.

use super::passages::{Meets, Passage, Passages};
use super::stretch::Stretches;
use super::system::System;
use super::together::Together;

/// A thick network that has been solved.
pub(super) struct Thick {
    /// Its equations, with a row for each void that water flowed through at first.
    pub system: System,
    stretches: Stretches,
    /// What hangs together within slabs.
    within: Together,
    /// What voids hang together with.
    meets: Vec<Meets>,
    /// By slab: constrictions that have changed since, and voids that hang together with other sides.
    changed: Vec<usize>,
}

impl Thick {
    /// Of its equations, what its voids hang together with, and by way of which constrictions they do.
    pub fn of(
        system: System,
        passages: &Passages,
        meets: &[Meets],
        is_way: impl Fn(&Passage) -> bool + Sync,
    ) -> Self {
        let mut within = Together::of(meets.len());
        passages.join_within(&mut within, |_| true, is_way);
        let stretches = Stretches::of(&system.equations());
        let changed = vec![0; passages.slabs().number()];
        Self { system, stretches, within, meets: meets.to_vec(), changed }
    }

    /// These exits have changed.
    pub fn change(&mut self, passages: &Passages, is_changed: impl Fn(usize) -> bool + Sync) {
        let more = passages.changed(is_changed);
        self.changed.iter_mut().zip(more).for_each(|(changed, more)| *changed += more);
    }

    /// What each void hangs together with now, by way of such constrictions.
    pub fn meet(&mut self, passages: &Passages, is_way: impl Fn(&Passage) -> bool + Sync) -> Vec<Meets> {
        let changed = &mut self.changed;
        passages.join_within(&mut self.within, |slab| changed[slab] > 0, &is_way);
        let meets = passages.meet(self.meets.len(), self.within.clone(), is_way);
        for (void, _) in (0u32..).zip(self.meets.iter().zip(&meets)).filter(|(_, (then, now))| then != now) {
            passages.slabs().beside(void).for_each(|slab| changed[slab] += 1);
        }
        self.meets.clone_from(&meets);
        meets
    }

    /// Takes what has changed, by slab, as a solution begins.
    pub fn take_changed(&mut self) -> Vec<usize> {
        let none = vec![0; self.changed.len()];
        std::mem::replace(&mut self.changed, none)
    }

    /// Brings pressures close to the solution, where stretches around the slabs that have changed will do;
    /// which slabs these are.
    pub fn improve(&mut self, pressure: &mut [f64], within: f64, changed: &[usize]) -> Option<Vec<bool>> {
        self.system.improve(pressure, within, &mut self.stretches, changed)
    }
}
