//! What every face says first: whether the filter holds, the line of practice, the line of the walk, and the
//! three findings that matter most.

use super::amount::worse_in_words;
use super::beside::is_evidence;
use super::entry::{
    BROAD_BASE, COHESIVE_FINES, DISPERSIVE_WOULD_NOT_HOLD, EVIDENCE_UNSAFE, GUESSED_CONSTRICTIONS,
    LOSES_FINES,
};
use super::practice::{Standing, broken, standing};
use super::probability::{beside_range, is_beyond_range, stated};
use super::rule_words::against;
use super::study_points::beside_ends;
use super::tested::is_beyond_tests;
use super::washout::washout;
use crate::gradation::Gradation;
use crate::outcome::digits::{percent, percent_span};
use crate::outcome::numbers::in_digits;
use crate::outcome::record::{
    AppliedRule, Confidence, Direction, FindingRecord, Outcome, PanReading, RuleRole, RunSummary, Statistic,
    Verdict,
};
use crate::outcome::rules::PAPER_NO_EROSION;

/// Findings that stand on the first page and on a terminal; the rest stand further down the page.
pub const FOREMOST: usize = 3;

impl Outcome {
    /// Whether the filter holds, does not, or nobody can say, in a line.
    pub fn headline(&self) -> String {
        let said = headline(&self.rules, self.verdict, &self.doubts(), worse_in_words(self));
        match self.beyond_if_dispersive() {
            Some(_) => unless_dispersive(&said),
            None => said,
        }
    }

    /// The lines that every face begins with, each under its name.
    pub fn first_lines(&self) -> [(&'static str, String); 4] {
        [
            ("Verdict", self.headline()),
            ("Practice", self.practice_in_words()),
            ("Walk", self.walk_in_words()),
            ("Next", self.next_in_words()),
        ]
    }

    /// What the walk says, in a line: its class, the mass eroded, how far it can be relied on, what tests on
    /// soils of this kind make of it (within the checked range a probability, else where D15F lies beside
    /// them), and in how many networks no path is left open.
    pub fn walk_in_words(&self) -> String {
        let mass = self.over_curve_range().unwrap_or_else(|| {
            let what = "95 % interval by the scatter of replicates ";
            let runs = [("first run", what), ("second", "")].into_iter().zip(&self.summary);
            runs.map(|((name, what), run)| eroded(name, what, run)).collect::<Vec<_>>().join(", ")
        });
        let mass = mass + &self.beyond_over_readings().unwrap_or_default();
        let mut said = format!("{}; eroded {mass}", self.verdict.words());
        // What practice says of the filter itself stands in the lines above.
        if self.hides_probability() {
            said += &format!("; {}", self.confidence_in_brief());
        }
        if self.confidence == Confidence::Contradicted {
            said += &self.openings_of_few().unwrap_or_default();
        }
        if self.verdict != Verdict::Continuing && self.errs_unsafely() {
            said += "; the walk errs on the unsafe side for this pair";
        }
        if let Some(beyond) = self.beyond_its_own_boundary() {
            said += &format!("; {beyond}");
        }
        [self.beside_tests(), self.no_open_path()]
            .into_iter()
            .flatten()
            .fold(said, |said, more| format!("{said}. {more}"))
    }

    /// Whether the walk errs on the unsafe side for this pair, by soils of its kind or by its own base.
    pub fn errs_unsafely(&self) -> bool {
        let errs =
            |of: &FindingRecord| of.direction == Direction::Unsafe && ERRS_UNSAFELY.contains(&of.id.as_str());
        self.findings.iter().any(errs)
    }

    /// That a pair that holds in the walk lies beyond the boundary of no erosion that the authors of the
    /// model found with it.
    fn beyond_its_own_boundary(&self) -> Option<String> {
        let rule = self.rules.iter().find(|rule| rule.id == PAPER_NO_EROSION && rule.met == Some(false));
        let [value, limit] = against(rule.filter(|_| self.verdict == Verdict::None)?, 3);
        Some(format!(
            "beyond the boundary of no erosion of the network with which the model was published (Shire & \
             O'Sullivan: D15F/D85B {value} > {limit})"
        ))
    }

    /// How little of the filter's mass sets the openings that were walked, where they are guessed from its
    /// grains by number and half of these have less than [`FEW_PERCENT`] of its mass.
    fn openings_of_few(&self) -> Option<String> {
        let filter = &self.inputs.filter;
        let is_guessed = self.findings.iter().any(|finding| finding.id == GUESSED_CONSTRICTIONS);
        let curve = Gradation::of_rows(&filter.gradation).ok().filter(|_| is_guessed)?;
        // The pan fraction is not walked.
        let finer = curve.percent_finer_by_mass(filter.d50_by_number_mm) - filter.gradation.first()?[1];
        (0.0..FEW_PERCENT).contains(&finer).then(|| {
            format!(
                " (half of the filter's grains by number, which set the openings walked, are {} % of its \
                 mass)",
                in_digits(finer, 2)
            )
        })
    }

    /// In how many networks no path is left open after the last run: that nothing erodes there any more says
    /// nothing of the soil.
    fn no_open_path(&self) -> Option<String> {
        let last = self.summary.last().filter(|_| self.verdict != Verdict::Continuing)?.run;
        let runs = || self.replicates.iter().flat_map(|of| &of.runs).filter(|run| run.run == last);
        let closed = runs().filter(|run| run.backbone_fraction == 0.0).count();
        let which = if last == 1 { "first" } else { "second" };
        let of = runs().count();
        (closed > 0).then(|| {
            format!(
                "No open path for base particles is left in {closed} of {of} networks after the {which} run; \
                 this says nothing of the filter's drainage"
            )
        })
    }

    /// Least and most of the base's mass that erode over the range of the constriction curve, run by run: the
    /// class is that of the whole range. `None` where the curve is no range.
    pub fn over_curve_range(&self) -> Option<String> {
        let range = self.curve_range.as_ref()?;
        let run = |(ends, name): (&[f64; 2], &str)| {
            format!("{} in the {name}", percent_span(ends.map(|of| of.max(0.0))))
        };
        let runs = range.eroded_mass_fraction.iter().zip(["first run", "second"]);
        let said = runs.map(run).collect::<Vec<_>>().join(", ");
        (!said.is_empty()).then(|| said + " over the range of constrictions" + beside_ends(range))
    }

    /// The most that erodes over the readings of the base's finest part, where that is more than the mass
    /// beside it. Each reading was walked with the curve itself.
    fn beyond_over_readings(&self) -> Option<String> {
        let most = |of: &Statistic| of.high.unwrap_or(of.mean);
        let first = |of: &PanReading| of.walked.runs.first().map(most);
        let range = self.curve_range.as_ref().and_then(|range| Some(range.eroded_mass_fraction.first()?[1]));
        let said = range.or_else(|| Some(most(&self.summary.first()?.eroded_mass_fraction)))?;
        let over = self.pan_bounds.as_ref()?.readings.iter().filter_map(first).fold(f64::NAN, f64::max);
        let apart = if range.is_some() { " (the two were not walked together)" } else { "" };
        (over > said).then(|| {
            format!(
                ", and up to {} in the first run over the readings of the base's finest part{apart}",
                percent(over)
            )
        })
    }

    /// Whether both probabilities that a test would show no erosion stand beside the verdict: where one
    /// alone does, or none, [`Outcome::beside_tests`] says which and why.
    pub fn shows_probabilities(&self) -> bool {
        !self.hides_probability() && !is_beyond_tests(&self.rules)
    }

    /// The probability that a test would show no erosion. Outside the checked range, against practice, and
    /// beyond every D15F without erosion nobody can answer for one: there stands where D15F lies beside the
    /// range of tests.
    pub fn beside_tests(&self) -> Option<String> {
        let evidence = self.evidence.as_ref()?;
        if self.hides_probability() || is_beyond_range(evidence.probability_by_tests) {
            return Some(beside_range(self.inputs.filter.d15_mm, evidence.range_of_tests_mm?, ""));
        }
        let each = evidence.probabilities(is_beyond_tests(&self.rules))?;
        Some(stated(&each, evidence.range_of_tests_mm))
    }

    /// The findings that matter most, at most [`FOREMOST`], and how many more there are.
    pub fn foremost(&self) -> (Vec<FindingRecord>, usize) {
        let mut all = self.ordered();
        let more = all.split_off(all.len().min(FOREMOST)).len();
        (all, more)
    }

    /// All findings in the order of a reader, but the line of evidence: what speaks against the verdict, then
    /// the rest.
    pub fn ordered(&self) -> Vec<FindingRecord> {
        let all = self.against().into_iter().chain(self.besides());
        // The line of practice has the limit of a dispersive base that the filter breaks, and what a filter
        // that is too coarse without its finer part may lose.
        let is_said = |finding: &FindingRecord| match finding.id.as_str() {
            DISPERSIVE_WOULD_NOT_HOLD => self.beyond_if_dispersive().is_some(),
            LOSES_FINES => washout(&self.rules).is_some(),
            _ => false,
        };
        let all = all.filter(|finding| !is_evidence(finding) && !is_said(finding));
        let mut all: Vec<FindingRecord> = all.collect();
        keep(&mut all, FOREMOST - 1, |finding| finding.id == BROAD_BASE);
        if self.verdict == Verdict::None {
            unfold(&mut all);
        }
        all
    }
}

/// Findings by which the walk errs on the unsafe side for a pair.
const ERRS_UNSAFELY: [&str; 3] = [EVIDENCE_UNSAFE, "broadly_graded", "not_regraded"];

/// Keeps among the foremost what "no erosion" hangs on: fines whose cohesion the walk ignores though the
/// class stands, and that it does not with less base.
fn unfold(all: &mut [FindingRecord]) {
    keep(all, FOREMOST - 2, |finding| !finding.against && finding.id == COHESIVE_FINES);
    keep(all, FOREMOST - 1, |finding| finding.against && finding.id == "worse_with_amount");
}

/// Brings the first finding of a kind forward to this place, if it stands behind it.
fn keep(all: &mut [FindingRecord], place: usize, is_kept: impl Fn(&FindingRecord) -> bool) {
    if let Some(at) = all.iter().position(is_kept).filter(|at| *at > place) {
        all[place..=at].rotate_right(1);
    }
}

/// Of less of a filter's mass (%) sieves tell little.
const FEW_PERCENT: f64 = 1.0;

/// Beyond the limit of design, and within the boundary of no erosion.
const NO_MARGIN: &str = "does not meet the limit of design, though tests held such filters";

/// Whether a filter of a class, with these doubts, holds, does not, or nobody can say, in a line; with the
/// class of the walk and the worse one that another amount of base gives, where there is one.
///
/// Practice speaks first: a walk that is more favourable never makes a filter a good one.
pub fn headline(
    rules: &[AppliedRule],
    verdict: Verdict,
    doubts: &[Confidence],
    by_amount: Option<String>,
) -> String {
    let standing = standing(rules);
    let walked = verdict.words();
    let said = match (&standing, verdict) {
        (Standing::NoRules, Verdict::Undecided) => "nobody can say yet: the walk is undecided".into(),
        (Standing::NoRules, _) => format!("{walked} in the model"),
        (Standing::Fails, Verdict::None) => {
            "does not meet practice, though the walk says no erosion: rely on practice".into()
        }
        (Standing::Fails, Verdict::Undecided) => "does not meet practice; the walk is undecided".into(),
        (Standing::Fails, _) => format!("does not hold: practice is not met, {walked} in the model"),
        (Standing::WashedOut, Verdict::None | Verdict::Undecided) => {
            "does not meet practice: the filter may lose its finer part, and is too coarse without it".into()
        }
        (Standing::WashedOut, _) => {
            format!(
                "does not hold: {walked} in the model, and the filter may lose its finer part and is too \
                 coarse without it"
            )
        }
        (Standing::NoMargin, Verdict::Undecided) => format!("{NO_MARGIN}; the walk is undecided"),
        (Standing::NoMargin, _) => format!("{NO_MARGIN}; {walked} in the model"),
        (Standing::Unstable, Verdict::Continuing) => {
            format!("does not hold: {walked} in the model, and the filter may lose its finer part")
        }
        (Standing::Unstable, _) => "may not hold: the filter may lose its finer part".into(),
        (Standing::Open(between), Verdict::Undecided) => {
            format!("practice is not known: {between}; the walk is undecided")
        }
        (Standing::Open(between), _) => format!("practice is not known: {between}; {walked} in the model"),
        (Standing::Unknown(needs), Verdict::Undecided) => {
            format!("nobody can say yet: practice needs {needs}, and the walk is undecided")
        }
        (Standing::Unknown(needs), Verdict::None) => {
            format!("nobody can say yet: practice needs {needs}; {walked} in the model")
        }
        (Standing::Unknown(needs), _) => {
            format!("may not hold: {walked} in the model; practice needs {needs}")
        }
        (Standing::Met, Verdict::None) if doubts.is_empty() => "holds: practice and walk agree".into(),
        (Standing::Met, Verdict::None) => {
            let by_amount = by_amount.map(|by_amount| format!("the walk: {by_amount}"));
            let said = doubts.iter().map(|doubt| match (doubt, &by_amount) {
                (Confidence::Outside, Some(by_amount)) => by_amount,
                _ => reservation(*doubt),
            });
            format!("holds by practice; {}", said.collect::<Vec<_>>().join("; "))
        }
        (Standing::Met, Verdict::Undecided) => "holds by practice; the walk is undecided".into(),
        (Standing::Met, _) => format!("holds by practice; the walk is stricter: {walked} in the model"),
    };
    // Of a filter that is too coarse as it is the line of practice says so.
    let unstable = matches!(standing, Standing::NoMargin | Standing::Unknown(_) | Standing::Open(_))
        && breaks(rules, RuleRole::Stability);
    // A walk that agrees has said what the doubt is.
    let is_said = standing == Standing::Met && verdict == Verdict::None;
    let dry = !is_said && breaks(rules, RuleRole::Drainage);
    let wide = !is_said && standing == Standing::Met && breaks(rules, RuleRole::Placing);
    let more = [
        (unstable, "; the filter may lose its finer part"),
        (dry, "; the filter may not drain"),
        (wide, "; the filter may segregate"),
    ];
    more.into_iter().filter(|(holds, _)| *holds).fold(said, |said, (_, more)| said + more)
}

/// What keeps "no erosion" from being said without reserve, where practice is met.
fn reservation(confidence: Confidence) -> &'static str {
    match confidence {
        Confidence::MayNotDrain => "the filter may not drain the base",
        Confidence::MaySegregate => "the filter may segregate when placed",
        Confidence::Unstable => "the filter may lose its finer part",
        Confidence::Contradicted => "another rule argues against it",
        Confidence::Within | Confidence::Outside => {
            "no erosion in the walk, outside the range in which it was checked"
        }
    }
}

/// The same of a filter that holds on a condition alone.
fn unless_dispersive(said: &str) -> String {
    let holds = ["holds by practice", "holds"].into_iter().find(|begin| said.starts_with(begin));
    holds.map_or_else(
        || said.to_owned(),
        |begin| said.replacen(begin, &format!("{begin} unless the base is dispersive"), 1),
    )
}

fn breaks(rules: &[AppliedRule], role: RuleRole) -> bool {
    !broken(rules, role).is_empty()
}

fn eroded(name: &str, what: &str, run: &RunSummary) -> String {
    let eroded = &run.eroded_mass_fraction;
    // An interval that is no wider than the last digit of its mean says nothing.
    let is_wide = |(low, high): &(f64, f64)| {
        let [mean, low, high] = [eroded.mean, *low, *high].map(|of| percent(of.max(1e-9)));
        mean != low || mean != high
    };
    let interval = match eroded.low.zip(eroded.high).filter(is_wide) {
        Some((low, high)) => format!(" ({what}{})", percent_span([low, high].map(|of| of.max(0.0)))),
        None => String::new(),
    };
    format!("{} in the {name}{interval}", percent(eroded.mean))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::verdict::{PairRules, judge};

    fn said(filter: &[(f64, f64)], base: &[(f64, f64)], verdict: Verdict) -> String {
        let soil = |points| Gradation::from_lines(points).unwrap();
        let rules = PairRules::of(&soil(base), &soil(filter)).rules;
        let label = judge(verdict, &rules, Vec::new()).confidence;
        let doubts: Vec<Confidence> = Confidence::DOUBTS.into_iter().filter(|of| *of == label).collect();
        headline(&rules, verdict, &doubts, None)
    }

    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];
    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
    const GRAVEL: [(f64, f64); 3] = [(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)];
    const GOOD: [(f64, f64); 2] = [(1.0, 0.0), (3.0, 100.0)];
    const COARSE: [(f64, f64); 2] = [(8.0, 0.0), (16.0, 100.0)];
    /// Between the limit of design and the boundary that tests saw.
    const BETWEEN: [(f64, f64); 2] = [(2.5, 0.0), (5.0, 100.0)];

    #[test]
    fn practice_and_walk_stand_in_one_line() {
        assert_eq!(said(&GOOD, &SAND, Verdict::None), "holds: practice and walk agree");
        for (verdict, line) in [
            (Verdict::Some, "holds by practice; the walk is stricter: some erosion in the model"),
            (Verdict::Continuing, "holds by practice; the walk is stricter: continuing erosion in the model"),
            (Verdict::Undecided, "holds by practice; the walk is undecided"),
        ] {
            assert_eq!(said(&GOOD, &SAND, verdict), line);
        }
        for (filter, base) in [(&GRAVEL[..], &TILL[..]), (&COARSE, &SAND)] {
            for verdict in [Verdict::Some, Verdict::Continuing] {
                let line = format!("does not hold: practice is not met, {} in the model", verdict.words());
                assert_eq!(said(filter, base, verdict), line);
            }
            let none = said(filter, base, Verdict::None);
            assert_eq!(none, "does not meet practice, though the walk says no erosion: rely on practice");
            let open = said(filter, base, Verdict::Undecided);
            assert_eq!(open, "does not meet practice; the walk is undecided");
        }
        let margin = said(&BETWEEN, &SAND, Verdict::None);
        assert_eq!(
            margin,
            "does not meet the limit of design, though tests held such filters; no erosion in the model"
        );
        assert_eq!(headline(&[], Verdict::None, &[Confidence::Outside], None), "no erosion in the model");
    }

    #[test]
    fn what_no_erosion_hangs_on_is_among_the_foremost() {
        use crate::verdict::finding;
        let note = || finding::not_studied().record(false);
        let fines = || finding::cohesive_fines(20.0).settled().record(false);
        let amount =
            || finding::worse_with_amount("why", "classes", "0.5", "some erosion", "each").record(true);
        let ordered = |mut all: Vec<FindingRecord>| -> Vec<String> {
            unfold(&mut all);
            all.into_iter().map(|finding| finding.id).collect()
        };
        let both = ordered(vec![note(), note(), note(), amount(), note(), fines()]);
        assert_eq!(both[1..3], ["cohesive_fines", "worse_with_amount"]);
        assert_eq!(ordered(vec![note(), note(), note(), fines()])[1], "cohesive_fines");
        let both = ordered(vec![note(), note(), fines(), amount()]);
        assert_eq!(both[1..3], ["cohesive_fines", "worse_with_amount"]);
        assert_eq!(ordered(vec![note(), fines(), note()])[1], "cohesive_fines");
    }

    #[test]
    fn what_holds_on_a_condition_alone_is_said_with_it() {
        for (said, with) in [
            (
                "holds by practice; the walk is",
                "holds by practice unless the base is dispersive; the walk is",
            ),
            ("holds: practice and", "holds unless the base is dispersive: practice and"),
            ("may not hold: the filter", "may not hold: the filter"),
        ] {
            assert_eq!(unless_dispersive(said), with);
        }
    }

    /// Nobody reads "holds" alone where practice has something against the filter.
    #[test]
    fn what_speaks_against_the_filter_stands_in_the_line() {
        let fine = said(&SAND, &SAND, Verdict::None);
        assert_eq!(fine, "holds by practice; the filter may not drain the base");
        let fine = said(&SAND, &SAND, Verdict::Undecided);
        assert_eq!(fine, "holds by practice; the walk is undecided; the filter may not drain");
        let gap = [(0.3, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];
        assert_eq!(
            said(&gap, &SAND, Verdict::None),
            "does not meet practice: the filter may lose its finer part, and is too coarse without it; the \
             filter may not drain"
        );
        let some = said(&gap, &SAND, Verdict::Some);
        assert!(
            some.starts_with("does not hold: some erosion in the model, and the filter may lose "),
            "{some}"
        );
        // Without its finer part a filter of half the size still retains the sand.
        assert_eq!(
            said(&gap.map(|(size, percent)| (0.5 * size, percent)), &SAND, Verdict::None),
            "may not hold: the filter may lose its finer part; the filter may not drain"
        );
        // A sand whose fines nobody sieved.
        let hidden = said(&GOOD, &[(0.3, 25.0), (1.0, 100.0)], Verdict::None);
        assert!(
            hidden.starts_with("nobody can say yet: practice needs finer sieves of the base; "),
            "{hidden}"
        );
    }
}
