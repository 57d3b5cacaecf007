//! Values of settings beside numbers and texts: words, files and tables as a scene writes them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use voidwalk_core::network::Connectivity;
use voidwalk_core::schema::Leaf;

/// Where a constriction curve comes from: a file name has a folder or an ending.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveSource {
    /// A filter that comes with the program.
    Shipped(String),
    /// A CSV file.
    File(PathBuf),
}

impl Serialize for CurveSource {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Shipped(name) => name.serialize(serializer),
            Self::File(path) => path.serialize(serializer),
        }
    }
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

/// A word for how densely a filter is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Density {
    /// The densest packing: no friction.
    Dense,
    /// Between the two: friction 0.1. "medium" is read as this too.
    #[serde(alias = "medium")]
    Intermediate,
    /// Loose: friction 0.3.
    Loose,
}

impl Density {
    /// From the densest.
    pub const ALL: [Self; 3] = [Self::Dense, Self::Intermediate, Self::Loose];

    /// The word in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dense => "dense",
            Self::Intermediate => "intermediate",
            Self::Loose => "loose",
        }
    }

    /// The words that [`Density::named`] takes, for a message.
    pub const WORDS: &str = "dense, medium (or intermediate), loose";

    /// The density that a word names, as a scene reads it.
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

/// Density of a filter whose constrictions come from the library of packings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LibraryDensity {
    /// The densest packing.
    Dense,
    /// Between the two. "medium" is read as this too.
    #[serde(alias = "medium")]
    Intermediate,
    /// Loose.
    Loose,
    /// Not known: anything from loose to dense.
    Unknown,
}

impl LibraryDensity {
    /// From the densest, and the unknown one last.
    pub const ALL: [Self; 4] = [Self::Dense, Self::Intermediate, Self::Loose, Self::Unknown];

    /// From 0, loose, to 1, dense; the middle if it is unknown.
    pub fn relative(self) -> f64 {
        match self {
            Self::Loose => 0.0,
            Self::Intermediate | Self::Unknown => 0.5,
            Self::Dense => 1.0,
        }
    }

    /// The word in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dense => Density::Dense.name(),
            Self::Intermediate => Density::Intermediate.name(),
            Self::Loose => Density::Loose.name(),
            Self::Unknown => "unknown",
        }
    }
}

impl From<Density> for LibraryDensity {
    fn from(density: Density) -> Self {
        match density {
            Density::Dense => Self::Dense,
            Density::Intermediate => Self::Intermediate,
            Density::Loose => Self::Loose,
        }
    }
}

/// Structure of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NetworkMadeOf {
    /// A cubic lattice of voids.
    Lattice,
    /// The voids of a packing.
    Graph,
}

impl NetworkMadeOf {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Lattice, Self::Graph];

    /// Its name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lattice => "lattice",
            Self::Graph => "graph",
        }
    }
}

/// Units that a sheet shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SheetUnits {
    /// mm alone.
    Metric,
    /// Inches beside mm.
    Us,
}

impl SheetUnits {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Metric, Self::Us];

    /// The word in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metric => "metric",
            Self::Us => "us",
        }
    }
}

impl Leaf for SheetUnits {}
impl Leaf for NetworkMadeOf {}

/// Regrading of a base before its walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Regrade {
    /// Regraded by filter practice.
    Practice,
    /// Left unchanged.
    No,
}

impl Leaf for Regrade {}
impl Leaf for Density {}
impl Leaf for LibraryDensity {}

/// Percent of the voids by connectivity, as written in a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct VoidConnectivity(pub Connectivity);

const TABLE_3: &str = "table3";

/// The forms in which it may be written.
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
