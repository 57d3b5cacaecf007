//! Specification of a filter for a base: record, steps, band, and standard products.

pub mod products;
pub mod size_band;
pub mod specification;
mod steps;

use crate::rules::{GREATEST_SIZE_MM, MOST_CU, NamedCurve, WIDEST_BAND};
use crate::{IfDispersive, Note, SheetCover};
use size_band::{D15_OVER_D10, Side};
use specification::{NoBand, SizeBand, margins};
use steps::{Control, Findings, ReadCurve, any_filter};

pub use size_band::SieveSeries;
pub use specification::{RowNote, Specification, SpecificationStep};

/// Options of a specification.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpecificationOptions {
    /// True if the base is dispersive; `None` if this is not stated.
    pub dispersive: Option<bool>,
    /// Sieves at which the limits are stated.
    pub sieves: SieveSeries,
    /// True to place the band at the finer end of the allowed sizes instead of the coarser.
    pub finer: bool,
}

impl Specification {
    /// Specifies a filter for a base of one or several curves, in mm. The filter must retain and drain
    /// every curve, so the strictest limit of each kind counts.
    ///
    /// ```
    /// use voidwalk_core::Gradation;
    /// use voidwalk_practice::design::Specification;
    /// use voidwalk_practice::SpecificationOptions;
    /// let clay = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)])?;
    /// let filter = Specification::of("core", &[("core".into(), clay)], SpecificationOptions::default());
    /// assert_eq!((filter.d15f_min_mm, filter.d15f_max_mm), (Some(0.1), Some(0.7)));
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn of(name: &str, bases: &[NamedCurve], options: SpecificationOptions) -> Self {
        let dispersive = options.dispersive == Some(true);
        let read: Vec<ReadCurve> = bases.iter().map(|base| ReadCurve::of(base, dispersive)).collect();
        let strictest = read.iter().min_by(|a, b| a.greatest().total_cmp(&b.greatest()));
        let unknown = read.iter().find(|curve| curve.unknown.is_some());
        let d15f_max = strictest.filter(|_| unknown.is_none()).and_then(|curve| curve.record.d15f_max_mm);
        let coarsest = read.iter().max_by(|a, b| a.least().total_cmp(&b.least()));
        let d15f_min = coarsest.and_then(|curve| curve.record.d15f_min_mm);
        let control = d15f_min.zip(d15f_max).and_then(|(min, max)| control(min, max, options.finer));
        let band = control.as_ref().and_then(|control| SizeBand::of(control.d15, control.d60));
        let at_most = coarsest.is_some_and(ReadCurve::least_at_most);
        let certain = read.iter().map(ReadCurve::certain_least).fold(0.0, f64::max);
        let no_band = no_band((d15f_min, at_most), d15f_max, unknown, band.is_some());
        let if_dispersive =
            options.dispersive.is_none().then(|| IfDispersive::of_bases(bases, &any_filter())).flatten();
        let (sides, finer) = (band.as_ref(), options.finer);
        let facts =
            Findings { read: &read, strictest, unknown, coarsest, d15f_max, control, band: sides, finer };
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: None,
            base: name.into(),
            dispersive,
            sieves: options.sieves,
            cover: SheetCover::default(),
            inches: false,
            inputs: Vec::new(),
            steps: facts.steps(),
            curves: read.iter().map(|curve| curve.record.clone()).collect(),
            notes: steps::notes(&read).into_iter().chain(notes_of_sides(sides)).collect(),
            d15f_min_mm: d15f_min,
            d15f_min_at_most: at_most,
            d15f_max_mm: d15f_max,
            finer,
            if_dispersive,
            limits: sides.map(|band| band.limits(options.sieves)).unwrap_or_default(),
            products: margins((d15f_min, certain), d15f_max),
            no_band,
            band,
        }
    }
}

/// Control points of a band between a minimum and a maximum D15F (mm), at the finer or the coarser end if
/// that range is wider than a band may be; `None` if the minimum exceeds the maximum.
fn control(min: f64, max: f64, finer: bool) -> Option<Control> {
    let d15 = match finer {
        true => [min, max.min(WIDEST_BAND * min)],
        false => [min.max(max / WIDEST_BAND), max],
    };
    let d60_max = MOST_CU * d15[1] / D15_OVER_D10;
    (min <= max).then_some(Control { d15, d60: [d60_max / WIDEST_BAND, d60_max] })
}

/// Minimum D15F (mm) of the band of a filter that drains from `min` (mm) and retains up to `max`: raised
/// if the band would otherwise be too wide.
pub fn least_of_band(min: f64, max: f64) -> f64 {
    control(min, max, false).map_or(min, |control| control.d15[0])
}

/// Reason why no filter between a minimum and a maximum D15F (mm) has a band; `None` if one has.
pub fn no_band_between((min, at_most): (f64, bool), max: f64) -> Option<NoBand> {
    let band = control(min, max, false).and_then(|control| SizeBand::of(control.d15, control.d60));
    no_band((Some(min), at_most), Some(max), None, band.is_some())
}

fn no_band(
    (min, at_most): (Option<f64>, bool),
    max: Option<f64>,
    unknown: Option<&ReadCurve>,
    has_band: bool,
) -> Option<NoBand> {
    Some(match (min, max) {
        _ if has_band => return None,
        (Some(min), Some(max)) if min > max && at_most => {
            NoBand::DrainageNotKnown { most_drains_mm: min, most_mm: max }
        }
        (Some(min), Some(max)) if min > max => NoBand::NoneDrainsAndRetains { least_mm: min, most_mm: max },
        (Some(_), Some(max)) if MOST_CU * max / D15_OVER_D10 < GREATEST_SIZE_MM => NoBand::TooManyFines,
        (Some(_), Some(max)) => NoBand::TooCoarse { most_d60f_mm: MOST_CU * max / D15_OVER_D10 },
        _ => match unknown.and_then(|curve| Some((curve.record.curve.clone(), curve.unknown.clone()?))) {
            Some((curve, needs)) => NoBand::LimitNotKnown { curve, needs },
            None => NoBand::NoRule,
        },
    })
}

/// Notes on the sides of a band that are not internally stable.
fn notes_of_sides(band: Option<&SizeBand>) -> Vec<RowNote> {
    let row_note = |side: Side| {
        let authorities = side.authorities();
        let is_unstable = !authorities.is_empty();
        let note = Note::UnstableSide { side: side.name.into(), authorities };
        is_unstable.then_some(RowNote { row: None, note })
    };
    band.map(Side::both).into_iter().flatten().filter_map(row_note).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rule_result::met_of;
    use crate::test_soils::{CORE, DESIGN_CLAY, DESIGN_SAND, REGRADED_TILL, TILL, curve, soil};
    use crate::{DispersiveLack, PairOptions, PairRules, RuleNote, RuleRole};
    use specification::{StepName, StepNote};
    use voidwalk_core::gradation::{GAP_PERCENT, Gradation};

    fn specified_if(points: &[(f64, f64)], dispersive: Option<bool>) -> Specification {
        let options = SpecificationOptions { dispersive, ..SpecificationOptions::default() };
        Specification::of("base", &soil(points), options)
    }

    fn specified(points: &[(f64, f64)]) -> Specification {
        specified_if(points, None)
    }

    const GAP: [(f64, f64); 4] = [(0.08, 0.0), (0.3, 40.0), (2.4, 41.0), (4.0, 100.0)];

    fn near(value: Option<f64>, wanted: f64) -> bool {
        value.is_some_and(|value| (value / wanted - 1.0).abs() < 1e-9)
    }

    fn value(specified: &Specification, name: &str) -> Option<f64> {
        let all = specified.steps.iter().flat_map(|step| &step.values);
        all.filter(|value| value.name == name).find_map(|value| value.value)
    }

    /// A core of category 2: 0.1 to 0.7 mm, a ratio of 7 that is narrowed to 5.
    #[test]
    fn a_core_with_60_percent_of_fines_by_hand() {
        let core = specified(&CORE);
        assert_eq!(core.curves[0].category, Some(2));
        assert!(near(core.d15f_max_mm, 0.7) && near(core.d15f_min_mm, 0.1));
        assert!(near(value(&core, "minimum D15F of the band"), 0.14));
        assert!(near(value(&core, "maximum D10F"), 0.7 / 1.2));
        assert!(near(value(&core, "maximum D60F"), 3.5) && near(value(&core, "minimum D60F"), 0.7));
        assert!(near(value(&core, "minimum D10F"), 0.14 / 1.2));
        let sizes = &core.band.as_ref().unwrap().sizes;
        assert_eq!(sizes.iter().map(|size| size.percent).collect::<Vec<_>>(), [5.0, 15.0, 60.0]);
        assert!(core.steps.iter().map(|step| step.step).eq(1..=12));
        assert!(core.no_band.is_none() && core.nearest_product().is_none());
        assert!(core.products[0].fits() == Some(true) && core.products[1].fits() == Some(false));
    }

    /// Categories 1, 3 and 4, and a dispersive clay.
    #[test]
    fn the_limits_of_the_other_categories_by_hand() {
        assert!(near(specified(&DESIGN_CLAY).d15f_max_mm, 9.0 * 0.05));
        let dispersive = specified_if(&DESIGN_CLAY, Some(true));
        assert!(near(dispersive.d15f_max_mm, 6.4 * 0.05) && dispersive.dispersive);
        let silty = specified(&[(0.01, 0.0), (0.075, 25.0), (1.0, 85.0), (4.0, 100.0)]);
        assert!(near(silty.d15f_max_mm, (40.0 - 25.0) / 25.0 * (4.0 - 0.7) + 0.7));
        let sand = specified(&DESIGN_SAND);
        assert!(near(sand.d15f_max_mm, 2.0) && near(sand.d15f_min_mm, 1.0));
        // The ratio of 2 needs no narrowing.
        assert!(near(value(&sand, "minimum D15F of the band"), 1.0) && sand.steps[6].notes.is_empty());
    }

    /// The till of the first trial: D85B of 1.53 mm regraded on No. 4, 38 % fines.
    #[test]
    fn a_till_is_regraded_and_its_limit_is_that_of_design() {
        let till = specified(&TILL);
        let fines: f64 = 35.0 / 0.92;
        assert!(near(value(&till, "fines A, finer than 0.075 mm"), fines));
        assert_eq!(value(&till, "regraded on"), Some(4.75));
        let d85b = till.curves[0].d85_mm.unwrap();
        let design = (40.0 - fines) / 25.0 * (4.0 * d85b - 0.7) + 0.7;
        assert!(near(till.d15f_max_mm, design) && near(value(&till, "maximum D15F by practice"), design));
        // D15B is finer than the finest sieve: the limit is at most five times the sieve.
        assert!(near(till.d15f_min_mm, 5.0 * 0.075));
    }

    /// If the fine side is flatter than the factor implies, its own D10 counts.
    #[test]
    fn the_least_d10f_is_that_of_the_fine_side_where_that_is_finer() {
        // D15F of 1 to 2 mm: D5 of the fine side is a fifth of 2 x 5^(-10/45).
        let sand = specified(&DESIGN_SAND);
        let d10 = (2.0 * 5f64.powf(-10.0 / 45.0) / 5.0).sqrt();
        assert!(d10 < 1.0 / 1.2 && near(value(&sand, "minimum D10F"), d10), "{d10}");
        let sources = [7, 9, 10].map(|at| sand.steps[at].source.as_str());
        assert!(sources.iter().all(|source| source.contains("this program")), "{sources:?}");
    }

    #[test]
    fn the_step_of_gravel_and_gap_answers_both() {
        let flattest = |points: &[(f64, f64)]| match specified(points).steps[1].notes[..] {
            [StepNote::Gravel { curve: None, flattest: Some(flattest), .. }] => flattest,
            ref notes => panic!("{notes:?}"),
        };
        let [from, within] = flattest(&GAP);
        assert!(near(Some(from), 0.3) && within < GAP_PERCENT, "{within}");
        // 12 % over a factor of 8.33.
        let [from, within] = flattest(&[(0.08, 10.0), (0.6, 59.0), (5.0, 71.0), (20.0, 100.0)]);
        assert!(near(Some(from), 0.6) && near(Some(within), 12.0 * 4f64.ln() / (5.0f64 / 0.6).ln()));
        // 5 % is cited as a number of this program alone.
        let source = &specified(&DESIGN_SAND).steps[1].source;
        assert!(source.ends_with("The check for a gap is this program's own"), "{source}");
    }

    /// A base that is unstable, broad, and flat between 0.6 and 5 mm.
    #[test]
    fn what_is_wrong_with_the_base_itself_is_among_the_notes() {
        let notes = |specified: &Specification| {
            specified.notes.iter().map(|row| row.note.clone()).collect::<Vec<_>>()
        };
        let points = [(0.002, 5.0), (0.075, 29.0), (0.6, 59.0), (5.0, 71.0), (20.0, 100.0)];
        let broad = notes(&specified(&points));
        // Regraded on 0.6 mm: 49.2 % fines, and so 0.7 mm, as on No. 4: no other limit is noted.
        let [Note::UnstableBase { index, .. }, Note::BroadBase { .. }, Note::FlatBase { .. }] = broad[..]
        else {
            panic!("{broad:?}")
        };
        assert!(index < 1.0, "{index}");
        let gap = notes(&specified(&GAP));
        assert!(gap.iter().any(|note| matches!(note, Note::GapOfBase { .. })), "{gap:?}");
        assert_eq!(notes(&specified(&[(0.1, 0.0), (0.5, 100.0)])), []);
        // With several curves each note names its curve.
        let both = both("sand", &[(0.1, 0.0), (0.5, 100.0)], "till", &points);
        let rows: Vec<_> = both.notes.iter().map(|row| row.row.as_deref()).collect();
        assert_eq!(rows, [Some("till"), Some("till"), Some("till"), None]);
        // The note of the band covers all curves: 0.636 to 0.700 mm, with a fine side that extends far
        // out to its D5.
        assert!(matches!(notes(&both)[3], Note::UnstableSide { .. }), "{:?}", both.notes);
    }

    fn both(one: &str, points: &[(f64, f64)], other: &str, others: &[(f64, f64)]) -> Specification {
        let curves = [(one.to_owned(), curve(points)), (other.to_owned(), curve(others))];
        Specification::of("site", &curves, SpecificationOptions::default())
    }

    #[test]
    fn of_several_curves_the_strictest_limit_of_each_counts() {
        let fine = [(0.1, 0.0), (0.15, 15.0), (0.4, 85.0), (1.0, 100.0)];
        let both = both("fine", &fine, "coarse", &[(0.1, 0.0), (0.2, 15.0), (0.8, 85.0), (2.0, 100.0)]);
        assert!(near(both.d15f_max_mm, 1.6) && near(both.d15f_min_mm, 1.0));
        let [fine, coarse] = [0, 1].map(|at: usize| both.curves[at].d15f_max_mm);
        assert!(near(coarse, 2.0 * fine.unwrap()));
        let [StepNote::SetBy { rule: Some(rule), curve }] = &both.steps[4].notes[..] else {
            panic!("{:?}", both.steps[4])
        };
        assert_eq!((Some(rule.as_str()), curve.as_deref()), (both.set_by(), Some("fine")));
        assert_eq!(both.steps[5].notes[0], StepNote::SetBy { rule: None, curve: Some("coarse".into()) });
        assert!(value(&both, "D15B of coarse").is_some());
    }

    #[test]
    fn without_a_known_limit_or_room_between_both_there_is_no_band_and_it_is_said_why() {
        let without = |points: &[(f64, f64)], dispersive| {
            let specified = specified_if(points, dispersive);
            assert!(specified.band.is_none() && specified.limits.is_empty(), "{points:?}");
            specified
        };
        // 20 % finer than 0.2 mm: fines, and so the category, are not known.
        let open = without(&[(0.2, 20.0), (0.5, 85.0), (1.0, 100.0)], None);
        assert!(open.nearest_product().is_none() && open.d15f_max_mm.is_none());
        let needs = vec![RuleNote::NeedsFinesOfBase];
        assert_eq!(open.no_band, Some(NoBand::LimitNotKnown { curve: "soil".into(), needs }));
        // A sand of one size: 5 D15B is more than 4 D85B.
        let uniform = without(&[(0.4, 0.0), (0.5, 100.0)], None);
        let Some(NoBand::NoneDrainsAndRetains { least_mm, most_mm }) = uniform.no_band else {
            panic!("{uniform:?}")
        };
        assert!(near(uniform.d15f_min_mm, least_mm) && least_mm > most_mm);
        // A base so fine that its limit, 6.4 D85B = 0.064 mm, is less than the minimum for any filter.
        let fine = without(&[(0.0005, 0.0), (0.01, 85.0), (0.02, 100.0)], Some(true)).no_band;
        let Some(NoBand::NoneDrainsAndRetains { least_mm, most_mm }) = fine else { panic!("{fine:?}") };
        assert!(near(Some(least_mm), 0.1) && near(Some(most_mm), 0.064), "{least_mm} {most_mm}");
        // A gravel whose filter would consist of cobbles.
        let gravel = without(&[(5.0, 0.0), (6.0, 15.0), (9.0, 85.0), (12.0, 100.0)], None).no_band;
        assert!(matches!(gravel, Some(NoBand::TooCoarse { most_d60f_mm }) if most_d60f_mm > 75.0));
        // A dispersive clay whose limit is 6.4 D85B, or 0.103 mm: its coarse side has too many fines.
        let narrow = without(&[(0.0008, 0.0), (0.0161, 85.0), (0.03, 100.0)], Some(true)).no_band;
        assert_eq!(narrow, Some(NoBand::TooManyFines));
    }

    /// A specification keeps every rule of the table for both sides of the band and every curve of the
    /// base.
    #[test]
    fn both_sides_of_a_band_keep_every_rule_of_retention_drainage_and_placing() {
        let fines = [(0.002, 6.0), (0.02, 20.0), (0.075, 35.0)];
        let graded = [&fines[..], &[(0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)]].concat();
        let sand = [(0.1, 0.0), (0.3, 15.0), (1.2, 85.0), (3.0, 100.0)];
        for points in [&DESIGN_CLAY[..], &CORE, &graded, &DESIGN_SAND, &sand] {
            let [fine, coarse] = specified(points).band.unwrap().continued();
            // Slightly finer or coarser, so that no rounding breaks the limit itself.
            let sides = [("fine", fine, 1.0 + 1e-9), ("coarse", coarse, 1.0 - 1e-9)];
            let sides = sides.map(|(name, rows, hair)| {
                (name.to_owned(), Gradation::of_rows(&rows).unwrap().scaled(hair).unwrap())
            });
            let pair = PairRules::of_envelopes(&soil(points), &sides, PairOptions::default());
            let decision = pair.decision();
            for role in [RuleRole::Retention, RuleRole::Continuation, RuleRole::Drainage, RuleRole::Placing] {
                assert_eq!(decision.broken(role).next(), None, "{points:?}");
            }
            for id in ["sherard-dunnigan", "permeability", "filter-uniformity", "filter-band", "filter-fines"]
            {
                assert_eq!(met_of(&pair.rules, id), Some(true), "{id}: {points:?}");
            }
        }
    }

    /// The limit of a silt is 0.7 mm, or 0.5 mm if it is dispersive; with 25 % fines no source has a limit.
    #[test]
    fn a_base_of_which_nobody_has_said_whether_it_is_dispersive_has_the_limit_of_one_that_is() {
        let limit = |fines: f64, dispersive| {
            let silt = [(0.01, 0.0), (0.075, fines), (0.3, 92.0), (0.6, 100.0)];
            specified_if(&silt, dispersive).if_dispersive
        };
        let known = limit(45.0, None).unwrap();
        assert_eq!((known.d15f_max_mm, known.at_most, known.lacks), (0.5, false, None));
        let open = limit(25.0, None).unwrap();
        assert_eq!((open.at_most, open.lacks), (true, Some(DispersiveLack::AnyLimit)));
        // Few fines, and an explicit answer.
        assert_eq!([limit(10.0, None), limit(45.0, Some(true)), limit(45.0, Some(false))], [None; 3]);
    }

    /// The minimum D15F of 0.1 mm stays, and the maximum is lowered from 0.7 to 0.5 mm.
    #[test]
    fn a_finer_band_lowers_its_maximum_and_keeps_its_minimum() {
        let [coarser, finer] = [false, true].map(|finer| {
            let options = SpecificationOptions { finer, ..SpecificationOptions::default() };
            Specification::of("core", &soil(&CORE), options)
        });
        for (specified, [least, most]) in [(&coarser, [0.14, 0.7]), (&finer, [0.1, 0.5])] {
            let d15 = specified.band.as_ref().unwrap().d15_mm().map(Some);
            assert!(near(d15[0], least) && near(d15[1], most), "{d15:?}");
        }
        assert_eq!((finer.d15f_min_mm, finer.d15f_max_mm), (coarser.d15f_min_mm, coarser.d15f_max_mm));
        assert_eq!(finer.steps[6].notes, [StepNote::Lowered]);
        assert_eq!(coarser.steps[6].notes, [StepNote::Raised]);
        // The allowed sizes are equal: products do not depend on the position of the band.
        assert_eq!(finer.products, coarser.products);
    }

    /// Each rule for the fines of this base, with its numbers: 37.8 % fines and a D85B of 1.80 mm.
    #[test]
    fn the_step_of_retention_has_the_formula_of_the_category_with_its_numbers() {
        let formula =
            |points: &[(f64, f64)], dispersive| specified_if(points, dispersive).steps.swap_remove(4).formula;
        let begins = |formula: String, words: &str| {
            let rest = formula.strip_prefix("Sherard and Dunnigan's limit of design");
            assert!(rest.is_some_and(|rest| rest.starts_with(words)), "{formula}");
        };
        assert_eq!(
            formula(&REGRADED_TILL, None),
            "Sherard and Dunnigan's limit of design, category 3, A 15 to 40 %: (40 - A)/25 (4 D85B - 0.7) + \
             0.7 mm = (40 - 37.84)/25 (4 x 1.80 - 0.7) + 0.7 mm"
        );
        assert!(specified(&REGRADED_TILL).steps[4].source.starts_with("Sherard & Dunnigan (1989)"));
        begins(
            formula(&DESIGN_CLAY, None),
            ", category 1, A > 85 %: 9 D85B, not less than 0.2 mm = 9 x 0.0500, not less than 0.2 mm",
        );
        let clay = formula(&DESIGN_CLAY, Some(true));
        assert!(clay.contains("category 1, A > 85 %, dispersive: 6.4 D85B"), "{clay}");
        let sand = formula(&DESIGN_SAND, None);
        assert!(sand.ends_with(" of design, category 4, A < 15 %: 4 D85B = 4 x 0.500 mm"), "{sand}");
        // No text gives a limit for a dispersive soil of category 3.
        let silty = formula(&[(0.01, 0.0), (0.075, 25.0), (1.0, 85.0), (4.0, 100.0)], Some(true));
        let end = " mm (no text gives a limit for dispersive soils with such fines)";
        assert!(silty.ends_with(end), "{silty}");
        begins(
            silty,
            ", category 3, A 15 to 40 %, dispersive: at most (40 - A)/25 (4 D85B - 0.7) + 0.7 mm = \
             (40 - 25)/25",
        );
        // If the fines are not known, the formula is given whole.
        begins(formula(&[(0.2, 20.0), (0.5, 85.0), (1.0, 100.0)], None), ": A > 85 %: 9 D85B, ");
    }

    /// Straight sides with a Cu of 6: D'15/d'85 is 6^(15/50), and 4 D is 38.7 % higher.
    #[test]
    fn both_sides_of_the_band_are_checked_for_internal_stability() {
        let core = specified(&CORE);
        let last = core.steps.last().unwrap();
        assert_eq!(last.does, StepName::CheckStability);
        let of_coarse = |name: &str| value(&core, &format!("{name} of the coarse side"));
        // Percent over ln size: 45 % for a factor of 5.
        let slope = 45.0 / 5f64.ln();
        assert!(near(of_coarse("greatest D'15/d'85"), (15.0 / slope).exp()));
        assert!(near(of_coarse("least H/F"), slope * 4f64.ln() / 20.0));
        let stable = |side: &str, not_kept: &[&str]| StepNote::Stability {
            side: side.into(),
            is_known: true,
            not_kept: not_kept.iter().map(|name| (*name).into()).collect(),
        };
        assert_eq!(last.notes, [stable("fine", &[]), stable("coarse", &[])]);
        assert!(last.source.contains("Internal Instability") && core.notes.is_empty(), "{last:?}");
        // 0.705 mm retains, barely more than the 0.7 mm that drains: the fine side extends far out to its D5.
        let narrow = specified(&[(0.1, 0.0), (0.14, 15.0), (0.17625, 85.0), (0.3, 100.0)]);
        let [RowNote { row: None, note: Note::UnstableSide { side, authorities } }] = &narrow.notes[..]
        else {
            panic!("{:?}", narrow.notes)
        };
        assert_eq!((side.as_str(), &authorities[..]), ("fine", &["Kenney and Lau".to_owned()][..]));
        assert_eq!(narrow.steps.last().unwrap().notes[0], stable("fine", &["Kenney and Lau"]));
    }

    /// A side without its finer part still keeps the limit: D60F of the fine side is at most the maximum
    /// D15F, and the coarse side is straight and therefore stable.
    #[test]
    fn no_side_of_a_band_is_too_coarse_without_its_finer_part() {
        let is_of_side = |row: &&RowNote| matches!(row.note, Note::UnstableSide { .. });
        let mut unstable = 0;
        for scale in [0.8, 1.0, 4.0] {
            // A limit of four D85B, from below the draining size to far above it.
            for retains in [0.65, 0.7005, 0.705, 0.72, 0.8, 1.0, 2.0] {
                let sand = [(0.1, 0.0), (0.14, 15.0), (retains / 4.0, 85.0), (1.0, 100.0)];
                let points = sand.map(|(size, percent)| (scale * size, percent));
                let (sand, filter) = (curve(&points), specified(&points));
                unstable += filter.notes.iter().filter(is_of_side).count();
                for side in filter.band.iter().flat_map(SizeBand::continued) {
                    let side = Gradation::of_rows(&side).unwrap();
                    let side = side.scaled(1.0 - 1e-9).unwrap();
                    let washout = PairRules::of(&sand, &side).decision().washout.map(|washout| washout.left);
                    assert_eq!(washout, None, "{retains}");
                }
            }
        }
        assert!(unstable > 0);
    }
}
