//! A body that no material holds together any more is a fault of the tick, in every way to run a scene.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::tick::flags;
use palpate_sim::tick::record::TickFault;

/// A ball of gel that turns so.
pub fn spun(spin_rad_s: f64) -> String {
    format!(
        "[[body]]\nid = \"gel\"\nsurface = {{ builtin = \"sphere\", size = 0.05 }}\nmodel = \"lattice\"\n\
         material = {{ young_pa = 20.0 }}\nlattice = {{ layers = 2, refine = \"none\" }}\nspin_rad_s = [0.0, 0.0, {spin_rad_s}]\n\
         [[tool]]\nid = \"pen\"\npose = {{ position = [0.2, 0.0, 0.0] }}\n"
    )
}

fn length_m(world: &World) -> f64 {
    let mut net = world.scene.rest_surface(0).unwrap().net().points().to_vec();
    world.state.copy_net(&world.scene, 0, &mut net);
    let grown = |(low, high): (Point3, Point3), p: &Point3| (low.inf(p), high.sup(p));
    let (low, high) = net.iter().fold((net[0], net[0]), grown);
    (high - low).norm()
}

#[test]
fn a_gel_that_is_spun_apart_is_a_fault_and_comes_back_to_rest() {
    let mut world = World::new(&spun(600.0));
    let rest_m = length_m(&world);
    let mut fault = None;
    for _ in 0..400 {
        let output = world.at([0.2, 0.0, 0.0]);
        assert!(length_m(&world) < TickFault::MOST_STRETCHED * rest_m);
        if output.fault.is_some() {
            fault = output.fault;
            break;
        }
    }
    assert_eq!(fault, Some(TickFault::CameApart { body: 0 }));
    assert_eq!(length_m(&world), rest_m);
    let after = world.at([0.2, 0.0, 0.0]);
    assert_eq!(after.fault, None);
    assert!(
        after.tools[0].flags & flags::FAULT != 0,
        "no sign for the hand"
    );
}

#[test]
fn a_body_beyond_any_speed_is_a_fault_and_a_fast_one_is_not() {
    for (speed_m_s, apart) in [(100.0, false), (900.0, false), (1_100.0, true), (1e9, true)] {
        let mut world = World::new(&spun(0.0));
        let body = world.state.bodies[0].deformable.as_mut().unwrap();
        body.velocities.fill(Vector3::new(speed_m_s, 0.0, 0.0));
        body.still = 0;
        let state = &world.state;
        world.scene.prepare(state, &mut world.scratch);
        let fault = world.silent().fault;
        let wanted = apart.then_some(TickFault::CameApart { body: 0 });
        assert_eq!(fault, wanted, "{speed_m_s} m/s");
    }
}
