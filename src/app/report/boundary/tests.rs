use super::*;
use crate::outcome::boundary::Boundary;
use crate::outcome::boundary::{BaseStated, BoundaryRow};
use crate::outcome::record::ModelLimit;
use voidwalk_core::store::format::BOUNDARY;
use voidwalk_practice::SheetCover;

fn written(all: &Boundaries, csv: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("boundary.json"), BOUNDARY.json(all).unwrap()).unwrap();
    std::fs::write(folder.path().join("boundary.csv"), csv).unwrap();
    let written = write_boundary(folder.path()).unwrap();
    assert!(written.page.ends_with("boundary.html"));
    std::fs::read_to_string(written.page).unwrap()
}

fn all(no_erosion: Option<Boundary>) -> Boundaries {
    Boundaries {
        version: "1".into(),
        commit: None,
        boundaries: vec![BoundaryRow {
            density: "<loose>".into(),
            thickness: "60 layers".into(),
            layers: 60,
            thickness_mm: None,
            grains_per_void: Some(0.61),
            no_erosion_notes: Vec::new(),
            no_erosion,
            holds_to: None,
            continuing: None,
            continuing_notes: Vec::new(),
            unsteady: None,
            not_monotone: 0,
            networks: Vec::new(),
            as_end: None,
            end_of: None,
        }],
        base: BaseStated {
            name: "b".into(),
            cu: None,
            d15_mm: None,
            d85_mm: None,
            d95_over_d85: None,
            regraded_at_mm: None,
            tail_mass_fraction: 0.0,
            d85_as_sampled_mm: None,
        },
        filter: "f".into(),
        curve_name: "c".into(),
        filter_cu: None,
        filter_d15_mm: None,
        inputs: Vec::new(),
        threshold: 0.075,
        replicates: 3,
        seed: 1,
        engine: "expected".into(),
        bracket: [0.5, 100.0],
        step: 0.005,
        notes: Vec::new(),
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
    use crate::outcome::boundary::NetworkBoundaries;
    let page_of = |ratios: &[f64]| {
        let networks: Vec<_> = ratios.iter().map(|ratio| Ok(*ratio)).collect();
        let mut all = all(Boundary::of(&networks, Some(0.2)));
        all.base.d85_mm = Some(0.2);
        all.replicates = ratios.len() as u64;
        let network =
            |ratio: &f64| NetworkBoundaries { network: 1, no_erosion: Some(*ratio), continuing: None };
        all.boundaries[0].networks = ratios.iter().map(network).collect();
        written(&all, CSV)
    };
    let few = page_of(&[4.0, 4.4, 6.0]);
    assert!(few.contains("(4.00 to 6.00)"), "{few}");
    assert!(few.contains("median of 3 networks (in brackets least and most); below it the D15F"), "{few}");
    assert!(few.contains("blend over the interpolated 5 to 95 % range of the networks."), "{few}");
    let one = page_of(&[4.4]);
    assert!(one.contains(", of one network; below it the D15F"), "{one}");
    assert!(!one.contains("least and most") && !one.contains("5 to 95 %"), "{one}");
    let many = page_of(&[4.0, 4.4, 4.8, 5.2].repeat(5));
    assert!(
        many.contains("median of 20 networks (in brackets 5 to 95 % range); below it the D15F"),
        "{many}"
    );
}

/// Whatever the model says, its line has no colour, no zone of its figure is green, and names are inert.
#[test]
fn nothing_of_the_model_is_green_and_names_are_inert() {
    for no_erosion in [Boundary::of(&[Ok(4.3), Ok(4.5)], Some(0.2)), None] {
        let mut all = all(no_erosion);
        all.base.d85_mm = Some(0.2);
        let page = written(&all, CSV);
        assert!(page.contains("class=\"verdict\"") && !page.contains("class=\"verdict "), "{page}");
        assert!(page.contains("<b>Model (research)</b>: "), "{page}");
        assert!(!page.contains("#009E73\"") && !page.contains(">Limit: "), "{page}");
        assert!(page.contains("&lt;loose&gt;") && !page.contains("<loose>"));
        assert!(
            page.contains("default-src 'none'")
                && page.contains("The model leaves out: a limit to what enters")
        );
    }
}

#[test]
fn the_figure_is_of_the_row_that_holds_least() {
    let boundary = |ratio: f64| Boundary::of(&[Ok(ratio), Ok(ratio)], Some(0.2));
    let mut all = all(boundary(5.0));
    let loose =
        BoundaryRow { density: "loosest".into(), no_erosion: boundary(3.0), ..all.boundaries[0].clone() };
    all.boundaries.push(loose);
    all.base.d85_mm = Some(0.2);
    let page = written(&all, &format!("{CSV}loosest,60 layers,1,3.0,0.01,,\n"));
    assert!(page.contains("Base eroded against D15F: loosest, 60 layers"), "{page}");
    assert!(page.contains("this one holds least"));
}

/// The model holds to 0.8068 mm.
#[test]
fn a_boundary_of_no_erosion_is_rounded_inward_in_mm_and_inches() {
    let mut all = all(Boundary::of(&[Ok(4.034), Ok(4.034)], Some(0.2)));
    all.base.d85_mm = Some(0.2);
    let csv = CSV.replace("4.0,", "3.9,");
    let page = written(&all, &csv).replace('\u{202f}', " ");
    assert!(page.contains("D15F 0.806 mm") && !page.contains("0.807"), "{page}");
    all.inches = true;
    let page = written(&all, &csv).replace('\u{202f}', " ");
    // 0.806 mm are 0.03173 in.
    let inches = page.matches("0.806 mm (").count();
    assert!(inches > 1 && inches == page.matches("0.0317 in").count(), "{page}");
}

#[test]
fn a_folder_that_was_changed_is_refused_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let text = BOUNDARY.json(&all(None)).unwrap();
    std::fs::write(folder.path().join("boundary.json"), text).unwrap();
    std::fs::write(folder.path().join("boundary.csv"), CSV.replace("0.01", "much")).unwrap();
    let error = write_boundary(folder.path()).unwrap_err().to_string();
    assert!(error.contains("boundary.csv") && error.contains('2'), "{error}");
    std::fs::remove_file(folder.path().join("boundary.json")).unwrap();
    assert!(write_boundary(folder.path()).unwrap_err().to_string().contains("boundary.json"));
}
