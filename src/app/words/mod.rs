//! English: sentences in which faces express records.
//!
//! - `first_lines()` gives the lines of practice and model at the top of every face.
//! - [`sentence()`] fills a note's sentence with its numbers; [`setting()`] names the setting that
//!   changes it.
//! - `rule`: rules of practice and their notes; `meaning()`: a class of the model; `left_out`:
//!   parts omitted from an answer.

mod answer;
pub(crate) mod batch;
pub(crate) mod boundary;
pub(crate) mod designed;
mod grains;
pub(crate) mod ledger;
pub(crate) mod left_out;
mod note;
mod practice;
pub(crate) mod products;
pub(crate) mod rule;
pub mod specification;

pub use answer::next;
pub(crate) use answer::{FOREMOST, FirstLine, capital, first_lines, foremost, meaning, so_far, undecided_by};
pub use grains::{doubt, reading};
pub(crate) use ledger::{base_size, grading};
pub(crate) use note::row_note;
pub use note::{sentence, setting};
pub(crate) use practice::{dispersive_limit, judged_alone, practice_line};
