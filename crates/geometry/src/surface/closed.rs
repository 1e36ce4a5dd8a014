//! How a surface closes: periodic directions, seams, poles, the volume inside and which side is
//! out.
//!
//! Edges are compared as curves in homogeneous coordinates; two points are one when they are within
//! [`SAME_POINT`] × size. Finds a surface closed when opposite edges meet or each is a single point
//! (teardrop, sphere, torus); edges joined in other pairs, as on branching surfaces, are found by
//! [`Surface::joints`].

use super::joints::Sets;
use super::{ClosestPoint, Closing, ControlNet, Surface, Topology};
use crate::basis::{KnotKind, KnotVector, Side};
use crate::math::{Point3, Vector3, gauss_legendre};

/// Points closer than this times [`Surface::size`] are one point. Files with 12 digits pass,
/// features do not vanish.
pub const SAME_POINT: f64 = 1e-9;

/// Points a span and direction for rational surfaces, whose volume no rule gives exactly: a quarter
/// circle's integrand then converges to rounding.
pub(super) const RATIONAL_NODES: usize = 24;

impl Surface {
    /// Diagonal of the net's bounding box, m: the length that tolerances are relative to.
    pub fn size(&self) -> f64 {
        self.net().size()
    }

    /// A foot is where the surface ends: on its rim, not where two rims lie upon each other within `close_m`.
    pub fn ends_at(&self, foot: &ClosestPoint, close_m: f64) -> bool {
        let at_end = |knots: &KnotVector, t: f64, other: &dyn Fn(f64) -> Point3| {
            let (start, end) = knots.domain();
            let opposite = if t <= start { end } else { start };
            !knots.is_periodic()
                && (t <= start || t >= end)
                && (other(opposite) - foot.point).norm() > close_m
        };
        at_end(self.knots_u(), foot.u, &|u| self.point(u, foot.v))
            || at_end(self.knots_v(), foot.v, &|v| self.point(foot.u, v))
    }

    /// Inside of the surface or on a periodic seam, and on no crease.
    pub fn is_smooth_at(&self, u: f64, v: f64) -> bool {
        [(self.knots_u(), u), (self.knots_v(), v)]
            .into_iter()
            .all(|(knots, t)| {
                let (start, end) = knots.domain();
                let inside = knots.is_periodic() || (t > start && t < end);
                inside && knots.multiplicity(t) < knots.degree()
            })
    }

    /// How the surface closes, as its net is now.
    pub fn topology(&self) -> Topology {
        let tolerance = SAME_POINT * self.size();
        let mut topology = Topology {
            closing: [Closing::Open; 2],
            poles: [[false; 2]; 2],
            torn: [false; 2],
        };
        let whole = self.joints().is_some_and(|joints| joints.is_whole());
        for (direction, knots) in [self.knots_u(), self.knots_v()].into_iter().enumerate() {
            let (start, end) = knots.domain();
            let first = self.iso_row(direction, start, Side::Right);
            let last = self.iso_row(direction, end, Side::Left);
            let meet = coincide(&first, &last, tolerance);
            topology.closing[direction] = match knots.kind() {
                KnotKind::Periodic => Closing::Periodic,
                KnotKind::Clamped if meet => Closing::Seam,
                KnotKind::Open if meet => Closing::Touching,
                KnotKind::Clamped | KnotKind::Open => Closing::Open,
            };
            if !knots.is_periodic() {
                topology.poles[direction] = [
                    is_one_point(&first, tolerance),
                    is_one_point(&last, tolerance),
                ];
            }
            topology.torn[direction] = !whole
                && knots.disjoined().into_iter().any(|knot| {
                    let left = self.iso_row(direction, knot, Side::Left);
                    let right = self.iso_row(direction, knot, Side::Right);
                    !coincide(&left, &right, tolerance)
                });
        }
        topology
    }

    /// Signed volume inside a closed surface, m³: positive when the normals point outwards. Exact
    /// up to rounding without weights. On a surface that is not closed, the volume of the cone from
    /// the net's centre to it.
    pub fn volume(&self) -> f64 {
        // ∫ div(x / 3) dV = 1/3 ∮ S · (S_u × S_v) du dv; from the centre, where least cancels.
        let points = self.net().points();
        let centre: Vector3 =
            points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64;
        let count = |knots: &KnotVector| {
            // S is of degree p in u, S_u of p − 1, S_v of p: 3p − 1 together.
            let exact = (3 * knots.degree()).div_ceil(2);
            if self.weights().is_some() {
                exact.max(RATIONAL_NODES)
            } else {
                exact
            }
        };
        let counts = [count(self.knots_u()), count(self.knots_v())];
        let sum = self.integrate(counts, |frame| {
            (frame.point.coords - centre).dot(&frame.du.cross(&frame.dv))
        });
        if self.flip_normal() {
            -sum / 3.0
        } else {
            sum / 3.0
        }
    }

    /// Returns this surface with its normals flipped if it is closed and they point inwards.
    pub fn oriented_outward(self) -> Self {
        if self.topology().is_closed() && self.volume() < 0.0 {
            let flip = !self.flip_normal();
            self.with_flip_normal(flip)
        } else {
            self
        }
    }

    /// Returns this surface with control points of seams, joints and poles that agree within the
    /// tolerance made equal bit for bit, and with them the weights of seams.
    pub fn with_exact_seams(mut self) -> Self {
        let topology = self.topology();
        let nodes = self.distinct_points(&topology);
        self.match_weights(&topology);
        let mut place: Vec<Option<Point3>> = vec![None; nodes.count];
        for (point, &node) in self.net_mut().points_mut().iter_mut().zip(&nodes.of) {
            *point = *place[node].get_or_insert(*point);
        }
        self
    }

    /// Weights along the end of a seam: those along its start times one ratio, where they are not
    /// already but for the last digits.
    fn match_weights(&mut self, topology: &Topology) {
        let (rows, columns) = (self.net().rows(), self.net().columns());
        let Some(weights) = self.weights_mut() else {
            return;
        };
        let mut copy = |first: &[usize], last: &[usize]| {
            let ratio = weights[last[0]] / weights[first[0]];
            for (&a, &b) in first.iter().zip(last) {
                let wanted = ratio * weights[a];
                if (weights[b] - wanted).abs() > 8.0 * f64::EPSILON * wanted {
                    weights[b] = wanted;
                }
            }
        };
        let row = |i: usize| -> Vec<usize> { (0..columns).map(|j| i * columns + j).collect() };
        let column = |j: usize| -> Vec<usize> { (0..rows).map(|i| i * columns + j).collect() };
        if topology.closing[0] == Closing::Seam {
            copy(&row(0), &row(rows - 1));
        }
        if topology.closing[1] == Closing::Seam {
            copy(&column(0), &column(columns - 1));
        }
    }

    /// Which control points are one point: rows of a clamped seam, columns likewise, those that an
    /// open direction repeats, both sides of a knot that parts a surface which meets there, the rows
    /// of clamped poles, and what [`Surface::joints`] finds on a branching surface.
    pub fn distinct_points(&self, topology: &Topology) -> DistinctPoints {
        let (rows, columns) = (self.net().rows(), self.net().columns());
        let clamped =
            [self.knots_u(), self.knots_v()].map(|knots| knots.kind() == KnotKind::Clamped);
        let pole =
            |direction: usize, end: usize| clamped[direction] && topology.poles[direction][end];
        let at = |i: usize, j: usize| i * columns + j;
        let mut joined = Sets::new(rows * columns);
        if topology.closing[0] == Closing::Seam {
            (0..columns).for_each(|j| joined.join(at(0, j), at(rows - 1, j)));
        }
        if topology.closing[1] == Closing::Seam {
            (0..rows).for_each(|i| joined.join(at(i, 0), at(i, columns - 1)));
        }
        for (end, (row, column)) in [(0, 0), (rows - 1, columns - 1)].into_iter().enumerate() {
            if pole(0, end) {
                (1..columns).for_each(|j| joined.join(at(row, 0), at(row, j)));
            }
            if pole(1, end) {
                (1..rows).for_each(|i| joined.join(at(0, column), at(i, column)));
            }
        }
        if let Some(joints) = self.joints() {
            joints
                .first_at_place()
                .iter()
                .enumerate()
                .for_each(|(k, &first)| joined.join(k, first));
        } else {
            for (direction, [a, b]) in self.meeting_rows(topology) {
                let count = [columns, rows][direction];
                (0..count).for_each(|x| match direction {
                    0 => joined.join(at(a, x), at(b, x)),
                    _ => joined.join(at(x, a), at(x, b)),
                });
            }
        }
        let mut number = vec![usize::MAX; rows * columns];
        let mut count = 0;
        for k in 0..number.len() {
            let root = joined.root(k);
            if number[root] == usize::MAX {
                number[root] = count;
                count += 1;
            }
            number[k] = number[root];
        }
        DistinctPoints { count, of: number }
    }

    /// Rows that agree within the tolerance, as (direction, both): of an open direction that repeats
    /// its points, and on both sides of a disjoined knot.
    fn meeting_rows(&self, topology: &Topology) -> Vec<(usize, [usize; 2])> {
        let tolerance = SAME_POINT * self.size();
        let mut found = Vec::new();
        for (d, knots) in [self.knots_u(), self.knots_v()].into_iter().enumerate() {
            let (p, n) = (knots.degree(), knots.count());
            let agree = |pairs: &[[usize; 2]]| {
                (pairs.iter()).all(|pair| {
                    let [a, b] = pair.map(|row| self.control_row(d, row));
                    coincide(&a, &b, tolerance)
                })
            };
            let repeated: Vec<_> = (0..p).map(|k| [k, n - p + k]).collect();
            let parted: Vec<_> = knots.parted_after().iter().map(|&k| [k, k + 1]).collect();
            if topology.closing[d] == Closing::Touching && n >= 2 * p && agree(&repeated) {
                found.extend(repeated.into_iter().map(|pair| (d, pair)));
            }
            let met = parted.into_iter().filter(|pair| agree(&[*pair]));
            found.extend(met.map(|pair| (d, pair)));
        }
        found
    }

    /// Control points (with weights) of a row (direction 0) or a column.
    pub(super) fn control_row(&self, direction: usize, row: usize) -> Vec<(Point3, f64)> {
        let (rows, columns) = (self.net().rows(), self.net().columns());
        let index = |x: usize| [row * columns + x, x * columns + row][direction];
        let count = [columns, rows][direction];
        let weight = |k: usize| self.weights().map_or(1.0, |w| w[k]);
        (0..count)
            .map(|x| (self.net().points()[index(x)], weight(index(x))))
            .collect()
    }

    /// Control points (with weights) of the curve at one parameter of a direction (0: u, 1: v).
    pub(super) fn iso_row(
        &self,
        direction: usize,
        parameter: f64,
        side: Side,
    ) -> Vec<(Point3, f64)> {
        let (rows, columns) = (self.net().rows(), self.net().columns());
        let (knots, count, across) = if direction == 0 {
            (self.knots_u(), columns, rows)
        } else {
            (self.knots_v(), rows, columns)
        };
        let window = knots.window_from(parameter, side);
        (0..count)
            .map(|j| {
                let (mut sum, mut weight) = (Vector3::zeros(), 0.0);
                for (a, value) in window.values().iter().enumerate() {
                    let i = super::tensor::wrap(window.first + a, across);
                    let k = if direction == 0 {
                        i * columns + j
                    } else {
                        j * columns + i
                    };
                    let share = value * self.weights().map_or(1.0, |w| w[k]);
                    sum += self.net().points()[k].coords * share;
                    weight += share;
                }
                (Point3::from(sum / weight), weight)
            })
            .collect()
    }
}

/// Numbers of the distinct control points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DistinctPoints {
    /// How many there are.
    pub count: usize,
    /// (rows × columns) number of each control point, u-major; numbered in order of first
    /// appearance.
    pub of: Vec<usize>,
}

impl DistinctPoints {
    /// Copies the positions of the distinct points, (count), into a net of this shape.
    pub fn scatter(&self, positions: &[Point3], net: &mut ControlNet) {
        debug_assert_eq!(
            positions.len(),
            self.count,
            "one position for each distinct point"
        );
        for (point, &node) in net.points_mut().iter_mut().zip(&self.of) {
            *point = positions[node];
        }
    }
}

/// Parameters and weights of `per_span` Gauss points in each span of positive length.
pub(crate) fn gauss_nodes(knots: &KnotVector, per_span: usize) -> Vec<(f64, f64)> {
    let rule = gauss_legendre(per_span);
    let t = knots.knots();
    let mut nodes = Vec::new();
    for i in knots.spans() {
        let (middle, half) = (0.5 * (t[i] + t[i + 1]), 0.5 * (t[i + 1] - t[i]));
        nodes.extend(
            rule.iter()
                .map(|(x, weight)| (middle + half * x, half * weight)),
        );
    }
    nodes
}

/// Same points, and weights in one constant ratio: then the curves are the same at every parameter.
fn coincide(a: &[(Point3, f64)], b: &[(Point3, f64)], tolerance: f64) -> bool {
    let ratio = a[0].1 / b[0].1;
    a.iter().zip(b).all(|(x, y)| {
        (x.0 - y.0).norm() <= tolerance && (x.1 / y.1 - ratio).abs() <= SAME_POINT * ratio.abs()
    })
}

fn is_one_point(row: &[(Point3, f64)], tolerance: f64) -> bool {
    row.iter()
        .all(|(point, _)| (point - row[0].0).norm() <= tolerance)
}

#[cfg(test)]
mod tests {
    use super::super::Direction;
    use super::super::builtin::builtin;
    use super::super::testing::tilted;
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn teardrops_and_spheres_have_a_seam_and_two_poles() {
        for name in ["teardrop", "sphere"] {
            let topology = tilted(&builtin(name, None, None).unwrap()).topology();
            assert_eq!(topology.closing, [Closing::Seam, Closing::Open], "{name}");
            assert_eq!(topology.poles, [[false; 2], [true; 2]], "{name}");
            assert!(topology.is_closed());
        }
    }

    #[test]
    fn a_torus_is_periodic_twice_and_a_sheet_is_open() {
        let torus = builtin("torus", None, None).unwrap().topology();
        assert_eq!(
            (torus.closing, torus.is_closed()),
            ([Closing::Periodic; 2], true)
        );
        let sheet = builtin("sheet", None, None).unwrap().topology();
        assert_eq!(
            (sheet.closing, sheet.poles),
            ([Closing::Open; 2], [[false; 2]; 2])
        );
        assert!(!sheet.is_closed());
    }

    #[test]
    fn a_seam_is_found_to_a_billionth_of_the_size_and_not_beyond() {
        let drop = builtin("teardrop", None, None).unwrap();
        for (gap, closed) in [(0.9, true), (1.2, false)] {
            let mut torn = drop.clone();
            let gap = gap * SAME_POINT * drop.size();
            torn.net_mut().points_mut()[3].x += gap;
            assert_eq!(torn.topology().is_closed(), closed, "gap {gap}");
            if closed {
                let mended = torn.with_exact_seams();
                assert_eq!(mended.net().at(0, 3), mended.net().at(7, 3));
            }
        }
    }

    // A cylinder without caps: its seam closes it round, but not at its ends.
    #[test]
    fn a_tube_is_not_closed_and_a_disjoined_sphere_is_torn() {
        let sphere = builtin("sphere", None, None).unwrap();
        let tube = sphere.insert_knots(Direction::V, &[0.5]).unwrap();
        assert!(tube.topology().is_closed(), "its parts still meet");
        let mut torn = tube.clone();
        let columns = torn.net().columns();
        let half = columns / 2;
        for (k, point) in torn.net_mut().points_mut().iter_mut().enumerate() {
            if k % columns >= half {
                point.z += 0.01;
            }
        }
        assert_eq!(torn.topology().torn, [false, true]);
        assert!(!torn.topology().is_closed());
    }

    #[test]
    fn volume_of_a_rational_sphere_is_four_thirds_pi() {
        for radius in [0.05, 3.0] {
            let sphere = tilted(&builtin("sphere", None, Some(radius)).unwrap());
            let exact = 4.0 / 3.0 * PI * radius.powi(3);
            let error = sphere.volume() / exact - 1.0;
            assert!(
                error.abs() < 1e-12,
                "radius {radius}: relative error {error}"
            );
        }
    }

    // Triangles in disguise: degree 1, a square ring, and both caps collapsed to points.
    #[test]
    fn volume_of_a_faceted_spindle_is_that_of_its_pyramids() {
        let knots_u = KnotVector::periodic_uniform(1, 4).unwrap();
        let knots_v = KnotVector::clamped_uniform(1, 3).unwrap();
        let ring = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let points = ring
            .iter()
            .flat_map(|&[x, y]| {
                [
                    Point3::new(0.0, 0.0, -2.0),
                    Point3::new(x, y, 0.0),
                    Point3::new(0.0, 0.0, 1.0),
                ]
            })
            .collect();
        let spindle = Surface::new(
            knots_u,
            knots_v,
            ControlNet::new(4, 3, points).unwrap(),
            None,
        )
        .unwrap();
        assert!(spindle.topology().is_closed());
        // Two pyramids over a square of area 2, heights 2 and 1.
        assert!(
            (spindle.volume() - 2.0 * 3.0 / 3.0).abs() < 1e-14,
            "{}",
            spindle.volume()
        );
    }

    // Independent of quadrature: tetrahedra from the centre to a fine triangulation, whose error
    // falls by 4 with each halving; extrapolated twice.
    #[test]
    fn volume_of_the_teardrop_is_what_fine_triangles_tend_to() {
        let drop = builtin("teardrop", None, None).unwrap();
        let triangles = |count: usize| -> f64 {
            let grid: Vec<Vec<Point3>> = (0..=count)
                .map(|i| {
                    (0..=count)
                        .map(|j| drop.point(i as f64 / count as f64, j as f64 / count as f64))
                        .collect()
                })
                .collect();
            let mut six_times = 0.0;
            for i in 0..count {
                for j in 0..count {
                    let [a, b, c, d] = [
                        grid[i][j],
                        grid[i + 1][j],
                        grid[i + 1][j + 1],
                        grid[i][j + 1],
                    ]
                    .map(|p| p.coords);
                    six_times += a.dot(&b.cross(&c)) + a.dot(&c.cross(&d));
                }
            }
            (six_times / 6.0).abs()
        };
        // Counts divisible by the five spans, so that every cell is smooth.
        let (coarse, middle, fine) = (triangles(40), triangles(80), triangles(160));
        let (first, second) = ((4.0 * middle - coarse) / 3.0, (4.0 * fine - middle) / 3.0);
        let limit = (16.0 * second - first) / 15.0;
        let volume = drop.volume();
        assert!(
            (volume - limit).abs() < 1e-9 * volume,
            "{volume} m³, triangles tend to {limit} m³"
        );
    }

    #[test]
    fn normals_are_turned_outwards_whatever_the_parametrisation() {
        for name in ["teardrop", "sphere", "torus"] {
            let surface = builtin(name, None, None).unwrap();
            for twisted in [
                surface.clone(),
                surface.swap_uv(),
                surface.clone().with_flip_normal(!surface.flip_normal()),
            ] {
                assert!(twisted.oriented_outward().volume() > 0.0, "{name}");
            }
        }
    }

    #[test]
    fn distinct_points_merge_seams_and_poles() {
        let count = |name: &str| {
            let surface = builtin(name, None, None).unwrap();
            surface.distinct_points(&surface.topology()).count
        };
        // 7 × 6 between the poles, and the poles.
        assert_eq!(count("teardrop"), 7 * 6 + 2);
        assert_eq!(count("sphere"), 8 * 3 + 2);
        assert_eq!(count("torus"), 16 * 12);
        assert_eq!(count("sheet"), 64);
        let drop = builtin("teardrop", None, None).unwrap();
        let distinct = drop.distinct_points(&drop.topology());
        let first = |node: usize| distinct.of.iter().position(|&of| of == node).unwrap();
        let positions: Vec<Point3> = (0..distinct.count)
            .map(|node| drop.net().points()[first(node)])
            .collect();
        let mut net = drop.net().clone();
        net.points_mut().fill(Point3::origin());
        distinct.scatter(&positions, &mut net);
        assert_eq!(&net, drop.net());
    }
}
