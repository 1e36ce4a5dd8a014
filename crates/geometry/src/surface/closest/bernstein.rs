//! Tensor-product Bernstein polynomials as flat arrays: product, halving, restriction, and what
//! their coefficients prove.
//!
//! Coefficients of a polynomial with `nu × nv` of them are u-major: (i, j) at `i * nv + j`. The
//! least coefficient is a lower bound of the polynomial on [0, 1]², off by O(width²) when the box
//! is halved; the corners are values. The signs of first and second differences prove monotony and
//! convexity. Functions are inlined so that callers with literal sizes get straight loops.

use crate::basis::MAX_DEGREE;
use crate::surface::bezier::bernstein;

/// Most coefficients in one direction: a squared distance has twice the surface's degree.
pub(super) const MAX_ORDER: usize = 2 * MAX_DEGREE + 1;

/// Binomial coefficient.
pub(super) fn binomial(n: usize, k: usize) -> f64 {
    (1..=k).fold(1.0, |c, i| c * (n + 1 - i) as f64 / i as f64)
}

/// Least coefficient.
#[inline(always)]
pub(super) fn least(a: &[f64]) -> f64 {
    // Four running minima: one would wait for itself.
    let mut m = [f64::INFINITY; 4];
    let mut blocks = a.chunks_exact(4);
    for block in &mut blocks {
        for k in 0..4 {
            m[k] = if block[k] < m[k] { block[k] } else { m[k] };
        }
    }
    for &x in blocks.remainder() {
        m[0] = if x < m[0] { x } else { m[0] };
    }
    m[0].min(m[1]).min(m[2].min(m[3]))
}

/// Greatest coefficient.
#[inline(always)]
pub(super) fn greatest(a: &[f64]) -> f64 {
    a.iter()
        .fold(f64::NEG_INFINITY, |m, &x| if x > m { x } else { m })
}

/// Halves in u: the lower half to `low`, the upper half stays.
#[inline(always)]
pub(crate) fn halve_u(a: &mut [f64], low: &mut [f64], nu: usize, nv: usize) {
    low[..nv].copy_from_slice(&a[..nv]);
    for k in 1..nu {
        for x in 0..(nu - k) * nv {
            a[x] = 0.5 * (a[x] + a[x + nv]);
        }
        low[k * nv..(k + 1) * nv].copy_from_slice(&a[..nv]);
    }
}

/// Halves in v.
#[inline(always)]
pub(crate) fn halve_v(a: &mut [f64], low: &mut [f64], nu: usize, nv: usize) {
    for i in 0..nu {
        let (a, low) = (&mut a[i * nv..(i + 1) * nv], &mut low[i * nv..(i + 1) * nv]);
        low[0] = a[0];
        for k in 1..nv {
            for x in 0..nv - k {
                a[x] = 0.5 * (a[x] + a[x + 1]);
            }
            low[k] = a[0];
        }
    }
}

/// Restricts to u in [from, to] ⊆ [0, 1].
#[inline(always)]
pub(super) fn restrict_u(a: &mut [f64], nu: usize, nv: usize, from: f64, to: f64) {
    let a = &mut a[..nu * nv];
    if to < 1.0 {
        // Keep [0, to]: de Casteljau, first points of each stage.
        for k in 1..nu {
            for x in (k * nv..nu * nv).rev() {
                a[x] = (1.0 - to) * a[x - nv] + to * a[x];
            }
        }
    }
    if from > 0.0 {
        let y = from / to;
        for k in 1..nu {
            for x in 0..(nu - k) * nv {
                a[x] = (1.0 - y) * a[x] + y * a[x + nv];
            }
        }
    }
}

/// Restricts to v in [from, to] ⊆ [0, 1].
#[inline(always)]
pub(super) fn restrict_v(a: &mut [f64], nu: usize, nv: usize, from: f64, to: f64) {
    if from > 0.0 || to < 1.0 {
        for i in 0..nu {
            restrict_u(&mut a[i * nv..(i + 1) * nv], nv, 1, from, to);
        }
    }
}

/// Least first differences, greatest first differences: (u, v) each.
#[inline(always)]
pub(super) fn first_differences(a: &[f64], nu: usize, nv: usize) -> [(f64, f64); 2] {
    let mut u = (f64::INFINITY, f64::NEG_INFINITY);
    for x in 0..(nu - 1) * nv {
        let d = a[x + nv] - a[x];
        u.0 = if d < u.0 { d } else { u.0 };
        u.1 = if d > u.1 { d } else { u.1 };
    }
    let mut v = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..nu {
        for j in 0..nv - 1 {
            let d = a[i * nv + j + 1] - a[i * nv + j];
            v.0 = if d < v.0 { d } else { v.0 };
            v.1 = if d > v.1 { d } else { v.1 };
        }
    }
    [u, v]
}

/// Bounds of the second derivatives on the unit box.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurvatureBound {
    /// Least ∂²/∂u².
    pub uu: f64,
    /// Least ∂²/∂v².
    pub vv: f64,
    /// Greatest |∂²/∂u∂v|.
    pub uv: f64,
    /// Greatest |∂²/∂u²|, |∂²/∂v²|.
    pub spread: (f64, f64),
}

impl CurvatureBound {
    /// The Hessian is positive definite on the whole box, by more than rounding.
    pub fn convex(&self, noise: f64) -> bool {
        let (a, b, c) = (self.uu - noise, self.vv - noise, self.uv + noise);
        a > 0.0 && b > 0.0 && a * b > c * c
    }
}

/// Second derivatives on the unit box, from second differences.
#[inline(always)]
pub(super) fn curvature(a: &[f64], nu: usize, nv: usize) -> CurvatureBound {
    let (mut uu, mut uu_max) = (f64::INFINITY, f64::NEG_INFINITY);
    if nu > 2 {
        for x in 0..(nu - 2) * nv {
            let d = (a[x + 2 * nv] - a[x + nv]) - (a[x + nv] - a[x]);
            uu = if d < uu { d } else { uu };
            uu_max = if d > uu_max { d } else { uu_max };
        }
    } else {
        (uu, uu_max) = (0.0, 0.0);
    }
    let (mut vv, mut vv_max) = (f64::INFINITY, f64::NEG_INFINITY);
    if nv > 2 {
        for i in 0..nu {
            for j in 0..nv - 2 {
                let x = i * nv + j;
                let d = (a[x + 2] - a[x + 1]) - (a[x + 1] - a[x]);
                vv = if d < vv { d } else { vv };
                vv_max = if d > vv_max { d } else { vv_max };
            }
        }
    } else {
        (vv, vv_max) = (0.0, 0.0);
    }
    let mut uv = 0.0;
    for i in 0..nu - 1 {
        for j in 0..nv - 1 {
            let x = i * nv + j;
            let d = ((a[x + nv + 1] - a[x + nv]) - (a[x + 1] - a[x])).abs();
            uv = if d > uv { d } else { uv };
        }
    }
    let (p, q) = ((nu - 1) as f64, (nv - 1) as f64);
    let (su, sv) = (p * (p - 1.0), q * (q - 1.0));
    CurvatureBound {
        uu: uu * su,
        vv: vv * sv,
        uv: uv * p * q,
        spread: (
            uu_max.abs().max(uu.abs()) * su,
            vv_max.abs().max(vv.abs()) * sv,
        ),
    }
}

/// Value, gradient and Hessian (uu, uv, vv) at (s, t).
#[inline(always)]
pub(super) fn jet(a: &[f64], nu: usize, nv: usize, s: f64, t: f64) -> (f64, [f64; 2], [f64; 3]) {
    if nu.max(nv) <= 7 {
        jet_in::<7>(a, nu, nv, s, t)
    } else {
        jet_in::<MAX_ORDER>(a, nu, nv, s, t)
    }
}

#[inline(always)]
fn jet_in<const N: usize>(
    a: &[f64],
    nu: usize,
    nv: usize,
    s: f64,
    t: f64,
) -> (f64, [f64; 2], [f64; 3]) {
    let (bs, bt) = (bernstein::<N>(nu - 1, s), bernstein::<N>(nv - 1, t));
    let (mut f, mut g, mut h) = (0.0, [0.0; 2], [0.0; 3]);
    for i in 0..nu {
        let (mut x, mut y, mut z) = (0.0, 0.0, 0.0);
        for j in 0..nv {
            let c = a[i * nv + j];
            x += bt[0][j] * c;
            y += bt[1][j] * c;
            z += bt[2][j] * c;
        }
        f += bs[0][i] * x;
        g[0] += bs[1][i] * x;
        g[1] += bs[0][i] * y;
        h[0] += bs[2][i] * x;
        h[1] += bs[1][i] * y;
        h[2] += bs[0][i] * z;
    }
    (f, g, h)
}

/// What a bound found out about a polynomial and a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Nowhere below the floor.
    Clear,
    /// Below the floor at this local parameter.
    Below(f64, f64),
    /// Neither proved.
    Open,
}

/// Whether a univariate polynomial stays at or above `floor` on [0, 1]; `Below` carries the
/// parameter in its first place.
///
/// Walks dyadic intervals from left to right, each restricted from the whole edge, so that nothing
/// needs a stack.
pub(super) fn edge_verdict(edge: &[f64], floor: f64) -> Verdict {
    const SMALLEST: f64 = 1.0 / (1u64 << 44) as f64;
    let n = edge.len();
    let mut part = [0.0; MAX_ORDER];
    let (mut start, mut width) = (0.0, 1.0);
    for _ in 0..4096 {
        let a = &mut part[..n];
        a.copy_from_slice(edge);
        restrict_u(a, n, 1, start, start + width);
        match interval_verdict(a, floor) {
            Verdict::Below(s, _) => return Verdict::Below(start + width * s, 0.0),
            Verdict::Open if width > SMALLEST => width *= 0.5,
            _ => {
                start += width;
                if start >= 1.0 {
                    return Verdict::Clear;
                }
                // As large as the next interval's place on the dyadic grid allows, at most twice
                // this one.
                if (start / (2.0 * width)).fract() == 0.0 && start + 2.0 * width <= 1.0 {
                    width *= 2.0;
                }
            }
        }
    }
    Verdict::Open
}

fn interval_verdict(a: &[f64], floor: f64) -> Verdict {
    let n = a.len();
    if a[0] < floor {
        return Verdict::Below(0.0, 0.0);
    }
    if a[n - 1] < floor {
        return Verdict::Below(1.0, 0.0);
    }
    if least(a) >= floor {
        return Verdict::Clear;
    }
    let (mut up, mut down, mut convex) = (true, true, true);
    for k in 1..n {
        up &= a[k] >= a[k - 1];
        down &= a[k] <= a[k - 1];
        if k > 1 {
            convex &= (a[k] - a[k - 1]) >= (a[k - 1] - a[k - 2]);
        }
    }
    if up || down {
        return Verdict::Clear;
    }
    if convex {
        let mut s: f64 = 0.5;
        for _ in 0..8 {
            let b = bernstein::<MAX_ORDER>(n - 1, s);
            let sum = |r: usize| -> f64 { a.iter().zip(&b[r]).map(|(x, y)| x * y).sum() };
            let (f, g, h) = (sum(0), sum(1), sum(2));
            if f < floor {
                return Verdict::Below(s, 0.0);
            }
            // A convex function lies above its tangent.
            if f + (-s * g).min((1.0 - s) * g) >= floor {
                return Verdict::Clear;
            }
            if h <= 0.0 {
                break;
            }
            s = (s - g / h).clamp(0.0, 1.0);
        }
    }
    Verdict::Open
}

/// Whether a convex polynomial stays at or above `floor` on the unit box: Newton from (s, t), and
/// the tangent plane, which a convex function never goes below.
#[inline(always)]
pub(super) fn convex_verdict(
    a: &[f64],
    nu: usize,
    nv: usize,
    floor: f64,
    mut s: f64,
    mut t: f64,
) -> Verdict {
    for _ in 0..12 {
        let (f, g, h) = jet(a, nu, nv, s, t);
        if f < floor {
            return Verdict::Below(s, t);
        }
        if f + (-s * g[0]).min((1.0 - s) * g[0]) + (-t * g[1]).min((1.0 - t) * g[1]) >= floor {
            return Verdict::Clear;
        }
        let fixed_s = (s <= 0.0 && g[0] >= 0.0) || (s >= 1.0 && g[0] <= 0.0);
        let fixed_t = (t <= 0.0 && g[1] >= 0.0) || (t >= 1.0 && g[1] <= 0.0);
        let (ds, dt) = match (fixed_s, fixed_t) {
            (true, true) => break,
            (true, false) => (0.0, -g[1] / h[2]),
            (false, true) => (-g[0] / h[0], 0.0),
            (false, false) => {
                let det = h[0] * h[2] - h[1] * h[1];
                (
                    (h[1] * g[1] - h[2] * g[0]) / det,
                    (h[1] * g[0] - h[0] * g[1]) / det,
                )
            }
        };
        if !(ds.is_finite() && dt.is_finite()) {
            break;
        }
        (s, t) = ((s + ds).clamp(0.0, 1.0), (t + dt).clamp(0.0, 1.0));
    }
    Verdict::Open
}
