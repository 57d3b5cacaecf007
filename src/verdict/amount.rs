//! How the verdict moves with the amount of base.

use super::entry::Finding;
use super::finding as found;
use super::practice::severity;
use super::study_points::{classes, reach, times, walked_in_words};
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
/// where no amount gives a worse class.
pub(super) fn worse_in_words(outcome: &Outcome) -> Option<String> {
    let amounts = Amounts::of(outcome);
    let worse = amounts.worse()?;
    let own = amounts.ratio().map_or_else(
        || "this amount of base".to_owned(),
        |ratio| format!("base of {} % of the filter's mass", in_digits(100.0 * ratio, DIGITS)),
    );
    let (class, other) = (amounts.verdict.words(), worse.walked.verdict.words());
    Some(format!("{class} with {own}, {other} with {}", part_of_it(worse.factor)))
}

/// A multiple of what was just named.
fn part_of_it(factor: f64) -> String {
    match factor {
        0.25 => "a quarter of it".into(),
        0.5 => "half of it".into(),
        2.0 => "twice that".into(),
        4.0 => "four times that".into(),
        _ => format!("{} times that", times(factor)),
    }
}

/// The amounts of base that were walked, beside a verdict.
struct Amounts<'a> {
    rows: &'a [Sensitivity],
    verdict: Verdict,
    /// The class of the scene's own base as the others are classed.
    as_others: Verdict,
    /// How the others are classed, where that is not as the verdict is.
    points: Option<&'a str>,
    /// Whether the constriction curve is a range, of which the ends have no other amounts.
    is_range: bool,
}

impl<'a> Amounts<'a> {
    fn of(outcome: &'a Outcome) -> Self {
        Self {
            rows: &outcome.sensitivity,
            verdict: outcome.verdict,
            as_others: outcome.class_as_points(),
            points: outcome.points_are(),
            is_range: outcome.curve_range.is_some(),
        }
    }

    fn others(&self) -> impl Iterator<Item = &'a Sensitivity> {
        self.rows.iter().filter(|row| row.factor != 1.0)
    }

    /// The other amount whose class is worst and worse than the verdict; of equal classes the amount that is
    /// nearest to the one that was asked for.
    fn worse(&self) -> Option<&'a Sensitivity> {
        let own = severity(self.verdict)?;
        let away = |row: &Sensitivity| (row.factor - 1.0).abs();
        let graded = self.others().filter_map(|row| Some((severity(row.walked.verdict)?, row)));
        let worst = graded.max_by(|a, b| a.0.cmp(&b.0).then(away(b.1).total_cmp(&away(a.1))));
        worst.filter(|(class, _)| *class > own).map(|(_, row)| row)
    }

    /// The mass of the scene's own base over that of its filter.
    fn ratio(&self) -> Option<f64> {
        self.rows.iter().find_map(|row| Some(row.mass_ratio? / row.factor))
    }

    /// Whether the mass that erodes in the first run is about the same whatever the amount: then less of a
    /// larger base erodes, by percent, though nothing else has changed.
    fn is_same_mass(&self) -> bool {
        let mass = |row: &Sensitivity| row.factor * row.walked.runs.first().map_or(f64::NAN, |s| s.mean);
        let within = |most: f64, of: &dyn Fn(&Sensitivity) -> f64| {
            let least = self.rows.iter().map(of).fold(f64::INFINITY, f64::min);
            let greatest = self.rows.iter().map(of).fold(0.0, f64::max);
            least > 0.0 && greatest <= most * least
        };
        within(ABOUT_THE_SAME, &mass) && !within(FAR_APART * (1.0 - 1e-9), &|row| row.factor)
    }

    /// The class of each amount, and how the others are classed.
    fn classes(&self) -> String {
        let others = self.others().map(|row| (row.factor, row.walked.verdict));
        let points: Vec<(f64, Verdict)> = others.chain([(1.0, self.as_others)]).collect();
        let each = match self.ratio() {
            Some(ratio) => classes(&points, |ends, is_first| {
                let share =
                    reach(ends.map(|factor| 100.0 * ratio * factor), |share| in_digits(share, DIGITS));
                let of = if is_first { " of the filter's mass" } else { "" };
                format!("with {}{share} %{of}", if is_first { "base of " } else { "" })
            }),
            None => classes(&points, |ends, _| format!("with {} times the base", reach(ends, times))),
        };
        let ends = "; the ends of its range were not walked with other amounts";
        match self.points {
            Some(points) => format!("{each} ({points}{})", if self.is_range { ends } else { "" }),
            None => each,
        }
    }

    /// What follows for the class where the same mass erodes of each amount. One class of all that were
    /// walked is no steadier for it: of less base a greater share erodes.
    fn follows(&self, is_one: bool) -> &'static str {
        match self.as_others {
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
        self.others().next()?;
        let each = self
            .others()
            .map(|row| format!("{} times the base: {}", times(row.factor), walked_in_words(&row.walked)));
        let each = each.collect::<Vec<_>>().join("; ");
        let classes = self.classes();
        let is_one = self.others().all(|row| row.walked.verdict == self.as_others);
        let why = match is_one {
            _ if self.is_same_mass() => &format!("{SAME_MASS}{}", self.follows(is_one)),
            _ if self.verdict == Verdict::Undecided => {
                "The verdict is undecided. The class by amount of base"
            }
            true => "The class does not change with the amount of base",
            false => "The class depends on the amount of base",
        };
        Some(match self.worse() {
            _ if self.verdict == Verdict::Undecided => {
                let points = self.points.map_or(String::new(), |points| format!(", {points}"));
                found::open_with_amount(why, &classes, &points, &each)
            }
            Some(row) => {
                let class = row.walked.verdict.words();
                found::worse_with_amount(why, &classes, &times(row.factor), class, &each)
            }
            None if is_one => {
                let widen = |[least, most]: [f64; 2], of: f64| [least.min(of), most.max(of)];
                let factors = self.others().map(|row| row.factor);
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
    use crate::outcome::record::{Classed, Statistic};

    fn row(factor: f64, verdict: Verdict, mean: f64) -> Sensitivity {
        let runs = vec![Statistic { mean, sd: None, low: None, high: None }];
        let walked = Classed { replicates: 1, stopped_when_clear: false, verdict, runs };
        let mass_ratio = Some(0.05 * factor);
        Sensitivity { factor, n_base: 100, grains_per_void: None, mass_ratio, walked }
    }

    fn amounts(rows: &[Sensitivity], verdict: Verdict) -> Amounts<'_> {
        Amounts { rows, verdict, as_others: verdict, points: None, is_range: false }
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
        let stays = Amounts { points, is_range: true, ..amounts(&held, Verdict::None) }.finding().unwrap();
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
        let open = Amounts { as_others: Verdict::None, points, ..amounts(&rows, Verdict::Undecided) };
        let open = open.finding().unwrap().sentence();
        assert!(
            open.starts_with(SAME_MASS) && open.ends_with("with 1.25 % (by the curve itself)."),
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
