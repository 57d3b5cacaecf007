//! Rows of numbers, whose columns are the fields of their type: CSV, npz and Python use the same names.

/// A column of a table of numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum NumberColumn {
    /// Counts.
    Counts(Vec<u64>),
    /// Whole numbers, some of which represent things without a number.
    Whole(Vec<i64>),
    /// Numbers with a point.
    Floats(Vec<f64>),
}

/// A row of a table of numbers, whose columns are the fields of its type; `rows!` declares it.
pub trait NumberRow: Sized {
    /// Every column with its name.
    fn columns(rows: &[Self]) -> Vec<(&'static str, NumberColumn)>;

    /// The rows of columns, each requested by its name and with an empty column of its kind; `None` if the
    /// given columns differ in length or kind.
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
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
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
    /// One row of `flow.csv`: the permeability when the flow was solved; there is none without water.
    pub struct FlowRow {
        /// Counts from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Increments that were done.
        pub increment: u64,
        /// Permeability over that of the clean filter.
        pub k_over_k0: f64,
        /// Part of the inflow that went through constrictions which had closed since the flow was solved
        /// before, summed over the filter: so many on the mean way of a particle.
        pub closed_flow_fraction: f64,
    }

    /// One row of `series.csv`: the counts after an increment.
    pub struct SeriesRow {
        /// Counts from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Counts from 1.
        pub increment: u64,
        /// Particles inserted so far in this run.
        pub inserted: u64,
        /// Particles still moving.
        pub moving: u64,
        /// Particles eroded so far in this run.
        pub eroded: u64,
        /// Particles stopped by a constriction so far in this run.
        pub retained_in_constrictions: u64,
        /// Particles retained in voids so far in this run.
        pub retained_in_voids: u64,
        /// Particles trapped in closed loops.
        pub trapped: u64,
        /// Constrictions blocked.
        pub blocked: u64,
        /// Mass eroded so far over the mass that the whole run inserts.
        pub eroded_mass_fraction: f64,
    }

    /// One row of `layers.csv`: a layer when a run has ended.
    pub struct LayerRow {
        /// Counts from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// Counts from 0 where particles come in.
        pub layer: u64,
        /// Constrictions that leave the voids of this layer.
        pub constrictions: u64,
        /// Those of them that are blocked.
        pub blocked: u64,
        /// Particles of this run stopped by them.
        pub retained_in_constrictions: u64,
        /// Particles of this run retained in the voids of this layer.
        pub retained_in_voids: u64,
    }

    /// One row of `retained.csv` or `eroded.csv`: a point of the size curve of what is retained, or eroded,
    /// so far.
    pub struct SizeRow {
        /// Counts from 1.
        pub replicate: u64,
        /// 1 or 2.
        pub run: u64,
        /// The increment after which the curve was taken.
        pub increment: u64,
        /// Size (mm).
        pub diameter_mm: f64,
        /// Percent of the mass in particles no larger.
        pub percent_finer_by_mass: f64,
        /// Percent of the number in particles no larger.
        pub percent_finer_by_number: f64,
    }

    /// One row of `voids.csv`: a void of the filter, and where it lies.
    pub struct VoidRow {
        /// Counts from 0.
        pub void: u64,
        /// Counts from 0 at the start nodes, or at the first voids behind the reservoir.
        pub layer: u64,
        /// Across the flow.
        pub x_mm: f64,
        /// Across the flow.
        pub y_mm: f64,
        /// Along the flow.
        pub z_mm: f64,
    }

    /// One row of `constrictions_of_network.csv`: a constriction between two voids; -1 is the outside, before
    /// the filter as the first of the two and behind it as the second.
    pub struct ConstrictionRow {
        /// Its number in `blocked.csv`.
        pub constriction: u64,
        /// One of the voids that it joins.
        pub from: i64,
        /// The other; where constrictions have a direction, the one that it leads to.
        pub to: i64,
        /// Way from the one to the other, to the nearest of its periodic images; half a layer along the flow
        /// where either is the outside.
        pub dx_mm: f64,
        /// Along y.
        pub dy_mm: f64,
        /// Along z.
        pub dz_mm: f64,
        /// Diameter.
        pub diameter_mm: f64,
        /// Conductance times viscosity: in mm3 between the voids of a packing, in a unit of its own on a
        /// lattice; 0 where no water is reckoned with.
        pub conductance: f64,
    }

    /// One row of `blocked.csv`: a constriction that a base particle blocked.
    pub struct BlockedRow {
        /// 1 or 2.
        pub run: u64,
        /// The increment in which a particle stopped there.
        pub increment: u64,
        /// The constriction, from 0.
        pub constriction: u64,
    }

    /// One row of `retained_by_void.csv`: what a void with retained particles of a run held after an
    /// increment; void 0 has a row after each increment that was kept, whatever it holds.
    pub struct RetainedRow {
        /// 1 or 2.
        pub run: u64,
        /// Increments that were done.
        pub increment: u64,
        /// The void, from 0; -1 is the reservoir before the filter.
        pub void: i64,
        /// Particles stopped by its constrictions so far in this run.
        pub retained_in_constrictions: u64,
        /// Particles retained in it so far in this run for want of an open exit.
        pub retained_in_voids: u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::table::csv_of;
    use serde::Serialize;
    use serde::de::DeserializeOwned;
    use std::fmt::Debug;

    /// Endings of the names of columns of numbers with a point: the unit, or the total that the number is a
    /// share of.
    const UNITS: [&str; 6] = ["_mm", "_fraction", "_by_mass", "_by_number", "_over_k0", "conductance"];

    /// The CSV file of a type has its columns in this order, and its rows come back from them.
    fn has_its_columns<R: NumberRow + Serialize + DeserializeOwned + PartialEq + Debug>() {
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
        // A column that is too short, or of another kind, makes no rows.
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
