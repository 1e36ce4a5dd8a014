//! What the deforming models have in common: the method of the step, the cells' materials, samples.

use super::values::MOST_POINTS;
use super::{Inputs, Make, fixed, values};
use crate::body::net::Reduced;
use crate::body::{Cell, CellGrid, Deformable, DeformableError, Inside, Integrator, Material};
use crate::body::{Solid, StepMatrix, StepSettings};
use crate::scene::parts::{BodyModel, Choice, DeformingBody, samples_per_span};
use crate::scene::plan::step_us;
use crate::scene::refine::{self, Refined};
use crate::scene::spec::{BodySpec, IterationsSpec, MatrixSpec, MethodSpec, ModelSpec, RefineSpec};
use crate::solve::indentation::{
    FOCUS, FOCUS_OF_SMOOTH, LESS, LESS_OF_SMOOTH, PATCH, PATCH_OF_SMOOTH, Resolution, of_layers,
};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::contact::ContactSamples;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;

/// Most nodes that `refine = "auto"` makes: a tick with more does not fit a millisecond on one core.
pub(super) const NODE_BUDGET: usize = 1_900;
/// Of that, most for each layer of cells that a focus makes. What a net is too coarse to show of a ball is added
/// as an indentation, so that more points add time and nothing else: of 250, 300, 350, 400 and 475, lattices of three
/// and four layers in the teardrop meet forces within 13, 10, 18, 16 and 9 % of the reference at 1 to 4 mm, continua
/// within 6, 8, 12, 8 and 9 %, in 0.5, 0.6, 0.7, 0.8 and 1 of the time.
const FOCUS_BUDGET: usize = 300;

/// Of `iterations = "auto"`: the motion error to be reached, the share of a tick that a body's step may
/// take, and the most iterations.
const MOTION_ERROR: f64 = 0.02;
const STEP_SHARE: f64 = 0.5;
const MOST_AUTO: usize = 5;

/// A deforming body on its refined surface, of which `parts` gives all but the step.
pub(super) fn deforming<'b>(
    body: &'b Inputs<'_>,
    node_budget: usize,
    parts: impl Fn(&Surface) -> Option<Make<'b>>,
) -> Option<(Surface, BodyModel)> {
    let Inputs {
        scene, spec, at, ..
    } = body;
    let parted = [body.surface.knots_u(), body.surface.knots_v()]
        .iter()
        .any(|knots| !knots.disjoined().is_empty());
    if parted && body.surface.joints().is_none() {
        return at.key("surface").refused(
            "the knots of this surface part it: to deform, it must be clamped in both directions and have at \
             most 1024 patches; or use model = \"rigid\"",
        );
    }
    let focused = matches!(spec.lattice.refine, RefineSpec::Focus { .. });
    let node_budget = match focused {
        true => node_budget.min(FOCUS_BUDGET * spec.layers()),
        false => node_budget,
    };
    let with = |grading: f64| {
        let from = Refined {
            scene,
            spec,
            at,
            placement: &body.placement,
            node_budget,
            grading,
        };
        let refined = refine::refine(&from, body.surface.clone())?;
        let make = parts(&refined)?;
        let (deformable, why) = stepped(body, &make)?;
        Some((refined, deformable, why))
    };
    let [steeper @ .., even] = refine::GRADINGS;
    // Spans of unlike lengths may make cells that no continuum can use.
    let graded = match spec.lattice.refine {
        RefineSpec::Focus { .. } => steeper
            .into_iter()
            .find_map(|grading| at.attempt(|| with(grading))),
        _ => None,
    };
    let (refined, deformable, why) = graded.or_else(|| with(even))?;
    let mut deformable = deformable;
    values::launch(spec, &mut deformable, at)?;
    let samples = ContactSamples::new(&refined, samples_per_span(&refined));
    let choice = Choice {
        model: spec.model().name(),
        why,
    };
    let model = DeformingBody {
        resolution: resolution(&refined, &deformable, spec),
        deformable,
        samples,
        sweeps: spec.integrator.contact_sweeps,
        every: spec.integrator.every,
        choice,
    };
    Some((refined, BodyModel::Deforming(Box::new(model))))
}

/// How finely a solid resolves what presses it, at each of its control points.
fn resolution(surface: &Surface, body: &Deformable, spec: &BodySpec) -> Vec<Resolution> {
    let smooth = spec.model() == ModelSpec::Net;
    let thickness_m = spec.lattice.thickness_m.unwrap_or(f64::INFINITY);
    let (u, v) = (surface.knots_u().greville(), surface.knots_v().greville());
    let places = u.iter().flat_map(|&u| v.iter().map(move |&v| (u, v)));
    let at = |(control, (u, v)): (usize, (f64, f64))| {
        let grain = body.grain(body.coordinate_of_control(control))?;
        // Folded cells have no volume to speak of: nothing is added where they are.
        if !(grain.volume_m3 > 0.0 && grain.plane_modulus_pa > 0.0) {
            return Some(Resolution::default());
        }
        let span_m = span_m(surface, control);
        let (patch_m, focus, less) = match smooth {
            true => {
                let layer_m = 2.0 * grain.volume_m3 / (span_m * span_m);
                let patch_m = PATCH_OF_SMOOTH * span_m * of_layers(layer_m / span_m);
                (patch_m, FOCUS_OF_SMOOTH, LESS_OF_SMOOTH)
            }
            // Half a cell is all that a control point of a surface has.
            false => {
                let cell_m = libm::cbrt(2.0 * grain.volume_m3);
                (PATCH * (span_m * cell_m).sqrt(), FOCUS, LESS)
            }
        };
        let mean = surface
            .curvature(u, v)
            .map_or(0.0, |curvature| curvature.mean());
        // Rounder than its own patch, a net is not resolved.
        let most = 1.0 / patch_m;
        Some(Resolution {
            plane_modulus_pa: grain.plane_modulus_pa,
            across: (2.0 - grain.poisson) / (2.0 - 2.0 * grain.poisson),
            voigt: body.voigt(),
            patch_m,
            focus,
            less,
            curvature_1_m: mean.max(-most).min(most),
            // Half of what is there.
            thin_1_m: 2.0 / thickness_m,
        })
    };
    let all: Vec<Resolution> = places.enumerate().map_while(at).collect();
    // A sheet as thin as a patch is no half-space below it.
    match all.iter().any(|one| one.patch_m > thickness_m) {
        true => Vec::new(),
        false => all,
    }
}

/// Mean length of the spans around a control point, m; where one side of them is shorter than a quarter of
/// the other, at poles, as if it were a quarter.
fn span_m(surface: &Surface, control: usize) -> f64 {
    let (ku, kv) = (surface.knots_u(), surface.knots_v());
    let (i, j) = (control / kv.count(), control % kv.count());
    let wide = |knots: &KnotVector, i: usize| {
        let degree = knots.degree();
        let support = &knots.knots()[i..=i + degree + 1];
        (support[degree + 1] - support[0]) / (degree + 1) as f64
    };
    let frame = surface.frame(ku.greville()[i], kv.greville()[j]);
    let (u, v) = (frame.du.norm() * wide(ku, i), frame.dv.norm() * wide(kv, j));
    (u.max(0.25 * v) * v.max(0.25 * u)).sqrt()
}

/// The body with the method of its integrator, and why that one.
fn stepped(body: &Inputs<'_>, make: &Make<'_>) -> Option<(Deformable, String)> {
    let integrator = &body.spec.integrator;
    let with = |integrator| {
        make(StepSettings {
            dt_s: body.dt_s * f64::from(body.spec.integrator.every),
            integrator,
            // What carries a body may move at any time, and nothing would wake it.
            sleep_m_s: if body.scene.gravity.frame.is_some() {
                0.0
            } else {
                body.spec.integrator.sleep_m_s
            },
        })
    };
    let matrix = match integrator.matrix {
        MatrixSpec::Auto => StepMatrix::Auto,
        MatrixSpec::Tangent => StepMatrix::Tangent,
        MatrixSpec::Bounding => StepMatrix::Bounding,
    };
    let implicit = || match integrator.iterations {
        IterationsSpec::Count(iterations) => with(Integrator::Implicit { iterations, matrix }),
        IterationsSpec::Auto(_) => {
            let first = with(Integrator::Implicit {
                iterations: 1,
                matrix,
            })?;
            match few_iterations(&first, body.dt_s, integrator.every) {
                1 => Ok(first),
                iterations => with(Integrator::Implicit { iterations, matrix }),
            }
        }
    };
    let substeps = integrator.substeps;
    let explicit = || with(Integrator::Explicit { substeps });
    let checked = |result: Result<Deformable, DeformableError>| {
        result
            .map_err(|error| body.at.key(key_of(&error)).refuse(error))
            .ok()
    };
    Some(match integrator.method {
        MethodSpec::Implicit => (
            checked(implicit())?,
            "implicit, as the scene says or by default".to_owned(),
        ),
        MethodSpec::Explicit => (
            checked(explicit())?,
            "explicit, as the scene says".to_owned(),
        ),
        MethodSpec::Xpbd => (
            checked(with(Integrator::Xpbd { substeps }))?,
            "xpbd, as the scene says: compare its forces, it softens silently".to_owned(),
        ),
        MethodSpec::Auto => cheaper(checked(implicit())?, explicit()),
    })
}

/// As few iterations as bring the expected motion error below [`MOTION_ERROR`], while the predicted
/// step takes no more than its share of the tick.
fn few_iterations(body: &Deformable, dt_s: f64, every: u32) -> usize {
    if every > 1 {
        // Contact is settled between the iterations of one tick.
        return 1;
    }
    let affordable = (STEP_SHARE * dt_s * 1e6 / step_us(body)) as usize;
    let most = affordable.clamp(1, MOST_AUTO);
    (1..most)
        .find(|&iterations| body.motion_error(iterations) <= MOTION_ERROR)
        .unwrap_or(most)
}

/// The key of a `[[body]]` that decides over an error.
fn key_of(error: &DeformableError) -> &'static str {
    match error {
        DeformableError::Substeps { .. } | DeformableError::Unsupported(_) => "integrator",
        _ => "lattice",
    }
}

/// The cheaper of two methods, by the plan's own prediction of their steps.
fn cheaper(
    implicit: Deformable,
    explicit: Result<Deformable, DeformableError>,
) -> (Deformable, String) {
    let implicit_us = step_us(&implicit);
    match explicit {
        Err(error) => (implicit, format!("implicit: {error}")),
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

/// A solid of cells: `moved` gives them with what moves them and the volume that the surface
/// encloses, m³; `inside` is what acts between their nodes.
pub(super) fn solid<'s>(
    body: &'s Inputs<'_>,
    surface: &Surface,
    inside: Inside,
    moved: impl FnOnce() -> Option<(Reduced, f64)>,
) -> Option<Make<'s>> {
    if surface.joints().is_some() {
        return body.at.key("model").refused(
            "the net of this surface is disjoined: its inside has no layers; use model = \"membrane\"",
        );
    }
    let points = surface.net().points().len();
    let layers = body.spec.layers();
    if points.saturating_mul(layers) > MOST_POINTS {
        return body.at.key("lattice").refused(format!(
            "a net of {points} points in {layers} layers has more than {MOST_POINTS} nodes, which no tick can move; \
             simplify the surface (palpate surface simplify), use fewer layers, or model = \"membrane\""
        ));
    }
    let (moved, enclosed_volume_m3) = moved()?;
    let Reduced {
        grid,
        map,
        coordinates,
        coordinate_of_control,
        patch_of_cell,
    } = moved;
    let moves = fixed::Moved {
        nodes: &grid.nodes,
        map: &map,
    };
    let mut fixed = fixed::fixed(
        body,
        surface,
        &coordinates,
        &coordinate_of_control,
        Some(&moves),
    );
    let firmness = fixed::firmness(body, &grid.cells, &moves, &coordinates, &mut fixed);
    let of_cell = materials(body, &grid);
    Some(Box::new(move |settings| {
        let solid = Solid {
            grid: &grid,
            map: map.clone(),
            patch_of_cell: &patch_of_cell,
            coordinates: coordinates.clone(),
            coordinate_of_control: coordinate_of_control.clone(),
            fixed: fixed.clone(),
            enclosed_volume_m3,
            inside,
            material: |cell: usize| of_cell[cell],
            firmness: &firmness,
        };
        solid.build(&body.material, settings)
    }))
}

/// What each cell is made of: of the last region that holds its centre.
fn materials(body: &Inputs<'_>, grid: &CellGrid) -> Vec<Material> {
    let Inputs {
        spec,
        placement,
        material: common,
        ..
    } = body;
    let of_cell = |cell: &Cell| {
        let centre: Vector3 = cell
            .iter()
            .map(|&node| grid.nodes[node as usize].coords / 8.0)
            .sum();
        let centre = placement.inverse_transform_point(&Point3::from(centre));
        let region = spec
            .regions
            .iter()
            .rev()
            .find(|region| region.holds(&centre));
        region.map_or(*common, |region| Material {
            young_pa: region.young_pa.unwrap_or(common.young_pa),
            poisson: region.poisson.unwrap_or(common.poisson),
            density_kg_m3: region.density_kg_m3.unwrap_or(common.density_kg_m3),
            ..*common
        })
    };
    grid.cells.iter().map(of_cell).collect()
}
