//! A sieve curve: made, checked and read. Wide steps between two of its sieves, where the distribution
//! of the mass is unknown.

use super::error::{GradationError, NumberError, TableError};
use super::table::{Direction, Row, check_percent, check_size, rising};
use serde::Serialize;
use std::f64::consts::PI;

/// Upper limit of fines (mm): the No. 200 sieve.
pub const FINES_MM: f64 = 0.075;

/// Lower limit of gravel (mm): the No. 4 sieve.
pub const GRAVEL_MM: f64 = 4.75;

/// Names of the two columns in messages.
pub const FIELDS: [&str; 2] = ["opening_mm", "percent_finer"];

/// A sieve curve: percent finer by mass against size, linear in percent against ln(size).
///
/// Invariants: sizes rise, percent never falls, the coarsest point is 100 %. A flat segment between two
/// points (a gap-graded soil) has no particles in it.
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
    /// Size of each point (mm), rising; one entry for particles of a single size.
    pub(super) size_mm: Vec<f64>,
    /// Percent finer by mass at each point, never falling, 100 at the last.
    pub(super) percent: Vec<f64>,
    /// ln of the size ratio over each segment; entry i is from point i to point i + 1.
    pub(super) log_ratio: Vec<f64>,
    /// Number of particles finer than each point, per mm3 of solid.
    pub(super) number: Vec<f64>,
    /// Number of segments, from the finest on, that were given as straight lines, not as steps between
    /// two sieves.
    pub(super) lines: usize,
}

impl Gradation {
    /// Makes a straight line on semi-log paper from its smallest size: `D_x = d0_mm Cu^(x / 50)`.
    ///
    /// # Errors
    /// A size out of range (1e-12 to 1e12 mm, also for the largest, `d0_mm cu^2`), or a `cu` below 1.
    /// `cu` = 1 is a single size.
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

    /// Makes a straight line on semi-log paper through a given size: `D_percent` is `dx_mm`.
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
    /// A size out of range (1e-12 to 1e12 mm).
    pub fn single(d_mm: f64) -> Result<Gradation, GradationError> {
        check_size("d_mm", d_mm)?;
        Ok(Gradation::new(vec![d_mm], vec![100.0]))
    }

    /// Makes a gradation from a sieve table: pairs of opening (mm) and percent finer by mass, ascending or
    /// descending.
    ///
    /// A finest point above 0 % leaves a pan fraction: with `d0_mm` the curve continues straight to 0 %
    /// at that size; without it the pan fraction is counted by mass only.
    ///
    /// # Errors
    /// Rows that are not a sieve curve; the line is the point's number in the list.
    pub fn from_points(points: &[(f64, f64)], d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
        from_rows("points", Row::listed(points.iter().copied(), FIELDS)?, d0_mm)
    }

    /// Makes a curve given as straight lines between these points, not by sieves: nothing is uncertain
    /// between them.
    pub fn from_lines(points: &[(f64, f64)]) -> Result<Gradation, GradationError> {
        let curve = Gradation::from_points(points, None)?;
        Ok(Gradation { lines: curve.size_mm.len(), ..curve })
    }

    /// Makes a gradation from the rows of a record: size (mm), percent finer by mass.
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

    /// D_x: smallest size (mm) such that `percent` of the mass is no coarser.
    ///
    /// `None` for a percentage outside 0 to 100, or in a pan fraction.
    pub fn d(&self, percent: f64) -> Option<f64> {
        if !(0.0..=100.0).contains(&percent) || percent < self.tail_percent() {
            return None;
        }
        // Percents that differ only in the last digits of a sum are equal.
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

    /// Smallest size of known mass (mm): D_0, or the finest opening if there is a pan fraction.
    pub fn smallest_mm(&self) -> f64 {
        self.size_mm[0]
    }

    /// Largest size (mm), D_100.
    pub fn largest_mm(&self) -> f64 {
        self.size_mm[self.size_mm.len() - 1]
    }

    /// Percent by mass no coarser than `d_mm`; `None` if that size lies in a pan fraction.
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

    /// Pan fraction: fraction of the mass, 0 to 1, finer than the finest sieve. It is counted by mass only.
    pub fn pan_fraction(&self) -> f64 {
        self.tail_percent() / 100.0
    }

    /// Points of the curve for a plot; sizes never fall. A single size gives the two ends of a vertical line.
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
    let allowed = "a finite number, 1 (a single size) or more";
    NumberError::unless(value >= 1.0 && value.is_finite(), "cu", value, || allowed.into())
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
            NumberError::unless(finest.percent != 0.0, "d0_mm", d0, || {
                format!("none, since {file} itself goes down to 0 % (at {} mm)", finest.size)
            })?;
            NumberError::unless(d0 < finest.size, "d0_mm", d0, || {
                format!("a size below the finest opening of {file}, {} mm", finest.size)
            })?;
            size_mm.insert(0, d0);
            percent.insert(0, 0.0);
        }
        None if single => {
            let allowed = "at least two openings, or one and the smallest size (d0_mm); one row alone leaves \
                           all of the mass of unknown size";
            return Err(TableError::refused(file, finest.line, FIELDS[0], finest.size, allowed).into());
        }
        None => {}
    }
    // Points before the last 0 % or after the first 100 % hold no mass.
    let end = percent.partition_point(|&p| p < 100.0) + 1;
    size_mm.truncate(end);
    percent.truncate(end);
    let start = percent.partition_point(|&p| p <= 0.0).saturating_sub(1);
    if end == start + 1 {
        let allowed = "less than 100 at the finest opening (all of the mass is of unknown size), or the \
                       smallest size (d0_mm)";
        return Err(TableError::refused(file, finest.line, FIELDS[1], finest.percent, allowed).into());
    }
    Ok(Gradation::sieved(size_mm.split_off(start), percent.split_off(start), usize::from(d0_mm.is_some())))
}

/// Relative difference allowed between two ways of writing a number of a curve.
pub const TIE: f64 = 1e-9;

/// A point of a gradation or constriction curve; a row of size and percent in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(into = "[f64; 2]")]
pub struct CurvePoint {
    /// Diameter of a particle or constriction, in the unit of the curve: mm for a gradation.
    pub size: f64,
    /// Percent finer by mass, or smaller by number.
    pub percent: f64,
}

impl CurvePoint {
    /// Row of a record: size, percent.
    pub fn row(self) -> [f64; 2] {
        [self.size, self.percent]
    }
}

impl From<CurvePoint> for [f64; 2] {
    fn from(point: CurvePoint) -> Self {
        point.row()
    }
}

/// `(1 - e^(-3 l)) / l`, with its limit at 0.
fn shape(l: f64) -> f64 {
    if l > 0.0 { -libm::expm1(-3.0 * l) / l } else { 3.0 }
}

/// Particles per mm3 of solid in a segment from size `a` to `a e^l` with mass fraction `m`: the integral
/// of `6 / (pi D^3) dm`, which is `2 m / (pi a^3) (1 - e^(-3 l)) / l`. The number finer than `D` is
/// linear in `D^-3`.
pub(super) fn count(a: f64, l: f64, m: f64) -> f64 {
    2.0 * m / (PI * (a * a * a)) * shape(l)
}

fn cumulative(size_mm: &[f64], percent: &[f64], log_ratio: &[f64]) -> Vec<f64> {
    if let [d] = size_mm {
        return vec![6.0 / (PI * (d * d * d))];
    }
    let mut total = 0.0;
    let mut number = vec![0.0];
    for (i, &l) in log_ratio.iter().enumerate() {
        total += count(size_mm[i], l, (percent[i + 1] - percent[i]) / 100.0);
        number.push(total);
    }
    number
}

/// Maximum ratio of two neighbouring sieves between which practice draws a straight line. The openings of
/// 12.5 and 4.75 mm (2.63) are neighbours among the sieves that ASTM D448 requires for a No. 57 stone.
pub const USUAL_STEP: f64 = 2.65;

/// Ratio of two neighbouring sieves above which a rule has no result if it depends on the sizes between
/// them.
pub const WIDE_STEP: f64 = 4.0;

/// Mass (%) that remains spread over a step that is not wide when the rest of the step's mass is placed
/// at one of its sieves.
pub(super) const TRACE_PERCENT: f64 = 1e-6;

/// Relative distance within which mass counts as being at a sieve, and relative distance of mass from a
/// size at which a rule counts fines or gravel.
const NEXT: f64 = 1e-12;
const BESIDE: f64 = 1e-6;

/// Number of parts of a wide step, equal in ln(size); the bounds between them serve as single sizes.
const FILLINGS: i32 = 6;

/// Two neighbouring sieves with a ratio above [`USUAL_STEP`] and mass between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The finer sieve (mm).
    pub from_mm: f64,
    /// The coarser sieve (mm).
    pub to_mm: f64,
    segment: usize,
}

impl Step {
    /// Tells if the ratio of the sieves is above [`WIDE_STEP`].
    pub fn is_wide(self) -> bool {
        self.to_mm > self.from_mm * WIDE_STEP * (1.0 + TIE)
    }

    /// Ratio of the two sieves.
    pub fn ratio(self) -> f64 {
        self.to_mm / self.from_mm
    }

    /// Tells if a size lies strictly between the two sieves.
    pub fn holds(self, size_mm: f64) -> bool {
        size_mm > self.from_mm * (1.0 + TIE) && size_mm < self.to_mm * (1.0 - TIE)
    }

    /// Tells if a size lies between the two sieves, or at one of them.
    pub fn encloses(self, size_mm: f64) -> bool {
        (self.from_mm * (1.0 - TIE)..=self.to_mm * (1.0 + TIE)).contains(&size_mm)
    }
}

impl Gradation {
    /// Finds the steps between sieves that are too wide for practice to interpolate, the finest first. A
    /// given straight line has no such steps.
    pub fn open_steps(&self) -> Vec<Step> {
        let step = |i: usize| Step { from_mm: self.size_mm[i], to_mm: self.size_mm[i + 1], segment: i };
        let is_open = |i: &usize| {
            self.percent[i + 1] > self.percent[*i]
                && self.size_mm[i + 1] > self.size_mm[*i] * USUAL_STEP * (1.0 + TIE)
        };
        (self.lines..self.log_ratio.len()).filter(is_open).map(step).collect()
    }

    /// Fills the given steps of the curve with points between their sieves: size (mm) and percent finer,
    /// rising.
    pub fn filled(&self, steps: &[(Step, Vec<(f64, f64)>)]) -> Gradation {
        let (mut size_mm, mut percent) = (self.size_mm.clone(), self.percent.clone());
        for (step, points) in steps.iter().rev() {
            let at = step.segment + 1;
            size_mm.splice(at..at, points.iter().map(|point| point.0));
            percent.splice(at..at, points.iter().map(|point| point.1));
        }
        Gradation::new(size_mm, percent)
    }

    /// Points that place the mass of a step at one of its sieves.
    pub fn mass_at(&self, step: &Step, end: End) -> Vec<(f64, f64)> {
        let [low, high] = self.percents(step);
        // The sieves of a step that is not wide keep their percents: a trace of mass marks each.
        let trace = if step.is_wide() { 0.0 } else { TRACE_PERCENT.min((high - low) / 3.0) };
        match end {
            End::Fine => vec![(step.from_mm * (1.0 + NEXT), high - trace)],
            End::Coarse => vec![(step.to_mm * (1.0 - NEXT), low + trace)],
        }
    }

    /// Points that place the mass of a wide step inside it, in case neither of its ends is the worst: at
    /// single sizes, and in two parts with a gap between them.
    pub fn fillings(&self, step: &Step) -> Vec<Vec<(f64, f64)>> {
        let [low, high] = self.percents(step);
        let within =
            (1..FILLINGS).map(|i| step.from_mm * libm::pow(step.ratio(), f64::from(i) / f64::from(FILLINGS)));
        let beside = |size: f64| [size * (1.0 - 2.0 * BESIDE), size * (1.0 + BESIDE)];
        let sizes = [FINES_MM, GRAVEL_MM].into_iter().flat_map(beside).chain(within);
        // A gap covers a factor of four.
        let sizes = sizes.chain([step.from_mm * 3.9, step.to_mm / 3.9]);
        let at_once = sizes.filter(|size| step.holds(*size) && step.holds(size * (1.0 + BESIDE)));
        let at_once = at_once.map(|size| vec![(size, low), (size * (1.0 + NEXT), high)]);
        let parts = [0.1, 0.25, 0.5, 0.75].map(|part| low + part * (high - low));
        let parts = parts.into_iter().chain([10.0, 20.0, 30.0, 80.0]);
        let parts = parts.filter(|percent| low < *percent && *percent < high);
        let ends = [step.from_mm * (1.0 + NEXT), step.to_mm * (1.0 - NEXT)];
        at_once.chain(parts.map(|percent| ends.map(|end| (end, percent)).to_vec())).collect()
    }

    fn percents(&self, step: &Step) -> [f64; 2] {
        [self.percent[step.segment], self.percent[step.segment + 1]]
    }

    /// Largest size (mm) such that at most `percent` of the mass is finer; [`Gradation::d`] gives the
    /// smallest. They differ if the curve is flat at this percent.
    pub fn coarse_d(&self, percent: f64) -> Option<f64> {
        let above = self.percent.partition_point(|&p| p <= percent + 100.0 * TIE);
        match above.checked_sub(1).map(|i| (self.percent[i], self.size_mm[i])) {
            Some((p, d)) if (p - percent).abs() <= 100.0 * TIE => Some(d),
            _ => self.d(percent),
        }
    }
}

/// Sieve of a step at which its mass is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// At the finer sieve.
    Fine,
    /// At the coarser sieve.
    Coarse,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_common_sieves_is_no_open_one() {
        let stone = [(2.36, 1.0), (4.75, 5.0), (12.5, 42.5), (25.0, 97.5), (37.5, 100.0)];
        assert!(Gradation::from_points(&stone, None).unwrap().open_steps().is_empty());
        let four = Gradation::from_points(&[(0.075, 0.0), (0.3, 50.0), (1.3, 100.0)], None).unwrap();
        assert_eq!(four.open_steps().iter().map(|step| step.is_wide()).collect::<Vec<_>>(), [false, true]);
        // No sieve is missing between the finest sieve and a size given by the user.
        let stated = Gradation::from_points(&[(0.3, 12.0), (0.6, 100.0)], Some(0.01)).unwrap();
        assert!(stated.open_steps().is_empty());
    }

    #[test]
    fn mass_stands_at_either_end_of_a_step() {
        let sparse = Gradation::from_points(&[(0.3, 12.0), (38.0, 60.0), (75.0, 100.0)], None).unwrap();
        let steps = sparse.open_steps();
        for (end, d15, finer) in [(End::Fine, 0.3, 60.0), (End::Coarse, 38.0, 12.0)] {
            let curve = sparse.filled(&[(steps[0], sparse.mass_at(&steps[0], end))]);
            assert!((curve.d(15.0).unwrap() / d15 - 1.0).abs() < 1e-11);
            assert!((curve.percent_finer_by_mass(5.0) - finer).abs() < 1e-5);
            assert_eq!(curve.percent_finer_by_mass(0.3), 12.0);
            assert_eq!(curve.d(80.0), sparse.d(80.0));
            assert_eq!(curve.d(12.0), Some(0.3));
            assert!((curve.coarse_d(60.0).unwrap() / 38.0 - 1.0).abs() < 1e-11);
        }
    }

    #[test]
    fn a_flat_curve_has_two_sizes_of_its_percent() {
        let flat = Gradation::from_points(&[(0.6, 0.0), (1.18, 15.0), (2.36, 15.0), (4.75, 100.0)], None);
        let flat = flat.unwrap();
        assert_eq!((flat.d(15.0), flat.coarse_d(15.0)), (Some(1.18), Some(2.36)));
        assert_eq!(flat.d(40.0), flat.coarse_d(40.0));
    }
}
