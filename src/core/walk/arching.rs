//! Arching: a particle that fits through a constriction may jam in it together with other arriving particles.
//!
//! A particle that would pass a constriction `R` times its size (ratio of diameters) jams with the
//! probability given by a [`Law`], by its own draw. Particles that jam in one constriction in one increment
//! form one arch, in the order of insertion, up to the number in an arch for the `R` of the first
//! ([`in_arch`]); the others pass (module `chunks`). The constriction closes from the next increment on, even
//! if the arch is incomplete: with few particles per increment too few arrive to complete it.
//!
//! Chunks affect only the draw of a particle: the one at place `j` of chunk `c` takes draw `j` of the stream
//! (seed, arching, run, increment, `c`), extended to 64 bits if sixteen do not decide.
//!
//! A law may depend on the concentration, the solids fraction of the suspension that enters the filter:
//! particles that move with the water keep it in every void, so the scene states one value for the walk.

use crate::schema::Leaf;
use libm::{exp, lgamma, log, pow};
use serde::{Deserialize, Serialize};

/// Solids fraction of densely packed grains, the maximum for a suspension.
pub const DENSEST: f64 = 0.64;

/// A published law of clogging.
///
/// Laws are data: the walk reads a table of probabilities over `R` ([`Arching`]).
#[derive(Debug)]
pub struct Law {
    /// Name of the law in a scene.
    pub name: &'static str,
    /// Publication of the law.
    pub source: &'static str,
    /// Parts of the source that could be read, and other sources used.
    pub basis: &'static str,
    /// Minimum `R` at which nothing arches.
    pub widest: f64,
    /// True if the probability depends on the concentration; the other laws are for dense flow.
    pub of_concentration: bool,
    probability: fn(f64, f64) -> f64,
}

/// Name of a law in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LawName {
    /// No arches.
    #[serde(rename = "none")]
    None,
    /// Dense discharge of dry spheres.
    #[serde(rename = "zuriguel-2005")]
    Zuriguel2005,
    /// Suspension, with enough particles at the neck at once.
    #[serde(rename = "marin-2018")]
    Marin2018,
    /// Every particle larger than a third of the constriction.
    #[serde(rename = "critical-3")]
    Critical3,
}

impl Leaf for LawName {}

impl LawName {
    /// All names, in the order shown to users.
    pub const ALL: [Self; 4] = [Self::None, Self::Zuriguel2005, Self::Marin2018, Self::Critical3];

    /// Name as text.
    pub fn name(self) -> &'static str {
        self.law().map_or("none", |law| law.name)
    }

    /// Law of this name; `None` if particles do not arch.
    pub fn law(self) -> Option<&'static Law> {
        (self as usize).checked_sub(1).map(|place| &LAWS[place])
    }
}

/// All laws, in the order shown to users.
pub static LAWS: [Law; 3] = [
    Law {
        name: "zuriguel-2005",
        source: "Zuriguel, Garcimartin, Maza, Pugnaloni and Pastor 2005, Physical Review E 71, 051303",
        basis: "Dense discharge of dry spheres through a circular hole: on average A / (4.94 - R)^6.9 \
                grains pass before a jam, A = 9900. The constants were read in a later review, not in the \
                article; \
                that each grain jams with the same probability is taken from its abstract. It is the law of \
                the dense limit, without dilution. In the model it held bases that eroded in tests.",
        widest: 4.94,
        of_concentration: false,
        probability: zuriguel,
    },
    Law {
        name: "marin-2018",
        source: "Marin, Lhuissier, Rossi and Kaehler 2018, Physical Review E 97, 021102 (arXiv 1711.06119)",
        basis: "Suspensions arch for R < 3, if enough particles are at the neck at once. Read in the \
                abstract; that an arch needs R^2 + 1 particles was read in a later review. This program \
                assumes that the number at the neck is Poisson, with a mean from the concentration and the \
                volume of a neck as long as it is wide. The number in an arch is an integer, so the \
                probability is saw-toothed over R; from a concentration of about 0.2 on it rises with R, \
                whereas for dry grains it falls.",
        widest: 3.0,
        of_concentration: true,
        probability: at_the_neck,
    },
    Law {
        name: "critical-3",
        source: "after Marin, Lhuissier, Rossi and Kaehler 2018, Physical Review E 97, 021102",
        basis: "Every particle below R = 3 jams. A particle that jams alone is retained as by sieving with \
                particles three times as large, which checks the walk; if several jam in one constriction \
                at once, only as many stay as an arch holds. In the model it held bases that eroded in \
                tests.",
        widest: 3.0,
        of_concentration: false,
        probability: |_, _| 1.0,
    },
];

impl Law {
    /// Law of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        LAWS.iter().find(|law| law.name == name)
    }

    /// Probability that a particle jams in a constriction `ratio` (at least 1) times its size, at this
    /// concentration (volume of particles divided by volume of suspension); 0 from `widest` on.
    pub fn probability(&self, ratio: f64, concentration: f64) -> f64 {
        if ratio >= self.widest { 0.0 } else { (self.probability)(ratio, concentration) }
    }

    /// Maximum size of particles that can neither block nor arch, if this is the finest open constriction.
    pub fn passive_limit(&self, finest: f32) -> f32 {
        // Slightly finer, so that rounding never lets a passive particle arch.
        (f64::from(finest) / self.widest * (1.0 - 1e-6)) as f32
    }
}

/// Reciprocal of the mean number of particles up to and including the one that jams.
fn zuriguel(ratio: f64, _: f64) -> f64 {
    1.0 / (1.0 + 9900.0 / pow(4.94 - ratio, 6.9))
}

/// Probability that the other particles of an arch are in the neck (as long as it is wide) with this
/// particle.
///
/// Computed as 1 minus a sum, so probabilities below the last bit of 1 become 0.
fn at_the_neck(ratio: f64, concentration: f64) -> f64 {
    // Volume of the neck, pi / 4 D^2 D, divided by the volume of a particle, pi / 6 d^3.
    let mean = 1.5 * ratio * ratio * ratio * concentration;
    let others = in_arch(ratio) - 1;
    if mean <= 0.0 {
        return 0.0;
    }
    let poisson = |k: u32| exp(f64::from(k) * log(mean) - mean - lgamma(f64::from(k) + 1.0));
    (1.0 - (0..others).map(poisson).sum::<f64>()).max(0.0)
}

/// Number of particles in an arch over a constriction `ratio` times their size: R^2 + 1, at least 2.
fn in_arch(ratio: f64) -> u32 {
    (ratio * ratio + 1.0).round().max(2.0) as u32
}

const STEPS: usize = 1 << 14;

/// Number of bits of a draw that decide.
const BITS: u32 = 48;

/// Minimum probability that draws of this many bits can represent.
const RAREST: f64 = 1.0 / (1u64 << BITS) as f64;

/// Offset of the classes: twice the biased exponent of 1.
pub(super) const CLASS_OF_ONE: usize = 254;

/// Slightly wider, so that rounding never jams a particle beyond its reach.
fn wider(ratio: f64) -> f32 {
    (ratio * (1.0 + 1e-6)) as f32
}

/// Tabulated law at one concentration, for a walk.
#[derive(Clone, Debug)]
pub struct Arching {
    pub(super) law: &'static Law,
    /// Probability at equal steps of `R` from 1 to the widest; the last entry applies just below the widest.
    table: Vec<f64>,
    /// `R` from which the table contains no jams.
    stops_to: f64,
    reach: Reach,
}

/// Largest ratio of a constriction to a particle that jams in it, at least 1, for the sixteen bits of a
/// draw in classes of half a power of two ([`Arching::class_of`]).
pub(super) type Reach = [f32; 32];

impl Arching {
    /// Tabulates a law at this concentration (volume of particles divided by volume of suspension). Jams
    /// rarer than once in `2^48` draws count as impossible.
    pub fn new(law: &'static Law, concentration: f64) -> Self {
        let step = (law.widest - 1.0) / STEPS as f64;
        let at = |k: usize| {
            // The law is not defined at `widest` itself: the table ends with the limit there.
            let ratio = 1.0 + step * k as f64;
            let probability = (law.probability)(ratio.min(law.widest * (1.0 - 1e-12)), concentration);
            if probability < RAREST { 0.0 } else { probability }
        };
        let table: Vec<f64> = (0..=STEPS).map(at).collect();
        // Between two steps the table is above 0 if it is above 0 at either of them.
        let end_of = |jams: &dyn Fn(&f64) -> bool| {
            1.0 + step * table.iter().rposition(jams).map_or(0, |k| (k + 1).min(STEPS)) as f64
        };
        let reach = std::array::from_fn(|class| {
            // Smallest draw of the class: a power of two, or half-way to the next.
            let least =
                if class == 0 { 0.0 } else { (1 << (class / 2)) as f64 * (1.0 + 0.5 * (class % 2) as f64) };
            wider(end_of(&|probability| probability * 65_536.0 > least.floor()))
        });
        Self { law, stops_to: end_of(&|&probability| probability > 0.0), table, reach }
    }

    /// Minimum `R` at which nothing arches at this concentration: [`Law::widest`], or less if jams in
    /// wider constrictions are too rare for any draw.
    pub(crate) fn stops_to(&self) -> f64 {
        self.stops_to
    }

    /// Tells if a particle of this size may arch in this constriction, which it fits.
    #[inline]
    fn may(&self, width: f32, diameter: f32) -> bool {
        f64::from(width) < self.law.widest * f64::from(diameter)
    }

    pub(super) fn reach(&self) -> &Reach {
        &self.reach
    }

    /// Class of a draw: twice its power of two, plus one from half-way to the next power on.
    #[inline(always)]
    pub(super) fn class_of(draw: u16) -> usize {
        ((f32::from(draw).to_bits() >> 22) as usize).saturating_sub(CLASS_OF_ONE)
    }

    /// Number of particles in the arch that a particle of this size starts if it jams in this constriction
    /// by this word; `None` if it passes.
    #[inline]
    pub(super) fn jams(&self, width: f32, diameter: f32, word: u64) -> Option<u32> {
        if !self.may(width, diameter) {
            return None;
        }
        let draw = (word >> (64 - BITS)) as f64 / (1u64 << BITS) as f64;
        let ratio = f64::from(width) / f64::from(diameter);
        (draw < self.by_table(ratio)).then(|| in_arch(ratio))
    }

    pub(super) fn by_table(&self, ratio: f64) -> f64 {
        let place = ((ratio - 1.0) / (self.law.widest - 1.0)).clamp(0.0, 1.0) * STEPS as f64;
        let step = (place as usize).min(STEPS - 1);
        let [low, high] = [self.table[step], self.table[step + 1]];
        low + (place - step as f64) * (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_laws() {
        for name in LawName::ALL {
            assert_eq!(serde_json::to_value(name).unwrap(), name.name());
            assert_eq!(Law::named(name.name()).map(|law| law.name), name.law().map(|law| law.name));
        }
        assert_eq!(LawName::ALL.len(), LAWS.len() + 1);
    }

    #[test]
    fn a_table_is_its_law() {
        for law in &LAWS {
            for concentration in [0.01, 0.2, 0.6] {
                let arching = Arching::new(law, concentration);
                for k in 0..1000 {
                    let ratio = 1.0 + (law.widest - 1.0) * (f64::from(k) + 0.37) / 1000.0;
                    let (table, whole) = (arching.by_table(ratio), law.probability(ratio, concentration));
                    // The number of particles in an arch is an integer, so one law has steps.
                    let steps = in_arch(ratio - 3e-4) != in_arch(ratio + 3e-4);
                    let near = (table - whole).abs() < 1e-6 || (steps && law.of_concentration);
                    assert!(near && (0.0..=1.0).contains(&table), "{} {ratio}: {table} {whole}", law.name);
                }
                assert_eq!(law.probability(law.widest, concentration), 0.0);
            }
        }
    }

    /// By hand. Dense discharge, from the constants of the review: 9900 / 3.94^6.9 = 0.7704 particles pass
    /// before a jam, 9900 / 3.44^6.9 = 1.965, 9900 / 1.94^6.9 = 102.3. In a suspension R = 2 needs 5, so four
    /// others; at 0.2 their mean number is 0.2 * 1.5 * 8 = 2.4, and four or more have probability 1 - e^-2.4
    /// (1 + 2.4 + 2.88 + 2.304) = 0.2213. At 0.047 an arch of two (1.22) has 1 - e^-0.1280, an arch of three
    /// (1.23) 1 - e^-m (1 + m) with m = 0.1312: the law is saw-toothed.
    #[test]
    fn laws_are_as_published() {
        let [dense, suspension] = ["zuriguel-2005", "marin-2018"].map(|name| Law::named(name).unwrap());
        for (law, ratio, concentration, wanted) in [
            (dense, 1.0, 0.0, 1.0 / 1.7704),
            (dense, 1.5, 0.0, 1.0 / 2.965),
            (dense, 3.0, 0.0, 1.0 / 103.3),
            (suspension, 2.0, 0.2, 0.2213),
            (suspension, 1.22, 0.047, 0.12016),
            (suspension, 1.23, 0.047, 0.007888),
            (suspension, 1.58, 0.047, 0.03219),
            (suspension, 1.59, 0.047, 0.003072),
        ] {
            let probability = law.probability(ratio, concentration);
            assert!((probability / wanted - 1.0).abs() < 3e-4, "{} {ratio}: {probability}", law.name);
        }
        assert_eq!(suspension.probability(2.0, 0.0), 0.0);
        assert!(suspension.probability(1.5, 0.02) < 0.01 && suspension.probability(2.9, 0.6) > 0.9);
        // Where it is dense, it rises with R.
        for dense in [0.2, 0.6] {
            assert!([1.23, 2.0, 2.5, 2.9].map(|ratio| at_the_neck(ratio, dense)).is_sorted_by(|a, b| a < b));
        }
        // Below the last bit of 1 minus a sum.
        assert_eq!(at_the_neck(2.8, 0.001), 0.0);
    }

    /// By hand: four others are in a neck of R = 2 with probability m^4 / 24, m = 12 times the concentration.
    /// At 0.0001 that is 8.6e-14, some 24 draws of 2^48; at 0.00001 it is 8.6e-18, less than one.
    #[test]
    fn what_no_draw_can_be_is_no_jam() {
        let law = Law::named("marin-2018").unwrap();
        assert!((law.probability(2.0, 1e-4) / 8.6e-14 - 1.0).abs() < 0.02);
        let jams = |concentration| Arching::new(law, concentration).jams(2.0, 1.0, 0);
        assert_eq!((jams(1e-4), jams(1e-5)), (Some(5), None));
        let [rare, rarer] = [1e-4, 1e-5].map(|concentration| Arching::new(law, concentration).stops_to());
        assert!(1.0 < rarer && rarer < 2.0 && 2.0 < rare && rare < 3.0, "{rare} {rarer}");
        for law in &LAWS {
            // Jams of a law that falls to 0 at its widest are too rare just below it.
            let dense = Arching::new(law, DENSEST).stops_to();
            assert!((law.widest - 0.05..=law.widest).contains(&dense), "{} {dense}", law.name);
        }
    }

    /// No draw jams a particle beyond its reach, and the reach is no wider than its class (half a power of
    /// two) requires.
    #[test]
    fn no_draw_jams_beyond_its_reach() {
        for arching in LAWS.iter().map(|law| Arching::new(law, 0.2)) {
            for draw in 0..=u16::MAX {
                let class = Arching::class_of(draw);
                assert!(class < 32 && class >= Arching::class_of(draw.saturating_sub(1)));
                let reach = arching.reach()[class];
                assert!(reach >= 1.0 && f64::from(reach) <= arching.law.widest * 1.000_01);
                if draw % 37 != 0 {
                    continue;
                }
                for k in 1..=40u8 {
                    let width = reach * (1.0 + f32::from(k) / 40.0 * 3.0);
                    let word = u64::from(draw) << 48;
                    assert_eq!(arching.jams(width, 1.0, word), None, "{draw} {width}");
                }
            }
        }
        let dense = Arching::new(&LAWS[0], 0.6);
        // 1 / 102.3 of all draws jam at R = 3: 640 of them.
        assert!(dense.reach()[Arching::class_of(500)] > 3.0 && dense.reach()[Arching::class_of(1024)] < 3.0);
        assert_eq!(dense.reach()[31], wider(1.0));
    }

    #[test]
    fn a_passive_particle_never_arches() {
        let arching = Arching::new(Law::named("critical-3").unwrap(), 0.0);
        for finest in [0.1f32, 0.333_333_34, 0.7, 1e-3] {
            let limit = arching.law.passive_limit(finest);
            assert!(!arching.may(finest, limit) && arching.may(finest, limit * 1.000_01), "{finest}");
        }
        assert_eq!(arching.law.passive_limit(f32::INFINITY), f32::INFINITY);
    }
}
