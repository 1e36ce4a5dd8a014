//! Scenes remade while they run: merge, isolate, truncate, cut.
//!
//! ```text
//! bus ── request, bodies as they stand ──▶ worker: model the surfaces ─▶ next scene file ─▶ Scene, buffers, journal ── Swap ──▶ bus ─▶ loop
//! ```
//! All of it happens on a thread of its own; the loop goes on meanwhile, and takes the next scene
//! over between two ticks.

mod cut;
mod isolate;
mod merge;
mod truncate;

use palpate_drive::editor::{Edit, EditNews, EditRequest, Editor, Standing};
use palpate_drive::swap::Swap;
use palpate_geometry::surface::Surface;
use palpate_record::SceneChanges;
use palpate_sim::scene::{Scene, SceneChange};
use palpate_sim::tick::CarryOver;
use sha2::Digest as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

const FAULT: &str = "an internal fault of the modeling code stopped the change; the scene is as \
                     it was, and the daemon's log has the details";

/// A request with what it is about.
struct EditJob {
    id: u64,
    scene: Arc<Scene>,
    standing: Vec<Standing>,
    request: EditRequest,
}

/// What modeling came to.
struct Edited {
    /// None: all is well as it is.
    change: Option<SceneChange>,
    /// For people.
    what: String,
    /// For programs.
    report: serde_json::Value,
}

/// The thread that remakes scenes; it ends when this is dropped.
pub struct SceneEditor {
    jobs: Sender<EditJob>,
    news: Receiver<EditNews>,
}

impl SceneEditor {
    /// Starts the thread. `changes` prepares the recorder.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn start(changes: SceneChanges) -> std::io::Result<Self> {
        let (jobs, job_out) = channel::<EditJob>();
        let (news_in, news) = channel();
        std::thread::Builder::new()
            .name("palpate-editor".into())
            .spawn(move || {
                for job in job_out {
                    let id = job.id;
                    // A fault in modeling must not end the thread: later requests would wait
                    // for an answer that never comes.
                    let news = catch_unwind(AssertUnwindSafe(|| carry_out(&job, &changes)))
                        .unwrap_or_else(|_| Err(FAULT.into()))
                        .unwrap_or_else(|reason| EditNews::Refused { id, reason });
                    if news_in.send(news).is_err() {
                        return;
                    }
                }
            })?;
        Ok(Self { jobs, news })
    }
}

impl Editor for SceneEditor {
    fn ask(&mut self, id: u64, scene: &Arc<Scene>, standing: Vec<Standing>, request: EditRequest) {
        // The thread lives as long as we do.
        let _ = self.jobs.send(EditJob {
            id,
            scene: scene.clone(),
            standing,
            request,
        });
    }

    fn news(&mut self) -> Option<EditNews> {
        self.news.try_recv().ok()
    }
}

fn carry_out(job: &EditJob, changes: &SceneChanges) -> Result<EditNews, String> {
    let id = job.id;
    let Remade { next, what, report } = behind_the_loop(|| remade(job))?;
    let Some((next, carry)) = next else {
        return Ok(EditNews::Nothing { id, report });
    };
    let text = toml::to_string(&next.spec).map_err(|e| e.to_string())?;
    let scene_hash = sha2::Sha256::digest(text.as_bytes()).into();
    let journal = changes.journal(&next, &what).map_err(|e| e.to_string())?;
    // Starts the threads of bodies that step apart, which must not run behind the loop.
    let swap = Swap::new(id, next, carry, Box::new(journal));
    let (swap, nets) = swap.map_err(|e| e.to_string())?;
    Ok(EditNews::Ready {
        swap: Box::new(swap),
        nets,
        scene_hash,
        what,
        report,
    })
}

/// Work on a thread that gives way to the loop where cores are few, as do the threads that it starts.
fn behind_the_loop<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let low = || {
        // On Linux this is of one thread; elsewhere it would be of all.
        #[cfg(target_os = "linux")]
        let _ = rustix::process::nice(10);
        work()
    };
    match std::thread::scope(|threads| threads.spawn(low).join()) {
        Ok(done) => done,
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

/// The next scene and what goes on in it, if anything changes.
struct Remade {
    next: Option<(Arc<Scene>, CarryOver)>,
    what: String,
    report: serde_json::Value,
}

fn remade(job: &EditJob) -> Result<Remade, String> {
    let EditJob {
        scene,
        standing,
        request,
        ..
    } = job;
    let surfaces: Vec<Surface> = request
        .bodies
        .iter()
        .zip(standing)
        .map(|(&body, stands)| {
            let surface = scene.surface_with(body, &stands.points).map_err(|e| e.to_string())?;
            surface.ok_or_else(|| {
                format!(
                    "{:?} is a part, which has no net to change; name bodies that are B-spline surfaces",
                    scene.body_id(body)
                )
            })
        })
        .collect::<Result<_, _>>()?;
    let Edited {
        change,
        what,
        report,
    } = match &request.edit {
        Edit::Merge {
            id,
            continuity,
            method,
            hidden,
            tolerance_m,
        } => {
            let asked = merge::MergeRequest {
                id: id.as_deref(),
                continuity: *continuity,
                method: method.as_deref(),
                hidden: hidden.as_deref(),
                tolerance_m: *tolerance_m,
            };
            merge::merge(scene, &request.bodies, &surfaces, &asked)?
        }
        Edit::Isolate {
            method,
            gap_m,
            max_turn_deg,
        } => {
            let asked = isolate::IsolateRequest {
                method: method.as_deref(),
                gap_m: *gap_m,
                max_turn_deg: *max_turn_deg,
            };
            isolate::isolate(scene, &request.bodies, &surfaces, &asked)?
        }
        Edit::Truncate { tolerance_m } => {
            truncate::truncate(scene, &request.bodies, &surfaces, *tolerance_m)?
        }
        Edit::Cut { plane, kerf_m } => {
            let (&[body], [stands]) = (&*request.bodies, &**standing) else {
                return Err("cut takes one body".into());
            };
            cut::cut(
                scene,
                body,
                (&stands.points, &stands.coordinates),
                plane,
                *kerf_m,
            )?
        }
    };
    let Some(change) = change else {
        return Ok(Remade {
            next: None,
            what,
            report,
        });
    };
    let next = change.build_to_run().map_err(|e| e.to_string())?;
    let found: Vec<&str> = next
        .warnings()
        .iter()
        .map(|finding| finding.what.as_str())
        .collect();
    let mut report = report;
    if !found.is_empty() {
        tracing::warn!(?found, "about the next scene");
        report["warnings"] = found.into();
    }
    let next = Arc::new(next);
    if !change.fits(scene, &next) {
        return Err(
            "a body that stays would be built otherwise in the next scene; nothing was changed"
                .into(),
        );
    }
    let carry = CarryOver::new(scene, &next, change.origins().to_vec());
    Ok(Remade {
        next: Some((next, carry)),
        what,
        report,
    })
}
