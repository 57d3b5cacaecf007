//! Notes of rules beside their results, as data.

use serde::{Deserialize, Serialize};

/// Declares the notes; a test can make each of them with any number.
macro_rules! notes {
    ($($(#[$doc:meta])* $id:ident $(($($type:ty),*))?,)*) => {
        /// What a rule says beside its result.
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
    // What is missing for a result.
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

    // What lies between two sieves (mm) that stand far apart.
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

    // What the base was taken as.
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

    // What is known of a limit or a value.
    /// The filter is coarser than any limit that the base can have.
    BeyondAnyLimit,
    /// Tests found no clear boundary for such bases: it is not a limit.
    NoClearBoundary,
    /// It is not kept, though tests found no clear boundary for such bases.
    BeyondUnclearBoundary,
    /// The filter is finer than that, but nobody judges whether the erosion is excessive.
    ExcessiveNotJudged,
    /// How the limit follows from fines and D85B: so many times the one that ends at this share of fines
    /// (%), for this share (%).
    ByFines(f64, f64, f64),
    /// The limit of design is its floor: so many times D85B are less (mm).
    FloorGoverns(f64, f64),
    /// D15B lies in the base's finest part, and so many times it are less (mm) than the least that any filter
    /// is asked for.
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
    /// How many times finer than in tests the largest particle is that passes, where coarser ones stay.
    FarFinerThanTests(f64),

    // What the filter's own stability was judged by.
    /// The split (%) of Kezdi's ratio, D'15 of the coarser part and d'85 of the finer part.
    KezdiAt(f64, f64, f64),
    /// The splits that were judged (%).
    KezdiSplits(f64, f64),
    /// The share (%) of the filter that hides something of Kezdi's ratio.
    KezdiHidden(f64),
    /// F (%) of an index of shape, and the most that F can be (%).
    ShapeAt(f64, f64),
    /// The same of a filter of which no sieve tells below the second of three (%).
    ShapeAbovePan(f64, f64, f64),
    /// D90/D15, and the range of D90/D60 that is stable by Burenkova.
    BurenkovaRange(f64, f64, f64),
    /// Sand and gravel with few fines, by Wan and Fell.
    WanFellSand,
    /// Silt, sand and gravel with some clay, by Wan and Fell.
    WanFellSilt,
    /// How the source states its probability.
    WanFellContours,

    // Why a rule was not made for these soils.
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
    pub fn sieves_between(self) -> Option<[f64; 2]> {
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
pub fn d15f_between(notes: &[RuleNote]) -> Option<[f64; 2]> {
    notes.iter().find_map(|note| match *note {
        RuleNote::D15FBetween(from, to) => Some([from, to]),
        _ => None,
    })
}
