//! rapier3d's soft bodies: tetrahedra of stable neo-Hookean material with pinned particles, touched
//! by a kinematic ball.

use rapier3d_f64::prelude::*;

/// Box under a ball, as the suite's other methods press it.
pub(crate) struct SoftBox {
    world: PhysicsWorld,
    ball: RigidBodyHandle,
    collider: ColliderHandle,
}

/// How rapier solves the elasticity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Solver {
    /// Rows beside contacts and joints, swept once a substep: its default.
    Rows,
    /// Its implicit finite elements.
    Elements,
}

/// Half the thickness that rapier gives the surface, m. The ball starts as much higher.
const SKIN_M: f64 = 1e-4;
const BALL_M: f64 = 0.03;

impl SoftBox {
    /// 0.1 m with `nodes` particles a side, the lowest pinned, its top at z = 0.
    pub(crate) fn new(
        nodes: usize,
        young_pa: f64,
        dt_s: f64,
        substeps: usize,
        solver: Solver,
    ) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let parameters = &mut world.integration_parameters;
        parameters.dt = dt_s;
        parameters.num_solver_iterations = substeps;
        // Its tolerances are shares of this length: a thousandth of it is let overlap.
        parameters.length_unit = 0.1;
        let material = SoftBodyMaterial {
            young_modulus: young_pa,
            poisson_ratio: 0.3,
            ..SoftBodyMaterial::default()
        };
        let of_solver = match solver {
            Solver::Rows => SoftBodySolver::Constraints,
            Solver::Elements => SoftBodySolver::Fem,
        };
        let body = SoftBodyBuilder::cuboid(
            Vector::new(0.0, 0.0, -0.05),
            Vector::splat(0.05),
            nodes,
            nodes,
            nodes,
        );
        let lowest: Vec<u32> = (0..nodes * nodes)
            .map(|column| (column * nodes) as u32)
            .collect();
        let body = body
            .mass(1.0)
            .pinned_particles(lowest)
            .material(material)
            .cell_model(SoftBodyCellModel::NeoHookean)
            .solver(of_solver)
            .particle_radius(SKIN_M)
            .can_sleep(false)
            .surface_collider(ColliderBuilder::ball(1.0).friction(0.0));
        world.insert_soft_body(body);
        let start = RigidBodyBuilder::kinematic_position_based().translation(Vector::new(
            0.0,
            0.0,
            BALL_M + 2e-3,
        ));
        let (ball, collider) = world.insert(start, ColliderBuilder::ball(BALL_M).friction(0.0));
        Self {
            world,
            ball,
            collider,
        }
    }

    /// One step with the ball pressed this deep, m; the force on it, N.
    pub(crate) fn press(&mut self, depth_m: f64) -> f64 {
        let height = BALL_M + SKIN_M - depth_m;
        self.world.bodies[self.ball].set_next_kinematic_translation(Vector::new(0.0, 0.0, height));
        self.world.step();
        let dt_s = self.world.integration_parameters.dt;
        let pairs = self.world.narrow_phase.contact_pairs_with(self.collider);
        pairs.map(|pair| pair.total_impulse().z.abs() / dt_s).sum()
    }
}

/// A beam that is let go, as the suite's other methods swing it: the same grid of points, cubes of
/// tetrahedra between them.
pub(crate) struct SoftBeam {
    world: PhysicsWorld,
    body: SoftBodyHandle,
    /// Particles, and their height at rest.
    tip: Vec<(usize, f64)>,
}

impl SoftBeam {
    /// `counts` particles along x from 0, across y about 0 and down from z = 0, those up to `held_m`
    /// pinned, and without damping; `starts` is where particles at places of rest are now.
    pub(crate) fn new(
        counts: [usize; 3],
        sides_m: [f64; 3],
        held_m: f64,
        young_pa: f64,
        (substeps, solver): (usize, Solver),
        starts: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let parameters = &mut world.integration_parameters;
        parameters.dt = 1e-3;
        parameters.num_solver_iterations = substeps;
        parameters.length_unit = sides_m[0];
        let material = SoftBodyMaterial {
            young_modulus: young_pa,
            poisson_ratio: 0.25,
            elastic_damping_ratio: 0.0,
            ..SoftBodyMaterial::default()
        };
        let of_solver = match solver {
            Solver::Rows => SoftBodySolver::Constraints,
            Solver::Elements => SoftBodySolver::Fem,
        };
        let [length, width, thickness] = sides_m;
        let body = SoftBodyBuilder::cuboid(
            Vector::new(0.5 * length, 0.0, -0.5 * thickness),
            Vector::new(length, width, thickness) * 0.5,
            counts[0],
            counts[1],
            counts[2],
        )
        .mass(1_000.0 * length * width * thickness)
        .material(material)
        .cell_model(SoftBodyCellModel::NeoHookean)
        .solver(of_solver)
        .can_sleep(false);
        let body = world.insert_soft_body(body);
        let mut tip = Vec::new();
        if let Some(soft) = world.soft_bodies.get_mut(body) {
            for k in 0..soft.num_particles() {
                let rest = soft.particle_position(k);
                if rest.x < held_m + 1e-9 {
                    soft.set_particle_pinned(k, true);
                    continue;
                }
                if rest.x > length - 1e-9 {
                    tip.push((k, rest.z));
                }
                let [x, y, z] = starts([rest.x, rest.y, rest.z]);
                soft.set_particle_position(k, Vector::new(x, y, z));
            }
        }
        Self { world, body, tip }
    }

    /// One step of 1 ms; how far the free end is above rest, m.
    pub(crate) fn step(&mut self) -> f64 {
        self.world.step();
        let soft = (self.world.soft_bodies.get(self.body)).expect("the beam stays in its world");
        let heights = self
            .tip
            .iter()
            .map(|&(k, z)| soft.particle_position(k).z - z);
        heights.sum::<f64>() / self.tip.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_grows_with_depth_and_is_of_the_size_of_hertz() {
        let mut soft = SoftBox::new(6, 20e3, 1e-3, 4, Solver::Rows);
        let mut held = |depth_m: f64| {
            let mut force_n = 0.0;
            for k in 0..150 {
                force_n = soft.press(depth_m * (f64::from(k) / 50.0).min(1.0));
            }
            force_n
        };
        let (shallow, deep) = (held(2e-3), held(8e-3));
        // 4/3 E/(1 − ν²) √R d^1.5 of a half space; a box of finite depth is stiffer, a coarse one
        // too.
        let hertz = |d: f64| 4.0 / 3.0 * 20e3 / 0.91 * libm::sqrt(0.03) * libm::pow(d, 1.5);
        assert!(
            shallow > 0.3 * hertz(2e-3) && shallow < 3.0 * hertz(2e-3),
            "{shallow} N"
        );
        assert!(
            deep > 0.5 * hertz(8e-3) && deep < 2.0 * hertz(8e-3),
            "{deep} N"
        );
    }

    #[test]
    fn a_beam_that_is_let_go_swings_through() {
        let bent = |[x, y, z]: [f64; 3]| [x, y, z + x * x];
        let solver = (4, Solver::Rows);
        let mut beam = SoftBeam::new([11, 3, 3], [0.1, 0.02, 0.02], 0.0, 200e3, solver, bent);
        let least = (0..200).map(|_| beam.step()).fold(f64::INFINITY, f64::min);
        assert!(least < -1e-3 && least > -0.02, "{least} m of 0.01 m");
    }
}
