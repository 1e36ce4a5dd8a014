//! Bodies: the constants of a deforming body, and the arithmetic of its step.
//!
//! ```text
//! Surface ── layers::build ──▶ Cells ── springs::from_cells ──▶ Lattice (constant: springs, masses, factor, compliance)
//! tick: predict (x* = free motion) … contact solve … advance (x' = x* + A⁻¹ Cᵀ λ, v = (x' − x) / dt)
//! ```
//! A lattice knows nodes, not tools: contact hands it forces on control points.

mod cells;
mod cube;
#[cfg(test)]
mod cube_tests;
mod exterior;
mod harmonic;
mod lattice;
pub mod layers;
mod quality;
mod som;
mod springs;
mod ties;
mod transfinite;
mod untangle;

pub use cells::{Cell, CellGrid, CellQuality};
pub use cube::{CubeError, CubeLattice, MOST_NODES_A_SIDE};
pub use exterior::{CONDITION_LIMIT, ExteriorError, ExteriorMap, check_exterior, measure_exterior};
pub use lattice::{Lattice, LatticeError, LatticeScratch, LatticeState, Material, StepSettings};
pub use som::{SomSettings, som};
pub use springs::Spring;
pub use ties::coordinates_of_controls;
pub use transfinite::{thick_sheet, transfinite};
