//! The points of a study in words: which class each amount of base or thickness gives, and what was walked.

use crate::outcome::digits::percent;
use crate::outcome::numbers::in_digits;
use crate::outcome::record::{
    Classed, CurveEnd, CurveRange, OfThickness, Outcome, PanSize, Sensitivity, Statistic, Verdict,
};
use crate::outcome::undecided::UndecidedBy;

impl Outcome {
    /// The class that the other points of a study are compared with: by the curve itself, where the verdict
    /// is that of an end of its range.
    pub fn class_of_curve(&self) -> Verdict {
        let decided =
            |range: &&CurveRange| self.verdict != Verdict::Undecided && range.whole() == self.verdict;
        let range = self.curve_range.as_ref().filter(decided);
        range.map_or(self.verdict, |range| range.verdict)
    }

    /// The class of the scene itself as the other points of a study are classed: without what leaves the
    /// verdict undecided.
    pub(super) fn class_as_points(&self) -> Verdict {
        let of = match self.undecided_by() {
            Some(UndecidedBy::Pan) => {
                self.pan_bounds.as_ref().and_then(|bounds| bounds.verdict_of(PanSize::Passive))
            }
            Some(UndecidedBy::Curve) => self.curve_range.as_ref().map(|range| range.verdict),
            _ => None,
        };
        of.unwrap_or_else(|| self.class_of_curve())
    }
}

/// A point of a study: the scene walked with another amount of base or another thickness.
pub(super) trait StudyPoint {
    /// Multiple of the scene's own amount or thickness; 1 is the scene itself.
    fn factor(&self) -> f64;
    fn walked(&self) -> &Classed;
}

impl StudyPoint for Sensitivity {
    fn factor(&self) -> f64 {
        self.factor
    }

    fn walked(&self) -> &Classed {
        &self.walked
    }
}

impl StudyPoint for OfThickness {
    fn factor(&self) -> f64 {
        self.factor
    }

    fn walked(&self) -> &Classed {
        &self.walked
    }
}

/// The points of a study beside the verdict of its scene.
pub(super) struct Study<'a, P> {
    pub(super) rows: &'a [P],
    pub(super) verdict: Verdict,
    /// The class of the scene itself as the others are classed.
    pub(super) as_others: Verdict,
    /// How the others are classed, where that is not as the verdict is.
    pub(super) points: Option<&'a str>,
    /// The range of the constriction curve, whose ends were walked with the scene itself alone.
    pub(super) range: Option<&'a CurveRange>,
    /// Eroded mass fraction that divides the classes.
    pub(super) threshold: f64,
}

impl<'a, P: StudyPoint> Study<'a, P> {
    pub(super) fn of(outcome: &'a Outcome, rows: &'a [P]) -> Self {
        Self {
            rows,
            verdict: outcome.verdict,
            as_others: outcome.class_as_points(),
            points: outcome.points_are(),
            range: outcome.curve_range.as_ref(),
            threshold: outcome.threshold,
        }
    }

    /// The point of the scene itself.
    pub(super) fn own(&self) -> Option<&'a P> {
        self.rows.iter().find(|row| row.factor() == 1.0)
    }

    pub(super) fn others(&self) -> impl Iterator<Item = &'a P> + use<'a, P> {
        self.rows.iter().filter(|row| row.factor() != 1.0)
    }

    /// Whether every other point has the class of the scene itself.
    pub(super) fn stays(&self) -> bool {
        self.others().all(|row| row.walked().verdict == self.as_others)
    }

    pub(super) fn is_open(&self) -> bool {
        self.verdict == Verdict::Undecided
    }

    /// The class of each point, the scene itself last: undecided where the verdict is.
    pub(super) fn classed(&self) -> Vec<(f64, Verdict)> {
        let own = if self.is_open() { self.verdict } else { self.as_others };
        let others = self.others().map(|row| (row.factor(), row.walked().verdict));
        others.chain([(1.0, own)]).collect()
    }

    /// How the points are classed; `others` names them where the scene itself is classed otherwise. `None`
    /// where all are classed as the verdict is.
    pub(super) fn how_classed(&self, others: &str) -> Option<String> {
        let is_otherwise = self.is_open() && self.as_others != self.verdict;
        self.points.map(|points| if is_otherwise { format!("{others} {points}") } else { points.to_owned() })
    }

    /// What would erode of the other points at the end of the range of constrictions that erodes most, where
    /// that is a worse class than was walked.
    pub(super) fn scaled(&self) -> Vec<Scaled> {
        let Some((range, own)) = self.range.zip(self.own()) else {
            return Vec::new();
        };
        let of = |row: &P| scaled(range, own.walked(), (row.factor(), row.walked()), self.threshold);
        self.others().filter_map(of).collect()
    }

    /// What eroded of each other point, after its multiple and this name.
    pub(super) fn each(&self, name: &str) -> String {
        let each = |row: &P| format!("{} {name}: {}", times(row.factor()), walked_in_words(row.walked()));
        self.others().map(each).collect::<Vec<_>>().join("; ")
    }

    /// How the points are classed, behind a comma; empty where as the verdict is.
    pub(super) fn comma_points(&self) -> String {
        self.points.map_or(String::new(), |points| format!(", {points}"))
    }
}

/// Classes by rising multiples: neighbours of one class together, those of the scene itself first. `said`
/// words a group by its least and its greatest multiple, and whether it is the first.
pub(super) fn classes(points: &[(f64, Verdict)], said: impl Fn([f64; 2], bool) -> String) -> String {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups: Vec<([f64; 2], Verdict)> =
        points.chunk_by(|a, b| a.1 == b.1).map(|of| ([of[0].0, of[of.len() - 1].0], of[0].1)).collect();
    let own = groups.iter().position(|([least, most], _)| (*least..=*most).contains(&1.0));
    if let Some(own) = own {
        groups[..=own].rotate_right(1);
    }
    let each = groups.iter().enumerate();
    let each = each.map(|(at, (ends, class))| format!("{} {}", class.words(), said(*ends, at == 0)));
    each.collect::<Vec<_>>().join(", ")
}

/// From one number to another in these words, or the one that both are.
pub(super) fn reach([least, most]: [f64; 2], words: impl Fn(f64) -> String) -> String {
    if least == most { words(least) } else { format!("{} to {}", words(least), words(most)) }
}

/// A multiple, without digits that say nothing.
pub(super) fn times(factor: f64) -> String {
    let times = format!("{factor:.3}");
    times.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// What would erode of a point of a study at the end of the range of constrictions that erodes most: scaled,
/// not walked.
pub(super) struct Scaled {
    /// Multiple of the scene's own amount or thickness.
    pub(super) factor: f64,
    /// The class in words; `AT_THRESHOLD` where the interval straddles the threshold.
    pub(super) class: &'static str,
    /// Least and most eroded in the first run (fraction of the mass).
    eroded: [f64; 2],
}

const AT_THRESHOLD: &str = "at the threshold";

impl Scaled {
    /// Whether it lies beyond the threshold as a whole.
    pub(super) fn erodes(&self) -> bool {
        self.class != AT_THRESHOLD
    }
}

/// Scales what erodes at the end of the range that erodes most by what the point and the scene itself lose
/// with the middle curve; `None` where that is no worse than the class of the point.
fn scaled(
    range: &CurveRange,
    own: &Classed,
    (factor, point): (f64, &Classed),
    threshold: f64,
) -> Option<Scaled> {
    let times = point.runs.first()?.mean / own.runs.first()?.mean;
    let span = |of: &Statistic| [of.low.unwrap_or(of.mean), of.high.unwrap_or(of.mean)].map(|of| of * times);
    let first = |of: &CurveEnd| of.walked.runs.first().map(&span);
    let most = |of: &CurveEnd| first(of).map_or(0.0, |[_, most]| most);
    let end = range.ends.iter().max_by(|a, b| most(a).total_cmp(&most(b)))?;
    let eroded = first(end)?;
    let second = end.walked.runs.get(1).map(span);
    let class = match eroded {
        [least, _] if least >= threshold => match second {
            Some([_, most]) if most < threshold => "some erosion",
            _ => "at least some erosion",
        },
        [_, most] if most >= threshold => AT_THRESHOLD,
        _ => return None,
    };
    let is_worse = match point.verdict {
        Verdict::None => true,
        Verdict::Undecided => class != AT_THRESHOLD,
        Verdict::Some | Verdict::Continuing => false,
    };
    is_worse.then_some(Scaled { factor, class, eroded })
}

/// What follows the classes of the points where the end that erodes most gives worse ones; empty where none
/// does. `said` words a point by its multiple.
pub(super) fn at_end(scaled: &[Scaled], said: impl Fn(f64) -> String) -> String {
    if scaled.is_empty() {
        return String::new();
    }
    let each = scaled.iter().map(|of| {
        let eroded = of.eroded.map(|share| in_digits(100.0 * share, 2));
        let eroded = if eroded[0] == eroded[1] { eroded[0].clone() } else { eroded.join(" to ") };
        format!("{} {} ({eroded} % eroded)", of.class, said(of.factor))
    });
    let each = each.collect::<Vec<_>>().join(", ");
    format!(". At the end of the range that erodes most (scaled, not walked): {each}")
}

/// What makes least and most eroded over a range wider than its ends that were walked; empty where nothing
/// does.
pub(super) fn beside_ends(range: &CurveRange) -> &'static str {
    if range.has_intervals() { ", 95 % intervals included" } else { "" }
}

/// The class of other walks, and what eroded in them.
fn walked_in_words(walked: &Classed) -> String {
    let eroded: Vec<String> = walked.runs.iter().map(|s| share(s, walked.stopped_when_clear)).collect();
    let replicates = if walked.replicates == 1 { "replicate" } else { "replicates" };
    let (class, count) = (walked.verdict.words(), walked.replicates);
    format!("{class}, {} eroded in {count} {replicates}", eroded.join(" then "))
}

/// The eroded mass; of a point that stopped early its interval, as one replicate has no digits to show.
fn share(eroded: &Statistic, stopped: bool) -> String {
    match (eroded.low, eroded.high) {
        (Some(low), Some(high)) if stopped => format!("{:.0} to {:.0} %", 100.0 * low, 100.0 * high),
        _ => percent(eroded.mean),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_of_one_class_stand_together_and_the_scene_itself_first() {
        use Verdict::{None, Some, Undecided};
        let said = |ends: [f64; 2], first: bool| {
            format!("{}{}", reach(ends, times), if first { " times" } else { "" })
        };
        let points = [(0.25, Some), (4.0, None), (0.5, Undecided), (1.0, None), (2.0, None)];
        let words = classes(&points, said);
        assert_eq!(words, "no erosion 1 to 4 times, some erosion 0.25, undecided 0.5");
        assert_eq!(classes(&[(1.0, None), (0.5, None)], said), "no erosion 0.5 to 1 times");
    }

    #[test]
    fn a_point_that_stopped_early_has_its_interval() {
        let runs = vec![Statistic { mean: 0.59, sd: None, low: Some(0.386), high: Some(0.797) }];
        let walked = Classed { replicates: 1, stopped_when_clear: true, verdict: Verdict::Continuing, runs };
        let said = "continuing erosion, 39 to 80 % eroded in 1 replicate";
        assert_eq!(walked_in_words(&walked), said);
    }
}
