//! English: sentences in which faces express records.
//!
//! - [`first_lines()`] gives the lines of practice and model at the top of every face.
//! - [`sentence()`] fills a note's sentence with its numbers; [`setting()`] names the setting that
//!   changes it.
//! - [`rule`]: rules of practice and their notes; [`meaning()`]: a class of the model; [`left_out`]:
//!   parts omitted from an answer.

mod answer;
pub mod batch;
pub mod boundary;
pub mod designed;
pub mod ledger;
pub mod left_out;
mod note;
mod practice;
pub mod products;
pub mod rule;
pub mod specification;

pub use answer::{FOREMOST, FirstLine, capital, first_lines, foremost, meaning, next, so_far, undecided_by};
pub use ledger::{base_size, grading};
pub use note::{row_note, sentence, setting};
pub use practice::{dispersive_limit, judged_alone, practice_line};
