//! Builders `transfinite` and `som`: a cube of nodes, the outermost of which ride on the surface of a body.

mod cube;
mod exterior;
mod harmonic;
mod som;
#[cfg(test)]
mod tests;
mod transfinite;
mod untangle;

pub use cube::{CubeError, CubeLattice};
pub use exterior::{CONDITION_LIMIT, ExteriorError, ExteriorMap, check_exterior, measure_exterior};
pub use som::{SomSettings, som};
pub use transfinite::{thick_sheet, transfinite};

use palpate_geometry::surface::Surface;
use palpate_sim::body::coordinates_of_surface;
use palpate_sim::body::net::Reduced;
use palpate_sim::scene::CellBuilder;
use palpate_sim::scene::spec::LatticeSpec;
use std::error::Error;

/// `builder = "transfinite"`: by a harmonic map; with a thickness also in a sheet.
#[derive(Clone, Copy, Debug)]
pub struct Transfinite;

/// `builder = "som"`: by a self-organising map.
#[derive(Clone, Copy, Debug)]
pub struct SelfOrganising;

impl CellBuilder for Transfinite {
    fn name(&self) -> &'static str {
        "transfinite"
    }

    fn cells(
        &self,
        surface: &Surface,
        lattice: &LatticeSpec,
    ) -> Result<(Reduced, f64), Box<dyn Error>> {
        let cube = match lattice.thickness_m {
            Some(thickness_m) if !surface.topology().is_closed() => {
                thick_sheet(surface, lattice.nodes, thickness_m)
            }
            _ => transfinite(surface, lattice.nodes),
        };
        riding(surface, cube?)
    }
}

impl CellBuilder for SelfOrganising {
    fn name(&self) -> &'static str {
        "som"
    }

    fn cells(
        &self,
        surface: &Surface,
        lattice: &LatticeSpec,
    ) -> Result<(Reduced, f64), Box<dyn Error>> {
        let settings = SomSettings {
            cycles: lattice.cycles,
            ..SomSettings::default()
        };
        riding(surface, som(surface, lattice.nodes, &settings)?)
    }
}

/// A cube of nodes, the outermost of which ride on the surface, and the volume that it encloses, m³.
fn riding(surface: &Surface, cube: CubeLattice) -> Result<(Reduced, f64), Box<dyn Error>> {
    let coordinate_of_control = coordinates_of_surface(surface);
    check_exterior(surface, &cube.exterior, &coordinate_of_control)?;
    let (map, coordinates) = cube.riding(surface, &coordinate_of_control);
    let volume = if surface.topology().is_closed() {
        surface.volume().abs()
    } else {
        cube.quality().volume_m3
    };
    let cells = Reduced {
        grid: cube.grid,
        map,
        coordinates,
        coordinate_of_control,
        patch_of_cell: Vec::new(),
    };
    Ok((cells, volume))
}
