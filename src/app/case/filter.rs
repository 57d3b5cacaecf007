//! Filter of a case: as stated by the scene and its files, then its gradation, its constrictions in mm
//! with their possible error, and the network that all replicates walk, if it has one.

use super::error::CaseError;
use super::files::Files;
use super::library_filter::{LibraryFilter, OtherCurve, curve_ends};
use super::packed_filter::{GUESSED_GRAINS_PER_VOID, PackedFilter};
use crate::scene::{
    Amount, BaseGradation, D85, Extent, FilterGradation, LibraryDensity, NetworkSource, Scene, USUAL_LAYERS,
};
use crate::words;
use std::path::PathBuf;
use std::sync::Arc;
use voidwalk_core::constrictions::{
    Curve, CurveUnit, DEFAULT_MERGE_OVERLAP, ShippedFilter, VoidGraph, inscribed,
};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::{GraphShape, Network, WIDE};
use voidwalk_core::packing::Packing;

/// Filter with all its derived values.
#[derive(Clone)]
pub struct CaseFilter {
    pub(crate) gradation: Gradation,
    /// Reference length: the smallest grain (mm).
    pub(crate) unit_mm: f64,
    /// Constriction curve (mm).
    pub curve: Curve,
    /// Further curves that are walked: the ends of the range of its own curve.
    pub(crate) curve_ends: Vec<OtherCurve>,
    /// Finest constriction (mm) of all curves that are walked, including the ends of its range: finer
    /// particles block nothing in any of them.
    pub(crate) finest_mm: f64,
    /// Filter grains per void, known or guessed.
    pub(crate) grains_per_void: Option<f64>,
    /// Shipped filter that the curve comes from, if any.
    pub(crate) shipped: Option<&'static ShippedFilter>,
    /// Packing on which the curve was measured, if made by the program.
    pub(crate) packed: Option<PackedFilter>,
    /// Entry of the library of packings, if the curve comes from there.
    pub(crate) library: Option<LibraryFilter>,
    /// Relative density, from 0 (loose) to 1 (dense), of a curve guessed from the gradation.
    pub(crate) guessed_density: Option<f64>,
}

impl CaseFilter {
    /// Reads the filter that a scene states, and the network of its replicates if they all walk one; `packed`
    /// and `measured` are its packing and that packing's voids, if they already exist. Sets the layers of a
    /// thickness before the curve is built, so that the thickness is refused first.
    pub(super) fn read(
        scene: &mut Scene,
        packed: Option<PackedFilter>,
        measured: Option<Arc<GraphPacking>>,
        files: &mut Files,
    ) -> Result<(Self, Option<FixedNetwork>), CaseError> {
        let packed = match (&scene.filter.measured, scene.filter.grains_per_void) {
            (Some(curve), Some(grains_per_void)) => Some(PackedFilter::kept(curve, grains_per_void)?),
            _ => packed,
        };
        let graph = match (measured, scene.network.source()) {
            (None, NetworkSource::Graph(file, _)) => {
                GraphPacking::read(scene, file.as_ref(), packed.as_ref(), files)?.map(Arc::new)
            }
            (measured, _) => measured,
        };
        let (stated, shipped) = match (&scene.filter.curve, &packed) {
            (_, Some(packed)) => (Some(files.packed(packed)?), None),
            (Some(source), None) => {
                let (curve, shipped) = files.curve(source, "filter.curve", &scene.name)?;
                (Some(curve), shipped)
            }
            (None, None) if scene.packing.is_some() => {
                return Err(CaseError::NotPacked { file: scene.name.clone() });
            }
            (None, None) => (graph.as_ref().map(|graph| graph.curve.clone()), None),
        };
        let gradation = gradation(scene, shipped, graph.as_deref(), files)?;
        let library = match scene.filter.library {
            Some(density) => LibraryFilter::find(&gradation, density)?,
            None => None,
        };
        // The constrictions of a filter are guessed if no library filter is similar.
        let of_library = scene.filter.library.filter(|_| library.is_none());
        let guessed_density = scene.filter.estimate.or(of_library.map(LibraryDensity::relative));
        let stated = match (&library, guessed_density) {
            (Some(library), _) => Some(library.found.curve.clone()),
            (None, Some(density)) => Some(inscribed(&gradation, density)?),
            (None, None) => stated,
        };
        let fixed = FixedNetwork::read(scene, &gradation, graph.as_ref(), files)?;
        set_layers_of_thickness(scene, &gradation)?;
        let unit_mm = gradation.smallest_mm();
        let curve = match (fixed.as_ref().filter(|fixed| fixed.packing.is_none()), stated) {
            (Some(fixed), _) => fixed.curve()?,
            (None, Some(curve)) => {
                if curve.unit() == CurveUnit::D0f && gradation.pan_fraction() > 0.0 {
                    let problem = "this constriction curve is in units of D0F, but the filter's finest \
                     sieve leaves a pan fraction (finer than that sieve): give filter.d0_mm";
                    return Err(scene.clash(problem).into());
                }
                curve.in_mm(unit_mm)?
            }
            (None, None) => return Err(scene.clash("filter.curve is missing").into()),
        };
        let mut curve_ends = match (&fixed, &library) {
            (Some(_), _) => Vec::new(),
            (None, Some(library)) => library.ends.clone(),
            (None, None) => {
                let part = packed.as_ref().and_then(|packed| packed.part.as_ref());
                curve_ends(&curve, &gradation, part, guessed_density)
            }
        };
        if scene.filter.grains_per_void.is_some() {
            // A value stated by the user applies to every curve.
            curve_ends.iter_mut().for_each(|end| end.times_grains = 1.0);
        }
        let finest_mm = curve_ends.iter().map(|end| end.curve.smallest()).fold(curve.smallest(), f64::min);
        // By Eq. (2) the mass of base is a fraction of the mass of a graph's grains.
        let of_graph = graph.map(|graph| {
            let solid = std::f64::consts::FRAC_PI_6 * graph.graph.cubes_mm3;
            solid * gradation.particles_per_unit_volume() / graph.graph.voids() as f64
        });
        // The grains per void of a shipped packing do not apply to a network from another source.
        let of_shipped = shipped.filter(|_| fixed.is_none()).map(|shipped| shipped.grains_per_void);
        let of_packing = packed.as_ref().map(|packed| packed.grains_per_void).or(of_shipped);
        let of_library = library.as_ref().map(|library| library.found.grains_per_void);
        let known = scene.filter.grains_per_void.or(of_graph).or(of_packing).or(of_library);
        let is_guessed = needs_grains_per_void(scene, guessed_density);
        let grains_per_void = known.or(is_guessed.then_some(GUESSED_GRAINS_PER_VOID));
        let filter = Self {
            gradation,
            unit_mm,
            curve,
            curve_ends,
            finest_mm,
            grains_per_void,
            shipped,
            packed,
            library,
            guessed_density,
        };
        Ok((filter, fixed))
    }

    /// True if lengths of a scene are in units of the smallest filter grain, unless a network has a size.
    pub(super) fn is_scale_free(&self, scene: &Scene) -> bool {
        let is_without_packing = self.library.is_some() || self.guessed_density.is_some();
        matches!(scene.filter.gradation(), FilterGradation::Linear { d0_mm, .. } if d0_mm == 1.0)
            && (self.shipped.is_some() || self.packed.is_some() || is_without_packing)
            && matches!(
                scene.base.gradation(),
                BaseGradation::Linear { d85: D85::AtDc(..) | D85::Ratio(_), .. } | BaseGradation::Single(_)
            )
    }

    /// Multiplies all sizes of the filter by `factor`, and keeps only its own curve.
    pub(super) fn enlarged(self, factor: f64) -> Result<Self, CaseError> {
        let gradation = self.gradation.scaled(factor)?;
        Ok(Self {
            unit_mm: gradation.smallest_mm(),
            gradation,
            curve: self.curve.scaled(factor)?,
            curve_ends: Vec::new(),
            finest_mm: factor * self.finest_mm,
            ..self
        })
    }
}

/// True if the constrictions are a guess and Eq. (2) needs grains per void that are not given.
pub(super) fn needs_grains_per_void(scene: &Scene, guessed_density: Option<f64>) -> bool {
    guessed_density.is_some()
        && scene.filter.grains_per_void.is_none()
        && matches!(scene.base.amount(), Amount::MassRatio(..))
}

/// Gradation of the packing or of the shipped filter, unless the scene states one.
fn gradation(
    scene: &Scene,
    shipped: Option<&ShippedFilter>,
    graph: Option<&GraphPacking>,
    files: &mut Files,
) -> Result<Gradation, CaseError> {
    match (&scene.filter.gradation(), graph) {
        (FilterGradation::Linear { cu: None, .. }, Some(graph)) if shipped.is_none() => {
            Ok(graph.gradation.clone())
        }
        (FilterGradation::Linear { d0_mm, cu }, _) => {
            let cu = cu.or(shipped.map(|s| s.cu)).ok_or_else(|| {
                scene.clash(
                    "filter.cu or filter.sieve is missing: this constriction curve does not say \
                     its filter's gradation",
                )
            })?;
            Ok(Gradation::linear_from_d0(*d0_mm, cu)?)
        }
        (FilterGradation::Sieve(path, d0_mm), _) => files.sieve(path, *d0_mm, "filter.sieve", &scene.name),
    }
}

/// Sets the number of layers of a lattice from the scene's thickness and this filter.
fn set_layers_of_thickness(scene: &mut Scene, filter: &Gradation) -> Result<(), CaseError> {
    let (NetworkSource::Cubic(_), extent) = (scene.network.source(), scene.network.extent()) else {
        return Ok(());
    };
    let unit_mm = filter.smallest_mm();
    let Some(mm) = extent.thickness_mm(filter.d(50.0).unwrap_or(unit_mm)) else { return Ok(()) };
    let layer = filter.d_by_number(50.0).unwrap_or(unit_mm);
    let layers = (mm / layer).round();
    if layers < 1.0 {
        let problem = format!(
            "the network is to be {mm:.4} mm thick, but one layer of voids, D50F by number, is {layer:.4} \
             mm: allowed: half a layer or more (network.thickness_mm, network.thickness_d50f)"
        );
        return Err(scene.clash(problem).into());
    }
    scene.network.set_layers(layers.min(f64::from(u32::MAX)) as u64);
    Ok(())
}

/// Network that all replicates walk.
#[derive(Clone)]
pub(crate) struct FixedNetwork {
    pub(crate) network: Network,
    /// Finest constriction, in units of the reference length.
    pub(super) finest: f32,
    /// Packing whose voids form it; `None` for a network from a file.
    pub(crate) packing: Option<CopiedPacking>,
}

/// Packing whose voids form a network, repeated along the flow.
#[derive(Clone)]
pub(crate) struct CopiedPacking {
    pub(crate) copies: u32,
    /// Total thickness of the copies (mm).
    pub(crate) thickness_mm: f64,
    pub(super) graph: Arc<GraphPacking>,
}

impl FixedNetwork {
    /// Reads the network of a scene; `None` if each replicate builds its own, or if the packing does not
    /// exist yet.
    fn read(
        scene: &Scene,
        filter: &Gradation,
        graph: Option<&Arc<GraphPacking>>,
        files: &mut Files,
    ) -> Result<Option<Self>, CaseError> {
        let unit_mm = filter.smallest_mm();
        let (network, packing) = match (&scene.network.source(), graph) {
            (NetworkSource::File(path), _) => (files.network(path, scene, unit_mm)?, None),
            (NetworkSource::Graph(_, extent), Some(graph)) => {
                let copies = graph.copies(*extent, filter.d(50.0).unwrap_or(unit_mm));
                let thickness_mm = f64::from(copies) * graph.graph.cell_mm[2];
                let (rule, rho) = (scene.exit_rule(), scene.exits.rho.unwrap_or(0.0));
                let network = Network::of_graph(&graph.graph, GraphShape { copies, rule, rho, unit_mm })?;
                (network, Some(CopiedPacking { copies, thickness_mm, graph: graph.clone() }))
            }
            _ => return Ok(None),
        };
        Ok(Some(Self { finest: network.finest(), network, packing }))
    }

    /// Constriction curve (mm): its open diameters by number, at most a thousand points.
    fn curve(&self) -> Result<Curve, CaseError> {
        let unit_mm = self.network.unit_mm();
        let open = self.network.diameters().iter().filter(|&&d| d > 0.0 && d != WIDE);
        let mut sizes: Vec<f64> = open.map(|&d| f64::from(d) * unit_mm).collect();
        sizes.sort_by(f64::total_cmp);
        let Some(last) = sizes.len().checked_sub(1) else {
            return Ok(Curve::from_points(&[(100.0, unit_mm)], CurveUnit::Mm)?);
        };
        let steps = last.clamp(1, 1000);
        let point = |k: usize| (100.0 * k as f64 / steps as f64, sizes[last * k / steps]);
        Ok(Curve::from_points(&(0..=steps).map(point).collect::<Vec<_>>(), CurveUnit::Mm)?)
    }
}

/// Measurements on the grains of a graph's packing.
pub(crate) struct GraphPacking {
    pub(crate) graph: VoidGraph,
    /// Constriction curve in mm.
    pub curve: Curve,
    pub(crate) gradation: Gradation,
}

impl GraphPacking {
    /// Reads the file named by the scene, or measures the filter's own packing; `None` if that does not
    /// exist yet.
    pub(crate) fn read(
        scene: &Scene,
        file: Option<&PathBuf>,
        packed: Option<&PackedFilter>,
        files: &mut Files,
    ) -> Result<Option<Self>, CaseError> {
        let merge_overlap =
            scene.packing.as_ref().map_or(DEFAULT_MERGE_OVERLAP, |packing| packing.filter.merge_overlap);
        let (name, packing) = match (file, packed) {
            (Some(path), _) => files.packing(path, scene)?,
            (None, Some(PackedFilter { grains: Some(grains), .. })) => files.packed_grains(grains)?,
            (None, _) => return Ok(None),
        };
        let (constrictions, graph) = VoidGraph::measure(&packing, merge_overlap)
            .map_err(|error| scene.clash(format!("{name}: {error}")))?;
        if let (Some(_), Some(input)) = (file, files.inputs.last_mut()) {
            input.notes.extend(constrictions.doubts().iter().map(words::doubt));
        }
        let gradation = of_grains(&packing)?;
        Ok(Some(Self { graph, curve: constrictions.curve()?, gradation }))
    }

    /// Number of copies of the packing for this extent.
    fn copies(&self, extent: Extent, d50f_mm: f64) -> u32 {
        let cell = self.graph.cell_mm[2];
        let thickness = match extent {
            Extent::Copies(copies) => return copies,
            other => other.thickness_mm(d50f_mm).unwrap_or(USUAL_LAYERS as f64 * self.graph.spacing_mm()),
        };
        // A thickness that exceeds a whole number of cells only by rounding needs no further cell.
        libm::ceil(thickness / cell - 1e-9).clamp(1.0, 1e6) as u32
    }
}

/// Gradation of grains by mass, at about 200 points.
fn of_grains(packing: &Packing) -> Result<Gradation, CaseError> {
    let mut sizes = packing.diameter.clone();
    sizes.sort_by(f64::total_cmp);
    let (smallest, largest) = (sizes[0], sizes[sizes.len() - 1]);
    if smallest == largest {
        return Ok(Gradation::single(smallest)?);
    }
    let cube = |d: f64| d * d * d;
    let all: f64 = sizes.iter().map(|&d| cube(d)).sum();
    let (mut finer, mut points) = (0.0, vec![(smallest, 0.0)]);
    for &size in &sizes {
        finer += cube(size);
        let percent = 100.0 * finer / all;
        let (last_size, last_percent) = points[points.len() - 1];
        if size > last_size && percent >= last_percent + 0.5 {
            points.push((size, percent.min(100.0)));
        }
    }
    match points.last_mut() {
        Some(last) if last.0 == largest => last.1 = 100.0,
        _ => points.push((largest, 100.0)),
    }
    Ok(Gradation::from_points(&points, None)?)
}
