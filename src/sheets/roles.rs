//! Role of a column whose heading leaves it open and whose rows decide it: classes, and percents that rise
//! towards the finer sieves.

use super::grid::Grid;
use super::heading::{Retained, Role, says_cumulative, says_finer};
use super::layout::{Layout, SoilColumn};
use super::size::{Entry, Form, Opening, Unit};
use voidwalk_core::gradation::FIELDS;
use voidwalk_core::gradation::TableError;

/// Settles the role of a column. Classes among its rows, whose bounds are in mm, become the sieves below
/// them.
pub(super) fn settle(
    grid: &Grid,
    layout: &Layout,
    column: &SoilColumn,
    entries: &mut Vec<Entry>,
    notes: &mut Vec<String>,
) -> Result<Role, TableError> {
    let is_class = |entry: &Entry| matches!(entry.opening, Opening::Class(..));
    match entries.iter().find(|entry| is_class(entry)) {
        Some(class) => {
            let role = of_classes(grid, layout, column, class, notes)?;
            as_sieves(grid, entries)?;
            Ok(role)
        }
        None if rises_in_known_sizes(layout, column, entries) => {
            notes.push("cumulative percents that rise towards the finer sizes read as retained".into());
            Ok(Role::Retained(Retained { percent: true, cumulative: Some(true) }))
        }
        None => Ok(column.role),
    }
}

/// A class holds what is retained between two sieves.
fn of_classes(
    grid: &Grid,
    layout: &Layout,
    column: &SoilColumn,
    class: &Entry,
    notes: &mut Vec<String>,
) -> Result<Role, TableError> {
    if class.form == Form::Plain && layout.unit.is_none() {
        let allowed = "classes with their unit, in the heading as Fraction (mm) or in each cell";
        return Err(grid.refused(class.line, class.column, FIELDS[0], &class.text, allowed));
    }
    if let Role::Retained(_) = column.role {
        return Ok(column.role);
    }
    if says_finer(&column.heading) || says_cumulative(&column.heading) {
        let allowed = "percents of each class, as their openings are the bounds of classes, or one opening \
                       in each row";
        return Err(grid.refused(class.line, column.column, "heading", &column.heading, allowed));
    }
    notes.push(format!("percents of classes such as {} read as retained on the finer sieve", class.text));
    Ok(Role::Retained(Retained { percent: true, cumulative: Some(false) }))
}

/// Replaces each class by its lower sieve, and adds above the coarsest class the sieve that all mass passes.
fn as_sieves(grid: &Grid, entries: &mut Vec<Entry>) -> Result<(), TableError> {
    let bounds = |entry: &Entry| match entry.opening {
        Opening::Class(upper, lower) => Some((upper, lower)),
        Opening::Below(upper) => Some((upper, 0.0)),
        _ => None,
    };
    let refused = |entry: &Entry, allowed: &str| {
        Err(grid.refused(entry.line, entry.column, FIELDS[0], &entry.text, allowed))
    };
    if let Some(entry) = entries.iter().find(|entry| matches!(entry.opening, Opening::Mm(_))) {
        return refused(entry, "the bounds of a class in each row, as the other rows have");
    }
    let mut order: Vec<usize> = (0..entries.len()).filter(|&at| bounds(&entries[at]).is_some()).collect();
    let lower = |at: usize| bounds(&entries[at]).map_or(0.0, |(_, lower)| lower);
    order.sort_by(|&a, &b| lower(b).total_cmp(&lower(a)));
    for pair in order.windows(2) {
        let (above, below) = (lower(pair[0]), bounds(&entries[pair[1]]).map_or(0.0, |(upper, _)| upper));
        if (above - below).abs() > 1e-9 * above {
            return refused(&entries[pair[1]], "classes that follow each other, with one bound in common");
        }
    }
    let Some(&coarsest) = order.first() else { return Ok(()) };
    let top = bounds(&entries[coarsest]).map(|(upper, _)| upper).filter(|upper| upper.is_finite());
    for entry in entries.iter_mut() {
        if let Opening::Class(_, lower) = entry.opening {
            entry.opening = if lower > 0.0 { Opening::Mm(lower) } else { Opening::Pan };
        }
    }
    if let Some(upper) = top {
        let of_class = &entries[coarsest];
        let Entry { line, column, form, .. } = *of_class;
        let all = Entry {
            line,
            column,
            opening: Opening::Mm(upper),
            text: of_class.text.clone(),
            form,
            value: 0.0,
        };
        let descends = order.windows(2).all(|pair| pair[0] < pair[1]);
        entries.insert(if descends { coarsest } else { coarsest + 1 }, all);
    }
    Ok(())
}

/// True if cumulative percents under a heading that says no more are retained: their sizes, whose unit is
/// given, fall while they rise.
fn rises_in_known_sizes(layout: &Layout, column: &SoilColumn, entries: &[Entry]) -> bool {
    let is_known = |entry: &Entry| match layout.unit {
        Some(unit) => unit != Unit::SieveNumber,
        None => entry.form != Form::Plain,
    };
    if column.role != Role::Finer || !says_cumulative(&column.heading) || says_finer(&column.heading) {
        return false;
    }
    let mut sizes: Vec<(f64, f64)> = Vec::new();
    for entry in entries {
        match entry.opening {
            Opening::Mm(size) if is_known(entry) => sizes.push((size, entry.value)),
            Opening::Mm(_) => return false,
            _ => {}
        }
    }
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let ends = (sizes.first().map(|row| row.1), sizes.last().map(|row| row.1));
    sizes.windows(2).all(|w| w[0].1 <= w[1].1) && ends.0 < ends.1
}
