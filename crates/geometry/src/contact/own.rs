//! A surface in contact with itself.
//!
//! Places that face each other are found as between two surfaces. A fold that penetrates itself and
//! the two sides of a wall look alike there: what distinguishes them is how often the surface winds
//! around the point between them, twice or once, none in a gap.

mod pieces;
#[cfg(test)]
mod tests;
mod winding;

use self::pieces::NearPieces;
use self::winding::Winding;
use super::pair::cells::{Block, Cells};
use super::pair::cone::Cone;
use super::pair::depth::{Sounding, jet};
use super::pair::facing::{Half, face};
use super::pair::usable;
use super::{Contact, ContactSet, Reach, Rectangle, ToolPoint};
use crate::basis::MAX_DEGREE;
use crate::math::Point3;
use crate::surface::closest::Foot;
use crate::surface::{BezierPieces, ClosestPoint, ClosestSolver, Frame, Surface};

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
    pieces: NearPieces,
    /// (pieces): cones of normals, where known.
    cones: Vec<Cone>,
    known: Vec<bool>,
    /// Cells of pairs of pieces that come near and may face, as pairs.
    near: Vec<(u32, u32)>,
    winding: Winding,
    walls: Vec<Point3>,
}

impl SelfSolver {
    /// Precomputes what depends on the knots.
    pub fn new(surface: &Surface) -> Self {
        let pieces = BezierPieces::new(surface);
        let cells = Cells::new(surface, &pieces);
        Self {
            winding: Winding::new(&pieces),
            cells,
            cones: vec![Cone::ANY; pieces.len()],
            known: vec![false; pieces.len()],
            pieces: NearPieces::new(surface, &pieces),
            near: Vec::with_capacity(MOST_PAIRS),
            walls: Vec::with_capacity(MOST_WALLS),
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
        let pieces = solver.pieces(surface);
        self.cells.begin(pieces);
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
        let half = Half { surface, pieces };
        self.find(half, reach_m, out);
        self.search(half, [margin_m, fold_m, size_m], out);
    }

    /// The contacts that the pairs of cells lead to.
    fn search(&mut self, half: Half<'_>, lengths_m: [f64; 3], out: &mut ContactSet) {
        for k in 0..self.near.len() {
            let (x, y) = self.near[k];
            let ((am, aw), (bm, bw)) =
                (self.cells.middle(x as usize), self.cells.middle(y as usize));
            let found = face(half, half, [am, bm], [aw, bw]);
            if let Some(found) = found.filter(|found| !found.flat) {
                self.judge(half, found.at, lengths_m, out);
            }
        }
    }

    /// Pairs of cells that come near each other and may face; those of pieces first, of which there
    /// are fewer.
    fn find(&mut self, half: Half<'_>, reach_m: f64, out: &mut ContactSet) {
        let pieces = half.pieces;
        self.near.clear();
        self.known.fill(false);
        (self.pieces).follow(half, self.cells.whole.diagonal(), reach_m);
        for a in 0..pieces.len() {
            let own = block(pieces, a);
            let mut from = a;
            while let Some(b) = self.pieces.next(a, from) {
                from = b + 1;
                if !own.meets(&block(pieces, b), reach_m) {
                    continue;
                }
                let [mine, other] = [a, b].map(|k| self.cone(half, k));
                if mine.may_face(&other) && !self.find_cells(half, [a, b], reach_m) {
                    out.note_dropped();
                    return;
                }
            }
        }
    }

    /// The cone of a piece of the present net.
    fn cone(&mut self, half: Half<'_>, piece: usize) -> Cone {
        if !self.known[piece] {
            self.known[piece] = true;
            self.cones[piece] = cone(half.surface, half.pieces, piece);
        }
        self.cones[piece]
    }

    /// Those of two pieces; `false`: there is no room for all.
    fn find_cells(&mut self, half: Half<'_>, [a, b]: [usize; 2], reach_m: f64) -> bool {
        let (([i, j], [m, n]), ([k, l], [p, q])) = (self.cells.of_piece(a), self.cells.of_piece(b));
        let columns = self.cells.counts[1];
        for r in 0..m * n {
            let x = (i + r / n) * columns + j + r % n;
            self.cells.look(half.surface, half.pieces, x);
            for s in 0..p * q {
                let y = (k + s / q) * columns + l + s % q;
                if a == b && y <= x {
                    continue;
                }
                self.cells.look(half.surface, half.pieces, y);
                let near = self.cells.box_of(x).meets(self.cells.box_of(y), reach_m);
                if !near || !self.may_face(x, y) || self.adjacent(x, y) {
                    continue;
                }
                if self.near.len() == MOST_PAIRS {
                    return false;
                }
                self.near.push((x as u32, y as u32));
            }
        }
        true
    }

    /// Cells may hold places that face each other: along the normals of both. As near as that is to pairs beside
    /// them, Newton may come from here.
    fn may_face(&self, x: usize, y: usize) -> bool {
        let [a, b] = [x, y].map(|cell| (self.cells.box_of(cell), self.cells.cone_of(cell)));
        let way = b.0.middle() - a.0.middle();
        let away = a.0.diagonal() + b.0.diagonal();
        a.1.may_face(b.1) && a.1.may_hold(&way, away) && b.1.may_hold(&way, away)
    }

    /// Cells with a common vertex always touch.
    fn adjacent(&self, x: usize, y: usize) -> bool {
        let other = self.cells.corners(y);
        self.cells.corners(x).iter().any(|c| other.contains(c))
    }

    /// Adds a stationary pair if it is a greatest depth of a fold, or a least gap.
    fn judge(
        &mut self,
        half: Half<'_>,
        [u, v, s, t]: [f64; 4],
        [margin_m, fold_m, size_m]: [f64; 3],
        out: &mut ContactSet,
    ) {
        let (x, y) = (self.cells.cell_at(u, v), self.cells.cell_at(s, t));
        if x == y || self.adjacent(x, y) {
            return;
        }
        let Half { surface, pieces } = half;
        let (a, b) = (pieces.frame_at([u, v]), pieces.frame_at([s, t]));
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
            let winding = self.winding.around(pieces, &middle, &nb);
            let wanted = winding.is_some_and(|times| {
                let times = if surface.flip_normal() { -times } else { times };
                if depth_m > 0.0 { times > 1 } else { times < 1 }
            });
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
