//! Which standard products fit, in the same words on every face.

use crate::gradation::Gradation;
use crate::outcome::design::Design;
use crate::outcome::design::products::Fit;
use crate::outcome::design::specification::{ProductMargin, SieveLimit, Specification};
use crate::outcome::digits::percent;
use crate::outcome::numbers::trimmed;

/// Said of a product both whose sides keep every requirement.
pub const FITS: &str = "fits";

/// Percentage points by which a gradation leaves a limit that is printed in whole percents, and is said to.
const SEEN: f64 = 0.5;

/// Said of a product of which D15B would tell whether it drains.
pub const MAY_DRAIN: &str = "may drain: D15B must be tested";

/// Said where no product fits.
const NONE_FITS: &str = "None of the standard products fits";

/// Said of a product that does not fit, with what its sides do not keep beside D15F.
fn does_not_fit(not_kept: &str) -> String {
    if not_kept.is_empty() { "does not fit".into() } else { format!("does not fit: {not_kept}") }
}

impl Specification {
    /// What is said of a standard product, by practice alone.
    pub fn product_in_words(&self, of: &ProductMargin) -> String {
        match of.fits() {
            Some(true) => FITS.into(),
            Some(false) => does_not_fit(&of.not_kept),
            None if self.d15f_min_at_most && of.drains_by.is_none() => MAY_DRAIN.into(),
            None => "no result".into(),
        }
    }

    /// Which standard products fit by practice alone, or which comes closest: sentences without the last end.
    pub fn products_in_words(&self) -> String {
        let fitting = self.products.iter().filter(|of| of.fits() == Some(true));
        let fitting: Vec<&str> = fitting.map(|of| of.product.as_str()).collect();
        if !fitting.is_empty() {
            return format!("Standard products that fit: {}", fitting.join(", "));
        }
        let other =
            if self.products.iter().any(|of| of.fits() == Some(false)) { "other" } else { "standard" };
        match self.nearest_product() {
            Some(nearest) => format!("{NONE_FITS}. {} comes closest by its D15", nearest.product),
            None if self.d15f_min_at_most => {
                "Whether a standard product fits is not known: D15B must be tested".into()
            }
            None => format!("No {other} product is known to fit: a limit of D15F is not known"),
        }
    }
}

impl Design {
    /// What is said of a product.
    pub fn product_in_words(&self, fit: &Fit) -> String {
        let not_kept = self.not_kept(&fit.name);
        match (self.fits(fit), self.fits_by_practice()) {
            (true, true) => format!("{FITS} by practice"),
            (true, false) => "in doubt".into(),
            (false, _) if fit.may_fit() && not_kept.is_empty() => "not known".into(),
            (false, _) => does_not_fit(if fit.fits() { not_kept } else { "" }),
        }
    }

    /// Which filter the rules of practice judge here, and where it leaves the band to specify: sentences.
    /// `None` where its sizes are not given, or there is no band.
    pub fn judged_filter_in_words(&self) -> Option<String> {
        let d15f_mm = self.rules_at * self.base.d85_mm.filter(|_| !self.inverse)?;
        let specification = self.specification.as_ref().filter(|of| of.band.is_some())?;
        let given = Gradation::of_rows(&self.filter_gradation).ok()?;
        let judged = given.scaled(d15f_mm / self.filter_d15_mm?).ok()?;
        // What is finer than its finest sieve is not known.
        let known = specification.limits.iter().filter(|limit| limit.opening_mm >= judged.smallest_mm());
        let beyond = |limit: &SieveLimit| {
            let finer = judged.percent_finer_by_mass(limit.opening_mm);
            let (least, most) = (limit.min_percent_finer, limit.max_percent_finer.unwrap_or(100.0));
            let (by, bound) = match finer < least {
                true => (least - finer, format!("asks for at least {}", trimmed(least))),
                false => (finer - most, format!("allows at most {}", trimmed(most))),
            };
            let said = format!(
                "It leaves the band at {}: {} are finer there, and the band {bound} %.",
                limit.sieve,
                percent(finer / 100.0)
            );
            (by >= SEEN).then_some((by, said))
        };
        let worst = known.filter_map(beyond).max_by(|a, b| a.0.total_cmp(&b.0));
        let place = worst.map_or_else(|| "It stays within the band.".into(), |(_, said)| said);
        Some(format!(
            "The filter as given is judged, scaled to this D15F. {place} Step 12 checks the sides of the \
             band for internal stability."
        ))
    }

    /// Which standard products fit, a sentence without its end; `None` where none was compared.
    pub fn products_in_words(&self) -> Option<String> {
        if self.products.is_empty() {
            return None;
        }
        if !self.fits_by_practice() {
            return Some("No standard product is said to fit, as the answer is in doubt".into());
        }
        let fitting = self.products.iter().filter(|fit| self.fits(fit));
        let fitting: Vec<&str> = fitting.map(|fit| fit.name.as_str()).collect();
        Some(match fitting.is_empty() {
            false => format!(
                "Standard products that fit by practice (their own shapes were not walked): {}",
                fitting.join(", ")
            ),
            true if self.products.iter().any(Fit::may_fit) => {
                "Of the standard products none is known to fit".into()
            }
            true => NONE_FITS.into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::design::band::SetBy;
    use crate::outcome::design::{Boundary, DesignAnswer, Specification};
    use crate::verdict::SpecificationOptions;

    /// A core of category 2, whose limit practice sets at 0.7 mm: D15 of C33 sand is 0.178 to 0.424 mm, and
    /// at 1.18 mm it leaves the band.
    fn core(set_by: SetBy) -> Design {
        let base = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]).unwrap();
        let of = Specification::of("core", &[("core".into(), base)], SpecificationOptions::default());
        let fit = |name: &str, holds| {
            serde_json::json!({"name": name, "d15_mm": [0.178, 0.424], "drains": true, "holds": holds,
                "practice": holds, "source": ""})
        };
        let text = serde_json::json!({
            "version": "1", "inverse": false, "filter": "f", "filter_cu": 1.5, "filter_d15_mm": null,
            "unit": "mm",
            "base": {"name": "b", "cu": null, "d15_mm": null, "d85_mm": 0.4, "d95_over_d85": null,
                "tail_mass_fraction": 0.0},
            "threshold": 0.075, "replicates": 2, "seed": 1, "engine": "expected", "bracket": [0.5, 100.0],
            "step": 0.005,
            "rules": [], "rules_at": 1.75,
            "products": [fit("ASTM C33 fine aggregate", true), fit("ASTM C33/D448 No. 8 stone", false)],
            "model_leaves_out": [], "settings": [],
            "seconds": 1.0,
            "answer": DesignAnswer { d15f_max_mm: Some(0.7), d85b_min_mm: None, d15f_over_d85b: Some(1.75),
                set_by, rule: None, limit: String::new(), margin: None, walk: None,
                washout: None, if_dispersive: None, said: String::new() },
            "specification": of,
            "boundaries": [{"density": "loose", "thickness": "60 layers", "layers": 60, "thickness_mm": null,
                "grains_per_void": 0.6, "no_erosion": Boundary::of(&[Ok(3.0), Ok(3.0)], Some(0.4)),
                "continuing": null, "not_monotone": 0, "networks": [], "band": null}],
        });
        serde_json::from_value(text).unwrap()
    }

    /// C33 sand has a D15 of 0.178 to 0.424 mm, and a Cu of 4.0 and 4.2; 0.100 to 0.700 mm are allowed.
    #[test]
    fn a_product_is_tested_with_its_own_sides_and_not_by_the_band_that_was_drawn() {
        let said = |of: &Design| of.products.iter().map(|fit| of.product_in_words(fit)).collect::<Vec<_>>();
        let by_practice = core(SetBy::Practice);
        assert_eq!(said(&by_practice), ["fits by practice", "does not fit"]);
        assert!(by_practice.products_in_words().unwrap().ends_with(": ASTM C33 fine aggregate"));
        assert_eq!(said(&core(SetBy::Walk))[0], "in doubt");
        let given = by_practice.specification.as_ref().unwrap();
        let fits: Vec<_> = given.products.iter().filter(|of| of.fits() == Some(true)).collect();
        assert_eq!(fits.iter().map(|of| &*of.product).collect::<Vec<_>>(), ["ASTM C33 fine aggregate"]);
        assert_eq!(given.product_in_words(fits[0]), FITS);
        // No. 8 stone may be delivered with a Cu of 1.6.
        let stone = given.products.iter().find(|of| of.product.contains("No. 8 ")).unwrap();
        assert!(stone.not_kept.starts_with("Cu of its coarse side is 1.59"), "{stone:?}");
        // The filter that the rules judge is another, and may leave the band: at 2.36 mm at 0.7 mm of D15F.
        let shape = |points: Vec<[f64; 2]>| Design {
            filter_gradation: points,
            filter_d15_mm: Some(0.35),
            ..core(SetBy::Practice)
        };
        let long = vec![[0.1, 0.0], [0.35, 15.0], [1.5, 30.0], [6.0, 95.0], [20.0, 100.0]];
        let judged = shape(long).judged_filter_in_words().unwrap();
        assert!(
            judged.starts_with("The filter as given is judged, scaled to this D15F. It leaves the band at ")
                && judged.contains(" are finer there, and the band asks for at least 49 %. Step 12 checks"),
            "{judged}"
        );
        let within = vec![[0.2, 0.0], [0.35, 15.0], [1.7, 60.0], [6.0, 100.0]];
        assert!(shape(within).judged_filter_in_words().unwrap().contains(" It stays within the band. "));
        assert_eq!(core(SetBy::Practice).judged_filter_in_words(), None);
        let doubted = core(SetBy::Walk);
        assert_eq!(said(&doubted), ["in doubt", "does not fit"]);
        assert!(doubted.products_in_words().unwrap().ends_with("as the answer is in doubt"));
    }
}
