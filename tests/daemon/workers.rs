//! Steps on worker threads have the bits of steps on the tick thread.

use crate::common::{World, press};
use palpate::drive::workers::Workers;
use palpate_geometry::math::{SavedState, state_hash};
use palpate_sim::tick::restore;
use std::sync::Arc;

const BALL: &str = r#"
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.02 } }
pose = { position = [0.0, 0.0, 0.05] }
coupling = { stiffness_n_m = inf, damping_n_s_m = 0.0 }
device = { force_max_n = 1e9, ramp_s = 0.0 }
"#;

fn slab(model: &str, more: &str) -> String {
    format!(
        r#"
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [7, 7], size = 0.1 }}
model = "{model}"
lattice = {{ layers = 4, refine = "none", thickness_m = 0.03 }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]
{more}
{BALL}"#
    )
}

#[test]
fn a_body_that_steps_every_fourth_tick_has_the_same_bits_on_a_thread() {
    let text = slab("lattice", "integrator = { every = 4 }");
    let (mut here, mut there) = (World::new(&text), World::new(&text));
    let scene = Arc::new(World::new(&text).scene);
    there.scratch.set_pipeline(Box::new(
        Workers::start(&scene)
            .unwrap()
            .expect("a body that steps apart"),
    ));
    let place = |k: u32| {
        [
            0.001 * libm::sin(f64::from(k) * 0.01),
            0.0,
            0.025 - 0.009 * (f64::from(k) / 400.0).min(1.0),
        ]
    };
    let mut saved = SavedState::default();
    for k in 0..1_001 {
        let (a, b) = (here.at(place(k)), there.at(place(k)));
        assert_eq!(a, b, "tick {k}");
        assert_eq!(
            state_hash(&here.state),
            state_hash(&there.state),
            "tick {k}"
        );
        if k == 701 {
            // In the middle of a step.
            saved.save_from(&there.state);
        }
    }
    // From there on anew, while a step of later is still under way on the thread.
    restore(&there.scene, &mut there.state, &mut there.scratch, &saved).unwrap();
    there.seq = 702;
    for k in 702..1_001 {
        there.at(place(k));
    }
    assert_eq!(state_hash(&here.state), state_hash(&there.state));
    // At rest it presses as a body does that steps every tick.
    let mut each = World::new(&slab("lattice", ""));
    let (slow, quick) = (press(&mut here, 0.003, 600), press(&mut each, 0.003, 600));
    assert!(
        (slow / quick - 1.0).abs() < 1e-3,
        "{slow} N every fourth tick, {quick} N every tick"
    );
}
