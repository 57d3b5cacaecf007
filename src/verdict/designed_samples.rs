//! Many samples and how coarse a filter may be for each: by practice, and by the walk where there was one.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::batch::NAMED;
use crate::gradation::SoilSample;
use crate::outcome::design::band::SetBy;
use crate::outcome::design::{Design, Specification};
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::record::{Confidence, ModelLimit};
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
    /// Hash of everything that the rows follow from: samples, shape of the filter and settings.
    pub work: String,
    /// The samples, as they were named.
    pub samples: String,
    /// The shape of the filter that was walked; empty where nothing was.
    pub filter: String,
    /// Whether the samples were said to be dispersive.
    pub dispersive: bool,
    /// A row for each sample.
    pub rows: Vec<DesignedSample>,
    /// What was assumed of the files, a sentence each.
    pub notes: Vec<String>,
    /// What no walk contains; empty where nothing was walked.
    pub model_leaves_out: Vec<ModelLimit>,
}

/// How coarse a filter may be for one sample. Sizes are in mm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DesignedSample {
    /// The sample.
    pub sample: String,
    /// What names the sample on a command line.
    pub path: PathBuf,
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
    /// The least D15F that drains the sample.
    pub d15f_min_mm: Option<f64>,
    /// Whether the true least is not known, and is at most that.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub d15f_min_at_most: bool,
    /// Greatest D15F that both practice and walk allow; `None` where none is known.
    pub d15f_max_mm: Option<f64>,
    /// 1 for the sample that governs, which has the least of these, 2 and 3 for those next to it.
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
    /// How far the answer can be relied on.
    pub confidence: Confidence,
    /// The weightiest reason why no further.
    pub reason: Option<String>,
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
            group: sample.curve.group(),
            category: curve.category,
            fines_percent: curve.fines_percent,
            regraded_at_mm: curve.regraded_at_mm,
            d85b_mm: curve.d85_mm,
            limit_mm: practice.d15f_max_mm,
            rule: curve.d15f_max_rule.clone(),
            d15f_min_mm: practice.d15f_min_mm,
            d15f_min_at_most: practice.d15f_min_at_most,
            d15f_max_mm: practice.d15f_max_mm,
            governs: None,
            design: None,
            not_walked: String::new(),
        }
    }

    /// The same with its design, whose results are in this folder.
    pub fn designed(self, design: &Design, folder: String) -> Self {
        let (answer, held) = (design.answer(), design.least_held());
        let ratio = held.map(|(_, ratio)| ratio);
        let of = SampleDesign {
            folder,
            no_erosion_d15f_mm: ratio.zip(design.base.d85_mm).map(|(ratio, d85)| ratio * d85),
            no_erosion_d15f_over_d85b: ratio,
            set_by: answer.set_by,
            confidence: design.confidence,
            reason: design.reasons.first().cloned(),
            said: answer.said,
        };
        Self { d15f_max_mm: answer.d15f_max_mm, design: Some(of), ..self }
    }

    /// What set the greatest D15F; `None` without one.
    pub fn set_by(&self) -> Option<&'static str> {
        self.d15f_max_mm?;
        Some(match self.design.as_ref().map(|of| of.set_by) {
            Some(SetBy::Walk) => "the walk",
            Some(SetBy::Practice) | None => "practice",
        })
    }

    /// The greatest D15F, and what set it, in words.
    fn greatest_in_words(&self) -> String {
        let Some(greatest) = self.d15f_max_mm else { return "no greatest D15F is known".into() };
        let whose = match self.set_by() {
            Some("practice") => format!("practice: {}", self.rule),
            _ => "the walk".into(),
        };
        format!("D15F up to {} mm ({whose})", rounded_down(greatest))
    }

    /// The columns of `designs.csv`, and under their headings what a terminal and a page show.
    pub fn columns<'a>() -> Columns<'a, Self> {
        let design = |row: &Self| row.design.clone();
        let why_not = |row: &Self| Some(row.not_walked.clone()).filter(|why| !why.is_empty());
        let drains = |row: &Self| {
            let at_most = if row.d15f_min_at_most { " at most" } else { "" };
            row.d15f_min_mm.map(|least| format!("{}{at_most}", rounded_up(least)))
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
            .headed("D85B, regraded, mm")
            .digits("limit_mm", 4, |row| row.limit_mm)
            .number("Limit of practice, mm", |row| row.limit_mm.map(rounded_down))
            .column("rule", |row: &Self| row.rule.clone())
            .headed("Whose limit")
            .digits("d15f_min_mm", 4, |row| row.d15f_min_mm)
            .number("Drains from, mm", drains)
            .column("d15f_min_at_most", |row: &Self| row.d15f_min_at_most.to_string())
            .digits("no_erosion_d15f_mm", 4, move |row| design(row)?.no_erosion_d15f_mm)
            .number("No erosion by walk up to, mm", move |row| {
                let mm = design(row).and_then(|of| of.no_erosion_d15f_mm).map(rounded_down);
                mm.unwrap_or_default().shown().below(why_not(row))
            })
            .digits("no_erosion_d15f_over_d85b", 3, move |row| design(row)?.no_erosion_d15f_over_d85b)
            .digits("d15f_max_mm", 4, |row| row.d15f_max_mm)
            .number("D15F up to, mm", |row| row.d15f_max_mm.map(rounded_down))
            .column("set_by", |row: &Self| row.set_by().map(str::to_owned))
            .headed("Set by")
            .column("governs", |row: &Self| row.governs)
            .headed("Governs")
            .column("confidence", move |row| design(row).map(|of| of.confidence.words().to_owned()))
            .column("reason", move |row| design(row)?.reason)
            .column("not_walked", |row: &Self| row.not_walked.clone())
            .column("folder", move |row| design(row).map(|of| of.folder))
            .only(&SHOWN)
    }
}

impl DesignedSamples {
    /// Of these rows, with those that govern: the least D15F first, and of equal ones the finer base.
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
            work: String::new(),
            samples,
            filter: String::new(),
            dispersive: false,
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

    /// The sample that asks for the greatest D15F to drain; `None` where none asks for any.
    fn drainage(&self) -> Option<(&DesignedSample, f64)> {
        let limits = self.rows.iter().filter_map(|row| Some((row, row.d15f_min_mm?)));
        limits.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The D15F of a filter for all samples, in a sentence without its end.
    pub fn for_all_in_words(&self) -> String {
        let open = self.rows.iter().filter(|row| row.d15f_max_mm.is_none() || !row.not_walked.is_empty());
        let open = open.count();
        let Some(first) = self.governing().first().copied() else {
            return "For no sample a greatest D15F is known".into();
        };
        let of = match open {
            0 => format!("all {} samples", self.rows.len()),
            1 => format!("the {} samples that are settled (1 is not)", self.rows.len() - 1),
            _ => format!("the {} samples that are settled ({open} are not)", self.rows.len() - open),
        };
        let greatest = first.d15f_max_mm.unwrap_or_default();
        match self.drainage() {
            Some((row, least)) if least > greatest => {
                let fines = if row.d15f_min_at_most { ", or less, as its fines are not known," } else { "" };
                let [least, greatest] = [rounded_up(least), rounded_down(greatest)];
                let and =
                    if row.path == first.path { " and".into() } else { format!(", and {}", first.sample) };
                format!(
                    "No one filter serves {of}: {} needs D15F {least} mm or more{fines} to drain{and} allows \
                     {greatest} mm at most",
                    row.sample
                )
            }
            Some((_, least)) => {
                format!("A filter for {of}: D15F from {} to {} mm", rounded_up(least), rounded_down(greatest))
            }
            None => format!("A filter for {of}: D15F up to {} mm", rounded_down(greatest)),
        }
    }

    /// Which samples govern, what sets their limits and which are open, sentences without their ends.
    pub fn in_words(&self) -> Vec<String> {
        let mut said = vec![self.for_all_in_words()];
        for (at, row) in self.governing().into_iter().enumerate() {
            let what = if at == 0 { "Governing sample" } else { "Then" };
            said.push(format!("{what} {}: {}", row.sample, row.greatest_in_words()));
        }
        if let Some((row, least)) = self.drainage() {
            let at_most = if row.d15f_min_at_most { "at most " } else { "" };
            let limit = rounded_up(least);
            said.push(format!("Drainage is governed by {}: least D15F {at_most}{limit} mm", row.sample));
        }
        let count = |what: &str| self.rows.iter().filter(|row| row.set_by() == Some(what)).count();
        let [practice, walk] = ["practice", "the walk"].map(count);
        if self.rows.iter().any(|row| row.design.is_some()) {
            said.push(format!("Practice sets the greatest D15F of {practice}, the walk that of {walk}"));
        }
        let names = |of: &dyn Fn(&DesignedSample) -> bool| {
            let names: Vec<&str> =
                self.rows.iter().filter(|row| of(row)).map(|row| row.sample.as_str()).collect();
            (!names.is_empty()).then(|| names.join(", "))
        };
        let open = names(&|row| row.d15f_max_mm.is_none());
        said.extend(open.map(|names| format!("May govern, as no greatest D15F is known: {names}")));
        let by_practice = names(&|row| row.d15f_max_mm.is_some() && !row.not_walked.is_empty());
        said.extend(by_practice.map(|names| format!("Not walked, by practice alone: {names}")));
        said
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::verdict::SpecificationOptions;

    fn row(name: &str, points: &[(f64, f64)]) -> DesignedSample {
        let curve = Gradation::from_points(points, None).unwrap();
        let sample = SoilSample { name: name.into(), path: name.into(), curve: curve.clone() };
        let of = Specification::of(name, &[(name.into(), curve)], SpecificationOptions::default());
        DesignedSample::of(&sample, &of)
    }

    fn walked(row: DesignedSample, greatest: Option<f64>) -> DesignedSample {
        let design = SampleDesign {
            folder: "samples/x".into(),
            no_erosion_d15f_mm: greatest,
            no_erosion_d15f_over_d85b: None,
            set_by: SetBy::Walk,
            confidence: Confidence::Outside,
            reason: None,
            said: String::new(),
        };
        DesignedSample { d15f_max_mm: greatest, design: Some(design), ..row }
    }

    #[test]
    fn the_least_d15f_governs_and_a_sample_without_one_may() {
        // 60 % fines: 0.7 mm. A clean sand: 4 D85B.
        let core = row("core", &[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]);
        let sand = row("sand", &[(0.1, 0.0), (0.5, 100.0)]);
        assert_eq!(
            (core.limit_mm, core.d15f_max_mm, core.set_by()),
            (Some(0.7), Some(0.7), Some("practice"))
        );
        let limit = sand.limit_mm.unwrap();
        assert!((limit - 4.0 * sand.d85b_mm.unwrap()).abs() < 1e-9, "{sand:?}");
        let by_practice = DesignedSamples::new("s".into(), vec![sand.clone(), core.clone()]);
        let said = by_practice.in_words();
        assert_eq!(said[1], format!("Governing sample core: D15F up to 0.700 mm (practice: {})", core.rule));
        assert!(
            said[0].starts_with("A filter for all 2 samples: D15F from ") && said[0].ends_with("0.700 mm")
        );
        // The walk allows less of one, and nothing is known of another.
        let rows = vec![
            walked(sand.clone(), Some(0.65)),
            core,
            walked(row("silt", &[(0.005, 0.0), (0.075, 90.0), (0.2, 100.0)]), None),
        ];
        let all = DesignedSamples::new("s".into(), rows);
        assert_eq!(all.rows.iter().map(|row| row.governs).collect::<Vec<_>>(), [Some(1), Some(2), None]);
        let said = all.in_words().join("\n");
        for words in [
            "the 2 samples that are settled (1 is not): D15F from ",
            "Governing sample sand: D15F up to 0.650 mm (the walk)",
            "Practice sets the greatest D15F of 1, the walk that of 1",
            "May govern, as no greatest D15F is known: silt",
        ] {
            assert!(said.contains(words), "{words}: {said}");
        }
        let csv = String::from_utf8(DesignedSample::columns().csv(&all.rows)).unwrap();
        assert!(csv.starts_with("sample,group,category,fines_percent,regraded_at_mm,d85b_mm,limit_mm,rule,"));
        assert_eq!(csv.lines().count(), 4);
    }

    #[test]
    fn samples_that_no_one_filter_serves_are_said() {
        let fine = row("fine", &[(0.01, 0.0), (0.05, 100.0)]);
        let coarse = row("coarse", &[(0.5, 0.0), (4.0, 100.0)]);
        let all = DesignedSamples::new("s".into(), vec![fine, coarse]);
        let said = all.for_all_in_words();
        assert!(said.starts_with("No one filter serves all 2 samples: coarse needs D15F "), "{said}");
        let none = DesignedSamples::new("s".into(), Vec::new());
        assert_eq!(none.for_all_in_words(), "For no sample a greatest D15F is known");
    }
}
