//! Three-vectors and unit quaternions (x y z w) as arrays.

pub(super) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn scale(a: [f64; 3], s: f64) -> [f64; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// No longer than `most`; nothing at all if not finite.
pub(super) fn limited(a: [f64; 3], most: f64) -> [f64; 3] {
    let size = norm(a);
    match size.is_finite() {
        false => [0.0; 3],
        true if size > most => scale(a, most / size),
        true => a,
    }
}

/// The identity rotation.
pub(super) const UNTURNED: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// First `b`, then `a`.
pub(super) fn turn(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    let [ax, ay, az, aw] = a;
    let [bx, by, bz, bw] = b;
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

pub(super) fn inverse(q: [f64; 4]) -> [f64; 4] {
    [-q[0], -q[1], -q[2], q[3]]
}

pub(super) fn unit(q: [f64; 4]) -> [f64; 4] {
    let size = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    if size > 0.0 && size.is_finite() {
        q.map(|x| x / size)
    } else {
        UNTURNED
    }
}

/// Rotation by `vector` (axis times angle, rad).
pub(super) fn from_vector(vector: [f64; 3]) -> [f64; 4] {
    let angle = norm(vector);
    // sin(a/2)/a by its series where the quotient loses its digits.
    let share = if angle < 1e-4 {
        0.5 - angle * angle / 48.0
    } else {
        libm::sin(0.5 * angle) / angle
    };
    let [x, y, z] = scale(vector, share);
    unit([x, y, z, libm::cos(0.5 * angle)])
}

/// Axis times angle of a unit quaternion, the shorter way round, rad.
pub(super) fn to_vector(q: [f64; 4]) -> [f64; 3] {
    let q = if q[3] < 0.0 { q.map(|x| -x) } else { q };
    let part = [q[0], q[1], q[2]];
    let sine = norm(part);
    let share = if sine < 1e-8 {
        2.0
    } else {
        2.0 * libm::atan2(sine, q[3]) / sine
    };
    scale(part, share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_vector_comes_back() {
        for vector in [
            [0.0; 3],
            [1e-9, 0.0, 2e-9],
            [1e-4, -1e-4, 0.0],
            [0.3, -1.0, 2.0],
            [0.0, 3.1, 0.0],
        ] {
            let back = to_vector(from_vector(vector));
            assert!(
                norm(sub(back, vector)) < 1e-14 * (1.0 + norm(vector)),
                "{vector:?} {back:?}"
            );
        }
    }

    #[test]
    fn turns_about_one_axis_add_up_and_order_matters_otherwise() {
        let z = |angle| from_vector([0.0, 0.0, angle]);
        assert!((to_vector(turn(z(0.4), z(0.5)))[2] - 0.9).abs() < 1e-15);
        // x by a quarter, then z by a quarter: takes y to z, which stays; the other order takes y
        // to −x.
        let (x, z) = (
            from_vector([std::f64::consts::FRAC_PI_2, 0.0, 0.0]),
            z(std::f64::consts::FRAC_PI_2),
        );
        let rotate = |q, v: [f64; 3]| {
            let [a, b, c, _] = turn(turn(q, [v[0], v[1], v[2], 0.0]), inverse(q));
            [a, b, c]
        };
        assert!(norm(sub(rotate(turn(z, x), [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0])) < 1e-15);
        assert!(norm(sub(rotate(turn(x, z), [0.0, 1.0, 0.0]), [-1.0, 0.0, 0.0])) < 1e-15);
    }

    #[test]
    fn what_is_not_finite_counts_as_none() {
        assert_eq!(limited([f64::NAN, 1.0, 0.0], 5.0), [0.0; 3]);
        assert_eq!(limited([f64::INFINITY, 1.0, 0.0], 5.0), [0.0; 3]);
        assert_eq!(limited([3.0, 4.0, 0.0], 5.0), [3.0, 4.0, 0.0]);
        assert_eq!(limited([6.0, 8.0, 0.0], 5.0), [3.0, 4.0, 0.0]);
    }
}
