//! The tangent of backward Euler, `M / dt² + (1 + d / dt) K`, in 3 × 3 blocks of coordinates, and what is added for
//! springs.
//!
//! Springs alone are soft against turning (cells that are long and thin, light nodes). What their tension adds there is
//! met by a share of a Laplacian, as large as slow motions allow: it resists turning too, as if the body were heavier.

use super::elements::{Place, Weight};
use super::matter::Matter;
use super::neighbours::middle;
use super::node_map::NodeMap;
use palpate_geometry::math::{BlockTriplets, Matrix3, SymmetricTriplets, Vector3};
use std::collections::BTreeMap;

/// Shares of the firm Laplacian: at most in the tangent of rest, and in the firmer one.
const MOST_SHARE: f64 = 0.5;
const FIRM_SHARE: f64 = 1.0;
/// Of the middle length: edges shorter than this have a larger share.
const SHORT: f64 = 0.5;
/// The largest share of a short edge.
const SHORT_SHARE: f64 = 1.0;
/// How much the share may add to the inertia of turning: slow swings become longer by half of it.
const ADDED_INERTIA: f64 = 0.01;
/// A beam's slowest swing turns its parts more than turning as a whole does, for the same kinetic
/// energy; measured on beams of 12 to 16 cells.
const SWING: f64 = 4.4;

/// Edges of the firm Laplacian, (nodes, nodes, N/m).
pub(super) struct Firm {
    /// What they carry in the tangent of rest.
    pub rest: Vec<(u32, u32, f64)>,
    /// And in the firmer one.
    pub firmer: Vec<(u32, u32, f64)>,
    /// What short ones carry more than others in the tangent of rest.
    pub short: Vec<(u32, u32, f64)>,
}

/// The firm Laplacian in the matrices of a lattice.
///
/// Edges have the same share, except that short ones have more, by the square of the
/// middle length over theirs: they add no more to the inertia of turning, and it is there (poles) that
/// the frames of neighbours differ most against their distance.
pub(super) fn firm(matter: &Matter) -> Firm {
    let nodes = matter.map.nodes(&matter.rest);
    let dt = matter.settings.dt_s;
    let (mut at, mut weight) = (Vector3::zeros(), 0.0);
    for (c, place) in matter.rest.iter().enumerate() {
        if matter.is_free() || matter.unknown(c).is_none() {
            at += place.coords * matter.masses[c];
            weight += matter.masses[c];
        }
    }
    let centre = at / weight;
    let inertia: f64 = (matter.masses.iter().zip(&matter.rest))
        .map(|(m, place)| m * (place.coords - centre).norm_squared())
        .sum();
    let edges = matter.law.edges(Weight::Firm);
    let squares: Vec<f64> = (edges.iter())
        .map(|&(a, b, _)| (nodes[a as usize] - nodes[b as usize]).norm_squared())
        .collect();
    let middle = middle(&squares);
    let boost = |square: f64| (SHORT * SHORT * middle / square.max(f64::MIN_POSITIVE)).max(1.0);
    let share = |least: f64, most: f64, square: f64| (least * boost(square)).min(most);
    // Turning about each axis at 1 rad/s adds up to |r|² twice.
    let heavier = |least: f64| {
        let each = edges.iter().zip(&squares);
        let turning: f64 = each
            .map(|(&(_, _, k), &square)| k * square * share(least, SHORT_SHARE, square))
            .sum();
        SWING * turning * dt * dt / inertia
    };
    // The largest share that makes turning no heavier than allowed, by bisection.
    let (mut low, mut high) = (0.0, MOST_SHARE);
    for _ in 0..60 {
        let share = 0.5 * (low + high);
        match heavier(share) <= ADDED_INERTIA {
            true => low = share,
            false => high = share,
        }
    }
    let carried = |least: f64| -> Vec<(u32, u32, f64)> {
        let each = edges.iter().zip(&squares);
        each.map(|(&(a, b, k), &square)| (a, b, k * share(least, SHORT_SHARE, square)))
            .collect()
    };
    let short = edges
        .iter()
        .zip(&squares)
        .filter_map(|(&(a, b, k), &square)| {
            let more = share(low, SHORT_SHARE, square) - low;
            (more > 0.0).then_some((a, b, k * more))
        });
    Firm {
        rest: carried(low),
        firmer: carried(FIRM_SHARE),
        short: short.collect(),
    }
}

/// Adds what edges carry to blocks of the coordinates that can move.
pub(super) fn add_edges(matter: &Matter, edges: &[(u32, u32, f64)], to: &mut BlockTriplets) {
    let scale = matter.voigt();
    let mut scalar = SymmetricTriplets::new(to.n);
    let edges: Vec<_> = edges.iter().map(|&(a, b, k)| (a, b, k * scale)).collect();
    (matter.map).add_edges(&edges, |c| matter.unknown(c as usize), &mut scalar);
    for &(i, j, value) in &scalar.entries {
        let block = Matrix3::from_diagonal_element(value);
        to.add(i as usize, j as usize, block);
    }
}

/// The tangent at a place, in blocks of the coordinates that can move.
pub(super) fn at(matter: &Matter, place: &Place<'_>) -> BlockTriplets {
    let dt = matter.settings.dt_s;
    let scale = 1.0 + matter.damping_s / dt;
    let mut matrix = BlockTriplets::new(matter.unknown_count());
    for (row, &coordinate) in matter.coordinate_of_unknown.iter().enumerate() {
        let share = matter.masses[coordinate as usize] / (dt * dt);
        matrix.add(row, row, Matrix3::from_diagonal_element(share));
    }
    match &matter.map {
        NodeMap::Same => {
            matter.law.tangent_at(place, &mut |a, b, block| {
                let (a, b) = (matter.unknown(a as usize), matter.unknown(b as usize));
                if let (Some(a), Some(b)) = (a, b) {
                    matrix.add(a, b, block * scale);
                }
            });
            matter
                .law
                .shared_at(place.places, &mut |growth, stiffness| {
                    let of_coordinates = growth.iter().copied();
                    each_product(
                        matter,
                        of_coordinates,
                        stiffness * scale,
                        &mut |i, j, block| {
                            matrix.add(i, j, block);
                        },
                    );
                });
        }
        NodeMap::Sparse(map) => {
            // Many small products meet in each block of coordinates: gathered row by row.
            let mut sums: Vec<BTreeMap<usize, Matrix3>> = vec![BTreeMap::new(); matrix.n];
            let mut of_nodes: BTreeMap<(u32, u32), Matrix3> = BTreeMap::new();
            matter.law.tangent_at(place, &mut |a, b, block| {
                *of_nodes.entry((a, b)).or_insert_with(Matrix3::zeros) += block;
            });
            for (&(a, b), block) in &of_nodes {
                let (left, left_weights) = map.row(a as usize);
                let (right, right_weights) = map.row(b as usize);
                for (&i, u) in left.iter().zip(left_weights) {
                    let Some(i) = matter.unknown(i as usize) else {
                        continue;
                    };
                    for (&j, w) in right.iter().zip(right_weights) {
                        let Some(j) = matter.unknown(j as usize) else {
                            continue;
                        };
                        let part = block * (u * w * scale);
                        let mut add = |i: usize, j: usize, part: Matrix3| {
                            if i >= j {
                                *sums[i].entry(j).or_insert_with(Matrix3::zeros) += part;
                            }
                        };
                        add(i, j, part);
                        if a != b {
                            add(j, i, part.transpose());
                        }
                    }
                }
            }
            matter
                .law
                .shared_at(place.places, &mut |growth, stiffness| {
                    let of_nodes = growth.iter().map(|&(node, gradient)| {
                        let (coordinates, weights) = map.row(node as usize);
                        (gradient, coordinates.iter().zip(weights))
                    });
                    let of_coordinates = of_nodes
                        .flat_map(|(gradient, row)| row.map(move |(&c, &w)| (c, gradient * w)));
                    each_product(
                        matter,
                        of_coordinates,
                        stiffness * scale,
                        &mut |i, j, block| {
                            *sums[i].entry(j).or_insert_with(Matrix3::zeros) += block;
                        },
                    );
                });
            for (i, row) in sums.into_iter().enumerate() {
                for (j, block) in row {
                    matrix.add(i, j, block);
                }
            }
        }
    }
    matrix
}

/// Hands out the lower blocks of k g gᵀ by unknowns, g given by coordinate in parts.
fn each_product(
    matter: &Matter,
    parts: impl Iterator<Item = (u32, Vector3)>,
    stiffness: f64,
    out: &mut impl FnMut(usize, usize, Matrix3),
) {
    let mut gradient: BTreeMap<usize, Vector3> = BTreeMap::new();
    for (coordinate, part) in parts {
        if let Some(unknown) = matter.unknown(coordinate as usize) {
            *gradient.entry(unknown).or_insert_with(Vector3::zeros) += part;
        }
    }
    for (&i, a) in &gradient {
        for (&j, b) in gradient.range(..=i) {
            out(i, j, a * b.transpose() * stiffness);
        }
    }
}
