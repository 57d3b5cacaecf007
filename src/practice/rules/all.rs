//! The table of rules.

use super::rule::{FilterRule, Judged, Pairing, RuleInputs};
use super::{drainage, retention, stability};
use crate::{RuleQuantity, RuleRole, RuleUnit};
use voidwalk_core::gradation::Gradation;

/// Id of the rule by which new filters are specified.
pub const DESIGN: &str = "sherard-dunnigan";
/// Id of the boundary up to which tests saw no erosion.
pub const TESTS_NO_EROSION: &str = "foster-fell-no-erosion";
/// Id of the boundary from which tests saw continuing erosion.
pub const TESTS_CONTINUING: &str = "foster-fell-continuing";
/// Id of the probability of continuing erosion into an open joint.
pub(crate) const CONSTRICTED_EXIT: &str = "constricted-exit";
/// Id of the rule of drainage of the base.
pub const PERMEABILITY: &str = "permeability";
/// Id of the minimum D15F of an older manual.
pub const PERMEABILITY_LEAST: &str = "permeability-em-1901";
/// Id of the rule that limits the fines of a filter.
pub const FILTER_FINES: &str = "filter-fines";
/// Id of the rule that excludes cobbles from a filter.
pub const FILTER_GREATEST_SIZE: &str = "filter-greatest-size";
/// Id of Terzaghi's ratio.
pub const TERZAGHI: &str = "terzaghi";
/// Id of Kezdi's criterion of internal stability.
pub(crate) const KEZDI: &str = "kezdi";
/// Id of Kenney and Lau's criterion of internal stability.
pub(crate) const KENNEY_LAU: &str = "kenney-lau";
/// Id of Li and Fannin's criterion, which takes the milder of Kenney and Lau's and Kezdi's at every size.
pub(crate) const LI_FANNIN: &str = "li-fannin";

/// Publication with Table 9.2.
const FELL: &str = "Fell, MacGregor, Stapledon & Bell, Geotechnical Engineering of Dams, Table 9.2 (after \
                    Foster 1999; Foster & Fell 2001)";

/// Source of the stability rules.
const INTERNAL_STABILITY: &str = "U.S. Army Corps of Engineers, Internal Instability Toolbox manual \
                                  (RMC-CPD-2023-10), after Li and Fannin (2008)";

/// Source of numbers that no citable text confirms.
const OURS: &str = "a check of this program, as specifications of filters commonly have it; no text that can \
                    be cited was read for its number";

type Judge = fn(&RuleInputs) -> Judged;

/// Rule with a maximum D15F for every pair of curves, of no author; the table replaces what differs. Every
/// rule states how it judges and its source.
const fn pair(judge: Judge, source: &'static str) -> FilterRule {
    FilterRule {
        id: "",
        authority: "",
        stated_by: &[],
        says: "",
        role: RuleRole::Retention,
        applies_to: "",
        quantity: &RuleQuantity::D15F,
        formula: "",
        at_least: false,
        unit: RuleUnit::Mm,
        source,
        pairing: Pairing::EachPair,
        judge,
    }
}

/// Rule on every curve of the filter.
const fn filter(judge: Judge, source: &'static str) -> FilterRule {
    let (role, unit, pairing) = (RuleRole::Placing, RuleUnit::One, Pairing::EachFilter);
    FilterRule { role, unit, pairing, ..pair(judge, source) }
}

/// Rule of the filter's internal stability.
const fn stable(judge: Judge, source: &'static str) -> FilterRule {
    FilterRule {
        stated_by: &["USACE"],
        says: "internal stability of the filter",
        role: RuleRole::Stability,
        ..filter(judge, source)
    }
}

/// Comparison of the walk with tests, or of a pair with the walks of the paper.
const fn walk(judge: Judge, source: &'static str) -> FilterRule {
    FilterRule { role: RuleRole::Walk, unit: RuleUnit::One, ..pair(judge, source) }
}

/// All rules, in reading order.
pub const RULES: &[FilterRule] = &[
    FilterRule {
        id: DESIGN,
        authority: "Sherard and Dunnigan",
        stated_by: &["NRCS", "USBR", "USACE"],
        says: "the filter retains the base (design)",
        applies_to: "design of filters; the limit follows from the fines A of the regraded base (NRCS, USBR, \
                     FEMA)",
        formula: "A > 85 %: 9 D85B, not less than 0.2 mm; A 40 to 85 %: 0.7 mm; A 15 to 40 %: (40 - A)/25 \
                  (4 D85B - 0.7) + 0.7 mm; A < 15 %: 4 D85B; dispersive: A > 85 %: 6.4 D85B, not less than \
                  0.2 mm; 40 to 85 %: 0.5 mm",
        ..pair(
            retention::sherard_dunnigan,
            "Sherard & Dunnigan (1989), as given by Fell et al., Geotechnical Engineering of Dams, Table \
             9.2, with its note (b) on dispersive soils; the 0.2 mm: Sherard et al. (1984), as given by \
             Messerklinger, 18th International Conference on Soil Mechanics and Geotechnical Engineering \
             (2013), p. 3315",
        )
    },
    FilterRule {
        id: TESTS_NO_EROSION,
        authority: "Foster and Fell",
        says: "no erosion rather than some",
        applies_to: "filters of existing dams: a criterion proposed from tests, without a margin of safety",
        formula: "A > 85 %: 9 D85B; A 35 to 85 %: 0.7 mm; A 15 to 35 %: 1.6 ((35 - A)/20 (4 D85B - 0.7) + \
                  0.7 mm); A < 15 %: 7 D85B; dispersive: A > 85 %: 6.4 D85B; 35 to 85 %: 0.5 mm",
        ..pair(retention::no_erosion, FELL)
    },
    FilterRule {
        id: TESTS_CONTINUING,
        authority: "Foster and Fell",
        stated_by: &["USACE"],
        says: "boundary of continuing erosion",
        role: RuleRole::Continuation,
        applies_to: "existing dams with filters coarser than modern rules allow; D95B after regrading; not \
                     bases with 15 to 85 % fines and a D95B above 2 mm",
        formula: "9 D95B",
        ..pair(
            retention::continuing,
            "Foster & Fell (2001), as given by Fell et al., Geotechnical Engineering of Dams, section \
             9.3.2; regraded base: U.S. Army Corps of Engineers, Filter Evaluation manual \
             (RMC-CPD-2023-04), chapter Foster and Fell",
        )
    },
    FilterRule {
        id: TERZAGHI,
        authority: "Terzaghi",
        says: "the filter retains the base",
        applies_to: "bases with less than 15 % fines; D85B after regrading",
        quantity: &RuleQuantity::D15FOverD85B,
        formula: "4",
        unit: RuleUnit::One,
        ..pair(retention::terzaghi, "Terzaghi, as stated by Shire & O'Sullivan, section 2")
    },
    FilterRule {
        id: CONSTRICTED_EXIT,
        stated_by: &["USACE"],
        says: "Constricted exit: probability of continuing erosion into an open joint",
        role: RuleRole::Continuation,
        applies_to: "joints, defects and cracks beside the base that do not erode; steady flow",
        quantity: &RuleQuantity::named("probability"),
        formula: "from JOS/D95B after regrading: below 0.4: 0; 0.5: 0.01 %; 0.75: 0.1 %; 1: 10 %; 2: 50 %; \
                  3 and more: 90 %; between them straight on the scale of a normal variate",
        unit: RuleUnit::Percent,
        ..pair(
            retention::constricted,
            "U.S. Army Corps of Engineers, Filter Evaluation manual (RMC-CPD-2023-04), chapter \
             Constricted Exit, after Fell and Foster",
        )
    },
    FilterRule {
        id: PERMEABILITY,
        stated_by: &["NRCS", "USBR", "USACE"],
        says: "Permeability: the filter drains the base",
        role: RuleRole::Drainage,
        applies_to: "design of filters; D15B before regrading",
        formula: "5 D15B by USBR (2011) and NRCS (2017), and not less than 0.1 mm",
        at_least: true,
        ..pair(
            |inputs| drainage::permeability(inputs, 5.0),
            "U.S. Army Corps of Engineers, Filter Evaluation manual, chapter Permeability, which cites \
             USBR (2011) and NRCS (2017)",
        )
    },
    FilterRule {
        id: PERMEABILITY_LEAST,
        stated_by: &["USACE"],
        says: "Permeability, the least by EM 1110-2-1901: the filter drains the base",
        role: RuleRole::Drainage,
        applies_to: "filters of which this older manual is asked; D15B before regrading",
        formula: "3 D15B, the least of the 3 to 5 D15B of EM 1110-2-1901, and not less than 0.1 mm",
        at_least: true,
        ..pair(
            |inputs| drainage::permeability(inputs, 3.0),
            "U.S. Army Corps of Engineers, Filter Evaluation manual, chapter Permeability, which cites \
             EM 1110-2-1901 (2005)",
        )
    },
    FilterRule {
        id: FILTER_FINES,
        says: "The filter has few fines",
        role: RuleRole::Drainage,
        applies_to: "design of filters; that they are not plastic is not seen from a sieve curve",
        quantity: &RuleQuantity::named("finer than 0.075 mm"),
        formula: "5 %",
        unit: RuleUnit::Percent,
        ..filter(drainage::fines, OURS)
    },
    FilterRule {
        id: FILTER_GREATEST_SIZE,
        says: "The filter has no cobbles",
        applies_to: "design of filters: coarse grains segregate",
        quantity: &RuleQuantity::named("D100F"),
        formula: "75 mm",
        unit: RuleUnit::Mm,
        ..filter(drainage::greatest_size, OURS)
    },
    FilterRule {
        id: "filter-uniformity",
        says: "The filter is uniform enough for its band",
        applies_to: "design of filters: both sides of the band; wider curves leave room for gap-graded ones",
        quantity: &RuleQuantity::named("Cu of the filter"),
        formula: "6",
        ..filter(drainage::uniformity, OURS)
    },
    FilterRule {
        id: "filter-band",
        says: "The band of the filter is narrow",
        applies_to: "design of filters that are stated as a band of curves",
        quantity: &RuleQuantity::named("size of the coarse side / of the fine side"),
        formula: "5, from 5 to 60 % finer",
        pairing: Pairing::AllFilters,
        ..filter(drainage::band, OURS)
    },
    FilterRule {
        id: KEZDI,
        authority: "Kézdi (1979)",
        applies_to: "the filter alone: internal stability",
        quantity: &RuleQuantity::named("D'15/d'85, split at 17.6 to 64.7 %"),
        formula: "4",
        ..stable(stability::kezdi, INTERNAL_STABILITY)
    },
    FilterRule {
        id: KENNEY_LAU,
        authority: "Kenney and Lau (1986)",
        applies_to: "the filter alone: internal stability, F up to 20 % (Cu > 3) or 30 %",
        quantity: &RuleQuantity::named("least H/F of the filter"),
        formula: "1",
        at_least: true,
        ..stable(|inputs| stability::shape(inputs, Gradation::kenney_lau), INTERNAL_STABILITY)
    },
    FilterRule {
        id: LI_FANNIN,
        authority: "Li and Fannin (2008)",
        applies_to: "the filter alone: internal stability; Kenney and Lau to F = 15 %, Kézdi from there",
        quantity: &RuleQuantity::named("least H/min(F, 15 %) of the filter"),
        formula: "1",
        at_least: true,
        ..stable(|inputs| stability::shape(inputs, Gradation::li_fannin), INTERNAL_STABILITY)
    },
    FilterRule {
        id: "burenkova",
        authority: "Burenkova (1993)",
        applies_to: "the filter alone: broadly graded and gap-graded sands and gravels without cohesion, \
                     up to 100 mm, Cu up to 200",
        quantity: &RuleQuantity::named("h' = D90/D60 of the filter"),
        formula: "0.76 lg h'' + 1, with h'' = D90/D15, and less than 1.86 lg h'' + 1",
        at_least: true,
        ..stable(
            stability::burenkova,
            "U.S. Army Corps of Engineers, Internal Instability Toolbox manual (RMC-CPD-2023-10), \
             chapter Burenkova Method",
        )
    },
    FilterRule {
        id: "wan-fell",
        authority: "Wan and Fell (2004)",
        says: "probability that the filter loses its fines",
        applies_to: "the filter alone: broadly graded and gap-graded soils",
        quantity: &RuleQuantity::named("probability"),
        formula: "none stated: 1 / (1 + exp(-Z)), Z from h' and h'' of Burenkova",
        unit: RuleUnit::Percent,
        ..stable(
            stability::wan_fell,
            "U.S. Army Corps of Engineers, Internal Instability Toolbox manual (RMC-CPD-2023-10), \
             chapter Modified Burenkova Method",
        )
    },
    FilterRule {
        id: "kenney-controlling",
        authority: "Kenney et al.",
        says: "controlling constriction size Dc* ≤ D15F/5",
        applies_to: "bases without cohesion; Dc* is the largest particle eroded in the first run",
        quantity: &RuleQuantity::named("largest eroded / D15F"),
        formula: "1/5",
        ..walk(retention::largest_passing, "Kenney et al., as stated by Shire & O'Sullivan, section 2")
    },
    FilterRule {
        id: "paper-no-erosion",
        says: "Network model of the paper: no erosion rather than some",
        applies_to: "loose filters of Cu 1.5 and 3",
        quantity: &RuleQuantity::D15FOverD85B,
        formula: "5",
        ..walk(|inputs| retention::paper(inputs, 85.0, 5.0), "Shire & O'Sullivan, section 6, Fig. 14(a)")
    },
    FilterRule {
        id: "paper-continuing",
        says: "Network model of the paper: some erosion rather than continuing",
        applies_to: "filters of Cu 1.5 and 3",
        quantity: &RuleQuantity::D15FOverD95B,
        formula: "4.7",
        ..walk(|inputs| retention::paper(inputs, 95.0, 4.7), "Shire & O'Sullivan, section 6, Fig. 15")
    },
];
