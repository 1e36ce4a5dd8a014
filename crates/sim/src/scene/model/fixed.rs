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

/// A coordinate is held with this share of the nodes that it moves. Smooth coordinates that are held reach
/// their full stiffness only a span farther in; at a half, a `net` on the teardrop was 15 to 30 %
/// too soft, at a twentieth up to 30 % too stiff.
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
    let mut fixed = vec![false; coordinates.len()];
    let behind = |fixed: &mut Vec<bool>, point: Point3, normal: Vector3| {
        for (flag, place) in fixed.iter_mut().zip(coordinates) {
            *flag |= (place - point).dot(&normal) <= 0.0;
        }
        if let Some(moved) = moved {
            moved.behind(&point, &normal, fixed);
        }
    };
    for (point, normal) in planes(body) {
        behind(&mut fixed, point, normal);
    }
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

/// How much stiffer than what they are made of cells are that a plane cuts which holds the body: what gives way is their
/// part in front of it, while their nodes give way from those that are held on.
///
/// Without it the force on the teardrop, held at 11 … 23 mm, rises in steps of 20 to 40 % where it should rise by 5 %
/// for each millimetre.
pub(super) fn firmness(
    body: &Inputs<'_>,
    cells: &[Cell],
    moved: &Moved<'_>,
    coordinates: &[Point3],
    fixed: &[bool],
) -> Vec<f64> {
    let planes = planes(body);
    let height_m = |point: &Point3| {
        let of_plane = |(at, normal): &(Point3, Vector3)| (point - at).dot(normal);
        planes.iter().map(of_plane).fold(f64::INFINITY, f64::min)
    };
    if planes.is_empty() {
        return vec![1.0; cells.len()];
    }
    // Of smooth coordinates, those beside them make what is held give way.
    let (ahead, bent) = match (body.spec.model(), body.spec.lattice.cells_per_span) {
        (ModelSpec::Net, per_span) => ((1.0 - (per_span as f64).powi(-2)) / 3.0, BENT),
        _ => (0.0, 1.0),
    };
    let of_cell = |cell: &Cell| {
        let (mut held, mut free) = ((0.0, 0.0), (0.0, 0.0));
        let mut add = |coordinate: usize, weight: f64| {
            let to = if fixed[coordinate] { &mut held } else { &mut free };
            to.0 += weight;
            to.1 += weight * height_m(&coordinates[coordinate]);
        };
        for &node in cell {
            moved.map.each(node as usize, &mut add);
        }
        if held.0 <= LEAST * (held.0 + free.0) || free.0 <= 0.0 {
            return 1.0;
        }
        let (held_m, free_m) = (held.1 / held.0, free.1 / free.0);
        let from_m = held_m - ahead * (free_m - held_m);
        let longer = (free_m - from_m) / free_m;
        match free_m > held_m {
            true => longer.clamp(1.0 / FIRMEST, FIRMEST).powf(bent),
            false => 1.0,
        }
    };
    cells.iter().map(of_cell).collect()
}

/// The share of a cell's nodes that must be held.
const LEAST: f64 = 0.1;
/// The firmest cell, relative to its material.
const FIRMEST: f64 = 10.0;
/// Where cells of smooth coordinates are firmer, so is what bends behind them.
const BENT: f64 = 0.87;

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
