//! Check of a retained column, in percent or by mass, beside the column that is read: a contradiction is
//! refused.

use std::collections::HashMap;

use super::content::percentage;
use super::extent::Extent;
use super::grid::{Grid, GridRow};
use super::heading::{Role, role, says_of_fines};
use super::layout::{Layout, head};
use super::size::{Opening, opening};
use super::table::Soil;
use voidwalk_core::gradation::FIELDS;
use voidwalk_core::gradation::TableError;

/// Percents that were rounded to whole ones differ by less than this.
const ROUNDED: f64 = 1.5;

/// Refuses a retained column that agrees with no soil.
pub(super) fn refuse(
    grid: &Grid,
    layout: &Layout,
    extent: &Extent,
    soils: &[Result<Soil, TableError>],
) -> Result<(), TableError> {
    let read: Vec<&Soil> = soils.iter().filter_map(|soil| soil.as_ref().ok()).collect();
    if grid.across.is_some() || !layout.headed || read.len() < soils.len() {
        return Ok(());
    }
    let width = extent.rows(grid, layout).map(|row| row.cells.len()).max().unwrap_or(0);
    for column in (0..width).filter(|&c| layout.soils.iter().all(|soil| soil.column != c)) {
        let heading = head(&grid.rows[layout.at..layout.first], column);
        let Role::Retained(retained) = role(&heading) else { continue };
        if says_of_fines(&heading) {
            continue;
        }
        let values: HashMap<usize, f64> = extent
            .rows(grid, layout)
            .filter_map(|row| Some((row.line, percentage(row.cell(column))?)))
            .collect();
        let is_pan = |row: &&GridRow| {
            let size = opening(row.cell(extent.column_of_size(layout, row)));
            matches!(size, Some((Opening::Pan | Opening::Below(_), _)))
        };
        let pans: Vec<usize> = extent.rows(grid, layout).filter(is_pan).map(|row| row.line).collect();
        let percents = |soil: &&Soil| differs(soil, &values, &pans);
        let masses = |soil: &&Soil| masses_differ(soil, &values, &pans);
        let differing: Vec<Option<usize>> = match retained.percent {
            true => read.iter().map(percents).collect(),
            false => read.iter().map(masses).collect(),
        };
        if let Some(Some(line)) = differing.first().filter(|_| differing.iter().all(Option::is_some)) {
            let allowed = format!(
                "{} retained that agree with the percents in {}, or one of the two columns alone",
                if retained.percent { "percents" } else { "masses" },
                grid.column_label(layout.soils[0].column)
            );
            let value = values.get(line).map_or(String::new(), f64::to_string);
            return Err(grid.refused(*line, column, FIELDS[1], &value, allowed));
        }
    }
    Ok(())
}

/// The first line in which masses with a pan, on each sieve or cumulative, differ from the curve.
fn masses_differ(soil: &Soil, masses: &HashMap<usize, f64>, pans: &[usize]) -> Option<usize> {
    let mut rows: Vec<_> = soil.rows.iter().filter(|row| masses.contains_key(&row.line)).collect();
    rows.sort_by(|a, b| b.size.total_cmp(&a.size));
    let of_pans: Vec<f64> = pans.iter().filter_map(|line| masses.get(line).copied()).collect();
    let finest =
        rows.last().filter(|row| !of_pans.is_empty() && rows.len() > 1 && !pans.contains(&row.line))?;
    let on_sieves: f64 = rows.iter().map(|row| masses[&row.line]).sum();
    let most = masses.values().fold(0.0, |most: f64, &mass| most.max(mass));
    let coarser = 1.0 - finest.percent / 100.0;
    let pan = of_pans.iter().sum::<f64>();
    // Mass washed out may be in the percents and not in the pan.
    let whole = [on_sieves + pan, most, on_sieves / coarser, masses[&finest.line] / coarser];
    let line_of = |(at, &whole): (usize, &f64)| {
        let mut sum = 0.0;
        let is_possible = whole.is_finite() && whole >= if at % 2 == 1 { most } else { on_sieves + pan };
        rows.iter().find_map(|row| {
            let mass = masses[&row.line];
            sum = if at % 2 == 1 { mass } else { sum + mass };
            let is_other = (100.0 * sum / whole - (100.0 - row.percent)).abs() > ROUNDED;
            (is_other || !is_possible).then_some(row.line)
        })
    };
    let lines: Vec<usize> = whole.iter().enumerate().map_while(line_of).collect();
    lines.first().copied().filter(|_| lines.len() == whole.len())
}

/// The first line in which percents retained, on each sieve or cumulative, differ from the curve.
fn differs(soil: &Soil, retained: &HashMap<usize, f64>, pans: &[usize]) -> Option<usize> {
    let mut rows: Vec<_> = soil.rows.iter().filter(|row| retained.contains_key(&row.line)).collect();
    rows.sort_by(|a, b| b.size.total_cmp(&a.size));
    let is_fraction = rows.len() > 1 && rows.iter().all(|row| retained[&row.line] <= 1.0);
    let factor = if is_fraction { 100.0 } else { 1.0 };
    let value = |line: usize| factor * retained[&line];
    let cumulative = rows.iter().find(|row| (value(row.line) - (100.0 - row.percent)).abs() > ROUNDED);
    let mut sum = 0.0;
    let single = rows.iter().find(|row| {
        sum += value(row.line);
        (sum - (100.0 - row.percent)).abs() > ROUNDED
    });
    let single = single.map(|row| row.line);
    // Mass washed out is a part of the pan.
    let of_pans: Vec<f64> = pans.iter().filter_map(|line| Some(factor * retained.get(line)?)).collect();
    let rest = pans.first().copied().filter(|_| {
        let finest = rows.last().filter(|row| !pans.contains(&row.line) && !of_pans.is_empty());
        finest.is_some_and(|finest| (of_pans.iter().sum::<f64>() - finest.percent).abs() > ROUNDED)
    });
    cumulative.and(single.or(rest))
}
