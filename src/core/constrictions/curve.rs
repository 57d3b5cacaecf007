//! A constriction size distribution, by number.

use crate::gradation::{CurvePoint, Direction, NumberError, Row, Table, TableError, check_size, rising};
use crate::stream::unit;
use std::fmt;
use std::path::Path;

/// Unit of the diameters of a [`Curve`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveUnit {
    /// Millimetres.
    Mm,
    /// The smallest grain of the filter, D0F: a scale-free curve.
    D0f,
}

impl CurveUnit {
    /// Returns the name of the diameter column in this unit.
    pub(crate) fn field(self) -> &'static str {
        match self {
            CurveUnit::Mm => "diameter_mm",
            CurveUnit::D0f => "diameter_over_d0f",
        }
    }
}

impl fmt::Display for CurveUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            CurveUnit::Mm => "mm",
            CurveUnit::D0f => "D0F",
        })
    }
}

/// An invalid constriction curve.
#[derive(Debug, thiserror::Error)]
pub enum CurveError {
    /// The table of the curve.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A number that is not from a table.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// The packing has no constriction to measure.
    #[error(
        "the packing has no constriction: its {0} tetrahedra form {1} voids, with no open facet \
         between two; more grains of the sizes that carry the filter are needed"
    )]
    NoConstriction(usize, usize),
    /// A name of no shipped filter, the most similar name, and all names.
    #[error("no shipped filter is called \"{0}\"; the nearest is \"{1}\" (shipped: {2})")]
    UnknownFilter(String, String, String),
}

const PERCENT: &str = "percent_smaller";

/// A constriction size distribution (CSD): percent smaller by number against diameter, linear between
/// its points.
///
/// Invariants: diameters and percent never fall, and percent goes from 0 to 100. One point is a single
/// size; the same diameter twice is a vertical step; the same percent twice is a plateau, a gap in the
/// sizes. A first point above 0 % is a step at its diameter.
///
/// ```
/// use voidwalk_core::constrictions::{Curve, CurveUnit};
/// let curve = Curve::from_points(&[(0.0, 0.15), (100.0, 0.35)], CurveUnit::D0f)?;
/// assert_eq!(curve.dc(50.0), Some(0.25));
/// assert!((curve.percent_smaller(0.25) - 50.0).abs() < 1e-9);
/// assert_eq!(curve.quantile(0.5), 0.25);
/// # Ok::<(), voidwalk_core::constrictions::CurveError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Percent smaller by number at each point, 0 first and 100 last, never falling.
    percent: Vec<f64>,
    /// Diameter of each point, never falling.
    diameter: Vec<f64>,
    unit: CurveUnit,
}

impl Curve {
    /// Makes a curve through pairs of percent smaller and diameter, in `unit`, rising or falling.
    ///
    /// # Errors
    /// Errors of [`Curve::from_csv`]; the line is the point's number in the list.
    pub fn from_points(points: &[(f64, f64)], unit: CurveUnit) -> Result<Curve, CurveError> {
        let points = points.iter().map(|&(percent, size)| (size, percent));
        Curve::from_rows("points", Row::listed(points, [unit.field(), PERCENT])?, unit)
    }

    /// Reads a curve from a CSV file with the columns `percent_smaller` and `diameter_mm` or
    /// `diameter_over_d0f`, in either order, named in a header.
    ///
    /// # Errors
    /// A file that cannot be read, is a folder, is too large or is not UTF-8; no header, or other names in
    /// it; no rows; a row without exactly two fields; a value that is not a finite number in range; diameters
    /// that both rise and fall; percent that falls as diameter rises; a largest diameter below 100 %.
    pub fn from_csv(path: impl AsRef<Path>) -> Result<Curve, CurveError> {
        Curve::from_table(&Table::open(path.as_ref())?)
    }

    /// Parses the content of a file like [`Curve::from_csv`]; `name` is used in messages.
    pub fn from_csv_text(name: &str, content: &[u8]) -> Result<Curve, CurveError> {
        Curve::from_table(&Table::parse(name, content)?)
    }

    fn from_table(table: &Table) -> Result<Curve, CurveError> {
        let refused = |line, value: String, nearest: Option<&str>| TableError::Header {
            file: table.file.clone(),
            line,
            value,
            allowed: format!(
                "percent_smaller and diameter_mm, or percent_smaller and diameter_over_d0f{}",
                nearest.map_or(String::new(), |n| format!(" (nearest: {n})"))
            ),
        };
        let Some((line, names)) = &table.header else {
            return Err(refused(table.first_line(), "no header".into(), None).into());
        };
        let names = names.each_ref().map(|n| n.to_lowercase());
        for (size_column, unit) in
            [(0, CurveUnit::Mm), (1, CurveUnit::Mm), (0, CurveUnit::D0f), (1, CurveUnit::D0f)]
        {
            if names[size_column] == unit.field() && names[1 - size_column] == PERCENT {
                let rows = table.rows(size_column, [unit.field(), PERCENT])?;
                return Curve::from_rows(&table.file, rows, unit);
            }
        }
        let known = [PERCENT, CurveUnit::Mm.field(), CurveUnit::D0f.field()];
        let wrong = names.iter().find(|n| !known.contains(&n.as_str()));
        let nearest = wrong.and_then(|wrong| nearest(wrong, known));
        let value = wrong.cloned().unwrap_or_else(|| names.join(","));
        Err(refused(*line, value, nearest).into())
    }

    fn from_rows(file: &str, rows: Vec<Row>, unit: CurveUnit) -> Result<Curve, CurveError> {
        let rows = rising(file, rows, [unit.field(), PERCENT], Direction::Steps)?;
        let mut points: Vec<(f64, f64)> = Vec::with_capacity(rows.len() + 1);
        if rows[0].percent > 0.0 {
            points.push((0.0, rows[0].size));
        }
        for row in rows {
            if points.last() == Some(&(row.percent, row.size)) {
                continue;
            }
            // Only the two ends of a vertical or level run of points are kept.
            if let [.., (p, d), (q, e)] = points[..]
                && ((d == e && e == row.size) || (p == q && q == row.percent))
            {
                points.pop();
            }
            points.push((row.percent, row.size));
        }
        // Plateaus at 0 % and at 100 % hold no constriction.
        let start = points.iter().rposition(|&(p, _)| p == 0.0).unwrap_or(0);
        let end = points.iter().position(|&(p, _)| p == 100.0).unwrap_or(points.len() - 1);
        let (percent, diameter) = points[start..=end].iter().copied().unzip();
        Ok(Curve { percent, diameter, unit })
    }

    /// D_cx: smallest diameter that `percent` of the constrictions do not exceed; `None` outside 0 to
    /// 100.
    pub fn dc(&self, percent: f64) -> Option<f64> {
        if !(0.0..=100.0).contains(&percent) {
            return None;
        }
        match self.percent.partition_point(|&p| p < percent) {
            0 => Some(self.diameter[0]),
            i => Some(self.up_to(i).at(percent)),
        }
    }

    /// Returns the segment that ends at point `i`, which is not the first.
    #[inline(always)]
    fn up_to(&self, i: usize) -> Part {
        let ends = |points: &[f64]| [points[i - 1], points[i]];
        Part { percent: ends(&self.percent), diameter: ends(&self.diameter) }
    }

    /// Draws diameters from random words: [`Curve::quantile`] at [`unit`] of each word.
    pub(crate) fn draws(&self) -> CurveDraws<'_> {
        // There are at least two points, the first at 0 %.
        let mut end = 1;
        let of_bucket = |bucket: u64| {
            let percent = 100.0 * unit(bucket << BELOW_BUCKET);
            end += self.percent[end..].iter().take_while(|&&p| p < percent).count();
            end as u32
        };
        CurveDraws { curve: self, end: (0..=u64::MAX >> BELOW_BUCKET).map(of_bucket).collect() }
    }

    /// Percent by number of the constrictions that are no larger than `diameter` (in this curve's unit).
    pub fn percent_smaller(&self, diameter: f64) -> f64 {
        let above = self.diameter.partition_point(|&d| d <= diameter);
        if above == 0 {
            return 0.0;
        }
        if above == self.diameter.len() {
            return 100.0;
        }
        let (a, b) = (self.diameter[above - 1], self.diameter[above]);
        let (p, q) = (self.percent[above - 1], self.percent[above]);
        (p + (diameter - a) / (b - a) * (q - p)).clamp(p, q)
    }

    /// Diameter at the fraction `unit`: the inverse of the distribution, so that a uniform `unit` from 0
    /// to 1 draws a constriction. It never falls as `unit` rises; outside 0 to 1 it is the nearest end.
    pub fn quantile(&self, unit: f64) -> f64 {
        match self.dc(100.0 * unit) {
            Some(diameter) => diameter,
            None if unit > 0.5 => self.diameter[self.diameter.len() - 1],
            None => self.diameter[0],
        }
    }

    /// Coefficient of uniformity of the constrictions, `D_c60 / D_c10`.
    pub fn cu(&self) -> f64 {
        self.quantile(0.6) / self.quantile(0.1)
    }

    /// Smallest constriction, D_c0.
    pub fn smallest(&self) -> f64 {
        self.diameter[0]
    }

    /// Largest constriction, D_c100.
    pub fn largest(&self) -> f64 {
        self.diameter[self.diameter.len() - 1]
    }

    /// Unit of the diameters.
    pub fn unit(&self) -> CurveUnit {
        self.unit
    }

    /// Points of the curve, from 0 % to 100 %.
    pub fn points(&self) -> Vec<CurvePoint> {
        let point = |(&size, &percent): (&f64, &f64)| CurvePoint { size, percent };
        self.diameter.iter().zip(&self.percent).map(point).collect()
    }

    /// Multiplies every diameter by `factor` and keeps the unit.
    ///
    /// # Errors
    /// A factor that is not positive and finite, or that takes a diameter out of range.
    pub fn scaled(&self, factor: f64) -> Result<Curve, CurveError> {
        NumberError::unless_positive("factor", factor)?;
        let diameter: Vec<f64> = self.diameter.iter().map(|d| d * factor).collect();
        for &d in &diameter {
            check_size("scaled diameter", d)?;
        }
        Ok(Curve { percent: self.percent.clone(), diameter, unit: self.unit })
    }

    /// Converts the curve to mm, for a filter whose smallest grain is `d0f_mm`.
    ///
    /// # Errors
    /// Errors of [`Curve::scaled`].
    pub fn in_mm(&self, d0f_mm: f64) -> Result<Curve, CurveError> {
        match self.unit {
            CurveUnit::Mm => Ok(self.clone()),
            CurveUnit::D0f => Ok(Curve { unit: CurveUnit::Mm, ..self.scaled(d0f_mm)? }),
        }
    }
}

/// A segment of a curve, linear in percent against diameter.
#[derive(Clone, Copy, Default)]
struct Part {
    percent: [f64; 2],
    diameter: [f64; 2],
}

impl Part {
    /// Diameter at `percent`, which is above the first end and at most the second.
    #[inline(always)]
    fn at(self, percent: f64) -> f64 {
        let ([p, q], [a, b]) = (self.percent, self.diameter);
        let d = a + (percent - p) / (q - p) * (b - a);
        let d = if d < a { a } else { d };
        let d = if d > b { b } else { d };
        if percent == q { b } else { d }
    }
}

/// Number of bits of a word below those of its bucket: 1,024 buckets.
const BELOW_BUCKET: u32 = 54;

/// Number of words whose diameters are drawn together.
const AT_ONCE: usize = 64;

/// The inverse of a curve for random words: the segment of each is looked up, not searched for.
pub(crate) struct CurveDraws<'a> {
    curve: &'a Curve,
    /// Point that ends the segment of the bucket's smallest word, by bucket (the upper bits of a word).
    end: Vec<u32>,
}

impl CurveDraws<'_> {
    /// Draws diameters, in the curve's unit, from successive words of `next`.
    pub(crate) fn fill(&self, mut next: impl FnMut() -> u64, out: &mut [f32], unit_mm: f64) {
        for out in out.chunks_mut(AT_ONCE) {
            let (mut percent, mut parts) = ([0.0; AT_ONCE], [Part::default(); AT_ONCE]);
            for (percent, part) in percent.iter_mut().zip(&mut parts).take(out.len()) {
                let word = next();
                *percent = 100.0 * unit(word);
                let mut end = self.end[(word >> BELOW_BUCKET) as usize] as usize;
                while self.curve.percent[end] < *percent {
                    end += 1;
                }
                *part = self.curve.up_to(end);
            }
            for ((out, &percent), part) in out.iter_mut().zip(&percent).zip(&parts) {
                *out = (part.at(percent) / unit_mm) as f32;
            }
        }
    }
}

/// Entry of `known` most similar to `name`; `None` if `known` is empty.
pub(super) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known.into_iter().max_by(|a, b| strsim::jaro_winkler(name, a).total_cmp(&strsim::jaro_winkler(name, b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64)]) -> Curve {
        Curve::from_points(points, CurveUnit::D0f).unwrap()
    }

    /// Points in the form accepted by `from_points`.
    fn pairs(curve: &Curve) -> Vec<(f64, f64)> {
        curve.points().iter().map(|point| (point.percent, point.size)).collect()
    }

    #[test]
    fn one_point_is_one_size() {
        let one = curve(&[(100.0, 0.2)]);
        assert_eq!(pairs(&one), [(0.0, 0.2), (100.0, 0.2)]);
        for unit in [0.0, 0.3, 1.0] {
            assert_eq!(one.quantile(unit), 0.2);
        }
        assert_eq!((one.percent_smaller(0.199), one.percent_smaller(0.2)), (0.0, 100.0));
        assert_eq!(one.cu(), 1.0);
        assert_eq!(one, curve(&[(100.0, 0.2), (0.0, 0.2)]));
    }

    #[test]
    fn a_first_point_above_zero_is_a_step() {
        let stepped = curve(&[(20.0, 0.2), (100.0, 0.4)]);
        assert_eq!((stepped.dc(0.0), stepped.dc(20.0), stepped.dc(100.0)), (Some(0.2), Some(0.2), Some(0.4)));
        assert_eq!(stepped.quantile(0.1), 0.2);
        assert_eq!((stepped.percent_smaller(0.19), stepped.percent_smaller(0.2)), (0.0, 20.0));
        assert!((stepped.quantile(0.6) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn steps_and_plateaus() {
        let both = curve(&[(0.0, 0.1), (30.0, 0.2), (40.0, 0.2), (60.0, 0.2), (60.0, 0.4), (100.0, 0.5)]);
        assert_eq!(
            pairs(&both),
            [(0.0, 0.1), (30.0, 0.2), (60.0, 0.2), (60.0, 0.4), (100.0, 0.5)],
            "a point inside a step is merged"
        );
        assert_eq!((both.dc(45.0), both.dc(60.0)), (Some(0.2), Some(0.2)));
        assert!(both.quantile(0.6001) > 0.4);
        assert_eq!((both.percent_smaller(0.2), both.percent_smaller(0.3)), (60.0, 60.0));
    }

    #[test]
    fn outside_the_curve() {
        let c = curve(&[(0.0, 0.1), (100.0, 0.3)]);
        assert_eq!((c.dc(-0.1), c.dc(100.1), c.dc(f64::NAN)), (None, None, None));
        assert_eq!((c.quantile(-1.0), c.quantile(2.0)), (0.1, 0.3));
        assert_eq!((c.percent_smaller(0.0), c.percent_smaller(1.0)), (0.0, 100.0));
    }

    /// Checks curves with one size, steps, plateaus, and many points: at the bounds of buckets, beside
    /// them, and anywhere.
    #[test]
    fn words_draw_what_the_quantile_of_each_is() {
        let many: Vec<_> = (0..=5000).map(|i| (0.02 * f64::from(i), 0.1 + 1e-5 * f64::from(i))).collect();
        let steps = [(0.0, 0.1), (30.0, 0.2), (60.0, 0.2), (60.0, 0.4), (60.1, 0.4), (100.0, 0.5)];
        let crowded = [(0.0, 0.1), (1e-15, 0.2), (1e-13, 0.3), (100.0 - 1e-13, 0.4), (100.0, 0.5)];
        let all: [&[(f64, f64)]; 5] =
            [&[(100.0, 0.2)], &[(20.0, 0.2), (100.0, 0.4)], &steps, &crowded, &many];
        for points in all {
            let curve = curve(points);
            let bounds = (0..1 << 10).flat_map(|bucket: u64| {
                let first = bucket << BELOW_BUCKET;
                [first, first + 4095, first + 4096, first.wrapping_sub(1), first.wrapping_sub(4097)]
            });
            let anywhere = (0..10_000).map(|i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            let words: Vec<u64> = bounds.chain(anywhere).collect();
            let (mut drawn, mut next) = (vec![0.0; words.len()], words.iter());
            curve.draws().fill(|| *next.next().unwrap(), &mut drawn, 0.7);
            for (word, drawn) in words.iter().zip(drawn) {
                assert_eq!((curve.quantile(unit(*word)) / 0.7) as f32, drawn, "{word}");
            }
            assert!(next.next().is_none());
        }
    }

    #[test]
    fn units_and_scale() {
        let c = curve(&[(0.0, 0.1), (100.0, 0.3)]);
        let mm = c.in_mm(2.0).unwrap();
        assert_eq!((mm.unit(), mm.smallest(), mm.largest()), (CurveUnit::Mm, 0.2, 0.6));
        assert_eq!(mm.in_mm(5.0).unwrap(), mm, "mm stay mm");
        assert_eq!(
            c.scaled(0.0).unwrap_err().to_string(),
            "factor = 0.0 is not allowed; allowed: a positive finite number"
        );
        assert!(c.scaled(1e-20).is_err());
    }
}
