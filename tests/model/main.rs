//! The model itself: gradations, packings, engines and walks against exact answers, slow twins and each other.

mod arches;
mod counts;
mod counts_distribution;
mod coverage;
mod exact_answers;
mod exact_flow;
mod flow;
mod gradation;
mod openings;
mod packing;
mod sampling;
mod tiny_networks;
mod walk_against_reference;
mod walk_paths;
