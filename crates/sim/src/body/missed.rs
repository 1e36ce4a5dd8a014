//! What a step leaves of its own equation where contact forces act: loads that a further iteration would answer.
//!
//! Only coordinates that contact forces press are looked at, and only the cells, springs and bends about them: what is
//! left elsewhere moves the contact by little (`palpate-bench trust`), and a pass over all of a body costs a tenth of its tick.
//!
//! Gaps of pressures, J − 1 − q / λ, are not looked at: closing one presses all nodes of a cell, which hardly moves them; a
//! part of these loads alone would move them λ / μ times as far.

use super::elements::MaterialLaw;
use super::elements::continuum::Given;
use super::look_ahead::LookAhead;
use super::matter::Matter;
use super::node_map::NodeMap;
use super::scratch::DeformableScratch;
use super::state::DeformableState;
use palpate_geometry::math::{Lane, Vector3};

/// Lists, one after the other.
#[derive(Debug, Default)]
struct Lists<T> {
    starts: Vec<u32>,
    all: Vec<T>,
}

impl<T> Lists<T> {
    fn new(lists: impl Iterator<Item = Vec<T>>) -> Self {
        let (mut starts, mut all) = (vec![0], Vec::new());
        for list in lists {
            all.extend(list);
            starts.push(all.len() as u32);
        }
        Self { starts, all }
    }

    fn of(&self, k: usize) -> &[T] {
        &self.all[self.starts[k] as usize..self.starts[k + 1] as usize]
    }
}

/// What lies about the coordinates of the net, in the order of [`Matter::surface`].
#[derive(Debug, Default)]
pub(super) struct About {
    /// Nodes that a coordinate moves, and by how much.
    nodes: Lists<(u32, f64)>,
    /// [Parts](MaterialLaw::parts) of the law at these nodes, ascending.
    parts: Lists<u32>,
    /// By part: its nodes.
    nodes_of_part: Lists<u32>,
}

impl About {
    pub fn new(matter: &Matter) -> Self {
        let parts = matter.law.parts();
        let node_count = match &matter.map {
            NodeMap::Same => matter.rest.len(),
            NodeMap::Sparse(map) => map.rows(),
        };
        let mut parts_of_node: Vec<Vec<u32>> = vec![Vec::new(); node_count];
        for (part, nodes) in parts.iter().enumerate() {
            for &node in nodes {
                parts_of_node[node as usize].push(part as u32);
            }
        }
        let mut nodes_of: Vec<Vec<(u32, f64)>> = vec![Vec::new(); matter.rest.len()];
        match &matter.map {
            NodeMap::Same => {
                for (node, nodes) in nodes_of.iter_mut().enumerate() {
                    nodes.push((node as u32, 1.0));
                }
            }
            NodeMap::Sparse(map) => {
                for node in 0..map.rows() {
                    let (columns, weights) = map.row(node);
                    for (&c, &weight) in columns.iter().zip(weights) {
                        nodes_of[c as usize].push((node as u32, weight));
                    }
                }
            }
        }
        let of_place = |&c: &u32| {
            let nodes = nodes_of[c as usize].iter();
            let mut parts: Vec<u32> = nodes
                .flat_map(|(node, _)| &parts_of_node[*node as usize])
                .copied()
                .collect();
            parts.sort_unstable();
            parts.dedup();
            parts
        };
        let surface = || matter.surface.iter();
        Self {
            nodes: Lists::new(surface().map(|&c| nodes_of[c as usize].clone())),
            parts: Lists::new(surface().map(of_place)),
            nodes_of_part: Lists::new(parts.into_iter()),
        }
    }

    /// Buffers.
    pub fn scratch(&self, matter: &Matter) -> Missed {
        Missed {
            loads: Vec::with_capacity(matter.surface.len()),
            parts: Vec::with_capacity(self.nodes_of_part.starts.len() - 1),
            has_part: vec![false; self.nodes_of_part.starts.len() - 1],
            nodes: Vec::with_capacity(self.parts_nodes(matter)),
            has_node: vec![false; self.parts_nodes(matter)],
        }
    }

    fn parts_nodes(&self, matter: &Matter) -> usize {
        match &matter.map {
            NodeMap::Same => matter.rest.len(),
            NodeMap::Sparse(map) => map.rows(),
        }
    }
}

/// What a step leaves of its equation.
#[derive(Clone, Debug, Default)]
pub(super) struct Missed {
    /// By place on the net, ascending: N.
    pub loads: Vec<(u32, Vector3)>,
    /// Parts of the law and nodes that a look takes.
    parts: Vec<u32>,
    has_part: Vec<bool>,
    nodes: Vec<u32>,
    has_node: Vec<bool>,
}

impl Missed {
    /// Adds a load where one is looked at.
    pub fn add(&mut self, place: u32, load: &Vector3) {
        if let Ok(k) = self.loads.binary_search_by_key(&place, |entry| entry.0) {
            self.loads[k].1 += load;
        }
    }

    /// Chooses where to look: at places that carry, and what lies about them.
    fn choose(&mut self, about: &About, carried: &[(u32, Vector3)], place_of: impl Fn(u32) -> u32) {
        for part in self.parts.drain(..) {
            self.has_part[part as usize] = false;
        }
        for node in self.nodes.drain(..) {
            self.has_node[node as usize] = false;
        }
        self.loads.clear();
        for (coordinate, force) in carried {
            if *force == Vector3::zeros() {
                continue;
            }
            let place = place_of(*coordinate);
            self.loads.push((place, Vector3::zeros()));
            for &part in about.parts.of(place as usize) {
                if !std::mem::replace(&mut self.has_part[part as usize], true) {
                    self.parts.push(part);
                }
            }
        }
        self.loads.sort_unstable_by_key(|entry| entry.0);
        self.parts.sort_unstable();
        for &part in &self.parts {
            for &node in about.nodes_of_part.of(part as usize) {
                if !std::mem::replace(&mut self.has_node[node as usize], true) {
                    self.nodes.push(node);
                }
            }
        }
    }
}

impl About {
    /// What the step in `scratch`, which has arrived, leaves of its equation where contact forces act, into
    /// `scratch.missed`. `place_of`: of a coordinate that carries.
    pub fn look(
        &self,
        matter: &Matter,
        look_ahead: Option<&LookAhead>,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
        place_of: impl Fn(u32) -> u32,
    ) {
        scratch.missed.choose(self, &scratch.carried, &place_of);
        match look_ahead {
            Some(look_ahead) => matter.look_ahead_short(look_ahead, state, scratch),
            None => matter.look_ahead(state, scratch),
        }
        let DeformableScratch {
            missed,
            coordinates,
            nodes,
            residual,
            node_residual,
            implicit,
            reached,
            carried,
            field,
            ..
        } = scratch;
        let (places, forces): (&[Lane], &mut [Lane]) = match &matter.map {
            NodeMap::Same => (coordinates, residual),
            NodeMap::Sparse(map) => {
                map.apply_some(&missed.nodes, coordinates, nodes);
                (nodes, node_residual)
            }
        };
        for &node in &missed.nodes {
            forces[node as usize] = [0.0; 4];
        }
        // Of a coordinate.
        let gathered = |place: u32, forces: &[Lane]| -> Lane {
            let mut sum = [0.0; 4];
            for &(node, weight) in self.nodes.of(place as usize) {
                for (sum, part) in sum.iter_mut().zip(&forces[node as usize]) {
                    *sum += weight * part;
                }
            }
            sum
        };
        let given = Given {
            pressures: &implicit.pressures,
            gaps: &mut implicit.gaps,
        };
        let law: &MaterialLaw = &matter.law;
        law.add_forces_of_parts(
            &missed.parts,
            matter.rest_lengths(state),
            given,
            places,
            forces,
        );
        let inverse_dt = 1.0 / matter.settings.dt_s;
        for (place, load) in &mut missed.loads {
            let c = matter.surface[*place as usize] as usize;
            let moved = reached[c] - state.positions[c];
            let due = (state.velocities[c] - moved * inverse_dt) * inverse_dt
                + field.at(&state.positions[c], &state.velocities[c]);
            let [x, y, z, _] = gathered(*place, forces);
            *load = due * matter.masses[c] + Vector3::new(x, y, z);
            if let Ok(k) = carried.binary_search_by_key(&(c as u32), |entry| entry.0) {
                *load += carried[k].1;
            }
        }
    }
}
