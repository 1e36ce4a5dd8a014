//! What a tick costs over what a scene is made of, one number growing and all else the same, and the
//! exponent p of t ~ nᵖ that fits best.
//!
//! Of what is touched (tools, contacts, nodes, a net that is refined) the work of a tick must grow; of
//! what is not touched (bodies elsewhere or at rest, faces and knots away from the contact) it should
//! hardly.

use super::indent::{failed, first_touch};
use super::scenes::TeardropCase;
use super::world::World;
use super::{Effort, Row, TEARDROP_REFERENCE_N, side_by_side};
use palpate_sim::haptics::DevicePose;

/// A number that grows.
struct Growth {
    /// `scaling/NAME/n`.
    name: &'static str,
    /// What n counts.
    of: &'static str,
    /// All of them, of which a quick run takes the first four.
    sizes: &'static [usize],
    scene: fn(usize) -> String,
    /// Where its tools are in a tick, which moves them a little.
    hands: fn(usize, f64) -> Vec<[f64; 3]>,
    /// Ticks before any counts.
    first: usize,
}

const GROWTHS: [Growth; 6] = [
    Growth {
        name: "tools",
        of: "tools that press a rigid sphere",
        sizes: &[1, 4, 16, 32, 64],
        scene: |n| format!("{}{}", sphere("ball", [8, 8], 0.0), balls(n)),
        hands: around_sphere,
        first: 100,
    },
    Growth {
        name: "bodies",
        of: "rigid bodies, of which one is touched",
        sizes: &[1, 4, 16, 64, 256],
        scene: |n| {
            let others = (1..n).map(|k| sphere(&format!("b{k}"), [8, 8], 0.1 * k as f64));
            format!(
                "{}{}{}",
                sphere("ball", [8, 8], 0.0),
                others.collect::<String>(),
                balls(1)
            )
        },
        hands: |_, t| around_sphere(1, t),
        first: 100,
    },
    Growth {
        name: "at-rest",
        of: "free bodies that lie on a floor, none of them touched",
        sizes: &[1, 4, 16, 64],
        scene: at_rest,
        hands: |_, t| vec![[1e-4 * t, 0.0, 0.3]],
        first: 3_000,
    },
    Growth {
        name: "net",
        of: "control points a side of a rigid sphere that is touched at one place",
        sizes: &[8, 16, 24, 32, 48],
        scene: |n| format!("{}{}", sphere("ball", [n, n], 0.0), balls(1)),
        hands: |_, t| around_sphere(1, t),
        first: 100,
    },
    Growth {
        name: "faces",
        of: "triangles of a tool that touches a rigid sphere at one place",
        sizes: &[80, 320, 1_280, 5_120],
        scene: |n| format!("{}{}", sphere("ball", [8, 8], 0.0), mesh_ball(n)),
        hands: |_, t| around_sphere(1, t),
        first: 100,
    },
    Growth {
        name: "contacts",
        of: "balls that press one soft teardrop",
        sizes: &[1, 2, 4, 8, 16],
        scene: |n| format!("{}{}", soft_teardrop(), balls(n)),
        hands: |n, t| {
            let hand = |k: usize| {
                let z = 0.035 + 0.02 * (k as f64 + 0.5) / n as f64;
                [0.0175 + 0.005 * libm::exp(-t), 0.003, z]
            };
            (0..n).map(hand).collect()
        },
        first: 300,
    },
];

fn sphere(id: &str, net: [usize; 2], y: f64) -> String {
    format!(
        "[[body]]\nid = \"{id}\"\nsurface = {{ builtin = \"sphere\", size = 0.02, net = {net:?} }}\npose = {{ position = [0.0, {y:?}, 0.0] }}\n"
    )
}

fn balls(n: usize) -> String {
    let ball = |k: usize| {
        format!(
            "[[tool]]\nid = \"t{k}\"\nshape = {{ sphere = {{ radius_m = 0.002 }} }}\npose = {{ position = [0.06, 0.0, {:?}] }}\n",
            0.03 + 0.005 * k as f64
        )
    };
    (0..n).map(ball).collect()
}

fn soft_teardrop() -> String {
    "[[body]]\nid = \"drop\"\nsurface = { builtin = \"teardrop\", net = [8, 8] }\nmodel = \"continuum\"\n\
     material = { young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 2e-3 }\nlattice = { layers = 2, refine = \"none\" }\n\
     fixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]\n"
        .to_owned()
}

/// Pucks of 40 mm on a floor, and a tool far above.
fn at_rest(n: usize) -> String {
    let puck = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/stack/puck.json");
    let mut text = "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n[[body]]\nid = \"floor\"\nsurface = { builtin = \"sheet\", size = 1.0 }\n"
        .to_owned();
    for k in 0..n {
        let (x, y) = (0.05 * (k % 8) as f64 - 0.17, 0.05 * (k / 8) as f64 - 0.17);
        text += &format!(
            "[[body]]\nid = \"b{k}\"\nfree = true\nsurface = {{ file = {puck:?} }}\n\
             material = {{ density_kg_m3 = 1000.0 }}\npose = {{ position = [{x:?}, {y:?}, 0.00002] }}\n"
        );
    }
    text + &balls(1)
}

/// Places 1.5 mm inside a ball of 2 mm's touch of a sphere of 20 mm, spread over it, which tremble.
fn around_sphere(n: usize, t: f64) -> Vec<[f64; 3]> {
    let radius = 0.0205 + 1e-4 * libm::sin(t);
    let place = |k: usize| {
        let z = 1.0 - 2.0 * (k as f64 + 0.4) / n as f64;
        let z = if n == 1 { 0.6 } else { z };
        let (sin, cos) = libm::sincos(2.399_963 * k as f64 + 0.05 * t);
        let across = (1.0 - z * z).sqrt();
        [radius * across * cos, radius * across * sin, radius * z]
    };
    (0..n).map(place).collect()
}

/// A ball of 2 mm of so many triangles, as a tool.
fn mesh_ball(triangles: usize) -> String {
    let (mut points, mut faces) = octahedron();
    while faces.len() < triangles {
        (points, faces) = split(&points, &faces);
    }
    let points: Vec<_> = points.iter().map(|p| p.map(|x| 0.002 * x)).collect();
    format!(
        "[[tool]]\nid = \"t0\"\nshape = {{ mesh = {{ inline = {{ vertices = {points:?}, triangles = {faces:?} }} }} }}\n\
         pose = {{ position = [0.06, 0.0, 0.03] }}\n"
    )
}

type Mesh = (Vec<[f64; 3]>, Vec<[usize; 3]>);

fn octahedron() -> Mesh {
    let points = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let upper = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let lower = upper.map(|[a, b, _]| [b, a, 5]);
    (points, [upper, lower].concat())
}

/// Each triangle in four, with the new points on the sphere.
fn split(points: &[[f64; 3]], faces: &[[usize; 3]]) -> Mesh {
    let mut points = points.to_vec();
    let mut between = std::collections::BTreeMap::new();
    let mut middle = |a: usize, b: usize, points: &mut Vec<[f64; 3]>| {
        *between.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let sum: [f64; 3] = std::array::from_fn(|k| points[a][k] + points[b][k]);
            let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
            points.push(sum.map(|x| x / length));
            points.len() - 1
        })
    };
    let mut finer = Vec::with_capacity(4 * faces.len());
    for &[a, b, c] in faces {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(a, b)| middle(a, b, &mut points));
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    (points, finer)
}

/// Nodes along each axis of a lattice in the teardrop.
const SIDES: [usize; 6] = [8, 12, 16, 20, 24, 30];
/// Ticks of a press by 3 mm, and those that are timed after it.
const PRESS: usize = 300;

/// What a tick costs over what a scene is made of. Each row is handed out as soon as it is measured.
pub fn scaling(effort: Effort, cases: super::Cases<'_>, out: &mut dyn FnMut(Row)) {
    let wanted = |case: &str| cases.has(case);
    let quick = |sizes: usize| match effort {
        Effort::Quick => sizes.min(4),
        Effort::Full => sizes,
    };
    if wanted(side_by_side::CASE) {
        side_by_side::rows(effort, out);
    }
    for growth in &GROWTHS {
        let name = format!("scaling/{}", growth.name);
        let mut points = Vec::new();
        for &n in &growth.sizes[..quick(growth.sizes.len())] {
            let case = format!("{name}/{n}");
            if wanted(&case) {
                out(grown(growth, &case, n, effort, &mut points));
            }
        }
        if points.len() > 1 {
            out(fitted(&name, growth.of, &points));
        }
    }
    for matrix in ["auto", "bounding"] {
        let name = format!("scaling/nodes/{matrix}");
        let mut points = Vec::new();
        for &side in &SIDES[..quick(SIDES.len())] {
            let case = format!("{name}/{side}");
            if wanted(&case) {
                out(pressed(&case, matrix, side, effort, &mut points));
            }
        }
        if points.len() > 1 {
            out(fitted(&name, "free nodes of a pressed lattice", &points));
        }
    }
}

/// Ticks of one size; adds it and the median tick to `points`.
fn grown(growth: &Growth, case: &str, n: usize, effort: Effort, points: &mut Vec<[f64; 2]>) -> Row {
    let mut world = match World::new(&(growth.scene)(n)) {
        Ok(world) => world,
        Err(why) => return failed(case, &why),
    };
    let ticks = match effort {
        Effort::Quick => 200,
        Effort::Full => 1_000,
    };
    let mut contacts = 0;
    for k in 0..growth.first + ticks {
        let hands = (growth.hands)(n, 0.02 * k as f64);
        let poses: Vec<_> = hands.into_iter().map(DevicePose::at_rest).collect();
        contacts = world.posed(&poses).contacts.list().len();
    }
    world.ticks_s.drain(..growth.first);
    let note = format!("{contacts} contacts reported, {} faults", world.faults);
    let row = Row {
        suite: "scaling",
        ..world.row(case, "tick", note)
    };
    points.extend(row.times.map(|times| [n as f64, times.median_s]));
    row
}

/// Ticks of a pressed cube of nodes; adds its free nodes and the median tick to `points`. Error: of the
/// force at 3 mm against the converged solid, after a press that is not quite over.
fn pressed(
    case: &str,
    matrix: &str,
    side: usize,
    effort: Effort,
    points: &mut Vec<[f64; 2]>,
) -> Row {
    // One coarse net for all, which even the smallest cube sees.
    let scene = TeardropCase::cube(case, side, "\"none\"").text(1_000);
    let chosen = format!("integrator = {{ matrix = \"{matrix}\", ");
    let mut world = match World::new(&scene.replace("integrator = { ", &chosen)) {
        Ok(world) => world,
        Err(why) => return failed(case, &why),
    };
    let touch = first_touch(world.scene.rest_surface(0).expect("a surface"));
    let mut press = |k: usize| {
        let depth = 3e-3 * (k as f64 / PRESS as f64).min(1.0);
        world.at([touch - depth, 0.003, 0.045]).tools[0]
            .force_n
            .norm()
    };
    for k in 0..PRESS {
        press(k);
    }
    let held = match effort {
        Effort::Quick => 100,
        Effort::Full => 500,
    };
    let force_n = (PRESS..PRESS + held)
        .map(&mut press)
        .fold(0.0, |_, force_n| force_n);
    world.ticks_s.drain(..PRESS);
    let Some(body) = world.scene.deformable(0) else {
        return failed(case, "it does not deform");
    };
    let (free, matrix) = (body.unknown_count(), body.step_matrix().unwrap_or("none"));
    let note = format!(
        "{free} nodes are free; {matrix} matrix, {} numbers in its factor, compliance {:.1} MB; force {force_n:.4} N",
        body.factor_non_zeros(),
        body.compliance_bytes() as f64 * 1e-6,
    );
    let error = (force_n / TEARDROP_REFERENCE_N[2] - 1.0).abs();
    let row = Row {
        suite: "scaling",
        ..world.row(case, matrix, note)
    };
    points.extend(row.times.map(|times| [free as f64, times.median_s]));
    row.off_by(error, "of the force")
}

/// The exponent of times over sizes, by least squares on their logarithms; error: the farthest point's
/// share off that line.
fn fitted(case: &str, of: &str, points: &[[f64; 2]]) -> Row {
    let logs: Vec<[f64; 2]> = points.iter().map(|point| point.map(libm::log)).collect();
    let (exponent, at_one) = line(&logs);
    let off = |[x, y]: &[f64; 2]| (libm::exp(y - at_one - exponent * x) - 1.0).abs();
    let worst = logs.iter().map(off).fold(0.0, f64::max);
    let row = Row::new("scaling", case, "fit").off_by(worst, "of the time, off the fit");
    row.saying(format!(
        "the tick grows with the {exponent:.2}th power of the {of}, of {} sizes",
        points.len()
    ))
}

/// Slope and intercept of the line nearest to points.
fn line(points: &[[f64; 2]]) -> (f64, f64) {
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|point| point[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let both: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let own: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    let slope = both / own;
    (slope, y - slope * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_law_is_found() {
        let points = [100.0, 500.0, 4_000.0].map(|n: f64| [n, 3e-7 * libm::pow(n, 1.4)]);
        let row = fitted("case", "nodes", &points);
        assert!(row.note.contains("1.40th"), "{}", row.note);
        assert!(row.error_size().is_some_and(|error| error < 1e-9));
    }

    #[test]
    fn every_scene_that_grows_is_built_and_touched_as_it_says() {
        for growth in &GROWTHS {
            let n = growth.sizes[0];
            let row = grown(growth, growth.name, n, Effort::Quick, &mut Vec::new());
            let touched = !row.note.starts_with("0 contacts") || growth.name == "at-rest";
            assert!(
                row.times.is_some() && touched,
                "{}: {}",
                growth.name,
                row.note
            );
            assert!(
                row.note.ends_with("0 faults"),
                "{}: {}",
                growth.name,
                row.note
            );
        }
    }
}
