//! Inserts one grain after another: each carves its cavity and fills it (Bowyer, Watson).
//!
//! The steps are identical in space, where tetrahedra with a corner at infinity close the triangulation,
//! and on the torus, where a grain represents all its images. The torus is valid as long as the cavity
//! of a grain neither overlaps the cavities of its images nor shares a facet with them; a violation is
//! detected ([`Wrapped`]).
//!
//! # Order
//! Coarse to fine, each level along a Hilbert curve. Neighbours on the curve are neighbours in space, so
//! a walk from the previous grain is short. Each level is an even sample of the whole, so no cavity
//! becomes long (this is the purpose of the biased randomised order of Amenta, Choi & Rote,
//! doi:10.1145/777792.777824, here without random numbers).

use super::mesh::{Corner, GrainPoint, INFINITE, Mesh, NONE, Points, Shift, corner, grain, image};
use super::predicates::{facets, in_conflict, orientation};
use std::cmp::Ordering;

/// The cavity of a grain met the cavity of one of its images.
pub(super) struct Wrapped;

/// State of a tetrahedron in the current insertion.
#[derive(Clone, Copy)]
struct Mark {
    insertion: u32,
    /// Bits 0..24: the translate in which it was met; bit 31: set if it is in the cavity.
    state: u32,
}

const IN_CAVITY: u32 = 1 << 31;

/// A facet of the cavity, and the tetrahedron to be built on it.
#[derive(Clone, Copy)]
struct Stand {
    grains: [u32; 4],
    /// Shift of each corner as seen from the new grain.
    images: [Shift; 4],
    /// Index of the corner that is the new grain.
    apex: usize,
    /// The tetrahedron outside, and its corner opposite the facet.
    outside: u32,
    translate: Shift,
}

/// An edge on the surface of the cavity and the facet that met it first.
#[derive(Clone, Copy)]
struct Edge {
    insertion: u32,
    ends: [(u32, Shift); 2],
    tetrahedron: u32,
    facet: u32,
}

impl Edge {
    const UNUSED: Self = Self { insertion: 0, ends: [(0, Shift::ZERO); 2], tetrahedron: 0, facet: 0 };
}

pub(super) struct Builder<'a> {
    pub(super) mesh: Mesh,
    points: &'a Points,
    /// Grain of each point and its images; breaks ties between coincident centres.
    identity: &'a [u32],
    marks: Vec<Mark>,
    insertion: u32,
    /// Start of the next walk, and its translate.
    last: (u32, Shift),
    dead: Vec<u32>,
    stack: Vec<(u32, Shift)>,
    stands: Vec<Stand>,
    new: Vec<(u32, Shift)>,
    edges: Vec<Edge>,
}

impl<'a> Builder<'a> {
    /// Continues from a mesh, which must not be empty.
    pub(super) fn new(mesh: Mesh, points: &'a Points, identity: &'a [u32]) -> Self {
        let marks = vec![Mark { insertion: 0, state: 0 }; mesh.corners.len()];
        let last = (mesh.corners.iter().position(|c| c[0] != NONE).unwrap_or(0) as u32, Shift::ZERO);
        Self {
            mesh,
            points,
            identity,
            marks,
            insertion: 0,
            last,
            dead: Vec::new(),
            stack: Vec::new(),
            stands: Vec::new(),
            new: Vec::new(),
            edges: vec![Edge::UNUSED; 256],
        }
    }

    /// Makes a free triangulation of the first four points of `order` that span space, and moves these
    /// points to its front. `None` if all lie in one plane.
    pub(super) fn first(points: &'a Points, identity: &'a [u32], order: &mut [u32]) -> Option<Self> {
        let spanning = spanning(&points.at, order)?;
        for (place, at) in spanning.into_iter().enumerate() {
            // Later entries hold later positions, so no placed point moves.
            order[place..=at].rotate_right(1);
        }
        let mut corners = [order[0], order[1], order[2], order[3]];
        if orientation(&corners.map(|p| points.at[p as usize])) < 0 {
            corners.swap(2, 3);
        }
        let mut mesh = Mesh::default();
        let inner = mesh.push(corners);
        let outer: [u32; 4] = std::array::from_fn(|i| {
            let mut outside = corners;
            outside[i] = INFINITE;
            // Seen from infinity the facet turns the other way.
            outside.swap((i + 1) % 4, (i + 2) % 4);
            mesh.push(outside)
        });
        for i in 0..4 {
            mesh.link((inner, i), (outer[i], i), Shift::ZERO);
            for j in 0..i {
                // The facet without corners i and j, in both.
                let facet = |t: u32, missing: Corner| {
                    mesh.corners[t as usize].iter().position(|&c| c == missing).unwrap_or(0)
                };
                let (a, b) = (facet(outer[i], corners[j]), facet(outer[j], corners[i]));
                mesh.link((outer[i], a), (outer[j], b), Shift::ZERO);
            }
        }
        Some(Self::new(mesh, points, identity))
    }

    /// Tells if point `p` at `at` removes tetrahedron `t`, in the translate `shift`.
    #[inline(always)]
    fn conflict<const PERIODIC: bool>(&self, t: u32, shift: Shift, p: u32, at: &GrainPoint) -> bool {
        let corners = &self.mesh.corners[t as usize];
        let tie = |i: usize, j: usize| -> Ordering {
            let id = |i: usize| self.identity[if i == 4 { p } else { grain(corners[i]) } as usize];
            id(i).cmp(&id(j))
        };
        if !PERIODIC && let Some(i) = self.mesh.infinite_corner(t) {
            return self.infinite_conflict(t, i, p, at);
        }
        in_conflict(&self.points.corners::<PERIODIC>(corners, shift), at, tie)
    }

    /// Tells if a point is beyond a facet of the hull; in its plane, the tetrahedron behind it decides.
    #[inline(never)]
    fn infinite_conflict(&self, t: u32, infinite: usize, p: u32, at: &GrainPoint) -> bool {
        let mut corners = self.mesh.corners[t as usize];
        corners[infinite] = p;
        match orientation(&corners.map(|c| self.points.at[c as usize])) {
            0 => self.conflict::<false>(self.mesh.neighbours[t as usize][infinite] / 4, Shift::ZERO, p, at),
            side => side > 0,
        }
    }

    /// Walks to a tetrahedron that contains the point, or to one beyond the hull that sees it.
    #[inline]
    fn locate<const PERIODIC: bool>(&self, at: &GrainPoint) -> (u32, Shift) {
        let (mut t, mut shift) = self.last;
        if !PERIODIC && let Some(i) = self.mesh.infinite_corner(t) {
            t = self.mesh.neighbours[t as usize][i] / 4;
        }
        loop {
            if !PERIODIC && self.mesh.infinite_corner(t).is_some() {
                return (t, shift);
            }
            let corners = self.points.corners::<PERIODIC>(&self.mesh.corners[t as usize], shift);
            let Some(i) = facets(&corners, at) else { return (t, shift) };
            if PERIODIC {
                shift = shift.plus(self.mesh.shifts[t as usize][i]);
            }
            t = self.mesh.neighbours[t as usize][i] / 4;
        }
    }

    /// Inserts point `p`, unless other points hide it.
    pub(super) fn insert<const PERIODIC: bool>(&mut self, p: u32) -> Result<(), Wrapped> {
        let at = self.points.at[p as usize];
        let start = self.locate::<PERIODIC>(&at);
        if !self.conflict::<PERIODIC>(start.0, start.1, p, &at) {
            self.last = start;
            return Ok(());
        }
        self.carve::<PERIODIC>(start, p, &at)?;
        self.fill::<PERIODIC>()
    }

    /// Collects the cavity in `dead` and its surface in `stands`.
    fn carve<const PERIODIC: bool>(
        &mut self,
        start: (u32, Shift),
        p: u32,
        at: &GrainPoint,
    ) -> Result<(), Wrapped> {
        self.insertion += 1;
        let insertion = self.insertion;
        self.stands.clear();
        self.stack.clear();
        self.marks[start.0 as usize] = Mark { insertion, state: IN_CAVITY | (start.1.0 & !IN_CAVITY) };
        self.stack.push(start);
        let mut next = 0;
        while next < self.stack.len() {
            let (t, shift) = self.stack[next];
            next += 1;
            for i in 0..4 {
                let across = self.mesh.neighbours[t as usize][i];
                let o = across / 4;
                let translate =
                    if PERIODIC { shift.plus(self.mesh.shifts[t as usize][i]) } else { Shift::ZERO };
                let mark = self.marks[o as usize];
                let known = mark.insertion == insertion;
                let same = mark.state & !IN_CAVITY == translate.0 & !IN_CAVITY;
                if known && mark.state & IN_CAVITY != 0 {
                    if same {
                        continue;
                    }
                    return Err(Wrapped);
                }
                if !(known && same) {
                    let taken = self.conflict::<PERIODIC>(o, translate, p, at);
                    let state = (translate.0 & !IN_CAVITY) | if taken { IN_CAVITY } else { 0 };
                    self.marks[o as usize] = Mark { insertion, state };
                    if taken {
                        self.stack.push((o, translate));
                        continue;
                    }
                }
                let [a, b, c, d] = self.mesh.corners[t as usize];
                let mut stand = Stand {
                    grains: [grain(a), grain(b), grain(c), grain(d)],
                    images: [Shift::ZERO; 4],
                    apex: i,
                    outside: across,
                    translate,
                };
                if PERIODIC {
                    let from_p = |c: Corner| image(c).plus(shift);
                    stand.images = [from_p(a), from_p(b), from_p(c), from_p(d)];
                    stand.images[i] = Shift::ZERO;
                }
                stand.grains[i] = p;
                self.stands.push(stand);
            }
        }
        Ok(())
    }

    /// Replaces the cavity by tetrahedra from its surface to the new grain.
    fn fill<const PERIODIC: bool>(&mut self) -> Result<(), Wrapped> {
        for stand in &self.stands {
            let mark = self.marks[(stand.outside / 4) as usize];
            if PERIODIC && mark.state & IN_CAVITY != 0 {
                return Err(Wrapped);
            }
        }
        for &(t, _) in &self.stack {
            self.mesh.corners[t as usize][0] = NONE;
            self.dead.push(t);
        }
        self.new.clear();
        for stand in &self.stands {
            let (mut corners, mut shift) = (stand.grains, Shift::ZERO);
            if PERIODIC {
                (corners, shift) = stored(&stand.grains, &stand.images).ok_or(Wrapped)?;
            }
            let t = match self.dead.pop() {
                Some(t) => {
                    self.mesh.corners[t as usize] = corners;
                    t
                }
                None => {
                    self.marks.push(Mark { insertion: 0, state: 0 });
                    self.mesh.push(corners)
                }
            };
            self.new.push((t, shift));
            let (outside, j) = (stand.outside / 4, (stand.outside % 4) as usize);
            self.mesh.link((t, stand.apex), (outside, j), stand.translate.minus(shift));
        }
        let wanted = (self.stands.len() * 4).next_power_of_two();
        if self.edges.len() < wanted {
            self.edges = vec![Edge::UNUSED; wanted];
        }
        for k in 0..self.stands.len() {
            let stand = self.stands[k];
            for i in 1..4 {
                let facet = (stand.apex + i) % 4;
                // The two corners of that facet beside the new grain.
                let others = [(stand.apex + 1 + i % 3) % 4, (stand.apex + 1 + (i + 1) % 3) % 4];
                let ends = others.map(|c| (stand.grains[c], stand.images[c]));
                self.pair(ends, k as u32, facet as u32);
            }
        }
        self.last = self.new[0];
        Ok(())
    }

    /// Links the two new tetrahedra that share an edge of the cavity's surface, once both exist.
    #[inline(always)]
    fn pair(&mut self, mut ends: [(u32, Shift); 2], k: u32, facet: u32) {
        if ends[1] < ends[0] {
            ends.swap(0, 1);
        }
        let (insertion, mask) = (self.insertion, self.edges.len() - 1);
        let mixed = (u64::from(ends[0].0) << 32 | u64::from(ends[1].0)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut slot = (mixed >> 40) as usize & mask;
        loop {
            let edge = self.edges[slot];
            if edge.insertion != insertion {
                self.edges[slot] = Edge { insertion, ends, tetrahedron: k, facet };
                return;
            }
            if edge.ends == ends {
                let (a, b) = (self.new[edge.tetrahedron as usize], self.new[k as usize]);
                self.mesh.link((a.0, edge.facet as usize), (b.0, facet as usize), b.1.minus(a.1));
                return;
            }
            slot = (slot + 1) & mask;
        }
    }
}

/// Moves corners to their stored translate, and returns the shift back; `None` if the images extend over
/// more than four cells.
pub(super) fn stored(grains: &[u32; 4], images: &[Shift; 4]) -> Option<([Corner; 4], Shift)> {
    if images.iter().all(|&i| i == Shift::ZERO) {
        return Some((*grains, Shift::ZERO));
    }
    let cells = images.map(Shift::cells);
    let least = Shift::new(std::array::from_fn(|axis| cells.iter().fold(i32::MAX, |m, c| m.min(c[axis]))));
    let mut corners = [0; 4];
    for (slot, (&grain, &image)) in corners.iter_mut().zip(grains.iter().zip(images)) {
        *slot = corner(grain, image.minus(least))?;
    }
    Some((corners, least))
}

/// Finds the positions in `order`, ascending, of four points that span space.
fn spanning(at: &[GrainPoint], order: &[u32]) -> Option<[usize; 4]> {
    let point = |i: usize| at[order[i] as usize];
    let a = point(0);
    let mut chosen = [0; 4];
    chosen[1] = (1..order.len()).find(|&i| point(i)[..3] != a[..3])?;
    let b = point(chosen[1]);
    // Collinear with a and b, so coplanar with any two other points; three are tried.
    let aside = |i: usize| {
        let c = point(i);
        (0..3).any(|axis| {
            let mut d = a;
            d[axis] += 1.0;
            orientation(&[a, b, c, d]) != 0
        })
    };
    chosen[2] = (chosen[1] + 1..order.len()).find(|&i| aside(i))?;
    let c = point(chosen[2]);
    chosen[3] = (chosen[2] + 1..order.len()).find(|&i| orientation(&[a, b, c, point(i)]) != 0)?;
    Some(chosen)
}

pub(super) fn free_order(at: &[GrainPoint]) -> Vec<u32> {
    let values = |axis: usize| at.iter().map(move |p| p[axis]);
    let low: [f64; 3] = std::array::from_fn(|axis| values(axis).fold(f64::INFINITY, f64::min));
    let high = |axis: usize| values(axis).fold(f64::NEG_INFINITY, f64::max);
    let extent = (0..3).map(|axis| high(axis) - low[axis]).fold(1.0, f64::max);
    levels(&sorted(at, low, extent), (at.len() / 64).max(1))
}

const BITS: u32 = 16;

/// Approximate growth of the number of grains from one level to the next.
const GROWTH: usize = 8;

/// Distance along the Hilbert curve of a cell in a grid of 2^[`BITS`] cells per side (Skilling,
/// *Programming the Hilbert curve*, doi:10.1063/1.1751381).
fn along_curve(mut x: [u32; 3]) -> u64 {
    let mut q = 1 << (BITS - 1);
    while q > 1 {
        let p = q - 1;
        for i in 0..3 {
            if x[i] & q != 0 {
                x[0] ^= p;
            } else {
                let t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
        q >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut t = 0;
    q = 1 << (BITS - 1);
    while q > 1 {
        if x[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let spread = |value: u32| -> u64 {
        let mut v = u64::from(value ^ t);
        v = (v | v << 32) & 0x001f_0000_0000_ffff;
        v = (v | v << 16) & 0x001f_0000_ff00_00ff;
        v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
        v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
        (v | v << 2) & 0x1249_2492_4924_9249
    };
    spread(x[0]) << 2 | spread(x[1]) << 1 | spread(x[2])
}

/// Sorts all points along the curve through the box from `low` to `low + extent`.
pub(super) fn sorted(at: &[GrainPoint], low: [f64; 3], extent: f64) -> Vec<u32> {
    let scale = f64::from(1u32 << BITS) / extent;
    let mut keyed: Vec<(u64, u32)> = at
        .iter()
        .zip(0u32..)
        .map(|(point, i)| {
            let cell = |axis: usize| (((point[axis] - low[axis]) * scale) as u32).min((1 << BITS) - 1);
            (along_curve([cell(0), cell(1), cell(2)]), i)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, i)| i).collect()
}

/// Reorders the points: first every `stride`th, then the rest level by level.
pub(super) fn levels(sorted: &[u32], mut stride: usize) -> Vec<u32> {
    let mut placed = vec![false; sorted.len()];
    let mut order = Vec::with_capacity(sorted.len());
    loop {
        for i in (0..sorted.len()).step_by(stride) {
            if !std::mem::replace(&mut placed[i], true) {
                order.push(sorted[i]);
            }
        }
        if stride == 1 {
            return order;
        }
        stride = (stride / GROWTH).max(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_steps_from_cell_to_neighbouring_cell() {
        let mut cells = Vec::new();
        for x in 0..8u32 {
            for y in 0..8 {
                for z in 0..8 {
                    cells.push((along_curve([x, y, z]), [x as i32, y as i32, z as i32]));
                }
            }
        }
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let step: i32 = (0..3).map(|axis| (pair[0].1[axis] - pair[1].1[axis]).abs()).sum();
            assert_eq!(step, 1, "{pair:?}");
        }
    }

    #[test]
    fn every_point_has_one_place() {
        let mut order = levels(&(0..1000).collect::<Vec<_>>(), 77);
        assert_eq!(order[..3], [0, 77, 154]);
        order.sort_unstable();
        assert!(order.into_iter().eq(0..1000));
    }
}
