//! The group of a soil by ASTM D2487, as far as a sieve curve tells it.

use super::sieve::Gradation;

/// Fines are finer than this (mm): the No. 200 sieve.
pub const FINES_MM: f64 = 0.075;

/// Gravel is coarser than this (mm): the No. 4 sieve.
pub const GRAVEL_MM: f64 = 4.75;

/// Coarser grains are cobbles, which the groups leave out (mm).
const COBBLES_MM: f64 = 75.0;

/// From this much gravel on a sand is one with gravel, and a gravel with as much sand one with sand (%).
const WITH_OTHER: f64 = 15.0;

/// A group. Where more than 12 % are fines their plasticity decides, and no shape is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Group {
    FineGrained,
    ManyFines { is_gravel: bool, has_other: bool },
    FewFines { is_gravel: bool, is_well_graded: bool, has_fines: bool },
}

impl Group {
    /// The group of a soil with so many percent of fines and of gravel, and of this Cu and Cc.
    pub fn of(fines: f64, gravel: f64, shape: Option<(f64, f64)>) -> Option<Self> {
        if fines >= 50.0 {
            return Some(Self::FineGrained);
        }
        let is_gravel = gravel > (100.0 - fines) / 2.0;
        if fines > 12.0 {
            // A sand with gravel, or a gravel with sand.
            let other = if is_gravel { 100.0 - fines - gravel } else { gravel };
            return Some(Self::ManyFines { is_gravel, has_other: other >= WITH_OTHER });
        }
        let (cu, cc) = shape?;
        let least_cu = if is_gravel { 4.0 } else { 6.0 };
        let is_well_graded = cu >= least_cu && (1.0..=3.0).contains(&cc);
        Some(Self::FewFines { is_gravel, is_well_graded, has_fines: fines >= 5.0 })
    }

    /// Its symbol; where the plasticity of the fines decides, both that it may come to.
    fn symbol(self) -> String {
        let letter = |is_gravel| if is_gravel { 'G' } else { 'S' };
        match self {
            Self::FineGrained => "fine-grained".into(),
            Self::ManyFines { is_gravel, has_other } => {
                let kind = letter(is_gravel);
                let other = match (has_other, is_gravel) {
                    (false, _) => "",
                    (true, true) => ", with sand",
                    (true, false) => ", with gravel",
                };
                format!("{kind}M or {kind}C{other}")
            }
            Self::FewFines { is_gravel, is_well_graded, has_fines } => {
                let kind = letter(is_gravel);
                let clean = format!("{kind}{}", if is_well_graded { 'W' } else { 'P' });
                if has_fines { format!("{clean}-{kind}M or {clean}-{kind}C") } else { clean }
            }
        }
    }

    /// What it is called, and its symbol.
    pub fn in_words(self) -> String {
        let noun = |is_gravel| if is_gravel { "gravel" } else { "sand" };
        match self {
            Self::FineGrained => {
                "fine-grained soil (half or more is finer than 0.075 mm): silt or clay".into()
            }
            Self::ManyFines { is_gravel, .. } => {
                format!("{} with more than 12 % fines: {}", noun(is_gravel), self.symbol())
            }
            Self::FewFines { is_gravel, is_well_graded, has_fines } => {
                let word = if is_well_graded { "well-graded" } else { "poorly graded" };
                let fines = if has_fines { " with silt or clay" } else { "" };
                format!("{word} {}{fines}: {}", noun(is_gravel), self.symbol())
            }
        }
    }
}

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
        // Of less than 5 % no finest tail has more.
        let fines = self.percent_finer_by_mass(FINES_MM);
        let is_known = fines < 5.0 || self.percent_finer_if_known(FINES_MM).is_some();
        if !is_known || self.largest_mm() > COBBLES_MM {
            return None;
        }
        let gravel = 100.0 - self.percent_finer_by_mass(GRAVEL_MM);
        Some(Group::of(fines, gravel, self.cu().zip(self.cc()))?.symbol())
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
        assert_eq!(
            group(&[(0.075, 20.0), (4.75, 60.0), (19.0, 100.0)]).as_deref(),
            Some("SM or SC, with gravel")
        );
        let gravel = group(&[(0.075, 20.0), (4.75, 59.0), (19.0, 100.0)]);
        assert_eq!(gravel.as_deref(), Some("GM or GC, with sand"));
        for (finer, name) in [(85.0, "SM or SC, with gravel"), (85.1, "SM or SC")] {
            let sand = [(0.075, 20.0), (4.75, finer), (19.0, 100.0)];
            assert_eq!(group(&sand).as_deref(), Some(name));
        }
        assert_eq!(group(&[(0.01, 0.0), (0.075, 50.0), (0.3, 100.0)]).as_deref(), Some("fine-grained"));
        // Nobody sieved its fines; cobbles.
        assert_eq!(group(&[(0.3, 25.0), (1.0, 100.0)]), None);
        assert_eq!(group(&[(1.0, 0.0), (150.0, 100.0)]), None);
    }
}
