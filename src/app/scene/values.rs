//! Values of settings other than numbers and texts: words, files and tables as a scene writes them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use voidwalk_core::network::Connectivity;
use voidwalk_core::schema::Leaf;

/// Source of a constriction curve: a file name has a folder or an ending.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum CurveSource {
    /// Filter shipped with the program.
    Shipped(String),
    /// A CSV file.
    File(PathBuf),
}

impl<'de> Deserialize<'de> for CurveSource {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let is_file =
            text.contains(['/', '\\']) || text.to_lowercase().ends_with(".csv") || text.ends_with(".txt");
        Ok(if is_file { Self::File(text.into()) } else { Self::Shipped(text) })
    }
}

impl Leaf for CurveSource {
    fn placed(self, folder: &Path) -> Self {
        match self {
            Self::File(path) => Self::File(folder.join(path)),
            shipped => shipped,
        }
    }
}

/// Declares a value that is one of several words.
macro_rules! words {
    ($(#[$about:meta])* $kind:ident { $($(#[$what:meta])* $variant:ident = $word:literal,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        pub enum $kind {
            $($(#[$what])* #[serde(rename = $word)] $variant,)*
        }

        #[allow(dead_code, reason = "some words are only read")]
        impl $kind {
            /// All values.
            pub const ALL: [Self; [$($word),*].len()] = [$(Self::$variant),*];

            /// Word in a scene.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)*
                }
            }
        }

        impl Leaf for $kind {}
    };
}

words! {
    /// Density of a packed filter.
    Density {
        /// Densest packing: no friction.
        Dense = "dense",
        /// Friction 0.1, between dense and loose. "medium" is accepted too.
        #[serde(alias = "medium")]
        Intermediate = "intermediate",
        /// Loose packing: friction 0.3.
        Loose = "loose",
    }
}

impl Density {
    /// Words accepted by [`Density::named`], for messages.
    pub const WORDS: &str = "dense, medium (or intermediate), loose";

    /// Density that a word names, as a scene reads it.
    pub fn named(word: &str) -> Option<Self> {
        match word {
            "medium" => Some(Self::Intermediate),
            word => Self::ALL.into_iter().find(|density| density.name() == word),
        }
    }

    /// Friction between grains during compression that makes a packing of this density.
    pub fn friction(self) -> f64 {
        match self {
            Self::Dense => 0.0,
            Self::Intermediate => 0.1,
            Self::Loose => 0.3,
        }
    }
}

words! {
    /// Density of a filter whose constrictions come from the library of packings.
    LibraryDensity {
        Dense = "dense",
        #[serde(alias = "medium")]
        Intermediate = "intermediate",
        Loose = "loose",
        /// Anything from loose to dense.
        Unknown = "unknown",
    }
}

impl LibraryDensity {
    /// Relative density from 0 (loose) to 1 (dense); 0.5 if it is unknown.
    pub(crate) fn relative(self) -> f64 {
        match self {
            Self::Loose => 0.0,
            Self::Intermediate | Self::Unknown => 0.5,
            Self::Dense => 1.0,
        }
    }
}

words! {
    /// Structure of a network.
    NetworkMadeOf {
        Lattice = "lattice",
        /// Voids of a packing.
        Graph = "graph",
    }
}

words! {
    /// Units that a sheet shows.
    SheetUnits {
        Metric = "metric",
        /// Millimetres and inches.
        Us = "us",
    }
}

words! {
    /// Regrading of a base before its walk.
    Regrade {
        Practice = "practice",
        No = "no",
    }
}

/// Percent of the voids by connectivity, as written in a scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct VoidConnectivity(pub(crate) Connectivity);

const TABLE_3: &str = "table3";

/// Forms in which connectivity may be written.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum WrittenConnectivity {
    Name(String),
    Percent(BTreeMap<String, f64>),
}

impl Serialize for VoidConnectivity {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let percent = self.0.percent().iter().map(|(k, share)| (k.to_string(), *share));
        match self.0 == Connectivity::table_3() {
            true => WrittenConnectivity::Name(TABLE_3.into()),
            false => WrittenConnectivity::Percent(percent.collect()),
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for VoidConnectivity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::Error;
        let percent = match WrittenConnectivity::deserialize(deserializer)? {
            WrittenConnectivity::Name(name) if name == TABLE_3 => return Ok(Self(Connectivity::table_3())),
            WrittenConnectivity::Name(name) => return Err(D::Error::custom(name)),
            WrittenConnectivity::Percent(percent) => percent,
        };
        let one = |(k, share): (&String, &f64)| Some((k.parse::<u32>().ok()?, *share));
        let percent: Vec<_> =
            percent.iter().map(one).collect::<Option<_>>().ok_or_else(|| D::Error::custom("not a number"))?;
        Connectivity::new(&percent).map(Self).map_err(D::Error::custom)
    }
}

impl Leaf for VoidConnectivity {
    const TOML_TYPE: &'static str = "string or table";
}
