//! Unstructured grids of VTK, for ParaView: `.vtu` with its numbers in binary at its end.

use std::fmt::Write;

/// Kind of each cell of a grid, by VTK's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellKind {
    /// One point.
    Vertex,
    /// Two ends.
    Line,
    /// Eight corners.
    Hexahedron,
}

impl CellKind {
    fn number(self) -> u8 {
        match self {
            Self::Vertex => 1,
            Self::Line => 3,
            Self::Hexahedron => 12,
        }
    }

    fn corners(self) -> usize {
        match self {
            Self::Vertex => 1,
            Self::Line => 2,
            Self::Hexahedron => 8,
        }
    }
}

/// Points, cells between them, and named numbers of each cell.
pub(super) struct Grid<'a> {
    /// x, y, z of each point.
    pub points: &'a [[f64; 3]],
    /// The kind of every cell.
    pub kind: CellKind,
    /// Points of the cells, cell by cell.
    pub corners: &'a [i64],
    /// A number of each cell, by name.
    pub columns: &'a [(String, Vec<f64>)],
}

impl Grid<'_> {
    /// The file: a head with the beginning of each array, then the arrays, each after its length in bytes.
    pub(super) fn file(&self) -> Vec<u8> {
        let cells = self.corners.len() / self.kind.corners();
        let (mut head, mut data) = (String::new(), Vec::new());
        // Writing to a string cannot fail.
        let _ = write!(
            head,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece \
             NumberOfPoints=\"{}\" \
             NumberOfCells=\"{cells}\">\n<Points>\n",
            self.points.len()
        );
        let mut array = |head: &mut String, kind: &str, name: &str, more: &str, bytes: Vec<u8>| {
            let offset = data.len();
            let _ = writeln!(
                head,
                "<DataArray type=\"{kind}\" Name=\"{name}\"{more} format=\"appended\" offset=\"{offset}\"/>"
            );
            data.extend((bytes.len() as u64).to_le_bytes());
            data.extend(bytes);
        };
        let floats = |all: &mut dyn Iterator<Item = f64>| all.flat_map(f64::to_le_bytes).collect::<Vec<u8>>();
        let whole = |all: &mut dyn Iterator<Item = i64>| all.flat_map(i64::to_le_bytes).collect::<Vec<u8>>();
        let points = floats(&mut self.points.iter().flatten().copied());
        array(&mut head, "Float64", "points", " NumberOfComponents=\"3\"", points);
        head.push_str("</Points>\n<Cells>\n");
        array(&mut head, "Int64", "connectivity", "", whole(&mut self.corners.iter().copied()));
        let ends = whole(&mut (1..=cells).map(|cell| (cell * self.kind.corners()) as i64));
        array(&mut head, "Int64", "offsets", "", ends);
        array(&mut head, "UInt8", "types", "", vec![self.kind.number(); cells]);
        head.push_str("</Cells>\n<CellData>\n");
        for (name, column) in self.columns {
            array(&mut head, "Float64", name, "", floats(&mut column.iter().copied()));
        }
        head.push_str("</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
        [head.as_bytes(), &data, b"\n</AppendedData>\n</VTKFile>\n"].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_array_stands_where_the_head_says() {
        let columns = [("size".to_owned(), vec![0.5, 0.25])];
        let points = [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]];
        let grid = Grid { points: &points, kind: CellKind::Vertex, corners: &[0, 1], columns: &columns };
        let file = grid.file();
        let begin = file.windows(2).position(|pair| pair == b"\n_").unwrap() + 2;
        let head = String::from_utf8(file[..begin].to_vec()).unwrap();
        let at = |name: &str| -> usize {
            let (_, rest) = head.split_once(&format!("Name=\"{name}\"")).unwrap();
            rest.split_once("offset=\"").unwrap().1.split('"').next().unwrap().parse().unwrap()
        };
        let word = |at: usize| file[begin + at..begin + at + 8].try_into().unwrap();
        for (name, bytes) in
            [("points", 48), ("connectivity", 16), ("offsets", 16), ("types", 2), ("size", 16)]
        {
            assert_eq!(u64::from_le_bytes(word(at(name))), bytes, "{name}");
        }
        assert_eq!(f64::from_le_bytes(word(at("points") + 8 + 40)), 5.0);
        assert_eq!(i64::from_le_bytes(word(at("offsets") + 8 + 8)), 2);
        assert_eq!(f64::from_le_bytes(word(at("size") + 8)), 0.5);
    }
}
