//! English: the sentences in which faces express records.
//!
//! - [`first_lines()`] are the lines of practice and model at the top of every face.
//! - [`sentence()`] fills a note's sentence with its numbers, [`setting()`] names the setting that changes
//!   it.
//! - `rule`, `rule_note`: rules of practice; [`meaning()`]: a class of the model; `left_out`: parts that an
//!   answer leaves out.

mod answer;
mod base_size;
pub mod batch;
#[cfg(test)]
mod batch_tests;
pub mod boundary;
mod case_columns;
mod class;
pub mod designed;
mod dispersion;
pub mod ledger;
pub mod left_out;
mod next;
mod note;
mod practice;
pub mod products;
pub mod rule;
pub mod rule_note;
mod so_far;
pub mod specification;

pub use answer::{FOREMOST, FirstLine, first_lines, foremost, model};
pub use base_size::{base_size, grading};
pub use class::{capital, meaning, undecided_by};
pub use dispersion::{beside_dispersive, dispersive_limit, test};
pub use next::next;
pub use note::{row_note, sentence, setting};
pub use practice::{judged_alone, practice_line, tested_in_brief};
pub use so_far::so_far;
