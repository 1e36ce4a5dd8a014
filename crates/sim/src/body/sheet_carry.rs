//! What the control points of a piece of a membrane take over from those of the membrane.
//!
//! The skin of a membrane is its matter. Where the piece's surface is, the nearest place of the membrane's surface at rest is
//! the same matter, and the piece's control points are those whose surface moves as the membrane does at such places: least
//! squares along u and along v. What the weights miss of affine motions is added, so that those are exact.

use super::deformable::Deformable;
use super::node_map::SparseRows;
use super::weights::coordinates_at;
use palpate_geometry::basis::{Blending, BlendingInverse, KnotVector};
use palpate_geometry::math::{Matrix3, Point3, Vector3};
use palpate_geometry::surface::{ClosestSolver, Surface};

/// Places of a span that are compared.
const SAMPLES: usize = 3;
/// Weights of samples that are less than this count nothing.
const LEAST: f64 = 1e-6;
/// Squares of widths relative to the greatest, below which a sheet is flat.
const FLAT: f64 = 1e-12;

/// Affine motions of a body, from its coordinates, and what rows of weights miss of them.
#[derive(Debug)]
pub(super) struct Affine {
    /// Mean of the coordinates at rest, m.
    centre: Point3,
    /// Σ (X − centre) (X − centre)ᵀ, inverted in the directions in which the body has a width, 1/m².
    inverse: Matrix3,
    /// (rows) What is missing to weights that add up to one, and to the place that they are of, m.
    missing: Vec<(f64, Vector3)>,
}

/// An affine field.
#[derive(Clone, Copy, Debug)]
pub(super) struct AffineField {
    mean: Vector3,
    slope: Matrix3,
}

impl Affine {
    /// For places with rows of weights of a body's coordinates.
    fn new(rest: &[Point3], places: &[Point3], rows: &SparseRows) -> Self {
        debug_assert_eq!(places.len(), rows.rows(), "a row a place");
        let sum: Vector3 = rest.iter().map(|x| x.coords).sum();
        let centre = Point3::from(sum / rest.len() as f64);
        let squares = rest.iter().map(|x| (x - centre) * (x - centre).transpose());
        let missing = |(row, place): (usize, &Point3)| {
            let (columns, weights) = rows.row(row);
            let (mut sum, mut first) = (1.0, place - centre);
            for (&column, &weight) in columns.iter().zip(weights) {
                sum -= weight;
                first -= (rest[column as usize] - centre) * weight;
            }
            (sum, first)
        };
        Self {
            centre,
            inverse: inverse_where_wide(squares.sum()),
            missing: places.iter().enumerate().map(missing).collect(),
        }
    }

    /// The affine field nearest to values at the coordinates of a body that is at `rest` there.
    pub fn of(&self, rest: &[Point3], values: impl Iterator<Item = Vector3>) -> AffineField {
        let (mut sum, mut first) = (Vector3::zeros(), Matrix3::zeros());
        for (x, value) in rest.iter().zip(values) {
            sum += value;
            first += value * (x - self.centre).transpose();
        }
        AffineField {
            mean: sum / rest.len() as f64,
            slope: first * self.inverse,
        }
    }

    /// What a row misses of a field.
    pub fn missed(&self, row: usize, field: &AffineField) -> Vector3 {
        let (sum, first) = self.missing[row];
        field.mean * sum + field.slope * first
    }
}

/// The inverse in the directions in which there is anything.
fn inverse_where_wide(squares: Matrix3) -> Matrix3 {
    let eigen = squares.symmetric_eigen();
    let widest = eigen.eigenvalues.max();
    let mut inverse = Matrix3::zeros();
    for (value, axis) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if *value > FLAT * widest {
            inverse += axis * axis.transpose() / *value;
        }
    }
    inverse
}

/// Weights of a membrane's coordinates for each of a piece's, and what they miss. `None` where a control point is no
/// coordinate of its own.
pub(super) fn carried(
    (body, whole): (&Deformable, &Surface),
    (piece, part): (&Deformable, &Surface),
) -> Option<(SparseRows, Affine)> {
    let (old, new) = (body.matter(), piece.matter());
    let of_control = &old.coordinate_of_control;
    let same =
        |surface: &Surface, coordinates: &[u32]| surface.net().points().len() == coordinates.len();
    if !same(whole, of_control) || !same(part, &new.coordinate_of_control) {
        return None;
    }
    let [us, vs] = [part.knots_u(), part.knots_v()].map(samples);
    let [along_u, along_v] =
        [(part.knots_u(), &us), (part.knots_v(), &vs)].map(samples_of_controls);
    let mut solver = ClosestSolver::new(whole);
    let mut at = Vec::with_capacity(us.len() * vs.len());
    for &u in &us {
        for &v in &vs {
            let foot = solver.closest(whole, &part.point(u, v));
            at.push(coordinates_at(whole, [foot.u, foot.v], of_control));
        }
    }
    let columns = part.net().columns();
    let mut rows = vec![None; new.rest.len()];
    let mut sum = vec![0.0; old.rest.len()];
    for (control, &coordinate) in new.coordinate_of_control.iter().enumerate() {
        let row = rows.get_mut(coordinate as usize)?;
        if row.is_some() {
            continue;
        }
        sum.fill(0.0);
        for &(k, a) in &along_u[control / columns] {
            for &(l, b) in &along_v[control % columns] {
                for &(from, weight) in &at[k * vs.len() + l] {
                    sum[from as usize] += a * b * weight;
                }
            }
        }
        let entries = sum.iter().enumerate().filter(|entry| *entry.1 != 0.0);
        *row = Some(
            entries
                .map(|(from, weight)| (from as u32, *weight))
                .collect::<Vec<_>>(),
        );
    }
    let rows = SparseRows::new(rows.into_iter().collect::<Option<Vec<_>>>()?);
    let affine = Affine::new(&old.rest, &new.rest, &rows);
    Some((rows, affine))
}

/// Parameters of a direction: within all spans, and at ends.
fn samples(knots: &KnotVector) -> Vec<f64> {
    let t = knots.knots();
    let (start, end) = knots.domain();
    let inner = knots.spans().flat_map(|k| {
        let at = move |j: usize| (j as f64 + 0.5) / SAMPLES as f64;
        (0..SAMPLES).map(move |j| t[k] + (t[k + 1] - t[k]) * at(j))
    });
    let ends = !knots.is_periodic();
    let first = std::iter::once(start).filter(|_| ends);
    let last = std::iter::once(end).filter(|_| ends);
    first.chain(inner).chain(last).collect()
}

/// For each control point of a direction, the samples that it is made of.
fn samples_of_controls((knots, samples): (&KnotVector, &Vec<f64>)) -> Vec<Vec<(usize, f64)>> {
    let inverse = BlendingInverse::new(Blending::new(knots, samples));
    let count = knots.count();
    let mut all = vec![Vec::new(); count];
    let mut one = vec![0.0; samples.len()];
    let mut out = vec![0.0; count];
    let mut scratch = vec![0.0; samples.len() + count];
    for k in 0..samples.len() {
        one.fill(0.0);
        one[k] = 1.0;
        inverse.fit(&one, &mut out, &mut scratch);
        for (row, &weight) in all.iter_mut().zip(&out) {
            if weight.abs() > LEAST {
                row.push((k, weight));
            }
        }
    }
    all
}
