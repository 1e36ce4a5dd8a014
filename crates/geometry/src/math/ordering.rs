//! In which order the rows of a sparse symmetric matrix are eliminated.

use super::Point3;
use super::dissection;

/// Matrices of fewer rows are ordered by minimum degree alone: their solves are short (dissection would
/// save a quarter of the numbers at a thousand rows), and recordings of such bodies keep their bits.
const DISSECTED: usize = 2_500;

/// No row.
pub(super) const NONE: u32 = u32::MAX;

/// Neighbours of each row: ascending, once each.
pub(super) type Adjacent = Vec<Vec<u32>>;

/// Neighbours by the entries of a triangle.
pub(super) fn adjacent(n: usize, entries: impl Iterator<Item = (u32, u32)>) -> Adjacent {
    let mut adjacent: Adjacent = vec![Vec::new(); n];
    for (i, j) in entries.filter(|(i, j)| i != j) {
        adjacent[i as usize].push(j);
        adjacent[j as usize].push(i);
    }
    for list in &mut adjacent {
        list.sort_unstable();
        list.dedup();
    }
    adjacent
}

/// The order with the fewest numbers in the factor: by minimum degree, or, of a large matrix whose rows
/// have places (none: empty), by nested dissection. `None` for a pattern that is refused.
pub(super) fn order(adjacent: &Adjacent, places: &[Point3]) -> Option<Vec<u32>> {
    let n = adjacent.len();
    let mut local = vec![NONE; n];
    let all: Vec<u32> = (0..n as u32).collect();
    let by_degree = minimum_degree(adjacent, &all, &mut local)?;
    if n < DISSECTED || places.len() != n {
        return Some(by_degree);
    }
    let mut leaf = |nodes: &[u32]| minimum_degree(adjacent, nodes, &mut local);
    let dissected = dissection::order(adjacent, places, &mut leaf)?;
    let fewer = numbers(adjacent, &dissected) < numbers(adjacent, &by_degree);
    Some(if fewer { dissected } else { by_degree })
}

/// Approximate minimum degree of the graph between some nodes (Amestoy, Davis & Duff 2004); `local` is
/// [`NONE`] everywhere, before and after.
fn minimum_degree(adjacent: &Adjacent, nodes: &[u32], local: &mut [u32]) -> Option<Vec<u32>> {
    for (k, &node) in nodes.iter().enumerate() {
        local[node as usize] = k as u32;
    }
    let (mut starts, mut rows) = (vec![0i64], Vec::new());
    for &node in nodes {
        let within = adjacent[node as usize]
            .iter()
            .map(|&other| local[other as usize])
            .filter(|&place| place != NONE);
        let start = rows.len();
        rows.extend(within.map(i64::from));
        rows[start..].sort_unstable();
        starts.push(rows.len() as i64);
    }
    for &node in nodes {
        local[node as usize] = NONE;
    }
    if rows.is_empty() {
        return Some(nodes.to_vec());
    }
    let control = amd::Control::default();
    let (order, _, _) = amd::order(nodes.len() as i64, &starts, &rows, &control).ok()?;
    Some(order.into_iter().map(|k| nodes[k as usize]).collect())
}

/// Numbers in the factor, of a matrix of single numbers: the rows of the elimination tree that each
/// row reaches (Davis, *Direct Methods for Sparse Linear Systems*, §4.4).
fn numbers(adjacent: &Adjacent, order: &[u32]) -> usize {
    let n = order.len();
    let mut place = vec![0u32; n];
    for (k, &node) in order.iter().enumerate() {
        place[node as usize] = k as u32;
    }
    let (mut parent, mut mark) = (vec![NONE; n], vec![NONE; n]);
    let mut count = n;
    for (k, &node) in order.iter().enumerate() {
        mark[k] = k as u32;
        for &other in &adjacent[node as usize] {
            let mut i = place[other as usize] as usize;
            while i < k && mark[i] != k as u32 {
                mark[i] = k as u32;
                count += 1;
                if parent[i] == NONE {
                    parent[i] = k as u32;
                }
                i = parent[i] as usize;
            }
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of nodes with the springs of a lattice: edges and diagonals of faces.
    fn cube(side: usize) -> (Adjacent, Vec<Point3>) {
        let at = |k: usize| [k / side / side, k / side % side, k % side];
        let n = side * side * side;
        let places = (0..n).map(|k| Point3::from(at(k).map(|x| x as f64)));
        let near = |a: usize, b: usize| {
            let apart = std::array::from_fn::<usize, 3, _>(|c| at(a)[c].abs_diff(at(b)[c]));
            apart.iter().all(|&x| x < 2) && apart.iter().sum::<usize>() < 3
        };
        let reach = side * side + side;
        let pairs = (0..n).flat_map(|a| {
            (a.saturating_sub(reach)..a)
                .filter(move |&b| near(a, b))
                .map(move |b| (a as u32, b as u32))
        });
        (adjacent(n, pairs), places.collect())
    }

    #[test]
    fn dissection_of_a_lattice_is_a_permutation_with_half_of_the_numbers() {
        let (graph, places) = cube(20);
        let (dissected, by_degree) = (order(&graph, &places), order(&graph, &[]));
        let (dissected, by_degree) = (dissected.unwrap(), by_degree.unwrap());
        let mut sorted = dissected.clone();
        sorted.sort_unstable();
        assert!(
            sorted
                .iter()
                .enumerate()
                .all(|(k, &node)| k == node as usize)
        );
        let (few, many) = (numbers(&graph, &dissected), numbers(&graph, &by_degree));
        println!("{few} numbers by dissection, {many} by minimum degree");
        assert!(5 * few < 3 * many, "{few} and {many} numbers");
    }

    // nnz ~ n^(4/3): from 16³ to 26³ nodes 4.3 n, 7 times as many.
    #[test]
    fn numbers_of_a_dissected_lattice_grow_about_as_theory_has_it() {
        let of = |side| {
            let (graph, places) = cube(side);
            numbers(&graph, &order(&graph, &places).unwrap()) as f64
        };
        let exponent = (of(26) / of(16)).ln() / (26.0_f64 / 16.0).powi(3).ln();
        println!("exponent {exponent}");
        assert!(exponent < 1.46, "{exponent}");
    }

    #[test]
    fn places_that_say_nothing_fall_back_to_minimum_degree() {
        let (graph, places) = cube(14);
        let same = vec![Point3::origin(); places.len()];
        let found = order(&graph, &same).unwrap();
        let most = numbers(&graph, &order(&graph, &[]).unwrap());
        assert!(numbers(&graph, &found) <= most);
    }
}
