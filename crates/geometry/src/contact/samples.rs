//! A fixed grid of surface samples, the same number in every knot span, with their basis windows at
//! hand.

use crate::basis::{BasisWindow, KnotVector};
use crate::math::{Point3, Vector3};
use crate::surface::{Joints, Surface, wrap};

/// Samples of a surface, grouped by patch (a pair of knot spans), so that whole patches are skipped
/// by their control hull.
#[derive(Clone, Debug)]
pub struct ContactSamples {
    u: SampledDirection,
    v: SampledDirection,
    /// Of a branching surface.
    joints: Option<Box<Joints>>,
}

#[derive(Clone, Debug)]
struct SampledDirection {
    per_span: usize,
    count: usize,
    /// The last sample is followed by the first.
    wraps: bool,
    /// Where the parameter begins and ends.
    ends: (f64, f64),
    parameters: Vec<f64>,
    windows: Vec<BasisWindow>,
    /// Knots between patches of a branching surface: samples go on over them by their joints.
    gaps: Vec<f64>,
}

impl SampledDirection {
    fn new(knots: &KnotVector, per_span: usize, wraps: bool) -> Self {
        let mut parameters = Vec::new();
        for span in knots.spans() {
            let (a, b) = (knots.knots()[span], knots.knots()[span + 1]);
            // Mid-points of equal parts: no sample on a knot line, none doubled at a seam.
            parameters
                .extend((0..per_span).map(|k| a + (b - a) * (k as f64 + 0.5) / per_span as f64));
        }
        let windows = parameters.iter().map(|&u| knots.window(u)).collect();
        Self {
            per_span,
            count: knots.count(),
            wraps,
            ends: knots.domain(),
            parameters,
            windows,
            gaps: Vec::new(),
        }
    }

    fn patches(&self) -> usize {
        self.parameters.len() / self.per_span
    }

    /// The samples before and after a parameter, each with how near it is: both sum to 1, or beside
    /// an end, where there is one sample only, to less, down to 0 at the end. `None` between patches
    /// of a branching surface.
    fn beside(&self, x: f64) -> Option<[(usize, f64); 2]> {
        let after = self.parameters.partition_point(|&parameter| parameter <= x);
        let last = self.parameters.len() - 1;
        let (start, end) = self.ends;
        if after == 0 || after > last {
            if !self.gaps.is_empty() {
                return None;
            }
            let (low, high) = (self.parameters[last], self.parameters[0] + (end - start));
            let past = if after == 0 { x + (end - start) } else { x };
            if self.wraps {
                return Some(between([last, 0], (past - low) / (high - low)));
            }
            let (sample, edge) = if after == 0 { (0, start) } else { (last, end) };
            let near = (x - edge) / (self.parameters[sample] - edge);
            return Some([(sample, near), (sample, 0.0)]);
        }
        let (low, high) = (self.parameters[after - 1], self.parameters[after]);
        (!self.parted(low, high)).then(|| between([after - 1, after], (x - low) / (high - low)))
    }

    /// A gap between patches lies between two parameters.
    fn parted(&self, low: f64, high: f64) -> bool {
        self.gaps.iter().any(|&gap| gap > low && gap < high)
    }

    /// The index so many places further.
    fn further(&self, index: usize, by: isize) -> Option<usize> {
        let (count, to) = (self.parameters.len() as isize, index as isize + by);
        if self.wraps {
            return Some(to.rem_euclid(count) as usize);
        }
        let to = usize::try_from(to)
            .ok()
            .filter(|&to| to < self.parameters.len())?;
        let ends = [index.min(to), index.max(to)].map(|index| self.parameters[index]);
        (!self.parted(ends[0], ends[1])).then_some(to)
    }
}

fn between([a, b]: [usize; 2], share: f64) -> [(usize, f64); 2] {
    [(a, 1.0 - share), (b, share)]
}

/// Rational basis weights of one sample: `weights[k]` belongs to control point `controls[k]`.
#[derive(Debug, Default)]
pub struct Weights {
    /// u-major control indices.
    pub controls: Vec<u32>,
    /// Sum to one.
    pub weights: Vec<f64>,
}

impl Weights {
    /// The weights at a parameter of which the windows are at hand.
    pub fn set(&mut self, surface: &Surface, wu: &BasisWindow, wv: &BasisWindow) {
        self.controls.clear();
        self.weights.clear();
        let (rows, columns) = (surface.net().rows(), surface.net().columns());
        let mut total = 0.0;
        for (a, n) in wu.values().iter().enumerate() {
            let row = wrap(wu.first + a, rows) * columns;
            for (b, m) in wv.values().iter().enumerate() {
                let control = row + wrap(wv.first + b, columns);
                let share = n * m * surface.weights().map_or(1.0, |w| w[control]);
                total += share;
                self.controls.push(control as u32);
                self.weights.push(share);
            }
        }
        if surface.weights().is_some() {
            for weight in &mut self.weights {
                *weight /= total;
            }
        }
    }

    /// Σ weight × point.
    pub fn point(&self, net: &[Point3]) -> Point3 {
        let mut sum = Vector3::zeros();
        for (&control, &weight) in self.controls.iter().zip(&self.weights) {
            sum += net[control as usize].coords * weight;
        }
        Point3::from(sum)
    }
}

impl ContactSamples {
    /// A grid of `per_span` samples, in u and v, in every patch. On a branching surface, where directions
    /// meet, both numbers are the larger one.
    pub fn new(surface: &Surface, per_span: [usize; 2]) -> Self {
        let topology = surface.topology();
        let joints = surface.joints().map(Box::new);
        let per_span = match joints {
            Some(_) => [per_span[0].max(per_span[1]); 2],
            None => per_span,
        };
        // Of a branching surface, ends that meet are joints like others.
        let wraps = [0, 1].map(|d| joints.is_none() && topology.wraps(d));
        let mut u = SampledDirection::new(surface.knots_u(), per_span[0], wraps[0]);
        let mut v = SampledDirection::new(surface.knots_v(), per_span[1], wraps[1]);
        if let Some(joints) = &joints {
            (u.gaps, v.gaps) = (joints.breaks(0), joints.breaks(1));
        }
        Self { u, v, joints }
    }

    /// A patch that is drawn elsewhere: its samples are not asked for.
    pub fn is_duplicate(&self, patch_u: usize, patch_v: usize) -> bool {
        self.joints
            .as_ref()
            .is_some_and(|joints| joints.is_duplicate(patch_u, patch_v))
    }

    /// The four samples around a place, also over one joint, each with its bilinear weight; beside an
    /// edge or a pole, where no sample lies beyond, the weights fall from a sum of 1 to 0. `None` where
    /// more than two patches meet.
    pub fn around(&self, u: f64, v: f64) -> Option<[(usize, f64); 4]> {
        match (self.u.beside(u), self.v.beside(v)) {
            (Some(us), Some(vs)) => {
                let [a, b] = us.map(|iu| self.pair(0, iu, vs));
                Some([a[0], a[1], b[0], b[1]])
            }
            (None, Some(vs)) => self.around_joint([u, v], 0, vs),
            (Some(us), None) => self.around_joint([u, v], 1, us),
            (None, None) => None,
        }
    }

    /// Where a sample is in the grid, in u and v.
    pub fn place(&self, sample: usize) -> [usize; 2] {
        let (iu, iv) = self.split(sample);
        [iu, iv]
    }

    /// The sample so many places further in u and v; `None` beyond an end or a joint.
    pub fn further(&self, sample: usize, by: [isize; 2]) -> Option<usize> {
        let (iu, iv) = self.split(sample);
        let (iu, iv) = (self.u.further(iu, by[0])?, self.v.further(iv, by[1])?);
        Some(iu * self.v.parameters.len() + iv)
    }

    /// Two samples with one index in direction `d` and two in the other.
    fn pair(
        &self,
        d: usize,
        (index, near): (usize, f64),
        others: [(usize, f64); 2],
    ) -> [(usize, f64); 2] {
        let columns = self.v.parameters.len();
        others.map(|(other, share)| {
            let sample = if d == 0 {
                index * columns + other
            } else {
                other * columns + index
            };
            (sample, near * share)
        })
    }

    /// The four samples around a place beside an edge on which parameter `d` is held; `own` are
    /// those along it.
    fn around_joint(
        &self,
        at: [f64; 2],
        d: usize,
        own: [(usize, f64); 2],
    ) -> Option<[(usize, f64); 4]> {
        let joints = self.joints.as_ref()?;
        let patch = joints.patch_at(at);
        let (first, last) = self.ends(joints, patch, d);
        let of = |d: usize| if d == 0 { &self.u } else { &self.v };
        let upper = at[d] >= of(d).parameters[last];
        let (there, side) = joints.beyond_side(patch, 2 * d + usize::from(upper), at)?;
        let (other, held) = (joints.patch_at(there), side / 2);
        let (low, high) = self.ends(joints, other, held);
        let along = of(1 - held).beside(there[1 - held])?;
        let (sample, edge) = match upper {
            true => (last, joints.rectangle(patch)[d][1]),
            false => (first, joints.rectangle(patch)[d][0]),
        };
        // The first samples on either side are as far from the joint.
        let from = of(d).parameters[sample];
        let beyond = 0.5 * (at[d] - from) / (edge - from);
        let [a, b] = self.pair(d, (sample, 1.0 - beyond), own);
        let there = if side.is_multiple_of(2) { low } else { high };
        let [x, y] = self.pair(held, (there, beyond), along);
        Some([a, b, x, y])
    }

    /// The first and the last sample of a patch in a direction.
    fn ends(&self, joints: &Joints, patch: usize, d: usize) -> (usize, usize) {
        let [from, to] = joints.rectangle(patch)[d];
        let parameters = if d == 0 {
            &self.u.parameters
        } else {
            &self.v.parameters
        };
        (
            parameters.partition_point(|&x| x <= from),
            parameters.partition_point(|&x| x < to) - 1,
        )
    }

    /// All samples.
    pub fn len(&self) -> usize {
        self.u.parameters.len() * self.v.parameters.len()
    }

    /// True without samples; never, for a valid surface.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Parameters of a sample.
    pub fn parameter(&self, sample: usize) -> (f64, f64) {
        let (iu, iv) = self.split(sample);
        (self.u.parameters[iu], self.v.parameters[iv])
    }

    /// Windows of a sample.
    pub fn windows(&self, sample: usize) -> (&BasisWindow, &BasisWindow) {
        let (iu, iv) = self.split(sample);
        (&self.u.windows[iu], &self.v.windows[iv])
    }

    fn split(&self, sample: usize) -> (usize, usize) {
        (
            sample / self.v.parameters.len(),
            sample % self.v.parameters.len(),
        )
    }

    /// Patches in u and v.
    pub fn patches(&self) -> (usize, usize) {
        (self.u.patches(), self.v.patches())
    }

    /// Samples of a patch, ascending.
    pub fn samples_of(&self, patch_u: usize, patch_v: usize) -> impl Iterator<Item = usize> + '_ {
        let stride = self.v.parameters.len();
        let (pu, pv) = (self.u.per_span, self.v.per_span);
        (patch_u * pu..(patch_u + 1) * pu)
            .flat_map(move |iu| (patch_v * pv..(patch_v + 1) * pv).map(move |iv| iu * stride + iv))
    }

    /// Axis-aligned box of the control points that shape a patch: it holds the patch (convex hull
    /// property).
    pub fn patch_box(&self, net: &[Point3], patch_u: usize, patch_v: usize) -> (Point3, Point3) {
        let (wu, wv) = (
            &self.u.windows[patch_u * self.u.per_span],
            &self.v.windows[patch_v * self.v.per_span],
        );
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for a in 0..wu.len {
            let row = wrap(wu.first + a, self.u.count) * self.v.count;
            for b in 0..wv.len {
                let p = &net[row + wrap(wv.first + b, self.v.count)];
                for c in 0..3 {
                    low[c] = if p[c] < low[c] { p[c] } else { low[c] };
                    high[c] = if p[c] > high[c] { p[c] } else { high[c] };
                }
            }
        }
        (Point3::from(low), Point3::from(high))
    }
}

/// Squared distance of a point to a box, m².
pub fn distance_squared_to_box(point: &Point3, low: &Point3, high: &Point3) -> f64 {
    (0..3)
        .map(|c| {
            let outside = if point[c] < low[c] {
                low[c] - point[c]
            } else if point[c] > high[c] {
                point[c] - high[c]
            } else {
                0.0
            };
            outside * outside
        })
        .sum()
}
