//! Bodies: the constants of a deforming body, and the arithmetic of its step.
//!
//! ```text
//! Surface ── layers ──▶ CellGrid ── elements ─▶ Law ─┐
//!                            masses, NodeMap (x = W q) ├─▶ Deformable (constant: step, compliance of the net)
//! tick: predict (x* = free motion) … contact solve … advance (x' = x* + A⁻¹ Cᵀ λ, v = (x' − x) / dt) … plastic flow
//! ```
//! A body knows coordinates, not tools: contact hands it forces on control points.

mod before;
mod bins;
mod cells;
mod convergence;
mod core;
mod deformable;
mod elements;
mod explicit;
mod field;
mod follow;
mod following;
mod frame;
mod frames;
mod grown;
mod guard;
mod implicit;
mod lattice;
mod law_forces;
pub mod layers;
mod ledger;
mod look_ahead;
mod material;
mod matter;
mod membrane;
mod missed;
mod neighbours;
pub mod net;
mod node_map;
pub mod opposite;
mod plastic;
mod quality;
mod repair;
mod rigid_motion;
mod rigid_velocity;
mod scalar_factor;
mod scratch;
mod settings;
mod shared_momentum;
mod sheet;
mod sheet_carry;
mod skin_motion;
mod state;
mod stepper;
pub(crate) mod stillness;
mod tangent;
mod tetrahedra;
mod through_skin;
mod ties;
mod transfer;
mod trials;
mod weights;
mod xpbd;

pub use cells::{Cell, CellGrid, CellQuality, MOST_NODES_A_SIDE};
pub use core::Made;
pub use deformable::Deformable;
pub use elements::continuum::{self, ContinuumError, ContinuumLaw, Elastic, VolumeBarrier};
pub use elements::springs::{CellShares, MODULI, Spring, SpringLaw, springs_of_cells};
pub use elements::{Bend, Edge, MaterialLaw, Weight};
pub use field::Field;
pub use following::{Following, Follows, Shape};
pub use lattice::{Inside, Solid};
pub use ledger::Ledger;
pub use material::{Material, PRESETS, Plastic, Preset, Stiffening, preset};
pub use matter::{Blueprint, Grain};
pub use membrane::{membrane, membrane_area_m2};
pub use node_map::{NodeMap, SparseRows};
pub use scratch::DeformableScratch;
pub use settings::{DeformableError, FallBack, Integrator, StepMatrix, StepSettings};
pub(crate) use shared_momentum::SharedMomentum;
pub use sheet::{Row, Sheet};
pub use state::DeformableState;
pub use ties::{coordinates_of_controls, coordinates_of_surface};
pub use transfer::{Deformed, Transfer};
pub use trials::{take_best, trials};
pub use weights::weights_at;
