//! Packing files: every dress, every refusal with its words, and no panic.

use super::{Cell, Packing};
use proptest::prelude::*;

const CSV: &str = "# cell_mm = 2, 3, 4\nx_mm,y_mm,z_mm,diameter_mm\n0.5,1,2,1\n1.5,2.5,3.25,0.75\n";
const DUMP: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n-1 1\n0 3\n1 5\n\
                    ITEM: ATOMS id type x y z radius\n2 1 0.5 2.5 4.25 0.375\n1 1 -0.5 1 3 0.5\n";

fn parsed(text: &str) -> Result<Packing, String> {
    Packing::parse("f", text.as_bytes()).map_err(|error| error.to_string())
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

/// A dump says once what its lengths are, before its first frame or before each.
#[test]
fn a_dump_says_which_frame_and_which_units_were_taken() {
    let units = |name: &str| format!("ITEM: UNITS\n{name}\n");
    let read = |text: &str| {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("dump");
        std::fs::write(&path, text).unwrap();
        Packing::read_with_notes(&path)
    };
    for (name, scale, words) in [
        ("si", 1e3, "metres"),
        ("cgs", 10.0, "centimetres"),
        ("micro", 1e-3, "micro"),
        ("nano", 1e-6, "nano"),
    ] {
        let first = DUMP.replace("0.375", "9").replace("TIMESTEP\n0", "TIMESTEP\n-1");
        for text in
            [format!("{}{first}{DUMP}", units(name)), format!("{}{first}{}{DUMP}", units(name), units(name))]
        {
            let (packing, notes) = read(&text).unwrap();
            assert_eq!(packing.diameter, [scale, 0.75 * scale], "{text}");
            assert_eq!(packing.x, [0.5 * scale, 1.5 * scale]);
            assert_eq!(packing.cell, Cell::Periodic([2.0 * scale, 3.0 * scale, 4.0 * scale]));
            assert!(notes[0].ends_with("holds 2 frames: the last one, timestep 0, is taken"), "{notes:?}");
            assert!(notes[1].contains(&format!("ITEM: UNITS {name}: lengths are in {words}")), "{notes:?}");
        }
    }
    assert_eq!(read(DUMP).unwrap(), (expected(), Vec::new()));
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

/// Each bad file carries what must be said about it.
#[test]
fn bad_files_are_refused_with_their_place() {
    let csv = |from: &str, to: &str| CSV.replacen(from, to, 1);
    let dump = |from: &str, to: &str| DUMP.replacen(from, to, 1);
    for (text, message) in [
        (String::new(), "f ends after line 0; expected a first line \"# cell_mm"),
        (csv("# cell_mm = 2, 3, 4\n", ""), "f, line 1, cell: \"x_mm,y_mm,z_mm,diameter_mm\" is not allowed"),
        (csv("2, 3, 4", "2, 3"), "f, line 1, cell"),
        (
            csv("2, 3, 4", "2, nan, 4"),
            "f, line 1, cell_mm: \"nan\" is not allowed; allowed: a finite number above 0",
        ),
        (csv("2, 3, 4", "2, 0, 4"), "f, line 1, cell_mm: \"0\""),
        (csv("diameter_mm", "diameter"), "f, line 2, header: \"x_mm,y_mm,z_mm,diameter\""),
        (csv("x_mm,y_mm", "x_mm,x_mm"), "(2 called x_mm found)"),
        (
            csv("0.5,1,2,1", "0.5,inf,2,1"),
            "f, line 3, y_mm: \"inf\" is not allowed; allowed: a finite number",
        ),
        (csv("0.5,1,2,1", "0.5,1e400,2,1"), "f, line 3, y_mm: \"1e400\""),
        (
            csv("0.5,1,2,1", "0.5,1,2"),
            "f, line 3, diameter_mm: \"0.5,1,2\" is not allowed; allowed: 4 fields",
        ),
        (
            csv("0.5,1,2,1", "0.5,1,2,-1"),
            "f, line 3, diameter_mm: \"-1\" is not allowed; allowed: a finite number above 0",
        ),
        (csv("0.5,1,2,1\n1.5,2.5,3.25,0.75\n", ""), "f ends after line 2; expected at least one grain"),
        (dump("pp pp pp", "pp ff pp"), "f, line 5, box bounds: \"pp ff pp\""),
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
        let found = parsed(&text).unwrap_err();
        assert!(found.contains(message), "{found}\n{text}");
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
    /// Cut, garbled or repeated: an answer or an error, never a panic.
    #[test]
    fn no_file_makes_it_panic(cut in 0usize..200, at in 0usize..200, with in ".{0,6}", which: bool) {
        let mut text: Vec<char> = if which { CSV } else { DUMP }.chars().collect();
        let at = at.min(text.len());
        text.splice(at..(at + with.len()).min(text.len()), with.chars());
        text.truncate(text.len() - cut.min(text.len()) / 2);
        let text: String = text.into_iter().collect();
        if let Ok(packing) = parsed(&text) {
            prop_assert_eq!(packing.x.len(), packing.diameter.len());
        }
    }
}
