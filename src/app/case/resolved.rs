//! Identity of a case: its scene with every number given and its files, the fingerprint of both, and the
//! key of its networks.

use super::Case;
use super::filter::needs_grains_per_void;
use crate::scene::{About, CurveSource, NetworkSource, Scene};
use std::path::PathBuf;
use voidwalk_core::walk::Engine;

/// Part of the fingerprint of every case: raised if the program's results for the same scene change.
const PROTOCOL: u32 = 1;
/// Protocol of cases in which water flows.
const WATER_PROTOCOL: u32 = 2;
/// Number added if particles arch: raised if only the results of such cases change.
const ARCHING_PROTOCOL: u32 = 20_000;

impl Case {
    /// Scene completed from its files and its filter's packing, with the files' names in a run folder.
    /// Running it from there gives the same bits.
    pub fn resolved(&self) -> Scene {
        let mut scene = self.scene.clone();
        let kept = |setting: &str| {
            let input = self.inputs.iter().find(|input| input.setting == setting);
            input.map(|input| match &input.soil {
                Some(soil) => PathBuf::from(format!("{}#{soil}", input.kept_as)),
                None => PathBuf::from(&input.kept_as),
            })
        };
        let kept_curve = |source: Option<CurveSource>, setting: &str| match source {
            Some(CurveSource::File(_)) => kept(setting).map(CurveSource::File),
            shipped => shipped,
        };
        if self.filter.packed.is_some() {
            scene.filter.measured = kept("filter.curve");
        }
        scene.filter.curve = kept_curve(scene.filter.curve, "filter.curve");
        scene.filter.sieve = kept("filter.sieve");
        if scene.filter.sieve.is_none() {
            scene.filter.cu = scene.filter.cu.or(self.filter.shipped.map(|shipped| shipped.cu));
        }
        if self.filter.library.is_none() && !needs_grains_per_void(&scene, self.filter.guessed_density) {
            scene.filter.grains_per_void = self.filter.grains_per_void;
        }
        scene.base.sieve = kept("base.sieve");
        scene.base.dc_curve = kept_curve(scene.base.dc_curve, "base.dc_curve");
        scene.network.file = kept("network.file");
        scene.network.packing = kept("network.packing");
        scene
    }

    /// Fingerprint of all inputs of the results: the resolved scene and its files.
    pub(crate) fn fingerprint(&self) -> String {
        // No result depends on the cover.
        let scene = Scene { about: About::default(), ..self.resolved() };
        let mut protocol = if scene.exit_rule().needs_flow() { WATER_PROTOCOL } else { PROTOCOL };
        if scene.law().is_some() {
            protocol += ARCHING_PROTOCOL;
        }
        let mut text = format!("{protocol}\n{}", scene.to_toml()).into_bytes();
        if self.filter.library.is_some() || scene.filter.estimate.is_some() {
            // Another library, another lookup in it, or other random circles give other curves and other
            // amounts of base.
            let ends = &self.filter.curve_ends;
            let own_grains = self.filter.library.as_ref().map(|library| library.found.grains_per_void);
            for grains in own_grains.into_iter().chain(ends.iter().map(|end| end.times_grains)) {
                text.extend_from_slice(&grains.to_le_bytes());
            }
            for curve in std::iter::once(&self.filter.curve).chain(ends.iter().map(|end| &end.curve)) {
                let points: Vec<_> = curve.points().iter().map(|point| (point.percent, point.size)).collect();
                text.extend_from_slice(format!("{points:?}").as_bytes());
            }
        }
        text.extend_from_slice(self.filter.shipped.map_or("", |shipped| shipped.curve_csv).as_bytes());
        for input in self.inputs.iter().filter(|input| input.setting != "filter.density") {
            text.extend_from_slice(input.setting.as_bytes());
            text.extend_from_slice(&input.bytes);
        }
        format!("{:032x}", xxhash_rust::xxh3::xxh3_128(&text))
    }

    /// Key that two cases share only if [`Case::network`] builds the same network for this seed; `None`
    /// if a case has a single network, which already exists.
    pub(crate) fn network_key(&self, seed: u64) -> Option<u128> {
        let source = self.scene.network.source();
        if self.network.fixed.is_some() || matches!(source, NetworkSource::File(_)) {
            return None;
        }
        let curve: Vec<(u64, u64)> =
            self.filter.curve.points().iter().map(|p| (p.percent.to_bits(), p.size.to_bits())).collect();
        let (unit, rule) = (self.filter.unit_mm.to_bits(), self.scene.exit_rule());
        let made_of = format!("{seed} {source:?} {unit} {rule:?} {:?} {curve:?}", self.scene.exits);
        Some(xxhash_rust::xxh3::xxh3_128(made_of.as_bytes()))
    }

    /// True if its first runs begin with exits that depend only on the network, and passive particles
    /// take them.
    pub(crate) fn begins_with_plain_exits(&self) -> bool {
        let scene = &self.scene;
        let has_counts = matches!(scene.walk.engine, Engine::Counts | Engine::Expected);
        has_counts && scene.is_lattice_by_area() && scene.law().is_none() && !scene.leaves_openings()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends that differ only in their amount of base give other results.
    #[test]
    fn the_grains_per_void_of_an_end_are_in_the_fingerprint() {
        let case = Case::built_in(&["filter.library=loose", "filter.cu=1.5", "filter.d0_mm=1"]).unwrap();
        let mut other = case.clone();
        other.filter.curve_ends[0].times_grains *= 0.9;
        assert_ne!(case.fingerprint(), other.fingerprint());
    }

    #[test]
    fn what_is_only_said_of_a_scene_is_kept_and_changes_no_fingerprint() {
        let case = |set: &[&str]| Case::built_in(set).unwrap();
        let with_cover = case(&["about.client=Water Board", "about.project=Dam"]);
        assert_eq!(with_cover.fingerprint(), case(&[]).fingerprint());
        assert_ne!(with_cover.fingerprint(), case(&["base.cu=1.6"]).fingerprint());
        assert_eq!(with_cover.resolved().about.client.as_deref(), Some("Water Board"));
    }
}
