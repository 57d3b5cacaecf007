//! What practice says of all samples of a filter: how many are met, and which governs drainage.

use super::batch::BatchRow;
use super::practice::DRAINAGE_UNKNOWN;
use crate::outcome::numbers::rounded_up;

/// How many samples a filter retains; how many it may not drain, and of how many that is not known, where it
/// does not drain all.
pub fn counts_in_words(rows: &[BatchRow], filter: &str) -> String {
    let of_filter = || rows.iter().filter(|row| row.filter == filter);
    let samples = of_filter().count();
    let one_or_more = if samples == 1 { "sample" } else { "samples" };
    let [met, not_met, none] =
        [Some(true), Some(false), None].map(|met| of_filter().filter(|row| row.met == met).count());
    let dry = of_filter().filter(|row| row.drains == Some(false)).count();
    let open = of_filter().filter(|row| row.drains.is_none() && row.d15f_min_mm.is_some()).count();
    let drainage = [(dry, "may not drain"), (open, DRAINAGE_UNKNOWN)].into_iter();
    let drainage = drainage.filter(|(count, _)| *count > 0);
    let drainage: String = drainage.map(|(count, what)| format!("; {count} {what}")).collect();
    let on_condition = match of_filter().filter(|row| row.breaks_if_dispersive).count() {
        0 => String::new(),
        count => format!(" ({count} of them unless the base is dispersive)"),
    };
    let others = format!("{not_met} not met, {none} without a result{drainage}");
    format!("of {samples} {one_or_more} {met} met{on_condition}, {others}")
}

/// The sample that asks a filter for the maximum D15F to drain, in words; `None` where it drains all, or
/// without a limit.
pub fn governs_drainage(rows: &[BatchRow], filter: &str) -> Option<String> {
    let of_filter = rows.iter().filter(|row| row.filter == filter && row.drains != Some(true));
    let limits = of_filter.filter_map(|row| Some((row.d15f_min_mm?, row)));
    let (least, row) = limits.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let limit = match row.d15f_min_at_most {
        true => format!("the minimum D15F is not known, and at most {} mm", rounded_up(least)),
        false => format!("D15F {} mm or more", rounded_up(least)),
    };
    Some(format!("drainage is governed by {}: {limit}", row.sample))
}
