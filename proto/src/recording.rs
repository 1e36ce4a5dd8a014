//! Protobuf messages of recordings, generated from `proto/palpate/v1/recording.proto`.

#![allow(missing_docs, clippy::all)]

include!(concat!(env!("OUT_DIR"), "/palpate.v1.rs"));

/// `FileDescriptorSet` of all messages here, as MCAP schemas carry it.
pub const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/descriptors.bin"));
