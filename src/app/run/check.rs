//! Forecast of a run, before any of its work.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::callbacks::Callbacks;
use super::error::RunError;
use super::machine::on_threads;
use super::planned::runs_to_walk;
use super::prepare::{Draft, PrepareOptions};
use super::replicates::{have_networks, left_out_of_first_run};
use super::results::left_out;
use crate::case::{CaseError, PackedFilter, PackingPlan};
use crate::outcome::record::{Inputs, LeftOut, Ratios};
use crate::scene::Scene;
use voidwalk_core::store::Placement;
use voidwalk_practice::Note;
use voidwalk_practice::ordered;

/// What a run of a scene would do; sizes and times are estimates.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Check {
    /// Base particles of a run.
    pub n_base: u64,
    /// Base particles by Eq. (2), where the grains per void are known.
    pub n_base_eq2: Option<u64>,
    /// Whether a cap made `n_base` smaller than Eq. (2).
    pub capped: bool,
    /// Filter grains per void, where known.
    pub grains_per_void: Option<f64>,
    /// Mass of base over mass of filter, where known.
    pub mass_ratio: Option<f64>,
    /// Base particles that are walked by themselves, at most.
    pub one_by_one: u64,
    /// Runs to walk.
    pub runs_to_walk: u64,
    /// Increments of insertion of a run, at most.
    pub increments: u64,
    /// Memory of a walk (bytes).
    pub bytes: u64,
    /// Memory that the walks may take (bytes).
    pub bytes_allowed: u64,
    /// Memory in words.
    pub memory: String,
    /// Seconds of one core of this machine for the walks, the packing apart.
    pub core_seconds: f64,
    /// Whether the particles are in files, mapped into memory.
    pub particles_on_disk: bool,
    /// Sizes of filter over base.
    pub ratios: Ratios,
    /// The packing that is needed.
    pub packing: Option<PackingCheck>,
    /// What goes in.
    pub inputs: Inputs,
    /// Parts of the program that are not needed.
    pub left_out: Vec<LeftOut>,
    /// What a user must know.
    pub notes: Vec<Note>,
    /// Why a run would be refused all the same: memory does not suffice.
    #[serde(skip)]
    pub refusal: Option<CaseError>,
}

/// The packing that a scene needs.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct PackingCheck {
    /// Grains.
    pub grains: u64,
    /// Its folder.
    pub folder: PathBuf,
    /// Whether it is there; until then the filter's constrictions and grains per void are guesses.
    pub is_made: bool,
    /// Steps that it takes.
    pub steps: u64,
    /// Seconds of one core of this machine that it takes; where it is made, of one of 2024.
    pub core_seconds: f64,
}

impl PackingCheck {
    fn new(plan: &PackingPlan, folder: PathBuf, is_made: bool) -> Self {
        let grains = plan.compression.grains as u64;
        let core_seconds = if is_made { plan.core_seconds() } else { plan.core_seconds_here() };
        Self { grains, folder, is_made, steps: plan.usual_steps(), core_seconds }
    }
}

/// Forecasts a run of a scene, here and with these options; makes no packing and writes nothing.
///
/// # Errors
/// All mistakes of the scene, memory apart: see [`Check::refusal`].
pub fn check(scene: Scene, options: &PrepareOptions) -> Result<Check, RunError> {
    on_threads(options.threads, || check_here(scene, options))
}

fn check_here(scene: Scene, options: &PrepareOptions) -> Result<Check, RunError> {
    let draft = Draft::new(scene)?;
    let (mut packing, mut filter) = (None, None);
    if let Some(plan) = &draft.packing {
        let mut folder = options.packings.join(plan.folder_name());
        filter = PackedFilter::find(&options.packings, plan)?;
        if let Some(other) = filter.as_ref().and_then(|made| made.same_shape.as_ref()) {
            folder = other.folder.clone().into();
        }
        packing = Some(PackingCheck::new(plan, folder, filter.is_some()));
    }
    let mut case = draft.finished(filter)?;
    let here = Path::new(".");
    let threads = rayon::current_num_threads() as u64;
    let refusal = case.place(&options.limits(here), threads, here).err();
    let mut of_run = Vec::new();
    if refusal.is_none() {
        have_networks(&case, &Callbacks::default())?;
        of_run = left_out_of_first_run(&case).map_err(RunError::refused)?;
    }
    Ok(Check {
        n_base: case.supply.n_base,
        n_base_eq2: case.supply.n_base_eq2,
        capped: case.supply.capped,
        grains_per_void: case.filter.grains_per_void,
        mass_ratio: case.supply.mass_ratio,
        one_by_one: case.one_by_one(case.supply.n_base),
        runs_to_walk: runs_to_walk(&case),
        increments: case.increments(),
        bytes: case.bytes(case.supply.n_base, threads).saturating_add(case.kept_bytes()),
        bytes_allowed: case.memory,
        memory: case.memory_in_words(threads),
        core_seconds: case.core_seconds_here(),
        particles_on_disk: case.placement != Placement::Memory,
        ratios: case.ratios(),
        packing,
        inputs: case.record(),
        left_out: left_out(&case, &of_run),
        notes: ordered(case.notes()),
        refusal,
    })
}
