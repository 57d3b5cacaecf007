//! Rows of numbers whose columns are the fields of their type: CSV, npz and Python use the same names.
//!
//! `metrics` and `recorder` fill them. A further column has `#[serde(default)]`, as pages and exports read
//! files of older runs, and checkpoints hold rows. The name of a fraction, size or other float ends as in
//! `UNITS` of the tests. `tests/commands/scene.rs` has the headers, `src/docs/files.md` their meaning.

/// Column of a table of numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum NumberColumn {
    /// Counts.
    Counts(Vec<u64>),
    /// Whole numbers; some values stand for things without a number.
    Whole(Vec<i64>),
    /// Floating-point numbers.
    Floats(Vec<f64>),
}

/// Row of a table of numbers whose columns are the fields of its type; declared by `rows!`.
pub trait NumberRow: Sized {
    /// All columns with their names.
    fn columns(rows: &[Self]) -> Vec<(&'static str, NumberColumn)>;

    /// Builds rows from columns, each requested by its name and with an empty column of its kind; `None`
    /// if the given columns differ in length or kind.
    ///
    /// # Errors
    /// Returns the errors of `column`.
    fn rows<E>(
        column: impl FnMut(&'static str, NumberColumn) -> Result<NumberColumn, E>,
    ) -> Result<Option<Vec<Self>>, E>;
}

macro_rules! numbers {
    ($($kind:ty: $variant:ident),*) => { $(
        impl From<Vec<$kind>> for NumberColumn {
            fn from(column: Vec<$kind>) -> Self {
                Self::$variant(column)
            }
        }

        impl TryFrom<NumberColumn> for Vec<$kind> {
            type Error = NumberColumn;

            fn try_from(column: NumberColumn) -> Result<Self, NumberColumn> {
                if let NumberColumn::$variant(column) = column { Ok(column) } else { Err(column) }
            }
        }
    )* };
}

numbers!(u64: Counts, i64: Whole, f64: Floats);

/// Declares rows of a table of numbers: CSV, npz and Python take their columns from the fields.
macro_rules! rows {
    ($($(#[$about:meta])* pub struct $row:ident {
        $($(#[$what:meta])* pub $field:ident: $kind:ty,)*
    })*) => { $(
        $(#[$about])*
        #[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
        pub struct $row {
            $($(#[$what])* pub $field: $kind,)*
        }

        impl NumberRow for $row {
            fn columns(rows: &[Self]) -> Vec<(&'static str, NumberColumn)> {
                vec![$((
                    stringify!($field),
                    rows.iter().map(|row| row.$field).collect::<Vec<$kind>>().into(),
                )),*]
            }

            fn rows<E>(
                mut column: impl FnMut(&'static str, NumberColumn) -> Result<NumberColumn, E>,
            ) -> Result<Option<Vec<Self>>, E> {
                $(let Ok($field): Result<Vec<$kind>, _> =
                    column(stringify!($field), Vec::<$kind>::new().into())?.try_into()
                else {
                    return Ok(None);
                };)*
                let counts = [$($field.len()),*];
                let differ = counts.iter().any(|count| *count != counts[0]);
                Ok((!differ).then(|| (0..counts[0]).map(|at| Self { $($field: $field[at]),* }).collect()))
            }
        }
    )* };
}
rows! {
    /// Row of `flow.csv`: permeability when the flow was solved; there are no rows without water.
    pub struct FlowRow {
        /// Replicate, counted from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Number of increments completed.
        pub increment: u64,
        /// Permeability over that of the clean filter.
        pub k_over_k0: f64,
        /// Fraction of the inflow through constrictions that had closed since the previous flow solution,
        /// summed over the filter: their mean number on the way of a particle.
        pub closed_flow_fraction: f64,
    }

    /// Row of `series.csv`: counts after an increment.
    pub struct SeriesRow {
        /// Replicate, counted from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Increment, counted from 1.
        pub increment: u64,
        /// Number of particles inserted so far in this run.
        pub inserted: u64,
        /// Number of particles still moving.
        pub moving: u64,
        /// Number of particles eroded so far in this run.
        pub eroded: u64,
        /// Number of particles stopped by a constriction so far in this run.
        pub retained_in_constrictions: u64,
        /// Number of particles retained in voids so far in this run.
        pub retained_in_voids: u64,
        /// Number of particles trapped in closed loops.
        pub trapped: u64,
        /// Number of blocked constrictions.
        pub blocked: u64,
        /// Mass eroded so far over the mass that the whole run inserts.
        pub eroded_mass_fraction: f64,
    }

    /// Row of `layers.csv`: a layer at the end of a run.
    pub struct LayerRow {
        /// Replicate, counted from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Layer, counted from 0 at the inlet.
        pub layer: u64,
        /// Number of constrictions that leave the voids of this layer.
        pub constrictions: u64,
        /// Number of these constrictions that are blocked.
        pub blocked: u64,
        /// Number of particles of this run stopped by them.
        pub retained_in_constrictions: u64,
        /// Number of particles of this run retained in the voids of this layer.
        pub retained_in_voids: u64,
    }

    /// Row of `retained.csv` or `eroded.csv`: a point of the size curve of the mass retained or eroded so
    /// far.
    pub struct SizeRow {
        /// Replicate, counted from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Increment after which the curve was recorded.
        pub increment: u64,
        /// Size (mm).
        pub diameter_mm: f64,
        /// Percent of the mass in particles of at most this size.
        pub percent_finer_by_mass: f64,
        /// Percent of the number in particles of at most this size.
        pub percent_finer_by_number: f64,
    }

    /// Row of `voids.csv`: a void of the filter with its position.
    pub struct VoidRow {
        /// Void, counted from 0.
        pub void: u64,
        /// Layer, counted from 0 at the start nodes, or at the first voids downstream of the reservoir.
        pub layer: u64,
        /// Position across the flow.
        pub x_mm: f64,
        /// Position across the flow.
        pub y_mm: f64,
        /// Position along the flow.
        pub z_mm: f64,
    }

    /// Row of `constrictions_of_network.csv`: a constriction between two voids; -1 is the outside,
    /// upstream of the filter as the first of the two and downstream as the second.
    pub struct ConstrictionRow {
        /// Number of the constriction in `blocked.csv`.
        pub constriction: u64,
        /// First of the two voids that it joins.
        pub from: i64,
        /// Second void; the one that it leads to if constrictions have a direction.
        pub to: i64,
        /// Distance along x from the first to the nearest periodic image of the second; half a layer
        /// along the flow if either is the outside.
        pub dx_mm: f64,
        /// Distance along y.
        pub dy_mm: f64,
        /// Distance along z.
        pub dz_mm: f64,
        /// Diameter.
        pub diameter_mm: f64,
        /// Conductance times viscosity: in mm3 between the voids of a packing, in an arbitrary unit on a
        /// lattice; 0 without water.
        pub conductance: f64,
    }

    /// Row of `blocked.csv`: a constriction that a base particle blocked.
    pub struct BlockedRow {
        /// 1 or 2.
        pub run: u64,
        /// Increment in which a particle stopped there.
        pub increment: u64,
        /// Constriction, counted from 0.
        pub constriction: u64,
    }

    /// Row of `retained_by_void.csv`: contents of a void with retained particles of a run after an
    /// increment; void 0 has a row after each recorded increment, even if it is empty.
    pub struct RetainedRow {
        /// 1 or 2.
        pub run: u64,
        /// Number of increments completed.
        pub increment: u64,
        /// Void, counted from 0; -1 is the reservoir upstream of the filter.
        pub void: i64,
        /// Number of particles stopped by its constrictions so far in this run.
        pub retained_in_constrictions: u64,
        /// Number of particles retained in it so far in this run because no exit was open.
        pub retained_in_voids: u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::table::csv_of;
    use serde::Serialize;
    use std::fmt::Debug;

    /// Endings of the names of floating-point columns: the unit, or the total that a fraction refers to.
    const UNITS: [&str; 6] = ["_mm", "_fraction", "_by_mass", "_by_number", "_over_k0", "conductance"];

    /// Checks that the CSV file of a type has its columns in this order, and that its rows can be read back.
    fn has_its_columns<R: NumberRow + Serialize + Default + PartialEq + Debug>() {
        let mut count = 0u8;
        let another = |_: &str, kind| {
            count += 1;
            Ok::<_, ()>(match kind {
                NumberColumn::Counts(_) => vec![u64::from(count)].into(),
                NumberColumn::Whole(_) => vec![-i64::from(count)].into(),
                NumberColumn::Floats(_) => vec![1e-300 * f64::from(count)].into(),
            })
        };
        let rows: Vec<R> = R::rows(another).unwrap().unwrap();
        let columns = R::columns(&rows);
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        let csv = String::from_utf8(csv_of(&rows)).unwrap();
        assert_eq!(csv.lines().next().unwrap(), names.join(","));
        for (name, numbers) in &columns {
            let has_unit = UNITS.iter().any(|unit| name.ends_with(unit));
            assert_eq!(matches!(numbers, NumberColumn::Floats(_)), has_unit, "{name}");
        }
        let given = |name: &str| columns.iter().find(|(column, _)| *column == name).unwrap().1.clone();
        assert_eq!(R::rows::<()>(|name, _| Ok(given(name))), Ok(Some(rows)));
        // A column that is too short or of another kind gives no rows.
        let short = |name: &str, like| Ok(if name == names[1] { like } else { given(name) });
        assert_eq!(R::rows::<()>(short), Ok(None));
        let truth = NumberColumn::Floats(vec![1.0]);
        assert_eq!(R::rows::<()>(|_, _| Ok(truth.clone())), Ok(None));
        assert_eq!(R::rows(|_, _| Err("there is none")), Err("there is none"));
    }

    #[test]
    fn a_table_of_a_run_has_the_same_columns_wherever_it_is_written() {
        has_its_columns::<FlowRow>();
        has_its_columns::<SeriesRow>();
        has_its_columns::<LayerRow>();
        has_its_columns::<SizeRow>();
        has_its_columns::<BlockedRow>();
        has_its_columns::<VoidRow>();
        has_its_columns::<RetainedRow>();
        has_its_columns::<ConstrictionRow>();
    }
}
