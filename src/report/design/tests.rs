use super::*;
use crate::gradation::Gradation;
use crate::outcome::design::Boundary;
use crate::outcome::design::Specification;
use crate::outcome::design::band::{Band, SetBy};
use crate::outcome::design::products::Fit;
use crate::outcome::design::{BaseStated, DesignAnswer};
use crate::outcome::record::{AppliedRule, ModelLimit, RuleRole, SheetCover};
use crate::outcome::rules::DESIGN;
use crate::report::numbers::rounded_down;
use crate::store::format::DESIGN as DESIGN_FILE;
use crate::verdict::{PairRules, SpecificationOptions};

fn written(design: &Design, csv: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("design.json"), DESIGN_FILE.json(design).unwrap()).unwrap();
    std::fs::write(folder.path().join("design.csv"), csv).unwrap();
    let written = write_design(folder.path()).unwrap();
    assert!(written.page.ends_with("design.html"));
    std::fs::read_to_string(written.page).unwrap()
}

#[test]
fn a_product_is_said_to_fit_only_where_nothing_is_in_doubt() {
    let fit = |drains| Fit {
        name: if drains { "sand" } else { "clay" }.into(),
        d15_mm: [0.2, 0.4],
        drains,
        may_drain: false,
        holds: true,
        practice: None,
        source: String::new(),
    };
    let doubted = Design { products: vec![fit(true), fit(false)], ..design(None) };
    let said = |of: &Design| ["sand", "clay", "other"].map(|name| of.says_fit(name));
    assert_eq!(said(&doubted), [None, Some(false), None]);
    let by_practice = DesignAnswer { set_by: SetBy::Practice, ..doubted.answer() };
    let mut sure = Design { answer: Some(by_practice), ..doubted };
    sure.boundaries[0].no_erosion = Boundary::of(&[Ok(4.3), Ok(4.5)], Some(0.2));
    assert_eq!(said(&sure), [Some(true), Some(false), None]);
}

fn design(no_erosion: Option<Boundary>) -> Design {
    Design {
        specification: None,
        version: "1".into(),
        commit: None,
        answer: None,
        boundaries: vec![DesignRow {
            density: "<loose>".into(),
            thickness: "60 layers".into(),
            layers: 60,
            thickness_mm: None,
            grains_per_void: Some(0.61),
            no_erosion_note: no_erosion.is_none().then(|| "nothing erodes".into()),
            no_erosion,
            holds_to: None,
            continuing: None,
            continuing_note: None,
            unsteady: None,
            not_monotone: 0,
            networks: Vec::new(),
            band: None,
            band_note: None,
            as_end: None,
            end_of: None,
        }],
        inverse: false,
        base: BaseStated {
            name: "b".into(),
            cu: None,
            d15_mm: None,
            d85_mm: None,
            d95_over_d85: None,
            regraded_at_mm: None,
            tail_mass_fraction: 0.0,
            d85_as_sampled_mm: None,
            gradation: Vec::new(),
            regraded: Vec::new(),
        },
        filter: "f".into(),
        filter_cu: None,
        filter_d15_mm: None,
        filter_gradation: Vec::new(),
        inputs: Vec::new(),
        unit: "mm".into(),
        threshold: 0.075,
        replicates: 3,
        seed: 1,
        engine: "expected".into(),
        bracket: [0.5, 100.0],
        step: 0.005,
        findings: Vec::new(),
        rules: Vec::new(),
        rules_at: 4.0,
        products: Vec::new(),
        model_leaves_out: vec![ModelLimit::Supply],
        settings: Vec::new(),
        cover: SheetCover::default(),
        inches: false,
        seconds: 1.0,
    }
}

const CSV: &str = "density,thickness,network,d15f_over_d85b,eroded_first,eroded_second,d85b_of\n\
                   <loose>,60 layers,1,4.0,0.01,,\n<loose>,60 layers,1,5.0,0.5,0.4,\n";

/// A percentile of few networks would lie between two of them.
#[test]
fn of_few_networks_the_page_has_least_and_most() {
    use crate::outcome::design::NetworkBoundaries;
    let of = |ratios: &[f64]| {
        let networks: Vec<_> = ratios.iter().map(|ratio| Ok(*ratio)).collect();
        let mut design = design(Boundary::of(&networks, Some(0.2)));
        design.base.d85_mm = Some(0.2);
        design.replicates = ratios.len() as u64;
        let network =
            |ratio: &f64| NetworkBoundaries { network: 1, no_erosion: Some(*ratio), continuing: None };
        design.boundaries[0].networks = ratios.iter().map(network).collect();
        written(&design, CSV)
    };
    let few = of(&[4.0, 4.4, 6.0]);
    assert!(few.contains(" in the median of 3 networks (4.00 to 6.00, least and most): "), "{few}");
    assert!(few.contains("median of 3 networks (in brackets least and most); below it the D15F"), "{few}");
    assert!(few.contains("blend over the interpolated 5 to 95 % range of the networks."), "{few}");
    let one = of(&[4.4]);
    assert!(
        one.contains(" on one network: ") && one.contains(", of one network; below it the D15F"),
        "{one}"
    );
    assert!(!one.contains("least and most") && !one.contains("5 to 95 %"), "{one}");
    let many = of(&[4.0, 4.4, 4.8, 5.2].repeat(5));
    assert!(many.contains("in the median of 20 networks (4.00 to 5.20, 5 to 95 % range): "), "{many}");
}

#[test]
fn only_what_was_checked_is_green_and_names_are_inert() {
    let boundary = || {
        let networks = [Ok(4.3), Ok(4.5)];
        Boundary::of(&networks, Some(0.2))
    };
    let design = |boundary| {
        let mut design = design(boundary);
        design.base.d85_mm = Some(0.2);
        design
    };
    let page = written(&design(boundary()), CSV);
    // The walk alone sets no specification.
    assert!(page.contains("verdict doubted") && page.contains("D15F up to 0.862 mm"), "{page}");
    assert!(page.contains("&lt;loose&gt;") && !page.contains("<loose>"));
    assert!(
        page.contains("default-src 'none'") && page.contains("The model leaves out: a limit to what enters")
    );
    let none = written(&design(None), CSV);
    assert!(none.contains("verdict undecided") && none.contains("Nothing erodes."));
}

#[test]
fn a_filter_that_holds_all_that_was_searched_says_so_and_is_not_green() {
    let mut design = design(None);
    design.boundaries[0].holds_to = Some(1.08);
    let page = written(&design, CSV);
    assert!(page.contains("Holds as far as was searched: D15F up to 1.08 D85B"), "{page}");
    assert!(page.contains("verdict doubted") && !page.contains("No ratio is known"));
    design.base.d85_mm = Some(0.5);
    assert!(written(&design, CSV).contains("Holds as far as was searched: D15F up to 0.540 mm"));
}

#[test]
fn the_figure_is_of_the_row_that_counts_and_its_limits_are_those_of_the_rules() {
    let gap = [(0.1, 0.0), (0.2, 20.0), (0.5, 50.0), (4.0, 55.0), (9.5, 80.0), (19.0, 100.0)];
    let base = Gradation::from_lines(&gap).unwrap();
    let (d85, part) = (base.d(85.0).unwrap(), base.regraded().gradation.d(85.0).unwrap());
    let of = |ratio: f64| Boundary::of(&[Ok(ratio), Ok(ratio)], Some(d85));
    let mut design = design(of(5.0));
    let loose = DesignRow { density: "loosest".into(), no_erosion: of(3.0), ..design.boundaries[0].clone() };
    design.boundaries.push(loose);
    design.base.d85_mm = Some(d85);
    let filter = Gradation::linear_from_dx(15.0, design.rules_at * d85, 1.5).unwrap();
    design.rules = PairRules::of(&base, &filter).rules;
    let page = written(&design, &format!("{CSV}loosest,60 layers,1,3.0,0.01,,\n"));
    assert!(page.contains("Base eroded against D15F: loosest, 60 layers"), "{page}");
    assert!(page.contains("this one holds least"));
    let terzaghi = |d85b: f64| format!("Terzaghi: the filter retains the base {}", rounded_down(4.0 * d85b));
    assert!(page.contains(&terzaghi(part)) && !page.contains(&terzaghi(d85)), "{page}");
}

/// 30 % pass the finest sieve: of the limit of practice only the most is known.
#[test]
fn a_limit_of_which_only_the_most_is_known_makes_nothing_green() {
    let points = [(0.25, 30.0), (0.5, 45.0), (1.0, 60.0), (2.0, 90.0), (4.0, 100.0)];
    let base = Gradation::from_lines(&points).unwrap();
    let d85 = base.d(85.0).unwrap();
    let of = |ratio: f64| Boundary::of(&[Ok(ratio), Ok(ratio)], Some(d85));
    let mut open = design(of(3.0));
    open.base.d85_mm = Some(d85);
    let filter = Gradation::linear_from_dx(15.0, 3.0 * d85, 1.5).unwrap();
    (open.rules, open.rules_at) = (PairRules::of(&base, &filter).rules, 3.0);
    assert!(open.answer().said.starts_with("The maximum D15F is not known"));
    let csv = CSV.replace("4.0,", "2.0,");
    let page = written(&open, &csv);
    assert!(page.contains("verdict doubted") && !page.contains("verdict none"), "{page}");
    assert!(page.contains(">practice not known<") && page.contains("Nothing is green"), "{page}");
    assert!(!page.contains(">no erosion<") && page.contains("design, at most"), "{page}");
    assert!(page.contains("at most 7.") && !page.contains("the filter retains the base 7."), "{page}");
    // Whose fines are known is drawn green as far as practice allows.
    let mut known = open.clone();
    for rule in &mut known.rules {
        (rule.limit_at_most, rule.met) = (false, Some(true));
    }
    let page = written(&known, &csv);
    assert!(page.contains(">no erosion<"), "{page}");
    // For the inverse practice allows what its answer says, and no more.
    let answer = |ratio: Option<f64>, rule: Option<&str>| DesignAnswer {
        d15f_max_mm: None,
        d85b_min_mm: None,
        d15f_over_d85b: ratio,
        set_by: SetBy::Practice,
        rule: rule.map(str::to_owned),
        limit: String::new(),
        washout: None,
        margin: None,
        walk: None,
        if_dispersive: None,
        said: "s".into(),
    };
    let inverse = |answer| Design { inverse: true, answer: Some(answer), ..known.clone() };
    let page = written(&inverse(answer(Some(2.5), Some(DESIGN))), &csv);
    assert!(page.contains(">no erosion<") && page.contains(">beyond practice<"), "{page}");
    let page = written(&inverse(answer(None, Some(DESIGN))), &csv);
    assert!(!page.contains(">no erosion<") && page.contains(">beyond practice<"), "{page}");
    let page = written(&inverse(answer(None, None)), &csv);
    assert!(!page.contains(">no erosion<") && page.contains(">practice not known<"), "{page}");
}

/// A number of the walk stands in bold where the walk decides, and in plain weight below a limit of practice.
#[test]
fn a_boundary_that_does_not_decide_is_not_in_bold() {
    let silt = Gradation::from_lines(&[(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)]).unwrap();
    let d85 = silt.d(85.0).unwrap();
    let with = |ratio: f64| {
        let mut of = design(Boundary::of(&[Ok(ratio), Ok(ratio)], Some(d85)));
        of.base.d85_mm = Some(d85);
        let filter = Gradation::linear_from_dx(15.0, of.rules_at * d85, 1.5).unwrap();
        of.rules = PairRules::of(&silt, &filter).rules;
        let bases = [("silt".to_owned(), silt.clone())];
        of.specification = Some(Specification::of("silt", &bases, SpecificationOptions::default()));
        of
    };
    let beyond = written(&with(40.0), CSV);
    assert!(beyond.contains("40.00") && !beyond.contains("<b>40.00</b>"), "{beyond}");
    let sheet = beyond.split("Other findings").next().unwrap();
    assert!(sheet.contains("The walk sets no tighter limit, and is no check of it"));
    let said = "This limit has no margin: it is the lower end of the range in which tests put the boundary \
                of no erosion";
    assert!(sheet.contains(said));
    // What the walk decides: 2 D85B are 0.49 mm.
    let decides = written(&with(2.0), CSV);
    assert!(decides.contains("<b>2.00</b>"), "{decides}");
    assert!(!decides.contains("thicker filters hold more"));
    // Nobody decides where the limit of practice is known only as the most that it can be.
    let mut open = with(40.0);
    let retains = |rule: &&mut AppliedRule| rule.role == RuleRole::Retention && rule.applies;
    open.rules.iter_mut().find(retains).unwrap().limit_at_most = true;
    open.specification = None;
    assert_eq!((open.answer().set_by, open.answer().d15f_over_d85b), (SetBy::Walk, None));
    let page = written(&open, CSV);
    assert!(page.contains("40.00") && !page.contains("<b>40.00</b>"), "{page}");
}

/// The limit of practice is 0.8069 mm, the walk holds to 0.8068 mm, and 0.7051 mm drain.
#[test]
fn limits_are_rounded_inward_wherever_the_page_has_them() {
    let sand = |size| Gradation::linear_from_dx(15.0, size, 1.5).unwrap();
    let rules = PairRules::of(&sand(0.15), &sand(0.8)).rules.into_iter();
    let rules = rules.filter(|rule| rule.id == DESIGN);
    let mut design = design(Boundary::of(&[Ok(4.034), Ok(4.034)], Some(0.2)));
    design.rules = rules.map(|rule| AppliedRule { limit: Some(0.8069), ..rule }).collect();
    design.base.d85_mm = Some(0.2);
    let band = Band {
        least: 0.7051,
        least_at_most: false,
        greatest: 0.8068,
        set_by: SetBy::Walk,
        practice: Some(0.8069),
        practice_rule: "r".into(),
        practice_rule_id: None,
        unit: "mm".into(),
        is_empty: false,
        said: "D15F from 0.706 to 0.806 mm".into(),
    };
    design.boundaries[0].band = Some(band);
    let csv = CSV.replace("4.0,", "3.9,");
    let page = written(&design, &csv);
    assert!(page.contains("D15F up to 0.806 mm") && page.contains("Practice allows up to 0.806 mm"));
    assert!(page.contains(" 0.806 mm.</figcaption>") && page.contains(">0.706 mm<"), "{page}");
    assert!(!page.contains("0.807") && !page.contains("0.705"), "{page}");
    design.inches = true;
    let page = written(&design, &csv).replace("\u{202f}mm", " mm");
    // 0.806 mm are 0.03173 in, and 0.706 mm 0.02780 in.
    let inches = |mm: &str| page.match_indices(&format!("{mm} mm (")).count();
    assert!(inches("0.806") > 3 && inches("0.706") > 0);
    assert_eq!(inches("0.806"), page.matches("0.0317\u{202f}in").count(), "{page}");
    assert!(page.contains("0.706 mm (0.0278\u{202f}in)"), "{page}");
}

#[test]
fn a_folder_that_was_changed_is_refused_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let text = DESIGN_FILE.json(&design(None)).unwrap();
    std::fs::write(folder.path().join("design.json"), text).unwrap();
    std::fs::write(folder.path().join("design.csv"), CSV.replace("0.01", "much")).unwrap();
    let error = write_design(folder.path()).unwrap_err().to_string();
    assert!(error.contains("design.csv") && error.contains('2'), "{error}");
    std::fs::remove_file(folder.path().join("design.json")).unwrap();
    assert!(write_design(folder.path()).unwrap_err().to_string().contains("design.json"));
}
