//! The one door through which a scene comes in: every value is checked where it is built, and every
//! problem is collected with the path of its key.
//!
//! ```text
//! Scene::build ──▶ At("tool[0]") ── key("shape") ── key("sphere") ── above_zero("radius_m", …) ──▶ Some(radius) or a problem
//! Loaded::build ─▶ the same, and each path is looked up in the file: file:line:column
//! ```
//! A check gives the value back, so what is built from it needs no second check; `None` means that
//! a problem was written down and that nothing can be built from the value.

use super::files::Files;
use super::methods::Methods;
use palpate_geometry::math::{MOST_COORDINATE_M, Pose, Rotation, Vector3, direction_of};
use std::cell::RefCell;
use std::fmt::{self, Display};
use std::ops::RangeInclusive;
use std::path::Path;

/// What a number of a scene that is not 0 may be, in SI units: what is computed of such numbers stays finite, and nothing
/// that is meant is outside.
const MEANT: RangeInclusive<f64> = 1e-15..=1e15;

/// Everything that is wrong with a scene. Never empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// In order of lines where the scene came from a file, else in the order of checks.
    pub problems: Vec<Problem>,
}

/// One value that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Path of the key, for example `body[0].material.young_pa`; empty when it concerns the file as
    /// a whole.
    pub path: String,
    /// What is wrong and how to fix it.
    pub reason: String,
    /// Where the scene file says so; `None` for a scene that is data only.
    pub place: Option<Place>,
}

/// A position in a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Name of the file.
    pub file: String,
    /// From 1; 0 when the file could not be read at all.
    pub line: usize,
    /// Bytes from the start of the line, from 1.
    pub column: usize,
}

impl Place {
    /// Where a byte of a text stands.
    pub(super) fn of(file: &str, text: &str, start: usize) -> Self {
        let before = &text.as_bytes()[..start.min(text.len())];
        let line_start = before
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |k| k + 1);
        Self {
            file: file.to_owned(),
            line: before.iter().filter(|&&b| b == b'\n').count() + 1,
            column: before.len() - line_start + 1,
        }
    }
}

impl Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            path,
            reason,
            place,
        } = self;
        match place {
            Some(Place { file, line: 0, .. }) => write!(f, "{file}: {reason}"),
            Some(Place { file, line, column }) => write!(f, "{file}:{line}:{column}: {reason}"),
            None if path.is_empty() => f.write_str(reason),
            None => write!(f, "{path}: {reason}"),
        }
    }
}

impl Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, problem) in self.problems.iter().enumerate() {
            let end = if k > 0 { "\n" } else { "" };
            write!(f, "{end}{problem}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}

impl SceneError {
    /// A single problem with a value that has a path but no file.
    pub(super) fn one(path: impl Into<String>, reason: impl Display) -> Self {
        Self {
            problems: vec![Problem {
                path: path.into(),
                reason: reason.to_string(),
                place: None,
            }],
        }
    }
}

/// Collects the problems of one scene.
pub(super) struct Door<'d> {
    /// Files that the scene names.
    files: &'d dyn Files,
    methods: Methods,
    problems: RefCell<Vec<Problem>>,
    /// Path and text of what is taken otherwise than a file says.
    notes: RefCell<Vec<(String, String)>>,
}

impl<'d> Door<'d> {
    pub fn new(files: &'d dyn Files) -> Self {
        Self {
            files,
            methods: Methods::default(),
            problems: RefCell::default(),
            notes: RefCell::default(),
        }
    }

    /// A door of scenes that may name these methods.
    pub fn with(self, methods: Methods) -> Self {
        Self { methods, ..self }
    }

    /// The top of the scene.
    pub fn top(&self) -> At<'_> {
        At {
            door: self,
            path: String::new(),
        }
    }

    /// What was noted so far: path and text.
    pub fn notes(&self) -> Vec<(String, String)> {
        self.notes.borrow().clone()
    }

    /// How many problems there are so far.
    pub fn count(&self) -> usize {
        self.problems.borrow().len()
    }

    /// What was built, if nothing was wrong.
    pub fn close<T>(self, built: Option<T>) -> Result<T, SceneError> {
        let problems = self.problems.into_inner();
        match built {
            Some(built) if problems.is_empty() => Ok(built),
            _ => {
                debug_assert!(
                    !problems.is_empty(),
                    "nothing was built and nobody said why"
                );
                Err(SceneError { problems })
            }
        }
    }
}

/// A table or value of the scene that is being read: where to write down what is wrong with it.
#[derive(Clone)]
pub(crate) struct At<'d> {
    door: &'d Door<'d>,
    path: String,
}

impl<'d> At<'d> {
    /// A key of this table.
    pub fn key(&self, key: &str) -> At<'d> {
        let dot = if self.path.is_empty() { "" } else { "." };
        At {
            door: self.door,
            path: format!("{}{dot}{key}", self.path),
        }
    }

    /// An entry of this array, from 0.
    pub fn entry(&self, index: usize) -> At<'d> {
        At {
            door: self.door,
            path: format!("{}[{index}]", self.path),
        }
    }

    /// Methods that the scene may name beside those of this crate.
    pub fn methods(&self) -> Methods {
        self.door.methods
    }

    /// A file that the scene names, in messages.
    pub fn name_of(&self, file: &Path) -> String {
        self.door.files.named(file)
    }

    /// Notes what is taken otherwise than a file says; the scene warns of it.
    pub fn note(&self, text: impl Display) {
        let note = (self.path.clone(), text.to_string());
        self.door.notes.borrow_mut().push(note);
    }

    /// How many problems the scene has so far.
    pub fn problem_count(&self) -> usize {
        self.door.count()
    }

    /// What comes of it, or `None` and no problem more than before.
    pub fn attempt<T>(&self, work: impl FnOnce() -> Option<T>) -> Option<T> {
        let before = self.problem_count();
        let result = work();
        if self.problem_count() > before {
            self.door.problems.borrow_mut().truncate(before);
            return None;
        }
        result
    }

    /// Writes a problem down: what is wrong and how to fix it.
    pub fn refuse(&self, reason: impl Display) {
        self.door.problems.borrow_mut().push(Problem {
            path: self.path.clone(),
            reason: reason.to_string(),
            place: None,
        });
    }

    /// [`At::refuse`], as the answer of a function that has nothing to give.
    pub fn refused<T>(&self, reason: impl Display) -> Option<T> {
        self.refuse(reason);
        None
    }

    /// What went well, or a problem here.
    pub fn take<T, E: Display>(&self, result: Result<T, E>) -> Option<T> {
        result.map_err(|error| self.refuse(error)).ok()
    }

    /// A value of this table that must be above 0, and what a scene may mean.
    pub fn above_zero(&self, key: &str, value: f64, unit: &str) -> Option<f64> {
        if MEANT.contains(&value) {
            return Some(value);
        }
        let unit = spaced(unit);
        self.key(key).refused(match value > 0.0 {
            true => format!("{key} is {value:e}{unit}; it must be {}{unit}", meant()),
            false => format!("{key} is {value}; it must be a number above 0{unit}"),
        })
    }

    /// A value of this table that must be 0, or as in [`At::above_zero`].
    pub fn not_below_zero(&self, key: &str, value: f64, unit: &str) -> Option<f64> {
        if value == 0.0 || MEANT.contains(&value) {
            return Some(value);
        }
        let unit = spaced(unit);
        self.key(key).refused(match value > 0.0 {
            true => format!(
                "{key} is {value:e}{unit}; it must be 0, or {}{unit}",
                meant()
            ),
            false => format!("{key} is {value}; it must be 0 or more{unit}"),
        })
    }

    /// A count of this table, from 1 to `most`.
    pub fn count(&self, key: &str, value: usize, most: usize) -> Option<usize> {
        if (1..=most).contains(&value) {
            return Some(value);
        }
        self.key(key)
            .refused(format!("{key} is {value}; it must be 1 to {most}"))
    }

    /// Values of this table, coordinates for the most part, that must all be numbers to calculate with.
    pub fn finite(&self, key: &str, values: &[f64]) -> Option<()> {
        if values.iter().all(|x| x.abs() <= MOST_COORDINATE_M) {
            return Some(());
        }
        self.key(key).refused(format!(
            "{key} is {values:?}; every value must be a finite number within ±{MOST_COORDINATE_M:e}"
        ))
    }

    /// A vector of this table of any length above 0; gives it with length 1.
    pub fn direction(&self, key: &str, v: &[f64; 3]) -> Option<Vector3> {
        direction_of(&Vector3::from(*v)).or_else(|| {
            self.key(key).refused(format!(
                "{key} {v:?} has no direction; give a vector of any length above 0"
            ))
        })
    }

    /// A placement, here: m, and a unit quaternion x y z w.
    pub fn pose(&self, position: &[f64; 3], orientation: &[f64; 4]) -> Option<Pose> {
        let finite = self.finite("position", position);
        let [x, y, z, w] = *orientation;
        let quaternion = nalgebra::Quaternion::new(w, x, y, z);
        let norm = quaternion.norm();
        if norm.is_nan() || (norm - 1.0).abs() > 1e-6 {
            return self.key("orientation").refused(format!(
                "orientation has length {norm}; give a unit quaternion [x, y, z, w]"
            ));
        }
        finite?;
        Some(Pose::from_parts(
            Vector3::from(*position).into(),
            Rotation::from_quaternion(quaternion),
        ))
    }

    /// A file that this table names.
    pub fn read_file(&self, key: &str, file: &Path) -> Option<Vec<u8>> {
        self.key(key).take(self.door.files.read(file))
    }
}

/// [`MEANT`] in words.
fn meant() -> String {
    format!("from {:e} to {:e}", MEANT.start(), MEANT.end())
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

/// What is wrong with TOML in a file that a scene names, and where. Its text is not repeated: a scene
/// of someone else can name any file, and the message goes where that one can read it.
pub(super) fn words_of_another(text: &str, error: &toml::de::Error) -> String {
    let Place { line, column, .. } = Place::of("", text, error.span().map_or(0, |span| span.start));
    let message = match error.message().split_once(", expected ") {
        Some((_, wanted)) => format!("expected {wanted}"),
        None => error.message().to_owned(),
    };
    format!("line {line}, column {column}: {message}")
}

/// The name of a list nearest to one that is not in it.
pub(super) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> &'a str {
    known
        .into_iter()
        .min_by_key(|known| strsim::damerau_levenshtein(name, known))
        .unwrap_or("")
}
