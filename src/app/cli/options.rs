//! Options shared by several commands. Settings of a scene (`--joint-mm` is `filter.joint_mm`) have their
//! help, allowed values and errors from the table of settings.

use std::marker::PhantomData;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{NonEmptyStringValueParser, TypedValueParser, ValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use super::exit::FailOn;
use super::init::schema;
use crate::run::CheckpointInterval;
use crate::run::machine::bytes_from_words;
use crate::scene::{Density, Scene};
use voidwalk_core::constrictions::Facets;
use voidwalk_core::schema::length::{LENGTHS, millimetres};
use voidwalk_core::schema::{KeyInfo, Value, setting_name};
use voidwalk_core::store::format::FORMATS;

/// Settings of a command.
pub(crate) trait CommandSettings {
    /// Full names of the settings that have an option of their own.
    const OPTIONS: &'static [&'static str];
    /// Help of `--set`; `None` for a command without it.
    const SET: Option<&'static str>;
}

/// Settings of `run`, `check` and `judge`.
pub(crate) struct OfScene;

impl CommandSettings for OfScene {
    const OPTIONS: &'static [&'static str] = &[
        "seed",
        "stop.target_error_pp",
        "stop.decide_percent",
        "base.dispersive",
        "filter.joint_mm",
        "about.units",
    ];
    const SET: Option<&'static str> = Some("Replace a setting, for example --set base.cu=3; can be repeated");
}

/// Settings of `boundary`.
pub(crate) struct OfBoundary;

impl CommandSettings for OfBoundary {
    const OPTIONS: &'static [&'static str] = &["seed", "about.units"];
    const SET: Option<&'static str> = Some(
        "Replace a setting, for example --set filter.grains_per_void=0.43 or --set replicates=20; can be \
         repeated",
    );
}

/// Settings of `pack`.
pub(crate) struct OfPacking;

impl CommandSettings for OfPacking {
    const OPTIONS: &'static [&'static str] = &["packing.seed"];
    const SET: Option<&'static str> =
        Some("Replace a setting, for example --set packing.grains=20000; can be repeated");
}

/// Settings of `design`.
pub(crate) struct OfSpecification;

impl CommandSettings for OfSpecification {
    const OPTIONS: &'static [&'static str] = &["about.units", "base.dispersive"];
    const SET: Option<&'static str> =
        Some("State a fact on the page, for example --set about.project=\"Main dam\"; can be repeated");
}

/// Settings of `rules`.
pub(crate) struct OfRules;

impl CommandSettings for OfRules {
    const OPTIONS: &'static [&'static str] = &["base.dispersive", "filter.joint_mm"];
    const SET: Option<&'static str> = None;
}

/// Settings that the user of a command gave.
pub(crate) struct SettingOptions<C> {
    /// Assignments, each as `KEY=VALUE`.
    pub(crate) assignments: Vec<String>,
    command: PhantomData<C>,
}

impl<C: CommandSettings> Args for SettingOptions<C> {
    fn augment_args(command: Command) -> Command {
        let set = C::SET.map(|help| {
            let set = Arg::new(SET).long(SET).value_name("KEY=VALUE").action(ArgAction::Append);
            set.value_parser(assignment).help(help)
        });
        let all = Scene::keys();
        let key = |name: &&str| all.iter().find(|key| key.full_name() == *name).cloned();
        command.args(set).args(C::OPTIONS.iter().filter_map(key).map(option))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<C: CommandSettings> FromArgMatches for SettingOptions<C> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let set = C::SET.and_then(|_| matches.get_many::<String>(SET));
        let set: Vec<String> = set.into_iter().flatten().cloned().collect();
        let mut assignments = set.clone();
        for key in C::OPTIONS {
            let Some(value) = matches.get_one::<String>(key) else { continue };
            let is_this = |set: &&String| setting_name(set) == *key;
            if let Some(twice) = set.iter().find(is_this) {
                let option = option_name(key);
                let problem = format!("--{option} and --set {twice} say the same thing twice: give one\n");
                return Err(clap::Error::raw(ErrorKind::ArgumentConflict, problem));
            }
            assignments.push(format!("{key}={value}"));
        }
        Ok(Self { assignments, command: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

pub(super) const SET: &str = "set";

fn option_name(key: &str) -> String {
    key.rsplit('.').next().unwrap_or_default().replace('_', "-")
}

fn option(key: KeyInfo) -> Arg {
    let name = key.full_name();
    let option = Arg::new(name.clone()).long(option_name(&name)).action(ArgAction::Set);
    let option = match key.toml_type {
        "boolean" => {
            option.num_args(0..=1).require_equals(true).default_missing_value("true").value_name("BOOL")
        }
        "integer" => option.value_name("N").allow_hyphen_values(true),
        "float" => option.value_name("NUMBER").allow_hyphen_values(true),
        "float or string" => option.value_name("LENGTH").allow_hyphen_values(true),
        _ => option.value_name("WORD"),
    };
    option.help(format!("{} [{name}]", key.doc.trim_end_matches('.'))).value_parser(parser(key))
}

fn parser(key: KeyInfo) -> ValueParser {
    let (admits, allowed) = (key.admits, key.allowed);
    let checked = move |text: String| match admits(&Value::of_assignment(text.trim())) {
        true => Ok(text),
        false => Err(format!("write {allowed}")),
    };
    NonEmptyStringValueParser::new().try_map(checked).into()
}

#[derive(Args)]
pub(crate) struct WalkArgs {
    /// Worker threads; the result is the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub(crate) threads: Option<usize>,
    /// Save a checkpoint this often, such as 10min or 50increments; a stop (Ctrl-C, SIGTERM) always saves
    /// one [default: 10min; for a resumed run, its first setting]
    #[arg(long, value_name = "TIME")]
    pub(crate) checkpoint_every: Option<CheckpointInterval>,
    /// Print no progress and no summary
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Args)]
pub(crate) struct AcceptArgs {
    /// Exit with code 4 if the worse of practice and model is at least this bad: some or continuing erosion.
    /// Practice that is not met counts as some erosion, or as continuing if that is not excluded.
    /// Undecided counts as bad, as does practice that is not known. Results are written as usual
    #[arg(long, value_name = "VERDICT")]
    pub(crate) fail_on: Option<FailOn>,
}

#[derive(Args)]
pub(crate) struct ResultArgs {
    /// Folder for the results: new, empty, or made by voidwalk [default: the first free of voidwalk-run,
    /// voidwalk-run-2, ...]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace the results of an earlier run in --out
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Write verdict.xlsx, too: verdict, inputs, rules, runs, gradations, provenance
    #[cfg(feature = "xlsx")]
    #[arg(long)]
    pub(crate) xlsx: bool,
    #[command(flatten)]
    pub(crate) accept: AcceptArgs,
    #[command(flatten)]
    pub(crate) walk: WalkArgs,
}

#[derive(Args)]
pub(crate) struct SceneArgs {
    /// Scene (TOML), for check also the plan of a campaign [default: the built-in scene, a loose filter of Cu
    /// 1.5 and a base of Cu 1.5 at Dc5]
    pub(crate) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: SettingArgs,
}

#[derive(Args)]
pub(crate) struct SettingArgs {
    #[command(flatten)]
    pub(crate) settings: SettingOptions<OfScene>,
    /// Folder that keeps packings, so that each is made once
    #[arg(long, value_name = "DIR", default_value = "voidwalk-packings")]
    pub(crate) packings: PathBuf,
    /// Memory limit, such as 4GB: base particles beyond it are kept in mapped files in the run folder; the
    /// result is the same [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE", value_parser = bytes_from_words, allow_hyphen_values = true)]
    pub(crate) memory: Option<u64>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

fn assignment(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((name, _)) if !name.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("write KEY=VALUE, as --set filter.cu=3".into()),
    }
}

/// Parses the density of a filter. A number could be a void ratio, a relative density or a friction.
pub(super) fn density(text: &str) -> Result<Density, String> {
    Density::named(text).ok_or_else(|| {
        "write loose, medium (or intermediate) or dense; the friction between grains while they are \
         compressed is a number: --set filter.friction=0.2"
            .into()
    })
}

pub(super) const FACETS: [(&str, Facets); 2] = [("all", Facets::All), ("on-both-hulls", Facets::OnBothHulls)];

pub(super) fn facets(text: &str) -> Result<Facets, String> {
    let named = FACETS.iter().find(|(word, _)| *word == text);
    named.map(|(_, facets)| *facets).ok_or_else(|| FACETS.map(|(word, _)| word).join(" or "))
}

pub(super) fn lattice_size(text: &str) -> Result<[u32; 3], String> {
    let length = |text: &str| text.trim().parse().ok().filter(|&voids| voids > 0);
    let lengths: Option<Vec<u32>> = text.split('x').map(length).collect();
    match lengths.as_deref() {
        Some(&[size]) => Ok([size; 3]),
        Some(&[nx, ny, nz]) => Ok([nx, ny, nz]),
        _ => Err("write a whole number of voids above 0, or three as 40x40x60".into()),
    }
}

pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.trim().parse().map_err(|_| format!("write a whole number from 0 to {}", u64::MAX))
}

pub(super) fn schema_of(text: &str) -> Result<String, String> {
    let names: Vec<&str> = FORMATS.iter().map(|form| form.name()).collect();
    schema(text).ok_or_else(|| format!("one of {}", names.join(", ")))
}

pub(super) fn threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number| (1..=1024).contains(number));
    number.ok_or_else(|| "write a whole number from 1 to 1024".into())
}

pub(super) fn time(text: &str) -> Result<Duration, String> {
    humantime::parse_duration(text).map_err(|e| format!("{e}; write a time as 30s, 4min or 1h"))
}

/// Parses a length above 0 (mm).
pub(super) fn length(text: &str) -> Result<f64, String> {
    millimetres(text).ok_or_else(|| format!("write {LENGTHS}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<C: CommandSettings>(words: &[&str]) -> Result<Vec<String>, clap::Error> {
        let command = SettingOptions::<C>::augment_args(Command::new("x").no_binary_name(true));
        let matches = command.try_get_matches_from(words)?;
        SettingOptions::<C>::from_arg_matches(&matches).map(|options| options.assignments)
    }

    #[test]
    fn every_option_is_a_setting() {
        let all: Vec<String> = Scene::keys().iter().map(KeyInfo::full_name).collect();
        let named = [
            OfScene::OPTIONS,
            OfBoundary::OPTIONS,
            OfPacking::OPTIONS,
            OfSpecification::OPTIONS,
            OfRules::OPTIONS,
        ];
        assert!(named.concat().iter().all(|name| all.iter().any(|key| key == name)));
    }

    #[test]
    fn options_become_settings() {
        let words = ["--set", "base.cu=2", "--seed", "3", "--dispersive", "--joint-mm", "1/8in"];
        let settings = ["base.cu=2", "seed=3", "base.dispersive=true", "filter.joint_mm=1/8in"];
        assert_eq!(read::<OfScene>(&words).unwrap(), settings);
        assert_eq!(read::<OfRules>(&["--dispersive=false"]).unwrap(), ["base.dispersive=false"]);
        assert!(read::<OfRules>(&["--set", "base.cu=2"]).is_err());
    }

    #[test]
    fn values_are_checked_as_the_setting_is() {
        for (words, allowed) in [
            (["--seed", "-1"], "a whole number from 0 to 18446744073709551615"),
            (["--decide-percent", "150"], "a probability from 50 to 99.999"),
            (["--target-error-pp", "0"], "above 0 and below 100"),
            (["--joint-mm", "2 furlongs"], "3/8in"),
            (["--units", "yards"], "\"us\""),
        ] {
            let problem = read::<OfScene>(&words).unwrap_err().to_string();
            assert!(problem.contains(words[0]) && problem.contains(allowed), "{problem}");
        }
    }

    #[test]
    fn a_setting_that_is_given_twice_is_refused() {
        let problem = read::<OfScene>(&["--seed", "3", "--set", " seed = 4"]).unwrap_err().to_string();
        let wanted = "--seed and --set  seed = 4 say the same thing twice: give one";
        assert!(problem.contains(wanted), "{problem}");
    }

    #[test]
    fn values_are_read_or_refused() {
        assert!(seed("-1").is_err() && seed("18446744073709551615") == Ok(u64::MAX));
        assert!(assignment("filter.cu").is_err() && assignment("=3").is_err() && assignment("a=").is_ok());
    }
}
