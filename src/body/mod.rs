//! Bodies: the constants of a deforming body, and the arithmetic of its step.
//!
//! ```text
//! Surface ── layers ──▶ CellGrid ── springs ──▶ Law ─┐
//!                            masses, NodeMap (x = W q) ├─▶ Deformable (constant: step, compliance of the net)
//! tick: predict (x* = free motion) … contact solve … advance (x' = x* + A⁻¹ Cᵀ λ, v = (x' − x) / dt) … plastic flow
//! ```
//! A body knows coordinates, not tools: contact hands it forces on control points.

mod bends;
mod cells;
pub mod continuum;
mod deformable;
mod explicit;
mod implicit;
mod lattice;
mod law;
pub mod layers;
mod material;
mod membrane;
pub mod net;
mod node_map;
mod plastic;
#[cfg(feature = "reference")]
pub mod reference;
mod spring_table;
mod springs;
mod state;
mod xpbd;

pub use bends::Bend;
pub use cells::{Cell, CellGrid, CellQuality};
pub use continuum::{Continuum, ContinuumError, Elastic, Pass};
pub use deformable::{Blueprint, Deformable, DeformableError, Integrator, StepSettings};
pub use lattice::{Inside, Solid};
pub use law::Law;
pub use material::{Material, PRESETS, Plastic, Preset, Stiffening, preset};
pub use membrane::membrane;
pub use node_map::{NodeMap, SparseRows};
pub use springs::{Spring, SpringRule};
pub use state::{DeformableScratch, DeformableState};
