//! The recorder: what to keep, a port for the tick thread, a voice for the bus, a thread that
//! writes.

use super::disk::{Disk, FileSystem};
use super::file::SessionFile;
use super::format::WriteError;
use super::head::Head;
use super::keeper::{Keeper, KeeperEnds, KeptScene, Mail, Shelf};
use super::memory::Memory;
use super::parts::Split;
use super::port::{RecorderPort, port};
use super::report::RecordingReport;
use super::views::Views;
use palpate_drive::archive::{Archive, ArchiveNews, ArchiveRequest};
use palpate_drive::journal::JournalGauges;
use palpate_proto::text::is_unprintable;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::SceneSpec;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// What to record.
#[derive(Clone)]
pub struct RecorderSettings {
    /// Record to this file from the first tick on.
    pub path: Option<PathBuf>,
    /// Where recordings and snapshots go that someone asks for.
    pub directory: PathBuf,
    /// How much of the past to keep in memory for snapshots.
    pub ring: Option<Duration>,
    /// When a new file begins.
    pub split: Split,
    /// Scene file as the user wrote it.
    pub scene_text: String,
    /// Scene with its surfaces written out.
    pub effective: SceneSpec,
    /// More for the metadata record at the start.
    pub extra: BTreeMap<String, String>,
    /// Where files go.
    pub disk: Arc<dyn Disk>,
}

impl RecorderSettings {
    /// Records nothing yet. `effective` is the scene with its surfaces written out.
    pub fn new(scene_text: &str, effective: &SceneSpec) -> Self {
        Self {
            path: None,
            directory: PathBuf::from("recordings/local"),
            ring: None,
            split: Split::default(),
            scene_text: scene_text.to_owned(),
            effective: effective.clone(),
            extra: BTreeMap::new(),
            disk: Arc::new(FileSystem),
        }
    }

    /// Records to a file from the first tick on.
    pub fn to(self, path: &Path) -> Self {
        Self {
            path: Some(path.to_owned()),
            ..self
        }
    }
}

/// A running recorder.
pub struct Recorder {
    gauges: Arc<JournalGauges>,
    changes: SceneChanges,
    stop: Arc<AtomicBool>,
    mail: Sender<Mail>,
    news: Option<Receiver<ArchiveNews>>,
    thread: JoinHandle<RecordingReport>,
}

impl Recorder {
    /// Starts the thread, and the file if one is wanted at once.
    ///
    /// # Errors
    /// A file that cannot be created or is there already, a disk that is full, or a scene without a
    /// text form.
    pub fn start(
        settings: RecorderSettings,
        scene: &Scene,
    ) -> Result<(Self, RecorderPort), WriteError> {
        let path = settings.path.clone();
        let changes_text = (settings.scene_text.clone(), settings.extra.clone());
        let (keeper, mail, news_out, port) = keeper(settings, scene)?;
        let (gauges, wanted) = (keeper.ends.gauges.clone(), keeper.ends.wanted.clone());
        let stop = keeper.ends.stop.clone();
        let thread = std::thread::Builder::new()
            .name("palpate-recorder".into())
            .spawn(move || keeper.run())
            .map_err(|source| WriteError::Io {
                path: path.unwrap_or_default(),
                source,
            })?;
        let (scene_text, extra) = changes_text;
        let changes = SceneChanges {
            gauges: gauges.clone(),
            wanted,
            mail: mail.clone(),
            scene_text,
            extra,
        };
        Ok((
            Self {
                gauges,
                changes,
                stop,
                mail,
                news: Some(news_out),
                thread,
            },
            port,
        ))
    }

    /// For whoever gives the loop other scenes.
    pub fn changes(&self) -> SceneChanges {
        self.changes.clone()
    }

    /// Bytes, losses and state, live.
    pub fn gauges(&self) -> Arc<JournalGauges> {
        self.gauges.clone()
    }

    /// What the bus talks to; there is one.
    pub fn archive(&mut self) -> Option<Box<dyn Archive>> {
        let news = self.news.take()?;
        Some(Box::new(Post {
            mail: self.mail.clone(),
            news,
        }))
    }

    /// Writes what is left, ends files and gives them their names. Call after the tick thread has
    /// ended.
    pub fn finish(self) -> RecordingReport {
        self.stop.store(true, Ordering::Release);
        self.thread.join().unwrap_or_else(|_| RecordingReport {
            failure: Some(WriteError::Io {
                path: PathBuf::new(),
                source: std::io::Error::other("the recorder thread panicked"),
            }),
            ..RecordingReport::default()
        })
    }
}

/// A recorder without a thread, for simulations: whoever has the clock decides when it takes what has
/// come.
pub struct SteppedRecorder {
    keeper: Keeper,
}

impl SteppedRecorder {
    /// How often a recorder with a thread takes what has come.
    pub const TURN: Duration = super::keeper::TURN;

    /// As [`Recorder::start`].
    ///
    /// # Errors
    /// As [`Recorder::start`].
    pub fn new(
        settings: RecorderSettings,
        scene: &Scene,
    ) -> Result<(Self, RecorderPort), WriteError> {
        let (keeper, _, _, port) = keeper(settings, scene)?;
        Ok((Self { keeper }, port))
    }

    /// Takes what has come.
    pub fn turn(&mut self) {
        self.keeper.turn(false);
    }

    /// As [`Recorder::finish`].
    pub fn finish(mut self) -> RecordingReport {
        self.keeper.turn(true);
        self.keeper.end()
    }

    /// Bytes, losses and state.
    pub fn gauges(&self) -> &JournalGauges {
        &self.keeper.ends.gauges
    }
}

/// What a recorder's thread runs, and the ends that stay with others.
fn keeper(
    settings: RecorderSettings,
    scene: &Scene,
) -> Result<(Keeper, Sender<Mail>, Receiver<ArchiveNews>, RecorderPort), WriteError> {
    let gauges = Arc::new(JournalGauges::default());
    let wanted = Arc::new(AtomicU32::new(0));
    let stop = Arc::new(AtomicBool::new(false));
    let (port, stream) = port(scene, gauges.clone(), wanted.clone());
    let mut head = Head::new(
        scene,
        &settings.scene_text,
        &settings.effective,
        stream.bodies.clone(),
    )?;
    head.extra.extend(settings.extra);
    let views = Views::of(scene);
    let head_bytes = SessionFile::head_bytes(&head, views.clone());
    let head_bytes = head_bytes.map_err(|source| WriteError::Io {
        path: settings.path.clone().unwrap_or_default(),
        source,
    })?;
    settings.split.check(head_bytes)?;
    let memory = settings
        .ring
        .map(|ring| Memory::new((ring.as_secs_f64() / scene.dt_s).round() as u64));
    let (mail, mail_out) = channel();
    let (news, news_out) = channel();
    let mut keeper = Keeper::new(
        KeptScene {
            stream,
            head: Arc::new(head),
            views,
        },
        Shelf {
            disk: settings.disk,
            directory: settings.directory,
            split: settings.split,
        },
        memory,
        KeeperEnds {
            gauges,
            wanted,
            stop,
            mail: mail_out,
            news,
        },
    );
    if let Some(path) = &settings.path {
        keeper.begin(path, None)?;
    }
    Ok((keeper, mail, news_out, port))
}

/// Prepares the recorder for scenes that the loop may go on with.
#[derive(Clone)]
pub struct SceneChanges {
    gauges: Arc<JournalGauges>,
    wanted: Arc<AtomicU32>,
    mail: Sender<Mail>,
    scene_text: String,
    extra: BTreeMap<String, String>,
}

impl SceneChanges {
    /// The journal of another scene. `what` says how it came to be; the file that begins with it
    /// says so too. A scene that the loop never takes leaves no trace.
    ///
    /// # Errors
    /// A scene without a text form.
    pub fn journal(&self, scene: &Scene, what: &str) -> Result<RecorderPort, WriteError> {
        let (port, stream) = port(scene, self.gauges.clone(), self.wanted.clone());
        let mut head = Head::new(scene, &self.scene_text, &scene.spec, stream.bodies.clone())?;
        head.extra.extend(self.extra.clone());
        head.extra.insert("scene_change".into(), what.to_owned());
        let next = KeptScene {
            stream,
            head: Arc::new(head),
            views: Views::of(scene),
        };
        // Without a recorder thread there is nothing to keep.
        let _ = self.mail.send(Mail::Next(Box::new(next)));
        Ok(port)
    }
}

struct Post {
    mail: Sender<Mail>,
    news: Receiver<ArchiveNews>,
}

impl Archive for Post {
    fn event(&mut self, tick: u64, kind: &str, detail: &str) {
        let _ = self.mail.send(Mail::Event {
            tick,
            kind: kind.into(),
            detail: detail.into(),
        });
    }

    fn ask(&mut self, id: u64, request: ArchiveRequest) {
        let _ = self.mail.send(Mail::Ask { id, request });
    }

    fn news(&mut self) -> Option<ArchiveNews> {
        self.news.try_recv().ok()
    }
}

/// Where a recording goes when no one said: a file that is not there yet.
pub fn default_path(directory: &Path, stem: &str) -> PathBuf {
    let seconds = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .map_or(0, |t| t.as_secs());
    let name = |suffix: String| directory.join(format!("{stem}-{seconds}{suffix}.mcap"));
    let free = |path: &PathBuf| !path.exists() && !super::file::part_of(path).exists();
    let first = name(String::new());
    if free(&first) {
        return first;
    }
    (2..)
        .map(|k| name(format!("-{k}")))
        .find(free)
        .unwrap_or(first)
}

/// A client's name for a file, in our directory: it chooses the name, not the place.
pub(super) fn place(
    directory: &Path,
    name: Option<PathBuf>,
    stem: &str,
) -> Result<PathBuf, String> {
    let Some(name) = name else {
        return Ok(default_path(directory, stem));
    };
    check_name(&name).map_err(|error| error.to_string())?;
    let text = name.to_str().and_then(|name| name.strip_suffix(".mcap"));
    // Other systems separate by a backslash, shells read a dash as an option and hide what begins
    // with a dot; a blank at an end is not seen.
    let plain = text.is_some_and(|stem| {
        !stem.is_empty()
            && !stem.contains(['/', '\\'])
            && !stem.starts_with(['.', '-', '~'])
            && stem.trim() == stem
    });
    match plain {
        true => Ok(directory.join(name)),
        false => Err(format!(
            "{name:?} is not a valid file name; use one like session.mcap, without a directory: the file is written to {}",
            directory.display()
        )),
    }
}

/// Refuses the name of a file that terminals, logs and pages would not show as it is.
pub(super) fn check_name(path: &Path) -> Result<(), WriteError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match name.chars().find(|c| is_unprintable(*c)) {
        None => Ok(()),
        Some(character) => Err(WriteError::Name {
            name: name.into_owned(),
            character,
        }),
    }
}
