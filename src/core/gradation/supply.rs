//! Number of base particles that a test inserts: Eq. (2) of the paper.

use super::{Gradation, GradationError, NumberError};

/// Number of base particles, and its cap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaseSupply {
    /// Base particles to insert.
    pub n_base: u64,
    /// Base particles by Eq. (2).
    pub n_base_eq2: u64,
    /// True if the cap made `n_base` smaller than `n_base_eq2`.
    pub capped: bool,
}

/// Computes the number of base particles, Eq. (2) of the paper:
///
/// ```text
/// N_base = F_base * (N_p / N_voids) * voids * N_base,unit / N_filter,unit
/// ```
///
/// rounded to the nearest integer. `mass_ratio` is F_base, the mass of base over the mass of filter;
/// `grains_per_void` is N_p / N_voids of the filter's packing; `voids` is the number of voids of the network.
/// N_unit is the number of particles per unit mass; base and filter have one solid density, so numbers per
/// unit of solid volume ([`Gradation::particles_per_unit_volume`]) serve as well.
///
/// A pan fraction in the base is in its mass, not in its number: the particles represent `1 - tail` of
/// `mass_ratio`.
///
/// `cap` limits the number; `None` is no limit. Fewer particles than Eq. (2) requires is a bias towards more
/// erosion, not noise, so the result tells if it is capped.
///
/// # Errors
/// A mass ratio or grains per void that is not a positive finite number, no voids, or a number of
/// particles that does not fit u64. A result that rounds to 0 is returned as it is.
///
/// ```
/// use voidwalk_core::gradation::{Gradation, base_particles};
/// let filter = Gradation::single(1.0)?;
/// let base = Gradation::single(0.1)?;
/// // A tenth of the size: a thousand times as many in the same volume.
/// let supply = base_particles(0.05, 0.6, 96_000, &base, &filter, None)?;
/// assert_eq!(supply.n_base, 2_880_000);
/// # Ok::<(), voidwalk_core::gradation::GradationError>(())
/// ```
pub fn base_particles(
    mass_ratio: f64,
    grains_per_void: f64,
    voids: u64,
    base: &Gradation,
    filter: &Gradation,
    cap: Option<u64>,
) -> Result<BaseSupply, GradationError> {
    NumberError::unless_positive("mass_ratio", mass_ratio)?;
    NumberError::unless_positive("grains_per_void", grains_per_void)?;
    if voids == 0 {
        return Err(NumberError::new("voids", 0.0, "at least one void").into());
    }
    let per_grain = base.particles_per_unit_volume() / filter.particles_per_unit_volume();
    let n = (mass_ratio * (grains_per_void * voids as f64) * per_grain).round();
    // 2^64 itself does not fit.
    if n.is_nan() || n >= 18_446_744_073_709_551_616.0 {
        return Err(NumberError::new("n_base", n, "less than 2^64").into());
    }
    let n_base_eq2 = n as u64;
    let n_base = cap.map_or(n_base_eq2, |cap| n_base_eq2.min(cap));
    Ok(BaseSupply { n_base, n_base_eq2, capped: n_base < n_base_eq2 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn supply(cap: Option<u64>) -> BaseSupply {
        let filter = Gradation::linear_from_d0(1.0, 1.5).unwrap();
        let base = Gradation::linear_from_d0(0.1, 3.0).unwrap();
        base_particles(0.05, 0.61, 96_000, &base, &filter, cap).unwrap()
    }

    /// Compares with Eq. (2) for N_unit of a straight semi-log line worked out by hand:
    /// `N_unit = (1 - Cu^-6) / (pi D0^3 ln Cu)`.
    #[test]
    fn equation_two_by_hand() {
        let unit = |d0: f64, cu: f64| {
            (1.0 - libm::pow(cu, -6.0)) / (std::f64::consts::PI * d0 * d0 * d0 * libm::log(cu))
        };
        let expected = 0.05 * 0.61 * 96_000.0 * unit(0.1, 3.0) / unit(1.0, 1.5);
        assert_eq!(supply(None).n_base_eq2, expected.round() as u64);
    }

    #[test]
    fn a_cap_is_off_unless_asked_for_and_never_silent() {
        let full = supply(None);
        assert_eq!((full.n_base, full.capped), (full.n_base_eq2, false));
        let cut = supply(Some(1000));
        assert_eq!((cut.n_base, cut.n_base_eq2, cut.capped), (1000, full.n_base_eq2, true));
        assert!(!supply(Some(full.n_base)).capped);
    }

    #[test]
    fn a_tail_takes_its_mass_out_of_the_number() {
        let filter = Gradation::single(1.0).unwrap();
        let whole = Gradation::from_points(&[(0.1, 0.0), (0.2, 100.0)], None).unwrap();
        let tailed = Gradation::from_points(&[(0.1, 40.0), (0.2, 100.0)], None).unwrap();
        let n = |base| base_particles(0.05, 1.0, 1_000_000, base, &filter, None).unwrap().n_base as f64;
        assert!((n(&tailed) / n(&whole) - 0.6).abs() < 1e-6);
    }

    #[test]
    fn what_cannot_be_counted_is_refused() {
        let g = Gradation::single(1.0).unwrap();
        let dust = Gradation::single(1e-9).unwrap();
        for (ratio, grains, voids, base, text) in [
            (0.0, 1.0, 1, &g, "mass_ratio = 0.0 is not allowed; allowed: a positive finite number"),
            (f64::NAN, 1.0, 1, &g, "mass_ratio = NaN is not allowed; allowed: a positive finite number"),
            (
                1.0,
                f64::INFINITY,
                1,
                &g,
                "grains_per_void = inf is not allowed; allowed: a positive finite number",
            ),
            (1.0, 1.0, 0, &g, "voids = 0.0 is not allowed; allowed: at least one void"),
            (1.0, 1.0, 1, &dust, "n_base = 9.999999999999999e26 is not allowed; allowed: less than 2^64"),
        ] {
            let error = base_particles(ratio, grains, voids, base, &g, None).unwrap_err();
            assert_eq!(error.to_string(), text);
        }
        assert_eq!(base_particles(1e-30, 1.0, 1, &g, &g, None).unwrap().n_base, 0);
    }

    #[test]
    fn a_factor_of_two_on_every_length_changes_nothing() {
        let (filter, base) = (
            Gradation::linear_from_d0(1.0, 1.5).unwrap(),
            Gradation::linear_from_dx(85.0, 0.21, 4.5).unwrap(),
        );
        let n = |f: f64| {
            let (b, g) = (base.scaled(f).unwrap(), filter.scaled(f).unwrap());
            base_particles(0.05, 0.61, 96_000, &b, &g, None).unwrap()
        };
        assert_eq!(n(1.0), n(2.0));
        assert_eq!(n(1.0), n(1.0 / 1024.0));
    }
}
