//! Functions written as text: `x^2 + 4*y^2 + sqrt(z^2 + 1e-6) - 0.01`.
//!
//! ```text
//! sum     = product { (+ | −) product }
//! product = signed { (* | /) signed }
//! signed  = − signed | + signed | power
//! power   = atom [ ^ signed ]           −x^2 is −(x²), 2^3^2 is 2^(3²)
//! atom    = number | x | y | z | pi | function ( sum {, sum} ) | ( sum )
//! ```

use super::tape::{Binary, MAX_OPS, Op, Tape, Unary};

/// Brackets and signs deeper than this are refused rather than followed.
const MAX_DEPTH: usize = 64;

/// Why a text is not a valid function. Columns count characters from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExpressionError {
    /// Something else was expected.
    #[error("column {column}: found {found}, expected {expected}")]
    Unexpected {
        /// Column in the text.
        column: usize,
        /// What is there.
        found: String,
        /// What could be.
        expected: &'static str,
    },
    /// An unknown name.
    #[error(
        "column {column}: '{name}' is unknown{hint}; there are x, y, z (m), pi and the functions {FUNCTIONS}"
    )]
    Name {
        /// Column in the text.
        column: usize,
        /// The name.
        name: String,
        /// "; did you mean ...", or nothing.
        hint: String,
    },
    /// A function with the wrong number of arguments.
    #[error("column {column}: {name} takes {takes} arguments, not {given}")]
    Arguments {
        /// Where the function starts.
        column: usize,
        /// The function.
        name: String,
        /// How many it takes.
        takes: &'static str,
        /// How many there are.
        given: usize,
    },
    /// A number that cannot be read.
    #[error("column {column}: '{text}' is not a number")]
    Number {
        /// Column in the text.
        column: usize,
        /// What is there.
        text: String,
    },
    /// Too many operations.
    #[error(
        "column {column}: more than {MAX_OPS} operations, or brackets deeper than {MAX_DEPTH}; write it shorter"
    )]
    Long {
        /// Where it became too much.
        column: usize,
    },
}

const FUNCTIONS: &str = "sqrt abs min max sin cos tan exp ln tanh atan2 hypot";

impl Tape {
    /// Compiles a text.
    ///
    /// # Errors
    /// What cannot be read, with its column and what would help.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        let mut parser = Parser {
            chars: text.chars().collect(),
            at: 0,
            ops: Vec::new(),
            depth: 0,
        };
        parser.sum()?;
        match parser.peek() {
            None => Ok(Self::new(parser.ops)),
            Some(_) => Err(parser.unexpected("an operator (+ - * / ^) or the end")),
        }
    }
}

struct Parser {
    chars: Vec<char>,
    at: usize,
    ops: Vec<Op>,
    depth: usize,
}

type Parsed = Result<u16, ExpressionError>;

impl Parser {
    fn peek(&mut self) -> Option<char> {
        while self.chars.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
        self.chars.get(self.at).copied()
    }

    fn eat(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += usize::from(found);
        found
    }

    fn unexpected(&mut self, expected: &'static str) -> ExpressionError {
        let found = self
            .peek()
            .map_or_else(|| "the end".to_owned(), |c| format!("'{c}'"));
        ExpressionError::Unexpected {
            column: self.at + 1,
            found,
            expected,
        }
    }

    fn push(&mut self, op: Op) -> Parsed {
        // The same operation on the same operands is one: x*x squares, and boxes stay tight.
        if let Some(k) = self.ops.iter().position(|other| *other == op) {
            return Ok(k as u16);
        }
        if self.ops.len() == MAX_OPS {
            return Err(ExpressionError::Long { column: self.at });
        }
        self.ops.push(op);
        Ok(self.ops.len() as u16 - 1)
    }

    fn sum(&mut self) -> Parsed {
        let mut left = self.product()?;
        loop {
            let op = match self.peek() {
                Some('+') => Binary::Add,
                Some('-' | '−') => Binary::Subtract,
                _ => return self.last(left),
            };
            self.at += 1;
            let right = self.product()?;
            left = self.push(Op::Binary(op, left, right))?;
        }
    }

    /// The value of a tape is its last operation; one that was found earlier is repeated there.
    fn last(&mut self, place: u16) -> Parsed {
        if self.depth > 0 || usize::from(place) + 1 == self.ops.len() {
            return Ok(place);
        }
        if self.ops.len() == MAX_OPS {
            return Err(ExpressionError::Long { column: self.at });
        }
        self.ops.push(Op::Power(place, 1));
        Ok(self.ops.len() as u16 - 1)
    }

    fn product(&mut self) -> Parsed {
        let mut left = self.signed()?;
        loop {
            let op = match self.peek() {
                Some('*') => Binary::Multiply,
                Some('/') => Binary::Divide,
                _ => return Ok(left),
            };
            self.at += 1;
            let right = self.signed()?;
            left = self.push(Op::Binary(op, left, right))?;
        }
    }

    fn signed(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(ExpressionError::Long {
                column: self.at + 1,
            });
        }
        let place = if self.eat('-') || self.eat('−') {
            let inner = self.signed()?;
            match self.ops[usize::from(inner)] {
                Op::Constant(c) => self.push(Op::Constant(-c)),
                _ => self.push(Op::Unary(Unary::Negate, inner)),
            }
        } else if self.eat('+') {
            self.signed()
        } else {
            self.power()
        };
        self.depth -= 1;
        place
    }

    fn power(&mut self) -> Parsed {
        let base = self.atom()?;
        if !self.eat('^') {
            return Ok(base);
        }
        let exponent = self.signed()?;
        match self.ops[usize::from(exponent)] {
            Op::Constant(n) if n.fract() == 0.0 && n.abs() <= 64.0 => {
                self.push(Op::Power(base, n as i32))
            }
            Op::Constant(0.5) => self.push(Op::Unary(Unary::Sqrt, base)),
            _ => self.push(Op::Binary(Binary::Power, base, exponent)),
        }
    }

    fn atom(&mut self) -> Parsed {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                let inside = self.sum()?;
                if self.eat(')') {
                    Ok(inside)
                } else {
                    Err(self.unexpected("')'"))
                }
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            _ => Err(self.unexpected("a number, x, y, z, pi, a function or '('")),
        }
    }

    fn number(&mut self) -> Parsed {
        let start = self.at;
        let mut text = String::new();
        while let Some(&c) = self.chars.get(self.at) {
            let exponent = matches!(text.chars().last(), Some('e' | 'E'));
            if c.is_ascii_digit()
                || c == '.'
                || matches!(c, 'e' | 'E') && !text.contains(['e', 'E'])
                || exponent && matches!(c, '+' | '-')
            {
                text.push(c);
                self.at += 1;
            } else {
                break;
            }
        }
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => self.push(Op::Constant(x)),
            _ => Err(ExpressionError::Number {
                column: start + 1,
                text,
            }),
        }
    }

    fn name(&mut self) -> Parsed {
        let start = self.at;
        let mut name = String::new();
        while let Some(&c) = self
            .chars
            .get(self.at)
            .filter(|c| c.is_alphanumeric() || **c == '_')
        {
            name.push(c);
            self.at += 1;
        }
        let variable = ["x", "y", "z"].iter().position(|v| *v == name);
        if let Some(v) = variable {
            return self.push(Op::Variable(v as u8));
        }
        if name == "pi" {
            return self.push(Op::Constant(std::f64::consts::PI));
        }
        let unary = match name.as_str() {
            "sqrt" => Some(Unary::Sqrt),
            "abs" => Some(Unary::Abs),
            "sin" => Some(Unary::Sin),
            "cos" => Some(Unary::Cos),
            "tan" => Some(Unary::Tan),
            "exp" => Some(Unary::Exp),
            "ln" => Some(Unary::Ln),
            "tanh" => Some(Unary::Tanh),
            _ => None,
        };
        let binary = match name.as_str() {
            "min" => Some(Binary::Min),
            "max" => Some(Binary::Max),
            "hypot" => Some(Binary::Hypot),
            "atan2" => Some(Binary::Atan2),
            _ => None,
        };
        if unary.is_none() && binary.is_none() {
            return Err(ExpressionError::Name {
                column: start + 1,
                hint: hint(&name),
                name,
            });
        }
        let arguments = self.arguments()?;
        let wrong = |takes| ExpressionError::Arguments {
            column: start + 1,
            name,
            takes,
            given: arguments.len(),
        };
        match (unary, binary) {
            (Some(u), _) if arguments.len() == 1 => self.push(Op::Unary(u, arguments[0])),
            (Some(_), _) => Err(wrong("1")),
            (_, Some(b @ (Binary::Min | Binary::Max))) if arguments.len() >= 2 => {
                let mut left = arguments[0];
                for &right in &arguments[1..] {
                    left = self.push(Op::Binary(b, left, right))?;
                }
                Ok(left)
            }
            (_, Some(Binary::Min | Binary::Max)) => Err(wrong("2 or more")),
            (_, Some(b)) if arguments.len() == 2 => {
                self.push(Op::Binary(b, arguments[0], arguments[1]))
            }
            _ => Err(wrong("2")),
        }
    }

    fn arguments(&mut self) -> Result<Vec<u16>, ExpressionError> {
        if !self.eat('(') {
            return Err(self.unexpected("'(' after a function"));
        }
        let mut arguments = vec![self.sum()?];
        while self.eat(',') {
            arguments.push(self.sum()?);
        }
        if self.eat(')') {
            Ok(arguments)
        } else {
            Err(self.unexpected("',' or ')'"))
        }
    }
}

/// What may have been meant.
fn hint(name: &str) -> String {
    let other = match name {
        "log" => Some("ln"),
        "X" => Some("x"),
        "Y" => Some("y"),
        "Z" => Some("z"),
        "pow" => Some("a ^ b"),
        _ => FUNCTIONS
            .split(' ')
            .filter(|f| strsim::jaro_winkler(f, name) > 0.7)
            .max_by(|a, b| strsim::jaro_winkler(a, name).total_cmp(&strsim::jaro_winkler(b, name))),
    };
    other.map_or_else(String::new, |o| format!("; did you mean {o}?"))
}
