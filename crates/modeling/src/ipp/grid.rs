//! Plain arithmetic on grids of Bernstein coefficients: values, gradients, parts. The errors are
//! bounded by the caller.

/// Value and gradient at a point, all from sums of non-negative basis functions.
pub fn value_and_gradient(c: &[f64], [p, q]: [usize; 2], at: [f64; 2]) -> (f64, [f64; 2]) {
    let ((bs, ds), (bt, dt)) = (basis(p, at[0]), basis(q, at[1]));
    let (mut value, mut gradient) = (0.0, [0.0; 2]);
    for (row, (b, d)) in c.chunks(q + 1).zip(bs.iter().zip(&ds)) {
        let along: f64 = row.iter().zip(&bt).map(|(c, b)| c * b).sum();
        let slope: f64 = row.iter().zip(&dt).map(|(c, d)| c * d).sum();
        value += b * along;
        gradient[0] += d * along;
        gradient[1] += b * slope;
    }
    (value, gradient)
}

/// Highest degree of a basis in one variable: bodies of degree 15 give 3 · 15 − 2.
const MOST: usize = 44;

/// The Bernstein polynomials of a degree and their derivatives.
fn basis(degree: usize, t: f64) -> ([f64; MOST], [f64; MOST]) {
    debug_assert!(degree < MOST, "degree {degree} is above what splines give");
    let (mut b, mut d) = ([0.0; MOST], [0.0; MOST]);
    b[0] = 1.0;
    for k in 1..=degree {
        if k == degree {
            for i in 0..=degree {
                let (left, right) = (
                    if i > 0 { b[i - 1] } else { 0.0 },
                    if i < degree { b[i] } else { 0.0 },
                );
                d[i] = degree as f64 * (left - right);
            }
        }
        for i in (0..=k).rev() {
            b[i] = (1.0 - t) * b[i] + if i > 0 { t * b[i - 1] } else { 0.0 };
        }
    }
    (b, d)
}

/// The part on [start, end] in one variable (0 or 1), in place. Ends may be a little outside [0,
/// 1].
pub fn restrict(c: &mut [f64], [p, q]: [usize; 2], axis: usize, start: f64, end: f64) {
    let width = q + 1;
    if axis == 0 {
        cut(p, start, end, |low, keep, t| {
            let (a, b) = c[low * width..(low + 2) * width].split_at_mut(width);
            blend(a, b, keep, t);
        });
    } else {
        for row in c.chunks_mut(width) {
            cut(q, start, end, |low, keep, t| {
                let (a, b) = row[low..low + 2].split_at_mut(1);
                blend(a, b, keep, t);
            });
        }
    }
}

/// Where a blend of two neighbours goes.
#[derive(Clone, Copy, PartialEq)]
enum Keep {
    Lower,
    Upper,
}

/// `(1 − t) a + t b` into one of the two.
#[inline]
fn blend(a: &mut [f64], b: &mut [f64], keep: Keep, t: f64) {
    let s = 1.0 - t;
    for (x, y) in a.iter_mut().zip(b) {
        let value = s * *x + t * *y;
        match keep {
            Keep::Lower => *x = value,
            Keep::Upper => *y = value,
        }
    }
}

/// De Casteljau's schedule: first the part before `end`, then of that the part from `start` on.
#[inline]
fn cut(degree: usize, start: f64, end: f64, mut blend: impl FnMut(usize, Keep, f64)) {
    if end != 1.0 {
        for r in 1..=degree {
            for i in (r..=degree).rev() {
                blend(i - 1, Keep::Upper, end);
            }
        }
    }
    if start != 0.0 {
        for r in 1..=degree {
            for i in 0..=degree - r {
                blend(i, Keep::Lower, start / end);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    #[test]
    fn parts_and_gradients_belong_to_the_same_polynomial() {
        let mut random = Random(8);
        for _ in 0..200 {
            let degree = [random.integer(0, 8), random.integer(0, 8)];
            let c: Vec<f64> = (0..(degree[0] + 1) * (degree[1] + 1))
                .map(|_| random.float(-1.0, 1.0))
                .collect();
            let (start, end) = (random.float(-0.01, 0.4), random.float(0.6, 1.01));
            let at = [random.float(0.0, 1.0), random.float(0.0, 1.0)];
            for axis in 0..2 {
                let mut part = c.clone();
                restrict(&mut part, degree, axis, start, end);
                let mut inner = at;
                inner[axis] = (at[axis] - start) / (end - start);
                let (whole, slope) = value_and_gradient(&c, degree, at);
                assert!((value_and_gradient(&part, degree, inner).0 - whole).abs() < 1e-13);
                let (mut low, mut high) = (at, at);
                (low[axis], high[axis]) = (at[axis] - 1e-6, at[axis] + 1e-6);
                let change =
                    value_and_gradient(&c, degree, high).0 - value_and_gradient(&c, degree, low).0;
                assert!((slope[axis] - change / 2e-6).abs() < 1e-7);
            }
        }
    }
}
