//! Free bodies like boxes: on their faces and edges, in walls, as dominoes.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Random, Rotation, Vector3, rotation_by};
use std::fmt::Write as _;

const FAR: [f64; 3] = [5.0, 5.0, 5.0];
const BRICK: [f64; 3] = [0.04, 0.02, 0.02];
const DOMINO: [f64; 3] = [0.006, 0.02, 0.04];

/// Control points of a box with flat faces on z = 0 whose edges are rounded.
fn net([length, width, height]: [f64; 3], rounded: f64) -> String {
    let (a, b, r) = (0.5 * length, 0.5 * width, rounded);
    // Five points in a line make two spans of it; the corner between two lines is rounded.
    let half = [
        (a, r - b),
        (a, 0.0),
        (a, b - r),
        (a, b),
        (a - r, b),
        (0.0, b),
        (r - a, b),
        (-a, b),
    ];
    let around = half.into_iter().chain(half.map(|(x, y)| (-x, -y)));
    let face = [0.0, 0.25, 0.5, 0.75, 1.0 - 2.0 * r / length.min(width)];
    let mut profile: Vec<(f64, f64)> = face.map(|part| (part, 0.0)).into();
    profile.extend([0.0, r, 0.5 * height, height - r, height].map(|z| (1.0, z)));
    profile.extend(face.iter().rev().map(|part| (*part, height)));
    let rings: Vec<Vec<[f64; 3]>> = around
        .map(|(x, y)| {
            profile
                .iter()
                .map(|(part, z)| [part * x, part * y, *z])
                .collect()
        })
        .collect();
    format!("{rings:?}")
}

fn knots() -> String {
    let u: Vec<f64> = (0..=16).map(|k| f64::from(k) / 16.0).collect();
    let mut v = vec![0.0; 4];
    v.extend((1..12).map(|k| f64::from(k) / 12.0));
    v.extend([1.0; 4]);
    format!("{:?}", [u, v])
}

/// A box whose origin, the middle of its lower face, is at a place.
fn block(id: &str, size: [f64; 3], at: [f64; 3], turn: &Rotation, more: &str) -> String {
    let rounded = 0.1 * size[0].min(size[1]).min(0.01);
    let turn = turn.as_vector();
    format!(
        "[[body]]\nid = \"{id}\"\nfree = true\nmaterial = {{ density_kg_m3 = 1000.0 }}\n\
         pose = {{ position = {at:?}, orientation = [{:?}, {:?}, {:?}, {:?}] }}\n{more}\n\
         [body.surface.inline]\nformat = \"palpate.surface.v1\"\nunit = \"m\"\ndegree = [3, 3]\n\
         periodic = [true, false]\nknots = {}\npoints = {}\n",
        turn[0],
        turn[1],
        turn[2],
        turn[3],
        knots(),
        net(size, rounded)
    )
}

fn rub(a: &str, b: &str, mu: f64) -> String {
    format!("[[contact]]\npair = [\"{a}\", \"{b}\"]\nfriction = {{ mu = {mu:?} }}\n")
}

fn world(bodies: &str) -> World {
    World::new(&format!(
        "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n\
         [[body]]\nid = \"floor\"\nsurface = {{ builtin = \"sheet\", size = 1.0 }}\n{bodies}\n\
         [[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\npose = {{ position = {FAR:?} }}\n"
    ))
}

/// Ticks until all `bodies` after the floor sleep, if they do.
fn rests(world: &mut World, bodies: usize, most: usize) -> Option<usize> {
    (0..most).find(|_| {
        world.at_in_place(FAR);
        (1..=bodies).all(|b| world.state.is_left_alone(b))
    })
}

/// Where the middle of a box is, m.
fn middle(world: &World, body: usize) -> Vector3 {
    let motion = world.state.rigid_motion(&world.scene, body);
    motion.expect("a free body").centre.coords
}

// From each face, and from edges and corners at any angle, a box comes to lie on a face.
#[test]
fn a_box_that_is_set_on_a_face_an_edge_or_a_corner_comes_to_lie_on_a_face() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut turns = vec![
        Vector3::zeros(),
        Vector3::new(quarter, 0.0, 0.0),
        Vector3::new(2.0 * quarter, 0.0, 0.0),
        Vector3::new(3.0 * quarter, 0.0, 0.0),
        Vector3::new(0.0, quarter, 0.0),
        Vector3::new(0.0, -quarter, 0.0),
        // On an edge, and a little beyond balance.
        Vector3::new(0.52 * quarter, 0.0, 0.0),
        Vector3::new(0.0, 0.48 * quarter, 0.0),
    ];
    let mut random = Random(47);
    turns.extend((0..12).map(|_| random.vector() * 2.0));
    for turn in turns {
        let turn = rotation_by(&turn);
        let [length, width, height] = BRICK;
        // Its lowest corner is 0.1 mm above the floor.
        let up = Vector3::new(0.0, 0.0, 0.5 * height);
        let corners = [-0.5, 0.5].into_iter().flat_map(|x| {
            [-0.5, 0.5].into_iter().flat_map(move |y| {
                [0.0, 1.0].map(|z| Vector3::new(x * length, y * width, z * height))
            })
        });
        let lowest = corners
            .map(|corner| (turn * corner).z)
            .fold(f64::INFINITY, f64::min);
        let at = [0.0, 0.0, 1e-4 - lowest];
        let text = block("box", BRICK, at, &turn, "") + &rub("box", "floor", 0.5);
        let mut world = world(&text);
        let ticks = rests(&mut world, 1, 3_000);
        let z = middle(&world, 1).z;
        println!(
            "from {:.2?}: asleep after {ticks:?} ticks, {z}",
            (turn * up).as_slice()
        );
        assert!(ticks.is_some(), "it never rests: {z}");
        let off = [0.5 * length, 0.5 * height].map(|half| (z - half).abs());
        assert!(off[0].min(off[1]) < 5e-6, "its middle is at {z}");
    }
}

#[test]
fn a_wall_of_bricks_rests() {
    let [length, _, height] = BRICK;
    let place = |row: usize, column: usize| {
        let shift = if row % 2 == 1 { 0.25 } else { 0.0 };
        (column as f64 - 2.0 + shift) * (length + 5e-4)
    };
    let mut text = String::new();
    for row in 0..5 {
        for column in 0..5 {
            let z = (height + 2e-5) * row as f64 + 2e-5;
            let at = [place(row, column), 0.0, z];
            text += &block(
                &format!("b{row}{column}"),
                BRICK,
                at,
                &Rotation::identity(),
                "",
            );
        }
    }
    for column in 0..5 {
        text += &rub("floor", &format!("b0{column}"), 0.5);
        for (row, other) in (1..5).flat_map(|row| (0..5).map(move |other| (row, other))) {
            if (place(row, column) - place(row - 1, other)).abs() < length {
                text += &rub(
                    &format!("b{}{other}", row - 1),
                    &format!("b{row}{column}"),
                    0.5,
                );
            }
        }
    }
    let mut world = world(&text);
    let ticks = rests(&mut world, 25, 600);
    assert!(ticks.is_some(), "the wall never rests");
    let mut worst = [0.0f64; 2];
    for row in 0..5 {
        for column in 0..5 {
            let stands = Vector3::new(place(row, column), 0.0, height * (row as f64 + 0.5));
            let off = middle(&world, 1 + 5 * row + column) - stands;
            worst = [worst[0].max(off.xy().norm()), worst[1].max(off.z.abs())];
        }
    }
    println!("asleep after {ticks:?} ticks, off by {worst:?} m");
    assert!(
        worst[0] < 5e-5 && worst[1] < 1e-5,
        "a brick is off by {worst:?} m"
    );
}

// The last one claps down flat: its far edge comes down by 1.5 mm a tick.
#[test]
fn a_row_of_dominoes_falls_and_lies_above_the_floor() {
    let mut text = String::new();
    for k in 0..20 {
        let spin = if k == 0 {
            "spin_rad_s = [0.0, 25.0, 0.0]"
        } else {
            ""
        };
        let at = [0.02 * f64::from(k) - 0.2, 0.0, 2e-5];
        text += &block(&format!("d{k}"), DOMINO, at, &Rotation::identity(), spin);
    }
    for k in 0..20 {
        let _ = write!(text, "{}", rub("floor", &format!("d{k}"), 0.5));
        if k > 0 {
            text += &rub(&format!("d{}", k - 1), &format!("d{k}"), 0.2);
        }
    }
    let mut world = world(&text);
    for _ in 0..1_000 {
        world.at_in_place(FAR);
    }
    let before: Vec<Vector3> = (1..=20).map(|b| middle(&world, b)).collect();
    for _ in 0..200 {
        world.at_in_place(FAR);
    }
    let after: Vec<Vector3> = (1..=20).map(|b| middle(&world, b)).collect();
    let moved_m = before.iter().zip(&after).map(|(a, b)| (a - b).norm());
    let moved_m = moved_m.fold(0.0, f64::max);
    println!(
        "in 0.2 s they move by {moved_m:.1e} m; {:.5?}",
        after[19].as_slice()
    );
    // Those that lean on each other may tremble, but do not creep.
    assert!(moved_m < 1e-5, "one moves by {moved_m} m");
    assert!(
        after.iter().all(|at| (0.00299..0.0125).contains(&at.z)),
        "one stands or is in the floor: {after:?}"
    );
    assert!(
        (after[19].z - 0.003).abs() < 5e-6,
        "the last one does not lie"
    );
}
