//! Placement of direct labels: beside their own curve, and on nothing else.

/// Pixels between an anchor and its label.
pub(super) const GAP: f64 = 9.0;

/// A rectangle: left, top, right, bottom, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
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

    fn within(&self, frame: &Rect) -> bool {
        self.left >= frame.left
            && self.right <= frame.right
            && self.top >= frame.top
            && self.bottom <= frame.bottom
    }

    fn grown(&self, by: f64) -> Rect {
        Rect { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }
}

/// The drawn points, and the free space for labels.
pub(super) struct Canvas {
    pub frame: Rect,
    /// Points on the drawn marks, a few pixels apart, each with the index of its mark.
    pub ink: Vec<((f64, f64), usize)>,
    /// Labels and symbols that were placed.
    pub taken: Vec<Rect>,
}

impl Canvas {
    /// Adds points every 3 pixels along a path, so that no label can slip between two of them.
    pub(super) fn draw(&mut self, path: &[(f64, f64)], mark: usize) {
        for pair in path.windows(2) {
            let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            let steps = (libm::hypot(dx, dy) / 3.0).ceil().clamp(1.0, 2000.0) as usize;
            for step in 0..steps {
                let share = step as f64 / steps as f64;
                self.ink.push(((pair[0].0 + share * dx, pair[0].1 + share * dy), mark));
            }
        }
        self.ink.extend(path.last().map(|end| (*end, mark)));
    }

    /// Takes and returns a free box of this size near one of the anchors (tried in order), or `None`. Other
    /// marks are kept at a greater distance, so that a name is on its own curve's side of a neighbour.
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
                let candidate = Rect { left, top, right: left + width, bottom: top + height };
                if !candidate.within(&self.frame) || self.covers(&candidate.grown(1.0)) {
                    continue;
                }
                let near = candidate.grown(12.0);
                let crowd = self.ink.iter().filter(|(point, _)| near.holds(*point));
                let crowd: f64 = crowd.map(|(_, other)| if *other == mark { 0.5 } else { 2.0 }).sum();
                let cost = crowd + 1.5 * order as f64 + 0.5 * rank as f64;
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
        self.taken.iter().any(|taken| taken.meets(candidate))
            || self.ink.iter().any(|(point, _)| candidate.holds(*point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn canvas() -> Canvas {
        let frame = Rect { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 };
        Canvas { frame, ink: Vec::new(), taken: Vec::new() }
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
            assert!(!canvas.ink.iter().any(|(point, _)| label.holds(*point)), "{label:?} covers the curve");
        }
    }

    #[test]
    fn a_label_stands_on_its_own_side_of_a_neighbour() {
        let mut canvas = canvas();
        canvas.draw(&[(46.0, 0.0), (46.0, 100.0)], 0);
        canvas.draw(&[(54.0, 0.0), (54.0, 100.0)], 1);
        assert!(canvas.place(&[(46.0, 50.0)], 30.0, 12.0, 0).unwrap().right < 46.0);
        assert!(canvas.place(&[(54.0, 50.0)], 30.0, 12.0, 1).unwrap().left > 54.0);
    }

    #[test]
    fn no_room_is_said() {
        let mut canvas = canvas();
        assert_eq!(canvas.place(&[(50.0, 50.0)], 120.0, 12.0, 0), None);
    }
}
