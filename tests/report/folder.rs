//! A run folder as a finished run leaves it, made up but plausible: the loose Cu 1.5 filter with D0F = 4 mm
//! against a base of Cu 3. No walk is behind it; only the report is tested with it.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use voidwalk::outcome::record::*;
use voidwalk::practice::{AppliedRule, InputFile, Note, RuleQuantity, RuleRole, RuleUnit};
use voidwalk::store::format::{MANIFEST, OUTCOME};

/// A number between 0 and 1 that depends on three others and on nothing else.
fn scatter(a: u64, b: u64, c: u64) -> f64 {
    let mixed = (a * 0x9e37_79b9 + b * 0x85eb_ca6b + c * 0xc2b2_ae35 + 1).wrapping_mul(0x2545_f491_4f6c_dd1d);
    (mixed >> 40) as f64 / (1u64 << 24) as f64
}

fn straight(d0_mm: f64, cu: f64) -> Vec<[f64; 2]> {
    (0..=20).map(|i| [d0_mm * libm::pow(cu, f64::from(i) * 0.1), f64::from(i) * 5.0]).collect()
}

fn statistic(mean: f64, sd: f64, replicates: u64) -> Statistic {
    if replicates < 2 {
        return Statistic { mean, sd: None, low: None, high: None };
    }
    let half = 2.0 * sd / (replicates as f64).sqrt();
    Statistic { mean, sd: Some(sd), low: Some(mean - half), high: Some(mean + half) }
}

/// A note that holds a text.
pub fn note(text: &str) -> Note {
    Note::ReadAs { file: text.to_owned(), reading: "a table".to_owned() }
}

/// The outcome of `replicates` replicates of two runs.
pub fn outcome(replicates: u64) -> Outcome {
    let (d0f, cu_f) = (4.0, 1.5);
    let (d0b, cu_b) = (0.141, 3.0);
    let filter_at = |percent: f64| d0f * libm::pow(cu_f, percent / 50.0);
    let base_at = |percent: f64| d0b * libm::pow(cu_b, percent / 50.0);
    let dc = [
        (0.1604, 0.0),
        (0.186, 2.0),
        (0.205, 5.0),
        (0.222, 10.0),
        (0.247, 20.0),
        (0.268, 30.0),
        (0.29, 40.0),
        (0.313, 50.0),
        (0.338, 60.0),
        (0.367, 70.0),
        (0.405, 80.0),
        (0.465, 90.0),
        (0.53, 95.0),
        (0.64, 99.0),
        (0.79, 100.0),
    ];
    let run = |replicate: u64, run: u64| {
        let eroded = final_eroded(replicate, run);
        let blocked = if run == 1 { 8_410 } else { 9_150 };
        Run {
            run,
            eroded_mass_fraction: eroded,
            eroded_number_fraction: 0.2 + eroded,
            largest_eroded_mm: Some(0.886 + 0.01 * scatter(replicate, run, 5)),
            largest_eroded_over_d15f: Some(0.196 + 0.002 * scatter(replicate, run, 5)),
            blocked,
            blocked_fraction: blocked as f64 / 288_000.0,
            blocked_first_three_layers_fraction: 0.21 + 0.03 * run as f64,
            backbone_fraction: 0.81 - 0.05 * run as f64,
            inserted: 21_443_871,
            eroded: 7_105_300,
            retained_in_constrictions: 1_304_221,
            retained_in_arches: None,
            arches: None,
            arched_mass_fraction: None,
            retained_in_voids: 13_034_102,
            trapped: 248,
            retained_per_void: 149.4,
            deepest_retained_layer: Some(59),
            retained_95_layer: Some(11),
            increments: 404 + replicate,
            particle_moves: 1_904_220_114,
            k_over_k0: None,
            flow_solutions: None,
            flow_closed_most: None,
            k0_mm2: None,
            fullness_max: None,
            overfull_fraction: None,
            by_connectivity: Vec::new(),
            seconds: 11.9,
        }
    };
    let all: Vec<Replicate> = (1..=replicates)
        .map(|replicate| Replicate {
            seed: 2016 + replicate,
            verdict: if final_eroded(replicate, 2) < 0.075 { Verdict::Some } else { Verdict::Continuing },
            runs: vec![run(replicate, 1), run(replicate, 2)],
        })
        .collect();
    let mean = |run: u64| (1..=replicates).map(|r| final_eroded(r, run)).sum::<f64>() / replicates as f64;
    let summary = (1..=2).map(|run| RunSummary {
        run,
        eroded_mass_fraction: statistic(mean(run), 0.011, replicates),
        eroded_number_fraction: statistic(mean(run) + 0.2, 0.013, replicates),
        largest_eroded_over_d15f: Some(statistic(0.197, 0.0012, replicates)),
        blocked_fraction: statistic(if run == 1 { 0.0292 } else { 0.0318 }, 0.0004, replicates),
        blocked_first_three_layers_fraction: statistic(0.21 + 0.03 * run as f64, 0.004, replicates),
        backbone_fraction: statistic(0.81 - 0.05 * run as f64, 0.006, replicates),
    });
    let thickness =
        [(0.5, 0.301), (1.0, mean(1)), (2.0, 0.052)].into_iter().map(|(factor, first)| OfThickness {
            factor,
            layers: (60.0 * factor) as u64,
            thickness_mm: Some(70.6 * factor),
            n_base: (21_443_871.0 * factor) as u64,
            walked: Classed {
                replicates: 4,
                stopped_when_clear: false,
                verdict: if first < 0.075 { Verdict::None } else { Verdict::Some },
                runs: vec![statistic(first, 0.01, 4), statistic(0.25 * first, 0.005, 4)],
            },
        });
    let verdicts = [Verdict::Continuing, Verdict::Continuing, Verdict::Some, Verdict::Some, Verdict::None];
    let sensitivity =
        [0.25, 0.5, 1.0, 2.0, 4.0].into_iter().zip(verdicts).enumerate().map(|(i, (factor, verdict))| {
            let first = [0.412, 0.297, mean(1), 0.118, 0.061][i];
            let second = [0.187, 0.094, mean(2), 0.021, 0.008][i];
            Sensitivity {
                factor,
                n_base: (21_443_871.0 * factor) as u64,
                grains_per_void: Some(0.61 * factor),
                mass_ratio: Some(0.05 * factor),
                walked: Classed {
                    replicates: 4,
                    stopped_when_clear: false,
                    verdict,
                    runs: vec![statistic(first, 0.012, 4), statistic(second, 0.006, 4)],
                },
            }
        });
    Outcome {
        headline: None,
        model: Model {
            class: Verdict::Some,
            eroded_percent: vec![[10.0, 12.0], [1.0, 3.0]],
            replicates,
            network: NetworkKind::Cubic,
        },
        notes: vec![Note::CohesiveFines { fines_percent: 18.0 }],
        practice: None,
        constrictions: ConstrictionsRecord { origin: CurveOrigin::Given },
        seed: 2016,
        n_base: 21_443_871,
        n_base_eq2: Some(21_443_871),
        capped: false,
        grains_per_void: Some(0.61),
        engine: "particles".into(),
        replicates: all,
        summary: summary.collect(),
        stopping: Some(Stopping {
            target_error_pp: None,
            decide_percent: Some(99.9),
            most: 1000,
            looks: 1,
            met: true,
            verdict: Some(Verdict::Some),
            half_width_pp: Some(1.2),
            short_of: None,
        }),
        threshold: 0.075,
        left_out: vec![LeftOut::PackingByCurve, LeftOut::SecondRun],
        model_leaves_out: ModelLimit::ALL.to_vec(),
        inputs: Inputs {
            filter: FilterRecord {
                name: "Loose filter gravel".into(),
                attribution:
                    "Shire & O'Sullivan (2016), Geotechnique 66(10), 826-839, doi:10.1680/jgeot.15.P.215, \
                              CC BY 4.0"
                        .into(),
                cu: Some(cu_f),
                d0_mm: d0f,
                d15_mm: filter_at(15.0),
                d50_mm: filter_at(50.0),
                d50_by_number_mm: 4.93,
                d85_mm: filter_at(85.0),
                void_ratio: Some(0.658),
                gradation: straight(d0f, cu_f),
                constrictions: dc.iter().map(|(d, p)| [d * d0f, *p]).collect(),
                cu_csd: 1.63,
                curve_name: "shire2016-cu1.5-loose".into(),
            },
            base: BaseRecord {
                name: "Silty core fill".into(),
                cu: Some(cu_b),
                d0_mm: d0b,
                d15_mm: Some(base_at(15.0)),
                d50_mm: Some(base_at(50.0)),
                d85_mm: base_at(85.0),
                d95_mm: base_at(95.0),
                d100_mm: base_at(100.0),
                tail_mass_fraction: 0.0,
                regraded_at_mm: None,
                as_sampled: None,
                gradation: straight(d0b, cu_b),
            },
            network: NetworkRecord {
                kind: NetworkKind::Cubic,
                name: "cubic".into(),
                nx: Some(40),
                ny: Some(40),
                nz: Some(60),
                voids: 96_000,
                constrictions: 288_000,
                start_nodes: 1_600,
                layers: 60,
                connectivity: Vec::new(),
                thickness_mm: Some(60.0 * 4.93),
                copies: None,
            },
            mass_ratio: Some(0.05),
            inject_share: 0.01,
            scale_free: false,
        },
        network: None,
        ratios: Ratios {
            d15f_over_d85b: filter_at(15.0) / base_at(85.0),
            d15f_over_d95b: filter_at(15.0) / base_at(95.0),
        },
        rules: [
            ("Terzaghi", "D15F/D85B", 4.0, "Terzaghi, as in Fannin (2008)"),
            (
                "Foster and Fell, no erosion",
                "D15F/D85B",
                7.0,
                "Foster and Fell (2001), base with less than 15 % fines",
            ),
            ("Foster and Fell, continuing erosion", "D15F/D95B", 9.0, "Foster and Fell (2001)"),
        ]
        .map(|(name, quantity, limit, source)| {
            let value = filter_at(15.0) / base_at(if quantity == "D15F/D85B" { 85.0 } else { 95.0 });
            let (name, source) = (name.into(), source.into());
            let quantity =
                if quantity == "D15F/D85B" { RuleQuantity::D15FOverD85B } else { RuleQuantity::D15FOverD95B };
            AppliedRule {
                value_bound: None,
                without_finer: None,
                id: String::new(),
                name,
                authority: String::new(),
                stated_by: Vec::new(),
                role: RuleRole::Retention,
                applies: true,
                quantity,
                value: Some(value),
                limit: Some(limit),
                unit: RuleUnit::One,
                at_least: false,
                limit_at_most: false,
                met: Some(value <= limit),
                needs: Vec::new(),
                notes: Vec::new(),
                applies_to: "bases in general".into(),
                formula: String::new(),
                source,
                filter_curve: String::new(),
                base_curve: String::new(),
            }
        })
        .into(),
        infiltration: Some(Infiltration {
            layers: 60,
            sizes: vec![
                InfiltrationSize {
                    name: "D50B".into(),
                    diameter_mm: base_at(50.0),
                    downstream: 1.0,
                    layers_95: None,
                    layers_99: None,
                    through: 1.0,
                },
                InfiltrationSize {
                    name: "D85B".into(),
                    diameter_mm: base_at(85.0),
                    downstream: 0.96,
                    layers_95: Some(73.4),
                    layers_99: Some(112.8),
                    through: 0.086,
                },
            ],
            coarsest_through_mm: 0.85,
            eroded_without_blocking: 0.873,
        }),
        curve_range: None,
        if_dispersive: None,
        arching: None,
        sensitivity: sensitivity.collect(),
        thickness: thickness.collect(),
        studies_to_come: false,
        digest: String::new(),
        seconds: 239.4,
    }
}

fn final_eroded(replicate: u64, run: u64) -> f64 {
    let middle = if run == 1 { 0.192 } else { 0.048 };
    middle * (0.92 + 0.16 * scatter(replicate, run, 1))
}

/// What the maker of a folder may choose.
pub struct Plan {
    pub outcome: Outcome,
    pub increments: u64,
    pub scene: String,
}

impl Plan {
    /// Ten replicates, a usual length.
    pub fn usual() -> Plan {
        Plan { outcome: outcome(10), increments: 410, scene: SCENE.into() }
    }

    /// Writes the folder.
    pub fn write(&self, folder: &Path) {
        let put = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
        put("outcome.json", &OUTCOME.json(&self.outcome).unwrap());
        put("manifest.json", &MANIFEST.json(&manifest()).unwrap());
        put("scene.toml", &self.scene);
        put("series.csv", &self.series());
        put("layers.csv", &self.layers());
        let (retained, eroded) = self.curves();
        put("retained.csv", &retained);
        put("eroded.csv", &eroded);
    }

    fn runs(&self) -> impl Iterator<Item = (u64, u64)> {
        let runs = self.outcome.summary.len() as u64;
        (1..=self.outcome.replicates.len() as u64)
            .flat_map(move |replicate| (1..=runs).map(move |run| (replicate, run)))
    }

    fn series(&self) -> String {
        let mut text = "replicate,run,increment,inserted,moving,eroded,retained_in_constrictions,\
                 retained_in_voids,trapped,blocked,eroded_mass_fraction\n"
            .to_owned();
        for (replicate, run) in self.runs() {
            let end =
                self.outcome.replicates[replicate as usize - 1].runs[run as usize - 1].eroded_mass_fraction;
            for increment in 1..=self.increments {
                let t = increment as f64 / self.increments as f64 * 410.0;
                let rise = 1.0 / (1.0 + libm::exp(-(t - 165.0 - 6.0 * scatter(replicate, run, 2)) / 17.0));
                let inserted = (increment * 214_438).min(21_443_871);
                let eroded = (inserted as f64 * 0.33 * rise) as u64;
                let held = (inserted - eroded) / 2;
                let blocked = 8_410.0 * (1.0 - libm::exp(-t / 30.0));
                writeln!(
                    text,
                    "{replicate},{run},{increment},{inserted},{},{eroded},{},{held},0,{blocked:.0},{}",
                    inserted - eroded - 2 * held,
                    held,
                    end * rise,
                )
                .unwrap();
            }
        }
        text
    }

    fn layers(&self) -> String {
        let mut text =
            "replicate,run,layer,constrictions,blocked,retained_in_constrictions,retained_in_voids\n"
                .to_owned();
        for (replicate, run) in self.runs() {
            for layer in 0..self.outcome.inputs.network.layers {
                let share = (0.31 + 0.03 * run as f64) * libm::exp(-(layer as f64) / 6.5) + 0.004;
                let blocked = (4800.0 * share * (0.93 + 0.14 * scatter(replicate, run, 100 + layer))) as u64;
                writeln!(
                    text,
                    "{replicate},{run},{layer},4800,{blocked},{},{}",
                    blocked * 120,
                    blocked * 900
                )
                .unwrap();
            }
        }
        text
    }

    fn curves(&self) -> (String, String) {
        let head = "replicate,run,increment,diameter_mm,percent_finer_by_mass,percent_finer_by_number\n";
        let (mut retained, mut eroded) = (head.to_owned(), head.to_owned());
        let base = &self.outcome.inputs.base;
        for (replicate, run) in self.runs() {
            let marks = [1, 10, 25, 50, 100, 200, self.increments];
            for (step, increment) in marks.into_iter().enumerate() {
                for i in 0..=40 {
                    let share = f64::from(i) / 40.0;
                    let size = base.d0_mm * libm::pow(base.d100_mm / base.d0_mm, share);
                    let skew = [6.0, 4.0, 2.8, 2.1, 1.7, 1.35, 1.2][step];
                    let (mass, number) =
                        (100.0 * libm::pow(share, skew), 100.0 * libm::pow(share, skew / 2.0));
                    writeln!(retained, "{replicate},{run},{increment},{size},{mass},{number}").unwrap();
                    let share = (size / 0.886).min(1.0);
                    let at = libm::log(share.max(base.d0_mm / 0.886) * 0.886 / base.d0_mm)
                        / libm::log(0.886 / base.d0_mm);
                    writeln!(
                        eroded,
                        "{replicate},{run},{increment},{size},{},{}",
                        100.0 * at,
                        100.0 * at.sqrt()
                    )
                    .unwrap();
                }
            }
        }
        (retained, eroded)
    }
}

fn manifest() -> Manifest {
    Manifest {
        version: "0.1.0".into(),
        commit: Some("4f2c43f".into()),
        seed: 2016,
        inputs: vec![InputFile {
            name: "core-fill.csv".into(),
            xxh3: "9f86d081884c7d659a2feaa0c55ad015".into(),
        }],
        threads: 2,
        host: "workstation".into(),
        machine: "Linux x86_64, 2 processors, 8 GB".into(),
        started: "2026-11-21T09:12:04Z".into(),
        finished: "2026-11-21T09:16:03Z".into(),
        command: "voidwalk run scene.toml --threads 2".into(),
    }
}

const SCENE: &str = "seed = 2016\nreplicates = 10\n\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\ncu = \
                     1.5\nd0_mm = 4.0\n\n[base]\nsieve = \"core-fill.csv\"\nmass_ratio = \
                     0.05\n\n[network]\nnx = 40\nny = 40\nnz = 60\n";
