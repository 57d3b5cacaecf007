//! The way from a file to its soils.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::blocks::Block;
use super::grid::Grid;
use super::heading::{Role, says_mean};
use super::joined::Read;
use super::layout::{Layout, SoilColumn};
use super::lines::names_listed;
use super::stated::states_unit;
use super::summary::SoilSummary;
use super::table::Soil;
use super::torn::whole_row;
use super::units::TAKEN_AS_MM;
use super::{ags, blocks, bounds, csv, joined, names, points, text, workbook};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::gradation::{FILE_LIMIT_BYTES, bytes_of};
use voidwalk_core::gradation::{GradationError, TableError, letters, shortened};
use voidwalk_core::text::plain;

impl Soil {
    /// All soils in a file, called `file` in messages.
    ///
    /// # Errors
    /// No table, or one that cannot be understood or could be understood in two ways.
    pub fn all(file: &str, bytes: &[u8]) -> Result<Vec<Soil>, GradationError> {
        let soils = tables(file, bytes, None)?;
        Ok(soils.into_iter().map(|(_, soil)| soil).collect::<Result<_, _>>()?)
    }

    /// The only soil in a file, or the one of this name: the name of a sheet, of a column, or both as
    /// `sheet/column`.
    ///
    /// # Errors
    /// Errors of [`Soil::all`], for this soil; several soils, or no soil of this name.
    pub fn one(file: &str, bytes: &[u8], name: Option<&str>) -> Result<Soil, GradationError> {
        let mut soils = tables(file, bytes, name)?;
        if let Some(name) = name {
            let all: Vec<String> = soils.iter().map(|(names, _)| names[0].clone()).collect();
            soils.retain(|(names, _)| is_named(names, name));
            if soils.is_empty() {
                let (file, name, soils) = (file.to_owned(), shortened(name), names_listed(&all));
                return Err(TableError::NoSuchSoil { file, name, soils }.into());
            }
        }
        if soils.len() > 1 {
            let all: Vec<String> = soils.iter().map(|(names, _)| names[0].clone()).collect();
            let (soils, first) = (names_listed(&all), plain(&all[0]));
            return Err(TableError::SeveralSoils { file: file.to_owned(), soils, first }.into());
        }
        match soils.pop() {
            Some((_, soil)) => Ok(soil?),
            None => Err(TableError::NoRows { file: file.into(), header: false }.into()),
        }
    }
}

/// Splits a scene's `path` into its file and the name of the soil in it: `site.xlsx#Filter A`. Files and
/// soils may have a `#` in their names: the first one behind the name of an existing file counts, and without
/// such a file the last.
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

/// A name in its displayed form, without the differences that two spellings of it may have.
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
    if workbook::is_zip(bytes) {
        return of_workbook(file, bytes, wanted);
    }
    let (text, note) = text::decoded(file, bytes)?;
    if ags::is_ags(&text) {
        return of_ags(ags::soils(file, &text)?);
    }
    let mut refusal = None;
    for delimiter in csv::separators(&text) {
        let mut grid = csv::grid(file, &text, delimiter);
        grid.notes.extend(note.clone());
        if grid.rows.is_empty() {
            return Err(TableError::NoRows { file: file.into(), header: false });
        }
        // Text that the first separator does not turn into a table may become one with another.
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
    if !soils.iter().any(|(_, soil)| soil.as_ref().is_ok_and(is_taken)) {
        return Ok(());
    }
    let mut comments = text.lines().enumerate().filter(|(_, line)| line.trim_start().starts_with('#'));
    match comments.find(|(_, line)| states_unit(line)) {
        Some((index, line)) => {
            let allowed = "openings whose heading names their unit, as Size (mm) or Size (um)".into();
            let (file, line, value) = (file.to_owned(), index + 1, shortened(line));
            Err(TableError::Header { file, line, value, allowed })
        }
        None => Ok(()),
    }
}

fn of_ags(tables: Vec<(String, Grid, Layout)>) -> Result<Vec<Named>, TableError> {
    let mut named = Vec::new();
    for (name, grid, layout) in tables {
        named.extend(points::soils(&grid, &layout)?.into_iter().map(|soil| (vec![name.clone()], soil)));
    }
    Ok(named)
}

/// Soils of every sheet. A sheet without a table, such as a cover, is skipped with a note if others have one;
/// if it was asked for by name, its error is returned.
fn of_workbook(file: &str, bytes: &[u8], wanted: Option<&str>) -> Result<Vec<Named>, TableError> {
    let (mut soils, mut refusals) = (Vec::new(), Vec::new());
    let sheets = workbook::sheets(file, bytes)?;
    if sheets.is_empty() {
        return Err(TableError::NoRows { file: file.into(), header: false });
    }
    for grid in sheets {
        let sheet = grid.sheet.clone().unwrap_or_default();
        // Rows that are each in one cell also belong to a table.
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
            // A table that is present but cannot be read is not skipped.
            Err(error @ (TableError::Value { .. } | TableError::Header { .. })) if has_table => {
                soils.push((vec![sheet], Err(error)));
            }
            Err(error) => refusals.push((sheet, error)),
        }
    }
    if let Some(at) =
        refusals.iter().position(|(sheet, _)| wanted.is_some_and(|w| folded(w) == folded(sheet)))
        && soils.iter().all(|(names, _)| wanted.is_some_and(|w| !is_named(names, w)))
    {
        return Err(refusals.swap_remove(at).1);
    }
    let all: Vec<String> = refusals.iter().map(|(sheet, _)| format!("\"{sheet}\"")).collect();
    if soils.is_empty()
        && let Some((_, error)) = refusals.into_iter().next()
    {
        return Err(error);
    }
    if !all.is_empty() && wanted.is_none() {
        let note = format!("no table was found in sheet {}", names_listed(&all));
        soils.iter_mut().filter_map(|(_, soil)| soil.as_mut().ok()).for_each(|s| s.notes.push(note.clone()));
    }
    Ok(soils)
}

fn is_named(names: &[String], wanted: &str) -> bool {
    names.iter().any(|name| folded(name) == folded(wanted))
}

/// Soils of one grid.
fn soils_of(grid: Grid) -> Result<Vec<Named>, TableError> {
    let mut blocks = blocks::blocks(grid)?;
    let several = blocks.len() > 1;
    blocks.iter_mut().for_each(names::name_columns);
    let titles = if several { names::titles(&blocks) } else { vec![String::new(); blocks.len()] };
    let read = |(mut block, title): (Block, String)| {
        let title = block.sample.take().unwrap_or(title);
        bounds::settle(&mut block.grid, &mut block.layout)?;
        let soils = points::soils(&block.grid, &block.layout)?;
        Ok(Read { block, title, soils })
    };
    let tables = joined::joined(blocks.into_iter().zip(titles).map(read).collect::<Result<_, _>>()?)?;
    Ok(named(tables))
}

/// Soils with their names: the title of their table, the heading of their column, or both, and the sheet.
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
                    // `% passing` is no name.
                    name.clear();
                } else if name.is_empty() || times[&folded(&name)] > 1 {
                    let place = grid.place_of(table.block.line(), column.column);
                    let letters = letters(place.column as u32);
                    name = match (grid.across.is_some(), several) {
                        (true, _) => format!(
                            "{name} ({} {})",
                            if grid.sheet.is_some() { "row" } else { "line" },
                            place.line
                        ),
                        (false, true) if grid.sheet.is_some() => {
                            format!("{name} (cell {letters}{})", place.line)
                        }
                        (false, true) => format!("{name} (line {}, column {})", place.line, place.column + 1),
                        (false, false) => format!("{name} (column {letters})"),
                    }
                    .trim()
                    .to_owned();
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

/// Soils of a file, or the one that `path` names after a `#`; a soil without a name takes the name of its
/// file.
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

/// Soils of a file as samples; the mean of others is refused with a question.
fn samples_of_file(path: &Path) -> Result<Vec<Soil>, GradationError> {
    let soils = soils_of_file(path)?;
    let names: Vec<&str> = soils.iter().map(Soil::name).collect();
    names::ask_about(&path.display().to_string(), &names, says_mean, "means, which are no samples")?;
    Ok(soils)
}

/// Summaries of the soils of a file, or of the one that `path` names after a `#`.
///
/// # Errors
/// Errors of [`read_gradation`], for each soil.
pub fn soils_in_file(path: &Path, d0_mm: Option<f64>) -> Result<Vec<SoilSummary>, GradationError> {
    samples_of_file(path)?.iter().map(|soil| SoilSummary::of(soil, d0_mm)).collect()
}

/// Names and sieve curves of the soils of a file, or of the one that `path` names after a `#`.
///
/// # Errors
/// Errors of [`read_gradation`], for each soil.
pub fn curves_in_file(path: &Path, d0_mm: Option<f64>) -> Result<Vec<(String, Gradation)>, GradationError> {
    let named = |soil: &Soil| Ok((soil.name.clone(), soil.gradation(d0_mm)?));
    samples_of_file(path)?.iter().map(named).collect()
}

/// Curves as in [`curves_in_file`], with those of soils that are no samples.
pub(super) fn all_in_file(path: &Path) -> Result<Vec<(String, Gradation)>, GradationError> {
    let named = |soil: &Soil| Ok((soil.name.clone(), soil.gradation(None)?));
    soils_of_file(path)?.iter().map(named).collect()
}

/// Assumptions about the soils of a file, or about the one that `path` names after a `#`, without
/// repetitions.
///
/// # Errors
/// Errors of [`read_gradation`], for each soil.
pub fn notes_in_file(path: &Path) -> Result<Vec<String>, GradationError> {
    let mut seen = HashSet::new();
    let mut notes: Vec<String> = soils_of_file(path)?.into_iter().flat_map(|soil| soil.notes).collect();
    notes.retain(|note| seen.insert(note.clone()));
    Ok(notes)
}

/// A sieve table from a file: `site.csv`, or `site.xlsx#Filter A` where it holds several soils.
///
/// `docs::soils` says which tables are understood. In a plain table, `opening_mm,percent_finer`, the header
/// may be left out, the columns may come in either order, and sizes may rise or fall.
///
/// # Errors
/// A file that cannot be read, is a folder, is larger than [`FILE_LIMIT_BYTES`] or holds no table; no rows; a
/// row that cannot be read; a value that is not a finite number in range; sizes that repeat or go both ways;
/// percent that falls as size rises; a coarsest size below 100 %; a single row without `d0_mm` (all of its
/// mass is of unknown size); a `d0_mm` that is not below the finest opening, or that nothing is left for.
pub fn read_gradation(path: impl AsRef<Path>, d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
    let (path, name) = file_and_soil(path.as_ref());
    let (file, bytes) = (path.display().to_string(), bytes_of(&path)?);
    Soil::one(&file, &bytes, name.as_deref())?.gradation(d0_mm)
}

/// Reads the content of a file as [`read_gradation`] does; messages call it `name`.
///
/// # Errors
/// Errors of [`read_gradation`].
pub fn parse_gradation(name: &str, content: &[u8], d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
    Soil::one(name, content, None)?.gradation(d0_mm)
}
