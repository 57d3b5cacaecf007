//! Empirical filter rules, applied to the same two curves and shown beside the verdict.
//!
//! Each rule stands with where it is published and what it was made for. A rule whose inputs the scene does
//! not give is listed with what it needs; one that was not made for this base is listed without a result.

use super::record::{AppliedRule, Ratios};
use crate::gradation::{Gradation, ShapeIndex};

/// Largest size of fines (mm).
const FINES_MM: f64 = 0.075;

/// Percent of fines up to which the paper states Foster and Fell's boundary.
const FEW_FINES: f64 = 15.0;

/// What the rules read.
pub struct RuleInputs<'a> {
    /// D15F over D85B and D95B.
    pub ratios: Ratios,
    /// The filter's sieve curve, where the scene gives one.
    pub filter_sieve: Option<&'a Gradation>,
    /// The base's gradation, where its sizes are in mm and not multiples of D0F.
    pub base_mm: Option<&'a Gradation>,
    /// Largest particle eroded in the first run over D15F, mean over replicates; `None` where nothing eroded.
    pub largest_eroded_over_d15f: Option<f64>,
}

/// The rules that the paper states, in its words and with its sources, and those of the filter's own
/// stability.
///
/// A rule that lacks an input, or was not made for this base, has no result; its note says why.
pub fn apply(inputs: &RuleInputs) -> Vec<AppliedRule> {
    let ratios = &inputs.ratios;
    let (d85, d95) = (Some(ratios.d15f_over_d85b), Some(ratios.d15f_over_d95b));
    vec![
        AppliedRule {
            name: "Terzaghi: the filter retains the base".into(),
            applies_to: "filters and bases in general".into(),
            ..at_most("D15F/D85B", d85, 4.0, "Terzaghi, as stated by Shire & O'Sullivan, section 2")
        },
        sherard_and_dunnigan(d85),
        foster_and_fell_some(d85, inputs.base_mm),
        AppliedRule {
            name: "Foster and Fell: some erosion rather than continuing".into(),
            applies_to: "existing dams whose filters are coarser than modern rules allow".into(),
            ..at_most("D15F/D95B", d95, 9.0, "Foster and Fell, as stated by Shire & O'Sullivan, section 2")
        },
        AppliedRule {
            name: "Kenney et al.: controlling constriction size Dc* ≤ D15F/5".into(),
            applies_to:
                "bases without cohesion; Dc* is the largest eroded particle, here that of the walk's \
                         first run"
                    .into(),
            note: match inputs.largest_eroded_over_d15f {
                Some(_) => "checks the walk against their tests, not the filter".into(),
                None => "nothing eroded in the first run".into(),
            },
            ..at_most(
                "largest eroded / D15F",
                inputs.largest_eroded_over_d15f,
                0.2,
                "Kenney et al., as stated by Shire & O'Sullivan, section 2",
            )
        },
        kezdi(inputs.filter_sieve),
        kenney_lau(inputs.filter_sieve),
        AppliedRule {
            name: "Network model of the paper: no erosion rather than some".into(),
            applies_to: "loose filters of Cu 1.5 and 3".into(),
            ..at_most("D15F/D85B", d85, 5.0, "Shire & O'Sullivan, section 6, Fig. 14(a)")
        },
        AppliedRule {
            name: "Network model of the paper: some erosion rather than continuing".into(),
            applies_to: "filters of Cu 1.5 and 3".into(),
            ..at_most("D15F/D95B", d95, 4.7, "Shire & O'Sullivan, section 6, Fig. 15")
        },
    ]
}

/// A rule that a quantity is at most a limit; its name is the caller's.
fn at_most(quantity: &str, value: Option<f64>, limit: f64, source: &str) -> AppliedRule {
    AppliedRule {
        name: String::new(),
        quantity: quantity.into(),
        value,
        limit: Some(limit),
        at_least: false,
        meets: value.map(|v| v <= limit),
        applies_to: String::new(),
        note: String::new(),
        source: source.into(),
    }
}

fn sherard_and_dunnigan(d15f_over_d85b: Option<f64>) -> AppliedRule {
    AppliedRule {
        name: "Sherard and Dunnigan: a limit of D15F/D85B that varies with the base".into(),
        quantity: "D15F/D85B".into(),
        value: d15f_over_d85b,
        limit: None,
        at_least: false,
        meets: None,
        applies_to: "design of filters, by the fines content of the base".into(),
        note: "the paper gives none of their limits, so none is applied".into(),
        source: "Sherard and Dunnigan, as stated by Shire & O'Sullivan, section 2".into(),
    }
}

fn foster_and_fell_some(d15f_over_d85b: Option<f64>, base_mm: Option<&Gradation>) -> AppliedRule {
    let rule = AppliedRule {
        name: "Foster and Fell: no erosion rather than some".into(),
        applies_to: "bases with less than 15 % cohesive fines".into(),
        ..at_most(
            "D15F/D85B",
            d15f_over_d85b,
            7.0,
            "Foster and Fell, as stated by Shire & O'Sullivan, section 2",
        )
    };
    let Some(base) = base_mm else {
        return AppliedRule {
            note: "sizes are multiples of D0F: the fines of the base are not known".into(),
            ..rule
        };
    };
    if base.smallest_mm() > FINES_MM && base.pan_fraction() > 0.0 {
        let note = format!(
            "whether the base has less than 15 % fines is not known: its finest sieve is {} mm",
            base.smallest_mm()
        );
        return AppliedRule { note, ..rule };
    }
    let fines = base.percent_finer_by_mass(FINES_MM);
    match fines < FEW_FINES {
        true => rule,
        false => {
            let note = format!("not made for this base: {fines:.0} % of it is finer than 0.075 mm");
            AppliedRule { meets: None, note, ..rule }
        }
    }
}

/// Where both stability rules are stated.
const INTERNAL_STABILITY: &str = "U.S. Army Corps of Engineers, Internal Instability Toolbox manual \
                                  (RMC-CPD-2023-10), after Li and Fannin (2008)";

fn kezdi(filter: Option<&Gradation>) -> AppliedRule {
    let found = filter.map(|f| f.kezdi());
    AppliedRule {
        name: "Kézdi (1979): the filter holds its own fines".into(),
        applies_to: "the filter alone: internal stability".into(),
        note: note_of(found, "split"),
        ..at_most(
            "greatest D'15/d'85 of the filter",
            found.flatten().map(|i| i.value),
            4.0,
            INTERNAL_STABILITY,
        )
    }
}

fn kenney_lau(filter: Option<&Gradation>) -> AppliedRule {
    let found = filter.map(|f| f.kenney_lau());
    let value = found.flatten().map(|i| i.value);
    let upto =
        filter.and_then(|f| f.loose_percent()).map_or("20 % (Cu > 3) or 30 %".into(), |p| format!("{p} %"));
    AppliedRule {
        name: "Kenney and Lau (1986): the filter holds its own fines".into(),
        quantity: "least H/F of the filter".into(),
        value,
        limit: Some(1.0),
        at_least: true,
        meets: value.map(|v| v >= 1.0),
        applies_to: format!("the filter alone: internal stability, F up to {upto}"),
        note: note_of(found, "F"),
        source: INTERNAL_STABILITY.into(),
    }
}

/// What a reader must know of a shape index: missing inputs, or where it is.
fn note_of(found: Option<Option<ShapeIndex>>, what: &str) -> String {
    match found {
        None => "needs the filter's sieve curve".into(),
        Some(None) => {
            "needs finer sieves, or filter.d0_mm: too much of the filter is finer than its finest sieve"
                .into()
        }
        Some(Some(index)) => format!("at {what} = {:.0} %", index.percent),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(filter: Option<&Gradation>, base: Option<&Gradation>) -> Vec<AppliedRule> {
        let ratios = Ratios { d15f_over_d85b: 5.5, d15f_over_d95b: 4.5 };
        let largest_eroded_over_d15f = Some(0.19);
        apply(&RuleInputs { ratios, filter_sieve: filter, base_mm: base, largest_eroded_over_d15f })
    }

    fn find<'a>(rules: &'a [AppliedRule], name: &str) -> &'a AppliedRule {
        rules.iter().find(|r| r.name.starts_with(name)).unwrap()
    }

    #[test]
    fn limits_are_those_of_the_paper() {
        let all = rules(None, None);
        let of = |name: &str| {
            let rule = find(&all, name);
            (rule.value, rule.limit, rule.meets)
        };
        assert_eq!(of("Terzaghi"), (Some(5.5), Some(4.0), Some(false)));
        assert_eq!(of("Foster and Fell: no"), (Some(5.5), Some(7.0), Some(true)));
        assert_eq!(of("Foster and Fell: some"), (Some(4.5), Some(9.0), Some(true)));
        assert_eq!(of("Kenney et al."), (Some(0.19), Some(0.2), Some(true)));
        assert_eq!(of("Sherard"), (Some(5.5), None, None));
        assert_eq!(of("Network model of the paper: no"), (Some(5.5), Some(5.0), Some(false)));
        assert_eq!(of("Network model of the paper: some"), (Some(4.5), Some(4.7), Some(true)));
        assert!(all.iter().all(|r| !r.source.is_empty() && !r.applies_to.is_empty()));
    }

    #[test]
    fn a_missing_sieve_curve_is_asked_for() {
        let all = rules(None, None);
        for name in ["Kézdi", "Kenney and Lau"] {
            let rule = find(&all, name);
            assert_eq!(
                (rule.value, rule.meets, rule.note.as_str()),
                (None, None, "needs the filter's sieve curve")
            );
        }
        let gap =
            Gradation::from_points(&[(0.1, 0.0), (0.2, 15.0), (4.0, 15.0), (20.0, 100.0)], None).unwrap();
        let all = rules(Some(&gap), None);
        assert_eq!(
            (find(&all, "Kézdi").meets, find(&all, "Kenney and Lau").meets),
            (Some(false), Some(false))
        );
        let uniform = Gradation::from_points(&[(1.0, 0.0), (4.0, 100.0)], None).unwrap();
        let all = rules(Some(&uniform), None);
        let both = ["Kézdi", "Kenney and Lau"].map(|name| find(&all, name).meets);
        assert_eq!(both, [Some(true), Some(true)]);
        let hidden = Gradation::from_points(&[(1.0, 90.0), (4.0, 100.0)], None).unwrap();
        assert!(find(&rules(Some(&hidden), None), "Kézdi").note.contains("finest sieve"));
    }

    #[test]
    fn a_rule_that_was_not_made_for_the_base_has_no_result() {
        let of = |points: &[(f64, f64)]| {
            let base = Gradation::from_points(points, None).unwrap();
            let rule = find(&rules(None, Some(&base)), "Foster and Fell: no").clone();
            (rule.meets, rule.note)
        };
        assert_eq!(of(&[(0.1, 0.0), (1.0, 100.0)]), (Some(true), String::new()));
        let (meets, note) = of(&[(0.01, 0.0), (0.075, 40.0), (1.0, 100.0)]);
        assert!(meets.is_none() && note.contains("40 % of it is finer"), "{note}");
        assert!(of(&[(0.2, 10.0), (1.0, 100.0)]).1.contains("not known: its finest sieve is 0.2 mm"));
    }
}
