//! Tables of a page: rows with the columns that describe them ([`Columns`]), which a page may decorate; and
//! tables of the sizes of soils.

use super::shell::clean;
use crate::outcome::table::{ColumnKind, Columns, Emphasis, PageColumn, Shown};
use maud::{Markup, Render, html};
use std::fmt::Display;
use voidwalk_practice::page::sizes_of;
use voidwalk_practice::quantity::{SizeUnit, whole};

/// Table that scrolls by itself if the page is too narrow for it.
pub(super) struct Table<'a, T> {
    rows: Vec<&'a T>,
    columns: Vec<TableColumn<'a, T>>,
    class: Option<&'static str>,
    more: Markup,
}

struct TableColumn<'a, T> {
    name: String,
    heading: Markup,
    kind: ColumnKind,
    cell: Box<dyn Fn(&T) -> Markup + 'a>,
    /// True if the page shows other cells than those of the description.
    is_decorated: bool,
}

impl<'a, T: 'a> Table<'a, T> {
    pub(super) fn new(rows: impl IntoIterator<Item = &'a T>, columns: Columns<'a, T>) -> Self {
        let column = |PageColumn { name, heading, kind, cell }: PageColumn<'a, T>| {
            let cell = Box::new(move |row: &T| markup(&cell(row)));
            TableColumn { name, heading: markup(&heading), kind, cell, is_decorated: false }
        };
        let columns = columns.of_page().map(column).collect();
        Self { rows: rows.into_iter().collect(), columns, class: None, more: html! {} }
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
        let column = self.columns.iter_mut().find(|column| column.name == name);
        let column = column.unwrap_or_else(|| panic!("{name} is no column"));
        (column.cell, column.is_decorated) = (Box::new(cell), true);
        self
    }

    /// True unless it is a column of text that is empty in every row.
    fn is_shown(&self, column: &TableColumn<T>) -> bool {
        column.kind != ColumnKind::Text
            || column.is_decorated
            || self.rows.is_empty()
            || self.rows.iter().any(|row| !(column.cell)(row).0.is_empty())
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

impl<'a, T: 'a> Render for Table<'a, T> {
    fn render(&self) -> Markup {
        let columns: Vec<_> = self.columns.iter().filter(|column| self.is_shown(column)).collect();
        html! {
            div.scroll { table class=[self.class] {
                thead { tr { @for column in &columns { @match column.kind {
                    ColumnKind::Number => th.n { (column.heading) },
                    _ => th { (column.heading) },
                } } } }
                tbody {
                    @for row in &self.rows { tr { @for column in &columns { @match column.kind {
                        ColumnKind::Name => th { ((column.cell)(row)) },
                        ColumnKind::Text => td { ((column.cell)(row)) },
                        ColumnKind::Number => td.n { ((column.cell)(row)) },
                    } } } }
                    (self.more)
                }
            } }
        }
    }
}

/// Soil: its name in the table, and its rows of size and percent finer by mass.
pub(super) type SizedSoil<'a> = (String, &'a [[f64; 2]]);

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
    let sizes: Vec<_> = soils.iter().map(|(_, rows)| sizes_of(rows, unit)).collect();
    let rows: Vec<usize> = (0..sizes.first().map_or(0, Vec::len)).collect();
    let mut columns = Columns::default().name("size", unit.name(), |row: &usize| sizes[0][*row].0);
    for (at, ((soil, _), sizes)) in soils.iter().zip(&sizes).enumerate() {
        columns = columns.number(format!("soil_{at}"), soil, |row| sizes[*row].1.clone());
    }
    html! { div.sizes { (Table::new(&rows, columns)) (note(unit)) } }
}

/// Sizes of many soils, one row each, in mm.
pub(super) fn of_many(soils: &[SizedSoil]) -> Markup {
    type Row<'a> = (&'a String, Vec<(&'static str, Option<String>)>);
    let sizes: Vec<Row> = soils.iter().map(|(name, rows)| (name, sizes_of(rows, SizeUnit::Mm))).collect();
    let Some((_, first)) = sizes.first() else { return html! {} };
    let mut columns = Columns::default().name("soil", "Soil", |row: &Row| row.0.clone());
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
