//! The rows of the CSV files of a run, as dicts of columns and back.

use numpy::{Element, IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voidwalk::outcome::Recorded;
use voidwalk::outcome::number_rows::{NumberColumn, NumberRow};

use crate::arrays::column;
use crate::problem::refused;

/// Puts rows into `tables` as a dict of arrays; where there are none, only if it is needed.
fn put<R: NumberRow>(tables: &Bound<'_, PyDict>, name: &str, rows: &[R], is_needed: bool) -> PyResult<()> {
    if rows.is_empty() && !is_needed {
        return Ok(());
    }
    let py = tables.py();
    let table = PyDict::new(py);
    for (name, numbers) in R::columns(rows) {
        match numbers {
            NumberColumn::Counts(column) => table.set_item(name, column.into_pyarray(py))?,
            NumberColumn::Whole(column) => table.set_item(name, column.into_pyarray(py))?,
            NumberColumn::Floats(column) => table.set_item(name, column.into_pyarray(py))?,
        }
    }
    tables.set_item(name, table)
}

/// The rows of the table of this name; empty if there is no such table and it is not needed.
fn to_rows<R: NumberRow>(tables: &Bound<'_, PyDict>, name: &str, is_needed: bool) -> PyResult<Vec<R>> {
    let table: Bound<'_, PyDict> = match tables.get_item(name)? {
        Some(table) => table.cast_into()?,
        None if is_needed => return Err(refused(format!("there is no table {name}"))),
        None => return Ok(Vec::new()),
    };
    let rows = R::rows(|field, like| {
        Ok::<_, PyErr>(match like {
            NumberColumn::Counts(_) => column_of::<u64>(name, &table, field)?.into(),
            NumberColumn::Whole(_) => column_of::<i64>(name, &table, field)?.into(),
            NumberColumn::Floats(_) => column_of::<f64>(name, &table, field)?.into(),
        })
    })?;
    rows.ok_or_else(|| refused(format!("the columns of {name} differ in length")))
}

fn column_of<T: Element + Copy>(name: &str, table: &Bound<'_, PyDict>, field: &str) -> PyResult<Vec<T>> {
    let wrong = || refused(format!("{name}[{field:?}] is not the column that the walk gave"));
    let array = table.get_item(field)?.ok_or_else(wrong)?;
    let array: PyReadonlyArray1<'_, T> = array.extract().map_err(|_| wrong())?;
    match column(field, &array) {
        Ok(column) => Ok(column.to_vec()),
        Err(_) => Ok(array.as_array().iter().copied().collect()),
    }
}

/// The tables of a run, each a dict of columns; flow, voids and blocked constrictions if they were kept.
pub fn of_recorded<'py>(py: Python<'py>, recorded: &Recorded) -> PyResult<Bound<'py, PyDict>> {
    let Recorded { series, layers, retained, eroded, flow, voids, blocked } = recorded;
    let tables = PyDict::new(py);
    put(&tables, "series", series, true)?;
    put(&tables, "layers", layers, true)?;
    put(&tables, "retained", retained, true)?;
    put(&tables, "eroded", eroded, true)?;
    put(&tables, "flow", flow, false)?;
    put(&tables, "retained_by_void", voids, false)?;
    put(&tables, "blockings", blocked, false)?;
    Ok(tables)
}

/// The rows of the tables of a run; flow, voids and blocked constrictions if they were kept.
pub fn to_recorded(tables: &Bound<'_, PyDict>) -> PyResult<Recorded> {
    Ok(Recorded {
        series: to_rows(tables, "series", true)?,
        layers: to_rows(tables, "layers", true)?,
        retained: to_rows(tables, "retained", true)?,
        eroded: to_rows(tables, "eroded", true)?,
        flow: to_rows(tables, "flow", false)?,
        voids: to_rows(tables, "retained_by_void", false)?,
        blocked: to_rows(tables, "blockings", false)?,
    })
}
