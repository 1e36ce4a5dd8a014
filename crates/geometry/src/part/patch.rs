//! A part of one face on a B-spline, as a surface and its trim.

use super::carrier::Carrier;
use super::part::Part;
use super::pcurve::FlatCurve;
use crate::surface::{Surface, Trim, TrimError};

/// Places of all loops, about.
const PLACES: usize = 2048;
/// Most chords of a cubic of a loop.
const MOST_CHORDS: usize = 64;
/// Of the domain: a place this near to an end of it is there.
const SEATED: f64 = 1e-9;

impl Part {
    /// The surface of the one face and what is kept of it, in chords of its loops; none where there are more faces, the face is
    /// on another carrier, or it closes on itself.
    ///
    /// # Errors
    /// Loops that cross, or leave the domain of the surface.
    pub fn as_patch(&self) -> Option<Result<(Surface, Trim), TrimError>> {
        let [face] = self.faces.as_slice() else {
            return None;
        };
        let (Carrier::Spline(_), [0.0, 0.0]) = (&face.carrier, face.trim.chart.periods) else {
            return None;
        };
        let flat = self.flattened(0).ok()?;
        let pictures = || flat.loops.iter().flatten().map(|piece| &piece.picture);
        let cubics: usize = pictures().map(|picture| picture.points.len() / 3).sum();
        let chords = (PLACES / cubics.max(1)).clamp(1, MOST_CHORDS);
        let domain = [flat.surface.knots_u(), flat.surface.knots_v()].map(|knots| knots.domain());
        // Edges along the ends of the surface lie on them but for rounding.
        let seated = |uv: [f64; 2]| {
            std::array::from_fn(|k| {
                let (low, high) = domain[k];
                let close = SEATED * (high - low);
                let end = [low, high]
                    .into_iter()
                    .find(|end| (uv[k] - end).abs() <= close);
                end.unwrap_or(uv[k])
            })
        };
        let loops = flat.loops.iter().map(|pieces| {
            let all = pieces
                .iter()
                .flat_map(|piece| places(&piece.picture, chords));
            all.map(seated).collect()
        });
        let loops: Vec<Vec<[f64; 2]>> = loops.collect();
        Some(Trim::new(&flat.surface, loops).map(|trim| (flat.surface, trim)))
    }
}

/// Places of a curve but the last, so many on each of its cubics, one on straight ones.
fn places(picture: &FlatCurve, chords: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
    let cubics = picture.points.windows(4).step_by(3);
    cubics.flat_map(move |points| {
        let [a, b, c, d] = [points[0], points[1], points[2], points[3]];
        let (long, bent) = ([d[0] - a[0], d[1] - a[1]], |p: [f64; 2]| {
            ((p[0] - a[0]) * (d[1] - a[1]) - (p[1] - a[1]) * (d[0] - a[0])).abs()
        });
        let straight = 1e-9 * (long[0] * long[0] + long[1] * long[1]);
        let count = if bent(b).max(bent(c)) <= straight {
            1
        } else {
            chords
        };
        (0..count).map(move |k| {
            let t = k as f64 / count as f64;
            let s = 1.0 - t;
            let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
            std::array::from_fn(|d| (0..4).map(|i| weights[i] * points[i][d]).sum())
        })
    })
}
