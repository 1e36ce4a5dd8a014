//! Model `membrane`: point masses at the control points of a surface, springs between neighbours,
//! bending along rows.

use super::cells::CellGrid;
use super::deformable::Deformable;
use super::elements::Bend;
use super::elements::MaterialLaw;
use super::elements::springs::{from_quads, quad_area};
use super::material::Material;
use super::matter::Blueprint;
use super::node_map::NodeMap;
use super::settings::{DeformableError, StepSettings};
use super::sheet::{Row, Sheet};
use super::ties::coordinates_of_surface;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;

/// ν of a square net of springs.
const POISSON: f64 = 1.0 / 3.0;

/// Builds a membrane of a thickness (m) over control points and their neighbours.
/// `coordinate_of_control` says which of them are one (seams, poles, joints); `fixed[coordinate]`
/// ones never move.
///
/// # Errors
/// No free coordinate, coordinates without mass, or a step that cannot be built.
pub fn membrane(
    points: &[Point3],
    sheet: &Sheet,
    coordinate_of_control: &[u32],
    material: &Material,
    thickness_m: f64,
    fixed: &[bool],
    settings: StepSettings,
) -> Result<Deformable, DeformableError> {
    debug_assert_eq!(
        points.len(),
        coordinate_of_control.len(),
        "a coordinate a point"
    );
    let mut coordinates = vec![Point3::origin(); fixed.len()];
    for (point, &coordinate) in points.iter().zip(coordinate_of_control) {
        coordinates[coordinate as usize] = *point;
    }
    let quads = &sheet.quads;
    let mut areas = vec![0.0; coordinates.len()];
    // A sheet has no cells: its figures are those of the quadrilaterals times the thickness.
    let mut quality = CellGrid {
        nodes: Vec::new(),
        cells: Vec::new(),
        node_of_control: Vec::new(),
    }
    .quality();
    (quality.least_volume_m3, quality.edge_m) = (f64::INFINITY, [f64::INFINITY, 0.0]);
    for quad in quads {
        let area = quad_area(&coordinates, quad);
        quality.volume_m3 += area * thickness_m;
        quality.least_volume_m3 = quality.least_volume_m3.min(area * thickness_m);
        quad.iter()
            .for_each(|&corner| areas[corner as usize] += 0.25 * area);
    }
    let springs = from_quads(&coordinates, quads, material.young_pa * thickness_m);
    for spring in &springs {
        let length = spring.rest_length_m;
        quality.edge_m = [quality.edge_m[0].min(length), quality.edge_m[1].max(length)];
    }
    let plate = material.young_pa * thickness_m.powi(3) / (12.0 * (1.0 - POISSON * POISSON));
    let bend = |row: &Row| Bend::new(row, &coordinates, plate, areas[row.middle as usize]);
    let bends = sheet.rows.iter().filter_map(bend).collect();
    let masses = areas
        .iter()
        .map(|area| area * thickness_m * material.density_kg_m3)
        .collect();
    let blueprint = Blueprint {
        coordinates,
        map: NodeMap::Same,
        masses,
        law: MaterialLaw::membrane(&springs, material.stiffening, bends),
        coordinate_of_control: coordinate_of_control.to_vec(),
        fixed: fixed.to_vec(),
        quality,
        cells: Vec::new(),
        young_pa: Vec::new(),
        grains: Vec::new(),
    };
    Deformable::new(blueprint, material.damping_s, material.plastic, settings)
}

/// The area that counts for a membrane's mass: of the quadrilaterals between the control points of its surface, m².
pub fn membrane_area_m2(surface: &Surface) -> f64 {
    let points = surface.net().points();
    let of_control = coordinates_of_surface(surface);
    let sheet = Sheet::of_surface(surface, &of_control);
    let mut coordinates = vec![Point3::origin(); points.len()];
    for (point, &coordinate) in points.iter().zip(&of_control) {
        coordinates[coordinate as usize] = *point;
    }
    let area = |quad| quad_area(&coordinates, quad);
    sheet.quads.iter().map(area).sum()
}
