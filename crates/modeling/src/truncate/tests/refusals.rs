//! What is refused, and what there is nothing to do for.

use super::*;
use crate::truncate::TruncateError;

fn refused(a: &Surface, b: &Surface) -> TruncateError {
    truncate(a, b, &TruncateSpec::default()).unwrap_err()
}

#[test]
fn a_body_in_another_is_refused() {
    let (outer, inner) = (sphere(0.05, [0.0; 3]), sphere(0.03, [0.0, 0.0, 0.01]));
    let known = |inner, outer| TruncateError::Contained { inner, outer };
    assert_eq!(refused(&outer, &inner), known(1, 0));
    assert_eq!(refused(&inner, &outer), known(0, 1));
    // Touching from within.
    assert_eq!(
        refused(&outer, &sphere(0.03, [0.0, 0.0, 0.02])),
        known(1, 0)
    );
}

#[test]
fn coincident_surfaces_are_refused() {
    let ball = sphere(0.05, [0.0; 3]);
    let error = refused(&ball, &ball);
    assert!(
        matches!(error, TruncateError::Coincident { share, .. } if share == 100.0),
        "{error}"
    );
}

#[test]
fn bodies_apart_or_touching_have_nothing_to_do() {
    let ball = sphere(0.05, [0.0; 3]);
    for z in [0.08, 0.09, 1.0] {
        let two = truncate(
            &ball,
            &sphere(0.03, [0.0, 0.0, z]),
            &TruncateSpec::default(),
        );
        assert!(two.unwrap().is_none(), "{z}");
    }
}

#[test]
fn a_hair_of_overlap_is_truncated() {
    // 1 µm deep of 50 mm.
    let two = truncated(&sphere(0.05, [0.0; 3]), &sphere(0.03, [0.0, 0.0, 0.079999]));
    let rim = two.breps[0].vertices[0];
    // The circle in which both spheres cross.
    let (r, s, d) = (0.05, 0.03, 0.079999);
    let z: f64 = (d * d + r * r - s * s) / (2.0 * d);
    let rho = libm::hypot(rim.x, rim.y);
    assert!(
        (rim.z - z).abs() < 1e-11 && (rho - (r * r - z * z).sqrt()).abs() < 1e-9,
        "{rim}"
    );
}

#[test]
fn bodies_that_are_none_are_refused() {
    let ball = sphere(0.05, [0.0; 3]);
    let sheet = builtin("sheet", None, None).unwrap();
    assert_eq!(refused(&ball, &sheet), TruncateError::Open { body: 1 });
    assert_eq!(refused(&sheet, &ball), TruncateError::Open { body: 0 });
    let flat = mapped(ball.clone(), |p| Point3::new(p.x, p.y, 0.0));
    assert_eq!(refused(&flat, &ball), TruncateError::NoVolume { body: 0 });
    for tolerance_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let spec = TruncateSpec {
            tolerance_m: Some(tolerance_m),
        };
        let error = truncate(&ball, &ball, &spec).unwrap_err();
        assert!(matches!(error, TruncateError::Tolerance(_)), "{error}");
    }
}

#[test]
fn surfaces_turned_inside_out_are_truncated_alike() {
    let (a, b) = (sphere(0.05, [0.0; 3]), sphere(0.03, [0.0, 0.0, 0.06]));
    let plain = truncated(&a, &b);
    let turned = truncated(&a.clone().with_flip_normal(!a.flip_normal()), &b.swap_uv());
    for (x, y) in plain.volumes_m3.iter().zip(&turned.volumes_m3) {
        assert!((x / y - 1.0).abs() < 1e-6, "{x} {y}");
    }
}
