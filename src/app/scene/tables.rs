//! Scene of two sieve tables, for a user who names only a base and a filter.

use std::path::Path;

use super::values::{Density, LibraryDensity};
use super::{Origin, Scene, SceneError};
use voidwalk_core::schema::setting_name;
use voidwalk_practice::PairOptions;

/// Options for a scene of two tables.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableOptions {
    /// Density of the filter. Its constrictions come from the library of packings; without a density, and
    /// if `changes` do not define the constrictions, both loose and dense are walked.
    pub density: Option<Density>,
    /// True to pack the filter itself, loose unless a density is given.
    pub pack: bool,
    /// True for a first look with fewer replicates.
    pub quick: bool,
    /// True to walk the base as sampled. Otherwise a base in a table is walked as regraded by filter
    /// practice, unless `changes` contain `base.regrade`.
    pub as_sampled: bool,
    /// True to accept base and filter as given, though their sizes look exchanged.
    pub as_given: bool,
    /// Further settings, as `name=value`; they override the other options.
    pub changes: Vec<String>,
}

/// Number of replicates of a first look.
const QUICK: u64 = 5;

/// Settings that define the filter's constrictions.
const CONSTRICTIONS: [&str; 7] = [
    "filter.curve",
    "filter.density",
    "filter.friction",
    "filter.library",
    "filter.estimate",
    "network.file",
    "network.packing",
];
const REPLICATES: [&str; 3] = ["replicates", "stop.target_error_pp", "stop.decide_percent"];
/// Settings that describe the filter's own packing.
const PACKED: [&str; 2] = ["filter.density", "filter.friction"];
const BASE: [&str; 3] = ["base.sieve", "base.cu", "base.single_mm"];
const FILTER: [&str; 2] = ["filter.sieve", "filter.cu"];
/// Settings that no sieve table gives and that rules of practice depend on.
const OF_RULES: [&str; 2] = ["base.dispersive", "filter.joint_mm"];

impl TableOptions {
    /// Setting to walk a base as sampled.
    pub(crate) const AS_SAMPLED: &str = "base.regrade=\"no\"";

    /// Settings that express these options. Errors: [`SceneError::Clash`]: a change also sets the density or
    /// the regrading of the base.
    fn settings(&self) -> Result<Vec<String>, SceneError> {
        let twice = |names: String| Err(clash(format!("{names} say the same thing twice: give one")));
        if let (Some(density), true) = (self.density, self.is_set(&["filter.density", "filter.library"])) {
            return twice(format!("density {} and filter.density or filter.library", density.name()));
        }
        let regrade = match (self.as_sampled, self.is_set(&["base.regrade"])) {
            (true, true) => return twice("--as-sampled and base.regrade".into()),
            (true, false) => Some(Self::AS_SAMPLED.into()),
            (false, false) => Some("base.regrade=\"practice\"".into()),
            (false, true) => None,
        };
        let replicates = self.quick && !self.is_set(&REPLICATES);
        let replicates = replicates.then(|| format!("replicates={QUICK}"));
        let settings = self.density_setting().into_iter().chain(replicates).chain(regrade);
        Ok(settings.chain(self.changes.iter().cloned()).collect())
    }

    /// Setting of the density: of the filter's own packing, which is loose if nothing else is stated, or
    /// of the library, where it is unknown if no setting defines the constrictions.
    pub(crate) fn density_setting(&self) -> Option<String> {
        let (name, usual, stated): (_, _, &[&str]) = match self.pack {
            true => ("density", Density::Loose.name(), &PACKED),
            false => ("library", LibraryDensity::Unknown.name(), &CONSTRICTIONS),
        };
        let density = self.density.map_or(usual, Density::name);
        let is_needed = self.density.is_some() || !self.is_set(stated);
        is_needed.then(|| format!("filter.{name}=\"{density}\""))
    }

    /// Inputs of the rules of practice other than the two tables. Errors: a value is not allowed.
    pub(crate) fn of_rules(&self) -> Result<PairOptions, SceneError> {
        let is_one = |change: &&String| OF_RULES.contains(&setting_name(change));
        let stated: Vec<String> = self.changes.iter().filter(is_one).cloned().collect();
        let scene = Scene::built_in(&stated)?;
        Ok(PairOptions {
            dispersive: scene.base.dispersive == Some(true),
            joint_mm: scene.filter.joint_mm,
            as_given: self.as_given,
        })
    }

    fn is_set(&self, names: &[&str]) -> bool {
        set_among(&self.changes, names).is_some()
    }
}

impl Scene {
    /// Scene of a base and a filter that are sieve tables (`FILE#NAME` for one of several soils); all
    /// other settings come from the built-in scene. Reads no file.
    ///
    /// # Errors
    /// See [`Scene::built_in`]; also if a change would replace one of the two, or if a name is not UTF-8.
    pub fn of_tables(base: &Path, filter: &Path, options: &TableOptions) -> Result<Self, SceneError> {
        let [named_base, named_filter] = [base, filter].map(|path| path.display().to_string());
        keep_soils(&options.changes, Some(&named_base), Some(&named_filter))?;
        let mut settings = Vec::new();
        for (name, path) in [("filter.sieve", filter), ("base.sieve", base)] {
            settings.push(format!("{name}={}", quoted(path)?));
        }
        // A pair is judged as given; other amounts and thicknesses are a research question.
        settings.push("record.sensitivity=[]".into());
        let changes = options.settings()?;
        let mut scene = Self::built_in(&[&settings[..], &changes].concat())?;
        // The scatter of millions of passive particles is negligible, and their expectation is fast;
        // there is no expectation if blocked constrictions leave openings.
        if !scene.leaves_openings() {
            settings.push("engine=\"expected\"".into());
            scene = Self::built_in(&[settings, changes].concat())?;
        }
        scene.is_guarded = !options.as_given;
        Ok(scene)
    }
}

/// Refuses settings that would replace a soil that is also named: results would then belong to the wrong
/// soil. Errors: [`SceneError::Clash`] names the setting and the soil.
pub(crate) fn keep_soils(
    changes: &[String],
    base: Option<&str>,
    filter: Option<&str>,
) -> Result<(), SceneError> {
    for (role, named, names) in [("base", base, &BASE[..]), ("filter", filter, &FILTER)] {
        if let (Some(named), Some(name)) = (named, set_among(changes, names)) {
            return Err(clash(format!(
                "{name} would put another soil in the place of the {role}, {named}: name the other instead, \
                 or leave {name} out"
            )));
        }
    }
    Ok(())
}

fn clash(problem: String) -> SceneError {
    SceneError::Clash { file: Origin::CommandLine.to_string(), problem }
}

/// First of these settings among the changes.
fn set_among<'a>(changes: &[String], names: &[&'a str]) -> Option<&'a str> {
    let is_set = |name: &str| changes.iter().any(|change| setting_name(change) == name);
    names.iter().copied().find(|name| is_set(name))
}

/// Path as a TOML string, so that one like `1e5` remains a name.
pub(crate) fn quoted(path: &Path) -> Result<String, SceneError> {
    let text = path.to_str().ok_or_else(|| SceneError::Clash {
        file: path.display().to_string(),
        problem: "its name is not UTF-8 text; give it another".into(),
    })?;
    Ok(toml::Value::String(text.to_owned()).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Regrade;
    use voidwalk_core::walk::Engine;

    fn scene(options: &TableOptions) -> Result<Scene, SceneError> {
        Scene::of_tables(Path::new("1e5"), Path::new("a \"b\".xlsx#Filter A"), options)
    }

    fn refused(options: &TableOptions) -> String {
        scene(options).unwrap_err().to_string()
    }

    fn with(changes: &[&str]) -> TableOptions {
        TableOptions { changes: changes.iter().map(ToString::to_string).collect(), ..Default::default() }
    }

    #[test]
    fn two_names_are_a_scene() {
        let scene = scene(&TableOptions::default()).unwrap();
        assert_eq!(scene.filter.sieve.as_deref(), Some(Path::new("a \"b\".xlsx#Filter A")));
        assert_eq!(scene.base.sieve.as_deref(), Some(Path::new("1e5")));
        let filter = &scene.filter;
        assert_eq!((&filter.curve, filter.estimate, filter.cu), (&None, None, None));
        assert_eq!(filter.library, Some(LibraryDensity::Unknown));
        assert_eq!((scene.base.cu, scene.walk.replicates), (None, 10));
    }

    /// The notation does not matter; a requested engine takes precedence.
    #[test]
    fn the_engine_follows_from_what_blocked_constrictions_are() {
        let engine = |changes: &[&str]| scene(&with(changes)).unwrap().walk.engine;
        assert_eq!([engine(&[]), engine(&["walk.blocked=closed"])], [Engine::Expected; 2]);
        for open in ["walk.blocked=open", "walk.blocked='open'", " walk.blocked = \"open\" "] {
            assert_eq!(engine(&[open]), Engine::Auto, "{open}");
        }
        assert_eq!(engine(&["engine=auto"]), Engine::Auto);
        assert!(scene(&with(&["walk.blocked='open'", "engine=expected"])).is_err());
    }

    #[test]
    fn a_base_in_a_table_is_walked_as_practice_regrades_it_unless_it_is_said_otherwise() {
        let regrade = |options: &TableOptions| scene(options).unwrap().base.regrade;
        assert_eq!(regrade(&with(&[])), Some(Regrade::Practice));
        assert_eq!(regrade(&TableOptions { as_sampled: true, ..with(&[]) }), Some(Regrade::No));
        for (set, wanted) in [("base.regrade=no", Regrade::No), ("base.regrade=practice", Regrade::Practice)]
        {
            assert_eq!(regrade(&with(&[set])), Some(wanted), "{set}");
            let twice = TableOptions { as_sampled: true, ..with(&[set]) };
            assert!(refused(&twice).contains("say the same thing twice"));
        }
    }

    #[test]
    fn a_density_is_one_of_the_library_unless_it_is_packed_and_changes_go_before_all() {
        let dense = TableOptions { density: Some(Density::Dense), ..Default::default() };
        let looked_up = scene(&dense).unwrap();
        assert!(looked_up.packing.is_none() && looked_up.filter.library == Some(LibraryDensity::Dense));
        let packed = scene(&TableOptions { pack: true, ..dense }).unwrap();
        assert!(packed.packing.is_some() && packed.filter.density == Some(Density::Dense));
        let loose = scene(&TableOptions { pack: true, ..Default::default() }).unwrap();
        assert_eq!((loose.filter.density, loose.filter.library), (Some(Density::Loose), None));
        let rough = scene(&TableOptions { pack: true, ..with(&["filter.friction=0.2"]) }).unwrap();
        assert_eq!((rough.filter.density, rough.filter.friction), (None, Some(0.2)));
        let given = scene(&with(&["filter.curve=cu3-loose", "replicates=3"])).unwrap();
        assert!(given.filter.estimate.is_none() && given.walk.replicates == 3);
        let both = TableOptions { density: Some(Density::Loose), ..with(&["filter.estimate=1"]) };
        assert!(refused(&both).contains("both say what the filter's constrictions"));
        for set in ["filter.density=dense", "filter.library=dense"] {
            let twice = TableOptions { density: Some(Density::Loose), ..with(&[set]) };
            assert!(refused(&twice).contains("say the same thing twice"), "{set}");
        }
        let odd = refused(&with(&["base.uc=3"]));
        assert!(odd.contains("there is no setting `base.uc`"), "{odd}");
    }

    #[test]
    fn rules_are_told_of_dispersion_and_joints_by_the_same_settings_as_walks() {
        let told = with(&["base.dispersive=true", "filter.joint_mm=1/8in", "filter.d0_mm=2"]).of_rules();
        assert_eq!(told.unwrap(), PairOptions { dispersive: true, joint_mm: Some(3.175), as_given: false });
        assert_eq!(with(&["base.dispersive=false"]).of_rules().unwrap(), PairOptions::default());
        let refused = with(&["filter.joint_mm=wide"]).of_rules().unwrap_err().to_string();
        assert!(refused.contains("filter.joint_mm: `wide` is not allowed"), "{refused}");
    }

    #[test]
    fn no_change_replaces_a_soil_that_is_named() {
        for change in [
            "base.sieve=\"other.csv\"",
            " base.sieve = other",
            "base.cu=2",
            "base.single_mm=0.2",
            "filter.cu=3",
        ] {
            let message = refused(&with(&[change]));
            assert!(message.contains("would put another soil in the place of the"), "{change}: {message}");
        }
        let message = refused(&with(&["filter.sieve=b.csv"]));
        let words = "in the place of the filter, a \"b\".xlsx#Filter A: name the other";
        assert!(message.contains(words), "{message}");
        assert!(scene(&with(&["base.d0_mm=0.01", "filter.d0_mm=0.1", "base.mass_ratio=0.1"])).is_ok());
        assert!(keep_soils(&["base.cu=2".into()], None, Some("f")).is_ok());
    }

    #[test]
    fn a_pair_is_walked_with_another_amount_or_thickness_where_that_is_set_alone() {
        let studies = |sets: &[&str]| {
            let record = scene(&with(sets)).unwrap().record;
            (record.sensitivity, record.thickness)
        };
        assert_eq!(studies(&[]), (Vec::new(), None));
        assert_eq!(studies(&["record.sensitivity=[2]"]), (vec![2.0], None));
        assert_eq!(studies(&["record.thickness=[0.5]"]), (Vec::new(), Some(vec![0.5])));
    }

    #[test]
    fn a_quick_look_walks_fewer_replicates_of_the_same_model() {
        let quick = scene(&TableOptions { quick: true, ..with(&[]) }).unwrap();
        assert_eq!(quick.walk.replicates, QUICK);
        let whole = scene(&with(&[])).unwrap();
        assert_eq!(quick.network, whole.network);
        let told = scene(&TableOptions { quick: true, ..with(&["replicates=7"]) }).unwrap();
        assert_eq!(told.walk.replicates, 7);
    }
}
