//! Cells inside a surface, by the builder that the scene names.

use super::Inputs;
use crate::body::layers;
use crate::body::net::Reduced;
use crate::body::{CellGrid, NodeMap};
use crate::scene::layout::{is_flat, layout};
use crate::scene::spec::{BuilderSpec, ModelSpec};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::Surface;

/// The cells, what moves them, and the volume that the surface encloses, m³.
pub(super) fn of_builder<'a>(
    body: &'a Inputs<'_>,
    surface: &'a Surface,
) -> impl FnOnce() -> Option<(Reduced, f64)> + 'a {
    move || match body.spec.lattice.builder {
        BuilderSpec::Layers => layered(body, surface),
        builder @ (BuilderSpec::Transfinite | BuilderSpec::Som) => {
            let at = body.at.key("lattice");
            let builder = at.methods().cell_builder(builder.name(), &at)?;
            at.take(builder.cells(surface, &body.spec.lattice))
        }
    }
}

/// True for layers between the two sides of a flat body.
pub(super) fn has_flat_layers(body: &Inputs<'_>, surface: &Surface) -> bool {
    body.spec.lattice.builder == BuilderSpec::Layers && is_flat(surface)
}

/// Layers of nodes, which are the coordinates, and the volume that the surface encloses.
fn layered(body: &Inputs<'_>, surface: &Surface) -> Option<(Reduced, f64)> {
    let (grid, volume) = cells(body, surface)?;
    let (coordinates, coordinate_of_control) = (grid.nodes.clone(), grid.node_of_control.clone());
    Some((
        Reduced {
            grid,
            map: NodeMap::Same,
            coordinates,
            coordinate_of_control,
            patch_of_cell: Vec::new(),
        },
        volume,
    ))
}

/// Cells of a body and the volume its surface encloses.
fn cells(body: &Inputs<'_>, surface: &Surface) -> Option<(CellGrid, f64)> {
    let topology = surface.topology();
    let points = surface.net().points();
    let columns = surface.net().columns();
    let count = body.spec.layers();
    let Some(shape) = layout(surface, &topology) else {
        let (thickness_m, inward) = sheet(body, surface)?;
        let grid = layers::sheet(
            points,
            &inward,
            surface.net().rows(),
            columns,
            count,
            thickness_m,
        );
        let volume = grid.quality().volume_m3;
        return Some((grid, volume));
    };
    debug_assert!(count >= 1, "the number of layers was checked");
    let grid = match body.spec.model() {
        ModelSpec::Continuum => layers::rings_for_continuum(points, &shape, count),
        _ => layers::rings_at_best(points, &shape, count),
    };
    // An open tube encloses nothing by itself; its cells then say how much it holds.
    let volume = if topology.is_closed() {
        surface.volume().abs()
    } else {
        grid.quality().volume_m3
    };
    Some((grid, volume))
}

/// Thickness of an open sheet and its inward normals at control points.
pub(super) fn sheet(body: &Inputs<'_>, surface: &Surface) -> Option<(f64, Vec<Vector3>)> {
    let (lattice, at) = (&body.spec.lattice, body.at.key("lattice"));
    let thickness_m = lattice.thickness_m.or_else(|| {
        at.key("thickness_m")
            .refused("an open sheet needs a thickness above 0; give lattice = { thickness_m = … }")
    });
    let layers = body.spec.layers();
    if layers < 2 {
        return at.key("layers").refused(format!(
            "layers is {layers}; an open sheet needs at least 2"
        ));
    }
    let (us, vs) = (surface.knots_u().greville(), surface.knots_v().greville());
    let places = us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v)));
    Some((
        thickness_m?,
        places.map(|(u, v)| -surface.normal(u, v)).collect(),
    ))
}
