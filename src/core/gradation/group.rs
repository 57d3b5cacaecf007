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

/// Classification of a soil by the standard: the group of its fraction finer than 75 mm, and the rest.
struct Class {
    /// Percent of fines; above 12 % the group depends on their plasticity, from 50 % on they alone count.
    fines: f64,
    is_gravel: bool,
    /// True for well-graded soils; not needed above 12 % of fines.
    is_well_graded: bool,
    /// True for sands with gravel, and gravels with sand.
    has_other: bool,
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
        let class = Self::fine(fines, gravel, part.cu().zip(part.cc()))?;
        Some(Self { has_cobbles, has_boulders: soil.largest_mm() > BOULDERS_MM, ..class })
    }

    /// Classifies a soil without cobbles from its percentages of fines and gravel, and its Cu and Cc.
    fn fine(fines: f64, gravel: f64, shape: Option<(f64, f64)>) -> Option<Self> {
        let is_gravel = gravel > (100.0 - fines) / 2.0;
        let other = if is_gravel { 100.0 - fines - gravel } else { gravel };
        let least_cu = if is_gravel { 4.0 } else { 6.0 };
        let is_well_graded = match shape {
            Some((cu, cc)) => cu >= least_cu && (1.0..=3.0).contains(&cc),
            None if fines > 12.0 => false,
            None => return None,
        };
        let has_other = fines < 50.0 && other >= WITH_OTHER;
        Some(Self { fines, is_gravel, is_well_graded, has_other, has_cobbles: false, has_boulders: false })
    }

    /// Makes a suffix such as `, with gravel and cobbles`.
    fn with(&self) -> String {
        let other = if self.is_gravel { "sand" } else { "gravel" };
        let all = [(self.has_other, other), (self.has_cobbles, "cobbles"), (self.has_boulders, "boulders")];
        let all: Vec<&str> = all.into_iter().filter(|(has, _)| *has).map(|(_, name)| name).collect();
        match all.split_last() {
            None => String::new(),
            Some((last, [])) => format!(", with {last}"),
            Some((last, others)) => format!(", with {} and {last}", others.join(", ")),
        }
    }

    /// Makes the symbol, or both possible symbols if the plasticity of the fines decides.
    fn symbol(&self) -> String {
        let kind = if self.is_gravel { 'G' } else { 'S' };
        let grade = if self.is_well_graded { 'W' } else { 'P' };
        let symbol = match self.fines {
            50.0.. => "fine-grained".into(),
            fines if fines > 12.0 => format!("{kind}M or {kind}C"),
            5.0.. => format!("{kind}{grade}-{kind}M or {kind}{grade}-{kind}C"),
            _ => format!("{kind}{grade}"),
        };
        symbol + &self.with()
    }

    fn name(&self) -> String {
        if self.fines >= 50.0 {
            let scope = if self.has_cobbles { " of the part finer than 75 mm" } else { "" };
            let with = self.with();
            return format!(
                "fine-grained soil (half or more{scope} is finer than 0.075 mm): silt or clay{with}"
            );
        }
        let grade = match self.is_well_graded {
            _ if self.fines > 12.0 => "",
            true => "well-graded ",
            false => "poorly graded ",
        };
        let soil = if self.is_gravel { "gravel" } else { "sand" };
        let fines = match self.fines {
            fines if fines > 12.0 => " with more than 12 % fines",
            5.0.. => " with silt or clay",
            _ => "",
        };
        let part = if self.has_cobbles { " in the part finer than 75 mm" } else { "" };
        format!("{grade}{soil}{fines}{part}: {}", self.symbol())
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
        Class::classify(self).map(|class| class.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soil(points: &[(f64, f64)]) -> Gradation {
        Gradation::from_points(points, None).unwrap()
    }

    /// Points of a soil, and its group.
    type Case<'a> = (&'a [(f64, f64)], Option<&'a str>);

    #[test]
    fn groups_are_those_of_the_standard() {
        let well = [(0.075, 3.0), (0.2, 10.0), (0.7, 30.0), (2.0, 60.0), (9.5, 100.0)];
        let wide = [(1.0, 2.0), (2.0, 10.0), (7.0, 30.0), (20.0, 60.0), (60.0, 100.0)];
        let dual = [(0.075, 8.0), (0.15, 10.0), (0.3, 30.0), (0.6, 60.0), (2.0, 100.0)];
        let cases: [Case<'_>; 17] = [
            (&well, Some("SW, with gravel")),
            (&[(0.5, 0.0), (1.0, 100.0)], Some("SP")),
            (&[(5.0, 0.0), (10.0, 100.0)], Some("GP")),
            (&wide, Some("GW, with sand")),
            (&dual, Some("SP-SM or SP-SC")),
            (&[(0.075, 22.0), (0.3, 85.0), (0.6, 100.0)], Some("SM or SC")),
            // Exactly half of the fraction coarser than No. 200 is gravel.
            (&[(0.075, 20.0), (4.75, 60.0), (19.0, 100.0)], Some("SM or SC, with gravel")),
            (&[(0.075, 20.0), (4.75, 59.0), (19.0, 100.0)], Some("GM or GC, with sand")),
            // Sand or gravel beside the other is named from 15 %, for every group.
            (&[(0.075, 20.0), (4.75, 85.0), (19.0, 100.0)], Some("SM or SC, with gravel")),
            (&[(0.075, 20.0), (4.75, 85.1), (19.0, 100.0)], Some("SM or SC")),
            (&[(0.075, 7.0), (0.3, 30.0), (4.75, 85.0), (19.0, 100.0)], Some("SP-SM or SP-SC, with gravel")),
            (&[(0.075, 7.0), (0.3, 30.0), (4.75, 85.1), (19.0, 100.0)], Some("SP-SM or SP-SC")),
            (&[(0.075, 3.0), (4.75, 18.0), (19.0, 100.0)], Some("GP, with sand")),
            (&[(0.075, 3.0), (4.75, 17.9), (19.0, 100.0)], Some("GP")),
            (&[(0.01, 0.0), (0.075, 50.0), (0.3, 100.0)], Some("fine-grained")),
            // The fines were not sieved; this does not matter if there are few.
            (&[(0.3, 25.0), (1.0, 100.0)], None),
            (&[(0.3, 4.0), (1.0, 100.0)], Some("SP")),
        ];
        for (points, symbol) in cases {
            assert_eq!(soil(points).group().as_deref(), symbol, "{points:?}");
        }
        assert_eq!(soil(&[(5.0, 5.0), (10.0, 100.0)]).group(), None);
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
            assert_eq!(Class::fine(fines, gravel, shape).map(|class| class.name()).as_deref(), expected);
        }
    }
}
