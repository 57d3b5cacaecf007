//! Standard products that fit, in the same words on every face.

use crate::outcome::table::{Columns, TableCell};
use voidwalk_core::gradation::FINES_MM;
use voidwalk_practice::design::products::{LEAST_CU, NotKept, is_to_be_checked};
use voidwalk_practice::design::specification::{ProductMargin, Specification};
use voidwalk_practice::quantity::{SizeUnit, length, significant};
use voidwalk_practice::rules::{GREATEST_SIZE_MM, MOST_CU, WIDEST_BAND};

/// Requirements other than on D15F that the sides of a product do not keep.
fn not_kept(all: &[NotKept]) -> String {
    let one = |breach: &NotKept| match breach {
        NotKept::CuOfFineSide { cu } => cu_of("fine", *cu),
        NotKept::CuOfCoarseSide { cu } => cu_of("coarse", *cu),
        NotKept::Width { ratio } => {
            format!("its sides are {} to 1 apart, and at most {WIDEST_BAND} is allowed", significant(*ratio))
        }
        NotKept::Fines { percent } => format!("up to {percent} % may be finer than {FINES_MM} mm"),
        NotKept::GreatestSize => format!("grains may be coarser than {GREATEST_SIZE_MM} mm"),
    };
    all.iter().map(one).collect::<Vec<_>>().join("; ")
}

fn cu_of(side: &str, cu: f64) -> String {
    format!("Cu of its {side} side is {}, and {LEAST_CU} to {MOST_CU} is asked for", significant(cu))
}

/// Names of products whose limits are to be checked; `None` if there are none.
pub(crate) fn to_be_checked(products: &[ProductMargin]) -> Option<String> {
    let checked = products.iter().filter(|product| is_to_be_checked(&product.source));
    let named: Vec<&str> = checked.map(|product| product.product.as_str()).collect();
    (!named.is_empty()).then(|| format!("Limits to be checked against the standard: {}.", named.join(", ")))
}

/// Columns of `specification_products.csv` and of a workbook, and under their headings the columns of a
/// page, with sizes in this unit.
pub(crate) fn columns<'a>(unit: SizeUnit) -> Columns<'a, ProductMargin> {
    let margin = |by: Option<f64>| by.map_or("not given".shown(), |by| significant(by).shown());
    Columns::default()
        .name("product", "Product", |product: &ProductMargin| product.product.clone())
        .column("d15_fine_mm", |product| product.d15_fine_mm)
        .headed("D15 of the fine side (mm)")
        .page_number("D15, fine to coarse side (mm)", move |product| {
            length(product.d15_fine_mm, unit).to(length(product.d15_coarse_mm, unit)).in_cell()
        })
        .column("d15_coarse_mm", |product| product.d15_coarse_mm)
        .headed("D15 of the coarse side (mm)")
        .column("drains_by", |product| product.drains_by)
        .page_number("Drains: finest D15 / minimum D15F", move |product| margin(product.drains_by))
        .column("holds_by", |product| product.holds_by)
        .page_number("Retains: maximum D15F / coarsest D15", move |product| margin(product.holds_by))
        .column("not_kept", |product| not_kept(&product.not_kept))
        .page_text("Other requirements not kept", |product| {
            Some(not_kept(&product.not_kept)).filter(|words| !words.is_empty())
        })
        .column("source", |product| product.source.clone())
        .headed("Source of its limits")
}

/// Result of a standard product beside a specification.
pub(crate) fn product(specification: &Specification, product: &ProductMargin) -> String {
    match product.fits() {
        Some(true) => "fits".into(),
        Some(false) if product.not_kept.is_empty() => "does not fit".into(),
        Some(false) => format!("does not fit: {}", not_kept(&product.not_kept)),
        None if specification.d15f_min_at_most && product.drains_by.is_none() => {
            "may drain: D15B must be tested".into()
        }
        None => "no result".into(),
    }
}

/// Standard products that fit, or the closest one, in sentences, the last without its end.
pub(crate) fn products(specification: &Specification) -> String {
    let fitting = specification.products.iter().filter(|product| product.fits() == Some(true));
    let fitting: Vec<&str> = fitting.map(|product| product.product.as_str()).collect();
    if !fitting.is_empty() {
        return format!("Standard products that fit: {}", fitting.join(", "));
    }
    let other = if specification.products.iter().any(|product| product.fits() == Some(false)) {
        "other"
    } else {
        "standard"
    };
    match specification.nearest_product() {
        Some(nearest) => {
            format!("None of the standard products fits. {} comes closest by its D15", nearest.product)
        }
        None if specification.d15f_min_at_most => {
            "Whether a standard product fits is not known: D15B must be tested".into()
        }
        None => format!("No {other} product is known to fit: a limit of D15F is not known"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::{CORE, soil};
    use voidwalk_practice::SpecificationOptions;

    /// A core of category 2, for which 0.100 to 0.700 mm is allowed. C33 sand has a D15 of 0.178 to
    /// 0.424 mm and a Cu of 4.0 and 4.2, and leaves the band at 1.18 mm.
    #[test]
    fn a_product_is_tested_with_its_own_sides_and_not_by_the_band_that_was_drawn() {
        let core = Specification::of("core", &soil(&CORE), SpecificationOptions::default());
        let fits: Vec<_> = core.products.iter().filter(|product| product.fits() == Some(true)).collect();
        let [sand] = fits[..] else { panic!("{fits:?}") };
        assert_eq!((&*sand.product, &*product(&core, sand)), ("ASTM C33 fine aggregate", "fits"));
        // No. 8 stone may be delivered with a Cu of 1.6.
        let stone = core.products.iter().find(|product| product.product.contains("No. 8 ")).unwrap();
        let [NotKept::CuOfCoarseSide { cu }, ..] = stone.not_kept[..] else { panic!("{stone:?}") };
        assert!((cu - 1.59).abs() < 0.005, "{cu}");
    }
}
