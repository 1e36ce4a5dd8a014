//! Gaps between two surfaces that are near each other and do not cross.

use super::cover::{CellId, Cover};
use super::grid::SAME_DEPTH;
use super::levels::nearest_in_cell;
use super::peaks::{Leaf, Peaks};
use palpate_geometry::contact::{Contact, ContactSet, ToolPoint};
use palpate_geometry::math::Vector3;

/// Local gaps within the margin, at the corners of cells whose spheres meet, against the other
/// side's triangles.
pub(super) fn gaps(
    pairs: &[[CellId; 2]],
    b: &mut Cover,
    t: &mut Cover,
    peaks: &mut Peaks,
    margin: f64,
    side: f64,
    set: &mut ContactSet,
) {
    peaks.leaves.clear();
    let mut k = 0;
    while k < pairs.len() {
        let id = pairs[k][0];
        let mut best: Option<(f64, Contact)> = None;
        while k < pairs.len() && pairs[k][0] == id {
            let found = gap(b, t, pairs[k], side);
            if found.0 <= margin && best.is_none_or(|best| found.0 < best.0) {
                best = Some(found);
            }
            k += 1;
        }
        if let Some((gap_m, contact)) = best {
            // A cell may come up in several runs of pairs: the nearest stays.
            let leaf = Leaf {
                id,
                depth_m: -gap_m,
                uv: [contact.u, contact.v],
                point: contact.on_body,
                normal: contact.normal,
            };
            match peaks.leaves.iter_mut().find(|other| other.id == id) {
                Some(other) if other.depth_m < leaf.depth_m => *other = leaf,
                Some(_) => {}
                None => peaks.leaves.push(leaf),
            }
        }
    }
    peaks.group(b, SAME_DEPTH * b.size_m);
    peaks.maxima(|leaf| {
        // The same pair again, for what a leaf does not carry.
        let pairs = pairs.iter().filter(|pair| pair[0] == leaf.id);
        let nearest = pairs
            .map(|&pair| gap(b, t, pair, side))
            .min_by(|x, y| x.0.total_cmp(&y.0));
        if let Some((_, contact)) = nearest {
            set.push(contact);
        }
    });
    peaks.rectangles(b, |rectangle| set.push_rectangle(rectangle));
}

/// The least gap between two cells that do not cross, by the corners of each and the triangles of
/// the other.
fn gap(b: &mut Cover, t: &mut Cover, [x, y]: [CellId; 2], side: f64) -> (f64, Contact) {
    let (p, q) = (
        (b.corners(x), b.parameters(x)),
        (t.corners(y), t.parameters(y)),
    );
    let mut best = (f64::INFINITY, [p.1[0], q.1[0]], [p.0[0], q.0[0]]);
    for k in 0..4 {
        let to_tool = nearest_in_cell(t, y, &p.0[k]);
        if to_tool.distance_m < best.0 {
            best = (
                to_tool.distance_m,
                [p.1[k], to_tool.uv],
                [p.0[k], to_tool.point],
            );
        }
        let to_body = nearest_in_cell(b, x, &q.0[k]);
        if to_body.distance_m < best.0 {
            best = (
                to_body.distance_m,
                [to_body.uv, q.1[k]],
                [to_body.point, q.0[k]],
            );
        }
    }
    let (gap_m, [[u, v], tool_uv], [on_body, on_tool]) = best;
    let normals = nearest_in_cell(b, x, &on_body).normals * side;
    let normal = (on_tool - on_body).try_normalize(1e-9 * b.size_m);
    let normal = normal
        .or_else(|| normals.try_normalize(0.0))
        .unwrap_or_else(Vector3::z);
    let on_tool = on_body + normal * gap_m;
    (
        gap_m,
        Contact {
            u,
            v,
            on_body,
            on_tool,
            normal,
            depth_m: -gap_m,
            tool_uv: Some(tool_uv),
            point: ToolPoint::Found,
        },
    )
}
