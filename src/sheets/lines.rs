//! Lists of lines, rows or names within a sentence.

use voidwalk_core::gradation::shortened;
use voidwalk_core::text::plain;

/// Most items that are named one by one.
const MOST: usize = 8;

/// `line 5`, `rows 5, 7, 8`, `lines 5, 7 and 12 more`.
pub(super) fn listed<T>(word: &str, all: &[T], name: impl Fn(&T) -> String) -> String {
    let shown: Vec<String> = all.iter().take(MOST).map(name).collect();
    let shown = shown.join(", ");
    match all.len() {
        1 => format!("{word} {shown}"),
        n if n > MOST => format!("{word}s {shown} and {} more", n - MOST),
        _ => format!("{word}s {shown}"),
    }
}

/// Names of soils, shortened; of many, the first ones.
pub(super) fn names_listed(names: &[String]) -> String {
    const MOST: usize = 12;
    let mut shown: Vec<String> = names.iter().take(MOST).map(|name| shortened(&plain(name))).collect();
    if names.len() > MOST {
        shown.push(format!("and {} more", names.len() - MOST));
    }
    shown.join(", ")
}
