//! Facts about surfaces that touch themselves, against mirror images.

use super::*;
use crate::basis::KnotVector;
use crate::math::{Random, Vector3};
use crate::surface::{ControlNet, builtin};

/// A sausage folded to a hairpin: legs along y at x = ±0.015 m of radius 0.01 m, with a belly in
/// the middle of each.
fn sausage(belly_m: f64) -> Surface {
    hairpin(belly_m, 9, 5, 12)
}

fn hairpin(belly_m: f64, legs: i32, bend: i32, around: i32) -> Surface {
    // Wide: its curvature is to stay below one over the depth, or the deepest places have more than
    // one foot.
    const BELLY: [f64; 9] = [0.0, 0.0, 0.2, 0.7, 1.0, 0.7, 0.2, 0.0, 0.0];
    let mut centres = vec![];
    let step = 0.08 / f64::from(legs - 1);
    for k in 0..legs {
        centres.push((
            Vector3::new(0.015, step * f64::from(k), 0.0),
            Vector3::x(),
            k,
        ));
    }
    for k in 1..=bend {
        let angle = std::f64::consts::PI * f64::from(k) / f64::from(bend + 1);
        let out = Vector3::new(libm::cos(angle), libm::sin(angle), 0.0);
        centres.push((Vector3::new(0.0, 0.08, 0.0) + out * 0.015, out, 0));
    }
    for k in (0..legs).rev() {
        centres.push((
            Vector3::new(-0.015, step * f64::from(k), 0.0),
            -Vector3::x(),
            k,
        ));
    }
    let last = centres.len() - 1;
    let columns = centres.len();
    let mut points = vec![];
    for i in 0..around {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(around);
        for (j, (centre, out, k)) in centres.iter().enumerate() {
            let radius =
                if j == 0 || j == last { 0.0 } else { 0.01 } + belly_m * BELLY[*k as usize];
            let way = out * libm::cos(angle) + Vector3::z() * libm::sin(angle);
            points.push(Point3::from(centre + way * radius));
        }
    }
    let u = KnotVector::periodic_uniform(3, around as usize).unwrap();
    let v = KnotVector::clamped_uniform(3, columns).unwrap();
    let net = ControlNet::new(around as usize, columns, points).unwrap();
    Surface::new(u, v, net, None).unwrap().oriented_outward()
}

fn own(surface: &Surface, margin_m: f64) -> ContactSet {
    folds(surface, margin_m, 0.2 * surface.size())
}

fn folds(surface: &Surface, margin_m: f64, deepest_fold_m: f64) -> ContactSet {
    let mut set = ContactSet::new();
    let mut solver = ClosestSolver::new(surface);
    let reach = Reach {
        margin_m,
        below: false,
        closing_m: 0.0,
    };
    SelfSolver::new(surface).contacts(surface, &mut solver, reach, deepest_fold_m, &mut set);
    set
}

// The legs are mirror images in x = 0, so the depth is twice what the inner side of one passes that
// plane by.
#[test]
fn a_folded_sausage_is_as_deep_in_itself_as_it_passes_its_mirror() {
    for belly in [0.009, 0.0075, 0.0062, 0.005, 0.003] {
        let surface = sausage(belly);
        assert!(surface.topology().is_closed() && surface.volume() > 0.0);
        let (mut least, mut at) = (f64::INFINITY, (0.0, 0.0));
        let mut wide = [0.5, 0.2];
        let mut middle = (0.5, 0.2);
        while wide[0] > 1e-9 {
            for i in -30..=30 {
                for j in -30..=30 {
                    let (u, v) = (
                        middle.0 + wide[0] * f64::from(i) / 30.0,
                        middle.1 + wide[1] * f64::from(j) / 30.0,
                    );
                    let (u, v) = (u.rem_euclid(1.0), v.clamp(0.05, 0.35));
                    let x = surface.point(u, v).x;
                    if x < least {
                        (least, at) = (x, (u, v));
                    }
                }
            }
            middle = at;
            wide = wide.map(|w| 0.5 * w);
        }
        let depth = -2.0 * least;
        let set = own(&surface, 0.01);
        let c = set
            .deepest()
            .unwrap_or_else(|| panic!("nothing at {belly}, depth {depth}"));
        assert!(
            (c.depth_m - depth).abs() < 1e-12,
            "belly {belly}: {} for {depth}",
            c.depth_m
        );
        assert!(
            (c.on_body - c.on_tool - c.normal * c.depth_m).norm() < 1e-13,
            "{c:?}"
        );
        assert_eq!(set.overlap(), depth > 0.0, "belly {belly}: {set:?}");
        assert!((c.normal.x.abs() - 1.0).abs() < 1e-9, "{c:?}");
    }
}

#[test]
fn an_unfolded_surface_of_any_thickness_does_not_touch_itself() {
    for thickness in [1.0, 0.1, 1e-3, 1e-5] {
        for name in ["sphere", "teardrop", "torus"] {
            let mut surface = builtin(name, None, None).unwrap();
            for p in surface.net_mut().points_mut() {
                p.x *= thickness;
            }
            let set = own(&surface, 0.0);
            assert!(
                set.contacts().is_empty() && !set.overlap(),
                "{name} {thickness}: {set:?}"
            );
        }
    }
}

// What is asked for is found as among all folds, and what is deeper is not.
#[test]
fn a_tick_that_asks_for_shallow_folds_finds_those() {
    for belly in [0.0075, 0.0062, 0.0056, 0.0053] {
        let surface = sausage(belly);
        let all = own(&surface, 1e-4);
        for deepest_m in [1e-3, 2e-3, TICK_FOLD * surface.size()] {
            let some = folds(&surface, 1e-4, deepest_m);
            let wanted: Vec<&Contact> = all
                .contacts()
                .iter()
                .filter(|c| c.depth_m <= deepest_m)
                .collect();
            assert_eq!(
                some.contacts().len(),
                wanted.len(),
                "belly {belly}, {deepest_m}: {all:?} and {some:?}"
            );
            for (a, b) in wanted.iter().zip(some.contacts()) {
                assert!(
                    (a.depth_m - b.depth_m).abs() < 1e-13,
                    "belly {belly}, {deepest_m}: {a:?} {b:?}"
                );
            }
        }
    }
}

// What is remembered of earlier nets saves work and changes no bit.
#[test]
fn a_surface_that_moves_is_answered_as_one_seen_for_the_first_time() {
    let start = sausage(0.0063);
    let size_m = start.size();
    let mut random = Random(5);
    let (mut solver, mut followed) = (ClosestSolver::new(&start), SelfSolver::new(&start));
    let (mut surface, mut set) = (start.clone(), ContactSet::new());
    let (mut met, mut far) = (0, 0);
    for tick in 0..300 {
        // Folds and unfolds, turns as a whole, shivers, and now and then jumps.
        let most = if tick % 50 == 49 { 1e-2 } else { 1e-5 } * size_m;
        let squeeze_m = 1e-3 * libm::sin(0.05 * f64::from(tick));
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 2e-3 * f64::from(tick));
        let points = surface.net_mut().points_mut().iter_mut();
        let jump = random.vector() * most;
        for (point, rest) in points.zip(start.net().points()) {
            let nearer_m = squeeze_m * libm::tanh(rest.x / 3e-3);
            let bent = Point3::new(rest.x - nearer_m, rest.y, rest.z);
            *point = turn * bent + jump;
            point.z += 1e-3 * size_m * libm::sin(90.0 * rest.y + f64::from(tick));
        }
        let reach = Reach {
            margin_m: random.float(1e-4, 1e-2) * size_m,
            ..Reach::TOUCH
        };
        solver.net_changed();
        let fold_m = TICK_FOLD * size_m;
        followed.contacts(&surface, &mut solver, reach, fold_m, &mut set);
        let mut fresh = ContactSet::new();
        let mut solver = ClosestSolver::new(&surface);
        SelfSolver::new(&surface).contacts(&surface, &mut solver, reach, fold_m, &mut fresh);
        assert_eq!(set, fresh, "tick {tick}");
        match set.contacts().is_empty() {
            true => far += 1,
            false => met += 1,
        }
    }
    assert!(
        met > 200 && far > 10,
        "{met} ticks in touch, {far} out of it"
    );
}

// Cones and directions leave nothing out: Newton from every pair of cells that come near finds no other fold.
#[test]
fn every_pair_of_cells_leads_to_no_more_than_those_that_may_face() {
    let mut random = Random(3);
    let mut count = 0;
    for round in 0..24 {
        let mut surface = match round % 3 {
            0 => builtin("torus", None, None).unwrap(),
            1 => hairpin(random.float(0.005, 0.008), 7, 4, 8),
            _ => sausage(random.float(0.006, 0.0085)),
        };
        let size_m = surface.size();
        let [columns, rough_m] = [
            surface.net().columns() as f64,
            random.float(0.0, 0.02) * size_m,
        ];
        for (k, point) in surface.net_mut().points_mut().iter_mut().enumerate() {
            // Poles stay whole.
            let column = k as f64 % columns;
            if round % 3 == 0 || (column > 1.0 && column < columns - 2.0) {
                *point += random.vector() * rough_m;
            }
            if round % 3 == 0 {
                point.z *= 0.3;
            }
        }
        let mut solver = ClosestSolver::new(&surface);
        let mut own = SelfSolver::new(&surface);
        let lengths_m = [0.01 * size_m, 0.05 * size_m, size_m];
        let reach = Reach {
            margin_m: lengths_m[0],
            ..Reach::TOUCH
        };
        let (mut some, mut all) = (ContactSet::new(), ContactSet::new());
        own.contacts(&surface, &mut solver, reach, lengths_m[1], &mut some);
        let half = Half {
            surface: &surface,
            pieces: solver.pieces_now(),
        };
        own.near.clear();
        own.walls.clear();
        for x in 0..own.cells.cell_count() {
            own.cells.look(half.surface, half.pieces, x);
            for y in 0..x {
                let near = own.cells.box_of(x).meets(own.cells.box_of(y), lengths_m[1]);
                if near && !own.adjacent(x, y) {
                    own.near.push((y as u32, x as u32));
                }
            }
        }
        own.search(half, lengths_m, &mut all);
        let missed = all.contacts().iter().filter(|c| {
            let near = |p: &Point3, q: &Point3| (p - q).norm() < 1e-6 * size_m;
            !some.contacts().iter().any(|d| {
                near(&c.on_body, &d.on_body) && near(&c.on_tool, &d.on_tool)
                    || near(&c.on_body, &d.on_tool) && near(&c.on_tool, &d.on_body)
            })
        });
        assert_eq!(missed.count(), 0, "round {round}: {some:?} of {all:?}");
        count += all.contacts().len();
    }
    assert!(count > 5, "{count}");
}

/// The solid angle of the surface in triangles (Van Oosterom & Strackee 1983), over 4π.
fn solid_angle(surface: &Surface, point: &Point3) -> f64 {
    let counts = [160, 320];
    let at = |d: usize, k: usize| {
        let knots = [surface.knots_u(), surface.knots_v()][d];
        let (low, high) = knots.domain();
        low + (high - low) * k as f64 / counts[d] as f64
    };
    let from = |i: usize, j: usize| surface.point(at(0, i), at(1, j)) - point;
    let mut sum = 0.0;
    for (i, j) in (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j))) {
        let [a, b, c, d] = [
            from(i, j),
            from(i + 1, j),
            from(i + 1, j + 1),
            from(i, j + 1),
        ];
        for [a, b, c] in [[a, b, c], [a, c, d]] {
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            sum += 2.0 * libm::atan2(a.dot(&b.cross(&c)), below);
        }
    }
    sum / (4.0 * std::f64::consts::PI)
}

#[test]
fn a_surface_winds_around_points_as_often_as_its_solid_angle_says() {
    let named = |name: &str| builtin(name, None, None).unwrap();
    let mut random = Random(11);
    let mut seen = [0; 3];
    for surface in [
        sausage(0.0075),
        sausage(0.009),
        named("torus"),
        named("sphere"),
        named("teardrop"),
    ] {
        let pieces = BezierPieces::new(&surface);
        let mut winding = Winding::new(&pieces);
        let (mut low, mut high) = (Point3::origin(), Point3::origin());
        for x in surface.net().points() {
            (low, high) = (low.inf(x), high.sup(x));
        }
        for k in 0..24 {
            // Around, and on planes of symmetry.
            let share = random.vector();
            let mut point =
                nalgebra::center(&low, &high) + 0.5 * share.component_mul(&(high - low));
            if k % 2 == 0 {
                (point.x, point.z) = (0.0, 0.0);
            }
            let exact = solid_angle(&surface, &point);
            if (exact - exact.round()).abs() > 0.02 {
                continue;
            }
            let along = random.vector().normalize();
            for along in [along, Vector3::x(), Vector3::y()] {
                let found = winding.around(&pieces, &point, &along);
                assert_eq!(found, Some(exact.round() as i32), "{point}, {exact}");
            }
            seen[exact.round().abs() as usize] += 1;
        }
    }
    assert!(seen.iter().all(|&n| n > 3), "{seen:?}");
}

// Distance to the surface at which the winding number still distinguishes a fold from a wall.
#[test]
fn a_point_just_below_a_surface_is_inside() {
    let surface = sausage(0.002);
    let pieces = BezierPieces::new(&surface);
    let mut winding = Winding::new(&pieces);
    let mut random = Random(7);
    for k in 0..200 {
        let (u, v) = match k % 3 {
            0 => (random.unit(), random.unit()),
            _ => (0.5, f64::from(k) / 200.0),
        };
        let frame = pieces.frame_at([u, v]);
        let normal = frame.du.cross(&frame.dv).normalize();
        let away = normal * (1e-9 * surface.size());
        let inwards = if surface.flip_normal() { away } else { -away };
        for (point, times) in [(frame.point + inwards, 1), (frame.point - inwards, 0)] {
            let found = winding.around(&pieces, &point, &normal);
            assert_eq!(found.map(i32::abs), Some(times), "({u}, {v})");
        }
    }
}
