//! Which standard products fit, in the same words on every face.

use crate::outcome::design::Design;
use crate::outcome::design::products::Fit;
use crate::outcome::design::specification::{ProductMargin, Specification};

/// Said of a product that fits by its D15 and stays within the band.
pub const FITS: &str = "D15 fits";

/// Said of a product that fits by its D15 while its limits at the sieves leave the band.
pub const OUTSIDE: &str = "but lies outside this band";

/// The band that a product whose D15 fits is compared with.
enum Beside {
    Within,
    Outside,
    NoBand,
}

/// What is said of a product whose D15 fits, of walk and practice or of practice alone.
fn fits_in_words(by_practice: bool, beside: Beside) -> &'static str {
    match (by_practice, beside) {
        (false, Beside::Within) => FITS,
        (false, Beside::Outside) => "D15 fits, but lies outside this band",
        (false, Beside::NoBand) => "D15 fits; there is no band",
        (true, Beside::Within) => "D15 fits by practice",
        (true, Beside::Outside) => "D15 fits by practice, but lies outside this band",
        (true, Beside::NoBand) => "D15 fits by practice; there is no band",
    }
}

impl Specification {
    fn beside(&self, of: &ProductMargin) -> Beside {
        match of.worst_sieve_mm {
            _ if self.band.is_none() => Beside::NoBand,
            Some(_) => Beside::Outside,
            None => Beside::Within,
        }
    }

    /// What is said of a standard product, by practice alone.
    pub fn product_in_words(&self, of: &ProductMargin) -> &'static str {
        match of.fits() {
            Some(true) => fits_in_words(false, self.beside(of)),
            Some(false) => "does not fit",
            None if self.d15f_min_at_most && of.drains_by.is_none() => "may drain: needs a hydrometer test",
            None => "no result",
        }
    }
}

impl Design {
    /// Where a product lies beside the band of the specification; within where no specification says more.
    fn beside(&self, product: &str) -> Beside {
        let Some(specification) = &self.specification else { return Beside::Within };
        let of = specification.products.iter().find(|of| of.product == product);
        of.map_or(Beside::Within, |of| specification.beside(of))
    }

    /// What is said of a product.
    pub fn product_in_words(&self, fit: &Fit) -> &'static str {
        let by_practice = !self.may_fit() && self.fits_by_practice();
        match (fit.fits(), self.may_fit() || by_practice) {
            (true, true) => fits_in_words(by_practice, self.beside(&fit.name)),
            (true, false) => "in doubt",
            (false, _) if fit.may_fit() => "not known",
            (false, _) => "does not fit",
        }
    }

    /// Which standard products fit, a sentence without its end; `None` where none was compared.
    pub fn products_in_words(&self) -> Option<String> {
        if self.products.is_empty() {
            return None;
        }
        let by_practice = !self.may_fit() && self.fits_by_practice();
        if !self.may_fit() && !by_practice {
            return Some("No standard product is said to fit, as the answer is in doubt".into());
        }
        let named = |fit: &Fit| match self.beside(&fit.name) {
            Beside::Outside => format!("{} ({OUTSIDE})", fit.name),
            Beside::Within | Beside::NoBand => fit.name.clone(),
        };
        let fitting: Vec<String> = self.products.iter().filter(|fit| fit.fits()).map(named).collect();
        let by = if by_practice { " by practice" } else { "" };
        let no_band = match &self.specification {
            Some(of) if of.band.is_none() => ", though there is no band",
            _ => "",
        };
        Some(match fitting.is_empty() {
            false => {
                format!("{FITS}{by}{no_band} (their own shapes were not walked): {}", fitting.join(", "))
            }
            true if self.products.iter().any(Fit::may_fit) => {
                "Of the standard products none is known to fit".into()
            }
            true => "None of the standard products fits".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::design::band::SetBy;
    use crate::outcome::design::{Boundary, DesignAnswer, Specification};
    use crate::outcome::record::Confidence;
    use crate::verdict::SpecificationOptions;

    /// A core of category 2, whose limit practice sets at 0.7 mm: D15 of C33 sand is 0.178 to 0.424 mm, and
    /// at 1.18 mm it leaves the band.
    fn core(confidence: Confidence) -> Design {
        let base = Gradation::from_points(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)], None).unwrap();
        let of = Specification::of("core", &[("core".into(), base)], SpecificationOptions::default());
        let fit = |name: &str, holds| {
            serde_json::json!({"name": name, "d15_mm": [0.178, 0.424], "drains": true, "holds": holds,
                "practice": holds, "source": ""})
        };
        let text = serde_json::json!({
            "version": "1", "inverse": false, "filter": "f", "filter_cu": 1.5, "filter_d15_mm": null,
            "unit": "mm",
            "base": {"name": "b", "cu": null, "d15_mm": null, "d85_mm": 0.4, "d95_over_d85": null},
            "threshold": 0.075, "replicates": 2, "seed": 1, "bracket": [0.5, 100.0], "step": 0.005,
            "confidence": confidence, "reasons": [], "rules": [], "rules_at": 1.75,
            "products": [fit("ASTM C33 fine aggregate", true), fit("ASTM C33/D448 No. 8 stone", false)],
            "products_confidence": confidence, "warnings": [], "model_leaves_out": [], "settings": [],
            "seconds": 1.0,
            "answer": DesignAnswer { d15f_max_mm: Some(0.7), d85b_min_mm: None, d15f_over_d85b: Some(1.75),
                set_by: SetBy::Practice, rule: None, said: String::new() },
            "specification": of,
            "boundaries": [{"density": "loose", "thickness": "60 layers", "layers": 60, "thickness_mm": null,
                "grains_per_void": 0.6, "no_erosion": Boundary::of(&[Ok(3.0), Ok(3.0)], Some(0.4)),
                "continuing": null, "not_monotone": 0, "networks": [], "band": null}],
        });
        serde_json::from_value(text).unwrap()
    }

    #[test]
    fn a_product_that_fits_by_its_d15_is_never_said_to_fit_a_band_that_it_leaves() {
        let said = |of: &Design| of.products.iter().map(|fit| of.product_in_words(fit)).collect::<Vec<_>>();
        let by_practice = core(Confidence::Outside);
        assert_eq!(said(&by_practice), ["D15 fits by practice, but lies outside this band", "does not fit"]);
        assert_eq!(
            by_practice.products_in_words().unwrap(),
            "D15 fits by practice (their own shapes were not walked): ASTM C33 fine aggregate (but lies \
             outside this band)"
        );
        assert_eq!(said(&core(Confidence::Within))[0], "D15 fits, but lies outside this band");
        let alone = Design { specification: None, ..core(Confidence::Within) };
        assert_eq!(said(&alone)[0], FITS);
        // No band is left that a product could keep.
        let none = |of: Specification| Specification { band: None, ..of };
        let specification = by_practice.specification.clone().map(none);
        let of_practice = specification.clone().unwrap();
        let words: Vec<_> = of_practice.products.iter().map(|of| of_practice.product_in_words(of)).collect();
        assert!(words.contains(&"D15 fits; there is no band") && !words.contains(&FITS), "{words:?}");
        let without = Design { specification, ..core(Confidence::Within) };
        assert_eq!(said(&without)[0], "D15 fits; there is no band");
        assert!(without.products_in_words().unwrap().starts_with("D15 fits, though there is no band ("));
        let given = by_practice.specification.as_ref().unwrap();
        let c33 = given.products.iter().find(|of| of.product == "ASTM C33 fine aggregate").unwrap();
        assert_eq!(given.product_in_words(c33), "D15 fits, but lies outside this band");
        let doubted = core(Confidence::Contradicted);
        assert_eq!(said(&doubted), ["in doubt", "does not fit"]);
        assert!(doubted.products_in_words().unwrap().ends_with("as the answer is in doubt"));
    }
}
