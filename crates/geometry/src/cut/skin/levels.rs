//! Lengths across the levels of a function: how far it is from a rim to a level, in the mean.

use std::f64::consts::PI;

/// Triangles of a band, and bands at most.
const BAND: usize = 30;
const MOST_BANDS: usize = 40;

/// A triangle: its level, its area, m², and how much a metre changes the level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    pub level: f64,
    pub area: f64,
    pub slope: f64,
}

/// The way from a rim at level 0.
pub(super) struct Levels {
    /// Levels, lengths up to them, m, and lengths for each level there.
    nodes: Vec<[f64; 3]>,
    /// Of the disc about the pole, m; 0 of a ring.
    radius_m: f64,
    pub length_m: f64,
}

impl Levels {
    /// Of a disc, whose levels rise without end towards its pole, or of a ring that ends at level 1.
    pub fn new(mut strips: Vec<Strip>, disc: bool) -> Self {
        strips.sort_by(|a, b| a.level.total_cmp(&b.level));
        let count = (strips.len() / BAND).clamp(3, MOST_BANDS);
        let whole: f64 = strips.iter().map(|s| s.area).sum();
        let mut bands = vec![(0.0, 0.0); count];
        let mut ends = vec![0.0; count + 1];
        let mut passed = 0.0;
        for strip in &strips {
            let band = ((passed / whole * count as f64) as usize).min(count - 1);
            bands[band].0 += strip.area;
            bands[band].1 += strip.area * strip.slope;
            // Where it ends is where its last strip is.
            ends[band + 1] = strip.level;
            passed += strip.area;
        }
        if !disc {
            ends[count] = 1.0;
        }
        let inner = usize::from(disc);
        let radius_m = inner as f64 * libm::sqrt((whole / count as f64) / PI);
        let mut slopes: Vec<f64> = (bands.iter())
            .map(|(area, sum)| (area / sum.max(1e-300)).clamp(1e-300, 1e300))
            .collect();
        smooth(&mut slopes);
        let mut nodes = vec![[0.0, 0.0, slopes[0]]];
        for k in 0..count - inner {
            let [level, length, _] = nodes[nodes.len() - 1];
            let end = ends[k + 1].max(level + 1e-9);
            let next = slopes.get(k + 1).copied().unwrap_or(slopes[k]);
            let slope = 2.0 * slopes[k] * next / (slopes[k] + next);
            nodes.push([end, length + slopes[k] * (end - level), slope]);
        }
        let length_m = nodes[nodes.len() - 1][1] + radius_m;
        Self {
            nodes,
            radius_m,
            length_m,
        }
    }

    /// Share of the length, 0 at the rim.
    pub fn share(&self, level: f64) -> f64 {
        let last = self.nodes[self.nodes.len() - 1];
        let length = if level <= 0.0 {
            0.0
        } else if level >= last[0] {
            // As on a plane about its origin.
            let decay = last[2] / self.radius_m.max(1e-300);
            last[1] + self.radius_m * (1.0 - libm::exp(-decay * (level - last[0])))
        } else {
            let k = self.nodes.partition_point(|node| node[0] <= level);
            hermite(&self.nodes[k - 1], &self.nodes[k], level)
        };
        (length / self.length_m).clamp(0.0, 1.0)
    }
}

/// Means of neighbours, as logarithms: slopes differ by orders.
fn smooth(slopes: &mut [f64]) {
    for _ in 0..2 {
        let logs: Vec<f64> = slopes.iter().map(|s| libm::log(*s)).collect();
        let at = |k: usize| logs[k.min(logs.len() - 1)];
        for (k, slope) in slopes.iter_mut().enumerate() {
            let mean = 0.25 * at(k.saturating_sub(1)) + 0.5 * at(k) + 0.25 * at(k + 1);
            *slope = libm::exp(mean);
        }
    }
}

/// The cubic with these ends and slopes, which are no steeper than keeps it rising.
fn hermite(a: &[f64; 3], b: &[f64; 3], level: f64) -> f64 {
    let (width, rise) = (b[0] - a[0], b[1] - a[1]);
    let t = (level - a[0]) / width;
    let steepest = 3.0 * rise;
    let [p, q] = [a[2], b[2]].map(|slope| (slope * width).min(steepest));
    let (s, tt) = (1.0 - t, t * t);
    a[1] + rise * tt * (3.0 - 2.0 * t) + p * t * s * s - q * tt * s
}
