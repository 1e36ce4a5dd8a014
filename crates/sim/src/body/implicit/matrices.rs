//! The matrices of a step and their factors, at build.

use super::{Kind, STRETCHES};
use crate::body::core::{Core, Factor, SurfaceBlocks};
use crate::body::elements::{Edge, Place, Weight};
use crate::body::follow;
use crate::body::following::Shape;
use crate::body::frame::IDENTITY;
use crate::body::frames::Frames;
use crate::body::grown::Cells;
use crate::body::matter::{Matter, lanes_of};
use crate::body::scalar_factor::ScalarFactor;
use crate::body::settings::DeformableError;
use crate::body::tangent;
use palpate_geometry::math::{BlockCholesky, BlockTriplets, Lane, Point3, SymmetricTriplets};

/// Most stiffness over inertia for which a factor in single precision is good.
const MOST_STIFF: f64 = 1e5;

/// Where the unknowns are at rest.
fn places(matter: &Matter) -> Vec<Point3> {
    let unknowns = matter.coordinate_of_unknown.iter();
    unknowns.map(|&c| matter.rest[c as usize]).collect()
}

/// The core above every tangent.
pub(super) fn bounding(matter: &Matter) -> Result<Core, DeformableError> {
    let matrix = scalar_matrix(matter, &matter.law.edges(Weight::Bounding));
    let mut factor = Factor::Scalar(ScalarFactor::new(&matrix, &places(matter))?);
    let surface = SurfaceBlocks::new(matter, &factor);
    let mut stiffest = vec![0.0; matter.unknown_count()];
    for (i, j, value) in &matrix.entries {
        if i == j {
            stiffest[*i as usize] += value;
        }
    }
    if let Factor::Scalar(factor) = &mut factor
        && !is_too_stiff(matter, &stiffest)
    {
        factor.round();
    }
    Ok(Core {
        factor,
        growth: Vec::new(),
        made_in: Vec::new(),
        surface,
        cells: Cells::default(),
    })
}

/// True where rounding of the stiffest rows to single precision would disturb the motion of all;
/// `diagonal` is that of the matrix, N/m.
fn is_too_stiff(matter: &Matter, diagonal: &[f64]) -> bool {
    let dt = matter.settings.dt_s;
    let mean_kg = matter.masses.iter().sum::<f64>() / matter.masses.len() as f64;
    let stiffness = diagonal.iter().copied().fold(0.0, f64::max) * dt * dt / mean_kg;
    stiffness.is_nan() || stiffness > MOST_STIFF
}

/// The cores of the tangent of rest, if it has a factor of at most so many numbers that single precision can hold; and
/// the Laplacian of what short edges of a lattice carry beyond others.
pub(super) fn tangents(matter: &Matter, kind: Kind, most: usize) -> Option<(Vec<Core>, Vec<Edge>)> {
    let nodes = lanes_of(&matter.map.nodes(&matter.rest));
    let metrics = (matter.flow.as_ref()).map_or(&[][..], |flow| flow.rest(&matter.law));
    let rest = Place {
        places: &nodes,
        metrics: &[],
        pressures: &[],
    };
    let plain = tangent::at(matter, &rest);
    let (matrices, short) = match kind {
        Kind::Continuum => (vec![plain], Vec::new()),
        Kind::Lattice => of_lattice(matter, &plain),
        Kind::Sheet => (of_sheet(matter, &plain), Vec::new()),
    };
    let mut stiffest = vec![0.0; matter.unknown_count()];
    for (i, j, block) in &matrices[0].entries {
        if i == j {
            stiffest[*i as usize] += block.trace() / 3.0;
        }
    }
    if is_too_stiff(matter, &stiffest) && kind != Kind::Continuum {
        return None;
    }
    let mut cores = Vec::new();
    for matrix in &matrices {
        let most = if cores.is_empty() { most } else { usize::MAX };
        cores.push(core(matter, matrix, (&nodes, metrics), most)?);
    }
    Some((cores, short))
}

/// The core of a continuum in a shape; `None` where it has no factor.
pub(super) fn core_of(matter: &Matter, frames: &Frames, shape: &Shape) -> Option<Core> {
    let nodes = follow::nodes_of(matter, shape);
    let place = Place {
        places: &nodes,
        metrics: &shape.metrics,
        pressures: &shape.pressures,
    };
    let at = (&nodes[..], &shape.metrics[..]);
    let mut made = core(matter, &tangent::at(matter, &place), at, usize::MAX)?;
    made.made_in = vec![IDENTITY; matter.unknown_count()];
    frames.fit(&lanes_of(&shape.positions), &mut made.made_in);
    Some(made)
}

/// The core of a matrix that was made at places of the nodes, with the metrics of what flows.
fn core(
    matter: &Matter,
    matrix: &BlockTriplets,
    (nodes, metrics): (&[Lane], &[Lane]),
    most: usize,
) -> Option<Core> {
    let factor = BlockCholesky::placed(matrix, &places(matter), most).ok()??;
    let factor = Factor::Blocks(factor);
    let surface = SurfaceBlocks::new(matter, &factor);
    let growth = (matter.law.continuum.as_ref()).map(|law| law.growth_at(nodes));
    let cells = (matter.law.continuum.as_ref()).map(|_| Cells::at(matter, nodes, metrics));
    Some(Core {
        factor,
        growth: growth.unwrap_or_default(),
        made_in: Vec::new(),
        surface,
        cells: cells.unwrap_or_default(),
    })
}

/// The tangent of rest and a firmer one, and the Laplacian of what short edges carry beyond others.
fn of_lattice(
    matter: &Matter,
    plain: &BlockTriplets,
) -> (Vec<BlockTriplets>, Vec<(u32, u32, f64)>) {
    let firm = tangent::firm(matter);
    let with = |edges: &[(u32, u32, f64)]| {
        let mut matrix = plain.clone();
        tangent::add_edges(matter, edges, &mut matrix);
        matrix
    };
    let matrices = vec![with(&firm.rest), with(&firm.firmer)];
    let mut short = SymmetricTriplets::new(matter.unknown_count());
    (matter.map).add_edges(&firm.short, |c| matter.unknown(c as usize), &mut short);
    (matrices, short.entries)
}

/// The tangent of rest with each stretch.
fn of_sheet(matter: &Matter, plain: &BlockTriplets) -> Vec<BlockTriplets> {
    let drawn = STRETCHES.map(|stretch| {
        let mut matrix = plain.clone();
        tangent::add_edges(matter, &matter.law.tension_edges(stretch), &mut matrix);
        matrix
    });
    drawn.into()
}

/// M / dt² + (1 + d / dt) Wᵀ L W.
fn scalar_matrix(matter: &Matter, edges: &[(u32, u32, f64)]) -> SymmetricTriplets {
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
