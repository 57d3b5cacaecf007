//! From a scene to a case that can be walked: the one sequence for every command.
//!
//! A scene is drafted first, with a guess at a filter that is still to be packed: its mistakes, and a lack of
//! memory, are refused then. The caller claims the folder for the results next. Only then is the draft
//! finished, and its filter packed unless it has been packed before, which may take hours.

use std::path::{Path, PathBuf};

use super::callbacks::Callbacks;
use super::error::RunError;
use super::folder::shown;
use super::machine::{Machine, on_threads};
use super::pack::{provide, with_time};
use super::replicates::have_networks;
use crate::case::{Case, CaseError, PackedFilter, PackingPlan, ResourceLimits};
use crate::scene::Scene;
use voidwalk_core::store::write_whole;

/// Options of preparing a scene; no setting changes a result.
#[derive(Clone, Debug)]
pub struct PrepareOptions {
    /// Folder in which packings are kept, so that each is made once.
    pub packings: PathBuf,
    /// Memory that the walks may take (bytes); 80 % of the available memory without it.
    pub memory: Option<u64>,
    /// Worker threads; by default the number that a cluster's job has, else one per core.
    pub threads: Option<usize>,
}

impl Default for PrepareOptions {
    fn default() -> Self {
        Self { packings: "voidwalk-packings".into(), memory: None, threads: None }
    }
}

impl PrepareOptions {
    /// Limits of the walks, with their particles in memory or in `folder`.
    pub(crate) fn limits(&self, folder: &Path) -> ResourceLimits {
        ResourceLimits::new(self.memory, Machine::here().available, folder)
    }
}

/// A scene that has been found sound, and the packing that it needs.
pub struct Draft {
    /// The scene.
    scene: Scene,
    /// The case, with a guess at a filter that is to be packed.
    pub case: Case,
    /// Packing that is still to be made for it.
    pub packing: Option<PackingPlan>,
}

impl Draft {
    /// Works a scene out, with a guess at a filter that is to be packed.
    ///
    /// # Errors
    /// Everything that is wrong with the scene.
    pub fn new(scene: Scene) -> Result<Self, RunError> {
        let packing = PackingPlan::of(&scene).map_err(with_time)?;
        let placeholder = packing.as_ref().map(PackedFilter::placeholder).transpose();
        let known = packing.as_ref().map_or(Vec::new(), |packing| packing.inputs.clone());
        let case = Case::with_packed(scene.clone(), placeholder.map_err(CaseError::from)?, known)?;
        Ok(Self { scene, case, packing })
    }

    /// Finishes the case, with the packed filter if it needs one; no file is read again.
    ///
    /// # Errors
    /// A filter that turns out unsuitable once it is packed.
    pub fn finished(self, filter: Option<PackedFilter>) -> Result<Case, RunError> {
        match filter {
            Some(_) => Ok(Case::with_packed(self.scene, filter, self.case.inputs)?),
            None => Ok(self.case),
        }
    }
}

/// Prepares a scene: checks it and its memory, packs its filter or takes it from the folder of packings,
/// works its numbers out, and places its particles in memory or, if they do not fit, in files in the current
/// folder.
///
/// # Errors
/// Mistakes of the scene, before any work; later errors of the packing.
pub fn prepare(scene: Scene, options: &PrepareOptions, callbacks: &Callbacks) -> Result<Case, RunError> {
    let here = Path::new(".");
    on_threads(options.threads, || Ok(prepare_into(scene, options, here, || Ok(here), callbacks)?.0))
}

/// Prepares a scene for a folder that is claimed once the scene is found sound, before any work: `claim`
/// claims it, and `wanted` is its future path. To be called on the threads that will walk.
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

/// Writes the built-in scene, commented, as a start for another.
///
/// # Errors
/// A file that exists already is refused.
pub fn write_built_in(path: &Path) -> Result<(), RunError> {
    write_new(path, Scene::init_text().as_bytes())
}

/// Writes a file that does not exist yet.
///
/// # Errors
/// A file that exists already is refused.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    if path.symlink_metadata().is_ok() {
        let problem = "is there already; name a file that is not";
        return Err(RunError::Refused(format!("{}: {problem}", shown(path))));
    }
    write_whole(path, bytes).map_err(RunError::Claim)
}
