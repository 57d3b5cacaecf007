//! Answers to requests: each answer is a call of the library.

use std::fs::{self, File};
use std::io::{self, Seek};
use std::net::TcpStream;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::{Value, json};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::batches::{self, AskedBatch, AskedTables, rules_of_pair};
use super::guard::Guard;
use super::http::{Answer, BODY, Request, read_body};
use super::job::{JobFile, Work, of_cases};
use super::jobs::JobQueue;
use super::sheets::Sheets;
use crate::case::LibraryFilter;
use crate::cases::BatchPlan;
use crate::report;
use crate::run::error::Exit;
use crate::run::prepare::Draft;
use crate::run::{self, EXAMPLE_FILES, PrepareOptions, RunError, checkpoints};
use crate::scene::{Density, LibraryDensity, Scene, TableOptions};
use crate::words::batch::columns;
use crate::words::sentence;
use voidwalk_core::constrictions::shipped;
use voidwalk_core::gradation::{CurvePoint, Gradation};
use voidwalk_core::schema::KeyInfo;
use voidwalk_core::store::open_regular;
use voidwalk_core::text::is_plain_part;
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{BatchTable, PairOptions, PairRules, Refusal};
use voidwalk_sheets::curves_in_file;

const PAGE: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("page.js");
const STYLE: &str = include_str!("page.css");
const ICON: &str = include_str!("icon.svg");

/// Content security policy of the page: it may use only its own script, style, pictures and requests.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; \
    connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const POLICY_OF_DRAWING: &str = "default-src 'none'; style-src 'unsafe-inline'; sandbox";

/// Maximum number of settings, and maximum length of a setting.
const SETTINGS: (usize, usize) = (200, 2000);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    base: String,
    filter: String,
    #[serde(flatten)]
    tables: AskedTables,
}

struct Planned {
    title: String,
    asked: Value,
    work: Work,
}

pub(crate) struct Routes {
    pub(crate) guard: Guard,
    pub(crate) sheets: Sheets,
    pub(crate) jobs: JobQueue,
    pub(crate) prepare: PrepareOptions,
    pub(crate) root: PathBuf,
}

type Problem = (u16, String);

/// Constriction curves of a filter, loose and dense, by their names; empty if the library has no similar
/// filter.
fn constrictions(filter: &Gradation) -> Vec<(String, Vec<CurvePoint>)> {
    let curve = |density: LibraryDensity| {
        let entry = LibraryFilter::find(filter, density).ok()??.found;
        Some((format!("constrictions, {}, by number", density.name()), entry.curve.points()))
    };
    [LibraryDensity::Loose, LibraryDensity::Dense].into_iter().filter_map(curve).collect()
}

fn wrong(error: impl std::fmt::Display) -> Problem {
    (422, on_page(&error.to_string()))
}

/// Message of the command line in the words of the page, which has boxes and fields instead of options.
fn on_page(message: &str) -> String {
    let shorter = ["--set: ", "--set, "].iter().find_map(|start| message.strip_prefix(start));
    let message = shorter.unwrap_or(message);
    message
        .replace("(--as-given)", "(the tick \"base and filter are as given\")")
        .replace("--as-sampled", "the tick \"walk the base as it was sampled\"")
}

fn missing(what: &str) -> Problem {
    (404, format!("there is no such {what}"))
}

fn failed(error: io::Error) -> Problem {
    (500, error.to_string())
}

impl Routes {
    pub(crate) fn answer(&self, mut request: Request, stream: &mut TcpStream) -> io::Result<Answer> {
        let Some(path) = self.guard.path(&request).map(str::to_owned) else {
            let words = "not allowed: open the address that voidwalk serve has printed, with its secret";
            return Ok(Answer::problem(403, words));
        };
        let answered = match request.method.as_str() {
            "GET" => self.get(&path, &request),
            "POST" => match read_body(&mut request, stream)? {
                Ok(body) => self.post(&path, &request, &body),
                Err(refusal) => return Ok(refusal),
            },
            _ => Err((405, "GET or POST".into())),
        };
        Ok(answered.unwrap_or_else(|(status, words)| Answer::problem(status, &self.sheets.as_named(&words))))
    }

    fn get(&self, path: &str, request: &Request) -> Result<Answer, Problem> {
        let page = |kind, text: &str| Answer { policy: Some(POLICY.into()), ..Answer::new(200, kind, text) };
        match path {
            "" => Ok(page("text/html; charset=utf-8", PAGE)),
            "page.js" => Ok(page("text/javascript; charset=utf-8", SCRIPT)),
            "icon.svg" => Ok(page("image/svg+xml", ICON)),
            "page.css" => Ok(page("text/css; charset=utf-8", STYLE)),
            "api/state" => Ok(Answer::json(200, self.state(request))),
            "api/form" => Ok(Answer::json(200, form())),
            "api/rules" => self.rules(request),
            "api/curves.svg" => self.curves(request),
            "api/samples" => Ok(Answer::json(200, batches::of_samples(&self.samples(request)?))),
            "samples.csv" => {
                let csv = columns(SizeUnit::Mm).csv(&self.samples(request)?.rows);
                let answer = Answer::new(200, "text/csv; charset=utf-8", csv);
                Ok(Answer { download: Some("voidwalk-samples.csv".into()), ..answer })
            }
            #[cfg(feature = "xlsx")]
            "voidwalk-soils.xlsx" => template(path),
            _ => match path.split_once('/') {
                Some(("files", file)) => self.file(file),
                Some(("examples", name)) => example(name),
                Some(("zip", folder)) => self.zip(folder),
                _ => Err(missing("page")),
            },
        }
    }

    fn post(&self, path: &str, request: &Request, body: &[u8]) -> Result<Answer, Problem> {
        let id = || {
            let id = request.parameter("id").and_then(|id| id.parse().ok());
            id.ok_or((400, "which job?".to_owned()))
        };
        let accepted = |id: usize| Answer::json(200, json!({ "id": id }));
        let conflict = |words: String| (409, words);
        match path {
            "api/sheet" => {
                let name = request.parameter("name").unwrap_or_default();
                let sheet = self.sheets.add(&name, body).map_err(wrong)?;
                Ok(Answer::json(200, json!(*sheet)))
            }
            "api/judge" | "api/batch" => {
                let request: Value = serde_json::from_slice(body).map_err(malformed)?;
                let kind = path.trim_start_matches("api/").to_owned();
                let Planned { title, asked, work } = self.planned(&kind, &request)?;
                let file = JobFile { kind, title, asked, request, ended: None };
                let status = |error: &RunError| if error.exit() == Exit::Refused { 429 } else { 500 };
                let added = self.jobs.add(file, work).map_err(|error| (status(&error), error.to_string()));
                added.map(accepted)
            }
            "api/check" => {
                let asked = serde_json::from_slice(body).map_err(malformed)?;
                let check = run::check(self.scene(&asked)?, &self.prepare).map_err(wrong)?;
                let refusal =
                    check.refusal.as_ref().map(|refusal| self.sheets.as_named(&refusal.to_string()));
                let unit = SizeUnit::of(check.inputs.scale_free, false);
                let mut value = serde_json::to_value(&check).map_err(wrong)?;
                value["notes"] = check.notes.iter().map(|note| sentence(note, unit)).collect();
                value["refusal"] = json!(refusal);
                Ok(Answer::json(200, value))
            }
            "api/stop" => id().and_then(|id| self.jobs.stop(id).map(|()| accepted(id)).map_err(conflict)),
            "api/continue" => {
                let id = id()?;
                let work = match self.jobs.kept(id).map_err(conflict)? {
                    Some(file) => match self.planned(&file.kind, &file.request) {
                        Ok(planned) => planned.work,
                        // A sheet is missing, but the folder holds everything needed.
                        Err(_) if self.jobs.has_scene(id) => Work::Resume,
                        Err(problem) => return Err(problem),
                    },
                    None => Work::Resume,
                };
                self.jobs.resume(id, work).map(|()| accepted(id)).map_err(conflict)
            }
            _ => Err(missing("page")),
        }
    }

    fn planned(&self, kind: &str, request: &Value) -> Result<Planned, Problem> {
        match kind {
            "judge" => {
                let asked: Asked = Deserialize::deserialize(request).map_err(malformed)?;
                let title = format!("{} on {}", self.title(&asked.base), self.title(&asked.filter));
                let scene = self.scene(&asked)?;
                Draft::new(scene.clone()).map_err(wrong)?;
                let sheets = json!({ "base": asked.base, "filter": asked.filter });
                Ok(Planned { title, asked: sheets, work: Work::Judge(Box::new(scene)) })
            }
            "batch" => {
                let asked: AskedBatch = Deserialize::deserialize(request).map_err(malformed)?;
                let sheets = json!({ "base": asked.base, "filter": asked.filters.first() });
                let (samples, filters) = asked.sheets(&self.sheets).map_err(wrong)?;
                let names = batches::filter_names(&self.sheets, &filters);
                let of_samples = self.sheets.as_named(&samples.display().to_string());
                let (tables, walks) = (table_options(&asked.tables)?, asked.walks().map_err(wrong)?);
                let options = of_cases(&self.root, &self.prepare, "");
                let plan = BatchPlan::new(&samples, &filters, &tables, walks, &options).map_err(wrong)?;
                let plan = plan.named(&of_samples, &names, |message| self.sheets.as_named(message));
                let title = asked.title(&of_samples, &names);
                Ok(Planned { title, asked: sheets, work: Work::Batch(Box::new(plan)) })
            }
            _ => Err(missing("work")),
        }
    }

    /// All state that changes; sheets only if the page has a different number of them.
    fn state(&self, request: &Request) -> Value {
        let sheets = self.sheets.all();
        let folder = std::path::absolute(&self.root).unwrap_or_else(|_| self.root.clone());
        let has_all = request.parameter("have") == Some(sheets.len().to_string());
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "folder": folder.display().to_string(),
            "largest_mb": BODY >> 20,
            "has_template": cfg!(feature = "xlsx"),
            "sheets": if has_all { Value::Null } else { sheets.iter().map(|sheet| json!(**sheet)).collect() },
            "jobs": self.jobs.snapshot(|words| self.sheets.as_named(words)),
        })
    }

    fn title(&self, sheet: &str) -> String {
        let path = self.sheets.path(sheet).unwrap_or_default();
        self.sheets.as_named(&path.display().to_string())
    }

    fn path(&self, sheet: &str) -> Result<PathBuf, Problem> {
        self.sheets.path(sheet).map_err(wrong)
    }

    fn scene(&self, asked: &Asked) -> Result<Scene, Problem> {
        let (base, filter) = (self.path(&asked.base)?, self.path(&asked.filter)?);
        Scene::of_tables(&base, &filter, &table_options(&asked.tables)?).map_err(wrong)
    }

    fn rules(&self, request: &Request) -> Result<Answer, Problem> {
        let curves = |name: &str| {
            let path = self.path(&request.parameter(name).unwrap_or_default())?;
            curves_in_file(&path, None).map_err(RunError::refused).map_err(wrong)
        };
        let options = pair_options(request)?;
        let pair = PairRules::guarded(&curves("base")?, &curves("filter")?, options)
            .map_err(|mistake| wrong(Refusal(&mistake, "--as-given").to_string()))?;
        Ok(Answer::json(200, rules_of_pair(&pair)))
    }

    fn samples(&self, request: &Request) -> Result<BatchTable, Problem> {
        let [base, filters] = ["base", "filter"].map(|name| request.parameter(name).unwrap_or_default());
        let filters: Vec<&str> = filters.split('\n').filter(|name| !name.is_empty()).collect();
        batches::samples(&self.sheets, &base, &filters, pair_options(request)?).map_err(wrong)
    }

    /// Sieve curves of the named sheets in one drawing, with the library's constrictions of the filter.
    fn curves(&self, request: &Request) -> Result<Answer, Problem> {
        let (mut soils, mut passages) = (Vec::new(), Vec::new());
        for (name, role) in [("base", "base"), ("filter", "filter"), ("more", "")] {
            for sheet in request.parameter(name).iter().flat_map(|all| all.split('\n')) {
                for (name, curve) in curves_in_file(&self.path(sheet)?, None).map_err(wrong)? {
                    if role == "filter" {
                        passages.extend(constrictions(&curve));
                    }
                    let named = if role.is_empty() { name } else { format!("{role}: {name}") };
                    soils.push((named, curve.points()));
                }
            }
        }
        soils.extend(passages);
        let drawn =
            report::soils_figure(soils.iter().map(|(name, points)| (name.as_str(), &points[..])), false);
        Ok(Answer { policy: Some(POLICY_OF_DRAWING.into()), ..Answer::new(200, "image/svg+xml", drawn) })
    }

    /// File in a job's folder; other folders and links are refused.
    fn file(&self, named: &str) -> Result<Answer, Problem> {
        let missing = || missing("file");
        let (folder, rest) = named.split_once('/').ok_or_else(missing)?;
        if !rest.split('/').all(is_plain_part) {
            return Err(missing());
        }
        let folder = self.jobs.folder(folder).filter(|folder| is_own(folder)).ok_or_else(missing)?;
        let path = folder.join(rest);
        let real = |path: &Path| path.canonicalize().ok();
        if !real(&path).zip(real(&folder)).is_some_and(|(path, folder)| path.starts_with(folder)) {
            return Err(missing());
        }
        // Reading a pipe would block the connection for ever.
        let file = open_regular(&path).ok().flatten();
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let kind = match ending {
            "html" => "text/html; charset=utf-8",
            "svg" => "image/svg+xml",
            "json" => "application/json; charset=utf-8",
            "csv" | "toml" | "txt" | "jsonl" => "text/plain; charset=utf-8",
            _ => "application/octet-stream",
        };
        let answer = Answer::file(kind, file.ok_or_else(missing)?).map_err(failed)?;
        let policy = match ending {
            // A page of results runs no script; its links lead to other files here.
            "html" => Some(format!("{}; frame-ancestors 'none'", report::shell::content_policy())),
            "svg" => Some(POLICY_OF_DRAWING.to_owned()),
            _ => None,
        };
        Ok(Answer { policy, ..answer })
    }

    fn zip(&self, named: &str) -> Result<Answer, Problem> {
        let name = named.strip_suffix(".zip").unwrap_or(named);
        let folder = self.jobs.folder(name).filter(|folder| is_own(folder));
        let folder = folder.ok_or_else(|| missing("folder yet"))?;
        let packed = archive(&folder, name, &self.root).map_err(failed)?;
        let answer = Answer::file("application/zip", packed).map_err(failed)?;
        Ok(Answer { download: Some(format!("voidwalk-{name}.zip")), ..answer })
    }
}

fn pair_options(request: &Request) -> Result<PairOptions, Problem> {
    let changes: Vec<String> =
        request.parameter("changes").iter().flat_map(|all| all.lines().map(String::from)).collect();
    bounded(&changes)?;
    let as_given = request.parameter("as_given").is_some();
    TableOptions { as_given, changes, ..TableOptions::default() }.of_rules().map_err(wrong)
}

fn is_own(folder: &Path) -> bool {
    folder.symlink_metadata().is_ok_and(|meta| meta.is_dir())
}

fn malformed(error: serde_json::Error) -> Problem {
    (400, error.to_string())
}

fn table_options(asked: &AskedTables) -> Result<TableOptions, Problem> {
    let AskedTables { pack, quick, as_sampled, as_given, .. } = *asked;
    let named = |word| Density::named(word).ok_or_else(|| wrong(format!("density: {}", Density::WORDS)));
    let density = Some(&*asked.density).filter(|word| !word.is_empty()).map(named).transpose()?;
    bounded(&asked.changes)?;
    Ok(TableOptions { density, pack, quick, as_sampled, as_given, changes: asked.changes.clone() })
}

fn bounded(changes: &[String]) -> Result<(), Problem> {
    if changes.len() > SETTINGS.0 || changes.iter().any(|change| change.len() > SETTINGS.1) {
        return Err(wrong(format!("at most {} settings of {} characters", SETTINGS.0, SETTINGS.1)));
    }
    Ok(())
}

/// Every setting of a scene with its meaning, and the curves and filters shipped with the program.
fn form() -> Value {
    let key = |key: &KeyInfo| {
        json!({
            "section": key.section, "name": key.full_name(), "doc": key.doc, "shown": key.shown,
            "is_set": key.is_set,
        })
    };
    let keys: Vec<Value> = Scene::keys().iter().map(key).collect();
    let curves: Vec<Value> =
        shipped().iter().map(|curve| json!({ "name": curve.name, "title": curve.title })).collect();
    json!({ "keys": keys, "curves": curves, "densities": Density::ALL.map(Density::name) })
}

fn example(name: &str) -> Result<Answer, Problem> {
    let file = EXAMPLE_FILES.iter().find(|file| file.name == name).ok_or_else(|| missing("example"))?;
    Ok(Answer::new(200, "text/plain; charset=utf-8", file.text))
}

#[cfg(feature = "xlsx")]
fn template(path: &str) -> Result<Answer, Problem> {
    let bytes = report::soil_template().map_err(|error| (500, error.to_string()))?;
    let answer = Answer::new(200, "application/octet-stream", bytes);
    Ok(Answer { download: Some(path.into()), ..answer })
}

/// Packs the results in `folder` under `name`, into an unnamed file in `beside`. Leaves out checkpoints and
/// names that begin with a dot, and follows no link.
fn archive(folder: &Path, name: &str, beside: &Path) -> io::Result<File> {
    let mut writer = ZipWriter::new(tempfile::tempfile_in(beside)?);
    add(&mut writer, folder, name)?;
    let mut file = writer.finish().map_err(io::Error::other)?;
    file.rewind()?;
    Ok(file)
}

fn add(writer: &mut ZipWriter<File>, folder: &Path, name: &str) -> io::Result<()> {
    let mut entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let (file, kind) = (entry.file_name().to_string_lossy().into_owned(), entry.file_type()?);
        let inside = format!("{name}/{file}");
        if file.starts_with('.') || file == checkpoints::FOLDER {
            continue;
        }
        if kind.is_dir() {
            add(writer, &entry.path(), &inside)?;
        } else if kind.is_file()
            && let Some(mut content) = open_regular(&entry.path())?
        {
            let options =
                SimpleFileOptions::default().large_file(entry.metadata()?.len() > u64::from(u32::MAX));
            writer.start_file(inside, options).map_err(io::Error::other)?;
            io::copy(&mut content, writer)?;
        }
    }
    Ok(())
}
