//! `clients/c/palpate.h`: C99, without allocation; texts and lists point into the bytes decoded.

use super::{NOTICE, prose, snake, wrapped};
use palpate_proto::layout::{Choice, Field, Flags, Item, MessageType, Shape, Struct};
use palpate_proto::messages::TABLE;

/// What does not depend on the messages.
const RUNTIME: &str = include_str!("runtime.h");

/// Columns of the comments.
const COLUMNS: usize = 100;

/// The header.
pub fn header() -> String {
    let about = "Bus messages of Palpate for C99 and C++: plain structs, their bytes, and the keys they travel on. \
                 Nothing is allocated. SI units; quaternions are x y z w; world frame; times are nanoseconds. \
                 docs/wire.md of the project says what each message is for.";
    let use_it = "For each message: NAME_decode fills a struct from bytes, whose texts and lists point into them; \
                  NAME_encode writes bytes; NAME_key writes the key expression. All but keys give a palpate_fault.";
    let mut out = String::from("/*\n");
    for text in [about, use_it, NOTICE] {
        out += &lines(text, " * ");
        out += " *\n";
    }
    out.truncate(out.len() - " *\n".len());
    out += &format!(" */\n{RUNTIME}");
    for item in TABLE {
        out += &match item {
            Item::Message(message) => of_message(message),
            Item::Struct(layout) => structure(layout),
            Item::Choice(choice) => of_choice(choice),
            Item::Flags(flags) => of_flags(flags),
        };
    }
    out + "\n#endif\n"
}

fn lines(text: &str, indent: &str) -> String {
    let lines = wrapped(text, COLUMNS - indent.len());
    lines
        .iter()
        .map(|line| format!("{indent}{line}\n"))
        .collect()
}

fn comment(doc: &[&str], indent: &str) -> String {
    let text = prose(doc, str::to_owned, str::to_owned);
    if indent.len() + text.chars().count() + 6 <= COLUMNS {
        return format!("{indent}/* {text} */\n");
    }
    format!(
        "{indent}/*\n{}{indent} */\n",
        lines(&text, &format!("{indent} * "))
    )
}

fn of_flags(flags: &Flags) -> String {
    let mut out = format!("\n{}", comment(flags.doc, ""));
    for flag in flags.flags {
        let group = if flags.bare {
            String::new()
        } else {
            snake(flags.name).to_uppercase() + "_"
        };
        out += &comment(flag.doc, "");
        out += &format!(
            "#define PALPATE_{group}{} {}u\n",
            flag.name,
            1u32 << flag.bit
        );
    }
    out
}

fn of_message(message: &MessageType) -> String {
    let name = snake(message.layout.name);
    let upper = name.to_uppercase();
    // palpate/{instance}/tool/{tool}/pose
    let (mut parameters, mut parts) = (String::from("const char *instance"), String::new());
    let mut rest = format!("/{}", message.key);
    parts += "\"palpate/\", instance";
    while let Some((before, (id, after))) = rest
        .split_once('{')
        .and_then(|(before, after)| Some((before, after.split_once('}')?)))
    {
        parameters += &format!(", const char *{id}");
        parts += &format!(", \"{before}\", {id}");
        rest = after.to_owned();
    }
    parts += &format!(", \"{rest}\"");
    format!(
        "{struct_}
/* Schema of the encoding application/octet-stream that goes with it. */
#define PALPATE_{upper}_SCHEMA \"postcard;{wire}\"
/* Greatest size, bytes. */
#define PALPATE_{upper}_MAX_BYTES {most}

/* Reads a message of `size` bytes. What is in `out` after a fault is unspecified. */
static inline int palpate_{name}_decode(palpate_{name} *out, const uint8_t *bytes, size_t size) {{
  palpate_reader reader;
  if (size > PALPATE_{upper}_MAX_BYTES) return PALPATE_OVERSIZED;
  reader.next = bytes;
  reader.end = size > 0 ? bytes + size : bytes;
  reader.fault = PALPATE_OK;
  palpate_{name}_read(&reader, out);
  return palpate_read_end(&reader);
}}

/* Writes a message into `room` bytes; `size` is how many it takes. */
static inline int palpate_{name}_encode(const palpate_{name} *in, uint8_t *bytes, size_t room, size_t *size) {{
  palpate_writer writer;
  writer.next = bytes;
  writer.end = room > 0 ? bytes + room : bytes;
  writer.fault = PALPATE_OK;
  palpate_{name}_write(&writer, in);
  *size = writer.next == bytes ? 0 : (size_t)(writer.next - bytes);
  if (writer.fault == PALPATE_OK && *size > PALPATE_{upper}_MAX_BYTES) return PALPATE_OVERSIZED;
  return writer.fault;
}}

/* Key of the message; see palpate_join. An id may be \"*\" to subscribe to all. */
static inline size_t palpate_{name}_key(char *out, size_t room, {parameters}) {{
  const char *const parts[] = {{{parts}}};
  return palpate_join(out, room, parts, sizeof parts / sizeof parts[0]);
}}
",
        struct_ = structure(message.layout),
        wire = message.name,
        most = message.max_bytes,
    )
}

fn structure(layout: &Struct) -> String {
    let name = snake(layout.name);
    let read: String = layout
        .fields
        .iter()
        .map(|field| read(&field.shape, &format!("out->{}", field.name), "  ", 0))
        .collect();
    let write: String = layout
        .fields
        .iter()
        .map(|field| write(&field.shape, &format!("in->{}", field.name), "  ", 0))
        .collect();
    format!(
        "\n{}typedef struct palpate_{name} {{\n{}}} palpate_{name};\n\n\
         static inline void palpate_{name}_read(palpate_reader *reader, palpate_{name} *out) {{\n{read}}}\n\n\
         static inline void palpate_{name}_write(palpate_writer *writer, const palpate_{name} *in) {{\n{write}}}\n",
        comment(layout.doc, ""),
        members(layout.fields, "  ")
    )
}

fn members(fields: &[Field], indent: &str) -> String {
    let members = fields.iter().map(|field| {
        let comment = comment(field.doc, indent);
        match &field.shape {
            Shape::Optional(item) => format!(
                "{comment}{indent}bool has_{0};\n{indent}{1};\n",
                field.name,
                declared(item, field.name)
            ),
            shape => format!("{comment}{indent}{};\n", declared(shape, field.name)),
        }
    });
    members.collect()
}

/// A member of a struct: its type and name.
fn declared(shape: &Shape, name: &str) -> String {
    match shape {
        Shape::U8 => format!("uint8_t {name}"),
        Shape::U16 => format!("uint16_t {name}"),
        Shape::U32 => format!("uint32_t {name}"),
        Shape::U64 => format!("uint64_t {name}"),
        Shape::F64 => format!("double {name}"),
        Shape::Bool => format!("bool {name}"),
        Shape::Text => format!("palpate_text {name}"),
        Shape::Array(item, count) => declared(item, &format!("{name}[{count}]")),
        Shape::List(_) => format!("palpate_list {name}"),
        Shape::Optional(_) => unreachable!("optional values are fields of their own"),
        Shape::Struct(layout) => format!("palpate_{} {name}", snake(layout.name)),
        Shape::Choice(choice) => format!("palpate_{} {name}", snake(choice.name)),
    }
}

/// Fewest bytes that a value has.
fn least_bytes(shape: &Shape) -> usize {
    match shape {
        Shape::F64 => 8,
        Shape::Array(item, count) => least_bytes(item) * count,
        Shape::Struct(layout) => layout
            .fields
            .iter()
            .map(|field| least_bytes(&field.shape))
            .sum(),
        _ => 1,
    }
}

/// Bytes of a value, when all values have as many.
fn fixed_bytes(shape: &Shape) -> Option<usize> {
    match shape {
        Shape::F64 => Some(8),
        Shape::U8 => Some(1),
        Shape::Array(item, count) => Some(fixed_bytes(item)? * count),
        _ => None,
    }
}

fn read(shape: &Shape, to: &str, indent: &str, depth: usize) -> String {
    let number = |call: String| format!("{indent}{to} = {call};\n");
    match shape {
        Shape::U8 => number("palpate_read_u8(reader)".into()),
        Shape::U16 => number("(uint16_t)palpate_read_varint(reader, 16)".into()),
        Shape::U32 => number("(uint32_t)palpate_read_varint(reader, 32)".into()),
        Shape::U64 => number("palpate_read_varint(reader, 64)".into()),
        Shape::F64 => number("palpate_read_f64(reader)".into()),
        Shape::Bool => number("palpate_read_bool(reader)".into()),
        Shape::Text => number("palpate_read_text(reader)".into()),
        Shape::Array(item, count) => {
            let k = format!("k{depth}");
            let inside = read(
                item,
                &format!("{to}[{k}]"),
                &format!("{indent}  "),
                depth + 1,
            );
            format!("{indent}for (size_t {k} = 0; {k} < {count}; {k}++) {{\n{inside}{indent}}}\n")
        }
        Shape::List(item) => {
            let start = format!(
                "{indent}{to}.count = palpate_read_count(reader, {});\n{indent}{to}.bytes = reader->next;\n",
                least_bytes(item)
            );
            let skip = match fixed_bytes(item) {
                Some(bytes) => format!(
                    "{indent}if ({to}.count > 0) reader->next += (size_t){to}.count * {bytes};\n"
                ),
                None => {
                    let k = format!("k{depth}");
                    let inside = read(
                        item,
                        &format!("item{depth}"),
                        &format!("{indent}  "),
                        depth + 1,
                    );
                    format!(
                        "{indent}for (uint64_t {k} = 0; {k} < {to}.count && reader->fault == PALPATE_OK; {k}++) {{\n\
                         {indent}  {};\n{inside}{indent}}}\n",
                        declared(item, &format!("item{depth}"))
                    )
                }
            };
            format!(
                "{start}{skip}{indent}{to}.size = {to}.count > 0 ? (size_t)(reader->next - {to}.bytes) : 0;\n"
            )
        }
        Shape::Optional(item) => {
            let inside = read(item, to, &format!("{indent}  "), depth);
            let has = has(to);
            format!(
                "{indent}{has} = palpate_read_bool(reader);\n{indent}if ({has}) {{\n{inside}{indent}}}\n"
            )
        }
        Shape::Struct(layout) => {
            format!(
                "{indent}palpate_{}_read(reader, &{to});\n",
                snake(layout.name)
            )
        }
        Shape::Choice(choice) => {
            format!(
                "{indent}palpate_{}_read(reader, &{to});\n",
                snake(choice.name)
            )
        }
    }
}

fn write(shape: &Shape, from: &str, indent: &str, depth: usize) -> String {
    let call = |call: String| format!("{indent}{call};\n");
    match shape {
        Shape::U8 => call(format!("palpate_write_u8(writer, {from})")),
        Shape::U16 | Shape::U32 | Shape::U64 => {
            call(format!("palpate_write_varint(writer, {from})"))
        }
        Shape::F64 => call(format!("palpate_write_f64(writer, {from})")),
        Shape::Bool => call(format!("palpate_write_u8(writer, {from} ? 1 : 0)")),
        Shape::Text => call(format!("palpate_write_text(writer, {from})")),
        Shape::Array(item, count) => {
            let k = format!("k{depth}");
            let inside = write(
                item,
                &format!("{from}[{k}]"),
                &format!("{indent}  "),
                depth + 1,
            );
            format!("{indent}for (size_t {k} = 0; {k} < {count}; {k}++) {{\n{inside}{indent}}}\n")
        }
        Shape::List(_) => call(format!("palpate_write_list(writer, {from})")),
        Shape::Optional(item) => {
            let inside = write(item, from, &format!("{indent}  "), depth);
            let has = has(from);
            format!(
                "{indent}palpate_write_u8(writer, {has} ? 1 : 0);\n{indent}if ({has}) {{\n{inside}{indent}}}\n"
            )
        }
        Shape::Struct(layout) => call(format!(
            "palpate_{}_write(writer, &{from})",
            snake(layout.name)
        )),
        Shape::Choice(choice) => call(format!(
            "palpate_{}_write(writer, &{from})",
            snake(choice.name)
        )),
    }
}

/// `out->weights` as `out->has_weights`.
fn has(member: &str) -> String {
    let at = member.rfind(['.', '>']).map_or(0, |at| at + 1);
    format!("{}has_{}", &member[..at], &member[at..])
}

fn of_choice(choice: &Choice) -> String {
    let (name, count) = (snake(choice.name), choice.cases.len());
    let upper = name.to_uppercase();
    let mut out = format!("\n{}enum {{\n", comment(choice.doc, ""));
    for (number, case) in choice.cases.iter().enumerate() {
        let comma = if number + 1 < count { "," } else { "" };
        let case_name = snake(case.name).to_uppercase();
        out += &comment(case.doc, "  ");
        out += &format!("  PALPATE_{upper}_{case_name} = {number}{comma}\n");
    }
    out += "};\n\n";
    if choice.is_plain() {
        out += &format!("typedef uint32_t palpate_{name};\n\n");
        out += &format!(
            "static inline void palpate_{name}_read(palpate_reader *reader, palpate_{name} *out) {{\n  \
             *out = palpate_read_case(reader, {count});\n}}\n\n\
             static inline void palpate_{name}_write(palpate_writer *writer, const palpate_{name} *in) {{\n  \
             palpate_write_varint(writer, *in);\n}}\n"
        );
        return out;
    }
    out += &format!(
        "typedef struct palpate_{name} {{\n  /* Number of the case; `as` has the fields of that one. */\n  \
         uint32_t number;\n  union {{\n"
    );
    let (mut reads, mut writes) = (String::new(), String::new());
    for case in choice.cases.iter().filter(|case| !case.fields.is_empty()) {
        let member = snake(case.name);
        out += &format!(
            "    struct {{\n{}    }} {member};\n",
            members(case.fields, "      ")
        );
        let label = format!("    case PALPATE_{upper}_{}:\n", member.to_uppercase());
        (reads, writes) = (reads + &label, writes + &label);
        for field in case.fields {
            let place = format!("as.{member}.{}", field.name);
            reads += &read(&field.shape, &format!("out->{place}"), "      ", 0);
            writes += &write(&field.shape, &format!("in->{place}"), "      ", 0);
        }
        reads += "      break;\n";
        writes += "      break;\n";
    }
    let end = "    default:\n      break;\n  }\n}\n";
    out += &format!(
        "  }} as;\n}} palpate_{name};\n\n\
         static inline void palpate_{name}_read(palpate_reader *reader, palpate_{name} *out) {{\n  \
         out->number = palpate_read_case(reader, {count});\n  switch (out->number) {{\n{reads}{end}\n\
         static inline void palpate_{name}_write(palpate_writer *writer, const palpate_{name} *in) {{\n  \
         palpate_write_varint(writer, in->number);\n  switch (in->number) {{\n{writes}{end}"
    );
    out
}
