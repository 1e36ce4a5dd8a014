//! Protobuf messages of recordings, generated from the files in `proto/palpate/v1` by
//! `cargo run -p palpate-proto --example generate`.

#![allow(missing_docs, clippy::all)]

use prost::Message as _;
use std::collections::BTreeSet;

include!("generated/recording.rs");

/// `FileDescriptorSet` of all messages of recordings: those here and those of [`crate::foxglove`].
pub const DESCRIPTORS: &[u8] = include_bytes!("generated/descriptors.bin");

/// `FileDescriptorSet` that a schema of MCAP carries for a message, for example `palpate.v1.Tick`
/// or `foxglove.SceneUpdate`: the file of that message and what it imports. None if we have no such
/// message.
pub fn descriptors(message: &str) -> Option<Vec<u8>> {
    let mut set = prost_types::FileDescriptorSet::decode(DESCRIPTORS).ok()?;
    let (package, name) = message.rsplit_once('.')?;
    let own = set.file.iter().find(|file| {
        file.package() == package && file.message_type.iter().any(|of| of.name() == name)
    })?;
    let mut wanted = BTreeSet::from([own.name().to_owned()]);
    // Imports stand before who imports them, so one pass from the end finds them all.
    for file in set.file.iter().rev() {
        if wanted.contains(file.name()) {
            wanted.extend(file.dependency.iter().cloned());
        }
    }
    set.file.retain(|file| wanted.contains(file.name()));
    Some(set.encode_to_vec())
}
