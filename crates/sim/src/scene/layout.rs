//! How the control points of a surface lie around a solid.

use crate::body::layers::{RingEnds, Rings};
use crate::body::opposite::Medial;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{Closing, Surface, Topology};

/// Which direction goes around, and what its ends do; `None` for an open sheet.
pub(super) fn layout(surface: &Surface, topology: &Topology) -> Option<Rings> {
    let (rows, columns) = (surface.net().rows(), surface.net().columns());
    let [distinct_u, distinct_v] = distinct(surface, topology);
    let goes_round = |d: usize| matches!(topology.closing[d], Closing::Seam | Closing::Periodic);
    let length = |points: Vec<Point3>| {
        points
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum::<f64>()
    };
    let net = surface.net();
    let u_around = match (goes_round(0), goes_round(1)) {
        (false, false) => return None,
        (true, false) => true,
        (false, true) => false,
        (true, true) => {
            // A torus: the shorter way round is the tube.
            let along_u = length((0..rows).map(|i| *net.at(i, 0)).collect());
            let along_v = length((0..columns).map(|j| *net.at(0, j)).collect());
            along_u <= along_v
        }
    };
    let (around, along, axis_closed, poles) = if u_around {
        (distinct_u, distinct_v, goes_round(1), topology.poles[1])
    } else {
        (distinct_v, distinct_u, goes_round(0), topology.poles[0])
    };
    let ends = RingEnds {
        axis_closed,
        first_pole: poles[0],
        last_pole: poles[1],
    };
    let rings = Rings {
        around,
        along,
        ends,
        u_around,
        columns,
        medial: Medial::Curve,
    };
    Some(rings.with_medial(surface.net().points()))
}

/// True for a closed body whose layers stand between its two sides.
pub(super) fn is_flat(surface: &Surface) -> bool {
    layout(surface, &surface.topology()).is_some_and(|rings| rings.is_flat())
}

/// Control points in u and v, those repeated at a seam counted once.
pub(super) fn distinct(surface: &Surface, topology: &Topology) -> [usize; 2] {
    let repeated = |d: usize| usize::from(topology.closing[d] == Closing::Seam);
    [
        surface.net().rows() - repeated(0),
        surface.net().columns() - repeated(1),
    ]
}
