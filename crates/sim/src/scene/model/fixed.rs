//! Which coordinates of a body never move.

use super::Inputs;
use super::values::Held;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;

/// Which coordinates never move.
pub(super) fn fixed(
    body: &Inputs<'_>,
    surface: &Surface,
    coordinates: &[Point3],
    of_control: &[u32],
) -> Vec<bool> {
    let Inputs {
        held, placement, ..
    } = body;
    let mut fixed = vec![false; coordinates.len()];
    let behind = |fixed: &mut Vec<bool>, point: Point3, normal: Vector3| {
        for (flag, place) in fixed.iter_mut().zip(coordinates) {
            *flag |= (place - point).dot(&normal) <= 0.0;
        }
    };
    for held in held {
        match *held {
            Held::Behind { point, normal } => {
                behind(&mut fixed, placement * point, placement * normal);
            }
            Held::Range { u, v } => {
                let within = |x: f64, [from, to]: [f64; 2]| x >= from && x <= to;
                let (us, vs) = (surface.knots_u().greville(), surface.knots_v().greville());
                for (control, &coordinate) in of_control.iter().enumerate() {
                    fixed[coordinate as usize] |=
                        within(us[control / vs.len()], u) && within(vs[control % vs.len()], v);
                }
            }
        }
    }
    // A tool that cannot be built is reported where it stands.
    for (tool, spec) in body.tools.iter().zip(&body.scene.tools) {
        if let (true, Some(tool)) = (spec.fixes_nodes, tool)
            && let ToolShape::Plane { normal } = tool.shape
        {
            let (at, turn) = tool.start;
            behind(&mut fixed, at, turn * normal);
        }
    }
    fixed
}
