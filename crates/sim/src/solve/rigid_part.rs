//! The rigid part of how a free body answers loads.
//!
//! With T its rigid motions, G = (Tᵀ M T)⁻¹ and Ã the operator of its step's matrix, a free body answers by
//! `A = dt² T G Tᵀ + Π Ã Πᵀ`, Π = 1 − T G Tᵀ M: whatever the matrix misses of a strained body, momentum is what loads make
//! of it. With H = Ã M T and S = Tᵀ M H that is Ã and a low rank:
//! `A − Ã = T (dt² G + G S G) Tᵀ − T G Hᵀ − H G Tᵀ`.

use palpate_geometry::math::{Matrix3, Vector3};

/// A motion or a load in terms of the six rigid motions: linear, then angular.
pub type Six = [Vector3; 2];

/// That of a body in a step.
#[derive(Clone, Debug, Default)]
pub struct RigidPart {
    /// 1/kg, and 1/(kg·m²).
    pub inverse: (f64, Matrix3),
    /// dt², s².
    pub square_s2: f64,
    /// (places), m, from the centre of mass.
    pub arms: Vec<Vector3>,
    /// H (places): what accelerations along the axes, then about them, answer, m.
    pub answers: Vec<[Vector3; 6]>,
    /// S (column after column), kg m and so on.
    pub whole: [Six; 6],
}

/// What loads come to: Tᵀ f and Hᵀ f.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loads {
    rigid: Six,
    answered: Six,
}

/// How much of each motion answers them: of T and of H.
#[derive(Clone, Copy, Debug)]
pub struct Amounts {
    rigid: Six,
    answered: Six,
}

impl RigidPart {
    /// Room for as many places.
    pub fn for_places(count: usize) -> Self {
        Self {
            arms: vec![Vector3::zeros(); count],
            answers: vec![[Vector3::zeros(); 6]; count],
            ..Self::default()
        }
    }

    /// Adds a force at a place.
    pub fn add(&self, place: usize, force: &Vector3, to: &mut Loads) {
        to.rigid[0] += force;
        to.rigid[1] += self.arms[place].cross(force);
        for (k, answer) in self.answers[place].iter().enumerate() {
            to.answered[k / 3][k % 3] += answer.dot(force);
        }
    }

    /// Amounts of T and H under loads.
    pub fn amounts(&self, loads: &Loads) -> Amounts {
        let rigid = self.scaled(&loads.rigid);
        let mut mixed = [Vector3::zeros(); 2];
        for (k, column) in self.whole.iter().enumerate() {
            for (sum, part) in mixed.iter_mut().zip(column) {
                *sum += part * rigid[k / 3][k % 3];
            }
        }
        for (mixed, answered) in mixed.iter_mut().zip(&loads.answered) {
            *mixed -= answered;
        }
        let mixed = self.scaled(&mixed);
        Amounts {
            rigid: [0, 1].map(|k| rigid[k] * self.square_s2 + mixed[k]),
            answered: rigid.map(|part| -part),
        }
    }

    /// What they add to the motion of a place, m.
    pub fn moved(&self, place: usize, amounts: &Amounts) -> Vector3 {
        let [linear, angular] = amounts.rigid;
        let mut moved = linear + angular.cross(&self.arms[place]);
        for (k, answer) in self.answers[place].iter().enumerate() {
            moved += answer * amounts.answered[k / 3][k % 3];
        }
        moved
    }

    /// G times loads.
    fn scaled(&self, six: &Six) -> Six {
        let (per_mass, per_inertia) = &self.inverse;
        [six[0] * *per_mass, per_inertia * six[1]]
    }
}
