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

        impl crate::outcome::number_rows::NumberRow for $row {
            fn columns(rows: &[Self]) -> Vec<(&'static str, crate::outcome::number_rows::NumberColumn)> {
                vec![$((
                    stringify!($field),
                    rows.iter().map(|row| row.$field).collect::<Vec<$kind>>().into(),
                )),*]
            }

            fn rows<E>(
                mut column: impl FnMut(
                    &'static str,
                    crate::outcome::number_rows::NumberColumn,
                ) -> Result<crate::outcome::number_rows::NumberColumn, E>,
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
pub(crate) use rows;
