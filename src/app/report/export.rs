//! The tables of a folder for other programs: arrays for NumPy, grids for ParaView.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::by_void;
use super::error::ReportError;
use super::files::{rows, text};
use super::vtu::{CellKind, Grid};
use crate::outcome::record::LayerRow;
use voidwalk_core::store::{Array, make_folder, npz, write_whole};

/// The files that were written, and the columns of words that were not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// The files.
    pub files: Vec<PathBuf>,
    /// `TABLE.COLUMN`.
    pub words: Vec<String>,
}

/// Writes `export/arrays.npz`, with an array `TABLE.COLUMN` of every column of numbers of every CSV table in
/// the folder; `export/layers.vtu` of a run: a block for each layer, with the means over the replicates;
/// `export/grains.vtu` of a packing: a point for each grain, with its diameter; of a run that kept its
/// voids `voids.pvd` and `constrictions.pvd`, with a grid for each moment; and `verdict.xlsx` of a run.
///
/// # Errors
/// [`ReportError`] names the file that cannot be read, is no table, or cannot be written.
pub fn export(folder: &Path) -> Result<Exported, ReportError> {
    let tables = tables(folder)?;
    let (mut arrays, mut words) = (Vec::new(), Vec::new());
    for (name, table) in &tables {
        for (column, fields) in table {
            match numbers(fields) {
                Some(array) => arrays.push((format!("{name}.{column}"), array)),
                None => words.push(format!("{name}.{column}")),
            }
        }
    }
    let out = folder.join("export");
    let unwritten = |source| ReportError::Read { path: out.join("arrays.npz"), source };
    // Everything is read before anything is written.
    let mut grids = vec![("arrays.npz", npz(&arrays).map_err(unwritten)?)];
    if tables.contains_key("layers") {
        grids.push(("layers.vtu", layers(&folder.join("layers.csv"))?));
    }
    let of_voids =
        tables.contains_key("retained_by_void").then(|| by_void::Tables::read(folder)).transpose()?;
    grids.extend(tables.get("grains").and_then(grains).map(|bytes| ("grains.vtu", bytes)));
    #[cfg(feature = "xlsx")]
    if folder.join("outcome.json").is_file() {
        grids.push((super::workbook::VERDICT, super::workbook::verdict_workbook(folder)?));
    }
    let mut files = Vec::new();
    make_folder(&out)?;
    let mut write = |name: &str, bytes: &[u8]| -> Result<(), ReportError> {
        let path = out.join(name);
        write_whole(&path, bytes)?;
        files.push(path);
        Ok(())
    };
    for (name, bytes) in grids {
        write(name, &bytes)?;
    }
    if let Some(tables) = of_voids {
        by_void::grids(&tables, &mut write)?;
    }
    Ok(Exported { files, words })
}

/// A table: its columns with their names, in order.
type Table = Vec<(String, Vec<String>)>;

/// Every CSV table in the folder, by its name.
fn tables(folder: &Path) -> Result<BTreeMap<String, Table>, ReportError> {
    let unread = |source| ReportError::Read { path: folder.to_owned(), source };
    let mut tables = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(unread)? {
        let path = entry.map_err(unread)?.path();
        let is_table = path.extension().is_some_and(|ending| ending == "csv") && path.is_file();
        if let Some(name) = path.file_stem().and_then(|name| name.to_str()).filter(|_| is_table) {
            tables.insert(name.to_owned(), table(&path)?);
        }
    }
    Ok(tables)
}

fn table(path: &Path) -> Result<Table, ReportError> {
    let text = text(path)?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let form = |error: csv::Error| ReportError::Form {
        path: path.to_owned(),
        line: error.position().map_or(1, csv::Position::line),
        message: error.to_string(),
    };
    let mut table: Table =
        reader.headers().map_err(form)?.iter().map(|name| (name.trim().to_owned(), Vec::new())).collect();
    for record in reader.records() {
        for ((_, column), field) in table.iter_mut().zip(&record.map_err(form)?) {
            column.push(field.trim().to_owned());
        }
    }
    Ok(table)
}

/// A column as whole numbers if all are whole, else as numbers with empty cells as NaN; `None` for words.
fn numbers(fields: &[String]) -> Option<Array> {
    if let Some(whole) = fields.iter().map(|field| field.parse().ok()).collect::<Option<Vec<i64>>>() {
        return Some(Array::of_whole(whole));
    }
    let float = |field: &String| if field.is_empty() { Some(f64::NAN) } else { field.parse().ok() };
    fields.iter().map(float).collect::<Option<Vec<f64>>>().map(Array::of_floats)
}

/// A column of blocks, one for each layer, the first layer on top; lengths are in layers.
fn layers(path: &Path) -> Result<Vec<u8>, ReportError> {
    let rows = rows::<LayerRow>(path)?;
    let count = rows.iter().map(|(_, row)| row.layer.saturating_add(1)).max().unwrap_or(0) as usize;
    if count > rows.len() {
        let message = format!("layer {} without those before it", count - 1);
        return Err(ReportError::Form { path: path.to_owned(), line: rows.len() as u64 + 1, message });
    }
    let mut sums: BTreeMap<(u64, &str), Vec<(f64, f64)>> = BTreeMap::new();
    for (_, row) in &rows {
        for (name, value) in [
            ("constrictions", row.constrictions),
            ("blocked", row.blocked),
            ("retained_in_constrictions", row.retained_in_constrictions),
            ("retained_in_voids", row.retained_in_voids),
        ] {
            let sum = &mut sums.entry((row.run, name)).or_insert_with(|| vec![(0.0, 0.0); count])
                [row.layer as usize];
            *sum = (sum.0 + value as f64, sum.1 + 1.0);
        }
    }
    let columns: Vec<(String, Vec<f64>)> = sums
        .into_iter()
        .map(|((run, name), sums)| {
            let means = sums.iter().map(|(sum, rows)| sum / rows).collect();
            (format!("{name}_run_{run}"), means)
        })
        .collect();
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let points: Vec<[f64; 3]> =
        (0..=count).flat_map(|layer| square.map(|[x, y]| [x, y, 0.0 - layer as f64])).collect();
    // The corners below first, as VTK requires.
    let corners: Vec<i64> =
        (0..count as i64).flat_map(|layer| [4, 5, 6, 7, 0, 1, 2, 3].map(|c| 4 * layer + c)).collect();
    Ok(Grid { points: &points, kind: CellKind::Hexahedron, corners: &corners, columns: &columns }.file())
}

/// The grains of a packing; `None` if the table has no grains.
fn grains(table: &Table) -> Option<Vec<u8>> {
    let column = |name: &str| -> Option<Vec<f64>> {
        let (_, fields) = table.iter().find(|(column, _)| column == name)?;
        fields.iter().map(|field| field.parse().ok()).collect()
    };
    let [x, y, z] = [column("x_mm")?, column("y_mm")?, column("z_mm")?];
    let points: Vec<[f64; 3]> = (0..x.len()).map(|grain| [x[grain], y[grain], z[grain]]).collect();
    let corners: Vec<i64> = (0..x.len() as i64).collect();
    let columns = [("diameter_mm".to_owned(), column("diameter_mm")?)];
    Some(Grid { points: &points, kind: CellKind::Vertex, corners: &corners, columns: &columns }.file())
}

#[cfg(test)]
mod tests {
    use super::*;
    use voidwalk_core::store::{Npz, Numbers};

    #[test]
    fn every_column_of_numbers_is_an_array() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(root.path().join(name), text).unwrap();
        write("cases.csv", "case,n,mean\n\"a, b\",3,0.5\nc,4,\n");
        write("grains.csv", "# cell_mm = 1, 1, 1\nx_mm,y_mm,z_mm,diameter_mm\n0,1,2,0.5\n");
        write("notes.txt", "no table");
        let exported = export(root.path()).unwrap();
        assert_eq!(exported.words, ["cases.case"]);
        let names: Vec<_> =
            exported.files.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["arrays.npz", "grains.vtu"]);
        let bytes = std::fs::read(&exported.files[0]).unwrap();
        let mut npz = Npz::open(&bytes).unwrap();
        assert_eq!(npz.first(&["cases.n"]).unwrap().unwrap().1.numbers, Numbers::Whole(vec![3, 4]));
        let Numbers::Float(means) = npz.first(&["cases.mean"]).unwrap().unwrap().1.numbers else { panic!() };
        assert!(means[0] == 0.5 && means[1].is_nan());
        // A second export gives the same files.
        assert_eq!(export(root.path()).unwrap(), exported);
        write("broken.csv", "a,b\n1\n");
        assert!(export(root.path()).unwrap_err().to_string().contains("broken.csv:2:"));
    }
}
