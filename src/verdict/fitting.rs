//! Which standard products fit, in the same words on every face.

use crate::gradation::Gradation;
use crate::outcome::design::Design;
use crate::outcome::design::products::Fit;
use crate::outcome::design::specification::{ProductMargin, SieveLimit, Specification};
use crate::outcome::digits::percent;
use crate::outcome::numbers::{significant, trimmed};

/// Said of a product that fits by its D15 and stays within the band.
pub const FITS: &str = "D15 fits";

/// Where a product leaves the band that its D15 fits, at the sieve (mm) at which its limits do so by most.
pub fn leaves_at(sieve_mm: f64) -> String {
    format!("leaves the band at {} mm", significant(sieve_mm))
}

/// Percentage points by which a gradation leaves a limit that is printed in whole percents, and is said to.
const SEEN: f64 = 0.5;

/// The band that a product whose D15 fits is compared with.
enum Beside {
    Within,
    /// It leaves the band, by most at this sieve (mm).
    Outside(f64),
    NoBand,
}

/// What is said of a product whose D15 fits, of walk and practice or of practice alone. One that leaves the
/// band does not fit, though its D15 does.
fn fits_in_words(by_practice: bool, beside: &Beside) -> String {
    let by = if by_practice { " by practice" } else { "" };
    match beside {
        Beside::Within => format!("{FITS}{by}"),
        Beside::Outside(sieve) => format!("{}; only its D15 is allowed{by}", leaves_at(*sieve)),
        Beside::NoBand => format!("{FITS}{by}; there is no band"),
    }
}

/// Products whose D15 fits: those that stay within the band, and those that leave it.
#[derive(Default)]
struct Fitting {
    within: Vec<String>,
    /// Each with the sieve at which it leaves the band.
    leaving: Vec<String>,
}

impl Fitting {
    fn of<'a>(products: impl Iterator<Item = (&'a str, Beside)>) -> Self {
        let mut all = Self::default();
        for (name, beside) in products {
            match beside {
                Beside::Outside(sieve) => all.leaving.push(format!("{name} ({})", leaves_at(sieve))),
                Beside::Within | Beside::NoBand => all.within.push(name.into()),
            }
        }
        all
    }

    /// Behind what is said of those within the band: of which the D15 alone is allowed, `by` practice or by
    /// both.
    fn with_leaving(&self, within: String, by: &str) -> String {
        match self.leaving.is_empty() {
            true => within,
            false => format!("{within}. Only the D15 is allowed{by} of {}", self.leaving.join(", ")),
        }
    }
}

/// Said where no product fits.
const NONE_FITS: &str = "None of the standard products fits";

impl Specification {
    fn beside(&self, of: &ProductMargin) -> Beside {
        match of.worst_sieve_mm {
            _ if self.band.is_none() => Beside::NoBand,
            Some(sieve) => Beside::Outside(sieve),
            None => Beside::Within,
        }
    }

    /// What is said of a standard product, by practice alone.
    pub fn product_in_words(&self, of: &ProductMargin) -> String {
        match of.fits() {
            Some(true) => fits_in_words(false, &self.beside(of)),
            Some(false) => "does not fit".into(),
            None if self.d15f_min_at_most && of.drains_by.is_none() => {
                "may drain: needs a hydrometer test".into()
            }
            None => "no result".into(),
        }
    }

    /// Which standard products fit by practice alone, or which comes closest: sentences without the last end.
    pub fn products_in_words(&self) -> String {
        let fitting = self.products.iter().filter(|of| of.fits() == Some(true));
        let fitting = Fitting::of(fitting.map(|of| (of.product.as_str(), self.beside(of))));
        if !fitting.within.is_empty() {
            let no_band = if self.band.is_none() { ", though there is no band" } else { "" };
            return fitting.with_leaving(format!("{FITS}{no_band}: {}", fitting.within.join(", ")), "");
        }
        if !fitting.leaving.is_empty() {
            return fitting.with_leaving(NONE_FITS.into(), "");
        }
        let other =
            if self.products.iter().any(|of| of.fits() == Some(false)) { "other" } else { "standard" };
        match self.nearest_product() {
            Some(nearest) => format!("{NONE_FITS}. {} comes closest by its D15", nearest.product),
            None if self.d15f_min_at_most => {
                "Whether a standard product fits is not known: D15B is finer than the finest sieve. A \
                 hydrometer test of the base would tell whether it drains"
                    .into()
            }
            None => format!("No {other} product is known to fit: a limit of D15F is not known"),
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
    pub fn product_in_words(&self, fit: &Fit) -> String {
        let by_practice = !self.may_fit() && self.fits_by_practice();
        match (fit.fits(), self.may_fit() || by_practice) {
            (true, true) => fits_in_words(by_practice, &self.beside(&fit.name)),
            (true, false) => "in doubt".into(),
            (false, _) if fit.may_fit() => "not known".into(),
            (false, _) => "does not fit".into(),
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
            let [least, most] = [limit.min_percent_finer, limit.max_percent_finer];
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
        let by_practice = !self.may_fit() && self.fits_by_practice();
        if !self.may_fit() && !by_practice {
            return Some("No standard product is said to fit, as the answer is in doubt".into());
        }
        let fitting = self.products.iter().filter(|fit| fit.fits());
        let fitting = Fitting::of(fitting.map(|fit| (fit.name.as_str(), self.beside(&fit.name))));
        let by = if by_practice { " by practice" } else { "" };
        let no_band = match &self.specification {
            Some(of) if of.band.is_none() => ", though there is no band",
            _ => "",
        };
        let within = match fitting.within.is_empty() {
            false => {
                let names = fitting.within.join(", ");
                format!("{FITS}{by}{no_band} (their own shapes were not walked): {names}")
            }
            true if self.products.iter().any(Fit::may_fit) => {
                "Of the standard products none is known to fit".into()
            }
            true => NONE_FITS.into(),
        };
        Some(fitting.with_leaving(within, by))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::design::band::SetBy;
    use crate::outcome::design::{Boundary, DesignAnswer, Specification};
    use crate::outcome::record::Confidence;
    use crate::verdict::SpecificationOptions;

    /// A core of category 2, whose limit practice sets at 0.7 mm: D15 of C33 sand is 0.178 to 0.424 mm, and
    /// at 1.18 mm it leaves the band.
    fn core(confidence: Confidence) -> Design {
        let base = Gradation::from_lines(&[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]).unwrap();
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
                set_by: SetBy::Practice, rule: None, limit: String::new(), margin: None, walk: None,
                washout: None, if_dispersive: None, said: String::new() },
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
        assert_eq!(
            said(&by_practice),
            ["leaves the band at 1.18 mm; only its D15 is allowed by practice", "does not fit"]
        );
        assert_eq!(
            by_practice.products_in_words().unwrap(),
            "None of the standard products fits. Only the D15 is allowed by practice of ASTM C33 fine \
             aggregate (leaves the band at 1.18 mm)"
        );
        let leaves = "leaves the band at 1.18 mm; only its D15 is allowed";
        assert_eq!(said(&core(Confidence::Within))[0], leaves);
        let alone = Design { specification: None, ..core(Confidence::Within) };
        assert_eq!(said(&alone)[0], FITS);
        // No band is left that a product could keep.
        let none = |of: Specification| Specification { band: None, ..of };
        let specification = by_practice.specification.clone().map(none);
        let of_practice = specification.clone().unwrap();
        let words: Vec<_> = of_practice.products.iter().map(|of| of_practice.product_in_words(of)).collect();
        assert!(words.iter().any(|of| of == "D15 fits; there is no band"), "{words:?}");
        assert!(words.iter().all(|of| of != FITS), "{words:?}");
        let without = Design { specification, ..core(Confidence::Within) };
        assert_eq!(said(&without)[0], "D15 fits; there is no band");
        assert!(without.products_in_words().unwrap().starts_with("D15 fits, though there is no band ("));
        let given = by_practice.specification.as_ref().unwrap();
        let c33 = given.products.iter().find(|of| of.product == "ASTM C33 fine aggregate").unwrap();
        assert_eq!(given.product_in_words(c33), leaves);
        // The specification says it as the design does.
        assert_eq!(
            given.products_in_words(),
            "None of the standard products fits. Only the D15 is allowed of ASTM C33 fine aggregate (leaves \
             the band at 1.18 mm)"
        );
        assert!(of_practice.products_in_words().starts_with("D15 fits, though there is no band: ASTM C33 f"));
        // The filter that the rules judge is another, and may leave the band: D100F at 0.7 mm of D15F.
        let shape = |points: Vec<[f64; 2]>| Design {
            filter_gradation: points,
            filter_d15_mm: Some(0.35),
            ..core(Confidence::Within)
        };
        let long = vec![[0.1, 0.0], [0.35, 15.0], [1.5, 60.0], [6.0, 95.0], [20.0, 100.0]];
        let judged = shape(long).judged_filter_in_words().unwrap();
        assert!(
            judged.starts_with("The filter as given is judged, scaled to this D15F. It leaves the band at ")
                && judged.contains(" are finer there, and the band asks for at least 100 %. Step 12 checks"),
            "{judged}"
        );
        let within = vec![[0.2, 0.0], [0.35, 15.0], [1.7, 60.0], [6.0, 100.0]];
        assert!(shape(within).judged_filter_in_words().unwrap().contains(" It stays within the band. "));
        assert_eq!(core(Confidence::Within).judged_filter_in_words(), None);
        let doubted = core(Confidence::Contradicted);
        assert_eq!(said(&doubted), ["in doubt", "does not fit"]);
        assert!(doubted.products_in_words().unwrap().ends_with("as the answer is in doubt"));
    }
}
