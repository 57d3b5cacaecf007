//! The group of a soil by ASTM D2487, as far as a sieve curve tells it.

use super::{FINES_MM, Gradation};

/// No. 4, between sand and gravel (mm).
const GRAVEL_MM: f64 = 4.75;

/// Coarser grains are cobbles, which the groups leave out (mm).
const COBBLES_MM: f64 = 75.0;

impl Gradation {
    /// The symbol of its group, sizes in mm. Where the plasticity of the fines decides, both symbols that it
    /// may come to; `None` where cobbles or a finest tail leave it open.
    ///
    /// ```
    /// use voidwalk::Gradation;
    /// let sand = Gradation::from_points(&[(0.1, 0.0), (0.3, 15.0), (1.0, 70.0), (2.0, 100.0)], None)?;
    /// assert_eq!(sand.group().as_deref(), Some("SP"));
    /// # Ok::<(), voidwalk::gradation::GradationError>(())
    /// ```
    pub fn group(&self) -> Option<String> {
        let fines = self.percent_finer_by_mass(FINES_MM);
        let is_known = self.pan_fraction() == 0.0 || self.smallest_mm() <= FINES_MM || fines < 5.0;
        if !is_known || self.largest_mm() > COBBLES_MM {
            return None;
        }
        if fines >= 50.0 {
            return Some("fine-grained".into());
        }
        let gravel = 100.0 - self.percent_finer_by_mass(GRAVEL_MM);
        let (kind, least_cu) = if 2.0 * gravel > 100.0 - fines { ("G", 4.0) } else { ("S", 6.0) };
        if fines > 12.0 {
            return Some(format!("{kind}M or {kind}C"));
        }
        let (cu, cc) = (self.cu()?, self.cc()?);
        let grading = if cu >= least_cu && (1.0..=3.0).contains(&cc) { "W" } else { "P" };
        let clean = format!("{kind}{grading}");
        Some(if fines < 5.0 { clean } else { format!("{clean}-{kind}M or {clean}-{kind}C") })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_those_of_the_standard() {
        let group = |points: &[(f64, f64)]| Gradation::from_points(points, None).unwrap().group();
        let well = [(0.075, 3.0), (0.2, 10.0), (0.7, 30.0), (2.0, 60.0), (9.5, 100.0)];
        assert_eq!(group(&well).as_deref(), Some("SW"));
        assert_eq!(group(&[(0.5, 0.0), (1.0, 100.0)]).as_deref(), Some("SP"));
        assert_eq!(group(&[(5.0, 0.0), (10.0, 100.0)]).as_deref(), Some("GP"));
        let wide = [(1.0, 2.0), (2.0, 10.0), (7.0, 30.0), (20.0, 60.0), (60.0, 100.0)];
        assert_eq!(group(&wide).as_deref(), Some("GW"));
        let dual = [(0.075, 8.0), (0.15, 10.0), (0.3, 30.0), (0.6, 60.0), (2.0, 100.0)];
        assert_eq!(group(&dual).as_deref(), Some("SP-SM or SP-SC"));
        assert_eq!(group(&[(0.075, 22.0), (0.3, 85.0), (0.6, 100.0)]).as_deref(), Some("SM or SC"));
        // Half of what is coarser than No. 200 is gravel, and no more.
        assert_eq!(group(&[(0.075, 20.0), (4.75, 60.0), (19.0, 100.0)]).as_deref(), Some("SM or SC"));
        assert_eq!(group(&[(0.075, 20.0), (4.75, 59.0), (19.0, 100.0)]).as_deref(), Some("GM or GC"));
        assert_eq!(group(&[(0.01, 0.0), (0.075, 50.0), (0.3, 100.0)]).as_deref(), Some("fine-grained"));
        // Nobody sieved its fines; cobbles.
        assert_eq!(group(&[(0.3, 25.0), (1.0, 100.0)]), None);
        assert_eq!(group(&[(1.0, 0.0), (150.0, 100.0)]), None);
    }
}
