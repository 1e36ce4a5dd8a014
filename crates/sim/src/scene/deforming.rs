//! From a scene file's data to the constants of a deforming body.

use super::build::{SceneError, error, pose, unit};
use super::layout::layout;
use super::plan::step_us;
use super::spec::{
    BodySpec, BuilderSpec, FixedSpec, MaterialSpec, MethodSpec, ModelSpec, RegionSpec, SceneSpec,
    ShapeSpec, SpringsSpec,
};
use crate::body::layers;
use crate::body::net::{self, Axis, Reduced};
use crate::body::{
    self, CellGrid, Deformable, DeformableError, Inside, Integrator, Material, NodeMap, Plastic,
    Sheet, Solid, SomSettings, SpringRule, StepSettings, Stiffening,
};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Pose, Vector3};
use palpate_geometry::surface::{Closing, Direction, Surface};

/// What moves a body, and why that way.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    /// `lattice`, `membrane` …
    pub model: &'static str,
    /// One sentence for the plan.
    pub why: String,
}

/// Builds a deforming body on its refined surface.
pub(super) fn build(
    scene: &SceneSpec,
    spec: &BodySpec,
    path: &str,
    surface: &Surface,
    placement: &Pose,
    dt_s: f64,
) -> Result<(Deformable, Choice), SceneError> {
    let settings = |integrator| StepSettings {
        dt_s: dt_s * f64::from(spec.integrator.every),
        integrator,
        // What carries a body may move at any time, and nothing would wake it.
        sleep_m_s: if scene.gravity.frame.is_some() {
            0.0
        } else {
            spec.integrator.sleep_m_s
        },
    };
    let implicit = Integrator::Implicit {
        iterations: spec.integrator.iterations,
    };
    let explicit = Integrator::Explicit {
        substeps: spec.integrator.substeps,
    };
    let make = |integrator| match spec.model {
        ModelSpec::Membrane => {
            membrane(scene, spec, path, surface, placement, settings(integrator))
        }
        ModelSpec::Rigid | ModelSpec::Lattice | ModelSpec::Continuum | ModelSpec::Net => {
            solid(scene, spec, path, surface, placement, settings(integrator))
        }
    };
    let model = match spec.model {
        ModelSpec::Membrane => "membrane",
        ModelSpec::Net => "net",
        ModelSpec::Continuum => "continuum",
        ModelSpec::Rigid | ModelSpec::Lattice => "lattice",
    };
    let (body, why) = match spec.integrator.method {
        MethodSpec::Implicit => (
            make(implicit)?,
            "implicit, as the scene says or by default".to_owned(),
        ),
        MethodSpec::Explicit => (make(explicit)?, "explicit, as the scene says".to_owned()),
        MethodSpec::Xpbd => {
            let xpbd = Integrator::Xpbd {
                substeps: spec.integrator.substeps,
            };
            (
                make(xpbd)?,
                "xpbd, as the scene says: compare its forces, it softens silently".to_owned(),
            )
        }
        MethodSpec::Auto => cheaper(make(implicit)?, make(explicit)),
    };
    Ok((body, Choice { model, why }))
}

/// The cheaper of two methods, by the plan's own prediction of their steps.
fn cheaper(implicit: Deformable, explicit: Result<Deformable, SceneError>) -> (Deformable, String) {
    let implicit_us = step_us(&implicit);
    match explicit {
        Err(error) => (implicit, format!("implicit: {}", error.reason)),
        Ok(explicit) => {
            let substeps = explicit.integration().1;
            let explicit_us = step_us(&explicit);
            let compared = format!(
                "{substeps} explicit substeps would take {explicit_us:.0} us, implicit {implicit_us:.0} us"
            );
            if explicit_us < implicit_us {
                (explicit, format!("explicit: {compared}"))
            } else {
                (implicit, format!("implicit: {compared}"))
            }
        }
    }
}

/// A solid of any model and builder.
fn solid(
    scene: &SceneSpec,
    spec: &BodySpec,
    path: &str,
    surface: &Surface,
    placement: &Pose,
    settings: StepSettings,
) -> Result<Deformable, SceneError> {
    if surface.joints().is_some() {
        let reason = "the net of this surface is disjoined: its inside has no layers; use model = \"membrane\"";
        return Err(error(format!("{path}.model"), reason));
    }
    let common = material(&spec.material, path)?;
    let (moved, enclosed_volume_m3) = match (spec.model, spec.lattice.builder) {
        (ModelSpec::Net, _) => reduced(spec, path, surface)?,
        (_, BuilderSpec::Layers) => layered(spec, path, surface)?,
        (_, BuilderSpec::Transfinite | BuilderSpec::Som) => riding(spec, path, surface)?,
    };
    let Reduced {
        grid,
        map,
        coordinates,
        coordinate_of_control,
    } = moved;
    let fixed = fixed(
        scene,
        spec,
        path,
        surface,
        placement,
        &coordinates,
        &coordinate_of_control,
    )?;
    let of_cell = materials(spec, &common, &grid, placement);
    let solid = Solid {
        grid: &grid,
        map,
        coordinates,
        coordinate_of_control,
        fixed,
        enclosed_volume_m3,
        inside: inside(spec),
        material: |cell: usize| of_cell[cell],
    };
    solid
        .build(&common, settings)
        .map_err(|e| deformable_error(path, &e))
}

/// Layers of nodes, which are the coordinates, and the volume that the surface encloses.
fn layered(spec: &BodySpec, path: &str, surface: &Surface) -> Result<(Reduced, f64), SceneError> {
    let (grid, volume) = cells(spec, path, surface)?;
    let (coordinates, coordinate_of_control) = (grid.nodes.clone(), grid.node_of_control.clone());
    Ok((
        Reduced {
            grid,
            map: NodeMap::Same,
            coordinates,
            coordinate_of_control,
        },
        volume,
    ))
}

/// A cube of nodes, the outermost of which ride on the surface, and the volume that it encloses.
fn riding(spec: &BodySpec, path: &str, surface: &Surface) -> Result<(Reduced, f64), SceneError> {
    let bad = |e: &dyn std::fmt::Display| error(format!("{path}.lattice"), e);
    let counts = spec.lattice.nodes;
    let closed = surface.topology().is_closed();
    let cube = match (spec.lattice.builder, closed, spec.lattice.thickness_m) {
        (BuilderSpec::Som, ..) => {
            let settings = SomSettings {
                cycles: spec.lattice.cycles,
                ..SomSettings::default()
            };
            body::som(surface, counts, &settings)
        }
        (BuilderSpec::Transfinite | BuilderSpec::Layers, false, Some(thickness_m)) => {
            body::thick_sheet(surface, counts, thickness_m)
        }
        (BuilderSpec::Transfinite | BuilderSpec::Layers, true, _)
        | (BuilderSpec::Transfinite | BuilderSpec::Layers, false, None) => {
            body::transfinite(surface, counts)
        }
    };
    let cube = cube.map_err(|e| bad(&e))?;
    let coordinate_of_control = body::coordinates_of_surface(surface);
    body::check_exterior(surface, &cube.exterior, &coordinate_of_control).map_err(|e| bad(&e))?;
    let (map, coordinates) = cube.riding(surface, &coordinate_of_control);
    let volume = if closed {
        surface.volume().abs()
    } else {
        cube.quality().volume_m3
    };
    Ok((
        Reduced {
            grid: cube.grid,
            map,
            coordinates,
            coordinate_of_control,
        },
        volume,
    ))
}

fn inside(spec: &BodySpec) -> Inside {
    match spec.model {
        ModelSpec::Net => Inside::SmoothContinuum,
        ModelSpec::Continuum => Inside::Continuum,
        // A membrane has no inside, a rigid body no law.
        ModelSpec::Lattice | ModelSpec::Membrane | ModelSpec::Rigid => {
            Inside::Springs(rule(&spec.material))
        }
    }
}

fn rule(material: &MaterialSpec) -> SpringRule {
    match material.springs {
        Some(SpringsSpec::Seed) => SpringRule::Seed,
        Some(SpringsSpec::Moduli) | None => SpringRule::Moduli,
    }
}

/// Cells over finer knots than the surface's, moved by its net and shells of it, and the volume its
/// surface encloses.
fn reduced(spec: &BodySpec, path: &str, surface: &Surface) -> Result<(Reduced, f64), SceneError> {
    if surface.weights().is_some() {
        return Err(error(
            format!("{path}.model"),
            "a rational surface has no \"net\" model; use \"continuum\"",
        ));
    }
    let per_span = spec.lattice.cells_per_span;
    let finer = |direction: Direction, knots: &KnotVector| {
        let spans = knots
            .spans()
            .map(|i| (knots.knots()[i], knots.knots()[i + 1]));
        let at = |(a, b): (f64, f64), k: usize| a + (b - a) * k as f64 / per_span as f64;
        let inner: Vec<f64> = spans
            .flat_map(|span| (1..per_span).map(move |k| at(span, k)))
            .collect();
        surface
            .insert_knots(direction, &inner)
            .map_err(|e| error(format!("{path}.lattice.cells_per_span"), e))
    };
    let (finer_u, finer_v) = (
        finer(Direction::U, surface.knots_u())?,
        finer(Direction::V, surface.knots_v())?,
    );
    let topology = surface.topology();
    let seam = |d: usize| topology.closing[d] == Closing::Seam;
    let axes = [
        Axis::insertion(surface.knots_u(), finer_u.knots_u(), seam(0)),
        Axis::insertion(surface.knots_v(), finer_v.knots_v(), seam(1)),
    ];
    let points = surface.net().points();
    let Some(shape) = layout(surface, &topology) else {
        let (thickness_m, inward) = sheet(spec, path, surface)?;
        let shells = spec.lattice.layers;
        let depth = Axis::depth(
            shells,
            spec.lattice.cell_layers.unwrap_or(2 * (shells - 1)) + 1,
        );
        let reduced = net::sheet(points, &inward, &axes[0], &axes[1], &depth, thickness_m);
        let volume = reduced.grid.quality().volume_m3;
        return Ok((reduced, volume));
    };
    let shells = spec.lattice.layers.max(1);
    let depth = Axis::depth(
        shells + 1,
        spec.lattice.cell_layers.unwrap_or(2 * shells) + 1,
    );
    let [around, along] = if shape.u_around {
        [&axes[0], &axes[1]]
    } else {
        [&axes[1], &axes[0]]
    };
    let reduced = net::rings(points, &shape, around, along, &depth);
    let volume = if topology.is_closed() {
        surface.volume().abs()
    } else {
        reduced.grid.quality().volume_m3
    };
    Ok((reduced, volume))
}

fn membrane(
    scene: &SceneSpec,
    spec: &BodySpec,
    path: &str,
    surface: &Surface,
    placement: &Pose,
    settings: StepSettings,
) -> Result<Deformable, SceneError> {
    let Some(thickness_m) = spec
        .lattice
        .thickness_m
        .filter(|t| t.is_finite() && *t > 0.0)
    else {
        return Err(error(
            format!("{path}.lattice.thickness_m"),
            "a membrane needs a thickness above 0",
        ));
    };
    if !spec.regions.is_empty() {
        return Err(error(
            format!("{path}.region"),
            "a membrane is of one material; use model = \"lattice\"",
        ));
    }
    let points = surface.net().points();
    let of_control = body::coordinates_of_surface(surface);
    let count = of_control.iter().max().map_or(0, |&last| last as usize + 1);
    let mut coordinates = vec![Point3::origin(); count];
    for (point, &coordinate) in points.iter().zip(&of_control) {
        coordinates[coordinate as usize] = *point;
    }
    let common = material(&spec.material, path)?;
    let fixed = fixed(
        scene,
        spec,
        path,
        surface,
        placement,
        &coordinates,
        &of_control,
    )?;
    let wraps = surface
        .topology()
        .closing
        .map(|closing| closing == Closing::Periodic);
    let sheet = Sheet::of(surface, wraps, &of_control);
    body::membrane(
        points,
        &sheet,
        &of_control,
        &common,
        thickness_m,
        &fixed,
        settings,
    )
    .map_err(|e| deformable_error(path, &e))
}

fn deformable_error(path: &str, e: &DeformableError) -> SceneError {
    let key = match e {
        DeformableError::Substeps { .. } | DeformableError::Unsupported(_) => "integrator",
        _ => "lattice",
    };
    error(format!("{path}.{key}"), e)
}

/// The material of a body: its preset, and what differs.
fn material(spec: &MaterialSpec, path: &str) -> Result<Material, SceneError> {
    let name = spec.preset.as_deref().unwrap_or("gel");
    let Some(preset) = body::preset(name) else {
        return Err(error(
            format!("{path}.material.preset"),
            format!("{name:?} is no material"),
        ));
    };
    let of_preset = preset.material;
    let plastic = spec.plastic.as_ref().map(|p| Plastic {
        yield_strain: p.yield_strain,
        rate_per_s: p.rate_per_s,
        hardening: p.hardening,
        limit: p.limit,
        spread_m: p.spread_m,
    });
    let stiffening = spec.stiffening.as_ref().map(|s| Stiffening {
        strain: s.strain,
        ratio: s.ratio,
        least_length: s.least_length,
        least_length_ratio: s.least_length_ratio,
    });
    let material = Material {
        young_pa: spec.young_pa.unwrap_or(of_preset.young_pa),
        poisson: spec.poisson.unwrap_or(of_preset.poisson),
        density_kg_m3: spec.density_kg_m3.unwrap_or(of_preset.density_kg_m3),
        damping_s: spec.damping_s.unwrap_or(of_preset.damping_s),
        plastic: plastic.or(of_preset.plastic).filter(|p| p.rate_per_s > 0.0),
        stiffening: stiffening.or(of_preset.stiffening),
    };
    let positive =
        material.young_pa > 0.0 && material.density_kg_m3 > 0.0 && material.damping_s >= 0.0;
    if !(positive && (0.0..0.5).contains(&material.poisson)) {
        return Err(error(
            format!("{path}.material"),
            "young_pa and density_kg_m3 must be above 0, damping_s at least 0, poisson in [0, 0.5)",
        ));
    }
    Ok(material)
}

/// What each cell is made of: of the last region that holds its centre.
fn materials(
    spec: &BodySpec,
    common: &Material,
    grid: &CellGrid,
    placement: &Pose,
) -> Vec<Material> {
    let holds = |region: &RegionSpec, p: &Point3| match (&region.ball, &region.box_) {
        (Some(ball), _) => (p - Point3::from(ball.centre)).norm() <= ball.radius_m,
        (None, Some(bounds)) => (0..3).all(|c| (bounds.low[c]..=bounds.high[c]).contains(&p[c])),
        (None, None) => false,
    };
    let of_cell = |cell: &body::Cell| {
        let centre: Vector3 = cell
            .iter()
            .map(|&node| grid.nodes[node as usize].coords / 8.0)
            .sum();
        let centre = placement.inverse_transform_point(&Point3::from(centre));
        let region = spec
            .regions
            .iter()
            .rev()
            .find(|region| holds(region, &centre));
        region.map_or(*common, |region| Material {
            young_pa: region.young_pa.unwrap_or(common.young_pa),
            poisson: region.poisson.unwrap_or(common.poisson),
            density_kg_m3: region.density_kg_m3.unwrap_or(common.density_kg_m3),
            ..*common
        })
    };
    grid.cells.iter().map(of_cell).collect()
}

/// Which coordinates never move.
fn fixed(
    scene: &SceneSpec,
    spec: &BodySpec,
    path: &str,
    surface: &Surface,
    placement: &Pose,
    coordinates: &[Point3],
    of_control: &[u32],
) -> Result<Vec<bool>, SceneError> {
    let mut fixed = vec![false; coordinates.len()];
    let behind = |fixed: &mut Vec<bool>, point: Point3, normal: Vector3| {
        for (flag, place) in fixed.iter_mut().zip(coordinates) {
            *flag |= (place - point).dot(&normal) <= 0.0;
        }
    };
    for (f, entry) in spec.fixed.iter().enumerate() {
        match entry {
            FixedSpec::Plane { point, normal } => {
                let normal = unit(normal, &format!("{path}.fixed[{f}].normal"))?;
                behind(
                    &mut fixed,
                    placement * Point3::from(*point),
                    placement * normal,
                );
            }
            FixedSpec::Range { u, v } => {
                let within = |x: f64, [from, to]: [f64; 2]| x >= from && x <= to;
                let (us, vs) = (surface.knots_u().greville(), surface.knots_v().greville());
                for (control, &coordinate) in of_control.iter().enumerate() {
                    fixed[coordinate as usize] |=
                        within(us[control / vs.len()], *u) && within(vs[control % vs.len()], *v);
                }
            }
        }
    }
    for (t, tool) in scene
        .tools
        .iter()
        .enumerate()
        .filter(|(_, tool)| tool.fixes_nodes)
    {
        let ShapeSpec::Plane { normal } = &tool.shape else {
            return Err(error(
                format!("tool[{t}].fixes_nodes"),
                "only a plane tool can fix nodes",
            ));
        };
        let at = pose(&tool.pose, &format!("tool[{t}].pose"))?;
        let normal = unit(normal, &format!("tool[{t}].shape.plane.normal"))?;
        behind(
            &mut fixed,
            Point3::from(at.translation.vector),
            at.rotation * normal,
        );
    }
    Ok(fixed)
}

/// Cells of a body and the volume its surface encloses.
fn cells(spec: &BodySpec, path: &str, surface: &Surface) -> Result<(CellGrid, f64), SceneError> {
    let topology = surface.topology();
    let points = surface.net().points();
    let columns = surface.net().columns();
    let count = spec.lattice.layers;
    let Some(shape) = layout(surface, &topology) else {
        let (thickness_m, inward) = sheet(spec, path, surface)?;
        let grid = layers::sheet(
            points,
            &inward,
            surface.net().rows(),
            columns,
            count,
            thickness_m,
        );
        let volume = grid.quality().volume_m3;
        return Ok((grid, volume));
    };
    if count < 1 {
        return Err(error(format!("{path}.lattice.layers"), "at least 1 layer"));
    }
    let grid = layers::rings_at_best(points, &shape, count);
    // An open tube encloses nothing by itself; its cells then say how much it holds.
    let volume = if topology.is_closed() {
        surface.volume().abs()
    } else {
        grid.quality().volume_m3
    };
    Ok((grid, volume))
}

/// Thickness of an open sheet and its inward normals at control points.
fn sheet(
    spec: &BodySpec,
    path: &str,
    surface: &Surface,
) -> Result<(f64, Vec<Vector3>), SceneError> {
    let Some(thickness_m) = spec
        .lattice
        .thickness_m
        .filter(|t| t.is_finite() && *t > 0.0)
    else {
        return Err(error(
            format!("{path}.lattice.thickness_m"),
            "an open sheet needs a thickness above 0",
        ));
    };
    if spec.lattice.layers < 2 {
        return Err(error(
            format!("{path}.lattice.layers"),
            "an open sheet needs at least 2 layers",
        ));
    }
    let (us, vs) = (surface.knots_u().greville(), surface.knots_v().greville());
    let places = us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v)));
    Ok((
        thickness_m,
        places.map(|(u, v)| -surface.normal(u, v)).collect(),
    ))
}
