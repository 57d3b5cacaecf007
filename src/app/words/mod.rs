//! English: sentences in which faces express records.

mod answer;
pub(crate) mod batch;
pub(crate) mod boundary;
pub(crate) mod designed;
mod grains;
pub(crate) mod ledger;
pub(crate) mod left_out;
pub(crate) mod memory;
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
