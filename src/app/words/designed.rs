//! Limits of a filter for many samples, in sentences.

use super::practice::{beside_dispersive, dispersive_limit, test};
use super::specification::no_band;
use crate::outcome::table::Columns;
use voidwalk_practice::quantity::{NumberRole, SizeUnit, greatest_length, least_length, length, limits};
use voidwalk_practice::rules::WIDEST_BAND;
use voidwalk_practice::{
    DesignedSample, DesignedSamples, IfDispersive, Note, least_of_band, no_band_between,
};

/// Kind of note, and the beginning of its warning for several samples.
type Caution = (fn(&Note) -> bool, &'static str);

const CAUTIONS: [Caution; 5] = [
    (|note| matches!(note, Note::UnstableBase { .. }), "Not internally stable by Kenney and Lau"),
    (
        |note| matches!(note, Note::UnstableSide { .. }),
        "With a side of its own band that is not internally stable",
    ),
    (
        |note| matches!(note, Note::BroadBase { .. } | Note::BroadBaseAtLeast { .. }),
        "Broadly graded, so that the finer part may move between the coarse grains",
    ),
    (|note| matches!(note, Note::GapOfBase { .. }), "Gap-graded by this program's own check"),
    (
        |note| matches!(note, Note::FlatBase { .. }),
        "A curve that is flat somewhere, to be looked at for a gap",
    ),
];

fn counted(samples: usize) -> String {
    format!("{samples} sample{}", if samples == 1 { "" } else { "s" })
}

/// Sample and one of its limits of D15F (mm).
type Limit<'a> = (&'a DesignedSample, f64);

/// Sample with the largest minimum D15F for drainage; `None` if no sample has one.
fn drainage<'a>(rows: impl IntoIterator<Item = &'a DesignedSample>) -> Option<Limit<'a>> {
    let limits = rows.into_iter().filter_map(|row| Some((row, row.d15f_min_mm?)));
    limits.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Sample with the smallest maximum D15F; `None` if no sample has one.
fn strictest<'a>(rows: impl IntoIterator<Item = &'a DesignedSample>) -> Option<Limit<'a>> {
    let limits = rows.into_iter().filter_map(|row| Some((row, row.d15f_max_mm?)));
    limits.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Maximum D15F of a sample, and the origin of its rule.
fn greatest(row: &DesignedSample, unit: SizeUnit) -> String {
    let Some(mm) = row.d15f_max_mm else { return "no maximum D15F is known".into() };
    format!("D15F up to {} (practice: {})", greatest_length(mm, unit), row.rule)
}

/// Reason why a sample has no band, without the last full stop; empty if it has one.
fn without_band(row: &DesignedSample, unit: SizeUnit) -> String {
    row.no_band.as_ref().map_or_else(String::new, |why| no_band(why, unit).trim_end_matches('.').to_owned())
}

/// D15F of a filter for all samples, in a sentence without its end.
///
/// Both ends come from settled samples, and the maximum never exceeds the limit of any other sample.
fn for_all(all: &DesignedSamples, unit: SizeUnit) -> String {
    let [most, least_of] = [false, true]
        .map(|at_least| move |mm: f64| length(mm, unit).role(NumberRole::of_limit(at_least)).to_string());
    let (settled, others): (Vec<_>, Vec<_>) = all.rows.iter().partition(|row| row.is_settled());
    let cap = strictest(others.iter().copied());
    let Some((first, most_of_settled)) = strictest(settled.iter().copied()) else {
        let Some((row, mm)) = cap else { return "No maximum D15F is known for any sample".into() };
        let all = match others.len() {
            1 => "the sample".into(),
            all => format!("all {}", counted(all)),
        };
        return format!(
            "No filter is known that serves {all}: none is settled, and {} allows D15F up to {} at most",
            row.sample,
            most(mm)
        );
    };
    let cap = cap.filter(|(_, mm)| *mm < most_of_settled);
    let (first, greatest) = cap.unwrap_or((first, most_of_settled));
    let samples = match (settled.len(), others.len()) {
        (1, 0) => "the sample".to_owned(),
        (all, 0) => format!("all {}", counted(all)),
        (some, open) => {
            let [are, not] = [some, open].map(|n| if n == 1 { "is" } else { "are" });
            format!("the {} that {are} settled ({open} {not} not)", counted(some))
        }
    };
    let within = cap.map_or_else(String::new, |(row, _)| format!(" within the limit of {}", row.sample));
    let mm = most(greatest);
    let Some((row, least)) = drainage(settled.iter().copied()) else {
        return format!("A filter for {samples}{within}: D15F up to {mm}; no minimum D15F is known");
    };
    let (at_most, from) = (row.d15f_min_at_most, least_of(least));
    let and = if row.path == first.path { " and".into() } else { format!(", and {}", first.sample) };
    match no_band_between((least, at_most), greatest) {
        Some(_) if least > greatest && at_most => format!(
            "It is not known whether one filter serves {samples}{within}: {} drains from D15F {from} or \
             less, as its fines are not known{and} allows {mm} at most",
            row.sample
        ),
        Some(_) if least > greatest => format!(
            "No one filter serves {samples}{within}: {} needs D15F {from} or more to drain{and} allows \
             {mm} at most",
            row.sample
        ),
        Some(why) => format!(
            "No one filter is specified for {samples}{within}, with D15F from {}: {}",
            limits(least, greatest, unit),
            no_band(&why, unit).trim_end_matches('.')
        ),
        None => {
            let begins = least_of(least_of_band(least, greatest));
            let at_most = if at_most { "not known, and at most " } else { "" };
            let raised = match begins == from {
                true => String::new(),
                false => format!(
                    " (the minimum that drains is {at_most}{from}; it is raised so that the band is \
                     no wider than {WIDEST_BAND} to 1)"
                ),
            };
            let both = limits(least_of_band(least, greatest), greatest, unit);
            format!("A filter for {samples}{within}: D15F from {both}{raised}")
        }
    }
}

/// Sentences without their ends on the governing samples with their limits, and on the open samples; `again`
/// is the advice for a dispersive sample, as [`DESIGN_EACH_AGAIN`](super::specification::DESIGN_EACH_AGAIN).
pub(crate) fn lines(all: &DesignedSamples, again: &str, unit: SizeUnit) -> Vec<String> {
    let mut sentences = vec![for_all(all, unit)];
    for (at, row) in all.governing().into_iter().enumerate() {
        let what = if at == 0 { "Governing sample" } else { "Then" };
        sentences.push(format!("{what} {}: {}", row.sample, greatest(row, unit)));
    }
    if let Some((row, least)) = drainage(&all.rows) {
        let at_most = if row.d15f_min_at_most { "at most " } else { "" };
        let open = if row.is_settled() { "" } else { " (this sample is not settled)" };
        let limit = least_length(least, unit).to_string();
        sentences
            .push(format!("Drainage is governed by {}: minimum D15F {at_most}{limit}{open}", row.sample));
    }
    if all.rows.iter().any(DesignedSample::is_settled) {
        let still_to_set = "Not a complete specification: the maximum D90F is still to be set, for each \
                            sample and for a filter for several";
        sentences.push(still_to_set.into());
    }
    sentences.extend(cautions(all));
    sentences.extend(dispersion(all, again, unit));
    let (open, known): (Vec<_>, Vec<_>) = all.rows.iter().partition(|row| row.d15f_max_mm.is_none());
    let unserved = known.iter().filter(|row| row.no_band.is_some());
    sentences.extend(unserved.map(|row| format!("No band for {}: {}", row.sample, without_band(row, unit))));
    sentences.extend(open.into_iter().map(|row| {
        format!("May govern, as no maximum D15F is known: {}: {}", row.sample, without_band(row, unit))
    }));
    sentences
}

/// Number of samples that may be dispersive, and the limit by practice of the strictest sample whose
/// limit is then lower.
fn dispersion(all: &DesignedSamples, again: &str, unit: SizeUnit) -> Option<String> {
    let open: Vec<_> = all.rows.iter().filter_map(|row| Some((row, row.if_dispersive?))).collect();
    let is_less = |(row, limit): &&(&DesignedSample, IfDispersive)| {
        beside_dispersive(*limit, row.d15f_max_mm.unwrap_or(f64::INFINITY), unit).is_some()
    };
    let strictest = open.iter().filter(is_less).min_by(|a, b| a.1.d15f_max_mm.total_cmp(&b.1.d15f_max_mm));
    let (row, limit) = strictest?;
    Some(format!(
        "{} with 15 % fines or more may be dispersive, which is not stated. If {} is, {}. {} then not \
         valid: {again}",
        counted(open.len()),
        row.sample,
        clause(*limit, unit),
        match (open.len(), all.rows.len()) {
            (_, 1) => "Its band is",
            (1, _) => "Its band, and the filter for all, are",
            _ => "Their bands, and the filter for all, are",
        }
    ))
}

/// Warnings about the samples themselves, with their names.
fn cautions(all: &DesignedSamples) -> Vec<String> {
    let named = |(is_it, what): &Caution| {
        let is_so = |row: &&DesignedSample| row.notes.iter().any(is_it);
        let names: Vec<&str> = all.rows.iter().filter(is_so).map(|row| row.sample.as_str()).collect();
        (!names.is_empty()).then(|| format!("{what}: {}", names.join(", ")))
    };
    CAUTIONS.iter().filter_map(named).collect()
}

/// Limit of a dispersive base, and the test for an unknown limit.
fn clause(limit: IfDispersive, unit: SizeUnit) -> String {
    let words = format!("D15F is to be {}", dispersive_limit(limit, unit));
    if limit.at_most {
        format!("{words}; {}", test(limit, "have the base tested with the filter"))
    } else {
        words
    }
}

/// Columns of `designs.csv`, and under their headings of a terminal and a page, with sizes in this unit.
pub(crate) fn columns<'a>(unit: SizeUnit) -> Columns<'a, DesignedSample> {
    let drains = move |row: &DesignedSample| {
        let at_most = if row.d15f_min_at_most { " at most" } else { "" };
        row.d15f_min_mm.map(|least| format!("{}{at_most}", least_length(least, unit).in_cell()))
    };
    let band = move |row: &DesignedSample| match row.band_d15f_mm {
        Some([least, greatest]) => limits(least, greatest, unit).in_cell(),
        None => "none".into(),
    };
    Columns::default()
        .name("sample", "Sample", |row: &DesignedSample| row.sample.clone())
        .text("group", "Group", |row| row.group.clone())
        .column("category", |row| row.category.map(u64::from))
        .digits("fines_percent", 1, |row| row.fines_percent)
        .digits("regraded_at_mm", 4, |row| row.regraded_at_mm)
        .digits("d85b_mm", 4, |row| row.d85b_mm)
        .page_number("D85B, regraded, mm", move |row| row.d85b_mm.map(|mm| length(mm, unit).in_cell()))
        .digits("d15f_max_mm", 4, |row| row.d15f_max_mm)
        .page_number("Limit of practice, mm", move |row| {
            row.d15f_max_mm.map(|mm| greatest_length(mm, unit).in_cell())
        })
        .text("rule", "Whose limit", |row| row.rule.clone())
        .digits("d15f_min_mm", 4, |row| row.d15f_min_mm)
        .page_number("Drains from, mm", drains)
        .column("d15f_min_at_most", |row| row.d15f_min_at_most)
        .digits("band_d15f_min_mm", 4, |row| row.band_d15f_mm.map(|[least, _]| least))
        .digits("band_d15f_max_mm", 4, |row| row.band_d15f_mm.map(|[_, greatest]| greatest))
        .page_number("Band, D15F, mm", band)
        .number("governs", "Governs", |row| row.governs)
        .column("no_band", move |row| row.no_band.as_ref().map(|why| no_band(why, unit)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::{CORE, curve};
    use crate::words::specification::DESIGN_EACH_AGAIN;
    use voidwalk_practice::SpecificationOptions;
    use voidwalk_practice::design::Specification;
    use voidwalk_sheets::SoilSample;

    fn designed(rows: Vec<DesignedSample>) -> DesignedSamples {
        DesignedSamples::new("s".into(), rows)
    }

    fn lines_of(all: &DesignedSamples) -> Vec<String> {
        lines(all, DESIGN_EACH_AGAIN, SizeUnit::Mm)
    }

    fn row(name: &str, points: &[(f64, f64)]) -> DesignedSample {
        let curve = curve(points);
        let sample = SoilSample { name: name.into(), path: name.into(), curve: curve.clone() };
        let specification = Specification::of(name, &[(name.into(), curve)], SpecificationOptions::default());
        DesignedSample::of(&sample, &specification)
    }

    #[test]
    fn the_least_d15f_of_practice_governs() {
        // 60 % fines: 0.7 mm. A clean sand: 4 D85B.
        let core = row("core", &CORE);
        let sand = row("sand", &[(0.1, 0.0), (0.5, 100.0)]);
        let limit = sand.d15f_max_mm.unwrap();
        assert!(core.d15f_max_mm == Some(0.7) && (limit - 4.0 * sand.d85b_mm.unwrap()).abs() < 1e-9);
        let by_practice = designed(vec![sand.clone(), core.clone()]);
        let sentences = lines_of(&by_practice);
        let governing =
            format!("Governing sample core: D15F up to 0.700\u{202f}mm (practice: {})", core.rule);
        assert_eq!(sentences[1], governing);
        assert!(sentences[0].starts_with("A filter for all 2 samples: D15F from "), "{}", sentences[0]);
        assert!(sentences[0].ends_with("0.700\u{202f}mm"), "{}", sentences[0]);
        assert!(by_practice.rows.iter().map(|row| row.governs).eq([Some(2), Some(1)]));
        let csv = String::from_utf8(columns(SizeUnit::Mm).csv(&by_practice.rows)).unwrap();
        assert!(
            csv.starts_with("sample,group,category,fines_percent,regraded_at_mm,d85b_mm,d15f_max_mm,rule,")
        );
        assert_eq!(csv.lines().count(), 3);
    }

    /// The table of many samples has the warnings of each specification.
    #[test]
    fn samples_that_are_not_stable_themselves_are_named() {
        let gap = [(0.01, 0.0), (0.075, 20.0), (0.425, 29.0), (2.0, 30.0), (4.75, 50.0), (19.0, 100.0)];
        let sand = row("sand", &[(0.1, 0.0), (0.5, 100.0)]);
        let all = designed(vec![row("A", &gap), sand.clone(), row("B", &gap)]);
        let text = lines_of(&all).join("\n");
        for words in ["Not internally stable by Kenney and Lau", "Gap-graded by this program's own check"] {
            assert!(text.contains(&format!("\n{words}: A, B\n")), "{words}: {text}");
        }
        assert!(text.contains("are then not valid: design again for dispersive soils"), "{text}");
        let text = lines_of(&designed(vec![sand])).join("\n");
        assert!(!text.contains("Kenney") && text.contains("the maximum D90F is still to be set"), "{text}");
    }

    #[test]
    fn samples_that_no_one_filter_serves_are_said() {
        let fine = row("fine", &[(0.01, 0.0), (0.05, 100.0)]);
        let coarse = row("coarse", &[(0.5, 0.0), (4.0, 100.0)]);
        let sentence = for_all(&designed(vec![fine, coarse]), SizeUnit::Mm);
        assert!(sentence.starts_with("No one filter serves all 2 samples: coarse needs D15F "), "{sentence}");
        let none = for_all(&designed(Vec::new()), SizeUnit::Mm);
        assert_eq!(none, "No maximum D15F is known for any sample");
        // Each of these gravels has a D60F beyond the maximum size; between their limits there is no band.
        let t1 = [(37.5, 100.0), (19.0, 80.0), (9.5, 60.0), (4.75, 40.0), (2.0, 10.0), (1.0, 0.0)];
        let t2 = [(37.5, 100.0), (19.0, 95.0), (9.5, 75.0), (4.75, 50.0), (2.0, 20.0), (1.0, 0.0)];
        let [t1, t2] = [("T1", t1), ("T2", t2)].map(|(name, points)| row(name, &points));
        assert!(t1.no_band.is_some() && t1.d15f_max_mm.is_some(), "{t1:?}");
        let why = format!("No band for T1: {}", without_band(&t1, SizeUnit::Mm));
        let sentences = lines_of(&designed(vec![t1, t2]));
        assert!(sentences[0].starts_with("No filter is known that serves all 2 samples"), "{}", sentences[0]);
        assert!(sentences.contains(&why), "{sentences:?}");
    }

    #[test]
    fn both_ends_are_of_the_samples_that_are_settled_and_a_bound_on_drainage_refuses_nothing() {
        // The open sample drains only from a D15F far above the limit of the settled one.
        let core = row("core", &CORE);
        let gravel = DesignedSample { d15f_max_mm: None, ..row("g", &[(1.0, 0.0), (9.0, 100.0)]) };
        assert!(gravel.d15f_min_mm.unwrap() > 1.0);
        let sentences = lines_of(&designed(vec![core.clone(), gravel]));
        assert_eq!(
            sentences[0],
            "A filter for the 1 sample that is settled (1 is not): D15F from 0.140 to 0.700\u{202f}mm (the \
             minimum that drains is 0.100\u{202f}mm; it is raised so that the band is no wider than 5 to 1)"
        );
        assert!(sentences.iter().any(|line| line.ends_with("mm (this sample is not settled)")));
        let open = DesignedSample { path: "other".into(), d15f_min_at_most: true, ..core.clone() };
        let open = DesignedSample { d15f_min_mm: Some(2.0), ..open };
        for (rows, words) in [
            (vec![core.clone()], "A filter for the sample: D15F from 0.140 to 0.700\u{202f}mm (the"),
            (vec![core, open], "It is not known whether one filter serves all 2 samples: core drains"),
        ] {
            let sentence = for_all(&designed(rows), SizeUnit::Mm);
            assert!(sentence.starts_with(words), "{sentence}");
        }
    }
}
