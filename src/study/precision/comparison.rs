//! Replicates of a setting, and their difference from those of the reference setting.

use super::study::{PrecisionError, Study};
use crate::outcome::precision::BiasRow;
use crate::outcome::record::Statistic;
use crate::outcome::student;

/// One value of each replicate, in order.
pub(super) struct Replicates {
    /// The value: an eroded mass fraction, or a void ratio.
    pub values: Vec<f64>,
    /// Processor time of each replicate (s).
    pub core_seconds: Vec<f64>,
}

impl Study<'_> {
    /// Replicates side by side, each walked with its seed; `walk` gives its value and its processor time (s).
    pub(super) fn replicates(
        &self,
        count: u64,
        walk: impl Fn(u64) -> Result<(f64, f64), PrecisionError> + Sync,
    ) -> Result<Replicates, PrecisionError> {
        let walked = self.side_by_side(count as usize, |i| walk(self.seed(1 + i as u64)))?;
        let (values, core_seconds) = walked.into_iter().unzip();
        Ok(Replicates { values, core_seconds })
    }
}

/// Mean of values, of which there is at least one.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Statistics of the differences between two settings, replicate by replicate.
pub(super) fn paired_difference(a: &Replicates, b: &Replicates) -> Statistic {
    let each: Vec<f64> = a.values.iter().zip(&b.values).map(|(a, b)| a - b).collect();
    Statistic::of(&each)
}

/// The row of a setting compared with the reference (`None`: it is the reference): replicate by replicate
/// where they are `paired`. What is changed, to what, and the number of base particles are the caller's to
/// fill in.
pub(super) fn compared(found: &Replicates, reference: Option<&Replicates>, paired: bool) -> BiasRow {
    let difference = reference.map(|reference| match paired {
        true => paired_difference(found, reference),
        false => welch(&found.values, &reference.values),
    });
    BiasRow {
        factor: String::new(),
        level: String::new(),
        at: 1.0,
        reference: reference.is_none(),
        n_base: 0,
        replicates: found.values.len() as u64,
        value: mean(&found.values),
        bias: difference.map_or(0.0, |d| d.mean),
        bias_low: difference.and_then(|d| d.low),
        bias_high: difference.and_then(|d| d.high),
        paired: paired && reference.is_some(),
        core_seconds: mean(&found.core_seconds),
    }
}

/// Difference of two means of independent values, and its 95 % interval (Welch).
fn welch(a: &[f64], b: &[f64]) -> Statistic {
    let (of_a, of_b) = (Statistic::of(a), Statistic::of(b));
    let (na, nb) = (a.len() as f64, b.len() as f64);
    let (va, vb) = (of_a.sd.map_or(0.0, |s| s * s / na), of_b.sd.map_or(0.0, |s| s * s / nb));
    let difference = of_a.mean - of_b.mean;
    let degrees = (va + vb) * (va + vb) / (va * va / (na - 1.0) + vb * vb / (nb - 1.0));
    if !degrees.is_finite() {
        return Statistic { mean: difference, sd: None, low: None, high: None };
    }
    let half = student::two_sided((degrees as u64).max(1), 0.05) * (va + vb).sqrt();
    Statistic { mean: difference, sd: None, low: Some(difference - half), high: Some(difference + half) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: means 2 and 6, variances of the means 1/3 and 4/3; 2.94 degrees of freedom, taken as 2.
    #[test]
    fn welch_by_hand() {
        let of = welch(&[1.0, 2.0, 3.0], &[4.0, 6.0, 8.0]);
        let half = 4.302_653 * (5.0f64 / 3.0).sqrt();
        assert_eq!(of.mean, -4.0);
        assert!((of.low.unwrap() + 4.0 + half).abs() < 1e-6 && (of.high.unwrap() + 4.0 - half).abs() < 1e-6);
        let none = welch(&[1.0, 1.0], &[1.0, 1.0]);
        assert_eq!((none.mean, none.low, none.high), (0.0, None, None));
    }

    #[test]
    fn pairs_take_the_scatter_of_the_networks_out() {
        let of = |values: &[f64]| Replicates { values: values.to_vec(), core_seconds: vec![1.0] };
        let (a, b) = (of(&[0.2, 0.5, 0.9]), of(&[0.1, 0.4, 0.8]));
        let paired = compared(&a, Some(&b), true);
        assert!((paired.bias - 0.1).abs() < 1e-12 && (paired.bias_high.unwrap() - 0.1).abs() < 1e-9);
        assert!(compared(&a, Some(&b), false).bias_high.unwrap() > 0.5);
    }
}
