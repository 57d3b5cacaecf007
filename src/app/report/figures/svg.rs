//! SVG text: elements, numbers, escaping, and the estimated width of a text; paths with few points; and
//! positions for labels that are beside their own curve and cover nothing else.

use std::fmt::Write;

use voidwalk_core::text::visible;

/// Generic families only, so that a figure looks the same as a file and in a page, and fetches nothing.
pub(super) const FONT: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// Characters in a form that XML can hold: markup escaped, hidden ones replaced.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            other => out.push(visible(other)),
        }
    }
    out
}

/// Estimated width of a text in pixels, rather too large: the reader's font is unknown.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | 't' | 'f' | 'r' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | '('
            | ')' | ' ' => 0.33,
            'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.9,
            'A'..='Z' => 0.7,
            c if (c as u32) > 0x2e80 => 1.0,
            _ => 0.57,
        })
        .sum();
    em * size
}

/// Text in lines at most `width` pixels wide, broken at spaces.
pub(super) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_of(line, size) + width_of(word, size) + width_of(" ", size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Number with at most two decimals and no trailing zeros.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Sequence of elements. Only presentation attributes are written, never a `style`: a strict content security
/// policy accepts them.
#[derive(Default)]
pub(super) struct Svg(pub(super) String);

impl Svg {
    pub(super) fn raw(&mut self, text: &str) {
        self.0 += text;
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), paint: &str) {
        let (x1, y1, x2, y2) = (short(from.0), short(from.1), short(to.0), short(to.1));
        let _ = writeln!(self.0, r#"<path d="M{x1} {y1}L{x2} {y2}" fill="none" {paint}/>"#);
    }

    pub(super) fn rect(&mut self, left: f64, top: f64, width: f64, height: f64, paint: &str) {
        let (x, y, w, h) = (short(left), short(top), short(width), short(height));
        let _ = writeln!(self.0, r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" {paint}/>"#);
    }

    pub(super) fn circle(&mut self, (x, y): (f64, f64), radius: f64, paint: &str) {
        let (x, y, radius) = (short(x), short(y), short(radius));
        self.raw(&format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {paint}/>\n"));
    }

    pub(super) fn path(&mut self, points: &[(f64, f64)], closed: bool, paint: &str) {
        let Some((first, rest)) = points.split_first() else { return };
        let _ = write!(self.0, r#"<path d="M{} {}"#, short(first.0), short(first.1));
        for point in rest {
            let _ = write!(self.0, "L{} {}", short(point.0), short(point.1));
        }
        let _ = writeln!(self.0, r#"{}" {paint}/>"#, if closed { "Z" } else { "" });
    }

    /// Writes text whose baseline passes through `at`, which is its `start`, `middle` or `end`; the content
    /// is escaped here and nowhere else.
    pub(super) fn text(&mut self, at: (f64, f64), anchor: &str, content: &str, extra: &str) {
        let (x, y, content) = (short(at.0), short(at.1), escape(content));
        let _ = writeln!(self.0, r#"<text x="{x}" y="{y}" text-anchor="{anchor}" {extra}>{content}</text>"#);
    }
}

/// Point at a fraction of a path's length.
pub(super) fn along(path: &[(f64, f64)], share: f64) -> Option<(f64, f64)> {
    let length = |pair: &[(f64, f64)]| libm::hypot(pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
    let mut left = share * path.windows(2).map(length).sum::<f64>();
    for pair in path.windows(2) {
        let here = length(pair);
        if left <= here && here > 0.0 {
            let part = left / here;
            let [from, to] = [pair[0], pair[1]];
            return Some((from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1)));
        }
        left -= here;
    }
    path.last().copied()
}

/// Path with the minimum of points that keeps it within a third of a pixel (Douglas and Peucker), after
/// dropping points that coincide with their predecessor.
pub(super) fn simplify(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    const NEAR: f64 = 0.3;
    let mut path: Vec<(f64, f64)> = Vec::new();
    let mut last = None;
    for point in points {
        match path.last() {
            Some(before) if libm::hypot(point.0 - before.0, point.1 - before.1) < NEAR => last = Some(point),
            _ => {
                path.push(point);
                last = None;
            }
        }
    }
    path.extend(last);
    if path.len() < 3 {
        return path;
    }
    let mut keep = vec![false; path.len()];
    keep[0] = true;
    keep[path.len() - 1] = true;
    let mut spans = vec![(0, path.len() - 1)];
    while let Some((from, to)) = spans.pop() {
        let (mut index, mut away) = (from, NEAR);
        for between in from + 1..to {
            let distance = off_chord(path[between], path[from], path[to]);
            if distance >= away {
                (index, away) = (between, distance);
            }
        }
        if away > NEAR {
            keep[index] = true;
            spans.push((from, index));
            spans.push((index, to));
        }
    }
    path.into_iter().zip(keep).filter_map(|(point, kept)| kept.then_some(point)).collect()
}

/// Distance of a point from the segment between two others.
fn off_chord(point: (f64, f64), from: (f64, f64), to: (f64, f64)) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (px, py) = (point.0 - from.0, point.1 - from.1);
    let square = dx * dx + dy * dy;
    let share = if square > 0.0 { ((px * dx + py * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    libm::hypot(px - share * dx, py - share * dy)
}

/// Pixels between an anchor and its label.
pub(super) const GAP: f64 = 9.0;

/// A rectangle: left, top, right, bottom, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rect {
    fn meets(&self, other: &Rect) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn holds(&self, point: (f64, f64)) -> bool {
        point.0 > self.left && point.0 < self.right && point.1 > self.top && point.1 < self.bottom
    }

    /// True if a point is inside or on the edge.
    pub(super) fn reaches(&self, (x, y): (f64, f64)) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    fn within(&self, frame: &Rect) -> bool {
        frame.reaches((self.left, self.top)) && frame.reaches((self.right, self.bottom))
    }

    pub(super) fn grown(&self, by: f64) -> Rect {
        Rect { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }
}

/// Drawn points, and the space that remains for labels.
pub(super) struct Canvas {
    frame: Rect,
    /// Points on the drawn marks, a few pixels apart, each with the index of its mark; by column.
    ink: Vec<Vec<((f64, f64), usize)>>,
    /// Labels and symbols already placed.
    pub(super) taken: Vec<Rect>,
}

/// Width of a column of ink (pixels): a label looks for ink in the columns that it covers only.
const COLUMN: f64 = 24.0;

impl Canvas {
    pub(super) fn new(frame: Rect) -> Self {
        let columns = ((frame.right - frame.left) / COLUMN).ceil().clamp(1.0, 1000.0) as usize;
        Self { frame, ink: vec![Vec::new(); columns], taken: Vec::new() }
    }

    /// Column of an abscissa; what lies outside the frame belongs to the outermost.
    fn column(&self, x: f64) -> usize {
        (((x - self.frame.left) / COLUMN).max(0.0) as usize).min(self.ink.len() - 1)
    }

    fn add(&mut self, point: (f64, f64), mark: usize) {
        let column = self.column(point.0);
        self.ink[column].push((point, mark));
    }

    /// Drawn points inside a rectangle.
    fn inside(&self, area: Rect) -> impl Iterator<Item = &((f64, f64), usize)> {
        let columns = &self.ink[self.column(area.left)..=self.column(area.right)];
        columns.iter().flatten().filter(move |(point, _)| area.holds(*point))
    }

    /// Adds points every 3 pixels along a path, so that no label can slip between two of them.
    pub(super) fn draw(&mut self, path: &[(f64, f64)], mark: usize) {
        for pair in path.windows(2) {
            let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            let steps = (libm::hypot(dx, dy) / 3.0).ceil().clamp(1.0, 2000.0) as usize;
            for step in 0..steps {
                let share = step as f64 / steps as f64;
                self.add((pair[0].0 + share * dx, pair[0].1 + share * dy), mark);
            }
        }
        path.last().into_iter().for_each(|end| self.add(*end, mark));
    }

    /// Takes and returns a free box of this size near one of the anchors (tried in order), or `None`. Other
    /// marks are kept at a greater distance, so that a name stays on its own curve's side of a neighbour.
    pub(super) fn place(
        &mut self,
        anchors: &[(f64, f64)],
        width: f64,
        height: f64,
        mark: usize,
    ) -> Option<Rect> {
        let mut best: Option<(f64, Rect)> = None;
        for (order, &(x, y)) in anchors.iter().enumerate() {
            let beside = y - height / 2.0;
            let corners = [
                (x + GAP, beside),
                (x - GAP - width, beside),
                (x + GAP, y - GAP - height),
                (x - GAP - width, y - GAP - height),
                (x + GAP, y + GAP),
                (x - GAP - width, y + GAP),
                (x - width / 2.0, y - GAP - height),
                (x - width / 2.0, y + GAP),
            ];
            for (rank, (left, top)) in corners.into_iter().enumerate() {
                let distance = 1.5 * order as f64 + 0.5 * rank as f64;
                if best.is_some_and(|(least, _)| least <= distance) {
                    continue;
                }
                let candidate = Rect { left, top, right: left + width, bottom: top + height };
                if !candidate.within(&self.frame) || self.covers(&candidate.grown(1.0)) {
                    continue;
                }
                let crowd = self.inside(candidate.grown(12.0));
                let crowd: f64 = crowd.map(|(_, other)| if *other == mark { 0.5 } else { 2.0 }).sum();
                let cost = crowd + distance;
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, candidate));
                }
            }
        }
        let (_, free) = best?;
        self.taken.push(free);
        Some(free)
    }

    fn covers(&self, candidate: &Rect) -> bool {
        self.taken.iter().any(|taken| taken.meets(candidate)) || self.inside(*candidate).next().is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_and_control_characters_become_inert() {
        assert_eq!(escape("<script>\"&'\u{0}\u{202e}"), "&lt;script&gt;&quot;&amp;&#39;\u{fffd}\u{fffd}");
        assert_eq!(escape("a\u{61c}b\u{2067}c"), "a\u{fffd}b\u{fffd}c");
        assert_eq!(escape("Sand 0–2 mm, größer"), "Sand 0–2 mm, größer");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(1.0), "1");
        assert_eq!(short(-0.001), "0");
        assert_eq!(short(100.25), "100.25");
        assert_eq!(short(100.0), "100");
    }

    #[test]
    fn labels_are_wrapped() {
        assert_eq!(wrap("one two three", 10.0, 40.0), ["one two", "three"]);
        assert_eq!(wrap("", 10.0, 40.0), Vec::<String>::new());
    }

    #[test]
    fn a_simplified_path_stays_within_a_pixel_and_keeps_its_ends() {
        let full: Vec<(f64, f64)> =
            (0..5000).map(|i| (f64::from(i) * 0.1, 50.0 * libm::sin(f64::from(i) * 0.01))).collect();
        let few = simplify(full.iter().copied());
        assert!(few.len() < 300, "{}", few.len());
        assert_eq!((few[0], few[few.len() - 1]), (full[0], full[4999]));
        for point in full {
            let near = few.windows(2).map(|pair| off_chord(point, pair[0], pair[1])).fold(f64::MAX, f64::min);
            assert!(near < 1.0, "{point:?} is {near} off");
        }
    }

    #[test]
    fn a_share_of_a_path_is_a_share_of_its_length() {
        let path = [(0.0, 0.0), (10.0, 0.0), (10.0, 30.0)];
        assert_eq!(along(&path, 0.25), Some((10.0, 0.0)));
        assert_eq!(along(&path, 0.5), Some((10.0, 10.0)));
        assert_eq!(along(&[], 0.5), None);
    }

    fn canvas() -> Canvas {
        Canvas::new(Rect { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 })
    }

    #[test]
    fn a_label_covers_no_curve_and_no_other_label() {
        let mut canvas = canvas();
        canvas.draw(&[(0.0, 100.0), (100.0, 0.0)], 0);
        let anchors: Vec<_> = (1..10).map(|i| (10.0 * f64::from(i), 100.0 - 10.0 * f64::from(i))).collect();
        let first = canvas.place(&anchors, 30.0, 12.0, 0).unwrap();
        let second = canvas.place(&anchors, 30.0, 12.0, 0).unwrap();
        assert!(!first.meets(&second));
        for label in [first, second] {
            assert!(label.within(&canvas.frame));
            let covered = canvas.ink.iter().flatten().any(|(point, _)| label.holds(*point));
            assert!(!covered, "{label:?} covers the curve");
        }
    }

    #[test]
    fn a_label_stands_on_its_own_side_of_a_neighbour() {
        let mut canvas = canvas();
        canvas.draw(&[(46.0, 0.0), (46.0, 100.0)], 0);
        canvas.draw(&[(54.0, 0.0), (54.0, 100.0)], 1);
        assert!(canvas.place(&[(46.0, 50.0)], 30.0, 12.0, 0).unwrap().right < 46.0);
        assert!(canvas.place(&[(54.0, 50.0)], 30.0, 12.0, 1).unwrap().left > 54.0);
        assert_eq!(canvas.place(&[(50.0, 50.0)], 120.0, 12.0, 0), None, "no room");
    }
}
