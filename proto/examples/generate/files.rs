//! The generated files, and what their generators share.

mod c;
mod protobuf;
mod python;
mod typescript;

/// Path from the root of the repository, and contents, of every generated file.
pub fn all() -> Vec<(&'static str, Vec<u8>)> {
    let clients = [
        ("clients/python/palpate/messages.py", python::messages()),
        ("clients/python/palpate/events.py", python::events()),
        ("clients/web/src/messages.ts", typescript::messages()),
        ("clients/web/src/events.ts", typescript::events()),
        ("clients/c/palpate.h", c::header()),
    ];
    let recordings = [
        "proto/src/generated/recording.rs",
        "proto/src/generated/foxglove.rs",
        "proto/src/generated/descriptors.bin",
    ];
    let clients = clients.map(|(path, text)| (path, text.into_bytes()));
    let recordings = recordings.into_iter().zip(protobuf::files());
    clients.into_iter().chain(recordings).collect()
}

/// What every generated file says of itself.
const NOTICE: &str = "Generated from proto/src/messages.rs by \
                      `cargo run -p palpate-proto --example generate`; do not edit.";

/// Longest line of Python and TypeScript, columns.
const COLUMNS: usize = 120;

/// Documentation as one paragraph; `code` and `link` write what is in backquotes and what links
/// to another item.
fn prose(doc: &[&str], code: impl Fn(&str) -> String, link: impl Fn(&str) -> String) -> String {
    let text = doc.iter().map(|line| line.trim()).collect::<Vec<_>>();
    let (text, mut out) = (text.join(" "), String::new());
    let mut rest = text.as_str();
    while let Some(at) = rest.find('`') {
        let Some(length) = rest[at + 1..].find('`') else {
            break;
        };
        let (before, name) = (&rest[..at], &rest[at + 1..at + 1 + length]);
        rest = &rest[at + length + 2..];
        match (before.strip_suffix('['), rest.strip_prefix(']')) {
            (Some(before), Some(after)) => {
                out += before;
                out += &link(name);
                // The target of a link stays in Rust.
                rest = match after
                    .strip_prefix('(')
                    .and_then(|target| target.split_once(')'))
                {
                    Some((_, after)) => after,
                    None => after,
                };
            }
            _ => {
                out += before;
                out += &code(name);
            }
        }
    }
    out + rest
}

/// Words in lines of at most `width` columns.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// `ToolPose` as `tool_pose`.
pub fn snake(name: &str) -> String {
    let mut out = String::new();
    for (k, letter) in name.chars().enumerate() {
        if letter.is_ascii_uppercase() && k > 0 {
            out.push('_');
        }
        out.push(letter.to_ascii_lowercase());
    }
    out
}

/// Those of `names` that `text` has as a word of its own.
fn used<'n>(text: &str, names: &[&'n str]) -> Vec<&'n str> {
    let words: Vec<&str> = text
        .split(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_')
        .collect();
    let wanted = names.iter().filter(|name| words.contains(name));
    wanted.copied().collect()
}
