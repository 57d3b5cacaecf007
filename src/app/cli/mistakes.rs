//! Guesses at the meaning of command lines that are not understood.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::Command;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use strsim::damerau_levenshtein;

use super::print::to_copy;
use crate::scene::Scene;
use voidwalk_core::schema::KeyInfo;

/// Maximum number of files in a folder that are searched for a name similar to a missing one.
const FILES: usize = 1000;

pub(crate) fn explained(mut error: clap::Error, command: &Command, words: &[OsString]) -> clap::Error {
    let words: Vec<String> = words.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    let tip = match error.kind() {
        ErrorKind::InvalidSubcommand => {
            text(ContextKind::InvalidSubcommand).and_then(|name| instead_of_command(&name, command))
        }
        ErrorKind::UnknownArgument => {
            text(ContextKind::InvalidArg).and_then(|name| instead_of_argument(&name, command, &words))
        }
        ErrorKind::MissingRequiredArgument => two_tables(&words),
        _ => None,
    };
    if let Some(tip) = tip {
        error.remove(ContextKind::SuggestedArg);
        error.remove(ContextKind::SuggestedSubcommand);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(tip)]));
    }
    error
}

fn instead_of_command(name: &str, command: &Command) -> Option<String> {
    if is_table(name) {
        return Some(JUDGE.into());
    }
    if name.ends_with(".toml") {
        return Some(format!("to walk a scene: voidwalk run {}", to_copy(name)));
    }
    let known = command.get_subcommands().map(Command::get_name);
    let (distance, nearest) = known.map(|known| (damerau_levenshtein(known, name), known)).min()?;
    let like = distance <= 1.max(name.chars().count() / 3);
    let all = "all commands: voidwalk help; to begin with, type `voidwalk` alone";
    Some(if like { format!("did you mean `voidwalk {nearest}`?") } else { all.into() })
}

const JUDGE: &str = "two sieve tables are judged by: voidwalk judge BASE FILTER (the base first)";

fn instead_of_argument(name: &str, command: &Command, words: &[String]) -> Option<String> {
    let used = words.get(1).and_then(|word| command.find_subcommand(word))?;
    let walks = ["run", "check"].contains(&used.get_name());
    if let Some(flag) = name.strip_prefix("--") {
        if walks && ["base", "filter"].contains(&flag) {
            return Some(JUDGE.into());
        }
        // Settings of a specification affect only its page.
        let is_walked = used.get_name() != "design";
        let takes_settings = is_walked && used.get_arguments().any(|arg| arg.get_long() == Some("set"));
        return takes_settings.then(|| as_setting(name, words)).flatten();
    }
    unquoted(words).or_else(|| if walks { two_tables(words) } else { None })
}

fn as_setting(flag: &str, words: &[String]) -> Option<String> {
    let name = flag.trim_start_matches('-').replace('-', "_");
    let known: Vec<String> = Scene::keys().iter().map(KeyInfo::full_name).collect();
    let last = |known: &String| known.rsplit('.').next().unwrap_or_default().to_owned();
    let is_meant = |known: &&String| **known == name || last(known) == name;
    let mut meant: Vec<&String> = known.iter().filter(is_meant).collect();
    if meant.is_empty() {
        let distance = |known: &&String| damerau_levenshtein(&last(known), &name);
        let nearest = known.iter().min_by_key(distance)?;
        if distance(&nearest) > name.chars().count() / 4 {
            return None;
        }
        meant.push(nearest);
    }
    let given = words.iter().position(|word| word.split('=').next() == Some(flag));
    let value = given.and_then(|at| match words[at].split_once('=') {
        Some((_, value)) => Some(value),
        None => words.get(at + 1).map(String::as_str).filter(|next| !next.starts_with("--")),
    });
    let value = value.unwrap_or("VALUE");
    let set: Vec<String> =
        meant.iter().map(|key| format!("--set {}", to_copy(format!("{key}={value}")))).collect();
    Some(format!("a setting of the scene: {}", set.join(" or ")))
}

fn two_tables(words: &[String]) -> Option<String> {
    let tables: Vec<&String> = words.iter().skip(2).filter(|word| is_table(word)).collect();
    match tables[..] {
        [first, second] => {
            let [first, second] = [first, second].map(to_copy);
            Some(format!("two sieve tables are judged by: voidwalk judge {first} {second} (the base first)"))
        }
        [_] if words.get(1).is_some_and(|command| command == "judge") => Some(JUDGE.into()),
        _ => None,
    }
}

fn is_table(word: &str) -> bool {
    let path = word.split('#').next().unwrap_or_default().to_lowercase();
    [".csv", ".xlsx", ".ods", ".ags"].iter().any(|ending| path.ends_with(ending))
}

/// Hint at a file that may be meant if something is refused: one whose name contains a space, so that the
/// shell took it for two words; or, if a file is missing, one with a similar name.
pub(crate) fn instead_of_files(words: &[OsString], is_missing: bool) -> Option<String> {
    let words: Vec<String> = words.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    unquoted(&words).or_else(|| if is_missing { misspelt_file(&words) } else { None })
}

/// Words that together are the name of one file; the first may follow `key=`.
fn unquoted(words: &[String]) -> Option<String> {
    for (at, first) in words.iter().enumerate().skip(1) {
        let (key, begin) =
            first.rsplit_once('=').map_or((None, first.as_str()), |(key, path)| (Some(key), path));
        let mut name = begin.to_owned();
        for next in words.iter().skip(at + 1).take(4) {
            name = format!("{name} {next}");
            let file = name.split('#').next().unwrap_or_default();
            if Path::new(file).is_file() && !Path::new(begin).exists() {
                let word = key.map_or(name.clone(), |key| format!("{key}={name}"));
                return Some(format!("a name with a space is one word in quotes: {}", to_copy(word)));
            }
        }
    }
    None
}

/// File that a word names, after `key=` and before the `#NAME` of a soil.
fn named(word: &str) -> PathBuf {
    let path = word.split_once('=').map_or(word, |(_, value)| value);
    PathBuf::from(path.split('#').next().unwrap_or_default())
}

fn misspelt_file(words: &[String]) -> Option<String> {
    let written = |word: &String| ["--out", "--figure", "--packings"].contains(&word.as_str());
    let pairs = words.iter().zip(words.iter().skip(1)).filter(|(before, _)| !written(before));
    let missing =
        pairs.map(|(_, word)| named(word)).filter(|path| path.extension().is_some() && !path.exists());
    missing.into_iter().find_map(|path| nearest_beside(&path))
}

fn nearest_beside(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let files = std::fs::read_dir(folder).ok()?.take(FILES).flatten();
    let names = files.filter_map(|file| file.file_name().into_string().ok());
    let like = names.map(|other| (damerau_levenshtein(&other, name), other)).min()?;
    (like.0 <= 2 && like.0 * 3 < name.chars().count())
        .then(|| format!("did you mean `{}`?", to_copy(path.with_file_name(&like.1))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> Vec<String> {
        line.split(' ').map(String::from).collect()
    }

    #[test]
    fn a_flag_that_names_a_setting_is_set() {
        for (line, wanted) in [
            ("voidwalk run --replicates 3", "a setting of the scene: --set replicates=3"),
            ("voidwalk run --replicates=3", "a setting of the scene: --set replicates=3"),
            ("voidwalk run --cu 3", "a setting of the scene: --set filter.cu=3 or --set base.cu=3"),
            ("voidwalk run --base.cu", "a setting of the scene: --set base.cu=VALUE"),
            (
                "voidwalk run --grains-per-void 0.4",
                "a setting of the scene: --set filter.grains_per_void=0.4",
            ),
            ("voidwalk run --replicate 3", "a setting of the scene: --set replicates=3"),
        ] {
            let words = words(line);
            let flag = words[2].split('=').next().unwrap();
            assert_eq!(as_setting(flag, &words).as_deref(), Some(wanted), "{line}");
        }
        assert_eq!(as_setting("--colour", &words("voidwalk run --colour red")), None);
    }

    #[test]
    fn commands_and_tables_are_known() {
        let command = super::super::help::command();
        let hint = |name: &str| instead_of_command(name, &command).unwrap();
        assert_eq!(hint("rnu"), "did you mean `voidwalk run`?");
        assert_eq!(hint("jugde"), "did you mean `voidwalk judge`?");
        assert_eq!(hint("dam.toml"), "to walk a scene: voidwalk run dam.toml");
        assert!(hint("sand.csv").contains("voidwalk judge BASE FILTER"));
        assert!(hint("frobnicate").contains("voidwalk help"));
        let tables = |line: &str| two_tables(&words(line));
        assert!(tables("voidwalk run a.csv b.xlsx#One").unwrap().contains("judge a.csv 'b.xlsx#One'"));
        assert_eq!(tables("voidwalk run a.csv"), None);
    }
}
