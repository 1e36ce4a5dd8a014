//! What a place of a surface takes of its control points, and of the coordinates that these are.

use palpate_geometry::surface::Surface;

/// Weights of the control points at one place, as (control point, weight): they sum to one.
pub fn weights_at(surface: &Surface, [u, v]: [f64; 2]) -> Vec<(usize, f64)> {
    let (wu, wv) = (surface.knots_u().window(u), surface.knots_v().window(v));
    let (rows, columns) = (surface.net().rows(), surface.net().columns());
    let mut entries = Vec::with_capacity(wu.len * wv.len);
    for (a, n) in wu.values().iter().enumerate() {
        for (b, m) in wv.values().iter().enumerate() {
            let k = (wu.first + a) % rows * columns + (wv.first + b) % columns;
            entries.push((k, n * m * surface.weights().map_or(1.0, |w| w[k])));
        }
    }
    let total: f64 = entries.iter().map(|(_, weight)| weight).sum();
    entries.iter_mut().for_each(|(_, weight)| *weight /= total);
    entries
}

/// Weights of the coordinates at one place: they sum to one. `of_control`: coordinates of the control points, u-major.
pub(super) fn coordinates_at(
    surface: &Surface,
    at: [f64; 2],
    of_control: &[u32],
) -> Vec<(u32, f64)> {
    debug_assert_eq!(
        of_control.len(),
        surface.net().points().len(),
        "a coordinate a control point"
    );
    let each = weights_at(surface, at).into_iter();
    each.map(|(k, weight)| (of_control[k], weight)).collect()
}
