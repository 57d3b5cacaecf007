//! Settings with where they come from: a line of a TOML file, or the command line.
//!
//! A setting has a dotted name (`base.cu`). Some names are alternatives: setting one on the command line
//! replaces the others.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

/// A scene that is refused.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{file}: {source}")]
    File {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is not TOML, or too large.
    #[error("{file}{at}: {problem}")]
    Syntax {
        /// The file.
        file: String,
        /// `, line N` where known.
        at: String,
        /// What is wrong.
        problem: String,
    },
    /// No setting has this name.
    #[error("{origin}: there is no setting `{name}`; did you mean `{nearest}`?")]
    Unknown {
        /// Where it stands.
        origin: Origin,
        /// The name.
        name: String,
        /// The most similar valid name.
        nearest: String,
    },
    /// A setting has a value that it cannot have.
    #[error("{origin}, {name}: `{value}` is not allowed; {allowed}")]
    Value {
        /// Where it stands.
        origin: Origin,
        /// The setting.
        name: String,
        /// The value.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// Settings that clash, or one that is missing.
    #[error("{file}: {problem}")]
    Clash {
        /// The scene.
        file: String,
        /// What clashes.
        problem: String,
    },
}

/// Where a setting comes from.
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

/// A value as it was written.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Text.
    Text(String),
    /// A number, digit for digit.
    Number(String),
    /// A list.
    List(Vec<Value>),
    /// A table, in the order in which it was written.
    Table(Vec<(String, Value)>),
    /// Anything else: a date, a truth value, an integer that is not decimal.
    Other(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) | Self::Number(text) | Self::Other(text) => {
                let printable = text.chars().map(|c| if c.is_control() { '?' } else { c });
                write!(f, "{}", printable.take(80).collect::<String>())
            }
            Self::List(items) => {
                let items: Vec<String> = items.iter().take(10).map(ToString::to_string).collect();
                write!(f, "[{}]", items.join(", "))
            }
            Self::Table(items) => {
                let printable = |text: &String| text.chars().filter(|c| !c.is_control()).collect::<String>();
                let items: Vec<String> =
                    items.iter().take(14).map(|(k, v)| format!("{} = {v}", printable(k))).collect();
                write!(f, "{{ {} }}", items.join(", "))
            }
        }
    }
}

impl From<&DeValue<'_>> for Value {
    fn from(value: &DeValue) -> Self {
        match value {
            DeValue::String(text) => Self::Text(text.to_string()),
            DeValue::Integer(i) if i.radix() == 10 => Self::Number(i.as_str().to_string()),
            DeValue::Float(number) => Self::Number(number.as_str().to_string()),
            DeValue::Array(items) => Self::List(items.iter().map(|i| i.get_ref().into()).collect()),
            DeValue::Integer(i) => Self::Other(i.to_string()),
            DeValue::Boolean(b) => Self::Other(b.to_string()),
            DeValue::Datetime(d) => Self::Other(d.to_string()),
            DeValue::Table(items) => Self::Table(
                items
                    .iter()
                    .map(|(key, value)| (key.get_ref().to_string(), value.get_ref().into()))
                    .collect(),
            ),
        }
    }
}

/// What is known of the names: which exist, and which replace each other.
pub struct Names {
    /// Every valid name.
    pub known: &'static [&'static str],
    /// Setting the first of a pair on the command line removes the second.
    pub replaces: &'static [(&'static str, &'static str)],
}

/// Settings by name.
#[derive(Debug)]
pub struct Settings {
    file: String,
    folder: PathBuf,
    values: BTreeMap<String, (Value, Origin)>,
}

/// A larger settings file is refused (bytes).
const LARGEST_FILE: u64 = 1 << 20;

impl Settings {
    /// Reads a TOML file.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, or sets what does not exist.
    pub fn read(path: &Path, names: &Names) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let io = |source| SceneError::File { file: file.clone(), source };
        let meta = std::fs::metadata(path).map_err(io)?;
        if !meta.is_file() || meta.len() > LARGEST_FILE {
            let problem = format!("must be a regular file of at most {LARGEST_FILE} bytes");
            return Err(SceneError::Syntax { file, at: String::new(), problem });
        }
        let bytes = std::fs::read(path).map_err(io)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self::parse(&bytes, &file, folder, names)
    }

    /// Reads TOML text; `file` names it in errors, and relative paths start from `folder`.
    ///
    /// # Errors
    /// As [`Settings::read`].
    pub fn parse(bytes: &[u8], file: &str, folder: PathBuf, names: &Names) -> Result<Self, SceneError> {
        let syntax = |at, problem| SceneError::Syntax { file: file.into(), at, problem };
        let text =
            std::str::from_utf8(bytes).map_err(|_| syntax(String::new(), "is not UTF-8 text".into()))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let line_of = |at: usize| text[..at.min(text.len())].matches('\n').count() + 1;
        let table = DeTable::parse(text).map_err(|e| {
            let at = e.span().map_or(String::new(), |span| format!(", line {}", line_of(span.start)));
            syntax(at, e.message().to_string())
        })?;
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

    /// Applies `name=value` from the command line; the value is TOML, or else text.
    ///
    /// # Errors
    /// There is no `=`, or no such setting.
    pub fn set(&mut self, assignment: &str, names: &Names) -> Result<(), SceneError> {
        self.set_together(&[assignment.to_owned()], names, &Origin::CommandLine)
    }

    /// Applies assignments that are stated together: they replace alternatives that were given before, not one another.
    ///
    /// # Errors
    /// As [`Settings::set`].
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
            let value = match DeValue::parse(value) {
                Ok(parsed) => Value::from(parsed.get_ref()),
                Err(_) => Value::Text(value.into()),
            };
            stated.push((name.to_owned(), value));
        }
        for (name, _) in &stated {
            for (_, replaced) in names.replaces.iter().filter(|(by, _)| by == name) {
                self.values.remove(*replaced);
            }
        }
        for (name, value) in stated {
            self.values.insert(name, (value, origin.clone()));
        }
        Ok(())
    }

    /// What errors call the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The first setting that is given among those whose names begin like this.
    pub fn first_in(&self, beginning: &str) -> Option<&str> {
        self.values.keys().find(|name| name.starts_with(beginning)).map(String::as_str)
    }

    /// A setting as it was written.
    pub fn value(&self, name: &str) -> Option<&Value> {
        self.values.get(name).map(|(value, _)| value)
    }

    /// Whether a setting is given.
    pub fn has(&self, name: &str) -> bool {
        self.values.contains_key(name)
    }

    /// The error for a setting's value.
    pub fn refuse(&self, name: &str, allowed: impl Into<String>) -> SceneError {
        let (value, origin) = self
            .values
            .get(name)
            .cloned()
            .unwrap_or_else(|| (Value::Other("nothing".into()), Origin::Line(self.file.clone(), 1)));
        SceneError::Value { origin, name: name.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// The error for settings that clash.
    pub fn clash(&self, problem: impl Into<String>) -> SceneError {
        SceneError::Clash { file: self.file.clone(), problem: problem.into() }
    }

    /// A finite number that `valid` admits.
    ///
    /// # Errors
    /// Anything else.
    pub fn number(
        &self,
        name: &str,
        valid: impl Fn(f64) -> bool,
        allowed: &str,
    ) -> Result<Option<f64>, SceneError> {
        let Some((value, _)) = self.values.get(name) else { return Ok(None) };
        let parsed = value.number().filter(|n| valid(*n));
        parsed.map(Some).ok_or_else(|| self.refuse(name, allowed))
    }

    /// A whole number in a range; `2e8` is one too.
    ///
    /// # Errors
    /// Anything else.
    pub fn whole(&self, name: &str, range: std::ops::RangeInclusive<u64>) -> Result<Option<u64>, SceneError> {
        let Some((value, _)) = self.values.get(name) else { return Ok(None) };
        let parsed = match value {
            Value::Number(digits) => whole(digits).filter(|n| range.contains(n)),
            _ => None,
        };
        let allowed = || format!("a whole number from {} to {}", range.start(), range.end());
        parsed.map(Some).ok_or_else(|| self.refuse(name, allowed()))
    }

    /// Text that is not empty.
    ///
    /// # Errors
    /// Anything else.
    pub fn text(&self, name: &str, allowed: &str) -> Result<Option<String>, SceneError> {
        match self.values.get(name) {
            None => Ok(None),
            Some((Value::Text(text), _)) if !text.is_empty() => Ok(Some(text.clone())),
            Some(_) => Err(self.refuse(name, allowed)),
        }
    }

    /// What one of a few words stands for.
    ///
    /// # Errors
    /// Another word, or no text.
    pub fn word<T>(
        &self,
        name: &str,
        words: impl IntoIterator<Item = (&'static str, T)>,
        allowed: &str,
    ) -> Result<Option<T>, SceneError> {
        let Some(text) = self.text(name, allowed)? else { return Ok(None) };
        let found = words.into_iter().find(|(word, _)| *word == text);
        found.map(|(_, meaning)| Some(meaning)).ok_or_else(|| self.refuse(name, allowed))
    }

    /// A path; one in a file starts from that file's folder, one on the command line from the working folder.
    ///
    /// # Errors
    /// Not text.
    pub fn path(&self, name: &str) -> Result<Option<PathBuf>, SceneError> {
        let Some(text) = self.text(name, "a file name in quotes")? else { return Ok(None) };
        Ok(Some(self.resolve(name, &text)))
    }

    /// A path that is written at setting `name`.
    pub fn resolve(&self, name: &str, path: &str) -> PathBuf {
        match self.values.get(name) {
            Some((_, Origin::Line(..))) => self.folder.join(path),
            Some((_, Origin::Plan(file, _))) => Path::new(file).with_file_name(path),
            _ => PathBuf::from(path),
        }
    }

    /// A list of numbers that `valid` admits.
    ///
    /// # Errors
    /// Anything else.
    pub fn numbers(
        &self,
        name: &str,
        valid: impl Fn(f64) -> bool,
        allowed: &str,
    ) -> Result<Option<Vec<f64>>, SceneError> {
        let Some((value, _)) = self.values.get(name) else { return Ok(None) };
        let Value::List(items) = value else { return Err(self.refuse(name, allowed)) };
        let one = |item: &Value| item.number().filter(|n| valid(*n));
        let all: Option<Vec<f64>> = items.iter().map(one).collect();
        all.map(Some).ok_or_else(|| self.refuse(name, allowed))
    }
}

impl Value {
    /// A finite number.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(digits) => digits.parse::<f64>().ok().filter(|n| n.is_finite()),
            _ => None,
        }
    }
}

/// A whole number written as `200000000`, `2e8` or `2.5e8`.
fn whole(digits: &str) -> Option<u64> {
    if let Ok(n) = digits.parse::<u64>() {
        return Some(n);
    }
    let n = digits.parse::<f64>().ok()?;
    (n.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(&n)).then_some(n as u64)
}

impl Names {
    fn check(&self, name: &str, origin: &Origin) -> Result<(), SceneError> {
        if self.known.contains(&name) { Ok(()) } else { Err(self.unknown(name, origin)) }
    }

    fn unknown(&self, name: &str, origin: &Origin) -> SceneError {
        let distance = |known: &&&str| {
            let last = |n: &str| n.rsplit('.').next().unwrap_or_default().to_string();
            let whole = strsim::damerau_levenshtein(known, name);
            (whole.min(strsim::damerau_levenshtein(&last(known), &last(name)) + 1), whole)
        };
        let nearest = self.known.iter().min_by_key(distance).copied().unwrap_or_default();
        let name = Value::Text(name.into()).to_string();
        SceneError::Unknown { origin: origin.clone(), name, nearest: nearest.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NAMES: Names =
        Names { known: &["seed", "base.cu", "base.sieve"], replaces: &[("base.cu", "base.sieve")] };

    fn parse(text: &str) -> Result<Settings, SceneError> {
        Settings::parse(text.as_bytes(), "s.toml", PathBuf::from("there"), &NAMES)
    }

    #[test]
    fn an_error_names_file_line_field_value_and_what_is_allowed() {
        let settings = parse("seed = 1\n[base]\n\ncu = -3\n").unwrap();
        let error = settings.number("base.cu", |n| n >= 1.0, "a number of at least 1").unwrap_err();
        assert_eq!(error.to_string(), "s.toml, line 4, base.cu: `-3` is not allowed; a number of at least 1");
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
        let mut settings = parse("[base]\nsieve = \"a.csv\"").unwrap();
        assert_eq!(settings.path("base.sieve").unwrap(), Some(PathBuf::from("there/a.csv")));
        settings.set("base.sieve=b.csv", &NAMES).unwrap();
        assert_eq!(settings.path("base.sieve").unwrap(), Some(PathBuf::from("b.csv")));
        settings.set("base.cu = 3", &NAMES).unwrap();
        assert!(!settings.has("base.sieve"));
        assert!(settings.set("base.cu", &NAMES).is_err());
        assert!(settings.set("base.uc=1", &NAMES).is_err());
    }

    #[test]
    fn numbers_are_finite_and_whole_where_they_must_be() {
        for text in ["seed = nan", "seed = inf", "seed = 1e400", "seed = 1.5", "seed = -1", "seed = \"1\""] {
            assert!(parse(text).and_then(|s| s.whole("seed", 0..=u64::MAX)).is_err(), "{text}");
        }
        for (text, n) in [("seed = 2e8", 200_000_000), ("seed = 18446744073709551615", u64::MAX)] {
            assert_eq!(parse(text).unwrap().whole("seed", 0..=u64::MAX).unwrap(), Some(n));
        }
    }

    #[test]
    fn what_is_no_toml_is_refused_with_its_line() {
        assert!(parse("seed = 1\nbase = \n").unwrap_err().to_string().starts_with("s.toml, line 2: "));
        assert!(Settings::read(Path::new("/"), &NAMES).is_err());
        assert!(
            Settings::read(Path::new("/no/such"), &NAMES).unwrap_err().to_string().starts_with("/no/such")
        );
    }

    proptest! {
        #[test]
        fn parsing_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = Settings::parse(&bytes, "s.toml", PathBuf::new(), &NAMES);
        }
    }
}
