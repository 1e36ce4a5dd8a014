//! Compiles the Protobuf messages of recordings; no `protoc` needed.

use prost::Message as _;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const ROOT: &str = "proto";
const OURS: &str = "palpate/v1/recording.proto";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed={ROOT}");
    if std::env::var_os("CARGO_FEATURE_RECORDING").is_none() {
        return Ok(());
    }
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    let mut files = vec![OURS.to_owned()];
    files.extend(published()?);
    let all = protox::compile(&files, [ROOT])?;
    std::fs::write(out.join("descriptors.bin"), all.encode_to_vec())?;

    // A channel of a recording carries its message's file and what that imports, not everything: a
    // set for each file.
    let mut arms = String::new();
    for (number, file) in files.iter().enumerate() {
        let mut wanted = BTreeSet::from([file.clone()]);
        // Imports stand before who imports them, so one pass from the end finds them all.
        for descriptor in all.file.iter().rev() {
            if wanted.contains(descriptor.name()) {
                wanted.extend(descriptor.dependency.iter().cloned());
            }
        }
        let mut set = all.clone();
        set.file
            .retain(|descriptor| wanted.contains(descriptor.name()));
        // Comments of our own messages tell what their packed numbers are; the published ones are
        // known.
        set.file
            .iter_mut()
            .filter(|descriptor| descriptor.name() != OURS)
            .for_each(|d| d.source_code_info = None);
        std::fs::write(
            out.join(format!("descriptors_{number}.bin")),
            set.encode_to_vec(),
        )?;
        let own = all
            .file
            .iter()
            .find(|descriptor| descriptor.name() == file.as_str())
            .ok_or("a file went missing")?;
        let names: Vec<String> = own
            .message_type
            .iter()
            .map(|m| format!("\"{}.{}\"", own.package(), m.name()))
            .collect();
        writeln!(
            arms,
            "{} => Some(include_bytes!(concat!(env!(\"OUT_DIR\"), \"/descriptors_{number}.bin\"))),",
            names.join(" | ")
        )?;
    }
    std::fs::write(
        out.join("descriptor_sets.rs"),
        format!("match message {{\n{arms}_ => None,\n}}\n"),
    )?;
    prost_build::Config::new().compile_fds(all)?;
    Ok(())
}

/// The Foxglove messages that recordings use, as paths below the root.
fn published() -> std::io::Result<Vec<String>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(Path::new(ROOT).join("foxglove"))? {
        files.push(format!("foxglove/{}", entry?.file_name().to_string_lossy()));
    }
    files.sort();
    Ok(files)
}
