//! Edges of surfaces: creases, seams and rims, and poles that are tips.

use super::{Curve, Edge, Features, SHARP};
use crate::basis::{KnotVector, Side};
use crate::math::{Point3, Vector3};
use crate::surface::{Closing, Frame, Surface, Topology};

/// Points of an edge in each span it runs through: what a cubic between two leaves over is below 1e-9 of the size.
const POINTS: usize = 48;
/// Normals around a pole are looked at so far from it, of the domain, at so many places.
const BESIDE: f64 = 1e-6;
const AROUND: usize = 16;

impl Features {
    /// Those of a surface: creases and seams that stand out sharper than 1°, open rims, and tips at poles.
    pub fn of_surface(surface: &Surface) -> Self {
        let mut found = Found {
            surface,
            topology: surface.topology(),
            size_m: surface.size(),
            features: Self::default(),
        };
        for direction in 0..2 {
            for (t, rim) in found.across(direction) {
                found.along(direction, t, rim);
            }
        }
        for direction in 0..2 {
            for end in 0..2 {
                if found.topology.poles[direction][end] {
                    found.tip(direction, end);
                }
            }
        }
        found.features
    }
}

struct Found<'a> {
    surface: &'a Surface,
    topology: Topology,
    size_m: f64,
    features: Features,
}

/// Spans of positive length.
fn spans(knots: &KnotVector) -> impl Iterator<Item = (f64, f64)> + '_ {
    let all = knots.knots();
    knots.spans().map(|k| (all[k], all[k + 1]))
}

/// A place on an edge, and the way along it.
type Place = (Point3, Vector3);

impl Found<'_> {
    fn knots(&self, direction: usize) -> &KnotVector {
        [self.surface.knots_u(), self.surface.knots_v()][direction]
    }

    /// Parameters at which curves across a direction may be edges, and whether they are rims.
    fn across(&self, direction: usize) -> Vec<(f64, bool)> {
        let knots = self.knots(direction);
        let (start, end) = knots.domain();
        let inner = spans(knots).map(|(_, to)| to).filter(|&t| t < end);
        let creases = inner.filter(|&t| knots.multiplicity(t) >= knots.degree());
        let mut all: Vec<(f64, bool)> = creases.map(|t| (t, false)).collect();
        match self.topology.closing[direction] {
            Closing::Open => {
                let ends = [start, end].into_iter().zip(self.topology.poles[direction]);
                all.extend(ends.filter(|(_, pole)| !pole).map(|(t, _)| (t, true)));
            }
            Closing::Periodic | Closing::Seam | Closing::Touching => all.push((start, false)),
        }
        all
    }

    /// Point, way along, and whether an edge stands out there, at a share of a span along it.
    fn place(
        &self,
        [direction, end]: [usize; 2],
        t: f64,
        rim: bool,
        (from, to): (f64, f64),
        share: f64,
    ) -> (Place, bool) {
        let (start, stop) = self.knots(direction).domain();
        let along_side = if share == 1.0 {
            Side::Left
        } else {
            Side::Right
        };
        let frame = |t: f64, across: Side, share: f64| {
            let s = from + (to - from) * share;
            if direction == 0 {
                self.surface.frame_from(t, s, across, along_side)
            } else {
                self.surface.frame_from(s, t, along_side, across)
            }
        };
        let after = if end == 1 { Side::Left } else { Side::Right };
        let here = frame(t, after, share);
        let place = (here.point, [here.dv, here.du][direction]);
        if rim {
            return (place, true);
        }
        // The normal is undefined at a pole, so it is taken just beside it.
        let share = share.clamp(BESIDE, 1.0 - BESIDE);
        let normal = |frame: &Frame| {
            let normal = frame.du.cross(&frame.dv).normalize();
            if self.surface.flip_normal() {
                -normal
            } else {
                normal
            }
        };
        let before = frame(if t <= start { stop } else { t }, Side::Left, share);
        let here = frame(t, Side::Right, share);
        let onwards = [here.du, here.dv][direction];
        let (one, other) = (normal(&before), normal(&here));
        (place, one.dot(&other) < SHARP && onwards.dot(&one) < 0.0)
    }

    /// Follows a curve across a direction and keeps what of it is an edge.
    fn along(&mut self, direction: usize, t: f64, rim: bool) {
        let other = 1 - direction;
        let pieces: Vec<(f64, f64)> = spans(self.knots(other)).collect();
        let end = self.knots(other).domain().1;
        let mut runs: Vec<Vec<Place>> = vec![Vec::new()];
        let mut whole = self.topology.closing[other] != Closing::Open;
        let mut last: Option<Vector3> = None;
        for (from, to) in pieces {
            for k in 0..=POINTS {
                let share = k as f64 / POINTS as f64;
                let at = [
                    direction,
                    usize::from(rim && t > self.knots(direction).domain().0),
                ];
                let ((p, way), stands_out) = self.place(at, t, rim, (from, to), share);
                let way = way.try_normalize(0.0);
                let (Some(way), true) = (way, stands_out) else {
                    (whole, last) = (false, None);
                    runs.push(Vec::new());
                    continue;
                };
                let run = runs.len() - 1;
                if k == 0 {
                    // The same place again: a bend of the curve is a corner.
                    match last {
                        Some(before) if before.dot(&way) >= SHARP => {}
                        Some(_) => {
                            whole = false;
                            runs.push(vec![(p, way)]);
                        }
                        None => runs[run].push((p, way)),
                    }
                } else {
                    runs[run].push((p, way));
                }
                last = Some(way);
                if whole && to >= end && k == POINTS {
                    // Round: the last place is the first.
                    let first = runs[0][0];
                    whole = first.1.dot(&way) >= SHARP;
                }
            }
        }
        for mut places in runs.into_iter().filter(|places| places.len() > 2) {
            if whole {
                places.pop();
                self.features
                    .edges
                    .push(Edge::Curve(Curve::new(places, None)));
                continue;
            }
            let edge = self.features.open_edge(places, self.size_m);
            self.features.edges.push(edge);
        }
    }

    /// A pole around which normals differ is a tip.
    fn tip(&mut self, direction: usize, end: usize) {
        let (from, to) = self.knots(direction).domain();
        let pole = [from, to][end];
        let beside = [from + BESIDE * (to - from), to - BESIDE * (to - from)][end];
        let (start, stop) = self.knots(1 - direction).domain();
        let at = |t: f64, k: usize| {
            let s = start + (stop - start) * (k as f64 + 0.5) / AROUND as f64;
            if direction == 0 { [t, s] } else { [s, t] }
        };
        let normal = |k: usize| {
            let [u, v] = at(beside, k);
            self.surface.normal(u, v)
        };
        let first = normal(0);
        if (1..AROUND).any(|k| normal(k).dot(&first) < SHARP) {
            let [u, v] = at(pole, 0);
            let p = self.surface.point(u, v);
            self.features.corner(p, self.size_m);
        }
    }
}
