//! Facts about surfaces that touch themselves, against mirror images.

use super::*;
use crate::basis::KnotVector;
use crate::math::Vector3;
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
