//! The words of what an answer leaves out: what the model does not contain, and what a scene does not need.

use std::fmt;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::quantity::{fixed, given};
use crate::outcome::record::ModelLimit;
use crate::walk::{Engine, Finest, Shortcut};

impl ModelLimit {
    /// What it is in brief, and the rest of what is said of it.
    fn parts(&self) -> (&str, &str) {
        const HYDRAULICS: &str = "no flow, no gradient, no time; an increment is not an interval of time";
        const GRADIENT: &str = "no gradient, no time; an increment is not an interval of time";
        match self {
            Self::Hydraulics => ("hydraulics", HYDRAULICS),
            Self::HydraulicsElsewhere => ("hydraulics, in the other cases", HYDRAULICS),
            Self::Gradient => ("hydraulics but for the direction and the shares of slow flow", GRADIENT),
            Self::GradientThere => (
                "hydraulics but for the direction and the shares of slow flow, where water gives particles \
                 their way",
                GRADIENT,
            ),
            Self::Bridging => ("bridging", "a particle is stopped only by a constriction finer than itself"),
            Self::PartialClogging => {
                ("partial clogging", "a constriction is open at its full size or blocked")
            }
            Self::Supply => ("a limit to what enters", "all base particles are offered to the filter"),
            Self::Excessive => (
                "the excessive-erosion class of Foster and Fell",
                "the verdict knows no, some and continuing erosion",
            ),
            Self::Cohesion => (
                "cohesion, dispersion, suffusion of the filter itself, segregation and layering of the \
                 filter",
                "",
            ),
        }
    }
}

impl fmt::Display for ModelLimit {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.parts() {
            (brief, "") => f.write_str(brief),
            (brief, rest) => write!(f, "{brief}: {rest}"),
        }
    }
}

impl Serialize for ModelLimit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for ModelLimit {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let words = String::deserialize(deserializer)?;
        let known = Self::ALL.into_iter().find(|limit| limit.to_string() == words);
        known.ok_or_else(|| D::Error::custom(format!("{words:?} is no limit of the model")))
    }
}

/// What no rule covers, as no text was read that gives its numbers.
pub const NOT_COVERED: &str = "Not covered by the rules: segregation by D90F and D10F, excessive erosion.";

/// What the model does not contain and what no rule covers, in two sentences.
pub fn left_out_in_brief(limits: &[ModelLimit]) -> String {
    let brief: Vec<&str> = limits.iter().map(|limit| limit.parts().0).collect();
    format!("The model leaves out: {}. {NOT_COVERED}", brief.join("; "))
}

/// A part of the program that a scene does not need, or a study of which nothing is walked.
#[derive(Clone, Debug, PartialEq)]
pub enum LeftOut {
    /// A lattice, where the voids of a packing are the network.
    Lattice,
    /// All before the network, where that is given.
    BeforeNetwork,
    /// A given curve, where a packing is measured.
    GivenCurve,
    /// Packing, where the curve comes from the library.
    PackingByLibrary,
    /// Packing, where the curve is guessed.
    PackingByGuess,
    /// Packing, where the curve is given.
    PackingByCurve,
    /// Packing, where the packing of this folder has the filter's shape and is taken so many times as large.
    PackingOfShape(String, f64),
    /// The second run.
    SecondRun,
    /// Multiples of that number above the cap, and the cap.
    AmountsAboveCap(Vec<f64>, f64),
    /// Multiples of that number that give a number which is walked already.
    AmountsTheSame(Vec<f64>),
    /// Another thickness of a network from a file.
    ThicknessOfFile,
    /// A multiple of the thickness, and why it cannot be walked.
    ThicknessRefused(f64, String),
    /// A multiple of the thickness that has as many layers, or as many copies of a packing.
    ThicknessTheSame(f64, u64, LayerKind),
}

/// What a network consists of along the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerKind {
    /// Layers of a lattice.
    Layer,
    /// Copies of a packing.
    Copy,
}

/// The study of the number of base particles.
const AMOUNTS: &str = "sensitivity to the number of base particles";

impl LeftOut {
    /// What it says, as a part of a sentence.
    pub fn words(&self) -> String {
        let times = |factors: &[f64]| {
            factors.iter().map(|factor| format!("x{}", given(*factor))).collect::<Vec<_>>().join(", ")
        };
        let text = match self {
            Self::Lattice => "a lattice: the voids of the packing are the network",
            Self::BeforeNetwork => "packing, triangulation and constriction curve: the network is given",
            Self::GivenCurve => "a given constriction curve: it is measured on the packing",
            Self::PackingByLibrary => {
                "packing and triangulation: the constriction curve is from the library of packings"
            }
            Self::PackingByGuess => {
                "packing and triangulation: the constriction curve is guessed from the gradation"
            }
            Self::PackingByCurve => "packing and triangulation: the constriction curve is given",
            Self::PackingOfShape(folder, factor) => {
                let factor = fixed(*factor, 4);
                return format!(
                    "packing the filter: the packing in {folder} has its shape, and was taken {factor} \
                     times as large"
                );
            }
            Self::SecondRun => "the second run: it was not asked for",
            Self::AmountsAboveCap(factors, cap) => {
                let cap = given(*cap);
                return format!("{AMOUNTS}, {}: more than base.cap, {cap}, allows", times(factors));
            }
            Self::AmountsTheSame(factors) => {
                return format!(
                    "{AMOUNTS}, {}: the same number of particles as the scene itself or another factor",
                    times(factors)
                );
            }
            Self::ThicknessOfFile => {
                "filters of another thickness: a network from a file is as thick as it is"
            }
            Self::ThicknessRefused(factor, why) => {
                return format!("a filter {} times as thick: {why}", given(*factor));
            }
            Self::ThicknessTheSame(factor, parts, kind) => {
                let noun = match (kind, parts) {
                    (LayerKind::Copy, 1) => "copy of the packing",
                    (LayerKind::Copy, _) => "copies of the packing",
                    (LayerKind::Layer, 1) => "layer",
                    (LayerKind::Layer, _) => "layers",
                };
                return format!(
                    "a filter {} times as thick: to the nearest whole number it has the same {parts} {noun}",
                    given(*factor)
                );
            }
        };
        text.into()
    }
}

impl Shortcut {
    /// What it says, in a sentence; sizes have this unit.
    pub fn sentence(&self, unit: &str) -> String {
        let followed = |engine: Engine| match engine {
            Engine::Expected => "only their expected number in each void is followed",
            _ => "only their number in each void is followed, which is exact",
        };
        let finest_open = |finest: Finest| {
            format!("the finest open constriction of this walk ({} {unit})", fixed(finest.size_mm, 4))
        };
        match *self {
            Self::NothingOpen => {
                "No constriction is open: every base particle stays in the void it starts in.".into()
            }
            Self::NonePassive(finest) => {
                let fine = if finest.arches { "too fine to arch in" } else { "as fine as" };
                let open = finest_open(finest);
                format!("No base particle is {fine} {open}, so none is kept as a count.")
            }
            Self::Openings => {
                "Blocked constrictions leave openings that may stop a particle of any size: none is \
                               kept as a count."
                    .into()
            }
            Self::AllPassive(finest, engine) => format!(
                "Every base particle passes every open constriction (finest {} {unit}){}: nothing can be \
                 blocked, and none is walked on its own; {}.",
                fixed(finest.size_mm, 4),
                if finest.arches { ", and is too fine to arch" } else { "" },
                followed(engine)
            ),
            Self::MostPassive(percent, finest, engine) => format!(
                "All but {} % of the base particles by number are {} {} and can block nothing: {}, and \
                 their sizes are drawn where they come to rest.",
                digits(percent),
                if finest.arches { "too fine to arch in" } else { "no coarser than" },
                finest_open(finest),
                followed(engine)
            ),
            Self::OneSize => "The base has one size: no column of diameters is kept.".into(),
            Self::FewPassive(passive, start_nodes) => format!(
                "None is kept as a count: {passive} passive base particles an increment for {start_nodes} \
                 start nodes are so few that walking each by itself is faster, and the distribution is the \
                 same."
            ),
        }
    }
}

/// A number of percent with four digits that mean something: `19.65`, `0.002500`, `3.000e-7`.
fn digits(percent: f64) -> String {
    match percent {
        few if few < 1e-3 && few.is_finite() => format!("{few:.3e}"),
        many => fixed(many, (3.0 - libm::log10(many).floor()).max(0.0) as usize),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::{Modelled, leaves_out};

    const NUMBERS: [f64; 8] = [0.0, 1e-300, -1.0, 12.345, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

    #[track_caller]
    fn reads_well(words: &str) {
        assert!(!words.contains("NaN") && !words.contains("inf ") && !words.contains("inf)"), "{words}");
        assert!(!words.is_empty() && !words.contains("  ") && words.len() < 300, "{words}");
    }

    fn all(number: f64, n: u64, text: &str) -> Vec<LeftOut> {
        vec![
            LeftOut::Lattice,
            LeftOut::BeforeNetwork,
            LeftOut::GivenCurve,
            LeftOut::PackingByLibrary,
            LeftOut::PackingByGuess,
            LeftOut::PackingByCurve,
            LeftOut::PackingOfShape(text.into(), number),
            LeftOut::SecondRun,
            LeftOut::AmountsAboveCap(vec![number, 2.0], number),
            LeftOut::AmountsTheSame(vec![number]),
            LeftOut::ThicknessOfFile,
            LeftOut::ThicknessRefused(number, text.into()),
            LeftOut::ThicknessTheSame(number, n, LayerKind::Layer),
            LeftOut::ThicknessTheSame(number, n, LayerKind::Copy),
        ]
    }

    #[test]
    fn everything_left_out_reads_well_with_any_numbers() {
        for number in NUMBERS {
            for n in [0, 1, u64::MAX] {
                for item in all(number, n, "a reason") {
                    let words = item.words();
                    reads_well(&words);
                    assert!(words.contains(": ") && !words.ends_with('.'), "{words}");
                }
                let of_run = |engine| {
                    [false, true].into_iter().flat_map(move |arches| {
                        let finest = Finest { size_mm: number, arches };
                        [
                            Shortcut::NothingOpen,
                            Shortcut::NonePassive(finest),
                            Shortcut::Openings,
                            Shortcut::AllPassive(finest, engine),
                            Shortcut::MostPassive(number, finest, engine),
                            Shortcut::OneSize,
                            Shortcut::FewPassive(n, n),
                        ]
                    })
                };
                for item in Engine::ALL.into_iter().flat_map(of_run) {
                    reads_well(&item.sentence("mm"));
                    assert!(item.sentence("mm").ends_with('.'), "{item:?}");
                    assert!(!item.sentence("D0F").contains(" mm"), "{item:?}");
                }
            }
        }
        assert_eq!(digits(19.654), "19.65");
        assert_eq!((digits(0.0025), digits(3e-7)), ("0.002500".into(), "3.000e-7".into()));
    }

    #[test]
    fn limits_of_the_model_are_written_as_words_and_read_back() {
        for limit in ModelLimit::ALL {
            reads_well(&limit.to_string());
            let text = serde_json::to_string(&limit).unwrap();
            assert_eq!(serde_json::from_str::<ModelLimit>(&text).unwrap(), limit);
        }
        assert!(serde_json::from_str::<ModelLimit>("\"Hydraulics: no gradient, no flow rate.\"").is_err());
        let brief = left_out_in_brief(&leaves_out(Modelled::default()));
        assert!(
            brief.starts_with("The model leaves out: hydraulics; bridging; partial clogging; "),
            "{brief}"
        );
        assert!(brief.ends_with(
            "; cohesion, dispersion, suffusion of the filter itself, segregation and layering of the filter. \
             Not covered by the rules: segregation by D90F and D10F, excessive erosion."
        ));
    }
}
