//! Where friction keeps a tool.
//!
//! Contacts are looked for where it is going to be, not where it would slide without friction; that
//! is only the place at which the contact problem is made linear, its forces come from
//! [`crate::tick::balance`]. And each row that sticks remembers where.

use super::warm::{Warm, WarmRow};
use crate::party::BodyScratch;
use crate::party::{ToolScratch, view};
use crate::scene::{Body, Pair, Scene};
use crate::solve::friction::{FrictionLaw, Stick};
use crate::solve::indentation::Touch;
use crate::solve::proxy::ProxyState;
use crate::solve::rows::{Row, RowSet};
use crate::solve::solver::Solver;
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_geometry::skin::Skin;

/// A contact that has rolled this far from where it stuck, relative to the body's size, sticks anew
/// where it is: the body may turn under the tool, and another place of it moves otherwise. Far
/// above what a trembling hand rolls.
const ROLLS: f64 = 0.01;

/// Coefficient that counts for pair `p` now: the kinetic one once any of its rows slips.
pub(crate) fn coefficient(pair: &Pair, p: usize, warm: &Warm) -> f64 {
    let Some(friction) = pair.friction else {
        return 0.0;
    };
    if warm.of_pair(p).iter().any(|row| row.slips) {
        friction.mu_kinetic
    } else {
        friction.mu
    }
}

/// What friction leaves of a slide when the surface keeps the tool from going `blocked` as well.
pub(crate) fn held_back(slide: Vector3, blocked: Vector3, mu: f64) -> Vector3 {
    debug_assert!(mu >= 0.0, "friction that drives");
    let (length, held) = (slide.norm(), mu * blocked.norm());
    if length > held {
        slide * (1.0 - held / length)
    } else {
        Vector3::zeros()
    }
}

/// Where a ball that touches goes when it wants to go to `target`: on its tangent plane at `last`,
/// as far as friction lets it.
pub(crate) fn ball_target(
    proxy: &ProxyState,
    skin: &Skin,
    last: &Point3,
    target: &Point3,
    radius_m: f64,
    mu: f64,
) -> Point3 {
    let foot = skin.point(proxy.foot.u, proxy.foot.v);
    let outward = skin.normal(proxy.foot.u, proxy.foot.v) * if proxy.below { -1.0 } else { 1.0 };
    // At an edge the ball leans against it from where it is.
    let away = last - foot;
    let distance = away.norm();
    let leans = radius_m > 0.0 && away.dot(&outward) > 0.5 * radius_m;
    let normal = if leans { away / distance } else { outward };
    let depth = radius_m - (target - foot).dot(&normal);
    let pressed = depth > 0.0;
    if !pressed {
        return *target;
    }
    let way = target - last;
    let along = normal * way.dot(&normal);
    last + along + held_back(way - along, normal * depth, mu)
}

/// How far free motion takes a row past where it sticks, and where that is. `old`: the row in the
/// last tick; `touch`: that of its pair.
pub(crate) fn slip(
    scene: &Scene,
    tools: &[ToolScratch],
    bodies: &[BodyScratch],
    rows: &mut RowSet,
    row: &Row,
    (old, touch): (Option<&WarmRow>, &Touch),
) -> (Vector3, Stick) {
    let stuck = old.filter(|old| !old.slips).map(|old| old.stick);
    match (row.law, row.tool()) {
        (FrictionLaw::Grip { .. }, _) => (row.slip, Stick::default()),
        (FrictionLaw::Push { mu: 0.0, .. }, _) => (row.slip, Stick::default()),
        (FrictionLaw::Push { .. }, Some(t)) => {
            let (body, parts) = (&scene.bodies[row.body as usize], &bodies[row.body as usize]);
            let free = tools[t].free;
            // Where a ball sticks does not turn with it.
            let ball = scene.tools[t].shape.ball_radius_m().is_some();
            let turn = if ball {
                Rotation::identity()
            } else {
                tools[t].free_turn
            };
            let here = predicted(rows, body, parts, row.u, row.v);
            let mut slip = row.slip + touch.drawn_m;
            if let Some(stick) = stuck {
                let there = predicted(rows, body, parts, stick.u, stick.v);
                slip = free - there - turn * stick.offset - row.forced;
                if (here - there).norm() <= ROLLS * body.size_m {
                    return (slip - touch.left_m(), stick);
                }
            }
            (
                slip - touch.left_m(),
                Stick {
                    u: row.u,
                    v: row.v,
                    offset: turn.inverse_transform_vector(&(free - here - row.forced - slip)),
                },
            )
        }
        (FrictionLaw::Push { .. }, None) => {
            let offset = old.map_or_else(Vector3::zeros, |old| old.stick.offset);
            (row.slip + offset, Stick::default())
        }
    }
}

/// Where rows of this tick will stick in the next, now that forces are known: between bodies that is how far they have
/// crept, and what slips sticks nowhere.
pub(crate) fn settle(rows: &[Row], solver: &mut Solver) {
    let Solver {
        problem,
        matrix,
        sticks,
        ..
    } = solver;
    for (i, (row, stick)) in rows.iter().zip(sticks).enumerate() {
        if row.tool().is_none() && row.law.acts_across() {
            // What the row gives way more than its bodies is no way that they go: it stays bent by that.
            let bent = matrix.block(i, i)
                * problem.force_n(i)
                * (row.regularization / (1.0 + row.regularization));
            let crept = match problem.slips(i) {
                true => Vector3::zeros(),
                false => problem.displaced_m(i),
            };
            let offset = crept - bent;
            stick.offset = offset - row.normal * offset.dot(&row.normal);
        } else if problem.slips(i) {
            *stick = Stick::default();
        }
    }
}

/// A point of a body after free motion.
fn predicted(rows: &mut RowSet, body: &Body, parts: &BodyScratch, u: f64, v: f64) -> Point3 {
    match view(body, parts) {
        Some(view) => rows.predicted_point(&view, u, v),
        None => {
            let point = parts.skin.point(u, v);
            point + parts.step.at(&point)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slide_is_shortened_by_the_cone_and_never_turned_round() {
        let (slide, blocked) = (Vector3::new(3.0, 4.0, 0.0), Vector3::new(0.0, 0.0, -2.0));
        assert!((held_back(slide, blocked, 0.5).norm() - 4.0).abs() < 1e-15);
        assert_eq!(held_back(slide, blocked, 2.5), Vector3::zeros());
        assert_eq!(held_back(slide, blocked, 0.0), slide);
    }
}
