//! Covers against samples; single tools against the certified queries; hard cases.

use super::cover::CellId;
use super::sphere::Lens;
use super::*;
use crate::testing::fifty_surfaces;
use palpate_geometry::basis::{KnotVector, Side};
use palpate_geometry::math::Random;
use palpate_geometry::surface::{ClosestSolver, ControlNet, builtin};

pub(super) fn shape(name: &str) -> Surface {
    builtin(name, None, None).unwrap()
}

fn near_surface(random: &mut Random, surface: &Surface, off_m: f64) -> Point3 {
    let (u, v) = (random.float(0.0, 1.0), random.float(0.05, 0.95));
    surface.point(u, v) + surface.normal(u, v) * random.float(-off_m, off_m)
}

/// What the triangles of the finest cells may miss of the surface: the sag, and a quarter of each
/// cell's twist.
pub(super) fn missed_m(spheres: &mut Spheres) -> f64 {
    let cover = &mut spheres.cover;
    let level = cover.levels() - 1;
    let mut most: f64 = 0.0;
    for i in 0..cover.u.finest() as u16 {
        for j in 0..cover.v.finest() as u16 {
            let id = CellId {
                level: level as u8,
                i,
                j,
            };
            let [a, b, c, d] = cover.corners(id);
            most = most.max(cover.sag(id) + 0.25 * ((a - b) + (c - d)).norm());
        }
    }
    most
}

#[test]
fn spheres_of_all_levels_hold_the_surface_of_their_cells() {
    let builtins = ["teardrop", "sphere", "torus", "sheet"].map(shape);
    let mut tried = 0;
    for surface in builtins.into_iter().chain(fifty_surfaces(11)) {
        let mut cover = Cover::new(&surface, [14, 29]);
        let mut random = Random(3);
        for level in 0..cover.levels() {
            for i in 0..cover.u.level(level).len() as u16 {
                for j in 0..cover.v.level(level).len() as u16 {
                    let id = CellId {
                        level: level as u8,
                        i,
                        j,
                    };
                    let Lens {
                        sphere,
                        normal,
                        half_m,
                    } = *cover.lens(id);
                    let [[u0, v0], _, [u1, v1], _] = cover.parameters(id);
                    for _ in 0..3 {
                        let (u, v) = (random.float(u0, u1), random.float(v0, v1));
                        let point = surface.frame_from(u, v, Side::Right, Side::Right).point;
                        let away = (point - sphere.centre).norm();
                        assert!(
                            away <= sphere.radius_m,
                            "({u}, {v}) is {away} from {sphere:?} in {surface:?}"
                        );
                        let off = (point - sphere.centre).dot(&normal).abs();
                        assert!(
                            off <= half_m,
                            "({u}, {v}) is {off} off a slab of {half_m} in {surface:?}"
                        );
                        tried += 1;
                    }
                }
            }
        }
    }
    assert!(tried > 50_000, "{tried}");
}

#[test]
fn balls_and_points_agree_with_the_certified_closest_point_and_errors_fall_with_the_square() {
    let surface = shape("teardrop");
    let mut solver = ClosestSolver::new(&surface);
    let mut worst = Vec::new();
    for rows in [28, 82, 244] {
        let mut spheres = Spheres::new(&surface, [rows; 2]);
        let (mut random, mut set, mut error) = (Random(1), ContactSet::new(), 0.0_f64);
        let missed = missed_m(&mut spheres);
        for k in 0..400 {
            let q = near_surface(&mut random, &surface, 0.01);
            let radius = [0.0, 0.012, 0.03][k % 3];
            let exact = radius - solver.closest(&surface, &q).signed_distance;
            spheres.ball(&q, radius, &Reach::TOUCH, &mut set);
            let depth = set.deepest().map(|c| c.depth_m);
            if exact.abs() > missed {
                assert_eq!(
                    depth.is_some(),
                    exact > 0.0,
                    "{rows}: {q} {radius}: {exact}"
                );
            }
            for c in set.contacts() {
                let rest = c.on_body - c.on_tool - c.normal * c.depth_m;
                assert!(
                    rest.norm() < 1e-15 && (c.normal.norm() - 1.0).abs() < 1e-12,
                    "{c:?}"
                );
                assert!(
                    (surface.point(c.u, c.v) - c.on_body).norm() <= missed,
                    "{c:?}"
                );
            }
            error = depth.map_or(error, |depth| error.max((depth - exact).abs()));
        }
        assert!(
            error <= missed,
            "{rows}: {error} m, but no more than {missed} m is missed"
        );
        worst.push(error);
    }
    for pair in worst.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!(
            (6.0..13.0).contains(&ratio),
            "{worst:?}: three times the rows leave a ninth of the error"
        );
    }
}

#[test]
fn planes_agree_with_the_certified_deepest_point_and_errors_fall_with_the_square() {
    let surface = shape("teardrop");
    let mut solver = ClosestSolver::new(&surface);
    let mut worst = Vec::new();
    for rows in [28, 82, 244] {
        let mut spheres = Spheres::new(&surface, [rows; 2]);
        let (mut random, mut set, mut error) = (Random(2), ContactSet::new(), 0.0_f64);
        for _ in 0..200 {
            let mut x = || random.float(-1.0, 1.0);
            let normal = Vector3::new(x(), x(), x()).normalize();
            let (_, _, deepest) = solver.deepest_along(&surface, &-normal);
            let depth = random.float(0.001, 0.03);
            let origin = deepest + normal * depth;
            spheres.plane(&origin, &normal, &Reach::TOUCH, &mut set);
            let found = set.deepest().expect("a plane a millimetre deep").depth_m;
            assert!(
                found <= depth + 1e-12,
                "corners are points of the surface: {found} of {depth}"
            );
            error = error.max(depth - found);
            spheres.plane(&(deepest - normal * 1e-9), &normal, &Reach::TOUCH, &mut set);
            assert!(set.contacts().is_empty() && !set.overlap());
        }
        worst.push(error);
    }
    for pair in worst.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!(
            (5.0..16.0).contains(&ratio),
            "{worst:?}: three times the rows leave a ninth of the error"
        );
    }
}

/// An upright cylinder, by its exact distance.
struct Cylinder {
    radius_m: f64,
    half_m: f64,
    bounded: bool,
}

impl Solid for Cylinder {
    fn signed_gap(&self, p: &Point3) -> (f64, Vector3) {
        let rho = p.x.hypot(p.y);
        let (out, up) = (rho - self.radius_m, p.z.abs() - self.half_m);
        let radial = if rho > 0.0 {
            Vector3::new(p.x / rho, p.y / rho, 0.0)
        } else {
            Vector3::x()
        };
        let axial = Vector3::z() * p.z.signum();
        if out <= 0.0 && up <= 0.0 {
            if out > up { (out, radial) } else { (up, axial) }
        } else {
            let away = radial * out.max(0.0) + axial * up.max(0.0);
            (away.norm(), away.normalize())
        }
    }
    fn bounded_gap(&self, p: &Point3) -> Option<f64> {
        self.bounded.then(|| self.signed_gap(p).0)
    }
    fn inner_point(&self) -> Option<Point3> {
        Some(Point3::origin())
    }
}

#[test]
fn a_solid_meets_the_same_points_with_and_without_a_bound_and_brute_force_finds_none_deeper() {
    let sheet = {
        let mut sheet = builtin("sheet", Some([12, 12]), Some(0.1)).unwrap();
        for p in sheet.net_mut().points_mut() {
            p.z = 0.01 * libm::sin(90.0 * p.x) * libm::cos(70.0 * p.y) - 0.012;
        }
        sheet
    };
    let mut spheres = Spheres::new(&sheet, [82; 2]);
    let (mut with, mut without) = (ContactSet::new(), ContactSet::new());
    let cylinder = |bounded| Cylinder {
        radius_m: 0.03,
        half_m: 0.008,
        bounded,
    };
    spheres.solid(&cylinder(true), &Reach::TOUCH, &mut with);
    let few = spheres.counters().points();
    spheres.load(&sheet);
    spheres.solid(&cylinder(false), &Reach::TOUCH, &mut without);
    assert_eq!(with, without);
    assert!(
        few < 4_000 && spheres.counters().points() == 82 * 82,
        "{few}"
    );
    assert!(!with.contacts().is_empty(), "{with:?}");
    let mut deepest: f64 = 0.0;
    for k in 0..1_000_000 {
        let (u, v) = (f64::from(k % 1000) / 999.0, f64::from(k / 1000) / 999.0);
        deepest = deepest.max(-cylinder(true).signed_gap(&sheet.point(u, v)).0);
    }
    let found = with.deepest().unwrap().depth_m;
    // The gap's slope along the surface is up to one at the rim, so corners may miss half a cell's
    // diagonal there.
    assert!(
        found <= deepest + 1e-6 && found >= deepest - 0.5 * 0.1 * 1.5 / 81.0,
        "{found} of {deepest}"
    );
}

#[test]
fn a_tool_wholly_inside_is_found() {
    let surface = shape("teardrop");
    let mut spheres = Spheres::new(&surface, [28; 2]);
    let centre = surface.centroid().unwrap();
    let mut set = ContactSet::new();
    spheres.ball(&centre, 1e-3, &Reach::TOUCH, &mut set);
    let exact = 1e-3
        - ClosestSolver::new(&surface)
            .closest(&surface, &centre)
            .signed_distance;
    assert!(set.overlap() && set.contacts().len() == 1);
    assert!(
        (set.deepest().unwrap().depth_m - exact).abs() < missed_m(&mut spheres),
        "{set:?} {exact}"
    );
    let moved = surface.transformed(&Pose::translation(-centre.x, -centre.y, -centre.z));
    let mut spheres = Spheres::new(&moved, [28; 2]);
    spheres.solid(
        &Cylinder {
            radius_m: 1e-3,
            half_m: 1e-3,
            bounded: true,
        },
        &Reach::TOUCH,
        &mut set,
    );
    assert!(set.overlap() && set.contacts().is_empty());
    // And larger than the body, all around it.
    spheres.ball(&Point3::origin(), 1.0, &Reach::TOUCH, &mut set);
    assert!(set.deepest().unwrap().depth_m > 1.0);
    spheres.solid(
        &Cylinder {
            radius_m: 1.0,
            half_m: 1.0,
            bounded: true,
        },
        &Reach::TOUCH,
        &mut set,
    );
    assert!(set.overlap() && !set.contacts().is_empty());
}

#[test]
fn a_plane_on_a_flat_patch_stops_early_and_is_one_contact_of_depth_zero() {
    let sheet = shape("sheet");
    let mut spheres = Spheres::new(&sheet, [82; 2]);
    let mut set = ContactSet::new();
    spheres.plane(&Point3::origin(), &Vector3::z(), &Reach::TOUCH, &mut set);
    assert_eq!(spheres.counters().early_stop, Some(0));
    assert!(
        spheres.counters().points() <= 100,
        "{:?}",
        spheres.counters()
    );
    assert_eq!((set.contacts().len(), set.rectangles().len()), (1, 1));
    assert!(set.overlap() && set.deepest().unwrap().depth_m.abs() < 1e-15);
    assert_eq!(
        set.rectangles()[0],
        Rectangle {
            u: [0.0, 1.0],
            v: [0.0, 1.0]
        }
    );
}

#[test]
fn a_bump_in_a_flat_patch_is_no_reason_to_stop() {
    // One control point of a fine net: no corner of the coarse cells moves or turns there.
    let mut sheet = builtin("sheet", Some([82, 82]), Some(0.1)).unwrap();
    sheet.net_mut().points_mut()[41 * 82 + 41].z = -0.004;
    let mut spheres = Spheres::new(&sheet, [82; 2]);
    let mut set = ContactSet::new();
    // Above all of the sheet but for nothing: everything meets.
    spheres.plane(
        &Point3::new(0.0, 0.0, 1e-3),
        &Vector3::z(),
        &Reach::TOUCH,
        &mut set,
    );
    let deepest = ClosestSolver::new(&sheet)
        .deepest_along(&sheet, &-Vector3::z())
        .2
        .z;
    let found = set.deepest().unwrap().depth_m;
    assert!(
        found > 0.9 * (1e-3 - deepest),
        "{found} of {}",
        1e-3 - deepest
    );
}

#[test]
fn a_small_contact_visits_a_small_share_of_the_points() {
    let surface = shape("teardrop");
    let (point, normal) = (surface.point(0.3, 0.5), surface.normal(0.3, 0.5));
    let mut spheres = Spheres::new(&surface, [82; 2]);
    let mut set = ContactSet::new();
    spheres.ball(&(point + normal * 2.9e-3), 3e-3, &Reach::TOUCH, &mut set);
    assert_eq!(set.contacts().len(), 1);
    let counters = spheres.counters();
    assert!(counters.points() < 82 * 82 / 10, "{counters:?}");
    assert_eq!(
        counters.triangle_tests, 0,
        "a ball needs no triangle–triangle test"
    );
    // Far away nothing at all is computed, at the second time by the witness alone.
    spheres.load(&surface);
    for _ in 0..2 {
        spheres.ball(&(point + normal), 3e-3, &Reach::TOUCH, &mut set);
        assert!(spheres.counters().hulls_apart && spheres.counters().points() == 0);
    }
}

#[test]
fn a_ball_at_a_pole_is_one_contact() {
    let surface = shape("teardrop");
    for (v, rows) in [(0.0, 28), (1.0, 82)] {
        let (pole, normal) = (surface.point(0.2, v), surface.normal(0.2, v));
        let mut spheres = Spheres::new(&surface, [rows; 2]);
        let mut set = ContactSet::new();
        spheres.ball(&(pole + normal * 4e-3), 5e-3, &Reach::TOUCH, &mut set);
        assert_eq!(set.contacts().len(), 1, "{set:?}");
        assert!(
            (set.deepest().unwrap().depth_m - 1e-3).abs() <= missed_m(&mut spheres),
            "{set:?}"
        );
        spheres.plane(&(pole - normal * 1e-3), &-normal, &Reach::TOUCH, &mut set);
        assert_eq!(set.contacts().len(), 1, "{set:?}");
    }
}

#[test]
fn a_contact_on_a_seam_is_one_contact_and_one_rectangle() {
    let torus = shape("torus");
    let mut spheres = Spheres::new(&torus, [82; 2]);
    let (point, normal) = (torus.point(0.0, 0.3), torus.normal(0.0, 0.3));
    let mut set = ContactSet::new();
    spheres.ball(&(point + normal * 4e-3), 5e-3, &Reach::TOUCH, &mut set);
    assert_eq!(
        (set.contacts().len(), set.rectangles().len()),
        (1, 1),
        "{set:?}"
    );
    let Rectangle { u, v } = set.rectangles()[0];
    assert!(
        u[0] > 0.5 && u[0] < 1.0 && u[1] > 1.0 && u[1] < 1.5,
        "{u:?} goes on behind the seam"
    );
    assert!(v[0] < 0.3 && v[1] > 0.3 && v[1] - v[0] < 0.5, "{v:?}");
    // The teardrop's seam is not periodic, but closed all the same.
    let drop = shape("teardrop");
    let mut spheres = Spheres::new(&drop, [82; 2]);
    let (point, normal) = (drop.point(0.0, 0.5), drop.normal(0.0, 0.5));
    spheres.ball(&(point + normal * 4e-3), 5e-3, &Reach::TOUCH, &mut set);
    assert_eq!(
        (set.contacts().len(), set.rectangles().len()),
        (1, 1),
        "{set:?}"
    );
}

#[test]
fn two_walls_of_a_valley_are_two_contacts() {
    let mut sheet = builtin("sheet", Some([20, 4]), Some(0.1)).unwrap();
    for p in sheet.net_mut().points_mut() {
        p.z = 0.02 * (1.0 - libm::cos(60.0 * p.x));
    }
    let mut spheres = Spheres::new(&sheet, [244, 28]);
    let mut set = ContactSet::new();
    spheres.ball(
        &Point3::new(0.0, 0.0, 0.0235),
        0.023,
        &Reach::TOUCH,
        &mut set,
    );
    assert_eq!(set.contacts().len(), 2, "{set:?}");
    let [a, b] = set.contacts() else {
        unreachable!()
    };
    assert!(
        (a.depth_m - b.depth_m).abs() < 1e-6 && (a.on_body.x + b.on_body.x).abs() < 1e-3,
        "{set:?}"
    );
}

// Depth divided by size must not depend on the size.
#[test]
fn bodies_of_a_micrometre_and_of_a_kilometre_are_alike() {
    let answer = |scale: f64| {
        let drop = shape("teardrop").scaled(scale);
        let mut spheres = Spheres::new(&drop, [82; 2]);
        let mut set = ContactSet::new();
        let at = drop.point(0.3, 0.5) + drop.normal(0.3, 0.5) * (4e-3 * scale);
        spheres.ball(&at, 5e-3 * scale, &Reach::TOUCH, &mut set);
        let ball = set.deepest().unwrap().depth_m / scale;
        spheres.plane(
            &drop.point(0.3, 0.5),
            &Vector3::new(0.3, 0.4, 0.5),
            &Reach::TOUCH,
            &mut set,
        );
        (
            ball,
            set.deepest().unwrap().depth_m / scale,
            set.contacts().len(),
        )
    };
    let (ball, plane, contacts) = answer(1.0);
    for scale in [1e-5, 1e4] {
        let other = answer(scale);
        assert!(
            (other.0 - ball).abs() < 1e-13 && (other.1 - plane).abs() < 1e-13,
            "{scale}: {other:?}"
        );
        assert_eq!(other.2, contacts, "{scale}");
    }
}

#[test]
fn what_is_not_finite_or_has_no_extent_gives_no_contact_and_no_panic() {
    let drop = shape("teardrop");
    let mut spheres = Spheres::new(&drop, [28; 2]);
    let mut set = ContactSet::new();
    for x in [f64::NAN, f64::INFINITY] {
        spheres.ball(&Point3::new(x, 0.0, 0.0), 0.1, &Reach::TOUCH, &mut set);
        assert!(set.contacts().is_empty());
        spheres.ball(&Point3::origin(), x, &Reach::TOUCH, &mut set);
        assert!(set.contacts().is_empty());
        spheres.plane(
            &Point3::new(x, 0.0, 0.0),
            &Vector3::z(),
            &Reach::TOUCH,
            &mut set,
        );
        assert!(set.contacts().is_empty());
        spheres.plane(
            &Point3::origin(),
            &Vector3::new(x, 0.0, 0.0),
            &Reach::TOUCH,
            &mut set,
        );
        assert!(set.contacts().is_empty());
    }
    spheres.plane(
        &Point3::origin(),
        &Vector3::zeros(),
        &Reach::TOUCH,
        &mut set,
    );
    assert!(set.contacts().is_empty());
    // All control points in one place.
    let knots = || KnotVector::clamped_uniform(3, 5).unwrap();
    let net = ControlNet::new(5, 5, vec![Point3::new(0.1, 0.2, 0.3); 25]).unwrap();
    let dot = Surface::new(knots(), knots(), net, None).unwrap();
    let mut spheres = Spheres::new(&dot, [28; 2]);
    spheres.ball(&Point3::new(0.1, 0.2, 0.29), 0.02, &Reach::TOUCH, &mut set);
    assert!(
        (set.deepest().unwrap().depth_m - 0.01).abs() < 1e-15,
        "{set:?}"
    );
    spheres.plane(&Point3::origin(), &Vector3::z(), &Reach::TOUCH, &mut set);
    assert!(set.contacts().is_empty());
}

#[test]
fn a_sheet_is_touched_from_the_side_the_tool_came_from() {
    let sheet = shape("sheet");
    let mut spheres = Spheres::new(&sheet, [28; 2]);
    let mut set = ContactSet::new();
    let ask = |z: f64, below: bool, set: &mut ContactSet, spheres: &mut Spheres| {
        let reach = Reach {
            margin_m: 0.0,
            below,
            closing_m: 0.0,
        };
        spheres.ball(&Point3::new(0.01, 0.02, z), 0.01, &reach, set);
        set.deepest().map(|c| (c.depth_m, c.normal.z))
    };
    let close = |got: Option<(f64, f64)>, depth: f64, z: f64| {
        let (d, n) = got.expect("a contact");
        assert!(
            (d - depth).abs() < 1e-12 && (n - z).abs() < 1e-12,
            "{d} {n}"
        );
    };
    close(ask(0.004, false, &mut set, &mut spheres), 0.006, 1.0);
    close(ask(-0.004, false, &mut set, &mut spheres), 0.014, 1.0);
    close(ask(-0.004, true, &mut set, &mut spheres), 0.006, -1.0);
    close(ask(-0.03, false, &mut set, &mut spheres), 0.04, 1.0);
    assert!(ask(0.03, false, &mut set, &mut spheres).is_none());
    // Beside the sheet and a little below its plane is not behind it.
    spheres.ball(
        &Point3::new(0.2, 0.0, -0.001),
        0.01,
        &Reach::TOUCH,
        &mut set,
    );
    assert!(set.contacts().is_empty(), "{set:?}");
}

#[test]
fn the_same_question_has_the_same_answer_whatever_was_asked_before() {
    let surface = shape("teardrop");
    let mut random = Random(8);
    let mut used = Spheres::new(&surface, [82; 2]);
    let (mut first, mut second) = (ContactSet::new(), ContactSet::new());
    for k in 0..60 {
        let q = near_surface(&mut random, &surface, 0.02);
        used.ball(&q, 0.01, &Reach::TOUCH, &mut first);
        let mut fresh = Spheres::new(&surface, [82; 2]);
        fresh.ball(&q, 0.01, &Reach::TOUCH, &mut second);
        assert_eq!(first, second, "ball {k}");
    }
}
