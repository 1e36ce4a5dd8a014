//! Balls and half-spaces against parts by hand, in closed form, and against parts of files.

use super::*;
use crate::contact::{Contact, ContactSet, Reach, ToolPoint};
use crate::exchange::step::{PartPick, read_part};
use crate::math::{Point3, Random, Vector3};
use crate::part::hand::{FILES, axes, cone, cylinder, prism, rounded, walls, whole};
use crate::part::{Brep, BrepCurve, Carrier};

const BOX: [[f64; 2]; 4] = [[0.0, 0.0], [0.06, 0.0], [0.06, 0.04], [0.0, 0.04]];

struct Rig {
    part: Part,
    pose: Pose,
    solver: PartSolver,
    scratch: PartScratch,
    set: ContactSet,
}

impl Rig {
    fn of(part: Part, pose: Pose) -> Self {
        Self {
            pose,
            solver: PartSolver::new(&part),
            scratch: PartScratch::new(&part),
            set: ContactSet::new(),
            part,
        }
    }

    fn new(brep: &Brep, random: &mut Random) -> Self {
        Self::of(Part::new(brep).expect("a part"), pose(random))
    }

    fn of_file(name: &str, random: &mut Random) -> Self {
        let path = format!(
            "{}/tests/data/parts/{name}.step",
            env!("CARGO_MANIFEST_DIR")
        );
        let bytes = std::fs::read(path).expect("the file");
        let read = read_part(&bytes, &PartPick::default()).expect("a part");
        Self::new(&read.brep, random)
    }

    /// A ball around a place in the part's frame.
    fn ball(&mut self, q: &Point3, radius_m: f64, reach: &Reach) -> &[Contact] {
        let side = PartSide {
            part: &self.part,
            pose: &self.pose,
            solver: &mut self.solver,
        };
        let centre = self.pose * q;
        ball::contacts(
            side,
            &centre,
            radius_m,
            reach,
            &mut self.scratch,
            &mut self.set,
        );
        self.check(|on_tool, depth_m| {
            let off = (on_tool - centre).norm() - radius_m;
            off.abs() <= 1e-6 * radius_m + 4.0 * self.part.gap_m() || depth_m > radius_m
        });
        self.set.contacts()
    }

    /// A half-space below a plane through a place with a normal, both in the part's frame.
    fn plane(&mut self, place: &Point3, normal: &Vector3, reach: &Reach) -> &[Contact] {
        let side = PartSide {
            part: &self.part,
            pose: &self.pose,
            solver: &mut self.solver,
        };
        let (place, normal) = (self.pose * place, self.pose * normal);
        plane::contacts(
            side,
            &place,
            &normal,
            reach,
            &mut self.scratch,
            &mut self.set,
        );
        self.check(|on_tool, _| (on_tool - place).dot(&normal).abs() < 1e-12);
        self.set.contacts()
    }

    fn check(&self, is_of_tool: impl Fn(&Point3, f64) -> bool) {
        for contact in self.set.contacts() {
            let apart = contact.on_body - contact.on_tool - contact.normal * contact.depth_m;
            assert!(apart.norm() < 1e-15, "{contact:?}");
            assert!((contact.normal.norm() - 1.0).abs() < 1e-12, "{contact:?}");
            let named = self.pose * self.part.point([contact.u, contact.v]);
            let off = (named - contact.on_body).norm();
            let most = 1e-9 * self.part.size_m() + 2.0 * self.part.gap_m();
            assert!(off <= most, "{off:e} m off {contact:?}");
            assert!(is_of_tool(&contact.on_tool, contact.depth_m), "{contact:?}");
        }
    }
}

fn pose(random: &mut Random) -> Pose {
    let [x, y, z] = random.vector().into();
    Pose::translation(0.1 * x, 0.1 * y, 0.1 * z) * random.rotation()
}

fn touch() -> Reach {
    Reach::TOUCH
}

/// Signed distance of a box, rounded about z or not, between two heights.
fn box_distance(p: &Point3, centre: [f64; 2], half: [f64; 2], radius: f64, height: f64) -> f64 {
    let a = (p.x - centre[0]).abs() - half[0] + radius;
    let b = (p.y - centre[1]).abs() - half[1] + radius;
    let across = a.max(0.0).hypot(b.max(0.0)) + a.max(b).min(0.0) - radius;
    let up = (p.z - 0.5 * height).abs() - 0.5 * height;
    across.max(0.0).hypot(up.max(0.0)) + across.max(up).min(0.0)
}

#[test]
fn a_convex_part_has_one_contact_of_the_right_depth() {
    let mut random = Random(61);
    let (half, r, h) = ([0.03, 0.02], 0.006, 0.02);
    let square = |p: &Point3| box_distance(p, half, half, 0.0, h);
    let round = |p: &Point3| box_distance(p, [0.0; 2], half, r, h);
    let can = |p: &Point3| box_distance(p, [0.0; 2], [0.01; 2], 0.01, h);
    type Case<'a> = (&'a str, Brep, &'a dyn Fn(&Point3) -> f64);
    let cases: [Case<'_>; 3] = [
        ("box", prism(&BOX, h), &square),
        ("rounded", rounded(half, r, h), &round),
        ("cylinder", cylinder(0.01, h), &can),
    ];
    for (name, brep, distance) in cases {
        for _ in 0..8 {
            let mut rig = Rig::new(&brep, &mut random);
            for k in 0..2_000 {
                let mut q = Point3::from(random.vector() * 0.08);
                if k % 4 == 0 {
                    // On or beside the smooth edges of the rounded one.
                    let off = 10f64.powf(random.float(-14.0, -5.0));
                    q = Point3::new(half[0] + 0.01 * random.unit(), half[1] - r + off, 0.01);
                }
                let radius = random.float(0.0, 0.04);
                let right = distance(&q);
                let found = rig.ball(&q, radius, &touch());
                if right > radius {
                    assert!(found.is_empty(), "{name} {k}: {found:?}");
                    continue;
                }
                let Some(deepest) = found.first() else {
                    panic!("{name} {k}: nothing at {q}, {right}");
                };
                let off = (deepest.depth_m - (radius - right)).abs();
                assert!(off < 1e-14, "{name} {k}: {found:?} at {q}, {right}");
                assert_eq!(found.len(), 1, "{name} {k}: {found:?} at {q}, {right}");
                let slope = Vector3::from_fn(|c, _| {
                    let step = Vector3::ith(c, 1e-6);
                    (distance(&(q + step)) - distance(&(q - step))) / 2e-6
                });
                let normal = deepest.normal;
                let turned = (normal - rig.pose * slope).norm();
                // On the medial axis the distance has a kink, and no gradient to compare with.
                let clear = (slope.norm() - 1.0).abs() < 1e-6 && right.abs() > 1e-4;
                assert!(!clear || turned < 1e-3, "{name} {k}: {turned} at {q}");
            }
            assert_eq!(rig.scratch.minima.missed, 0, "{name}");
        }
    }
}

#[test]
fn a_ball_in_a_corner_touches_both_walls() {
    let notch = [
        [0.0, 0.0],
        [0.06, 0.0],
        [0.06, 0.02],
        [0.02, 0.02],
        [0.02, 0.06],
        [0.0, 0.06],
    ];
    let mut random = Random(62);
    let mut rig = Rig::new(&prism(&notch, 0.1), &mut random);
    for _ in 0..2_000 {
        let [a, b] = [0, 1].map(|_| random.float(1e-5, 0.009));
        let q = Point3::new(0.02 + a, 0.02 + b, random.float(0.02, 0.08));
        let mut depths = [a, b].map(|d| 0.01 - d);
        depths.sort_unstable_by(|x, y| y.total_cmp(x));
        let found = rig.ball(&q, 0.01, &touch());
        assert_eq!(found.len(), 2, "{found:?}");
        for (contact, depth) in found.iter().zip(depths) {
            assert!((contact.depth_m - depth).abs() < 1e-14, "{found:?}");
        }
        let normals = found[0].normal.dot(&found[1].normal);
        assert!(normals.abs() < 1e-12, "{found:?}");
    }
    // On the edge's own line, from within the matter, it is the nearest.
    let found = rig.ball(&Point3::new(0.019, 0.019, 0.05), 0.01, &touch());
    assert!((found[0].depth_m - (0.01 + 1e-3 * 2f64.sqrt())).abs() < 1e-14);
}

/// The floor of a notch is of two faces, and the edge between them is off both.
#[test]
fn a_second_contact_is_not_lost_over_an_edge_with_a_gap() {
    let notch = [
        [0.0, 0.0],
        [0.06, 0.0],
        [0.06, 0.02],
        [0.025, 0.02],
        [0.02, 0.02],
        [0.02, 0.06],
        [0.0, 0.06],
    ];
    let mut random = Random(69);
    for gap in [0.0, 1e-9, -1e-9, 1e-7, -1e-7, 1e-6, -1e-6, 1e-5, -1e-5] {
        let mut brep = prism(&notch, 0.1);
        let is_there = |p: &Point3| p.x == 0.025;
        for edge in &mut brep.edges {
            let upright = edge.ends.map(|v| is_there(&brep.vertices[v as usize])) == [true; 2];
            if let (BrepCurve::Line { origin, .. }, true) = (&mut edge.curve, upright) {
                origin.y += gap;
            }
        }
        let moved = brep.vertices.iter_mut().filter(|p| is_there(p));
        moved.for_each(|p| p.y += gap);
        let mut rig = Rig::new(&brep, &mut random);
        assert!((rig.part.gap_m() - gap.abs()).abs() < 1e-15);
        for k in 0..2_000 {
            let off = 10f64.powf(random.float(-15.0, -3.0)) * random.signed();
            // Farther from the floor than from the wall beside it.
            let height = random.float(0.0065, 0.0095);
            let q = Point3::new(0.025 + off, 0.02 + height, random.float(0.02, 0.08));
            let found = rig.ball(&q, 0.01, &touch());
            assert_eq!(found.len(), 2, "{gap:e} {k}: {found:?} at {off:e}");
            let short = found[1].depth_m - (0.01 - height);
            assert!(short.abs() <= gap.abs() + 1e-14, "{gap:e} {k}: {found:?}");
        }
    }
}

#[test]
fn an_apex_is_a_contact_where_it_is_the_nearest() {
    let mut random = Random(70);
    let mut rig = Rig::new(&cone(), &mut random);
    for _ in 0..2_000 {
        // Within 45° of straight above, and not.
        let [x, y] = [random.signed(), random.signed()].map(|x| 0.008 * x);
        let q = Point3::new(x, y, 0.01 + 0.01 * random.unit());
        let (rho, up) = (x.hypot(y), q.z - 0.01);
        let right = match up > rho {
            true => rho.hypot(up),
            false => (rho + up) * 0.5f64.sqrt(),
        };
        let found = rig.ball(&q, 0.02, &touch());
        assert_eq!(found.len(), 1, "{found:?} at {q}");
        assert!((found[0].depth_m - (0.02 - right)).abs() < 1e-14);
    }
    assert_eq!(rig.scratch.minima.missed, 0);
}

/// The places of edges are where the most can go wrong.
#[test]
fn balls_right_above_the_edges_of_files_are_held() {
    let mut random = Random(71);
    for name in FILES {
        let mut rig = Rig::of_file(name, &mut random);
        let size = rig.part.size_m();
        let mesh = rig
            .part
            .triangles(1e-2 * size, 1_000_000)
            .expect("triangles");
        let mut of: Vec<Option<u32>> = vec![None; mesh.mesh.points.len()];
        let mut on_edge = vec![false; of.len()];
        for (triangle, face) in mesh.mesh.triangles.iter().zip(&mesh.faces) {
            for &k in triangle {
                on_edge[k as usize] |= of[k as usize].is_some_and(|other| other != *face);
                of[k as usize] = Some(*face);
            }
        }
        let edges: Vec<Point3> = (mesh.mesh.points.iter().zip(&on_edge))
            .filter(|(_, on)| **on)
            .map(|(p, _)| *p)
            .collect();
        let (mut several, mut took) = (0, std::time::Duration::ZERO);
        let count = 1_500;
        for _ in 0..count {
            let p = edges[random.below(edges.len())];
            let foot = rig.solver.closest(&rig.part, &p).expect("finite");
            let tiny = 10f64.powf(random.float(-14.0, -3.0)) * size;
            let q = p + foot.normal * (0.01 * size * random.unit()) + random.vector() * tiny;
            let closest = rig.solver.closest(&rig.part, &q).expect("finite");
            let radius = closest.distance + 1e-4 * size;
            let start = std::time::Instant::now();
            let found = rig.ball(&q, radius, &touch()).len();
            took += start.elapsed();
            let depth = rig.set.deepest().map(|c| c.depth_m);
            let right = match closest.signed_distance {
                Some(signed) if signed < 0.0 => radius + closest.distance,
                _ => radius - closest.distance,
            };
            assert!(
                depth.is_some_and(|d| (d - right).abs() < 1e-12),
                "{name}: {depth:?} for {right} at {q}"
            );
            several += usize::from(found > 1);
        }
        assert_eq!(rig.scratch.minima.missed, 0, "{name}");
        println!(
            "{name}: {several} of {count} with several contacts, {:.1} µs each",
            took.as_secs_f64() * 1e6 / f64::from(count),
        );
    }
}

#[test]
fn a_sheet_holds_from_both_sides_and_lets_go_beside_its_rim() {
    let mut random = Random(63);
    let strip = [[0.0, 0.0], [0.05, 0.0], [0.05, 0.05], [0.0, 0.05]];
    let mut maker = walls(&strip, 0.04);
    // Two walls at right angles.
    maker.0.faces.truncate(2);
    let brep = maker.0;
    let mut rig = Rig::new(&brep, &mut random);
    assert!(!rig.part.is_closed());
    let below = Reach {
        below: true,
        ..Reach::TOUCH
    };
    let away = Point3::new(0.02, -0.002, 0.02);
    let depth = |found: &[Contact]| found.first().map(|c| c.depth_m);
    let near = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-14);
    assert!(near(depth(rig.ball(&away, 0.005, &touch())), 0.003));
    assert!(near(depth(rig.ball(&away, 0.005, &below)), 0.007));
    let inner = Point3::new(0.02, 0.002, 0.02);
    assert!(near(depth(rig.ball(&inner, 0.005, &touch())), 0.007));
    assert!(near(depth(rig.ball(&inner, 0.005, &below)), 0.003));
    // In the corner, behind: both walls from below.
    let corner = Point3::new(0.048, 0.003, 0.02);
    let found = rig.ball(&corner, 0.005, &below);
    assert_eq!(found.len(), 2, "{found:?}");
    // Outside the corner: the edge.
    let out = Point3::new(0.052, -0.002, 0.02);
    assert!(near(
        depth(rig.ball(&out, 0.005, &touch())),
        0.005 - 0.002 * 2f64.sqrt()
    ));
    // Beside the rim, on either side of the wall's plane.
    for y in [-0.001, 0.001] {
        let q = Point3::new(0.02, y, 0.042);
        let found = rig.ball(&q, 0.005, &touch());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(near(depth(found), 0.005 - 0.002f64.hypot(y)));
    }
}

#[test]
fn nothing_falls_through_an_edge_that_is_nearly_smooth() {
    let mut random = Random(64);
    for turn in [0.0, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2] {
        for sign in [1.0, -1.0] {
            let ridge = 0.02 + sign * 0.03 * libm::tan(0.5 * turn);
            let roof = [
                [0.0, 0.0],
                [0.06, 0.0],
                [0.06, 0.02],
                [0.03, ridge],
                [0.0, 0.02],
            ];
            let mut rig = Rig::new(&prism(&roof, 0.05), &mut random);
            let mut twice = 0;
            for _ in 0..1_000 {
                let off = 10f64.powf(random.float(-12.0, -2.0)) * random.signed();
                let height = random.float(1e-4, 9e-3);
                let q = Point3::new(0.03 + off, ridge + height, 0.025);
                let closest = rig.solver.closest(&rig.part, &q).expect("finite");
                let found = rig.ball(&q, 0.01, &touch());
                let depth = found.first().map(|c| c.depth_m);
                let right = 0.01 - closest.distance;
                assert!(
                    depth.is_some_and(|d| (d - right).abs() < 1e-14),
                    "{turn:e}: {found:?} at {off:e}"
                );
                assert!(
                    sign < 0.0 || found.len() == 1,
                    "{turn:e}: {found:?} at {off:e}"
                );
                twice += found.len() - 1;
            }
            assert_eq!(rig.scratch.minima.missed, 0, "{turn:e}");
            println!("turn {:e}: {twice} of 1000 twice", sign * turn);
        }
    }
}

#[test]
fn balls_against_parts_of_files_are_as_deep_as_they_are_near() {
    let mut random = Random(65);
    for name in FILES {
        let mut rig = Rig::of_file(name, &mut random);
        let size = rig.part.size_m();
        let mesh = rig
            .part
            .triangles(1e-3 * size, 1_000_000)
            .expect("triangles")
            .mesh;
        let (mut outside, mut contacts, mut worst) = (0, 0, 0.0f64);
        let mut dropped = 0;
        for _ in 0..400 {
            let k = random.below(mesh.points.len());
            let out = random.vector() * 0.05 * size * random.unit();
            let q = mesh.points[k] + out;
            let radius = 0.1 * size * random.unit();
            let closest = rig.solver.closest(&rig.part, &q).expect("finite");
            if closest.signed_distance.is_none_or(|d| d < 0.0) {
                continue;
            }
            outside += 1;
            // No place of the mesh is nearer; its points are on the part.
            let near = mesh
                .points
                .iter()
                .map(|p| (p - q).norm())
                .fold(f64::INFINITY, f64::min);
            assert!(closest.distance <= near + 1e-9 * size + 2.0 * rig.part.gap_m());
            let found = rig.ball(&q, radius, &touch());
            let depth = found.first().map_or(f64::NEG_INFINITY, |c| c.depth_m);
            contacts += found.len();
            let right = radius - closest.distance;
            if right > 0.0 {
                let off = (depth - right).abs();
                assert!(off <= 1e-9 * size, "{name}: {depth} for {closest:?} at {q}");
                worst = worst.max(off);
            } else {
                assert!(depth < 1e-12, "{name}: {depth} for {closest:?} at {q}");
            }
            dropped += usize::from(rig.set.dropped() > 0);
        }
        println!(
            "{name}: {outside} outside, {contacts} contacts, off by {:.1e} of the size, missed {}, dropped {dropped}, gap {:.1e}",
            worst / size,
            rig.scratch.minima.missed,
            rig.part.gap_m() / size,
        );
    }
}

#[test]
fn a_ball_that_slides_over_a_part_of_a_file_is_always_held() {
    let mut random = Random(66);
    for name in FILES {
        let mut rig = Rig::of_file(name, &mut random);
        let (size, gap) = (rig.part.size_m(), rig.part.gap_m());
        let mesh = rig
            .part
            .triangles(1e-2 * size, 1_000_000)
            .expect("triangles")
            .mesh;
        let radius = 0.02 * size;
        let (mut held, mut steepest) = (0, 0.0f64);
        for _ in 0..8 {
            let ends = [0, 1].map(|_| mesh.points[random.below(mesh.points.len())]);
            let steps = 250;
            let travel = (ends[1] - ends[0]).norm() / f64::from(steps);
            let mut before: Option<f64> = None;
            let mut q = ends[0];
            for _ in 0..steps {
                q += (ends[1] - ends[0]) / f64::from(steps);
                // Back to just outside the part.
                let foot = rig.solver.closest(&rig.part, &q).expect("finite");
                let on = foot.point + foot.normal * (0.5 * radius);
                let moved = (on - q).norm();
                let closest = rig.solver.closest(&rig.part, &on).expect("finite");
                let found = rig.ball(&on, radius, &touch());
                assert!(
                    closest.distance >= radius || !found.is_empty(),
                    "{name}: nothing at {on}, {closest:?}"
                );
                held += usize::from(!found.is_empty());
                // Along the straight way, the depth changes by no more than the ball moves.
                let found = rig.ball(&q, 10.0 * radius, &touch());
                let depth = found.first().map(|c| c.depth_m);
                if let (Some(a), Some(b)) = (before, depth) {
                    let jump = (a - b).abs() - travel;
                    assert!(
                        jump <= 4.0 * gap + 1e-9 * size,
                        "{name}: {jump:e} at {q}, {moved}"
                    );
                    steepest = steepest.max(jump);
                }
                before = depth;
            }
        }
        println!(
            "{name}: held {held} of 2000; jumps of {:.1e} of the size, gap {:.1e}, missed {}",
            steepest / size,
            gap / size,
            rig.scratch.minima.missed
        );
    }
}

#[test]
fn a_part_rests_on_all_its_corners() {
    let mut random = Random(67);
    let up = Vector3::z();
    for _ in 0..8 {
        let margin = Reach {
            margin_m: 1e-3,
            ..Reach::TOUCH
        };
        let mut rig = Rig::new(&prism(&BOX, 0.02), &mut random);
        let found = rig.plane(&Point3::new(0.3, 0.1, 1e-4), &up, &touch());
        assert_eq!(found.len(), 4, "{found:?}");
        assert!(found.iter().all(|c| (c.depth_m - 1e-4).abs() < 1e-15));
        assert!(found.iter().all(|c| c.point == ToolPoint::Corner));
        // Tilted a little, it keeps them.
        let tilted = Vector3::new(0.01, 0.005, 1.0).normalize();
        assert_eq!(rig.plane(&Point3::origin(), &tilted, &margin).len(), 4);
        // On an edge, and on a corner.
        let edge = Vector3::new(1.0, 0.0, 1.0).normalize();
        assert_eq!(rig.plane(&Point3::origin(), &edge, &margin).len(), 2);
        let corner = Vector3::new(1.0, 1.0, 1.0).normalize();
        assert_eq!(rig.plane(&Point3::origin(), &corner, &margin).len(), 1);

        let mut rig = Rig::new(&cylinder(0.01, 0.02), &mut random);
        let found = rig.plane(&Point3::new(0.0, 0.0, 1e-4), &up, &touch());
        assert_eq!(found.len(), 8, "{found:?}");
        assert!(found.iter().all(|c| (c.depth_m - 1e-4).abs() < 1e-15));
        let found = rig.plane(&Point3::new(-0.0099, 0.0, 0.0), &Vector3::x(), &touch());
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found.iter().all(|c| (c.depth_m - 1e-4).abs() < 1e-15));

        let mut rig = Rig::new(&rounded([0.03, 0.02], 0.006, 0.02), &mut random);
        let found = rig.plane(&Point3::new(0.0, -0.0199, 0.0), &Vector3::y(), &touch());
        assert_eq!(found.len(), 4, "{found:?}");
        let found = rig.plane(&Point3::new(0.0, 0.0, 1e-4), &up, &touch());
        assert!(found.len() >= 8, "{found:?}");

        let ring = Carrier::Torus {
            axes: axes([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
            major_m: 0.02,
            minor_m: 0.005,
        };
        let mut rig = Rig::new(&whole(ring), &mut random);
        let found = rig.plane(&Point3::new(0.0, 0.0, -0.0049), &up, &touch());
        assert_eq!(found.len(), 8, "{found:?}");
        let tilted = Vector3::new(0.01, 0.0, 1.0).normalize();
        let found = rig.plane(&Point3::new(0.0, 0.0, -0.005), &tilted, &touch());
        assert!(matches!(found[0].point, ToolPoint::Deepest { by_m } if by_m < 2e-5));
        let right = 0.02 * tilted.x - 0.005 * (tilted.z - 1.0);
        assert!((found[0].depth_m - right).abs() < 1e-6, "{right} {found:?}");

        let mut rig = Rig::new(&cone(), &mut random);
        let found = rig.plane(&Point3::new(0.0, 0.0, 0.0099), &-up, &touch());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].depth_m - 1e-4).abs() < 1e-15, "{found:?}");
    }
}

#[test]
fn half_spaces_against_parts_are_as_deep_as_their_lowest_points() {
    let mut random = Random(68);
    for name in FILES {
        let mut rig = Rig::of_file(name, &mut random);
        let size = rig.part.size_m();
        let mesh = rig
            .part
            .triangles(1e-3 * size, 1_000_000)
            .expect("triangles");
        let gap = rig.part.gap_m();
        let most = mesh.deviation_m + 4.0 * gap + 1e-9 * size;
        let (mut contacts, mut empty) = (0, 0);
        for _ in 0..100 {
            let Some(normal) = random.vector().try_normalize(0.1) else {
                continue;
            };
            let height = |p: &Point3| normal.dot(&p.coords);
            let points = &mesh.mesh.points;
            let low = points.iter().map(height).fold(f64::INFINITY, f64::min);
            let place = Point3::from(normal * (low + 0.02 * size));
            let found = rig.plane(&place, &normal, &touch());
            let depth = found.first().map_or(f64::NEG_INFINITY, |c| c.depth_m);
            let off = depth - 0.02 * size;
            assert!(off >= -1e-9 * size - 2.0 * gap, "{name}: {off:e} {found:?}");
            assert!(off <= most, "{name}: {off:e} of {most:e}, {found:?}");
            contacts += found.len();
            empty += usize::from(found.is_empty());
        }
        println!("{name}: {contacts} contacts of 100 planes, {empty} without");
    }
}
