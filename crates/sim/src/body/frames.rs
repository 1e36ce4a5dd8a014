//! How far each coordinate's neighbourhood has turned since rest: rotations that carry the tangent
//! of rest along (stiffness warping, Müller et al. 2002).
//!
//! The deformation gradient is fitted to the edges to a few neighbours; the rotation is its polar
//! part by Newton's method (Higham 1986). Only the preconditioner of the step uses it, so it need
//! not be exact, but it must be a rotation or close to one whatever the positions are.

use super::matter::Matter;
use super::node_map::NodeMap;
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3};

/// Neighbours of a coordinate, at most.
const MOST: usize = 8;
/// Newton steps: a stretch of 1.3 is off by 1e-7 after three.
const STEPS: usize = 3;
/// Deformation gradients with a determinant outside of this range have no use for Newton's method.
const DETERMINANTS: std::ops::Range<f64> = 0.05..20.0;

/// Rows of a rotation.
pub(super) type Frame = [[f64; 3]; 3];

/// Constants of the fit.
#[derive(Debug)]
pub(super) struct Frames {
    /// (unknowns): neighbours, filled up with the coordinate itself.
    neighbours: Vec<[u32; MOST]>,
    /// (unknowns): weight vectors, F = Σ (x_j − x_i) w_jᵀ.
    weights: Vec<[[f64; 3]; MOST]>,
}

impl Frames {
    /// Of the coordinates that can move. One whose neighbours lie in a plane keeps the frame of
    /// rest.
    pub(super) fn new(matter: &Matter) -> Self {
        let adjacent = adjacent(matter);
        let (mut neighbours, mut weights) = (Vec::new(), Vec::new());
        for &coordinate in &matter.coordinate_of_unknown {
            let i = coordinate as usize;
            let here = matter.rest[i];
            let mut near: Vec<(f64, u32)> = adjacent[i]
                .iter()
                .map(|&j| ((matter.rest[j as usize] - here).norm(), j))
                .filter(|entry| entry.0 > 0.0)
                .collect();
            near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let (chosen, fit) = choose(&near, here, &matter.rest);
            let mut all = [coordinate; MOST];
            let mut vectors = [[0.0; 3]; MOST];
            for (k, &&j) in chosen.iter().enumerate() {
                let edge = matter.rest[j as usize] - here;
                let vector = fit * (edge / edge.norm_squared());
                all[k] = j;
                vectors[k] = [vector.x, vector.y, vector.z];
            }
            neighbours.push(all);
            weights.push(vectors);
        }
        Self {
            neighbours,
            weights,
        }
    }

    /// Writes the frame of every unknown (unknowns) at `places` (coordinates).
    pub(super) fn fit(&self, matter: &Matter, places: &[Lane], frames: &mut [Frame]) {
        let all = self.neighbours.iter().zip(&self.weights).zip(frames);
        for (((neighbours, weights), frame), &c) in all.zip(&matter.coordinate_of_unknown) {
            let here = places[c as usize];
            let mut gradient = [[0.0; 3]; 3];
            for (&j, weight) in neighbours.iter().zip(weights) {
                let there = places[j as usize];
                for (r, row) in gradient.iter_mut().enumerate() {
                    let edge = there[r] - here[r];
                    for (value, w) in row.iter_mut().zip(weight) {
                        *value += edge * w;
                    }
                }
            }
            *frame = rotation(&gradient);
        }
    }
}

/// Up to [`MOST`] neighbours and the inverse of their moments; none where they span no space.
fn choose<'a>(near: &'a [(f64, u32)], here: Point3, rest: &[Point3]) -> (Vec<&'a u32>, Matrix3) {
    /// Least part of the largest moment that the smallest may be.
    const FLAT: f64 = 0.05;
    let moments = |chosen: &[&u32]| {
        chosen.iter().fold(Matrix3::zeros(), |sum, &&j| {
            let edge = rest[j as usize] - here;
            sum + edge * edge.transpose() / edge.norm_squared()
        })
    };
    let spread = |chosen: &[&u32]| {
        let values = moments(chosen).symmetric_eigenvalues();
        values.min() / values.max().max(f64::MIN_POSITIVE)
    };
    let mut chosen: Vec<&u32> = near.iter().take(MOST).map(|entry| &entry.1).collect();
    if chosen.len() < 3 {
        return (Vec::new(), Matrix3::zeros());
    }
    // The nearest may lie in a plane; the last of them then gives way to one that leaves it.
    let mut more = near.iter().skip(MOST).map(|entry| &entry.1);
    while spread(&chosen) < FLAT {
        let Some(next) = more.next() else {
            return (Vec::new(), Matrix3::zeros());
        };
        let mut tried = chosen.clone();
        tried[MOST - 1] = next;
        if spread(&tried) > spread(&chosen) {
            chosen = tried;
        }
    }
    let fit = moments(&chosen).try_inverse();
    match fit {
        Some(fit) => (chosen, fit),
        None => (Vec::new(), Matrix3::zeros()),
    }
}

/// Coordinates that the law couples to each, ascending.
pub(super) fn adjacent(matter: &Matter) -> Vec<Vec<u32>> {
    let mut adjacent = vec![Vec::new(); matter.rest.len()];
    let mut join = |a: u32, b: u32| {
        if a != b {
            adjacent[a as usize].push(b);
            adjacent[b as usize].push(a);
        }
    };
    match &matter.map {
        NodeMap::Same => matter.law_edges().iter().for_each(|&(a, b, _)| join(a, b)),
        NodeMap::Sparse(map) => {
            for node in 0..map.rows() {
                let (columns, _) = map.row(node);
                for (k, &a) in columns.iter().enumerate() {
                    columns[..k].iter().for_each(|&b| join(a, b));
                }
            }
        }
    }
    for list in &mut adjacent {
        list.sort_unstable();
        list.dedup();
    }
    adjacent
}

const IDENTITY: Frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The rotation nearest to a matrix given by rows.
pub(super) fn rotation(gradient: &Frame) -> Frame {
    let mut x = *gradient;
    for _ in 0..STEPS {
        // Rows of the cofactor matrix; the inverse transposed is it over the determinant.
        let cofactors = [cross(x[1], x[2]), cross(x[2], x[0]), cross(x[0], x[1])];
        let determinant = dot(x[0], cofactors[0]);
        if !DETERMINANTS.contains(&determinant) {
            return frame_of_columns(gradient);
        }
        let inverse = 0.5 / determinant;
        for (row, cofactor) in x.iter_mut().zip(cofactors) {
            for (value, c) in row.iter_mut().zip(cofactor) {
                *value = 0.5 * *value + inverse * c;
            }
        }
    }
    x
}

/// The first two columns made orthonormal (Gram & Schmidt); rest's own frame where they are
/// parallel.
fn frame_of_columns(gradient: &Frame) -> Frame {
    let column = |k: usize| Vector3::new(gradient[0][k], gradient[1][k], gradient[2][k]);
    let (Some(first), second) = (column(0).try_normalize(1e-9), column(1)) else {
        return IDENTITY;
    };
    let Some(third) = first.cross(&second).try_normalize(1e-9) else {
        return IDENTITY;
    };
    let second = third.cross(&first);
    std::array::from_fn(|r| [first[r], second[r], third[r]])
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::{Random, Rotation};

    #[test]
    fn a_turned_and_stretched_neighbourhood_gives_its_rotation() {
        let mut random = Random(5);
        for _ in 0..200 {
            let turn = Rotation::from_scaled_axis(random.vector() * 3.0);
            let stretch = random.vector().map(|x| 1.0 + 0.3 * x);
            let axes = Rotation::from_scaled_axis(random.vector()).to_rotation_matrix();
            let strain =
                axes.matrix() * Matrix3::from_diagonal(&stretch) * axes.matrix().transpose();
            let wanted = turn.to_rotation_matrix();
            let given = wanted.matrix() * strain;
            let rows = std::array::from_fn(|r| std::array::from_fn(|c| given[(r, c)]));
            let found = rotation(&rows);
            for r in 0..3 {
                for c in 0..3 {
                    // ½ (σ − 1)² three times over, from σ = 0.7.
                    assert!((found[r][c] - wanted.matrix()[(r, c)]).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn flat_inverted_and_missing_neighbourhoods_give_rotations_all_the_same() {
        let cases = [
            [[0.0; 3]; 3],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
            [[1e30, 1.0, 0.0], [0.0, 1e-30, 5.0], [0.0, 0.0, 3.0]],
            [[2.0, 2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 2.0, 0.0]],
        ];
        for gradient in cases {
            let [a, b, c] = rotation(&gradient);
            for row in [a, b, c] {
                assert!((dot(row, row) - 1.0).abs() < 1e-9, "{gradient:?}");
            }
            assert!((dot(a, cross(b, c)) - 1.0).abs() < 1e-9, "{gradient:?}");
        }
    }
}
