//! How the skin of a piece takes over the motion of the skin that was there.
//!
//! ```text
//! places on the new skin ─▶ how the matter there moves, on the old skin or inside ─▶ control points that fit ─▶ nodes inside
//! ```
//! A control point is no matter: it lies beside the skin, which moves less than it. So the motion is looked up at places on the
//! skin, and the control points are those whose skin moves so.

use super::cells::{Cell, EDGES, gauss_determinants, middle_determinant};
use super::deformable::Deformable;
use super::matter::Matter;
use super::node_map::{NodeMap, SparseRows};
use super::state::DeformableState;
use super::tetrahedra::Tetrahedra;
use super::through_skin::{Places, ThroughSkin};
use super::weights::coordinates_at;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ClosestSolver, Surface};
use std::collections::BTreeMap;

/// How far a coordinate of a control point may be from it, relative to the size of the surface.
const SAME: f64 = 1e-9;
/// A cell that would be left with less than this share of its volume at rest, somewhere in it, takes its coordinates halfway back to
/// where cells take them; so often at most, and the last time all the way.
const LEAST_SHARE: f64 = 0.2;
const MOST_HALVINGS: usize = 5;
/// A cell with this share of its volume in its middle is not looked at any closer.
const ENOUGH: f64 = 0.6;

/// What the coordinates of the net of a piece take over, and those inside with them.
#[derive(Debug)]
pub(super) struct SkinMotion {
    /// Coordinates of the net.
    outer: Vec<u32>,
    /// (`outer`) × (coordinates of the body): how the points of the skin move.
    points: SparseRows,
    through: ThroughSkin,
    /// (coordinates of the piece) × (coordinates of the piece): how those inside follow the net.
    inwards: SparseRows,
    /// (cells of the piece): determinants in the middle at rest.
    middles_m3: Vec<f64>,
}

/// How coordinates take over the motion of cells: (coordinates of the piece) × (coordinates of the body).
pub(super) struct ByCells<'a> {
    pub places: &'a SparseRows,
    pub body: &'a Matter,
    pub old: &'a DeformableState,
}

impl ByCells<'_> {
    /// How far a row moves, m, and how fast, m/s.
    pub fn motion(&self, rows: &SparseRows, row: usize) -> [Vector3; 2] {
        let (columns, weights) = rows.row(row);
        let (mut moved, mut velocity) = (Vector3::zeros(), Vector3::zeros());
        for (&from, &weight) in columns.iter().zip(weights) {
            let from = from as usize;
            moved += (self.old.positions[from] - self.body.rest[from]) * weight;
            velocity += self.old.velocities[from] * weight;
        }
        [moved, velocity]
    }
}

/// How the matter of a body moves at a place.
pub(super) fn by_cells(cells: &Tetrahedra, body: &Matter, place: &Point3) -> Vec<(u32, f64)> {
    let mut row = Vec::new();
    for (node, share) in cells.shares(place) {
        let add = |c: usize, w: f64| row.push((c as u32, w * share));
        body.map.each(node as usize, add);
    }
    row
}

impl SkinMotion {
    /// From a body and a piece with their surfaces at rest, and the cells of the body at rest; `None` where control points are not
    /// coordinates, or more of them are one than at poles.
    pub fn new(
        [body, piece]: [&Deformable; 2],
        [skin, new]: [&Surface; 2],
        cells: &Tetrahedra,
    ) -> Option<Self> {
        let [body, piece] = [body.matter(), piece.matter()];
        if !(has_net(body, skin) && has_net(piece, new)) {
            return None;
        }
        let of = &piece.coordinate_of_control;
        let through = ThroughSkin::new(new, of)?;
        let places = Places::new(new, of);
        let mut on_skin = OnSkin::new(body, skin, cells);
        let mut taken = vec![false; piece.rest.len()];
        let (mut outer, mut rows) = (Vec::new(), Vec::new());
        for (control, &c) in of.iter().enumerate() {
            if std::mem::replace(&mut taken[c as usize], true) {
                continue;
            }
            let mut row = Vec::new();
            for (place, weight) in places.seen(control) {
                let [u, v] = places.at(place);
                let seen = on_skin.row(place, || new.point(u, v)).iter();
                row.extend(seen.map(|&(c, w)| (c, w * weight)));
            }
            outer.push(c);
            rows.push(row);
        }
        let middle = |cell: &Cell| middle_determinant(&corners(piece, cell, &piece.rest));
        let middles_m3 = piece.cells.iter().map(middle).collect();
        Some(Self {
            inwards: inwards(piece, &taken),
            points: SparseRows::new(rows),
            outer,
            through,
            middles_m3,
        })
    }

    /// Moves the coordinates of the net, which went with the cells of the body, and those inside. Nothing is allocated.
    pub fn carry(&self, piece: &Matter, by_cells: &ByCells<'_>, new: &mut DeformableState) {
        debug_assert_eq!(self.inwards.rows(), piece.rest.len(), "another piece");
        debug_assert_eq!(self.middles_m3.len(), piece.cells.len(), "a middle a cell");
        for (row, &c) in self.outer.iter().enumerate() {
            let [moved, velocity] = by_cells.motion(&self.points, row);
            new.positions[c as usize] = Point3::from(moved);
            new.velocities[c as usize] = velocity;
        }
        (self.through).solve(&mut new.positions, |position| &mut position.coords);
        (self.through).solve(&mut new.velocities, |velocity| velocity);
        for &c in &self.outer {
            let c = c as usize;
            let moved = new.positions[c].coords;
            let free = piece.unknown(c).is_some();
            new.positions[c] = piece.rest[c] + if free { moved } else { Vector3::zeros() };
            new.velocities[c] *= f64::from(u8::from(free));
        }
        for c in 0..self.inwards.rows() {
            let (columns, weights) = self.inwards.row(c);
            for (&from, &weight) in columns.iter().zip(weights) {
                let [moved, velocity] = ahead(piece, by_cells, new, from as usize);
                if piece.unknown(c).is_some() {
                    new.positions[c] += moved * weight;
                    new.velocities[c] += velocity * weight;
                }
            }
        }
        self.go_back(piece, by_cells, new);
    }

    /// Takes coordinates of cells that were squeezed too much back to where cells take them.
    fn go_back(&self, piece: &Matter, by_cells: &ByCells<'_>, new: &mut DeformableState) {
        for round in 1..=MOST_HALVINGS {
            let keep = if round < MOST_HALVINGS { 0.5 } else { 0.0 };
            let mut all_good = true;
            for (cell, &middle_m3) in piece.cells.iter().zip(&self.middles_m3) {
                if least_share(piece, cell, middle_m3, &new.positions) >= LEAST_SHARE {
                    continue;
                }
                all_good = false;
                for (k, &node) in cell.iter().enumerate() {
                    if cell[..k].contains(&node) {
                        continue;
                    }
                    piece.map.each(node as usize, |c, _| {
                        if piece.unknown(c).is_some() {
                            let [moved, velocity] = ahead(piece, by_cells, new, c);
                            new.positions[c] -= moved * (1.0 - keep);
                            new.velocities[c] -= velocity * (1.0 - keep);
                        }
                    });
                }
            }
            if all_good {
                return;
            }
        }
    }
}

/// How far a coordinate of a piece is from where cells take it, and how much faster it is; one that is held is nowhere else.
fn ahead(piece: &Matter, by_cells: &ByCells<'_>, new: &DeformableState, c: usize) -> [Vector3; 2] {
    if piece.unknown(c).is_none() {
        return [Vector3::zeros(); 2];
    }
    let [moved, velocity] = by_cells.motion(by_cells.places, c);
    [
        new.positions[c] - piece.rest[c] - moved,
        new.velocities[c] - velocity,
    ]
}

/// The control points of a surface are coordinates of a body.
fn has_net(matter: &Matter, surface: &Surface) -> bool {
    let points = surface.net().points();
    let close_m = SAME * surface.size();
    let there = |(c, p): (&u32, &Point3)| (matter.rest[*c as usize] - p).norm() <= close_m;
    points.len() == matter.coordinate_of_control.len()
        && matter.coordinate_of_control.iter().zip(points).all(there)
}

/// Mean distance of neighbours in the net of a surface, m.
fn spacing_m(surface: &Surface) -> f64 {
    let net = surface.net();
    let (mut sum, mut count) = (0.0, 0.0);
    for (i, j) in (1..net.rows()).flat_map(|i| (1..net.columns()).map(move |j| (i, j))) {
        sum += (net.at(i, j) - net.at(i - 1, j)).norm() + (net.at(i, j) - net.at(i, j - 1)).norm();
        count += 2.0;
    }
    sum / count
}

/// Points of the skin of a piece, on the body that it was a part of.
struct OnSkin<'a> {
    body: &'a Matter,
    skin: &'a Surface,
    cells: &'a Tetrahedra,
    solver: ClosestSolver,
    /// How deep the motion of the skin reaches, m.
    reach_m: f64,
    /// Rows of places that were asked for.
    known: BTreeMap<[usize; 2], Vec<(u32, f64)>>,
}

impl<'a> OnSkin<'a> {
    fn new(body: &'a Matter, skin: &'a Surface, cells: &'a Tetrahedra) -> Self {
        Self {
            body,
            skin,
            cells,
            solver: ClosestSolver::new(skin),
            reach_m: spacing_m(skin),
            known: BTreeMap::new(),
        }
    }

    /// How the matter at a point moves: as the skin of the body there, and away from it ever more as its cells.
    fn row(&mut self, place: [usize; 2], point: impl FnOnce() -> Point3) -> &[(u32, f64)] {
        let Self {
            body,
            skin,
            cells,
            solver,
            reach_m,
            known,
        } = self;
        known.entry(place).or_insert_with(|| {
            let place = point();
            let foot = solver.closest(skin, &place);
            let mut row = by_cells(cells, body, &place);
            let share = share_of_skin(foot.distance / *reach_m);
            if share > 0.0 {
                let inside = by_cells(cells, body, &foot.point).into_iter();
                row.extend(inside.map(|(c, weight)| (c, -share * weight)));
                let outside =
                    coordinates_at(skin, [foot.u, foot.v], &body.coordinate_of_control).into_iter();
                row.extend(outside.map(|(c, weight)| (c, share * weight)));
            }
            row
        })
    }
}

/// 1 on the skin, 0 from as deep as it reaches; smooth.
fn share_of_skin(depth: f64) -> f64 {
    let inner = (1.0 - depth * depth).max(0.0);
    inner * inner
}

/// How nodes inside a piece follow its net: those next to it most, those farthest inside not at all. Where nodes are not the
/// coordinates, coordinates inside stay.
fn inwards(piece: &Matter, outer: &[bool]) -> SparseRows {
    let count = piece.rest.len();
    if piece.map != NodeMap::Same {
        return SparseRows::new(vec![Vec::new(); count]);
    }
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); count];
    for cell in &piece.cells {
        for [a, b] in EDGES.map(|edge| edge.map(|corner| cell[corner] as usize)) {
            if a != b {
                beside[a].push(b);
                beside[b].push(a);
            }
        }
    }
    let mut depth: Vec<Option<usize>> = outer.iter().map(|outer| outer.then_some(0)).collect();
    let mut levels = vec![(0..count).filter(|&c| outer[c]).collect::<Vec<usize>>()];
    while let Some(last) = levels.last().filter(|level| !level.is_empty()) {
        let mut next = Vec::new();
        for &node in last.iter().flat_map(|&node| &beside[node]) {
            if depth[node].is_none() {
                depth[node] = Some(levels.len());
                next.push(node);
            }
        }
        levels.push(next);
    }
    let deepest = levels.len().saturating_sub(2);
    let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); count];
    // Shares of the net, level by level, before they fade.
    for (level, nodes) in levels.iter().enumerate().take(deepest) {
        for &node in nodes {
            if level == 0 {
                rows[node] = vec![(node as u32, 1.0)];
                continue;
            }
            let mut from: Vec<usize> = beside[node].clone();
            from.retain(|&other| depth[other] == Some(level - 1));
            let share = 1.0 / from.len() as f64;
            let shares = from.iter().flat_map(|&other| &rows[other]);
            rows[node] = shares.map(|&(c, weight)| (c, weight * share)).collect();
        }
    }
    for (node, row) in rows.iter_mut().enumerate() {
        let fade = match depth[node] {
            Some(level) if level > 0 => 1.0 - level as f64 / deepest as f64,
            _ => 0.0,
        };
        row.iter_mut().for_each(|entry| entry.1 *= fade);
    }
    SparseRows::new(rows)
}

/// Where the corners of a cell are.
fn corners(piece: &Matter, cell: &Cell, coordinates: &[Point3]) -> [Point3; 8] {
    cell.map(|node| {
        let mut sum = Vector3::zeros();
        let add = |c: usize, weight: f64| sum += coordinates[c].coords * weight;
        piece.map.each(node as usize, add);
        Point3::from(sum)
    })
}

/// The least that a cell has of its volume at rest, over the places where it is integrated; of one that has enough in the middle,
/// what it has there.
fn least_share(piece: &Matter, cell: &Cell, middle_m3: f64, coordinates: &[Point3]) -> f64 {
    let now = corners(piece, cell, coordinates);
    let in_middle = middle_determinant(&now) / middle_m3;
    if in_middle >= ENOUGH {
        return in_middle;
    }
    let rest = gauss_determinants(&corners(piece, cell, &piece.rest));
    let shares = rest
        .iter()
        .zip(gauss_determinants(&now))
        .map(|(rest, now)| now / rest);
    shares.fold(f64::INFINITY, f64::min)
}
