//! Builder `layers`: the control points of a surface are the outermost nodes of its lattice.
//!
//! Closed surfaces: rings of control points shrink in equal steps towards a medial curve, so the
//! cells beside the curve are wedges. The curve follows the rings' centroids but ends short of the
//! poles: were it to reach them, a flat end (a ring in one plane with its pole) would have cells
//! without volume. Tori and open tubes keep their centroids. Flat bodies shrink towards a medial
//! surface ([`super::opposite`]). Open sheets: copies of the net at
//! equal depths along the inward normals. Either way the surface is exact: no node is fitted to it.

use super::cells::{Cell, CellGrid};
use super::elements::continuum::refused_cells;
use super::opposite::{self, Medial};
use super::repair::repair;
use palpate_geometry::math::{Point3, Vector3};

/// What the rings of a closed surface do along the other direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RingEnds {
    /// The axis closes on itself (a torus).
    pub axis_closed: bool,
    /// First ring is one point.
    pub first_pole: bool,
    /// Last ring is one point.
    pub last_pole: bool,
}

/// The control points of a surface as rings around an axis; those repeated at a seam are the first
/// ones again.
#[derive(Clone, Debug)]
pub struct Rings {
    /// Control points around, repeated seam points not counted.
    pub around: usize,
    /// Control points along, repeated seam points not counted.
    pub along: usize,
    /// Ends of the axis.
    pub ends: RingEnds,
    /// True when u goes around and v along.
    pub u_around: bool,
    /// Control points of the net in v, repeated ones counted.
    pub columns: usize,
    /// What the rings shrink towards.
    pub medial: Medial,
}

impl Rings {
    /// Of a net whose u goes around, without a seam.
    pub fn seamless(around: usize, along: usize, ends: RingEnds) -> Self {
        Self {
            around,
            along,
            ends,
            u_around: true,
            columns: along,
            medial: Medial::Curve,
        }
    }

    /// Index (u-major) of the control point i around, j along.
    pub fn control(&self, i: usize, j: usize) -> usize {
        if self.u_around {
            i * self.columns + j
        } else {
            j * self.columns + i
        }
    }

    /// Place around and along of a control point.
    pub fn place(&self, control: usize) -> (usize, usize) {
        let (row, column) = (control / self.columns, control % self.columns);
        let (i, j) = if self.u_around {
            (row, column)
        } else {
            (column, row)
        };
        (i % self.around, j % self.along)
    }
}

/// Cells of a closed surface from its control points: `layers` shells, the surface's included, then
/// the medial curve.
pub fn rings(points: &[Point3], rings: &Rings, layers: usize) -> CellGrid {
    rings_about(
        &medial_curve(points, rings, &Insets::EVEN),
        points,
        rings,
        layers,
    )
}

/// [`rings`], with the ends of the medial curve moved to where the cells are best.
pub fn rings_at_best(points: &[Point3], rings: &Rings, layers: usize) -> CellGrid {
    let build = |medial: &[Point3]| rings_about(medial, points, rings, layers);
    build(&best_medial(points, rings, build))
}

/// [`rings_at_best`], for a continuum: cells that it would refuse are repaired where moving nodes inside is enough.
pub fn rings_for_continuum(points: &[Point3], rings: &Rings, layers: usize) -> CellGrid {
    let mut grid = rings_at_best(points, rings, layers);
    if refused_cells(&grid) > 0 {
        repair(&mut grid);
    }
    grid
}

/// The medial curve with which `build` makes the best cells: none folded, none that a continuum
/// refuses, then the greatest least scaled Jacobian of the cells that are not wedges. At a pointed pole the even curve ends too far
/// inside, and the cells beside it are slanted.
pub(super) fn best_medial(
    points: &[Point3],
    rings: &Rings,
    build: impl Fn(&[Point3]) -> CellGrid,
) -> Vec<Point3> {
    if rings.is_flat() {
        return opposite::middles(points, rings);
    }
    let mut best_insets = Insets::EVEN;
    let even = medial_curve(points, rings, &best_insets);
    if !(rings.ends.first_pole || rings.ends.last_pole) {
        return even;
    }
    let mut best = (worth(&build(&even), &WORST), even);
    for decay in DECAYS {
        for end in [0, 1, 0, 1] {
            for inset in INSETS {
                let mut insets = Insets {
                    decay,
                    ..best_insets
                };
                insets.radii[end] = inset;
                if best.0 >= [0.0, 0.0, 0.0, GOOD_ENOUGH] {
                    return best.1;
                }
                let medial = medial_curve(points, rings, &insets);
                let trial = worth(&build(&medial), &best.0);
                if trial > best.0 {
                    (best, best_insets) = ((trial, medial), insets);
                }
            }
        }
    }
    best.1
}

/// How good the cells of a trial are, in order of weight; not looked at further where less than `best` is certain.
fn worth(grid: &CellGrid, best: &Worth) -> Worth {
    let mut worth = WORST;
    let (folded, sense) = grid.folded_cells();
    worth[0] = -(folded as f64);
    if worth[0] < best[0] {
        return worth;
    }
    worth[1] = -(refused_cells(grid) as f64);
    if worth[..2] < best[..2] {
        return worth;
    }
    let (folded, least) = grid.corners(sense);
    worth[2] = -(folded as f64);
    worth[3] = least.min(GOOD_ENOUGH);
    worth
}

/// Cells that are folded, that a continuum refuses, and that are folded at a corner, less than none; least scaled Jacobian of
/// the cells that are not wedges.
type Worth = [f64; 4];

const WORST: Worth = [f64::NEG_INFINITY; 4];

/// Cells between the rings and one medial point for each ring, or for each control point where the
/// body has a medial surface.
pub(super) fn rings_about(
    medial: &[Point3],
    points: &[Point3],
    rings: &Rings,
    layers: usize,
) -> CellGrid {
    let Rings { around, along, .. } = *rings;
    let node = ring_nodes(rings, layers);
    let count = node.iter().max().map_or(0, |&last| last as usize + 1);
    let mut nodes = vec![Point3::origin(); count];
    for layer in 0..=layers {
        let shrink = 1.0 - layer as f64 / layers as f64;
        for j in 0..along {
            for i in (0..around).rev() {
                // Shared nodes stand where the first of their ring does.
                let target = match rings.medial {
                    Medial::Curve => medial[j],
                    Medial::Surface => medial[j * around + i],
                };
                let place = target + (points[rings.control(i, j)] - target) * shrink;
                nodes[node[(layer * along + j) * around + i] as usize] = place;
            }
        }
    }
    let cells = ring_cells(rings, layers);
    let node_of_control = (0..points.len())
        .map(|k| {
            let (i, j) = rings.place(k);
            node[j * around + i]
        })
        .collect();
    CellGrid {
        nodes,
        cells,
        node_of_control,
    }
    .right_handed()
}

/// (layers + 1, along, around) → node; the medial curve and the poles of each shell repeat theirs, as
/// do the innermost nodes of control points opposite each other and all those of a rim.
pub fn ring_nodes(rings: &Rings, layers: usize) -> Vec<u32> {
    let Rings { around, along, .. } = *rings;
    let at = |layer: usize, j: usize, i: usize| (layer * along + j) * around + i;
    let mut node = vec![0u32; (layers + 1) * along * around];
    let mut count = 0;
    for j in 0..along {
        for layer in 0..=layers {
            for i in 0..around {
                let innermost = layer == layers;
                if i > 0 && (rings.is_pole(j) || (innermost && !rings.is_flat())) {
                    node[at(layer, j, i)] = node[at(layer, j, 0)];
                    continue;
                }
                if layer > 0 && rings.is_rim(j) {
                    node[at(layer, j, i)] = node[at(0, j, i)];
                    continue;
                }
                if innermost && rings.is_flat() && rings.opposite(j) < j {
                    node[at(layer, j, i)] = node[at(layer, rings.opposite(j), i)];
                    continue;
                }
                node[at(layer, j, i)] = count;
                count += 1;
            }
        }
    }
    node
}

/// Cells between the nodes of [`ring_nodes`].
pub fn ring_cells(rings: &Rings, layers: usize) -> Vec<Cell> {
    let Rings {
        around,
        along,
        ends,
        ..
    } = *rings;
    let node = ring_nodes(rings, layers);
    let steps_along = if ends.axis_closed { along } else { along - 1 };
    let mut cells = Vec::with_capacity(layers * steps_along * around);
    for layer in 0..layers {
        for j in (0..steps_along).filter(|&j| !rings.is_closed_up(j)) {
            for i in 0..around {
                cells.push(std::array::from_fn(|corner| {
                    let (dl, dj, di) = (corner >> 2, (corner >> 1) & 1, corner & 1);
                    node[((layer + dl) * along + (j + dj) % along) * around + (i + di) % around]
                }));
            }
        }
    }
    cells
}

/// Of each of [`ring_cells`], the number of its patch of 2 × 2 × 2 neighbours.
pub fn ring_patches(rings: &Rings, layers: usize) -> Vec<u32> {
    let (around, along) = (rings.around, rings.along);
    let steps_along = if rings.ends.axis_closed {
        along
    } else {
        along - 1
    };
    let open = (0..steps_along).filter(|&j| !rings.is_closed_up(j)).count();
    patches([layers, open, around])
}

/// Of each of [`sheet_cells`], the same.
pub fn sheet_patches(rows: usize, columns: usize, layers: usize) -> Vec<u32> {
    patches([layers - 1, rows - 1, columns - 1])
}

fn patches(counts: [usize; 3]) -> Vec<u32> {
    let [layers, rows, columns] = counts;
    let halves = [rows, columns].map(|count| count.div_ceil(2));
    let mut of_cells = Vec::with_capacity(layers * rows * columns);
    for layer in 0..layers {
        for row in 0..rows {
            for column in 0..columns {
                let patch = (layer / 2 * halves[0] + row / 2) * halves[1] + column / 2;
                of_cells.push(patch as u32);
            }
        }
    }
    of_cells
}

/// How far the medial curve ends before its poles.
#[derive(Clone, Copy, Debug)]
struct Insets {
    /// At the first and the last end, in largest ring radii.
    radii: [f64; 2],
    /// The points between give way as (1 − s)^decay, s the share of the length from that end.
    decay: i32,
}

impl Insets {
    const EVEN: Self = Self {
        radii: [0.5; 2],
        decay: 1,
    };
}

/// Insets and decays that [`rings_at_best`] tries. Large insets first: they make the larger cells.
const INSETS: [f64; 9] = [0.65, 0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.06, 0.03];
const DECAYS: [i32; 4] = [1, 2, 4, 8];

/// A least scaled Jacobian beyond which nothing is gained: sin 30°.
const GOOD_ENOUGH: f64 = 0.5;

/// Steps of the medial curve shorter than this part of its length are too short, and are widened to
/// [`LEAST_STEP`] of the mean step.
const NO_STEP: f64 = 1e-6;
const LEAST_STEP: f64 = 0.25;

/// One point a ring: along the polygon of ring centroids, drawn in at each pole (by 0.4 of the
/// length at most).
fn medial_curve(points: &[Point3], rings: &Rings, insets: &Insets) -> Vec<Point3> {
    let Rings {
        around,
        along,
        ends,
        ..
    } = *rings;
    let ring = |j: usize| (0..around).map(move |i| points[rings.control(i, j)]);
    let centroids: Vec<Point3> = (0..along)
        .map(|j| Point3::from(ring(j).map(|p| p.coords).sum::<Vector3>() / around as f64))
        .collect();
    if ends.axis_closed || !(ends.first_pole || ends.last_pole) {
        return centroids;
    }
    let mut arc = vec![0.0; along];
    for j in 1..along {
        arc[j] = arc[j - 1] + (centroids[j] - centroids[j - 1]).norm();
    }
    let length = arc[along - 1];
    let radius = |j: usize| ring(j).map(|p| (p - centroids[j]).norm()).sum::<f64>() / around as f64;
    let radius = (0..along).map(radius).fold(0.0, f64::max);
    let inset = |end: usize| (insets.radii[end] * radius).min(0.4 * length);
    let first = if ends.first_pole { inset(0) } else { 0.0 };
    let last = if ends.last_pole { inset(1) } else { 0.0 };
    let place = |s: f64| {
        let k = arc.partition_point(|&a| a <= s).clamp(1, along - 1);
        let span = arc[k] - arc[k - 1];
        let t = if span > 0.0 {
            (s - arc[k - 1]) / span
        } else {
            0.0
        };
        centroids[k - 1] + (centroids[k] - centroids[k - 1]) * t
    };
    let wanted = spread_out(&arc);
    if insets.decay == 1 {
        return wanted
            .iter()
            .map(|&s| place(first + s * (length - first - last) / length))
            .collect();
    }
    let giving = |share: f64| share.max(0.0).powi(insets.decay);
    wanted
        .iter()
        .map(|&s| place(s + first * giving(1.0 - s / length) - last * giving(s / length)))
        .collect()
}

/// Where the medial points should lie: as the centroids do, but apart. At a smooth pole the next
/// ring lies in the plane of the pole, and their centroids may be one point; two nodes there would
/// be joined by a spring without length.
fn spread_out(arc: &[f64]) -> Vec<f64> {
    let length = arc[arc.len() - 1];
    if arc
        .windows(2)
        .all(|pair| pair[1] - pair[0] > NO_STEP * length)
    {
        return arc.to_vec();
    }
    let least = LEAST_STEP * length / (arc.len() - 1) as f64;
    let mut wanted = vec![0.0];
    for pair in arc.windows(2) {
        wanted.push(wanted[wanted.len() - 1] + (pair[1] - pair[0]).max(least));
    }
    let scale = length / wanted[wanted.len() - 1];
    wanted.iter().map(|s| s * scale).collect()
}

/// Cells of an open sheet of `rows × columns` control points: `layers` ≥ 2 copies, the first is the
/// net, the last lies `thickness_m` below along the inward normals.
pub fn sheet(
    points: &[Point3],
    inward_normals: &[Vector3],
    rows: usize,
    columns: usize,
    layers: usize,
    thickness_m: f64,
) -> CellGrid {
    let mut nodes = Vec::with_capacity(points.len() * layers);
    for layer in 0..layers {
        let depth = thickness_m * layer as f64 / (layers - 1) as f64;
        nodes.extend(
            points
                .iter()
                .zip(inward_normals)
                .map(|(point, normal)| point + normal * depth),
        );
    }
    let cells = sheet_cells(rows, columns, layers);
    CellGrid {
        nodes,
        cells,
        node_of_control: (0..points.len() as u32).collect(),
    }
    .right_handed()
}

/// Cells between `layers` copies of rows × columns nodes.
pub fn sheet_cells(rows: usize, columns: usize, layers: usize) -> Vec<Cell> {
    let mut cells = Vec::new();
    for layer in 0..layers - 1 {
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                cells.push(std::array::from_fn(|corner| {
                    let (dl, dr, dc) = (corner >> 2, (corner >> 1) & 1, corner & 1);
                    (((layer + dl) * rows + row + dr) * columns + column + dc) as u32
                }));
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::basis::KnotVector;
    use palpate_geometry::surface::{ControlNet, Surface, builtin};

    /// Rings on a cylinder of revolution with both ends closed to poles: a double cone.
    fn double_cone(around: usize, along: usize) -> (Vec<Point3>, Rings) {
        let mut points = Vec::new();
        for i in 0..around {
            for j in 0..along {
                let angle = std::f64::consts::TAU * i as f64 / around as f64;
                let z = j as f64 / (along - 1) as f64;
                let radius = 0.5 * (1.0 - (2.0 * z - 1.0).abs());
                points.push(Point3::new(radius * angle.cos(), radius * angle.sin(), z));
            }
        }
        let ends = RingEnds {
            axis_closed: false,
            first_pole: true,
            last_pole: true,
        };
        (points, Rings::seamless(around, along, ends))
    }

    #[test]
    fn layers_count_as_the_formula_says_and_fill_the_control_polyhedron() {
        for (around, along, layers) in [(12, 13, 4), (22, 23, 4), (6, 5, 1)] {
            let (points, shape) = double_cone(around, along);
            let grid = rings(&points, &shape, layers);
            // Shells with two poles each, then the medial curve.
            assert_eq!(
                grid.nodes.len(),
                (around * (along - 2) + 2) * layers + along
            );
            for (k, point) in points.iter().enumerate() {
                let node = grid.nodes[grid.node_of_control[k] as usize];
                assert!(
                    (node - point).norm() < 1e-15,
                    "control point {k} is not its node"
                );
            }
            // A double cone over a regular polygon: 1/3 base × height, base = n/2 r² sin(2π/n).
            let n = around as f64;
            let base = 0.5 * n * 0.25 * (std::f64::consts::TAU / n).sin();
            let volume = grid.quality().volume_m3;
            assert!(
                (volume - base / 3.0).abs() < 1e-12,
                "{volume} != {}",
                base / 3.0
            );
            assert!(grid.quality().least_volume_m3 > 0.0);
        }
    }

    /// Rings of a surface whose u goes around, unless it is a torus, whose v does.
    fn solid(surface: &Surface, layers: usize, best: bool) -> CellGrid {
        let topology = surface.topology();
        let [u, v] = surface.distinct_counts();
        let columns = surface.net().columns();
        let torus = topology.wraps(0) && topology.wraps(1);
        let [first_pole, last_pole] = topology.poles[1];
        let ends = RingEnds {
            axis_closed: torus,
            first_pole,
            last_pole,
        };
        let (around, along) = if torus { (v, u) } else { (u, v) };
        let shape = Rings {
            around,
            along,
            ends,
            u_around: !torus,
            columns,
            medial: Medial::Curve,
        };
        let points = surface.net().points();
        if best {
            rings_at_best(points, &shape, layers)
        } else {
            rings(points, &shape, layers)
        }
    }

    /// 12 control points around, profile (radius, z) along.
    fn turned(profile: &[[f64; 2]]) -> Surface {
        let around = KnotVector::periodic_uniform(3, 12).unwrap();
        let along = KnotVector::clamped_uniform(3, profile.len()).unwrap();
        let point = |i: usize, [radius, z]: [f64; 2]| {
            let angle = std::f64::consts::TAU * i as f64 / 12.0;
            Point3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
        };
        let points = (0..12)
            .flat_map(|i| profile.iter().map(move |&p| point(i, p)))
            .collect();
        Surface::new(
            around,
            along,
            ControlNet::new(12, profile.len(), points).unwrap(),
            None,
        )
        .unwrap()
    }

    fn drop(net: usize) -> Surface {
        builtin("teardrop", Some([net; 2]), None).unwrap()
    }

    #[test]
    fn every_surface_fills_with_right_handed_cells_and_edges_that_have_a_length() {
        let tube = turned(&std::array::from_fn::<_, 9, _>(|j| [0.02, 0.01 * j as f64]));
        let can = turned(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [2.0, 2.0],
            [2.0, 3.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ]);
        let sphere = |net| builtin("sphere", net, None).unwrap();
        let surfaces = [
            ("teardrop 8", drop(8)),
            ("teardrop 12", drop(12)),
            ("teardrop 20", drop(20)),
            ("sphere", sphere(None)),
            ("sphere 12 × 9", sphere(Some([12, 9]))),
            ("torus", builtin("torus", None, None).unwrap()),
            ("tube", tube),
            ("can", can),
        ];
        for (name, surface) in &surfaces {
            for layers in 1..=4 {
                for best in [false, true] {
                    let grid = solid(surface, layers, best);
                    let quality = grid.quality();
                    let what = format!("{name}, {layers} layers, best {best}: {quality:?}");
                    assert_eq!(quality.folded_cells, 0, "{what}");
                    assert!(
                        grid.cells.iter().all(|cell| grid.signed_volume(cell) > 0.0),
                        "{what}"
                    );
                    assert!(quality.edge_m[0] > 1e-4 * surface.size(), "{what}");
                    for (k, point) in surface.net().points().iter().enumerate() {
                        let off = (grid.nodes[grid.node_of_control[k] as usize] - point).norm();
                        assert!(off < 1e-15, "{what}: control point {k} is off by {off} m");
                    }
                }
            }
        }
    }

    // The least scaled Jacobian was 0.13 to 0.23 here with the medial curve at even insets.
    #[test]
    fn refined_teardrops_have_good_corners_when_the_medial_curve_reaches_into_their_point() {
        for net in [[12, 13], [22, 23]] {
            let refined = drop(8).refined_to(net[0], net[1]).unwrap();
            for layers in 2..=4 {
                let quality = solid(&refined, layers, true).quality();
                assert!(
                    quality.least_scaled_jacobian_hexahedra >= GOOD_ENOUGH,
                    "{net:?} × {layers}: {quality:?}"
                );
                assert_eq!(
                    quality.folded_corner_cells, 0,
                    "{net:?} × {layers}: {quality:?}"
                );
            }
        }
    }
}
