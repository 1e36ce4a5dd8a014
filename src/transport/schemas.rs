//! Answers about the layout of messages: `@meta/schema/{Type}`.

use super::answers::{reply_json, reply_refused};
use super::post::Asked;
use palpate_proto::keys::Keys;
use palpate_proto::recording::{DESCRIPTORS, descriptors};
use palpate_proto::schema;
use prost::Message as _;
use zenoh::bytes::Encoding;
use zenoh::key_expr::KeyExpr;

/// Answers for every type that the query names: layouts of bus messages, or with `?format=proto`
/// the descriptors of a message of recordings and of what it imports.
pub(super) fn answer(keys: &Keys, query: &Asked) {
    let asked = |name: &str| {
        let key = keys.meta_schema(name);
        KeyExpr::try_from(key)
            .ok()
            .filter(|key| query.key_expr().intersects(key))
    };
    let names = match query.parameters().get("format") {
        None | Some("json") => {
            let found = schema::all().filter_map(|schema| Some((asked(schema.name)?, schema)));
            if found
                .map(|(key, schema)| reply_json(query, key, &schema))
                .count()
                > 0
            {
                return;
            }
            schema::all().map(|schema| schema.name.to_owned()).collect()
        }
        Some("proto") => {
            let names = recording_types();
            let found = names
                .iter()
                .filter_map(|name| Some((asked(name)?, descriptors(name)?)));
            let encoding =
                Encoding::APPLICATION_PROTOBUF.with_schema("google.protobuf.FileDescriptorSet");
            let put = |(key, set): (_, Vec<u8>)| query.answer(key, set, encoding.clone());
            if found.map(put).count() > 0 {
                return;
            }
            names
        }
        Some(other) => {
            return reply_refused(
                query,
                &format!("format={other} is unknown; there are json and proto"),
            );
        }
    };
    reply_refused(
        query,
        &format!("there is no such type; there are {}", names.join(", ")),
    );
}

/// Full names of the messages of recordings.
fn recording_types() -> Vec<String> {
    #[derive(prost::Message)]
    struct Set {
        #[prost(message, repeated, tag = "1")]
        file: Vec<File>,
    }
    #[derive(prost::Message)]
    struct File {
        #[prost(string, tag = "2")]
        package: String,
        #[prost(message, repeated, tag = "4")]
        message_type: Vec<Type>,
    }
    #[derive(prost::Message)]
    struct Type {
        #[prost(string, tag = "1")]
        name: String,
    }
    let set = Set::decode(DESCRIPTORS).unwrap_or_default();
    let types = |file: &File| {
        file.message_type
            .iter()
            .map(|kind| format!("{}.{}", file.package, kind.name))
            .collect()
    };
    set.file
        .iter()
        .flat_map(|file| -> Vec<String> { types(file) })
        .collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn recording_types_are_read_from_the_descriptors() {
        let names = super::recording_types();
        assert!(
            names.contains(&"palpate.v1.Tick".to_owned())
                && names.contains(&"palpate.v1.Keyframe".to_owned())
        );
    }
}
