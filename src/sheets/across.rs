//! Tables on their side: a row of openings, possibly within the headings of percents (`P#200`,
//! `Passing 19 mm`), and below it one row per soil, with its names to the left.

use super::content::{
    begins_with_words, holds_several, is_blank, is_data, is_text, is_value, is_words, percentage,
    refuse_short, refused_row, row_below,
};
use super::grid::{Grid, GridRow, joined};
use super::heading::{Retained, Role, role, says_finer, says_sample, unit, words};
use super::languages::Words;
use super::layout::{Layout, MOST_NAMED, ROWS_OF_TITLES, SoilColumn, is_heading, says_soil};
use super::size::{Form, Opening, Unit, goes_one_way, opening, positive_size};
use std::collections::HashMap;
use std::ops::Range;
use voidwalk_core::gradation::{TableError, percent_is_allowed, shortened};

/// Minimum number of openings: fewer bare numbers may mean anything, and fewer named openings make no curve.
const LEAST_OPENINGS: usize = 3;
const LEAST_NAMED: usize = 2;

/// The openings of a table that lies on its side.
struct Openings {
    columns: Vec<usize>,
    /// Openings as written, without the words around them.
    texts: Vec<String>,
    /// Role of the values, if the words around the openings say retained.
    retained: Option<Role>,
    /// True if all openings are numbers without a unit or a word.
    bare: bool,
}

/// A table on its side.
struct Across<'a> {
    grid: &'a Grid,
    /// Index of the row of openings.
    at: usize,
    heading: &'a GridRow,
    openings: Openings,
    /// Indices of the rows with a soil each.
    soils: Range<usize>,
}

/// Finds the table of a grid that lies on its side, and returns it upright with its layout; `None` if
/// there is none.
pub(super) fn find(grid: &Grid) -> Result<Option<(Grid, Layout)>, TableError> {
    let upper = &grid.rows[..grid.rows.len().min(ROWS_OF_TITLES)];
    if upper.iter().any(|row| is_heading(row) && says_soil(row) && openings(row).is_none_or(|o| o.bare)) {
        return Ok(None);
    }
    let table = upper.iter().enumerate().find_map(|(at, heading)| {
        let openings = openings(heading)?;
        let soils = soils(heading, &grid.rows[at + 1..], &openings.columns)?;
        let soils = at + 1 + soils.start..at + 1 + soils.end;
        Some(Across { grid, at, heading, openings, soils })
    });
    let Some(table) = table else { return Ok(None) };
    if table.openings.bare && !table.has_openings() {
        return match upper.iter().any(is_heading) {
            true => Ok(None),
            false => Err(table.refused_percents()),
        };
    }
    table.refuse_second()?;
    table.refuse_other_openings()?;
    table.refuse_lost()?;
    Ok(Some(table.upright()))
}

/// Finds the openings of a row after its words, rising or falling, and the pan after them.
fn openings(row: &GridRow) -> Option<Openings> {
    let is_head = |c: usize| head(row.cell(c)).is_some();
    let first = row.filled().find(|&c| is_head(c)).filter(|&first| first > 0)?;
    let mut starts = row.filled().filter(|&c| c >= first && is_head(c) && !is_head(c - 1));
    starts.find_map(|start| openings_from(row, start).filter(|openings| start == first || !openings.bare))
}

fn openings_from(row: &GridRow, first: usize) -> Option<Openings> {
    let mut heads: Vec<Head> = Vec::new();
    for c in first..row.cells.len() {
        let is_rest = matches!(opening(row.cell(c)), Some((Opening::Below(_), _)));
        let Some(head) = head(row.cell(c)) else { break };
        // After openings without words, `< 0.075` is the pan.
        if is_rest && heads.last().is_some_and(|last| last.role.is_none()) {
            break;
        }
        heads.push(head);
    }
    let (mut sizes, mut bare) = (Vec::new(), true);
    for head in &heads {
        let Some((Opening::Mm(size) | Opening::Bare(size), form)) = opening(&head.text) else { continue };
        bare &= form == Form::Plain && head.role.is_none();
        sizes.push(size);
    }
    let one_way = goes_one_way(&sizes);
    let least = if bare { LEAST_OPENINGS } else { LEAST_NAMED };
    if heads.len() < least || !one_way && !mixes_units(&heads) {
        return None;
    }
    let retained = heads.iter().find_map(|head| head.role.filter(|role| *role != Role::Finer));
    let mut texts: Vec<String> = heads.into_iter().map(|head| head.text).collect();
    let is_rest = |c: &usize| matches!(opening(row.cell(*c)), Some((Opening::Pan | Opening::Below(_), _)));
    let end = first + texts.len();
    let rest: Vec<usize> = (end..row.cells.len()).take_while(is_rest).collect();
    texts.extend(rest.iter().map(|&c| row.cell(c).to_owned()));
    Some(Openings { columns: (first..end).chain(rest).collect(), texts, retained, bare })
}

/// True if there are both bare numbers and openings with a unit, so that their order says nothing yet.
fn mixes_units(heads: &[Head]) -> bool {
    let is_bare = |head: &Head| matches!(opening(&head.text), Some((Opening::Bare(_), _)));
    heads.iter().any(|head| head.role.is_some()) && heads.iter().any(is_bare)
}

/// Rows below that contain one soil each: words, then percents.
fn soils(heading: &GridRow, below: &[GridRow], openings: &[usize]) -> Option<Range<usize>> {
    // A number is a name only below a heading of names; below a heading of openings it is an opening.
    let of_names = |c: usize| !heading.cell(c).is_empty() && role(heading.cell(c)) == Role::Other;
    let is_sieve = |cell: &str| opening(cell).is_some_and(|(o, _)| !matches!(o, Opening::Class(..)));
    let is_name = |c: usize, cell: &str| match is_value(cell) || is_sieve(cell) {
        true => of_names(c),
        false => !is_blank(cell),
    };
    let is_size = |c: &usize| role(heading.cell(*c)) == Role::Size && !openings.contains(c);
    let sizes: Vec<usize> = heading.filled().filter(is_size).collect();
    let is_soil = |row: &GridRow| {
        // Each row has its own size, so the headings are names of soils such as p4.
        if sizes.iter().any(|&c| is_value(row.cell(c)) || is_sieve(row.cell(c))) {
            return false;
        }
        let named = (0..openings[0]).any(|c| is_name(c, row.cell(c)));
        let values = openings.iter().filter(|&&c| is_value(row.cell(c))).count();
        let filled = openings.iter().filter(|&&c| !is_blank(row.cell(c))).count();
        named && values >= 2 && 2 * values > filled
    };
    let first = below.iter().position(|row| !is_text(row))?;
    let count = below[first..].iter().take_while(|row| is_soil(row)).count();
    (count > 0).then_some(first..first + count)
}

/// Minimum value in a row of percents; openings (mm) may be smaller.
const LEAST_PERCENT: f64 = 0.1;

impl<'a> Across<'a> {
    fn rows(&self) -> &'a [GridRow] {
        &self.grid.rows[self.soils.clone()]
    }

    fn last(&self) -> usize {
        self.openings.columns[self.openings.columns.len() - 1]
    }

    /// True if a row of bare numbers contains openings, by the words to its left or by its numbers, and is
    /// not a row of percents beside the name of a soil.
    fn has_openings(&self) -> bool {
        let (row, columns) = (self.heading, &self.openings.columns);
        let labels: Vec<&str> = (0..columns[0]).map(|c| row.cell(c)).filter(|cell| !is_blank(cell)).collect();
        if labels.iter().any(|label| role(label) == Role::Size || is_of_names(label)) {
            return true;
        }
        if let Some(above) = self.text_above() {
            let says_size = |row: &GridRow| row.cells.iter().any(|cell| role(cell) == Role::Size);
            return labels.is_empty() && says_size(above);
        }
        let sizes = || columns.iter().filter_map(|&c| percentage(row.cell(c)));
        let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
        labels.is_empty() || most > 100.0 || most > 1.0 && least < LEAST_PERCENT
    }

    /// Returns the row of words above numbers, such as percents under headings that are not understood.
    fn text_above(&self) -> Option<&'a GridRow> {
        let columns = &self.openings.columns;
        let is_words = |row: &&GridRow| {
            let words =
                columns.iter().filter(|&&c| !row.cell(c).is_empty() && !is_value(row.cell(c))).count();
            2 * words >= columns.len()
        };
        self.grid.rows[..self.at].iter().rev().find(is_words)
    }

    /// Makes the error for a row of percents beside the name of a soil without openings.
    fn refused_percents(&self) -> TableError {
        let (grid, row, columns) = (self.grid, self.heading, &self.openings.columns);
        let name = (0..columns[0]).map(|c| row.cell(c)).find(|cell| !is_blank(cell)).unwrap_or_default();
        if let Some(above) = self.text_above() {
            let is_unread = |c: &usize| !above.cell(*c).is_empty() && head(above.cell(*c)).is_none();
            let column = columns.iter().copied().find(is_unread).unwrap_or(columns[0]);
            let name = shortened(name);
            let allowed = format!(
                "an opening above the percents of \"{name}\", such as P#200, Passing 19 mm or 0.075 mm"
            );
            return grid.refused(above.line, column, "heading", above.cell(column), allowed);
        }
        let allowed = "Sample or Sieve (mm) beside these numbers if they are openings, or a row of openings \
                       above them if they are percents";
        grid.refused(row.line, 0, "heading", name, allowed)
    }

    fn is_between(&self, c: usize) -> bool {
        (self.openings.columns[0]..=self.last()).contains(&c)
    }

    /// Refuses headings beside the openings that name more openings or seem to do so.
    fn refuse_other_openings(&self) -> Result<(), TableError> {
        let (row, first, last) = (self.heading, self.openings.columns[0], self.last());
        let is_beside = |c: usize| c + 1 == first || c == last + 1;
        let is_percents = |c: usize| {
            let cells = self.rows().iter().map(|row| row.cell(c)).filter(|cell| !is_blank(cell));
            let mut percents = cells.map(|cell| percentage(cell).is_some_and(percent_is_allowed)).peekable();
            percents.peek().is_some() && percents.all(|is_percent| is_percent)
        };
        let is_other = |c: &usize| {
            let cell = row.cell(*c);
            let is_named = is_broken(cell) || head(cell).is_some_and(|head| head.role.is_some());
            !self.is_between(*c) && (is_named || is_beside(*c) && is_misspelt(cell) && is_percents(*c))
        };
        if let Some(c) = row.filled().find(is_other) {
            let allowed = "an opening, such as P#200, Passing 19 mm or 0.075 mm, beside the other openings";
            return Err(self.grid.refused(row.line, c, "heading", row.cell(c), allowed));
        }
        Ok(())
    }

    /// Refuses rows below the soils that also look like a table, instead of ignoring them.
    fn refuse_second(&self) -> Result<(), TableError> {
        let &Across { grid, at, heading, .. } = self;
        let label = |row: &GridRow| row.filled().next().map(|c| row.cell(c).to_lowercase());
        for (index, row) in grid.rows.iter().enumerate().skip(at + 1) {
            let again = openings(row).is_some() && label(row) == label(heading);
            let beyond = index >= self.soils.end
                && (is_data(row) && !begins_with_words(row) || openings(row).is_some());
            if again || beyond {
                let column = row.filled().next().unwrap_or(self.openings.columns[0]);
                let allowed = "one row of openings, and the rows of soils directly below it: keep each table \
                               in a file or a sheet of its own";
                return Err(grid.refused(row.line, column, "row", row.cell(column), allowed));
            }
        }
        Ok(())
    }

    /// Refuses rows of soils that cannot be read, openings that would be ignored, and values without an
    /// opening.
    fn refuse_lost(&self) -> Result<(), TableError> {
        let &Across { grid, at, heading, .. } = self;
        let (openings, last) = (&self.openings.columns, self.last());
        let refused = |row: &GridRow, c: usize, allowed: &str| {
            Err(grid.refused(row.line, c, "row", row.cell(c), allowed))
        };
        let is_opening = |row: &GridRow, c: usize| opening(row.cell(c)).is_some();
        if let Some(above) = grid.rows[..at].iter().find(|row| {
            row.filled().any(|c| !is_opening(row, c) && holds_several(row.cell(c)))
                || openings.iter().filter(|&&c| is_opening(row, c)).count() >= LEAST_OPENINGS
        }) {
            let c = above.filled().next().unwrap_or(0);
            return refused(above, c, "openings in cells of their own, all rising or all falling");
        }
        for row in self.rows() {
            refuse_short(grid, row, "", last)?;
            let is_size = |&c: &usize| role(row.cell(c)) == Role::Size && !is_value(row.cell(c));
            if let Some(c) = (0..openings[0]).find(is_size) {
                return refused(row, c, "one row of openings");
            }
            if let Some(c) =
                (last + 1..row.cells.len()).find(|&c| is_value(row.cell(c)) && heading.cell(c).is_empty())
            {
                return refused(row, c, "an opening above each value");
            }
        }
        if let Some(c) = (last + 1..heading.cells.len()).find(|&c| is_opening(heading, c)) {
            return refused(heading, c, "openings side by side");
        }
        let is_soil = |row: &GridRow| openings.iter().filter(|&&c| is_value(row.cell(c))).count() > 1;
        let Some(end) = grid.rows.iter().rposition(is_soil) else { return Ok(()) };
        for (index, row) in grid.rows.iter().enumerate().skip(at + 1).filter(|(_, row)| is_text(row)) {
            let is_near = index < end || row.line == grid.rows[end].line + 1;
            let several = || row.filled().find(|&c| holds_several(row.cell(c)));
            let column = several().or_else(|| row_below(row)).filter(|_| is_near);
            if let Some(column) = column {
                return Err(refused_row(grid, row, column));
            }
        }
        Ok(())
    }

    fn upright(&self) -> (Grid, Layout) {
        let &Across { grid, at, heading, .. } = self;
        let Openings { columns, texts, retained, .. } = &self.openings;
        let soils = self.rows();
        let turned = |(&c, text): (&usize, &String)| GridRow {
            line: c + 1,
            cells: [text.clone()].into_iter().chain(soils.iter().map(|row| row.cell(c).to_owned())).collect(),
            text: None,
            open: false,
        };
        let beside = (0..heading.cells.len()).filter(|&c| !self.is_between(c)).map(|c| heading.cell(c));
        let words_above: Vec<&str> = grid.rows[..at]
            .iter()
            .rev()
            .flat_map(|row| row.cells.iter())
            .map(String::as_str)
            .chain(beside)
            .filter(|cell| cell.contains(char::is_alphabetic) && opening(cell).is_none())
            .collect();
        let stated_unit = |text: &&str| match (role(text), unit(text)) {
            (Role::Other, _) => None,
            (_, Ok(Some(unit))) if unit != Unit::SieveNumber => Some(unit),
            _ => None,
        };
        let stated_retained =
            words_above.iter().map(|text| role(text)).find(|role| matches!(role, Role::Retained(_)));
        let (names, unread) = names(&grid.rows[..=at], soils, columns[0]);
        let soil = |(index, row): (usize, &GridRow)| {
            let words = (0..columns[0]).map(|c| row.cell(c)).filter(|cell| !cell.is_empty());
            let stated = words.map(role).find(|role| role.has_values());
            let role = stated.or(*retained).or(stated_retained).unwrap_or(Role::Other);
            SoilColumn { column: index + 1, heading: names[index].clone(), role, end: None }
        };
        let named = |c: usize| soils.iter().any(|row| percentage(row.cell(c)).is_some());
        let last = self.last();
        let unused: Vec<String> = unread
            .into_iter()
            .chain(last + 1..heading.cells.len().max(last + 1))
            .filter(|&c| named(c))
            .map(|c| format!("{} (\"{}\")", grid.column_label(c), shortened(heading.cell(c))))
            .collect();
        let mut notes = vec!["openings read across: a row for each soil".to_owned()];
        if !unused.is_empty() {
            notes.push(format!("not used: {}", joined(unused, MOST_NAMED)));
        }
        if let Some(row) = grid.rows.get(self.soils.end) {
            let begins = row.filled().find(|&c| is_words(row.cell(c))).map_or("", |c| row.cell(c));
            let (place, begins) = (grid.row_label(row.line), shortened(begins));
            notes.push(format!("the rest from {place} on (\"{begins}\") was left out"));
        }
        let layout = Layout {
            unit: words_above.iter().find_map(stated_unit),
            soils: soils.iter().enumerate().map(soil).collect(),
            headed: true,
            notes,
            ..Layout::default()
        };
        let lines = [heading].into_iter().chain(soils).map(|row| row.line).collect();
        let turned = grid.with_rows(columns.iter().zip(texts).map(turned).collect());
        (Grid { left: 0, across: Some(lines), part: None, ..turned }, layout)
    }
}

/// Words before or after an opening that mean finer.
static FINER: Words = Words::of(
    "p|pass|passing|passed|percent|percentage|pct|perc|finer|smaller|than|through|minus|cum|cumul|\
     cumulative|undersize",
);
static RETAINED: Words = Words::of("ret|retained|coarser|plus|oversize|cr");
static BETWEEN: Words = Words::of("on|sieve|sieves|size|the|by|mass|weight");

/// An opening as the heading of a column.
struct Head {
    text: String,
    /// Finer or retained, according to the words; `None` without words.
    role: Option<Role>,
}

/// Removes the words about percents from both ends of a heading, and returns the role that they name.
fn without_words(heading: &str) -> (String, Option<Role>) {
    let small = heading.to_lowercase().replace('_', " ");
    let (mut rest, mut stated, mut retained, mut cumulative) = (small.as_str(), false, false, None);
    let mut take = |word: &str, stated: &mut bool| {
        let is_retained =
            RETAINED.has(word) || matches!(role(word), Role::Retained(Retained { percent: true, .. }));
        retained |= is_retained;
        if word.starts_with("cum") {
            cumulative = Some(true);
        }
        let is_word = is_retained || FINER.has(word) || says_finer(word);
        *stated |= is_word;
        is_word || *stated && BETWEEN.has(word)
    };
    loop {
        let bare = rest.trim_start_matches([' ', '%', '.', ':', '<', '≤', '(', '-']);
        stated |= rest[..rest.len() - bare.len()].contains(['%', '<', '≤', '-']);
        rest = bare;
        if let Some(after) = rest.strip_prefix('+') {
            rest = after;
            take("plus", &mut stated);
            continue;
        }
        let mut word: String = rest.chars().take_while(|c| c.is_alphabetic()).collect();
        if ["pno", "pnr"].contains(&word.as_str()) {
            word.truncate(1);
        }
        if word.is_empty() || !take(&word, &mut stated) {
            break;
        }
        rest = &rest[word.len()..];
    }
    while opening(rest).is_none() {
        let bare = rest.trim_end_matches([' ', '%', '.', ':', ',', '(', ')']);
        stated |= rest[bare.len()..].contains('%');
        rest = bare;
        let from = rest
            .rfind(|c: char| !c.is_alphabetic())
            .map_or(0, |at| at + rest[at..].chars().next().map_or(1, char::len_utf8));
        if from == rest.len() || !take(&rest[from..], &mut stated) {
            break;
        }
        rest = &rest[..from];
    }
    let role = if retained { Role::Retained(Retained { percent: true, cumulative }) } else { Role::Finer };
    (rest.trim().to_owned(), stated.then_some(role))
}

fn is_size(text: &str) -> bool {
    positive_size(text).is_some_and(f64::is_finite)
}

/// Returns the opening named by a heading, with or without words about percents around it.
fn head(heading: &str) -> Option<Head> {
    if is_size(heading) && !heading.starts_with('+') {
        return Some(Head { text: heading.to_owned(), role: None });
    }
    let (text, role) = without_words(heading);
    (role.is_some() && is_size(&text)).then_some(Head { text, role })
}

/// True if a heading seems to name an opening but does not: `P#4x`.
fn is_broken(heading: &str) -> bool {
    let (text, role) = without_words(heading);
    role.is_some() && text.contains(|c: char| c.is_ascii_digit()) && !is_size(&text)
}

/// True if a heading may be an opening with a typing error: `#2OO`, `0..075`, `PO.O75`; not `LL`, `D60`.
fn is_misspelt(heading: &str) -> bool {
    let mended = heading.replace(['O', 'o'], "0").replace(['l', 'I'], "1");
    let has_digit = heading.contains(|c: char| c.is_ascii_digit() || c == '#');
    has_digit && (!is_words(heading) || head(&mended).is_some())
}

/// True if a heading announces names below it and is not itself a name: `Sample no.`, `Hole`.
fn is_of_names(heading: &str) -> bool {
    static BESIDE: Words = Words::of(
        "no|nr|number|id|ref|reference|type|test|trial|hole|bore|location|station|description|bh|tp|\
         lab|layer",
    );
    let words = words(heading);
    !words.is_empty() && words.iter().all(|word| says_sample(word) || BESIDE.has(word))
}

/// Names of the soils in `rows` below `headings`, whose openings begin in column `end`, and the columns
/// that are not used for names. A name consists of the first column and those announced as names; a
/// depth and other columns are added only if names would otherwise be equal.
fn names(headings: &[GridRow], rows: &[GridRow], end: usize) -> (Vec<String>, Vec<usize>) {
    /// Maximum number of additional columns used to tell soils with the same name apart.
    const MOST_MORE: usize = 8;
    let head = |c: usize| {
        let near = headings.iter().rev().take(3).map(|row| row.cell(c));
        near.into_iter().find(|cell| !cell.is_empty()).unwrap_or_default()
    };
    let any = |c: usize, is: &dyn Fn(&str) -> bool| rows.iter().any(|row| is(row.cell(c)));
    let filled: Vec<usize> = (0..end).filter(|&c| any(c, &|cell| !is_blank(cell))).collect();
    let is_first = |c: usize| Some(&c) == filled.first();
    let is_text = |c: usize| head(c).is_empty() && !any(c, &is_value);
    let rank = |c: usize| match () {
        () if is_first(c) || says_sample(head(c)) || is_text(c) => 0,
        () if words(head(c)).iter().any(|word| says_depth(word)) => 1,
        () => 2,
    };
    let mut order = filled.clone();
    order.sort_by_key(|&c| rank(c));
    let (always, more) = order.split_at(order.partition_point(|&c| rank(c) == 0));
    let joined = |row: &GridRow, columns: &[usize]| {
        let cells = columns.iter().map(|&c| row.cell(c)).filter(|cell| !is_blank(cell));
        cells.collect::<Vec<_>>().join(" ")
    };
    let mut names: Vec<String> = rows.iter().map(|row| joined(row, always)).collect();
    let mut unused = Vec::new();
    let (more, others) = more.split_at(more.len().min(MOST_MORE));
    for &c in more {
        let mut times: HashMap<String, usize> = HashMap::new();
        names.iter().for_each(|name| *times.entry(name.clone()).or_default() += 1);
        let mut used = false;
        for (name, row) in names.iter_mut().zip(rows) {
            if (times[name] > 1 || name.is_empty()) && !is_blank(row.cell(c)) {
                *name = format!("{name} {}", row.cell(c)).trim().to_owned();
                used = true;
            }
        }
        unused.extend((!used).then_some(c));
    }
    unused.extend(others);
    (names, unused)
}

/// True if a word of a heading announces depths below it.
pub(super) fn says_depth(word: &str) -> bool {
    ["depth", "tiefe", "profondeur", "profundidad", "prof", "from", "top", "elevation"].contains(&word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn openings_are_found_within_headings_of_percents() {
        let all = "P3/4 = 3/4|P#4 = #4|P 200 = 200|PNo. 40 = no. 40|P-#40 = #40|Passing 19 mm = 19 mm|\
            % pass #40 = #40|%<0.425mm = 0.425mm|<0.075 mm = 0.075 mm|% finer No. 200 = no. 200|\
            Percent passing sieve No. 4 = no. 4|pct_finer_0.075mm = 0.075mm|Cum 19 = 19|#200 (%) = #200|\
            19 mm passing = 19 mm|3/4 in. % passing = 3/4 in|Minus #200 = #200|Durchgang 4 mm = 4 mm|\
            Passant 80 µm = 80 µm|No. 4 = No. 4";
        for (heading, text) in all.split('|').filter_map(|pair| pair.split_once(" = ")) {
            let head = head(heading).unwrap_or_else(|| panic!("{heading}"));
            assert_eq!(head.text, text, "{heading}");
            assert!(!matches!(head.role, Some(Role::Retained(_))), "{heading}");
        }
        for heading in ["% ret #4", "Rückstand 4 mm", "Cum. % retained on 4.75 mm", "+4.75 mm"] {
            assert!(matches!(head(heading).unwrap().role, Some(Role::Retained(_))), "{heading}");
        }
        for heading in "LL|PI (%)|Sample|P80 (um)|D60|Depth (m)|Gravel %|Cu|P|%".split('|') {
            assert!(head(heading).is_none(), "{heading}");
        }
        assert!(["P#4x", "% pass 3//4", "Passing No. 201"].into_iter().all(is_broken));
        assert!("#2OO|0..075|PO.O75|#200x|#lOO|No. 2OO|O.O75".split('|').all(is_misspelt));
        for other in ["LL", "PI", "Cu", "D60", "Moisture (%)", "P80 (um)", "CaCO3 (%)", "USCS", "LL1"] {
            assert!(!is_misspelt(other), "{other}");
        }
        assert!(!["LL (%)", "P#4", "Depth 2", "D60", "Cu"].into_iter().any(is_broken));
    }
}
