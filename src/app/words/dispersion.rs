//! The limit of a base that may be dispersive or not.

use voidwalk_practice::dispersion::BeyondDispersive;
use voidwalk_practice::quantity::{NumberRole, SizeUnit, Unit, beside_limit, length, significant};
use voidwalk_practice::{DispersiveLack, IfDispersive};

/// A filter that is too coarse for a dispersive base alone, in a clause.
pub(super) fn beyond_dispersive(beyond: &BeyondDispersive, unit: SizeUnit) -> String {
    let at_most = if beyond.limit.at_most { "at most " } else { "" };
    let [value, most] =
        beside_limit([Some(beyond.d15f_mm), Some(beyond.limit.d15f_max_mm)], false, Unit::Size(unit))
            .map(Option::unwrap_or_default);
    let without = beyond.without_percent.map(|part| {
        format!(" (D15F {value} without the filter's finest {} %)", significant(part).decimals(1))
    });
    let without = without.unwrap_or_default();
    format!("dispersive base: limit {at_most}{most}, not kept{without}")
}

/// The limit behind a recommended D15F (mm); `None` if that holds for a dispersive base too.
pub fn beside_dispersive(limit: IfDispersive, d15f_mm: f64, unit: SizeUnit) -> Option<String> {
    if !limit.at_most && limit.d15f_max_mm >= d15f_mm {
        return None;
    }
    let bound = match limit.lacks {
        Some(DispersiveLack::AnyLimit) => "less than",
        Some(DispersiveLack::D85B | DispersiveLack::LimitOfDesign) | None => "at most",
    };
    let most = length(limit.d15f_max_mm, unit).role(NumberRole::Greatest);
    Some(format!("dispersive base: {bound} {most}"))
}

/// The limit of D15F. A limit that no source gives is never stated as the limit of other bases.
pub fn dispersive_limit(limit: IfDispersive, unit: SizeUnit) -> String {
    let most = length(limit.d15f_max_mm, unit).role(NumberRole::Greatest).to_string();
    match limit.lacks.filter(|_| limit.at_most) {
        Some(DispersiveLack::AnyLimit) => {
            format!("less than {most}, by how much no source that was read says")
        }
        Some(DispersiveLack::D85B) => format!("at most {most}, as D85B is not known"),
        Some(DispersiveLack::LimitOfDesign) | None => format!("at most {most}"),
    }
}

/// The test that determines an unknown limit: this one, if no text has the limit.
pub fn test(limit: IfDispersive, of_the_pair: &'static str) -> &'static str {
    match limit.lacks {
        Some(DispersiveLack::D85B) => "have the base tested with a hydrometer",
        Some(DispersiveLack::LimitOfDesign | DispersiveLack::AnyLimit) | None => of_the_pair,
    }
}
