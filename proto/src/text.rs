//! Words of others on a terminal, in a log or on a page: they may hold characters that move the
//! cursor, clear the screen or show a name in another order than it has.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::ops::Range;

/// Control characters, and those that are not seen but reorder, hide or break what is around them.
pub fn is_unprintable(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{ad}'
                | '\u{61c}'
                | '\u{180e}'
                | '\u{200b}'
                | '\u{200e}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}'
                | '\u{feff}'
                | '\u{fff9}'..='\u{fffb}'
                | '\u{e0000}'..='\u{e007f}'
        )
}

/// The text with escapes (`\u{1b}`) in place of characters that [`is_unprintable`] names; lines and
/// tabs stay.
///
/// ```
/// use palpate_proto::text::printable;
/// assert_eq!(printable("tool é\n"), "tool é\n");
/// assert_eq!(printable("\u{1b}[2J"), "\\u{1b}[2J");
/// ```
pub fn printable(text: &str) -> Cow<'_, str> {
    let stays = |c: char| matches!(c, '\n' | '\t') || !is_unprintable(c);
    if text.chars().all(stays) {
        return text.into();
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match stays(c) {
            true => out.push(c),
            false => drop(write!(out, "{}", c.escape_unicode())),
        }
    }
    out.into()
}

/// What a reader says about a text, with the line and column of the place. What stands there is not
/// repeated: the file may hold a key, or be another than was meant, and the message may go far.
///
/// ```
/// use palpate_proto::text::located;
/// assert_eq!(located("a\nb = ", Some(2..3), "no value"), "line 2, column 1: no value");
/// ```
pub fn located(text: &str, span: Option<Range<usize>>, message: &str) -> String {
    let start = span.map_or(0, |span| span.start.min(text.len()));
    let before = &text.as_bytes()[..start];
    let line_start = before
        .iter()
        .rposition(|byte| *byte == b'\n')
        .map_or(0, |at| at + 1);
    let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
    let message = without_value(message);
    format!("line {line}, column {}: {message}", 1 + start - line_start)
}

/// What a reader says, without what it met: of `invalid type: string "x", expected f64`, the end.
pub fn without_value(message: &str) -> Cow<'_, str> {
    match message.split_once(", expected ") {
        Some((_, wanted)) => format!("expected {wanted}").into(),
        None => message.into(),
    }
}
