//! Bodies: the constants of a deforming body, and the arithmetic of its step.
//!
//! ```text
//! Surface ── layers::build ──▶ Cells ── springs::from_cells ──▶ Lattice (constant: springs, masses, factor, compliance)
//! tick: predict (x* = free motion) … contact solve … advance (x' = x* + A⁻¹ Cᵀ λ, v = (x' − x) / dt)
//! ```
//! A lattice knows nodes, not tools: contact hands it forces on control points.

mod cells;
pub mod continuum;
mod lattice;
pub mod layers;
#[cfg(feature = "reference")]
pub mod reference;
mod springs;

pub use cells::{Cell, CellGrid, CellQuality};
pub use continuum::{Continuum, ContinuumError, Elastic, Pass};
pub use lattice::{Lattice, LatticeError, LatticeScratch, LatticeState, Material, StepSettings};
pub use springs::Spring;
