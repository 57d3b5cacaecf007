//! Lists of lines or rows within a sentence.

/// Most that are named one by one.
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
