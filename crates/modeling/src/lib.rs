//! Surfaces from surfaces, and from curves.
//!
//! ```text
//! merge    patches ──▶ one surface, C^c at the seams
//! isolate  overlapping solids ──▶ short translations that free them
//! ipp      polynomial equations in Bernstein form ──▶ all roots in a box, certified
//! pipe     spine ──▶ the largest radius without self-intersection (by ipp), the pipe as a surface
//! branch   tree ──▶ one tensor-product surface that bifurcates
//! truncate overlapping solids ──▶ parts that share a wall
//! ```
//! None of this runs inside a tick: people and `editing` call it, between sessions or beside the
//! loop.

pub mod branch;
pub mod ipp;
pub mod isolate;
pub mod merge;
pub mod pipe;
pub mod truncate;
