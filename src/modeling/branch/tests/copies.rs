//! Copies, ties and tables; and what the rest of the engine makes of such a surface.

use super::*;
use crate::exchange::{Format, Pick, read_surface, write_surface};
use crate::surface::file::Unit;
use std::collections::BTreeMap;

#[test]
fn tables_from_the_tree_and_from_the_net_are_the_same() {
    for (name, tree) in trees() {
        let grown = grow(&tree).unwrap();
        assert_eq!(PatchTable::recovered(&grown.surface).unwrap(), grown.patches, "{name}");
        assert_eq!(PatchTable::recovered(&given(name)).unwrap(), grown.patches, "{name}, nine decimals");
    }
}

// The engine finds copies and ties from the net itself: by equal bits, walked the same way.
#[test]
fn copies_are_equal_bit_for_bit_and_walked_the_same_way() {
    for (name, tree) in trees() {
        let BranchingSurface { surface, patches, .. } = grow(&tree).unwrap();
        let mut copies = 0;
        for copy in &patches.patches {
            let Some(original) = copy.duplicate_of else { continue };
            let original = &patches.patches[original];
            assert!(original.duplicate_of.is_none() && original.leaf < copy.leaf && original.arc == copy.arc);
            assert_eq!((&original.node, original.v, original.rows), (&copy.node, copy.v, copy.rows));
            let bits = |patch| -> Vec<[u64; 3]> {
                patches.control_points(&surface, patch).map(|p| p.coords.map(f64::to_bits).into()).collect()
            };
            assert_eq!(bits(original), bits(copy), "{name}: {copy:?}");
            copies += 1;
        }
        assert_eq!(copies + patches.distinct().count(), 2 * patches.leaves * patches.parts);
    }
}

#[test]
fn ties_are_all_places_of_equal_bits() {
    for (name, tree) in trees() {
        let BranchingSurface { surface, ties, .. } = grow(&tree).unwrap();
        let mut places: BTreeMap<[u64; 3], Vec<usize>> = BTreeMap::new();
        for (k, point) in surface.net().points().iter().enumerate() {
            assert!(point.iter().all(|x| x.to_bits() != (-0.0_f64).to_bits()), "{name}: −0 at {k}");
            places.entry(point.coords.map(f64::to_bits).into()).or_default().push(k);
        }
        let mut wanted: Vec<_> = places.into_values().filter(|places| places.len() > 1).collect();
        let mut ties = ties;
        wanted.sort();
        ties.sort();
        assert_eq!(ties, wanted, "{name}");
    }
}

// Tied points moved as one: the copies stay copies and nothing opens.
#[test]
fn ties_moved_together_keep_the_surface_closed() {
    let BranchingSurface { mut surface, patches, ties } = grow(&trees()[3].1).unwrap();
    let mut random = Random(93);
    let mut tied = vec![usize::MAX; surface.net().points().len()];
    ties.iter().enumerate().for_each(|(class, places)| places.iter().for_each(|&k| tied[k] = class));
    let moves: Vec<_> = ties.iter().map(|_| [0; 3].map(|_| random.float(-0.01, 0.01))).collect();
    for (k, point) in surface.net_mut().points_mut().iter_mut().enumerate() {
        let by = moves.get(tied[k]).copied().unwrap_or_else(|| [0; 3].map(|_| random.float(-0.01, 0.01)));
        *point += crate::math::Vector3::from(by);
    }
    let (m, _) = Measures::of(&surface, &patches);
    assert_eq!((m.copy_deviation_m, m.euler, m.loops, m.non_manifold), (0.0, -3, 5, 0));
    assert!(m.gap_m <= GOAL_GAP * m.size_m, "gap {} m", m.gap_m);
    assert!(m.angle_deg > 0.1, "moved at random the joints crease: {}°", m.angle_deg);
    assert_eq!(PatchTable::recovered(&surface).unwrap(), patches);
}

// STEP and IGES have no form for a surface in pieces: they take it patch by patch.
#[test]
fn files_keep_every_bit_and_step_takes_it_patch_by_patch() {
    for (name, tree) in trees() {
        let BranchingSurface { surface, patches, .. } = grow(&tree).unwrap();
        let bytes = write_surface(&surface, Format::Json, Unit::Metre).unwrap();
        assert_eq!(read_surface(&bytes, Format::Json, Pick::First).unwrap().surface, surface, "{name}");
        for format in [Format::Step, Format::Iges] {
            assert!(write_surface(&surface, format, Unit::Metre).is_err(), "{name}, {format:?}");
            for patch in patches.distinct() {
                let piece = surface.sub_surface(patch.u, patch.v).unwrap();
                // Cut at knots of full multiplicity, its net is that part of the whole net, bit for bit.
                assert_eq!(piece.net().points(), patches.control_points(&surface, patch).collect::<Vec<_>>());
                let bytes = write_surface(&piece, format, Unit::Metre).unwrap();
                assert_eq!(read_surface(&bytes, format, Pick::First).unwrap().surface, piece, "{name}, {format:?}");
            }
        }
    }
}

// Full multiplicities inside: evaluation from both sides, pieces and triangles are those of a torn surface.
#[test]
fn the_rest_of_the_engine_takes_the_surface_as_torn() {
    let BranchingSurface { surface, .. } = grow(&trees()[0].1).unwrap();
    let topology = surface.topology();
    // In u the loops of two leaves part; in v inner arcs part from the stem.
    assert_eq!(topology.torn, [true; 2]);
    assert!(!topology.is_closed());
    let patches = surface.bezier_patches();
    assert_eq!(patches.len(), 24 * 11);
    for patch in &patches {
        let ((a, b), (c, d)) = (patch.knots_u().domain(), patch.knots_v().domain());
        let (u, v) = (0.3 * a + 0.7 * b, 0.6 * c + 0.4 * d);
        assert!((patch.point(u, v) - surface.point(u, v)).norm() <= 1e-14 * surface.size());
    }
    // No triangle reaches over a disjoined knot: edges stay as short as cells are.
    let mesh = surface.tessellated([4, 4]).unwrap();
    let longest = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let at = |k: u32| mesh.points[k as usize];
    let longest = longest.map(|(a, b)| (at(a) - at(b)).norm()).fold(0.0, f64::max);
    assert!(longest < 0.4, "an edge of {longest} m");
    assert_eq!(mesh.triangles.len(), 24 * 11 * 32);
}

// "Terminate, repeat the last point, then disjoin": a piece without extent between the leaves. The same points, and the
// same measures.
#[test]
fn a_repeated_last_point_before_disjoining_is_understood() {
    let plain = grow(&trees()[0].1).unwrap().surface;
    let (mut rows, columns) = (Vec::new(), plain.net().columns());
    let repeats = 3;
    for i in 0..34 {
        let row: Vec<Point3> = (0..columns).map(|j| *plain.net().at(i, j)).collect();
        let times = if i == 16 { 1 + repeats } else { 1 };
        rows.extend(std::iter::repeat_n(row, times));
    }
    // u = 12 creases, and the piece up to 13 is a point; then the second leaf.
    let mut knots: Vec<f64> = plain.knots_u().knots().iter().copied().filter(|&u| u < 12.0).collect();
    knots.extend([12.0; 3]);
    knots.extend([13.0; 4]);
    knots.extend(plain.knots_u().knots().iter().filter(|&&u| u > 12.0).map(|u| u + 1.0));
    let net = ControlNet::new(rows.len(), columns, rows.concat()).unwrap();
    let surface = Surface::new(KnotVector::new(3, knots).unwrap(), plain.knots_v().clone(), net, None).unwrap();
    let (a, b) = (measured(&plain), measured(&surface));
    assert_eq!((b.euler, b.loops, b.misses(GOAL_ANGLE_DEG)), (-1, 3, Vec::new()));
    assert!((a.area_m2 - b.area_m2).abs() < 1e-12 * a.area_m2);
}
