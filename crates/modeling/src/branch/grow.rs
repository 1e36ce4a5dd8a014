//! From the parameters of a tree to its one net.
//!
//! ```text
//! stem section ──▶ straight layers ──▶ overlap layer          rows of a tube, from its lower end up
//!                                        │ shared with
//!  inverted T ◀── outline half + arch ◀──┘
//!  open book, q tilted rows, free rows ──▶ straight layers ──▶ overlap layer ──▶ the next fork …
//! ```
//! A row is a list of indices into one pool of points. What the construction draws twice, the
//! section of a stem under several leaves, the arch, the outline of the inverted T, is one index at
//! several places of the net: copies are equal bit for bit, and the places that a deformation has
//! to move together are known.

use super::error::BranchError;
use super::patches::{Groups, PatchTable};
use super::section::{Place, arc_columns, arch, rectangle, smoothstep};
use super::tree::{Branch, Fork, Hand, Stem, Tree};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ControlNet, Surface, SurfaceError};

/// A tree as one surface.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchingSurface {
    /// u round the sections, v from the tops down to the stem's end; its normals point out of the
    /// tubes.
    pub surface: Surface,
    /// What each part of the domain draws, and what it repeats.
    pub patches: PatchTable,
    /// Places of the net (u-major) that hold one point, for each point that has several; they move
    /// together.
    pub ties: Vec<Vec<usize>>,
}

/// The surface of a tree.
///
/// # Errors
/// A number out of range, or the rule (R1 to R4) that the tree breaks, with the place and how to
/// mend it.
///
/// # Examples
/// ```
/// use palpate_modeling::branch::{Measures, Tree, grow};
/// let tree: Tree = toml::from_str(include_str!(concat!(
///     env!("CARGO_MANIFEST_DIR"),
///     "/src/branch/data/y.toml"
/// )))?;
/// let grown = grow(&tree)?;
/// let (measures, _mesh) = Measures::of(&grown.surface, &grown.patches);
/// assert!(measures.misses(1e-6).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn grow(tree: &Tree) -> Result<BranchingSurface, BranchError> {
    super::check::check(tree)?;
    grow_unchecked(tree)
}

/// The surface of a tree that may break rules.
pub(super) fn grow_unchecked(tree: &Tree) -> Result<BranchingSurface, BranchError> {
    let counts = row_counts(tree);
    let mut grower = Grower {
        p: tree.degree_u,
        q: tree.degree_v,
        counts,
        pool: Vec::new(),
        tubes: Vec::new(),
    };
    let leaves = grower.stem(&tree.stem);
    grower.assemble(&leaves)
}

/// `stem`, then a letter a fork.
pub(super) fn child_name(parent: &str, hand: Hand) -> String {
    let parent = if parent == "stem" { "" } else { parent };
    format!("{parent}{}", hand.letter())
}

/// Rows of each part, the stem's first: the most that one of its tubes needs.
pub(super) fn row_counts(tree: &Tree) -> Vec<usize> {
    let (q, depth) = (tree.degree_v, tree.depth());
    let mut counts = vec![0; depth + 1];
    counts[0] = q + 2 + tree.stem.free_rows;
    let mut forks: Vec<(&Fork, usize)> = tree
        .stem
        .fork
        .as_deref()
        .map(|fork| (fork, 1))
        .into_iter()
        .collect();
    while let Some((fork, part)) = forks.pop() {
        for (_, branch) in fork.branches() {
            // Inverted T, open book, tilted and free rows; then the straight layers that a part
            // above stands on.
            let layers = if part < depth { q + 2 } else { 0 };
            counts[part] = counts[part].max(2 + q + branch.free_rows + layers);
            forks.extend(branch.fork.as_deref().map(|fork| (fork, part + 1)));
        }
    }
    counts
}

/// (2n + 1) indices into the pool.
type Row = Vec<usize>;

struct Grower {
    p: usize,
    q: usize,
    /// Rows of each part, the stem's first.
    counts: Vec<usize>,
    pool: Vec<Point3>,
    /// Rows of every tube of every part, from its lower end up.
    tubes: Vec<Vec<Row>>,
}

/// A rectangle that a fork stands on or layers repeat.
#[derive(Clone, Copy)]
struct Rectangle {
    width_m: f64,
    depth_m: f64,
    neighbour_m: f64,
}

impl Rectangle {
    fn widened(self, by: f64) -> Self {
        Self {
            width_m: self.width_m * by,
            neighbour_m: self.neighbour_m * by,
            ..self
        }
    }
}

impl Grower {
    /// Tubes of each leaf, the stem's first.
    fn stem(&mut self, stem: &Stem) -> Vec<Vec<usize>> {
        let section = Rectangle {
            width_m: 2.0 * stem.half_width_m,
            depth_m: 2.0 * stem.half_depth_m,
            neighbour_m: stem.neighbour_m,
        };
        let top = Place::of_the_stem();
        let layers = self.q + 2;
        let mut rows: Vec<Row> = (0..layers + stem.free_rows)
            .map(|k| {
                let (straight, free) = (
                    k.min(layers - 1) as f64,
                    (k + 1).saturating_sub(layers) as f64,
                );
                let down_m = straight * stem.layer_m + free * stem.free_step_m;
                self.layer(
                    &top.raised(-down_m),
                    section.widened(1.0 + free * stem.free_widening),
                )
            })
            .collect();
        rows.reverse();
        self.above(rows, &top, section, stem.layer_m, stem.fork.as_deref(), 1)
    }

    /// Files a tube and grows what stands on it: a fork, or itself through the parts that other
    /// leaves need.
    fn above(
        &mut self,
        rows: Vec<Row>,
        top: &Place,
        section: Rectangle,
        layer_m: f64,
        fork: Option<&Fork>,
        part: usize,
    ) -> Vec<Vec<usize>> {
        let overlap = rows[rows.len() - 1].clone();
        let tube = self.tubes.len();
        self.tubes.push(rows);
        let mut leaves = match fork {
            Some(fork) => self.fork(fork, &overlap, top, section, layer_m, part),
            None if part < self.counts.len() => {
                let mut rows = vec![overlap];
                rows.extend(
                    (1..self.counts[part])
                        .map(|k| self.layer(&top.raised(k as f64 * layer_m), section)),
                );
                let top = top.raised((self.counts[part] - 1) as f64 * layer_m);
                self.above(rows, &top, section, layer_m, None, part + 1)
            }
            None => vec![Vec::new()],
        };
        leaves.iter_mut().for_each(|leaf| leaf.insert(0, tube));
        leaves
    }

    fn fork(
        &mut self,
        fork: &Fork,
        overlap: &Row,
        top: &Place,
        section: Rectangle,
        layer_m: f64,
        part: usize,
    ) -> Vec<Vec<usize>> {
        let n = arc_columns(self.p);
        let polygon = arch(self.p, 0.5 * section.depth_m, fork.arch_m, fork.neighbour_m);
        let mut stroke: Row = polygon
            .iter()
            .map(|&[y, z]| self.push(top.at(0.0, y, z)))
            .collect();
        (stroke[0], stroke[n]) = (overlap[n], overlap[0]);
        let raise_m = fork.raise * layer_m;
        let outline = self.loop_of(section);
        fork.branches()
            .into_iter()
            .flat_map(|(hand, branch)| {
                let inverted_t = join_arcs(hand, overlap, &stroke);
                let open_book =
                    self.open_book(hand, branch.shift_m, raise_m, &outline, &polygon, top);
                self.branch(
                    hand,
                    branch,
                    vec![inverted_t, open_book],
                    top,
                    section.depth_m,
                    part,
                )
            })
            .collect()
    }

    /// Outline raised, arch moved aside, and the corners between them both.
    fn open_book(
        &mut self,
        hand: Hand,
        shift_m: f64,
        raise_m: f64,
        outline: &[[f64; 2]],
        polygon: &[[f64; 2]],
        top: &Place,
    ) -> Row {
        let n = arc_columns(self.p);
        let x = hand.sign() * shift_m;
        let mut raised: Row = outline
            .iter()
            .map(|&[x, y]| self.push(top.at(x, y, raise_m)))
            .collect();
        let mut moved: Row = polygon
            .iter()
            .map(|&[y, z]| self.push(top.at(x, y, z)))
            .collect();
        let [front, back] = [0, n].map(|k| self.push(top.at(x, outline[k][1], raise_m)));
        raised.push(front);
        (raised[0], raised[n]) = (front, back);
        (moved[0], moved[n]) = (back, front);
        join_arcs(hand, &raised, &moved)
    }

    /// Tilted rows, free rows and, where something stands on it, straight layers.
    fn branch(
        &mut self,
        hand: Hand,
        branch: &Branch,
        mut rows: Vec<Row>,
        fork: &Place,
        depth_m: f64,
        part: usize,
    ) -> Vec<Vec<usize>> {
        let (place, width_m) = tilted(hand, branch, fork);
        for (k, &front) in branch.front.iter().enumerate() {
            let loop_ = rectangle(self.p, -hand.sign() * front, branch.neighbour);
            rows.push(self.ring(
                &place.raised(k as f64 * branch.tilt_step_m),
                &loop_,
                width_m,
                depth_m,
            ));
        }
        let mut place = place.raised((self.q - 1) as f64 * branch.tilt_step_m);
        let mut end = place;
        for k in 1..=branch.free_rows {
            let t = k as f64 / branch.free_rows as f64;
            let turn = hand.sign() * branch.turn_deg.to_radians() / branch.free_rows as f64;
            place = place.turned(turn).raised(branch.free_step_m);
            end = place.twisted(branch.twist_deg.to_radians() * smoothstep(t));
            rows.push(self.free_row(hand, branch, &end, [width_m, depth_m], smoothstep(t)));
        }
        let section = Rectangle {
            width_m: 2.0 * branch.end.half_width_m,
            depth_m: 2.0 * branch.end.half_depth_m,
            neighbour_m: branch.neighbour * 2.0 * branch.end.half_width_m,
        };
        // To the top of the part: the straight layers that the next part stands on, and what other
        // tubes have more.
        let topmost = part + 1 == self.counts.len();
        let step_m = if topmost {
            branch.free_step_m
        } else {
            branch.layer_m()
        };
        let from = end;
        for k in 1..=self.counts[part] - rows.len() {
            end = from.raised(k as f64 * step_m);
            let row = match &branch.end.outline {
                Some(outline) => self.ring(&end, outline, section.width_m, section.depth_m),
                None => self.layer(&end, section),
            };
            rows.push(row);
        }
        self.above(
            rows,
            &end,
            section,
            branch.layer_m(),
            branch.fork.as_deref(),
            part + 1,
        )
    }

    /// The tilted section on its way to the end's.
    fn free_row(
        &mut self,
        hand: Hand,
        branch: &Branch,
        place: &Place,
        from_m: [f64; 2],
        share: f64,
    ) -> Row {
        let front = -hand.sign() * branch.free_front * (1.0 - share);
        let mut loop_ = rectangle(self.p, front, branch.neighbour);
        if let Some(outline) = &branch.end.outline {
            for (point, own) in loop_.iter_mut().zip(outline) {
                *point = [0, 1].map(|c| point[c] + (own[c] - point[c]) * share);
            }
        }
        let size = |from: f64, half: f64| from + (2.0 * half - from) * share;
        self.ring(
            place,
            &loop_,
            size(from_m[0], branch.end.half_width_m),
            size(from_m[1], branch.end.half_depth_m),
        )
    }

    fn loop_of(&self, section: Rectangle) -> Vec<[f64; 2]> {
        let unit = rectangle(self.p, 0.0, section.neighbour_m / section.width_m);
        unit.into_iter()
            .map(|[x, y]| [x * section.width_m, y * section.depth_m])
            .collect()
    }

    fn layer(&mut self, place: &Place, section: Rectangle) -> Row {
        let loop_ = self.loop_of(section);
        self.ring(place, &loop_, 1.0, 1.0)
    }

    /// A closed loop of new points: column 2n is column 0.
    fn ring(&mut self, place: &Place, loop_: &[[f64; 2]], width_m: f64, depth_m: f64) -> Row {
        let mut row: Row = loop_
            .iter()
            .map(|&[x, y]| self.push(place.at(x * width_m, y * depth_m, 0.0)))
            .collect();
        row.push(row[0]);
        row
    }

    fn push(&mut self, point: Point3) -> usize {
        self.pool.push(point);
        self.pool.len() - 1
    }

    /// Knots, net, table and ties from the tubes that each leaf passes, the stem first.
    fn assemble(&self, leaves: &[Vec<usize>]) -> Result<BranchingSurface, BranchError> {
        let loop_ = 2 * arc_columns(self.p) + 1;
        let parts = self.counts.len();
        let rows: usize = self.counts.iter().sum();
        let mut places: Vec<Vec<usize>> = vec![Vec::new(); self.pool.len()];
        let mut points = Vec::with_capacity(leaves.len() * loop_ * rows);
        for leaf in leaves {
            for column in 0..loop_ {
                for row in leaf
                    .iter()
                    .rev()
                    .flat_map(|&tube| self.tubes[tube].iter().rev())
                {
                    places[row[column]].push(points.len());
                    points.push(self.pool[row[column]]);
                }
            }
        }
        let knots_u = knots(
            self.p,
            leaves
                .iter()
                .flat_map(|_| [(self.p + 3, self.p), (self.p + 3, self.p + 1)]),
        )?;
        let (q, counts) = (self.q, &self.counts);
        let knots_v = knots(q, counts.iter().rev().map(|count| (count - q, q + 1)))?;
        let net =
            ControlNet::new(leaves.len() * loop_, rows, points).map_err(SurfaceError::from)?;
        let surface = Surface::new(knots_u, knots_v, net, None)?;
        let of_part = |part: usize| leaves.iter().map(|leaf| leaf[parts - 1 - part]).collect();
        let patches = PatchTable::new(&surface, &Groups((0..parts).map(of_part).collect()))?;
        let ties = places
            .into_iter()
            .filter(|places| places.len() > 1)
            .collect();
        Ok(BranchingSurface {
            surface,
            patches,
            ties,
        })
    }
}

/// The half of a loop that a hand keeps, and the stroke of the fork: both from a front joint to a
/// front joint.
fn join_arcs(hand: Hand, outline: &Row, stroke: &Row) -> Row {
    let n = stroke.len() - 1;
    match hand {
        Hand::Left => outline[..n].iter().chain(stroke).copied().collect(),
        Hand::Right => stroke[1..]
            .iter()
            .rev()
            .chain(&outline[n..])
            .copied()
            .collect(),
    }
}

/// Frame and width (m) of the first tilted row.
fn tilted(hand: Hand, branch: &Branch, fork: &Place) -> (Place, f64) {
    let sign = hand.sign();
    let corner = |[away, up]: [f64; 2]| (sign * away, up);
    let ((ox, oz), (ix, iz)) = (corner(branch.outer_m), corner(branch.inner_m));
    // From left to right: towards the arch on the left, away from it on the right.
    let (dx, dz) = (sign * (ox - ix), sign * (oz - iz));
    let width_m = (dx * dx + dz * dz).sqrt();
    let x: Vector3 = fork.x * (dx / width_m) + fork.z * (dz / width_m);
    let z: Vector3 = fork.z * (dx / width_m) - fork.x * (dz / width_m);
    (
        Place {
            origin: fork.at(0.5 * (ox + ix), 0.0, 0.5 * (oz + iz)),
            x,
            y: fork.y,
            z,
        },
        width_m,
    )
}

/// Clamped knots of pieces in a row: spans of length 1, and the multiplicity of the knot after each
/// piece.
fn knots(
    degree: usize,
    pieces: impl Iterator<Item = (usize, usize)>,
) -> Result<KnotVector, BranchError> {
    let mut knots = vec![0.0; degree + 1];
    let mut at = 0;
    for (spans, multiplicity) in pieces {
        knots.extend((at + 1..at + spans).map(|k| k as f64));
        at += spans;
        knots.extend(std::iter::repeat_n(at as f64, multiplicity));
    }
    Ok(KnotVector::new(degree, knots)?)
}
