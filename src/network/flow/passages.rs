//! Constrictions as water sees them, slab by slab, and what hangs together by way of them.

use super::slabs::{Slabs, each};
use super::together::Together;
use super::turned::Turned;
use crate::network::twins::NO_TWIN;
use crate::network::{END, Network};

/// A constriction as water sees it.
pub(super) struct Passage {
    /// The void that it is an exit of.
    pub one: u32,
    /// The void beyond: the reservoir is one, and so is what lies behind the filter.
    pub other: u32,
    /// The exit.
    pub exit: u32,
}

/// The constrictions of a network, each once.
pub(super) struct Passages {
    /// Slab after slab, and then those of cuts alone.
    all: Vec<Passage>,
    /// By slab, and for the cuts: where its passages begin; and where the last end.
    begin: Vec<usize>,
    /// By slab, and for the cuts: how many of its passages join voids of that slab. They come first.
    within: Vec<usize>,
    slabs: Slabs,
    reservoir: Option<u32>,
}

impl Passages {
    /// Of a network, of which each exit leads to the void `other`: END is one more void.
    pub(super) fn of(network: &Network, other: &[u32]) -> Self {
        let (outside, reservoir) = (network.voids() as u32, network.reservoir());
        let mut all = Vec::with_capacity(network.constrictions() / 2);
        let twins = network.undirected.as_ref().map(|undirected| &undirected.twin);
        for one in 0..outside {
            for c in network.exits(one) {
                let (exit, twin) = (c as u32, twins.map_or(NO_TWIN, |twin| twin[c]));
                if twin >= exit {
                    all.push(Passage { one, other: other[c], exit });
                }
            }
        }
        let slabs = slabs(network);
        let is_void = |void: u32| void != outside && Some(void) != reservoir;
        let slab = |p: &Passage| slabs.of_both(p.one, Some(p.other).filter(|&other| is_void(other)));
        let is_within = |p: &Passage| is_void(p.other) && slabs.are_both(p.one, p.other);
        // In their order otherwise.
        all.sort_by_key(|p| (slab(p), !is_within(p)));
        let begin: Vec<usize> =
            (0..=slabs.number() + 1).map(|at| all.partition_point(|p| slab(p) < at)).collect();
        let within = begin.windows(2).map(|of| all[of[0]..of[1]].partition_point(is_within)).collect();
        Self { all, begin, within, slabs, reservoir }
    }

    /// The slabs.
    pub(super) fn slabs(&self) -> &Slabs {
        &self.slabs
    }

    /// Those of a slab, or of the cuts, from the void that is not the reservoir.
    pub(super) fn of_slab(&self, at: usize) -> &[Passage] {
        &self.all[self.begin[at]..self.begin[at + 1]]
    }

    /// How many constrictions have changed, by slab; those between voids of cuts in the slabs on both sides.
    pub(super) fn changed(&self, is_changed: impl Fn(usize) -> bool + Sync) -> Vec<usize> {
        let slabs = self.slabs.number();
        let mut changed = vec![0; slabs];
        let in_cuts = self.of_slab(slabs).iter().filter(|passage| is_changed(passage.exit as usize));
        for passage in in_cuts {
            self.slabs.beside(passage.one).for_each(|slab| changed[slab] += 1);
        }
        each(&mut changed, |at, changed| {
            *changed += self.of_slab(at).iter().filter(|passage| is_changed(passage.exit as usize)).count();
        });
        changed
    }

    /// Joins what hangs together within slabs, by way of such constrictions.
    pub(super) fn join_within(
        &self,
        together: &mut Together,
        is_wanted: impl Fn(usize) -> bool + Sync,
        is_way: impl Fn(&Passage) -> bool + Sync,
    ) {
        let slabs = &self.slabs;
        each(&mut together.between(&slabs.begin()[..=slabs.number()]), |at, part| {
            if is_wanted(at) {
                part.take_apart();
                for passage in self.of_slab(at)[..self.within[at]].iter().filter(|passage| is_way(passage)) {
                    part.join(slabs.place(passage.one), slabs.place(passage.other));
                }
            }
        });
    }

    /// What each of so many voids hangs together with, by way of other voids and of such constrictions, from
    /// what hangs together within slabs.
    pub(super) fn meet(
        &self,
        voids: usize,
        mut together: Together,
        is_way: impl Fn(&Passage) -> bool + Sync,
    ) -> Vec<Meets> {
        let (outside, slabs) = (voids as u32, &self.slabs);
        let is_way = |passage: &&Passage| is_way(passage);
        let others =
            || (0..=slabs.number()).flat_map(|at| &self.of_slab(at)[self.within[at]..]).filter(is_way);
        let is_inner = |passage: &&Passage| Some(passage.other) != self.reservoir && passage.other != outside;
        for passage in others().filter(is_inner) {
            together.join(slabs.place(passage.one), slabs.place(passage.other));
        }
        let mut of_root = vec![Meets::default(); voids];
        for passage in others().filter(|passage| !is_inner(passage)) {
            let meets = &mut of_root[together.root(slabs.place(passage.one)) as usize];
            meets.reservoir |= Some(passage.other) == self.reservoir;
            meets.end |= passage.other == outside;
        }
        let mut all = vec![Meets::default(); voids];
        let mut parts: Vec<_> = all.chunks_mut(Turned::GROUP).collect();
        each(&mut parts, |at, part| {
            for (void, meets) in (at * Turned::GROUP..).zip(part.iter_mut()) {
                *meets = of_root[together.found(slabs.place(void as u32)) as usize];
            }
        });
        all
    }
}

/// Slabs of a network without directions.
fn slabs(network: &Network) -> Slabs {
    let Some(reservoir) = network.reservoir() else { return Slabs::one(network.voids()) };
    let inlets = network.exits(reservoir).map(|c| network.targets()[c]).filter(|&to| to != END);
    let inlets: Vec<u32> = inlets.collect();
    Slabs::of(network.voids(), &inlets, |void, into| {
        let to = network.exits(void).map(|c| network.targets()[c]);
        into.extend(to.filter(|&to| to != END && to != reservoir));
    })
}

/// What a void hangs together with: the two sides of the filter, neither by way of the other.
#[derive(Clone, Copy, Default, PartialEq)]
pub(super) struct Meets {
    /// The reservoir.
    pub reservoir: bool,
    /// What lies behind the filter.
    pub end: bool,
}

/// Both.
pub(super) const THROUGH: Meets = Meets { reservoir: true, end: true };
