//! Every setting for programs: printed by `voidwalk init --json`, and the source of the book's reference.

use serde::Serialize;

use super::groups::GROUPS;
use super::init::{for_users, sections};
use voidwalk_core::schema::{Alternative, Group, KeyInfo};

/// Every setting of a scene, and which exclude each other. Values stand as they are written in TOML.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct SceneReference {
    /// The sections in the order in which they are written.
    pub sections: Vec<SectionReference>,
    /// Settings that say the same thing in different ways, of which a scene may use one.
    pub exclusive: Vec<ExclusiveSettings>,
}

/// A section of a scene.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct SectionReference {
    /// Its name, empty for the settings at the top.
    pub name: &'static str,
    /// What it is about.
    pub about: String,
    /// Its settings.
    pub settings: Vec<SettingReference>,
}

/// A setting.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct SettingReference {
    /// Its full name: `base.cu`.
    pub name: String,
    /// The type of its value in TOML.
    #[serde(rename = "type")]
    pub toml_type: &'static str,
    /// What is allowed.
    pub allowed: String,
    /// The value where a scene does not set it; none where it then has no value.
    pub default: Option<String>,
    /// Its value in the built-in scene; none where it is not set there.
    pub built_in: Option<String>,
    /// A value that it may have.
    pub example: String,
    /// What it means.
    pub meaning: String,
}

/// Settings that exclude each other.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ExclusiveSettings {
    /// What they say: `give the base`.
    pub says: &'static str,
    /// The ways to say it. A name that ends in a point is that of a whole section.
    pub alternatives: Vec<WayReference>,
}

/// One way to say what [`ExclusiveSettings`] say.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct WayReference {
    /// Settings that say it, each by itself.
    pub by: &'static [&'static str],
    /// Settings that go with these alone.
    pub with: &'static [&'static str],
}

/// Reference of a scene's settings.
pub(super) fn reference() -> SceneReference {
    let section = |(about, keys): (&[&str], Vec<KeyInfo>)| SectionReference {
        name: keys.first().map_or("", |key| key.section),
        about: for_users(about),
        settings: keys.into_iter().map(setting).collect(),
    };
    // In a group with one alternative the others give way on the command line only.
    let exclusive = GROUPS.iter().filter(|group| group.alternatives.len() > 1).map(exclusive);
    SceneReference { sections: sections().into_iter().map(section).collect(), exclusive: exclusive.collect() }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// A value that no setting takes.
    const WRONG: &str = "[[]]";

    fn settings() -> Vec<SettingReference> {
        reference().sections.into_iter().flat_map(|section| section.settings).collect()
    }

    /// The only setting beside which this one is allowed.
    fn beside(name: &str) -> Option<&'static str> {
        let exclusive = reference().exclusive;
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
            // It may ask for others beside it, but not for another value.
            let wrong = |value: &str| error(value).is_some_and(|text| text.contains("is not allowed"));
            assert!(!example.is_empty() && !wrong(&example), "{name} = {example}: {:?}", error(&example));
            assert!(!default.as_deref().is_some_and(wrong), "{name}: {default:?}");
        }
    }
}
