//! The given pairs, hard cases, laws.

mod table;
