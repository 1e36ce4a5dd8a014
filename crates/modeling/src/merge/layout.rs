//! Which patch lies where, and how it is turned, so that edges meet.

use super::rim::{Misfit, Rim, facing, facing_back};
use super::turn::Turn;
use super::{Arrangement, Edge, MergeError};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{Closing, Direction, Surface};

/// Points compared along an edge, less one.
const STEPS: usize = 8;
/// Edges whose ends are farther apart than this, along them and as a share of the shorter one, meet
/// in part only.
const T_JUNCTION: f64 = 1.0 / 3.0;
/// An edge shorter than this, as a share of the patch, is a point.
const POINT: f64 = 1e-6;

/// A patch of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placed {
    /// Which patch, from 0.
    pub patch: usize,
    /// How it is laid.
    pub turn: Turn,
}

/// The grid of patches: rows follow each other in u, the patches of a row in v.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Rows, u.
    pub rows: usize,
    /// Columns, v.
    pub columns: usize,
    /// (rows × columns), row after row.
    pub places: Vec<Placed>,
}

impl Layout {
    /// Lays the patches as asked, and refuses those that cannot be joined. A trimmed patch is joined where it ends.
    ///
    /// # Errors
    /// A count that does not fit, sides that are not edges, edges too far apart or meeting only in part.
    pub(super) fn new(
        surfaces: &[Surface],
        arrangement: Arrangement,
        rims: &[Option<Rims>],
    ) -> Result<Self, MergeError> {
        let given = surfaces.len();
        if given < 2 {
            return Err(MergeError::TooFew { given });
        }
        let rims = rims
            .iter()
            .map(Option::as_ref)
            .chain(std::iter::repeat(None));
        let grids: Vec<PatchGrid> = (surfaces.iter().zip(rims))
            .map(|(surface, rims)| {
                PatchGrid::new(surface, rims, arrangement == Arrangement::Closest)
            })
            .collect();
        let (layout, cost) = match arrangement {
            Arrangement::Closest | Arrangement::Edges(_) if given > 2 => {
                return Err(MergeError::NoGrid { given });
            }
            Arrangement::Closest => pair(&grids, None),
            Arrangement::Edges(edges) => pair(&grids, Some(edges)),
            Arrangement::Grid { rows, columns } if rows.checked_mul(columns) != Some(given) => {
                return Err(MergeError::Arrangement {
                    given,
                    rows,
                    columns,
                });
            }
            Arrangement::Grid { rows, columns } => fill(&grids, rows, columns),
        };
        if !cost.is_finite() {
            let patch = grids
                .iter()
                .position(|g| Edge::ALL.iter().all(|&e| !g.joins(Turn::default(), e)))
                .unwrap_or(0);
            return Err(MergeError::NoEdge { patch });
        }
        for (a, b, edges) in layout.seams() {
            check(&grids, a, b, edges)?;
        }
        Ok(layout)
    }

    /// A place.
    pub fn at(&self, row: usize, column: usize) -> Placed {
        self.places[row * self.columns + column]
    }

    /// Neighbours, and the edges of the turned patches that meet.
    pub fn seams(&self) -> impl Iterator<Item = (Placed, Placed, [Edge; 2])> + '_ {
        let cells = (0..self.rows).flat_map(|i| (0..self.columns).map(move |j| (i, j)));
        cells.flat_map(move |(i, j)| {
            let below = (i + 1 < self.rows)
                .then(|| (self.at(i, j), self.at(i + 1, j), [Edge::U1, Edge::U0]));
            let right = (j + 1 < self.columns)
                .then(|| (self.at(i, j), self.at(i, j + 1), [Edge::V1, Edge::V0]));
            below.into_iter().chain(right)
        })
    }
}

/// What the trim of a patch leaves, as each of its edges sees it.
pub(super) struct Rims(pub [Result<Option<Rim>, Misfit>; 4]);

impl Rims {
    pub(super) fn at(&self, edge: Edge) -> &Result<Option<Rim>, Misfit> {
        &self.0[edge as usize]
    }
}

/// Places of a patch, evenly in its parameters.
struct PatchGrid {
    points: Vec<Point3>,
    size_m: f64,
    /// u, v go round, or both ends meet.
    closed: [bool; 2],
    /// Of a trimmed patch: where it ends before an edge.
    ends: Vec<(Edge, [Point3; STEPS + 1])>,
    /// Edges at which it does not end.
    barred: Vec<Edge>,
}

/// Where lines to the edges of a patch end that end on a graph.
fn ends(surface: &Surface, rims: &Rims) -> Vec<(Edge, [Point3; STEPS + 1])> {
    let at = |direction, f: f64| {
        let knots = surface.knots(direction);
        knots.domain().0 + knots.length() * f
    };
    let graphs = Edge::ALL.into_iter().filter_map(|edge| {
        let graph = rims.at(edge).as_ref().ok()?.as_ref()?.graph.as_ref().ok()?;
        let points = std::array::from_fn(|k| {
            let g = k as f64 / STEPS as f64;
            let [u, v] = facing_back(edge, [graph.at(g), g]);
            surface.point(at(Direction::U, u), at(Direction::V, v))
        });
        Some((edge, points))
    });
    graphs.collect()
}

/// All but the edges before which a patch ends; if there are none, those that no row of points reaches.
fn barred(rims: &Rims, ends: &[(Edge, [Point3; STEPS + 1])]) -> Vec<Edge> {
    let bars = |edge: &Edge| match rims.at(*edge) {
        _ if !ends.is_empty() => ends.iter().all(|(end, _)| end != edge),
        Ok(Some(rim)) => rim.least <= 0.0,
        _ => false,
    };
    Edge::ALL.into_iter().filter(bars).collect()
}

impl PatchGrid {
    fn new(surface: &Surface, rims: Option<&Rims>, any_edge: bool) -> Self {
        let at = |knots: &palpate_geometry::basis::KnotVector, k: usize| {
            knots.domain().0 + knots.length() * (k as f64 / STEPS as f64)
        };
        let (us, vs) = (surface.knots_u(), surface.knots_v());
        let pairs = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (i, j)));
        let points: Vec<Point3> = pairs
            .map(|(i, j)| surface.point(at(us, i), at(vs, j)))
            .collect();
        let ends = rims.map_or_else(Vec::new, |rims| ends(surface, rims));
        let low = points.iter().fold(points[0], |low, p| low.inf(p));
        let high = points.iter().fold(points[0], |high, p| high.sup(p));
        let closed = surface
            .topology()
            .closing
            .map(|closing| closing != Closing::Open);
        Self {
            points,
            size_m: (high - low).norm(),
            closed,
            barred: (rims.filter(|_| any_edge)).map_or_else(Vec::new, |rims| barred(rims, &ends)),
            ends,
        }
    }

    fn edge(&self, turn: Turn, edge: Edge) -> [Point3; STEPS + 1] {
        let source = turn.source(edge);
        let end = self.ends.iter().find(|(at, _)| *at == source);
        std::array::from_fn(|k| {
            let along = k as f64 / STEPS as f64;
            let place = match edge {
                Edge::U0 => [0.0, along],
                Edge::U1 => [1.0, along],
                Edge::V0 => [along, 0.0],
                Edge::V1 => [along, 1.0],
            };
            let place = turn.back(place);
            if let Some((_, points)) = end {
                return points[(facing(source, place)[1] * STEPS as f64).round() as usize];
            }
            let [i, j] = place.map(|x| (x * STEPS as f64).round() as usize);
            self.points[i * (STEPS + 1) + j]
        })
    }

    /// The edge is one: the surface does not go on there, and it has a length.
    fn joins(&self, turn: Turn, edge: Edge) -> bool {
        let source = turn.source(edge);
        let closed = self.closed[if source.direction() == Direction::U {
            0
        } else {
            1
        }];
        !self.barred.contains(&source)
            && !closed
            && length(&self.edge(turn, edge)) > POINT * self.size_m
    }
}

fn length(edge: &[Point3]) -> f64 {
    edge.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

/// Mean distance of points that should meet, m; infinite where an edge is none.
fn apart(grids: &[PatchGrid], a: Placed, b: Placed, [at_a, at_b]: [Edge; 2]) -> f64 {
    let (one, other) = (&grids[a.patch], &grids[b.patch]);
    if !(one.joins(a.turn, at_a) && other.joins(b.turn, at_b)) {
        return f64::INFINITY;
    }
    let (x, y) = (one.edge(a.turn, at_a), other.edge(b.turn, at_b));
    x.iter().zip(&y).map(|(p, q)| (p - q).norm()).sum::<f64>() / (STEPS + 1) as f64
}

/// Two patches: the first stays as it is, the second comes before or after it, in u or in v.
fn pair(grids: &[PatchGrid], named: Option<[Edge; 2]>) -> (Layout, f64) {
    let a = Placed {
        patch: 0,
        turn: Turn::default(),
    };
    let mut best: Option<(Layout, f64)> = None;
    for at_a in [Edge::U1, Edge::U0, Edge::V1, Edge::V0] {
        let (at_b, rows, columns) = match at_a {
            Edge::U1 => (Edge::U0, 2, 1),
            Edge::U0 => (Edge::U1, 2, 1),
            Edge::V1 => (Edge::V0, 1, 2),
            Edge::V0 => (Edge::V1, 1, 2),
        };
        for turn in Turn::all() {
            if named.is_some_and(|[x, y]| x != at_a || y != turn.source(at_b)) {
                continue;
            }
            let b = Placed { patch: 1, turn };
            let cost = apart(grids, a, b, [at_a, at_b]);
            // Turns that match equally well (a square of flat patches) are distinguished by order, not
            // by rounding.
            if best
                .as_ref()
                .is_none_or(|(_, least)| cost < least * (1.0 - 1e-9))
            {
                let places = if at_a.at_end() {
                    vec![a, b]
                } else {
                    vec![b, a]
                };
                best = Some((
                    Layout {
                        rows,
                        columns,
                        places,
                    },
                    cost,
                ));
            }
        }
    }
    best.expect("four edges and eight turns hold every named pair")
}

/// A grid: for each turn of the first patch the others follow, each turned to be nearest to those
/// before it.
fn fill(grids: &[PatchGrid], rows: usize, columns: usize) -> (Layout, f64) {
    let mut best: Option<(Layout, f64)> = None;
    for first in Turn::all() {
        let (mut places, mut total) = (
            vec![Placed {
                patch: 0,
                turn: first,
            }],
            0.0,
        );
        for patch in 1..grids.len() {
            let (i, j) = (patch / columns, patch % columns);
            let mut chosen: Option<(Placed, f64)> = None;
            for turn in Turn::all() {
                let b = Placed { patch, turn };
                let above =
                    (i > 0).then(|| apart(grids, places[patch - columns], b, [Edge::U1, Edge::U0]));
                let left =
                    (j > 0).then(|| apart(grids, places[patch - 1], b, [Edge::V1, Edge::V0]));
                let cost: f64 = above.into_iter().chain(left).sum();
                if chosen.is_none_or(|(_, least)| cost < least * (1.0 - 1e-9)) {
                    chosen = Some((b, cost));
                }
            }
            let (place, cost) = chosen.expect("eight turns were tried");
            places.push(place);
            total += cost;
        }
        if best
            .as_ref()
            .is_none_or(|(_, least)| total < least * (1.0 - 1e-9))
        {
            best = Some((
                Layout {
                    rows,
                    columns,
                    places,
                },
                total,
            ));
        }
    }
    best.expect("eight turns were tried")
}

/// Two edges can be joined: near enough, and whole against whole.
fn check(
    grids: &[PatchGrid],
    a: Placed,
    b: Placed,
    [at_a, at_b]: [Edge; 2],
) -> Result<(), MergeError> {
    let (x, y) = (
        grids[a.patch].edge(a.turn, at_a),
        grids[b.patch].edge(b.turn, at_b),
    );
    let [a_m, b_m] = [&x, &y].map(|edge| length(edge));
    let shorter = a_m.min(b_m);
    let longer = if a_m >= b_m { &x } else { &y };
    // Only what corners miss along the edge makes a T; across it there may be a gap to bridge.
    let along = |at: usize, inner: usize| {
        let chord = longer[at] - longer[inner];
        (x[at] - y[at]).dot(&chord).abs() / chord.norm().max(f64::MIN_POSITIVE)
    };
    let offset_m = along(0, 1).max(along(STEPS, STEPS - 1));
    let gap_m = apart(grids, a, b, [at_a, at_b]);
    if gap_m > shorter {
        return Err(MergeError::TooFar {
            a: a.patch,
            b: b.patch,
            gap_m,
            length_m: shorter,
        });
    }
    if offset_m > T_JUNCTION * shorter {
        return Err(MergeError::TJunction {
            a: a.patch,
            b: b.patch,
            a_m,
            b_m,
            offset_m,
        });
    }
    Ok(())
}
