//! Tables of a page: a column is its heading and what it shows of a row. Where the table is a file, too, both
//! come from one description ([`Columns`]), which a page may decorate.

use maud::{Markup, Render, html};

use super::shell::clean;
use crate::outcome::table::{Columns, Shown};

/// Where the text of a column stands.
#[derive(Clone, Copy)]
enum Kind {
    /// Left, as the name of its row.
    Name,
    /// Left.
    Text,
    /// Right.
    Number,
}

/// A column: its heading, and its cell of a row.
struct Column<'a, T> {
    /// Its name in a file, where it has one.
    name: String,
    kind: Kind,
    heading: Markup,
    cell: Box<dyn Fn(&T) -> Markup + 'a>,
}

/// A table, which scrolls by itself where the page is too narrow for it.
pub(super) struct Table<'a, T> {
    rows: Vec<&'a T>,
    columns: Vec<Column<'a, T>>,
    class: Option<&'static str>,
    more: Markup,
}

impl<'a, T> Table<'a, T> {
    /// A table of these rows, without a column.
    pub(super) fn of(rows: impl IntoIterator<Item = &'a T>) -> Self {
        Self { rows: rows.into_iter().collect(), columns: Vec::new(), class: None, more: html! {} }
    }

    /// With a class of the style.
    pub(super) fn class(self, class: &'static str) -> Self {
        Self { class: Some(class), ..self }
    }

    /// With a further row at its end.
    pub(super) fn more(self, more: Markup) -> Self {
        Self { more, ..self }
    }

    /// With the described columns of a row or of a part of it; a column that is empty in every row is left
    /// out.
    pub(super) fn columns<P: 'a>(mut self, of: Columns<'a, P>, part: impl Fn(&T) -> &P + Copy + 'a) -> Self {
        for column in of.of_page() {
            let shown = |row: &&&T| column.is_number || (column.cell)(part(row)) != Shown::default();
            if self.rows.is_empty() || self.rows.iter().any(|row| shown(&row)) {
                let kind = if column.is_number { Kind::Number } else { Kind::Text };
                self =
                    self.column(kind, clean(&column.heading), move |row| markup(&(column.cell)(part(row))));
                self.columns.last_mut().expect("just added").name = column.name;
            }
        }
        self
    }

    /// The cells of a described column show this instead.
    pub(super) fn showing(mut self, name: &str, cell: impl Fn(&T) -> Markup + 'a) -> Self {
        self.described(name).cell = Box::new(cell);
        self
    }

    /// The cells of a described column show this instead, and name their rows.
    pub(super) fn named_by(mut self, name: &str, cell: impl Fn(&T) -> Markup + 'a) -> Self {
        self.described(name).kind = Kind::Name;
        self.showing(name, cell)
    }

    fn described(&mut self, name: &str) -> &mut Column<'a, T> {
        self.columns.iter_mut().find(|column| column.name == name).expect("a column that is described")
    }

    /// With a column of the names of the rows.
    pub(super) fn name<R: Render>(self, heading: impl Render, cell: impl Fn(&T) -> R + 'a) -> Self {
        self.column(Kind::Name, heading, cell)
    }

    /// With a column of texts.
    pub(super) fn text<R: Render>(self, heading: impl Render, cell: impl Fn(&T) -> R + 'a) -> Self {
        self.column(Kind::Text, heading, cell)
    }

    /// With a column of numbers.
    pub(super) fn number<R: Render>(self, heading: impl Render, cell: impl Fn(&T) -> R + 'a) -> Self {
        self.column(Kind::Number, heading, cell)
    }

    fn column<R: Render>(mut self, kind: Kind, heading: impl Render, cell: impl Fn(&T) -> R + 'a) -> Self {
        let cell = Box::new(move |row: &T| cell(row).render());
        self.columns.push(Column { name: String::new(), kind, heading: heading.render(), cell });
        self
    }
}

fn markup(shown: &Shown) -> Markup {
    html! {
        @if shown.is_doubt { span.amber { (clean(&shown.text)) } } @else { (clean(&shown.text)) }
        @for line in &shown.below { br; span.small { (clean(line)) } }
    }
}

impl<T> Render for Table<'_, T> {
    fn render(&self) -> Markup {
        html! {
            div.scroll { table class=[self.class] {
                thead { tr { @for column in &self.columns { @match column.kind {
                    Kind::Number => th.n { (column.heading) },
                    _ => th { (column.heading) },
                } } } }
                tbody {
                    @for row in &self.rows { tr { @for column in &self.columns { @match column.kind {
                        Kind::Name => th { ((column.cell)(row)) },
                        Kind::Text => td { ((column.cell)(row)) },
                        Kind::Number => td.n { ((column.cell)(row)) },
                    } } } }
                    (self.more)
                }
            } }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_stands_over_its_cells_and_markup_in_texts_is_escaped() {
        let table = Table::of(&[("<b>", 0.25)])
            .class("study")
            .name("Name", |row| row.0)
            .number("Value", |row| format!("{:.2}", row.1));
        let expected = "<div class=\"scroll\"><table class=\"study\"><thead><tr><th>Name</th><th \
                        class=\"n\">Value</th></tr></thead><tbody><tr><th>&lt;b&gt;</th><td \
                        class=\"n\">0.25</td></tr></tbody></table></div>";
        assert_eq!(table.render().into_string(), expected);
    }

    #[test]
    fn described_columns_stand_in_their_places_and_empty_ones_are_left_out() {
        let columns = Columns::default()
            .column("case", |row: &(&str, u64)| row.0.to_owned())
            .headed("Case")
            .column("none", |_| "")
            .headed("Nothing")
            .column("count", |row| row.1)
            .headed("Count")
            .place(-1)
            .column("hidden", |row| row.1);
        let rows = [("<a>", 12_345)];
        let table =
            Table::of(&rows).columns(columns, |row| row).named_by("case", |row| html! { i { (row.0) } });
        let text = table.render().into_string();
        assert!(text.contains("<tr><th class=\"n\">Count</th><th>Case</th></tr>"), "{text}");
        assert!(text.contains("<td class=\"n\">12\u{202f}345</td><th><i>&lt;a&gt;</i></th></tr>"), "{text}");
    }
}
