//! The folder of a reproduction: a campaign's folder for each plan, and a percolation study.

use std::path::Path;

use voidwalk::outcome::ledger::LedgerLine;
use voidwalk::outcome::packing::Summary;
use voidwalk::outcome::percolation::PercolationStudy;
use voidwalk::outcome::record::{FilterRecord, Outcome, RunSummary, SeriesRow, SizeRow, Statistic};
use voidwalk::report::ReportError;
use voidwalk::report::files::{json, lines, rows};

/// A way to run the paper's campaign.
pub struct Variant {
    /// Name of the plan and of its folder.
    pub name: &'static str,
    /// What a reader calls it.
    pub title: &'static str,
    /// Its constriction curves.
    pub curves: Curves,
    /// The variant that has the cases which this one does not walk again because nothing changes for them.
    over: Option<&'static str>,
}

/// Where constriction curves come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curves {
    /// Our own packings, voids merged at the overlap that was fitted to the paper's Table 2.
    Own,
    /// The authors' own.
    Published,
    /// Our own packing, voids merged at the overlap that the paper states.
    AsStated,
}

const fn variant(
    name: &'static str,
    title: &'static str,
    curves: Curves,
    over: Option<&'static str>,
) -> Variant {
    Variant { name, title, curves, over }
}

/// The first is the one that the page is about; each other one changes what its title says, and nothing else.
pub const VARIANTS: [Variant; 9] = [
    variant("paper", "own curves, grains per void as packed", Curves::Own, None),
    variant(
        "paper-hull",
        "published curves (convex hulls at 50 %), grains per void of that rule",
        Curves::Published,
        None,
    ),
    variant("paper-inverse", "voids per grain in place of grains per void, cap 2e8", Curves::Own, None),
    variant("paper-2.5", "2.5 grains per void", Curves::Own, None),
    variant("paper-capped", "cap 2e8", Curves::Own, Some("paper")),
    variant("paper-2.5-capped", "2.5 grains, cap 2e8", Curves::Own, Some("paper-2.5")),
    variant("paper-published", "published curves, grains per void of our own rule", Curves::Published, None),
    variant("paper-published-2.5", "published curves, 2.5 grains", Curves::Published, None),
    variant("overlap-0.5", "voids merged at an overlap of 50 %, all facets", Curves::AsStated, None),
];

/// The variant of this name.
pub fn variant_of(name: &str) -> Option<&'static Variant> {
    VARIANTS.iter().find(|variant| variant.name == name)
}

/// Plans beside those of [`VARIANTS`].
const OTHERS: [&str; 4] = ["kenney", "table3", "one-size", "progress"];

/// A case: its line of the ledger and its outcome.
pub struct Case {
    pub line: LedgerLine,
    pub outcome: Outcome,
}

/// The cases of a campaign.
pub struct Walked {
    /// Name of the plan.
    pub name: &'static str,
    /// In the order of the plan.
    pub cases: Vec<Case>,
}

/// All that the folder of a reproduction holds. What has not been walked is missing here, and its rows say
/// so.
pub struct Study {
    campaigns: Vec<Walked>,
    pub percolation: Option<PercolationStudy>,
    /// Of the cases of Fig. 13, by name.
    pub series: Vec<(&'static str, Vec<SeriesRow>)>,
    /// Size curves of what the case of Fig. 18 retains.
    pub retained: Vec<SizeRow>,
    /// Voids and constrictions of packed grains, by the curves that their overlap gives.
    pub packed: Vec<(Curves, Summary)>,
}

/// Cases of Fig. 13 in the plan `progress`.
const SERIES: [&str; 3] = ["fig13-continuing", "fig13-some", "fig13-none"];

impl Study {
    pub fn read(folder: &Path) -> Result<Self, ReportError> {
        let mut campaigns = Vec::new();
        for name in VARIANTS.iter().map(|variant| variant.name).chain(OTHERS) {
            let place = folder.join(name);
            if place.join("ledger.jsonl").is_file() {
                campaigns.push(Walked { name, cases: cases(&place)? });
            }
        }
        let path = folder.join("percolation/percolation.json");
        let percolation = if path.is_file() { Some(json(&path)?) } else { None };
        let packed = packed(folder)?;
        let mut study = Self { campaigns, percolation, series: Vec::new(), retained: Vec::new(), packed };
        let place =
            |name| study.named("progress", name).map(|c| folder.join("progress").join(&c.line.folder));
        let mut series = Vec::new();
        for name in SERIES {
            if let Some(place) = place(name) {
                series.push((name, bare(rows(&place.join("series.csv"))?)));
            }
        }
        if let Some(place) = place("fig18") {
            study.retained = bare(rows(&place.join("retained.csv"))?);
        }
        study.series = series;
        Ok(study)
    }

    /// Whether there is nothing at all.
    pub fn is_empty(&self) -> bool {
        self.percolation.is_none() && self.campaigns.iter().all(|walked| walked.cases.is_empty())
    }

    /// The campaigns that were walked.
    pub fn walked(&self) -> &[Walked] {
        &self.campaigns
    }

    /// The variants that were walked.
    pub fn variants(&self) -> impl Iterator<Item = &'static Variant> {
        VARIANTS.iter().filter(|variant| self.campaigns.iter().any(|walked| walked.name == variant.name))
    }

    /// The cases of a plan; for a variant that walks only what it changes, those of the one below it too.
    pub fn cases(&self, plan: &str) -> Vec<&Case> {
        let own = |name: &str| self.campaigns.iter().find(|walked| walked.name == name).map(|w| &w.cases);
        let Some(cases) = own(plan) else { return Vec::new() };
        let below = variant_of(plan).and_then(|variant| variant.over);
        let mut all: Vec<&Case> = below.and_then(own).into_iter().flatten().collect();
        for case in cases {
            match all.iter().position(|other| other.line.case == case.line.case) {
                Some(at) => all[at] = case,
                None => all.push(case),
            }
        }
        all
    }

    /// The case of these levels.
    pub fn case(&self, plan: &str, levels: &[(&str, &str)]) -> Option<&Case> {
        let fits = |case: &&Case| levels.iter().all(|(factor, level)| case.level(factor) == *level);
        self.cases(plan).into_iter().find(fits)
    }

    /// The case of this name.
    pub fn named(&self, plan: &str, name: &str) -> Option<&Case> {
        self.cases(plan).into_iter().find(|case| case.line.case == name)
    }

    /// A filter of a plan by the name of its level.
    pub fn filter(&self, plan: &str, name: &str) -> Option<&FilterRecord> {
        self.case(plan, &[("filter", name)]).map(|case| &case.outcome.inputs.filter)
    }
}

/// Whether two tellings of the same runs agree; a number that goes through JSON twice may lose its last bit.
fn same(a: &[RunSummary], b: &[RunSummary]) -> bool {
    let close = |(a, b): (&RunSummary, &RunSummary)| {
        (a.eroded_mass_fraction.mean - b.eroded_mass_fraction.mean).abs() < 1e-12
            && (a.blocked_fraction.mean - b.blocked_fraction.mean).abs() < 1e-12
    };
    a.len() == b.len() && a.iter().zip(b).all(close)
}

/// Rows without their lines.
fn bare<T>(rows: Vec<(u64, T)>) -> Vec<T> {
    rows.into_iter().map(|(_, row)| row).collect()
}

/// The grains of the loose filter with Cu 1.5 that `overlap-0.5` packs, by both overlaps; what is not there
/// is left out.
fn packed(folder: &Path) -> Result<Vec<(Curves, Summary)>, ReportError> {
    let by_plan = std::fs::read_dir(folder.join("packings")).into_iter().flatten().flatten();
    let by_plan = by_plan.map(|entry| (Curves::AsStated, entry.path()));
    let by_our_overlap = (Curves::Own, folder.join("constrictions"));
    let mut places: Vec<_> = by_plan.chain([by_our_overlap]).collect();
    places.iter_mut().for_each(|(_, place)| place.push("constrictions.json"));
    places.retain(|(_, place)| place.is_file());
    places.into_iter().map(|(curves, place)| Ok((curves, json(&place)?))).collect()
}

fn cases(place: &Path) -> Result<Vec<Case>, ReportError> {
    let ledger: Vec<LedgerLine> = lines(&place.join("ledger.jsonl"))?;
    let one = |line: LedgerLine| {
        let path = place.join(&line.folder).join("outcome.json");
        let outcome: Outcome = json(&path)?;
        if outcome.seed != line.seed || !same(&outcome.summary, &line.runs) {
            return Err(ReportError::Value {
                path,
                field: "seed and summary".into(),
                value: "not what ledger.jsonl says".into(),
                allowed: "the outcome that the ledger was collected from".into(),
            });
        }
        Ok(Case { line, outcome })
    };
    ledger.into_iter().map(one).collect()
}

/// From this share of the base's largest size on, an eroded particle counts as its largest.
const ITS_LARGEST: f64 = 0.99;

impl Case {
    /// Level of a factor; empty where the case has none.
    pub fn level(&self, factor: &str) -> &str {
        self.line.levels.get(factor).and_then(|level| level.as_str()).unwrap_or("")
    }

    /// Whether the filter is a loose one.
    pub fn is_loose(&self) -> bool {
        self.level("filter").ends_with("loose")
    }

    /// Statistics of run 1 or 2.
    pub fn run(&self, run: usize) -> Option<&RunSummary> {
        self.line.runs.get(run - 1)
    }

    /// Percent of the base mass eroded in run 1 or 2.
    pub fn eroded(&self, run: usize) -> Option<Statistic> {
        self.run(run).map(|summary| times(&summary.eroded_mass_fraction, 100.0))
    }

    /// Mean of the same; 0 where there is no such run.
    pub fn mean(&self, run: usize) -> f64 {
        self.eroded(run).map_or(0.0, |eroded| eroded.mean)
    }

    /// Largest particle eroded in run 1 or 2, over D15F.
    pub fn largest(&self, run: usize) -> Option<Statistic> {
        self.run(run).and_then(|summary| summary.largest_eroded_over_d15f)
    }

    /// The same over D0F.
    pub fn largest_over_d0f(&self, run: usize) -> Option<Statistic> {
        let filter = &self.outcome.inputs.filter;
        self.largest(run).map(|largest| times(&largest, filter.d15_mm / filter.d0_mm))
    }

    /// Whether the largest particle eroded in run 1 or 2 is the base's own largest: then something larger
    /// might have eroded too, and the filter says no more than that.
    pub fn erodes_its_largest(&self, run: usize) -> bool {
        let inputs = &self.outcome.inputs;
        let is_own =
            |largest: Statistic| largest.mean * inputs.filter.d15_mm >= ITS_LARGEST * inputs.base.d100_mm;
        self.largest(run).is_some_and(is_own)
    }

    /// D15F / D85B.
    pub fn d85_ratio(&self) -> f64 {
        self.line.ratios.d15f_over_d85b
    }

    /// D15F / D95B.
    pub fn d95_ratio(&self) -> f64 {
        self.line.ratios.d15f_over_d95b
    }

    /// D50B / D0F.
    pub fn d50b_over_d0f(&self) -> Option<f64> {
        Some(self.outcome.inputs.base.d50_mm? / self.outcome.inputs.filter.d0_mm)
    }
}

/// A statistic in other units.
pub fn times(statistic: &Statistic, factor: f64) -> Statistic {
    Statistic {
        mean: statistic.mean * factor,
        sd: statistic.sd.map(|sd| sd * factor),
        low: statistic.low.map(|low| low * factor),
        high: statistic.high.map(|high| high * factor),
    }
}

/// Diameter (as the curve gives it) below which `percent` of a curve of (size, percent) rows lies.
pub fn size_at(rows: &[[f64; 2]], percent: f64) -> Option<f64> {
    if let Some(first) = rows.first().filter(|row| row[1] >= percent) {
        return Some(first[0]);
    }
    let pair = rows
        .windows(2)
        .find(|pair| pair[0][1] <= percent && pair[1][1] >= percent && pair[1][1] > pair[0][1])?;
    let share = (percent - pair[0][1]) / (pair[1][1] - pair[0][1]);
    Some(pair[0][0] + share * (pair[1][0] - pair[0][0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_between_rows() {
        let rows = [[1.0, 0.0], [2.0, 50.0], [4.0, 100.0]];
        assert_eq!(
            [0.0, 25.0, 50.0, 75.0, 100.0].map(|p| size_at(&rows, p).unwrap()),
            [1.0, 1.5, 2.0, 3.0, 4.0]
        );
        assert_eq!(size_at(&rows[..2], 75.0), None);
    }
}
