//! A surface in contact with itself.
//!
//! Places that face each other are found as between two surfaces. A fold that penetrates itself and the two sides of a
//! wall look alike there: what tells them apart is how often the surface winds around the point between them, twice or
//! once, none in a gap. The winding number is the solid angle the surface fills, in triangles that shrink towards the
//! point (Van Oosterom & Strackee 1983), which gives it to a small fraction of one.

use super::pair::cells::Cells;
use super::pair::depth::{Sounding, jet};
use super::pair::facing::{Half, face};
use super::pair::usable;
use super::{Contact, ContactSet, Reach, Rectangle};
use crate::math::Point3;
use crate::surface::closest::Foot;
use crate::surface::{ClosestPoint, ClosestSolver, Frame, Surface};

/// Parts looked at for one winding number.
const MOST_PARTS: usize = 20_000;
/// Halvings of a part in each direction: 2⁻²⁶ of a cell is about rounding of a difference of squares.
const DEEPEST: u32 = 26;
/// Deepest fold that can be looked for, relative to the size.
const DEEPEST_FOLD: f64 = 0.2;
/// Pairs of cells handed to Newton; beyond that, pairs are dropped.
const MOST_PAIRS: usize = 1 << 13;

/// Contacts of one surface with itself. Scratch, sized once.
#[derive(Clone, Debug)]
pub struct SelfSolver {
    cells: Cells,
    other: ClosestSolver,
    stack: Vec<([f64; 4], u32)>,
    /// (cells): by their low side.
    order: Vec<u32>,
}

impl SelfSolver {
    /// Precomputes what depends on the knots.
    pub fn new(surface: &Surface) -> Self {
        let mut other = ClosestSolver::new(surface);
        let cells = Cells::new(surface, other.pieces(surface));
        let order = Vec::with_capacity(cells.cell_count());
        Self { cells, other, stack: Vec::with_capacity(4 * DEEPEST as usize + 8), order }
    }

    /// Places where the surface penetrates itself, each with the greatest depth around, deepest first; and gaps up to
    /// `reach.margin_m` across the outside. `on_tool` and `tool_uv` are the other place on the same surface. Only a closed
    /// surface has an inside; others have no contacts. Folds deeper than `deepest_m` are not looked for, nor those deeper
    /// than a fifth of the size: the less is asked for, the sooner walls are told from folds.
    pub fn contacts(
        &mut self,
        surface: &Surface,
        solver: &mut ClosestSolver,
        reach: Reach,
        deepest_m: f64,
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
        let margin_m = if reach.margin_m > 0.0 { reach.margin_m } else { 0.0 };
        if !margin_m.is_finite() {
            return;
        }
        let n = self.cells.cell_count();
        for cell in 0..n {
            self.cells.look(surface, solver.pieces_now(), cell);
        }
        // Places that face each other through a fold are as far apart as it is deep.
        let deepest_m = deepest_m.clamp(0.0, DEEPEST_FOLD * size_m);
        let reach_m = margin_m.max(deepest_m);
        let limits = [margin_m, deepest_m, size_m];
        // Along the longest side only cells whose shadows meet are compared.
        let whole = &self.cells.whole;
        let axis =
            (0..3).fold(
                0,
                |best, c| {
                    if whole.high[c] - whole.low[c] > whole.high[best] - whole.low[best] { c } else { best }
                },
            );
        let cells = &self.cells;
        self.order.clear();
        self.order.extend(0..n as u32);
        self.order.sort_unstable_by(|&x, &y| {
            let low = |cell: u32| cells.box_of(cell as usize).low[axis];
            low(x).total_cmp(&low(y)).then(x.cmp(&y))
        });
        let mut tried = 0;
        for k in 0..n {
            for l in k + 1..n {
                let (x, y) = (self.order[k] as usize, self.order[l] as usize);
                let (first, second) = (self.cells.box_of(x), self.cells.box_of(y));
                if second.low[axis] - reach_m > first.high[axis] {
                    break;
                }
                // The lower number first: which of a pair is called the body does not depend on where they lie.
                let (x, y) = (x.min(y), x.max(y));
                if !first.meets(second, reach_m)
                    || !self.cells.cone_of(x).may_face(self.cells.cone_of(y))
                    || self.adjacent(x, y)
                {
                    continue;
                }
                tried += 1;
                if tried > MOST_PAIRS {
                    out.note_dropped();
                    return;
                }
                let mut a = Half { surface, solver };
                let mut b = Half { surface, solver: &mut self.other };
                let ((am, aw), (bm, bw)) = (self.cells.middle(x), self.cells.middle(y));
                if let Some(found) = face(&mut a, &mut b, [am, bm], [aw, bw]) {
                    self.judge(surface, solver, found.at, limits, out);
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
        [margin_m, deepest_m, size_m]: [f64; 3],
        out: &mut ContactSet,
    ) {
        let (x, y) = (self.cells.cell_at(u, v), self.cells.cell_at(s, t));
        if x == y || self.adjacent(x, y) {
            return;
        }
        let (a, b) = (solver.frame_at(surface, u, v), solver.frame_at(surface, s, t));
        let outward = |f: &Frame| {
            let n = f.du.cross(&f.dv) * if surface.flip_normal() { -1.0 } else { 1.0 };
            n.try_normalize(0.0)
        };
        let (Some(na), Some(nb)) = (outward(&a), outward(&b)) else { return };
        let depth_m = (b.point - a.point).dot(&nb);
        let near = depth_m >= -margin_m - 1e-12 * size_m && depth_m <= deepest_m + 1e-12 * size_m;
        if na.dot(&nb) > -0.999_999 || !near {
            return;
        }
        let at =
            ClosestPoint { u: s, v: t, point: b.point, normal: nb, distance: depth_m.abs(), signed_distance: -depth_m };
        let sounding = Sounding { depth_m, foot: Foot { at, frame: b, smooth: true }, normal: nb };
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
        // A gap lies in front of both sides and so is no wall. Between places that touch there is nothing to wind around; a
        // wall without thickness is no wall.
        if depth_m > 1e-9 * size_m {
            if self.winding(surface, solver, &nalgebra::center(&a.point, &b.point)) <= 1.5 {
                return;
            }
        } else if depth_m >= -1e-9 * size_m {
            out.set_overlap();
        }
        out.push(Contact { u, v, on_body: a.point, on_tool: b.point, normal: -nb, depth_m, tool_uv: Some([s, t]) });
        for cell in [x, y] {
            let ([u, v], [wide_u, wide_v]) = self.cells.middle(cell);
            let side = |x: f64, wide: f64| [x - 0.5 * wide, x + 0.5 * wide];
            out.push_rectangle(Rectangle { u: side(u, wide_u), v: side(v, wide_v) });
        }
    }

    /// How often the surface winds around a point.
    fn winding(&mut self, surface: &Surface, solver: &mut ClosestSolver, point: &Point3) -> f64 {
        let (mut sum, mut parts) = (0.0, 0);
        for cell in 0..self.cells.cell_count() {
            let ([u, v], [wide_u, wide_v]) = self.cells.middle(cell);
            let whole = [u - 0.5 * wide_u, u + 0.5 * wide_u, v - 0.5 * wide_v, v + 0.5 * wide_v];
            self.stack.clear();
            self.stack.push((whole, 0));
            while let Some(([u0, u1, v0, v1], level)) = self.stack.pop() {
                parts += 1;
                let mut at = |u: f64, v: f64| solver.frame_at(surface, u, v).point - point;
                let corners = [at(u0, v0), at(u1, v0), at(u1, v1), at(u0, v1)];
                let (um, vm) = (0.5 * (u0 + u1), 0.5 * (v0 + v1));
                let far = corners.iter().fold(0.0_f64, |m, c| m.max((c - corners[0]).norm()));
                let near = corners.iter().fold(at(um, vm).norm(), |m, c| m.min(c.norm()));
                if near < 1.5 * far && level < DEEPEST && parts < MOST_PARTS {
                    for part in [[u0, um, v0, vm], [u0, um, vm, v1], [um, u1, v0, vm], [um, u1, vm, v1]] {
                        self.stack.push((part, level + 1));
                    }
                    continue;
                }
                for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                    let (a, b, c) = (&corners[a], &corners[b], &corners[c]);
                    let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
                    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
                    sum += 2.0 * libm::atan2(a.dot(&b.cross(c)), below);
                }
            }
        }
        sum / (4.0 * std::f64::consts::PI) * if surface.flip_normal() { -1.0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::KnotVector;
    use crate::math::Vector3;
    use crate::surface::{ControlNet, builtin};

    /// A sausage folded to a hairpin: legs along y at x = ±0.015 m of radius 0.01 m, with a belly in the middle of each.
    fn sausage(belly_m: f64) -> Surface {
        // Wide: its curvature is to stay below one over the depth, or the deepest places have more than one foot.
        const BELLY: [f64; 9] = [0.0, 0.0, 0.2, 0.7, 1.0, 0.7, 0.2, 0.0, 0.0];
        let (legs, bend, around) = (9, 5, 12);
        let mut centres = vec![];
        for k in 0..legs {
            centres.push((Vector3::new(0.015, 0.01 * f64::from(k), 0.0), Vector3::x(), k));
        }
        for k in 1..=bend {
            let angle = std::f64::consts::PI * f64::from(k) / f64::from(bend + 1);
            let out = Vector3::new(libm::cos(angle), libm::sin(angle), 0.0);
            centres.push((Vector3::new(0.0, 0.08, 0.0) + out * 0.015, out, 0));
        }
        for k in (0..legs).rev() {
            centres.push((Vector3::new(-0.015, 0.01 * f64::from(k), 0.0), -Vector3::x(), k));
        }
        let last = centres.len() - 1;
        let columns = centres.len();
        let mut points = vec![];
        for i in 0..around {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(around);
            for (j, (centre, out, k)) in centres.iter().enumerate() {
                let radius = if j == 0 || j == last { 0.0 } else { 0.01 } + belly_m * BELLY[*k as usize];
                let way = out * libm::cos(angle) + Vector3::z() * libm::sin(angle);
                points.push(Point3::from(centre + way * radius));
            }
        }
        let u = KnotVector::periodic_uniform(3, around as usize).unwrap();
        let v = KnotVector::clamped_uniform(3, columns).unwrap();
        let net = ControlNet::new(around as usize, columns, points).unwrap();
        Surface::new(u, v, net, None).unwrap().oriented_outward()
    }

    fn own(surface: &Surface, margin_m: f64) -> ContactSet {
        let mut set = ContactSet::new();
        let mut solver = ClosestSolver::new(surface);
        let reach = Reach { margin_m, below: false };
        SelfSolver::new(surface).contacts(surface, &mut solver, reach, surface.size(), &mut set);
        set
    }

    // The legs are mirror images in x = 0, so the depth is twice what the inner side of one passes that plane by.
    #[test]
    fn a_folded_sausage_is_as_deep_in_itself_as_it_passes_its_mirror() {
        for belly in [0.009, 0.0075, 0.0062, 0.005, 0.003] {
            let surface = sausage(belly);
            assert!(surface.topology().is_closed() && surface.volume() > 0.0);
            let (mut least, mut at) = (f64::INFINITY, (0.0, 0.0));
            let mut wide = [0.5, 0.2];
            let mut middle = (0.5, 0.2);
            while wide[0] > 1e-9 {
                for i in -30..=30 {
                    for j in -30..=30 {
                        let (u, v) =
                            (middle.0 + wide[0] * f64::from(i) / 30.0, middle.1 + wide[1] * f64::from(j) / 30.0);
                        let (u, v) = (u.rem_euclid(1.0), v.clamp(0.05, 0.35));
                        let x = surface.point(u, v).x;
                        if x < least {
                            (least, at) = (x, (u, v));
                        }
                    }
                }
                middle = at;
                wide = wide.map(|w| 0.5 * w);
            }
            let depth = -2.0 * least;
            let set = own(&surface, 0.01);
            let c = set.deepest().unwrap_or_else(|| panic!("nothing at {belly}, depth {depth}"));
            assert!((c.depth_m - depth).abs() < 1e-12, "belly {belly}: {} for {depth}", c.depth_m);
            assert!((c.on_body - c.on_tool - c.normal * c.depth_m).norm() < 1e-13, "{c:?}");
            assert_eq!(set.overlap(), depth > 0.0, "belly {belly}: {set:?}");
            assert!((c.normal.x.abs() - 1.0).abs() < 1e-9, "{c:?}");
        }
    }

    #[test]
    fn an_unfolded_surface_of_any_thickness_does_not_touch_itself() {
        for thickness in [1.0, 0.1, 1e-3, 1e-5] {
            for name in ["sphere", "teardrop", "torus"] {
                let mut surface = builtin(name, None, None).unwrap();
                for p in surface.net_mut().points_mut() {
                    p.x *= thickness;
                }
                let set = own(&surface, 0.0);
                assert!(set.contacts().is_empty() && !set.overlap(), "{name} {thickness}: {set:?}");
            }
        }
    }
}
