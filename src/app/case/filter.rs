//! The filter of a case: its gradation, and its constrictions in mm with how far they may be off.

use super::curve_ends::{self, OtherCurve};
use super::error::CaseError;
use super::fixed_network::FixedNetwork;
use super::library_filter::LibraryFilter;
use super::packed_filter::{GUESSED_GRAINS_PER_VOID, PackedFilter};
use super::stated_filter::StatedFilter;
use crate::scene::{Amount, BaseGradation, D85, FilterGradation, Scene};
use voidwalk_core::constrictions::{Curve, CurveUnit, ShippedFilter};
use voidwalk_core::gradation::Gradation;

/// A filter, worked out.
#[derive(Clone)]
pub struct CaseFilter {
    /// Its gradation.
    pub gradation: Gradation,
    /// The reference length: its smallest grain (mm).
    pub unit_mm: f64,
    /// Its constriction curve (mm).
    pub curve: Curve,
    /// Further curves that are walked: the ends of the range in which its own is known.
    pub curve_ends: Vec<OtherCurve>,
    /// The finest constriction (mm) of every curve that is walked, the ends of its range included: finer
    /// particles block nothing in any of them.
    pub finest_mm: f64,
    /// Filter grains per void, if they are known or guessed.
    pub grains_per_void: Option<f64>,
    /// The shipped filter that the curve is, if it is one.
    pub shipped: Option<&'static ShippedFilter>,
    /// The packing that the curve was measured on, if the program made it.
    pub packed: Option<PackedFilter>,
    /// Entry of the library of packings, if the curve comes from there.
    pub library: Option<LibraryFilter>,
    /// Relative density, 0 loose to 1 dense, of a curve that is guessed from the gradation.
    pub guessed_density: Option<f64>,
}

impl CaseFilter {
    /// Takes a filter as it is stated; `fixed` is its network if all replicates walk one network.
    pub(super) fn new(
        scene: &Scene,
        stated: StatedFilter,
        fixed: Option<&FixedNetwork>,
    ) -> Result<Self, CaseError> {
        let grains_per_void = grains_per_void(scene, &stated, fixed);
        let StatedFilter { gradation, curve, shipped, packed, library, guessed_density, .. } = stated;
        let unit_mm = gradation.smallest_mm();
        let curve = match (fixed.filter(|fixed| fixed.packing.is_none()), curve) {
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
        let curve_ends = match (fixed, &library) {
            (Some(_), _) => Vec::new(),
            (None, Some(library)) => {
                // A value stated by the user holds for every curve.
                let is_stated = scene.filter.grains_per_void.is_some();
                let times = |end: &OtherCurve| if is_stated { 1.0 } else { end.times_grains };
                library
                    .ends
                    .iter()
                    .map(|end| OtherCurve { times_grains: times(end), ..end.clone() })
                    .collect()
            }
            (None, None) => {
                let part = packed.as_ref().and_then(|packed| packed.part.as_ref());
                curve_ends::of(&curve, &gradation, part, guessed_density)
            }
        };
        let finest_mm = curve_ends.iter().map(|end| end.curve.smallest()).fold(curve.smallest(), f64::min);
        Ok(Self {
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
        })
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

    /// Enlarges all sizes of the filter by `factor`, and keeps its own curve alone.
    ///
    /// # Errors
    /// Sizes out of range.
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

/// True if Eq. (2) needs grains per void that are not given: if the constrictions are a guess.
pub(super) fn needs_grains_per_void(scene: &Scene, guessed_density: Option<f64>) -> bool {
    guessed_density.is_some()
        && scene.filter.grains_per_void.is_none()
        && matches!(scene.base.amount(), Amount::MassRatio(..))
}

/// Filter grains per void: as given, as measured on the packing of the voids or constrictions, or a guess.
fn grains_per_void(scene: &Scene, stated: &StatedFilter, fixed: Option<&FixedNetwork>) -> Option<f64> {
    // The grains per void of a shipped packing do not apply to a network from elsewhere.
    let of_shipped = stated.shipped.filter(|_| fixed.is_none()).map(|shipped| shipped.grains_per_void);
    let of_graph = stated.graph.as_ref().map(|graph| graph.grains_per_void(&stated.gradation));
    let of_packing = stated.packed.as_ref().map(|packed| packed.grains_per_void).or(of_shipped);
    let of_library = stated.library.as_ref().map(|library| library.found.grains_per_void);
    let known = scene.filter.grains_per_void.or(of_graph).or(of_packing).or(of_library);
    let is_guessed = needs_grains_per_void(scene, stated.guessed_density);
    known.or(is_guessed.then_some(GUESSED_GRAINS_PER_VOID))
}
