//! Rims nested in the plane: what they bound is the caps.

use super::rim::{RimEdge, RimPiece};
use super::{CutError, CutPlane};
use crate::math::{Point3, Vector3, gauss_legendre};

/// Places of each piece of a rim where it is asked what is inside.
const LOOKS: usize = 8;

/// A rim as the plane sees it.
struct Outline {
    /// m².
    area_m2: f64,
    places: Vec<[f64; 2]>,
    low: [f64; 2],
    high: [f64; 2],
}

/// Two directions along the plane; the first × the second is its normal.
pub(super) fn directions(plane: &CutPlane) -> [Vector3; 2] {
    let n = plane.normal;
    let least = Vector3::ith(n.iamin(), 1.0);
    let x = (least - n * n.dot(&least)).normalize();
    [x, n.cross(&x)]
}

fn pieces(edges: &[RimEdge]) -> impl Iterator<Item = &RimPiece> {
    edges.iter().flat_map(|edge| match edge {
        RimEdge::Cut(pieces) => pieces.as_slice(),
        RimEdge::Border(..) => &[],
    })
}

/// Groups of rims that bound one cap each, the outer one first, and each cap's area (m²). `rims`: the edges of a rim, and
/// whether what it bounds is on its left as the normal sees it.
pub(super) fn caps(
    plane: &CutPlane,
    rims: &[(&[RimEdge], bool)],
) -> Result<Vec<(Vec<usize>, f64)>, CutError> {
    let rule = gauss_legendre(super::rim::ORDER);
    let [x, y] = directions(plane);
    let outlines: Vec<Outline> = rims
        .iter()
        .map(|(edges, left)| {
            let area: f64 = pieces(edges).map(|piece| piece.swept(plane, &rule)).sum();
            let at = |p: Point3| [x.dot(&p.coords), y.dot(&p.coords)];
            let places = pieces(edges).flat_map(|piece| {
                (0..LOOKS).map(move |k| at(piece.point(k as f64 / LOOKS as f64)))
            });
            Outline::new(if *left { area } else { -area }, places.collect())
        })
        .collect();
    let outer: Vec<usize> = (0..rims.len())
        .filter(|&k| outlines[k].area_m2 > 0.0)
        .collect();
    let mut caps: Vec<(Vec<usize>, f64)> = outer
        .iter()
        .map(|&k| (vec![k], outlines[k].area_m2))
        .collect();
    for hole in 0..rims.len() {
        if outlines[hole].area_m2 > 0.0 {
            continue;
        }
        let around = (0..outer.len()).filter(|&c| outlines[outer[c]].holds(&outlines[hole]));
        let least = around.min_by(|&a, &b| {
            let area = |c: usize| outlines[outer[c]].area_m2;
            area(a).total_cmp(&area(b))
        });
        let Some(cap) = least else {
            let place = pieces(rims[hole].0).next().map(|piece| piece.points[0]);
            let Point3 { coords } = place.unwrap_or_else(Point3::origin);
            let [x, y, z] = coords.into();
            return Err(CutError::Crossed { x, y, z });
        };
        caps[cap].0.push(hole);
        caps[cap].1 += outlines[hole].area_m2;
    }
    Ok(caps)
}

impl Outline {
    fn new(area_m2: f64, places: Vec<[f64; 2]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in &places {
            for d in 0..2 {
                low[d] = low[d].min(place[d]);
                high[d] = high[d].max(place[d]);
            }
        }
        Self {
            area_m2,
            places,
            low,
            high,
        }
    }

    /// Most places of another one are inside: all of them, but where both touch.
    fn holds(&self, other: &Self) -> bool {
        let apart = (0..2).any(|d| other.low[d] > self.high[d] || other.high[d] < self.low[d]);
        if apart {
            return false;
        }
        let step = (other.places.len() / 31).max(1);
        let asked: Vec<bool> = (other.places.iter())
            .step_by(step)
            .map(|p| self.contains(p))
            .collect();
        2 * asked.iter().filter(|inside| **inside).count() > asked.len()
    }

    /// By crossings of the ray towards +x.
    fn contains(&self, [x, y]: &[f64; 2]) -> bool {
        let n = self.places.len();
        let mut inside = false;
        for k in 0..n {
            let ([ax, ay], [bx, by]) = (self.places[k], self.places[(k + 1) % n]);
            if (ay > *y) != (by > *y) && *x < ax + (bx - ax) * (y - ay) / (by - ay) {
                inside = !inside;
            }
        }
        inside
    }
}
