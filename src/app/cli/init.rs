//! `voidwalk init`: the built-in scene, or the plan of a campaign, as a start.

use std::path::Path;

use super::print::{as_it_is, json, shown, to_stdout};
use crate::cases::CasePlan;
use crate::run::{RunError, write_built_in, write_new};
use crate::scene::Scene;
use voidwalk_core::store::format;

/// Writes the built-in scene or a plan, or lists the settings, or the contents of a file.
pub fn init(path: Option<&Path>, plan: bool, as_json: bool, schema: Option<String>) -> Result<(), RunError> {
    if let Some(schema) = schema {
        to_stdout(&schema);
        return Ok(());
    }
    if as_json {
        as_it_is(&json(format::SETTINGS, &Scene::reference())?);
        return Ok(());
    }
    let Some(path) = path else {
        to_stdout(&if plan { CasePlan::INIT_TEXT.to_owned() } else { Scene::init_text() });
        return Ok(());
    };
    if plan {
        write_new(path, CasePlan::INIT_TEXT.as_bytes())?;
    } else {
        write_built_in(path)?;
    }
    to_stdout(&format!("{}\n", shown(path)));
    Ok(())
}
