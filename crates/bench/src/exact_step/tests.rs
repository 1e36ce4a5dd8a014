//! Steps and equilibria in closed form, and our own step where it has converged.

use super::contact::{Skin, Touch};
use super::obstacle::Obstacle;
use super::*;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::TickInput;
use palpate_sim::tick::step;
use std::path::Path;

/// A sheet of 0.1 m and its tool, which is far away.
fn sheet(model: &str, net: [usize; 2], thickness_m: f64, more: &str) -> Scene {
    let text = format!(
        "[[body]]\nid = \"sheet\"\nsurface = {{ builtin = \"sheet\", net = {net:?}, size = 0.1 }}\nmodel = \"{model}\"\n\
         lattice = {{ layers = 3, refine = \"none\", thickness_m = {thickness_m:?} }}\n{more}\n\
         [[tool]]\nid = \"pen\"\nshape = {{ point = {{}} }}\npose = {{ position = [0.0, 0.0, 1.0] }}\n"
    );
    let loaded = file::parse(&text, "test.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    Scene::build(&loaded.spec, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_free_body_falls_by_g_dt_squared_in_its_first_step() {
    let scene = sheet("continuum", [6, 5], 0.02, "");
    let body = scene.deformable(0).unwrap();
    let mut exact = ExactStep::new(body);
    exact.gravity = Vector3::new(0.0, 0.0, -9.81);
    let mut state = body.rest_state();
    state.velocities.fill(Vector3::new(0.3, 0.0, 0.0));
    let loads = vec![Vector3::zeros(); body.coordinate_count()];
    let before = state.positions.clone();
    exact.step(&mut state, &loads).unwrap();
    for (now, before) in state.positions.iter().zip(&before) {
        let moved = now - before - Vector3::new(3e-4, 0.0, -9.81e-6);
        assert!(moved.norm() < 1e-15, "off by {moved:?}");
    }
}

// ν = 0 and a load spread as trapezoids over the end: strain is F / (A E) everywhere.
#[test]
fn a_rod_that_is_drawn_is_longer_by_f_l_over_a_e() {
    let (young, thickness) = (50e3, 0.02);
    let more = format!(
        "material = {{ young_pa = {young:?}, poisson = 0.0, damping_s = 0.0 }}\n\
         fixed = [{{ point = [-0.0499, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }}]"
    );
    let scene = sheet("continuum", [7, 4], thickness, &more);
    let body = scene.deformable(0).unwrap();
    let mut state = body.rest_state();
    let rest = state.positions.clone();
    let share = |p: &Point3| {
        let across = [
            p.y.abs() > 0.0499,
            p.z.abs() < 1e-6 || p.z < 1e-6 - thickness,
        ];
        across
            .map(|edge| if edge { 0.5 } else { 1.0 })
            .iter()
            .product::<f64>()
    };
    let at_end = |p: &Point3| p.x > 0.0499;
    let sum: f64 = rest.iter().filter(|p| at_end(p)).map(share).sum();
    let force = 1e-6 * young * 0.1 * thickness;
    let loads: Vec<Vector3> = rest
        .iter()
        .map(|p| {
            Vector3::x()
                * if at_end(p) {
                    force * share(p) / sum
                } else {
                    0.0
                }
        })
        .collect();
    ExactStep::new(body).settle(&mut state, &loads, 1).unwrap();
    let from = -0.0499;
    for (now, before) in state.positions.iter().zip(&rest) {
        // It gives way from the plane on.
        let strain_m = 1e-6 * (before.x - from).max(0.0);
        let miss = (now - before - Vector3::x() * strain_m).norm();
        // Strain changes the stiffness, by a share of about the strain.
        assert!(miss < 1e-5 * 1e-7, "{before:?} is off by {miss} m");
    }
}

// The step of the library, with as many iterations as it takes, on its way back from a load.
#[test]
fn sixty_iterations_of_our_step_are_the_exact_step() {
    for (model, damping_s) in [
        ("lattice", 0.0),
        ("continuum", 0.0),
        ("continuum", 2e-3),
        ("net", 0.0),
        ("membrane", 0.0),
    ] {
        let thickness = if model == "membrane" { 4e-3 } else { 0.03 };
        let more = format!(
            "material = {{ young_pa = 20e3, poisson = 0.25, damping_s = {damping_s:?} }}\n\
             integrator = {{ sleep_m_s = 0.0, iterations = 60 }}\nfixed = [{{ u = [0.0, 0.2], v = [0.0, 1.0] }}]"
        );
        let scene = sheet(model, [7, 5], thickness, &more);
        let body = scene.deformable(0).unwrap();
        let mut exact = ExactStep::new(body);
        exact.damping_s = damping_s;
        let mut state = body.rest_state();
        let end = state.positions.iter().map(|p| p.x).fold(0.0, f64::max);
        let tip_n = if model == "membrane" { 1e-5 } else { 1e-3 };
        let load = |p: &Point3| Vector3::z() * if p.x > end - 1e-9 { tip_n } else { 0.0 };
        let loads: Vec<Vector3> = state.positions.iter().map(load).collect();
        exact
            .settle(&mut state, &loads, 4)
            .unwrap_or_else(|e| panic!("{model}: {e}"));
        let none = vec![Vector3::zeros(); loads.len()];
        let mut whole = scene.initial_state();
        let ours = whole.bodies[0].deformable.as_mut().unwrap();
        ours.positions.clone_from(&state.positions);
        let mut scratch = scene.scratch(&whole);
        let mut input = TickInput::default();
        for tick in 0..20 {
            input.poses[0] = None;
            step(&scene, &mut whole, &mut scratch, &input);
            let ours = whole.bodies[0].deformable.as_ref().unwrap();
            let before = state.positions.clone();
            let solved = exact.step(&mut state, &none).unwrap();
            let (mut motion, mut miss) = (0.0f64, 0.0f64);
            for ((now, before), ours) in state.positions.iter().zip(&before).zip(&ours.positions) {
                motion = motion.max((now - before).norm());
                miss = miss.max((ours - now).norm());
            }
            assert!(
                miss < 1e-8 * motion * (tick + 1) as f64,
                "{model}, tick {tick}: {miss} m of {motion} m, exact to {}",
                solved.residual
            );
        }
    }
}

// ν = 0: a plate that lies flat on the far face presses the slab evenly, with E A times the strain.
#[test]
fn a_plane_presses_a_slab_with_e_a_times_the_strain() {
    let (young, thickness, strain) = (50e3, 0.02, 1e-6);
    let more = format!(
        "material = {{ young_pa = {young:?}, poisson = 0.0, damping_s = 0.0 }}\n\
         fixed = [{{ point = [0.0, 0.0, {:?}], normal = [0.0, 0.0, 1.0] }}]",
        1e-6 - thickness
    );
    let scene = sheet("continuum", [6, 5], thickness, &more);
    let body = scene.deformable(0).unwrap();
    let mut exact = ExactStep::new(body);
    // So long that inertia is nothing beside what holds the body.
    exact.dt_s = 1e4;
    let skin = Skin::new(
        &exact,
        scene.rest_surface(0).expect("a surface"),
        [21, 21],
        |_| true,
    )
    .unwrap();
    let (mut state, mut touch) = (body.rest_state(), Touch::default());
    let plate = Obstacle::Plane {
        point: Point3::new(0.0, 0.0, -strain * thickness),
        normal: -Vector3::z(),
    };
    let none = vec![Vector3::zeros(); body.coordinate_count()];
    exact
        .step_touching(&mut state, &none, &skin, &plate, &mut touch)
        .unwrap();
    let force = young * 0.1 * 0.1 * strain;
    assert!(
        (-touch.force_n.z / force - 1.0).abs() < 1e-4,
        "{} instead of {force} N",
        touch.force_n
    );
}

// In every step momentum changes by weight and contact alone, nothing is inside, and what is at rest
// in the end presses with its weight.
#[test]
fn a_block_that_falls_on_a_plane_comes_to_rest_on_its_weight() {
    let scene = sheet(
        "continuum",
        [5, 5],
        0.03,
        "material = { young_pa = 20e3, poisson = 0.3, damping_s = 2e-2 }",
    );
    let body = scene.deformable(0).unwrap();
    let mut exact = ExactStep::new(body);
    (exact.damping_s, exact.gravity) = (2e-2, Vector3::new(0.0, 0.0, 9.81));
    let surface = scene.rest_surface(0).expect("a surface");
    let skin = Skin::new(&exact, surface, [25, 25], |_| true).unwrap();
    assert_eq!(skin.len(), 625);
    let (mut state, mut touch) = (body.rest_state(), Touch::default());
    // It falls upwards: the surface is its upper side.
    let ceiling = Obstacle::Plane {
        point: Point3::new(0.0, 0.0, 1e-3),
        normal: -Vector3::z(),
    };
    let none = vec![Vector3::zeros(); body.coordinate_count()];
    let momentum = |state: &DeformableState| -> Vector3 {
        let moving = body.masses().iter().zip(&state.velocities);
        moving.map(|(m, v)| v * *m).sum()
    };
    let weight = exact.gravity * body.mass_kg();
    for tick in 0..600 {
        let before = momentum(&state);
        exact
            .step_touching(&mut state, &none, &skin, &ceiling, &mut touch)
            .unwrap_or_else(|e| panic!("tick {tick}: {e}"));
        let gained = (momentum(&state) - before) / exact.dt_s;
        assert!(
            (gained - weight - touch.force_n).norm()
                < 1e-8 * weight.norm().max(touch.force_n.norm()),
            "tick {tick}: {gained} by {weight} and {}",
            touch.force_n
        );
        assert!(touch.force_n.z <= 0.0, "tick {tick}: it is held back");
        let mut now = surface.clone();
        for (control, point) in now.net_mut().points_mut().iter_mut().enumerate() {
            *point = state.positions[body.coordinate_of_control(control)];
        }
        for k in 0..25 {
            let along = f64::from(k) / 24.0;
            let inside = now.point(along, 0.5).z - 1e-3;
            assert!(inside < 1e-9, "tick {tick}: {inside} m inside");
        }
    }
    let off = (touch.force_n + weight).norm() / weight.norm();
    assert!(
        off < 1e-4,
        "it presses with {} N, of {weight}",
        touch.force_n
    );
}

#[test]
fn gaps_to_obstacles_have_their_slopes() {
    let ball = Obstacle::Sphere {
        centre: Point3::new(0.02, 0.01, 0.05),
        radius_m: 0.02,
    };
    let plane = Obstacle::Plane {
        point: Point3::new(0.0, 0.0, 0.01),
        normal: Vector3::new(0.6, 0.0, 0.8),
    };
    let at = Point3::new(0.035, 0.02, 0.061);
    for obstacle in [ball, plane] {
        let (gap, normal, _) = obstacle.gap(&at);
        assert!((normal.norm() - 1.0).abs() < 1e-14);
        for axis in 0..3 {
            let mut moved = at;
            moved[axis] += 1e-7;
            let slope = (obstacle.gap(&moved).0 - gap) / 1e-7;
            assert!(
                (slope - normal[axis]).abs() < 1e-5,
                "{slope} is not {}",
                normal[axis]
            );
        }
    }
}
