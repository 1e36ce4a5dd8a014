//! `clients/web/src/messages.ts` and `events.ts`: tables that `decode` and `encode` take, and the
//! types of their values.

use super::{COLUMNS, NOTICE, prose, used, wrapped};
use palpate_proto::codec::MAX_BYTES;
use palpate_proto::layout::{Choice, Field, Flags, Item, Shape, Struct};
use palpate_proto::messages::{ALL, TABLE};

const CODEC: [&str; 16] = [
    "array", "bool", "cases", "choice", "f64", "list", "numbers", "octets", "optional", "points",
    "struct", "text", "u16", "u32", "u64", "u8",
];

/// The messages.
pub fn messages() -> String {
    let mut body = String::new();
    for item in TABLE {
        match item {
            Item::Message(message) => {
                let most = if message.max_bytes == MAX_BYTES {
                    String::new()
                } else {
                    format!(", {}", message.max_bytes)
                };
                let name = message.layout.name;
                body += &format!(
                    "\n{}export const {name} = message(\"{}\", \"{}\", {{\n{}}}{most});\n\
                     export type {name} = Of<typeof {name}>;\n",
                    comment(message.layout.doc, ""),
                    message.name,
                    message.key,
                    fields(message.layout.fields, "  ")
                );
            }
            Item::Struct(layout) => body += &structure(layout),
            Item::Choice(choice) if choice.is_plain() => body += &plain(choice),
            Item::Choice(_) => {}
            Item::Flags(flags) => body += &bits(flags),
        }
    }
    let all: String = ALL
        .iter()
        .map(|message| format!("  {},\n", message.layout.name))
        .collect();
    body += &format!(
        "\n/** All messages that have a name, for `decodeNamed`. */\nexport const MESSAGES = [\n{all}] as const;\n"
    );
    let choices: Vec<&str> = TABLE
        .iter()
        .filter_map(|item| match item {
            Item::Choice(choice) if !choice.is_plain() => Some(choice.name),
            _ => None,
        })
        .collect();
    let note = "The messages of the bus. SI units; quaternions are x y z w; world frame; times are nanoseconds. \
                `u64` is a bigint; lists of numbers and of points are flat `Float64Array`s. `docs/wire.md` of the \
                project lists what each key carries.";
    let each = "Each name is a value, the table that `decode` and `encode` take, and a type, that of the message.";
    format!(
        "{}\n{}import {{ {} }} from \"./events\";\nimport {{ message, type Of }} from \"./wire\";\n\n\
         /** x y z. */\nconst vector = array(f64, 3);\n/** x y z w. */\nconst quaternion = array(f64, 4);\n{body}",
        header(&[note, each, NOTICE]),
        imports(&format!("{body} array f64")),
        used(&body, &choices).join(", ")
    )
}

/// The choices with fields.
pub fn events() -> String {
    let mut body = String::new();
    for item in TABLE {
        let Item::Choice(choice) = item else { continue };
        if choice.is_plain() {
            continue;
        }
        let mut doc = choice.doc.to_vec();
        doc.push("May grow at its end: skip an event whose decoding fails with `unknown-case`.");
        body += &format!(
            "\n{}export const {} = cases({{\n",
            comment(&doc, ""),
            choice.name
        );
        for case in choice.cases {
            let inside = fields(case.fields, "    ");
            let inside = if inside.is_empty() {
                inside
            } else {
                format!("\n{inside}  ")
            };
            body += &format!(
                "{}  {}: struct({{{inside}}}),\n",
                comment(case.doc, "  "),
                case.name
            );
        }
        body += &format!("}});\nexport type {0} = Value<typeof {0}>;\n", choice.name);
    }
    format!(
        "{}\n{}{body}",
        header(&["What happened: the kinds of a `SimEvent`.", NOTICE]),
        imports(&body)
    )
}

fn header(paragraphs: &[&str]) -> String {
    let paragraphs: Vec<String> = paragraphs
        .iter()
        .map(|text| {
            wrapped(text, COLUMNS - 3)
                .iter()
                .map(|line| format!(" * {line}\n"))
                .collect::<String>()
        })
        .collect();
    format!("/**\n{} */\n", paragraphs.join(" *\n"))
}

fn imports(body: &str) -> String {
    let mut names = used(body, &CODEC).join(", ");
    if body.contains("Value<") {
        names += ", type Value";
    }
    let line = format!("import {{ {names} }} from \"./codec\";\n");
    if line.len() <= COLUMNS {
        return line;
    }
    let lines = wrapped(&(names + ","), COLUMNS - 2);
    let lines: String = lines.iter().map(|line| format!("  {line}\n")).collect();
    format!("import {{\n{lines}}} from \"./codec\";\n")
}

fn comment(doc: &[&str], indent: &str) -> String {
    let text = prose(
        doc,
        |code| format!("`{code}`"),
        |link| format!("{{@link {link}}}"),
    );
    if indent.len() + text.chars().count() + 7 <= COLUMNS {
        return format!("{indent}/** {text} */\n");
    }
    let lines: String = wrapped(&text, COLUMNS - indent.len() - 3)
        .iter()
        .map(|line| format!("{indent} * {line}\n"))
        .collect();
    format!("{indent}/**\n{lines}{indent} */\n")
}

fn fields(fields: &[Field], indent: &str) -> String {
    let lines = fields.iter().map(|field| {
        let comment = comment(field.doc, indent);
        format!("{comment}{indent}{}: {},\n", field.name, wire(&field.shape))
    });
    lines.collect()
}

fn wire(shape: &Shape) -> String {
    match shape {
        Shape::U8 => "u8".into(),
        Shape::U16 => "u16".into(),
        Shape::U32 => "u32".into(),
        Shape::U64 => "u64".into(),
        Shape::F64 => "f64".into(),
        Shape::Bool => "bool".into(),
        Shape::Text => "text".into(),
        Shape::Array(Shape::F64, 3) => "vector".into(),
        Shape::Array(Shape::F64, 4) => "quaternion".into(),
        Shape::Array(Shape::U8, 32) => "octets(32)".into(),
        Shape::Array(item, count) => format!("array({}, {count})", wire(item)),
        Shape::List(Shape::F64) => "numbers".into(),
        Shape::List(Shape::Array(Shape::F64, 3)) => "points".into(),
        Shape::List(item) => format!("list({})", wire(item)),
        Shape::Optional(item) => format!("optional({})", wire(item)),
        Shape::Struct(layout) => layout.name.into(),
        Shape::Choice(choice) => choice.name.into(),
    }
}

fn structure(layout: &Struct) -> String {
    format!(
        "\n{}export const {1} = struct({{\n{2}}});\nexport type {1} = Value<typeof {1}>;\n",
        comment(layout.doc, ""),
        layout.name,
        fields(layout.fields, "  ")
    )
}

fn plain(choice: &Choice) -> String {
    let cases: String = choice
        .cases
        .iter()
        .map(|case| format!("{}  \"{}\",\n", comment(case.doc, "  "), case.name))
        .collect();
    format!(
        "\n{}export const {1} = choice(\n{cases});\nexport type {1} = Value<typeof {1}>;\n",
        comment(choice.doc, ""),
        choice.name
    )
}

fn bits(flags: &Flags) -> String {
    if flags.bare {
        let constants = flags.flags.iter().map(|flag| {
            let comment = comment(flag.doc, "");
            format!(
                "\n{comment}export const {} = {};\n",
                flag.name,
                1u32 << flag.bit
            )
        });
        return constants.collect();
    }
    let lines: String = flags
        .flags
        .iter()
        .map(|flag| {
            format!(
                "{}  {}: {},\n",
                comment(flag.doc, "  "),
                flag.name,
                1u32 << flag.bit
            )
        })
        .collect();
    format!(
        "\n{}export const {} = {{\n{lines}}} as const;\n",
        comment(flags.doc, ""),
        flags.name
    )
}
