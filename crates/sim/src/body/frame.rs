//! The rotation of a coordinate's neighbourhood.

use palpate_geometry::math::Lane;

/// Rows of a rotation.
pub(super) type Frame = [[f64; 3]; 3];

/// The frame of rest.
pub(super) const IDENTITY: Frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Rᵀ v.
#[inline(always)]
pub(super) fn into_rest(frame: &Frame, v: &Lane) -> Lane {
    let [a, b, c] = frame;
    std::array::from_fn(|k| match k {
        3 => 0.0,
        k => a[k] * v[0] + b[k] * v[1] + c[k] * v[2],
    })
}

/// R v.
#[inline(always)]
pub(super) fn from_rest(frame: &Frame, v: &Lane) -> Lane {
    let turned = frame.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    [turned[0], turned[1], turned[2], 0.0]
}
