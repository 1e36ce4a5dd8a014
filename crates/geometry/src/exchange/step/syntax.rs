//! The exchange structure of ISO 10303-21: first where each instance stands, then the values of one
//! of them.
//!
//! The index holds three numbers for each instance; values are parsed when asked for, to a bounded
//! depth. Text is kept as bytes: files in Latin-1 are read as well as those in UTF-8.

use super::StepError;

/// Lists within lists. Entities have three at most.
const MAX_DEPTH: usize = 16;

/// A file, indexed.
#[derive(Debug)]
pub(super) struct Exchange<'a> {
    bytes: &'a [u8],
    /// Sorted by id.
    instances: Vec<Instance>,
}

/// `#id = start .. end;`
#[derive(Clone, Copy, Debug)]
pub(super) struct Instance {
    pub id: u64,
    start: usize,
    end: usize,
}

/// `NAME(arguments)`: an instance, or one part of a complex instance.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Record<'a> {
    pub name: &'a str,
    pub arguments: Vec<Value<'a>>,
}

/// An argument.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'a> {
    /// `$`
    Omitted,
    /// `*`
    Derived,
    /// Integers too.
    Number(f64),
    /// Between its quotes, as it stands.
    Text(&'a [u8]),
    /// `.T.` without its points.
    Enumeration(&'a str),
    /// `#7`
    Reference(u64),
    /// `(…)`
    List(Vec<Value<'a>>),
    /// `LENGTH_MEASURE(25.4)`
    Typed(&'a str, Vec<Value<'a>>),
}

impl Value<'_> {
    /// For messages.
    pub fn shown(&self) -> String {
        match self {
            Value::Omitted => "$".to_owned(),
            Value::Derived => "*".to_owned(),
            Value::Number(number) => format!("{number}"),
            Value::Text(text) => shortened(text),
            Value::Enumeration(name) => format!(".{name}."),
            Value::Reference(id) => format!("#{id}"),
            Value::List(values) => format!("a list of {}", values.len()),
            Value::Typed(name, _) => format!("a {name}"),
        }
    }
}

impl<'a> Exchange<'a> {
    /// Walks through the file once.
    pub fn index(bytes: &'a [u8]) -> Result<Self, StepError> {
        let mut cursor = Cursor {
            bytes,
            at: 0,
            end: bytes.len(),
        };
        if bytes.starts_with(b"\xef\xbb\xbf") {
            cursor.at = 3;
        }
        if cursor.space().is_err() || !cursor.rest().starts_with(b"ISO-10303-21") {
            return Err(StepError::NotStep);
        }
        cursor.statement()?;
        let mut instances = Vec::new();
        let mut in_data = false;
        loop {
            cursor.space()?;
            if cursor.at == cursor.end {
                return Err(cursor.unfinished(cursor.at, "the file: END-ISO-10303-21 is missing"));
            }
            let (start, end) = cursor.statement()?;
            let text = &bytes[start..end];
            if text.first() == Some(&b'#') {
                if in_data {
                    let mut inside = Cursor {
                        bytes,
                        at: start,
                        end,
                    };
                    let id = inside.reference()?;
                    inside.space()?;
                    inside.expect(b'=', "=")?;
                    inside.space()?;
                    instances.push(Instance {
                        id,
                        start: inside.at,
                        end,
                    });
                }
            } else if is_word(text, b"DATA") {
                in_data = true;
            } else if is_word(text, b"ENDSEC") {
                in_data = false;
            } else if is_word(text, b"END-ISO-10303-21") {
                break;
            } else if in_data {
                return Err(cursor.syntax(start, "#, the number of an instance, or ENDSEC"));
            }
        }
        instances.sort_by_key(|instance| instance.id);
        if let Some(pair) = instances.windows(2).find(|pair| pair[0].id == pair[1].id) {
            return Err(StepError::Twice(pair[0].id));
        }
        Ok(Self { bytes, instances })
    }

    /// The file's length, bytes.
    pub fn size(&self) -> usize {
        self.bytes.len()
    }

    /// All instances, ids ascending.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// What stands behind `#id =`, as it stands.
    pub fn text(&self, instance: &Instance) -> &'a [u8] {
        &self.bytes[instance.start..instance.end]
    }

    /// The instance that `from` refers to.
    pub fn find(&self, to: u64, from: u64) -> Result<&Instance, StepError> {
        let at = self
            .instances
            .binary_search_by_key(&to, |instance| instance.id);
        at.map(|at| &self.instances[at])
            .map_err(|_| StepError::Missing { from, to })
    }

    /// Its records: one, or those of a complex instance.
    pub fn records(&self, instance: &Instance) -> Result<Vec<Record<'a>>, StepError> {
        let mut cursor = Cursor {
            bytes: self.bytes,
            at: instance.start,
            end: instance.end,
        };
        let mut records = Vec::new();
        if cursor.peek() == Some(b'(') {
            cursor.at += 1;
            loop {
                cursor.space()?;
                if cursor.peek() == Some(b')') {
                    cursor.at += 1;
                    break;
                }
                records.push(cursor.record()?);
            }
        } else {
            records.push(cursor.record()?);
        }
        cursor.space()?;
        if cursor.at < cursor.end {
            return Err(cursor.syntax(cursor.at, "; after the instance"));
        }
        Ok(records)
    }

    /// The numbers that an instance refers to. Malformed text refers to nothing.
    pub fn references(&self, instance: &Instance) -> Vec<u64> {
        let mut cursor = Cursor {
            bytes: self.bytes,
            at: instance.start,
            end: instance.end,
        };
        let mut found = Vec::new();
        while let Some(byte) = cursor.peek() {
            match byte {
                b'#' => found.extend(cursor.reference().ok()),
                b'\'' | b'"' | b'/' if cursor.skip_quoted().is_err() => break,
                b'\'' | b'"' | b'/' => {}
                _ => cursor.at += 1,
            }
        }
        found
    }
}

fn is_word(text: &[u8], word: &[u8]) -> bool {
    text.strip_prefix(word).is_some_and(|rest| {
        rest.first()
            .is_none_or(|b| b.is_ascii_whitespace() || *b == b'(')
    })
}

fn shortened(text: &[u8]) -> String {
    let head = String::from_utf8_lossy(&text[..text.len().min(24)]);
    format!(
        "\"{}{}\"",
        head.escape_debug(),
        if text.len() > 24 { "…" } else { "" }
    )
}

/// A place in a stretch of the file.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    end: usize,
}

impl<'a> Cursor<'a> {
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..self.end]
    }

    fn peek(&self) -> Option<u8> {
        self.rest().first().copied()
    }

    fn line(&self, at: usize) -> usize {
        1 + self.bytes[..at]
            .iter()
            .filter(|&&byte| byte == b'\n')
            .count()
    }

    fn unfinished(&self, at: usize, inside: &'static str) -> StepError {
        StepError::Unfinished {
            line: self.line(at),
            inside,
        }
    }

    fn syntax(&self, at: usize, wanted: &'static str) -> StepError {
        let found = if at < self.end {
            shortened(&self.bytes[at..self.end])
        } else {
            "its end".to_owned()
        };
        StepError::Syntax {
            line: self.line(at),
            wanted,
            found,
        }
    }

    fn expect(&mut self, byte: u8, wanted: &'static str) -> Result<(), StepError> {
        if self.peek() != Some(byte) {
            return Err(self.syntax(self.at, wanted));
        }
        self.at += 1;
        Ok(())
    }

    /// Past white space and comments.
    fn space(&mut self) -> Result<(), StepError> {
        while let Some(byte) = self.peek() {
            if byte.is_ascii_whitespace() {
                self.at += 1;
            } else if self.rest().starts_with(b"/*") {
                self.skip_quoted()?;
            } else {
                break;
            }
        }
        Ok(())
    }

    /// Past a string, a binary, a comment, or a slash that begins none. Doubled quotes are two
    /// strings side by side.
    fn skip_quoted(&mut self) -> Result<(), StepError> {
        let start = self.at;
        let rest = self.rest();
        let (close, inside): (&[u8], _) = match rest {
            [b'/', b'*', ..] => (b"*/", "a comment"),
            [b'\'', ..] => (b"'", "a string"),
            [b'"', ..] => (b"\"", "a binary"),
            _ => {
                self.at += 1;
                return Ok(());
            }
        };
        let body = &rest[close.len()..];
        let Some(length) = body.windows(close.len()).position(|window| window == close) else {
            return Err(self.unfinished(start, inside));
        };
        self.at += length + 2 * close.len();
        Ok(())
    }

    /// Up to the next semicolon outside strings and comments, and past it.
    fn statement(&mut self) -> Result<(usize, usize), StepError> {
        let start = self.at;
        while let Some(byte) = self.peek() {
            match byte {
                b';' => {
                    self.at += 1;
                    return Ok((start, self.at - 1));
                }
                b'\'' | b'"' | b'/' => self.skip_quoted()?,
                _ => self.at += 1,
            }
        }
        Err(self.unfinished(start, "a statement"))
    }

    fn while_in(&mut self, allowed: impl Fn(u8) -> bool) -> &'a [u8] {
        let rest = self.rest();
        let length = rest
            .iter()
            .position(|&byte| !allowed(byte))
            .unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    fn reference(&mut self) -> Result<u64, StepError> {
        let start = self.at;
        self.expect(b'#', "#")?;
        let digits = self.while_in(|byte| byte.is_ascii_digit());
        let number = std::str::from_utf8(digits)
            .ok()
            .and_then(|digits| digits.parse().ok());
        number.ok_or_else(|| self.syntax(start, "an instance number such as #7"))
    }

    fn name(&mut self) -> Result<&'a str, StepError> {
        let start = self.at;
        let name =
            self.while_in(|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'!');
        match std::str::from_utf8(name) {
            Ok(name) if !name.is_empty() => Ok(name),
            _ => Err(self.syntax(start, "the name of an entity")),
        }
    }

    fn record(&mut self) -> Result<Record<'a>, StepError> {
        let name = self.name()?;
        self.space()?;
        let arguments = self.list(0)?;
        Ok(Record { name, arguments })
    }

    fn list(&mut self, depth: usize) -> Result<Vec<Value<'a>>, StepError> {
        if depth >= MAX_DEPTH {
            return Err(self.syntax(self.at, "lists nested at most 16 deep"));
        }
        self.expect(b'(', "a list in parentheses")?;
        let mut values = Vec::new();
        self.space()?;
        if self.peek() == Some(b')') {
            self.at += 1;
            return Ok(values);
        }
        loop {
            self.space()?;
            values.push(self.value(depth)?);
            self.space()?;
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(b')') => {
                    self.at += 1;
                    return Ok(values);
                }
                _ => return Err(self.syntax(self.at, ", or ) in a list")),
            }
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value<'a>, StepError> {
        let start = self.at;
        match self.peek() {
            Some(b'$') => {
                self.at += 1;
                Ok(Value::Omitted)
            }
            Some(b'*') => {
                self.at += 1;
                Ok(Value::Derived)
            }
            Some(b'#') => Ok(Value::Reference(self.reference()?)),
            Some(b'(') => Ok(Value::List(self.list(depth + 1)?)),
            Some(b'\'' | b'"') => {
                // Doubled quotes stand for one: the string goes on.
                while matches!(self.peek(), Some(b'\'' | b'"')) {
                    self.skip_quoted()?;
                }
                Ok(Value::Text(&self.bytes[start + 1..self.at - 1]))
            }
            Some(b'.')
                if self
                    .rest()
                    .get(1)
                    .is_some_and(|byte| byte.is_ascii_alphabetic()) =>
            {
                self.at += 1;
                let name = self.name()?;
                self.expect(b'.', ". after an enumeration")?;
                Ok(Value::Enumeration(name))
            }
            Some(b'0'..=b'9' | b'+' | b'-' | b'.') => {
                let token =
                    self.while_in(|b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.'));
                crate::exchange::number::parse(token)
                    .map(Value::Number)
                    .ok_or_else(|| self.syntax(start, "a finite number, such as 1.5E-3"))
            }
            Some(byte) if byte.is_ascii_alphabetic() || byte == b'!' => {
                let name = self.name()?;
                self.space()?;
                Ok(Value::Typed(name, self.list(depth + 1)?))
            }
            _ => Err(self.syntax(start, "a value")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(data: &str) -> String {
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_NAME('a;b');\nENDSEC;\nDATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n"
        )
    }

    fn records(data: &str) -> Result<Vec<Record<'static>>, StepError> {
        let text: &'static str = Box::leak(file(data).into_boxed_str());
        let exchange = Exchange::index(text.as_bytes())?;
        exchange.records(&exchange.instances()[0])
    }

    #[test]
    fn every_kind_of_value_is_read() {
        let read = records(
            "#7 = /* it's; */ THING('it''s; ok', $,*,.T. , #12,(1,-2.5E-1,()),LENGTH_MEASURE(3.));",
        )
        .unwrap();
        let arguments = vec![
            Value::Text(b"it''s; ok"),
            Value::Omitted,
            Value::Derived,
            Value::Enumeration("T"),
            Value::Reference(12),
            Value::List(vec![
                Value::Number(1.0),
                Value::Number(-0.25),
                Value::List(vec![]),
            ]),
            Value::Typed("LENGTH_MEASURE", vec![Value::Number(3.0)]),
        ];
        assert_eq!(
            read,
            vec![Record {
                name: "THING",
                arguments
            }]
        );
    }

    #[test]
    fn complex_instances_have_several_records() {
        let read =
            records("#1=( LENGTH_UNIT() NAMED_UNIT(*)\nSI_UNIT(.MILLI.,.METRE.) );").unwrap();
        assert_eq!(
            read.iter().map(|r| r.name).collect::<Vec<_>>(),
            ["LENGTH_UNIT", "NAMED_UNIT", "SI_UNIT"]
        );
    }

    #[test]
    fn references_are_found_outside_strings_and_comments() {
        let text = file("#1=A(#2,'#3 isn''t one',(#4) /* #5 */);");
        let exchange = Exchange::index(text.as_bytes()).unwrap();
        assert_eq!(exchange.references(&exchange.instances()[0]), [2, 4]);
    }

    #[test]
    fn what_is_against_the_grammar_is_named_with_its_line() {
        let message = |data: &str| records(data).unwrap_err().to_string();
        assert_eq!(
            message("#1=A(1,2"),
            "line 7: expected , or ) in a list, found \"ENDSEC\""
        );
        assert_eq!(
            message("#1=A(1.2.3);"),
            "line 6: expected a finite number, such as 1.5E-3, found \"1.2.3)\""
        );
        assert_eq!(
            message("#1=A('x);"),
            "line 6: the file ends inside a string; it seems to be cut short"
        );
        assert_eq!(message("\n#1;"), "line 7: expected =, found its end");
        assert_eq!(message("#1=A();#1=B();"), "#1 is defined twice");
        assert_eq!(
            message("#=A();"),
            "line 6: expected an instance number such as #7, found \"#=A()\""
        );
        assert_eq!(
            message("A();"),
            "line 6: expected #, the number of an instance, or ENDSEC, found \"A();\\nENDSEC;\\nEND-ISO-103…\""
        );
        assert!(
            message(&format!(
                "#1=A({}1{});",
                "(".repeat(100_000),
                ")".repeat(100_000)
            ))
            .contains("nested at most 16")
        );
        assert!(message("#1=A(#99999999999999999999999);").contains("an instance number"));
        assert_eq!(Exchange::index(b"solid x").unwrap_err(), StepError::NotStep);
    }
}
