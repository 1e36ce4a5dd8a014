//! What is said of the senses of faces: what was turned, and why a part has no inside.

use super::brep::Brep;

/// `#id`s that a note lists.
const LISTED: usize = 5;

/// How the senses of faces are taken otherwise than the file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Senses {
    /// `#id`s of the faces that are turned: their sense, their loops, or both.
    pub turned: Vec<u64>,
    /// Closed shells that were inside out, or voids that were the wrong way round.
    pub inside_out: usize,
    /// Why the part has no inside; empty if it has one, or is a sheet.
    pub problems: Vec<SenseProblem>,
    /// By face: its sense, its loops are turned.
    pub(super) changes: Vec<[bool; 2]>,
}

/// Why a part has no inside.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SenseProblem {
    /// Edges that bound one face.
    #[error(
        "edges that belong to one face only: {count}, first #{edge}; the shell is open there, and the part has no inside: add the \
         missing faces, or sew those that are there, in the CAD system that wrote the file"
    )]
    Open {
        /// The first of them, in the file.
        edge: u64,
        /// All of them.
        count: usize,
    },
    /// Edges that a band without two sides goes through, or at which an odd number of faces meet.
    #[error(
        "edges whose faces have no common side, however they are turned: {count}, first #{edge}, where {faces} faces meet; the \
         part has no inside: if it should be a solid, remove the faces within it, or divide it into several, in the CAD system \
         that wrote the file"
    )]
    Uneven {
        /// The first of them, in the file.
        edge: u64,
        /// How many faces meet there.
        faces: usize,
        /// All such edges.
        count: usize,
    },
    /// Faces that look inwards from one side and outwards from another.
    #[error(
        "the shell with face #{face} is inside out from some sides only, as shells are that cross themselves; the part has no \
         inside: repair the part in the CAD system that wrote the file"
    )]
    Crossing {
        /// The first face of the shell, in the file.
        face: u64,
    },
    /// A void that is in nothing.
    #[error(
        "the shell with face #{face} should be a void, and is outside the solid; the part has no inside: repair the part in the \
         CAD system that wrote the file"
    )]
    Outside {
        /// The first face of the void, in the file.
        face: u64,
    },
}

impl Senses {
    /// Turns in a boundary, the one that the part was made of, what was turned in the part: a part of it then has nothing to
    /// turn.
    pub fn correct(&self, brep: &mut Brep) {
        for (face, [sense, loops]) in brep.faces.iter_mut().zip(&self.changes) {
            face.same_sense ^= sense;
            for bound in face.bounds.iter_mut().filter(|_| *loops) {
                bound.reverse();
            }
        }
    }

    /// A sentence for each thing that is otherwise than the file says.
    pub fn notes(&self) -> Vec<String> {
        let mut all = Vec::new();
        if let count @ 1.. = self.turned.len() {
            let ids: Vec<String> = (self.turned.iter().take(LISTED))
                .map(|id| format!("#{id}"))
                .collect();
            let more = if count > LISTED { ", …" } else { "" };
            let shells = match self.inside_out {
                0 => String::new(),
                n => format!("; shells that were inside out: {n}"),
            };
            all.push(format!(
                "faces turned, whose sense or loops are the wrong way in the file: {count} ({}{more}){shells}",
                ids.join(", ")
            ));
        }
        all.extend(self.problems.iter().map(ToString::to_string));
        all
    }
}
