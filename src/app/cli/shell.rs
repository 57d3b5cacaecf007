//! Commands `voidwalk completions` and `voidwalk man`: descriptions of the program for a shell and for `man`.

use std::path::Path;

use clap::builder::PossibleValuesParser;
use clap::{Arg, Command};
use clap_complete::{Shell, generate};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};

use super::exit::EXIT_CODES;
use super::help::command;
use super::options::{FACETS, SET};
use super::print::{shown, to_stdout};
use crate::run::RunError;
use crate::run::folder::refused;
use crate::scene::{Density, LibraryDensity, Scene};
use voidwalk_core::constrictions::shipped;
use voidwalk_core::packing::LengthUnit;
use voidwalk_core::schema::KeyInfo;
use voidwalk_core::store::format::FORMATS;
use voidwalk_core::store::{StoreError, write_whole};

pub(crate) fn completions(shell: Shell) {
    to_stdout(&script(shell));
}

fn script(shell: Shell) -> String {
    let mut script = Vec::new();
    generate(shell, &mut with_values(shell), "voidwalk", &mut script);
    let mut script = String::from_utf8_lossy(&script).into_owned();
    if shell == Shell::Bash {
        script = script.replace(BASH_FILES, "COMPREPLY=()");
    }
    script.push_str(match shell {
        Shell::Bash => BASH_MORE,
        Shell::Zsh => ZSH_MORE,
        Shell::Fish => FISH_MORE,
        _ => "",
    });
    script
}

/// Completion of file names that bash would insert unquoted, and run: with nothing offered, bash itself
/// completes and quotes files.
const BASH_FILES: &str = r#"COMPREPLY=($(compgen -f "${cur}"))"#;

/// Completion in bash of the soils of a file after `FILE#`; after `base.cu=` it offers nothing, because the
/// value is still to be typed. Bash does not quote text that it inserts within quotes, so only names to which
/// quotes give no meaning are offered there.
const BASH_MORE: &str = r##"
_voidwalk_and_values() {
    local word="${COMP_WORDS[COMP_CWORD]}" quoted="" name
    case $word in *[\"\']*) quoted=yes word=${word#[\"\']} ;; *) word=${word//\\/} ;; esac
    COMPREPLY=()
    if [[ $word == *"#"* && -f ${word%%"#"*} ]]; then
        while IFS= read -r name; do
            [[ $name == "$word"* ]] || continue
            case $quoted$name in
                yes*[\"\'\$\`\\!]*) ;;
                yes*) COMPREPLY+=("$name") ;;
                *) COMPREPLY+=("$(printf %q "$name")") ;;
            esac
        done < <("$1" soil --names -- "${word%%"#"*}" 2>/dev/null)
        return
    fi
    _voidwalk "$@"
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]]; then
        compopt -o nospace 2>/dev/null
    fi
}
complete -F _voidwalk_and_values -o nosort -o bashdefault -o default voidwalk 2>/dev/null ||
    complete -F _voidwalk_and_values -o bashdefault -o default voidwalk
"##;

const ZSH_MORE: &str = r#"
_voidwalk_and_soils() {
    local word=${(Q)words[CURRENT]}
    if [[ $word == *'#'* && -f ${word%%'#'*} ]]; then
        local -a soils
        soils=(${(f)"$($words[1] soil --names -- ${word%%'#'*} 2>/dev/null)"})
        compadd -a soils
    else
        _voidwalk "$@"
    fi
}
compdef _voidwalk_and_soils voidwalk
"#;

const FISH_MORE: &str = r#"
function __voidwalk_soils
    set -l word (string unescape -- (commandline -ct))
    set -l file (string split -m1 '#' -- $word)[1]
    if string match -q '*#*' -- $word; and test -f "$file"
        voidwalk soil --names -- $file 2>/dev/null
    end
end
complete -c voidwalk -a '(__voidwalk_soils)'
"#;

/// Arguments of the program with their possible values. Arguments that may also be a file have values only in
/// bash, which goes on to files if no value fits.
fn with_values(shell: Shell) -> Command {
    let names = command().get_subcommands().map(|sub| sub.get_name().to_owned()).collect::<Vec<_>>();
    names.iter().fold(command(), |whole, name| {
        whole.mut_subcommand(name, |sub| sub.mut_args(|arg| of_argument(arg, name, shell)))
    })
}

fn of_argument(arg: Arg, command: &str, shell: Shell) -> Arg {
    let named = |words: &[&str]| words.iter().map(ToString::to_string).collect::<Vec<_>>();
    let values = match arg.get_id().as_str() {
        "density" => named(&Density::ALL.map(Density::name)),
        "densities" => {
            let packed = ["friction=", "estimate="];
            named(&[&LibraryDensity::ALL.map(LibraryDensity::name)[..], &packed].concat())
        }
        SET => assignments(),
        "schema" => FORMATS.iter().map(|form| form.name().to_owned()).collect(),
        "unit" => named(&LengthUnit::ALL.map(LengthUnit::name)),
        "facets" => named(&FACETS.map(|(word, _)| word)),
        "filter" if command == "boundary" && shell == Shell::Bash => {
            shipped().iter().map(|filter| filter.name.clone()).collect()
        }
        id => match Scene::keys().into_iter().find(|key| key.full_name() == id) {
            Some(key) if !key.offered.is_empty() => key.offered,
            _ => return arg,
        },
    };
    arg.value_parser(PossibleValuesParser::new(values))
}

/// Every setting in the form of `--set`, with each of its possible words.
fn assignments() -> Vec<String> {
    let of_key = |key: KeyInfo| {
        let name = key.full_name();
        match key.offered.is_empty() {
            true => vec![format!("{name}=")],
            false => key.offered.iter().map(|word| format!("{name}={word}")).collect(),
        }
    };
    Scene::keys().into_iter().flat_map(of_key).collect()
}

pub(crate) fn man(folder: &Path) -> Result<(), RunError> {
    if let Some(file) = folder.ancestors().find(|part| part.exists() && !part.is_dir()) {
        let problem = "is a file; name a folder for the pages, a new one or one that is there";
        return Err(refused(file, problem));
    }
    let mut whole = command();
    whole.build();
    let mut pages = vec![("voidwalk.1".to_owned(), page(whole.clone().after_help(None))?)];
    for sub in whole.get_subcommands().filter(|sub| sub.get_name() != "help") {
        pages.push((format!("voidwalk-{}.1", sub.get_name()), page(sub.clone())?));
    }
    let io = |source| StoreError::Io { path: folder.to_owned(), action: "make the folder", source };
    std::fs::create_dir_all(folder).map_err(io).map_err(RunError::Claim)?;
    for (name, text) in &pages {
        write_whole(&folder.join(name), text).map_err(RunError::Claim)?;
    }
    to_stdout(&format!("{} pages in {}\n", pages.len(), shown(folder)));
    Ok(())
}

fn page(command: Command) -> Result<Vec<u8>, RunError> {
    let mut text = Vec::new();
    Man::new(command).render(&mut text).map_err(RunError::failed)?;
    let mut codes = Roff::default();
    codes.control("SH", ["EXIT STATUS"]);
    for (code, meaning) in EXIT_CODES {
        codes.control("TP", []).text([bold(code.to_string())]).text([roman(meaning)]);
    }
    codes.to_writer(&mut text).map_err(RunError::failed)?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::error::ErrorKind;
    use std::collections::BTreeSet;

    #[test]
    fn values_are_completed_where_they_are_known() {
        let bash = script(Shell::Bash);
        for value in
            ["loose", "base.cu=", "filter.density=dense", "walk.arching=zuriguel-2005", "on-both-hulls"]
        {
            assert!(bash.contains(&format!(" {value} ")) || bash.contains(&format!("{value}\"")), "{value}");
        }
        assert!(bash.contains("shire2016-cu1.5-loose") && bash.trim_end().ends_with("default voidwalk"));
        assert!(!bash.contains("compgen -f") && !bash.contains("compgen -d"));
        let [zsh, fish] = [Shell::Zsh, Shell::Fish].map(script);
        for script in [&zsh, &fish] {
            assert!(script.contains("loose") && script.contains("filter.density=dense"));
        }
        let option = |command: &str, option: &str| {
            let (command, option) = (format!("using_subcommand {command}"), format!(" -l {option} "));
            fish.lines().filter(|line| line.contains(&command) && line.contains(&option)).collect::<Vec<_>>()
        };
        // Arguments that may be a file have no list of words in this shell.
        let lines = option("boundary", "filter");
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(lines[0].ends_with(" -r") && !lines[0].contains("shire2016"), "{lines:?}");
        assert!(option("design", "units")[0].contains(" -r -f -a "));
    }

    #[test]
    fn a_value_that_is_completed_is_one_that_is_read() {
        let parsers = with_values(Shell::Bash);
        let mut settings = BTreeSet::new();
        for sub in parsers.get_subcommands() {
            for arg in sub.get_arguments().filter(|arg| arg.get_num_args().is_none_or(|n| n.takes_values())) {
                let parser = command();
                let parser = parser.find_subcommand(sub.get_name()).unwrap().clone();
                for value in arg.get_possible_values() {
                    let Some(long) = arg.get_long() else { continue };
                    if arg.get_id() == SET && !value.get_name().ends_with('=') {
                        settings.insert(value.get_name().to_owned());
                    }
                    let value = match value.get_name() {
                        name if name.ends_with('=') => format!("{name}1"),
                        name => name.to_owned(),
                    };
                    let words = ["voidwalk".to_owned(), format!("--{long}={value}")];
                    let read = parser.clone().ignore_errors(false).try_get_matches_from(words.clone());
                    let wrong = read.err().filter(|error| error.kind() == ErrorKind::ValueValidation);
                    assert!(wrong.is_none(), "{words:?}: {wrong:?}");
                }
            }
        }
        // A scene with the required settings must accept every word that is offered for a setting.
        assert!(settings.len() > 30, "{settings:?}");
        let packed = ["filter.cu=1.5", "filter.density=loose"];
        let file = ["network.kind=graph", "network.packing=\"grains.csv\""];
        for setting in settings {
            let with = match setting.split_once('=').unwrap() {
                ("filter.density", _) => &packed[..1],
                ("network.kind", _) => &packed[..],
                ("network.unit", _) => &file[..],
                ("walk.arching", "marin-2018") => &["walk.concentration=0.02"],
                ("walk.exit", "height") => &["filter.cu=1.5", "filter.density=loose", "network.kind=graph"],
                _ => &[],
            };
            let all: Vec<String> = with.iter().map(ToString::to_string).chain([setting.clone()]).collect();
            let read = Scene::built_in(&all);
            assert!(read.is_ok(), "{setting}: {}", read.unwrap_err());
        }
    }
}
