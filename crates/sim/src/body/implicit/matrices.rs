//! The matrices of a step and their factors, at build.

use super::{TAUT, Tangent, WATCHED, WATCHED_OF_SHEETS, WILD_LENGTH};
use crate::body::elements::Weight;
use crate::body::frames::Frames;
use crate::body::matter::Matter;
use crate::body::neighbours::{middle, shortest_edges};
use crate::body::scalar_factor::ScalarFactor;
use crate::body::settings::DeformableError;
use crate::body::tangent;
use palpate_geometry::math::{BlockCholesky, BlockTriplets, Point3, SymmetricTriplets};

/// Most stiffness over inertia for which a factor in single precision is good.
const MOST_STIFF: f64 = 1e5;

/// Where the unknowns are at rest.
pub(super) fn places(matter: &Matter) -> Vec<Point3> {
    let unknowns = matter.coordinate_of_unknown.iter();
    unknowns.map(|&c| matter.rest[c as usize]).collect()
}

/// The factor above every tangent.
pub(super) fn bounding(matter: &Matter) -> Result<ScalarFactor, DeformableError> {
    let matrix = scalar_matrix(matter, &matter.law.edges(Weight::Bounding));
    Ok(ScalarFactor::new(&matrix, &places(matter))?)
}

/// True where rounding of the stiffest rows to single precision would disturb the motion of all;
/// `diagonal` is that of the matrix, N/m.
pub(super) fn is_too_stiff(matter: &Matter, diagonal: &[f64]) -> bool {
    let dt = matter.settings.dt_s;
    let mean_kg = matter.masses.iter().sum::<f64>() / matter.masses.len() as f64;
    let stiffness = diagonal.iter().copied().fold(0.0, f64::max) * dt * dt / mean_kg;
    stiffness.is_nan() || stiffness > MOST_STIFF
}

/// The tangent of rest with its factor, if it has one of at most so many numbers that single precision
/// can hold.
pub(super) fn tangent_of(matter: &Matter, most: usize) -> Option<Tangent> {
    let (matrices, short) = match matter.law.is_solid() {
        true => of_solid(matter),
        false => (of_sheet(matter), Vec::new()),
    };
    let matrix = matrices.first()?;
    let mut stiffest = vec![0.0; matrix.n];
    for (i, j, block) in &matrix.entries {
        if i == j {
            stiffest[*i as usize] += block.trace() / 3.0;
        }
    }
    if is_too_stiff(matter, &stiffest) {
        return None;
    }
    let places = places(matter);
    let mut factors = vec![BlockCholesky::placed(matrix, &places, most).ok()??];
    for matrix in &matrices[1..] {
        factors.push(BlockCholesky::placed(matrix, &places, usize::MAX).ok()??);
    }
    let edges = shortest_edges(matter);
    let wild_m = WILD_LENGTH * middle(&edges);
    let least = match matter.law.is_solid() {
        true => WATCHED,
        false => WATCHED_OF_SHEETS,
    };
    let watched = |&c: &u32| least.map(|share| share * edges[c as usize]);
    Some(Tangent {
        factors,
        sheet: !matter.law.is_solid(),
        frames: Frames::new(matter),
        bounding: bounding(matter).ok()?,
        watched_m: matter.coordinate_of_unknown.iter().map(watched).collect(),
        wild_m,
        short,
    })
}

/// The tangent of rest and a firmer one, and the Laplacian of what short edges carry beyond others.
fn of_solid(matter: &Matter) -> (Vec<BlockTriplets>, Vec<(u32, u32, f64)>) {
    let firm = tangent::firm(matter);
    let matrices = [
        (&firm.rest, tangent::STRAINS[0]),
        (&firm.firmer, tangent::STRAINS[1]),
    ]
    .map(|(edges, strain)| tangent::at_rest(matter, &tangent::of_law(matter, strain), edges));
    let mut short = SymmetricTriplets::new(matter.unknown_count());
    (matter.map).add_edges(&firm.short, |c| matter.unknown(c as usize), &mut short);
    (matrices.into(), short.entries)
}

/// The tangent of rest with each tension.
fn of_sheet(matter: &Matter) -> Vec<BlockTriplets> {
    let law = tangent::of_law(matter, 0.0);
    let drawn = TAUT.map(|taut| tangent::at_rest(matter, &law, &matter.law.taut_edges(taut)));
    drawn.into()
}

/// M / dt² + (1 + d / dt) Wᵀ L W.
pub(super) fn scalar_matrix(matter: &Matter, edges: &[(u32, u32, f64)]) -> SymmetricTriplets {
    let (dt, damping_s) = (matter.settings.dt_s, matter.damping_s);
    let mut matrix = SymmetricTriplets::new(matter.unknown_count());
    for (row, &coordinate) in matter.coordinate_of_unknown.iter().enumerate() {
        matrix.add(row, row, matter.masses[coordinate as usize] / (dt * dt));
    }
    let scaled: Vec<_> = edges
        .iter()
        .map(|&(a, b, k)| (a, b, k * (1.0 + damping_s / dt)))
        .collect();
    matter
        .map
        .add_edges(&scaled, |c| matter.unknown(c as usize), &mut matrix);
    matrix
}
