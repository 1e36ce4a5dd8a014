//! Forces of four cells at a time.
//!
//! A cell's map is x(ξ) = Σ c_m ξ^m over the eight monomials 1, ζ, η, ηζ, ξ, ξζ, ξη, ξηζ (bit 4 of
//! m: ξ, 2: η, 1: ζ); its modes c come from the corners by sums and differences alone. With G =
//! ∂x/∂ξ and the metric S = J₀⁻¹ J₀⁻ᵀ of rest, I_C = tr(G S Gᵀ), so F itself is never formed. The
//! volume is a polynomial of the modes: V / 8 = [c_ξ, c_η, c_ζ] + ⅓ ([c_ξ, c_ξη, c_ξζ] + [c_η,
//! c_ηζ, c_ξη] + [c_ζ, c_ξζ, c_ηζ]).

use super::rest::GAUSS;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Matrix3};

/// Rows of a metric: xx yy zz xy xz yz.
pub(super) const ROWS: usize = 6;

/// A symmetric matrix as the rows of a metric.
pub(super) fn rows_of(s: &Matrix3) -> [f64; ROWS] {
    [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|at| s[at])
}

/// Four cells side by side; missing ones have no stiffness.
#[derive(Clone, Debug)]
pub(super) struct CellBlock {
    /// (Gauss point, xx yy zz xy xz yz): J₀⁻¹ J₀⁻ᵀ, 1/m².
    pub metric: [[Four; 6]; 8],
    /// (Gauss point): μ' × share of the volume, J.
    pub stiffness_j: [Four; 8],
    /// Cells that are there, the first of the four.
    pub count: usize,
    /// (corner, cell).
    pub nodes: [[u32; 4]; 8],
    /// 1 / V₀, with the sign of the winding, 1/m³.
    pub per_volume: Four,
    /// ±1, the winding.
    pub winding: Four,
    /// λ', Pa.
    pub bulk_pa: Four,
    /// 1 / λ', 1/Pa; 0 for missing cells.
    pub per_bulk: Four,
    /// μ, Pa.
    pub shear_pa: Four,
}

pub(super) type Triple<L> = [L; 3];

#[inline(always)]
fn plus<L: Lanes>(a: Triple<L>, b: Triple<L>) -> Triple<L> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn minus<L: Lanes>(a: Triple<L>, b: Triple<L>) -> Triple<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn times<L: Lanes>(a: Triple<L>, factor: L) -> Triple<L> {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

#[inline(always)]
pub(super) fn dot<L: Lanes>(a: Triple<L>, b: Triple<L>) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross<L: Lanes>(a: Triple<L>, b: Triple<L>) -> Triple<L> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Modes from corners.
#[inline(always)]
pub(super) fn modes<L: Lanes>(nodes: &[[u32; 4]; 8], places: &[Lane]) -> [Triple<L>; 8] {
    let zero = L::splat(0.0);
    let eighth = L::splat(0.125);
    let mut c = [[zero; 3]; 8];
    for corner in 0..8 {
        let n = &nodes[corner];
        let rows = L::transposed([
            L::load(&places[n[0] as usize]),
            L::load(&places[n[1] as usize]),
            L::load(&places[n[2] as usize]),
            L::load(&places[n[3] as usize]),
        ]);
        c[corner] = [rows[0], rows[1], rows[2]];
    }
    for bit in [1, 2, 4] {
        for low in 0..8 {
            if low & bit == 0 {
                let (a, b) = (c[low], c[low | bit]);
                c[low] = plus(a, b);
                c[low | bit] = minus(b, a);
            }
        }
    }
    for mode in 1..8 {
        c[mode] = times(c[mode], eighth);
    }
    c
}

/// base + s g first + t g second + s t g² both at (s, t) = (−, −), (−, +), (+, −), (+, +).
#[inline(always)]
fn spread<L: Lanes>(
    base: Triple<L>,
    first: Triple<L>,
    second: Triple<L>,
    both: Triple<L>,
) -> [Triple<L>; 4] {
    let (g, third) = (L::splat(GAUSS), L::splat(GAUSS * GAUSS));
    let (first, second, both) = (times(first, g), times(second, g), times(both, third));
    let (base_low, base_high) = (minus(base, first), plus(base, first));
    let (slope_low, slope_high) = (minus(second, both), plus(second, both));
    [
        minus(base_low, slope_low),
        plus(base_low, slope_low),
        minus(base_high, slope_high),
        plus(base_high, slope_high),
    ]
}

/// The transpose of [`spread`].
#[inline(always)]
fn gather<L: Lanes>(at: &[Triple<L>; 4]) -> [Triple<L>; 4] {
    let (g, third) = (L::splat(GAUSS), L::splat(GAUSS * GAUSS));
    let (base_low, slope_low) = (plus(at[0], at[1]), minus(at[1], at[0]));
    let (base_high, slope_high) = (plus(at[2], at[3]), minus(at[3], at[2]));
    [
        plus(base_low, base_high),
        times(minus(base_high, base_low), g),
        times(plus(slope_low, slope_high), g),
        times(minus(slope_high, slope_low), third),
    ]
}

/// ∂x/∂ξ by (η, ζ), ∂x/∂η by (ξ, ζ), ∂x/∂ζ by (ξ, η).
#[inline(always)]
pub(super) fn slopes<L: Lanes>(c: &[Triple<L>; 8]) -> [[Triple<L>; 4]; 3] {
    [
        spread(c[4], c[6], c[5], c[7]),
        spread(c[2], c[6], c[3], c[7]),
        spread(c[1], c[5], c[3], c[7]),
    ]
}

/// Places of a Gauss point in each row of [`slopes`].
#[inline(always)]
pub(super) fn at(gauss: usize) -> [usize; 3] {
    [gauss & 3, (gauss >> 2) * 2 + (gauss & 1), gauss >> 1]
}

/// G S at a Gauss point and I_C.
#[inline(always)]
pub(super) fn stretch<L: Lanes>(metric: &[Four; 6], g: [Triple<L>; 3]) -> ([Triple<L>; 3], L) {
    let [xx, yy, zz] = [
        L::load(&metric[0]),
        L::load(&metric[1]),
        L::load(&metric[2]),
    ];
    let [xy, xz, yz] = [
        L::load(&metric[3]),
        L::load(&metric[4]),
        L::load(&metric[5]),
    ];
    let t = [
        plus(plus(times(g[0], xx), times(g[1], xy)), times(g[2], xz)),
        plus(plus(times(g[0], xy), times(g[1], yy)), times(g[2], yz)),
        plus(plus(times(g[0], xz), times(g[1], yz)), times(g[2], zz)),
    ];
    let invariant = dot(t[0], g[0]) + dot(t[1], g[1]) + dot(t[2], g[2]);
    (t, invariant)
}

/// The square of the most that four cells are stretched by at their centres, as a factor, or a little more: the largest
/// eigenvalue of b = G S Gᵀ.
#[inline(always)]
pub(in crate::body) fn stretched<L: Lanes>(
    nodes: &[[u32; 4]; 8],
    metric: &[Four; 6],
    places: &[Lane],
) -> L {
    let [xx, yy, zz, xy, xz, yz] = left_stretch::<L>(nodes, metric, places);
    largest([xx, yy, zz], [xy, xz, yz])
}

/// b = G S Gᵀ at the centres: xx yy zz xy xz yz.
#[inline(always)]
fn left_stretch<L: Lanes>(nodes: &[[u32; 4]; 8], metric: &[Four; 6], places: &[Lane]) -> [L; 6] {
    let c = modes::<L>(nodes, places);
    let g = [c[4], c[2], c[1]];
    let (t, _) = stretch(metric, g);
    let b = |i: usize, j: usize| t[0][i] * g[0][j] + t[1][i] * g[1][j] + t[2][i] * g[2][j];
    [b(0, 0), b(1, 1), b(2, 2), b(0, 1), b(0, 2), b(1, 2)]
}

/// The largest eigenvalue of a symmetric matrix, or a little more: at most m + 2 p, m the mean of its diagonal and 6 p²
/// the sum of the squares of what is left of it.
#[inline(always)]
fn largest<L: Lanes>([x, y, z]: [L; 3], [p, q, r]: [L; 3]) -> L {
    let mean = (x + y + z) * L::splat(1.0 / 3.0);
    let (x, y, z) = (x - mean, y - mean, z - mean);
    let aside = p * p + q * q + r * r;
    let square = x * x + y * y + z * z + aside + aside;
    mean + (square * L::splat(4.0 / 6.0)).sqrt()
}

/// The inverses of four symmetric matrices, xx yy zz xy xz yz; zero of those without one.
pub(in crate::body) fn inverses([xx, yy, zz, xy, xz, yz]: &[Four; 6]) -> [Four; 6] {
    let mut inverses = [[0.0; 4]; 6];
    for k in 0..4 {
        let (off, across) = ([xy[k], xz[k], yz[k]], [xx[k], yy[k], zz[k]]);
        let [a, b, c] = off;
        let matrix = Matrix3::new(across[0], a, b, a, across[1], c, b, c, across[2]);
        let inverse = matrix.try_inverse().unwrap_or_else(Matrix3::zeros);
        for (row, value) in inverses.iter_mut().zip(rows_of(&inverse)) {
            row[k] = value;
        }
    }
    inverses
}

/// JᵀJ of four cells at their centres, m²: xx yy zz xy xz yz.
pub(in crate::body) fn squares_at_centre(nodes: &[[u32; 4]; 8], places: &[Lane]) -> [Four; 6] {
    let c = modes::<Baseline>(nodes, places);
    let [x, y, z] = [c[4], c[2], c[1]];
    let dot = |a: Triple<Baseline>, b: Triple<Baseline>| {
        let mut four = [0.0; 4];
        (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]).store(&mut four);
        four
    };
    [
        dot(x, x),
        dot(y, y),
        dot(z, z),
        dot(x, y),
        dot(x, z),
        dot(y, z),
    ]
}

/// The square of the most that an area of each of four cells has grown by at its centre, as a factor, or a little more:
/// the largest eigenvalue of cof b.
#[inline(always)]
pub(in crate::body) fn areas_squared<L: Lanes>(
    nodes: &[[u32; 4]; 8],
    metric: &[Four; 6],
    places: &[Lane],
) -> L {
    let [xx, yy, zz, xy, xz, yz] = left_stretch::<L>(nodes, metric, places);
    let diagonal = [yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy];
    let aside = [xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - yz * xx];
    largest(diagonal, aside)
}

/// ∂(V / 8)/∂c for the modes 1 … 6, and V.
#[inline(always)]
pub(super) fn volume<L: Lanes>(c: &[Triple<L>; 8]) -> ([Triple<L>; 8], L) {
    let third = L::splat(1.0 / 3.0);
    let (x, y, z) = (c[4], c[2], c[1]);
    let (xy, xz, yz) = (times(c[6], third), times(c[5], third), times(c[3], third));
    let dx = plus(cross(y, z), cross(xy, c[5]));
    let dy = plus(cross(z, x), cross(yz, c[6]));
    let dz = plus(cross(x, y), cross(xz, c[3]));
    let dyz = plus(cross(xy, y), cross(z, xz));
    let dxz = plus(cross(x, xy), cross(yz, z));
    let dxy = plus(cross(xz, x), cross(y, yz));
    // [x, y, z] is in all of the three, each of the others in one of them: take it off twice.
    let twice = dot(x, cross(y, z)) * L::splat(2.0);
    let volume = (dot(x, dx) + dot(y, dy) + dot(z, dz) - twice) * L::splat(8.0);
    let zero = L::splat(0.0);
    ([[zero; 3], dz, dy, dyz, dx, dxz, dxy, [zero; 3]], volume)
}

/// Adds the forces of a block's cells with a metric for each Gauss point and, where they are given, pressures; answers
/// with the gaps of [`pressure`].
#[inline(always)]
pub(super) fn add_forces<L: Lanes>(
    block: &CellBlock,
    metrics: &[[Four; 6]; 8],
    given_pa: Option<&Four>,
    places: &[Lane],
    residual: &mut [Lane],
) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let c = modes::<L>(&block.nodes, places);
    let slopes = slopes(&c);
    let mut pulls = [[[zero; 3]; 4]; 3];
    for gauss in 0..8 {
        let [i, j, k] = at(gauss);
        let (t, invariant) = stretch(&metrics[gauss], [slopes[0][i], slopes[1][j], slopes[2][k]]);
        // P = μ' (1 − 1 / (I_C + 1)) F: Smith, de Goes & Kim 2018, eq. 14.
        let factor = L::load(&block.stiffness_j[gauss]) * (one - one / (invariant + one));
        pulls[0][i] = plus(pulls[0][i], times(t[0], factor));
        pulls[1][j] = plus(pulls[1][j], times(t[1], factor));
        pulls[2][k] = plus(pulls[2][k], times(t[2], factor));
    }
    let (x, y, z) = (gather(&pulls[0]), gather(&pulls[1]), gather(&pulls[2]));
    let (growth, volume) = volume(&c);
    let (pressure, gap) = pressure(block, volume, given_pa);
    let eighth = L::splat(-0.125);
    let mut force = [
        [zero; 3],
        z[0],
        y[0],
        plus(y[2], z[2]),
        x[0],
        plus(x[2], z[1]),
        plus(x[1], y[1]),
        plus(plus(x[3], y[3]), z[3]),
    ];
    for mode in 1..8 {
        force[mode] = minus(times(force[mode], eighth), times(growth[mode], pressure));
    }
    scatter(&block.nodes, force, residual);
    gap
}

/// Adds forces on the modes to the corners' nodes.
#[inline(always)]
pub(super) fn scatter<L: Lanes>(
    nodes: &[[u32; 4]; 8],
    mut force: [Triple<L>; 8],
    residual: &mut [Lane],
) {
    for bit in [1, 2, 4] {
        for low in 0..8 {
            if low & bit == 0 {
                let (a, b) = (force[low], force[low | bit]);
                force[low] = minus(a, b);
                force[low | bit] = plus(a, b);
            }
        }
    }
    for corner in 0..8 {
        let [fx, fy, fz] = force[corner];
        let rows = L::transposed([fx, fy, fz, L::splat(0.0)]);
        for (row, &node) in rows.into_iter().zip(&nodes[corner]) {
            let lane = &mut residual[node as usize];
            (L::load(lane) + row).store(lane);
        }
    }
}

/// ∂Ψ/∂V = q − μ with the sign of the winding, Pa, and the gap J̄ − 1 − q / λ' between volume and pressure. Without a given
/// pressure q is λ' (J̄ − 1), and the gap is zero.
#[inline(always)]
pub(super) fn pressure<L: Lanes>(block: &CellBlock, volume: L, given_pa: Option<&Four>) -> (L, L) {
    let grown = grown(block, volume);
    let (q, gap) = match given_pa {
        Some(q) => {
            let q = L::load(q);
            (q, grown - q * L::load(&block.per_bulk))
        }
        None => (L::load(&block.bulk_pa) * grown, L::splat(0.0)),
    };
    (
        (q - L::load(&block.shear_pa)) * L::load(&block.winding),
        gap,
    )
}

/// J̄ − 1.
#[inline(always)]
pub(super) fn grown<L: Lanes>(block: &CellBlock, volume: L) -> L {
    let grown = volume * L::load(&block.per_volume) - L::splat(1.0);
    // The bounds are far out: they only turn what has overflowed into numbers.
    grown.greatest(L::splat(-1e90)).least(L::splat(1e90))
}
