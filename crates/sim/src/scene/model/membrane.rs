//! Model `membrane`: a skin of springs between control points, bending along their rows.

use super::{Inputs, Make, Model, common, fixed};
use crate::body::{Sheet, coordinates_of_surface};
use crate::scene::BodyModel;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;

pub(super) struct Membrane;

impl Model for Membrane {
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)> {
        let thickness_m = body.spec.lattice.thickness_m.or_else(|| {
            body.at
                .key("lattice")
                .key("thickness_m")
                .refused("a membrane needs a thickness above 0; give lattice = { thickness_m = … }")
        });
        if !body.spec.regions.is_empty() {
            return body
                .at
                .key("region")
                .refused("a membrane is of one material; use model = \"lattice\"");
        }
        let thickness_m = thickness_m?;
        common::deforming(body, common::NODE_BUDGET, |surface| {
            parts(body, surface, thickness_m)
        })
    }
}

fn parts<'s>(body: &'s Inputs<'_>, surface: &Surface, thickness_m: f64) -> Option<Make<'s>> {
    let points = surface.net().points();
    let of_control = coordinates_of_surface(surface);
    let count = of_control.iter().max().map_or(0, |&last| last as usize + 1);
    let mut coordinates = vec![Point3::origin(); count];
    for (point, &coordinate) in points.iter().zip(&of_control) {
        coordinates[coordinate as usize] = *point;
    }
    let fixed = fixed::fixed(body, surface, &coordinates, &of_control, None);
    let sheet = Sheet::of_surface(surface, &of_control);
    let points = points.to_vec();
    Some(Box::new(move |settings| {
        crate::body::membrane(
            &points,
            &sheet,
            &of_control,
            &body.material,
            thickness_m,
            &fixed,
            settings,
        )
    }))
}
