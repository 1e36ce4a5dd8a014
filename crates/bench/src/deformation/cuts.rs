//! Bodies that are cut while they move: how long all takes until the loop can take the pieces over, and what of mass and
//! momentum is lost.

use super::world::World;
use crate::measure::{Times, clocked};
use crate::{Effort, Row};
use palpate_geometry::cut::CutPlane;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::scene::{Scene, SceneCut};
use palpate_sim::tick::{CarryOver, SceneState};

/// Bodies: name, what the scene says of it, a point of the plane, its normal.
const BODIES: [(&str, &str, [f64; 3], [f64; 3]); 5] = [
    (
        "ball",
        "surface = { builtin = \"sphere\", size = 0.03 }\nmodel = \"continuum\"",
        [0.0, 0.0, 0.004],
        [0.2, 0.1, 1.0],
    ),
    (
        "ball 12³",
        "surface = { builtin = \"sphere\", size = 0.03 }\nmodel = \"lattice\"\nlattice = { builder = \"transfinite\", nodes = [12, 12, 12] }",
        [0.0, 0.0, 0.004],
        [0.2, 0.1, 1.0],
    ),
    (
        "drop",
        "surface = { builtin = \"teardrop\" }\nmodel = \"continuum\"",
        [0.0, 0.0, 0.04],
        [0.5, 0.0, 1.0],
    ),
    (
        "drop lattice",
        "surface = { builtin = \"teardrop\" }\nmodel = \"lattice\"",
        [0.0, 0.0, 0.04],
        [0.5, 0.0, 1.0],
    ),
    (
        "ring",
        "surface = { builtin = \"torus\" }\nmodel = \"continuum\"",
        [0.001, 0.0, 0.0],
        [1.0, 0.2, 0.1],
    ),
];
/// Ticks before the cut.
const TICKS: usize = 50;

/// Cases `cut/<body>`.
pub(super) fn cuts(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for (name, body, point, normal) in BODIES {
        let case = format!("cut/{name}");
        if wanted(&case) {
            let row = Row::new("deformation", &case, "palpate");
            out(match cut(effort, body, point, normal) {
                Ok((times, off, note)) => row.timed(times).off_by(off, "").saying(note),
                Err(reason) => row.saying(reason),
            });
        }
    }
}

/// Times from the request to a scene that the loop can take, the largest relative error of mass, momentum and angular
/// momentum, and the pieces in words.
fn cut(
    effort: Effort,
    body: &str,
    point: [f64; 3],
    normal: [f64; 3],
) -> Result<(Option<Times>, f64, String), String> {
    let mut world = World::new(&format!(
        "[[body]]\nid = \"body\"\n{body}\nmaterial = {{ young_pa = 2e4 }}\nvelocity_m_s = [0.1, -0.2, 0.05]\n\
         spin_rad_s = [3.0, 10.0, -5.0]\n[[tool]]\nid = \"pen\"\nshape = {{ point = {{}} }}\npose = {{ position = [0.0, 0.0, 0.5] }}\n"
    ))?;
    for _ in 0..TICKS {
        world.at([0.0, 0.0, 0.5]);
    }
    let plane = CutPlane::through(&point.into(), &normal.into()).ok_or("no plane")?;
    let coordinates = world.state.coordinates(0).ok_or("a rigid body")?.to_vec();
    let mut points = world.scene.skin(0).points().to_vec();
    world.state.copy_net(&world.scene, 0, &mut points);
    let count = match effort {
        Effort::Quick => 2,
        Effort::Full => 9,
    };
    let mut times_s = Vec::new();
    let (mut off, mut note) = (f64::NAN, String::new());
    for _ in 0..count {
        let (took, made) = clocked(|| made(&world, (&points, &coordinates), &plane));
        times_s.push(took.as_secs_f64());
        let (done, next, carry) = made?;
        let mut state = next.initial_state();
        next.carry_over(&world.scene, &world.state, &carry, &mut state);
        off = largest(motion(&world.scene, &world.state), motion(&next, &state));
        let misses = done
            .pieces
            .iter()
            .map(|piece| piece.skin.off_m)
            .fold(0.0, f64::max);
        note = format!(
            "{} pieces, surfaces within {misses:.1e} m",
            done.pieces.len()
        );
    }
    Ok((Times::of(times_s), off, note))
}

type Made = (SceneCut, Scene, CarryOver);

fn made(world: &World, standing: (&[Point3], &[Point3]), plane: &CutPlane) -> Result<Made, String> {
    let done = SceneCut::new(&world.scene, 0, standing, plane, 0.0).map_err(|e| e.to_string())?;
    let next = done.change.build_to_run().map_err(|e| e.to_string())?;
    let carry = CarryOver::new(&world.scene, &next, done.change.origins().to_vec());
    let state = next.initial_state();
    drop(next.scratch(&state));
    Ok((done, next, carry))
}

/// Mass, kg, momentum, and angular momentum about the origin.
fn motion(scene: &Scene, state: &SceneState) -> (f64, Vector3, Vector3) {
    let mut sum = (0.0, Vector3::zeros(), Vector3::zeros());
    for body in 0..scene.body_count() {
        let (Some(of), Some(now)) = (scene.deformable(body), &state.bodies[body].deformable) else {
            continue;
        };
        for ((x, v), m) in now.positions.iter().zip(&now.velocities).zip(of.masses()) {
            sum.0 += m;
            sum.1 += v * *m;
            sum.2 += x.coords.cross(v) * *m;
        }
    }
    sum
}

fn largest(before: (f64, Vector3, Vector3), after: (f64, Vector3, Vector3)) -> f64 {
    let mass = (after.0 / before.0 - 1.0).abs();
    let linear = (after.1 - before.1).norm() / before.1.norm();
    mass.max(linear)
        .max((after.2 - before.2).norm() / before.2.norm())
}
