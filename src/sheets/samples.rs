//! Many samples: every soil of a file, or of every file in a folder.

use std::path::{Path, PathBuf};

use super::heading::says_limit;
use super::names;
use super::read::{all_in_file, curves_in_file, file_and_soil};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::gradation::{GradationError, TableError};

/// One of many samples.
#[derive(Clone, Debug)]
pub struct SoilSample {
    /// Name of the sample: its name in the file, preceded by the file's name if a folder has several files.
    /// The file's name includes its ending if two files of a folder differ in that alone.
    pub name: String,
    /// Path on a command line: `site.ags#BH1 1.50`, or the file alone if it holds no other soil.
    pub path: PathBuf,
    /// Sieve curve.
    pub curve: Gradation,
}

/// Endings of the files of a folder that are read.
const ENDINGS: [&str; 5] = ["csv", "txt", "xlsx", "ods", "ags"];

/// Every sample of a file, or the one that `path` names after a `#`. For a folder, the samples of every table
/// in it, file by file in the order of their names; folders within it are not searched.
///
/// # Errors
/// A folder without a table; a file that cannot be read as one, with the errors of [`curves_in_file`]; limits
/// of a specification, or the mean of others, beside the samples.
pub fn samples_in(path: &Path) -> Result<Vec<SoilSample>, GradationError> {
    in_files(path, &|file| {
        let curves = curves_in_file(file, None)?;
        let names: Vec<&str> = curves.iter().map(|(name, _)| name.as_str()).collect();
        let what = "limits, which are no samples";
        names::ask_about(&file.display().to_string(), &names, says_limit, what)?;
        Ok(curves)
    })
}

/// Curves of an envelope: every soil of a file, or the one that `path` names after a `#`.
///
/// # Errors
/// Errors of [`curves_in_file`].
pub fn envelope_in(path: &Path) -> Result<Vec<SoilSample>, GradationError> {
    in_file(path, &|file| curves_in_file(file, None))
}

/// Every soil of a file or a folder, like [`samples_in`], together with soils that are no samples.
///
/// # Errors
/// A folder without a table; a file that cannot be read as one.
pub fn named_soils_in(path: &Path) -> Result<Vec<SoilSample>, GradationError> {
    in_files(path, &all_in_file)
}

/// The names and curves of a file.
type Curves<'a> = &'a dyn Fn(&Path) -> Result<Vec<(String, Gradation)>, GradationError>;

fn in_files(path: &Path, curves: Curves) -> Result<Vec<SoilSample>, GradationError> {
    if !path.is_dir() {
        return in_file(path, curves);
    }
    let folder = || path.display().to_string();
    let read = |source| TableError::Read { file: folder(), source };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(read)? {
        let file = entry.map_err(read)?.path();
        let ending = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let is_hidden = file.file_name().unwrap_or_default().to_string_lossy().starts_with('.');
        if file.is_file() && !is_hidden && ENDINGS.contains(&&*ending) {
            files.push(file);
        }
    }
    if files.is_empty() {
        return Err(TableError::NoTables { folder: folder(), endings: ENDINGS.join(", .") }.into());
    }
    files.sort();
    // Names that some disks and some readers take as equal count as equal.
    let lower = |stem: &str| stem.to_lowercase();
    let stem = |file: &PathBuf| file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let stems: Vec<String> = files.iter().map(stem).collect();
    let mut samples = Vec::new();
    for (file, stem) in files.iter().zip(&stems) {
        let is_alone = stems.iter().filter(|other| lower(other) == lower(stem)).count() == 1;
        let whole = || file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let stem = if is_alone { stem.clone() } else { whole() };
        let of_file = in_file(file, curves)?;
        let several = of_file.len() > 1;
        samples.extend(of_file.into_iter().map(|sample| {
            let name = if several { format!("{stem}/{}", sample.name) } else { stem.clone() };
            SoilSample { name, ..sample }
        }));
    }
    Ok(samples)
}

fn in_file(path: &Path, curves: Curves) -> Result<Vec<SoilSample>, GradationError> {
    let curves = curves(path)?;
    let several = curves.len() > 1;
    let (file, _) = file_and_soil(path);
    let sample = |(name, curve): (String, Gradation)| {
        let path =
            if several { PathBuf::from(format!("{}#{name}", file.display())) } else { path.to_owned() };
        SoilSample { name, path, curve }
    };
    Ok(curves.into_iter().map(sample).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_gradation;

    #[test]
    fn a_folder_has_the_samples_of_all_its_tables_in_order() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(root.path().join(name), text).unwrap();
        write("notes.md", "no table");
        assert!(
            samples_in(root.path())
                .unwrap_err()
                .to_string()
                .contains("no table in it; allowed: files of .csv")
        );
        write("b.csv", "opening_mm,percent_finer\n2,100\n0.5,0\n");
        write("a.csv", "Sieve (mm),Core,Shell\n2,100,100\n0.5,40,10\n0.1,0,0\n");
        let samples = samples_in(root.path()).unwrap();
        let names: Vec<&str> = samples.iter().map(|sample| sample.name.as_str()).collect();
        assert_eq!(names, ["a/Core", "a/Shell", "b"]);
        for sample in &samples {
            let again = read_gradation(&sample.path, None).unwrap();
            assert_eq!(again.d(50.0), sample.curve.d(50.0), "{}", sample.path.display());
        }
        write("c.csv", "nothing");
        assert!(samples_in(root.path()).unwrap_err().to_string().contains("c.csv"));
    }

    #[test]
    fn means_and_limits_are_no_samples_unless_they_are_named() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.csv");
        let write = |heads: &str| {
            let rows = "2,100,100,100\n0.5,40,45,50\n0.1,2,3,4\n";
            std::fs::write(&path, format!("Sieve (mm),{heads}\n{rows}")).unwrap();
        };
        let one = |name: &str| read_gradation(root.path().join(format!("a.csv#{name}")), None);
        write("Min,Result,Max");
        assert!(
            samples_in(&path).unwrap_err().to_string().contains("limits, which are no samples: Min, Max")
        );
        assert_eq!(curves_in_file(&path, None).unwrap().len(), 3);
        assert_eq!(named_soils_in(&path).unwrap().len(), 3);
        assert_eq!(samples_in(&root.path().join("a.csv#Result")).unwrap().len(), 1);
        write("Test 1 % passing,Average % passing,Test 2 % passing");
        assert!(curves_in_file(&path, None).unwrap_err().to_string().contains("means, which are no samples"));
        assert!(samples_in(&path).is_err() && named_soils_in(&path).is_ok());
        assert_eq!(one("Average % passing").unwrap().percent_finer_if_known(0.5), Some(45.0));
        write("Upper shell,Lower shell,Core");
        assert_eq!(samples_in(&path).unwrap().len(), 3);
    }

    /// Two files of one stem, and a `#` in the names of files and soils: every sample is read again by its
    /// path.
    #[test]
    fn a_sample_called_d_is_no_second_column_of_openings() {
        let root = tempfile::tempdir().unwrap();
        let names = |text: &str| -> Vec<String> {
            let path = root.path().join("a.csv");
            std::fs::write(&path, text).unwrap();
            samples_in(&path).unwrap().into_iter().map(|sample| sample.name).collect()
        };
        let five = "Sieve (mm),A,B,C,D,E\n2,100,100,100,100,100\n0.5,40,10,20,30,50\n0.1,0,0,0,0,0\n";
        assert_eq!(names(five), ["A", "B", "C", "D", "E"]);
        let four = "Sieve (mm),A,B,C,d\n2,100,100,100,100\n0.5,40,10,20,30\n0.1,0,0,0,0\n";
        assert_eq!(names(four), ["A", "B", "C", "d"]);
        // An ordinary column of openings.
        assert_eq!(names("D,A,B\n2,100,100\n0.5,40,10\n0.1,0,0\n"), ["A", "B"]);
        assert_eq!(names("D,C,E\n2,100,100\n0.5,40,10\n0.1,0,0\n"), ["C", "E"]);
    }

    #[test]
    fn names_that_look_alike_are_told_apart() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(root.path().join(name), text).unwrap();
        write("a.csv", "opening_mm,percent_finer\n2,100\n0.5,0\n");
        write("A.txt", "opening_mm,percent_finer\n4,100\n0.5,0\n");
        write("b#1.csv", "Sieve (mm),BH#1,BH#2\n2,100,100\n0.5,40,10\n0.1,0,0\n");
        write("c#2.csv", "opening_mm,percent_finer\n8,100\n0.5,0\n");
        let samples = samples_in(root.path()).unwrap();
        let names: Vec<&str> = samples.iter().map(|sample| sample.name.as_str()).collect();
        assert_eq!(names, ["A.txt", "a.csv", "b#1/BH#1", "b#1/BH#2", "c#2"]);
        for sample in &samples {
            let again = read_gradation(&sample.path, None).unwrap();
            assert_eq!(again.d(50.0), sample.curve.d(50.0), "{}", sample.path.display());
        }
        let none = file_and_soil(&root.path().join("none.xlsx#Filter A"));
        assert_eq!(none, (root.path().join("none.xlsx"), Some("Filter A".into())));
    }
}
