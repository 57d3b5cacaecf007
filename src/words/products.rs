//! Which standard products fit, in the same words on every face.

use crate::outcome::design::specification::{ProductMargin, Specification};

/// Said of a product both whose sides keep every requirement.
pub const FITS: &str = "fits";

/// Said of a product of which D15B would tell whether it drains.
const MAY_DRAIN: &str = "may drain: D15B must be tested";

/// Said where no product fits.
const NONE_FITS: &str = "None of the standard products fits";

/// Said of a product that does not fit, with what its sides do not keep beside D15F.
fn does_not_fit(not_kept: &str) -> String {
    if not_kept.is_empty() { "does not fit".into() } else { format!("does not fit: {not_kept}") }
}

/// The result of a standard product beside a specification.
pub fn product(specification: &Specification, product: &ProductMargin) -> String {
    match product.fits() {
        Some(true) => FITS.into(),
        Some(false) => does_not_fit(&product.not_kept),
        None if specification.d15f_min_at_most && product.drains_by.is_none() => MAY_DRAIN.into(),
        None => "no result".into(),
    }
}

/// The standard products that fit, or the one that comes closest: sentences without the last end.
pub fn products(specification: &Specification) -> String {
    let fitting = specification.products.iter().filter(|of| of.fits() == Some(true));
    let fitting: Vec<&str> = fitting.map(|of| of.product.as_str()).collect();
    if !fitting.is_empty() {
        return format!("Standard products that fit: {}", fitting.join(", "));
    }
    let other =
        if specification.products.iter().any(|of| of.fits() == Some(false)) { "other" } else { "standard" };
    match specification.nearest_product() {
        Some(nearest) => format!("{NONE_FITS}. {} comes closest by its D15", nearest.product),
        None if specification.d15f_min_at_most => {
            "Whether a standard product fits is not known: D15B must be tested".into()
        }
        None => format!("No {other} product is known to fit: a limit of D15F is not known"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::verdict::SpecificationOptions;

    /// A core of category 2, for which 0.100 to 0.700 mm are allowed. C33 sand has a D15 of 0.178 to 0.424 mm
    /// and a Cu of 4.0 and 4.2, and leaves the band at 1.18 mm.
    #[test]
    fn a_product_is_tested_with_its_own_sides_and_not_by_the_band_that_was_drawn() {
        let base = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]).unwrap();
        let core = Specification::of("core", &[("core".into(), base)], SpecificationOptions::default());
        let fits: Vec<_> = core.products.iter().filter(|of| of.fits() == Some(true)).collect();
        assert_eq!(fits.iter().map(|of| &*of.product).collect::<Vec<_>>(), ["ASTM C33 fine aggregate"]);
        assert_eq!(product(&core, fits[0]), FITS);
        // No. 8 stone may be delivered with a Cu of 1.6.
        let stone = core.products.iter().find(|of| of.product.contains("No. 8 ")).unwrap();
        assert!(stone.not_kept.starts_with("Cu of its coarse side is 1.59"), "{stone:?}");
    }
}
