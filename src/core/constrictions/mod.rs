//! Constrictions: the narrowest openings between the voids of a filter, and their sizes by number.
//!
//! ```text
//! Packing -> Triangulation -> voids, discs -> Constrictions -> Curve
//! ```
//! [`from_library()`] gets a curve from packings made earlier, and [`inscribed()`] estimates one from
//! the gradation alone.

mod curve;
mod discs;
mod graph;
mod inscribed;
#[cfg(test)]
mod lattice_tests;
mod library;
mod shipped;
mod summary;
mod triangulation;
mod voids;

pub use curve::{Curve, CurveError, CurveUnit};
pub use graph::VoidGraph;
pub use inscribed::inscribed;
pub use library::{FromLibrary, from_library};
pub use shipped::{ShippedFilter, find, shipped};
pub use summary::{Doubt, Summary};
pub use triangulation::{Triangulation, TriangulationError};

use crate::packing::Packing;
use discs::{ConstrictionDisc, disc};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use triangulation::{GrainPoint, Shift, facet};
use voids::{Insphere, NEAR, Region, SAME_GRAIN, Voids, is_surrounded, nearer, void_ratio_within};

/// Difference of centre and radius, relative to the radius, within which two discs between the same
/// voids are one (four grains on one circle, up to a jitter of 1e-6 of a grain).
const SAME_DISC: f64 = 1e-4;

/// Default overlap from which two tetrahedra share a void.
pub const DEFAULT_MERGE_OVERLAP: f64 = 0.1;

/// Selection of the facets between two voids that count as constrictions.
///
/// The published program of the paper's author (T. Shire, *Weighted-Delaunay-Constrictions*, GitHub,
/// after Reboul et al.) does not count every facet between two voids: it takes the convex hull of the
/// grains of each void and counts a triangle that lies on two such hulls. With its overlap of 0.5 this
/// gives, on packings of Cu 1.5 and Cu 3, the same curve within 1 % from Dc5 to Dc75 as all facets with
/// an overlap of 0.1 (`results/packing.md`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum Facets {
    /// Every facet between two voids.
    #[default]
    All,
    /// Facets on the convex hulls of the grain centres of both voids.
    OnBothHulls,
}

/// The constrictions of a packing, the voids between them, and the quantities needed to judge a filter.
///
/// Constriction `c` is entry `c` of the constriction columns, void `v` entry `v` of the void columns.
/// Constrictions are in the order of their tetrahedra, which depends on the packing only. The columns of
/// a free packing contain everything; its statistics leave out the outer 5 %.
///
/// ```
/// use voidwalk_core::constrictions::Constrictions;
/// use voidwalk_core::packing::{Cell, Packing};
/// // Simple cubic: 3 x 3 x 3 touching grains of 1 mm.
/// let grains = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9, 1].map(f64::from));
/// let packing = Packing::from_grains(Cell::Periodic([3.0; 3]), grains);
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
    /// Number of facets between voids that are closed by grains.
    pub(crate) closed: usize,
    /// Number of constrictions whose disc was made smaller by a fourth grain.
    pub(crate) cut: usize,
    pub(crate) tetrahedra: usize,
    /// Grains inside others, ascending; they are ignored.
    pub(crate) hidden: Vec<u32>,
    /// Pairs of grains with the same centre, to a thousandth of the smaller diameter.
    pub(crate) duplicates: Vec<[u32; 2]>,
    /// Pairs of grains nearer than a quarter of the smaller diameter.
    pub(crate) near: Vec<[u32; 2]>,
    /// Volume of voids over volume of grains (overlaps counted twice).
    pub(crate) void_ratio: f64,
    pub(crate) d0_mm: f64,
    pub(crate) merge_overlap: f64,
    pub(crate) counted: Facets,
    region: Region,
    /// Number of grains in the region, without hidden ones.
    grains: usize,
    is_surrounded: bool,
}

/// Reasons why a packing's constrictions cannot be measured.
#[allow(missing_docs)]
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum ConstrictionsError {
    /// The packing has no triangulation.
    #[error(transparent)]
    Triangulation(#[from] TriangulationError),
    /// The grains have no periodic cell, which the graph of their voids needs.
    #[error("the grains have no periodic cell, and the graph of their voids needs one")]
    NoCell,
    /// A void meets itself on the other side of the cell.
    #[error(
        "void {0} runs through the whole cell and meets itself: no path through the graph is known. Merge \
         less (merge_overlap = {1} now), or take more grains"
    )]
    Endless(u32, f64),
    /// Grains inside others, as grains side by side appear to be in a cell of the wrong size or unit.
    #[error(
        "the grains do not fit their cell: {hidden} of {grains} lie inside others, the first of them grain \
         {first} (counted from 0). The cell is too small, or in another unit than the grains, or grains \
         occur twice in the file"
    )]
    Hidden { hidden: usize, grains: usize, first: u32 },
    /// Grains that occur twice: the number of such pairs, and the first pair.
    #[error(
        "{0} pairs of grains have the same centre, the first of them grains {one} and {other} (counted from \
         0); leave out the duplicates",
        one = .1[0], other = .1[1]
    )]
    Twice(usize, [u32; 2]),
    /// The grains leave no voids: the void ratio is 0 or less.
    #[error(
        "the void ratio is {0:.4}: the grains have more volume than the space that contains them. \
         Diameters may be in another unit than centres, or radii be read as diameters"
    )]
    Full(f64),
    /// No grain is surrounded by others.
    #[error(
        "no grain is surrounded by others: the grains are a layer, a heap or a row, and their voids are \
         open outwards. Take a block of at least three grains along each axis, or give its periodic cell"
    )]
    Outside,
    /// An invalid merge overlap.
    #[error("merge_overlap = {0} is not allowed; allowed: a finite number from 0")]
    MergeOverlap(f64),
}

/// An open facet between two voids, and the constriction of which it is all or a part.
struct Passage {
    /// Tetrahedron with the lower index, and its corner opposite the facet.
    facet: (usize, usize),
    /// Tetrahedron on the other side, and the shift of its stored translate.
    across: (usize, Shift),
    /// Index of its constriction; a new one is numbered one above those of earlier facets.
    constriction: usize,
    disc: ConstrictionDisc,
}

/// The voids of a triangulation and the facets between them.
struct Passages {
    voids: Voids,
    counted: Facets,
    open: Vec<Passage>,
    /// Diameter and centre (mm) of each constriction.
    constrictions: Vec<(f64, [f64; 3])>,
    /// Number of facets closed by grains.
    closed: usize,
}

impl Passages {
    /// Finds the voids, and the `counted` facets between them.
    ///
    /// # Errors
    /// A `merge_overlap` that is negative or not finite.
    fn find(t: &Triangulation, merge_overlap: f64, counted: Facets) -> Result<Self, ConstrictionsError> {
        if !(merge_overlap.is_finite() && merge_overlap >= 0.0) {
            return Err(ConstrictionsError::MergeOverlap(merge_overlap));
        }
        let voids = Voids::merge(t, merge_overlap);
        let void_of = &voids.by_tetrahedron;
        let counts = |i: usize, k: usize| {
            // Each facet is visited from the tetrahedron with the lower index.
            t.across(i, k).is_some_and(|(u, j, _)| {
                u > i
                    && void_of[u] != void_of[i]
                    && (counted == Facets::All || voids.on_hull(t, i, k) && voids.on_hull(t, u, j))
            })
        };
        let facets: Vec<(usize, usize)> = (0..t.tetrahedra())
            .into_par_iter()
            .with_min_len(256)
            .flat_map_iter(|i| (0..4).map(move |k| (i, k)))
            .filter(|&(i, k)| counts(i, k))
            .collect();
        let discs: Vec<ConstrictionDisc> =
            facets.par_iter().with_min_len(256).map(|&(i, k)| disc(t, i, k)).collect();
        let (mut open, mut closed) = (Vec::new(), 0);
        let mut constrictions: Vec<(f64, [f64; 3])> = Vec::new();
        let mut between: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
        for (facet, disc) in facets.into_iter().zip(discs) {
            let Some((u, _, shift)) = t.across(facet.0, facet.1) else { continue };
            if disc.radius <= 0.0 {
                closed += 1;
                continue;
            }
            let (centre, diameter) = (t.inside_mm(disc.centre), 2.0 * disc.radius * t.unit_mm());
            let (a, b) = (void_of[facet.0], void_of[u]);
            let seen = between.entry((a.min(b), a.max(b))).or_default();
            let same = |&&c: &&usize| {
                (constrictions[c].0 - diameter).abs() <= SAME_DISC * diameter
                    && t.distance_mm(&constrictions[c].1, &centre) <= SAME_DISC * diameter
            };
            let constriction = match seen.iter().find(same) {
                Some(&known) => known,
                None => {
                    seen.push(constrictions.len());
                    constrictions.push((diameter, centre));
                    constrictions.len() - 1
                }
            };
            open.push(Passage { facet, across: (u, shift), constriction, disc });
        }
        Ok(Self { voids, counted, open, constrictions, closed })
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
        Ok(Self::between(t, &Passages::find(t, merge_overlap, counted)?))
    }

    /// Measures the facets between the voids of a triangulation.
    fn between(t: &Triangulation, passages: &Passages) -> Self {
        let (voids, unit_mm) = (&passages.voids, t.unit_mm());
        let mut void_diameter_mm = vec![0.0; voids.count];
        let mut void_centre_mm = vec![[f64::NAN; 3]; voids.count];
        for (i, (&v, insphere)) in voids.by_tetrahedron.iter().zip(&voids.inspheres).enumerate() {
            let v = v as usize;
            match insphere {
                Insphere::Sphere(s) if 2.0 * s.radius * unit_mm > void_diameter_mm[v] => {
                    void_diameter_mm[v] = 2.0 * s.radius * unit_mm;
                    void_centre_mm[v] = t.inside_mm(s.centre);
                }
                _ if void_centre_mm[v][0].is_nan() => {
                    let [x, y, z, _] = t.stored(i)[0];
                    void_centre_mm[v] = t.inside_mm([x, y, z]);
                }
                _ => {}
            }
        }
        let region = Region::new(t);
        let void_ratio = match t.cell() {
            Some([x, y, z]) => {
                let solid: f64 = t.visible().map(|s| ball(s[3])).sum();
                (x * y * z - solid) / solid
            }
            None => void_ratio_within(t, &region),
        };
        let (diameter_mm, centre_mm) = passages.constrictions.iter().copied().unzip();
        let mut measured = Self {
            diameter_mm,
            centre_mm,
            upstream: Vec::new(),
            downstream: Vec::new(),
            void_diameter_mm,
            void_centre_mm,
            closed: passages.closed,
            cut: 0,
            tetrahedra: t.tetrahedra(),
            hidden: t.hidden().to_vec(),
            duplicates: nearer(SAME_GRAIN, t, t.duplicates().to_vec()),
            near: nearer(NEAR, t, Vec::new()),
            is_surrounded: is_surrounded(t),
            void_ratio,
            d0_mm: 2.0 * t.least_radius() * unit_mm,
            merge_overlap: voids.merge_overlap,
            counted: passages.counted,
            grains: t.visible().filter(|s| region.holds(&t.inside_mm([s[0], s[1], s[2]]))).count(),
            region,
        };
        for passage in &passages.open {
            if passage.constriction < measured.upstream.len() {
                continue;
            }
            let (i, k) = passage.facet;
            let (a, b) = (voids.by_tetrahedron[i], voids.by_tetrahedron[passage.across.0]);
            measured.cut += usize::from(passage.disc.cut);
            let (low, high) = if leads_up(&t.stored(i), k) { (a, b) } else { (b, a) };
            measured.upstream.push(low);
            measured.downstream.push(high);
        }
        measured
    }

    /// Number of voids used for statistics.
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

    /// Number of voids by number of constrictions: entry `n` counts those with `n`.
    pub(crate) fn connectivity(&self) -> Vec<usize> {
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

    /// Mean number of constrictions per void.
    pub(crate) fn mean_connectivity(&self) -> f64 {
        let counts = self.connectivity();
        let ends: usize = counts.iter().enumerate().map(|(n, voids)| n * voids).sum();
        ends as f64 / counts.iter().sum::<usize>() as f64
    }

    /// Returns the curve by number (mm): constriction `i` of `n`, in ascending order, is at
    /// `i / (n - 1)`, so that D_c0 and D_c100 are the smallest and the largest.
    ///
    /// # Errors
    /// A packing without constrictions, or sizes that are not allowed in a [`Curve`].
    pub fn curve(&self) -> Result<Curve, CurveError> {
        let mut sizes: Vec<f64> = (self.diameter_mm.iter().zip(&self.centre_mm))
            .filter(|(_, centre)| self.region.holds(centre))
            .map(|(&diameter, _)| diameter)
            .collect();
        if sizes.is_empty() {
            return Err(CurveError::NoConstriction(self.tetrahedra, self.voids()));
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
    let facet = facet(corners, corner);
    let edge = |k: usize| -> [f64; 2] { [facet[k][0] - facet[0][0], facet[k][1] - facet[0][1]] };
    let normal_z = edge(1)[0] * edge(2)[1] - edge(1)[1] * edge(2)[0];
    // Positive orientation: the other corners turn one way for even corners, the opposite way for odd ones.
    if corner.is_multiple_of(2) { normal_z > 0.0 } else { normal_z < 0.0 }
}

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius
}
