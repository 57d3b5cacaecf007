//! Draws a [`Figure`] as SVG: marks, and their names if there is room.

use super::curves;
use super::figure::{Across, Colour, Dash, Figure, Form, Mark, Shape, Size};
use super::frame::{self, Frame, LINE_HEIGHT, TICK_TEXT, axis_labels, grid, roomy};
use super::svg::{Canvas, FONT, GAP, Rect, Svg, along, escape, short, simplify, width_of};
use voidwalk_practice::quantity::significant;

/// Half the width of a symbol.
const SYMBOL: f64 = 4.5;

impl Figure {
    pub fn file(&self) -> String {
        let body = draw(self, Size::Wide, "figure", r#" xmlns="http://www.w3.org/2000/svg""#);
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{body}")
    }

    /// Draws the figure as an element of a page; `id` must differ from the id of any other element there.
    pub(crate) fn inline(&self, id: &str, size: Size) -> String {
        draw(self, size, id, "")
    }
}

fn draw(figure: &Figure, size: Size, id: &str, namespace: &str) -> String {
    let (width, height) = match size {
        Size::Wide => figure.wide,
        Size::Narrow => figure.narrow,
        Size::Sheet => figure.sheet.unwrap_or(figure.wide),
    };
    let mut above = if figure.names_above { named(figure) } else { Vec::new() };
    // Marks without room for a name are named above the frame, which moves it, so all is drawn again.
    let (body, height) = loop {
        let (body, height, homeless) = body(figure, width, height, id, &above);
        if homeless.is_empty() {
            break (body, height);
        }
        above.extend(homeless);
        above.sort_unstable();
    };
    let id = escape(id);
    let mut svg = Svg::default();
    svg.raw(&format!(
        "<svg{namespace} id=\"{id}\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\" aria-labelledby=\"{id}-title {id}-desc\" font-family=\"{FONT}\" \
         font-size=\"{TICK_TEXT}\" fill=\"#1a1a1a\">\n"
    ));
    svg.raw(&format!("<title id=\"{id}-title\">{}</title>\n", escape(&figure.title)));
    svg.raw(&format!("<desc id=\"{id}-desc\">{}</desc>\n", escape(&figure.description)));
    svg.rect(0.0, 0.0, width, height, r##"fill="#ffffff""##);
    svg.raw(&body);
    svg.raw("</svg>\n");
    svg.0
}

fn named(figure: &Figure) -> Vec<usize> {
    (0..figure.marks.len()).filter(|&index| figure.marks[index].label.is_some()).collect()
}

/// Content of the element, its height, and the marks without room for a name. Names of the marks in `above`
/// are placed above the frame.
fn body(figure: &Figure, width: f64, height: f64, id: &str, above: &[usize]) -> (String, f64, Vec<usize>) {
    let mut svg = Svg::default();
    let mut top = key(&mut svg, figure, above, width, 12.0);
    if figure.sieves {
        top += frame::HEIGHT;
    }
    let (frame, height) = roomy(figure, width, height, top);
    grid(&mut svg, &frame);
    axis_labels(&mut svg, &frame, height);
    if figure.sieves {
        frame::sieves(&mut svg, &frame);
    }

    let clip = format!("{}-clip", escape(id));
    let Rect { left, top, right, bottom } = frame.area;
    svg.raw(&format!("<clipPath id=\"{clip}\">\n"));
    svg.rect(left - 1.0, top - 1.0, right - left + 2.0, bottom - top + 2.0, "");
    svg.raw(&format!("</clipPath>\n<g clip-path=\"url(#{clip})\" stroke-linejoin=\"round\">\n"));
    let mut canvas = Canvas::new(frame.area.grown(-3.0));
    let classes = curves::classes(figure);
    for (index, mark) in figure.marks.iter().enumerate() {
        in_group(&mut svg, &classes[index], |svg| draw_mark(svg, &mut canvas, &frame, mark, index));
    }
    svg.raw("</g>\n");
    let paint = r##"fill="none" stroke="#1a1a1a" stroke-width="1.2""##;
    svg.rect(left, top, right - left, bottom - top, paint);

    // Narrow figures are for screens without a pointer.
    let is_pointed_at = width == figure.wide.0;
    if is_pointed_at {
        spots(&mut svg, figure, &classes, &frame);
    }
    let mut symbols = Vec::new();
    for (index, mark) in figure.marks.iter().enumerate() {
        if let Form::Point(at, shape) = mark.form {
            let title = is_pointed_at.then(|| title(figure, mark.label.as_deref(), at));
            in_group(&mut svg, &classes[index], |svg| {
                title.iter().for_each(|title| svg.raw(&format!("<g>{title}\n")));
                symbols.extend(draw_point(svg, &mut canvas, &frame, (at, shape, mark), index));
                title.iter().for_each(|_| svg.raw("</g>\n"));
            });
        }
    }
    canvas.taken.extend(symbols);
    // Points come first, because they have only one anchor.
    let mut order = named(figure);
    order.retain(|index| !above.contains(index));
    order.sort_by_key(|&index| !matches!(figure.marks[index].form, Form::Point(..)));
    let mut homeless = Vec::new();
    for index in order {
        let mark = &figure.marks[index];
        let Some(label) = &mark.label else { continue };
        let mut anchors = anchors(&frame, mark);
        if anchors.is_empty() {
            continue;
        }
        let lines: Vec<&str> = label.lines().collect();
        let wide = lines.iter().map(|line| width_of(line, TICK_TEXT)).fold(0.0, f64::max);
        if let Form::Area(outline) = &mark.form {
            let (left, right) = reach(&frame, outline);
            if right - left < wide + 6.0 {
                homeless.push(index);
                continue;
            }
            // The first choice is right of the anchor: here it is moved to the middle of the area.
            anchors.iter_mut().for_each(|anchor| anchor.0 -= GAP + wide / 2.0);
        }
        match canvas.place(&anchors, wide, LINE_HEIGHT * lines.len() as f64 - 2.0, index) {
            None => homeless.push(index),
            Some(area) => {
                let place = side(&area, &anchors);
                in_group(&mut svg, &classes[index], |svg| name(svg, &lines, &area, place, mark.colour));
            }
        }
    }
    (svg.0, height, homeless)
}

/// Draws the parts of a curve in a group, so that a page can hide it.
fn in_group(svg: &mut Svg, class: &str, draw: impl FnOnce(&mut Svg)) {
    if class.is_empty() {
        return draw(svg);
    }
    svg.raw(&format!("<g{class}>\n"));
    draw(svg);
    svg.raw("</g>\n");
}

/// Writes a name beside its mark, on a light background that separates it from the drawing below.
fn name(svg: &mut Svg, lines: &[&str], area: &Rect, (at, anchor): (f64, &'static str), colour: Colour) {
    let halo = r##"stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke""##;
    let paint = format!("fill=\"{}\" {halo}", colour.text);
    for (row, line) in lines.iter().enumerate() {
        svg.text((at, area.top + 12.0 + row as f64 * LINE_HEIGHT), anchor, line, &paint);
    }
}

/// Text to the left of its curve ends at the curve, so that a narrower font leaves no gap.
fn side(area: &Rect, anchors: &[(f64, f64)]) -> (f64, &'static str) {
    let nearest = anchors.iter().min_by(|a, b| distance(area, **a).total_cmp(&distance(area, **b)));
    match nearest {
        Some((x, _)) if *x >= area.right => (area.right, "end"),
        Some((x, _)) if *x > area.left => ((area.left + area.right) / 2.0, "middle"),
        _ => (area.left, "start"),
    }
}

fn distance(rect: &Rect, point: (f64, f64)) -> f64 {
    let dx = (rect.left - point.0).max(point.0 - rect.right).max(0.0);
    let dy = (rect.top - point.1).max(point.1 - rect.bottom).max(0.0);
    libm::hypot(dx, dy)
}

/// Draws the names above the frame, in as many rows as needed. Returns the top of the frame.
fn key(svg: &mut Svg, figure: &Figure, above: &[usize], width: f64, top: f64) -> f64 {
    const SAMPLE: f64 = 26.0;
    let (mut left, mut row) = (14.0, top);
    for mark in above.iter().map(|&index| &figure.marks[index]) {
        let Some(label) = &mark.label else { continue };
        let label = label.replace('\n', " ");
        let room = SAMPLE + 6.0 + width_of(&label, TICK_TEXT) + 18.0;
        if left > 14.0 && left + room - 18.0 > width - 8.0 {
            (left, row) = (14.0, row + LINE_HEIGHT + 2.0);
        }
        let middle = row + 8.0;
        match mark.form {
            Form::Point(_, shape) => symbol(svg, (left + SAMPLE / 2.0, middle), shape, mark),
            Form::Line(_) | Form::Rule(..) => {
                svg.line((left, middle), (left + SAMPLE, middle), &stroke(mark));
            }
            Form::Area(_) => svg.rect(left, middle - 6.0, SAMPLE, 12.0, &shade(mark)),
            Form::Disc(..) => {}
        }
        let paint = format!("fill=\"{}\"", mark.colour.text);
        svg.text((left + SAMPLE + 6.0, middle + 4.5), "start", &label, &paint);
        left += room;
    }
    if above.is_empty() { top } else { row + LINE_HEIGHT + 8.0 }
}

fn draw_mark(svg: &mut Svg, canvas: &mut Canvas, frame: &Frame<'_>, mark: &Mark, index: usize) {
    match &mark.form {
        Form::Area(outline) => svg.path(&frame.path(outline), true, &shade(mark)),
        Form::Line(points) => {
            let path = frame.path(points);
            match path.as_slice() {
                [] => {}
                [at] => symbol(svg, *at, Shape::Circle, mark),
                _ => svg.path(&path, false, &format!("fill=\"none\" {}", stroke(mark))),
            }
            canvas.draw(&frame.seen(&path), index);
        }
        Form::Rule(across, at) => {
            let Rect { left, top, right, bottom } = frame.area;
            let ends = match across {
                Across::X => frame.x_at(*at).map(|x| ((x, top), (x, bottom))),
                Across::Y => frame.y_at(*at).map(|y| ((left, y), (right, y))),
            };
            if let Some((from, to)) = ends {
                svg.line(from, to, &stroke(mark));
                canvas.draw(&[from, to], index);
            }
        }
        Form::Disc(centre, diameter) => {
            let edge = frame.x_at(centre.0 + diameter);
            if let (Some((x, y)), Some(edge)) = (frame.at(*centre), edge) {
                svg.circle((x, y), 0.5 * (edge - x).abs(), &format!("fill=\"{}\"", mark.colour.line));
            }
        }
        Form::Point(at, _) => {
            if let (true, Some((x, y))) = (mark.drop, frame.at(*at)) {
                let line = Mark::line(Vec::new(), mark.colour).width(1.3).dash(Dash::Dotted);
                svg.line((x, y), (x, frame.area.bottom), &stroke(&line));
                canvas.draw(&[(x, y), (x, frame.area.bottom)], index);
            }
        }
    }
}

/// Draws a symbol and its bars on top of everything without clipping: half a circle on the frame reads badly.
fn draw_point(
    svg: &mut Svg,
    canvas: &mut Canvas,
    frame: &Frame<'_>,
    (at, shape, mark): ((f64, f64), Shape, &Mark),
    index: usize,
) -> Option<Rect> {
    let (x, y) = frame.at(at)?;
    let area = &frame.area;
    if !area.grown(0.5).reaches((x, y)) {
        return None;
    }
    let paint = format!("stroke=\"{}\" stroke-width=\"1.8\"", mark.colour.line);
    let mut bar = |from: (f64, f64), to: (f64, f64), cap: (f64, f64)| {
        svg.line(from, to, &paint);
        for end in [from, to] {
            svg.line((end.0 - cap.0, end.1 - cap.1), (end.0 + cap.0, end.1 + cap.1), &paint);
        }
        canvas.draw(&[from, to], index);
    };
    if let Some((low, high)) = mark.x_interval
        && let (Some(low), Some(high)) = (frame.x_at(low), frame.x_at(high))
    {
        bar((low.clamp(area.left, area.right), y), (high.clamp(area.left, area.right), y), (0.0, 5.0));
    }
    if let Some((low, high)) = mark.y_interval
        && let (Some(low), Some(high)) = (frame.y_at(low), frame.y_at(high))
    {
        bar((x, low.clamp(area.top, area.bottom)), (x, high.clamp(area.top, area.bottom)), (5.0, 0.0));
    }
    symbol(svg, (x, y), shape, mark);
    let reach = SYMBOL + 1.0;
    Some(Rect { left: x - reach, top: y - reach, right: x + reach, bottom: y + reach })
}

fn symbol(svg: &mut Svg, (x, y): (f64, f64), shape: Shape, mark: &Mark) {
    let fill = if mark.filled { mark.colour.line } else { "#ffffff" };
    let paint = format!("fill=\"{fill}\" stroke=\"{}\" stroke-width=\"1.8\"", mark.colour.line);
    let r = SYMBOL;
    match shape {
        Shape::Circle => svg.circle((x, y), r, &paint),
        Shape::Square => svg.rect(x - r + 0.5, y - r + 0.5, 2.0 * r - 1.0, 2.0 * r - 1.0, &paint),
        Shape::Diamond => {
            svg.path(&[(x, y - r - 1.0), (x + r + 1.0, y), (x, y + r + 1.0), (x - r - 1.0, y)], true, &paint)
        }
        Shape::Triangle => {
            svg.path(&[(x, y - r - 0.5), (x + r + 0.5, y + r), (x - r - 0.5, y + r)], true, &paint)
        }
    }
}

fn shade(area: &Mark) -> String {
    format!("fill=\"{}\" fill-opacity=\"{}\"", area.colour.line, short(area.opacity))
}

fn stroke(line: &Mark) -> String {
    let dashes = match line.dash {
        Dash::Solid => "",
        Dash::Dashed => r#" stroke-dasharray="7 4""#,
        Dash::Dotted => r#" stroke-dasharray="1.5 3.5""#,
    };
    let opacity = match line.opacity < 1.0 {
        true => format!(" stroke-opacity=\"{}\"", short(line.opacity)),
        false => String::new(),
    };
    format!("stroke=\"{}\" stroke-width=\"{}\"{dashes}{opacity}", line.colour.line, short(line.width))
}

/// Positions for the name of a mark, in order of preference.
fn anchors(frame: &Frame<'_>, mark: &Mark) -> Vec<(f64, f64)> {
    let Rect { left, top, right, bottom } = frame.area;
    match &mark.form {
        Form::Point(at, _) => frame.at(*at).into_iter().collect(),
        Form::Disc(..) => Vec::new(),
        Form::Rule(across, at) => [0.97, 0.85, 0.7, 0.5, 0.3, 0.15, 0.03]
            .into_iter()
            .filter_map(|share| match across {
                Across::X => frame.x_at(*at).map(|x| (x, bottom - share * (bottom - top))),
                Across::Y => frame.y_at(*at).map(|y| (left + share * (right - left), y)),
            })
            .collect(),
        Form::Line(points) => {
            let path = frame.path(points);
            [0.62, 0.7, 0.54, 0.78, 0.46, 0.86, 0.38, 0.92, 0.3, 0.22, 0.97, 0.14, 0.06]
                .into_iter()
                .filter_map(|share| along(&path, share))
                .filter(|point| frame.area.reaches(*point))
                .collect()
        }
        Form::Area(outline) => {
            let path = frame.seen(&frame.path(outline));
            let (left, right) = reach(frame, outline);
            let highest = path.iter().map(|(_, y)| *y).fold(f64::MAX, f64::min);
            if path.is_empty() { Vec::new() } else { vec![((left + right) / 2.0, highest)] }
        }
    }
}

/// Leftmost and rightmost pixels of an outline inside the frame.
fn reach(frame: &Frame<'_>, outline: &[(f64, f64)]) -> (f64, f64) {
    let seen = frame.seen(&frame.path(outline));
    seen.iter().fold((f64::MAX, f64::MIN), |(least, most), (x, _)| (least.min(*x), most.max(*x)))
}

/// Maximum number of spots on a line, and their minimum spacing (pixels).
const SPOTS: usize = 24;
const APART: f64 = 14.0;

/// Tooltip of a point.
fn title(figure: &Figure, label: Option<&str>, (x, y): (f64, f64)) -> String {
    let name = label.map_or(String::new(), |label| format!("{}: ", label.replace('\n', " ")));
    // An axis of rows has no label: its value is a position. After its first clause a label describes the
    // marks along the axis, not a value.
    let value = |label: &str, value: f64| match label.split([';', '\n']).next().unwrap_or_default() {
        "" => String::new(),
        label => format!("{label} {}", significant(value)),
    };
    let values = [value(&figure.x.label, x), value(&figure.y.label, y)];
    let values: Vec<&str> = values.iter().map(String::as_str).filter(|text| !text.is_empty()).collect();
    format!("<title>{}</title>", escape(&format!("{name}{}", values.join("; "))))
}

/// Draws the spots with tooltips, those of each mark in a group of its class.
fn spots(svg: &mut Svg, figure: &Figure, classes: &[String], frame: &Frame<'_>) {
    for (mark, class) in figure.marks.iter().zip(classes) {
        let (Form::Line(points), Some(label)) = (&mark.form, mark.label.as_deref()) else { continue };
        let drawn =
            |&point: &(f64, f64)| Some((point, frame.at(point).filter(|pixel| frame.area.reaches(*pixel))?));
        let seen: Vec<((f64, f64), (f64, f64))> = points.iter().filter_map(drawn).collect();
        let few = simplify(seen.iter().map(|(_, pixel)| *pixel)).len().clamp(2, SPOTS);
        let stride = seen.len().div_ceil(few).max(1);
        let mut last: Option<(f64, f64)> = None;
        svg.raw(&format!("<g{class}>\n"));
        for (point, (x, y)) in seen.into_iter().step_by(stride) {
            if last.is_some_and(|(a, b)| libm::hypot(x - a, y - b) < APART) {
                continue;
            }
            last = Some((x, y));
            svg.raw(&format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"7\" fill=\"none\" pointer-events=\"all\">{}</circle>\n",
                short(x),
                short(y),
                title(figure, Some(label), point)
            ));
        }
        svg.raw("</g>\n");
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, BLUE};
    use super::*;

    /// The first line of the axis label gives the words.
    #[test]
    fn a_pointer_shows_the_place_of_a_mark() {
        let x = Axis::log("Times the grains; below, grains per void", 0.5, 2.0);
        let mut figure = Figure::new("title", "what", x, Axis::linear("Eroded (%)", 0.0, 100.0));
        let line = Mark::line(vec![(1.0, 20.0), (2.0, 60.0)], BLUE);
        figure.add(line.label("first"));
        figure.add(Mark::point(1.0, 20.0, BLUE, Shape::Circle));
        let drawn = figure.inline("one", Size::Wide);
        for values in ["Times the grains 1.00; Eroded (%) 20.0", "Times the grains 2.00; Eroded (%) 60.0"] {
            assert!(drawn.contains(&format!("<title>first: {values}</title>")), "{values}: {drawn}");
        }
        assert!(drawn.contains("<title>Times the grains 1.00; Eroded (%) 20.0</title>"), "{drawn}");
        // A narrow figure is for a screen without a pointer.
        assert!(!figure.inline("two", Size::Narrow).contains("first: "));
    }
}
