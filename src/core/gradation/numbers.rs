//! Gradations by number of particles.

use super::Gradation;
use super::segments::count;

impl Gradation {
    /// Number of particles of known size in one mm3 of solid: the integral of `6 / (pi D^3)` over the
    /// mass fraction.
    /// Base and filter have one solid density, so the ratio of two of these is `N_base,unit / N_filter,unit`
    /// of Eq. (2). A pan fraction is in the solid, not in the number.
    pub fn particles_per_unit_volume(&self) -> f64 {
        self.number[self.number.len() - 1]
    }

    /// Percent by number, among the particles of known size, no coarser than `d_mm`.
    pub fn percent_finer_by_number(&self, d_mm: f64) -> f64 {
        100.0 * self.number_fraction_in(0.0, d_mm)
    }

    /// Smallest size (mm) that `percent` by number of the particles of known size is finer than or equal to;
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
        // The share of the segment's particles is (1 - (a / D)^3) / (1 - e^(-3 L)).
        let share = (target - low) / (high - low);
        let x = -libm::expm1(-3.0 * self.log_ratio[i - 1]) * share;
        Some((a / libm::cbrt(1.0 - x)).clamp(a, b))
    }

    /// Share by number, 0 to 1, of the particles of known size that are coarser than `low_mm` and no
    /// coarser than `high_mm`.
    pub fn number_fraction_in(&self, low_mm: f64, high_mm: f64) -> f64 {
        (self.number_in(low_mm, high_mm) / self.particles_per_unit_volume()).min(1.0)
    }

    /// Particles per mm3 of solid in `low_mm < D <= high_mm`.
    fn number_in(&self, low_mm: f64, high_mm: f64) -> f64 {
        if self.size_mm.len() == 1 {
            let inside = low_mm < self.size_mm[0] && self.size_mm[0] <= high_mm;
            return if inside { self.number[0] } else { 0.0 };
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
        number
    }
}
