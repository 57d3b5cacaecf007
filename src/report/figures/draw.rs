//! From a [`Figure`] to SVG: margins, grid, marks, names.

use super::axis::{Axis, Tick};
use super::colour::Colour;
use super::curves;
use super::figure::{Figure, Naming, Size};
use super::hover;
use super::marks::{Across, Dash, Line, Mark, Point, Shape};
use super::path::{along, simplify};
use super::place::{Canvas, GAP, Rect};
use super::sieves;
use super::svg::{Anchor, FONT, Svg, escape, short, width_of, wrap};

const TICK_TEXT: f64 = 13.0;
const LABEL_TEXT: f64 = 14.0;
const LINE_HEIGHT: f64 = 17.0;
const SYMBOL: f64 = 4.5;
/// The narrowest and lowest frame.
const LEAST: f64 = 60.0;

/// Where values fall in pixels.
struct Frame<'a> {
    x: &'a Axis,
    y: &'a Axis,
    area: Rect,
}

impl Frame<'_> {
    fn x_at(&self, value: f64) -> Option<f64> {
        let share = self.x.position(value)?;
        let share = if self.x.downward { 1.0 - share } else { share };
        Some(self.area.left + share * (self.area.right - self.area.left))
    }

    fn y_at(&self, value: f64) -> Option<f64> {
        let share = self.y.position(value)?;
        let share = if self.y.downward { share } else { 1.0 - share };
        Some(self.area.top + share * (self.area.bottom - self.area.top))
    }

    fn at(&self, point: (f64, f64)) -> Option<(f64, f64)> {
        Some((self.x_at(point.0)?, self.y_at(point.1)?))
    }

    fn path(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        simplify(points.iter().filter_map(|point| self.at(*point)))
    }

    /// A path kept inside the frame, for finding room: what the clip hides needs none.
    fn seen(&self, path: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let area = &self.area;
        path.iter().map(|(x, y)| (x.clamp(area.left, area.right), y.clamp(area.top, area.bottom))).collect()
    }
}

impl Figure {
    /// A file of its own.
    pub fn file(&self) -> String {
        let body = draw(self, Size::Wide, "figure", r#" xmlns="http://www.w3.org/2000/svg""#);
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{body}")
    }

    /// An element of a page; `id` must be unlike that of any other element there.
    pub fn inline(&self, id: &str, size: Size) -> String {
        draw(self, size, id, "")
    }
}

fn draw(figure: &Figure, size: Size, id: &str, namespace: &str) -> String {
    let (width, height) = match size {
        Size::Wide => figure.wide,
        Size::Narrow => figure.narrow,
    };
    let mut above = match figure.naming {
        Naming::Above => named(figure),
        Naming::Direct => Vec::new(),
    };
    // Marks whose names find no room are named above the frame; that moves the frame, so all is drawn again.
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
    svg.finish()
}

/// Indices of the marks that have a name.
fn named(figure: &Figure) -> Vec<usize> {
    (0..figure.marks.len()).filter(|&index| label_of(&figure.marks[index]).is_some()).collect()
}

fn label_of(mark: &Mark) -> Option<(&str, Colour)> {
    let (label, colour) = match mark {
        Mark::Line(line) => (&line.label, line.colour),
        Mark::Point(point) => (&point.label, point.colour),
        Mark::Rule(rule) => (&rule.label, rule.colour),
        Mark::Area(area) => (&area.label, area.colour),
        Mark::Disc(_) => return None,
    };
    label.as_deref().map(|label| (label, colour))
}

/// Everything inside the element, how high it is, and the marks whose names found no room. `above` are named
/// above the frame.
fn body(figure: &Figure, width: f64, height: f64, id: &str, above: &[usize]) -> (String, f64, Vec<usize>) {
    let mut svg = Svg::default();
    let mut top = 12.0;
    if !figure.heading.is_empty() {
        for line in wrap(&figure.heading, LABEL_TEXT * 1.08, width - 24.0) {
            svg.text((12.0, top + 12.0), Anchor::Start, &line, r#"font-weight="bold" font-size="14""#);
            top += LINE_HEIGHT + 1.0;
        }
        top += 6.0;
    }
    top = key(&mut svg, figure, above, width, top);
    if figure.sieves {
        top += sieves::HEIGHT;
    }
    let (frame, height) = roomy(figure, width, height, top);
    grid(&mut svg, &frame);
    axis_labels(&mut svg, &frame, height);
    if figure.sieves {
        sieves::draw(&mut svg, &frame.area, |size| frame.x_at(size));
    }

    let clip = format!("{}-clip", escape(id));
    let Rect { left, top, right, bottom } = frame.area;
    svg.raw(&format!("<clipPath id=\"{clip}\">\n"));
    svg.rect(left - 1.0, top - 1.0, right - left + 2.0, bottom - top + 2.0, "");
    svg.raw(&format!("</clipPath>\n<g clip-path=\"url(#{clip})\" stroke-linejoin=\"round\">\n"));
    let mut canvas = Canvas { frame: inset(&frame.area), ink: Vec::new(), taken: Vec::new() };
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
        hover::draw(&mut svg, figure, &classes, &frame.area, |point| frame.at(point));
    }
    let mut symbols = Vec::new();
    for (index, mark) in figure.marks.iter().enumerate() {
        if let Mark::Point(point) = mark {
            let title = is_pointed_at.then(|| {
                let said = (point.true_x.unwrap_or(point.at.0), point.at.1);
                hover::title(figure, point.label.as_deref(), said)
            });
            in_group(&mut svg, &classes[index], |svg| {
                title.iter().for_each(|title| svg.raw(&format!("<g>{title}\n")));
                symbols.extend(draw_point(svg, &mut canvas, &frame, point, index));
                title.iter().for_each(|_| svg.raw("</g>\n"));
            });
        }
    }
    canvas.taken.extend(symbols);
    // points first: they have one anchor only
    let mut order = named(figure);
    order.retain(|index| !above.contains(index));
    order.sort_by_key(|&index| !matches!(figure.marks[index], Mark::Point(_)));
    let mut homeless = Vec::new();
    for index in order {
        let mark = &figure.marks[index];
        let Some((label, colour)) = label_of(mark) else { continue };
        let mut anchors = anchors(&frame, mark);
        if anchors.is_empty() {
            continue;
        }
        let lines: Vec<&str> = label.lines().collect();
        let wide = lines.iter().map(|line| width_of(line, TICK_TEXT)).fold(0.0, f64::max);
        if let Mark::Area(area) = mark {
            let (left, right) = reach(&frame, &area.outline);
            if right - left < wide + 6.0 {
                homeless.push(index);
                continue;
            }
            // the first choice is right of the anchor: that is then in the middle of the area
            anchors.iter_mut().for_each(|anchor| anchor.0 -= GAP + wide / 2.0);
        }
        match canvas.place(&anchors, wide, LINE_HEIGHT * lines.len() as f64 - 2.0, index) {
            None => homeless.push(index),
            Some(found) => {
                let place = side(&found, &anchors);
                in_group(&mut svg, &classes[index], |svg| name(svg, &lines, &found, place, colour));
            }
        }
    }
    (svg.finish(), height, homeless)
}

/// Draws what belongs to a curve, so that a page can hide it.
fn in_group(svg: &mut Svg, class: &str, draw: impl FnOnce(&mut Svg)) {
    if class.is_empty() {
        return draw(svg);
    }
    svg.raw(&format!("<g{class}>\n"));
    draw(svg);
    svg.raw("</g>\n");
}

/// Writes a name beside its mark, on a light ground that keeps it apart from what lies below.
fn name(svg: &mut Svg, lines: &[&str], found: &Rect, (at, anchor): (f64, Anchor), colour: Colour) {
    let halo = r##"stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke""##;
    let paint = format!("fill=\"{}\" {halo}", colour.text);
    for (row, line) in lines.iter().enumerate() {
        svg.text((at, found.top + 12.0 + row as f64 * LINE_HEIGHT), anchor, line, &paint);
    }
}

/// Text that stands left of its curve ends there, so that a narrower font leaves no gap.
fn side(found: &Rect, anchors: &[(f64, f64)]) -> (f64, Anchor) {
    let nearest = anchors.iter().min_by(|a, b| distance(found, **a).total_cmp(&distance(found, **b)));
    match nearest {
        Some((x, _)) if *x >= found.right => (found.right, Anchor::End),
        Some((x, _)) if *x > found.left => ((found.left + found.right) / 2.0, Anchor::Middle),
        _ => (found.left, Anchor::Start),
    }
}

fn distance(rect: &Rect, point: (f64, f64)) -> f64 {
    let dx = (rect.left - point.0).max(point.0 - rect.right).max(0.0);
    let dy = (rect.top - point.1).max(point.1 - rect.bottom).max(0.0);
    libm::hypot(dx, dy)
}

fn inset(area: &Rect) -> Rect {
    Rect { left: area.left + 3.0, top: area.top + 3.0, right: area.right - 3.0, bottom: area.bottom - 3.0 }
}

/// The names above the frame, in as many rows as they need. Returns where the frame may begin.
fn key(svg: &mut Svg, figure: &Figure, above: &[usize], width: f64, top: f64) -> f64 {
    const SAMPLE: f64 = 26.0;
    let (mut left, mut row) = (14.0, top);
    for &index in above {
        let Some((label, colour)) = label_of(&figure.marks[index]) else { continue };
        let label = label.replace('\n', " ");
        let room = SAMPLE + 6.0 + width_of(&label, TICK_TEXT) + 18.0;
        if left > 14.0 && left + room - 18.0 > width - 8.0 {
            (left, row) = (14.0, row + LINE_HEIGHT + 2.0);
        }
        let middle = row + 8.0;
        match &figure.marks[index] {
            Mark::Point(point) => symbol(svg, (left + SAMPLE / 2.0, middle), point),
            Mark::Line(line) => svg.line((left, middle), (left + SAMPLE, middle), &stroke(line)),
            Mark::Rule(rule) => {
                let line = Line::new(Vec::new(), rule.colour).width(1.5).dash(rule.dash);
                svg.line((left, middle), (left + SAMPLE, middle), &stroke(&line));
            }
            Mark::Area(area) => {
                let paint = format!("fill=\"{}\" fill-opacity=\"{}\"", area.colour.line, short(area.opacity));
                svg.rect(left, middle - 6.0, SAMPLE, 12.0, &paint);
            }
            Mark::Disc(_) => {}
        }
        let paint = format!("fill=\"{}\"", colour.text);
        svg.text((left + SAMPLE + 6.0, middle + 4.5), Anchor::Start, &label, &paint);
        left += room;
    }
    if above.is_empty() { top } else { row + LINE_HEIGHT + 8.0 }
}

/// A frame that is not too low for anything to be seen, whatever stands above and below it: the figure grows.
fn roomy(figure: &Figure, width: f64, height: f64, top: f64) -> (Frame<'_>, f64) {
    let first = frame(figure, width, height, top);
    let high = first.area.bottom - first.area.top;
    if high >= LEAST {
        return (first, height);
    }
    // The label beside the frame breaks into fewer lines where the frame is higher, which makes it wider: at
    // most the labels below then need fewer lines.
    let height = height + LEAST - high;
    (frame(figure, width, height, top), height)
}

fn frame(figure: &Figure, width: f64, height: f64, top: f64) -> Frame<'_> {
    let widest = |axis: &Axis| {
        let texts = axis.ticks.iter().flat_map(|tick| &tick.text);
        texts.map(|text| width_of(text, TICK_TEXT)).fold(0.0, f64::max)
    };
    let rows = figure.x.ticks.iter().map(|tick| tick.text.len()).max().unwrap_or(0) as f64;
    let right = width - 20.0;
    let y_lines = if figure.y.label.is_empty() {
        0
    } else {
        wrap(&figure.y.label, LABEL_TEXT, height - top - 90.0).len()
    };
    // What is too long to stand beside the frame is cut off at the figure's edge.
    let left = (12.0 + y_lines as f64 * LINE_HEIGHT + widest(&figure.y) + 12.0).min(right - LEAST);
    let x_lines = wrap(&figure.x.label, LABEL_TEXT, right - left).len() as f64;
    let bottom = height - 10.0 - (x_lines + rows) * LINE_HEIGHT - 6.0;
    let top = top + 4.0;
    let side = if figure.square { (right - left).min(bottom - top).max(0.0) } else { f64::INFINITY };
    let (right, bottom) = (right.min(left + side), bottom.min(top + side));
    Frame { x: &figure.x, y: &figure.y, area: Rect { left, top, right, bottom } }
}

fn grid(svg: &mut Svg, frame: &Frame<'_>) {
    let Rect { left, top, right, bottom } = frame.area;
    let minor = r##"stroke="#e6e6e6" stroke-width="0.8""##;
    let major = r##"stroke="#bdbdbd" stroke-width="1""##;
    for strong in [false, true] {
        let paint = if strong { major } else { minor };
        let drawn = |tick: &&Tick| (!tick.text.is_empty() && tick.rank == 0) == strong;
        for x in frame.x.ticks.iter().filter(drawn).filter_map(|tick| frame.x_at(tick.at)) {
            svg.line((x, top), (x, bottom), paint);
        }
        for y in frame.y.ticks.iter().filter(drawn).filter_map(|tick| frame.y_at(tick.at)) {
            svg.line((left, y), (right, y), paint);
        }
    }
    for (tick, x) in labelled(frame.x, |tick| {
        let wide = tick.text.iter().map(|text| width_of(text, TICK_TEXT)).fold(0.0, f64::max);
        frame.x_at(tick.at).map(|x| (x, wide / 2.0 + 4.0))
    }) {
        for (row, text) in tick.text.iter().enumerate() {
            svg.text((x, bottom + 17.0 + row as f64 * LINE_HEIGHT), Anchor::Middle, text, "");
        }
    }
    for (tick, y) in
        labelled(frame.y, |tick| frame.y_at(tick.at).map(|y| (y, LINE_HEIGHT * tick.text.len() as f64 / 2.0)))
    {
        let first = y + 4.5 - (tick.text.len() as f64 - 1.0) * LINE_HEIGHT / 2.0;
        for (row, text) in tick.text.iter().enumerate() {
            svg.text((left - 7.0, first + row as f64 * LINE_HEIGHT), Anchor::End, text, "");
        }
    }
}

/// The ticks whose labels fit beside one another, the important ones first, each with its place. `room` gives
/// the place of a tick and half the room of its label.
fn labelled(axis: &Axis, room: impl Fn(&Tick) -> Option<(f64, f64)>) -> Vec<(&Tick, f64)> {
    let mut kept: Vec<(&Tick, f64, f64)> = Vec::new();
    let highest = axis.ticks.iter().map(|tick| tick.rank).max().unwrap_or(0);
    for rank in 0..=highest {
        let group: Vec<_> = axis
            .ticks
            .iter()
            .filter(|tick| tick.rank == rank && !tick.text.is_empty())
            .filter_map(|tick| room(tick).map(|(at, half)| (tick, at, half)))
            .collect();
        // the first rank is thinned evenly until it fits; a lower one comes whole or not at all
        let fits = |stride: usize| {
            let mut all = kept.clone();
            all.extend(group.iter().step_by(stride));
            all.sort_by(|a, b| a.1.total_cmp(&b.1));
            all.windows(2).all(|pair| pair[1].1 - pair[0].1 >= pair[0].2 + pair[1].2)
        };
        if group.is_empty() {
            continue;
        }
        let most = if kept.is_empty() { group.len() } else { 1 };
        match (1..=most).find(|stride| fits(*stride)) {
            Some(stride) => kept.extend(group.into_iter().step_by(stride)),
            None => break,
        }
    }
    kept.into_iter().map(|(tick, at, _)| (tick, at)).collect()
}

fn axis_labels(svg: &mut Svg, frame: &Frame<'_>, height: f64) {
    let Rect { left, top, right, bottom } = frame.area;
    let size = format!("font-size=\"{LABEL_TEXT}\"");
    let lines = wrap(&frame.x.label, LABEL_TEXT, right - left);
    let first = height - 12.0 - (lines.len() as f64 - 1.0) * LINE_HEIGHT;
    for (row, line) in lines.iter().enumerate() {
        svg.text(((left + right) / 2.0, first + row as f64 * LINE_HEIGHT), Anchor::Middle, line, &size);
    }
    let middle = (top + bottom) / 2.0;
    for (row, line) in wrap(&frame.y.label, LABEL_TEXT, height - top - 90.0).iter().enumerate() {
        let x = 20.0 + row as f64 * LINE_HEIGHT;
        let turned = format!("{size} transform=\"rotate(-90 {} {})\"", short(x), short(middle));
        svg.text((x, middle), Anchor::Middle, line, &turned);
    }
}

fn draw_mark(svg: &mut Svg, canvas: &mut Canvas, frame: &Frame<'_>, mark: &Mark, index: usize) {
    match mark {
        Mark::Area(area) => {
            let paint = format!("fill=\"{}\" fill-opacity=\"{}\"", area.colour.line, short(area.opacity));
            svg.path(&frame.path(&area.outline), true, &paint);
        }
        Mark::Line(line) => {
            let path = frame.path(&line.points);
            match path.as_slice() {
                [] => {}
                [(x, y)] => symbol(svg, (*x, *y), &Point::new(0.0, 0.0, line.colour, Shape::Circle)),
                _ => svg.path(&path, false, &format!("fill=\"none\" {}", stroke(line))),
            }
            canvas.draw(&frame.seen(&path), index);
        }
        Mark::Rule(rule) => {
            let Rect { left, top, right, bottom } = frame.area;
            let ends = match rule.across {
                Across::X => frame.x_at(rule.at).map(|x| ((x, top), (x, bottom))),
                Across::Y => frame.y_at(rule.at).map(|y| ((left, y), (right, y))),
            };
            if let Some((from, to)) = ends {
                let line = Line::new(Vec::new(), rule.colour).width(1.5).dash(rule.dash);
                svg.line(from, to, &stroke(&line));
                canvas.draw(&[from, to], index);
            }
        }
        Mark::Disc(disc) => {
            let edge = frame.x_at(disc.centre.0 + disc.diameter);
            if let (Some((x, y)), Some(edge)) = (frame.at(disc.centre), edge) {
                svg.circle((x, y), 0.5 * (edge - x).abs(), &format!("fill=\"{}\"", disc.colour.line));
            }
        }
        Mark::Point(point) => {
            if let (true, Some((x, y))) = (point.drop, frame.at(point.at)) {
                let line = Line::new(Vec::new(), point.colour).width(1.3).dash(Dash::Dotted);
                svg.line((x, y), (x, frame.area.bottom), &stroke(&line));
                canvas.draw(&[(x, y), (x, frame.area.bottom)], index);
            }
        }
    }
}

/// A symbol and its bars, drawn over everything else and not clipped: half a circle on the frame reads badly.
fn draw_point(
    svg: &mut Svg,
    canvas: &mut Canvas,
    frame: &Frame<'_>,
    point: &Point,
    index: usize,
) -> Option<Rect> {
    let (x, y) = frame.at(point.at)?;
    let area = &frame.area;
    let inside =
        x >= area.left - 0.5 && x <= area.right + 0.5 && y >= area.top - 0.5 && y <= area.bottom + 0.5;
    if !inside {
        return None;
    }
    let paint = format!("stroke=\"{}\" stroke-width=\"1.8\"", point.colour.line);
    let mut bar = |from: (f64, f64), to: (f64, f64), cap: (f64, f64)| {
        svg.line(from, to, &paint);
        for end in [from, to] {
            svg.line((end.0 - cap.0, end.1 - cap.1), (end.0 + cap.0, end.1 + cap.1), &paint);
        }
        canvas.draw(&[from, to], index);
    };
    if let Some((low, high)) = point.x_interval
        && let (Some(low), Some(high)) = (frame.x_at(low), frame.x_at(high))
    {
        bar((low.clamp(area.left, area.right), y), (high.clamp(area.left, area.right), y), (0.0, 5.0));
    }
    if let Some((low, high)) = point.y_interval
        && let (Some(low), Some(high)) = (frame.y_at(low), frame.y_at(high))
    {
        bar((x, low.clamp(area.top, area.bottom)), (x, high.clamp(area.top, area.bottom)), (5.0, 0.0));
    }
    symbol(svg, (x, y), point);
    let reach = SYMBOL + 1.0;
    Some(Rect { left: x - reach, top: y - reach, right: x + reach, bottom: y + reach })
}

fn symbol(svg: &mut Svg, (x, y): (f64, f64), point: &Point) {
    let fill = if point.filled { point.colour.line } else { "#ffffff" };
    let paint = format!("fill=\"{fill}\" stroke=\"{}\" stroke-width=\"1.8\"", point.colour.line);
    let r = SYMBOL;
    match point.shape {
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

fn stroke(line: &Line) -> String {
    let dashes = match line.dash {
        Dash::Solid => "",
        Dash::Dashed => r#" stroke-dasharray="7 4""#,
        Dash::Dotted => r#" stroke-dasharray="1.5 3.5""#,
    };
    let opacity = if line.opacity < 1.0 {
        format!(" stroke-opacity=\"{}\"", short(line.opacity))
    } else {
        String::new()
    };
    format!("stroke=\"{}\" stroke-width=\"{}\"{dashes}{opacity}", line.colour.line, short(line.width))
}

/// Where the name of a mark may hang, in the order of preference.
fn anchors(frame: &Frame<'_>, mark: &Mark) -> Vec<(f64, f64)> {
    let Rect { left, top, right, bottom } = frame.area;
    match mark {
        Mark::Point(point) => frame.at(point.at).into_iter().collect(),
        Mark::Disc(_) => Vec::new(),
        Mark::Rule(rule) => [0.97, 0.85, 0.7, 0.5, 0.3, 0.15, 0.03]
            .into_iter()
            .filter_map(|share| match rule.across {
                Across::X => frame.x_at(rule.at).map(|x| (x, bottom - share * (bottom - top))),
                Across::Y => frame.y_at(rule.at).map(|y| (left + share * (right - left), y)),
            })
            .collect(),
        Mark::Line(line) => {
            let path = frame.path(&line.points);
            [0.62, 0.7, 0.54, 0.78, 0.46, 0.86, 0.38, 0.92, 0.3, 0.22, 0.97, 0.14, 0.06]
                .into_iter()
                .filter_map(|share| along(&path, share))
                .filter(|(x, y)| *x >= left && *x <= right && *y >= top && *y <= bottom)
                .collect()
        }
        Mark::Area(area) => {
            let path = frame.seen(&frame.path(&area.outline));
            let (left, right) = reach(frame, &area.outline);
            let highest = path.iter().map(|(_, y)| *y).fold(f64::MAX, f64::min);
            if path.is_empty() { Vec::new() } else { vec![((left + right) / 2.0, highest)] }
        }
    }
}

/// Leftmost and rightmost pixel of an outline inside the frame.
fn reach(frame: &Frame<'_>, outline: &[(f64, f64)]) -> (f64, f64) {
    let seen = frame.seen(&frame.path(outline));
    seen.iter().fold((f64::MAX, f64::MIN), |(least, most), (x, _)| (least.min(*x), most.max(*x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowded_tick_labels_are_thinned_and_the_important_kept() {
        let axis = Axis::log("x", 0.11, 8.5);
        let kept = |half: f64| {
            let found = labelled(&axis, |tick| axis.position(tick.at).map(|share| (share * 300.0, half)));
            let mut texts: Vec<_> = found.into_iter().map(|(tick, _)| tick.text[0].clone()).collect();
            texts.sort();
            texts
        };
        assert_eq!(kept(10.0), ["0.1", "0.2", "0.5", "1", "2", "5"]);
        assert_eq!(kept(40.0), ["0.1", "1"]);
    }
}
