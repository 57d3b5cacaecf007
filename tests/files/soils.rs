//! Every file of `tests/soils` is understood or refused as the `.txt` beside it says. Of a file that is understood it
//! has a line for each soil, `NAME | size percent, size percent, ...` (mm, percent finer), and `note:` lines, each of
//! which must be in a note of the first soil; of a file that is refused `refused:` lines, each of which must be in the
//! message. Commit 16af1d7a has the script that made the workbooks.

use std::path::{Path, PathBuf};
use voidwalk::sheets::Soil;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/soils")
}

/// What is wrong with how a file is read, by what its text expects; nothing where all is well.
fn complaint(name: &str, expected: &str) -> Option<String> {
    let bytes = std::fs::read(folder().join(name)).unwrap();
    let lines = |lead: &str| -> Vec<String> {
        expected
            .lines()
            .filter_map(|line| line.strip_prefix(lead))
            .map(|line| line.trim().to_owned())
            .collect()
    };
    let refusals = lines("refused:");
    let soils = match Soil::all(name, &bytes) {
        Err(error) if refusals.is_empty() => return Some(format!("refused: {error}")),
        Err(error) => return missing(&error.to_string(), &refusals),
        Ok(soils) => soils,
    };
    let curves: Result<Vec<_>, _> = soils.iter().map(|soil| soil.gradation(None)).collect();
    let curves = match curves {
        Err(error) if refusals.is_empty() => return Some(format!("refused: {error}")),
        Err(error) => return missing(&error.to_string(), &refusals),
        Ok(curves) => curves,
    };
    if !refusals.is_empty() {
        return Some(format!("taken: {soils:?}"));
    }
    let wanted: Vec<(&str, &str)> = expected.lines().filter_map(|line| line.split_once('|')).collect();
    if wanted.len() != soils.len() {
        return Some(format!("{} soils: {soils:?}", soils.len()));
    }
    for ((soil, curve), (wanted_name, wanted)) in soils.iter().zip(&curves).zip(wanted) {
        let wanted: Vec<(f64, f64)> = wanted
            .split(',')
            .map(|pair| {
                let mut numbers = pair.split_whitespace().map(|number| number.parse::<f64>().unwrap());
                (numbers.next().unwrap(), numbers.next().unwrap())
            })
            .collect();
        // Sieves that all passes hold nothing: a curve begins at the first of them.
        let top = wanted.iter().position(|point| point.1 == 100.0).unwrap();
        let found = curve.points();
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-5 * b.abs().max(1e-9);
        let same = found.len() == top + 1
            && found.iter().zip(&wanted).all(|(f, w)| close(f.size, w.0) && close(f.percent, w.1));
        let named = wanted_name.trim();
        if !same || (!named.is_empty() && soil.name() != named) {
            return Some(format!("{:?}: {found:?}", soil.name()));
        }
    }
    missing(&soils[0].notes().join("\n"), &lines("note:"))
}

fn missing(text: &str, parts: &[String]) -> Option<String> {
    let absent: Vec<&String> = parts.iter().filter(|part| !text.contains(part.as_str())).collect();
    (!absent.is_empty()).then(|| format!("{text:?} lacks {absent:?}"))
}

#[test]
fn soils_are_understood_or_refused_as_the_text_beside_them_says() {
    let (mut taken, mut refused) = (0, 0);
    let mut wrong = String::new();
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        let Some(name) = path.file_name().unwrap().to_str().unwrap().strip_suffix(".txt") else { continue };
        let expected = std::fs::read_to_string(&path).unwrap();
        *(if expected.contains("refused:") { &mut refused } else { &mut taken }) += 1;
        if let Some(complaint) = complaint(name, &expected) {
            wrong += &format!("{name}: {complaint}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(taken >= 60 && refused >= 44, "{taken} taken, {refused} refused");
}
