//! The page in a browser, and the bundle that the daemon embeds. Where there is no npm, no Chromium
//! or nothing installed in `clients/web`, they say that they were skipped.

use crate::daemon::{PROGRAM, quiet};
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
fn run(command: &mut Command, directory: &Path) -> String {
    let done = command
        .env("PALPATE", PROGRAM)
        .current_dir(directory)
        .output()
        .unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, err) = (text(&done.stdout), text(&done.stderr));
    assert!(done.status.success(), "{command:?}\n{out}\n{err}");
    out
}

fn npm(script: &str, web: &Path) {
    run(Command::new("npm").args(["run", "--silent", script]), web);
}

/// A Chromium on the path, or that of `CHROMIUM`.
fn chromium() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("CHROMIUM") {
        return Some(path.into());
    }
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&path)
        .flat_map(|directory| names.map(|name| directory.join(name)))
        .find(|program| program.is_file())
}

// What a build with Rust alone serves is what the sources of the page make.
#[test]
fn the_embedded_page_is_what_its_sources_make() {
    if let Some(web) = web() {
        npm("page:check", &web);
    }
}

#[test]
fn a_browser_shows_presses_records_and_seeks() {
    let Some(web) = web() else { return };
    if !web.join("node_modules/playwright-core").is_dir() {
        println!("skipped: playwright-core is not installed in clients/web (npm ci)");
        return;
    }
    let Some(chromium) = chromium() else {
        println!("skipped: there is no Chromium (apt-get install chromium)");
        return;
    };
    for script in ["build", "build:tests"] {
        npm(script, &web);
    }
    let _quiet = quiet();
    let mut node = Command::new("node");
    node.arg("tests/browser.mjs").env("CHROMIUM", chromium);
    println!("{}", run(&mut node, &web));
}
