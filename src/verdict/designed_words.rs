//! How coarse a filter for many samples may be, in sentences.

use super::designed_samples::{DesignedSample, DesignedSamples};
use super::specification::{least_of_band, no_band_between};
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::record::IfDispersive;
use crate::outcome::rules::WIDEST_BAND;

/// What a specification warns of a base, and how it begins where it is said of several.
const CAUTIONS: [(&str, &str); 5] = [
    ("unstable_base", "Not internally stable by Kenney and Lau"),
    ("unstable_side", "With a side of its own band that is not internally stable"),
    ("broad_base", "Broadly graded, so that the finer part may move between the coarse grains"),
    ("gap_of_base", "Gap-graded by this program's own check"),
    ("flat_base", "A curve that is flat somewhere, to be looked at for a gap"),
];

/// So many samples.
fn counted(samples: usize) -> String {
    format!("{samples} sample{}", if samples == 1 { "" } else { "s" })
}

/// The sample with the greatest minimum D15F to drain, and that D15F (mm); `None` where none has any.
fn drainage<'a>(rows: impl IntoIterator<Item = &'a DesignedSample>) -> Option<(&'a DesignedSample, f64)> {
    let limits = rows.into_iter().filter_map(|row| Some((row, row.d15f_min_mm?)));
    limits.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The sample with the least bound of D15F, and that bound (mm); `None` where none has any.
fn strictest<'a>(rows: impl IntoIterator<Item = &'a DesignedSample>) -> Option<(&'a DesignedSample, f64)> {
    let limits = rows.into_iter().filter_map(|row| Some((row, row.bound()?)));
    limits.min_by(|a, b| a.1.total_cmp(&b.1))
}

impl DesignedSample {
    /// The maximum D15F, and what set it, in words.
    fn greatest_in_words(&self) -> String {
        let rule = self.rule_of_answer();
        match (self.d15f_max_mm, self.limit_mm, self.set_by()) {
            (None, None, _) => "no maximum D15F is known".into(),
            (None, Some(limit), _) => format!(
                "no maximum D15F is known; practice allows {} mm at most ({})",
                rounded_down(limit),
                self.rule
            ),
            (Some(mm), _, Some("the walk")) => format!("D15F up to {} mm (the walk)", rounded_down(mm)),
            (Some(mm), _, by) => {
                format!("D15F up to {} mm ({}: {rule})", rounded_down(mm), by.unwrap_or("practice"))
            }
        }
    }

    /// Why its maximum D15F is not known.
    fn open_in_words(&self) -> String {
        let why = self.design.as_ref().map_or(&self.no_band, |of| &of.said);
        let why = if why.is_empty() { &self.not_walked } else { why };
        let limit = match self.limit_mm {
            Some(limit) => format!("limit of practice {} mm", rounded_down(limit)),
            None => "limit of practice not known".into(),
        };
        format!("May govern, as no maximum D15F is known: {} ({limit}): {}", self.sample, within_line(why))
    }
}

/// Sentences without the last full stop.
fn within_line(said: &str) -> &str {
    said.trim_end_matches('.')
}

impl DesignedSamples {
    /// The D15F of a filter for all samples, in a sentence without its end.
    ///
    /// Both ends are of the samples that are settled, and the greatest is never above what any other allows.
    pub fn for_all_in_words(&self) -> String {
        let (settled, others): (Vec<_>, Vec<_>) = self.rows.iter().partition(|row| row.is_settled());
        let cap = strictest(others.iter().copied());
        let Some((first, own)) = strictest(settled.iter().copied()) else {
            return match cap {
                Some((row, mm)) => format!(
                    "No filter is known that serves {}: none is settled, and {} allows D15F up to {} mm at \
                     most",
                    if others.len() == 1 {
                        "the sample".into()
                    } else {
                        format!("all {}", counted(others.len()))
                    },
                    row.sample,
                    rounded_down(mm)
                ),
                None => "No maximum D15F is known for any sample".into(),
            };
        };
        let cap = cap.filter(|(_, mm)| *mm < own);
        let (first, greatest) = cap.unwrap_or((first, own));
        let of = match (settled.len(), others.len()) {
            (1, 0) => "the sample".to_owned(),
            (all, 0) => format!("all {}", counted(all)),
            (some, open) => {
                let [are, not] = [some, open].map(|n| if n == 1 { "is" } else { "are" });
                format!("the {} that {are} settled ({open} {not} not)", counted(some))
            }
        };
        let within = cap.map_or_else(String::new, |(row, _)| format!(" within the limit of {}", row.sample));
        let mm = rounded_down(greatest);
        let Some((row, least)) = drainage(settled.iter().copied()) else {
            return format!("A filter for {of}{within}: D15F up to {mm} mm; no minimum D15F is known");
        };
        let (at_most, from) = (row.d15f_min_at_most, rounded_up(least));
        let and = if row.path == first.path { " and".into() } else { format!(", and {}", first.sample) };
        match no_band_between((least, at_most), greatest) {
            Some(_) if least > greatest && at_most => format!(
                "It is not known whether one filter serves {of}{within}: {} drains from D15F {from} mm or \
                 less, as its fines are not known{and} allows {mm} mm at most",
                row.sample
            ),
            Some(_) if least > greatest => format!(
                "No one filter serves {of}{within}: {} needs D15F {from} mm or more to drain{and} allows \
                 {mm} mm at most",
                row.sample
            ),
            Some(why) => format!(
                "No one filter is specified for {of}{within}, with D15F from {from} to {mm} mm: {}",
                within_line(&why)
            ),
            None => {
                let begins = rounded_up(least_of_band(least, greatest));
                let at_most = if at_most { "not known, and at most " } else { "" };
                let raised = match begins == from {
                    true => String::new(),
                    false => format!(
                        " (the minimum that drains is {at_most}{from} mm; it is raised so that the band is \
                         no wider than {WIDEST_BAND} to 1)"
                    ),
                };
                format!("A filter for {of}{within}: D15F from {begins} to {mm} mm{raised}")
            }
        }
    }

    /// Which samples govern, what sets their limits, how far they can be relied on and which are open:
    /// sentences without their ends; `again` is what to do where a sample is dispersive, as
    /// [`DESIGN_EACH_AGAIN`](super::DESIGN_EACH_AGAIN).
    pub fn in_words(&self, again: &str) -> Vec<String> {
        let mut said = vec![self.for_all_in_words()];
        for (at, row) in self.governing().into_iter().enumerate() {
            let what = if at == 0 { "Governing sample" } else { "Then" };
            said.push(format!("{what} {}: {}", row.sample, row.greatest_in_words()));
        }
        if let Some((row, least)) = drainage(&self.rows) {
            let at_most = if row.d15f_min_at_most { "at most " } else { "" };
            let open = if row.is_settled() { "" } else { " (this sample is not settled)" };
            let limit = rounded_up(least);
            said.push(format!(
                "Drainage is governed by {}: minimum D15F {at_most}{limit} mm{open}",
                row.sample
            ));
        }
        said.extend(self.still_to_set());
        said.extend(self.cautions());
        said.extend(self.dispersion_in_words(again));
        let walked = self.rows.iter().filter(|row| row.design.is_some()).count();
        if walked > 0 {
            said.extend(self.set_in_words());
            said.extend(self.washout_in_words(walked));
        }
        let (open, known): (Vec<_>, Vec<_>) = self.rows.iter().partition(|row| row.d15f_max_mm.is_none());
        let unserved = known.iter().filter(|row| !row.no_band.is_empty());
        said.extend(unserved.map(|row| format!("No band for {}: {}", row.sample, within_line(&row.no_band))));
        said.extend(open.into_iter().map(DesignedSample::open_in_words));
        let by_practice = known.iter().filter(|row| !row.not_walked.is_empty());
        let by_practice: Vec<&str> = by_practice.map(|row| row.sample.as_str()).collect();
        if !by_practice.is_empty() {
            said.push(format!("Not walked, by practice alone: {}", by_practice.join(", ")));
        }
        said
    }

    /// How many samples may be dispersive, and what practice allows the strictest of those for which it then
    /// allows less.
    fn dispersion_in_words(&self, again: &str) -> Option<String> {
        let open: Vec<_> = self.rows.iter().filter_map(|row| Some((row, row.if_dispersive?))).collect();
        let is_less = |(row, of): &&(&DesignedSample, IfDispersive)| {
            of.beside(row.bound().unwrap_or(f64::INFINITY)).is_some()
        };
        let strictest =
            open.iter().filter(is_less).min_by(|a, b| a.1.d15f_max_mm.total_cmp(&b.1.d15f_max_mm));
        let (row, of) = strictest?;
        Some(format!(
            "{} with 15 % fines or more may be dispersive, which is not stated. If {} is, {}. {} then not \
             valid: {again}",
            counted(open.len()),
            row.sample,
            of.clause_of_base(),
            match (open.len(), self.rows.len()) {
                (_, 1) => "Its band is",
                (1, _) => "Its band, and the filter for all, are",
                _ => "Their bands, and the filter for all, are",
            }
        ))
    }

    /// What no band has here, of one sample or of all; `None` where no sample has a band.
    fn still_to_set(&self) -> Option<String> {
        let has_band = self.rows.iter().any(|row| row.d15f_max_mm.is_some() && row.no_band.is_empty());
        has_band.then(|| {
            "Not a complete specification: the maximum D90F is still to be set, for each sample and for a \
             filter for several"
                .into()
        })
    }

    /// What is to be known of the samples themselves, with their names.
    fn cautions(&self) -> Vec<String> {
        let named = |(id, what): &(&str, &str)| {
            let is_so = |row: &&DesignedSample| row.findings.iter().any(|of| of.id == *id);
            let names: Vec<&str> = self.rows.iter().filter(is_so).map(|row| row.sample.as_str()).collect();
            (!names.is_empty()).then(|| format!("{what}: {}", names.join(", ")))
        };
        CAUTIONS.iter().filter_map(named).collect()
    }

    /// For how many samples each of practice and walk sets the maximum D15F.
    fn set_in_words(&self) -> Option<String> {
        let mut counts: Vec<(&str, usize)> = Vec::new();
        for by in self.rows.iter().filter_map(DesignedSample::set_by) {
            match counts.iter_mut().find(|(what, _)| *what == by) {
                Some((_, count)) => *count += 1,
                None => counts.push((by, 1)),
            }
        }
        let each = |(by, count): &(&str, usize)| format!("for {} by {by}", counted(*count));
        let each: Vec<String> = counts.iter().map(each).collect();
        (!each.is_empty()).then(|| format!("The maximum D15F is set {}", each.join(", ")))
    }

    /// For how many of them the filter as given is too coarse without the finer part that it may lose.
    fn washout_in_words(&self, walked: usize) -> Option<String> {
        let is_so = |row: &&DesignedSample| row.design.as_ref().is_some_and(|of| of.washout.is_some());
        let count = self.rows.iter().filter(is_so).count();
        (count > 0).then(|| {
            format!(
                "The filter as given is not internally stable, and for {count} of {} too coarse without the \
                 finer part that it may lose",
                counted(walked)
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::gradation::SoilSample;
    use crate::outcome::design::Specification;
    use crate::outcome::design::band::SetBy;
    use crate::outcome::numbers::SizeUnit;
    use crate::verdict::DESIGN_EACH_AGAIN;
    use crate::verdict::SampleDesign;
    use crate::verdict::SpecificationOptions;

    fn row(name: &str, points: &[(f64, f64)]) -> DesignedSample {
        let curve = Gradation::from_lines(points).unwrap();
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
            rule: String::new(),
            washout: None,
            said: "No ratio is known".into(),
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
        let said = by_practice.in_words(DESIGN_EACH_AGAIN);
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
        // Practice allows the silt less than all others, whatever the walk knows of it.
        let silt = all.rows[2].limit_mm.unwrap();
        assert!(silt < 0.65, "{silt}");
        assert_eq!(all.rows.iter().map(|row| row.governs).collect::<Vec<_>>(), [Some(2), Some(3), Some(1)]);
        let said = all.in_words(DESIGN_EACH_AGAIN).join("\n");
        for words in [
            "the 2 samples that are settled (1 is not) within the limit of silt: ",
            "Governing sample silt: no maximum D15F is known; practice allows ",
            "Then sand: D15F up to 0.650 mm (the walk)",
            "2 samples with 15 % fines or more may be dispersive, which is not stated. If silt is, D15F is ",
            " mm. Their bands, and the filter for all, are then not valid: design again for dispersive soils",
            "Not a complete specification: the maximum D90F is still to be set",
            "The maximum D15F is set for 1 sample by the walk, for 1 sample by practice",
            "May govern, as no maximum D15F is known: silt (limit of practice ",
            "mm): No ratio is known",
        ] {
            assert!(said.contains(words), "{words}: {said}");
        }
        let csv = String::from_utf8(DesignedSample::columns(SizeUnit::Mm).csv(&all.rows)).unwrap();
        assert!(csv.starts_with("sample,group,category,fines_percent,regraded_at_mm,d85b_mm,limit_mm,rule,"));
        assert_eq!(csv.lines().count(), 4);
        assert!(csv.contains("No ratio is known"), "{csv}");
    }

    #[test]
    fn samples_for_which_the_filter_as_given_washes_out_are_counted() {
        let core = row("core", &[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]);
        let of = |washout: Option<&str>| {
            let of = walked(core.clone(), Some(0.7));
            let washout = washout.map(str::to_owned);
            let design = of.design.clone().map(|design| SampleDesign { washout, ..design });
            DesignedSample { design, ..of }
        };
        let said = |all| DesignedSamples::new("s".into(), all).in_words(DESIGN_EACH_AGAIN).join("\n");
        let some = said(vec![of(Some("w")), of(None)]);
        assert!(some.contains("not internally stable, and for 1 of 2 samples too coarse without"), "{some}");
        assert!(!said(vec![of(None)]).contains("too coarse without"));
    }

    /// The table of many samples warns as the specification of each.
    #[test]
    fn samples_that_are_not_stable_themselves_are_named() {
        let gap = [(0.01, 0.0), (0.075, 20.0), (0.425, 29.0), (2.0, 30.0), (4.75, 50.0), (19.0, 100.0)];
        let sand = row("sand", &[(0.1, 0.0), (0.5, 100.0)]);
        let all = DesignedSamples::new("s".into(), vec![row("A", &gap), sand.clone(), row("B", &gap)]);
        let said = all.in_words(DESIGN_EACH_AGAIN).join("\n");
        for words in ["Not internally stable by Kenney and Lau", "Gap-graded by this program's own check"] {
            assert!(said.contains(&format!("\n{words}: A, B\n")), "{words}: {said}");
        }
        assert!(said.contains("are then not valid: design again for dispersive soils"), "{said}");
        let said = DesignedSamples::new("s".into(), vec![sand]).in_words(DESIGN_EACH_AGAIN).join("\n");
        assert!(!said.contains("Kenney") && said.contains("the maximum D90F is still to be set"), "{said}");
    }

    #[test]
    fn samples_that_no_one_filter_serves_are_said() {
        let fine = row("fine", &[(0.01, 0.0), (0.05, 100.0)]);
        let coarse = row("coarse", &[(0.5, 0.0), (4.0, 100.0)]);
        let all = DesignedSamples::new("s".into(), vec![fine, coarse]);
        let said = all.for_all_in_words();
        assert!(said.starts_with("No one filter serves all 2 samples: coarse needs D15F "), "{said}");
        let none = DesignedSamples::new("s".into(), Vec::new());
        assert_eq!(none.for_all_in_words(), "No maximum D15F is known for any sample");
    }

    /// Each of these gravels has a D60F beyond the greatest size; between their limits there is no band.
    #[test]
    fn a_sample_without_a_band_of_its_own_is_not_served() {
        let t1 =
            row("T1", &[(37.5, 100.0), (19.0, 80.0), (9.5, 60.0), (4.75, 40.0), (2.0, 10.0), (1.0, 0.0)]);
        let t2 =
            row("T2", &[(37.5, 100.0), (19.0, 95.0), (9.5, 75.0), (4.75, 50.0), (2.0, 20.0), (1.0, 0.0)]);
        assert!(!t1.no_band.is_empty() && t1.d15f_max_mm.is_some(), "{t1:?}");
        let why = t1.no_band.clone();
        let said = DesignedSamples::new("s".into(), vec![t1, t2]).in_words(DESIGN_EACH_AGAIN);
        assert!(said[0].starts_with("No filter is known that serves all 2 samples"), "{}", said[0]);
        assert!(said.contains(&format!("No band for T1: {}", why.trim_end_matches('.'))), "{said:?}");
    }

    #[test]
    fn both_ends_are_of_the_samples_that_are_settled_and_a_bound_on_drainage_refuses_nothing() {
        // The open sample drains from far more than the settled one allows.
        let core = row("core", &[(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)]);
        let gravel = DesignedSample { limit_mm: None, ..walked(row("g", &[(1.0, 0.0), (9.0, 100.0)]), None) };
        assert!(gravel.d15f_min_mm.unwrap() > 1.0);
        let said = DesignedSamples::new("s".into(), vec![core.clone(), gravel]).in_words(DESIGN_EACH_AGAIN);
        assert_eq!(
            said[0],
            "A filter for the 1 sample that is settled (1 is not): D15F from 0.140 to 0.700 mm (the minimum \
             that drains is 0.100 mm; it is raised so that the band is no wider than 5 to 1)"
        );
        assert!(said.iter().any(|line| line.ends_with("mm (this sample is not settled)")), "{said:?}");
        let one = DesignedSamples::new("s".into(), vec![core.clone()]);
        let said = one.for_all_in_words();
        assert!(said.starts_with("A filter for the sample: D15F from 0.140 to 0.700 mm (the"), "{said}");
        let open = DesignedSample {
            path: "other".into(),
            d15f_min_mm: Some(2.0),
            d15f_min_at_most: true,
            ..core.clone()
        };
        let said = DesignedSamples::new("s".into(), vec![core, open]).for_all_in_words();
        assert!(
            said.starts_with("It is not known whether one filter serves all 2 samples: core drains"),
            "{said}"
        );
    }
}
