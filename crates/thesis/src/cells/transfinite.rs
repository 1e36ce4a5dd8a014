//! Builder `transfinite`: a cube lattice mapped into a closed surface, or a sheet given a
//! thickness.
//!
//! Closed surfaces with two poles: the outermost nodes of the cube go to a sphere by equal angles
//! (Ronchi, Iacono, Paolucci 1996), and its longitude and latitude to the parameters of the
//! surface, by mean arc length around and along. The nodes inside are the harmonic map of those
//! ([`harmonic`](super::harmonic)). Cells that come out folded, as where the body bends, are unfolded
//! by [`untangle`](super::untangle).

use super::cube::{CubeError, CubeLattice, check_closed, check_finite, is_outermost};
use super::{harmonic, untangle};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// A lattice of `counts` nodes inside a closed surface with two poles; the third axis goes from
/// pole to pole. All nodes of its six faces ride on the surface.
///
/// # Errors
/// A surface that is not of this kind, encloses nothing, or whose cells stay folded; counts.
pub fn transfinite(surface: &Surface, counts: [usize; 3]) -> Result<CubeLattice, CubeError> {
    let chart = Chart::new(surface)?;
    let mut lattice = CubeLattice::new(counts, |place| {
        if !is_outermost(counts, place) {
            return (Point3::origin(), None);
        }
        let [u, v] = chart.at(cubed_sphere(counts, place));
        (surface.point(u, v), Some([u, v]))
    })?;
    harmonic::fill(&mut lattice);
    untangle::untangle(&mut lattice, surface);
    lattice.unfolded()
}

/// A lattice on an open sheet: `counts[0]` nodes along u and `counts[1]` along v, even in mean arc
/// length, on the surface; `counts[2]` deep, the last `thickness_m` below along the inward normals.
/// Only the first of each column rides on the surface.
///
/// # Errors
/// A closed surface, a thickness that is not positive, cells folded because the sheet bends within
/// its thickness; counts.
pub fn thick_sheet(
    surface: &Surface,
    counts: [usize; 3],
    thickness_m: f64,
) -> Result<CubeLattice, CubeError> {
    check_finite(surface)?;
    if !(thickness_m.is_finite() && thickness_m > 0.0) {
        return Err(CubeError::Length {
            what: "the thickness",
            value_m: thickness_m,
        });
    }
    let topology = surface.topology();
    if topology.wraps(0) || topology.wraps(1) || topology.is_closed() {
        return Err(CubeError::Topology {
            needed: "a sheet with four open edges",
        });
    }
    let tables = [ArcTable::new(surface, true), ArcTable::new(surface, false)];
    let share = |t: usize, n: usize| t as f64 / (n - 1) as f64;
    let mut lattice = CubeLattice::new(counts, |[i, j, k]| {
        let (u, v) = (
            tables[0].parameter(share(i, counts[0])),
            tables[1].parameter(share(j, counts[1])),
        );
        let depth = thickness_m * share(k, counts[2]);
        let point = surface.point(u, v);
        if k == 0 {
            (point, Some([u, v]))
        } else {
            (point - surface.normal(u, v) * depth, None)
        }
    })?;
    // Downwards is the third axis: left-handed for a surface whose normal is S_u × S_v.
    lattice.grid = lattice.grid.right_handed();
    lattice.unfolded()
}

/// Direction of an outermost node on the cubed sphere, longest component 1: steps of equal angle on
/// each face.
fn cubed_sphere(counts: [usize; 3], place: [usize; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let steps = counts[axis] as f64 - 1.0;
        // Written so that opposite nodes get opposite values to the last bit.
        let share = (2.0 * place[axis] as f64 - steps) / steps;
        if share.abs() == 1.0 {
            share
        } else {
            libm::tan(FRAC_PI_4 * share)
        }
    })
}

/// Parameters of a closed surface with two poles by the directions of a sphere.
struct Chart {
    around: ArcTable,
    along: ArcTable,
    u_around: bool,
    /// Longitude runs the other way, so that right-handed cells stay so.
    mirrored: bool,
}

impl Chart {
    fn new(surface: &Surface) -> Result<Self, CubeError> {
        let volume = check_closed(surface)?;
        let u_around = surface.topology().wraps(0);
        let (around, along) = (
            ArcTable::new(surface, u_around),
            ArcTable::new(surface, !u_around),
        );
        Ok(Self {
            around,
            along,
            u_around,
            mirrored: (volume > 0.0) != u_around,
        })
    }

    /// (u, v) of a direction; −z is the pole where the direction along starts.
    fn at(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let longitude = libm::atan2(if self.mirrored { -y } else { y }, x) / TAU;
        let latitude = libm::atan2(libm::hypot(x, y), -z) / PI;
        let around = self.around.parameter(if longitude < 0.0 {
            longitude + 1.0
        } else {
            longitude
        });
        let along = self.along.parameter(latitude);
        if self.u_around {
            [around, along]
        } else {
            [along, around]
        }
    }
}

/// Lengths between samples of a table of arc length; short against a knot span of the nets in use.
const ARC_STEPS: usize = 256;

/// Lines over which arc length is averaged.
const ARC_LINES: usize = 16;

/// Parameter by arc length, meant over lines of one direction.
struct ArcTable {
    start: f64,
    step: f64,
    /// Share of the length up to each sample: rising from 0 to 1.
    share: Vec<f64>,
}

impl ArcTable {
    fn new(surface: &Surface, along_u: bool) -> Self {
        let (knots, across) = if along_u {
            (surface.knots_u(), surface.knots_v())
        } else {
            (surface.knots_v(), surface.knots_u())
        };
        let (start, end) = knots.domain();
        let step = (end - start) / ARC_STEPS as f64;
        let (low, high) = across.domain();
        let lines: Vec<_> = (0..ARC_LINES)
            .map(|line| across.window(low + (high - low) * (line as f64 + 0.5) / ARC_LINES as f64))
            .collect();
        let mut share = vec![0.0; ARC_STEPS + 1];
        let mut last: Vec<Point3> = Vec::new();
        for k in 0..=ARC_STEPS {
            let window = knots.window(if k == ARC_STEPS {
                end
            } else {
                start + step * k as f64
            });
            let points: Vec<Point3> = lines
                .iter()
                .map(|line| {
                    if along_u {
                        surface.point_in(&window, line)
                    } else {
                        surface.point_in(line, &window)
                    }
                })
                .collect();
            let length: f64 = points.iter().zip(&last).map(|(a, b)| (a - b).norm()).sum();
            share[k] = if k == 0 { 0.0 } else { share[k - 1] + length };
            last = points;
        }
        let total = share[ARC_STEPS];
        for value in &mut share {
            *value /= total;
        }
        Self { start, step, share }
    }

    /// Parameter at a share of the length, in [0, 1].
    fn parameter(&self, share: f64) -> f64 {
        let k = self
            .share
            .partition_point(|&s| s < share)
            .clamp(1, ARC_STEPS);
        let (before, after) = (self.share[k - 1], self.share[k]);
        let within = if after > before {
            ((share - before) / (after - before)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        self.start + self.step * (k as f64 - 1.0 + within)
    }
}
