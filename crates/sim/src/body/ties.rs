//! Which control points are one coordinate.

use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;

/// Coordinate of each control point, numbered in order of first appearance. Points at the same
/// place, bit for bit (the doubled row of a clamped seam, the row of a pole), are one; so are the
/// pairs in `tied`, as merged and branching nets list them, and what they join. Pairs that name a
/// point beyond the list are passed over.
///
/// ```
/// use palpate_sim::body::coordinates_of_controls;
/// use palpate_geometry::math::Point3;
///
/// let points = [0.0, 1.0, 2.0, 0.0].map(|x| Point3::new(x, 0.0, 0.0));
/// assert_eq!(coordinates_of_controls(&points, &[]), [0, 1, 2, 0]);
/// assert_eq!(coordinates_of_controls(&points, &[(3, 2)]), [0, 1, 0, 0]);
/// ```
pub fn coordinates_of_controls(points: &[Point3], tied: &[(u32, u32)]) -> Vec<u32> {
    let mut root: Vec<usize> = (0..points.len()).collect();
    let find = |root: &[usize], mut k: usize| {
        while root[k] != k {
            k = root[k];
        }
        k
    };
    // The least index of a set is its root.
    let join = |root: &mut [usize], a: usize, b: usize| {
        let (a, b) = (find(root, a), find(root, b));
        root[a.max(b)] = a.min(b);
    };
    // Adding zero makes −0 and 0 one place.
    let key = |k: usize| points[k].coords.map(|x| (x + 0.0).to_bits());
    let mut by_place: Vec<usize> = (0..points.len()).collect();
    by_place.sort_by_key(|&k| (<[u64; 3]>::from(key(k)), k));
    for pair in by_place.windows(2) {
        if key(pair[0]) == key(pair[1]) {
            join(&mut root, pair[0], pair[1]);
        }
    }
    for &(a, b) in tied {
        if (a as usize) < points.len() && (b as usize) < points.len() {
            join(&mut root, a as usize, b as usize);
        }
    }
    let mut number = vec![u32::MAX; points.len()];
    let mut count = 0;
    (0..points.len())
        .map(|k| {
            let set = find(&root, k);
            if number[set] == u32::MAX {
                number[set] = count;
                count += 1;
            }
            number[set]
        })
        .collect()
}

/// Coordinate of each control point of a surface: as [`coordinates_of_controls`] says, but of a
/// branching surface what its edges and duplicates join, so that walls which only touch stay two.
pub fn coordinates_of_surface(surface: &Surface) -> Vec<u32> {
    if surface.joints().is_none() {
        return coordinates_of_controls(surface.net().points(), &[]);
    }
    surface
        .distinct_points(&surface.topology())
        .of
        .into_iter()
        .map(|k| k as u32)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::surface::builtin;

    #[test]
    fn builtins_are_tied_as_their_topology_says() {
        for name in ["teardrop", "sphere", "torus", "sheet"] {
            let surface = builtin(name, None, None).unwrap().with_exact_seams();
            let expected = surface.distinct_points(&surface.topology());
            let found = coordinates_of_controls(surface.net().points(), &[]);
            assert_eq!(
                found,
                expected.of.iter().map(|&k| k as u32).collect::<Vec<_>>(),
                "{name}"
            );
        }
    }

    // Slow twin: sweep over all pairs until nothing changes.
    #[test]
    fn random_ties_join_what_a_slow_closure_joins() {
        let mut state = 5_u64;
        let mut next = |below: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        for _ in 0..50 {
            let count = 1 + next(40);
            let points: Vec<Point3> = (0..count)
                .map(|_| Point3::new(next(30) as f64, 0.0, -0.0))
                .collect();
            let tied: Vec<(u32, u32)> = (0..next(20))
                .map(|_| (next(count + 2) as u32, next(count + 2) as u32))
                .collect();
            let mut label: Vec<usize> = (0..count).collect();
            loop {
                let before = label.clone();
                for a in 0..count {
                    for b in 0..count {
                        let pair = |&(x, y): &(u32, u32)| (x as usize, y as usize) == (a, b);
                        if points[a] == points[b] || tied.iter().any(pair) {
                            let least = label[a].min(label[b]);
                            (label[a], label[b]) = (least, least);
                        }
                    }
                }
                if label == before {
                    break;
                }
            }
            let found = coordinates_of_controls(&points, &tied);
            for a in 0..count {
                for b in 0..count {
                    assert_eq!(
                        found[a] == found[b],
                        label[a] == label[b],
                        "points {a} and {b} of {points:?} tied {tied:?}"
                    );
                }
            }
            let most = found.iter().max().unwrap();
            assert!(
                (0..=*most).all(|k| found.contains(&k)),
                "numbers have gaps: {found:?}"
            );
        }
    }
}
