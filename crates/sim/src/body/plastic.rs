//! Plastic flow: rest follows the strain beyond yield, so that clay keeps its dents.
//!
//! Of cells: [`CellFlow`]. Of springs, rest lengths follow.
//!
//! The strain of a spring is (l − L) / L₀. Beyond the yield strain y + H p (p: plastic strain so
//! far, H: hardening) the rest length moves towards the length at a given rate, until it has
//! changed by the limit. Only right-hand sides change: the matrix of the step is that of the first
//! rest lengths. With a spread, the flow of a spring is shared with those around it (the thesis'
//! neighbourhood radius, sec. 5.4), so that a pull draws a smooth bump.

use super::bins::Bins;
use super::elements::MaterialLaw;
use super::elements::continuum::CellFlow;
use super::elements::spring_table::SpringTable;
use super::material::Plastic;
use super::node_map::SparseRows;
use palpate_geometry::math::{Lane, Point3};

/// Constants of the flow of a body.
#[derive(Debug)]
pub(super) enum Flow {
    Springs(SpringFlow),
    Cells(CellFlow),
}

impl Flow {
    pub(super) fn new(law: Plastic, of: &MaterialLaw, rest: &[Point3], dt_s: f64) -> Self {
        match &of.continuum {
            Some(solid) => Self::Cells(CellFlow::new(law, solid, dt_s)),
            None => Self::Springs(SpringFlow::new(law, &of.springs, rest, dt_s)),
        }
    }

    /// What flows, before anything has: lengths of springs, or metrics of cells.
    pub(super) fn rest<'a>(&'a self, of: &'a MaterialLaw) -> &'a [Lane] {
        match self {
            Self::Springs(_) => of.springs.rest(),
            Self::Cells(cells) => cells.rest(),
        }
    }

    /// Number of lanes of plastic strains.
    pub(super) fn strain_lanes(&self, of: &MaterialLaw) -> usize {
        match self {
            Self::Springs(_) => of.springs.rest().len(),
            Self::Cells(cells) => cells.strain_lanes(),
        }
    }

    /// Lets a body at `nodes` flow; true if anything did. `rest` and `strains` are its state,
    /// `amounts` is room for as many lanes as `strains`.
    pub(super) fn flow(
        &self,
        of: &MaterialLaw,
        nodes: &[Lane],
        rest: &mut [Lane],
        strains: &mut [Lane],
        amounts: &mut [Lane],
    ) -> bool {
        match (self, &of.continuum) {
            (Self::Springs(springs), _) => springs.flow(&of.springs, nodes, rest, strains, amounts),
            (Self::Cells(cells), Some(solid)) => cells.flow(solid, nodes, rest, strains, amounts),
            (Self::Cells(_), None) => false,
        }
    }
}

/// Constants of the flow of springs.
#[derive(Debug)]
pub(super) struct SpringFlow {
    law: Plastic,
    /// Share of a body step's excess strain that flows.
    share: f64,
    /// Row: spring (4 × block + place); entries: springs that take part of its flow, weights adding
    /// up to one.
    spread: Option<SparseRows>,
}

impl SpringFlow {
    fn new(law: Plastic, table: &SpringTable, rest: &[Point3], dt_s: f64) -> Self {
        let spread = (law.spread_m > 0.0).then(|| {
            let middles = table.each().map(|(block, place, a, b, _)| {
                (4 * block + place, nalgebra::center(&rest[a], &rest[b]))
            });
            neighbours(law.spread_m, &middles.collect::<Vec<_>>())
        });
        // Never more than the whole excess in one step.
        Self {
            law,
            share: -libm::expm1(-law.rate_per_s * dt_s),
            spread,
        }
    }

    /// Lets springs flow; true if any did. `flow` has as many entries as `lengths`.
    fn flow(
        &self,
        table: &SpringTable,
        nodes: &[Lane],
        lengths: &mut [Lane],
        strains: &mut [Lane],
        flow: &mut [Lane],
    ) -> bool {
        let mut any = false;
        if self.spread.is_some() {
            flow.fill([0.0; 4]);
        }
        for (block, place, a, b, _) in table.each() {
            let first = table.rest()[block][place];
            let (from, to) = (&nodes[a], &nodes[b]);
            let d = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
            let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
            let strain = (length - lengths[block][place]) / first;
            let excess =
                strain.abs() - self.law.yield_strain - self.law.hardening * strains[block][place];
            if excess.is_nan() || excess <= 0.0 {
                continue;
            }
            any = true;
            let change = self.share * excess * strain.signum();
            match &self.spread {
                None => self.change(
                    first,
                    change,
                    &mut lengths[block][place],
                    &mut strains[block][place],
                ),
                Some(spread) => {
                    let (springs, weights) = spread.row(4 * block + place);
                    for (&spring, weight) in springs.iter().zip(weights) {
                        flow[spring as usize / 4][spring as usize % 4] += change * weight;
                    }
                }
            }
        }
        if any && self.spread.is_some() {
            for (block, place, ..) in table.each() {
                let change = flow[block][place];
                if change != 0.0 {
                    let first = table.rest()[block][place];
                    self.change(
                        first,
                        change,
                        &mut lengths[block][place],
                        &mut strains[block][place],
                    );
                }
            }
        }
        any
    }

    fn change(&self, first: f64, change: f64, length: &mut f64, strain: &mut f64) {
        let (low, high) = (
            first * (1.0 - self.law.limit),
            first * (1.0 + self.law.limit),
        );
        let next = (*length + change * first).clamp(low, high);
        *strain += (next - *length).abs() / first;
        *length = next;
    }
}

/// Weights (1 − (d / r)²)² of the places within r of each place, scaled to add up to one; places come
/// with their numbers, four to a lane.
pub(super) fn neighbours(radius: f64, springs: &[(usize, Point3)]) -> SparseRows {
    let mut sorted = springs.to_vec();
    sorted.sort_by_key(|entry| entry.0);
    let bins = Bins::new(radius, sorted.iter().map(|entry| entry.1));
    let lanes = springs.iter().map(|entry| entry.0 / 4 + 1).max();
    let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); 4 * lanes.unwrap_or(0)];
    for &(spring, middle) in springs {
        let row = &mut rows[spring];
        bins.around(&middle, |k| {
            let (other, place) = sorted[k];
            let share = 1.0 - (place - middle).norm_squared() / (radius * radius);
            if share > 0.0 {
                row.push((other as u32, share * share));
            }
        });
        let sum: f64 = row.iter().map(|entry| entry.1).sum();
        row.iter_mut().for_each(|entry| entry.1 /= sum);
    }
    SparseRows::new(rows)
}
