//! Axes: a range, a scale, and the positions of ticks and grid lines.

/// Spacing of values along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scale {
    Linear,
    Log,
}

/// Grid line with its label; without text it is a minor line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) text: String,
    /// Rank of the label: if two labels overlap, the one of lower rank is kept.
    pub(crate) rank: u8,
}

impl Tick {
    pub(crate) fn new(at: f64, text: impl Into<String>) -> Tick {
        Tick { at, text: text.into(), rank: 0 }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Measured quantity, with the unit.
    pub(crate) label: String,
    scale: Scale,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Grid lines, including minor ones.
    pub(crate) ticks: Vec<Tick>,
    /// True if values increase downwards (depth) or, on a horizontal axis, to the left (coarse sizes first).
    pub(crate) downward: bool,
}

impl Axis {
    /// Linear axis from `low` to `high`, widened to half steps of 1, 2 or 5.
    pub(crate) fn linear(label: &str, low: f64, high: f64) -> Axis {
        let (low, high) = if high > low { (low, high) } else { (low, low + 1.0) };
        let step = tidy_step((high - low) / 6.0);
        let (first, last) = ((2.0 * low / step + 1e-9).floor(), (2.0 * high / step - 1e-9).ceil());
        let decimals = libm::fmax(0.0, -libm::floor(libm::log10(step) + 1e-9)) as usize;
        let mut ticks = Vec::new();
        for half in first as i64..=last as i64 {
            let at = half as f64 * 0.5 * step;
            let text = if half % 2 == 0 { format!("{at:.decimals$}") } else { String::new() };
            ticks.push(Tick { at, text, rank: u8::from(half % 2 != 0) });
        }
        let (low, high) = (first * 0.5 * step, last * 0.5 * step);
        Axis { label: label.to_owned(), scale: Scale::Linear, low, high, ticks, downward: false }
    }

    /// Axis of percent from 0 to 100, with a line every 10.
    pub(crate) fn percent(label: &str) -> Axis {
        let ticks = (0..=10u8)
            .map(|ten| Tick {
                at: f64::from(ten) * 10.0,
                text: (u32::from(ten) * 10).to_string(),
                rank: ten % 2,
            })
            .collect();
        Axis { label: label.to_owned(), scale: Scale::Linear, low: 0.0, high: 100.0, ticks, downward: false }
    }

    /// Logarithmic axis around `low ... high` (both positive), with lines at 1, 2, ... 9 of each decade.
    pub fn log(label: &str, low: f64, high: f64) -> Axis {
        let (low, high) = (tidy_log(low * 0.97, false), tidy_log(high * 1.03, true));
        let decades = libm::log10(high / low);
        let mut ticks = Vec::new();
        for exponent in
            libm::floor(libm::log10(low) + 1e-9) as i32..=libm::ceil(libm::log10(high) - 1e-9) as i32
        {
            for digit in 1..=9u8 {
                let at = power_of_ten(f64::from(digit), exponent);
                if at < low * (1.0 - 1e-9) || at > high * (1.0 + 1e-9) {
                    continue;
                }
                let rank = match digit {
                    1 => 0,
                    2 | 5 => 1,
                    3 | 4 | 6 | 8 => 2,
                    _ => 3,
                };
                let most = if decades > 3.0 {
                    0
                } else if decades > 0.9 {
                    1
                } else {
                    2
                };
                let text = if rank <= most { decade_label(digit, exponent) } else { String::new() };
                ticks.push(Tick { at, text, rank });
            }
        }
        Axis { label: label.to_owned(), scale: Scale::Log, low, high, ticks, downward: false }
    }

    pub(crate) fn with_ticks(mut self, ticks: Vec<Tick>) -> Axis {
        self.ticks = ticks;
        self
    }

    pub(crate) fn downward(mut self) -> Axis {
        self.downward = true;
        self
    }

    /// Limits the axis to exactly `low` and `high`; ticks beyond them are removed.
    pub(crate) fn within(mut self, low: f64, high: f64) -> Axis {
        (self.low, self.high) = (low, high);
        self.ticks.retain(|tick| (low..=high).contains(&tick.at));
        self
    }

    /// Downward axis of named rows, counted from 1.
    pub(crate) fn rows(names: impl IntoIterator<Item = String>) -> Axis {
        let ticks: Vec<Tick> =
            (1..).zip(names).map(|(row, name): (u32, _)| Tick::new(f64::from(row), name)).collect();
        let high = ticks.len() as f64 + 0.7;
        Axis::linear("", 0.0, 1.0).with_ticks(ticks).downward().within(0.3, high)
    }

    /// Position of a value: 0 at `low`, 1 at `high`; `None` if the scale cannot show the value.
    pub(crate) fn position(&self, value: f64) -> Option<f64> {
        let position = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log if value > 0.0 => libm::log10(value / self.low) / libm::log10(self.high / self.low),
            Scale::Log => return None,
        };
        position.is_finite().then_some(position)
    }
}

/// Minimum and maximum of the positive values; 0.1 and 1 if there are none.
pub(crate) fn positive_range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let positive = values.filter(|v| *v > 0.0 && v.is_finite());
    let (low, high) =
        positive.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
    if low.is_finite() { (low, high) } else { (0.1, 1.0) }
}

/// Smallest 1, 2 or 5 times a power of ten that is at least `rough`.
fn tidy_step(rough: f64) -> f64 {
    let exponent = libm::floor(libm::log10(rough)) as i32;
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|digit| power_of_ten(digit, exponent))
        .find(|step| *step >= rough * (1.0 - 1e-9))
        .unwrap_or(rough)
}

/// Next digit times a power of ten below or above `value`.
fn tidy_log(value: f64, above: bool) -> f64 {
    let exponent = libm::floor(libm::log10(value)) as i32;
    let mut digits = (1..=10u8).map(|digit| power_of_ten(f64::from(digit), exponent));
    let next = if above { digits.find(|at| *at >= value) } else { digits.rfind(|at| *at <= value) };
    next.unwrap_or(value)
}

/// Value of `digit * 10^exponent`, exact whenever its decimal text is.
fn power_of_ten(digit: f64, exponent: i32) -> f64 {
    if exponent < 0 {
        digit / libm::exp10(f64::from(-exponent))
    } else {
        digit * libm::exp10(f64::from(exponent))
    }
}

fn decade_label(digit: u8, exponent: i32) -> String {
    match exponent {
        -4..0 => format!("{:.*}", exponent.unsigned_abs() as usize, power_of_ten(f64::from(digit), exponent)),
        0..=4 => format!("{:.0}", power_of_ten(f64::from(digit), exponent)),
        _ => format!("{digit}e{exponent}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks.iter().map(|tick| tick.text.clone()).filter(|text| !text.is_empty()).collect()
    }

    #[test]
    fn a_size_axis_has_every_minor_line_and_labels_decades_or_if_short_more() {
        let axis = Axis::log("Size (mm)", 0.063, 63.0);
        assert_eq!((axis.low, axis.high), (0.06, 70.0));
        assert_eq!(labels(&axis), ["0.1", "1", "10"]);
        // 0.06 to 0.09 (4), 0.1 to 0.9, 1 to 9, 10 to 70 (7)
        assert_eq!(axis.ticks.len(), 4 + 9 + 9 + 7);
        assert_eq!(labels(&Axis::log("Size (mm)", 0.11, 2.1)), ["0.1", "0.2", "0.5", "1", "2"]);
        assert_eq!(labels(&Axis::log("Size (mm)", 2.2, 5.1)), ["2", "3", "4", "5", "6"]);
    }

    #[test]
    fn linear_steps_are_tidy() {
        let axis = Axis::linear("x", 0.0, 354.0);
        assert_eq!((axis.low, axis.high), (0.0, 400.0));
        assert_eq!(Axis::linear("x", 0.0, 410.0).high, 450.0);
        assert_eq!(labels(&axis), ["0", "100", "200", "300", "400"]);
        assert_eq!(labels(&Axis::linear("x", 0.0, 0.11)), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10"]);
    }

    #[test]
    fn positions_run_from_zero_to_one_and_refuse_what_has_no_logarithm() {
        let axis = Axis::log("x", 0.1, 9.0);
        assert_eq!(axis.position(axis.low), Some(0.0));
        assert_eq!(axis.position(axis.high), Some(1.0));
        assert_eq!(axis.position(0.0), None);
        assert_eq!(Axis::percent("y").position(f64::NAN), None);
    }
}
