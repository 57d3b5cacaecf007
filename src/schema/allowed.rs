//! The types of settings, and which values they may have.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Which values a setting may have.
pub struct Allowed<T> {
    /// The same in words, as errors say it.
    pub words: String,
    test: Box<dyn Fn(&T) -> bool>,
}

impl<T> Allowed<T> {
    /// Whether a value is allowed.
    pub fn admits(&self, value: &T) -> bool {
        (self.test)(value)
    }
}

/// Values that pass a test; `words` says which they are.
pub fn only<T>(words: impl Into<String>, test: impl Fn(&T) -> bool + 'static) -> Allowed<T> {
    Allowed { words: words.into(), test: Box::new(test) }
}

/// Every value of the type; `words` says which they are.
pub fn any<T>(words: impl Into<String>) -> Allowed<T> {
    only(words, |_| true)
}

/// Whole numbers of a range.
pub fn whole(range: RangeInclusive<u64>) -> Allowed<u64> {
    only(format!("a whole number from {} to {}", range.start(), range.end()), move |n| range.contains(n))
}

/// Numbers of a range; `words` says which.
pub fn within(range: RangeInclusive<f64>, words: &str) -> Allowed<f64> {
    only(words, move |n| range.contains(n))
}

/// Finite numbers above 0.
pub fn above_zero() -> Allowed<f64> {
    only("a finite number above 0", |n: &f64| *n > 0.0 && n.is_finite())
}

/// The words of a type that has few.
pub fn words<T>(all: &[&str]) -> Allowed<T> {
    let quoted: Vec<String> = all.iter().map(|word| format!("\"{word}\"")).collect();
    any(match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    })
}

/// The type of a setting's value.
pub trait Leaf: Serialize + DeserializeOwned {
    /// Its type in TOML; most are one of a few words.
    const TOML_TYPE: &'static str = "string";

    /// The value with its relative paths starting from `folder`.
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
