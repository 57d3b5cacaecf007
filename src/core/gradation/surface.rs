//! Gradations by surface of their particles.

use super::Gradation;

impl Gradation {
    /// Share, 0 to 1, of the surface of the particles of known size that belongs to those coarser than
    /// `d_mm`.
    ///
    /// Mass `m` spread evenly over ln(D) from `a` to `b` has the surface `6 m (1/a - 1/b) / ln(b/a)` for one
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
        match all > 0.0 {
            true => coarser / all,
            false => f64::from(u8::from(self.largest_mm() > d_mm)),
        }
    }
}
