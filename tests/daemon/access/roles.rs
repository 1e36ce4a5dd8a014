//! Every role tries everything on every key of a daemon with TLS. What may come through is in the
//! table; what comes through is found out at the other end.

use super::{Secured, request};
use palpate::auth::Role;
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::query::QueryTarget;

/// Who tries: `ghost` is a tool that the scene does not have, and with it any name without a role.
const ROLES: [&str; 5] = ["operator", "tool:ball", "tool:pen", "viewer", "tool:ghost"];

/// Verb, key, and which of the roles may.
const TABLE: &[(&str, &str, [bool; 5])] = &[
    ("put", "tool/ball/pose", [true, true, false, false, false]),
    ("put", "tool/ball/device", [true, true, false, false, false]),
    ("put", "tool/pen/pose", [true, false, true, false, false]),
    ("put", "tool/pen/device", [true, false, true, false, false]),
    (
        "token",
        "@live/tool/ball",
        [true, true, false, false, false],
    ),
    ("token", "@live/tool/pen", [true, false, true, false, false]),
    ("command", "rpc/pause", [true, false, false, false, false]),
    ("command", "rpc/resume", [true, false, false, false, false]),
    ("command", "rpc/reset", [true, false, false, false, false]),
    ("command", "rpc/step", [true, false, false, false, false]),
    (
        "command",
        "rpc/record_stop",
        [true, false, false, false, false],
    ),
    ("command", "rpc/merge", [true, false, false, false, false]),
    ("query", "scene", [true, true, true, true, false]),
    ("query", "status", [true, true, true, true, false]),
    ("query", "event", [true, true, true, true, false]),
    ("query", "body/drop/net", [true, true, true, true, false]),
    ("query", "@meta/info", [true, true, true, true, false]),
    ("query", "@meta/metrics", [true, true, true, true, false]),
    ("query", "@meta/schema/*", [true, true, true, true, false]),
    ("tokens", "@live/*/*", [true, true, true, true, false]),
    ("hear", "tool/ball/force", [true, true, true, true, false]),
    ("hear", "body/drop/net", [true, true, true, true, false]),
    ("hear", "status", [true, true, true, true, false]),
    ("hear", "**", [true, true, true, true, false]),
    // To pass for the daemon.
    ("put", "tool/ball/force", [true, false, false, false, false]),
    ("put", "body/drop/net", [true, false, false, false, false]),
    ("put", "event", [true, false, false, false, false]),
    ("answer", "scene", [true, false, false, false, false]),
    ("answer", "rpc/pause", [true, false, false, false, false]),
    (
        "token",
        "@live/server/fake",
        [true, false, false, false, false],
    ),
];

/// How long it takes to be sure that nothing comes. What is allowed is waited for longer.
const NEVER: Duration = Duration::from_millis(400);
const SURELY: Duration = Duration::from_secs(20);

fn key(rest: &str) -> String {
    format!("palpate/default/{rest}")
}

/// Tries until it works or nothing more is to be expected.
fn tries(expected: bool, mut works: impl FnMut() -> bool) -> bool {
    let (begun, patience) = (Instant::now(), if expected { SURELY } else { NEVER });
    while begun.elapsed() < patience {
        if works() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    works()
}

/// The first answer without error.
fn asked(session: &zenoh::Session, selector: &str, patience: Duration) -> Option<Vec<u8>> {
    let get = session.get(selector).timeout(patience);
    let replies = get.target(QueryTarget::All).wait().unwrap();
    let mut found = None;
    while let Ok(reply) = replies.recv() {
        if let Ok(sample) = reply.result() {
            found = Some(sample.payload().to_bytes().into_owned());
        }
    }
    found
}

/// What the daemon has counted of a tool: malformed poses, refused descriptions.
fn counted(operator: &zenoh::Session, tool: &str, what: &str) -> u64 {
    match what {
        "pose" => {
            let text = asked(operator, &key("@meta/metrics"), SURELY).unwrap();
            let text = String::from_utf8(text).unwrap();
            let lines = text.lines().filter(|line| {
                line.contains(&format!("tool=\"{tool}\"")) && line.contains("malformed")
            });
            let count = lines.filter_map(|line| line.rsplit(' ').next()?.parse::<u64>().ok());
            count.sum()
        }
        _ => {
            let text = asked(operator, &key("@meta/info"), SURELY).unwrap();
            let info: Value = serde_json::from_slice(&text).unwrap();
            info["devices"][tool]["refused"].as_u64().unwrap_or(0)
        }
    }
}

/// One cell: does it come through?
fn cell(
    verb: &str,
    rest: &str,
    expected: bool,
    own: &zenoh::Session,
    operator: &zenoh::Session,
) -> bool {
    let at = key(rest);
    match verb {
        // Seen by what the daemon counts: the holder's own poses do not matter.
        "put" if rest.ends_with("/pose") || rest.ends_with("/device") => {
            let mut parts = rest.split('/').skip(1);
            let (tool, what) = (parts.next().unwrap(), parts.next().unwrap());
            let before = counted(operator, tool, what);
            tries(expected, || {
                own.put(&at, vec![0xff; 5]).wait().unwrap();
                counted(operator, tool, what) > before
            })
        }
        "put" => {
            let fake = Arc::new(AtomicBool::new(false));
            let seen = fake.clone();
            let listening = operator.declare_subscriber(&at).callback(move |sample| {
                seen.fetch_or(&*sample.payload().to_bytes() == b"fake", Ordering::Relaxed);
            });
            let _listening = listening.wait().unwrap();
            tries(expected, || {
                own.put(&at, b"fake".to_vec()).wait().unwrap();
                std::thread::sleep(Duration::from_millis(30));
                fake.load(Ordering::Relaxed)
            })
        }
        "token" => {
            let _token = own.liveliness().declare_token(&at).wait().unwrap();
            tries(expected, || live(operator, &at) > 0)
        }
        "tokens" => tries(expected, || live(own, &at) > 0),
        "command" => {
            let patience = if expected { SURELY } else { NEVER };
            // Refused by the daemon for its arguments is an answer too.
            asked(own, &at, patience).is_some()
        }
        "query" => {
            let patience = if expected { SURELY } else { NEVER };
            asked(own, &at, patience).is_some()
        }
        "hear" => {
            let (heard, messages) = mpsc::channel();
            let listening = own.declare_subscriber(&at).callback(move |sample| {
                let _ = heard.send(sample.payload().len());
            });
            let _listening = listening.wait().unwrap();
            let patience = if expected { SURELY } else { NEVER };
            messages.recv_timeout(patience).is_ok()
        }
        "answer" => {
            let answering = own.declare_queryable(&at).callback({
                let at = at.clone();
                move |query| drop(query.reply(at.clone(), b"fake".to_vec()).wait())
            });
            let _answering = answering.wait().unwrap();
            tries(expected, || {
                let replies = operator.get(&at).timeout(Duration::from_secs(2));
                let replies = replies.target(QueryTarget::All);
                let replies = replies
                    .consolidation(zenoh::query::ConsolidationMode::None)
                    .wait()
                    .unwrap();
                let mut fake = false;
                while let Ok(reply) = replies.recv() {
                    let answer = reply.result();
                    fake |= answer.is_ok_and(|sample| &*sample.payload().to_bytes() == b"fake");
                }
                fake
            })
        }
        other => panic!("{other}?"),
    }
}

fn live(session: &zenoh::Session, at: &str) -> usize {
    let get = session.liveliness().get(at).timeout(NEVER).wait().unwrap();
    let mut count = 0;
    while let Ok(reply) = get.recv() {
        count += usize::from(reply.result().is_ok());
    }
    count
}

#[test]
fn each_role_does_what_its_certificate_says_and_nothing_else() {
    all_roles("tls", TABLE);
}

// The rules are by certificate, whatever carries it: a row of each verb.
#[test]
fn each_role_does_the_same_over_quic() {
    let mut verbs = Vec::new();
    let first = TABLE.iter().filter(|(verb, ..)| {
        let is_first = !verbs.contains(verb);
        verbs.push(verb);
        is_first
    });
    let rows: Vec<_> = first.copied().collect();
    all_roles("quic", &rows);
}

fn all_roles(protocol: &str, rows: &[(&str, &str, [bool; 5])]) {
    let secured = Secured::start_as(&request(Role::Daemon), protocol);
    let role = |name: &str| Role::of(name).unwrap();
    let operator = secured.session(&secured.identity(Role::Operator)).unwrap();
    // Somebody holds the ball, so that there are forces to hear.
    let ends = Arc::new(AtomicBool::new(false));
    let (ended, poses) = (ends.clone(), Arc::new(AtomicU32::new(0)));
    let holder = secured
        .session(&secured.identity(role("tool:ball")))
        .unwrap();
    let moved = poses.clone();
    let holding = std::thread::spawn(move || {
        while !ended.load(Ordering::Relaxed) {
            let seq = moved.fetch_add(1, Ordering::Relaxed) + 1;
            let pose = palpate_client::proto::messages::ToolPose {
                seq: u64::from(seq),
                ..palpate_client::pose_at([0.06, 0.003, 0.045])
            };
            let bytes = palpate_client::proto::codec::encode(&pose);
            holder.put(key("tool/ball/pose"), bytes).wait().unwrap();
            std::thread::sleep(Duration::from_millis(10));
        }
    });
    let sessions = ROLES.map(|name| secured.session(&secured.identity(role(name))).unwrap());
    let mut came = vec![[false; ROLES.len()]; rows.len()];
    // Those who may not do what a verb says try at the same time: each waits to be sure that nothing comes, and
    // what comes of one is seen by all of them. Then those who may, one after another.
    let verbs: BTreeSet<&str> = rows.iter().map(|(verb, ..)| *verb).collect();
    for verb in verbs {
        let cells = |expected: bool| {
            let of_verb = rows
                .iter()
                .enumerate()
                .filter(move |(_, row)| row.0 == verb);
            let cells = of_verb.flat_map(|(k, row)| (0..ROLES.len()).map(move |r| (k, r, row)));
            cells.filter(move |(_, r, (.., may))| may[*r] == expected)
        };
        std::thread::scope(|scope| {
            let denied: Vec<_> = cells(false)
                .map(|(k, r, (verb, rest, _))| {
                    let (own, operator) = (&sessions[r], &operator);
                    (
                        k,
                        r,
                        scope.spawn(move || cell(verb, rest, false, own, operator)),
                    )
                })
                .collect();
            for (k, r, tried) in denied {
                came[k][r] = tried.join().unwrap();
            }
        });
        for (k, r, (verb, rest, _)) in cells(true) {
            came[k][r] = cell(verb, rest, true, &sessions[r], &operator);
        }
    }
    ends.store(true, Ordering::Relaxed);
    holding.join().unwrap();
    let mut wrong = Vec::new();
    let mut table = format!("{:<8} {:<22}", "", "");
    for name in ROLES {
        table += &format!(" {name:>10}");
    }
    for ((verb, rest, may), came) in rows.iter().zip(&came) {
        table += &format!("\n{verb:<8} {rest:<22}");
        for ((name, expected), came) in ROLES.iter().zip(may).zip(came) {
            table += &format!(" {:>10}", if *came { "yes" } else { "-" });
            if came != expected {
                wrong.push(format!("{name} {verb} {rest}: {came}, not {expected}"));
            }
        }
    }
    println!("{table}\n{} cells", rows.len() * ROLES.len());
    assert!(wrong.is_empty(), "{wrong:#?}");
}
