//! Steps from a file to its soils, and from many files to samples.

use super::blocks::Block;
use super::content::whole_row;
use super::grid::{Grid, Place, names_listed};
use super::heading::{Role, says_limit, says_mean};
use super::layout::{Layout, SoilColumn};
use super::names::Read;
use super::soil::{Soil, SoilSummary};
use super::units::{TAKEN_AS_MM, WITH_UNIT, states_unit};
use super::workbook::{Zipped, unreadable};
use super::{ags, blocks, names, ods, points, roles, text, xlsx};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use voidwalk_core::gradation::{
    FILE_LIMIT_BYTES, Gradation, GradationError, TableError, bytes_of, letters, shortened,
};
use voidwalk_core::text::plain;

impl Soil {
    /// Reads all soils in a file; messages call it `file`.
    ///
    /// # Errors
    /// No table, or one that cannot be understood or could be understood in two ways.
    pub fn all(file: &str, bytes: &[u8]) -> Result<Vec<Soil>, GradationError> {
        let soils = tables(file, bytes, None)?;
        Ok(soils.into_iter().map(|(_, soil)| soil).collect::<Result<_, _>>()?)
    }

    /// Reads the only soil in a file, or the one with this name: the name of a sheet, of a column, or
    /// both as `sheet/column`.
    ///
    /// # Errors
    /// Errors of [`Soil::all`] for this soil; several soils, or no soil with this name.
    pub fn one(file: &str, bytes: &[u8], name: Option<&str>) -> Result<Soil, GradationError> {
        let mut soils = tables(file, bytes, name)?;
        let all =
            |soils: &[Named]| -> Vec<String> { soils.iter().map(|(names, _)| names[0].clone()).collect() };
        let (file, names) = (file.to_owned(), all(&soils));
        if let Some(name) = name {
            soils.retain(|(names, _)| is_named(names, name));
            if soils.is_empty() {
                let (name, soils) = (shortened(name), names_listed(&names));
                return Err(TableError::NoSuchSoil { file, name, soils }.into());
            }
        }
        if soils.len() > 1 {
            let names = all(&soils);
            let (soils, first) = (names_listed(&names), plain(&names[0]));
            return Err(TableError::SeveralSoils { file, soils, first }.into());
        }
        let (_, soil) = soils.pop().ok_or(TableError::NoRows { file, header: false })?;
        Ok(soil?)
    }
}

/// Splits a scene's `path` into its file and the name of the soil in it: `site.xlsx#Filter A`. Names of
/// files and soils may contain a `#`: the path is split at the first one after the name of an existing
/// file, or at the last one if there is no such file.
pub fn file_and_soil(path: &Path) -> (PathBuf, Option<String>) {
    let Some(text) = path.to_str().filter(|_| !path.exists()) else { return (path.to_owned(), None) };
    let is_named = |(file, soil): &(&str, &str)| !file.is_empty() && !soil.trim().is_empty();
    let at = |at: usize| (&text[..at], &text[at + 1..]);
    let mut places = text.match_indices('#').map(|(place, _)| at(place)).filter(is_named);
    let of_file = places.find(|(file, _)| Path::new(file).is_file());
    match of_file.or_else(|| text.rsplit_once('#').filter(is_named)) {
        Some((file, soil)) => (PathBuf::from(file), Some(soil.trim().to_owned())),
        None => (path.to_owned(), None),
    }
}

/// Returns a name as displayed, without the differences between two spellings of it.
fn folded(name: &str) -> String {
    plain(name).split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase()
}

/// Names of a soil, the full one first, and its table.
type Named = (Vec<String>, Result<Soil, TableError>);

/// Every table that looks like a soil.
fn tables(file: &str, bytes: &[u8], wanted: Option<&str>) -> Result<Vec<Named>, TableError> {
    if bytes.len() as u64 > FILE_LIMIT_BYTES {
        return Err(TableError::TooLarge { file: file.into(), limit: FILE_LIMIT_BYTES });
    }
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        return of_workbook(file, bytes, wanted);
    }
    let (text, note) = text::decoded(file, bytes)?;
    if ags::is_ags(&text) {
        return of_ags(ags::soils(file, &text)?);
    }
    let mut refusal = None;
    for delimiter in text::separators(&text) {
        let mut grid = text::grid(file, &text, delimiter);
        grid.notes.extend(note.clone());
        if grid.rows.is_empty() {
            return Err(TableError::NoRows { file: file.into(), header: false });
        }
        // A text that is no table with the first separator may become one with another.
        match soils_of(grid) {
            Ok(soils) if soils.iter().any(|(_, soil)| soil.is_ok()) => {
                refuse_commented_unit(file, &text, &soils)?;
                return Ok(soils);
            }
            Ok(mut soils) => refusal = refusal.or(soils.pop().and_then(|(_, soil)| soil.err())),
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    Err(refusal.unwrap_or(TableError::NoRows { file: file.into(), header: false }))
}

/// Refuses openings that were taken as mm if a comment names another unit.
fn refuse_commented_unit(file: &str, text: &str, soils: &[Named]) -> Result<(), TableError> {
    let is_taken = |soil: &Soil| soil.notes.iter().any(|note| note == TAKEN_AS_MM);
    let mut comments = text.lines().enumerate().filter(|(_, line)| line.trim_start().starts_with('#'));
    if soils.iter().any(|(_, soil)| soil.as_ref().is_ok_and(is_taken))
        && let Some((index, line)) = comments.find(|(_, line)| states_unit(line))
    {
        let (file, line, value) = (file.to_owned(), index + 1, shortened(line));
        return Err(TableError::Header { file, line, value, allowed: WITH_UNIT.into() });
    }
    Ok(())
}

fn of_ags(tables: Vec<(String, Grid, Layout)>) -> Result<Vec<Named>, TableError> {
    let mut named = Vec::new();
    for (name, grid, layout) in tables {
        named.extend(points::soils(&grid, &layout)?.into_iter().map(|soil| (vec![name.clone()], soil)));
    }
    Ok(named)
}

/// Reads the soils of every sheet. A sheet without a table, such as a cover, is skipped with a note if
/// other sheets have one; if it was requested by name, its error is returned.
fn of_workbook(file: &str, bytes: &[u8], wanted: Option<&str>) -> Result<Vec<Named>, TableError> {
    let (mut soils, mut refusals) = (Vec::new(), Vec::new());
    let sheets = sheets(file, bytes)?;
    if sheets.is_empty() {
        return Err(TableError::NoRows { file: file.into(), header: false });
    }
    for grid in sheets {
        let sheet = grid.sheet.clone().unwrap_or_default();
        // Rows that are each in one cell also count as a table.
        let torn = grid.rows.iter().filter(|row| whole_row(row, false).is_some()).count();
        let (place, has_table) = (grid.place(), blocks::has_table(&grid) || torn > 1);
        let read = match ags::is_ags_sheet(&grid) {
            true => ags::soils_of_sheet(&grid).and_then(of_ags),
            false => soils_of(grid),
        };
        match read {
            Ok(tables) if !has_table && tables.iter().all(|(_, soil)| soil.is_err()) => {
                refusals.push((sheet, TableError::NoRows { file: place, header: false }));
            }
            Ok(tables) => soils.extend(tables),
            // A table that exists but cannot be read is not skipped.
            Err(error @ (TableError::Value { .. } | TableError::Header { .. })) if has_table => {
                soils.push((vec![sheet], Err(error)));
            }
            Err(error) => refusals.push((sheet, error)),
        }
    }
    if let Some(wanted) = wanted
        && !soils.iter().any(|(names, _)| is_named(names, wanted))
        && let Some(at) = refusals.iter().position(|(sheet, _)| folded(wanted) == folded(sheet))
    {
        return Err(refusals.swap_remove(at).1);
    }
    if soils.is_empty() && !refusals.is_empty() {
        return Err(refusals.swap_remove(0).1);
    }
    if !refusals.is_empty() && wanted.is_none() {
        let all: Vec<String> = refusals.iter().map(|(sheet, _)| format!("\"{sheet}\"")).collect();
        let note = format!("no table was found in sheet {}", names_listed(&all));
        soils.iter_mut().filter_map(|(_, soil)| soil.as_mut().ok()).for_each(|s| s.notes.push(note.clone()));
    }
    Ok(soils)
}

fn is_named(names: &[String], wanted: &str) -> bool {
    names.iter().any(|name| folded(name) == folded(wanted))
}

fn soils_of(grid: Grid) -> Result<Vec<Named>, TableError> {
    let mut blocks = blocks::blocks(grid)?;
    let several = blocks.len() > 1;
    blocks.iter_mut().for_each(names::name_columns);
    let titles = if several { names::titles(&blocks) } else { vec![String::new(); blocks.len()] };
    let read = |(mut block, title): (Block, String)| {
        let title = block.sample.take().unwrap_or(title);
        roles::settle_bounds(&mut block.grid, &mut block.layout)?;
        let soils = points::soils(&block.grid, &block.layout)?;
        Ok(Read { block, title, soils })
    };
    let tables = names::joined(blocks.into_iter().zip(titles).map(read).collect::<Result<_, _>>()?)?;
    Ok(named(tables))
}

/// Names the soils: by the title of their table, the heading of their column, or both, and the sheet.
fn named(tables: Vec<Read>) -> Vec<Named> {
    let single = tables.iter().map(|table| table.soils.len()).sum::<usize>() == 1;
    let several = tables.len() > 1;
    let own_name = |table: &Read, column: &SoilColumn| match (table.title.as_str(), &column.heading) {
        ("", heading) => heading.clone(),
        (title, _) if table.soils.len() == 1 => title.to_owned(),
        (title, heading) => format!("{title} {heading}"),
    };
    let mut times: HashMap<String, usize> = HashMap::new();
    for table in &tables {
        for column in &table.block.layout.soils {
            *times.entry(folded(&own_name(table, column))).or_default() += 1;
        }
    }
    let mut soils = Vec::new();
    for table in tables {
        let (grid, layout) = (&table.block.grid, &table.block.layout);
        let names: Vec<Vec<String>> = layout
            .soils
            .iter()
            .map(|column| {
                let mut name = own_name(&table, column);
                if single && grid.sheet.is_none() && column.role != Role::Other {
                    // `% passing` is not a name.
                    name.clear();
                } else if name.is_empty() || times[&folded(&name)] > 1 {
                    let Place { line, column } = grid.place_of(table.block.line(), column.column);
                    let letters = letters(column as u32);
                    let place = match (grid.across.is_some(), several, grid.sheet.is_some()) {
                        (true, _, true) => format!("row {line}"),
                        (true, _, false) => format!("line {line}"),
                        (false, true, true) => format!("cell {letters}{line}"),
                        (false, true, false) => format!("line {line}, column {}", column + 1),
                        (false, false, _) => format!("column {letters}"),
                    };
                    name = format!("{name} ({place})").trim().to_owned();
                }
                match &grid.sheet {
                    Some(sheet) if single => vec![sheet.clone(), name],
                    Some(sheet) => vec![format!("{sheet}/{name}"), name],
                    None => vec![name],
                }
            })
            .collect();
        for (names, soil) in names.into_iter().zip(table.soils) {
            let soil = soil.map(|soil| Soil { name: names[0].clone(), ..soil });
            soils.push((names, soil));
        }
    }
    soils
}

/// Reads the soils of a file, or the one that `path` names after a `#`; a soil without a name gets that
/// of its file.
fn soils_of_file(path: &Path) -> Result<Vec<Soil>, GradationError> {
    let (path, name) = file_and_soil(path);
    let (file, bytes) = (path.display().to_string(), bytes_of(&path)?);
    let mut soils = match name {
        Some(name) => vec![Soil::one(&file, &bytes, Some(&name))?],
        None => Soil::all(&file, &bytes)?,
    };
    if let [soil] = &mut soils[..]
        && soil.name.is_empty()
    {
        soil.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    }
    Ok(soils)
}

/// Reads the soils of a file as samples; the mean of others is refused with a question.
fn samples_of_file(path: &Path) -> Result<Vec<Soil>, GradationError> {
    let soils = soils_of_file(path)?;
    names::refuse_unless_samples(path, soils.iter().map(Soil::name), says_mean, "means")?;
    Ok(soils)
}

fn curve(soil: &Soil, d0_mm: Option<f64>) -> Result<(String, Gradation), GradationError> {
    Ok((soil.name.clone(), soil.gradation(d0_mm)?))
}

/// Reads summaries of the soils of a file, or of the one that `path` names after a `#`.
pub fn soils_in_file(path: &Path, d0_mm: Option<f64>) -> Result<Vec<SoilSummary>, GradationError> {
    samples_of_file(path)?.iter().map(|soil| SoilSummary::of(soil, d0_mm)).collect()
}

/// Reads names and sieve curves of the soils of a file, or of the one that `path` names after a `#`.
pub fn curves_in_file(path: &Path, d0_mm: Option<f64>) -> Result<Vec<(String, Gradation)>, GradationError> {
    samples_of_file(path)?.iter().map(|soil| curve(soil, d0_mm)).collect()
}

/// Lists the assumptions about the soils of a file, or about the one that `path` names after a `#`,
/// without repetition.
pub fn notes_in_file(path: &Path) -> Result<Vec<String>, GradationError> {
    let mut seen = HashSet::new();
    let mut notes: Vec<String> = soils_of_file(path)?.into_iter().flat_map(|soil| soil.notes).collect();
    notes.retain(|note| seen.insert(note.clone()));
    Ok(notes)
}

/// Reads a sieve table from a file: `site.csv`, or `site.xlsx#Filter A` if it contains several soils.
///
/// `docs::soils` describes the tables that are understood. In a plain table, `opening_mm,percent_finer`,
/// the header may be left out, the columns may be in either order, and sizes may rise or fall.
///
/// # Errors
/// A file that cannot be read, is a folder, is larger than [`FILE_LIMIT_BYTES`] or contains no table; no
/// rows; a row that cannot be read; a value that is not a finite number in range; sizes that repeat or both
/// rise and fall; percent that falls as size rises; a coarsest size below 100 %; a single row without `d0_mm`
/// (all of its mass is of unknown size); a `d0_mm` that is not below the finest opening, or is not needed.
pub fn read_gradation(path: impl AsRef<Path>, d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
    let (path, name) = file_and_soil(path.as_ref());
    let (file, bytes) = (path.display().to_string(), bytes_of(&path)?);
    Soil::one(&file, &bytes, name.as_deref())?.gradation(d0_mm)
}

/// Reads the content of a file like [`read_gradation`]; messages call it `name`.
pub fn parse_gradation(name: &str, content: &[u8], d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
    Soil::one(name, content, None)?.gradation(d0_mm)
}

/// Reads the sheets that are not empty.
fn sheets(file: &str, bytes: &[u8]) -> Result<Vec<Grid>, TableError> {
    let mut zipped = Zipped::open(file, bytes)?;
    let sheets = if zipped.has("xl/workbook.xml") {
        xlsx::sheets(file, &mut zipped)?
    } else if zipped.has("content.xml") {
        ods::sheets(file, &mut zipped)?
    } else {
        return Err(unreadable(file, "it is a zip, but no workbook (.xlsx or .ods)"));
    };
    Ok(sheets.into_iter().filter(|sheet| !sheet.rows.is_empty()).collect())
}

/// One of many samples.
#[derive(Clone, Debug)]
pub struct SoilSample {
    /// Name of the sample: its name in the file, after the file's name if a folder has several files.
    /// The file's name includes its ending if two files in a folder differ only in that.
    pub name: String,
    /// Path on a command line: `site.ags#BH1 1.50`, or the file alone if it contains no other soil.
    pub path: PathBuf,
    /// Sieve curve.
    pub curve: Gradation,
}

const ENDINGS: [&str; 5] = ["csv", "txt", "xlsx", "ods", "ags"];

/// Reads every sample of a file, or the one that `path` names after a `#`. For a folder, reads the
/// samples of every table in it, by file in the order of their names; subfolders are not searched.
///
/// # Errors
/// A folder without a table; a file that cannot be read as one, with the errors of [`curves_in_file`];
/// limits of a specification, or a mean, among the samples.
pub fn samples_in(path: &Path) -> Result<Vec<SoilSample>, GradationError> {
    in_files(path, &|file| {
        let curves = curves_in_file(file, None)?;
        names::refuse_unless_samples(
            file,
            curves.iter().map(|(name, _)| name.as_str()),
            says_limit,
            "limits",
        )?;
        Ok(curves)
    })
}

/// Reads the curves of an envelope: every soil of a file, or the one that `path` names after a `#`.
pub fn envelope_in(path: &Path) -> Result<Vec<SoilSample>, GradationError> {
    in_file(path, &|file| curves_in_file(file, None))
}

/// Reads every soil of a file or a folder like [`samples_in`], including soils that are not samples.
///
/// # Errors
/// A folder without a table; a file that cannot be read as one.
pub fn named_soils_in(path: &Path) -> Result<Vec<SoilSample>, GradationError> {
    in_files(path, &|file| soils_of_file(file)?.iter().map(|soil| curve(soil, None)).collect())
}

type Curves<'a> = &'a dyn Fn(&Path) -> Result<Vec<(String, Gradation)>, GradationError>;

fn in_files(path: &Path, curves: Curves) -> Result<Vec<SoilSample>, GradationError> {
    if !path.is_dir() {
        return in_file(path, curves);
    }
    let folder = path.display().to_string();
    let read = |source| TableError::Read { file: folder.clone(), source };
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
        return Err(TableError::NoTables { folder, endings: ENDINGS.join(", .") }.into());
    }
    files.sort();
    // Names that some disks and some readers treat as equal count as equal.
    let lower = |file: &PathBuf| file.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    let mut samples = Vec::new();
    for file in &files {
        let is_alone = files.iter().filter(|other| lower(other) == lower(file)).count() == 1;
        let stem = if is_alone { file.file_stem() } else { file.file_name() };
        let stem = stem.unwrap_or_default().to_string_lossy();
        let of_file = in_file(file, curves)?;
        let several = of_file.len() > 1;
        samples.extend(of_file.into_iter().map(|sample| {
            let name = if several { format!("{stem}/{}", sample.name) } else { stem.to_string() };
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
        let named = || PathBuf::from(format!("{}#{name}", file.display()));
        let path = if several { named() } else { path.to_owned() };
        SoilSample { name, path, curve }
    };
    Ok(curves.into_iter().map(sample).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, name: &str, text: &str) {
        std::fs::write(folder.join(name), text).unwrap();
    }

    fn names(samples: &[SoilSample]) -> Vec<&str> {
        samples.iter().map(|sample| sample.name.as_str()).collect()
    }

    /// Checks that every sample can be read again by its path.
    fn read_again(samples: &[SoilSample]) {
        for sample in samples {
            let again = read_gradation(&sample.path, None).unwrap();
            assert_eq!(again.d(50.0), sample.curve.d(50.0), "{}", sample.path.display());
        }
    }

    #[test]
    fn a_folder_has_the_samples_of_all_its_tables_in_order() {
        let root = tempfile::tempdir().unwrap();
        let write = |name, text| write(root.path(), name, text);
        write("notes.md", "no table");
        let error = |path: &Path| samples_in(path).unwrap_err().to_string();
        assert!(error(root.path()).contains("no table in it; allowed: files of .csv"));
        write("b.csv", "opening_mm,percent_finer\n2,100\n0.5,0\n");
        write("a.csv", "Sieve (mm),Core,Shell\n2,100,100\n0.5,40,10\n0.1,0,0\n");
        let samples = samples_in(root.path()).unwrap();
        assert_eq!(names(&samples), ["a/Core", "a/Shell", "b"]);
        read_again(&samples);
        write("c.csv", "nothing");
        assert!(error(root.path()).contains("c.csv"));
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
        let error = samples_in(&path).unwrap_err().to_string();
        assert!(error.contains("limits, which are not samples: Min, Max"), "{error}");
        assert_eq!(curves_in_file(&path, None).unwrap().len(), 3);
        assert_eq!(named_soils_in(&path).unwrap().len(), 3);
        assert_eq!(samples_in(&root.path().join("a.csv#Result")).unwrap().len(), 1);
        write("Test 1 % passing,Average % passing,Test 2 % passing");
        let error = curves_in_file(&path, None).unwrap_err().to_string();
        assert!(error.contains("means, which are not samples"), "{error}");
        assert!(samples_in(&path).is_err() && named_soils_in(&path).is_ok());
        assert_eq!(one("Average % passing").unwrap().percent_finer_if_known(0.5), Some(45.0));
        write("Upper shell,Lower shell,Core");
        assert_eq!(samples_in(&path).unwrap().len(), 3);
    }

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

    /// Two files with the same stem, and a `#` in the names of files and soils: every sample can be read
    /// again by its path.
    #[test]
    fn names_that_look_alike_are_told_apart() {
        let root = tempfile::tempdir().unwrap();
        let write = |name, text| write(root.path(), name, text);
        write("a.csv", "opening_mm,percent_finer\n2,100\n0.5,0\n");
        write("A.txt", "opening_mm,percent_finer\n4,100\n0.5,0\n");
        write("b#1.csv", "Sieve (mm),BH#1,BH#2\n2,100,100\n0.5,40,10\n0.1,0,0\n");
        write("c#2.csv", "opening_mm,percent_finer\n8,100\n0.5,0\n");
        let samples = samples_in(root.path()).unwrap();
        assert_eq!(names(&samples), ["A.txt", "a.csv", "b#1/BH#1", "b#1/BH#2", "c#2"]);
        read_again(&samples);
        let none = file_and_soil(&root.path().join("none.xlsx#Filter A"));
        assert_eq!(none, (root.path().join("none.xlsx"), Some("Filter A".into())));
    }
}
