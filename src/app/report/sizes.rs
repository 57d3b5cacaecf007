//! The sizes of soils that engineers look for, D5 to D95, Cu, Cc, fines and group, as a table.

use maud::{Markup, html};

use super::quantity::SizeUnit;
use super::shell::clean;
use super::table::Table;
use crate::outcome::table::Columns;
use voidwalk_practice::soil_sizes::sizes_of;

/// A soil: its name in the table, and its rows of size and percent finer.
pub(super) struct SizedSoil<'a> {
    /// Name in the table.
    pub name: String,
    /// Size, and percent finer by mass.
    pub rows: &'a [[f64; 2]],
}

impl<'a> SizedSoil<'a> {
    pub(super) fn new(name: impl Into<String>, rows: &'a [[f64; 2]]) -> Self {
        Self { name: name.into(), rows }
    }
}

/// The name of a soil, and its sizes by their names.
type SoilRow<'a> = (&'a String, Vec<(&'static str, Option<String>)>);

/// Note below such a table.
fn note(unit: SizeUnit) -> Markup {
    html! { p.small {
        @if unit != SizeUnit::D0f {
            "Group by ASTM D2487, finer than 75 mm. "
        }
        "–: not known."
    } }
}

/// Sizes of a few soils, one column each.
pub(super) fn of_few(soils: &[SizedSoil], unit: SizeUnit) -> Markup {
    let sizes: Vec<_> = soils.iter().map(|soil| sizes_of(soil.rows, unit)).collect();
    let rows: Vec<usize> = (0..sizes.first().map_or(0, Vec::len)).collect();
    let mut columns = Columns::default().name("size", unit.name(), |row: &usize| sizes[0][*row].0);
    for (at, (soil, sizes)) in soils.iter().zip(&sizes).enumerate() {
        columns = columns.number(format!("soil_{at}"), &*soil.name, |row| sizes[*row].1.clone());
    }
    html! { div.sizes { (Table::of(&rows, columns)) (note(unit)) } }
}

/// Sizes of many soils, one row each, in mm.
pub(super) fn of_many(soils: &[SizedSoil]) -> Markup {
    let sizes: Vec<_> = soils.iter().map(|soil| (&soil.name, sizes_of(soil.rows, SizeUnit::Mm))).collect();
    let Some((_, first)) = sizes.first() else { return html! {} };
    let mut columns = Columns::default().name("soil", "Soil", |row: &SoilRow| row.0.clone());
    for (at, (name, _)) in first.iter().enumerate() {
        let heading = if name.starts_with('D') { format!("{name}, mm") } else { (*name).into() };
        columns = columns.number(format!("size_{at}"), heading, move |(_, sizes)| sizes[at].1.clone());
    }
    let table = Table::of(&sizes, columns).class("cases");
    html! { (table.showing("soil", |(name, _)| html! { bdi { (clean(name)) } })) (note(SizeUnit::Mm)) }
}
