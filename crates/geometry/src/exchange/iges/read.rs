//! Entity 128 and the matrices, entity 124, that place it. IGES 5.3, §4.23 and §4.21.

use super::error::IgesError;
use super::sections::{Entry, File, INSTANCE, shortened};
use crate::basis::MAX_DEGREE;
use crate::exchange::LengthUnit;
use crate::exchange::number::parse;
use crate::exchange::spline::{FileSurface, runs};
use crate::math::{Matrix3, Point3, Vector3};

const SURFACE: u32 = 128;
const MATRIX: u32 = 124;

/// Matrices that place a matrix: more than nested views and assemblies have.
const MAX_MATRICES: usize = 16;

/// Directory entries of all surfaces.
pub(super) fn find(file: &File<'_>) -> Result<Vec<u64>, IgesError> {
    let surfaces = file
        .entries()
        .flatten()
        .filter(|entry| entry.kind == u64::from(SURFACE));
    let ids: Vec<u64> = surfaces.map(|entry| entry.id).collect();
    if ids.is_empty() {
        Err(IgesError::NoSurface(file.count()))
    } else {
        Ok(ids)
    }
}

/// The parameters of one entity, and how to complain about them.
pub(super) struct Parameters {
    kind: u32,
    id: u64,
    tokens: Vec<Vec<u8>>,
}

impl Parameters {
    pub(super) fn of(file: &File<'_>, entry: &Entry, kind: u32) -> Result<Self, IgesError> {
        Ok(Self {
            kind,
            id: entry.id,
            tokens: file.parameters(entry)?,
        })
    }

    fn require(&self, needed: u64) -> Result<(), IgesError> {
        let given = self.tokens.len();
        if (given as u64) < needed {
            return Err(IgesError::Few {
                kind: self.kind,
                id: self.id,
                given,
                needed,
            });
        }
        Ok(())
    }

    fn wrong(&self, k: usize, what: &'static str, wanted: &'static str) -> IgesError {
        let found = shortened(&self.tokens[k]);
        IgesError::Parameter {
            kind: self.kind,
            id: self.id,
            index: k + 1,
            what,
            wanted,
            found,
        }
    }

    /// Empty parameters are 0.
    fn whole(&self, k: usize, what: &'static str) -> Result<u64, IgesError> {
        let token = &self.tokens[k];
        let number = if token.is_empty() {
            Some(0)
        } else {
            std::str::from_utf8(token).ok().and_then(|t| t.parse().ok())
        };
        number
            .filter(|&number: &u64| number < 1 << 40)
            .ok_or_else(|| self.wrong(k, what, "a whole number"))
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.tokens.len()
    }

    pub(super) fn real(&self, k: usize, what: &'static str) -> Result<f64, IgesError> {
        let token = &self.tokens[k];
        let number = if token.is_empty() {
            Some(0.0)
        } else {
            parse(token)
        };
        number.ok_or_else(|| self.wrong(k, what, "a finite number"))
    }
}

/// The values of a surface, the first of a chain whose others take it over, in metres, and the ranges of u and v that the file
/// means.
pub(super) fn surface(
    file: &File<'_>,
    chain: &[Entry],
    unit: &LengthUnit,
) -> Result<(FileSurface, [(f64, f64); 2]), IgesError> {
    let parameters = Parameters::of(file, &chain[0], SURFACE)?;
    parameters.require(9)?;
    let last = [
        parameters.whole(0, "upper index of the first sum")?,
        parameters.whole(1, "upper index of the second sum")?,
    ];
    let degrees = [
        parameters.whole(2, "degree in u")?,
        parameters.whole(3, "degree in v")?,
    ];
    for k in 0..2 {
        if degrees[k] > MAX_DEGREE as u64 {
            return Err(parameters.wrong(2 + k, ["degree in u", "degree in v"][k], "at most 15"));
        }
    }
    let polynomial = parameters.whole(6, "polynomial")? == 1;
    let counts = last.map(|last| last + 1);
    // Counted before anything is allocated: below 2⁴⁰ each, as u128 nothing overflows.
    let knots = [counts[0] + degrees[0] + 1, counts[1] + degrees[1] + 1];
    let net = u128::from(counts[0]) * u128::from(counts[1]);
    let needed = 9 + u128::from(knots[0]) + u128::from(knots[1]) + 4 * net + 4;
    parameters.require(u64::try_from(needed).unwrap_or(u64::MAX))?;
    let [rows, columns] = counts.map(|count| count as usize);
    let knots = knots.map(|count| count as usize);
    let mut at = 9;
    let mut take = |count: usize, what: &'static str| -> Result<Vec<f64>, IgesError> {
        let values = (at..at + count).map(|k| parameters.real(k, what)).collect();
        at += count;
        values
    };
    let (knots_u, knots_v) = (take(knots[0], "knot in u")?, take(knots[1], "knot in v")?);
    let weights_in_file = take(rows * columns, "weight")?;
    let coordinates = take(3 * rows * columns, "coordinate")?;
    let range = take(4, "range of u and v")?;
    let placed = placement(file, chain)?;
    // The file runs through u first.
    let order = || (0..rows).flat_map(|i| (0..columns).map(move |j| i + j * rows));
    let points = order()
        .map(|k| {
            let point = Vector3::new(
                coordinates[3 * k],
                coordinates[3 * k + 1],
                coordinates[3 * k + 2],
            );
            let point = placed
                .as_ref()
                .map_or(point, |(rotation, shift)| rotation * point + shift);
            Point3::from(point.map(|x| unit.to_metres(x)))
        })
        .collect();
    let weights: Vec<f64> = order().map(|k| weights_in_file[k]).collect();
    // Polynomial says that weights are equal; so do equal weights, unless the file says rational.
    let rational = !polynomial || weights.iter().any(|weight| *weight != weights[0]);
    let weights = rational.then_some(weights);
    let values = FileSurface {
        degrees: degrees.map(|degree| degree as usize),
        knots: [runs(&knots_u), runs(&knots_v)],
        rows,
        columns,
        points,
        weights,
    };
    Ok((values, [(range[0], range[1]), (range[2], range[3])]))
}

/// A turn (with a scale, perhaps), and a shift after it, in the file's unit.
type Placement = (Matrix3, Vector3);

/// One placement after the other.
fn after(inner: Option<Placement>, (turn, shift): Placement) -> Option<Placement> {
    Some(match inner {
        None => (turn, shift),
        Some((inner, moved)) => (turn * inner, turn * moved + shift),
    })
}

/// The product of all that places an entity, the first of a chain whose others take it over; `None` without any, so
/// that numbers stay as they are bit for bit.
pub(super) fn placement(file: &File<'_>, chain: &[Entry]) -> Result<Option<Placement>, IgesError> {
    let mut placed = None;
    for entry in chain {
        placed = matrices(file, entry, placed)?;
        if entry.kind == INSTANCE {
            placed = after(placed, instance(file, entry)?);
        }
    }
    Ok(placed)
}

/// Where a subfigure (308) stands: its definition, a shift, a scale.
fn instance(file: &File<'_>, entry: &Entry) -> Result<Placement, IgesError> {
    let parameters = Parameters::of(file, entry, INSTANCE as u32)?;
    parameters.require(4)?;
    let number = |k: usize, what: &'static str| parameters.real(k, what);
    let shift = Vector3::new(
        number(1, "shift")?,
        number(2, "shift")?,
        number(3, "shift")?,
    );
    let has_scale = parameters
        .tokens
        .get(4)
        .is_some_and(|token| !token.is_empty());
    let scale = if has_scale { number(4, "scale")? } else { 1.0 };
    if scale <= 0.0 {
        return Err(parameters.wrong(4, "scale", "above 0"));
    }
    Ok((Matrix3::identity() * scale, shift))
}

/// The matrices of an entity, after what is inside it.
fn matrices(
    file: &File<'_>,
    entry: &Entry,
    mut placed: Option<Placement>,
) -> Result<Option<Placement>, IgesError> {
    let mut from = *entry;
    for _ in 0..MAX_MATRICES {
        if from.matrix == 0 {
            return Ok(placed);
        }
        let to = file
            .entry(from.matrix)
            .filter(|entry| entry.kind == u64::from(MATRIX));
        let to = to.ok_or(IgesError::Matrix {
            from: from.id,
            to: from.matrix,
        })?;
        let parameters = Parameters::of(file, &to, MATRIX)?;
        parameters.require(12)?;
        let mut values = [0.0; 12];
        for (k, value) in values.iter_mut().enumerate() {
            *value = parameters.real(k, "element of the matrix")?;
        }
        let [a, b, c, x, d, e, f, y, g, h, i, z] = values;
        let turn = Matrix3::new(a, b, c, d, e, f, g, h, i);
        placed = after(placed, (turn, Vector3::new(x, y, z)));
        from = to;
    }
    Err(IgesError::Circle(entry.id))
}
