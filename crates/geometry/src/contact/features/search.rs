//! Where corners and edges of a tool are in the signed distance of a body.

use super::edge::FIXED;
use super::{Edge, Features};
use crate::contact::{Contact, ContactSet, Reach, ToolPoint, distance_squared_to_box};
use crate::math::{Point3, Pose, Vector3};
use crate::skin::{Skin, SkinSolver};
use crate::surface::{ClosestPoint, Closing, WarmFoot};

/// Looks along a round edge, and most along another.
const LOOKS: usize = 16;
/// Of these, each so many is a fixed point.
const EVERY: usize = LOOKS / FIXED;
/// Corners of one block, whose ball is asked for before they are.
const BLOCK: usize = 8;
/// Looks a span of the surface.
const LOOKS_OF_SPAN: f64 = 2.0;
/// Slopes of the distance along an edge below this are level.
const LEVEL: f64 = 1e-9;
/// Steps towards a place without slope, and the slope that ends them.
const STEPS: usize = 60;
const NO_SLOPE: f64 = 1e-13;
/// Of a face: deeper than the feature beside it by this, of the size, or the feature stands for it.
const DEEPER: f64 = 1e-7;
/// Normals of two smooth places that touch agree by this cosine (0.8°): what queries leave over is less.
const AGREE: f64 = 1.0 - 1e-4;
/// Where the way to a point turns from the normal of a part by more than this, the foot is on an edge or a corner.
const TURNED: f64 = 1e-6;
/// Of the size: a foot this near to a rim of a part is on it.
const RIM: f64 = 1e-9;
/// Looks along the size of a part.
const LOOKS_OF_PART: f64 = 8.0;
/// Beyond an open rim a foot is straight below its point within this cosine.
const STRAIGHT: f64 = 1.0 - 1e-6;

/// Scratch for the features of one tool against one body. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub struct FeatureSearch {
    size_m: f64,
    /// Between two looks along an edge, m.
    spacing_m: f64,
    closed: bool,
    /// The ends of u and v are apart.
    open: [bool; 2],
    /// (corners): what is known of each.
    corners: Vec<CornerGap>,
    /// (⌈corners / BLOCK⌉): centre and radius of a ball around so many corners, in the tool's frame, m.
    blocks: Vec<(Point3, f64)>,
    found: ContactSet,
    tops: Vec<Contact>,
}

/// How near a corner is to the body.
#[derive(Clone, Copy, Debug)]
struct CornerGap {
    /// It is no nearer than this, m; negative inside.
    least_m: f64,
    /// Where it was looked for.
    foot: Option<ClosestPoint>,
}

/// A ball around points: centre and radius, m.
pub(super) fn ball_around(points: &[Point3]) -> (Point3, f64) {
    let (low, high) = points
        .iter()
        .fold((points[0], points[0]), |(l, h), p| (l.inf(p), h.sup(p)));
    let centre = nalgebra::center(&low, &high);
    let away = points.iter().map(|p| (p - centre).norm());
    (centre, away.fold(0.0, f64::max))
}

/// The body as features see it.
struct Below<'a> {
    skin: &'a Skin,
    solver: &'a mut SkinSolver,
    side: f64,
    open: [bool; 2],
    /// Around the body, m, and how far outside of it points count.
    bounds: (Point3, Point3),
    within_m: f64,
}

impl Below<'_> {
    /// Something of a ball around a point may be in touch, or within the margin.
    fn may_touch(&self, p: &Point3, radius_m: f64) -> bool {
        self.away_m(p) <= radius_m + self.within_m
    }

    /// From the box around the body, m.
    fn away_m(&self, p: &Point3) -> f64 {
        let (low, high) = &self.bounds;
        distance_squared_to_box(p, low, high).sqrt()
    }

    /// The contact of a point of the tool with its foot. Beyond an open rim there is none.
    fn contact(&self, foot: &ClosestPoint, p: &Point3, point: ToolPoint) -> Option<Contact> {
        let gap_m = self.side * foot.signed_distance;
        let own = foot.normal * self.side;
        let sign = if gap_m < 0.0 { -1.0 } else { 1.0 };
        let way = (p - foot.point) * sign;
        if gap_m < 0.0 && self.on_rim(foot) && way.dot(&own) < STRAIGHT * foot.distance {
            return None;
        }
        // At a crease or a rim the surface has none of its own.
        let smooth = |way: &Vector3| match self.skin {
            Skin::Surface(surface) => surface.is_smooth_at(foot.u, foot.v),
            Skin::Part(_) => (way - own).norm() <= TURNED,
        };
        let normal = match way.try_normalize(0.0) {
            Some(n) if foot.distance > 1e-9 * foot.point.coords.amax() && !smooth(&n) => n,
            _ => own,
        };
        Some(Contact {
            u: foot.u,
            v: foot.v,
            on_body: foot.point,
            on_tool: *p,
            normal,
            depth_m: -gap_m,
            tool_uv: None,
            point,
        })
    }

    /// At an end of the surface that does not close.
    fn on_rim(&self, foot: &ClosestPoint) -> bool {
        let surface = match self.skin {
            Skin::Surface(surface) => surface,
            Skin::Part(_) => return self.skin.ends_at(foot, RIM * self.skin.size_m()),
        };
        let ends = [(surface.knots_u(), foot.u), (surface.knots_v(), foot.v)];
        let at_end = ends.map(|(knots, t)| {
            let (start, end) = knots.domain();
            t <= start || t >= end
        });
        (0..2).any(|k| at_end[k] && self.open[k])
    }

    fn gap_m(&mut self, p: &Point3) -> f64 {
        self.side * self.closest(p).signed_distance
    }

    fn closest(&mut self, p: &Point3) -> ClosestPoint {
        self.solver.closest(self.skin, p)
    }

    /// The foot of a point close to another, of which the foot is known. Of a part, descent may end on a face behind an
    /// edge, which is not the nearest.
    fn foot_near(&mut self, p: &Point3, last: &ClosestPoint, warm: &mut Warm) -> ClosestPoint {
        match self.skin {
            Skin::Surface(_) => {
                let local = self.solver.local(self.skin, p, last.u, last.v);
                local.unwrap_or(*last)
            }
            Skin::Part(_) => {
                let moved_m = (p - warm.at).norm();
                warm.at = *p;
                (self.solver).closest_warm_moved(self.skin, p, moved_m, 0.0, &mut warm.foot)
            }
        }
    }

    /// Slope of the distance along a way.
    fn slope(&self, foot: &ClosestPoint, way: &Vector3) -> f64 {
        (foot.normal * self.side).dot(way)
    }
}

/// Of a part: the last foot, and of which point.
struct Warm {
    foot: WarmFoot,
    at: Point3,
}

impl FeatureSearch {
    /// Makes room for the features of a tool.
    pub fn new(skin: &Skin, features: &Features) -> Self {
        let size_m = skin.size_m();
        let looks = skin.surface().map_or(LOOKS_OF_PART, |surface| {
            let spans = [surface.knots_u(), surface.knots_v()].map(|knots| knots.spans().count());
            LOOKS_OF_SPAN * spans[0].max(spans[1]).max(1) as f64
        });
        let ends = skin.surface().map(|surface| surface.topology().closing);
        Self {
            size_m,
            spacing_m: size_m / looks,
            closed: skin.is_closed(),
            open: ends.map_or([false; 2], |ends| {
                ends.map(|closing| closing == Closing::Open)
            }),
            corners: vec![
                CornerGap {
                    least_m: f64::INFINITY,
                    foot: None,
                };
                features.corners.len()
            ],
            blocks: features.corners.chunks(BLOCK).map(ball_around).collect(),
            found: ContactSet::new(),
            tops: Vec::with_capacity(crate::contact::MAX_CONTACTS),
        }
    }

    /// What the last search found.
    pub fn found(&self) -> &[Contact] {
        self.found.contacts()
    }

    /// Looks for the features that touch, or are within the margin.
    pub fn find(
        &mut self,
        features: &Features,
        pose: &Pose,
        skin: &Skin,
        solver: &mut SkinSolver,
        reach: &Reach,
    ) {
        let (side, size_m, spacing_m) = (reach.side(), self.size_m, self.spacing_m);
        let (open, closed) = (self.open, self.closed);
        let Self {
            found: set,
            corners,
            blocks,
            ..
        } = self;
        set.clear();
        let points = skin.points();
        let (low, high) = points
            .iter()
            .fold((points[0], points[0]), |(l, h), p| (l.inf(p), h.sup(p)));
        let behind_m = if closed { 0.0 } else { size_m };
        let mut below = Below {
            skin,
            solver,
            side,
            open,
            bounds: (low, high),
            within_m: reach.margin_m + behind_m + 1e-9 * size_m,
        };
        // The distance changes by no more than the way.
        for (block, (centre, radius_m)) in blocks.iter().enumerate() {
            let first = block * BLOCK;
            let last = corners.len().min(first + BLOCK);
            let centre = pose * centre;
            let is_near = below.may_touch(&centre, *radius_m);
            let least_m = match is_near {
                false => below.away_m(&centre) - radius_m,
                true if last - first == 1 => f64::NEG_INFINITY,
                true => below.gap_m(&centre) - radius_m,
            };
            for k in first..last {
                corners[k] = CornerGap {
                    least_m,
                    foot: None,
                };
                let p = pose * features.corners[k];
                if !is_near || least_m > reach.margin_m {
                    continue;
                }
                corners[k].least_m = below.away_m(&p);
                if below.may_touch(&p, 0.0) {
                    let foot = below.closest(&p);
                    corners[k] = CornerGap {
                        least_m: side * foot.signed_distance,
                        foot: Some(foot),
                    };
                    push(set, reach, below.contact(&foot, &p, ToolPoint::Corner));
                }
            }
        }
        for edge in &features.edges {
            let (centre, radius_m) = edge.ball();
            if !below.may_touch(&(pose * centre), radius_m) {
                continue;
            }
            along(edge, corners, spacing_m, pose, &mut below, reach, set);
        }
    }

    /// Adds what was found to what a query of the faces found, `set`, of which stays what is deeper than the features
    /// beside it.
    pub fn join(
        &mut self,
        features: &Features,
        pose: &Pose,
        skin: &Skin,
        solver: &mut SkinSolver,
        reach: &Reach,
        set: &mut ContactSet,
    ) {
        let side = reach.side();
        let agree = |c: &&Contact| {
            let own = || (skin.normal(c.u, c.v) * side).dot(&c.normal) >= AGREE;
            let smooth = match skin {
                Skin::Surface(surface) => surface.is_smooth_at(c.u, c.v),
                // Within a face; edges and corners have no normal of their own.
                Skin::Part(_) => c.point == ToolPoint::Found,
            };
            !smooth || own()
        };
        self.tops.clear();
        self.tops.extend(set.contacts().iter().filter(agree));
        set.take_out();
        self.found.contacts().iter().for_each(|c| set.push(*c));
        for top in &self.tops {
            let place = pose.inverse_transform_point(&top.on_tool);
            let beside = pose * features.nearest(&place);
            let beside_m = -side * solver.closest(skin, &beside).signed_distance;
            let by_m = top.depth_m - beside_m;
            if by_m > DEEPER * self.size_m {
                set.push(Contact {
                    point: ToolPoint::Deepest { by_m },
                    ..*top
                });
            }
        }
    }
}

/// The least distances along an edge, and the fixed points of a round one.
fn along(
    edge: &Edge,
    corners: &[CornerGap],
    spacing_m: f64,
    pose: &Pose,
    below: &mut Below<'_>,
    reach: &Reach,
    set: &mut ContactSet,
) {
    let point = |t: f64| {
        let (p, way) = edge.at(t);
        (pose * p, pose.rotation * way)
    };
    let length_m = edge.length_m();
    let looks = if edge.is_straight() {
        ((length_m / spacing_m).ceil() as usize).clamp(1, LOOKS)
    } else {
        LOOKS
    };
    let ends = edge.corners();
    // Where both ends are farther than the way between them, nothing between is near.
    if let Some(ends) = ends {
        let [a, b] = ends.map(|corner| corners[corner].least_m);
        if a + b - length_m > 2.0 * reach.margin_m {
            return;
        }
    } else {
        let (centre, radius_m) = edge.ball();
        if below.gap_m(&(pose * centre)) > radius_m + reach.margin_m {
            return;
        }
    }
    let at = |k: usize| k as f64 / looks as f64;
    let mut places = [(Point3::origin(), Vector3::zeros()); LOOKS + 1];
    for (k, place) in places.iter_mut().take(looks + 1).enumerate() {
        *place = point(at(k));
    }
    let chord_m = |k: usize| (places[k + 1].0 - places[k].0).norm();
    // Between two looks an edge is no longer than twice the way.
    let step_m = 2.0 * (0..looks).map(chord_m).fold(0.0, f64::max);
    let counts = |k: usize| {
        let beside = k.saturating_sub(1)..=(k + 1).min(looks);
        let fixed = edge.is_round() && k.is_multiple_of(EVERY);
        let reach_m = step_m * if fixed { EVERY as f64 } else { 1.0 };
        let mut near = beside.map(|k| below.may_touch(&places[k].0, reach_m));
        k == 0 || k == looks || near.any(|near| near)
    };
    let counted: [bool; LOOKS + 1] = std::array::from_fn(|k| k <= looks && counts(k));
    let mut feet = [None; LOOKS + 1];
    for k in (0..=looks).filter(|&k| counted[k]) {
        let (p, way) = places[k];
        let foot = match ends {
            Some([first, _]) if k == 0 => corners[first].foot,
            Some([_, last]) if k == looks => corners[last].foot,
            None if k == looks => feet[0].map(|(foot, _)| foot),
            _ => None,
        };
        let foot = foot.unwrap_or_else(|| below.closest(&p));
        feet[k] = Some((foot, below.slope(&foot, &way) / length_m));
        if edge.is_round() && k < looks && k.is_multiple_of(EVERY) {
            push(set, reach, below.contact(&foot, &p, ToolPoint::Round));
        }
    }
    let side = below.side;
    let depth_m =
        |k: usize| feet[k].map_or(f64::NEG_INFINITY, |(foot, _)| -side * foot.signed_distance);
    for k in 0..looks {
        let [Some((foot, from)), Some((_, to))] = [feet[k], feet[k + 1]] else {
            continue;
        };
        // An edge may come to a face that it lies on from then on, or leave one.
        let is_level = |slope: f64| slope.abs() <= LEVEL;
        let was_level = k == 0 || feet[k - 1].is_some_and(|(_, slope)| is_level(slope));
        let shift = match (from < -LEVEL, to > LEVEL) {
            (true, true) => 0.0,
            (true, false) if is_level(to) => -LEVEL,
            (false, true) if is_level(from) && was_level => LEVEL,
            _ => continue,
        };
        let (foot, p) = least(
            below,
            &point,
            length_m,
            [(at(k), from), (at(k + 1), to)],
            shift,
            foot,
        );
        let beside = if edge.is_round() {
            let before = k - k % EVERY;
            [before, before + EVERY]
        } else {
            [0, looks]
        };
        let least_m = -side * foot.signed_distance;
        let by_m = (least_m - depth_m(beside[0]).max(depth_m(beside[1]))).max(0.0);
        push(
            set,
            reach,
            below.contact(&foot, &p, ToolPoint::Deepest { by_m }),
        );
    }
}

/// Where the slope along an edge is `shift`, between two places of which it is known.
fn least(
    below: &mut Below<'_>,
    point: &impl Fn(f64) -> (Point3, Vector3),
    length_m: f64,
    [(mut low, mut at_low), (mut high, mut at_high)]: [(f64, f64); 2],
    shift: f64,
    mut foot: ClosestPoint,
) -> (ClosestPoint, Point3) {
    let mut p = point(low).0;
    (at_low, at_high) = (at_low - shift, at_high - shift);
    let mut warm = Warm {
        foot: WarmFoot::default(),
        at: p,
    };
    // Where an edge is level, no place on it is deeper.
    let close = if shift == 0.0 { 1e-15 } else { 1e-9 };
    let mut level = None;
    for step in 0..STEPS {
        let t = if step % 3 == 2 || shift != 0.0 {
            0.5 * (low + high)
        } else {
            low + (high - low) * (at_low / (at_low - at_high))
        };
        let (here, way) = point(t);
        p = here;
        foot = below.foot_near(&p, &foot, &mut warm);
        let slope = below.slope(&foot, &way) / length_m - shift;
        if slope.abs() < NO_SLOPE || high - low < close {
            break;
        }
        if slope * shift < 0.0 {
            level = Some((foot, p));
        }
        if slope < 0.0 {
            (low, at_low) = (t, slope);
        } else {
            (high, at_high) = (t, slope);
        }
    }
    // Where what is level begins or ends, the last place on it.
    level.unwrap_or((foot, p))
}

fn push(set: &mut ContactSet, reach: &Reach, contact: Option<Contact>) {
    if let Some(contact) = contact.filter(|contact| contact.depth_m >= -reach.margin_m) {
        set.push(contact);
    }
}
