//! Model `net`: a continuum on a finer grid of cells, moved by the control points and few shells
//! inside them.

use super::{Inputs, Model, cells, common};
use crate::body::Inside;
use crate::body::net::{self, Axis, Reduced};
use crate::scene::BodyModel;
use crate::scene::layout::layout;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::surface::{Closing, Direction, Surface};

/// Most coordinates that `refine = "auto"` makes: the matrix of a net is nearly full.
const NET_BUDGET: usize = 460;

pub(super) struct Net;

impl Model for Net {
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)> {
        common::deforming(body, NET_BUDGET, |surface| {
            common::solid(body, surface, Inside::SmoothContinuum, || {
                reduced(body, surface)
            })
        })
    }
}

/// Cells over finer knots than the surface's, moved by its net and shells of it, and the volume its
/// surface encloses.
fn reduced(body: &Inputs<'_>, surface: &Surface) -> Option<(Reduced, f64)> {
    let spec = body.spec;
    let per_span = spec.lattice.cells_per_span;
    let finer = |direction: Direction, knots: &KnotVector| {
        let spans = knots
            .spans()
            .map(|i| (knots.knots()[i], knots.knots()[i + 1]));
        let at = |(a, b): (f64, f64), k: usize| a + (b - a) * k as f64 / per_span as f64;
        let inner: Vec<f64> = spans
            .flat_map(|span| (1..per_span).map(move |k| at(span, k)))
            .collect();
        body.at
            .key("lattice")
            .key("cells_per_span")
            .take(surface.insert_knots(direction, &inner))
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
    let (points, weights) = (surface.net().points(), surface.weights());
    let Some(shape) = layout(surface, &topology) else {
        let (thickness_m, inward) = cells::sheet(body, surface)?;
        let shells = spec.layers();
        let depth = Axis::depth(
            shells,
            spec.lattice.cell_layers.unwrap_or(2 * (shells - 1)) + 1,
        );
        let reduced = net::sheet(
            points,
            weights,
            &inward,
            &axes[0],
            &axes[1],
            &depth,
            thickness_m,
        );
        let volume = reduced.grid.quality().volume_m3;
        return Some((reduced, volume));
    };
    let shells = spec.layers();
    let depth = Axis::depth(
        shells + 1,
        spec.lattice.cell_layers.unwrap_or(2 * shells) + 1,
    );
    let [around, along] = if shape.u_around {
        [&axes[0], &axes[1]]
    } else {
        [&axes[1], &axes[0]]
    };
    let reduced = net::rings(points, weights, &shape, around, along, &depth);
    let volume = if topology.is_closed() {
        surface.volume().abs()
    } else {
        reduced.grid.quality().volume_m3
    };
    Some((reduced, volume))
}
