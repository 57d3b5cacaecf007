//! A row at one ratio, as what knows millimetres judges it.

use super::row::Row;
use crate::case::{Case, StatedBase};
use crate::outcome::record::{AppliedRule, FindingRecord};
use crate::outcome::rules::{BaseSoil, RuleInputs, apply};
use crate::run::error::RunError;
use crate::scene::{Amount, BaseGradation, D85};
use crate::verdict::{Finding, finding, ordered};

/// Fewer networks than these give no percentiles.
const FEW_NETWORKS: u64 = 5;

/// A base coarser than this (D85, mm) is worth a word.
const COARSE_BASE_MM: f64 = 10.0;

/// What the search itself finds of a row: a band over so few networks says little, a number of base particles
/// may not be that of Eq. (2) at every ratio, and a base that is regraded and then scaled is not the one that
/// practice regrades in that size.
fn of_search(row: &Row) -> Vec<Finding> {
    let networks = row.case.scene.walk.replicates;
    let few = (networks < FEW_NETWORKS).then(|| finding::few_networks(networks));
    let recut = row.stated.regraded_from.as_ref().filter(|_| row.inverse);
    let recut = recut.map(|(_, at)| finding::regraded_elsewhere(*at));
    few.into_iter().chain(of_amount(row)).chain(recut).collect()
}

fn of_amount(row: &Row) -> Option<Finding> {
    match row.case.scene.base.amount() {
        Amount::Number(n) | Amount::MassRatio(_, Some(n)) => Some(finding::amount_held(n)),
        Amount::MassRatio(_, None) => None,
    }
}

/// A row at one ratio, as what knows millimetres judges it.
pub(super) struct Judged {
    /// The case with the sizes that filter and base have there; without a unit, that of D85B = 1.
    pub case: Case,
    has_size: bool,
    /// D85B (mm).
    d85_mm: Option<f64>,
    /// The base that was stated.
    pub base_name: String,
    /// Thickness of the real filter (mm), where nothing here has a size to compare it with.
    real_thickness: Option<f64>,
}

impl Judged {
    pub fn new(row: &Row, ratio: f64) -> Result<Self, RunError> {
        let has_size = row.has_size();
        let d85 = match (has_size, row.inverse) {
            (true, false) => row.d85_mm.unwrap_or(1.0),
            (true, true) => row.d15f() / ratio,
            (false, _) => 1.0,
        };
        let scaled = |stated: &StatedBase| -> Result<StatedBase, RunError> {
            let factor = d85 / row.stated.gradation.d(85.0).unwrap_or(d85);
            let sizes = |gradation: &crate::gradation::Gradation| {
                gradation.scaled(factor).map_err(crate::case::CaseError::from)
            };
            let regraded_from = match &stated.regraded_from {
                Some((given, at)) => Some((sizes(given)?, at * factor)),
                None => None,
            };
            Ok(StatedBase { gradation: sizes(&stated.gradation)?, regraded_from, ..stated.clone() })
        };
        let stated = if has_size && !row.inverse { row.stated.clone() } else { scaled(&row.stated)? };
        let mut case = row.case.enlarged(ratio * d85 / row.d15f(), &stated)?;
        if let Ok(walked) = row.at(ratio) {
            case.counts = walked.counts;
            (case.n_base, case.n_base_eq2, case.capped) = (walked.n_base, walked.n_base_eq2, walked.capped);
        }
        let base_name = case.record().base.name;
        let mut real_thickness = None;
        if !has_size {
            real_thickness = case.scene.filter.thickness_mm.take();
            // As multiples of a size that is not known, neither soil has fines.
            (case.scene.filter.d0_mm, case.scene.base) = (Some(1.0), row.case.scene.base.clone());
        } else if let BaseGradation::Linear { d85: D85::AtDc(..) | D85::Ratio(_), .. } =
            case.scene.base.gradation()
        {
            // The filter's size says the base's.
            let of = &mut case.scene.base;
            (of.d85_mm, of.d85_at_dc, of.dc_curve, of.d15f_over_d85b) = (Some(d85), None, None, None);
        }
        Ok(Self { case, has_size, d85_mm: has_size.then_some(d85), base_name, real_thickness })
    }

    pub fn unit(&self) -> &'static str {
        if self.has_size { "mm" } else { "D85B" }
    }

    pub fn rules(&self) -> Vec<AppliedRule> {
        let (case, scale_free) = (&self.case, !self.has_size);
        let inputs = RuleInputs {
            filter: &case.filter,
            filter_is_measured: case.filter_is_measured(),
            base: case.base_as_given(),
            walked_base: &case.base,
            base_soil: BaseSoil::of(case.base_as_given(), scale_free),
            scale_free,
            filter_curves: Vec::new(),
            dispersive: case.scene.base.dispersive == Some(true),
            joint_mm: case.scene.filter.joint_mm,
            largest_eroded_over_d15f: None,
        };
        let mut rules = apply(&inputs);
        for rule in rules.iter_mut().filter(|rule| rule.unit == "D0F") {
            rule.unit = "D85B".into();
        }
        rules
    }

    /// What a reader must know besides, with what else was found.
    pub fn findings(&self, row: &Row, rules: &[AppliedRule], others: Vec<Finding>) -> Vec<FindingRecord> {
        // Said of every ratio below.
        let of_one = self.case.too_little_base().filter(|_| of_amount(row).is_some());
        let coarse = self.d85_mm.filter(|d85| *d85 > COARSE_BASE_MM).map(finding::coarse_base);
        let not_compared = self.real_thickness.map(|real| finding::thickness_without_unit(real, self.unit()));
        let of_case = self.case.findings().into_iter();
        let found = of_case.filter(|finding| Some(finding) != of_one.as_ref());
        let found = found
            .chain(self.case.unchecked_clogging())
            .chain(coarse)
            .chain(not_compared)
            .chain(of_search(row))
            .chain(others);
        ordered(rules, found.collect())
    }
}
