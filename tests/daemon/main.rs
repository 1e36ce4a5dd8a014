//! The program as its users meet it: daemons as processes, clients, recordings, commands.
// Strangers open sessions of their own.
#![allow(clippy::disallowed_methods)]

#[path = "../../crates/sim/tests/common/mod.rs"]
mod common;
#[path = "common/daemon.rs"]
mod daemon;
#[path = "common/live.rs"]
mod live;
#[path = "common/page.rs"]
mod page;
#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/session.rs"]
mod session;

#[path = "access/mod.rs"]
mod access;
mod agones;
mod batch;
mod clients;
mod crash;
mod cutting;
mod damage;
#[path = "devices/mod.rs"]
mod devices;
mod documents;
mod documents_run;
mod editing;
mod examples;
mod export;
mod faults;
mod features;
mod first_hour;
mod follow;
mod golden;
mod haptic_link;
mod hostile_bytes;
mod hostile_files;
mod inputs;
mod keeping;
mod kubernetes;
mod lobby;
mod many_tools;
#[path = "page/mod.rs"]
mod pages;
mod play;
mod quoting;
mod reach;
mod readers_that_stop;
mod readmes;
mod recording;
mod reference;
mod relay;
mod replay_levels;
mod scenarios;
mod self_check;
mod sessions;
mod slow_disk;
mod streaming;
mod surface_commands;
mod surface_parts;
mod surface_pipe;
mod test_helper;
mod trust;
mod views;
#[path = "watchdogs/mod.rs"]
mod watchdogs;
mod wire;
mod workers;
