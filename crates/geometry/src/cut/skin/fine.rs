//! Even triangles of a piece's whole boundary, or of the piece of a sheet, which know where they are at rest.

use super::error::PieceSkinError;
use crate::basis::Side as KnotSide;
use crate::cut::grid::Grid;
use crate::cut::{Cut, Origin};
use crate::math::{MOST_COORDINATE_M, Point3, Vector3};
use crate::part::Fineness;
use crate::surface::Surface;
use std::collections::{BTreeMap, BTreeSet};

/// Of the size: how far the first triangles may be from the surface; coarse ones may cross where finer ones do not.
const TOLERANCES: [f64; 3] = [1.5e-2, 4e-3, 1e-3];
/// Of the root of the area: the shortest and the longest edges that are asked for.
pub(super) const EDGES: [f64; 2] = [1.0 / 50.0, 1.0 / 14.0];
/// Halvings of edges, rounds.
const MOST_ROUNDS: usize = 12;
/// Triangles at most.
const MOST: usize = 200_000;
/// Places along a line at which its normals are compared, and the cosine between them below which it is an edge.
const LOOKS: usize = 16;
const SHARP: f64 = 0.95;
/// Of the way to the middle: where normals about a pole are looked at.
const BESIDE: f64 = 1e-3;
/// Of a parameter's range: how near to a pole or a border a place is at it.
const AT_POLE: f64 = 1e-9;
const AT_BORDER: f64 = 1e-7;

/// The surfaces that a place of a cut is put on.
pub(super) struct Sheets<'a> {
    pub cut: &'a Cut,
    pub rest: &'a Surface,
    pub matter: &'a mut dyn FnMut(&Point3) -> Point3,
}

/// A place of a piece's boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub origin: Origin,
    /// As the body was cut, m.
    pub cut: Point3,
    /// At rest, m.
    pub rest: Point3,
}

/// What an edge runs through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lies {
    Skin,
    Cap,
    /// Between the two.
    Rim,
    /// Along an edge that the surface has.
    Crease,
    /// Along the border of an open surface.
    Border,
}

impl Lies {
    /// Faces end there.
    fn is_outer(self) -> bool {
        matches!(self, Self::Rim | Self::Crease | Self::Border)
    }
}

/// Triangles of a piece's boundary.
pub(super) struct Fine {
    pub corners: Vec<Corner>,
    /// Counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// (triangles) The cap; `None` on the skin.
    pub caps: Vec<Option<u32>>,
    creases: Creases,
}

/// Closed lines of the surface along which it has an edge, such as the rim of a former cut.
struct Creases {
    /// The parameter that has these values there, ascending.
    direction: usize,
    values: Vec<f64>,
}

impl Creases {
    /// Those of the surface at rest; none of sheets, which have no edges of former caps.
    fn of(sheets: &Sheets<'_>, closed: bool) -> Self {
        let (grid, rest) = (sheets.grid(), sheets.rest);
        let round = (0..2).find(|&d| grid.wraps[1 - d] && !grid.wraps[d]);
        let mut creases = Self {
            direction: round.unwrap_or(0),
            values: Vec::new(),
        };
        if closed && round.is_some() {
            let knots = [rest.knots_u(), rest.knots_v()][creases.direction];
            let around = [rest.knots_v(), rest.knots_u()][creases.direction];
            let inner = knots.spans().map(|k| knots.knots()[k]).skip(1);
            creases.values = inner
                .filter(|&t| knots.multiplicity(t) >= knots.degree())
                .filter(|&t| is_sharp(rest, creases.direction, t, around.domain()))
                .collect();
        }
        creases
    }

    /// How many are below a place.
    fn below(&self, [u, v]: [f64; 2]) -> usize {
        let value = [u, v][self.direction];
        self.values.partition_point(|t| *t < value)
    }

    /// The share of the way between two places at which the first is crossed.
    fn crossed(&self, places: [[f64; 2]; 2]) -> Option<f64> {
        let [a, b] = places.map(|uv| uv[self.direction]);
        let crossed = self.values.iter().find(|t| (a - **t) * (b - **t) < 0.0);
        crossed.map(|t| (t - a) / (b - a))
    }
}

/// Normals on both sides of a line differ somewhere.
fn is_sharp(surface: &Surface, direction: usize, value: f64, (start, end): (f64, f64)) -> bool {
    (0..LOOKS).any(|k| {
        let around = start + (end - start) * k as f64 / LOOKS as f64;
        let [a, b] = [KnotSide::Left, KnotSide::Right].map(|side| {
            let frame = match direction {
                0 => surface.frame_from(value, around, side, KnotSide::Right),
                _ => surface.frame_from(around, value, KnotSide::Right, side),
            };
            frame.du.cross(&frame.dv)
        });
        a.dot(&b) < SHARP * a.norm() * b.norm()
    })
}

impl Cut {
    /// There is such a piece, and the surface at rest is the one that was cut but for where it is.
    pub(super) fn check_rest(&self, piece: usize, rest: &Surface) -> Result<(), PieceSkinError> {
        let own = &self.surface;
        let same = rest.knots_u() == own.knots_u()
            && rest.knots_v() == own.knots_v()
            && rest.net().points().len() == own.net().points().len()
            && rest.topology() == own.topology();
        if piece >= self.pieces.len() {
            return Err(PieceSkinError::Piece {
                piece,
                count: self.pieces.len(),
            });
        }
        match same {
            true => Ok(()),
            false => Err(PieceSkinError::Rest),
        }
    }
}

impl<'a> Sheets<'a> {
    /// Of a cut, with the same surface at rest.
    pub fn new(
        cut: &'a Cut,
        rest: &'a Surface,
        matter: &'a mut dyn FnMut(&Point3) -> Point3,
    ) -> Self {
        let own = &cut.surface;
        let still = rest.net() == own.net() && rest.weights() == own.weights();
        Self {
            cut,
            rest: if still { own } else { rest },
            matter,
        }
    }
}

impl Sheets<'_> {
    fn grid(&self) -> &Grid {
        self.cut.grid()
    }

    /// The parameter that has no value here, where a place is a pole.
    fn vague(&self, uv: [f64; 2]) -> Option<usize> {
        let grid = self.grid();
        (0..2).find_map(|d| {
            let [low, high] = [grid.parameter(d, 0), grid.parameter(d, grid.end(d))];
            let near = AT_POLE * (high - low);
            let at = [uv[d] - low <= near, high - uv[d] <= near];
            (0..2)
                .any(|end| grid.poles[d][end] && at[end])
                .then_some(1 - d)
        })
    }

    /// The surface at rest has a pole there, and normals around it that differ.
    pub fn is_tip(&self, uv: [f64; 2]) -> bool {
        let Some(around) = self.vague(uv) else {
            return false;
        };
        let grid = self.grid();
        let ends = [0, 1].map(|d| [grid.parameter(d, 0), grid.parameter(d, grid.end(d))]);
        let along = 1 - around;
        let [low, high] = ends[along];
        let inside = uv[along] + BESIDE * (0.5 * (low + high) - uv[along]);
        let normal = |k: usize| {
            let [start, end] = ends[around];
            let turn = start + (end - start) * k as f64 / LOOKS as f64;
            let at = if around == 0 {
                [turn, inside]
            } else {
                [inside, turn]
            };
            let frame = self.rest.frame(at[0], at[1]);
            let normal = frame.du.cross(&frame.dv);
            normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
        };
        let sum: Vector3 = (0..LOOKS).map(normal).sum();
        sum.norm() < SHARP * LOOKS as f64
    }

    /// Mean parameters of places near each other.
    pub fn mean(&self, places: &[([f64; 2], f64)]) -> [f64; 2] {
        let grid = self.grid();
        let vague: Vec<Option<usize>> = places.iter().map(|p| self.vague(p.0)).collect();
        let near = (0..places.len()).find(|&k| vague[k].is_none()).unwrap_or(0);
        let near = places[near].0;
        std::array::from_fn(|d| {
            let (mut sum, mut weight, mut all) = (0.0, 0.0, 0.0);
            for (k, (uv, share)) in places.iter().enumerate() {
                all += share;
                if vague[k] != Some(d) {
                    sum += share * grid.lifted(*uv, near)[d];
                    weight += share;
                }
            }
            match weight > 1e-12 * all {
                true => sum / weight,
                false => near[d],
            }
        })
    }

    /// A place of the skin.
    pub fn on_skin(&self, uv: [f64; 2]) -> Corner {
        let [u, v] = self.grid().reduced(uv);
        let own = &self.cut.surface;
        let (wu, wv) = (own.knots_u().window(u), own.knots_v().window(v));
        let cut = own.point_in(&wu, &wv);
        Corner {
            origin: Origin::Skin { u, v },
            cut,
            rest: match std::ptr::eq(own, self.rest) {
                true => cut,
                false => self.rest.point_in(&wu, &wv),
            },
        }
    }

    /// The place of the skin in the plane nearest to one close to it.
    pub fn on_rim(&self, mut uv: [f64; 2]) -> Corner {
        let plane = &self.cut.plane;
        let mut best = (f64::INFINITY, uv);
        for _ in 0..6 {
            let [u, v] = self.grid().reduced(uv);
            let frame = self.cut.surface.frame(u, v);
            let height = plane.height(&frame.point);
            if height.abs() >= best.0 {
                break;
            }
            best = (height.abs(), uv);
            // The shortest way in space along which the height vanishes.
            let (a, b) = (frame.du, frame.dv);
            let slope = [plane.normal.dot(&a), plane.normal.dot(&b)];
            let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
            let det = aa * bb - ab * ab;
            if det <= 1e-12 * aa * bb {
                break;
            }
            let way = [
                (bb * slope[0] - ab * slope[1]) / det,
                (aa * slope[1] - ab * slope[0]) / det,
            ];
            let gain = way[0] * slope[0] + way[1] * slope[1];
            if gain <= 1e-6 {
                break;
            }
            uv = [0, 1].map(|d| uv[d] - height * way[d] / gain);
        }
        self.on_skin(best.1)
    }

    /// The sides of the domain that a place is on, by direction: 0 at its start, 1 at its end. Only those that are borders.
    fn borders(&self, uv: [f64; 2]) -> [Option<usize>; 2] {
        let grid = self.grid();
        [0, 1].map(|d| {
            let ends = [grid.parameter(d, 0), grid.parameter(d, grid.end(d))];
            let near = AT_BORDER * (ends[1] - ends[0]);
            let open = |end: &usize| !grid.wraps[d] && !grid.poles[d][*end];
            (0..2)
                .filter(open)
                .find(|&end| (uv[d] - ends[end]).abs() <= near)
        })
    }

    /// A place of the skin, on the border if it is as good as there.
    fn at_border(&self, mut uv: [f64; 2]) -> Corner {
        let grid = self.grid();
        for (d, end) in self.borders(uv).into_iter().enumerate() {
            match end {
                Some(0) => uv[d] = grid.parameter(d, 0),
                Some(_) => uv[d] = grid.parameter(d, grid.end(d)),
                None => {}
            }
        }
        self.on_skin(uv)
    }

    /// Whether an edge on one side of which there is nothing is of the border, or else of the cut.
    fn is_border(&self, ends: [[f64; 2]; 2]) -> bool {
        let [a, b] = ends.map(|uv| self.borders(uv));
        (0..2).any(|d| a[d].is_some() && a[d] == b[d])
    }

    /// A place within a cap.
    pub fn on_cap(&mut self, cut: Point3) -> Corner {
        Corner {
            origin: Origin::Cap,
            cut,
            rest: (self.matter)(&cut),
        }
    }

    /// Between corners of a triangle or of an edge.
    pub fn between(&mut self, places: &[(Corner, f64)], lies: Lies) -> Corner {
        let mean = |sheets: &Self| {
            let uv = |(corner, share): &(Corner, f64)| match corner.origin {
                Origin::Skin { u, v } => Some(([u, v], *share)),
                Origin::Cap => None,
            };
            let all: Vec<_> = places.iter().filter_map(uv).collect();
            sheets.mean(&all)
        };
        match lies {
            Lies::Skin | Lies::Crease => self.on_skin(mean(self)),
            Lies::Border => self.at_border(mean(self)),
            Lies::Rim => self.on_rim(mean(self)),
            Lies::Cap => {
                let sum: Vector3 = places.iter().map(|(c, share)| c.cut.coords * *share).sum();
                self.on_cap(Point3::from(sum))
            }
        }
    }
}

impl Fine {
    /// Of a piece, with edges of about `edge` of the root of its area.
    pub fn new(sheets: &mut Sheets<'_>, piece: usize, edge: f64) -> Result<Self, PieceSkinError> {
        let cut = sheets.cut;
        let whole = &cut.pieces[piece];
        let root_m = libm::sqrt(whole.skin_area_m2 + whole.cap_area_m2.max(0.0));
        let divided = |tolerance: f64| {
            cut.triangles(
                piece,
                &Fineness {
                    tolerance_m: tolerance * root_m,
                    most: MOST,
                    plane_step_m: Some(1.4 * edge * root_m),
                },
            )
        };
        let mut made = divided(TOLERANCES[0]);
        for &finer in &TOLERANCES[1..] {
            if made.is_err() {
                made = divided(finer);
            }
        }
        let made = made?;
        let corner = |(point, origin): (&Point3, &Origin)| match *origin {
            Origin::Skin { u, v } => sheets.at_border([u, v]),
            Origin::Cap => sheets.on_cap(*point),
        };
        let corners = made.mesh.points.iter().zip(&made.origins).map(corner);
        let mut fine = Self {
            corners: corners.collect(),
            triangles: made.mesh.triangles,
            caps: made.caps,
            creases: Creases::of(sheets, cut.closed),
        };
        for (edge, lies) in fine.edges(sheets) {
            for k in edge.into_iter().filter(|_| lies == Lies::Rim) {
                if let Origin::Skin { u, v } = fine.corners[k as usize].origin
                    && sheets.borders([u, v]) == [None; 2]
                {
                    fine.corners[k as usize] = sheets.on_rim([u, v]);
                }
            }
        }
        if cut.closed {
            fine.divide_at_creases(sheets);
        }
        let longest_m = edge * libm::sqrt(fine.area_m2());
        fine.refine(sheets, longest_m)?;
        Ok(fine)
    }

    pub fn rest(&self, triangle: usize) -> [Point3; 3] {
        self.triangles[triangle].map(|k| self.corners[k as usize].rest)
    }

    pub fn area_of(&self, triangle: usize) -> f64 {
        let [a, b, c] = self.rest(triangle);
        0.5 * (b - a).cross(&(c - a)).norm()
    }

    /// At rest.
    pub fn area_m2(&self) -> f64 {
        (0..self.triangles.len()).map(|t| self.area_of(t)).sum()
    }

    fn uv(&self, corner: u32) -> Option<[f64; 2]> {
        match self.corners[corner as usize].origin {
            Origin::Skin { u, v } => Some([u, v]),
            Origin::Cap => None,
        }
    }

    /// Equal for triangles of one cap, and for those of the skin between the same creases.
    pub fn label(&self, triangle: usize) -> u32 {
        if let Some(cap) = self.caps[triangle] {
            return cap;
        }
        let places = self.triangles[triangle].map(|k| self.uv(k).unwrap_or([0.0; 2]));
        let mean = [0, 1].map(|d| places.iter().map(|uv| uv[d]).sum::<f64>() / 3.0);
        u32::MAX - self.creases.below(mean) as u32
    }

    /// Divides triangles of the skin along the creases that no rim meets; of others nothing is known from here on.
    fn divide_at_creases(&mut self, sheets: &mut Sheets<'_>) {
        let edges = self.edges(sheets);
        let direction = self.creases.direction;
        for (ends, lies) in &edges {
            let places = ends.map(|k| self.uv(k).map(|uv| uv[direction]));
            if let ([Some(a), Some(b)], Lies::Rim) = (places, lies) {
                self.creases.values.retain(|t| (a - t) * (b - t) > 0.0);
            }
        }
        self.snap(sheets);
        for _ in 0..MOST_ROUNDS {
            let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
            for (ends, lies) in self.edges(sheets) {
                let (false, [Some(a), Some(b)]) = (lies == Lies::Cap, ends.map(|k| self.uv(k)))
                else {
                    continue;
                };
                if let Some(share) = self.creases.crossed([a, b]) {
                    middles.insert(ends, self.corners.len() as u32);
                    let mut middle = sheets.mean(&[(a, 1.0 - share), (b, share)]);
                    let value = middle[direction];
                    let near = |x: &&f64| (**x - value).abs();
                    let own = self.creases.values.iter();
                    let own = own.min_by(|x, y| near(x).total_cmp(&near(y)));
                    middle[direction] = own.copied().unwrap_or(value);
                    self.corners.push(sheets.on_skin(middle));
                }
            }
            if middles.is_empty() {
                break;
            }
            self.split(&middles);
        }
    }

    /// Puts corners that are as good as on a crease onto it.
    fn snap(&mut self, sheets: &Sheets<'_>) {
        let (grid, d) = (sheets.grid(), self.creases.direction);
        let near = AT_POLE * (grid.parameter(d, grid.end(d)) - grid.parameter(d, 0));
        for k in 0..self.corners.len() {
            let Some(mut uv) = self.uv(k as u32) else {
                continue;
            };
            let value = self
                .creases
                .values
                .iter()
                .find(|t| (uv[d] - **t).abs() <= near);
            if let Some(&value) = value.filter(|t| **t != uv[d]) {
                uv[d] = value;
                self.corners[k] = sheets.on_skin(uv);
            }
        }
    }

    /// Each edge once, with what it runs through.
    fn edges(&self, sheets: &Sheets<'_>) -> BTreeMap<[u32; 2], Lies> {
        let mut seen: Vec<([u32; 2], bool, u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (t, &[a, b, c]) in self.triangles.iter().enumerate() {
            let label = self.label(t);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                seen.push(([p.min(q), p.max(q)], self.caps[t].is_some(), label));
            }
        }
        seen.sort_unstable();
        let lies = |group: &[([u32; 2], bool, u32)]| {
            let caps = group.iter().filter(|side| side.1).count();
            let lies = match caps {
                0 if group.len() == 1 => self.outer(sheets, group[0].0),
                0 if group[0].2 != group[group.len() - 1].2 => Lies::Crease,
                0 => Lies::Skin,
                n if n == group.len() => Lies::Cap,
                _ => Lies::Rim,
            };
            (group[0].0, lies)
        };
        seen.chunk_by(|a, b| a.0 == b.0).map(lies).collect()
    }

    /// What an edge of one triangle runs along.
    pub fn outer(&self, sheets: &Sheets<'_>, ends: [u32; 2]) -> Lies {
        let places = ends.map(|k| self.uv(k).unwrap_or([f64::NAN; 2]));
        match sheets.is_border(places) {
            true => Lies::Border,
            false => Lies::Rim,
        }
    }

    /// Halves edges that are too long, and those that leave no corner between two places of rims.
    fn refine(&mut self, sheets: &mut Sheets<'_>, longest_m: f64) -> Result<(), PieceSkinError> {
        for _ in 0..MOST_ROUNDS {
            let edges = self.edges(sheets);
            let mut on_rim = vec![false; self.corners.len()];
            for ([p, q], lies) in &edges {
                if lies.is_outer() {
                    on_rim[*p as usize] = true;
                    on_rim[*q as usize] = true;
                }
            }
            let alone = self.alone(&edges);
            let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
            for (ends, lies) in edges {
                let [p, q] = ends.map(|k| self.corners[k as usize]);
                let inside = matches!(lies, Lies::Skin | Lies::Cap);
                let chord = inside && ends.iter().all(|&k| on_rim[k as usize]);
                if chord || alone.contains(&ends) || (q.rest - p.rest).norm() > longest_m {
                    middles.insert(ends, self.corners.len() as u32);
                    let middle = sheets.between(&[(p, 0.5), (q, 0.5)], lies);
                    self.corners.push(middle);
                }
            }
            if middles.is_empty() {
                return Ok(());
            }
            self.split(&middles);
            if self.triangles.len() > MOST {
                return Err(PieceSkinError::TooFine { most: MOST });
            }
        }
        Ok(())
    }

    /// Edges of triangles that are a face by themselves.
    fn alone(&self, edges: &BTreeMap<[u32; 2], Lies>) -> BTreeSet<[u32; 2]> {
        let mut alone = BTreeSet::new();
        for &[a, b, c] in &self.triangles {
            let own = [(a, b), (b, c), (c, a)].map(|(p, q)| [p.min(q), p.max(q)]);
            let outer = |edge| edges.get(edge).is_some_and(|lies| lies.is_outer());
            if own.iter().all(outer) {
                alone.extend(own);
            }
        }
        alone
    }

    fn split(&mut self, middles: &BTreeMap<[u32; 2], u32>) {
        let (mut triangles, mut caps) = (Vec::new(), Vec::new());
        for (corners, cap) in self.triangles.iter().zip(&self.caps) {
            let before = triangles.len();
            self.split_one(*corners, middles, &mut triangles);
            caps.extend(std::iter::repeat_n(*cap, triangles.len() - before));
        }
        (self.triangles, self.caps) = (triangles, caps);
    }

    /// A triangle, divided at the middles of its edges that have one; a quadrangle along its shorter diagonal.
    fn split_one(
        &self,
        corners: [u32; 3],
        middles: &BTreeMap<[u32; 2], u32>,
        into: &mut Vec<[u32; 3]>,
    ) {
        let [a, b, c] = corners;
        let middle = |p: u32, q: u32| middles.get(&[p.min(q), p.max(q)]).copied();
        let length =
            |p: u32, q: u32| (self.corners[p as usize].rest - self.corners[q as usize].rest).norm();
        match [middle(a, b), middle(b, c), middle(c, a)] {
            [None, None, None] => into.push(corners),
            [Some(x), Some(y), Some(z)] => {
                into.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
            }
            // Turned until the first edge has a middle and the last has none.
            [None, _, _] => self.split_one([b, c, a], middles, into),
            [Some(_), _, Some(_)] => self.split_one([c, a, b], middles, into),
            [Some(x), Some(y), None] => {
                into.push([x, b, y]);
                match length(a, y) < length(x, c) {
                    true => into.extend([[a, x, y], [a, y, c]]),
                    false => into.extend([[a, x, c], [x, y, c]]),
                }
            }
            [Some(x), None, None] => into.extend([[a, x, c], [x, b, c]]),
        }
    }
}

/// All can be calculated with.
pub(super) fn finite(corners: &[Corner]) -> Result<(), PieceSkinError> {
    let good = |p: &Point3| p.iter().all(|x| x.abs() <= MOST_COORDINATE_M);
    match corners.iter().find(|corner| !good(&corner.rest)) {
        Some(Corner { rest, .. }) => Err(PieceSkinError::NotFinite {
            x: rest.x,
            y: rest.y,
            z: rest.z,
        }),
        None => Ok(()),
    }
}
