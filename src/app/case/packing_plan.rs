//! Plan of a packing, and its fingerprint.

use super::input::Input;
use crate::outcome::packing::PackedPart;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::packing::{self, Settings as Compression};

/// Two gradations have one shape if their sizes, scaled, agree to within this ...
const SAME_SIZE: f64 = 1e-3;
/// ... and their percentages as near as this.
const SAME_PERCENT: f64 = 1e-2;

/// Part of the definition of a packing: another number gives other grains from the same recipe.
const PROTOCOL: u32 = 2;
/// Protocol of gradations so wide that their most crowded grains are moved as heavier ones.
const WIDE_PROTOCOL: u32 = 3;

/// Plan of a packing.
#[derive(Clone, Debug)]
pub struct PackingPlan {
    /// The gradation that is packed: the filter's, or its finer part's.
    pub gradation: Gradation,
    /// The gradation in words.
    pub name: String,
    /// True if it is linear.
    pub linear: bool,
    /// Part of the filter that it is, if the whole is not packed.
    pub part: Option<PackedPart>,
    /// Height of the cell by its width.
    pub aspect: f64,
    /// Settings of the compression.
    pub compression: Compression,
    /// Overlap of two inscribed spheres from which their tetrahedra are one void.
    pub merge_overlap: f64,
    /// Files that were read.
    pub inputs: Vec<Input>,
}

impl PackingPlan {
    /// Fingerprint of everything that the grains follow from.
    pub fn fingerprint(&self) -> String {
        self.fingerprint_of(&pairs(&self.gradation))
    }

    /// Fingerprint of a gradation with these points, compressed likewise.
    pub(super) fn fingerprint_of(&self, points: &[(f64, f64)]) -> String {
        let protocol = if packing::is_wide(&self.gradation) { WIDE_PROTOCOL } else { PROTOCOL };
        let mut text = format!("{protocol} {points:?} {:?}", self.compression);
        if self.aspect != 1.0 {
            text += &format!(" {:?} times as tall", self.aspect);
        }
        format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text.as_bytes()))
    }

    /// The factor from a gradation with these points to the plan's: `None` if no factor takes every size to
    /// within a thousandth of its target.
    pub(super) fn scale_from(&self, points: &[(f64, f64)]) -> Option<f64> {
        let planned = pairs(&self.gradation);
        let (coarsest, its) = (planned.last()?, points.last()?);
        let factor = coarsest.0 / its.0;
        let fits = |(planned, other): (&(f64, f64), &(f64, f64))| {
            (factor * other.0 / planned.0 - 1.0).abs() < SAME_SIZE
                && (other.1 - planned.1).abs() < SAME_PERCENT
        };
        (planned.len() == points.len() && planned.iter().zip(points).all(fits)).then_some(factor)
    }

    /// True if one packing, scaled, serves both plans.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        let points = pairs(&other.gradation);
        self.scale_from(&points).is_some() && self.fingerprint_of(&points) == other.fingerprint()
    }

    /// Name of the folder in which the packing is kept among others.
    pub fn folder_name(&self) -> String {
        let cu = self.gradation.cu().map_or("graded".to_string(), |cu| format!("cu{:.3}", cu));
        let cu = cu.trim_end_matches('0').trim_end_matches('.');
        format!("{cu}-friction{}-{}", self.compression.friction, &self.fingerprint()[..8])
    }
}

/// Size and percent of each point, as fingerprints hash them.
fn pairs(gradation: &Gradation) -> Vec<(f64, f64)> {
    gradation.points().iter().map(|point| (point.size, point.percent)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn plan(cu: f64, grains: usize) -> PackingPlan {
        let text = format!(
            "[filter]\ncu = {cu}\ndensity = \"loose\"\n[base]\ncu = 1.5\nd15f_over_d85b = 4\n\
             [packing]\ngrains = {grains}\ncoarsest = 100\n"
        );
        PackingPlan::of(&Scene::parse(text.as_bytes(), "s.toml", &[]).unwrap()).unwrap().unwrap()
    }

    #[test]
    fn the_fingerprint_names_the_protocol() {
        let protocols = |cu: f64, grains: usize| {
            let plan = plan(cu, grains);
            let points = pairs(&plan.gradation);
            let text = |protocol: u32| format!("{protocol} {points:?} {:?}", plan.compression);
            let [earlier, wide] = [2, 3]
                .map(|protocol| format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text(protocol).as_bytes())));
            (plan.fingerprint() == earlier, plan.fingerprint() == wide)
        };
        assert_eq!(protocols(3.0, 20_000), (true, false));
        assert_eq!(protocols(4.4, 20_000), (true, false));
        // 4.5^2 is 20.25, even if too few grains reach it.
        assert_eq!(protocols(4.5, 20_000), (false, true));
        assert_eq!(protocols(6.0, 60_000), (false, true));
    }
}
