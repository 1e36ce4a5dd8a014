//! Coordinates that the law couples.

use super::matter::Matter;
use super::node_map::NodeMap;

/// Coordinates that the law couples to each, ascending.
pub(super) fn adjacent(matter: &Matter) -> Vec<Vec<u32>> {
    let mut adjacent = vec![Vec::new(); matter.rest.len()];
    let mut join = |a: u32, b: u32| {
        if a != b {
            adjacent[a as usize].push(b);
            adjacent[b as usize].push(a);
        }
    };
    match &matter.map {
        NodeMap::Same => matter.law_edges().iter().for_each(|&(a, b, _)| join(a, b)),
        NodeMap::Sparse(map) => {
            for node in 0..map.rows() {
                let (columns, _) = map.row(node);
                for (k, &a) in columns.iter().enumerate() {
                    columns[..k].iter().for_each(|&b| join(a, b));
                }
            }
        }
    }
    for list in &mut adjacent {
        list.sort_unstable();
        list.dedup();
    }
    adjacent
}

/// (coordinates): distance to the nearest coordinate that the law couples to it, m.
pub(super) fn shortest_edges(matter: &Matter) -> Vec<f64> {
    let mut shortest = vec![f64::INFINITY; matter.rest.len()];
    for (c, adjacent) in adjacent(matter).iter().enumerate() {
        for &other in adjacent {
            let length = (matter.rest[other as usize] - matter.rest[c]).norm();
            if length > 0.0 && length < shortest[c] {
                shortest[c] = length;
            }
        }
    }
    shortest
}

/// The middle one of the finite values; 0 where there are none.
pub(super) fn middle(values: &[f64]) -> f64 {
    let mut finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let half = finite.len() / 2;
    match finite.is_empty() {
        true => 0.0,
        false => *finite.select_nth_unstable_by(half, f64::total_cmp).1,
    }
}
