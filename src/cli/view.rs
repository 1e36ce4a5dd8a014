//! `palpate view`: recordings on a page.

use super::Outcome;
use super::page::{PageArgs, open_in_browser};
use super::text;
use crate::viewer::{RecordingsViewer, ViewerSettings, html_page};
use anyhow::Context as _;
use palpate_record::{Session, recorded_scene};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording, or a directory of recordings.
    path: PathBuf,
    /// Show this recording beside the first one, with their differences.
    #[arg(long, value_name = "OTHER")]
    against: Option<PathBuf>,
    /// Write one self-contained page instead, which opens from disk.
    #[arg(long, value_name = "OUT.html", conflicts_with_all = ["against", "http"])]
    html: Option<PathBuf>,
    /// With --html: most bytes of recording in the page; a longer one is thinned.
    #[arg(long, default_value = "16MB", value_parser = text::bytes, requires = "html")]
    max_data: u64,
    #[command(flatten)]
    page: PageArgs,
}

/// Most files of a directory.
const MOST_FILES: usize = 1_000;

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    if let Some(out) = &args.html {
        return write_page(args, out);
    }
    let mut files = files(&args.path)?;
    if let Some(other) = &args.against {
        anyhow::ensure!(
            args.path.is_file(),
            "--against compares two recordings: {} is a directory",
            args.path.display()
        );
        files.push(other.clone());
    }
    for file in &files {
        // Said here, not on an empty page. A directory may hold other people's files.
        if !args.path.is_dir() {
            Session::open(file)?;
        }
    }
    serve_page(
        &files,
        args.against.is_some(),
        args.page.http,
        args.page.http_host.clone(),
        !args.page.no_open,
    )
}

/// Shows one recording on a page at an address until Ctrl-C.
pub fn show(file: &Path, address: SocketAddr) -> anyhow::Result<Outcome> {
    serve_page(&[file.to_owned()], false, Some(address), Vec::new(), false)
}

fn serve_page(
    files: &[PathBuf],
    against: bool,
    address: Option<SocketAddr>,
    hosts: Vec<String>,
    open: bool,
) -> anyhow::Result<Outcome> {
    let settings = ViewerSettings {
        open: Vec::new(),
        address,
        hosts,
        origins: Vec::new(),
        foxglove: None,
        view_only: true,
        instance: String::new(),
        played: false,
    };
    let viewer = RecordingsViewer::start(&settings, files, against)?;
    let url = viewer.url();
    eprintln!("page: {url}\nCtrl-C ends it");
    if open {
        open_in_browser(&url);
    }
    let (end, ended) = channel();
    ctrlc::set_handler(move || {
        let _ = end.send(());
    })
    .context("listening for Ctrl-C")?;
    let _ = ended.recv();
    Ok(Outcome::Ok)
}

/// The recording, or those of a directory by name.
fn files(path: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let at = || path.display().to_string();
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let is_recording = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.ends_with(".mcap") || name.ends_with(".mcap.part")
    };
    let mut files: Vec<PathBuf> = std::fs::read_dir(path)
        .with_context(at)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(is_recording)
        .collect();
    files.sort();
    anyhow::ensure!(
        !files.is_empty(),
        "{} has no recordings (*.mcap)",
        path.display()
    );
    if files.len() > MOST_FILES {
        eprintln!(
            "note: showing the first {MOST_FILES} of {} recordings",
            files.len()
        );
        files.truncate(MOST_FILES);
    }
    Ok(files)
}

fn write_page(args: &Args, out: &Path) -> anyhow::Result<Outcome> {
    anyhow::ensure!(
        !args.path.is_dir(),
        "--html takes one recording: {} is a directory",
        args.path.display()
    );
    let session = Session::open(&args.path)?;
    let scene = recorded_scene(&session)?;
    let name = args.path.file_name().unwrap_or_default().to_string_lossy();
    let (page, every) = html_page(&session, &scene, &name, args.max_data)?;
    std::fs::write(out, &page).with_context(|| out.display().to_string())?;
    println!(
        "wrote {} ({:.1} MB)",
        out.display(),
        page.len() as f64 * 1e-6
    );
    if every > 1 {
        println!(
            "thinned: one tick in {every}, and nets as much rarer; --max-data keeps more. It does not replay."
        );
    }
    Ok(Outcome::Ok)
}
