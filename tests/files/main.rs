//! Files that are read: tables that are refused with their message, checkpoints of every version, torn and damaged ones.

mod accounts;
mod bad_tables;
mod damaged;
mod forged_checkpoints;
mod golden;
mod marked;
#[path = "../readers/mod.rs"]
mod readers;
mod results;
mod sheets;
mod soils;
mod torn_checkpoints;
mod vanished;
