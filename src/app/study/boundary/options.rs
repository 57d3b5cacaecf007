//! Options of a search of boundaries, and the place of its results.

use std::path::PathBuf;

use crate::run::prepare::PrepareOptions;
use crate::scene::{Extent, NetworkKeys, USUAL_LAYERS};
use voidwalk_core::schema::length::{LENGTHS, millimetres};

/// Options of a search of boundaries, and the place of its results.
#[derive(Clone, Debug)]
pub struct BoundaryOptions {
    /// Sieve table of the base; without it the settings define the base.
    pub base: Option<PathBuf>,
    /// The filter's shape: a sieve table, a Cu, or a shipped curve's name; without it the settings define it.
    pub filter: Option<String>,
    /// Densities: a word, `friction=F` or `estimate=D`.
    pub densities: Vec<String>,
    /// True if this very filter is packed; otherwise the library of packings gives its constrictions.
    pub pack: bool,
    /// Thicknesses.
    pub thicknesses: Vec<Thickness>,
    /// Settings of the built-in scene, as `base.cu=3`.
    pub settings: Vec<String>,
    /// True if the base is walked as it was sampled. Otherwise a base with a size of its own is walked as
    /// filter practice regrades it, unless `settings` contain `base.regrade`.
    pub as_sampled: bool,
    /// True if base and filter are taken as they are given, though their sizes look exchanged.
    pub as_given: bool,
    /// Folder for the results.
    pub out: PathBuf,
    /// True if earlier results there are replaced.
    pub overwrite: bool,
    /// Threads, memory and the folder of packings.
    pub prepare: PrepareOptions,
}

impl Default for BoundaryOptions {
    fn default() -> Self {
        Self {
            base: None,
            filter: None,
            densities: Vec::new(),
            pack: false,
            thicknesses: Vec::new(),
            settings: Vec::new(),
            as_sampled: false,
            as_given: false,
            out: "voidwalk-boundary".into(),
            overwrite: false,
            prepare: PrepareOptions::default(),
        }
    }
}

/// Unit of a filter's thickness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thickness {
    /// Layers of voids.
    Layers(u64),
    /// Millimetres.
    Mm(f64),
    /// Multiples of D50F by mass.
    D50F(f64),
}

impl Thickness {
    pub(super) fn of(network: &NetworkKeys) -> Self {
        match network.extent() {
            Extent::Mm(mm) => Self::Mm(mm),
            Extent::D50F(multiple) => Self::D50F(multiple),
            Extent::Copies(_) | Extent::Usual => {
                Self::Layers(network.source().shape().map_or(USUAL_LAYERS, |[_, _, nz]| nz.into()))
            }
        }
    }

    pub(super) fn setting(self) -> String {
        match self {
            Self::Layers(layers) => format!("network.nz={layers}"),
            Self::D50F(multiple) => format!("network.thickness_d50f={multiple:?}"),
            Self::Mm(mm) => format!("network.thickness_mm={mm:?}"),
        }
    }
}

impl std::str::FromStr for Thickness {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.trim().to_lowercase();
        let refused = || {
            format!(
                "--thickness {text}: allowed: layers of voids as 60layers, a multiple of D50F as 75D50F, or \
                 {LENGTHS}"
            )
        };
        let number = |rest: &str| rest.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
        if let Some(rest) = lower.strip_suffix("d50f") {
            return number(rest).map(Self::D50F).ok_or_else(refused);
        }
        if let Some(rest) = lower.strip_suffix("layers") {
            let layers = rest.trim().parse().ok().filter(|n| (1..=1_000_000).contains(n));
            return layers.map(Self::Layers).ok_or_else(refused);
        }
        millimetres(&lower).map(Self::Mm).ok_or_else(refused)
    }
}

/// Thicknesses with commas between them.
#[derive(Clone, Debug, PartialEq)]
pub struct ThicknessList(pub Vec<Thickness>);

impl std::str::FromStr for ThicknessList {
    type Err = String;

    /// Reads a list. `1,5m` may be one thickness with a decimal comma: a list has no number without a unit if
    /// another has one.
    fn from_str(text: &str) -> Result<Self, String> {
        let items: Vec<&str> = text.split(',').collect();
        let is_bare = |item: &&str| item.trim().parse::<f64>().is_ok();
        if let Some(at) = items.iter().position(&is_bare)
            && !items.iter().all(is_bare)
        {
            let bare = items[at].trim();
            let follows = items.get(at + 1).map(|next| next.trim());
            let follows = follows.filter(|next| next.starts_with(|c: char| c.is_ascii_digit()));
            let point = follows
                .map_or(String::new(), |next| format!("; or a decimal point, not a comma: {bare}.{next}"));
            return Err(format!(
                "--thickness {text}: {bare} has no unit, though another of the list has one; allowed: \
                 {bare}mm or {bare}layers{point}"
            ));
        }
        items.into_iter().map(str::parse).collect::<Result<_, _>>().map(Self)
    }
}

impl std::fmt::Display for Thickness {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Layers(n) => write!(f, "{n} layers"),
            Self::Mm(mm) => write!(f, "{mm} mm"),
            Self::D50F(multiple) => write!(f, "{multiple} D50F"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thickness_says_what_it_is_in() {
        let read = |text: &str| text.parse::<Thickness>();
        assert_eq!(read("60layers"), Ok(Thickness::Layers(60)));
        assert_eq!((read("500mm"), read("500")), (Ok(Thickness::Mm(500.0)), Ok(Thickness::Mm(500.0))));
        assert_eq!((read("2ft"), read("24in")), (Ok(Thickness::Mm(609.6)), Ok(Thickness::Mm(609.6))));
        assert_eq!(read("75 D50F"), Ok(Thickness::D50F(75.0)));
        for wrong in ["0", "0mm", "-3mm", "0layers", "2.5layers", "nanmm", "inf", "thick", ""] {
            assert!(read(wrong).unwrap_err().contains("or a length above 0"), "{wrong}");
        }
    }

    #[test]
    fn a_decimal_comma_is_no_list_of_two_thicknesses() {
        let read = |text: &str| text.parse::<ThicknessList>();
        let two = ThicknessList(vec![Thickness::Layers(12), Thickness::Mm(15.0)]);
        assert_eq!(read("12layers,15mm"), Ok(two.clone()));
        assert_eq!(read("12layers, 1.5cm"), Ok(two));
        assert_eq!(read("100,200"), Ok(ThicknessList(vec![Thickness::Mm(100.0), Thickness::Mm(200.0)])));
        assert!(read("1,5m").unwrap_err().contains("; or a decimal point, not a comma: 1.5m"));
        assert!(read("60layers,500").unwrap_err().ends_with("allowed: 500mm or 500layers"));
        assert!(read("12layers,thick").unwrap_err().contains("--thickness thick: allowed: "));
    }
}
