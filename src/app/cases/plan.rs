//! A plan: factors that are crossed, and single cases, each a scene with a name and a seed of its own.
//!
//! ```toml
//! seed = 1
//! seeds = "common"                   # one for all cases, which share networks; default: one each
//! scene = "common.toml"              # start of all cases; default: the built-in scene
//! [set]
//! replicates = 10
//! [[factor]]                         # one setting, many values
//! name = "cu_b"
//! setting = "base.cu"
//! values = [1.5, 3, 4.5]             # or range = { from = 1.5, to = 4.5, count = 3 }
//! [[factor]]                         # or named levels, each with settings
//! name = "filter"
//! [factor.levels]
//! loose = { "filter.curve" = "shire2016-cu1.5-loose" }
//! dense = { "filter.curve" = "shire2016-cu1.5-dense" }
//! [[leave_out]]                      # combinations that are not walked
//! filter = "dense"
//! cu_b = "4.5"
//! [[case]]                           # a case outside the cross
//! name = "site"
//! set = { "base.sieve" = "site.csv" }
//! ```
//!
//! A case is named after its levels (`filter=loose,cu_b=3`). Unless `seeds = "common"`, its seed follows from
//! the plan's seed and that name alone: adding, removing or changing one case changes no other.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::de::DeTable;

use crate::scene::{Origin, Scene, SceneError};
use voidwalk_core::schema::{hints, read_file, setting_name};
use voidwalk_core::store::{folder_name, read_regular};
use voidwalk_core::text::is_hidden;

/// Maximum number of cases; more are taken for a mistake.
const MOST_CASES: usize = 100_000;

const LARGEST_FILE: u64 = 1 << 20;

/// Top-level keys of a scene, which a plan accepts only inside `set`.
const OF_A_SCENE: [&str; 10] =
    ["filter", "base", "network", "packing", "record", "stop", "about", "replicates", "runs", "engine"];

const SCENE: &str = "is a scene, not the plan of a campaign; walk it by `voidwalk run`, or name it in a \
 plan by scene = \"FILE\" above its [[factor]] and [[case]]; settings of all cases go under [set]";

const NO_PLAN: &str = "is a table of numbers, not the plan of a campaign; two sieve tables are \
                      judged by `voidwalk judge BASE FILTER`";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    #[serde(default)]
    title: String,
    #[serde(default = "one")]
    seed: u64,
    #[serde(default)]
    seeds: Seeds,
    scene: Option<PathBuf>,
    #[serde(default)]
    set: toml::Table,
    #[serde(default)]
    factor: Vec<Factor>,
    #[serde(default)]
    leave_out: Vec<BTreeMap<String, String>>,
    #[serde(default)]
    case: Vec<Single>,
}

fn one() -> u64 {
    1
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Seeds {
    #[default]
    Own,
    /// The plan's seed for all cases. Cases that differ in one factor then share their random numbers, and so
    /// differ less by chance. Cases with the same filter and lattice walk the same networks, each built once.
    Common,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Factor {
    name: String,
    setting: Option<String>,
    #[serde(default)]
    values: Vec<toml::Value>,
    range: Option<Range>,
    #[serde(default)]
    levels: toml::Table,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Range {
    from: f64,
    to: f64,
    count: usize,
}

impl Range {
    fn values(&self) -> Result<Vec<toml::Value>, String> {
        let Self { from, to, count } = *self;
        if !(from.is_finite() && to.is_finite() && (2..=1000).contains(&count)) {
            return Err("a range has two numbers, `from` and `to`, and a `count` from 2 to 1000".into());
        }
        let value = |index: usize| {
            let exact = from + (to - from) * index as f64 / (count - 1) as f64;
            // Gives thirds and tenths without rounding errors.
            let value: f64 = format!("{exact:.11e}").parse().unwrap_or(exact);
            match value.fract() == 0.0 && value.abs() < 1e15 {
                true => toml::Value::Integer(value as i64),
                false => toml::Value::Float(value),
            }
        };
        Ok((0..count).map(value).collect())
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Single {
    name: String,
    #[serde(default)]
    set: toml::Table,
}

/// A case of a plan.
#[derive(Clone, Debug)]
pub struct PlannedCase {
    pub(crate) name: String,
    /// Level by factor, in the order of the plan; empty for a case outside the cross.
    pub(crate) levels: Vec<(String, String)>,
    pub(crate) scene: Scene,
}

/// Plan with its cases worked out.
#[derive(Clone, Debug)]
pub struct CasePlan {
    pub(crate) file: String,
    pub(crate) title: String,
    pub(crate) factors: Vec<String>,
    /// Cases: the cross, with the last factor varying fastest, then the single ones.
    pub cases: Vec<PlannedCase>,
}

type Level = (String, Vec<String>);

impl CasePlan {
    /// A plan to start from: every key with its meaning, as `voidwalk init --plan` prints it.
    pub(crate) const INIT_TEXT: &str = include_str!("../data/plan.toml");

    /// True if a file has keys that only a plan has, even if it is otherwise wrong.
    pub(crate) fn is_plan(path: &Path) -> bool {
        let bytes = read_regular(path, LARGEST_FILE).ok().flatten().unwrap_or_default();
        hints::as_text(&bytes).is_ok_and(|text| match DeTable::parse(text) {
            Ok(table) => hints::is_plan(table.get_ref()),
            // A scene has no list of tables.
            Err(_) => ["[[factor]]", "[[case]]"].iter().any(|head| text.contains(head)),
        })
    }

    /// Reads a plan and every scene in it.
    ///
    /// # Errors
    /// A file that cannot be read or is not a plan, two cases of one name, a case with refused settings.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::parse(&read_file(path, &path.display().to_string(), LARGEST_FILE)?, path)
    }

    /// Applies [`CasePlan::read`] to the content of a file; files named in its scenes are looked up beside
    /// `path`.
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let syntax = |at: String, problem: String| SceneError::Syntax { file: file.clone(), at, problem };
        let text = hints::as_text(bytes).map_err(|problem| syntax(String::new(), problem))?;
        let written: Written = toml::from_str(text).map_err(|e| {
            let line = e.span().map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1);
            let hint = line.and_then(|line| hints::of_line(text, line));
            match toml::from_str::<toml::Table>(text) {
                Ok(table) if OF_A_SCENE.iter().any(|key| table.contains_key(*key)) => {
                    return syntax(String::new(), SCENE.into());
                }
                Err(_) if hints::is_table(text) => return syntax(String::new(), NO_PLAN.into()),
                _ => {}
            }
            let problem = hint.unwrap_or_else(|| e.message().to_string());
            syntax(line.map_or(String::new(), |n| format!(", line {n}")), problem)
        })?;
        Self::expand(file.clone(), path, written)
    }

    fn expand(file: String, path: &Path, written: Written) -> Result<Self, SceneError> {
        let clash = |problem: String| SceneError::Clash { file: file.clone(), problem };
        let mut factors: Vec<(String, Vec<Level>)> = Vec::new();
        for factor in &written.factor {
            check_name("factor", &factor.name).map_err(clash)?;
            if factors.iter().any(|(name, _)| *name == factor.name) {
                return Err(clash(format!("two factors are called `{}`", factor.name)));
            }
            factors.push((factor.name.clone(), levels(factor).map_err(clash)?));
        }
        let total = factors.iter().try_fold(1usize, |n, (_, levels)| n.checked_mul(levels.len()));
        total.filter(|n| n + written.case.len() <= MOST_CASES).ok_or_else(|| {
            clash(format!("the factors make too many cases; at most {MOST_CASES} are allowed"))
        })?;
        for left_out in &written.leave_out {
            check_left_out(left_out, &factors).map_err(clash)?;
        }
        let common = assignments(&written.set);
        let mut plan = Self {
            title: written.title.clone(),
            factors: factors.iter().map(|(name, _)| name.clone()).collect(),
            cases: Vec::new(),
            file: file.clone(),
        };
        let base = written.scene.as_ref().map(|scene| path.parent().unwrap_or(Path::new("")).join(scene));
        let levels: Vec<&[Level]> = factors.iter().map(|(_, levels)| &levels[..]).collect();
        let combinations = if factors.is_empty() { Vec::new() } else { crossed(&levels) };
        for chosen in combinations {
            let names = chosen.iter().map(|(level, _)| level.clone());
            let levels: Vec<(String, String)> = plan.factors.iter().cloned().zip(names).collect();
            let is_level =
                |(factor, level): (&String, &String)| levels.iter().any(|(f, l)| f == factor && l == level);
            if written.leave_out.iter().any(|combination| combination.iter().all(is_level)) {
                continue;
            }
            let names: Vec<String> =
                levels.iter().map(|(factor, level)| format!("{factor}={level}")).collect();
            let mut settings = vec![common.clone()];
            settings.extend(chosen.iter().map(|(_, settings)| settings.clone()));
            plan.add(&written, base.as_deref(), names.join(","), levels, &settings)?;
        }
        for single in &written.case {
            check_name("case", &single.name).map_err(clash)?;
            let settings = [common.clone(), assignments(&single.set)];
            plan.add(&written, base.as_deref(), single.name.clone(), Vec::new(), &settings)?;
        }
        if plan.cases.is_empty() {
            return Err(clash("there is no case: add [[factor]] or [[case]]".into()));
        }
        Ok(plan)
    }

    fn add(
        &mut self,
        written: &Written,
        base: Option<&Path>,
        name: String,
        levels: Vec<(String, String)>,
        settings: &[Vec<String>],
    ) -> Result<(), SceneError> {
        let clash = |problem: String| Err(SceneError::Clash { file: self.file.clone(), problem });
        if self.case(&name).is_some() {
            return clash(format!("two cases are called `{name}`"));
        }
        let folder = folder_name(&name);
        // Some systems' disks do not distinguish upper from lower case.
        let lower = folder.to_lowercase();
        let is_alike = |case: &&PlannedCase| case.folder_name().to_lowercase() == lower;
        if let Some(PlannedCase { name: other, .. }) = self.cases.iter().find(is_alike) {
            return clash(format!(
                "cases `{other}` and `{name}` would share the folder {folder} on some systems: rename one"
            ));
        }
        let origin = Origin::Plan(self.file.clone(), name.clone());
        let mut scene = Scene::planned(base, settings, &origin)?;
        if !settings.iter().flatten().any(|setting| setting_name(setting) == "seed") {
            scene.walk.seed = match written.seeds {
                Seeds::Common => written.seed,
                Seeds::Own => xxhash_rust::xxh3::xxh3_64_with_seed(name.as_bytes(), written.seed),
            };
        }
        self.cases.push(PlannedCase { name, levels, scene });
        Ok(())
    }

    /// Name of its file without the folder, the same wherever the plan is walked.
    pub(crate) fn file_name(&self) -> String {
        let name = Path::new(&self.file).file_name();
        name.map_or_else(|| self.file.clone(), |name| name.to_string_lossy().into_owned())
    }

    pub(crate) fn case(&self, name: &str) -> Option<&PlannedCase> {
        self.cases.iter().find(|case| case.name == name)
    }
}

impl PlannedCase {
    /// Name of the folder that holds its results.
    pub fn folder_name(&self) -> String {
        folder_name(&self.name)
    }
}

/// Every combination of one level of each factor, with the last factor varying fastest.
pub(crate) fn crossed<'a, T>(factors: &[&'a [T]]) -> Vec<Vec<&'a T>> {
    factors.iter().fold(vec![Vec::new()], |begun, levels| {
        let with_levels =
            |chosen: Vec<&'a T>| levels.iter().map(move |level| [&chosen[..], &[level]].concat());
        begun.into_iter().flat_map(with_levels).collect()
    })
}

/// Checks that a name can be part of a file name, a table and a page.
fn check_name(what: &str, name: &str) -> Result<(), String> {
    let bad = |c: char| is_hidden(c) || "=,/\\\"'".contains(c);
    if name.is_empty() || name.len() > 100 || name.starts_with('.') || name.chars().any(bad) {
        return Err(format!(
            "{what} name `{}` is not allowed; 1 to 100 characters, none of = , / \\ and quotes, no dot in \
             front",
            name.chars().filter(|c| !is_hidden(*c)).take(100).collect::<String>()
        ));
    }
    Ok(())
}

fn levels(factor: &Factor) -> Result<Vec<Level>, String> {
    let name = &factor.name;
    let of_range = factor.range.as_ref().map(Range::values).transpose();
    let of_range = of_range.map_err(|problem| format!("factor `{name}`: {problem}"))?;
    let values = match (of_range, factor.values.is_empty()) {
        (Some(_), false) => return Err(format!("factor `{name}` needs either `values` or `range`")),
        (range, _) => range.unwrap_or_else(|| factor.values.clone()),
    };
    let levels: Vec<Level> = match (&factor.setting, values.is_empty(), factor.levels.is_empty()) {
        (Some(setting), false, true) => {
            values.iter().map(|value| (word(value), vec![format!("{setting}={value}")])).collect()
        }
        (None, true, false) => {
            let one = |(level, set): (&String, &toml::Value)| match set {
                toml::Value::Table(set) => Ok((level.clone(), assignments(set))),
                _ => Err(format!("factor `{name}`, level `{level}`: a table of settings is needed")),
            };
            factor.levels.iter().map(one).collect::<Result<_, _>>()?
        }
        _ => {
            return Err(format!(
                "factor `{name}` needs either `setting` and `values` (or `range`), or `levels`"
            ));
        }
    };
    for (index, (level, _)) in levels.iter().enumerate() {
        check_name("level", level)?;
        if levels[..index].iter().any(|(other, _)| other == level) {
            return Err(format!("factor `{name}` has level `{level}` twice"));
        }
    }
    Ok(levels)
}

fn word(value: &toml::Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Settings as `--set` takes them.
fn assignments(set: &toml::Table) -> Vec<String> {
    let one = |(name, value): (&String, &toml::Value)| match value {
        toml::Value::Table(inner) => {
            inner.iter().map(|(key, value)| format!("{name}.{key}={value}")).collect::<Vec<_>>()
        }
        _ => vec![format!("{name}={value}")],
    };
    set.iter().flat_map(one).collect()
}

fn check_left_out(
    left_out: &BTreeMap<String, String>,
    factors: &[(String, Vec<Level>)],
) -> Result<(), String> {
    if left_out.is_empty() {
        return Err("a [[leave_out]] without a factor would leave out everything".into());
    }
    for (factor, level) in left_out {
        let Some((_, levels)) = factors.iter().find(|(name, _)| name == factor) else {
            return Err(format!("leave_out: there is no factor `{factor}`"));
        };
        if !levels.iter().any(|(name, _)| name == level) {
            let all: Vec<&str> = levels.iter().map(|(name, _)| name.as_str()).collect();
            return Err(format!(
                "leave_out: factor `{factor}` has no level `{level}`; it has {}",
                all.join(", ")
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(text: &str) -> Result<CasePlan, SceneError> {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("plan.toml");
        std::fs::write(&path, text).unwrap();
        CasePlan::read(&path)
    }

    fn names(text: &str) -> Result<Vec<String>, SceneError> {
        plan(text).map(|plan| plan.cases.into_iter().map(|case| case.name).collect())
    }

    const TWO_BY_TWO: &str = "[[factor]]\nname = \"cu_b\"\nsetting = \"base.cu\"\nvalues = [1.5, 3]\n\
        [[factor]]\nname = \"filter\"\n[factor.levels]\n\
        a = { \"filter.curve\" = \"shire2016-cu1.5-loose\" }\n\
        b = { filter = { curve = \"shire2016-cu1.5-dense\" } }\n";

    #[test]
    fn factors_are_crossed_with_the_last_running_fastest() {
        let plan = plan(TWO_BY_TWO).unwrap();
        assert_eq!(
            names(TWO_BY_TWO).unwrap(),
            ["cu_b=1.5,filter=a", "cu_b=1.5,filter=b", "cu_b=3,filter=a", "cu_b=3,filter=b"]
        );
        let seeds: std::collections::BTreeSet<u64> = plan.cases.iter().map(|c| c.scene.walk.seed).collect();
        assert_eq!(seeds.len(), 4);
    }

    /// Checks the printed plan, also with every commented-out key enabled.
    #[test]
    fn the_plan_to_start_from_is_one_and_names_every_key() {
        let text = CasePlan::INIT_TEXT;
        assert_eq!(plan(text).unwrap().cases.len(), 4);
        let uncommented = |line: &str| match line.strip_prefix("# ") {
            Some(rest) if rest.starts_with("[[") || rest.contains(" = ") && !rest.starts_with("scene") => {
                rest.to_owned()
            }
            _ => line.to_owned(),
        };
        let whole: Vec<String> = text.lines().map(uncommented).collect();
        let whole = plan(&whole.join("\n")).unwrap();
        // One combination is left out, and one case is outside the cross.
        assert_eq!((whole.cases.len(), whole.cases[3].name.as_str()), (4, "wide base"));
        assert!(whole.cases.iter().all(|case| case.scene.walk.seed == 1), "common seeds");
        let known = plan("no = 1").unwrap_err().to_string();
        for key in ["title", "seed", "seeds", "scene", "set", "factor", "leave_out", "case"] {
            let is_there = [format!("{key} = "), format!("[{key}]")].iter().any(|form| text.contains(form));
            assert!(is_there && known.contains(key), "{key}: {known}");
        }
    }

    #[test]
    fn a_level_may_be_a_length_with_its_unit() {
        let factor = "[[factor]]\nname = \"thickness\"\nsetting = \"network.thickness_mm\"\n";
        let text = format!("{factor}values = [\"2ft\", \"0.5m\", 500]\n");
        assert_eq!(names(&text).unwrap(), ["thickness=2ft", "thickness=0.5m", "thickness=500"]);
        let cases = plan(&text).unwrap().cases;
        let mm = cases.iter().map(|case| case.scene.network.thickness_mm);
        assert_eq!(mm.collect::<Vec<_>>(), [Some(609.6), Some(500.0), Some(500.0)]);
    }

    #[test]
    fn a_range_is_even_and_has_both_ends() {
        let factor = "[[factor]]\nname = \"cu\"\nsetting = \"base.cu\"\n";
        let levels = |range: &str| names(&format!("{factor}range = {range}\n"));
        let rising = levels("{ from = 2.1, to = 3, count = 4 }").unwrap();
        assert_eq!(rising, ["cu=2.1", "cu=2.4", "cu=2.7", "cu=3"]);
        assert_eq!(levels("{ from = 6, to = 2, count = 3 }").unwrap(), ["cu=6", "cu=4", "cu=2"]);
        for (range, message) in [
            ("{ from = 2, to = 3, count = 1 }", "a `count` from 2 to 1000"),
            ("{ from = 2, to = inf, count = 3 }", "has two numbers"),
            ("{ from = 2, to = 3 }", "missing field `count`"),
            ("{ from = 2, to = 2, count = 3 }", "level `2` twice"),
            ("{ from = 2, to = 3, count = 2 }\nvalues = [4]", "either `values` or `range`"),
        ] {
            let error = levels(range).unwrap_err().to_string();
            assert!(error.contains(message), "{range}: {error}");
        }
    }

    #[test]
    fn a_case_keeps_its_seed_when_others_come_and_go() {
        let all = plan(TWO_BY_TWO).unwrap();
        let fewer =
            plan(&format!("{TWO_BY_TWO}[[leave_out]]\ncu_b = \"1.5\"\n[[case]]\nname = \"x\"\n")).unwrap();
        assert_eq!(fewer.cases.len(), 3);
        for case in &fewer.cases[..2] {
            assert_eq!(all.case(&case.name).unwrap().scene.walk.seed, case.scene.walk.seed);
        }
        let common = plan(&format!("seeds = \"common\"\nseed = 7\n{TWO_BY_TWO}")).unwrap();
        assert!(common.cases.iter().all(|c| c.scene.walk.seed == 7));
    }

    #[test]
    fn mistakes_are_named() {
        for (text, message) in [
            ("", "there is no case"),
            ("sed = 1", "line 1: unknown field `sed`"),
            ("[[factor]]\nname = \"a\"\n", "needs either `setting` and `values`"),
            (
                "[[factor]]\nname = \"a\"\nsetting = \"base.uc\"\nvalues = [1]\n",
                "case a=1: there is no setting `base.uc`",
            ),
            (
                "[[factor]]\nname = \"a\"\nsetting = \"base.cu\"\nvalues = [0.1]\n",
                "case a=0.1, base.cu: `0.1` is not allowed",
            ),
            ("[[factor]]\nname = \"a\"\nsetting = \"base.cu\"\nvalues = [2, 2]\n", "level `2` twice"),
            ("[[factor]]\nname = \"a=b\"\nsetting = \"base.cu\"\nvalues = [2]\n", "is not allowed"),
            ("[[case]]\nname = \"../x\"\n", "is not allowed"),
            ("[[case]]\nname = \"x\"\n[[case]]\nname = \"x\"\n", "two cases are called `x`"),
            (
                "[[case]]\nname = \"x\"\nset = { filter = { \
                 curve = \"a.csv\", density = \"loose\", cu = 2 } }\n",
                "both say what the filter's constrictions are",
            ),
            ("[[case]]\nname = \"x\"\n[[case]]\nname = \"X\"\n", "share the folder X"),
            (
                "[[factor]]\nname = \"f\"\n[factor.levels]\na = { base = { cu = 2 } }\n\
                 A = { base = { cu = 3 } }\n",
                "share the folder f=A",
            ),
            ("[[case]]\nname = \"x\"\n[[leave_out]]\nfilter = \"x\"\n", "there is no factor `filter`"),
        ] {
            let error = plan(text).unwrap_err().to_string();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
