//! From a scene file's data to the constants of a simulation.

use super::frame::FrameOf;
use super::spec::{
    BodySpec, ContactMethod, DeviceSpec, FrictionSpec, IntegratorSpec, ModelSpec, PoseSpec,
    SPHERES_RESOLUTION, SceneSpec, SurfaceSpec, ToolSpec,
};
use super::{Body, BodyModel, Device, LatticeBody, Method, Pair, Scene, Tool};
use super::{deforming, refine, shapes};
use crate::haptics::{Coupling, DeviceFigures, LinkLimits};
use crate::solve::friction::Friction;
use crate::solve::rows::Holder;
use palpate_geometry::contact::SampleGrid;
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3};
use palpate_geometry::surface::{self, Surface};
use std::path::Path;

/// Why a scene could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct SceneError {
    /// Path of the key, for example `body[0].material.young_pa`.
    pub path: String,
    /// What is wrong and how to mend it.
    pub reason: String,
}

pub(super) fn error(path: impl Into<String>, reason: impl ToString) -> SceneError {
    SceneError {
        path: path.into(),
        reason: reason.to_string(),
    }
}

/// Contact samples a knot span and direction. Two were chosen between one (the force ripples by
/// several percent as a ball slides over a control point) and three (twice the rows for a change of
/// force below one percent).
pub fn default_samples_per_span() -> usize {
    2
}

impl Scene {
    /// Builds surfaces, bodies and tools; `directory` is where relative paths of the spec start.
    ///
    /// # Errors
    /// The first value that cannot be built, with its path.
    ///
    /// # Examples
    /// ```
    /// use palpate_sim::scene::{Scene, file};
    /// use std::path::Path;
    /// let text = r#"
    ///     [[body]]
    ///     id = "ball"
    ///     surface = { builtin = "sphere" }
    ///     [[tool]]
    ///     id = "pen"
    ///     shape = { point = {} }
    ///     pose = { position = [0.0, 0.0, 0.1] }
    /// "#;
    /// let loaded = file::parse(text, "scene.toml", Path::new("."))?;
    /// let scene = Scene::build(&loaded.spec, Path::new("."))?;
    /// assert_eq!((scene.body_count(), scene.tool_count()), (1, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn build(spec: &SceneSpec, directory: &Path) -> Result<Self, SceneError> {
        let dt_s = 1.0 / f64::from(spec.loop_.rate_hz);
        let mut bodies = Vec::new();
        for (b, body) in spec.bodies.iter().enumerate() {
            bodies.push(build_body(
                spec,
                body,
                &format!("body[{b}]"),
                directory,
                dt_s,
            )?);
        }
        let mut tools = Vec::new();
        for (t, tool) in spec.tools.iter().enumerate() {
            tools.push(build_tool(tool, &format!("tool[{t}]"), directory, dt_s)?);
        }
        let frame = frame(spec, &tools)?;
        let pairs = build_pairs(spec, &tools, &bodies, frame.as_ref())?;
        for pair in &pairs {
            let Some(tool) = pair.tool() else { continue };
            let rigid_body = matches!(bodies[pair.body].model, BodyModel::Rigid);
            if rigid_body && tools[tool].coupling.is_rigid() {
                return Err(error(
                    format!("tool[{tool}].coupling.stiffness_n_m"),
                    format!(
                        "a rigid coupling against the rigid body {:?} has no finite force; give it a stiffness",
                        bodies[pair.body].id
                    ),
                ));
            }
        }
        let name = spec.name.clone().unwrap_or_else(|| "scene".into());
        Ok(Self {
            name,
            dt_s,
            clock: spec.loop_.clock,
            spec: spec.clone(),
            bodies,
            tools,
            pairs,
            frame,
        })
    }
}

/// The same scene with every surface file written out in place: what a recording carries, so that
/// its replay needs no file.
///
/// # Errors
/// A surface file that cannot be read or parsed.
pub fn inline_files(spec: &SceneSpec, directory: &Path) -> Result<SceneSpec, SceneError> {
    let mut inlined = spec.clone();
    for (b, body) in inlined.bodies.iter_mut().enumerate() {
        inline_surface(&mut body.surface, &format!("body[{b}].surface"), directory)?;
    }
    for (t, tool) in inlined.tools.iter_mut().enumerate() {
        shapes::inline(&mut tool.shape, &format!("tool[{t}].shape"), directory)?;
    }
    Ok(inlined)
}

pub(super) fn inline_surface(
    surface: &mut SurfaceSpec,
    path: &str,
    directory: &Path,
) -> Result<(), SceneError> {
    let Some(file) = surface.file.take() else {
        return Ok(());
    };
    let path = format!("{path}.file");
    let full = directory.join(file);
    let text = std::fs::read_to_string(&full)
        .map_err(|e| error(&path, format!("cannot read {}: {e}", full.display())))?;
    let mut document: serde_json::Value =
        serde_json::from_str(&text).map_err(|e| error(&path, e))?;
    // TOML, as which recordings keep the scene, has no null; absent says the same.
    if let Some(fields) = document.as_object_mut() {
        fields.retain(|_, value| !value.is_null());
    }
    surface.inline = Some(document);
    Ok(())
}

/// The tool in whose frame the bodies are, if the scene names one.
fn frame(spec: &SceneSpec, tools: &[Tool]) -> Result<Option<FrameOf>, SceneError> {
    let Some(id) = &spec.gravity.frame else {
        return Ok(None);
    };
    let Some(tool) = tools.iter().position(|tool| &tool.id == id) else {
        return Err(error(
            "gravity.frame",
            format!("there is no tool {id:?} in this scene"),
        ));
    };
    if let Some(b) = spec
        .bodies
        .iter()
        .position(|body| body.model != ModelSpec::Rigid && body.integrator.every > 1)
    {
        let reason = "a body in a carried frame steps every tick: what it feels changes with each; use every = 1";
        return Err(error(format!("body[{b}].integrator.every"), reason));
    }
    Ok(Some(FrameOf {
        tool,
        smoothing_s: spec.gravity.smoothing_s,
    }))
}

/// Every tool against every body, bodies that deform against all others, and those that may touch
/// themselves; exceptions as the scene lists them.
fn build_pairs(
    spec: &SceneSpec,
    tools: &[Tool],
    bodies: &[Body],
    frame: Option<&FrameOf>,
) -> Result<Vec<Pair>, SceneError> {
    let mut pairs = Vec::new();
    let index = |k: usize| k as u32;
    let deforms = |body: usize| !matches!(bodies[body].model, BodyModel::Rigid);
    // The tool that carries the frame moves all bodies alike and touches none.
    for tool in (0..tools.len()).filter(|&tool| frame.is_none_or(|frame| frame.tool != tool)) {
        let holder = Holder::Tool(index(tool));
        let friction = friction(spec.tools[tool].friction.as_ref(), || {
            format!("tool[{tool}].friction")
        })?;
        pairs.extend((0..bodies.len()).map(|body| Pair {
            holder,
            body,
            method: Method::Exact,
            friction,
        }));
    }
    for body in 0..bodies.len() {
        for other in body + 1..bodies.len() {
            if deforms(body) || deforms(other) {
                // A sheet has no inside: it is asked for the side on which the other is.
                let sheet_second = bodies[other].two_sided && !bodies[body].two_sided;
                let (body, other) = if sheet_second {
                    (other, body)
                } else {
                    (body, other)
                };
                let holder = Holder::Body(index(other));
                pairs.push(Pair {
                    holder,
                    body,
                    method: Method::Exact,
                    friction: None,
                });
            }
        }
    }
    for body in 0..bodies.len() {
        if spec.bodies[body].self_contact && deforms(body) {
            let holder = Holder::Body(index(body));
            pairs.push(Pair {
                holder,
                body,
                method: Method::Exact,
                friction: None,
            });
        }
    }
    for (c, contact) in spec.contacts.iter().enumerate() {
        let [holder_id, body_id] = &contact.pair;
        let tool = tools
            .iter()
            .position(|tool| &tool.id == holder_id)
            .map(|tool| Holder::Tool(index(tool)));
        let find = |id: &str| bodies.iter().position(|body| body.id == id);
        let holder = tool.or_else(|| find(holder_id).map(|body| Holder::Body(index(body))));
        let (Some(holder), Some(body)) = (holder, find(body_id)) else {
            return Err(error(
                format!("contact[{c}].pair"),
                format!("no tool or body {holder_id:?} or no body {body_id:?} in this scene"),
            ));
        };
        let named = |pair: &Pair| {
            let swapped = match holder {
                Holder::Body(other) => {
                    pair.holder == Holder::Body(index(body)) && pair.body == other as usize
                }
                Holder::Tool(_) => false,
            };
            (pair.holder == holder && pair.body == body) || swapped
        };
        if contact.friction.is_some() {
            let friction = friction(contact.friction.as_ref(), || {
                format!("contact[{c}].friction")
            })?;
            pairs
                .iter_mut()
                .filter(|pair| named(pair))
                .for_each(|pair| pair.friction = friction);
        }
        match contact.method {
            ContactMethod::Exact => {}
            ContactMethod::None => pairs.retain(|pair| !named(pair)),
            ContactMethod::Spheres => {
                let other = match holder {
                    Holder::Body(other) => bodies[other as usize].surface.joints().is_some(),
                    Holder::Tool(_) => false,
                };
                if other || bodies[body].surface.joints().is_some() {
                    let reason = "a surface in joined pieces has no \"spheres\" contact; use method = \"exact\"";
                    return Err(error(format!("contact[{c}].method"), reason));
                }
                let resolution = contact.resolution.unwrap_or(SPHERES_RESOLUTION);
                for pair in pairs.iter_mut().filter(|pair| named(pair)) {
                    pair.method = Method::Spheres(resolution);
                }
            }
        }
    }
    Ok(pairs)
}

/// Without friction a pair has none, rather than a coefficient of zero: it is then solved as such.
fn friction(
    spec: Option<&FrictionSpec>,
    path: impl Fn() -> String,
) -> Result<Option<Friction>, SceneError> {
    let Some(&FrictionSpec {
        mu,
        mu_kinetic,
        viscous_n_s_m,
    }) = spec
    else {
        return Ok(None);
    };
    let mu_kinetic = mu_kinetic.unwrap_or(mu);
    if !(mu.is_finite() && (0.0..=mu).contains(&mu_kinetic)) {
        return Err(error(
            path(),
            "mu must be 0 or more and mu_kinetic at most mu",
        ));
    }
    if !(viscous_n_s_m.is_finite() && viscous_n_s_m >= 0.0) {
        return Err(error(path(), "viscous_n_s_m must be 0 or more"));
    }
    Ok((mu > 0.0 || viscous_n_s_m > 0.0).then_some(Friction {
        mu,
        mu_kinetic,
        viscous_n_s_m,
    }))
}

fn build_tool(
    spec: &ToolSpec,
    path: &str,
    directory: &Path,
    dt_s: f64,
) -> Result<Tool, SceneError> {
    let shape = shapes::build(&spec.shape, &format!("{path}.shape"), directory)?;
    let coupling = &spec.coupling;
    if !(coupling.stiffness_n_m > 0.0
        && coupling.damping_n_s_m >= 0.0
        && coupling.damping_n_s_m.is_finite())
    {
        return Err(error(
            format!("{path}.coupling"),
            "stiffness_n_m must be above 0 and damping_n_s_m at least 0",
        ));
    }
    let (turning, damping) = (
        coupling.turning_stiffness_nm_rad,
        coupling.turning_damping_nm_s_rad,
    );
    if !(turning > 0.0 && damping >= 0.0 && damping.is_finite()) {
        let reason =
            "turning_stiffness_nm_rad must be above 0 and turning_damping_nm_s_rad at least 0";
        return Err(error(format!("{path}.coupling"), reason));
    }
    let grip_n = spec.grip.force_max_n;
    if !(grip_n.is_finite() && grip_n >= 0.0) {
        return Err(error(
            format!("{path}.grip.force_max_n"),
            "a grip holds with 0 N or more",
        ));
    }
    let pose = pose(&spec.pose, &format!("{path}.pose"))?;
    let (device, limits) = build_device(&spec.device, coupling.bounded, dt_s);
    let mut stiffness_n_m = coupling.stiffness_n_m;
    if coupling.bounded && spec.device.damping_n_s_m.is_some() {
        let most = device
            .figures
            .stiffness_limits(coupling.damping_n_s_m)
            .passive_n_m();
        if most == 0.0 {
            let reason = "a bounded coupling needs a device with more damping than its own, and with dry friction if it has \
                          an encoder: give damping_n_s_m, coulomb_n and encoder_m of [tool.device], or drop bounded";
            return Err(error(format!("{path}.coupling.bounded"), reason));
        }
        stiffness_n_m = stiffness_n_m.min(most);
    }
    let mut built = Coupling::new(stiffness_n_m, coupling.damping_n_s_m, dt_s);
    if shape.ball_radius_m().is_none() {
        built = built.turning(
            coupling.turning_stiffness_nm_rad,
            coupling.turning_damping_nm_s_rad,
        );
    }
    let start = (Point3::from(pose.translation.vector), pose.rotation);
    Ok(Tool {
        id: spec.id.clone(),
        shape,
        start,
        coupling: built,
        limits,
        device,
        grip_n,
    })
}

fn build_device(spec: &DeviceSpec, bounded: bool, dt_s: f64) -> (Device, LinkLimits) {
    let limits = LinkLimits {
        force_max_n: spec.force_max_n,
        ramp_n: if spec.ramp_s > 0.0 {
            spec.force_max_n * dt_s / spec.ramp_s
        } else {
            spec.force_max_n
        },
        stale_ticks: (spec.stale_s / dt_s).ceil() as u32,
        stride_max_m: spec.speed_max_m_s * dt_s,
    };
    let figures = DeviceFigures {
        damping_n_s_m: spec.damping_n_s_m.unwrap_or(0.0),
        coulomb_n: spec.coulomb_n,
        encoder_m: spec.encoder_m,
        period_s: spec.rate_hz.map_or(dt_s, |rate| dt_s.max(1.0 / rate)),
        delay_s: spec.delay_s,
    };
    let passivity_damping_n_s_m = spec.passivity.then_some(spec.passivity_damping_n_s_m);
    let known = spec.damping_n_s_m.is_some();
    (
        Device {
            torque_max_nm: spec.torque_max_nm,
            passivity_damping_n_s_m,
            bounded,
            figures,
            known,
        },
        limits,
    )
}

pub(super) fn unit(normal: &[f64; 3], path: &str) -> Result<Vector3, SceneError> {
    Vector3::from(*normal)
        .try_normalize(0.0)
        .filter(|n| n.iter().all(|x| x.is_finite()))
        .ok_or_else(|| error(path, format!("{normal:?} has no direction")))
}

pub(super) fn pose(spec: &PoseSpec, path: &str) -> Result<Pose, SceneError> {
    let [x, y, z, w] = spec.orientation;
    let quaternion = nalgebra::Quaternion::new(w, x, y, z);
    if (quaternion.norm() - 1.0).abs() > 1e-6 || !spec.position.iter().all(|x| x.is_finite()) {
        return Err(error(
            path,
            "position must be finite and orientation a unit quaternion x y z w",
        ));
    }
    Ok(Pose::from_parts(
        Vector3::from(spec.position).into(),
        Rotation::from_quaternion(quaternion),
    ))
}

pub(super) fn build_surface(
    spec: &SurfaceSpec,
    path: &str,
    directory: &Path,
) -> Result<Surface, SceneError> {
    match (&spec.builtin, &spec.file, &spec.inline) {
        (Some(name), None, None) => surface::builtin(name, spec.net, spec.size)
            .map_err(|e| error(format!("{path}.builtin"), e)),
        (None, Some(file), None) => {
            let full = directory.join(file);
            let text = std::fs::read_to_string(&full).map_err(|e| {
                error(
                    format!("{path}.file"),
                    format!("cannot read {}: {e}", full.display()),
                )
            })?;
            surface::file::read(&text)
                .map_err(|e| error(format!("{path}.file"), format!("{}: {e}", full.display())))
        }
        (None, None, Some(value)) => {
            surface::file::from_value(value).map_err(|e| error(format!("{path}.inline"), e))
        }
        _ => Err(error(path, "give exactly one of builtin, file, inline")),
    }
}

fn build_body(
    scene: &SceneSpec,
    spec: &BodySpec,
    path: &str,
    directory: &Path,
    dt_s: f64,
) -> Result<Body, SceneError> {
    let placement = pose(&spec.pose, &format!("{path}.pose"))?;
    let original = build_surface(&spec.surface, &format!("{path}.surface"), directory)?
        .oriented_outward()
        .transformed(&placement);
    // Copies of a branching surface move together, so they start equal bit for bit.
    let original = if original.joints().is_some() {
        original.with_exact_seams()
    } else {
        original
    };
    let original_net = [original.net().rows(), original.net().columns()];
    let topology = original.topology();
    let two_sided = !topology.is_closed();
    let size_m = original.size();
    let (surface, model) = match spec.model {
        ModelSpec::Rigid => (original, BodyModel::Rigid),
        ModelSpec::Membrane | ModelSpec::Lattice | ModelSpec::Continuum | ModelSpec::Net => {
            let parted = [original.knots_u(), original.knots_v()]
                .iter()
                .any(|knots| !knots.disjoined().is_empty());
            if parted && original.joints().is_none() {
                let reason = "the knots of this surface part it: to deform, it must be clamped in both directions and have at \
                              most 1024 patches; or use model = \"rigid\"";
                return Err(error(format!("{path}.surface"), reason));
            }
            let surface = refine::refine(scene, spec, path, original)?;
            let (lattice, choice) =
                deforming::build(scene, spec, path, &surface, &placement, dt_s)?;
            let samples = SampleGrid::new(&surface, default_samples_per_span());
            let IntegratorSpec {
                contact_sweeps: sweeps,
                every,
                ..
            } = spec.integrator;
            (
                surface,
                BodyModel::Lattice(Box::new(LatticeBody {
                    lattice,
                    samples,
                    sweeps,
                    every,
                    choice,
                })),
            )
        }
    };
    Ok(Body {
        id: spec.id.clone(),
        surface,
        original_net,
        size_m,
        two_sided,
        model,
    })
}
