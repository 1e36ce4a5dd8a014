//! A part of one face on a B-spline, as a surface and its trim.

use super::bezier;
use super::carrier::Carrier;
use super::part::Part;
use crate::surface::{Surface, Trim, TrimError};

/// Places of all loops, about.
const PLACES: usize = 2048;
/// Most chords of a monotone piece of a loop.
const MOST_CHORDS: usize = 64;
/// In parameters over the range of the loops: pieces farther apart belong to two loops.
const APART: f64 = 1e-4;

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
        let (Carrier::Spline(surface), [0.0, 0.0]) = (&face.carrier, face.trim.chart.periods)
        else {
            return None;
        };
        let walks: Vec<_> = face.trim.walks().collect();
        let chords = (PLACES / walks.len().max(1)).clamp(1, MOST_CHORDS);
        let range = face.trim.reach.map(|[low, high]| high - low);
        let near =
            |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() <= APART * range[k]);
        let mut loops: Vec<Vec<[f64; 2]>> = Vec::new();
        for walk in walks {
            let (points, [from, to]) = walk.points?;
            let n = if points.len() == 2 { 1 } else { chords };
            let at = |k: usize| {
                let t = from + (to - from) * (k as f64 / n as f64);
                face.trim.chart.raw(&bezier::evaluate(points, t).0)
            };
            let follows = |places: &&mut Vec<[f64; 2]>| {
                let closed = places.len() > 2 && near(places[0], places[places.len() - 1]);
                !closed && near(places[places.len() - 1], at(0))
            };
            match loops.last_mut().filter(follows) {
                Some(places) => places.extend((1..=n).map(at)),
                None => loops.push((0..=n).map(at).collect()),
            }
        }
        for places in &mut loops {
            // The end that closes it is the start, but for the gap of an edge.
            if places.len() > 1 && near(places[0], places[places.len() - 1]) {
                places.pop();
            }
        }
        let surface = Surface::clone(surface);
        Some(Trim::new(&surface, loops).map(|trim| (surface, trim)))
    }
}
