//! How a piece of a body goes on from it: each of its coordinates and points of flow takes over what the matter at its
//! place had.
//!
//! Both bodies stand in the world at rest, so that the same place is the same matter. A coordinate at X goes to
//! X + Σ w (x − X_w), with the shares w of the cell that holds X, which gives any affine motion exactly; so do velocities.
//! Control points of a body without flow are moved so that the skin moves as it did: [`super::skin_motion`].

use super::bins::Bins;
use super::deformable::Deformable;
use super::elements::continuum::{CellCarry, SpringCarry};
use super::elements::spring_table::SpringTable;
use super::matter::Matter;
use super::node_map::SparseRows;
use super::plastic::Flow;
use super::sheet_carry::{Affine, carried};
use super::skin_motion::{ByCells, SkinMotion, by_cells};
use super::state::DeformableState;
use super::tetrahedra::Tetrahedra;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;

/// Springs within this of each other, relative to the mean length of those that are carried over, are of the same matter.
const NEAR: f64 = 1.5;
/// Squares below which two springs are one: of the distance of their middles, relative to that, and of the sine between them.
const SAME: f64 = 1e-18;
/// How much more a spring along another counts than one across it: cos² to this power.
const ALONG: i32 = 8;

/// What a piece takes over from the body that it was a part of.
#[derive(Debug)]
pub struct Transfer {
    /// (coordinates of the piece) × (coordinates of the body).
    places: SparseRows,
    /// Of membranes.
    affine: Option<Affine>,
    /// Of those of the net, and of those inside with them.
    skin: Option<SkinMotion>,
    flow: Option<FlowCarry>,
}

/// What flow has come to.
#[derive(Debug)]
enum FlowCarry {
    /// (springs of the piece) × (springs of the body).
    Springs(SparseRows),
    Cells(CellCarry),
    /// Of a piece in which no continuum has cells.
    CellsToSprings(SpringCarry),
}

impl Transfer {
    /// From a body and a piece, and their surfaces at rest. `None` where the body has no cells, or not of the piece's kind.
    pub fn new(
        body: &Deformable,
        piece: &Deformable,
        surfaces: Option<[&Surface; 2]>,
    ) -> Option<Self> {
        let (old, new) = (body.matter(), piece.matter());
        let nodes = old.map.nodes(&old.rest);
        let cells = Tetrahedra::new(&old.cells, &nodes)?;
        let flow = match (&old.flow, &new.flow) {
            (Some(Flow::Springs(_)), Some(Flow::Springs(_))) => {
                Some(FlowCarry::Springs(springs(old, new)))
            }
            (Some(Flow::Cells(_)), Some(Flow::Cells(_))) => {
                let (old, new) = (old.law.continuum.as_ref(), new.law.continuum.as_ref());
                Some(FlowCarry::Cells(CellCarry::new(old?, new?)))
            }
            (Some(Flow::Cells(_)), Some(Flow::Springs(_))) => {
                let springs = lines(&new.law.springs, &new.map.nodes(&new.rest));
                let solid = old.law.continuum.as_ref()?;
                Some(FlowCarry::CellsToSprings(SpringCarry::new(solid, &springs)))
            }
            _ => None,
        };
        // What has flowed is as smooth as what cells take over, and its skin would spring back to that.
        let surfaces = surfaces.filter(|_| flow.is_none());
        Some(Self {
            places: SparseRows::new(new.rest.iter().map(|place| by_cells(&cells, old, place))),
            affine: None,
            skin: surfaces.and_then(|surfaces| SkinMotion::new([body, piece], surfaces, &cells)),
            flow,
        })
    }

    /// From a membrane to a piece of it, each with its surface at rest.
    pub fn of_membrane(
        body: (&Deformable, &Surface),
        piece: (&Deformable, &Surface),
    ) -> Option<Self> {
        let (old, new) = (body.0.matter(), piece.0.matter());
        let flow = match (&old.flow, &new.flow) {
            (Some(Flow::Springs(_)), Some(Flow::Springs(_))) => {
                Some(FlowCarry::Springs(springs(old, new)))
            }
            _ => None,
        };
        let (places, affine) = carried(body, piece)?;
        Some(Self {
            places,
            affine: Some(affine),
            skin: None,
            flow,
        })
    }

    /// Fills the state of a piece, which is its initial one, from that of the body; nothing is allocated. Coordinates that are
    /// held stay where they are at rest.
    pub fn carry(
        &self,
        bodies: [&Deformable; 2],
        old: &DeformableState,
        new: &mut DeformableState,
    ) {
        let [body, piece] = bodies.map(Deformable::matter);
        debug_assert_eq!(self.places.rows(), piece.rest.len(), "a row a coordinate");
        debug_assert_eq!(
            old.positions.len(),
            body.rest.len(),
            "a state of another body"
        );
        let fields = self.affine.as_ref().map(|affine| {
            let moved = old
                .positions
                .iter()
                .zip(&body.rest)
                .map(|(x, rest)| x - rest);
            let velocities = old.velocities.iter().copied();
            let fields = [
                affine.of(&body.rest, moved),
                affine.of(&body.rest, velocities),
            ];
            (affine, fields)
        });
        let by_cells = ByCells {
            places: &self.places,
            body,
            old,
        };
        for &c in &piece.coordinate_of_unknown {
            let c = c as usize;
            let [mut moved, mut velocity] = by_cells.motion(&self.places, c);
            if let Some((affine, [places, velocities])) = &fields {
                moved += affine.missed(c, places);
                velocity += affine.missed(c, velocities);
            }
            new.positions[c] = piece.rest[c] + moved;
            new.velocities[c] = velocity;
        }
        if let Some(skin) = &self.skin {
            skin.carry(piece, &by_cells, new);
        }
        match &self.flow {
            Some(FlowCarry::Springs(rows)) => carry_springs(rows, [body, piece], old, new),
            Some(FlowCarry::Cells(cells)) => cells.carry(
                (&old.rest_lengths, &old.plastic_strain),
                (&mut new.rest_lengths, &mut new.plastic_strain),
            ),
            Some(FlowCarry::CellsToSprings(springs)) => {
                let first = piece.law.springs.rest();
                springs.each(
                    (&old.rest_lengths, &old.plastic_strain),
                    |spring, ratio, strain| {
                        let (block, place) = (spring / 4, spring % 4);
                        new.rest_lengths[block][place] = first[block][place] * ratio;
                        new.plastic_strain[block][place] = strain;
                    },
                );
            }
            None => {}
        }
    }
}

/// Lengths without force keep their ratio to those at first.
fn carry_springs(
    rows: &SparseRows,
    [body, piece]: [&Matter; 2],
    old: &DeformableState,
    new: &mut DeformableState,
) {
    let (first, mine) = (body.law.springs.rest(), piece.law.springs.rest());
    for spring in 0..rows.rows() {
        let (columns, weights) = rows.row(spring);
        let (block, place) = (spring / 4, spring % 4);
        if columns.is_empty() {
            continue;
        }
        let (mut ratio, mut strain) = (0.0, 0.0);
        for (&from, &weight) in columns.iter().zip(weights) {
            let (block, place) = (from as usize / 4, from as usize % 4);
            ratio += weight * old.rest_lengths[block][place] / first[block][place];
            strain += weight * old.plastic_strain[block][place];
        }
        new.rest_lengths[block][place] = mine[block][place] * ratio;
        new.plastic_strain[block][place] = strain;
    }
}

/// Middles, directions and numbers of springs at rest.
fn lines(table: &SpringTable, nodes: &[Point3]) -> Vec<(usize, Point3, Vector3)> {
    let line = |(block, place, a, b, _): (usize, usize, usize, usize, f64)| {
        let along = (nodes[b] - nodes[a]).try_normalize(0.0)?;
        Some((
            4 * block + place,
            nalgebra::center(&nodes[a], &nodes[b]),
            along,
        ))
    };
    table.each().filter_map(line).collect()
}

/// For each spring of the piece those of the body around it, the more they are along it.
fn springs(old: &Matter, new: &Matter) -> SparseRows {
    let [old_nodes, new_nodes] = [old, new].map(|matter| matter.map.nodes(&matter.rest));
    let from = lines(&old.law.springs, &old_nodes);
    let lengths = old
        .law
        .springs
        .each()
        .map(|(_, _, a, b, _)| (old_nodes[b] - old_nodes[a]).norm());
    let near_m = NEAR * lengths.sum::<f64>() / from.len().max(1) as f64;
    let bins = Bins::new(near_m, from.iter().map(|line| line.1));
    let mut rows = vec![Vec::new(); 4 * new.law.springs.rest().len()];
    for (spring, middle, along) in lines(&new.law.springs, &new_nodes) {
        let row: &mut Vec<(u32, f64)> = &mut rows[spring];
        let mut same = None;
        bins.around(&middle, |k| {
            let (other, place, line) = &from[k];
            let away = (place - middle).norm_squared() / (near_m * near_m);
            let cosine = along.dot(line);
            if away < SAME && along.cross(line).norm_squared() < SAME {
                same = Some(*other as u32);
            }
            if away < 1.0 {
                row.push((*other as u32, (1.0 - away) * (cosine * cosine).powi(ALONG)));
            }
        });
        if let Some(same) = same {
            *row = vec![(same, 1.0)];
        }
        let sum: f64 = row.iter().map(|entry| entry.1).sum();
        if sum > 0.0 {
            row.iter_mut().for_each(|entry| entry.1 /= sum);
        } else {
            row.clear();
        }
    }
    SparseRows::new(rows)
}

/// A solid as it stands: where its matter is at rest.
#[derive(Debug)]
pub struct Deformed {
    cells: Tetrahedra,
    /// (nodes), m.
    rest: Vec<Point3>,
}

impl Deformed {
    /// Of a body with its coordinates at these places, m; `None` where it has no cells, or none with a volume.
    pub fn new(body: &Deformable, coordinates: &[Point3]) -> Option<Self> {
        Some(Self {
            cells: Tetrahedra::new(body.cells(), &body.nodes(coordinates))?,
            rest: body.nodes(body.rest()),
        })
    }

    /// Where at rest the matter is that is at a place now, m; outside of the cells as the nearest says.
    pub fn at_rest(&self, now: &Point3) -> Point3 {
        let shares = self.cells.shares(now).into_iter();
        Point3::from(
            shares
                .map(|(node, share)| self.rest[node as usize].coords * share)
                .sum::<Vector3>(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::through_skin::tests::egg;
    use super::*;
    use crate::scene::{Scene, file};
    use palpate_geometry::basis::KnotVector;
    use palpate_geometry::math::Random;
    use std::path::Path;

    fn scene(model: &str) -> Scene {
        let surface = egg();
        let net = surface.net();
        let rows: Vec<Vec<[f64; 3]>> = (net.points().chunks(net.columns()))
            .map(|row| row.iter().map(|p| p.coords.into()).collect())
            .collect();
        let [u, v] = [surface.knots_u(), surface.knots_v()].map(KnotVector::file_knots);
        let text = format!(
            "[[body]]\nid = \"egg\"\nmodel = \"{model}\"\nlattice = {{ refine = \"none\" }}\n[body.surface.inline]\n\
             format = \"palpate.surface.v1\"\nunit = \"m\"\ndegree = [3, 3]\nperiodic = [true, false]\n\
             knots = [{u:?}, {v:?}]\npoints = {rows:?}\n"
        );
        let loaded = file::parse(&text, "scene.toml", Path::new(".")).unwrap();
        loaded.build().unwrap()
    }

    /// A body moved at random by up to a length and a speed, and what a body like it takes over from it.
    fn taken_over(model: &str, most_m: f64) -> [DeformableState; 2] {
        let scene = scene(model);
        let (body, surface) = (scene.deformable(0).unwrap(), scene.rest_surface(0).unwrap());
        let transfer = Transfer::new(body, body, Some([surface; 2])).unwrap();
        assert!(transfer.skin.is_some(), "{model}");
        let (mut old, mut new) = (body.rest_state(), body.rest_state());
        let mut random = Random(5);
        let mut next = || random.vector() * most_m;
        old.positions.iter_mut().for_each(|p| *p += next());
        old.velocities.iter_mut().for_each(|v| *v = next());
        transfer.carry([body, body], &old, &mut new);
        [old, new]
    }

    // A piece with the surface of the whole body changes by no more than rounding. Coordinates inside a body of model `net` are not
    // nodes, so there only control points are exact.
    #[test]
    fn a_body_takes_itself_over() {
        for model in ["lattice", "continuum", "net"] {
            let [old, new] = taken_over(model, 1e-4);
            let scene = scene(model);
            let matter = scene.deformable(0).unwrap().matter();
            let mut looked_at = matter.coordinate_of_control.clone();
            if model != "net" {
                looked_at = (0..matter.rest.len() as u32).collect();
            }
            for c in looked_at.into_iter().map(|c| c as usize) {
                let off = (new.positions[c] - old.positions[c]).norm();
                let faster = (new.velocities[c] - old.velocities[c]).norm();
                assert!(off < 1e-15, "{model}, coordinate {c}: {off:e} m");
                assert!(faster < 1e-15, "{model}, coordinate {c}: {faster:e} m/s");
            }
        }
    }

    // Cells that are turned over already stay as they are in the body.
    #[test]
    fn a_body_with_cells_turned_over_takes_itself_over() {
        let [old, new] = taken_over("lattice", 1e-2);
        let places = old.positions.iter().zip(&new.positions);
        let off = places.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(off < 1e-10, "{off:e} m");
    }
}
