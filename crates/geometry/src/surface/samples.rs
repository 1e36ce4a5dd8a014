//! A fixed grid of parameters on surfaces with the same knots: points and normals out, nets back
//! in.
//!
//! `M = A_u P A_vᵀ` and its inverse in the least-squares sense, a direction at a time. Everything
//! is allocated at construction.

mod fit;
mod sweep;

pub use self::fit::GridFit;
use self::sweep::{Sweep, SweepCell};
use super::Surface;
use crate::basis::Blending;
use crate::math::lanes::{Baseline, Four, Lanes};
use crate::math::{Point3, Vector3};

/// Parameters (u_i, v_j) for all surfaces with one pair of knot vectors.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleGrid {
    u: Blending,
    v: Blending,
}

/// Points and unit outward normals at a [`SampleGrid`], u-major, and the room to compute them.
#[derive(Clone, Debug)]
pub struct Samples {
    /// (rows × columns), m.
    pub points: Vec<Point3>,
    /// (rows × columns), unit, outward.
    pub normals: Vec<Vector3>,
    /// (net rows × net columns): w x, w y, w z, w.
    net: Vec<Four>,
    /// (net rows × columns / 4): each row of the net sampled in v.
    cells: Vec<SweepCell>,
    /// (columns / 4): which samples of a row have a normal by their tangents, a bit each.
    regular: Vec<u8>,
}

impl SampleGrid {
    /// The grid of all pairs of `us` and `vs` on surfaces with the knots of this one.
    pub fn new(surface: &Surface, us: &[f64], vs: &[f64]) -> Self {
        Self {
            u: Blending::new(surface.knots_u(), us),
            v: Blending::new(surface.knots_v(), vs),
        }
    }

    /// From blendings at hand, u and v.
    pub fn from_blendings(u: Blending, v: Blending) -> Self {
        Self { u, v }
    }

    /// Blending in u.
    pub fn u(&self) -> &Blending {
        &self.u
    }

    /// Blending in v.
    pub fn v(&self) -> &Blending {
        &self.v
    }

    /// Buffers of the right size, all zero.
    pub fn samples(&self) -> Samples {
        let count = self.u.rows() * self.v.rows();
        Samples {
            points: vec![Point3::origin(); count],
            normals: vec![Vector3::zeros(); count],
            net: vec![[0.0; 4]; self.u.columns() * self.v.columns()],
            cells: vec![[[[0.0; 4]; 4]; 2]; self.u.columns() * self.v.rows().div_ceil(4)],
            regular: vec![0; self.v.rows().div_ceil(4)],
        }
    }

    /// Fills `out` from a surface with this grid's knots. Allocates nothing.
    pub fn evaluate_into(&self, surface: &Surface, out: &mut Samples) {
        self.sweep::<true>(surface, out);
    }

    /// [`SampleGrid::evaluate_into`] without the normals, which stay as they are.
    pub fn points_into(&self, surface: &Surface, out: &mut Samples) {
        self.sweep::<false>(surface, out);
    }

    fn sweep<const NORMALS: bool>(&self, surface: &Surface, out: &mut Samples) {
        #[cfg(target_arch = "x86_64")]
        if crate::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { sweep_wide::<NORMALS>(self, surface, out) };
        }
        self.sweep_in::<Baseline, NORMALS>(surface, out);
    }

    #[inline(always)]
    fn sweep_in<L: Lanes, const NORMALS: bool>(&self, surface: &Surface, out: &mut Samples) {
        let sweep = Sweep {
            u: &self.u,
            v: &self.v,
            surface,
        };
        // Constant widths and a constant number of coordinates make straight loops.
        match (self.u.width(), self.v.width(), surface.weights().is_some()) {
            (4, 4, false) => sweep.run::<L, 4, 4, 3, NORMALS>(out),
            (4, 4, true) => sweep.run::<L, 4, 4, 4, NORMALS>(out),
            (_, _, false) => sweep.run::<L, 0, 0, 3, NORMALS>(out),
            (_, _, true) => sweep.run::<L, 0, 0, 4, NORMALS>(out),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sweep_wide<const NORMALS: bool>(grid: &SampleGrid, surface: &Surface, out: &mut Samples) {
    grid.sweep_in::<crate::math::lanes::Wide, NORMALS>(surface, out);
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::super::testing::fifty_surfaces;
    use super::*;
    use crate::basis::testing::{Random, parameters};
    use crate::basis::{KnotKind, KnotVector};

    #[test]
    fn samples_are_the_points_and_normals_of_the_surface() {
        let mut random = Random(81);
        let builtins =
            ["teardrop", "sphere", "torus", "sheet"].map(|name| builtin(name, None, None).unwrap());
        for surface in fifty_surfaces(81).into_iter().chain(builtins) {
            let us = parameters(&mut random, surface.knots_u(), 5);
            let vs = parameters(&mut random, surface.knots_v(), 5);
            let grid = SampleGrid::new(&surface, &us, &vs);
            let mut samples = grid.samples();
            grid.evaluate_into(&surface, &mut samples);
            for (i, &u) in us.iter().enumerate() {
                for (j, &v) in vs.iter().enumerate() {
                    let k = i * vs.len() + j;
                    let (point, normal) = (surface.point(u, v), surface.normal(u, v));
                    assert!(
                        (samples.points[k] - point).norm() < 1e-14,
                        "({u}, {v}) of {surface:?}"
                    );
                    assert!(
                        (samples.normals[k] - normal).norm() < 1e-8,
                        "({u}, {v}) of {surface:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn grids_have_the_same_bits_on_every_processor() {
        let mut random = Random(83);
        let builtins =
            ["teardrop", "sphere", "torus", "sheet"].map(|name| builtin(name, None, None).unwrap());
        for surface in fifty_surfaces(83).into_iter().chain(builtins) {
            let us = parameters(&mut random, surface.knots_u(), 7);
            let vs = parameters(&mut random, surface.knots_v(), 6);
            let grid = SampleGrid::new(&surface, &us, &vs);
            let (mut slow, mut fast, mut bare) = (grid.samples(), grid.samples(), grid.samples());
            grid.sweep_in::<Baseline, true>(&surface, &mut slow);
            grid.evaluate_into(&surface, &mut fast);
            grid.points_into(&surface, &mut bare);
            assert_eq!(slow.points, fast.points, "{surface:?}");
            assert_eq!(slow.normals, fast.normals, "{surface:?}");
            assert_eq!(slow.points, bare.points, "{surface:?}");
        }
    }

    // Every number of samples from none to beyond two registers: the last register is not full.
    #[test]
    fn grids_of_any_count_fill_what_they_should() {
        let surface = builtin("teardrop", None, None)
            .unwrap()
            .with_flip_normal(true);
        for count in 0..10 {
            let vs: Vec<f64> = (0..count).map(|k| 0.03 + 0.1 * k as f64).collect();
            let grid = SampleGrid::new(&surface, &[0.2, 0.7], &vs);
            let mut samples = grid.samples();
            grid.evaluate_into(&surface, &mut samples);
            for (k, (point, normal)) in samples.points.iter().zip(&samples.normals).enumerate() {
                let (u, v) = ([0.2, 0.7][k / count], vs[k % count]);
                assert!(
                    (point - surface.point(u, v)).norm() < 1e-15
                        && (normal - surface.normal(u, v)).norm() < 1e-13
                );
            }
        }
    }

    #[test]
    fn a_fit_to_its_own_samples_recovers_the_net() {
        for surface in fifty_surfaces(82)
            .into_iter()
            .filter(|s| s.weights().is_none())
        {
            let spread = |knots: &KnotVector| -> Vec<f64> {
                let (t, count) = (knots.knots(), knots.degree() + 2);
                let at =
                    |i: usize, k: usize| t[i] + (t[i + 1] - t[i]) * (k as f64 + 0.5) / count as f64;
                knots
                    .spans()
                    .flat_map(|i| (0..count).map(move |k| at(i, k)))
                    .collect()
            };
            let grid = SampleGrid::new(
                &surface,
                &spread(surface.knots_u()),
                &spread(surface.knots_v()),
            );
            let mut samples = grid.samples();
            grid.evaluate_into(&surface, &mut samples);
            let mut net = surface.net().clone();
            net.points_mut().fill(Point3::origin());
            GridFit::new(&grid).fit_into(&samples.points, &mut net);
            // The outermost control points of an open vector reach the domain with 1/p! at most:
            // from degree 6 on the samples' own rounding is worth more than the bar there.
            let faint = [surface.knots_u(), surface.knots_v()]
                .iter()
                .any(|knots| knots.kind() == KnotKind::Open && knots.degree() >= 6);
            let tolerance = if faint { 1e-8 } else { 1e-10 } * surface.size();
            for (a, b) in net.points().iter().zip(surface.net().points()) {
                assert!((a - b).norm() < tolerance, "{a} is not {b} in {surface:?}");
            }
        }
    }
}
