//! The types of settings, and their allowed values.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::Value;
use super::length::{LENGTHS, millimetres};

/// Allowed values of a setting.
pub struct Allowed<T> {
    /// Allowed values in words, for errors.
    pub words: String,
    test: Box<dyn Fn(&T) -> bool>,
    /// Parser of the value from text, if text is accepted.
    of_text: Option<fn(&str) -> Option<T>>,
    /// Common values, for a shell to complete.
    offered: Vec<String>,
}

impl<T> Allowed<T> {
    /// Tells if a value is allowed.
    pub fn admits(&self, value: &T) -> bool {
        (self.test)(value)
    }
}

impl<T: Leaf> Allowed<T> {
    /// Reads a value, if it is of this type and allowed.
    pub fn read(&self, value: &Value) -> Option<T> {
        let read = match (value, self.of_text) {
            (Value::Text(text), Some(of_text)) => of_text(text),
            _ => T::deserialize(value).ok(),
        };
        read.filter(|value| self.admits(value))
    }

    /// Adds common values, for a shell to complete.
    pub fn offering(self, words: &[&str]) -> Self {
        Self { offered: words.iter().map(|word| (*word).to_owned()).collect(), ..self }
    }

    /// Common values.
    pub fn offered(&self) -> &[String] {
        &self.offered
    }

    /// Type in TOML.
    pub fn toml_type(&self) -> &'static str {
        if self.of_text.is_some() { "float or string" } else { T::TOML_TYPE }
    }
}

/// Values that pass a test; `words` describes them.
pub fn only<T>(words: impl Into<String>, test: impl Fn(&T) -> bool + 'static) -> Allowed<T> {
    Allowed { words: words.into(), test: Box::new(test), of_text: None, offered: Vec::new() }
}

/// Every value of the type; `words` describes them.
pub fn any<T>(words: impl Into<String>) -> Allowed<T> {
    only(words, |_| true)
}

/// Whole numbers of a range.
pub fn whole(range: RangeInclusive<u64>) -> Allowed<u64> {
    only(format!("a whole number from {} to {}", range.start(), range.end()), move |n| range.contains(n))
}

/// Numbers of a range; `words` describes it.
pub fn within(range: RangeInclusive<f64>, words: &str) -> Allowed<f64> {
    only(words, move |n| range.contains(n))
}

/// Finite numbers above 0.
pub fn above_zero() -> Allowed<f64> {
    only("a finite number above 0", |n: &f64| *n > 0.0 && n.is_finite())
}

/// Lengths above 0: numbers of mm, or text with a unit.
pub fn length() -> Allowed<f64> {
    Allowed { words: LENGTHS.into(), of_text: Some(millimetres), ..above_zero() }
}

/// Words of a type that has few.
pub fn words<T: Leaf>(all: &[&str]) -> Allowed<T> {
    let quoted: Vec<String> = all.iter().map(|word| format!("\"{word}\"")).collect();
    let allowed = any(match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    });
    allowed.offering(all)
}

/// The type of a setting's value.
pub trait Leaf: Serialize + DeserializeOwned {
    /// Type in TOML; most types are one of a few words.
    const TOML_TYPE: &'static str = "string";

    /// Makes the relative paths of the value start from `folder`.
    fn placed(self, folder: &Path) -> Self {
        let _ = folder;
        self
    }
}

impl Leaf for bool {
    const TOML_TYPE: &'static str = "boolean";
}
impl Leaf for u64 {
    const TOML_TYPE: &'static str = "integer";
}
impl Leaf for f64 {
    const TOML_TYPE: &'static str = "float";
}
impl Leaf for String {}
impl Leaf for Vec<u64> {
    const TOML_TYPE: &'static str = "array of integers";
}
impl Leaf for Vec<f64> {
    const TOML_TYPE: &'static str = "array of floats";
}
impl Leaf for PathBuf {
    fn placed(self, folder: &Path) -> Self {
        folder.join(self)
    }
}
