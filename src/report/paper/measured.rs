//! What a measure gives, and the measures by name.

use serde::Deserialize;

use super::study::Study;
use super::{of_campaign, of_parts};
use crate::outcome::record::Statistic;

/// What we have in place of a number of the paper.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Measured {
    /// In the units of the statement.
    pub value: f64,
    /// 95 % interval, where there is one.
    pub interval: Option<(f64, f64)>,
    /// Said with the number.
    pub words: String,
    /// Whether the replicates leave it open.
    pub open: bool,
}

impl Measured {
    /// A number without an interval.
    pub(super) fn exact(value: f64) -> Self {
        Self { value, interval: None, words: String::new(), open: false }
    }

    /// A mean with its interval.
    pub(super) fn of(statistic: &Statistic) -> Self {
        let interval = statistic.low.zip(statistic.high);
        Self { value: statistic.mean, interval, words: String::new(), open: false }
    }

    /// With words.
    pub(super) fn saying(self, words: impl Into<String>) -> Self {
        Self { words: words.into(), ..self }
    }

    /// Exceptions to a rule: those that are certain and those that the replicates leave open, of `all`.
    pub(super) fn exceptions(certain: usize, open: usize, all: usize) -> Option<Self> {
        let or_more = if open > 0 { format!(", {open} undecided") } else { String::new() };
        (all > 0).then(|| Self {
            value: certain as f64,
            interval: (open > 0).then_some((certain as f64, (certain + open) as f64)),
            words: format!("of {all}{or_more}"),
            open: certain == 0 && open > 0,
        })
    }
}

/// What a measure is of; each reads what it needs.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Of {
    pub filter: String,
    pub cu_b: String,
    pub d85b: String,
    pub case: String,
    pub class: String,
    pub run: usize,
    pub connectivity: u64,
    pub at: String,
    pub to: String,
}

impl Of {
    /// The levels that are named.
    pub(super) fn levels(&self) -> Vec<(&str, &str)> {
        [("filter", &self.filter), ("cu_b", &self.cu_b), ("d85b", &self.d85b)]
            .into_iter()
            .filter(|(_, level)| !level.is_empty())
            .map(|(factor, level)| (factor, level.as_str()))
            .collect()
    }
}

/// Reads a number off a study, for the plan of this name; `None` where it has not been walked.
pub(super) type Measure = fn(&Study, &str, &Of) -> Option<Measured>;

/// Which variants of the campaign a measure can differ between.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Over {
    /// All.
    Campaigns,
    /// Those whose constriction curves differ.
    Curves,
    /// None: it belongs to a plan of its own.
    Once,
}

impl Over {
    /// Whether the measure is taken for this variant.
    pub(super) fn takes(self, plan: &str) -> bool {
        match self {
            Over::Campaigns => true,
            Over::Curves => ["paper", "paper-published", "overlap-0.5"].contains(&plan),
            Over::Once => plan == "paper",
        }
    }
}

/// Every measure by the name that `statements.toml` uses.
#[rustfmt::skip]
pub(super) const MEASURES: [(&str, Over, Measure); 46] = [
    ("void_ratio", Over::Curves, of_parts::void_ratio),
    ("cu_csd", Over::Curves, of_parts::cu_csd),
    ("dc0_over_d0f", Over::Curves, of_parts::dc0_over_d0f),
    ("dense_finer", Over::Curves, of_parts::dense_finer),
    ("csd_over_d15f", Over::Curves, of_parts::csd_over_d15f),
    ("spread_slows", Over::Once, of_parts::spread_slows),
    ("blocked_by_one_size", Over::Once, of_parts::blocked_by_one_size),
    ("kenney_largest", Over::Once, of_parts::kenney_largest),
    ("kenney_drop", Over::Once, of_parts::kenney_drop),
    ("kenney_eroded", Over::Once, of_parts::kenney_eroded),
    ("table3_share", Over::Campaigns, of_parts::table3_share),
    ("table3_few", Over::Campaigns, of_parts::table3_few),
    ("table3_per_void", Over::Campaigns, of_parts::table3_per_void),
    ("table3_all", Over::Campaigns, of_parts::table3_all),
    ("cubic_per_void", Over::Campaigns, of_parts::cubic_per_void),
    ("table3_over_cubic", Over::Campaigns, of_parts::table3_over_cubic),
    ("table3_largest_shift", Over::Once, of_parts::table3_largest_shift),
    ("table3_not_less", Over::Once, of_parts::table3_not_less),
    ("first_retained_over_dc0", Over::Once, of_parts::first_retained_over_dc0),
    ("retained_finer", Over::Once, of_parts::retained_finer),
    ("voids", Over::Once, of_campaign::voids),
    ("combinations", Over::Once, of_campaign::combinations),
    ("n_base", Over::Campaigns, of_campaign::n_base),
    ("most_particles", Over::Campaigns, of_campaign::most_particles),
    ("second_blocks", Over::Campaigns, of_campaign::second_blocks),
    ("reruns_largest", Over::Campaigns, of_campaign::reruns_largest),
    ("reruns_eroded", Over::Campaigns, of_campaign::reruns_eroded),
    ("class", Over::Campaigns, of_campaign::class),
    ("eroded", Over::Campaigns, of_campaign::eroded),
    ("loose_below_5_not_none", Over::Campaigns, of_campaign::loose_below_5_not_none),
    ("uniform_above_5_not_continuing", Over::Campaigns, of_campaign::uniform_above_5_not_continuing),
    ("wide_5_to_6_not_some", Over::Campaigns, of_campaign::wide_5_to_6_not_some),
    ("uniform_reduction", Over::Campaigns, of_campaign::uniform_reduction),
    ("dense_not_less", Over::Campaigns, of_campaign::dense_not_less),
    ("wide_not_less", Over::Campaigns, of_campaign::wide_not_less),
    ("dividing_d95", Over::Campaigns, of_campaign::dividing_d95),
    ("dividing_d85", Over::Campaigns, of_campaign::dividing_d85),
    ("d95_better", Over::Campaigns, of_campaign::d95_better),
    ("largest_over_d15f", Over::Campaigns, of_campaign::largest_over_d15f),
    ("dense_largest_finer", Over::Campaigns, of_campaign::dense_largest_finer),
    ("dense_largest_not_less", Over::Campaigns, of_campaign::dense_largest_not_less),
    ("most_eroded_below_5", Over::Campaigns, of_campaign::most_eroded_below_5),
    ("density_effect", Over::Campaigns, of_campaign::density_effect),
    ("rank_all_layers", Over::Campaigns, of_campaign::rank_all_layers),
    ("rank_three_layers", Over::Campaigns, of_campaign::rank_three_layers),
    ("few_blocked", Over::Campaigns, of_campaign::few_blocked),
];

/// The measure of this name.
pub(super) fn measure(name: &str) -> Option<(Over, Measure)> {
    MEASURES.iter().find(|(known, ..)| *known == name).map(|&(_, over, measure)| (over, measure))
}
