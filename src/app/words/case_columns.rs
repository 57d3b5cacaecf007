//! The columns that the tables of campaigns and of batches share.

use super::base_size::{base_size, grading};
use crate::outcome::BaseSize;
use crate::outcome::record::{Ratios, Statistic};
use crate::outcome::table::{Columns, Emphasis, TableCell};
use voidwalk_practice::quantity::{SizeUnit, length, percent, significant, whole};

/// Mass eroded in a run, and its range if the constriction curve is a range.
type Eroded = (Option<Statistic>, Option<[f64; 2]>);

/// A thickness, true if it is a multiple of D0F instead of mm, and layers.
type Thickness = (Option<f64>, bool, Option<u64>);

impl<'a, T: 'a> Columns<'a, T> {
    /// Adds the number of rules of practice that are broken.
    pub(super) fn broken_rules(self, name: &str, heading: &str, count_of: fn(&T) -> Option<usize>) -> Self {
        let doubt = move |row: &T| count_of(row).filter(|count| *count > 0).map(|_| Emphasis::Doubt);
        self.column(name, count_of)
            .page_number(heading, move |row| count_of(row).shown().emphasised(doubt(row)))
    }

    /// Adds D15F over D85B, whose base a page names below it, and over D95B; a page shows them after the
    /// eroded mass.
    pub(crate) fn ratios(
        self,
        decimals: usize,
        unit: SizeUnit,
        ratios_of: fn(&T) -> (Ratios, Option<BaseSize>),
    ) -> Self {
        let d85b = move |row: &T| significant(ratios_of(row).0.d15f_over_d85b).shown();
        self.digits("d15f_over_d85b", decimals, move |row| Some(ratios_of(row).0.d15f_over_d85b))
            .page_number("D15F/ D85B", move |row| {
                d85b(row).below(ratios_of(row).1.map(|base| base_size(&base, unit)))
            })
            .place(1)
            .digits("d15f_over_d95b", decimals, move |row| Some(ratios_of(row).0.d15f_over_d95b))
            .page_number("D15F/ D95B", move |row| ratios_of(row).0.d15f_over_d95b)
            .place(1)
            .column("d85b_of", move |row| ratios_of(row).1.map(|base| grading(&base)))
    }

    /// Adds the mass eroded in the first run and in the second, with its interval and, on a page, its range
    /// if the constriction curve is a range.
    pub(crate) fn eroded(self, eroded_of: fn(&T, usize) -> Eroded) -> Self {
        let cell = move |row: &T, run| {
            let (statistic, range) = eroded_of(row, run);
            let curve = |[low, high]: [f64; 2]| format!("curve: {} to {}", percent(low), percent(high));
            statistic.shown().below(range.map(curve))
        };
        self.statistic(["first_eroded_mass_percent", "first_low", "first_high"], move |row| {
            eroded_of(row, 0).0
        })
        .page_number("Eroded, first run", move |row| cell(row, 0))
        .statistic(["second_eroded_mass_percent", "second_low", "second_high"], move |row| {
            eroded_of(row, 1).0
        })
        .page_number("second run", move |row| cell(row, 1))
    }

    /// Adds the thickness of the filter: in a file in mm alone, on a page with its unit and, if given,
    /// layers.
    pub(super) fn thickness(
        self,
        decimals: usize,
        unit: SizeUnit,
        thickness_of: fn(&T) -> Thickness,
    ) -> Self {
        let in_mm = move |row: &T| thickness_of(row).0.filter(|_| !thickness_of(row).1);
        self.digits("thickness_mm", decimals, in_mm).page_number("Thickness", move |row| {
            let (thickness, scale_free, layers) = thickness_of(row);
            let layers = layers.map(|layers| format!("{} layers", whole(layers)));
            let unit = if scale_free { SizeUnit::D0f } else { unit };
            thickness.map(|thickness| length(thickness, unit)).shown().below(layers)
        })
    }
}
