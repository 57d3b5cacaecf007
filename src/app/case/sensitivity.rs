//! Which other numbers of base particles a case is walked with.

use super::Case;
use crate::outcome::left_out::LeftOut;
use crate::scene::Amount;

impl Case {
    /// Multiples of N_base that the sensitivity study walks: those asked for, except those above a cap that
    /// the user set, those that give the number of the case itself, and repeated numbers.
    pub fn sensitivity_factors(&self) -> Vec<f64> {
        let cap = self.cap();
        let mut numbers = vec![self.supply.n_base];
        let mut is_other = |factor: &f64| {
            let number = self.times_base(*factor);
            let is_new = !numbers.contains(&number);
            numbers.push(number);
            is_new && *factor * self.supply.n_base as f64 <= cap
        };
        self.scene.record.sensitivity.iter().copied().filter(|factor| is_other(factor)).collect()
    }

    /// Multiples that are asked for, but not walked, each with the reason.
    pub(super) fn sensitivity_not_walked(&self) -> Vec<LeftOut> {
        let asked = &self.scene.record.sensitivity;
        let walked = self.sensitivity_factors();
        let cap = self.cap();
        let not_walked = asked.iter().copied().filter(|factor| !walked.contains(factor));
        let (above, same): (Vec<f64>, Vec<f64>) =
            not_walked.partition(|factor| factor * self.supply.n_base as f64 > cap);
        let is_above = (!above.is_empty()).then_some(LeftOut::AmountsAboveCap(above, cap));
        let is_same = (!same.is_empty()).then_some(LeftOut::AmountsTheSame(same));
        is_above.into_iter().chain(is_same).collect()
    }

    /// The number of base particles times this factor, at least one.
    pub fn times_base(&self, factor: f64) -> u64 {
        ((self.supply.n_base as f64 * factor).round() as u64).max(1)
    }

    /// Base particles with this many times the grains per void, up to a cap that the user set; unchanged if
    /// the user states their number.
    pub fn base_by_grains(&self, times_grains: f64) -> u64 {
        let is_by_mass = matches!(self.scene.base.amount(), Amount::MassRatio(..));
        let of_eq2 = self.supply.n_base_eq2.filter(|_| is_by_mass);
        of_eq2
            .map_or(self.supply.n_base, |n| (n as f64 * times_grains).round().min(self.cap()).max(1.0) as u64)
    }

    fn cap(&self) -> f64 {
        match self.scene.base.amount() {
            Amount::MassRatio(_, Some(cap)) => cap as f64,
            _ => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::words::left_out::left_out;

    /// The coarse end of the library has 6 % fewer grains per void near one of its shapes.
    #[test]
    fn the_base_of_an_end_follows_its_grains_unless_they_are_stated_and_keeps_the_cap() {
        let numbers = |set: &[&str]| {
            let set = [&["filter.library=loose", "filter.cu=1.5", "filter.d0_mm=1"], set].concat();
            let set: Vec<String> = set.into_iter().map(str::to_owned).collect();
            let case = Case::new(Scene::built_in(&set).unwrap()).unwrap();
            (case.base_by_grains(case.filter.curve_ends[0].times_grains), case.supply.n_base)
        };
        let (of_end, n_base) = numbers(&[]);
        assert_eq!(of_end, (n_base as f64 / 1.06).round() as u64);
        // Caps between the base of the end and the base of the case, and below both.
        for (cap, expected) in [(n_base - 1, of_end), (of_end / 2, of_end / 2)] {
            assert_eq!(numbers(&[&format!("base.cap={cap}")]), (expected, cap));
        }
        let (of_end, n_base) = numbers(&["filter.grains_per_void=0.5"]);
        assert_eq!(of_end, n_base);
        assert_eq!(numbers(&["base.n_base=1000"]), (1000, 1000));
    }

    #[test]
    fn what_is_not_walked_is_said_with_its_reason() {
        let studies = |set: &[&str]| {
            let all: Vec<String> = set.iter().map(ToString::to_string).collect();
            let case = Case::new(Scene::built_in(&all).unwrap()).unwrap();
            (
                case.sensitivity_factors(),
                case.left_out().iter().map(|part| left_out(part, "mm")).collect::<Vec<_>>(),
            )
        };
        let (factors, left_out) = studies(&["base.cap=1000"]);
        assert_eq!(factors, [0.25, 0.5]);
        let expected =
            "sensitivity to the number of base particles, x2, x4: more than base.cap, 1000, allows";
        assert!(left_out.iter().any(|line| line == expected), "{left_out:?}");
        let (factors, left_out) = studies(&["record.sensitivity=[1, 2, 2.0, 0.5]", "base.n_base=1000"]);
        assert_eq!(factors, [2.0, 0.5]);
        assert!(left_out.iter().any(|line| line.contains("particles, x1: the same number")), "{left_out:?}");
        let (factors, left_out) = studies(&["base.n_base=1000"]);
        assert_eq!(factors.len(), 4);
        assert!(
            !left_out.iter().any(|line| line.starts_with("sensitivity to the number of base particles")),
            "{left_out:?}"
        );
    }
}
