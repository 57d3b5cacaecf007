//! How the verdict moves with the amount of base.

use super::entry::Finding;
use super::finding as found;
use super::practice::severity;
use super::study_points::{Scaled, Study, at_end, classes, reach, times};
use crate::outcome::numbers::in_digits;
use crate::outcome::record::{Outcome, Sensitivity, Verdict};

/// The eroded mass is about the same where its least and greatest lie within this factor.
const ABOUT_THE_SAME: f64 = 1.5;

/// Digits of the mass of the base in percent of the filter's.
const DIGITS: u8 = 3;

/// Amounts must lie this far apart before the eroded mass is compared.
const FAR_APART: f64 = 4.0;

/// What the walk does with the amounts, where the same mass erodes of each.
const SAME_MASS: &str = "About the same mass erodes however much base is offered";

/// How the verdict moves with the amount of base; `None` without another amount.
pub fn finding(outcome: &Outcome) -> Option<Finding> {
    Amounts::of(outcome).finding()
}

/// The class with the base of the scene, and a worse one with another amount, as a headline says it; `None`
/// where no amount gives a worse class, walked or scaled to the end of the range that erodes most.
pub(super) fn worse_in_words(outcome: &Outcome) -> Option<String> {
    Amounts::of(outcome).worse_in_words()
}

/// Whether the walks of a case show that about the same mass erodes however much base is offered.
pub(super) fn is_same_mass(outcome: &Outcome) -> bool {
    Amounts::of(outcome).is_same_mass()
}

/// The amounts of base that were walked, beside a verdict.
struct Amounts<'a>(Study<'a, Sensitivity>);

impl<'a> Amounts<'a> {
    fn of(outcome: &'a Outcome) -> Self {
        Self(Study::of(outcome, &outcome.sensitivity))
    }

    /// The other amount whose class is worst and worse than the verdict; of equal classes the amount that is
    /// nearest to the one that was asked for.
    fn worse(&self) -> Option<&'a Sensitivity> {
        let own = severity(self.0.verdict)?;
        let away = |row: &Sensitivity| (row.factor - 1.0).abs();
        let graded = self.0.others().filter_map(|row| Some((severity(row.walked.verdict)?, row)));
        let worst = graded.max_by(|a, b| a.0.cmp(&b.0).then(away(b.1).total_cmp(&away(a.1))));
        worst.filter(|(class, _)| *class > own).map(|(_, row)| row)
    }

    /// The mass of the scene's own base over that of its filter.
    fn ratio(&self) -> Option<f64> {
        self.0.rows.iter().find_map(|row| Some(row.mass_ratio? / row.factor))
    }

    /// Whether the mass that erodes in the first run is about the same whatever the amount: then less of a
    /// larger base erodes, by percent, though nothing else has changed.
    fn is_same_mass(&self) -> bool {
        let mass = |row: &Sensitivity| row.factor * row.walked.runs.first().map_or(f64::NAN, |s| s.mean);
        let within = |most: f64, of: &dyn Fn(&Sensitivity) -> f64| {
            let least = self.0.rows.iter().map(of).fold(f64::INFINITY, f64::min);
            let greatest = self.0.rows.iter().map(of).fold(0.0, f64::max);
            least > 0.0 && greatest <= most * least
        };
        within(ABOUT_THE_SAME, &mass) && !within(FAR_APART * (1.0 - 1e-9), &|row| row.factor)
    }

    /// What would erode of the other amounts at the end of the range that erodes most, where that is a worse
    /// class than was walked: only where the walks show that the same mass erodes.
    fn scaled(&self) -> Vec<Scaled> {
        if self.is_same_mass() { self.0.scaled() } else { Vec::new() }
    }

    /// The amount nearest to the scene's own that erodes at that end, where no walked class is worse.
    fn worse_at_end(&self) -> Option<Scaled> {
        let beyond = self.scaled().into_iter().filter(|of| of.erodes());
        let away = |of: &Scaled| (of.factor - 1.0).abs();
        let nearest = beyond.min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.filter(|_| self.0.verdict == Verdict::None && self.worse().is_none())
    }

    fn worse_in_words(&self) -> Option<String> {
        let walked = self.worse().map(|row| (row.factor, row.walked.verdict.words(), ""));
        let (factor, other, how) = walked
            .or_else(|| self.worse_at_end().map(|of| (of.factor, of.class, " (scaled, not walked)")))?;
        let class = self.0.verdict.words();
        Some(match self.ratio().map(|ratio| 100.0 * ratio) {
            Some(own) => {
                let [own, of] = [own, own * factor].map(|share| in_digits(share, DIGITS));
                format!("{class} with base of {own} % of the filter's mass, {other} with {of} %{how}")
            }
            None => {
                format!("{class} with this amount of base, {other} with {} times as much{how}", times(factor))
            }
        })
    }

    /// One amount, after another in percent of the filter's mass.
    fn amount(&self, factor: f64) -> String {
        self.ratio().map_or_else(
            || format!("{} times the base", times(factor)),
            |ratio| format!("base of {} %", in_digits(100.0 * ratio * factor, DIGITS)),
        )
    }

    /// The class of each amount, and how the others are classed. The scene's own is undecided where the
    /// verdict is.
    fn classes(&self) -> String {
        let points = self.0.classed();
        let each = match self.ratio() {
            Some(ratio) => classes(&points, |ends, is_first| {
                let share =
                    reach(ends.map(|factor| 100.0 * ratio * factor), |share| in_digits(share, DIGITS));
                let of = if is_first { " of the filter's mass" } else { "" };
                format!("with {}{share} %{of}", if is_first { "base of " } else { "" })
            }),
            None => classes(&points, |ends, _| format!("with {} times the base", reach(ends, times))),
        };
        let scaled = at_end(&self.scaled(), |factor| format!("with {}", self.amount(factor)));
        let ends = match self.0.range {
            Some(_) if scaled.is_empty() => "; the ends of its range were not walked with other amounts",
            _ => "",
        };
        match self.0.how_classed("other amounts") {
            Some(points) => format!("{each} ({points}{ends}){scaled}"),
            None => format!("{each}{scaled}"),
        }
    }

    /// What follows for the class where the same mass erodes of each amount. One class of all that were
    /// walked is no steadier for it: of less base a greater share erodes.
    fn follows(&self, is_one: bool) -> &'static str {
        match self.0.as_others {
            _ if !is_one => ", so the class follows from the amount",
            Verdict::None => ", so that still less base would give a worse class; walked",
            Verdict::Some | Verdict::Continuing => {
                ", so that still more base would give a better class; walked"
            }
            Verdict::Undecided => "; walked",
        }
    }

    /// What the amounts say beside the verdict. A class worse than the verdict speaks against it. What is
    /// undecided neither stays nor moves.
    fn finding(&self) -> Option<Finding> {
        self.0.others().next()?;
        let each = self.0.each("times the base");
        let classes = self.classes();
        let at_end = self.worse_at_end();
        let is_one = at_end.is_none() && self.0.stays();
        let why = match is_one {
            _ if self.is_same_mass() => &format!("{SAME_MASS}{}", self.follows(is_one)),
            _ if self.0.is_open() => "The verdict is undecided. The class by amount of base",
            true => "The class does not change with the amount of base",
            false => "The class depends on the amount of base",
        };
        let worse = self.worse().map(|row| (row.factor, row.walked.verdict.words()));
        Some(match worse.or(at_end.map(|of| (of.factor, of.class))) {
            _ if self.0.is_open() => found::open_with_amount(why, &classes, &self.0.comma_points(), &each),
            Some((factor, class)) => found::worse_with_amount(why, &classes, &times(factor), class, &each),
            None if is_one => {
                let widen = |[least, most]: [f64; 2], of: f64| [least.min(of), most.max(of)];
                let factors = self.0.others().map(|row| row.factor);
                let ends = factors.fold([f64::INFINITY, f64::NEG_INFINITY], widen);
                found::stays_with_amount(why, &classes, &format!("{} times the base", reach(ends, times)))
            }
            None => found::moves_with_amount(why, &classes, &each),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::{Classed, CurveEnd, CurveRange, Statistic};

    fn row(factor: f64, verdict: Verdict, mean: f64) -> Sensitivity {
        let runs = vec![Statistic { mean, sd: None, low: None, high: None }];
        let walked = Classed { replicates: 1, stopped_when_clear: false, verdict, runs };
        let mass_ratio = Some(0.05 * factor);
        Sensitivity { factor, n_base: 100, grains_per_void: None, mass_ratio, walked }
    }

    fn amounts(rows: &[Sensitivity], verdict: Verdict) -> Amounts<'_> {
        Amounts(Study { rows, verdict, as_others: verdict, points: None, range: None, threshold: 0.075 })
    }

    fn of(rows: &[Sensitivity], verdict: Verdict) -> Finding {
        amounts(rows, verdict).finding().unwrap()
    }

    #[test]
    fn a_worse_class_with_less_base_speaks_against_the_verdict() {
        assert!(amounts(&[row(1.0, Verdict::None, 0.02)], Verdict::None).finding().is_none());
        let rows =
            [row(0.25, Verdict::Some, 0.09), row(1.0, Verdict::None, 0.01), row(4.0, Verdict::None, 0.01)];
        let worse = of(&rows, Verdict::None);
        assert!(worse.id() == "worse_with_amount" && worse.is_against(Verdict::None));
        assert_eq!(
            worse.sentence(),
            "The class depends on the amount of base: no erosion with base of 5 to 20 % of the filter's \
             mass, some erosion with 1.25 %."
        );
        let each = &worse.record(true).numbers["each"];
        assert!(each.as_str().unwrap().starts_with("0.25 times the base: some erosion, 9.00 % eroded in 1"));
        let stays = of(&[row(0.25, Verdict::None, 0.02), row(4.0, Verdict::None, 0.02)], Verdict::None);
        assert!(stays.id() == "stays_with_amount" && !stays.is_against(Verdict::None));
        assert_eq!(
            stays.sentence(),
            "The class does not change with the amount of base: no erosion with base of 1.25 to 20 % of the \
             filter's mass."
        );
        // A better class moves the verdict, and is no doubt of it.
        let moves = of(&rows, Verdict::Some);
        assert!(moves.id() == "moves_with_amount" && !moves.is_against(Verdict::Some));
        let open = of(&rows, Verdict::Undecided).sentence();
        assert!(
            open.starts_with(
                "The verdict is undecided. The class by amount of base: undecided with base of 5"
            ),
            "{open}"
        );
        let mut odd = rows.clone();
        odd.iter_mut().for_each(|row| row.mass_ratio = Some(0.052345 * row.factor));
        let said = of(&odd, Verdict::None).sentence();
        assert!(
            said.contains("base of 5.23 to 20.9 % of the filter's mass, some erosion with 1.31 %"),
            "{said}"
        );
        let mut unknown = rows.clone();
        unknown.iter_mut().for_each(|row| row.mass_ratio = None);
        let worse = of(&unknown, Verdict::None).sentence();
        assert!(
            worse.ends_with(
                ": no erosion with 1 to 4 times the base, some erosion with 0.25 times the \
                                 base."
            ),
            "{worse}"
        );
    }

    /// A range of which the loose end erodes so much.
    fn range(loose: f64) -> CurveRange {
        let run = |mean: f64| Statistic { mean, sd: None, low: Some(0.95 * mean), high: Some(1.05 * mean) };
        let runs = vec![run(loose), run(0.0)];
        let walked = Classed { replicates: 10, stopped_when_clear: false, verdict: Verdict::None, runs };
        let end = CurveEnd { curve: "loose".into(), dc50_factor: 1.1, walked };
        CurveRange {
            verdict: Verdict::None,
            ends: vec![end],
            worst_counts: true,
            could_be: None,
            eroded_mass_fraction: Vec::new(),
        }
    }

    /// The core on C33 sand and C33 on No. 57 stone: the middle curve holds amounts that the loose end does
    /// not, as the same mass erodes.
    #[test]
    fn the_end_that_erodes_most_is_scaled_to_the_other_amounts() {
        let held = [(0.25, 0.066), (0.5, 0.033), (1.0, 0.0165), (2.0, 0.0083), (4.0, 0.0041)]
            .map(|(factor, share)| row(factor, Verdict::None, share));
        let loose = range(0.0252);
        let points = Some("by the curve itself");
        let of = Amounts(Study { points, range: Some(&loose), ..amounts(&held, Verdict::None).0 });
        assert_eq!(
            of.worse_in_words().unwrap(),
            "no erosion with base of 5 % of the filter's mass, some erosion with 1.25 % (scaled, not walked)"
        );
        let found = of.finding().unwrap();
        assert!(found.id() == "worse_with_amount" && found.is_against(Verdict::None));
        assert_eq!(
            found.sentence(),
            format!(
                "{SAME_MASS}, so the class follows from the amount: no erosion with base of 1.25 to 20 % of \
                 the filter's mass (by the curve itself). At the end of the range that erodes most (scaled, \
                 not walked): some erosion with base of 1.25 % (9.6 to 11 % eroded)."
            )
        );
        let shares = [(0.25, 0.0924), (0.5, 0.0484), (1.0, 0.0248), (2.0, 0.0122), (4.0, 0.0064)];
        let class = |share: f64| if share < 0.075 { Verdict::None } else { Verdict::Some };
        let rows = shares.map(|(factor, share)| row(factor, class(share), share));
        let loose = range(0.0373);
        let of = Amounts(Study { range: Some(&loose), ..amounts(&rows, Verdict::None).0 });
        let said = of.finding().unwrap().sentence();
        let end = "walked): at the threshold with base of 2.5 % (6.9 to 7.6 % eroded).";
        assert!(said.ends_with(end), "{said}");
        assert!(of.worse_in_words().unwrap().ends_with("some erosion with 1.25 %"));
        // Where other amounts lose another mass nothing is scaled.
        let other = [0.25, 1.0, 4.0].map(|factor| row(factor, Verdict::None, 0.02));
        let of = Amounts(Study { range: Some(&loose), ..amounts(&other, Verdict::None).0 });
        assert!(of.scaled().is_empty() && of.finding().unwrap().id() == "stays_with_amount");
    }

    /// C33 on No. 57 stone: of a quarter of the base four times the share.
    #[test]
    fn where_the_same_mass_erodes_the_class_is_said_to_follow_from_the_amount() {
        let shares = [(0.25, 0.0924), (0.5, 0.0484), (1.0, 0.0248), (2.0, 0.0122), (4.0, 0.0064)];
        let class = |share: f64| if share < 0.075 { Verdict::None } else { Verdict::Some };
        let rows = shares.map(|(factor, share)| row(factor, class(share), share));
        let worse = of(&rows, Verdict::None);
        assert_eq!(
            worse.sentence(),
            format!(
                "{SAME_MASS}, so the class follows from the amount: no erosion with base of 2.5 to 20 % of \
                     the filter's mass, some erosion with 1.25 %."
            )
        );
        // A class that is the same for all is no sturdier for it, and the ends of a range are not covered.
        let held = rows
            .clone()
            .map(|row| Sensitivity { walked: Classed { verdict: Verdict::None, ..row.walked }, ..row });
        let points = Some("by the curve itself");
        let narrow = range(0.001);
        let stays = Amounts(Study { points, range: Some(&narrow), ..amounts(&held, Verdict::None).0 });
        assert_eq!(stays.worse_in_words(), None);
        let stays = stays.finding().unwrap();
        assert_eq!(
            (stays.id(), stays.sentence()),
            (
                "stays_with_amount",
                format!(
                    "{SAME_MASS}, so that still less base would give a worse class; walked: no erosion with \
                     base of 1.25 to 20 % of the filter's mass (by the curve itself; the ends of its range \
                     were not walked with other amounts)."
                )
            )
        );
        let open =
            Amounts(Study { as_others: Verdict::None, points, ..amounts(&rows, Verdict::Undecided).0 });
        let open = open.finding().unwrap().sentence();
        assert!(
            open.starts_with(SAME_MASS)
                && open.ends_with(
                    ": undecided with base of 5 % of the filter's mass, some erosion with 1.25 %, no erosion \
                     with 2.5 %, no erosion with 10 to 20 % (other amounts by the curve itself)."
                ),
            "{open}"
        );
        let erodes = rows
            .clone()
            .map(|row| Sensitivity { walked: Classed { verdict: Verdict::Some, ..row.walked }, ..row });
        let some = of(&erodes, Verdict::Some).sentence();
        assert!(some.contains(", so that still more base would give a better class; walked: some"), "{some}");
        // Amounts that lie close together show nothing.
        assert!(!amounts(&rows[1..3], Verdict::None).is_same_mass());
    }
}
