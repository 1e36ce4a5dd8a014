//! The `spheres` narrow phase: contacts on points of the surface, as many as are asked for.
//!
//! The method of the design's source thesis (chapter 3), made safe and quick:
//! ```text
//! hull       hulls of the nets apart? the last tick's witness says so at once            ──▶ no contact
//! cover      spans whose control points are in reach of the tool; their sparse points, every k-th row
//! sphere     about four neighbouring points, and as much wider as the surface may leave their patch (sag); and a slab
//! levels     spheres that meet: three times as many rows there; flat cells stop early
//! triangles  two a cell of the last level: nearest points, triangle–triangle tests
//! peaks      regions of cells in touch, and the deepest point of each
//! ```
//! The number of rows is the dial of speed against error: depths are those of points and triangles
//! of the grid, so the error falls with the square of the rows (28, 82 and 244 give full levels).
//! No contact region larger than a cell is missed. Differences from the thesis: the sphere is
//! widened by a bound of what it misses between its points; control points in reach are found by
//! boxes, not by hull faces, which would miss a tool in a hollow; cells stop early only where the
//! surface is flat in between, so a bump cannot hide there.
//!
//! ```
//! use palpate_thesis::spheres::Spheres;
//! use palpate_geometry::contact::{ContactSet, Reach};
//! use palpate_geometry::math::Point3;
//! use palpate_geometry::surface::builtin;
//!
//! let ball = builtin("sphere", None, Some(0.05))?;
//! let mut spheres = Spheres::new(&ball, [82, 82]);
//! let mut contacts = ContactSet::new();
//! spheres.ball(&Point3::new(0.058, 0.0, 0.0), 0.01, &Reach::TOUCH, &mut contacts);
//! assert!((contacts.deepest().unwrap().depth_m - 0.002).abs() < 2e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod counters;
mod cover;
mod gaps;
mod grid;
mod hull;
mod levels;
mod pair;
#[cfg(test)]
mod pair_tests;
mod peaks;
mod points;
mod query;
#[cfg(test)]
mod query_tests;
mod region;
mod sag;
mod solid;
mod sphere;
#[cfg(test)]
mod tests;
mod triangles;

pub use self::counters::{Counters, LevelCounters, MAX_LEVELS};
pub use self::pair::SpheresPair;
pub use self::query::{SPHERES, counters_of};
pub use self::solid::Solid;
pub use self::sphere::Sphere;

use self::cover::Cover;
use self::hull::Witness;
use self::levels::{Levels, Limits, Nearest};
use self::peaks::{Leaf, Peaks};
use self::solid::{Ball, HalfSpace};
use grid::{FACING, SAME_DEPTH};
use palpate_geometry::contact::{Contact, ContactSet, Reach, Rectangle, ToolPoint};
use palpate_geometry::math::{Point3, Pose, Vector3};
use palpate_geometry::surface::Surface;

/// Least and most rows in a direction: indices of cells have 16 bits.
const ROWS: [usize; 2] = [2, 4096];

/// A surface with all the room that the method needs. Queries see the net of the last
/// [`Spheres::load`].
#[derive(Clone, Debug)]
pub struct Spheres {
    cover: Cover,
    levels: Levels,
    peaks: Peaks,
    witness: Witness,
    flat_turn: f64,
    counters: Counters,
}

impl Spheres {
    /// Sizes everything for `rows` points in u and v; each is taken to be in 2 ..= 4096. Loads the
    /// present net.
    pub fn new(surface: &Surface, rows: [usize; 2]) -> Self {
        let cover = Cover::new(surface, rows.map(|n| n.clamp(ROWS[0], ROWS[1])));
        // On a body that is about as curved as it is large, a cell at the finest level misses (1 /
        // cells)² / 4 of its size, and a coarsest one (a ninth of it) whose normals turn by δ
        // misses δ / 72: this δ keeps both alike.
        let flat_turn = 18.0 / (cover.u.finest() * cover.v.finest()) as f64;
        Self {
            levels: Levels::new(&cover),
            peaks: Peaks::new(&cover),
            witness: Witness::default(),
            flat_turn: flat_turn.min(0.1),
            counters: Counters::default(),
            cover,
        }
    }

    /// Takes over a net that moved; the surface must have the knots it was made with. Bounds are
    /// recomputed, points when next needed.
    pub fn load(&mut self, surface: &Surface) {
        self.load_at(surface, &Pose::identity());
    }

    /// [`Spheres::load`] of a rigid surface that stands at a pose.
    pub fn load_at(&mut self, surface: &Surface, pose: &Pose) {
        self.cover.load(surface, pose);
    }

    /// What the last query did.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// A point tool.
    pub fn point(&mut self, point: &Point3, reach: &Reach, set: &mut ContactSet) {
        self.ball(point, 0.0, reach, set);
    }

    /// A ball. Depth is radius − signed distance of the centre; on an open sheet, distance is
    /// signed from the side of `reach`. Besides the nearest point, every other local one in reach
    /// is a contact, while the centre is outside.
    pub fn ball(&mut self, centre: &Point3, radius_m: f64, reach: &Reach, set: &mut ContactSet) {
        let margin = self.begin(reach, set);
        if !(centre.iter().all(|x| x.is_finite()) && radius_m.is_finite() && radius_m >= 0.0) {
            return;
        }
        // Behind an open sheet is inside, however far: hulls cannot say.
        if self.cover.closed {
            let cover = &self.cover;
            let support = |d: &Vector3| cover.farthest(d) - centre.coords + d * radius_m;
            if self.witness.separates(support, margin + cover.noise_m()) {
                self.counters.hulls_apart = true;
                return;
            }
        }
        let ball = Ball {
            centre: *centre,
            radius_m,
        };
        if radius_m <= 0.0 && margin <= 0.0 {
            // Nothing but the nearest point counts, and no sphere says more than the search for it.
            self.far(&ball, reach, set);
            return;
        }
        self.refine(&ball, margin, true, false);
        self.peaks.leaves.clear();
        let mut best: Option<Nearest> = None;
        for &id in &self.levels.leaves {
            let found = levels::nearest_in_cell(&mut self.cover, id, centre);
            if best.is_none_or(|best| found.distance_m < best.distance_m) {
                best = Some(found);
            }
            if found.distance_m <= radius_m + margin {
                let Nearest {
                    point,
                    uv,
                    distance_m,
                    normals,
                } = found;
                self.peaks.leaves.push(Leaf {
                    id,
                    depth_m: -distance_m,
                    uv,
                    point,
                    normal: normals,
                });
            }
        }
        self.counters.triangulated_cells = self.levels.leaves.len() as u32;
        if self.peaks.leaves.is_empty() {
            // No surface in reach: all outside, or all inside.
            self.far(&ball, reach, set);
            return;
        }
        self.peaks
            .group(&self.cover, SAME_DEPTH * self.cover.size_m);
        let (cover, side) = (&self.cover, reach.side());
        let mut nearest: Option<(f64, bool)> = None;
        self.peaks.maxima(|leaf| {
            let inside = is_inside(cover, centre, leaf, side);
            if nearest.is_none_or(|(depth, _)| leaf.depth_m > depth) {
                nearest = Some((leaf.depth_m, inside));
            }
        });
        let Some((least, inside)) = nearest else {
            return;
        };
        self.peaks.maxima(|leaf| {
            // From inside only the nearest is the way out; from outside, what shows its back is the
            // far side of something.
            if leaf.depth_m >= least || (!inside && !is_inside(cover, centre, leaf, side)) {
                set.push(ball_contact(cover, &ball, leaf, side));
            }
        });
        self.peaks
            .rectangles(&self.cover, |rectangle| set.push_rectangle(rectangle));
    }

    /// Everything below the plane through `origin` with unit `normal` out of the tool.
    pub fn plane(
        &mut self,
        origin: &Point3,
        normal: &Vector3,
        reach: &Reach,
        set: &mut ContactSet,
    ) {
        let margin = self.begin(reach, set);
        let Some(normal) = normal
            .try_normalize(0.0)
            .filter(|n| n.iter().all(|x| x.is_finite()))
        else {
            return;
        };
        if !origin.iter().all(|x| x.is_finite()) {
            return;
        }
        // The deepest control point bounds all: the plane's own normal is the witness.
        let lowest = self.cover.farthest(&-normal);
        if (lowest - origin.coords).dot(&normal) > margin + self.cover.noise_m() {
            self.counters.hulls_apart = true;
            return;
        }
        let tool = HalfSpace {
            origin: *origin,
            normal,
        };
        self.refine(&tool, margin, true, true);
        self.sampled(&tool, margin, set);
    }

    /// Any solid: the points in range are put into its function. A solid that is wholly inside a
    /// closed body overlaps it without a contact.
    pub fn solid<S: Solid>(&mut self, tool: &S, reach: &Reach, set: &mut ContactSet) {
        let margin = self.begin(reach, set);
        let [low, high] = self.cover.whole_box();
        if !tool.may_meet_box(&low, &high, margin + self.cover.noise_m()) {
            self.counters.hulls_apart = true;
            return;
        }
        // Corners say nothing about a small tool within a flat cell: no early stop here.
        self.refine(tool, margin, false, true);
        self.sampled(tool, margin, set);
        let inner = tool
            .inner_point()
            .filter(|p| p.iter().all(|x| x.is_finite()));
        if let Some(inner) = inner.filter(|_| set.contacts().is_empty() && self.cover.closed) {
            let found = self.levels.nearest(&mut self.cover, &inner, f64::INFINITY);
            if found.is_some_and(|found| (inner - found.point).dot(&found.normals) < 0.0) {
                set.set_overlap();
            }
        }
    }

    fn begin(&mut self, reach: &Reach, set: &mut ContactSet) -> f64 {
        set.clear();
        self.counters = Counters::default();
        (self.cover.points.computed, self.cover.made) = (0, 0);
        if reach.margin_m.is_finite() && reach.margin_m > 0.0 {
            reach.margin_m
        } else {
            0.0
        }
    }

    fn refine<S: Solid>(&mut self, tool: &S, margin_m: f64, may_stop: bool, corners_only: bool) {
        let limits = Limits {
            margin_m,
            flat_turn: may_stop.then_some(self.flat_turn),
            corners_only,
        };
        self.levels
            .refine(&mut self.cover, tool, limits, &mut self.counters);
    }

    /// Contacts at the deepest corners of the cells that are left.
    fn sampled<S: Solid>(&mut self, tool: &S, margin_m: f64, set: &mut ContactSet) {
        self.peaks.leaves.clear();
        for &id in &self.levels.leaves {
            let corners = self.cover.corners(id);
            let (mut deepest, mut at) = (f64::NEG_INFINITY, 4);
            for (k, point) in corners.iter().enumerate() {
                let gap_m = tool.signed_gap(point).0;
                // False for NaN.
                if gap_m <= margin_m && -gap_m > deepest {
                    (deepest, at) = (-gap_m, k);
                }
            }
            if at < 4 {
                let (uv, point) = (self.cover.parameters(id)[at], corners[at]);
                self.peaks.leaves.push(Leaf {
                    id,
                    depth_m: deepest,
                    uv,
                    point,
                    normal: Vector3::zeros(),
                });
            }
        }
        let last = counters::of(&mut self.counters.body, self.cover.levels() - 1);
        last.points += std::mem::take(&mut self.cover.points.computed);
        self.peaks
            .group(&self.cover, SAME_DEPTH * self.cover.size_m);
        self.peaks.maxima(|leaf| {
            let normal = -tool.signed_gap(&leaf.point).1;
            let on_tool = leaf.point - normal * leaf.depth_m;
            let [u, v] = leaf.uv;
            let contact = Contact {
                u,
                v,
                on_body: leaf.point,
                on_tool,
                normal,
                depth_m: leaf.depth_m,
                tool_uv: None,
                point: ToolPoint::Found,
            };
            if normal
                .iter()
                .chain(on_tool.coords.iter())
                .all(|x| x.is_finite())
            {
                set.push(contact);
            }
        });
        self.peaks
            .rectangles(&self.cover, |rectangle| set.push_rectangle(rectangle));
    }

    /// The ball reaches no part of the surface: in contact only when its centre is inside.
    fn far(&mut self, ball: &Ball, reach: &Reach, set: &mut ContactSet) {
        let Some(found) = self
            .levels
            .nearest(&mut self.cover, &ball.centre, f64::INFINITY)
        else {
            return;
        };
        let Nearest {
            point,
            uv,
            distance_m,
            normals,
        } = found;
        let leaf = Leaf {
            id: cover::CellId::default(),
            depth_m: -distance_m,
            uv,
            point,
            normal: normals,
        };
        if is_inside(&self.cover, &ball.centre, &leaf, reach.side()) {
            set.push(ball_contact(&self.cover, ball, &leaf, reach.side()));
            set.push_rectangle(Rectangle {
                u: [uv[0]; 2],
                v: [uv[1]; 2],
            });
        }
        // The search goes up and down: all of it on the account of the last level.
        let last = counters::of(&mut self.counters.body, self.cover.levels() - 1);
        last.points += std::mem::take(&mut self.cover.points.computed);
        last.spheres += self.cover.made;
    }
}

/// The centre is on the inner side of its foot.
fn is_inside(cover: &Cover, centre: &Point3, leaf: &Leaf, side: f64) -> bool {
    let away = centre - leaf.point;
    let along = away.dot(&leaf.normal) * side;
    along < 0.0 && (cover.closed || -along > FACING * away.norm() * leaf.normal.norm())
}

fn ball_contact(cover: &Cover, ball: &Ball, leaf: &Leaf, side: f64) -> Contact {
    let away = ball.centre - leaf.point;
    let distance = away.norm();
    let sign = if is_inside(cover, &ball.centre, leaf, side) {
        -1.0
    } else {
        1.0
    };
    let normal = if distance > 1e-9 * cover.size_m {
        away * (sign / distance)
    } else {
        leaf.normal.try_normalize(0.0).unwrap_or_else(Vector3::z) * side
    };
    let depth_m = ball.radius_m - sign * distance;
    let [u, v] = leaf.uv;
    Contact {
        u,
        v,
        on_body: leaf.point,
        on_tool: leaf.point - normal * depth_m,
        normal,
        depth_m,
        tool_uv: None,
        point: ToolPoint::Found,
    }
}
