//! The commands as a user meets them: what they print and write, refuse, stop, and continue.

mod arches;
mod batch;
mod boundary;
mod broad;
mod campaign;
mod check_and_run;
mod checkpoints;
#[cfg(target_os = "linux")]
mod completion;
mod contract;
mod designs;
mod first_hour;
mod formats;
mod full_disk;
#[cfg(target_os = "linux")]
mod full_stdout;
mod graph;
mod hostile_names;
mod judge;
mod mistakes;
mod openings;
mod order;
mod pack;
mod pan;
mod program;
mod rules;
mod scene;
mod scene_networks;
mod scene_refused;
mod schemas;
mod second_command;
#[cfg(feature = "serve")]
mod serve;
#[cfg(feature = "serve")]
mod serve_batch;
#[cfg(feature = "serve")]
mod serve_jobs;
#[cfg(feature = "serve")]
mod served;
mod sheet;
mod slurm_scripts;
mod small_run;
mod soils;
mod soils_of_a_sheet;
mod specification;
mod studies;
mod thickness;
mod trial;
#[cfg(feature = "xlsx")]
mod workbooks;
