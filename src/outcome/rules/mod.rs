//! The rules of filter practice, applied to the same two curves and shown beside the verdict.
//!
//! One rule is one entry of [`RULES`]: what it is for, where it applies, its limit and its source. A rule
//! that lacks an input says what it needs; one that was not made for these soils has no result.

mod base;
mod drainage;
mod retention;
mod rule;
mod stability;
mod walk;

pub use base::{BaseSoil, FEW_FINES};
pub use rule::{FilterRule, Fines, Judged, RuleInputs, RuleUnit};

use super::applied::{AppliedRule, RuleRole};

/// Fell et al., who give Table 9.2.
const FELL: &str = "Fell, MacGregor, Stapledon & Bell, Geotechnical Engineering of Dams, Table 9.2 (after \
                    Foster 1999; Foster & Fell 2001)";

/// Where the stability rules are stated.
const INTERNAL_STABILITY: &str = "U.S. Army Corps of Engineers, Internal Instability Toolbox manual \
                                  (RMC-CPD-2023-10), after Li and Fannin (2008)";

/// Every rule, in the order of a reader.
pub const RULES: [FilterRule; 14] = [
    FilterRule {
        id: "sherard-dunnigan",
        name: "Sherard and Dunnigan: the filter retains the base (design)",
        role: RuleRole::Retention,
        applies_to: "design of filters; the limit follows from the fines A of the regraded base (NRCS, USBR, \
                     FEMA); not dispersive clays",
        quantity: "D15F",
        formula: "A > 85 %: 9 D85B, not less than 0.2 mm; A 40 to 85 %: 0.7 mm; A 15 to 40 %: (40 - A)/25 (4 \
                  D85B - 0.7) + 0.7 mm; A < 15 %: 4 D85B",
        at_least: false,
        unit: RuleUnit::Size,
        source: "Sherard & Dunnigan (1989), as given by Fell et al., Geotechnical Engineering of Dams, Table \
                 9.2; the 0.2 mm: NRCS, National Engineering Handbook 633, chapter 26 (2017)",
        judge: retention::sherard_dunnigan,
    },
    FilterRule {
        id: "foster-fell-no-erosion",
        name: "Foster and Fell: no erosion rather than some",
        role: RuleRole::Retention,
        applies_to: "filters of existing dams: the boundary seen in tests, without a margin of safety; not \
                     dispersive clays",
        quantity: "D15F",
        formula: "A > 85 %: 9 D85B; A 35 to 85 %: 0.7 mm; A 15 to 35 %: 1.6 ((35 - A)/20 (4 D85B - 0.7) + \
                  0.7 mm); A < 15 %: 7 D85B",
        at_least: false,
        unit: RuleUnit::Size,
        source: FELL,
        judge: retention::no_erosion,
    },
    FilterRule {
        id: "foster-fell-excessive",
        name: "Foster and Fell: some erosion rather than excessive",
        role: RuleRole::Continuation,
        applies_to: "filters of existing dams",
        quantity: "D15F",
        formula: "",
        at_least: false,
        unit: RuleUnit::Size,
        source: "Foster and Fell (2001); Fell et al. (2008); in figures of the Filter Evaluation manual of \
                 the U.S. Army Corps of Engineers",
        judge: retention::excessive,
    },
    FilterRule {
        id: "foster-fell-continuing",
        name: "Foster and Fell: some erosion rather than continuing",
        role: RuleRole::Continuation,
        applies_to: "existing dams with filters coarser than modern rules allow; D95B after regrading",
        quantity: "D15F",
        formula: "9 D95B",
        at_least: false,
        unit: RuleUnit::Size,
        source: "Foster and Fell, as stated by Shire & O'Sullivan, section 2; regraded base: U.S. Army Corps \
                 of Engineers, Filter Evaluation manual, chapter Foster and Fell",
        judge: retention::continuing,
    },
    FilterRule {
        id: "terzaghi",
        name: "Terzaghi: the filter retains the base",
        role: RuleRole::Retention,
        applies_to: "bases with less than 15 % fines; D85B after regrading",
        quantity: "D15F/D85B",
        formula: "4",
        at_least: false,
        unit: RuleUnit::One,
        source: "Terzaghi, as stated by Shire & O'Sullivan, section 2",
        judge: retention::terzaghi,
    },
    FilterRule {
        id: "permeability",
        name: "Permeability: the filter drains the base",
        role: RuleRole::Drainage,
        applies_to: "design of filters; D15B before regrading",
        quantity: "D15F",
        formula: "5 D15B, and not less than 0.1 mm (older manuals: 3 to 5 D15B)",
        at_least: true,
        unit: RuleUnit::Size,
        source: "U.S. Army Corps of Engineers, Filter Evaluation manual, chapter Permeability, which cites \
                 USBR (2011), NRCS (2017) and EM 1110-2-1901",
        judge: drainage::permeability,
    },
    FilterRule {
        id: "filter-fines",
        name: "The filter has few fines",
        role: RuleRole::Drainage,
        applies_to: "design of filters; that they are not plastic is not seen from a sieve curve",
        quantity: "finer than 0.075 mm",
        formula: "5 %",
        at_least: false,
        unit: RuleUnit::Percent,
        source: "IS 11568 (1986), as summarised at infralens.in",
        judge: drainage::fines,
    },
    FilterRule {
        id: "filter-greatest-size",
        name: "The filter has no cobbles",
        role: RuleRole::Drainage,
        applies_to: "design of filters: coarse grains segregate",
        quantity: "D100F",
        formula: "75 mm",
        at_least: false,
        unit: RuleUnit::Size,
        source: "IS 11568 (1986), as summarised at infralens.in",
        judge: drainage::greatest_size,
    },
    FilterRule {
        id: "kezdi",
        name: "Kézdi (1979): the filter holds its own fines",
        role: RuleRole::Stability,
        applies_to: "the filter alone: internal stability",
        quantity: "greatest D'15/d'85 of the filter",
        formula: "4",
        at_least: false,
        unit: RuleUnit::One,
        source: INTERNAL_STABILITY,
        judge: stability::kezdi,
    },
    FilterRule {
        id: "kenney-lau",
        name: "Kenney and Lau (1986): the filter holds its own fines",
        role: RuleRole::Stability,
        applies_to: "the filter alone: internal stability, F up to 20 % (Cu > 3) or 30 %",
        quantity: "least H/F of the filter",
        formula: "1",
        at_least: true,
        unit: RuleUnit::One,
        source: INTERNAL_STABILITY,
        judge: stability::kenney_lau,
    },
    FilterRule {
        id: "li-fannin",
        name: "Li and Fannin (2008): the filter holds its own fines",
        role: RuleRole::Stability,
        applies_to: "the filter alone: internal stability; Kenney and Lau to F = 15 %, Kézdi from there",
        quantity: "least H/min(F, 15 %) of the filter",
        formula: "1",
        at_least: true,
        unit: RuleUnit::One,
        source: INTERNAL_STABILITY,
        judge: stability::li_fannin,
    },
    FilterRule {
        id: "kenney-controlling",
        name: "Kenney et al.: controlling constriction size Dc* ≤ D15F/5",
        role: RuleRole::Walk,
        applies_to: "bases without cohesion; Dc* is the largest particle eroded in the first run",
        quantity: "largest eroded / D15F",
        formula: "1/5",
        at_least: false,
        unit: RuleUnit::One,
        source: "Kenney et al., as stated by Shire & O'Sullivan, section 2",
        judge: walk::largest_passing,
    },
    FilterRule {
        id: "paper-no-erosion",
        name: "Network model of the paper: no erosion rather than some",
        role: RuleRole::Walk,
        applies_to: "loose filters of Cu 1.5 and 3",
        quantity: "D15F/D85B",
        formula: "5",
        at_least: false,
        unit: RuleUnit::One,
        source: "Shire & O'Sullivan, section 6, Fig. 14(a)",
        judge: walk::paper_no_erosion,
    },
    FilterRule {
        id: "paper-continuing",
        name: "Network model of the paper: some erosion rather than continuing",
        role: RuleRole::Walk,
        applies_to: "filters of Cu 1.5 and 3",
        quantity: "D15F/D95B",
        formula: "4.7",
        at_least: false,
        unit: RuleUnit::One,
        source: "Shire & O'Sullivan, section 6, Fig. 15",
        judge: walk::paper_continuing,
    },
];

/// Applies every rule.
pub fn apply(inputs: &RuleInputs) -> Vec<AppliedRule> {
    RULES.iter().map(|rule| applied(rule, inputs)).collect()
}

/// One rule, applied.
fn applied(rule: &FilterRule, inputs: &RuleInputs) -> AppliedRule {
    let judged = (rule.judge)(inputs);
    let keeps = |(value, limit): (f64, f64)| if rule.at_least { value >= limit } else { value <= limit };
    let met = judged.met.or_else(|| judged.value.zip(judged.limit).map(keeps));
    AppliedRule {
        id: rule.id.into(),
        name: rule.name.into(),
        role: rule.role,
        applies: judged.applies,
        quantity: rule.quantity.into(),
        value: judged.value,
        limit: judged.limit,
        unit: match rule.unit {
            RuleUnit::Size if inputs.scale_free => "D0F".into(),
            RuleUnit::Size => "mm".into(),
            RuleUnit::One => String::new(),
            RuleUnit::Percent => "%".into(),
        },
        at_least: rule.at_least,
        met: met.filter(|_| judged.applies),
        needs: judged.needs,
        note: judged.note,
        applies_to: rule.applies_to.into(),
        formula: rule.formula.into(),
        source: rule.source.into(),
    }
}

#[cfg(test)]
mod tests;
