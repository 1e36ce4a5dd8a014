//! Regions of intersection: one for each connected line in which the two meshes cross.
//!
//! ```text
//! cuts → segments that share a triangle are one line → its vector area is the region's normal
//! corners of one body inside the other → the region whose line is nearest
//! ```
//! The vector area A = ½ Σ p × q of a closed line, with its segments p → q along n₁ × n₂, is for a
//! quadrilateral the cross product of its diagonals over two, the normal of a region in the thesis;
//! the sum holds for any line.

use super::pair::{Cut, Cuts, Pair};
use palpate_geometry::math::{Matrix3, Vector3};
use std::f64::consts::PI;

/// A line whose vector area is below this share of that of the circle of its length has no normal.
const FLAT: f64 = 1e-3;
/// Share of the triangles whose pairs may be parallel before lines are not to be trusted.
const PARALLEL_SHARE: f64 = 0.05;

/// A region of intersection, m.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// Unit; from the orientation of the line. `None` when the line encloses no area.
    pub normal: Option<Vector3>,
    /// Mean of its points.
    centre: Vector3,
    /// From the point on the moving body to the farthest one on the fixed body.
    pub farthest: Vector3,
}

/// Why no regions were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoRegions {
    /// The meshes do not cross.
    NoLine,
    /// They coincide in parts.
    Coincident,
}

/// All regions at a place, in their order along the first principal axis of their centres.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    pub list: Vec<Region>,
    /// Place in `list` of the one with the farthest pair: region 1 of the methods.
    pub first: usize,
}

impl Regions {
    pub fn new(pair: &Pair<'_>, translation: &Vector3) -> Result<Self, NoRegions> {
        let cuts = pair.cuts(translation);
        let triangles = pair.moving.triangle_count() + pair.fixed.triangle_count();
        if cuts.parallel as f64 > PARALLEL_SHARE * triangles as f64 {
            return Err(NoRegions::Coincident);
        }
        let lines = lines(pair, &cuts);
        if lines.is_empty() {
            return Err(NoRegions::NoLine);
        }
        let inside = inside(pair, translation);
        let mut points = lines
            .iter()
            .map(|line| line_points(line))
            .map(|p| [p.clone(), p])
            .collect::<Vec<_>>();
        let ends: Vec<Vec<Vector3>> = points.iter().map(|[p, _]| p.clone()).collect();
        for (k, corners) in inside.iter().enumerate() {
            for corner in corners {
                points[nearest_line(&ends, corner)][k].push(*corner);
            }
        }
        let mut list: Vec<Region> = lines
            .iter()
            .zip(&points)
            .map(|(line, [moving, fixed])| Region {
                normal: normal(line),
                centre: mean(moving, fixed),
                farthest: farthest(moving, fixed),
            })
            .collect();
        sort(&mut list);
        let first = (0..list.len()).fold(0, |best, k| {
            if list[k].farthest.norm_squared() > list[best].farthest.norm_squared() {
                k
            } else {
                best
            }
        });
        Ok(Self { list, first })
    }

    /// The region of the farthest pair.
    pub fn region_1(&self) -> &Region {
        &self.list[self.first]
    }
}

/// Segments that share a triangle, joined; in order of their first segment.
fn lines(pair: &Pair<'_>, cuts: &Cuts) -> Vec<Vec<Cut>> {
    let mut to: Vec<usize> = (0..cuts.segments.len()).collect();
    let root = |to: &[usize], mut k: usize| {
        while to[k] != k {
            k = to[k];
        }
        k
    };
    let counts = [pair.moving.triangle_count(), pair.fixed.triangle_count()];
    let mut seen = counts.map(|count| vec![usize::MAX; count]);
    for (k, cut) in cuts.segments.iter().enumerate() {
        for (body, &triangle) in cut.triangles.iter().enumerate() {
            let before = &mut seen[body][triangle as usize];
            if *before == usize::MAX {
                *before = k;
                continue;
            }
            let (a, b) = (root(&to, *before), root(&to, k));
            to[a.max(b)] = a.min(b);
            // A shorter way for those that come later.
            to[k] = a.min(b);
        }
    }
    let mut place = vec![usize::MAX; cuts.segments.len()];
    let mut lines: Vec<Vec<Cut>> = Vec::new();
    for (k, cut) in cuts.segments.iter().enumerate() {
        let r = root(&to, k);
        if place[r] == usize::MAX {
            place[r] = lines.len();
            lines.push(Vec::new());
        }
        lines[place[r]].push(*cut);
    }
    lines
}

fn line_points(line: &[Cut]) -> Vec<Vector3> {
    line.iter().flat_map(|cut| cut.ends).collect()
}

/// Corners of (the moving, the fixed) body inside the other one, where they stand.
fn inside(pair: &Pair<'_>, translation: &Vector3) -> [Vec<Vector3>; 2] {
    let by = pair.moved_by(translation);
    let moving = pair
        .moving
        .points
        .iter()
        .map(|p| p + by)
        .filter(|p| pair.fixed.winding(p) != 0);
    let fixed = pair
        .fixed
        .points
        .iter()
        .filter(|p| pair.moving.winding(&(*p - by)) != 0)
        .copied();
    [moving.collect(), fixed.collect()]
}

fn nearest_line(lines: &[Vec<Vector3>], point: &Vector3) -> usize {
    if lines.len() == 1 {
        return 0;
    }
    let distance = |line: &Vec<Vector3>| {
        line.iter()
            .map(|p| (p - point).norm_squared())
            .fold(f64::INFINITY, f64::min)
    };
    let mut best = (f64::INFINITY, 0);
    for (k, line) in lines.iter().enumerate() {
        let d = distance(line);
        if d < best.0 {
            best = (d, k);
        }
    }
    best.1
}

fn normal(line: &[Cut]) -> Option<Vector3> {
    let origin = line[0].ends[0];
    let length: f64 = line
        .iter()
        .map(|cut| (cut.ends[1] - cut.ends[0]).norm())
        .sum();
    let area = line
        .iter()
        .map(|cut| (cut.ends[0] - origin).cross(&(cut.ends[1] - origin)))
        .fold(Vector3::zeros(), |sum, x| sum + x)
        / 2.0;
    (area.norm() >= FLAT * length * length / (4.0 * PI))
        .then(|| area.try_normalize(0.0))
        .flatten()
}

fn mean(a: &[Vector3], b: &[Vector3]) -> Vector3 {
    let sum = a.iter().chain(b).fold(Vector3::zeros(), |sum, p| sum + p);
    sum / (a.len() + b.len()) as f64
}

/// From the point of `a` to the point of `b` that is farthest from it, of all pairs.
///
/// Points far from the common mean come first; two of them are no farther apart than their
/// distances from it together, so the search ends early.
pub(super) fn farthest(a: &[Vector3], b: &[Vector3]) -> Vector3 {
    let middle = mean(a, b);
    let sorted = |points: &[Vector3]| {
        let mut far: Vec<(f64, Vector3)> =
            points.iter().map(|p| ((p - middle).norm(), *p)).collect();
        far.sort_by(|x, y| y.0.total_cmp(&x.0));
        far
    };
    let (a, b) = (sorted(a), sorted(b));
    let mut best = (-1.0_f64, Vector3::zeros());
    for (from_a, q) in &a {
        for (from_b, p) in &b {
            if from_a + from_b <= best.0 {
                break;
            }
            let distance = (p - q).norm();
            if distance > best.0 {
                best = (distance, p - q);
            }
        }
    }
    best.1
}

/// Along the first principal axis of the centres; if it is not defined, along the line through the
/// two farthest apart.
fn sort(list: &mut [Region]) {
    let middle = list.iter().fold(Vector3::zeros(), |sum, r| sum + r.centre) / list.len() as f64;
    let spread = list.iter().fold(Matrix3::zeros(), |sum, r| {
        let d = r.centre - middle;
        sum + d * d.transpose()
    });
    // Power iteration: three dozen squarings leave nothing of the other axes.
    let mut matrix = spread;
    for _ in 0..36 {
        let scale = matrix.norm();
        if !(scale > 0.0 && scale.is_finite()) {
            return;
        }
        matrix /= scale;
        matrix = matrix * matrix;
    }
    let column = (0..3).fold(0, |best, k| {
        if matrix.column(k).norm_squared() > matrix.column(best).norm_squared() {
            k
        } else {
            best
        }
    });
    let axis: Vector3 = matrix.column(column).into_owned();
    list.sort_by(|a, b| axis.dot(&a.centre).total_cmp(&axis.dot(&b.centre)));
}
