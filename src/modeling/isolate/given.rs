//! The pairs of closed surfaces that isolation is measured on, as JSON: nets, grids, published lengths.

/// One document a pair, in the order of their numbers.
pub const ALL: [&str; 12] = [
    include_str!("data/01_spheres_shallow.json"),
    include_str!("data/02_ellipsoids_shallow.json"),
    include_str!("data/03_ellipsoids_deep.json"),
    include_str!("data/05_small_on_large_offset.json"),
    include_str!("data/06_crossed_sausages.json"),
    include_str!("data/07_bent_sausage_over_ellipsoid.json"),
    include_str!("data/08_torus_side_ellipsoid.json"),
    include_str!("data/10_linked_tori_overlapping.json"),
    include_str!("data/11_sphere_plugging_torus_hole.json"),
    include_str!("data/13_knobbly_body_ellipsoid.json"),
    include_str!("data/15_contained.json"),
    include_str!("data/16_identical_ellipsoids.json"),
];
