//! The workbook of a specification.

use super::sheet::{Entry, Sheet};
use crate::outcome::design::Specification;
use crate::outcome::quantity::SizeUnit;
use crate::words::products::{not_kept, product as product_result};
use crate::words::specification::{beside_limits, no_band, step_rows, still_to_set, without_margin};
use crate::words::{dispersive_limit, row_note};

/// What the page says too.
const CAUTIONS: [(&str, &str); 3] = [
    ("Fines", "At most 5 % may be finer than 0.075 mm, and these fines must not be plastic."),
    ("Segregation", "Segregation is not checked: the maximum D90F is still to be set (see its step)."),
    ("Use", "It does not replace a filter test or a designer’s judgement."),
];

/// Its sheets.
pub(super) fn sheets(of: &Specification) -> Vec<Sheet> {
    vec![summary(of), limits(of), band(of), products(of), steps(of), base(of)]
}

fn summary(of: &Specification) -> Sheet {
    let d15 = of.band.as_ref().map(|band| band.d15_mm());
    let mut sheet = Sheet::new("Specification", &["Item", "Value", "Unit"]);
    sheet.item("Base", &of.base, "");
    sheet.item("Dispersive", of.dispersive, "");
    sheet.item("Minimum D15F, which drains the base", of.d15f_min_mm, "mm");
    sheet.item("Maximum D15F, which retains the base", of.d15f_max_mm, "mm");
    let mm = SizeUnit::Mm;
    let dispersive = of.if_dispersive.map(|limit| format!("D15F {}", dispersive_limit(limit, mm)));
    sheet.item("Maximum D15F if the base is dispersive (not stated)", dispersive, "");
    sheet.item("Maximum D15F set by", of.set_by(), "");
    sheet.item("Margin", without_margin(of, mm), "");
    sheet.item("D15F of the band, fine side", d15.map(|d15| d15[0]), "mm");
    sheet.item("D15F of the band, coarse side", d15.map(|d15| d15[1]), "mm");
    sheet.item("No band, because", of.no_band.as_ref().map(|why| no_band(why, mm)), "");
    of.notes.iter().for_each(|row| sheet.item("Warning", row_note(row, SizeUnit::Mm), ""));
    sheet.item("Still to be set", still_to_set(of, mm), "");
    sheet.item("Basis", "By the rules of practice alone, without a walk.", "");
    CAUTIONS.iter().for_each(|(item, caution)| sheet.item(item, *caution, ""));
    sheet.item("voidwalk", &of.version, "");
    sheet
}

fn limits(of: &Specification) -> Sheet {
    let headings = ["Sieve", "Opening (mm)", "Least finer by mass (%)", "Greatest finer by mass (%)", "Note"];
    // Said once, beside the first sieve.
    let mut note = beside_limits(of, SizeUnit::Mm);
    let mut sheet = Sheet::new("Limits", &headings);
    for limit in &of.limits {
        sheet.row([
            (&limit.sieve).into(),
            limit.opening_mm.into(),
            limit.min_percent_finer.into(),
            limit.max_percent_finer.into(),
            note.take().into(),
        ]);
    }
    sheet
}

fn band(of: &Specification) -> Sheet {
    let mut sheet = Sheet::new("Band", &["Finer by mass (%)", "Least size (mm)", "Greatest size (mm)"]);
    for size in of.band.iter().flat_map(|band| &band.sizes) {
        sheet.row([size.percent.into(), size.min_mm.into(), size.max_mm.into()]);
    }
    sheet
}

fn products(of: &Specification) -> Sheet {
    let headings = [
        "Product",
        "D15 of the fine side (mm)",
        "D15 of the coarse side (mm)",
        "D15 of the fine side / minimum D15F (-)",
        "Maximum D15F / D15 of the coarse side (-)",
        "Fits",
        "Result",
        "What else its sides do not keep",
        "Source of its limits",
    ];
    let mut sheet = Sheet::new("Products", &headings);
    for product in &of.products {
        sheet.row([
            (&product.product).into(),
            product.d15_fine_mm.into(),
            product.d15_coarse_mm.into(),
            product.drains_by.into(),
            product.holds_by.into(),
            product.fits().into(),
            product_result(of, product).into(),
            not_kept(&product.not_kept).into(),
            (&product.source).into(),
        ]);
    }
    sheet
}

fn steps(of: &Specification) -> Sheet {
    let headings = ["Step", "What is done", "Quantity", "Value", "Unit", "Formula", "Note", "Source"];
    let mut sheet = Sheet::new("Steps", &headings);
    for row in of.steps.iter().flat_map(step_rows) {
        sheet.row([
            row.step.into(),
            row.does.into(),
            row.quantity.into(),
            row.value.into(),
            row.unit.into(),
            row.formula.into(),
            row.note.into(),
            row.source.into(),
        ]);
    }
    sheet
}

fn base(of: &Specification) -> Sheet {
    let mut sheet = Sheet::new("Base", &["Curve", "Grading", "Size (mm)", "Finer by mass (%)"]);
    for curve in &of.curves {
        for (grading, rows) in [("as sampled", &curve.gradation), ("regraded", &curve.regraded)] {
            let row = |row: &[f64; 2]| -> [Entry; 4] {
                [(&curve.curve).into(), grading.into(), row[0].into(), row[1].into()]
            };
            rows.iter().for_each(|of| sheet.row(row(of)));
        }
    }
    sheet
}
