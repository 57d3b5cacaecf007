//! Tables of a page: rows with the columns that describe them ([`Columns`]), which a page may decorate; and
//! tables of the sizes of soils.

use super::shell::clean;
use crate::outcome::table::{ColumnKind, Columns, Emphasis, PageColumn, Shown};
use maud::{Markup, Render, html};
use std::collections::BTreeMap;
use std::fmt::Display;
use voidwalk_practice::page::sizes_of;
use voidwalk_practice::quantity::{SizeUnit, whole};

/// Markup that a page shows in the cells of a column instead of its description.
type Decoration<'a, T> = Box<dyn Fn(&T) -> Markup + 'a>;

/// Table that scrolls by itself if the page is too narrow for it.
pub(super) struct Table<'a, T> {
    rows: Vec<&'a T>,
    columns: Vec<PageColumn<'a, T>>,
    /// Decorations by the positions of their columns.
    decorations: BTreeMap<usize, Decoration<'a, T>>,
    class: Option<&'static str>,
    more: Markup,
}

impl<'a, T> Table<'a, T> {
    pub(super) fn new(rows: impl IntoIterator<Item = &'a T>, columns: Columns<'a, T>) -> Self {
        let (rows, columns) = (rows.into_iter().collect(), columns.of_page().collect());
        Self { rows, columns, decorations: BTreeMap::new(), class: None, more: html! {} }
    }

    pub(super) fn class(self, class: &'static str) -> Self {
        Self { class: Some(class), ..self }
    }

    /// Adds a row at the end.
    pub(super) fn more(self, more: Markup) -> Self {
        Self { more, ..self }
    }

    /// Shows this in the cells of the first column with this name; a factor of a campaign may have the name
    /// of another column.
    pub(super) fn showing(mut self, name: &str, cell: impl Fn(&T) -> Markup + 'a) -> Self {
        let place = self.columns.iter().position(|column| column.name == name);
        self.decorations.insert(place.unwrap_or_else(|| panic!("{name} is no column")), Box::new(cell));
        self
    }

    fn cell(&self, place: usize, row: &T) -> Markup {
        match self.decorations.get(&place) {
            Some(cell) => cell(row),
            None => markup(&(self.columns[place].cell)(row)),
        }
    }

    /// Columns with their positions, without text columns that are empty in every row.
    fn filled(&self) -> Vec<(usize, &PageColumn<'a, T>)> {
        let is_filled = |(place, column): &(usize, &PageColumn<T>)| {
            column.kind != ColumnKind::Text
                || self.decorations.contains_key(place)
                || self.rows.is_empty()
                || self.rows.iter().any(|row| (column.cell)(row) != Shown::default())
        };
        self.columns.iter().enumerate().filter(is_filled).collect()
    }
}

fn markup(shown: &Shown) -> Markup {
    html! {
        @match shown.emphasis {
            Some(emphasis) => {
                @let (class, sign) = look(emphasis);
                span class=(class) { (sign) (clean(&shown.text)) }
            }
            None => (clean(&shown.text)),
        }
        @for line in &shown.below { br; span.small { (clean(line)) } }
    }
}

/// Style class of an emphasised text, and the text before it.
fn look(emphasis: Emphasis) -> (String, &'static str) {
    match emphasis {
        Emphasis::Doubt => ("amber".into(), ""),
        Emphasis::Kept(true) => ("keeps".into(), "✓ "),
        Emphasis::Kept(false) => ("breaks".into(), "✗ "),
        Emphasis::Run(run) => (format!("run-{run}"), ""),
        Emphasis::Whole => ("whole".into(), ""),
    }
}

impl<T> Render for Table<'_, T> {
    fn render(&self) -> Markup {
        let columns = self.filled();
        html! {
            div.scroll { table class=[self.class] {
                thead { tr { @for (_, column) in &columns { @match column.kind {
                    ColumnKind::Number => th.n { (markup(&column.heading)) },
                    _ => th { (markup(&column.heading)) },
                } } } }
                tbody {
                    @for row in &self.rows { tr { @for (place, column) in &columns { @match column.kind {
                        ColumnKind::Name => th { (self.cell(*place, row)) },
                        ColumnKind::Text => td { (self.cell(*place, row)) },
                        ColumnKind::Number => td.n { (self.cell(*place, row)) },
                    } } } }
                    (self.more)
                }
            } }
        }
    }
}

/// Soil: its name in the table, and its rows of size and percent finer by mass.
pub(super) struct SizedSoil<'a> {
    name: String,
    rows: &'a [[f64; 2]],
}

impl<'a> SizedSoil<'a> {
    pub(super) fn new(name: impl Into<String>, rows: &'a [[f64; 2]]) -> Self {
        Self { name: name.into(), rows }
    }
}

/// Name of a soil, and its sizes by their names.
type SoilRow<'a> = (&'a String, Vec<(&'static str, Option<String>)>);

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
    html! { div.sizes { (Table::new(&rows, columns)) (note(unit)) } }
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
    let table = Table::new(&sizes, columns).class("cases");
    html! { (table.showing("soil", |(name, _)| html! { bdi { (clean(name)) } })) (note(SizeUnit::Mm)) }
}

/// Value in words, or a text for a missing one.
pub(super) fn known<T, R: Display>(value: Option<T>, words: impl FnOnce(T) -> R) -> String {
    value.map_or_else(|| "not given".to_owned(), |value| words(value).to_string())
}

pub(super) fn counts<const N: usize>(numbers: [u64; N]) -> String {
    numbers.map(|number| whole(number).to_string()).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::table::TableCell;

    #[test]
    fn a_heading_stands_over_its_cells_and_markup_in_texts_is_escaped() {
        let columns = Columns::default().name("name", "Name", |row: &(&'static str, f64)| row.0).number(
            "value",
            "".shown(),
            |row| format!("{:.2}", row.1),
        );
        let table = Table::new(&[("<b>", 0.25)], columns).class("study");
        let expected = "<div class=\"scroll\"><table class=\"study\"><thead><tr><th>Name</th><th \
                        class=\"n\"></th></tr></thead><tbody><tr><th>&lt;b&gt;</th><td \
                        class=\"n\">0.25</td></tr></tbody></table></div>";
        assert_eq!(table.render().into_string(), expected);
    }

    #[test]
    fn columns_stand_in_their_places_and_empty_texts_are_left_out() {
        let columns = Columns::default()
            .name("case", "Case", |row: &(&str, u64)| row.0.to_owned())
            .text("none", "Nothing", |_| "")
            .number("count", "Count".shown().emphasised(Emphasis::Run(2)), |row| row.1)
            .place(-1)
            .text("met", "Met", |_| {
                "met".shown().emphasised(Emphasis::Kept(false)).below("in part".to_owned())
            })
            .column("hidden", |row| row.1);
        let rows = [("<a>", 12_345)];
        let table = Table::new(&rows, columns).showing("case", |row| html! { i { (row.0) } });
        let text = table.render().into_string();
        let head = "<th class=\"n\"><span class=\"run-2\">Count</span></th><th>Case</th><th>Met</th></tr>";
        let row = "<td class=\"n\">12\u{202f}345</td><th><i>&lt;a&gt;</i></th><td><span \
                   class=\"breaks\">✗ met</span><br><span class=\"small\">in part</span></td></tr>";
        assert!(text.contains(head) && text.contains(row), "{text}");
    }
}
