//! Specifications against calculations by hand.

use super::*;
use crate::design::RowNote;
use crate::design::specification::{StepName, StepNote};
use crate::{DispersiveLack, Note, RuleNote, RuleRole};
use crate::{PairOptions, PairRules};
use voidwalk_core::gradation::{GAP_PERCENT, Gradation};

fn soil(points: &[(f64, f64)]) -> Gradation {
    Gradation::from_lines(points).unwrap()
}

fn specified(points: &[(f64, f64)]) -> Specification {
    Specification::of("base", &[("base".into(), soil(points))], SpecificationOptions::default())
}

fn near(value: Option<f64>, wanted: f64) -> bool {
    value.is_some_and(|value| (value / wanted - 1.0).abs() < 1e-9)
}

fn value(specified: &Specification, name: &str) -> Option<f64> {
    let all = specified.steps.iter().flat_map(|step| &step.values);
    all.filter(|value| value.name == name).find_map(|value| value.value)
}

/// A core of category 2: 0.7 mm and the least of 0.1 mm, whose ratio of 7 is narrowed to 5.
#[test]
fn a_core_with_60_percent_of_fines_by_hand() {
    let core = specified(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]);
    assert_eq!(core.curves[0].category, Some(2));
    assert!(near(core.d15f_max_mm, 0.7) && near(core.d15f_min_mm, 0.1));
    assert!(near(value(&core, "minimum D15F of the band"), 0.14));
    assert!(near(value(&core, "maximum D10F"), 0.7 / 1.2));
    assert!(near(value(&core, "maximum D60F"), 3.5) && near(value(&core, "minimum D60F"), 0.7));
    assert!(near(value(&core, "minimum D10F"), 0.14 / 1.2));
    let sizes = &core.band.as_ref().unwrap().sizes;
    assert_eq!(sizes.iter().map(|size| size.percent).collect::<Vec<_>>(), [5.0, 15.0, 60.0]);
    assert_eq!(core.steps.iter().map(|step| step.step).collect::<Vec<_>>(), (1..=12).collect::<Vec<_>>());
    assert!(core.no_band.is_none() && core.nearest_product().is_none());
    assert!(core.products[0].fits() == Some(true) && core.products[1].fits() == Some(false));
}

/// Categories 1, 3 and 4, and a dispersive clay.
#[test]
fn the_limits_of_the_other_categories_by_hand() {
    let clay = [(0.001, 0.0), (0.02, 60.0), (0.05, 85.0), (0.075, 90.0), (0.3, 100.0)];
    assert!(near(specified(&clay).d15f_max_mm, 9.0 * 0.05));
    let options = SpecificationOptions { dispersive: Some(true), ..Default::default() };
    let dispersive = Specification::of("clay", &[("clay".into(), soil(&clay))], options);
    assert!(near(dispersive.d15f_max_mm, 6.4 * 0.05) && dispersive.dispersive);
    let silty = specified(&[(0.01, 0.0), (0.075, 25.0), (1.0, 85.0), (4.0, 100.0)]);
    assert!(near(silty.d15f_max_mm, (40.0 - 25.0) / 25.0 * (4.0 - 0.7) + 0.7));
    let sand = specified(&[(0.1, 0.0), (0.2, 15.0), (0.5, 85.0), (1.0, 100.0)]);
    assert!(near(sand.d15f_max_mm, 2.0) && near(sand.d15f_min_mm, 1.0));
    // The ratio of 2 needs no narrowing.
    assert!(near(value(&sand, "minimum D15F of the band"), 1.0));
}

/// The till of the first trial: D85B 1.53 mm on No. 4, 38 % of fines.
#[test]
fn a_till_is_regraded_and_its_limit_is_that_of_design() {
    let till = specified(&[(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)]);
    let fines: f64 = 35.0 / 0.92;
    assert!(near(value(&till, "fines A, finer than 0.075 mm"), fines));
    assert_eq!(value(&till, "regraded on"), Some(4.75));
    let d85b = till.curves[0].d85_mm.unwrap();
    let design = (40.0 - fines) / 25.0 * (4.0 * d85b - 0.7) + 0.7;
    assert!(near(till.d15f_max_mm, design) && near(value(&till, "maximum D15F by practice"), design));
    // D15B is finer than the finest sieve: the limit is at most five times the sieve.
    assert!(near(till.d15f_min_mm, 5.0 * 0.075));
}

/// If the fine side is flatter than the factor says, its own D10 counts.
#[test]
fn the_least_d10f_is_that_of_the_fine_side_where_that_is_finer() {
    // D15F of 1 to 2 mm: D5 of the fine side is a fifth of 2 x 5^(-10/45).
    let sand = specified(&[(0.1, 0.0), (0.2, 15.0), (0.5, 85.0), (1.0, 100.0)]);
    let d10 = (2.0 * 5f64.powf(-10.0 / 45.0) / 5.0).sqrt();
    assert!(d10 < 1.0 / 1.2 && near(value(&sand, "minimum D10F"), d10), "{d10}");
    let sources = [7, 9, 10].map(|at| sand.steps[at].source.as_str());
    assert!(sources.iter().all(|source| source.contains("this program")), "{sources:?}");
}

#[test]
fn what_set_the_answer_and_that_the_band_was_narrowed_is_recorded() {
    let core = specified(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]);
    assert_eq!(core.set_by(), Some(core.curves[0].d15f_max_rule.as_str()));
    assert_eq!(core.steps[6].notes, [StepNote::Raised]);
    // The ratio of 2 needs no raising.
    let sand = specified(&[(0.1, 0.0), (0.2, 15.0), (0.5, 85.0), (1.0, 100.0)]);
    assert_eq!(sand.steps[6].notes, []);
}

#[test]
fn the_step_of_gravel_and_gap_answers_both() {
    let flattest = |points: &[(f64, f64)]| match specified(points).steps[1].notes[..] {
        [StepNote::Gravel { curve: None, flattest: Some(flattest), .. }] => flattest,
        ref notes => panic!("{notes:?}"),
    };
    let [from, within] = flattest(&[(0.08, 0.0), (0.3, 40.0), (2.4, 41.0), (4.0, 100.0)]);
    assert!(near(Some(from), 0.3) && within < GAP_PERCENT, "{within}");
    // 12 % over a factor of 8.33.
    let [from, within] = flattest(&[(0.08, 10.0), (0.6, 59.0), (5.0, 71.0), (20.0, 100.0)]);
    assert!(near(Some(from), 0.6) && near(Some(within), 12.0 * 4f64.ln() / (5.0f64 / 0.6).ln()), "{within}");
    // 5 % is cited under our name alone.
    let source = specified(&[(0.1, 0.0), (0.5, 100.0)]).steps[1].source.clone();
    assert!(source.ends_with("The check for a gap is this program's own"), "{source}");
}

/// The base of a sheet that is signed: unstable, broad, and flat between 0.6 and 5 mm.
#[test]
fn what_is_wrong_with_the_base_itself_is_among_the_notes() {
    let notes =
        |specified: &Specification| specified.notes.iter().map(|row| row.note.clone()).collect::<Vec<_>>();
    let points = [(0.002, 5.0), (0.075, 29.0), (0.6, 59.0), (5.0, 71.0), (20.0, 100.0)];
    let broad = notes(&specified(&points));
    // Regraded on 0.6 mm: 49.2 % of fines, and so 0.7 mm, as on No. 4: no other limit is noted.
    assert!(
        matches!(broad[..], [Note::UnstableBase { index, .. }, Note::BroadBase { .. }, Note::FlatBase { .. }]
            if index < 1.0),
        "{broad:?}"
    );
    let gap = notes(&specified(&[(0.08, 0.0), (0.3, 40.0), (2.4, 41.0), (4.0, 100.0)]));
    assert!(gap.iter().any(|note| matches!(note, Note::GapOfBase { .. })), "{gap:?}");
    assert_eq!(notes(&specified(&[(0.1, 0.0), (0.5, 100.0)])), []);
    // With several curves each note names its own.
    let sand = soil(&[(0.1, 0.0), (0.5, 100.0)]);
    let both = [("sand".to_owned(), sand), ("till".to_owned(), soil(&points))];
    let both = Specification::of("site", &both, SpecificationOptions::default());
    let rows: Vec<_> = both.notes.iter().map(|row| row.row.as_deref()).collect();
    assert_eq!(rows, [Some("till"), Some("till"), Some("till"), None]);
    // The note of the band covers all curves: 0.636 to 0.700 mm, with a fine side that runs far out to its
    // D5.
    assert!(matches!(notes(&both)[3], Note::UnstableSide { .. }), "{:?}", both.notes);
}

#[test]
fn of_several_curves_the_strictest_limit_of_each_counts() {
    let curves: Vec<NamedCurve> = vec![
        ("fine".into(), soil(&[(0.1, 0.0), (0.15, 15.0), (0.4, 85.0), (1.0, 100.0)])),
        ("coarse".into(), soil(&[(0.1, 0.0), (0.2, 15.0), (0.8, 85.0), (2.0, 100.0)])),
    ];
    let both = Specification::of("site", &curves, SpecificationOptions::default());
    assert!(near(both.d15f_max_mm, 1.6) && near(both.d15f_min_mm, 1.0));
    let limits: Vec<_> = both.curves.iter().map(|curve| curve.d15f_max_mm.unwrap()).collect();
    assert!((limits[1] / limits[0] - 2.0).abs() < 1e-9, "{limits:?}");
    let [StepNote::SetBy { rule: Some(rule), curve }] = &both.steps[4].notes[..] else {
        panic!("{:?}", both.steps[4])
    };
    assert_eq!((Some(rule.as_str()), curve.as_deref()), (both.set_by(), Some("fine")));
    assert_eq!(both.steps[5].notes[0], StepNote::SetBy { rule: None, curve: Some("coarse".into()) });
    assert!(value(&both, "D15B of coarse").is_some());
}

#[test]
fn without_a_known_limit_or_room_between_both_there_is_no_band_and_it_is_said_why() {
    // 20 % finer than 0.2 mm: fines, and so the category, are not known.
    let open = specified(&[(0.2, 20.0), (0.5, 85.0), (1.0, 100.0)]);
    assert!(open.nearest_product().is_none());
    assert!(open.band.is_none() && open.d15f_max_mm.is_none() && open.limits.is_empty());
    let needs = vec![RuleNote::NeedsFinesOfBase];
    assert_eq!(open.no_band, Some(NoBand::LimitNotKnown { curve: "base".into(), needs }));
    // A sand of one size: 5 D15B is more than 4 D85B.
    let uniform = specified(&[(0.4, 0.0), (0.5, 100.0)]);
    let Some(NoBand::NoneDrainsAndRetains { least_mm, most_mm }) = uniform.no_band else {
        panic!("{uniform:?}")
    };
    assert!(uniform.band.is_none() && near(uniform.d15f_min_mm, least_mm) && least_mm > most_mm);
    // A gravel whose filter would consist of stones.
    let gravel = specified(&[(5.0, 0.0), (6.0, 15.0), (9.0, 85.0), (12.0, 100.0)]);
    assert!(matches!(gravel.no_band, Some(NoBand::TooCoarse { most_d60f_mm }) if most_d60f_mm > 75.0));
}

/// A dispersive clay whose limit is 6.4 D85B, 0.103 mm.
#[test]
fn a_coarse_side_with_too_many_fines_leaves_no_band() {
    let clay = [("clay".to_owned(), soil(&[(0.0008, 0.0), (0.0161, 85.0), (0.03, 100.0)]))];
    let options = SpecificationOptions { dispersive: Some(true), ..Default::default() };
    let narrow = Specification::of("clay", &clay, options);
    assert!(narrow.band.is_none() && narrow.limits.is_empty());
    assert_eq!(narrow.no_band, Some(NoBand::TooManyFines));
}

/// A specification keeps every rule of the table: both sides of the band, against every curve of the base.
#[test]
fn both_sides_of_a_band_keep_every_rule_of_retention_drainage_and_placing() {
    let bases: [&[(f64, f64)]; 5] = [
        &[(0.001, 0.0), (0.02, 60.0), (0.05, 85.0), (0.075, 90.0), (0.3, 100.0)],
        &[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)],
        &[(0.002, 6.0), (0.02, 20.0), (0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)],
        &[(0.1, 0.0), (0.2, 15.0), (0.5, 85.0), (1.0, 100.0)],
        &[(0.1, 0.0), (0.3, 15.0), (1.2, 85.0), (3.0, 100.0)],
    ];
    for points in bases {
        let band = specified(points).band.unwrap();
        let side = |rows: &[[f64; 2]]| Gradation::of_rows(rows).unwrap();
        let [fine, coarse] = band.continued();
        let sides = [("fine".to_owned(), side(&fine)), ("coarse".to_owned(), side(&coarse))];
        // Slightly finer, so that no rounding breaks the limit itself.
        let sides = sides.map(|(name, curve)| {
            let hair = if name == "coarse" { 1.0 - 1e-9 } else { 1.0 + 1e-9 };
            (name, curve.scaled(hair).unwrap())
        });
        let base = [("base".to_owned(), soil(points))];
        let pair = PairRules::of_envelopes(&base, &sides, PairOptions::default());
        let (rules, decision) = (&pair.rules, pair.decision());
        for role in [RuleRole::Retention, RuleRole::Continuation, RuleRole::Drainage, RuleRole::Placing] {
            assert_eq!(decision.broken(role).next(), None, "{points:?}");
        }
        let met = |id: &str| rules.iter().find(|rule| rule.id == id).unwrap().met;
        for id in ["sherard-dunnigan", "permeability", "filter-uniformity", "filter-band", "filter-fines"] {
            assert_eq!(met(id), Some(true), "{id}: {points:?}");
        }
    }
}

/// Practice has 0.7 mm for a silt, and 0.5 mm if it is dispersive; with 25 % fines no source has a limit.
#[test]
fn a_base_of_which_nobody_has_said_whether_it_is_dispersive_has_the_limit_of_one_that_is() {
    let silt = [(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)];
    let limit = |points: &[(f64, f64)], dispersive| {
        let options = SpecificationOptions { dispersive, ..Default::default() };
        Specification::of("silt", &[("silt".into(), soil(points))], options).if_dispersive
    };
    let known = limit(&silt, None).unwrap();
    assert_eq!((known.d15f_max_mm, known.at_most, known.lacks), (0.5, false, None));
    let open = limit(&[(0.01, 0.0), (0.075, 25.0), (0.3, 92.0), (0.6, 100.0)], None).unwrap();
    assert_eq!((open.at_most, open.lacks), (true, Some(DispersiveLack::AnyLimit)));
    // Few fines, and an explicit answer.
    assert_eq!(limit(&[(0.01, 0.0), (0.075, 10.0), (0.3, 92.0), (0.6, 100.0)], None), None);
    assert_eq!([Some(true), Some(false)].map(|dispersive| limit(&silt, dispersive)), [None, None]);
}

/// D15F of at most 6.4 D85B, here 0.064 mm, is less than any filter may have.
#[test]
fn a_base_that_is_too_fine_has_no_filter() {
    let clay = soil(&[(0.0005, 0.0), (0.01, 85.0), (0.02, 100.0)]);
    let options = SpecificationOptions { dispersive: Some(true), ..Default::default() };
    let specified = Specification::of("clay", &[("clay".into(), clay)], options);
    let Some(NoBand::NoneDrainsAndRetains { least_mm, most_mm }) = specified.no_band else {
        panic!("{specified:?}")
    };
    assert!(near(Some(least_mm), 0.1) && near(Some(most_mm), 0.064), "{least_mm} {most_mm}");
}

/// The minimum D15F of 0.1 mm stays, and the maximum is lowered from 0.7 to 0.5 mm.
#[test]
fn a_finer_band_lowers_its_maximum_and_keeps_its_minimum() {
    let core = soil(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]);
    let specified = |finer| {
        let options = SpecificationOptions { finer, ..Default::default() };
        Specification::of("core", &[("core".into(), core.clone())], options)
    };
    let [coarser, finer] = [false, true].map(specified);
    let d15 = |specified: &Specification| specified.band.as_ref().unwrap().d15_mm();
    let near = |values: [f64; 2], wanted: [f64; 2]| {
        values.iter().zip(wanted).all(|(value, wanted)| (value / wanted - 1.0).abs() < 1e-9)
    };
    assert!(near(d15(&coarser), [0.14, 0.7]) && near(d15(&finer), [0.1, 0.5]));
    assert_eq!((finer.d15f_min_mm, finer.d15f_max_mm), (coarser.d15f_min_mm, coarser.d15f_max_mm));
    assert_eq!(finer.steps[6].notes, [StepNote::Lowered]);
    assert_eq!(coarser.steps[6].notes, [StepNote::Raised]);
    // The allowed sizes are equal: products do not depend on the place of the band.
    assert_eq!(finer.products, coarser.products);
}

/// Each rule for the fines of this base, with its numbers: 37.8 % of fines and a D85B of 1.80 mm.
#[test]
fn the_step_of_retention_has_the_formula_of_the_category_with_its_numbers() {
    let formula = |points: &[(f64, f64)]| specified(points).steps[4].formula.clone();
    let till = [(0.075, 28.0), (0.15, 37.0), (0.425, 48.0), (0.85, 55.0), (2.0, 64.0), (4.75, 74.0)];
    let till: Vec<(f64, f64)> = till.into_iter().chain([(9.5, 82.0), (19.0, 89.0), (37.5, 100.0)]).collect();
    assert_eq!(
        formula(&till),
        "Sherard and Dunnigan's limit of design, category 3, A 15 to 40 %: (40 - A)/25 (4 D85B - 0.7) + 0.7 \
         mm = (40 - 37.84)/25 (4 x 1.80 - 0.7) + 0.7 mm"
    );
    assert!(specified(&till).steps[4].source.starts_with("Sherard & Dunnigan (1989)"));
    let clay = [(0.001, 0.0), (0.02, 60.0), (0.05, 85.0), (0.075, 90.0), (0.3, 100.0)];
    assert!(
        formula(&clay).starts_with(
            "Sherard and Dunnigan's limit of design, category 1, A > 85 %: 9 D85B, not less than 0.2 mm = 9 \
             x 0.0500, not less than 0.2 mm"
        ),
        "{}",
        formula(&clay)
    );
    let sand = formula(&[(0.1, 0.0), (0.2, 15.0), (0.5, 85.0), (1.0, 100.0)]);
    assert_eq!(sand, "Sherard and Dunnigan's limit of design, category 4, A < 15 %: 4 D85B = 4 x 0.500 mm");
    let options = SpecificationOptions { dispersive: Some(true), ..Default::default() };
    let dispersive = |points: &[(f64, f64)]| {
        Specification::of("clay", &[("clay".into(), soil(points))], options).steps[4].formula.clone()
    };
    assert!(
        dispersive(&clay).contains("category 1, A > 85 %, dispersive: 6.4 D85B"),
        "{}",
        dispersive(&clay)
    );
    // No text gives a limit for a dispersive soil of category 3.
    let silty = dispersive(&[(0.01, 0.0), (0.075, 25.0), (1.0, 85.0), (4.0, 100.0)]);
    assert!(
        silty
            .contains("A 15 to 40 %, dispersive: at most (40 - A)/25 (4 D85B - 0.7) + 0.7 mm = (40 - 25)/25")
            && silty.contains(" mm (no text gives a limit for dispersive soils with such fines)"),
        "{silty}"
    );
    // Unknown fines leave the formula whole.
    let open = formula(&[(0.2, 20.0), (0.5, 85.0), (1.0, 100.0)]);
    assert!(open.contains("limit of design: A > 85 %: 9 D85B, "), "{open}");
}

/// Straight sides of a Cu of 6: D'15/d'85 is 6^(15/50), and 4 D is 38.7 % further up.
#[test]
fn both_sides_of_the_band_are_checked_for_internal_stability() {
    let core = specified(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]);
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
    // 0.705 mm retain barely more than the 0.7 mm that drain: the fine side runs far out to its D5.
    let narrow = specified(&[(0.1, 0.0), (0.14, 15.0), (0.17625, 85.0), (0.3, 100.0)]);
    let [RowNote { row: None, note: Note::UnstableSide { side, authorities } }] = &narrow.notes[..] else {
        panic!("{:?}", narrow.notes)
    };
    assert_eq!((side.as_str(), &authorities[..]), ("fine", &["Kenney and Lau".to_owned()][..]));
    assert_eq!(narrow.steps.last().unwrap().notes[0], stable("fine", &["Kenney and Lau"]));
}

/// A side that loses its finer part still keeps the limit: D60F of the fine side is no more than the maximum
/// D15F, and the coarse side is straight, which is stable.
#[test]
fn no_side_of_a_band_is_too_coarse_without_its_finer_part() {
    let is_of_side = |row: &&RowNote| matches!(row.note, Note::UnstableSide { .. });
    let mut unstable = 0;
    for scale in [0.8, 1.0, 4.0] {
        // A limit of four D85B, from less than the draining size to much more.
        for retains in [0.65, 0.7005, 0.705, 0.72, 0.8, 1.0, 2.0] {
            let sand = [(0.1, 0.0), (0.14, 15.0), (retains / 4.0, 85.0), (1.0, 100.0)];
            let points = sand.map(|(size, percent)| (scale * size, percent));
            let (sand, filter) = (soil(&points), specified(&points));
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
