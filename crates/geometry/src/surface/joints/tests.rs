use super::super::{ClosestSolver, Direction, Mesh, Surface, WarmFoot, builtin, file};
use super::*;
use crate::basis::Side;
use crate::basis::testing::Random;
use crate::math::{Point3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

fn read(text: &str) -> Surface {
    file::read(text).unwrap().with_exact_seams()
}

fn vessel() -> Surface {
    read(include_str!("../../../../../scenes/vessel.json"))
}

/// Name, surface, distinct patches, leaves.
fn branching() -> Vec<(&'static str, Surface, usize, usize)> {
    vec![
        ("vessel", vessel(), 6, 2),
        (
            "three leaves",
            read(include_str!("../../../tests/data/three-leaves.json")),
            12,
            3,
        ),
        (
            "four leaves",
            read(include_str!("../../../tests/data/four-leaves-twisted.json")),
            14,
            4,
        ),
    ]
}

fn shown(joints: &Joints) -> usize {
    joints
        .patches()
        .iter()
        .filter(|patch| patch.duplicate_of.is_none())
        .count()
}

#[test]
fn patches_of_branching_nets_are_counted_once() {
    for (name, surface, distinct, leaves) in branching() {
        let joints = surface.joints().unwrap();
        println!(
            "{name}: {} of {} patches",
            shown(&joints),
            joints.patches().len()
        );
        assert_eq!(
            joints.patches().len() % (2 * leaves),
            0,
            "{name}: two arcs a leaf"
        );
        assert!(joints.is_whole(), "{name}: an edge along a joint is open");
        assert_eq!(surface.topology().torn, [false, false], "{name}");
        assert!(!surface.topology().is_closed(), "{name} has open ends");
        assert_eq!(shown(&joints), distinct, "{name}");
    }
}

#[test]
fn ordinary_surfaces_have_no_joints() {
    for name in ["teardrop", "sphere", "torus", "sheet"] {
        assert!(
            builtin(name, None, None).unwrap().joints().is_none(),
            "{name}"
        );
    }
    // A crease does not part a surface.
    let creased = builtin("sheet", Some([6, 6]), None)
        .unwrap()
        .insert_knots(Direction::U, &[0.5; 3])
        .unwrap();
    assert!(creased.joints().is_none());
}

// Copies at equal positions are one; the tied points are those and nothing else.
#[test]
fn copies_of_a_branching_net_are_one_point() {
    let surface = vessel();
    let distinct = surface.distinct_points(&surface.topology());
    let places: BTreeSet<[u64; 3]> = surface
        .net()
        .points()
        .iter()
        .map(|p| p.coords.map(f64::to_bits).into())
        .collect();
    assert_eq!(distinct.count, places.len());
    assert!(distinct.count < surface.net().points().len());
}

// Two walls of a squeezed tube that meet in one control point, or in all but one of an edge, stay
// two.
#[test]
fn walls_that_touch_in_some_points_are_not_joined() {
    let sheet = builtin("sheet", Some([4, 4]), None).unwrap();
    let mut torn = sheet.insert_knots(Direction::U, &[0.5; 4]).unwrap();
    let columns = torn.net().columns();
    let whole = torn.distinct_points(&torn.topology()).count;
    assert_eq!(
        whole,
        torn.net().points().len() - columns,
        "an edge that is joined"
    );
    // The row right of the gap moves off, but for one point.
    let row = torn.net().rows() / 2;
    for j in 1..columns {
        torn.net_mut().points_mut()[row * columns + j].z += 0.01;
    }
    assert_eq!(
        torn.distinct_points(&torn.topology()).count,
        torn.net().points().len()
    );
    assert_eq!(torn.topology().torn, [true, false]);
}

#[test]
fn joints_have_no_gap_and_one_normal() {
    for (name, surface, ..) in branching() {
        let joints = surface.joints().unwrap();
        let (mut gap, mut angle) = (0.0_f64, 0.0_f64);
        let mut count = 0;
        for (a, b, against) in joints.seams() {
            for k in 0..=20 {
                let share = f64::from(k) / 20.0;
                let frames = [(a, share), (b, if against { 1.0 - share } else { share })].map(
                    |(edge, share)| {
                        let spot = joints.spot(edge, share);
                        let side = |d: usize, x: f64| {
                            let end = joints.strips_of(edge.patch)[d].range[1];
                            if x >= end { Side::Left } else { Side::Right }
                        };
                        surface.frame_from(spot.u, spot.v, side(0, spot.u), side(1, spot.v))
                    },
                );
                gap = gap.max((frames[0].point - frames[1].point).norm());
                let [m, n] = frames.map(|f| f.du.cross(&f.dv).normalize());
                angle = angle.max(libm::atan2(m.cross(&n).norm(), m.dot(&n)).to_degrees());
                count += 1;
            }
        }
        println!("{name}: {count} places on joints, gap {gap:e} m, angle {angle:e} degrees");
        assert!(gap <= 1e-9 * surface.size(), "{name}: gap {gap} m");
        // The nets have nine digits.
        assert!(angle < 1e-4, "{name}: {angle} degrees");
    }
}

/// Euler number and boundary loops of a mesh, corners at one place taken for one.
fn shape(mesh: &Mesh) -> (i64, usize) {
    let place = |k: u32| -> [u64; 3] {
        mesh.points[k as usize]
            .coords
            .map(|x| (x + 0.0).to_bits())
            .into()
    };
    let mut corners = BTreeSet::new();
    let mut edges: BTreeMap<([u64; 3], [u64; 3]), i32> = BTreeMap::new();
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(place)) {
        corners.extend([a, b, c]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let count = edges.entry((from.min(to), from.max(to))).or_default();
            // Each edge once each way: consistent and manifold.
            *count += if from < to { 1 } else { 16 };
        }
    }
    assert!(
        edges.values().all(|&count| [1, 16, 17].contains(&count)),
        "an edge between triangles that disagree"
    );
    let mut next: BTreeMap<[u64; 3], [u64; 3]> = BTreeMap::new();
    for ((low, high), count) in &edges {
        match count {
            1 => _ = next.insert(*low, *high),
            16 => _ = next.insert(*high, *low),
            _ => {}
        }
    }
    let mut loops = 0;
    while let Some((&start, _)) = next.iter().next() {
        loops += 1;
        let mut at = start;
        while let Some(to) = next.remove(&at) {
            at = to;
        }
    }
    (
        corners.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64,
        loops,
    )
}

#[test]
fn meshes_of_branching_surfaces_are_tubes_that_branch() {
    for (name, surface, _, leaves) in branching() {
        let meshes = [
            surface.tessellated([3, 2]).unwrap(),
            surface.tessellated_to(2e-3 * surface.size()).unwrap(),
        ];
        for mesh in meshes {
            let (euler, loops) = shape(&mesh);
            assert_eq!((euler, loops), (1 - leaves as i64, leaves + 1), "{name}");
        }
    }
}

// Against the triangles of the mesh, which holds each patch once, and against all that the net
// draws.
#[test]
fn area_counts_each_patch_once() {
    for (name, surface, ..) in branching() {
        let mesh = surface.tessellated([12, 12]).unwrap();
        let at = |k: u32| mesh.points[k as usize];
        let triangles: f64 = mesh
            .triangles
            .iter()
            .map(|&[a, b, c]| 0.5 * (at(b) - at(a)).cross(&(at(c) - at(a))).norm())
            .sum();
        let area = surface.area();
        println!("{name}: {area} m², triangles {triangles} m²");
        assert!(
            (triangles / area - 1.0).abs() < 2e-3,
            "{name}: {area} m², triangles {triangles} m²"
        );
    }
}

fn around(random: &mut Random, surface: &Surface) -> Point3 {
    let points = surface.net().points();
    let base = points[random.integer(0, points.len() - 1)];
    let far = 0.1 * surface.size();
    base + Vector3::new(
        random.float(-far, far),
        random.float(-far, far),
        random.float(-far, far),
    )
}

fn in_duplicate(joints: &Joints, u: f64, v: f64) -> bool {
    let inside = |x: f64, [a, b]: [f64; 2]| x > a && x < b;
    joints
        .patches()
        .iter()
        .any(|patch| patch.duplicate_of.is_some() && inside(u, patch.u) && inside(v, patch.v))
}

#[test]
fn closest_points_are_global_and_never_on_a_duplicate() {
    for (name, surface, ..) in branching() {
        let joints = surface.joints().unwrap();
        let mut solver = ClosestSolver::new(&surface);
        let mut random = Random(5);
        let samples: Vec<Point3> = surface.tessellated([6, 6]).unwrap().points;
        for _ in 0..60 {
            let query = around(&mut random, &surface);
            let foot = solver.closest(&surface, &query);
            let sampled = samples
                .iter()
                .map(|p| (p - query).norm())
                .fold(f64::INFINITY, f64::min);
            assert!(
                foot.distance <= sampled * (1.0 + 1e-12),
                "{name}: {} m, a sample is {sampled} m away",
                foot.distance
            );
            assert!(
                !in_duplicate(&joints, foot.u, foot.v),
                "{name}: the foot is on a duplicate"
            );
            let again = surface.point(foot.u, foot.v);
            assert!(
                (again - foot.point).norm() < 1e-9 * surface.size(),
                "{name}: the parameters say another place"
            );
        }
    }
}

// A ball that slides over every joint: one minimum, its normal without a jump.
#[test]
fn a_foot_slides_over_joints_without_a_jump() {
    for (name, surface, ..) in branching() {
        let joints = surface.joints().unwrap();
        let mut solver = ClosestSolver::new(&surface);
        let far = 2e-3 * surface.size();
        let mut crossed = 0;
        for (edge, _, _) in joints.seams() {
            for share in [0.31, 0.5, 0.77] {
                let spot = joints.spot(edge, share);
                let inward = if edge.side.is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                };
                let [wide_u, wide_v] = joints
                    .strips_of(edge.patch)
                    .map(|s| (s.range[1] - s.range[0]) / s.spans.len() as f64);
                let step = 0.1 * inward;
                let (u, v) = if edge.side < 2 {
                    (spot.u + step * wide_u, spot.v)
                } else {
                    (spot.u, spot.v + step * wide_v)
                };
                let start = surface.frame(u, v);
                // Over the edge, as far again beyond.
                let on_edge = solver.closest(
                    &surface,
                    &surface
                        .frame_from(spot.u, spot.v, side(edge, 0), side(edge, 1))
                        .point,
                );
                let way = (on_edge.point - start.point) * 2.0;
                let normal = surface.normal(u, v);
                let mut warm = WarmFoot::default();
                let mut last: Option<(Point3, Vector3)> = None;
                for k in 0..=40 {
                    let query = start.point + way * (f64::from(k) / 40.0) + normal * far;
                    let foot = solver.closest_warm(&surface, &query, way.norm() / 40.0, &mut warm);
                    let cold = solver.closest(&surface, &query);
                    assert!(
                        (foot.distance - cold.distance).abs() < 1e-11 * surface.size(),
                        "{name}: the warm foot is worse"
                    );
                    if let Some((point, normal)) = last {
                        let (moved, turned) =
                            ((foot.point - point).norm(), (foot.normal - normal).norm());
                        assert!(
                            moved < 0.2 * way.norm(),
                            "{name} at {edge:?}, {share}: the foot jumps by {moved} m"
                        );
                        assert!(
                            turned < 0.2,
                            "{name} at {edge:?}, {share}: the normal turns by {turned}"
                        );
                    }
                    last = Some((foot.point, foot.normal));
                }
                crossed += 1;
            }
        }
        println!("{name}: {crossed} ways over joints");
        assert!(crossed >= 25, "{name}");
    }
}

fn side(edge: Edge, d: usize) -> Side {
    if edge.side == 2 * d + 1 {
        Side::Left
    } else {
        Side::Right
    }
}

#[test]
fn knots_come_into_all_copies_alike() {
    for (name, surface, ..) in branching() {
        let before = surface.joints().unwrap();
        let (start, end) = (before.patches()[0].u, before.patches()[0].v);
        let u = start[0] + 0.3 * (start[1] - start[0]);
        let v = end[0] + 0.27 * (end[1] - end[0]);
        let finer = surface.insert_knots_alike([&[u], &[v]]).unwrap();
        let after = finer.joints().unwrap();
        assert!(finer.net().rows() > surface.net().rows() + 1, "{name}");
        let kinds = |joints: &Joints| {
            joints
                .patches()
                .iter()
                .map(|p| p.duplicate_of)
                .collect::<Vec<_>>()
        };
        assert_eq!(kinds(&before), kinds(&after), "{name}");
        assert!(after.is_whole(), "{name}");
        assert_eq!(before.seams().count(), after.seams().count(), "{name}");
        assert!(
            (finer.point(u, v) - surface.point(u, v)).norm() < 1e-12,
            "{name}"
        );
        // Asked for what was brought about, nothing more comes.
        let all: Vec<f64> = before.cuts(0, u).into_iter().map(|(_, x)| x).collect();
        let listed = surface.insert_knots_alike([&all, &[]]).unwrap();
        assert_eq!(listed.net().rows(), finer.net().rows(), "{name}");
        let [rows, columns] = [surface.net().rows() + 7, surface.net().columns() + 3];
        let refined = surface.refined_to(rows, columns).unwrap();
        assert!(
            refined.net().rows() >= rows && refined.net().columns() >= columns,
            "{name}"
        );
        assert_eq!(kinds(&before), kinds(&refined.joints().unwrap()), "{name}");
    }
}
