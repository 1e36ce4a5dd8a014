//! A bare ROS 2 peer over Zenoh: what an rmw_zenoh node would send and receive, byte by byte.

use palpate::transport::{Role, SessionSettings, open};
use palpate_devices::cdr::{decode, encode};
use palpate_devices::ros2::{
    Attachment, Header, PoseStamped, RosMessage, TwistStamped, topic_key, topic_subscription,
};
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::sample::Sample;

/// Messages that came, oldest first.
#[derive(Clone)]
pub struct Heard {
    queue: Arc<(Mutex<VecDeque<Sample>>, Condvar)>,
    _subscriber: Arc<zenoh::pubsub::Subscriber<()>>,
}

impl Heard {
    /// The next one, which must come.
    pub fn next<M: RosMessage>(&self) -> M {
        let sample = self.sample(Duration::from_secs(30)).expect("a message");
        let attachment = sample.attachment().expect("an attachment").to_bytes();
        Attachment::from_bytes(&attachment).unwrap();
        decode(&sample.payload().to_bytes()).unwrap()
    }

    pub fn sample(&self, patience: Duration) -> Option<Sample> {
        let (queue, arrived) = &*self.queue;
        let until = Instant::now() + patience;
        let mut waiting = queue.lock().unwrap();
        loop {
            if let Some(sample) = waiting.pop_front() {
                return Some(sample);
            }
            let left = until.checked_duration_since(Instant::now())?;
            waiting = arrived.wait_timeout(waiting, left).unwrap().0;
        }
    }

    /// All that has come.
    pub fn take<M: RosMessage>(&self) -> Vec<M> {
        let (queue, _) = &*self.queue;
        let waiting = std::mem::take(&mut *queue.lock().unwrap());
        let read = |sample: Sample| decode(&sample.payload().to_bytes()).unwrap();
        waiting.into_iter().map(read).collect()
    }
}

/// A session of its own.
pub struct Peer {
    pub session: zenoh::Session,
    pub gid: [u8; 16],
    sequence: std::cell::Cell<i64>,
}

impl Peer {
    pub fn connect(endpoint: &str) -> Self {
        let settings = SessionSettings {
            connect: vec![endpoint.to_owned()],
            role: Role::Client,
            ..Default::default()
        };
        // A router that has just been started may not answer yet.
        let session = (0..50).find_map(|_| {
            let opened = open(&settings).ok();
            if opened.is_none() {
                std::thread::sleep(Duration::from_millis(100));
            }
            opened
        });
        Self {
            session: session.unwrap_or_else(|| panic!("nobody answers at {endpoint}")),
            gid: [7; 16],
            sequence: std::cell::Cell::new(1),
        }
    }

    pub fn hear<M: RosMessage>(&self, topic: &str) -> Heard {
        let queue = Arc::<(Mutex<VecDeque<Sample>>, Condvar)>::default();
        let shared = queue.clone();
        let subscriber = self
            .session
            .declare_subscriber(topic_subscription(0, topic, M::TYPE))
            .callback(move |sample| {
                shared.0.lock().unwrap().push_back(sample);
                shared.1.notify_all();
            })
            .wait()
            .unwrap();
        Heard {
            queue,
            _subscriber: Arc::new(subscriber),
        }
    }

    /// Waits until somebody subscribes to a topic.
    pub fn await_listener<M: RosMessage>(&self, topic: &str) {
        let publisher = self
            .session
            .declare_publisher(topic_key(0, topic, M::TYPE))
            .wait()
            .unwrap();
        let begun = Instant::now();
        while !publisher.matching_status().wait().unwrap().matching() {
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "nobody hears {topic}"
            );
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    pub fn attachment(&self) -> Attachment {
        let sequence = self.sequence.replace(self.sequence.get() + 1);
        Attachment {
            sequence,
            source_ns: 1_000_000 * sequence,
            gid: self.gid,
        }
    }

    pub fn put<M: RosMessage>(&self, topic: &str, message: &M) {
        let attachment = self.attachment().to_bytes().to_vec();
        self.put_bytes::<M>(topic, encode(message), Some(attachment));
    }

    pub fn put_bytes<M: RosMessage>(
        &self,
        topic: &str,
        bytes: Vec<u8>,
        attachment: Option<Vec<u8>>,
    ) {
        let key = topic_key(0, topic, M::TYPE);
        let put = self.session.put(key, bytes);
        match attachment {
            Some(attachment) => put.attachment(attachment).wait(),
            None => put.wait(),
        }
        .unwrap();
    }
}

/// A pose at a time in ms.
pub fn pose(time_ms: u64, position: [f64; 3]) -> PoseStamped {
    PoseStamped {
        header: Header::new(1_000_000_000 + time_ms * 1_000_000, "world"),
        position,
        orientation: [0.0, 0.0, 0.0, 1.0],
    }
}

/// A velocity at a time in ms.
pub fn twist(time_ms: u64, linear: [f64; 3]) -> TwistStamped {
    TwistStamped {
        header: Header::new(1_000_000_000 + time_ms * 1_000_000, "world"),
        linear,
        angular: [0.0; 3],
    }
}
