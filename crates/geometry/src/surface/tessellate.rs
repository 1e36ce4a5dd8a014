//! Triangles from surfaces: so many to a span, or as many as keep them within a distance.
//!
//! A surface over a rectangle h × k of parameters lies within `(h² max|S_uu| + 2 h k max|S_uv| + k²
//! max|S_vv|) / 8` of the two triangles over it (Filip, Magedson & Markot 1986). The second
//! derivatives of a Bézier piece are bounded by the differences of its control points; with weights
//! by those of numerator and denominator.
//!
//! Edges between cells are shared, ends that meet are one row of corners and a pole is one corner,
//! so that a closed surface gives a closed mesh. At creases and gaps corners are doubled: each side
//! has its own normals. Of a branching surface each patch is drawn once, and corners on joined
//! edges are equal bit for bit.

use super::joints::{Edge, Joints, Sets};
use super::{BezierPieces, Mesh, Surface};
use crate::basis::{KnotVector, Side};
use crate::math::{Point3, Vector3};

/// Most corners of a mesh.
const MOST_CORNERS: usize = 1 << 24;

/// Why a surface was not tessellated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TessellateError {
    /// Not a length.
    #[error("a tolerance of {0} m cannot be kept: it must be finite and above 0")]
    Tolerance(f64),
    /// No cells.
    #[error("a span needs at least one cell in each direction")]
    NoCells,
    /// Too fine.
    #[error("that takes more than {MOST_CORNERS} corners: allow a greater distance or fewer cells")]
    TooFine,
}

impl Surface {
    /// Every span of positive length cut evenly into that many cells in u and v, two triangles
    /// each.
    ///
    /// # Errors
    /// No cells, or more than 2²⁴ corners.
    pub fn tessellated(&self, cells: [usize; 2]) -> Result<Mesh, TessellateError> {
        if cells.contains(&0) {
            return Err(TessellateError::NoCells);
        }
        let each = |knots: &KnotVector, cells: usize| vec![cells; knots.spans().count()];
        self.mesh(
            &each(self.knots_u(), cells[0]),
            &each(self.knots_v(), cells[1]),
        )
    }

    /// As many triangles as keep every point of the surface within `tolerance` (m) of them.
    ///
    /// # Errors
    /// A tolerance that is not finite and above 0, or one that takes more than 2²⁴ corners.
    pub fn tessellated_to(&self, tolerance: f64) -> Result<Mesh, TessellateError> {
        if !(tolerance.is_finite() && tolerance > 0.0) {
            return Err(TessellateError::Tolerance(tolerance));
        }
        let pieces = BezierPieces::new(self);
        let across = self.knots_v().spans().count();
        let (mut cells_u, mut cells_v) = (vec![1; pieces.len() / across], vec![1; across]);
        for piece in (0..pieces.len()).filter(|&piece| !pieces.is_duplicate(piece)) {
            // (n, m) cells: a/n² + 2b/nm + c/m² is at most (a + b)/n² + (c + b)/m², of which each
            // gets half.
            let [a, b, c] = pieces.second_derivative_bounds(piece);
            for (bound, most) in [
                (a + b, &mut cells_u[piece / across]),
                (c + b, &mut cells_v[piece % across]),
            ] {
                let needed = (bound / (4.0 * tolerance)).sqrt().ceil();
                if needed > MOST_CORNERS as f64 {
                    return Err(TessellateError::TooFine);
                }
                *most = (*most).max(needed as usize);
            }
        }
        if let Some(joints) = pieces.joints() {
            joints.cut_alike([&mut cells_u, &mut cells_v]);
        }
        self.mesh(&cells_u, &cells_v)
    }

    fn mesh(&self, cells_u: &[usize], cells_v: &[usize]) -> Result<Mesh, TessellateError> {
        let lines = |cells: &[usize]| {
            cells
                .iter()
                .try_fold(2 * cells.len(), |sum, n| sum.checked_add(*n))
        };
        let corners = lines(cells_u)
            .zip(lines(cells_v))
            .and_then(|(n, m)| n.checked_mul(m));
        if corners.is_none_or(|n| n > MOST_CORNERS) {
            return Err(TessellateError::TooFine);
        }
        let (us, vs) = (
            stations(self.knots_u(), cells_u),
            stations(self.knots_v(), cells_v),
        );
        let topology = self.topology();
        let joints = self.joints();
        let shown = |a: &Station, b: &Station| {
            joints
                .as_ref()
                .is_none_or(|t| !t.is_duplicate(a.span, b.span))
        };
        let mut mesh = Mesh::default();
        let mut numbers = vec![0_u32; us.len() * vs.len()];
        for (i, a) in us.iter().enumerate() {
            for (j, b) in vs.iter().enumerate() {
                if !shown(a, b) {
                    continue;
                }
                let (last_u, last_v) = (i + 1 == us.len(), j + 1 == vs.len());
                let pole = |direction: usize, first: bool, last: bool| {
                    (first && topology.poles[direction][0])
                        || (last && topology.poles[direction][1])
                };
                // The corner that this one is the same as.
                let (mut row, mut column) = (i, j);
                if last_u && topology.wraps(0) && smooth_closure(self.knots_u()) {
                    row = 0;
                }
                if last_v && topology.wraps(1) && smooth_closure(self.knots_v()) {
                    column = 0;
                }
                if pole(0, i == 0, last_u) {
                    column = 0;
                }
                if pole(1, j == 0, last_v) {
                    row = 0;
                }
                if (row, column) != (i, j) {
                    numbers[i * vs.len() + j] = numbers[row * vs.len() + column];
                    continue;
                }
                let frame = self.frame_from(a.at, b.at, a.side, b.side);
                numbers[i * vs.len() + j] = mesh.points.len() as u32;
                // The same point from either side of a crease, to the last bit.
                let whole = |knots: &KnotVector, s: &Station| {
                    if knots.multiplicity(s.at) <= knots.degree() {
                        Side::Right
                    } else {
                        s.side
                    }
                };
                let (side_u, side_v) = (whole(self.knots_u(), a), whole(self.knots_v(), b));
                mesh.points
                    .push(self.frame_from(a.at, b.at, side_u, side_v).point);
                mesh.normals.push(self.normal_of(&frame, a.at, b.at));
            }
        }
        if let Some(joints) = &joints {
            Self::weld(joints, [&us, &vs], &numbers, &mut mesh.points);
        }
        for i in (0..us.len() - 1).filter(|&i| us[i].joined) {
            for j in (0..vs.len() - 1).filter(|&j| vs[j].joined) {
                if !shown(&us[i], &vs[j]) {
                    continue;
                }
                let number = |i: usize, j: usize| numbers[i * vs.len() + j];
                let cell = [
                    number(i, j),
                    number(i + 1, j),
                    number(i + 1, j + 1),
                    number(i, j + 1),
                ];
                mesh.add_cell(cell, self.flip_normal());
            }
        }
        Ok(mesh)
    }

    /// Corners on joined edges, which are as many on either side, made equal to the last bit.
    fn weld(joints: &Joints, stations: [&[Station]; 2], numbers: &[u32], points: &mut [Point3]) {
        let columns = stations[1].len();
        let corners = |edge: Edge| -> Vec<u32> {
            let strips = joints.strips_of(edge.patch);
            let held = edge.side / 2;
            let within = |d: usize| {
                let all = stations[d];
                let from = all.partition_point(|s| s.span < strips[d].spans.start);
                from..all.partition_point(|s| s.span < strips[d].spans.end)
            };
            let (across, along) = (within(held), within(1 - held));
            let at = if edge.side.is_multiple_of(2) {
                across.start
            } else {
                across.end - 1
            };
            along
                .map(|k| {
                    numbers[if held == 0 {
                        at * columns + k
                    } else {
                        k * columns + at
                    }]
                })
                .collect()
        };
        let mut same = Sets::new(points.len());
        for (a, b, against) in joints.seams() {
            let (mut one, other) = (corners(a), corners(b));
            if against {
                one.reverse();
            }
            debug_assert_eq!(one.len(), other.len(), "joined edges are cut alike");
            one.into_iter()
                .zip(other)
                .for_each(|(x, y)| same.join(x as usize, y as usize));
        }
        for k in 0..points.len() {
            points[k] = points[same.root(k)];
        }
    }
}

/// Where a row of corners lies.
struct Station {
    at: f64,
    side: Side,
    /// Among the spans of positive length: that of the cell before, at the end of a part.
    span: usize,
    /// A cell lies between this and the next.
    joined: bool,
}

fn stations(knots: &KnotVector, cells: &[usize]) -> Vec<Station> {
    let t = knots.knots();
    let mut stations: Vec<Station> = Vec::new();
    for (k, (span, &cells)) in knots.spans().zip(cells).enumerate() {
        let (start, end) = (t[span], t[span + 1]);
        if knots.multiplicity(start) >= knots.degree() || stations.is_empty() {
            stations.push(Station {
                at: start,
                side: Side::Right,
                span: k,
                joined: true,
            });
        } else if let Some(last) = stations.last_mut() {
            (last.joined, last.side, last.span) = (true, Side::Right, k);
        }
        for m in 1..cells {
            let at = start + (end - start) * (m as f64 / cells as f64);
            stations.push(Station {
                at,
                side: Side::Right,
                span: k,
                joined: true,
            });
        }
        stations.push(Station {
            at: end,
            side: Side::Left,
            span: k,
            joined: false,
        });
    }
    stations
}

/// The two ends of a direction that closes can share corners: a clamped seam is only known to be
/// continuous, but like a periodic one it is meant to be smooth unless its knots crease it.
fn smooth_closure(knots: &KnotVector) -> bool {
    !knots.is_periodic() || knots.multiplicity(knots.domain().0) < knots.degree()
}

impl Mesh {
    /// Two triangles across the shorter diagonal; those without area, at poles, are left out.
    fn add_cell(&mut self, [a, b, c, d]: [u32; 4], flip: bool) {
        let at = |k: u32| &self.points[k as usize];
        let halves = if (at(a) - at(c)).norm_squared() <= (at(b) - at(d)).norm_squared() {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        };
        for [x, y, z] in halves {
            if x != y && y != z && z != x {
                self.triangles
                    .push(if flip { [x, z, y] } else { [x, y, z] });
            }
        }
    }
}

impl BezierPieces {
    /// Bounds of |S_uu| h², |S_uv| h k and |S_vv| k² on a piece of h × k parameters, m.
    pub(crate) fn second_derivative_bounds(&self, piece: usize) -> [f64; 3] {
        let (p, q) = (self.u.degree, self.v.degree);
        let points = self.points(piece);
        let (mut least, mut reach) = (f64::INFINITY, 0.0_f64);
        let centre = Point3::from(Vector3::from_fn(|c, _| points[0][c] / points[0][3]));
        // Numerator from the centre, and weight.
        let at = |i: usize, j: usize| {
            let [x, y, z, w] = points[i * (q + 1) + j];
            (Vector3::new(x, y, z) - centre.coords * w, w)
        };
        for i in 0..=p {
            for j in 0..=q {
                let (a, w) = at(i, j);
                least = least.min(w);
                reach = reach.max(a.norm() / w);
            }
        }
        // Greatest difference of order (k, l), for numerator and weight, times the degrees that a
        // derivative brings.
        let differences = |k: usize, l: usize| -> (f64, f64) {
            if k > p || l > q {
                return (0.0, 0.0);
            }
            let binomial = [[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [1.0, -2.0, 1.0]];
            let falling = |n: usize, k: usize| (0..k).map(|r| (n - r) as f64).product::<f64>();
            let (mut a, mut w) = (0.0_f64, 0.0_f64);
            for i in 0..=p - k {
                for j in 0..=q - l {
                    let (mut da, mut dw) = (Vector3::zeros(), 0.0);
                    for r in 0..=k {
                        for s in 0..=l {
                            let (x, y) = at(i + r, j + s);
                            da += x * (binomial[k][r] * binomial[l][s]);
                            dw += y * (binomial[k][r] * binomial[l][s]);
                        }
                    }
                    (a, w) = (a.max(da.norm()), w.max(dw.abs()));
                }
            }
            let factor = falling(p, k) * falling(q, l);
            (a * factor, w * factor)
        };
        let [(au, wu), (av, wv)] = [differences(1, 0), differences(0, 1)];
        let [(auu, wuu), (auv, wuv), (avv, wvv)] =
            [differences(2, 0), differences(1, 1), differences(0, 2)];
        // |S − centre| is at most `reach`; then S_u = (A_u − w_u S) / w, and so on.
        let (su, sv) = ((au + wu * reach) / least, (av + wv * reach) / least);
        [
            (auu + 2.0 * wu * su + wuu * reach) / least,
            (auv + wu * sv + wv * su + wuv * reach) / least,
            (avv + 2.0 * wv * sv + wvv * reach) / least,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::Direction;
    use super::super::builtin::builtin;
    use super::super::testing::fifty_surfaces;
    use super::*;
    use std::collections::BTreeMap;

    fn volume(mesh: &Mesh) -> f64 {
        let at = |k: u32| mesh.points[k as usize].coords;
        mesh.triangles
            .iter()
            .map(|&[a, b, c]| at(a).dot(&at(b).cross(&at(c))) / 6.0)
            .sum()
    }

    #[test]
    fn closed_surfaces_give_closed_meshes_that_face_outwards() {
        for name in ["teardrop", "sphere", "torus"] {
            let surface = builtin(name, None, None)
                .unwrap()
                .refined_to(14, 15)
                .unwrap();
            for mesh in [
                surface.tessellated([3, 4]).unwrap(),
                surface.tessellated_to(1e-4).unwrap(),
            ] {
                let mut edges: BTreeMap<([u64; 3], [u64; 3]), i32> = BTreeMap::new();
                // Corners of a crease are two at one place.
                let place = |k: u32| -> [u64; 3] {
                    mesh.points[k as usize].coords.map(f64::to_bits).into()
                };
                for [a, b, c] in mesh.triangles.iter().map(|t| t.map(place)) {
                    for (from, to) in [(a, b), (b, c), (c, a)] {
                        *edges.entry((from.min(to), from.max(to))).or_default() +=
                            if from < to { 1 } else { -1 };
                    }
                }
                assert!(
                    edges.values().all(|sum| *sum == 0),
                    "{name}: an edge without a partner"
                );
                let (ours, exact) = (volume(&mesh), surface.volume());
                assert!(
                    (ours / exact - 1.0).abs() < 0.05,
                    "{name}: {ours} m³ of {exact} m³"
                );
                // Every triangle faces as its corners do.
                for &[a, b, c] in &mesh.triangles {
                    let [x, y, z] = [a, b, c].map(|k| mesh.points[k as usize]);
                    let across = (y - x).cross(&(z - x));
                    let normals = [a, b, c].map(|k| mesh.normals[k as usize]);
                    assert!(
                        normals.iter().all(|n| (n.norm() - 1.0).abs() < 1e-12),
                        "{name}"
                    );
                    // One corner alone may look away, at a tip that a coarse triangle cuts off.
                    let facing = normals.iter().sum::<Vector3>().dot(&across.normalize());
                    assert!(
                        facing > 0.0,
                        "{name}: {x} {y} {z} faces its normals {normals:?} by {facing}"
                    );
                }
            }
        }
    }

    /// Distance from a point to a triangle: by descending on barycentric coordinates over a fine
    /// grid, refined; slow.
    fn distance(point: &Point3, [a, b, c]: [Point3; 3]) -> f64 {
        let (mut best, mut centre, mut size) = (f64::INFINITY, (1.0 / 3.0, 1.0 / 3.0), 1.0);
        for _ in 0..12 {
            let around = centre;
            for i in -4..=4 {
                for j in -4..=4 {
                    let s = (around.0 + size * f64::from(i) / 4.0).clamp(0.0, 1.0);
                    let t = (around.1 + size * f64::from(j) / 4.0).clamp(0.0, 1.0 - s);
                    let d = (a + (b - a) * s + (c - a) * t - point).norm();
                    if d < best {
                        (best, centre) = (d, (s, t));
                    }
                }
            }
            size *= 0.4;
        }
        best
    }

    #[test]
    fn no_point_is_further_from_the_triangles_than_asked() {
        let mut closeness: Vec<f64> = Vec::new();
        for surface in fifty_surfaces(81).iter().take(16) {
            if surface.topology().wraps(0) || surface.topology().wraps(1) {
                continue;
            }
            let tolerance = 0.01 * surface.size();
            let mesh = surface.tessellated_to(tolerance).unwrap();
            let mut worst = 0.0_f64;
            for i in 0..7 {
                for j in 0..7 {
                    let ((a, b), (c, d)) = (surface.knots_u().domain(), surface.knots_v().domain());
                    let (u, v) = (
                        a + (b - a) * (f64::from(i) + 0.37) / 7.0,
                        c + (d - c) * (f64::from(j) + 0.61) / 7.0,
                    );
                    let point = surface.point(u, v);
                    let corners = |t: &[u32; 3]| t.map(|k| mesh.points[k as usize]);
                    // Only near triangles can be nearest.
                    let mut near: Vec<[Point3; 3]> = mesh.triangles.iter().map(corners).collect();
                    near.sort_by(|x, y| {
                        let to = |t: &[Point3; 3]| {
                            t.iter()
                                .map(|c| (c - point).norm())
                                .fold(f64::INFINITY, f64::min)
                        };
                        to(x).total_cmp(&to(y))
                    });
                    worst = worst.max(
                        near.iter()
                            .take(40)
                            .map(|t| distance(&point, *t))
                            .fold(f64::INFINITY, f64::min),
                    );
                }
            }
            assert!(
                worst <= tolerance,
                "{worst} m where {tolerance} m was asked"
            );
            closeness.push(worst / tolerance);
        }
        assert!(
            closeness.len() >= 3 && closeness.iter().any(|c| *c > 0.05),
            "{closeness:?}: the bound says nothing"
        );
    }

    #[test]
    fn gaps_and_creases_have_corners_of_their_own() {
        let folded = builtin("sheet", Some([4, 4]), None)
            .unwrap()
            .insert_knots(Direction::U, &[0.5; 4])
            .unwrap();
        let mesh = folded.tessellated([2, 1]).unwrap();
        assert_eq!((mesh.points.len(), mesh.triangles.len()), (6 * 2, 4 * 2));
    }

    #[test]
    fn nonsense_is_refused() {
        let sheet = builtin("sheet", None, None).unwrap();
        assert_eq!(sheet.tessellated([0, 3]), Err(TessellateError::NoCells));
        assert_eq!(
            sheet.tessellated([1 << 20, 1 << 20]),
            Err(TessellateError::TooFine)
        );
        assert_eq!(
            sheet.tessellated([usize::MAX, 2]),
            Err(TessellateError::TooFine)
        );
        for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                sheet.tessellated_to(tolerance),
                Err(TessellateError::Tolerance(_))
            ));
        }
        let drop = builtin("teardrop", None, None).unwrap();
        assert_eq!(drop.tessellated_to(1e-18), Err(TessellateError::TooFine));
    }
}
