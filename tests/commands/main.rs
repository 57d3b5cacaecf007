//! The commands as a user meets them: what they print and write, refuse, stop, and continue.

mod broad;
mod campaign;
mod check_and_run;
mod checkpoints;
mod first_hour;
mod full_disk;
mod graph;
mod hostile_names;
mod pack;
mod pan;
mod precision;
mod program;
mod rules;
mod scene;
mod second_command;
mod slurm_scripts;
mod soils;
mod trial;
