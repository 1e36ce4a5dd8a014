//! Oracles and random knots for tests: a recursive twin of the basis, and a generator with a fixed
//! sequence.

use super::{KnotKind, KnotVector};
pub(crate) use crate::math::Random;

/// A knot vector of some kind with uneven spans and now and then a repeated knot, up to `most`
/// times.
pub(crate) fn random_knots(
    random: &mut Random,
    degree: usize,
    kind: KnotKind,
    most: usize,
) -> KnotVector {
    let mut at = random.float(-1.0, 1.0);
    let mut next = |random: &mut Random| {
        at += random.float(0.3, 1.0);
        at
    };
    let mut inner = Vec::new();
    for _ in 0..random.integer(1, 4) {
        let knot = next(random);
        let times = if random.integer(0, 2) == 0 {
            random.integer(1, most)
        } else {
            1
        };
        inner.extend(std::iter::repeat_n(knot, times));
    }
    match kind {
        KnotKind::Clamped => {
            let (start, end) = (inner[0] - 0.7, next(random));
            let mut knots = vec![start; degree + 1];
            knots.extend(inner);
            knots.extend(std::iter::repeat_n(end, degree + 1));
            KnotVector::new(degree, knots).unwrap()
        }
        KnotKind::Open => {
            let start = inner[0];
            let mut knots: Vec<f64> = (0..=degree)
                .map(|k| start - 0.4 * (degree + 1 - k) as f64)
                .collect();
            knots.extend(inner);
            knots.extend((0..=degree).map(|_| next(random)));
            KnotVector::new(degree, knots).unwrap()
        }
        KnotKind::Periodic => {
            let mut knots = vec![inner[0] - 0.5];
            knots.extend(inner);
            while knots.len() < degree + 2 + random.integer(0, 2) {
                knots.push(next(random));
            }
            KnotVector::periodic(degree, knots).unwrap()
        }
    }
}

/// N_{i,p}^{(order)}(u) by the definition (Cox–de Boor and its derivative, without any table), with
/// `knots[span] <= u` the one span on which degree 0 is 1.
pub(crate) fn twin_basis(
    knots: &[f64],
    span: usize,
    i: usize,
    p: usize,
    order: usize,
    u: f64,
) -> f64 {
    let over = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
    if p == 0 {
        return if order == 0 && i == span { 1.0 } else { 0.0 };
    }
    let lower = |i: usize, order: usize| twin_basis(knots, span, i, p - 1, order, u);
    let (left, right) = (knots[i + p] - knots[i], knots[i + p + 1] - knots[i + 1]);
    if order > 0 {
        let p = p as f64;
        return p * (over(lower(i, order - 1), left) - over(lower(i + 1, order - 1), right));
    }
    over(u - knots[i], left) * lower(i, 0) + over(knots[i + p + 1] - u, right) * lower(i + 1, 0)
}

/// The span for the twin, by scanning: the last of positive length that starts at or before u, or
/// before u.
pub(crate) fn twin_span(knots: &KnotVector, u: f64, from_left: bool) -> usize {
    let t = knots.knots();
    let spans: Vec<usize> = knots.spans().collect();
    let starts_before = |i: usize| if from_left { t[i] < u } else { t[i] <= u };
    spans
        .iter()
        .copied()
        .rev()
        .find(|&i| starts_before(i))
        .unwrap_or(spans[0])
}

/// All columns (control points) of one row, dense, by the twin.
pub(crate) fn twin_row(knots: &KnotVector, u: f64, from_left: bool, order: usize) -> Vec<f64> {
    let span = twin_span(knots, u, from_left);
    let mut row = vec![0.0; knots.count()];
    for i in 0..knots.basis_count() {
        row[i % knots.count()] += twin_basis(knots.knots(), span, i, knots.degree(), order, u);
    }
    row
}

/// Parameters worth trying: knots, between knots, ends, and some more.
pub(crate) fn parameters(random: &mut Random, knots: &KnotVector, more: usize) -> Vec<f64> {
    let t = knots.knots();
    let mut parameters: Vec<f64> = knots
        .spans()
        .flat_map(|i| [t[i], 0.5 * (t[i] + t[i + 1])])
        .collect();
    let (start, end) = knots.domain();
    parameters.extend((0..more).map(|_| random.float(start, end)));
    parameters.push(end);
    parameters
}

/// Every kind.
pub(crate) const KINDS: [KnotKind; 3] = [KnotKind::Clamped, KnotKind::Open, KnotKind::Periodic];
