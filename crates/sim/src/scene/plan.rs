//! The compiled plan: what a tick of this scene does and holds, and nothing else.

use super::{BodyModel, DeformingBody, Pair, Scene};
use crate::body::Deformable;
use crate::solve::rows::Holder;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::dispatch::Method;
use serde::Serialize;
use std::fmt;

/// What a scene compiled to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Scene name.
    pub scene: String,
    /// Length of a tick, s.
    pub dt_s: f64,
    /// Bodies.
    pub bodies: Vec<BodyPlan>,
    /// Tools.
    pub tools: Vec<ToolPlan>,
    /// Pairs that are tested.
    pub pairs: Vec<PairPlan>,
    /// Stages of a tick, in order.
    pub stages: Vec<StagePlan>,
    /// Buffers, with their bytes.
    pub buffers: Vec<BufferPlan>,
}

/// A body of the plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodyPlan {
    /// Id.
    pub id: String,
    /// `rigid`, `membrane`, `lattice` …
    pub model: &'static str,
    /// Net as given.
    pub net: [usize; 2],
    /// Net as simulated and published.
    pub simulated_net: [usize; 2],
    /// Of a part, which has no net.
    pub faces: Option<usize>,
    /// Of a body that deforms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deformable: Option<DeformingPlan>,
    /// Of a rigid body that contact and gravity move.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free: Option<FreePlan>,
}

/// A free rigid body of the plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FreePlan {
    /// kg.
    pub mass_kg: f64,
    /// Centre of mass at the start, m.
    pub centre_m: [f64; 3],
    /// Principal moments of inertia about it, kg·m².
    pub moments_kg_m2: [f64; 3],
}

/// A deforming body of the plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeformingPlan {
    /// Nodes that carry the law.
    pub nodes: usize,
    /// Coordinates that can move.
    pub free_nodes: usize,
    /// `implicit`, `explicit`, `xpbd`.
    pub method: &'static str,
    /// Iterations or substeps of a step.
    pub passes: usize,
    /// Matrix of an implicit step: `tangent` or `bounding`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matrix: Option<&'static str>,
    /// Of an implicit step: how far the body is from the converged step a tenth of a second after a
    /// blow, rms over that time, relative to its motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion_error: Option<f64>,
    /// Why this method.
    pub why: String,
    /// The body steps once in so many ticks.
    pub every: u32,
    /// A step as it is predicted, µs.
    pub step_us: f64,
    /// Where a step is predicted to take longer than that: once in how many ticks it could be done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fitting_every: Option<u32>,
    /// Springs.
    pub springs: usize,
    /// Non-zeros of the factor.
    pub factor_non_zeros: usize,
    /// Contact samples.
    pub samples: usize,
    /// kg.
    pub mass_kg: f64,
    /// Smallest cell, m³.
    pub least_cell_m3: f64,
    /// Shortest and longest edge, m.
    pub edge_m: [f64; 2],
}

impl DeformingPlan {
    /// That a step takes longer than the ticks it has, if it does, and what would help.
    pub fn too_slow(&self) -> Option<String> {
        Some(too_slow(self.step_us, self.every, self.fitting_every?))
    }
}

/// That a step takes longer than the ticks it has, and what would help.
fn too_slow(step_us: f64, every: u32, fitting_every: u32) -> String {
    let ticks = match every {
        1 => "a tick".to_owned(),
        every => format!("its {every} ticks"),
    };
    format!(
        "a step is predicted to take {:.1} ms, longer than {ticks}: `every = {fitting_every}` would fit, or fewer nodes",
        step_us * 1e-3
    )
}

/// [`DeformingPlan::too_slow`] of a body, without the rest of its plan.
pub(super) fn slow_step(body: &DeformingBody, dt_s: f64) -> Option<String> {
    let step_us = step_us(&body.deformable);
    let fitting = fitting_every(step_us, body.every, dt_s)?;
    Some(too_slow(step_us, body.every, fitting))
}

/// A tool of the plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToolPlan {
    /// Id.
    pub id: String,
    /// Shape name.
    pub shape: &'static str,
    /// Greatest force, N.
    pub force_max_n: f64,
    /// Stiffness of its coupling, N/m; `None`: rigid.
    pub stiffness_n_m: Option<f64>,
    /// The same for rotation, N·m/rad; `None`: turned as its device is.
    pub turning_stiffness_nm_rad: Option<f64>,
    /// The stiffest that its device holds in any hand, N/m, where the scene describes the device.
    pub passive_n_m: Option<f64>,
}

/// A pair of the plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PairPlan {
    /// Id of the tool, or of the body that holds.
    pub tool: String,
    /// Body id.
    pub body: String,
    /// What is done for it.
    pub method: String,
}

/// A stage of a tick with its predicted cost on one core of a current machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StagePlan {
    /// `render` or `deform`, and of what.
    pub stage: String,
    /// Predicted from operation counts, µs.
    pub predicted_us: f64,
    /// Measured median over a dry run, µs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured_us: Option<f64>,
}

/// A buffer of the plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BufferPlan {
    /// What it holds.
    pub name: String,
    /// Bytes.
    pub bytes: usize,
}

/// Cost of one spring of the force pass and of one non-zero of a solve with three right-hand sides,
/// µs: medians on a 3 GHz x86-64 core.
const SPRING_US: f64 = 0.003;
const NON_ZERO_US: f64 = 0.0022;
/// One non-zero of a large scalar factor in single precision, µs.
const SINGLE_US: f64 = 0.0014;
/// One number of a factor in blocks, read twice by a solve, µs.
const BLOCK_NUMBER_US: f64 = 0.0004;
/// One cell of the continuum's pass, µs.
const CELL_US: f64 = 0.15;
/// Contacts of a pair in touch, µs: medians of `palpate bench contact`.
fn query_us(scene: &Scene, pair: &Pair) -> f64 {
    let two_surfaces = 300.0;
    let exact = match pair.holder {
        Holder::Body(_) => two_surfaces,
        Holder::Tool(t) => match &scene.tools[t as usize].shape {
            ToolShape::Point | ToolShape::Sphere { .. } => 10.0,
            ToolShape::Plane { .. } => 15.0,
            ToolShape::Implicit { .. } => 250.0,
            ToolShape::Mesh(_) => 2_000.0,
            ToolShape::Surface(_) => two_surfaces,
        },
    };
    match pair.method {
        Method::Exact => exact,
        Method::Other(method, points) => (method.query_us)(points, exact == two_surfaces),
    }
}

/// Of the ticks that a step on its own thread has: what it should take at most.
const STEP_SHARE: f64 = 0.8;

/// Once in how many ticks of `dt_s` a step of `step_us` can be done; `None` if `every` is enough.
fn fitting_every(step_us: f64, every: u32, dt_s: f64) -> Option<u32> {
    let ticks = step_us * 1e-6 / dt_s;
    (ticks > f64::from(every)).then(|| (ticks / STEP_SHARE).ceil() as u32)
}

/// One pass over a body's springs and cells, µs.
fn pass_us(body: &Deformable) -> f64 {
    body.spring_count() as f64 * SPRING_US + body.cell_count() as f64 * CELL_US
}

/// A body's step, µs: passes and solves.
pub(super) fn step_us(body: &Deformable) -> f64 {
    match body.integration() {
        ("implicit", iterations) => {
            let number_us = match body.step_matrix() {
                Some("tangent") => BLOCK_NUMBER_US,
                _ if body.factor_bits() == 32 => SINGLE_US,
                _ => NON_ZERO_US,
            };
            (pass_us(body) + body.factor_non_zeros() as f64 * number_us) * iterations as f64
        }
        // Without and with contact.
        (_, substeps) => 2.0 * pass_us(body) * substeps as f64,
    }
}

/// A held body bends by less than this share of its size.
const BENDS: f64 = 0.5;

impl Scene {
    /// What a tick in contact is predicted to take, µs: every tool touches the one body that costs most, and
    /// bodies touch where something brings them together or they stand close.
    pub fn predicted_tick_us(&self) -> f64 {
        let mut of_tools = vec![0.0_f64; self.tools.len()];
        let mut sum_us: f64 = 0.0;
        for pair in &self.pairs {
            let query_us = query_us(self, pair);
            match pair.holder {
                Holder::Tool(tool) => {
                    let most_us = &mut of_tools[tool as usize];
                    *most_us = most_us.max(query_us);
                }
                Holder::Body(other) if self.can_meet(other as usize, pair.body) => {
                    sum_us += query_us
                }
                Holder::Body(_) => {}
            }
        }
        for body in &self.bodies {
            if let BodyModel::Deforming(model) = &body.model {
                sum_us += step_us(&model.deformable) / f64::from(model.every);
            }
        }
        sum_us + of_tools.iter().sum::<f64>()
    }

    /// What a body's step in a tick is predicted to take, µs; 0 of what does not deform, or steps elsewhere.
    pub(crate) fn step_us(&self, body: usize) -> f64 {
        match &self.bodies[body].model {
            BodyModel::Deforming(model) if model.every == 1 => step_us(&model.deformable),
            _ => 0.0,
        }
    }

    fn can_meet(&self, a: usize, b: usize) -> bool {
        let moves =
            |body: usize| self.bodies[body].mover.is_some() || self.free_mass_kg(body).is_some();
        if a == b || moves(a) || moves(b) {
            return true;
        }
        let bounds = |body: usize| {
            let points = self.bodies[body].skin.points();
            let first = (points[0], points[0]);
            (points.iter()).fold(first, |(low, high), p| (low.inf(p), high.sup(p)))
        };
        let ((a_low, a_high), (b_low, b_high)) = (bounds(a), bounds(b));
        let most_m = BENDS * self.bodies[a].size_m.min(self.bodies[b].size_m);
        (0..3).all(|c| (a_low[c] - b_high[c]).max(b_low[c] - a_high[c]) < most_m)
    }

    /// The plan this scene compiled to.
    pub fn plan(&self) -> Plan {
        let mut stages = Vec::new();
        let mut buffers = Vec::new();
        for pair in &self.pairs {
            let stage = format!(
                "render {} on {}",
                self.holder_id(pair),
                self.bodies[pair.body].id
            );
            stages.push(StagePlan {
                stage,
                predicted_us: query_us(self, pair),
                measured_us: None,
            });
        }
        if !self.pairs.is_empty() {
            let bytes = self.most_rows().pow(2) * size_of::<f64>();
            buffers.push(BufferPlan {
                name: "contact problem".into(),
                bytes,
            });
        }
        for body in &self.bodies {
            if let BodyModel::Deforming(model) = &body.model {
                let deformable = &model.deformable;
                stages.push(StagePlan {
                    stage: format!("deform {}", body.id),
                    predicted_us: step_us(deformable) / f64::from(model.every),
                    measured_us: None,
                });
                buffers.push(BufferPlan {
                    name: format!("{} nodes", body.id),
                    bytes: deformable.coordinate_count() * 6 * size_of::<f64>(),
                });
                buffers.push(BufferPlan {
                    name: format!("{} factor", body.id),
                    bytes: deformable.factor_non_zeros() * 12,
                });
                buffers.push(BufferPlan {
                    name: format!("{} surface compliance", body.id),
                    bytes: deformable.compliance_bytes(),
                });
            }
        }
        Plan {
            scene: self.name.clone(),
            dt_s: self.dt_s,
            bodies: (self.bodies.iter())
                .map(|body| body_plan(body, self.dt_s))
                .collect(),
            tools: self
                .tools
                .iter()
                .enumerate()
                .map(|(t, tool)| ToolPlan {
                    id: tool.id.clone(),
                    shape: self.shape_name(t),
                    force_max_n: tool.limits.force_max_n,
                    stiffness_n_m: finite(tool.coupling.stiffness_n_m()),
                    turning_stiffness_nm_rad: finite(tool.coupling.turning_stiffness_nm_rad()),
                    passive_n_m: self
                        .stiffness_limits_of(tool)
                        .and_then(|limits| finite(limits.passive_n_m())),
                })
                .collect(),
            pairs: self
                .pairs
                .iter()
                .map(|pair| PairPlan {
                    tool: self.holder_id(pair).to_owned(),
                    body: self.bodies[pair.body].id.clone(),
                    method: match (pair.method, &self.bodies[pair.body].model) {
                        (method, BodyModel::Rigid) => method.name().to_owned(),
                        (Method::Exact, BodyModel::Deforming(_)) => {
                            "exact feet and samples, on the body's compliance".to_owned()
                        }
                        (Method::Other(method, _), BodyModel::Deforming(_)) => {
                            format!("{} and samples, on the body's compliance", method.name)
                        }
                    },
                })
                .collect(),
            stages,
            buffers,
        }
    }
}

fn body_plan(body: &super::Body, dt_s: f64) -> BodyPlan {
    let simulated_net = (body.skin.surface()).map_or([0; 2], |surface| {
        [surface.net().rows(), surface.net().columns()]
    });
    let (model, deformable) = match &body.model {
        BodyModel::Rigid => ("rigid", None),
        BodyModel::Deforming(model) => {
            let deformable = &model.deformable;
            let quality = deformable.quality();
            let (method, passes) = deformable.integration();
            let plan = DeformingPlan {
                nodes: deformable.node_count(),
                free_nodes: deformable.unknown_count(),
                method,
                passes,
                matrix: deformable.step_matrix(),
                motion_error: deformable
                    .step_matrix()
                    .map(|_| deformable.motion_error(passes)),
                why: model.choice.why.clone(),
                every: model.every,
                step_us: step_us(deformable),
                fitting_every: fitting_every(step_us(deformable), model.every, dt_s),
                springs: deformable.spring_count(),
                factor_non_zeros: deformable.factor_non_zeros(),
                samples: model.samples.len(),
                mass_kg: deformable.mass_kg(),
                least_cell_m3: quality.least_volume_m3,
                edge_m: quality.edge_m,
            };
            (model.choice.model, Some(plan))
        }
    };
    BodyPlan {
        id: body.id.clone(),
        model,
        net: body.original_net,
        simulated_net,
        faces: (body.skin.part()).map(|placed| placed.part().faces().len()),
        deformable,
        free: body.free().map(|free| FreePlan {
            mass_kg: free.mass.mass_kg,
            centre_m: free.mass.centre.coords.into(),
            moments_kg_m2: free.mass.moments_kg_m2,
        }),
    }
}

/// JSON has no infinity.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "scene {}: one tick is {} ms",
            self.scene,
            self.dt_s * 1e3
        )?;
        for body in &self.bodies {
            write!(f, "  body {}: {}, ", body.id, body.model)?;
            let ([r, s], [a, b]) = (body.net, body.simulated_net);
            match body.faces {
                Some(faces) => writeln!(f, "a part of {faces} faces")?,
                None => writeln!(f, "net {r} x {s}, simulated {a} x {b}")?,
            }
            if let Some(free) = &body.free {
                let ([x, y, z], [a, b, c]) = (free.centre_m, free.moments_kg_m2);
                writeln!(
                    f,
                    "    free: {:.4} kg, centre ({:.2}, {:.2}, {:.2}) mm, moments {a:.3e}, {b:.3e}, {c:.3e} kg m2",
                    free.mass_kg,
                    x * 1e3,
                    y * 1e3,
                    z * 1e3
                )?;
            }
            if let Some(l) = &body.deformable {
                writeln!(
                    f,
                    "    {} nodes ({} free), {} springs, {} factor non-zeros, {} samples, {:.4} kg, edges {:.2} to {:.2} mm",
                    l.nodes,
                    l.free_nodes,
                    l.springs,
                    l.factor_non_zeros,
                    l.samples,
                    l.mass_kg,
                    l.edge_m[0] * 1e3,
                    l.edge_m[1] * 1e3
                )?;
                let each = match (l.method == "implicit", l.passes) {
                    (true, 1) => "iteration",
                    (true, _) => "iterations",
                    (false, 1) => "substep",
                    (false, _) => "substeps",
                };
                let when = match l.every {
                    1 => "every tick".to_owned(),
                    every => format!("every {every} ticks"),
                };
                writeln!(
                    f,
                    "    {} {each} a step, a step {when}; {}",
                    l.passes, l.why
                )?;
                if let Some(too_slow) = l.too_slow() {
                    writeln!(f, "    {too_slow}")?;
                }
                if let (Some(matrix), Some(error)) = (l.matrix, l.motion_error) {
                    writeln!(
                        f,
                        "    {matrix} matrix; expected motion error {:.2} % over 0.1 s after a blow",
                        error * 100.0
                    )?;
                }
            }
        }
        for tool in &self.tools {
            write!(
                f,
                "  tool {}: {}, at most {} N",
                tool.id, tool.shape, tool.force_max_n
            )?;
            match tool.stiffness_n_m {
                Some(stiffness) => write!(f, ", coupled with {stiffness} N/m")?,
                None => write!(f, ", held by its device")?,
            }
            if tool.turning_stiffness_nm_rad.is_some() {
                write!(f, ", free to turn")?;
            }
            if let Some(passive) = tool.passive_n_m {
                write!(f, " (its device holds {passive:.0} N/m in any hand)")?;
            }
            writeln!(f)?;
        }
        for pair in &self.pairs {
            writeln!(f, "  pair {} - {}: {}", pair.tool, pair.body, pair.method)?;
        }
        writeln!(
            f,
            "  {:<40} {:>13} {:>12}",
            "stage", "predicted us", "measured us"
        )?;
        for stage in &self.stages {
            let measured = stage
                .measured_us
                .map_or("-".into(), |us| format!("{us:.1}"));
            writeln!(
                f,
                "  {:<40} {:>13.1} {measured:>12}",
                stage.stage, stage.predicted_us
            )?;
        }
        for buffer in &self.buffers {
            writeln!(f, "  buffer {:<33} {:>10} bytes", buffer.name, buffer.bytes)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_longer_than_its_ticks_is_told_with_what_fits() {
        // Within its ticks, however near.
        assert_eq!(fitting_every(1_000.0, 1, 1e-3), None);
        assert_eq!(fitting_every(3_999.0, 4, 1e-3), None);
        // A fifth of the ticks is left to spare.
        assert_eq!(fitting_every(4_100.0, 4, 1e-3), Some(6));
        assert_eq!(fitting_every(4_100.0, 4, 2e-3), None);
    }
}
