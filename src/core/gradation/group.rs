//! Group of a soil by ASTM D2487, as far as a sieve curve determines it.

use super::sieve::{FINES_MM, GRAVEL_MM, Gradation};

/// Size above which grains are cobbles, which the groups leave out (mm).
const COBBLES_MM: f64 = 75.0;

/// Sieve for cobbles in exact inches, as in older tables (mm): a soil that passes it counts as free of
/// cobbles.
const THREE_INCHES_MM: f64 = 76.2;

/// Size above which cobbles are boulders (mm).
const BOULDERS_MM: f64 = 300.0;

/// Minimum percentage of gravel in a sand "with gravel", and of sand in a gravel "with sand".
const WITH_OTHER: f64 = 15.0;

/// A group. Above 12 % of fines it depends on their plasticity, and the shape is not needed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Group {
    FineGrained,
    ManyFines { is_gravel: bool, has_other: bool },
    FewFines { is_gravel: bool, is_well_graded: bool, has_fines: bool, has_other: bool },
}

impl Group {
    /// Finds the group of a soil from its percentages of fines and gravel, and its Cu and Cc.
    fn classify(fines: f64, gravel: f64, shape: Option<(f64, f64)>) -> Option<Self> {
        if fines >= 50.0 {
            return Some(Self::FineGrained);
        }
        let is_gravel = gravel > (100.0 - fines) / 2.0;
        // A sand with gravel, or a gravel with sand.
        let other = if is_gravel { 100.0 - fines - gravel } else { gravel };
        let has_other = other >= WITH_OTHER;
        if fines > 12.0 {
            return Some(Self::ManyFines { is_gravel, has_other });
        }
        let (cu, cc) = shape?;
        let least_cu = if is_gravel { 4.0 } else { 6.0 };
        let is_well_graded = cu >= least_cu && (1.0..=3.0).contains(&cc);
        Some(Self::FewFines { is_gravel, is_well_graded, has_fines: fines >= 5.0, has_other })
    }

    /// Returns the symbol, or both possible symbols if the plasticity of the fines decides.
    fn symbol(self) -> String {
        match self {
            Self::FineGrained => "fine-grained".into(),
            Self::ManyFines { is_gravel: true, .. } => "GM or GC".into(),
            Self::ManyFines { .. } => "SM or SC".into(),
            Self::FewFines { is_gravel, is_well_graded, has_fines, .. } => {
                let kind = if is_gravel { 'G' } else { 'S' };
                let clean = format!("{kind}{}", if is_well_graded { 'W' } else { 'P' });
                if has_fines { format!("{clean}-{kind}M or {clean}-{kind}C") } else { clean }
            }
        }
    }

    /// Returns sand or gravel if the soil has enough of the one that its name omits.
    fn other(self) -> Option<&'static str> {
        match self {
            Self::ManyFines { is_gravel, has_other: true }
            | Self::FewFines { is_gravel, has_other: true, .. } => {
                Some(if is_gravel { "sand" } else { "gravel" })
            }
            _ => None,
        }
    }
}

/// Classification of a soil by the standard: the group of its fraction finer than 75 mm, and the rest.
struct Class {
    group: Group,
    has_cobbles: bool,
    has_boulders: bool,
}

impl Class {
    /// Classifies a soil; `None` if more than half is cobbles, or if a pan fraction leaves the group open.
    fn classify(soil: &Gradation) -> Option<Self> {
        let has_cobbles = soil.largest_mm() > THREE_INCHES_MM;
        if has_cobbles && soil.percent_finer_by_mass(COBBLES_MM) < 50.0 {
            return None;
        }
        let part = if has_cobbles { soil.passing(COBBLES_MM)? } else { soil.clone() };
        // A pan fraction belongs to the fines, so below 5 % it does not matter.
        let fines = part.percent_finer_by_mass(FINES_MM);
        if fines >= 5.0 && part.percent_finer_if_known(FINES_MM).is_none() {
            return None;
        }
        let gravel = 100.0 - part.percent_finer_by_mass(GRAVEL_MM);
        let group = Group::classify(fines, gravel, part.cu().zip(part.cc()))?;
        Some(Self { group, has_cobbles, has_boulders: soil.largest_mm() > BOULDERS_MM })
    }

    /// Makes a suffix such as `, with gravel and cobbles`.
    fn with(&self) -> String {
        let cobbles = self.has_cobbles.then_some("cobbles");
        let boulders = self.has_boulders.then_some("boulders");
        let all: Vec<&str> = [self.group.other(), cobbles, boulders].into_iter().flatten().collect();
        match all.split_last() {
            None => String::new(),
            Some((last, [])) => format!(", with {last}"),
            Some((last, others)) => format!(", with {} and {last}", others.join(", ")),
        }
    }

    fn symbol(&self) -> String {
        format!("{}{}", self.group.symbol(), self.with())
    }

    /// Returns the name and symbol.
    fn in_words(&self) -> String {
        let noun = |is_gravel| if is_gravel { "gravel" } else { "sand" };
        let part = if self.has_cobbles { " in the part finer than 75 mm" } else { "" };
        let name = match self.group {
            Group::FineGrained => {
                let scope = if self.has_cobbles { " of the part finer than 75 mm" } else { "" };
                let with = self.with();
                return format!(
                    "fine-grained soil (half or more{scope} is finer than 0.075 mm): silt or clay{with}"
                );
            }
            Group::ManyFines { is_gravel, .. } => format!("{} with more than 12 % fines", noun(is_gravel)),
            Group::FewFines { is_gravel, is_well_graded, has_fines, .. } => {
                let word = if is_well_graded { "well-graded" } else { "poorly graded" };
                let fines = if has_fines { " with silt or clay" } else { "" };
                format!("{word} {}{fines}", noun(is_gravel))
            }
        };
        format!("{name}{part}: {}", self.symbol())
    }
}

impl Gradation {
    /// Returns the group symbol of the fraction finer than 75 mm, and the soil's other fractions (sizes
    /// in mm). Gives both possible symbols if the plasticity of the fines decides; `None` if more than
    /// half is coarser than 75 mm, or if a pan fraction leaves the group open.
    pub fn group(&self) -> Option<String> {
        Class::classify(self).map(|class| class.symbol())
    }

    /// Returns the name of the soil and its group symbol.
    pub fn group_in_words(&self) -> Option<String> {
        Class::classify(self).map(|class| class.in_words())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soil(points: &[(f64, f64)]) -> Gradation {
        Gradation::from_points(points, None).unwrap()
    }

    fn group(points: &[(f64, f64)]) -> Option<String> {
        soil(points).group()
    }

    #[test]
    fn groups_are_those_of_the_standard() {
        let well = [(0.075, 3.0), (0.2, 10.0), (0.7, 30.0), (2.0, 60.0), (9.5, 100.0)];
        assert_eq!(group(&well).as_deref(), Some("SW, with gravel"));
        assert_eq!(group(&[(0.5, 0.0), (1.0, 100.0)]).as_deref(), Some("SP"));
        assert_eq!(group(&[(5.0, 0.0), (10.0, 100.0)]).as_deref(), Some("GP"));
        let wide = [(1.0, 2.0), (2.0, 10.0), (7.0, 30.0), (20.0, 60.0), (60.0, 100.0)];
        assert_eq!(group(&wide).as_deref(), Some("GW, with sand"));
        let dual = [(0.075, 8.0), (0.15, 10.0), (0.3, 30.0), (0.6, 60.0), (2.0, 100.0)];
        assert_eq!(group(&dual).as_deref(), Some("SP-SM or SP-SC"));
        assert_eq!(group(&[(0.075, 22.0), (0.3, 85.0), (0.6, 100.0)]).as_deref(), Some("SM or SC"));
        // Exactly half of the fraction coarser than No. 200 is gravel.
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
        // The fines were not sieved; this does not matter if there are few.
        assert_eq!(group(&[(0.3, 25.0), (1.0, 100.0)]), None);
        assert_eq!(group(&[(0.3, 4.0), (1.0, 100.0)]).as_deref(), Some("SP"));
        assert_eq!(group(&[(5.0, 5.0), (10.0, 100.0)]), None);
    }

    #[test]
    fn sand_or_gravel_beside_the_other_is_named_from_15_percent_for_every_group() {
        for (finer, name) in [(85.0, "SP-SM or SP-SC, with gravel"), (85.1, "SP-SM or SP-SC")] {
            let sand = [(0.075, 7.0), (0.3, 30.0), (4.75, finer), (19.0, 100.0)];
            assert_eq!(group(&sand).as_deref(), Some(name));
        }
        for (finer, name) in [(18.0, "GP, with sand"), (17.9, "GP")] {
            let gravel = [(0.075, 3.0), (4.75, finer), (19.0, 100.0)];
            assert_eq!(group(&gravel).as_deref(), Some(name));
        }
    }

    /// The whole is a gravel, the classified fraction a sand.
    #[test]
    fn only_the_part_finer_than_75_mm_is_classified() {
        let cobbles = soil(&[(0.075, 20.0), (4.75, 54.0), (75.0, 80.0), (150.0, 100.0)]);
        assert_eq!(cobbles.group().as_deref(), Some("SM or SC, with gravel and cobbles"));
        let name = "sand with more than 12 % fines in the part finer than 75 mm";
        let words = format!("{name}: SM or SC, with gravel and cobbles");
        assert_eq!(cobbles.group_in_words(), Some(words));
        // 41 % of 80 % are fines: more than half of the fraction, less than half of the whole.
        let fines = soil(&[(0.075, 41.0), (4.75, 80.0), (75.0, 80.0), (350.0, 100.0)]);
        assert_eq!(fines.group().as_deref(), Some("fine-grained, with cobbles and boulders"));
        let words = fines.group_in_words().unwrap();
        assert!(
            words.contains("(half or more of the part finer than 75 mm is finer than 0.075 mm)"),
            "{words}"
        );
        // Cu and Cc are those of the fraction, too.
        let gravel = soil(&[(4.75, 0.0), (75.0, 75.0), (150.0, 100.0)]);
        let part = soil(&[(4.75, 0.0), (75.0, 100.0)]);
        assert_eq!(gravel.group().unwrap(), format!("{}, with cobbles", part.group().unwrap()));
        // More cobbles than soil; three inches exactly.
        assert_eq!(soil(&[(1.0, 0.0), (75.0, 49.9), (150.0, 100.0)]).group(), None);
        assert_eq!(soil(&[(5.0, 0.0), (76.2, 100.0)]).group().as_deref(), Some("GP"));
    }

    #[test]
    fn classes_follow_the_limits_of_astm_d2487() {
        for (fines, gravel, shape, expected) in [
            (2.0, 10.0, Some((7.0, 1.2)), Some("well-graded sand: SW")),
            (2.0, 10.0, Some((5.9, 1.2)), Some("poorly graded sand: SP")),
            (2.0, 83.1, Some((4.0, 3.0)), Some("well-graded gravel: GW")),
            (2.0, 60.0, Some((4.0, 3.1)), Some("poorly graded gravel: GP, with sand")),
            (5.0, 10.0, Some((7.0, 1.2)), Some("well-graded sand with silt or clay: SW-SM or SW-SC")),
            (12.1, 10.0, None, Some("sand with more than 12 % fines: SM or SC")),
            (2.0, 10.0, None, None),
            (50.0, 0.0, None, Some("fine-grained soil (half or more is finer than 0.075 mm): silt or clay")),
        ] {
            let group = Group::classify(fines, gravel, shape);
            let class = group.map(|group| Class { group, has_cobbles: false, has_boulders: false });
            assert_eq!(class.map(|class| class.in_words()).as_deref(), expected);
        }
    }
}
