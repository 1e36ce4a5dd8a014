//! Where in a scene file something stands.
//!
//! Text search is enough for a pointer: the values themselves came from a real parser.

use super::Problem;
use std::ops::Range;

/// A scene file's text and name.
pub(super) struct Place<'a> {
    pub text: &'a str,
    pub file: &'a str,
}

impl Place<'_> {
    pub fn problem(&self, at: Range<usize>, message: String) -> Problem {
        let before = &self.text[..at.start.min(self.text.len())];
        let line = before.matches('\n').count() + 1;
        let column = before.len() - before.rfind('\n').map_or(0, |k| k + 1) + 1;
        Problem {
            file: self.file.to_owned(),
            line,
            column,
            message,
        }
    }

    /// Where a key stands: in the `index`-th `[[table]]` (and its sub-tables), or in `[table]`; the
    /// table's header otherwise.
    pub fn find(&self, table: &str, index: usize, key: &str) -> Range<usize> {
        let mut header = 0..0;
        for Line { start, text, head } in self.lines_of(table, index) {
            match head {
                Some(head) if head == table => header = start..start + text.len(),
                Some(_) => {}
                None => {
                    if let Some(at) = word(text, key) {
                        return start + at..start + at + key.len();
                    }
                }
            }
        }
        header
    }

    /// Header of the `nth` part `[[table.part]]` of the `index`-th `[[table]]`; that of the table
    /// if it is written inline.
    pub fn find_part(&self, table: &str, index: usize, part: &str, nth: usize) -> Range<usize> {
        let name = format!("{table}.{part}");
        let mut parts = self
            .lines_of(table, index)
            .filter(|line| line.head == Some(name.as_str()));
        parts.nth(nth).map_or_else(
            || self.find(table, index, part),
            |line| line.start..line.start + line.text.len(),
        )
    }

    /// Lines of the `index`-th `[[table]]` and of its sub-tables.
    fn lines_of<'a>(&'a self, table: &'a str, index: usize) -> impl Iterator<Item = Line<'a>> {
        let (mut seen, mut inside, mut next) = (0usize, false, 0);
        self.text.split_inclusive('\n').filter_map(move |text| {
            let (start, head) = (next, head(text));
            next += text.len();
            if head == Some(table) {
                inside = seen == index;
                seen += 1;
            } else if let Some(head) = head {
                inside &= head
                    .strip_prefix(table)
                    .is_some_and(|rest| rest.starts_with('.'));
            }
            inside.then_some(Line { start, text, head })
        })
    }
}

/// A line, where it starts, and its table if it is a header.
struct Line<'a> {
    start: usize,
    text: &'a str,
    head: Option<&'a str>,
}

fn head(line: &str) -> Option<&str> {
    let line = line.trim();
    line.starts_with('[').then(|| {
        line.trim_start_matches('[')
            .split(']')
            .next()
            .unwrap_or("")
            .trim()
    })
}

fn word(line: &str, key: &str) -> Option<usize> {
    let code = line.split('#').next().unwrap_or("");
    let fits = |c: Option<char>| c.is_none_or(|c| !(c.is_alphanumeric() || c == '_' || c == '-'));
    code.match_indices(key).map(|(at, _)| at).find(|&at| {
        fits(code[..at].chars().next_back()) && fits(code[at + key.len()..].chars().next())
    })
}
