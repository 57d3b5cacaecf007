//! The built-in scene as commented TOML, made from the descriptions of its sections.

use std::fmt::Write;

use super::keys::{About, Base, ExitKeys, Filter, FilterPacking, NetworkKeys, Record, WalkKeys};
use crate::outcome::stopping::StopRule;
use voidwalk_core::packing;
use voidwalk_core::schema::KeyInfo;

/// Columns of a comment.
const WIDTH: usize = 96;

/// Description of each section, with its settings.
pub(super) fn sections() -> Vec<(&'static [&'static str], Vec<KeyInfo>)> {
    let packing_keys = [FilterPacking::keys(), packing::Settings::keys()].concat();
    vec![
        (WalkKeys::ABOUT, WalkKeys::keys()),
        (StopRule::ABOUT, StopRule::keys()),
        (Filter::ABOUT, Filter::keys()),
        (FilterPacking::ABOUT, packing_keys),
        (Base::ABOUT, Base::keys()),
        (ExitKeys::ABOUT, ExitKeys::keys()),
        (NetworkKeys::ABOUT, NetworkKeys::keys()),
        (Record::ABOUT, Record::keys()),
        (About::ABOUT, About::keys()),
    ]
}

/// The text: words follow `# `, settings that are off follow `#`; a section whose settings are all off is off
/// too.
pub(super) fn text() -> String {
    let mut text = String::new();
    for (about, keys) in sections() {
        let section = keys.first().map_or("", |key| key.section);
        let line = |text: &mut String, is_set: bool, what: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}{what}", if is_set { "" } else { "#" });
        };
        if !section.is_empty() {
            text.push('\n');
        }
        comment(&mut text, &for_users(about));
        match section {
            "" => text.push('\n'),
            name => line(&mut text, keys.iter().any(|key| key.is_set), format!("[{name}]")),
        }
        for key in keys {
            comment(&mut text, &key.doc);
            line(&mut text, key.is_set, format!("{} = {}", key.name, key.shown));
        }
    }
    text
}

/// First paragraph of a section's description; the paragraphs after it are for programmers.
pub(super) fn for_users(about: &[&str]) -> String {
    about.iter().take_while(|line| !line.trim().is_empty()).copied().collect::<String>().trim().to_owned()
}

/// Appends words as comment lines.
fn comment(text: &mut String, words: &str) {
    let mut line = String::from("#");
    for word in words.split_whitespace() {
        if line.len() + 1 + word.len() > WIDTH && line.len() > 1 {
            text.push_str(&line);
            text.push('\n');
            line = String::from("#");
        }
        line.push(' ');
        line.push_str(word);
    }
    text.push_str(&line);
    text.push('\n');
}
