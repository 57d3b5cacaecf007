//! `voidwalk init`: the built-in scene, as a start.

use std::path::Path;

use super::print::{json, shown, to_stdout};
use crate::run::{RunError, write_built_in};
use crate::scene::Scene;
use crate::store::format::{self, Format};

/// Writes the built-in scene, or says what may be set, or what a file holds.
pub fn init(path: Option<&Path>, as_json: bool, schema: Option<Format>) -> Result<(), RunError> {
    if let Some(form) = schema {
        to_stdout(form.schema);
        return Ok(());
    }
    if as_json {
        to_stdout(&json(format::SETTINGS, &Scene::reference())?);
        return Ok(());
    }
    let Some(path) = path else {
        to_stdout(&Scene::init_text());
        return Ok(());
    };
    write_built_in(path)?;
    to_stdout(&format!("{}\n", shown(path)));
    Ok(())
}
