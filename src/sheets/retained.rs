//! Retained values, by mass or in percent: converted to percents finer, or compared with those that are read.

use super::content::{is_words, percentage};
use super::extent::{Below, Extent, Reading};
use super::grid::GridRow;
use super::heading::{Retained, Role, role, says_of_fines, words};
use super::languages::Words;
use super::layout::head;
use super::size::{Entry, Opening, is_washed, opening};
use super::soil::Soil;
use std::collections::HashMap;
use voidwalk_core::gradation::{FIELDS, Row, TableError};

/// Tolerance within which separately weighed percents sum to 100.
const ROUNDED: f64 = 0.6;

/// Percent below which retained values may be grams if their heading does not say percent.
const NEARLY_ALL: f64 = 95.0;

pub(super) fn says_percent(heading: &str) -> bool {
    let small = heading.to_lowercase();
    ["%", "percent", "pct", "prozent"].iter().any(|word| small.contains(word))
}

/// True if a heading says that its values are fractions of 1.
pub(super) fn says_fraction(heading: &str) -> bool {
    let small = heading.to_lowercase();
    small.contains("fraction") || small.contains("ratio")
}

/// Converts fractions of 1 to percents if the heading calls them fractions.
pub(super) fn scale_fractions(
    reading: &mut Reading,
    retained: Retained,
    entries: &mut [Entry],
) -> Result<(), TableError> {
    let is_broken = |entry: &&Entry| entry.value > 0.0 && entry.value < 1.0;
    let (true, Some(broken)) = (retained.percent, entries.iter().find(is_broken)) else {
        return Ok(());
    };
    if entries.iter().any(|entry| entry.value > 1.0) {
        return Ok(());
    }
    let heading = &reading.column.heading;
    if !says_fraction(heading) || says_percent(heading) {
        let allowed = "percents up to 100, with the pan; these look like fractions from 0 to 1: write \
                       percents, or `fraction` in the heading";
        return Err(reading.refused_value(broken.line, broken.value, allowed));
    }
    reading.notes.push("values from 0 to 1 read as fractions: 1 is 100 %".into());
    entries.iter_mut().for_each(|entry| entry.value = tidy(100.0 * entry.value));
    Ok(())
}

/// Refuses values without a pan that end far below 100 under a plain `Retained`: they may be grams.
fn refuse_unsaid(reading: &Reading, line: usize, end: f64) -> Result<(), TableError> {
    let is_stated = |cell: &str| says_percent(cell) || says_fraction(cell);
    let any_cell = || reading.grid.rows.iter().any(|row| is_stated(row.cell(reading.column.column)));
    let is_retained = matches!(role(&reading.column.heading), Role::Retained(_));
    if end >= NEARLY_ALL || !is_retained || any_cell() {
        return Ok(());
    }
    let allowed = "% or g in the heading, or what is retained in the pan: these may be percents or grams";
    Err(reading.refused_value(line, end, allowed))
}

/// Checks stated masses. Mass washed out or lost is a part of the whole; a mass above, beside or
/// below the table that differs from the mass of all rows is refused or noted.
fn check_stated(reading: &mut Reading, percent: bool, whole: f64) -> Result<(), TableError> {
    static LOST: Words =
        Words::of("wash|washed|washing|loss|losses|lost|fines|minus|through|decanted|silt|clay");
    static MASS: Words = Words::of("mass|weight|masse|gewicht|wt");
    static ALL: Words = Words::of("total|initial|dry|sample|specimen|start|original|before");
    static TARE: Words = Words::of("tare|container|dish|can|pan|wet|with");
    static PART: Words =
        Words::of("after|washed|retained|water|sieve|unit|density|subsample|passing|fines|minimum|required");
    let &mut Reading { extent, grid, column, .. } = reading;
    let column = column.column;
    for row in extent.below.iter().chain(&stated(extent)) {
        let Some((first, value)) = row.value else { continue };
        let of_row = words(&row.words);
        let is_below = extent.below.iter().any(|below| below.line == row.line);
        if is_below && value > 0.0 && LOST.any(&of_row) {
            let allowed = "the pan as the last row of what is retained, with all that was washed out or \
                           lost: it is a part of the whole";
            return Err(grid.refused(row.line, row.column, FIELDS[0], &row.words, allowed));
        }
        // A row of masses has one for each column of masses after its words.
        let of_soil = grid.rows.iter().find(|other| row.column < column && other.line == row.line);
        let in_column = of_soil.and_then(|row| percentage(row.cell(column)));
        let (place, value) = in_column.map_or((first, value), |value| (column, value));
        let is_all = ALL.any(&of_row) && !TARE.any(&of_row) && !PART.any(&of_row);
        let is_near = |value: f64| (value - whole).abs() <= 0.01 * whole;
        let is_same = [value, 1000.0 * value, value / 1000.0].into_iter().any(is_near);
        let has = |name: &str| of_row.iter().any(|word| word == name);
        let is_mass = MASS.any(&of_row) || is_below && has("total");
        let is_a_part = !is_all && (value < whole || !is_below);
        if percent || value <= 0.0 || !is_mass || is_same || is_a_part {
            continue;
        }
        let sum = tidy(whole);
        if has("dry") && !TARE.any(&of_row) {
            let allowed = match value > whole {
                true => format!(
                    "all of it in the table, whose masses come to {sum}: with the pan, and all that was \
                     washed out"
                ),
                false => format!("at least the {sum} to which the masses of the table come"),
            };
            return Err(grid.refused(row.line, place, "dry mass", &value.to_string(), allowed));
        }
        let place = if is_below { "below it" } else { "beside it" };
        reading.notes.push(format!(
            "the masses of the table come to {sum}, and \"{}\" {place} is {value}: was anything washed out \
             or lost?",
            row.words
        ));
    }
    Ok(())
}

/// Words and the number after them, above the table or beside it.
fn stated(extent: &Extent) -> Vec<Below> {
    let mut stated = Vec::new();
    let is_other = |row: &&GridRow| extent.below.iter().all(|below| below.line != row.line);
    for row in extent.grid.rows.iter().filter(is_other) {
        let says = |cell: &str| is_words(cell) || matches!(opening(cell), Some((Opening::Total, _)));
        for column in row.filled().filter(|&c| says(row.cell(c))) {
            let cell = row.cell(column);
            let (words, inside) = cell.rsplit_once([':', '=']).unwrap_or((cell, ""));
            let next = || row.filled().find(|&c| c > column);
            let behind = || next().and_then(|c| Some((c, mass(row.cell(c))?)));
            let value = mass(inside).map(|value| (column, value)).or_else(behind);
            stated.push(Below { line: row.line, column, words: words.trim().to_owned(), value });
        }
    }
    stated
}

fn mass(cell: &str) -> Option<f64> {
    percentage(cell.trim_end_matches("kg").trim_end_matches('g').trim())
}

/// Removes the rounding error from a sum of decimals.
fn tidy(sum: f64) -> f64 {
    (sum * 1e6).round() / 1e6
}

pub(super) fn percents_finer(
    reading: &mut Reading,
    Retained { percent, cumulative }: Retained,
    entries: &[Entry],
    missing: &[usize],
) -> Result<Vec<Row>, TableError> {
    let &mut Reading { grid, column, .. } = reading;
    let mut sieves: Vec<(usize, f64, f64)> = Vec::new();
    if let Some((line, text)) = grid.commented.first() {
        let allowed = "every row of what is retained, as each is a part of the whole: take away this row or \
                       the # before it";
        return Err(grid.refused(*line, 0, FIELDS[0], text, allowed));
    }
    let (mut pans, mut total) = (Vec::new(), None);
    for entry in entries {
        match entry.opening {
            Opening::Mm(size) => sieves.push((entry.line, size, entry.value)),
            Opening::Total if total.is_some_and(|total| total != entry.value) => {
                return Err(reading.refused_value(entry.line, entry.value, "one total"));
            }
            Opening::Total => total = Some(entry.value),
            _ => pans.push(entry),
        }
    }
    let pan = pans.first().map(|first| (first.line, pans.iter().map(|entry| entry.value).sum::<f64>()));
    let sum = sieves.iter().map(|sieve| sieve.2).sum::<f64>() + pan.map_or(0.0, |pan| pan.1);
    let is_whole = total.is_some_and(|total: f64| (sum - total).abs() <= ROUNDED / 100.0 * total);
    let washed = pans.iter().find(|entry| is_washed(&entry.text));
    if let Some(part) = washed.or(pans.get(1)).filter(|_| !is_whole) {
        let allowed = "one row for the pan, the last, with all that was washed out or lost, as it is a \
                       part of the whole; or a row for the total, to which all of them sum";
        return Err(reading.refused_size(part, allowed));
    }
    let refused_size = |&(line, size, _): &(usize, f64, f64), allowed: String| {
        grid.refused(line, column.column, FIELDS[0], &size.to_string(), allowed)
    };
    let is_turn = |w: &[(usize, f64, f64)]| (w[0].1 - w[1].1) * (w[1].1 - w[2].1) < 0.0;
    if let Some(turn) = sieves.windows(3).find(|three| is_turn(three)) {
        let allowed = "sizes all ascending or all descending";
        return Err(refused_size(&turn[2], allowed.into()));
    }
    sieves.sort_by(|a, b| b.1.total_cmp(&a.1));
    let Some(&(first_line, _, first)) = sieves.first() else { return Ok(Vec::new()) };
    if let Some(pair) = sieves.windows(2).find(|pair| pair[0].1 == pair[1].1) {
        let allowed = format!("every size once (it is also in {})", grid.row_label(pair[0].0));
        return Err(refused_size(&pair[1], allowed));
    }
    let on_sieves: f64 = sieves.iter().map(|sieve| sieve.2).sum();
    let all = on_sieves + pan.map_or(0.0, |(_, mass)| mass);
    let last = pan.map_or(sieves[sieves.len() - 1].2, |(_, mass)| mass);
    let rises = sieves.windows(2).all(|w| w[0].2 <= w[1].2)
        && pan.is_none_or(|(_, mass)| mass >= sieves[sieves.len() - 1].2);
    let near = |a: f64, b: f64| (a - b).abs() <= ROUNDED / 100.0 * b.abs().max(1e-12);
    let whole = if percent { Some(100.0) } else { total };
    let can_end_at = |sum: f64| match whole {
        Some(whole) if pan.is_some() => near(sum, whole),
        Some(whole) => sum <= whole * (1.0 + ROUNDED / 100.0),
        None => pan.is_some(),
    };
    let cumulative = match (cumulative, can_end_at(all), rises && can_end_at(last)) {
        (Some(true), _, true) | (None, false, true) => true,
        (Some(false), true, _) | (None, true, false) => false,
        (None, true, true) => {
            let allowed =
                "a heading that says whether each value is `cumulative` or `individual`: both fit the values";
            return Err(reading.refused_value(first_line, first, allowed));
        }
        _ if whole.is_none() && pan.is_none() => {
            let allowed = "masses with that in the pan, or their total, without which percents are not known";
            return Err(reading.refused_value(sieves[sieves.len() - 1].0, last, allowed));
        }
        (Some(true), _, false) => {
            let allowed = "values retained that rise towards the finer sieves, to 100 % at most, as the \
                           heading says cumulative";
            return Err(reading.refused_value(first_line, first, allowed));
        }
        _ => {
            let allowed = format!(
                "values retained that sum to the whole with the pan (these sum to {}), or cumulative ones \
                 that rise towards the finer sieves",
                tidy(all)
            );
            return Err(reading.refused_value(first_line, first, allowed));
        }
    };
    if !cumulative
        && let Some(&line) = missing.first()
        && !whole.is_some_and(|whole| near(all, whole))
    {
        let allowed =
            "what is retained on every sieve, 0 where nothing is; leave out a sieve that was not used";
        return Err(grid.refused(line, column.column, FIELDS[1], "", allowed));
    }
    if percent && let Some(total) = total.filter(|&total| !near(total, 100.0) && !near(total, all)) {
        let allowed = format!("the sum of the percents ({}) or 100 as their total", tidy(all));
        return Err(reading.refused_value(first_line, total, allowed));
    }
    let whole = match (cumulative, pan) {
        (false, Some(_)) => all,
        (true, Some(_)) if whole.is_none() || percent => last,
        _ => whole.unwrap_or(all),
    };
    if whole <= 0.0 {
        return Err(reading.refused_value(first_line, first, "masses of which any is above 0"));
    }
    check_stated(reading, percent, whole)?;
    if percent && pan.is_none() && total.is_none() {
        refuse_unsaid(reading, sieves[sieves.len() - 1].0, if cumulative { last } else { all })?;
    }
    let mut coarser = 0.0;
    let mut rows = Vec::new();
    for (line, size, value) in sieves {
        coarser = if cumulative { value } else { coarser + value };
        // Removes the rounding error of a sum of decimals.
        let finer = (100.0 * (1.0 - coarser / whole) * 1e9).round() / 1e9;
        rows.push(Row { line, size, percent: finer.clamp(0.0, 100.0) + 0.0 });
    }
    let what = if percent { "percents" } else { "masses" };
    let how = if cumulative { "cumulative " } else { "" };
    reading.notes.push(format!("{how}{what} retained turned into percent finer"));
    let rest = rows.last().map_or(0.0, |row| row.percent);
    if percent && !cumulative && pan.is_none() && rest > ROUNDED {
        let (sum, rest) = (tidy(all), tidy(rest));
        reading.notes.push(format!(
            "the percents retained sum to {sum}, without the pan: the missing {rest} % were taken as finer \
             than the finest sieve"
        ));
    }
    Ok(rows)
}

/// Upper limit of the difference between percents that were rounded to whole ones.
const ROUNDED_TO_WHOLE: f64 = 1.5;

/// Refuses a retained column that agrees with no soil.
pub(super) fn refuse_contradiction(
    extent: &Extent,
    soils: &[Result<Soil, TableError>],
) -> Result<(), TableError> {
    let (grid, layout) = (extent.grid, extent.layout);
    let read: Vec<&Soil> = soils.iter().filter_map(|soil| soil.as_ref().ok()).collect();
    if grid.across.is_some() || !layout.headed || read.len() < soils.len() {
        return Ok(());
    }
    let width = extent.rows().map(|row| row.cells.len()).max().unwrap_or(0);
    for column in (0..width).filter(|&c| layout.soils.iter().all(|soil| soil.column != c)) {
        let heading = head(&grid.rows[layout.at..layout.first], column);
        let Role::Retained(retained) = role(&heading) else { continue };
        if says_of_fines(&heading) {
            continue;
        }
        let value = |row: &GridRow| Some((row.line, percentage(row.cell(column))?));
        let values: HashMap<usize, f64> = extent.rows().filter_map(value).collect();
        let is_pan = |row: &&GridRow| matches!(extent.opening(row), Some(Opening::Pan | Opening::Below(_)));
        let pans: Vec<usize> = extent.rows().filter(is_pan).map(|row| row.line).collect();
        let differing = read.iter().map(|soil| match retained.percent {
            true => percents_differ(soil, &values, &pans),
            false => masses_differ(soil, &values, &pans),
        });
        let differing: Vec<Option<usize>> = differing.collect();
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

/// Finds the first line in which masses with a pan, on each sieve or cumulative, differ from the curve.
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
    // Mass washed out may be included in the percents but not in the pan.
    let whole = [on_sieves + pan, most, on_sieves / coarser, masses[&finest.line] / coarser];
    let line_of = |(at, &whole): (usize, &f64)| {
        let mut sum = 0.0;
        let is_possible = whole.is_finite() && whole >= if at % 2 == 1 { most } else { on_sieves + pan };
        rows.iter().find_map(|row| {
            let mass = masses[&row.line];
            sum = if at % 2 == 1 { mass } else { sum + mass };
            let is_other = (100.0 * sum / whole - (100.0 - row.percent)).abs() > ROUNDED_TO_WHOLE;
            (is_other || !is_possible).then_some(row.line)
        })
    };
    let lines: Vec<usize> = whole.iter().enumerate().map_while(line_of).collect();
    lines.first().copied().filter(|_| lines.len() == whole.len())
}

/// Finds the first line in which percents retained, on each sieve or cumulative, differ from the curve.
fn percents_differ(soil: &Soil, retained: &HashMap<usize, f64>, pans: &[usize]) -> Option<usize> {
    let mut rows: Vec<_> = soil.rows.iter().filter(|row| retained.contains_key(&row.line)).collect();
    rows.sort_by(|a, b| b.size.total_cmp(&a.size));
    let is_fraction = rows.len() > 1 && rows.iter().all(|row| retained[&row.line] <= 1.0);
    let factor = if is_fraction { 100.0 } else { 1.0 };
    let value = |line: usize| factor * retained[&line];
    let cumulative =
        rows.iter().find(|row| (value(row.line) - (100.0 - row.percent)).abs() > ROUNDED_TO_WHOLE);
    let mut sum = 0.0;
    let single = rows.iter().find(|row| {
        sum += value(row.line);
        (sum - (100.0 - row.percent)).abs() > ROUNDED_TO_WHOLE
    });
    let single = single.map(|row| row.line);
    // Mass washed out belongs to the pan.
    let of_pans: Vec<f64> = pans.iter().filter_map(|line| Some(factor * retained.get(line)?)).collect();
    let rest = pans.first().copied().filter(|_| {
        let finest = rows.last().filter(|row| !pans.contains(&row.line) && !of_pans.is_empty());
        finest.is_some_and(|finest| (of_pans.iter().sum::<f64>() - finest.percent).abs() > ROUNDED_TO_WHOLE)
    });
    cumulative.and(single.or(rest))
}

#[cfg(test)]
mod tests {
    use crate::Soil;

    #[test]
    fn percents_without_a_pan_say_what_they_were_taken_to_leave() {
        let notes = |rows: &str| {
            let text = format!("Sieve (mm),% Retained\n{rows}");
            Soil::all("a.csv", text.as_bytes()).unwrap()[0].notes().join("; ")
        };
        let short = notes("9.5,0\n4.75,30\n1.18,40\n0.075,5\n");
        let note = "the percents retained sum to 75, without the pan: the missing 25 % were taken as finer \
                    than the finest sieve";
        assert!(short.contains(note), "{short}");
        for whole in ["9.5,0\n4.75,30\n1.18,40\n0.075,5\nPan,25\n", "9.5,0\n4.75,30\n1.18,64\n0.075,6\n"] {
            let notes = notes(whole);
            assert!(notes.contains("turned into percent finer") && !notes.contains("missing"), "{notes}");
        }
    }
}
