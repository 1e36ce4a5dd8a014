//! A piece's boundary from pole to pole: a chain of sections, each next to the one before it along one rim.
//!
//! The faces of a closed boundary without handles and the rims between them are a tree. A path in it is the chain; what
//! hangs on a face of the path goes with it, so that the first and the last section are discs, those between them rings.

use super::error::PieceSkinError;
use super::fine::{Fine, Lies};

/// Of the whole area: smaller sections are no sections of their own, if there are others.
const LEAST_SHARE: f64 = 4e-3;

/// Two triangles, and the place of the edge in each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Numbers of its corners, the smaller one first.
    pub ends: [u32; 2],
    /// Of an outer edge of a sheet, the same twice.
    pub sides: [(u32, u8); 2],
}

/// Triangles, edges and what joins them.
pub(super) struct Net {
    pub edges: Vec<Edge>,
    /// (triangles) The edge from each corner to the next.
    pub of: Vec<[u32; 3]>,
}

impl Net {
    /// Of a closed boundary of one part without handles.
    pub fn new(fine: &Fine) -> Result<Self, PieceSkinError> {
        let net = Self::joined(fine, false)?;
        match net.shape(fine) {
            (1, 2) => Ok(net),
            (1, euler) if euler < 2 && euler % 2 == 0 => Err(PieceSkinError::Handles {
                handles: ((2 - euler) / 2) as usize,
            }),
            _ => Err(PieceSkinError::Pinched),
        }
    }

    /// Of a sheet, whose outer edges have their triangle on both sides.
    pub fn open(fine: &Fine) -> Result<Self, PieceSkinError> {
        Self::joined(fine, true)
    }

    /// How many parts there are, and corners − edges + triangles.
    pub fn shape(&self, fine: &Fine) -> (usize, i64) {
        let mut used = vec![false; fine.corners.len()];
        (fine.triangles.iter().flatten()).for_each(|&k| used[k as usize] = true);
        let corners = used.iter().filter(|used| **used).count();
        let euler = corners as i64 - self.edges.len() as i64 + fine.triangles.len() as i64;
        (self.parts(|_| true).1, euler)
    }

    fn joined(fine: &Fine, open: bool) -> Result<Self, PieceSkinError> {
        let mut halves: Vec<([u32; 2], u32, u8)> = Vec::with_capacity(3 * fine.triangles.len());
        for (t, corners) in fine.triangles.iter().enumerate() {
            for k in 0..3 {
                let (p, q) = (corners[k], corners[(k + 1) % 3]);
                halves.push(([p.min(q), p.max(q)], t as u32, k as u8));
            }
        }
        halves.sort_unstable();
        let mut net = Self {
            edges: Vec::with_capacity(halves.len() / 2),
            of: vec![[0; 3]; fine.triangles.len()],
        };
        for group in halves.chunk_by(|a, b| a.0 == b.0) {
            let (ends, sides) = match *group {
                [(ends, t, k), (_, other, l)] => (ends, [(t, k), (other, l)]),
                [(ends, t, k)] if open => (ends, [(t, k); 2]),
                _ => return Err(PieceSkinError::Pinched),
            };
            let starts = sides.map(|(t, k)| fine.triangles[t as usize][k as usize]);
            if starts[0] == starts[1] && sides[0] != sides[1] {
                return Err(PieceSkinError::Pinched);
            }
            for (t, k) in sides {
                net.of[t as usize][k as usize] = net.edges.len() as u32;
            }
            net.edges.push(Edge { ends, sides });
        }
        Ok(net)
    }

    /// The triangle across an edge of a triangle.
    pub fn across(&self, triangle: u32, k: usize) -> u32 {
        let sides = self.edges[self.of[triangle as usize][k] as usize].sides;
        match sides[0].0 == triangle && sides[0].1 as usize == k {
            true => sides[1].0,
            false => sides[0].0,
        }
    }

    /// The part of each triangle, and how many there are; parts hang together across open edges.
    fn parts(&self, open: impl Fn(&Edge) -> bool) -> (Vec<u32>, usize) {
        let mut of = vec![u32::MAX; self.of.len()];
        let mut count = 0;
        let mut ahead = Vec::new();
        for first in 0..of.len() {
            if of[first] != u32::MAX {
                continue;
            }
            of[first] = count;
            ahead.push(first as u32);
            while let Some(t) = ahead.pop() {
                for k in 0..3 {
                    let next = self.across(t, k);
                    if of[next as usize] == u32::MAX
                        && open(&self.edges[self.of[t as usize][k] as usize])
                    {
                        of[next as usize] = count;
                        ahead.push(next);
                    }
                }
            }
            count += 1;
        }
        (of, count as usize)
    }
}

/// A closed walk between two faces.
#[derive(Clone, Debug)]
pub(super) struct Rim {
    /// The face on the left of the walk, and that on its right, seen from outside.
    pub faces: [u32; 2],
    /// Edge from each corner of the walk to the next.
    pub edges: Vec<u32>,
    pub corners: Vec<u32>,
    pub length_m: f64,
    /// Between skin and cap, or along a crease of the skin.
    pub lies: Lies,
}

/// Faces joined to a chain.
pub(super) struct Sections {
    /// (triangles)
    pub of: Vec<u32>,
    pub count: usize,
    /// Between each section and the next, which is on the left.
    pub rims: Vec<Rim>,
    /// Of the piece.
    pub all_rims: usize,
}

impl Sections {
    /// At most `most` of them, at least two.
    pub fn new(fine: &Fine, net: &Net, most: usize) -> Result<Self, PieceSkinError> {
        let labels: Vec<u32> = (0..fine.triangles.len()).map(|t| fine.label(t)).collect();
        let differ = |edge: &Edge| {
            let [a, b] = edge.sides.map(|side| labels[side.0 as usize]);
            a != b
        };
        let (faces, count) = net.parts(|edge| !differ(edge));
        let rims = rims(fine, net, &faces)?;
        if rims.len() + 1 != count || rims.is_empty() {
            return Err(PieceSkinError::Pinched);
        }
        let mut areas = vec![0.0; count];
        for (t, &face) in faces.iter().enumerate() {
            areas[face as usize] += fine.area_of(t);
        }
        let tree = Tree::new(&rims, &areas);
        let chain = tree.best(most);
        let (of_face, chain) = tree.sections(&chain);
        let oriented = chain.iter().enumerate().map(|(k, &rim)| {
            let mut rim = rims[rim].clone();
            if of_face[rim.faces[0] as usize] as usize != k + 1 {
                rim.turn();
            }
            rim
        });
        Ok(Self {
            rims: oriented.collect(),
            count: chain.len() + 1,
            of: faces.iter().map(|&f| of_face[f as usize]).collect(),
            all_rims: rims.len(),
        })
    }
}

impl Rim {
    pub fn turn(&mut self) {
        self.faces.swap(0, 1);
        // The edge of a corner is that to the next one.
        self.corners.reverse();
        self.edges.reverse();
        self.edges.rotate_left(1);
    }

    /// Begins with another of its edges as the last.
    pub fn end_with(&mut self, edge: u32) {
        if let Some(k) = self.edges.iter().position(|&e| e == edge) {
            let shift = (k + 1) % self.edges.len();
            self.edges.rotate_left(shift);
            self.corners.rotate_left(shift);
        }
    }
}

/// Walks along the edges between faces, the face of the smaller number on the left.
fn rims(fine: &Fine, net: &Net, faces: &[u32]) -> Result<Vec<Rim>, PieceSkinError> {
    // (corners) The walk goes on along this edge to that corner.
    let mut next: Vec<Option<(u32, u32)>> = vec![None; fine.corners.len()];
    let mut starts = Vec::new();
    let mut pairs = vec![[0; 2]; fine.corners.len()];
    for (e, edge) in net.edges.iter().enumerate() {
        let [a, b] = edge.sides.map(|side| faces[side.0 as usize]);
        if a == b {
            continue;
        }
        let (t, k) = edge.sides[usize::from(b < a)];
        let corners = fine.triangles[t as usize];
        let (from, to) = (corners[k as usize], corners[(k as usize + 1) % 3]);
        if next[from as usize].is_some() {
            return Err(PieceSkinError::Pinched);
        }
        next[from as usize] = Some((e as u32, to));
        pairs[from as usize] = [a.min(b), a.max(b)];
        starts.push(from);
    }
    let mut rims = Vec::new();
    for start in starts {
        let mut rim = Rim {
            faces: pairs[start as usize],
            edges: Vec::new(),
            corners: Vec::new(),
            length_m: 0.0,
            lies: Lies::Crease,
        };
        let mut at = start;
        while let Some((edge, to)) = next[at as usize].take() {
            if pairs[at as usize] != rim.faces {
                return Err(PieceSkinError::Pinched);
            }
            let sides = net.edges[edge as usize].sides.map(|side| side.0 as usize);
            if sides.into_iter().any(|t| fine.caps[t].is_some()) {
                rim.lies = Lies::Rim;
            }
            rim.edges.push(edge);
            rim.corners.push(at);
            let [p, q] = [at, to].map(|k| fine.corners[k as usize].rest);
            rim.length_m += (q - p).norm();
            at = to;
        }
        if rim.edges.is_empty() {
            continue;
        }
        if at != start || rim.edges.len() < 3 {
            return Err(PieceSkinError::Pinched);
        }
        rims.push(rim);
    }
    Ok(rims)
}

/// Faces, and the rims between them.
struct Tree<'a> {
    rims: &'a [Rim],
    areas: &'a [f64],
    /// (faces) Rims, and the faces beyond them.
    beside: Vec<Vec<(usize, usize)>>,
}

impl<'a> Tree<'a> {
    fn new(rims: &'a [Rim], areas: &'a [f64]) -> Self {
        let mut beside = vec![Vec::new(); areas.len()];
        for (k, rim) in rims.iter().enumerate() {
            let [a, b] = rim.faces.map(|f| f as usize);
            beside[a].push((k, b));
            beside[b].push((k, a));
        }
        Self {
            rims,
            areas,
            beside,
        }
    }

    /// Rims from a face to another.
    fn path(&self, from: usize, to: usize) -> Vec<usize> {
        let mut before: Vec<Option<(usize, usize)>> = vec![None; self.areas.len()];
        let mut ahead = vec![from];
        while let Some(face) = ahead.pop() {
            for &(rim, other) in &self.beside[face] {
                if other != from && before[other].is_none() {
                    before[other] = Some((rim, face));
                    ahead.push(other);
                }
            }
        }
        let mut path = Vec::new();
        let mut at = to;
        while let Some((rim, face)) = before[at] {
            path.push(rim);
            at = face;
        }
        path.reverse();
        path
    }

    /// The path with the longest rims, of those whose sections are large enough; of all where none is.
    fn best(&self, most: usize) -> Vec<usize> {
        let whole: f64 = self.areas.iter().sum();
        let mut best: Option<((bool, f64), Vec<usize>)> = None;
        for from in 0..self.areas.len() {
            for to in from + 1..self.areas.len() {
                let path = self.path(from, to);
                if path.is_empty() || path.len() + 1 > most {
                    continue;
                }
                let (of, chain) = self.sections(&path);
                let mut shares = vec![0.0; chain.len() + 1];
                for (face, &section) in of.iter().enumerate() {
                    shares[section as usize] += self.areas[face] / whole;
                }
                let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
                let length: f64 = path.iter().map(|&rim| self.rims[rim].length_m).sum();
                // Where all are small, the one that is least so.
                let large = least >= LEAST_SHARE;
                let score = (large, if large { length } else { least });
                if best.as_ref().is_none_or(|(known, _)| *known < score) {
                    best = Some((score, path));
                }
            }
        }
        best.map_or_else(Vec::new, |(_, path)| path)
    }

    /// The section of each face, and the rims between sections.
    fn sections(&self, path: &[usize]) -> (Vec<u32>, Vec<usize>) {
        // Away from the first face of the path, the number rises where a rim of the path is crossed.
        let ends = path.first().map(|&rim| self.rims[rim].faces);
        let first = match (ends, path.get(1)) {
            (Some([a, b]), Some(&second)) => match self.rims[second].faces.contains(&b) {
                true => a,
                false => b,
            },
            (Some([a, _]), None) => a,
            (None, _) => 0,
        };
        let mut of = vec![u32::MAX; self.areas.len()];
        of[first as usize] = 0;
        let mut ahead = vec![first as usize];
        while let Some(face) = ahead.pop() {
            for &(rim, other) in &self.beside[face] {
                if of[other] == u32::MAX {
                    of[other] = of[face] + u32::from(path.contains(&rim));
                    ahead.push(other);
                }
            }
        }
        (of, path.to_vec())
    }
}
