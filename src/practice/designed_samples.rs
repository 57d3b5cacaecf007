//! Many samples, and the coarsest filter that practice allows for each.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::batch::NAMED;
use crate::design::Specification;
use crate::design::specification::{NoBand, SizeBand};
use crate::{IfDispersive, InputFile, Note, SheetCover};
use voidwalk_sheets::SoilSample;

/// The whole of `designs.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct DesignedSamples {
    /// Version of the program.
    pub version: String,
    /// The commit that it was built from; `None` where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The samples, as they were named.
    pub samples: String,
    /// Whether the samples were said to be dispersive.
    pub dispersive: bool,
    /// Whether inches stand beside mm on page and terminal.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inches: bool,
    /// What the sheet says of itself.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub cover: SheetCover,
    /// Every file that was read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputFile>,
    /// A row for each sample.
    pub rows: Vec<DesignedSample>,
    /// What was assumed of the files, a sentence each.
    pub notes: Vec<String>,
}

/// How coarse a filter may be for one sample. Sizes are in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
    /// Maximum D15F by which practice retains the sample; `None` where it is not known.
    pub d15f_max_mm: Option<f64>,
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
    /// D15F of both sides of the band of its specification; `None` without a band.
    pub band_d15f_mm: Option<[f64; 2]>,
    /// What a reader must know of the sample itself, as for a filter of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
    /// Why the sample has no band of its own, though both limits may be known; `None` where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_band: Option<NoBand>,
    /// 1 for the sample that governs, 2 and 3 for those next to it: by `d15f_max_mm`.
    pub governs: Option<u64>,
}

impl DesignedSample {
    /// Answer of practice for a sample.
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
            d15f_max_mm: practice.d15f_max_mm,
            rule: curve.d15f_max_rule.clone(),
            d15f_min_mm: practice.d15f_min_mm,
            d15f_min_at_most: practice.d15f_min_at_most,
            if_dispersive: practice.if_dispersive,
            band_d15f_mm: practice.band.as_ref().map(SizeBand::d15_mm),
            notes: practice.notes.iter().map(|row| row.note.clone()).collect(),
            no_band: practice.no_band.clone(),
            governs: None,
        }
    }

    /// True if practice has a maximum D15F and a band for the sample.
    pub fn is_settled(&self) -> bool {
        self.d15f_max_mm.is_some() && self.no_band.is_none()
    }
}

impl DesignedSamples {
    /// Table of these rows, with the samples that govern: the least maximum D15F first, and among equal ones
    /// the finer base.
    pub fn new(samples: String, mut rows: Vec<DesignedSample>) -> Self {
        let mut order: Vec<usize> = (0..rows.len()).filter(|&at| rows[at].d15f_max_mm.is_some()).collect();
        let key = |row: &DesignedSample| [row.d15f_max_mm, row.d85b_mm].map(|mm| mm.unwrap_or(f64::INFINITY));
        let less = |a: [f64; 2], b: [f64; 2]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
        order.sort_by(|&a, &b| less(key(&rows[a]), key(&rows[b])));
        for (rank, &at) in (1..).zip(order.iter().take(NAMED)) {
            rows[at].governs = Some(rank);
        }
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: None,
            samples,
            dispersive: false,
            inches: false,
            cover: SheetCover::default(),
            inputs: Vec::new(),
            rows,
            notes: Vec::new(),
        }
    }

    /// Samples that govern, the strictest first.
    pub fn governing(&self) -> Vec<&DesignedSample> {
        let mut rows: Vec<&DesignedSample> = self.rows.iter().filter(|row| row.governs.is_some()).collect();
        rows.sort_by_key(|row| row.governs);
        rows
    }
}
