//! Sections of a pipe: points of the spine with a frame that turns about the tangent as little as
//! it can.
//!
//! Rotation-minimising frames by double reflection (Wang, Jüttler, Zheng & Liu 2008). Round a
//! closed spine the frame comes back turned by its holonomy, which is spread evenly over the
//! length.

use super::piece::{Jet, Piece};
use super::spine::angle;
use palpate_geometry::math::{Vector3, gauss_legendre};

/// A section's centre, tangent and the two directions of its plane, with derivatives by the
/// parameter of the spine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    /// Parameter of the spine.
    pub parameter: f64,
    pub centre: Vector3,
    pub velocity: Vector3,
    pub normals: [Vector3; 2],
    pub turning: [Vector3; 2],
}

/// A stretch of a piece between two sections, x from `from` to `to`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub piece: usize,
    pub from: f64,
    pub to: f64,
}

/// The sections at both ends of every stretch. Stretches follow each other along the spine.
pub(super) fn sections(pieces: &[Piece], stretches: &[Stretch], closed: bool) -> Vec<[Section; 2]> {
    let jets: Vec<[Jet; 2]> = stretches
        .iter()
        .map(|s| [s.from, s.to].map(|x| by_parameter(&pieces[s.piece], x)))
        .collect();
    let lengths: Vec<f64> = stretches
        .iter()
        .map(|s| length(&pieces[s.piece], s))
        .collect();
    let total: f64 = lengths.iter().sum();
    // One normal at the start of each stretch, and one at the end of the last.
    let mut normals = vec![any_normal(&jets[0][0].first)];
    for [a, b] in &jets {
        normals.push(reflected_twice(a, b, normals[normals.len() - 1]));
    }
    let twist = if closed {
        -turn(&normals[jets.len()], &normals[0], &jets[0][0].first)
    } else {
        0.0
    };
    let mut travelled = 0.0;
    let mut sections = Vec::with_capacity(jets.len());
    for (k, [a, b]) in jets.iter().enumerate() {
        let before = twist * travelled / total;
        travelled += lengths[k];
        let piece = &pieces[stretches[k].piece];
        let [from, to] = [stretches[k].from, stretches[k].to].map(|x| piece.parameter(x));
        // Each normal belongs to two stretches: its end and the next one's start.
        let start = section(from, a, normals[k], before, twist / total);
        let end = section(
            to,
            b,
            normals[k + 1],
            twist * travelled / total,
            twist / total,
        );
        sections.push([start, end]);
    }
    sections
}

/// Derivatives by the spine's parameter instead of x.
fn by_parameter(piece: &Piece, x: f64) -> Jet {
    let (jet, rate) = (piece.jet(x), 1.0 / (piece.end - piece.start));
    Jet {
        point: jet.point,
        first: jet.first * rate,
        second: jet.second * (rate * rate),
    }
}

/// Turned by `twist` from the frame that does not turn; `rate` is the turn by length.
fn section(parameter: f64, jet: &Jet, normal: Vector3, twist: f64, rate: f64) -> Section {
    let speed = jet.first.norm();
    let tangent = jet.first / speed;
    let other = tangent.cross(&normal);
    let (sin, cos) = libm::sincos(twist);
    let normals = [normal * cos + other * sin, other * cos - normal * sin];
    // n' = −(n · T') T for a frame that does not turn about T, and T' · n = c'' · n / |c'|.
    let lean = |n: &Vector3| tangent * (-jet.second.dot(n) / speed);
    let turning = [
        lean(&normals[0]) + normals[1] * (rate * speed),
        lean(&normals[1]) - normals[0] * (rate * speed),
    ];
    Section {
        parameter,
        centre: jet.point,
        velocity: jet.first,
        normals,
        turning,
    }
}

/// Some unit vector normal to a direction.
fn any_normal(direction: &Vector3) -> Vector3 {
    let axis = direction.iamin();
    let mut other = Vector3::zeros();
    other[axis] = 1.0;
    direction.cross(&other).normalize()
}

/// The normal at `a` carried to `b`: mirrored in the plane half way, then in the one that takes the
/// tangent to b's.
fn reflected_twice(a: &Jet, b: &Jet, normal: Vector3) -> Vector3 {
    let mirror =
        |v: Vector3, along: &Vector3| v - along * (2.0 * along.dot(&v) / along.norm_squared());
    let (ta, tb) = (a.first.normalize(), b.first.normalize());
    let step = b.point - a.point;
    let (normal, tangent) = if step.norm_squared() > 0.0 {
        (mirror(normal, &step), mirror(ta, &step))
    } else {
        (normal, ta)
    };
    let change = tb - tangent;
    let carried = if change.norm_squared() > 1e-20 {
        mirror(normal, &change)
    } else {
        normal
    };
    (carried - tb * tb.dot(&carried)).normalize()
}

/// The angle about `axis` from one normal to another, in (−π, π].
fn turn(to: &Vector3, from: &Vector3, axis: &Vector3) -> f64 {
    let size = angle(from, to);
    if from.cross(to).dot(axis) < 0.0 {
        -size
    } else {
        size
    }
}

fn length(piece: &Piece, stretch: &Stretch) -> f64 {
    let half = 0.5 * (stretch.to - stretch.from);
    gauss_legendre(6)
        .iter()
        .map(|(node, weight)| {
            weight * half * piece.jet(stretch.from + half * (1.0 + node)).first.norm()
        })
        .sum()
}
