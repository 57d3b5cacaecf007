//! Many samples of a base against filters: one row for each pair with the answer of practice, and the
//! governing samples.

use super::pair::{Mistake, PairOptions, PairRules};
use super::rule_result::credit;
use crate::applied::d15f_between;
use crate::design::Specification;
use crate::design::specification::{NoBand, SizeBand};
use crate::retention::retaining;
use crate::rules::{CONSTRICTED_EXIT, DESIGN, NamedCurve, OpenBase, PERMEABILITY, sieved_limit};
use crate::{
    AppliedRule, IfDispersive, InputFile, Note, PracticeClass, RuleNote, RuleQuantity, RuleRole, SheetCover,
    TestedClass,
};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::path::PathBuf;
use voidwalk_sheets::SoilSample;

/// Number of governing samples named for a full walk.
pub const NAMED: usize = 3;

/// Answer of practice for one sample and one filter. Sizes are in mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct BatchRow {
    /// Name of the sample.
    pub sample: String,
    /// Path of the sample on a command line.
    pub path: PathBuf,
    /// Name of the filter.
    pub filter: String,
    /// ASTM D2487 group of the sample; `None` if the sieves do not give it.
    pub group: Option<String>,
    /// NRCS category, 1 to 4; `None` if the fines are not known closely enough.
    pub category: Option<u8>,
    /// Percent finer than 0.075 mm after regrading.
    pub fines_percent: Option<f64>,
    /// Size on which the sample was regraded.
    pub regraded_at_mm: Option<f64>,
    /// D85 after regrading.
    pub d85b_mm: Option<f64>,
    /// D15 of the filter, of its coarsest curve; `None` if the sieves leave it open and the result
    /// depends on it.
    pub d15f_mm: Option<f64>,
    /// Strictest limit of D15F for retention of the sample; its lower bound if sieves of the sample are
    /// widely spaced.
    pub limit_mm: Option<f64>,
    /// True if the limit is not known exactly and is at most `limit_mm`.
    pub limit_at_most: bool,
    /// Author of the limit.
    pub rule: String,
    /// True if the filter keeps every rule of retention, as placed and without the finer part that it may
    /// lose; `None` if this is not known.
    pub met: Option<bool>,
    /// Class by the boundaries of Foster and Fell.
    pub tests: TestedClass,
    /// True if the filter is coarser than any for which their tests found no erosion.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_beyond_tests: bool,
    /// True if the filter keeps every rule of drainage; `None` if this is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drains: Option<bool>,
    /// Minimum D15F that drains the sample.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub d15f_min_mm: Option<f64>,
    /// True if the minimum is not known exactly and is at most `d15f_min_mm`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub d15f_min_at_most: bool,
    /// Warnings about the two tables.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
    /// Two widely spaced sieves that leave the result open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub open_sieves: Option<RuleNote>,
    /// Finer part of the filter (%) that it may lose, and without which it is too coarse.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub too_coarse_without_percent: Option<f64>,
    /// True if the filter may segregate.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub may_segregate: bool,
    /// True if a rule of drainage was applied.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_drainage_judged: bool,
    /// Result for an open joint, if one was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<JointErosion>,
    /// True if the filter may lose its own fines.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub may_lose_fines: bool,
    /// Limit if the sample is dispersive, for a sample with enough fines and no statement about dispersion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// True if the limit is met but would be broken by a dispersive base, and dispersion is not stated.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub breaks_if_dispersive: bool,
    /// True if the two tables look exchanged and no rule was applied.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_refused: bool,
}

/// Continuing erosion into an open joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct JointErosion {
    /// Probability (%); `None` if it is not known, or below the smallest that the source states.
    pub percent: Option<f64>,
    /// True if it is below the smallest probability that the source states.
    pub is_below_source: bool,
}

impl BatchRow {
    /// True if the limit is not known or is only an upper bound.
    pub fn limit_is_open(&self) -> bool {
        self.limit_mm.is_none() || self.limit_at_most
    }

    /// Applies practice to one sample and one filter. A pair that looks exchanged has no result unless
    /// `options` says it is as given.
    ///
    /// ```
    /// use voidwalk_core::Gradation;
    /// use voidwalk_sheets::SoilSample;
    /// use voidwalk_practice::{BatchRow, PairOptions};
    /// let filter = Gradation::from_lines(&[(0.5, 0.0), (2.0, 100.0)])?;
    /// let curve = Gradation::from_lines(&[(0.08, 0.0), (0.3, 100.0)])?;
    /// let sample = SoilSample { name: "S".into(), path: "site.csv#S".into(), curve };
    /// let filter = vec![("F".to_owned(), filter)];
    /// let row = BatchRow::of(&sample, ("F", &filter), PairOptions::default());
    /// assert_eq!((row.met, row.category, row.rule.as_str()), (Some(true), Some(4), "Sherard and Dunnigan"));
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    ///
    /// # Panics
    /// The filter has no curve.
    pub fn of(sample: &SoilSample, (filter, curves): (&str, &[NamedCurve]), options: PairOptions) -> Self {
        let base = &sample.curve;
        let bases = [(sample.name.clone(), base.clone())];
        let mistake = Mistake::of_envelopes(&bases, curves);
        let pair = PairRules::with_mistake(&bases, curves, options, mistake.as_ref());
        let row = Self {
            sample: sample.name.clone(),
            path: sample.path.clone(),
            filter: filter.into(),
            group: base.group(),
            category: pair.base.category,
            fines_percent: pair.base.fines_percent,
            regraded_at_mm: pair.base.regraded_at_mm,
            d85b_mm: pair.base.d85_mm,
            d15f_mm: pair.filter.d15_mm,
            is_refused: mistake.as_ref().is_some_and(|mistake| mistake.is_refused() && !options.as_given),
            notes: mistake.map(|mistake| mistake.note).into_iter().collect(),
            ..Self::default()
        };
        if row.is_refused {
            return row;
        }
        let (rules, decision) = (&pair.rules, pair.decision());
        let strictest = decision.strictest().map(|(rule, limit)| (rule, limit, rule.limit_at_most));
        let is_open = base.open_steps().into_iter().any(|step| step.is_wide());
        let open_base = is_open.then(|| OpenBase::of(base, false));
        // The strictest limit over all readings of the base between widely spaced sieves.
        let strictest_by_sieves = |rule: &AppliedRule| {
            let limit = sieved_limit(&rule.id, base, open_base.as_ref()?, options.dispersive)?;
            limit.depends_on.map(|_| limit.strictest)
        };
        let of_d15f = |rule: &&AppliedRule| rule.applies && rule.quantity == RuleQuantity::D15F;
        let least = retaining(rules).filter(of_d15f);
        let least = least.filter_map(|rule| Some((rule, strictest_by_sieves(rule)?, false)));
        let strictest = strictest.into_iter().chain(least).min_by(|a, b| a.1.total_cmp(&b.1));
        let is_size = |rule: &&AppliedRule| rule.applies && rule.quantity != RuleQuantity::D15FOverD85B;
        let judged = decision.applied(DESIGN).and_then(|rule| rule.value).or(row.d15f_mm);
        // The remainder of a filter that may lose its own fines is unknown, as on the page of the pair.
        let unknown = decision.standing.class() == PracticeClass::NotKnown
            || retaining(rules).filter(is_size).any(|rule| rule.met.is_none());
        let fails = decision.breaks(RuleRole::Retention)
            || decision.breaks(RuleRole::Continuation)
            || decision.washout.is_some();
        let met = if fails { Some(false) } else { (!unknown && strictest.is_some()).then_some(true) };
        let drainage = decision.applied(PERMEABILITY);
        let breaks = decision.breaks(RuleRole::Drainage);
        let drains = if breaks { Some(false) } else { drainage.and_then(|rule| rule.met) };
        let greatest = drainage.and_then(strictest_by_sieves);
        let leaves_d15f_open = |rule: &AppliedRule| rule.met.is_none() && d15f_between(&rule.needs).is_some();
        let joint = |rule: &AppliedRule| JointErosion {
            percent: rule.value,
            is_below_source: rule.value.is_none() && rule.needs.is_empty(),
        };
        Self {
            d15f_mm: judged.filter(|_| met.is_some() || !rules.iter().any(leaves_d15f_open)),
            limit_mm: strictest.map(|(_, limit, _)| limit),
            limit_at_most: strictest.is_some_and(|(.., at_most)| at_most),
            rule: strictest.map_or(String::new(), |(rule, limit, _)| whose(rules, rule, limit)),
            met,
            tests: decision.tests,
            is_beyond_tests: decision.is_beyond_tests,
            drains,
            d15f_min_mm: greatest.or(drainage.and_then(|rule| rule.limit)),
            d15f_min_at_most: greatest.is_none() && drainage.is_some_and(|rule| rule.limit_at_most),
            open_sieves: decision.open_sieves.filter(|_| met.is_none()),
            too_coarse_without_percent: decision.washout.as_ref().map(|washout| washout.left.percent),
            may_segregate: decision.breaks(RuleRole::Placing),
            is_drainage_judged: drainage.is_some(),
            joint: decision.applied(CONSTRICTED_EXIT).map(joint),
            if_dispersive: pair.if_dispersive,
            may_lose_fines: decision.breaks(RuleRole::Stability),
            breaks_if_dispersive: met == Some(true) && decision.beyond_dispersive.is_some(),
            ..row
        }
    }
}

/// Author of the limit; the first rule counts if limits are equal, such as design and Terzaghi for a
/// clean sand.
fn whose(rules: &[AppliedRule], strictest: &AppliedRule, limit: f64) -> String {
    let is_same = |rule: &&AppliedRule| {
        let is_limit = rule.limit.is_some_and(|of_rule| (of_rule - limit).abs() <= 1e-9 * limit);
        rule.role == RuleRole::Retention && rule.applies && rule.quantity == RuleQuantity::D15F && is_limit
    };
    credit(rules.iter().find(is_same).unwrap_or(strictest)).to_owned()
}

/// Samples that govern a filter, strictest first: at most `most` of those with the lowest limit. Equal
/// limits are ordered by D85B, smallest first.
pub fn governing<'r>(rows: &'r [BatchRow], filter: &str, most: usize) -> Vec<&'r BatchRow> {
    let has_limit = |row: &&BatchRow| row.filter == filter && row.limit_mm.is_some();
    let mut limits: Vec<&BatchRow> = rows.iter().filter(has_limit).collect();
    limits.sort_by(|a, b| strictest_first([a.limit_mm, a.d85b_mm], [b.limit_mm, b.d85b_mm]));
    limits.truncate(most);
    limits
}

/// Order by the limit, and by D85B among equal limits; unknown sizes come last.
fn strictest_first(a: [Option<f64>; 2], b: [Option<f64>; 2]) -> Ordering {
    let [a, b] = [a, b].map(|sizes| sizes.map(|mm| mm.unwrap_or(f64::INFINITY)));
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

/// Number of further samples whose limit equals the last governing one.
pub fn more_with_that_limit(rows: &[BatchRow], filter: &str, named: &[&BatchRow]) -> usize {
    let Some(limit) = named.last().and_then(|row| row.limit_mm) else { return 0 };
    let is_same = |row: &&BatchRow| {
        row.filter == filter
            && row.limit_mm.is_some_and(|row_limit| (row_limit - limit).abs() <= 1e-9 * limit)
    };
    let of_named = named.iter().copied().filter(is_same).count();
    rows.iter().filter(is_same).count() - of_named
}

/// Samples of a filter whose limit is unknown or only bounded above: any of them may govern. Excludes
/// samples named as governing and samples that look exchanged with the filter.
pub fn may_govern<'r>(rows: &'r [BatchRow], filter: &str) -> Vec<&'r BatchRow> {
    let named = governing(rows, filter, NAMED);
    let is_named = |row: &BatchRow| named.iter().any(|other| std::ptr::eq(*other, row));
    let is_open =
        |row: &&BatchRow| row.filter == filter && row.limit_is_open() && !row.is_refused && !is_named(row);
    rows.iter().filter(is_open).collect()
}

/// Filter of a batch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct BatchFilter {
    /// Name of the filter as given and as used in the rows.
    pub name: String,
    /// Names of its curves; several form an envelope.
    pub curves: Vec<String>,
    /// D15F (mm) of its coarsest curve; `None` if the table does not reach it.
    pub d15f_mm: Option<f64>,
    /// Each curve: rows of (size in mm, percent finer by mass), sizes ascending.
    pub gradations: Vec<Vec<[f64; 2]>>,
}

/// Answers of practice for every filter and sample, grouped by filter.
#[derive(Clone, Debug)]
pub struct BatchTable {
    /// One row for each filter and sample.
    pub rows: Vec<BatchRow>,
    /// Filters of the batch.
    pub filters: Vec<BatchFilter>,
    /// Curve of the base as sampled, in rows of (size in mm, percent finer by mass); empty if there are
    /// several samples.
    pub base: Vec<[f64; 2]>,
    /// Assumptions about the files, one sentence each.
    pub notes: Vec<String>,
}

impl BatchTable {
    /// Builds the table of these samples and named filters, each with the curves of its envelope.
    pub fn new(
        samples: &[SoilSample],
        filters: Vec<(String, Vec<NamedCurve>)>,
        notes: Vec<String>,
        options: PairOptions,
    ) -> Self {
        let base = match samples {
            [sample] => sample.curve.rows(),
            _ => Vec::new(),
        };
        let mut table = Self { rows: Vec::new(), filters: Vec::new(), base, notes };
        for (name, curves) in filters {
            let rows = samples.iter().map(|sample| BatchRow::of(sample, (&name, &curves), options));
            let rows: Vec<BatchRow> = rows.collect();
            let d15f_mm = rows.iter().find_map(|row| row.d15f_mm);
            table.rows.extend(rows);
            let gradations = curves.iter().map(|(_, curve)| curve.rows()).collect();
            let curves = curves.into_iter().map(|(name, _)| name).collect();
            table.filters.push(BatchFilter { name, curves, d15f_mm, gradations });
        }
        table
    }
}

/// Contents of `designs.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct DesignedSamples {
    /// Version of the program.
    pub version: String,
    /// Commit that the program was built from; `None` if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Samples as named by the user.
    pub samples: String,
    /// True if the samples were stated to be dispersive.
    pub dispersive: bool,
    /// True if page and terminal show inches beside mm.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inches: bool,
    /// Cover of the sheet.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub cover: SheetCover,
    /// Files that were read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputFile>,
    /// One row for each sample.
    pub rows: Vec<DesignedSample>,
    /// Assumptions about the files, one sentence each.
    pub notes: Vec<String>,
}

/// Limits of a filter for one sample. Sizes are in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct DesignedSample {
    /// Name of the sample.
    pub sample: String,
    /// Path of the sample on a command line.
    pub path: PathBuf,
    /// Size (mm) and percent finer by mass, as sampled.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradation: Vec<[f64; 2]>,
    /// Size (mm) and percent finer by mass after regrading; empty if the rules do not regrade the sample.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regraded: Vec<[f64; 2]>,
    /// ASTM D2487 group; `None` if the sieves do not give it.
    pub group: Option<String>,
    /// NRCS category, 1 to 4; `None` if the fines are not known closely enough.
    pub category: Option<u8>,
    /// Percent finer than 0.075 mm after regrading.
    pub fines_percent: Option<f64>,
    /// Size on which the sample was regraded.
    pub regraded_at_mm: Option<f64>,
    /// D85 after regrading.
    pub d85b_mm: Option<f64>,
    /// Maximum D15F that retains the sample by practice; `None` if it is not known.
    pub d15f_max_mm: Option<f64>,
    /// Author of the maximum.
    pub rule: String,
    /// Minimum D15F that drains the sample.
    pub d15f_min_mm: Option<f64>,
    /// True if the minimum is not known exactly and is at most `d15f_min_mm`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub d15f_min_at_most: bool,
    /// Limit of practice if the sample is dispersive; `None` if dispersion is stated or the sample has
    /// few fines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// D15F of both sides of the specified band; `None` without a band.
    pub band_d15f_mm: Option<[f64; 2]>,
    /// Notes on the sample itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
    /// Reason why the sample has no band, though both limits may be known; `None` if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_band: Option<NoBand>,
    /// Rank by `d15f_max_mm`: 1 for the governing sample, 2 and 3 for the next.
    pub governs: Option<u64>,
}

impl DesignedSample {
    /// Records the answer of practice for a sample.
    pub fn of(sample: &SoilSample, practice: &Specification) -> Self {
        let curve = &practice.curves[0];
        Self {
            sample: sample.name.clone(),
            path: sample.path.clone(),
            gradation: curve.gradation.clone(),
            regraded: curve.regraded.clone(),
            group: sample.curve.group(),
            category: curve.category,
            fines_percent: curve.fines_percent,
            regraded_at_mm: curve.regraded_at_mm,
            d85b_mm: curve.d85_mm,
            d15f_max_mm: practice.d15f_max_mm,
            rule: curve.d15f_max_rule.clone(),
            d15f_min_mm: practice.d15f_min_mm,
            d15f_min_at_most: practice.d15f_min_at_most,
            if_dispersive: practice.if_dispersive,
            band_d15f_mm: practice.band.as_ref().map(SizeBand::d15_mm),
            notes: practice.notes.iter().map(|row| row.note.clone()).collect(),
            no_band: practice.no_band.clone(),
            governs: None,
        }
    }

    /// True if practice has a maximum D15F and a band for the sample.
    pub fn is_settled(&self) -> bool {
        self.d15f_max_mm.is_some() && self.no_band.is_none()
    }
}

impl DesignedSamples {
    /// Table of these rows with the governing samples: lowest maximum D15F first, and the finer base
    /// first if equal.
    pub fn new(samples: String, mut rows: Vec<DesignedSample>) -> Self {
        let mut order: Vec<usize> = (0..rows.len()).filter(|&at| rows[at].d15f_max_mm.is_some()).collect();
        let sizes = |at: usize| [rows[at].d15f_max_mm, rows[at].d85b_mm];
        order.sort_by(|&a, &b| strictest_first(sizes(a), sizes(b)));
        for (rank, &at) in (1..).zip(order.iter().take(NAMED)) {
            rows[at].governs = Some(rank);
        }
        Self { version: env!("CARGO_PKG_VERSION").into(), samples, rows, ..Self::default() }
    }

    /// Governing samples, strictest first.
    pub fn governing(&self) -> Vec<&DesignedSample> {
        let mut rows: Vec<&DesignedSample> = self.rows.iter().filter(|row| row.governs.is_some()).collect();
        rows.sort_by_key(|row| row.governs);
        rows
    }
}
