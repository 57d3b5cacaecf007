//! `voidwalk pack`, and the packing that a scene asks for.

use std::cell::Cell;
use std::io::IsTerminal;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use super::Exit;
use super::args::PackArgs;
use super::print::{count, plain, to_stderr, to_stdout};
use super::run::{pool, refuse_other_kinds, refused_or_failed};
use super::signals::stop_on_signals;
use crate::case::{PackedError, PackedFilter, PackingPlan, RECORD};
use crate::outcome::packing::PackingRecord;
use crate::packing::{CompressionProgress, PackingError, Stage};
use crate::report;
use crate::run::pack::{PackCallbacks, PackError, STATES, make};
use crate::scene::Scene;
use crate::store::checkpoint::CheckpointError;
use crate::store::{Folder, StoreError};

/// How often a packing that a scene asks for keeps its state.
const KEEP_EVERY: Duration = Duration::from_secs(60);

/// How often a packing that another process makes is looked for.
const LOOK: Duration = Duration::from_millis(500);

/// Packs a filter into a folder.
pub fn pack(args: &PackArgs) -> Result<(), Exit> {
    let mut settings = args.settings.clone();
    settings.extend(args.seed.map(|seed| format!("packing.seed={seed}")));
    let recipe = Scene::read_packing(&args.filter, &settings).map_err(Exit::refused)?;
    let order = PackingPlan::new(&recipe).map_err(Exit::refused)?;
    let stop = stop_on_signals()?;
    let out = args.out.clone().unwrap_or_else(|| Path::new("voidwalk-packings").join(order.folder_name()));
    let folder = Folder::open(&out).map_err(refused_or_failed)?;
    refuse_other_kinds(&folder, "packing")?;
    // With a state beside it, whoever wrote the record was killed before all was done.
    let finished = folder.has(RECORD) && !STATES.iter().any(|state| folder.has(state));
    if finished && !args.overwrite {
        let problem =
            format!("{}: holds a packing already; name another folder or add --overwrite", out.display());
        return Err(Exit::refused(plain(&problem)));
    }
    if args.overwrite {
        for name in [
            RECORD,
            STATES[0],
            STATES[1],
            "report.html",
            "grains.csv",
            "grains.vtp",
            "constrictions.csv",
            "constrictions.json",
            "constrictions.vtp",
        ] {
            folder.remove(name).map_err(Exit::failed)?;
        }
    }
    pool(args.threads)?.install(|| packed(&folder, &order, args.quiet, &stop, args.checkpoint_every))?;
    let text = folder.read(RECORD).map_err(Exit::failed)?.unwrap_or_default();
    if args.json {
        to_stdout(&String::from_utf8_lossy(&text));
    } else if !args.quiet {
        let record: PackingRecord = serde_json::from_slice(&text).map_err(Exit::failed)?;
        let filter = read(&out, &order)?.ok_or_else(|| Exit::failed("the packing is gone"))?;
        to_stdout(&summary(&record, &filter, &out));
    }
    Ok(())
}

/// The packing of a scene's filter: taken from where packings are kept, or made and kept there.
pub fn provide(
    order: &PackingPlan,
    packings: &Path,
    quiet: bool,
    stop: &AtomicBool,
) -> Result<PackedFilter, Exit> {
    let path = packings.join(order.folder_name());
    if let Some(filter) = read(&path, order)? {
        return Ok(filter);
    }
    let mut waiting = false;
    let folder = loop {
        match Folder::open(&path) {
            // Another process makes the same packing: it is taken from there.
            Err(StoreError::Held { holder, .. }) => {
                if stop.load(Ordering::Relaxed) {
                    return Err(Exit::stopped(
                        "while another process made the packing; the same command goes on",
                    ));
                }
                if !waiting && !quiet {
                    let shown = path.display().to_string();
                    to_stderr(&format!(
                        "waiting for the packing in {} ({})\n",
                        plain(&shown),
                        plain(&holder)
                    ));
                }
                waiting = true;
                std::thread::sleep(LOOK);
            }
            other => break other.map_err(refused_or_failed)?,
        }
    };
    if !folder.has(RECORD) {
        packed(&folder, order, quiet, stop, KEEP_EVERY)?;
    }
    read(&path, order)?.ok_or_else(|| Exit::failed(format!("{}: the packing is gone", path.display())))
}

/// A finished packing, or none.
pub fn read(path: &Path, order: &PackingPlan) -> Result<Option<PackedFilter>, Exit> {
    PackedFilter::read(path, order).map_err(|error| match error {
        PackedError::Read(error) => refused_or_failed(error),
        other => Exit::refused(plain(&other.to_string())),
    })
}

fn packed(
    folder: &Folder,
    order: &PackingPlan,
    quiet: bool,
    stop: &AtomicBool,
    keep_every: Duration,
) -> Result<(), Exit> {
    let shown = Shown::new(quiet, order);
    let warn = |error: &CheckpointError| {
        to_stderr(&format!("warning: {}; the checkpoint before it was taken\n", plain(&error.to_string())));
    };
    let watch = PackCallbacks { tell: &|progress| shown.tell(progress), warn: &warn, stop, keep_every };
    let result = make(folder, order, &watch);
    shown.finish();
    let path = folder.path().display();
    result.map_err(|error| match error {
        PackError::Stopped(steps) => Exit::stopped(plain(&format!(
            "after {} steps of the packing; the same command goes on from {path}",
            count(steps)
        ))),
        PackError::State { .. } | PackError::Packing(PackingError::Setting { .. }) => {
            Exit::refused(plain(&error.to_string()))
        }
        PackError::Packing(problem @ (PackingError::NarrowCell { .. } | PackingError::Placement { .. })) => {
            Exit::refused(problem)
        }
        other => Exit::failed(plain(&other.to_string())),
    })?;
    report::write_packing(folder.path()).map_err(Exit::failed)?;
    Ok(())
}

/// Progress of a compression on stderr.
struct Shown {
    how: How,
    begun: Instant,
    /// Steps that packings of this friction took (`results/filters-2026-11-21.md`).
    usual: u64,
    /// Steps done when this start of the program began.
    first: Cell<Option<u64>>,
}

enum How {
    Quiet,
    Bar(ProgressBar),
    Lines { last: Cell<Instant> },
}

impl Shown {
    fn new(quiet: bool, order: &PackingPlan) -> Self {
        let begun = Instant::now();
        let usual = match order.compression.friction {
            0.0 => 50_000,
            friction if friction <= 0.5 => 30_000,
            _ => 95_000,
        };
        let mut shown = Self { how: How::Quiet, begun, usual, first: Cell::new(None) };
        if quiet {
            return shown;
        }
        to_stderr(&format!(
            "packing {} grains ({}), friction {}: about {} steps\n",
            count(order.compression.grains as u64),
            plain(&order.name),
            order.compression.friction,
            count(usual)
        ));
        shown.how = if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new_spinner();
            bar.enable_steady_tick(Duration::from_millis(200));
            How::Bar(bar)
        } else {
            How::Lines { last: Cell::new(begun) }
        };
        shown
    }

    fn tell(&self, progress: &CompressionProgress) {
        if self.first.get().is_none() {
            self.first.set(Some(progress.steps));
        }
        match &self.how {
            How::Quiet => {}
            How::Bar(bar) => bar.set_message(self.line(progress)),
            How::Lines { last } => {
                if last.get().elapsed() >= Duration::from_secs(5) {
                    last.set(Instant::now());
                    to_stderr(&(self.line(progress) + "\n"));
                }
            }
        }
    }

    fn line(&self, progress: &CompressionProgress) -> String {
        let stage = match progress.stage {
            Stage::Squeeze => "squeeze",
            Stage::Compress => "compress",
            Stage::Settle => "settle with the final friction",
            Stage::Done => "done",
        };
        let seconds = self.begun.elapsed().as_secs_f64();
        let here = progress.steps - self.first.get().unwrap_or(0);
        let left = match self.usual.checked_sub(progress.steps) {
            Some(steps) if here > 0 => {
                format!("about {:.0} s to go if it is like others", steps as f64 * seconds / here as f64)
            }
            Some(_) => "time to go not known yet".to_string(),
            None => "longer than most".to_string(),
        };
        format!(
            "{stage}: {} steps, void ratio {:.4}, pressure {:.3} of the target, coordination {:.2}, unbalanced {:.3}, \
             {seconds:.0} s gone, {left}",
            count(progress.steps),
            progress.void_ratio,
            progress.pressure,
            progress.coordination,
            progress.unbalanced,
        )
    }

    fn finish(&self) {
        if let How::Bar(bar) = &self.how {
            bar.finish_and_clear();
        }
    }
}

fn summary(record: &PackingRecord, filter: &PackedFilter, out: &Path) -> String {
    let change = match record.friction == record.final_friction {
        true => String::new(),
        false => {
            format!(" ({:.4} before friction {} was set)", record.before.void_ratio, record.final_friction)
        }
    };
    let lines = [
        format!("Void ratio {:.4}{change} at {:.2} kPa", record.after.void_ratio, record.after.pressure_kpa),
        format!(
            "  {} grains, coordination {:.2} ({:.2} without the {:.1} % rattlers), {} steps",
            count(record.grains),
            record.after.coordination,
            record.after.coordination_held,
            100.0 * record.after.rattlers,
            count(record.steps)
        ),
        format!(
            "  Cu_CSD {:.3}, Dc5 {:.4} mm, Dc50 {:.4} mm, {:.3} grains per void (Eq. 2)",
            filter.curve.cu(),
            filter.curve.dc(5.0).unwrap_or(f64::NAN),
            filter.curve.dc(50.0).unwrap_or(f64::NAN),
            filter.grains_per_void
        ),
        format!("{:.1} s; report: {}", record.seconds, out.join("report.html").display()),
        format!("for a scene: filter.curve = \"{}\"", out.join("constrictions.csv").display()),
    ];
    lines.iter().map(|line| plain(line) + "\n").collect()
}
