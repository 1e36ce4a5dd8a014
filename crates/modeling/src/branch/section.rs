//! One closed loop of control points: a section of a branch in its own frame.
//!
//! ```text
//!   p+2 ──── n-1  n=B  n+1 ──── n+p        n = 2p + 2 columns to an arc, 2n + 1 to a loop.
//!    │                          │          Arc 1 runs from F by the left to B, arc 2 from B by the right to F.
//!   p+1                        n+p+1       Columns p and p + 2 are corners, 1 the neighbour of the joint.
//!    │                          │
//!    p ──── 1    0=2n=F   2n-1 ──── n+p+2
//! ```

use palpate_geometry::math::{Point3, Vector3};

/// Where a section lies: right-handed, z along the branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub origin: Point3,
    pub x: Vector3,
    pub y: Vector3,
    pub z: Vector3,
}

impl Place {
    /// The frame of the stem's top.
    pub fn of_the_stem() -> Self {
        Self {
            origin: Point3::origin(),
            x: Vector3::x(),
            y: Vector3::y(),
            z: Vector3::z(),
        }
    }

    /// A point of this frame.
    pub fn at(&self, x: f64, y: f64, z: f64) -> Point3 {
        let point = self.origin + (self.x * x + self.y * y + self.z * z);
        // No −0: equal points are to have equal bits.
        point.map(|c| c + 0.0)
    }

    /// Further up by a distance.
    pub fn raised(&self, by_m: f64) -> Self {
        Self {
            origin: self.at(0.0, 0.0, by_m),
            ..*self
        }
    }

    /// Turned about y: z towards x.
    pub fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self {
            x: self.x * cos - self.z * sin,
            z: self.z * cos + self.x * sin,
            ..*self
        }
    }

    /// Turned about z: x towards y.
    pub fn twisted(&self, angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self {
            x: self.x * cos + self.y * sin,
            y: self.y * cos - self.x * sin,
            ..*self
        }
    }
}

/// Columns of an arc, less one.
pub(super) fn arc_columns(p: usize) -> usize {
    2 * p + 2
}

/// Distance from the joint of columns 0 ..= p along the front: the neighbour, then evenly to the
/// corner.
pub(super) fn front_columns(p: usize, neighbour: f64, corner: f64) -> Vec<f64> {
    let even = |k: usize| neighbour + (corner - neighbour) * ((k - 1) as f64 / (p - 1) as f64);
    (0..=p)
        .map(|k| match k {
            0 => 0.0,
            1 => neighbour,
            k if k == p => corner,
            k => even(k),
        })
        .collect()
}

/// (2n) the rectangle of width and depth 1 with its joints at x = front: columns 0 .. 2n.
pub(super) fn rectangle(p: usize, front: f64, neighbour: f64) -> Vec<[f64; 2]> {
    let left: Vec<f64> = front_columns(p, neighbour, 0.5 + front)
        .into_iter()
        .map(|d| front - d)
        .collect();
    let right: Vec<f64> = front_columns(p, neighbour, 0.5 - front)
        .into_iter()
        .map(|d| front + d)
        .collect();
    let mut loop_ = Vec::with_capacity(2 * arc_columns(p));
    loop_.extend(left.iter().map(|&x| [x, -0.5]));
    loop_.push([-0.5, 0.0]);
    loop_.extend(left[1..].iter().rev().map(|&x| [x, 0.5]));
    loop_.extend(right.iter().map(|&x| [x, 0.5]));
    loop_.push([0.5, 0.0]);
    loop_.extend(right[1..].iter().rev().map(|&x| [x, -0.5]));
    loop_
}

/// (n + 1) the arch from the back joint to the front one, as (y, z): straight up, across, straight
/// down.
pub(super) fn arch(p: usize, half_depth_m: f64, height_m: f64, neighbour_m: f64) -> Vec<[f64; 2]> {
    let up = front_columns(p, neighbour_m, height_m);
    let mut arch = Vec::with_capacity(arc_columns(p) + 1);
    arch.extend(up.iter().map(|&z| [half_depth_m, z]));
    arch.push([0.0, height_m]);
    arch.extend(up.iter().rev().map(|&z| [-half_depth_m, z]));
    arch
}

/// Slow at both ends: 3 t² − 2 t³.
pub(super) fn smoothstep(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_has_its_corners_and_is_the_same_seen_from_behind() {
        for p in 2..=6 {
            let n = arc_columns(p);
            let loop_ = rectangle(p, 0.1, 0.05);
            assert_eq!(loop_.len(), 2 * n);
            assert_eq!((loop_[0], loop_[n]), ([0.1, -0.5], [0.1, 0.5]));
            assert_eq!((loop_[p], loop_[p + 2]), ([-0.5, -0.5], [-0.5, 0.5]));
            assert_eq!((loop_[n + p], loop_[n + p + 2]), ([0.5, 0.5], [0.5, -0.5]));
            for k in 1..n {
                assert_eq!(loop_[k][0], loop_[n - k][0]);
                assert_eq!(loop_[k][1], -loop_[n - k][1]);
                assert_eq!(loop_[n + k][0], loop_[2 * n - k][0]);
            }
            let opposite = loop_[1][0] + loop_[2 * n - 1][0] - 2.0 * loop_[0][0];
            assert!(opposite.abs() <= f64::EPSILON, "off by {opposite}");
        }
    }

    #[test]
    fn an_arch_goes_up_across_and_down() {
        let arch = arch(3, 0.8, 0.7, 0.24);
        let heights: Vec<f64> = arch.iter().map(|point| point[1]).collect();
        for (got, wanted) in heights
            .iter()
            .zip([0.0, 0.24, 0.47, 0.7, 0.7, 0.7, 0.47, 0.24, 0.0])
        {
            assert!((got - wanted).abs() < 1e-15, "{heights:?}");
        }
    }
}
