//! What a replay restores.

use super::frame::FrameState;
use super::quality;
use super::rigid::RigidState;
use super::warm::Warm;
use crate::body::{DeformableState, Field};
use crate::haptics::{DeviceBounds, Link, Port};
use crate::scene::{BodyModel, Scene};
use crate::solve::grip::{GRAB, GripState};
use crate::solve::proxy::ProxyState;
use palpate_geometry::math::{Coded, Point3, Rotation, StateSize, Vector3, state_size};
use palpate_geometry::stateful;
use palpate_geometry::surface::WarmFoot;

/// Whether bodies move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunState {
    /// Ticking.
    Running,
    /// Standing still, but for this many ticks.
    Paused {
        /// Ticks still to run.
        steps: u32,
    },
    /// Forces fade for good.
    Stopping,
}

/// All that a replay must restore. Hashed every tick.
#[derive(Debug, PartialEq)]
pub struct SceneState {
    /// Ticks done.
    pub tick: u64,
    /// Whether bodies move.
    pub run: RunState,
    /// 0 is full quality; see [`super::quality`].
    pub quality: u8,
    /// The last tick set a body back to rest: the next forces say so.
    pub faulted: bool,
    /// By body.
    pub bodies: Vec<BodyState>,
    /// By tool.
    pub tools: Vec<ToolState>,
    /// By pair of the plan.
    pub pairs: Vec<PairState>,
    /// How the frame of the bodies moves; saved only where a tool carries it.
    pub frame: FrameState,
    /// A tool carries the bodies.
    pub(crate) carried: bool,
    /// Contact forces of the last tick.
    pub warm: Warm,
}

/// State of a body.
#[derive(Debug, Default, PartialEq)]
pub struct BodyState {
    /// Nodes, when it deforms.
    pub deformable: Option<DeformableState>,
    /// Grows with every change of the net.
    pub revision: u64,
    /// How far the farthest control point moved in the last tick, m.
    pub moved_m: f64,
    /// Ticks since the body's step began, for bodies that step once in several ticks; those by which it
    /// was put off do not count.
    pub phase: u32,
    /// The next tick neither begins nor takes over a step: it is late.
    pub put_off: bool,
    /// (coordinates), N: contact forces of the tick in which that step began; empty for bodies that
    /// step every tick.
    pub loads: Vec<Vector3>,
    /// Where it is, when it is rigid and moves.
    pub rigid: Option<RigidState>,
}

/// Steps of bodies on other threads: begun with the loads of one tick, taken over some ticks later,
/// always the same number but for those in which they were put off.
pub trait Pipeline: Send + std::fmt::Debug {
    /// Begins the step of a body: `predicted` is its free motion, `loads` are its contact forces.
    fn start(
        &mut self,
        body: usize,
        field: Field,
        state: &DeformableState,
        predicted: &[Point3],
        loads: &[Vector3],
    );
    /// True when neither beginning a step nor taking over the one that was begun would wait.
    fn is_ready(&mut self, body: usize) -> bool;
    /// Waits for that step: the state after it, and the free motion of the next. False if none was
    /// begun.
    fn finish(
        &mut self,
        body: usize,
        state: &mut DeformableState,
        predicted: &mut [Point3],
    ) -> bool;
    /// Forgets all steps that were begun.
    fn cancel(&mut self);
}

/// State of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolState {
    /// Its device.
    pub link: Link,
    /// Where the surface holds the tool back, m.
    pub proxy: Point3,
    /// How it is turned there; without a coupling for rotation, as the device is.
    pub orientation: Rotation,
    /// Energy between its device and the loop.
    pub port: Port,
    /// What its device can bear, as reported.
    pub bounds: DeviceBounds,
    /// What it grabs; nothing while the button is up.
    pub grip: GripState,
}

/// State of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairState {
    /// The proxy's.
    pub proxy: ProxyState,
    /// Every which of the body's samples is a row, in u and v: 2 and more where the contact has more
    /// than there are rows; 0 before there was a contact.
    pub thinned: u8,
}

impl Scene {
    /// The state at the start.
    pub fn initial_state(&self) -> SceneState {
        let bodies = self.bodies.iter().map(|body| match &body.model {
            BodyModel::Rigid => BodyState {
                deformable: None,
                revision: 0,
                moved_m: 0.0,
                phase: 0,
                put_off: false,
                loads: Vec::new(),
                rigid: body.mover.as_ref().map(RigidState::start),
            },
            BodyModel::Deforming(model) => BodyState {
                deformable: Some(model.deformable.rest_state()),
                revision: 0,
                moved_m: 0.0,
                phase: 0,
                put_off: false,
                loads: vec![
                    Vector3::zeros();
                    if model.every > 1 {
                        model.deformable.coordinate_count()
                    } else {
                        0
                    }
                ],
                rigid: None,
            },
        });
        let tools = self.tools.iter().map(|tool| {
            let mut link = Link::default();
            (link.pose.position, link.pose.orientation) = tool.start;
            let (proxy, orientation) = tool.start;
            let (port, bounds, grip) = (
                Port::default(),
                DeviceBounds::default(),
                GripState::default(),
            );
            ToolState {
                link,
                proxy,
                orientation,
                port,
                bounds,
                grip,
            }
        });
        SceneState {
            tick: 0,
            run: RunState::Running,
            quality: 0,
            faulted: false,
            bodies: bodies.collect(),
            tools: tools.collect(),
            pairs: vec![PairState::default(); self.pairs.len()],
            frame: FrameState::default(),
            carried: self.frame.is_some(),
            warm: Warm::with_room(self.most_rows()),
        }
    }
}

impl Clone for SceneState {
    fn clone(&self) -> Self {
        let mut copy = Self {
            tick: 0,
            run: RunState::Running,
            quality: 0,
            faulted: false,
            bodies: Vec::new(),
            tools: Vec::new(),
            pairs: Vec::new(),
            frame: FrameState::default(),
            carried: false,
            warm: Warm::with_room(0),
        };
        copy.clone_from(self);
        copy
    }

    /// Allocates nothing between states of one scene.
    fn clone_from(&mut self, from: &Self) {
        let Self {
            tick,
            run,
            quality,
            faulted,
            bodies,
            tools,
            pairs,
            frame,
            carried,
            warm,
        } = self;
        (*tick, *run) = (from.tick, from.run);
        (*quality, *faulted) = (from.quality, from.faulted);
        bodies.clone_from(&from.bodies);
        tools.clone_from(&from.tools);
        pairs.clone_from(&from.pairs);
        (*frame, *carried) = (from.frame, from.carried);
        warm.clone_from(&from.warm);
    }
}

impl Clone for BodyState {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.clone_from(self);
        copy
    }

    /// Allocates nothing between states of one body.
    fn clone_from(&mut self, from: &Self) {
        let Self {
            deformable,
            revision,
            moved_m,
            phase,
            put_off,
            loads,
            rigid,
        } = self;
        *rigid = from.rigid;
        // `Option` hands its value's own `clone_from` on.
        deformable.clone_from(&from.deformable);
        (*revision, *moved_m) = (from.revision, from.moved_m);
        (*phase, *put_off) = (from.phase, from.put_off);
        loads.clone_from(&from.loads);
    }
}

impl BodyState {
    /// It lies at rest, and may be left alone with its contacts.
    pub(super) fn lies_calm(&self) -> bool {
        let free = self.rigid.as_ref().and_then(RigidState::flight);
        self.deformable
            .as_ref()
            .is_some_and(|body| body.lies_calm())
            || free.is_some_and(|flight| flight.lies_calm())
    }

    /// It is left alone.
    pub(super) fn is_left_alone(&self) -> bool {
        let free = self.rigid.as_ref().and_then(RigidState::flight);
        self.deformable
            .as_ref()
            .is_some_and(|body| body.is_left_alone())
            || free.is_some_and(|flight| flight.is_left_alone())
    }
}

impl SceneState {
    /// Net of a body now, u-major, m; `out` is as long as the net of [`Scene::rest_surface`].
    pub fn copy_net(&self, scene: &Scene, body: usize, out: &mut [Point3]) {
        match (&scene.bodies[body].model, &self.bodies[body].deformable) {
            (BodyModel::Deforming(model), Some(deformable)) => {
                for (control, point) in out.iter_mut().enumerate() {
                    *point = deformable.positions[model.deformable.coordinate_of_control(control)];
                }
            }
            _ => {
                let rest = scene.bodies[body].surface.net().points();
                match (&scene.bodies[body].mover, &self.bodies[body].rigid) {
                    (Some(mover), Some(rigid)) => {
                        for (point, rest) in out.iter_mut().zip(rest) {
                            *point = rigid.carry(mover, rest);
                        }
                    }
                    _ => out.copy_from_slice(rest),
                }
            }
        }
    }

    /// Coordinates of a deforming body now, m: of its nodes, by [`Deformable::nodes`](crate::body::Deformable::nodes).
    pub fn coordinates(&self, body: usize) -> Option<&[Point3]> {
        let deformable = self.bodies[body].deformable.as_ref()?;
        Some(&deformable.positions)
    }

    /// Size of the largest state of this scene: contact rows and grips come and go.
    pub fn largest_size(&self) -> StateSize {
        let mut largest = self.clone();
        largest.warm.fill();
        for tool in &mut largest.tools {
            tool.link.pose.buttons |= GRAB;
            tool.grip = GripState::full();
        }
        state_size(&largest)
    }

    /// Grows with every change of that body's net.
    pub fn net_revision(&self, body: usize) -> u64 {
        self.bodies[body].revision
    }
}

impl Coded for RunState {
    /// The kind; the steps come after it.
    fn code(&self) -> u64 {
        match self {
            Self::Running => 0,
            Self::Paused { .. } => 1,
            Self::Stopping => 2,
        }
    }

    fn set_code(&mut self, code: u64) -> bool {
        *self = match code {
            0 => Self::Running,
            1 => Self::Paused { steps: 0 },
            2 => Self::Stopping,
            _ => return false,
        };
        true
    }
}

stateful!(SceneState, |this, walk| {
    let SceneState {
        tick,
        run,
        quality,
        faulted,
        bodies,
        tools,
        pairs,
        frame,
        carried,
        warm,
    } = this;
    walk.word(tick)?;
    walk.packed(
        "run state or quality",
        [(0, run), (32, quality), (40, faulted)],
    )?;
    walk.ensure(*quality <= quality::LOWEST, "quality", u64::from(*quality))?;
    if let RunState::Paused { steps } = run {
        walk.coded("step count", steps)?;
    } else {
        walk.nothing()?;
    }
    for body in bodies {
        walk.part(body)?;
    }
    for tool in tools {
        walk.part(tool)?;
    }
    for pair in pairs {
        walk.part(pair)?;
    }
    if *carried {
        walk.part(frame)?;
    }
    walk.part(warm)?;
    Ok(())
});

stateful!(BodyState, |this, walk| {
    let BodyState {
        deformable,
        revision,
        moved_m,
        phase,
        put_off,
        loads,
        rigid,
    } = this;
    walk.word(revision)?;
    walk.float(moved_m)?;
    if let Some(deformable) = deformable {
        walk.part(deformable)?;
        if !loads.is_empty() {
            walk.packed("phase of a body's step", [(0, phase), (32, put_off)])?;
            walk.triples(loads)?;
        }
    }
    if let Some(rigid) = rigid {
        walk.part(rigid)?;
    }
    Ok(())
});

stateful!(ToolState, |this, walk| {
    let ToolState {
        link,
        proxy,
        orientation,
        port,
        bounds,
        grip,
    } = this;
    walk.part(link)?;
    walk.point(proxy)?;
    walk.rotation(orientation)?;
    walk.part(port)?;
    walk.part(bounds)?;
    if link.pose.buttons & GRAB != 0 {
        walk.part(grip)
    } else {
        walk.clear(grip)
    }
});

stateful!(PairState, |this, walk| {
    let PairState {
        proxy:
            ProxyState {
                touching,
                below,
                known,
                clear_m,
                met,
                deepest_m,
                foot,
                queried,
            },
        thinned,
    } = this;
    let WarmFoot {
        u,
        v,
        budget_m,
        net_cost,
    } = foot;
    walk.packed(
        "proxy",
        [
            (0, touching),
            (1, below),
            (2, known),
            (3, met),
            (8, thinned),
        ],
    )?;
    walk.float(clear_m)?;
    walk.float(deepest_m)?;
    for value in [u, v, budget_m, net_cost] {
        walk.float(value)?;
    }
    walk.point(queried)
});
