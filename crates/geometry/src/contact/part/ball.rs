use super::*;
use crate::contact::*;
use crate::math::*;
pub fn contacts(
    side: PartSide<'_>,
    centre: &Point3,
    radius_m: f64,
    reach: &Reach,
    _: &mut PartScratch,
    out: &mut ContactSet,
) {
    let q = side.pose.inverse_transform_point(centre);
    if let Some(foot) = side.solver.closest(side.part, &q) {
        let d = foot.signed_distance.unwrap_or(foot.distance);
        if radius_m - d >= -reach.margin_m {
            let normal = side.pose.rotation
                * (if foot.distance > 1e-12 {
                    (q - foot.point) / d
                } else {
                    foot.normal
                });
            let on_body = side.pose * foot.point;
            let depth_m = radius_m - d;
            out.push(Contact {
                u: foot.place[0],
                v: foot.place[1],
                on_body,
                on_tool: on_body - normal * depth_m,
                normal,
                depth_m,
                tool_uv: None,
                point: ToolPoint::Found,
            });
        }
    }
}
