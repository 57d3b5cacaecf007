//! A scene: one base-filter combination and the plan of its walk, as the user states them.
//!
//! Every setting is declared once, in `keys` or by the stage that it belongs to ([`StopRule`], packing's
//! [`Settings`](voidwalk_core::packing::Settings)); a [`Scene`] holds them all. Those declarations decide the
//! commented text of [`Scene::init_text`], the allowed and refused settings, and the resolved scene that a
//! run writes and that identifies it. `groups` lists the settings that exclude each other. The names are a
//! contract.

mod complete;
mod cover;
mod groups;
mod init;
mod keys;
mod meaning;
mod packing_keys;
mod reference;
mod tables;
mod values;

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use serde::Serialize;

pub use keys::{About, Base, ExitKeys, Filter, FilterPacking, NetworkKeys, Record, WalkKeys};
pub use meaning::{
    Amount, BaseGradation, D85, Extent, FilterGradation, NetworkSource, PackingSpec, USUAL_LAYERS,
};
pub use packing_keys::PackingKeys;
pub use reference::{ExclusiveSettings, SceneReference, SectionReference, SettingReference, WayReference};
pub use tables::{TableOptions, keep_soils, quoted};
pub use values::{CurveSource, Density, LibraryDensity, NetworkMadeOf, Regrade, SheetUnits};
pub use voidwalk_core::schema::{Origin, SceneError};

use crate::outcome::stopping::StopRule;
use packing_keys::packing_keys;
use voidwalk_core::network::ExitRule;
use voidwalk_core::schema::{GivenSettings, KeyInfo, Names};
use voidwalk_core::walk::{BlockedAs, Law};

/// Name of the built-in scene in errors.
pub(crate) const BUILT_IN_NAME: &str = "built-in scene";

/// A scene: every setting with its value, given or by default, each checked by itself and against the others.
///
/// ```
/// let scene = voidwalk_app::Scene::built_in(&["base.cu=3".into(), "network.nz=30".into()]).unwrap();
/// assert_eq!((scene.base.cu, scene.network.nz), (Some(3.0), Some(30)));
/// let again = voidwalk_app::Scene::parse(scene.to_toml().as_bytes(), "again.toml", &[]).unwrap();
/// assert_eq!(again.to_toml(), scene.to_toml());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// Name in errors.
    #[serde(skip)]
    pub name: String,
    /// True if base and filter were named as a pair: they are refused if they look exchanged.
    #[serde(skip)]
    pub is_guarded: bool,
    /// Seed, engine, replicates and the like: the settings without a section.
    #[serde(flatten)]
    pub walk: WalkKeys,
    /// Rule that stops the addition of replicates, if more than those may be needed.
    #[serde(skip_serializing_if = "StopRule::is_unset")]
    pub stop: StopRule,
    /// The filter.
    pub filter: Filter,
    /// Packing of the filter, if it is packed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packing: Option<PackingKeys>,
    /// The base soil.
    pub base: Base,
    /// Choice of exits by particles.
    #[serde(rename = "walk", skip_serializing_if = "ExitKeys::is_unset")]
    pub exits: ExitKeys,
    /// The network.
    pub network: NetworkKeys,
    /// Results to keep.
    pub record: Record,
    /// Further entries on the first page of the report.
    #[serde(skip_serializing_if = "About::is_unset")]
    pub about: About,
}

/// The names of all settings, and which exclude each other.
static NAMES: LazyLock<Names> = LazyLock::new(|| Names {
    known: Scene::keys().iter().map(KeyInfo::full_name).collect(),
    lines: About::texts(),
    groups: groups::GROUPS,
});

impl Scene {
    /// Every setting, section by section, in the order in which they are written.
    pub fn keys() -> Vec<KeyInfo> {
        init::sections().into_iter().flat_map(|(_, keys)| keys).collect()
    }

    /// The built-in scene as commented TOML, as `voidwalk init` writes it, with every setting.
    pub fn init_text() -> String {
        init::text()
    }

    /// Reference for programs: every setting with its type, default and allowed values.
    pub fn reference() -> SceneReference {
        reference::reference()
    }

    /// The built-in scene, with `name=value` settings applied.
    ///
    /// # Errors
    /// A setting that does not exist or is not allowed.
    pub fn built_in(assignments: &[String]) -> Result<Self, SceneError> {
        Self::parse(init::text().as_bytes(), BUILT_IN_NAME, assignments)
    }

    /// A scene from a file, with `name=value` settings applied.
    ///
    /// # Errors
    /// The file cannot be read, or a setting does not exist, is not allowed, clashes or is missing.
    pub fn read(path: &Path, assignments: &[String]) -> Result<Self, SceneError> {
        Self::assigned(GivenSettings::read(path, &NAMES)?, assignments)
    }

    /// A scene from TOML text; errors call the file `name`, and paths are taken as they are.
    ///
    /// # Errors
    /// See [`Scene::read`].
    pub fn parse(bytes: &[u8], name: &str, assignments: &[String]) -> Result<Self, SceneError> {
        Self::assigned(GivenSettings::parse(bytes, name, PathBuf::new(), &NAMES)?, assignments)
    }

    /// The scene of a plan's case: the built-in scene or one from a file, with the case's settings, those
    /// stated together in one list each.
    ///
    /// # Errors
    /// See [`Scene::read`].
    pub fn planned(
        base: Option<&Path>,
        assignments: &[Vec<String>],
        origin: &Origin,
    ) -> Result<Self, SceneError> {
        let mut s = match base {
            Some(path) => GivenSettings::read(path, &NAMES)?,
            None => GivenSettings::parse(init::text().as_bytes(), BUILT_IN_NAME, PathBuf::new(), &NAMES)?,
        };
        for together in assignments {
            s.set_together(together, &NAMES, origin)?;
        }
        Ok(Self { name: origin.to_string(), ..Self::of(&s)? })
    }

    fn assigned(mut s: GivenSettings, assignments: &[String]) -> Result<Self, SceneError> {
        s.set_together(assignments, &NAMES, &Origin::CommandLine)?;
        Self::of(&s)
    }

    fn of(s: &GivenSettings) -> Result<Self, SceneError> {
        s.check_groups(groups::GROUPS)?;
        let mut scene = Self {
            name: s.file().to_owned(),
            is_guarded: false,
            walk: WalkKeys::read(s)?,
            stop: StopRule::read(s)?,
            filter: Filter::read(s)?,
            packing: packing_keys(s)?,
            base: Base::read(s)?,
            exits: ExitKeys::read(s)?,
            network: NetworkKeys::read(s)?,
            record: Record::read(s)?,
            about: About::read(s)?,
        };
        scene.check_what_is_missing(s)?;
        scene.fill_in();
        Ok(scene)
    }

    /// Reads the packing of a filter from a file; in a scene the other settings are ignored.
    ///
    /// # Errors
    /// See [`Scene::read`]; also if neither density nor friction is given.
    pub fn read_packing(path: &Path, assignments: &[String]) -> Result<PackingSpec, SceneError> {
        let mut s = GivenSettings::read(path, &NAMES)?;
        s.set_together(assignments, &NAMES, &Origin::CommandLine)?;
        s.check_groups(groups::GROUPS)?;
        let (mut filter, packing) = (Filter::read(&s)?, packing_keys(&s)?);
        filter.fill_in();
        let Some(packing) = packing else {
            let words = Density::WORDS;
            return Err(s.clash(format!("filter.density is missing: {words}; or filter.friction")));
        };
        PackingSpec::new(&filter, &packing, s.file())
    }

    /// Packing of the filter, if it is to be packed.
    ///
    /// # Errors
    /// Its gradation is missing.
    pub fn packing_spec(&self) -> Result<Option<PackingSpec>, SceneError> {
        let spec = |packing| PackingSpec::new(&self.filter, packing, &self.name);
        self.packing.as_ref().map(spec).transpose()
    }

    /// Every setting that the scene has, in TOML: read again, it is the same scene.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_else(|e| unreachable!("settings are numbers, words and lists: {e}"))
    }

    /// The error for settings of this scene that clash.
    pub fn clash(&self, problem: impl Into<String>) -> SceneError {
        SceneError::Clash { file: self.name.clone(), problem: problem.into() }
    }

    /// True if blocked constrictions leave openings.
    pub fn leaves_openings(&self) -> bool {
        self.exits.blocked == Some(BlockedAs::Open)
    }

    /// The law of arching, if particles arch.
    pub fn law(&self) -> Option<&'static Law> {
        self.exits.arching?.law()
    }

    /// Rule by which particles choose among the exits of a void.
    pub fn exit_rule(&self) -> ExitRule {
        self.exits.exit.unwrap_or(match self.network.kind {
            Some(NetworkMadeOf::Graph) => ExitRule::Flux,
            _ if self.network.is_of_arrays() => ExitRule::Flux,
            _ => ExitRule::Area,
        })
    }

    /// True if particles walk the directed cubic lattice and choose among its exits by area.
    pub fn is_lattice_by_area(&self) -> bool {
        matches!(self.network.source(), NetworkSource::Cubic(_)) && self.exit_rule() == ExitRule::Area
    }

    /// Gives the settings that follow from others their values, so that the scene is complete.
    fn fill_in(&mut self) {
        self.filter.fill_in();
        self.base.fill_in();
        self.network.fill_in();
    }
}

#[cfg(test)]
mod tests;
