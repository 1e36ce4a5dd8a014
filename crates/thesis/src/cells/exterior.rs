//! Do the exterior nodes of a cube lattice see every control point?
//!
//! With x_node = Σ N_c(u, v) P_c over the coordinates c of the net, a coordinate that no node
//! feels, or a pattern of them that cancels at all nodes, has neither mass nor stiffness. The
//! singular values of N (exterior nodes × coordinates) tell: a mass matrix made of these rows has
//! the square of their condition.

use nalgebra::{DMatrix, SymmetricEigen};
use palpate_geometry::surface::Surface;
use palpate_sim::body::weights_at;

/// Largest condition of the exterior map that is let pass; the mass matrix has the square of it. On
/// the teardrops, transfinite lattices with six exterior nodes to a coordinate have 26 to 390, with
/// three 700 to 1e4, with two 1e6.
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
        /// Number of coordinates.
        coordinates: usize,
    },
}

/// Checks that nodes at these parameters see every coordinate of the net; `coordinate_of_control`
/// as [`coordinates_of_controls`](palpate_sim::body::coordinates_of_controls) gives it. Offline: the cube of
/// the number of coordinates.
///
/// # Errors
/// Coordinates that do not fit the net, or that are seen with a condition above
/// [`CONDITION_LIMIT`].
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
        return Err(ExteriorError::Ties {
            given: coordinate_of_control.len(),
            controls,
            largest,
        });
    }
    let nothing = Least {
        count: coordinates,
        worst: 0,
    };
    let unseen = ExteriorMap {
        nodes: exterior.len(),
        coordinates,
        condition: f64::INFINITY,
        rank: 0,
    };
    if !exterior
        .iter()
        .all(|(_, [u, v])| u.is_finite() && v.is_finite())
    {
        return Ok((unseen, nothing));
    }
    // NᵀN: the rows of N have a few entries each. Its eigenvalues are the squares of the singular
    // values, so these are known to 1e-8 of the largest, far below the limit.
    let mut normal = DMatrix::<f64>::zeros(coordinates, coordinates);
    for (_, uv) in exterior {
        let entries = weights_at(surface, *uv);
        for (i, a) in &entries {
            for (j, b) in &entries {
                normal[(
                    coordinate_of_control[*i] as usize,
                    coordinate_of_control[*j] as usize,
                )] += a * b;
            }
        }
    }
    if normal.is_empty() || !normal.iter().all(|x| x.is_finite()) {
        return Ok((unseen, nothing));
    }
    let Some(eigen) = SymmetricEigen::try_new(normal, f64::EPSILON, 100 * coordinates) else {
        return Ok((unseen, nothing));
    };
    let most = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let above = |share: f64| {
        eigen
            .eigenvalues
            .iter()
            .filter(|&&value| value > share * share * most)
            .count()
    };
    let rank = above(1e-7);
    let weakest = (0..coordinates)
        .min_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]))
        .unwrap_or(0);
    let condition = if rank == coordinates {
        (most / eigen.eigenvalues[weakest]).sqrt()
    } else {
        f64::INFINITY
    };
    let pattern = eigen.eigenvectors.column(weakest).iamax();
    let worst = coordinate_of_control
        .iter()
        .position(|&c| c as usize == pattern)
        .unwrap_or(0);
    let map = ExteriorMap {
        nodes: exterior.len(),
        coordinates,
        condition,
        rank,
    };
    Ok((
        map,
        Least {
            count: coordinates - above(1.0 / CONDITION_LIMIT),
            worst,
        },
    ))
}

#[cfg(test)]
mod tests {
    use super::super::transfinite;
    use super::*;
    use palpate_geometry::surface::builtin;
    use palpate_sim::body::coordinates_of_controls;

    fn drop(net: usize) -> (Surface, Vec<u32>) {
        let surface = builtin("teardrop", Some([net; 2]), None).unwrap();
        let coordinates = coordinates_of_controls(surface.net().points(), &[]);
        (surface, coordinates)
    }

    // N assembled densely row by row, its singular values by another method.
    #[test]
    fn condition_and_rank_are_those_of_the_dense_map() {
        for (net, nodes) in [(8, 5), (8, 8), (8, 12), (12, 8), (12, 12)] {
            let (surface, coordinates) = drop(net);
            let lattice = transfinite(&surface, [nodes; 3]).unwrap();
            let map = measure_exterior(&surface, &lattice.exterior, &coordinates).unwrap();
            let mut dense = DMatrix::<f64>::zeros(lattice.exterior.len(), map.coordinates);
            for (row, (node, uv)) in lattice.exterior.iter().enumerate() {
                let mut point = palpate_geometry::math::Vector3::zeros();
                for (control, weight) in weights_at(&surface, *uv) {
                    dense[(row, coordinates[control] as usize)] += weight;
                    point += surface.net().points()[control].coords * weight;
                }
                let off = (point - lattice.grid.nodes[*node as usize].coords).norm();
                assert!(off < 1e-15, "node {node} is {off} m from Σ N P");
            }
            let singular = dense.singular_values();
            let exact = singular.max() / singular.min();
            // Eigenvalues of NᵀN have the square of the condition.
            assert!(
                (map.condition / exact - 1.0).abs() < 1e-14 * exact * exact,
                "{net}, {nodes}³: {map:?}, not {exact}"
            );
            assert_eq!(map.rank, map.coordinates);
        }
    }

    #[test]
    fn a_fine_enough_lattice_sees_the_net_and_a_coarse_one_says_what_to_do() {
        for nodes in [8, 10, 12, 15, 20] {
            let (surface, coordinates) = drop(8);
            let lattice = transfinite(&surface, [nodes; 3]).unwrap();
            let map = check_exterior(&surface, &lattice.exterior, &coordinates).unwrap();
            assert!(map.condition < 50.0, "{nodes}³: {map:?}");
        }
        let (surface, coordinates) = drop(20);
        // 296 nodes for 344 coordinates: at least 48 patterns are not seen.
        let lattice = transfinite(&surface, [8; 3]).unwrap();
        let error = check_exterior(&surface, &lattice.exterior, &coordinates).unwrap_err();
        let ExteriorError::UnseenControls {
            count,
            condition,
            nodes,
            coordinates: of,
            ..
        } = error.clone()
        else {
            panic!("{error}")
        };
        assert!(
            count >= 48 && condition == f64::INFINITY && (nodes, of) == (296, 344),
            "{error:?}"
        );
        assert!(
            error.to_string().contains("finer lattice or a coarser net"),
            "{error}"
        );
        let lattice = transfinite(&surface, [20; 3]).unwrap();
        check_exterior(&surface, &lattice.exterior, &coordinates).unwrap();
    }

    // One node alone, then all nodes but those that feel one control point.
    #[test]
    fn the_worst_control_point_is_the_one_left_out() {
        let (surface, coordinates) = drop(8);
        let lattice = transfinite(&surface, [20; 3]).unwrap();
        for hidden in [18, 27, 45] {
            let felt = |uv: [f64; 2]| {
                weights_at(&surface, uv)
                    .iter()
                    .any(|&(k, w)| coordinates[k] == coordinates[hidden] && w > 0.0)
            };
            let rest: Vec<_> = lattice
                .exterior
                .iter()
                .copied()
                .filter(|(_, uv)| !felt(*uv))
                .collect();
            let error = check_exterior(&surface, &rest, &coordinates).unwrap_err();
            let ExteriorError::UnseenControls { count, .. } = error else {
                panic!("{error}")
            };
            assert!(count >= 1);
            let map = measure_exterior(&surface, &rest, &coordinates).unwrap();
            assert!(map.rank < map.coordinates, "{map:?}");
        }
        let alone = check_exterior(&surface, &lattice.exterior[..1], &coordinates).unwrap_err();
        assert!(
            matches!(
                alone,
                ExteriorError::UnseenControls {
                    count: 43,
                    nodes: 1,
                    ..
                }
            ),
            "{alone:?}"
        );
    }

    #[test]
    fn coordinates_that_do_not_fit_are_refused_and_no_nodes_see_nothing() {
        let (surface, coordinates) = drop(8);
        let check =
            |numbers: &[u32]| check_exterior(&surface, &[(0, [0.5, 0.5])], numbers).unwrap_err();
        for numbers in [vec![], vec![0; 63], vec![1; 64], vec![u32::MAX; 64]] {
            assert!(
                matches!(check(&numbers), ExteriorError::Ties { .. }),
                "{numbers:?}"
            );
        }
        for exterior in [vec![], vec![(0, [f64::NAN, 0.5])]] {
            let error = check_exterior(&surface, &exterior, &coordinates).unwrap_err();
            assert!(
                matches!(error, ExteriorError::UnseenControls { count: 44, .. }),
                "{error:?}"
            );
        }
    }
}
