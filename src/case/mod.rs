//! A case: a scene with its files read and every number worked out, before any work is done.

mod arching;
mod curve_ends;
mod cut;
mod error;
mod files;
mod input;
mod left_out;
mod library_filter;
mod memory;
mod network_key;
mod notes;
mod packed_filter;
mod packing_plan;
mod pan;
mod places;
mod recipe;
mod record;
mod regrade;
mod resolved;
mod scaled;
mod sensitivity;
mod sizes;
mod supply;
mod thickness;
mod void_graph;

pub use curve_ends::{OtherCurve, end_of_guess};
pub use error::CaseError;
use files::Files;
pub use files::{INPUT_FILES, INPUT_NAMES};
pub use input::Input;
pub use library_filter::LibraryFilter;
pub use memory::{ResourceLimits, in_words};
use packed_filter::GUESSED_GRAINS_PER_VOID;
pub use packed_filter::{GRAINS, PackedError, PackedFilter, RECORD};
pub use packing_plan::PackingPlan;
pub use record::base_record;
pub use scaled::StatedBase;
use supply::Against;
pub use supply::PAPER_MASS_RATIO;
use void_graph::GraphPacking;

use crate::constrictions::{Curve, CurveUnit, ShippedFilter, inscribed};
use crate::gradation::{Gradation, SizeSampler};
use crate::network::{CONDUCTANCE_EXPONENT, ExitRule, Network, NetworkError, WIDE};
use crate::outcome::record::Ratios;
use crate::scene::{
    Amount, BaseGradation, D85, Extent, FilterGradation, LibraryDensity, NetworkSource, Scene, USUAL_LAYERS,
};
use crate::store::Placement;
use crate::stream::{Key, Purpose};
use crate::verdict::{Mistake, MistakeKind};
use rand::Rng;
use std::borrow::Cow;
use std::sync::Arc;

/// Seed of replicate `replicate`, counted from 1: a function of the user's seed and the replicate alone.
pub fn replicate_seed(seed: u64, replicate: u64) -> u64 {
    Key { seed, purpose: Purpose::Replicate, run: 0, increment: 0, chunk: replicate }.generator().next_u64()
}

/// A scene, worked out.
///
/// ```
/// use voidwalk::{Case, Scene};
/// let case = Case::new(Scene::built_in(&["base.cu=3".to_owned()])?)?;
/// // D85 of the base is the Dc5 of the filter, and Eq. (2) says how many particles there are.
/// assert!((case.base.d(85.0).unwrap() / case.curve.dc(5.0).unwrap() - 1.0).abs() < 1e-9);
/// assert_eq!(Some(case.n_base), case.n_base_eq2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Case {
    /// The scene it comes from.
    pub scene: Scene,
    /// The filter's gradation.
    pub filter: Gradation,
    /// The filter's constriction curve (mm).
    pub curve: Curve,
    /// The finest constriction (mm) of every curve that is walked, the ends of its range included: what is
    /// finer blocks nothing in any of them.
    pub finest_mm: f64,
    /// The other curves that are walked besides its own: the ends of the range in which it is known.
    pub curve_ends: Vec<OtherCurve>,
    /// What the library of packings says of the filter, where its curve is taken from there.
    pub library: Option<LibraryFilter>,
    /// Relative density, 0 loose to 1 dense, of a curve that is guessed from the gradation.
    pub guessed_density: Option<f64>,
    /// The shipped filter that the curve is, if it is one.
    pub shipped: Option<&'static ShippedFilter>,
    /// The packing that the curve was measured on, if the program made it.
    pub packed: Option<PackedFilter>,
    /// The base's gradation, as it is walked.
    pub base: Gradation,
    /// The base as it was given, and the size (mm) that it was regraded on, where it is walked regraded.
    pub regraded_from: Option<(Gradation, f64)>,
    /// Its pan fraction is walked as particles just finer than every constriction, not counted by mass only.
    pub pan_is_walked: bool,
    /// Draws the base's sizes, in units of `unit_mm`.
    pub sampler: SizeSampler,
    /// Base particles of a run, by Eq. (2) or as given.
    pub n_base: u64,
    /// Base particles by Eq. (2); `None` where the grains per void are not given.
    pub n_base_eq2: Option<u64>,
    /// Whether a cap made `n_base` smaller than Eq. (2).
    pub capped: bool,
    /// Filter grains per void, where given.
    pub grains_per_void: Option<f64>,
    /// Mass of base over mass of filter that `n_base` stands for; `None` where the grains per void are not
    /// given.
    pub mass_ratio: Option<f64>,
    /// The reference length: the smallest filter grain (mm).
    pub unit_mm: f64,
    /// The network, where all replicates walk the same: from a file, or the voids of a packing.
    pub fixed_network: Option<Network>,
    /// Its finest constriction, in units of `unit_mm`.
    finest_of_fixed: Option<f32>,
    /// Copies of a packing whose voids are the network, and their thickness together (mm).
    pub copies: Option<(u32, f64)>,
    /// What was measured on the packing whose voids are the network.
    graph: Option<Arc<GraphPacking>>,
    /// Voids, constrictions (of the first replicate), start nodes, layers.
    pub counts: [u64; 4],
    /// Connectivity and percent of the voids, where not all voids have the same.
    pub connectivity: Vec<[f64; 2]>,
    /// Files that were read.
    pub inputs: Vec<Input>,
    /// Memory that the walks may take (bytes): no limit until [`Case::place`] sets one.
    pub memory: u64,
    /// Where the columns of the particles live.
    pub placement: Placement,
}

impl Case {
    /// Reads the scene's files and works out every number; does no other work.
    ///
    /// # Errors
    /// A file that is refused, or numbers that clash.
    pub fn new(scene: Scene) -> Result<Self, CaseError> {
        Self::with_packed(scene, None)
    }

    /// The same for a scene whose filter has been packed.
    ///
    /// # Errors
    /// As [`Case::new`]; the scene's filter is to be packed and has not been.
    pub fn with_packed(scene: Scene, packed: Option<PackedFilter>) -> Result<Self, CaseError> {
        Self::with_graph(scene, packed, None)
    }

    /// The same with the voids of its packing, where they have been measured.
    fn with_graph(
        mut scene: Scene,
        packed: Option<PackedFilter>,
        measured: Option<Arc<GraphPacking>>,
    ) -> Result<Self, CaseError> {
        let packed = match (&scene.filter.measured, scene.filter.grains_per_void) {
            (Some(curve), Some(grains_per_void)) => Some(PackedFilter::kept(curve, grains_per_void)?),
            _ => packed,
        };
        let mut files = Files::default();
        let graph = match (measured, scene.network.source()) {
            (None, NetworkSource::Graph(file, _)) => {
                GraphPacking::read(&scene, file.as_ref(), packed.as_ref(), &mut files)?.map(Arc::new)
            }
            (measured, _) => measured,
        };
        let curve = match (&scene.filter.curve, &packed) {
            (_, Some(packed)) => Some((files.packed(packed)?, None)),
            (Some(source), None) => {
                Some(files.curve(source, "filter.curve", "filter-curve.csv", &scene.name)?)
            }
            (None, None) if scene.packing.is_some() => {
                return Err(CaseError::NotPacked { file: scene.name.clone() });
            }
            (None, None) => graph.as_ref().map(|graph| (graph.curve.clone(), None)),
        };
        let shipped = curve.as_ref().and_then(|(_, shipped)| *shipped);
        let filter = match &scene.filter.gradation() {
            FilterGradation::Linear { cu: None, .. } if shipped.is_none() && graph.is_some() => {
                graph.as_ref().expect("just seen").gradation.clone()
            }
            FilterGradation::Linear { d0_mm, cu } => {
                let cu = cu.or(shipped.map(|s| s.cu)).ok_or_else(|| {
                    scene.clash(
                        "filter.cu or filter.sieve is missing: this constriction curve does not say \
                     its filter's gradation",
                    )
                })?;
                Gradation::linear_from_d0(*d0_mm, cu)?
            }
            FilterGradation::Sieve(path, d0_mm) => {
                files.sieve(path, *d0_mm, "filter.sieve", "filter-sieve.csv", &scene.name)?
            }
        };
        let library = match scene.filter.library {
            Some(density) => LibraryFilter::find(&filter, density)?,
            None => None,
        };
        let of_library = scene.filter.library.filter(|_| library.is_none());
        let guessed_density = scene.filter.estimate.or(of_library.map(LibraryDensity::relative));
        let curve = match (&library, guessed_density) {
            (Some(library), _) => Some((library.found.curve.clone(), None)),
            (None, Some(density)) => Some((inscribed(&filter, density)?, None)),
            (None, None) => curve,
        };
        let unit_mm = filter.smallest_mm();
        let d50f_mm = filter.d(50.0).unwrap_or(unit_mm);
        let (mut fixed_network, mut copies) = (None, None);
        match (&scene.network.source(), &graph) {
            (NetworkSource::File(path), _) => fixed_network = Some(files.network(path, &scene, unit_mm)?),
            (NetworkSource::Graph(_, extent), Some(graph)) => {
                let count = graph.copies(*extent, d50f_mm);
                copies = Some((count, f64::from(count) * graph.graph.cell_mm[2]));
                fixed_network = Some(graph.network(&scene, count, unit_mm)?);
            }
            (NetworkSource::Cubic(_), _) => {
                if let Some(mm) = scene.network.extent().thickness_mm(d50f_mm) {
                    let layer = filter.d_by_number(50.0).unwrap_or(unit_mm);
                    let layers = (mm / layer).round();
                    if layers < 1.0 {
                        let problem = format!(
                            "the network is to be {mm:.4} mm thick, but one layer of voids, D50F by number, \
                             is {layer:.4} mm: allowed: half a layer or more (network.thickness_mm, \
                             network.thickness_d50f)"
                        );
                        return Err(scene.clash(problem).into());
                    }
                    scene.network.set_layers(layers.min(f64::from(u32::MAX)) as u64);
                }
            }
            _ => {}
        }
        let curve = match (fixed_network.as_ref().filter(|_| graph.is_none()), curve) {
            (Some(network), _) => curve_of(network)?,
            (None, Some((curve, _))) => {
                if curve.unit() == CurveUnit::D0f && filter.pan_fraction() > 0.0 {
                    let problem = "this constriction curve is in units of D0F, but the filter's finest \
                     sieve leaves a pan fraction (finer than that sieve): give filter.d0_mm";
                    return Err(scene.clash(problem).into());
                }
                curve.in_mm(unit_mm)?
            }
            (None, None) => return Err(scene.clash("filter.curve is missing").into()),
        };
        let base = base_gradation(&scene, &filter, &curve, unit_mm, &mut files)?;
        let (base, regraded_from) = regrade::walked(&scene, base)?;
        // A sieve table alone can be in another unit, or the filter's.
        let mistake = match scene.base.gradation() {
            BaseGradation::Sieve(..) => {
                let as_given = regraded_from.as_ref().map_or(&base, |(given, _)| given);
                Mistake::find(as_given, &filter, false)
            }
            _ => None,
        };
        if let Some(mistake) = mistake.as_ref().filter(|mistake| mistake.kind == MistakeKind::Unit) {
            return Err(scene.clash(&mistake.sentence).into());
        }
        let (counts, connectivity) = match (&fixed_network, &scene.network.source()) {
            // Exits that are passed both ways are no connectivity of the paper's kind.
            (Some(n), _) if graph.is_some() || n.reservoir().is_some() => (sizes::of_network(n), Vec::new()),
            (Some(n), _) => (sizes::of_network(n), sizes::connectivity_of(n)),
            (None, NetworkSource::Connected(shape, wanted)) => {
                sizes::of_connected(*shape, wanted, &curve, unit_mm, replicate_seed(scene.walk.seed, 1))?
            }
            (None, source) => {
                let shape = source.shape().unwrap_or_else(|| placeholder_shape(&scene, &filter));
                (sizes::of_lattice(shape)?, Vec::new())
            }
        };
        // The grains per void of a shipped packing say nothing of a network from elsewhere.
        let of_shipped = shipped.filter(|_| fixed_network.is_none()).map(|s| s.grains_per_void);
        let of_graph = graph.as_ref().map(|graph| graph.grains_per_void(&filter));
        let of_packing = packed.as_ref().map(|packed| packed.grains_per_void).or(of_shipped);
        let of_library = library.as_ref().map(|library| library.found.grains_per_void);
        let guessed = needs_grains_per_void(&scene, guessed_density).then_some(GUESSED_GRAINS_PER_VOID);
        let known = scene.filter.grains_per_void.or(of_graph).or(of_packing).or(of_library);
        let grains_per_void = known.or(guessed);
        let curve_ends = match (&fixed_network, &library) {
            (Some(_), _) => Vec::new(),
            (None, Some(library)) => library.ends.clone(),
            (None, None) => {
                let part = packed.as_ref().and_then(|of| of.part.as_ref());
                curve_ends::of(&curve, &filter, part, guessed_density)
            }
        };
        let finest_mm = curve_ends.iter().map(|end| end.curve.smallest()).fold(curve.smallest(), f64::min);
        let against = Against {
            scene: &scene,
            filter: &filter,
            finest_mm,
            unit_mm,
            grains_per_void,
            voids: counts[0],
            is_packed: packed.as_ref().is_some_and(|packed| packed.files.is_some()),
        };
        let walked = against.walked(&base).map_err(|error| match mistake {
            Some(mistake) => CaseError::from(scene.clash(mistake.sentence)),
            None => error,
        })?;
        for (name, gradation, percent) in [("filter", &filter, 15.0), ("base", &base, 85.0)] {
            if gradation.d(percent).is_none() {
                let problem = format!(
                    "the {name}'s D{percent} lies in the pan fraction (finer than the finest sieve): add \
                     finer sieves, or {name}.d0_mm"
                );
                return Err(scene.clash(problem).into());
            }
        }
        let case = Self {
            packed,
            filter,
            curve,
            finest_mm,
            curve_ends,
            library,
            guessed_density,
            shipped,
            base,
            regraded_from,
            pan_is_walked: walked.pan_is_walked,
            n_base_eq2: walked.n_base_eq2(),
            sampler: walked.sampler,
            n_base: walked.n_base.n_base,
            capped: walked.n_base.capped,
            grains_per_void,
            mass_ratio: walked.mass_ratio,
            unit_mm,
            finest_of_fixed: fixed_network.as_ref().map(|network| network.finest_open(|_| false)),
            fixed_network,
            copies,
            graph,
            counts,
            connectivity,
            inputs: files.0,
            memory: u64::MAX,
            placement: Placement::Memory,
            scene,
        };
        case.check_clogging()?;
        Ok(case)
    }

    /// The base as it was given, before any regrading.
    pub fn base_as_given(&self) -> &Gradation {
        self.regraded_from.as_ref().map_or(&self.base, |(given, _)| given)
    }

    /// Share of the base's mass that is passive and counted by mass only.
    pub fn pan_by_mass_only(&self) -> f64 {
        if self.pan_is_walked { 0.0 } else { self.base.pan_fraction() }
    }

    /// The base with all particles that are walked.
    pub fn base_as_walked(&self) -> Cow<'_, Gradation> {
        match self.pan_is_walked {
            true => {
                Cow::Owned(pan::as_passive(&self.base, self.finest_mm, &self.scene).expect("it was sampled"))
            }
            false => Cow::Borrowed(&self.base),
        }
    }

    /// The network of the replicate with this seed.
    ///
    /// # Errors
    /// None that [`Case::new`] has not found.
    pub fn network(&self, seed: u64) -> Result<Network, NetworkError> {
        let shape = self.scene.network.source().shape().unwrap_or_default();
        match (&self.fixed_network, &self.scene.network.source()) {
            (None, NetworkSource::Cubic(_)) => {
                self.with_directions(Network::cubic(shape, &self.curve, self.unit_mm, seed)?)
            }
            // A packing that is still to be made.
            (None, NetworkSource::Graph(..)) => {
                let shape = placeholder_shape(&self.scene, &self.filter);
                self.with_directions(Network::cubic(shape, &self.curve, self.unit_mm, seed)?)
            }
            (None, NetworkSource::Connected(_, wanted)) => {
                Network::connected(shape, &self.curve, self.unit_mm, seed, wanted)
            }
            (file, _) => Ok(file.clone().expect("a network from a file was read")),
        }
    }

    /// A lattice as its exit rule wants it: without directions where water gives them.
    fn with_directions(&self, lattice: Network) -> Result<Network, NetworkError> {
        let (rule, exits) = (self.scene.exit_rule(), &self.scene.exits);
        if rule == ExitRule::Area {
            return Ok(lattice);
        }
        let exponent = exits.conductance_exponent.unwrap_or(CONDUCTANCE_EXPONENT);
        lattice.undirected_lattice(rule, exits.rho.unwrap_or(0.0), exponent)
    }

    /// Increments over which the base is inserted: a whole number, so that every part is equal.
    pub fn increments(&self) -> u64 {
        (1.0 / self.scene.walk.inject_share).round().max(1.0) as u64
    }

    /// Constriction curves that are walked: its own, and the ends of its range.
    pub fn curves(&self) -> usize {
        1 + self.curve_ends.len()
    }

    /// D15F over D85B and D95B.
    pub fn ratios(&self) -> Ratios {
        let d = |gradation: &Gradation, percent| gradation.d(percent).unwrap_or(f64::NAN);
        let d15f = d(&self.filter, 15.0);
        Ratios { d15f_over_d85b: d15f / d(&self.base, 85.0), d15f_over_d95b: d15f / d(&self.base, 95.0) }
    }
}

/// Whether Eq. (2) needs grains per void that nobody gives: where the constrictions are a guess.
fn needs_grains_per_void(scene: &Scene, guessed_density: Option<f64>) -> bool {
    guessed_density.is_some()
        && scene.filter.grains_per_void.is_none()
        && matches!(scene.base.amount(), Amount::MassRatio(..))
}

/// A lattice about as large as the graph of a packing that is still to be made.
fn placeholder_shape(scene: &Scene, filter: &Gradation) -> [u32; 3] {
    let grains = scene.packing.as_ref().and_then(|packing| packing.filter.grains).unwrap_or(9_000);
    let across = libm::cbrt(grains as f64 / GUESSED_GRAINS_PER_VOID).ceil().clamp(1.0, 1000.0) as u32;
    let along = match scene.network.extent() {
        Extent::Copies(copies) => copies.saturating_mul(across).min(1_000_000),
        extent => {
            let layer = filter.d_by_number(50.0).unwrap_or(filter.smallest_mm());
            let thickness = extent.thickness_mm(filter.d(50.0).unwrap_or(layer));
            thickness.map_or(USUAL_LAYERS as u32, |mm| (mm / layer).ceil().clamp(1.0, 1e6) as u32)
        }
    };
    [across, across, along]
}

/// The constriction curve of a given network (mm): its open diameters by number, at most a thousand points.
fn curve_of(network: &Network) -> Result<Curve, CaseError> {
    let mut sizes: Vec<f64> = network
        .diameters()
        .iter()
        .filter(|&&d| d > 0.0 && d != WIDE)
        .map(|&d| f64::from(d) * network.unit_mm())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let Some(last) = sizes.len().checked_sub(1) else {
        return Ok(Curve::from_points(&[(100.0, network.unit_mm())], CurveUnit::Mm)?);
    };
    let steps = last.clamp(1, 1000);
    let point = |k: usize| (100.0 * k as f64 / steps as f64, sizes[last * k / steps]);
    Ok(Curve::from_points(&(0..=steps).map(point).collect::<Vec<_>>(), CurveUnit::Mm)?)
}

fn base_gradation(
    scene: &Scene,
    filter: &Gradation,
    curve: &Curve,
    unit_mm: f64,
    files: &mut Files,
) -> Result<Gradation, CaseError> {
    let (cu, d85_mm) = match &scene.base.gradation() {
        BaseGradation::Sieve(path, d0_mm) => {
            return files.sieve(path, *d0_mm, "base.sieve", "base-sieve.csv", &scene.name);
        }
        BaseGradation::Single(size) => return Ok(Gradation::single(*size)?),
        BaseGradation::Linear { cu, d85: D85::Mm(mm) } => (*cu, *mm),
        BaseGradation::Linear { cu, d85: D85::Ratio(ratio) } => {
            let d15f = filter.d(15.0).ok_or_else(|| scene.clash("the filter's D15 is not known"))?;
            (*cu, d15f / ratio)
        }
        BaseGradation::Linear { cu, d85: D85::AtDc(percent, other) } => {
            let other = match other {
                Some(source) => Some(
                    files
                        .curve(source, "base.dc_curve", "base-dc-curve.csv", &scene.name)?
                        .0
                        .in_mm(unit_mm)?,
                ),
                None => None,
            };
            let curve = other.as_ref().unwrap_or(curve);
            (*cu, curve.dc(*percent).ok_or_else(|| scene.clash("base.d85_at_dc is not on the curve"))?)
        }
    };
    Ok(Gradation::linear_from_dx(85.0, d85_mm, cu)?)
}
