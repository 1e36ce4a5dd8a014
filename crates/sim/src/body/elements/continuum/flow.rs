//! Plastic flow of cells: F = Fe Fp at each point where a cell is integrated.
//!
//! What a cell's energy knows of its rest is the metric S = J₀⁻¹ J₀⁻ᵀ. With a plastic part it is
//! J₀⁻¹ Cp⁻¹ J₀⁻ᵀ, and that is the state of the flow: forces need nothing else. The elastic
//! strain is the logarithm of Be = G S Gᵀ, G = ∂x/∂ξ, in its principal axes (Simo 1992). Its
//! deviator has the size q / E = 3 / (2 (1 + ν)) √(2/3 |dev ln Ve|²), which is the strain of a bar
//! that is drawn; beyond the yield strain y + H p (p: plastic strain so far, H: hardening) the
//! deviator shrinks along itself at the given rate, as in a cell that is held, for the step. That
//! keeps the volume, and it never raises I_C, so it never makes energy. With a spread, how much
//! flows is averaged over the points around; each still flows along its own deviator.

use super::kernel::{CellBlock, ROWS, at, modes, rows_of, slopes};
use super::{ContinuumLaw, Points};
use crate::body::bins::Bins;
use crate::body::material::Plastic;
use crate::body::node_map::SparseRows;
use palpate_geometry::math::lanes::{Baseline, Lanes};
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3};

/// Excess strains below this are rounding; without it a body would never sleep.
const ROUNDING: f64 = 1e-9;
/// Volumes below this share of that at rest are on the way through themselves, and do not flow.
const LEAST_VOLUME: f64 = 0.1;
/// Sweeps of Jacobi's method, which converges quadratically.
const SWEEPS: usize = 8;

/// Constants of the flow of a solid.
#[derive(Debug)]
pub(in crate::body) struct CellFlow {
    law: Plastic,
    dt_s: f64,
    /// (points × rows): the metrics of the first rest, four cells a row.
    rest: Vec<Lane>,
    /// Row: point (4 × its lane + cell); entries: points that take part of its flow, weights adding
    /// up to one.
    spread: Option<SparseRows>,
}

impl CellFlow {
    pub(in crate::body) fn new(law: Plastic, solid: &ContinuumLaw, dt_s: f64) -> Self {
        let of_block = |block: &CellBlock| -> Vec<Lane> {
            block.metric[..solid.point_count()].as_flattened().to_vec()
        };
        let rest = solid.blocks.iter().flat_map(of_block).collect();
        let spread = (law.spread_m > 0.0)
            .then(|| crate::body::plastic::neighbours(law.spread_m, &solid.places_of_points()));
        Self {
            law,
            dt_s,
            rest,
            spread,
        }
    }

    /// Metrics before anything has flowed.
    pub(in crate::body) fn rest(&self) -> &[Lane] {
        &self.rest
    }

    /// Number of lanes of plastic strains.
    pub(in crate::body) fn strain_lanes(&self) -> usize {
        self.rest.len() / ROWS
    }

    /// Lets points flow; true if any did. `metrics` is as long as [`CellFlow::rest`]; `strains` and
    /// `amounts` are [`CellFlow::strain_lanes`] long.
    pub(in crate::body) fn flow(
        &self,
        solid: &ContinuumLaw,
        places: &[Lane],
        metrics: &mut [Lane],
        strains: &mut [Lane],
        amounts: &mut [Lane],
    ) -> bool {
        let mut any = false;
        amounts.fill([0.0; 4]);
        solid.each_point(places, &mut |lane, cell, poisson, gradient| {
            let point = Point::new(metrics, &self.rest, lane, cell, gradient);
            let amount = self.amount(&point, poisson, strains[lane][cell]);
            if amount <= 0.0 {
                return;
            }
            any = true;
            match &self.spread {
                None => amounts[lane][cell] = amount,
                Some(spread) => {
                    let (points, weights) = spread.row(4 * lane + cell);
                    for (&other, weight) in points.iter().zip(weights) {
                        amounts[other as usize / 4][other as usize % 4] += amount * weight;
                    }
                }
            }
        });
        if !any {
            return false;
        }
        let mut flowed = false;
        solid.each_point(places, &mut |lane, cell, _, gradient| {
            let amount = amounts[lane][cell];
            if amount > 0.0 {
                let point = Point::new(metrics, &self.rest, lane, cell, gradient);
                if let Some((metric, amount)) = point.flowed(amount, self.law.limit) {
                    store(metrics, lane, cell, &metric);
                    strains[lane][cell] += amount;
                    flowed = true;
                }
            }
        });
        flowed
    }

    /// Plastic strain of a point in this step by its own stress.
    fn amount(&self, point: &Point, poisson: f64, plastic: f64) -> f64 {
        let ratio = 1.5 / (1.0 + poisson);
        let yields = self.law.yield_strain + self.law.hardening * plastic;
        if point.is_far_below(yields / ratio) {
            return 0.0;
        }
        let Some(strain) = point.strain() else {
            return 0.0;
        };
        let excess = ratio * strain.size() - yields;
        if excess.is_nan() || excess <= ROUNDING {
            return 0.0;
        }
        // Of a cell that is held: its stress falls by `ratio` and its yield strain grows by H.
        let slope = ratio + self.law.hardening;
        excess * -libm::expm1(-self.law.rate_per_s * slope * self.dt_s) / slope
    }
}

/// A point of a cell: how it is, and how it was at rest.
struct Point {
    /// ∂x/∂ξ.
    gradient: Matrix3,
    metric: Matrix3,
    first: Matrix3,
    /// G S Gᵀ.
    stretch: Matrix3,
}

/// Logarithmic elastic strain in its principal axes.
struct Strain {
    axes: Matrix3,
    mean: f64,
    deviator: Vector3,
}

impl Strain {
    /// √(2/3) of the deviator.
    fn size(&self) -> f64 {
        (2.0 / 3.0 * self.deviator.norm_squared()).sqrt()
    }
}

impl Point {
    fn new(metrics: &[Lane], rest: &[Lane], lane: usize, cell: usize, gradient: &Matrix3) -> Self {
        let metric = load(metrics, lane, cell);
        Self {
            gradient: *gradient,
            metric,
            first: load(rest, lane, cell),
            stretch: gradient * metric * gradient.transpose(),
        }
    }

    /// True where the strain is below `size` for certain, without a logarithm.
    ///
    /// With principal logarithms e_i of no sum, tr Be / det^(1/3) − 3 = Σ exp(2 e_i) − 3, which for
    /// sizes up to 1 is at least 1.3 |e|² and grows with |e|.
    fn is_far_below(&self, size: f64) -> bool {
        let (trace, volume) = (self.stretch.trace(), self.stretch.determinant());
        let bound = 3.0 + 1.2 * (1.5 * size * size);
        size < 1.0 && trace * trace * trace < bound * bound * bound * volume
    }

    /// `None` for a point that is flat, turned over or nowhere.
    fn strain(&self) -> Option<Strain> {
        let grown = self.gradient.determinant() * self.first.determinant().sqrt();
        // The sign of the winding is not known here: volumes of both signs are as good as each other.
        if grown.is_nan() || grown.abs() < LEAST_VOLUME {
            return None;
        }
        let (squares, axes) = principal(&self.stretch);
        if !squares
            .iter()
            .all(|square| *square > 0.0 && square.is_finite())
        {
            return None;
        }
        let logarithms = squares.map(|square| 0.5 * libm::log(square));
        let mean = logarithms.sum() / 3.0;
        Some(Strain {
            axes,
            mean,
            deviator: logarithms.map(|e| e - mean),
        })
    }

    /// The metric after a plastic strain, and how much of it was done: no more than the elastic
    /// strain there is, and within the limit. `None` if nothing changes.
    fn flowed(&self, amount: f64, limit: f64) -> Option<(Matrix3, f64)> {
        let strain = self.strain()?;
        let size = strain.size();
        if size <= ROUNDING {
            return None;
        }
        let amount = amount.min(size);
        let kept = 1.0 - amount / size;
        let squares = strain
            .deviator
            .map(|e| libm::exp(2.0 * (strain.mean + e * kept)));
        let stretch = strain.axes * Matrix3::from_diagonal(&squares) * strain.axes.transpose();
        let back = self.gradient.try_inverse()?;
        let metric = even(&(back * stretch * back.transpose()), &self.first);
        let metric = within(&metric, &self.first, limit)?;
        let trace = |metric: &Matrix3| (self.gradient * metric * self.gradient.transpose()).trace();
        // Drawn back to the limit it must not hold more energy than before.
        (trace(&metric) < trace(&self.metric)).then_some((metric, amount))
    }
}

/// Symmetric, and of the determinant of the first: flow keeps the volume.
fn even(metric: &Matrix3, first: &Matrix3) -> Matrix3 {
    let even = (metric + metric.transpose()) * 0.5;
    even * libm::cbrt(first.determinant() / even.determinant())
}

/// A metric whose plastic stretches are from 1 − limit to 1 + limit: one beyond is drawn back along
/// its logarithms.
fn within(metric: &Matrix3, first: &Matrix3, limit: f64) -> Option<Matrix3> {
    // In the axes of a Cholesky factor L of the first metric, L⁻¹ S L⁻ᵀ is Cp⁻¹ but for a turn.
    let lower = first.cholesky()?.l();
    let back = lower.try_inverse()?;
    let plastic = back * metric * back.transpose();
    let (squares, axes) = principal(&((plastic + plastic.transpose()) * 0.5));
    if !squares
        .iter()
        .all(|square| *square > 0.0 && square.is_finite())
    {
        return None;
    }
    let logarithms = squares.map(|square| -0.5 * libm::log(square));
    let bounds = [libm::log1p(-limit), libm::log1p(limit)];
    let share = |e: &f64| e / if *e > 0.0 { bounds[1] } else { bounds[0] };
    let over = logarithms.iter().map(share).fold(0.0, f64::max);
    if over <= 1.0 {
        return Some(*metric);
    }
    let squares = logarithms.map(|e| libm::exp(-2.0 * e / over));
    let plastic = axes * Matrix3::from_diagonal(&squares) * axes.transpose();
    Some(even(&(lower * plastic * lower.transpose()), first))
}

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix by Jacobi's rotations.
fn principal(matrix: &Matrix3) -> (Vector3, Matrix3) {
    let (mut a, mut axes) = (*matrix, Matrix3::identity());
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[(p, q)] == 0.0 {
                continue;
            }
            let theta = (a[(q, q)] - a[(p, p)]) / (2.0 * a[(p, q)]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let mut turn = Matrix3::identity();
            (turn[(p, p)], turn[(q, q)]) = (c, c);
            (turn[(p, q)], turn[(q, p)]) = (t * c, -t * c);
            a = turn.transpose() * a * turn;
            (a[(p, q)], a[(q, p)]) = (0.0, 0.0);
            axes *= turn;
        }
    }
    (a.diagonal(), axes)
}

fn load(metrics: &[Lane], lane: usize, cell: usize) -> Matrix3 {
    let row = |k: usize| metrics[ROWS * lane + k][cell];
    Matrix3::new(
        row(0),
        row(3),
        row(4),
        row(3),
        row(1),
        row(5),
        row(4),
        row(5),
        row(2),
    )
}

fn store(metrics: &mut [Lane], lane: usize, cell: usize, s: &Matrix3) {
    for (k, value) in rows_of(s).into_iter().enumerate() {
        metrics[ROWS * lane + k][cell] = value;
    }
}

/// A point where a cell is integrated: its number (4 × its lane + its cell), its place at rest, m, and J₀ = ∂x/∂ξ there.
type FlowPoint = (usize, Point3, Matrix3);

/// Points of a solid by their places at rest.
struct FlowPoints {
    all: Vec<FlowPoint>,
    bins: Bins,
}

impl FlowPoints {
    fn of(solid: &ContinuumLaw) -> Self {
        let all = solid.points_at_rest();
        let volumes = all.iter().map(|point| point.2.determinant().abs());
        // Points of a cell are closer than its edges.
        let side_m = 2.0 * libm::cbrt(volumes.fold(0.0, f64::max));
        let bins = Bins::new(
            side_m.max(f64::MIN_POSITIVE),
            all.iter().map(|point| point.1),
        );
        Self { all, bins }
    }

    fn nearest(&self, place: &Point3) -> Option<&FlowPoint> {
        let mut best = (f64::INFINITY, None);
        self.bins.around(place, |k| {
            let away = (self.all[k].1 - place).norm_squared();
            if away < best.0 {
                best = (away, Some(k));
            }
        });
        best.1.map(|k| &self.all[k])
    }
}

/// How the flow of a solid goes on in springs in its place: each is drawn as the matter around its middle is.
#[derive(Debug)]
pub(in crate::body) struct SpringCarry {
    /// Numbers of a spring and of the point that it follows, J₀ of that, and the spring's direction at rest.
    springs: Vec<(usize, usize, Matrix3, Vector3)>,
}

impl SpringCarry {
    /// From a solid to springs with these numbers, middles and directions; both at rest in the world.
    pub(in crate::body) fn new(from: &ContinuumLaw, to: &[(usize, Point3, Vector3)]) -> Self {
        let from = FlowPoints::of(from);
        let follow = |(spring, middle, along): &(usize, Point3, Vector3)| {
            let (point, _, frame) = from.nearest(middle)?;
            Some((*spring, *point, *frame, *along))
        };
        Self {
            springs: to.iter().filter_map(follow).collect(),
        }
    }

    /// Hands out each spring, by how much flow has drawn it, and the plastic strain there.
    pub(in crate::body) fn each(
        &self,
        (metrics, strains): (&[Lane], &[Lane]),
        mut out: impl FnMut(usize, f64, f64),
    ) {
        for (spring, point, frame, along) in &self.springs {
            let (lane, cell) = (point / 4, point % 4);
            // Cp⁻¹ = J₀ S J₀ᵀ; a line along d is drawn by √(d Cp d).
            let drawn = frame * load(metrics, lane, cell) * frame.transpose();
            let Some(right) = drawn.try_inverse() else {
                continue;
            };
            let ratio = along.dot(&(right * along)).sqrt();
            if ratio.is_finite() {
                out(*spring, ratio, strains[lane][cell]);
            }
        }
    }
}

/// How the flow of a solid goes on in another of the same matter: each point takes over that of the nearest.
#[derive(Debug)]
pub(in crate::body) struct CellCarry {
    /// Numbers of a point and of the one that it follows, and what takes a metric from there to here.
    points: Vec<(usize, usize, Matrix3)>,
}

impl CellCarry {
    /// From one solid to another; both at rest in the world.
    pub(in crate::body) fn new(from: &ContinuumLaw, to: &ContinuumLaw) -> Self {
        let [from, to] = [from, to].map(ContinuumLaw::points_at_rest);
        let volume = |frame: &Matrix3| frame.determinant().abs();
        let largest = from
            .iter()
            .map(|point| volume(&point.2))
            .fold(0.0, f64::max);
        // Points of a cell are closer than its edges.
        let side_m = (2.0 * libm::cbrt(largest)).max(f64::MIN_POSITIVE);
        let bins = Bins::new(side_m, from.iter().map(|point| point.1));
        let nearest = |(number, place, frame): &(usize, Point3, Matrix3)| {
            let mut best = (f64::INFINITY, None);
            bins.around(place, |k| {
                let away = (from[k].1 - place).norm_squared();
                if away < best.0 {
                    best = (away, Some(k));
                }
            });
            let (other, _, old) = &from[best.1?];
            Some((*number, *other, frame.try_inverse()? * old))
        };
        Self {
            points: to.iter().filter_map(nearest).collect(),
        }
    }

    /// Carries metrics and plastic strains over; points with nothing near stay as they are.
    pub(in crate::body) fn carry(
        &self,
        (metrics, strains): (&[Lane], &[Lane]),
        (to, amounts): (&mut [Lane], &mut [Lane]),
    ) {
        for (number, other, map) in &self.points {
            let (lane, cell) = (number / 4, number % 4);
            let (from, of) = (other / 4, other % 4);
            // Cp⁻¹ is the same tensor in both: J₀ S J₀ᵀ.
            let metric = map * load(metrics, from, of) * map.transpose();
            let first = load(to, lane, cell);
            store(to, lane, cell, &even(&metric, &first));
            amounts[lane][cell] = strains[from][of];
        }
    }
}

impl ContinuumLaw {
    fn points_at_rest(&self) -> Vec<FlowPoint> {
        let rest: Vec<Lane> = self.rest.iter().map(|p| [p.x, p.y, p.z, 0.0]).collect();
        let places = self.places_of_points();
        let mut frames = vec![Matrix3::zeros(); 4 * self.blocks.len() * self.point_count()];
        self.each_point(&rest, &mut |lane, cell, _, frame| {
            frames[4 * lane + cell] = *frame
        });
        let each = places
            .into_iter()
            .map(|(number, place)| (number, place, frames[number]));
        each.collect()
    }

    /// Points at which a cell is integrated.
    pub(super) fn point_count(&self) -> usize {
        match self.points {
            Points::Eight => 8,
            Points::Centre => 1,
        }
    }

    /// Hands out each point: its lane, its cell in the lane, the cell's ν, and G = ∂x/∂ξ at `places`.
    fn each_point(&self, places: &[Lane], out: &mut impl FnMut(usize, usize, f64, &Matrix3)) {
        let count = self.point_count();
        let mut first = 0;
        for (k, block) in self.blocks.iter().enumerate() {
            let materials = &self.materials[first..first + block.count];
            first += block.count;
            let c = modes::<Baseline>(&block.nodes, places);
            let slopes = slopes(&c);
            for point in 0..count {
                let columns = match self.points {
                    Points::Eight => {
                        let [i, j, k] = at(point);
                        [slopes[0][i], slopes[1][j], slopes[2][k]]
                    }
                    Points::Centre => [c[4], c[2], c[1]],
                };
                let mut four = [Matrix3::zeros(); 4];
                for (column, of) in columns.into_iter().enumerate() {
                    for (axis, lanes) in of.into_iter().enumerate() {
                        let mut values = [0.0; 4];
                        lanes.store(&mut values);
                        for (matrix, value) in four.iter_mut().zip(values) {
                            matrix[(axis, column)] = value;
                        }
                    }
                }
                for (cell, (matrix, elastic)) in four.iter().zip(materials).enumerate() {
                    out(count * k + point, cell, elastic.poisson, matrix);
                }
            }
        }
    }

    /// Each point's number (4 × its lane + its cell) and place at rest, m.
    fn places_of_points(&self) -> Vec<(usize, Point3)> {
        let mut points = Vec::new();
        let count = self.point_count();
        let blocks = self.blocks.iter().enumerate();
        let lanes = blocks.flat_map(|(k, block)| (0..block.count).map(move |cell| (k, cell)));
        for ((block, in_block), cell) in lanes.zip(&self.cells) {
            for point in 0..count {
                let mut place = Vector3::zeros();
                for (corner, &node) in cell.iter().enumerate() {
                    let weight: f64 = match self.points {
                        Points::Eight => (0..3)
                            .map(|bit| {
                                let same = (corner >> bit) & 1 == (point >> bit) & 1;
                                0.5 * (1.0 + if same { 1.0 } else { -1.0 } * super::rest::GAUSS)
                            })
                            .product(),
                        Points::Centre => 0.125,
                    };
                    place += self.rest[node as usize].coords * weight;
                }
                let lane = count * block + point;
                points.push((4 * lane + in_block, Point3::from(place)));
            }
        }
        points
    }
}
