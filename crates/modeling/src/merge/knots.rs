//! Knots of the merged surface: those of the patches end to end, the seam, and what the seam gives
//! up.
//!
//! Of the k knots that a seam has for C⁰, C^c keeps k − c. The other c are not lost: they become
//! simple knots beside it (the source's step 5 puts each half way to its neighbour), so every
//! continuity has the same number of control points.

use super::axis::Axis;
use palpate_geometry::basis::{KnotError, KnotVector};

/// Where the blocks lie on the merged parameter: (blocks) of [start, end], rising, from 0 to 1.
pub(super) type Intervals = Vec<[f64; 2]>;

/// Interior knots of a line of patches, as fractions of each block: (blocks).
pub(super) type Interiors = Vec<Vec<f64>>;

/// Knots of one direction and which of them may be moved: all but ends and seams.
#[derive(Clone, Debug)]
pub(super) struct Knots {
    pub degree: usize,
    /// (count + degree + 1), rising.
    pub values: Vec<f64>,
    /// Where patches meet.
    pub seams: Vec<f64>,
}

impl Knots {
    /// Patches end to end. `blend` is how far the farthest knot given up by a seam lies from it, as
    /// a share of the way to the next; the others lie evenly between.
    pub(super) fn joined(
        degree: usize,
        continuity: usize,
        interiors: &Interiors,
        at: &Intervals,
        blend: f64,
    ) -> Self {
        let seams: Vec<f64> = at.windows(2).map(|w| 0.5 * (w[0][1] + w[1][0])).collect();
        let mut values: Vec<f64> = Vec::new();
        for (inner, [start, end]) in interiors.iter().zip(at) {
            values.extend(inner.iter().map(|f| start + f * (end - start)));
        }
        let marks: Vec<f64> = values.iter().chain(&seams).copied().collect();
        for &seam in &seams {
            values.extend(std::iter::repeat_n(seam, degree - continuity));
            let left = marks
                .iter()
                .copied()
                .filter(|&t| t < seam)
                .fold(0.0, f64::max);
            let right = marks
                .iter()
                .copied()
                .filter(|&t| t > seam)
                .fold(1.0, f64::min);
            let before = continuity.div_ceil(2);
            for (neighbour, n) in [(left, before), (right, continuity - before)] {
                values.extend(
                    (1..=n).map(|j| seam + (neighbour - seam) * blend * (j as f64 / n as f64)),
                );
            }
        }
        values.sort_by(f64::total_cmp);
        Self {
            degree,
            values: clamped(degree, values),
            seams,
        }
    }

    /// The source's place of a knot given up: evenly between the seam and its neighbour.
    pub(super) fn seed_blend(continuity: usize) -> f64 {
        let n = continuity.div_ceil(2) as f64;
        n / (n + 1.0)
    }

    /// As a checked vector.
    pub(super) fn vector(&self) -> Result<KnotVector, KnotError> {
        KnotVector::new(self.degree, self.values.clone())
    }

    /// Indices of the knots that may be moved.
    pub(super) fn movable(&self) -> impl Iterator<Item = usize> + '_ {
        (self.degree + 1..self.values.len() - self.degree - 1)
            .filter(|&k| !self.seams.contains(&self.values[k]))
    }

    /// The shortest span that touches a seam.
    pub(super) fn least_span_at_seams(&self) -> f64 {
        let beside = |seam: f64| {
            let spans = self.values.iter().map(move |t| (t - seam).abs());
            spans
                .filter(|&span| span > 0.0)
                .fold(f64::INFINITY, f64::min)
        };
        self.seams
            .iter()
            .map(|&seam| beside(seam))
            .fold(f64::INFINITY, f64::min)
    }

    /// One knot more; the number of control points grows by one.
    pub(super) fn insert(&mut self, knot: f64) {
        let at = self.values.partition_point(|&t| t <= knot);
        self.values.insert(at, knot);
    }
}

fn clamped(degree: usize, interior: Vec<f64>) -> Vec<f64> {
    let mut values = vec![0.0; degree + 1];
    values.extend(interior);
    values.extend(std::iter::repeat_n(1.0, degree + 1));
    values
}

/// Interior knots of the strand that has most along all blocks together, and how many each block
/// has: the source's r is the larger of the sums. Where sums are equal the knots are averaged if
/// their numbers agree block by block, as the source does across the seam; if not they come from
/// the first.
pub(super) fn interiors(axis: &Axis) -> Interiors {
    let strands = axis.blocks[0].strands.len();
    let of = |s: usize| -> Interiors {
        axis.blocks
            .iter()
            .map(|block| inner(&block.strands[s].knots, axis.degree))
            .collect()
    };
    let all: Vec<Interiors> = (0..strands).map(of).collect();
    let total = |one: &Interiors| one.iter().map(Vec::len).sum::<usize>();
    let most = all.iter().map(total).max().unwrap_or(0);
    let counts = |one: &Interiors| one.iter().map(Vec::len).collect::<Vec<_>>();
    let longest = all
        .iter()
        .find(|one| total(one) == most)
        .expect("there is a strand");
    if all.iter().all(|one| counts(one) == counts(longest)) {
        return averaged(&all);
    }
    if axis.blocks.len() == 1 {
        // Unequal numbers: uniform, as the source says.
        return vec![(1..=most).map(|k| k as f64 / (most + 1) as f64).collect()];
    }
    longest.clone()
}

fn averaged(all: &[Interiors]) -> Interiors {
    let mut mean = all[0].clone();
    for (b, block) in mean.iter_mut().enumerate() {
        for (k, value) in block.iter_mut().enumerate() {
            *value = all.iter().map(|one| one[b][k]).sum::<f64>() / all.len() as f64;
        }
    }
    mean
}

/// Knots inside [0, 1], none more often than the merged degree.
pub(super) fn inner(knots: &KnotVector, degree: usize) -> Vec<f64> {
    let mut inner: Vec<f64> = Vec::new();
    for &t in knots.knots().iter().filter(|&&t| t > 0.0 && t < 1.0) {
        let times = inner.iter().rev().take_while(|&&x| x == t).count();
        if times < degree {
            inner.push(t);
        }
    }
    inner
}

#[cfg(test)]
mod tests {
    use super::*;

    // The source's own example (section 4.3.3), which prints four digits.
    #[test]
    fn knots_end_to_end_are_those_of_the_source() {
        let interiors = vec![
            vec![0.2138, 0.4959, 0.7262],
            vec![0.1215, 0.2512, 0.3689, 0.5047, 0.7283, 0.8631],
        ];
        let at = vec![[0.0, 0.5], [0.5, 1.0]];
        let c2 = Knots::joined(3, 2, &interiors, &at, Knots::seed_blend(2));
        let wanted = [
            0.0, 0.0, 0.0, 0.0, 0.1069, 0.2480, 0.3631, 0.4315, 0.5, 0.5304, 0.5608, 0.6256,
            0.6845, 0.7524, 0.8642, 0.9316, 1.0, 1.0, 1.0, 1.0,
        ];
        assert_eq!(c2.values.len(), wanted.len());
        for (got, wanted) in c2.values.iter().zip(wanted) {
            assert!((got - wanted).abs() < 6e-5, "{got} {wanted}");
        }
        let c0 = Knots::joined(3, 0, &interiors, &at, Knots::seed_blend(0));
        assert_eq!(c0.values.iter().filter(|&&t| t == 0.5).count(), 3);
        assert_eq!(c0.values.len(), c2.values.len());
        // r = r1 + r2 − 1 with r1 = 7, r2 = 10.
        assert_eq!(c0.vector().unwrap().count(), 16);
    }
}
