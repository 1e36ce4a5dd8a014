//! The surface of a body after any tick: as recorded, or by replaying to it from the keyframe
//! before.

use super::super::channel::{Happening, Topic};
use super::super::reader::{Follower, ReadError, Session};
use super::super::replay::recorded_scene;
use super::ExportError;
use super::reached::Reached;
use palpate_geometry::math::{Point3, first_outside};
use palpate_geometry::surface::Surface;
use palpate_sim::scene::Scene;
use std::sync::Arc;

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
    let scene = Arc::new(recorded_scene(session)?);
    let ids = || (0..scene.body_count()).map(|body| scene.body_id(body));
    let Some(index) = ids().position(|id| id == body) else {
        let bodies = ids().map(str::to_owned).collect();
        return Err(ExportError::UnknownBody {
            body: body.to_owned(),
            bodies,
        });
    };
    let count = scene.skin(index).points().len();
    let points = match recorded(session, body, tick, count)? {
        Some(points) => points,
        None => replayed(session, &scene, index, tick)?,
    };
    (scene.surface_with(index, &points)?).ok_or_else(|| ExportError::Part {
        body: body.to_owned(),
    })
}

fn recorded(
    session: &Session,
    body: &str,
    tick: u64,
    count: usize,
) -> Result<Option<Vec<Point3>>, ReadError> {
    for happening in Follower::between(session, tick, tick).only(&[Topic::Net]) {
        let Happening::Net(net) = happening? else {
            continue;
        };
        if net.body == body && net.points.len() == 3 * count {
            let points = net.points.chunks_exact(3);
            let points: Vec<_> = points.map(|p| Point3::new(p[0], p[1], p[2])).collect();
            // What no net can be is not taken: the ticks tell what it was.
            if first_outside(&points).is_none() {
                return Ok(Some(points));
            }
        }
    }
    Ok(None)
}

fn replayed(
    session: &Session,
    scene: &Arc<Scene>,
    body: usize,
    tick: u64,
) -> Result<Vec<Point3>, ExportError> {
    let reached = Reached::after(session, scene, tick)?;
    if !reached.is_exact {
        let nets = nets_near(session, scene.body_id(body), tick)?;
        return Err(ExportError::Inexact { tick, nets });
    }
    let mut points = Vec::new();
    reached.rerun.copy_net(body, &mut points);
    Ok(points)
}

/// Ticks of the last net of a body before a tick and of the first after it.
fn nets_near(session: &Session, body: &str, tick: u64) -> Result<Vec<u64>, ReadError> {
    let mut near = Vec::new();
    for happening in Follower::new(session).only(&[Topic::Net]) {
        let Happening::Net(net) = happening? else {
            continue;
        };
        if net.body != body || net.tick == tick {
            continue;
        }
        if net.tick > tick {
            near.push(net.tick);
            break;
        }
        near = vec![net.tick];
    }
    Ok(near)
}
