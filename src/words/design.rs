//! The lines that every face of a design begins with: those of practice, and that of the model.

use super::specification::{band, no_band};
use crate::outcome::design::{Design, Specification, are_few};
use crate::outcome::quantity::{NumberRole, SizeUnit, length, significant};

/// Which share of so many networks is shown: of few the least and the most of them.
pub fn share_of_networks(networks: u64) -> &'static str {
    if are_few(networks) { "least and most" } else { "5 to 95 % range" }
}

/// The ends of a boundary over so many networks, as `4.77 to 4.97`, and what they are the ends of.
pub fn over_networks(ends: &str, networks: u64) -> String {
    match are_few(networks) {
        true => format!("{ends} over {networks} networks"),
        false => format!("{ends}, {} of {networks} networks", share_of_networks(networks)),
    }
}

/// The share of so many networks that figures draw, which is read between two networks where they are few.
pub fn drawn_of_networks(networks: u64) -> &'static str {
    if are_few(networks) { "interpolated 5 to 95 % range" } else { "5 to 95 % range" }
}

/// The lines, each under its name: of a base without a size the model's alone.
pub fn design_lines(design: &Design, unit: SizeUnit) -> Vec<(&'static str, String)> {
    let practice =
        design.specification.iter().flat_map(|specification| specification_lines(specification, unit));
    practice.chain([("Model (research)", design_model(design, unit))]).collect()
}

/// The least D15F/D85B that nearly all networks hold, and its D15F where the base has a size.
pub fn design_model(design: &Design, unit: SizeUnit) -> String {
    let Some((row, ratio)) = design.least_held() else {
        return "no D15F/D85B is known that nearly all networks hold".into();
    };
    let size = design
        .base
        .d85_mm
        .map(|d85| format!(", D15F {}", length(ratio * d85, unit).role(NumberRole::Greatest)));
    let holds_whole_search = row.no_erosion.is_none() && row.eroding_networks() == 0;
    format!(
        "nearly all networks hold D15F/D85B {}{}{}",
        significant(ratio).role(NumberRole::Greatest),
        size.unwrap_or_default(),
        if holds_whole_search { ", as far as was searched" } else { "" }
    )
}

/// The band, and the limit with whose it is.
fn specification_lines(specification: &Specification, unit: SizeUnit) -> [(&'static str, String); 2] {
    let band = band(specification, unit).unwrap_or_else(|| match &specification.no_band {
        Some(why) => format!("no band. {}", no_band(why, unit).trim_end_matches('.')),
        None => "no band".into(),
    });
    [("Practice", band), ("Limit", limit(specification, unit))]
}

/// The maximum D15F and whose rule sets it.
pub fn limit(specification: &Specification, unit: SizeUnit) -> String {
    match specification.strictest() {
        Some((curve, limit)) => {
            format!("D15F {} ({})", length(limit, unit).role(NumberRole::Greatest), curve.d15f_max_rule)
        }
        None => "not known".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::design::Boundary;
    use crate::verdict::SpecificationOptions;

    /// A design whose networks erode from these D15F/D85B on; none of them where there are none.
    fn design(ratios: &[f64], d85_mm: Option<f64>) -> Design {
        let networks: Vec<_> = ratios.iter().map(|ratio| Ok(*ratio)).collect();
        let no_erosion = if networks.is_empty() { None } else { Boundary::of(&networks, d85_mm) };
        let text = serde_json::json!({
            "version": "1", "filter": "f", "filter_cu": 1.5, "filter_d15_mm": null,
            "base": {"name": "b", "cu": null, "d15_mm": null, "d85_mm": d85_mm, "d95_over_d85": null,
                "tail_mass_fraction": 0.0},
            "threshold": 0.075, "replicates": 2, "seed": 1, "engine": "expected", "bracket": [0.5, 100.0],
            "step": 0.005, "model_leaves_out": [], "settings": [], "seconds": 1.0,
            "boundaries": [{"density": "loose", "thickness": "60 layers", "layers": 60, "thickness_mm": null,
                "grains_per_void": 0.6, "no_erosion": no_erosion, "continuing": null, "not_monotone": 0,
                "networks": []}],
        });
        serde_json::from_value(text).unwrap()
    }

    fn specified(points: &[(f64, f64)]) -> Specification {
        let base = [("b".to_owned(), Gradation::from_lines(points).unwrap())];
        Specification::of("b", &base, SpecificationOptions::default())
    }

    #[test]
    fn neither_practice_nor_the_model_changes_the_lines_of_the_other() {
        let core = specified(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]);
        let lines = |ratios: &[f64], specification: Option<&Specification>| {
            Design { specification: specification.cloned(), ..design(ratios, Some(0.2)) }.clone()
        };
        let lines = |ratios: &[f64], specification: Option<&Specification>| {
            design_lines(&lines(ratios, specification), SizeUnit::Mm)
        };
        let practice = specification_lines(&core, SizeUnit::Mm);
        for ratios in [&[][..], &[0.6, 0.6], &[9.0, 9.0]] {
            let [alone, beside] = [lines(ratios, None), lines(ratios, Some(&core))];
            assert_eq!(beside[..2], practice);
            assert_eq!(beside[2..], alone[..]);
        }
        // A ratio that is held is rounded down, as is its size.
        let model = &lines(&[4.034, 4.034], None)[0];
        assert_eq!(model.0, "Model (research)");
        assert_eq!(model.1, "nearly all networks hold D15F/D85B 4.03, D15F 0.806\u{202f}mm");
    }

    #[test]
    fn a_row_that_holds_nothing_leaves_no_ratio_known() {
        let mut two = design(&[3.0, 3.0], None);
        assert_eq!(two.least_held().map(|(_, ratio)| ratio), Some(3.0));
        two.boundaries.extend(design(&[], None).boundaries);
        assert!(two.least_held().is_none());
        // What holds all that was searched counts to its end, and is said to.
        two.boundaries[1].holds_to = Some(1.08);
        assert!(design_model(&two, SizeUnit::Mm).ends_with("1.08, as far as was searched"));
    }

    #[test]
    fn a_limit_of_which_only_the_most_is_known_is_not_known() {
        let open = [(0.25, 30.0), (0.5, 45.0), (1.0, 60.0), (2.0, 90.0), (4.0, 100.0)];
        let [(_, band), (_, limit)] = specification_lines(&specified(&open), SizeUnit::Mm);
        assert!(band.starts_with("no band. ") && limit == "not known", "{band} {limit}");
    }
}
