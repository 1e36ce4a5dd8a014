//! Moving a node to where the worst of its cells is best, by fixed trial steps (Freitag & Ollivier-Gooch 1997).

use palpate_geometry::math::{Point3, Vector3};

/// Places that a node tries: the mean of its neighbours, half the way there, and steps of some lengths, m, along the axes.
pub fn trials<const N: usize>(
    start: Point3,
    mean: Point3,
    steps_m: [f64; N],
) -> impl Iterator<Item = Point3> {
    let steps = steps_m
        .into_iter()
        .flat_map(|step_m| (0..6).map(move |k| (step_m, k)));
    let around = steps.map(move |(step_m, k)| {
        let mut offset = Vector3::zeros();
        offset[k / 2] = if k % 2 == 0 { step_m } else { -step_m };
        start + offset
    });
    [mean, nalgebra::center(&start, &mean)]
        .into_iter()
        .chain(around)
}

/// Puts a node where the worst of its cells is best; false where that is where it was.
pub fn take_best<G>(
    grid: &mut G,
    node: impl Fn(&mut G) -> &mut Point3,
    places: impl Iterator<Item = Point3>,
    worst: impl Fn(&G) -> f64,
) -> bool {
    let start = *node(grid);
    let mut best = (worst(grid), start);
    for place in places {
        *node(grid) = place;
        let value = worst(grid);
        if value > best.0 {
            best = (value, place);
        }
    }
    *node(grid) = best.1;
    best.1 != start
}
