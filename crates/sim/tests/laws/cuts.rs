//! Bodies that are cut while they move: their pieces have their mass and momentum, and go on as bodies like them.

use crate::common::{Laws as _, World};
use palpate_geometry::cut::CutPlane;
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_geometry::surface::{ClosestSolver, Surface};
use palpate_sim::scene::{BodyPiece, Scene, SceneCut, SceneCutError};
use palpate_sim::tick::{CarryOver, hash};
use std::path::Path;

fn plane(point: [f64; 3], normal: [f64; 3]) -> CutPlane {
    CutPlane::through(&Point3::from(point), &Vector3::from(normal)).expect("a direction")
}

/// Cuts a body of a world as it stands; the world goes on with it whole.
fn try_cut(
    world: &World,
    body: &str,
    plane: &CutPlane,
    kerf_m: f64,
) -> Result<SceneCut, SceneCutError> {
    let index = world.scene.body_index(body).expect("a body");
    let mut points = world.scene.skin(index).points().to_vec();
    world.state.copy_net(&world.scene, index, &mut points);
    let coordinates = world.state.coordinates(index).unwrap_or(&[]).to_vec();
    SceneCut::new(&world.scene, index, (&points, &coordinates), plane, kerf_m)
}

/// Cuts a body of a world as it stands, and goes on with the pieces.
fn cut(world: &mut World, body: &str, plane: &CutPlane, kerf_m: f64) -> SceneCut {
    let done = try_cut(world, body, plane, kerf_m).unwrap_or_else(|e| panic!("{e}"));
    go_on(world, &done);
    done
}

/// Goes on with the pieces of a cut.
fn go_on(world: &mut World, done: &SceneCut) {
    let next = done.change.build_to_run();
    follow(world, next.unwrap_or_else(|e| panic!("{e}")), done);
}

fn follow(world: &mut World, next: Scene, done: &SceneCut) {
    let carry = CarryOver::new(&world.scene, &next, done.change.origins().to_vec());
    let mut state = next.initial_state();
    next.carry_over(&world.scene, &world.state, &carry, &mut state);
    world.scratch = next.scratch(&state);
    next.prepare(&state, &mut world.scratch);
    (world.scene, world.state) = (next.into(), state);
}

/// Ticks without a device.
fn rest(world: &mut World, ticks: usize) {
    (0..ticks).for_each(|_| drop(world.silent()));
}

/// Mass, momentum and angular momentum about the origin of all bodies.
fn motion(world: &World) -> (f64, Vector3, Vector3) {
    let (mut mass, mut linear, mut angular) = (0.0, Vector3::zeros(), Vector3::zeros());
    for body in 0..world.scene.body_count() {
        let Some(deformable) = world.scene.deformable(body) else {
            continue;
        };
        let state = world.state.bodies[body].deformable.as_ref().unwrap();
        let each = state.positions.iter().zip(&state.velocities);
        for ((x, v), m) in each.zip(deformable.masses()) {
            mass += m;
            linear += v * *m;
            angular += x.coords.cross(v) * *m;
        }
    }
    (mass, linear, angular)
}

fn jelly(model: &str, more: &str) -> String {
    format!(
        "[[body]]\nid = \"jelly\"\nsurface = {{ builtin = \"sphere\", size = 0.03 }}\n{model}\n{more}\n\
         [[tool]]\nid = \"pen\"\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\npose = {{ position = [0.0, 0.0, 0.2] }}\n\
         device = {{ force_max_n = 50.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}\n"
    )
}

/// Points of a surface, evenly in (u, v).
fn samples(surface: &Surface, count: usize) -> Vec<Point3> {
    let [u, v] = [surface.knots_u().domain(), surface.knots_v().domain()];
    let at = |(a, b): (f64, f64), k: usize| a + (b - a) * k as f64 / count as f64;
    let all = (0..=count).flat_map(|i| (0..=count).map(move |j| (i, j)));
    all.map(|(i, j)| surface.point(at(u, i), at(v, j)))
        .collect()
}

const MODELS: [&str; 4] = [
    "model = \"continuum\"\nmaterial = { young_pa = 2e4, poisson = 0.45 }",
    "model = \"lattice\"\nmaterial = { young_pa = 2e4 }",
    "model = \"net\"\nmaterial = { young_pa = 2e4 }",
    "model = \"lattice\"\nmaterial = { young_pa = 2e4 }\nlattice = { builder = \"transfinite\", nodes = [9, 9, 9] }",
];

#[test]
fn pieces_have_the_mass_and_the_momentum_of_the_body() {
    for model in MODELS {
        let moving = "velocity_m_s = [0.1, -0.2, 0.05]\nspin_rad_s = [3.0, 10.0, -5.0]";
        let mut world = World::new(&jelly(model, moving));
        rest(&mut world, 50);
        let before = motion(&world);
        let done = cut(
            &mut world,
            "jelly",
            &plane([0.004, -0.01, 0.004], [0.3, 0.2, 1.0]),
            0.0,
        );
        assert_eq!(done.pieces.len(), 2);
        let after = motion(&world);
        let off = [
            after.0 / before.0 - 1.0,
            (after.1 - before.1).norm() / before.1.norm(),
            (after.2 - before.2).norm() / before.2.norm(),
        ];
        let misses = done
            .pieces
            .iter()
            .map(|piece| piece.skin.off_m)
            .fold(0.0, f64::max);
        println!("{model}: {off:?}, surfaces {misses:e} m off");
        assert!(off.iter().all(|off| off.abs() < 1e-12), "{model}: {off:?}");
        rest(&mut world, 500);
        let later = motion(&world);
        assert!(
            (later.1 - before.1).norm() < 1e-9 * before.1.norm(),
            "{model}"
        );
        for body in 0..2 {
            let body = world.state.bodies[body].deformable.as_ref().unwrap();
            let fastest = body
                .velocities
                .iter()
                .map(Vector3::norm)
                .fold(0.0, f64::max);
            assert!(fastest < 1.0, "{model}: {fastest} m/s");
        }
    }
}

// At rest nothing begins to move, and nothing is left of a cut but two bodies.
#[test]
fn a_body_at_rest_stays_at_rest() {
    for model in &MODELS[..2] {
        let mut world = World::new(&jelly(model, ""));
        rest(&mut world, 5);
        cut(
            &mut world,
            "jelly",
            &plane([0.0, 0.0, 0.003], [0.0, 0.1, 1.0]),
            0.0,
        );
        rest(&mut world, 200);
        for body in 0..2 {
            let body = world.state.bodies[body].deformable.as_ref().unwrap();
            let fastest = body
                .velocities
                .iter()
                .map(Vector3::norm)
                .fold(0.0, f64::max);
            assert!(fastest < 1e-9, "{model}: {fastest:e} m/s");
        }
    }
}

#[test]
fn a_piece_that_is_held_stays_and_the_other_falls() {
    let held = "fixed = [{ point = [0.0, 0.0, -0.015], normal = [0.0, 0.0, 1.0] }]\n\
                [gravity]\nacceleration = [0.0, 0.0, -9.81]";
    let mut world = World::new(&jelly(MODELS[0], held));
    rest(&mut world, 500);
    let done = cut(
        &mut world,
        "jelly",
        &plane([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        0.0,
    );
    let before = motion(&world).1;
    rest(&mut world, 100);
    let upper = world.scene.body_index(&done.pieces[0].id).unwrap();
    let lower = world.scene.body_index(&done.pieces[1].id).unwrap();
    let mean = |world: &World, body: usize| {
        let state = world.state.bodies[body].deformable.as_ref().unwrap();
        state.velocities.iter().sum::<Vector3>() / state.velocities.len() as f64
    };
    // Free fall of a tenth of a second, as nothing is between the pieces.
    assert!(
        (mean(&world, upper).z + 0.981).abs() < 0.02,
        "{} {before:?}",
        mean(&world, upper)
    );
    assert!(mean(&world, lower).norm() < 0.05);
    assert!(world.scene.spec.bodies[upper].fixed.is_empty());
}

// The pen presses on, and comes to the force with which the pieces press that never were one body.
#[test]
fn a_pen_presses_on_and_pieces_are_cut_again() {
    for model in &MODELS[..3] {
        let held = "fixed = [{ point = [0.0, 0.0, -0.02], normal = [0.0, 0.0, 1.0] }]";
        let coarse = jelly(model, held).replace("size = 0.03", "size = 0.03, net = [12, 9]");
        let mut world = World::new(&coarse);
        let down = |k: usize| [0.012, 0.0, 0.036 - 4e-5 * k.min(100) as f64];
        let press = |world: &mut World, from: usize, ticks: usize| {
            (from..from + ticks).fold(0.0, |_, k| world.at(down(k)).tools[0].force_n.norm())
        };
        let whole = press(&mut world, 0, 400);
        assert!(whole > 0.01, "{model}: {whole} N");
        let planes = [
            plane([-0.004, 0.0, 0.0], [1.0, 0.05, 0.0]),
            plane([0.0, -0.006, 0.0], [0.0, 1.0, 0.0]),
        ];
        let mut body = "jelly".to_owned();
        // A net takes fewer shapes.
        let count = if model.contains("lattice") { 2 } else { 1 };
        for (k, plane) in planes.iter().enumerate().take(count) {
            let done = cut(&mut world, &body, plane, 0.0);
            body.clone_from(&done.pieces[0].id);
            let first = press(&mut world, 400, 1);
            let last = press(&mut world, 400, 1_000);
            let mut apart = World::new(&toml::to_string(&world.scene.spec).unwrap());
            let built = press(&mut apart, 0, 1_400);
            println!(
                "{model}, cut {}: {first} N, then {last} N, built so {built} N",
                k + 1
            );
            // Springs settle slowly.
            assert!(
                first > 0.3 * last && first < 3.0 * last,
                "{model}: {first} N, {last} N"
            );
            assert!(
                (last / built - 1.0).abs() < 1e-2,
                "{model}: {last} N, built so {built} N"
            );
        }
        assert_eq!(world.scene.body_count(), 1 + count);
    }
}

// A dent in clay stays when the clay is cut.
#[test]
fn clay_keeps_its_dents() {
    for model in ["continuum", "lattice"] {
        let material =
            "material = { young_pa = 2e4, plastic = { yield_strain = 0.02, rate_per_s = 20.0 } }";
        let held = "fixed = [{ point = [0.0, 0.0, -0.02], normal = [0.0, 0.0, 1.0] }]";
        let mut world = World::new(&jelly(&format!("model = \"{model}\"\n{material}"), held));
        for k in 0..250 {
            world.at([0.0, 0.0, 0.036 - 8e-5 * f64::from(k.min(100))]);
        }
        for _ in 0..350 {
            world.at([0.0, 0.0, 0.06]);
        }
        let top = |world: &World| {
            let mut highest = f64::NEG_INFINITY;
            for body in 0..world.scene.body_count() {
                let mut points = world.scene.skin(body).points().to_vec();
                world.state.copy_net(&world.scene, body, &mut points);
                let surface = world.scene.surface_with(body, &points).unwrap().unwrap();
                for p in samples(&surface, 100) {
                    if p.x.hypot(p.y) < 0.002 {
                        highest = highest.max(p.z);
                    }
                }
            }
            highest
        };
        let before = top(&world);
        let whole = World::new(&jelly(&format!("model = \"{model}\"\n{material}"), held));
        let dent = top(&whole) - before;
        assert!(dent > 1e-3, "{model}: {dent} m");
        cut(
            &mut world,
            "jelly",
            &plane([0.008, 0.0, 0.0], [1.0, 0.0, 0.0]),
            0.0,
        );
        let first = top(&whole) - top(&world);
        rest(&mut world, 200);
        let kept = top(&whole) - top(&world);
        println!("{model}: dent of {dent} m, {first} m after the cut, then {kept} m");
        // Another net shows a dent that is as narrow as its spans less deep; nothing of it goes back.
        assert!(first > 0.5 * dent, "{model}: {dent} m, {first} m");
        assert!(
            (kept / first - 1.0).abs() < 0.15,
            "{model}: {first} m, {kept} m"
        );
    }
}

fn skin(surface: &str, more: &str) -> World {
    World::new(&format!(
        "[[body]]\nid = \"skin\"\nsurface = {{ {surface} }}\nmodel = \"membrane\"\nlattice = {{ thickness_m = 1e-3 }}\n\
         material = {{ young_pa = 2e5 }}\n{more}\n\
         [[tool]]\nid = \"pen\"\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\npose = {{ position = [0.0, 0.0, 0.2] }}\n\
         device = {{ force_max_n = 50.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}\n"
    ))
}

const SKINS: [&str; 3] = [
    "builtin = \"sphere\", size = 0.03, net = [12, 7]",
    "builtin = \"sheet\", size = 0.06, net = [10, 10]",
    "builtin = \"torus\"",
];

// Two sheets, no cap: of a ball, of a square and of a ring.
#[test]
fn pieces_of_a_moving_membrane_have_its_mass_and_momentum() {
    for surface in SKINS {
        let moving = "velocity_m_s = [0.1, -0.2, 0.05]\nspin_rad_s = [3.0, 10.0, -5.0]";
        let mut world = skin(surface, moving);
        rest(&mut world, 50);
        let before = motion(&world);
        let oblique = plane([0.004, -0.01, 0.004], [1.0, 0.2, 0.3]);
        let done = cut(&mut world, "skin", &oblique, 0.0);
        assert_eq!(done.pieces.len(), 2);
        let after = motion(&world);
        let off = [
            after.0 / before.0 - 1.0,
            (after.1 - before.1).norm() / before.1.norm(),
            (after.2 - before.2).norm() / before.2.norm(),
        ];
        println!("{surface}: {off:?}");
        assert!(
            off.iter().all(|off| off.abs() < 1e-12),
            "{surface}: {off:?}"
        );
        for piece in &done.pieces {
            let size_m = piece.piece.skin_area_m2.sqrt();
            println!("  {} off {:.1e}", piece.id, piece.skin.off_m / size_m);
            assert_eq!((piece.piece.cap_area_m2, piece.skin.creases), (0.0, 0));
            assert!(piece.skin.off_m < 5e-3 * size_m, "{surface}");
            assert!(!piece.skin.surface.topology().is_closed());
            let volume = piece.piece.skin_area_m2 * 1e-3;
            assert_eq!(piece.piece.volume_m3, volume, "{surface}");
        }
        // They stand where the whole did: its surface cut there, and rims in the plane.
        for (body, piece) in done.pieces.iter().enumerate() {
            let mut points = world.scene.skin(body).points().to_vec();
            world.state.copy_net(&world.scene, body, &mut points);
            let surface = world.scene.surface_with(body, &points).unwrap().unwrap();
            let side = if piece.piece.above { 1.0 } else { -1.0 };
            let lowest = samples(&surface, 50)
                .iter()
                .map(|p| side * oblique.height(p))
                .fold(f64::INFINITY, f64::min);
            println!("  {} to {lowest:.1e} m of the plane", piece.id);
            assert!(lowest.abs() < 2e-4, "{lowest}");
            let area = surface.area() / piece.piece.skin_area_m2;
            assert!((area - 1.0).abs() < 2e-3, "{area}");
        }
        rest(&mut world, 300);
        let later = motion(&world);
        let lost = (later.1 - before.1).norm() / before.1.norm();
        assert!(lost < 1e-9, "{surface}: {lost}");
        for body in 0..2 {
            let fastest = fastest(&world, body);
            assert!(fastest < 2.0, "{surface}: {fastest} m/s");
        }
    }
}

fn fastest(world: &World, body: usize) -> f64 {
    let body = world.state.bodies[body].deformable.as_ref().unwrap();
    let speeds = body.velocities.iter().map(Vector3::norm);
    speeds.fold(0.0, f64::max)
}

#[test]
fn a_membrane_at_rest_stays_so_and_its_pieces_are_cut_again() {
    for surface in SKINS {
        let mut world = skin(surface, "");
        rest(&mut world, 5);
        let first = plane([0.001, 0.0, 0.0], [1.0, 0.1, 0.05]);
        let done = cut(&mut world, "skin", &first, 0.0);
        rest(&mut world, 100);
        let before = motion(&world).0;
        let second = plane([0.0, 0.002, 0.0], [0.05, 1.0, 0.2]);
        let again = cut(&mut world, &done.pieces[0].id, &second, 0.0);
        let after = motion(&world).0;
        assert!((after / before - 1.0).abs() < 1e-12, "{surface}");
        rest(&mut world, 100);
        for body in 0..world.scene.body_count() {
            let fastest = fastest(&world, body);
            assert!(fastest < 1e-9, "{surface}: {fastest:e} m/s");
        }
        for piece in &again.pieces {
            let share = piece.skin.off_m / piece.piece.skin_area_m2.sqrt();
            println!("{surface}: {} off {share:.1e} of its size", piece.id);
            assert!(share < 2e-2, "{surface}: {share}");
        }
    }
}

// What is fixed stays so, the rest falls; what is in a kerf is lost.
#[test]
fn a_membrane_hangs_on_where_it_is_fixed() {
    let held = "fixed = [{ point = [-0.028, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }]\n\
                [gravity]\nacceleration = [0.0, 0.0, -9.81]";
    let mut world = skin(SKINS[1], held);
    rest(&mut world, 20);
    let whole = motion(&world).0;
    let kerf_m = 0.002;
    let done = cut(
        &mut world,
        "skin",
        &plane([0.01, 0.0, 0.0], [1.0, 0.0, 0.0]),
        kerf_m,
    );
    let lost = done.lost_m3 / (0.06 * 0.06 * 1e-3);
    assert!((lost / (kerf_m / 0.06) - 1.0).abs() < 0.05, "{lost}");
    let left = motion(&world).0 / whole;
    assert!((left + lost - 1.0).abs() < 1e-4, "{left} {lost}");
    rest(&mut world, 100);
    let [loose, hung] = [0, 1].map(|k| world.scene.body_index(&done.pieces[k].id).unwrap());
    assert!(world.scene.spec.bodies[loose].fixed.is_empty());
    assert_eq!(world.scene.spec.bodies[hung].fixed.len(), 1);
    let mean = |body: usize| {
        let state = world.state.bodies[body].deformable.as_ref().unwrap();
        state.velocities.iter().sum::<Vector3>() / state.velocities.len() as f64
    };
    assert!(
        (mean(loose).z + 0.981 + 0.196).abs() < 0.1,
        "{}",
        mean(loose)
    );
    assert!(mean(hung).norm() < mean(loose).norm());
}

#[test]
fn what_cannot_be_cut_says_why() {
    let rigid = World::new("[[body]]\nid = \"ball\"\nsurface = { builtin = \"sphere\" }\n");
    let sheet = World::new(
        "[[body]]\nid = \"sheet\"\nsurface = { builtin = \"sheet\" }\nmodel = \"lattice\"\nlattice = { thickness_m = 4e-3 }\n",
    );
    let ranged = skin(SKINS[1], "fixed = [{ u = [0.0, 0.1], v = [0.0, 1.0] }]");
    let tight = skin(SKINS[2], "");
    let soft = World::new(&jelly(MODELS[0], ""));
    let ring = World::new(
        "[[body]]\nid = \"ring\"\nsurface = { builtin = \"torus\" }\nmodel = \"continuum\"\n",
    );
    let z = plane([0.0; 3], [0.0, 0.0, 1.0]);
    let far = plane([0.0, 0.0, 0.2], [0.0, 0.0, 1.0]);
    let corner = plane([0.045, 0.0, 0.0], [1.0, 0.0, 0.0]);
    for (world, plane, word) in [
        (&rigid, &z, "is rigid"),
        (&sheet, &z, "open surface with a thickness"),
        (&ranged, &z, "range of parameters"),
        (&tight, &corner, "holes"),
        (&soft, &far, "does not cut"),
        (&ring, &z, "holes"),
    ] {
        let points = world.scene.skin(0).points();
        let coordinates = world.state.coordinates(0).unwrap_or(&[]);
        let error = SceneCut::new(&world.scene, 0, (points, coordinates), plane, 0.0).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
}

/// The surface of a body, at rest and as it stands.
fn stands(world: &World, body: usize) -> [Surface; 2] {
    let mut points = world.scene.skin(body).points().to_vec();
    world.state.copy_net(&world.scene, body, &mut points);
    let now = world.scene.surface_with(body, &points).unwrap().unwrap();
    [world.scene.rest_surface(body).unwrap().clone(), now]
}

/// How the skin of a piece differs from that of the whole where it was skin before: the greatest depth below rest along a
/// direction, of both, and the root of the mean square of the difference, m.
fn skins_differ(
    whole: &[Surface; 2],
    piece: &[Surface; 2],
    out: &Vector3,
    kept: impl Fn(&Point3) -> bool,
) -> [f64; 3] {
    let mut closest = ClosestSolver::new(&piece[0]);
    let [u, v] = [whole[0].knots_u().domain(), whole[0].knots_v().domain()];
    let at = |(a, b): (f64, f64), k: usize, count: usize| a + (b - a) * k as f64 / count as f64;
    let (mut deepest, mut sum, mut count) = ([0.0_f64; 2], 0.0, 0.0);
    for (i, j) in (0..60).flat_map(|i| (0..=60).map(move |j| (i, j))) {
        let (u, v) = (at(u, i, 60), at(v, j, 60));
        let place = whole[0].point(u, v);
        if !kept(&place) {
            continue;
        }
        let foot = closest.closest(&piece[0], &place);
        let moved = [
            whole[1].point(u, v) - place,
            piece[1].point(foot.u, foot.v) - foot.point,
        ];
        deepest = [0, 1].map(|k| deepest[k].max(-moved[k].dot(out)));
        sum += (moved[1] - moved[0]).norm_squared();
        count += 1.0;
    }
    [deepest[0], deepest[1], f64::sqrt(sum / count)]
}

// A pen presses a narrow hollow, and the skin of the piece under it has it too: with control points that move as the matter at
// their places does, skins are 0.03 to 0.1 mm off. Other cells under the same skin press otherwise until they have settled.
#[test]
fn the_skin_of_a_piece_is_where_the_skin_was() {
    let held = "fixed = [{ point = [0.0, 0.0, -0.01], normal = [0.0, 0.0, 1.0] }]";
    for (model, out, most_off_m) in [
        (MODELS[0], [0.0, 1.0, 1.0], 4e-5),
        (MODELS[1], [0.0, 1.0, 1.0], 5e-5),
        (MODELS[1], [-0.5, -0.7, 0.2], 1.5e-5),
    ] {
        let out = Vector3::from(out).normalize();
        let mut world = World::new(&jelly(model, held));
        let down = |k: usize| (out * (0.035 - 5e-5 * k.min(100) as f64)).into();
        let mut force = 0.0;
        for k in 0..250 {
            force = world.at(down(k)).tools[0].force_n.norm();
        }
        let whole = stands(&world, 0);
        let across = plane([0.010, 0.0, 0.0], [-1.0, 0.1, 0.0]);
        let done = cut(&mut world, "jelly", &across, 0.0);
        let index = world.scene.body_index(&done.pieces[0].id).unwrap();
        let piece = stands(&world, index);
        let [before, after, off] = skins_differ(&whole, &piece, &out, |p| p.x < 0.008);
        let forces: Vec<f64> = (0..100)
            .map(|_| world.at(down(250)).tools[0].force_n.norm())
            .collect();
        println!(
            "{model}: {before:e} m deep, {after:e} m after the cut, {off:e} m off; {force:.3} N, then {:.3?}",
            [0, 1, 2, 5, 10, 20, 50, 99].map(|k| forces[k]),
        );
        assert!(
            (after / before - 1.0).abs() < 0.2,
            "{model}: {before} m, {after} m"
        );
        assert!(off < most_off_m, "{model}: {off} m");
        let most = forces.iter().copied().fold(0.0, f64::max);
        let least = forces.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(
            most < 1.2 * force && least > 0.35 * force,
            "{model}: {force} N, then {least} to {most} N"
        );
    }
}

/// A small body of springs, with few control points; it moves and turns unless something holds it.
fn small(more: &str) -> String {
    format!(
        "[[body]]\nid = \"jelly\"\nsurface = {{ builtin = \"sphere\", size = 0.03, net = [16, 11] }}\nmodel = \"lattice\"\n\
         material = {{ young_pa = 2e4 }}\nlattice = {{ refine = \"none\" }}\n{more}\n"
    )
}

const MOVING: &str = "velocity_m_s = [0.1, -0.2, 0.05]\nspin_rad_s = [3.0, 10.0, -5.0]";

/// Cuts a moving body where a cut may not be possible: either nothing has changed and the reason is given, or the pieces have
/// mass, momentum and angular momentum of the body, and go on. Twice the same comes of it.
fn cut_or_refused(world: &mut World, body: &str, plane: &CutPlane) -> Result<usize, String> {
    let before = motion(world);
    let again = try_cut(world, body, plane, 0.0);
    let done = match try_cut(world, body, plane, 0.0) {
        Ok(done) => done,
        Err(error) => {
            assert_eq!(error.to_string(), again.unwrap_err().to_string());
            return Err(error.to_string());
        }
    };
    let text = |done: &SceneCut| toml::to_string(done.change.spec()).unwrap();
    assert!(
        text(&done) == text(&again.unwrap()),
        "another cut came of it"
    );
    go_on(world, &done);
    let after = motion(world);
    let near = |off: f64, of: f64| assert!(off < 1e-12 * of, "{off:e} of {of:e}");
    near((after.0 - before.0).abs(), before.0);
    near(
        (after.1 - before.1).norm(),
        before.1.norm().max(1e-3 * before.0),
    );
    near(
        (after.2 - before.2).norm(),
        before.2.norm().max(1e-5 * before.0),
    );
    rest(world, 20);
    goes_on(world);
    Ok(done.pieces.len())
}

/// Mean of a body's control points, m.
fn middle(world: &World, body: usize) -> Vector3 {
    let [_, now] = stands(world, body);
    let points = now.net().points();
    points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64
}

/// Every place is a number, and nothing flies off.
fn goes_on(world: &World) {
    for body in 0..world.scene.body_count() {
        let Some(state) = &world.state.bodies[body].deformable else {
            continue;
        };
        let far = state.positions.iter().map(|p| p.coords.norm());
        assert!(far.fold(0.0, f64::max) < 0.1, "a place is far off");
        assert!(
            state
                .positions
                .iter()
                .all(|p| p.coords.iter().all(|x| x.is_finite()))
        );
        let fast = state.velocities.iter().map(Vector3::norm);
        assert!(fast.fold(0.0, f64::max) < 5.0, "a place is fast");
        assert!(
            state
                .velocities
                .iter()
                .all(|v| v.iter().all(|x| x.is_finite()))
        );
    }
}

// A thousandth of the size inside, and just touching.
#[test]
fn a_plane_that_grazes_a_body_cuts_it() {
    for normal in [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 2.0, 3.0]] {
        let normal = Vector3::from(normal).normalize();
        let mut world = World::new(&small(MOVING));
        rest(&mut world, 5);
        let [_, now] = stands(&world, 0);
        let (_, _, place) = ClosestSolver::new(&now).deepest_along(&now, &normal);
        let at = |depth_m: f64| plane((place - normal * depth_m).coords.into(), normal.into());
        let tangent = cut_or_refused(&mut world, "jelly", &at(-1e-9)).unwrap_err();
        assert!(tangent.contains("does not cut"), "{tangent}");
        assert_eq!(cut_or_refused(&mut world, "jelly", &at(6e-5)), Ok(2));
    }
}

// The inner equator of a ring touches the plane: its curve is a figure of eight, or nearly one; farther out there is a hole.
#[test]
fn a_saddle_in_the_plane_is_refused_with_its_reason() {
    for (at, reason) in [
        (0.03, "touch in single points"),
        (0.03 - 1e-7, "triangles"),
        (0.031, "holes"),
    ] {
        let mut world = World::new(
            "[[body]]\nid = \"ring\"\nsurface = { builtin = \"torus\" }\nmodel = \"lattice\"\n\
             material = { young_pa = 2e4 }\nlattice = { refine = \"none\" }\n",
        );
        let plane = plane([at, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let error = cut_or_refused(&mut world, "ring", &plane).unwrap_err();
        assert!(error.contains(reason), "at {at} m: {error}");
    }
}

#[test]
fn a_plane_through_both_poles_cuts_a_body() {
    for normal in [[1.0, 0.0, 0.0], [0.3, 1.0, 0.0]] {
        let mut world = World::new(&small(""));
        let cut = cut_or_refused(&mut world, "jelly", &plane([0.0; 3], normal));
        assert_eq!(cut, Ok(2));
    }
}

// Both pieces reach into what a plane holds: there they stay.
#[test]
fn pieces_are_held_where_the_body_was() {
    let held = "fixed = [{ point = [0.0, 0.0, -0.015], normal = [0.0, 0.0, 1.0] }]\n\
                [gravity]\nacceleration = [0.0, 0.0, -9.81]";
    let mut world = World::new(&small(held));
    rest(&mut world, 200);
    cut(
        &mut world,
        "jelly",
        &plane([0.004, 0.0, 0.0], [1.0, 0.2, 0.1]),
        0.0,
    );
    rest(&mut world, 100);
    goes_on(&world);
    for body in 0..2 {
        assert_eq!(world.scene.spec.bodies[body].fixed.len(), 1);
        let rest = world.scene.rest_surface(body).unwrap().net().points();
        let mut now = rest.to_vec();
        world.state.copy_net(&world.scene, body, &mut now);
        let (mut held, mut most) = (0, 0.0_f64);
        for (was, is) in rest.iter().zip(&now) {
            most = most.max((is - was).norm());
            if was.z <= -0.015 {
                held += 1;
                assert!((is - was).norm() < 1e-15, "{was} is at {is}");
            }
        }
        assert!(held > 0 && most < 0.02, "{held} held, {most} m");
    }
}

// Two tools press from both sides, each goes on with its own piece. Other cells under the same skin press up to a fifth more
// for a few ticks, as in [`the_skin_of_a_piece_is_where_the_skin_was`], and then less, since a half is softer.
#[test]
fn two_tools_press_on_with_a_piece_each() {
    let mut text = small("fixed = [{ point = [0.0, 0.0, -0.01], normal = [0.0, 0.0, 1.0] }]");
    for side in [-1.0, 1.0] {
        text += &format!(
            "[[tool]]\nid = \"pen{}\"\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\n\
             pose = {{ position = [{:?}, 0.0, 0.2] }}\n\
             device = {{ force_max_n = 50.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}\n",
            i32::from(side > 0.0),
            side * 0.02
        );
    }
    let mut world = World::new(&text);
    let at = |k: usize| {
        let away = 0.036 - 4e-5 * k.min(100) as f64;
        [-1.0, 1.0].map(|side| ([side * away, 0.0, 0.01], 0))
    };
    let press = |world: &mut World, k: usize| {
        let output = world.all(&at(k));
        [0, 1].map(|tool| output.tools[tool].force_n)
    };
    let mut before = [Vector3::zeros(); 2];
    (0..300).for_each(|k| before = press(&mut world, k));
    cut(
        &mut world,
        "jelly",
        &plane([0.001, 0.0, 0.0], [1.0, 0.1, 0.05]),
        0.0,
    );
    let after: Vec<_> = (0..150).map(|_| press(&mut world, 300)).collect();
    goes_on(&world);
    let mut apart = World::new(&toml::to_string(&world.scene.spec).unwrap());
    let mut built = [Vector3::zeros(); 2];
    (0..400).for_each(|k| built = press(&mut apart, k));
    for tool in 0..2 {
        let force = before[tool].norm();
        let forces = after.iter().map(|forces| forces[tool].norm());
        let most = forces.clone().fold(0.0, f64::max);
        let least = forces.fold(f64::INFINITY, f64::min);
        let end = after[149][tool].norm();
        println!(
            "tool {tool}: {force:.4} N, then {:.4} N, {least:.4} to {most:.4} N, {end:.4} N in the end, built so {:.4} N",
            after[0][tool].norm(),
            built[tool].norm()
        );
        assert!(before[tool].dot(&after[0][tool]) > 0.0);
        assert!(
            most < 1.2 * force && least > 0.4 * force,
            "{force} N, {least} to {most} N"
        );
        assert!((end / built[tool].norm() - 1.0).abs() < 0.05, "{end} N");
    }
}

// Slices of a thousandth and a hundredth of the size.
#[test]
fn a_second_cut_beside_the_first_is_refused_with_its_reason() {
    let mut world = World::new(&small(MOVING));
    rest(&mut world, 5);
    let at = |z: f64| plane([0.0, 0.0, z], [0.0, 0.0, 1.0]);
    assert_eq!(cut_or_refused(&mut world, "jelly", &at(0.003)), Ok(2));
    let upper = world.scene.body_id(0).to_owned();
    for more_m in [6e-5, 6e-4] {
        let error = cut_or_refused(&mut world, &upper, &at(0.003 + more_m)).unwrap_err();
        assert!(error.contains("too thin"), "{more_m} m: {error}");
    }
}

#[test]
fn a_piece_of_a_piece_of_a_piece_goes_on() {
    let mut world = World::new(&small(MOVING));
    rest(&mut world, 5);
    let mut body = "jelly".to_owned();
    for normal in [[0.0, 0.1, 1.0], [1.0, 0.1, 0.0], [0.1, 1.0, 0.0]] {
        let index = world.scene.body_index(&body).unwrap();
        let middle = middle(&world, index);
        assert_eq!(
            cut_or_refused(&mut world, &body, &plane(middle.into(), normal)),
            Ok(2)
        );
        body = format!("{body}-1");
    }
    assert_eq!(world.scene.body_count(), 4);
    assert!(world.scene.body_index("jelly-1-1-1").is_some());
}

// What has flowed goes on in the pieces, exact in mass and momentum as well.
#[test]
fn a_body_that_has_flowed_is_cut_while_it_moves() {
    let flow = "plastic = { yield_strain = 0.02, rate_per_s = 20.0 }";
    let text = small("").replace("young_pa = 2e4", &format!("young_pa = 2e4, {flow}"));
    for model in ["lattice", "continuum"] {
        let pen = "[[tool]]\nid = \"pen\"\nshape = { sphere = { radius_m = 0.01 } }\npose = { position = [0.0, 0.0, 0.2] }\n\
                   device = { force_max_n = 50.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }\n";
        let text = text.replace("lattice\"", &format!("{model}\"")) + pen;
        let mut world = World::new(&text);
        for k in 0..150 {
            world.at([0.002, 0.0, 0.042 - 1.5e-4 * f64::from(k.min(100))]);
        }
        let middle = middle(&world, 0);
        let strains = |world: &World, body: usize| {
            let state = world.state.bodies[body].deformable.as_ref().unwrap();
            state
                .plastic_strain
                .as_flattened()
                .iter()
                .copied()
                .fold(0.0, f64::max)
        };
        let before = strains(&world, 0);
        assert!(before > 1e-3, "{model}: {before}");
        assert_eq!(
            cut_or_refused(&mut world, "jelly", &plane(middle.into(), [1.0, 0.1, 0.2])),
            Ok(2)
        );
        let after = strains(&world, 0).max(strains(&world, 1));
        println!("{model}: plastic strain {before}, {after} after the cut");
        assert!(after > 0.1 * before, "{model}: {before}, {after}");
    }
}

// A surface of joined patches has no inside that a body could be cut into.
#[test]
fn a_branching_body_is_not_cut() {
    let vessel = include_str!("../../../../scenes/vessel.toml");
    let free: String = vessel
        .lines()
        .filter(|line| !line.starts_with("fixed"))
        .fold(String::new(), |text, line| text + line + "\n");
    let world = World::new(&free.replace("vessel.json", "../../scenes/vessel.json"));
    let id = world.scene.body_id(0).to_owned();
    let error = try_cut(&world, &id, &plane([0.0; 3], [0.0, 0.0, 1.0]), 0.0).unwrap_err();
    assert!(error.to_string().contains("joined patches"), "{error}");
}

// Bodies that stay are shared with the scene before, and pieces are built with the cut: all go on as bodies that are built of the
// next file, bit by bit.
#[test]
fn what_is_ready_goes_on_as_what_its_file_says() {
    for model in MODELS {
        let beside = "[[body]]\nid = \"beside\"\nsurface = { builtin = \"sphere\", size = 0.02, net = [10, 7] }\n\
                      pose = { position = [0.1, 0.0, 0.0] }\nmodel = \"lattice\"\n";
        let text = jelly(model, "spin_rad_s = [1.0, 2.0, 0.0]")
            .replace("[[tool]]", &format!("{beside}[[tool]]"));
        let text = text.replace("size = 0.03", "size = 0.03, net = [12, 9]");
        let mut worlds = [World::new(&text), World::new(&text)];
        worlds.iter_mut().for_each(|world| rest(world, 10));
        let plane = plane([0.0, 0.0, 0.004], [0.1, 0.2, 1.0]);
        for (k, world) in worlds.iter_mut().enumerate() {
            let done = try_cut(world, "jelly", &plane, 0.0).unwrap_or_else(|e| panic!("{e}"));
            let next = match k {
                0 => done.change.build_to_run(),
                _ => Scene::build_with(done.change.spec(), Path::new("."), palpate_thesis::METHODS),
            };
            follow(world, next.unwrap_or_else(|e| panic!("{e}")), &done);
        }
        for k in 0..60 {
            let at = [0.0, 0.0, 0.036 - 1e-4 * f64::from(k)];
            let [ready, built] = worlds.each_mut().map(|world| {
                let mut output = world.at(at);
                hash(&world.state, &mut output);
                output.state_hash
            });
            assert_eq!(ready, built, "{model}: tick {k}");
        }
    }
}

// What is held everywhere cannot deform: it is a rigid body.
#[test]
fn a_piece_that_is_held_everywhere_is_rigid() {
    let held = "fixed = [{ point = [0.0, 0.0, -0.01], normal = [0.0, 0.0, 1.0] }]";
    let mut world = World::new(&small(held));
    rest(&mut world, 5);
    let done = cut(
        &mut world,
        "jelly",
        &plane([0.0, 0.0, -0.015], [0.0, 0.1, 1.0]),
        0.0,
    );
    let models = [0, 1].map(|body| world.scene.model_name(body));
    assert_eq!(
        models,
        ["lattice", "rigid"],
        "{:?}",
        done.change.body("jelly-2")
    );
    rest(&mut world, 50);
    goes_on(&world);
    assert!(fastest(&world, 0) < 1e-9);
}

// Pieces of a continuum are continua, unless a plane leaves one long and thin.
#[test]
fn most_pieces_of_a_continuum_are_continua() {
    let text = jelly("model = \"continuum\"\nmaterial = { young_pa = 2e4 }", "");
    let text = text.replace(
        "builtin = \"sphere\", size = 0.03",
        "builtin = \"teardrop\"",
    );
    let world = World::new(&text);
    let rest = world.scene.rest_surface(0).expect("a surface");
    let points = rest.net().points();
    let sum: Vector3 = points.iter().map(|p| p.coords).sum();
    let centre = Point3::from(sum / points.len() as f64);
    let mut random = Random(17);
    let (mut continua, mut pieces) = (0, 0);
    for _ in 0..PLANES {
        let normal = random.vector();
        let at = centre + random.vector() * 0.125 * rest.size();
        let plane = CutPlane::through(&at, &normal).expect("a direction");
        let Ok(done) = try_cut(&world, "jelly", &plane, 0.0) else {
            continue;
        };
        let spec = |piece: &BodyPiece| done.change.body(&piece.id);
        let models = done
            .pieces
            .iter()
            .filter_map(|piece| Some(spec(piece)?.model().name()));
        continua += models.filter(|model| *model == "continuum").count();
        pieces += done.pieces.len();
    }
    println!("{continua} of {pieces} pieces");
    assert!(
        pieces >= PLANES && 3 * continua >= 2 * pieces,
        "{continua} of {pieces}"
    );
}

const PLANES: usize = 4;

// The first rows of control points around a pole are smooth, so that a press there holds still: after half a second the force
// stays within what the springs of a whole ball give it.
#[test]
fn a_press_on_the_pole_of_a_piece_holds_still() {
    for model in ["continuum", "lattice"] {
        let held = "fixed = [{ point = [0.0, 0.0, -0.012], normal = [0.0, 0.0, 1.0] }]";
        let model = format!("model = \"{model}\"\nmaterial = {{ young_pa = 2e4 }}");
        let mut world = World::new(&jelly(&model, held));
        let below = plane([0.0, 0.0, -0.016], [0.02, 0.05, 1.0]);
        cut(&mut world, "jelly", &below, 0.0);
        let rest = world.scene.rest_surface(0).expect("a surface");
        let (start, end) = rest.knots_v().domain();
        let poles = [start, end].map(|v| rest.point(0.0, v));
        let pole = poles
            .into_iter()
            .max_by(|a, b| a.z.total_cmp(&b.z))
            .unwrap();
        let at = |k: usize| {
            let height = 0.0055 - 4e-5 * k.min(75) as f64;
            [pole.x + 1e-4, pole.y, pole.z + height]
        };
        let forces: Vec<f64> = (0..600)
            .map(|k| world.at(at(k)).tools[0].force_n.norm())
            .collect();
        let most = forces[500..].iter().copied().fold(0.0, f64::max);
        let least = forces[500..].iter().copied().fold(f64::INFINITY, f64::min);
        println!("{model}: {least} to {most} N");
        assert!(
            least > 0.1 && most < 1.03 * least,
            "{model}: {least} to {most} N"
        );
    }
}
