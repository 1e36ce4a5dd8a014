//! Where on a part of a Bézier piece local minima can be, by the signs of its Bernstein
//! coefficients.
//!
//! The objective is A / W with W > 0. Where its value is f, its slope has the sign of A_u − f W_u,
//! and at a critical point its second derivatives are those of A − f W, over W. Both are linear in
//! f, so what holds for the least and the greatest value that the part takes holds for all between
//! them. A polynomial (W = 1) is its own only form.

use super::bernstein::{MAX_ORDER, least};

/// What the coefficients of a part say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Claim {
    /// No local minimum of the surface below the ceiling.
    Nothing,
    /// At most one; descent within the part from here finds it.
    Start(f64, f64),
    /// Neither; halve in u (true) or in v.
    Halve(bool),
}

/// What is known of a part beside its coefficients.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    /// Its edges at least and greatest u, v beyond which the surface is not smooth: minima may sit
    /// there on a slope.
    pub borders: [[bool; 2]; 2],
    /// In u and v, shares of the piece.
    pub widths: [f64; 2],
    /// Values at or above this do not matter.
    pub ceiling: f64,
    /// How far rounding may have moved a coefficient.
    pub noise: f64,
    /// Values nearer to each other than this are equal.
    pub equal: f64,
}

/// Least and greatest.
type Range = (f64, f64);

const EMPTY: Range = (f64::INFINITY, f64::NEG_INFINITY);

#[inline(always)]
fn take(range: &mut Range, x: f64) {
    range.0 = if x < range.0 { x } else { range.0 };
    range.1 = if x > range.1 { x } else { range.1 };
}

/// Looks at one or two forms (A − f W at the least and greatest f) of a part, `nu × nv`
/// coefficients each; `whole` is A and W, where there are two. The caller has made sure that the
/// part reaches below the ceiling.
#[inline(always)]
pub(super) fn claim<const FORMS: usize>(
    forms: [&[f64]; FORMS],
    whole: (&[f64], &[f64]),
    nu: usize,
    nv: usize,
    setting: &Setting,
) -> Claim {
    let noise = setting.noise;
    let (mut values, mut du, mut dv) = (EMPTY, EMPTY, EMPTY);
    for a in forms {
        for &x in &a[..nu * nv] {
            take(&mut values, x);
        }
        for x in 0..(nu - 1) * nv {
            take(&mut du, a[x + nv] - a[x]);
        }
        for i in 0..nu {
            for j in 0..nv - 1 {
                take(&mut dv, a[i * nv + j + 1] - a[i * nv + j]);
            }
        }
    }
    if FORMS == 1 && values.1 - values.0 <= setting.equal {
        return Claim::Start(0.5, 0.5);
    }
    let edge = |in_u: bool, at_end: bool| {
        let mut range = EMPTY;
        for a in forms {
            if in_u {
                let x = if at_end { (nu - 2) * nv } else { 0 };
                (x..x + nv).for_each(|x| take(&mut range, a[x + nv] - a[x]));
            } else {
                let x = if at_end { nv - 2 } else { 0 };
                (0..nu).for_each(|i| take(&mut range, a[i * nv + x + 1] - a[i * nv + x]));
            }
        }
        range
    };
    // Monotone: the least value is on one edge. It is a minimum of the surface only if the slope
    // ends there too.
    let mut held = [None; 2];
    for (k, slope) in [du, dv].into_iter().enumerate() {
        if slope.0 >= -noise {
            if !setting.borders[k][0] && edge(k == 0, false).0 > noise {
                return Claim::Nothing;
            }
            held[k] = Some(0.0);
        } else if slope.1 <= noise {
            if !setting.borders[k][1] && edge(k == 0, true).1 < -noise {
                return Claim::Nothing;
            }
            held[k] = Some(1.0);
        }
    }
    match held {
        [Some(s), Some(t)] => Claim::Start(s, t),
        [Some(s), None] => {
            let row = if s > 0.0 { (nu - 1) * nv } else { 0 };
            match on_edge::<FORMS>(
                |j| row + j,
                nv,
                setting.borders[1],
                forms[0],
                whole,
                setting,
            ) {
                Some(Some(t)) => Claim::Start(s, t),
                Some(None) => Claim::Nothing,
                None => Claim::Halve(false),
            }
        }
        [None, Some(t)] => {
            let column = if t > 0.0 { nv - 1 } else { 0 };
            match on_edge::<FORMS>(
                |i| i * nv + column,
                nu,
                setting.borders[0],
                forms[0],
                whole,
                setting,
            ) {
                Some(Some(s)) => Claim::Start(s, t),
                Some(None) => Claim::Nothing,
                None => Claim::Halve(true),
            }
        }
        [None, None] => in_the_middle(forms, nu, nv, setting),
    }
}

/// On an edge that holds the least values: where to start, that there is nothing, or neither. `at`
/// gives the place of its coefficients. A rational edge has forms of its own: its values spread
/// less than those of the part.
#[inline(always)]
fn on_edge<const FORMS: usize>(
    at: impl Fn(usize) -> usize,
    n: usize,
    borders: [bool; 2],
    form: &[f64],
    whole: (&[f64], &[f64]),
    setting: &Setting,
) -> Option<Option<f64>> {
    let noise = setting.noise;
    let mut edges = [[0.0; MAX_ORDER]; FORMS];
    if FORMS == 1 {
        (0..n).for_each(|k| edges[0][k] = form[at(k)]);
    } else {
        let mut range = EMPTY;
        (0..n).for_each(|k| take(&mut range, whole.0[at(k)] / whole.1[at(k)]));
        if range.0 >= setting.ceiling {
            return Some(None);
        }
        for (edge, f) in edges
            .iter_mut()
            .zip([range.0, range.1.min(setting.ceiling)])
        {
            (0..n).for_each(|k| edge[k] = whole.0[at(k)] - f * whole.1[at(k)]);
        }
    }
    let forms = edges.each_ref().map(|e| &e[..n]);
    let (mut slope, mut bend) = (EMPTY, EMPTY);
    for a in forms {
        for k in 1..n {
            take(&mut slope, a[k] - a[k - 1]);
        }
        for k in 2..n {
            take(&mut bend, (a[k] - a[k - 1]) - (a[k - 1] - a[k - 2]));
        }
    }
    if slope.0 >= -noise {
        let on = forms.iter().any(|a| a[1] - a[0] <= noise);
        return Some((borders[0] || on).then_some(0.0));
    }
    if slope.1 <= noise {
        let on = forms.iter().any(|a| a[n - 1] - a[n - 2] >= -noise);
        return Some((borders[1] || on).then_some(1.0));
    }
    if bend.1 < -4.0 * noise {
        return (!borders[0] && !borders[1]).then_some(None);
    }
    (bend.0 > 4.0 * noise).then(|| {
        let a = forms[0];
        Some((0..n).fold(0, |at, k| if a[k] < a[at] { k } else { at }) as f64 / (n - 1) as f64)
    })
}

/// Where neither slope has a sign, the Hessian decides.
#[inline(always)]
fn in_the_middle<const FORMS: usize>(
    forms: [&[f64]; FORMS],
    nu: usize,
    nv: usize,
    setting: &Setting,
) -> Claim {
    let (mut uu, mut uv, mut vv) = (EMPTY, EMPTY, EMPTY);
    for a in forms {
        if nu < 3 {
            take(&mut uu, 0.0);
        }
        if nv < 3 {
            take(&mut vv, 0.0);
        }
        for x in 0..nu.saturating_sub(2) * nv {
            take(&mut uu, (a[x + 2 * nv] - a[x + nv]) - (a[x + nv] - a[x]));
        }
        for i in 0..nu {
            for j in 0..nv.saturating_sub(2) {
                let x = i * nv + j;
                take(&mut vv, (a[x + 2] - a[x + 1]) - (a[x + 1] - a[x]));
            }
        }
        for i in 0..nu - 1 {
            for j in 0..nv - 1 {
                let x = i * nv + j;
                take(&mut uv, (a[x + nv + 1] - a[x + nv]) - (a[x + 1] - a[x]));
            }
        }
    }
    let (p, q) = ((nu - 1) as f64, (nv - 1) as f64);
    let scaled = |range: Range, s: f64| {
        (
            (range.0 - 4.0 * setting.noise) * s,
            (range.1 + 4.0 * setting.noise) * s,
        )
    };
    let (uu, uv, vv) = (
        scaled(uu, p * (p - 1.0)),
        scaled(uv, p * q),
        scaled(vv, q * (q - 1.0)),
    );
    let most_uv = uv.0.abs().max(uv.1.abs());
    if uu.0 > 0.0 && vv.0 > 0.0 && uu.0 * vv.0 > most_uv * most_uv {
        // Start at the control point that is lowest: near the answer, and inside.
        let a = forms[0];
        let at = (0..nu * nv).fold(0, |at, k| if a[k] < a[at] { k } else { at });
        return Claim::Start((at / nv) as f64 / p, (at % nv) as f64 / q);
    }
    // Bent down, or a saddle, all over: a minimum could only be on a border.
    let open = |k: usize| !setting.borders[k][0] && !setting.borders[k][1];
    let least_uv = if uv.0 > 0.0 {
        uv.0
    } else if uv.1 < 0.0 {
        uv.1
    } else {
        0.0
    };
    let saddle = uu.1 >= 0.0 && vv.1 >= 0.0 && uu.1 * vv.1 < least_uv * least_uv;
    let down = [uu.1 < 0.0, vv.1 < 0.0];
    if (down[0] && open(0)) || (down[1] && open(1)) || (saddle && open(0) && open(1)) {
        return Claim::Nothing;
    }
    // Cut off what lies on a border, else what bends most; what only rounding bends does not count.
    let wider = setting.widths[0] >= setting.widths[1];
    if down[0] != down[1] || (saddle && open(0) != open(1)) {
        return Claim::Halve(if down[0] != down[1] { down[0] } else { open(1) });
    }
    let spread = |range: Range, s: f64| {
        (range.0.abs().max(range.1.abs()) - 8.0 * setting.noise * s).max(0.0)
    };
    let (by_u, by_v) = (spread(uu, p * (p - 1.0)), spread(vv, q * (q - 1.0)));
    let both = spread(uv, p * q);
    Claim::Halve(if saddle || both >= by_u.max(by_v) {
        wider
    } else {
        by_u >= by_v
    })
}

/// Least and greatest value of A / W by their coefficients.
pub(super) fn quotient_range(a: &[f64], w: &[f64]) -> Range {
    let mut range = EMPTY;
    for (x, y) in a.iter().zip(w) {
        take(&mut range, x / y);
    }
    range
}

/// The least coefficient is at or above the ceiling.
#[inline(always)]
pub(super) fn above(a: &[f64], ceiling: f64) -> bool {
    least(a) >= ceiling
}
