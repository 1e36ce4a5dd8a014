//! One parametric direction of the grid: the patches seen as bundles of lines that follow each
//! other.
//!
//! ```text
//! block 0            block 1            blocks follow each other along the direction,
//! strand 0 ━━━━━━━━━ ┿ ━━━━━━━━━━━━     strands lie side by side (one for each place across);
//! strand 1 ━━━━━━━━━ ┿ ━━━━━━━━━━━━     lines: a few of each strand, samples for the choice of knots
//! ```

use super::layout::Layout;
use super::sheet::Sheet;
use palpate_geometry::basis::{Blending, KnotError, KnotVector};
use palpate_geometry::surface::{Direction, Surface};

/// Lines of a strand by which parameters and knots are chosen.
pub(super) const LINES: usize = 7;
/// Numbers of a sample of all of them.
const LINE_WIDTH: usize = 3 * LINES;

/// One patch, along one direction.
pub(super) struct Strand {
    /// Over [0, 1].
    pub knots: KnotVector,
    /// (fractions × 3 LINES): the lines where the block is sampled.
    pub samples: Vec<f64>,
    /// (3 LINES) each: derivatives of the lines by the fraction, at the first and the last sample.
    pub slopes: [Vec<f64>; 2],
}

/// Patches side by side.
pub(super) struct KnotBlock {
    /// Of the patch, from 0 to 1, rising: where it is sampled; those hidden are left out.
    pub fractions: Vec<f64>,
    /// One for each place across.
    pub strands: Vec<Strand>,
}

impl KnotBlock {
    /// The first and last fraction that shows.
    pub(super) fn shown(&self) -> (f64, f64) {
        (self.fractions[0], self.fractions[self.fractions.len() - 1])
    }
}

/// All patches along one direction.
pub(super) struct Axis {
    /// Of the merged surface.
    pub degree: usize,
    /// One after the other.
    pub blocks: Vec<KnotBlock>,
}

impl Axis {
    /// `sheets` as the layout places them; `fractions[block]` says where to sample.
    pub(super) fn new(
        sheets: &[Sheet],
        layout: &Layout,
        direction: Direction,
        degree: usize,
        fractions: &[Vec<f64>],
    ) -> Self {
        let (blocks, strands) = match direction {
            Direction::U => (layout.rows, layout.columns),
            Direction::V => (layout.columns, layout.rows),
        };
        let place = |block: usize, strand: usize| match direction {
            Direction::U => block * layout.columns + strand,
            Direction::V => strand * layout.columns + block,
        };
        let block = |b: usize| KnotBlock {
            fractions: fractions[b].clone(),
            strands: (0..strands)
                .map(|s| Strand::new(&sheets[place(b, s)], direction, &fractions[b]))
                .collect(),
        };
        Self {
            degree,
            blocks: (0..blocks).map(block).collect(),
        }
    }

    /// Mean length of the lines of a block from its first to its last sample, m.
    pub(super) fn length_m(&self, block: usize) -> f64 {
        let strands = &self.blocks[block].strands;
        let steps = |s: &Strand| -> f64 {
            s.samples
                .chunks_exact(LINE_WIDTH)
                .zip(s.samples[LINE_WIDTH..].chunks_exact(LINE_WIDTH))
                .map(|(a, b)| distance(a, b))
                .sum()
        };
        strands.iter().map(steps).sum::<f64>() / strands.len() as f64
    }

    /// Mean distance from the last samples of a block to the first of the next, m.
    pub(super) fn gap_m(&self, block: usize) -> f64 {
        let pairs = self.blocks[block]
            .strands
            .iter()
            .zip(&self.blocks[block + 1].strands);
        let gaps = pairs.map(|(a, b)| {
            distance(
                &a.samples[a.samples.len() - LINE_WIDTH..],
                &b.samples[..LINE_WIDTH],
            )
        });
        gaps.sum::<f64>() / self.blocks[block].strands.len() as f64
    }

    /// Mean speed of the lines, m for the whole patch, at the first (0) or last (1) sample of a
    /// block.
    pub(super) fn speed_m(&self, block: usize, end: usize) -> f64 {
        let strands = &self.blocks[block].strands;
        let zero = [0.0; LINE_WIDTH];
        strands
            .iter()
            .map(|s| distance(&s.slopes[end], &zero))
            .sum::<f64>()
            / strands.len() as f64
    }
}

/// Mean distance of the points of two samples.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let square = |k: usize| (a[k] - b[k]) * (a[k] - b[k]);
    (0..LINES)
        .map(|k| (square(3 * k) + square(3 * k + 1) + square(3 * k + 2)).sqrt())
        .sum::<f64>()
        / LINES as f64
}

impl Strand {
    fn new(sheet: &Sheet, direction: Direction, fractions: &[f64]) -> Self {
        if sheet.end.is_some() {
            return Self::drawn(sheet, direction, fractions);
        }
        let surface = &sheet.surface;
        let (along, across) = match direction {
            Direction::U => (surface.knots_u(), surface.knots_v()),
            Direction::V => (surface.knots_v(), surface.knots_u()),
        };
        let knots = normalised(along);
        let lines = lines(surface, direction, across);
        let blending = Blending::new(&knots, fractions);
        let samples = (0..blending.rows())
            .flat_map(|row| combine(&blending, row, 0, &lines))
            .collect();
        let slopes =
            [0, blending.rows() - 1].map(|row| combine(&blending, row, 1, &lines).to_vec());
        Self {
            knots,
            samples,
            slopes,
        }
    }
}

impl Strand {
    /// Of lines that end on a curve, point by point.
    fn drawn(sheet: &Sheet, direction: Direction, fractions: &[f64]) -> Self {
        let row = |f: f64, of: &dyn Fn([f64; 2]) -> [f64; 3]| -> Vec<f64> {
            let places = (0..LINES).map(|k| k as f64 / (LINES - 1) as f64);
            let at = |g: f64| match direction {
                Direction::U => [f, g],
                Direction::V => [g, f],
            };
            places.flat_map(|g| of(at(g))).collect()
        };
        let point = |at| sheet.point(at).coords.into();
        let slope = |at| sheet.slope(at, direction).into();
        let ends = [fractions[0], fractions[fractions.len() - 1]];
        Self {
            knots: normalised(sheet.surface.knots(direction)),
            samples: fractions.iter().flat_map(|f| row(*f, &point)).collect(),
            slopes: ends.map(|f| row(f, &slope)),
        }
    }
}

/// Control points of [`LINES`] lines along a direction, evenly across: (count along × 3 LINES).
fn lines(surface: &Surface, direction: Direction, across: &KnotVector) -> Vec<[f64; LINE_WIDTH]> {
    let places: Vec<f64> = (0..LINES)
        .map(|k| across.domain().0 + across.length() * (k as f64 / (LINES - 1) as f64))
        .collect();
    let blending = Blending::new(across, &places);
    let net = surface.net();
    let count = if direction == Direction::U {
        net.rows()
    } else {
        net.columns()
    };
    let mut lines = vec![[0.0; LINE_WIDTH]; count];
    for (i, line) in lines.iter_mut().enumerate() {
        for k in 0..LINES {
            for (j, value) in blending.entries(k, 0) {
                let point = if direction == Direction::U {
                    net.at(i, j)
                } else {
                    net.at(j, i)
                };
                (0..3).for_each(|c| line[3 * k + c] += value * point[c]);
            }
        }
    }
    lines
}

fn combine(
    blending: &Blending,
    row: usize,
    order: usize,
    lines: &[[f64; LINE_WIDTH]],
) -> [f64; LINE_WIDTH] {
    let mut sum = [0.0; LINE_WIDTH];
    for (i, value) in blending.entries(row, order) {
        sum.iter_mut()
            .zip(&lines[i])
            .for_each(|(s, x)| *s += value * x);
    }
    sum
}

/// Knots scaled to [0, 1].
///
/// # Errors
/// A span that is too short beside the length of the domain to remain a span.
pub(super) fn try_normalised(knots: &KnotVector) -> Result<KnotVector, KnotError> {
    let ((start, end), length) = (knots.domain(), knots.length());
    // Both ends come out exactly: (end − start) / length is 1.
    let share = |t: f64| {
        if t >= end {
            1.0
        } else {
            ((t - start) / length).max(0.0)
        }
    };
    KnotVector::new(
        knots.degree(),
        knots.knots().iter().map(|&t| share(t)).collect(),
    )
}

/// Knots scaled to [0, 1], of a patch that `check_nets` let pass.
pub(super) fn normalised(knots: &KnotVector) -> KnotVector {
    try_normalised(knots).expect("patches whose knots cannot be scaled are refused at the door")
}
