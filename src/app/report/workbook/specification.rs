//! The workbook of a specification.

use super::sheet::Sheet;
use crate::outcome::table::Columns;
use crate::words::products::{columns as product_columns, product as product_result};
use crate::words::specification::{
    StepRow, beside_limits, limit_columns, no_band, step_rows, still_to_set, without_margin,
};
use crate::words::{dispersive_limit, row_note};
use voidwalk_practice::design::Specification;
use voidwalk_practice::design::size_band::BandSize;
use voidwalk_practice::quantity::SizeUnit;

/// Cautions that the page has too.
const CAUTIONS: [(&str, &str); 3] = [
    ("Fines", "At most 5 % may be finer than 0.075 mm, and these fines must not be plastic."),
    ("Segregation", "Segregation is not checked: the maximum D90F is still to be set (see its step)."),
    ("Use", "It does not replace a filter test or a designer’s judgement."),
];

/// Sheets of the workbook.
pub(super) fn sheets(design: &Specification) -> Vec<Sheet> {
    vec![summary(design), limits(design), band(design), products(design), steps(design), base(design)]
}

fn summary(design: &Specification) -> Sheet {
    let d15 = design.band.as_ref().map(|band| band.d15_mm());
    let mut sheet = Sheet::items("Specification");
    sheet.item("Base", &design.base, "");
    sheet.item("Dispersive", design.dispersive, "");
    sheet.item("Minimum D15F, which drains the base", design.d15f_min_mm, "mm");
    sheet.item("Maximum D15F, which retains the base", design.d15f_max_mm, "mm");
    let mm = SizeUnit::Mm;
    let dispersive = design.if_dispersive.map(|limit| format!("D15F {}", dispersive_limit(limit, mm)));
    sheet.item("Maximum D15F if the base is dispersive (not stated)", dispersive, "");
    sheet.item("Maximum D15F set by", design.set_by(), "");
    sheet.item("Margin", without_margin(design, mm), "");
    sheet.item("D15F of the band, fine side", d15.map(|d15| d15[0]), "mm");
    sheet.item("D15F of the band, coarse side", d15.map(|d15| d15[1]), "mm");
    sheet.item("No band, because", design.no_band.as_ref().map(|why| no_band(why, mm)), "");
    design.notes.iter().for_each(|row| sheet.item("Warning", row_note(row, SizeUnit::Mm), ""));
    sheet.item("Still to be set", still_to_set(design, mm), "");
    sheet.item("Basis", "By the rules of practice alone, without a walk.", "");
    CAUTIONS.iter().for_each(|(item, caution)| sheet.item(item, *caution, ""));
    sheet.item("voidwalk", &design.version, "");
    sheet
}

fn limits(design: &Specification) -> Sheet {
    let (note, first) = (beside_limits(design, SizeUnit::Mm), design.limits.first());
    let columns = limit_columns().column("Note", |limit| note.clone().filter(|_| Some(limit) == first));
    Sheet::of("Limits", &columns, &design.limits)
}

fn band(design: &Specification) -> Sheet {
    let columns = Columns::default()
        .column("Finer by mass (%)", |size: &BandSize| size.percent)
        .column("Least size (mm)", |size| size.min_mm)
        .column("Greatest size (mm)", |size| size.max_mm);
    Sheet::of("Band", &columns, design.band.iter().flat_map(|band| &band.sizes))
}

fn products(design: &Specification) -> Sheet {
    let columns = product_columns(SizeUnit::Mm)
        .column("Fits", |product| product.fits())
        .column("Result", |product| product_result(design, product));
    Sheet::of("Products", &columns, &design.products)
}

fn steps(design: &Specification) -> Sheet {
    let columns = Columns::default()
        .column("Step", |row: &StepRow| row.step)
        .column("What is done", |row| row.does.clone())
        .column("Quantity", |row| row.quantity.clone())
        .column("Value", |row| row.value)
        .column("Unit", |row| row.unit.clone())
        .column("Formula", |row| row.formula.clone())
        .column("Note", |row| row.note.clone())
        .column("Source", |row| row.source.clone());
    Sheet::of("Steps", &columns, &design.steps.iter().flat_map(step_rows).collect::<Vec<_>>())
}

fn base(design: &Specification) -> Sheet {
    let columns = Columns::default()
        .column("Curve", |row: &(String, &str, [f64; 2])| row.0.clone())
        .column("Grading", |row| row.1.to_owned())
        .column("Size (mm)", |row| row.2[0])
        .column("Finer by mass (%)", |row| row.2[1]);
    let gradings = design.curves.iter().flat_map(|curve| {
        [(&curve.curve, "as sampled", &curve.gradation), (&curve.curve, "regraded", &curve.regraded)]
    });
    let rows = gradings
        .flat_map(|(curve, grading, rows)| rows.iter().map(move |row| (curve.clone(), grading, *row)));
    Sheet::of("Base", &columns, &rows.collect::<Vec<_>>())
}
