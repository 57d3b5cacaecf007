//! Types of settings, their allowed values, and values as written.

use super::length::{LENGTHS, millimetres};
use serde::de::value::{Error, MapDeserializer, SeqDeserializer};
use serde::de::{DeserializeOwned, Error as _, IntoDeserializer, Visitor};
use serde::{Deserializer, Serialize, forward_to_deserialize_any};
use std::fmt;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use toml::de::DeValue;

/// Allowed values of a setting.
pub struct Allowed<T> {
    /// Allowed values in words, for errors.
    pub words: String,
    test: Box<dyn Fn(&T) -> bool>,
    /// Parser for values written as text, if text is accepted.
    of_text: Option<fn(&str) -> Option<T>>,
    /// Common values, offered for shell completion.
    pub offered: Vec<String>,
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

    /// Adds common values for shell completion.
    pub fn offering(self, words: &[&str]) -> Self {
        Self { offered: words.iter().map(|word| (*word).to_owned()).collect(), ..self }
    }

    /// Type in TOML.
    pub fn toml_type(&self) -> &'static str {
        if self.of_text.is_some() { "float or string" } else { T::TOML_TYPE }
    }
}

/// Allows values that pass a test; `words` describes them.
pub fn only<T>(words: impl Into<String>, test: impl Fn(&T) -> bool + 'static) -> Allowed<T> {
    Allowed { words: words.into(), test: Box::new(test), of_text: None, offered: Vec::new() }
}

/// Allows every value of the type; `words` describes them.
pub fn any<T>(words: impl Into<String>) -> Allowed<T> {
    only(words, |_| true)
}

/// Allows whole numbers in a range.
pub fn whole(range: RangeInclusive<u64>) -> Allowed<u64> {
    only(format!("a whole number from {} to {}", range.start(), range.end()), move |n| range.contains(n))
}

/// Allows numbers in a range; `words` describes it.
pub fn within(range: RangeInclusive<f64>, words: &str) -> Allowed<f64> {
    only(words, move |n| range.contains(n))
}

/// Allows finite numbers above 0.
pub fn above_zero() -> Allowed<f64> {
    only("a finite number above 0", |n: &f64| *n > 0.0 && n.is_finite())
}

/// Allows lengths above 0: numbers in mm, or text with a unit.
pub fn length() -> Allowed<f64> {
    Allowed { words: LENGTHS.into(), of_text: Some(millimetres), ..above_zero() }
}

/// Allows the words of a type that has only a few.
pub fn words<T: Leaf>(all: &[&str]) -> Allowed<T> {
    let quoted: Vec<String> = all.iter().map(|word| format!("\"{word}\"")).collect();
    let allowed = any(match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    });
    allowed.offering(all)
}

/// Type of a setting's value.
pub trait Leaf: Serialize + DeserializeOwned {
    /// Type in TOML; most types have a few allowed words.
    const TOML_TYPE: &'static str = "string";

    /// Resolves relative paths in the value from `folder`.
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

/// A value as written.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Text.
    Text(String),
    /// A number, with all its digits.
    Number(String),
    /// A list.
    List(Vec<Value>),
    /// A table, in the order of its text.
    Table(Vec<(String, Value)>),
    /// Anything else: a date, a boolean, a non-decimal integer.
    Other(String),
}

impl Value {
    /// Reads a value from a command line: as TOML, or else as text.
    pub fn of_assignment(text: &str) -> Self {
        match DeValue::parse(text) {
            Ok(parsed) => Self::from(parsed.get_ref()),
            Err(_) => Self::Text(text.into()),
        }
    }

    /// Reads a finite number.
    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(digits) => digits.parse::<f64>().ok().filter(|n| n.is_finite()),
            _ => None,
        }
    }

    /// Reads a whole number written as `200000000`, `2e8` or `2.5e8`.
    fn whole(&self) -> Option<u64> {
        let Self::Number(digits) = self else { return None };
        if let Ok(n) = digits.parse::<u64>() {
            return Some(n);
        }
        let n = digits.parse::<f64>().ok()?;
        (n.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(&n)).then_some(n as u64)
    }
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

impl<'de> IntoDeserializer<'de> for &'de Value {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// Reads digits by the type of the setting: a count may be written `2e8`, and a length must be finite.
impl<'de> Deserializer<'de> for &'de Value {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self {
            Value::Text(text) if !text.is_empty() => visitor.visit_str(text),
            Value::List(items) => visitor.visit_seq(SeqDeserializer::new(items.iter())),
            Value::Table(items) => visitor
                .visit_map(MapDeserializer::new(items.iter().map(|(key, value)| (key.as_str(), value)))),
            Value::Number(_) => self.deserialize_f64(visitor),
            Value::Text(_) | Value::Other(_) => Err(Error::custom("not allowed here")),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self {
            Value::Other(word) if word == "true" => visitor.visit_bool(true),
            Value::Other(word) if word == "false" => visitor.visit_bool(false),
            _ => Err(Error::custom("not true or false")),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_f64(self.number().ok_or_else(|| Error::custom("not a finite number"))?)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_u64(self.whole().ok_or_else(|| Error::custom("not a whole number"))?)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self {
            Value::Text(text) => visitor.visit_enum(text.as_str().into_deserializer()),
            _ => Err(Error::custom("not a word")),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i64 i128 u8 u16 u32 u128 f32 char str string bytes byte_buf option unit
        unit_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}
