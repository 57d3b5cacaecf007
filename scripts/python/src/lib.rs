//! The Python face of voidwalk: arrays and dicts in, calls of the library, arrays and dicts out.
//!
//! Nothing of the model is here. `work` lets a call run without the interpreter and hears Ctrl-C; each other
//! file turns the arguments of one stage into arguments of the library, and its results into arrays. The
//! classes that a user sees are written in Python (`python/voidwalk`), over these.

mod arrays;
mod command;
mod grains;
mod network;
mod notes;
mod pages;
mod problem;
mod rules;
mod scenes;
mod soil;
mod studies;
mod tables;
mod walks;
mod work;

use pyo3::prelude::*;

/// Functions that voidwalk's Python classes call. The module keeps no state that threads could share, so an
/// interpreter without a global lock needs no lock for it.
#[pymodule(gil_used = false)]
mod _voidwalk {
    #[pymodule_export]
    use crate::{
        command::command,
        grains::{measure, pack, read_packing},
        network::Network,
        notes::note_sentences,
        pages::{report, run_brief, run_page, walk_brief, walk_page},
        problem::VoidwalkError,
        rules::rules,
        scenes::{Scene, campaign, init_text, resume, run, run_in_memory},
        soil::{Curve, Gradation},
        studies::{boundary, percolation, schema, soils, specification, specification_words},
        walks::{replicate_seed, walk},
        work::Progress,
    };
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
