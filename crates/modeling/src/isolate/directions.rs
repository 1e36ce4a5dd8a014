//! The displacements of the seven methods, from the regions at one place.

use super::Reason;
use super::pair::Pair;
use super::regions::{NoRegions, Regions, farthest};
use palpate_geometry::math::Vector3;

/// A cosine below this does not decide on which side a normal points.
const UNDECIDED: f64 = 0.05;

/// Which displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum DirectionRule {
    /// 1: from the farthest pair of all.
    Farthest,
    /// 2: components of the farthest pair of region 1, signs by the extents.
    FarthestOfRegion,
    /// 3: normal of region 1.
    Normal,
    /// 4: weighted normals of all regions.
    Normals,
    /// 5: line of the centroids.
    Centroids,
    /// 6 and 7: a × rule 4 + b × rule 5.
    Blend(f64, f64),
}

/// What a step moves by.
pub(super) fn displacement(
    rule: DirectionRule,
    pair: &Pair<'_>,
    translation: &Vector3,
) -> Result<Vector3, Reason> {
    if rule == DirectionRule::Farthest {
        let by = pair.moved_by(translation);
        let moving: Vec<Vector3> = pair.moving.points.iter().map(|p| p + by).collect();
        return Ok(farthest(&moving, &pair.fixed.points));
    }
    let regions = Regions::new(pair, translation).map_err(|none| match none {
        NoRegions::NoLine => Reason::NoRegion,
        NoRegions::Coincident => Reason::Coincident,
    })?;
    let signed = by_extents(pair, translation, &regions.region_1().farthest);
    if rule == DirectionRule::FarthestOfRegion {
        return Ok(signed);
    }
    // The step length of all the others, the largest component, depends on the axes; the thesis has
    // it so.
    let length = signed.amax();
    Ok(unit(rule, pair, translation, &regions, &signed)? * length)
}

/// The unit vectors of the methods 4, 5 and 6 at the start, those that there are.
pub(super) fn starts(pair: &Pair<'_>) -> Vec<Vector3> {
    let at = Vector3::zeros();
    let mut found = Vec::with_capacity(3);
    match Regions::new(pair, &at) {
        Ok(regions) => {
            let signed = by_extents(pair, &at, &regions.region_1().farthest);
            for rule in [
                DirectionRule::Blend(0.5, 0.5),
                DirectionRule::Centroids,
                DirectionRule::Normals,
            ] {
                found.extend(unit(rule, pair, &at, &regions, &signed).ok());
            }
        }
        Err(_) => found.extend(centroids(pair, &at).ok()),
    }
    found
}

fn unit(
    rule: DirectionRule,
    pair: &Pair<'_>,
    translation: &Vector3,
    regions: &Regions,
    signed: &Vector3,
) -> Result<Vector3, Reason> {
    match rule {
        DirectionRule::Farthest | DirectionRule::FarthestOfRegion => {
            signed.try_normalize(0.0).ok_or(Reason::NoNormal)
        }
        DirectionRule::Normal => {
            let normal = regions.region_1().normal.ok_or(Reason::NoNormal)?;
            Ok(sided(normal, pair, translation, signed))
        }
        DirectionRule::Normals => normals(pair, translation, regions, signed),
        DirectionRule::Centroids => centroids(pair, translation),
        DirectionRule::Blend(a, b) => {
            let by_normals = if a > 0.0 {
                Some(normals(pair, translation, regions, signed)?)
            } else {
                None
            };
            let by_centroids = if b > 0.0 {
                centroids(pair, translation).ok()
            } else {
                None
            };
            let sum = match (by_normals, by_centroids) {
                (Some(x), Some(y)) => x * a + y * b,
                (Some(x), None) | (None, Some(x)) => x,
                (None, None) => return Err(Reason::CoincidentCentroids),
            };
            sum.try_normalize(1e-9).ok_or(Reason::NoNormal)
        }
    }
}

/// Method 4: region 1 and its neighbours on either side, the i-th with the weight 1 / sqrt(1 + i).
fn normals(
    pair: &Pair<'_>,
    translation: &Vector3,
    regions: &Regions,
    signed: &Vector3,
) -> Result<Vector3, Reason> {
    let mut sum = Vector3::zeros();
    for (k, region) in regions.list.iter().enumerate() {
        let away = k.abs_diff(regions.first);
        if let Some(normal) = region.normal {
            sum += sided(normal, pair, translation, signed) / ((1 + away) as f64).sqrt();
        }
    }
    let normal = sum.try_normalize(1e-9).ok_or(Reason::NoNormal)?;
    Ok(sided(normal, pair, translation, signed))
}

/// Method 5.
fn centroids(pair: &Pair<'_>, translation: &Vector3) -> Result<Vector3, Reason> {
    let between = pair.between_centroids() + translation;
    between
        .try_normalize(1e-9 * pair.diameter_m)
        .ok_or(Reason::CoincidentCentroids)
}

/// The normal or its opposite: with the displacement of method 2, or where that is nearly at right
/// angles, with the centroids.
fn sided(normal: Vector3, pair: &Pair<'_>, translation: &Vector3, signed: &Vector3) -> Vector3 {
    let cosine = signed.try_normalize(0.0).map_or(0.0, |m| m.dot(&normal));
    let decides = if cosine.abs() < UNDECIDED {
        (pair.between_centroids() + translation).dot(&normal)
    } else {
        cosine
    };
    if decides < 0.0 { -normal } else { normal }
}

/// Method 2: the lengths of `distance` along the axes, each towards the side that the extents say.
fn by_extents(pair: &Pair<'_>, translation: &Vector3, distance: &Vector3) -> Vector3 {
    let by = pair.moved_by(translation);
    let (a, b) = (pair.moving.block(), pair.fixed.block());
    Vector3::from_fn(|k, _| {
        let (a0, a1) = (a.low[k] + by[k], a.high[k] + by[k]);
        let (b0, b1) = (b.low[k], b.high[k]);
        let sign = if a0 > b1 {
            1.0
        } else if a1 < b0 {
            -1.0
        } else if a1 > b1 || a0 > b0 {
            1.0
        } else {
            -1.0
        };
        sign * distance[k].abs()
    })
}
