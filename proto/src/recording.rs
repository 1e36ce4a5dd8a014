//! Protobuf messages of recordings, generated from `proto/palpate/v1/recording.proto`.

#![allow(missing_docs, clippy::all)]

include!(concat!(env!("OUT_DIR"), "/palpate.v1.rs"));

/// `FileDescriptorSet` of all messages of recordings: those here and those of [`crate::foxglove`].
pub const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/descriptors.bin"));

/// `FileDescriptorSet` that a schema of MCAP carries for a message, for example `palpate.v1.Tick`
/// or `foxglove.SceneUpdate`: the file of that message and what it imports. None if we have no such
/// message.
pub fn descriptors(message: &str) -> Option<&'static [u8]> {
    include!(concat!(env!("OUT_DIR"), "/descriptor_sets.rs"))
}
