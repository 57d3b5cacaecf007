//! Curves that a reader can hide: a named line or kind of symbol, and the marks in its colour, if no other
//! has that colour. Rules, limits and named areas stay: a threshold, or the range in which a verdict holds,
//! cannot be hidden.

use super::figure::{Colour, Figure, Form, Mark};

/// Maximum number of curves that the style of a page can hide; a figure with more hides none.
const MOST: usize = 16;

impl Figure {
    /// Names of the curves that a reader can hide, in the order of their classes `curve-1` ...; empty for
    /// fewer than two.
    pub(crate) fn curves(&self) -> Vec<String> {
        let mut names = Vec::new();
        for name in self.marks.iter().filter_map(|mark| curve_of(self, mark)) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        if (2..=MOST).contains(&names.len()) { names } else { Vec::new() }
    }
}

/// Class of each mark, as an attribute; empty for marks that stay.
pub(super) fn classes(figure: &Figure) -> Vec<String> {
    let names = figure.curves();
    let class = |mark: &Mark| {
        let name = curve_of(figure, mark)?;
        let index = names.iter().position(|other| *other == name)?;
        Some(format!(" class=\"curve-{}\"", index + 1))
    };
    figure.marks.iter().map(|mark| class(mark).unwrap_or_default()).collect()
}

fn curve_of(figure: &Figure, mark: &Mark) -> Option<String> {
    let (label, colour) = look(mark)?;
    let line = || only_name(figure, colour, |mark| matches!(mark.form, Form::Line(_)));
    let any = || only_name(figure, colour, |_| true);
    match (&mark.form, label) {
        // A value marked on a line is hidden with the line.
        (Form::Point(..), Some(name)) => line().or(Some(name)),
        (_, Some(name)) => Some(name),
        (Form::Area(_), None) => line(),
        (_, None) => line().or_else(any),
    }
}

/// Name that belongs to a colour, if these marks have only one.
fn only_name(figure: &Figure, colour: Colour, is_meant: fn(&Mark) -> bool) -> Option<String> {
    let looks = figure.marks.iter().filter(|mark| is_meant(mark)).filter_map(look);
    let mut names = looks.filter(|(_, other)| *other == colour).filter_map(|(name, _)| name);
    let first = names.next()?;
    names.all(|name| name == first).then_some(first)
}

/// Name and colour of a mark that can be hidden.
fn look(mark: &Mark) -> Option<(Option<String>, Colour)> {
    let can_be_hidden = match mark.form {
        Form::Line(_) => !mark.stays,
        Form::Area(_) => mark.label.is_none(),
        Form::Point(..) => true,
        Form::Rule(..) | Form::Disc(..) => false,
    };
    can_be_hidden.then(|| (mark.label.as_ref().map(|label| label.replace('\n', " ")), mark.colour))
}

#[cfg(test)]
mod tests {
    use super::super::{Across, Axis, BLACK, BLUE, GREEN, GREY, Shape, Size};
    use super::*;

    fn figure() -> Figure {
        let axis = || Axis::linear("x", 0.0, 10.0);
        Figure::new("t", "d", axis(), axis())
    }

    fn line(colour: Colour) -> Mark {
        Mark::line(vec![(0.0, 0.0), (9.0, 9.0)], colour)
    }

    #[test]
    fn what_is_drawn_in_a_curves_colour_goes_with_it_and_a_threshold_stays() {
        let mut figure = figure();
        figure.add(line(BLUE).width(0.8));
        figure.add(Mark::area(vec![(0.0, 0.0), (9.0, 9.0), (9.0, 0.0)], GREEN, 0.2));
        figure.add(Mark::rule(Across::Y, 7.5, BLUE).label("7.5 %"));
        figure.add(line(BLUE).label("first\nrun"));
        figure.add(line(GREEN).label("second run"));
        figure.add(Mark::point(1.0, 1.0, GREEN, Shape::Circle).label("D15"));
        figure.add(line(GREY));
        figure.add(line(BLACK).stays().label("limit"));
        figure.add(Mark::area(vec![(0.0, 0.0), (9.0, 0.0), (9.0, 9.0)], GREEN, 0.1).label("no erosion"));
        assert_eq!(figure.curves(), ["first run", "second run"]);
        let (one, two) = (r#" class="curve-1""#, r#" class="curve-2""#);
        assert_eq!(classes(&figure), [one, two, "", one, two, two, "", "", ""]);
        // Lines, their names, tooltips and the symbol: all parts of each curve, and no part of the rule.
        let drawn = figure.inline("one", Size::Wide);
        let group = |class: &str| -> Vec<String> {
            let begin = format!("<g{class}>");
            let parts = drawn.split(&begin).skip(1);
            parts.map(|part| part.split("</g>").next().unwrap().to_owned()).collect()
        };
        let (one, two) = (group(one), group(two));
        assert!(one.iter().all(|part| !part.contains("7.5")) && two.len() > 3, "{drawn}");
        assert!(one.iter().any(|part| part.contains(">first</text>")));
        assert!(two.iter().any(|part| part.contains("<title>second run: ")));
        assert!(two.iter().any(|part| part.contains(">D15</text>")));
    }

    #[test]
    fn one_curve_cannot_be_hidden_nor_can_too_many() {
        let mut one = figure();
        one.add(line(BLUE).label("only"));
        assert!(one.curves().is_empty());
        let mut many = figure();
        for index in 0..=MOST {
            many.add(line(BLACK).label(&format!("curve {index}")));
        }
        assert!(many.curves().is_empty() && !many.inline("m", Size::Wide).contains("curve-"));
        many.marks.pop();
        assert_eq!(many.curves().len(), MOST);
    }
}
