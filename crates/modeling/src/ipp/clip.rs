//! Where the convex hull of control points meets the axis: one projection of the projected
//! polyhedron.
//!
//! Over x = i/m stand the lowest and the highest value of the coefficients with index i. The
//! polynomial can vanish at x only where the lower hull is at or below 0 and the upper hull at or
//! above (Sherbrooke & Patrikalakis 1993).

/// The part of [0, 1] where the hull of the points (i/m, lower_i) and (i/m, upper_i) meets 0;
/// `None` where it does not.
pub fn crossing(lower: &[f64], upper: &[f64]) -> Option<(f64, f64)> {
    let (a, b) = below(lower.len(), |i| lower[i])?;
    let (c, d) = below(upper.len(), |i| -upper[i])?;
    let (start, end) = (a.max(c), b.min(d));
    (start <= end).then_some((start, end))
}

/// The x of the hull's points at or below 0: they end in a point there or on a segment that passes
/// from above 0 to it.
fn below(count: usize, value: impl Fn(usize) -> f64) -> Option<(f64, f64)> {
    let m = (count.max(2) - 1) as f64;
    let first = (0..count).find(|&i| value(i) <= 0.0)?;
    let last = (0..count).rfind(|&i| value(i) <= 0.0)?;
    if count == 1 {
        return Some((0.0, 1.0));
    }
    let (mut start, mut end) = (first as f64, last as f64);
    for j in first..=last {
        let low = value(j);
        if low > 0.0 {
            continue;
        }
        for i in 0..first {
            let high = value(i);
            start = start.min(i as f64 + (j - i) as f64 * (high / (high - low)));
        }
        for i in last + 1..count {
            let high = value(i);
            end = end.max(i as f64 - (i - j) as f64 * (high / (high - low)));
        }
    }
    Some((start / m, end / m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    // Patrikalakis & Maekawa, table 4.5: (t − 0.1)(t − 0.6)(t − 0.7).
    #[test]
    fn the_published_first_box_comes_out() {
        let roots = [0.1, 0.6, 0.7];
        // The blossom of t − a, t − b, t − c at k ones.
        let coefficients: Vec<f64> = (0..4)
            .map(|k| {
                let orders = [
                    [0, 1, 2],
                    [0, 2, 1],
                    [1, 0, 2],
                    [1, 2, 0],
                    [2, 0, 1],
                    [2, 1, 0],
                ];
                let product = |o: &[usize; 3]| {
                    (0..3)
                        .map(|place| f64::from(u8::from(place < k)) - roots[o[place]])
                        .product::<f64>()
                };
                orders.iter().map(product).sum::<f64>() / 6.0
            })
            .collect();
        let (start, end) = crossing(&coefficients, &coefficients).unwrap();
        assert!((start - 0.076_363_636_363_635).abs() < 1e-14, "{start}");
        assert!((end - 0.856_000_000_000_001).abs() < 2e-15, "{end}");
    }

    #[test]
    fn the_crossing_is_that_of_all_segments_between_points() {
        let mut random = Random(5);
        for _ in 0..2_000 {
            let m = random.integer(1, 9);
            let lower: Vec<f64> = (0..=m).map(|_| random.float(-1.0, 1.0)).collect();
            let upper: Vec<f64> = lower.iter().map(|l| l + random.float(0.0, 0.2)).collect();
            let hull = |x: f64, values: &[f64], sign: f64| {
                let mut least = f64::INFINITY;
                for i in 0..=m {
                    for j in i..=m {
                        let (a, b) = (i as f64 / m as f64, j as f64 / m as f64);
                        if a - 1e-12 <= x && x <= b + 1e-12 {
                            let t = if j > i { (x - a) / (b - a) } else { 0.0 };
                            least = least.min(sign * ((1.0 - t) * values[i] + t * values[j]));
                        }
                    }
                }
                least
            };
            let found = crossing(&lower, &upper);
            for k in 0..=100 {
                let x = f64::from(k) / 100.0;
                let meets = hull(x, &lower, 1.0) < -1e-9 && hull(x, &upper, -1.0) < -1e-9;
                let inside = found.is_some_and(|(start, end)| start <= x && x <= end);
                assert!(!meets || inside, "{lower:?}: {x} is missing from {found:?}");
                let clear = hull(x, &lower, 1.0) > 1e-9 || hull(x, &upper, -1.0) > 1e-9;
                assert!(
                    !clear || !inside,
                    "{lower:?}: {x} should not be in {found:?}"
                );
            }
        }
    }
}
