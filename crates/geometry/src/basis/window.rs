//! The basis functions that live at one parameter, with derivatives.
//!
//! Piegl & Tiller, *The NURBS Book*, algorithms A2.2 and A2.3, for orders 0, 1 and 2.

use super::{KnotVector, MAX_DEGREE, Side};

const WIDTH: usize = MAX_DEGREE + 1;

/// `degree + 1` basis functions at a parameter: everything else is zero there.
#[derive(Clone, Copy, Debug)]
pub struct BasisWindow {
    /// Column of the first value, in the stored (extended) basis; take it modulo the control count
    /// when periodic.
    pub first: usize,
    /// Number of values, `degree + 1`.
    pub len: usize,
    values: [f64; WIDTH],
    first_derivatives: [f64; WIDTH],
    second_derivatives: [f64; WIDTH],
}

impl BasisWindow {
    /// Basis values, `degree + 1`.
    pub fn values(&self) -> &[f64] {
        &self.values[..self.len]
    }

    /// First derivatives, `degree + 1`.
    pub fn first_derivatives(&self) -> &[f64] {
        &self.first_derivatives[..self.len]
    }

    /// Second derivatives, `degree + 1`.
    pub fn second_derivatives(&self) -> &[f64] {
        &self.second_derivatives[..self.len]
    }

    /// Values of derivative `order` (0, 1 or 2).
    pub fn order(&self, order: usize) -> &[f64] {
        match order {
            0 => self.values(),
            1 => self.first_derivatives(),
            _ => self.second_derivatives(),
        }
    }
}

impl KnotVector {
    /// The basis window at `u` (confined to the domain), seen from the right; see
    /// [`KnotVector::window_from`].
    pub fn window(&self, u: f64) -> BasisWindow {
        self.window_from(u, Side::Right)
    }

    /// The basis window at `u`, seen from one side, with first and second derivatives.
    pub fn window_from(&self, u: f64, side: Side) -> BasisWindow {
        let u = self.confine_from(u, side);
        let p = self.degree();
        let i = self.span(u, side);
        // The 2p knots that matter: t[p − 1] <= u <= t[p].
        let t = &self.knots()[i + 1 - p..=i + p];
        let mut window = BasisWindow {
            first: i - p,
            len: p + 1,
            values: [0.0; WIDTH],
            first_derivatives: [0.0; WIDTH],
            second_derivatives: [0.0; WIDTH],
        };
        // The degrees that scenes are made of get loops of constant length, which is twice as fast.
        match p {
            2 => fill(2, t, u, &mut window),
            3 => fill(3, t, u, &mut window),
            _ => fill(p, t, u, &mut window),
        }
        window
    }
}

#[inline(always)]
fn fill(p: usize, t: &[f64], u: f64, window: &mut BasisWindow) {
    let t = &t[..2 * p];
    let values = &mut window.values;
    // Of the last two rounds: N_{r,j-1} / Δ_r, and 1 / Δ_r of the last; the derivatives need no
    // division of their own.
    let (mut quotients, mut before) = ([0.0; WIDTH], [0.0; WIDTH]);
    let mut inverse = [0.0; WIDTH];
    values[0] = 1.0;
    for j in 1..=p {
        before = quotients;
        let mut saved = 0.0;
        for r in 0..j {
            let (low, high) = (t[p + r - j], t[p + r]);
            inverse[r] = 1.0 / (high - low);
            let quotient = values[r] * inverse[r];
            quotients[r] = quotient;
            values[r] = saved + (high - u) * quotient;
            saved = (u - low) * quotient;
        }
        values[j] = saved;
    }
    difference(p, &quotients, &mut window.first_derivatives);
    if p >= 2 {
        let mut inner = [0.0; WIDTH];
        difference(p - 1, &before, &mut inner);
        for r in 0..p {
            inner[r] *= inverse[r];
        }
        difference(p, &inner, &mut window.second_derivatives);
    }
}

/// Derivative of degree-`k` functions from those of degree `k − 1`, each over its width of knots:
/// N'_{i,k} = k (N_{i,k-1} / Δ_i − N_{i+1,k-1} / Δ_{i+1}), eq. 2.7.
#[inline(always)]
fn difference(k: usize, quotients: &[f64; WIDTH], out: &mut [f64; WIDTH]) {
    let factor = k as f64;
    out[0] = -factor * quotients[0];
    for j in 1..k {
        out[j] = factor * (quotients[j - 1] - quotients[j]);
    }
    out[k] = factor * quotients[k - 1];
}

#[cfg(test)]
mod tests {
    use super::super::testing::{KINDS, Random, parameters, random_knots, twin_row};
    use super::*;

    fn dense(knots: &KnotVector, window: &BasisWindow, order: usize) -> Vec<f64> {
        let mut row = vec![0.0; knots.count()];
        for (k, value) in window.order(order).iter().enumerate() {
            row[(window.first + k) % knots.count()] += value;
        }
        row
    }

    fn assert_rows_agree(got: &[f64], wanted: &[f64], tolerance: f64, what: &str) {
        let scale = wanted.iter().fold(1.0_f64, |a, x| a.max(x.abs()));
        for (column, (a, b)) in got.iter().zip(wanted).enumerate() {
            assert!(
                (a - b).abs() <= tolerance * scale,
                "{what}: column {column} is {a}, not {b}"
            );
        }
    }

    #[test]
    fn windows_agree_with_the_recursive_definition_from_both_sides() {
        let mut random = Random(1);
        for degree in 1..=7 {
            for kind in KINDS {
                for _ in 0..6 {
                    let knots = random_knots(&mut random, degree, kind, degree + 1);
                    let (start, end) = knots.domain();
                    for u in parameters(&mut random, &knots, 4) {
                        for side in [Side::Left, Side::Right] {
                            let at = match side {
                                Side::Left if knots.is_periodic() && u == start => end,
                                Side::Right if knots.is_periodic() && u == end => start,
                                _ => u,
                            };
                            let window = knots.window_from(u, side);
                            for order in 0..3 {
                                let wanted = twin_row(&knots, at, side == Side::Left, order);
                                let what =
                                    format!("{knots:?}, u = {u} from the {side:?}, order {order}");
                                // Same values by another order of operations: some tens of
                                // roundings.
                                assert_rows_agree(
                                    &dense(&knots, &window, order),
                                    &wanted,
                                    1e-13,
                                    &what,
                                );
                            }
                        }
                    }
                }
            }
        }
    }

    // Values of scipy.interpolate.BSpline 1.17 (unit coefficients, wrapped for periodic vectors),
    // kept as data.
    #[test]
    fn windows_agree_with_scipy() {
        let cases: serde_json::Value =
            serde_json::from_str(include_str!("data/scipy.json")).unwrap();
        let floats = |value: &serde_json::Value| -> Vec<f64> {
            value
                .as_array()
                .unwrap()
                .iter()
                .map(|x| x.as_f64().unwrap())
                .collect()
        };
        for case in cases.as_array().unwrap() {
            let degree = case["degree"].as_u64().unwrap() as usize;
            let values = floats(&case["knots"]);
            let periodic = case["periodic"].as_bool().unwrap();
            let knots = if periodic {
                KnotVector::periodic(degree, values)
            } else {
                KnotVector::new(degree, values)
            };
            let knots = knots.unwrap();
            for row in case["rows"].as_array().unwrap() {
                let u = row["u"].as_f64().unwrap();
                for order in 0..3 {
                    let what = format!("{}, u = {u}, order {order}", case["name"]);
                    // scipy differences coefficients for derivatives: a few roundings more than
                    // ours.
                    let wanted = floats(&row["orders"][order]);
                    assert_rows_agree(
                        &dense(&knots, &knots.window(u), order),
                        &wanted,
                        1e-12,
                        &what,
                    );
                }
            }
        }
    }

    #[test]
    fn values_sum_to_one_are_never_negative_and_derivatives_sum_to_zero() {
        let mut random = Random(2);
        for degree in 1..=MAX_DEGREE {
            for kind in KINDS {
                let knots = random_knots(&mut random, degree, kind, degree + 1);
                for u in parameters(&mut random, &knots, 20) {
                    let window = knots.window(u);
                    let sum: f64 = window.values().iter().sum();
                    assert!((sum - 1.0).abs() < 1e-14, "{knots:?} at {u}: sum {sum}");
                    assert!(
                        window.values().iter().all(|&n| n >= 0.0),
                        "{knots:?} at {u}: {window:?}"
                    );
                    for derivatives in [window.first_derivatives(), window.second_derivatives()] {
                        let size: f64 = derivatives.iter().map(|d| d.abs()).sum();
                        let sum: f64 = derivatives.iter().sum();
                        assert!(
                            sum.abs() <= 1e-13 * size,
                            "{knots:?} at {u}: derivatives sum to {sum}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn derivatives_agree_with_central_differences_inside_spans() {
        let mut random = Random(3);
        for degree in 1..=7 {
            for kind in KINDS {
                let knots = random_knots(&mut random, degree, kind, degree + 1);
                let t = knots.knots();
                for i in knots.spans() {
                    let (u, h) = (0.5 * (t[i] + t[i + 1]), 1e-4 * (t[i + 1] - t[i]));
                    let (before, at, after) =
                        (knots.window(u - h), knots.window(u), knots.window(u + h));
                    for k in 0..=degree {
                        let (a, b, c) = (before.values()[k], at.values()[k], after.values()[k]);
                        let (first, second) = ((c - a) / (2.0 * h), (a - 2.0 * b + c) / (h * h));
                        let span = t[i + 1] - t[i];
                        // Truncation h² p⁴ / span³ for the first; rounding ε / h² for the second.
                        let (one, two) = (at.first_derivatives()[k], at.second_derivatives()[k]);
                        assert!(
                            (first - one).abs() * span < 1e-4,
                            "{knots:?} at {u}: {one}, differences give {first}"
                        );
                        assert!(
                            (second - two).abs() * span * span < 1e-3,
                            "{knots:?} at {u}: {two}, not {second}"
                        );
                    }
                }
            }
        }
    }
}
