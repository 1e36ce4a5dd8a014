//! The product `A_u P A_vᵀ`, four samples at a time.
//!
//! First `T = P A_vᵀ` and its derivative along v, for each row of the net: a [`SweepCell`] holds four
//! neighbouring samples, one coordinate a register. Then each row of the grid blends `degree + 1`
//! rows of cells, so that all sums of four points and their tangents stay in registers until the
//! points and unit normals are stored. Tangents are in metres per length of the domain, as
//! [`Surface::normal_from`] compares them; where they do not determine the normal the surface is
//! asked.
//!
//! No closure touches a register here: closures are not compiled for AVX2, and the compiler then
//! calls each instruction.

use super::Samples;
use crate::basis::{Blending, MAX_DEGREE};
use crate::math::lanes::{Four, Lanes, Triple};
use crate::math::{Point3, Vector3};
use crate::surface::normal::inward;
use crate::surface::tensor::{Frame, Surface, wrap};

/// `cell[order][coordinate][sample]`: order 0 or 1 along v; w x, w y, w z, w; four samples.
pub(super) type SweepCell = [[Four; 4]; 2];

const WIDEST: usize = MAX_DEGREE + 1;

/// The square of the least sine (times the ratio of the tangents) with which a cross product is
/// taken for the normal.
const REGULAR: f64 = 1e-6;

/// The square of the length of S_u over that of S_v below which S_u is rounding.
const COLLAPSED: f64 = 1e-24;

pub(super) struct Sweep<'a> {
    pub u: &'a Blending,
    pub v: &'a Blending,
    pub surface: &'a Surface,
}

impl Sweep<'_> {
    /// `WU` and `WV` are the widths, or 0 to ask the blendings; `C` coordinates: 3, or 4 with
    /// weights.
    #[inline(always)]
    pub fn run<L: Lanes, const WU: usize, const WV: usize, const C: usize, const NORMALS: bool>(
        &self,
        out: &mut Samples,
    ) {
        let net = self.surface.net();
        debug_assert_eq!(
            (net.rows(), net.columns()),
            (self.u.columns(), self.v.columns()),
            "the surface has another net than the grid was made for"
        );
        self.weigh::<C>(&mut out.net);
        self.along_v::<L, WV>(&out.net, &mut out.cells);
        let (per_row, blocks) = (self.v.rows(), self.v.rows().div_ceil(4));
        for i in 0..self.u.rows() {
            let row = i * per_row..(i + 1) * per_row;
            let (points, normals, masks) = (
                &mut out.points[row.clone()],
                &mut out.normals[row],
                &mut out.regular[..blocks],
            );
            self.row::<L, WU, C, NORMALS>(i, blocks, &out.cells, points, normals, masks);
        }
    }

    #[inline(always)]
    fn weigh<const C: usize>(&self, net: &mut [Four]) {
        let points = self.surface.net().points();
        match self.surface.weights() {
            Some(weights) if C == 4 => {
                for ((to, p), &w) in net.iter_mut().zip(points).zip(weights) {
                    *to = [p.x * w, p.y * w, p.z * w, w];
                }
            }
            _ => net
                .iter_mut()
                .zip(points)
                .for_each(|(to, p)| *to = [p.x, p.y, p.z, 1.0]),
        }
    }

    /// Samples every row of the net in v.
    #[inline(always)]
    fn along_v<L: Lanes, const WV: usize>(&self, net: &[Four], cells: &mut [SweepCell]) {
        let width = if WV > 0 { WV } else { self.v.width() };
        let (columns, rows, blocks) = (
            self.v.columns(),
            self.u.columns(),
            self.v.rows().div_ceil(4),
        );
        let length = self.surface.knots_v().length();
        for block in 0..blocks {
            // Past the last sample the register repeats it.
            let samples: [usize; 4] =
                std::array::from_fn(|k| (4 * block + k).min(self.v.rows() - 1));
            let windows = samples.map(|j| {
                let ((first, values), (_, slopes)) = (self.v.row(j, 0), self.v.row(j, 1));
                (first, &values[..width], &slopes[..width])
            });
            for a in 0..rows {
                let line = &net[a * columns..(a + 1) * columns];
                let mut sums = [[L::splat(0.0); 4]; 2];
                for k in 0..4 {
                    let (first, values, slopes) = windows[k];
                    let x = L::load(&line[first]);
                    sums[0][k] = x * L::splat(values[0]);
                    sums[1][k] = x * L::splat(slopes[0] * length);
                    for b in 1..width {
                        let x = L::load(&line[wrap(first + b, columns)]);
                        sums[0][k] = sums[0][k] + x * L::splat(values[b]);
                        sums[1][k] = sums[1][k] + x * L::splat(slopes[b] * length);
                    }
                }
                let cell = &mut cells[a * blocks + block];
                for order in 0..2 {
                    let across = L::transposed(sums[order]);
                    for c in 0..4 {
                        across[c].store(&mut cell[order][c]);
                    }
                }
            }
        }
    }

    /// Row `i` of the grid, from the cells of the net's rows.
    #[inline(always)]
    fn row<L: Lanes, const WU: usize, const C: usize, const NORMALS: bool>(
        &self,
        i: usize,
        blocks: usize,
        cells: &[SweepCell],
        points: &mut [Point3],
        normals: &mut [Vector3],
        masks: &mut [u8],
    ) {
        let width = if WU > 0 { WU } else { self.u.width() };
        let ((first, values), (_, slopes)) = (self.u.row(i, 0), self.u.row(i, 1));
        let length = self.surface.knots_u().length();
        let mut shares = [L::splat(0.0); WIDEST];
        let mut turns = shares;
        let mut lines: [&[SweepCell]; WIDEST] = [&[]; WIDEST];
        for a in 0..width {
            (shares[a], turns[a]) = (L::splat(values[a]), L::splat(slopes[a] * length));
            let row = wrap(first + a, self.u.columns());
            lines[a] = &cells[row * blocks..][..blocks];
        }
        let one = L::splat(1.0);
        let outward = L::splat(if self.surface.flip_normal() {
            -1.0
        } else {
            1.0
        });
        let mut all_regular = true;
        for block in 0..blocks {
            // First the points alone, then the tangents: all sums at once do not fit into the
            // registers.
            let cell = &lines[0][block];
            let mut s = [one; C];
            for c in 0..C {
                s[c] = L::load(&cell[0][c]) * shares[0];
            }
            for a in 1..width {
                let cell = &lines[a][block];
                for c in 0..C {
                    s[c] = s[c] + L::load(&cell[0][c]) * shares[a];
                }
            }
            let per_w = if C == 4 { one / s[C - 1] } else { one };
            let mut point = [s[0], s[1], s[2]];
            if C == 4 {
                point = [s[0] * per_w, s[1] * per_w, s[2] * per_w];
            }
            let from = 4 * block;
            put(point, &mut points[from..]);
            if !NORMALS {
                continue;
            }
            let (mut du, mut dv) = ([one; C], [one; C]);
            for c in 0..C {
                du[c] = L::load(&cell[0][c]) * turns[0];
                dv[c] = L::load(&cell[1][c]) * shares[0];
            }
            for a in 1..width {
                let cell = &lines[a][block];
                for c in 0..C {
                    du[c] = du[c] + L::load(&cell[0][c]) * turns[a];
                    dv[c] = dv[c] + L::load(&cell[1][c]) * shares[a];
                }
            }
            if C == 4 {
                // Quotient rule; The NURBS Book, eq. 4.20.
                for c in 0..3 {
                    du[c] = (du[c] - point[c] * du[C - 1]) * per_w;
                    dv[c] = (dv[c] - point[c] * dv[C - 1]) * per_w;
                }
            }
            let cross = [
                du[1] * dv[2] - du[2] * dv[1],
                du[2] * dv[0] - du[0] * dv[2],
                du[0] * dv[1] - du[1] * dv[0],
            ];
            let area = cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2];
            let along_u = du[0] * du[0] + du[1] * du[1] + du[2] * du[2];
            let along_v = dv[0] * dv[0] + dv[1] * dv[1] + dv[2] * dv[2];
            let tangent = along_u.greatest(along_v);
            let regular = area.above(L::splat(REGULAR) * (tangent * tangent));
            // A root in single precision and two steps of Newton were tried: slower than this root
            // and division.
            let scale = outward / area.sqrt();
            put(
                [cross[0] * scale, cross[1] * scale, cross[2] * scale],
                &mut normals[from..],
            );
            all_regular &= regular == 0b1111;
            masks[block] = regular;
        }
        if !NORMALS || all_regular {
            return;
        }
        // Apart from the loop above, whose registers are all in use.
        for block in 0..blocks {
            let (regular, from) = (masks[block], 4 * block);
            if regular == 0b1111 {
                continue;
            }
            let cell = &lines[0][block];
            let (mut du, mut dv) = ([one; C], [one; C]);
            for c in 0..C {
                du[c] = L::load(&cell[0][c]) * turns[0];
                dv[c] = L::load(&cell[1][c]) * shares[0];
            }
            for a in 1..width {
                let cell = &lines[a][block];
                for c in 0..C {
                    du[c] = du[c] + L::load(&cell[0][c]) * turns[a];
                    dv[c] = dv[c] + L::load(&cell[1][c]) * shares[a];
                }
            }
            let along_u = du[0] * du[0] + du[1] * du[1] + du[2] * du[2];
            let along_v = dv[0] * dv[0] + dv[1] * dv[1] + dv[2] * dv[2];
            // At a pole in v, S_u vanishes and S_u × S_v grows as S_uv × S_v does.
            let mut duv = [one; C];
            for c in 0..C {
                duv[c] = L::load(&cell[1][c]) * turns[0];
            }
            for a in 1..width {
                for c in 0..C {
                    duv[c] = duv[c] + L::load(&lines[a][block][1][c]) * turns[a];
                }
            }
            let grows = [
                duv[1] * dv[2] - duv[2] * dv[1],
                duv[2] * dv[0] - duv[0] * dv[2],
                duv[0] * dv[1] - duv[1] * dv[0],
            ];
            let growth = grows[0] * grows[0] + grows[1] * grows[1] + grows[2] * grows[2];
            let across = duv[0] * duv[0] + duv[1] * duv[1] + duv[2] * duv[2];
            let mut pole = (L::splat(COLLAPSED) * along_v).above(along_u);
            pole &= growth.above(L::splat(REGULAR) * (across * along_v));
            let scale = outward / growth.sqrt();
            let mut limits = [Vector3::zeros(); 4];
            put(
                [grows[0] * scale, grows[1] * scale, grows[2] * scale],
                &mut limits,
            );
            for (k, j) in (from..normals.len().min(from + 4)).enumerate() {
                if regular & (1 << k) == 0 {
                    let inward = inward(self.surface.knots_v(), self.v.parameters()[j]);
                    let simple = C == 3 && pole & (1 << k) != 0 && inward != 0.0;
                    normals[j] = if simple {
                        limits[k] * inward
                    } else {
                        self.normal(i, j)
                    };
                }
            }
        }
    }

    /// The normal where the tangents do not say: a pole, a sharp corner.
    fn normal(&self, i: usize, j: usize) -> Vector3 {
        let (u, v) = (self.u.parameters()[i], self.v.parameters()[j]);
        if self.surface.weights().is_some() {
            return self.surface.normal(u, v);
        }
        // The blendings have the derivatives at hand; computing them anew would take most of the
        // time.
        let (rows, columns) = (self.surface.net().rows(), self.surface.net().columns());
        let points = self.surface.net().points();
        let mut sums = [[Vector3::zeros(); 3]; 3];
        let (first_u, first_v) = (self.u.row(i, 0).0, self.v.row(j, 0).0);
        let in_u: [&[f64]; 3] = std::array::from_fn(|order| self.u.row(i, order).1);
        let in_v: [&[f64]; 3] = std::array::from_fn(|order| self.v.row(j, order).1);
        for a in 0..in_u[0].len() {
            let line = wrap(first_u + a, rows) * columns;
            let mut along = [Vector3::zeros(); 3];
            for b in 0..in_v[0].len() {
                let point = points[line + wrap(first_v + b, columns)].coords;
                for order in 0..3 {
                    along[order] += point * in_v[order][b];
                }
            }
            for k in 0..3 {
                for l in 0..3 - k {
                    sums[k][l] += along[l] * in_u[k][a];
                }
            }
        }
        let [[s, dv, dvv], [du, duv, _], [duu, _, _]] = sums;
        self.surface.normal_of(
            &Frame {
                point: Point3::from(s),
                du,
                dv,
                duu,
                duv,
                dvv,
            },
            u,
            v,
        )
    }
}

/// Stores four triples, or as many as there are places.
#[inline(always)]
fn put<L: Lanes, T: Triple>([x, y, z]: [L; 3], to: &mut [T]) {
    if let Some(four) = to.first_chunk_mut::<4>() {
        L::interleave(x, y, z, T::flat(four));
    } else {
        let mut flat = [0.0; 12];
        L::interleave(x, y, z, &mut flat);
        for (to, x) in to.iter_mut().zip(flat.as_chunks::<3>().0) {
            *to = T::from(*x);
        }
    }
}
