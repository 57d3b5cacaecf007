//! Packing files: every dress, every refusal with its words, and no panic.

use super::{Cell, CellOption, LengthUnit, Packing, ReadOptions};
use proptest::prelude::*;

const CSV: &str = "# cell_mm = 2, 3, 4\nx_mm,y_mm,z_mm,diameter_mm\n0.5,1,2,1\n1.5,2.5,3.25,0.75\n";
/// Options in mm, with the cell from the file.
const MM: ReadOptions = ReadOptions { unit: Some(LengthUnit::Mm), cell: None };
const DUMP: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n-1 1\n0 3\n1 5\n\
                    ITEM: ATOMS id type x y z radius\n2 1 0.5 2.5 4.25 0.375\n1 1 -0.5 1 3 0.5\n";

/// Parses a file that gives its unit and its cell; a dump without units is in mm here.
fn parsed(text: &str) -> Result<Packing, String> {
    let unit = (text.contains("ITEM:") && !text.contains("ITEM: UNITS")).then_some(LengthUnit::Mm);
    parsed_as(text, &ReadOptions { unit, cell: None })
}

fn parsed_as(text: &str, options: &ReadOptions) -> Result<Packing, String> {
    let read = Packing::parse_as("f", text.as_bytes(), options);
    read.map(|(packing, _)| packing).map_err(|error| error.to_string())
}

fn expected() -> Packing {
    Packing {
        cell: Cell::Periodic([2.0, 3.0, 4.0]),
        x: vec![0.5, 1.5],
        y: vec![1.0, 2.5],
        z: vec![2.0, 3.25],
        diameter: vec![1.0, 0.75],
    }
}

#[test]
fn the_same_packing_in_every_dress() {
    for text in [
        CSV.to_string(),
        format!("\u{feff}{}", CSV.replace('\n', "\r\n")),
        CSV.replace("x_mm,y_mm,z_mm,diameter_mm\n", "\n# note\n X_mm , Y_mm,\"z_mm\",diameter_mm,colour\n"),
        CSV.replace("\n0", "\n\n0").replace(',', ";"),
        format!("# exported by somebody\n# step = 7\n\n{CSV}"),
        DUMP.to_string(),
        DUMP.replace("TIMESTEP\n0", "TIMESTEP\n7\nITEM: TIME\n0.5"),
        DUMP.replace("-1 1", "0 2")
            .replace("id type x", "id type xs")
            .replace(" 0.5 2", " 0.75 2")
            .replace(" -0.5", " 0.25"),
        DUMP.replace("radius", "diameter").replace("0.375", "0.75").replace("3 0.5", "3 1"),
        format!("{}{DUMP}", DUMP.replace("0.375", "9")),
    ] {
        assert_eq!(parsed(&text), Ok(expected()), "{text}");
    }
    let free = Packing { cell: Cell::Free, x: vec![-0.5, 0.5], z: vec![3.0, 4.25], ..expected() };
    assert_eq!(parsed(&DUMP.replace("pp pp pp", "ff sm ff")), Ok(free));
    assert_eq!(parsed(&CSV.replace("cell_mm = 2, 3, 4", "cell = none")).unwrap().cell, Cell::Free);
}

/// A dump names the unit of its lengths once, before its first frame, or before each frame.
#[test]
fn a_dump_says_which_frame_and_which_units_were_taken() {
    let units = |name: &str| format!("ITEM: UNITS\n{name}\n");
    let read = |text: &str| {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("dump");
        std::fs::write(&path, text).unwrap();
        Packing::read_as(&path, &ReadOptions::default())
    };
    for (name, scale, words) in [
        ("si", 1e3, "metres"),
        ("cgs", 10.0, "centimetres"),
        ("micro", 1e-3, "micrometres"),
        ("nano", 1e-6, "nanometres"),
    ] {
        let first = DUMP.replace("0.375", "9").replace("TIMESTEP\n0", "TIMESTEP\n-1");
        for text in
            [format!("{}{first}{DUMP}", units(name)), format!("{}{first}{}{DUMP}", units(name), units(name))]
        {
            let (packing, notes) = read(&text).unwrap();
            assert_eq!(packing.diameter, [scale, 0.75 * scale], "{text}");
            assert_eq!(packing.x, [0.5 * scale, 1.5 * scale]);
            assert_eq!(packing.cell, Cell::Periodic([2.0 * scale, 3.0 * scale, 4.0 * scale]));
            // The user names the unit.
            let lengths = format!("lengths are in {words}, and are turned into mm");
            assert_eq!(notes, ["holds 2 frames: the last one, timestep 0, is taken", lengths.as_str()]);
        }
    }
    // LIGGGHTS does not name its unit, nor does LAMMPS by default.
    let silent = read(DUMP).unwrap_err().to_string();
    assert!(
        silent.contains("does not say the unit of its lengths") && silent.contains("--unit m"),
        "{silent}"
    );
    let given = |unit| ReadOptions { unit: Some(unit), cell: None };
    assert_eq!(parsed_as(DUMP, &given(LengthUnit::Mm)), Ok(expected()));
    assert_eq!(parsed_as(DUMP, &given(LengthUnit::M)).unwrap().diameter, [1e3, 750.0]);
    // Reduced units have no length of their own, and two that differ give no answer.
    let reduced = format!("{}{DUMP}", units("lj"));
    assert_eq!(parsed_as(&reduced, &given(LengthUnit::Mm)), Ok(expected()));
    let both = parsed_as(&format!("{}{DUMP}", units("si")), &given(LengthUnit::Mm)).unwrap_err();
    assert!(both.contains("unit: \"mm\" is not allowed; allowed: m: the file says the unit"), "{both}");
    let cell = parsed_as(DUMP, &ReadOptions { unit: Some(LengthUnit::Mm), cell: Some(CellOption::None) });
    assert!(cell.unwrap_err().contains("the file says its boundaries itself"));
    for name in ["lj", "real", "metal", "electron", "SI", ""] {
        let refused = parsed(&format!("{}{DUMP}", units(name))).unwrap_err();
        let message = format!("f, line 2, units: \"{name}\" is not allowed; allowed: si, cgs, micro or nano");
        assert!(refused.starts_with(&message), "{refused}");
    }
    let two = parsed(&format!("{}{DUMP}{}{DUMP}", units("si"), units("cgs"))).unwrap_err();
    assert!(two.contains("line 15, units: \"cgs\"") && two.contains("the same units"), "{two}");
    let huge = parsed(&format!("{}{}", units("si"), DUMP.replace("0.5 2.5", "1e307 2.5"))).unwrap_err();
    assert!(huge.contains("lengths in metres that are numbers in mm"), "{huge}");
}

#[test]
fn what_is_written_is_read_back() {
    for cell in [Cell::Periodic([2.0, 3.0, 0.1 + 0.2]), Cell::Free] {
        let packing = Packing { cell, x: vec![1e-300, 1.0 / 3.0], ..expected() };
        assert_eq!(parsed(&packing.to_csv()), Ok(packing.clone()));
        let vtp = packing.to_vtp();
        assert!(vtp.contains("NumberOfPoints=\"2\"") && vtp.contains("\n0.75\n") && vtp.contains(" 2.5 "));
    }
}

/// Each bad file has its own message.
#[test]
fn bad_files_are_refused_with_their_place() {
    let csv = |from: &str, to: &str| CSV.replacen(from, to, 1);
    let dump = |from: &str, to: &str| DUMP.replacen(from, to, 1);
    for (text, message) in [
        (String::new(), "f ends after line 0; expected a line \"# cell_mm"),
        (
            csv("# cell_mm = 2, 3, 4\n", ""),
            "f does not say whether its boundaries are periodic; say it: --cell none",
        ),
        (csv("# cell_mm = 2, 3, 4\nx_mm", "name"), "one column each for x, y, z"),
        (
            "name,colour\n1,2\n".into(),
            "f is no packing that is known: line 1 is \"name,colour\". Known are: CSV",
        ),
        (csv("2, 3, 4", "2, 3"), "f, line 1, cell"),
        (
            csv("2, 3, 4", "2, nan, 4"),
            "f, line 1, cell_mm: \"nan\" is not allowed; allowed: a finite number above 0",
        ),
        (format!("# step = 7\n{}", csv("2, 3, 4", "2, 3")), "f, line 2, cell"),
        (csv("cell_mm", "cell_m"), "f, line 1, cell"),
        (format!("# cell = none\n{CSV}"), "f, line 2, cell: \"# cell_mm = 2, 3, 4\" is not allowed"),
        (csv("2, 3, 4", "0.8, 0.8, 0.8"), "f: the grains do not fit their cell: the grains have 1.454 times"),
        (csv("2, 3, 4", "2, 0, 4"), "f, line 1, cell_mm: \"0\""),
        (csv("diameter_mm", "diameter"), "f, line 2, header: \"x_mm,y_mm,z_mm,diameter\""),
        (csv("x_mm,y_mm", "x_mm,x_mm"), "(2 for x found)"),
        (csv("0.5,1,2,1", "0.5,inf,2,1"), "f, line 3, y: \"inf\" is not allowed; allowed: a finite number"),
        (csv("0.5,1,2,1", "0.5,1e400,2,1"), "f, line 3, y: \"1e400\""),
        (csv("0.5,1,2,1", "0.5,1,2"), "f, line 3, diameter: \"0.5,1,2\" is not allowed; allowed: 4 fields"),
        (
            csv("0.5,1,2,1", "0.5,1,2,-1"),
            "f, line 3, diameter: \"-1\" is not allowed; allowed: a finite number above 0",
        ),
        (csv("0.5,1,2,1\n1.5,2.5,3.25,0.75\n", ""), "f ends after line 2; expected at least one grain"),
        (dump("pp pp pp", "pp ff pp"), "f: its box is periodic along some axes only"),
        (dump("pp pp pp", "pp pp"), "f, line 5, box bounds: \"pp pp\""),
        (dump("pp pp pp", "xy xz yz pp pp pp"), "a box with right angles"),
        (dump("-1 1", "1 -1"), "f, line 6, box bounds: \"1 -1\" is not allowed; allowed: a low bound below"),
        (dump("ATOMS\n2", "ATOMS\n999999999999999999999"), "f, line 4, number of atoms"),
        (
            dump("ATOMS\n2", "ATOMS\n18446744073709551615"),
            "expected 18446744073709551615 rows of atoms, 2 found",
        ),
        (dump("ATOMS\n2", "ATOMS\n1"), "f, line 11, atoms"),
        (dump("radius", "size"), "a column called diameter or radius"),
        (dump("x y z", "x y q"), "columns x, y and z"),
        (
            dump("\n1 1", "\n2 1"),
            "f, line 11, id: \"2\" is not allowed; allowed: every id once (it stands on line 10 too)",
        ),
        (dump("0.375", "nan"), "f, line 10, diameter: \"nan\""),
        (DUMP[..80].to_string(), "f ends after line"),
    ] {
        let error = parsed(&text).unwrap_err();
        assert!(error.contains(message), "{error}\n{text}");
    }
    let binary = Packing::parse("f", b"# cell = none\n\xff").unwrap_err().to_string();
    assert!(binary.contains("f, line 2: byte 0xFF"), "{binary}");
    let folder = Packing::read(std::env::temp_dir()).unwrap_err().to_string();
    assert!(folder.contains("is a folder"), "{folder}");
    assert!(
        Packing::read("no/such/file").unwrap_err().to_string().starts_with("no/such/file: cannot be read")
    );
}

proptest! {
    /// A cut, garbled or repeated file gives a packing or an error, never a panic.
    #[test]
    fn no_file_makes_it_panic(cut in 0usize..200, at in 0usize..200, with in ".{0,6}", is_csv: bool) {
        let mut text: Vec<char> = if is_csv { CSV } else { DUMP }.chars().collect();
        let at = at.min(text.len());
        text.splice(at..(at + with.len()).min(text.len()), with.chars());
        text.truncate(text.len() - cut.min(text.len()) / 2);
        let text: String = text.into_iter().collect();
        if let Ok(packing) = parsed(&text) {
            prop_assert_eq!(packing.x.len(), packing.diameter.len());
        }
    }
}

/// Centres and radii in metres, as other programs write them.
const METRES: [[&str; 4]; 2] =
    [["-0.0005", "0.001", "0.003", "0.0005"], ["0.0005", "0.0025", "0.00425", "0.000375"]];

fn rows(row: impl Fn([&str; 4]) -> String) -> String {
    METRES.map(row).concat()
}

/// Files of Yade, MercuryDPM and ParaView with the two grains.
#[test]
fn files_of_other_programs_are_read_when_unit_and_cell_are_said() {
    let yade = format!(
        "#format x_y_z_r_matId\n# packed\n{}",
        rows(|[x, y, z, r]| format!("{x}\t{y}\t{z}\t{r}\t0\n"))
    );
    let bounds = "-0.001 0 0.001 0.001 0.003 0.005";
    let frame = |time: &str, radius: &str| {
        let body = rows(|[x, y, z, r]| format!("{x} {y} {z} 0 0 0 {r} 0 0 0 0 0 0 7\n"));
        format!("2 {time} {bounds}\n{}", body.replace("0.000375", radius))
    };
    let mercury = format!("{}{}", frame("0", "0.0009"), frame("1.5", "0.000375"));
    let points = rows(|[x, y, z, r]| format!("{},7,{x},{y},{z}\n", 2.0 * r.parse::<f64>().unwrap()));
    let paraview = format!("\"Diameter\",\"ID\",\"Points:0\",\"Points:1\",\"Points:2\"\n{points}");
    let close = |packing: &Packing, shift: [f64; 3], text: &str| {
        for ((actual, wanted), shift) in
            [(&packing.x, [-0.5, 0.5]), (&packing.y, [1.0, 2.5]), (&packing.z, [3.0, 4.25])]
                .into_iter()
                .zip(shift)
        {
            assert!(
                actual.iter().zip(wanted).all(|(a, b)| (a - b - shift).abs() < 1e-12),
                "{text}: {actual:?}"
            );
        }
        assert!((packing.diameter[0] - 1.0).abs() + (packing.diameter[1] - 0.75).abs() < 1e-12, "{text}");
    };
    let options = |cell: &str| ReadOptions { unit: Some(LengthUnit::M), cell: Some(cell.parse().unwrap()) };
    for text in [&yade, &mercury, &paraview, &paraview.replace("Points:", "coordinates_")] {
        let free = parsed_as(text, &options("none")).unwrap();
        assert_eq!(free.cell, Cell::Free);
        close(&free, [0.0; 3], text);
        let periodic = parsed_as(text, &options("0.002, 0.003,0.004")).unwrap();
        assert_eq!(periodic.cell, Cell::Periodic([2.0, 3.0, 4.0]));
        let message = |options: ReadOptions| parsed_as(text, &options).unwrap_err();
        assert!(
            message(ReadOptions { unit: None, ..options("none") }).contains("does not say the unit"),
            "{text}"
        );
        let bounds = message(ReadOptions { unit: Some(LengthUnit::M), cell: None });
        assert!(bounds.contains("does not say whether its boundaries are periodic"), "{bounds}");
        assert_eq!(bounds.contains("or bounds for one"), text.as_str() == mercury, "{bounds}");
    }
    let moved = parsed_as(&mercury, &options("bounds")).unwrap();
    let Cell::Periodic(lengths) = moved.cell else { panic!("{:?}", moved.cell) };
    assert!(lengths.iter().zip([2.0, 3.0, 4.0]).all(|(a, b)| (a - b).abs() < 1e-12));
    close(&moved, [1.0, 0.0, -1.0], "bounds");
    let (_, notes) = Packing::parse_as("f", mercury.as_bytes(), &options("none")).unwrap();
    assert!(notes[0].contains("holds 2 frames: the last one, time 1.5, is taken"), "{notes:?}");
    // A unit in the names does as well as one that the user gives.
    let named = paraview.replace("Points:0", "x (m)").replace("Points:1", "y (m)").replace("Points:2", "z_m");
    let named =
        parsed_as(&named.replace("Diameter", "Diameter [m]"), &ReadOptions { unit: None, ..options("none") });
    close(&named.unwrap(), [0.0; 3], "named");
}

#[test]
fn files_of_other_programs_that_are_broken_are_refused_with_their_place() {
    let options = ReadOptions { unit: Some(LengthUnit::M), cell: Some(CellOption::None) };
    for (text, message) in [
        (
            "#format x_y_r\n1 2 3\n",
            "f, line 1, format: \"#format x_y_r\" is not allowed; allowed: x, y, z and r",
        ),
        ("#format x_y_z_r\n1 2 3\n", "f, line 2, row: \"1 2 3\" is not allowed; allowed: 4 fields"),
        ("#format x_y_z_r\n1 2 3 0\n", "f, line 2, diameter: \"0\""),
        ("#format x_y_z_r\n", "f ends after line 1; expected at least one sphere"),
        (
            "1 0 0 0 1 1\n0 0 0 0 1 0 0 0\n",
            "f, line 1, frame: \"1 0 0 0 1 1\" is not allowed; allowed: three dimensions",
        ),
        ("1 0 0 0 0 1 1 1\n1 2 3\n", "f, line 2, particle: \"1 2 3\" is not allowed; allowed: at least 14"),
        ("2 0 0 0 0 1 1 1\n1 2 3\n", "f ends after line 2; expected 2 rows of particles, 1 found"),
        ("0 0 0 0 0 1 1 1\n0 1 0 0 0 1 1 1\n", "expected a frame with at least one particle"),
        ("1 0 0 0 2 1 1 1\n", "a low bound below the high one"),
        (
            "x_mm,y_m,z_mm,radius_mm\n",
            "f, line 1, header: \"x_mm,y_m,z_mm,radius_mm\" is not allowed; allowed: the same unit",
        ),
        ("# cell_mm = 1,1,1\nx_m,y_m,z_m,r_m\n0,0,0,1\n", "columns in mm, as the cell above them"),
    ] {
        let error = parsed_as(text, &options).unwrap_err();
        assert!(error.contains(message), "{error}\n{text}");
    }
    let zipped = Packing::parse("f", b"PK\x03\x04").unwrap_err().to_string();
    assert!(
        zipped.contains("a zip or a workbook (save a workbook's sheet as CSV). Known are: CSV"),
        "{zipped}"
    );
    for bad in ["", "1,2", "1,2,0", "1,2,nan", "box"] {
        assert!(bad.parse::<CellOption>().unwrap_err().starts_with("write none for free"), "{bad}");
    }
    assert!("µm".parse() == Ok(LengthUnit::Um) && "inch".parse::<LengthUnit>().is_err());
}

#[test]
fn the_last_frame_with_grains_is_taken() {
    let options = ReadOptions { unit: Some(LengthUnit::M), cell: Some(CellOption::None) };
    let (empty, full) = ("0 2 0 0 0 1 1 1\n", "1 1.5 0 0 0 1 1 1\n.5 .5 .5 0 0 0 .1 0 0 0 0 0 0 0\n");
    let alone = parsed_as(full, &options).unwrap();
    for text in [format!("{empty}{full}"), format!("{full}{empty}"), format!("{empty}{full}{empty}{empty}")] {
        let (packing, notes) = Packing::parse_as("f", text.as_bytes(), &options).unwrap();
        assert_eq!(packing, alone);
        assert!(notes[0].contains("time 1.5"), "{notes:?}");
        assert_eq!(notes[0].contains("with grains"), text.ends_with(empty), "{notes:?}");
    }
    let empty = DUMP.replace("ATOMS\n2", "ATOMS\n0").replace("TIMESTEP\n0", "TIMESTEP\n9");
    let empty = format!("{}\n", &empty[..empty.rfind("ITEM: ATOMS").unwrap() + 11]);
    for text in [format!("{empty}{DUMP}"), format!("{DUMP}{empty}{empty}")] {
        let (packing, notes) = Packing::parse_as("f", text.as_bytes(), &MM).unwrap();
        assert_eq!(Ok(packing), parsed(DUMP));
        assert!(notes[0].contains("timestep 0"), "{notes:?}");
    }
    assert!(parsed(&empty).is_err());
}

#[test]
fn a_box_that_is_periodic_along_some_axes_is_free_where_the_user_says_so() {
    let (text, free) = (DUMP.replace("pp pp pp", "pp pp ff"), DUMP.replace("pp pp pp", "ff ff ff"));
    let none = ReadOptions { cell: Some(CellOption::None), ..MM };
    assert_eq!(parsed_as(&text, &none), parsed(&free));
    for cell in [None, Some(CellOption::Bounds), Some(CellOption::Lengths([9.0; 3]))] {
        let error = parsed_as(&text, &ReadOptions { cell, ..MM }).unwrap_err();
        assert!(error.contains("along some axes only"), "{error}");
    }
}

/// A wrong cell gives finer constrictions: a filter that seems to hold more.
#[test]
fn grains_wider_than_a_cell_given_by_hand_are_refused() {
    let text = "#format x_y_z_r\n0.1 0 0 0.05\n1.9 0.5 0.5 0.05\n";
    let read = |x: f64| {
        let cell = Some(CellOption::Lengths([x, 1.0, 1.0]));
        parsed_as(text, &ReadOptions { unit: Some(LengthUnit::M), cell })
    };
    assert_eq!(read(1.8).map(|packing| packing.cell), Ok(Cell::Periodic([1800.0, 1000.0, 1000.0])));
    let error = read(1.7).unwrap_err();
    assert!(
        error.contains("along x, and the cell is 1.7 long there") && error.contains("file's unit"),
        "{error}"
    );
    // Grains may lie outside a cell that their own program wrote.
    assert!(parsed(&CSV.replace("1.5,2.5", "3.5,2.5")).is_ok());
}

#[test]
fn a_radius_that_contradicts_the_diameter_is_refused() {
    let read = |head: &str, sizes: &str| {
        let text = format!("# cell = none\nx_mm,y_mm,z_mm,diameter_mm,{head}\n0,0,0,{sizes}\n2,0,0,1,0.5\n");
        Packing::parse("g.csv", text.as_bytes()).map(|packing| packing.diameter).map_err(|e| e.to_string())
    };
    for (head, sizes) in [("radius_mm", "1.003,0.5"), ("radius_um", "0.001,0.5"), ("r", "1,255")] {
        let text = read(head, sizes);
        assert_eq!(text.is_ok(), head != "radius_um", "{text:?}");
    }
    let error = read("radius_mm", "1,1").unwrap_err();
    assert!(error.contains("line 3") && error.contains("radius"), "{error}");
}
