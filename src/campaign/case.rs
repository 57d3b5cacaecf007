//! A case: a scene with its files read and every number worked out, before any work is done.

use std::path::{Path, PathBuf};

use super::scene::{Amount, BaseGradation, CurveSource, D85, FilterGradation, NetworkSource, Scene};
use super::settings::SceneError;
use crate::constrictions::{Curve, CurveError, CurveUnit, ShippedFilter, find};
use crate::gradation::{BaseSupply, Gradation, GradationError, NumberError, SizeSampler, base_particles};
use crate::network::{Network, NetworkError};
use crate::outcome::record::{self, InputFile, Ratios};
use crate::walk::{CHUNK, Engine};

/// Why a scene cannot be walked.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The scene itself.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A gradation.
    #[error(transparent)]
    Gradation(#[from] GradationError),
    /// A constriction curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// A number worked out from the scene.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// The network.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// More memory than there is.
    #[error(
        "{n_base} base particles walked one by one on {voids} voids need {needed} of memory, but {available} are \
         available; set base.cap or base.n_base lower, or a smaller network"
    )]
    Memory {
        /// Base particles.
        n_base: u64,
        /// Voids.
        voids: u64,
        /// Bytes needed, in words.
        needed: String,
        /// Bytes available, in words.
        available: String,
    },
}

/// A file that was read, and the name under which a run folder keeps it.
#[derive(Clone, Debug)]
pub struct Input {
    /// The setting that names it.
    pub setting: &'static str,
    /// Its path as given.
    pub path: PathBuf,
    /// Name inside the run folder.
    pub kept_as: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// A scene, worked out.
pub struct Case {
    /// The scene it comes from.
    pub scene: Scene,
    /// The filter's gradation.
    pub filter: Gradation,
    /// The filter's constriction curve (mm).
    pub curve: Curve,
    /// The shipped filter that the curve is, if it is one.
    pub shipped: Option<&'static ShippedFilter>,
    /// The base's gradation.
    pub base: Gradation,
    /// Draws the base's sizes, in units of `unit_mm`.
    pub sampler: SizeSampler,
    /// N_base, by Eq. (2) or as given.
    pub supply: BaseSupply,
    /// Filter grains per void.
    pub grains_per_void: f64,
    /// Mass of base over mass of filter.
    pub mass_ratio: f64,
    /// The reference length: the smallest filter grain (mm).
    pub unit_mm: f64,
    /// The network, where it comes from a file.
    pub network_file: Option<Network>,
    /// Voids, constrictions, start nodes, layers.
    pub counts: [u64; 4],
    /// Files that were read.
    pub inputs: Vec<Input>,
}

/// Reads the files of a scene, and remembers them.
#[derive(Default)]
struct Files(Vec<Input>);

impl Files {
    /// Notes a file that a reader has read; reads it again for the copy in the run folder.
    fn keep(&mut self, setting: &'static str, path: &Path, kept_as: &str) -> Result<(), CaseError> {
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| SceneError::File { file, source })?;
        let input = Input { setting, path: path.to_owned(), kept_as: format!("inputs/{kept_as}"), bytes };
        self.0.push(input);
        Ok(())
    }

    fn curve(
        &mut self,
        source: &CurveSource,
        setting: &'static str,
        kept_as: &str,
    ) -> Result<(Curve, Option<&'static ShippedFilter>), CaseError> {
        match source {
            CurveSource::Shipped(name) => {
                let shipped = find(name)?;
                Ok((shipped.curve()?, Some(shipped)))
            }
            CurveSource::File(path) => {
                let curve = Curve::from_csv(path)?;
                self.keep(setting, path, kept_as)?;
                Ok((curve, None))
            }
        }
    }

    fn sieve(
        &mut self,
        path: &Path,
        d0_mm: Option<f64>,
        setting: &'static str,
        kept_as: &str,
    ) -> Result<Gradation, CaseError> {
        let gradation = Gradation::from_sieve_csv(path, d0_mm)?;
        self.keep(setting, path, kept_as)?;
        Ok(gradation)
    }
}

impl Case {
    /// Reads the scene's files and works out every number; does no other work.
    ///
    /// # Errors
    /// A file that is refused, or numbers that clash.
    pub fn new(scene: Scene) -> Result<Self, CaseError> {
        let mut files = Files::default();
        let curve = match &scene.curve {
            Some(source) => Some(files.curve(source, "filter.curve", "filter-curve.csv")?),
            None => None,
        };
        let shipped = curve.as_ref().and_then(|(_, shipped)| *shipped);
        let filter = match &scene.filter {
            FilterGradation::Linear { d0_mm, cu } => {
                let cu = cu.or(shipped.map(|s| s.cu)).ok_or_else(|| {
                    scene.clash("filter.cu or filter.sieve is missing: this constriction curve does not say its filter's gradation")
                })?;
                Gradation::linear_from_d0(*d0_mm, cu)?
            }
            FilterGradation::Sieve(path, d0_mm) => {
                files.sieve(path, *d0_mm, "filter.sieve", "filter-sieve.csv")?
            }
        };
        let unit_mm = filter.smallest_mm();
        let network_file = match &scene.network {
            NetworkSource::File(path) => {
                let network = Network::read_csv(path, unit_mm)?;
                files.keep("network.file", path, "network.csv")?;
                Some(network)
            }
            NetworkSource::Cubic(_) => None,
        };
        let curve = match (&network_file, curve) {
            (Some(network), _) => curve_of(network)?,
            (None, Some((curve, _))) => curve.in_mm(unit_mm)?,
            (None, None) => return Err(scene.clash("filter.curve is missing").into()),
        };
        let base = base_gradation(&scene, &filter, &curve, unit_mm, &mut files)?;
        let counts = match (&network_file, &scene.network) {
            (Some(n), _) => {
                [n.voids() as u64, n.constrictions() as u64, n.start().len() as u64, n.layers() as u64]
            }
            (None, NetworkSource::Cubic(shape)) => {
                let [nx, ny, nz] = shape.map(u64::from);
                let constrictions = Network::lattice_constrictions(*shape)? as u64;
                [constrictions / 3, constrictions, nx * ny, nz]
            }
            (None, NetworkSource::File(_)) => unreachable!("a network file was read above"),
        };
        let grains_per_void = scene.grains_per_void.or(shipped.map(|s| s.grains_per_void));
        let (supply, grains_per_void, mass_ratio) =
            supply(&scene, grains_per_void, counts[0], &base, &filter)?;
        let sampler = SizeSampler::new(&base, unit_mm)?;
        for (name, gradation, percent) in [("filter", &filter, 15.0), ("base", &base, 85.0)] {
            if gradation.d(percent).is_none() {
                let problem = format!(
                    "the {name}'s D{percent} lies in a finest tail of unknown size: add finer sieves, or {name}.d0_mm"
                );
                return Err(scene.clash(problem).into());
            }
        }
        Ok(Self {
            filter,
            curve,
            shipped,
            base,
            sampler,
            supply,
            grains_per_void,
            mass_ratio,
            unit_mm,
            network_file,
            counts,
            inputs: files.0,
            scene,
        })
    }

    /// The network of the replicate with this seed.
    ///
    /// # Errors
    /// None that [`Case::new`] has not found.
    pub fn network(&self, seed: u64) -> Result<Network, NetworkError> {
        match (&self.network_file, &self.scene.network) {
            (None, NetworkSource::Cubic(shape)) => Network::cubic(*shape, &self.curve, self.unit_mm, seed),
            (file, _) => Ok(file.clone().expect("a network from a file was read")),
        }
    }

    /// Base particles of a run of `n_base` that are walked one by one: all, or those that may be coarser than the
    /// finest constriction.
    pub fn one_by_one(&self, n_base: u64) -> u64 {
        if self.scene.engine == Engine::Particles {
            return n_base;
        }
        let finest = match &self.network_file {
            Some(network) => network.finest_open(|_| false),
            None => (self.curve.smallest() / self.unit_mm) as f32,
        };
        let passive = self.sampler.word_limit(finest) as f64 / 18_446_744_073_709_551_616.0;
        (n_base as f64 * (1.0 - passive)).ceil() as u64
    }

    /// Increments over which the base is inserted: a whole number, so that every part is equal.
    pub fn increments(&self) -> u64 {
        (1.0 / self.scene.inject_share).round().max(1.0) as u64
    }

    /// Bytes that walking `n_base` particles takes, network and tallies included.
    pub fn bytes(&self, n_base: u64) -> u64 {
        let chunks = self.one_by_one(n_base).div_ceil(CHUNK as u64);
        let particles = chunks.saturating_mul(8 * CHUNK as u64 + 256);
        let [voids, constrictions, ..] = self.counts;
        particles.saturating_add(voids * 140 + constrictions * 25)
    }

    /// Refuses what does not fit the memory that is available.
    ///
    /// # Errors
    /// [`CaseError::Memory`].
    pub fn check_memory(&self, available: u64) -> Result<(), CaseError> {
        let needed = self.bytes(self.supply.n_base);
        if needed <= available {
            return Ok(());
        }
        Err(CaseError::Memory {
            n_base: self.one_by_one(self.supply.n_base),
            voids: self.counts[0],
            needed: in_words(needed),
            available: in_words(available),
        })
    }

    /// D15F over D85B and D95B.
    pub fn ratios(&self) -> Ratios {
        let d = |gradation: &Gradation, percent| gradation.d(percent).unwrap_or(f64::NAN);
        let d15f = d(&self.filter, 15.0);
        Ratios { d15f_over_d85b: d15f / d(&self.base, 85.0), d15f_over_d95b: d15f / d(&self.base, 95.0) }
    }

    /// Parts of the program that this scene does not need, in words.
    pub fn left_out(&self) -> Vec<String> {
        let mut left_out = vec![match self.network_file {
            Some(_) => "packing, triangulation and constriction curve: the network is given".to_string(),
            None => "packing and triangulation: the constriction curve is given".to_string(),
        }];
        if self.scene.runs == 1 {
            left_out.push("the second run: it was not asked for".into());
        }
        if self.scene.sensitivity.0.is_empty() {
            left_out.push("sensitivity to the number of base particles: it was not asked for".into());
        }
        left_out
    }

    /// Files that were read, with their checksums.
    pub fn input_files(&self) -> Vec<InputFile> {
        let one = |i: &Input| InputFile {
            name: i.path.display().to_string(),
            xxh3: format!("{:016x}", xxhash_rust::xxh3::xxh3_64(&i.bytes)),
        };
        self.inputs.iter().map(one).collect()
    }

    /// What went in, as a run folder records it.
    pub fn record(&self) -> record::Inputs {
        let d = |gradation: &Gradation, percent| gradation.d(percent).unwrap_or(f64::NAN);
        let pairs = |points: Vec<(f64, f64)>| points.into_iter().map(|(a, b)| [a, b]).collect();
        let [voids, constrictions, start_nodes, layers] = self.counts;
        let d50_by_number = self.filter.d_by_number(50.0).unwrap_or(f64::NAN);
        let (kind, name, shape) = match &self.scene.network {
            NetworkSource::Cubic(n) => (
                record::NetworkKind::Cubic,
                format!("cubic {} x {} x {}", n[0], n[1], n[2]),
                n.map(|n| Some(u64::from(n))),
            ),
            NetworkSource::File(path) => (record::NetworkKind::File, path.display().to_string(), [None; 3]),
        };
        let curve_name = match (&self.network_file, &self.scene.curve) {
            (Some(_), _) | (None, None) => "the network's own constrictions".to_string(),
            (None, Some(CurveSource::Shipped(name))) => name.clone(),
            (None, Some(CurveSource::File(path))) => path.display().to_string(),
        };
        record::Inputs {
            filter: record::Filter {
                name: match &self.scene.filter {
                    FilterGradation::Sieve(path, _) => path.display().to_string(),
                    FilterGradation::Linear { .. } => {
                        format!("linear, Cu {:.3}", self.filter.cu().unwrap_or(f64::NAN))
                    }
                },
                attribution: match (&self.network_file, self.shipped) {
                    (None, Some(shipped)) => format!("{} ({})", shipped.attribution, shipped.licence),
                    _ => String::new(),
                },
                cu: self.filter.cu(),
                d0_mm: self.unit_mm,
                d15_mm: d(&self.filter, 15.0),
                d50_mm: d(&self.filter, 50.0),
                d50_by_number_mm: d50_by_number,
                d85_mm: d(&self.filter, 85.0),
                void_ratio: self.shipped.filter(|_| self.network_file.is_none()).map(|s| s.void_ratio),
                gradation: pairs(self.filter.points()),
                constrictions: self.curve.points().into_iter().map(|(percent, d)| [d, percent]).collect(),
                cu_csd: self.curve.cu(),
                curve_name,
            },
            base: record::Base {
                name: match &self.scene.base {
                    BaseGradation::Sieve(path, _) => path.display().to_string(),
                    BaseGradation::Single(_) => "one size".into(),
                    BaseGradation::Linear { cu, .. } => format!("linear, Cu {cu}"),
                },
                cu: self.base.cu(),
                d0_mm: self.base.smallest_mm(),
                d15_mm: self.base.d(15.0),
                d50_mm: self.base.d(50.0),
                d85_mm: d(&self.base, 85.0),
                d95_mm: d(&self.base, 95.0),
                d100_mm: self.base.largest_mm(),
                tail_mass_fraction: self.base.tail_mass_fraction(),
                gradation: pairs(self.base.points()),
            },
            network: record::Network {
                kind,
                name,
                nx: shape[0],
                ny: shape[1],
                nz: shape[2],
                voids,
                constrictions,
                start_nodes,
                layers,
                thickness_mm: self.network_file.is_none().then(|| layers as f64 * d50_by_number),
            },
            mass_ratio: self.mass_ratio,
            inject_share: self.scene.inject_share,
            scale_free: self.is_scale_free(),
        }
    }

    /// Whether lengths are in units of the smallest filter grain: a scale-free curve with d0_mm = 1.
    pub fn is_scale_free(&self) -> bool {
        matches!(self.scene.filter, FilterGradation::Linear { d0_mm, .. } if d0_mm == 1.0)
            && self.shipped.is_some()
            && matches!(
                self.scene.base,
                BaseGradation::Linear { d85: D85::AtDc(..) | D85::Ratio(_), .. } | BaseGradation::Single(_)
            )
    }

    /// Where the inputs leave the range in which the model was checked, and what else a reader must know.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let mut cu = |whose: &str, cu: Option<f64>, low: f64, high: f64| match cu {
            Some(cu) if cu < low - 1e-9 || cu > high + 1e-9 => warnings
                .push(format!("Cu of the {whose} is {cu:.2}: the model was checked for {low} to {high}")),
            _ => {}
        };
        cu("filter", self.filter.cu(), 1.2, 6.0);
        cu("base", self.base.cu(), 1.2, 4.5);
        if !self.is_scale_free() {
            let fines = self.base.percent_finer_by_mass(0.075).max(100.0 * self.base.tail_mass_fraction());
            if self.base.smallest_mm() < 0.075 && fines > 15.0 {
                warnings.push(format!(
                    "{fines:.0} % of the base is finer than 0.075 mm: cohesion may govern, which the model does not know"
                ));
            }
        }
        if self.base.d(50.0).zip(self.filter.d(50.0)).is_some_and(|(b, f)| b > f) {
            warnings.push("the base is coarser than the filter (D50): are the two files exchanged?".into());
        }
        if self.base.tail_mass_fraction() > 0.0 {
            warnings.push(format!(
                "{:.1} % of the base is finer than its finest sieve: taken as passive and counted by mass only",
                100.0 * self.base.tail_mass_fraction()
            ));
        }
        if self.supply.capped {
            warnings.push(format!(
                "the cap of {} base particles bit: Eq. (2) asks for {}. Fewer particles block less: a bias towards more erosion, not \
                 noise",
                self.supply.n_base, self.supply.n_base_eq2
            ));
        }
        warnings
    }
}

/// The constriction curve of a given network (mm): its open diameters by number, at most a thousand points.
fn curve_of(network: &Network) -> Result<Curve, CaseError> {
    let mut sizes: Vec<f64> =
        network.diameters().iter().filter(|&&d| d > 0.0).map(|&d| f64::from(d) * network.unit_mm()).collect();
    sizes.sort_by(f64::total_cmp);
    let Some(last) = sizes.len().checked_sub(1) else {
        return Ok(Curve::from_points(&[(100.0, network.unit_mm())], CurveUnit::Mm)?);
    };
    let steps = last.clamp(1, 1000);
    let point = |k: usize| (100.0 * k as f64 / steps as f64, sizes[last * k / steps]);
    Ok(Curve::from_points(&(0..=steps).map(point).collect::<Vec<_>>(), CurveUnit::Mm)?)
}

fn base_gradation(
    scene: &Scene,
    filter: &Gradation,
    curve: &Curve,
    unit_mm: f64,
    files: &mut Files,
) -> Result<Gradation, CaseError> {
    let (cu, d85_mm) = match &scene.base {
        BaseGradation::Sieve(path, d0_mm) => {
            return files.sieve(path, *d0_mm, "base.sieve", "base-sieve.csv");
        }
        BaseGradation::Single(size) => return Ok(Gradation::single(*size)?),
        BaseGradation::Linear { cu, d85: D85::Mm(mm) } => (*cu, *mm),
        BaseGradation::Linear { cu, d85: D85::Ratio(ratio) } => {
            let d15f = filter.d(15.0).ok_or_else(|| scene.clash("the filter's D15 is not known"))?;
            (*cu, d15f / ratio)
        }
        BaseGradation::Linear { cu, d85: D85::AtDc(percent, other) } => {
            let other = match other {
                Some(source) => {
                    Some(files.curve(source, "base.dc_curve", "base-dc-curve.csv")?.0.in_mm(unit_mm)?)
                }
                None => None,
            };
            let curve = other.as_ref().unwrap_or(curve);
            (*cu, curve.dc(*percent).ok_or_else(|| scene.clash("base.d85_at_dc is not on the curve"))?)
        }
    };
    Ok(Gradation::linear_from_dx(85.0, d85_mm, cu)?)
}

/// N_base; the grains per void and the mass ratio that it stands for.
fn supply(
    scene: &Scene,
    grains_per_void: Option<f64>,
    voids: u64,
    base: &Gradation,
    filter: &Gradation,
) -> Result<(BaseSupply, f64, f64), CaseError> {
    let missing =
        || scene.clash("filter.grains_per_void is missing (Eq. 2): only the shipped curves know theirs");
    match scene.amount {
        Amount::MassRatio(ratio, cap) => {
            let grains = grains_per_void.ok_or_else(missing)?;
            let supply = base_particles(ratio, grains, voids, base, filter, cap)?;
            if supply.n_base == 0 {
                let problem = "Eq. (2) gives less than half a base particle: a larger network, mass ratio or grains per void is needed";
                return Err(scene.clash(problem).into());
            }
            Ok((supply, grains, ratio))
        }
        Amount::Number(n) => {
            let grains = grains_per_void.unwrap_or(1.0);
            // Eq. (2) is linear in the mass ratio: what one unit of it gives says what `n` stands for.
            let per_ratio = base_particles(1.0, grains, voids, base, filter, None).map(|s| s.n_base_eq2);
            let ratio = per_ratio.map_or(f64::NAN, |per_ratio| n as f64 / per_ratio as f64);
            let eq2 = base_particles(0.05, grains, voids, base, filter, None).map_or(n, |s| s.n_base_eq2);
            Ok((BaseSupply { n_base: n, n_base_eq2: eq2, capped: false }, grains, ratio))
        }
    }
}

/// Bytes in words: `1.6 GB`.
pub fn in_words(bytes: u64) -> String {
    let (mut value, mut unit) = (bytes as f64, "bytes");
    for larger in ["kB", "MB", "GB", "TB", "PB", "EB"] {
        if value < 1000.0 {
            break;
        }
        value /= 1000.0;
        unit = larger;
    }
    if unit == "bytes" { format!("{bytes} bytes") } else { format!("{value:.2} {unit}") }
}
