//! Parts of Bézier curves and sheets, and what their points bound.

use super::super::cells::Block;
use super::super::cone::Cone;
use crate::math::Vector3;

/// A part of a line of cells against a part of a cell.
pub(super) struct CurvePart {
    /// (degree + 1), homogeneous.
    pub curve: Vec<[f64; 4]>,
    pub range: [f64; 2],
    /// (p + 1) × (q + 1), u-major, homogeneous.
    pub sheet: Vec<[f64; 4]>,
    pub rectangle: [[f64; 2]; 2],
    pub depth: u32,
}

/// Points in space.
pub(super) fn projected(points: &[[f64; 4]]) -> Vec<[f64; 3]> {
    points
        .iter()
        .map(|x| [x[0] / x[3], x[1] / x[3], x[2] / x[3]])
        .collect()
}

pub(super) fn boxed(points: &[[f64; 3]]) -> Block {
    let mut block = Block::EMPTY;
    for x in points {
        for c in 0..3 {
            block.low[c] = if x[c] < block.low[c] {
                x[c]
            } else {
                block.low[c]
            };
            block.high[c] = if x[c] > block.high[c] {
                x[c]
            } else {
                block.high[c]
            };
        }
    }
    block
}

/// Least and greatest extent along an axis.
pub(super) fn range(points: &[[f64; 3]], axis: &Vector3) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for p in points {
        let x = p[0] * axis.x + p[1] * axis.y + p[2] * axis.z;
        low = if x < low { x } else { low };
        high = if x > high { x } else { high };
    }
    [low, high]
}

pub(super) fn parted(a: [f64; 2], b: [f64; 2], margin: f64) -> bool {
    a[0] - margin > b[1] || b[0] - margin > a[1]
}

/// All of a curve's tangents lead through the planes whose normals are in a cone, the same way.
pub(super) fn passes_once(curve: &[[f64; 3]], cone: &Cone) -> bool {
    if cone.cos < 0.0 {
        return false;
    }
    let at = |x: &[f64; 3]| Vector3::new(x[0], x[1], x[2]);
    let mut sense = 0.0;
    curve.windows(2).all(|w| {
        let step = at(&w[1]) - at(&w[0]);
        let rise = step.dot(&cone.axis);
        let same = sense * rise >= 0.0;
        sense = rise;
        same && rise.abs() > cone.sin * step.norm()
    })
}

/// Two halves along the longest of the three directions.
pub(super) fn halves(part: CurvePart, [p, q]: [usize; 2]) -> [CurvePart; 2] {
    let depth = part.depth + 1;
    let length = |a: &[f64; 4], b: &[f64; 4]| {
        (0..3)
            .map(|c| (b[c] / b[3] - a[c] / a[3]) * (b[c] / b[3] - a[c] / a[3]))
            .sum::<f64>()
    };
    let n = q + 1;
    let curve = length(&part.curve[0], &part.curve[part.curve.len() - 1]);
    let last = p * n;
    let u = length(&part.sheet[0], &part.sheet[last])
        .max(length(&part.sheet[q], &part.sheet[last + q]));
    let v = length(&part.sheet[0], &part.sheet[q])
        .max(length(&part.sheet[last], &part.sheet[last + q]));
    let halved = |[low, high]: [f64; 2]| [[low, 0.5 * (low + high)], [0.5 * (low + high), high]];
    if curve >= u && curve >= v {
        let (mut a, mut b) = (part.curve.clone(), part.curve);
        let count = a.len();
        split(&mut a, &mut b, 0, 1, count);
        let [ra, rb] = halved(part.range);
        return [
            CurvePart {
                curve: a,
                range: ra,
                sheet: part.sheet.clone(),
                rectangle: part.rectangle,
                depth,
            },
            CurvePart {
                curve: b,
                range: rb,
                sheet: part.sheet,
                rectangle: part.rectangle,
                depth,
            },
        ];
    }
    let d = usize::from(v > u);
    let (mut a, mut b) = (part.sheet.clone(), part.sheet);
    if d == 0 {
        (0..n).for_each(|l| split(&mut a, &mut b, l, n, p + 1));
    } else {
        (0..=p).for_each(|k| split(&mut a, &mut b, k * n, 1, n));
    }
    let [ra, rb] = halved(part.rectangle[d]);
    let (mut low, mut high) = (part.rectangle, part.rectangle);
    (low[d], high[d]) = (ra, rb);
    [
        CurvePart {
            curve: part.curve.clone(),
            range: part.range,
            sheet: a,
            rectangle: low,
            depth,
        },
        CurvePart {
            curve: part.curve,
            range: part.range,
            sheet: b,
            rectangle: high,
            depth,
        },
    ]
}

/// De Casteljau at one half, for `count` points from `first` on, `stride` apart: `a` becomes the
/// lower half, and `b`, whose last point of each round stays where it was, the upper.
fn split(a: &mut [[f64; 4]], b: &mut [[f64; 4]], first: usize, stride: usize, count: usize) {
    let at = |k: usize| first + k * stride;
    for r in 1..count {
        for k in 0..count - r {
            for c in 0..4 {
                b[at(k)][c] = 0.5 * (b[at(k)][c] + b[at(k + 1)][c]);
            }
        }
        a[at(r)] = b[at(0)];
    }
}
