//! Signed distances of two bodies, and places where they are equal or zero.

use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ClosestPoint, ClosestSolver, Surface};

/// Newton's steps and halvings at most.
const STEPS: usize = 60;
/// Of the size: a difference of distances that is rounding.
const ZERO: f64 = 1e-12;
/// Squared length of a difference of two unit normals that has no direction.
const FLAT: f64 = 1e-12;

/// Both signed distances of a point, m, negative inside, and their gradients: the normals at the feet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depths {
    pub phi: [f64; 2],
    pub normals: [Vector3; 2],
}

impl Depths {
    /// φ_A − φ_B, m: negative where the point is deeper in the first body.
    pub fn lead(&self) -> f64 {
        self.phi[0] - self.phi[1]
    }

    /// The gradient of [`Self::lead`].
    pub fn slope(&self) -> Vector3 {
        self.normals[0] - self.normals[1]
    }

    /// Half of φ_A + φ_B, m: the depth where both are equal.
    pub fn mean(&self) -> f64 {
        0.5 * (self.phi[0] + self.phi[1])
    }

    /// In both bodies.
    pub fn in_both(&self) -> bool {
        self.phi[0] < 0.0 && self.phi[1] < 0.0
    }
}

/// Two closed surfaces whose normals point outwards.
pub(super) struct Fields<'a> {
    pub surfaces: [&'a Surface; 2],
    solvers: [ClosestSolver; 2],
    /// Diagonal of the smaller body's net, m: what tolerances refer to.
    pub size_m: f64,
}

impl<'a> Fields<'a> {
    pub fn new(surfaces: [&'a Surface; 2]) -> Self {
        Self {
            surfaces,
            solvers: surfaces.map(ClosestSolver::new),
            size_m: surfaces[0].size().min(surfaces[1].size()),
        }
    }

    /// The solvers, for queries about both surfaces.
    pub fn solvers(&mut self) -> [&mut ClosestSolver; 2] {
        self.solvers.each_mut()
    }

    pub fn at(&mut self, q: &Point3) -> Depths {
        let feet: [_; 2] = std::array::from_fn(|k| self.solvers[k].closest(self.surfaces[k], q));
        Depths {
            phi: feet.map(|foot| foot.signed_distance),
            normals: feet.map(|foot| foot.normal),
        }
    }

    /// The foot on one body's surface.
    pub fn foot(&mut self, body: usize, q: &Point3) -> ClosestPoint {
        self.solvers[body].closest(self.surfaces[body], q)
    }

    /// The signed distance of one body, m.
    pub fn phi(&mut self, body: usize, q: &Point3) -> f64 {
        self.foot(body, q).signed_distance
    }

    /// The place near `q` on both surfaces: each step is the shortest onto both tangent planes. The nearest that was met
    /// where they are tangent.
    pub fn onto_rim(&mut self, q: &Point3) -> Point3 {
        let (mut q, mut best) = (*q, (f64::INFINITY, *q));
        for _ in 0..8 {
            let Depths { phi, normals } = self.at(&q);
            let off_m = phi[0].abs().max(phi[1].abs());
            if off_m >= 0.5 * best.0 {
                break;
            }
            best = (off_m, q);
            let [a, b] = normals;
            let cos = a.dot(&b);
            let det = 1.0 - cos * cos;
            if off_m <= 1e-15 * self.size_m || det < FLAT {
                break;
            }
            // a · d = −φ_A and b · d = −φ_B, d in the plane of a and b.
            let shares = [(cos * phi[1] - phi[0]) / det, (cos * phi[0] - phi[1]) / det];
            q += a * shares[0] + b * shares[1];
        }
        best.1
    }

    /// The place near `q` where both distances are equal: Newton's steps along the gradient of their difference, and
    /// halvings where it is not smooth. `None` where there is none near by.
    pub fn onto_wall(&mut self, q: &Point3) -> Option<Point3> {
        let zero_m = ZERO * self.size_m;
        let (mut here, mut at) = (*q, self.at(q));
        for _ in 0..STEPS {
            let lead = at.lead();
            if lead.abs() <= zero_m {
                return Some(here);
            }
            let slope = at.slope();
            let steep = slope.norm_squared();
            if steep < FLAT {
                return None;
            }
            let next = here - slope * (lead / steep);
            if (next - q).norm() > self.size_m {
                return None;
            }
            let after = self.at(&next);
            if after.lead() * lead < 0.0 && after.lead().abs() > 0.1 * lead.abs() {
                return Some(self.between([here, next], [lead, after.lead()]));
            }
            (here, at) = (next, after);
        }
        None
    }

    /// The zero of φ_A − φ_B on a line between places of opposite sign: regula falsi, halved where it is slow.
    fn between(&mut self, mut ends: [Point3; 2], mut leads: [f64; 2]) -> Point3 {
        let zero_m = ZERO * self.size_m;
        for step in 0..STEPS {
            let share = match step % 3 {
                2 => 0.5,
                _ => leads[0] / (leads[0] - leads[1]),
            };
            let middle = ends[0] + (ends[1] - ends[0]) * share;
            let lead = self.at(&middle).lead();
            let side = usize::from(lead * leads[0] <= 0.0);
            (ends[side], leads[side]) = (middle, lead);
            if lead.abs() <= zero_m || (ends[1] - ends[0]).norm() <= zero_m {
                break;
            }
        }
        ends[usize::from(leads[1].abs() < leads[0].abs())]
    }
}
