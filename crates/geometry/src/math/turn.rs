//! Rotations as vectors: direction of the axis, length of the angle, rad.

use super::{Rotation, Vector3};

/// Below this angle, rad, series are exact to rounding.
const SMALL: f64 = 1e-4;
/// Unit vectors whose sum is shorter have no axis between them that rounding leaves.
const OPPOSITE: f64 = 1e-8;

/// The rotation by a vector (exponential map).
pub fn rotation_by(turn: &Vector3) -> Rotation {
    let angle = turn.norm();
    let (sine, cosine) = (libm::sin(0.5 * angle), libm::cos(0.5 * angle));
    // sin(a / 2) / a
    let share = if angle < SMALL {
        0.5 - angle * angle / 48.0
    } else {
        sine / angle
    };
    let v = turn * share;
    Rotation::new_unchecked(nalgebra::Quaternion::new(cosine, v.x, v.y, v.z))
}

/// The shortest rotation from one direction to another, neither of them zero; a half turn about any
/// axis across where they are opposite.
pub fn rotation_onto(from: &Vector3, to: &Vector3) -> Rotation {
    let (a, b) = (from.normalize(), to.normalize());
    let both = a + b;
    let (w, v) = if both.norm() > OPPOSITE {
        // |a + b|² / 2 is 1 + cos.
        (0.5 * both.norm_squared(), a.cross(&b))
    } else {
        let mut aside = Vector3::zeros();
        aside[a.iamin()] = 1.0;
        (0.0, a.cross(&aside))
    };
    Rotation::new_normalize(nalgebra::Quaternion::new(w, v.x, v.y, v.z))
}

/// The vector by which `from` turns into `to`, in the frame in which both are given; by the short
/// way.
pub fn turn_between(from: &Rotation, to: &Rotation) -> Vector3 {
    if from == to {
        // Their quotient would differ from the identity in its last bits.
        return Vector3::zeros();
    }
    let q = to * from.inverse();
    let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
    let v = Vector3::new(q.i, q.j, q.k) * sign;
    let (sine, cosine) = (v.norm(), q.w * sign);
    // 2 atan2(s, c) / s
    let share = if sine < SMALL {
        2.0 / cosine * (1.0 - sine * sine / (3.0 * cosine * cosine))
    } else {
        2.0 * libm::atan2(sine, cosine) / sine
    };
    v * share
}

#[cfg(test)]
mod tests {
    use super::super::Random;
    use super::*;

    #[test]
    fn both_maps_agree_with_the_rotation_matrix_and_with_each_other() {
        let mut state = 5u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        for k in 0..2_000 {
            let axis = Vector3::new(random(), random(), random()).normalize();
            let angle = [1e-12, 9e-5, 1.1e-4, 1e-2, 1.0, 3.1][k % 6] * (0.5 + random().abs());
            let rotation = rotation_by(&(axis * angle));
            let x = Vector3::new(random(), random(), random());
            // Rodrigues' formula.
            let turned = x * angle.cos()
                + axis.cross(&x) * angle.sin()
                + axis * (axis.dot(&x) * (1.0 - angle.cos()));
            assert!((rotation * x - turned).norm() < 1e-15 * 4.0);
            let from = rotation_by(&(Vector3::new(random(), random(), random()) * 4.0));
            let back = turn_between(&from, &(rotation * from));
            assert!(
                (back - axis * angle).norm() < 2e-15,
                "{angle}: {back} is not {}",
                axis * angle
            );
        }
    }

    #[test]
    fn one_direction_turns_onto_another_the_short_way() {
        let mut random = Random(7);
        for k in 0..2_000 {
            let from = random.vector();
            // Anywhere, near, nearly opposite, the same, opposite.
            let to = match k % 5 {
                0 => random.vector(),
                1 => from + random.vector() * 1e-9,
                2 => random.vector() * 1e-5 - from,
                3 => from * 2.0,
                _ => -from,
            };
            let turn = rotation_onto(&from, &to);
            let (there, goal) = (turn * from.normalize(), to.normalize());
            assert!((there - goal).norm() < 1e-10, "{from:?} to {to:?}");
            let angle = libm::atan2(from.cross(&to).norm(), from.dot(&to));
            let turned = turn_between(&Rotation::identity(), &turn).norm();
            assert!((turned - angle).abs() < 1e-10, "{turned} is not {angle}");
        }
    }

    #[test]
    fn nothing_turns_by_nothing_and_the_sign_of_a_quaternion_is_no_turn() {
        assert_eq!(rotation_by(&Vector3::zeros()), Rotation::identity());
        let q = rotation_by(&Vector3::new(0.3, -0.2, 1.0));
        let other = Rotation::new_unchecked(-q.into_inner());
        assert!(turn_between(&q, &other).norm() < 1e-15);
    }
}
