//! Loops in the parameters of a surface: what is on their left is kept, the rest is trimmed away.

use super::{Direction, Surface};

/// Most places of all loops of a trim.
const MOST: usize = 4096;
/// Of the domain: a place that is farther outside than this is a mistake, one nearer is moved onto the border.
const BORDER: f64 = 1e-6;

/// Why loops trim nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrimError {
    /// No loops at all.
    #[error("trim has no loops; leave it out for the whole surface")]
    Empty,
    /// More places than are read.
    #[error("trim has {given} places; {MOST} are possible: give every second or third")]
    TooMany {
        /// Of all loops.
        given: usize,
    },
    /// A loop that bounds no area.
    #[error("loop {ring} of trim has {given} places; a loop needs three or more")]
    Short {
        /// Which loop, from 0.
        ring: usize,
        /// Its places.
        given: usize,
    },
    /// A place that is not on the surface.
    #[error(
        "place {place} of loop {ring} of trim, ({u}, {v}), is outside of the domain: u from {} to {}, v from {} to {}",
        domain[0][0], domain[0][1], domain[1][0], domain[1][1]
    )]
    Outside {
        /// Which loop, from 0.
        ring: usize,
        /// Which of its places, from 0.
        place: usize,
        /// Its u.
        u: f64,
        /// Its v.
        v: f64,
        /// Of the surface, u and v.
        domain: [[f64; 2]; 2],
    },
    /// Two sides that cross.
    #[error("loops {rings:?} of trim cross near ({u}, {v}): no side of them is the left one there")]
    Crossing {
        /// Which loops, from 0; twice the same where one crosses itself.
        rings: [usize; 2],
        /// Where, u.
        u: f64,
        /// Where, v.
        v: f64,
    },
}

/// The part of a surface on the left of its loops.
///
/// Loops are closed polylines; the last place is joined to the first. An outer loop runs counterclockwise in (u, v), one round
/// a hole clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Trim {
    loops: Vec<Vec<[f64; 2]>>,
}

impl Trim {
    /// Of places in the parameters of the surface.
    ///
    /// # Errors
    /// No loops, a loop of fewer than three places, more than 4096 places, places outside of the domain (by more than 1e-6 of
    /// it) or not finite, loops that cross themselves or each other.
    pub fn new(surface: &Surface, mut loops: Vec<Vec<[f64; 2]>>) -> Result<Self, TrimError> {
        let given = loops.iter().map(Vec::len).sum();
        if loops.is_empty() {
            return Err(TrimError::Empty);
        }
        if given > MOST {
            return Err(TrimError::TooMany { given });
        }
        let domain = [Direction::U, Direction::V].map(|d| {
            let (start, end) = surface.knots(d).domain();
            [start, end]
        });
        for (ring, places) in loops.iter_mut().enumerate() {
            // A file may repeat the first place at the end.
            if places.len() > 1 && places.first() == places.last() {
                places.pop();
            }
            if places.len() < 3 {
                let given = places.len();
                return Err(TrimError::Short { ring, given });
            }
            for (place, uv) in places.iter_mut().enumerate() {
                let [u, v] = *uv;
                let shares = [0, 1].map(|d| share(uv[d], domain[d]));
                let [Some(x), Some(y)] = shares else {
                    return Err(TrimError::Outside {
                        ring,
                        place,
                        u,
                        v,
                        domain,
                    });
                };
                *uv = [x, y];
            }
        }
        if let Some((rings, at)) = crossing(&loops) {
            let [u, v] = [0, 1].map(|d| {
                let [start, end] = domain[d];
                start + at[d] * (end - start)
            });
            return Err(TrimError::Crossing { rings, u, v });
        }
        Ok(Self { loops })
    }

    /// The loops, in fractions of the domain: 0 at the start of u (or v), 1 at its end, both to the bit where a loop runs along the
    /// border.
    pub fn loops(&self) -> &[Vec<[f64; 2]>] {
        &self.loops
    }
}

/// A parameter as a fraction of the domain; none outside of it.
fn share(t: f64, [start, end]: [f64; 2]) -> Option<f64> {
    let share = (t - start) / (end - start);
    let inside = (-BORDER..=1.0 + BORDER).contains(&share);
    inside.then_some(match share {
        _ if share <= BORDER => 0.0,
        _ if share >= 1.0 - BORDER => 1.0,
        _ => share,
    })
}

/// Which loops cross first, and where.
fn crossing(loops: &[Vec<[f64; 2]>]) -> Option<([usize; 2], [f64; 2])> {
    let sides: Vec<(usize, [f64; 2], [f64; 2])> = (loops.iter().enumerate())
        .flat_map(|(ring, places)| {
            let next = places.iter().cycle().skip(1);
            places.iter().zip(next).map(move |(a, b)| (ring, *a, *b))
        })
        .collect();
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    for (k, &(one, a, b)) in sides.iter().enumerate() {
        for &(other, c, d) in &sides[k + 1..] {
            let [of_c, of_d] = [turn(a, b, c), turn(a, b, d)];
            if of_c * of_d < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0 {
                let t = of_c / (of_c - of_d);
                let at = [0, 1].map(|i| c[i] + t * (d[i] - c[i]));
                return Some(([one, other], at));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::builtin;
    use super::*;

    fn trim(loops: &[&[[f64; 2]]]) -> Result<Trim, TrimError> {
        let sheet = builtin("sheet", None, None).unwrap();
        Trim::new(&sheet, loops.iter().map(|l| l.to_vec()).collect())
    }

    #[test]
    fn loops_are_kept_as_fractions_and_snap_to_the_border() {
        let kept = trim(&[&[[1e-9, -1e-9], [0.5, 0.0], [0.5, 1.0 + 1e-9], [1e-9, -1e-9]]]);
        assert_eq!(
            kept.unwrap().loops(),
            [vec![[0.0, 0.0], [0.5, 0.0], [0.5, 1.0]]]
        );
    }

    #[test]
    fn loops_that_trim_nothing_are_refused_with_their_place() {
        let square: &[[f64; 2]] = &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(trim(&[square]).is_ok());
        assert_eq!(trim(&[]), Err(TrimError::Empty));
        assert_eq!(
            trim(&[square, &square[..2]]),
            Err(TrimError::Short { ring: 1, given: 2 })
        );
        for bad in [1.1, f64::NAN, f64::INFINITY] {
            let error = trim(&[&[[0.0, 0.0], [1.0, 0.0], [0.5, bad]]]).unwrap_err();
            let named = matches!(
                error,
                TrimError::Outside {
                    ring: 0,
                    place: 2,
                    ..
                }
            );
            assert!(named, "{error}");
        }
        let eight = trim(&[&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]]);
        assert_eq!(
            eight,
            Err(TrimError::Crossing {
                rings: [0, 0],
                u: 0.5,
                v: 0.5
            })
        );
        let shifted: Vec<[f64; 2]> = square
            .iter()
            .map(|p| [0.5 * p[0] + 0.1, 0.5 * p[1] + 0.1])
            .collect();
        let half: &[[f64; 2]] = &[[0.0, 0.0], [0.3, 0.0], [0.3, 1.0], [0.0, 1.0]];
        let crossed = trim(&[half, &shifted]).unwrap_err();
        assert!(matches!(crossed, TrimError::Crossing { rings: [0, 1], .. }));
        let many = vec![[0.5, 0.5]; MOST + 1];
        assert_eq!(trim(&[&many]), Err(TrimError::TooMany { given: MOST + 1 }));
    }
}
