//! Page and figures of a percolation study.

use std::path::Path;

use maud::{Markup, Render, html};

use super::figures::{Across, Axis, BLUE, Dash, Figure, GREY, Mark, PURPLE, Shape, Tick};
use super::files::{ReportError, json};
use super::section::{Sections, Written};
use super::shell::Drawn;
use super::table::Table;
use crate::outcome::percolation::{NU_PARALLEL, PercolationStudy, SizeThreshold, Z};
use crate::outcome::record::Statistic;
use crate::outcome::table::Columns;
use voidwalk_practice::quantity::{duration, significant, whole};

/// Writes `report.html` and its figures into the folder of a percolation study, from its `percolation.json`.
pub(crate) fn write_percolation(folder: &Path) -> Result<Written, ReportError> {
    let study: &PercolationStudy = &json(&folder.join("percolation.json"))?;
    let title = "Percolation threshold of the directed cubic lattice";
    let what = html! { p {
        "Constrictions of an L × L × L lattice (or one of three lengths), periodic sideways, opened one by \
         one at random until a path leads from the start layer out of the last: the share that is then \
         open. " (whole(study.realisations)) " realisations of each size, seed " (study.seed)
        ", each threshold exact."
    } };
    // Without a cube there is no size to plot against.
    let draw: &[fn(&PercolationStudy) -> Drawn] =
        if study.sizes.is_empty() { &[] } else { &[percolation_spread, threshold] };
    let footer = html! { p.small { "voidwalk " (study.version) ", " (duration(study.seconds)) "." } };
    Sections::new(title, title, &html! {})
        .words(&what)
        .words(&sizes(study))
        .words(&fits(study))
        .figures(draw.iter().map(|draw| draw(study)))
        .write(folder, "report.html", &footer)
}

fn sizes(study: &PercolationStudy) -> Markup {
    let digits = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.5}"));
    let ends = |statistic: &Statistic| format!("{} to {}", digits(statistic.low), digits(statistic.high));
    let rows: Vec<(String, &Statistic, Option<f64>)> = study.lattices().collect();
    let columns = Columns::default()
        .number("size", "L", |row: &(String, &Statistic, _)| row.0.replace('x', " × "))
        .number("mean", "Mean threshold", |row| digits(Some(row.1.mean)))
        .number("interval", "95 % interval of the mean", |row| ends(row.1))
        .number("sd", "Standard deviation", |row| digits(row.1.sd))
        .number("sd_error", "its standard error", |row| digits(row.2));
    Table::new(&rows, columns).render()
}

fn fits(study: &PercolationStudy) -> Markup {
    let quality = |chi_squared, degrees| {
        html! { ", χ² = " (significant(chi_squared)) " on " (degrees) " degrees of freedom" }
    };
    html! {
        @if let Some(fit) = &study.one_length {
            p { "Threshold of the infinite lattice; the known value is " (study.infinite_lattice) ":" }
            ul {
                li {
                    "One length, p(L) = p − a L" sup { "−1/ν" } " with ν = " (NU_PARALLEL) ": "
                    (format!("{:.5} ± {:.5}", fit.threshold, fit.threshold_error))
                    (quality(fit.chi_squared, fit.degrees))
                }
                @if let Some(fit) = &study.many_starts { li {
                    "Many starts, L d" sup { "ν" } " = b + c ln(L d" sup { "ν/z" }
                    ") with d = p − p(L), z = " (Z) ": " (format!("{:.5}", fit.threshold))
                    (format!(" ({:.5} to {:.5}, 68 %)", fit.threshold_low, fit.threshold_high))
                    (quality(fit.chi_squared, fit.degrees))
                } }
                @if let Some(slope) = study.sd_exponent { li {
                    "The standard deviation falls as L" sup { (format!("{slope:.2}")) } " over all sizes."
                } }
            }
            p.small {
                "If χ² far exceeds the degrees of freedom, the relation does not describe these sizes, and \
                 its error means nothing."
            }
        }
    }
}

/// Standard deviation of the threshold against the size of the lattice: Fig. 6 of the paper.
fn percolation_spread(study: &PercolationStudy) -> Drawn {
    let sd = |size: &SizeThreshold| size.threshold.sd.unwrap_or(0.0);
    let ends = |size: &SizeThreshold| {
        let half = 1.96 * size.sd_error.unwrap_or(0.0);
        (sd(size) - half, sd(size) + half)
    };
    let rows: Vec<&SizeThreshold> = study.sizes.iter().filter(|size| size.threshold.sd.is_some()).collect();
    let widest = rows.iter().map(|size| size.size as f64).fold(1.0, f64::max);
    let lowest = rows.iter().map(|size| ends(size).0).fold(0.0, f64::min);
    let highest = rows.iter().map(|size| ends(size).1).fold(0.001, f64::max);
    let x = Axis::linear("Size of the lattice, L (voids along each side)", 0.0, widest);
    let y = Axis::linear("Standard deviation of the threshold (–)", lowest, highest);
    let what = "Standard deviation of the percolation threshold against the size of the lattice";
    let mut figure = Figure::new("Scatter of the percolation threshold", what, x, y);
    figure.add(Mark::line(rows.iter().map(|size| (size.size as f64, sd(size))).collect(), BLUE).width(1.5));
    for size in rows {
        let point = Mark::point(size.size as f64, sd(size), BLUE, Shape::Circle);
        figure.add(point.y_interval(Some(ends(size))));
    }
    let caption = "Standard deviation of the percolation threshold over the realisations, as in Fig. 6 of \
                   the paper. Bars: 95 % intervals, for normal thresholds.";
    Drawn::new("percolation-sd", figure, caption)
}

/// Mean threshold against `L^(-1/nu)`, where a power law is a straight line.
fn threshold(study: &PercolationStudy) -> Drawn {
    let at = |size: f64| libm::pow(size, -1.0 / NU_PARALLEL);
    let widest = study.sizes.iter().map(|s| at(s.size as f64)).fold(0.0, f64::max);
    let means = || study.sizes.iter().map(|s| s.threshold.mean);
    let lowest = means().fold(study.infinite_lattice, f64::min);
    let highest = means().fold(study.infinite_lattice, f64::max);
    let room = 0.1 * (highest - lowest).max(0.001);
    let mut x = Axis::linear(
        "L, spaced as L to the power of −1/ν∥; the infinite lattice is at the left",
        0.0,
        widest,
    );
    let sizes = study.sizes.iter().map(|s| Tick::new(at(s.size as f64), s.size.to_string()));
    x = x.with_ticks(std::iter::once(Tick::new(0.0, "∞")).chain(sizes).collect());
    let y = Axis::linear("Mean threshold (–)", lowest - room, highest + room);
    let what = "Mean percolation threshold against the size of the lattice, with the fitted relations";
    let mut figure = Figure::new("Percolation threshold against size", what, x, y);
    let known = format!("known, {}", study.infinite_lattice);
    figure.add(Mark::rule(Across::Y, study.infinite_lattice, GREY).dash(Dash::Dashed).label(&known));
    if let Some(fit) = &study.one_length {
        let ends = [0.0, widest].map(|x| (x, fit.threshold - fit.amplitude * x));
        figure.add(Mark::line(ends.to_vec(), BLUE).label("one length"));
    }
    if let Some(fit) = &study.many_starts {
        // Fixed-point iteration for d, which gives L: y = b + c ln(L d^(nu / z)) with y = L d^nu; it
        // contracts.
        let least = means().map(|mean| fit.threshold - mean).fold(f64::MAX, f64::min);
        let most = means().map(|mean| fit.threshold - mean).fold(0.0, f64::max);
        let size = |d: f64| {
            (0..200).fold(1.0 / d, |size, _| {
                let starts = libm::log(size * libm::pow(d, NU_PARALLEL / Z));
                ((fit.offset + fit.slope * starts) / libm::pow(d, NU_PARALLEL)).max(1.0)
            })
        };
        let at_step = |i: u32| {
            let d = least * libm::pow(most / least, f64::from(i) / 60.0);
            (at(size(d)), fit.threshold - d)
        };
        let curve = (0..=60).map(at_step).collect();
        figure.add(Mark::line(curve, PURPLE).dash(Dash::Dashed).label("many starts"));
    }
    for size in &study.sizes {
        let bar = size.threshold.low.zip(size.threshold.high);
        figure
            .add(Mark::point(at(size.size as f64), size.threshold.mean, BLUE, Shape::Circle).y_interval(bar));
    }
    let caption = "Mean threshold of each size, and the two relations fitted to them. Bars: 95 % intervals \
                   of the mean.";
    Drawn::new("percolation-threshold", figure, caption)
}
