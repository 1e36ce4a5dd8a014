//! Do the exterior nodes of a cube lattice see every control point?
//!
//! With x_node = Σ N_c(u, v) P_c over the coordinates c of the net, a coordinate that no node feels, or a pattern of them
//! that cancels at all nodes, has neither mass nor stiffness. The singular values of N (exterior nodes × coordinates)
//! tell: a mass matrix made of these rows has the square of their condition.

use crate::surface::Surface;
use nalgebra::{DMatrix, SymmetricEigen};

/// Largest condition of the exterior map that is let pass. Lattices that see the whole net have 10 to 100 (a 12³ on the
/// 8 × 8 teardrop: see the tests); nets as fine as the lattice have 1e4 and more, or no rank.
pub const CONDITION_LIMIT: f64 = 1e3;

/// How well the exterior nodes see a net.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExteriorMap {
    /// Exterior nodes.
    pub nodes: usize,
    /// Coordinates: control points, those that are tied counted once.
    pub coordinates: usize,
    /// Largest over least singular value of N; infinite when it has not full rank.
    pub condition: f64,
    /// Singular values above 1e-7 of the largest.
    pub rank: usize,
}

/// Why the exterior nodes cannot carry the net.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExteriorError {
    /// The numbers of coordinates are not one for each control point, or leave gaps.
    #[error(
        "{given} coordinate numbers for {controls} control points, the largest {largest:?}: give one for each control point, 0 and up without gaps"
    )]
    Ties {
        /// How many were given.
        given: usize,
        /// Control points.
        controls: usize,
        /// The largest, if any.
        largest: Option<u32>,
    },
    /// Some control points are not seen.
    #[error(
        "{count} of {coordinates} control points are not seen by the {nodes} exterior nodes (worst: control point {worst}, condition {condition:.3e}, limit {CONDITION_LIMIT:e}); take a finer lattice or a coarser net"
    )]
    UnseenControls {
        /// Coordinates, or patterns of them, that are seen too weakly.
        count: usize,
        /// Control point, u-major, that moves most in the pattern seen least.
        worst: usize,
        /// Largest over least singular value; infinite when a pattern is not seen at all.
        condition: f64,
        /// Exterior nodes.
        nodes: usize,
        /// Coordinates.
        coordinates: usize,
    },
}

/// Checks that nodes at these parameters see every coordinate of the net; `coordinate_of_control` as
/// [`coordinates_of_controls`](super::coordinates_of_controls) gives it. Offline: the cube of the number of coordinates.
///
/// # Errors
/// Coordinates that do not fit the net, or that are seen with a condition above [`CONDITION_LIMIT`].
pub fn check_exterior(
    surface: &Surface,
    exterior: &[(u32, [f64; 2])],
    coordinate_of_control: &[u32],
) -> Result<ExteriorMap, ExteriorError> {
    let (map, least) = exterior_map(surface, exterior, coordinate_of_control)?;
    if map.condition <= CONDITION_LIMIT {
        return Ok(map);
    }
    Err(ExteriorError::UnseenControls {
        count: least.count,
        worst: least.worst,
        condition: map.condition,
        nodes: map.nodes,
        coordinates: map.coordinates,
    })
}

/// The figures alone, however bad.
///
/// # Errors
/// Coordinates that do not fit the net.
pub fn measure_exterior(
    surface: &Surface,
    exterior: &[(u32, [f64; 2])],
    coordinate_of_control: &[u32],
) -> Result<ExteriorMap, ExteriorError> {
    Ok(exterior_map(surface, exterior, coordinate_of_control)?.0)
}

/// Weights of the control points at one place, as (control point, weight): they sum to one.
pub(super) fn weights_at(surface: &Surface, [u, v]: [f64; 2]) -> Vec<(usize, f64)> {
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

/// What is seen least.
struct Least {
    count: usize,
    worst: usize,
}

fn exterior_map(
    surface: &Surface,
    exterior: &[(u32, [f64; 2])],
    coordinate_of_control: &[u32],
) -> Result<(ExteriorMap, Least), ExteriorError> {
    let controls = surface.net().points().len();
    let largest = coordinate_of_control.iter().copied().max();
    let coordinates = largest.map_or(0, |k| k as usize + 1);
    let mut used = vec![false; coordinates.min(controls)];
    coordinate_of_control.iter().for_each(|&c| {
        if let Some(flag) = used.get_mut(c as usize) {
            *flag = true;
        }
    });
    if coordinate_of_control.len() != controls || coordinates > controls || used.contains(&false) {
        return Err(ExteriorError::Ties { given: coordinate_of_control.len(), controls, largest });
    }
    // NᵀN: the rows of N have a few entries each. Its eigenvalues are the squares of the singular values, so these are
    // known to 1e-8 of the largest, far below the limit.
    let mut normal = DMatrix::<f64>::zeros(coordinates, coordinates);
    for (_, uv) in exterior {
        let entries = weights_at(surface, *uv);
        for (i, a) in &entries {
            for (j, b) in &entries {
                normal[(coordinate_of_control[*i] as usize, coordinate_of_control[*j] as usize)] += a * b;
            }
        }
    }
    let nothing = Least { count: coordinates, worst: 0 };
    let unseen = ExteriorMap { nodes: exterior.len(), coordinates, condition: f64::INFINITY, rank: 0 };
    if !normal.iter().all(|x| x.is_finite()) {
        return Ok((unseen, nothing));
    }
    let Some(eigen) = SymmetricEigen::try_new(normal, f64::EPSILON, 100 * coordinates) else {
        return Ok((unseen, nothing));
    };
    let most = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let above = |share: f64| eigen.eigenvalues.iter().filter(|&&value| value > share * share * most).count();
    let rank = above(1e-7);
    let weakest = (0..coordinates).min_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b])).unwrap_or(0);
    let condition = if rank == coordinates { (most / eigen.eigenvalues[weakest]).sqrt() } else { f64::INFINITY };
    let pattern = eigen.eigenvectors.column(weakest).iamax();
    let worst = coordinate_of_control.iter().position(|&c| c as usize == pattern).unwrap_or(0);
    let map = ExteriorMap { nodes: exterior.len(), coordinates, condition, rank };
    Ok((map, Least { count: coordinates - above(1.0 / CONDITION_LIMIT), worst }))
}
