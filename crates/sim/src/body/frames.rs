//! How far each coordinate's neighbourhood has turned since rest: rotations that carry the tangent
//! of rest along (stiffness warping, Müller et al. 2002).
//!
//! The deformation gradient is fitted to the edges to a few neighbours; the rotation is its polar
//! part by Newton's method (Higham 1986), made orthonormal. Only the matrix of the step uses it, so it need
//! not be the nearest rotation, but it must be one whatever the positions are.

use super::frame::{Frame, IDENTITY};
use super::matter::Matter;
use super::neighbours::{adjacent, middle, shortest_edges};
use super::node_map::NodeMap;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3, simd};
use std::collections::{BTreeMap, BTreeSet};

/// Neighbours of a coordinate, at most.
const MOST: usize = 8;
/// Least part of the largest moment of neighbours that the smallest may be.
const FLAT: f64 = 0.05;
/// Newton steps: a stretch of 1.3 is off by 1e-7 after three.
const STEPS: usize = 3;
/// Deformation gradients with a determinant outside of this range have no use for Newton's method.
const DETERMINANTS: std::ops::Range<f64> = 0.05..20.0;

/// Constants of the fit.
#[derive(Debug)]
pub(super) struct Frames {
    blocks: Vec<Block>,
}

/// Four unknowns side by side; the last block is filled up with coordinate 0 and no weights.
#[derive(Clone, Debug)]
struct Block {
    here: [u32; 4],
    /// Filled up with the coordinate itself.
    neighbours: [[u32; 4]; MOST],
    /// F = Σ (x_j − x_i) w_jᵀ.
    weights: [[Four; 3]; MOST],
    /// At rest, where neighbours are taken to lie in a plane; else zero.
    normals: [Four; 3],
    /// Any of them does.
    flat: bool,
}

/// F = Σ (x_j − x_i) w_jᵀ of a coordinate i.
#[derive(Clone, Debug)]
struct Fit {
    here: u32,
    edges: Vec<(u32, Vector3)>,
    /// Of the plane that the neighbours are taken to lie in, or zero.
    normal: Vector3,
}

impl Fit {
    /// Of neighbours with their weights, the best first. `None` where they lie nearly in a plane.
    fn new(i: usize, near: &[(u32, f64)], rest: &[Point3]) -> Option<Self> {
        let here = rest[i];
        let (chosen, inverse) = choose(near, here, rest)?;
        let edges =
            (chosen.iter()).map(|&(j, weight)| (j, inverse * (rest[j as usize] - here) * weight));
        Some(Self {
            here: i as u32,
            edges: edges.collect(),
            normal: Vector3::zeros(),
        })
    }

    /// Of a sheet: what leaves the plane of the nearest neighbours is left out, and the sheet's normal
    /// goes with what they span. `None` where they lie nearly in a line.
    fn of_sheet(i: usize, near: &[(f64, u32)], rest: &[Point3]) -> Option<Self> {
        let edges = || {
            let nearest = near.iter().take(MOST);
            nearest.map(|&(_, j)| (j, rest[j as usize] - rest[i]))
        };
        let moments = edges().fold(Matrix3::zeros(), |sum, (_, edge)| {
            sum + edge * edge.transpose()
        });
        let eigen = moments.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let [flat, small, large] = order;
        let breadth = eigen.eigenvalues[small] / eigen.eigenvalues[large];
        if breadth.is_nan() || breadth <= FLAT {
            return None;
        }
        let axis = |k: usize| eigen.eigenvectors.column(k).into_owned();
        let weight = |edge: Vector3| {
            let along = |k: usize| axis(k) * (axis(k).dot(&edge) / eigen.eigenvalues[k]);
            along(small) + along(large)
        };
        Some(Self {
            here: i as u32,
            edges: edges().map(|(j, edge)| (j, weight(edge))).collect(),
            normal: axis(flat),
        })
    }
}

/// The fit of a coordinate, or of the nearest one that has any: what is too thin to show how it turns
/// turns with what it hangs on.
fn nearest<'a>(
    i: usize,
    fits: &'a [Option<Fit>],
    adjacent: &[Vec<u32>],
    rest: &[Point3],
) -> Option<&'a Fit> {
    if fits[i].is_some() {
        return fits[i].as_ref();
    }
    let mut seen = BTreeSet::from([i as u32]);
    let mut front = vec![i as u32];
    while !front.is_empty() {
        let mut next: Vec<u32> = Vec::new();
        for &from in &front {
            next.extend(adjacent[from as usize].iter().filter(|&&j| seen.insert(j)));
        }
        let distance = |fit: &Fit| (rest[fit.here as usize] - rest[i]).norm_squared();
        let found = next.iter().filter_map(|&j| fits[j as usize].as_ref());
        if let Some(fit) = found.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
            return Some(fit);
        }
        front = next;
    }
    None
}

impl Block {
    fn set(&mut self, lane: usize, fit: &Fit) {
        self.here[lane] = fit.here;
        for (normals, value) in self.normals.iter_mut().zip(fit.normal.iter()) {
            normals[lane] = *value;
        }
        self.flat |= fit.normal != Vector3::zeros();
        for (k, neighbours) in self.neighbours.iter_mut().enumerate() {
            let (j, vector) = fit
                .edges
                .get(k)
                .copied()
                .unwrap_or((fit.here, Vector3::zeros()));
            neighbours[lane] = j;
            for (weight, value) in self.weights[k].iter_mut().zip(vector.iter()) {
                weight[lane] = *value;
            }
        }
    }

    const EMPTY: Self = Self {
        here: [0; 4],
        neighbours: [[0; 4]; MOST],
        weights: [[[0.0; 4]; 3]; MOST],
        normals: [[0.0; 4]; 3],
        flat: false,
    };
}

impl Frames {
    /// Of the coordinates that can move. One whose neighbours lie in a plane keeps the frame of
    /// rest.
    pub(super) fn new(matter: &Matter) -> Self {
        let adjacent = adjacent(matter);
        let rest = &matter.rest;
        // Springs alone resist no turning of small parts: only long edges show how these turn, and
        // weigh most. Of cells the nearest are the better witnesses.
        let (reach_m, weight): (f64, fn(f64) -> f64) = match matter.law.springs.len() {
            0 => (0.0, |square| 1.0 / square),
            _ => (middle(&shortest_edges(matter)), |_| 1.0),
        };
        let stiffness = Stiffness::of(matter);
        let fits: Vec<Option<Fit>> = (0..rest.len())
            .map(|i| {
                let near = neighbourhood(i, &adjacent, rest, reach_m);
                if !matter.law.is_solid() {
                    return Fit::of_sheet(i, &near, rest);
                }
                let weigh = |j: u32| weight((rest[j as usize] - rest[i]).norm_squared());
                let near = near.into_iter().map(|(_, j)| (j, weigh(j)));
                Fit::new(i, &stiffness.weighed(i, near.collect()), rest)
            })
            .collect();
        let mut blocks = Vec::with_capacity(matter.unknown_count().div_ceil(4));
        for four in matter.coordinate_of_unknown.chunks(4) {
            let mut block = Block::EMPTY;
            for (lane, &coordinate) in four.iter().enumerate() {
                if let Some(fit) = nearest(coordinate as usize, &fits, &adjacent, rest) {
                    block.set(lane, fit);
                }
            }
            blocks.push(block);
        }
        Self { blocks }
    }

    /// Writes the frame of every unknown (unknowns) at `places` (coordinates).
    pub(super) fn fit(&self, places: &[Lane], frames: &mut [Frame]) {
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { fit_wide(&self.blocks, places, frames) };
        }
        fit_in::<Baseline>(&self.blocks, places, frames);
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn fit_wide(blocks: &[Block], places: &[Lane], frames: &mut [Frame]) {
    fit_in::<palpate_geometry::math::lanes::Wide>(blocks, places, frames);
}

// No closures: they would be compiled without the registers of the caller.
#[inline(always)]
fn fit_in<L: Lanes>(blocks: &[Block], places: &[Lane], frames: &mut [Frame]) {
    for (block, frames) in blocks.iter().zip(frames.chunks_mut(4)) {
        let here = load(&block.here, places);
        let mut gradient = [[L::splat(0.0); 3]; 3];
        for (neighbours, weights) in block.neighbours.iter().zip(&block.weights) {
            let there = load::<L>(neighbours, places);
            let edges = [there[0] - here[0], there[1] - here[1], there[2] - here[2]];
            let weights = [
                L::load(&weights[0]),
                L::load(&weights[1]),
                L::load(&weights[2]),
            ];
            for (row, edge) in gradient.iter_mut().zip(edges) {
                for (value, w) in row.iter_mut().zip(weights) {
                    *value = *value + edge * w;
                }
            }
        }
        if block.flat {
            add_normal(block, &mut gradient);
        }
        let (turned, good) = rotations(&gradient);
        let mut rows = [[[0.0; 4]; 3]; 3];
        store(&turned, &mut rows);
        if good != 0b1111 {
            let mut given = [[[0.0; 4]; 3]; 3];
            store(&gradient, &mut given);
            repair(&given, good, &mut rows);
        }
        for (lane, frame) in frames.iter_mut().enumerate() {
            for (row, values) in frame.iter_mut().zip(&rows) {
                for (value, four) in row.iter_mut().zip(values) {
                    *value = four[lane];
                }
            }
        }
    }
}

/// Adds what the normals become to gradients of sheets: the cross product of what two vectors with that
/// normal become.
#[inline(always)]
fn add_normal<L: Lanes>(block: &Block, gradient: &mut [[L; 3]; 3]) {
    let [a, b, c] = *gradient;
    let normal = [
        L::load(&block.normals[0]),
        L::load(&block.normals[1]),
        L::load(&block.normals[2]),
    ];
    for (row, cofactor) in gradient
        .iter_mut()
        .zip([cross(b, c), cross(c, a), cross(a, b)])
    {
        let turned = dot(cofactor, normal);
        for (value, n) in row.iter_mut().zip(normal) {
            *value = *value + turned * n;
        }
    }
}

/// x, y and z of four coordinates.
#[inline(always)]
fn load<L: Lanes>(of: &[u32; 4], places: &[Lane]) -> [L; 3] {
    let rows = L::transposed([
        L::load(&places[of[0] as usize]),
        L::load(&places[of[1] as usize]),
        L::load(&places[of[2] as usize]),
        L::load(&places[of[3] as usize]),
    ]);
    [rows[0], rows[1], rows[2]]
}

#[inline(always)]
fn store<L: Lanes>(from: &[[L; 3]; 3], to: &mut [[Four; 3]; 3]) {
    for (to, from) in to.iter_mut().zip(from) {
        for (to, from) in to.iter_mut().zip(from) {
            from.store(to);
        }
    }
}

/// Replaces the frames of gradients that Newton's method has no use for.
#[cold]
fn repair(gradients: &[[Four; 3]; 3], good: u8, rows: &mut [[Four; 3]; 3]) {
    for lane in (0..4).filter(|lane| good & (1 << lane) == 0) {
        let frame = frame_of_columns(&gradients.map(|row| row.map(|value| value[lane])));
        for (to, value) in rows.iter_mut().flatten().zip(frame.as_flattened()) {
            to[lane] = *value;
        }
    }
}

/// How stiff the cells are that couple two coordinates: where moduli differ, what is soft does not show how stiff
/// matter beside it turns.
struct Stiffness {
    /// (coordinates): mean modulus of the cells that it shares with others, by those, Pa; empty for a body of one
    /// modulus.
    young_pa: Vec<BTreeMap<u32, f64>>,
}

impl Stiffness {
    fn of(matter: &Matter) -> Self {
        let is_even = matter.young_pa.windows(2).all(|two| two[0] == two[1]);
        if is_even || matter.cells.is_empty() {
            return Self {
                young_pa: Vec::new(),
            };
        }
        let mut sums = vec![BTreeMap::<u32, [f64; 2]>::new(); matter.rest.len()];
        for (cell, young_pa) in matter.cells.iter().zip(&matter.young_pa) {
            let mut shares = BTreeMap::<u32, f64>::new();
            for &node in cell {
                match &matter.map {
                    NodeMap::Same => *shares.entry(node).or_default() += 1.0,
                    NodeMap::Sparse(map) => {
                        let (columns, weights) = map.row(node as usize);
                        for (&c, w) in columns.iter().zip(weights) {
                            *shares.entry(c).or_default() += w.abs();
                        }
                    }
                }
            }
            for (&i, own) in &shares {
                for (&j, other) in shares.iter().filter(|entry| *entry.0 != i) {
                    let [weighed, share] = sums[i as usize].entry(j).or_default();
                    *weighed += own * other * young_pa;
                    *share += own * other;
                }
            }
        }
        let mean = |[weighed, share]: [f64; 2]| weighed / share;
        let means = sums.into_iter();
        Self {
            young_pa: means
                .map(|of| of.into_iter().map(|(j, sums)| (j, mean(sums))).collect())
                .collect(),
        }
    }

    /// Neighbours of a coordinate with their weights, those that stiff matter couples to it first.
    fn weighed(&self, i: usize, mut near: Vec<(u32, f64)>) -> Vec<(u32, f64)> {
        let Some(young_pa) = self.young_pa.get(i) else {
            return near;
        };
        let most_pa = young_pa.values().copied().fold(0.0, f64::max);
        let share = |j: u32| young_pa.get(&j).map_or(0.0, |young_pa| young_pa / most_pa);
        near.sort_by_key(|&(j, _)| (-libm::log10(share(j))).round() as u32);
        for (j, weight) in &mut near {
            *weight *= share(*j);
        }
        near
    }
}

/// Coordinates around one with their distances: those coupled to it, and beyond them, along others,
/// all within `reach_m`, so that where cells are much smaller than elsewhere (poles) a neighbourhood is
/// no smaller than elsewhere. Each is followed by the one farthest from all before it where there are
/// more than the nearest [`MOST`].
fn neighbourhood(
    i: usize,
    adjacent: &[Vec<u32>],
    rest: &[Point3],
    reach_m: f64,
) -> Vec<(f64, u32)> {
    let here = rest[i];
    let distance = |j: u32| (rest[j as usize] - here).norm();
    let mut near: Vec<(f64, u32)> = adjacent[i]
        .iter()
        .map(|&j| (distance(j), j))
        .filter(|entry| entry.0 > 0.0)
        .collect();
    let by_distance = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    near.sort_by(by_distance);
    if near.get(MOST - 1).is_none_or(|entry| entry.0 >= reach_m) {
        return near;
    }
    let mut seen: BTreeSet<u32> = near.iter().map(|entry| entry.1).collect();
    seen.insert(i as u32);
    let mut front: Vec<u32> = near.iter().filter(|e| e.0 < reach_m).map(|e| e.1).collect();
    while let Some(from) = front.pop() {
        for &j in &adjacent[from as usize] {
            let length = distance(j);
            if length > 0.0 && length < reach_m && seen.insert(j) {
                near.push((length, j));
                front.push(j);
            }
        }
    }
    near.sort_by(by_distance);
    // Farthest first, then ever where the largest hole is.
    let mut holes: Vec<f64> = near.iter().map(|entry| entry.0).collect();
    for k in 0..near.len().min(MOST) {
        let Some(next) = (k..near.len()).max_by(|&a, &b| holes[a].total_cmp(&holes[b])) else {
            break;
        };
        near.swap(k, next);
        holes.swap(k, next);
        let there = rest[near[k].1 as usize];
        for (hole, entry) in holes.iter_mut().zip(&near).skip(k + 1) {
            *hole = hole.min((rest[entry.1 as usize] - there).norm());
        }
    }
    near
}

/// Up to [`MOST`] neighbours and the inverse of their moments; `None` where they span no space.
fn choose(
    near: &[(u32, f64)],
    here: Point3,
    rest: &[Point3],
) -> Option<(Vec<(u32, f64)>, Matrix3)> {
    let moments = |chosen: &[(u32, f64)]| {
        chosen.iter().fold(Matrix3::zeros(), |sum, &(j, weight)| {
            let edge = rest[j as usize] - here;
            sum + edge * edge.transpose() * weight
        })
    };
    let spread = |chosen: &[(u32, f64)]| {
        let values = moments(chosen).symmetric_eigenvalues();
        values.min() / values.max().max(f64::MIN_POSITIVE)
    };
    let mut chosen: Vec<(u32, f64)> = near.iter().take(MOST).copied().collect();
    if chosen.len() < 3 {
        return None;
    }
    // The first may lie in a plane; the last of them then gives way to one that leaves it.
    let mut more = near.iter().skip(MOST);
    while spread(&chosen) < FLAT {
        let next = more.next()?;
        let mut tried = chosen.clone();
        tried[MOST - 1] = *next;
        if spread(&tried) > spread(&chosen) {
            chosen = tried;
        }
    }
    moments(&chosen)
        .try_inverse()
        .map(|inverse| (chosen, inverse))
}

#[inline(always)]
fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn unit<L: Lanes>(v: [L; 3]) -> [L; 3] {
    let scale = L::splat(1.0) / dot(v, v).sqrt();
    [v[0] * scale, v[1] * scale, v[2] * scale]
}

/// Rotations near those nearest to four matrices given by rows, and in which of them Newton's method has
/// found it.
#[inline(always)]
fn rotations<L: Lanes>(gradient: &[[L; 3]; 3]) -> ([[L; 3]; 3], u8) {
    let (mut x, mut good) = (*gradient, 0b1111);
    for _ in 0..STEPS {
        // Rows of the cofactor matrix; the inverse transposed is it over the determinant.
        let cofactors = [cross(x[1], x[2]), cross(x[2], x[0]), cross(x[0], x[1])];
        let determinant = dot(x[0], cofactors[0]);
        good &= determinant.above(L::splat(DETERMINANTS.start))
            & L::splat(DETERMINANTS.end).above(determinant);
        let inverse = L::splat(0.5) / determinant;
        for (row, cofactor) in x.iter_mut().zip(cofactors) {
            for (value, c) in row.iter_mut().zip(cofactor) {
                *value = L::splat(0.5) * *value + inverse * c;
            }
        }
    }
    // Where it is drawn or squeezed far, what three steps leave still stretches; the step's matrix would too.
    let first = unit(x[0]);
    let along = dot(x[1], first);
    let across = [
        x[1][0] - along * first[0],
        x[1][1] - along * first[1],
        x[1][2] - along * first[2],
    ];
    let second = unit(across);
    ([first, second, cross(first, second)], good)
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

#[cfg(test)]
mod tests {
    use super::super::frame::from_rest;
    use super::*;
    use palpate_geometry::math::{Random, Rotation};

    /// The frame of a body whose unknown 0 has neighbours at e_x, e_y, e_z, moved by the columns of
    /// a gradient; every processor must give the same
    /// bits.
    fn rotation(gradient: &Frame) -> Frame {
        let mut block = Block::EMPTY;
        let mut places = vec![[0.0; 4]];
        for k in 0..3 {
            block.neighbours[k] = [k as u32 + 1; 4];
            block.weights[k][k] = [1.0; 4];
            places.push([gradient[0][k], gradient[1][k], gradient[2][k], 0.0]);
        }
        let frames = Frames {
            blocks: vec![block],
        };
        let (mut found, mut plain) = ([IDENTITY; 4], [IDENTITY; 4]);
        frames.fit(&places, &mut found);
        fit_in::<Baseline>(&frames.blocks, &places, &mut plain);
        assert_eq!(found, plain);
        assert!(found.iter().all(|frame| *frame == found[0]));
        found[0]
    }

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

    // A sheet in a slanted plane, turned, and stretched within the plane: the normal turns along.
    #[test]
    fn a_turned_and_stretched_sheet_gives_its_rotation() {
        let mut random = Random(6);
        for _ in 0..200 {
            let plane = Rotation::from_scaled_axis(random.vector());
            let rest: Vec<Point3> = (0..7)
                .map(|k| match k {
                    0 => Point3::origin(),
                    k => {
                        let angle = f64::from(k) + 0.2 * random.unit();
                        plane * Point3::new(libm::cos(angle), libm::sin(angle), 0.0)
                    }
                })
                .collect();
            let near: Vec<(f64, u32)> = (1..7).map(|k| (1.0, k)).collect();
            let fit = Fit::of_sheet(0, &near, &rest).unwrap();
            let mut block = Block::EMPTY;
            (0..4).for_each(|lane| block.set(lane, &fit));
            let frames = Frames {
                blocks: vec![block],
            };
            let turn = Rotation::from_scaled_axis(random.vector() * 3.0);
            let stretch = Vector3::new(1.0 + 0.2 * random.unit(), 1.0 - 0.2 * random.unit(), 1.0);
            let places: Vec<Lane> = rest
                .iter()
                .map(|p| {
                    let flat = (plane.inverse() * p).coords.component_mul(&stretch);
                    let at = turn * (plane * flat);
                    [at.x, at.y, at.z, 0.0]
                })
                .collect();
            let (mut found, mut plain) = ([IDENTITY; 4], [IDENTITY; 4]);
            frames.fit(&places, &mut found);
            fit_in::<Baseline>(&frames.blocks, &places, &mut plain);
            assert_eq!(found, plain);
            let wanted = turn.to_rotation_matrix();
            for r in 0..3 {
                for c in 0..3 {
                    // ½ (σ − 1)² three times over, from σ of 0.64 to 1.44.
                    assert!((found[0][r][c] - wanted.matrix()[(r, c)]).abs() < 1e-4);
                }
            }
            let own = plane * Vector3::z();
            let [x, y, z, _] = from_rest(&found[3], &[own.x, own.y, own.z, 0.0]);
            let normal = turn * own;
            assert!(Vector3::new(x, y, z).cross(&normal).norm() < 1e-4);
        }
    }

    #[test]
    fn neighbours_in_a_line_show_no_plane() {
        let rest: Vec<Point3> = (0..5)
            .map(|k| Point3::new(f64::from(k), 1e-3 * f64::from(k * k), 0.0))
            .collect();
        let near: Vec<(f64, u32)> = (1..5).map(|k| (f64::from(k), k)).collect();
        assert!(Fit::of_sheet(0, &near, &rest).is_none());
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
                assert!(
                    (Vector3::from(row).norm() - 1.0).abs() < 1e-9,
                    "{gradient:?}"
                );
            }
            let volume = Vector3::from(a).dot(&Vector3::from(b).cross(&Vector3::from(c)));
            assert!((volume - 1.0).abs() < 1e-9, "{gradient:?}");
        }
    }
}
