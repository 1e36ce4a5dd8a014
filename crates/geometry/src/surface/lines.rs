//! A surface as a bundle of lines: what is done to every row or every column of control points
//! alike.

use super::{Surface, SurfaceError};
use crate::basis::{BasisChange, KnotError, KnotVector};
use crate::math::Point3;

/// A parametric direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Along the rows' index.
    U,
    /// Along the columns' index.
    V,
}

impl Direction {
    /// What the knots of this direction refused.
    pub(super) fn refused(self, source: KnotError) -> SurfaceError {
        let direction = match self {
            Self::U => 'u',
            Self::V => 'v',
        };
        SurfaceError::Knots { direction, source }
    }
}

/// A control point and its weight; the point is not multiplied by it.
pub(super) type LinePoint = (Point3, f64);

impl Surface {
    /// Knots of a direction.
    pub fn knots(&self, direction: Direction) -> &KnotVector {
        match direction {
            Direction::U => self.knots_u(),
            Direction::V => self.knots_v(),
        }
    }

    /// Neighbouring control points (u-major indices), first along rows, then along columns; none
    /// across a gap.
    pub fn net_edges(&self) -> Vec<[u32; 2]> {
        let (rows, columns) = (self.net().rows(), self.net().columns());
        let at = |i: usize, j: usize| (i * columns + j) as u32;
        let [gaps_u, gaps_v] = [self.knots_u().parted_after(), self.knots_v().parted_after()];
        let (gaps_u, gaps_v) = (&gaps_u, &gaps_v);
        let along = (0..rows).flat_map(|i| {
            (1..columns)
                .filter(|j| !gaps_v.contains(&(j - 1)))
                .map(move |j| [at(i, j - 1), at(i, j)])
        });
        let across = (1..rows)
            .filter(|i| !gaps_u.contains(&(i - 1)))
            .flat_map(|i| (0..columns).map(move |j| [at(i - 1, j), at(i, j)]));
        along.chain(across).collect()
    }

    /// The control points along a direction: one line for each control point of the other.
    pub(super) fn lines(&self, direction: Direction) -> Vec<Vec<LinePoint>> {
        let (rows, columns) = (self.net().rows(), self.net().columns());
        let at = |k: usize| (self.net().points()[k], self.weights().map_or(1.0, |w| w[k]));
        match direction {
            Direction::U => (0..columns)
                .map(|j| (0..rows).map(|i| at(i * columns + j)).collect())
                .collect(),
            Direction::V => (0..rows)
                .map(|i| (0..columns).map(|j| at(i * columns + j)).collect())
                .collect(),
        }
    }

    /// This surface with other knots along a direction and every line replaced. New lines have as
    /// many points as the new knots want, and weights above 0.
    pub(super) fn with_lines(
        &self,
        direction: Direction,
        knots: KnotVector,
        mut change: impl FnMut(&[LinePoint]) -> Vec<LinePoint>,
    ) -> Self {
        let lines: Vec<Vec<LinePoint>> = self
            .lines(direction)
            .iter()
            .map(|line| change(line))
            .collect();
        let (knots_u, knots_v) = match direction {
            Direction::U => (knots, self.knots_v().clone()),
            Direction::V => (self.knots_u().clone(), knots),
        };
        let (rows, columns) = (knots_u.count(), knots_v.count());
        let at = |i: usize, j: usize| match direction {
            Direction::U => lines[j][i],
            Direction::V => lines[i][j],
        };
        let all: Vec<LinePoint> = (0..rows)
            .flat_map(|i| (0..columns).map(move |j| (i, j)))
            .map(|(i, j)| at(i, j))
            .collect();
        let points = all.iter().map(|point| point.0).collect();
        let weights = self
            .weights()
            .map(|_| all.iter().map(|point| point.1).collect());
        self.rebuilt(knots_u, knots_v, points, weights)
            .with_flip_normal(self.flip_normal())
    }

    /// Returns this surface expressed over other knots.
    pub(super) fn changed(&self, direction: Direction, change: &BasisChange) -> Self {
        self.with_lines(direction, change.knots().clone(), |line| {
            (0..change.knots().count())
                .map(|row| combine(change.entries(row), line))
                .collect()
        })
    }
}

/// A sum of weighted points in homogeneous coordinates. Measured from one of them: equal points
/// give exactly that point, so seams and poles survive to the last bit.
pub(super) fn combine(
    entries: impl Iterator<Item = (usize, f64)> + Clone,
    line: &[LinePoint],
) -> LinePoint {
    let heaviest = |best: Option<(usize, f64)>, (k, share): (usize, f64)| match best {
        Some((_, most)) if most >= share.abs() => best,
        _ => Some((k, share.abs())),
    };
    let Some((reference, _)) = entries.clone().fold(None, heaviest) else {
        return line[0];
    };
    let origin = line[reference].0;
    let weight: f64 = entries.clone().map(|(k, share)| share * line[k].1).sum();
    let mut point = origin;
    for (k, share) in entries.filter(|(k, _)| *k != reference) {
        point += (line[k].0 - origin) * (share * line[k].1 / weight);
    }
    (point, weight)
}
