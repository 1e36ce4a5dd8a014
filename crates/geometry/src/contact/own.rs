//! A surface in contact with itself.
//!
//! Places that face each other are found as between two surfaces. A fold that penetrates itself and
//! the two sides of a wall look alike there: what distinguishes them is how often the surface winds
//! around the point between them, twice or once, none in a gap. The winding number is the solid
//! angle the surface fills, in triangles that shrink towards the point (Van Oosterom & Strackee
//! 1983), which gives it to a small fraction of one.

#[cfg(test)]
mod tests;

use super::pair::cells::{Block, Cells};
use super::pair::cone::Cone;
use super::pair::depth::{Sounding, jet};
use super::pair::facing::{Half, face};
use super::pair::usable;
use super::{Contact, ContactSet, Reach, Rectangle, ToolPoint};
use crate::basis::MAX_DEGREE;
use crate::math::{Point3, Vector3};
use crate::surface::closest::Foot;
use crate::surface::{BezierPieces, ClosestPoint, ClosestSolver, Frame, Surface};

/// Parts looked at for one winding number.
const MOST_PARTS: usize = 20_000;
/// Halvings of a part in each direction: 2⁻²⁶ of a cell is about rounding of a difference of
/// squares.
const DEEPEST: u32 = 26;
/// What a tick asks for as the deepest fold, relative to the size: contact forces stop folds long
/// before.
pub const TICK_FOLD: f64 = 0.04;
/// Walls remembered within a call, so that each costs one winding number.
const MOST_WALLS: usize = 64;
/// Pairs of cells handed to Newton; beyond that, pairs are dropped.
const MOST_PAIRS: usize = 1 << 13;

/// Contacts of one surface with itself. Scratch, sized once.
#[derive(Clone, Debug)]
pub struct SelfSolver {
    cells: Cells,
    other: ClosestSolver,
    /// (pieces): cones of normals.
    cones: Vec<Cone>,
    /// Cells of pairs of pieces that come near and may face, as pairs.
    near: Vec<(u32, u32)>,
    stack: Vec<OwnPatch>,
    walls: Vec<Point3>,
}

/// A part of the surface as the winding number sees it.
#[derive(Clone, Copy, Debug)]
struct OwnPatch {
    /// u from, u to, v from, v to.
    range: [f64; 4],
    level: u32,
    /// Corners from the point: (u from, v from), (u to, v from), (u to, v to), (u from, v to).
    corners: [Vector3; 4],
}

impl SelfSolver {
    /// Precomputes what depends on the knots.
    pub fn new(surface: &Surface) -> Self {
        let mut other = ClosestSolver::new(surface);
        let cells = Cells::new(surface, other.pieces(surface));
        let pieces = other.pieces_now().len();
        Self {
            cells,
            cones: vec![Cone::ANY; pieces],
            near: Vec::with_capacity(MOST_PAIRS),
            stack: Vec::with_capacity(4 * DEEPEST as usize + 8),
            walls: Vec::with_capacity(MOST_WALLS),
            other,
        }
    }

    /// Places where the surface penetrates itself, each with the greatest depth around, deepest
    /// first; and gaps up to `reach.margin_m` across the outside. `on_tool` and `tool_uv` are the
    /// other place on the same surface. Only a closed surface has an inside; others have no
    /// contacts. Folds deeper than `deepest_fold_m`, or than the radii of curvature at their feet,
    /// are not looked for: the less is asked for, the fewer walls are distinguished from folds.
    pub fn contacts(
        &mut self,
        surface: &Surface,
        solver: &mut ClosestSolver,
        reach: Reach,
        deepest_fold_m: f64,
        out: &mut ContactSet,
    ) {
        out.clear();
        if !usable(surface) || !self.cells.closed {
            return;
        }
        self.other.net_changed();
        self.other.pieces(surface);
        self.cells.begin(solver.pieces(surface));
        let size_m = self.cells.whole.diagonal();
        let margin_m = if reach.margin_m > 0.0 {
            reach.margin_m
        } else {
            0.0
        };
        let fold_m = if deepest_fold_m > 0.0 {
            deepest_fold_m
        } else {
            0.0
        };
        // Places that face each other through a fold are as far apart as it is deep.
        let reach_m = margin_m.max(fold_m) + 1e-12 * size_m;
        if !reach_m.is_finite() {
            return;
        }
        self.walls.clear();
        self.find(surface, solver.pieces_now(), reach_m, out);
        for k in 0..self.near.len() {
            let (x, y) = self.near[k];
            let mut a = Half { surface, solver };
            let mut b = Half {
                surface,
                solver: &mut self.other,
            };
            let ((am, aw), (bm, bw)) =
                (self.cells.middle(x as usize), self.cells.middle(y as usize));
            let found = face(&mut a, &mut b, [am, bm], [aw, bw]);
            if let Some(found) = found.filter(|found| !found.flat) {
                self.judge(surface, solver, found.at, [margin_m, fold_m, size_m], out);
            }
        }
    }

    /// Pairs of cells that come near each other and may face; those of pieces first, of which there
    /// are fewer.
    fn find(
        &mut self,
        surface: &Surface,
        pieces: &BezierPieces,
        reach_m: f64,
        out: &mut ContactSet,
    ) {
        self.near.clear();
        let count = pieces.len();
        for k in 0..count {
            self.cones[k] = cone(surface, pieces, k);
        }
        for a in 0..count {
            let own = block(pieces, a);
            for b in a..count {
                if !own.meets(&block(pieces, b), reach_m) || !self.cones[a].may_face(&self.cones[b])
                {
                    continue;
                }
                let (([i, j], [m, n]), ([k, l], [p, q])) =
                    (self.cells.of_piece(a), self.cells.of_piece(b));
                let columns = self.cells.counts[1];
                for r in 0..m * n {
                    let x = (i + r / n) * columns + j + r % n;
                    self.cells.look(surface, pieces, x);
                    for s in 0..p * q {
                        let y = (k + s / q) * columns + l + s % q;
                        if a == b && y <= x {
                            continue;
                        }
                        self.cells.look(surface, pieces, y);
                        let near = self.cells.box_of(x).meets(self.cells.box_of(y), reach_m);
                        if !near
                            || !self.cells.cone_of(x).may_face(self.cells.cone_of(y))
                            || self.adjacent(x, y)
                        {
                            continue;
                        }
                        if self.near.len() == MOST_PAIRS {
                            out.note_dropped();
                            return;
                        }
                        self.near.push((x as u32, y as u32));
                    }
                }
            }
        }
    }

    /// Cells with a common vertex always touch.
    fn adjacent(&self, x: usize, y: usize) -> bool {
        let other = self.cells.corners(y);
        self.cells.corners(x).iter().any(|c| other.contains(c))
    }

    /// Adds a stationary pair if it is a greatest depth of a fold, or a least gap.
    fn judge(
        &mut self,
        surface: &Surface,
        solver: &mut ClosestSolver,
        [u, v, s, t]: [f64; 4],
        [margin_m, fold_m, size_m]: [f64; 3],
        out: &mut ContactSet,
    ) {
        let (x, y) = (self.cells.cell_at(u, v), self.cells.cell_at(s, t));
        if x == y || self.adjacent(x, y) {
            return;
        }
        let (a, b) = (
            solver.frame_at(surface, u, v),
            solver.frame_at(surface, s, t),
        );
        let outward = |f: &Frame| {
            let n = f.du.cross(&f.dv) * if surface.flip_normal() { -1.0 } else { 1.0 };
            n.try_normalize(0.0)
        };
        let (Some(na), Some(nb)) = (outward(&a), outward(&b)) else {
            return;
        };
        let depth_m = (b.point - a.point).dot(&nb);
        let near = depth_m >= -margin_m - 1e-12 * size_m && depth_m <= fold_m + 1e-12 * size_m;
        if na.dot(&nb) > -0.999_999 || !near {
            return;
        }
        let at = ClosestPoint {
            u: s,
            v: t,
            point: b.point,
            normal: nb,
            distance: depth_m.abs(),
            signed_distance: -depth_m,
        };
        let sounding = Sounding {
            depth_m,
            foot: Foot {
                at,
                frame: b,
                smooth: true,
            },
            normal: nb,
            has_normal: true,
        };
        let h = jet(&a, &sounding).h;
        if !(h[0] > 0.0 && h[2] > 0.0 && h[0] * h[2] > h[1] * h[1]) {
            return;
        }
        let same = |c: &Contact| {
            let near = |p: &Point3, q: &Point3| (p - q).norm() <= 1e-6 * size_m;
            (near(&c.on_body, &a.point) && near(&c.on_tool, &b.point))
                || (near(&c.on_body, &b.point) && near(&c.on_tool, &a.point))
        };
        if out.contacts().iter().any(same) {
            return;
        }
        // Between places that touch there is nothing to wind around; a wall without thickness is no
        // wall.
        if depth_m.abs() > 1e-9 * size_m {
            let middle = nalgebra::center(&a.point, &b.point);
            if self
                .walls
                .iter()
                .any(|w| (w - middle).norm() <= 1e-6 * size_m)
            {
                return;
            }
            let winding = self.winding(surface, solver, &middle);
            let wanted = if depth_m > 0.0 {
                winding > 1.5
            } else {
                winding < 0.5
            };
            if !wanted {
                if self.walls.len() < MOST_WALLS {
                    self.walls.push(middle);
                }
                return;
            }
        } else {
            out.set_overlap();
        }
        out.push(Contact {
            u,
            v,
            on_body: a.point,
            on_tool: b.point,
            normal: -nb,
            depth_m,
            tool_uv: Some([s, t]),
            point: ToolPoint::Found,
        });
        for cell in [x, y] {
            let ([u, v], [wide_u, wide_v]) = self.cells.middle(cell);
            let side = |x: f64, wide: f64| [x - 0.5 * wide, x + 0.5 * wide];
            out.push_rectangle(Rectangle {
                u: side(u, wide_u),
                v: side(v, wide_v),
            });
        }
    }

    /// How often the surface winds around a point.
    fn winding(&mut self, surface: &Surface, solver: &mut ClosestSolver, point: &Point3) -> f64 {
        let (mut sum, mut parts) = (0.0, 0);
        // Of a piece that is not far, at least parts as small as cells.
        let [p, q] = [0, 1].map(|d| self.cells.of_piece(0).1[d]);
        let least = p.max(q).next_power_of_two().trailing_zeros();
        for piece in 0..solver.pieces_now().len() {
            let pieces = solver.pieces_now();
            let whole = block(pieces, piece);
            let ([u0, u1], [v0, v1]) = pieces.rectangle(piece);
            let points = pieces.points(piece);
            let n = pieces.v.degree + 1;
            let last = points.len() - n;
            let corners = [0, last, last + n - 1, n - 1].map(|k| {
                let x = &points[k];
                Vector3::new(x[0] / x[3], x[1] / x[3], x[2] / x[3]) - point.coords
            });
            if whole.distance(point) >= 1.5 * whole.diagonal() {
                sum += angle(&corners);
                continue;
            }
            self.stack.clear();
            self.stack.push(OwnPatch {
                range: [u0, u1, v0, v1],
                level: 0,
                corners,
            });
            while let Some(OwnPatch {
                range: [u0, u1, v0, v1],
                level,
                corners,
            }) = self.stack.pop()
            {
                parts += 1;
                let mut at = |u: f64, v: f64| solver.frame_at(surface, u, v).point - point;
                let (um, vm) = (0.5 * (u0 + u1), 0.5 * (v0 + v1));
                let middle = at(um, vm);
                let far = corners.iter().fold((middle - corners[0]).norm(), |m, c| {
                    m.max((c - corners[0]).norm())
                });
                let near = corners.iter().fold(middle.norm(), |m, c| m.min(c.norm()));
                if (near < 1.5 * far || level < least) && level < DEEPEST && parts < MOST_PARTS {
                    let [a, b, c, d] = corners;
                    let [ab, bc, cd, da] = [at(um, v0), at(u1, vm), at(um, v1), at(u0, vm)];
                    let level = level + 1;
                    let parts = [
                        ([u0, um, v0, vm], [a, ab, middle, da]),
                        ([um, u1, v0, vm], [ab, b, bc, middle]),
                        ([um, u1, vm, v1], [middle, bc, c, cd]),
                        ([u0, um, vm, v1], [da, middle, cd, d]),
                    ];
                    self.stack.extend(parts.map(|(range, corners)| OwnPatch {
                        range,
                        level,
                        corners,
                    }));
                    continue;
                }
                sum += angle(&corners);
            }
        }
        sum / (4.0 * std::f64::consts::PI) * if surface.flip_normal() { -1.0 } else { 1.0 }
    }
}

/// Solid angle of two triangles, seen from the origin.
fn angle(corners: &[Vector3; 4]) -> f64 {
    let mut sum = 0.0;
    for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
        let (a, b, c) = (&corners[a], &corners[b], &corners[c]);
        let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        sum += 2.0 * libm::atan2(a.dot(&b.cross(c)), below);
    }
    sum
}

fn block(pieces: &BezierPieces, k: usize) -> Block {
    let b = pieces.bounds(k);
    Block {
        low: [b.min.x, b.min.y, b.min.z],
        high: [b.max.x, b.max.y, b.max.z],
    }
}

fn cone(surface: &Surface, pieces: &BezierPieces, k: usize) -> Cone {
    let mut flat = [[0.0; 3]; (MAX_DEGREE + 1) * (MAX_DEGREE + 1)];
    let points = pieces.points(k);
    for (y, x) in flat.iter_mut().zip(points) {
        *y = [x[0] / x[3], x[1] / x[3], x[2] / x[3]];
    }
    let (p, q) = (pieces.u.degree, pieces.v.degree);
    Cone::of_normals(
        &flat[..points.len()],
        p,
        q,
        surface.flip_normal(),
        pieces.is_rational(),
    )
}
