//! The sections of an IGES file: lines by their letter in column 73, parameters by the delimiters
//! of the global section.

use super::error::IgesError;
use crate::exchange::LengthUnit;
use crate::exchange::number::parse;

/// A subfigure at its place.
pub(super) const INSTANCE: u64 = 408;

/// Columns of data in a line of parameters; the rest names its directory entry.
const PARAMETER_COLUMNS: usize = 64;

/// A file, indexed. Lines are slices of its bytes.
#[derive(Debug)]
pub(super) struct File<'a> {
    global: Vec<Token<'a>>,
    /// Two lines an entity.
    directory: Vec<[&'a [u8]; 2]>,
    parameters: Vec<&'a [u8]>,
    delimiters: [u8; 2],
}

/// A parameter: its bytes, trimmed.
type Token<'a> = std::borrow::Cow<'a, [u8]>;

/// What a directory entry says that matters here.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Number of its first line, as the D column has it.
    pub id: u64,
    pub kind: u64,
    first: u64,
    lines: u64,
    /// Directory entry of its matrix, 0 if it has none.
    pub matrix: u64,
    /// It is there only as a part of another entity.
    pub dependent: bool,
}

impl<'a> File<'a> {
    /// Sorts the lines into sections.
    pub fn index(bytes: &'a [u8]) -> Result<Self, IgesError> {
        let mut global_text = Vec::new();
        let mut entries: Vec<&[u8]> = Vec::new();
        let mut parameters: Vec<&[u8]> = Vec::new();
        let mut terminate = None;
        let mut section = b'S';
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        for (k, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
            let line = line.strip_suffix(b"\r").unwrap_or(line);
            if line.iter().all(u8::is_ascii_whitespace) {
                continue;
            }
            let letter = line.get(72).copied().unwrap_or(b' ');
            if k == 0 && letter != b'S' {
                return Err(IgesError::NotIges(match letter {
                    b'C' => "it is in the compressed form",
                    b'B' => "it is in the binary form",
                    _ => "its first line has no S in column 73",
                }));
            }
            // Sections in their order, each after those before it.
            let place = |letter: u8| b"SGDPT".iter().position(|&known| known == letter);
            if place(letter).is_none_or(|at| Some(at) < place(section)) {
                let (line_number, found) = (k + 1, shortened(line));
                let wanted = "a letter of S, G, D, P, T in column 73, in that order";
                return Err(IgesError::Line {
                    line: line_number,
                    wanted,
                    found,
                });
            }
            section = letter;
            match letter {
                b'G' => global_text.extend_from_slice(&line[..72]),
                b'D' => entries.push(line),
                b'P' => parameters.push(&line[..PARAMETER_COLUMNS]),
                b'T' => {
                    terminate = Some(line);
                    break;
                }
                _ => {}
            }
        }
        let Some(terminate) = terminate else {
            return Err(IgesError::Unfinished(
                "it has no terminate section (a line with T in column 73)",
            ));
        };
        let told = |letter: u8, from: usize| terminate.get(from) == Some(&letter);
        let number = |from: usize| terminate.get(from + 1..from + 8).and_then(whole);
        let agree = told(b'D', 16)
            && told(b'P', 24)
            && number(16) == Some(entries.len() as u64)
            && number(24) == Some(parameters.len() as u64);
        if !agree {
            return Err(IgesError::Unfinished(
                "sections D and P have not as many lines as the terminate section says",
            ));
        }
        if entries.len() % 2 == 1 {
            return Err(IgesError::Unfinished(
                "a directory entry has one line instead of two",
            ));
        }
        let delimiters = delimiters(&global_text)?;
        let mut global = Vec::new();
        let mut reader = SectionReader {
            text: &global_text,
            at: 0,
            delimiters,
        };
        while let Some(token) = reader.next()? {
            global.push(Token::Owned(token.to_vec()));
        }
        let directory = entries
            .chunks_exact(2)
            .map(|pair| [pair[0], pair[1]])
            .collect();
        Ok(Self {
            global,
            directory,
            parameters,
            delimiters,
        })
    }

    /// How many entities there are.
    pub fn count(&self) -> usize {
        self.directory.len()
    }

    /// All entries whose numbers can be read; `None` for the others.
    pub fn entries(&self) -> impl Iterator<Item = Option<Entry>> + '_ {
        (0..self.count()).map(|k| self.entry(2 * k as u64 + 1))
    }

    /// The entry whose first line is number `id`.
    pub fn entry(&self, id: u64) -> Option<Entry> {
        let at = usize::try_from(id.checked_sub(1)?)
            .ok()
            .filter(|at| at % 2 == 0)?
            / 2;
        let [one, two] = self.directory.get(at)?;
        let field = |line: &[u8], k: usize| line.get(8 * k..8 * k + 8).and_then(whole_or_zero);
        let (kind, first, matrix) = (field(one, 0)?, field(one, 1)?, field(one, 6)?);
        // Some files leave the number of lines out.
        let lines = field(two, 3)?.max(1);
        Some(Entry {
            id,
            kind,
            first,
            lines,
            matrix,
            // The second pair of digits of its status: 01 physically, 02 logically, 03 both.
            dependent: matches!(one.get(67), Some(b'1' | b'3')),
        })
    }

    /// The parameters of an entity, without its number.
    pub fn parameters(&self, entry: &Entry) -> Result<Vec<Vec<u8>>, IgesError> {
        let (id, first) = (entry.id, entry.first);
        let last = first.saturating_add(entry.lines - 1);
        let pointer = IgesError::Pointer {
            id,
            first,
            last,
            lines: self.parameters.len(),
        };
        if first == 0 || last > self.parameters.len() as u64 {
            return Err(pointer);
        }
        let text = self.parameters[first as usize - 1..last as usize].concat();
        let mut reader = SectionReader {
            text: &text,
            at: 0,
            delimiters: self.delimiters,
        };
        let mut tokens = Vec::new();
        while let Some(token) = reader.next()? {
            tokens.push(token.to_vec());
        }
        if !tokens.is_empty() {
            tokens.remove(0);
        }
        Ok(tokens)
    }

    /// The unit of the model, by flag, name and scale of the global section.
    pub fn unit(&self) -> Result<LengthUnit, IgesError> {
        let token = |index: usize| self.global.get(index - 1).map_or(&[][..], |token| token);
        let wrong = |index: usize, what: &'static str| {
            let found = shortened(token(index));
            IgesError::Global { index, what, found }
        };
        // Empty parameters have defaults: scale 1, inches.
        let scale = if token(13).is_empty() {
            Some(1.0)
        } else {
            parse(token(13))
        };
        let scale = scale.filter(|s| s.is_normal() && *s > 0.0);
        let scale = scale.ok_or_else(|| wrong(13, "the model's scale, a number above 0"))?;
        let flag = if token(14).is_empty() {
            Some(1)
        } else {
            whole(token(14))
        };
        let unit = |name: &str, numerator: f64, denominator: f64| {
            LengthUnit::of_metres(name, numerator, denominator)
        };
        let unit = match flag {
            Some(1) => unit("inch", 25.4, 1e3),
            Some(2) => unit("mm", 1.0, 1e3),
            Some(4) => unit("ft", 304.8, 1e3),
            Some(5) => unit("mi", 1609.344, 1.0),
            Some(6) => unit("m", 1.0, 1.0),
            Some(7) => unit("km", 1e3, 1.0),
            Some(8) => unit("mil", 25.4, 1e6),
            Some(9) => unit("µm", 1.0, 1e6),
            Some(10) => unit("cm", 1.0, 1e2),
            Some(11) => unit("µin", 25.4, 1e9),
            // By name only; those that CAD systems write here are the ones above.
            Some(3) => match hollerith_body(token(15)) {
                b"IN" | b"INCH" => unit("inch", 25.4, 1e3),
                b"MM" => unit("mm", 1.0, 1e3),
                b"FT" => unit("ft", 304.8, 1e3),
                b"M" => unit("m", 1.0, 1.0),
                b"CM" => unit("cm", 1.0, 1e2),
                b"UM" => unit("µm", 1.0, 1e6),
                _ => return Err(wrong(15, "the name of a unit of length that we know")),
            },
            _ => return Err(wrong(14, "the unit's flag, 1 to 11")),
        };
        // The model is `scale` times as large as the thing.
        let unit = if scale == 1.0 {
            unit
        } else {
            unit.divided(scale)
        };
        // A scale near the ends of the numbers leaves no unit.
        let unit = Some(unit).filter(LengthUnit::is_length);
        unit.ok_or_else(|| wrong(13, "the model's scale, a number above 0"))
    }
}

/// A whole number that may have blanks around it, as fields of fixed width have.
fn whole(field: &[u8]) -> Option<u64> {
    std::str::from_utf8(field).ok()?.trim().parse().ok()
}

/// Reads a whole number, a blank field as 0. Negative numbers (pointers to properties) give `None`.
fn whole_or_zero(field: &[u8]) -> Option<u64> {
    let text = std::str::from_utf8(field).ok()?.trim();
    if text.is_empty() || text.starts_with('-') {
        Some(0)
    } else {
        text.parse().ok()
    }
}

pub(super) fn shortened(text: &[u8]) -> String {
    if text.is_empty() {
        return "empty".to_owned();
    }
    let head = String::from_utf8_lossy(&text[..text.len().min(24)]);
    format!(
        "\"{}{}\"",
        head.escape_debug(),
        if text.len() > 24 { "…" } else { "" }
    )
}

/// `2HMM` → `MM`.
fn hollerith_body(token: &[u8]) -> &[u8] {
    let at = token
        .iter()
        .position(|&byte| byte == b'H')
        .map_or(0, |at| at + 1);
    token[at..].trim_ascii()
}

/// The parameter and record delimiters, which the global section begins with: `1H,,1H;,` or empty
/// for these two.
fn delimiters(global: &[u8]) -> Result<[u8; 2], IgesError> {
    let wrong = |index: usize| IgesError::Global {
        index,
        what: "a delimiter, such as 1H,",
        found: shortened(&global[..global.len().min(16)]),
    };
    let text = global.trim_ascii_start();
    let (parameter, rest) = match text {
        [b'1', b'H', delimiter, next, rest @ ..] if next == delimiter => (*delimiter, rest),
        [b',', rest @ ..] => (b',', rest),
        _ => return Err(wrong(1)),
    };
    let record = match rest {
        [b'1', b'H', delimiter, ..] => *delimiter,
        [next, ..] if *next == parameter => b';',
        _ => return Err(wrong(2)),
    };
    let usable = |byte: u8| {
        byte.is_ascii_graphic() && !byte.is_ascii_alphanumeric() && !b"+-.".contains(&byte)
    };
    if !usable(parameter) || !usable(record) || parameter == record {
        return Err(wrong(1));
    }
    Ok([parameter, record])
}

/// Walks through free-format parameters.
struct SectionReader<'a> {
    text: &'a [u8],
    at: usize,
    delimiters: [u8; 2],
}

impl<'a> SectionReader<'a> {
    /// The next parameter, without blanks around it; `None` after the record's end.
    fn next(&mut self) -> Result<Option<&'a [u8]>, IgesError> {
        let text = self.text;
        if self.at > text.len() {
            return Ok(None);
        }
        let start = self.at;
        let mut at = start;
        while text.get(at).is_some_and(u8::is_ascii_whitespace) {
            at += 1;
        }
        // A Hollerith string: its count, H, and as many characters, delimiters among them.
        let digits = text[at..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit())
            .count();
        if digits > 0 && text.get(at + digits) == Some(&b'H') {
            let count = whole(&text[at..at + digits]).and_then(|count| usize::try_from(count).ok());
            let end = count
                .and_then(|count| (at + digits + 1).checked_add(count))
                .filter(|&end| end <= text.len());
            at = end.ok_or(IgesError::Unfinished(
                "a string is longer than the lines that hold it",
            ))?;
        }
        let [parameter, record] = self.delimiters;
        while text
            .get(at)
            .is_some_and(|&byte| byte != parameter && byte != record)
        {
            at += 1;
        }
        match text.get(at) {
            None => Err(IgesError::Unfinished("a list of parameters has no end")),
            Some(byte) => {
                // After the record's delimiter there is nothing.
                self.at = if *byte == record {
                    text.len() + 1
                } else {
                    at + 1
                };
                Ok(Some(text[start..at].trim_ascii()))
            }
        }
    }
}
