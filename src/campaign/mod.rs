//! Scenes and campaigns: the only place that knows all stages.

pub mod settings;
