//! The patch table: what each rectangle of the domain draws, and which rectangles draw the same.
//!
//! u falls into leaves of two arcs, v into parts, the tops first. A block (leaf, part) draws the
//! section of the tube that the leaf passes in that part: a tube under m leaves is drawn m times.

use super::error::BranchError;
use palpate_geometry::basis::{KnotVector, Side};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{SAME_POINT, Surface};
use serde::Serialize;

/// One rectangle of the domain: an arc of a leaf in a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Patch {
    /// The tube that it draws: `stem`, then a letter for each fork passed, as in `LR`.
    pub node: String,
    /// Leaf, from left to right.
    pub leaf: usize,
    /// Part of v, the tops first.
    pub part: usize,
    /// 1: from the front joint by the left to the back joint; 2: back by the right.
    pub arc: usize,
    /// Range of u.
    pub u: [f64; 2],
    /// Range of v.
    pub v: [f64; 2],
    /// First and last control point in u.
    pub columns: [usize; 2],
    /// First and last control point in v.
    pub rows: [usize; 2],
    /// Place in the table of the patch that this one repeats.
    pub duplicate_of: Option<usize>,
}

/// All patches: by part, leaf and arc.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatchTable {
    /// Number of leaves.
    pub leaves: usize,
    /// Number of parts.
    pub parts: usize,
    /// (parts × leaves × 2)
    pub patches: Vec<Patch>,
}

/// By part (the tops first) and leaf: equal numbers draw the same section.
pub(super) struct Groups(pub Vec<Vec<usize>>);

/// A piece of a knot vector between knots where the surface creases or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
struct NetPiece {
    range: [f64; 2],
    points: [usize; 2],
    /// The knot after it has full multiplicity.
    disjoined: bool,
}

impl PatchTable {
    pub(super) fn new(surface: &Surface, groups: &Groups) -> Result<Self, BranchError> {
        let arcs = arcs(surface)?;
        let parts = parts(surface)?;
        let leaves = arcs.len() / 2;
        let names = names(&groups.0);
        let mut patches: Vec<Patch> = Vec::with_capacity(2 * leaves * parts.len());
        for (part, piece_v) in parts.iter().enumerate() {
            for leaf in 0..leaves {
                let first = groups.0[part]
                    .iter()
                    .position(|&group| group == groups.0[part][leaf])
                    .unwrap_or(leaf);
                for arc in 0..2 {
                    let piece_u = arcs[2 * leaf + arc];
                    patches.push(Patch {
                        node: names[part][leaf].clone(),
                        leaf,
                        part,
                        arc: arc + 1,
                        u: piece_u.range,
                        v: piece_v.range,
                        columns: piece_u.points,
                        rows: piece_v.points,
                        duplicate_of: (first < leaf).then_some(2 * (part * leaves + first) + arc),
                    });
                }
            }
        }
        Ok(Self {
            leaves,
            parts: parts.len(),
            patches,
        })
    }

    /// The table of any surface with the knots of a branching net; blocks whose control points are
    /// at the same places (within 1e-9 of the size) are one.
    ///
    /// # Errors
    /// Weights, a size beyond 1e±60 m, knots that are not clamped, arcs that do not come in pairs,
    /// leaves of different shape, or rule R5: a knot in v that creases where it should disjoin.
    pub fn recovered(surface: &Surface) -> Result<Self, BranchError> {
        if surface.weights().is_some() {
            return Err(not_branched(
                "the surface is rational".to_owned(),
                "branching nets have no weights",
            ));
        }
        // Volumes are taken of it.
        if !(surface.size() > 1e-60 && surface.size() < 1e60) {
            let what = format!("its size is {:e} m", surface.size());
            return Err(not_branched(
                what,
                "scale it to something between 1e-60 and 1e60 m",
            ));
        }
        let arcs = arcs(surface)?;
        let parts = parts(surface)?;
        let tolerance = SAME_POINT * surface.size();
        let same = |part: &NetPiece, a: usize, b: usize| {
            (0..2).all(|arc| {
                deviation(surface, arcs[2 * a + arc], arcs[2 * b + arc], part) <= tolerance
            })
        };
        let group = |part: &NetPiece| {
            let mut of: Vec<usize> = Vec::new();
            for leaf in 0..arcs.len() / 2 {
                of.push(
                    (0..leaf)
                        .find(|&first| of[first] == first && same(part, first, leaf))
                        .unwrap_or(leaf),
                );
            }
            of
        };
        Self::new(surface, &Groups(parts.iter().map(group).collect()))
    }

    /// The patch of an arc (1 or 2).
    pub fn patch(&self, part: usize, leaf: usize, arc: usize) -> &Patch {
        &self.patches[2 * (part * self.leaves + leaf) + arc - 1]
    }

    /// Patches that repeat no other.
    pub fn distinct(&self) -> impl Iterator<Item = &Patch> {
        self.patches
            .iter()
            .filter(|patch| patch.duplicate_of.is_none())
    }

    /// Greatest distance of control points of a copy from those of its original, m: 0 when copies
    /// are equal bit for bit.
    pub fn copy_deviation_m(&self, surface: &Surface) -> f64 {
        let of = |patch: &Patch| self.control_points(surface, patch);
        self.patches
            .iter()
            .filter_map(|patch| Some((patch, &self.patches[patch.duplicate_of?])))
            .flat_map(|(copy, original)| {
                of(copy)
                    .zip(of(original))
                    .map(|(a, b)| (a - b).norm())
                    .collect::<Vec<_>>()
            })
            .fold(0.0, f64::max)
    }

    /// Control points of a patch, u-major.
    pub fn control_points<'a>(
        &self,
        surface: &'a Surface,
        patch: &Patch,
    ) -> impl Iterator<Item = Point3> + use<'a> {
        let ([a, b], [c, d]) = (patch.columns, patch.rows);
        (a..=b).flat_map(move |i| (c..=d).map(move |j| *surface.net().at(i, j)))
    }
}

/// Greatest distance between the control points of two arcs in a part, m.
fn deviation(surface: &Surface, a: NetPiece, b: NetPiece, part: &NetPiece) -> f64 {
    let [first, last] = a.points;
    let mut worst = 0.0_f64;
    for k in 0..=last - first {
        for j in part.points[0]..=part.points[1] {
            worst = worst.max(
                (surface.net().at(first + k, j) - surface.net().at(b.points[0] + k, j)).norm(),
            );
        }
    }
    worst
}

/// Pieces of a direction, cut at knots of multiplicity `degree` and more.
fn pieces(knots: &KnotVector) -> Vec<NetPiece> {
    let degree = knots.degree();
    let mut pieces: Vec<NetPiece> = Vec::new();
    let mut start = knots.domain().0;
    for i in knots.spans() {
        let end = knots.knots()[i + 1];
        let multiplicity = knots.multiplicity(end);
        if multiplicity >= degree {
            let points = [
                knots.span(start, Side::Right) - degree,
                knots.span(end, Side::Left),
            ];
            pieces.push(NetPiece {
                range: [start, end],
                points,
                disjoined: multiplicity > degree,
            });
            start = end;
        }
    }
    pieces
}

fn not_branched(what: String, mend: &'static str) -> BranchError {
    BranchError::NotBranched { what, mend }
}

fn clamped(knots: &KnotVector, name: char) -> Result<(), BranchError> {
    if knots.kind() == palpate_geometry::basis::KnotKind::Clamped {
        return Ok(());
    }
    Err(not_branched(
        format!("the knots in {name} are not clamped"),
        "clamp them, as leaves begin and end at points",
    ))
}

/// Arcs, two a leaf. Pieces without extent, where a last point was repeated before disjoining, are
/// passed over.
fn arcs(surface: &Surface) -> Result<Vec<NetPiece>, BranchError> {
    let knots = surface.knots_u();
    clamped(knots, 'u')?;
    let mut arcs: Vec<NetPiece> = Vec::new();
    for piece in pieces(knots) {
        let [first, last] = piece.points;
        let net = surface.net();
        let still = (first + 1..=last)
            .all(|i| (0..net.columns()).all(|j| net.at(i, j) == net.at(first, j)));
        match arcs.last_mut() {
            Some(before) if still => before.disjoined |= piece.disjoined,
            _ => arcs.push(piece),
        }
    }
    let mend = "give each leaf two arcs: multiplicity p at its back joint, p + 1 after it";
    if arcs.is_empty() || !arcs.len().is_multiple_of(2) {
        return Err(not_branched(
            format!("u has {} arcs, not two for each leaf", arcs.len()),
            mend,
        ));
    }
    if let Some(k) = (0..arcs.len()).find(|&k| arcs[k].disjoined != (k % 2 == 1)) {
        let [at, wanted] = [
            format!("{}", arcs[k].range[1]),
            format!("{}", knots.degree() + k % 2),
        ];
        return Err(not_branched(
            format!("the knot u = {at} has not multiplicity {wanted}"),
            mend,
        ));
    }
    let shape = |arc: &NetPiece| (arc.points[1] - arc.points[0], arc.range[1] - arc.range[0]);
    if let Some(other) = arcs.iter().find(|arc| shape(arc) != shape(&arcs[0])) {
        let what = format!(
            "the arc at u = {} has other points or another length than the first",
            other.range[0]
        );
        return Err(not_branched(
            what,
            "draw all arcs with the same knots, as copies must fit",
        ));
    }
    Ok(arcs)
}

/// Parts of v, each disjoined from the next.
fn parts(surface: &Surface) -> Result<Vec<NetPiece>, BranchError> {
    let knots = surface.knots_v();
    clamped(knots, 'v')?;
    let parts = pieces(knots);
    let (last, q) = (parts.len() - 1, knots.degree());
    // Two rows of a fork and q more above them, two layers below.
    if let Some(part) = parts
        .iter()
        .find(|part| parts.len() > 1 && part.points[1] - part.points[0] < q + 1)
    {
        let what = format!(
            "the part at v = {} has {} rows",
            part.range[0],
            part.points[1] - part.points[0] + 1
        );
        return Err(not_branched(
            what,
            "give it q + 2: inverted T, open book and q rows above them",
        ));
    }
    if let Some(part) = parts[..last].iter().find(|part| !part.disjoined) {
        return Err(BranchError::Rule {
            rule: super::Rule::R5,
            place: format!("the knot v = {}", part.range[1]),
            what: format!(
                "its multiplicity is {q}: inner arcs are joined to the stem by a spurious sheet"
            ),
            mend: format!("repeat it {} times and double the row", q + 1),
        });
    }
    Ok(parts)
}

/// Names of the tubes by part and leaf: a group that divides gives its halves a letter each.
fn names(groups: &[Vec<usize>]) -> Vec<Vec<String>> {
    let leaves = groups.first().map_or(0, Vec::len);
    let mut names = vec![vec!["stem".to_owned(); leaves]; groups.len()];
    for part in (0..groups.len()).rev() {
        let below: Vec<(String, usize)> = match groups.get(part + 1) {
            Some(of) => of
                .iter()
                .enumerate()
                .map(|(leaf, &group)| (names[part + 1][leaf].clone(), group))
                .collect(),
            None => vec![("stem".to_owned(), 0); leaves],
        };
        for leaf in 0..leaves {
            // Groups that stand on the same tube, in order.
            let mut beside: Vec<usize> = Vec::new();
            for other in (0..leaves).filter(|&other| below[other].1 == below[leaf].1) {
                if !beside.contains(&groups[part][other]) {
                    beside.push(groups[part][other]);
                }
            }
            let parent = if below[leaf].0 == "stem" {
                ""
            } else {
                below[leaf].0.as_str()
            };
            let place = beside
                .iter()
                .position(|&group| group == groups[part][leaf])
                .unwrap_or(0);
            names[part][leaf] = match beside.len() {
                1 => below[leaf].0.clone(),
                2 => format!("{parent}{}", ['L', 'R'][place]),
                _ => format!("{parent}{place}"),
            };
        }
    }
    names
}
