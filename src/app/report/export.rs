//! Tables of a folder for other programs: NumPy arrays and VTK grids for ParaView (`.vtu` with its numbers in
//! binary at the end).

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::files::{ReportError, malformed, rows, text};
use crate::outcome::record::{BlockedRow, ConstrictionRow, LayerRow, RetainedRow, VoidRow};
use voidwalk_core::store::{Array, make_folder, npz, write_whole};

/// Files that were written, and columns of words that were not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Exported {
    pub(crate) files: Vec<PathBuf>,
    /// Columns of words, as `TABLE.COLUMN`.
    pub(crate) words: Vec<String>,
}

/// Writes `export/arrays.npz`, with an array `TABLE.COLUMN` for each numeric column of every CSV table in the
/// folder. For a run it also writes `export/layers.vtu`, a block per layer with the means over the
/// replicates, and `verdict.xlsx`; for a packing `export/grains.vtu`, a point per grain with its diameter;
/// for a run that kept its voids `voids.pvd` and `constrictions.pvd`, with a grid for each moment.
///
/// # Errors
/// [`ReportError`] names the file that cannot be read, is not a table, or cannot be written.
pub(crate) fn export(folder: &Path) -> Result<Exported, ReportError> {
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
    let of_voids = tables.contains_key("retained_by_void").then(|| Tables::read(folder)).transpose()?;
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
        void_grids(&tables, &mut write)?;
    }
    Ok(Exported { files, words })
}

/// A table: its columns with their names, in order.
type Table = Vec<(String, Vec<String>)>;

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
    let form = |error: csv::Error| {
        malformed(path, error.position().map_or(1, csv::Position::line), error.to_string())
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

/// Column of integers if all values are integers, else of numbers (NaN if empty); `None` for words.
fn numbers(fields: &[String]) -> Option<Array> {
    if let Some(whole) = fields.iter().map(|field| field.parse().ok()).collect::<Option<Vec<i64>>>() {
        return Some(Array::of_whole(whole));
    }
    let float = |field: &String| if field.is_empty() { Some(f64::NAN) } else { field.parse().ok() };
    fields.iter().map(float).collect::<Option<Vec<f64>>>().map(Array::of_floats)
}

/// Blocks in a column, one per layer, the first layer on top; lengths are in layers.
fn layers(path: &Path) -> Result<Vec<u8>, ReportError> {
    let rows = rows::<LayerRow>(path)?;
    let count = rows.iter().map(|(_, row)| row.layer.saturating_add(1)).max().unwrap_or(0) as usize;
    if count > rows.len() {
        let message = format!("layer {} without those before it", count - 1);
        return Err(malformed(path, rows.len() as u64 + 1, message));
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
    Ok(grid(CellKind::Block, &points, &columns))
}

/// Grains of a packing; `None` if the table has no grains.
fn grains(table: &Table) -> Option<Vec<u8>> {
    let column = |name: &str| -> Option<Vec<f64>> {
        let (_, fields) = table.iter().find(|(column, _)| column == name)?;
        fields.iter().map(|field| field.parse().ok()).collect()
    };
    let [x, y, z] = [column("x_mm")?, column("y_mm")?, column("z_mm")?];
    let points: Vec<[f64; 3]> = (0..x.len()).map(|grain| [x[grain], y[grain], z[grain]]).collect();
    let columns = [("diameter_mm".to_owned(), column("diameter_mm")?)];
    Some(grid(CellKind::Vertex, &points, &columns))
}

/// Moment: a run, and the number of increments done.
type Moment = (u64, u64);

/// Tables of a folder, with the contents of its voids at each moment.
struct Tables {
    voids: Vec<[f64; 3]>,
    constrictions: Vec<ConstrictionRow>,
    /// Moment at which each constriction was blocked, by its number.
    blocked: BTreeMap<u64, Moment>,
    /// Contents of voids, by moment.
    retained: BTreeMap<Moment, Vec<RetainedRow>>,
    moments: BTreeSet<Moment>,
}

/// Writes grids of a run that kept its voids. For each moment: `voids_N.vtu`, a point per void with its
/// contents, and `constrictions_N.vtu`, a line per constriction with its diameter, its conductance and the
/// time of blocking, if any. `voids.pvd` and `constrictions.pvd` open in ParaView as sequences of moments.
fn void_grids(
    tables: &Tables,
    mut write: impl FnMut(&str, &[u8]) -> Result<(), ReportError>,
) -> Result<(), ReportError> {
    type Draw = fn(&Tables, Moment) -> Vec<u8>;
    let grids: [(&str, Draw); 2] = [("voids", Tables::voids_at), ("constrictions", Tables::lines_at)];
    for (kind, grid) in grids {
        let mut sets = String::new();
        for (number, &moment) in tables.moments.iter().enumerate() {
            let name = format!("{kind}_{number:04}.vtu");
            write(&name, &grid(tables, moment))?;
            let time = tables.time_of(moment);
            sets += &format!("<DataSet timestep=\"{time}\" file=\"{name}\"/>\n");
        }
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" \
             byte_order=\"LittleEndian\">\n<Collection>\n{sets}</Collection>\n</VTKFile>\n"
        );
        write(&format!("{kind}.pvd"), text.as_bytes())?;
    }
    Ok(())
}

impl Tables {
    fn read(folder: &Path) -> Result<Self, ReportError> {
        let [of_voids, of_network, of_retained] =
            ["voids.csv", "constrictions_of_network.csv", "retained_by_void.csv"]
                .map(|name| folder.join(name));
        let voids = rows::<VoidRow>(&of_voids)?;
        let count = voids.len() as u64;
        // Voids are numbered by row.
        if let Some((index, (line, row))) = (0u64..).zip(&voids).find(|(index, (_, row))| row.void != *index)
        {
            return Err(malformed(&of_voids, *line, format!("void is {}, allowed: {index}", row.void)));
        }
        let mut constrictions = Vec::new();
        for (line, row) in rows::<ConstrictionRow>(&of_network)? {
            let known = |void: i64| void < count as i64;
            if !known(row.from) || !known(row.to) || row.from.max(row.to) < 0 {
                let joins = format!("joins {} and {}", row.from, row.to);
                let message = format!("{joins}, but voids.csv holds {count} voids");
                return Err(malformed(&of_network, line, message));
            }
            constrictions.push(row);
        }
        let mut blocked = BTreeMap::new();
        for (_, row) in rows::<BlockedRow>(&folder.join("blocked.csv"))? {
            blocked.entry(row.constriction).or_insert((row.run, row.increment));
        }
        let mut retained: BTreeMap<Moment, Vec<RetainedRow>> = BTreeMap::new();
        for (line, row) in rows::<RetainedRow>(&of_retained)? {
            if row.void >= count as i64 {
                let message = format!("void is {}, but voids.csv holds {count} voids", row.void);
                return Err(malformed(&of_retained, line, message));
            }
            retained.entry((row.run, row.increment)).or_default().push(row);
        }
        let moments = [(1, 0)].into_iter().chain(retained.keys().copied()).collect();
        let voids = voids.into_iter().map(|(_, row)| [row.x_mm, row.y_mm, row.z_mm]).collect();
        Ok(Self { voids, constrictions, blocked, retained, moments })
    }

    /// Time of a moment in increments; the second run follows the first.
    fn time_of(&self, (run, increment): Moment) -> u64 {
        let last = |run: u64| self.moments.iter().filter(|m| m.0 == run).map(|m| m.1).max().unwrap_or(0);
        let before: u64 = self.moments.iter().map(|m| m.0).filter(|&r| r < run).max().map_or(0, last);
        before.saturating_add(increment)
    }

    fn voids_at(&self, moment: Moment) -> Vec<u8> {
        let (mut in_constrictions, mut in_voids) = (vec![0.0; self.voids.len()], vec![0.0; self.voids.len()]);
        for row in self.retained.get(&moment).into_iter().flatten() {
            // The reservoir before the filter, -1, is not a void.
            if let Ok(void) = usize::try_from(row.void) {
                in_constrictions[void] = row.retained_in_constrictions as f64;
                in_voids[void] = row.retained_in_voids as f64;
            }
        }
        // The second run counts from zero again.
        let columns = [
            ("retained_in_constrictions_in_this_run".to_owned(), in_constrictions),
            ("retained_in_voids_in_this_run".to_owned(), in_voids),
        ];
        grid(CellKind::Vertex, &self.voids, &columns)
    }

    fn lines_at(&self, moment: Moment) -> Vec<u8> {
        let ends = |row: &ConstrictionRow| {
            let vector = [row.dx_mm, row.dy_mm, row.dz_mm];
            let by = |p: [f64; 3], sign: f64| [0, 1, 2].map(|axis| p[axis] + sign * vector[axis]);
            match usize::try_from(row.from) {
                Ok(from) => [self.voids[from], by(self.voids[from], 1.0)],
                Err(_) => [by(self.voids[row.to as usize], -1.0), self.voids[row.to as usize]],
            }
        };
        let points: Vec<[f64; 3]> = self.constrictions.iter().flat_map(ends).collect();
        let column = |name: &str, value: &dyn Fn(&ConstrictionRow) -> f64| {
            (name.to_owned(), self.constrictions.iter().map(value).collect::<Vec<f64>>())
        };
        let blocked_at =
            |row: &ConstrictionRow| self.blocked.get(&row.constriction).filter(|&&at| at <= moment);
        let columns = [
            column("diameter_mm", &|row| row.diameter_mm),
            column("conductance", &|row| row.conductance),
            column("blocked", &|row| f64::from(u8::from(blocked_at(row).is_some()))),
            // An open constriction has -1.
            column("blocked_at", &|row| blocked_at(row).map_or(-1.0, |&at| self.time_of(at) as f64)),
        ];
        grid(CellKind::Line, &points, &columns)
    }
}

/// Kind of a grid's cells.
#[derive(Clone, Copy)]
enum CellKind {
    /// A cell for each point.
    Vertex,
    /// A cell between each two points.
    Line,
    /// A block between each four points and the next four, which lie below them.
    Block,
}

/// File of points, cells between them, and named numbers for each cell: a header with the offset of each
/// array, then the arrays, each after its length in bytes.
fn grid(kind: CellKind, points: &[[f64; 3]], columns: &[(String, Vec<f64>)]) -> Vec<u8> {
    let count = points.len() as i64;
    // VTK's number of the kind, the number of corners of a cell, and the corners, cell by cell.
    let (number, corners, joined): (u8, usize, Vec<i64>) = match kind {
        CellKind::Vertex => (1, 1, (0..count).collect()),
        CellKind::Line => (3, 2, (0..count).collect()),
        // The lower corners come first, as VTK requires.
        CellKind::Block => {
            let block = |layer| [4, 5, 6, 7, 0, 1, 2, 3].map(|corner| 4 * layer + corner);
            (12, 8, (0..count / 4 - 1).flat_map(block).collect())
        }
    };
    let cells = joined.len() / corners;
    let (mut head, mut data) = (String::new(), Vec::new());
    // Writing to a string cannot fail.
    let _ = write!(
        head,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece \
         NumberOfPoints=\"{count}\" NumberOfCells=\"{cells}\">\n<Points>\n"
    );
    let mut array = |head: &mut String, kind: &str, name: &str, more: &str, bytes: Vec<u8>| {
        let offset = data.len();
        let _ = writeln!(
            head,
            "<DataArray type=\"{kind}\" Name=\"{name}\"{more} format=\"appended\" offset=\"{offset}\"/>"
        );
        data.extend((bytes.len() as u64).to_le_bytes());
        data.extend(bytes);
    };
    let floats = |all: &mut dyn Iterator<Item = f64>| all.flat_map(f64::to_le_bytes).collect::<Vec<u8>>();
    let whole = |all: &mut dyn Iterator<Item = i64>| all.flat_map(i64::to_le_bytes).collect::<Vec<u8>>();
    let points = floats(&mut points.iter().flatten().copied());
    array(&mut head, "Float64", "points", " NumberOfComponents=\"3\"", points);
    head.push_str("</Points>\n<Cells>\n");
    array(&mut head, "Int64", "connectivity", "", whole(&mut joined.iter().copied()));
    let ends = whole(&mut (1..=cells).map(|cell| (cell * corners) as i64));
    array(&mut head, "Int64", "offsets", "", ends);
    array(&mut head, "UInt8", "types", "", vec![number; cells]);
    head.push_str("</Cells>\n<CellData>\n");
    for (name, column) in columns {
        array(&mut head, "Float64", name, "", floats(&mut column.iter().copied()));
    }
    head.push_str("</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
    [head.as_bytes(), &data, b"\n</AppendedData>\n</VTKFile>\n"].concat()
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

    #[test]
    fn every_array_stands_where_the_head_says() {
        let columns = [("size".to_owned(), vec![0.5, 0.25])];
        let points = [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]];
        let file = grid(CellKind::Vertex, &points, &columns);
        let begin = file.windows(2).position(|pair| pair == b"\n_").unwrap() + 2;
        let head = String::from_utf8(file[..begin].to_vec()).unwrap();
        let at = |name: &str| -> usize {
            let (_, rest) = head.split_once(&format!("Name=\"{name}\"")).unwrap();
            rest.split_once("offset=\"").unwrap().1.split('"').next().unwrap().parse().unwrap()
        };
        let word = |at: usize| file[begin + at..begin + at + 8].try_into().unwrap();
        for (name, bytes) in
            [("points", 48), ("connectivity", 16), ("offsets", 16), ("types", 2), ("size", 16)]
        {
            assert_eq!(u64::from_le_bytes(word(at(name))), bytes, "{name}");
        }
        assert_eq!(f64::from_le_bytes(word(at("points") + 8 + 40)), 5.0);
        assert_eq!(i64::from_le_bytes(word(at("offsets") + 8 + 8)), 2);
        assert_eq!(f64::from_le_bytes(word(at("size") + 8)), 0.5);
    }
}
