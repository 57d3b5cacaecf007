//! A finding: an entry of the table with its numbers.

use serde_json::Map;

use super::quantity::FindingValue;
use crate::outcome::record::{FindingRecord, Topic};

/// The name of the finding that the base is broadly graded.
pub const BROAD_BASE: &str = "broad_base";

/// What the table declares of a finding.
#[derive(Debug)]
pub struct Entry {
    /// Its name for programs.
    pub id: &'static str,
    /// What it is about.
    pub about: Topic,
    /// Its name in a word or two.
    pub label: &'static str,
    /// The names of its numbers, in order.
    pub names: &'static [&'static str],
    /// Those of them that no sentence shows, as a text beside them says them in words.
    pub unshown: &'static [&'static str],
    /// Its sentences, with the names of its numbers in braces. The first may stand in a headline.
    pub sentence: &'static str,
    /// Which setting changes it; may be empty.
    pub to_do: &'static str,
    /// The page of `src/docs` that explains it.
    pub page: &'static str,
}

/// The table of findings: of each entry a static, and a function of its name that takes its numbers.
macro_rules! findings {
    (@raw Count) => {
        u64
    };
    (@raw Text) => {
        &str
    };
    (@raw Reason) => {
        &crate::gradation::RegradeReason
    };
    (@raw $unit:ident) => {
        f64
    };
    (@value Reason $name:ident) => {
        FindingValue::Text($name.words())
    };
    (@value $unit:ident $name:ident) => {
        FindingValue::$unit($name.into())
    };
    (@or $default:expr) => {
        $default
    };
    (@or $default:expr, $given:expr) => {
        $given
    };
    ($(
        $(#[$doc:meta])*
        $id:ident($($name:ident: $unit:ident),*): $about:ident $(, unshown $($unshown:ident)+)?;
            $label:literal, $page:literal, $sentence:expr $(, to do $to_do:literal)?;
    )*) => {
        #[allow(non_upper_case_globals)]
        mod entries {
            use super::*;
            $(pub static $id: Entry = Entry {
                id: stringify!($id),
                about: Topic::$about,
                label: $label,
                names: &[$(stringify!($name)),*],
                unshown: &[$($(stringify!($unshown)),+)?],
                sentence: $sentence,
                to_do: findings!(@or "" $(, $to_do)?),
                page: $page,
            };)*
        }

        /// Every entry, the most important first.
        pub static ALL: &[&Entry] = &[$(&entries::$id),*];

        $(
            $(#[$doc])*
            #[allow(clippy::too_many_arguments)]
            pub fn $id($($name: findings!(@raw $unit)),*) -> Finding {
                let values = vec![$(findings!(@value $unit $name)),*];
                Finding { entry: &entries::$id, values }
            }
        )*

        /// Every finding with numbers of this size and this text.
        #[cfg(test)]
        pub fn all_with(size: f64, n: u64, text: &str) -> Vec<Finding> {
            let of = |unit: &str| match unit {
                "Percent" => FindingValue::Percent(size),
                "Mm" => FindingValue::Mm(size),
                "Ratio" => FindingValue::Ratio(size),
                "Points" => FindingValue::Points(size),
                "Count" => FindingValue::Count(n),
                _ => FindingValue::Text(text.into()),
            };
            let finding = |entry, values| Finding { entry, values };
            vec![$(finding(&entries::$id, vec![$(of(stringify!($unit))),*])),*]
        }
    };
}
pub(super) use findings;

/// An entry of the table with its numbers.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Its entry.
    pub entry: &'static Entry,
    /// Its numbers, in the order of the entry's names.
    pub values: Vec<FindingValue>,
}

impl PartialEq for Finding {
    fn eq(&self, other: &Self) -> bool {
        self.entry.id == other.entry.id && self.values == other.values
    }
}

impl Finding {
    /// Its name for programs.
    pub fn id(&self) -> &'static str {
        self.entry.id
    }

    /// What it says.
    pub fn sentence(&self) -> String {
        self.filled(self.entry.sentence)
    }

    /// The sentence, and which setting changes it.
    pub fn with_to_do(&self) -> String {
        self.record().with_to_do()
    }

    /// As it is written.
    pub fn record(&self) -> FindingRecord {
        let names = self.entry.names.iter().zip(&self.values);
        let numbers: Map<_, _> =
            names.map(|(name, value)| (format!("{name}{}", value.suffix()), value.json())).collect();
        FindingRecord {
            id: self.entry.id.into(),
            about: self.entry.about,
            label: self.entry.label.into(),
            numbers,
            sentence: self.sentence(),
            to_do: self.filled(self.entry.to_do),
        }
    }

    /// A template with the numbers in the place of their names: `{name}`, or `{name:noun}` of a count.
    fn filled(&self, template: &str) -> String {
        let mut text = String::new();
        let mut rest = template;
        while let Some((before, after)) = rest.split_once('{') {
            let (field, after) = after.split_once('}').unwrap_or((after, ""));
            let (name, noun) = field.split_once(':').map_or((field, None), |(name, noun)| (name, Some(noun)));
            let at = self.entry.names.iter().position(|of| *of == name);
            text += before;
            text += &at.and_then(|at| self.values.get(at)).map_or(String::new(), |value| value.shown(noun));
            rest = after;
        }
        text += rest;
        // A text may be empty.
        text.split(' ').filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ")
    }
}
