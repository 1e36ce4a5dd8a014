//! Which rims bound the same region of a surface, so that each region is a face of its own.
//!
//! A path over the surface that crosses every rim an even number of times stays in its region; where a surface goes round
//! both ways, paths round it are tried too.

use super::fields::Fields;
use super::rim::Rim;
use palpate_geometry::math::{Point3, Vector3};

/// Places of a path.
const STEPS: usize = 256;
/// Halvings between two of them.
const HALVINGS: usize = 40;
/// How far beside a rim a path begins, of its length and the body's size; halved so many times.
const BESIDE: f64 = 1e-2;
const NEARER: usize = 20;

/// Rims by regions of a body's surface outside the other body.
pub(super) fn regions(fields: &mut Fields<'_>, body: usize, rims: &[Rim]) -> Vec<Vec<usize>> {
    let starts: Vec<Option<[f64; 2]>> =
        (rims.iter()).map(|rim| beside(fields, body, rim)).collect();
    let mut regions: Vec<Vec<usize>> = Vec::new();
    for (k, start) in starts.iter().enumerate() {
        let same = regions.iter().position(|region| {
            let first = starts[region[0]];
            match (first, start) {
                (Some(a), Some(b)) => connected(fields, body, rims, a, *b),
                // Nothing is known: one face with all rims is no worse than a wrong one.
                _ => true,
            }
        });
        match same {
            Some(region) => regions[region].push(k),
            None => regions.push(vec![k]),
        }
    }
    regions
}

/// Parameters of a place of the body's surface beside a rim, outside the other body.
fn beside(fields: &mut Fields<'_>, body: usize, rim: &Rim) -> Option<[f64; 2]> {
    let start = rim.points()[0];
    let normals = fields.at(&start).normals;
    let (own, other) = (normals[body], normals[1 - body]);
    let out: Vector3 = (other - own * own.dot(&other)).try_normalize(1e-9)?;
    let mut step_m = BESIDE * rim.length_m().min(fields.size_m);
    for _ in 0..NEARER {
        let foot = fields.foot(body, &(start + out * step_m));
        if fields.phi(1 - body, &foot.point) > 0.0 {
            return Some([foot.u, foot.v]);
        }
        step_m *= 0.5;
    }
    None
}

fn connected(
    fields: &mut Fields<'_>,
    body: usize,
    rims: &[Rim],
    from: [f64; 2],
    to: [f64; 2],
) -> bool {
    let surface = fields.surfaces[body];
    let round = [surface.knots_u(), surface.knots_v()].map(|knots| match knots.is_periodic() {
        true => knots.length(),
        false => 0.0,
    });
    // On a surface that is like a sphere one path decides.
    let turns: &[f64] = if round[0] * round[1] > 0.0 {
        &[0.0, -1.0, 1.0]
    } else {
        &[0.0]
    };
    turns.iter().any(|i| {
        turns.iter().any(|j| {
            let end = [to[0] + i * round[0], to[1] + j * round[1]];
            crossings(fields, body, rims, from, end)
                .iter()
                .all(|odd| !odd)
        })
    })
}

/// By rim: a straight path in the parameters crosses it an odd number of times.
fn crossings(
    fields: &mut Fields<'_>,
    body: usize,
    rims: &[Rim],
    from: [f64; 2],
    to: [f64; 2],
) -> Vec<bool> {
    let surface = fields.surfaces[body];
    let place = |t: f64| -> Point3 {
        let [u, v] = [0, 1].map(|k| from[k] + t * (to[k] - from[k]));
        surface.point(surface.knots_u().confine(u), surface.knots_v().confine(v))
    };
    let mut odd = vec![false; rims.len()];
    let mut before = true;
    for k in 1..=STEPS {
        let t = k as f64 / STEPS as f64;
        let outside = fields.phi(1 - body, &place(t)) > 0.0;
        if outside != before {
            let (mut low, mut high) = (t - 1.0 / STEPS as f64, t);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                match (fields.phi(1 - body, &place(middle)) > 0.0) == before {
                    true => low = middle,
                    false => high = middle,
                }
            }
            let at = place(high);
            let away = |rim: &Rim| rim.nearest(&at).1;
            let nearest =
                (0..rims.len()).min_by(|&a, &b| away(&rims[a]).total_cmp(&away(&rims[b])));
            odd[nearest.unwrap_or(0)] ^= true;
        }
        before = outside;
    }
    odd
}
