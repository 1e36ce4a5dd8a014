//! What an IGES file makes of a surface: the entities that name it, and those that name them, up to what stands in the model
//! by itself. IGES 5.3, §4.
//!
//! ```text
//! 128 ◀── face 144, 143, 510 ◀── shell 514 ◀── solid 186, 430 ◀── subfigure 308 ◀── its place 408
//!  ▲                                                                         (groups and properties aside)
//!  └── anything else: another shape, of which the surface is a part
//! ```

use super::read::Parameters;
use super::sections::{Entry, File, INSTANCE};

/// Faces on a surface: all of it, or what is within their boundaries.
pub(super) const FACES: [u64; 3] = [144, 143, 510];

/// What takes over what it names, moved at most: shells, solids of shells, solids at their places, definitions of subfigures.
const WRAPS: [u64; 5] = [514, 186, 430, 308, INSTANCE];

/// Entities that name each other at most.
const MOST_DEPTH: usize = 16;

/// The parameters of an entity as numbers; not finite where one is something else.
pub(super) struct Numbers(pub Vec<f64>);

impl Numbers {
    pub fn of(file: &File<'_>, entry: &Entry) -> Option<Self> {
        let read = Parameters::of(file, entry, entry.kind as u32).ok()?;
        let number = |k| read.real(k, "").unwrap_or(f64::NAN);
        Some(Self((0..read.count()).map(number).collect()))
    }

    pub fn at(&self, k: usize) -> Option<f64> {
        self.0.get(k).copied()
    }

    pub fn pointer(&self, k: usize) -> Option<u64> {
        self.at(k)
            .filter(|id| *id >= 1.0 && id.fract() == 0.0)
            .map(|id| id as u64)
    }

    pub fn count(&self, k: usize) -> Option<usize> {
        self.at(k)
            .filter(|count| *count >= 0.0 && count.fract() == 0.0 && *count < 1e6)
            .map(|count| count as usize)
    }

    /// So many pointers, from `first` on, each `step` after the one before it.
    fn pointers(&self, first: usize, count: usize, step: usize) -> Vec<u64> {
        let numbers = self.0.iter().skip(first).step_by(step).take(count);
        numbers.map(|id| *id as u64).collect()
    }
}

/// Whether entities of a kind have no surface or solid among their parameters: curves, points, solids and surfaces of numbers and
/// curves, boundaries (which belong to faces), drawings, properties.
fn names_none(kind: u64) -> bool {
    matches!(kind, 0 | 100..=136 | 138 | 141 | 142 | 146 | 148 | 150..=168 | 190..=198 | 200..=306 | 310..=319 | 321..=324
        | 404..=406 | 410 | 416 | 418 | 422 | 502..=508)
}

/// Whether an entity names another one. In kinds that are not known, any whole number may be a name.
fn names(file: &File<'_>, entry: &Entry, id: u64) -> bool {
    if names_none(entry.kind) || entry.id == id {
        return false;
    }
    let Some(numbers) = Numbers::of(file, entry) else {
        return false;
    };
    let counted = |k: usize| numbers.count(k).unwrap_or(0);
    match entry.kind {
        144 | 510 | 430 | INSTANCE => numbers.pointer(0) == Some(id),
        143 => numbers.pointer(1) == Some(id),
        140 => numbers.pointer(4) == Some(id),
        514 => numbers.pointers(1, counted(0), 2).contains(&id),
        // A shell, and those of its voids.
        186 => numbers.pointer(0) == Some(id) || numbers.pointers(3, counted(2), 2).contains(&id),
        308 => numbers.pointers(3, counted(2), 1).contains(&id),
        // Operations on solids name them with a minus.
        _ => numbers.0.iter().any(|number| number.abs() == id as f64),
    }
}

/// What becomes of one surface.
#[derive(Debug)]
pub(super) struct Uses {
    /// The surface, and what takes it over, one in the other.
    pub chain: Vec<Entry>,
    /// Faces on it.
    pub faces: Vec<Entry>,
    /// It is a part of another shape, or of one that is not in the file.
    pub other: bool,
    /// Places in which it stands, where they are several.
    pub placements: usize,
}

impl Uses {
    pub fn of(file: &File<'_>, surface: Entry) -> Self {
        let mut uses = Self {
            chain: vec![surface],
            faces: Vec::new(),
            other: false,
            placements: 0,
        };
        let mut inner = surface;
        for _ in 0..MOST_DEPTH {
            let mut outer: Vec<Entry> = file
                .entries()
                .flatten()
                .filter(|entry| names(file, entry, inner.id))
                .collect();
            uses.other |= inner.id == surface.id && inner.dependent && outer.is_empty();
            // Groups show what they name as it is.
            outer.retain(|entry| entry.kind != 402);
            let is_face = |entry: &Entry| FACES.contains(&entry.kind);
            uses.other |= outer
                .iter()
                .any(|entry| !is_face(entry) && !WRAPS.contains(&entry.kind));
            uses.faces
                .extend(outer.iter().filter(|entry| is_face(entry)));
            match outer[..] {
                [one] if !uses.other => inner = one,
                [] | [_] => return uses,
                _ => {
                    uses.placements = outer.len();
                    return uses;
                }
            }
            uses.chain.push(inner);
        }
        uses.other = true;
        uses
    }
}
