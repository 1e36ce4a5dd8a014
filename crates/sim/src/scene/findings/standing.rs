//! Where things stand when a scene starts: bodies in each other, tools in bodies, and bodies that nothing holds.

use super::{FindingKind, Found, mm, short};
use crate::body::Cell;
use crate::scene::spec::FixedSpec;
use crate::scene::{BodyModel, Scene};
use crate::solve::rows::Holder;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::skin::SkinSolver;

/// How far from a body a tool that is warned of starts, relative to the size of the body.
const CLEARANCE: f64 = 0.02;
/// Bodies of which one deforms may stand in each other by this share of the smaller one.
const MOST_OVERLAP: f64 = 0.05;

pub(super) fn look(scene: &Scene, found: &mut Found) {
    overlaps(scene, found);
    starting_inside(scene, found);
    held_by_nothing(scene, found);
    fixes_nothing(scene, found);
    regions_of_nothing(scene, found);
}

/// Bodies that stand in each other, of which one deforms: contact would press it out in one tick, with a force that no
/// material bears.
fn overlaps(scene: &Scene, found: &mut Found) {
    let bodies = |holder: Holder| matches!(holder, Holder::Body(_));
    if !scene.pairs.iter().any(|pair| bodies(pair.holder)) {
        return;
    }
    for (pair, depth_m) in scene.pairs.iter().zip(crate::tick::depths_at_start(scene)) {
        let Holder::Body(other) = pair.holder else {
            continue;
        };
        let [a, b] = [other as usize, pair.body];
        let deforms = [a, b].iter().any(|&body| scene.deforms(body));
        let least_m = scene.bodies[a].size_m.min(scene.bodies[b].size_m);
        if a != b && deforms && depth_m > MOST_OVERLAP * least_m {
            let [one, two] = [a, b].map(|body| &scene.bodies[body].id);
            found.add(
                FindingKind::Wrong,
                format!("body[{}].pose", a.max(b)),
                format!(
                    "bodies {one} and {two} stand {} in each other: they would be pressed apart in one tick; move one of them \
                     (`palpate surface isolate` finds how)",
                    mm(depth_m)
                ),
            );
        }
    }
}

/// Tools that begin in the solid of a body: a device that takes one feels that at once.
fn starting_inside(scene: &Scene, found: &mut Found) {
    for pair in &scene.pairs {
        let Some(t) = pair.tool() else { continue };
        let (tool, body) = (&scene.tools[t], &scene.bodies[pair.body]);
        if body.two_sided || matches!(tool.shape, ToolShape::Plane { .. }) {
            continue;
        }
        let at = tool.start.0;
        let foot = SkinSolver::new(&body.skin).closest(&body.skin, &at);
        let depth_m = tool.shape.ball_radius_m().unwrap_or(0.0) - foot.signed_distance;
        if depth_m > 0.0 {
            let [x, y, z] = (at + foot.normal * (depth_m + CLEARANCE * body.size_m)).into();
            found.limit(
                format!("tool[{t}].pose"),
                format!(
                    "tool {}: it starts {:.1} mm inside body {}; move its pose out of it, for example to position = \
                     [{x:.4}, {y:.4}, {z:.4}]",
                    tool.id,
                    depth_m * 1e3,
                    body.id
                ),
            );
        }
    }
}

/// A body that the first touch sends away for ever, or that falls, with nothing that it could meet.
fn held_by_nothing(scene: &Scene, found: &mut Found) {
    let is_floor = |tool: usize| {
        matches!(scene.tools[tool].shape, ToolShape::Plane { .. }) && !scene.cuts(tool)
    };
    let floor = (0..scene.tools.len()).any(is_floor);
    if floor || scene.bodies.len() > 1 || scene.spec.gravity.frame.is_some() {
        return;
    }
    let (body, spec) = (&scene.bodies[0], &scene.spec.bodies[0]);
    let launched = spec.velocity_m_s != [0.0; 3] || spec.spin_rad_s != [0.0; 3];
    if launched || scene.free_mass_kg(0).is_none() {
        return;
    }
    let goes = match Vector3::from(scene.spec.gravity.acceleration) == Vector3::zeros() {
        true => "the first touch pushes it away for good",
        false => "it falls for ever",
    };
    let what = match body.model {
        BodyModel::Rigid => "drop free, or add a body that it lies on",
        BodyModel::Deforming(_) => {
            "hold a part of it, fixed = [{ point = […], normal = […] }], or add a body that it lies on"
        }
    };
    found.unusual(
        "body[0]",
        format!("nothing holds body {}: {goes}; {what}", body.id),
    );
}

/// Planes that hold no part of their body.
fn fixes_nothing(scene: &Scene, found: &mut Found) {
    for (b, (body, spec)) in scene.bodies.iter().zip(&scene.spec.bodies).enumerate() {
        let BodyModel::Deforming(model) = &body.model else {
            continue;
        };
        let placed = scene.placement(b);
        let rest = model.deformable.rest();
        let nodes = model.deformable.nodes(rest);
        for (k, fixed) in spec.fixed.iter().enumerate() {
            let FixedSpec::Plane { point, normal } = fixed else {
                continue;
            };
            let (point, normal) = (
                placed * Point3::from(*point),
                placed * Vector3::from(*normal),
            );
            let nearest_m = (rest.iter().chain(&nodes))
                .map(|p| (p - point).dot(&normal) / normal.norm())
                .fold(f64::INFINITY, f64::min);
            if nearest_m > 0.0 {
                found.unusual(
                    format!("body[{b}].fixed[{k}]"),
                    format!(
                        "this plane holds nothing of body {}, whose nearest point is {} m in front of it; points are in m, \
                         in the body's frame, and what lies against the normal is held",
                        body.id,
                        short(nearest_m)
                    ),
                );
            }
        }
    }
}

/// Parts of another material in which their body has no cell.
fn regions_of_nothing(scene: &Scene, found: &mut Found) {
    for (b, (body, spec)) in scene.bodies.iter().zip(&scene.spec.bodies).enumerate() {
        let BodyModel::Deforming(model) = &body.model else {
            continue;
        };
        let nodes = model.deformable.nodes(model.deformable.rest());
        let back = scene.placement(b).inverse();
        let cells = model.deformable.cells().iter();
        let centre = |cell: &Cell| {
            let sum: Vector3 = cell.iter().map(|&node| nodes[node as usize].coords).sum();
            back * Point3::from(sum / cell.len() as f64)
        };
        let centres: Vec<Point3> = cells.map(centre).collect();
        for (r, region) in spec.regions.iter().enumerate() {
            if !centres.is_empty() && !centres.iter().any(|centre| region.holds(centre)) {
                found.unusual(
                    format!("body[{b}].region[{r}]"),
                    format!(
                        "this region holds the centre of no cell of body {}: it is elsewhere (m, in the body's frame), or smaller \
                         than the cells",
                        body.id
                    ),
                );
            }
        }
    }
}
