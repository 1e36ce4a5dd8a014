//! From poses to contact rows.
//!
//! ```text
//! broad phase     pairs that can touch in this tick
//! ball            proxy on the exact surface ─▶ its foot, every other region in touch, samples inside
//! other shapes    anchor (the last proxy, moved on while nothing is near) ─▶ every contact in reach, samples inside
//! two bodies      every contact of both surfaces in reach, samples of each inside the other
//! itself          places where a body's surface meets itself from outside
//! ```

use super::between::{bodies, itself};
use super::feet::{MAX_FEET, ToolOnBody, Way, margin_m, meet, moving, push_foot, push_sample};
use super::follow::{Follow, FollowedTool, push_feet};
use super::manifold::{Placed, push_manifold};
use super::search::{PairState, Search};
use super::{bounce, grip, near_field, stick};
use crate::haptics::LinkPhase;
use crate::party::view;
use crate::rest;
use crate::solve::indentation::Touch;
use crate::solve::proxy::BallContact;
use crate::solve::row_key::RowKey;
use crate::solve::rows::{Approach, DeformingView, Holder, RowSet};
use crate::tick::record::ContactReport;
use palpate_geometry::basis::BasisWindow;
use palpate_geometry::contact::dispatch::Method;
use palpate_geometry::contact::exact::ball::signed_gap;
use palpate_geometry::contact::{
    Contact, Facing, Reach, ToolPoint, ToolShape, distance_squared_to_box,
};
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3, rotation_by, turn_between};

/// Most steps of an anchor through empty space in one tick.
const STRIDES: usize = 64;
/// Longest of these steps, relative to the body's size: within it, what is near is described by
/// planes.
const STRIDE: f64 = 0.05;
/// A slide shorter than this, relative to the body's size, turns no normal that a hand could tell.
const SLID: f64 = 1e-6;
/// Rounds of projection on contacts.
const PROJECTIONS: usize = 20;
/// A contact beside a foot, relative to a ball's radius: bulges of what it has pressed flat.
const BESIDE: f64 = 0.25;
/// The same for other tools, relative to the body's size.
const SAME_FOOT: f64 = 1e-3;
/// Feet closer than this, relative to the body's size, are one.
const SAME: f64 = 1e-6;

/// Moves the proxies on the surfaces as they stand and writes the rows of the contact problem.
pub(crate) fn find(search: &mut Search<'_>) {
    let scene = search.scene;
    search.rows.clear();
    search.touches.fill(Touch::default());
    search.rest.rows.clear();
    for (p, pair) in scene.pairs.iter().enumerate() {
        search.rows.begin_pair();
        if let Some(t) = pair.tool() {
            grip::push_anchors(
                scene,
                (t, &search.tools[t]),
                (p, search.pairs[p].proxy.below),
                &search.tool_parts[t],
                &search.bodies[pair.body],
                search.rows,
            );
        }
        if rest::lies(scene, search.states, search.bodies, pair) {
            keep(search, p);
            continue;
        }
        search.rest.wake(p);
        if !search.near.is_near(p) {
            let (low, high) = &search.bodies[pair.body].bounds;
            // The point of the holder that says on which side of the body it is.
            let place = match pair.holder {
                Holder::Tool(t) => search.tool_parts[t as usize].free,
                Holder::Body(other) => search.bodies[other as usize].skin.points()[0],
            };
            let away_m = distance_squared_to_box(&place, low, high).sqrt();
            let PairState { proxy, thinned, .. } = &mut search.pairs[p];
            proxy.leave(&place, away_m);
            *thinned = 0;
            search.rows.end_pair();
            continue;
        }
        match pair.holder {
            Holder::Tool(t) => {
                let t = t as usize;
                if search.tools[t].link.phase == LinkPhase::Absent {
                    continue;
                }
                let pose = match scene.tools[t].shape.ball_radius_m() {
                    Some(radius_m) if pair.method == Method::Exact => {
                        ball(search, p, t, radius_m);
                        Pose::identity()
                    }
                    _ => shape(search, p, t),
                };
                search.rows.end_pair();
                near_field::touch(search, p, t, &pose);
                continue;
            }
            Holder::Body(other) if other as usize == pair.body => itself(search, p),
            Holder::Body(other) => bodies(search, p, other as usize),
        }
        search.rows.end_pair();
    }
    bounce::meet(scene, &mut search.rows.rows);
}

/// Keeps the rows of a pair that is left alone, and sees to it that they can be reported.
fn keep(search: &mut Search<'_>, p: usize) {
    let kept = search.warm.of_pair(p);
    search.rest.rows.extend(kept);
    let reported = std::mem::replace(&mut search.rest.reported[p], true);
    if reported || kept.is_empty() {
        return;
    }
    let Holder::Body(other) = search.scene.pairs[p].holder else {
        return;
    };
    // Looks once more, and leaves no trace but the reports.
    let before = search.pairs[p];
    bodies(search, p, other as usize);
    search.pairs[p] = before;
    let Search { rest, rows, .. } = search;
    for row in rows.of_pair() {
        let Some(kept) = kept
            .iter()
            .find(|kept| kept.id == row.id && kept.force_n > 0.0)
        else {
            continue;
        };
        let report = ContactReport {
            body: row.body,
            holder: row.holder,
            u: row.u,
            v: row.v,
            point: row.point,
            normal: row.normal,
            depth_m: -row.now_m,
            force_n: row.normal * kept.force_n + kept.tangent_n,
        };
        if rest.reports.len() < rest.reports.capacity() {
            let at = rest.reports.partition_point(|(pair, _)| *pair <= p as u32);
            rest.reports.insert(at, (p as u32, report));
        }
    }
    rows.drop_pair();
}

/// A point or a sphere: its proxy on the exact surface.
fn ball(search: &mut Search<'_>, p: usize, t: usize, radius_m: f64) {
    let Search {
        scene,
        tools: states,
        states: body_states,
        warm,
        pairs: pair_states,
        tool_parts: tools,
        bodies,
        narrow: pairs,
        rows,
        hits,
        ..
    } = search;
    let pair = &scene.pairs[p];
    let body = &scene.bodies[pair.body];
    let parts = &mut bodies[pair.body];
    let (free, margin) = (tools[t].free, margin_m(radius_m, body.size_m));
    // Free motion of the body may close a gap within the tick.
    let closing = moving(body, parts);
    let near = margin + closing;
    let last = states[t].proxy;
    let touched = pair_states[p].proxy.touching;
    let mut target = tools[t].proxy;
    if states[t].grip.holds() {
        // Held where it is, not where the device pulls it.
        target = last;
    } else if touched && pair.friction.is_some() {
        target = stick::ball_target(
            &pair_states[p].proxy,
            &parts.skin,
            &last,
            &target,
            radius_m,
            stick::coefficient(pair, p, warm),
        );
    }
    let PairState {
        proxy,
        thinned,
        sunk_m,
        ..
    } = &mut pair_states[p];
    let sided = parts.sided(body);
    let held = BallContact { sided, radius_m }.constrain(
        &last,
        &target,
        body_states[pair.body].moved_m,
        proxy,
    );
    tools[t].proxy = held.centre;
    if held.gap_m >= near {
        *thinned = 0;
        return;
    }
    let reach = Reach {
        margin_m: near,
        below: proxy.below,
        closing_m: 0.0,
    };
    let here = Pose::from_parts(held.centre.coords.into(), Rotation::identity());
    pairs[p].contacts(&scene.tools[t].shape, &here, parts.side(), reach);
    let set = &pairs[p].set;
    let gap_now = (held.centre - held.foot.point).dot(&held.normal) - radius_m;
    let first = Contact {
        u: held.foot.u,
        v: held.foot.v,
        on_body: held.foot.point,
        on_tool: held.foot.point + held.normal * gap_now,
        normal: held.normal,
        depth_m: -gap_now,
        tool_uv: None,
        point: ToolPoint::Found,
    };
    let same = |contact: &&Contact| (contact.on_body - first.on_body).norm() > SAME * body.size_m;
    let way = Way {
        from: held.centre,
        rotation: Rotation::identity(),
        carried: free - held.centre,
        turned: Vector3::zeros(),
        slipped: slipped(touched, held.centre - last),
        twisted: Vector3::zeros(),
        has_arms: false,
        under: parts.step,
    };
    let feet = std::iter::once(&first).chain(set.contacts().iter().filter(same));
    let view = view(body, parts);
    let on = ToolOnBody {
        p,
        pair,
        view: view.as_ref(),
        way,
        margin_m: margin,
    };
    let side = if proxy.below { -1.0 } else { 1.0 };
    let Some(view) = view.filter(|_| radius_m > 0.0) else {
        if body.skin.part().is_none() {
            return push_plain(rows, &on, feet);
        }
        // From face to face feet keep their numbers.
        let placed = Placed {
            pose: &here,
            size_m: body.size_m,
            side,
            remembers: false,
        };
        return push_manifold(rows, &on, feet, warm.rows(), parts, &placed);
    };
    let centre = held.centre;
    let look = |point: &Point3| {
        let (gap_m, normal) = signed_gap(&centre, radius_m, point);
        (*point != centre).then_some(Facing {
            gap_m,
            normal,
            uv: [0.0; 2],
        })
    };
    let within = radius_m + near;
    let meets = |low: &Point3, high: &Point3| {
        distance_squared_to_box(&centre, low, high) <= within * within
    };
    let approach = approach(rows, &view, margin, closing);
    let every = view.samples_in_touch(approach, usize::from(*thinned), meets, look, hits);
    *thinned = every.min(255) as u8;
    for hit in hits.iter() {
        push_sample(rows, &on, &view, hit);
    }
    let tool = FollowedTool {
        on,
        view: &view,
        pose: &here,
        follow: Follow::Rolls,
        size_m: body.size_m,
        side,
        every,
        sunk_m: *sunk_m,
        beside_m: beside_m(&scene.tools[t].shape, body.size_m),
    };
    let warm = warm.rows();
    push_feet(rows, &tool, feet, warm, parts, look);
}

/// Samples that the body's own motion brings to a tool within the tick: one met a tick late
/// would be pushed out with the energy of its depth. How far the tool goes is up to what it meets.
fn approach<'a>(
    rows: &'a mut RowSet,
    view: &'a DeformingView<'a>,
    margin_m: f64,
    closing_m: f64,
) -> Approach<impl FnMut(&BasisWindow, &BasisWindow, &Vector3) -> f64 + 'a> {
    Approach {
        margin_m,
        closing_m,
        closes: move |wu: &BasisWindow, wv: &BasisWindow, normal: &Vector3| {
            rows.free_motion(view, wu, wv).dot(normal)
        },
    }
}

/// Rows of contacts in the order of their depth, on a rigid body or of a point.
fn push_plain<'a>(
    rows: &mut RowSet,
    on: &ToolOnBody<'_>,
    contacts: impl Iterator<Item = &'a Contact>,
) {
    for (k, contact) in contacts.take(MAX_FEET).enumerate() {
        push_foot(rows, on, RowKey::foot(k), contact, 0.0);
    }
}

/// Where a tool stands.
#[derive(Clone, Copy)]
struct Stand {
    place: Point3,
    rotation: Rotation,
}

impl Stand {
    fn pose(&self) -> Pose {
        Pose::from_parts(self.place.coords.into(), self.rotation)
    }

    /// From here to there: of the reference point, m, and of the orientation, rad.
    fn way_to(&self, there: &Self) -> (Vector3, Vector3) {
        (
            there.place - self.place,
            turn_between(&self.rotation, &there.rotation),
        )
    }

    /// A part of the way.
    fn go(&mut self, (way, turn): (Vector3, Vector3), part: f64) {
        self.place += way * part;
        self.rotation = rotation_by(&(turn * part)) * self.rotation;
    }
}

/// Tools other than balls, and all on the `spheres` method; returns where it looked at the tool.
fn shape(search: &mut Search<'_>, p: usize, t: usize) -> Pose {
    let Search {
        scene,
        tools: states,
        states: body_states,
        warm,
        pairs: pair_states,
        tool_parts: tools,
        bodies,
        narrow: pairs,
        rows,
        hits,
        ..
    } = search;
    let pair = &scene.pairs[p];
    let (tool, body) = (&scene.tools[t], &scene.bodies[pair.body]);
    let parts = &mut bodies[pair.body];
    let free = Stand {
        place: tools[t].free,
        rotation: tools[t].free_turn,
    };
    let margin = margin_m(0.0, body.size_m);
    // Free motion of the body may close a gap within the tick.
    let closing = moving(body, parts);
    let mu = stick::coefficient(pair, p, warm);
    let last = Stand {
        place: states[t].proxy,
        rotation: states[t].orientation,
    };
    let PairState {
        proxy,
        thinned,
        sunk_m,
        ..
    } = &mut pair_states[p];
    let touched = proxy.touching;
    let scratch_pair = &mut pairs[p];
    let gripped = states[t].grip.holds();
    // A half-space looks the same from everywhere: its contacts are those where it is going to be.
    // A tool that the device turns is looked at as it is turned.
    let mut anchor = if tool.shape.is_plane() && !gripped {
        free
    } else {
        last
    };
    if !tool.coupling.turns() {
        anchor.rotation = free.rotation;
    }
    // How far the farthest point of the tool goes when it turns by one rad.
    let lever = tool.shape.reach_m().unwrap_or(body.size_m);
    if body.two_sided {
        let moved_m = body_states[pair.body].moved_m;
        let mut sided = parts.sided(body);
        if proxy.touching {
            let foot = sided.solver.closest(sided.skin, &anchor.place);
            sided.go_round(&foot, &anchor.place, proxy);
        } else {
            sided.look(&anchor.place, moved_m, proxy);
        }
    }
    let longest = STRIDE * body.size_m;
    for stride in 0..STRIDES {
        let way = anchor.way_to(&free);
        let length = way.0.norm() + lever * way.1.norm();
        let reach = Reach {
            margin_m: length.min(longest).max(margin) + closing,
            below: proxy.below,
            closing_m: 0.0,
        };
        scratch_pair.contacts(&tool.shape, &anchor.pose(), parts.side(), reach);
        if length <= reach.margin_m
            || !scratch_pair.set.contacts().is_empty()
            || stride + 1 == STRIDES
        {
            break;
        }
        // Nothing is within reach: that far it may go.
        anchor.go(way, 0.99 * reach.margin_m / length);
    }
    if !body.is_soft() && !gripped {
        // Normals turn while the tool slides: look again from where these contacts let it go.
        let way = free.place - anchor.place;
        let mut slid = slide(scratch_pair.set.contacts(), way);
        if touched && mu > 0.0 {
            slid = stick::held_back(slid, way - slid, mu);
        }
        if slid.norm() > SLID * body.size_m && !scratch_pair.set.contacts().is_empty() {
            anchor.place += slid;
            let (way, turn) = anchor.way_to(&free);
            let margin_m = (way.norm() + lever * turn.norm()).min(longest).max(margin);
            let reach = Reach {
                margin_m,
                below: proxy.below,
                closing_m: 0.0,
            };
            scratch_pair.contacts(&tool.shape, &anchor.pose(), parts.side(), reach);
        }
    }
    let set = &scratch_pair.set;
    proxy.touching = false;
    if (set.contacts().iter()).any(|contact| contact.depth_m > -margin) {
        proxy.touch();
    }
    let ((carried, turned), (slid, twisted)) = (anchor.way_to(&free), last.way_to(&anchor));
    let way = Way {
        from: anchor.place,
        rotation: anchor.rotation,
        carried,
        turned,
        slipped: slipped(touched, slid),
        twisted: slipped(touched, twisted),
        has_arms: tool.shape.ball_radius_m().is_none(),
        under: parts.step,
    };
    let view = view(body, parts);
    let on = ToolOnBody {
        p,
        pair,
        view: view.as_ref(),
        way,
        margin_m: margin,
    };
    let mut every = 1;
    let pose = anchor.pose();
    if let Some(view) = view.filter(|_| !set.contacts().is_empty()) {
        let bounds = tool.shape.bounds(&pose);
        let meets = |low: &Point3, high: &Point3| {
            bounds.is_none_or(|bounds| meet(&bounds, low, high, margin + closing))
        };
        hits.clear();
        if !matches!(tool.shape, ToolShape::Point) {
            let look = |x: &Point3| scratch_pair.facing(&tool.shape, &pose, x, margin + closing);
            let approach = approach(rows, &view, margin, closing);
            every = view.samples_in_touch(approach, usize::from(*thinned), meets, look, hits);
            *thinned = every.min(255) as u8;
        }
        for hit in hits.iter() {
            push_sample(rows, &on, &view, hit);
        }
    }
    let warm = warm.rows();
    let edges_known = tool.shape.features().is_some();
    let is_part = body.skin.part().is_some();
    if view.is_none() && (edges_known || tool.coupling.turns() || is_part) {
        let side = if proxy.below { -1.0 } else { 1.0 };
        let placed = Placed {
            pose: &pose,
            size_m: body.size_m,
            side,
            remembers: !edges_known && tool.coupling.turns(),
        };
        let found = scratch_pair.set.contacts().iter();
        push_manifold(rows, &on, found, warm, parts, &placed);
        return pose;
    }
    let feet = scratch_pair.set.contacts().iter();
    let Some(view) = view else {
        push_plain(rows, &on, feet);
        return pose;
    };
    // What gives way has samples beside the deepest points.
    let feet = feet.filter(|contact| contact.point != ToolPoint::Round);
    let follow = match tool.shape {
        ToolShape::Point => {
            push_plain(rows, &on, feet);
            return pose;
        }
        ToolShape::Sphere { .. } => Follow::Rolls,
        ToolShape::Plane { .. } => Follow::OnBody,
        ToolShape::Surface(_) | ToolShape::Implicit { .. } | ToolShape::Mesh(_) => Follow::Stays,
    };
    let shape = &tool.shape;
    let tool = FollowedTool {
        on,
        view: &view,
        pose: &pose,
        follow,
        size_m: body.size_m,
        side: if proxy.below { -1.0 } else { 1.0 },
        every,
        sunk_m: *sunk_m,
        beside_m: beside_m(shape, body.size_m),
    };
    let facing = |point: &Point3| scratch_pair.facing(shape, &pose, point, margin);
    push_feet(rows, &tool, feet, warm, parts, facing);
    pose
}

/// Contacts nearer than this to a foot of a tool are no feet of their own, m.
fn beside_m(shape: &ToolShape, size_m: f64) -> f64 {
    match shape.ball_radius_m() {
        Some(radius_m) => BESIDE * radius_m,
        None => SAME_FOOT * size_m,
    }
}

/// A tool that did not touch before begins to resist from where it comes to touch.
fn slipped(touched: bool, way: Vector3) -> Vector3 {
    if touched { way } else { Vector3::zeros() }
}

/// The part of a way that contacts allow: projected on their half-spaces, one after the other.
fn slide(contacts: &[Contact], way: Vector3) -> Vector3 {
    let mut slid = way;
    for _ in 0..PROJECTIONS {
        let mut changed = false;
        for contact in contacts {
            let gap = slid.dot(&contact.normal) - contact.depth_m;
            if gap < 0.0 {
                slid -= contact.normal * gap;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    slid
}
