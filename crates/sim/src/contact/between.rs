//! Bodies against each other, and against themselves.

use super::bounce;
use super::feet::{MAX_FEET, TwoBodies, margin_m, meet, moving, push_between};
use super::meeting::Meeting;
use super::search::Search;
use crate::party::{BodyScratch, view};
use crate::solve::row_key::RowKey;
use crate::solve::rows::Approach;
use palpate_geometry::basis::BasisWindow;
use palpate_geometry::contact::dispatch::look_at;
use palpate_geometry::contact::{Contact, Facing, Reach, ToolPoint};
use palpate_geometry::math::{Point3, Vector3};

/// Deepest fold of a body into itself that a tick looks for, relative to the size.
const FOLD: f64 = 5e-3;

/// A contact may be deeper than the deepest of the last tick by the motion of both bodies and by this
/// share of the smaller one's size: what a search may have missed. Bodies that press, rub and push each
/// other stay below 5e-4; a crushed ball on a sheet, whose surface turns over, sees the sheet's far end
/// 0.33 of that size inside and more.
const SUDDEN: f64 = 0.02;

/// A contact this near to a foot of the last tick, relative to the size of the smaller body, is that foot.
const SAME: f64 = 0.05;

/// How much more than by its bodies a row between rigid ones that has carried gives way. Balance does not say how two
/// and more rows share a force; so they do as springs of one stiffness would. What lies is in by this share of g dt².
const EASE: f64 = 0.1;

/// A body against another, the holder: every contact of both surfaces, and samples of each inside
/// the other.
pub(super) fn bodies(search: &mut Search<'_>, p: usize, other: usize) {
    let Search {
        scene,
        states,
        warm,
        pairs: pair_states,
        bodies,
        narrow: pairs,
        rows,
        hits,
        ..
    } = search;
    let pair = &scene.pairs[p];
    let (my_body, their_body) = (&scene.bodies[pair.body], &scene.bodies[other]);
    let Ok([mine, theirs]) = bodies.get_disjoint_mut([pair.body, other]) else {
        return;
    };
    let proxy = &mut pair_states[p].proxy;
    if my_body.two_sided && their_body.two_sided && !proxy.touching {
        let corner = theirs.skin.points()[0];
        let moved_m = states[pair.body].moved_m;
        mine.sided(my_body).look(&corner, moved_m, proxy);
    }
    // Free motion may close a gap within the tick.
    let closing = moving(my_body, mine) + moving(their_body, theirs);
    let margin = margin_m(0.0, my_body.size_m.min(their_body.size_m)) + 2.0 * closing;
    let reach = Reach {
        margin_m: margin,
        below: proxy.below,
        closing_m: closing,
    };
    // What is closed has the side of a sheet on which it touches, as long as it does.
    let known = their_body.two_sided || proxy.touching && proxy.known;
    let side = pairs[p].body_contacts(mine.side(), theirs.side(), reach, known);
    if my_body.two_sided && !their_body.two_sided {
        proxy.known = side.is_some();
        proxy.below = side.is_some_and(|side| side < 0.0);
    }
    // Nothing goes deeper in a tick than it moves: what seems to lies beside a fold, where a surface
    // that was crushed has its outside in.
    let moved_m = states[pair.body].moved_m + states[other].moved_m;
    let sudden_m = SUDDEN * my_body.size_m.min(their_body.size_m);
    let most_m = proxy.deepest_m + moved_m + sudden_m;
    if proxy.met {
        pairs[p].set.keep(|contact| contact.depth_m <= most_m);
    }
    let contacts = pairs[p].set.contacts();
    let deepest_m = contacts.first().map_or(0.0, |contact| contact.depth_m);
    (proxy.met, proxy.deepest_m) = (true, deepest_m.max(0.0));
    proxy.touching = false;
    if !contacts.is_empty() {
        proxy.touch();
    }
    // The side of a sheet belongs to the place where it is touched.
    let side_of = |near: &Contact| match my_body.two_sided {
        true => (near.normal)
            .dot(&mine.skin.normal(near.u, near.v))
            .signum(),
        false => 1.0,
    };
    let of = TwoBodies {
        p,
        pair,
        views: [view(my_body, mine), view(their_body, theirs)],
        steps: [mine.step, theirs.step],
        margin_m: margin,
    };
    let views = of.views;
    let free = mine.gives().is_some() || theirs.gives().is_some();
    let thinned = usize::from(std::mem::take(&mut pair_states[p].thinned));
    if let Some(view) = views[0].as_ref().filter(|_| !contacts.is_empty()) {
        let bounds = theirs.bounds;
        let look = |x: &Point3| {
            let local = |x: &Point3, s, t| theirs.solver.local(&theirs.skin, x, s, t);
            let seen = look_at(contacts, x, margin, local)?;
            if free {
                return straight(x, seen, 1.0, theirs);
            }
            Some(seen)
        };
        let every = view.samples_in_touch(
            within(margin),
            thinned,
            |low, high| meet(&bounds, low, high, margin),
            look,
            hits,
        );
        let kept = &mut pair_states[p].thinned;
        *kept = (*kept).max(every.min(255) as u8);
        for hit in hits.iter() {
            let (u, v) = view.samples.parameter(hit.index);
            let Facing { gap_m, normal, uv } = hit.facing;
            let on_tool = hit.point + normal * gap_m;
            let contact = Contact {
                u,
                v,
                on_body: hit.point,
                on_tool,
                normal,
                depth_m: -gap_m,
                tool_uv: Some(uv),
                point: ToolPoint::Found,
            };
            push_between(rows, &of, RowKey::sample(hit.index), &contact);
        }
    }
    if let Some(view) = views[1].as_ref().filter(|_| !contacts.is_empty()) {
        let bounds = mine.bounds;
        let look = |x: &Point3| {
            let near = nearest(contacts, x, |c| (x - c.on_body).dot(&c.normal) < margin)?;
            let foot = mine.solver.local(&mine.skin, x, near.u, near.v)?;
            let side = side_of(near);
            let gap_m = side * foot.signed_distance;
            let seen = Facing {
                gap_m,
                normal: -foot.normal * side,
                uv: [foot.u, foot.v],
            };
            // Beside a rim nothing is deep.
            if free || my_body.two_sided {
                return straight(x, seen, side, mine);
            }
            Some(seen)
        };
        let every = view.samples_in_touch(
            within(margin),
            thinned,
            |low, high| meet(&bounds, low, high, margin),
            look,
            hits,
        );
        let kept = &mut pair_states[p].thinned;
        *kept = (*kept).max(every.min(255) as u8);
        for hit in hits.iter() {
            let (s, t) = view.samples.parameter(hit.index);
            let Facing {
                gap_m,
                normal,
                uv: [u, v],
            } = hit.facing;
            let on_body = hit.point + normal * gap_m;
            let contact = Contact {
                u,
                v,
                on_body,
                on_tool: hit.point,
                normal: -normal,
                depth_m: -gap_m,
                tool_uv: Some([s, t]),
                point: ToolPoint::Found,
            };
            push_between(rows, &of, RowKey::of_owner(hit.index), &contact);
        }
    }
    let meeting = Meeting {
        of,
        parts: mine,
        theirs,
        size_m: my_body.size_m,
        same_m: SAME * my_body.size_m.min(their_body.size_m),
        lies: theirs
            .gives()
            .copied()
            .filter(|_| views.iter().all(Option::is_none)),
        sides: contacts.first().map_or([1.0; 2], |near| {
            let [s, t] = near.tool_uv.unwrap_or_default();
            let of_holder = match their_body.two_sided {
                true => -near.normal.dot(&theirs.skin.normal(s, t)).signum(),
                false => 1.0,
            };
            [side_of(near), of_holder]
        }),
    };
    // Rigid faces share what they bear.
    let shares = warm.of_pair(p).iter().any(|row| row.force_n > 0.0);
    meeting.push_feet(rows, contacts, warm.rows());
    if views.iter().all(Option::is_none) && rows.of_pair().len() > 1 {
        let regularization = if shares { EASE } else { bounce::TRACE };
        (rows.of_pair_mut().iter_mut()).for_each(|row| row.regularization = regularization);
    }
}

/// A body against itself: the places where it meets itself from outside.
pub(super) fn itself(search: &mut Search<'_>, p: usize) {
    let Search {
        scene,
        bodies,
        narrow: pairs,
        rows,
        ..
    } = search;
    let pair = &scene.pairs[p];
    let body = &scene.bodies[pair.body];
    let parts = &mut bodies[pair.body];
    let margin = margin_m(0.0, body.size_m) + 2.0 * moving(body, parts);
    // Folds are met as they begin: what is deeper is a wall.
    let deepest_m = FOLD * body.size_m + margin;
    let Some(own) = parts.side().surface() else {
        return;
    };
    pairs[p].own_contacts(
        own,
        Reach {
            margin_m: margin,
            below: false,
            closing_m: 0.0,
        },
        deepest_m,
    );
    let view = view(body, parts);
    let of = TwoBodies {
        p,
        pair,
        views: [view; 2],
        steps: [parts.step; 2],
        margin_m: margin,
    };
    for (k, contact) in pairs[p].set.contacts().iter().take(MAX_FEET).enumerate() {
        push_between(rows, &of, RowKey::foot(k), contact);
    }
}

/// What a point sees of a surface on its side (+1, or −1 below a sheet), if its foot is straight below it.
/// Descent may end at a pole of a ball, with a foot from which the way to the point is no normal: other
/// starts around it lead off.
fn straight(x: &Point3, seen: Facing, side: f64, on: &BodyScratch) -> Option<Facing> {
    // Straight below, the way is the gap; beside, it misses the foot.
    let is_straight = |seen: &Facing| {
        let [u, v] = seen.uv;
        let missed_m = (on.skin.point(u, v) - (x + seen.normal * seen.gap_m)).norm();
        missed_m <= ASIDE * seen.gap_m.abs() + ASIDE_M
    };
    if is_straight(&seen) {
        return Some(seen);
    }
    let [u, v] = seen.uv;
    // Descent on a part passes over its edges.
    let surface = on.skin.surface()?;
    let (long_u, long_v) = (surface.knots_u().length(), surface.knots_v().length());
    STARTS.iter().find_map(|(a, b)| {
        let foot = on
            .solver
            .local(&on.skin, x, u + a * long_u, v + b * long_v)?;
        let seen = Facing {
            gap_m: side * foot.signed_distance,
            normal: -foot.normal * side,
            uv: [foot.u, foot.v],
        };
        is_straight(&seen).then_some(seen)
    })
}

/// Other starts of a descent, relative to the lengths of the domain in u and v.
const STARTS: [(f64, f64); 6] = [
    (0.125, 0.1),
    (-0.125, 0.1),
    (0.125, -0.1),
    (-0.125, -0.1),
    (0.375, 0.1),
    (0.375, -0.1),
];
/// A foot this far aside, relative to the gap, is still straight below.
const ASIDE: f64 = 1e-3;
/// And this far whatever the gap, m: what descent leaves over.
const ASIDE_M: f64 = 1e-8;

/// Samples nearer than `margin_m`, which has the motion of both bodies in it.
fn within(margin_m: f64) -> Approach<impl FnMut(&BasisWindow, &BasisWindow, &Vector3) -> f64> {
    Approach {
        margin_m,
        closing_m: 0.0,
        closes: |_: &BasisWindow, _: &BasisWindow, _: &Vector3| 0.0,
    }
}

/// The contact next to a point among those that pass.
fn nearest<'a>(
    contacts: &'a [Contact],
    x: &Point3,
    passes: impl Fn(&&Contact) -> bool,
) -> Option<&'a Contact> {
    let away = |c: &Contact| (c.on_body - x).norm_squared();
    contacts
        .iter()
        .filter(passes)
        .min_by(|a, b| away(a).total_cmp(&away(b)))
}
