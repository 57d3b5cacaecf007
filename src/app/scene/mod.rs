//! Scene: one base-filter combination and the plan of its walk, as stated by the user.
//!
//! Every setting is declared once, in `keys` or by its stage (`StopRule`, packing's
//! [`Settings`](voidwalk_core::packing::Settings)); a [`Scene`] holds them all. Those declarations define
//! the commented text of [`Scene::init_text`], the allowed and refused settings, and the resolved scene
//! that a run writes and that identifies it. Setting names must not change.

mod keys;
mod meaning;
mod reference;
mod tables;
mod values;

pub(crate) use keys::{About, Base, ExitKeys, Filter, NetworkKeys, PackingKeys, Record, WalkKeys};
pub(crate) use meaning::{
    Amount, BaseGradation, D85, Extent, FilterGradation, NetworkSource, PackingSpec, USUAL_LAYERS,
};
pub(crate) use reference::SceneReference;
pub use tables::TableOptions;
pub(crate) use tables::{keep_soils, quoted};
pub use values::{CurveSource, Density};
pub(crate) use values::{LibraryDensity, NetworkMadeOf, Regrade};
pub(crate) use voidwalk_core::schema::{Origin, SceneError};

use crate::outcome::stopping::StopRule;
use keys::{GROUPS, concentrations, packing_keys};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use voidwalk_core::network::ExitRule;
use voidwalk_core::schema::{GivenSettings, KeyInfo, Names};
use voidwalk_core::walk::{BlockedAs, Engine, Law};

/// Name of the built-in scene in errors.
pub(crate) const BUILT_IN_NAME: &str = "built-in scene";

/// Scene: every setting with its value, given or default, each checked alone and against the others.
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
    /// True if base and filter were named as a pair, which is refused if they look exchanged.
    #[serde(skip)]
    pub(crate) is_guarded: bool,
    /// Settings without a section, such as seed, engine and replicates.
    #[serde(flatten)]
    pub(crate) walk: WalkKeys,
    /// Rule that ends the addition of replicates, if their number is not fixed.
    #[serde(skip_serializing_if = "StopRule::is_unset")]
    pub(crate) stop: StopRule,
    /// The filter.
    pub filter: Filter,
    /// Packing of the filter, if it is packed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) packing: Option<PackingKeys>,
    /// The base soil.
    pub base: Base,
    /// Choice of exits by particles.
    #[serde(rename = "walk", skip_serializing_if = "is_unset")]
    pub(crate) exits: ExitKeys,
    /// The network.
    pub network: NetworkKeys,
    pub(crate) record: Record,
    /// Further entries for the first page of the report.
    #[serde(skip_serializing_if = "is_unset")]
    pub(crate) about: About,
}

fn is_unset<T: Default + PartialEq>(section: &T) -> bool {
    *section == T::default()
}

/// Names of all settings, and which exclude each other.
static NAMES: LazyLock<Names> = LazyLock::new(|| Names {
    known: Scene::keys().iter().map(KeyInfo::full_name).collect(),
    lines: About::texts(),
    groups: GROUPS,
});

impl Scene {
    /// Built-in scene with `name=value` settings applied.
    ///
    /// # Errors
    /// A setting does not exist or is not allowed.
    pub fn built_in(assignments: &[String]) -> Result<Self, SceneError> {
        Self::parse(Self::init_text().as_bytes(), BUILT_IN_NAME, assignments)
    }

    /// Scene from a file, with `name=value` settings applied.
    ///
    /// # Errors
    /// The file cannot be read, or a setting does not exist, is not allowed, clashes or is missing.
    pub fn read(path: &Path, assignments: &[String]) -> Result<Self, SceneError> {
        Self::assigned(GivenSettings::read(path, &NAMES)?, assignments)
    }

    /// Scene from TOML text; errors call the file `name`, and paths are taken as they are.
    pub fn parse(bytes: &[u8], name: &str, assignments: &[String]) -> Result<Self, SceneError> {
        Self::assigned(GivenSettings::parse(bytes, name, PathBuf::new(), &NAMES)?, assignments)
    }

    /// Scene of a plan's case: the built-in scene or one from a file, with the case's settings, one list
    /// for each group stated together.
    pub(crate) fn planned(
        base: Option<&Path>,
        assignments: &[Vec<String>],
        origin: &Origin,
    ) -> Result<Self, SceneError> {
        let mut s = match base {
            Some(path) => GivenSettings::read(path, &NAMES)?,
            None => {
                GivenSettings::parse(Self::init_text().as_bytes(), BUILT_IN_NAME, PathBuf::new(), &NAMES)?
            }
        };
        for together in assignments {
            s.set_together(together, &NAMES, origin)?;
        }
        Ok(Self { name: origin.to_string(), ..Self::from_settings(&s)? })
    }

    fn assigned(mut s: GivenSettings, assignments: &[String]) -> Result<Self, SceneError> {
        s.set_together(assignments, &NAMES, &Origin::CommandLine)?;
        Self::from_settings(&s)
    }

    fn from_settings(s: &GivenSettings) -> Result<Self, SceneError> {
        s.check_groups(GROUPS)?;
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
        // Settings that follow from others get their values, so that the scene is complete.
        scene.filter.fill_in();
        scene.base.fill_in();
        scene.network.fill_in();
        Ok(scene)
    }

    /// Reads the packing of a filter from a file; in a scene the other settings are ignored. Errors: see
    /// [`Scene::read`]; also if neither density nor friction is given.
    pub(crate) fn read_packing(path: &Path, assignments: &[String]) -> Result<PackingSpec, SceneError> {
        let mut s = GivenSettings::read(path, &NAMES)?;
        s.set_together(assignments, &NAMES, &Origin::CommandLine)?;
        s.check_groups(GROUPS)?;
        let (mut filter, packing) = (Filter::read(&s)?, packing_keys(&s)?);
        filter.fill_in();
        let Some(packing) = packing else {
            let words = Density::WORDS;
            return Err(s.clash(format!("filter.density is missing: {words}; or filter.friction")));
        };
        PackingSpec::new(&filter, &packing, s.file())
    }

    /// Packing of the filter, if it is to be packed. Errors: its gradation is missing.
    pub(crate) fn packing_spec(&self) -> Result<Option<PackingSpec>, SceneError> {
        let spec = |packing| PackingSpec::new(&self.filter, packing, &self.name);
        self.packing.as_ref().map(spec).transpose()
    }

    /// All settings of the scene in TOML; reading them gives the same scene.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_else(|e| unreachable!("settings are numbers, words and lists: {e}"))
    }

    /// Error for settings of this scene that clash.
    pub(crate) fn clash(&self, problem: impl Into<String>) -> SceneError {
        SceneError::Clash { file: self.name.clone(), problem: problem.into() }
    }

    /// True if blocked constrictions leave openings.
    pub(crate) fn leaves_openings(&self) -> bool {
        self.exits.blocked == Some(BlockedAs::Open)
    }

    /// Law of arching, if particles arch.
    pub(crate) fn law(&self) -> Option<&'static Law> {
        self.exits.arching?.law()
    }

    /// Rule by which particles choose among the exits of a void.
    pub(crate) fn exit_rule(&self) -> ExitRule {
        self.exits.exit.unwrap_or(match self.network.kind {
            Some(NetworkMadeOf::Graph) => ExitRule::Flux,
            _ if self.network.is_of_arrays() => ExitRule::Flux,
            _ => ExitRule::Area,
        })
    }

    /// True if particles walk the directed cubic lattice and choose among its exits by area.
    pub(crate) fn is_lattice_by_area(&self) -> bool {
        matches!(self.network.source(), NetworkSource::Cubic(_)) && self.exit_rule() == ExitRule::Area
    }

    /// Refuses a scene that lacks a setting or has one that does not apply.
    fn check_what_is_missing(&self, s: &GivenSettings) -> Result<(), SceneError> {
        let (filter, network) = (&self.filter, &self.network);
        let guessed_or_given =
            filter.curve.is_some() || filter.library.is_some() || filter.estimate.is_some();
        let of_network = network.file.is_some() || network.packing.is_some();
        if !guessed_or_given && !of_network && self.packing.is_none() {
            return Err(s.clash(
                "the filter's constrictions are missing: filter.density = \"loose\" (or \"intermediate\", \
                 \"dense\") packs its grains; filter.library = \"loose\" takes them from the library of \
                 packings; filter.curve names a shipped curve, or a CSV file with \
                 percent_smaller,diameter_mm",
            ));
        }
        if filter.measured.is_some() && (self.packing.is_none() || filter.grains_per_void.is_none()) {
            return Err(s.clash(
                "filter.measured goes with filter.grains_per_void, and filter.density or filter.friction",
            ));
        }
        self.check_network(s)?;
        let base = &self.base;
        if base.cu.is_none() && base.sieve.is_none() && base.single_mm.is_none() {
            return Err(
                s.clash("the base is missing: give base.cu (with D85B), base.sieve or base.single_mm")
            );
        }
        if base.cu.is_some() && base.d85().is_none() {
            return Err(s.clash("base.cu needs one of base.d85_mm, base.d85_at_dc, base.d15f_over_d85b"));
        }
        if s.has("stop.most_replicates") && self.stop.is_unset() {
            return Err(s.clash(
                "stop.most_replicates says nothing without stop.target_error_pp or stop.decide_percent",
            ));
        }
        self.packing_spec().map(drop)
    }

    /// Refuses a network that mixes lattice and graph, and an exit rule that it does not allow.
    fn check_network(&self, s: &GivenSettings) -> Result<(), SceneError> {
        let graph = self.network.kind == Some(NetworkMadeOf::Graph);
        let wrong = |names: &[&str], problem: &str| match names.iter().find(|name| s.has(name)) {
            Some(name) => Err(s.clash(format!("{name} {problem}"))),
            None => Ok(()),
        };
        if graph {
            wrong(
                &["network.nx", "network.ny", "network.nz", "network.connectivity", "network.file"],
                "does not go with network.kind = \"graph\": a packing has its voids where they are",
            )?;
            wrong(&["walk.conductance_exponent"], "is for a lattice: a packing's voids conduct as they do")?;
            if self.network.packing.is_some() {
                let problem = "says what the constrictions are, but network.packing brings its own: keep one";
                wrong(&["filter.curve", "filter.library", "filter.estimate"], problem)?;
                // A run keeps the grains of the filter that it packed, and states both.
                if self.filter.measured.is_none() {
                    wrong(&["filter.density", "filter.friction"], problem)?;
                }
            }
            if self.network.packing.is_none() && self.packing.is_none() {
                return Err(s.clash(
                    "network.kind = \"graph\" needs grains: filter.density packs them, or network.packing \
                     names a file of them",
                ));
            }
        } else {
            wrong(&["network.packing", "network.copies"], "goes with network.kind = \"graph\"")?;
        }
        if self.network.file.is_some() {
            wrong(
                &["record.voids"],
                "needs to know where voids lie, which a network from a file does not say",
            )?;
        }
        let of_arrays = self.network.is_of_arrays();
        if self.network.packing.is_none() {
            wrong(&["network.cell"], "goes with network.packing")?;
            if !of_arrays {
                wrong(&["network.unit"], "goes with network.packing, or with an .npz as network.file")?;
            }
        }
        if of_arrays {
            wrong(
                &["walk.conductance_exponent"],
                "is for a lattice: arrays say what conducts, or the fourth power does",
            )?;
        }
        if self.network.file.is_some() || self.network.connectivity.is_some() {
            wrong(&["network.thickness_mm", "network.thickness_d50f"], "is for a lattice or a graph")?;
        }
        let rule = self.exit_rule();
        let allowed: &[ExitRule] = match (graph, &self.network.file, &self.network.connectivity) {
            (false, Some(_), _) if of_arrays => &[ExitRule::Flux, ExitRule::AreaAlongFlow, ExitRule::Area],
            (true, ..) => &[ExitRule::Flux, ExitRule::AreaAlongFlow, ExitRule::Height],
            (false, None, None) => &[ExitRule::Area, ExitRule::Flux, ExitRule::AreaAlongFlow],
            _ => &[ExitRule::Area],
        };
        if !allowed.contains(&rule) {
            let words: Vec<String> = allowed.iter().map(|rule| format!("\"{}\"", rule.name())).collect();
            return Err(s.refuse(
                "walk.exit",
                format!(
                    "{} on this network: {}",
                    words.join(", "),
                    match graph {
                        true =>
                            "the constrictions of a graph have no direction of their own, so that area alone \
                             leads nowhere",
                        false => "the rule needs to know which way is which",
                    }
                ),
            ));
        }
        if !rule.needs_flow() {
            wrong(
                &["walk.rho", "walk.flow_tolerance", "walk.conductance_exponent"],
                "says nothing where no water flows: walk.exit",
            )?;
        }
        if self.leaves_openings() {
            wrong(
                &["walk.rho", "walk.conductance_exponent"],
                "says nothing where walk.blocked is \"open\": what openings conduct follows from the fourth \
                 power of their size",
            )?;
            if matches!(self.walk.engine, Engine::Counts | Engine::Expected) {
                let problem = format!(
                    "\"particles\" or \"auto\": where walk.blocked is \"open\" any particle may be stopped, \
                     and \"{}\" counts those that cannot be",
                    self.walk.engine.name()
                );
                return Err(s.refuse("engine", problem));
            }
        }
        match self.law().filter(|law| law.of_concentration) {
            None => {
                wrong(&["walk.concentration"], "says nothing without a law of arching that depends on it")
            }
            Some(law) if self.exits.concentration.is_none() => Err(s.clash(format!(
                "walk.concentration is missing: \"{}\" depends on the solids fraction of the suspension that \
                 enters the filter (volume of particles by volume of suspension), {}",
                law.name,
                concentrations()
            ))),
            Some(_) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
