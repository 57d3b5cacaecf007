//! Columns to and from NumPy.

use numpy::{Element, IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use voidwalk::packing::{Cell, Packing};

use crate::problem::refused;

/// A column as a slice, if it is one piece of memory.
pub fn column<'a, T: Element>(name: &str, array: &'a PyReadonlyArray1<'_, T>) -> PyResult<&'a [T]> {
    array.as_slice().map_err(|_| refused(format!("{name} is not one piece of memory")))
}

/// Rows of `N` as a slice, if they are one piece of memory.
pub fn rows<'a, T: Element, const N: usize>(
    name: &str,
    array: &'a PyReadonlyArray2<'_, T>,
) -> PyResult<&'a [[T; N]]> {
    let flat = array.as_slice().map_err(|_| refused(format!("{name} is not one piece of memory")))?;
    match flat.as_chunks() {
        (rows, []) => Ok(rows),
        _ => Err(refused(format!("{name} does not have {N} columns"))),
    }
}

/// Numbers of voids.
pub fn voids(name: &str, numbers: &[i64]) -> PyResult<Vec<u32>> {
    let number = |&n: &i64| u32::try_from(n).map_err(|_| refused(format!("{name}: {n} is no void")));
    numbers.iter().map(number).collect()
}

/// Grains as Python hands them in: coords, diameter and the lengths of the cell.
#[derive(FromPyObject)]
pub struct Grains<'py>(PyReadonlyArray2<'py, f64>, PyReadonlyArray1<'py, f64>, Option<[f64; 3]>);

impl Grains<'_> {
    /// The grains as the library keeps them: a column an axis.
    pub fn packing(&self) -> PyResult<Packing> {
        let Self(coords, diameter, cell) = self;
        let points: &[[f64; 3]] = rows("coords", coords)?;
        let along = |axis: usize| points.iter().map(|p| p[axis]).collect();
        Ok(Packing {
            cell: cell.map_or(Cell::Free, Cell::Periodic),
            x: along(0),
            y: along(1),
            z: along(2),
            diameter: column("diameter", diameter)?.to_vec(),
        })
    }
}

/// Rows of three as an array that takes their memory over.
pub fn of_rows<'py, T: Element + Copy, const N: usize>(
    py: Python<'py>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'py, PyAny>> {
    let count = rows.len();
    let flat: Vec<T> = rows.into_flattened();
    flat.into_pyarray(py).call_method1("reshape", (count, N))
}

/// Grains as arrays: coords, diameter and the lengths of the cell.
pub fn of_packing<'py>(
    py: Python<'py>,
    packing: Packing,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, Option<[f64; 3]>)> {
    let Packing { cell, x, y, z, diameter } = packing;
    let points: Vec<[f64; 3]> = x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect();
    let cell = match cell {
        Cell::Periodic(lengths) => Some(lengths),
        Cell::Free => None,
    };
    Ok((of_rows(py, points)?, diameter.into_pyarray(py).into_any(), cell))
}
