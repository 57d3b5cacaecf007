//! Splits a table that names the sample in each row into a table for each sample.

use std::collections::HashMap;

use super::content::is_blank;
use super::grid::{Grid, GridRow};
use super::heading::{Role, role, says_sample, words};
use super::labels::says_depth;
use super::layout::Layout;
use super::size::{Opening, opening};
use voidwalk_core::gradation::TableError;

/// Most places of the headings of all parts.
const MOST_PLACES: usize = 1_000_000;

/// Part of a table that belongs to one sample, with the sample's name.
pub(super) struct Part {
    pub(super) name: String,
    pub(super) grid: Grid,
}

/// Parts of a table whose rows name their samples; empty for fewer than two names.
///
/// # Errors
/// Rows that each name another sample, as with openings in the headings.
pub(super) fn parts(grid: &Grid, layout: &Layout) -> Result<Vec<Part>, TableError> {
    let headings = &grid.rows[layout.at..layout.first];
    if !layout.headed || layout.soils.len() != 1 {
        return Ok(Vec::new());
    }
    let value = layout.soils[0].column;
    let width = headings.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let is_free = |c: usize| c != value && c != layout.size && layout.other_size != Some(c);
    let heads =
        |c: usize| headings.iter().map(move |row| row.cell(c)).filter(|cell| role(cell) == Role::Other);
    let of_samples =
        |c: usize| heads(c).any(|cell| says_sample(cell) || words(cell).iter().any(|w| w == "hole"));
    let of_depths = |c: usize| heads(c).any(|cell| words(cell).iter().any(|word| says_depth(word)));
    let samples: Vec<usize> = (0..width).filter(|&c| is_free(c) && of_samples(c)).collect();
    let depths: Vec<usize> =
        (0..width).filter(|&c| is_free(c) && !samples.contains(&c) && of_depths(c)).collect();
    // A name that is merged over rows lies in the first of them.
    let mut last: Vec<String> = vec![String::new(); width];
    let mut rows: Vec<(String, String, &GridRow)> = Vec::new();
    for row in grid.rows[layout.first..].iter().filter(|row| opening(row.cell(layout.size)).is_some()) {
        for &c in samples.iter().chain(&depths).filter(|&&c| !is_blank(row.cell(c))) {
            row.cell(c).clone_into(&mut last[c]);
        }
        let joined = |columns: &[usize]| {
            let cells: Vec<&str> =
                columns.iter().map(|&c| last[c].as_str()).filter(|c| !c.is_empty()).collect();
            cells.join(" ")
        };
        rows.push((joined(&samples), joined(&depths), row));
    }
    // `Cu | 5` below the table names no sample.
    let mut places: HashMap<(&str, &str), usize> = HashMap::new();
    let mut keys: Vec<(&str, &str)> = Vec::new();
    for (sample, depth, _) in rows.iter().filter(|row| !is_blank(row.2.cell(value))) {
        places.entry((sample, depth)).or_insert_with(|| {
            keys.push((sample, depth));
            keys.len() - 1
        });
    }
    if samples.is_empty() || keys.len() < 2 {
        return Ok(Vec::new());
    }
    let of_fractions = samples.iter().all(|&c| heads(c).any(may_be_of_fractions));
    if keys.len() == rows.len() && !of_fractions {
        let allowed = "a row for each opening of a sample, or openings in the headings above a row for each \
                       sample";
        return Err(grid.refused(rows[0].2.line, samples[0], "row", keys[0].0, allowed));
    }
    if of_fractions && goes_one_way(rows.iter().map(|row| row.2.cell(layout.size))) {
        return Ok(Vec::new());
    }
    if keys.len().saturating_mul(width) > MOST_PLACES {
        let is = format!("a table of {} samples in {width} columns", keys.len());
        return Err(TableError::Format { file: grid.place(), is });
    }
    let mut times: HashMap<&str, usize> = HashMap::new();
    keys.iter().for_each(|key| *times.entry(key.0).or_default() += 1);
    let part = |key: &(&str, &str)| {
        let name = if times[key.0] > 1 { format!("{} {}", key.0, key.1) } else { key.0.to_owned() };
        Part { name: name.trim().to_owned(), grid: grid.band(layout.at..layout.first) }
    };
    let mut parts: Vec<Part> = keys.iter().map(part).collect();
    let mut named = rows.iter().peekable();
    let mut last = 0;
    for row in &grid.rows[layout.first..] {
        let mut row = row.clone();
        if let Some((sample, depth, _)) = named.next_if(|named| named.2.line == row.line)
            && let Some(&place) = places.get(&(sample.as_str(), depth.as_str()))
        {
            last = place;
            for &c in samples.iter().chain(&depths) {
                if let Some(cell) = row.cells.get_mut(c) {
                    cell.clear();
                }
            }
        }
        // Rows between the rows of samples go with the sample above them.
        parts[last].grid.rows.push(row);
    }
    Ok(parts)
}

/// True if a heading of names may name the fractions of one soil.
fn may_be_of_fractions(heading: &str) -> bool {
    words(heading).iter().any(|word| ["material", "soil", "name", "source"].contains(&word.as_str()))
}

/// True if openings only rise or only fall, like those of one soil.
fn goes_one_way<'a>(cells: impl Iterator<Item = &'a str>) -> bool {
    let sizes: Vec<f64> = cells
        .filter_map(|cell| match opening(cell)?.0 {
            Opening::Mm(size) | Opening::Bare(size) if size > 0.0 => Some(size),
            _ => None,
        })
        .collect();
    sizes.windows(2).all(|w| w[0] > w[1]) || sizes.windows(2).all(|w| w[0] < w[1])
}
