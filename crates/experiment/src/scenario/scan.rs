//! Palpation: taps over a grid, the stiffness that each meets, and the places that are stiffer than
//! what is around them.

use palpate_geometry::math::Point3;
use palpate_sim::tick::record::ToolOutput;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// `scan = { low = [x, y], high = [x, y], counts = [11, 11], clear_z = …, … }`: taps along −z.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScanSpec {
    /// First place of the grid, m.
    pub low: [f64; 2],
    /// Last, m.
    pub high: [f64; 2],
    /// Places in x and y, each 3 or more.
    pub counts: [usize; 2],
    /// Where the tool goes from place to place, m.
    pub clear_z: f64,
    /// How deep it goes, m.
    pub press_z: f64,
    /// Of one tap, s: a tenth over, three tenths down, three tenths held, three tenths up.
    pub period_s: f64,
}

/// Stiffness over a grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StiffnessMap {
    /// First and last place, m.
    pub low: [f64; 2],
    /// Last place, m.
    pub high: [f64; 2],
    /// Places in x and y.
    pub counts: [usize; 2],
    /// (x, y), x slowest: force over depth, N/mm; 0 where nothing was touched.
    pub n_per_mm: Vec<f64>,
}

/// A place that is stiffer than its surroundings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// m.
    pub place: [f64; 2],
    /// N/mm.
    pub n_per_mm: f64,
}

/// A scan at work.
pub struct Scanner {
    spec: ScanSpec,
    map: StiffnessMap,
    /// The tap that is under way, and how high the tool was when it first met a force in it, m.
    tap: usize,
    touched_z: Option<f64>,
}

impl Scanner {
    pub fn new(spec: &ScanSpec) -> Result<Self, String> {
        let finite = [spec.clear_z, spec.press_z, spec.period_s]
            .iter()
            .chain(&spec.low)
            .chain(&spec.high)
            .all(|x| x.is_finite());
        let sound = finite && spec.counts.iter().all(|n| (3..=1_000).contains(n));
        if !(sound && spec.period_s > 0.0 && spec.clear_z > spec.press_z) {
            return Err(
                "a scan needs finite places, 3 to 1000 of them each way, and clear_z above press_z"
                    .into(),
            );
        }
        let [nx, ny] = spec.counts;
        Ok(Self {
            map: StiffnessMap {
                low: spec.low,
                high: spec.high,
                counts: spec.counts,
                n_per_mm: vec![0.0; nx * ny],
            },
            spec: spec.clone(),
            tap: 0,
            touched_z: None,
        })
    }

    /// Where the tool is at a time, s; what it got in the tick before is noted at the end of the
    /// hold of each tap.
    pub fn place(&mut self, time_s: f64, last: &ToolOutput) -> Point3 {
        let spec = &self.spec;
        let taps = self.map.n_per_mm.len();
        let tap = ((time_s / spec.period_s) as usize).min(taps - 1);
        let share = (time_s - tap as f64 * spec.period_s) / spec.period_s;
        let here = self.map.place(tap);
        let before = self.map.place(tap.max(1) - 1);
        let over = smooth(share / 0.1);
        let down = smooth((share - 0.1) / 0.3) - smooth((share - 0.7) / 0.3);
        if tap != self.tap {
            (self.tap, self.touched_z) = (tap, None);
        }
        let z = last.proxy_position.z;
        if last.contact_count > 0 {
            let depth_m = *self.touched_z.get_or_insert(z) - z;
            if (0.4..0.7).contains(&share) && depth_m > 0.0 {
                self.map.n_per_mm[tap] = last.contact_force_n.z / (depth_m * 1e3);
            }
        }
        Point3::new(
            before[0] + (here[0] - before[0]) * over,
            before[1] + (here[1] - before[1]) * over,
            spec.clear_z + (spec.press_z - spec.clear_z) * down,
        )
    }

    /// s of all taps.
    pub fn length_s(&self) -> f64 {
        self.spec.period_s * self.map.n_per_mm.len() as f64
    }

    pub fn map(&self) -> &StiffnessMap {
        &self.map
    }
}

/// From 0 to 1 with the least jerk, constant outside.
fn smooth(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

/// A place is a peak when it is stiffer than the median by so much of it: between what a block does
/// without nodules (0.12 in its middle) and what the deeper of two does (0.8).
const STIFFER: f64 = 0.3;

impl StiffnessMap {
    fn place(&self, k: usize) -> [f64; 2] {
        let at = |c: usize, k: usize| {
            self.low[c] + (self.high[c] - self.low[c]) * k as f64 / (self.counts[c] - 1) as f64
        };
        // To and fro, so that no way is long.
        let (i, j) = (k / self.counts[1], k % self.counts[1]);
        let j = if i.is_multiple_of(2) {
            j
        } else {
            self.counts[1] - 1 - j
        };
        [at(0, i), at(1, j)]
    }

    /// Stiffness at row i (x) and column j (y).
    pub fn at(&self, i: usize, j: usize) -> f64 {
        let k = if i.is_multiple_of(2) {
            j
        } else {
            self.counts[1] - 1 - j
        };
        self.n_per_mm[i * self.counts[1] + k]
    }

    /// Places that are stiffer than the median of the map and than all eight around them, stiffest
    /// first, each between the grid's places by the parabola through its neighbours.
    pub fn peaks(&self) -> Vec<Peak> {
        let [nx, ny] = self.counts;
        let mut sorted = self.n_per_mm.clone();
        sorted.sort_by(f64::total_cmp);
        let least = (1.0 + STIFFER) * sorted[sorted.len() / 2];
        let mut peaks = Vec::new();
        for i in 1..nx - 1 {
            for j in 1..ny - 1 {
                let here = self.at(i, j);
                let mut around = (0..9)
                    .filter(|k| *k != 4)
                    .map(|k| self.at(i + k / 3 - 1, j + k % 3 - 1));
                if here < least || !around.all(|other| other < here) {
                    continue;
                }
                let vertex = |before: f64, after: f64| {
                    0.5 * (before - after) / (before - 2.0 * here + after)
                };
                let (du, dv) = (
                    vertex(self.at(i - 1, j), self.at(i + 1, j)),
                    vertex(self.at(i, j - 1), self.at(i, j + 1)),
                );
                let step = |c: usize| (self.high[c] - self.low[c]) / (self.counts[c] - 1) as f64;
                let place = [
                    self.low[0] + step(0) * (i as f64 + du),
                    self.low[1] + step(1) * (j as f64 + dv),
                ];
                peaks.push(Peak {
                    place,
                    n_per_mm: here,
                });
            }
        }
        peaks.sort_by(|a, b| b.n_per_mm.total_cmp(&a.n_per_mm));
        peaks
    }
}

/// A map as an SVG picture: a square a place, dark where it is stiff; rings where `peaks` are,
/// crosses at the places in `truth`.
pub fn picture(map: &StiffnessMap, truth: &[[f64; 2]]) -> String {
    const SIDE: f64 = 480.0;
    let [nx, ny] = map.counts;
    let (least, most) = map
        .n_per_mm
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
    let range = |c: usize| (map.high[c] - map.low[c]) / (map.counts[c] - 1) as f64;
    let cell = [SIDE / nx as f64, SIDE / ny as f64];
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 540\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"640\" height=\"540\" fill=\"white\"/>\n",
    );
    let shade = |value: f64| {
        let s = ((value - least) / (most - least).max(1e-12)).clamp(0.0, 1.0);
        let mix = |from: f64, to: f64| (from + (to - from) * s).round() as u8;
        format!(
            "rgb({},{},{})",
            mix(247.0, 127.0),
            mix(244.0, 0.0),
            mix(238.0, 30.0)
        )
    };
    for i in 0..nx {
        for j in 0..ny {
            let _ = writeln!(
                svg,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{}\"><title>{:.4} N/mm</title></rect>",
                20.0 + i as f64 * cell[0],
                20.0 + (ny - 1 - j) as f64 * cell[1],
                cell[0] + 0.3,
                cell[1] + 0.3,
                shade(map.at(i, j)),
                map.at(i, j)
            );
        }
    }
    let on_page = |place: [f64; 2]| {
        let along = |c: usize| (place[c] - map.low[c]) / range(c) + 0.5;
        (20.0 + along(0) * cell[0], 20.0 + SIDE - along(1) * cell[1])
    };
    for &place in truth {
        let (x, y) = on_page(place);
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {y:.1}h16M{x:.1} {:.1}v16\" stroke=\"black\" stroke-width=\"2\"/>",
            x - 8.0,
            y - 8.0
        );
    }
    for peak in map.peaks() {
        let (x, y) = on_page(peak.place);
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"14\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"3\"/>"
        );
    }
    for k in 0..=20 {
        let s = f64::from(k) / 20.0;
        let y = 20.0 + (1.0 - s) * (SIDE - 24.0);
        let _ = writeln!(
            svg,
            "<rect x=\"520\" y=\"{y:.1}\" width=\"24\" height=\"24\" fill=\"{}\"/>",
            shade(least + (most - least) * s)
        );
    }
    for (value, y) in [(most, 34.0), (least, 20.0 + SIDE - 4.0)] {
        let _ = writeln!(svg, "<text x=\"550\" y=\"{y}\">{value:.3} N/mm</text>");
    }
    let _ = writeln!(
        svg,
        "<text x=\"20\" y=\"526\">{:.0} mm × {:.0} mm, {nx} × {ny} taps; cross: a nodule, ring: found by touch</text>\n</svg>",
        (map.high[0] - map.low[0]) * 1e3,
        (map.high[1] - map.low[1]) * 1e3
    );
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    // Two bumps between the places of the grid, one of them a third as high.
    #[test]
    fn peaks_are_found_between_the_places_of_a_grid() {
        let truth = [[0.0113, -0.0087], [-0.0121, 0.0104]];
        let mut map = StiffnessMap {
            low: [-0.02; 2],
            high: [0.02; 2],
            counts: [13, 11],
            n_per_mm: vec![0.0; 143],
        };
        for k in 0..143 {
            let place = map.place(k);
            let bump = |at: [f64; 2], height: f64| {
                let r = [(place[0] - at[0]) / 0.006, (place[1] - at[1]) / 0.006];
                height * libm::exp(-0.5 * (r[0] * r[0] + r[1] * r[1]))
            };
            map.n_per_mm[k] = 0.1 + bump(truth[0], 0.3) + bump(truth[1], 0.1) + 1e-3 * place[0];
        }
        let peaks = map.peaks();
        assert_eq!(peaks.len(), 2);
        for (peak, truth) in peaks.iter().zip(truth) {
            let off = libm::hypot(peak.place[0] - truth[0], peak.place[1] - truth[1]);
            assert!(off < 5e-4, "{peak:?} is {off} m off");
        }
        let svg = picture(&map, &truth);
        assert_eq!(
            (
                svg.matches("<circle").count(),
                svg.matches("<title>").count()
            ),
            (2, 143)
        );
        map.n_per_mm.fill(0.2);
        assert_eq!(map.peaks(), []);
    }
}
