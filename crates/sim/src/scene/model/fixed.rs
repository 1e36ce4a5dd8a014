//! Which coordinates of a body never move.

use super::values::Held;
use super::{Inputs, ModelSpec};
use crate::body::{Cell, NodeMap, layers};
use crate::scene::layout::layout;
use crate::scene::spec::BuilderSpec;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ClosestSolver, Surface};

/// Parameters are in a range to within this part of the domain: those of a node below the surface
/// are found.
const FOUND: f64 = 1e-6;

/// A coordinate is held with this share of the nodes that it moves: smooth ones up to half a span in front of a plane.
const HELD: f64 = 0.1;

/// What moves with a coordinate.
pub(super) struct Moved<'a> {
    /// Nodes at rest, m.
    pub nodes: &'a [Point3],
    /// From coordinates.
    pub map: &'a NodeMap,
}

impl Moved<'_> {
    /// Marks coordinates of whose nodes a share of [`HELD`] is behind the plane.
    fn behind(&self, point: &Point3, normal: &Vector3, fixed: &mut [bool]) {
        let behind = |node: &Point3| f64::from((node - point).dot(normal) <= 0.0);
        let held: Vec<f64> = self.nodes.iter().map(behind).collect();
        let all = self.map.lumped(&vec![1.0; held.len()], fixed.len());
        let held = self.map.lumped(&held, fixed.len());
        for ((flag, held), all) in fixed.iter_mut().zip(held).zip(all) {
            *flag |= held >= HELD * all;
        }
    }
}

/// Which coordinates never move.
pub(super) fn fixed(
    body: &Inputs<'_>,
    surface: &Surface,
    coordinates: &[Point3],
    of_control: &[u32],
    moved: Option<&Moved<'_>>,
) -> Vec<bool> {
    let mut fixed = behind(&planes(body), coordinates, moved);
    for held in &body.held {
        match *held {
            Held::Behind { .. } => (),
            Held::Range { u, v } => {
                let within = |x: f64, [from, to]: [f64; 2]| x >= from && x <= to;
                let (us, vs) = (surface.knots_u().greville(), surface.knots_v().greville());
                let mut skin = vec![false; of_control.len()];
                for (control, held) in skin.iter_mut().enumerate() {
                    *held = within(us[control / vs.len()], u) && within(vs[control % vs.len()], v);
                }
                for (&coordinate, _) in of_control.iter().zip(&skin).filter(|(_, held)| **held) {
                    fixed[coordinate as usize] = true;
                }
                below(
                    body,
                    surface,
                    coordinates,
                    of_control,
                    &skin,
                    [u, v],
                    &mut fixed,
                );
            }
        }
    }
    fixed
}

/// Which coordinates planes hold.
fn behind(
    planes: &[(Point3, Vector3)],
    coordinates: &[Point3],
    moved: Option<&Moved<'_>>,
) -> Vec<bool> {
    let mut behind = vec![false; coordinates.len()];
    for (point, normal) in planes {
        for (flag, place) in behind.iter_mut().zip(coordinates) {
            *flag |= (place - point).dot(normal) <= 0.0;
        }
        if let Some(moved) = moved {
            moved.behind(point, normal, &mut behind);
        }
    }
    behind
}

/// The planes behind which a body is held: a point of each, and its normal.
fn planes(body: &Inputs<'_>) -> Vec<(Point3, Vector3)> {
    let placement = &body.placement;
    let of_body = body.held.iter().filter_map(|held| match *held {
        Held::Behind { point, normal } => Some((placement * point, placement * normal)),
        Held::Range { .. } => None,
    });
    // A tool that cannot be built is reported where it stands.
    let of_tools = (body.tools.iter().zip(&body.scene.tools)).filter_map(|(tool, spec)| {
        match (spec.fixes_nodes, tool) {
            (true, Some(tool)) => match tool.shape {
                ToolShape::Plane { normal } => {
                    let (at, turn) = tool.start;
                    Some((at, turn * normal))
                }
                _ => None,
            },
            _ => None,
        }
    });
    of_body.chain(of_tools).collect()
}

/// How many times as stiff as their material cells are that stand between what a plane holds and what it does not: they
/// give way from the coordinates that are held on, where only what is in front of the plane should.
///
/// Without it the force on the teardrop, held up to 11 … 23 mm, rises by steps of 20 to 40 % where it should rise by
/// 5 % for each millimetre.
///
/// Nodes so near to a plane that a cell would have to be firmer than [`FIRMEST`] are held as well, and the next cells are
/// softer then.
pub(super) fn firmness(
    body: &Inputs<'_>,
    cells: &[Cell],
    moved: &Moved<'_>,
    coordinates: &[Point3],
    fixed: &mut [bool],
) -> Vec<f64> {
    let planes = planes(body);
    let height_m = |point: &Point3| {
        let of_plane = |(at, normal): &(Point3, Vector3)| (point - at).dot(normal);
        planes.iter().map(of_plane).fold(f64::INFINITY, f64::min)
    };
    if planes.is_empty() {
        return vec![1.0; cells.len()];
    }
    // What ranges hold besides stands wherever it stands.
    let mut behind = behind(&planes, coordinates, Some(moved));
    if let NodeMap::Same = moved.map {
        hold_near(cells, coordinates, &mut behind, height_m);
        for (flag, behind) in fixed.iter_mut().zip(&behind) {
            *flag |= behind;
        }
    }
    let firmest = match moved.map {
        NodeMap::Same => FIRMEST,
        NodeMap::Sparse(_) => FIRMEST_SMOOTH,
    };
    // Nodes beside the last smooth coordinate that is held move with the next: matter gives way from this share of the
    // distance between the two farther behind.
    let gives_way = match body.spec.model() {
        ModelSpec::Net => (1.0 - (body.spec.lattice.cells_per_span as f64).powi(-2)) / 3.0,
        _ => 0.0,
    };
    // (coordinates that are held): the lowest node that moves beside them, m; at the end of a body none does.
    let mut lowest_m = vec![f64::INFINITY; coordinates.len()];
    for (node, place) in moved.nodes.iter().enumerate() {
        let (mut moves, height_m) = (false, height_m(place));
        (moved.map).each(node, |c, weight| moves |= weight > 0.0 && !behind[c]);
        if moves {
            (moved.map).each(node, |c, _| lowest_m[c] = lowest_m[c].min(height_m));
        }
    }
    let of_cell = |cell: &Cell| {
        let (mut held, mut free) = (Nearest::default(), Nearest::default());
        for &node in cell {
            moved.map.each(node as usize, |c, weight| {
                let to = if behind[c] { &mut held } else { &mut free };
                to.add(weight, height_m(&coordinates[c]), lowest_m[c]);
            });
        }
        if held.whole <= LEAST * (held.whole + free.whole) || free.whole <= 0.0 {
            return 1.0;
        }
        let (held_m, free_m) = (held.height_m(), free.height_m());
        let apart_m = free_m - held_m;
        let ends = held.lowest_m > held_m + AT_END * apart_m;
        let length_m = apart_m * (1.0 + if ends { 0.0 } else { gives_way });
        match length_m > 0.0 {
            true => (length_m / free_m.max(0.0)).clamp(1.0 / firmest, firmest),
            false => 1.0,
        }
    };
    cells.iter().map(of_cell).collect()
}

/// Holds nodes in front of planes that are at most a part of 1 / [`FIRMEST`] of the way from what is held; none where that
/// would hold all.
fn hold_near(
    cells: &[Cell],
    nodes: &[Point3],
    behind: &mut [bool],
    height_m: impl Fn(&Point3) -> f64,
) {
    let mut near = behind.to_vec();
    for cell in cells {
        let (mut sum_m, mut held) = (0.0, 0.0);
        for &node in cell.iter().filter(|&&node| behind[node as usize]) {
            sum_m += height_m(&nodes[node as usize]);
            held += 1.0;
        }
        let held_m = sum_m / held;
        for &node in cell.iter().filter(|&&node| !behind[node as usize]) {
            let free_m = height_m(&nodes[node as usize]);
            near[node as usize] |= held > 0.0 && free_m * FIRMEST < free_m - held_m;
        }
    }
    if !near.iter().all(|held| *held) {
        behind.copy_from_slice(&near);
    }
}

/// The share of a cell's nodes that must be held.
const LEAST: f64 = 0.1;
/// The firmest cell, relative to its material.
const FIRMEST: f64 = 3.0;
/// The firmest cell of a body with smooth coordinates, which are not held for being near a plane.
const FIRMEST_SMOOTH: f64 = 10.0;

/// No node moves so near to what is held, relative to the distance of what is not.
const AT_END: f64 = 0.1;

/// The height of the coordinates that move a cell most.
struct Nearest {
    whole: f64,
    cubes: f64,
    sum: f64,
    lowest_m: f64,
}

impl Default for Nearest {
    fn default() -> Self {
        Self {
            whole: 0.0,
            cubes: 0.0,
            sum: 0.0,
            lowest_m: f64::INFINITY,
        }
    }
}

impl Nearest {
    fn add(&mut self, weight: f64, height_m: f64, lowest_m: f64) {
        self.lowest_m = self.lowest_m.min(lowest_m);
        let cube = weight * weight * weight;
        self.whole += weight;
        self.cubes += cube;
        self.sum += cube * height_m;
    }

    fn height_m(&self) -> f64 {
        self.sum / self.cubes
    }
}

/// Holds what lies below held control points: through the whole thickness of a sheet, and in a body
/// with an axis the section within a ring that is held all around. Held by its skin alone, a beam
/// would swing like a door.
fn below(
    body: &Inputs<'_>,
    surface: &Surface,
    coordinates: &[Point3],
    of_control: &[u32],
    skin: &[bool],
    ranges: [[f64; 2]; 2],
    fixed: &mut [bool],
) {
    let count = of_control.iter().max().map_or(0, |&last| last as usize + 1);
    if coordinates.len() == count {
        return;
    }
    let (lattice, layers) = (&body.spec.lattice, body.spec.layers());
    let layered = lattice.builder == BuilderSpec::Layers || body.spec.model() == ModelSpec::Net;
    match layout(surface, &surface.topology()) {
        // Layers are copies of the net, one after the other.
        None if layered => {
            for coordinate in count..coordinates.len() {
                fixed[coordinate] |= fixed[coordinate % count];
            }
        }
        None => {
            let mut solver = ClosestSolver::new(surface);
            let within = |x: f64, [from, to]: [f64; 2], (start, end): (f64, f64)| {
                let slack = FOUND * (end - start);
                x >= from - slack && x <= to + slack
            };
            let (us, vs) = (surface.knots_u().domain(), surface.knots_v().domain());
            for (place, held) in coordinates.iter().zip(fixed).skip(count) {
                let foot = solver.closest(surface, place);
                *held |= within(foot.u, ranges[0], us) && within(foot.v, ranges[1], vs);
            }
        }
        Some(rings) if layered => {
            let node = layers::ring_nodes(&rings, layers);
            let (around, along) = (rings.around, rings.along);
            for j in (0..along).filter(|&j| (0..around).all(|i| skin[rings.control(i, j)])) {
                for layer in 1..=layers {
                    let first = (layer * along + j) * around;
                    for &inner in &node[first..first + around] {
                        fixed[inner as usize] = true;
                    }
                }
            }
        }
        Some(_) => (),
    }
}
