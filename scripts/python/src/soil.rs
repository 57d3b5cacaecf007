//! Gradations and constriction curves.

use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use voidwalk::constrictions::{self, CurveUnit};
use voidwalk::gradation::{self, CurvePoint};
use voidwalk::scene::Density;
use voidwalk::sheets::curves_in_file;

use crate::arrays::column;
use crate::problem::refused;

/// Error of points that come as columns: the library counts rows of a table from 1.
fn of_points(error: impl std::fmt::Display) -> PyErr {
    let text = error.to_string().replace("points, line", "line");
    let mut message = String::new();
    for (at, part) in text.split("line ").enumerate() {
        let digits = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        match part[..digits].parse::<u64>() {
            Ok(line) if at > 0 => message += &format!("entry {}{}", line.saturating_sub(1), &part[digits..]),
            _ if at > 0 => message = message + "line " + part,
            _ => message += part,
        }
    }
    refused(if message == text { message } else { message + " (entries are counted from 0)" })
}

/// A density by its word.
pub fn density_named(word: &str) -> PyResult<Density> {
    let words = Density::WORDS;
    Density::named(word).ok_or_else(|| refused(format!("density = {word} is not allowed; {words}")))
}

/// A sieve curve of the library.
#[pyclass(frozen, module = "voidwalk._voidwalk")]
pub struct Gradation {
    pub inner: gradation::Gradation,
}

type Points<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// A column with its name.
type Column<'a, 'py> = (&'a str, &'a PyReadonlyArray1<'py, f64>);

/// Points of two columns of one length.
fn paired((x, xs): Column<'_, '_>, (y, ys): Column<'_, '_>) -> PyResult<Vec<(f64, f64)>> {
    let (xs, ys) = (column(x, xs)?, column(y, ys)?);
    if xs.len() != ys.len() {
        return Err(refused(format!("{x} has {} entries, but {y} has {}", xs.len(), ys.len())));
    }
    Ok(xs.iter().copied().zip(ys.iter().copied()).collect())
}

/// Sizes and percents.
fn arrays(py: Python<'_>, points: Vec<CurvePoint>) -> Points<'_> {
    let (sizes, percents): (Vec<f64>, Vec<f64>) = points.into_iter().map(|p| (p.size, p.percent)).unzip();
    (sizes.into_pyarray(py).into_any(), percents.into_pyarray(py).into_any())
}

#[pymethods]
impl Gradation {
    #[staticmethod]
    fn linear(percent: f64, size_mm: f64, cu: f64) -> PyResult<Self> {
        let inner = match percent {
            0.0 => gradation::Gradation::linear_from_d0(size_mm, cu),
            percent => gradation::Gradation::linear_from_dx(percent, size_mm, cu),
        };
        Ok(Self { inner: inner.map_err(refused)? })
    }

    #[staticmethod]
    fn single(size_mm: f64) -> PyResult<Self> {
        Ok(Self { inner: gradation::Gradation::single(size_mm).map_err(refused)? })
    }

    #[staticmethod]
    #[pyo3(signature = (size_mm, percent_finer, d0_mm=None))]
    fn from_points(
        size_mm: PyReadonlyArray1<'_, f64>,
        percent_finer: PyReadonlyArray1<'_, f64>,
        d0_mm: Option<f64>,
    ) -> PyResult<Self> {
        let points = paired(("size_mm", &size_mm), ("percent_finer", &percent_finer))?;
        Ok(Self { inner: gradation::Gradation::from_points(&points, d0_mm).map_err(of_points)? })
    }

    /// Every soil in a file, by name.
    #[staticmethod]
    #[pyo3(signature = (path, d0_mm=None))]
    fn in_file(path: std::path::PathBuf, d0_mm: Option<f64>) -> PyResult<Vec<(String, Self)>> {
        let curves = curves_in_file(&path, d0_mm).map_err(refused)?;
        Ok(curves.into_iter().map(|(name, inner)| (name, Self { inner })).collect())
    }

    fn d(&self, percent: f64) -> Option<f64> {
        self.inner.d(percent)
    }

    fn d_by_number(&self, percent: f64) -> Option<f64> {
        self.inner.d_by_number(percent)
    }

    fn percent_finer(&self, size_mm: f64) -> f64 {
        self.inner.percent_finer_by_mass(size_mm)
    }

    #[getter]
    fn cu(&self) -> Option<f64> {
        self.inner.cu()
    }

    #[getter]
    fn pan_fraction(&self) -> f64 {
        self.inner.pan_fraction()
    }

    fn points<'py>(&self, py: Python<'py>) -> Points<'py> {
        arrays(py, self.inner.points())
    }

    /// Base particles by Eq. (2), with this gradation as the base.
    fn base_particles(
        &self,
        filter: &Self,
        mass_ratio: f64,
        grains_per_void: f64,
        voids: u64,
    ) -> PyResult<u64> {
        let supply =
            gradation::base_particles(mass_ratio, grains_per_void, voids, &self.inner, &filter.inner, None);
        Ok(supply.map_err(refused)?.n_base)
    }
}

/// A constriction curve of the library, in mm.
#[pyclass(frozen, module = "voidwalk._voidwalk")]
pub struct Curve {
    pub inner: constrictions::Curve,
}

#[pymethods]
impl Curve {
    #[staticmethod]
    fn from_points(
        percent_smaller: PyReadonlyArray1<'_, f64>,
        diameter_mm: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let points = paired(("percent_smaller", &percent_smaller), ("diameter_mm", &diameter_mm))?;
        let inner = constrictions::Curve::from_points(&points, CurveUnit::Mm).map_err(of_points)?;
        Ok(Self { inner })
    }

    /// The shipped curve of this name, of a filter with this smallest grain; that filter and its grains per void.
    #[staticmethod]
    fn shipped(name: &str, d0_mm: f64) -> PyResult<(Self, Gradation, f64)> {
        let filter = constrictions::find(name).map_err(refused)?;
        let inner = filter.curve().and_then(|curve| curve.in_mm(d0_mm)).map_err(refused)?;
        let gradation = gradation::Gradation::linear_from_d0(d0_mm, filter.cu).map_err(refused)?;
        Ok((Self { inner }, Gradation { inner: gradation }, filter.grains_per_void))
    }

    #[staticmethod]
    fn from_file(path: std::path::PathBuf, d0_mm: f64) -> PyResult<Self> {
        let inner =
            constrictions::Curve::from_csv(path).and_then(|curve| curve.in_mm(d0_mm)).map_err(refused)?;
        Ok(Self { inner })
    }

    fn dc(&self, percent: f64) -> Option<f64> {
        self.inner.dc(percent)
    }

    fn percent_smaller(&self, diameter_mm: f64) -> f64 {
        self.inner.percent_smaller(diameter_mm)
    }

    #[getter]
    fn cu(&self) -> f64 {
        self.inner.cu()
    }

    fn points<'py>(&self, py: Python<'py>) -> Points<'py> {
        let (sizes, percents) = arrays(py, self.inner.points());
        (percents, sizes)
    }
}
