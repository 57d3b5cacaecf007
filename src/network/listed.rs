//! Constrictions that a file lists twice.

/// Two rows that are one constriction, where at least half of all rows are listed twice: there and back, as
/// in lists of neighbours, or the same row again. One constriction would be two, of which one stays open when
/// the other is blocked. Some voids may well be joined by several constrictions of one size.
pub(super) fn listed_twice(rows: impl Iterator<Item = ([i64; 2], [f64; 2])>) -> Option<[usize; 2]> {
    let key = |(row, ([a, b], sizes)): (usize, ([i64; 2], [f64; 2]))| {
        ((a.min(b), a.max(b), sizes.map(f64::to_bits)), a > b, row)
    };
    let mut rows: Vec<_> =
        rows.enumerate().map(key).filter(|row| row.0.0 >= 0 && row.0.0 < row.0.1).collect();
    rows.sort_unstable();
    let are_alike = rows.windows(2).all(|pair| pair[0].0.2 == pair[1].0.2);
    let (mut twice, mut first) = (0, None);
    for same in rows.chunk_by(|a, b| a.0 == b.0) {
        let (one, other) = (&same[0], &same[same.len() - 1]);
        // Where all constrictions are alike, those of one direction may be several.
        if same.len() > 1 && (one.1 != other.1 || !are_alike) {
            twice += same.len();
            first = first.or(Some([one.2.min(other.2), one.2.max(other.2)]));
        }
    }
    first.filter(|_| 2 * twice >= rows.len())
}
