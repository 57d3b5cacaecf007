//! Every table in `tests/bad` is refused with exactly the message in the `.txt` file beside it, and
//! tables that only look unusual are read.

use std::path::Path;
use voidwalk::constrictions::Curve;
use voidwalk::gradation::{FILE_LIMIT_BYTES, Gradation};
use voidwalk::sheets::{parse_gradation, read_gradation};

/// Each bad table of `folder` against its message; `read` gives the message of a file.
fn check(folder: &str, least: usize, read: impl Fn(&Path) -> String) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad").join(folder);
    let mut seen = 0;
    let mut wrong = String::new();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "csv") {
            continue;
        }
        seen += 1;
        let found = read(&path).replace(&format!("{}/", folder.display()), "");
        let expected = std::fs::read_to_string(path.with_extension("txt")).unwrap_or_default();
        if found != expected.trim_end() {
            wrong += &format!("{}\n  found    {found}\n  expected {expected}\n", path.display());
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(seen >= least, "{seen} bad tables found");
}

#[test]
fn bad_sieve_tables_are_refused() {
    check("sieve", 42, |path| match read_gradation(path, None) {
        Ok(gradation) => format!("{gradation:?}"),
        Err(error) => error.to_string(),
    });
}

#[test]
fn bad_curves_are_refused() {
    check("curve", 16, |path| match Curve::from_csv(path) {
        Ok(curve) => format!("{curve:?}"),
        Err(error) => error.to_string(),
    });
}

#[test]
fn a_folder_a_missing_file_and_a_huge_file_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: &Path| read_gradation(path, None).unwrap_err().to_string();
    assert_eq!(
        message(folder.path()),
        format!("{} is a folder; allowed: a CSV file of two columns", folder.path().display())
    );
    let missing = folder.path().join("none.csv");
    assert!(message(&missing).starts_with(&format!("{}: cannot be read: ", missing.display())));
    let huge = folder.path().join("huge.csv");
    std::fs::File::create(&huge).unwrap().set_len(FILE_LIMIT_BYTES + 1).unwrap();
    assert_eq!(
        message(&huge),
        format!(
            "{} is larger than 16 MB; allowed: a CSV file of two columns up to that size",
            huge.display()
        )
    );
    assert!(Curve::from_csv(&huge).unwrap_err().to_string().contains("larger than 16 MB"));
}

/// A file that never ends is not a regular file, and is not read at all.
#[cfg(target_os = "linux")]
#[test]
fn an_endless_file_is_refused() {
    let message = read_gradation("/dev/zero", None).unwrap_err().to_string();
    assert!(message.contains("/dev/zero") && message.contains("not a regular file"), "{message}");
}

#[test]
fn unusual_tables_are_read() {
    let expected = Gradation::from_points(&[(0.5, 0.0), (1.5, 20.5), (4.0, 100.0)], None).unwrap();
    for text in [
        "0.5,0\n1.5,20.5\n4,100\n",
        "4,100\n1.5,20.5\n0.5,0",
        "opening_mm,percent_finer\n0.5,0\n1.5,20.5\n4,100\n",
        "percent_finer,opening_mm\n0,0.5\n20.5,1.5\n100,4\n",
        "Passing (%);Sieve size (mm)\n0;0,5\n20,5;1,5\n100;4\n",
        "\u{feff}Opening in mm,% finer by mass\r\n0.5,0\r\n1.5,20.5\r\n4,100\r\n",
        "Sieböffnung;Durchgang\n0,5;0\n1,5;20,5\n4,0;100\n",
        "# lab 7\n\n  # again\nd\tF\n0,5\t0\n1,5\t20,5\n4\t100\n\n",
        "\"0,5\",\"0\"\n\"1,5\",\"20,5\"\n\"4\",\"100\"\n",
        "0.5,0,,\n1.5,20.5,\n,,\n4,100\n",
        " 5e-1 , -0 \n +1.5 , 20.5 \n 4. , 1e+2 \n",
        "0.2,0\n0.3,0\n0.5,0\n1.5,20.5\n4,100\n8,100\n16,100\n",
    ] {
        let found = parse_gradation("t.csv", text.as_bytes(), None);
        assert_eq!(found.unwrap_or_else(|e| panic!("{text:?}: {e}")), expected, "{text:?}");
    }
}

#[test]
fn unusual_curves_are_read() {
    let expected = [[0.25, 0.0], [0.5, 50.0], [1.0, 100.0]];
    for text in [
        "percent_smaller,diameter_mm\n0,0.25\n50,0.5\n100,1\n",
        "diameter_mm,percent_smaller\n0.25,0\n0.5,50\n1,100\n",
        "\u{feff}Percent_Smaller;Diameter_mm\r\n100;1,0\r\n50;0,5\r\n0;0,25\r\n",
        "percent_smaller,diameter_mm\n0,0.1\n0,0.25\n50,0.5\n50,0.5\n100,1\n100,2\n",
    ] {
        let curve = Curve::from_csv_text("t.csv", text.as_bytes()).unwrap();
        assert_eq!(
            curve.points().into_iter().map(|point| point.row()).collect::<Vec<_>>(),
            expected,
            "{text:?}"
        );
    }
}

#[test]
fn the_smallest_size_must_fit_the_table() {
    let tail = b"1,20\n2,60\n4,100\n";
    let whole = b"1,0\n2,60\n4,100\n";
    let message = |text, d0| parse_gradation("t.csv", text, Some(d0)).unwrap_err().to_string();
    assert_eq!(
        message(&tail[..], 1.0),
        "d0_mm = 1.0 is not allowed; allowed: a size below the finest opening of t.csv, 1 mm"
    );
    assert_eq!(message(&tail[..], -1.0), "d0_mm = -1.0 is not allowed; allowed: a number from 1e-12 to 1e12");
    assert_eq!(
        message(&whole[..], 0.5),
        "d0_mm = 0.5 is not allowed; allowed: none, since t.csv itself goes down to 0 % (at 1 mm)"
    );
    let one = parse_gradation("t.csv", b"2,100\n", Some(1.0)).unwrap();
    assert_eq!(one.points(), Gradation::from_points(&[(1.0, 0.0), (2.0, 100.0)], None).unwrap().points());
}
