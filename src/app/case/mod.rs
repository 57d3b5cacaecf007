//! Case: a scene with its files read and every number determined, before any work is done.
//!
//! It is built in stages, each complete once it exists and made from the previous ones: the filter as stated,
//! a network that all replicates walk, the filter, the base, the network, the particles of the base.

mod base;
mod error;
mod files;
mod filter;
mod library_filter;
mod memory;
mod network;
mod notes;
mod packed_filter;
mod recipe;
mod record;
mod resolved;
mod varied;

pub(crate) use base::{CaseBase, CaseSupply, PAPER_MASS_RATIO};
pub use error::CaseError;
pub(crate) use files::{INPUT_FILES, INPUT_NAMES};
pub(crate) use filter::CaseFilter;
pub(crate) use library_filter::{LibraryFilter, OtherCurve, end_of_guess};
pub(crate) use memory::ResourceLimits;
pub(crate) use network::CaseNetwork;
pub use network::replicate_seed;
pub use packed_filter::PackingPlan;
pub(crate) use packed_filter::{GRAINS, Input, PackedError, PackedFilter, RECORD};
pub(crate) use record::base_record;
pub(crate) use varied::StatedBase;

use crate::outcome::Modelled;
use crate::outcome::record::{ArchingRecord, Ratios};
use crate::scene::{NetworkSource, Scene};
use base::as_passive;
use files::Files;
use filter::GraphPacking;
use network::placeholder_shape;
use std::borrow::Cow;
use std::sync::Arc;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::{CONDUCTANCE_EXPONENT, ExitRule, Network, NetworkError};
use voidwalk_core::store::Placement;
use voidwalk_core::walk::{Arching, DENSEST};
use voidwalk_practice::Note;

/// Scene with all its derived values.
///
/// ```
/// use voidwalk_app::{Case, Scene};
/// let case = Case::new(Scene::built_in(&["base.cu=3".to_owned()])?)?;
/// // D85 of the base is the Dc5 of the filter, and Eq. (2) says how many particles there are.
/// assert!((case.base.gradation.d(85.0).unwrap() / case.filter.curve.dc(5.0).unwrap() - 1.0).abs() < 1e-9);
/// assert_eq!(Some(case.supply.n_base), case.supply.n_base_eq2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Case {
    pub(crate) scene: Scene,
    /// The filter.
    pub filter: CaseFilter,
    /// The base.
    pub base: CaseBase,
    /// Note that base and filter look exchanged, or are in different units.
    pub(crate) mistake: Option<Note>,
    pub(crate) network: CaseNetwork,
    /// Particles of the base in the walk.
    pub supply: CaseSupply,
    /// Files that were read.
    pub inputs: Vec<Input>,
    /// Maximum memory for the walks (bytes): no limit until [`Case::place`] sets one.
    pub(crate) memory: u64,
    /// Location of the particles' columns.
    pub(crate) placement: Placement,
}

impl Case {
    /// Reads the scene's files and determines every number; does no other work.
    ///
    /// # Errors
    /// A file is refused, or numbers clash.
    pub fn new(scene: Scene) -> Result<Self, CaseError> {
        Self::with_filter(scene, None, None, Vec::new())
    }

    /// Case of the built-in scene with these settings.
    #[cfg(test)]
    pub(crate) fn built_in(set: &[&str]) -> Result<Self, CaseError> {
        let set: Vec<String> = set.iter().map(ToString::to_string).collect();
        Self::new(Scene::built_in(&set)?)
    }

    /// Case of a scene whose filter has been packed, with the voids of the packing if they have been
    /// measured, and with these files read before. Errors: as for [`Case::new`]; also if the filter is to be
    /// packed and has not been.
    pub(crate) fn with_filter(
        mut scene: Scene,
        packed: Option<PackedFilter>,
        measured: Option<Arc<GraphPacking>>,
        known: Vec<Input>,
    ) -> Result<Self, CaseError> {
        let mut files = Files { known, ..Files::default() };
        let (filter, fixed) = CaseFilter::read(&mut scene, packed, measured, &mut files)?;
        let base = CaseBase::read(&scene, &filter, &mut files)?;
        let scale_free = fixed.is_none() && filter.is_scale_free(&scene);
        let mistake = base.mistake(&scene, &filter.gradation, scale_free)?;
        let network = CaseNetwork::new(&scene, &filter, fixed)?;
        let is_packed = filter.packed.as_ref().is_some_and(|packed| packed.files.is_some());
        let supply = CaseSupply::new(&scene, &filter, network.voids, &base.gradation, is_packed);
        let supply = supply.map_err(|error| match &mistake {
            Some(mistake) if scene.base.sieve.is_some() => scene.clash(mistake.to_string()).into(),
            _ => error,
        })?;
        for (name, soil, percent) in [("filter", &filter.gradation, 15.0), ("base", &base.gradation, 85.0)] {
            if soil.d(percent).is_none() {
                let problem = format!(
                    "the {name}'s D{percent} lies in the pan fraction (finer than the finest sieve): add \
                     finer sieves, or {name}.d0_mm"
                );
                return Err(scene.clash(problem).into());
            }
        }
        if scene.leaves_openings() && base.as_given().pan_fraction() > 0.0 {
            let problem = "walk.blocked = \"open\" needs the sizes of the whole base, as openings may stop a \
                           particle of any size: add base.d0_mm, or finer sieves down to 0 %";
            return Err(scene.clash(problem).into());
        }
        let (inputs, memory, placement) = (files.inputs, u64::MAX, Placement::Memory);
        let mistake = mistake.map(|mistake| mistake.note);
        Ok(Self { scene, filter, base, mistake, network, supply, inputs, memory, placement })
    }

    /// Mass fraction of the base that is passive and counted by mass only.
    pub(crate) fn pan_by_mass_only(&self) -> f64 {
        if self.supply.pan_is_walked { 0.0 } else { self.base.gradation.pan_fraction() }
    }

    /// Base with all particles that are walked.
    pub(crate) fn base_as_walked(&self) -> Cow<'_, Gradation> {
        let (base, finest_mm) = (&self.base.gradation, self.filter.finest_mm);
        match self.supply.pan_is_walked {
            true => Cow::Owned(as_passive(base, finest_mm, &self.scene).expect("it was sampled")),
            false => Cow::Borrowed(base),
        }
    }

    /// Network of the replicate with this seed. Errors: no network with the scene's distribution of
    /// connectivity is found for this seed; [`Case::new`] reports all other errors.
    pub(crate) fn network(&self, seed: u64) -> Result<Network, NetworkError> {
        let (filter, exits) = (&self.filter, &self.scene.exits);
        let network = match (&self.network.fixed, &self.scene.network.source()) {
            (Some(fixed), _) => fixed.network.clone(),
            (None, NetworkSource::Connected(shape, wanted)) => {
                Network::connected(*shape, &filter.curve, filter.unit_mm, seed, wanted)?
            }
            (None, source) => {
                let placeholder = || placeholder_shape(&self.scene, &filter.gradation);
                let shape = source.shape().unwrap_or_else(placeholder);
                let lattice = Network::cubic(shape, &filter.curve, filter.unit_mm, seed)?;
                let exponent = exits.conductance_exponent.unwrap_or(CONDUCTANCE_EXPONENT);
                match self.scene.exit_rule() {
                    ExitRule::Area => lattice,
                    // Water sets the directions.
                    rule => lattice.undirected_lattice(rule, exits.rho.unwrap_or(0.0), exponent)?,
                }
            }
        };
        Ok(match exits.flow_tolerance {
            Some(tolerance) => network.with_flow_tolerance(tolerance),
            None => network,
        })
    }

    /// Number of increments in which the base is inserted, a whole number so that all are equal.
    pub(crate) fn increments(&self) -> u64 {
        (1.0 / self.scene.walk.inject_share).round().max(1.0) as u64
    }

    /// Number of constriction curves that are walked: its own, and the ends of its range.
    pub(crate) fn curves(&self) -> usize {
        1 + self.filter.curve_ends.len()
    }

    /// D15F over D85B and D95B.
    pub(crate) fn ratios(&self) -> Ratios {
        let d = |gradation: &Gradation, percent| gradation.d(percent).unwrap_or(f64::NAN);
        let (d15f, base) = (d(&self.filter.gradation, 15.0), &self.base.gradation);
        Ratios { d15f_over_d85b: d15f / d(base, 85.0), d15f_over_d95b: d15f / d(base, 95.0) }
    }

    /// Law of its arches at the concentration stated by the scene; `None` if particles do not arch.
    pub(crate) fn arching(&self) -> Option<Arc<Arching>> {
        let concentration = self.scene.exits.concentration.unwrap_or(DENSEST);
        self.scene.law().map(|law| Arc::new(Arching::new(law, concentration)))
    }

    pub(crate) fn arching_record(&self) -> Option<ArchingRecord> {
        let law = self.scene.law()?;
        Some(ArchingRecord {
            law: law.name.into(),
            source: law.source.into(),
            basis: law.basis.into(),
            range_of_ratio: [1.0, law.widest],
            concentration: self.scene.exits.concentration,
        })
    }

    /// Mechanisms in its walks that other walks omit.
    pub(crate) fn modelled(&self) -> Modelled {
        Modelled {
            flow: self.scene.exit_rule().needs_flow(),
            arches: self.scene.law().is_some(),
            openings: self.scene.leaves_openings(),
        }
    }

    /// Doubts about a verdict with arches and openings, which no test has checked.
    pub(crate) fn unchecked_clogging(&self) -> impl Iterator<Item = Note> {
        let arches = self.scene.law().map(|law| Note::Arches { law: law.name.into() });
        arches.into_iter().chain(self.scene.leaves_openings().then_some(Note::Openings {}))
    }
}
