//! Names of soils on a page: a soil's own name rather than its file's, and no name that only repeats its
//! kind. No page shows the folders of a file.

use std::borrow::Cow;

use maud::{Markup, html};

use super::figures::shorten;
use super::shell::{LINE, clean};

/// File name endings of the tables from which soils are read.
const TABLES: [&str; 7] = ["csv", "txt", "tsv", "xlsx", "ods", "ags", "dat"];

/// Name of a soil: `Till 3` for `soils.xlsx#Till 3`, `tillh` for `csv/tillh.csv`; any other name is kept.
pub(super) fn soil_name(name: &str) -> &str {
    let (file, soil) = name.split_once('#').unwrap_or((name, ""));
    let Some(stem) = ends_as_table(file) else { return name };
    match (soil.trim(), last_part(stem)) {
        ("", "") => name,
        ("", stem) => stem,
        (soil, _) => soil,
    }
}

/// True if a soil's name says more than its kind; a column of a table may be called `Base`.
pub(super) fn is_named(kind: &str, name: &str) -> bool {
    let soil = soil_name(name).trim();
    !soil.is_empty() && !soil.eq_ignore_ascii_case(kind)
}

/// Kind of a soil, and its name if it has one: `Base Till 3`.
pub(super) fn titled(kind: &str, name: &str) -> Markup {
    html! {
        (kind)
        @if is_named(kind, name) { " " b { bdi { (clean(&shorten(soil_name(name), LINE))) } } }
    }
}

/// File name, or a name that begins with one, without its folders; any other name is kept.
pub(super) fn file_name(name: &str) -> Cow<'_, str> {
    let (file, rest) = match name.find('#').or_else(|| name.find(", ")) {
        Some(at) => name.split_at(at),
        None => (name, ""),
    };
    match ends_as_table(file) {
        Some(_) => Cow::Owned(format!("{}{rest}", last_part(file))),
        None => Cow::Borrowed(name),
    }
}

/// Name, without folders, of any file that was read.
pub(super) fn input_name(name: &str) -> Cow<'_, str> {
    match file_name(name) {
        Cow::Borrowed(_) => Cow::Borrowed(last_part(name)),
        owned => owned,
    }
}

/// Kind of a soil, in these words, and its name, or its file's name if its own says no more than its kind:
/// `Base base.csv`.
pub(super) fn titled_by_file(kind: &str, words: &str, name: &str) -> Markup {
    let is_table = ends_as_table(name.split('#').next().unwrap_or_default()).is_some();
    let shown = match is_named(kind, name) {
        true => Cow::Borrowed(soil_name(name)),
        false => file_name(name),
    };
    html! {
        @if is_named(kind, name) || is_table { (words) " " b { bdi { (clean(&shorten(&shown, LINE))) } } }
        @else if words == kind { (titled(kind, name)) }
        @else { (words) }
    }
}

/// End of a path that distinguishes it from others, with as few folders as possible.
pub(super) fn told_apart(path: &str, others: &[&str]) -> String {
    let parts = |path: &str| path.split(['/', '\\']).map(str::to_owned).collect::<Vec<String>>();
    let path_parts = parts(path);
    let end = |parts: &[String], count: usize| parts[parts.len().saturating_sub(count)..].join("/");
    let is_alone = |count: &usize| {
        let like = others.iter().filter(|other| end(&parts(other), *count) == end(&path_parts, *count));
        like.count() <= 1
    };
    let count = (1..path_parts.len()).find(is_alone).unwrap_or(path_parts.len());
    end(&path_parts, count)
}

/// Option as on a command line, with a file name without its folders.
pub(super) fn option_words(option: &str) -> String {
    let at = option.find('=').map(|at| at + 1).or_else(|| option.strip_prefix("--filter ").map(|_| 9));
    let (name, value) = option.split_at(at.unwrap_or(0));
    format!("{name}{}", file_name(value))
}

/// Note that begins with the name of its file.
fn note_words(note: &str) -> String {
    match note.split_once(": ") {
        Some((file, note)) => format!("{}: {note}", file_name(file)),
        None => note.to_owned(),
    }
}

/// Name from outside, shortened to fit tables and legends.
pub(super) fn brief_name(name: &str) -> String {
    clean(&shorten(name, 60))
}

/// Notes on files as a list; empty without notes.
pub(super) fn file_notes(notes: &[String]) -> Markup {
    html! { @if !notes.is_empty() { ul { @for note in notes { li { (clean(&note_words(note))) } } } } }
}

fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or_default()
}

/// The name of a table without its ending; `None` for any other name.
fn ends_as_table(file: &str) -> Option<&str> {
    let (stem, ending) = file.rsplit_once('.')?;
    TABLES.iter().any(|table| ending.eq_ignore_ascii_case(table)).then_some(stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_says_no_more_than_its_kind_is_left_out() {
        let title = |kind, name| titled(kind, name).into_string();
        assert_eq!(title("Base", "/lab/base.csv"), "Base");
        assert_eq!(title("Base", "soils.xlsx#BASE"), "Base");
        assert_eq!(title("filter", "C33 <sand>.csv"), "filter <b><bdi>C33 &lt;sand&gt;</bdi></b>");
        assert_eq!(title("Base", "lab/soils.xlsx#Till 3"), "Base <b><bdi>Till 3</bdi></b>");
        assert!(
            is_named("Base", "filter.csv") && !is_named("filter", "a/Filter.CSV") && !is_named("base", "")
        );
    }

    #[test]
    fn a_name_that_says_no_more_than_its_kind_is_that_of_its_file_where_a_sheet_needs_one() {
        let title = |name| titled_by_file("Base", "Base", name).into_string();
        assert_eq!(title("/lab/base.csv"), "Base <b><bdi>base.csv</bdi></b>");
        assert_eq!(title("lab/soils.xlsx#base"), "Base <b><bdi>soils.xlsx#base</bdi></b>");
        assert_eq!(title("/lab/till.csv"), "Base <b><bdi>till</bdi></b>");
        assert_eq!([title("base"), title("")], ["Base", "Base"]);
        let filter = |name| titled_by_file("filter", "filter of the shape", name).into_string();
        assert_eq!(filter("/lab/filter.csv"), "filter of the shape <b><bdi>filter.csv</bdi></b>");
        assert_eq!(filter("C33.csv"), "filter of the shape <b><bdi>C33</bdi></b>");
        assert_eq!(filter("filter"), "filter of the shape");
        let read = ["/lab/soils.xlsx#Base/Sample 1", "/lab/packing.dump", "base.csv"].map(input_name);
        assert_eq!(read, ["soils.xlsx#Base/Sample 1", "packing.dump", "base.csv"]);
    }

    #[test]
    fn no_folder_stands_beside_the_name_of_a_file() {
        for (name, file) in [
            ("/tmp/a b/base.csv", "base.csv"),
            ("C:\\soils\\ring.xlsx#Base/Sample 1", "ring.xlsx#Base/Sample 1"),
            ("the voids of /tmp/grains.csv, 3 times", "grains.csv, 3 times"),
            ("linear, Cu 3/4", "linear, Cu 3/4"),
        ] {
            assert_eq!(file_name(name), file);
        }
        assert_eq!(option_words("--filter /a b/c.csv"), "--filter c.csv");
        assert_eq!(option_words("--set base.sieve=/a/b.csv"), "--set base.sieve=b.csv");
        assert_eq!([option_words("/a/b.csv"), option_words("--pack")], ["b.csv", "--pack"]);
        assert_eq!(note_words("/a/b.csv: 3/4 in: taken as 19 mm"), "b.csv: 3/4 in: taken as 19 mm");
    }

    #[test]
    fn files_of_one_name_are_told_apart_by_their_nearest_folders_alone() {
        let all = ["/lab/5/filter.csv", "/lab/7/filter.csv", "C:\\soils\\c33.csv"];
        let told = |path| told_apart(path, &all);
        assert_eq!(all.map(told), ["5/filter.csv", "7/filter.csv", "c33.csv"]);
        let deep = ["/a/x/filter.csv", "/b/x/filter.csv", "x/filter.csv"];
        assert_eq!(told_apart(deep[0], &deep), "a/x/filter.csv");
        assert_eq!(told_apart(deep[2], &deep), "x/filter.csv");
    }

    #[test]
    fn a_soil_is_called_by_its_own_name() {
        for (name, soil) in [
            ("csv/tillh.csv", "tillh"),
            ("C:\\soils\\C33 sand.CSV", "C33 sand"),
            ("lab/soils.xlsx#Till 3", "Till 3"),
            ("soils.ods# ", "soils"),
            ("linear, Cu 1.5", "linear, Cu 1.5"),
            ("Silty core fill no. 3", "Silty core fill no. 3"),
            ("#3", "#3"),
            (".csv", ".csv"),
            ("", ""),
        ] {
            assert_eq!(soil_name(name), soil);
        }
    }
}
