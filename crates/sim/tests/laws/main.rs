//! Laws of the simulation: forces, rest, energy, friction, couplings, refusals.

#![allow(clippy::disallowed_methods)]

mod apart;
mod bending;
mod bounce;
mod boxes;
mod carried;
mod chains;
#[path = "../common/mod.rs"]
mod common;
mod contact;
mod cuts;
mod deformation;
mod deforming_input;
mod deforming_laws;
mod errors;
mod examples;
mod explained;
mod extreme_input;
mod faces;
mod flags;
mod free_rigid;
mod friction;
mod grip;
mod haptics;
mod late;
mod light_touch;
mod many_tools;
mod membranes;
mod models;
mod motion;
mod movers;
mod part_solids;
mod parts;
mod presses;
mod quality;
mod refinement;
mod resting;
mod rigid;
mod seated;
mod sides;
mod thin;
mod vessel;
