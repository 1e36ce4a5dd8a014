//! Where corners and edges of a tool are in the signed distance of a body.

use super::edge::FIXED;
use super::{Edge, Features};
use crate::contact::MAX_CONTACTS;
use crate::contact::balls::{Ball, BallTree, Node};
use crate::contact::{Contact, ContactSet, Reach, ToolPoint, distance_squared_to_box};
use crate::math::{Point3, Pose, Vector3};
use crate::skin::{Skin, SkinSolver};
use crate::surface::{ClosestPoint, Closing, WarmFoot};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Looks along a round edge, and most along another.
const LOOKS: usize = 16;
/// Of these, each so many is a fixed point.
const EVERY: usize = LOOKS / FIXED;
/// Looks a span of the surface.
const LOOKS_OF_SPAN: f64 = 2.0;
/// Features of a ball that are looked at at once: a query for the ball would not save more than it takes.
const FEW: usize = 2;
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
    /// (corners): the foot of each that was asked for, and which these are.
    corners: Vec<Option<ClosestPoint>>,
    asked: Vec<usize>,
    /// Of edges and then corners, in the tool's frame.
    tree: BallTree,
    /// What is still to be looked at.
    heap: BinaryHeap<Waiting>,
    found: ContactSet,
    tops: Vec<Contact>,
}

/// Features that may be so deep, m.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Waiting {
    most_m: f64,
    node: Node,
}

impl Eq for Waiting {}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        let depth = self.most_m.total_cmp(&other.most_m);
        depth.then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A ball around points: centre and radius, m.
pub(super) fn ball_around(points: &[Point3]) -> Ball {
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
    /// A ball that keeps out of a closed body: no point is deeper in the body than it is outside of this.
    outside: Option<Ball>,
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

    /// No point of a ball is deeper, m.
    fn most_m(&self, &(centre, radius_m): &Ball) -> f64 {
        self.outside.map_or(f64::INFINITY, |(p, free_m)| {
            (centre - p).norm() + radius_m - free_m
        })
    }

    /// Finds a ball outside of a closed body, near to what may be deepest of a tool around the point of this foot.
    fn keep_out(&mut self, foot: &ClosestPoint, size_m: f64) {
        let p = foot.point + foot.normal * (foot.signed_distance.max(0.0) + size_m);
        let free_m = self.gap_m(&p);
        self.outside = (free_m > 0.0).then_some((p, free_m));
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
        let corners = features.corners.iter().map(|p| (*p, 0.0));
        let tree = BallTree::new(features.edges.iter().map(Edge::ball).chain(corners));
        Self {
            size_m,
            spacing_m: size_m / looks,
            closed: skin.is_closed(),
            open: ends.map_or([false; 2], |ends| {
                ends.map(|closing| closing == Closing::Open)
            }),
            corners: vec![None; features.corners.len()],
            asked: Vec::with_capacity(features.corners.len()),
            heap: BinaryHeap::with_capacity(tree.len()),
            tree,
            found: ContactSet::new(),
            tops: Vec::with_capacity(MAX_CONTACTS),
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
        self.found.clear();
        self.heap.clear();
        self.asked.drain(..).for_each(|k| self.corners[k] = None);
        let Some(root) = self.tree.root() else {
            return;
        };
        let points = skin.points();
        let bounds = points
            .iter()
            .fold((points[0], points[0]), |(l, h), p| (l.inf(p), h.sup(p)));
        let behind_m = if self.closed { 0.0 } else { self.size_m };
        let rounding_m = 1e-9 * self.size_m;
        let mut below = Below {
            skin,
            solver,
            side: reach.side(),
            open: self.open,
            bounds,
            within_m: reach.margin_m + behind_m + rounding_m,
            outside: None,
        };
        let (middle, radius_m) = self.tree.ball(root);
        if !below.may_touch(&(pose * middle), radius_m) {
            return;
        }
        self.heap.push(Waiting {
            most_m: f64::INFINITY,
            node: root,
        });
        while let Some(Waiting { mut most_m, node }) = self.heap.pop() {
            // Of more than there is room for, the deepest stay.
            let last = self.found.contacts().get(MAX_CONTACTS - 1);
            let least_m = last.map_or(-reach.margin_m, |contact| contact.depth_m) - rounding_m;
            if most_m < least_m {
                break;
            }
            if node.0 == 0 {
                self.look(features, node.1, pose, &mut below, reach);
                continue;
            }
            // The distance changes by no more than the way. Around more than the body it excludes nothing, and of
            // a few features each is looked at as soon.
            let (centre, radius_m) = self.tree.ball(node);
            let near = |child: &Node| self.most_of(features, *child, pose, &below) >= least_m;
            let many = node.0 > 1 || self.tree.within(node).filter(near).count() > FEW;
            if self.closed && radius_m < self.size_m && many {
                let foot = below.closest(&(pose * centre));
                most_m = most_m.min(radius_m - below.side * foot.signed_distance);
                if below.outside.is_none() && node.0 > 1 && most_m >= least_m {
                    below.keep_out(&foot, self.size_m);
                }
            }
            for child in self.tree.within(node) {
                let most_m = most_m.min(self.most_of(features, child, pose, &below));
                if most_m >= least_m {
                    self.heap.push(Waiting {
                        most_m,
                        node: child,
                    });
                }
            }
        }
    }

    /// No feature of a ball of the tree is deeper, m; −∞ where none is near.
    fn most_of(&self, features: &Features, node: Node, pose: &Pose, below: &Below<'_>) -> f64 {
        let (centre, radius_m) = self.tree.ball(node);
        let centre = pose * centre;
        if !below.may_touch(&centre, radius_m) {
            return f64::NEG_INFINITY;
        }
        match features.edges.get(node.1).filter(|_| node.0 == 0) {
            // Of a straight edge the ends are outermost.
            Some(Edge::Segment { ends, .. }) => {
                let [a, b] = ends.map(|p| below.most_m(&(pose * p, 0.0)));
                a.max(b)
            }
            _ => below.most_m(&(centre, radius_m)),
        }
    }

    /// Adds the contacts of a feature: an edge or, behind the last, a corner.
    fn look(
        &mut self,
        features: &Features,
        k: usize,
        pose: &Pose,
        below: &mut Below<'_>,
        reach: &Reach,
    ) {
        let mut foot = |corner: usize, below: &mut Below<'_>| {
            *self.corners[corner].get_or_insert_with(|| {
                self.asked.push(corner);
                below.closest(&(pose * features.corners[corner]))
            })
        };
        let Some(edge) = features.edges.get(k) else {
            let corner = k - features.edges.len();
            let foot = foot(corner, below);
            let p = pose * features.corners[corner];
            push(
                &mut self.found,
                reach,
                below.contact(&foot, &p, ToolPoint::Corner),
            );
            return;
        };
        let ends = edge.corners().map(|ends| ends.map(|k| foot(k, below)));
        along(
            edge,
            ends,
            self.spacing_m,
            pose,
            below,
            reach,
            &mut self.found,
        );
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
            let beside = pose * nearest(features, &self.tree, &place);
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

/// The point of an edge, or the corner, next to a point, m.
fn nearest(features: &Features, tree: &BallTree, p: &Point3) -> Point3 {
    let away_m = |node: Node| {
        let (centre, radius_m) = tree.ball(node);
        (centre - p).norm() - radius_m
    };
    let mut best = (f64::INFINITY, 0, *p);
    tree.descend(&mut |node| {
        if away_m(node) > best.0 * (1.0 + 1e-9) {
            return false;
        }
        if node.0 == 0 {
            let q = match features.edges.get(node.1) {
                Some(edge) => edge.nearest(p),
                None => features.corners[node.1 - features.edges.len()],
            };
            let found = ((q - p).norm(), node.1, q);
            if (found.0, found.1) < (best.0, best.1) {
                best = found;
            }
        }
        true
    });
    best.2
}

/// The least distances along an edge, and the fixed points of a round one.
fn along(
    edge: &Edge,
    ends: Option<[ClosestPoint; 2]>,
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
    // Where both ends are farther than the way between them, nothing between is near.
    if let Some(ends) = ends {
        let [a, b] = ends.map(|foot| below.side * foot.signed_distance);
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
            Some([first, _]) if k == 0 => Some(first),
            Some([_, last]) if k == looks => Some(last),
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
