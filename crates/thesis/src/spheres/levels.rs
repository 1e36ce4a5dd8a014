//! Refinement of one surface inside the spheres that meet a tool, and the search for the nearest
//! point.

use super::counters::{self, Counters};
use super::cover::{CellId, Cover};
use super::solid::Solid;
use super::triangles;
use palpate_geometry::math::{Point3, Vector3};

/// How far refinement goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Gaps up to this count as meeting, m.
    pub margin_m: f64,
    /// A cell whose normals turn by less than this may stay whole, rad; `None` where samples at
    /// corners would not do.
    pub flat_turn: Option<f64>,
    /// Only corners of the last cells are asked for: no spheres there.
    pub corners_only: bool,
}

/// Cells on their way down.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    now: Vec<CellId>,
    next: Vec<CellId>,
    met: Vec<CellId>,
    bounds: Vec<(CellId, f64)>,
    /// The cells that remain.
    pub leaves: Vec<CellId>,
}

/// The point of a surface's triangles that is nearest to a query.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub point: Point3,
    pub uv: [f64; 2],
    pub distance_m: f64,
    /// Sum of the unit normals of the triangles that share the point.
    pub normals: Vector3,
}

impl Levels {
    /// Room for all cells of a surface.
    pub fn new(cover: &Cover) -> Self {
        let room = cover.u.finest() * cover.v.finest();
        Self {
            now: Vec::with_capacity(room),
            next: Vec::with_capacity(room),
            met: Vec::with_capacity(room),
            bounds: Vec::with_capacity(room),
            leaves: Vec::with_capacity(room),
        }
    }

    /// Leaves the cells, finest or flat, whose spheres meet the tool.
    pub fn refine<S: Solid>(
        &mut self,
        cover: &mut Cover,
        tool: &S,
        limits: Limits,
        counters: &mut Counters,
    ) {
        let margin = limits.margin_m;
        self.leaves.clear();
        self.now.clear();
        let reach = margin + cover.noise_m();
        cover.concerned(
            |low, high| tool.may_meet_box(low, high, reach),
            |id| self.now.push(id),
        );
        for level in 0..cover.levels() {
            if self.now.is_empty() {
                break;
            }
            let last = level + 1 == cover.levels();
            if last && limits.corners_only {
                self.leaves.extend_from_slice(&self.now);
                break;
            }
            self.met.clear();
            for &id in &self.now {
                let sphere = cover.sphere(id);
                // False for NaN.
                if tool
                    .bounded_gap(&sphere.centre)
                    .is_none_or(|gap| gap <= sphere.radius_m + margin)
                {
                    self.met.push(id);
                }
            }
            let counts = counters::of(&mut counters.body, level);
            counts.spheres += self.now.len() as u32;
            counts.tests += self.now.len() as u32;
            counts.meets += self.met.len() as u32;
            counts.points += std::mem::take(&mut cover.points.computed);
            if self.met.len() == self.now.len()
                && limits.flat_turn.is_some()
                && !last
                && counters.early_stop.is_none()
            {
                counters.early_stop = Some(level as u8);
            }
            self.next.clear();
            for &id in &self.met {
                if last || limits.flat_turn.is_some_and(|turn| cover.is_flat(id, turn)) {
                    self.leaves.push(id);
                } else {
                    push_children(cover, id, &mut self.next);
                }
            }
            std::mem::swap(&mut self.now, &mut self.next);
        }
    }

    /// The nearest point of the surface's triangles within `within_m`: only spheres that may hold a
    /// nearer one are refined.
    pub fn nearest(&mut self, cover: &mut Cover, q: &Point3, within_m: f64) -> Option<Nearest> {
        let mut least = within_m;
        self.bounds.clear();
        let bounds = &mut self.bounds;
        let mut closest = (f64::INFINITY, CellId::default());
        cover.near(q, within_m, |cover, id| {
            least = offer(cover, bounds, id, q, least);
            let square = (cover.sphere(id).centre - q).norm_squared();
            closest = if square < closest.0 {
                (square, id)
            } else {
                closest
            };
            least
        });
        if !self.bounds.is_empty() {
            let surely = dive(cover, closest.1, q);
            least = if surely < least { surely } else { least };
        }
        for _ in 1..cover.levels() {
            // What is surely there decides what may still be nearer.
            self.now.clear();
            for &(id, bound) in &self.bounds {
                if bound <= least * least {
                    push_children(cover, id, &mut self.now);
                }
            }
            self.bounds.clear();
            for &id in &self.now {
                least = offer(cover, &mut self.bounds, id, q, least);
            }
        }
        let mut best: Option<Nearest> = None;
        let tie = 1e-12 * cover.size_m;
        for &(id, bound) in &self.bounds {
            if bound > least * least {
                continue;
            }
            let found = nearest_in_cell(cover, id, q);
            match &mut best {
                Some(best) if found.distance_m > best.distance_m + tie => {}
                Some(best) if found.distance_m >= best.distance_m - tie => {
                    best.normals += found.normals;
                    if found.distance_m < best.distance_m {
                        *best = Nearest {
                            normals: best.normals,
                            ..found
                        };
                    }
                }
                _ => best = Some(found),
            }
            least = if found.distance_m < least {
                found.distance_m + tie
            } else {
                least
            };
        }
        best.filter(|best| best.distance_m.is_finite())
    }
}

/// How near a point of the surface is at most: straight down from a cell, by the most promising
/// child each time. The bound spares the search most spheres.
fn dive(cover: &mut Cover, mut id: CellId, q: &Point3) -> f64 {
    while usize::from(id.level) + 1 < cover.levels() {
        let [[i0, i1], [j0, j1]] = cover.children(id);
        let mut best = f64::INFINITY;
        let level = id.level + 1;
        for i in i0..i1 {
            for j in j0..j1 {
                let child = CellId {
                    level,
                    i: i as u16,
                    j: j as u16,
                };
                let square = (cover.sphere(child).centre - q).norm_squared();
                if square < best || id.level < level {
                    (best, id) = (square, child);
                }
            }
        }
    }
    let found = nearest_in_cell(cover, id, q);
    found.distance_m + 1e-9 * cover.size_m
}

/// Keeps a cell that may hold a point nearer than `least`, with the square of its bound; how near
/// one surely is.
#[inline(always)]
fn offer(
    cover: &mut Cover,
    bounds: &mut Vec<(CellId, f64)>,
    id: CellId,
    q: &Point3,
    least: f64,
) -> f64 {
    let lens = cover.lens(id);
    let (bound, square) = lens.bound(q);
    if bound > least * least {
        return least;
    }
    // The sphere holds some point of the surface, and it is nearer than the sphere's far side.
    let surely = square.sqrt() + lens.sphere.radius_m;
    bounds.push((id, bound));
    if surely < least { surely } else { least }
}

/// Of the two triangles of a cell.
#[inline]
pub(super) fn nearest_in_cell(cover: &mut Cover, id: CellId, q: &Point3) -> Nearest {
    let (corners, outward) = (cover.corners(id), cover.outward());
    let parameters = cover.parameters(id);
    let tie = 1e-12 * cover.size_m;
    let mut best = Nearest {
        point: corners[0],
        uv: parameters[0],
        distance_m: f64::INFINITY,
        normals: Vector3::zeros(),
    };
    for t in triangles::split(&corners) {
        let [a, b, c] = t.map(|k| corners[k]);
        let w = triangles::nearest(q, &[a, b, c]);
        let point = Point3::from(a.coords * w[0] + b.coords * w[1] + c.coords * w[2]);
        let distance_m = (point - q).norm();
        let normal = (b - a)
            .cross(&(c - a))
            .try_normalize(0.0)
            .unwrap_or_else(Vector3::zeros)
            * outward;
        let [x, y, z] = t.map(|k| parameters[k]);
        let uv = std::array::from_fn(|d| x[d] * w[0] + y[d] * w[1] + z[d] * w[2]);
        if distance_m < best.distance_m - tie {
            best = Nearest {
                point,
                uv,
                distance_m,
                normals: normal,
            };
        } else if distance_m <= best.distance_m + tie {
            best.normals += normal;
        }
    }
    best
}

#[inline(always)]
fn push_children(cover: &Cover, id: CellId, to: &mut Vec<CellId>) {
    let [[i0, i1], [j0, j1]] = cover.children(id);
    for i in i0..i1 {
        for j in j0..j1 {
            to.push(CellId {
                level: id.level + 1,
                i: i as u16,
                j: j as u16,
            });
        }
    }
}
