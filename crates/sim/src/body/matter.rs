//! The matter of a deforming body: what moves, what it weighs and what acts between its nodes. How it
//! steps is the business of the steppers, which are built from it.

use super::cells::{Cell, CellQuality};
use super::elements::MaterialLaw;
use super::material::Plastic;
use super::node_map::NodeMap;
use super::plastic::Flow;
use super::rigid_velocity::RigidVelocity;
use super::settings::{DeformableError, StepSettings};
use crate::body::elements::Weight;
use palpate_geometry::math::{Lane, Point3};

/// Marks a fixed coordinate where an index is expected.
pub(super) const FIXED: u32 = u32::MAX;

/// What a body is built from.
#[derive(Debug)]
pub struct Blueprint {
    /// (coordinates), m, at rest.
    pub coordinates: Vec<Point3>,
    /// Nodes from coordinates.
    pub map: NodeMap,
    /// (nodes), kg.
    pub masses: Vec<f64>,
    /// Forces between nodes.
    pub law: MaterialLaw,
    /// (control points): coordinate of each.
    pub coordinate_of_control: Vec<u32>,
    /// (coordinates): never move.
    pub fixed: Vec<bool>,
    /// Figures of the cells.
    pub quality: CellQuality,
    /// Cells between nodes, for who draws them; none of a membrane.
    pub cells: Vec<Cell>,
    /// (cells): Young's modulus, Pa.
    pub young_pa: Vec<f64>,
    /// (coordinates): volume and stiffness of the solid around each; empty for membranes and nets.
    pub grains: Vec<Grain>,
}

/// The part of a solid that a coordinate stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grain {
    /// m³.
    pub volume_m3: f64,
    /// E / (1 − ν²), Pa.
    pub plane_modulus_pa: f64,
    /// ν.
    pub poisson: f64,
}

/// A body without its step.
#[derive(Debug)]
pub(super) struct Matter {
    pub settings: StepSettings,
    pub damping_s: f64,
    /// (coordinates), m.
    pub rest: Vec<Point3>,
    pub map: NodeMap,
    pub law: MaterialLaw,
    /// (coordinates), kg.
    pub masses: Vec<f64>,
    /// (coordinates): place among those that can move, or [`FIXED`].
    pub unknown: Vec<u32>,
    /// (unknowns): coordinate.
    pub coordinate_of_unknown: Vec<u32>,
    /// (control points): coordinate of each.
    pub coordinate_of_control: Vec<u32>,
    /// Coordinates of the net that can move, ascending.
    pub surface: Vec<u32>,
    pub flow: Option<Flow>,
    /// Motion at the start, of a free body.
    pub launch: Option<RigidVelocity>,
    pub quality: CellQuality,
    pub cells: Vec<Cell>,
    /// (cells).
    pub young_pa: Vec<f64>,
    /// (coordinates), or none.
    pub grains: Vec<Grain>,
}

impl Matter {
    /// 1 + d / dt: how much stiffer a Voigt solid is within a step.
    pub fn voigt(&self) -> f64 {
        1.0 + self.damping_s / self.settings.dt_s
    }

    /// Takes a blueprint.
    ///
    /// # Errors
    /// No free coordinate, one without mass, or a combination that is not there.
    pub fn new(
        blueprint: Blueprint,
        damping_s: f64,
        plastic: Option<Plastic>,
        settings: StepSettings,
    ) -> Result<Self, DeformableError> {
        let Blueprint {
            coordinates: rest,
            map,
            masses,
            law,
            coordinate_of_control,
            fixed,
            quality,
            cells,
            young_pa,
            grains,
        } = blueprint;
        let count = rest.len();
        let masses = map.lumped(&masses, count);
        let mut unknown = vec![FIXED; count];
        let mut coordinate_of_unknown = Vec::new();
        for coordinate in (0..count).filter(|&c| !fixed[c]) {
            unknown[coordinate] = coordinate_of_unknown.len() as u32;
            coordinate_of_unknown.push(coordinate as u32);
        }
        if coordinate_of_unknown.is_empty() {
            return Err(DeformableError::AllFixed(count));
        }
        let weightless = masses
            .iter()
            .filter(|&&m| !(m > 0.0 && m.is_finite()))
            .count();
        if weightless > 0 {
            return Err(DeformableError::NoMass(weightless));
        }
        let free = |c: &u32| unknown[*c as usize] != FIXED;
        let mut surface: Vec<u32> = coordinate_of_control.iter().copied().filter(free).collect();
        surface.sort_unstable();
        surface.dedup();
        let flow = plastic
            .map(|law_of_flow| Flow::new(law_of_flow, &law, &map.nodes(&rest), settings.dt_s));
        Ok(Self {
            settings,
            damping_s,
            rest,
            map,
            law,
            masses,
            unknown,
            coordinate_of_unknown,
            coordinate_of_control,
            surface,
            flow,
            launch: None,
            quality,
            cells,
            young_pa,
            grains,
        })
    }

    /// Place of a coordinate among the free ones; `None` if it is fixed.
    pub fn unknown(&self, coordinate: usize) -> Option<usize> {
        debug_assert!(coordinate < self.rest.len(), "no such coordinate");
        let row = self.unknown[coordinate];
        (row != FIXED).then_some(row as usize)
    }

    /// True when nothing holds the body.
    pub fn is_free(&self) -> bool {
        self.coordinate_of_unknown.len() == self.rest.len()
    }

    /// Coordinates that can move.
    pub fn unknown_count(&self) -> usize {
        self.coordinate_of_unknown.len()
    }

    /// Number of lanes of plastic strains; none without flow.
    pub fn strain_lanes(&self) -> usize {
        (self.flow.as_ref()).map_or(0, |flow| flow.strain_lanes(&self.law))
    }

    /// W q, in the buffer where nodes are not the coordinates.
    pub fn nodes_of<'a>(&self, coordinates: &'a [Lane], buffer: &'a mut [Lane]) -> &'a [Lane] {
        match &self.map {
            NodeMap::Same => coordinates,
            NodeMap::Sparse(map) => {
                map.apply(coordinates, buffer);
                buffer
            }
        }
    }

    /// Where some nodes are; others are anywhere.
    pub fn some_nodes_of<'a>(
        &self,
        some: &[u32],
        coordinates: &'a [Lane],
        buffer: &'a mut [Lane],
    ) -> &'a [Lane] {
        match &self.map {
            NodeMap::Same => coordinates,
            NodeMap::Sparse(map) => {
                map.apply_some(some, coordinates, buffer);
                buffer
            }
        }
    }

    /// Entries of the step's matrix that come from the law, edges at nodes.
    pub fn law_edges(&self) -> Vec<(u32, u32, f64)> {
        self.law.edges(Weight::Bounding)
    }
}

/// Points as rows of registers, in a vector.
pub(super) fn lanes_of(points: &[Point3]) -> Vec<Lane> {
    points.iter().map(|p| [p.x, p.y, p.z, 0.0]).collect()
}

/// Points as rows of registers.
pub(super) fn lanes(points: &[Point3], out: &mut [Lane]) {
    debug_assert_eq!(points.len(), out.len(), "a lane a point");
    for (lane, p) in out.iter_mut().zip(points) {
        *lane = [p.x, p.y, p.z, 0.0];
    }
}
