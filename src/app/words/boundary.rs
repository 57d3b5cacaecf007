//! Words of every face for boundaries of the model.

use crate::outcome::boundary::{Boundaries, BoundaryRow, are_few};
use voidwalk_practice::quantity::{NumberRole, SizeUnit, greatest_length, significant};

/// Range of networks that is shown: for few networks the minimum and maximum.
pub(crate) fn share_of_networks(networks: u64) -> &'static str {
    if are_few(networks) { "least and most" } else { "5 to 95 % range" }
}

/// Ends of a boundary over networks, as `4.77 to 4.97`, with their meaning.
pub(crate) fn over_networks(ends: &str, networks: u64) -> String {
    match are_few(networks) {
        true => format!("{ends} over {networks} networks"),
        false => format!("{ends}, {} of {networks} networks", share_of_networks(networks)),
    }
}

/// Range of networks drawn in figures; with few networks it is read between two of them.
pub(crate) fn drawn_of_networks(networks: u64) -> &'static str {
    if are_few(networks) { "interpolated 5 to 95 % range" } else { "5 to 95 % range" }
}

/// Density of a row, with the range that it is an end of, or with its worse end.
pub(crate) fn row_name(row: &BoundaryRow) -> String {
    match (&row.end_of, &row.as_end) {
        (Some(range), _) => format!("{} (an end of the range of {range})", row.density),
        (None, Some(end)) => format!("density {} (its worse end: {end})", row.density),
        (None, None) => row.density.clone(),
    }
}

/// Lowest D15F/D85B that nearly all networks hold, and its D15F if the base has sizes in mm.
pub(crate) fn held(boundaries: &Boundaries, unit: SizeUnit) -> String {
    let Some((row, ratio)) = boundaries.least_held() else {
        return "no D15F/D85B is known that nearly all networks hold".into();
    };
    let size = boundaries.base.d85_mm.map(|d85| format!(", D15F {}", greatest_length(ratio * d85, unit)));
    let holds_whole_search = row.no_erosion.is_none() && row.eroding_networks() == 0;
    format!(
        "nearly all networks hold D15F/D85B {}{}{}",
        significant(ratio).role(NumberRole::Greatest),
        size.unwrap_or_default(),
        if holds_whole_search { ", as far as was searched" } else { "" }
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::boundary::Boundary;

    /// Record of networks that erode from these D15F/D85B; without ratios no network erodes.
    fn record(ratios: &[f64], d85_mm: Option<f64>) -> Boundaries {
        let networks: Vec<_> = ratios.iter().map(|ratio| Ok(*ratio)).collect();
        let no_erosion = if networks.is_empty() { None } else { Boundary::of(&networks, d85_mm) };
        let text = serde_json::json!({
            "version": "1", "filter": "f", "curve_name": "c", "filter_cu": 1.5, "filter_d15_mm": null,
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

    #[test]
    fn a_ratio_that_is_held_is_rounded_down_as_is_its_size() {
        let sentence = held(&record(&[4.034, 4.034], Some(0.2)), SizeUnit::Mm);
        assert_eq!(sentence, "nearly all networks hold D15F/D85B 4.03, D15F 0.806\u{202f}mm");
    }

    #[test]
    fn a_row_that_holds_nothing_leaves_no_ratio_known() {
        let mut two = record(&[3.0, 3.0], None);
        assert_eq!(two.least_held().map(|(_, ratio)| ratio), Some(3.0));
        two.boundaries.extend(record(&[], None).boundaries);
        assert!(two.least_held().is_none());
        // A row that holds to the end of the search counts up to that end, and the words say so.
        two.boundaries[1].holds_to = Some(1.08);
        assert!(held(&two, SizeUnit::Mm).ends_with("1.08, as far as was searched"));
    }
}
