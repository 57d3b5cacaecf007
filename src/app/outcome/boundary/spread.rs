//! Median and 5 to 95 % band of the networks' boundaries, where some lie beyond the search.

use serde::{Deserialize, Serialize};

/// On which side of all that was searched something lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Beyond {
    /// At smaller ratios.
    Below,
    /// At larger ratios.
    Above,
}

/// Percentiles of a boundary over networks (percent).
const PERCENTILES: [f64; 3] = [5.0, 50.0, 95.0];

/// From this number of networks on, a percentile is not read between the last two of them.
const ENOUGH: u64 = 20;

/// Tells if the least and the most of this number of networks are shown: a percentile would be read between
/// the last two.
pub fn are_few(networks: u64) -> bool {
    networks < ENOUGH
}

/// The 5, 50 and 95 percentile of values, some of which are only known to lie above or below the whole
/// search. A percentile that depends on such values gives their side instead (below if it depends on both
/// sides: the cautious one). Between two values a percentile is linear in its rank, from the least at 0 to
/// the greatest at 100 (Hyndman and Fan's seventh definition).
///
/// # Panics
/// Panics if there is no value.
pub fn spread(values: &[Result<f64, Beyond>]) -> [Result<f64, Beyond>; 3] {
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
    fn percentiles_by_hand() {
        let eleven: Vec<_> = (0..=10).rev().map(|k| Ok(f64::from(k))).collect();
        assert_eq!(spread(&eleven), [Ok(0.5), Ok(5.0), Ok(9.5)]);
        assert_eq!(spread(&[Ok(3.0)]), [Ok(3.0); 3]);
        // The ends of the band of five networks are not the least and the most.
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
