//! Random spines against slow twins.

use super::oracle::{compare, random_spine, sampled_pairs};
use super::{PipeLimits, Spine, body_to_body};
use crate::ipp::Status;
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::Curve;

#[test]
fn all_pairs_of_random_spines_are_found_and_no_others() {
    let (mut pairs, mut unseen) = (0, 0);
    for seed in 1..=240 {
        let curve = random_spine(seed);
        let body = body_to_body(&Spine::new(&curve).unwrap());
        assert_eq!(body.status, Status::Complete, "seed {seed}");
        let found: Vec<[f64; 2]> = body.pairs.iter().map(|pair| pair.parameters).collect();
        let comparison = compare(&curve, &found, 160);
        assert_eq!(
            (comparison.missed, comparison.wrong),
            (0, 0),
            "seed {seed}: {comparison:?} {found:?}"
        );
        assert!(comparison.error < 1e-10, "seed {seed}: {comparison:?}");
        pairs += comparison.pairs;
        unseen += comparison.unseen;
    }
    println!("{pairs} pairs, {unseen} not seen by sampling");
    // Sampling must see nearly all, or the test says little.
    assert!(
        pairs > 300 && 20 * unseen < pairs,
        "{pairs} pairs, {unseen} unseen"
    );
}

#[test]
fn the_twin_sees_the_pairs_that_an_answer_lacks_or_invents() {
    let (seed, found) = (1..200)
        .map(|seed| (seed, sampled_pairs(&random_spine(seed), 160)))
        .find(|(_, found)| found.len() >= 2)
        .expect("a spine with two pairs");
    let curve = random_spine(seed);
    assert_eq!(compare(&curve, &found[1..], 160).missed, 1);
    let mut invented = found.clone();
    invented.push([0.2, 0.9]);
    assert_eq!(compare(&curve, &invented, 160).wrong, 1);
}

/// |T'| / |c'| by differences of unit tangents.
fn curvature(curve: &Curve, t: f64) -> f64 {
    let (start, end) = curve.knots().domain();
    let h = 1e-5 * (end - start);
    let (low, high) = ((t - h).max(start), (t + h).min(end));
    let unit = |t: f64| curve.point_and_tangent(t).1.normalize();
    let turn: Vector3 = unit(high) - unit(low);
    turn.norm() / ((high - low) * curve.point_and_tangent(0.5 * (low + high)).1.norm())
}

#[test]
fn no_sample_of_a_random_spine_bends_more_than_the_largest_curvature() {
    for seed in 1..=120 {
        let curve = random_spine(seed);
        let limits = PipeLimits::of(&curve).unwrap();
        let kappa_max = 1.0 / limits.local.radius_m.unwrap();
        let (start, end) = curve.knots().domain();
        let most = (0..=2_000)
            .map(|k| curvature(&curve, start + (end - start) * f64::from(k) / 2_000.0))
            .fold(0.0, f64::max);
        assert!(
            most <= kappa_max * (1.0 + 1e-6),
            "seed {seed}: {most} is above {kappa_max}"
        );
        assert!(
            most >= kappa_max * 0.98,
            "seed {seed}: {kappa_max} is far above {most}"
        );
    }
}

/// Gap between the end circle of a radius and the pipe's body near a parameter: negative where they
/// overlap.
fn gap(curve: &Curve, end: usize, near: f64, radius: f64) -> f64 {
    let (start, stop) = curve.knots().domain();
    let here = [start, stop][end];
    let (centre, velocity) = curve.point_and_tangent(here);
    let tangent = velocity.normalize();
    let a = tangent
        .cross(&Vector3::ith(tangent.iamin(), 1.0))
        .normalize();
    let b = tangent.cross(&a);
    let window = 0.2 * (near - here).abs();
    let mut least = f64::INFINITY;
    for k in 0..=240 {
        let t = (near + window * (f64::from(k) / 120.0 - 1.0)).clamp(start, stop);
        let body = curve.point(t);
        // The nearest point of the circle is in the direction of the body's point.
        let d = body - centre;
        let (x, y) = (d.dot(&a), d.dot(&b));
        let size = (x * x + y * y).sqrt();
        let nearest = centre + (a * x + b * y) * (radius / size);
        least = least.min((nearest - body).norm() - radius);
    }
    least
}

/// Radius at which an end circle reaches the circle of the body at a parameter: |d|² / (2 |d⊥|).
fn reach(curve: &Curve, end: usize, t: f64) -> f64 {
    let (start, stop) = curve.knots().domain();
    let (centre, velocity) = curve.point_and_tangent([start, stop][end]);
    let (d, tangent) = (curve.point(t) - centre, velocity.normalize());
    d.norm_squared() / (2.0 * (d - tangent * d.dot(&tangent)).norm())
}

#[test]
fn end_circles_clear_the_body_below_the_touching_radius_and_cut_it_above() {
    let mut checked = 0;
    for seed in 1..=150 {
        let curve = random_spine(seed);
        let limits = PipeLimits::of(&curve).unwrap();
        let Some(touch) = limits.ends_to_body.touches.first() else {
            continue;
        };
        let (start, stop) = curve.knots().domain();
        // Away from the ends of the domain, where the window is cut.
        // Where R is largest the circle cuts the body on both sides of the touch already.
        let radius =
            |share: f64| reach(&curve, touch.end, touch.parameter + share * (stop - start));
        let least = radius(-0.02) > radius(0.0) && radius(0.02) > radius(0.0);
        let inside = (touch.parameter - start).min(stop - touch.parameter) > 0.05 * (stop - start);
        if !inside || !least {
            continue;
        }
        let at = |share: f64| gap(&curve, touch.end, touch.parameter, share * touch.radius_m);
        assert!(
            at(0.99) > 0.0 && at(1.01) < 0.0,
            "seed {seed}: {touch:?} gaps {} {}",
            at(0.99),
            at(1.01)
        );
        checked += 1;
    }
    assert!(checked > 20, "{checked}");
}
