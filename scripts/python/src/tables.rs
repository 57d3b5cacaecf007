//! The rows of the CSV files of a run, as dicts of columns and back.

use numpy::{Element, IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voidwalk::outcome::Recorded;
use voidwalk::outcome::record::{BlockedRow, FlowRow, LayerRow, RetainedRow, SeriesRow, SizeRow};

use crate::arrays::column;
use crate::problem::refused;

/// The columns of a table, named once: rows to a dict of arrays, and back.
macro_rules! table {
    ($to:ident, $from:ident, $row:ident, $($field:ident: $kind:ty),*) => {
        fn $to<'py>(py: Python<'py>, rows: &[$row]) -> PyResult<Bound<'py, PyDict>> {
            let table = PyDict::new(py);
            $(table.set_item(
                stringify!($field),
                rows.iter().map(|row| row.$field).collect::<Vec<$kind>>().into_pyarray(py),
            )?;)*
            Ok(table)
        }

        fn $from(name: &str, table: &Bound<'_, PyDict>) -> PyResult<Vec<$row>> {
            $(let $field: Vec<$kind> = column_of(name, table, stringify!($field))?;)*
            let count = [$($field.len()),*].into_iter().min().unwrap_or(0);
            if [$($field.len()),*] != [$({ let _ = stringify!($field); count }),*] {
                return Err(refused(format!("the columns of {name} differ in length")));
            }
            Ok((0..count).map(|i| $row { $($field: $field[i]),* }).collect())
        }
    };
}

table!(
    of_series, to_series, SeriesRow,
    replicate: u64, run: u64, increment: u64, inserted: u64, moving: u64, eroded: u64,
    retained_in_constrictions: u64, retained_in_voids: u64, trapped: u64, blocked: u64, eroded_mass_fraction: f64
);
table!(
    of_layers, to_layers, LayerRow,
    replicate: u64, run: u64, layer: u64, constrictions: u64, blocked: u64, retained_in_constrictions: u64,
    retained_in_voids: u64
);
table!(
    of_sizes, to_sizes, SizeRow,
    replicate: u64, run: u64, increment: u64, diameter_mm: f64, percent_finer_by_mass: f64,
    percent_finer_by_number: f64
);
table!(of_flow, to_flow, FlowRow, replicate: u64, run: u64, increment: u64, k_over_k0: f64);
table!(
    of_voids, to_voids, RetainedRow,
    run: u64, increment: u64, void: i64, retained_in_constrictions: u64, retained_in_voids: u64
);
table!(of_blocked, to_blocked, BlockedRow, run: u64, increment: u64, constriction: u64);

fn column_of<T: Element + Copy>(name: &str, table: &Bound<'_, PyDict>, field: &str) -> PyResult<Vec<T>> {
    let wrong = || refused(format!("{name}[{field:?}] is not the column that the walk gave"));
    let array = table.get_item(field)?.ok_or_else(wrong)?;
    let array: PyReadonlyArray1<'_, T> = array.extract().map_err(|_| wrong())?;
    match column(field, &array) {
        Ok(column) => Ok(column.to_vec()),
        Err(_) => Ok(array.as_array().iter().copied().collect()),
    }
}

/// The tables of a run, each a dict of columns.
pub fn of_recorded<'py>(py: Python<'py>, recorded: &Recorded) -> PyResult<Bound<'py, PyDict>> {
    let Recorded { series, layers, retained, eroded, flow, voids, blocked } = recorded;
    let tables = PyDict::new(py);
    tables.set_item("series", of_series(py, series)?)?;
    tables.set_item("layers", of_layers(py, layers)?)?;
    tables.set_item("retained", of_sizes(py, retained)?)?;
    tables.set_item("eroded", of_sizes(py, eroded)?)?;
    if !flow.is_empty() {
        tables.set_item("flow", of_flow(py, flow)?)?;
    }
    if !voids.is_empty() {
        tables.set_item("retained_by_void", of_voids(py, voids)?)?;
    }
    if !blocked.is_empty() {
        tables.set_item("blockings", of_blocked(py, blocked)?)?;
    }
    Ok(tables)
}

/// The rows of the tables of a run; those of flow, voids and blocked constrictions where they were kept.
pub fn to_recorded(tables: &Bound<'_, PyDict>) -> PyResult<Recorded> {
    let table = |name: &str| -> PyResult<Bound<'_, PyDict>> {
        let found = tables.get_item(name)?.ok_or_else(|| refused(format!("there is no table {name}")))?;
        Ok(found.cast_into()?)
    };
    let kept = |name: &str| tables.contains(name)?.then(|| table(name)).transpose();
    Ok(Recorded {
        series: to_series("series", &table("series")?)?,
        layers: to_layers("layers", &table("layers")?)?,
        retained: to_sizes("retained", &table("retained")?)?,
        eroded: to_sizes("eroded", &table("eroded")?)?,
        flow: kept("flow")?.map_or(Ok(Vec::new()), |table| to_flow("flow", &table))?,
        voids: kept("retained_by_void")?
            .map_or(Ok(Vec::new()), |table| to_voids("retained_by_void", &table))?,
        blocked: kept("blockings")?.map_or(Ok(Vec::new()), |table| to_blocked("blockings", &table))?,
    })
}
