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
mod two_tables;
mod walks;
mod work;

use pyo3::prelude::*;

/// Functions that voidwalk's Python classes call. The module keeps no state that threads could share, so an
/// interpreter without a global lock needs no lock for it.
#[pymodule(gil_used = false)]
mod _voidwalk {
    #[pymodule_export]
    use crate::command::command;
    #[pymodule_export]
    use crate::grains::{measure, pack, read_packing};
    #[pymodule_export]
    use crate::network::Network;
    #[pymodule_export]
    use crate::notes::note_sentences;
    #[pymodule_export]
    use crate::pages::{report, run_brief, run_page, walk_brief, walk_page};
    #[pymodule_export]
    use crate::problem::VoidwalkError;
    #[pymodule_export]
    use crate::rules::rules;
    #[pymodule_export]
    use crate::scenes::{Scene, campaign, init_text, resume, run, run_in_memory};
    #[pymodule_export]
    use crate::soil::{Curve, Gradation};
    #[pymodule_export]
    use crate::studies::{boundary, percolation, schema, soils, specification, specification_words};
    #[pymodule_export]
    use crate::walks::{replicate_seed, walk};
    #[pymodule_export]
    use crate::work::Progress;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
