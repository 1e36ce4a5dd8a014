//! From a scene file's data to the constants of a simulation.

use super::door::{At, Door, SceneError};
use super::files::Files;
use super::methods::Methods;
use super::pairs::{self, Frictions};
use super::spec::{MAX_TOOLS, SceneSpec};
use super::{Body, BodyModel, FrameOf, Pair, Scene, Tool, model, mover, tool};
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::mesh::MeshTool;
use std::sync::Arc;

impl Scene {
    /// Checks the spec and builds surfaces, bodies and tools; `files` has the files that the spec
    /// names: a folder where relative paths start, or memory. [`file::Loaded::build`](super::file::Loaded::build) does the same for a scene
    /// file and gives lines.
    ///
    /// # Errors
    /// Everything that is wrong with the spec, each problem with the path of its key. What depends
    /// on a value that is wrong is not looked at.
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
    pub fn build(spec: &SceneSpec, files: impl Files) -> Result<Self, SceneError> {
        Self::build_with(spec, files, Methods::default())
    }

    /// [`Scene::build`] of a scene that may name these methods.
    ///
    /// # Errors
    /// As [`Scene::build`].
    pub fn build_with(
        spec: &SceneSpec,
        files: impl Files,
        methods: Methods,
    ) -> Result<Self, SceneError> {
        Self::build_from(spec, &files, methods, &[])
    }

    /// [`Scene::build_to_run`] of a scene that differs from this one: deforming bodies of which nothing differs are shared.
    /// `files` are those that this one was built from.
    ///
    /// # Errors
    /// As [`Scene::build_to_run`].
    pub fn variant_to_run(&self, spec: &SceneSpec, files: impl Files) -> Result<Self, SceneError> {
        let comes_out = |spec: &SceneSpec| {
            let tools = spec.tools.iter();
            let tools = tools.map(|tool| {
                let shape = (tool.shape.clone(), tool.pose.clone());
                (tool.id.clone(), shape, tool.fixes_nodes)
            });
            let tools: Vec<_> = tools.collect();
            (spec.loop_.rate_hz, spec.gravity.frame.clone(), tools)
        };
        let alike = comes_out(spec) == comes_out(&self.spec);
        let pairs = spec.bodies.iter().zip(&self.spec.bodies);
        let ready: Vec<Option<Arc<Body>>> = (pairs.zip(&self.bodies))
            .map(|((new, old), body)| (alike && new == old && body.is_soft()).then(|| body.clone()))
            .collect();
        let mut scene = Self::build_from(spec, &files, self.methods, &ready)?;
        for b in (0..ready.len()).filter(|&b| ready[b].is_some()) {
            let of_body = format!("body[{b}].");
            let notes = self.notes.iter().cloned();
            (scene.notes).extend(notes.filter(|(path, _)| path.starts_with(&of_body)));
        }
        scene.checked_to_run()
    }

    /// [`Scene::build_with`], with bodies that are ready, by index.
    pub(super) fn build_from(
        spec: &SceneSpec,
        files: &dyn Files,
        methods: Methods,
        ready: &[Option<Arc<Body>>],
    ) -> Result<Self, SceneError> {
        let door = Door::new(files).with(methods);
        let mut built = scene(spec, ready, &door.top());
        if let Some(scene) = &mut built {
            scene.notes = door.notes();
        }
        door.close(built)
    }
}

/// A copy of a scene with every surface, mesh and motion file written out in place: what a recording carries,
/// so that its replay needs no file.
///
/// # Errors
/// Every file that cannot be read or parsed.
pub fn inline_files(spec: &SceneSpec, files: impl Files) -> Result<SceneSpec, SceneError> {
    let door = Door::new(&files);
    let top = door.top();
    let mut inlined = spec.clone();
    for (b, body) in inlined.bodies.iter_mut().enumerate() {
        let at = top.key("body").entry(b);
        let _ = body.surface.inline_file(&at.key("surface"));
        if body.model().model().deforms() {
            // Written out: a later build may choose another number.
            body.lattice.layers = Some(body.layers());
        }
        if let Some(motion) = &mut body.motion {
            let _ = mover::inline_file(motion, &at.key("motion"));
        }
    }
    for (t, tool) in inlined.tools.iter_mut().enumerate() {
        let at = top.key("tool").entry(t).key("shape");
        let _ = tool.shape.inline_files(&at);
    }
    drop(top);
    door.close(Some(inlined))
}

fn scene(spec: &SceneSpec, ready: &[Option<Arc<Body>>], top: &At<'_>) -> Option<Scene> {
    check_globals(spec, top);
    let dt_s = 1.0 / f64::from(spec.loop_.rate_hz.max(1));
    let frictions = Frictions::of(spec, top);
    for (c, contact) in spec.contacts.iter().enumerate() {
        let _ = pairs::check(spec, contact, &top.key("contact").entry(c));
    }
    let tools: Vec<Option<Tool>> = (spec.tools.iter().enumerate())
        .map(|(t, tool)| tool::build(tool, &top.key("tool").entry(t), dt_s))
        .collect();
    let frame = frame(spec, top);
    let known: Vec<Option<&Tool>> = tools.iter().map(Option::as_ref).collect();
    let bodies: Vec<Option<Arc<Body>>> = (spec.bodies.iter().enumerate())
        .map(|(b, body)| {
            let made = || model::build(spec, &known, body, &top.key("body").entry(b), dt_s);
            let ready = ready.get(b).cloned().flatten();
            ready.or_else(|| made().map(Arc::new))
        })
        .collect();
    let mut bodies: Vec<Arc<Body>> = bodies.into_iter().collect::<Option<_>>()?;
    let tools: Vec<Tool> = tools.into_iter().collect::<Option<_>>()?;
    make_solid(&mut bodies, &tools, top)?;
    let (frictions, frame) = (frictions?, frame?);
    let pairs = pairs::build(spec, &frictions, &tools, &bodies, frame.as_ref(), top)?;
    check_couplings(&tools, &bodies, &pairs, top);
    Some(Scene {
        name: spec.name.clone().unwrap_or_else(|| "scene".into()),
        dt_s,
        clock: spec.loop_.clock,
        spec: spec.clone(),
        bodies,
        tools,
        pairs,
        frame,
        methods: top.methods(),
        notes: Vec::new(),
        warnings: Vec::new(),
    })
}

/// Gives closed parts what surfaces and other parts need to touch them, where there are any.
fn make_solid(bodies: &mut [Arc<Body>], tools: &[Tool], top: &At<'_>) -> Option<()> {
    let touched = bodies.iter().any(|body| !body.is_firm()) && bodies.len() > 1
        || (tools.iter()).any(|tool| matches!(tool.shape, ToolShape::Surface(_)));
    for (b, body) in bodies.iter_mut().enumerate().filter(|_| touched) {
        let Some(placed) = body.skin.part().filter(|placed| placed.part().is_closed()) else {
            continue;
        };
        match MeshTool::of_part(placed.shared()) {
            Ok(solid) => {
                // Parts are rigid, and made here.
                if let Some(body) = Arc::get_mut(body) {
                    body.solid = Some(Arc::new(solid));
                }
            }
            Err(error) => {
                return top.key("body").entry(b).key("surface").refused(format!(
                    "surfaces and other bodies touch a part by its triangles, and {error}"
                ));
            }
        }
    }
    Some(())
}

/// What concerns the scene as a whole: rates, gravity, recording, how many, and ids.
fn check_globals(spec: &SceneSpec, top: &At<'_>) {
    let rate = spec.loop_.rate_hz;
    if !(1..=10_000).contains(&rate) {
        top.key("loop")
            .key("rate_hz")
            .refuse(format!("rate_hz is {rate}; it must be 1 to 10000"));
    }
    let gravity = top.key("gravity");
    gravity.finite("acceleration", &spec.gravity.acceleration);
    gravity.not_below_zero("smoothing_s", spec.gravity.smoothing_s, "s");
    let record = top.key("record");
    record.above_zero("keyframe_s", spec.record.keyframe_s, "s");
    record.above_zero("net_hz", spec.record.net_hz, "Hz");
    record.above_zero("view_hz", spec.record.view_hz, "Hz");
    if spec.bodies.is_empty() {
        top.key("body")
            .refuse("a scene needs at least one [[body]]");
    }
    if spec.tools.len() > MAX_TOOLS {
        top.key("tool").entry(MAX_TOOLS).key("id").refuse(format!(
            "{} tools; a scene has at most {MAX_TOOLS} tools",
            spec.tools.len()
        ));
    }
    let bodies: Vec<&str> = spec.bodies.iter().map(|body| body.id.as_str()).collect();
    let tools: Vec<&str> = spec.tools.iter().map(|tool| tool.id.as_str()).collect();
    check_ids("body", &bodies, top);
    check_ids("tool", &tools, top);
}

fn check_ids(table: &str, ids: &[&str], top: &At<'_>) {
    let fits = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_' || b == b'-';
    for (k, id) in ids.iter().enumerate() {
        let at = top.key(table).entry(k).key("id");
        if !((1..=64).contains(&id.len()) && id.bytes().all(fits)) {
            at.refuse(format!(
                "{id:?} is not a valid id; use 1 to 64 of a-z, 0-9, '_' and '-'"
            ));
        }
        if ids[..k].contains(id) {
            at.refuse(format!("id {id:?} is taken by an earlier {table}"));
        }
    }
}

/// The tool in whose frame the bodies are, if the scene names one. The outer `None` is a problem.
fn frame(spec: &SceneSpec, top: &At<'_>) -> Option<Option<FrameOf>> {
    let Some(id) = &spec.gravity.frame else {
        return Some(None);
    };
    let mut refused = false;
    for (b, body) in spec.bodies.iter().enumerate() {
        if body.model().model().deforms() && body.integrator.every > 1 {
            let at = top.key("body").entry(b).key("integrator").key("every");
            at.refuse(
                "a body in a carried frame steps every tick: what it feels changes with each; use every = 1",
            );
            refused = true;
        }
    }
    let Some(tool) = spec.tools.iter().position(|tool| &tool.id == id) else {
        let known: Vec<&str> = spec.tools.iter().map(|tool| tool.id.as_str()).collect();
        return top.key("gravity").key("frame").refused(format!(
            "there is no tool {id:?} in this scene; its tools are {known:?}"
        ));
    };
    (!refused).then_some(Some(FrameOf {
        tool,
        smoothing_s: spec.gravity.smoothing_s,
    }))
}

/// A rigid coupling needs something that gives way.
fn check_couplings(tools: &[Tool], bodies: &[Arc<Body>], pairs: &[Pair], top: &At<'_>) {
    for (t, tool) in tools.iter().enumerate() {
        let is_rigid = |pair: &&Pair| matches!(bodies[pair.body].model, BodyModel::Rigid);
        let mut of_tool = pairs.iter().filter(|pair| pair.tool() == Some(t));
        if let (true, Some(pair)) = (tool.coupling.is_rigid(), of_tool.find(is_rigid)) {
            let at = top
                .key("tool")
                .entry(t)
                .key("coupling")
                .key("stiffness_n_m");
            at.refuse(format!(
                "a rigid coupling against the rigid body {:?} has no finite force; give it a stiffness",
                bodies[pair.body].id
            ));
        }
    }
}
