//! The page in a browser, and the bundle that the daemon embeds. Where there is no npm, no Chromium
//! or nothing installed in `clients/web`, they say that they were skipped.

use crate::daemon::PROGRAM;
use std::path::{Path, PathBuf};
use std::process::Command;

/// `clients/web`, if its packages are installed.
fn web() -> Option<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("clients/web");
    if directory.join("node_modules/esbuild").is_dir() {
        return Some(directory);
    }
    println!("skipped: nothing is installed in clients/web (npm ci)");
    None
}

/// Runs to the end, which must be a good one; gives stdout.
fn run(program: &str, arguments: &[&str], directory: &Path) -> String {
    let done = Command::new(program)
        .args(arguments)
        .env("PALPATE", PROGRAM)
        .current_dir(directory)
        .output()
        .unwrap_or_else(|e| panic!("{program}: {e}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, err) = (text(&done.stdout), text(&done.stderr));
    assert!(
        done.status.success(),
        "{program} {arguments:?}\n{out}\n{err}"
    );
    out
}

// What a build with Rust alone serves is what the sources of the page make.
#[test]
fn the_embedded_page_is_what_its_sources_make() {
    if let Some(web) = web() {
        run("npm", &["run", "--silent", "page:check"], &web);
    }
}

#[test]
fn a_browser_shows_presses_records_and_seeks() {
    let Some(web) = web() else { return };
    if !web.join("node_modules/playwright-core").is_dir() {
        println!("skipped: playwright-core is not installed in clients/web (npm ci)");
        return;
    }
    let browsers = ["chromium", "chromium-browser", "google-chrome"];
    let there = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    if !browsers.iter().any(there) {
        println!("skipped: there is no Chromium (apt-get install chromium)");
        return;
    }
    for script in ["build", "build:tests"] {
        run("npm", &["run", "--silent", script], &web);
    }
    println!("{}", run("node", &["tests/browser.mjs"], &web));
}
