//! Measures the constrictions of a packing.

use super::curve::{Curve, CurveError, CurveUnit};
use super::discs::{ConstrictionDisc, disc};
use super::frame::{Frame, Region, is_surrounded, void_ratio_within};
use super::triangulation::{GrainPoint, Positions, Shift, Triangulation, TriangulationError};
use super::twice::{duplicates, near};
use super::voids::{Insphere, Voids};
use crate::packing::Packing;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Relative difference of centre and radius, by the radius, within which two discs between the same voids are
/// one (four grains on one circle, up to a jitter of 1e-6 of a grain).
const SAME_DISC: f64 = 1e-4;

/// Overlap from which two tetrahedra share a void, unless it is given.
pub const DEFAULT_MERGE_OVERLAP: f64 = 0.1;

/// Which facets between two voids are constrictions.
///
/// The published program of the paper's author (T. Shire, *Weighted-Delaunay-Constrictions*, GitHub,
/// after Reboul et al.) does not count every facet between two voids: it takes the convex hull of the
/// grains of each void and counts a triangle that is on two such hulls. With its overlap of 0.5 this
/// gives, on packings of Cu 1.5 and Cu 3, the curve that all facets give at an overlap of 0.1, within 1 %
/// from Dc5 to Dc75 (`results/packing.md`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum Facets {
    /// Every facet between two voids.
    #[default]
    All,
    /// Those on the convex hulls of the grain centres of both voids.
    OnBothHulls,
}

/// The constrictions of a packing, the voids between them, and the quantities for judging a filter.
///
/// Constriction `c` is entry `c` of the constriction columns, void `v` entry `v` of the void columns.
/// Constrictions are in the order of their tetrahedra, which the packing alone decides. A free packing's
/// columns hold everything; its statistics leave out the outer 5 %.
///
/// ```
/// use voidwalk_core::constrictions::Constrictions;
/// use voidwalk_core::packing::{Cell, Packing};
/// // Simple cubic: 3 x 3 x 3 touching grains of 1 mm.
/// let along = |stride: usize| (0..27).map(|i| (i / stride % 3) as f64).collect();
/// let packing = Packing {
///     cell: Cell::Periodic([3.0; 3]),
///     x: along(1), y: along(3), z: along(9),
///     diameter: vec![1.0; 27],
/// };
/// let measured = Constrictions::measure(&packing, 0.1)?;
/// assert_eq!((measured.voids(), measured.constrictions()), (27, 81));
/// assert!((measured.diameter_mm[0] - 0.414_214).abs() < 1e-6);
/// # Ok::<(), voidwalk_core::constrictions::ConstrictionsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Constrictions {
    /// Constriction diameter (mm) by constriction.
    pub diameter_mm: Vec<f64>,
    /// Centre x, y, z (mm) by constriction, inside the cell.
    pub centre_mm: Vec<[f64; 3]>,
    /// Void on the side of lower z, by constriction.
    pub upstream: Vec<u32>,
    /// Void on the side of higher z, by constriction.
    pub downstream: Vec<u32>,
    /// Diameter (mm) of the largest sphere tangent to four grains of the void, by void; 0 if there is no such
    /// sphere.
    pub void_diameter_mm: Vec<f64>,
    /// Its centre x, y, z (mm), by void; a corner of the void if there is no such sphere.
    pub void_centre_mm: Vec<[f64; 3]>,
    /// Tetrahedra by void.
    pub void_tetrahedra: Vec<u32>,
    /// Facets between voids that the grains close.
    pub closed: usize,
    /// Constrictions whose disc a fourth grain shortened.
    pub cut: usize,
    /// Tetrahedra without a tangent sphere.
    pub open_tetrahedra: usize,
    /// Tetrahedra of four grains on one circle.
    pub flat_tetrahedra: usize,
    /// Tetrahedra.
    pub tetrahedra: usize,
    /// Grains inside others, ascending; they take no part.
    pub hidden: Vec<u32>,
    /// Pairs of grains with the same centre, to a thousandth of the smaller diameter.
    pub duplicates: Vec<[u32; 2]>,
    /// Pairs of grains nearer than a quarter of the smaller diameter.
    pub near: Vec<[u32; 2]>,
    /// Volume of voids over volume of grains (overlaps counted twice).
    pub void_ratio: f64,
    /// Smallest grain (mm).
    pub d0_mm: f64,
    /// Overlap from which two tetrahedra share a void.
    pub merge_overlap: f64,
    /// Facets between voids that were counted.
    pub counted: Facets,
    /// Region for statistics.
    pub(super) region: Region,
    /// Grains in the region, hidden ones left out.
    pub(super) grains: usize,
    /// True if a grain has others all around it.
    pub(super) is_surrounded: bool,
}

/// Reasons why a packing's constrictions cannot be measured.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum ConstrictionsError {
    /// The packing has no triangulation.
    #[error(transparent)]
    Triangulation(#[from] TriangulationError),
    /// Grains without a periodic cell, which the graph of their voids needs.
    #[error("the grains have no periodic cell, and the graph of their voids needs one")]
    NoCell,
    /// A void that meets itself on the other side of the cell.
    #[error(
        "void {void} runs through the whole cell and meets itself: no way through the graph is known. Merge \
         less (merge_overlap = {merge_overlap} now), or take more grains"
    )]
    Endless {
        /// The void.
        void: u32,
        /// Overlap from which tetrahedra share a void.
        merge_overlap: f64,
    },
    /// Grains inside others: a periodic cell of another size or unit makes them of grains side by side.
    #[error(
        "the grains do not fit their cell: {hidden} of {grains} lie inside others, the first of them grain \
         {first} (counted from 0). The cell is too small, or in another unit than the grains, or grains \
         stand twice in the file"
    )]
    Hidden {
        /// Grains inside others.
        hidden: usize,
        /// All grains.
        grains: usize,
        /// The first grain inside another.
        first: u32,
    },
    /// Grains that occur twice.
    #[error(
        "{pairs} pairs of grains have the same centre, the first of them grains {} and {} (counted from 0); \
         leave out those that stand twice",
        first[0], first[1]
    )]
    Twice {
        /// Number of such pairs.
        pairs: usize,
        /// First such pair.
        first: [u32; 2],
    },
    /// Grains that leave no voids.
    #[error(
        "the void ratio is {void_ratio:.4}: the grains have more volume than the space that they stand in. \
         Diameters may be in another unit than centres, or radii be read as diameters"
    )]
    Full {
        /// Volume of voids over volume of grains.
        void_ratio: f64,
    },
    /// Grains without any that has others all around it.
    #[error(
        "no grain has others all around it: the grains are a layer, a heap or a row, and their voids are \
         open \
         outwards. Take a block of at least three grains along each axis, or give its periodic cell"
    )]
    Outside,
    /// An invalid merge overlap.
    #[error("merge_overlap = {value} is not allowed; allowed: a finite number from 0")]
    MergeOverlap {
        /// Requested value.
        value: f64,
    },
}

/// The voids of a triangulation.
///
/// # Errors
/// A `merge_overlap` that is negative or not finite.
pub(super) fn merged(t: &Triangulation, merge_overlap: f64) -> Result<Voids, ConstrictionsError> {
    if !(merge_overlap.is_finite() && merge_overlap >= 0.0) {
        return Err(ConstrictionsError::MergeOverlap { value: merge_overlap });
    }
    Ok(Voids::merge(t, &t.positions(), merge_overlap))
}

/// An open facet between two voids, and the constriction that it forms, or forms a part of.
pub(super) struct Passage {
    /// Tetrahedron and corner opposite the facet, on the side with the lower index.
    pub(super) facet: (usize, usize),
    /// Its constriction; a new one is numbered one above those of earlier facets.
    pub(super) constriction: usize,
    /// Radius of the disc, in grid units.
    pub(super) radius: f64,
    /// Its centre, in the stored translate of the tetrahedron.
    pub(super) centre: [f64; 3],
    /// True if a fourth grain cuts into it.
    pub(super) cut: bool,
}

/// The facets between voids.
pub(super) struct Passages {
    /// Open facets.
    pub(super) open: Vec<Passage>,
    /// Number of facets that the grains close.
    pub(super) closed: usize,
}

impl Passages {
    /// Finds the facets between voids that are `counted`.
    pub(super) fn new(t: &Triangulation, positions: &Positions<'_>, voids: &Voids, counted: Facets) -> Self {
        let counts = |i: usize, k: usize| {
            // Each facet is taken from the tetrahedron with the lower index.
            t.across(i, k).is_some_and(|(u, j, _)| {
                u > i
                    && voids.by_tetrahedron[u] != voids.by_tetrahedron[i]
                    && (counted == Facets::All
                        || voids.on_hull(t, positions, i, k) && voids.on_hull(t, positions, u, j))
            })
        };
        let facets: Vec<(usize, usize)> = (0..t.tetrahedra())
            .into_par_iter()
            .with_min_len(256)
            .flat_map_iter(|i| (0..4).map(move |k| (i, k)))
            .filter(|&(i, k)| counts(i, k))
            .collect();
        let discs: Vec<ConstrictionDisc> =
            facets.par_iter().with_min_len(256).map(|&(i, k)| disc(t, positions, i, k)).collect();
        let frame = Frame::new(t);
        let mut passages = Self { open: Vec::new(), closed: 0 };
        // Diameter and centre (mm) of each constriction.
        let mut constrictions: Vec<(f64, [f64; 3])> = Vec::new();
        let mut between: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
        for (&(i, k), disc) in facets.iter().zip(&discs) {
            let Some((u, _, _)) = t.across(i, k) else { continue };
            if disc.radius <= 0.0 {
                passages.closed += 1;
                continue;
            }
            let (centre, diameter) = (frame.inside_mm(disc.centre), 2.0 * disc.radius * frame.unit_mm);
            let (a, b) = (voids.by_tetrahedron[i], voids.by_tetrahedron[u]);
            let seen = between.entry((a.min(b), a.max(b))).or_default();
            let same = |&&c: &&usize| {
                (constrictions[c].0 - diameter).abs() <= SAME_DISC * diameter
                    && frame.distance_mm(&constrictions[c].1, &centre) <= SAME_DISC * diameter
            };
            let constriction = match seen.iter().find(same) {
                Some(&known) => known,
                None => {
                    seen.push(constrictions.len());
                    constrictions.push((diameter, centre));
                    constrictions.len() - 1
                }
            };
            let &ConstrictionDisc { centre, radius, cut } = disc;
            passages.open.push(Passage { facet: (i, k), constriction, radius, centre, cut });
        }
        passages
    }
}

impl Constrictions {
    /// Triangulates a packing and measures it.
    ///
    /// # Errors
    /// Errors of [`Triangulation::new`]; a `merge_overlap` that is negative or not finite.
    pub fn measure(packing: &Packing, merge_overlap: f64) -> Result<Self, ConstrictionsError> {
        Self::from_triangulation(&Triangulation::new(packing)?, merge_overlap, Facets::All)
    }

    /// Measures a triangulation.
    ///
    /// # Errors
    /// A `merge_overlap` that is negative or not finite.
    pub fn from_triangulation(
        t: &Triangulation,
        merge_overlap: f64,
        counted: Facets,
    ) -> Result<Self, ConstrictionsError> {
        let voids = merged(t, merge_overlap)?;
        let passages = Passages::new(t, &t.positions(), &voids, counted);
        Ok(Self::between(t, &voids, &passages, merge_overlap, counted))
    }

    /// Measures the facets between the voids of a triangulation.
    pub(super) fn between(
        t: &Triangulation,
        voids: &Voids,
        passages: &Passages,
        merge_overlap: f64,
        counted: Facets,
    ) -> Self {
        let positions = t.positions();
        let frame = Frame::new(t);
        let mut measured = Self::empty(t, voids, &frame);
        (measured.merge_overlap, measured.counted) = (merge_overlap, counted);
        measured.closed = passages.closed;
        for passage in &passages.open {
            if passage.constriction < measured.diameter_mm.len() {
                continue;
            }
            let (i, k) = passage.facet;
            let Some((u, _, _)) = t.across(i, k) else { continue };
            let (a, b) = (voids.by_tetrahedron[i], voids.by_tetrahedron[u]);
            measured.cut += usize::from(passage.cut);
            measured.diameter_mm.push(2.0 * passage.radius * frame.unit_mm);
            measured.centre_mm.push(frame.inside_mm(passage.centre));
            let up = leads_up(&t.at(&positions, i, Shift::ZERO), k);
            measured.upstream.push(if up { a } else { b });
            measured.downstream.push(if up { b } else { a });
        }
        measured
    }

    /// Fills everything but the constrictions.
    fn empty(t: &Triangulation, voids: &Voids, frame: &Frame) -> Self {
        let positions = t.positions();
        let mut void_diameter_mm = vec![0.0; voids.count];
        let mut void_centre_mm = vec![[f64::NAN; 3]; voids.count];
        let mut void_tetrahedra = vec![0; voids.count];
        for (i, (&v, insphere)) in voids.by_tetrahedron.iter().zip(&voids.inspheres).enumerate() {
            let v = v as usize;
            void_tetrahedra[v] += 1;
            match insphere {
                Insphere::Sphere(s) if 2.0 * s.radius * frame.unit_mm > void_diameter_mm[v] => {
                    void_diameter_mm[v] = 2.0 * s.radius * frame.unit_mm;
                    void_centre_mm[v] = frame.inside_mm(s.centre);
                }
                _ if void_centre_mm[v][0].is_nan() => {
                    let corner = t.at(&positions, i, Shift::ZERO)[0];
                    void_centre_mm[v] = frame.inside_mm([corner[0], corner[1], corner[2]]);
                }
                _ => {}
            }
        }
        let count = |wanted: fn(&Insphere) -> bool| {
            voids.inspheres.iter().filter(|insphere| wanted(insphere)).count()
        };
        let mut is_hidden = vec![false; t.grains()];
        t.hidden().iter().for_each(|&g| is_hidden[g as usize] = true);
        let visible = || t.spheres().iter().zip(&is_hidden).filter(|(_, hidden)| !**hidden).map(|(s, _)| s);
        let region = frame.region(t);
        let grains = visible().filter(|s| region.holds(&frame.inside_mm([s[0], s[1], s[2]]))).count();
        let smallest = t.spheres().iter().map(|s| s[3]).fold(f64::INFINITY, f64::min);
        let void_ratio = match t.cell() {
            Some([x, y, z]) => {
                let solid: f64 = visible().map(|s| ball(s[3])).sum();
                (x * y * z - solid) / solid
            }
            None => void_ratio_within(t, &positions, frame, &region),
        };
        Self {
            diameter_mm: Vec::new(),
            centre_mm: Vec::new(),
            upstream: Vec::new(),
            downstream: Vec::new(),
            void_diameter_mm,
            void_centre_mm,
            void_tetrahedra,
            closed: 0,
            cut: 0,
            open_tetrahedra: count(|insphere| matches!(insphere, Insphere::Open)),
            flat_tetrahedra: count(|insphere| matches!(insphere, Insphere::Flat)),
            tetrahedra: t.tetrahedra(),
            hidden: t.hidden().to_vec(),
            duplicates: duplicates(t, &positions),
            near: near(t, &positions),
            is_surrounded: is_surrounded(t, &positions),
            void_ratio,
            d0_mm: 2.0 * smallest * frame.unit_mm,
            merge_overlap: 0.0,
            counted: Facets::All,
            region,
            grains,
        }
    }

    /// Number of grains that statistics are taken over.
    pub fn grains(&self) -> usize {
        self.grains
    }

    /// Number of voids that statistics are taken over.
    pub fn voids(&self) -> usize {
        self.void_centre_mm.iter().filter(|centre| self.region.holds(centre)).count()
    }

    /// Number of constrictions used for statistics.
    pub fn constrictions(&self) -> usize {
        self.centre_mm.iter().filter(|centre| self.region.holds(centre)).count()
    }

    /// Grains per void, N_p / N_voids of the paper's Eq. (2).
    pub fn grains_per_void(&self) -> f64 {
        self.grains as f64 / self.voids() as f64
    }

    /// Voids by number of their constrictions: entry `n` counts those with `n`.
    pub fn connectivity(&self) -> Vec<usize> {
        let mut of_void = vec![0usize; self.void_centre_mm.len()];
        for &v in self.upstream.iter().chain(&self.downstream) {
            of_void[v as usize] += 1;
        }
        let mut counts = Vec::new();
        for (n, centre) in of_void.into_iter().zip(&self.void_centre_mm) {
            if self.region.holds(centre) {
                if counts.len() <= n {
                    counts.resize(n + 1, 0);
                }
                counts[n] += 1;
            }
        }
        counts
    }

    /// Mean number of constrictions of a void.
    pub fn mean_connectivity(&self) -> f64 {
        let counts = self.connectivity();
        let ends: usize = counts.iter().enumerate().map(|(n, voids)| n * voids).sum();
        ends as f64 / counts.iter().sum::<usize>() as f64
    }

    /// Curve by number (mm): constriction `i` of `n` in ascending order at `i / (n - 1)`, so that D_c0 and
    /// D_c100 are the smallest and the largest.
    ///
    /// # Errors
    /// A packing without constrictions, or with sizes that are invalid in a [`Curve`].
    pub fn curve(&self) -> Result<Curve, CurveError> {
        let mut sizes: Vec<f64> = (self.diameter_mm.iter().zip(&self.centre_mm))
            .filter(|(_, centre)| self.region.holds(centre))
            .map(|(&diameter, _)| diameter)
            .collect();
        if sizes.is_empty() {
            return Err(CurveError::NoConstriction { tetrahedra: self.tetrahedra, voids: self.voids() });
        }
        sizes.sort_unstable_by(f64::total_cmp);
        let last = (sizes.len().max(2) - 1) as f64;
        let mut points: Vec<(f64, f64)> =
            sizes.iter().enumerate().map(|(i, &size)| (100.0 * i as f64 / last, size)).collect();
        if let [only] = points[..] {
            points.push((100.0, only.1));
        }
        Curve::from_points(&points, CurveUnit::Mm)
    }
}

/// Tells if the facet opposite a corner leads from its tetrahedron towards higher z.
fn leads_up(corners: &[GrainPoint; 4], corner: usize) -> bool {
    let facet = [1, 2, 3].map(|k| corners[(corner + k) % 4]);
    let edge = |k: usize| -> [f64; 2] { [facet[k][0] - facet[0][0], facet[k][1] - facet[0][1]] };
    let normal_z = edge(1)[0] * edge(2)[1] - edge(1)[1] * edge(2)[0];
    // Positive orientation: the other corners turn one way for even corners, the other way for odd.
    if corner.is_multiple_of(2) { normal_z > 0.0 } else { normal_z < 0.0 }
}

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius
}
