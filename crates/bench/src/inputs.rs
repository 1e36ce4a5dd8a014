//! Queries and movements, the same in every run.

use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;

pub(super) use palpate_geometry::math::Random;

/// In the cube of side 1 around the origin.
fn in_cube(random: &mut Random) -> Vector3 {
    Vector3::new(
        random.unit() - 0.5,
        random.unit() - 0.5,
        random.unit() - 0.5,
    )
}

/// `count` parameters over a domain, ends included.
pub(super) fn spread(domain: (f64, f64), count: usize) -> Vec<f64> {
    let last = (count - 1) as f64;
    (0..count)
        .map(|k| {
            if k + 1 == count {
                domain.1
            } else {
                domain.0 + (domain.1 - domain.0) * k as f64 / last
            }
        })
        .collect()
}

/// Queries in random order about a body: as many near its surface, between surface and axis, around
/// it and far away.
pub(super) fn scattered(surface: &Surface, count: usize) -> Vec<Point3> {
    let mut random = Random(count as u64);
    let size = surface.size();
    let net = surface.net().points();
    let centre = Point3::from(net.iter().map(|p| p.coords).sum::<Vector3>() / net.len() as f64);
    (0..count)
        .map(|k| {
            let (u, v) = (random.unit(), random.unit());
            let point = surface.point(u, v);
            match k % 4 {
                0 => point + surface.normal(u, v) * ((random.unit() - 0.5) * 0.04 * size),
                1 => {
                    let axis = nalgebra::center(&surface.point(0.0, v), &surface.point(0.5, v));
                    nalgebra::center(&axis, &point)
                }
                2 => centre + in_cube(&mut random) * (1.3 * size),
                _ => centre + in_cube(&mut random) * (15.0 * size),
            }
        })
        .collect()
}

/// The tip of a tool, once a millisecond: round and along the body at 0.1 m/s, up to 3 mm above and
/// below the surface, over seam and poles.
pub(super) fn walk(surface: &Surface, count: usize) -> Vec<Point3> {
    const STEP_M: f64 = 1e-4;
    let at = |t: f64| {
        let (u, v) = (0.731 * t, 0.5 + 0.5 * libm::sin(1.0 + 2.618 * t));
        let u = u - u.floor();
        surface.point(u, v) + surface.normal(u, v) * (3e-3 * libm::sin(17.0 * t))
    };
    let (mut t, mut place, mut pace) = (0.0, at(0.0), 1e-3);
    (0..count)
        .map(|_| {
            // The pace that would have made the last step right; near a pole steps shrink and the
            // pace grows.
            let next = at(t + pace);
            pace = (pace * STEP_M / (next - place).norm().max(0.3 * STEP_M)).min(5e-3);
            t += pace;
            place = at(t);
            place
        })
        .collect()
}

/// A body that breathes: the net at a tick, from its rest. Control points move by up to 2 mm at up
/// to 2 µm a tick.
pub(super) fn breathe(rest: &[Point3], tick: usize, net: &mut [Point3]) {
    let swell = 2e-3 * libm::sin(1e-3 * tick as f64);
    for (k, (point, rest)) in net.iter_mut().zip(rest).enumerate() {
        let phase = k as f64;
        let share = 0.577 * swell;
        *point =
            rest + Vector3::new(libm::sin(phase), libm::cos(phase), libm::sin(0.1 * phase)) * share;
    }
}

/// Largest movement of a point, m.
pub(super) fn largest_movement(before: &[Point3], now: &[Point3]) -> f64 {
    before
        .iter()
        .zip(now)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::surface::builtin;

    #[test]
    fn the_walk_is_as_fast_as_a_hand_and_stays_near_the_surface() {
        let surface = builtin("teardrop", None, None).unwrap();
        let walk = walk(&surface, 3000);
        let steps: Vec<f64> = walk.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
        assert!(
            steps.iter().all(|s| *s < 1e-3),
            "{:?}",
            steps.iter().fold(0.0, |a: f64, b| a.max(*b))
        );
        assert!(steps.iter().sum::<f64>() > 0.1, "the walk gets around");
    }

    #[test]
    fn a_breathing_net_moves_little_at_a_time() {
        let rest = vec![Point3::origin(); 5];
        let (mut a, mut b) = (rest.clone(), rest.clone());
        breathe(&rest, 7, &mut a);
        breathe(&rest, 8, &mut b);
        let moved = largest_movement(&a, &b);
        assert!(moved > 1e-7 && moved < 2.5e-6, "{moved}");
    }
}
