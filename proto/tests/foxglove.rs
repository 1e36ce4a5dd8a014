//! Our Foxglove messages are the published ones, field by field. `foxglove_published.json` holds
//! the facts, taken from the descriptors of the package that it names.
#![cfg(feature = "recording")]

use palpate_proto::recording::{DESCRIPTORS, descriptors};
use prost::Message as _;
use prost_types::field_descriptor_proto::Label;
use prost_types::{DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorSet};
use serde_json::{Map, Value, json};

fn all() -> FileDescriptorSet {
    FileDescriptorSet::decode(DESCRIPTORS).unwrap()
}

fn field(field: &FieldDescriptorProto) -> Value {
    // `TYPE_FIXED32` is told as `fixed32`, and a message or choice with its full name.
    let kind = field
        .r#type()
        .as_str_name()
        .trim_start_matches("TYPE_")
        .to_lowercase();
    let kind = [kind.as_str(), field.type_name()].join(" ");
    json!({
        "name": field.name(),
        "number": field.number(),
        "type": kind.trim_end(),
        "repeated": field.label() == Label::Repeated,
    })
}

fn choice(choice: &EnumDescriptorProto) -> (String, Value) {
    let values: Map<String, Value> = choice
        .value
        .iter()
        .map(|value| (value.name().to_owned(), value.number().into()))
        .collect();
    (choice.name().to_owned(), values.into())
}

fn message(message: &DescriptorProto) -> Value {
    assert!(
        message.nested_type.is_empty() && message.oneof_decl.is_empty(),
        "{}",
        message.name()
    );
    json!({
        "enums": message.enum_type.iter().map(choice).collect::<Map<_, _>>(),
        "fields": message.field.iter().map(field).collect::<Vec<_>>(),
    })
}

#[test]
fn our_foxglove_messages_are_the_published_ones() {
    let facts: Value = serde_json::from_str(include_str!("foxglove_published.json")).unwrap();
    let published = facts["messages"].as_object().unwrap();
    let mut seen = Vec::new();
    for file in all()
        .file
        .iter()
        .filter(|file| file.package() == "foxglove")
    {
        assert_eq!(file.syntax(), "proto3", "{}", file.name());
        assert!(
            file.enum_type.is_empty(),
            "{}: choices belong to their message",
            file.name()
        );
        for ours in &file.message_type {
            let name = format!("foxglove.{}", ours.name());
            assert_eq!(file.name(), format!("foxglove/{}.proto", ours.name()));
            assert_eq!(
                Some(&message(ours)),
                published.get(&name),
                "{name} differs from {}",
                facts["version"]
            );
            seen.push(name);
        }
    }
    seen.sort();
    assert_eq!(
        seen,
        published.keys().cloned().collect::<Vec<_>>(),
        "messages are missing or not published"
    );
}

/// What a reader of a recording needs and nothing else: it resolves every name from the set alone.
#[test]
fn the_descriptors_of_a_message_are_complete() {
    let mut messages = 0;
    for file in all()
        .file
        .iter()
        .filter(|file| !file.package().starts_with("google"))
    {
        for message in &file.message_type {
            let name = format!("{}.{}", file.package(), message.name());
            let set = FileDescriptorSet::decode(&descriptors(&name).unwrap()[..]).unwrap();
            let mut before: Vec<&str> = Vec::new();
            for member in &set.file {
                for import in &member.dependency {
                    assert!(
                        before.contains(&import.as_str()),
                        "{name}: {} lacks {import}",
                        member.name()
                    );
                }
                before.push(member.name());
            }
            // The last is the message's own file: nothing in the set is there without need.
            assert_eq!(before.last(), Some(&file.name()), "{name}");
            messages += 1;
        }
    }
    assert!(messages > 23, "only {messages} messages");
    assert_eq!(descriptors("foxglove.Grid"), None);
}

#[test]
fn our_own_schema_stays_free_of_the_published_ones() {
    let set = FileDescriptorSet::decode(&descriptors("palpate.v1.Tick").unwrap()[..]).unwrap();
    let names: Vec<&str> = set.file.iter().map(|file| file.name()).collect();
    assert_eq!(names, ["palpate/v1/recording.proto"]);
    assert!(
        set.file[0].source_code_info.is_some(),
        "comments tell what the packed numbers are"
    );
}
