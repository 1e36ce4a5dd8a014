//! One equation in one variable.

use super::{Bernstein, Status, crossing};

/// Boxes for one equation.
const BUDGET: usize = 4_000;

/// Narrower boxes are not cut further.
const NARROWEST: f64 = 1e-14;

/// A part of this width that is all rounding is a polynomial that vanishes.
const CURVE: f64 = 0.05;

/// Roots so little outside [0, 1] are on its edge.
const EDGE: f64 = 1e-9;

/// A root, or a part of [0, 1] in which roots cannot be distinguished from rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleRoot {
    /// The best parameter.
    pub at: f64,
    /// The part of [0, 1] that it stands for.
    pub low: f64,
    /// See `low`.
    pub high: f64,
    /// True when the polynomial is proved to change sign in the part, and to do it once.
    pub simple: bool,
}

/// All roots.
#[derive(Clone, Debug, Default)]
pub struct SingleSolution {
    /// All roots, in ascending order.
    pub roots: Vec<SingleRoot>,
    /// What the answer rests on.
    pub status: Status,
    /// Boxes looked at.
    pub boxes: usize,
}

/// All roots of `p` on [0, 1].
pub fn roots(p: &Bernstein) -> SingleSolution {
    let mut solution = SingleSolution::default();
    let mut stack = vec![(0.0, 1.0, p.clone())];
    while let Some((low, high, part)) = stack.pop() {
        solution.boxes += 1;
        if solution.boxes > BUDGET {
            solution.status = Status::Budget;
            break;
        }
        match judge(&part, high - low) {
            Verdict::None => {}
            Verdict::One { simple } => {
                let at = if simple {
                    low + bisect(&part) * (high - low)
                } else {
                    0.5 * (low + high)
                };
                solution.roots.push(SingleRoot {
                    at,
                    low,
                    high,
                    simple,
                });
            }
            Verdict::Cut(start, end) => {
                let width = high - low;
                let at = |x: f64| if x == 1.0 { high } else { low + x * width };
                if end - start > 0.8 {
                    // Off the middle: halves of halves are where roots of made-up examples lie.
                    let middle = 0.5 * (start + end) - (end - start) / 64.0;
                    stack.push((at(middle), at(end), part.part(middle, end)));
                    stack.push((at(start), at(middle), part.part(start, middle)));
                } else {
                    stack.push((at(start), at(end), part.part(start, end)));
                }
            }
        }
    }
    join(&mut solution);
    solution.roots = std::mem::take(&mut solution.roots)
        .into_iter()
        .filter_map(|root| looked_at_again(p, root))
        .collect();
    if let Some(widest) = solution
        .roots
        .iter()
        .filter(|root| !root.simple)
        .map(|root| root.high - root.low)
        .reduce(f64::max)
    {
        solution.status = solution.status.max(if widest > CURVE {
            Status::Continuum
        } else {
            Status::Cluster
        });
    }
    solution
}

/// A root on a cut or on the edge of [0, 1] proves simple with some room around it. `None` where it
/// proves to be outside.
fn looked_at_again(p: &Bernstein, root: SingleRoot) -> Option<SingleRoot> {
    if root.simple || root.high - root.low > 1e-6 {
        return Some(root);
    }
    let room = 4.0 * EDGE + 2.0 * (root.high - root.low);
    let (low, high) = (root.low - room, root.high + room);
    let part = p.part(low, high);
    if !matches!(judge(&part, high - low), Verdict::One { simple: true }) {
        return Some(root);
    }
    let at = low + bisect(&part) * (high - low);
    // A root so little outside is on the edge: the polynomial is not known more exactly.
    let inside = (-EDGE..=1.0 + EDGE).contains(&at);
    inside.then_some(SingleRoot {
        at: at.clamp(0.0, 1.0),
        simple: true,
        ..root
    })
}

enum Verdict {
    None,
    One { simple: bool },
    Cut(f64, f64),
}

fn judge(part: &Bernstein, width: f64) -> Verdict {
    let coefficients = part.coefficients();
    if coefficients.iter().all(|a| a.lo > 0.0) || coefficients.iter().all(|a| a.hi < 0.0) {
        return Verdict::None;
    }
    // Nothing but rounding is left, and parts would look the same: their coefficients are means of
    // these. Four times the bound, or parts at the edge of what can be excluded would be cut to
    // dust.
    if width < NARROWEST
        || coefficients
            .iter()
            .all(|a| a.mid().abs() <= 4.0 * a.radius())
    {
        return Verdict::One { simple: false };
    }
    let (first, last) = (coefficients[0], coefficients[coefficients.len() - 1]);
    let rises = coefficients.windows(2).all(|pair| pair[1].lo > pair[0].hi);
    let falls = coefficients.windows(2).all(|pair| pair[1].hi < pair[0].lo);
    if (rises && first.hi < 0.0 && last.lo > 0.0) || (falls && first.lo > 0.0 && last.hi < 0.0) {
        return Verdict::One { simple: true };
    }
    let lower: Vec<f64> = coefficients.iter().map(|a| a.lo).collect();
    let upper: Vec<f64> = coefficients.iter().map(|a| a.hi).collect();
    match crossing(&lower, &upper) {
        None => Verdict::None,
        Some(part) => {
            let (start, end) = padded(part);
            Verdict::Cut(start, end)
        }
    }
}

/// A clipped part with room for the rounding of its ends, and no thinner than 1e-4: the next step
/// is cheap.
pub(super) fn padded((start, end): (f64, f64)) -> (f64, f64) {
    let room = 1e-9 + (0.5 * (1e-4 - (end - start))).max(0.0);
    ((start - room).max(0.0), (end + room).min(1.0))
}

/// The zero of a monotone polynomial with a change of sign: Newton's method kept inside a shrinking
/// bracket.
fn bisect(p: &Bernstein) -> f64 {
    let slope = p.derivative();
    let rising = p.coefficients()[0].mid() < 0.0;
    let (mut low, mut high, mut t) = (0.0, 1.0, 0.5);
    for _ in 0..100 {
        let value = p.value(t);
        if value == 0.0 {
            break;
        }
        if (value < 0.0) == rising {
            low = t
        } else {
            high = t
        }
        let newton = t - value / slope.value(t);
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - t).abs() <= f64::EPSILON * 0.25 {
            break;
        }
        t = next;
    }
    t
}

/// Touching parts that are not resolved become one; a part at a found root's side is that root.
fn join(solution: &mut SingleSolution) {
    solution.roots.sort_by(|a, b| a.low.total_cmp(&b.low));
    let mut joined: Vec<SingleRoot> = Vec::new();
    for &root in &solution.roots {
        match joined.last_mut() {
            Some(last) if !(last.simple && root.simple) && root.low - last.high <= 1e-12 => {
                if last.simple && root.high - root.low < 1e-9 && root.low - last.at < 1e-9 {
                    continue;
                }
                if root.simple && last.high - last.low < 1e-9 && root.at - last.high < 1e-9 {
                    *last = root;
                    continue;
                }
                if last.simple || root.simple {
                    joined.push(root);
                    continue;
                }
                last.high = root.high;
                last.at = 0.5 * (last.low + last.high);
            }
            _ => joined.push(root),
        }
    }
    solution.roots = joined;
}

/// A parameter where all the polynomials may vanish together; `None` proves that there is none. Of
/// equal degree or not.
pub fn common_zero(polynomials: &[Bernstein]) -> Option<f64> {
    let mut stack = vec![(0.0, 1.0, polynomials.to_vec())];
    for _ in 0..BUDGET {
        let (low, high, parts) = stack.pop()?;
        let apart = |p: &Bernstein| {
            p.coefficients().iter().all(|a| a.lo > 0.0)
                || p.coefficients().iter().all(|a| a.hi < 0.0)
        };
        if parts.iter().any(apart) {
            continue;
        }
        let middle = 0.5 * (low + high);
        if high - low < 1e-12
            || parts
                .iter()
                .all(|p| p.coefficients().iter().all(|a| a.has_zero()))
        {
            return Some(middle);
        }
        stack.push((
            middle,
            high,
            parts.iter().map(|p| p.part(0.5, 1.0)).collect(),
        ));
        stack.push((
            low,
            middle,
            parts.iter().map(|p| p.part(0.0, 0.5)).collect(),
        ));
    }
    stack.pop().map(|(low, high, _)| 0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::super::Interval;
    use super::*;
    use palpate_geometry::math::Random;

    fn with_roots(roots: &[f64]) -> Bernstein {
        let factor = |r: &f64| {
            Bernstein::new(vec![
                Interval::point(-r),
                Interval::point(1.0) - Interval::point(*r),
            ])
        };
        roots
            .iter()
            .map(factor)
            .fold(Bernstein::one(0), |product, next| product.times(&next))
    }

    #[test]
    fn simple_roots_are_all_found_and_proved() {
        let mut random = Random(6);
        for _ in 0..300 {
            let count = random.integer(1, 8);
            let mut wanted: Vec<f64> = Vec::new();
            while wanted.len() < count {
                let next = random.float(-0.5, 1.5);
                if wanted.iter().all(|r| (r - next).abs() > 0.03)
                    && next.abs() > 1e-3
                    && (next - 1.0).abs() > 1e-3
                {
                    wanted.push(next);
                }
            }
            let p = with_roots(&wanted);
            let solution = roots(&p);
            wanted.retain(|r| (0.0..=1.0).contains(r));
            wanted.sort_by(f64::total_cmp);
            assert_eq!(solution.status, Status::Complete, "{wanted:?}");
            assert_eq!(
                solution.roots.len(),
                wanted.len(),
                "{wanted:?} {solution:?}"
            );
            for (found, wanted) in solution.roots.iter().zip(&wanted) {
                assert!(
                    (found.at - wanted).abs() < 1e-11 && found.simple,
                    "{found:?} is not {wanted}"
                );
            }
        }
    }

    #[test]
    fn roots_at_the_ends_are_kept() {
        let solution = roots(&with_roots(&[0.0, 0.5, 1.0]));
        let at: Vec<f64> = solution.roots.iter().map(|r| r.at).collect();
        assert_eq!(
            (at.len(), solution.status),
            (3, Status::Complete),
            "{solution:?}"
        );
        assert!(
            at[0].abs() < 1e-12 && (at[1] - 0.5).abs() < 1e-15 && (at[2] - 1.0).abs() < 1e-12,
            "{at:?}"
        );
    }

    #[test]
    fn a_multiple_root_is_a_cluster_and_zero_a_continuum() {
        let double = roots(&with_roots(&[0.3, 0.3, 0.8]));
        assert_eq!(double.status, Status::Cluster);
        assert!(
            double
                .roots
                .iter()
                .any(|r| !r.simple && r.low <= 0.3 && 0.3 <= r.high && r.high - r.low < 1e-6)
        );
        assert!(
            double
                .roots
                .iter()
                .any(|r| r.simple && (r.at - 0.8).abs() < 1e-13),
            "{double:?}"
        );
        assert!(double.boxes < 200, "{}", double.boxes);
        let zero = roots(&Bernstein::new(vec![Interval::around(0.0, 1e-16); 9]));
        assert_eq!((zero.status, zero.boxes), (Status::Continuum, 1));
    }

    #[test]
    fn a_common_zero_is_found_and_its_absence_proved() {
        let (a, b) = (with_roots(&[0.2, 0.7]), with_roots(&[0.7, 0.9]));
        assert!((common_zero(&[a.clone(), b]).unwrap() - 0.7).abs() < 1e-11);
        assert_eq!(common_zero(&[a, with_roots(&[0.701])]), None);
    }
}
