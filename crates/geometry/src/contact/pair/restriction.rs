//! Bézier points of a part of a piece.

use crate::basis::MAX_DEGREE;

pub(super) const MOST_POINTS: usize = (MAX_DEGREE + 1) * (MAX_DEGREE + 1);

/// Points of a part of a piece, homogeneous, one after the other.
#[inline(always)]
pub(super) fn restrict(
    piece: &[[f64; 4]],
    u: &[f64],
    v: &[f64],
    n: usize,
    m: usize,
    whole: bool,
    give: impl FnMut(usize, &[f64; 4]),
) {
    // Room for all degrees takes longer to clear than a cubic part takes.
    match n <= 4 && m <= 4 {
        true => restrict_in::<16>(piece, u, v, [n, m], whole, give),
        false => restrict_in::<MOST_POINTS>(piece, u, v, [n, m], whole, give),
    }
}

#[inline(always)]
fn restrict_in<const ROOM: usize>(
    piece: &[[f64; 4]],
    u: &[f64],
    v: &[f64],
    [n, m]: [usize; 2],
    whole: bool,
    mut give: impl FnMut(usize, &[f64; 4]),
) {
    let mut rows = [[0.0; 4]; ROOM];
    if whole {
        rows[..n * m].copy_from_slice(&piece[..n * m]);
    } else {
        let mut half = [[0.0; 4]; ROOM];
        for k in 0..n {
            for a in 0..n {
                let share = u[k * n + a];
                for l in 0..m {
                    for c in 0..4 {
                        half[k * m + l][c] += share * piece[a * m + l][c];
                    }
                }
            }
        }
        for k in 0..n {
            for l in 0..m {
                for b in 0..m {
                    let share = v[l * m + b];
                    for c in 0..4 {
                        rows[k * m + l][c] += share * half[k * m + b][c];
                    }
                }
            }
        }
    }
    for (k, y) in rows.iter().enumerate().take(n * m) {
        give(k, y);
    }
}

/// The matrix, row by row, that gives the Bézier points of [a, b] from those of [0, 1]: blossoms at
/// (a … a, b … b).
pub(super) fn restriction(p: usize, a: f64, b: f64) -> Vec<f64> {
    let n = p + 1;
    let mut out = vec![0.0; n * n];
    for k in 0..n {
        for l in 0..n {
            let mut x = vec![0.0; n];
            x[l] = 1.0;
            for r in 0..p {
                let t = if r < p - k { a } else { b };
                for i in 0..p - r {
                    x[i] = (1.0 - t) * x[i] + t * x[i + 1];
                }
            }
            out[k * n + l] = x[0];
        }
    }
    out
}
