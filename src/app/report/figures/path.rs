//! Paths in pixels: as few points as the eye needs, and places along them.

/// The point at a share of a path's length.
pub(super) fn along(path: &[(f64, f64)], share: f64) -> Option<(f64, f64)> {
    let length = |pair: &[(f64, f64)]| libm::hypot(pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
    let mut left = share * path.windows(2).map(length).sum::<f64>();
    for pair in path.windows(2) {
        let here = length(pair);
        if left <= here && here > 0.0 {
            let part = left / here;
            return Some((
                pair[0].0 + part * (pair[1].0 - pair[0].0),
                pair[0].1 + part * (pair[1].1 - pair[0].1),
            ));
        }
        left -= here;
    }
    path.last().copied()
}

/// The path with as few points as keep it within a third of a pixel (Douglas and Peucker), after points that
/// coincide with their predecessor are left out.
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
        let away = |index: usize| off_chord(path[index], path[from], path[to]);
        let farthest = (from + 1..to).max_by(|a, b| away(*a).total_cmp(&away(*b)));
        if let Some(index) = farthest
            && away(index) > NEAR
        {
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
