//! Triangles of a wall: tetrahedra of a lattice, followed from a rim on as far as the wall goes.
//!
//! ```text
//! cells through a rim ──▶ their neighbours, while φ_A − φ_B changes sign and the place is in both bodies
//! cell ──▶ six tetrahedra ──▶ triangles where φ_A = φ_B ──▶ cut off where the depth is 0 ──▶ loops, each near one rim
//! ```
//! The triangles say how the wall hangs together and where it is, roughly; their places are not used for more.

use super::fields::Fields;
use super::rim::Rim;
use palpate_geometry::math::{Point3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// Cells looked at, at most.
const MOST_CELLS: usize = 300_000;
/// A crossing is no nearer to the end of an edge than this share of it, so that no triangle is degenerate.
const MARGIN: f64 = 0.05;
/// Corners of a cell as bits x, y, z: the ways from the first corner to the last along three edges.
const WAYS: [[usize; 2]; 6] = [[1, 3], [1, 5], [2, 3], [2, 6], [4, 5], [4, 6]];

type Site = [i32; 3];

/// A connected piece of the wall.
#[derive(Clone, Debug, Default)]
pub(super) struct Sheet {
    pub points: Vec<Point3>,
    /// Seen from where φ_A > φ_B they turn to the left.
    pub triangles: Vec<[usize; 3]>,
    /// Vertices of the boundary, the sheet on the left, and the rim that each loop is near.
    pub loops: Vec<(usize, Vec<usize>)>,
    /// The vertex that is deepest in both bodies.
    pub deepest: usize,
}

/// Why a lattice does not show what the wall is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unclear {
    /// A finer one may.
    Coarse,
    /// There are too many cells.
    Large,
}

struct Lattice<'a, 'b> {
    fields: &'a mut Fields<'b>,
    origin: Point3,
    step_m: f64,
    /// φ_A − φ_B and the mean, m.
    values: BTreeMap<Site, [f64; 2]>,
}

impl Sheet {
    /// The piece of the wall that ends at a rim, by cells of a given size.
    pub fn at_rim(
        fields: &mut Fields<'_>,
        rims: &[Rim],
        rim: usize,
        step_m: f64,
    ) -> Result<Self, Unclear> {
        // Off the planes in which symmetric bodies have their walls.
        let origin = rims[rim].points()[0] + Vector3::new(0.31, 0.47, 0.59) * step_m;
        let mut lattice = Lattice {
            fields,
            origin,
            step_m,
            values: BTreeMap::new(),
        };
        let cells = lattice.follow(rims[rim].points())?;
        let (points, depths, triangles) = lattice.triangles(&cells);
        let (points, triangles) = cut(points, &depths, &triangles);
        // What the cut added is on a rim.
        let depth = |v: usize| depths.get(v).copied().unwrap_or(0.0);
        piece(&points, &triangles, depth, rims, rim, step_m)
    }
}

impl Lattice<'_, '_> {
    fn point(&self, site: Site) -> Point3 {
        self.origin + Vector3::from(site.map(f64::from)) * self.step_m
    }

    fn value(&mut self, site: Site) -> [f64; 2] {
        if let Some(&known) = self.values.get(&site) {
            return known;
        }
        let depths = self.fields.at(&self.point(site));
        let value = [depths.lead(), depths.mean()];
        self.values.insert(site, value);
        value
    }

    /// Cells of the wall, by their first corners.
    fn follow(&mut self, rim: &[Point3]) -> Result<BTreeSet<Site>, Unclear> {
        let cell = |p: &Point3| {
            let local = (p - self.origin) / self.step_m;
            [local.x, local.y, local.z].map(|x| x.floor() as i32)
        };
        let mut seen: BTreeSet<Site> = rim.iter().map(cell).collect();
        let mut next: Vec<Site> = seen.iter().copied().collect();
        let mut found = BTreeSet::new();
        // Nothing of the wall is in a cell all of whose corners are farther outside than its half diagonal.
        let reach_m = 0.87 * self.step_m;
        while let Some(site) = next.pop() {
            let corners: [_; 8] = std::array::from_fn(|c| self.value(corner(site, c)));
            let changes = corners
                .iter()
                .any(|c| (c[0] < 0.0) != (corners[0][0] < 0.0));
            if !(changes && corners.iter().any(|c| c[1] <= reach_m)) {
                continue;
            }
            found.insert(site);
            for axis in 0..3 {
                for by in [-1, 1] {
                    let mut beside = site;
                    beside[axis] += by;
                    if seen.insert(beside) {
                        next.push(beside);
                    }
                }
            }
            if found.len() > MOST_CELLS {
                return Err(Unclear::Large);
            }
        }
        Ok(found)
    }

    /// Triangles of all cells, with the mean depth at their corners.
    fn triangles(&mut self, cells: &BTreeSet<Site>) -> (Vec<Point3>, Vec<f64>, Vec<[usize; 3]>) {
        let (mut points, mut depths, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        let mut known: BTreeMap<(Site, usize), usize> = BTreeMap::new();
        for &site in cells {
            for way in WAYS {
                let bits = [0, way[0], way[1], 7];
                let values = bits.map(|c| self.value(corner(site, c)));
                let mut vertex = |a: usize, b: usize| {
                    let (a, b) = (a.min(b), a.max(b));
                    let key = (corner(site, bits[a]), bits[b] ^ bits[a]);
                    *known.entry(key).or_insert_with(|| {
                        let ends = [a, b].map(|k| self.point(corner(site, bits[k])));
                        let t = values[a][0] / (values[a][0] - values[b][0]);
                        let t = t.clamp(MARGIN, 1.0 - MARGIN);
                        points.push(ends[0] + (ends[1] - ends[0]) * t);
                        depths.push(values[a][1] + (values[b][1] - values[a][1]) * t);
                        points.len() - 1
                    })
                };
                for edges in facets(values.map(|v| v[0] < 0.0), bits) {
                    triangles.push(edges.map(|[a, b]| vertex(a, b)));
                }
            }
        }
        (points, depths, triangles)
    }
}

fn corner(site: Site, bits: usize) -> Site {
    std::array::from_fn(|axis| site[axis] + (bits >> axis & 1) as i32)
}

/// Triangles between the corners below and the others, as edges of the tetrahedron; they turn to the left as seen from the
/// others.
fn facets(below: [bool; 4], bits: [usize; 4]) -> Vec<[[usize; 2]; 3]> {
    let [low, high]: [Vec<usize>; 2] =
        [true, false].map(|side| (0..4).filter(|&k| below[k] == side).collect());
    let mut all = match (low.as_slice(), high.as_slice()) {
        (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => vec![[[a, b], [a, c], [a, d]]],
        (&[a, b], &[c, d]) => vec![[[a, c], [a, d], [b, d]], [[a, c], [b, d], [b, c]]],
        _ => return Vec::new(),
    };
    // Middles of edges decide the direction: they are in one plane that parts the corners.
    let at = |k: usize| Vector3::from([0, 1, 2].map(|axis| (bits[k] >> axis & 1) as f64));
    let mean = |side: &[usize]| side.iter().map(|&k| at(k)).sum::<Vector3>() / side.len() as f64;
    let up = mean(&high) - mean(&low);
    for triangle in &mut all {
        let [p, q, r] = triangle.map(|[a, b]| 0.5 * (at(a) + at(b)));
        if (q - p).cross(&(r - p)).dot(&up) < 0.0 {
            triangle.swap(1, 2);
        }
    }
    all
}

/// The part of a mesh where the depth is below 0.
fn cut(
    mut points: Vec<Point3>,
    depths: &[f64],
    triangles: &[[usize; 3]],
) -> (Vec<Point3>, Vec<[usize; 3]>) {
    let mut known: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let mut out = Vec::new();
    for triangle in triangles {
        let mut ring = Vec::with_capacity(4);
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            if depths[a] < 0.0 {
                ring.push(a);
            }
            if (depths[a] < 0.0) != (depths[b] < 0.0) {
                let [a, b] = [a.min(b), a.max(b)];
                ring.push(*known.entry([a, b]).or_insert_with(|| {
                    let t = (depths[a] / (depths[a] - depths[b])).clamp(MARGIN, 1.0 - MARGIN);
                    points.push(points[a] + (points[b] - points[a]) * t);
                    points.len() - 1
                }));
            }
        }
        out.extend((2..ring.len()).map(|k| [ring[0], ring[k - 1], ring[k]]));
    }
    (points, out)
}

/// The connected piece that ends at a rim, with its loops.
fn piece(
    points: &[Point3],
    triangles: &[[usize; 3]],
    depth: impl Fn(usize) -> f64,
    rims: &[Rim],
    rim: usize,
    step_m: f64,
) -> Result<Sheet, Unclear> {
    let root = connected(points.len(), triangles);
    let mut loops = Vec::new();
    for ring in boundary(triangles).ok_or(Unclear::Coarse)? {
        let off_m = |rim: &Rim| {
            let away = ring.iter().map(|&v| rim.nearest(&points[v]).1);
            away.sum::<f64>() / ring.len() as f64
        };
        let away: Vec<f64> = rims.iter().map(off_m).collect();
        let nearest = (0..rims.len()).min_by(|&a, &b| away[a].total_cmp(&away[b]));
        let near = nearest.filter(|&k| away[k] <= 2.0 * step_m);
        loops.push((near, ring));
    }
    let of_rim = loops.iter().find(|(near, _)| *near == Some(rim));
    let wanted = root[of_rim.ok_or(Unclear::Coarse)?.1[0]];
    loops.retain(|(_, ring)| root[ring[0]] == wanted);
    let mut sheet = Sheet::default();
    let mut number = vec![usize::MAX; points.len()];
    let mut taken = |v: usize| {
        if number[v] == usize::MAX {
            number[v] = sheet.points.len();
            sheet.points.push(points[v]);
        }
        number[v]
    };
    for triangle in triangles.iter().filter(|t| root[t[0]] == wanted) {
        sheet.triangles.push(triangle.map(&mut taken));
    }
    for (near, ring) in loops {
        let near = near.ok_or(Unclear::Coarse)?;
        let ring = ring.into_iter().map(&mut taken).collect();
        if sheet.loops.iter().any(|(known, _)| *known == near) {
            return Err(Unclear::Coarse);
        }
        sheet.loops.push((near, ring));
    }
    let kept = (0..points.len()).filter(|&v| number[v] != usize::MAX);
    let deepest = kept.min_by(|&a, &b| depth(a).total_cmp(&depth(b)));
    sheet.deepest = deepest.map_or(0, |v| number[v]);
    // As a sphere with as many holes as there are loops: vertices − edges + triangles, where each triangle has 3 / 2
    // edges and each edge of the boundary half a one.
    let rim_edges: usize = sheet.loops.iter().map(|(_, ring)| ring.len()).sum();
    let twice =
        2 * sheet.points.len() as isize - sheet.triangles.len() as isize - rim_edges as isize;
    match twice == 2 * (2 - sheet.loops.len() as isize) {
        true => Ok(sheet),
        false => Err(Unclear::Coarse),
    }
}

/// By vertex: a number that all vertices of a piece share.
fn connected(count: usize, triangles: &[[usize; 3]]) -> Vec<usize> {
    let mut root: Vec<usize> = (0..count).collect();
    fn find(root: &mut [usize], mut v: usize) -> usize {
        while root[v] != v {
            root[v] = root[root[v]];
            v = root[v];
        }
        v
    }
    for &[a, b, c] in triangles {
        for (a, b) in [(a, b), (b, c)] {
            let (a, b) = (find(&mut root, a), find(&mut root, b));
            root[a.max(b)] = a.min(b);
        }
    }
    (0..count).map(|v| find(&mut root, v)).collect()
}

/// Loops of edges that have a triangle on their left only; `None` where they are not simple.
fn boundary(triangles: &[[usize; 3]]) -> Option<Vec<Vec<usize>>> {
    let edges = || {
        triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
    };
    let all: BTreeSet<(usize, usize)> = edges().collect();
    let mut after: BTreeMap<usize, usize> = BTreeMap::new();
    for (a, b) in edges().filter(|&(a, b)| !all.contains(&(b, a))) {
        if after.insert(a, b).is_some() {
            return None;
        }
    }
    let mut loops = Vec::new();
    while let Some((start, mut next)) = after.pop_first() {
        let mut ring = vec![start];
        while next != start {
            ring.push(next);
            next = after.remove(&next)?;
        }
        loops.push(ring);
    }
    Some(loops)
}
