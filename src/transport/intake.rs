//! What comes in from clients for the bus thread, each kind with a bound of its own.
//!
//! Commands and questions have separate queues, and each queryable a share of places: a flood of one kind
//! of query takes no room from another, and commands are obeyed before any question is answered. A query
//! that finds no place is refused at once, on the receive thread of the client that asked.

use super::post::{Asked, Post, PostThreads};
use palpate_client::is_one_key;
use palpate_proto::messages::DeviceInfo;
use palpate_proto::rpc::Answer;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::query::Query;

/// Queries of one key that may be under way: until their answers are sent.
const PLACES: usize = 64;

/// A question: its answer changes nothing.
pub(super) enum Question {
    Scene,
    Status,
    Net(String),
    Info,
    Schema,
    Metrics,
    Events,
    Device(usize),
}

/// A place in the share of a queryable; free again when dropped.
pub(super) struct Place(Arc<AtomicUsize>);

impl Place {
    fn take(share: &Arc<AtomicUsize>) -> Option<Self> {
        let taken = share.fetch_add(1, Ordering::Relaxed);
        let place = Self(share.clone());
        (taken < PLACES).then_some(place)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// The receive threads' end.
#[derive(Clone)]
pub(super) struct Intake {
    commands: Sender<(&'static str, Asked)>,
    questions: Sender<(Question, Asked)>,
    /// Sends the answers to commands, where they have to come after what else it sends.
    command_post: Option<Post>,
    threads: PostThreads,
    pub(super) notices: Arc<Notices>,
}

/// The bus thread's end.
pub(super) struct Requests {
    pub(super) commands: Receiver<(&'static str, Asked)>,
    pub(super) questions: Receiver<(Question, Asked)>,
    pub(super) notices: Arc<Notices>,
}

impl Intake {
    /// Nothing has come in.
    pub(super) fn new(
        threads: &PostThreads,
        command_post: Option<Post>,
        tools: usize,
    ) -> (Self, Requests) {
        let (commands, commands_out) = channel();
        let (questions, questions_out) = channel();
        let notices = Arc::new(Notices::new(tools));
        let intake = Self {
            commands,
            questions,
            command_post,
            threads: threads.clone(),
            notices: notices.clone(),
        };
        let requests = Requests {
            commands: commands_out,
            questions: questions_out,
            notices,
        };
        (intake, requests)
    }

    /// The callback of a method's queryable. A method obeys queries of its own key only: a pattern that
    /// also matches it, as browsers of the bus ask, ends without an answer.
    pub(super) fn command(&self, method: &'static str) -> impl Fn(Query) + Send + Sync + 'static {
        let (queue, share) = (self.commands.clone(), Arc::<AtomicUsize>::default());
        let post = (self.command_post.clone()).unwrap_or_else(|| self.post());
        move |query| {
            if !is_one_key(query.key_expr()) {
                return;
            }
            match Place::take(&share) {
                Some(place) => drop(queue.send((method, Asked::new(query, &post, place)))),
                None => refuse_for_now(&query),
            }
        }
    }

    /// A way out for answers.
    pub(super) fn post(&self) -> Post {
        Post::new("palpate-answers", &self.threads)
    }

    /// The callback of a queryable whose answers change nothing, and go out through `post`.
    pub(super) fn question(
        &self,
        post: &Post,
        question: impl Fn() -> Question + Send + Sync + 'static,
    ) -> impl Fn(Query) + Send + Sync + 'static {
        let (queue, share) = (self.questions.clone(), Arc::<AtomicUsize>::default());
        let post = post.clone();
        move |query| match Place::take(&share) {
            Some(place) => drop(queue.send((question(), Asked::new(query, &post, place)))),
            None => refuse_for_now(&query),
        }
    }
}

fn refuse_for_now(query: &Query) {
    let answer = Answer::<()>::refused("too many queries of this key are waiting; try again");
    let json = serde_json::to_string(&answer).unwrap_or_default();
    let _ = (query.reply_err(json).encoding(Encoding::APPLICATION_JSON)).wait();
}

/// What became of a tool's token and device since the bus thread last looked; newest wins.
#[derive(Debug, Default)]
pub(super) struct Notice {
    /// A holder is gone.
    pub(super) left: bool,
    /// A holder is there, after that.
    pub(super) joined: bool,
    /// The description of a device, after both.
    pub(super) reported: Option<Box<DeviceInfo>>,
}

/// By tool: as many as the scene has, however much comes in.
#[derive(Debug)]
pub(super) struct Notices(Vec<Mutex<Notice>>);

impl Notices {
    fn new(tools: usize) -> Self {
        Self((0..tools).map(|_| Mutex::default()).collect())
    }

    fn with<T>(&self, tool: usize, act: impl FnOnce(&mut Notice) -> T) -> Option<T> {
        let notice = self.0.get(tool)?;
        Some(act(&mut notice
            .lock()
            .unwrap_or_else(PoisonError::into_inner)))
    }

    /// A token of a tool has appeared or is gone.
    pub(super) fn token(&self, tool: usize, present: bool) {
        self.with(tool, |notice| match present {
            true => notice.joined = true,
            false => {
                *notice = Notice {
                    left: true,
                    ..Notice::default()
                };
            }
        });
    }

    /// A client described the device that moves a tool.
    pub(super) fn reported(&self, tool: usize, info: Box<DeviceInfo>) {
        self.with(tool, |notice| notice.reported = Some(info));
    }

    /// What is new of a tool.
    pub(super) fn take(&self, tool: usize) -> Notice {
        self.with(tool, std::mem::take).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_of_places_is_bounded_and_free_again() {
        let share = Arc::<AtomicUsize>::default();
        let places: Vec<Option<Place>> = (0..3 * PLACES).map(|_| Place::take(&share)).collect();
        assert_eq!(places.iter().flatten().count(), PLACES);
        drop(places);
        assert_eq!(share.load(Ordering::Relaxed), 0);
        assert!(Place::take(&share).is_some());
    }

    #[test]
    fn the_next_holder_does_not_get_the_device_of_the_one_before() {
        let notices = Notices::new(1);
        notices.token(0, true);
        notices.reported(0, Box::new(device("first")));
        notices.token(0, false);
        notices.token(0, true);
        let notice = notices.take(0);
        assert!(notice.left && notice.joined && notice.reported.is_none());
        notices.reported(0, Box::new(device("second")));
        assert_eq!(notices.take(0).reported.unwrap().name, "second");
        assert!(notices.take(0).reported.is_none());
        // There is no such tool.
        notices.token(1, true);
        assert!(!notices.take(1).joined);
    }

    fn device(name: &str) -> DeviceInfo {
        DeviceInfo {
            name: name.into(),
            dof_force: 3,
            dof_torque: 0,
            workspace: [0.1; 3],
            force_max: 3.0,
            force_continuous: 1.0,
            torque_max: 0.0,
            mass: 0.1,
            damping: 0.0,
            coulomb_friction: 0.0,
            encoder_resolution: 0.0,
            rate_hz: 1000.0,
            delay_s: 0.0,
            deadband: 0.0,
        }
    }
}
