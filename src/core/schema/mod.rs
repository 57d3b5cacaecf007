//! Settings, each declared once with its name, type, default, allowed values, and text for the user.
//!
//! A stage declares its settings with `section!`. From that one declaration follow the struct with its
//! fields, the reading of a TOML file and of `--set` with errors that name the line ([`GivenSettings`]),
//! the commented text that `voidwalk init` writes ([`KeyInfo`]), the check of values from a program, and
//! the written record ([`serde::Serialize`]). So no setting can be missing from one of these places.
//! [`Group`]s declare which settings exclude each other.

mod allowed;
pub mod hints;
pub mod length;
mod settings;

use serde::Serialize;

pub use allowed::length;
pub use allowed::{Allowed, Leaf, Value, above_zero, any, only, whole, within, words};
pub use settings::{Alternative, GivenSettings, Group, Names, Origin, SceneError, read_file, setting_name};

/// Description of a setting for the user, and its allowed values.
#[derive(Clone, Debug)]
pub struct KeyInfo {
    /// Section; empty for top-level settings.
    pub section: &'static str,
    /// Name inside the section.
    pub name: &'static str,
    /// Meaning, in words.
    pub doc: String,
    /// Type of the value in TOML: `float`, `array of integers`.
    pub toml_type: &'static str,
    /// Value if a scene does not set it, in TOML.
    pub default: Option<String>,
    /// Allowed values, in the words of the errors.
    pub allowed: String,
    /// Common values, if they are words.
    pub offered: Vec<String>,
    /// Sample value, in TOML.
    pub shown: String,
    /// True if the built-in scene sets this value; else it is an example.
    pub is_set: bool,
    /// Tells if a value is allowed.
    pub admits: fn(&Value) -> bool,
}

impl KeyInfo {
    /// Full name: `base.cu`.
    pub fn full_name(&self) -> String {
        full_name(self.section, self.name)
    }
}

/// Full name of a setting.
pub fn full_name(section: &str, name: &str) -> String {
    if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") }
}

/// A value set by a program that is out of range.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfRange {
    /// Name of the setting inside its section.
    pub name: &'static str,
    /// Value, in TOML.
    pub value: String,
    /// Allowed values.
    pub allowed: String,
}

/// Type of a setting: a value that is always present, or one that may be missing.
pub trait Setting: Sized {
    /// Type of its value.
    type Value: Leaf;

    /// Makes the setting from a value.
    fn given(value: Self::Value) -> Self;

    /// Value, if there is one.
    fn value(&self) -> Option<&Self::Value>;

    /// Tells if there is no value to write.
    fn is_missing(&self) -> bool {
        self.value().is_none()
    }
}

impl<T: Leaf> Setting for T {
    type Value = T;

    fn given(value: T) -> Self {
        value
    }

    fn value(&self) -> Option<&T> {
        Some(self)
    }
}

impl<T: Leaf> Setting for Option<T> {
    type Value = T;

    fn given(value: T) -> Self {
        Some(value)
    }

    fn value(&self) -> Option<&T> {
        self.as_ref()
    }
}

/// Writes a value in TOML.
pub fn in_toml(value: &impl Serialize) -> String {
    let mut text = String::new();
    match value.serialize(toml::ser::ValueSerializer::new(&mut text)) {
        Ok(_) => text,
        Err(error) => unreachable!("a setting is a number, a word or a list of them: {error}"),
    }
}

/// Declares a section of settings: a struct with the code that reads, checks, describes and writes it.
///
/// ```text
/// section! {
///     /// Subject of the section.
///     pub struct Base in "base" {
///         /// Meaning of the setting: for the docs and for `voidwalk init`.
///         pub cu: Option<f64> = None, set "1.5", within(1.0..=1000.0, "a number from 1 to 1000");
/// `name: type = default`; then the form in `init`: `set` as in the built-in scene, or `off` as a
/// comment, with a value if the default has none; then the allowed values.
///         pub cap: Option<u64> = None, off "2e8", whole(1..=u64::MAX);
///     }
///     // Fields that only a program sets, not a scene.
///     beside { pub probe: bool = false; }
/// }
/// ```
#[macro_export]
#[doc(hidden)]
macro_rules! section {
    (
        $(#[doc = $about:literal])*
        $visible:vis struct $Section:ident in $section:literal {
            $(
                $(#[doc = $doc:literal])*
                pub $name:ident: $Type:ty = $default:expr, $state:ident $($example:literal)?, $allowed:expr;
            )*
        }
        $(beside { $(
            $(#[doc = $beside_doc:literal])*
            pub $beside:ident: $Beside:ty = $beside_default:expr;
        )* })?
    ) => {
        $(#[doc = $about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        $visible struct $Section {
            $(
                $(#[doc = $doc])*
                #[serde(skip_serializing_if = "::voidwalk_core::schema::Setting::is_missing")]
                pub $name: $Type,
            )*
            $($(
                $(#[doc = $beside_doc])*
                #[serde(skip)]
                pub $beside: $Beside,
            )*)?
        }

        impl Default for $Section {
            fn default() -> Self {
                Self { $($name: $default,)* $($($beside: $beside_default,)*)? }
            }
        }

        impl $Section {
            /// Text for the user about the section.
            pub const ABOUT: &'static [&'static str] = &[$($about),*];

            /// Descriptions of the settings for the user, in writing order.
            pub fn keys() -> Vec<$crate::schema::KeyInfo> {
                vec![$({
                    type Checked = $crate::schema::Allowed<<$Type as $crate::schema::Setting>::Value>;
                    let allowed: Checked = $allowed;
                    let default: $Type = $default;
                    let default = $crate::schema::Setting::value(&default).map($crate::schema::in_toml);
                    let written = default.clone();
                    $( let written = written.or(Some($example.to_owned())); )?
                    $crate::schema::KeyInfo {
                        section: $section,
                        name: stringify!($name),
                        doc: [$($doc),*].concat().trim().to_owned(),
                        toml_type: allowed.toml_type(),
                        default,
                        offered: allowed.offered,
                        allowed: allowed.words,
                        shown: written.unwrap_or_default(),
                        is_set: stringify!($state) == "set",
                        admits: |value| {
                            let allowed: Checked = $allowed;
                            allowed.read(value).is_some()
                        },
                    }
                }),*]
            }

            /// Reads the given settings, with defaults for the others.
            ///
            /// # Errors
            /// A value that is not allowed.
            pub fn read(
                settings: &$crate::schema::GivenSettings,
            ) -> Result<Self, $crate::schema::SceneError> {
                Ok(Self {
                    $($name: {
                        let name = $crate::schema::full_name($section, stringify!($name));
                        let given = settings.get(&name, &$allowed)?;
                        given.map_or_else(|| $default, $crate::schema::Setting::given)
                    },)*
                    $($($beside: $beside_default,)*)?
                })
            }

            /// Finds the first setting whose value is not allowed.
            pub fn out_of_range(&self) -> Option<$crate::schema::OutOfRange> {
                $(
                    let allowed: $crate::schema::Allowed<<$Type as $crate::schema::Setting>::Value> =
                        $allowed;
                    let value = $crate::schema::Setting::value(&self.$name);
                    if let Some(value) = value.filter(|value| !allowed.admits(value)) {
                        return Some($crate::schema::OutOfRange {
                            name: stringify!($name),
                            value: $crate::schema::in_toml(value),
                            allowed: allowed.words,
                        });
                    }
                )*
                None
            }
        }
    };
}

pub use crate::section;
