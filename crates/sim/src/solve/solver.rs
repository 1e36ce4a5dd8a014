//! The solve of a tick: its matrix, the two problems on it, of which one is in use, and their buffers.

use super::complementarity::Complementarity;
use super::cones::ConeShare;
use super::delassus::Delassus;
use super::friction::{FrictionProblem, Stick};
use super::hold::Barrier;
use super::indentation::{Indentation, Touch};
use super::matrix::ContactMatrix;
use super::rows::Row;
use super::sharing::Share;
use palpate_geometry::math::Vector3;

/// Contact forces of the rows of a tick, and what finds them.
#[derive(Debug)]
pub struct Solver {
    /// How the rows move each other.
    pub matrix: ContactMatrix,
    /// Forces along the normals.
    pub problem: Complementarity,
    /// Forces of three components: in use in ticks with friction or a grip.
    pub friction: FrictionProblem,
    /// By row, in such ticks.
    pub sticks: Vec<Stick>,
    /// Shares of one tool's rows, in such ticks.
    pub cones: Vec<ConeShare>,
    /// Shares of one tool's rows, in ticks without friction or a grip.
    pub shares: Vec<Share>,
    /// Rigid contacts of one tool.
    pub barriers: Vec<Barrier>,
    /// Of one body after the other.
    pub delassus: Delassus,
    /// By pair: a ball that touches a solid.
    pub touches: Vec<Touch>,
    /// By pair: how far it goes in beyond what the solid's net shows.
    pub indentations: Vec<Indentation>,
}

impl Solver {
    /// Forces have three components in this tick.
    pub fn is_whole(&self) -> bool {
        self.matrix.is_whole()
    }

    /// Force of a row on its holder, N.
    pub fn force_n(&self, i: usize, row: &Row) -> Vector3 {
        match self.is_whole() {
            true => self.friction.force_n(i),
            false => row.normal * self.problem.forces()[i],
        }
    }

    /// Replaces the force of a row on its holder, N.
    pub fn set_force_n(&mut self, i: usize, row: &Row, force_n: &Vector3) {
        self.problem.set_force(i, force_n.dot(&row.normal));
        if self.is_whole() {
            self.friction.set_force(i, force_n);
        }
    }

    /// True when a row carries a force that is a number.
    pub fn carries(&self, i: usize) -> bool {
        match self.is_whole() {
            true => {
                let push = self.friction.force_n(i);
                push != Vector3::zeros() && push.iter().all(|x| x.is_finite())
            }
            false => {
                let force_n = self.problem.forces()[i];
                force_n != 0.0 && force_n.is_finite()
            }
        }
    }

    /// Gap of a row under the present forces, m.
    pub fn gap_after(&self, i: usize) -> f64 {
        match self.is_whole() {
            true => self.friction.displaced_m(i).dot(&self.friction.normal(i)),
            false => self.problem.gap_after(&self.matrix, i),
        }
    }
}
