//! The same bodies in our engine and in rapier3d, both in this process, and in MuJoCo, which runs in Python.

use super::setup::{BALL_M, DT_S, HEIGHT_M, Motion, RADIUS_M, Setup};
#[cfg(feature = "peers")]
use super::setup::{Form, Thing};
use crate::measure::clocked;
use crate::peers::python;
use palpate_geometry::math::Point3;
use palpate_sim::World;
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;

/// What runs in Python: prints one JSON object.
const SCRIPT: &str = include_str!("../../../../../benches/peers/rigid.py");

/// A tick, and the bodies after it.
#[derive(Clone, Debug, serde::Deserialize)]
pub(super) struct Frame {
    pub took_s: f64,
    /// All of them.
    pub asleep: bool,
    pub bodies: Vec<Motion>,
}

/// What an engine did, or why it did nothing.
pub(super) struct Outcome {
    pub method: String,
    pub peer: bool,
    pub frames: Result<Vec<Frame>, String>,
}

/// Of all engines that there are.
pub(super) fn outcomes(setup: &Setup) -> Vec<Outcome> {
    let mut all = vec![Outcome {
        method: "palpate".to_owned(),
        peer: false,
        frames: ours(setup),
    }];
    #[cfg(feature = "peers")]
    for (stiffness, hz) in [("its own softness", None), ("stiff", Some(STIFF_HZ))] {
        all.push(Outcome {
            method: format!("rapier3d, {SUBSTEPS} substeps, {stiffness}"),
            peer: true,
            frames: Ok(rapier(setup, hz)),
        });
    }
    all.extend(mujoco(setup));
    all
}

pub(super) fn ours(setup: &Setup) -> Result<Vec<Frame>, String> {
    let mut world = crate::parse(&setup.text())?;
    let first = usize::from(setup.floor);
    let bodies = first..first + setup.things.len();
    let mut tick = || {
        let (took, ()) = clocked(|| {
            world.tick();
        });
        let World { scene, state, .. } = &world;
        Some(Frame {
            took_s: took.as_secs_f64(),
            asleep: bodies.clone().all(|body| state.is_left_alone(body)),
            bodies: (bodies.clone())
                .map(|body| motion(scene, state, body))
                .collect::<Option<_>>()?,
        })
    };
    let frames = (0..setup.ticks).map(|_| tick()).collect::<Option<_>>();
    frames.ok_or_else(|| "a body is not free".to_owned())
}

fn motion(scene: &Scene, state: &SceneState, body: usize) -> Option<Motion> {
    let motion = state.rigid_motion(scene, body)?;
    let [low, high] =
        [0.0, 1.0].map(|z| state.carried_point(scene, body, &Point3::new(0.0, 0.0, z)));
    Some(Motion {
        centre_m: motion.centre.coords.into(),
        velocity_m_s: motion.velocity_m_s.into(),
        spin_rad_s: motion.spin_rad_s.into(),
        axis: (high - low).into(),
    })
}

/// As many as rapier takes if nobody says otherwise.
#[cfg(feature = "peers")]
const SUBSTEPS: usize = 4;
/// Of its contacts if they are stiff: tall stacks stand best at an eighth of the rate of substeps. Its own
/// have 30, and 60 on what is fixed.
#[cfg(feature = "peers")]
const STIFF_HZ: f64 = 500.0;

#[cfg(feature = "peers")]
fn rapier(setup: &Setup, contacts_hz: Option<f64>) -> Vec<Frame> {
    use rapier3d_f64::prelude::*;
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::from_array(setup.gravity_m_s2);
    let parameters = &mut world.integration_parameters;
    parameters.dt = DT_S;
    parameters.num_solver_iterations = SUBSTEPS;
    // Its tolerances are shares of this length, the size of a body.
    parameters.length_unit = 2.0 * RADIUS_M;
    if let Some(hz) = contacts_hz {
        parameters.contact_softness.natural_frequency = hz;
        parameters.static_contact_softness.natural_frequency = hz;
    }
    let rubs = |collider: ColliderBuilder| {
        let collider = collider.friction(setup.mu);
        collider.restitution(setup.restitution)
    };
    if setup.floor {
        let floor = ColliderBuilder::new(SharedShape::halfspace(Vector::Z));
        world.insert(RigidBodyBuilder::fixed(), rubs(floor));
    }
    let add = |thing: &Thing| {
        let collider = match thing.shape {
            // Its cylinders are along y.
            Form::Puck => ColliderBuilder::cylinder(0.5 * HEIGHT_M, RADIUS_M)
                .rotation(Vector::X * std::f64::consts::FRAC_PI_2),
            Form::Ball => ColliderBuilder::ball(BALL_M),
        };
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::from_array(thing.centre_m()))
            .linvel(Vector::from_array(thing.velocity_m_s))
            .angvel(Vector::from_array(thing.spin_rad_s));
        world
            .insert(body, rubs(collider).density(thing.density_kg_m3))
            .0
    };
    let handles: Vec<RigidBodyHandle> = setup.things.iter().map(add).collect();
    let tick = |_| {
        let (took, ()) = clocked(|| world.step());
        let bodies = || handles.iter().map(|&handle| &world.bodies[handle]);
        Frame {
            took_s: took.as_secs_f64(),
            asleep: bodies().all(RigidBody::is_sleeping),
            bodies: bodies().map(carried).collect(),
        }
    };
    (0..setup.ticks).map(tick).collect()
}

#[cfg(feature = "peers")]
fn carried(body: &rapier3d_f64::prelude::RigidBody) -> Motion {
    Motion {
        centre_m: body.center_of_mass().to_array(),
        velocity_m_s: body.linvel().to_array(),
        spin_rad_s: body.angvel().to_array(),
        axis: (*body.rotation() * rapier3d_f64::prelude::Vector::Z).to_array(),
    }
}

/// What MuJoCo did with some setting of its contacts.
#[derive(serde::Deserialize)]
struct Run {
    method: String,
    frames: Vec<Frame>,
}

/// None where no Python is named.
fn mujoco(setup: &Setup) -> Vec<Outcome> {
    let input = serde_json::json!({
        "setup": setup, "dt_s": DT_S, "radius_m": RADIUS_M, "height_m": HEIGHT_M, "ball_m": BALL_M,
    });
    let outcome = |method, frames| Outcome {
        method,
        peer: true,
        frames,
    };
    match python::answer::<Vec<Run>>(SCRIPT, &input) {
        None => Vec::new(),
        Some(Err(why)) => vec![outcome("mujoco".to_owned(), Err(why))],
        Some(Ok(runs)) => runs
            .into_iter()
            .map(|run| outcome(run.method, Ok(run.frames)))
            .collect(),
    }
}
