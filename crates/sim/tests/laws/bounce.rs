//! Bodies that fall on something: contact in the tick in which it begins.

use super::common::{Laws as _, World};
use palpate_geometry::basis::KnotVector;
use palpate_sim::tick::flags;

/// A ball of jelly 2 mm above a plane, as fast as after a fall of 0.1 m.
const BALL: &str = r#"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
id = "ball"
surface = { builtin = "sphere", net = [8, 8], size = 0.03 }
pose = { position = [0.0, 0.0, 0.032] }
velocity_m_s = [0.0, 0.0, -1.4]
model = "continuum"
material = { young_pa = 20e3, poisson = 0.3, density_kg_m3 = 1000.0, damping_s = 1e-3 }
lattice = { layers = 3, refine = "none" }
integrator = { iterations = 8 }
[[tool]]
id = "floor"
shape = { plane = { normal = [0.0, 0.0, 1.0] } }
pose = { position = [0.0, 0.0, 0.0] }
coupling = { stiffness_n_m = inf, damping_n_s_m = 0.0 }
device = { force_max_n = 1e9, ramp_s = 0.0 }
"#;

/// The middles of the parts of every knot span.
fn middles(knots: &KnotVector, parts: usize) -> Vec<f64> {
    let mut places = Vec::new();
    for span in knots.spans() {
        let (from, to) = (knots.knots()[span], knots.knots()[span + 1]);
        places.extend((0..parts).map(|k| from + (to - from) * (k as f64 + 0.5) / parts as f64));
    }
    places
}

// Places that came to touch within a tick were met in the next one, by then as deep as they are fast:
// pushed out with the energy of that depth.
#[test]
fn a_falling_ball_is_met_where_it_comes_to_touch() {
    let mut world = World::new(BALL);
    let mut surface = world.scene.rest_surface(0).unwrap().clone();
    let grids = [3, 9]
        .map(|parts| [surface.knots_u(), surface.knots_v()].map(|knots| middles(knots, parts)));
    let (mut deepest_m, mut shortened) = ([0.0_f64; 2], 0);
    for _ in 0..45 {
        // A motion that strains cells by more than a step can follow is shortened; the tool says so.
        if world.at([0.0; 3]).tools[0].flags & flags::DEGRADED != 0 {
            shortened += 1;
            continue;
        }
        (world.state).copy_net(&world.scene, 0, surface.net_mut().points_mut());
        for (deepest_m, [us, vs]) in deepest_m.iter_mut().zip(&grids) {
            for u in us {
                for v in vs {
                    *deepest_m = deepest_m.max(-surface.point(*u, *v).z);
                }
            }
        }
    }
    // Samples are met where the tick ends, but for those that contact beside them pushes down within it; between them
    // the ball is as round as it is.
    let [at_samples_m, between_m] = deepest_m;
    assert!(at_samples_m < 5e-5, "{at_samples_m} m at a sample");
    assert!(shortened <= 8, "{shortened} ticks are shortened");
    assert!(between_m < 0.5e-3, "{between_m} m between samples");
}
