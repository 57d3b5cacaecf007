//! The rows of the CSV files of a run folder.

use crate::outcome::number_rows::rows;

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
}

#[cfg(test)]
mod tests {
    use std::fmt::Debug;

    use serde::Serialize;
    use serde::de::DeserializeOwned;

    use super::*;
    use crate::outcome::number_rows::{NumberColumn, NumberRow};
    use crate::outcome::record::{BlockedRow, ConstrictionRow, RetainedRow, VoidRow};
    use crate::outcome::table::csv_of;

    /// Endings of the names of columns of numbers with a point: the unit, or the total that the number is a
    /// share of.
    const UNITS: [&str; 6] = ["_mm", "_fraction", "_by_mass", "_by_number", "_over_k0", "conductance"];

    /// The columns of a type, which its CSV file has in this order, and from which its rows come back.
    fn has_its_columns<R: NumberRow + Serialize + DeserializeOwned + PartialEq + Debug>(row: R) {
        let rows = [row];
        let columns = R::columns(&rows);
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        let csv = String::from_utf8(csv_of(&rows)).unwrap();
        assert_eq!(csv.lines().next().unwrap(), names.join(","));
        for (name, numbers) in &columns {
            let has_unit = UNITS.iter().any(|unit| name.ends_with(unit));
            assert_eq!(matches!(numbers, NumberColumn::Floats(_)), has_unit, "{name}");
        }
        let given = |name: &str| columns.iter().find(|(column, _)| *column == name).unwrap().1.clone();
        assert_eq!(R::rows::<()>(|name, _| Ok(given(name))), Ok(Some(rows.into())));
        // A column that is too short, or of another kind, makes no rows.
        let short = |name: &str, like| Ok(if name == names[1] { like } else { given(name) });
        assert_eq!(R::rows::<()>(short), Ok(None));
        let truth = NumberColumn::Floats(vec![1.0]);
        assert_eq!(R::rows::<()>(|_, _| Ok(truth.clone())), Ok(None));
        assert_eq!(R::rows(|_, _| Err("there is none")), Err("there is none"));
    }

    #[test]
    fn a_table_of_a_run_has_the_same_columns_wherever_it_is_written() {
        let (replicate, run, increment) = (1, 2, 3);
        has_its_columns(FlowRow { replicate, run, increment, k_over_k0: 0.5, closed_flow_fraction: 0.01 });
        has_its_columns(SeriesRow {
            replicate,
            run,
            increment,
            inserted: 4,
            moving: 5,
            eroded: 6,
            retained_in_constrictions: 7,
            retained_in_voids: 8,
            trapped: 9,
            blocked: 10,
            eroded_mass_fraction: 0.25,
        });
        has_its_columns(LayerRow {
            replicate,
            run,
            layer: 0,
            constrictions: 4,
            blocked: 3,
            retained_in_constrictions: 2,
            retained_in_voids: 1,
        });
        let (percent_finer_by_mass, percent_finer_by_number) = (12.5, 25.0);
        has_its_columns(SizeRow {
            replicate,
            run,
            increment,
            diameter_mm: 0.1,
            percent_finer_by_mass,
            percent_finer_by_number,
        });
        has_its_columns(BlockedRow { run, increment, constriction: 4 });
        has_its_columns(VoidRow { void: 1, layer: 2, x_mm: 0.5, y_mm: -0.0, z_mm: 1e-300 });
        has_its_columns(RetainedRow {
            run,
            increment,
            void: -1,
            retained_in_constrictions: 4,
            retained_in_voids: 5,
        });
        has_its_columns(ConstrictionRow {
            constriction: 0,
            from: -1,
            to: 5,
            dx_mm: 0.1,
            dy_mm: 0.2,
            dz_mm: 0.3,
            diameter_mm: 0.4,
            conductance: 0.5,
        });
    }
}
