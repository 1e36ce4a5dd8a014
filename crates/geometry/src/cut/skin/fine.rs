//! Even triangles of a piece's whole boundary, which know where they are at rest.

use super::PieceSkinError;
use crate::cut::grid::Grid;
use crate::cut::{Cut, Origin};
use crate::math::{Point3, Vector3};
use crate::part::Fineness;
use crate::surface::Surface;
use std::collections::BTreeMap;

/// Of the size: how far the first triangles may be from the surface.
const TOLERANCE: f64 = 6e-3;
/// Halvings of edges, rounds.
const MOST_ROUNDS: usize = 12;
/// Triangles at most.
const MOST: usize = 200_000;
/// Of a parameter's range: how near to a pole a place is at it.
const AT_POLE: f64 = 1e-9;

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
}

/// Triangles of a piece's boundary.
pub(super) struct Fine {
    pub corners: Vec<Corner>,
    /// Counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// (triangles) The cap; `None` on the skin.
    pub caps: Vec<Option<u32>>,
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

    /// All values of a parameter are one place there.
    pub fn is_pole(&self, uv: [f64; 2]) -> bool {
        self.vague(uv).is_some()
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
        Corner {
            origin: Origin::Skin { u, v },
            cut: self.cut.surface.point(u, v),
            rest: self.rest.point(u, v),
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
            Lies::Skin => self.on_skin(mean(self)),
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
        let made = cut.triangles(
            piece,
            &Fineness {
                tolerance_m: TOLERANCE * root_m,
                most: MOST,
                plane_step_m: Some(1.4 * edge * root_m),
            },
        )?;
        let corner = |(point, origin): (&Point3, &Origin)| match *origin {
            Origin::Skin { u, v } => sheets.on_skin([u, v]),
            Origin::Cap => sheets.on_cap(*point),
        };
        let corners = made.mesh.points.iter().zip(&made.origins).map(corner);
        let mut fine = Self {
            corners: corners.collect(),
            triangles: made.mesh.triangles,
            caps: made.caps,
        };
        for (edge, lies) in fine.edges() {
            if lies == Lies::Rim {
                for k in edge {
                    if let Origin::Skin { u, v } = fine.corners[k as usize].origin {
                        fine.corners[k as usize] = sheets.on_rim([u, v]);
                    }
                }
            }
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

    /// Each edge once, with what it runs through.
    fn edges(&self) -> BTreeMap<[u32; 2], Lies> {
        let mut seen: Vec<([u32; 2], bool)> = Vec::with_capacity(3 * self.triangles.len());
        for (t, &[a, b, c]) in self.triangles.iter().enumerate() {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                seen.push(([p.min(q), p.max(q)], self.caps[t].is_some()));
            }
        }
        seen.sort_unstable();
        let lies = |group: &[([u32; 2], bool)]| {
            let caps = group.iter().filter(|side| side.1).count();
            let lies = match caps {
                0 => Lies::Skin,
                n if n == group.len() => Lies::Cap,
                _ => Lies::Rim,
            };
            (group[0].0, lies)
        };
        seen.chunk_by(|a, b| a.0 == b.0).map(lies).collect()
    }

    /// Halves edges that are too long, and those that leave no corner between two places of rims.
    fn refine(&mut self, sheets: &mut Sheets<'_>, longest_m: f64) -> Result<(), PieceSkinError> {
        for _ in 0..MOST_ROUNDS {
            let edges = self.edges();
            let mut on_rim = vec![false; self.corners.len()];
            for ([p, q], lies) in &edges {
                if *lies == Lies::Rim {
                    on_rim[*p as usize] = true;
                    on_rim[*q as usize] = true;
                }
            }
            let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
            for (ends, lies) in edges {
                let [p, q] = ends.map(|k| self.corners[k as usize]);
                let chord = lies != Lies::Rim && ends.iter().all(|&k| on_rim[k as usize]);
                if chord || (q.rest - p.rest).norm() > longest_m {
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
