//! The page: its socket, who may use it, and what it does to a scene.

mod browser;
mod crowds;
mod hands;
mod recordings;
mod security;
mod shown;

pub use crate::scenes::{SOFT_DROP as SOFT, TWO_BALLS};
