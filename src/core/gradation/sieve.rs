//! Makes, checks and reads a sieve curve.

use super::curve_point::{CurvePoint, TIE};
use super::error::Position;
use super::error::{GradationError, NumberError, TableError};
use super::segments::cumulative;
use super::table::{Direction, Row, check_percent, check_size, rising};

/// Names of the two columns in messages.
pub const FIELDS: [&str; 2] = ["opening_mm", "percent_finer"];

/// A sieve curve: percent finer by mass against size, straight in percent against ln(size).
///
/// Invariants: sizes rise, percent never falls, the coarsest point is 100 %. A flat piece between two points
/// (a gap-graded soil) has no particles in it.
///
/// ```
/// use voidwalk_core::gradation::Gradation;
/// let base = Gradation::linear_from_dx(85.0, 0.2, 3.0)?;
/// assert!((base.cu().unwrap() - 3.0).abs() < 1e-12);
/// assert!((base.d(85.0).unwrap() - 0.2).abs() < 1e-12);
/// assert!(base.d_by_number(50.0).unwrap() < base.d(50.0).unwrap());
/// # Ok::<(), voidwalk_core::gradation::GradationError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Gradation {
    /// Size of each point (mm), rising; one entry for a single size.
    pub(super) size_mm: Vec<f64>,
    /// Percent finer by mass at each point, never falling, 100 at the last.
    pub(super) percent: Vec<f64>,
    /// ln of the size ratio over each segment; entry i is from point i to point i + 1.
    pub(super) log_ratio: Vec<f64>,
    /// Particles finer than each point, in one mm3 of solid.
    pub(super) number: Vec<f64>,
    /// Number of segments, from the finest on, that are stated as straight lines and are no steps between two
    /// sieves.
    pub(super) lines: usize,
}

impl Gradation {
    /// Makes a straight line on semi-log paper from its smallest size: `D_x = d0_mm Cu^(x / 50)`.
    ///
    /// # Errors
    /// A size out of range (`SIZE_MIN_MM ..= SIZE_MAX_MM`, also for the largest, `d0_mm cu^2`), or a `cu`
    /// below 1; `cu` = 1 is a single size.
    pub fn linear_from_d0(d0_mm: f64, cu: f64) -> Result<Gradation, GradationError> {
        check_size("d0_mm", d0_mm)?;
        check_cu(cu)?;
        let largest = d0_mm * (cu * cu);
        check_size("d100_mm", largest)?;
        if largest == d0_mm {
            return Gradation::single(d0_mm);
        }
        Ok(Gradation::new(vec![d0_mm, largest], vec![0.0, 100.0]))
    }

    /// Makes a straight line on semi-log paper through one of its sizes: `D_percent` is `dx_mm`.
    ///
    /// # Errors
    /// Errors of [`Gradation::linear_from_d0`], and a `percent` outside 0 to 100.
    pub fn linear_from_dx(percent: f64, dx_mm: f64, cu: f64) -> Result<Gradation, GradationError> {
        check_percent("percent", percent)?;
        check_size("dx_mm", dx_mm)?;
        check_cu(cu)?;
        Gradation::linear_from_d0(dx_mm / libm::pow(cu, percent / 50.0), cu)
    }

    /// Makes a gradation of particles of one size.
    ///
    /// # Errors
    /// A size out of range (`SIZE_MIN_MM ..= SIZE_MAX_MM`).
    pub fn single(d_mm: f64) -> Result<Gradation, GradationError> {
        check_size("d_mm", d_mm)?;
        Ok(Gradation::new(vec![d_mm], vec![100.0]))
    }

    /// Makes a gradation from a sieve table: pairs of opening (mm) and percent finer by mass, ascending or
    /// descending.
    ///
    /// A finest point above 0 % leaves a tail: with `d0_mm` the curve goes on straight to 0 % at that size;
    /// without it the pan fraction is counted by mass only.
    ///
    /// # Errors
    /// Rows that are no sieve curve, with the point's place in the list as the line.
    pub fn from_points(points: &[(f64, f64)], d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
        let rows = points.iter().enumerate().map(|(i, &(size, percent))| Row { line: i + 1, size, percent });
        from_rows("points", Row::checked("points", rows.collect(), FIELDS)?, d0_mm)
    }

    /// Makes a curve that is stated as straight lines between these points, and not by sieves: nothing is
    /// open between them.
    ///
    /// # Errors
    /// Errors of [`Gradation::from_points`].
    pub fn from_lines(points: &[(f64, f64)]) -> Result<Gradation, GradationError> {
        let curve = Gradation::from_points(points, None)?;
        Ok(Gradation { lines: curve.size_mm.len(), ..curve })
    }

    /// Makes a gradation from rows of a record: size (mm), percent finer by mass.
    pub fn of_rows(rows: &[[f64; 2]]) -> Result<Gradation, GradationError> {
        let points: Vec<(f64, f64)> = rows.iter().map(|&[size, percent]| (size, percent)).collect();
        Gradation::from_lines(&points)
    }

    /// Makes a curve of straight lines from checked points.
    pub(super) fn new(size_mm: Vec<f64>, percent: Vec<f64>) -> Gradation {
        let lines = size_mm.len();
        Gradation::sieved(size_mm, percent, lines)
    }

    /// Makes a curve from checked points; all but the first `lines` segments lie between sieves.
    pub(super) fn sieved(size_mm: Vec<f64>, percent: Vec<f64>, lines: usize) -> Gradation {
        let log_ratio: Vec<f64> = size_mm.windows(2).map(|w| libm::log(w[1] / w[0])).collect();
        let number = cumulative(&size_mm, &percent, &log_ratio);
        Gradation { size_mm, percent, log_ratio, number, lines }
    }

    /// Multiplies every size by `factor`.
    ///
    /// # Errors
    /// A factor that is not positive and finite, or that takes a size out of range.
    pub fn scaled(&self, factor: f64) -> Result<Gradation, GradationError> {
        NumberError::unless_positive("factor", factor)?;
        let size_mm: Vec<f64> = self.size_mm.iter().map(|d| d * factor).collect();
        for &d in &size_mm {
            check_size("scaled size", d)?;
        }
        Ok(Gradation::sieved(size_mm, self.percent.clone(), self.lines))
    }

    /// D_x: the smallest size (mm) that `percent` of the mass is finer than or equal to.
    ///
    /// `None` for a percentage outside 0 to 100, or in a pan fraction.
    pub fn d(&self, percent: f64) -> Option<f64> {
        if !(0.0..=100.0).contains(&percent) || percent < self.tail_percent() {
            return None;
        }
        // Percents that differ by the last digits of a sum are one percent.
        let i = self.percent.partition_point(|&p| p < percent - 100.0 * TIE);
        if i == 0 || self.percent[i] <= percent + 100.0 * TIE {
            return Some(self.size_mm[i]);
        }
        let share = (percent - self.percent[i - 1]) / (self.percent[i] - self.percent[i - 1]);
        let d = self.size_mm[i - 1] * libm::exp(share * self.log_ratio[i - 1]);
        Some(d.clamp(self.size_mm[i - 1], self.size_mm[i]))
    }

    /// Coefficient of uniformity, `D_60 / D_10`; `None` if D_10 lies in a pan fraction.
    pub fn cu(&self) -> Option<f64> {
        Some(self.d(60.0)? / self.d(10.0)?)
    }

    /// Smallest size of known mass (mm): D_0, or the finest opening if there is a tail.
    pub fn smallest_mm(&self) -> f64 {
        self.size_mm[0]
    }

    /// Largest size (mm), D_100.
    pub fn largest_mm(&self) -> f64 {
        self.size_mm[self.size_mm.len() - 1]
    }

    /// Percent by mass no coarser than `d_mm`; `None` if that lies in a pan fraction.
    pub fn percent_finer_if_known(&self, d_mm: f64) -> Option<f64> {
        (self.pan_fraction() == 0.0 || self.smallest_mm() <= d_mm).then(|| self.percent_finer_by_mass(d_mm))
    }

    /// Percent by mass no coarser than `d_mm`. A pan fraction counts as finer than any size.
    pub fn percent_finer_by_mass(&self, d_mm: f64) -> f64 {
        let above = self.size_mm.partition_point(|&d| d <= d_mm);
        if above == 0 {
            return self.tail_percent();
        }
        if above == self.size_mm.len() {
            return 100.0;
        }
        let (low, high) = (self.percent[above - 1], self.percent[above]);
        let share = libm::log(d_mm / self.size_mm[above - 1]) / self.log_ratio[above - 1];
        (low + share * (high - low)).clamp(low, high)
    }

    /// Pan fraction: share of the mass, 0 to 1, finer than the finest sieve. It is counted by mass only.
    pub fn pan_fraction(&self) -> f64 {
        self.tail_percent() / 100.0
    }

    /// Points of the curve for a plot; sizes never fall. A single size is the two ends of its vertical line.
    pub fn points(&self) -> Vec<CurvePoint> {
        let point = |(&size, &percent): (&f64, &f64)| CurvePoint { size, percent };
        let mut points: Vec<_> = self.size_mm.iter().zip(&self.percent).map(point).collect();
        if points.len() == 1 {
            points.insert(0, CurvePoint { size: self.size_mm[0], percent: 0.0 });
        }
        points
    }

    /// Points as rows of a record: size, percent finer by mass.
    pub fn rows(&self) -> Vec<[f64; 2]> {
        self.points().into_iter().map(CurvePoint::row).collect()
    }

    fn tail_percent(&self) -> f64 {
        if self.size_mm.len() == 1 { 0.0 } else { self.percent[0] }
    }
}

fn check_cu(value: f64) -> Result<(), NumberError> {
    match value >= 1.0 && value.is_finite() {
        true => Ok(()),
        false => Err(NumberError::new("cu", value, "a finite number, 1 (a single size) or more")),
    }
}

/// Makes a curve from the rows of a table, in ascending or descending order.
pub fn from_rows(file: &str, rows: Vec<Row>, d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
    let rows = rising(file, rows, FIELDS, Direction::Strict)?;
    let (finest, single) = (rows[0], rows.len() == 1);
    let mut size_mm: Vec<f64> = rows.iter().map(|r| r.size).collect();
    let mut percent: Vec<f64> = rows.iter().map(|r| r.percent).collect();
    match d0_mm {
        Some(d0) => {
            check_size("d0_mm", d0)?;
            if finest.percent == 0.0 {
                let allowed = format!("none, since {file} itself goes down to 0 % (at {} mm)", finest.size);
                return Err(NumberError::new("d0_mm", d0, allowed).into());
            }
            if d0 >= finest.size {
                let allowed = format!("a size below the finest opening of {file}, {} mm", finest.size);
                return Err(NumberError::new("d0_mm", d0, allowed).into());
            }
            size_mm.insert(0, d0);
            percent.insert(0, 0.0);
        }
        None if single => {
            return Err(TableError::Value {
                at: Position { file: file.into(), line: finest.line, field: FIELDS[0], column: None },
                value: finest.size.to_string(),
                allowed: "at least two openings, or one and the smallest size (d0_mm); \
                          one row alone leaves all of the mass of unknown size"
                    .into(),
            }
            .into());
        }
        None => {}
    }
    // Points before the last 0 % and after the first 100 % hold no mass.
    let end = percent.partition_point(|&p| p < 100.0) + 1;
    size_mm.truncate(end);
    percent.truncate(end);
    let start = percent.partition_point(|&p| p <= 0.0).saturating_sub(1);
    if end == start + 1 {
        return Err(TableError::Value {
            at: Position { file: file.into(), line: finest.line, field: FIELDS[1], column: None },
            value: finest.percent.to_string(),
            allowed: "less than 100 at the finest opening (all of the mass is of unknown size), \
                      or the smallest size (d0_mm)"
                .into(),
        }
        .into());
    }
    Ok(Gradation::sieved(size_mm.split_off(start), percent.split_off(start), usize::from(d0_mm.is_some())))
}
