//! Methods of the source, kept for comparison: what the thesis that Palpate comes from has, and Palpate does otherwise.
//!
//! ```text
//! cells    cube lattices in a surface: transfinite, som         (Palpate: layers)
//! springs  their stiffness, each by itself: seed                (Palpate: moduli)
//! spheres  contacts on points of a surface                       (Palpate: on the surface itself)
//!     └──▶ METHODS ── Loaded::with | Scene::build_with ──▶ a scene that names them
//! ```
//! The crates of the product do not know them: each kind has a trait there, which a caller passes to those who build
//! a scene. Scenes name them by the same keys and values as methods of the product.

// Tests compare with formulas as they stand; the list of clippy.toml holds for what simulates.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod cells;
pub mod spheres;
pub mod springs;
#[cfg(test)]
mod testing;

use palpate_sim::scene::Methods;

/// All of them, by the names that scenes give them.
pub const METHODS: Methods = Methods {
    cells: &[&cells::Transfinite, &cells::SelfOrganising],
    springs: &[&springs::Seed],
    contact: &[&spheres::SPHERES],
};
