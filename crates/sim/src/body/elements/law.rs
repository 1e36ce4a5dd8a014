//! What every law of matter says.

use palpate_geometry::math::{Lane, Matrix3};
use std::fmt::Debug;

/// An edge (a, b, k) of a Laplacian Σ k (e_a − e_b)(e_a − e_b)ᵀ, N/m.
pub type Edge = (u32, u32, f64);

/// What a Laplacian of springs is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// At least 3/4 of any tangent: a step that starts from the inertial prediction is stable with it.
    Bounding,
    /// Firm against turning: bounds the stresses of a strained solid.
    Firm,
    /// No less than any tangent: what explicit steps must resolve.
    Steepest,
}

/// A state of a law at which it has a tangent.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    /// Of the nodes, m, the fourth number ignored.
    pub places: &'a [Lane],
    /// As `rest` of [`add_forces`](super::MaterialLaw::add_forces).
    pub metrics: &'a [Lane],
    /// Where pressures are unknowns, Pa; empty: none presses.
    pub pressures: &'a [Lane],
}

/// A law of matter beside springs. Places are those of nodes, m, the fourth number ignored.
pub(crate) trait ForceLaw: Debug + Send + Sync {
    /// Adds −∂E/∂x, N.
    fn add_forces(&self, places: &[Lane], residual: &mut [Lane]);

    /// Elastic energy, J.
    fn energy_j(&self, places: &[Lane]) -> f64;

    /// Its part of a Laplacian above the tangent.
    fn edges(&self) -> Vec<Edge>;

    /// Hands out blocks (a, b, ∂²E/∂x_a∂x_b), N/m, without what is negative, a >= b or its mirror, each pair of nodes
    /// once or in parts.
    fn tangent_at(&self, at: &Place<'_>, out: &mut dyn FnMut(u32, u32, Matrix3));

    /// Its parts, each with its nodes: their forces can be had without those of others.
    fn parts(&self) -> Vec<Vec<u32>>;

    /// How many there are.
    fn part_count(&self) -> usize;

    /// Adds −∂E/∂x of some of its parts, whose numbers count from `first`, N.
    fn add_forces_of_parts(&self, parts: (&[u32], u32), places: &[Lane], residual: &mut [Lane]);

    /// It resists bending alone, as sheets do: out of plane they are as stiff as they are drawn.
    fn is_of_sheets(&self) -> bool {
        false
    }

    /// Methods that know springs alone may leave it out.
    fn is_safeguard(&self) -> bool {
        false
    }
}
