//! Rules of practice as applied to two soils and recorded.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

/// A filter rule as applied.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct AppliedRule {
    /// Identifier of the rule, such as `sherard-dunnigan`.
    pub id: String,
    /// Author and statement of the rule.
    pub name: String,
    /// Author of the rule; empty if nobody is cited.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub authority: String,
    /// Further authorities whose texts state the rule; may be empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stated_by: Vec<String>,
    /// Role of the rule.
    pub role: RuleRole,
    /// True if the rule was made for these soils.
    pub applies: bool,
    /// Quantity that the rule limits, such as `D15F/D85B`.
    pub quantity: RuleQuantity,
    /// Value of the quantity for these inputs; `None` if they do not give it.
    pub value: Option<f64>,
    /// Side of `value` on which the true value lies, if the sieves give only a bound; `None` if the value
    /// is exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value_bound: Option<ValueBound>,
    /// Maximum or minimum that the rule allows; `None` if no number is known.
    pub limit: Option<f64>,
    /// Unit of value and limit: `mm`, `D0F` or `%`; empty for a ratio.
    #[cfg_attr(feature = "schemas", schemars(with = "String"))]
    pub unit: RuleUnit,
    /// True if `limit` is a minimum, false if it is a maximum.
    pub at_least: bool,
    /// True if the limit is not known exactly and is at most `limit`; it may lie on either side of
    /// `limit` if `needs` names two widely spaced sieves.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub limit_at_most: bool,
    /// True if the value keeps the limit; `None` if the rule has no result. For a rule of continuing
    /// erosion `true` only excludes continuing erosion, not some or excessive erosion.
    pub met: Option<bool>,
    /// Inputs missing for a result; may be empty.
    pub needs: Vec<RuleNote>,
    /// Notes on the value and on why the rule does not apply; may be empty.
    pub notes: Vec<RuleNote>,
    /// Soils that the rule was made for.
    pub applies_to: String,
    /// Limit in words.
    pub formula: String,
    /// Publication of the rule.
    pub source: String,
    /// Remainder of the filter without the largest finer part that it may lose by a rule of internal
    /// stability; `None` for other rules.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_finer: Option<WithoutFiner>,
    /// Curve of the filter that was read, if the filter is an envelope.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub filter_curve: String,
    /// Curve of the base that was read, if the base is an envelope.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub base_curve: String,
}

impl AppliedRule {
    /// Authorities that state the rule, its author first; empty for a check of this program.
    pub fn authorities(&self) -> Vec<&str> {
        let stated_by = self.stated_by.iter().map(String::as_str);
        std::iter::once(self.authority.as_str()).chain(stated_by).filter(|name| !name.is_empty()).collect()
    }

    /// True for a rule that applies to these soils and is not kept.
    pub fn is_broken(&self) -> bool {
        self.applies && self.met == Some(false) && self.role != RuleRole::Walk
    }
}

/// Unit of a rule's value and limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RuleUnit {
    /// Sizes in mm.
    #[serde(rename = "mm")]
    Mm,
    /// Sizes as multiples of D0F.
    #[serde(rename = "D0F")]
    D0f,
    /// A ratio.
    #[serde(rename = "")]
    One,
    /// Percent by mass.
    #[serde(rename = "%")]
    Percent,
}

impl RuleUnit {
    /// Name of the unit in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::D0f => "D0F",
            Self::One => "",
            Self::Percent => "%",
        }
    }
}

/// Side of a value on which the true value lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum ValueBound {
    /// The true value is at most the value.
    #[serde(rename = "at most")]
    AtMost,
    /// The true value is at least the value.
    #[serde(rename = "at least")]
    AtLeast,
}

/// Remainder of a filter without its finer part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct WithoutFiner {
    /// Finer part removed (percent of the filter's mass).
    pub percent: f64,
    /// D15 of the remainder (mm, or multiples of D0F if sizes have no unit).
    pub d15f: f64,
}

/// Quantity that a rule limits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum RuleQuantity {
    /// D15 of the filter.
    D15F,
    /// D15 of the filter over D85 of the base.
    #[serde(rename = "D15F/D85B")]
    D15FOverD85B,
    /// D15 of the filter over D95 of the base.
    #[serde(rename = "D15F/D95B")]
    D15FOverD95B,
    /// Any quantity that does not limit D15F, by its name.
    #[serde(untagged)]
    Named(Cow<'static, str>),
}

impl RuleQuantity {
    pub(crate) const fn named(name: &'static str) -> Self {
        Self::Named(Cow::Borrowed(name))
    }

    /// Name for readers.
    pub fn name(&self) -> &str {
        match self {
            Self::D15F => "D15F",
            Self::D15FOverD85B => "D15F/D85B",
            Self::D15FOverD95B => "D15F/D95B",
            Self::Named(name) => name,
        }
    }
}

impl fmt::Display for RuleQuantity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Role of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RuleRole {
    /// The filter retains the base without erosion.
    Retention,
    /// Erosion into a coarser filter stops.
    Continuation,
    /// The filter drains the base.
    Drainage,
    /// The filter does not segregate when placed.
    Placing,
    /// The filter holds its own fines.
    Stability,
    /// The walk agrees with tests; the rule checks the model, not the filter.
    Walk,
}

/// Declares the notes; a test can make each of them with any number. Faces have their words.
macro_rules! notes {
    ($($(#[$doc:meta])* $id:ident $(($($type:ty),*))?,)*) => {
        /// A note of a rule beside its result.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[cfg_attr(feature = "schemas", derive(schemars::JsonSchema), schemars(with = "schema::RuleNote"))]
        #[serde(tag = "id", content = "numbers", rename_all = "snake_case")]
        #[allow(missing_docs)]
        pub enum RuleNote {
            $($(#[$doc])* $id $(($($type),*))?,)*
        }

        impl RuleNote {
            /// Every note with all its numbers set to this one, for tests of a face.
            #[doc(hidden)]
            pub fn all_with(number: f64) -> Vec<Self> {
                vec![$(Self::$id $(($(number as $type),*))?),*]
            }
        }

        #[cfg(feature = "schemas")]
        mod schema {
            /// Note of a rule beside its result.
            #[derive(schemars::JsonSchema)]
            #[allow(dead_code)]
            pub(super) struct RuleNote {
                /// Name of the note.
                id: RuleNoteId,
                /// Number of the note, or its numbers in order; absent if it has none.
                #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
                numbers: serde_json::Value,
            }

            /// Name of a rule's note.
            #[derive(schemars::JsonSchema)]
            #[schemars(rename_all = "snake_case")]
            #[allow(dead_code)]
            enum RuleNoteId { $($id,)* }
        }
    };
}

notes! {
    // Missing inputs.
    NeedsFinesOfBase,
    NeedsD85B,
    NeedsD95B,
    NeedsD15B,
    /// D15 of the filter, which D0F would also give.
    NeedsD15F,
    /// D15 of the filter, which only sieves give.
    NeedsD15FSieved,
    NeedsD10F,
    NeedsFinesOfFilter,
    /// Sieves of the filter over the range in which the curves of a band are compared.
    NeedsSievesOfFilter,
    /// Gradation of the filter's finest part, for an index of its shape.
    NeedsFinestPartOfFilter,
    NeedsCurveOfFilter,
    NeedsCurveOfFilterInMm,
    /// A dispersion test of a base with 15 to 40 % fines.
    NeedsTestOfDispersive,
    /// A first run with some erosion.
    NeedsErosion,

    // Openings (mm) of two widely spaced sieves around a size.
    D15FBetween(f64, f64),
    D15BBetween(f64, f64),
    D85BBetween(f64, f64),
    D95BBetween(f64, f64),
    FilterBetween(f64, f64),
    BaseBetween(f64, f64),

    // Readings of the base.
    /// The other limit (mm) of a base with a flat part, which may be a gap.
    FlatBase(f64),
    Dispersive,
    /// NRCS category of the base.
    Category(u8),
    /// The base was regraded on this size (mm).
    RegradedOn(f64),
    BeforeRegrading,
    TakenAsSand,
    ResultOfModel,

    // Facts on a limit or a value.
    BeyondAnyLimit,
    NoClearBoundary,
    BeyondUnclearBoundary,
    /// The filter is within the boundary of continuing erosion; excessive erosion is not judged.
    ExcessiveNotJudged,
    /// Formula of the limit from fines and D85B: its factor, the fines content (%) at which it ends, and
    /// the fines content of the base (%).
    ByFines(f64, f64, f64),
    /// The limit of design is its floor, because this multiple of D85B is smaller (mm).
    FloorGoverns(f64, f64),
    /// D15B is finer than the finest sieve, and this multiple of it is smaller (mm) than the minimum for
    /// any filter.
    LeastGoverns(f64, f64),
    /// D15F is finer than the filter's finest sieve and at most the value.
    D15FAtMost,
    /// D15B is finer than the base's finest sieve: the limit is at most the one given.
    LimitAtMost,
    /// D15B is finer than the base's finest sieve: the limit is at least the one given.
    LimitAtLeast,
    CuAtLeast,
    /// Finest sieve of the filter (mm): the value is at most the percent that passes it.
    FinestSieveOfFilter(f64),
    /// Percent finer at which a band is widest.
    AtPercentFiner(f64),
    /// Percent finer from which a band is compared; no sieve gives the sizes below it.
    BandFrom(f64),
    /// Width of a joint (mm), D95B (mm), and their ratio.
    Joint(f64, f64, f64),
    LessThanSource,
    ChecksWalk,
    /// Factor by which the largest passing particle is finer than in tests, though coarser ones stay.
    FarFinerThanTests(f64),

    // Facts on the filter's internal stability.
    /// The split (%) at Kezdi's ratio, D'15 of the coarser part and d'85 of the finer part.
    KezdiAt(f64, f64, f64),
    /// First and last split that were judged (%).
    KezdiSplits(f64, f64),
    /// Percent of the filter finer than its finest sieve, where Kezdi's ratio is not known.
    KezdiHidden(f64),
    /// F (%) of an index of shape, and the maximum F (%).
    ShapeAt(f64, f64),
    /// F (%) of an index of shape, the smallest F that the sieves give (%), and the maximum F (%).
    ShapeAbovePan(f64, f64, f64),
    /// D90/D15, and the range of D90/D60 that is stable by Burenkova.
    BurenkovaRange(f64, f64, f64),
    WanFellSand,
    WanFellSilt,
    WanFellContours,

    // Reasons why a rule does not apply to these soils.
    /// Fines content of the base (%), for which other limits apply.
    LimitsByFines(f64),
    BurenkovaSoils,
    /// The filter is in Burenkova's third zone, above this D90/D60.
    BurenkovaThirdZone(f64),
    UniformFilter,
}

impl RuleNote {
    /// Openings (mm) of two widely spaced sieves, if the result depends on the sizes between them.
    pub(crate) fn sieves_between(self) -> Option<[f64; 2]> {
        match self {
            Self::D15FBetween(from, to)
            | Self::D15BBetween(from, to)
            | Self::D85BBetween(from, to)
            | Self::D95BBetween(from, to)
            | Self::FilterBetween(from, to)
            | Self::BaseBetween(from, to) => Some([from, to]),
            _ => None,
        }
    }
}

/// Openings (mm) of the two sieves around D15F, if they are widely spaced.
pub(crate) fn d15f_between(notes: &[RuleNote]) -> Option<[f64; 2]> {
    notes.iter().find_map(|note| match *note {
        RuleNote::D15FBetween(from, to) => Some([from, to]),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::RULES;

    #[test]
    fn a_quantity_is_written_by_its_name_and_read_back() {
        // No named quantity has the name of a limit of D15F.
        for quantity in RULES.iter().map(|rule| rule.quantity) {
            let text = serde_json::to_string(quantity).unwrap();
            assert_eq!(text, format!("\"{quantity}\""));
            assert_eq!(serde_json::from_str::<RuleQuantity>(&text).unwrap(), *quantity);
        }
    }
}
