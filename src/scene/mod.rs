//! A scene: one base-filter combination and how it is to be walked, as the user states it.
//!
//! Every setting is declared once, in `keys` or by the stage that it belongs to ([`StopRule`], packing's
//! [`Settings`](crate::packing::Settings)); a [`Scene`] holds them all. From those declarations follow the
//! commented text of [`Scene::init_text`], what may be set, what is refused, and the resolved scene that a
//! run writes and is known by. Which settings exclude each other stands in `groups`. The names are a
//! contract.

mod cover;
mod groups;
mod init;
mod keys;
mod meaning;
mod packing_keys;
mod reference;
mod tables;

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use serde::Serialize;

pub use crate::schema::{Origin, SceneError};
pub use keys::{
    About, Base, CurveSource, Density, ExitKeys, Filter, FilterPacking, LibraryDensity, NetworkKeys,
    NetworkMadeOf, Record, Regrade, SheetUnits, WalkKeys,
};
pub use meaning::{
    Amount, BaseGradation, D85, Extent, FilterGradation, NetworkSource, PackingSpec, USUAL_LAYERS,
};
pub use packing_keys::PackingKeys;
pub use reference::{ExclusiveSettings, SceneReference, SectionReference, SettingReference, WayReference};
pub use tables::{TableOptions, keep_soils, quoted, refuse_exchanged};

use crate::network::ExitRule;
use crate::outcome::stopping::StopRule;
use crate::schema::{GivenSettings, KeyInfo, Names};
use crate::walk::{BlockedAs, Concentration, Engine, Law};
use packing_keys::packing_keys;

/// What errors call the built-in scene.
const BUILT_IN_NAME: &str = "built-in scene";

/// A scene: every setting with its value, given or by default, each checked by itself and against the others.
///
/// ```
/// let scene = voidwalk::Scene::built_in(&["base.cu=3".into(), "network.nz=30".into()]).unwrap();
/// assert_eq!((scene.base.cu, scene.network.nz), (Some(3.0), Some(30)));
/// let again = voidwalk::Scene::parse(scene.to_toml().as_bytes(), "again.toml", &[]).unwrap();
/// assert_eq!(again.to_toml(), scene.to_toml());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// What errors call it.
    #[serde(skip)]
    pub name: String,
    /// Seed, engine, replicates and the like: the settings without a section.
    #[serde(flatten)]
    pub walk: WalkKeys,
    /// When to stop adding replicates, where more than those may be needed.
    #[serde(skip_serializing_if = "StopRule::is_unset")]
    pub stop: StopRule,
    /// The filter.
    pub filter: Filter,
    /// How the filter is packed, where it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub packing: Option<PackingKeys>,
    /// The base soil.
    pub base: Base,
    /// How particles choose their way.
    #[serde(rename = "walk", skip_serializing_if = "ExitKeys::is_unset")]
    pub exits: ExitKeys,
    /// The network.
    pub network: NetworkKeys,
    /// What to keep.
    pub record: Record,
    /// What the first page of the report says besides.
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

    /// The built-in scene as commented TOML: what `voidwalk init` writes, with every setting there is.
    pub fn init_text() -> String {
        init::text()
    }

    /// The same for programs: every setting with its type, default and what is allowed.
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

    /// A scene from TOML text; `name` stands for the file in errors, and paths are taken as they are.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn parse(bytes: &[u8], name: &str, assignments: &[String]) -> Result<Self, SceneError> {
        Self::assigned(GivenSettings::parse(bytes, name, PathBuf::new(), &NAMES)?, assignments)
    }

    /// The scene of a plan's case: the built-in scene or one from a file, with the case's settings, those
    /// stated together in one list each.
    ///
    /// # Errors
    /// As [`Scene::read`].
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

    /// How the filter of a file is to be packed; a scene will do, of which nothing else is looked at.
    ///
    /// # Errors
    /// As [`Scene::read`], or neither density nor friction is given.
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

    /// How the filter is to be packed, where it is.
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

    /// Refuses a scene that leaves a question open, or answers one that is not asked.
    fn check_what_is_missing(&self, s: &GivenSettings) -> Result<(), SceneError> {
        let filter = &self.filter;
        if filter.curve.is_none()
            && filter.library.is_none()
            && filter.estimate.is_none()
            && self.packing.is_none()
            && self.network.file.is_none()
            && self.network.packing.is_none()
        {
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

    /// Refuses a network that is half a lattice and half a graph, and an exit rule that does not go with it.
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
                let own = "says what the constrictions are, but network.packing brings its own: keep one";
                wrong(&["filter.curve", "filter.library", "filter.estimate"], own)?;
                // A run keeps the grains of the filter that it packed, and says both.
                if self.filter.measured.is_none() {
                    wrong(&["filter.density", "filter.friction"], own)?;
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
                &["walk.rho", "walk.conductance_exponent"],
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
        if !self.law().is_some_and(|law| law.of_concentration) {
            wrong(&["walk.concentration"], "says nothing without a law of arching that depends on it")?;
        }
        if !self.concentration_is_by_void() {
            wrong(&["walk.arch_size"], "says nothing unless walk.concentration is \"by-void\"")?;
        } else if !matches!(self.network.source(), NetworkSource::Cubic(_)) {
            let problem = "a part from 0 to 0.64: \"by-void\" needs the voids of a lattice, which are all of \
                           one volume";
            return Err(s.refuse("walk.concentration", problem));
        }
        Ok(())
    }

    /// Whether blocked constrictions leave openings.
    pub fn leaves_openings(&self) -> bool {
        self.exits.blocked == Some(BlockedAs::Open)
    }

    /// The law by which particles arch, where they do.
    pub fn law(&self) -> Option<&'static Law> {
        self.exits.arching?.law()
    }

    /// Whether laws of arching go by the concentration that the walk brings into each void.
    pub fn concentration_is_by_void(&self) -> bool {
        matches!(self.exits.concentration, Some(Concentration::Walked(_)))
    }

    /// How particles choose among the exits of a void.
    pub fn exit_rule(&self) -> ExitRule {
        self.exits.exit.unwrap_or(match self.network.kind {
            Some(NetworkMadeOf::Graph) => ExitRule::Flux,
            _ if self.network.is_of_arrays() => ExitRule::Flux,
            _ => ExitRule::Area,
        })
    }

    /// Whether particles walk the directed cubic lattice, and choose among its exits by area.
    pub fn is_lattice_by_area(&self) -> bool {
        matches!(self.network.source(), NetworkSource::Cubic(_)) && self.exit_rule() == ExitRule::Area
    }

    /// Gives the settings that follow from others their values, so that the scene says all that it means.
    fn fill_in(&mut self) {
        self.filter.fill_in();
        self.base.fill_in();
        self.network.fill_in();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::Connectivity;

    fn built_in(assignments: &[&str]) -> Result<Scene, SceneError> {
        Scene::built_in(&assignments.iter().map(ToString::to_string).collect::<Vec<_>>())
    }

    #[test]
    fn the_built_in_scene_is_what_it_says() {
        let scene = built_in(&[]).unwrap();
        assert_eq!(scene.filter.curve, Some(CurveSource::Shipped("shire2016-cu1.5-loose".into())));
        assert_eq!(scene.base.gradation(), BaseGradation::Linear { cu: 1.5, d85: D85::AtDc(5.0, None) });
        assert_eq!(scene.network.source(), NetworkSource::Cubic([40, 40, 60]));
        assert_eq!((scene.walk.seed, scene.walk.runs, scene.walk.replicates), (1, 2, 10));
        assert_eq!(scene.base.amount(), Amount::MassRatio(0.05, None));
        let text = Scene::init_text();
        assert!(text.lines().all(|line| line.len() <= 100), "{text}");
    }

    #[test]
    fn a_length_may_have_a_unit_and_is_kept_in_mm() {
        for (name, text, mm) in [
            ("filter.thickness_mm", "2ft", "609.6"),
            ("filter.joint_mm", "\"3/8in\"", "9.525"),
            ("network.thickness_mm", "0.5m", "500"),
            ("base.d85_mm", "75um", "0.075"),
        ] {
            let [said, plain] = [text, mm].map(|value| built_in(&[&format!("{name}={value}")]).unwrap());
            assert_eq!(said, plain, "{name}");
            assert!(said.to_toml().contains(mm), "{}", said.to_toml());
        }
        let wrong = built_in(&["network.thickness_mm=24 apples"]).unwrap_err().to_string();
        assert!(
            wrong.contains("`24 apples` is not allowed; a length above 0, in mm or with its unit"),
            "{wrong}"
        );
    }

    #[test]
    fn one_alternative_replaces_the_others() {
        let base = |set: &[&str]| built_in(set).unwrap().base.gradation();
        assert_eq!(base(&["base.single_mm=0.2"]), BaseGradation::Single(0.2));
        assert_eq!(base(&["base.sieve=b.csv"]), BaseGradation::Sieve("b.csv".into(), None));
        assert_eq!(
            base(&["base.cu=3", "base.d15f_over_d85b=6.5"]),
            BaseGradation::Linear { cu: 3.0, d85: D85::Ratio(6.5) }
        );
        assert_eq!(built_in(&["base.n_base=2e8"]).unwrap().base.amount(), Amount::Number(200_000_000));
        let network = |set: &[&str]| built_in(set).unwrap().network.source();
        assert_eq!(network(&["network.file=n.csv"]), NetworkSource::File("n.csv".into()));
        let table_3 = NetworkSource::Connected([8, 40, 60], Connectivity::table_3());
        assert_eq!(network(&["network.connectivity=table3", "network.nx=8"]), table_3);
    }

    /// What is said in one breath does not replace itself.
    #[test]
    fn alternatives_that_are_set_together_are_refused() {
        for (set, message) in [
            (
                ["base.single_mm=0.2", "base.cu=3"],
                "--set: base.cu and base.single_mm both give the base: keep one",
            ),
            (
                ["base.d85_mm=1", "base.d85_at_dc=5"],
                "--set: base.d85_mm and base.d85_at_dc both set D85B: keep one",
            ),
            (
                ["base.d85_at_dc=5", "base.d85_mm=1"],
                "--set: base.d85_mm and base.d85_at_dc both set D85B: keep one",
            ),
            (
                ["network.nx=8", "network.file=n.csv"],
                "network.nx and network.file both give the network: keep one",
            ),
        ] {
            assert!(
                built_in(&set).unwrap_err().to_string().contains(message),
                "{set:?}: {:?}",
                built_in(&set)
            );
        }
        // The file's are replaced all the same, and the same setting twice is as on any command line.
        let text = b"[filter]\ncurve = \"a.csv\"\nd0_mm = 2\n[base]\ncu = 2\nd85_mm = 1\n";
        let set = ["base.d15f_over_d85b=3", "filter.sieve=f.csv", "base.d15f_over_d85b=4"].map(String::from);
        let scene = Scene::parse(text, "s.toml", &set).unwrap();
        assert_eq!(scene.base.gradation(), BaseGradation::Linear { cu: 2.0, d85: D85::Ratio(4.0) });
        assert_eq!(scene.filter.d0_mm, None);
    }

    #[test]
    fn what_is_written_is_the_whole_scene() {
        for set in [
            vec![],
            vec!["seed=18446744073709551615", "stop.decide_percent=99.9", "inject_share=0.02"],
            vec!["filter.density=dense", "filter.cu=3", "packing.grains=500", "packing.drag=0.04"],
            vec!["filter.friction=0.2", "filter.sieve=f.csv", "filter.d0_mm=0.1"],
            vec!["about.project=Dam, \"zone\" 2B", "about.client=Größe & Co."],
            vec!["filter.estimate=0.5", "base.sieve=b.csv", "base.regrade=practice", "record.sensitivity=[]"],
            vec!["base.n_base=1e6"],
            vec!["base.dc_curve=cu3-loose", "base.cap=2e8", "network.connectivity={5=50, 7=50}"],
            vec!["network.file=n.csv", "sampling=stratified", "engine=expected"],
        ] {
            let scene = built_in(&set).unwrap();
            let text = scene.to_toml();
            let again =
                Scene::parse(text.as_bytes(), &scene.name, &[]).unwrap_or_else(|e| panic!("{text}{e}"));
            assert_eq!(again, scene, "{text}");
        }
    }

    /// A shell removes the quotes of what looks like a number or a date.
    #[test]
    fn what_a_cover_says_is_a_text_on_the_command_line_and_in_quotes_in_a_file() {
        let cover = |set: &[&str]| built_in(set).unwrap().about.cover();
        let stated = cover(&["about.date=2020-01-01", "about.revision=1", "about.number=true"]);
        let said = [stated.date, stated.revision, stated.number];
        assert_eq!(said.map(Option::unwrap), ["2020-01-01", "1", "true"]);
        assert_eq!(cover(&["about.revision=\"1\""]).revision.as_deref(), Some("1"));
        let of_file = Scene::parse(b"[about]\nrevision = 1\n", "s.toml", &[]).unwrap_err().to_string();
        assert!(of_file.contains("a text in quotes"), "{of_file}");
    }

    #[test]
    fn a_distribution_of_connectivity_is_given_by_name_or_as_a_table() {
        let of = |network: &str| {
            let text = format!("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\n{network}");
            Scene::parse(text.as_bytes(), "s.toml", &[]).map(|scene| scene.network.source())
        };
        let table_3 = NetworkSource::Connected([40, 40, 60], Connectivity::table_3());
        assert_eq!(of("[network]\nconnectivity = \"table3\"").unwrap(), table_3);
        for text in [
            "[network]\nnx = 5\nconnectivity = { 5 = 50, 7 = 50.0 }",
            "[network]\nnx = 5\n[network.connectivity]\n7 = 50\n5 = 50",
        ] {
            let expected = Connectivity::new(&[(5, 50.0), (7, 50.0)]).unwrap();
            assert_eq!(of(text).unwrap(), NetworkSource::Connected([5, 40, 60], expected));
        }
        for (text, message) in [
            (
                "connectivity = \"table4\"",
                "s.toml, line 6, network.connectivity: `table4` is not allowed; \"table3\"",
            ),
            (
                "connectivity = { 6 = 90 }",
                "`{ 6 = 90 }` is not allowed; \"table3\", or percentages that sum to 100",
            ),
            ("connectivity = { six = 100 }", "`{ six = 100 }` is not allowed; \"table3\", or percent"),
            ("connectivity = { 6 = \"all\" }", "is not allowed; \"table3\", or percent"),
            ("connectivity = { 1 = 100 }", "from 2"),
            ("connectivity = [6, 100]", "is not allowed"),
            ("connectivity = \"table3\"\nfile = \"n.csv\"", "keep one"),
        ] {
            let error = of(&format!("[network]\n{text}")).unwrap_err().to_string();
            assert!(error.starts_with("s.toml") && error.contains(message), "{text}: {error}");
        }
    }

    #[test]
    fn values_out_of_range_and_clashes_are_refused() {
        for (set, message) in [
            ("seed=-1", "a whole number from 0"),
            ("engine=warp", "\"auto\", \"particles\", \"counts\" or \"expected\""),
            ("stop.decide_percent=100", "a probability from 50 to 99.999"),
            ("stop.target_error_pp=0", "percentage points of the base"),
            ("stop.most_replicates=1", "2 to 100000"),
            ("sampling=sobol", "\"independent\" or \"stratified\""),
            ("runs=3", "a whole number from 1 to 2"),
            ("replicates=0", "from 1 to"),
            ("inject_share=0", "a whole number of equal parts"),
            ("inject_share=0.7", "a whole number of equal parts"),
            ("inject_share=1e-12", "from 0.000001"),
            ("filter.curve=3", "in quotes"),
            ("filter.grains_per_void=0", "above 0"),
            ("base.cu=0.5", "from 1 to 1000"),
            ("base.d85_at_dc=101", "from 0 to 100"),
            ("base.n_base=0", "from 1 to"),
            ("base.n_base=1.5", "whole number"),
            ("base.mass_ratio=inf", "above 0"),
            ("network.nx=0", "from 1 to"),
            ("network.nx=1e10", "from 1 to"),
            ("record.size_curves=[0]", "increments, from 1"),
            ("base.regrade=yes", "\"practice\" or \"no\""),
            ("filter.thickness_mm=0", "above 0"),
            ("base.d0_mm=1", "goes with base.sieve"),
            ("about.client=[3]", "a text in quotes, one line of at most 120 characters"),
            ("about.units=1", "\"us\""),
            ("about.client=\" \"", "a text in quotes, one line"),
            ("about.author=\"a\\nb\"", "a text in quotes, one line"),
            ("about.project=turned \u{202e}", "characters that are seen"),
            ("bas.cu=2", "did you mean `base.cu`"),
            ("filter.density=tight", "\"medium\" or \"intermediate\" (0.1), or \"loose\" (0.3)"),
            ("packing.drag=1", "packing.drag goes with filter.density or filter.friction"),
            ("filter.density=medium", "filter.cu or filter.sieve is missing"),
            ("filter.density=loose", "filter.cu or filter.sieve is missing"),
        ] {
            let error = built_in(&[set]).unwrap_err().to_string();
            assert!(error.contains(message), "{set}: {error}");
        }
        for (text, message) in [
            ("[base]\ncu = 2", "constrictions are missing: filter.density = \"loose\""),
            ("[filter]\ncurve = \"a.csv\"", "the base is missing"),
            ("[filter]\ncurve = \"a.csv\"\n[base]\ncu = 2", "needs one of base.d85_mm"),
            ("[filter]\ncurve = \"a.csv\"\n[base]\ncu = 2\nsingle_mm = 1", "keep one"),
            ("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\nd85_mm = 1", "goes with base.cu"),
            ("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\nn_base = 5\ncap = 3", "base.cap goes with"),
            (
                "[filter]\ncurve = \"a.csv\"\ndensity = \"loose\"",
                "both say what the filter's constrictions are",
            ),
            (
                "[filter]\nfriction = 99\ncu = 2\n[base]\nsingle_mm = 1",
                "filter.friction: `99` is not allowed",
            ),
        ] {
            let error = Scene::parse(text.as_bytes(), "s.toml", &[]).unwrap_err().to_string();
            assert!(error.starts_with("s.toml") && error.contains(message), "{text}: {error}");
        }
    }
}
