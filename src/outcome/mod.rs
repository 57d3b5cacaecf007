//! What the two runs say about a base-filter combination.

pub mod record;
