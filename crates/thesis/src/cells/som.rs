//! Builder `som`: a volumetric self-organising feature map (Igwe 2008; Pungotra 2010, §5.3.2).
//!
//! A cube lattice inside the body is attracted to a cloud of points of its surface. In each
//! learning cycle every point is won by the nearest exterior node, and every exterior node moves to
//! the mean of the points won near it in the lattice, weighted by a Gaussian of the lattice
//! distance that narrows from cycle to cycle. We use the batch form of the map (Kohonen 2001,
//! §3.6): it has the same resting states as presenting the points one at a time, needs no learning
//! rate and no order of presentation, and its Gaussian separates into three passes along the axes.
//!
//! The cloud is dense and each of its points weighs its area, so the nodes come to lie evenly on
//! the surface. At the end every exterior node takes the nearest point of the surface as its own,
//! so that nodes and surface points are one to one. (Matching the nodes with as many points fixed
//! beforehand leaves the last few nodes with points far from their neighbours, and the cells there
//! folded.) The interior is harmonic, and folded cells are unfolded.

use super::cube::{CubeError, CubeLattice, check_closed, is_outermost, node_at, place_of};
use super::{harmonic, untangle};
use palpate_geometry::math::{Matrix3, Point3, Vector3};
use palpate_geometry::surface::{ClosestSolver, Surface};

/// How the map learns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SomSettings {
    /// Learning cycles, 1 to 10 000; 100 to 300 in the thesis.
    pub cycles: usize,
    /// Points of the cloud for each exterior node.
    pub points_a_node: usize,
}

impl Default for SomSettings {
    fn default() -> Self {
        Self {
            cycles: 100,
            points_a_node: 6,
        }
    }
}

/// Radius of the Gaussian in the last cycle, in lattice steps. At 0.4 the cells are ragged, at 0.9
/// the thin end of the teardrop gets too few nodes.
const LAST_RADIUS: f64 = 0.6;

/// Cycles in which the winner is sought among all nodes; in the others it is sought from the last
/// winner.
const FULL_SEARCHES: [usize; 5] = [0, 3, 8, 20, 50];

/// A lattice of `counts` nodes in a closed, sphere-like surface; the third axis lies along the
/// body's longest one. All nodes of its six faces ride on the surface.
///
/// # Errors
/// A surface that is not of this kind, encloses nothing, or whose cells stay folded; counts.
pub fn som(
    surface: &Surface,
    counts: [usize; 3],
    settings: &SomSettings,
) -> Result<CubeLattice, CubeError> {
    check_closed(surface)?;
    let mut lattice = CubeLattice::new(counts, |place| {
        (
            Point3::origin(),
            is_outermost(counts, place).then_some([0.0; 2]),
        )
    })?;
    let cloud = Cloud::new(
        surface,
        lattice.exterior.len() * settings.points_a_node.clamp(1, 1000),
    );
    let mut map = Map::new(&lattice, &cloud);
    let cycles = settings.cycles.clamp(1, 10_000);
    let first_radius = 0.25 * counts.iter().copied().max().unwrap_or(2) as f64;
    for cycle in 0..cycles {
        let done = cycle as f64 / cycles as f64;
        let radius = first_radius * libm::pow((LAST_RADIUS / first_radius).min(1.0), done);
        map.learn(&cloud, radius, FULL_SEARCHES.contains(&cycle));
    }
    map.settle(&cloud, surface, &mut lattice);
    harmonic::fill(&mut lattice);
    untangle::untangle(&mut lattice, surface);
    lattice.unfolded()
}

/// Points of a surface, evenly spaced in its parameters.
struct Cloud {
    points: Vec<Point3>,
    /// Parameters of each.
    parameters: Vec<[f64; 2]>,
    /// Area around each, m².
    areas: Vec<f64>,
}

impl Cloud {
    fn new(surface: &Surface, count: usize) -> Self {
        let side = (count as f64).sqrt().ceil() as usize;
        let (low_u, high_u) = surface.knots_u().domain();
        let (low_v, high_v) = surface.knots_v().domain();
        let share = |k: usize| (k as f64 + 0.5) / side as f64;
        let columns: Vec<_> = (0..side)
            .map(|k| low_v + (high_v - low_v) * share(k))
            .map(|v| (v, surface.knots_v().window(v)))
            .collect();
        let mut cloud = Self {
            points: Vec::new(),
            parameters: Vec::new(),
            areas: Vec::new(),
        };
        for k in 0..side {
            let u = low_u + (high_u - low_u) * share(k);
            let row = surface.knots_u().window(u);
            for (v, column) in &columns {
                let frame = surface.frame_in(&row, column);
                cloud.points.push(frame.point);
                cloud.parameters.push([u, *v]);
                cloud.areas.push(frame.du.cross(&frame.dv).norm());
            }
        }
        cloud
    }

    /// Centre, and axes with their half lengths: the principal ones, shortest first, right-handed.
    fn frame(&self) -> (Point3, Matrix3, Vector3) {
        let total: f64 = self.areas.iter().sum();
        let centre = self
            .points
            .iter()
            .zip(&self.areas)
            .map(|(p, a)| p.coords * *a)
            .sum::<Vector3>()
            / total;
        let mut spread = Matrix3::zeros();
        for (point, area) in self.points.iter().zip(&self.areas) {
            let arm = point.coords - centre;
            spread += arm * arm.transpose() * (area / total);
        }
        let eigen = spread.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let [x, y] = [order[0], order[1]].map(|k| eigen.eigenvectors.column(k).into_owned());
        let axes = Matrix3::from_columns(&[x, y, x.cross(&y)]);
        // A uniform rod has half its length at √3 standard deviations.
        let half = Vector3::from_fn(|k, _| (3.0 * eigen.eigenvalues[order[k]].max(0.0)).sqrt());
        (centre.into(), axes, half)
    }
}

/// The exterior nodes while they learn.
struct Map {
    counts: [usize; 3],
    /// Exterior node → node of the lattice.
    nodes: Vec<u32>,
    /// Where they are.
    places: Vec<Point3>,
    /// Exterior nodes around exterior node e: `beside[starts[e]..starts[e + 1]]`.
    starts: Vec<u32>,
    beside: Vec<u32>,
    /// Exterior node that won each point of the cloud.
    winners: Vec<u32>,
    /// (nodes of the lattice): area × point and area of what was won, then spread; and the buffer
    /// of one line.
    field: Vec<[f64; 4]>,
    line: Vec<[f64; 4]>,
}

impl Map {
    fn new(lattice: &CubeLattice, cloud: &Cloud) -> Self {
        let counts = lattice.counts;
        let nodes: Vec<u32> = lattice.exterior.iter().map(|(node, _)| *node).collect();
        let mut exterior_of = vec![u32::MAX; lattice.grid.nodes.len()];
        for (entry, &node) in nodes.iter().enumerate() {
            exterior_of[node as usize] = entry as u32;
        }
        let (centre, axes, half) = cloud.frame();
        let (mut places, mut starts, mut beside) = (Vec::new(), vec![0], Vec::new());
        for &node in &nodes {
            let place = place_of(counts, node as usize);
            let share = Vector3::from_fn(|axis, _| {
                2.0 * place[axis] as f64 / (counts[axis] - 1) as f64 - 1.0
            });
            // Half as large as the body: inside, for most shapes, and it makes no difference
            // otherwise.
            places.push(centre + axes * share.component_mul(&half) * 0.5);
            for offset in 0..27 {
                let step = [offset / 9, offset / 3 % 3, offset % 3];
                let near: [usize; 3] =
                    std::array::from_fn(|axis| (place[axis] + step[axis]).wrapping_sub(1));
                if offset != 13
                    && (0..3).all(|axis| near[axis] < counts[axis])
                    && is_outermost(counts, near)
                {
                    beside.push(exterior_of[node_at(counts, near)]);
                }
            }
            starts.push(beside.len() as u32);
        }
        let line = vec![[0.0; 4]; counts.into_iter().max().unwrap_or(0)];
        let field = vec![[0.0; 4]; lattice.grid.nodes.len()];
        Self {
            counts,
            nodes,
            places,
            starts,
            beside,
            winners: vec![0; cloud.points.len()],
            field,
            line,
        }
    }

    /// One learning cycle with a Gaussian of this radius, lattice steps.
    fn learn(&mut self, cloud: &Cloud, radius: f64, search_all: bool) {
        self.find_winners(cloud, search_all);
        self.field.fill([0.0; 4]);
        for ((point, area), &winner) in cloud.points.iter().zip(&cloud.areas).zip(&self.winners) {
            let slot = &mut self.field[self.nodes[winner as usize] as usize];
            for (value, share) in
                slot.iter_mut()
                    .zip([point.x * area, point.y * area, point.z * area, *area])
            {
                *value += share;
            }
        }
        self.spread(radius);
        for (place, &node) in self.places.iter_mut().zip(&self.nodes) {
            let [x, y, z, area] = self.field[node as usize];
            // A node far from all winners waits.
            if area > 0.0 {
                *place = Point3::new(x / area, y / area, z / area);
            }
        }
    }

    /// Nearest exterior node of each point; ties go to the one found first.
    fn find_winners(&mut self, cloud: &Cloud, search_all: bool) {
        for (point, winner) in cloud.points.iter().zip(&mut self.winners) {
            let distance = |entry: usize| (self.places[entry] - point).norm_squared();
            let mut best = (*winner as usize, distance(*winner as usize));
            if search_all {
                for entry in 0..self.places.len() {
                    let there = distance(entry);
                    if there < best.1 {
                        best = (entry, there);
                    }
                }
            }
            // Downhill over the lattice: every step is strictly nearer, so it ends.
            loop {
                let from = best.0;
                for &entry in
                    &self.beside[self.starts[from] as usize..self.starts[from + 1] as usize]
                {
                    let there = distance(entry as usize);
                    if there < best.1 {
                        best = (entry as usize, there);
                    }
                }
                if best.0 == from {
                    break;
                }
            }
            *winner = best.0 as u32;
        }
    }

    /// Convolves the field with a Gaussian, one axis after the other.
    fn spread(&mut self, radius: f64) {
        let most = self.line.len().saturating_sub(1);
        let reach = ((3.0 * radius).ceil() as usize).clamp(1, most.max(1));
        let weights: Vec<f64> = (0..=reach)
            .map(|d| libm::exp(-0.5 * (d as f64 / radius) * (d as f64 / radius)))
            .collect();
        for axis in 0..3 {
            let n = self.counts[axis];
            let stride: usize = self.counts[axis + 1..].iter().product();
            for start in (0..self.field.len()).filter(|start| (start / stride).is_multiple_of(n)) {
                for k in 0..n {
                    self.line[k] = self.field[start + k * stride];
                }
                for k in 0..n {
                    let mut sum = [0.0; 4];
                    for other in k.saturating_sub(reach)..(k + reach + 1).min(n) {
                        let weight = weights[k.abs_diff(other)];
                        for (value, share) in sum.iter_mut().zip(&self.line[other]) {
                            *value += weight * share;
                        }
                    }
                    self.field[start + k * stride] = sum;
                }
            }
        }
    }

    /// Gives every exterior node its own point of the surface.
    fn settle(&mut self, cloud: &Cloud, surface: &Surface, lattice: &mut CubeLattice) {
        self.find_winners(cloud, true);
        let mut nearest = vec![(f64::INFINITY, usize::MAX); self.places.len()];
        for (point, (position, &winner)) in cloud.points.iter().zip(&self.winners).enumerate() {
            let distance = (self.places[winner as usize] - position).norm_squared();
            if distance < nearest[winner as usize].0 {
                nearest[winner as usize] = (distance, point);
            }
        }
        let mut solver = ClosestSolver::new(surface);
        for (entry, place) in self.places.iter().enumerate() {
            let seed = cloud.parameters.get(nearest[entry].1);
            let foot = seed.and_then(|&[u, v]| solver.local(surface, place, u, v));
            let foot = foot.unwrap_or_else(|| solver.closest(surface, place));
            lattice.exterior[entry].1 = [foot.u, foot.v];
            lattice.grid.nodes[self.nodes[entry] as usize] = surface.point(foot.u, foot.v);
        }
    }
}
