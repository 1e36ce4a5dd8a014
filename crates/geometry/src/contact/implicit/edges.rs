//! Edges of a solid that is given by a function: where `max`, `min` and `abs` change over from one operand to the other.
//!
//! With a choice of operands a function is smooth. Triangles around the solid whose corners have different choices cross
//! an edge, or a seam over which the slope goes on; from there Newton's method leads to where both functions vanish, and
//! steps along the cross product of their gradients go on to a corner or round. The tips of `hypot` and `sqrt` are where
//! these vanish on the boundary.

use super::shape::ImplicitTool;
use crate::contact::features::SHARP;
use crate::contact::{Curve, Edge, Features};
use crate::math::{Point3, Vector3};
use nalgebra::{Matrix2x3, Vector2};
use std::collections::BTreeSet;

/// Triangles in which crossings are looked for.
const TRIANGLES: usize = 20_000;
/// Steps along an edge, of the size of the solid: what a cubic between two leaves over is below 1e-9 of it.
const STEP: f64 = 1.0 / 200.0;
/// Most points of all edges.
const MOST_POINTS: usize = 20_000;
/// Steps of Newton's method, and halvings in search of a corner.
const NEWTON: usize = 30;
const HALVINGS: usize = 60;
/// A place is on the boundary within this of the size.
const ON: f64 = 1e-12;
/// In a step an edge bends aside by less than this share of it.
const BENT: f64 = 0.05;
/// How far beside an edge its sides are looked at, of the size.
const BESIDE: f64 = 1e-6;

impl ImplicitTool {
    /// Looks for the edges and tips of a function within a cube of so much in each direction, m. Where it has none, or
    /// too many, none are known.
    pub(super) fn find_edges(&mut self, reach_m: f64) {
        let mesh = self.outline(reach_m, TRIANGLES);
        let size_m = mesh
            .points
            .iter()
            .map(|p| p.coords.amax())
            .fold(0.0, f64::max);
        if self.tape().ties() == 0 || self.tape().ties() > u64::BITS as usize || size_m == 0.0 {
            return;
        }
        let mut tracer = Tracer {
            tool: self,
            size_m,
            reach_m,
            found: Features::default(),
            seen: Vec::new(),
            ties: 0,
            points: 0,
        };
        let choices: Vec<u64> = (mesh.points.iter())
            .map(|p| tracer.tool.tape().choices(p))
            .collect();
        let sides = mesh
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        let crossing: BTreeSet<(u32, u32)> = sides
            .filter(|&(a, b)| a < b && choices[a as usize] != choices[b as usize])
            .collect();
        for (a, b) in crossing {
            let [a, b] = [a as usize, b as usize];
            let middle = nalgebra::center(&mesh.points[a], &mesh.points[b]);
            let near_m = 2.0 * (mesh.points[a] - mesh.points[b]).norm();
            tracer.trace(middle, near_m, [choices[a], choices[b]]);
            if tracer.points > MOST_POINTS {
                return;
            }
        }
        if tracer.found.edges.is_empty() {
            return;
        }
        for p in &mesh.points {
            tracer.tip(p);
        }
        let (found, ties) = (tracer.found, tracer.ties);
        self.know(found, ties);
    }
}

struct Tracer<'a> {
    tool: &'a ImplicitTool,
    size_m: f64,
    /// An edge that goes on beyond this ends here, m from the origin in x, y or z.
    reach_m: f64,
    found: Features,
    /// Places of edges that were traced.
    seen: Vec<Place>,
    /// Which of `max`, `min` and `abs` make edges, as bits.
    ties: u64,
    points: usize,
}

/// A place on an edge, and the unit way along it.
type Place = (Point3, Vector3);

impl Tracer<'_> {
    /// Follows the edge of two sides through a point near to it.
    fn trace(&mut self, near: Point3, near_m: f64, sides: [u64; 2]) {
        let step_m = STEP * self.size_m;
        let Some(start) = self.on_edge(near, sides) else {
            return;
        };
        if (start.0 - near).norm() > near_m + self.size_m * ON {
            return;
        }
        let known = |(p, way): &Place| {
            let to = start.0 - p;
            let along_m = to.dot(way);
            along_m.abs() < 1.5 * step_m && (to - way * along_m).norm() < BENT * step_m
        };
        if self.seen.iter().any(known) {
            return;
        }
        self.ties |= sides[0] ^ sides[1];
        let (forwards, round) = self.follow(start, step_m, sides);
        let mut curve = Vec::new();
        if !round {
            let back = (start.0, -start.1);
            let (backwards, _) = self.follow(back, step_m, sides);
            curve.extend(
                backwards
                    .into_iter()
                    .skip(1)
                    .rev()
                    .map(|(p, way)| (p, -way)),
            );
        }
        curve.extend(forwards);
        self.points += curve.len();
        self.seen.extend(&curve);
        if curve.len() < 2 {
            return;
        }
        let edge = self.edge(curve, round);
        self.found.edges.push(edge);
    }

    /// Places along an edge from one on; whether they come round to it.
    fn follow(&self, start: Place, step_m: f64, sides: [u64; 2]) -> (Vec<Place>, bool) {
        let mut places = vec![start];
        while self.points + places.len() <= MOST_POINTS {
            let (p, way) = places[places.len() - 1];
            let go = |by_m: f64| {
                let (next, along) = self.on_edge(p + way * by_m, sides)?;
                let on = if along.dot(&way) < 0.0 { -along } else { along };
                ((next - p).norm() < 2.0 * step_m).then_some((next, on))
            };
            if let Some(next) = go(step_m) {
                let back = start.0 - next.0;
                if places.len() > 3 && back.norm() < step_m && back.dot(&next.1) >= 0.0 {
                    // Shorter than the others, the last step would make its points unlike: it is shared out.
                    return (self.even(places, sides), true);
                }
                places.push(next);
                continue;
            }
            let (mut low, mut high) = (0.0, step_m);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if go(middle).is_some() {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            if low > 1e-3 * step_m {
                places.extend(go(low));
            } else if places.len() > 1 {
                // The last step ended at the corner.
                let last = places.len() - 1;
                places[last] = go(low).unwrap_or(places[last]);
            }
            break;
        }
        (places, false)
    }

    /// The places of an edge that comes round, at equal distances.
    fn even(&self, places: Vec<Place>, sides: [u64; 2]) -> Vec<Place> {
        let count = places.len();
        let around = |k: usize| places[k % count].0;
        let lengths: Vec<f64> = (0..count)
            .map(|k| (around(k + 1) - around(k)).norm())
            .collect();
        let step_m = lengths.iter().sum::<f64>() / count as f64;
        let (mut out, mut k, mut before_m) = (Vec::with_capacity(count), 0, 0.0);
        for n in 0..count {
            let wanted_m = n as f64 * step_m;
            while k + 1 < count && before_m + lengths[k] < wanted_m {
                before_m += lengths[k];
                k += 1;
            }
            let share = (wanted_m - before_m) / lengths[k];
            let near = around(k) + (around(k + 1) - around(k)) * share;
            let (p, way) = self.on_edge(near, sides).unwrap_or(places[k]);
            out.push((
                p,
                if way.dot(&places[k].1) < 0.0 {
                    -way
                } else {
                    way
                },
            ));
        }
        out
    }

    /// The place next to a point at which two sides meet, as an edge that stands out.
    fn on_edge(&self, near: Point3, sides: [u64; 2]) -> Option<Place> {
        let tape = self.tool.tape();
        let at = |p: &Point3| sides.map(|side| tape.gradient_with(p, side));
        let mut p = near;
        for _ in 0..NEWTON {
            let [(f, df), (g, dg)] = at(&p);
            let slopes = Matrix2x3::from_rows(&[df.transpose(), dg.transpose()]);
            let square = (slopes * slopes.transpose()).try_inverse()?;
            let step = slopes.transpose() * (square * Vector2::new(f, g));
            p -= step;
            let moved = step.norm();
            if !moved.is_finite() {
                return None;
            }
            if moved < 1e-15 * self.size_m {
                break;
            }
        }
        if p.coords.amax() > self.reach_m {
            return None;
        }
        let [(f, df), (g, dg)] = at(&p);
        let on_m = ON * self.size_m;
        if f.abs() > on_m * df.norm() || g.abs() > on_m * dg.norm() {
            return None;
        }
        // Neither side is cut off by another.
        let (whole, steepness) = (tape.value(&p), df.norm().max(dg.norm()));
        if whole.abs() > on_m * steepness {
            return None;
        }
        let [one, other] = [df.normalize(), dg.normalize()];
        if one.dot(&other) >= SHARP {
            return None;
        }
        // It stands out where the solid goes on along neither side.
        let beside = (other - one).normalize() * (BESIDE * self.size_m);
        let outside = |q: Point3| tape.value(&q) > 0.0;
        if !(outside(p + beside) && outside(p - beside)) {
            return None;
        }
        Some((p, one.cross(&other).normalize()))
    }

    fn edge(&mut self, places: Vec<Place>, round: bool) -> Edge {
        if round {
            return Edge::Curve(Curve::new(places, None));
        }
        self.found.open_edge(places, self.size_m)
    }

    /// Keeps the tip of a root next to a point of the boundary, if there is one.
    fn tip(&mut self, near: &Point3) {
        let tape = self.tool.tape();
        for root in tape.roots() {
            let (value, slope) = tape.gradient_of(near, root);
            // A cone's distance from its axis, of points that are no farther from its tip than a cell or two.
            if value > 0.1 * self.size_m * slope.norm() {
                continue;
            }
            let mut p = *near;
            for _ in 0..200 {
                let (value, slope) = tape.gradient_of(&p, root);
                if slope.norm_squared() > 0.0 {
                    p -= slope * (value / slope.norm_squared());
                }
                let (f, gradient) = tape.gradient(&p);
                if gradient.norm_squared() > 0.0 {
                    p -= gradient * (f / gradient.norm_squared());
                }
            }
            let on_m = ON * self.size_m;
            let (value, _) = tape.gradient_of(&p, root);
            let steepness = |p: &Point3| tape.gradient(p).1.norm();
            let beside = |k: usize| {
                let angle = k as f64 * 1.1;
                let way = Vector3::new(
                    libm::cos(angle),
                    libm::sin(angle),
                    0.5 * libm::sin(1.7 * angle),
                );
                p + way * (BESIDE * self.size_m)
            };
            let is_on = value.abs() <= on_m && tape.value(&p).abs() <= on_m * steepness(&beside(1));
            let ways: Vec<Vector3> = (0..8)
                .map(|k| tape.gradient(&beside(k)).1.normalize())
                .collect();
            let is_sharp = ways.iter().any(|way| way.dot(&ways[0]) < SHARP);
            if p.coords.amax() <= 1.01 * self.size_m && is_on && is_sharp {
                self.found.corner(p, self.size_m);
            }
        }
    }
}
