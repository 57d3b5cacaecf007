//! The sizes of soils that engineers look for, D5 to D95, Cu, Cc, fines and group, as a table.

use maud::{Markup, Render, html};

use super::quantity::SizeUnit;
use super::shell::clean;
use super::table::Table;
use crate::outcome::soil_sizes::sizes_of;

/// A soil: what it is called in the table, and its rows of size and percent finer.
pub(super) struct SizedSoil<'a> {
    /// What it is called.
    pub name: String,
    /// Size, and percent finer by mass.
    pub rows: &'a [[f64; 2]],
}

impl<'a> SizedSoil<'a> {
    pub(super) fn new(name: impl Into<String>, rows: &'a [[f64; 2]]) -> Self {
        Self { name: name.into(), rows }
    }
}

/// What stands below such a table.
fn note(unit: SizeUnit) -> Markup {
    html! { p.small {
        @if unit != SizeUnit::D0f {
            "Group by ASTM D2487, finer than 75 mm. "
        }
        "–: not known."
    } }
}

/// A value, or that it is not known.
fn cell(value: Option<&String>) -> String {
    value.cloned().unwrap_or_else(|| "–".into())
}

/// Of a few soils, a column each.
pub(super) fn of_few(soils: &[SizedSoil], unit: SizeUnit) -> Markup {
    let sizes: Vec<_> = soils.iter().map(|soil| sizes_of(soil.rows, unit)).collect();
    let rows: Vec<usize> = (0..sizes.first().map_or(0, Vec::len)).collect();
    let mut table = Table::of(&rows).name(unit.name(), |row| sizes[0][*row].0);
    for (soil, sizes) in soils.iter().zip(&sizes) {
        table = table.number(clean(&soil.name), |row| cell(sizes[*row].1.as_ref()));
    }
    html! { div.sizes { (table) (note(unit)) } }
}

/// Of many soils, a row each, in mm.
pub(super) fn of_many(soils: &[SizedSoil]) -> Markup {
    let sizes: Vec<_> = soils.iter().map(|soil| (&soil.name, sizes_of(soil.rows, SizeUnit::Mm))).collect();
    let Some((_, first)) = sizes.first() else { return html! {} };
    let mut table =
        Table::of(&sizes).class("cases").name("Soil", |(name, _)| html! { bdi { (clean(name)) } });
    for (at, (name, _)) in first.iter().enumerate() {
        let heading = if name.starts_with('D') { format!("{name}, mm") } else { (*name).into() };
        table = table.number(heading, move |(_, sizes)| cell(sizes[at].1.as_ref()));
    }
    html! { (table.render()) (note(SizeUnit::Mm)) }
}
