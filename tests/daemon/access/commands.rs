//! `palpate auth`, and the commands that take an identity.

use super::Secured;
use crate::daemon::PROGRAM;
use palpate::auth::Role;
use std::path::Path;
use std::process::Command;

fn auth(arguments: &[&str]) -> (i32, String) {
    let output = Command::new(PROGRAM)
        .arg("auth")
        .args(arguments)
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    (output.status.code().unwrap_or(-1), words)
}

#[test]
fn identities_are_made_shown_and_never_overwritten() {
    let directory = tempfile::tempdir().unwrap();
    let ca = directory.path().join("keys").display().to_string();
    let (code, words) = auth(&["issue", &ca, "--role", "viewer"]);
    assert!(code == 2 && words.contains("palpate auth init"), "{words}");
    let (code, words) = auth(&["init", &ca, "--host", "lab.example", "--host", "10.0.0.7"]);
    assert_eq!(code, 0, "{words}");
    let (code, words) = auth(&["init", &ca]);
    assert!(code == 2 && words.contains("exists already"), "{words}");
    let tool = [
        "issue", &ca, "--role", "tool", "--tool", "ball", "--for", "30d", "--name", "ada",
    ];
    let (code, words) = auth(&tool);
    assert!(
        code == 0 && words.trim().ends_with("tool-ball-ada.json5"),
        "{words}"
    );
    let (code, words) = auth(&tool);
    assert!(code == 2 && words.contains("exists already"), "{words}");
    assert_eq!(
        auth(&["issue", &ca, "--role", "viewer", "--for", "12h"]).0,
        0
    );
    for wrong in [
        &["--role", "tool"][..],
        &["--role", "tool", "--tool", "*"],
        &["--role", "tool", "--tool", "a/b"],
        &["--role", "viewer", "--tool", "ball"],
        &["--role", "viewer", "--host", "here"],
        &["--role", "root"],
        &["--role", "viewer", "--for", "0d"],
        &["--role", "viewer", "--for", "99999d"],
        &["--role", "viewer", "--name", "../x"],
        &["--role", "daemon", "--name", "x", "--host", "not a name"],
    ] {
        let (code, words) = auth(&[&["issue", &ca][..], wrong].concat());
        assert!(
            code == 2 && !words.contains("panicked"),
            "{wrong:?}: {code} {words}"
        );
    }
    let (code, words) = auth(&["show", &ca]);
    println!("{words}");
    assert_eq!(code, 0, "{words}");
    for expected in [
        "daemon, valid for 365",
        "localhost, 127.0.0.1, ::1, lab.example, 10.0.0.7",
        "operator, valid for 365",
        "tool:ball, of ada, valid for 30.0 days",
        "publishes palpate/default/tool/ball/pose, palpate/default/tool/ball/device",
        "viewer, valid for 0.5 days",
        "nothing else: no command",
    ] {
        assert!(words.contains(expected), "{expected:?} in {words}");
    }
    assert!(!words.contains("WARNING"), "{words}");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let mode = |name: &str| {
            let data = std::fs::metadata(Path::new(&ca).join(name)).unwrap();
            data.permissions().mode() & 0o777
        };
        for secret in [
            "ca.key",
            "daemon.json5",
            "operator.json5",
            "tool-ball-ada.json5",
        ] {
            assert_eq!(mode(secret), 0o600, "{secret}");
        }
    }
    let (code, words) = auth(&["rules", "builtin:teardrop"]);
    let rules: serde_json::Value = serde_json::from_str(&words).unwrap();
    assert!(code == 0 && rules["access_control"]["default_permission"] == "deny");
    let text = Path::new(&ca).join("viewer.json5");
    let not_one = directory.path().join("none.json5");
    std::fs::write(&not_one, "{ mode: 'peer' }").unwrap();
    assert_eq!(auth(&["show", not_one.to_str().unwrap()]).0, 2);
    // Any Zenoh program takes it as its configuration.
    assert!(zenoh::Config::from_file(text).is_ok());
}

pub(super) fn a_device_presses_with_its_own_identity_and_a_viewer_gives_no_commands() {
    let secured = Secured::start();
    let ball = secured.identity(Role::tool("ball").unwrap());
    let viewer = secured.identity(Role::Viewer);
    let device = [
        "device", "--motion", "press", "--depth", "0.004", "--for", "2s", "--json",
    ];
    // All at the same time: who is refused waits for an answer.
    std::thread::scope(|scope| {
        let secured = &secured;
        let run = |arguments: &[&'static str], identity| {
            let arguments = arguments.to_vec();
            scope.spawn(move || secured.palpate(&arguments, identity))
        };
        let own = run(&[&device[..], &["--tool", "ball"]].concat(), &ball);
        let of_another = run(&[&device[..], &["--tool", "pen"]].concat(), &ball);
        let paused = run(&["rpc", "pause"], &viewer);
        let looks = [
            &["ls"][..],
            &["echo", "status", "--count", "2"],
            &["hz", "status", "--for", "1s"],
        ]
        .map(|arguments| (arguments, run(arguments, &viewer)));
        let (code, words) = own.join().unwrap();
        assert_eq!(code, 0, "{words}");
        let report = words.lines().find(|line| line.starts_with('{')).unwrap();
        let report: serde_json::Value = serde_json::from_str(report).unwrap();
        println!("{report}");
        // Another's tool: no force comes.
        let (code, words) = of_another.join().unwrap();
        assert_ne!(code, 0, "{words}");
        for (arguments, looked) in looks {
            let (code, words) = looked.join().unwrap();
            assert_eq!(code, 0, "{arguments:?}: {words}");
        }
        let (code, words) = paused.join().unwrap();
        assert!(
            code == 2 && words.contains("may this identity ask it"),
            "{words}"
        );
    });
    let (code, words) = secured.palpate(&["rpc", "pause"], &secured.identity(Role::Operator));
    assert_eq!(code, 0, "{words}");
}
