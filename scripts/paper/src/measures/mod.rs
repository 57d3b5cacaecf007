//! The measures by name: how each number that the paper states is read off our results.

mod campaign;
mod parts;

pub use self::campaign::{blocked, of_both_runs};
pub use self::parts::twins;
use crate::measured::{Measured, Of};
use crate::study::{Study, VARIANTS, Variant};

/// Reads a number off a study, for the plan of this name; `None` where it has not been walked.
pub type Measure = fn(&Study, &str, &Of) -> Option<Measured>;

/// Which variants of the campaign a measure can differ between.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// All.
    Campaigns,
    /// Those whose constriction curves differ.
    Curves,
    /// None: it belongs to a plan of its own.
    Once,
}

impl Over {
    /// Whether the measure is taken for this variant; of those with the same curves, for the first.
    pub fn takes(self, variant: &Variant) -> bool {
        let of_its_curves = || VARIANTS.iter().find(|other| other.curves == variant.curves);
        match self {
            Over::Campaigns => true,
            Over::Curves => of_its_curves().is_some_and(|first| first.name == variant.name),
            Over::Once => variant.name == VARIANTS[0].name,
        }
    }
}

/// Every measure by the name that `statements.toml` uses.
#[rustfmt::skip]
pub const MEASURES: [(&str, Over, Measure); 57] = [
    ("void_ratio", Over::Curves, parts::void_ratio),
    ("cu_csd", Over::Curves, parts::cu_csd),
    ("dc0_over_d0f", Over::Curves, parts::dc0_over_d0f),
    ("dense_finer", Over::Curves, parts::dense_finer),
    ("csd_over_d15f", Over::Curves, parts::csd_over_d15f),
    ("mean_connectivity", Over::Curves, parts::mean_connectivity),
    ("spread_slows", Over::Once, parts::spread_slows),
    ("blocked_by_one_size", Over::Once, parts::blocked_by_one_size),
    ("kenney_largest", Over::Once, parts::kenney_largest),
    ("kenney_drop", Over::Once, parts::kenney_drop),
    ("kenney_eroded", Over::Once, parts::kenney_eroded),
    ("table3_share", Over::Campaigns, parts::table3_share),
    ("table3_few", Over::Campaigns, parts::table3_few),
    ("table3_per_void", Over::Campaigns, parts::table3_per_void),
    ("table3_all", Over::Campaigns, parts::table3_all),
    ("cubic_per_void", Over::Campaigns, parts::cubic_per_void),
    ("table3_over_cubic", Over::Campaigns, parts::table3_over_cubic),
    ("table3_largest_shift", Over::Once, parts::table3_largest_shift),
    ("table3_not_less", Over::Once, parts::table3_not_less),
    ("first_retained_over_dc0", Over::Once, parts::first_retained_over_dc0),
    ("retained_finer", Over::Once, parts::retained_finer),
    ("voids", Over::Once, campaign::voids),
    ("combinations", Over::Once, campaign::combinations),
    ("connections", Over::Once, campaign::connections),
    ("n_base", Over::Campaigns, campaign::n_base),
    ("most_particles", Over::Campaigns, campaign::most_particles),
    ("second_blocks", Over::Campaigns, campaign::second_blocks),
    ("reruns_largest", Over::Campaigns, campaign::reruns_largest),
    ("reruns_eroded", Over::Campaigns, campaign::reruns_eroded),
    ("class", Over::Campaigns, campaign::class),
    ("eroded", Over::Campaigns, campaign::eroded),
    ("loose_below_5_not_none", Over::Campaigns, campaign::loose_below_5_not_none),
    ("uniform_above_5_not_continuing", Over::Campaigns, campaign::uniform_above_5_not_continuing),
    ("wide_5_to_6_not_some", Over::Campaigns, campaign::wide_5_to_6_not_some),
    ("uniform_reduction", Over::Campaigns, campaign::uniform_reduction),
    ("wide_65_not_continuing", Over::Campaigns, campaign::wide_65_not_continuing),
    ("wide_65_not_less", Over::Campaigns, campaign::wide_65_not_less),
    ("second_over_first", Over::Campaigns, campaign::second_over_first),
    ("rising", Over::Campaigns, campaign::rising),
    ("uniform_rise", Over::Campaigns, campaign::uniform_rise),
    ("filters_unlike", Over::Campaigns, campaign::filters_unlike),
    ("wider_filter_not_larger", Over::Campaigns, campaign::wider_filter_not_larger),
    ("dense_not_less", Over::Campaigns, campaign::dense_not_less),
    ("wide_not_less", Over::Campaigns, campaign::wide_not_less),
    ("dividing_d95", Over::Campaigns, campaign::dividing_d95),
    ("dividing_d85", Over::Campaigns, campaign::dividing_d85),
    ("d85_better", Over::Campaigns, campaign::d85_better),
    ("d95_better", Over::Campaigns, campaign::d95_better),
    ("largest_over_d15f", Over::Campaigns, campaign::largest_over_d15f),
    ("dense_largest_finer", Over::Campaigns, campaign::dense_largest_finer),
    ("dense_largest_not_less", Over::Campaigns, campaign::dense_largest_not_less),
    ("most_eroded_below_5", Over::Campaigns, campaign::most_eroded_below_5),
    ("density_effect", Over::Campaigns, campaign::density_effect),
    ("blocked_near_over_all", Over::Campaigns, campaign::blocked_near_over_all),
    ("rank_all_layers", Over::Campaigns, campaign::rank_all_layers),
    ("rank_three_layers", Over::Campaigns, campaign::rank_three_layers),
    ("few_blocked", Over::Campaigns, campaign::few_blocked),
];

/// The measure of this name.
pub fn measure(name: &str) -> Option<(Over, Measure)> {
    MEASURES.iter().find(|(known, ..)| *known == name).map(|&(_, over, measure)| (over, measure))
}
