//! Gradations.
