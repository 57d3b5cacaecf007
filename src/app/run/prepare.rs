//! Turns a scene into a case that can be walked, in one sequence for all commands.
//!
//! A scene is first drafted, with a guess for a filter that is still to be packed; mistakes and a lack of
//! memory are refused at this point. The caller then claims the folder for the results. Only then is the
//! draft finished, and its filter packed unless it has been packed before, which may take hours.
//!
//! A check forecasts the run of a scene without doing any of its work. Examples are files to start from.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::RunError;
use super::callbacks::Callbacks;
use super::folder::refused;
use super::machine::{available_bytes, on_threads};
use super::pack::{PACKINGS, provide, with_time};
use super::replicates::{have_networks, left_out_of_first_run, runs_to_walk};
use super::results::left_out;
use crate::case::{Case, CaseError, PackedFilter, PackingPlan, ResourceLimits};
use crate::outcome::record::{Inputs, LeftOut, Ratios};
use crate::scene::Scene;
use crate::words;
use voidwalk_core::store::{Placement, StoreError, write_whole};
use voidwalk_practice::{Note, ordered};

/// Options of preparing a scene; no option changes a result.
#[derive(Clone, Debug)]
pub struct PrepareOptions {
    /// Folder in which packings are kept, so that each is made once.
    pub packings: PathBuf,
    /// Memory that the walks may take (bytes); by default 80 % of the available memory.
    pub memory: Option<u64>,
    /// Worker threads; by default the number that a cluster's job has, else one per core.
    pub threads: Option<usize>,
}

impl Default for PrepareOptions {
    fn default() -> Self {
        Self { packings: PACKINGS.into(), memory: None, threads: None }
    }
}

impl PrepareOptions {
    /// Limits of the walks, with their particles in memory or in `folder`.
    pub(crate) fn limits(&self, folder: &Path) -> ResourceLimits {
        ResourceLimits::new(self.memory, available_bytes(), folder)
    }
}

/// Scene found sound, and the packing that it needs.
pub(crate) struct Draft {
    scene: Scene,
    /// Case, with a guess for a filter that is still to be packed.
    pub(crate) case: Case,
    /// Packing that is still to be made for it.
    pub(crate) packing: Option<PackingPlan>,
}

impl Draft {
    /// Works a scene out, with a guess for a filter that is still to be packed.
    pub(crate) fn new(scene: Scene) -> Result<Self, RunError> {
        let packing = PackingPlan::of(&scene).map_err(with_time)?;
        let placeholder = packing.as_ref().map(PackedFilter::placeholder).transpose();
        let known = packing.as_ref().map_or(Vec::new(), |packing| packing.inputs.clone());
        let case = Case::with_filter(scene.clone(), placeholder.map_err(CaseError::from)?, None, known)?;
        Ok(Self { scene, case, packing })
    }

    /// Finishes the case, with the packed filter if it needs one; no file is read again. Errors: a packed
    /// filter that turns out unsuitable.
    pub(crate) fn finished(self, filter: Option<PackedFilter>) -> Result<Case, RunError> {
        match filter {
            Some(_) => Ok(Case::with_filter(self.scene, filter, None, self.case.inputs)?),
            None => Ok(self.case),
        }
    }

    /// Forecasts the run, without making a packing that it needs.
    fn check(self, options: &PrepareOptions) -> Result<Check, RunError> {
        let (mut packing, mut filter) = (None, None);
        if let Some(plan) = &self.packing {
            let mut folder = options.packings.join(plan.folder_name());
            filter = PackedFilter::find(&options.packings, plan)?;
            if let Some(other) = filter.as_ref().and_then(|made| made.same_shape.as_ref()) {
                folder = other.folder.clone().into();
            }
            let is_made = filter.is_some();
            let core_seconds = if is_made { plan.core_seconds() } else { plan.core_seconds_here() };
            let (grains, steps) = (plan.compression.grains as u64, plan.usual_steps());
            packing = Some(PackingCheck { grains, folder, is_made, steps, core_seconds });
        }
        let mut case = self.finished(filter)?;
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
            memory: words::memory::memory(&case.walk_memory(threads)),
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
}

/// Prepares a scene: checks it and its memory, provides its packed filter, works its numbers out, and places
/// its particles in memory or, if they do not fit, in files in the current folder.
///
/// # Errors
/// Mistakes of the scene, before any work; then errors of the packing.
pub fn prepare(scene: Scene, options: &PrepareOptions, callbacks: &Callbacks) -> Result<Case, RunError> {
    let here = Path::new(".");
    on_threads(options.threads, || Ok(prepare_into(scene, options, here, || Ok(here), callbacks)?.0))
}

/// Prepares a scene for a folder that `claim` claims, before any work, once the scene is found sound;
/// `wanted` is its future path. Must be called on the threads that will walk.
pub(crate) fn prepare_into<F: AsRef<Path>>(
    scene: Scene,
    options: &PrepareOptions,
    wanted: &Path,
    claim: impl FnOnce() -> Result<F, RunError>,
    callbacks: &Callbacks,
) -> Result<(Case, F), RunError> {
    let (limits, threads) = (options.limits(wanted), rayon::current_num_threads() as u64);
    let mut draft = Draft::new(scene)?;
    draft.case.place(&limits, threads, wanted)?;
    have_networks(&draft.case, callbacks)?;
    let folder = claim()?;
    let provided = |packing| provide(packing, &options.packings, callbacks);
    let filter = draft.packing.as_ref().map(provided).transpose()?;
    let is_packed = filter.is_some();
    let mut case = draft.finished(filter)?;
    match is_packed {
        true => case.place(&limits, threads, folder.as_ref())?,
        false => case.placement = case.placement.within(folder.as_ref()),
    }
    Ok((case, folder))
}

/// Writes a file; refuses to replace one.
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    if path.symlink_metadata().is_ok() {
        return Err(refused(path, "exists already; name a new file"));
    }
    write_whole(path, bytes).map_err(RunError::Claim)
}

/// Forecast of a run of a scene; sizes and times are estimates.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Check {
    /// Base particles of a run.
    pub(crate) n_base: u64,
    /// Base particles by Eq. (2), if the grains per void are known.
    pub(crate) n_base_eq2: Option<u64>,
    /// True if a cap made `n_base` smaller than Eq. (2).
    pub(crate) capped: bool,
    /// Filter grains per void, if known.
    pub(crate) grains_per_void: Option<f64>,
    /// Mass of base over mass of filter, if known.
    pub(crate) mass_ratio: Option<f64>,
    /// Maximum number of base particles that are walked one by one.
    pub(crate) one_by_one: u64,
    /// Runs to walk.
    pub(crate) runs_to_walk: u64,
    /// Maximum number of increments of insertion of a run.
    pub(crate) increments: u64,
    /// Memory of a walk (bytes).
    pub(crate) bytes: u64,
    /// Memory that the walks may take (bytes).
    pub(crate) bytes_allowed: u64,
    /// Memory in words.
    pub(crate) memory: String,
    /// Seconds of one core of this machine for the walks, without the packing.
    pub(crate) core_seconds: f64,
    /// True if the particles are in files mapped into memory.
    pub(crate) particles_on_disk: bool,
    /// Size ratios of filter and base.
    pub(crate) ratios: Ratios,
    /// The packing that is needed.
    pub(crate) packing: Option<PackingCheck>,
    /// Inputs of the run.
    pub(crate) inputs: Inputs,
    /// Parts of the program that are not needed.
    pub(crate) left_out: Vec<LeftOut>,
    /// Notes for the user.
    pub(crate) notes: Vec<Note>,
    /// Reason why a run would still be refused: too little memory.
    #[serde(skip)]
    pub refusal: Option<CaseError>,
}

/// The packing that a scene needs.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct PackingCheck {
    /// Grains.
    pub(crate) grains: u64,
    /// Its folder.
    pub(crate) folder: PathBuf,
    /// True if it exists; until then the filter's constrictions and grains per void are guesses.
    pub(crate) is_made: bool,
    /// Steps of its compression.
    pub(crate) steps: u64,
    /// Seconds of one core of this machine that it takes; if it exists, of one core of 2024.
    pub(crate) core_seconds: f64,
}

/// Forecasts a run of a scene, here and with these options; packs nothing and writes nothing.
///
/// # Errors
/// All mistakes of the scene, memory apart: see `Check::refusal`.
pub fn check(scene: Scene, options: &PrepareOptions) -> Result<Check, RunError> {
    on_threads(options.threads, || Draft::new(scene)?.check(options))
}

/// An example: its file name, a description, and its text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExampleFile {
    /// Its name.
    pub(crate) name: &'static str,
    /// Description of its contents.
    pub(crate) what: &'static str,
    /// Its whole text.
    pub(crate) text: &'static str,
}

/// Example of this name in `src/app/data/examples`.
macro_rules! example {
    ($name:literal, $what:literal) => {
        ExampleFile { name: $name, what: $what, text: include_str!(concat!("../data/examples/", $name)) }
    };
}

/// Every example.
pub(crate) const EXAMPLE_FILES: [ExampleFile; 8] = [
    example!("base.csv", "a base: openings in mm, percent finer by mass"),
    example!("filter.csv", "a filter for it"),
    example!("filter-fine.csv", "a finer one"),
    example!("us-sieves.csv", "two soils by US sieves, side by side in one sheet"),
    example!("borrow-area.ags", "six samples of a borrow area (AGS4)"),
    example!("scene.toml", "a scene: base, filter and network, with a cover for the first sheet"),
    example!("plan.toml", "a plan: two filters by two densities"),
    example!("notebook.ipynb", "the same from Python"),
];

/// Writes every example into a folder, which is made if it is missing. Other files in it stay. Errors:
/// [`RunError::Refused`] if a file exists already, or the folder is a file; nothing is written then.
pub(crate) fn write_examples(folder: &Path) -> Result<(), RunError> {
    let places = EXAMPLE_FILES.map(|file| folder.join(file.name));
    if let Some(taken) = places.iter().find(|path| path.symlink_metadata().is_ok()) {
        return Err(refused(taken, "exists already; nothing was written. Name another folder"));
    }
    if let Some(file) = folder.ancestors().find(|part| part.exists() && !part.is_dir()) {
        return Err(refused(file, "is a file; name a folder, a new one or one that is there"));
    }
    let io = |source| StoreError::Io { path: folder.to_owned(), action: "make the folder", source };
    std::fs::create_dir_all(folder).map_err(io).map_err(RunError::Claim)?;
    places.iter().zip(EXAMPLE_FILES).try_for_each(|(path, file)| write_new(path, file.text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::CasePlan;
    use voidwalk_sheets::{curves_in_file, soils_in_file};

    #[test]
    fn every_example_is_read_without_a_remark_and_the_soils_are_what_is_said() {
        let root = tempfile::tempdir().unwrap();
        write_examples(root.path()).unwrap();
        let place = |name: &str| root.path().join(name);
        let soils = |name: &str| curves_in_file(&place(name), None).unwrap().len();
        let counts =
            ["base.csv", "filter.csv", "filter-fine.csv", "us-sieves.csv", "borrow-area.ags"].map(soils);
        assert_eq!(counts, [1, 1, 1, 2, 6]);
        let notes = |name: &str| soils_in_file(&place(name), None).unwrap()[0].notes.clone();
        let of_sieves = "US sieves read as the openings of ASTM E11 (No. 200 = 0.075 mm)";
        assert_eq!(notes("us-sieves.csv"), [of_sieves]);
        let case = Case::new(Scene::read(&place("scene.toml"), &[]).unwrap()).unwrap();
        assert_eq!(case.scene.filter.thickness_mm, Some(609.6));
        let plan = CasePlan::read(&place("plan.toml")).unwrap();
        assert_eq!(plan.cases.len(), 4);
        for case in &plan.cases {
            Case::new(case.scene.clone()).unwrap();
        }
        let notebook = EXAMPLE_FILES.iter().find(|file| file.name == "notebook.ipynb").unwrap();
        let notebook: serde_json::Value = serde_json::from_str(notebook.text).unwrap();
        assert_eq!((&notebook["nbformat"], notebook["cells"].as_array().unwrap().len()), (&4.into(), 8));
    }

    #[test]
    fn nothing_is_written_over_and_nothing_half() {
        let root = tempfile::tempdir().unwrap();
        let taken = root.path().join("plan.toml");
        std::fs::write(&taken, "mine").unwrap();
        let message = write_examples(root.path()).unwrap_err().to_string();
        assert!(message.contains("plan.toml: exists already; nothing was written"), "{message}");
        assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 1);
        let message = write_examples(&taken.join("below")).unwrap_err().to_string();
        assert!(message.contains("plan.toml: is a file"), "{message}");
    }
}
