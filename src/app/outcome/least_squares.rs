//! Straight lines by least squares.

/// A straight line by weighted least squares.
pub(crate) struct Straight {
    pub offset: f64,
    pub slope: f64,
    /// Standard error of the offset.
    pub offset_error: f64,
    /// Sum of squared deviations, each over its standard error.
    pub chi_squared: f64,
}

impl Straight {
    /// Fits a line through `(x, y, standard error of y)`.
    pub(crate) fn through(rows: &[(f64, f64, f64)]) -> Self {
        let sum = |term: &dyn Fn(f64, f64) -> f64| -> f64 {
            rows.iter().map(|&(x, y, error)| term(x, y) / (error * error)).sum()
        };
        let w = sum(&|_, _| 1.0);
        let (x, y) = (sum(&|x, _| x) / w, sum(&|_, y| y) / w);
        let xx = sum(&|xi, _| (xi - x) * (xi - x));
        let slope = sum(&|xi, yi| (xi - x) * (yi - y)) / xx;
        let offset = y - slope * x;
        let chi_squared = sum(&|xi, yi| (yi - offset - slope * xi) * (yi - offset - slope * xi));
        Self { offset, slope, offset_error: (1.0 / w + x * x / xx).sqrt(), chi_squared }
    }
}

/// Slope of ln(y) against ln(x) through points with positive coordinates, all of one weight.
pub(crate) fn log_log_slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs = || points.iter().map(|&(x, y)| (libm::log(x), libm::log(y)));
    let (x, y) = (logs().map(|(x, _)| x).sum::<f64>() / n, logs().map(|(_, y)| y).sum::<f64>() / n);
    let xy: f64 = logs().map(|(xi, yi)| (xi - x) * (yi - y)).sum();
    xy / logs().map(|(xi, _)| (xi - x) * (xi - x)).sum::<f64>()
}
