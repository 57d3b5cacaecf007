//! Many samples and how coarse a filter may be for each: by practice, and by the walk where there was one.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::batch::NAMED;
use super::rule_words::cited_rule;
use crate::gradation::SoilSample;
use crate::outcome::design::band::SetBy;
use crate::outcome::design::{Design, Specification};
use crate::outcome::numbers::SizeUnit;
use crate::outcome::record::{FindingRecord, IfDispersive, InputFile, ModelLimit, SheetCover, commit};
use crate::outcome::table::{Columns, TableCell};

/// Columns of the table that a terminal and a page show; all are in the file.
const SHOWN: [&str; 10] = [
    "sample",
    "group",
    "d85b_mm",
    "limit_mm",
    "rule",
    "d15f_min_mm",
    "no_erosion_d15f_mm",
    "d15f_max_mm",
    "set_by",
    "governs",
];

/// The whole of `designs.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DesignedSamples {
    /// Version of the program.
    pub version: String,
    /// The commit that it was built from; `None` where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Hash of everything that the rows follow from: samples, shape of the filter and settings.
    pub work: String,
    /// The samples, as they were named.
    pub samples: String,
    /// The shape of the filter that was walked; empty where nothing was.
    pub filter: String,
    /// Whether the samples were said to be dispersive.
    pub dispersive: bool,
    /// Whether inches stand beside mm on page and terminal.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inches: bool,
    /// What the sheet says of itself.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub cover: SheetCover,
    /// What was walked for every sample; `None` where nothing was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub walks: Option<DesignedWalks>,
    /// Every file that was read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputFile>,
    /// A row for each sample.
    pub rows: Vec<DesignedSample>,
    /// What was assumed of the files, a sentence each.
    pub notes: Vec<String>,
    /// What no walk contains; empty where nothing was walked.
    pub model_leaves_out: Vec<ModelLimit>,
}

/// What was walked for every sample alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DesignedWalks {
    /// The filter's shape and its constrictions, in words.
    pub filter: String,
    /// Size (mm) and percent finer by mass of the filter as it was given; empty where its sizes are not
    /// given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub filter_gradation: Vec<[f64; 2]>,
    /// How densely the filter is packed, in the order in which it was asked for.
    pub densities: Vec<String>,
    /// The thicknesses that were asked for, in words.
    pub thicknesses: Vec<String>,
    /// Networks of each boundary.
    pub networks: u64,
    /// The user's seed.
    pub seed: u64,
    /// Settings that were given, as on the command line.
    pub settings: Vec<String>,
}

impl DesignedWalks {
    /// Of the design of one of the samples, with the settings that all have.
    pub fn of(design: &Design, settings: &[String]) -> Self {
        let asked = || design.boundaries.iter().filter(|row| row.end_of.is_none());
        let mut densities: Vec<String> = asked().map(|row| row.density.clone()).collect();
        let mut thicknesses: Vec<String> = Vec::new();
        densities.dedup();
        for row in asked() {
            if !thicknesses.contains(&row.thickness) {
                thicknesses.push(row.thickness.clone());
            }
        }
        let (filter, networks, seed) = (design.filter.clone(), design.replicates, design.seed);
        let filter_gradation = design.filter_gradation.clone();
        let settings = settings.to_vec();
        Self { filter, filter_gradation, densities, thicknesses, networks, seed, settings }
    }
}

/// How coarse a filter may be for one sample. Sizes are in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DesignedSample {
    /// The sample.
    pub sample: String,
    /// What names the sample on a command line.
    pub path: PathBuf,
    /// Size (mm) and percent finer by mass, as sampled.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradation: Vec<[f64; 2]>,
    /// The same after regrading; empty where the rules do not regrade it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regraded: Vec<[f64; 2]>,
    /// Group by ASTM D2487; `None` where the sieves do not tell.
    pub group: Option<String>,
    /// Category of NRCS, 1 to 4; `None` where the fines are not known closely enough.
    pub category: Option<u8>,
    /// Percent finer than 0.075 mm after regrading.
    pub fines_percent: Option<f64>,
    /// The size on which the sample was regraded.
    pub regraded_at_mm: Option<f64>,
    /// 85 % finer, after regrading.
    pub d85b_mm: Option<f64>,
    /// The strictest limit of D15F by which practice retains the sample; `None` where it is not known.
    pub limit_mm: Option<f64>,
    /// Whose limit it is.
    pub rule: String,
    /// The minimum D15F that drains the sample.
    pub d15f_min_mm: Option<f64>,
    /// Whether the true least is not known, and is at most that.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub d15f_min_at_most: bool,
    /// What practice allows if the sample is dispersive; `None` where somebody has said whether it is, and
    /// where it has few fines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// Maximum D15F that both practice and walk allow; `None` where none is known.
    pub d15f_max_mm: Option<f64>,
    /// What a reader must know of the sample itself, as for a filter of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<FindingRecord>,
    /// Why the sample has no band of its own, though both limits may be known; empty where it has one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub no_band: String,
    /// 1 for the sample that governs, 2 and 3 for those next to it: by `d15f_max_mm`, and where that is not
    /// known by `limit_mm`.
    pub governs: Option<u64>,
    /// What its design says; `None` where it was not walked.
    pub design: Option<SampleDesign>,
    /// Why it was not walked, though the others were; empty otherwise.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub not_walked: String,
}

/// What the design of one sample says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SampleDesign {
    /// Folder of its results, inside that of all.
    pub folder: String,
    /// D15F (mm) up to which the walk shows no erosion on nearly all networks; `None` where none is known.
    pub no_erosion_d15f_mm: Option<f64>,
    /// The same over D85B as it was walked.
    pub no_erosion_d15f_over_d85b: Option<f64>,
    /// What set the answer.
    pub set_by: SetBy,
    /// Whose rule set it; empty where the walk did.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub rule: String,
    /// That the filter as given is too coarse without the finer part that it may lose, as a design has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub washout: Option<String>,
    /// The answer in a sentence without its full stop.
    pub said: String,
}

impl DesignedSample {
    /// What practice says of a sample; nothing is walked yet.
    pub fn of(sample: &SoilSample, practice: &Specification) -> Self {
        let curve = &practice.curves[0];
        Self {
            sample: sample.name.clone(),
            path: sample.path.clone(),
            gradation: curve.gradation.clone(),
            regraded: curve.regraded.clone(),
            group: sample.curve.group(),
            category: curve.category,
            fines_percent: curve.fines_percent,
            regraded_at_mm: curve.regraded_at_mm,
            d85b_mm: curve.d85_mm,
            limit_mm: practice.d15f_max_mm,
            rule: curve.d15f_max_rule.clone(),
            d15f_min_mm: practice.d15f_min_mm,
            d15f_min_at_most: practice.d15f_min_at_most,
            if_dispersive: practice.if_dispersive,
            d15f_max_mm: practice.d15f_max_mm,
            findings: practice.findings.iter().map(|of| of.finding.clone()).collect(),
            no_band: practice.no_band.clone().unwrap_or_default(),
            governs: None,
            design: None,
            not_walked: String::new(),
        }
    }

    /// The same with its design, whose results are in this folder.
    pub fn designed(self, design: &Design, folder: String) -> Self {
        let (answer, held) = (design.answer(), design.least_held());
        let ratio = held.map(|(_, ratio)| ratio);
        let rule = design.rules.iter().find(|rule| answer.rule.as_ref() == Some(&rule.id));
        // What walk and practice leave together may be no band where practice alone has one.
        let no_band = match &design.specification {
            Some(of) => of.no_band.clone().unwrap_or_default(),
            None => self.no_band.clone(),
        };
        let of = SampleDesign {
            folder,
            no_erosion_d15f_mm: ratio.zip(design.base.d85_mm).map(|(ratio, d85)| ratio * d85),
            no_erosion_d15f_over_d85b: ratio,
            set_by: answer.set_by,
            rule: rule.map_or_else(String::new, cited_rule),
            washout: answer.washout,
            said: answer.said,
        };
        Self { d15f_max_mm: answer.d15f_max_mm, no_band, design: Some(of), ..self }
    }

    /// The D15F (mm) that no filter for this sample may exceed, as far as is known.
    pub fn bound(&self) -> Option<f64> {
        self.d15f_max_mm.into_iter().chain(self.limit_mm).min_by(f64::total_cmp)
    }

    /// Whether its maximum D15F is known, by the walk where others were walked, and it has a band.
    pub fn is_settled(&self) -> bool {
        self.d15f_max_mm.is_some() && self.not_walked.is_empty() && self.no_band.is_empty()
    }

    /// What set the maximum D15F; `None` without one.
    pub fn set_by(&self) -> Option<&'static str> {
        self.d15f_max_mm?;
        Some(match &self.design {
            Some(of) if of.set_by == SetBy::Walk => "the walk",
            Some(of) if of.no_erosion_d15f_mm.is_none() => "practice alone, the walk has no answer",
            _ => "practice",
        })
    }

    /// The rule that set the maximum D15F, or that limits it.
    pub(super) fn rule_of_answer(&self) -> &str {
        let of_design = self.design.as_ref().map(|of| of.rule.as_str()).filter(|rule| !rule.is_empty());
        of_design.unwrap_or(&self.rule)
    }

    /// The columns of `designs.csv`, and under their headings what a terminal and a page show, sizes in this
    /// unit.
    pub fn columns<'a>(unit: SizeUnit) -> Columns<'a, Self> {
        let design = |row: &Self| row.design.clone();
        let why_not = |row: &Self| Some(row.not_walked.clone()).filter(|why| !why.is_empty());
        let drains = move |row: &Self| {
            let at_most = if row.d15f_min_at_most { " at most" } else { "" };
            row.d15f_min_mm.map(|least| format!("{}{at_most}", unit.least(least)))
        };
        Columns::default()
            .column("sample", |row: &Self| row.sample.clone())
            .headed("Sample")
            .column("group", |row: &Self| row.group.clone())
            .headed("Group")
            .column("category", |row: &Self| row.category.map(u64::from))
            .digits("fines_percent", 1, |row| row.fines_percent)
            .digits("regraded_at_mm", 4, |row| row.regraded_at_mm)
            .digits("d85b_mm", 4, |row| row.d85b_mm)
            .number("D85B, regraded, mm", move |row| row.d85b_mm.map(|mm| unit.short(mm)))
            .digits("limit_mm", 4, |row| row.limit_mm)
            .number("Limit of practice, mm", move |row| row.limit_mm.map(|mm| unit.greatest(mm)))
            .column("rule", |row: &Self| row.rule.clone())
            .headed("Whose limit")
            .digits("d15f_min_mm", 4, |row| row.d15f_min_mm)
            .number("Drains from, mm", drains)
            .column("d15f_min_at_most", |row: &Self| row.d15f_min_at_most.to_string())
            .digits("no_erosion_d15f_mm", 4, move |row| design(row)?.no_erosion_d15f_mm)
            .number("No erosion by walk up to, mm", move |row| {
                let mm = design(row).and_then(|of| of.no_erosion_d15f_mm).map(|mm| unit.greatest(mm));
                mm.unwrap_or_default().shown().below(why_not(row))
            })
            .digits("no_erosion_d15f_over_d85b", 3, move |row| design(row)?.no_erosion_d15f_over_d85b)
            .digits("d15f_max_mm", 4, |row| row.d15f_max_mm)
            .number("D15F up to, mm", move |row| {
                let is_unserved = row.d15f_max_mm.is_some() && !row.no_band.is_empty();
                let greatest = row.d15f_max_mm.map(|mm| unit.greatest(mm));
                greatest.shown().below(is_unserved.then(|| "no band".to_owned()))
            })
            .column("set_by", |row: &Self| row.set_by().map(str::to_owned))
            .headed("Set by")
            .column("governs", |row: &Self| row.governs)
            .headed("Governs")
            .column("not_walked", |row: &Self| row.not_walked.clone())
            .column("no_band", |row: &Self| row.no_band.clone())
            .column("said", move |row| design(row).map(|of| of.said))
            .column("folder", move |row| design(row).map(|of| of.folder))
            .only(&SHOWN)
    }
}

impl DesignedSamples {
    /// Of these rows, with those that govern: the minimum D15F first that is known to be too coarse beyond,
    /// and of equal ones the finer base.
    pub fn new(samples: String, mut rows: Vec<DesignedSample>) -> Self {
        let mut order: Vec<usize> = (0..rows.len()).filter(|&at| rows[at].bound().is_some()).collect();
        let key = |row: &DesignedSample| [row.bound(), row.d85b_mm].map(|mm| mm.unwrap_or(f64::INFINITY));
        let less = |a: [f64; 2], b: [f64; 2]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
        order.sort_by(|&a, &b| less(key(&rows[a]), key(&rows[b])));
        for (rank, &at) in (1..).zip(order.iter().take(NAMED)) {
            rows[at].governs = Some(rank);
        }
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            work: String::new(),
            samples,
            filter: String::new(),
            dispersive: false,
            inches: false,
            cover: SheetCover::default(),
            walks: None,
            inputs: Vec::new(),
            rows,
            notes: Vec::new(),
            model_leaves_out: Vec::new(),
        }
    }

    /// The samples that govern, the strictest first.
    pub fn governing(&self) -> Vec<&DesignedSample> {
        let mut rows: Vec<&DesignedSample> = self.rows.iter().filter(|row| row.governs.is_some()).collect();
        rows.sort_by_key(|row| row.governs);
        rows
    }
}
