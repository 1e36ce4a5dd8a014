//! The solve of a tick: its matrix, its forces, and buffers for what goes with them.

use super::delassus::Delassus;
use super::direct::Direct;
use super::friction::Stick;
use super::hold::Barrier;
use super::impacts::Impacts;
use super::indentation::{Indentation, Touch};
use super::matrix::ContactMatrix;
use super::motions::Motions;
use super::problem::ContactProblem;
use super::sharing::Share;
use palpate_geometry::math::Vector3;
use std::ops::Range;

/// Contact forces of the rows of a tick, and what finds them.
#[derive(Debug)]
pub struct Solver {
    /// How the rows move each other.
    pub matrix: ContactMatrix,
    /// Their forces.
    pub problem: ContactProblem,
    /// Bodies that move freely, and the rows on them.
    pub motions: Motions,
    /// Ends solves of bodies that move freely.
    pub direct: Direct,
    /// By body, then by tool: mass of the heaviest body that it is in touch with, through others that give way too; 0
    /// where none of them is free and rigid.
    pub heaviest_kg: Vec<f64>,
    /// By row: how it meets and parts.
    pub impacts: Impacts,
    /// By row: where it sticks if it does not slip.
    pub sticks: Vec<Stick>,
    /// Shares of one tool's rows.
    pub shares: Vec<Share>,
    /// Rigid contacts of one tool.
    pub barriers: Vec<Barrier>,
    /// Of one body after the other.
    pub delassus: Delassus,
    /// By pair: a tool that touches a solid.
    pub touches: Vec<Touch>,
    /// By pair: how far it goes in beyond what the solid's net shows.
    pub indentations: Vec<Indentation>,
    /// Pairs that touch so, and their rows.
    pub touching: Vec<Touching>,
}

/// A pair that touches, by its number, and its rows.
pub type Touching = (usize, Range<usize>);

impl Solver {
    /// Force of a row on its holder, N.
    pub fn force_n(&self, i: usize) -> Vector3 {
        self.problem.force_n(i)
    }

    /// True when a row carries a force that is a number.
    pub fn carries(&self, i: usize) -> bool {
        self.problem.carries(i)
    }

    /// Gap of a row under the present forces, m.
    pub fn gap_after(&self, i: usize) -> f64 {
        self.problem.gap_after(i)
    }
}
