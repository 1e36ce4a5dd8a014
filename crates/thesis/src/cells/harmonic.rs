//! Interior nodes of a lattice from its outermost ones: each is the mean of its six neighbours.
//!
//! The discrete Laplace equation with given values on the faces, solved exactly: sines diagonalise
//! the second difference along each axis (Buzbee, Golub, Nielson 1970), so three dense products per
//! axis do, O(n⁴) for n³ nodes. The map is what transfinite interpolation tends to when it is
//! smoothed for ever, so it needs no such start.

use super::cube::{CubeLattice, is_outermost, node_at};
use palpate_geometry::math::Vector3;

/// Places the nodes that are not on a face of the lattice.
pub(super) fn fill(lattice: &mut CubeLattice) {
    let counts = lattice.counts;
    if counts.iter().any(|&n| n < 3) {
        return;
    }
    let inner = counts.map(|n| n - 2);
    // What the faces give to their neighbours inside; also the buffer of all products.
    let mut values = Vec::with_capacity(inner.iter().product());
    for i in 1..=inner[0] {
        for j in 1..=inner[1] {
            for k in 1..=inner[2] {
                let mut sum = Vector3::zeros();
                for axis in 0..3 {
                    for side in [-1, 1] {
                        let mut place = [i, j, k];
                        place[axis] = place[axis].wrapping_add_signed(side);
                        if is_outermost(counts, place) {
                            sum += lattice.grid.nodes[node_at(counts, place)].coords;
                        }
                    }
                }
                values.push(sum);
            }
        }
    }
    let sines = inner.map(Sines::new);
    transform(&sines, inner, &mut values);
    for (node, value) in values.iter_mut().enumerate() {
        let place = [
            node / (inner[1] * inner[2]),
            node / inner[2] % inner[1],
            node % inner[2],
        ];
        let eigenvalue: f64 = (0..3)
            .map(|axis| sines[axis].eigenvalues[place[axis]])
            .sum();
        *value /= eigenvalue;
    }
    transform(&sines, inner, &mut values);
    let mut values = values.into_iter();
    for i in 1..=inner[0] {
        for j in 1..=inner[1] {
            for k in 1..=inner[2] {
                let Some(value) = values.next() else { return };
                lattice.grid.nodes[node_at(counts, [i, j, k])] = value.into();
            }
        }
    }
}

/// Eigenvectors and eigenvalues of −(second difference) on n nodes between two fixed ones.
struct Sines {
    /// (n × n), symmetric and its own inverse.
    matrix: Vec<f64>,
    /// (n), 2 − 2 cos(π m / (n + 1)).
    eigenvalues: Vec<f64>,
}

impl Sines {
    fn new(n: usize) -> Self {
        let step = std::f64::consts::PI / (n + 1) as f64;
        let scale = (2.0 / (n + 1) as f64).sqrt();
        // Products are reduced to the first period, so that large ones lose nothing.
        let sine = |m: usize| scale * libm::sin(step * (m % (2 * (n + 1))) as f64);
        let matrix = (0..n * n)
            .map(|k| sine((k / n + 1) * (k % n + 1)))
            .collect();
        let eigenvalues = (1..=n)
            .map(|m| {
                let half = libm::sin(0.5 * step * m as f64);
                4.0 * half * half
            })
            .collect();
        Self {
            matrix,
            eigenvalues,
        }
    }
}

/// Multiplies along each of the three axes.
fn transform(sines: &[Sines; 3], counts: [usize; 3], values: &mut [Vector3]) {
    for axis in 0..3 {
        let n = counts[axis];
        let stride: usize = counts[axis + 1..].iter().product();
        let mut line = vec![Vector3::zeros(); n];
        for start in (0..values.len()).filter(|start| (start / stride).is_multiple_of(n)) {
            for (m, slot) in line.iter_mut().enumerate() {
                let row = &sines[axis].matrix[m * n..(m + 1) * n];
                let mut sum = Vector3::zeros();
                for (k, weight) in row.iter().enumerate() {
                    sum += values[start + k * stride] * *weight;
                }
                *slot = sum;
            }
            for (k, value) in line.iter().enumerate() {
                values[start + k * stride] = *value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cube::place_of;
    use super::*;
    use palpate_geometry::math::Point3;

    #[test]
    fn every_interior_node_is_the_mean_of_its_neighbours() {
        for counts in [[3, 3, 3], [4, 7, 5], [12, 12, 12], [2, 5, 5], [31, 3, 4]] {
            let mut state = 11_u64;
            let mut random = || {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1u64 << 53) as f64
            };
            let mut lattice = CubeLattice::new(counts, |_| {
                (Point3::new(random(), random(), random()), None)
            })
            .unwrap();
            let before = lattice.grid.nodes.clone();
            fill(&mut lattice);
            for node in 0..before.len() {
                let place = place_of(counts, node);
                let x = lattice.grid.nodes[node];
                if is_outermost(counts, place) {
                    assert_eq!(x, before[node], "a node of a face moved");
                    continue;
                }
                let mut mean = Vector3::zeros();
                for axis in 0..3 {
                    for side in [-1, 1] {
                        let mut place = place;
                        place[axis] = place[axis].wrapping_add_signed(side);
                        mean += lattice.grid.nodes[node_at(counts, place)].coords / 6.0;
                    }
                }
                // Six dense products of up to 30 terms of size 1.
                assert!(
                    (x.coords - mean).norm() < 1e-13,
                    "{counts:?}, node {place:?}: {}",
                    (x.coords - mean).norm()
                );
            }
        }
    }

    #[test]
    fn a_box_stays_evenly_divided() {
        let even = CubeLattice::cuboid(
            &Point3::new(1.0, 2.0, 3.0),
            &Point3::new(2.0, 5.0, 3.5),
            [9, 6, 11],
        )
        .unwrap();
        let mut filled = even.clone();
        for node in 0..filled.grid.nodes.len() {
            if !is_outermost(even.counts, place_of(even.counts, node)) {
                filled.grid.nodes[node] = Point3::origin();
            }
        }
        fill(&mut filled);
        for (a, b) in even.grid.nodes.iter().zip(&filled.grid.nodes) {
            assert!((a - b).norm() < 1e-13);
        }
        let quality = even.quality();
        assert!(
            (quality.least_scaled_jacobian - 1.0).abs() < 1e-12
                && (quality.volume_m3 - 1.5).abs() < 1e-12
        );
    }
}
