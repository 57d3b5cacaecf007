//! `voidwalk init`: the built-in scene, as a start.

use std::path::Path;

use super::print::{shown, to_stdout};
use crate::run::{RunError, write_built_in};
use crate::scene::Scene;

/// Writes the built-in scene.
pub fn init(path: Option<&Path>) -> Result<(), RunError> {
    let Some(path) = path else {
        to_stdout(&Scene::init_text());
        return Ok(());
    };
    write_built_in(path)?;
    to_stdout(&format!("{}\n", shown(path)));
    Ok(())
}
