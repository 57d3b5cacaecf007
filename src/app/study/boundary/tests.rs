//! Boundaries of small lattices, compared with scans by hand and with other sizes, brackets and threads.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use super::search::Ended;
use super::*;
use crate::outcome::boundary::{BoundaryRow, Range};
use crate::run::prepare::PrepareOptions;
use crate::run::{case_of, walk_case};
use voidwalk_core::gradation::Gradation;
use voidwalk_practice::design::RowNote;

/// Lattice that takes moments, and few networks.
const SMALL: [&str; 3] = ["network.nx=9", "network.ny=9", "replicates=3"];

/// Layers of the small lattice, where no thickness is asked for.
const LAYERS: &str = "network.nz=10";

/// D15F/D85B between which these tests search.
pub(super) const SHORT: [f64; 2] = [0.8, 30.0];

/// Options with all of these settings; the later of two counts.
fn with_settings(out: &Path, all: &[&str]) -> BoundaryOptions {
    let mut settings: Vec<String> = Vec::new();
    for setting in all {
        settings.retain(|before| setting_name(before) != setting_name(setting));
        settings.push((*setting).to_owned());
    }
    BoundaryOptions { out: out.to_owned(), settings, ..BoundaryOptions::default() }
}

pub(super) fn options(out: &Path, more: &[&str]) -> BoundaryOptions {
    with_settings(out, &[&SMALL, more].concat())
}

pub(super) fn tiny(out: &Path, more: &[&str]) -> BoundaryOptions {
    let lattice = ["network.nx=6", "network.ny=6", "replicates=5", "base.cu=1.5"];
    with_settings(out, &[&lattice, more].concat())
}

pub(super) fn searched(options: &BoundaryOptions) -> Boundaries {
    found_within(options, SHORT)
}

pub(super) fn found_within(options: &BoundaryOptions, bracket: [f64; 2]) -> Boundaries {
    run_within(options, bracket, &Callbacks::default()).unwrap()
}

/// Error of a search that is stopped once it reports these words.
pub(super) fn stopped(options: &BoundaryOptions, words: &str) -> RunError {
    let stop = AtomicBool::new(false);
    let on_event = |event: Event| {
        if matches!(event, Event::Studying(text) if text.contains(words)) {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let callbacks = Callbacks { on_event: &on_event, stop: &stop, ..Callbacks::default() };
    run_within(options, SHORT, &callbacks).unwrap_err()
}

pub(super) fn of_base(folder: &Path, name: &str, points: &[(f64, f64)]) -> PathBuf {
    let rows: String = points.iter().map(|(d, percent)| format!("{d},{percent}\n")).collect();
    let path = folder.join(name);
    std::fs::write(&path, format!("opening_mm,percent_finer\n{rows}")).unwrap();
    path
}

/// Results that do not depend on the clock.
pub(super) fn timeless(all: &Boundaries) -> String {
    serde_json::to_string(&Boundaries { seconds: 0.0, ..all.clone() }).unwrap()
}

#[test]
fn a_base_twice_as_large_takes_a_filter_twice_as_large_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let points = [(0.063, 0.0), (0.125, 30.0), (0.25, 80.0), (0.5, 100.0)];
    let row = |name: &str, factor: f64| {
        let base = of_base(folder.path(), name, &points.map(|(d, percent)| (factor * d, percent)));
        let options = options(&folder.path().join(name.replace('.', "-")), &[LAYERS]);
        searched(&BoundaryOptions { base: Some(base), ..options }).boundaries.remove(0)
    };
    let (one, two) = (row("one.csv", 1.0), row("two.csv", 2.0));
    assert_eq!(one.networks, two.networks);
    for (a, b) in [(&one.no_erosion, &two.no_erosion), (&one.continuing, &two.continuing)] {
        let (a, b) = (a.as_ref().unwrap(), b.as_ref().unwrap());
        let [mm, twice] = [a, b].map(|boundary| boundary.d15f_mm.unwrap());
        let sizes = |range: Range| [range.median, range.low.unwrap(), range.high.unwrap()];
        assert_eq!(sizes(mm).map(|mm| (2.0 * mm).to_bits()), sizes(twice).map(f64::to_bits));
        assert_eq!(a.median.to_bits(), b.median.to_bits());
    }
    assert_eq!((2.0 * one.thickness_mm.unwrap()).to_bits(), two.thickness_mm.unwrap().to_bits());
}

#[test]
fn a_boundary_on_which_few_particles_decide_is_a_doubt() {
    let folder = tempfile::tempdir().unwrap();
    for (cu, across, in_doubt) in [("base.cu=3", 10, true), ("base.cu=1.5", 40, false)] {
        let [nx, ny] = ["nx", "ny"].map(|axis| format!("network.{axis}={across}"));
        let all = searched(&tiny(&folder.path().join(cu), &[cu, &nx, &ny, "network.nz=12"]));
        let is_doubt = all.notes.iter().any(|row| row.note.id() == "unsteady");
        assert_eq!(is_doubt, in_doubt, "{:?}", all.notes);
    }
}

#[test]
fn boundaries_hang_neither_on_a_wide_bracket_nor_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let result = |name: &str, bracket: [f64; 2], threads: usize| {
        let options = options(&folder.path().join(name), &[LAYERS, "base.cu=2"]);
        let prepare = PrepareOptions { threads: Some(threads), ..PrepareOptions::default() };
        let all = found_within(&BoundaryOptions { prepare, ..options }, bracket);
        let csv = std::fs::read_to_string(folder.path().join(name).join("boundary.csv")).unwrap();
        (all, csv)
    };
    let (one, walks) = result("one", [0.8, 30.0], 1);
    let (other, same_walks) = result("threads", [0.8, 30.0], 3);
    assert_eq!((timeless(&one), walks), (timeless(&other), same_walks));
    let (narrow, _) = result("narrow", [1.01, 12.3], 2);
    assert_eq!(one.boundaries[0].networks, narrow.boundaries[0].networks);
    assert_eq!(one.boundaries[0].no_erosion, narrow.boundaries[0].no_erosion);
    // A bracket that misses the boundary gives no number.
    let (beside, _) = result("beside", [0.8, 1.2], 2);
    let row = &beside.boundaries[0];
    assert!(row.no_erosion.is_none() && row.continuing.is_none());
    assert_eq!(row.no_erosion_notes[0].id(), "holds_to_end");
    assert!(row.held().is_some_and(|ratio| (1.2..1.3).contains(&ratio)), "{row:?}");
    assert!(beside.notes.iter().any(|row| row.note.id() == "holds_everywhere"), "{:?}", beside.notes);
}

/// Scans with whole runs of scenes, in steps of 0.5 %: another way to make the base, to walk and to search.
/// The bases are uniform, so that their erosion rises steeply: on so few voids the erosion of broad bases
/// rises so slowly that the scatter of a walk moves the boundary by a tenth.
#[test]
fn three_boundaries_are_those_of_scans_by_hand() {
    let folder = tempfile::tempdir().unwrap();
    for (cu, run) in [("base.cu=1.2", 0), ("base.cu=1.5", 0), ("base.cu=1.5", 1)] {
        let name = format!("{cu}-{run}");
        let wide = ["network.nx=16", "network.ny=16", "network.nz=10", "replicates=3", cu];
        let row: BoundaryRow = searched(&tiny(&folder.path().join(name), &wide)).boundaries.remove(0);
        let boundary = if run == 0 { row.no_erosion } else { row.continuing }.unwrap();
        let mut by_hand: Vec<Option<f64>> = vec![None; 3];
        for step in 0..160 {
            let ratio = 0.7 * boundary.median * libm::pow(1.005, f64::from(step));
            let of_ratio = format!("base.d15f_over_d85b={ratio}");
            // With the engine of a search.
            let of_scene = [&wide[..], &[&of_ratio, "record.sensitivity=[]", "engine=expected"]];
            let outcome = walk_case(&case_of(&of_scene.concat()), &Callbacks::default()).unwrap();
            for (network, replicate) in outcome.replicates.iter().enumerate() {
                let erodes = replicate.runs[..=run].iter().all(|record| record.eroded_mass_fraction >= 0.075);
                if erodes && by_hand[network].is_none() {
                    by_hand[network] = Some(ratio);
                }
            }
            if by_hand.iter().all(Option::is_some) {
                break;
            }
        }
        for (network, by_hand) in row.networks.iter().zip(by_hand) {
            let boundary = if run == 0 { network.no_erosion } else { network.continuing }.unwrap();
            let off = by_hand.unwrap() / boundary;
            // One step of the scan, plus the effect of other roundings of the base on single particles. An
            // error below 3 % goes unseen.
            let allowed = 0.97..1.03;
            assert!(allowed.contains(&off), "{cu} run {run}: {boundary} {by_hand:?}");
        }
    }
}

/// Compares bits of the walk with those of another engine.
#[test]
fn a_search_moves_the_expectation_of_what_blocks_nothing_unless_another_engine_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let result = |engine: &[&str]| {
        let out = folder.path().join(engine.concat());
        let all = searched(&tiny(&out, &[&["base.cu=2.5", "replicates=2"], engine].concat()));
        (all.engine, std::fs::read(out.join("boundary.csv")).unwrap())
    };
    let unsaid = result(&[]);
    assert_eq!(unsaid.0, "expected");
    assert_eq!(unsaid, result(&["engine=expected"]));
    assert_eq!(unsaid, result(&["engine=auto"]));
    let counted = result(&["engine=counts"]);
    assert_eq!(counted.0, "counts");
    assert_ne!(unsaid.1, counted.1);
}

#[test]
fn a_thickness_in_mm_takes_as_many_layers_as_the_filter_has_there() {
    let folder = tempfile::tempdir().unwrap();
    let base = of_base(folder.path(), "base.csv", &[(0.1, 0.0), (0.2, 100.0)]);
    let thicknesses = ["10mm", "20mm", "9layers"].map(|text| text.parse().unwrap()).to_vec();
    let options = options(&folder.path().join("out"), &[]);
    let all = searched(&BoundaryOptions { base: Some(base), thicknesses, ..options });
    let [thin, thick, layers] = &all.boundaries[..] else { panic!() };
    for (row, mm) in [(thin, 10.0), (thick, 20.0)] {
        // Each layer is as thick as D50F by number: 1.13 D0F for the built-in curve, whose D15F is 1.129 D0F.
        let d15f = row.no_erosion.as_ref().unwrap().d15f_mm.unwrap().median;
        let filter = Gradation::linear_from_dx(15.0, d15f, 1.5).unwrap();
        let wanted = (mm / filter.d_by_number(50.0).unwrap()).round();
        assert!((row.layers as f64 - wanted).abs() <= 1.0, "{} {wanted}", row.layers);
        assert_eq!(row.thickness_mm, Some(mm));
    }
    let ratio = |row: &BoundaryRow| row.no_erosion.as_ref().unwrap().median;
    assert!(ratio(thick) > ratio(thin), "thickness holds");
    assert_eq!((layers.layers, layers.thickness.as_str()), (9, "9 layers"));
    let (d15f, mm) =
        (layers.no_erosion.as_ref().unwrap().d15f_mm.unwrap().median, layers.thickness_mm.unwrap());
    let filter = Gradation::linear_from_dx(15.0, d15f, 1.5).unwrap();
    assert!((mm / (9.0 * filter.d_by_number(50.0).unwrap()) - 1.0).abs() < 1e-9);
}

#[test]
fn a_search_that_is_stopped_keeps_its_networks_and_goes_on_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let whole = searched(&options(&folder.path().join("whole"), &[LAYERS]));
    let path = folder.path().join("stopped");
    let prepare = PrepareOptions { threads: Some(1), ..PrepareOptions::default() };
    // It replaces another's work, but not its own.
    let options = BoundaryOptions { prepare, overwrite: true, ..options(&path, &[LAYERS]) };
    let error = stopped(&options, "network 1 of 3");
    assert_eq!(error.exit().code(), 3, "{error}");
    assert!(error.to_string().starts_with("after 1 of 3 networks"), "{error}");
    assert!(!path.join("boundary.json").exists() && !path.join("boundary.csv").exists());
    let messages = Mutex::new(Vec::new());
    let callbacks = Callbacks {
        on_event: &|event| {
            if let Event::Studying(text) = event {
                messages.lock().unwrap().push(text.to_owned());
            }
        },
        ..Callbacks::default()
    };
    let resumed = run_within(&options, SHORT, &callbacks).unwrap();
    assert!(messages.lock().unwrap()[0].starts_with("1 of 3 networks are done already"));
    assert_eq!(timeless(&resumed), timeless(&whole));
    let names: Vec<_> = std::fs::read_dir(&path).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(!names.iter().any(|name| name.to_string_lossy().starts_with("networks.")), "{names:?}");
    let again = run(&BoundaryOptions { overwrite: false, ..options }, &Callbacks::default()).unwrap_err();
    assert!(again.to_string().contains("holds a study of boundaries already"), "{again}");
    assert_eq!(again.exit().code(), 2);
}

#[test]
fn what_cannot_be_is_refused_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let refused = |settings: &[&str], change: &dyn Fn(&mut BoundaryOptions), words: &str| {
        let mut options = options(&out, settings);
        change(&mut options);
        let error = run(&options, &Callbacks::default()).expect_err(words);
        assert!(error.exit().code() == 2 && error.to_string().contains(words), "{words}: {error}");
        assert!(!out.exists(), "{words}: something was written");
    };
    let base = |name: &str, points: &[(f64, f64)]| Some(of_base(folder.path(), name, points));
    let sand = base("sand.csv", &[(0.1, 0.0), (0.4, 100.0)]);
    let micrometres = base("micro.csv", &[(100.0, 0.0), (400.0, 100.0)]);
    let pan = base("pan.csv", &[(0.1, 90.0), (0.4, 100.0)]);
    let curve = folder.path().join("own.csv");
    std::fs::write(&curve, "percent_smaller,diameter_over_d0f\n0,0.15\n50,0.3\n100,0.6\n").unwrap();
    let mm = |mm: f64| vec![Thickness::Mm(mm)];
    refused(&[], &|all| all.base = Some(folder.path().join("none.csv")), "none.csv");
    refused(&[], &|all| all.base.clone_from(&micrometres), "sizes micrometres");
    refused(&[], &|all| all.base.clone_from(&pan), "D85 lies in the pan");
    refused(&["base.cu=3"], &|all| all.base.clone_from(&sand), "base.cu");
    refused(&[], &|all| all.thicknesses = mm(500.0), "needs a base in mm");
    refused(&[], &|all| all.densities = vec!["2".into()], "dense, medium (or intermediate) or loose");
    refused(&[], &|all| all.densities = vec!["loose".into()], "filter.cu or filter.sieve is missing");
    refused(&[], &|all| all.filter = Some("cu1.5-lose".into()), "cu1.5-loose");
    refused(&["stop.decide_percent=99"], &|_| {}, "do not go with `boundary`");
    refused(&["runs=1"], &|_| {}, "runs = 1 does not go with `boundary`");
    refused(&["record.voids=[1]"], &|_| {}, "record.voids does not go");
    let estimate = |all: &mut BoundaryOptions| {
        (all.filter, all.densities) = (Some("3".into()), vec!["estimate=1.5".into()]);
    };
    refused(&[], &estimate, "relative density from 0 (loose) to 1");
    let another = "would put another soil in the place of the base";
    refused(&["base.sieve=c.csv"], &|all| all.base.clone_from(&sand), another);
    for (filter, setting) in [("3", "filter.cu=1.5"), ("f.csv", "filter.sieve=g.csv")] {
        let words = format!("in the place of the filter, {filter}");
        refused(&[setting], &|all| all.filter = Some(filter.into()), &words);
    }
    for thickness in [LAYERS, "network.thickness_d50f=9"] {
        refused(
            &[thickness],
            &|all| all.thicknesses = mm(9.0),
            &format!("--thickness and --set {thickness}"),
        );
    }
    let shape = "filter.curve=cu1.5-loose";
    refused(&[shape], &|all| all.filter = Some("cu3-loose".into()), &format!("--filter and --set {shape}"));
    refused(&[], &|all| all.filter = Some(curve.display().to_string()), "--set filter.curve=FILE");
    // A size beyond this machine or 32 bits does not mean a boundary beyond the search.
    let thick = |all: &mut BoundaryOptions, thickness: f64| {
        (all.base, all.thicknesses) = (sand.clone(), mm(thickness));
    };
    refused(&[], &|all| thick(all, 1e9), "every length must be");
    let little_memory = |all: &mut BoundaryOptions| {
        thick(all, 5000.0);
        all.prepare.memory = Some(2_000_000);
    };
    refused(&[], &little_memory, "of memory, but");
}

#[test]
fn what_is_found_of_one_row_alone_is_said_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let result = |name: &str, layers: &[&str]| {
        let thicknesses = layers.iter().map(|text| text.parse().unwrap()).collect();
        searched(&BoundaryOptions { thicknesses, ..tiny(&folder.path().join(name), &[]) })
    };
    let (thin, thick) = (result("thin", &["3layers"]), result("thick", &["16layers"]));
    for order in [["3layers", "16layers"], ["16layers", "3layers"]] {
        let both = result(&order.concat(), &order);
        for (row, alone) in [("3 layers", &thin), ("16 layers", &thick)] {
            let row = format!("loose, {row}");
            for RowNote { note, .. } in alone.notes.iter().filter(|row| row.note.id() != "not_monotone") {
                let is_there = |other: &RowNote| {
                    other.note == *note && other.row.as_ref().is_none_or(|name| *name == row)
                };
                assert!(both.notes.iter().any(is_there), "{note:?}: {:?}", both.notes);
            }
        }
    }
}

#[test]
fn the_base_is_named_as_it_is_stated() {
    let folder = tempfile::tempdir().unwrap();
    let out = |name: &str| folder.path().join(name);
    assert_eq!(searched(&options(&out("linear"), &[LAYERS, "base.cu=3"])).base.name, "linear, Cu 3");
    // A stated millimetre is a size.
    let base = of_base(folder.path(), "sand.csv", &[(0.1, 0.0), (0.2, 100.0)]);
    let sized = BoundaryOptions {
        base: Some(base),
        thicknesses: vec![Thickness::Mm(12.0)],
        ..options(&out("sized"), &["filter.d0_mm=1"])
    };
    let sized = searched(&sized);
    assert!(sized.base.name.ends_with("sand.csv"), "{}", sized.base.name);
    assert!(sized.boundaries[0].no_erosion.as_ref().unwrap().d15f_mm.is_some());
}

/// Networks that erode at every ratio of a bracket give no usable ratio.
#[test]
fn a_boundary_below_the_bracket_leaves_no_ratio_that_holds() {
    let folder = tempfile::tempdir().unwrap();
    let all = |name: &str, bracket: [f64; 2]| {
        let options = tiny(&folder.path().join(name), &["base.cu=3", "replicates=7", "network.nz=10"]);
        found_within(&options, bracket)
    };
    let wide = all("wide", [0.5, 30.0]);
    let least =
        wide.boundaries[0].networks.iter().filter_map(|network| network.no_erosion).fold(f64::MAX, f64::min);
    // First bracket that begins between the minimum of the networks and their median.
    let is_between = |all: &Boundaries| {
        all.boundaries[0].no_erosion.as_ref().is_some_and(|end| end.low.is_none() && end.high.is_some())
    };
    let mut brackets = (1..5).map(|step| [least * libm::exp(0.04 * f64::from(step)), 30.0]);
    let beside = brackets.find_map(|bracket| Some(all(&format!("{bracket:?}"), bracket)).filter(is_between));
    let beside = beside.expect("the networks lie apart");
    let row = &beside.boundaries[0];
    assert!(row.networks.iter().any(|network| network.no_erosion.is_none()), "{row:?}");
    assert!(row.no_erosion.as_ref().unwrap().cautious().is_none(), "{row:?}");
    assert!(beside.least_held().is_none(), "{beside:?}");
    assert!(beside.notes.iter().any(|row| row.note.id() == "erodes_everywhere"), "{:?}", beside.notes);
}

fn at(ratio: f64) -> Found {
    Found { no_erosion: Some(ratio), ..Found::default() }
}

#[test]
fn an_end_has_to_hold_clearly_more() {
    let done = |row: usize, network: u64, found: &Found| Done { row, network, found: found.clone() };
    let wanted = |less: &[Found]| {
        let done: Vec<Done> = (1..).zip(less).map(|(network, result)| done(1, network, result)).collect();
        clear_of(&done, &[(1, less.len() as u64)])
    };
    let near = |ratio: Option<f64>, wanted: f64| ratio.is_some_and(|ratio| (ratio - wanted).abs() < 1e-12);
    assert!(near(wanted(&[at(4.0)]), 4.4));
    // Networks 4 % apart, and 25 % apart.
    assert!(near(wanted(&[at(4.0), at(4.16)]), 4.16 * 1.1));
    assert!(near(wanted(&[at(5.0), at(4.0)]), 5.0 * 1.5625));
    let beyond = |side, why| Found { no_erosion_beyond: Some((side, why)), ..Found::default() };
    let erodes = beyond(Beyond::Below, Ended::Erodes(0.5));
    let holds = beyond(Beyond::Above, Ended::Holds(1, 100.0));
    let unknown = beyond(Beyond::Above, Ended::NotWalked("too fine".into()));
    for less in [erodes, holds, unknown] {
        assert_eq!(wanted(&[at(4.0), less.clone()]), None, "{less:?}");
        assert_eq!(wanted(std::slice::from_ref(&less)), None, "{less:?}");
    }
    // All networks of the worse end count, and every range.
    let all = [done(1, 2, &at(4.1)), done(1, 1, &at(4.0)), done(3, 1, &at(5.0))];
    assert_eq!(clear_of(&all, &[(1, 2)]), Some(4.1 * CLEAR));
    assert_eq!(clear_of(&all, &[(1, 2), (3, 1)]), Some(5.0 * CLEAR));
    assert_eq!(clear_of(&all, &[(1, 3)]), None);
    assert_eq!(clear_of(&all, &[]), None);
}
