//! What the parts cost: force passes over cubes, and building a body.

use super::super::measure::{clocked, time};
use super::{Effort, Row};
use palpate_geometry::math::{Point3, Rows};
use palpate_geometry::surface::builtin;
use palpate_sim::body::{
    CellGrid, ContinuumLaw, Elastic, Inside, Integrator, Material, Solid, StepSettings, layers,
    preset,
};
use palpate_thesis::cells::{CubeLattice, SomSettings, som, transfinite};
use std::time::Duration;

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for nodes in [10, 15, 30] {
        let case = format!("pass/{nodes}");
        if wanted(&case) {
            springs(&case, nodes, effort, out);
            if nodes < 30 || effort == Effort::Full {
                continuum(&case, nodes, effort, out);
            }
        }
    }
    builds(effort, wanted, out);
}

fn calls(effort: Effort) -> (usize, Duration) {
    if effort == Effort::Quick {
        (200, Duration::from_millis(200))
    } else {
        (5_000, Duration::from_secs(5))
    }
}

/// A cube of 0.1 m, its lowest nodes fixed.
fn cube(nodes: usize) -> (CellGrid, Vec<bool>) {
    let high = Point3::new(0.1, 0.1, 0.1);
    let cube = CellGrid::cuboid(&Point3::origin(), &high, [nodes; 3]);
    let fixed = cube.nodes.iter().map(|p| p.z <= 1e-9).collect();
    (cube, fixed)
}

/// One pass over the springs of a cube, as explicit steps do many; error: the sum of all forces,
/// which is zero.
fn springs(case: &str, nodes: usize, effort: Effort, out: &mut dyn FnMut(Row)) {
    let (cube, fixed) = cube(nodes);
    let Some(gel) = preset("gel") else {
        return;
    };
    let material: Material = gel.material;
    let settings = StepSettings {
        dt_s: 1e-4,
        integrator: Integrator::Explicit { substeps: 1 },
        sleep_m_s: 0.0,
    };
    let solid = Solid::whole(&cube, &fixed, 1e-3, Inside::Springs, |_| material);
    let Ok(body) = solid.build(&material, settings) else {
        return;
    };
    let mut state = body.rest_state();
    for (k, p) in state.positions.iter_mut().enumerate() {
        p.x += 1e-4 * libm::sin(k as f64);
    }
    let mut scratch = body.scratch();
    let (n, patience) = calls(effort);
    let times = time(n, patience, |_| {
        clocked(|| body.internal_forces(&state, &mut scratch)[0][0]).0
    });
    let forces = body.internal_forces(&state, &mut scratch);
    let (mut sum, mut largest) = ([0.0; 3], 0.0_f64);
    for force in forces {
        for c in 0..3 {
            sum[c] += force[c];
            largest = largest.max(force[c].abs());
        }
    }
    let miss = sum.iter().fold(0.0_f64, |worst, x| worst.max(x.abs())) / largest;
    let note = format!(
        "{} springs, {:.2} ns a spring",
        body.spring_count(),
        times.median_s * 1e9 / body.spring_count() as f64
    );
    let row = Row::new("deformation", case, "springs").timed(times);
    out(row.off_by(miss, "of the largest force").saying(note));
}

fn continuum(case: &str, nodes: usize, effort: Effort, out: &mut dyn FnMut(Row)) {
    let (cube, _) = cube(nodes);
    let elastic = vec![
        Elastic {
            young_pa: 20e3,
            poisson: 0.3
        };
        cube.cells.len()
    ];
    let Ok(continuum) = ContinuumLaw::new(&cube, &elastic) else {
        return;
    };
    let places: Rows = cube
        .nodes
        .iter()
        .enumerate()
        .map(|(k, p)| [p.x + 1e-4 * libm::sin(k as f64), p.y, p.z, 0.0])
        .collect();
    let mut residual = Rows::zeros(places.len());
    let (n, patience) = calls(effort);
    let times = time(n, patience, |_| {
        clocked(|| continuum.add_forces(&places, &mut residual)).0
    });
    let note = format!(
        "{} cells, {:.1} ns a cell",
        cube.cells.len(),
        times.median_s * 1e9 / cube.cells.len() as f64
    );
    let row = Row::new("deformation", case, "continuum");
    out(row.timed(times).saying(note));
}

/// Lattices in the teardrop; error: volume of the cells against that of the surface.
fn builds(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    let Ok(surface) = builtin("teardrop", Some([8, 8]), None) else {
        return;
    };
    let enclosed = surface.volume();
    let mut cube = |case: &str, method: &str, build: &dyn Fn() -> Option<CubeLattice>| {
        if !wanted(case) {
            return;
        }
        let mut made = None;
        let times = time(
            if effort == Effort::Quick { 1 } else { 5 },
            Duration::from_secs(20),
            |_| {
                let (took, lattice) = clocked(build);
                made = lattice;
                took
            },
        );
        let Some(lattice) = made else { return };
        let quality = lattice.quality();
        let note = format!(
            "least scaled Jacobian {:.3}, edge spread {:.2}, {} folded",
            quality.least_scaled_jacobian, quality.edge_spread, quality.folded_cells
        );
        let row = Row::new("deformation", case, method).timed(times);
        let error = quality.volume_error(enclosed);
        out(row.off_by(error, "of the volume").saying(note));
    };
    for nodes in [12, 30] {
        cube(
            &format!("build/transfinite/{nodes}"),
            "transfinite",
            &|| transfinite(&surface, [nodes; 3]).ok(),
        );
    }
    let sides: &[usize] = if effort == Effort::Quick {
        &[12]
    } else {
        &[10, 12, 20, 30]
    };
    for &nodes in sides {
        let build = || som(&surface, [nodes; 3], &SomSettings::default()).ok();
        cube(&format!("build/som/{nodes}"), "som", &build);
    }
    let case = "build/layers/22x23x4";
    if wanted(case) {
        let Ok(fine) = surface.refined_to(22, 23) else {
            return;
        };
        let rings = layers::Rings {
            around: 22,
            along: 23,
            ends: layers::RingEnds {
                axis_closed: false,
                first_pole: true,
                last_pole: true,
            },
            u_around: true,
            columns: fine.net().columns(),
            medial: Default::default(),
        };
        let build = || layers::rings_at_best(fine.net().points(), &rings, 4);
        let mut grid = None;
        let times = time(5, Duration::from_secs(5), |_| {
            let (took, made) = clocked(build);
            grid = Some(made);
            took
        });
        let Some(quality) = grid.map(|grid| grid.quality()) else {
            return;
        };
        let note = format!(
            "least scaled Jacobian {:.3} (cells with eight corners), edge spread {:.2}, {} folded",
            quality.least_scaled_jacobian_hexahedra, quality.edge_spread, quality.folded_cells
        );
        let row = Row::new("deformation", case, "layers").timed(times);
        let error = quality.volume_error(enclosed);
        out(row.off_by(error, "of the volume").saying(note));
    }
}
