//! Cuts a grid into its tables: side by side, one below another, or one for each sample named by its
//! rows. Each part has its own headings and its own openings, and is read separately.

use super::across::says_depth;
use super::content::{begins_with_words, is_blank, is_data, is_text, is_value, percentage, whole_row};
use super::grid::{Grid, GridRow};
use super::heading::{Role, role, says_sample, words};
use super::layout::{Headings, Layout, SoilColumn, fields, find, headings, is_heading, says_soil};
use super::size::{Opening, goes_one_way, opening, positive_size};
use super::{across, roles};
use std::collections::HashMap;
use std::ops::Range;
use voidwalk_core::gradation::TableError;

/// Maximum number of tables in a sheet of soils, which has some tens, but may have many more columns.
const MOST_TABLES: usize = 10_000;

/// A part of a grid that holds one table.
pub(super) struct Block {
    pub(super) grid: Grid,
    pub(super) layout: Layout,
    /// Columns of the table in the file.
    pub(super) columns: Range<usize>,
    /// Name of the sample, if the rows give one.
    pub(super) sample: Option<String>,
}

impl Block {
    pub(super) fn line(&self) -> usize {
        self.grid.rows.get(self.layout.at).map_or(0, |row| row.line)
    }
}

pub(super) fn blocks(grid: Grid) -> Result<Vec<Block>, TableError> {
    if let Some(row) = grid.rows.iter().find(|row| row.open) {
        return Err(fields(&grid, row));
    }
    if let Some((grid, layout)) = across::find(&grid)? {
        return Ok(vec![Block { grid, layout, columns: 0..0, sample: None }]);
    }
    let width = grid.width();
    let place = grid.place();
    let regions = regions(&grid, width);
    bounded(&place, regions.len())?;
    let parts = if regions.len() > 1 { grid.columns(&regions) } else { vec![grid] };
    let several = parts.len() > 1;
    let mut blocks = Vec::new();
    for part in parts {
        let bands = bands(&part);
        bounded(&place, blocks.len() + bands.len())?;
        let bands = match bands.len() > 1 {
            true => bands.into_iter().map(|rows| part.with_rows(part.rows[rows].to_vec())).collect(),
            false => vec![part],
        };
        for band in bands {
            blocks.extend(side_by_side(band, several)?);
            bounded(&place, blocks.len())?;
        }
    }
    Ok(blocks)
}

/// True if a sheet seems to contain a table: headings of openings, or rows of numbers. A cover has few
/// numbers, and they follow words.
pub(super) fn has_table(grid: &Grid) -> bool {
    const LEAST_ROWS: usize = 2;
    const LEAST_VALUES: usize = 3;
    let values = |row: &GridRow| row.filled().filter(|&c| is_value(row.cell(c))).count();
    let is_row = |row: &&GridRow| is_data(row) && (!begins_with_words(row) || values(row) >= LEAST_VALUES);
    grid.rows.iter().any(is_heading) || grid.rows.iter().filter(is_row).take(LEAST_ROWS).count() == LEAST_ROWS
}

fn bounded(place: &str, tables: usize) -> Result<(), TableError> {
    if tables <= MOST_TABLES {
        return Ok(());
    }
    let is = format!("a sheet of more than {MOST_TABLES} tables");
    Err(TableError::Format { file: place.to_owned(), is })
}

fn is_size_heading(cell: &str) -> bool {
    cell.contains(char::is_alphabetic)
        && role(cell) == Role::Size
        && !is_value(cell)
        && opening(cell).is_none()
}

/// Runs of columns without an empty column, each with a heading of openings; each is returned with the
/// columns to its right.
fn regions(grid: &Grid, width: usize) -> Vec<Range<usize>> {
    let mut anchors = vec![false; width];
    let mut top = None;
    for (index, row) in grid.rows.iter().enumerate() {
        // Skips rows of numbers quickly: numbers are never headings.
        let sizes: Vec<usize> = row.filled().filter(|&c| is_size_heading(row.cell(c))).collect();
        let is_table =
            sizes.len() > 1 || sizes.len() == 1 && row.filled().any(|c| role(row.cell(c)).has_values());
        if is_table {
            top = top.or(Some(index));
            sizes.into_iter().for_each(|c| anchors[c] = true);
        }
    }
    let Some(top) = top else { return ranges(vec![0], width) };
    let mut filled = vec![false; width];
    for row in &grid.rows[top..] {
        row.filled().for_each(|c| filled[c] = true);
    }
    let mut starts = Vec::new();
    let mut column = 0;
    while column < width {
        let end = (column..width).find(|&c| !filled[c]).unwrap_or(width);
        if anchors[column..end].contains(&true) {
            starts.push(column);
        }
        column = end + 1;
    }
    match starts.first_mut() {
        Some(first) => *first = 0,
        None => starts.push(0),
    }
    ranges(starts, width)
}

/// Ranges that begin at `starts`, each up to the next, the last up to `end`.
fn ranges(starts: Vec<usize>, end: usize) -> Vec<Range<usize>> {
    let ends: Vec<usize> = starts.iter().skip(1).copied().chain([end]).collect();
    starts.into_iter().zip(ends).map(|(start, end)| start..end).collect()
}

/// Rows of each of the tables one below another, with the titles above it.
fn bands(grid: &Grid) -> Vec<Range<usize>> {
    let rows = &grid.rows;
    let (Some(Headings { at, first, .. }), Some(data)) = headings(grid) else {
        return ranges(vec![0], rows.len());
    };
    let is_next = |r: &usize| {
        is_heading(&rows[*r])
            && (says_soil(&rows[*r]) || rows.get(r + 1).is_some_and(is_data))
            && rows[r + 1..].iter().take(4).any(is_data)
    };
    let later: Vec<usize> = (data.max(first)..rows.len()).filter(is_next).collect();
    let (mut starts, mut at) = (vec![0], at);
    for Range { start: next, end } in ranges(later, rows.len()) {
        if !goes_on(&rows[at..next], &rows[next], &rows[next + 1..end]) {
            starts.push(title_above(&rows[..next], at + 1));
            at = next;
        }
    }
    ranges(starts, rows.len())
}

/// Index of the first row of a title above the end of `rows`; titles above `least` are ignored.
fn title_above(rows: &[GridRow], least: usize) -> usize {
    let next = rows.len();
    let is_title = |r: usize| {
        (!is_data(&rows[r]) || begins_with_words(&rows[r])) && whole_row(&rows[r], false).is_none()
    };
    let above = (least..next).rev().take_while(|&r| is_title(r)).last().unwrap_or(next);
    // Rows directly below the numbers belong to them, up to the first empty row.
    let gap = |r: &usize| rows[*r].line > rows[r - 1].line + 1;
    match (above.max(1)..next).find(gap) {
        Some(after) => after,
        // Without a gap, the last row is a title if it has a single cell.
        None if above < next && rows[next - 1].filled().count() == 1 => next - 1,
        None => next,
    }
}

/// True if the headings repeat and the numbers below continue those above: it is one table.
fn goes_on(above: &[GridRow], next: &GridRow, below: &[GridRow]) -> bool {
    let head = &above[0];
    let roles = |row: &GridRow| -> Vec<(usize, Role)> {
        let role = |c| (c, role(row.cell(c)));
        row.filled().map(role).filter(|(_, role)| *role != Role::Other).collect()
    };
    let of_head = roles(head);
    let sizes: Vec<usize> = of_head.iter().filter(|(_, role)| *role == Role::Size).map(|(c, _)| *c).collect();
    let others = || of_head.iter().filter(|(_, role)| *role != Role::Size);
    let is_same = of_head == roles(next) && is_text(next);
    let (Some(&size), true) = (sizes.first(), is_same) else { return false };
    let numbers = |row: &GridRow| {
        let opening = sizes.iter().find_map(|&c| match opening(row.cell(c)) {
            Some((Opening::Mm(mm) | Opening::Bare(mm), _)) if c == size => Some(mm),
            Some((Opening::Pan | Opening::Total, _)) => Some(-1.0),
            _ => None,
        });
        let value = others().find_map(|(c, _)| percentage(row.cell(*c)));
        opening.zip(value.or(Some(0.0)))
    };
    let of_above: Vec<(f64, f64)> = above.iter().filter_map(numbers).collect();
    let (Some(&first), Some(&last)) = (of_above.first(), of_above.last()) else { return false };
    let Some(after) = below.iter().find_map(numbers) else { return true };
    let is_finer = others().all(|(_, role)| *role == Role::Finer);
    let (falls, rises) = (last.0 <= first.0 && after.0 < last.0, last.0 >= first.0 && after.0 > last.0);
    last.0 >= 0.0 && (falls && (!is_finer || after.1 <= last.1) || rises && (!is_finer || after.1 >= last.1))
}

/// Splits a band into tables: one, or several without an empty column between, each led by its openings.
fn side_by_side(band: Grid, several: bool) -> Result<Vec<Block>, TableError> {
    let (groups, line) = match headings(&band) {
        (Some(headings), _) => (groups(&band, &headings)?, Some(band.rows[headings.at].line)),
        (None, _) => (Vec::new(), None),
    };
    bounded(&band.place(), groups.len())?;
    let parts = if groups.len() > 1 { band.columns(&groups) } else { vec![band] };
    let several = several || parts.len() > 1;
    let mut blocks = Vec::new();
    for grid in parts {
        if let Some(line) = line {
            refuse_other_headings(&grid, line)?;
        }
        let layout = find(&grid)?;
        if several {
            refuse_far_values(&grid, &layout)?;
        }
        let columns = grid.left..grid.left + grid.width();
        let parts = by_sample(&grid, &layout)?;
        if parts.is_empty() {
            blocks.push(Block { grid, layout, columns, sample: None });
            continue;
        }
        bounded(&grid.place(), parts.len())?;
        for (name, grid) in parts {
            let layout = find(&grid)?;
            blocks.push(Block { grid, layout, columns: columns.clone(), sample: Some(name) });
        }
    }
    Ok(blocks)
}

fn groups(grid: &Grid, headings: &Headings) -> Result<Vec<Range<usize>>, TableError> {
    let Headings { at, first, roles, .. } = headings;
    let rows = &grid.rows[*first..];
    let heading = &grid.rows[*at];
    let refused =
        |c: usize, allowed: &str| grid.refused(heading.line, c, "heading", heading.cell(c), allowed);
    let mut holds = vec![(false, false); roles.len()];
    for row in rows {
        for c in row.filled().take_while(|&c| c < roles.len()) {
            let (values, openings) = &mut holds[c];
            *values |= is_value(row.cell(c));
            *openings |= matches!(opening(row.cell(c)), Some((Opening::Mm(_) | Opening::Bare(_), _)));
        }
    }
    let named = roles.iter().any(|role| role.has_values());
    // `Some(true)` for openings, `Some(false)` for values, `None` for anything else.
    let kind = |c: usize| match roles[c] {
        Role::Size if holds[c].1 => Some(true),
        Role::Finer | Role::Retained(_) if holds[c].0 => Some(false),
        Role::Other if !named && holds[c].0 => Some(false),
        _ => None,
    };
    let kinds: Vec<(usize, bool)> = (0..roles.len()).filter_map(|c| Some((c, kind(c)?))).collect();
    let (Some(&(_, begins)), Some(&(_, ends))) = (kinds.first(), kinds.last()) else { return Ok(Vec::new()) };
    // In all of the tables, the values may be to the left of their openings.
    let swapped = !begins && ends;
    let mut starts = vec![0];
    for pair in kinds.windows(2) {
        if pair[0].1 == swapped && pair[1].1 != swapped {
            starts.push(pair[1].0);
        }
    }
    if !begins && !ends && starts.len() > 1 {
        let allowed = "openings to the left of the values, or to the right of them, in all of the tables \
                       that stand side by side";
        return Err(refused(kinds[0].0, allowed));
    }
    let mut groups: Vec<Range<usize>> = Vec::new();
    // First openings of the last group; true if all of its values are retained.
    let (mut openings_before, mut retained_before) = (None, false);
    let mut rest = &kinds[..];
    for Range { start, end } in ranges(starts, grid.width()) {
        let (group, after) = rest.split_at(rest.partition_point(|(c, _)| *c < end));
        rest = after;
        let openings = group.iter().find(|(_, size)| *size).map(|(c, _)| *c);
        let values = || group.iter().filter(|(_, size)| !size).map(|(c, _)| roles[*c]);
        let (some, all_finer) = (values().next().is_some(), values().all(|role| role == Role::Finer));
        let agrees = || match (openings_before, openings) {
            (Some(a), Some(b)) => roles::agree(grid, headings, a, b),
            _ => false,
        };
        match groups.last_mut() {
            // The openings repeat after the percents, or the table repeats with more columns.
            Some(last) if !some && agrees() || some && all_finer && retained_before && agrees() => {
                last.end = end;
            }
            Some(_) if !some => {
                let allowed = "percents to the right of these openings, as they differ from those before";
                return Err(refused(openings.unwrap_or(start), allowed));
            }
            _ => {
                groups.push(start..end);
                openings_before = openings;
                retained_before = some && values().all(|role| matches!(role, Role::Retained(_)));
            }
        }
    }
    Ok(groups)
}

/// Refuses values after an empty column if they could belong to several adjacent tables.
fn refuse_far_values(grid: &Grid, layout: &Layout) -> Result<(), TableError> {
    let mut filled = vec![false; layout.soils.last().map_or(0, |last| last.column + 1)];
    for row in &grid.rows[layout.at..] {
        for (is_filled, cell) in filled.iter_mut().zip(&row.cells) {
            *is_filled |= !cell.is_empty();
        }
    }
    for pair in layout.soils.windows(2) {
        if (pair[0].column + 1..pair[1].column).any(|c| !filled[c]) {
            let SoilColumn { column, heading, .. } = &pair[1];
            let allowed = "openings of its own to its left, as the other tables have: an empty column \
                           parts it from those of the table before it";
            return Err(grid.refused(grid.rows[layout.at].line, *column, "heading", heading, allowed));
        }
    }
    Ok(())
}

/// Refuses headings of a table among the rows of another, below that table's headings.
fn refuse_other_headings(grid: &Grid, line: usize) -> Result<(), TableError> {
    for row in grid.rows.iter().filter(|row| row.line > line && !is_text(row)) {
        let Some(size) = row.filled().find(|&c| is_size_heading(row.cell(c))) else { continue };
        let mut right = row.filled().filter(|&c| c > size).take(3);
        if right.any(|c| !is_value(row.cell(c)) && role(row.cell(c)).has_values()) {
            let allowed = "a table whose headings are in one row with those of the tables beside it, or \
                           below the numbers of the one above it";
            return Err(grid.refused(row.line, size, "heading", row.cell(size), allowed));
        }
    }
    Ok(())
}

/// Maximum number of cells in the headings of all parts.
const MOST_PLACES: usize = 1_000_000;

/// Splits a table whose rows name their samples into parts with these names; empty for fewer than two names.
fn by_sample(grid: &Grid, layout: &Layout) -> Result<Vec<(String, Grid)>, TableError> {
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
    // A name merged over several rows is in the first of them.
    let mut last: Vec<String> = vec![String::new(); width];
    let mut rows: Vec<(String, String, &GridRow)> = Vec::new();
    for row in grid.rows[layout.first..].iter().filter(|row| opening(row.cell(layout.size)).is_some()) {
        for &c in samples.iter().chain(&depths).filter(|&&c| !is_blank(row.cell(c))) {
            row.cell(c).clone_into(&mut last[c]);
        }
        let joined = |columns: &[usize]| {
            let cells = columns.iter().map(|&c| last[c].as_str()).filter(|c| !c.is_empty());
            cells.collect::<Vec<_>>().join(" ")
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
    let sizes = rows.iter().filter_map(|row| positive_size(row.2.cell(layout.size)));
    if of_fractions && goes_one_way(&sizes.collect::<Vec<_>>()) {
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
        (name.trim().to_owned(), grid.with_rows(headings.to_vec()))
    };
    let mut parts: Vec<(String, Grid)> = keys.iter().map(part).collect();
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
        // Rows between the rows of samples belong to the sample above them.
        parts[last].1.rows.push(row);
    }
    Ok(parts)
}

/// True if the names below a heading may be those of the fractions of one soil.
fn may_be_of_fractions(heading: &str) -> bool {
    words(heading).iter().any(|word| ["material", "soil", "name", "source"].contains(&word.as_str()))
}
