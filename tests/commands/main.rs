//! The commands as a user meets them: what they print and write, refuse, stop, and continue.

mod campaign;
mod checkpoints;
mod full_disk;
mod hostile_names;
mod pack;
mod precision;
mod scene;
mod slurm_scripts;
mod soils;
