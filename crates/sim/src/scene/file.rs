//! Reads a scene file and says of everything that is wrong with it where it stands and how to mend
//! it.

use super::spec::{ContactMethod, ContactSpec, MAX_TOOLS, ModelSpec, SceneSpec, SurfaceSpec};
use palpate_geometry::surface::builtin::BUILTINS;
use place::Place;
use std::fmt;
use std::path::{Path, PathBuf};

mod body;
mod place;
mod tool;

/// A scene file, read and checked.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What it says.
    pub spec: SceneSpec,
    /// As it was written.
    pub text: String,
    /// Where its relative paths start.
    pub directory: PathBuf,
    /// SHA-256 of the text.
    pub sha256: [u8; 32],
}

/// All that is wrong with a scene file, in order of lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFileError {
    /// `file:line:column: what; mend`.
    pub problems: Vec<Problem>,
}

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Name of the file.
    pub file: String,
    /// From 1; 0 when the file could not be read at all.
    pub line: usize,
    /// From 1.
    pub column: usize,
    /// What is wrong and how to mend it.
    pub message: String,
}

impl fmt::Display for SceneFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, problem) in self.problems.iter().enumerate() {
            let Problem {
                file,
                line,
                column,
                message,
            } = problem;
            let end = if k > 0 { "\n" } else { "" };
            match line {
                0 => write!(f, "{end}{file}: {message}")?,
                _ => write!(f, "{end}{file}:{line}:{column}: {message}")?,
            }
        }
        Ok(())
    }
}

impl std::error::Error for SceneFileError {}

/// Reads a scene file.
///
/// # Errors
/// Everything that is wrong with it.
pub fn load(path: &Path) -> Result<Loaded, SceneFileError> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|e| SceneFileError {
        problems: vec![Problem {
            file: name.clone(),
            line: 0,
            column: 0,
            message: format!("cannot be read: {e}"),
        }],
    })?;
    parse(&text, &name, path.parent().unwrap_or(Path::new(".")))
}

/// Reads scene text; `name` is for messages, `directory` is where relative paths start.
///
/// # Errors
/// Everything that is wrong with it.
pub fn parse(text: &str, name: &str, directory: &Path) -> Result<Loaded, SceneFileError> {
    let place = Place { text, file: name };
    let spec: SceneSpec = match toml::from_str(text) {
        Ok(spec) => spec,
        Err(error) => {
            let at = error.span().unwrap_or(0..0);
            return Err(SceneFileError {
                problems: vec![place.problem(at, with_suggestion(error.message()))],
            });
        }
    };
    let mut check = Check {
        place,
        problems: Vec::new(),
    };
    check.scene(&spec, directory);
    if !check.problems.is_empty() {
        check
            .problems
            .sort_by_key(|problem| (problem.line, problem.column));
        return Err(SceneFileError {
            problems: check.problems,
        });
    }
    let mut spec = spec;
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
        directory: directory.to_owned(),
        sha256,
    })
}

/// Turns serde's "unknown field `x`, expected one of `a`, `b`" into a suggestion.
fn with_suggestion(message: &str) -> String {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    let (Some(given), true) = (quoted.first(), unknown) else {
        return message.to_owned();
    };
    let known = &quoted[1..];
    let nearest = known
        .iter()
        .min_by_key(|word| strsim::damerau_levenshtein(given, word));
    let list = known.join(", ");
    let near = known
        .iter()
        .find(|word| word.starts_with(given))
        .or(nearest);
    match near.filter(|word| {
        word.starts_with(given) || strsim::damerau_levenshtein(given, word) <= 1 + given.len() / 3
    }) {
        Some(word) => {
            format!("{given:?} is not known here; did you mean {word:?}? (known: {list})")
        }
        None => format!("{given:?} is not known here; known are {list}"),
    }
}

struct Check<'a> {
    place: Place<'a>,
    problems: Vec<Problem>,
}

impl Check<'_> {
    fn refuse(&mut self, table: &str, index: usize, key: &str, message: impl Into<String>) {
        let at = self.place.find(table, index, key);
        let problem = self.place.problem(at, message.into());
        self.problems.push(problem);
    }

    fn refuse_part(
        &mut self,
        table: &str,
        index: usize,
        part: &str,
        nth: usize,
        message: impl Into<String>,
    ) {
        let at = self.place.find_part(table, index, part, nth);
        let problem = self.place.problem(at, message.into());
        self.problems.push(problem);
    }

    fn above_zero(&mut self, table: &str, index: usize, key: &str, value: f64, unit: &str) {
        if !(value.is_finite() && value > 0.0) {
            self.refuse(
                table,
                index,
                key,
                format!("{key} is {value}; it must be a number above 0 {unit}"),
            );
        }
    }

    fn not_below_zero(&mut self, table: &str, index: usize, key: &str, value: f64, unit: &str) {
        if !(value.is_finite() && value >= 0.0) {
            self.refuse(
                table,
                index,
                key,
                format!("{key} is {value}; it must be 0 or more {unit}"),
            );
        }
    }

    fn finite(&mut self, table: &str, index: usize, key: &str, values: &[f64]) {
        if values.iter().any(|x| !x.is_finite()) {
            self.refuse(
                table,
                index,
                key,
                format!("{key} has a value that is not finite"),
            );
        }
    }

    fn direction(&mut self, table: &str, index: usize, key: &str, v: &[f64; 3]) {
        let length = v.iter().map(|x| x * x).sum::<f64>();
        if !(length.is_finite() && length > 0.0) {
            self.refuse(
                table,
                index,
                key,
                format!("{key} {v:?} has no direction; give a vector of any length above 0"),
            );
        }
    }

    fn pose(&mut self, table: &str, index: usize, pose: &super::spec::PoseSpec) {
        self.finite(table, index, "position", &pose.position);
        let norm = pose.orientation.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm.is_nan() || (norm - 1.0).abs() > 1e-6 {
            let message =
                format!("orientation has length {norm}; give a unit quaternion [x, y, z, w]");
            self.refuse(table, index, "orientation", message);
        }
    }

    fn id(&mut self, table: &str, index: usize, id: &str, others: &[&str]) {
        let fits = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_' || b == b'-';
        if !((1..=64).contains(&id.len()) && id.bytes().all(fits)) {
            self.refuse(
                table,
                index,
                "id",
                format!("{id:?} is no id; use 1 to 64 of a-z, 0-9, '_' and '-'"),
            );
        }
        if others[..index].contains(&id) {
            self.refuse(
                table,
                index,
                "id",
                format!("id {id:?} is taken by an earlier {table}"),
            );
        }
    }

    fn scene(&mut self, spec: &SceneSpec, directory: &Path) {
        let rate = spec.loop_.rate_hz;
        if !(1..=10_000).contains(&rate) {
            self.refuse(
                "loop",
                0,
                "rate_hz",
                format!("rate_hz is {rate}; it must be 1 to 10000"),
            );
        }
        self.finite("gravity", 0, "acceleration", &spec.gravity.acceleration);
        self.not_below_zero("gravity", 0, "smoothing_s", spec.gravity.smoothing_s, "s");
        if let Some(id) = &spec.gravity.frame
            && !spec.tools.iter().any(|tool| &tool.id == id)
        {
            self.refuse(
                "gravity",
                0,
                "frame",
                format!("there is no tool {id:?} in this scene"),
            );
        }
        self.above_zero("record", 0, "keyframe_s", spec.record.keyframe_s, "s");
        self.above_zero("record", 0, "net_hz", spec.record.net_hz, "Hz");
        self.above_zero("record", 0, "view_hz", spec.record.view_hz, "Hz");
        if spec.bodies.is_empty() {
            self.refuse("body", 0, "body", "a scene needs at least one [[body]]");
        }
        if spec.tools.len() > MAX_TOOLS {
            let message = format!(
                "{} tools; a scene has at most {MAX_TOOLS} tools",
                spec.tools.len()
            );
            self.refuse("tool", MAX_TOOLS, "id", message);
        }
        let bodies: Vec<&str> = spec.bodies.iter().map(|body| body.id.as_str()).collect();
        let tools: Vec<&str> = spec.tools.iter().map(|tool| tool.id.as_str()).collect();
        for (b, body) in spec.bodies.iter().enumerate() {
            self.id("body", b, &body.id, &bodies);
            self.body(b, body, directory);
        }
        for (t, tool) in spec.tools.iter().enumerate() {
            self.id("tool", t, &tool.id, &tools);
            self.tool(t, tool, directory);
        }
        for (c, contact) in spec.contacts.iter().enumerate() {
            self.contact(c, contact, &tools, &bodies);
        }
    }

    fn contact(&mut self, c: usize, contact: &ContactSpec, tools: &[&str], bodies: &[&str]) {
        let [holder, body] = &contact.pair;
        if !tools.contains(&holder.as_str()) && !bodies.contains(&holder.as_str()) {
            let message =
                format!("there is no tool and no body {holder:?}; pairs are [tool or body, body]");
            self.refuse("contact", c, "pair", message);
        }
        if !bodies.contains(&body.as_str()) {
            let message = format!("there is no body {body:?}; pairs are [tool or body, body]");
            self.refuse("contact", c, "pair", message);
        }
        if let Some(friction) = &contact.friction {
            self.friction("contact", c, friction);
        }
        match (contact.resolution, contact.method) {
            (Some(resolution), ContactMethod::Spheres) => {
                if resolution.iter().any(|n| !(4..=1_000).contains(n)) {
                    let message =
                        format!("resolution is {resolution:?}; each of the two must be 4 to 1000");
                    self.refuse("contact", c, "resolution", message);
                }
            }
            (Some(_), _) => {
                self.refuse(
                    "contact",
                    c,
                    "resolution",
                    "only method = \"spheres\" has a resolution",
                );
            }
            (None, _) => {}
        }
    }

    fn surface(&mut self, table: &str, index: usize, surface: &SurfaceSpec, directory: &Path) {
        let given = usize::from(surface.builtin.is_some())
            + usize::from(surface.file.is_some())
            + usize::from(surface.inline.is_some());
        if given != 1 {
            self.refuse(
                table,
                index,
                "surface",
                "surface needs exactly one of builtin, file, inline",
            );
        }
        if let Some(name) = &surface.builtin
            && !BUILTINS.contains(&name.as_str())
        {
            let near = BUILTINS
                .iter()
                .min_by_key(|known| strsim::damerau_levenshtein(name, known))
                .unwrap_or(&"");
            let message = format!(
                "{name:?} is no builtin surface; did you mean {near:?}? (known: {})",
                BUILTINS.join(", ")
            );
            self.refuse(table, index, "builtin", message);
        }
        if let Some(net) = surface.net
            && net.iter().any(|&n| n < 2)
        {
            self.refuse(
                table,
                index,
                "net",
                format!("net {net:?} is too small; at least 4 in each direction are needed"),
            );
        }
        if let Some(size) = surface.size {
            self.above_zero(table, index, "size", size, "m");
        }
        if let Some(file) = &surface.file
            && !directory.join(file).is_file()
        {
            let path = directory.join(file);
            self.refuse(
                table,
                index,
                "file",
                format!(
                    "there is no file {}; paths start at the scene file",
                    path.display()
                ),
            );
        }
    }

    fn body(&mut self, b: usize, body: &super::spec::BodySpec, directory: &Path) {
        self.surface("body", b, &body.surface, directory);
        self.pose("body", b, &body.pose);
        self.deforming(b, body);
        if body.self_contact && body.model == ModelSpec::Rigid {
            let message = "a rigid body cannot come to touch itself; give it a deforming model or drop self_contact";
            self.refuse("body", b, "self_contact", message);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "[[body]]\nid = \"drop\"\nsurface = { builtin = \"teardrop\" }\n\n[[tool]]\nid = \"ball\"\n";

    fn problems(text: &str) -> String {
        parse(text, "s.toml", Path::new("."))
            .map_or_else(|e| e.to_string(), |_| "no problem".into())
    }

    #[test]
    fn ten_lines_make_a_scene() {
        let loaded = parse(GOOD, "dir/drop.toml", Path::new(".")).unwrap();
        assert_eq!(loaded.spec.name.as_deref(), Some("drop"));
        assert_eq!(loaded.spec.loop_.rate_hz, 1_000);
    }

    #[test]
    fn every_problem_is_told_with_its_line() {
        let cases: [(&str, &str); 18] = [
            (
                "[loop]\nrate_hz = 0\n",
                "s.toml:2:1: rate_hz is 0; it must be 1 to 10000",
            ),
            (
                "[loop]\nrate = 5\n",
                "s.toml:2:1: \"rate\" is not known here; did you mean \"rate_hz\"?",
            ),
            ("[loop\n", "s.toml:1:6: "),
            (
                "[[body]]\nid = \"x\"\nsurface = { builtin = \"teardrip\" }\n",
                "s.toml:3:13: \"teardrip\" is no builtin surface; did you mean \"teardrop\"?",
            ),
            (
                "[[body]]\nid = \"x\"\nsurface = { file = \"no.json\" }\n",
                "s.toml:3:13: there is no file",
            ),
            (
                "[[body]]\nid = \"x\"\nsurface = {}\n",
                "s.toml:3:1: surface needs exactly one",
            ),
            (
                "[[body]]\nid = \"x\"\nsurface = { builtin = \"sheet\" }\n[body.material]\nyoung_pa = -1.0\n",
                "s.toml:5:1: young_pa is -1",
            ),
            (
                "[[body]]\nid = \"x\"\nsurface = { builtin = \"sheet\" }\nlattice = { layers = 0 }\n",
                "s.toml:4:13: layers is 0",
            ),
            (
                "[[body]]\nid = \"X y\"\nsurface = { builtin = \"sheet\" }\n",
                "s.toml:2:1: \"X y\" is no id",
            ),
            (
                "[[tool]]\nid = \"a\"\nshape = { sphere = { radius_m = 0.0 } }\n",
                "s.toml:3:22: radius_m is 0",
            ),
            (
                "[[tool]]\nid = \"a\"\n[[tool]]\nid = \"a\"\n",
                "s.toml:4:1: id \"a\" is taken",
            ),
            (
                "[[contact]]\npair = [\"ball\", \"drop\"]\nmethod = \"spheres\"\nresolution = [2, 82]\n",
                "s.toml:4:1: resolution is [2, 82]; each of the two must be 4 to 1000",
            ),
            (
                "[[body]]\nid = \"x\"\nsurface = { builtin = \"sheet\" }\nself_contact = true\n",
                "s.toml:4:1: a rigid body cannot come to touch itself",
            ),
            (
                "[[contact]]\npair = [\"pen\", \"drop\"]\n",
                "s.toml:2:1: there is no tool and no body \"pen\"",
            ),
            (
                "[[tool]]\nid = \"a\"\nfriction = { mu = -0.1 }\n",
                "s.toml:3:14: mu is -0.1; it must be 0 or more",
            ),
            (
                "[[tool]]\nid = \"a\"\nfriction = { mu = 0.3, mu_kinetic = 0.4 }\n",
                "s.toml:3:24: mu_kinetic is 0.4; it must be 0 to mu, which is 0.3",
            ),
            (
                "[[tool]]\nid = \"a\"\ngrip = { force_max_n = -1 }\n",
                "s.toml:3:1: the grip's force_max_n is -1",
            ),
            (
                "[[contact]]\npair = [\"ball\", \"drop\"]\nfriction = { mu = inf }\n",
                "s.toml:3:14: mu is inf; it must be 0 or more",
            ),
        ];
        for (text, expected) in cases {
            // A whole scene around the case, after it, so that lines count from the case.
            let whole = if text.contains("[[body]]") {
                text.to_owned()
            } else {
                format!("{text}\n{GOOD}")
            };
            let told = problems(&whole);
            assert!(
                told.lines().any(|line| line.starts_with(expected)),
                "{text:?} gives\n{told}\nnot\n{expected}"
            );
        }
    }

    #[test]
    fn all_problems_are_listed_not_only_the_first() {
        let told = problems(
            "[loop]\nrate_hz = 20000\n[record]\nnet_hz = 0.0\n[[body]]\nid = \"x\"\nsurface = { builtin = \"cube\" }\n",
        );
        assert_eq!(told.lines().count(), 3, "{told}");
    }
}
