//! What a replay restores.

use super::FrameState;
use super::{BodyModel, Scene, quality};
use crate::body::{DeformableState, Field};
use crate::haptics::{DeviceBounds, Link, Port};
use crate::solve::friction::Stick;
use crate::solve::grip::{GRAB, GripState};
use crate::solve::proxy::ProxyState;
use crate::solve::row_key::{RowId, RowKey};
use palpate_geometry::math::{
    Point3, Rotation, StateError, StateSink, StateSource, Stateful, Vector3,
};
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
    /// (rows of a tick at most, [`Scene::most_rows`]): contact forces of the last tick, the
    /// solver's warm start; `warm_len` are valid.
    pub warm: Vec<WarmRow>,
    /// Valid entries of `warm`.
    pub warm_len: usize,
    /// Some of them had friction or a grip.
    pub warm_friction: bool,
    /// Some of them are of tools that may turn.
    pub warm_arms: bool,
}

/// State of a body.
#[derive(Debug, Default, PartialEq)]
pub struct BodyState {
    /// Nodes, when it deforms.
    pub lattice: Option<DeformableState>,
    /// Grows with every change of the net.
    pub revision: u64,
    /// How far the farthest control point moved in the last tick, m.
    pub moved_m: f64,
    /// Ticks since the body's step began, for bodies that step once in several ticks.
    pub phase: u32,
    /// (coordinates), N: contact forces of the tick in which that step began; empty for bodies that
    /// step every tick.
    pub loads: Vec<Vector3>,
}

/// Steps of bodies on other threads: begun with the loads of one tick, taken over some ticks later,
/// always the same number.
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
    /// What its device told it can bear.
    pub bounds: DeviceBounds,
    /// What it grabs; nothing while the button is up.
    pub grip: GripState,
}

/// State of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairState {
    /// The proxy's.
    pub proxy: ProxyState,
}

/// A contact force to start from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WarmRow {
    /// Which row of the last tick it was.
    pub id: RowId,
    /// Where it is on the body; kept for feet, which have no sample to say so.
    pub uv: [f64; 2],
    /// Along the normal, N.
    pub force_n: f64,
    /// Across it, N.
    pub tangent_n: Vector3,
    /// Where it sticks, unless it slips.
    pub stick: Stick,
    /// It slipped.
    pub slips: bool,
    /// Where on a tool that may turn, from its reference point in its frame, m.
    pub on_tool: Vector3,
}

impl Scene {
    /// The state at the start.
    pub fn initial_state(&self) -> SceneState {
        let bodies = self.bodies.iter().map(|body| match &body.model {
            BodyModel::Rigid => BodyState {
                lattice: None,
                revision: 0,
                moved_m: 0.0,
                phase: 0,
                loads: Vec::new(),
            },
            BodyModel::Lattice(model) => BodyState {
                lattice: Some(model.lattice.rest_state()),
                revision: 0,
                moved_m: 0.0,
                phase: 0,
                loads: vec![
                    Vector3::zeros();
                    if model.every > 1 {
                        model.lattice.coordinate_count()
                    } else {
                        0
                    }
                ],
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
            bodies: bodies.collect(),
            tools: tools.collect(),
            pairs: vec![PairState::default(); self.pairs.len()],
            frame: FrameState::default(),
            carried: self.frame.is_some(),
            warm: vec![WarmRow::default(); self.most_rows()],
            warm_len: 0,
            warm_friction: false,
            warm_arms: false,
        }
    }
}

impl Clone for SceneState {
    fn clone(&self) -> Self {
        let mut copy = Self {
            tick: 0,
            run: RunState::Running,
            quality: 0,
            bodies: Vec::new(),
            tools: Vec::new(),
            pairs: Vec::new(),
            frame: FrameState::default(),
            carried: false,
            warm: Vec::new(),
            warm_len: 0,
            warm_friction: false,
            warm_arms: false,
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
            bodies,
            tools,
            pairs,
            frame,
            carried,
            warm,
            warm_len,
            warm_friction,
            warm_arms,
        } = self;
        (*tick, *run, *quality) = (from.tick, from.run, from.quality);
        bodies.clone_from(&from.bodies);
        tools.clone_from(&from.tools);
        pairs.clone_from(&from.pairs);
        (*frame, *carried) = (from.frame, from.carried);
        warm.clone_from(&from.warm);
        (*warm_len, *warm_friction, *warm_arms) =
            (from.warm_len, from.warm_friction, from.warm_arms);
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
            lattice,
            revision,
            moved_m,
            phase,
            loads,
        } = self;
        // `Option` hands its value's own `clone_from` on.
        lattice.clone_from(&from.lattice);
        (*revision, *moved_m, *phase) = (from.revision, from.moved_m, from.phase);
        loads.clone_from(&from.loads);
    }
}

impl SceneState {
    /// Net of a body now, u-major, m; `out` is as long as the net of [`Scene::rest_surface`].
    pub fn copy_net(&self, scene: &Scene, body: usize, out: &mut [Point3]) {
        match (&scene.bodies[body].model, &self.bodies[body].lattice) {
            (BodyModel::Lattice(model), Some(lattice)) => {
                for (control, point) in out.iter_mut().enumerate() {
                    *point = lattice.positions[model.lattice.coordinate_of_control(control)];
                }
            }
            _ => out.copy_from_slice(scene.bodies[body].surface.net().points()),
        }
    }

    /// Grows with every change of that body's net.
    pub fn net_revision(&self, body: usize) -> u64 {
        self.bodies[body].revision
    }
}

impl Stateful for SceneState {
    fn save(&self, sink: &mut impl StateSink) {
        sink.word(self.tick);
        let (run, steps) = match self.run {
            RunState::Running => (0, 0),
            RunState::Paused { steps } => (1, steps),
            RunState::Stopping => (2, 0),
        };
        sink.word(run | u64::from(self.quality) << 32);
        sink.word(u64::from(steps));
        for body in &self.bodies {
            sink.word(body.revision);
            sink.floats(&[body.moved_m]);
            if let Some(lattice) = &body.lattice {
                lattice.save(sink);
                if !body.loads.is_empty() {
                    sink.word(u64::from(body.phase));
                    body.loads
                        .iter()
                        .for_each(|load| sink.floats(load.as_slice()));
                }
            }
        }
        for tool in &self.tools {
            tool.link.save(sink);
            sink.floats(tool.proxy.coords.as_slice());
            sink.floats(tool.orientation.coords.as_slice());
            tool.port.save(sink);
            tool.bounds.save(sink);
            if tool.link.pose.buttons & GRAB != 0 {
                tool.grip.save(sink);
            }
        }
        for PairState { proxy } in &self.pairs {
            sink.word(u64::from(proxy.touching) | u64::from(proxy.below) << 1);
            sink.floats(&[
                proxy.foot.u,
                proxy.foot.v,
                proxy.foot.budget_m,
                proxy.foot.net_cost,
            ]);
            sink.floats(proxy.queried.coords.as_slice());
        }
        if self.carried {
            self.frame.save(sink);
        }
        sink.word(
            self.warm_len as u64
                | u64::from(self.warm_friction) << 32
                | u64::from(self.warm_arms) << 33,
        );
        for row in &self.warm[..self.warm_len] {
            sink.word(u64::from(row.id.pair));
            sink.word(u64::from(row.id.key.to_bits()));
            sink.floats(&[row.force_n]);
            if row.id.key.is_foot() {
                sink.floats(&row.uv);
            }
            if self.warm_arms {
                sink.floats(row.on_tool.as_slice());
            }
            if self.warm_friction {
                sink.word(u64::from(row.slips));
                sink.floats(row.tangent_n.as_slice());
                sink.floats(&[row.stick.u, row.stick.v]);
                sink.floats(row.stick.offset.as_slice());
            }
        }
    }

    fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError> {
        let small =
            |value: u64, what| u32::try_from(value).map_err(|_| StateError::Value { what, value });
        self.tick = source.word()?;
        let (head, steps) = (source.word()?, source.word()?);
        self.quality = match u8::try_from(head >> 32) {
            Ok(level) if level <= quality::LOWEST => level,
            _ => {
                return Err(StateError::Value {
                    what: "quality",
                    value: head >> 32,
                });
            }
        };
        self.run = match head & u64::from(u32::MAX) {
            0 => RunState::Running,
            1 => RunState::Paused {
                steps: small(steps, "step count")?,
            },
            2 => RunState::Stopping,
            value => {
                return Err(StateError::Value {
                    what: "run state",
                    value,
                });
            }
        };
        for body in &mut self.bodies {
            body.revision = source.word()?;
            body.moved_m = float(source)?;
            if let Some(lattice) = &mut body.lattice {
                lattice.restore(source)?;
                if !body.loads.is_empty() {
                    body.phase = small(source.word()?, "phase of a body's step")?;
                    for load in &mut body.loads {
                        source.floats(load.as_mut_slice())?;
                    }
                }
            }
        }
        for tool in &mut self.tools {
            tool.link.restore(source)?;
            source.floats(tool.proxy.coords.as_mut_slice())?;
            let mut quaternion = [0.0; 4];
            source.floats(&mut quaternion)?;
            // Taken as saved: normalising again would change the last bit.
            tool.orientation = Rotation::new_unchecked(nalgebra::Quaternion::from(
                nalgebra::Vector4::from(quaternion),
            ));
            tool.port.restore(source)?;
            tool.bounds.restore(source)?;
            tool.grip = GripState::default();
            if tool.link.pose.buttons & GRAB != 0 {
                tool.grip.restore(source)?;
            }
        }
        for PairState { proxy } in &mut self.pairs {
            let flags = source.word()?;
            (proxy.touching, proxy.below) = (flags & 1 != 0, flags & 2 != 0);
            let mut foot = [0.0; 4];
            source.floats(&mut foot)?;
            let [u, v, budget_m, net_cost] = foot;
            proxy.foot = WarmFoot {
                u,
                v,
                budget_m,
                net_cost,
            };
            source.floats(proxy.queried.coords.as_mut_slice())?;
        }
        if self.carried {
            self.frame.restore(source)?;
        }
        let head = source.word()?;
        let (warm_len, kinds) = (head & u64::from(u32::MAX), head >> 32);
        if warm_len > self.warm.len() as u64 || kinds > 3 {
            return Err(StateError::Value {
                what: "number of contact rows",
                value: head,
            });
        }
        (self.warm_len, self.warm_friction, self.warm_arms) =
            (warm_len as usize, kinds & 1 != 0, kinds & 2 != 0);
        for row in &mut self.warm[..self.warm_len] {
            *row = WarmRow::default();
            row.id.pair = small(source.word()?, "pair of a contact row")?;
            let bits = source.word()?;
            let key = u32::try_from(bits).ok().and_then(RowKey::from_bits);
            row.id.key = key.ok_or(StateError::Value {
                what: "key of a contact row",
                value: bits,
            })?;
            row.force_n = float(source)?;
            if row.id.key.is_foot() {
                source.floats(&mut row.uv)?;
            }
            if self.warm_arms {
                source.floats(row.on_tool.as_mut_slice())?;
            }
            if self.warm_friction {
                row.slips = source.word()? != 0;
                source.floats(row.tangent_n.as_mut_slice())?;
                (row.stick.u, row.stick.v) = (float(source)?, float(source)?);
                source.floats(row.stick.offset.as_mut_slice())?;
            }
        }
        Ok(())
    }
}

fn float(source: &mut impl StateSource) -> Result<f64, StateError> {
    let mut value = [0.0];
    source.floats(&mut value)?;
    Ok(value[0])
}
