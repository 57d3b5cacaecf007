//! Packing files: every accepted form, every refusal with its words, and no panic.

use super::{Cell, CellOption, LengthUnit, Packing, ReadOptions, ReadingNote};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use proptest::prelude::*;
use std::io::Write;

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
    let grains = [[0.5, 1.0, 2.0, 1.0], [1.5, 2.5, 3.25, 0.75]];
    Packing::from_grains(Cell::Periodic([2.0, 3.0, 4.0]), grains)
}

fn last_frame(frames: usize, lacking: Option<&'static str>, name: &'static str, time: &str) -> ReadingNote {
    ReadingNote::Frame { frames, lacking, time: (name, time.into()) }
}

/// Expects an error that contains `message`, where `|` separates a value from what is allowed.
fn assert_refused(read: Result<Packing, String>, message: &str) {
    let error = read.expect_err(message);
    assert!(error.contains(&message.replace(" | ", " is not allowed; allowed: ")), "{error}\n{message}");
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
    for (name, scale, unit) in [
        ("si", 1e3, LengthUnit::M),
        ("cgs", 10.0, LengthUnit::Cm),
        ("micro", 1e-3, LengthUnit::Um),
        ("nano", 1e-6, LengthUnit::Nm),
    ] {
        let first = DUMP.replace("0.375", "9").replace("TIMESTEP\n0", "TIMESTEP\n-1");
        for text in
            [format!("{}{first}{DUMP}", units(name)), format!("{}{first}{}{DUMP}", units(name), units(name))]
        {
            let (packing, notes) = read(&text).unwrap();
            assert_eq!(packing.diameter, [scale, 0.75 * scale], "{text}");
            assert_eq!(packing.x, [0.5 * scale, 1.5 * scale]);
            assert_eq!(packing.cell, Cell::Periodic([2.0 * scale, 3.0 * scale, 4.0 * scale]));
            assert_eq!(notes, [last_frame(2, None, "timestep", "0"), ReadingNote::Unit(unit)]);
        }
    }
    // LIGGGHTS does not name its unit, nor does LAMMPS by default.
    let silent = read(DUMP).unwrap_err().to_string();
    let parts = ["does not say the unit of its lengths", "--unit m"];
    assert!(parts.iter().all(|part| silent.contains(part)), "{silent}");
    let given = |unit| ReadOptions { unit: Some(unit), cell: None };
    assert_eq!(parsed_as(DUMP, &given(LengthUnit::Mm)), Ok(expected()));
    assert_eq!(parsed_as(DUMP, &given(LengthUnit::M)).unwrap().diameter, [1e3, 750.0]);
    // Reduced units have no length, and two different units give no answer.
    let reduced = format!("{}{DUMP}", units("lj"));
    assert_eq!(parsed_as(&reduced, &given(LengthUnit::Mm)), Ok(expected()));
    let both = parsed_as(&format!("{}{DUMP}", units("si")), &given(LengthUnit::Mm)).unwrap_err();
    assert!(both.contains("unit: \"mm\" is not allowed; allowed: m: the file states the unit"), "{both}");
    let cell = parsed_as(DUMP, &ReadOptions { unit: Some(LengthUnit::Mm), cell: Some(CellOption::None) });
    assert!(cell.unwrap_err().contains("the file states its boundaries"));
    for name in ["lj", "real", "metal", "electron", "SI", ""] {
        let refused = parsed(&format!("{}{DUMP}", units(name))).unwrap_err();
        let message = format!("f, line 2, units: \"{name}\" is not allowed; allowed: si, cgs, micro or nano");
        assert!(refused.starts_with(&message), "{refused}");
    }
    let two = parsed(&format!("{}{DUMP}{}{DUMP}", units("si"), units("cgs"))).unwrap_err();
    assert!(two.contains("line 15, units: \"cgs\"") && two.contains("the same units"), "{two}");
    let huge = parsed(&format!("{}{}", units("si"), DUMP.replace("0.5 2.5", "1e307 2.5"))).unwrap_err();
    assert!(huge.contains("lengths in metres that are finite numbers in mm"), "{huge}");
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
            "f does not say whether its boundaries are periodic; give them: --cell none",
        ),
        (csv("# cell_mm = 2, 3, 4\nx_mm", "name"), "one column each for x, y, z"),
        (
            "name,colour\n1,2\n".into(),
            "f is not in a known packing format: line 1 is \"name,colour\". Known formats: CSV",
        ),
        (csv("2, 3, 4", "2, 3"), "f, line 1, cell"),
        (csv("2, 3, 4", "2, nan, 4"), "f, line 1, cell_mm: \"nan\" | a finite number above 0"),
        (format!("# step = 7\n{}", csv("2, 3, 4", "2, 3")), "f, line 2, cell"),
        (csv("cell_mm", "cell_m"), "f, line 1, cell"),
        (format!("# cell = none\n{CSV}"), "f, line 2, cell: \"# cell_mm = 2, 3, 4\" is not allowed"),
        (csv("2, 3, 4", "0.8, 0.8, 0.8"), "f: the grains do not fit their cell: the grains have 1.454 times"),
        (csv("2, 3, 4", "2, 0, 4"), "f, line 1, cell_mm: \"0\""),
        (csv("diameter_mm", "diameter"), "f, line 2, header: \"x_mm,y_mm,z_mm,diameter\""),
        (csv("x_mm,y_mm", "x_mm,x_mm"), "(2 for x found)"),
        (csv("0.5,1,2,1", "0.5,inf,2,1"), "f, line 3, y: \"inf\" | a finite number"),
        (csv("0.5,1,2,1", "0.5,1e400,2,1"), "f, line 3, y: \"1e400\""),
        (csv("0.5,1,2,1", "0.5,1,2"), "f, line 3, diameter: \"0.5,1,2\" | 4 fields"),
        (csv("0.5,1,2,1", "0.5,1,2,-1"), "f, line 3, diameter: \"-1\" | a finite number above 0"),
        (csv("0.5,1,2,1\n1.5,2.5,3.25,0.75\n", ""), "f ends after line 2; expected at least one grain"),
        (dump("pp pp pp", "pp ff pp"), "f: its box is periodic along some axes only"),
        (dump("pp pp pp", "pp pp"), "f, line 5, box bounds: \"pp pp\""),
        (dump("pp pp pp", "xy xz yz pp pp pp"), "a box with right angles"),
        (dump("-1 1", "1 -1"), "f, line 6, box bounds: \"1 -1\" | a low bound below"),
        (dump("ATOMS\n2", "ATOMS\n999999999999999999999"), "f, line 4, number of atoms"),
        (
            dump("ATOMS\n2", "ATOMS\n18446744073709551615"),
            "expected 18446744073709551615 rows of atoms, 2 found",
        ),
        (dump("ATOMS\n2", "ATOMS\n1"), "f, line 11, atoms"),
        (dump("radius", "size"), "a column called diameter or radius"),
        (dump("x y z", "x y q"), "columns x, y and z"),
        (dump("\n1 1", "\n2 1"), "f, line 11, id: \"2\" | every id once (it is also on line 10)"),
        (dump("0.375", "nan"), "f, line 10, diameter: \"nan\""),
        (DUMP[..80].to_string(), "f ends after line"),
    ] {
        assert_refused(parsed(&text), message);
    }
    let binary = Packing::parse("f", b"# cell = none\n\xff").unwrap_err().to_string();
    assert!(binary.contains("f, line 2: byte 0xFF"), "{binary}");
    let folder = Packing::read(std::env::temp_dir()).unwrap_err().to_string();
    assert!(folder.contains("is a folder"), "{folder}");
    let none = Packing::read("no/such/file").unwrap_err();
    assert!(none.to_string().starts_with("no/such/file: cannot be read"), "{none}");
    let cause = std::error::Error::source(&none).and_then(|cause| cause.downcast_ref::<std::io::Error>());
    assert_eq!(cause.map(std::io::Error::kind), Some(std::io::ErrorKind::NotFound));
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
            let is_close = actual.iter().zip(wanted).all(|(a, b)| (a - b - shift).abs() < 1e-12);
            assert!(is_close, "{text}: {actual:?}");
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
        let unit = message(ReadOptions { unit: None, ..options("none") });
        assert!(unit.contains("does not say the unit"), "{unit}");
        let bounds = message(ReadOptions { unit: Some(LengthUnit::M), cell: None });
        assert!(bounds.contains("does not say whether its boundaries are periodic"), "{bounds}");
        assert_eq!(bounds.contains("or bounds for one"), text.as_str() == mercury, "{bounds}");
    }
    let moved = parsed_as(&mercury, &options("bounds")).unwrap();
    let Cell::Periodic(lengths) = moved.cell else { panic!("{:?}", moved.cell) };
    assert!(lengths.iter().zip([2.0, 3.0, 4.0]).all(|(a, b)| (a - b).abs() < 1e-12));
    close(&moved, [1.0, 0.0, -1.0], "bounds");
    let (_, notes) = Packing::parse_as("f", mercury.as_bytes(), &options("none")).unwrap();
    assert_eq!(notes[0], last_frame(2, None, "time", "1.5"));
    // A unit in the names is as good as one given by the user.
    let named = paraview.replace("Points:0", "x (m)").replace("Points:1", "y (m)").replace("Points:2", "z_m");
    let named =
        parsed_as(&named.replace("Diameter", "Diameter [m]"), &ReadOptions { unit: None, ..options("none") });
    close(&named.unwrap(), [0.0; 3], "named");
}

#[test]
fn files_of_other_programs_that_are_broken_are_refused_with_their_place() {
    let options = ReadOptions { unit: Some(LengthUnit::M), cell: Some(CellOption::None) };
    for (text, message) in [
        ("#format x_y_r\n1 2 3\n", "f, line 1, format: \"#format x_y_r\" | x, y, z and r"),
        ("#format x_y_z_r\n1 2 3\n", "f, line 2, row: \"1 2 3\" | 4 fields"),
        ("#format x_y_z_r\n1 2 3 0\n", "f, line 2, diameter: \"0\""),
        ("#format x_y_z_r\n", "f ends after line 1; expected at least one sphere"),
        ("1 0 0 0 1 1\n0 0 0 0 1 0 0 0\n", "f, line 1, frame: \"1 0 0 0 1 1\" | three dimensions"),
        ("1 0 0 0 0 1 1 1\n1 2 3\n", "f, line 2, particle: \"1 2 3\" | at least 14"),
        ("2 0 0 0 0 1 1 1\n1 2 3\n", "f ends after line 2; expected 2 rows of particles, 1 found"),
        ("0 0 0 0 0 1 1 1\n0 1 0 0 0 1 1 1\n", "expected a frame with at least one particle"),
        ("1 0 0 0 2 1 1 1\n", "a low bound below the high one"),
        ("x_mm,y_m,z_mm,radius_mm\n", "f, line 1, header: \"x_mm,y_m,z_mm,radius_mm\" | the same unit"),
        ("# cell_mm = 1,1,1\nx_m,y_m,z_m,r_m\n0,0,0,1\n", "columns in mm, as the cell above them"),
    ] {
        assert_refused(parsed_as(text, &options), message);
    }
    let zipped = Packing::parse("f", b"PK\x03\x04").unwrap_err().to_string();
    let looks_like = "a zip or a workbook (save a workbook's sheet as CSV). Known formats: CSV";
    assert!(zipped.contains(looks_like), "{zipped}");
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
    for (text, frames, lacking) in [
        (format!("{empty}{full}"), 2, None),
        (format!("{full}{empty}"), 2, Some("grains")),
        (format!("{empty}{full}{empty}{empty}"), 4, Some("grains")),
    ] {
        let (packing, notes) = Packing::parse_as("f", text.as_bytes(), &options).unwrap();
        assert_eq!(packing, alone);
        assert_eq!(notes[0], last_frame(frames, lacking, "time", "1.5"));
    }
    let empty = DUMP.replace("ATOMS\n2", "ATOMS\n0").replace("TIMESTEP\n0", "TIMESTEP\n9");
    let empty = format!("{}\n", &empty[..empty.rfind("ITEM: ATOMS").unwrap() + 11]);
    for (text, frames, lacking) in
        [(format!("{empty}{DUMP}"), 2, None), (format!("{DUMP}{empty}{empty}"), 3, Some("atoms"))]
    {
        let (packing, notes) = Packing::parse_as("f", text.as_bytes(), &MM).unwrap();
        assert_eq!(Ok(packing), parsed(DUMP));
        assert_eq!(notes[0], last_frame(frames, lacking, "timestep", "0"));
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

/// A wrong cell gives finer constrictions: a filter that seems to retain more.
#[test]
fn grains_wider_than_a_cell_given_by_hand_are_refused() {
    let text = "#format x_y_z_r\n0.1 0 0 0.05\n1.9 0.5 0.5 0.05\n";
    let read = |x: f64| {
        let cell = Some(CellOption::Lengths([x, 1.0, 1.0]));
        parsed_as(text, &ReadOptions { unit: Some(LengthUnit::M), cell })
    };
    assert_eq!(read(1.8).map(|packing| packing.cell), Ok(Cell::Periodic([1800.0, 1000.0, 1000.0])));
    let error = read(1.7).unwrap_err();
    let parts = ["along x, and the cell is 1.7 long there", "file's unit"];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");
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

const PLACES: [f64; 6] = [0.5, 1.0, 2.0, 1.5, 2.5, 3.25];
const RADII: [f64; 2] = [0.5, 0.375];

fn read_vtk(content: &[u8]) -> Result<Packing, String> {
    let options = ReadOptions { cell: Some(CellOption::None), ..MM };
    Packing::parse_as("f", content, &options).map(|read| read.0).map_err(|error| error.to_string())
}

/// The two grains of these tests, without a cell.
fn expected_free() -> Packing {
    Packing { cell: Cell::Free, ..expected() }
}

fn words(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn floats(values: &[f64], is_big_endian: bool) -> Vec<u8> {
    let bytes = |&value: &f64| match is_big_endian {
        true => (value as f32).to_be_bytes(),
        false => (value as f32).to_le_bytes(),
    };
    values.iter().flat_map(bytes).collect()
}

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(content).unwrap();
    packed.finish().unwrap()
}

const LEGACY: &str = "# vtk DataFile Version 3.0\nLIGGGHTS\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n\
                      0.5 1 2\n1.5 2.5 3.25\nVERTICES 2 4\n1 0\n1 1\nPOINT_DATA 2\n\
                      VECTORS v float\n0 0 0 0 0 0\nSCALARS radius float 1\nLOOKUP_TABLE default\n0.5\n\
                      0.375\n";

#[test]
fn files_before_xml() {
    assert_eq!(read_vtk(LEGACY.as_bytes()), Ok(expected_free()));
    assert_eq!(read_vtk(&gzip(LEGACY.as_bytes())), Ok(expected_free()));
    assert_eq!(read_vtk(LEGACY.replace('\n', "\r\n").as_bytes()), Ok(expected_free()));
    // Binary, in the form of VTK 9: cells by offsets, a field, and notes on arrays.
    let ints = |values: &[i64]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>();
    let parts: [(&str, Vec<u8>); 7] = [
        (
            "# vtk DataFile Version 5.1\nvtk output\nBINARY\nDATASET POLYDATA\nPOINTS 2 float\n",
            floats(&PLACES, true),
        ),
        ("\nMETADATA\nINFORMATION 0\n\nVERTICES 3 2\nOFFSETS vtktypeint64\n", ints(&[0, 1, 2])),
        ("\nCONNECTIVITY vtktypeint64\n", ints(&[0, 1])),
        ("\nCELL_DATA 2\nSCALARS radius int\nLOOKUP_TABLE default\n", vec![0; 8]),
        ("\nPOINT_DATA 2\nFIELD FieldData 2\nvelocity 3 2 float\n", floats(&PLACES, true)),
        ("\nradius 1 2 float\n", floats(&RADII, true)),
        ("\nMETADATA\nINFORMATION 0\n\n", Vec::new()),
    ];
    let binary: Vec<u8> = parts.iter().flat_map(|(text, bytes)| [text.as_bytes(), bytes].concat()).collect();
    assert_eq!(read_vtk(&binary), Ok(expected_free()));
    // Every shorter file is refused, or lacks only data after the radii.
    for end in 0..binary.len() {
        let shorter = read_vtk(&binary[..end]);
        assert!(shorter.is_err() || shorter == Ok(expected_free()), "{end}: {shorter:?}");
    }
}

/// A file in XML whose arrays have these attributes and this content.
fn in_xml(attributes: &str, arrays: [(&str, &str); 2], appended: &[u8]) -> Vec<u8> {
    let [(of_places, places), (of_radii, radii)] = arrays;
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" {attributes}>\n\
         <UnstructuredGrid>\n<Piece NumberOfPoints=\"2\" NumberOfCells=\"0\">\n<PointData>\n\
         <DataArray type=\"Float32\" Name=\"radii\" {of_radii}>{radii}</DataArray>\n</PointData>\n<Points>\n\
         <DataArray type=\"Float32\" NumberOfComponents=\"3\" {of_places}>{places}</DataArray>\n</Points>\n\
         </Piece>\n</UnstructuredGrid>\n"
    );
    [head.as_bytes(), appended, b"</VTKFile>\n"].concat()
}

fn with_length(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

/// Two blocks of at most 4 bytes compressed by zlib, and the header before them.
fn zlib(bytes: &[u8]) -> [Vec<u8>; 2] {
    let half = bytes.len() / 2 + 2;
    let blocks: Vec<Vec<u8>> = bytes
        .chunks(half)
        .map(|block| {
            let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            packed.write_all(block).unwrap();
            packed.finish().unwrap()
        })
        .collect();
    let last = bytes.len() % half;
    let header = [blocks.len(), half, last].into_iter().chain(blocks.iter().map(Vec::len));
    [header.flat_map(|n| (n as u32).to_le_bytes()).collect(), blocks.concat()]
}

#[test]
fn files_in_xml() {
    let (places, radii) = (floats(&PLACES, false), floats(&RADII, false));
    let text = [words(&PLACES), words(&RADII)];
    let ascii = in_xml("", [("format=\"ascii\"", &text[0]), ("format=\"ascii\"", &text[1])], b"");
    assert_eq!(read_vtk(&ascii), Ok(expected_free()));
    // VTK's notes on an array are inside it.
    let noted =
        text.each_ref().map(|text| format!("{text}\n<InformationKey><Value>9</Value></InformationKey>"));
    let noted = [("format=\"ascii\"", noted[0].as_str()), ("format=\"ascii\"", &noted[1])];
    assert_eq!(read_vtk(&in_xml("", noted, b"")), Ok(expected_free()));
    assert_eq!(read_vtk(&gzip(&ascii)), Ok(expected_free()));
    let coded = [&places, &radii].map(|bytes| STANDARD.encode(with_length(bytes)));
    let inline = [("format=\"binary\"", coded[0].as_str()), ("format=\"binary\"", &coded[1])];
    assert_eq!(read_vtk(&in_xml("byte_order=\"LittleEndian\"", inline, b"")), Ok(expected_free()));
    let packed = [&places, &radii].map(|bytes| zlib(bytes).map(|part| STANDARD.encode(part)).concat());
    let inline = [("format=\"binary\"", packed[0].as_str()), ("format=\"binary\"", &packed[1])];
    let compressor = "compressor=\"vtkZLibDataCompressor\" header_type=\"UInt32\"";
    assert_eq!(read_vtk(&in_xml(compressor, inline, b"")), Ok(expected_free()));
    for (is_raw, is_zlib) in [(true, false), (false, false), (true, true), (false, true)] {
        let encoded = |bytes: &[u8]| match (is_raw, is_zlib) {
            (true, false) => with_length(bytes),
            (true, true) => zlib(bytes).concat(),
            (false, false) => STANDARD.encode(with_length(bytes)).into_bytes(),
            (false, true) => zlib(bytes).map(|part| STANDARD.encode(part)).concat().into_bytes(),
        };
        let (first, second) = (encoded(&places), encoded(&radii));
        let encoding = if is_raw { "raw" } else { "base64" };
        let appended =
            [format!("<AppendedData encoding=\"{encoding}\">\n _").as_bytes(), &first, &second].concat();
        let appended = [&appended[..], b"\n</AppendedData>\n"].concat();
        let at = format!("format=\"appended\" offset=\"{}\"", first.len());
        let declared = [("format=\"appended\" offset=\"0\"", ""), (at.as_str(), "")];
        let content = in_xml(if is_zlib { compressor } else { "" }, declared, &appended);
        assert_eq!(read_vtk(&content), Ok(expected_free()), "{is_raw} {is_zlib}");
    }
    // Files written by this program give their unit.
    let packing = Packing { cell: Cell::Free, ..expected_free() };
    let options = ReadOptions { unit: None, cell: Some(CellOption::None) };
    let (back, _) = Packing::parse_as("grains.vtp", packing.to_vtp().as_bytes(), &options).unwrap();
    assert_eq!(back, packing);
}

#[test]
fn files_of_vtk_that_are_broken_are_refused_with_their_place() {
    let legacy = |from: &str, to: &str| LEGACY.replacen(from, to, 1).into_bytes();
    let array = "format=\"ascii\"";
    let xml = |attributes: &str, radii: &str| {
        in_xml(attributes, [(array, "0.5 1 2 1.5 2.5 3.25"), (array, radii)], b"")
    };
    let changed =
        |from: &str, to: &str| String::from_utf8(xml("", "1 1")).unwrap().replace(from, to).into_bytes();
    for (content, message) in [
        (legacy("POLYDATA", "STRUCTURED_POINTS"), "f, line 4, dataset: \"STRUCTURED_POINTS\""),
        (legacy("radius", "size"), "f, line 5, arrays of the points: \"size\""),
        (legacy("0.375", "-1"), "f, line 14, diameter: \"-1\" | a finite number above"),
        (legacy("0.375\n", ""), "expected further numbers"),
        (legacy("0.375", "much"), "f, line 17, number: \"much\""),
        (legacy("2.5", "nan"), "f, line 5, y: \"NaN\""),
        (legacy("POINTS 2", "POINTS 99999999999999999"), "expected 99999999999999999 times 3 numbers"),
        (legacy("POINTS 2 float", "POINTS 2 string"), "f, line 5, type: \"string\""),
        (legacy("ASCII", "TEXT"), "f, line 3, form: \"TEXT\" | ASCII or BINARY"),
        (xml("", "0.5"), "f, line 6, diameter: \"1 numbers\" | 2 numbers"),
        (
            in_xml("", [(array, "0.5 1 2 1.5"), (array, "1 1")], b""),
            "f, line 8, points: \"4 numbers\" | x, y and z of 2 points, as NumberOf",
        ),
        (changed("</VTKFile>", ""), "expected </VTKFile>"),
        (changed("Points=\"2\"", "Points=\"9\""), "x, y and z of 9 points"),
        (xml("byte_order=\"Middle\"", "1 1"), "f, line 2, byte_order: \"Middle\""),
        (xml("", "0.5 x"), "f, line 6, number: \"x\""),
        (
            xml("compressor=\"vtkLZ4DataCompressor\"", "1 1"),
            "f, line 2, compressor: \"vtkLZ4DataCompressor\"",
        ),
        (b"<VTKFile type=\"PPolyData\">".to_vec(), "of a parallel file give a piece"),
        (in_xml("", [("format=\"binary\"", "AAAA"), (array, "1 1")], b""), "expected all bytes of the array"),
        (
            in_xml("", [("format=\"appended\" offset=\"0\"", ""), (array, "1 1")], b""),
            "expected AppendedData with the numbers",
        ),
        (gzip(&gzip(LEGACY.as_bytes())), "packed twice (gzip)"),
        (gzip(LEGACY.as_bytes())[..40].to_vec(), "f: cannot be read: its gzip is broken"),
    ] {
        assert_refused(read_vtk(&content), message);
    }
}

proptest! {
    /// No bytes cause a panic.
    #[test]
    fn no_file_of_vtk_makes_it_panic(at in 0usize..600, byte: u8, form in 0usize..3) {
        let zlib = [&PLACES[..], &RADII]
            .map(|values| zlib(&floats(values, false)).map(|part| STANDARD.encode(part)).concat());
        let inline = [("format=\"binary\"", zlib[0].as_str()), ("format=\"binary\"", &zlib[1])];
        let mut content = match form {
            0 => LEGACY.as_bytes().to_vec(),
            1 => LEGACY.replace("ASCII", "BINARY").into_bytes(),
            _ => in_xml("compressor=\"vtkZLibDataCompressor\"", inline, b""),
        };
        let at = at % content.len();
        content[at] = byte;
        let _ = read_vtk(&content);
        let _ = read_vtk(&content[..at]);
    }
}
