//! From contacts to rows: which parties hold them, and how far free motion takes each.

use crate::party::BodyScratch;
use crate::party::{RigidStep, view};
use crate::scene::{Body, Pair};
use crate::solve::friction::FrictionLaw;
use crate::solve::row_key::{RowId, RowKey};
use crate::solve::rows::{DeformingView, Grip, Row, RowSet, SampleInTouch};
use palpate_geometry::contact::{Contact, ToolPoint};
use palpate_geometry::math::{Point3, Rotation, Vector3};

/// Contacts of one pair that become rows.
pub(super) const MAX_FEET: usize = 16;

/// Rows join a little before they touch, so that a bulge is met by a row in the tick in which it
/// rises.
pub(crate) fn margin_m(radius_m: f64, size_m: f64) -> f64 {
    if radius_m > 0.0 {
        0.02 * radius_m
    } else {
        1e-4 * size_m
    }
}

/// How far free motion takes any control point of a body within the tick, m.
pub(crate) fn moving(body: &Body, parts: &BodyScratch) -> f64 {
    let Some(view) = view(body, parts) else {
        return parts.step.most_m;
    };
    let pairs = view.surface.net().points().iter().zip(view.predicted);
    pairs
        .fold(0.0, |most: f64, (now, then)| {
            most.max((then - now).norm_squared())
        })
        .sqrt()
}

/// Two boxes come nearer than `margin_m`.
pub(crate) fn meet((a, b): &(Point3, Point3), low: &Point3, high: &Point3, margin_m: f64) -> bool {
    debug_assert!(
        margin_m >= 0.0 || margin_m.is_nan(),
        "boxes that must overlap"
    );
    (0..3).all(|c| low[c] <= b[c] + margin_m && high[c] >= a[c] - margin_m)
}

/// How far a tool goes within the tick, seen from where its contacts were looked for.
#[derive(Clone, Copy)]
pub(crate) struct Way {
    /// Its reference point there, m.
    pub from: Point3,
    /// How it is turned there.
    pub rotation: Rotation,
    /// From there to where it is free to go, m.
    pub carried: Vector3,
    /// The same for its orientation, rad.
    pub turned: Vector3,
    /// From where the last tick left it to there, m.
    pub slipped: Vector3,
    /// The same for its orientation, rad.
    pub twisted: Vector3,
    /// Its lever arms count: it is not a ball.
    pub has_arms: bool,
    /// How far the body goes, when it is rigid.
    pub under: RigidStep,
}

impl Way {
    /// The row of a contact, and how far the tool carries its point there.
    fn of(&self, row: Row, on_tool: &Point3) -> (Row, Vector3) {
        let arm = on_tool - self.from;
        let on_tool = self.rotation.inverse_transform_vector(&arm);
        if !self.has_arms {
            return (
                Row {
                    slip: self.slipped,
                    on_tool,
                    ..row
                },
                self.carried,
            );
        }
        (
            Row {
                slip: self.slipped + self.twisted.cross(&arm),
                arm,
                on_tool,
                ..row
            },
            self.carried + self.turned.cross(&arm),
        )
    }
}

/// A tool on a body, as its rows see it.
#[derive(Clone, Copy)]
pub(crate) struct ToolOnBody<'a> {
    /// Number of the pair.
    pub p: usize,
    pub pair: &'a Pair,
    /// Of a body that deforms.
    pub view: Option<&'a DeformingView<'a>>,
    pub way: Way,
    /// Rows join this near.
    pub margin_m: f64,
}

/// A row of a tool at a contact of its pair, its own compliance enlarged by `regularization` times itself.
pub(crate) fn push_foot(
    rows: &mut RowSet,
    on: &ToolOnBody<'_>,
    key: RowKey,
    contact: &Contact,
    regularization: f64,
) {
    let row = Row {
        regularization,
        ..row(on.p, on.pair, key, contact)
    };
    let (row, carried) = on.way.of(row, &contact.on_tool);
    match on.view {
        Some(view) => {
            let windows = windows(view, contact.u, contact.v);
            rows.push(
                row,
                Grip::Deforming(view, &windows.0, &windows.1),
                Grip::Carried(carried),
                on.margin_m,
            );
        }
        None => rows.push(
            row,
            carried_by(&on.way.under, &contact.on_body),
            Grip::Carried(carried),
            on.margin_m,
        ),
    }
}

/// A row of a tool at a sample of a deforming body.
pub(crate) fn push_sample(
    rows: &mut RowSet,
    on: &ToolOnBody<'_>,
    view: &DeformingView<'_>,
    hit: &SampleInTouch,
) {
    let (u, v) = view.samples.parameter(hit.index);
    let (wu, wv) = view.samples.windows(hit.index);
    let contact = Contact {
        u,
        v,
        on_body: hit.point,
        on_tool: hit.point + hit.facing.normal * hit.facing.gap_m,
        normal: hit.facing.normal,
        depth_m: -hit.facing.gap_m,
        tool_uv: None,
        point: ToolPoint::Found,
    };
    let row = row(on.p, on.pair, RowKey::sample(hit.index), &contact);
    let (row, carried) = on.way.of(row, &contact.on_tool);
    let body = Grip::Deforming(view, wu, wv);
    rows.push(row, body, Grip::Carried(carried), on.margin_m);
}

/// A point of a tool that is held to a point of a body.
pub(crate) struct HeldPoint {
    pub contact: Contact,
    /// From the body's point to where the tool's is free to go, m.
    pub away: Vector3,
    /// There from the tool's reference point, m.
    pub arm: Vector3,
    /// Most that the grip bears, N.
    pub limit_n: f64,
}

/// A row that holds a point of a tool.
pub(crate) fn push_anchor(
    rows: &mut RowSet,
    p: usize,
    pair: &Pair,
    key: RowKey,
    held: &HeldPoint,
    view: Option<&DeformingView<'_>>,
    under: &RigidStep,
) {
    let contact = &held.contact;
    let row = Row {
        slip: held.away,
        arm: held.arm,
        law: FrictionLaw::Grip {
            limit_n: held.limit_n,
        },
        ..row(p, pair, key, contact)
    };
    let mine = view.map(|view| (view, windows(view, contact.u, contact.v)));
    let body = grip_of(&mine, under, &contact.on_body);
    rows.push(row, body, Grip::Fixed, f64::INFINITY);
}

/// Two bodies as their rows see them: the pair's body first, then its holder.
pub(crate) struct TwoBodies<'a> {
    /// Number of the pair.
    pub p: usize,
    pub pair: &'a Pair,
    /// Of those that deform.
    pub views: [Option<DeformingView<'a>>; 2],
    /// How each goes within the tick, of rigid bodies that move.
    pub steps: [RigidStep; 2],
    /// Rows join this near.
    pub margin_m: f64,
}

/// A row between two bodies.
pub(crate) fn push_between(rows: &mut RowSet, of: &TwoBodies<'_>, key: RowKey, contact: &Contact) {
    debug_assert!(of.margin_m > 0.0, "rows join before they touch");
    let Some([s, t]) = contact.tool_uv else {
        return;
    };
    let TwoBodies { views, steps, .. } = of;
    let mut row = row(of.p, of.pair, key, contact);
    row.on_tool = Vector3::new(s, t, 0.0);
    let mine = views[0]
        .as_ref()
        .map(|view| (view, windows(view, contact.u, contact.v)));
    let theirs = views[1].as_ref().map(|view| (view, windows(view, s, t)));
    let body = grip_of(&mine, &steps[0], &contact.on_body);
    let holder = grip_of(&theirs, &steps[1], &contact.on_tool);
    rows.push(row, body, holder, of.margin_m);
}

type Windows = (
    palpate_geometry::basis::BasisWindow,
    palpate_geometry::basis::BasisWindow,
);

fn grip_of<'a>(
    side: &'a Option<(&'a DeformingView<'a>, Windows)>,
    step: &RigidStep,
    point: &Point3,
) -> Grip<'a> {
    match side {
        Some((view, windows)) => Grip::Deforming(view, &windows.0, &windows.1),
        None => carried_by(step, point),
    }
}

/// A point of a rigid body.
fn carried_by<'a>(step: &RigidStep, point: &Point3) -> Grip<'a> {
    match step.most_m > 0.0 {
        true => Grip::Carried(step.at(point)),
        false => Grip::Fixed,
    }
}

fn windows(view: &DeformingView<'_>, u: f64, v: f64) -> Windows {
    (
        view.surface.knots_u().window(u),
        view.surface.knots_v().window(v),
    )
}

/// With friction a row begins as one that drags: how much of the pair's drag is its own, the solve
/// knows.
fn law(pair: &Pair) -> FrictionLaw {
    pair.friction
        .map_or(FrictionLaw::SMOOTH, |friction| FrictionLaw::Push {
            mu: friction.mu,
            drag_n_m: friction.viscous_n_s_m,
        })
}

fn row(p: usize, pair: &Pair, key: RowKey, contact: &Contact) -> Row {
    Row {
        id: RowId {
            pair: p as u32,
            key,
        },
        body: pair.body as u32,
        holder: pair.holder,
        normal: contact.normal,
        gap_m: -contact.depth_m,
        now_m: -contact.depth_m,
        regularization: 0.0,
        counts_m: match contact.point {
            ToolPoint::Deepest { by_m } => by_m,
            ToolPoint::Found | ToolPoint::Corner | ToolPoint::Round => f64::INFINITY,
        },
        slip: Vector3::zeros(),
        forced: Vector3::zeros(),
        law: law(pair),
        point: contact.on_body,
        arm: Vector3::zeros(),
        on_tool: Vector3::zeros(),
        u: contact.u,
        v: contact.v,
        on_body: Default::default(),
        on_holder: Default::default(),
    }
}
