//! A sheet of triangles laid out flat: a disc on the unit disc, a ring on a cylinder.
//!
//! Each inner vertex is the mean of those beside it, nearer ones count more; on a convex outline no triangle turns over
//! (Tutte 1963; of a cylinder Gortler, Gotsman & Thurston 2006). A ring is cut along a chain of triangles from one loop to
//! the other: who crosses it has gone round once.

use super::rim::Rim;
use super::sheet::Sheet;
use palpate_geometry::math::{Cholesky, Point3, SymmetricTriplets};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// Places between which the start of a loop is looked for.
const TURNS: usize = 64;

/// Where the parameters of a wall are in a sheet: u in [0, 1) goes round, v is 1 at the first rim, and 0 at the pole of a
/// disc or the second rim of a ring.
pub(super) struct Flat {
    /// Places in the plane and in space.
    triangles: Vec<([[f64; 2]; 3], [Point3; 3])>,
    /// Of a ring: a parameter u belongs to the share `turn − u` of the second rim's length.
    pub turn: Option<f64>,
    /// Of a disc: where its pole is.
    pole: [f64; 2],
}

impl Flat {
    /// A sheet with one loop or two.
    pub fn new(sheet: &Sheet, rims: &[Rim]) -> Option<Self> {
        match sheet.loops.as_slice() {
            [one] => disc(sheet, &rims[one.0]),
            [one, two] => ring(sheet, [&rims[one.0], &rims[two.0]]),
            _ => None,
        }
    }

    /// The place of the sheet with parameters u and v, m.
    pub fn point(&self, u: f64, v: f64) -> Point3 {
        let at = match self.turn {
            None => {
                let (sin, cos) = libm::sincos(TAU * u);
                let [x, y] = self.pole;
                [x + v * (cos - x), y + v * (sin - y)]
            }
            Some(_) => [u, v],
        };
        let mut best = (f64::NEG_INFINITY, Point3::origin());
        for (flat, points) in &self.triangles {
            let shares = shares(flat, at);
            let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
            if least > best.0 {
                let kept = shares.map(|s| s.max(0.0));
                let sum: f64 = kept.iter().sum();
                let moved = (points[1] - points[0]) * kept[1] + (points[2] - points[0]) * kept[2];
                best = (least, points[0] + moved / sum);
            }
        }
        best.1
    }
}

/// Barycentric coordinates.
fn shares([a, b, c]: &[[f64; 2]; 3], p: [f64; 2]) -> [f64; 3] {
    let cross = |o: &[f64; 2], s: &[f64; 2], t: &[f64; 2]| {
        (s[0] - o[0]) * (t[1] - o[1]) - (s[1] - o[1]) * (t[0] - o[0])
    };
    let whole = cross(a, b, c);
    if whole == 0.0 {
        return [f64::NEG_INFINITY; 3];
    }
    [
        cross(&p, b, c) / whole,
        cross(&p, c, a) / whole,
        cross(&p, a, b) / whole,
    ]
}

/// By vertex of a loop: share of its length, from the place of the rim where the first vertex is.
fn along(sheet: &Sheet, ring: &[usize], rim: &Rim) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for (k, &v) in ring.iter().enumerate() {
        let next = ring[(k + 1) % ring.len()];
        lengths.push(lengths[k] + (sheet.points[next] - sheet.points[v]).norm());
    }
    let whole = lengths[ring.len()];
    // The mean of the angles by which the rim is ahead.
    let ahead = ring.iter().zip(&lengths).map(|(&v, length)| {
        let angle = TAU * (rim.nearest(&sheet.points[v]).0 - length / whole);
        libm::sincos(angle)
    });
    let (sin, cos) = ahead.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let start = libm::atan2(sin, cos) / TAU;
    let lengths = &lengths[..ring.len()];
    lengths
        .iter()
        .map(|length| start + length / whole)
        .collect()
}

fn disc(sheet: &Sheet, rim: &Rim) -> Option<Flat> {
    let ring = &sheet.loops[0].1;
    let mut fixed = vec![None; sheet.points.len()];
    for (&v, u) in ring.iter().zip(along(sheet, ring, rim)) {
        let (sin, cos) = libm::sincos(TAU * u);
        fixed[v] = Some([cos, sin]);
    }
    let flat = relaxed(sheet, &fixed, &BTreeMap::new())?;
    let triangles = sheet.triangles.iter();
    let triangles = triangles.map(|t| (t.map(|v| flat[v]), t.map(|v| sheet.points[v])));
    Some(Flat {
        triangles: triangles.collect(),
        turn: None,
        pole: flat[sheet.deepest],
    })
}

fn ring(sheet: &Sheet, rims: [&Rim; 2]) -> Option<Flat> {
    // Where the second rim's lengths begin, so that places with one u are near each other.
    let apart = |turn: f64| -> f64 {
        let us = (0..TURNS).map(|k| k as f64 / TURNS as f64);
        us.map(|u| (rims[0].point(u) - rims[1].point(turn - u)).norm_squared())
            .sum()
    };
    let turns = (0..TURNS).map(|k| k as f64 / TURNS as f64);
    let turn = turns.min_by(|a, b| apart(*a).total_cmp(&apart(*b)))?;
    let cut = chain(sheet)?;
    let mut fixed = vec![None; sheet.points.len()];
    let mut beside = [0.0; 2];
    for (k, (_, ring)) in sheet.loops.iter().enumerate() {
        // Beginning behind the edge at which the chain ends.
        let ends = |i: &usize| cut.contains_key(&(ring[*i], ring[(*i + 1) % ring.len()]));
        let last = (0..ring.len()).find(ends)?;
        let mut ring = ring.clone();
        ring.rotate_left((last + 1) % sheet.loops[k].1.len());
        let shares = along(sheet, &ring, rims[k]);
        let us: Vec<f64> = match k {
            0 => shares,
            _ => shares.iter().map(|s| turn - s).collect(),
        };
        beside[k] = us[0];
        let v = if k == 0 { 1.0 } else { 0.0 };
        // The second loop begins on the other side of the chain, where the first one has gone round.
        let whole = match k {
            0 => 0.0,
            _ => (beside[0] + 1.0 - beside[1]).round(),
        };
        for (&vertex, u) in ring.iter().zip(us) {
            fixed[vertex] = Some([u + whole, v]);
        }
    }
    // The first loop goes up by one on its way round and steps back at the chain.
    let first = &sheet.loops[0].1;
    let on_first =
        (0..first.len()).find_map(|i| cut.get(&(first[i], first[(i + 1) % first.len()])))?;
    let jumps = cut
        .iter()
        .map(|(&edge, &jump)| (edge, jump * on_first))
        .collect();
    let flat = relaxed(sheet, &fixed, &jumps)?;
    let mut triangles = Vec::with_capacity(3 * sheet.triangles.len());
    for t in &sheet.triangles {
        let jump = |a: usize, b: usize| jumps.get(&(a, b)).copied().unwrap_or(0.0);
        let by = [0.0, jump(t[0], t[1]), -jump(t[2], t[0])];
        let places: [[f64; 2]; 3] = std::array::from_fn(|k| [flat[t[k]][0] + by[k], flat[t[k]][1]]);
        let middle = places.iter().map(|p| p[0]).sum::<f64>() / 3.0;
        for shift in [-1.0, 0.0, 1.0] {
            let shift = shift - middle.floor();
            triangles.push((
                places.map(|p| [p[0] + shift, p[1]]),
                t.map(|v| sheet.points[v]),
            ));
        }
    }
    Some(Flat {
        triangles,
        turn: Some(turn),
        pole: [0.0; 2],
    })
}

/// Edges that a chain of triangles from the first loop to the second crosses, with +1 for those from its right to its left
/// and −1 the other way.
fn chain(sheet: &Sheet) -> Option<BTreeMap<(usize, usize), f64>> {
    let mut owner = BTreeMap::new();
    for (t, &[a, b, c]) in sheet.triangles.iter().enumerate() {
        for edge in [(a, b), (b, c), (c, a)] {
            owner.insert(edge, t);
        }
    }
    let rim_edges = |k: usize| -> Vec<(usize, usize)> {
        let ring = &sheet.loops[k].1;
        (0..ring.len())
            .map(|i| (ring[i], ring[(i + 1) % ring.len()]))
            .collect()
    };
    let start = *rim_edges(0).first()?;
    let goal: BTreeSet<(usize, usize)> = rim_edges(1).into_iter().collect();
    let first = *owner.get(&start)?;
    let mut from: BTreeMap<usize, (usize, usize)> = BTreeMap::from([(first, start)]);
    let mut queue = std::collections::VecDeque::from([first]);
    while let Some(t) = queue.pop_front() {
        let [a, b, c] = sheet.triangles[t];
        for edge in [(a, b), (b, c), (c, a)] {
            if goal.contains(&edge) {
                let mut cut = BTreeMap::from([(edge, 1.0)]);
                let mut at = t;
                while let Some(&into) = from.get(&at) {
                    // `into` is an edge of this triangle, entered from behind.
                    cut.insert(into, -1.0);
                    if at == first {
                        break;
                    }
                    let back = (into.1, into.0);
                    cut.insert(back, 1.0);
                    at = owner[&back];
                }
                return Some(cut);
            }
            if let Some(&next) = owner.get(&(edge.1, edge.0))
                && !from.contains_key(&next)
            {
                from.insert(next, (edge.1, edge.0));
                queue.push_back(next);
            }
        }
    }
    None
}

/// Places in the plane: those that are fixed, and means of neighbours elsewhere. A neighbour is seen moved by the jump of
/// the edge to it.
fn relaxed(
    sheet: &Sheet,
    fixed: &[Option<[f64; 2]>],
    jumps: &BTreeMap<(usize, usize), f64>,
) -> Option<Vec<[f64; 2]>> {
    let mut number = vec![usize::MAX; fixed.len()];
    let free: Vec<usize> = (0..fixed.len()).filter(|&v| fixed[v].is_none()).collect();
    free.iter().enumerate().for_each(|(k, &v)| number[v] = k);
    let mut matrix = SymmetricTriplets::new(free.len());
    let mut right = [vec![0.0; free.len()], vec![0.0; free.len()]];
    let edges: BTreeSet<(usize, usize)> = (sheet.triangles.iter())
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .flat_map(|(a, b)| [(a, b), (b, a)])
        .collect();
    for &(a, b) in &edges {
        let i = number[a];
        if i == usize::MAX {
            continue;
        }
        let weight = 1.0 / (sheet.points[a] - sheet.points[b]).norm();
        let jump = jumps.get(&(a, b)).copied().unwrap_or(0.0);
        matrix.add(i, i, weight);
        right[0][i] += weight * jump;
        match fixed[b] {
            Some(place) => (0..2).for_each(|k| right[k][i] += weight * place[k]),
            None if number[b] < i => matrix.add(i, number[b], -weight),
            None => {}
        }
    }
    if !free.is_empty() {
        let factor = Cholesky::new(&matrix).ok()?;
        right.iter_mut().for_each(|right| factor.solve_one(right));
    }
    let place = |v: usize| fixed[v].unwrap_or_else(|| [0, 1].map(|k| right[k][number[v]]));
    Some((0..fixed.len()).map(place).collect())
}
