//! From the number of a run to its values, motion and seed.

use super::asked::Asked;
use super::error::BatchError;
use super::files::{FileBytes, Folder, Kept};
use super::spec::{HandSpec, MotionSpec, Seeds, SweepSpec, Varied};
use crate::scenario::{SCENES, change};
use palpate_client::device::{DeviceModel, Hand, Kind};
use palpate_proto::text::located;
use palpate_sim::scene::file::{self, Loaded};
use palpate_sim::scene::inline_files;
use palpate_sim::scene::spec::Clock;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Value;

/// Most runs of a sweep.
const MOST_RUNS: usize = 1_000_000;
/// Most ticks of a run.
const MOST_S: f64 = 3_600.0;

/// A run before it runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// From 0. Seeds count fastest, then motions, then values, the last key fastest.
    pub run: usize,
    /// Number of its values: runs of the same sample have the same scene.
    pub sample: usize,
    /// In the order of [`Plan::keys`].
    pub values: Vec<Value>,
    /// Index into the motions.
    pub motion: usize,
    /// Of devices, hands and networks.
    pub seed: u64,
}

/// A hand, with the files that it names.
#[derive(Clone, Debug)]
pub(super) struct HandPlan {
    pub spec: HandSpec,
    /// Text of the motion file, if it is one.
    pub motion: Option<String>,
    /// Device and hand, unless the motion is followed exactly.
    pub device: Option<(DeviceModel, Hand)>,
}

/// A sweep, checked.
#[derive(Clone, Debug)]
pub struct Plan {
    scene: toml::Table,
    scene_name: String,
    directory: PathBuf,
    files: Arc<Kept>,
    varied: Vec<Varied>,
    random: Option<super::spec::RandomSpec>,
    seeds: Seeds,
    pub(super) for_s: f64,
    /// Columns beside the usual ones.
    pub(super) columns: Vec<String>,
    /// By motion: its name and its hands by tool.
    pub(super) motions: Vec<(String, BTreeMap<String, HandPlan>)>,
    samples: usize,
}

impl Plan {
    pub(super) fn new(
        spec: SweepSpec,
        name: &str,
        directory: &Path,
        files: Kept,
    ) -> Result<Self, BatchError> {
        let wrong = |key: &str, reason: String| BatchError::Key {
            sweep: name.to_owned(),
            key: key.to_owned(),
            reason,
        };
        if !(spec.for_s > 0.0 && spec.for_s <= MOST_S) {
            let reason = format!("is {}; above 0 and at most {MOST_S} s", spec.for_s);
            return Err(wrong("for_s", reason));
        }
        for column in &spec.columns {
            Asked::named(column).map_err(|reason| wrong("columns", reason))?;
        }
        let mut varied = Vec::new();
        for (key, value) in &spec.vary {
            let entry = Varied::new(key, value, spec.random.is_some());
            varied.push(entry.map_err(|reason| wrong(&format!("vary.{key:?}"), reason))?);
        }
        let product = |counts: &[usize]| {
            (counts.iter()).try_fold(1usize, |product, count| product.checked_mul(*count))
        };
        let counts: Vec<usize> = varied.iter().map(Varied::count).collect();
        let samples = match spec.random {
            Some(random) => Some(random.samples),
            None => product(&counts),
        };
        let seeds = spec.seeds.count();
        let all = samples.and_then(|samples| product(&[samples, spec.motions.len(), seeds]));
        let Some((samples, 1..=MOST_RUNS)) = samples.zip(all) else {
            let all = all.map_or("more than can be counted".to_owned(), |all| all.to_string());
            let reason = format!("{all} runs; from 1 to {MOST_RUNS}: values × motions × seeds");
            return Err(wrong("vary", reason));
        };
        let (text, inside, scene_name) = scene_text(&spec.scene, directory, &files)?;
        let mut scene: toml::Table = toml::from_str(&text)
            .map_err(|error| wrong("scene", located(&text, error.span(), error.message())))?;
        for (key, value) in &spec.set {
            change::set(&mut scene, key, value)
                .map_err(|reason| wrong(&format!("set.{key:?}"), reason))?;
        }
        // The name of a motion, device or hand, or else a file.
        let read = |name: &str| read_text(&directory.join(name), &files);
        let mut motions = Vec::new();
        for motion in &spec.motions {
            motions.push((motion.name.clone(), hands(motion, &wrong, &read)?));
        }
        let names = spec.motions.iter().map(|motion| &motion.name);
        if let Some(twice) =
            (names.clone()).find(|name| names.clone().filter(|other| other == name).count() > 1)
        {
            return Err(wrong("motion", format!("two are named {twice:?}")));
        }
        let plan = Self {
            scene,
            scene_name,
            directory: inside,
            files: Arc::new(files),
            varied,
            random: spec.random,
            seeds: spec.seeds,
            for_s: spec.for_s,
            columns: spec.columns,
            motions,
            samples,
        };
        // A misspelt key would fail in every run: better reported before the first.
        let first = plan.case(0);
        let loaded = plan.scene_of(&first).map_err(|reason| match reason {
            Unread::Path(reason) => wrong("vary", reason),
            Unread::Scene(source) => BatchError::Scene {
                sweep: name.to_owned(),
                source,
            },
        })?;
        let tools: Vec<&str> = (loaded.spec.tools.iter())
            .map(|tool| tool.id.as_str())
            .collect();
        for (motion, hands) in &plan.motions {
            if let Some(tool) = hands.keys().find(|tool| !tools.contains(&tool.as_str())) {
                let reason = format!("the scene has no tool {tool:?}; it has {tools:?}");
                return Err(wrong(&format!("motion {motion:?}: hands"), reason));
            }
        }
        Ok(plan)
    }

    /// Runs.
    pub fn count(&self) -> usize {
        self.samples * self.motions.len() * self.seeds.count()
    }

    /// Keys of the scene that vary, in the order of their names.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.varied.iter().map(|varied| varied.key.as_str())
    }

    pub(super) fn varied(&self) -> &[Varied] {
        &self.varied
    }

    /// Name of a motion.
    pub fn motion_name(&self, motion: usize) -> &str {
        &self.motions[motion].0
    }

    /// Tools that any motion moves, in the order of their names.
    pub fn tools(&self) -> Vec<&str> {
        let mut tools: Vec<&str> = (self.motions.iter())
            .flat_map(|(_, hands)| hands.keys().map(String::as_str))
            .collect();
        tools.sort_unstable();
        tools.dedup();
        tools
    }

    /// A run by its number.
    pub fn case(&self, run: usize) -> Case {
        let (seeds, motions) = (self.seeds.count(), self.motions.len());
        let sample = run / seeds / motions;
        Case {
            run,
            sample,
            values: self.values(sample),
            motion: run / seeds % motions,
            seed: self.seeds.at(run % seeds),
        }
    }

    fn values(&self, sample: usize) -> Vec<Value> {
        if let Some(random) = self.random {
            // Each key draws by its own name: another one that is added leaves it as it was.
            let drawn = |varied: &Varied| {
                let at = (random.seed, sample as u64, &varied.key);
                varied.drawn(share(at.0, at.1, at.2))
            };
            return self.varied.iter().map(drawn).collect();
        }
        let mut left = sample;
        let mut values: Vec<Value> = (self.varied.iter().rev())
            .map(|varied| {
                let index = left % varied.count();
                left /= varied.count();
                varied.at(index)
            })
            .collect();
        values.reverse();
        values
    }

    /// The scene of a run, read, in lockstep, not built.
    pub(super) fn scene_of(&self, case: &Case) -> Result<Loaded, Unread> {
        let mut table = self.scene.clone();
        for (varied, value) in self.varied.iter().zip(&case.values) {
            change::set(&mut table, &varied.key, value).map_err(Unread::Path)?;
        }
        let text = toml::to_string(&table).map_err(|error| Unread::Path(error.to_string()))?;
        let mut loaded =
            file::parse(&text, &self.scene_name, &self.directory).map_err(Unread::Scene)?;
        loaded.spec.loop_.clock = Clock::Lockstep;
        loaded.methods = palpate_thesis::METHODS;
        Ok(loaded)
    }

    /// The files that scenes name.
    pub(super) fn scene_files(&self) -> Folder<'_> {
        Folder {
            kept: &self.files,
            path: &self.directory,
        }
    }

    /// All files that the runs read: only words in the scene name one.
    pub(super) fn files(&self) -> FileBytes {
        let mut seen = BTreeSet::new();
        for sample in 0..self.samples {
            let case = self.case(sample * self.motions.len() * self.seeds.count());
            let words = case.values.iter().map(|value| match value {
                Value::Integer(_) | Value::Float(_) | Value::Boolean(_) => String::new(),
                words => words.to_string(),
            });
            if seen.insert(words.collect::<Vec<_>>())
                && let Ok(loaded) = self.scene_of(&case)
            {
                // What cannot be read is kept as that, and is in the row of its run.
                let _ = inline_files(&loaded.spec, self.scene_files());
            }
        }
        self.files.all()
    }
}

/// Why the scene of a run does not read.
pub(super) enum Unread {
    Path(String),
    Scene(palpate_sim::scene::SceneError),
}

impl std::fmt::Display for Unread {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Path(reason) => out.write_str(reason),
            Self::Scene(error) => error.fmt(out),
        }
    }
}

/// Text of the scene, where its paths start, and its name.
fn scene_text(
    scene: &str,
    directory: &Path,
    files: &Kept,
) -> Result<(String, PathBuf, String), BatchError> {
    if let Some(name) = scene.strip_prefix("builtin:") {
        let Some((_, text)) = SCENES.iter().find(|(known, _)| *known == name) else {
            let known = SCENES.map(|(known, _)| known).join(", ");
            return Err(BatchError::File {
                path: scene.to_owned(),
                reason: format!("no scene of this program; it has {known}"),
            });
        };
        return Ok((
            (*text).to_owned(),
            PathBuf::from("."),
            format!("{name}.toml"),
        ));
    }
    let path = directory.join(scene);
    let text = read_text(&path, files)?;
    let inside = path.parent().unwrap_or(Path::new(".")).to_owned();
    Ok((text, inside, path.display().to_string()))
}

fn read_text(path: &Path, files: &Kept) -> Result<String, BatchError> {
    files
        .text(path)
        .map_err(|error| BatchError::file(path, error))
}

/// Checks the hands of a motion and reads their files.
fn hands(
    motion: &MotionSpec,
    wrong: &dyn Fn(&str, String) -> BatchError,
    read: &dyn Fn(&str) -> Result<String, BatchError>,
) -> Result<BTreeMap<String, HandPlan>, BatchError> {
    let mut hands = BTreeMap::new();
    for (tool, spec) in &motion.hands {
        let key = format!("motion {:?}: hands.{tool}", motion.name);
        let wrong = |reason: String| wrong(&key, reason);
        let is_file = |name: &str| name.ends_with(".toml");
        let text = match is_file(&spec.motion) {
            true => Some(read(&spec.motion)?),
            false => Kind::named(&spec.motion)
                .map(|_| None)
                .map_err(|error| wrong(error.to_string()))?,
        };
        let device = match &spec.device {
            None => {
                let plain = HandSpec {
                    motion: spec.motion.clone(),
                    depth_m: spec.depth_m,
                    ..HandSpec::default()
                };
                if *spec != plain {
                    return Err(wrong(
                        "hand, tremor_m, delay_s, jitter_s, loss, reorder and passivity are those of a device: name one, device = \"ideal\""
                            .into(),
                    ));
                }
                None
            }
            Some(name) => {
                let refused = |error: palpate_client::device::DeviceError| wrong(error.to_string());
                let model = match is_file(name) {
                    true => DeviceModel::from_toml(&read(name)?, name),
                    false => DeviceModel::preset(name),
                };
                let named = spec.hand.as_deref().unwrap_or("relaxed");
                let mut hand = match is_file(named) {
                    true => Hand::from_toml(&read(named)?, named),
                    false => Hand::preset(named),
                }
                .map_err(refused)?;
                if let Some(tremor_m) = spec.tremor_m {
                    hand = Hand { tremor_m, ..hand }.checked().map_err(refused)?;
                }
                Some((model.map_err(refused)?, hand))
            }
        };
        if spec.depth_m.is_nan() || spec.depth_m.abs() > 1.0 {
            return Err(wrong(format!("depth_m is {}; at most 1 m", spec.depth_m)));
        }
        let spec = spec.clone();
        let plan = HandPlan {
            spec,
            motion: text,
            device,
        };
        hands.insert(tool.clone(), plan);
    }
    Ok(hands)
}

impl Default for HandSpec {
    fn default() -> Self {
        Self {
            motion: String::new(),
            depth_m: 0.0,
            device: None,
            hand: None,
            tremor_m: None,
            delay_s: 0.0,
            jitter_s: 0.0,
            loss: 0.0,
            reorder: 0.0,
            passivity: false,
        }
    }
}

impl Seeds {
    fn count(&self) -> usize {
        match self {
            Self::List(list) => list.len(),
            Self::From { count, .. } => *count,
        }
    }

    fn at(&self, index: usize) -> u64 {
        match self {
            Self::List(list) => list[index],
            Self::From { from, .. } => from.wrapping_add(index as u64),
        }
    }
}

/// A number from [0, 1) for a seed, a sample and a key: the first output of SplitMix64 from their
/// mix.
fn share(seed: u64, sample: u64, key: &str) -> f64 {
    let mut state = mixed(seed, sample, key);
    state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((state ^ (state >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// FNV-1a over the bytes of all three.
fn mixed(seed: u64, sample: u64, key: &str) -> u64 {
    let bytes = (seed.to_le_bytes().into_iter())
        .chain(sample.to_le_bytes())
        .chain(key.bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
