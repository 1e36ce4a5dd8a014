//! Scene files: read as TOML, built through the scene's one door, and every problem looked up in the
//! text.

mod spans;

use super::door::{Place, Problem, SceneError, nearest};
use super::methods::Methods;
use super::spec::SceneSpec;
use super::{Finding, Scene};
use serde::Deserialize as _;
use spans::Spans;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer};

/// A scene file, read but not yet built.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What it says.
    pub spec: SceneSpec,
    /// As it was written.
    pub text: String,
    /// Name of the file, for messages.
    pub name: String,
    /// Where its relative paths start.
    pub directory: PathBuf,
    /// SHA-256 of the text.
    pub sha256: [u8; 32],
    /// Methods that it may name beside those of this crate; none as read.
    pub methods: Methods,
}

/// Reads a scene file: its syntax and its keys. [`Loaded::build`] checks the values.
///
/// # Errors
/// A file that cannot be read, or that is not a scene, with lines.
pub fn load(path: &Path) -> Result<Loaded, SceneError> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|e| SceneError {
        problems: vec![Problem {
            path: String::new(),
            reason: format!("cannot be read: {e}"),
            place: Some(Place {
                file: name.clone(),
                line: 0,
                column: 0,
            }),
        }],
    })?;
    parse(&text, &name, path.parent().unwrap_or(Path::new(".")))
}

/// Reads scene text: its syntax and its keys. `name` is for messages, `directory` is where relative
/// paths start.
///
/// # Errors
/// Every mistake of syntax; or unknown keys, all of them unless a value is of a wrong kind; with lines.
pub fn parse(text: &str, name: &str, directory: &Path) -> Result<Loaded, SceneError> {
    let at = |span: Option<Range<usize>>, reason: String| Problem {
        path: String::new(),
        reason,
        place: Some(Place::of(name, text, span.map_or(0, |span| span.start))),
    };
    let (document, mistakes) = DeTable::parse_recoverable(text);
    if !mistakes.is_empty() {
        let mut problems: Vec<Problem> = mistakes
            .iter()
            .map(|error| at(error.span(), error.message().to_owned()))
            .collect();
        in_order(&mut problems);
        return Err(SceneError { problems });
    }
    let mut spec = read(document).map_err(|errors| {
        let problem = |error: &toml::de::Error| at(error.span(), with_suggestion(error.message()));
        let mut problems: Vec<Problem> = errors.iter().map(problem).collect();
        in_order(&mut problems);
        SceneError { problems }
    })?;
    if spec.name.is_none() {
        spec.name = Path::new(name)
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned());
    }
    use sha2::Digest as _;
    let sha256 = sha2::Sha256::digest(text.as_bytes()).into();
    Ok(Loaded {
        spec,
        text: text.to_owned(),
        name: name.to_owned(),
        directory: directory.to_owned(),
        sha256,
        methods: Methods::default(),
    })
}

/// Reads a scene. A key that it does not know is taken out, and it is read again: all of them are
/// found, up to the first error of another kind. Tables are read in the order of their keys' names.
fn read(mut document: Spanned<DeTable<'_>>) -> Result<SceneSpec, Vec<toml::de::Error>> {
    let mut errors: Vec<toml::de::Error> = Vec::new();
    loop {
        match SceneSpec::deserialize(Deserializer::from(document.clone())) {
            Ok(spec) if errors.is_empty() => return Ok(spec),
            Ok(_) => return Err(errors),
            Err(error) => {
                let unknown = error.message().starts_with("unknown field");
                let key = error.span().filter(|_| unknown);
                errors.push(error);
                if !key.is_some_and(|key| take_out(document.get_mut(), &key)) {
                    return Err(errors);
                }
            }
        }
    }
}

/// Takes the key at this place of the text out of a table, or of one inside it; false if it is not
/// there.
fn take_out(table: &mut DeTable<'_>, key: &Range<usize>) -> bool {
    fn inside(value: &mut DeValue<'_>, key: &Range<usize>) -> bool {
        match value {
            DeValue::Table(table) => take_out(table, key),
            DeValue::Array(array) => array.iter_mut().any(|value| inside(value.get_mut(), key)),
            _ => false,
        }
    }
    let named = table.iter().find(|(name, _)| name.span() == *key);
    match named.map(|(name, _)| name.get_ref().clone().into_owned()) {
        Some(name) => table.remove(name.as_str()).is_some(),
        None => table
            .iter_mut()
            .any(|(_, value)| inside(value.get_mut(), key)),
    }
}

impl Loaded {
    /// Sets the methods that the scene may name when it is built.
    pub fn with(self, methods: Methods) -> Self {
        Self { methods, ..self }
    }

    /// Checks and builds the scene.
    ///
    /// # Errors
    /// Everything that is wrong with it, each problem with its line, in order of lines.
    pub fn build(&self) -> Result<Scene, SceneError> {
        self.built(&self.spec)
    }

    /// As [`Loaded::build`], for a scene that is to run: [`Scene::build_to_run`].
    ///
    /// # Errors
    /// Everything that is wrong with it, each problem with its line, in order of lines.
    pub fn build_to_run(&self) -> Result<Scene, SceneError> {
        self.built_to_run(&self.spec)
    }

    /// [`Loaded::build`] of what was made of the scene that this file holds.
    ///
    /// # Errors
    /// As [`Loaded::build`].
    pub fn built(&self, spec: &SceneSpec) -> Result<Scene, SceneError> {
        Scene::build_with(spec, &self.directory, self.methods).map_err(|error| self.locate(error))
    }

    /// [`Loaded::build_to_run`] of what was made of the scene that this file holds.
    ///
    /// # Errors
    /// As [`Loaded::build_to_run`].
    pub fn built_to_run(&self, spec: &SceneSpec) -> Result<Scene, SceneError> {
        Scene::build_to_run_with(spec, &self.directory, self.methods)
            .map_err(|error| self.locate(error))
    }

    /// A finding about the scene, with its line.
    pub fn message(&self, finding: &Finding) -> String {
        let start = Spans::of(&self.text).start_of(&finding.path);
        let Place { file, line, column } = Place::of(&self.name, &self.text, start);
        format!("{file}:{line}:{column}: {finding}")
    }

    /// Looks up where this file says what is wrong with the scene; problems whose key the file does
    /// not write stand at the table that lacks it.
    pub fn locate(&self, mut error: SceneError) -> SceneError {
        let spans = Spans::of(&self.text);
        for problem in &mut error.problems {
            let start = spans.start_of(&problem.path);
            problem.place = Some(Place::of(&self.name, &self.text, start));
        }
        in_order(&mut error.problems);
        error
    }
}

fn in_order(problems: &mut [Problem]) {
    let key = |problem: &Problem| problem.place.as_ref().map(|at| (at.line, at.column));
    problems.sort_by_key(key);
}

/// Turns serde's "unknown field `x`, expected one of `a`, `b`" into a suggestion.
fn with_suggestion(message: &str) -> String {
    if let Some(found) = message.strip_prefix("wanted exactly 1 element, ") {
        let how_many = if found.starts_with("found 0") {
            "none"
        } else {
            "more than one"
        };
        return format!(
            "shape names {how_many} of point, sphere, plane, surface, cylinder, capsule, cone, ellipsoid, torus, box, \
             implicit, mesh; give exactly one, such as shape = {{ sphere = {{ radius_m = 0.01 }} }}"
        );
    }
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    let (Some(given), true) = (quoted.first(), unknown) else {
        return message.to_owned();
    };
    if *given == "zenoh" {
        return "a scene does not decide where the bus leads: give its configuration to `palpate serve` as \
                --zenoh-config FILE, and take this table out"
            .into();
    }
    let known = &quoted[1..];
    let list = known.join(", ");
    let near = known
        .iter()
        .copied()
        .find(|word| word.starts_with(given))
        .unwrap_or_else(|| nearest(given, known.iter().copied()));
    let distance = strsim::damerau_levenshtein(given, near);
    if !near.is_empty() && (near.starts_with(given) || distance <= 1 + given.len() / 3) {
        format!("{given:?} is not known here; did you mean {near:?}? (known: {list})")
    } else {
        format!("{given:?} is not known here; known are {list}")
    }
}

#[cfg(test)]
mod tests;
