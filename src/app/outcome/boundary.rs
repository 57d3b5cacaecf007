//! Boundaries of the model: contents of `boundary.json` and `boundary.csv`, and combination of networks.
//!
//! A boundary is the D15F/D85B from which a network erodes 7.5 % of the base: in the first run (from no
//! to some erosion), or in the second as well (from some to continuing erosion). Each shape and density
//! has one packing; the filter is scaled without a new packing.

use crate::outcome::BaseSize;
use crate::outcome::record::ModelLimit;
use serde::{Deserialize, Serialize};
use voidwalk_core::walk::Engine;
use voidwalk_practice::design::RowNote;
use voidwalk_practice::{InputFile, Note, SheetCover};

/// Step of the scale of ratios on which boundaries are found: half a percent, in ln(D15F/D85B).
pub(crate) const BETWEEN_STEPS: f64 = 0.005;

/// Contents of `boundary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Boundaries {
    /// Version of voidwalk.
    pub(crate) version: String,
    /// Commit that the program was built from; `None` if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) commit: Option<String>,
    /// Boundaries of the model, one row for each density and thickness, in the order requested.
    pub(crate) boundaries: Vec<BoundaryRow>,
    /// The base.
    pub(crate) base: BaseStated,
    /// Shape of the filter as named by the user.
    pub(crate) filter: String,
    /// Name of its constriction curve.
    pub(crate) curve_name: String,
    /// Cu of the filter.
    pub(crate) filter_cu: Option<f64>,
    /// D15F of the filter as given (mm), if its sizes are given.
    pub(crate) filter_d15_mm: Option<f64>,
    /// Files that were read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) inputs: Vec<InputFile>,
    /// Eroded mass fraction from which a run counts as eroding.
    pub(crate) threshold: f64,
    /// Number of networks for each boundary.
    pub(crate) replicates: u64,
    /// Seed given by the user.
    pub(crate) seed: u64,
    /// Engine of the walks; `expected` moves base particles that can block nothing as their expectation.
    pub(crate) engine: String,
    /// Range of D15F/D85B that was searched.
    pub(crate) bracket: [f64; 2],
    /// Step of the search as a fraction of D15F/D85B.
    pub(crate) step: f64,
    /// Notes on the model's boundaries, most important first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) notes: Vec<RowNote>,
    /// Processes that the model omits.
    pub(crate) model_leaves_out: Vec<ModelLimit>,
    /// Settings that were given, as on the command line.
    pub(crate) settings: Vec<String>,
    /// Cover of the sheet.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub(crate) cover: SheetCover,
    /// True if the page shows inches beside mm.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) inches: bool,
    /// Wall time (s).
    pub(crate) seconds: f64,
}

impl Boundaries {
    /// True if the base particles that can block nothing moved as their expectation.
    pub(crate) fn moves_expectation(&self) -> bool {
        self.engine == Engine::Expected.name()
    }

    /// Row with the lowest ratio that nearly all of its networks hold, and this ratio; `None` if no row
    /// has a known ratio.
    pub(crate) fn least_held(&self) -> Option<(&BoundaryRow, f64)> {
        let held = |row| Some((row, BoundaryRow::held(row)?));
        let all: Vec<_> = self.boundaries.iter().map(held).collect::<Option<_>>()?;
        all.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Properties of the base.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct BaseStated {
    /// Name of the base.
    pub(crate) name: String,
    /// D60/D10.
    pub(crate) cu: Option<f64>,
    /// D15 (mm) before regrading; `None` if the base has no sizes in mm.
    pub(crate) d15_mm: Option<f64>,
    /// D85 (mm) as walked; `None` if the base has no sizes in mm.
    pub(crate) d85_mm: Option<f64>,
    /// D95/D85.
    pub(crate) d95_over_d85: Option<f64>,
    /// Size (mm) on which the base was regraded before the walk; `None` if it was walked as sampled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) regraded_at_mm: Option<f64>,
    /// Mass fraction finer than the finest sieve, as walked.
    pub(crate) tail_mass_fraction: f64,
    /// D85 (mm) before regrading, if it was regraded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) d85_as_sampled_mm: Option<f64>,
}

impl BaseStated {
    /// D85 and the base that it belongs to; `None` if the base has no sizes in mm.
    pub(crate) fn size(&self) -> Option<BaseSize> {
        let (regraded_at_mm, as_sampled_mm) = (self.regraded_at_mm, self.d85_as_sampled_mm);
        Some(BaseSize { d85_mm: self.d85_mm?, regraded_at_mm, as_sampled_mm })
    }
}

/// Boundaries of one density and thickness.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct BoundaryRow {
    /// Density of the filter.
    pub(crate) density: String,
    /// Thickness as requested, in words.
    pub(crate) thickness: String,
    /// Layers of voids; at the no-erosion boundary if the thickness is in mm.
    pub(crate) layers: u64,
    /// Thickness (mm); at the no-erosion boundary if it is in layers. `None` if sizes have no unit.
    pub(crate) thickness_mm: Option<f64>,
    /// Filter grains per void, Eq. (2).
    pub(crate) grains_per_void: Option<f64>,
    /// Boundary between no and some erosion; `None` if it lies beyond the range that can be walked.
    pub(crate) no_erosion: Option<Boundary>,
    /// Notes on this boundary, or the reasons why there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) no_erosion_notes: Vec<Note>,
    /// D15F/D85B to which nearly all networks hold, if there is no boundary because more than half of
    /// them hold over the whole search.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) holds_to: Option<f64>,
    /// Boundary between some and continuing erosion.
    pub(crate) continuing: Option<Boundary>,
    /// Notes on this boundary, or the reasons why there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) continuing_notes: Vec<Note>,
    /// Note on a boundary that depends on few particles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) unsteady: Option<Note>,
    /// Number of networks that held at a larger ratio than one that eroded, in either run; their smallest
    /// eroding ratio counts.
    pub(crate) not_monotone: u64,
    /// Boundaries of each network.
    pub(crate) networks: Vec<NetworkBoundaries>,
    /// End of the density range with the lowest boundary, which gives this row. A filter of unknown
    /// density is searched only at its loose and its dense end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) as_end: Option<String>,
    /// Density for which this row is an end of the range of its constriction curve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) end_of: Option<String>,
}

impl BoundaryRow {
    /// Density whose networks were searched.
    pub(crate) fn searched(&self) -> &str {
        self.as_end.as_ref().unwrap_or(&self.density)
    }

    /// Ratio that nearly all networks hold; `None` if it is unknown.
    pub(crate) fn held(&self) -> Option<f64> {
        self.no_erosion.as_ref().map_or(self.holds_to, Boundary::cautious)
    }

    /// Boundaries of no and of continuing erosion with the ends that are shown. For few networks the ends
    /// are the minimum and maximum, because the percentiles lie between two networks.
    pub(crate) fn shown(&self) -> [Option<Boundary>; 2] {
        let by_network =
            |read: fn(&NetworkBoundaries) -> Option<f64>| self.networks.iter().map(read).collect::<Vec<_>>();
        let both = [
            (&self.no_erosion, by_network(|network| network.no_erosion)),
            (&self.continuing, by_network(|network| network.continuing)),
        ];
        both.map(|(boundary, networks)| Some(boundary.as_ref()?.with_shown_ends(&networks)))
    }

    /// Number of networks that eroded at some ratio of the search.
    pub(crate) fn eroding_networks(&self) -> usize {
        self.networks.iter().filter(|network| network.no_erosion.is_some()).count()
    }
}

/// Boundary over networks: D15F/D85B, and D15F in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct Boundary {
    /// Median over networks.
    pub(crate) median: f64,
    /// 5th percentile of networks; `None` if it depends on networks beyond the search, or for one network.
    pub(crate) low: Option<f64>,
    /// 95th percentile of networks; `None` as for `low`.
    pub(crate) high: Option<f64>,
    /// Side of the search on which the 5th percentile lies, if it lies beyond: below means that these
    /// networks erode at every ratio searched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) low_beyond: Option<Beyond>,
    /// D15F (mm) of the filter, if the base has sizes in mm.
    pub(crate) d15f_mm: Option<Range>,
}

impl Boundary {
    /// Combines networks; `None` if their median lies beyond the search. `d85b_mm` is the base's size, if the
    /// filter is scaled.
    pub(crate) fn of(networks: &[Result<f64, Beyond>], d85b_mm: Option<f64>) -> Option<Self> {
        let [low, median, high] = spread(networks);
        let median = median.ok()?;
        let low_beyond = low.err();
        // One network has no percentiles.
        let [low, high] = [low, high].map(|end| end.ok().filter(|_| networks.len() > 1));
        let mm = |d85| Range { median: median * d85, low: low.map(|r| r * d85), high: high.map(|r| r * d85) };
        Some(Self { median, low, high, low_beyond, d15f_mm: d85b_mm.map(mm) })
    }

    /// Takes the minimum and maximum of these networks as ends if they are few. An end that depends on
    /// networks beyond the search stays unknown.
    fn with_shown_ends(&self, networks: &[Option<f64>]) -> Self {
        if !are_few(networks.len() as u64) {
            return self.clone();
        }
        let end = |end: Option<f64>, outer: fn(f64, f64) -> f64| {
            end.map(|end| networks.iter().flatten().copied().fold(end, outer))
        };
        let (low, high) = (end(self.low, f64::min), end(self.high, f64::max));
        let d15f_mm = self.d15f_mm.map(|range| {
            let d85 = range.median / self.median;
            Range { low: low.map(|ratio| ratio * d85), high: high.map(|ratio| ratio * d85), ..range }
        });
        Self { low, high, d15f_mm, ..self.clone() }
    }

    /// Ratio that all but a few networks hold: the 5th percentile, or the median of a single network;
    /// `None` if more than a few erode at every ratio searched.
    pub(crate) fn cautious(&self) -> Option<f64> {
        let median = (self.low_beyond != Some(Beyond::Below)).then_some(self.median);
        self.low.or(median)
    }
}

/// Median and range of a size (mm).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct Range {
    /// Median over networks.
    pub(crate) median: f64,
    /// 5th percentile.
    pub(crate) low: Option<f64>,
    /// 95th percentile.
    pub(crate) high: Option<f64>,
}

/// Boundaries of one network; `None` if a boundary lies beyond the search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct NetworkBoundaries {
    /// Network, counted from 1.
    pub(crate) network: u64,
    /// D15F/D85B from which its first run erodes.
    pub(crate) no_erosion: Option<f64>,
    /// D15F/D85B from which its second run erodes.
    pub(crate) continuing: Option<f64>,
}

/// Row of `boundary.csv`: one ratio that was walked.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct WalkRow {
    /// Density, as in `boundary.json`.
    pub(crate) density: String,
    /// Thickness, as in `boundary.json`.
    pub(crate) thickness: String,
    /// Network, counted from 1.
    pub(crate) network: u64,
    /// Ratio D15F/D85B.
    pub(crate) d15f_over_d85b: f64,
    /// Eroded mass over inserted mass, first run.
    pub(crate) eroded_first: f64,
    /// Eroded mass over inserted mass, second run; empty if it was not walked.
    pub(crate) eroded_second: Option<f64>,
    /// Base of D85B: `as sampled`, or the size on which it was regraded; empty without a size.
    pub(crate) d85b_of: String,
}

/// Side of the search on which a value lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub(crate) enum Beyond {
    /// At smaller ratios.
    Below,
    /// At larger ratios.
    Above,
}

/// Percentiles of a boundary over networks (percent).
const PERCENTILES: [f64; 3] = [5.0, 50.0, 95.0];

/// True if the minimum and maximum of this number of networks are shown, because a percentile would lie
/// between the last two.
pub(crate) fn are_few(networks: u64) -> bool {
    networks < 20
}

/// 5th, 50th and 95th percentile of values, some known only to lie above or below the whole search. A
/// percentile that depends on such values gives their side instead (below, the cautious one, if it
/// depends on both). Between two values a percentile is linear in its rank, from the minimum at 0 to the
/// maximum at 100 (Hyndman and Fan's seventh definition).
///
/// # Panics
/// Panics if there is no value.
pub(crate) fn spread(values: &[Result<f64, Beyond>]) -> [Result<f64, Beyond>; 3] {
    let place = |value: &Result<f64, Beyond>| match value {
        Ok(value) => *value,
        Err(Beyond::Below) => f64::NEG_INFINITY,
        Err(Beyond::Above) => f64::INFINITY,
    };
    let mut sorted: Vec<f64> = values.iter().map(place).collect();
    sorted.sort_by(f64::total_cmp);
    PERCENTILES.map(|percent| {
        let rank = percent / 100.0 * (sorted.len() - 1) as f64;
        let (low, part) = (rank.floor() as usize, rank - rank.floor());
        let at = sorted[low];
        let value = match sorted.get(low + 1).filter(|next| part > 0.0 && **next != at) {
            Some(next) => at + part * (next - at),
            None => at,
        };
        match value {
            f64::INFINITY => Err(Beyond::Above),
            value if value.is_finite() => Ok(value),
            _ => Err(Beyond::Below),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn networks_that_erode_at_every_ratio_leave_no_ratio_that_nearly_all_hold() {
        let boundary_of = |networks: &[Result<f64, Beyond>]| Boundary::of(networks, Some(0.2)).unwrap();
        let below = Err(Beyond::Below);
        let eroding = boundary_of(&[below, Ok(2.1), Ok(2.2), below, Ok(2.3), Ok(2.4), Ok(2.5)]);
        assert_eq!((eroding.low, eroding.low_beyond), (None, Some(Beyond::Below)));
        assert_eq!((eroding.median, eroding.cautious()), (2.2, None));
        assert_eq!(eroding.d15f_mm.unwrap().low, None);
        // Networks that hold to the end of the search keep the lower end.
        let holding = boundary_of(&[Ok(2.0), Ok(2.2), Err(Beyond::Above)]);
        assert!((holding.cautious().unwrap() - 2.02).abs() < 1e-12 && holding.high.is_none());
    }

    #[test]
    fn of_few_networks_least_and_most_are_shown() {
        let ratios = [4.0, 4.4, 4.8, 5.0, 6.0];
        let over =
            |n: usize| -> Vec<Result<f64, Beyond>> { ratios.into_iter().cycle().take(n).map(Ok).collect() };
        let known =
            |networks: &[Result<_, _>]| networks.iter().map(|network| network.ok()).collect::<Vec<_>>();
        let few = over(5);
        let boundary = Boundary::of(&few, Some(0.5)).unwrap();
        assert!(boundary.low.unwrap() > 4.0 && boundary.high.unwrap() < 6.0);
        let shown = boundary.with_shown_ends(&known(&few));
        assert_eq!((shown.low, shown.high, shown.median), (Some(4.0), Some(6.0), 4.8));
        let mm = shown.d15f_mm.unwrap();
        let is = |value: Option<f64>, by_hand: f64| (value.unwrap() - by_hand).abs() < 1e-12;
        assert!(is(mm.low, 2.0) && is(mm.high, 3.0), "{mm:?}");
        // The ratio that the filter holds is still read from the percentile.
        assert!(boundary.cautious().unwrap() > 4.0);
        let many = Boundary::of(&over(20), Some(0.5)).unwrap();
        assert_eq!(many.with_shown_ends(&known(&over(20))), many);
        let beyond = [Ok(4.0), Ok(4.4), Err(Beyond::Above)];
        let shown = Boundary::of(&beyond, None).unwrap().with_shown_ends(&known(&beyond));
        assert_eq!((shown.low, shown.high), (Some(4.0), None));
        // One network has a boundary and no band.
        let alone = Boundary::of(&[Ok(4.0)], None).unwrap();
        assert_eq!((alone.median, alone.low, alone.high, alone.cautious()), (4.0, None, None, Some(4.0)));
        assert_eq!(alone.with_shown_ends(&[Some(4.0)]), alone);
    }

    #[test]
    fn a_record_is_read_as_it_was_written() {
        let boundary = Boundary::of(&[Ok(4.37), Err(Beyond::Above), Ok(4.41)], Some(0.17)).unwrap();
        assert!(boundary.high.is_none());
        let text = serde_json::to_string(&boundary).unwrap();
        assert!(text.contains("\"high\":null,\"d15f_mm\":{\"median\":"), "{text}");
        assert_eq!(serde_json::from_str::<Boundary>(&text).unwrap(), boundary);
    }

    #[test]
    fn percentiles_by_hand() {
        let eleven: Vec<_> = (0..=10).rev().map(|k| Ok(f64::from(k))).collect();
        assert_eq!(spread(&eleven), [Ok(0.5), Ok(5.0), Ok(9.5)]);
        assert_eq!(spread(&[Ok(3.0)]), [Ok(3.0); 3]);
        // For five networks the ends of the range are not the minimum and maximum.
        let five: Vec<_> = (0..5).map(|k| Ok(f64::from(k))).collect();
        let [low, _, high] = spread(&five).map(Result::unwrap);
        assert!(low > 0.0 && low < 1.0 && high > 3.0 && high < 4.0, "{low} {high}");
        assert_eq!([19, 20].map(are_few), [true, false]);
    }

    #[test]
    fn what_hangs_on_a_network_beyond_the_search_has_no_number() {
        let some = [Ok(1.0), Ok(2.0), Ok(3.0), Err(Beyond::Above), Err(Beyond::Below)];
        assert_eq!(spread(&some), [Err(Beyond::Below), Ok(2.0), Err(Beyond::Above)]);
        assert_eq!(spread(&[Err(Beyond::Above), Ok(1.0)]), [Err(Beyond::Above); 3]);
        assert_eq!(spread(&[Err(Beyond::Above); 2]), [Err(Beyond::Above); 3]);
        assert_eq!(spread(&[Err(Beyond::Above), Err(Beyond::Below)]), [Err(Beyond::Below); 3]);
    }
}
