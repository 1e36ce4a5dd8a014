//! Model `membrane`: point masses at the control points of a surface, springs between neighbours, bending along rows.

use super::bends::Bend;
use super::cells::CellGrid;
use super::deformable::{Blueprint, Deformable, DeformableError, StepSettings};
use super::law::Law;
use super::material::Material;
use super::node_map::NodeMap;
use super::springs::{from_quads, quad_area};
use crate::math::Point3;

/// ν of a square net of springs.
const POISSON: f64 = 1.0 / 3.0;

/// Builds a membrane of a thickness (m) over rows × columns control points. `coordinate_of_control` says which of them are
/// one (seams and poles), `wraps` which directions go on with their first points after the last; `fixed[coordinate]` ones never move.
///
/// # Errors
/// No free coordinate, coordinates without mass, or a step that cannot be built.
pub fn membrane(
    points: &[Point3],
    [rows, columns]: [usize; 2],
    wraps: [bool; 2],
    coordinate_of_control: &[u32],
    material: &Material,
    thickness_m: f64,
    fixed: &[bool],
    settings: StepSettings,
) -> Result<Deformable, DeformableError> {
    let at = |row: usize, column: usize| coordinate_of_control[row % rows * columns + column % columns];
    let mut coordinates = vec![Point3::origin(); fixed.len()];
    for (point, &coordinate) in points.iter().zip(coordinate_of_control) {
        coordinates[coordinate as usize] = *point;
    }
    let mut quads = Vec::new();
    for row in 0..rows - usize::from(!wraps[0]) {
        for column in 0..columns - usize::from(!wraps[1]) {
            quads.push([at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)]);
        }
    }
    let mut areas = vec![0.0; coordinates.len()];
    // A sheet has no cells: its figures are those of the quadrilaterals times the thickness.
    let mut quality = CellGrid { nodes: Vec::new(), cells: Vec::new(), node_of_control: Vec::new() }.quality();
    (quality.least_volume_m3, quality.edge_m) = (f64::INFINITY, [f64::INFINITY, 0.0]);
    for quad in &quads {
        let area = quad_area(&coordinates, quad);
        quality.volume_m3 += area * thickness_m;
        quality.least_volume_m3 = quality.least_volume_m3.min(area * thickness_m);
        quad.iter().for_each(|&corner| areas[corner as usize] += 0.25 * area);
    }
    let springs = from_quads(&coordinates, &quads, material.young_pa * thickness_m);
    for spring in &springs {
        let length = spring.rest_length_m;
        quality.edge_m = [quality.edge_m[0].min(length), quality.edge_m[1].max(length)];
    }
    let plate = material.young_pa * thickness_m.powi(3) / (12.0 * (1.0 - POISSON * POISSON));
    let mut bends = Vec::new();
    let mut bend = |before: u32, middle: u32, after: u32| {
        if before != middle && middle != after && before != after {
            bends.extend(Bend::new([before, middle, after], &coordinates, plate, areas[middle as usize]));
        }
    };
    for row in 0..rows {
        for column in 0..columns {
            let middle = at(row, column);
            if let Some([before, after]) = around(row, rows, wraps[0], |r| at(r, column)) {
                bend(before, middle, after);
            }
            if let Some([before, after]) = around(column, columns, wraps[1], |c| at(row, c)) {
                bend(before, middle, after);
            }
        }
    }
    let masses = areas.iter().map(|area| area * thickness_m * material.density_kg_m3).collect();
    let blueprint = Blueprint {
        coordinates,
        map: NodeMap::Same,
        masses,
        law: Law::membrane(&springs, material.stiffening, bends),
        coordinate_of_control: coordinate_of_control.to_vec(),
        fixed: fixed.to_vec(),
        quality,
    };
    Deformable::new(blueprint, material.damping_s, material.plastic, settings)
}

/// Neighbours of place `k` of `count`; across the seam where the last place repeats the first.
fn around(k: usize, count: usize, wraps: bool, at: impl Fn(usize) -> u32) -> Option<[u32; 2]> {
    let closed = count > 3 && at(0) == at(count - 1);
    match k {
        k if wraps => Some([at(k + count - 1), at(k + 1)]),
        0 if closed => Some([at(count - 2), at(1)]),
        k if k > 0 && k + 1 < count => Some([at(k - 1), at(k + 1)]),
        _ => None,
    }
}
