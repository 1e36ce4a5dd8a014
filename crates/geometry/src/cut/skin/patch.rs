//! A sheet laid out as a square: its rim becomes the four sides, what is inside is as even as that allows.

use super::chart::{Chart, Kind, Laid, Maker};
use super::error::PieceSkinError;
use super::fine::Fine;
use super::harmonic::{FIXED, Harmonic};
use super::sections::{Net, Rim};

/// A part of a rim from one corner of a square to the next.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub corners: Vec<u32>,
    /// (corners), ascending: by length.
    pub at: Vec<f64>,
}

impl Line {
    /// From 0 to 1, or from 1 to 0 where it is walked `backwards`.
    fn new(fine: &Fine, mut corners: Vec<u32>, backwards: bool) -> Self {
        if backwards {
            corners.reverse();
        }
        let mut passed = vec![0.0];
        for pair in corners.windows(2) {
            let [p, q] = [pair[0], pair[1]].map(|k| fine.corners[k as usize].rest);
            passed.push(passed[passed.len() - 1] + (q - p).norm());
        }
        let last = passed.len() - 1;
        let whole = passed[last].max(1e-300);
        let mut at: Vec<f64> = passed.iter().map(|x| x / whole).collect();
        at[last] = 1.0;
        Self { corners, at }
    }

    /// The ends of the edge at a place, and the share of the way along it.
    pub fn find(&self, at: f64) -> ([u32; 2], f64) {
        let last = self.at.len() - 1;
        let k = self.at.partition_point(|t| *t <= at).clamp(1, last);
        let (a, b) = (self.at[k - 1], self.at[k]);
        let share = ((at - a) / (b - a).max(1e-300)).clamp(0.0, 1.0);
        ([self.corners[k - 1], self.corners[k]], share)
    }

    /// m.
    fn length_m(&self, fine: &Fine) -> f64 {
        let way = |pair: &[u32]| {
            let [p, q] = [pair[0], pair[1]].map(|k| fine.corners[k as usize].rest);
            (q - p).norm()
        };
        self.corners.windows(2).map(way).sum()
    }
}

/// The sides of a square: v = 0, u = 1, v = 1, u = 0, each along u or v.
pub(super) fn four_sides(fine: &Fine, rim: &Rim, places: [usize; 4]) -> [Line; 4] {
    let count = rim.corners.len();
    [0, 1, 2, 3].map(|k| {
        let (from, to) = (places[k], places[(k + 1) % 4]);
        let steps = (to + count - from) % count;
        let corners = (0..=steps).map(|step| rim.corners[(from + step) % count]);
        Line::new(fine, corners.collect(), k >= 2)
    })
}

/// Mean lengths along u and along v of a square's sides, m.
pub(super) fn lengths_m(fine: &Fine, sides: &[Line; 4]) -> [f64; 2] {
    [0, 1].map(|d| 0.5 * (sides[d].length_m(fine) + sides[d + 2].length_m(fine)))
}

/// The chart between four sides.
pub(super) fn chart(
    fine: &Fine,
    net: &Net,
    rim: &Rim,
    sides: &[Line; 4],
) -> Result<Chart, PieceSkinError> {
    let of = vec![0; fine.triangles.len()];
    let maker = Maker {
        fine,
        net,
        of: &of,
        section: 0,
        triangles: (0..fine.triangles.len() as u32).collect(),
        kind: Kind::Patch,
    };
    let harmonic = Harmonic::new(fine, net, &maker.triangles, &[&rim.corners]);
    let harmonic = harmonic.ok_or(PieceSkinError::Pinched)?;
    let lengths = lengths_m(fine, sides);
    let made = |harmonic: &Harmonic| Ok(laid(fine, net, harmonic, sides, lengths[1]));
    let (chart, _) = maker.eased(&harmonic, made(&harmonic)?, lengths[0], &made)?;
    Ok(chart)
}

fn laid(fine: &Fine, net: &Net, harmonic: &Harmonic, sides: &[Line; 4], length_m: f64) -> Chart {
    let mut places = [(); 2].map(|()| vec![0.0; fine.corners.len()]);
    for (k, side) in sides.iter().enumerate() {
        let (along, across) = (k % 2, 1 - k % 2);
        let end = if k == 1 || k == 2 { 1.0 } else { 0.0 };
        for (&corner, &at) in side.corners.iter().zip(&side.at) {
            places[along][corner as usize] = at;
            places[across][corner as usize] = end;
        }
    }
    let nothing = vec![0.0; harmonic.count];
    for place in &mut places {
        harmonic.solve(net, place, &nothing, &[]);
    }
    let place = |corner: u32| [0, 1].map(|d| places[d][corner as usize]);
    let corners = (0..fine.corners.len() as u32)
        .filter(|&corner| harmonic.unknown[corner as usize] <= FIXED)
        .map(|corner| (corner, place(corner)));
    let lay = |(t, corners): (usize, &[u32; 3])| Laid {
        triangle: t as u32,
        places: corners.map(place),
    };
    let laid = fine.triangles.iter().enumerate().map(lay);
    Chart::of(Kind::Patch, length_m, corners.collect(), laid.collect())
}
