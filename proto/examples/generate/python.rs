//! `clients/python/palpate/messages.py` and `events.py`: dataclasses whose type hints say what the
//! bytes are.

use super::{COLUMNS, NOTICE, prose, snake, used, wrapped};
use palpate_proto::codec::MAX_BYTES;
use palpate_proto::layout::{Choice, Field, Flags, Item, MessageType, Shape, Struct};
use palpate_proto::messages::TABLE;

/// The messages.
pub fn messages() -> String {
    let mut body = String::new();
    let (mut all, mut names) = (Vec::new(), Vec::new());
    for item in TABLE {
        match item {
            Item::Message(message) => {
                body += &message_class(message);
                all.push(message.layout.name);
                names.push(message.layout.name);
            }
            Item::Struct(layout) => {
                body += &dataclass(layout, "", "");
                names.push(layout.name);
            }
            Item::Choice(choice) if choice.is_plain() => {
                body += &int_enum(choice);
                names.push(choice.name);
            }
            Item::Choice(_) => {}
            Item::Flags(flags) if flags.bare => {
                body += &constants(flags);
                names.extend(flags.flags.iter().map(|flag| flag.name));
            }
            Item::Flags(flags) => {
                body += &int_flag(flags);
                names.push(flags.name);
            }
        }
    }
    names.sort_by_key(|name| (name.chars().any(|c| c.is_ascii_lowercase()), *name));
    let listed: String = names
        .iter()
        .map(|name| format!("    \"{name}\",\n"))
        .collect();
    body += &format!(
        "\n\n#: All messages that have a name.\nALL = (\n{})\n\n__all__ = [\n{listed}]\n",
        all.iter()
            .map(|name| format!("    {name},\n"))
            .collect::<String>()
    );
    let base = used(
        &body,
        &[
            "U8",
            "U16",
            "U32",
            "U64",
            "Hash",
            "Message",
            "Quaternion",
            "Vector",
        ],
    );
    let events = used(&body, &choices());
    format!(
        "\"\"\"The messages of the bus as frozen dataclasses. SI units; quaternions are x y z w; world frame; \
         times are\nnanoseconds.\n\n``docs/wire.md`` of the project lists which key carries which message.\n\n\
         {NOTICE}\n\"\"\"\n\nimport enum\nfrom dataclasses import dataclass\nfrom typing import Optional\n\n\
         from .base import {}\nfrom .events import {}\n{body}",
        base.join(", "),
        events.join(", ")
    )
}

/// The choices with fields: a dataclass for each case, and their union.
pub fn events() -> String {
    let (mut body, mut names) = (String::new(), Vec::new());
    for item in TABLE {
        let Item::Choice(choice) = item else { continue };
        if choice.is_plain() {
            continue;
        }
        for case in choice.cases {
            body += &dataclass(
                &Struct {
                    name: case.name,
                    doc: case.doc,
                    fields: case.fields,
                },
                "",
                "",
            );
            names.push(case.name);
        }
        let doc = format!(
            "{} May grow at its end: skip an event that raises :class:`palpate.UnknownCase`.",
            text(choice.doc)
        );
        body += "\n\n";
        for line in wrapped(&doc, COLUMNS - 3) {
            body += &format!("#: {line}\n");
        }
        let cases: String = choice
            .cases
            .iter()
            .map(|case| format!("    {},\n", case.name))
            .collect();
        body += &format!("{} = Union[\n{cases}]\n", choice.name);
        names.push(choice.name);
    }
    names.sort_unstable();
    let listed: String = names
        .iter()
        .map(|name| format!("    \"{name}\",\n"))
        .collect();
    format!(
        "\"\"\"What happened: the kinds of a :class:`palpate.SimEvent`.\n\n{NOTICE}\n\"\"\"\n\nfrom dataclasses import dataclass\n\
         from typing import Union\n\nfrom .base import {}\n{body}\n__all__ = [\n{listed}]\n",
        used(
            &body,
            &["U8", "U16", "U32", "U64", "Hash", "Quaternion", "Vector"]
        )
        .join(", ")
    )
}

fn choices() -> Vec<&'static str> {
    let choices = TABLE.iter().filter_map(|item| match item {
        Item::Choice(choice) if !choice.is_plain() => Some(choice.name),
        _ => None,
    });
    choices.collect()
}

fn text(doc: &[&str]) -> String {
    prose(
        doc,
        |code| format!("``{code}``"),
        |link| format!(":class:`{link}`"),
    )
}

fn docstring(doc: &[&str], indent: &str) -> String {
    let text = text(doc);
    if indent.len() + text.chars().count() + 6 <= COLUMNS {
        return format!("{indent}\"\"\"{text}\"\"\"\n");
    }
    // The quotes take three columns of the first line; the others end where they do.
    let lines = wrapped(&text, COLUMNS - indent.len() - 3).join(&format!("\n{indent}"));
    format!("{indent}\"\"\"{lines}\n{indent}\"\"\"\n")
}

fn message_class(message: &MessageType) -> String {
    let mut constants = format!("    NAME = \"{}\"\n", message.name);
    constants += &format!("    KEY = \"palpate/{{instance}}/{}\"\n", message.key);
    if message.max_bytes != MAX_BYTES {
        constants += &format!("    MAX_BYTES = {}\n", message.max_bytes);
    }
    dataclass(message.layout, "(Message)", &constants)
}

fn dataclass(layout: &Struct, bases: &str, constants: &str) -> String {
    let mut out = format!(
        "\n\n@dataclass(frozen=True)\nclass {}{bases}:\n",
        layout.name
    );
    out += &docstring(layout.doc, "    ");
    if !constants.is_empty() {
        out += &format!("\n{constants}");
    }
    if !layout.fields.is_empty() {
        out.push('\n');
    }
    for field in layout.fields {
        out += &format!(
            "    {}: {}{}\n",
            field.name,
            hint(&field.shape),
            default(field)
        );
        out += &docstring(field.doc, "    ");
    }
    out
}

fn hint(shape: &Shape) -> String {
    match shape {
        Shape::U8 => "U8".into(),
        Shape::U16 => "U16".into(),
        Shape::U32 => "U32".into(),
        Shape::U64 => "U64".into(),
        Shape::F64 => "float".into(),
        Shape::Bool => "bool".into(),
        Shape::Text => "str".into(),
        Shape::Array(Shape::F64, 3) => "Vector".into(),
        Shape::Array(Shape::F64, 4) => "Quaternion".into(),
        Shape::Array(Shape::U8, 32) => "Hash".into(),
        Shape::Array(item, count) => format!("tuple[{}]", vec![hint(item); *count].join(", ")),
        Shape::List(item) => format!("tuple[{}, ...]", hint(item)),
        Shape::Optional(item) => format!("Optional[{}]", hint(item)),
        Shape::Struct(layout) => layout.name.into(),
        Shape::Choice(choice) => choice.name.into(),
    }
}

fn default(field: &Field) -> String {
    fn zero(shape: &Shape) -> String {
        match shape {
            Shape::F64 => "0.0".into(),
            Shape::Array(item, count) => format!("({})", vec![zero(item); *count].join(", ")),
            Shape::Optional(_) => "None".into(),
            Shape::Text => "\"\"".into(),
            Shape::Bool => "False".into(),
            Shape::List(_) => "()".into(),
            _ => "0".into(),
        }
    }
    if field.optional {
        format!(" = {}", zero(&field.shape))
    } else {
        String::new()
    }
}

fn int_enum(choice: &Choice) -> String {
    let mut out = format!("\n\nclass {}(enum.IntEnum):\n", choice.name);
    out += &docstring(choice.doc, "    ");
    out.push('\n');
    for (number, case) in choice.cases.iter().enumerate() {
        out += &format!("    {} = {number}\n", snake(case.name).to_uppercase());
        out += &docstring(case.doc, "    ");
    }
    out
}

fn int_flag(flags: &Flags) -> String {
    let mut out = format!("\n\nclass {}(enum.IntFlag):\n", flags.name);
    out += &docstring(flags.doc, "    ");
    out.push('\n');
    for flag in flags.flags {
        out += &format!("    {} = {}\n", flag.name, 1u32 << flag.bit);
        out += &docstring(flag.doc, "    ");
    }
    out
}

fn constants(flags: &Flags) -> String {
    let constants = flags.flags.iter().map(|flag| {
        format!(
            "\n\n#: {}\n{} = {}\n",
            text(flag.doc),
            flag.name,
            1u32 << flag.bit
        )
    });
    constants.collect()
}
