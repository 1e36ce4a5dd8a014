//! A piece as a boundary: its skin on the surface, its caps on planes, edges shared.

use super::pieces::{Cut, Piece};
use super::rim::{RimEdge, RimPiece};
use super::{CutPlane, caps};
use crate::basis::KnotVector;
use crate::math::Point3;
use crate::part::{Axes, Brep, BrepBound, BrepCurve, BrepEdge, BrepFace, BrepShell, Carrier};
use crate::surface::{Curve, Direction, SurfaceError};

/// Of the size: ends of edges that are nearer are one vertex.
const SAME: f64 = 1e-10;

impl Cut {
    /// Parts have u around where only one parameter goes round: u and v of the surface change places there.
    pub(super) fn is_swapped(&self) -> bool {
        let topology = self.surface.topology();
        topology.wraps(1) && !topology.wraps(0)
    }

    /// Some pieces as a boundary, each of closed surfaces a solid, else a sheet. Faces are numbered from 1, the parts of a
    /// piece's skin first, then its caps.
    ///
    /// # Errors
    /// A surface without a curve along its border.
    ///
    /// # Panics
    /// A number that is not of a piece.
    pub fn brep(&self, pieces: &[usize]) -> Result<Brep, SurfaceError> {
        let mut maker = Maker {
            cut: self,
            brep: Brep::default(),
            same_m: SAME * self.surface.size(),
        };
        for (k, &piece) in pieces.iter().enumerate() {
            maker.add(&self.pieces[piece], k as u32)?;
        }
        Ok(maker.brep)
    }
}

struct Maker<'a> {
    cut: &'a Cut,
    brep: Brep,
    same_m: f64,
}

impl Maker<'_> {
    fn add(&mut self, piece: &Piece, number: u32) -> Result<(), SurfaceError> {
        let first = self.brep.faces.len() as u32;
        let vertices = self.brep.vertices.len();
        let mut rims: Vec<Vec<u32>> = Vec::with_capacity(piece.rims.len());
        for rim in &piece.rims {
            let edges = rim.iter().map(|edge| self.edge(edge, vertices));
            rims.push(edges.collect::<Result<_, _>>()?);
        }
        let outwards = self.cut.outwards;
        let swapped = self.cut.is_swapped();
        let surface = match swapped {
            true => self.cut.surface.swap_uv(),
            false => self.cut.surface.clone(),
        };
        let carrier = Carrier::Spline(Box::new(surface.with_flip_normal(false)));
        let along = |rim: usize| {
            let uses = rims[rim].iter().map(|&e| (e, true));
            BrepBound::Loop(uses.collect())
        };
        let against = |rim: usize| {
            let uses = rims[rim].iter().rev().map(|&e| (e, false));
            BrepBound::Loop(uses.collect())
        };
        let bound = |rim: usize, forward: bool| match forward {
            true => along(rim),
            false => against(rim),
        };
        for skin in &piece.skins {
            self.brep.faces.push(BrepFace {
                id: self.brep.faces.len() as u64 + 1,
                carrier: carrier.clone(),
                same_sense: outwards != swapped,
                bounds: skin.iter().map(|&rim| bound(rim, outwards)).collect(),
            });
        }
        for cap in &piece.caps {
            self.brep.faces.push(BrepFace {
                id: self.brep.faces.len() as u64 + 1,
                carrier: Carrier::Plane(axes(&self.cut.plane, piece.above)),
                same_sense: true,
                bounds: cap.rims.iter().map(|&rim| bound(rim, !outwards)).collect(),
            });
        }
        self.brep.shells.push(BrepShell {
            faces: (first..self.brep.faces.len() as u32).collect(),
            closed: self.cut.closed,
            solid: self.cut.closed.then_some(number),
        });
        Ok(())
    }

    /// The vertex at a point, of those of the piece.
    fn vertex(&mut self, point: Point3, first: usize) -> u32 {
        let own = &self.brep.vertices[first..];
        let known = own.iter().position(|p| (p - point).norm() <= self.same_m);
        let at = first + known.unwrap_or(own.len());
        if known.is_none() {
            self.brep.vertices.push(point);
        }
        at as u32
    }

    fn edge(&mut self, edge: &RimEdge, first: usize) -> Result<u32, SurfaceError> {
        let (curve, points, along) = match edge {
            RimEdge::Cut(pieces) => {
                let ends = [
                    pieces[0].points[0],
                    pieces[pieces.len() - 1].points[super::rim::ORDER - 1],
                ];
                (spline(pieces), ends, true)
            }
            RimEdge::Border(direction, ends) => {
                let constant = [Direction::V, Direction::U][*direction];
                let curve = self
                    .cut
                    .surface
                    .iso_curve(constant, ends[0][1 - direction])?;
                let points = ends.map(|uv| self.cut.point(uv));
                (curve, points, ends[1][*direction] > ends[0][*direction])
            }
        };
        let ends = points.map(|point| self.vertex(point, first));
        self.brep.edges.push(BrepEdge {
            id: self.brep.edges.len() as u64 + 1,
            curve: BrepCurve::Spline(curve),
            ends,
            along,
        });
        Ok(self.brep.edges.len() as u32 - 1)
    }
}

/// At the foot of the origin, z out of a piece.
fn axes(plane: &CutPlane, above: bool) -> Axes {
    let [x, y] = caps::directions(plane);
    let (y, z) = match above {
        true => (-y, -plane.normal),
        false => (y, plane.normal),
    };
    Axes {
        origin: plane.origin(),
        x,
        y,
        z,
    }
}

/// Pieces end to start as one curve, by the lengths of their chords.
fn spline(pieces: &[RimPiece]) -> Curve {
    let degree = super::rim::ORDER - 1;
    let mut points = vec![pieces[0].points[0]];
    let mut knots = vec![0.0; degree + 1];
    let mut at = 0.0;
    for piece in pieces {
        points.extend(&piece.points[1..]);
        at += (piece.points[degree] - piece.points[0]).norm();
        knots.extend(std::iter::repeat_n(at, degree));
    }
    knots.push(at);
    let knots = KnotVector::new(degree, knots).expect("chords have a length");
    Curve::new(knots, points, None).expect("points of a surface")
}
