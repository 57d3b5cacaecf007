//! Where a case leaves the range in which the model was checked, and what else a reader must know.

use super::{Case, Input};

impl Case {
    /// Where the inputs leave the range in which the model was checked, and what else a reader must know.
    pub fn warnings(&self) -> Vec<String> {
        let of_file = |input: &Input| -> Vec<String> {
            input.notes.iter().map(|note| format!("{}: {note}", input.name)).collect()
        };
        let mut warnings: Vec<String> = self.inputs.iter().flat_map(of_file).collect();
        let mut cu = |whose: &str, cu: Option<f64>, low: f64, high: f64| match cu {
            Some(cu) if cu < low - 1e-9 || cu > high + 1e-9 => warnings
                .push(format!("Cu of the {whose} is {cu:.2}: the model was checked for {low} to {high}")),
            _ => {}
        };
        cu("filter", self.filter.cu(), 1.2, 6.0);
        cu("base", self.base.cu(), 1.2, 4.5);
        if !self.is_scale_free() {
            let fines = self.base.percent_finer_by_mass(0.075).max(100.0 * self.base.pan_fraction());
            if self.base.smallest_mm() < 0.075 && fines > 15.0 {
                warnings.push(format!(
                    "{fines:.0} % of the base is finer than 0.075 mm: cohesion may govern, which the model \
                     does not know"
                ));
            }
        }
        if self.base.d(50.0).zip(self.filter.d(50.0)).is_some_and(|(b, f)| b > f) {
            warnings.push("the base is coarser than the filter (D50): are the two files exchanged?".into());
        }
        if self.base.pan_fraction() > 0.0 {
            warnings.push(format!(
                "{:.1} % of the base is finer than its finest sieve: taken as passive and counted by mass \
                 only",
                100.0 * self.base.pan_fraction()
            ));
        }
        if let Some(shipped) = self.shipped.filter(|_| self.network_file.is_none())
            && let Some(cu) = self.filter.cu()
            && (cu / shipped.cu - 1.0).abs() > 0.05
        {
            warnings.push(format!(
                "the filter's Cu is {cu:.2}, but its constriction curve {} belongs to Cu {}: constrictions \
                 of another filter",
                shipped.name, shipped.cu
            ));
        }
        if self.scene.filter.estimate.is_some() {
            warnings.push(
                "the constriction curve is a guess from circles inscribed between three or four grains; the \
                 wider the filter's gradation, the more it is off. filter.density packs the grains and \
                 measures it"
                    .into(),
            );
        }
        if self.filter.pan_fraction() > 0.0 {
            warnings.push(format!(
                "{:.1} % of the filter is finer than its finest sieve: its grains are not in Eq. (2), which \
                 then asks for too much base; filter.d0_mm says where that tail ends",
                100.0 * self.filter.pan_fraction()
            ));
        }
        if let Some(eq2) = self.n_base_eq2.filter(|_| self.capped) {
            warnings.push(format!(
                "the cap of {} base particles bit: Eq. (2) asks for {eq2}. Fewer particles are a bias, not \
                 noise, and its sign depends on the case",
                self.n_base
            ));
        }
        warnings
    }
}
