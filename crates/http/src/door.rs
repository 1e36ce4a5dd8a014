//! Who stands at a door: connections bounded in number and in time, whatever is spoken behind it.
//!
//! ```text
//! enter ─▶ waiting ─ whole request ─▶ served ─ answered ─▶ waiting …
//!                  └ one of health ─▶ urgent ─┘
//! ```
//! Each stage has places of its own: those who only wait keep no one from being served, and those who are served
//! keep no one from asking for health. A newcomer need not wait for a deadline: of those who wait the one leaves that
//! has waited longest, of the address that has most of them, so that on loopback, where all have one address, the
//! rule still holds. Of those who are served one leaves that takes nothing of what it is sent; where all do, the
//! newcomer is refused.
//!
//! Connections are ended by shutting them down, which wakes whoever reads or writes them: the same for tasks and
//! for threads.

use std::net::{IpAddr, Ipv6Addr, SocketAddr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A request that has begun is whole after this long, however its bytes come.
pub const REQUEST: Duration = Duration::from_secs(5);
/// Who takes nothing of what it is sent for this long is gone.
pub const STALL: Duration = Duration::from_secs(20);
/// And after this long it makes room where there is none.
const STUCK: Duration = Duration::from_secs(1);

/// Address of a connection, as extensions of its requests have it.
#[derive(Clone, Copy, Debug)]
pub struct Peer(pub SocketAddr);

/// Places of a door.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Of those who have not made a whole request.
    pub waiting: usize,
    /// Of those who are answered, and of sockets.
    pub served: usize,
    /// Of these, of one address.
    pub of_one: usize,
    /// Of those who ask for health.
    pub urgent: usize,
    /// Who says nothing waits no longer than this, even where there is room.
    pub idle: Option<Duration>,
}

/// All places for those who are served are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("too many connections are at work here: try again in a moment, or close some")]
pub struct Crowded;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Waiting,
    Served,
    Urgent,
    /// Shut down; it keeps its descriptor until whoever serves it notices.
    Leaving,
}

/// A door, and who stands there.
pub struct Door {
    limits: Limits,
    guests: Mutex<Vec<Arc<Guest>>>,
}

struct Guest {
    /// Of one of these, as far as a rule about addresses goes.
    address: IpAddr,
    shut: Box<dyn Fn() + Send + Sync>,
    state: Mutex<State>,
}

struct State {
    stage: Stage,
    since: Instant,
    /// A request has begun.
    begun: Option<Instant>,
    /// The answer has been made, but perhaps not sent.
    answered: bool,
    /// It takes nothing of what is sent.
    stalled: Option<Instant>,
}

/// The place of a connection, until it is dropped.
pub struct Place {
    door: Arc<Door>,
    guest: Arc<Guest>,
}

impl Guest {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is(&self, stage: Stage) -> bool {
        self.state().stage == stage
    }

    fn leave(&self) {
        self.state().stage = Stage::Leaving;
        (self.shut)();
    }
}

impl Door {
    /// An empty one.
    pub fn new(limits: Limits) -> Arc<Self> {
        Arc::new(Self {
            limits,
            guests: Mutex::default(),
        })
    }

    fn guests(&self) -> MutexGuard<'_, Vec<Arc<Guest>>> {
        self.guests.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A connection comes, which `shut` would end. `None`: more are leaving than have left; close it.
    pub fn enter(
        self: &Arc<Self>,
        peer: IpAddr,
        shut: impl Fn() + Send + Sync + 'static,
    ) -> Option<Place> {
        let Limits {
            waiting,
            served,
            urgent,
            ..
        } = self.limits;
        let mut guests = self.guests();
        if guests.len() >= 2 * waiting + served + urgent {
            return None;
        }
        let all: Vec<_> = guests.iter().filter(|g| g.is(Stage::Waiting)).collect();
        if all.len() >= waiting {
            let of = |address| all.iter().filter(|g| g.address == address).count();
            let most = all.iter().map(|g| of(g.address)).max();
            let longest = (all.iter())
                .filter(|g| Some(of(g.address)) == most)
                .min_by_key(|g| g.state().since);
            if let Some(guest) = longest {
                guest.leave();
            }
        }
        let guest = Arc::new(Guest {
            address: address_of(peer),
            shut: Box::new(shut),
            state: Mutex::new(State {
                stage: Stage::Waiting,
                since: Instant::now(),
                begun: None,
                answered: false,
                stalled: None,
            }),
        });
        guests.push(guest.clone());
        Some(Place {
            door: self.clone(),
            guest,
        })
    }

    /// Ends those whose time is over. To be called a few times a second.
    pub fn sweep(&self, now: Instant) {
        let over = |since: Instant, most: Duration| now.saturating_duration_since(since) > most;
        for guest in &*self.guests() {
            let state = guest.state();
            let late = match state.stage {
                Stage::Waiting => {
                    state.begun.is_some_and(|begun| over(begun, REQUEST))
                        || (self.limits.idle).is_some_and(|idle| over(state.since, idle))
                }
                Stage::Urgent => over(state.since, STALL),
                Stage::Served => state.stalled.is_some_and(|since| over(since, STALL)),
                Stage::Leaving => false,
            };
            drop(state);
            if late {
                guest.leave();
            }
        }
    }
}

impl Place {
    /// Something of a request has come.
    pub fn hears(&self) {
        let mut state = self.guest.state();
        if state.stage == Stage::Waiting && state.begun.is_none() {
            state.begun = Some(Instant::now());
        }
    }

    /// A whole request has come: it is served from now on, if there is room.
    ///
    /// # Errors
    /// There is none.
    pub fn serve(&self, urgent: bool) -> Result<(), Crowded> {
        self.serve_at(urgent, Instant::now())
    }

    fn serve_at(&self, urgent: bool, now: Instant) -> Result<(), Crowded> {
        let Limits { served, of_one, .. } = self.door.limits;
        let guests = self.door.guests();
        let (stage, most) = match urgent {
            true => (Stage::Urgent, self.door.limits.urgent),
            false => (Stage::Served, served),
        };
        let others = |g: &&Arc<Guest>| !Arc::ptr_eq(g, &self.guest) && g.is(stage);
        let all: Vec<_> = guests.iter().filter(others).collect();
        let full = all.len() >= most;
        if urgent && full {
            // An answer of health is a few bytes: who is still at it after so many others does not read it.
            let first = all.iter().min_by_key(|g| g.state().since);
            first.iter().for_each(|guest| guest.leave());
        } else if !urgent {
            let neighbour = |g: &Arc<Guest>| g.address == self.guest.address;
            // An address that has all it may have makes room by itself.
            let alone = all.iter().filter(|g| neighbour(g)).count() >= of_one;
            if full || alone {
                let longest = (all.iter())
                    .filter(|g| !alone || neighbour(g))
                    .filter_map(|guest| Some((guest.state().stalled?, guest)))
                    .min_by_key(|(since, _)| *since)
                    .filter(|(since, _)| now.saturating_duration_since(*since) >= STUCK);
                longest.ok_or(Crowded)?.1.leave();
            }
        }
        let mut state = self.guest.state();
        if state.stage != Stage::Leaving {
            (state.stage, state.since) = (stage, now);
            (state.begun, state.answered) = (None, false);
        }
        Ok(())
    }

    /// The answer has been made.
    pub fn answered(&self) {
        self.guest.state().answered = true;
    }

    /// All that was made has been sent: after an answer it waits for the next request.
    pub fn sent(&self) {
        if std::mem::take(&mut self.guest.state().answered) {
            self.waits();
        }
    }

    /// It waits for a request, from now on.
    pub fn waits(&self) {
        let mut state = self.guest.state();
        if state.stage != Stage::Leaving {
            (state.stage, state.since) = (Stage::Waiting, Instant::now());
            state.begun = None;
        }
    }

    /// It takes nothing of what is sent (`true`), or something again.
    pub fn stalls(&self, stalls: bool) {
        let mut state = self.guest.state();
        match stalls {
            true => drop(state.stalled.get_or_insert_with(Instant::now)),
            false => state.stalled = None,
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.door
            .guests()
            .retain(|guest| !Arc::ptr_eq(guest, &self.guest));
    }
}

/// Of IPv6 the part that a network has: whoever has one address there has 2⁶⁴.
fn address_of(peer: IpAddr) -> IpAddr {
    match peer.to_canonical() {
        IpAddr::V6(address) => {
            let network = u128::from(address) >> 64 << 64;
            match address.is_loopback() {
                true => address.into(),
                false => Ipv6Addr::from(network).into(),
            }
        }
        address => address,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    const LIMITS: Limits = Limits {
        waiting: 4,
        served: 4,
        of_one: 3,
        urgent: 2,
        idle: Some(Duration::from_secs(15)),
    };

    /// A connection, and whether it was shut down.
    struct Visitor {
        place: Place,
        shut: Arc<AtomicBool>,
    }

    impl Visitor {
        fn new(door: &Arc<Door>, address: &str) -> Self {
            let shut = Arc::<AtomicBool>::default();
            let flag = shut.clone();
            let place = door.enter(address.parse().unwrap(), move || {
                flag.store(true, Ordering::Relaxed)
            });
            Self {
                place: place.unwrap(),
                shut,
            }
        }

        fn stays(&self) -> bool {
            !self.shut.load(Ordering::Relaxed)
        }
    }

    fn crowd(door: &Arc<Door>, address: &str, count: usize) -> Vec<Visitor> {
        (0..count).map(|_| Visitor::new(door, address)).collect()
    }

    fn staying(visitors: &[Visitor]) -> Vec<bool> {
        visitors.iter().map(Visitor::stays).collect()
    }

    #[test]
    fn a_newcomer_gets_the_place_of_who_has_waited_longest_where_most_come_from() {
        let door = Door::new(LIMITS);
        let other = Visitor::new(&door, "10.0.0.9");
        let many = crowd(&door, "127.0.0.1", 3);
        let newcomer = Visitor::new(&door, "10.0.0.8");
        assert_eq!(staying(&many), [false, true, true]);
        assert!(other.stays() && newcomer.stays());
        // Addresses of one network of IPv6 are one, and those of IPv4 are the same in both.
        drop((other, many, newcomer));
        let first = Visitor::new(&door, "::ffff:10.0.0.7");
        let network = [
            Visitor::new(&door, "2001:db8::1"),
            Visitor::new(&door, "2001:db8::2"),
            Visitor::new(&door, "10.0.0.7"),
        ];
        let _newcomer = Visitor::new(&door, "::1");
        assert_eq!((first.stays(), network[0].stays()), (false, true));
    }

    #[test]
    fn who_is_served_leaves_for_nobody_that_waits_and_waits_again_once_all_is_sent() {
        let door = Door::new(LIMITS);
        let served = Visitor::new(&door, "::1");
        served.place.serve(false).unwrap();
        let many = crowd(&door, "::1", 12);
        assert_eq!(many.iter().filter(|one| one.stays()).count(), 4);
        drop(many);
        served.place.answered();
        drop(crowd(&door, "::1", 8));
        assert!(served.stays(), "its answer is not sent yet");
        served.place.sent();
        drop(crowd(&door, "::1", 4));
        assert!(!served.stays());
    }

    #[test]
    fn a_request_is_whole_in_time_however_its_bytes_come() {
        let door = Door::new(LIMITS);
        let [slow, quick, silent, long] = [(); 4].map(|()| Visitor::new(&door, "::1"));
        let begun = Instant::now();
        for _ in 0..100 {
            slow.place.hears();
            quick.place.hears();
        }
        quick.place.serve(false).unwrap();
        long.place.serve(true).unwrap();
        door.sweep(begun + REQUEST - Duration::from_secs(1));
        assert!(slow.stays());
        door.sweep(begun + REQUEST + Duration::from_secs(1));
        assert!(!slow.stays() && quick.stays() && silent.stays());
        door.sweep(begun + 2 * STALL);
        assert!(!silent.stays() && !long.stays());
        assert!(quick.stays(), "an answer may take its time");
        quick.place.stalls(true);
        door.sweep(Instant::now() + 2 * STALL);
        assert!(!quick.stays(), "not if nobody takes it");
    }

    #[test]
    fn who_does_not_read_makes_room_and_where_all_read_a_newcomer_is_told() {
        let door = Door::new(LIMITS);
        let far = Visitor::new(&door, "10.0.0.1");
        far.place.serve(false).unwrap();
        let near = crowd(&door, "::1", 3);
        for one in &near {
            one.place.serve(false).unwrap();
        }
        // Of one address no more than three.
        let newcomer = Visitor::new(&door, "::1");
        assert_eq!(newcomer.place.serve(false), Err(Crowded));
        far.place.stalls(true);
        near[1].place.stalls(true);
        assert_eq!(newcomer.place.serve(false), Err(Crowded), "it may read on");
        let later = Instant::now() + STUCK;
        assert_eq!(newcomer.place.serve_at(false, later), Ok(()));
        assert_eq!(
            (staying(&near), far.stays()),
            (vec![true, false, true], true)
        );
    }

    #[test]
    fn health_has_places_of_its_own_and_nobody_keeps_one() {
        let door = Door::new(LIMITS);
        let busy = crowd(&door, "::1", 4);
        for one in &busy[..3] {
            one.place.serve(false).unwrap();
        }
        let asking = crowd(&door, "::1", 3);
        for one in &asking {
            assert_eq!(one.place.serve(true), Ok(()));
        }
        assert_eq!(staying(&asking), [false, true, true]);
        assert_eq!(staying(&busy), [true; 4]);
    }

    #[test]
    fn those_that_are_leaving_are_bounded_too() {
        let door = Door::new(LIMITS);
        let count = 2 * LIMITS.waiting + LIMITS.served + LIMITS.urgent;
        let many = crowd(&door, "::1", count);
        assert!(door.enter("::1".parse().unwrap(), || ()).is_none());
        drop(many);
        assert!(door.enter("::1".parse().unwrap(), || ()).is_some());
    }
}
