//! Surfaces of a running scene.

use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;

/// The surface of a body at rest.
///
/// # Errors
/// The body is a part.
pub fn rest_surface(scene: &Scene, body: usize) -> Result<&Surface, String> {
    (scene.rest_surface(body)).ok_or_else(|| {
        format!(
            "{:?} is a part, which has no B-spline surface: give a body that is one",
            scene.body_id(body)
        )
    })
}

/// The surface of a body as it is now; `None` of a part.
pub fn surface_now(scene: &Scene, state: &SceneState, body: usize) -> Option<Surface> {
    let mut surface = scene.rest_surface(body)?.clone();
    state.copy_net(scene, body, surface.net_mut().points_mut());
    Some(surface)
}

/// Rows of points over all of a surface, ends included: (rows × columns), u-major, and the
/// parameters of each.
pub fn grid(surface: &Surface, counts: [usize; 2]) -> Vec<(f64, f64, Point3)> {
    let ((a, b), (c, d)) = (surface.knots_u().domain(), surface.knots_v().domain());
    let at =
        |from: f64, to: f64, k: usize, n: usize| from + (to - from) * k as f64 / (n - 1) as f64;
    let [rows, columns] = counts;
    let mut points = Vec::with_capacity(rows * columns);
    for i in 0..rows {
        for j in 0..columns {
            let (u, v) = (at(a, b, i, rows), at(c, d, j, columns));
            points.push((u, v, surface.point(u, v)));
        }
    }
    points
}
