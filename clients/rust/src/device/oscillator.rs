//! A mass on a spring and a damper, exactly over one step.
//!
//! x″ + 2α x′ + κ x = a for a constant a: linear in the state, e^{−αh} times cos and sin (or cosh
//! and sinh, or 1 and h) of √(κ − α²) h. Exact for any stiffness and step, so integration adds no
//! energy of its own and a sampled loop is unstable where theory says, not where an integrator
//! does.

/// One step of the oscillator: x ← a11 x + a12 v + g a; v ← a21 x + a22 v + a12 a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Propagator {
    a11: f64,
    a12: f64,
    a21: f64,
    a22: f64,
    g: f64,
}

impl Propagator {
    /// `alpha` = half the damping rate, 1/s; `kappa` = stiffness by mass, 1/s²; `step_s` > 0.
    pub(super) fn new(alpha: f64, kappa: f64, step_s: f64) -> Propagator {
        let h = step_s;
        let d = alpha * alpha - kappa;
        // e^{−αh} cosh(√d h) and e^{−αh} sinh(√d h)/√d, whatever the sign of d.
        let z = d * h * h;
        let (c, s) = if z.abs() < 1e-3 {
            // cosh(√z) and sinh(√z)/√z by their series (the next terms are below 1e-16): near
            // critical damping the quotients below lose their digits.
            let e = libm::exp(-alpha * h);
            let c = 1.0 + z / 2.0 * (1.0 + z / 12.0 * (1.0 + z / 30.0 * (1.0 + z / 56.0)));
            let s = 1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0 * (1.0 + z / 72.0)));
            (e * c, e * h * s)
        } else if d > 0.0 {
            let root = d.sqrt();
            let (slow, fast) = (
                libm::exp((root - alpha) * h),
                libm::exp(-(root + alpha) * h),
            );
            ((slow + fast) / 2.0, (slow - fast) / (2.0 * root))
        } else {
            let root = (-d).sqrt();
            let e = libm::exp(-alpha * h);
            (e * libm::cos(root * h), e * libm::sin(root * h) / root)
        };
        let (a11, a12, a21, a22) = (c + alpha * s, s, -kappa * s, c - alpha * s);
        Propagator {
            a11,
            a12,
            a21,
            a22,
            g: drift(alpha, kappa, d, a11, h),
        }
    }

    /// Position and velocity after the step, for a constant acceleration `a`.
    pub(super) fn step(&self, x: f64, v: f64, a: f64) -> (f64, f64) {
        (
            self.a11 * x + self.a12 * v + self.g * a,
            self.a21 * x + self.a22 * v + self.a12 * a,
        )
    }
}

/// ∫ a12 over the step: where a unit acceleration takes a mass at rest. (1 − a11)/κ, without its
/// cancellations.
fn drift(alpha: f64, kappa: f64, d: f64, a11: f64, h: f64) -> f64 {
    let rate = 2.0 * alpha;
    if rate * h + kappa * h * h < 1e-2 {
        // Taylor: y = a12 has y(0) = 0, y′(0) = 1 and y″ = −2α y′ − κ y. Each term is below 1 % of
        // the one before.
        let (mut previous, mut derivative) = (0.0, 1.0);
        let (mut power, mut sum) = (h * h / 2.0, 0.0);
        for n in 0..8 {
            sum += derivative * power;
            (previous, derivative) = (derivative, -rate * derivative - kappa * previous);
            power *= h / f64::from(n + 3);
        }
        sum
    } else if d * h * h > 1e-6 {
        // Two exponentials; the slow rate α − √d as κ/(α + √d), which keeps its digits and may be
        // 0.
        let root = d.sqrt();
        let decay = |rate: f64| {
            if rate > 0.0 {
                -libm::expm1(-rate * h) / rate
            } else {
                h
            }
        };
        (decay(kappa / (alpha + root)) - decay(alpha + root)) / (2.0 * root)
    } else {
        (1.0 - a11) / kappa // here κh² > 1e-5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(alpha: f64, kappa: f64, h: f64, steps: usize, x: f64, v: f64, a: f64) -> (f64, f64) {
        let propagator = Propagator::new(alpha, kappa, h);
        (0..steps).fold((x, v), |(x, v), _| propagator.step(x, v, a))
    }

    fn close(found: (f64, f64), exact: (f64, f64), scale: f64, what: &str) {
        let error = (found.0 - exact.0)
            .abs()
            .max((found.1 - exact.1).abs() / scale.max(1.0));
        assert!(error < 1e-11, "{what}: {found:?} should be {exact:?}");
    }

    #[test]
    fn an_undamped_spring_is_a_cosine() {
        let (omega, t) = (30.0_f64, 1.7);
        let found = run(0.0, omega * omega, t / 1700.0, 1700, 0.02, 0.0, 0.0);
        close(
            found,
            (0.02 * (omega * t).cos(), -0.02 * omega * (omega * t).sin()),
            omega,
            "cosine",
        );
    }

    #[test]
    fn critical_damping_is_a_line_times_an_exponential() {
        let (alpha, t) = (40.0_f64, 0.25);
        let found = run(alpha, alpha * alpha, t / 1000.0, 1000, 0.01, 0.3, 0.0);
        let slope = 0.3 + alpha * 0.01;
        let e = (-alpha * t).exp();
        close(
            found,
            (
                (0.01 + slope * t) * e,
                (slope - alpha * (0.01 + slope * t)) * e,
            ),
            alpha,
            "critical",
        );
    }

    #[test]
    fn overdamped_is_two_exponentials() {
        // Roots −10 and −90: α = 50, κ = 900. x = A e^{−10 t} + B e^{−90 t} with x(0) = 1, x′(0) =
        // 0.
        let (t, a, b) = (0.2_f64, 90.0 / 80.0, -10.0 / 80.0);
        let exact = (
            a * (-10.0 * t).exp() + b * (-90.0 * t).exp(),
            -10.0 * a * (-10.0 * t).exp() - 90.0 * b * (-90.0 * t).exp(),
        );
        close(
            run(50.0, 900.0, 2e-4, 1000, 1.0, 0.0, 0.0),
            exact,
            90.0,
            "overdamped",
        );
    }

    #[test]
    fn a_constant_force_without_a_spring_gives_the_terminal_velocity() {
        // v = (a/c)(1 − e^{−ct}), x = (a/c) t − (a/c²)(1 − e^{−ct}).
        let (c, a, t) = (8.0_f64, 5.0, 0.6);
        let e = 1.0 - (-c * t).exp();
        let exact = (a / c * t - a / (c * c) * e, a / c * e);
        close(
            run(c / 2.0, 0.0, 1e-3, 600, 0.0, 0.0, a),
            exact,
            1.0,
            "drag",
        );
        // No damping either: ½ a t².
        close(
            run(0.0, 0.0, 1e-3, 600, 0.0, 0.0, a),
            (0.5 * a * t * t, a * t),
            1.0,
            "free",
        );
    }

    #[test]
    fn a_constant_force_on_a_spring_ends_at_the_deflection_it_holds() {
        let (x, v) = run(60.0, 6_400.0, 2.5e-4, 8_000, 0.0, 0.0, 12.0);
        assert!(
            (x - 12.0 / 6_400.0).abs() < 1e-14 && v.abs() < 1e-12,
            "{x} {v}"
        );
    }

    #[test]
    fn the_step_length_does_not_matter() {
        for (alpha, kappa) in [
            (3.0, 900.0),
            (30.0, 900.0),
            (300.0, 900.0),
            (20.0, 0.0),
            (0.0, 0.0),
            (0.1, 1e-3),
            (40.0, 1e-3),
        ] {
            let coarse = run(alpha, kappa, 0.016, 8, 0.01, -0.2, 3.0);
            let fine = run(alpha, kappa, 0.016 / 256.0, 8 * 256, 0.01, -0.2, 3.0);
            close(
                fine,
                coarse,
                kappa.sqrt(),
                &format!("α = {alpha}, κ = {kappa}"),
            );
        }
    }
}
