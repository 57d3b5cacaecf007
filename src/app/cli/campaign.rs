//! Command `voidwalk campaign`: the cases of a plan, walked by any number of processes in one folder.

use super::args::CampaignArgs;
use super::print::{self, grains_per_void, percent, plain, shown, to_copy, to_stdout};
use super::progress::{followed, followed_cases, unfollowed};
use super::run::{START, command_line};
use crate::cases;
use crate::cases::{CaseCallbacks, CaseOptions, CasePart, CasePlan, JobOptions, Mount, WrittenJobs};
use crate::outcome::ledger;
use crate::outcome::ledger::LedgerLine;
use crate::outcome::record::Verdict;
use crate::run::RunError;
use crate::run::cost::duration;
use crate::run::machine::Allocation;
use crate::words::ledger::thickness as thickness_words;
use crate::words::left_out::left_out_line;
use std::path::Path;

const SHOWN: usize = 20;

impl CampaignArgs {
    fn options(&self) -> CaseOptions {
        CaseOptions {
            out: self.out.clone(),
            part: match (&self.case, &self.task) {
                (Some(name), _) => CasePart::Named(name.clone()),
                (None, task) => task.clone().unwrap_or_default(),
            },
            packings: self.packings.clone(),
            memory: self.memory,
            threads: self.walk.threads,
            checkpoint_interval: self.walk.checkpoint_every.unwrap_or_default(),
            command: command_line(),
        }
    }
}

pub(crate) fn campaign(args: &CampaignArgs) -> Result<(), RunError> {
    let (plan, options, quiet) = (CasePlan::read(&args.plan)?, args.options(), args.walk.quiet);
    if args.list {
        let names = cases::names(&plan, &options.part)?;
        to_stdout(&print::lines(names));
        return Ok(());
    }
    if args.slurm {
        return write_scripts(args, &plan, &options);
    }
    if let Some(number) = args.make_packing {
        return followed(quiet, |run| cases::make_packing(&plan, number, &options, run));
    }
    let (lines, problem) = if args.collect {
        (Some(cases::collect(&plan, &options, &unfollowed())?), None)
    } else {
        let walk = |callbacks: &CaseCallbacks| cases::run(&plan, &options, callbacks);
        let finished = followed_cases(quiet, Allocation::here().is_some(), walk)?;
        let problem = finished.problem();
        (finished.lines, problem)
    };
    if let Some(lines) = lines.filter(|_| !quiet) {
        to_stdout(&words(&lines, &args.out));
    }
    problem.map_or(Ok(()), Err)
}

fn words(ledger: &[LedgerLine], out: &Path) -> String {
    let mut text = String::new();
    let mut line = |s: String| text += &(s + "\n");
    for verdict in [Verdict::None, Verdict::Some, Verdict::Continuing, Verdict::Undecided] {
        let count = ledger.iter().filter(|case| case.verdict == verdict).count();
        if count > 0 {
            line(format!("{count:>5}  {}", verdict.words()));
        }
    }
    for case in ledger.iter().filter(|_| ledger.len() <= SHOWN) {
        let eroded = case.runs.iter().map(|run| percent(run.eroded_mass_fraction.mean).to_string());
        let eroded = eroded.collect::<Vec<_>>().join(" then ");
        let (name, verdict) = (plain(&case.case), case.verdict.words());
        line(format!("{name}: {verdict}, {eroded} of the mass eroded"));
        line(format!("  {}; {}", thickness(case), grains_per_void(case.grains_per_void)));
    }
    if ledger.len() > SHOWN {
        let same = ledger.iter().all(|case| case.thickness == ledger[0].thickness);
        line(if same { thickness(&ledger[0]) } else { "modelled filter thickness: see cases.csv".into() });
    }
    line(left_out_line(&ledger::leaves_out(ledger)));
    let seconds: f64 = ledger.iter().map(|case| case.made.seconds).sum();
    let page = shown(&out.join("report.html"));
    let time = format!("{seconds:.1} s from start to end of each, beside other cases");
    line(format!("{} cases, {time}; report: {page}", ledger.len()));
    text
}

fn thickness(line: &LedgerLine) -> String {
    format!("modelled filter thickness: {}", thickness_words(&line.thickness))
}

fn write_scripts(args: &CampaignArgs, plan: &CasePlan, options: &CaseOptions) -> Result<(), RunError> {
    let (program, words) = match START.get().and_then(|start| start.again.as_deref()) {
        Some([program, words @ ..]) => (program.into(), words.to_vec()),
        _ => (std::env::current_exe().map_err(RunError::failed)?, Vec::new()),
    };
    let jobs = JobOptions { program, words, plan: args.plan.clone(), tasks: args.tasks.map(usize::from) };
    let written = cases::write_job_scripts(plan, options, &jobs)?;
    if let Some(doubt) = written.mount.as_ref().and_then(doubt) {
        (unfollowed().warn)(&doubt);
    }
    to_stdout(&jobs_in_words(&written));
    Ok(())
}

fn jobs_in_words(jobs: &WrittenJobs) -> String {
    if jobs.cases == 0 {
        return format!(
            "All {} cases are done: --collect instead of --slurm writes the ledger and the page\n",
            jobs.done
        );
    }
    let mut lines = Vec::new();
    if jobs.done > 0 {
        lines.push(format!("{} cases are done already", jobs.done));
    }
    let (packings, largest) = jobs.packings;
    if packings > 0 {
        let longest = duration(largest.seconds);
        lines.push(format!("{packings} packings first, the longest about {longest}"));
    }
    lines.push(format!(
        "{} cases in {} tasks, the longest about {}; requested per task: processors {}, memory {} MB, \
         time {} min",
        jobs.cases,
        jobs.tasks,
        duration(jobs.walk.seconds),
        jobs.processors,
        jobs.walk.megabytes(),
        jobs.walk.minutes()
    ));
    lines.push("Submit them (options of sbatch may follow, as --partition=NAME):".into());
    lines.push(format!("  sh {}", to_copy(&jobs.submit)));
    print::lines(lines)
}

/// Warning about the file locks of a mount; `None` if they work across nodes.
fn doubt(mount: &Mount) -> Option<String> {
    let one_node = "locks hold on one node only";
    let why = match mount.kind.as_str() {
        "nfs" | "nfs4" if mount.has("nolock") => format!("it is mounted with `nolock`: {one_node}"),
        "nfs" | "nfs4" if mount.has("local_lock=all") || mount.has("local_lock=flock") => {
            format!("it is mounted with `local_lock`: {one_node}")
        }
        "lustre" if mount.has("localflock") => format!("it is mounted with `localflock`: {one_node}"),
        "lustre" if !mount.has("flock") => "it is mounted without `flock`: there are no locks".to_owned(),
        "beegfs" => {
            format!("unless `tuneUseGlobalFileLocks = true` is set in its client's configuration, {one_node}")
        }
        "cifs" | "smb3" if mount.has("nobrl") => format!("it is mounted with `nobrl`: {one_node}"),
        "fuse.sshfs" | "9p" => one_node.to_owned(),
        "tmpfs" | "overlay" | "ramfs" => "it is this machine's own: other nodes do not see it".to_owned(),
        _ => return None,
    };
    Some(format!("this folder lies on {} ({}): {why}", mount.kind, mount.point.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOUNTS: &str = "22 1 8:1 / / rw,relatime shared:1 - ext4 /dev/sda1 rw\n\
        40 22 0:40 / /home rw shared:2 - nfs4 server:/home rw,vers=4.2,local_lock=none,addr=10.0.0.1\n\
        41 22 0:41 / /old rw - nfs server:/old rw,vers=3,nolock,local_lock=all\n\
        42 22 0:42 / /scratch/a\\040b rw - lustre 10.0.0.2@tcp:/s rw,checksum,localflock\n\
        43 22 0:43 / /scratch/c rw - lustre 10.0.0.2@tcp:/s rw,flock,lazystatfs\n\
        44 22 0:44 / /scratch/d rw - lustre 10.0.0.2@tcp:/s rw\n\
        45 22 0:45 / /bee rw - beegfs beegfs_nodev rw\n\
        46 22 0:46 / /tmp rw - tmpfs tmpfs rw\n\
        47 22 0:47 / /gpfs rw - gpfs gpfs0 rw\n";

    #[test]
    fn mounts_whose_locks_reach_one_node_are_named() {
        let doubt = |path: &str| doubt(&Mount::of(Path::new(path), MOUNTS).unwrap());
        for path in ["/home/x/campaign", "/srv/x", "/scratch/c/x", "/gpfs/x", "/homely"] {
            assert_eq!(doubt(path), None, "{path}");
        }
        for (path, words) in [
            ("/old/x", "`nolock`"),
            ("/scratch/a b/x", "`localflock`"),
            ("/scratch/d", "without `flock`"),
            ("/bee/x", "tuneUseGlobalFileLocks"),
            ("/tmp/x", "other nodes do not see it"),
        ] {
            let warning = doubt(path).unwrap();
            assert!(warning.contains(words), "{path}: {warning}");
        }
    }
}
