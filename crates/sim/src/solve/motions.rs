//! Free rigid bodies as unknowns of a solve: six numbers a body, however many rows it has.
//!
//! A body moves by x and turns by θ in a tick. A row at an arm a from its centre, which pushes it with a sign s, goes
//! by J (x, θ) = s (x + θ × a); a force f on the row loads the body with Jᵀ f = s (f, a × f).

use palpate_geometry::math::{Matrix3, Vector3};

/// Where a row acts on a body.
#[derive(Clone, Copy, Debug)]
pub struct Lever {
    /// The body's number among the [`Motions`].
    pub body: usize,
    /// The sign with which the row's force pushes it.
    pub sign: f64,
    /// From its centre of mass, m.
    pub arm: Vector3,
}

impl Lever {
    /// J: what multiplies x, then what multiplies θ.
    pub fn blocks(&self) -> [Matrix3; 2] {
        let turned = self.arm.cross_matrix() * -self.sign;
        [Matrix3::from_diagonal_element(self.sign), turned]
    }
}

/// The free rigid bodies of a tick and the rows on them.
#[derive(Clone, Debug)]
pub struct Motions {
    /// By body: m / dt² (N/m) and I / dt² (N·m/rad), in the world.
    inertias: Vec<(f64, Matrix3)>,
    /// By row.
    levers: Vec<[Option<Lever>; 2]>,
}

impl Motions {
    /// Room for rows on bodies.
    pub fn new(rows: usize, bodies: usize) -> Self {
        Self {
            inertias: Vec::with_capacity(bodies),
            levers: Vec::with_capacity(rows),
        }
    }

    /// No bodies yet, and so many rows on none of them.
    pub fn begin(&mut self, rows: usize) {
        self.inertias.clear();
        self.levers.clear();
        self.levers.resize(rows, [None; 2]);
    }

    /// Adds a body, m / dt² (N/m) and I / dt² (N·m/rad), and answers with its number.
    pub fn add_body(&mut self, inertia: (f64, Matrix3)) -> usize {
        self.inertias.push(inertia);
        self.inertias.len() - 1
    }

    /// Adds where a row acts on a body.
    pub fn add_lever(&mut self, row: usize, lever: Lever) {
        let free = self.levers[row].iter_mut().find(|slot| slot.is_none());
        debug_assert!(free.is_some(), "a row has two sides");
        if let Some(slot) = free {
            *slot = Some(lever);
        }
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.inertias.len()
    }

    /// m / dt² and I / dt² of a body.
    pub fn inertia(&self, body: usize) -> &(f64, Matrix3) {
        &self.inertias[body]
    }

    /// Where a row acts.
    pub fn of_row(&self, row: usize) -> impl Iterator<Item = &Lever> + Clone {
        self.levers[row].iter().flatten()
    }
}
