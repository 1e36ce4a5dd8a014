//! The tick and its contact queries allocate nothing. A program of its own, because the counting
//! allocator replaces that of the whole process.

#![allow(clippy::disallowed_methods)]

#[path = "../common/mod.rs"]
mod common;
mod contact;
#[path = "../common/counting.rs"]
mod counting;
mod maker;
mod tick;
