//! All settings in order: as the commented text of `voidwalk init`, and for programs, as printed by
//! `voidwalk init --json` and shown in the book.

use super::Scene;
use super::keys::{About, Base, ExitKeys, Filter, FilterPacking, GROUPS, NetworkKeys, Record, WalkKeys};
use crate::outcome::stopping::StopRule;
use serde::Serialize;
use voidwalk_core::packing;
use voidwalk_core::schema::{Alternative, Group, KeyInfo};

/// Width of a comment in columns.
const WIDTH: usize = 96;

/// All settings of a scene, and which exclude each other. Values are written as in TOML.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct SceneReference {
    /// Sections in the order in which they are written.
    pub(crate) sections: Vec<SectionReference>,
    /// Groups of settings that state one fact in different ways; a scene uses one way of each.
    pub(crate) exclusive: Vec<ExclusiveSettings>,
}

/// Section of a scene.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct SectionReference {
    /// Name of the section; empty for the settings at the top.
    pub(crate) name: &'static str,
    /// Subject of the section.
    pub(crate) about: String,
    /// Settings of the section.
    pub(crate) settings: Vec<SettingReference>,
}

/// Setting of a scene.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct SettingReference {
    /// Full name, such as `base.cu`.
    pub(crate) name: String,
    /// Type of the value in TOML.
    #[serde(rename = "type")]
    pub(crate) toml_type: &'static str,
    /// Allowed values.
    pub(crate) allowed: String,
    /// Value if a scene does not set it; absent if it then has no value.
    pub(crate) default: Option<String>,
    /// Value in the built-in scene; absent if it is not set there.
    pub(crate) built_in: Option<String>,
    /// Example of a value.
    pub(crate) example: String,
    /// Meaning of the setting.
    pub(crate) meaning: String,
}

/// Settings that exclude each other.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct ExclusiveSettings {
    /// Statement that they make, such as `give the base`.
    pub(crate) says: &'static str,
    /// Ways to make the statement. A name that ends in a point is a whole section.
    pub(crate) alternatives: Vec<WayReference>,
}

/// One way to make the statement of [`ExclusiveSettings`].
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct WayReference {
    /// Settings that make the statement, each alone.
    pub(crate) by: &'static [&'static str],
    /// Settings allowed only with these.
    pub(crate) with: &'static [&'static str],
}

impl Scene {
    /// All settings, section by section, in the order in which they are written.
    pub(crate) fn keys() -> Vec<KeyInfo> {
        sections().into_iter().flat_map(|(_, keys)| keys).collect()
    }

    /// Built-in scene as commented TOML with every setting: words follow `# `, settings that are off
    /// follow `#`; a section whose settings are all off is also off.
    pub fn init_text() -> String {
        let mut text = String::new();
        for (about, keys) in sections() {
            let section = keys.first().map_or("", |key| key.section);
            let off = |is_set: bool| if is_set { "" } else { "#" };
            if !section.is_empty() {
                text.push('\n');
            }
            comment(&mut text, &for_users(about));
            match section {
                "" => text.push('\n'),
                name => text += &format!("{}[{name}]\n", off(keys.iter().any(|key| key.is_set))),
            }
            for key in keys {
                comment(&mut text, &key.doc);
                text += &format!("{}{} = {}\n", off(key.is_set), key.name, key.shown);
            }
        }
        text
    }

    /// Reference for programs: every setting with its type, default and allowed values.
    pub(crate) fn reference() -> SceneReference {
        let section = |(about, keys): (&[&str], Vec<KeyInfo>)| SectionReference {
            name: keys.first().map_or("", |key| key.section),
            about: for_users(about),
            settings: keys.into_iter().map(setting).collect(),
        };
        // In a group with one alternative, the others give way only on the command line.
        let exclusive = GROUPS.iter().filter(|group| group.alternatives.len() > 1).map(exclusive);
        SceneReference {
            sections: sections().into_iter().map(section).collect(),
            exclusive: exclusive.collect(),
        }
    }
}

/// Sections, each with its description and settings.
fn sections() -> Vec<(&'static [&'static str], Vec<KeyInfo>)> {
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

fn setting(key: KeyInfo) -> SettingReference {
    SettingReference {
        name: key.full_name(),
        toml_type: key.toml_type,
        allowed: key.allowed,
        default: key.default,
        built_in: key.is_set.then(|| key.shown.clone()),
        example: key.shown,
        meaning: key.doc,
    }
}

fn exclusive(group: &Group) -> ExclusiveSettings {
    let reference = |alternative: &Alternative| WayReference { by: alternative.by, with: alternative.with };
    ExclusiveSettings { says: group.says, alternatives: group.alternatives.iter().map(reference).collect() }
}

/// First paragraph of a section's description; further paragraphs are for programmers.
fn for_users(about: &[&str]) -> String {
    about.iter().take_while(|line| !line.trim().is_empty()).copied().collect::<String>().trim().to_owned()
}

/// Appends words as comment lines.
fn comment(text: &mut String, words: &str) {
    let mut line = String::from("#");
    for word in words.split_whitespace() {
        if line.len() + 1 + word.len() > WIDTH && line.len() > 1 {
            *text += &(line + "\n");
            line = String::from("#");
        }
        line = line + " " + word;
    }
    *text += &(line + "\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    /// Value that no setting takes.
    const WRONG: &str = "[[]]";

    fn settings() -> Vec<SettingReference> {
        Scene::reference().sections.into_iter().flat_map(|section| section.settings).collect()
    }

    /// Setting that this one requires beside it.
    fn beside(name: &str) -> Option<&'static str> {
        let exclusive = Scene::reference().exclusive;
        let alternative = exclusive
            .iter()
            .flat_map(|group| &group.alternatives)
            .find(|alternative| alternative.with.contains(&name));
        alternative
            .map(|alternative| alternative.by[0])
            .or(name.starts_with("packing.").then_some("filter.density"))
    }

    #[test]
    fn what_is_said_to_be_allowed_is_what_a_wrong_value_is_answered_with() {
        let settings = settings();
        assert!(settings.len() > 60, "{} settings", settings.len());
        for SettingReference { name, allowed, .. } in &settings {
            let example = |other: &str| settings.iter().find(|s| s.name == other).map(|s| s.example.clone());
            let other = beside(name).map(|other| format!("{other}={}", example(other).unwrap()));
            let set: Vec<String> = other.into_iter().chain([format!("{name}={WRONG}")]).collect();
            let error = Scene::built_in(&set).unwrap_err().to_string();
            assert!(error.contains(name) && error.ends_with(allowed), "{error}");
        }
    }

    #[test]
    fn examples_and_defaults_are_allowed() {
        for SettingReference { name, default, example, .. } in settings() {
            let error =
                |value: &str| Scene::built_in(&[format!("{name}={value}")]).err().map(|e| e.to_string());
            // An error may ask for other settings, but not for another value.
            let wrong = |value: &str| error(value).is_some_and(|text| text.contains("is not allowed"));
            assert!(!example.is_empty() && !wrong(&example), "{name} = {example}: {:?}", error(&example));
            assert!(!default.as_deref().is_some_and(wrong), "{name}: {default:?}");
        }
    }
}
