//! Networks in CSV files.
//!
//! Header `from,to,diameter_mm`. A row `FROM,TO,D` is a constriction from void FROM to void TO; `TO` =
//! `end` leaves the filter. The row `start,ID,` makes void ID a start node. Void ids run from 0 without
//! gaps. The exits of a void keep the order of their rows. Lines that begin with `#` are comments; `#
//! shape = nx, ny, nz` marks the cubic lattice, whose exits must be the +x, +y, +z exits of that lattice.

use super::in_order_of_voids;
use super::{END, Network};
use std::io::Write;

/// Memory of one void of a cubic lattice during a walk (bytes): three constrictions, tables and tallies.
const BYTES_A_VOID: f64 = 215.0;

/// Reasons why a network cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// Lattice without voids, or with more constrictions than 32 bits can count.
    #[error(
        "network of {} x {} x {} voids: every length must be at least 1 and 3 nx ny nz below 4294967295; \
         this one would take {:.2e} bytes",
        shape[0], shape[1], shape[2], shape.iter().map(|&n| f64::from(n)).product::<f64>() * BYTES_A_VOID
    )]
    Shape {
        /// Number of voids along x, y, z.
        shape: [u32; 3],
    },
    /// Number of diameters that does not match the lattice.
    #[error("a lattice of {shape:?} voids has {expected} constrictions, but {found} diameters were given")]
    WrongLength {
        /// Number of voids along x, y, z.
        shape: [u32; 3],
        /// Number of constrictions of that lattice.
        expected: usize,
        /// Number of diameters given.
        found: usize,
    },
    /// Invalid diameter or conductance.
    #[error("constriction {constriction} has {quantity} {value}: it must be finite and not negative")]
    Number {
        /// Quantity of the constriction.
        quantity: &'static str,
        /// Number of the constriction, counted from 0.
        constriction: usize,
        /// Value found.
        value: String,
    },
    /// Voids and constrictions that do not form a passable network.
    #[error("the network cannot be walked: {problem}")]
    Unlinked {
        /// Description of the problem.
        problem: String,
    },
    /// Impossible distribution of connectivity.
    #[error("connectivity {value} is not allowed; {allowed}")]
    Connectivity {
        /// Value given.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// Loops whose exit is hardly ever taken.
    #[error(
        "a network has loops with so narrow a way out that the fate of a particle there is still unknown \
         after {sweeps} sweeps over its voids"
    )]
    NarrowWayOut {
        /// Number of sweeps over all voids.
        sweeps: usize,
    },
    /// Row that cannot be read.
    #[error("{file}, line {line}, {field}: `{value}` is not allowed; {allowed}")]
    Row {
        /// Name of the file.
        file: String,
        /// Line number, counted from 1.
        line: u64,
        /// Name of the field.
        field: &'static str,
        /// Value in the file.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// Readable rows that do not form a network.
    #[error("{file}: {problem}")]
    Whole {
        /// Name of the file.
        file: String,
        /// Problem of the file as a whole.
        problem: String,
    },
}

impl NetworkError {
    /// Error of an invalid diameter, in units of the network.
    pub(super) fn diameter(constriction: usize, value: f32) -> Self {
        Self::Number { quantity: "diameter", constriction, value: value.to_string() }
    }

    pub(super) fn whole(file: &str, problem: impl Into<String>) -> Self {
        Self::Whole { file: file.into(), problem: problem.into() }
    }
}

/// Refusal of voids and constrictions that do not form a network.
pub(super) fn unlinked<T>(problem: impl Into<String>) -> Result<T, NetworkError> {
    Err(NetworkError::Unlinked { problem: problem.into() })
}

impl Network {
    /// Reads a network from CSV text; `file` names it in errors.
    ///
    /// # Errors
    /// Errors state the file, line, field, value and the allowed values.
    pub fn from_csv(bytes: &[u8], file: &str, unit_mm: f64) -> Result<Self, NetworkError> {
        Rows::parse(bytes, file)?.into_network(file, unit_mm)
    }

    /// Writes the network as CSV, such that [`Network::from_csv`] restores it to the bit.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write_csv(&self, mut out: impl Write) -> std::io::Result<()> {
        if let Some([nx, ny, nz]) = self.shape {
            writeln!(out, "# shape = {nx}, {ny}, {nz}")?;
        }
        writeln!(out, "from,to,diameter_mm")?;
        for &void in &self.start {
            writeln!(out, "start,{void},")?;
        }
        for void in 0..self.voids() as u32 {
            for exit in self.exits(void) {
                let diameter_mm = f64::from(self.diameter[exit]) * self.unit_mm;
                match self.target[exit] {
                    END => writeln!(out, "{void},end,{diameter_mm:e}")?,
                    target => writeln!(out, "{void},{target},{diameter_mm:e}")?,
                }
            }
        }
        Ok(())
    }
}

#[derive(Default)]
struct Rows {
    shape: Option<[u32; 3]>,
    start: Vec<u32>,
    from: Vec<u32>,
    to: Vec<u32>,
    diameter_mm: Vec<f64>,
}

impl Rows {
    fn parse(bytes: &[u8], file: &str) -> Result<Self, NetworkError> {
        let whole = |problem: &str| NetworkError::whole(file, problem);
        let text = std::str::from_utf8(bytes).map_err(|_| whole("is not UTF-8 text"))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut rows = Self::default();
        let mut header = false;
        for (number, line) in text.lines().enumerate() {
            let line_number = number as u64 + 1;
            let row_error = |field, value: &str, allowed: &str| NetworkError::Row {
                file: file.into(),
                line: line_number,
                field,
                value: value.chars().take(60).collect(),
                allowed: allowed.into(),
            };
            let line = line.trim();
            if let Some(comment) = line.strip_prefix('#') {
                if let Some(shape) = comment.trim().strip_prefix("shape") {
                    let shape = shape.trim_start().trim_start_matches('=');
                    rows.shape = Some(parse_shape(shape).ok_or_else(|| {
                        row_error("shape", shape.trim(), "three whole numbers, as in `# shape = 40, 40, 60`")
                    })?);
                }
                continue;
            }
            if line.is_empty() {
                continue;
            }
            let fields: Vec<&str> = line.split(',').map(str::trim).collect();
            let &[from, to, diameter] = fields.as_slice() else {
                return Err(row_error("row", line, "three fields: from,to,diameter_mm"));
            };
            if !header {
                if (from, to, diameter) != ("from", "to", "diameter_mm") {
                    return Err(row_error("header", line, "the first row must be `from,to,diameter_mm`"));
                }
                header = true;
                continue;
            }
            let id = |field, value: &str| {
                let id = value.parse::<u32>().ok().filter(|&id| id != END);
                id.ok_or_else(|| row_error(field, value, "a void id: a whole number from 0 to 4294967294"))
            };
            if from == "start" {
                if !diameter.is_empty() {
                    return Err(row_error("diameter_mm", diameter, "nothing, in a `start` row"));
                }
                rows.start.push(id("to", to)?);
                continue;
            }
            rows.from.push(id("from", from)?);
            rows.to.push(if to == "end" { END } else { id("to", to)? });
            let value = diameter.parse::<f64>().ok().filter(|d| d.is_finite() && *d >= 0.0);
            rows.diameter_mm.push(
                value.ok_or_else(|| row_error("diameter_mm", diameter, "a finite number, 0 or larger"))?,
            );
        }
        if !header {
            return Err(whole("is empty: the first row must be `from,to,diameter_mm`"));
        }
        Ok(rows)
    }

    fn into_network(self, file: &str, unit_mm: f64) -> Result<Network, NetworkError> {
        let whole = |problem: String| NetworkError::whole(file, problem);
        if self.from.is_empty() {
            return Err(whole("has no constriction".into()));
        }
        if self.start.is_empty() {
            return Err(whole("has no start node: add a row `start,ID,`".into()));
        }
        let inner = self.to.iter().filter(|&&to| to != END);
        let named = self.start.iter().chain(&self.from).chain(inner).map(|&id| id as usize);
        let voids = named.clone().max().map_or(0, |last| last + 1);
        if voids > 2 * self.from.len() + self.start.len() || self.from.len() >= END as usize {
            return Err(whole(format!(
                "void ids run to {} but only {} rows name voids; number voids from 0 without gaps",
                voids - 1,
                self.from.len() + self.start.len()
            )));
        }
        let mut is_named = vec![false; voids];
        named.for_each(|id| is_named[id] = true);
        if let Some(gap) = is_named.iter().position(|&is| !is) {
            return Err(whole(format!("no row names void {gap}; number voids from 0 without gaps")));
        }
        let mut is_start = vec![false; voids];
        for &id in &self.start {
            if std::mem::replace(&mut is_start[id as usize], true) {
                return Err(whole(format!("void {id} is made a start node twice")));
            }
        }
        let ends = |(&from, &to)| [i64::from(from), if to == END { -1 } else { i64::from(to) }];
        let rows = self.from.iter().zip(&self.to).map(ends).zip(&self.diameter_mm);
        let twice = listed_twice(rows.map(|(ends, &mm)| (ends, [mm, 0.0])), true);
        if let Some(rows) = twice.filter(|_| self.shape.is_none()) {
            let [row, again] = rows.map(|row| format!("{} to {}", self.from[row], self.to[row]));
            return Err(whole(format!(
                "the rows from {row} and from {again} are one constriction listed twice (there and back, or \
                 repeated), and others are, too; keep one row of each"
            )));
        }
        let unit = |&mm: &f64| {
            let d = (mm / unit_mm) as f32;
            let is_far = !d.is_finite() || (mm > 0.0 && d < f32::MIN_POSITIVE);
            let problem = || format!("diameter {mm} mm is too far from the reference length {unit_mm} mm");
            if is_far { Err(whole(problem())) } else { Ok(d) }
        };
        let diameter = self.diameter_mm.iter().map(unit).collect::<Result<Vec<f32>, _>>()?;
        let (network, _) = Network::of_rows(voids, &self.from, &self.to, &diameter, self.start, unit_mm);
        let Some(shape) = self.shape else { return Ok(network) };
        let lattice = Network::cubic_from_diameters(shape, network.diameter, unit_mm)
            .map_err(|error| whole(error.to_string()))?;
        if lattice.target != network.target
            || lattice.start != network.start
            || lattice.exit_begin != network.exit_begin
        {
            return Err(whole(format!("says `# shape = {shape:?}`, but its rows are not that lattice")));
        }
        Ok(lattice)
    }
}

impl Network {
    /// Builds the network of directed constrictions, one per row; also returns the exit number of each.
    pub(super) fn of_rows(
        voids: usize,
        from: &[u32],
        to: &[u32],
        diameter: &[f32],
        start: Vec<u32>,
        unit_mm: f64,
    ) -> (Self, Vec<u32>) {
        let (exit_begin, slots) = in_order_of_voids(voids, from.iter().copied());
        let mut network = Self {
            exit_begin,
            target: vec![END; to.len()],
            diameter: vec![0.0; to.len()],
            start,
            layer: vec![],
            unit_mm,
            shape: None,
            undirected: None,
        };
        for ((&slot, &to), &d) in slots.iter().zip(to).zip(diameter) {
            (network.target[slot as usize], network.diameter[slot as usize]) = (to, d);
        }
        network.layer = network.distances(|_| true);
        (network, slots)
    }
}

fn parse_shape(text: &str) -> Option<[u32; 3]> {
    let lengths: Vec<u32> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    lengths.try_into().ok()
}

/// Largest relative difference between the two listings of one constriction, there and back.
const BACK: f64 = 2e-3;
/// Largest relative difference between two listings of the same row.
const AGAIN: f64 = 1e-9;
/// Number of rows below which matches may be chance.
const FEW: usize = 8;

/// Lower and higher void, sizes, true if the row leads from the higher void, row number.
type Row = ([i64; 2], [f64; 2], bool, usize);

/// Finds two rows that are one constriction, if too many rows are listed twice: there and back, as in
/// lists of neighbours, or the same row again. One constriction would become two, and one of them would
/// stay open when the other is blocked. Some pairs of voids may really have several constrictions between
/// them, so a few matches are allowed. In undirected networks the limit is half of all rows there and
/// back, whatever their sizes, or a twentieth of rows with equal sizes; in `directed` networks it is nine
/// rows in ten with equal sizes.
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
        // Two directed constrictions may join the same voids in opposite directions.
        true => twice >= 3 * FEW && 10 * twice >= 9 * rows.len(),
        false => 2 * twice >= rows.len() || !are_alike && back >= FEW && 20 * back >= rows.len(),
    };
    first.filter(|_| too_many)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Network, NetworkError> {
        Network::from_csv(text.as_bytes(), "net.csv", 2.0)
    }

    #[test]
    fn a_general_network_is_read() {
        let text =
            "\u{feff}# two voids\r\nfrom,to,diameter_mm\r\nstart,1,\r\n1,0,3\r\n0,end,1\r\n1,end,0\r\n";
        let network = read(text).unwrap();
        assert_eq!((network.voids(), network.constrictions()), (2, 3));
        assert_eq!(network.targets(), [END, 0, END]);
        assert_eq!(network.diameters(), [0.5, 1.5, 0.0]);
        assert_eq!(network.layer_of(), [1, 0]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let head = "from,to,diameter_mm\nstart,0,\n";
        for (text, message) in [
            ("", "is empty"),
            ("a,b,c\n", "line 1, header: `a,b,c` is not allowed"),
            ("from,to,diameter_mm\n0,end,1\n", "no start node"),
            (head, "has no constriction"),
            (&format!("{head}0,end\n"), "line 3, row: `0,end` is not allowed; three fields"),
            (&format!("{head}0,end,nan\n"), "line 3, diameter_mm: `nan` is not allowed; a finite number"),
            (&format!("{head}0,end,-1\n"), "`-1` is not allowed"),
            (&format!("{head}0,end,1e400\n"), "`1e400` is not allowed"),
            (&format!("{head}x,end,1\n"), "line 3, from: `x` is not allowed; a void id"),
            (&format!("{head}0,4294967295,1\n"), "line 3, to: `4294967295`"),
            (&format!("{head}0,4294967294,1\n"), "number voids from 0 without gaps"),
            (&format!("{head}0,2,1\n2,end,1\n"), "no row names void 1"),
            (&format!("{head}start,0,\n0,end,1\n"), "start node twice"),
            (&format!("{head}0,end,1e300\n"), "too far from the reference length"),
            (&format!("# shape = 2, 1\n{head}"), "line 1, shape"),
            (&format!("# shape = 1, 1, 1\n{head}0,end,1\n"), "1 diameters were given"),
            (&format!("# shape = 1, 1, 1\n{head}0,0,1\n0,end,1\n0,0,1\n"), "not that lattice"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.starts_with("net.csv") && error.contains(message), "{text:?} gave {error}");
        }
    }

    #[test]
    fn rows_that_are_listed_twice_are_refused() {
        let rows = |turned: bool| -> String {
            let row = |void: usize| {
                let (a, b) = if turned { (void + 1, void) } else { (void, void + 1) };
                format!("{a},{b},{}\n", 0.1 + 0.01 * void as f64)
            };
            (0..12).map(row).collect()
        };
        let with = |more: &str| {
            read(&format!("from,to,diameter_mm\nstart,0,\n{}{more}12,end,1\n", rows(false)))
                .map(|n| n.voids())
        };
        assert_eq!(with("").unwrap(), 13);
        for twice in [rows(true), rows(false)] {
            let error = with(&twice).unwrap_err().to_string();
            assert!(error.starts_with("net.csv: the rows from 0 to 1"), "{error}");
            assert!(error.contains("listed twice"), "{error}");
        }
    }

    proptest! {
        #[test]
        fn reading_never_panics(text in "(from,to,diameter_mm\n)?([0-9a-z,.#\\-\n ]{0,80})") {
            let _ = read(&text);
        }

        #[test]
        fn what_was_written_is_read_back(
            shape in [1u32..4, 1u32..4, 1u32..4],
            seed: u64,
            unit_mm in 1e-3f64..1e3,
        ) {
            let count = 3 * shape.iter().product::<u32>() as usize;
            let diameter = (0..count as u64)
                .map(|i| (i.wrapping_mul(seed | 1) >> 40) as f32 * 1e-5)
                .collect();
            let network = Network::cubic_from_diameters(shape, diameter, unit_mm).unwrap();
            let mut text = Vec::new();
            network.write_csv(&mut text).unwrap();
            prop_assert_eq!(Network::from_csv(&text, "net.csv", unit_mm).unwrap(), network.clone());
            // Read as a general network, it has the same voids, constrictions and layers.
            let general = text.split(|&b| b == b'\n').skip(1).collect::<Vec<_>>().join(&b'\n');
            let general = Network::from_csv(&general, "net.csv", unit_mm).unwrap();
            prop_assert_eq!(general.shape(), None);
            prop_assert_eq!(general.targets(), network.targets());
            prop_assert_eq!(general.diameters(), network.diameters());
            prop_assert_eq!(general.layer_of(), network.layer_of());
        }
    }
}
