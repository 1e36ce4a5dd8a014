//! What is beside each face and each vertex of a part.

use super::carrier::Carrier;
use super::part::Part;
use super::tree::Tree;

/// What shares an edge or a vertex with each face, and meets at each vertex.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    pub faces: Vec<Around>,
    pub vertices: Vec<Meeting>,
}

/// Around a face; items as in the trees of the part.
#[derive(Clone, Debug)]
pub(super) struct Around {
    /// Its own edges and lone vertices.
    pub own: Tree,
    /// These, and the edges that end where they do.
    pub wires: Tree,
    /// The face, all that meet it at an edge or a vertex, and all on B-splines: what is known of these spares searches.
    pub skin: Tree,
    /// Ascending, what `wires` and `skin` hold.
    pub wire_items: Vec<u32>,
    pub skin_items: Vec<u32>,
}

/// What meets at a vertex, ascending.
#[derive(Clone, Debug, Default)]
pub(super) struct Meeting {
    pub edges: Vec<u32>,
    pub faces: Vec<u32>,
}

impl Near {
    pub fn new(part: &Part) -> Self {
        let mut vertices = vec![Meeting::default(); part.vertices.len()];
        let mut own: Vec<Vec<u32>> = vec![Vec::new(); part.faces.len()];
        for (k, edge) in part.edges.iter().enumerate() {
            if edge.sides.is_empty() {
                continue;
            }
            for v in edge.ends {
                let meeting = &mut vertices[v as usize];
                meeting.edges.push(k as u32);
                meeting
                    .faces
                    .extend(edge.sides.iter().map(|side| side.face));
            }
            for side in &edge.sides {
                own[side.face as usize].push(k as u32);
            }
        }
        for meeting in &mut vertices {
            settle(&mut meeting.edges);
            settle(&mut meeting.faces);
        }
        for (k, &v) in part.lone.iter().enumerate() {
            if let Some(face) = part.vertices[v as usize].face {
                own[face as usize].push((part.edges.len() + k) as u32);
                vertices[v as usize].faces.push(face);
            }
        }
        let (wire_boxes, boxes) = (part.wires.boxes(), part.skin.boxes());
        let is_spline = |&k: &u32| matches!(part.faces[k as usize].carrier, Carrier::Spline(_));
        let splines: Vec<u32> = (0..part.faces.len() as u32).filter(is_spline).collect();
        let around = |(face, own): (usize, Vec<u32>)| {
            let (mut wires, mut skin) = (own.clone(), vec![face as u32]);
            for edge in own.iter().filter_map(|&k| part.edges.get(k as usize)) {
                for v in edge.ends {
                    wires.extend(&vertices[v as usize].edges);
                    skin.extend(&vertices[v as usize].faces);
                }
            }
            skin.extend(&splines);
            settle(&mut wires);
            settle(&mut skin);
            let mut own = own;
            settle(&mut own);
            Around {
                own: Tree::over(&wire_boxes, own),
                wires: Tree::over(&wire_boxes, wires.clone()),
                skin: Tree::over(&boxes, skin.clone()),
                wire_items: wires,
                skin_items: skin,
            }
        };
        Self {
            faces: own.into_iter().enumerate().map(around).collect(),
            vertices,
        }
    }

    /// Edges and faces around a face.
    pub fn trees(&self, face: u32) -> [&Tree; 2] {
        let around = &self.faces[face as usize];
        [&around.wires, &around.skin]
    }

    /// Something is known of a face.
    pub fn has(&self, face: u32) -> bool {
        self.faces.len() > face as usize
    }

    /// Edges and lone vertices of a face.
    pub fn own(&self, face: u32) -> &Tree {
        &self.faces[face as usize].own
    }
}

fn settle(items: &mut Vec<u32>) {
    items.sort_unstable();
    items.dedup();
}
