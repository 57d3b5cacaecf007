//! A row at one ratio, as what knows millimetres judges it.

use super::row::Row;
use crate::case::{Case, StatedBase};
use crate::outcome::confidence::{self, Judgement};
use crate::outcome::doubt::{Doubt, Way};
use crate::outcome::record::{AppliedRule, Confidence, Verdict};
use crate::outcome::rules::{BaseSoil, RuleInputs, apply};
use crate::run::error::RunError;
use crate::scene::{Amount, BaseGradation, D85};

/// Fewer networks than these give no percentiles.
const FEW_NETWORKS: u64 = 5;

/// A base coarser than this (D85, mm) is worth a word.
const COARSE_BASE_MM: f64 = 10.0;

/// How far a row can be relied on, why no further, and what else is to be said.
pub(super) type Said = (Confidence, Vec<String>, Vec<String>);

/// That a band over so few networks says little.
fn few_networks(row: &Row) -> Option<String> {
    let networks = row.case.scene.walk.replicates;
    let counted = if networks == 1 { "1 network".to_owned() } else { format!("{networks} networks") };
    (networks < FEW_NETWORKS).then(|| {
        format!(
            "only {counted}: a band of 5 to 95 % needs {FEW_NETWORKS} at least, better 20 \
             (--set replicates=20)"
        )
    })
}

/// That the number of base particles is not that of Eq. (2) at every ratio.
fn of_amount(row: &Row) -> Option<String> {
    let what = match row.case.scene.base.amount() {
        Amount::Number(n) => format!("base.n_base holds the number of base particles at {n}"),
        Amount::MassRatio(_, Some(cap)) => {
            format!("base.cap holds the number of base particles at {cap} or less")
        }
        Amount::MassRatio(_, None) => return None,
    };
    Some(format!(
        "{what}, which is not the base that Eq. (2) asks for at every ratio: where there is less, more \
         filters seem to hold"
    ))
}

/// That a base that is regraded and then scaled is not the one that practice regrades in that size.
fn recut(row: &Row) -> Option<String> {
    let (_, at) = row.stated.regraded_from.as_ref().filter(|_| row.inverse)?;
    Some(format!(
        "the base was regraded on {at:.3} mm in the size in which it is stated, and then scaled: practice \
         regrades the scaled base elsewhere, or not at all"
    ))
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
            (case.pan_size, case.counts) = (walked.pan_size, walked.counts);
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

    /// How far "no erosion" can be relied on, why no further, and what else is to be said.
    pub fn confidence(&self, row: &Row, rules: &[AppliedRule]) -> Said {
        // Said of every ratio below.
        let of_one = self.case.too_little_base().filter(|_| of_amount(row).is_some());
        let doubts = self.case.doubts().into_iter();
        let doubts = doubts.filter(|doubt| Some(&doubt.said) != of_one.as_ref());
        let coarse = self.d85_mm.filter(|d85| *d85 > COARSE_BASE_MM).map(|d85| {
            format!("the base's D85 is {d85:.1} mm: are its sizes micrometres under a header in mm?")
        });
        let not_compared = self.real_thickness.map(|real| Case::thickness_without_unit(real, self.unit()));
        let of_search = [not_compared, recut(row), few_networks(row), of_amount(row)].into_iter().flatten();
        let coarse = Doubt::all(Way::Open, coarse);
        let doubts = coarse.chain(doubts).chain(Doubt::all(Way::Open, of_search)).collect();
        let Judgement { confidence, reasons, notes } = confidence::judge(Verdict::None, rules, doubts);
        let is_new =
            |said: &String| !reasons.contains(said) && !notes.contains(said) && Some(said) != of_one.as_ref();
        let warnings: Vec<String> = self.case.warnings().into_iter().filter(is_new).collect();
        (confidence, reasons, notes.into_iter().chain(warnings).collect())
    }
}
