//! Short translations by search: exits along directions, then descent along the boundary of what is
//! free.
//!
//! ```text
//! exit      along a direction: scan, then halve between the last overlap and the first free place
//! descend   contact plane at T, the last five planes' shortest vector, back to free space; ends when nothing is gained
//! turn      directions beside T: accepted when a place slightly shorter is free
//! ```
//! The free places need not be an interval along a direction (a bar in a ring), so exits scan. A
//! descent finds a local minimum; `global` descends from the two shortest exits of spread
//! directions, which reached the least of some hundred directions on all given pairs. It is no
//! proof.

use super::Reason;
use super::directions::starts;
use super::pair::Pair;
use super::planes::{HalfSpace, keep, shortest};
use palpate_geometry::math::Vector3;

/// Places looked at along an exit.
const SCAN: u32 = 24;
/// An exit is halved to this share of the diameter.
const EXIT: f64 = 1e-5;
/// A descent ends when it gains less than this share of the length.
const GAIN: f64 = 1e-4;
/// Contact planes that a jump looks back at.
const KEPT: usize = 5;
/// Most contact planes of a descent.
const MOST_PLANES: u32 = 24;
/// A direction beside is better when a place shorter by this share is free.
const SHORTER: f64 = 2e-4;
/// First and last angle to directions beside, rad.
const WIDEST: f64 = 0.15;
const NARROWEST: f64 = 0.002;
/// Most accepted directions beside.
const MOST_TURNS: u32 = 60;
/// Two exits whose directions have a cosine above this lead to one descent.
const SAME_WAY: f64 = 0.85;

/// How far the vector of centroids may turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SearchLimit {
    /// rad; `None` for any turn.
    pub most_rad: Option<f64>,
}

impl SearchLimit {
    pub fn allows(&self, pair: &Pair<'_>, translation: &Vector3) -> bool {
        // 1e-12: a turn by nothing is nothing but rounding.
        self.most_rad.is_none_or(|most| {
            pair.turn_rad(translation)
                .is_some_and(|turn| turn <= most + 1e-12)
        })
    }
}

/// A search on one pair.
pub(super) struct TranslationSearch<'a, 'b> {
    pub pair: &'a mut Pair<'b>,
    pub limit: SearchLimit,
}

impl TranslationSearch<'_, '_> {
    /// No overlap, and not turned too far.
    fn free(&mut self, translation: &Vector3) -> bool {
        self.limit.allows(self.pair, translation) && !self.pair.overlap(translation)
    }

    /// The first free place along a unit vector, at contact; `None` when the turn forbids all of
    /// them.
    pub fn exit(&mut self, direction: &Vector3) -> Option<Vector3> {
        let end = self.pair.certain_exit_m(direction);
        let step = end / f64::from(SCAN);
        for k in 1..=SCAN {
            let length = step * f64::from(k);
            if self.free(&(direction * length)) {
                return Some(self.halved(&(direction * (length - step)), &(direction * length)));
            }
        }
        None
    }

    /// The free end of a segment from a place that is not free to one that is, cut down to contact.
    fn halved(&mut self, from: &Vector3, to: &Vector3) -> Vector3 {
        let (mut low, mut high) = (0.0, 1.0);
        let span = to - from;
        let (length, enough) = (span.norm(), EXIT * self.pair.diameter_m);
        // Sixty halvings exhaust the digits.
        for _ in 0..60 {
            if (high - low) * length <= enough {
                break;
            }
            let middle = 0.5 * (low + high);
            if self.free(&(from + span * middle)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        from + span * high
    }

    /// Towards the origin as far as it stays free, from a free place.
    fn shrunk(&mut self, from: &Vector3) -> Vector3 {
        // Small steps first: a jump to the origin could cross another body's part and end in a hole
        // behind it.
        let mut at = *from;
        let mut share = 0.02;
        for _ in 0..40 {
            let next = from * (1.0 - share);
            if !self.free(&next) {
                return self.halved(&next, &at);
            }
            if share >= 1.0 {
                return next;
            }
            at = next;
            share = (share * 1.7_f64).min(1.0);
        }
        at
    }

    /// Descends from a free place at contact to a local minimum of the length.
    pub fn descended(&mut self, from: &Vector3) -> Vector3 {
        let mut at = self.slid(from);
        let mut angle = WIDEST;
        for _ in 0..MOST_TURNS {
            match self.turned(&at, angle) {
                Some(better) => at = self.slid(&better),
                None if angle <= NARROWEST => break,
                None => angle = (angle / 3.0).max(NARROWEST),
            }
        }
        at
    }

    /// Contact planes and jumps.
    fn slid(&mut self, from: &Vector3) -> Vector3 {
        let mut best = *from;
        let mut planes: Vec<HalfSpace> = Vec::new();
        for _ in 0..MOST_PLANES {
            // At contact all points this near are in contact: the first that are found give a
            // plane.
            let near = self.pair.near(&best, EXIT * self.pair.diameter_m);
            let Some(normal) = near.normal else {
                return best;
            };
            let plane = HalfSpace {
                normal,
                at_least: normal.dot(&best) - near.gap_m,
            };
            keep(&mut planes, plane, KEPT);
            let Some(target) = shortest(&planes) else {
                return best;
            };
            let landed = if self.free(&target) {
                target
            } else {
                self.halved(&target, &best)
            };
            let next = self.shrunk(&landed);
            let gain = best.norm() - next.norm();
            if gain > 0.0 {
                best = next;
            }
            if gain < GAIN * best.norm() {
                return best;
            }
        }
        best
    }

    /// A free place in one of six directions at an angle from this one, shorter than this one.
    fn turned(&mut self, at: &Vector3, angle: f64) -> Option<Vector3> {
        let length = at.norm();
        let direction = at.try_normalize(0.0)?;
        let [side, other] = beside(&direction);
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        for k in 0..6 {
            let round = f64::from(k) * std::f64::consts::FRAC_PI_3;
            let tangent = side * libm::cos(round) + other * libm::sin(round);
            let candidate = (direction * cosine + tangent * sine) * (length * (1.0 - SHORTER));
            if self.free(&candidate) {
                return Some(self.shrunk(&candidate));
            }
        }
        None
    }

    /// Local: the exit along the direction of method 6, or 5, or 4, or along `warm`; then the
    /// descent.
    pub fn local(&mut self, warm: Option<&Vector3>) -> Result<Vector3, Reason> {
        let from = match warm.and_then(|warm| self.resumed(warm)) {
            Some(start) => Some(start),
            None => starts(self.pair)
                .into_iter()
                .find_map(|direction| self.exit(&direction)),
        };
        from.map(|from| self.descended(&from))
            .ok_or(Reason::NoStart)
    }

    /// A free place at contact near an earlier answer.
    fn resumed(&mut self, warm: &Vector3) -> Option<Vector3> {
        if self.free(warm) {
            return Some(self.shrunk(warm));
        }
        let mut at = *warm;
        let mut share = 1e-3;
        for _ in 0..12 {
            let next = warm * (1.0 + share);
            if self.free(&next) {
                return Some(self.halved(&at, &next));
            }
            at = next;
            share *= 1.7;
        }
        None
    }

    /// Global: exits along `spread` and along the directions of the methods, descents from the
    /// `descents` shortest that leave in different directions.
    pub fn global(&mut self, spread: &[Vector3], descents: usize) -> Result<Vector3, Reason> {
        let directions: Vec<Vector3> = starts(self.pair)
            .into_iter()
            .chain(spread.iter().copied())
            .collect();
        let mut exits: Vec<Vector3> = directions
            .iter()
            .filter_map(|direction| self.exit(direction))
            .collect();
        // Stable: of equals the first stays first.
        exits.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        let mut chosen: Vec<Vector3> = Vec::with_capacity(descents);
        for exit in exits {
            let same = |other: &Vector3| other.dot(&exit) > SAME_WAY * other.norm() * exit.norm();
            if chosen.len() < descents && !chosen.iter().any(same) {
                chosen.push(exit);
            }
        }
        let found = chosen.iter().map(|exit| self.descended(exit));
        let best = found.reduce(|best, next| {
            if next.norm() < best.norm() {
                next
            } else {
                best
            }
        });
        best.ok_or(Reason::NoStart)
    }
}

/// Two unit vectors at right angles to a unit vector and to each other.
fn beside(direction: &Vector3) -> [Vector3; 2] {
    let axis = direction.iamin();
    let side = direction.cross(&Vector3::ith(axis, 1.0)).normalize();
    [side, direction.cross(&side)]
}

/// The 6 faces and 8 corners of a cube: each with its opposite, so that exchanging the bodies
/// changes only the sign.
pub(super) fn fourteen() -> Vec<Vector3> {
    let mut directions = Vec::with_capacity(14);
    for sign in [1.0, -1.0] {
        directions.extend((0..3).map(|k| Vector3::ith(k, sign)));
        for (y, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            directions.push(Vector3::new(sign, sign * y, sign * z).normalize());
        }
    }
    directions
}

/// The corners of an icosahedron and the middles of its edges, each with its opposite.
pub(super) fn forty_two() -> Vec<Vector3> {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut corners = Vec::with_capacity(12);
    for (a, b) in [
        (1.0, golden),
        (1.0, -golden),
        (-1.0, golden),
        (-1.0, -golden),
    ] {
        corners.extend([
            Vector3::new(0.0, a, b),
            Vector3::new(a, b, 0.0),
            Vector3::new(b, 0.0, a),
        ]);
    }
    let mut directions: Vec<Vector3> = corners.iter().map(|c| c.normalize()).collect();
    for (k, a) in corners.iter().enumerate() {
        // Edges are 2 long; the next distance is twice the golden ratio.
        directions.extend(
            corners[..k]
                .iter()
                .filter(|b| (a - **b).norm() < 2.5)
                .map(|b| (a + b).normalize()),
        );
    }
    directions
}

/// Directions evenly inside a cone (`half_angle` rad round a unit vector): its axis and a spiral.
pub(super) fn cone(axis: &Vector3, half_angle: f64, count: usize) -> Vec<Vector3> {
    let [side, other] = beside(axis);
    let depth = 1.0 - libm::cos(half_angle.min(std::f64::consts::PI));
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let spiral = (0..count).map(|k| {
        let cosine = 1.0 - depth * (k as f64 + 0.5) / count as f64;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let round = golden * k as f64;
        (axis * cosine + side * (sine * libm::cos(round)) + other * (sine * libm::sin(round)))
            .normalize()
    });
    std::iter::once(*axis).chain(spiral).collect()
}
