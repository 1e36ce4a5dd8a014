//! Body to body: the pairs of points between which the spine's distance is stationary.
//!
//! (c(s) − c(t)) · c'(s) = 0 and (c(s) − c(t)) · c'(t) = 0 (Patrikalakis & Maekawa, (11.122) to
//! (11.131)). Inside a piece the factor s − t is removed: f = G(s, t) · N(s) and g = f(t, s), of
//! degrees (3n − 3, n − 1); on the diagonal both are
//! |N|² > 0. Between pieces f = [X(s)V(t) − Y(t)W(s)] · N(s). The body touches itself at half the least distance.

use super::adjacent::{Arc, directions, pairs_to_solve, within_a_right_angle};
use super::forms::Forms;
use super::piece::Piece;
use super::spine::Spine;
use crate::ipp::{Cluster, Found, Limits, PairSolver, Status, System, Tensor};
use palpate_geometry::math::Point3;

/// What the distance does around a stationary pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PairKind {
    /// The spine meets itself: distance 0.
    Crossing,
    /// Nearest among neighbours.
    Minimum,
    /// Neither nearest nor farthest.
    Saddle,
    /// Farthest among neighbours.
    Maximum,
}

/// Two points of the spine whose chord is normal to it at both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationaryPair {
    /// Parameters, the smaller first.
    pub parameters: [f64; 2],
    /// Proved bound of the parameters' error, as a share of their pieces.
    pub error: f64,
    /// Their distance, m.
    pub distance_m: f64,
    /// The two points, m.
    pub points: [Point3; 2],
    /// What the distance does around it.
    pub kind: PairKind,
}

/// A region whose stationary pairs cannot be separated: a curve of them, or some too close to each
/// other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unresolved {
    /// Range of the first parameter.
    pub first: [f64; 2],
    /// Range of the second parameter.
    pub second: [f64; 2],
    /// Least and largest distance found inside, m.
    pub distance_m: [f64; 2],
    /// Where the least was found.
    pub parameters: [f64; 2],
    /// The two points there, m.
    pub points: [Point3; 2],
    /// Cluster, continuum or budget.
    pub status: Status,
}

/// The answer for body to body.
#[derive(Clone, Debug, Default)]
pub struct BodyToBody {
    /// Half the least distance, m; `None` where there are no stationary pairs.
    pub radius_m: Option<f64>,
    /// All stationary pairs that are proved, in ascending order of parameters.
    pub pairs: Vec<StationaryPair>,
    /// Regions whose pairs could not be separated.
    pub unresolved: Vec<Unresolved>,
    /// What the answer rests on.
    pub status: Status,
    /// Boxes looked at by the solver.
    pub boxes: usize,
}

/// Boxes for a whole spine.
const MOST_BOXES: usize = 500_000;
/// Distances below this share of the spine's size are a crossing.
const CROSSING: f64 = 1e-13;
/// Pairs found on both sides of a joint are nearer than this share of a piece.
const SAME: f64 = 1e-9;
/// Further apart in their first place, two pairs are not the same.
const NEAR: f64 = 0.02;
/// Middles of a chain at which the distance is taken.
const MOST_MIDDLES: usize = 512;

/// All stationary pairs of a spine.
pub fn body_to_body(spine: &Spine) -> BodyToBody {
    let mut search = BodySearch {
        spine,
        solver: PairSolver::default(),
        found: Vec::new(),
        answer: BodyToBody::default(),
    };
    let count = spine.pieces.len();
    for i in 0..count {
        search.inside(i);
        for j in i + 1..count {
            let (a, b) = (search.arc(i), search.arc(j));
            if j == i + 1 {
                pairs_to_solve(&a, &b, |a, b| search.between(a, b, (i, j)));
            } else if spine.is_closed() && i == 0 && j == count - 1 {
                pairs_to_solve(&b, &a, |b, a| search.between(b, a, (j, i)));
            } else {
                search.between(&a, &b, (i, j));
            }
        }
    }
    search.finish()
}

struct BodySearch<'a> {
    spine: &'a Spine,
    solver: PairSolver,
    /// Pairs in places of the spine, with the error of the places.
    found: Vec<([BodyPlace; 2], f64)>,
    answer: BodyToBody,
}

/// A piece and x in [0, 1] in it.
#[derive(Clone, Copy, Debug)]
struct BodyPlace {
    piece: usize,
    x: f64,
}

impl BodyPlace {
    /// Counts pieces and parts of them.
    fn order(self) -> f64 {
        self.piece as f64 + self.x
    }
}

impl BodySearch<'_> {
    fn arc(&self, k: usize) -> Arc {
        Arc {
            piece: self.spine.pieces[k].clone(),
            forms: self.spine.forms[k].clone(),
        }
    }

    /// A spine that runs along itself for hundreds of pieces would take minutes.
    fn exhausted(&mut self) -> bool {
        let exhausted = self.answer.boxes > MOST_BOXES;
        if exhausted {
            self.answer.status = Status::Budget;
        }
        exhausted
    }

    /// A piece with itself.
    fn inside(&mut self, k: usize) {
        let forms = &self.spine.forms[k];
        if self.exhausted() || within_a_right_angle(&[forms]) {
            return;
        }
        let f = same_piece(forms);
        if f.has_sign() {
            self.answer.boxes += 1;
            return;
        }
        let system = System::new(&f, &f.swapped());
        let found = self.solver.solve(
            &system,
            &Limits {
                half: true,
                ..Limits::default()
            },
        );
        let piece = &self.spine.pieces[k];
        self.collect(&system, found, [piece, piece], [k, k]);
    }

    /// Two arcs of different pieces.
    fn between(&mut self, a: &Arc, b: &Arc, (i, j): (usize, usize)) {
        if self.exhausted()
            || chords_lean(&a.piece, &b.piece, &a.forms)
            || chords_lean(&a.piece, &b.piece, &b.forms)
        {
            self.answer.boxes += 1;
            return;
        }
        let (f, g) = different_pieces(&a.forms, &b.forms);
        if f.has_sign() || g.has_sign() {
            self.answer.boxes += 1;
            return;
        }
        let system = System::new(&f, &g);
        let found = self.solver.solve(&system, &Limits::default());
        self.collect(&system, found, [&a.piece, &b.piece], [i, j]);
    }

    fn collect(&mut self, system: &System, found: Found, arcs: [&Piece; 2], pieces: [usize; 2]) {
        self.answer.boxes += found.boxes;
        // Clusters raise it in the end, if they are still there.
        if found.status != Status::Cluster {
            self.answer.status = self.answer.status.max(found.status);
        }
        for root in &found.roots {
            let places = [0, 1].map(|k| self.place(arcs[k], pieces[k], root.at[k]));
            self.found.push((places, root.radius));
        }
        for cluster in &found.clusters {
            let unresolved = self.unresolved(system, cluster, arcs, found.status);
            self.answer.unresolved.push(unresolved);
        }
    }

    /// From a place in an arc to the place in the piece that it is cut from.
    fn place(&self, arc: &Piece, piece: usize, x: f64) -> BodyPlace {
        let whole = &self.spine.pieces[piece];
        if (arc.start, arc.end) == (whole.start, whole.end) {
            return BodyPlace { piece, x };
        }
        let x = (arc.parameter(x) - whole.start) / (whole.end - whole.start);
        BodyPlace {
            piece,
            x: x.clamp(0.0, 1.0),
        }
    }

    /// Distance is constant along a curve of stationary pairs, so some of its points say it all.
    fn unresolved(
        &self,
        system: &System,
        cluster: &Cluster,
        arcs: [&Piece; 2],
        status: Status,
    ) -> Unresolved {
        let stride = cluster.middles.len().div_ceil(MOST_MIDDLES);
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let (mut best, mut points) = ([0.0; 2], [Point3::origin(); 2]);
        for &middle in cluster.middles.iter().step_by(stride) {
            let at = system.settle(middle, cluster.low, cluster.high);
            let ends = [0, 1].map(|k| arcs[k].jet(at[k]).point);
            let distance_m = self.spine.metres((ends[0] - ends[1]).norm());
            if distance_m < range[0] {
                best = [0, 1].map(|k| arcs[k].parameter(at[k]));
                points = ends.map(|p| self.spine.place(&p));
            }
            range = [range[0].min(distance_m), range[1].max(distance_m)];
        }
        let span = |k: usize| {
            [
                arcs[k].parameter(cluster.low[k]),
                arcs[k].parameter(cluster.high[k]),
            ]
        };
        let status = status.max(Status::Cluster);
        Unresolved {
            first: span(0),
            second: span(1),
            distance_m: range,
            parameters: best,
            points,
            status,
        }
    }

    fn finish(mut self) -> BodyToBody {
        let count = self.spine.pieces.len();
        let period = count as f64;
        let mut found = std::mem::take(&mut self.found);
        for (places, _) in &mut found {
            for place in places.iter_mut() {
                // The end of a closed spine is its start.
                if self.spine.is_closed() && period - place.order() < SAME {
                    *place = BodyPlace { piece: 0, x: 0.0 };
                }
            }
            if places[0].order() > places[1].order() {
                places.swap(0, 1);
            }
        }
        let order = |pair: &([BodyPlace; 2], f64), k: usize| pair.0[k].order();
        found.sort_by(|a, b| {
            order(a, 0)
                .total_cmp(&order(b, 0))
                .then(order(a, 1).total_cmp(&order(b, 1)))
        });
        let mut kept: Vec<([BodyPlace; 2], f64)> = Vec::new();
        for pair in found {
            let room = |other: &([BodyPlace; 2], f64)| SAME + pair.1 + other.1;
            let same = |other: &([BodyPlace; 2], f64)| {
                (0..2).all(|k| (order(other, k) - order(&pair, k)).abs() < room(other))
            };
            // In order of the first place: only the last ones can be the same.
            let near = kept
                .iter()
                .rev()
                .take_while(|other| order(&pair, 0) - order(other, 0) < NEAR);
            if !near.into_iter().any(same) {
                kept.push(pair);
            }
        }
        self.answer.pairs = kept
            .iter()
            .map(|(places, error)| self.pair(*places, *error))
            .collect();
        let mut unresolved = std::mem::take(&mut self.answer.unresolved);
        unresolved.retain(|region| !self.is_proved_elsewhere(region));
        if !unresolved.is_empty() {
            self.answer.status = self.answer.status.max(Status::Cluster);
        }
        self.answer.unresolved = unresolved;
        let distances = self.answer.pairs.iter().map(|pair| pair.distance_m);
        let least = distances
            .chain(self.answer.unresolved.iter().map(|u| u.distance_m[0]))
            .min_by(f64::total_cmp);
        self.answer.radius_m = least.map(|distance_m| 0.5 * distance_m);
        self.answer
    }

    /// At a joint the same pair is seen from up to four pairs of pieces; one proof is enough.
    fn is_proved_elsewhere(&self, region: &Unresolved) -> bool {
        let (start, end) = self.spine.domain();
        let room = SAME * (end - start) / self.spine.piece_count() as f64;
        let width = |range: [f64; 2]| (range[1] - range[0]).abs();
        if region.status != Status::Cluster || width(region.first).max(width(region.second)) > room
        {
            return false;
        }
        // The end of a closed spine is its start.
        let inside = |t: f64| {
            if self.spine.is_closed() && end - t < room {
                start
            } else {
                t
            }
        };
        let mut at = region.parameters.map(inside);
        at.sort_by(f64::total_cmp);
        self.answer
            .pairs
            .iter()
            .any(|pair| (0..2).all(|k| (pair.parameters[k] - at[k]).abs() < room))
    }

    fn pair(&self, places: [BodyPlace; 2], error: f64) -> StationaryPair {
        let [a, b] = places.map(|place| self.spine.pieces[place.piece].jet(place.x));
        let chord = a.point - b.point;
        let distance = chord.norm();
        // Half the second derivatives of the squared distance.
        let ss = a.first.norm_squared() + chord.dot(&a.second);
        let tt = b.first.norm_squared() - chord.dot(&b.second);
        let st = -a.first.dot(&b.first);
        let kind = match ss * tt - st * st {
            _ if distance < CROSSING => PairKind::Crossing,
            determinant if determinant < 0.0 => PairKind::Saddle,
            _ if ss + tt > 0.0 => PairKind::Minimum,
            _ => PairKind::Maximum,
        };
        StationaryPair {
            parameters: places.map(|place| self.spine.pieces[place.piece].parameter(place.x)),
            error,
            distance_m: self.spine.metres(distance),
            points: [self.spine.place(&a.point), self.spine.place(&b.point)],
            kind,
        }
    }
}

/// True where every chord between control points has a positive, or every one a negative, scalar
/// product with every hodograph coefficient of one arc: its equation is a mean of those products,
/// so it has no root. Cheaper than the equation.
fn chords_lean(a: &Piece, b: &Piece, along: &Forms) -> bool {
    let (mut forwards, mut backwards) = (true, true);
    for direction in directions(along) {
        // Coordinates are at most 1 in size, so chords are shorter than 4 and exact to 1e-14.
        let margin = 1e-14 * direction.vector.norm() + 4.0 * direction.error;
        for p in &a.points {
            for q in &b.points {
                let product = (p - q).dot(&direction.vector);
                forwards &= product > margin;
                backwards &= product < -margin;
            }
            if !(forwards || backwards) {
                return false;
            }
        }
    }
    true
}

/// G(s, t) · N(s).
fn same_piece(forms: &Forms) -> Tensor {
    let g = forms.bezoutian();
    let n = &forms.hodograph;
    g[0].times_in_s(&n[0])
        .plus(&g[1].times_in_s(&n[1]))
        .plus(&g[2].times_in_s(&n[2]))
}

/// [X(s)V(t) − Y(t)W(s)] · N(s), and the same with the tangent of the other piece.
fn different_pieces(a: &Forms, b: &Forms) -> (Tensor, Tensor) {
    let chord = a.chord(b);
    let (n, m) = (&a.hodograph, &b.hodograph);
    let f = chord[0]
        .times_in_s(&n[0])
        .plus(&chord[1].times_in_s(&n[1]))
        .plus(&chord[2].times_in_s(&n[2]));
    let g = chord[0]
        .times_in_t(&m[0])
        .plus(&chord[1].times_in_t(&m[1]))
        .plus(&chord[2].times_in_t(&m[2]));
    (f, g)
}
