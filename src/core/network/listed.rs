//! Constrictions that a file lists twice.

/// Allowed difference of the sizes of one constriction listed there and back, as a part of the larger.
const BACK: f64 = 2e-3;
/// Allowed difference of the sizes of a row that is listed again, as a part of the larger.
const AGAIN: f64 = 1e-9;
/// Number of rows below which partners may arise by chance.
const FEW: usize = 8;

/// Lower and higher void, sizes, whether the row leads back, and its number.
type Row = ([i64; 2], [f64; 2], bool, usize);

/// Finds two rows that are one constriction, if too many rows are listed twice: there and back, as in lists
/// of neighbours, or the same row again. One constriction would become two, and one of them would stay open
/// when the other is blocked. Some voids may well be joined by several constrictions, which can all be passed
/// both ways: half of all rows there and back, whatever their sizes, are too many, and so is a twentieth of
/// like sizes. If each row leads one way (`directed`), only nine rows of ten of like sizes are too many.
pub(super) fn listed_twice(
    rows: impl Iterator<Item = ([i64; 2], [f64; 2])>,
    directed: bool,
) -> Option<[usize; 2]> {
    let with_key = |(row, ([a, b], sizes)): (usize, ([i64; 2], [f64; 2]))| -> Row {
        ([a.min(b), a.max(b)], sizes, a > b, row)
    };
    let mut rows: Vec<Row> =
        rows.enumerate().map(with_key).filter(|row| row.0[0] >= 0 && row.0[0] < row.0[1]).collect();
    rows.sort_unstable_by(|a, b| {
        let by_size = a.1[0].total_cmp(&b.1[0]).then(a.1[1].total_cmp(&b.1[1]));
        a.0.cmp(&b.0).then(by_size).then((a.2, a.3).cmp(&(b.2, b.3)))
    });
    let like = |a: [f64; 2], b: [f64; 2], part: f64| {
        (0..2).all(|k| (a[k] - b[k]).abs() <= part * a[k].abs().max(b[k].abs()))
    };
    let are_alike = rows.windows(2).all(|pair| like(pair[0].1, pair[1].1, AGAIN));
    let (mut twice, mut back, mut first) = (0, 0, None);
    for same in rows.chunk_by(|a, b| a.0 == b.0) {
        let pairs = |turned: bool, part: f64| {
            let is_pair =
                |pair: &&[Row]| (pair[0].2 != pair[1].2) == turned && like(pair[0].1, pair[1].1, part);
            (2 * same.windows(2).filter(is_pair).count()).min(same.len())
        };
        let both_ways = same.iter().any(|row| row.2 != same[0].2);
        let (of_back, of_again) = (pairs(true, BACK), if are_alike { 0 } else { pairs(false, AGAIN) });
        let count = if both_ways && !directed { same.len() } else { (of_back + of_again).min(same.len()) };
        twice += count;
        back += of_back;
        if count > 0 && first.is_none() {
            let (one, other) = (&same[0], same.iter().find(|row| row.2 != same[0].2).unwrap_or(&same[1]));
            first = Some([one.3.min(other.3), one.3.max(other.3)]);
        }
    }
    let too_many = match directed {
        // Two of them may join the same voids, each its own way.
        true => twice >= 3 * FEW && 10 * twice >= 9 * rows.len(),
        false => 2 * twice >= rows.len() || !are_alike && back >= FEW && 20 * back >= rows.len(),
    };
    first.filter(|_| too_many)
}
