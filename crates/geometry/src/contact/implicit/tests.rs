//! Facts about functions, and about implicit solids against surfaces.

use super::{ExpressionError, ImplicitShape, ImplicitSolver, Tape};
use crate::basis::testing::Random;
use crate::contact::exact::{ExactScratch, ball, plane};
use crate::contact::{ContactSet, Reach};
use crate::math::{Point3, Pose, Rotation, Vector3};
use crate::skin::{Skin, SkinSide, SkinSolver};
use crate::surface::{ClosestSolver, Surface, builtin};

const TEXTS: [&str; 12] = [
    "x^2 + 4*y^2 + sqrt(z^2 + 1e-6) - 0.01",
    "-x^2 + y",
    "2^3^2 - x*y*z",
    "max(x, y, z) - min(x, y) / 3",
    "sin(x)*cos(y + 1) + tan(z / 4)",
    "exp(-x) - ln(2 + y^2) + tanh(z)",
    "hypot(x, y) - abs(z) * .5",
    "atan2(y, x + 3) + pi",
    "(x + 2)^1.5 + (y + 3)^-2",
    "((x - y)*(x + y))^3 / (4 + z)",
    "x*x - 2*x*y + y*y",
    "1e-3 * x + 1.5E2*y - +z",
];

fn twin(k: usize, x: f64, y: f64, z: f64) -> f64 {
    match k {
        0 => x * x + 4.0 * y * y + (z * z + 1e-6).sqrt() - 0.01,
        1 => -(x * x) + y,
        2 => 512.0 - x * y * z,
        3 => x.max(y).max(z) - x.min(y) / 3.0,
        4 => x.sin() * (y + 1.0).cos() + (z / 4.0).tan(),
        5 => (-x).exp() - (2.0 + y * y).ln() + z.tanh(),
        6 => x.hypot(y) - z.abs() * 0.5,
        7 => y.atan2(x + 3.0) + std::f64::consts::PI,
        8 => (x + 2.0).powf(1.5) + (y + 3.0).powi(-2),
        9 => ((x - y) * (x + y)).powi(3) / (4.0 + z),
        10 => x * x - 2.0 * x * y + y * y,
        _ => 1e-3 * x + 150.0 * y - z,
    }
}

fn vector(random: &mut Random) -> Vector3 {
    Vector3::new(
        random.float(-1.0, 1.0),
        random.float(-1.0, 1.0),
        random.float(-1.0, 1.0),
    )
}

#[test]
fn a_text_means_what_it_says_and_its_gradient_is_that_of_differences() {
    let mut random = Random(1);
    for (k, text) in TEXTS.iter().enumerate() {
        let tape = Tape::parse(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        for _ in 0..200 {
            let p = Point3::from(vector(&mut random));
            let expected = twin(k, p.x, p.y, p.z);
            assert!(
                (tape.value(&p) - expected).abs() <= 1e-13 * (1.0 + expected.abs()),
                "{text} at {p:?}"
            );
            let (f, g) = tape.gradient(&p);
            assert_eq!(f, tape.value(&p), "{text}");
            for c in 0..3 {
                let h = 1e-6;
                let (mut a, mut b) = (p, p);
                a[c] -= h;
                b[c] += h;
                let slope = (tape.value(&b) - tape.value(&a)) / (2.0 * h);
                // Central differences: h² times a third derivative, and rounding over h.
                assert!(
                    (slope - g[c]).abs() <= 1e-7 * (1.0 + expected.abs() + slope.abs()),
                    "{text} at {p:?}: {slope} {}",
                    g[c]
                );
            }
        }
    }
}

#[test]
fn ranges_hold_every_value_of_their_boxes() {
    let mut random = Random(2);
    for text in TEXTS.iter().chain(&[
        "sin(9*x) + cos(20*y*z)",
        "tan(2*x)",
        "1/(x - y)",
        "ln(x)",
        "sqrt(y)",
        "x^z",
        "atan2(x, y)",
    ]) {
        let tape = Tape::parse(text).unwrap();
        for _ in 0..100 {
            let (c, half) = (
                Point3::from(vector(&mut random)),
                vector(&mut random).abs() * random.float(0.0, 1.0),
            );
            let range = tape.interval(&(c - half), &(c + half));
            for _ in 0..40 {
                let p = c + half.component_mul(&vector(&mut random));
                let value = tape.value(&p);
                assert!(
                    value.is_nan() || (range.low <= value && value <= range.high),
                    "{text}: {value} not in {range:?}"
                );
            }
        }
    }
}

// Short and long functions are computed in rooms of different sizes.
#[test]
fn a_function_of_any_length_is_computed_alike() {
    let p = Point3::new(0.3, -0.2, 0.1);
    for terms in 1..31 {
        let text = (1..=terms).map(|k| format!("abs(x - {k})*y"));
        let tape = Tape::parse(&text.collect::<Vec<_>>().join(" + ")).unwrap();
        let n = f64::from(terms);
        let sum = 0.5 * n * (n + 1.0) - 0.3 * n;
        let (f, slope) = tape.gradient(&p);
        let range = tape.interval(&p, &p);
        assert!((f + 0.2 * sum).abs() <= 1e-12 * sum && f == tape.value(&p));
        assert!((slope - Vector3::new(0.2 * n, sum, 0.0)).norm() <= 1e-12 * sum);
        assert!(range.low <= f && f <= range.high && range.high - range.low < 1e-10 * sum);
    }
}

#[test]
fn a_wrong_text_says_where_and_what_would_help() {
    for (text, column, words) in [
        ("", 1, "the end"),
        ("x +", 4, "expected a number"),
        ("x + 2 y", 7, "an operator"),
        ("(x + y", 7, "')'"),
        ("sqr(x)", 1, "did you mean sqrt?"),
        ("log(x)", 1, "did you mean ln?"),
        ("w + 1", 1, "x, y, z"),
        ("hypot(x)", 1, "takes 2 arguments, not 1"),
        ("sin x", 5, "'(' after a function"),
        ("1.2.3", 1, "not a number"),
        ("x $ y", 3, "'$'"),
    ] {
        let error = Tape::parse(text).unwrap_err().to_string();
        assert!(
            error.contains(&format!("column {column}:")) && error.contains(words),
            "{text}: {error}"
        );
    }
    let deep = "(".repeat(10_000);
    assert!(matches!(
        Tape::parse(&deep),
        Err(ExpressionError::Long { .. })
    ));
    let long: String = (0..300).map(|k| format!("{k}.5*x+")).collect::<String>() + "1";
    assert!(matches!(
        Tape::parse(&long),
        Err(ExpressionError::Long { .. })
    ));
}

fn touch(surface: &Surface, shape: &ImplicitShape, pose: &Pose, reach: &Reach) -> ContactSet {
    let skin = Skin::from(surface.clone());
    let mut solver = SkinSolver::new(&skin);
    let mut implicit = ImplicitSolver::new(&skin);
    let (tool, mut out) = (shape.compile().unwrap(), ContactSet::new());
    implicit.contacts(
        SkinSide {
            skin: &skin,
            solver: &mut solver,
        },
        &tool,
        pose,
        reach,
        &[],
        &mut out,
    );
    for c in out.contacts() {
        let scale = surface.size() + c.on_body.coords.amax();
        assert!(
            (surface.point(c.u, c.v) - c.on_body).norm() <= 1e-12 * scale,
            "{c:?}"
        );
        assert!(
            (c.on_body - c.on_tool - c.normal * c.depth_m).norm() <= 1e-13 * scale,
            "{c:?}"
        );
        assert!((c.normal.norm() - 1.0).abs() < 1e-12, "{c:?}");
    }
    out
}

fn expression(text: &str) -> ImplicitShape {
    ImplicitShape::Expression {
        text: text.to_owned(),
    }
}

fn at(p: Point3) -> Pose {
    Pose::translation(p.x, p.y, p.z)
}

fn centre(surface: &Surface) -> Point3 {
    let net = surface.net().points();
    Point3::from(net.iter().map(|p| p.coords).sum::<Vector3>() / net.len() as f64)
}

/// Each answer's depths hold those of the other, to `tolerance`.
fn same_depths(a: &ContactSet, b: &ContactSet, tolerance: f64, name: &str) {
    for (x, y) in [(a, b), (b, a)] {
        for c in x.contacts() {
            let found = y
                .contacts()
                .iter()
                .any(|d| (c.depth_m - d.depth_m).abs() <= tolerance);
            assert!(
                found,
                "{name}: no {} among {:?}",
                c.depth_m,
                y.contacts().iter().map(|c| c.depth_m).collect::<Vec<_>>()
            );
        }
    }
}

// z ≤ 0 is the half-space below a plane, whose contacts are certified.
#[test]
fn a_half_space_as_a_function_touches_like_a_plane() {
    let mut random = Random(3);
    let mut compared = 0;
    for name in ["teardrop", "torus", "sheet"] {
        let body = builtin(name, None, None).unwrap();
        let size = body.size();
        let mut solver = ClosestSolver::new(&body);
        let mut scratch = ExactScratch::new(&body, &mut solver);
        for _ in 0..12 {
            let pose = Pose::from_parts(
                (centre(&body).coords + vector(&mut random) * 0.3 * size).into(),
                Rotation::from_scaled_axis(vector(&mut random) * 3.0),
            );
            let mut expected = ContactSet::new();
            let (point, n) = (pose * Point3::origin(), pose * Vector3::z());
            plane::contacts(
                &body,
                &mut solver,
                &point,
                &n,
                &Reach::TOUCH,
                &mut scratch,
                &mut expected,
            );
            let found = touch(&body, &expression("z"), &pose, &Reach::TOUCH);
            same_depths(&found, &expected, 1e-9 * size, name);
            compared += expected.contacts().len();
        }
    }
    assert!(compared > 20, "{compared}");
}

// Depth in a ball along the gradient is radius less distance to the centre: from outside, the
// certified ball's.
#[test]
fn a_ball_as_a_function_touches_like_a_ball() {
    let mut random = Random(4);
    let mut compared = 0;
    for name in ["teardrop", "torus"] {
        let body = builtin(name, None, None).unwrap();
        let size = body.size();
        let mut solver = ClosestSolver::new(&body);
        let mut scratch = ExactScratch::new(&body, &mut solver);
        for _ in 0..12 {
            let q = centre(&body) + vector(&mut random) * 0.5 * size;
            let foot = solver.closest(&body, &q);
            if foot.signed_distance < 0.0 {
                continue;
            }
            let radius_m = foot.distance + random.float(0.01, 0.1) * size;
            let mut expected = ContactSet::new();
            ball::contacts(
                &body,
                &mut solver,
                &q,
                radius_m,
                &Reach::TOUCH,
                &mut scratch,
                &mut expected,
            );
            let found = touch(
                &body,
                &ImplicitShape::Sphere { radius_m },
                &at(q),
                &Reach::TOUCH,
            );
            assert!(
                (found.deepest().unwrap().depth_m - expected.deepest().unwrap().depth_m).abs()
                    <= 1e-9 * size
            );
            for c in expected.contacts() {
                assert!(
                    found
                        .contacts()
                        .iter()
                        .any(|d| (c.depth_m - d.depth_m).abs() <= 1e-9 * size),
                    "{c:?} {found:?}"
                );
            }
            compared += expected.contacts().len();
        }
    }
    assert!(compared > 8, "{compared}");
}

/// Greatest depth by samples, each refined around the best with a shrinking grid.
fn sampled(surface: &Surface, shape: &ImplicitShape, pose: &Pose) -> f64 {
    let tool = shape.compile().unwrap();
    let ((u0, u1), (v0, v1)) = (surface.knots_u().domain(), surface.knots_v().domain());
    let depth = |u: f64, v: f64| {
        let p = pose.inverse_transform_point(&surface.point(u.clamp(u0, u1), v.clamp(v0, v1)));
        tool.stand(&p).map_or(f64::NEG_INFINITY, |s| s.depth_m)
    };
    let n = 200;
    let (mut best, mut at) = (f64::NEG_INFINITY, (u0, v0));
    for a in 0..=n {
        for b in 0..=n {
            let (u, v) = (
                u0 + (u1 - u0) * a as f64 / n as f64,
                v0 + (v1 - v0) * b as f64 / n as f64,
            );
            let d = depth(u, v);
            if d > best {
                (best, at) = (d, (u, v));
            }
        }
    }
    let mut step = 1.5 / n as f64;
    while step > 1e-12 {
        let centre = at;
        for a in -6..=6 {
            for b in -6..=6 {
                let (u, v) = (
                    centre.0 + step * (u1 - u0) * a as f64 / 6.0,
                    centre.1 + step * (v1 - v0) * b as f64 / 6.0,
                );
                let d = depth(u, v);
                if d > best {
                    (best, at) = (d, (u.clamp(u0, u1), v.clamp(v0, v1)));
                }
            }
        }
        step *= 0.5;
    }
    best
}

#[test]
fn the_deepest_contact_is_as_deep_as_a_polished_sampling() {
    let mut random = Random(5);
    let body = builtin("teardrop", None, None).unwrap();
    let size = body.size();
    let shapes = [
        ImplicitShape::Cylinder {
            radius_m: 0.02,
            half_length_m: None,
        },
        ImplicitShape::Cylinder {
            radius_m: 0.02,
            half_length_m: Some(0.03),
        },
        ImplicitShape::Cone {
            half_angle_rad: 0.5,
            height_m: 0.05,
        },
        ImplicitShape::Ellipsoid {
            semi_axes_m: [0.01, 0.02, 0.04],
        },
        ImplicitShape::Torus {
            major_radius_m: 0.03,
            minor_radius_m: 0.01,
        },
        ImplicitShape::Box {
            half_extents_m: [0.01, 0.02, 0.03],
        },
        expression("x^2 + 4*y^2 + sqrt(z^2 + 1e-6) - 0.01"),
    ];
    let mut touched = 0;
    for k in 0..if cfg!(debug_assertions) { 21 } else { 210 } {
        let shape = &shapes[k % shapes.len()];
        let (u, v) = (random.float(0.0, 1.0), random.float(0.1, 0.9));
        let on = body.point(u, v) + vector(&mut random) * 0.01;
        let pose = Pose::from_parts(
            on.coords.into(),
            Rotation::from_scaled_axis(vector(&mut random) * 3.0),
        );
        let found = touch(&body, shape, &pose, &Reach::TOUCH);
        let expected = sampled(&body, shape, &pose);
        let depth = found.deepest().map_or(f64::NEG_INFINITY, |c| c.depth_m);
        if expected < 0.0 {
            assert!(
                depth < 1e-9 * size,
                "{shape:?} {pose:?}: {depth} {expected}"
            );
        } else {
            touched += 1;
            assert!(
                depth >= expected - 1e-9 * size,
                "{k} {shape:?} {pose:?}: {depth:e} less than {expected:e}"
            );
        }
    }
    assert!(touched > 10, "{touched}");
}

#[test]
fn hard_poses_do_no_harm() {
    let body = builtin("teardrop", None, None).unwrap();
    let ball = ImplicitShape::Sphere { radius_m: 0.02 };
    // Its centre on the surface: there the gradient vanishes, and there it is deepest.
    let on = body.point(0.3, 0.5);
    let set = touch(&body, &ball, &at(on), &Reach::TOUCH);
    assert!(
        (set.deepest().unwrap().depth_m - 0.02).abs() <= 1e-9 * body.size(),
        "{set:?}"
    );
    // Larger than the body; nowhere near; wholly inside; not finite.
    assert!(
        touch(
            &body,
            &ImplicitShape::Sphere { radius_m: 10.0 },
            &at(on),
            &Reach::TOUCH
        )
        .overlap()
    );
    assert!(
        touch(&body, &ball, &at(on + Vector3::x()), &Reach::TOUCH)
            .deepest()
            .is_none()
    );
    let inside = touch(
        &body,
        &ImplicitShape::Sphere { radius_m: 1e-3 },
        &at(centre(&body)),
        &Reach::TOUCH,
    );
    assert!(inside.deepest().is_none());
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(
            touch(
                &body,
                &ball,
                &Pose::translation(bad, 0.0, 0.0),
                &Reach::TOUCH
            )
            .deepest()
            .is_none()
        );
    }
    // Functions that mean nothing in places, or have no gradient.
    for text in [
        "ln(x)",
        "sqrt(-1 - x^2)",
        "1/x",
        "-1",
        "0",
        "abs(x)",
        "x^0",
        "min(x, 1/0)",
    ] {
        touch(&body, &expression(text), &at(on), &Reach::TOUCH);
    }
}

#[test]
fn a_cylinder_lying_on_a_sheet_is_one_contact_and_two_balls_are_two() {
    let sheet = builtin("sheet", None, Some(1.0)).unwrap();
    let bar = ImplicitShape::Cylinder {
        radius_m: 0.1,
        half_length_m: None,
    };
    let pose = Pose::from_parts(
        Vector3::new(0.0, 0.0, 0.08).into(),
        Rotation::from_euler_angles(0.0, std::f64::consts::FRAC_PI_2, 0.3),
    );
    let set = touch(&sheet, &bar, &pose, &Reach::TOUCH);
    assert_eq!(set.contacts().len(), 1, "{set:?}");
    assert!((set.deepest().unwrap().depth_m - 0.02).abs() <= 1e-9);
    let two = expression("min(hypot(x - 0.2, y, 0), 1)");
    assert!(two.compile().is_err(), "hypot takes two");
    let two = expression("min(sqrt((x - 0.2)^2 + y^2 + z^2), sqrt((x + 0.2)^2 + y^2 + z^2)) - 0.1");
    let set = touch(
        &sheet,
        &two,
        &at(Point3::new(0.05, 0.02, 0.07)),
        &Reach::TOUCH,
    );
    assert_eq!(set.contacts().len(), 2, "{set:?}");
    assert!(
        set.contacts()
            .iter()
            .all(|c| (c.depth_m - 0.03).abs() <= 1e-9)
    );
    // A gap within the margin is a contact of negative depth.
    let reach = Reach {
        margin_m: 0.02,
        below: false,
        closing_m: 0.0,
    };
    let set = touch(&sheet, &two, &at(Point3::new(0.05, 0.02, 0.11)), &reach);
    assert_eq!(set.contacts().len(), 2, "{set:?}");
    assert!(
        set.contacts()
            .iter()
            .all(|c| (c.depth_m + 0.01).abs() <= 1e-9)
    );
}

#[test]
fn tool_and_body_moved_together_touch_the_same_and_scale_does_not_matter() {
    let mut random = Random(6);
    let body = builtin("teardrop", None, None).unwrap();
    let shape = |scale: f64| ImplicitShape::Torus {
        major_radius_m: 0.03 * scale,
        minor_radius_m: 0.01 * scale,
    };
    for _ in 0..6 {
        let pose = Pose::from_parts(
            (body
                .point(random.float(0.0, 1.0), random.float(0.2, 0.8))
                .coords)
                .into(),
            Rotation::from_scaled_axis(vector(&mut random)),
        );
        let first = touch(&body, &shape(1.0), &pose, &Reach::TOUCH);
        let by = Pose::from_parts(
            vector(&mut random).into(),
            Rotation::from_scaled_axis(vector(&mut random) * 2.0),
        );
        let moved = touch(
            &body.transformed(&by),
            &shape(1.0),
            &(by * pose),
            &Reach::TOUCH,
        );
        same_depths(&first, &moved, 1e-9 * body.size(), "moved");
        for scale in [1e-5, 1e4] {
            let at = Pose::from_parts((pose.translation.vector * scale).into(), pose.rotation);
            let scaled = touch(&body.scaled(scale), &shape(scale), &at, &Reach::TOUCH);
            assert_eq!(scaled.contacts().is_empty(), first.contacts().is_empty());
            if let (Some(a), Some(b)) = (first.deepest(), scaled.deepest()) {
                assert!(
                    (a.depth_m * scale - b.depth_m).abs() <= 1e-9 * body.size() * scale,
                    "{a:?} {b:?}"
                );
            }
        }
    }
}
