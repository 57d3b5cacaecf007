//! Empirical filter rules, applied to the same two curves and shown beside the verdict.

use super::record::{Ratios, Rule};

/// The rules that the paper states, in its words and with its sources.
pub fn beside_the_verdict(ratios: &Ratios) -> Vec<Rule> {
    let rule = |name: &str, quantity: &str, value: f64, limit: f64, source: &str| Rule {
        name: name.into(),
        quantity: quantity.into(),
        value,
        limit,
        meets: value <= limit,
        source: source.into(),
    };
    vec![
        rule(
            "Terzaghi: the filter retains the base",
            "D15F/D85B",
            ratios.d15f_over_d85b,
            4.0,
            "Terzaghi's rule as stated by Shire & O'Sullivan, section 2, after Terzaghi",
        ),
        rule(
            "Foster and Fell: no erosion rather than some (base with less than 15 % fines)",
            "D15F/D85B",
            ratios.d15f_over_d85b,
            7.0,
            "Foster and Fell as stated by Shire & O'Sullivan, section 2",
        ),
        rule(
            "Foster and Fell: some erosion rather than continuing",
            "D15F/D95B",
            ratios.d15f_over_d95b,
            9.0,
            "Foster and Fell as stated by Shire & O'Sullivan, section 2",
        ),
        rule(
            "Network model of the paper: no erosion rather than some (loose filters)",
            "D15F/D85B",
            ratios.d15f_over_d85b,
            5.0,
            "Shire & O'Sullivan, section 6, Fig. 14(a)",
        ),
        rule(
            "Network model of the paper: some erosion rather than continuing",
            "D15F/D95B",
            ratios.d15f_over_d95b,
            4.7,
            "Shire & O'Sullivan, section 6, Fig. 15",
        ),
    ]
}
