//! A scene: one base-filter combination and how it is to be walked, as the user states it.
//!
//! The names of the settings are a contract; `src/data/scene.toml` shows them with what they mean.

use std::path::{Path, PathBuf};

mod names;
mod network_source;
mod recipe;
mod settings;

use crate::outcome::Wanted;
use crate::outcome::stopping::StopRule;
use crate::walk::{Engine, Sampling};
use names::NAMES;
pub use network_source::NetworkSource;
pub use recipe::{DENSITIES, PackingSpec};
pub use settings::{Origin, SceneError, Settings};

/// The built-in scene, commented.
pub const BUILT_IN: &str = include_str!("../data/scene.toml");

/// What errors call the built-in scene.
const BUILT_IN_NAME: &str = "built-in scene";

/// The filter's gradation by mass.
#[derive(Clone, Debug, PartialEq)]
pub enum FilterGradation {
    /// Straight on semi-log paper from `d0_mm`; `cu` from the shipped curve where it is not given.
    Linear {
        /// Smallest grain (mm).
        d0_mm: f64,
        /// D60 / D10.
        cu: Option<f64>,
    },
    /// A sieve table, and where its open tail ends.
    Sieve(PathBuf, Option<f64>),
}

/// The base's gradation by mass.
#[derive(Clone, Debug, PartialEq)]
pub enum BaseGradation {
    /// Straight on semi-log paper with a given D85B.
    Linear {
        /// D60 / D10.
        cu: f64,
        /// What sets D85B.
        d85: D85,
    },
    /// A sieve table, and where its open tail ends.
    Sieve(PathBuf, Option<f64>),
    /// One size (mm).
    Single(f64),
}

/// What sets D85B.
#[derive(Clone, Debug, PartialEq)]
pub enum D85 {
    /// A length (mm).
    Mm(f64),
    /// Dc at this percent of the filter's constriction curve, or of another one.
    AtDc(f64, Option<CurveSource>),
    /// D15F over this ratio.
    Ratio(f64),
}

/// Where a constriction curve comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveSource {
    /// A filter that comes with the program.
    Shipped(String),
    /// A CSV file.
    File(PathBuf),
}

/// How many base particles.
#[derive(Clone, Debug, PartialEq)]
pub enum Amount {
    /// Mass of base over mass of filter, Eq. (2), and a cap.
    MassRatio(f64, Option<u64>),
    /// The number itself.
    Number(u64),
}

/// A scene, each value checked on its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What errors call it.
    pub name: String,
    /// The user's seed.
    pub seed: u64,
    /// Which engine walks.
    pub engine: Engine,
    /// 1 or 2.
    pub runs: u64,
    /// New network and new walk each; the first look's number where a rule adds more.
    pub replicates: u64,
    /// When to stop adding replicates, where more than that may be needed.
    pub stop: StopRule,
    /// Share of the base inserted in each increment.
    pub inject_share: f64,
    /// How start nodes and sizes of the base particles are drawn.
    pub sampling: Sampling,
    /// The filter's constriction curve; missing where the filter is to be packed, or a network is read from a file.
    pub curve: Option<CurveSource>,
    /// How the filter is to be packed, where it is.
    pub recipe: Option<PackingSpec>,
    /// Relative density at which circles inscribed between touching grains stand for its constrictions, where they do.
    pub estimate: Option<f64>,
    /// The filter's gradation.
    pub filter: FilterGradation,
    /// Filter grains per void; from the shipped curve where it is not given.
    pub grains_per_void: Option<f64>,
    /// The base's gradation.
    pub base: BaseGradation,
    /// How much base.
    pub amount: Amount,
    /// The network.
    pub network: NetworkSource,
    /// What to keep.
    pub wanted: Wanted,
    /// Multiples of N_base at which the verdict is shown, and replicates of each.
    pub sensitivity: (Vec<f64>, u64),
}

impl Scene {
    /// The built-in scene, with `name=value` settings applied.
    ///
    /// # Errors
    /// A setting that does not exist or is not allowed.
    pub fn built_in(assignments: &[String]) -> Result<Self, SceneError> {
        let settings = Settings::parse(BUILT_IN.as_bytes(), BUILT_IN_NAME, PathBuf::new(), &NAMES)?;
        Self::new(settings, BUILT_IN_NAME, assignments)
    }

    /// A scene from a file, with `name=value` settings applied.
    ///
    /// # Errors
    /// The file cannot be read, or a setting does not exist, is not allowed, clashes or is missing.
    pub fn read(path: &Path, assignments: &[String]) -> Result<Self, SceneError> {
        let settings = Settings::read(path, &NAMES)?;
        Self::new(settings, &path.display().to_string(), assignments)
    }

    /// A scene from TOML text; `name` stands for the file in errors.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn parse(bytes: &[u8], name: &str, assignments: &[String]) -> Result<Self, SceneError> {
        Self::new(Settings::parse(bytes, name, PathBuf::new(), &NAMES)?, name, assignments)
    }

    /// The scene of a plan's case: the built-in scene or one from a file, with the case's settings, those stated together in
    /// one list each.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn planned(
        base: Option<&Path>,
        assignments: &[Vec<String>],
        origin: &Origin,
    ) -> Result<Self, SceneError> {
        let mut s = match base {
            Some(path) => Settings::read(path, &NAMES)?,
            None => Settings::parse(BUILT_IN.as_bytes(), BUILT_IN_NAME, PathBuf::new(), &NAMES)?,
        };
        for together in assignments {
            s.set_together(together, &NAMES, origin)?;
        }
        Self::from_settings(&s, &origin.to_string())
    }

    fn new(mut s: Settings, name: &str, assignments: &[String]) -> Result<Self, SceneError> {
        for assignment in assignments {
            s.set(assignment, &NAMES)?;
        }
        Self::from_settings(&s, name)
    }

    fn from_settings(s: &Settings, name: &str) -> Result<Self, SceneError> {
        let engine = s.word("engine", Engine::ALL.map(|e| (e.name(), e)), ENGINES)?;
        let sampling = s.word("sampling", Sampling::ALL.map(|s| (s.name(), s)), SAMPLINGS)?;
        let inject_share = s.number(
            "inject_share",
            is_whole_part,
            "one part of a whole number of equal parts, from 0.000001 to 1, as 0.01 or 0.02",
        )?;
        let every = s.whole("record.series_every", 0..=u64::MAX)?;
        let curves = s.numbers(
            "record.size_curves",
            |n| n >= 1.0 && n.fract() == 0.0,
            "a list of increments, from 1",
        )?;
        let factors = s.numbers("record.sensitivity", |n| n > 0.0, "a list of numbers above 0")?;
        let filter = filter(s)?;
        Ok(Self {
            recipe: PackingSpec::new(s, &filter)?,
            estimate: s.number(
                "filter.estimate",
                |n| (0.0..=1.0).contains(&n),
                "a relative density from 0 (loose) to 1 (dense)",
            )?,
            name: name.into(),
            seed: s.whole("seed", 0..=u64::MAX)?.unwrap_or(1),
            engine: engine.unwrap_or(Engine::Auto),
            runs: s.whole("runs", 1..=2)?.unwrap_or(2),
            replicates: s.whole("replicates", 1..=100_000)?.unwrap_or(10),
            stop: stop(s)?,
            inject_share: inject_share.unwrap_or(0.01),
            sampling: sampling.unwrap_or_default(),
            curve: curve(s)?,
            filter,
            grains_per_void: positive(s, "filter.grains_per_void")?,
            base: base(s)?,
            amount: amount(s)?,
            network: NetworkSource::of(s)?,
            wanted: Wanted {
                series_every: every.unwrap_or(1),
                size_curves: match curves {
                    Some(list) => list.into_iter().map(|n| n as u64).collect(),
                    None => vec![1, 10, 50, 100],
                },
                size_classes: s.whole("record.size_classes", 1..=4096)?.unwrap_or(64) as usize,
            },
            sensitivity: (
                factors.unwrap_or_else(|| vec![0.25, 0.5, 2.0, 4.0]),
                s.whole("record.sensitivity_replicates", 1..=1000)?.unwrap_or(3),
            ),
        })
    }

    /// How the filter of a file is to be packed; a scene will do, of which nothing else is looked at.
    ///
    /// # Errors
    /// As [`Scene::read`], or neither density nor friction is given.
    pub fn recipe(path: &Path, assignments: &[String]) -> Result<PackingSpec, SceneError> {
        let mut s = Settings::read(path, &NAMES)?;
        for assignment in assignments {
            s.set(assignment, &NAMES)?;
        }
        let recipe = PackingSpec::new(&s, &filter(&s)?)?;
        recipe.ok_or_else(|| {
            s.clash("filter.density is missing: \"dense\", \"intermediate\" or \"loose\"; or filter.friction")
        })
    }

    /// The error for settings of this scene that clash.
    pub fn clash(&self, problem: impl Into<String>) -> SceneError {
        SceneError::Clash { file: self.name.clone(), problem: problem.into() }
    }
}

const ENGINES: &str = "\"auto\", \"particles\", \"counts\" or \"expected\"";

const SAMPLINGS: &str = "\"independent\" or \"stratified\"";

/// Whether a share goes into 1 a whole number of times, within a thousandth.
fn is_whole_part(share: f64) -> bool {
    let parts = 1.0 / share;
    (1e-6..=1.0).contains(&share) && (parts - parts.round()).abs() < 1e-3 * parts
}

fn stop(s: &Settings) -> Result<StopRule, SceneError> {
    let rule = StopRule {
        target_error_pp: s.number(
            "stop.target_error_pp",
            |n| n > 0.0 && n < 100.0,
            "percentage points of the base, above 0 and below 100",
        )?,
        decide_percent: s.number(
            "stop.decide_percent",
            |n| (50.0..=99.999).contains(&n),
            "a probability from 50 to 99.999 (%)",
        )?,
        most: s.whole("stop.most_replicates", 2..=100_000)?.unwrap_or(1000),
    };
    if s.has("stop.most_replicates") && !rule.is_set() {
        return Err(
            s.clash("stop.most_replicates says nothing without stop.target_error_pp or stop.decide_percent")
        );
    }
    Ok(rule)
}

fn positive(s: &Settings, name: &str) -> Result<Option<f64>, SceneError> {
    s.number(name, |n| n > 0.0, "a finite number above 0")
}

fn curve(s: &Settings) -> Result<Option<CurveSource>, SceneError> {
    if let Some(other) =
        ["filter.curve", "filter.density", "filter.friction", "network.file"].iter().find(|n| s.has(n))
        && s.has("filter.estimate")
    {
        return Err(s.clash(format!(
            "filter.estimate and {other} both say what the filter's constrictions are: keep one"
        )));
    }
    let source = named_curve(s, "filter.curve")?;
    let ways = ["filter.density", "filter.friction", "filter.estimate", "network.file"];
    if source.is_none() && !ways.iter().any(|way| s.has(way)) {
        return Err(s.clash(
            "filter.curve is missing: a shipped name, or a CSV file with percent_smaller,diameter_mm; or filter.density, for a filter to be packed",
        ));
    }
    Ok(source)
}

/// A curve by shipped name or by file name: a file name has a folder or an ending.
fn named_curve(s: &Settings, name: &str) -> Result<Option<CurveSource>, SceneError> {
    let Some(text) = s.text(name, "a shipped curve or a file name, in quotes")? else { return Ok(None) };
    let is_file =
        text.contains(['/', '\\']) || text.to_lowercase().ends_with(".csv") || text.ends_with(".txt");
    Ok(Some(match is_file {
        true => CurveSource::File(s.resolve(name, &text)),
        false => CurveSource::Shipped(text),
    }))
}

fn filter(s: &Settings) -> Result<FilterGradation, SceneError> {
    let d0_mm = positive(s, "filter.d0_mm")?;
    if let Some(path) = s.path("filter.sieve")? {
        if s.has("filter.cu") {
            return Err(s.clash("filter.sieve and filter.cu both give the gradation: keep one"));
        }
        return Ok(FilterGradation::Sieve(path, d0_mm));
    }
    let cu = s.number("filter.cu", |n| (1.0..=1000.0).contains(&n), "a number from 1 to 1000")?;
    Ok(FilterGradation::Linear { d0_mm: d0_mm.unwrap_or(1.0), cu })
}

fn base(s: &Settings) -> Result<BaseGradation, SceneError> {
    let given = |names: &[&str]| -> Vec<String> {
        names.iter().filter(|n| s.has(&format!("base.{n}"))).map(|n| format!("base.{n}")).collect()
    };
    let kinds = given(&["cu", "sieve", "single_mm"]);
    if kinds.len() != 1 {
        let problem = match kinds.is_empty() {
            true => "the base is missing: give base.cu (with D85B), base.sieve or base.single_mm".into(),
            false => format!("{} all give the base: keep one", kinds.join(" and ")),
        };
        return Err(s.clash(problem));
    }
    let sizes = given(&["d85_mm", "d85_at_dc", "d15f_over_d85b"]);
    let d0_mm = positive(s, "base.d0_mm")?;
    if kinds[0] != "base.cu" && !sizes.is_empty() {
        return Err(s.clash(format!("{} goes with base.cu, not with {}", sizes.join(" and "), kinds[0])));
    }
    if kinds[0] != "base.sieve" && d0_mm.is_some() {
        return Err(s.clash("base.d0_mm goes with base.sieve: it says where an open finest tail ends"));
    }
    if s.has("base.dc_curve") && !s.has("base.d85_at_dc") {
        return Err(s.clash("base.dc_curve goes with base.d85_at_dc"));
    }
    if let Some(path) = s.path("base.sieve")? {
        return Ok(BaseGradation::Sieve(path, d0_mm));
    }
    if let Some(size) = positive(s, "base.single_mm")? {
        return Ok(BaseGradation::Single(size));
    }
    let cu = s.number("base.cu", |n| (1.0..=1000.0).contains(&n), "a number from 1 to 1000")?.unwrap_or(1.0);
    if sizes.len() != 1 {
        return Err(s.clash(match sizes.is_empty() {
            true => "base.cu needs one of base.d85_mm, base.d85_at_dc, base.d15f_over_d85b".into(),
            false => format!("{} both set D85B: keep one", sizes.join(" and ")),
        }));
    }
    let percent = s.number("base.d85_at_dc", |n| (0.0..=100.0).contains(&n), "a percentage from 0 to 100")?;
    let d85 = match (positive(s, "base.d85_mm")?, percent, positive(s, "base.d15f_over_d85b")?) {
        (Some(mm), ..) => D85::Mm(mm),
        (_, Some(percent), _) => D85::AtDc(percent, named_curve(s, "base.dc_curve")?),
        (.., ratio) => D85::Ratio(ratio.unwrap_or(1.0)),
    };
    Ok(BaseGradation::Linear { cu, d85 })
}

fn amount(s: &Settings) -> Result<Amount, SceneError> {
    let number = s.whole("base.n_base", 1..=u64::MAX)?;
    let ratio = positive(s, "base.mass_ratio")?;
    let cap = s.whole("base.cap", 1..=u64::MAX)?;
    match (number, ratio) {
        (Some(_), Some(_)) => {
            Err(s.clash("base.n_base and base.mass_ratio both say how much base: keep one"))
        }
        (Some(_), None) if cap.is_some() => {
            Err(s.clash("base.cap goes with base.mass_ratio, not with base.n_base"))
        }
        (Some(n), None) => Ok(Amount::Number(n)),
        (None, ratio) => Ok(Amount::MassRatio(ratio.unwrap_or(0.05), cap)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built_in(assignments: &[&str]) -> Result<Scene, SceneError> {
        Scene::built_in(&assignments.iter().map(ToString::to_string).collect::<Vec<_>>())
    }

    #[test]
    fn the_built_in_scene_is_what_it_says() {
        let scene = built_in(&[]).unwrap();
        assert_eq!(scene.curve, Some(CurveSource::Shipped("shire2016-cu1.5-loose".into())));
        assert_eq!(scene.base, BaseGradation::Linear { cu: 1.5, d85: D85::AtDc(5.0, None) });
        assert_eq!(scene.network, NetworkSource::Cubic([40, 40, 60]));
        assert_eq!((scene.seed, scene.runs, scene.replicates), (1, 2, 10));
        assert_eq!(scene.amount, Amount::MassRatio(0.05, None));
    }

    #[test]
    fn one_alternative_replaces_the_others() {
        let base = |set: &[&str]| built_in(set).unwrap().base;
        assert_eq!(base(&["base.single_mm=0.2"]), BaseGradation::Single(0.2));
        assert_eq!(base(&["base.sieve=b.csv"]), BaseGradation::Sieve("b.csv".into(), None));
        assert_eq!(
            base(&["base.single_mm=0.2", "base.cu=3", "base.d15f_over_d85b=6.5"]),
            BaseGradation::Linear { cu: 3.0, d85: D85::Ratio(6.5) }
        );
        assert_eq!(built_in(&["base.n_base=2e8"]).unwrap().amount, Amount::Number(200_000_000));
        assert_eq!(built_in(&["network.file=n.csv"]).unwrap().network, NetworkSource::File("n.csv".into()));
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
            ("base.d0_mm=1", "goes with base.sieve"),
            ("bas.cu=2", "did you mean `base.cu`"),
        ] {
            let error = built_in(&[set]).unwrap_err().to_string();
            assert!(error.contains(message), "{set}: {error}");
        }
        for (text, message) in [
            ("[base]\ncu = 2", "filter.curve is missing"),
            ("[filter]\ncurve = \"a.csv\"", "the base is missing"),
            ("[filter]\ncurve = \"a.csv\"\n[base]\ncu = 2", "needs one of base.d85_mm"),
            ("[filter]\ncurve = \"a.csv\"\n[base]\ncu = 2\nsingle_mm = 1", "keep one"),
            ("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\nd85_mm = 1", "goes with base.cu"),
            ("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\nn_base = 5\ncap = 3", "base.cap goes with"),
        ] {
            let error = Scene::parse(text.as_bytes(), "s.toml", &[]).unwrap_err().to_string();
            assert!(error.starts_with("s.toml") && error.contains(message), "{text}: {error}");
        }
    }
}
