//! From a scene file's data to the constants of a simulation.

use super::spec::{
    BodySpec, ContactMethod, FrictionSpec, ModelSpec, PoseSpec, SPHERES_RESOLUTION, SceneSpec, ShapeSpec, SurfaceSpec,
    ToolSpec,
};
use super::{Body, BodyModel, LatticeBody, Method, Pair, Scene, Tool};
use super::{refine, shapes};
use crate::body::layers::{self, RingEnds, Rings};
use crate::body::{CellGrid, Lattice, Material, StepSettings};
use crate::contact::SampleGrid;
use crate::contact::friction::Friction;
use crate::contact::rows::Holder;
use crate::haptics::{Coupling, LinkLimits};
use crate::math::{Point3, Pose, Rotation, Vector3};
use crate::surface::{self, Closing, Surface, Topology};
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
    SceneError { path: path.into(), reason: reason.to_string() }
}

/// Contact samples a knot span and direction. Two were chosen between one (the force ripples by several percent as a ball
/// slides over a control point) and three (twice the rows for a change of force below one percent).
pub fn default_samples_per_span() -> usize {
    2
}

impl Scene {
    /// Builds surfaces, bodies and tools; `directory` is where relative paths of the spec start.
    ///
    /// # Errors
    /// The first value that cannot be built, with its path.
    pub fn build(spec: &SceneSpec, directory: &Path) -> Result<Self, SceneError> {
        let dt_s = 1.0 / f64::from(spec.loop_.rate_hz);
        let gravity = Vector3::from(spec.gravity.acceleration);
        let mut bodies = Vec::new();
        for (b, body) in spec.bodies.iter().enumerate() {
            bodies.push(build_body(spec, body, &format!("body[{b}]"), directory, dt_s, gravity)?);
        }
        let mut tools = Vec::new();
        for (t, tool) in spec.tools.iter().enumerate() {
            tools.push(build_tool(tool, &format!("tool[{t}]"), directory, dt_s)?);
        }
        let pairs = build_pairs(spec, &tools, &bodies)?;
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
        Ok(Self { name, dt_s, clock: spec.loop_.clock, spec: spec.clone(), bodies, tools, pairs })
    }
}

/// The same scene with every surface file written out in place: what a recording carries, so that its replay needs no file.
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

pub(super) fn inline_surface(surface: &mut SurfaceSpec, path: &str, directory: &Path) -> Result<(), SceneError> {
    let Some(file) = surface.file.take() else { return Ok(()) };
    let path = format!("{path}.file");
    let full = directory.join(file);
    let text =
        std::fs::read_to_string(&full).map_err(|e| error(&path, format!("cannot read {}: {e}", full.display())))?;
    let mut document: serde_json::Value = serde_json::from_str(&text).map_err(|e| error(&path, e))?;
    // TOML, as which recordings keep the scene, has no null; absent says the same.
    if let Some(fields) = document.as_object_mut() {
        fields.retain(|_, value| !value.is_null());
    }
    surface.inline = Some(document);
    Ok(())
}

/// Every tool against every body, bodies that deform against all others, and those that may touch themselves; exceptions
/// as the scene lists them.
fn build_pairs(spec: &SceneSpec, tools: &[Tool], bodies: &[Body]) -> Result<Vec<Pair>, SceneError> {
    let mut pairs = Vec::new();
    let index = |k: usize| k as u32;
    let deforms = |body: usize| !matches!(bodies[body].model, BodyModel::Rigid);
    for tool in 0..tools.len() {
        let holder = Holder::Tool(index(tool));
        let friction = friction(spec.tools[tool].friction.as_ref(), || format!("tool[{tool}].friction"))?;
        pairs.extend((0..bodies.len()).map(|body| Pair { holder, body, method: Method::Exact, friction }));
    }
    for body in 0..bodies.len() {
        for other in body + 1..bodies.len() {
            if deforms(body) || deforms(other) {
                // A sheet has no inside: it is asked for the side on which the other is.
                let sheet_second = bodies[other].two_sided && !bodies[body].two_sided;
                let (body, other) = if sheet_second { (other, body) } else { (body, other) };
                let holder = Holder::Body(index(other));
                pairs.push(Pair { holder, body, method: Method::Exact, friction: None });
            }
        }
    }
    for body in 0..bodies.len() {
        if spec.bodies[body].self_contact && deforms(body) {
            let holder = Holder::Body(index(body));
            pairs.push(Pair { holder, body, method: Method::Exact, friction: None });
        }
    }
    for (c, contact) in spec.contacts.iter().enumerate() {
        let [holder_id, body_id] = &contact.pair;
        let tool = tools.iter().position(|tool| &tool.id == holder_id).map(|tool| Holder::Tool(index(tool)));
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
                Holder::Body(other) => pair.holder == Holder::Body(index(body)) && pair.body == other as usize,
                Holder::Tool(_) => false,
            };
            (pair.holder == holder && pair.body == body) || swapped
        };
        if contact.friction.is_some() {
            let friction = friction(contact.friction.as_ref(), || format!("contact[{c}].friction"))?;
            pairs.iter_mut().filter(|pair| named(pair)).for_each(|pair| pair.friction = friction);
        }
        match contact.method {
            ContactMethod::Exact => {}
            ContactMethod::None => pairs.retain(|pair| !named(pair)),
            ContactMethod::Spheres => {
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
fn friction(spec: Option<&FrictionSpec>, path: impl Fn() -> String) -> Result<Option<Friction>, SceneError> {
    let Some(&FrictionSpec { mu, mu_kinetic }) = spec else { return Ok(None) };
    let mu_kinetic = mu_kinetic.unwrap_or(mu);
    if !(mu.is_finite() && (0.0..=mu).contains(&mu_kinetic)) {
        return Err(error(path(), "mu must be 0 or more and mu_kinetic at most mu"));
    }
    Ok((mu > 0.0).then_some(Friction { mu, mu_kinetic }))
}

fn build_tool(spec: &ToolSpec, path: &str, directory: &Path, dt_s: f64) -> Result<Tool, SceneError> {
    let shape = shapes::build(&spec.shape, &format!("{path}.shape"), directory)?;
    let coupling = &spec.coupling;
    if !(coupling.stiffness_n_m > 0.0 && coupling.damping_n_s_m >= 0.0 && coupling.damping_n_s_m.is_finite()) {
        return Err(error(format!("{path}.coupling"), "stiffness_n_m must be above 0 and damping_n_s_m at least 0"));
    }
    let grip_n = spec.grip.force_max_n;
    if !(grip_n.is_finite() && grip_n >= 0.0) {
        return Err(error(format!("{path}.grip.force_max_n"), "a grip holds with 0 N or more"));
    }
    let device = &spec.device;
    let limits = LinkLimits {
        force_max_n: device.force_max_n,
        ramp_n: if device.ramp_s > 0.0 { device.force_max_n * dt_s / device.ramp_s } else { device.force_max_n },
        stale_ticks: (device.stale_s / dt_s).ceil() as u32,
        stride_max_m: device.speed_max_m_s * dt_s,
    };
    let pose = pose(&spec.pose, &format!("{path}.pose"))?;
    Ok(Tool {
        id: spec.id.clone(),
        shape,
        start: (Point3::from(pose.translation.vector), pose.rotation),
        coupling: Coupling::new(coupling.stiffness_n_m, coupling.damping_n_s_m, dt_s),
        limits,
        grip_n,
    })
}

pub(super) fn unit(normal: &[f64; 3], path: &str) -> Result<Vector3, SceneError> {
    Vector3::from(*normal)
        .try_normalize(0.0)
        .filter(|n| n.iter().all(|x| x.is_finite()))
        .ok_or_else(|| error(path, format!("{normal:?} has no direction")))
}

fn pose(spec: &PoseSpec, path: &str) -> Result<Pose, SceneError> {
    let [x, y, z, w] = spec.orientation;
    let quaternion = nalgebra::Quaternion::new(w, x, y, z);
    if (quaternion.norm() - 1.0).abs() > 1e-6 || !spec.position.iter().all(|x| x.is_finite()) {
        return Err(error(path, "position must be finite and orientation a unit quaternion x y z w"));
    }
    Ok(Pose::from_parts(Vector3::from(spec.position).into(), Rotation::from_quaternion(quaternion)))
}

pub(super) fn build_surface(spec: &SurfaceSpec, path: &str, directory: &Path) -> Result<Surface, SceneError> {
    match (&spec.builtin, &spec.file, &spec.inline) {
        (Some(name), None, None) => {
            surface::builtin(name, spec.net, spec.size).map_err(|e| error(format!("{path}.builtin"), e))
        }
        (None, Some(file), None) => {
            let full = directory.join(file);
            let text = std::fs::read_to_string(&full)
                .map_err(|e| error(format!("{path}.file"), format!("cannot read {}: {e}", full.display())))?;
            surface::file::read(&text).map_err(|e| error(format!("{path}.file"), format!("{}: {e}", full.display())))
        }
        (None, None, Some(value)) => surface::file::from_value(value).map_err(|e| error(format!("{path}.inline"), e)),
        _ => Err(error(path, "give exactly one of builtin, file, inline")),
    }
}

fn build_body(
    scene: &SceneSpec,
    spec: &BodySpec,
    path: &str,
    directory: &Path,
    dt_s: f64,
    gravity: Vector3,
) -> Result<Body, SceneError> {
    let placement = pose(&spec.pose, &format!("{path}.pose"))?;
    let original =
        build_surface(&spec.surface, &format!("{path}.surface"), directory)?.oriented_outward().transformed(&placement);
    let original_net = [original.net().rows(), original.net().columns()];
    let topology = original.topology();
    let two_sided = !topology.is_closed();
    let size_m = original.size();
    let (surface, model) = match spec.model {
        ModelSpec::Rigid => (original, BodyModel::Rigid),
        ModelSpec::Lattice => {
            let surface = refine::refine(scene, spec, path, original)?;
            let lattice = build_lattice(
                scene,
                spec,
                path,
                &surface,
                &placement,
                StepSettings { dt_s, iterations: spec.integrator.iterations, gravity },
            )?;
            let samples = SampleGrid::new(&surface, default_samples_per_span());
            let sweeps = spec.integrator.contact_sweeps;
            (surface, BodyModel::Lattice(Box::new(LatticeBody { lattice, samples, sweeps })))
        }
    };
    Ok(Body { id: spec.id.clone(), surface, original_net, size_m, two_sided, model })
}

/// How the control points of a surface lie around a solid: which direction goes around, and what its ends do.
pub(super) struct Layout {
    /// True when u goes around and v along.
    pub u_around: bool,
    around: usize,
    along: usize,
    ends: RingEnds,
}

pub(super) fn layout(surface: &Surface, topology: &Topology) -> Option<Layout> {
    let (rows, columns) = (surface.net().rows(), surface.net().columns());
    let [distinct_u, distinct_v] = distinct(surface, topology);
    let goes_round = |d: usize| matches!(topology.closing[d], Closing::Seam | Closing::Periodic);
    let length = |points: Vec<Point3>| points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>();
    let net = surface.net();
    let u_around = match (goes_round(0), goes_round(1)) {
        (false, false) => return None,
        (true, false) => true,
        (false, true) => false,
        (true, true) => {
            // A torus: the shorter way round is the tube.
            let along_u = length((0..rows).map(|i| *net.at(i, 0)).collect());
            let along_v = length((0..columns).map(|j| *net.at(0, j)).collect());
            along_u <= along_v
        }
    };
    let (around, along, axis_closed, poles) = if u_around {
        (distinct_u, distinct_v, goes_round(1), topology.poles[1])
    } else {
        (distinct_v, distinct_u, goes_round(0), topology.poles[0])
    };
    let ends = RingEnds { axis_closed, first_pole: poles[0], last_pole: poles[1] };
    Some(Layout { u_around, around, along, ends })
}

/// Control points in u and v, those repeated at a seam counted once.
pub(super) fn distinct(surface: &Surface, topology: &Topology) -> [usize; 2] {
    let repeated = |d: usize| usize::from(topology.closing[d] == Closing::Seam);
    [surface.net().rows() - repeated(0), surface.net().columns() - repeated(1)]
}

fn build_lattice(
    scene: &SceneSpec,
    spec: &BodySpec,
    path: &str,
    surface: &Surface,
    placement: &Pose,
    settings: StepSettings,
) -> Result<Lattice, SceneError> {
    let material = &spec.material;
    if !(material.young_pa > 0.0 && material.density_kg_m3 > 0.0 && material.damping_s >= 0.0) {
        return Err(error(
            format!("{path}.material"),
            "young_pa and density_kg_m3 must be above 0, damping_s at least 0",
        ));
    }
    let material =
        Material { young_pa: material.young_pa, density_kg_m3: material.density_kg_m3, damping_s: material.damping_s };
    let (grid, volume) = cells(spec, path, surface)?;
    let mut fixed = vec![false; grid.nodes.len()];
    let mut fix = |point: Point3, normal: Vector3| {
        for (flag, node) in fixed.iter_mut().zip(&grid.nodes) {
            *flag |= (node - point).dot(&normal) <= 0.0;
        }
    };
    for (f, plane) in spec.fixed.iter().enumerate() {
        let normal = unit(&plane.normal, &format!("{path}.fixed[{f}].normal"))?;
        fix(placement * Point3::from(plane.point), placement * normal);
    }
    for (t, tool) in scene.tools.iter().enumerate().filter(|(_, tool)| tool.fixes_nodes) {
        let ShapeSpec::Plane { normal } = &tool.shape else {
            return Err(error(format!("tool[{t}].fixes_nodes"), "only a plane tool can fix nodes"));
        };
        let at = pose(&tool.pose, &format!("tool[{t}].pose"))?;
        let normal = unit(normal, &format!("tool[{t}].shape.plane.normal"))?;
        fix(Point3::from(at.translation.vector), at.rotation * normal);
    }
    Lattice::new(&grid, &material, volume, &fixed, settings).map_err(|e| error(format!("{path}.lattice"), e))
}

/// Cells of a body and the volume its surface encloses.
fn cells(spec: &BodySpec, path: &str, surface: &Surface) -> Result<(CellGrid, f64), SceneError> {
    let topology = surface.topology();
    let points = surface.net().points();
    let columns = surface.net().columns();
    let count = spec.lattice.layers;
    let Some(layout) = layout(surface, &topology) else {
        let Some(thickness_m) = spec.lattice.thickness_m.filter(|t| t.is_finite() && *t > 0.0) else {
            return Err(error(format!("{path}.lattice.thickness_m"), "an open sheet needs a thickness above 0"));
        };
        if count < 2 {
            return Err(error(format!("{path}.lattice.layers"), "an open sheet needs at least 2 layers"));
        }
        let (us, vs) = (surface.knots_u().greville(), surface.knots_v().greville());
        let inward: Vec<Vector3> =
            us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v))).map(|(u, v)| -surface.normal(u, v)).collect();
        let grid = layers::sheet(points, &inward, surface.net().rows(), columns, count, thickness_m);
        let volume = grid.quality().volume_m3;
        return Ok((grid, volume));
    };
    if count < 1 {
        return Err(error(format!("{path}.lattice.layers"), "at least 1 layer"));
    }
    let Layout { u_around, around, along, ends } = layout;
    let rings = Rings { around, along, ends };
    let control = |i: usize, j: usize| if u_around { i * columns + j } else { j * columns + i };
    let ring_of = |k: usize| {
        let (row, column) = (k / columns, k % columns);
        if u_around { (row % around, column % along) } else { (column % around, row % along) }
    };
    let grid = layers::rings(points, &rings, count, control, ring_of);
    // An open tube encloses nothing by itself; its cells then say how much it holds.
    let volume = if topology.is_closed() { surface.volume().abs() } else { grid.quality().volume_m3 };
    Ok((grid, volume))
}
