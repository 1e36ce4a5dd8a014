//! Impacts of bodies that touch in a row.

use crate::common::{Laws as _, World};
use palpate_geometry::math::Random;

const FAR: [f64; 3] = [5.0, 5.0, 5.0];
const RADIUS_M: f64 = 0.03;

/// Balls in a row along x, each with its gap to the one before, density and speed; all pairs of neighbours with one
/// restitution.
fn row_of_balls(balls: &[(f64, f64, f64)], restitution: f64) -> World {
    let (mut text, mut x) = (String::new(), 0.0);
    for (k, (gap_m, density, speed)) in balls.iter().enumerate() {
        x += if k == 0 { 0.0 } else { 2.0 * RADIUS_M + gap_m };
        text += &format!(
            "[[body]]\nid = \"b{k}\"\nfree = true\nsurface = {{ builtin = \"sphere\", size = {RADIUS_M} }}\n\
             material = {{ density_kg_m3 = {density:?} }}\npose = {{ position = [{x:?}, 0.0, 0.0] }}\n\
             velocity_m_s = [{speed:?}, 0.0, 0.0]\n"
        );
    }
    for k in 1..balls.len() {
        text += &format!(
            "[[contact]]\npair = [\"b{}\", \"b{k}\"]\nrestitution = {restitution:?}\n",
            k - 1
        );
    }
    World::new(&format!(
        "{text}[[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\npose = {{ position = {FAR:?} }}\n"
    ))
}

fn speeds(world: &World, count: usize) -> Vec<f64> {
    let of = |body| world.state.rigid_motion(&world.scene, body).unwrap();
    (0..count).map(|body| of(body).velocity_m_s.x).collect()
}

// As many leave as came, whether the others touch or are less than a tick's way apart.
#[test]
fn a_cradle_of_balls_in_touch_sends_off_as_many_as_come() {
    let mut random = Random(17);
    for (count, come) in [(2, 1), (3, 1), (5, 1), (5, 2), (5, 3), (7, 2), (6, 5)] {
        for gap_m in [0.0, 1e-9, 1e-5] {
            let speed = 0.2 + 0.8 * random.unit();
            let balls: Vec<(f64, f64, f64)> = (0..count)
                .map(|k| match k {
                    k if k < come => (0.0, 1000.0, speed),
                    k if k == come => (1e-3, 1000.0, 0.0),
                    _ => (gap_m, 1000.0, 0.0),
                })
                .collect();
            let mut world = row_of_balls(&balls, 1.0);
            for _ in 0..60 {
                world.at_in_place(FAR);
            }
            let after = speeds(&world, count);
            for (k, after) in after.iter().enumerate() {
                let expected = if k >= count - come { speed } else { 0.0 };
                assert!(
                    (after - expected).abs() < 1e-9,
                    "{come} of {count}, {gap_m} m apart: {after} for {expected} m/s of ball {k}"
                );
            }
        }
    }
}

// Of any masses and restitution: momentum is kept, energy never gained, and kept at 1; none stays inside another.
#[test]
fn chains_of_any_masses_keep_momentum_and_gain_no_energy() {
    let mut random = Random(29);
    for case in 0..24 {
        let count = 3 + case % 4;
        let balls: Vec<(f64, f64, f64)> = (0..count)
            .map(|k| {
                let density = 1000.0 * libm::exp(4.0 * random.unit() - 2.0);
                (0.0, density, if k == 0 { 0.8 } else { 0.0 })
            })
            .collect();
        let restitution = [1.0, 0.7, 0.3][case % 3];
        let mut world = row_of_balls(&balls, restitution);
        let total = |world: &World| {
            let of = |body| world.state.rigid_motion(&world.scene, body).unwrap();
            let each = (0..count).map(of);
            each.fold((0.0, 0.0), |(momentum, energy), m| {
                (momentum + m.mass_kg * m.velocity_m_s.x, energy + m.energy_j)
            })
        };
        let before = total(&world);
        for _ in 0..40 {
            world.at_in_place(FAR);
        }
        let (momentum, energy) = total(&world);
        let after = speeds(&world, count);
        assert!(
            (momentum / before.0 - 1.0).abs() < 1e-11,
            "{case}: momentum {momentum} of {}",
            before.0
        );
        let left = energy / before.1;
        // What meets more slowly than 1 cm/s does not bounce.
        let heaviest = balls.iter().map(|ball| ball.1).fold(0.0, f64::max) / balls[0].1;
        let slow_j = before.1 * (0.01f64 / 0.8).powi(2) * heaviest * count as f64;
        assert!(left < 1.0 + 1e-11, "{case}: {left} of the energy");
        assert!(
            restitution < 1.0 || (1.0 - left) * before.1 < slow_j,
            "{case}: {left} of the energy, {after:?}"
        );
        assert!(
            after.windows(2).all(|pair| pair[1] > pair[0] - 1e-3),
            "{case}: still meeting, {after:?}"
        );
    }
}
