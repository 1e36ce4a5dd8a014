use super::super::cases::cases;
use super::super::{PipeLimits, Spine};
use super::*;
use palpate_geometry::surface::{Closing, Curve};

fn curve(name: &str) -> Curve {
    cases()
        .into_iter()
        .find(|case| case.name == name)
        .expect("a case of the data")
        .curve()
}

/// Distance from a point to the spine by dense samples and a golden section: knows nothing of
/// pieces and frames.
fn distance(curve: &Curve, samples: &[(f64, Point3)], point: &Point3) -> f64 {
    let squares = samples.iter().map(|(_, p)| (p - point).norm_squared());
    let (k, _) = squares
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap();
    let (mut low, mut high) = (
        samples[k.max(1) - 1].0,
        samples[(k + 1).min(samples.len() - 1)].0,
    );
    for _ in 0..60 {
        let (a, b) = (
            low + 0.381_966 * (high - low),
            low + 0.618_034 * (high - low),
        );
        if (curve.point(a) - point).norm_squared() < (curve.point(b) - point).norm_squared() {
            high = b
        } else {
            low = a
        }
    }
    (curve.point(0.5 * (low + high)) - point).norm()
}

#[test]
fn every_point_is_a_radius_from_the_spine_and_normals_point_away() {
    for name in [
        "example-11.6.2",
        "hook",
        "helix",
        "trefoil",
        "arc",
        "near-crossing",
    ] {
        let curve = curve(name);
        let spine = Spine::new(&curve).unwrap();
        let radius_m = 0.9 * PipeLimits::of_spine(&spine).r_max_m().unwrap().0;
        let pipe = pipe_surface(&spine, radius_m, 1e-6 * radius_m).unwrap();
        assert!(pipe.deviation_m <= 1e-6 * radius_m);
        let ((u0, u1), surface) = (pipe.surface.knots_u().domain(), &pipe.surface);
        assert_eq!((u0, u1), curve.knots().domain());
        let samples: Vec<_> = (0..=2_000)
            .map(|k| u0 + (u1 - u0) * f64::from(k) / 2_000.0)
            .map(|t| (t, curve.point(t)))
            .collect();
        let mut worst = 0.0_f64;
        for i in 0..=60 {
            let u = u0 + (u1 - u0) * f64::from(i) / 60.0;
            for j in 0..13 {
                let v = f64::from(j) / 13.0;
                let point = surface.point(u, v);
                worst = worst.max((distance(&curve, &samples, &point) - radius_m).abs());
                let away = (point - curve.point(u)).normalize();
                assert!(
                    surface.normal(u, v).dot(&away) > 0.999,
                    "{name}: the normal at ({u}, {v}) leans"
                );
            }
        }
        assert!(
            worst <= 1.2e-6 * radius_m,
            "{name}: {} of the radius off",
            worst / radius_m
        );
    }
}

#[test]
fn a_closed_spine_gives_a_closed_tube() {
    let spine = Spine::new(&curve("trefoil")).unwrap();
    let pipe = pipe_surface(&spine, 0.2, 1e-4).unwrap();
    let topology = pipe.surface.topology();
    assert_eq!(topology.closing, [Closing::Periodic; 2]);
    // Pappus: the volume of a tube is the area of its section times the length of its spine.
    let curve = curve("trefoil");
    let (start, end) = curve.knots().domain();
    let count = 20_000;
    let at = |k: i32| curve.point(start + (end - start) * f64::from(k) / f64::from(count));
    let length: f64 = (0..count).map(|k| (at(k + 1) - at(k)).norm()).sum();
    let wanted = std::f64::consts::PI * 0.2 * 0.2 * length;
    let volume = pipe.surface.volume();
    assert!(
        (volume / wanted - 1.0).abs() < 1e-3,
        "{volume} is not {wanted}"
    );
    let open = pipe_surface(&Spine::new(&self::curve("helix")).unwrap(), 0.2, 1e-4).unwrap();
    assert_eq!(
        open.surface.topology().closing,
        [Closing::Open, Closing::Periodic]
    );
}

#[test]
fn a_finer_tolerance_takes_more_stretches_and_is_kept() {
    let spine = Spine::new(&curve("hook")).unwrap();
    let mut last = 0;
    for tolerance_m in [1e-3, 1e-5, 1e-7, 1e-9] {
        let pipe = pipe_surface(&spine, 0.1, tolerance_m).unwrap();
        assert!(pipe.deviation_m <= tolerance_m && pipe.stretches > last);
        last = pipe.stretches;
    }
}

#[test]
fn curvature_that_jumps_is_swept_with_triple_knots() {
    // A straight line, then a quarter circle: the tangent is continuous, the curvature is not.
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let knots = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 3.0, 3.0, 3.0]).unwrap();
    let points = [[-1.0, 0.0], [-0.5, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
        .map(|[x, y]| Point3::new(x, y, 0.0));
    let curve = Curve::new(knots, points.to_vec(), Some(vec![1.0, 1.0, 1.0, h, 1.0])).unwrap();
    let spine = Spine::new(&curve).unwrap();
    assert!(spine.corners().is_empty());
    let pipe = pipe_surface(&spine, 0.25, 1e-7).unwrap();
    assert_eq!(pipe.surface.knots_u().multiplicity(1.0), 3);
    for k in 0..40 {
        let (u, v) = (f64::from(k) * 0.075, 0.03);
        let off = (pipe.surface.point(u, v) - curve.point(u)).norm() - 0.25;
        assert!(off.abs() < 1e-5, "{u}: {off}");
    }
}

#[test]
fn bad_lengths_corners_and_impossible_tolerances_are_refused() {
    let spine = Spine::new(&curve("hook")).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            pipe_surface(&spine, bad, 1e-6),
            Err(SweepError::Length {
                what: "the radius",
                ..
            })
        ));
        assert!(matches!(
            pipe_surface(&spine, 0.1, bad),
            Err(SweepError::Length {
                what: "the tolerance",
                ..
            })
        ));
    }
    assert!(matches!(
        pipe_surface(&spine, 0.1, 1e-18),
        Err(SweepError::Tolerance { .. })
    ));
    let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, 2.0, 2.0]).unwrap();
    let points = vec![
        Point3::origin(),
        Point3::new(1.0, 0.0, 0.0),
        Point3::new(1.0, 1.0, 0.0),
    ];
    let bent = Spine::new(&Curve::new(knots, points, None).unwrap()).unwrap();
    let refused = pipe_surface(&bent, 0.1, 1e-6).unwrap_err();
    assert!(
        matches!(refused, SweepError::Corner { parameter: 1.0, turn_deg } if (turn_deg - 90.0).abs() < 1e-12)
    );
}
