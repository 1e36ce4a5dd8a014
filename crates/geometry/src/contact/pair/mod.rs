//! Exact contact of two B-spline surfaces.
//!
//! ```text
//! touch     boxes of Bézier pieces, then of their parts (cells): which parts come near each other
//! facing    near cells whose cones of normals face: Newton in four unknowns to every stationary pair
//! regions   vertices of cells below the other surface, joined; from the highest, and from the facing pairs, climbs to the
//!           deepest place of each region, whose foot is certified
//! curves    where the surfaces cross, as polylines; only when asked for
//! ```
//! A region is a connected part of either surface inside the other solid; its contact is its point
//! farthest from the other surface. Shallow regions of the two surfaces share their deepest pair:
//! it is given once. Depths are certified (the closest point of the other surface is global); that
//! every region was found rests on the grid of cells (at least ten in each direction) and on the
//! facing pairs between its vertices.

pub(super) mod cells;
pub(super) mod cone;
mod curves;
pub(super) mod depth;
pub(super) mod facing;
#[cfg(test)]
mod hard_cases;
mod regions;
mod restriction;
#[cfg(test)]
mod tests;
mod tops;
mod touch;

pub use self::curves::{CurvePoint, IntersectionCurve};

use self::cells::Cells;
use self::depth::Below;
use self::facing::{Half, StationaryPair, face};
use self::regions::{PairRegion, Regions};
use self::tops::{Top, Upper};
use self::touch::{Divided, Touch};
use super::{Contact, ContactSet, Reach, Rectangle, ToolPoint};
use crate::math::Vector3;
use crate::surface::{ClosestSolver, Surface};

/// Most stationary pairs kept.
const MOST_FACING: usize = 64;
/// Most pairs of cells by which others are known to be of the same two faces.
const MOST_FLAT: usize = 256;
/// Of a manifold, a face that rises by less than this across a cell, relative to the smaller surface, is level there.
const LEVEL: f64 = 1e-7;
/// Contacts whose places and depths are nearer than these, relative to the size, are one.
const SAME_PLACE: f64 = 1e-5;
const SAME_DEPTH: f64 = 1e-9;
/// A sheet touches with a side of its own, and not with its rim alone, where the way out is nearer to its normal than by
/// this cosine.
const FACES: f64 = 0.1;
/// Depths within this of zero, relative to the size, touch.
const TOUCHING: f64 = 1e-12;

/// A surface as it stands with its solver; [`ClosestSolver::net_changed`] was called after each
/// movement.
#[derive(Debug)]
pub struct PairSide<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// Its solver.
    pub solver: &'a mut ClosestSolver,
}

/// Contacts between two surfaces whose nets may move. Scratch, sized once: answers depend on the
/// arguments only.
#[derive(Clone, Debug)]
pub struct PairSolver {
    body: Cells,
    tool: Cells,
    on_body: Regions,
    on_tool: Regions,
    touch: Touch,
    facing: Vec<StationaryPair>,
    /// Pairs of cells that are flat on each other.
    flat: Vec<[usize; 2]>,
    /// Places of a sheet below a tool's.
    starts: Vec<(f64, f64)>,
    /// The side of a sheet that the last query found in touch, +1 or −1.
    side: Option<f64>,
    /// Queries answer with a manifold.
    spreads: bool,
}

impl PairSolver {
    /// Precomputes what depends on the knots.
    pub fn new(body: &Surface, tool: &Surface) -> Self {
        let (body_solver, tool_solver) =
            (&mut ClosestSolver::new(body), &mut ClosestSolver::new(tool));
        let body_cells = Cells::new(body, body_solver.pieces(body));
        let tool_cells = Cells::new(tool, tool_solver.pieces(tool));
        Self {
            on_body: Regions::new(&body_cells),
            on_tool: Regions::new(&tool_cells),
            touch: Touch::new(tool_solver.pieces(tool).len()),
            facing: Vec::with_capacity(MOST_FACING),
            flat: Vec::with_capacity(MOST_FLAT),
            starts: Vec::with_capacity(2 * tool_cells.cell_count()),
            side: None,
            spreads: false,
            body: body_cells,
            tool: tool_cells,
        }
    }

    /// From now on queries answer with a manifold: beside the deepest points, with others within the margin that span what
    /// touches, at most eight of each surface.
    pub fn spread(&mut self) {
        self.spreads = true;
    }

    /// Every region with its deepest point, deepest first; gaps up to `reach.margin_m` as contacts
    /// of negative depth.
    ///
    /// `tool_uv` is set. A body that is an open sheet is inside where its normal points away from, or the other way round
    /// when `reach.below`; past its rim the nearest way out decides. An open tool has no inside. Nets that are not finite
    /// touch nothing.
    pub fn contacts(
        &mut self,
        body: PairSide<'_>,
        tool: PairSide<'_>,
        reach: Reach,
        out: &mut ContactSet,
    ) {
        self.find(body, tool, reach, Some(reach.side()), out);
    }

    /// As [`Self::contacts`], where it is not known on which side of a sheet a closed tool is: it touches the side from
    /// which the shortest way out of the tool leads.
    pub fn contacts_on_either_side(
        &mut self,
        body: PairSide<'_>,
        tool: PairSide<'_>,
        reach: Reach,
        out: &mut ContactSet,
    ) {
        self.find(body, tool, reach, None, out);
    }

    /// The side of a sheet on which the last query found a closed tool, +1 or −1; none where it touches with its rim alone.
    pub fn side_in_touch(&self) -> Option<f64> {
        self.side
    }

    fn find(
        &mut self,
        body: PairSide<'_>,
        tool: PairSide<'_>,
        reach: Reach,
        known: Option<f64>,
        out: &mut ContactSet,
    ) {
        out.clear();
        self.regions(
            body.surface,
            body.solver,
            tool.surface,
            tool.solver,
            reach,
            known,
        );
        let size_m = self.body.whole.diagonal() + self.tool.whole.diagonal();
        for k in 0..self.on_body.found.len() {
            let PairRegion { top, .. } = self.on_body.found[k];
            let depth_m = top.sounding.depth_m;
            let sheet = (self.side.is_some()).then_some(body.surface);
            if sheet.is_some_and(|sheet| self.is_through(sheet, &top)) {
                continue;
            }
            push(out, size_m, false, of_body(&top, body.surface));
            if depth_m >= -TOUCHING * size_m {
                let [u, v] = self.on_body.extent(&self.body, k);
                out.push_rectangle(Rectangle {
                    u: unwrapped(&self.body, 0, u),
                    v: unwrapped(&self.body, 1, v),
                });
            }
        }
        for k in 0..self.on_tool.found.len() {
            let PairRegion { top, .. } = self.on_tool.found[k];
            push(out, size_m, true, of_tool(&top, tool.surface));
        }
        if self.spreads {
            for top in &self.on_body.spread {
                let sheet = (self.side.is_some()).then_some(body.surface);
                if !sheet.is_some_and(|sheet| self.is_through(sheet, top)) {
                    push(out, size_m, false, spanning(of_body(top, body.surface)));
                }
            }
            for top in &self.on_tool.spread {
                push(out, size_m, false, spanning(of_tool(top, tool.surface)));
            }
        }
    }

    /// Whether the two solids share a point; touching counts.
    pub fn overlap(&mut self, body: PairSide<'_>, tool: PairSide<'_>) -> bool {
        self.regions(
            body.surface,
            body.solver,
            tool.surface,
            tool.solver,
            Reach::TOUCH,
            None,
        );
        let size_m = self.body.whole.diagonal() + self.tool.whole.diagonal();
        let mut found = self.on_body.found.iter().chain(&self.on_tool.found);
        found.any(|region| region.top.sounding.depth_m >= -TOUCHING * size_m)
    }

    fn regions(
        &mut self,
        body: &Surface,
        body_solver: &mut ClosestSolver,
        tool: &Surface,
        tool_solver: &mut ClosestSolver,
        reach: Reach,
        known: Option<f64>,
    ) {
        self.side = None;
        self.facing.clear();
        self.flat.clear();
        self.on_body.found.clear();
        self.on_tool.found.clear();
        self.on_body.spread.clear();
        self.on_tool.spread.clear();
        if ![body, tool].into_iter().all(usable) {
            return;
        }
        let margin_m = if reach.margin_m > 0.0 {
            reach.margin_m
        } else {
            0.0
        };
        let reach = Reach { margin_m, ..reach };
        self.body.begin(body_solver.pieces(body));
        self.tool.begin(tool_solver.pieces(tool));
        let (body_m, tool_m) = (self.body.whole.diagonal(), self.tool.whole.diagonal());
        let size_m = body_m + tool_m;
        if !size_m.is_finite() || !margin_m.is_finite() {
            return;
        }
        let reach_m = margin_m + 1e-11 * size_m;
        let level_m = match self.spreads {
            true => LEVEL * body_m.min(tool_m),
            false => 0.0,
        };
        (self.on_body.level_m, self.on_tool.level_m) = (level_m, level_m);
        // A sheet has no far side.
        if self.body.closed && !self.body.whole.meets(&self.tool.whole, reach_m) {
            return;
        }
        let (body_pieces, tool_pieces) = (body_solver.pieces_now(), tool_solver.pieces_now());
        let mut a = Divided {
            surface: body,
            pieces: body_pieces,
            cells: &mut self.body,
        };
        let mut b = Divided {
            surface: tool,
            pieces: tool_pieces,
            cells: &mut self.tool,
        };
        self.touch.find(&mut a, &mut b, reach_m);
        {
            let a = Half {
                surface: body,
                pieces: body_pieces,
            };
            let b = Half {
                surface: tool,
                pieces: tool_pieces,
            };
            for &(x, y) in self.touch.facing() {
                if self.facing.len() == MOST_FACING {
                    break;
                }
                let (own, other) = (x as usize, y as usize);
                let is_flat =
                    self.body.cone_of(own).is_flat() && self.tool.cone_of(other).is_flat();
                if is_flat {
                    let mut flat = self.flat.iter();
                    let known =
                        flat.any(|&[a, b]| self.body.touch(a, own) && self.tool.touch(b, other));
                    if self.flat.len() < MOST_FLAT {
                        self.flat.push([own, other]);
                    }
                    if known {
                        continue;
                    }
                }
                let ((am, aw), (bm, bw)) =
                    (self.body.middle(x as usize), self.tool.middle(y as usize));
                let Some(found) = face(a, b, [am, bm], [aw, bw]) else {
                    continue;
                };
                let same = |f: &StationaryPair| {
                    let near = |k: usize, w: f64| (f.at[k] - found.at[k]).abs() < 1e-6 * w;
                    near(0, aw[0]) && near(1, aw[1]) && near(2, bw[0]) && near(3, bw[1])
                };
                if !self.facing.iter().any(same) {
                    self.facing.push(found);
                }
            }
        }
        if self.tool.closed {
            let mut upper = Upper {
                surface: body,
                solver: body_solver,
                size_m,
            };
            let mut below = Below {
                surface: tool,
                solver: tool_solver,
                cells: &self.tool,
                side: 1.0,
            };
            let pairs = self.facing.iter().copied();
            self.on_body
                .find(&mut upper, &mut self.body, &mut below, pairs, margin_m);
            let in_touch = |region: &PairRegion| region.top.sounding.depth_m >= 0.0;
            if !self.body.closed && !self.on_body.found.iter().any(in_touch) {
                let starts = &mut self.starts;
                places_below(&mut upper, &self.body, &mut below, starts);
                self.on_body
                    .find_from(&mut upper, &mut self.body, &mut below, starts, margin_m);
            }
            if self.spreads {
                let reach = closing_faces(&self.body, reach);
                (self.on_body).spread(&self.body, &mut below, reach, std::iter::empty());
            }
        }
        let side = if self.tool.closed && !self.body.closed {
            self.side = self.side_of(body, known);
            self.side
        } else {
            Some(reach.side())
        };
        let Some(side) = side else { return };
        let mut upper = Upper {
            surface: tool,
            solver: tool_solver,
            size_m,
        };
        let mut below = Below {
            surface: body,
            solver: body_solver,
            cells: &self.body,
            side,
        };
        let pairs = self.facing.iter().map(|f| StationaryPair {
            at: [f.at[2], f.at[3], f.at[0], f.at[1]],
            flat: f.flat,
        });
        self.on_tool
            .find(&mut upper, &mut self.tool, &mut below, pairs, margin_m);
        if self.spreads {
            let others = self.on_body.spread.iter().map(|top| top.point);
            let reach = closing_faces(&self.tool, reach);
            (self.on_tool).spread(&self.tool, &mut below, reach, others);
        }
    }
}

impl PairSolver {
    /// The side on which a closed tool touches a sheet, +1 or −1: the known one, but past the rim the one on which the sheet
    /// is deepest inside. None where it is not, or only with its rim.
    fn side_of(&self, sheet: &Surface, known: Option<f64>) -> Option<f64> {
        let found = self.on_body.found.iter().map(|region| &region.top);
        // Where the way out of the tool is shortest along the sheet, that says nothing of its sides.
        let telling = found.filter(|top| is_edge(sheet, top) || cosine(sheet, top).abs() > FACES);
        let top = telling.max_by(|a, b| a.sounding.depth_m.total_cmp(&b.sounding.depth_m));
        let Some(top) = top else {
            return known.filter(|_| !self.on_body.found.is_empty());
        };
        let cosine = cosine(sheet, top);
        (cosine.abs() > FACES).then(|| match known {
            Some(side) if !on_rim(sheet, top) => side,
            _ => cosine.signum(),
        })
    }

    /// The way out of the tool leads through the sheet, or, from a smooth place of it, along it.
    fn is_through(&self, sheet: &Surface, top: &Top) -> bool {
        let side = self.side.unwrap_or(0.0);
        let least = if is_edge(sheet, top) { -FACES } else { FACES };
        side * cosine(sheet, top) < least && !on_rim(sheet, top)
    }
}

/// What is round has the same place below it after a tick; of a face the other end may come down.
fn closing_faces(cells: &Cells, reach: Reach) -> Reach {
    let mut touched = (0..cells.cell_count()).filter(|&cell| cells.touched[cell]);
    match touched.any(|cell| cells.cone_of(cell).is_flat()) {
        true => reach,
        false => Reach {
            closing_m: 0.0,
            ..reach
        },
    }
}

/// The feet, on a sheet, of the corners of those cells of a tool that touch it: all of the tool may lie between vertices of
/// the sheet.
fn places_below(
    sheet: &mut Upper<'_>,
    cells: &Cells,
    tool: &mut Below<'_>,
    to: &mut Vec<(f64, f64)>,
) {
    to.clear();
    for cell in (0..tool.cells.cell_count()).filter(|&cell| tool.cells.touched[cell]) {
        let corners = tool.cells.corners(cell);
        for vertex in [corners[0], corners[2]] {
            let (s, t) = tool.cells.parameters(vertex as usize);
            let point = tool.solver.frame_at(tool.surface, s, t).point;
            let foot = sheet.solver.rough(sheet.surface, &point);
            if !cells.on_open_edge(foot.u, foot.v) {
                to.push((foot.u, foot.v));
            }
        }
    }
}

/// A place of the body below the tool, as a contact.
fn of_body(top: &Top, body: &Surface) -> Contact {
    let foot = top.sounding.foot.at;
    Contact {
        u: top.u,
        v: top.v,
        on_body: top.point,
        on_tool: foot.point,
        normal: -normal_of(top, body),
        depth_m: top.sounding.depth_m,
        tool_uv: Some([foot.u, foot.v]),
        point: ToolPoint::Found,
    }
}

/// A place of the tool below the body, as a contact.
fn of_tool(top: &Top, tool: &Surface) -> Contact {
    let foot = top.sounding.foot.at;
    Contact {
        u: foot.u,
        v: foot.v,
        on_body: foot.point,
        on_tool: top.point,
        normal: normal_of(top, tool),
        depth_m: top.sounding.depth_m,
        tool_uv: Some([top.u, top.v]),
        point: ToolPoint::Found,
    }
}

/// A contact that spans a face with others.
fn spanning(contact: Contact) -> Contact {
    Contact {
        point: ToolPoint::Round,
        ..contact
    }
}

/// The normal below a place of a surface; at an edge or a pole that the place lies on, the one opposite to its own.
fn normal_of(top: &Top, upper: &Surface) -> Vector3 {
    let normal = top.sounding.normal;
    if top.sounding.has_normal {
        return normal;
    }
    let own = upper.normal(top.u, top.v);
    own * if own.dot(&normal) > 0.0 { 1.0 } else { -1.0 }
}

/// Of the way out of a tool, and the normal of a sheet that is inside of it.
fn cosine(sheet: &Surface, top: &Top) -> f64 {
    -top.sounding.normal.dot(&sheet.normal(top.u, top.v))
}

/// At a rim or a crease.
fn is_edge(sheet: &Surface, top: &Top) -> bool {
    on_rim(sheet, top) || !sheet.is_smooth_at(top.u, top.v)
}

/// At an end of its parameters.
fn on_rim(sheet: &Surface, top: &Top) -> bool {
    let ends = [(sheet.knots_u(), top.u), (sheet.knots_v(), top.v)];
    ends.iter().any(|(knots, t)| {
        let (start, end) = knots.domain();
        *t <= start || *t >= end
    })
}

/// Coordinates are finite, and so are their squares.
pub(super) fn usable(surface: &Surface) -> bool {
    surface
        .net()
        .points()
        .iter()
        .all(|p| p.iter().all(|x| x.abs() < 1e100))
}

/// Adds a contact unless its places are already there.
fn push(out: &mut ContactSet, size_m: f64, other_side: bool, contact: Contact) {
    if contact.depth_m >= -TOUCHING * size_m {
        out.set_overlap();
    }
    let (near, level) = (SAME_PLACE * size_m, SAME_DEPTH * size_m);
    let same = |c: &Contact| {
        let d = c.on_body - contact.on_body;
        let one_place = d.norm() <= near && (c.on_tool - contact.on_tool).norm() <= near;
        // Faces that lie on each other have their deepest place anywhere, and each side names its
        // own.
        let one_face = other_side
            && c.normal.dot(&contact.normal) > 1.0 - 1e-12
            && d.dot(&c.normal).abs() <= level;
        (c.depth_m - contact.depth_m).abs() <= level && (one_place || one_face)
    };
    if !out.contacts().iter().any(same) {
        out.push(contact);
    }
}

/// Parameters of a range of cells.
fn unwrapped(cells: &Cells, d: usize, [low, high]: [usize; 2]) -> [f64; 2] {
    let (n, line) = (cells.counts[d], &cells.lines[d]);
    let at = |k: usize| {
        if k <= n {
            line[k]
        } else {
            line[k - n] + (line[n] - line[0])
        }
    };
    [at(low), at(high)]
}
