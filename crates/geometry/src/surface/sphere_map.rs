//! Longitude and latitude on a closed shell without handles.
//!
//! A shell that is seen whole from its middle is projected from there. Of others, conformalised mean
//! curvature flow (Kazhdan, Solomon & Ben-Chen, *Can mean-curvature flow be
//! modified to be non-singular?*, 2012) carries the shell to a sphere: `(M_t + δ L₀) x' = M_t x`, L₀ the
//! cotangent Laplacian of the given shell, M_t the areas of the current one. The map keeps angles,
//! so that circles round a pole stay nearly circles. Stereographic projection and one Möbius
//! transformation bring the two ends of the longest axis to 0 and ∞: then u is the angle, and the
//! logarithm of the radius grows evenly along a tube. v is that logarithm, with equal steps for
//! equal lengths on the shell.

use super::shell::Shell;
use crate::math::{Point3, Vector3, rotation_onto};

/// Steps of the flow at most; a ball with bumps needs 10, a long tube 60.
const MOST_STEPS: usize = 150;

/// Radii on the sphere that agree to this, relatively, end the flow.
const ROUND: f64 = 2e-3;

/// Cotangents beyond this are of slivers, and would only slow the solver.
const MOST_COTANGENT: f64 = 20.0;

/// The least weight of an edge, so that none folds over for an obtuse angle.
const LEAST_WEIGHT: f64 = 1e-2;

/// Latitude bands over which lengths are counted.
const BANDS: usize = 400;

/// Places on the area for each band, and bands to either side over which lengths are averaged.
const PLACES: usize = 200;
const BESIDE: usize = 6;

/// Part of the extent, from an end, whose middle is the pole: a flat end has its pole in the middle.
const END: f64 = 0.02;

/// A shell's places on the sphere: for each corner a point of the unit sphere, poles at ±z.
pub(super) struct SphereMap {
    /// (corners)
    places: Vec<Vector3>,
    /// (BANDS + 1) v at equal steps of the logarithm from its `low` to its `high`.
    latitudes: Vec<f64>,
    low: f64,
    high: f64,
}

impl SphereMap {
    /// Of a closed shell of one part without handles, poles at its ends along `axis`.
    pub fn new(shell: &Shell, axis: &Vector3) -> Self {
        let sphere = seen_from_the_middle(shell).unwrap_or_else(|| flow(shell));
        let places = between_poles(&sphere, end(shell, &-axis), end(shell, axis));
        let mut map = Self {
            places,
            latitudes: Vec::new(),
            low: 0.0,
            high: 0.0,
        };
        map.spread(shell);
        map
    }

    /// u and v, each in 0 … 1, of a place in a triangle with these corners.
    pub fn parameters(&self, corners: [u32; 3], weights: [f64; 3]) -> (f64, f64) {
        let place: Vector3 = (0..3)
            .map(|k| self.places[corners[k] as usize] * weights[k])
            .sum();
        let turn = libm::atan2(place.y, place.x) / std::f64::consts::TAU;
        let u = if turn < 0.0 { turn + 1.0 } else { turn };
        (u.min(1.0), self.latitude(logarithm(&place)))
    }

    fn latitude(&self, logarithm: f64) -> f64 {
        let place = (logarithm - self.low) / (self.high - self.low) * BANDS as f64;
        if place <= 0.0 {
            // Below the first band radii on the shell are as those on the plane.
            return self.latitudes[0] * libm::exp(logarithm - self.low);
        }
        if place >= BANDS as f64 {
            return 1.0 - (1.0 - self.latitudes[BANDS]) * libm::exp(self.high - logarithm);
        }
        let (k, rest) = (place as usize, place.fract());
        self.latitudes[k] + (self.latitudes[k + 1] - self.latitudes[k]) * rest
    }

    /// Sets v: a band of the logarithm `dt` wide with area `dA` has length √(dA dt / 2π), since lengths
    /// along and around are equal where angles are kept.
    fn spread(&mut self, shell: &Shell) {
        let areas = shell.areas();
        let whole: f64 = areas.iter().sum();
        let mut parts: Vec<(f64, f64)> = shell
            .places(PLACES * BANDS)
            .into_iter()
            .map(|(triangle, weights)| {
                let corners = shell.triangles()[triangle];
                let place: Vector3 = (0..3)
                    .map(|k| self.places[corners[k] as usize] * weights[k])
                    .sum();
                (logarithm(&place), whole / (PLACES * BANDS) as f64)
            })
            .collect();
        parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        // The caps beyond are left to the rule of the plane.
        let cap = parts.len() / 1_000;
        self.low = parts[cap].0;
        self.high = parts[parts.len() - 1 - cap].0;
        let width = ((self.high - self.low) / BANDS as f64).max(f64::MIN_POSITIVE);
        let mut bands = vec![0.0; BANDS];
        for (logarithm, area) in &parts {
            let band = ((logarithm - self.low) / width) as usize;
            if *logarithm >= self.low && band < BANDS {
                bands[band] += area;
            }
        }
        let smooth = |k: usize| {
            let (from, to) = (k.saturating_sub(BESIDE), (k + BESIDE + 1).min(BANDS));
            bands[from..to].iter().sum::<f64>() / (to - from) as f64
        };
        let lengths: Vec<f64> = (0..BANDS)
            .map(|k| libm::sqrt((smooth(k) * width).max(1e-12 * whole) / std::f64::consts::TAU))
            .collect();
        // A cap of area A has radius √(A / π).
        let radius =
            libm::sqrt(cap.max(1) as f64 / parts.len() as f64 * whole / std::f64::consts::PI);
        let total = 2.0 * radius + lengths.iter().sum::<f64>();
        let mut passed = radius;
        self.latitudes = vec![passed / total];
        for length in lengths {
            passed += length;
            self.latitudes.push(passed / total);
        }
    }
}

/// The corner in the middle of what lies furthest along an axis.
fn end(shell: &Shell, axis: &Vector3) -> usize {
    let along = |p: &Point3| p.coords.dot(axis);
    let (low, high) = shell
        .points()
        .iter()
        .map(along)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(x), h.max(x))
        });
    let far = high - END * (high - low);
    let (mut weight, mut first) = (0.0, Vector3::zeros());
    for (t, area) in shell.areas().into_iter().enumerate() {
        let [a, b, c] = shell.corners(t);
        if [a, b, c].iter().all(|p| along(p) >= far) {
            weight += area;
            first += (a.coords + b.coords + c.coords) * (area / 3.0);
        }
    }
    let distance = |k: &usize| match weight > 0.0 {
        true => (shell.points()[*k].coords - first / weight).norm(),
        false => high - along(&shell.points()[*k]),
    };
    let corners = 0..shell.points().len();
    corners
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0)
}

/// Directions from the middle of the area, if every triangle faces away from it.
fn seen_from_the_middle(shell: &Shell) -> Option<Vec<Vector3>> {
    let mut places: Vec<Vector3> = shell.points().iter().map(|p| p.coords).collect();
    to_unit_area(&mut places, shell);
    let volume = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| places[k as usize]);
        let normal = (b - a).cross(&(c - a));
        (a + b + c).dot(&normal) / normal.norm().max(1e-300)
    };
    let outward = shell.triangles().iter().map(volume).sum::<f64>() > 0.0;
    // Triangles seen at less than 6° would crowd.
    let least = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| places[k as usize]);
        let seen = volume(t) / (a + b + c).norm().max(1e-300);
        if outward { seen > 0.1 } else { seen < -0.1 }
    };
    shell.triangles().iter().all(least).then(|| {
        places
            .iter()
            .map(|p| p.try_normalize(1e-300).unwrap_or_else(Vector3::z))
            .collect()
    })
}

/// ln |z| of the stereographic projection from the north pole; −∞ is the south pole.
fn logarithm(place: &Vector3) -> f64 {
    let length = place.norm().max(f64::MIN_POSITIVE);
    let height = (place.z / length).clamp(-1.0 + 1e-15, 1.0 - 1e-15);
    0.5 * libm::log((1.0 + height) / (1.0 - height))
}

/// The flow's end, on the unit sphere.
fn flow(shell: &Shell) -> Vec<Vector3> {
    let laplacian = Laplacian::new(shell);
    let mut places: Vec<Vector3> = shell.points().iter().map(|p| p.coords).collect();
    to_unit_area(&mut places, shell);
    let (mut step, mut masses) = (1e-3, vec![0.0; places.len()]);
    for _ in 0..MOST_STEPS {
        set_masses(&mut masses, &places, shell);
        laplacian.advance(&mut places, &masses, step);
        to_unit_area(&mut places, shell);
        let radii = places.iter().map(|p| p.norm());
        let (least, most) = radii.fold((f64::INFINITY, 0.0_f64), |(l, m), r| (l.min(r), m.max(r)));
        if most - least < ROUND * most {
            break;
        }
        step = (1.3 * step).min(0.1);
    }
    for place in &mut places {
        *place = place.try_normalize(1e-300).unwrap_or_else(Vector3::z);
    }
    places
}

/// About the middle of the area, scaled to area 1.
fn to_unit_area(places: &mut [Vector3], shell: &Shell) {
    let (mut area, mut first) = (0.0, Vector3::zeros());
    for t in shell.triangles() {
        let [a, b, c] = t.map(|k| places[k as usize]);
        let part = 0.5 * (b - a).cross(&(c - a)).norm();
        area += part;
        first += (a + b + c) * (part / 3.0);
    }
    if area > 0.0 {
        let (middle, scale) = (first / area, 1.0 / libm::sqrt(area));
        places.iter_mut().for_each(|p| *p = (*p - middle) * scale);
    }
}

/// A third of the area round each corner.
fn set_masses(masses: &mut [f64], places: &[Vector3], shell: &Shell) {
    masses.fill(1e-9 / places.len() as f64);
    for t in shell.triangles() {
        let [a, b, c] = t.map(|k| places[k as usize]);
        let part = (b - a).cross(&(c - a)).norm() / 6.0;
        t.iter().for_each(|&k| masses[k as usize] += part);
    }
}

/// Cotangent weights in compressed rows.
struct Laplacian {
    /// (corners + 1)
    starts: Vec<usize>,
    neighbours: Vec<u32>,
    weights: Vec<f64>,
    /// Sum of the weights of a row.
    diagonal: Vec<f64>,
}

impl Laplacian {
    fn new(shell: &Shell) -> Self {
        let count = shell.points().len();
        let mut entries: Vec<(u32, u32, f64)> = Vec::with_capacity(6 * shell.triangles().len());
        for &[a, b, c] in shell.triangles() {
            for (from, to, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
                let [p, q, r] = [from, to, opposite].map(|k| shell.points()[k as usize]);
                let (x, y) = (p - r, q - r);
                let twice_area = x.cross(&y).norm();
                let cotangent = x.dot(&y) / twice_area.max(1e-300);
                let weight = 0.5 * cotangent.clamp(-MOST_COTANGENT, MOST_COTANGENT);
                entries.push((from, to, weight));
                entries.push((to, from, weight));
            }
        }
        entries.sort_by_key(|entry| (entry.0, entry.1));
        let mut laplacian = Self {
            starts: vec![0; count + 1],
            neighbours: Vec::new(),
            weights: Vec::new(),
            diagonal: vec![0.0; count],
        };
        let mut rows = entries.chunk_by(|a, b| a.0 == b.0 && a.1 == b.1).peekable();
        for corner in 0..count {
            while let Some(edge) = rows.next_if(|edge| edge[0].0 as usize == corner) {
                let weight = edge.iter().map(|e| e.2).sum::<f64>().max(LEAST_WEIGHT);
                laplacian.neighbours.push(edge[0].1);
                laplacian.weights.push(weight);
                laplacian.diagonal[corner] += weight;
            }
            laplacian.starts[corner + 1] = laplacian.neighbours.len();
        }
        laplacian
    }

    /// out = (M + δ L) x.
    fn apply(&self, masses: &[f64], step: f64, x: &[Vector3], out: &mut [Vector3]) {
        for k in 0..x.len() {
            let mut sum = x[k] * self.diagonal[k];
            for e in self.starts[k]..self.starts[k + 1] {
                sum -= x[self.neighbours[e] as usize] * self.weights[e];
            }
            out[k] = x[k] * masses[k] + sum * step;
        }
    }

    /// One step of the flow: conjugate gradients with the diagonal as preconditioner, from the last
    /// places.
    fn advance(&self, x: &mut [Vector3], masses: &[f64], step: f64) {
        let dot =
            |a: &[Vector3], b: &[Vector3]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
        let right: Vec<Vector3> = x.iter().zip(masses).map(|(x, m)| x * *m).collect();
        let mut product = vec![Vector3::zeros(); x.len()];
        self.apply(masses, step, x, &mut product);
        let mut rest: Vec<Vector3> = right.iter().zip(&product).map(|(b, p)| b - p).collect();
        let eased = |rest: &[Vector3]| -> Vec<Vector3> {
            (0..rest.len())
                .map(|k| rest[k] / (masses[k] + step * self.diagonal[k]))
                .collect()
        };
        let mut z = eased(&rest);
        let mut way = z.clone();
        let mut gain = dot(&rest, &z);
        let enough = 1e-12 * dot(&right, &eased(&right));
        for _ in 0..400 {
            if gain <= enough {
                break;
            }
            self.apply(masses, step, &way, &mut product);
            let length = gain / dot(&way, &product);
            for k in 0..x.len() {
                x[k] += way[k] * length;
                rest[k] -= product[k] * length;
            }
            z = eased(&rest);
            let next = dot(&rest, &z);
            let share = next / gain;
            way.iter_mut()
                .zip(&z)
                .for_each(|(w, z)| *w = z + *w * share);
            gain = next;
        }
    }
}

/// The sphere turned until `south` is at −z, then, in the plane of the stereographic projection from
/// `north`, moved and back: `north` comes to +z, angles are kept.
fn between_poles(sphere: &[Vector3], south: usize, north: usize) -> Vec<Vector3> {
    let turn = rotation_onto(&sphere[north], &Vector3::z());
    let turned: Vec<Vector3> = sphere.iter().map(|p| turn * p).collect();
    let plane = |p: &Vector3| {
        let down = (1.0 - p.z).max(1e-14);
        (p.x / down, p.y / down)
    };
    let (x0, y0) = plane(&turned[south]);
    turned
        .iter()
        .map(|p| {
            let (x, y) = plane(p);
            let (x, y) = (x - x0, y - y0);
            let square = x * x + y * y;
            Vector3::new(2.0 * x, 2.0 * y, square - 1.0) / (square + 1.0)
        })
        .collect()
}

/// The direction of the longest extent of a shell's area, by its second moments.
pub(super) fn longest_axis(shell: &Shell) -> Vector3 {
    let areas = shell.areas();
    let middles: Vec<Point3> = (0..areas.len())
        .map(|t| {
            let [a, b, c] = shell.corners(t);
            Point3::from((a.coords + b.coords + c.coords) / 3.0)
        })
        .collect();
    let whole: f64 = areas.iter().sum();
    let mean = middles
        .iter()
        .zip(&areas)
        .map(|(p, a)| p.coords * *a)
        .sum::<Vector3>()
        / whole;
    let moments = middles
        .iter()
        .zip(&areas)
        .map(|(p, a)| {
            let way = p.coords - mean;
            way * way.transpose() * (*a / whole)
        })
        .sum::<crate::math::Matrix3>();
    let eigen = nalgebra::SymmetricEigen::new(moments);
    let most = eigen.eigenvalues.imax();
    eigen.eigenvectors.column(most).clone_owned()
}
