//! Facts about all local minima, against a dense sampling that is polished in its own way, and
//! closed forms.

use super::super::{ClosestPoint, ClosestSolver, ControlNet, Summit, Surface};
use super::tests::{Random, cylinder, query, random_surface, size, sphere, teardrop};
use crate::basis::KnotVector;
use crate::math::{Point3, Vector3};

fn room() -> Vec<ClosestPoint> {
    Vec::with_capacity(64)
}

fn summits() -> Vec<Summit> {
    Vec::with_capacity(64)
}

/// A parameter that left the domain: round where that leads on, else held.
fn turn(x: f64, (a, b): (f64, f64), wraps: bool) -> f64 {
    if (a..=b).contains(&x) || !wraps {
        x.clamp(a, b)
    } else {
        a + (x - a).rem_euclid(b - a)
    }
}

/// Minima of `f` over samples of the domain, `cells` in each direction and span, sharpened by a
/// shrinking cross.
fn sampled_minima(
    surface: &Surface,
    cells: usize,
    f: &dyn Fn(&Point3) -> f64,
) -> Vec<(f64, f64, f64)> {
    let axis = |knots: &KnotVector| -> Vec<f64> {
        let mut out: Vec<f64> = vec![];
        for i in knots.spans() {
            let (a, b) = (knots.knots()[i], knots.knots()[i + 1]);
            out.extend((0..cells).map(|k| a + (b - a) * k as f64 / cells as f64));
        }
        out.push(knots.domain().1);
        out
    };
    let topology = surface.topology();
    let (us, vs) = (axis(surface.knots_u()), axis(surface.knots_v()));
    let value = |u: f64, v: f64| f(&surface.point(u, v));
    let grid: Vec<f64> = us
        .iter()
        .flat_map(|&u| vs.iter().map(move |&v| (u, v)))
        .map(|(u, v)| value(u, v))
        .collect();
    let ((u0, u1), (v0, v1)) = (surface.knots_u().domain(), surface.knots_v().domain());
    let mut out = vec![];
    for a in 0..us.len() {
        for b in 0..vs.len() {
            let here = grid[a * vs.len() + b];
            let lower = (a.saturating_sub(1)..(a + 2).min(us.len())).all(|x| {
                (b.saturating_sub(1)..(b + 2).min(vs.len())).all(|y| grid[x * vs.len() + y] >= here)
            });
            if !lower {
                continue;
            }
            let (mut u, mut v, mut best) = (us[a], vs[b], here);
            let mut step = 0.5 / cells as f64;
            let (du, dv) = (
                surface.knots_u().spans().count() as f64,
                surface.knots_v().spans().count() as f64,
            );
            let (du, dv) = ((u1 - u0) / du, (v1 - v0) / dv);
            for _ in 0..400 {
                let mut moved = false;
                for k in 0..16 {
                    let angle = std::f64::consts::PI * k as f64 / 8.0;
                    let x = turn(
                        u + step * du * libm::cos(angle),
                        (u0, u1),
                        topology.wraps(0),
                    );
                    let y = turn(
                        v + step * dv * libm::sin(angle),
                        (v0, v1),
                        topology.wraps(1),
                    );
                    let there = value(x, y);
                    if there < best {
                        (u, v, best, moved) = (x, y, there, true);
                    }
                }
                if !moved {
                    step *= 0.5;
                    if step < 1e-9 {
                        break;
                    }
                }
            }
            out.push((u, v, best));
        }
    }
    out
}

/// Whether f is larger all around a place, by `clear` at a distance of `h` domains; at a seam the
/// other side is looked at.
fn is_minimum(
    surface: &Surface,
    u: f64,
    v: f64,
    h: f64,
    clear: f64,
    f: &dyn Fn(&Point3) -> f64,
) -> bool {
    let here = f(&surface.point(u, v));
    let topology = surface.topology();
    let (du, dv) = (surface.knots_u().domain(), surface.knots_v().domain());
    // From a pole every meridian leads on.
    for (end, x) in [dv.0, dv.1].into_iter().enumerate() {
        if topology.poles[1][end] && (v - x).abs() < h {
            if v != x {
                // A cross of parameters around this place would reach past the pole: no judgement.
                return clear < 0.0;
            }
            return [2.0 * h, 0.05 * h, 1e-3 * h, 1e-5 * h, 1e-7 * h]
                .into_iter()
                .all(|h| {
                    let y = if end == 0 {
                        x + h * (dv.1 - dv.0)
                    } else {
                        x - h * (dv.1 - dv.0)
                    };
                    (0..64).all(|k| {
                        f(&surface.point(du.0 + (du.1 - du.0) * k as f64 / 64.0, y))
                            >= here + clear.min(0.0)
                    })
                });
        }
    }
    (0..64).all(|k| {
        let angle = std::f64::consts::PI * (k as f64 + 0.3) / 32.0;
        let x = turn(
            u + h * (du.1 - du.0) * libm::cos(angle),
            du,
            topology.wraps(0),
        );
        let y = turn(
            v + h * (dv.1 - dv.0) * libm::sin(angle),
            dv,
            topology.wraps(1),
        );
        // A place held at an edge is its own neighbour there.
        (surface.point(x, y) - surface.point(u, v)).norm() < 1e-12
            || f(&surface.point(x, y)) >= here + clear
    })
}

fn compare(
    surface: &Surface,
    name: &str,
    cells: usize,
    ceiling: f64,
    scale: f64,
    f: &dyn Fn(&Point3) -> f64,
    found: &[(f64, f64, f64)],
) -> usize {
    let near =
        |a: (f64, f64), b: (f64, f64)| (surface.point(a.0, a.1) - surface.point(b.0, b.1)).norm();
    for &(u, v, value) in found {
        assert!(value < ceiling, "{name}: {value} is not below {ceiling}");
        assert!(
            is_minimum(surface, u, v, 1e-8, -1e-11 * scale, f),
            "{name}: no minimum at {u} {v}"
        );
    }
    let mut counted = 0;
    for (u, v, value) in sampled_minima(surface, cells, f) {
        if value > ceiling - 1e-6 * scale || !is_minimum(surface, u, v, 1e-3, 1e-10 * scale, f) {
            continue;
        }
        counted += 1;
        // The same value within sight: values at a minimum agree to the square of what separates
        // the places.
        let same = found
            .iter()
            .any(|x| (x.2 - value).abs() <= 1e-9 * scale && near((x.0, x.1), (u, v)) < 0.02);
        assert!(
            same,
            "{name}: missed the minimum {value} at {u} {v}; found {found:?}"
        );
    }
    counted
}

fn check_point(surface: &Surface, q: &Point3, radius: f64, cells: usize, name: &str) -> usize {
    let mut solver = ClosestSolver::new(surface);
    let mut out = room();
    assert!(
        solver.minima_within(surface, q, radius, &mut out),
        "{name}: not all"
    );
    let found: Vec<_> = out.iter().map(|x| (x.u, x.v, x.distance)).collect();
    assert!(found.is_sorted_by(|a, b| a.2 <= b.2), "{name}");
    compare(
        surface,
        name,
        cells,
        radius,
        size(surface),
        &|p| (p - q).norm(),
        &found,
    )
}

/// A random surface in one piece: the sampling does not know the two sides of a tear.
fn whole_surface(random: &mut Random) -> Surface {
    loop {
        let surface = random_surface(random);
        if surface.topology().torn == [false; 2] {
            return surface;
        }
    }
}

const FEW: usize = if cfg!(debug_assertions) { 24 } else { 200 };

#[test]
fn every_sampled_minimum_of_the_distance_is_found_and_each_found_one_is_a_minimum() {
    let mut random = Random(91);
    let mut counted = 0;
    for count in [8, 12] {
        let surface = teardrop(count);
        let size = size(&surface);
        for k in 0..FEW {
            let q = query(&surface, &mut random, k);
            let nearest = ClosestSolver::new(&surface).closest(&surface, &q).distance;
            let radius = nearest + random.float(0.01, 0.6) * size;
            counted += check_point(
                &surface,
                &q,
                radius,
                6,
                &format!("teardrop {count}, query {k} {q:?}"),
            );
        }
    }
    for k in 0..FEW {
        let surface = whole_surface(&mut random);
        let q = query(&surface, &mut random, k);
        let radius = random.float(0.05, 0.8) * size(&surface);
        counted += check_point(
            &surface,
            &q,
            radius,
            24,
            &format!("random surface {k}, query {q:?}"),
        );
    }
    println!("{counted} sampled minima");
    assert!(counted > 2 * FEW, "only {counted} minima were compared");
}

#[test]
fn every_sampled_summit_is_found_and_each_found_one_is_a_summit() {
    let mut random = Random(92);
    let mut counted = 0;
    for k in 0..2 * FEW {
        let (surface, cells) = if k % 4 == 0 {
            (teardrop([8, 12, 20][k / 4 % 3]), 5)
        } else {
            (whole_surface(&mut random), 24)
        };
        let direction = random.vector().normalize();
        let size = size(&surface);
        let (_, _, top) = ClosestSolver::new(&surface).deepest_along(&surface, &direction);
        let height = direction.dot(&top.coords) - random.float(0.02, 0.7) * size;
        let mut out = summits();
        let all =
            ClosestSolver::new(&surface).summits_along(&surface, &direction, height, &mut out);
        let name = format!("surface {k} along {direction:?}");
        assert!(all, "{name}: not all");
        assert!(
            (direction.dot(&top.coords) - out[0].height_m).abs() <= 1e-11 * size,
            "{name}"
        );
        let found: Vec<_> = out.iter().map(|x| (x.u, x.v, -x.height_m)).collect();
        counted += compare(
            &surface,
            &name,
            cells,
            -height,
            size,
            &|p| -direction.dot(&p.coords),
            &found,
        );
    }
    println!("{counted} sampled summits");
    assert!(counted > 2 * FEW, "only {counted} summits were compared");
}

// Every point of a sphere is equally near to its centre: one connected set, one answer.
#[test]
fn the_centre_of_a_sphere_has_one_foot() {
    let surface = sphere(0.05);
    let mut out = room();
    assert!(ClosestSolver::new(&surface).minima_within(
        &surface,
        &Point3::origin(),
        0.06,
        &mut out
    ));
    assert_eq!(out.len(), 1, "{out:?}");
    assert!((out[0].distance - 0.05).abs() < 1e-16);
}

// From a point on the axis the nearest points make a circle; from beside it, one foot on the near
// side.
#[test]
fn the_axis_of_a_cylinder_has_one_foot_and_its_side_two_rims() {
    let surface = cylinder(0.02, 0.1);
    let mut solver = ClosestSolver::new(&surface);
    let mut out = room();
    assert!(solver.minima_within(&surface, &Point3::new(0.0, 0.0, 0.05), 0.03, &mut out));
    assert_eq!(out.len(), 1, "{out:?}");
    assert!(solver.minima_within(&surface, &Point3::new(0.01, 0.002, 0.05), 0.5, &mut out));
    assert_eq!(out.len(), 1, "{out:?}");
    // Along the axis, each rim is a set of equal heights.
    let mut tops = summits();
    assert!(solver.summits_along(&surface, &Vector3::z(), 0.0, &mut tops));
    assert_eq!((tops.len(), tops[0].height_m), (1, 0.1));
    // Across it, a line of equal heights.
    assert!(solver.summits_along(&surface, &Vector3::x(), 0.0, &mut tops));
    assert_eq!(tops.len(), 1, "{tops:?}");
    let tilted = Vector3::new(1.0, 0.7, 0.0).normalize();
    assert!(solver.summits_along(&surface, &tilted, 0.0, &mut tops));
    assert_eq!(tops.len(), 1, "{tops:?}");
    assert!((tops[0].height_m - 0.02).abs() < 1e-15);
}

// A sheet in a plane is as high everywhere; with two bumps pushed up by as much, two places are
// highest.
#[test]
fn equal_heights_that_touch_are_one_and_apart_are_two() {
    let knots = KnotVector::clamped_uniform(3, 12).unwrap();
    let flat = |lift: f64| {
        let points = (0..144).map(|k| {
            let (i, j) = (k / 12, k % 12);
            let up = if (i, j) == (3, 3) || (i, j) == (8, 8) {
                lift
            } else {
                0.0
            };
            Point3::new(i as f64, j as f64, up)
        });
        Surface::new(
            knots.clone(),
            knots.clone(),
            ControlNet::new(12, 12, points.collect()).unwrap(),
            None,
        )
        .unwrap()
    };
    let mut out = summits();
    let sheet = flat(0.0);
    assert!(ClosestSolver::new(&sheet).summits_along(&sheet, &Vector3::z(), -1.0, &mut out));
    assert_eq!(out.len(), 1);
    let bumps = flat(1.0);
    assert!(ClosestSolver::new(&bumps).summits_along(&bumps, &Vector3::z(), 0.1, &mut out));
    assert_eq!(out.len(), 2, "{out:?}");
    assert!((out[0].height_m - out[1].height_m).abs() < 1e-12);
    // Seen from below, the whole sheet is a rim of equal heights around the bumps, or the sheet
    // between them.
    assert!(ClosestSolver::new(&bumps).summits_along(&bumps, &-Vector3::z(), -0.5, &mut out));
    assert_eq!(out.len(), 1, "{out:?}");
}

/// Cubic, of 8 by 8 points, poles along z.
fn globe(radius: f64) -> Surface {
    let u = KnotVector::periodic_uniform(3, 8).unwrap();
    let v = KnotVector::clamped_uniform(3, 8).unwrap();
    let points = (0..64).map(|k| {
        let turn = std::f64::consts::TAU * (k / 8) as f64 / 8.0;
        let up = std::f64::consts::PI * (k % 8) as f64 / 7.0;
        let out = if k % 8 == 7 { 0.0 } else { up.sin() };
        Point3::new(out * turn.cos(), out * turn.sin(), -up.cos()) * radius
    });
    Surface::new(u, v, ControlNet::new(8, 8, points.collect()).unwrap(), None).unwrap()
}

// A tilt moves the highest place off the pole by less than a search in parameters resolves: it must
// be found all the same, at the height that the curvature there says.
#[test]
fn a_summit_next_to_a_pole_is_found_however_little_it_is_off() {
    let mut random = Random(41);
    let mut tops = summits();
    for ball in [globe(0.03), sphere(0.03)] {
        let mut solver = ClosestSolver::new(&ball);
        for k in 0..400 {
            let tilt = 10f64.powf(-16.0 + 14.0 * f64::from(k) / 400.0);
            let turn = random.float(0.0, std::f64::consts::TAU);
            let aside = Vector3::new(turn.cos(), turn.sin(), 0.0) * tilt;
            for up in [1.0, -1.0] {
                let direction = (Vector3::z() * up + aside).normalize();
                let all = solver.summits_along(&ball, &direction, 0.02, &mut tops);
                assert!(all && !tops.is_empty(), "tilted by {tilt}: {tops:?}");
                let above = tops[0].height_m - 0.03 * direction.z * up;
                // Radii of curvature at the poles are below twice the size; heights are good to 1e-12
                // of it.
                assert!(
                    above > -3e-14 && above < 0.03 * tilt * tilt + 3e-14,
                    "tilted by {tilt}: {above} m above the pole"
                );
            }
        }
    }
}
