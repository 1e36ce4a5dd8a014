//! How long one client may hold up a session that others share.
//!
//! A client that stops reading fills its socket. Zenoh then holds the thread that has a message for it which
//! may not be dropped (an answer, an event, a declaration), for [`patience`] before it closes that client's
//! transport; a thread that sends to it waits as long, and one that closes its socket with unsent bytes up
//! to ten seconds. Zenoh has two threads that receive and one that sends: two such clients stopped poses,
//! forces and commands of all others for five to ten seconds. They need threads of their own.

use palpate_sim::scene::Scene;
use std::time::Duration;

/// Links that carry less are not waited for when a whole scene is asked of them, bytes per second.
const SLOWEST_LINK: f64 = 5e6;
/// Zenoh's own.
const LONGEST: Duration = Duration::from_secs(5);
/// Shorter waits would close clients whose machine is busy for a moment.
const SHORTEST: Duration = Duration::from_millis(250);
/// Between routers, which pass on what is not theirs.
pub(crate) const ROUTER_PATIENCE: Duration = Duration::from_secs(1);
/// Zenoh's threads: of those that receive and send, as many as clients that may be held up at a time without
/// others noticing. They sleep otherwise.
const THREADS: &str = "(rx: (worker_threads: 64), tx: (worker_threads: 64), net: (worker_threads: 16), \
                       acc: (worker_threads: 16), app: (worker_threads: 4))";
/// A peer that has connected says who it is within this.
const GREETING: Duration = Duration::from_secs(3);
/// Peers that have connected and not said who they are.
const GREETERS: usize = 512;

/// How long a session waits for a client that does not read: as long as its largest answer, the snapshot
/// of this scene, takes over a link of 40 Mbit/s.
pub fn patience(scene: &Scene) -> Duration {
    let points: usize = (0..scene.body_count())
        .map(|body| scene.skin(body).points().len())
        .sum();
    // At rest and now, three numbers each.
    let bytes = (points * 2 * 3 * size_of::<f64>()) as f64;
    Duration::from_secs_f64(bytes / SLOWEST_LINK).clamp(SHORTEST, LONGEST)
}

/// Bounds of a session that others connect to. What a configuration file has set stays.
pub(crate) fn bound(config: &mut zenoh::Config, patience: Duration) -> Result<(), String> {
    let queue = "transport/link/tx/queue";
    let patience_key = format!("{queue}/congestion_control/block/wait_before_close");
    let bounds = [
        (
            patience_key.as_str(),
            LONGEST.as_micros(),
            patience.as_micros(),
        ),
        // Declarations are sent with the routing tables locked: there is room for many.
        ("transport/link/tx/queue/size/control", 2, 16),
        (
            "transport/unicast/accept_timeout",
            10_000,
            GREETING.as_millis(),
        ),
        ("transport/unicast/accept_pending", 100, GREETERS as u128),
    ];
    for (key, default, ours) in bounds {
        let is = config.get_json(key).map_err(|e| format!("{key}: {e}"))?;
        if is == default.to_string() {
            (config.insert_json5(key, &ours.to_string())).map_err(|e| format!("{key}: {e}"))?;
        }
    }
    Ok(())
}

/// Gives Zenoh a thread for each client that may be held up. To be called before the first session and the
/// first thread of the process; what the user has set stays.
#[allow(unsafe_code)]
pub fn threads_for_many_clients() {
    const NAME: &str = "ZENOH_RUNTIME";
    if std::env::var_os(NAME).is_none() {
        // SAFETY: the caller has started no thread that could read the environment meanwhile.
        unsafe { std::env::set_var(NAME, THREADS) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zenoh_has_the_keys_and_defaults_that_are_replaced_and_a_users_own_stay() {
        let mut config = zenoh::Config::default();
        bound(&mut config, Duration::from_millis(123)).unwrap();
        let queue = "transport/link/tx/queue";
        let block = format!("{queue}/congestion_control/block/wait_before_close");
        for (key, value) in [
            (block.as_str(), "123000"),
            ("transport/link/tx/queue/size/control", "16"),
            ("transport/unicast/accept_timeout", "3000"),
            ("transport/unicast/accept_pending", "512"),
        ] {
            assert_eq!(config.get_json(key).unwrap(), value, "{key}");
        }
        let mut config = zenoh::Config::default();
        config.insert_json5(&block, "77").unwrap();
        bound(&mut config, Duration::from_millis(123)).unwrap();
        assert_eq!(config.get_json(&block).unwrap(), "77");
    }
}
