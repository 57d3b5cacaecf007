//! Writes packings, and other points with numbers, as files.

use super::grains::{Cell, Packing};
use std::fmt::Write;

impl Packing {
    /// This packing as CSV: the cell, a header, a row per grain. [`Packing::parse`] reads the same bits back.
    pub fn to_csv(&self) -> String {
        let mut text = match self.cell {
            Cell::Periodic([x, y, z]) => format!("# cell_mm = {x}, {y}, {z}\n"),
            Cell::Free => String::from("# cell = none\n"),
        };
        text.push_str("x_mm,y_mm,z_mm,diameter_mm\n");
        for i in 0..self.diameter.len() {
            // Writing to a String never fails.
            let _ = writeln!(text, "{},{},{},{}", self.x[i], self.y[i], self.z[i], self.diameter[i]);
        }
        text
    }

    /// The grains for ParaView: points (mm) with their diameter, to be shown as spheres.
    pub fn to_vtp(&self) -> String {
        let points: Vec<[f64; 3]> =
            (0..self.diameter.len()).map(|i| [self.x[i], self.y[i], self.z[i]]).collect();
        vtp_points(&points, &[("diameter_mm", &self.diameter)])
    }
}

/// Writes points with named numbers, a column each, as a VTK PolyData file.
pub fn vtp_points(points: &[[f64; 3]], columns: &[(&str, &[f64])]) -> String {
    let count = points.len();
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
         <PolyData>\n<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData>\n"
    );
    for (name, values) in columns {
        let _ = writeln!(text, "<DataArray type=\"Float64\" Name=\"{name}\" format=\"ascii\">");
        values.iter().for_each(|value| {
            let _ = writeln!(text, "{value}");
        });
        text.push_str("</DataArray>\n");
    }
    text.push_str(
        "</PointData>\n<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n",
    );
    for [x, y, z] in points {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    text.push_str("</DataArray>\n</Points>\n<Verts>\n");
    for (name, first) in [("connectivity", 0), ("offsets", 1)] {
        let _ = writeln!(text, "<DataArray type=\"Int64\" Name=\"{name}\" format=\"ascii\">");
        for i in first..first + count {
            let _ = writeln!(text, "{i}");
        }
        text.push_str("</DataArray>\n");
    }
    text.push_str("</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n");
    text
}
