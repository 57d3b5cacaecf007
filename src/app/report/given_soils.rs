//! Soils for which a specification is made: drawn on the form of gradations, with the band if there is one,
//! and in an appendix with their sizes and their gradations.

use maud::{Markup, html};

use super::appendix::{BETWEEN, TabledSoil, gradations};
use super::figures::{Area, Axis, BLUE, Dash, Figure, GREEN, Line, VERMILLION, positive_range, shorten};
use super::names::is_named;
use super::quantity::SizeUnit;
use super::shell::Drawn;
use super::sizes::{SizedSoil, of_few, of_many};
use voidwalk_practice::design::Specification;
use voidwalk_practice::design::specification::{SizeBand, SpecifiedCurve};

/// The file that has every row.
const RECORD: &str = "specification.json";

/// Greatest number of curves of a base that are drawn with every row shown.
const CURVES: usize = 12;

/// A curve of the base.
struct GivenCurve<'a> {
    name: &'a str,
    /// Size (mm) and percent finer by mass.
    sampled: &'a [[f64; 2]],
    /// Size and percent finer after regrading; empty if it is not regraded.
    regraded: &'a [[f64; 2]],
}

/// The soils of a specification.
pub(super) struct GivenSoils<'a> {
    curves: Vec<GivenCurve<'a>>,
    inches: bool,
}

impl<'a> GivenSoils<'a> {
    pub(super) fn of_specification(specification: &'a Specification) -> Self {
        Self {
            curves: specification.curves.iter().map(GivenCurve::of).collect(),
            inches: specification.inches,
        }
    }

    /// Heading of the appendix.
    pub(super) fn heading(&self) -> &'static str {
        match self.curves.len() {
            1 => "Appendix: the gradation of the base",
            _ => "Appendix: the gradations",
        }
    }

    /// Sizes and gradations of every soil; empty if no soil is known.
    pub(super) fn appendix(&self) -> Markup {
        if self.curves.is_empty() {
            return html! {};
        }
        let unit = SizeUnit::of(false, self.inches);
        let drawn = &self.curves[..self.curves.len().min(CURVES)];
        html! {
            p.small {
                "Percent finer by mass, as sampled"
                @if self.curves.iter().any(|curve| !curve.regraded.is_empty()) {
                    " and as regraded for the rules of practice"
                }
                "; " (BETWEEN)
            }
            @if self.curves.len() > 1 { (of_many(&self.sized())) } @else { (of_few(&self.sized(), unit)) }
            (gradations(&self.tabled(drawn), unit, RECORD))
            @if drawn.len() < self.curves.len() {
                p.small { "The other " (self.curves.len() - drawn.len()) " curves are in " (RECORD) "." }
            }
        }
    }

    /// Every soil, for a table of sizes.
    fn sized(&self) -> Vec<SizedSoil<'a>> {
        let several = self.curves.len() > 1;
        let mut soils = Vec::new();
        for curve in &self.curves {
            let (sampled, regraded) = match (several, curve.regraded.is_empty()) {
                (false, true) => ("Base".into(), String::new()),
                (false, false) => ("Base, sampled".into(), "regraded".into()),
                (true, _) => (curve.name.to_owned(), format!("{}, regraded", curve.name)),
            };
            soils.push(SizedSoil::new(sampled, curve.sampled));
            if !curve.regraded.is_empty() {
                soils.push(SizedSoil::new(regraded, curve.regraded));
            }
        }
        soils
    }

    /// Every soil with these curves of the base, for the tables of all rows.
    fn tabled(&self, curves: &[GivenCurve<'a>]) -> Vec<TabledSoil<'a>> {
        let several = self.curves.len() > 1;
        let mut soils = Vec::new();
        let named = |kind: &str, name: &'a str| if is_named(kind, name) { name } else { "" };
        for curve in curves {
            let name = if several { curve.name } else { named("base", curve.name) };
            soils.push(TabledSoil { kind: "Base, as sampled", name, rows: curve.sampled });
            if !curve.regraded.is_empty() {
                soils.push(TabledSoil { kind: "Base, regraded", name, rows: curve.regraded });
            }
        }
        soils
    }

    /// The soils on the form of gradations, with both sides of a band, whose D15F is in `words`; `None` if
    /// there is nothing to draw.
    pub(super) fn figure(&self, band: Option<&SizeBand>, words: Option<&str>) -> Option<Drawn> {
        let drawn = &self.curves[..self.curves.len().min(CURVES)];
        let sides = band.map(|band| (band.drawn_fine_side(), &band.coarse_side));
        let bases = drawn.iter().flat_map(|curve| curve.sampled.iter().chain(curve.regraded));
        let of_sides = sides.iter().flat_map(|(fine, coarse)| fine.iter().chain(*coarse));
        let sizes: Vec<f64> = bases.chain(of_sides).map(|row| row[0]).collect();
        if sizes.is_empty() {
            return None;
        }
        let (low, high) = positive_range(sizes.into_iter());
        let (title, what) = match band {
            Some(_) => (
                "Band of the filter",
                "Percent finer against size for the base and for both sides of the band of the filter",
            ),
            None => ("Gradations", "Percent finer against size for the soils that were given"),
        };
        let (x, y) = (Axis::log("Size (mm)", low, high), Axis::percent("Percent finer by mass (%)"));
        let mut figure = Figure::new(title, what, "", x, y).sizes((720.0, 460.0), (358.0, 400.0)).sieves();
        if let Some((fine, coarse)) = &sides {
            let outline = fine.iter().chain(coarse.iter().rev()).map(|&[x, y]| (x, y)).collect();
            figure.add(Area::new(outline, GREEN, 0.15).label("band"));
            figure.add(Line::of_rows(fine, GREEN).width(2.6).label("fine side"));
            figure.add(Line::of_rows(coarse, BLUE).width(2.6).label("coarse side"));
        }
        for curve in drawn {
            curve.draw(&mut figure, if self.curves.len() == 1 { "base" } else { curve.name });
        }
        Some(Drawn::new("specification", figure, self.caption(band.is_some(), words, drawn.len())))
    }

    fn caption(&self, has_band: bool, words: Option<&str>, drawn: usize) -> String {
        let mut text = match has_band {
            true => format!(
                "The band of the filter for this base, as its limits at the sieves have it{}. Its control \
                 points are joined by straight lines; above 60 % finer both sides go on straight, and below \
                 its D5 the fine side runs level: no more than 5 % may be finer.",
                words.map_or(String::new(), |words| format!(": {words}"))
            ),
            false => "Gradations by mass. There is no band to draw.".to_owned(),
        };
        let left_out = self.curves.len() - drawn;
        if left_out > 0 {
            text += &format!(" {left_out} more curves of the base are not drawn.");
        }
        text
    }
}

impl<'a> GivenCurve<'a> {
    fn of(curve: &'a SpecifiedCurve) -> Self {
        Self { name: &curve.curve, sampled: &curve.gradation, regraded: &curve.regraded }
    }

    fn draw(&self, figure: &mut Figure, name: &str) {
        let name = shorten(name, 24);
        match self.regraded.is_empty() {
            true => figure.add(Line::of_rows(self.sampled, VERMILLION).label(&name)),
            false => {
                let sampled = Line::of_rows(self.sampled, VERMILLION).width(1.4).dash(Dash::Dashed);
                figure.add(sampled.label(&format!("{name},\nas sampled")));
                figure.add(Line::of_rows(self.regraded, VERMILLION).label(&format!("{name},\nregraded")));
            }
        }
    }
}
