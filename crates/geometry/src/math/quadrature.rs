//! Gauss–Legendre quadrature.
//!
//! Nodes are the roots of the Legendre polynomial, by Newton from Tricomi's estimate; weights 2 /
//! ((1 − x²) P'_n(x)²).

/// Nodes and weights on [−1, 1], in rising order: exact for polynomials of degree `2 · count − 1`.
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let mut rule = vec![(0.0, 2.0); count];
    for k in 0..count / 2 + count % 2 {
        let mut x = libm::cos(std::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5));
        // Newton doubles its four right digits each time; six rounds are more than any count needs.
        for _ in 0..6 {
            let (value, derivative) = legendre(count, x);
            x -= value / derivative;
        }
        if 2 * k + 1 == count {
            x = 0.0;
        }
        let (_, derivative) = legendre(count, x);
        let weight = 2.0 / ((1.0 - x * x) * derivative * derivative);
        rule[k] = (-x, weight);
        rule[count - 1 - k] = (x, weight);
    }
    rule
}

/// P_n(x) and its derivative, |x| < 1.
fn legendre(count: usize, x: f64) -> (f64, f64) {
    let (mut value, mut before) = (1.0, 0.0);
    for k in 0..count {
        let k = k as f64;
        (value, before) = (
            ((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0),
            value,
        );
    }
    let derivative = count as f64 * (x * value - before) / (x * x - 1.0);
    (value, derivative)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn monomials_up_to_twice_the_count_less_one_are_integrated_exactly() {
        for count in 1..=40 {
            let rule = gauss_legendre(count);
            for power in 0..2 * count {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(power as i32)).sum();
                let exact = if power % 2 == 0 {
                    2.0 / (power as f64 + 1.0)
                } else {
                    0.0
                };
                // Weights are sums of some tens of roundings.
                assert!(
                    (sum - exact).abs() < 1e-14,
                    "count {count}, power {power}: {sum} is not {exact}"
                );
            }
        }
    }
}
