//! Words for what an answer leaves out: limits of the model, and parts that a scene does not need.

use crate::outcome::left_out::{LayerKind, LeftOut};
use crate::outcome::record::ModelLimit;
use voidwalk_core::walk::{Engine, Finest, Shortcut};
use voidwalk_practice::quantity::{given, significant};

/// Limit of the model in brief, and the rest of its meaning.
fn parts(limit: ModelLimit) -> (&'static str, &'static str) {
    const HYDRAULICS: &str = "no flow, no gradient, no time; an increment is not an interval of time";
    const GRADIENT: &str = "no gradient, no time; an increment is not an interval of time";
    match limit {
        ModelLimit::Hydraulics => ("hydraulics", HYDRAULICS),
        ModelLimit::HydraulicsElsewhere => ("hydraulics, in the other cases", HYDRAULICS),
        ModelLimit::Gradient => ("hydraulics except direction and distribution of slow flow", GRADIENT),
        ModelLimit::GradientThere => (
            "hydraulics except direction and distribution of slow flow, if water directs particles",
            GRADIENT,
        ),
        ModelLimit::Bridging => {
            ("bridging", "a particle is stopped only by a constriction finer than itself")
        }
        ModelLimit::PartialClogging => {
            ("partial clogging", "a constriction is open at its full size or blocked")
        }
        ModelLimit::Supply => ("a limit to what enters", "all base particles are offered to the filter"),
        ModelLimit::Excessive => (
            "the excessive-erosion class of Foster and Fell",
            "the verdict knows no, some and continuing erosion",
        ),
        ModelLimit::Cohesion => (
            "cohesion, dispersion, suffusion of the filter itself, segregation and layering of the filter",
            "",
        ),
    }
}

pub(crate) fn model_limit(limit: ModelLimit) -> String {
    match parts(limit) {
        (brief, "") => brief.to_owned(),
        (brief, rest) => format!("{brief}: {rest}"),
    }
}

/// Checks that no rule covers because no text with their numbers was read.
pub(crate) const NOT_COVERED: &str = "Not checked: segregation by D90F and D10F, excessive erosion.";

/// Limits of the model that matter most to a designer, in one line; the page lists all.
pub(crate) fn left_out_line(limits: &[ModelLimit]) -> String {
    let mut names: Vec<&str> = Vec::new();
    if limits.iter().any(|limit| [ModelLimit::Hydraulics, ModelLimit::HydraulicsElsewhere].contains(limit)) {
        names.push("hydraulics");
    }
    names.push("gradient");
    if limits.contains(&ModelLimit::Bridging) {
        names.push("bridging");
    }
    names.extend(["cohesion", "dispersion", "suffusion", "segregation"]);
    format!("The model is no proof; it leaves out {}.", names.join(", "))
}

/// Limits of the model and checks that no rule covers, in two sentences.
pub(crate) fn left_out_in_brief(limits: &[ModelLimit]) -> String {
    let brief: Vec<&str> = limits.iter().map(|limit| parts(*limit).0).collect();
    format!("The model leaves out: {}. {NOT_COVERED}", brief.join("; "))
}

const AMOUNTS: &str = "sensitivity to the number of base particles";

/// Part of the program that a scene does not need, as part of a sentence; sizes are in this unit.
pub(crate) fn left_out(part: &LeftOut, unit: &str) -> String {
    let times = |factors: &[f64]| {
        factors.iter().map(|factor| format!("x{}", given(*factor))).collect::<Vec<_>>().join(", ")
    };
    match part {
        LeftOut::Walk(shortcut) => shortcut_words(*shortcut, unit),
        LeftOut::Lattice => "a lattice: the voids of the packing are the network".into(),
        LeftOut::BeforeNetwork => {
            "packing, triangulation and constriction curve: the network is given".into()
        }
        LeftOut::GivenCurve => "a given constriction curve: it is measured on the packing".into(),
        LeftOut::PackingByLibrary => {
            "packing and triangulation: the constriction curve is from the library of packings".into()
        }
        LeftOut::PackingByGuess => {
            "packing and triangulation: the constriction curve is guessed from the gradation".into()
        }
        LeftOut::PackingByCurve => "packing and triangulation: the constriction curve is given".into(),
        LeftOut::PackingOfShape(folder, factor) => format!(
            "packing the filter: the packing in {folder} has its shape, and was taken {} times as large",
            significant(*factor).decimals(4)
        ),
        LeftOut::SecondRun => "the second run: it was not asked for".into(),
        LeftOut::AmountsAboveCap(factors, cap) => {
            format!("{AMOUNTS}, {}: more than base.cap, {}, allows", times(factors), given(*cap))
        }
        LeftOut::AmountsTheSame(factors) => format!(
            "{AMOUNTS}, {}: the same number of particles as the scene itself or another factor",
            times(factors)
        ),
        LeftOut::ThicknessOfFile => {
            "filters of another thickness: a network from a file is as thick as it is".into()
        }
        LeftOut::ThicknessRefused(factor, why) => {
            format!("a filter {} times as thick: {why}", given(*factor))
        }
        LeftOut::ThicknessTheSame(factor, parts, kind) => {
            let noun = match (kind, parts) {
                (LayerKind::Copy, 1) => "copy of the packing",
                (LayerKind::Copy, _) => "copies of the packing",
                (LayerKind::Layer, 1) => "layer",
                (LayerKind::Layer, _) => "layers",
            };
            format!(
                "a filter {} times as thick: to the nearest whole number it has the same {parts} {noun}",
                given(*factor)
            )
        }
    }
}

/// Several parts that a scene does not need, in words.
pub(crate) fn left_out_words(parts: &[LeftOut], unit: &str) -> String {
    parts.iter().map(|part| left_out(part, unit)).collect::<Vec<_>>().join("; ")
}

/// Shortcut of a walk, in a sentence; sizes are in this unit.
fn shortcut_words(shortcut: Shortcut, unit: &str) -> String {
    let followed = |engine: Engine| match engine {
        Engine::Expected => "only their expected number in each void is followed",
        _ => "only their number in each void is followed, which is exact",
    };
    let size = |finest: Finest| format!("{} {unit}", significant(finest.size_mm).decimals(4));
    match shortcut {
        Shortcut::NothingOpen => {
            "No constriction is open: every base particle stays in the void it starts in.".into()
        }
        Shortcut::NonePassive(finest) => format!(
            "No base particle is {} the finest open constriction of this walk ({}), so none is kept as a \
             count.",
            if finest.arches { "too fine to arch in" } else { "as fine as" },
            size(finest)
        ),
        Shortcut::Openings => "Blocked constrictions leave openings that may stop a particle of any size: \
                               none is kept as a count."
            .into(),
        Shortcut::AllPassive(finest, engine) => format!(
            "Every base particle passes every open constriction (finest {}){}: nothing can be blocked, and \
             none is walked on its own; {}.",
            size(finest),
            if finest.arches { ", and is too fine to arch" } else { "" },
            followed(engine)
        ),
        Shortcut::MostPassive(percent, finest, engine) => format!(
            "All but {} % of the base particles by number are {} the finest open constriction of this walk \
             ({}) and can block nothing: {}, and their sizes are drawn where they come to rest.",
            digits(percent),
            if finest.arches { "too fine to arch in" } else { "no coarser than" },
            size(finest),
            followed(engine)
        ),
        Shortcut::OneSize => "The base has one size: no column of diameters is kept.".into(),
        Shortcut::FewPassive(passive, start_nodes) => format!(
            "None is kept as a count: {passive} passive base particles an increment for {start_nodes} start \
             nodes are so few that walking each by itself is faster, and the distribution is the same."
        ),
    }
}

/// Percent with four significant digits: `19.65`, `0.002500`, `3.000e-7`.
fn digits(percent: f64) -> String {
    match percent {
        few if few < 1e-3 && few.is_finite() => format!("{few:.3e}"),
        many => significant(many).decimals((3.0 - libm::log10(many).floor()).max(0.0) as u8).to_string(),
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
                    let words = left_out(&item, "mm");
                    reads_well(&words);
                    assert!(words.contains(": ") && !words.ends_with('.'), "{words}");
                }
                let of_run = |engine| {
                    let [open, arching] = [false, true].map(|arches| Finest { size_mm: number, arches });
                    let mut all = vec![Shortcut::NothingOpen, Shortcut::Openings, Shortcut::OneSize];
                    all.push(Shortcut::FewPassive(n, n));
                    all.extend([open, arching].map(Shortcut::NonePassive));
                    all.extend([open, arching].map(|finest| Shortcut::AllPassive(finest, engine)));
                    all.extend([open, arching].map(|finest| Shortcut::MostPassive(number, finest, engine)));
                    all
                };
                for item in Engine::ALL.into_iter().flat_map(of_run) {
                    reads_well(&shortcut_words(item, "mm"));
                    assert!(shortcut_words(item, "mm").ends_with('.'), "{item:?}");
                    assert!(!shortcut_words(item, "D0F").contains(" mm"), "{item:?}");
                }
            }
        }
        assert_eq!(digits(19.654), "19.65");
        assert_eq!((digits(0.0025), digits(3e-7)), ("0.002500".into(), "3.000e-7".into()));
    }

    #[test]
    fn limits_of_the_model_are_written_as_words_and_read_back() {
        for limit in ModelLimit::ALL {
            reads_well(&model_limit(limit));
            let text = serde_json::to_string(&limit).unwrap();
            assert_eq!(serde_json::from_str::<ModelLimit>(&text).unwrap(), limit);
        }
        assert!(serde_json::from_str::<ModelLimit>("\"Hydraulics: no gradient, no flow rate.\"").is_err());
        let line = left_out_line(&leaves_out(Modelled::default()));
        assert_eq!(
            line,
            "The model is no proof; it leaves out hydraulics, gradient, bridging, cohesion, dispersion, \
             suffusion, segregation."
        );
        let modelled = Modelled { flow: true, arches: true, openings: false };
        let line = left_out_line(&leaves_out(modelled));
        assert!(line.contains("gradient") && !line.contains("hydraulics") && !line.contains("bridging"));
        let brief = left_out_in_brief(&leaves_out(Modelled::default()));
        assert!(brief.starts_with("The model leaves out: hydraulics; bridging; partial clogging; "));
        assert!(brief.ends_with(
            "; cohesion, dispersion, suffusion of the filter itself, segregation and layering of the filter. \
             Not checked: segregation by D90F and D10F, excessive erosion."
        ));
    }
}
