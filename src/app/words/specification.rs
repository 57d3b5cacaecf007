//! Specification of a filter in words.

use super::answer::capital;
use super::practice::{beside_dispersive, dispersive_limit, test};
use super::rule::{regrade_reason, rule_notes};
use crate::outcome::table::{Columns, Shown, TableCell};
use serde::Serialize;
use voidwalk_core::gradation::{FEW_FINES, FINES_MM, GAP_PERCENT};
use voidwalk_practice::design::products::LEAST_CU;
use voidwalk_practice::design::size_band::{D15_OVER_D10, SieveLimit, SizeBand};
use voidwalk_practice::design::specification::{NoBand, StepName, StepNote, StepValue};
use voidwalk_practice::design::{Specification, SpecificationStep};
use voidwalk_practice::quantity;
use voidwalk_practice::quantity::{
    NumberRole, SizeUnit, greatest_length, least_length, length, limits, significant,
};
use voidwalk_practice::rules::{
    DESIGN_FLOOR_MM, GREATEST_SIZE_MM, LEAST_D15F_MM, MOST_CU, MOST_FINES_PERCENT, WIDEST_BAND,
    range_of_tests,
};

pub(crate) const DESIGN_AGAIN: &str = "design again for a dispersive base";

/// Advice for samples found to be dispersive.
pub(crate) const DESIGN_EACH_AGAIN: &str = "design again for dispersive soils";

/// Band to specify: D15F of both sides, and Cu. `None` without a band.
pub(crate) fn band(specification: &Specification, unit: SizeUnit) -> Option<String> {
    let [least, most] = specification.band.as_ref()?.d15_mm();
    let is_open =
        specification.d15f_min_at_most && specification.d15f_min_mm.is_some_and(|drains| drains >= least);
    let open = if is_open { " (what drains the base is not known and at most the lower D15F)" } else { "" };
    Some(format!("D15F from {}{open}, Cu from {LEAST_CU} to {MOST_CU}", limits(least, most, unit)))
}

/// Reason why the band begins above the minimum D15F that drains the base, or ends below the maximum that
/// retains it, in a sentence without its end; `None` if neither is the case.
pub(crate) fn raised(specification: &Specification, unit: SizeUnit) -> Option<String> {
    let [least, most] = specification.band.as_ref()?.d15_mm();
    let lowered = specification.d15f_max_mm.filter(|max| most < max * (1.0 - 1e-9));
    let moved = if let Some(retains) = lowered {
        let [retains, most] = [retains, most].map(|mm| greatest_length(mm, unit));
        format!("maximum D15F that retains the base is {retains}; this maximum is lowered to {most}")
    } else {
        let drains = specification.d15f_min_mm.filter(|drains| least > drains * (1.0 + 1e-9))?;
        let at_most = if specification.d15f_min_at_most { "not known, and at most " } else { "" };
        let [drains, least] = [drains, least].map(|mm| least_length(mm, unit));
        format!("minimum D15F that drains the base is {at_most}{drains}; this minimum is raised to {least}")
    };
    Some(format!("The {moved}, so that the band is no wider than {WIDEST_BAND} to 1"))
}

/// Gap in a specification: the maximum D90F, which keeps a filter from segregating, because no text with
/// its numbers could be read. `None` without a band.
pub(crate) fn still_to_set(specification: &Specification, unit: SizeUnit) -> Option<String> {
    let least = specification.band.as_ref().map(SizeBand::least_d10_mm)?;
    Some(format!(
        "Not a complete specification: there is no limit above D60F, and the maximum D90F is still to be set \
         from the table of FEMA (2011) or NRCS (National Engineering Handbook, Part 633, Chapter 26), for a \
         minimum D10F of {}.",
        // Entry of the table: a finer D10F allows no coarser D90F.
        greatest_length(least, unit)
    ))
}

/// Requirements of a delivery beside the limits at the sieves: between two sieves it may leave the band
/// or have a gap. `None` without a band.
pub fn beside_limits(specification: &Specification, unit: SizeUnit) -> Option<String> {
    let [least, most] = specification.band.as_ref()?.d15_mm();
    Some(format!(
        "The limits alone are not enough: D15F of each delivery must lie within {}, its Cu between \
         {LEAST_CU} and {MOST_CU}, and it must have no gap. Judge each delivery by its own gradation.",
        limits(least, most, unit)
    ))
}

/// Warning in a sentence without its end that the maximum D15F has no margin, if it equals the tests'
/// boundary of no erosion.
pub(crate) fn without_margin(specification: &Specification, unit: SizeUnit) -> Option<String> {
    let (curve, limit) = specification.strictest()?;
    let fines = curve.fines_percent.filter(|_| curve.without_margin)?;
    let why = match (specification.dispersive && fines >= FEW_FINES, range_of_tests(fines, curve.d85_mm?)) {
        // The limit of design is then the floor for any filter, above the boundary of tests.
        (true, _) if limit < DESIGN_FLOOR_MM => {
            "it is the boundary of no erosion in tests (Fell et al., Table 9.2, note b)".into()
        }
        (true, _) => {
            "Fell et al. (Table 9.2, note b) give it for no erosion in tests; it is taken for design, too"
                .into()
        }
        (false, [low, high]) => {
            let place = match limit {
                limit if limit <= low * (1.0 + 1e-9) => "is the lower end of",
                limit if limit > high => "lies beyond",
                _ => "lies in",
            };
            format!(
                "it {place} the range in which tests put the boundary of no erosion ({}; Fell et al., Table \
                 9.2)",
                quantity::range_of_tests(low, high, unit)
            )
        }
    };
    Some(format!("This limit has no margin: {why}"))
}

pub(crate) fn limit(specification: &Specification, unit: SizeUnit) -> String {
    match specification.strictest() {
        Some((curve, limit)) => {
            format!("D15F {} ({})", greatest_length(limit, unit), curve.d15f_max_rule)
        }
        None => "not known".into(),
    }
}

/// Maximum D15F if the base is dispersive, and the advice, such as [`DESIGN_AGAIN`], in sentences, the
/// last without its end; `None` if all holds for such a base too, or if dispersion is stated.
pub(crate) fn if_dispersive(specification: &Specification, again: &str, unit: SizeUnit) -> Option<String> {
    let most = specification.d15f_max_mm.unwrap_or(f64::INFINITY);
    let limit =
        specification.if_dispersive.filter(|limit| beside_dispersive(*limit, most, unit).is_some())?;
    let [before, invalid] = match specification.band {
        Some(_) => ["this band is specified", "this band is not valid: "],
        None => ["a filter is specified", ""],
    };
    let with_filter = "have the base tested with the filter";
    let test = if limit.at_most { format!(", and {}", test(limit, with_filter)) } else { String::new() };
    Some(format!(
        "Whether the base is dispersive is not stated: have it tested (pinhole or crumb) before {before}. If \
         it is, {invalid}D15F is to be {}. {}{test}",
        dispersive_limit(limit, unit),
        capital(again)
    ))
}

/// Reason why there is no band, in sentences.
pub fn no_band(why: &NoBand, unit: SizeUnit) -> String {
    match why {
        NoBand::DrainageNotKnown { most_drains_mm, most_mm } => format!(
            "The minimum D15F that drains this base is not known. It is at most {}, and D15F must be at most \
             {} to retain the base: D15B must be tested.",
            least_length(*most_drains_mm, unit),
            greatest_length(*most_mm, unit)
        ),
        NoBand::NoneDrainsAndRetains { least_mm, most_mm } => format!(
            "No filter both drains and retains this base: D15F must be at least {} to drain it and at most \
             {} to retain it. {}",
            least_length(*least_mm, unit),
            greatest_length(*most_mm, unit),
            // A base this fine is not broad: the minimum D15F of any filter exceeds its limit.
            if *least_mm <= LEAST_D15F_MM {
                "Have the base tested in the laboratory with the filter, or take a filter in two stages."
            } else {
                "A filter in two stages, or a base that is less broad, is needed."
            }
        ),
        NoBand::TooManyFines => {
            format!("The coarse side would have more than {MOST_FINES_PERCENT} % finer than {FINES_MM} mm.")
        }
        NoBand::TooCoarse { most_d60f_mm } => format!(
            "The maximum D60F is {} and lies beyond the greatest size of {GREATEST_SIZE_MM} mm.",
            greatest_length(*most_d60f_mm, unit)
        ),
        NoBand::LimitNotKnown { curve, needs } => {
            let why =
                if needs.is_empty() { "the limit can only be lower".into() } else { rule_notes(needs, unit) };
            format!("The maximum D15F is not known for {curve}: {why}.")
        }
        NoBand::NoRule => "No rule of retention covers this base.".into(),
    }
}

/// Number of a step with its unit: a minimum rounded up, a maximum or a size that enters a table rounded
/// down; `None` if unknown.
pub(crate) fn step_value(value: &StepValue, unit: SizeUnit) -> Option<String> {
    let number = value.value?;
    Some(match (value.unit.as_str(), value.role()) {
        ("mm", Some(at_least)) => length(number, unit).role(NumberRole::of_limit(at_least)).to_string(),
        ("mm", None) => length(number, unit).to_string(),
        ("", _) if number.fract() == 0.0 && number < 100.0 => format!("{number:.0}"),
        (name, _) => format!("{} {name}", significant(number)).trim_end().to_owned(),
    })
}

pub(crate) fn step_name(step: StepName) -> &'static str {
    match step {
        StepName::Plot => "Plot the gradation of the base",
        StepName::FindGravel => "Find out whether the base has gravel or a gap",
        StepName::Regrade => "Regrade the base",
        StepName::Place => "Place the base in a category by its fines after regrading",
        StepName::Retain => "Find the maximum D15F that retains the base",
        StepName::Drain => "Find the minimum D15F that drains the base",
        StepName::Narrow => "Keep the band narrow at 15 % finer",
        StepName::KeepUniform => "Keep both sides uniform, without gaps",
        StepName::LimitEnds => "Limit the fines and the greatest size",
        StepName::KeepFromSegregating => "Keep the filter from segregating",
        StepName::Draw => "Draw both sides of the band",
        StepName::CheckStability => "Check both sides for internal stability",
    }
}

/// Remarks on a step in sentences.
pub(crate) fn step_notes(step: &SpecificationStep, unit: SizeUnit) -> String {
    let remark = match step.does {
        StepName::KeepUniform => format!(
            "Cu of each delivery lies between {LEAST_CU} and {MOST_CU}. {D15_OVER_D10} is D15/D10 of a side \
             that is straight on the form and has a Cu of {MOST_CU}."
        ),
        StepName::LimitEnds => format!(
            "At most {MOST_FINES_PERCENT} % is finer than {FINES_MM} mm, and than the minimum D5F. These \
             fines must not be plastic."
        ),
        StepName::KeepFromSegregating => "Still to be set: no text with its numbers could be read. The \
            maximum D90F follows from this minimum D10F by a table of FEMA and NRCS."
            .into(),
        StepName::Draw => "The control points are joined by straight lines on the form. Above 60 % finer \
            neither side is drawn, as no text was read for it. Below its D5 the fine side runs level to the \
            No. 200 sieve."
            .into(),
        StepName::CheckStability if !step.notes.is_empty() => "The fine side is judged from its D5 up, and \
            both as if they went on straight above 60 % finer."
            .into(),
        _ => String::new(),
    };
    let notes = step.notes.iter().map(|note| step_note(note, unit));
    notes.chain([remark]).filter(|words| !words.is_empty()).collect::<Vec<_>>().join(" ")
}

fn step_note(note: &StepNote, unit: SizeUnit) -> String {
    match note {
        StepNote::Curves { curves: 1 } => "One curve.".into(),
        StepNote::Curves { curves } => {
            format!("{curves} curves. Each is to be retained and drained, and the strictest limit counts.")
        }
        StepNote::Gravel { curve, why, flattest } => {
            let reason = regrade_reason(*why);
            let reason = match curve {
                Some(curve) => format!("{curve}: {reason}"),
                None => capital(&reason),
            };
            format!("{reason}. {}", gap(*flattest, unit))
        }
        StepNote::NotRegraded => "Not regraded.".into(),
        StepNote::SetBy { rule: Some(rule), curve: Some(curve) } => format!("Set by {rule}, for {curve}."),
        StepNote::SetBy { rule: Some(name), curve: None }
        | StepNote::SetBy { rule: None, curve: Some(name) } => {
            format!("Set by {name}.")
        }
        StepNote::SetBy { rule: None, curve: None } => String::new(),
        StepNote::LimitNotKnown { needs } if needs.is_empty() => "The limit can only be lower.".into(),
        StepNote::LimitNotKnown { needs: notes } | StepNote::OfRule { notes } => {
            format!("{}.", capital(&rule_notes(notes, unit)))
        }
        StepNote::DrainageAtMost => {
            "D15B is finer than the finest sieve. The minimum D15F is not known, and is at most this.".into()
        }
        StepNote::Raised => "The minimum D15F is raised.".into(),
        StepNote::Lowered => "The maximum D15F is lowered.".into(),
        StepNote::Stability { side, not_kept, .. } if !not_kept.is_empty() => {
            format!("The {side} side is not stable by {}.", not_kept.join(" and "))
        }
        StepNote::Stability { side, is_known: true, .. } => format!("The {side} side keeps both."),
        StepNote::Stability { side, .. } => format!("The {side} side is nearly of one size."),
    }
}

/// Check for a gap by a number of this program, as the manual leaves it to the eye.
fn gap(flattest: Option<[f64; 2]>, unit: SizeUnit) -> String {
    const EYE: &str =
        "The manual gives no number and leaves it to visual examination and judgment: look at the curve.";
    let Some([from_mm, within]) = flattest else {
        return format!("No gap by this program's own check. {EYE}");
    };
    let answer = if within < GAP_PERCENT { "A gap" } else { "No gap" };
    format!(
        "{answer} by this program's own check: the least mass within a factor of 4 in size is {} %, from {}, \
         and below {GAP_PERCENT} % counts as a gap. {EYE}",
        significant(within),
        length(from_mm, unit).to(length(4.0 * from_mm, unit))
    )
}

/// Columns of limits at each sieve, on a page and in a workbook.
pub(crate) fn limit_columns<'a>() -> Columns<'a, SieveLimit> {
    Columns::default()
        .name("sieve", "Sieve", |limit: &SieveLimit| limit.sieve.clone())
        .number("opening_mm", "Opening (mm)", |limit| limit.opening_mm)
        .column("min_percent_finer", |limit| limit.min_percent_finer)
        .page_number("Least finer (%)", |limit| significant(limit.min_percent_finer).in_digits(4))
        .column("max_percent_finer", |limit| limit.max_percent_finer)
        .page_number("Greatest finer (%)", |limit| {
            let most = limit.max_percent_finer;
            most.map_or(Shown::default(), |most| significant(most).in_digits(4).shown())
        })
}

/// Row of `specification_steps.csv`: one number of a step.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct StepRow {
    pub(crate) step: u64,
    pub(crate) does: String,
    /// Name of the number; empty if the step has no number.
    pub(crate) quantity: String,
    pub(crate) value: Option<f64>,
    pub(crate) unit: String,
    pub(crate) formula: String,
    /// Remarks for the reader.
    pub(crate) note: String,
    pub(crate) source: String,
}

/// Numbers of a step as rows; a step without a number gives one row.
pub(crate) fn step_rows(step: &SpecificationStep) -> Vec<StepRow> {
    let row = |value: Option<&StepValue>| StepRow {
        step: step.step,
        does: step_name(step.does).to_owned(),
        quantity: value.map_or_else(String::new, |value| value.name.clone()),
        value: value.and_then(|value| value.value),
        unit: value.map_or_else(String::new, |value| value.unit.clone()),
        formula: step.formula.clone(),
        note: step_notes(step, SizeUnit::Mm),
        source: step.source.clone(),
    };
    if step.values.is_empty() {
        vec![row(None)]
    } else {
        step.values.iter().map(|value| row(Some(value))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::{CORE, DESIGN_CLAY, DESIGN_SAND, TILL, soil};
    use voidwalk_practice::SpecificationOptions;
    use voidwalk_practice::design::specification::ENTERED_BY;

    /// A sand of one size, for which there is no band.
    const UNIFORM: [(f64, f64); 2] = [(0.4, 0.0), (0.5, 100.0)];

    fn specified(points: &[(f64, f64)], dispersive: Option<bool>) -> Specification {
        let options = SpecificationOptions { dispersive, ..SpecificationOptions::default() };
        Specification::of("base", &soil(points), options)
    }

    #[test]
    fn a_minimum_is_rounded_up_and_a_maximum_down() {
        for (name, value, unit, words) in [
            ("minimum D15F", Some(0.11661), "mm", Some("0.117\u{202f}mm")),
            // The words agree with the sentence on D90F.
            (ENTERED_BY, Some(0.19158), "mm", Some("0.191\u{202f}mm")),
            ("maximum D10F", Some(0.58389), "mm", Some("0.583\u{202f}mm")),
            ("maximum D15F / minimum D15F, as found", Some(6.999), "", Some("7.00")),
            ("category", Some(2.0), "", Some("2")),
            ("minimum D15F", None, "mm", None),
        ] {
            let value = StepValue { name: name.into(), value, unit: unit.into() };
            assert_eq!(step_value(&value, SizeUnit::Mm).as_deref(), words);
        }
    }

    /// All lengths of all steps, for sizes with many digits.
    #[test]
    fn inches_of_a_step_lie_within_the_limit_beside_them() {
        let mut checked = 0;
        for step in 0..40 {
            let by = libm::pow(1.01, f64::from(step));
            for points in [&CORE[..], &DESIGN_CLAY, &DESIGN_SAND] {
                let points: Vec<(f64, f64)> = points.iter().map(|(size, p)| (by * size, *p)).collect();
                let steps = specified(&points, None).steps;
                for value in steps.iter().flat_map(|step| &step.values).filter(|value| value.unit == "mm") {
                    let (Some(at_least), Some(number)) = (value.role(), value.value) else { continue };
                    let words = step_value(value, SizeUnit::MmAndInches).unwrap();
                    let (mm, inches) = words.split_once("\u{202f}mm (").unwrap();
                    let inches = inches.trim_end_matches("\u{202f}in)").parse::<f64>().unwrap();
                    let (mm, back) = (mm.parse::<f64>().unwrap(), 25.4 * inches);
                    let [high, middle, low] = if at_least { [back, mm, number] } else { [number, mm, back] };
                    let hair = 1.0 - 1e-8;
                    assert!(high >= middle * hair && middle >= low * hair, "{value:?} {words}");
                    checked += 1;
                }
            }
        }
        assert!(checked > 500, "{checked}");
    }

    /// The band in words is the band that is drawn, on every page.
    #[test]
    fn the_band_that_is_said_is_the_one_that_is_drawn() {
        let core = band(&specified(&CORE, None), SizeUnit::Mm);
        assert_eq!(core.as_deref(), Some("D15F from 0.140 to 0.700\u{202f}mm, Cu from 2 to 6"));
        for specification in [specified(&CORE, None), specified(&DESIGN_SAND, None)] {
            let sides = &specification.steps[10];
            let words_of = |name: &str| {
                let value = sides.values.iter().find(|value| value.name == name).unwrap();
                step_value(value, SizeUnit::Mm).unwrap()
            };
            let [least, greatest] = ["minimum D15F", "maximum D15F"].map(words_of);
            let limits = format!("{} to {greatest}", least.trim_end_matches("\u{202f}mm"));
            assert!(band(&specification, SizeUnit::Mm).unwrap().contains(&limits), "{limits}");
            assert!(beside_limits(&specification, SizeUnit::Mm).unwrap().contains(&limits), "{limits}");
        }
        let none = specified(&UNIFORM, None);
        assert_eq!([band(&none, SizeUnit::Mm), beside_limits(&none, SizeUnit::Mm)], [None, None]);
    }

    /// A ratio of 7 is narrowed to 5 at either end; a ratio of 2 is not.
    #[test]
    fn a_band_that_was_narrowed_is_said_with_both_sizes() {
        for (finer, sizes) in [(false, ["0.100", "0.140"]), (true, ["0.700", "0.500"])] {
            let options = SpecificationOptions { finer, ..SpecificationOptions::default() };
            let core = Specification::of("core", &soil(&CORE), options);
            let sentence = raised(&core, SizeUnit::Mm).unwrap();
            assert!(sizes.iter().all(|size| sentence.contains(&format!("{size}\u{202f}mm"))), "{sentence}");
        }
        assert_eq!(raised(&specified(&DESIGN_SAND, None), SizeUnit::Mm), None);
    }

    /// The first sheet and its step state the same size, which enters the table of D90F.
    #[test]
    fn the_minimum_d10f_is_one_number() {
        for specification in [specified(&TILL, None), specified(&CORE, None)] {
            let d10 = step_value(&specification.steps[9].values[0], SizeUnit::Mm).unwrap();
            let sentence = still_to_set(&specification, SizeUnit::Mm).unwrap();
            assert!(sentence.ends_with(&format!(" {d10}.")), "{d10}");
        }
        assert_eq!(still_to_set(&specified(&UNIFORM, None), SizeUnit::Mm), None);
    }

    /// A limit within the range of tests, one at its lower end, one below it, and limits of dispersive soils.
    #[test]
    fn a_limit_without_a_margin_is_said_to_have_none() {
        let sentence =
            |points: &[(f64, f64)], dispersive| without_margin(&specified(points, dispersive), SizeUnit::Mm);
        // For a dispersive clay this fine, 6.4 D85B is less than 0.2 mm, the minimum of design.
        let fine = [(0.0005, 0.0), (0.02, 85.0), (0.04, 100.0)];
        for (points, dispersive, words) in [
            (&CORE[..], None, "it is the lower end of the range"),
            // 6.4 to 13.5 D85B, and a limit of 9 D85B.
            (&DESIGN_CLAY, None, "it lies in the range in which tests put"),
            (&DESIGN_CLAY, None, "0.320 to 0.675\u{202f}mm"),
            (&DESIGN_CLAY, Some(true), "give it for no erosion in tests"),
            (&fine, Some(true), "it is the boundary of no erosion in tests"),
        ] {
            let sentence = sentence(points, dispersive).unwrap();
            assert!(sentence.contains(words), "{words}: {sentence}");
        }
        assert_eq!(sentence(&[(0.01, 0.0), (0.075, 25.0), (1.0, 85.0), (4.0, 100.0)], None), None);
        assert_eq!(sentence(&DESIGN_SAND, Some(true)), None);
    }

    /// The limit of a dispersive silt is 0.5 mm; with 25 % fines no source has a limit, and the limit of
    /// other bases is never stated as one.
    #[test]
    fn a_limit_of_dispersive_bases_that_no_source_gives_is_less_than_that_of_others() {
        let silt = |fines| [(0.01, 0.0), (0.075, fines), (0.3, 92.0), (0.6, 100.0)];
        let sentence =
            |fines, dispersive| if_dispersive(&specified(&silt(fines), dispersive), "again", SizeUnit::Mm);
        let known = sentence(45.0, None).unwrap();
        assert!(known.contains("this band is not valid: D15F is to be at most 0.500\u{202f}mm"), "{known}");
        let open = sentence(25.0, None).unwrap();
        assert!(open.contains("less than ") && !open.contains("at most"), "{open}");
        assert!(open.ends_with("have the base tested with the filter"), "{open}");
        // Few fines, and bases whose dispersion is stated.
        for (fines, dispersive) in [(10.0, None), (45.0, Some(true)), (45.0, Some(false))] {
            assert_eq!(sentence(fines, dispersive), None);
        }
    }

    /// The maximum D15F, 6.4 D85B = 0.064 mm, is less than the minimum for any filter.
    #[test]
    fn a_base_that_is_too_fine_is_not_called_broad() {
        let why =
            |least_mm| no_band(&NoBand::NoneDrainsAndRetains { least_mm, most_mm: 0.0640001 }, SizeUnit::Mm);
        let range = "at least 0.100\u{202f}mm to drain it and at most 0.0640\u{202f}mm to retain it";
        assert!(why(0.1).contains(range));
        assert!(!why(0.1).contains("less broad") && why(0.2).contains("less broad"));
    }
}
