//! The surface of a body after any tick: as recorded, or by replaying to it from the keyframe
//! before.

use super::super::reader::Session;
use super::super::replay::{Follower, recorded_scene};
use super::ExportError;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;
use palpate_sim::scene::Scene;

/// The surface of a body after tick `tick`, in the scene's axes, m.
///
/// A net that was recorded at that tick is taken as it is. Else the ticks from the keyframe before
/// are simulated again, and what they come to must have the recorded hash: a net is exact or an
/// error.
///
/// # Errors
/// A body or tick that there is not, a tick that no keyframe leads to, or a build that comes to
/// another state.
pub fn net_at(session: &Session, body: &str, tick: u64) -> Result<Surface, ExportError> {
    let scene = recorded_scene(session)?;
    let ids = || (0..scene.body_count()).map(|body| scene.body_id(body));
    let Some(index) = ids().position(|id| id == body) else {
        let bodies = ids().map(str::to_owned).collect();
        return Err(ExportError::UnknownBody {
            body: body.to_owned(),
            bodies,
        });
    };
    let points = match recorded(
        session,
        body,
        tick,
        scene.rest_surface(index).net().points().len(),
    ) {
        Some(points) => points,
        None => replayed(session, &scene, index, tick)?,
    };
    let mut surface = scene.rest_surface(index).clone();
    surface.net_mut().points_mut().copy_from_slice(&points);
    Ok(surface)
}

fn recorded(session: &Session, body: &str, tick: u64, count: usize) -> Option<Vec<Point3>> {
    let first = session.nets.partition_point(|net| net.tick < tick);
    let mut of_tick = session.nets[first..]
        .iter()
        .take_while(|net| net.tick == tick);
    let net = of_tick.find(|net| net.body == body && net.points.len() == 3 * count)?;
    let points: Vec<Point3> = net
        .points
        .chunks_exact(3)
        .map(|p| Point3::new(p[0], p[1], p[2]))
        .collect();
    points
        .iter()
        .all(|point| point.coords.iter().all(|x| x.is_finite()))
        .then_some(points)
}

fn replayed(
    session: &Session,
    scene: &Scene,
    body: usize,
    tick: u64,
) -> Result<Vec<Point3>, ExportError> {
    let keyframes = &session.keyframes;
    let last = session.ticks.last().map(|record| record.output.tick);
    let first = keyframes.first().map(|keyframe| keyframe.tick);
    let known = first.map(|first| (first, last.unwrap_or(first).max(first)));
    if known.is_none_or(|(first, last)| tick < first || tick > last) {
        return Err(ExportError::UnknownTick { tick, ticks: known });
    }
    // One of this very tick will do, unless it holds commands that came after it: then the one
    // before leads here.
    let before = keyframes.partition_point(|keyframe| keyframe.tick < tick);
    let own = keyframes
        .get(before)
        .filter(|keyframe| keyframe.tick == tick && keyframe.commands == 0);
    let earlier = || before.checked_sub(1).map(|k| &keyframes[k]);
    let keyframe = own.or_else(earlier).unwrap_or_else(|| &keyframes[before]);
    let mut follower = Follower::new(scene, session);
    let mut hash = follower.seat(keyframe)?;
    let mut expected = keyframe.state_hash;
    let start = session
        .ticks
        .partition_point(|record| record.output.tick <= keyframe.tick);
    let end = session
        .ticks
        .partition_point(|record| record.output.tick <= tick);
    let mut at = keyframe.tick;
    for record in &session.ticks[start..end] {
        at += 1;
        if record.output.tick != at {
            break;
        }
        hash = follower.tick(at, &record.input).state_hash;
        expected = record.output.state_hash;
    }
    if at != tick {
        let next = keyframes
            .iter()
            .map(|keyframe| keyframe.tick)
            .find(|next| *next > tick);
        return Err(ExportError::Unreached { tick, next });
    }
    if hash != expected {
        let id = scene.body_id(body);
        let ticks = || {
            session
                .nets
                .iter()
                .filter(|net| net.body == id)
                .map(|net| net.tick)
        };
        let nets = ticks()
            .take_while(|other| *other < tick)
            .last()
            .into_iter()
            .chain(ticks().find(|other| *other > tick))
            .collect();
        return Err(ExportError::Inexact { tick, nets });
    }
    let mut points = scene.rest_surface(body).net().points().to_vec();
    follower.state().copy_net(scene, body, &mut points);
    Ok(points)
}
