//! Settings with their origin: a line of a TOML file, or the command line.
//!
//! A setting has a dotted name (`base.cu`). Some settings exclude each other ([`Group`]): setting one on
//! the command line replaces the others, and a file that gives both is refused.

use super::{Allowed, Leaf, Value, hints};
use crate::store::{in_mb, read_regular};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// A refused scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{file}: {source}")]
    File {
        /// The file.
        file: String,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file is not TOML, or too large.
    #[error("{file}{at}: {problem}")]
    Syntax {
        /// The file.
        file: String,
        /// `, line N` if known.
        at: String,
        /// Description of the error.
        problem: String,
    },
    /// A name that is not a setting.
    #[error("{origin}: there is no setting `{name}`; {instead}")]
    Unknown {
        /// Place of the name.
        origin: Origin,
        /// The name.
        name: String,
        /// A similar valid name, or else the names in its section.
        instead: String,
    },
    /// A value that the setting does not allow.
    #[error("{origin}, {name}: `{value}` is not allowed; {allowed}")]
    Value {
        /// Place of the value.
        origin: Origin,
        /// The setting.
        name: String,
        /// The value.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// Settings that clash, or a missing setting.
    #[error("{file}: {problem}")]
    Clash {
        /// The scene.
        file: String,
        /// Description of the clash.
        problem: String,
    },
}

/// Reads a user's file of at most `largest` bytes, which errors call `file`.
///
/// # Errors
/// A file that cannot be read, is not a regular file or is too large.
pub fn read_file(path: &Path, file: &str, largest: u64) -> Result<Vec<u8>, SceneError> {
    let read = read_regular(path, largest);
    if let Some(bytes) = read.map_err(|source| SceneError::File { file: file.into(), source })? {
        return Ok(bytes);
    }
    let largest = in_mb(largest);
    let problem = match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => format!("is a folder; allowed: a file of at most {largest}"),
        Ok(metadata) if !metadata.is_file() => {
            format!("is a pipe, a device or a socket; allowed: a regular file of at most {largest}")
        }
        _ => format!("is larger than {largest}; allowed: a file up to that size"),
    };
    Err(SceneError::Syntax { file: file.into(), at: String::new(), problem })
}

/// Origin of a setting.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A line of a file, counted from 1.
    Line(String, usize),
    /// The command line.
    CommandLine,
    /// A case of a plan: its file and the case's name.
    Plan(String, String),
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(file, line) => write!(f, "{file}, line {line}"),
            Self::CommandLine => write!(f, "--set"),
            Self::Plan(file, case) => write!(f, "{file}, case {case}"),
        }
    }
}

/// Alternative settings that give the same thing; a scene may use one alternative.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// Purpose, for a message that begins with the names: `give the base`.
    pub says: &'static str,
    /// Alternatives.
    pub alternatives: &'static [Alternative],
}

/// One alternative of a [`Group`].
#[derive(Clone, Copy, Debug)]
pub struct Alternative {
    /// Settings that select it, each by itself.
    pub by: &'static [&'static str],
    /// Settings allowed only with this alternative.
    pub with: &'static [&'static str],
    /// True if those select this alternative too, on the command line.
    pub with_chooses: bool,
    /// Settings with another meaning under the other alternatives; removed if this one is selected on
    /// the command line.
    pub resets: &'static [&'static str],
}

impl Alternative {
    /// Makes the alternative selected by these settings.
    pub const fn by(by: &'static [&'static str]) -> Self {
        Self { by, with: &[], with_chooses: false, resets: &[] }
    }

    /// Adds settings allowed only with this alternative.
    pub const fn with(self, with: &'static [&'static str]) -> Self {
        Self { with, ..self }
    }

    fn is_chosen_by(&self, name: &str) -> bool {
        let is_by = |by: &&str| name == *by || (by.ends_with('.') && name.starts_with(*by));
        self.by.iter().any(is_by) || (self.with_chooses && self.with.contains(&name))
    }
}

/// Valid names, and names that exclude each other.
pub struct Names {
    /// All valid names.
    pub known: Vec<String>,
    /// Names whose value is text even if it looks like a number or a date.
    pub lines: Vec<String>,
    /// Settings that exclude each other.
    pub groups: &'static [Group],
}

/// Settings by name.
#[derive(Debug)]
pub struct GivenSettings {
    file: String,
    folder: PathBuf,
    values: BTreeMap<String, (Value, Origin)>,
}

/// Returns the name in `name=value`; empty without a `=`.
pub fn setting_name(assignment: &str) -> &str {
    assignment.split_once('=').map_or("", |(name, _)| name).trim()
}

/// Largest size of a settings file (bytes).
const LARGEST_FILE: u64 = 1 << 20;

const NO_SCENE: &str = "is a table of numbers, not a scene; two sieve tables are judged by `voidwalk judge \
 BASE FILTER`; a scene names one, as in base.sieve = \"sand.csv\" (`voidwalk init` writes a scene \
 to start from)";

const PLAN: &str = "is the plan of a campaign, not a scene; walk it by `voidwalk campaign`";

impl GivenSettings {
    /// Reads a TOML file.
    ///
    /// # Errors
    /// The file cannot be read, is not TOML, or sets an unknown name.
    pub fn read(path: &Path, names: &Names) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let bytes = read_file(path, &file, LARGEST_FILE)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self::parse(&bytes, &file, folder, names)
    }

    /// Reads TOML text; `file` names it in errors, and relative paths start from `folder`.
    pub fn parse(bytes: &[u8], file: &str, folder: PathBuf, names: &Names) -> Result<Self, SceneError> {
        let syntax = |at, problem| SceneError::Syntax { file: file.into(), at, problem };
        let text = hints::as_text(bytes).map_err(|problem| syntax(String::new(), problem))?;
        let line_of = |at: usize| text[..at.min(text.len())].matches('\n').count() + 1;
        let table = DeTable::parse(text).map_err(|e| {
            if hints::is_table(text) {
                return syntax(String::new(), NO_SCENE.into());
            }
            let line = e.span().map(|span| line_of(span.start));
            let hint = line.and_then(|line| hints::of_line(text, line));
            let at = line.map_or(String::new(), |line| format!(", line {line}"));
            syntax(at, hint.unwrap_or_else(|| e.message().to_string()))
        })?;
        if hints::is_plan(table.get_ref()) {
            return Err(syntax(String::new(), PLAN.into()));
        }
        let mut settings = Self { file: file.into(), folder, values: BTreeMap::new() };
        let mut add = |name: String, at: usize, value: &DeValue| {
            let origin = Origin::Line(file.into(), line_of(at));
            names.check(&name, &origin)?;
            settings.values.insert(name, (value.into(), origin));
            Ok(())
        };
        for (key, value) in table.get_ref() {
            match value.get_ref() {
                DeValue::Table(inner) => {
                    let table = format!("{}.", key.get_ref());
                    if !names.known.iter().any(|name| name.starts_with(&table)) {
                        let origin = Origin::Line(file.into(), line_of(key.span().start));
                        return Err(names.unknown(key.get_ref(), &origin));
                    }
                    for (inner_key, value) in inner {
                        let name = format!("{}.{}", key.get_ref(), inner_key.get_ref());
                        add(name, inner_key.span().start, value.get_ref())?;
                    }
                }
                other => add(key.get_ref().to_string(), key.span().start, other)?,
            }
        }
        Ok(settings)
    }

    /// Applies assignments `name=value` given together: they replace alternatives that were given
    /// before, not each other. A value is read as TOML, or else as text.
    ///
    /// # Errors
    /// An assignment without `=`, or an unknown setting.
    pub fn set_together(
        &mut self,
        assignments: &[String],
        names: &Names,
        origin: &Origin,
    ) -> Result<(), SceneError> {
        let mut stated = Vec::new();
        for assignment in assignments {
            let Some((name, value)) = assignment.split_once('=') else {
                return Err(SceneError::Value {
                    origin: origin.clone(),
                    name: "assignment".into(),
                    value: Value::Text(assignment.clone()).to_string(),
                    allowed: "write name=value, as in base.cu=3".into(),
                });
            };
            let (name, value) = (name.trim(), value.trim());
            names.check(name, origin)?;
            let of_line = names.lines.iter().any(|line| line == name);
            // A shell removes quotes.
            let read = match Value::of_assignment(value) {
                Value::Number(_) | Value::Other(_) if of_line => Value::Text(value.into()),
                read => read,
            };
            stated.push((name.to_owned(), read));
        }
        for (name, _) in &stated {
            for replaced in names.replaced_by(name) {
                self.values.remove(replaced);
            }
        }
        for (name, value) in stated {
            self.values.insert(name, (value, origin.clone()));
        }
        Ok(())
    }

    /// Name of the file in errors.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns the first given setting whose name begins with `beginning`.
    pub fn first_in(&self, beginning: &str) -> Option<&str> {
        self.values.keys().find(|name| name.starts_with(beginning)).map(String::as_str)
    }

    /// Tells if a setting is given.
    pub fn has(&self, name: &str) -> bool {
        self.values.contains_key(name)
    }

    /// Makes the error for a setting's value.
    pub fn refuse(&self, name: &str, allowed: impl Into<String>) -> SceneError {
        let (value, origin) = self
            .values
            .get(name)
            .cloned()
            .unwrap_or_else(|| (Value::Other("nothing".into()), Origin::Line(self.file.clone(), 1)));
        let (value, mut allowed) = (value.to_string(), allowed.into());
        if let Some(hint) = hints::of_value(name, &value) {
            allowed = format!("{allowed} ({hint})");
        }
        SceneError::Value { origin, name: name.into(), value, allowed }
    }

    /// Makes the error for settings that clash.
    pub fn clash(&self, problem: impl Into<String>) -> SceneError {
        SceneError::Clash { file: self.file.clone(), problem: problem.into() }
    }

    /// Reads the value of a setting, if it is given.
    ///
    /// # Errors
    /// A value of another type, or one that is not allowed.
    pub fn get<T: Leaf>(&self, name: &str, allowed: &Allowed<T>) -> Result<Option<T>, SceneError> {
        let Some((value, origin)) = self.values.get(name) else { return Ok(None) };
        let read = allowed.read(value);
        let read = read.ok_or_else(|| self.refuse(name, allowed.words.clone()))?;
        Ok(Some(match origin {
            Origin::Line(..) => read.placed(&self.folder),
            Origin::Plan(file, _) => read.placed(Path::new(file).parent().unwrap_or(Path::new(""))),
            Origin::CommandLine => read,
        }))
    }

    /// Refuses settings that exclude each other.
    ///
    /// # Errors
    /// [`SceneError::Clash`], with both names.
    pub fn check_groups(&self, groups: &[Group]) -> Result<(), SceneError> {
        groups.iter().try_for_each(|group| self.check_group(group))
    }

    fn check_group(&self, group: &Group) -> Result<(), SceneError> {
        let given = |names: &[&'static str]| names.iter().copied().find(|&name| self.has(name));
        let names: Vec<&str> =
            group.alternatives.iter().filter_map(|alternative| given(alternative.by)).collect();
        if names.len() > 1 {
            let all = if names.len() == 2 { "both" } else { "all" };
            let problem = format!("{} {all} {}: keep one", names.join(" and "), group.says);
            let by_hand =
                |name: &&str| self.values.get(*name).is_some_and(|(_, o)| *o == Origin::CommandLine);
            return Err(match names.iter().all(by_hand) {
                true => SceneError::Clash { file: Origin::CommandLine.to_string(), problem },
                false => self.clash(problem),
            });
        }
        let Some(name) = names.first() else { return Ok(()) };
        for alternative in group.alternatives.iter().filter(|alternative| !alternative.by.contains(name)) {
            if let Some(companion) = given(alternative.with) {
                return Err(
                    self.clash(format!("{companion} goes with {}, not with {name}", alternative.by[0]))
                );
            }
        }
        Ok(())
    }
}

impl Names {
    fn check(&self, name: &str, origin: &Origin) -> Result<(), SceneError> {
        if self.known.iter().any(|known| known == name) { Ok(()) } else { Err(self.unknown(name, origin)) }
    }

    /// Lists the settings that are removed when `name` is set on the command line.
    fn replaced_by(&self, name: &str) -> Vec<&'static str> {
        let mut replaced = Vec::new();
        for group in self.groups {
            let Some(chosen) = group.alternatives.iter().find(|alternative| alternative.is_chosen_by(name))
            else {
                continue;
            };
            for other in group.alternatives.iter().filter(|alternative| alternative.by != chosen.by) {
                replaced.extend(other.by.iter().chain(other.with));
            }
            replaced.extend(chosen.resets);
        }
        replaced
    }

    fn unknown(&self, name: &str, origin: &Origin) -> SceneError {
        let instead = hints::instead_of(name, &self.known);
        let name = Value::Text(name.into()).to_string();
        SceneError::Unknown { origin: origin.clone(), name, instead }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{above_zero, any, whole, within};
    use proptest::collection::vec;
    use proptest::prelude::proptest;

    const GROUPS: &[Group] = &[Group {
        says: "give the base",
        alternatives: &[
            Alternative { with_chooses: true, ..Alternative::by(&["base.cu"]).with(&["base.d85_mm"]) },
            Alternative::by(&["base.sieve"]).with(&["base.d0_mm"]),
        ],
    }];

    fn names() -> Names {
        let known = ["seed", "base.cu", "base.d85_mm", "base.sieve", "base.d0_mm"];
        Names { known: known.map(String::from).to_vec(), lines: Vec::new(), groups: GROUPS }
    }

    fn parse(text: &str) -> Result<GivenSettings, SceneError> {
        GivenSettings::parse(text.as_bytes(), "s.toml", PathBuf::from("there"), &names())
    }

    fn set(settings: &mut GivenSettings, assignment: &str) -> Result<(), SceneError> {
        settings.set_together(&[assignment.to_owned()], &names(), &Origin::CommandLine)
    }

    fn sieve(settings: &GivenSettings) -> Option<PathBuf> {
        settings.get("base.sieve", &any("a file name in quotes")).unwrap()
    }

    #[test]
    fn an_error_names_file_line_field_value_and_what_is_allowed() {
        let settings = parse("seed = 1\n[base]\n\ncu = -3\n").unwrap();
        let error = settings.get("base.cu", &within(1.0..=9.0, "a number from 1 to 9")).unwrap_err();
        assert_eq!(error.to_string(), "s.toml, line 4, base.cu: `-3` is not allowed; a number from 1 to 9");
    }

    #[test]
    fn unknown_names_suggest_the_nearest() {
        let error = parse("sede = 1\n").unwrap_err().to_string();
        assert_eq!(error, "s.toml, line 1: there is no setting `sede`; did you mean `seed`?");
        let error = parse("[base]\nseive = 1\n").unwrap_err().to_string();
        assert!(error.contains("line 2") && error.contains("did you mean `base.sieve`"), "{error}");
        assert!(parse("[base2]\n").unwrap_err().to_string().contains("line 1: there is no setting `base2`"));
    }

    #[test]
    fn the_command_line_replaces_alternatives_and_keeps_paths_apart() {
        let mut settings = parse("[base]\nsieve = \"a.csv\"\nd0_mm = 1").unwrap();
        assert_eq!(sieve(&settings), Some(PathBuf::from("there/a.csv")));
        set(&mut settings, "base.sieve=b.csv").unwrap();
        assert_eq!(sieve(&settings), Some(PathBuf::from("b.csv")));
        assert!(settings.has("base.d0_mm"));
        set(&mut settings, "base.cu = 3").unwrap();
        assert!(!settings.has("base.sieve") && !settings.has("base.d0_mm"));
        assert!(set(&mut settings, "base.cu").is_err());
        assert!(set(&mut settings, "base.uc=1").is_err());
    }

    #[test]
    fn settings_that_exclude_each_other_are_refused_with_both_names() {
        for (text, message) in [
            ("cu = 2\nsieve = \"a.csv\"", "base.cu and base.sieve both give the base: keep one"),
            ("d85_mm = 2\nsieve = \"a.csv\"", "base.d85_mm goes with base.cu, not with base.sieve"),
            ("cu = 2\nd0_mm = 1", "base.d0_mm goes with base.sieve, not with base.cu"),
        ] {
            let error = parse(&format!("[base]\n{text}")).unwrap().check_groups(GROUPS).unwrap_err();
            assert_eq!(error.to_string(), format!("s.toml: {message}"));
        }
        assert!(parse("[base]\ncu = 2\nd85_mm = 2").unwrap().check_groups(GROUPS).is_ok());
    }

    #[test]
    fn numbers_are_finite_and_whole_where_they_must_be() {
        for text in ["seed = nan", "seed = inf", "seed = 1e400", "seed = 1.5", "seed = -1", "seed = \"1\""] {
            assert!(parse(text).and_then(|s| s.get("seed", &whole(0..=u64::MAX))).is_err(), "{text}");
        }
        assert!(parse("seed = inf").and_then(|s| s.get("seed", &above_zero())).is_err());
        for (text, n) in [("seed = 2e8", 200_000_000), ("seed = 18446744073709551615", u64::MAX)] {
            assert_eq!(parse(text).unwrap().get("seed", &whole(0..=u64::MAX)).unwrap(), Some(n));
        }
    }

    #[test]
    fn what_is_no_toml_is_refused_with_its_line() {
        assert!(parse("seed = 1\nbase = \n").unwrap_err().to_string().starts_with("s.toml, line 2: "));
        let read = |path: &Path, most| read_file(path, "a", most).unwrap_err().to_string();
        assert!(read(Path::new("/no/such"), 9).starts_with("a: "));
        assert_eq!(read(Path::new("/"), 16 << 20), "a: is a folder; allowed: a file of at most 16 MB");
        if cfg!(unix) {
            assert!(read(Path::new("/dev/null"), 9).starts_with("a: is a pipe, a device or a socket; "));
        }
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "long").unwrap();
        assert_eq!(read(file.path(), 3), "a: is larger than 0 MB; allowed: a file up to that size");
    }

    proptest! {
        #[test]
        fn parsing_never_panics(bytes in vec(u8::MIN..=u8::MAX, 0..200)) {
            let _ = GivenSettings::parse(&bytes, "s.toml", PathBuf::new(), &names());
        }
    }
}
