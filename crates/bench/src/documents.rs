//! Tables of documents, written from what is measured: between two comments, of which the first says from
//! what they are.
//!
//! ```text
//! <!-- figures: NAME; measured at 1a2b3c4d; inputs 0123456789abcdef -->
//! <!-- end of figures -->
//! ```
//! A table is stale when its inputs are no longer those: the sources of its measurement, and for the
//! simulation the hashes that its golden recordings are held to, which change whenever bits do.

mod list;

use anyhow::{Context as _, ensure};
use list::{Table, tables};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Which tables, and what to do with them.
#[derive(clap::Args, Debug)]
pub struct DocumentOptions {
    /// Measure those that are stale, or those of --only, and write them into their documents.
    #[arg(long)]
    update: bool,
    /// Only tables whose names contain this.
    #[arg(long)]
    only: Option<String>,
}

const BEGIN: &str = "<!-- figures: ";
const END: &str = "<!-- end of figures -->";

/// Lists the tables of documents, or writes them; true if none is stale.
///
/// # Errors
/// A document without the comments of its table, or something that could not be measured.
pub fn documents(options: &DocumentOptions) -> anyhow::Result<bool> {
    let root = root();
    let mut fresh = true;
    let wanted =
        |table: &&Table| (options.only.as_ref()).is_none_or(|part| table.name.contains(part));
    let tables = tables();
    let chosen: Vec<&Table> = tables.iter().filter(wanted).collect();
    ensure!(!chosen.is_empty(), "no table has that name");
    for table in chosen {
        let path = root.join(table.document);
        let text = read(&path)?;
        let state = state(table, &text, &root)?;
        let asked = options.only.is_some() || !matches!(state, State::Fresh);
        if !options.update || !asked {
            fresh &= matches!(state, State::Fresh);
            println!("{}: {}: {}", table.document, table.name, state.words());
            continue;
        }
        if table.timed && cfg!(debug_assertions) {
            println!(
                "{}: {}: not measured: its times are those of a build with --release",
                table.document, table.name
            );
            fresh = false;
            continue;
        }
        eprintln!("{}: {} …", table.document, table.name);
        let measured = (table.measure)()?;
        let stamp = stamp(table, &root)?;
        // The document may have another table by now.
        let text = read(&path)?;
        let written = replaced(&text, &table.name, &stamp, &measured)
            .with_context(|| table.document.to_owned())?;
        std::fs::write(&path, written)
            .with_context(|| format!("cannot write {}", path.display()))?;
        println!("{}: {}: written", table.document, table.name);
    }
    Ok(fresh)
}

/// What is known about a table.
enum State {
    Fresh,
    Stale,
}

impl State {
    fn words(&self) -> &'static str {
        match self {
            Self::Fresh => "as measured",
            Self::Stale => "stale",
        }
    }
}

/// The repository: what is measured is that of these sources.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &Path) -> anyhow::Result<String> {
    std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
}

fn state(table: &Table, text: &str, root: &Path) -> anyhow::Result<State> {
    let comment = (comments(text).into_iter())
        .find(|comment| comment.name == table.name)
        .with_context(|| format!("{} has no table {:?}", table.document, table.name))?;
    let inputs = format!("inputs {}", inputs(table, root)?);
    Ok(match comment.stamp.split("; ").any(|part| part == inputs) {
        true => State::Fresh,
        false => State::Stale,
    })
}

/// The comment before a table.
struct Comment<'a> {
    name: &'a str,
    /// Commit and inputs.
    stamp: &'a str,
}

fn comments(text: &str) -> Vec<Comment<'_>> {
    text.lines().filter_map(comment).collect()
}

fn comment(line: &str) -> Option<Comment<'_>> {
    let inside = line.strip_prefix(BEGIN)?.strip_suffix(" -->")?;
    let (name, stamp) = inside.split_once("; ")?;
    Some(Comment { name, stamp })
}

/// The document with another table between the comments.
fn replaced(text: &str, name: &str, stamp: &str, table: &str) -> anyhow::Result<String> {
    let begin = format!("{BEGIN}{name}; ");
    let start = text
        .find(&begin)
        .with_context(|| format!("no line begins with {begin:?}"))?;
    let length = text[start..]
        .find(END)
        .with_context(|| format!("{name:?} has no {END:?}"))?;
    Ok(format!(
        "{}{begin}{stamp} -->\n\n{}\n\n{}",
        &text[..start],
        table.trim(),
        &text[start + length..]
    ))
}

/// Commit, machine where it matters, inputs.
fn stamp(table: &Table, root: &Path) -> anyhow::Result<String> {
    let git = |arguments: &[&str]| -> anyhow::Result<String> {
        let output = Command::new("git")
            .args(arguments)
            .current_dir(root)
            .output();
        let output = output.context("cannot ask git for the commit that is measured")?;
        ensure!(
            output.status.success(),
            "git: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        Ok(String::from_utf8(output.stdout)?.trim().to_owned())
    };
    let commit = git(&["rev-parse", "--short=8", "HEAD"])?;
    let changed = git(&[
        "status",
        "--porcelain",
        "--untracked-files=no",
        "--",
        ".",
        ":!docs",
    ])?;
    let with = if changed.is_empty() {
        ""
    } else {
        " with changes"
    };
    let machine = match table.timed {
        true => format!("; {}", machine()),
        false => String::new(),
    };
    let inputs = inputs(table, root)?;
    Ok(format!(
        "measured at {commit}{with}{machine}; inputs {inputs}"
    ))
}

/// Cores and their kind.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let kind = (information.lines())
        .find_map(|line| line.strip_prefix("model name")?.split_once(": "))
        .map_or("unknown processor", |(_, kind)| kind.trim());
    format!("{cores} cores, {kind}")
}

/// Hash of what a table depends on.
fn inputs(table: &Table, root: &Path) -> anyhow::Result<String> {
    let mut hash = Fnv::default();
    for input in &table.inputs {
        let mut files = Vec::new();
        gather(&root.join(input), &mut files)?;
        files.sort();
        for file in files {
            let said = said(&file)?;
            hash.add(said.as_bytes());
        }
    }
    if table.of_simulation {
        for session in golden(root)? {
            hash.add(session.as_bytes());
        }
    }
    Ok(format!("{:016x}", hash.0))
}

/// Files in a folder and those below, without tests; a file is itself.
fn gather(path: &Path, found: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    if path.file_stem().is_some_and(|stem| stem == "tests") {
        return Ok(());
    }
    let missing = || format!("cannot read {}, on which a table depends", path.display());
    if path.is_dir() {
        for entry in std::fs::read_dir(path).with_context(missing)? {
            gather(&entry?.path(), found)?;
        }
        return Ok(());
    }
    ensure!(path.is_file(), missing());
    let kind = path.extension().and_then(std::ffi::OsStr::to_str);
    if matches!(kind, Some("rs" | "toml" | "json" | "py" | "cpp")) {
        found.push(path.to_owned());
    }
    Ok(())
}

/// What a file says: without comments, indentation and tests.
fn said(path: &Path) -> anyhow::Result<String> {
    let text = read(path)?;
    let comment = match path.extension().and_then(std::ffi::OsStr::to_str) {
        Some("rs" | "cpp") => "//",
        Some("json") => return Ok(text),
        _ => "#",
    };
    let code = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or_default();
    let lines = code.lines().map(str::trim);
    Ok(lines
        .filter(|line| !line.is_empty() && !line.starts_with(comment))
        .collect::<Vec<_>>()
        .join("\n"))
}

/// Hashes of all states and nets that golden recordings come to: they change whenever bits do, but not when
/// only a flag of an output is added.
fn golden(root: &Path) -> anyhow::Result<BTreeSet<String>> {
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(root.join("recordings/golden"))? {
        let path = entry?.path();
        if path.extension().is_none_or(|kind| kind != "json") {
            continue;
        }
        let figures: serde_json::Value = serde_json::from_str(&read(&path)?)?;
        let hashes = ["session", "nets"].map(|of| figures["hashes"][of].as_str());
        found.extend(hashes.into_iter().flatten().map(str::to_owned));
    }
    ensure!(!found.is_empty(), "recordings/golden has no hashes");
    Ok(found)
}

/// FNV-1a, 64 bits.
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// Bytes, and that they end here.
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes.iter().chain(&[0xff]) {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Documents that may have tables.
    fn texts() -> Vec<(String, String)> {
        let mut paths = vec![root().join("README.md")];
        for entry in std::fs::read_dir(root().join("docs")).unwrap() {
            paths.push(entry.unwrap().path());
        }
        paths.retain(|path| path.extension().is_some_and(|kind| kind == "md"));
        let text = |path: PathBuf| (path.display().to_string(), read(&path).unwrap());
        paths.into_iter().map(text).collect()
    }

    #[test]
    fn no_table_of_a_document_is_older_than_what_it_is_of() {
        let mut stale = Vec::new();
        for table in tables() {
            let text = read(&root().join(table.document)).unwrap();
            if let State::Stale = state(&table, &text, &root()).unwrap() {
                let release = if table.timed { "--release " } else { "" };
                stale.push(format!(
                    "{}: {}: cargo run {release}-p palpate-bench -- documents --update --only {:?}",
                    table.document, table.name, table.name
                ));
            }
        }
        assert!(
            stale.is_empty(),
            "what these tables are measured from has changed; measure them again:\n{}",
            stale.join("\n")
        );
    }

    #[test]
    fn every_comment_in_a_document_is_of_a_table_that_can_be_measured() {
        let tables = tables();
        for (path, text) in texts() {
            let comments = comments(&text);
            assert_eq!(
                text.matches(BEGIN).count(),
                comments.len(),
                "{path}: a comment does not read"
            );
            assert_eq!(
                text.matches(END).count(),
                comments.len(),
                "{path}: {END} is missing"
            );
            for comment in comments {
                let known = tables.iter().filter(|table| table.name == comment.name);
                assert!(
                    known.clone().count() == 1 && known.clone().all(|t| path.ends_with(t.document)),
                    "{path}: {:?} is no table of it",
                    comment.name
                );
            }
        }
    }

    #[test]
    fn a_table_of_other_inputs_is_stale_and_one_of_these_is_not() {
        let tables = tables();
        let table = &tables[0];
        let of = |stamp: &str| {
            let text = format!("{BEGIN}{}; {stamp} -->\n\n{END}\n", table.name);
            state(table, &text, &root()).unwrap().words()
        };
        let now = inputs(table, &root()).unwrap();
        assert_eq!(
            of(&format!("measured at 1a2b3c4d; inputs {now}")),
            "as measured"
        );
        assert_eq!(of("measured at 1a2b3c4d; inputs 0123456789abcdef"), "stale");
        assert_eq!(of("measured at 1a2b3c4d"), "stale");
        assert_eq!(of("to be measured"), "stale");
    }

    #[test]
    fn a_table_is_replaced_and_nothing_else() {
        let text =
            "a\n\n<!-- figures: x; to be measured -->\n\n| old |\n\n<!-- end of figures -->\n\nb\n";
        let once = replaced(text, "x", "measured at 1; inputs 2", "| new |\n").unwrap();
        assert_eq!(
            once,
            "a\n\n<!-- figures: x; measured at 1; inputs 2 -->\n\n| new |\n\n<!-- end of figures -->\n\nb\n"
        );
        assert_eq!(
            replaced(&once, "x", "measured at 1; inputs 2", "| new |").unwrap(),
            once
        );
        assert!(replaced(text, "y", "", "").is_err());
        let comment = &comments(&once)[0];
        assert_eq!(
            (comment.name, comment.stamp),
            ("x", "measured at 1; inputs 2")
        );
    }

    #[test]
    fn comments_and_indentation_change_no_inputs_and_code_does() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("a.rs");
        let of = |text: &str| {
            std::fs::write(&file, text).unwrap();
            said(&file).unwrap()
        };
        let first = of(
            "//! A.\n#[derive(Debug)]\nfn a() {\n    b(); // why\n}\n#[cfg(test)]\nmod tests {\n}\n",
        );
        assert_eq!(
            first,
            of("/// B.\n#[derive(Debug)]\nfn a() {\nb(); // why\n\n}\n")
        );
        assert_ne!(
            first,
            of("#[derive(Debug)]\nfn a() {\n    c(); // why\n}\n")
        );
    }
}
