//! Many samples: a design for each, in a folder of its own, and one table of all.

use std::path::{Path, PathBuf};

use super::days::{day_of, is_day, today};
use super::design::{DesignOptions, identity, is_a_base, run};
use super::file_names::numbered;
use super::inputs::{files_of, input_files};
use super::kept;
use crate::gradation::{SoilSample, notes_in_file, samples_in};
use crate::outcome::design::{Design, Specification};
use crate::outcome::quantity::SizeUnit;
use crate::outcome::record::InputFile;
use crate::run::callbacks::{Callbacks, Event};
use crate::run::error::{Exit, RunError};
use crate::run::folder::{FolderKind, claim, shown};
use crate::run::machine::on_threads;
use crate::run::results::json;
use crate::scene::About;
use crate::store::Folder;
use crate::store::folder_name;
use crate::verdict::{DesignedSample, DesignedSamples, DesignedWalks, SpecificationOptions};
use crate::words::designed::columns;

/// Folder of the designs, inside that of all.
const SAMPLES: &str = "samples";

/// One row a sample.
const TABLE: &str = "designs.csv";

/// The table of a sample's walks, in the folder of its design.
const OF_DESIGN: &str = "design.csv";

/// Their page.
const PAGE: &str = "designs.html";

/// A refusal of all samples names no more of them.
const NAMED: usize = 3;

/// Which samples are designed for, and how.
#[derive(Clone, Debug)]
pub struct SampleDesignOptions {
    /// A file of samples, or a folder of such files.
    pub samples: PathBuf,
    /// Whether nothing is walked: practice alone.
    pub by_practice_alone: bool,
    /// How each is designed for; its base is the sample, and its folder is that of all.
    pub design: DesignOptions,
}

/// The samples, each found sound.
struct Planned {
    /// What practice says of each.
    rows: Vec<DesignedSample>,
    /// The folder of each sample's design.
    folders: Vec<String>,
    filter: String,
    dispersive: bool,
    notes: Vec<String>,
    inputs: Vec<InputFile>,
    /// Everything that the table follows from, as a hash.
    work: String,
}

/// Finds how coarse a filter may be for every sample, and writes `designs.csv` and, last, `designs.json`; the
/// design of each sample is in a folder of its own. A sample that cannot be walked stays in the table, with
/// the reason. Where the folder holds this very table already, nothing is walked.
///
/// # Errors
/// Samples that cannot be read, of which none can be walked, or one that is none, and a folder that cannot be
/// claimed, are refused before any work; then as [`run`]. After a stop or a kill the same command continues.
pub fn each(options: &SampleDesignOptions, callbacks: &Callbacks) -> Result<DesignedSamples, RunError> {
    let planned = on_threads(options.design.prepare.threads, || Planned::new(options))?;
    let (kind, out, overwrite) = (FolderKind::Designs, &options.design.out, options.design.overwrite);
    if !overwrite && let Some(found) = planned.found(options)? {
        return Ok(found);
    }
    // What is there is this very work, or unfinished, of which the study says whether it is.
    let folder = claim(out, kind, true)?;
    let work = planned.work.clone();
    let all = kept::study((&folder, kind, overwrite), work, callbacks, |_, _: Option<()>| {
        let all = planned.designed(options, &folder, callbacks)?;
        folder.write(TABLE, &columns(SizeUnit::Mm).csv(&all.rows))?;
        Ok(all)
    });
    all.map_err(|error| match error.exit() {
        Exit::Stopped => {
            RunError::Stopped(format!("progress saved; continue with the same command on {}", shown(out)))
        }
        _ => error,
    })
}

impl Planned {
    fn new(options: &SampleDesignOptions) -> Result<Self, RunError> {
        let samples = samples_in(&options.samples).map_err(RunError::refused)?;
        samples.iter().try_for_each(|of| is_a_base(&of.path, &of.name, &of.curve))?;
        let dispersive = options.design.dispersive();
        let of = SpecificationOptions { dispersive, ..SpecificationOptions::default() };
        let dispersive = dispersive == Some(true);
        let row = |sample: &SoilSample| {
            let curve = (sample.name.clone(), sample.curve.clone());
            DesignedSample::of(sample, &Specification::of(&sample.name, &[curve], of))
        };
        let mut rows: Vec<DesignedSample> = samples.iter().map(row).collect();
        let names = numbered(rows.iter().map(|row| row.sample.clone()).collect());
        let stated = options.stated();
        // A sample is not walked again for another cover.
        let walked = options.stated_of_walks();
        let (mut folders, mut filter) = (Vec::new(), String::new());
        for (row, name) in rows.iter_mut().zip(names).filter(|_| !options.by_practice_alone) {
            let of_sample = options.of_sample(row, PathBuf::new());
            let work_of = match identity(&of_sample) {
                Ok(of) => {
                    filter = of.filter;
                    kept::hash_of(&format!("{} {walked}", of.work))
                }
                Err(problem) => {
                    row.not_walked = problem.to_string();
                    String::new()
                }
            };
            // Other work has another folder, whatever the sample is called.
            folders.push(folder_name(&format!("{name} {}", &work_of.get(..8).unwrap_or_default())));
        }
        if !rows.is_empty() && !options.by_practice_alone && rows.iter().all(|row| !row.not_walked.is_empty())
        {
            let why = |row: &DesignedSample| format!("{}: {}", row.sample, row.not_walked);
            let reasons: Vec<String> = rows.iter().take(NAMED).map(why).collect();
            return Err(RunError::Refused(format!("no sample can be walked\n{}", reasons.join("\n"))));
        }
        let pairs = |sample: &SoilSample| -> Vec<(f64, f64)> {
            sample.curve.points().iter().map(|point| (point.size, point.percent)).collect()
        };
        let curves: Vec<_> = samples.iter().map(pairs).collect();
        let samples_at = shown(&options.samples);
        let work =
            kept::hash_of(&format!("{samples_at} {dispersive} {folders:?} {rows:?} {curves:?} {stated}"));
        let files = samples.iter().map(|sample| sample.path.as_path());
        let (notes, inputs) = (notes(&files_of(files.clone()))?, input_files(files)?);
        Ok(Self { rows, folders, filter, dispersive, notes, inputs, work })
    }

    /// The table that the folder holds already; `None` where [`each`] begins there or goes on.
    fn found(&self, options: &SampleDesignOptions) -> Result<Option<DesignedSamples>, RunError> {
        let (kind, out) = (FolderKind::Designs, &options.design.out);
        if out.symlink_metadata().is_err() {
            return Ok(None);
        }
        let folder = claim(out, kind, true)?;
        if !kind.is_finished(folder.path())? {
            return Ok(None);
        }
        let there: DesignedSamples = kept::record(folder.path(), kind)?;
        if there.work == self.work {
            // A table or a page that somebody took away is written again.
            let is_whole = |name: &&str| out.join(name).is_file();
            let page = cfg!(feature = "report").then_some(PAGE);
            return Ok([TABLE].iter().chain(&page).all(is_whole).then_some(there));
        }
        let problem =
            "holds the designs of other samples or settings; name another folder or add --overwrite";
        Err(RunError::Refused(format!("{}: {problem}", shown(out))))
    }

    /// The table, with every sample designed for that is not yet.
    fn designed(
        &self,
        options: &SampleDesignOptions,
        folder: &Folder,
        callbacks: &Callbacks,
    ) -> Result<DesignedSamples, RunError> {
        let (mut rows, mut leaves_out, mut walks, mut day) = (Vec::new(), Vec::new(), None, None);
        let mut inputs = self.inputs.clone();
        let settings = &options.design.settings;
        for (at, row) in self.rows.iter().enumerate() {
            let Some(name) = self.folders.get(at).filter(|_| row.not_walked.is_empty()) else {
                rows.push(row.clone());
                continue;
            };
            let text = format!("sample {} of {}: {}", at + 1, self.rows.len(), row.sample);
            (callbacks.on_event)(Event::Studying(&text));
            let place = format!("{SAMPLES}/{name}");
            let of_sample = options.of_sample(row, folder.path().join(&place));
            let is_done = of_sample.out.is_dir() && FolderKind::Design.is_finished(&of_sample.out)?;
            let design: Design = match is_done {
                true => covered(&of_sample, callbacks)?,
                false => run(&of_sample, callbacks)?,
            };
            // Days are in order as texts.
            day = day.max(design.cover.date.clone());
            leaves_out.clone_from(&design.model_leaves_out);
            walks = Some(DesignedWalks::of(&design, settings));
            // Besides the samples' own files that of the filter.
            add_new(&mut inputs, &design.inputs);
            rows.push(row.clone().designed(&design, place));
        }
        let all = DesignedSamples::new(shown(&options.samples), rows);
        Ok(DesignedSamples {
            work: self.work.clone(),
            filter: self.filter.clone(),
            dispersive: self.dispersive,
            inches: options.design.shows_inches(),
            cover: options.design.cover().dated(day.or_else(today)),
            walks,
            notes: self.notes.clone(),
            inputs,
            model_leaves_out: leaves_out,
            ..all
        })
    }
}

/// Adds the files that are not there yet. Files of one name are told apart by their sum, and copies of one
/// file by their names: a design names its files by another path than the table does.
fn add_new(inputs: &mut Vec<InputFile>, files: &[InputFile]) {
    let name = |file: &InputFile| Path::new(&file.name).file_name().map(ToOwned::to_owned);
    for file in files {
        if inputs.iter().all(|other| (name(other), &other.xxh3) != (name(file), &file.xxh3)) {
            inputs.push(file.clone());
        }
    }
}

impl SampleDesignOptions {
    /// What of the options stands in table, page or designs beside what is walked.
    fn stated(&self) -> String {
        self.stated_with(&self.design.settings)
    }

    /// The same without the cover.
    fn stated_of_walks(&self) -> String {
        let cover = About::texts();
        let name = |setting: &String| setting.split('=').next().unwrap_or_default().trim().to_owned();
        let settings = self.design.settings.iter().filter(|setting| !cover.contains(&name(setting)));
        self.stated_with(&settings.cloned().collect::<Vec<_>>())
    }

    fn stated_with(&self, settings: &[String]) -> String {
        let of = &self.design;
        format!("{} {settings:?} {} {}", of.sieves, of.as_sampled, of.as_given)
    }

    fn of_sample(&self, row: &DesignedSample, out: PathBuf) -> DesignOptions {
        DesignOptions { base: Some(row.path.clone()), out, overwrite: false, ..self.design.clone() }
    }
}

/// The design of a sample that is done, whose record and page get the cover that is stated now.
fn covered(options: &DesignOptions, callbacks: &Callbacks) -> Result<Design, RunError> {
    let kind = FolderKind::Design;
    let design: Design = kept::record(&options.out, kind)?;
    // A date that is no day was stated earlier; the table of the walks tells their day.
    let day = design.cover.date.clone().filter(|date| is_day(date));
    let day = day.or_else(|| day_of(&options.out.join(OF_DESIGN)));
    let cover = options.cover().dated(day);
    if design.cover == cover {
        return Ok(design);
    }
    let folder = claim(&options.out, kind, true)?;
    let design = Design { cover, ..design };
    folder.write(kind.record(), &json(kind.format(), &design)?)?;
    callbacks.results(kind, folder.path())?;
    Ok(design)
}

/// What was assumed of the files, once each.
fn notes(files: &[PathBuf]) -> Result<Vec<String>, RunError> {
    let mut all = Vec::new();
    for file in files {
        let of_file = notes_in_file(file).map_err(RunError::refused)?;
        all.extend(of_file.into_iter().map(|note| format!("{}: {note}", shown(file))));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A filter whose file holds the bytes of a sample's file is another input.
    #[test]
    fn an_input_is_known_by_name_and_sum() {
        let file = |name: &str, bytes: &str| InputFile::of(name, bytes.as_bytes());
        let mut inputs = vec![file("soils/sand.csv", "0.1,0")];
        let of_design =
            [file("inputs/sand.csv", "0.1,0"), file("filter.csv", "0.1,0"), file("sand.csv", "0.2,0")];
        for _ in 0..2 {
            add_new(&mut inputs, &of_design);
            let names: Vec<&str> = inputs.iter().map(|of| of.name.as_str()).collect();
            assert_eq!(names, ["soils/sand.csv", "filter.csv", "sand.csv"]);
        }
    }
}
