//! A network cut into slabs that only meet in cuts: threads work on slabs side by side.
//!
//! Voids are counted from the inlets on, each as far as it takes the fewest constrictions to reach it. No
//! constriction leads from one number past the next, so the voids of one number that lead to the next cut
//! those before them from those after them. Where slabs end follows from the network alone, so what is
//! worked out slab by slab, and added in their order, is the same to the bit on any number of threads.

use std::ops::Range;

use rayon::prelude::*;

/// Voids of a slab, at least: with fewer, waking other threads costs more than they bring.
const LEAST: usize = 6000;

/// The most slabs.
const MOST: usize = 64;

/// Voids in cuts, which one thread works on by itself: no more than one in so many.
const IN_CUTS: usize = 20;

/// Not counted yet.
const NONE: u32 = u32::MAX;

/// Which voids stand in which slab.
pub(super) struct Slabs {
    /// Voids, slab after slab and then cut after cut; those of each in rising order.
    order: Vec<u32>,
    /// By slab, and by cut after them: where its voids begin in that order; and where the last end.
    begin: Vec<usize>,
    /// By void: its slab, or number of slabs for those in cuts.
    slab: Vec<u32>,
    /// By void: where it stands in that order.
    place: Vec<u32>,
}

impl Slabs {
    /// All of so many voids in one slab.
    pub(super) fn one(voids: usize) -> Self {
        let order: Vec<u32> = (0..voids as u32).collect();
        Self { place: order.clone(), order, begin: vec![0, voids], slab: vec![0; voids] }
    }

    /// Of voids that are counted from the first of `inlets` on; `beyond` puts those that a void leads to
    /// into a list.
    pub(super) fn of(voids: usize, inlets: &[u32], beyond: impl Fn(u32, &mut Vec<u32>)) -> Self {
        if voids < 2 * LEAST {
            return Self::one(voids);
        }
        let (level, leads_on) = levels(voids, inlets, beyond);
        let mut size = vec![0usize; level.iter().max().map_or(0, |&most| most as usize + 1)];
        let mut width = size.clone();
        for (&level, &leads_on) in level.iter().zip(&leads_on) {
            size[level as usize] += 1;
            width[level as usize] += usize::from(leads_on);
        }
        let most = MOST.min(voids / LEAST) & !1;
        let fits = |&slabs: &usize| {
            let cuts = cuts(&size, voids, slabs);
            cuts.len() + 1 == slabs && cuts.iter().map(|&at| width[at]).sum::<usize>() * IN_CUTS <= voids
        };
        match (2..=most).rev().step_by(2).find(fits) {
            Some(slabs) => Self::between(&level, &leads_on, &cuts(&size, voids, slabs)),
            None => Self::one(voids),
        }
    }

    /// Between cuts at these numbers, which rise.
    fn between(level: &[u32], leads_on: &[bool], cuts: &[usize]) -> Self {
        let slabs = cuts.len() + 1;
        // Slabs first, then cuts; those of a cut's number that do not lead on stand in the slab before it.
        let part = |(&level, &leads_on): (&u32, &bool)| match cuts.binary_search(&(level as usize)) {
            Ok(cut) if leads_on => slabs + cut,
            Ok(slab) | Err(slab) => slab,
        };
        let part: Vec<usize> = level.iter().zip(leads_on).map(part).collect();
        let mut begin = vec![0; slabs + cuts.len() + 1];
        part.iter().for_each(|&part| begin[part + 1] += 1);
        (1..begin.len()).for_each(|i| begin[i] += begin[i - 1]);
        let (mut next, mut order, mut place) = (begin.clone(), vec![0; level.len()], vec![0; level.len()]);
        for (void, &part) in (0u32..).zip(&part) {
            order[next[part]] = void;
            place[void as usize] = next[part] as u32;
            next[part] += 1;
        }
        let slab = part.into_iter().map(|part| part.min(slabs) as u32).collect();
        Self { order, begin, slab, place }
    }

    /// Number of slabs.
    pub(super) fn number(&self) -> usize {
        self.begin.len() / 2
    }

    /// Voids in their order.
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    /// By slab, and by cut after them: where its voids begin in that order; and where the last end.
    pub(super) fn begin(&self) -> &[usize] {
        &self.begin
    }

    /// The voids of a slab, and of the cuts before and after it.
    pub(super) fn around(&self, slab: usize) -> impl Iterator<Item = u32> {
        let part = |at: usize| self.order[self.begin[at]..self.begin[at + 1]].iter().copied();
        part(slab).chain(self.cuts_of(slab).flat_map(part))
    }

    /// The cuts before and after a slab, counted after all slabs.
    pub(super) fn cuts_of(&self, slab: usize) -> Range<usize> {
        let number = self.number();
        number + slab.saturating_sub(1)..(number + slab + 1).min(2 * number - 1)
    }

    /// Where a void stands in their order.
    pub(super) fn place(&self, void: u32) -> u32 {
        self.place[void as usize]
    }

    /// The slab that a void stands in, or those on both sides of its cut.
    pub(super) fn beside(&self, void: u32) -> Range<usize> {
        let slab = self.slab[void as usize] as usize;
        if slab < self.number() {
            return slab..slab + 1;
        }
        let place = self.place(void) as usize;
        let cut = self.begin[self.number()..].partition_point(|&begin| begin <= place) - 1;
        cut..cut + 2
    }

    /// Whether both of these voids stand in a slab, which is the same then if a constriction joins them.
    pub(super) fn are_both(&self, one: u32, other: u32) -> bool {
        [one, other].iter().all(|&void| (self.slab[void as usize] as usize) < self.number())
    }

    /// The slab of what joins these two voids, or the number of slabs where none of them stands in one.
    pub(super) fn of_both(&self, one: u32, other: Option<u32>) -> usize {
        let of = |void: u32| self.slab[void as usize];
        other.map_or(of(one), |other| of(one).min(of(other))) as usize
    }
}

/// Does the same for each of several, on all threads.
pub(super) fn each<T: Send>(all: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    if all.len() > 1 && rayon::current_num_threads() > 1 {
        all.par_iter_mut().enumerate().with_max_len(1).for_each(|(at, one)| work(at, one));
    } else {
        all.iter_mut().enumerate().for_each(|(at, one)| work(at, one));
    }
}

/// How many constrictions a void is away from the inlets, and whether it leads to one that is one more.
/// Voids that nothing leads to are counted from the number of the void before them, which often lies beside
/// them.
fn levels(voids: usize, inlets: &[u32], beyond: impl Fn(u32, &mut Vec<u32>)) -> (Vec<u32>, Vec<bool>) {
    let (mut level, mut leads_on) = (vec![NONE; voids], vec![false; voids]);
    let mut queue: Vec<u32> = Vec::with_capacity(voids);
    for &void in inlets {
        if std::mem::replace(&mut level[void as usize], 0) == NONE {
            queue.push(void);
        }
    }
    let (mut done, mut near) = (0, Vec::new());
    for next in 0..voids {
        while let Some(&void) = queue.get(done) {
            done += 1;
            near.clear();
            beyond(void, &mut near);
            let after = level[void as usize] + 1;
            for &to in &near {
                if level[to as usize] == NONE {
                    level[to as usize] = after;
                    queue.push(to);
                }
                leads_on[void as usize] |= level[to as usize] == after;
            }
        }
        if level[next] == NONE {
            level[next] = if next == 0 { 0 } else { level[next - 1] };
            queue.push(next as u32);
        }
    }
    (level, leads_on)
}

/// Numbers whose voids are cuts between so many slabs of about as many voids each; fewer where two would be
/// neighbours.
fn cuts(size: &[usize], voids: usize, slabs: usize) -> Vec<usize> {
    let mut cuts: Vec<usize> = Vec::with_capacity(slabs);
    let mut before = 0;
    for (at, size) in size.iter().enumerate() {
        before += size;
        let is_after_another = cuts.last().is_none_or(|&last| at > last + 1) && at > 0;
        if cuts.len() + 1 < slabs && before * slabs >= (cuts.len() + 1) * voids && is_after_another {
            cuts.push(at);
        }
    }
    cuts.retain(|&at| at + 1 < size.len());
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Voids of a grid of so many columns and rows, numbered column by column, that water enters in the first
    /// row.
    fn grid(columns: u32, rows: u32) -> Slabs {
        let beyond = |void: u32, into: &mut Vec<u32>| {
            let [column, row] = [void / rows, void % rows];
            into.extend(
                [
                    row.checked_sub(1).map(|_| void - 1),
                    (row + 1 < rows).then_some(void + 1),
                    column.checked_sub(1).map(|_| void - rows),
                    (column + 1 < columns).then_some(void + rows),
                ]
                .into_iter()
                .flatten(),
            );
        };
        let inlets: Vec<u32> = (0..columns).map(|column| column * rows).collect();
        Slabs::of((columns * rows) as usize, &inlets, beyond)
    }

    #[test]
    fn slabs_meet_in_cuts_only() {
        let [columns, rows] = [100, 400];
        let slabs = grid(columns, rows);
        assert_eq!(slabs.number(), 6);
        let mut seen = slabs.order().to_vec();
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..columns * rows));
        let in_slabs = &slabs.begin()[..=6];
        assert!(in_slabs.windows(2).all(|w| (6000..7000).contains(&(w[1] - w[0]))), "{in_slabs:?}");
        assert!(slabs.begin()[6..].windows(2).all(|w| w[1] - w[0] == columns as usize));
        for void in 0..columns * rows - 1 {
            let of = |void| slabs.of_both(void, None);
            if (void + 1) % rows > 0 && of(void) != of(void + 1) {
                assert!(of(void) == 6 || of(void + 1) == 6, "{void}");
                assert_eq!(slabs.of_both(void, Some(void + 1)), of(void).min(of(void + 1)));
            }
        }
        let cut = slabs.order()[slabs.begin()[6]];
        assert_eq!(slabs.of_both(cut, Some(slabs.order()[slabs.begin()[7]])), 6);
    }

    /// A chain, each void of which has a dead end: these do not cut it.
    #[test]
    fn dead_ends_stand_in_no_cut() {
        let beyond = |void: u32, into: &mut Vec<u32>| match void % 2 {
            1 => into.push(void - 1),
            _ => into.extend(
                [void.checked_sub(2), Some(void + 1), (void < 29_998).then_some(void + 2)]
                    .into_iter()
                    .flatten(),
            ),
        };
        let slabs = Slabs::of(30_000, &[0], beyond);
        assert_eq!(slabs.number(), 4);
        let cuts = &slabs.order()[slabs.begin()[4]..];
        assert!(cuts.len() == 3 && cuts.iter().all(|void| void % 2 == 0), "{cuts:?}");
        for void in 0..30_000 {
            let (mut near, of) = (Vec::new(), |void| slabs.of_both(void, None));
            beyond(void, &mut near);
            assert!(near.iter().all(|&to| of(to) == of(void) || of(to) == 4 || of(void) == 4), "{void}");
        }
    }

    /// A network as wide as it is long has no narrow cuts, and a small one pays for none.
    #[test]
    fn what_has_no_narrow_cuts_is_one_slab() {
        assert_eq!(grid(3000, 5).number(), 1);
        assert_eq!(grid(100, 100).number(), 1);
    }

    /// What no inlet leads to stands in a slab, too.
    #[test]
    fn voids_that_nothing_leads_to_are_counted() {
        let line = |void: u32, into: &mut Vec<u32>| {
            into.extend([void.checked_sub(1), (void < 19_999).then_some(void + 1)].into_iter().flatten());
        };
        let apart = |void: u32, into: &mut Vec<u32>| {
            if void < 19_000 {
                line(void, into)
            }
        };
        let slabs = Slabs::of(20_000, &[0], apart);
        assert_eq!((slabs.number(), slabs.order().len()), (2, 20_000));
        assert_eq!(Slabs::of(20_000, &[], line).number(), 2);
    }
}
