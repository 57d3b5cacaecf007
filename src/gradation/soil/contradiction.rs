//! Percents retained beside the column that is read, which say the same or are refused.

use std::collections::HashMap;

use super::content::percentage;
use super::extent::Extent;
use super::grid::{Grid, GridRow};
use super::heading::{Role, role, says_of_fines};
use super::layout::{Layout, head};
use super::size::{Opening, opening};
use super::table::Soil;
use crate::gradation::error::TableError;
use crate::gradation::sieve::FIELDS;

/// Percents that were rounded to whole ones differ by less than this.
const ROUNDED: f64 = 1.5;

/// Refuses a column of percents retained that agrees with none of the soils.
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
        if !matches!(role(&heading), Role::Retained(r) if r.percent) || says_of_fines(&heading) {
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
        let differing: Vec<Option<usize>> = read.iter().map(|soil| differs(soil, &values, &pans)).collect();
        if let Some(Some(line)) = differing.first().filter(|_| differing.iter().all(Option::is_some)) {
            let allowed = format!(
                "percents retained that agree with those in {}, or one of the two columns alone",
                grid.column_said(layout.soils[0].column)
            );
            let value = values.get(line).map_or(String::new(), f64::to_string);
            return Err(grid.refused(*line, column, FIELDS[1], &value, allowed));
        }
    }
    Ok(())
}

/// The first line in which percents retained, on each sieve or cumulative, are not what the curve leaves.
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
    // What was washed out is a part of the pan.
    let of_pans: Vec<f64> = pans.iter().filter_map(|line| Some(factor * retained.get(line)?)).collect();
    let rest = pans.first().copied().filter(|_| {
        let finest = rows.last().filter(|row| !pans.contains(&row.line) && !of_pans.is_empty());
        finest.is_some_and(|finest| (of_pans.iter().sum::<f64>() - finest.percent).abs() > ROUNDED)
    });
    cumulative.and(single.or(rest))
}
