//! What is asked of a file, and what a part has not of it.

use super::StepError;
use crate::part::PartError;
use std::collections::BTreeMap;
use std::fmt;

/// Errors of faces that are left out that are said in full.
const MOST_NOTES: usize = 8;

/// What of a file is read; everything, unless it says something else.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PartPick {
    /// Name or number of a product; an assembly with all that it has.
    pub part: Option<String>,
    /// Which of its places, from 0.
    pub instance: Option<usize>,
    /// Faces that cannot be read are left out instead of refused.
    pub partial: bool,
}

/// What a file says and a part has not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PartLeftOut {
    /// Faces whose surface or curves cannot be read, by what they fail at.
    pub faces: BTreeMap<String, usize>,
    /// The first of their errors.
    pub errors: Vec<String>,
    /// Solids and sheets that no product has, or that another part than the picked one has.
    pub solids: usize,
    /// Faces of no shell.
    pub lone_faces: usize,
    /// Curves in space without faces.
    pub wireframes: usize,
    /// Sets of points, curves or surfaces without topology.
    pub sets: usize,
    /// Items that are given as triangles only.
    pub tessellated: usize,
    /// Solids that are built from others.
    pub constructed: usize,
    /// Files that parts of the assembly are in.
    pub elsewhere: Vec<String>,
    /// Solids with an open shell, read as sheets.
    pub open_solids: usize,
    /// Vertices that were taken for one with others.
    pub welded: usize,
}

impl PartLeftOut {
    /// The boundary has all that the file says.
    pub fn is_nothing(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn face(&mut self, on: String, error: &StepError) {
        let name = match error {
            StepError::Unreadable { entity, .. } => entity.clone(),
            _ => on,
        };
        self.one(name, error.to_string());
    }

    /// A face of a carrier that makes no part.
    pub(super) fn unfit(&mut self, on: &str, error: &PartError) {
        self.one(on.to_owned(), error.to_string());
    }

    fn one(&mut self, name: String, error: String) {
        *self.faces.entry(name).or_default() += 1;
        if self.errors.len() < MOST_NOTES {
            self.errors.push(error);
        }
    }
}

impl fmt::Display for PartLeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut all = Vec::new();
        if !self.faces.is_empty() {
            let count: usize = self.faces.values().sum();
            let kinds: Vec<String> = self
                .faces
                .iter()
                .map(|(k, n)| format!("{n} at {k}"))
                .collect();
            all.push(format!("{count} faces ({})", kinds.join(", ")));
        }
        let mut count = |n: usize, what: &str| {
            if n > 0 {
                all.push(format!("{n} {what}"));
            }
        };
        count(self.solids, "solids or sheets of no product or of others");
        count(self.lone_faces, "faces of no shell");
        count(self.wireframes, "wireframes");
        count(self.sets, "sets of points, curves or surfaces");
        count(self.tessellated, "tessellated items");
        count(self.constructed, "solids built from others");
        count(self.open_solids, "solids with open shells (read as sheets)");
        count(self.welded, "vertices beside another (made one)");
        if !self.elsewhere.is_empty() {
            all.push(format!(
                "parts in other files: {}",
                self.elsewhere.join(", ")
            ));
        }
        match all.is_empty() {
            true => write!(f, "nothing"),
            false => write!(f, "{}", all.join("; ")),
        }
    }
}
