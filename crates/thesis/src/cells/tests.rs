//! Tests of the builders of cube lattices, on one set of surfaces.

use super::{CubeError, CubeLattice, SomSettings, som, thick_sheet, transfinite};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Matrix3, Point3, Pose, Rotation, Vector3};
use palpate_geometry::surface::{ControlNet, Surface, builtin, file};

const RATIONAL: &str = include_str!("../../../geometry/src/surface/data/teardrop_8_rational.json");

fn drop(net: usize) -> Surface {
    builtin("teardrop", Some([net; 2]), None).unwrap()
}

fn bodies() -> Vec<(&'static str, Surface)> {
    vec![
        ("teardrop 8", drop(8)),
        ("teardrop 12", drop(12)),
        ("teardrop 20", drop(20)),
        (
            "rational teardrop",
            file::read(RATIONAL).unwrap().with_exact_seams(),
        ),
        ("sphere", builtin("sphere", None, None).unwrap()),
        ("teardrop, u and v swapped", drop(8).swap_uv()),
        (
            "mirrored teardrop",
            drop(8)
                .affine(
                    &Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0)),
                    &Vector3::zeros(),
                )
                .unwrap(),
        ),
        ("tilted teardrop", tilted(&drop(8))),
    ]
}

type Builder = fn(&Surface, [usize; 3]) -> Result<CubeLattice, CubeError>;

fn learned(surface: &Surface, counts: [usize; 3]) -> Result<CubeLattice, CubeError> {
    som(surface, counts, &SomSettings::default())
}

const BUILDERS: [(&str, Builder); 2] = [("transfinite", transfinite), ("som", learned)];

/// Turned, moved and scaled so that nothing is aligned with an axis.
fn tilted(surface: &Surface) -> Surface {
    let rotation = Rotation::from_euler_angles(0.3, -1.1, 2.0);
    surface.transformed(&Pose::from_parts(
        Vector3::new(0.3, -0.2, 0.7).into(),
        rotation,
    ))
}

#[test]
fn every_cell_is_positive_and_every_exterior_node_lies_at_its_own_place_on_the_surface() {
    for (name, surface) in &bodies() {
        for (builder, build) in BUILDERS {
            for counts in [[2; 3], [3; 3], [5; 3], [8; 3], [12; 3], [6, 7, 12]] {
                let what = format!("{builder}, {name}, {counts:?}");
                let lattice =
                    build(surface, counts).unwrap_or_else(|error| panic!("{what}: {error}"));
                let quality = lattice.quality();
                assert_eq!(quality.folded_cells, 0, "{what}");
                assert!(
                    lattice
                        .grid
                        .cells
                        .iter()
                        .all(|cell| lattice.grid.signed_volume(cell) > 0.0),
                    "{what}"
                );
                let total: usize = counts.iter().product();
                let inner: usize = counts.iter().map(|n| n - 2).product();
                assert_eq!(
                    (lattice.grid.nodes.len(), lattice.interior.len()),
                    (total, inner),
                    "{what}"
                );
                assert_eq!(lattice.exterior.len(), total - inner, "{what}");
                let mut places = Vec::new();
                for (node, [u, v]) in &lattice.exterior {
                    let x = lattice.grid.nodes[*node as usize];
                    assert_eq!(
                        x,
                        surface.point(*u, *v),
                        "{what}: node {node} is off the surface"
                    );
                    places.push(x);
                }
                // One to one: no two exterior nodes share a place.
                places.sort_by(|a, b| a.x.total_cmp(&b.x));
                for (k, a) in places.iter().enumerate() {
                    let beside = places[k + 1..]
                        .iter()
                        .take_while(|b| b.x - a.x < 1e-6 * surface.size());
                    let nearest = beside.map(|b| (a - b).norm()).fold(f64::INFINITY, f64::min);
                    assert!(
                        nearest > 1e-6 * surface.size(),
                        "{what}: two nodes {nearest} m apart"
                    );
                }
            }
        }
    }
}

// Chords under a smooth surface: the volume lacks a term in h².
#[test]
fn the_volume_error_falls_with_the_square_of_the_step() {
    for (name, surface) in [
        ("teardrop", drop(8)),
        ("sphere", builtin("sphere", None, None).unwrap()),
    ] {
        let volume = surface.volume();
        let error = |n: usize| {
            transfinite(&surface, [n; 3])
                .unwrap()
                .quality()
                .volume_error(volume)
        };
        let (coarse, fine) = (error(9), error(17));
        let order = libm::log2(coarse / fine);
        assert!(
            (1.9..2.1).contains(&order),
            "{name}: {coarse} to {fine} is order {order}"
        );
    }
}

#[test]
fn mirrored_and_turned_bodies_have_the_same_figures_and_a_sphere_gets_a_symmetric_lattice() {
    let reference = transfinite(&drop(8), [9; 3]).unwrap().quality();
    for (name, surface) in bodies().into_iter().skip(5) {
        let quality = transfinite(&surface, [9; 3]).unwrap().quality();
        let pairs = [
            (quality.volume_m3, reference.volume_m3),
            (quality.least_volume_m3, reference.least_volume_m3),
            (quality.edge_m[0], reference.edge_m[0]),
            (quality.edge_spread, reference.edge_spread),
        ];
        for (a, b) in pairs {
            assert!(
                (a - b).abs() < 1e-9 * b.abs(),
                "{name}: {quality:?} is not {reference:?}"
            );
        }
        assert!(
            (quality.least_scaled_jacobian - reference.least_scaled_jacobian).abs() < 1e-9,
            "{name}: {quality:?}"
        );
    }
    let sphere = transfinite(&builtin("sphere", None, Some(1.0)).unwrap(), [7; 3]).unwrap();
    for i in 0..7 {
        for j in 0..7 {
            for k in 0..7 {
                let at = |[i, j, k]: [usize; 3]| sphere.grid.nodes[(i * 7 + j) * 7 + k];
                let [x, below] = [at([i, j, k]), at([i, j, 6 - k])];
                assert!(
                    (x - Point3::new(below.x, below.y, -below.z)).norm() < 1e-12,
                    "({i}, {j}, {k}) and below"
                );
                let opposite = at([6 - i, 6 - j, 6 - k]);
                assert!(
                    (x.coords + opposite.coords).norm() < 1e-12,
                    "({i}, {j}, {k}) and opposite"
                );
            }
        }
    }
}

#[test]
fn builders_give_the_same_bits_twice() {
    for (builder, build) in BUILDERS {
        let [first, second] = [0, 1].map(|_| build(&drop(12), [10; 3]).unwrap());
        assert_eq!(first.exterior, second.exterior, "{builder}");
        assert_eq!(first.grid.nodes, second.grid.nodes, "{builder}");
    }
}

// The cells at the corners of the cube cannot be larger than the others allow; the learned map
// spreads its nodes at least as evenly as the mapped one.
#[test]
fn a_learned_lattice_is_as_good_as_a_mapped_one_and_stays_so_with_more_cycles() {
    for cycles in [100, 300] {
        for net in [8, 20] {
            let settings = SomSettings {
                cycles,
                ..SomSettings::default()
            };
            let learned = som(&drop(net), [10; 3], &settings).unwrap().quality();
            let mapped = transfinite(&drop(net), [10; 3]).unwrap().quality();
            let what = format!("{cycles} cycles, net {net}: {learned:?}, mapped {mapped:?}");
            assert!(learned.edge_spread < mapped.edge_spread, "{what}");
            assert!(
                learned.least_volume_m3 > 0.5 * mapped.least_volume_m3,
                "{what}"
            );
            let volume = drop(net).volume();
            assert!(
                learned.volume_error(volume).abs() < 1.05 * mapped.volume_error(volume).abs(),
                "{what}"
            );
        }
    }
}

#[test]
fn a_flat_sheet_becomes_boxes_and_a_sharply_bent_one_is_refused() {
    let sheet = builtin("sheet", None, Some(0.2)).unwrap();
    let lattice = thick_sheet(&sheet, [6, 5, 3], 0.01).unwrap();
    let quality = lattice.quality();
    assert!(
        (quality.least_scaled_jacobian - 1.0).abs() < 1e-9,
        "{quality:?}"
    );
    assert!(
        (quality.volume_m3 - 0.2 * 0.2 * 0.01).abs() < 1e-12 * 0.04,
        "{quality:?}"
    );
    assert_eq!((lattice.exterior.len(), lattice.interior.len()), (30, 60));
    for (node, [u, v]) in &lattice.exterior {
        assert_eq!(lattice.grid.nodes[*node as usize], sheet.point(*u, *v));
    }
    assert!(
        lattice
            .grid
            .cells
            .iter()
            .all(|cell| lattice.grid.signed_volume(cell) > 0.0)
    );
    // A half pipe of radius about 20 mm: its inside has room for 10 mm, not for 40.
    let knots = KnotVector::clamped_uniform(3, 8).unwrap();
    let point = |i: usize, j: usize| {
        let angle = std::f64::consts::PI * i as f64 / 7.0;
        Point3::new(
            0.02 * libm::cos(angle),
            0.02 * libm::sin(angle),
            0.01 * j as f64,
        )
    };
    let net = ControlNet::new(8, 8, (0..64).map(|k| point(k / 8, k % 8)).collect()).unwrap();
    let pipe = Surface::new(knots.clone(), knots, net, None).unwrap();
    for flip in [false, true] {
        let pipe = pipe.clone().with_flip_normal(flip);
        // The axis lies below the middle: depth along −n shrinks towards it or grows away from it.
        let towards_axis = pipe.normal(0.5, 0.5).y > 0.0;
        assert!(thick_sheet(&pipe, [8, 5, 3], 0.01).is_ok());
        let thick = thick_sheet(&pipe, [8, 5, 3], 0.04);
        assert_eq!(
            matches!(thick, Err(CubeError::Folded { .. })),
            towards_axis,
            "{flip}: {:?}",
            thick.err()
        );
    }
}

#[test]
fn what_cannot_be_filled_is_refused_by_a_typed_error() {
    let drop = drop(8);
    let mut lost = drop.clone();
    lost.net_mut().points_mut()[13].y = f64::NAN;
    let flat = drop.affine(
        &Matrix3::from_diagonal(&Vector3::new(1.0, 0.0, 1.0)),
        &Vector3::zeros(),
    );
    // Beyond 60 % of its length the body is mirrored: it crosses itself at a pinch and is inside
    // out behind it.
    let mut crossed = drop.clone();
    crossed
        .net_mut()
        .points_mut()
        .iter_mut()
        .for_each(|p| p.x *= 0.6 - p.z / 0.1);
    let torus = builtin("torus", None, None).unwrap();
    let sheet = builtin("sheet", None, None).unwrap();
    for (builder, build) in BUILDERS {
        for counts in [[0; 3], [1, 5, 5], [5, 5, 129], [usize::MAX; 3]] {
            assert!(
                matches!(build(&drop, counts), Err(CubeError::Counts { .. })),
                "{builder}, {counts:?}"
            );
        }
        assert!(
            matches!(
                build(&lost, [5; 3]),
                Err(CubeError::NotFinite { control: 13 })
            ),
            "{builder}"
        );
        for open in [&torus, &sheet] {
            assert!(
                matches!(build(open, [5; 3]), Err(CubeError::Topology { .. })),
                "{builder}"
            );
        }
        if let Ok(flat) = &flat {
            assert!(
                matches!(build(flat, [5; 3]), Err(CubeError::Flat { .. })),
                "{builder}"
            );
        }
        let error = build(&crossed, [8; 3]).map(|lattice| lattice.quality());
        assert!(
            matches!(error, Err(CubeError::Folded { .. })),
            "{builder}: {error:?}"
        );
    }
    assert!(matches!(
        thick_sheet(&drop, [5; 3], 0.01),
        Err(CubeError::Topology { .. })
    ));
    for thickness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(
                thick_sheet(&sheet, [5; 3], thickness),
                Err(CubeError::Length { .. })
            ),
            "{thickness}"
        );
    }
    let (low, high) = (Point3::origin(), Point3::new(1.0, 0.0, 1.0));
    assert!(matches!(
        CubeLattice::cuboid(&low, &high, [3; 3]),
        Err(CubeError::Length { .. })
    ));
}
