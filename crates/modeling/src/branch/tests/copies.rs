//! Copies, ties and tables; and what the rest of the engine makes of such a surface.

use super::*;
use std::collections::BTreeMap;

#[test]
fn tables_from_the_tree_and_from_the_net_are_the_same() {
    for (name, tree) in trees() {
        let grown = grow(&tree).unwrap();
        assert_eq!(
            PatchTable::recovered(&grown.surface).unwrap(),
            grown.patches,
            "{name}"
        );
        assert_eq!(
            PatchTable::recovered(&given(name)).unwrap(),
            grown.patches,
            "{name}, nine decimals"
        );
    }
}

// The engine finds copies and ties from the net itself: by equal bits, walked the same way.
#[test]
fn copies_are_equal_bit_for_bit_and_walked_the_same_way() {
    for (name, tree) in trees() {
        let BranchingSurface {
            surface, patches, ..
        } = grow(&tree).unwrap();
        let mut copies = 0;
        for copy in &patches.patches {
            let Some(original) = copy.duplicate_of else {
                continue;
            };
            let original = &patches.patches[original];
            assert!(
                original.duplicate_of.is_none()
                    && original.leaf < copy.leaf
                    && original.arc == copy.arc
            );
            assert_eq!(
                (&original.node, original.v, original.rows),
                (&copy.node, copy.v, copy.rows)
            );
            let bits = |patch| -> Vec<[u64; 3]> {
                patches
                    .control_points(&surface, patch)
                    .map(|p| p.coords.map(f64::to_bits).into())
                    .collect()
            };
            assert_eq!(bits(original), bits(copy), "{name}: {copy:?}");
            copies += 1;
        }
        assert_eq!(
            copies + patches.distinct().count(),
            2 * patches.leaves * patches.parts
        );
    }
}

#[test]
fn ties_are_all_places_of_equal_bits() {
    for (name, tree) in trees() {
        let BranchingSurface { surface, ties, .. } = grow(&tree).unwrap();
        let mut places: BTreeMap<[u64; 3], Vec<usize>> = BTreeMap::new();
        for (k, point) in surface.net().points().iter().enumerate() {
            assert!(
                point.iter().all(|x| x.to_bits() != (-0.0_f64).to_bits()),
                "{name}: −0 at {k}"
            );
            places
                .entry(point.coords.map(f64::to_bits).into())
                .or_default()
                .push(k);
        }
        let mut wanted: Vec<_> = places
            .into_values()
            .filter(|places| places.len() > 1)
            .collect();
        let mut ties = ties;
        wanted.sort();
        ties.sort();
        assert_eq!(ties, wanted, "{name}");
    }
}

// Tied points moved as one: the copies stay copies and nothing opens.
#[test]
fn ties_moved_together_keep_the_surface_closed() {
    let BranchingSurface {
        mut surface,
        patches,
        ties,
    } = grow(&trees()[3].1).unwrap();
    let mut random = Random(93);
    let mut tied = vec![usize::MAX; surface.net().points().len()];
    ties.iter()
        .enumerate()
        .for_each(|(class, places)| places.iter().for_each(|&k| tied[k] = class));
    let moves: Vec<_> = ties
        .iter()
        .map(|_| [0; 3].map(|_| random.float(-0.01, 0.01)))
        .collect();
    for (k, point) in surface.net_mut().points_mut().iter_mut().enumerate() {
        let by = moves
            .get(tied[k])
            .copied()
            .unwrap_or_else(|| [0; 3].map(|_| random.float(-0.01, 0.01)));
        *point += palpate_geometry::math::Vector3::from(by);
    }
    let (m, _) = Measures::of(&surface, &patches);
    assert_eq!(
        (m.copy_deviation_m, m.euler, m.loops, m.non_manifold),
        (0.0, -3, 5, 0)
    );
    assert!(m.gap_m <= GOAL_GAP * m.size_m, "gap {} m", m.gap_m);
    assert!(
        m.angle_deg > 0.1,
        "moved at random the joints crease: {}°",
        m.angle_deg
    );
    assert_eq!(PatchTable::recovered(&surface).unwrap(), patches);
}

// Cut at knots of full multiplicity, a patch has that part of the whole net: what STEP and IGES
// take.
#[test]
fn a_patch_alone_has_its_control_points_bit_for_bit() {
    for (name, tree) in trees() {
        let BranchingSurface {
            surface, patches, ..
        } = grow(&tree).unwrap();
        for patch in patches.distinct() {
            let piece = surface.sub_surface(patch.u, patch.v).unwrap();
            assert_eq!(
                piece.net().points(),
                patches.control_points(&surface, patch).collect::<Vec<_>>(),
                "{name}"
            );
        }
    }
}

// The surface layer knows nothing of trees: it finds the same patches by their edges.
#[test]
fn the_engine_finds_the_patches_of_the_table_and_draws_each_once() {
    for (_, tree) in trees() {
        let BranchingSurface {
            surface, patches, ..
        } = grow(&tree).unwrap();
        if patches.leaves == 1 {
            continue;
        }
        // Edges part at disjoined knots and meet again elsewhere: the surface is open at its ends
        // only.
        let topology = surface.topology();
        assert_eq!((topology.torn, topology.is_closed()), ([false; 2], false));
        let joints = surface.joints().unwrap();
        assert_eq!(joints.patches().len(), patches.patches.len());
        for found in joints.patches() {
            let named = |u: [f64; 2], v: [f64; 2]| {
                patches
                    .patches
                    .iter()
                    .find(|p| (p.u, p.v) == (u, v))
                    .unwrap()
            };
            let wanted = named(found.u, found.v)
                .duplicate_of
                .map(|row| (patches.patches[row].u, patches.patches[row].v));
            assert_eq!(
                found
                    .duplicate_of
                    .map(|k| (joints.patches()[k].u, joints.patches()[k].v)),
                wanted
            );
        }
        let pieces = surface.bezier_patches();
        for piece in &pieces {
            let ((a, b), (c, d)) = (piece.knots_u().domain(), piece.knots_v().domain());
            let (u, v) = (0.3 * a + 0.7 * b, 0.6 * c + 0.4 * d);
            assert!((piece.point(u, v) - surface.point(u, v)).norm() <= 1e-14 * surface.size());
        }
        let spans = |knots: &KnotVector, [a, b]: [f64; 2]| {
            knots
                .spans()
                .filter(|&i| knots.knots()[i] >= a && knots.knots()[i + 1] <= b)
                .count()
        };
        let drawn = patches
            .distinct()
            .map(|p| spans(surface.knots_u(), p.u) * spans(surface.knots_v(), p.v));
        let mesh = surface.tessellated([4, 4]).unwrap();
        assert_eq!(mesh.triangles.len(), drawn.sum::<usize>() * 32);
    }
}

// "Terminate, repeat the last point, then disjoin": a piece without extent between the leaves. The
// same points, and the same measures.
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
    let mut knots: Vec<f64> = plain
        .knots_u()
        .knots()
        .iter()
        .copied()
        .filter(|&u| u < 12.0)
        .collect();
    knots.extend([12.0; 3]);
    knots.extend([13.0; 4]);
    knots.extend(
        plain
            .knots_u()
            .knots()
            .iter()
            .filter(|&&u| u > 12.0)
            .map(|u| u + 1.0),
    );
    let net = ControlNet::new(rows.len(), columns, rows.concat()).unwrap();
    let surface = Surface::new(
        KnotVector::new(3, knots).unwrap(),
        plain.knots_v().clone(),
        net,
        None,
    )
    .unwrap();
    let (a, b) = (measured(&plain), measured(&surface));
    assert_eq!(
        (b.euler, b.loops, b.misses(GOAL_ANGLE_DEG)),
        (-1, 3, Vec::new())
    );
    assert!((a.area_m2 - b.area_m2).abs() < 1e-12 * a.area_m2);
}
