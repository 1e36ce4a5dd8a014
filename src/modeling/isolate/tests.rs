//! The given pairs, hard cases, laws.

mod pairs;
mod table;
