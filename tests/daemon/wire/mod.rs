//! The wire, from outside: daemons as processes, clients of ours and bare Zenoh sessions.

mod archive;
mod commands;
mod garbage;
mod held;
mod instances;
mod meta;
mod patterns;
mod poses;

use palpate_geometry::math::Random;
use std::time::{Duration, Instant};
use zenoh::Wait;

pub use crate::scenes::SOFT_DROP as SCENE;

/// Away from the drop.
pub const FREE: [f64; 3] = [0.06, 0.003, 0.045];

/// A press of 40 mm in 200 ticks along −x; the drop begins after some 25 mm.
pub fn pressing(tick: u64) -> [f64; 3] {
    [0.06 - 2e-4 * tick.min(200) as f64, FREE[1], FREE[2]]
}

/// A Zenoh session that knows nothing of us.
pub fn bare(endpoint: &str) -> zenoh::Session {
    let mut config = zenoh::Config::default();
    let settings = [
        ("mode", "\"peer\"".to_owned()),
        ("scouting/multicast/enabled", "false".to_owned()),
        ("listen/endpoints", "[]".to_owned()),
        ("connect/endpoints", format!("[\"{endpoint}\"]")),
    ];
    for (key, value) in settings {
        config.insert_json5(key, &value).unwrap();
    }
    zenoh::open(config).wait().unwrap()
}

/// Waits until something holds; says what was seen last when it does not.
pub fn until<T: std::fmt::Debug>(
    what: &str,
    mut look: impl FnMut() -> T,
    holds: impl Fn(&T) -> bool,
) -> T {
    let started = Instant::now();
    loop {
        let seen = look();
        if holds(&seen) {
            return seen;
        }
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "{what}: {seen:?}"
        );
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Fewer than `most` bytes that nobody chose.
pub fn any_bytes(random: &mut Random, most: usize) -> Vec<u8> {
    (0..random.below(most))
        .map(|_| random.word() as u8)
        .collect()
}
