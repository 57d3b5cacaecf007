//! Options of the command line that are settings of a scene: `--joint-mm` is `filter.joint_mm`. Help, allowed
//! values and errors come from the table of settings.

use std::fmt;
use std::marker::PhantomData;

use clap::builder::{NonEmptyStringValueParser, TypedValueParser, ValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use super::values::assignment;
use crate::scene::Scene;
use voidwalk_core::schema::{KeyInfo, Value, setting_name};

/// The settings of a command.
pub trait CommandSettings {
    /// Full names of the settings that have an option of their own.
    const OPTIONS: &'static [&'static str];

    /// Help of `--set`; `None` for a command without it.
    const SET: Option<&'static str>;
}

/// Settings of `run`, `check` and `judge`.
#[derive(Debug)]
pub enum OfScene {}

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
#[derive(Debug)]
pub enum OfBoundary {}

impl CommandSettings for OfBoundary {
    const OPTIONS: &'static [&'static str] = &["seed", "about.units"];
    const SET: Option<&'static str> = Some(
        "Replace a setting, for example --set filter.grains_per_void=0.43 or --set replicates=20; can be \
         repeated",
    );
}

/// Settings of `pack`.
#[derive(Debug)]
pub enum OfPacking {}

impl CommandSettings for OfPacking {
    const OPTIONS: &'static [&'static str] = &["packing.seed"];
    const SET: Option<&'static str> =
        Some("Replace a setting, for example --set packing.grains=20000; can be repeated");
}

/// Settings of `design`.
#[derive(Debug)]
pub enum OfSpecification {}

impl CommandSettings for OfSpecification {
    const OPTIONS: &'static [&'static str] = &["about.units", "base.dispersive"];
    const SET: Option<&'static str> =
        Some("What the page says of itself, for example --set about.project=\"Main dam\"; can be repeated");
}

/// Settings of `rules`.
#[derive(Debug)]
pub enum OfRules {}

impl CommandSettings for OfRules {
    const OPTIONS: &'static [&'static str] = &["base.dispersive", "filter.joint_mm"];
    const SET: Option<&'static str> = None;
}

/// The settings that a command line gives, by `--set` and by options of their own.
pub struct SettingOptions<C> {
    /// `KEY=VALUE` each.
    pub assignments: Vec<String>,
    command: PhantomData<C>,
}

impl<C> fmt::Debug for SettingOptions<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SettingOptions").field(&self.assignments).finish()
    }
}

impl<C: CommandSettings> Args for SettingOptions<C> {
    fn augment_args(command: Command) -> Command {
        let set = C::SET.map(|help| {
            let set = Arg::new(SET).long(SET).value_name("KEY=VALUE").action(ArgAction::Append);
            set.value_parser(assignment).help(help)
        });
        command.args(set).args(keys::<C>().map(option))
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

/// The name of `--set`.
pub(super) const SET: &str = "set";

/// The option of a setting, without its dashes.
pub(super) fn option_name(key: &str) -> String {
    key.rsplit('.').next().unwrap_or_default().replace('_', "-")
}

fn keys<C: CommandSettings>() -> impl Iterator<Item = KeyInfo> {
    let all = Scene::keys();
    C::OPTIONS.iter().filter_map(move |name| all.iter().find(|key| key.full_name() == *name).cloned())
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
        assert_eq!(
            read::<OfScene>(&words).unwrap(),
            ["base.cu=2", "seed=3", "base.dispersive=true", "filter.joint_mm=1/8in"]
        );
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
}
