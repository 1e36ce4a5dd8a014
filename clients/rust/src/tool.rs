//! One tool: poses out, forces in.

use crate::announce::Announcement;
use crate::connection::{ClientError, Latest, Palpate};
use crate::exact::is_one_key;
use crate::newest::NewestForce;
use crate::publish::publisher;
use palpate_proto::codec::{decode, encode};
use palpate_proto::keys::short_id;
use palpate_proto::messages::{DeviceInfo, ToolContact, ToolForce, ToolPose, force_flags};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use zenoh::Wait;
use zenoh::bytes::ZBytes;

/// In lockstep a pose without its force after this long is sent again.
const RESEND: Duration = Duration::from_millis(100);

/// A held tool. Its liveliness token lasts as long as it.
///
/// Its forces are what a hand may feel: answers to its own poses, not to those of whoever holds the tool
/// in its place, and when they stop coming they fade to zero ([`Forces::get`]). While another client sends poses
/// of the tool, its own are dropped by the daemon: [`Tool::send`] says so ([`ClientError::Held`]).
pub struct Tool {
    id: String,
    publisher: zenoh::pubsub::Publisher<'static>,
    forces: Forces,
    seq: u64,
    last: Option<ToolPose>,
    /// Goes with each pose: who sends it.
    holder: Vec<u8>,
    lockstep: bool,
    session: zenoh::Session,
    device_key: String,
    contact_key: String,
    announcement: Option<Announcement>,
    contact: Option<Latest<ToolContact>>,
    _token: zenoh::liveliness::LivelinessToken,
}

/// Forces of a tool as they arrive: the newest, as it may act.
#[derive(Clone)]
pub struct Forces {
    shared: Arc<Shared>,
    _subscriber: Arc<zenoh::pubsub::Subscriber<()>>,
}

struct Shared {
    state: Mutex<State>,
    arrived: Condvar,
}

struct State {
    newest: NewestForce,
    /// Of the tool's holder. `None`: whose poses are answered does not matter.
    sent: Option<Sent>,
}

/// The poses of a tool, by which it knows its answers.
struct Sent {
    /// Goes with each, and with the forces that answer them.
    holder: Vec<u8>,
    /// The first since the last answer.
    unanswered: Option<Instant>,
    /// Whose poses were answered instead.
    other: Option<String>,
    seq: u64,
    /// Time of each, in the place of its number; as many as are under way at 4 kHz and two seconds of delay.
    times_ns: Box<[u64; SENT]>,
}

const SENT: usize = 8192;

/// Whose poses are answered for so long while ours are not holds the tool: in this time a daemon takes it
/// from a client that has fallen silent.
const HELD: Duration = Duration::from_millis(250);

impl Sent {
    fn new(holder: Vec<u8>) -> Self {
        Self {
            holder,
            unanswered: None,
            other: None,
            seq: 0,
            times_ns: Box::new([0; SENT]),
        }
    }

    fn note(&mut self, pose: &ToolPose, now: Instant) {
        self.unanswered.get_or_insert(now);
        self.seq = pose.seq;
        self.times_ns[pose.seq as usize % SENT] = pose.t_client_ns;
    }

    /// Whether a force is for this hand: it answers a pose of ours. `sender`: whose pose it answers; daemons of
    /// before do not say.
    fn hear(&mut self, force: &ToolForce, sender: Option<&[u8]>, now: Instant) -> bool {
        if let Some(other) = sender.filter(|sender| *sender != self.holder) {
            // A stale pose is that of a client that has left.
            let moved = force.pose_seq > 0 && force.flags & force_flags::STALE == 0;
            let waits = |since| now.saturating_duration_since(since) > HELD;
            if moved && self.unanswered.is_some_and(waits) {
                self.other = Some(short_id(other));
            }
            return false;
        }
        let is_answer = self.is_answer(force);
        if is_answer {
            (self.unanswered, self.other) = (None, None);
        }
        is_answer
    }

    fn is_answer(&self, force: &ToolForce) -> bool {
        let kept = (self.seq + 1).saturating_sub(SENT as u64).max(1)..=self.seq;
        kept.contains(&force.pose_seq)
            && self.times_ns[force.pose_seq as usize % SENT] == force.t_client_ns
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn take(&self, force: ToolForce, sender: Option<&[u8]>) {
        let (mut state, now) = (self.lock(), Instant::now());
        let state = &mut *state;
        // What another hand presses is not for ours.
        let sent = state.sent.as_mut();
        if sent.is_none_or(|sent| sent.hear(&force, sender, now)) {
            state.newest.offer(force, now);
        }
        self.arrived.notify_all();
    }
}

impl Forces {
    fn subscribe(
        palpate: &Palpate,
        id: &str,
        newest: NewestForce,
        sent: Option<Sent>,
    ) -> Result<Self, ClientError> {
        let shared = Arc::new(Shared {
            state: Mutex::new(State { newest, sent }),
            arrived: Condvar::new(),
        });
        let told = shared.clone();
        let subscriber = palpate
            .session()
            .declare_subscriber(palpate.keys().tool_force(id))
            .callback(move |sample| {
                // What comes under a pattern is not from who names this tool.
                if is_one_key(sample.key_expr())
                    && let Ok(force) = decode::<ToolForce>(&sample.payload().to_bytes(), "")
                {
                    let sender = sample.attachment().map(ZBytes::to_bytes);
                    told.take(force, sender.as_deref());
                }
            })
            .wait()
            .map_err(ClientError::zenoh)?;
        Ok(Self {
            shared,
            _subscriber: Arc::new(subscriber),
        })
    }

    /// The newest force as it may act now; `None` before the first. When none has come for 50 ms (100 ms with
    /// a deadband, and for those who only watch) it fades to zero within 10 ms; when they come again, it comes
    /// back over 100 ms. A force that is less than it came is marked
    /// [`palpate_proto::messages::force_flags::RAMPING`]. In lockstep, where time stands still, none fades.
    pub fn get(&self) -> Option<ToolForce> {
        self.newest().felt(Instant::now())
    }

    /// The newest force as it came, and what is known of the others.
    pub fn newest(&self) -> NewestForce {
        self.shared.lock().newest
    }

    /// How long ago the newest force came; `None` before the first one. The daemon may be gone, and cannot
    /// say so.
    pub fn silence(&self) -> Option<Duration> {
        self.newest().silence(Instant::now())
    }
}

/// What goes along with poses and descriptions as Zenoh's attachment: daemons take those of one
/// holder at a time. Another one for each call.
pub fn holder_id(session: &zenoh::Session) -> Vec<u8> {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    [
        &session.zid().to_le_bytes()[..],
        &std::process::id().to_le_bytes(),
        &number.to_le_bytes(),
    ]
    .concat()
}

impl Palpate {
    /// Takes a tool of the scene.
    ///
    /// # Errors
    /// No such tool, another client that moves it, or Zenoh refused.
    pub fn tool(&self, id: &str) -> Result<Tool, ClientError> {
        let scene = self.scene()?;
        if !scene.tools.iter().any(|tool| tool.id == id) {
            let known = scene
                .tools
                .iter()
                .map(|tool| tool.id.as_str())
                .collect::<Vec<_>>()
                .join(", ");
            return Err(ClientError::Unknown {
                kind: "tool",
                id: id.to_owned(),
                known,
            });
        }
        // Who has just left is known a little longer.
        let begun = Instant::now();
        while let Some(holder) = self.holder(id)? {
            if begun.elapsed() > 2 * HELD {
                let tool = id.to_owned();
                return Err(ClientError::Held { tool, holder });
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        Tool::new(self, id, scene.lockstep)
    }

    /// Who moves a tool: the name of its device, or what the daemon calls the client.
    fn holder(&self, tool: &str) -> Result<Option<String>, ClientError> {
        Ok(self.holder_and_name(tool)?.map(|(_, name)| name))
    }

    /// What the daemon calls the client that moves a tool, and the name of its device.
    fn holder_and_name(&self, tool: &str) -> Result<Option<(String, String)>, ClientError> {
        let info: serde_json::Value =
            serde_json::from_str(&self.info()?).map_err(ClientError::zenoh)?;
        let told = &info["devices"][tool];
        let name = told["info"]["name"]
            .as_str()
            .filter(|name| !name.is_empty());
        let holder = told["holder"].as_str();
        Ok(holder.map(|client| (client.to_owned(), name.unwrap_or(client).to_owned())))
    }

    /// Checks that no other client moves a tool that this one has taken.
    ///
    /// # Errors
    /// [`ClientError::Held`] if another does; or the daemon does not answer.
    pub fn check_holder(&self, tool: &Tool) -> Result<(), ClientError> {
        let own = short_id(&tool.holder);
        match self.holder_and_name(&tool.id)? {
            Some((client, holder)) if client != own => {
                let tool = tool.id.clone();
                Err(ClientError::Held { tool, holder })
            }
            _ => Ok(()),
        }
    }

    /// Forces of a tool, for those who watch and do not hold it.
    ///
    /// # Errors
    /// No answer, or Zenoh refused.
    pub fn forces(&self, tool: &str) -> Result<Forces, ClientError> {
        // Whether its holder has a deadband is not known here.
        let newest = NewestForce::new(self.is_timeless()?, true);
        Forces::subscribe(self, tool, newest, None)
    }

    /// Time stands still between forces. A recording is played by the clock, whatever made it.
    fn is_timeless(&self) -> Result<bool, ClientError> {
        let info: serde_json::Value =
            serde_json::from_str(&self.info()?).map_err(ClientError::zenoh)?;
        Ok(info["lockstep"] == true && info["played"] != true)
    }
}

impl Tool {
    pub(crate) fn new(palpate: &Palpate, id: &str, lockstep: bool) -> Result<Self, ClientError> {
        let (session, keys) = (palpate.session(), palpate.keys());
        let timeless = lockstep && palpate.is_timeless()?;
        let newest = NewestForce::new(timeless, false);
        let holder = holder_id(session);
        let forces = Forces::subscribe(palpate, id, newest, Some(Sent::new(holder.clone())))?;
        let publisher =
            publisher::<ToolPose>(session, keys.tool_pose(id)).map_err(ClientError::zenoh)?;
        let token = session
            .liveliness()
            .declare_token(keys.live_tool(id))
            .wait()
            .map_err(ClientError::zenoh)?;
        Ok(Self {
            id: id.to_owned(),
            publisher,
            forces,
            seq: 0,
            last: None,
            holder,
            lockstep,
            session: session.clone(),
            device_key: keys.tool_device(id),
            contact_key: keys.tool_contact(id),
            announcement: None,
            contact: None,
            _token: token,
        })
    }

    /// True when the daemon waits for each pose.
    pub fn is_lockstep(&self) -> bool {
        self.lockstep
    }

    /// Sends a pose; gives the `seq` it got. In lockstep the pose's own time is kept, so that
    /// sessions repeat by bits.
    ///
    /// # Errors
    /// Another client holds the tool ([`Tool::take_refusal`]), or Zenoh refused.
    ///
    /// # Examples
    /// ```no_run
    /// use palpate_client::{Connect, Palpate, pose_at};
    /// let palpate = Palpate::connect(&Connect::to("tcp/127.0.0.1:7447"))?;
    /// let mut tool = palpate.tool("ball")?;
    /// let seq = tool.send(pose_at([0.0, 0.0, 0.05]))?;
    /// println!("{:?}", tool.wait_force(seq, std::time::Duration::from_millis(50)));
    /// # Ok::<(), palpate_client::ClientError>(())
    /// ```
    pub fn send(&mut self, pose: ToolPose) -> Result<u64, ClientError> {
        self.take_refusal()?;
        self.seq += 1;
        let t_client_ns = if self.lockstep {
            pose.t_client_ns
        } else {
            now_ns()
        };
        let pose = ToolPose {
            seq: self.seq,
            t_client_ns,
            ..pose
        };
        self.last = Some(pose);
        if let Some(sent) = &mut self.forces.shared.lock().sent {
            sent.note(&pose, Instant::now());
        }
        if let Some(announcement) = &self.announcement {
            announcement.repeat_if_due()?;
        }
        self.put(&pose)?;
        Ok(self.seq)
    }

    /// Whether the daemon dropped what was sent, because another client holds the tool: poses went unanswered
    /// for 250 ms while those of the other were answered. Said once; what is sent after that is another try.
    ///
    /// # Errors
    /// [`ClientError::Held`].
    pub fn take_refusal(&self) -> Result<(), ClientError> {
        let mut state = self.forces.shared.lock();
        let other = state.sent.as_mut().and_then(|sent| {
            let other = sent.other.take()?;
            sent.unanswered = None;
            Some(other)
        });
        other.map_or(Ok(()), |holder| {
            let tool = self.id.clone();
            Err(ClientError::Held { tool, holder })
        })
    }

    fn put(&self, pose: &ToolPose) -> Result<(), ClientError> {
        self.publisher
            .put(encode(pose))
            .attachment(self.receipt())
            .wait()
            .map_err(ClientError::zenoh)
    }

    /// Who sends, and what it has received: the daemon counts both.
    fn receipt(&self) -> Vec<u8> {
        let newest = self.newest();
        let newest_ns = newest.force.map_or(0, |force| force.t_server_ns);
        let mut bytes = Vec::with_capacity(self.holder.len() + 16);
        bytes.extend_from_slice(&self.holder);
        bytes.extend_from_slice(&newest.received.to_le_bytes());
        bytes.extend_from_slice(&newest_ns.to_le_bytes());
        bytes
    }

    /// Tells the daemon what this device can do, now and again whenever a daemon appears
    /// ([`Tool::send`] does it). Where the description has a deadband, forces come more rarely:
    /// only those a hand could tell from the last one.
    ///
    /// # Errors
    /// No device can be like that, or Zenoh refused.
    pub fn announce(&mut self, info: &DeviceInfo) -> Result<(), ClientError> {
        let info = info.clone().validated()?;
        self.forces
            .shared
            .lock()
            .newest
            .set_sparse(info.deadband > 0.0);
        match &mut self.announcement {
            Some(announcement) => announcement.replace(&info),
            none => {
                *none = Some(Announcement::new(
                    &self.session,
                    &self.device_key,
                    &info,
                    self.holder.clone(),
                )?);
                Ok(())
            }
        }
    }

    /// What contacts do to the tool, the newest: a sensor's reading, not limited for the device.
    /// The first call subscribes and gives `None`; what is asked for comes within some 100 ms, then
    /// every tick.
    ///
    /// # Errors
    /// Zenoh refused the subscription.
    pub fn contact(&mut self) -> Result<Option<ToolContact>, ClientError> {
        match &self.contact {
            Some(newest) => Ok(newest.get()),
            None => {
                self.contact = Some(Latest::subscribe(&self.session, self.contact_key.clone())?);
                Ok(None)
            }
        }
    }

    /// The newest force as it may act now: zero when none has come for 60 ms ([`Forces::get`]).
    pub fn force(&self) -> Option<ToolForce> {
        self.forces.get()
    }

    /// The newest force as it came, and what is known of the others.
    pub fn newest(&self) -> NewestForce {
        self.forces.newest()
    }

    /// How long ago the newest force came; `None` before the first one.
    pub fn silence(&self) -> Option<Duration> {
        self.forces.silence()
    }

    /// Forces received so far.
    pub fn received(&self) -> u64 {
        self.newest().received
    }

    /// Waits for a force that answers the pose `seq` or a later one, and gives it as it may act then
    /// ([`Forces::get`]). In lockstep the pose is sent again now and then. `None` also when another client holds
    /// the tool ([`Tool::take_refusal`]).
    pub fn wait_force(&self, seq: u64, timeout: Duration) -> Option<ToolForce> {
        let started = Instant::now();
        let shared = &self.forces.shared;
        let mut state = shared.lock();
        loop {
            let felt = state.newest.felt(Instant::now());
            if let Some(force) = felt.filter(|force| force.pose_seq >= seq) {
                return Some(force);
            }
            if state.sent.as_ref().is_some_and(|sent| sent.other.is_some()) {
                return None;
            }
            let left = timeout.checked_sub(started.elapsed())?;
            let slice = if self.lockstep {
                left.min(RESEND)
            } else {
                left
            };
            let (guard, waited) = shared
                .arrived
                .wait_timeout(state, slice)
                .unwrap_or_else(PoisonError::into_inner);
            state = guard;
            if waited.timed_out() && self.lockstep {
                drop(state);
                if let Some(pose) = &self.last {
                    let _ = self.put(pose);
                }
                state = shared.lock();
            }
        }
    }
}

/// Wall clock, ns.
pub(crate) fn now_ns() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |t| t.as_nanos() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(seq: u64) -> ToolPose {
        ToolPose {
            seq,
            t_client_ns: 1_000 + seq,
            ..crate::pose_at([0.0; 3])
        }
    }

    fn answer(pose_seq: u64, t_client_ns: u64) -> ToolForce {
        ToolForce {
            tick: pose_seq,
            pose_seq,
            t_client_ns,
            t_server_ns: 0,
            force: [0.0; 3],
            torque: [0.0; 3],
            proxy_position: [0.0; 3],
            proxy_orientation: [0.0, 0.0, 0.0, 1.0],
            depth: 0.0,
            contact_count: 0,
            flags: 0,
        }
    }

    #[test]
    fn a_force_that_answers_the_pose_of_another_is_no_answer() {
        let mut sent = Sent::new(vec![7; 24]);
        let now = Instant::now();
        assert!(!sent.is_answer(&answer(0, 0)), "nothing was sent");
        for seq in 1..=3 * SENT as u64 {
            sent.note(&pose(seq), now);
            assert!(sent.is_answer(&answer(seq, 1_000 + seq)));
        }
        let last = 3 * SENT as u64;
        let oldest = last + 1 - SENT as u64;
        assert!(sent.is_answer(&answer(oldest, 1_000 + oldest)));
        for (seq, time) in [
            (last, 7),
            (oldest - 1, 1_000 + oldest - 1),
            (last + 1, 1_000 + last + 1),
        ] {
            assert!(!sent.is_answer(&answer(seq, time)), "{seq} {time}");
        }
    }

    // Two clients in lockstep: both count from 1 and send no time.
    #[test]
    fn a_force_with_our_number_that_answers_another_client_is_not_ours_and_says_who_holds_the_tool()
    {
        let begun = Instant::now();
        let at = |ms| begun + Duration::from_millis(ms);
        let (ours, other) = ([7; 24], [9; 24]);
        let mut sent = Sent::new(ours.to_vec());
        for seq in 1..=500 {
            sent.note(&pose(seq), at(seq));
            let force = answer(seq, 1_000 + seq);
            assert!(!sent.hear(&force, Some(&other), at(seq)));
            // In less time it may be the other that has just left.
            assert_eq!(sent.other.is_some(), seq > 251, "{seq} ms");
        }
        assert_eq!(sent.other.as_deref(), Some("0909090909090909"));
        // The other leaves: its last pose grows stale, and ours is answered.
        let answered = answer(500, 1_500);
        assert!(sent.hear(&answered, Some(&ours), at(600)));
        sent.note(&pose(501), at(601));
        let left = ToolForce {
            flags: force_flags::STALE,
            ..answer(501, 1_501)
        };
        assert!(!sent.hear(&left, Some(&other), at(2_000)));
        assert!(!sent.hear(&answer(0, 0), Some(&other), at(2_000)));
        assert_eq!(sent.other, None);
        // A daemon of before does not say whose pose it was.
        assert!(sent.hear(&answer(501, 1_501), None, at(2_000)));
    }

    #[test]
    fn an_id_is_shortened_whatever_its_length() {
        assert_eq!(short_id(&[]), "");
        assert_eq!(short_id(&[1, 2, 3]), "010203");
        assert_eq!(short_id(&[1, 2, 3, 4, 5, 6]), "010203040506");
        assert_eq!(
            short_id(&[[1; 4], [2; 4], [3; 4]].concat()),
            "0101010103030303"
        );
    }
}
