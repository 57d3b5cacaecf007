//! Numbers and surfaces of particles, and the number of base particles inserted in a test: Eq. (2) of
//! the paper.

use super::sieve::count;
use super::{Gradation, GradationError, NumberError};

/// Number of base particles, and its cap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaseSupply {
    /// Base particles to insert.
    pub n_base: u64,
    /// Base particles by Eq. (2).
    pub n_base_eq2: u64,
    /// True if the cap made `n_base` smaller than `n_base_eq2`.
    pub capped: bool,
}

/// Computes the number of base particles, Eq. (2) of the paper:
///
/// ```text
/// N_base = F_base * (N_p / N_voids) * voids * N_base,unit / N_filter,unit
/// ```
///
/// rounded to the nearest integer. `mass_ratio` is F_base, the mass of base over the mass of filter;
/// `grains_per_void` is N_p / N_voids of the filter's packing; `voids` is the number of voids of the
/// network. N_unit is the number of particles per unit mass; base and filter have the same solid density,
/// so numbers per unit of solid volume ([`Gradation::particles_per_unit_volume`]) serve as well.
///
/// A pan fraction counts in the mass of the base, not in its number: the particles represent `1 - tail`
/// of `mass_ratio`.
///
/// `cap` limits the number; `None` means no limit. Fewer particles than by Eq. (2) bias the result
/// towards more erosion (this is not noise), so the result tells if it is capped.
///
/// # Errors
/// A mass ratio or grains per void that is not a positive finite number, no voids, or a number of
/// particles that does not fit u64. A result that rounds to 0 is returned as it is.
pub fn base_particles(
    mass_ratio: f64,
    grains_per_void: f64,
    voids: u64,
    base: &Gradation,
    filter: &Gradation,
    cap: Option<u64>,
) -> Result<BaseSupply, GradationError> {
    NumberError::unless_positive("mass_ratio", mass_ratio)?;
    NumberError::unless_positive("grains_per_void", grains_per_void)?;
    NumberError::unless(voids > 0, "voids", 0.0, || "at least one void".into())?;
    let per_grain = base.particles_per_unit_volume() / filter.particles_per_unit_volume();
    let n = (mass_ratio * (grains_per_void * voids as f64) * per_grain).round();
    // 2^64 itself does not fit.
    NumberError::unless(n < 18_446_744_073_709_551_616.0, "n_base", n, || "less than 2^64".into())?;
    let n_base_eq2 = n as u64;
    let n_base = cap.map_or(n_base_eq2, |cap| n_base_eq2.min(cap));
    Ok(BaseSupply { n_base, n_base_eq2, capped: n_base < n_base_eq2 })
}

impl Gradation {
    /// Number of particles of known size per mm3 of solid: the integral of `6 / (pi D^3)` over the mass
    /// fraction. Base and filter have the same solid density, so the ratio of two of these is
    /// `N_base,unit / N_filter,unit` of Eq. (2). A pan fraction counts in the solid, not in the number.
    pub fn particles_per_unit_volume(&self) -> f64 {
        self.number[self.number.len() - 1]
    }

    /// Percent by number of the particles of known size that are no coarser than `d_mm`.
    pub fn percent_finer_by_number(&self, d_mm: f64) -> f64 {
        100.0 * self.number_fraction_in(0.0, d_mm)
    }

    /// Smallest size (mm) such that `percent` by number of the particles of known size are no coarser;
    /// `None` outside 0 to 100.
    pub fn d_by_number(&self, percent: f64) -> Option<f64> {
        if !(0.0..=100.0).contains(&percent) {
            return None;
        }
        if self.size_mm.len() == 1 {
            return Some(self.size_mm[0]);
        }
        let target = percent / 100.0 * self.particles_per_unit_volume();
        let i = self.number.partition_point(|&n| n < target).max(1);
        let (a, b) = (self.size_mm[i - 1], self.size_mm[i]);
        let (low, high) = (self.number[i - 1], self.number[i]);
        if target <= low || high == low {
            return Some(a);
        }
        if target >= high {
            return Some(b);
        }
        // The fraction of the segment's particles is (1 - (a / D)^3) / (1 - e^(-3 L)).
        let share = (target - low) / (high - low);
        let x = -libm::expm1(-3.0 * self.log_ratio[i - 1]) * share;
        Some((a / libm::cbrt(1.0 - x)).clamp(a, b))
    }

    /// Fraction by number, 0 to 1, of the particles of known size that are coarser than `low_mm` and no
    /// coarser than `high_mm`.
    pub fn number_fraction_in(&self, low_mm: f64, high_mm: f64) -> f64 {
        if self.size_mm.len() == 1 {
            return f64::from(u8::from(low_mm < self.size_mm[0] && self.size_mm[0] <= high_mm));
        }
        let mut number = 0.0;
        for (i, &whole) in self.log_ratio.iter().enumerate() {
            let (a, b) = (self.size_mm[i], self.size_mm[i + 1]);
            if low_mm <= a && b <= high_mm {
                number += self.number[i + 1] - self.number[i];
                continue;
            }
            let (from, to) = (a.max(low_mm), b.min(high_mm));
            if from < to {
                let l = libm::log(to / from);
                // The mass per unit of ln(D) is m / whole.
                let m = (self.percent[i + 1] - self.percent[i]) / 100.0;
                number += count(from, l, if whole > 0.0 { (m * (l / whole)).min(m) } else { m });
            }
        }
        (number / self.particles_per_unit_volume()).min(1.0)
    }

    /// Fraction, 0 to 1, of the surface of the particles of known size that belongs to those coarser
    /// than `d_mm`.
    ///
    /// Mass `m` spread evenly over ln(D) from `a` to `b` has the surface `6 m (1/a - 1/b) / ln(b/a)` per
    /// mm3 of solid.
    ///
    /// ```
    /// use voidwalk_core::gradation::Gradation;
    /// // Linear, D100/D0 = 36: (1/9 - 1/36) / (1 - 1/36) of the surface is coarser than 9 D0.
    /// let soil = Gradation::linear_from_d0(1.0, 6.0)?;
    /// assert!((soil.surface_coarser_than(9.0) - 3.0 / 35.0).abs() < 1e-12);
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn surface_coarser_than(&self, d_mm: f64) -> f64 {
        let (mut coarser, mut all) = (0.0, 0.0);
        for (i, &log_ratio) in self.log_ratio.iter().enumerate() {
            let (a, b) = (self.size_mm[i], self.size_mm[i + 1]);
            let mass = self.percent[i + 1] - self.percent[i];
            if log_ratio <= 0.0 || mass <= 0.0 {
                continue;
            }
            let coarser_than = |from: f64| (mass / log_ratio * (1.0 / from - 1.0 / b)).max(0.0);
            all += coarser_than(a);
            coarser += coarser_than(d_mm.clamp(a, b));
        }
        if all > 0.0 { coarser / all } else { f64::from(u8::from(self.largest_mm() > d_mm)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn supply(cap: Option<u64>) -> BaseSupply {
        let filter = Gradation::linear_from_d0(1.0, 1.5).unwrap();
        let base = Gradation::linear_from_d0(0.1, 3.0).unwrap();
        base_particles(0.05, 0.61, 96_000, &base, &filter, cap).unwrap()
    }

    /// Compares with Eq. (2) for N_unit of a straight semi-log line worked out by hand:
    /// `N_unit = (1 - Cu^-6) / (pi D0^3 ln Cu)`.
    #[test]
    fn equation_two_by_hand() {
        let unit = |d0: f64, cu: f64| {
            (1.0 - libm::pow(cu, -6.0)) / (std::f64::consts::PI * d0 * d0 * d0 * libm::log(cu))
        };
        let expected = 0.05 * 0.61 * 96_000.0 * unit(0.1, 3.0) / unit(1.0, 1.5);
        assert_eq!(supply(None).n_base_eq2, expected.round() as u64);
    }

    #[test]
    fn a_cap_is_off_unless_asked_for_and_never_silent() {
        let full = supply(None);
        assert_eq!((full.n_base, full.capped), (full.n_base_eq2, false));
        let cut = supply(Some(1000));
        assert_eq!((cut.n_base, cut.n_base_eq2, cut.capped), (1000, full.n_base_eq2, true));
        assert!(!supply(Some(full.n_base)).capped);
    }

    #[test]
    fn a_tail_takes_its_mass_out_of_the_number() {
        let filter = Gradation::single(1.0).unwrap();
        let whole = Gradation::from_points(&[(0.1, 0.0), (0.2, 100.0)], None).unwrap();
        let tailed = Gradation::from_points(&[(0.1, 40.0), (0.2, 100.0)], None).unwrap();
        let n = |base| base_particles(0.05, 1.0, 1_000_000, base, &filter, None).unwrap().n_base as f64;
        assert!((n(&tailed) / n(&whole) - 0.6).abs() < 1e-6);
    }

    #[test]
    fn what_cannot_be_counted_is_refused() {
        let g = Gradation::single(1.0).unwrap();
        let dust = Gradation::single(1e-9).unwrap();
        for (ratio, grains, voids, base, value, allowed) in [
            (0.0, 1.0, 1, &g, "mass_ratio = 0.0", "a positive finite number"),
            (f64::NAN, 1.0, 1, &g, "mass_ratio = NaN", "a positive finite number"),
            (1.0, f64::INFINITY, 1, &g, "grains_per_void = inf", "a positive finite number"),
            (1.0, 1.0, 0, &g, "voids = 0.0", "at least one void"),
            (1.0, 1.0, 1, &dust, "n_base = 9.999999999999999e26", "less than 2^64"),
        ] {
            let error = base_particles(ratio, grains, voids, base, &g, None).unwrap_err();
            assert_eq!(error.to_string(), format!("{value} is not allowed; allowed: {allowed}"));
        }
        assert_eq!(base_particles(1e-30, 1.0, 1, &g, &g, None).unwrap().n_base, 0);
    }

    #[test]
    fn a_factor_of_two_on_every_length_changes_nothing() {
        let (filter, base) = (
            Gradation::linear_from_d0(1.0, 1.5).unwrap(),
            Gradation::linear_from_dx(85.0, 0.21, 4.5).unwrap(),
        );
        let n = |f: f64| {
            let (b, g) = (base.scaled(f).unwrap(), filter.scaled(f).unwrap());
            base_particles(0.05, 0.61, 96_000, &b, &g, None).unwrap()
        };
        assert_eq!(n(1.0), n(2.0));
        assert_eq!(n(1.0), n(1.0 / 1024.0));
    }
}
