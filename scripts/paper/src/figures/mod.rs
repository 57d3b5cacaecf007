//! The figures of the paper, drawn with our results. A figure for which nothing was walked is left out.

mod inputs;
mod scatter;
mod walks;

pub use self::inputs::{fig_6, fig_7, fig_8, fig_9, fig_10, fig_13, fig_18};
pub use self::walks::{fig_14, fig_15, fig_16, fig_17, fig_19, fig_20};
