//! Rules of practice applied to two soils, as they are recorded.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

/// A filter rule, applied.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct AppliedRule {
    /// Its name for programs, as `sherard-dunnigan`.
    pub id: String,
    /// Whose rule it is, and what it says.
    pub name: String,
    /// Whose rule it is; empty where nobody is cited.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub authority: String,
    /// Authorities whose texts state it besides; may be empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stated_by: Vec<String>,
    /// What it is a rule of.
    pub role: RuleRole,
    /// Whether it was made for these soils.
    pub applies: bool,
    /// What it limits, as `D15F/D85B`.
    pub quantity: RuleQuantity,
    /// Its value for these inputs; `None` where they do not give it.
    pub value: Option<f64>,
    /// On which side of `value` the true one lies, where sieves give only a bound; `None` where it is the
    /// value itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value_bound: Option<ValueBound>,
    /// The most, or the least, that the rule allows; `None` where no number is known.
    pub limit: Option<f64>,
    /// Unit of value and limit: `mm`, `D0F`, `%`; empty for a ratio.
    #[cfg_attr(feature = "schemas", schemars(with = "String"))]
    pub unit: RuleUnit,
    /// Whether `limit` is the least that the rule allows instead of the most.
    pub at_least: bool,
    /// Whether the true limit is not known, and is at most `limit`; on either side of it where `needs` names
    /// sieves that stand far apart.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub limit_at_most: bool,
    /// Whether the value keeps the limit; `None` where the rule has no result. Of a rule of continuing
    /// erosion `true` says only that this is not reached: some or excessive erosion is not excluded.
    pub met: Option<bool>,
    /// What is missing for a result; may be empty.
    pub needs: Vec<RuleNote>,
    /// Where the value is, why the rule was not made for these soils; may be empty.
    pub notes: Vec<RuleNote>,
    /// What the rule was made for.
    pub applies_to: String,
    /// Its limit in words.
    pub formula: String,
    /// Where the rule is published.
    pub source: String,
    /// What is left of the filter without the greatest part that it may lose by a rule of internal stability;
    /// `None` of other rules.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_finer: Option<WithoutFiner>,
    /// Which curve of the filter it read, where that is an envelope of several.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub filter_curve: String,
    /// Which curve of the base it read, where that is an envelope of several.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub base_curve: String,
}

impl AppliedRule {
    /// Authorities that state the rule: its own first; empty for a check of this program.
    pub fn authorities(&self) -> Vec<&str> {
        let stated_by = self.stated_by.iter().map(String::as_str);
        std::iter::once(self.authority.as_str()).chain(stated_by).filter(|name| !name.is_empty()).collect()
    }

    /// True for a rule of practice that was made for these soils and is not kept.
    pub fn is_broken(&self) -> bool {
        self.applies && self.met == Some(false) && self.role != RuleRole::Walk
    }
}

/// The unit of a rule's value and limit.
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
    /// Percent of the mass.
    #[serde(rename = "%")]
    Percent,
}

impl RuleUnit {
    /// Name of the unit as written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::D0f => "D0F",
            Self::One => "",
            Self::Percent => "%",
        }
    }
}

/// On which side of a value the true one lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum ValueBound {
    /// It is no more than the value.
    #[serde(rename = "at most")]
    AtMost,
    /// It is no less than the value.
    #[serde(rename = "at least")]
    AtLeast,
}

/// What is left of a filter without its finer part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct WithoutFiner {
    /// The part that is taken out (% of the filter's mass).
    pub percent: f64,
    /// 15 % finer of what is left (mm, or D0F where sizes have no unit).
    pub d15f: f64,
}

/// What a rule limits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum RuleQuantity {
    /// A size of the filter.
    D15F,
    /// The filter's size over one of the base.
    #[serde(rename = "D15F/D85B")]
    D15FOverD85B,
    /// The filter's size over one of the base.
    #[serde(rename = "D15F/D95B")]
    D15FOverD95B,
    /// Anything that is no limit of D15F, by its name.
    #[serde(untagged)]
    Named(Cow<'static, str>),
}

impl RuleQuantity {
    /// A quantity that is not a limit of D15F, by a name of its own.
    pub const fn named(name: &'static str) -> Self {
        Self::Named(Cow::Borrowed(name))
    }

    /// Name for a reader.
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

/// What a rule is a rule of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RuleRole {
    /// The filter retains the base without erosion.
    Retention,
    /// A coarser filter: erosion ends.
    Continuation,
    /// The filter drains the base.
    Drainage,
    /// The filter can be placed without segregating.
    Placing,
    /// The filter holds its own fines.
    Stability,
    /// The walk itself: it is checked by this, not the filter.
    Walk,
}

/// Declares the notes; a test can make each of them with any number.
macro_rules! notes {
    ($($(#[$doc:meta])* $id:ident $(($($type:ty),*))?,)*) => {
        /// A note of a rule beside its result.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[cfg_attr(feature = "schemas", derive(schemars::JsonSchema), schemars(with = "schema::RuleNote"))]
        #[serde(tag = "id", content = "numbers", rename_all = "snake_case")]
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
            /// What a rule says beside its result.
            #[derive(schemars::JsonSchema)]
            #[allow(dead_code)]
            pub(super) struct RuleNote {
                /// Its name.
                id: RuleNoteId,
                /// Its number, or its numbers in order; missing without any.
                #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
                numbers: serde_json::Value,
            }

            /// The name of what a rule says.
            #[derive(schemars::JsonSchema)]
            #[schemars(rename_all = "snake_case")]
            #[allow(dead_code)]
            enum RuleNoteId { $($id,)* }
        }
    };
}

notes! {
    // Missing inputs.
    /// The fines of the base.
    NeedsFinesOfBase,
    /// D85 of the base.
    NeedsD85B,
    /// D95 of the base.
    NeedsD95B,
    /// D15 of the base.
    NeedsD15B,
    /// D15 of the filter, of which D0F would tell, too.
    NeedsD15F,
    /// D15 of the filter, of which only sieves tell.
    NeedsD15FSieved,
    /// D10 of the filter.
    NeedsD10F,
    /// The fines of the filter.
    NeedsFinesOfFilter,
    /// Sieves of the filter where the curves of a band are compared.
    NeedsSievesOfFilter,
    /// The finest part of the filter, for its shape.
    NeedsFinestPartOfFilter,
    /// A sieve curve of the filter.
    NeedsCurveOfFilter,
    /// A sieve curve of the filter with a unit.
    NeedsCurveOfFilterInMm,
    /// A test of a dispersive base with 15 to 40 % fines.
    NeedsTestOfDispersive,
    /// A first run that erodes something.
    NeedsErosion,

    // Sizes between two sieves (mm) that stand far apart.
    /// D15 of the filter.
    D15FBetween(f64, f64),
    /// D15 of the base.
    D15BBetween(f64, f64),
    /// D85 of the base.
    D85BBetween(f64, f64),
    /// D95 of the base.
    D95BBetween(f64, f64),
    /// Sizes of the filter.
    FilterBetween(f64, f64),
    /// Sizes of the base.
    BaseBetween(f64, f64),

    // Readings of the base.
    /// The other limit (mm) of a base whose curve is flat, which may be a gap.
    FlatBase(f64),
    /// It is dispersive.
    Dispersive,
    /// Its category of NRCS.
    Category(u8),
    /// It was regraded on this size (mm).
    RegradedOn(f64),
    /// It was not regraded, for a rule that reads it as it is.
    BeforeRegrading,
    /// Sizes have no unit: a sand without fines.
    TakenAsSand,
    /// It is walked as it is.
    ResultOfModel,

    // Facts on a limit or a value.
    /// The filter is coarser than any limit that the base can have.
    BeyondAnyLimit,
    /// Tests found no clear boundary for such bases: it is not a limit.
    NoClearBoundary,
    /// It is not kept, though tests found no clear boundary for such bases.
    BeyondUnclearBoundary,
    /// The filter is finer than that, but nobody judges whether the erosion is excessive.
    ExcessiveNotJudged,
    /// Formula of the limit by fines and D85B: a multiple of the one that ends at this share of fines (%),
    /// for this share (%).
    ByFines(f64, f64, f64),
    /// The limit of design is its floor: this multiple of D85B is less (mm).
    FloorGoverns(f64, f64),
    /// D15B lies in the base's finest part, and this multiple of it is less (mm) than the least that any
    /// filter is asked for.
    LeastGoverns(f64, f64),
    /// D15F lies in the filter's finest part, and is at most the value.
    D15FAtMost,
    /// D15B lies in the base's finest part: the limit is at most the one given.
    LimitAtMost,
    /// D15B lies in the base's finest part: the limit is at least the one given.
    LimitAtLeast,
    /// D10 lies in the filter's finest part: Cu is at least the value.
    CuAtLeast,
    /// No sieve of the filter is finer than this (mm): the value is at most what passes it.
    FinestSieveOfFilter(f64),
    /// The percent finer at which a band is widest.
    AtPercentFiner(f64),
    /// A band is compared from this percent finer, below which no sieve tells.
    BandFrom(f64),
    /// Width of a joint (mm), D95B (mm), and their ratio.
    Joint(f64, f64, f64),
    /// A probability below the least that the source states.
    LessThanSource,
    /// A largest particle that the tests of others know.
    ChecksWalk,
    /// Factor by which the largest particle that passes is finer than in tests, where coarser ones stay.
    FarFinerThanTests(f64),

    // Facts on the filter's own stability.
    /// The split (%) of Kezdi's ratio, D'15 of the coarser part and d'85 of the finer part.
    KezdiAt(f64, f64, f64),
    /// The splits that were judged (%).
    KezdiSplits(f64, f64),
    /// The share (%) of the filter that hides something of Kezdi's ratio.
    KezdiHidden(f64),
    /// F (%) of an index of shape, and the most that F can be (%).
    ShapeAt(f64, f64),
    /// F (%) of an index of shape, the finest that sieves tell (%), and the most that F can be (%).
    ShapeAbovePan(f64, f64, f64),
    /// D90/D15, and the range of D90/D60 that is stable by Burenkova.
    BurenkovaRange(f64, f64, f64),
    /// Sand and gravel with few fines, by Wan and Fell.
    WanFellSand,
    /// Silt, sand and gravel with some clay, by Wan and Fell.
    WanFellSilt,
    /// The source states contours of its probability.
    WanFellContours,

    // Reasons for which a rule was not made for these soils.
    /// The base has this share of fines (%).
    LimitsByFines(f64),
    /// The filter is coarser or broader than Burenkova's.
    BurenkovaSoils,
    /// The filter is in Burenkova's third zone, above this D90/D60.
    BurenkovaThirdZone(f64),
    /// The filter is uniform.
    UniformFilter,
}

impl RuleNote {
    /// Openings (mm) of two sieves far apart, if the result depends on the sizes between them.
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

/// Openings (mm) of the two sieves around D15F, if they lie far apart.
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
        // No name of a rule's quantity is the name of a limit of D15F.
        for quantity in RULES.iter().map(|rule| &rule.quantity) {
            let text = serde_json::to_string(quantity).unwrap();
            assert_eq!(text, format!("\"{quantity}\""));
            assert_eq!(serde_json::from_str::<RuleQuantity>(&text).unwrap(), *quantity);
        }
    }
}
