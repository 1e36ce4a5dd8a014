//! A function of x, y, z as a flat list of operations, evaluated as numbers, with its gradient, and
//! over boxes.
//!
//! `fidget` compiles such functions to machine code but computes in f32, seven digits, where
//! contacts are asked to nine; `exmex` evaluates in f64 but differentiates symbolically (its
//! expressions double with each product) and has no intervals, which pruning needs. A tape of at
//! most [`MAX_OPS`] operations serves all three and allocates nothing.

use super::interval::Interval;
use crate::math::{Point3, Vector3};

/// Most operations of one function.
pub const MAX_OPS: usize = 160;

/// One operation; operands are places of earlier ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Constant(f64),
    /// 0, 1, 2: x, y, z.
    Variable(u8),
    Unary(Unary, u16),
    Binary(Binary, u16, u16),
    /// Whole power.
    Power(u16, i32),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Unary {
    Negate,
    Abs,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Exp,
    Ln,
    Tanh,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
    Hypot,
    Atan2,
}

/// A compiled function; the last operation is its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape {
    ops: Vec<Op>,
}

/// Value and derivatives by x, y, z.
#[derive(Clone, Copy)]
struct Dual {
    f: f64,
    d: [f64; 3],
}

impl Dual {
    const ZERO: Self = Self {
        f: 0.0,
        d: [0.0; 3],
    };

    #[inline(always)]
    fn chain(self, f: f64, slope: f64) -> Self {
        Self {
            f,
            d: self.d.map(|d| scaled(slope, d)),
        }
    }

    #[inline(always)]
    fn combine(a: Self, b: Self, f: f64, by_a: f64, by_b: f64) -> Self {
        Self {
            f,
            d: std::array::from_fn(|k| scaled(by_a, a.d[k]) + scaled(by_b, b.d[k])),
        }
    }
}

/// A slope times a derivative; what does not move does not care how steep it is (√ at 0, for
/// example).
#[inline(always)]
fn scaled(slope: f64, d: f64) -> f64 {
    if d == 0.0 { 0.0 } else { slope * d }
}

/// An expression with the constant `N` as room for so many operations: what a short function does not need is not cleared
/// each time that it is asked.
macro_rules! in_room {
    ($count:expr, $n:ident => $work:expr) => {
        match $count {
            ..=12 => {
                const $n: usize = 12;
                $work
            }
            ..=40 => {
                const $n: usize = 40;
                $work
            }
            _ => {
                const $n: usize = MAX_OPS;
                $work
            }
        }
    };
}

impl Op {
    fn chooses(&self) -> bool {
        matches!(
            self,
            Self::Unary(Unary::Abs, _) | Self::Binary(Binary::Min | Binary::Max, ..)
        )
    }
}

impl Tape {
    /// Operations whose operands come before them; at least one.
    pub(super) fn new(ops: Vec<Op>) -> Self {
        debug_assert!(
            !ops.is_empty() && ops.len() <= MAX_OPS,
            "the parser counts operations"
        );
        Self { ops }
    }

    /// The value at a point; NaN where it is not defined.
    pub fn value(&self, p: &Point3) -> f64 {
        in_room!(self.ops.len(), N => self.value_in::<N>(p))
    }

    fn value_in<const N: usize>(&self, p: &Point3) -> f64 {
        let mut r = [0.0; N];
        for (k, op) in self.ops.iter().enumerate() {
            r[k] = match *op {
                Op::Constant(c) => c,
                Op::Variable(v) => p[v as usize],
                Op::Unary(u, a) => unary(u, r[a as usize]).0,
                Op::Binary(b, x, y) => binary(b, r[x as usize], r[y as usize]),
                Op::Power(a, n) => whole_power(r[a as usize], n),
            };
        }
        r[self.ops.len() - 1]
    }

    /// Value and gradient, by forward differentiation. At kinks, the derivative from one side.
    pub fn gradient(&self, p: &Point3) -> (f64, Vector3) {
        let Dual { f, d } = self.differentiate(p, self.ops.len() - 1, |second| second);
        (f, Vector3::from(d))
    }

    /// Value and gradient of an earlier operation.
    pub(super) fn gradient_of(&self, p: &Point3, op: usize) -> (f64, Vector3) {
        let Dual { f, d } = self.differentiate(p, op, |second| second);
        (f, Vector3::from(d))
    }

    /// Value and gradient with `max`, `min` and `abs` held to the operands that `choices` names, as [`Self::choices`] does.
    pub(super) fn gradient_with(&self, p: &Point3, choices: u64) -> (f64, Vector3) {
        let mut left = choices;
        let Dual { f, d } = self.differentiate(p, self.ops.len() - 1, |_| {
            let second = left & 1 == 1;
            left >>= 1;
            second
        });
        (f, Vector3::from(d))
    }

    /// How many operations choose between operands: `max`, `min` and `abs`.
    pub(super) fn ties(&self) -> usize {
        self.ops.iter().filter(|op| op.chooses()).count()
    }

    /// Which operand each of them takes, the first operation's as the lowest bit: 1 for the second, or for the negative.
    pub(super) fn choices(&self, p: &Point3) -> u64 {
        let (mut choices, mut k) = (0, 0);
        self.differentiate(p, self.ops.len() - 1, |second| {
            choices |= u64::from(second) << k;
            k += 1;
            second
        });
        choices
    }

    /// Operations that have a tip where they vanish.
    pub(super) fn roots(&self) -> impl Iterator<Item = usize> + '_ {
        let root = |op: &Op| {
            matches!(
                op,
                Op::Unary(Unary::Sqrt, _) | Op::Binary(Binary::Hypot, ..)
            )
        };
        (0..self.ops.len()).filter(move |&k| root(&self.ops[k]))
    }

    /// Value and derivatives of an operation; `choose` is asked at each that chooses, in their order, with what is so.
    #[inline(always)]
    fn differentiate(&self, p: &Point3, op: usize, choose: impl FnMut(bool) -> bool) -> Dual {
        in_room!(op + 1, N => self.differentiate_in::<N>(p, op, choose))
    }

    #[inline(always)]
    fn differentiate_in<const N: usize>(
        &self,
        p: &Point3,
        op: usize,
        mut choose: impl FnMut(bool) -> bool,
    ) -> Dual {
        let mut r = [Dual::ZERO; N];
        for (k, op) in self.ops[..=op].iter().enumerate() {
            r[k] = match *op {
                Op::Constant(f) => Dual { f, d: [0.0; 3] },
                Op::Variable(v) => {
                    let mut d = [0.0; 3];
                    d[v as usize] = 1.0;
                    Dual {
                        f: p[v as usize],
                        d,
                    }
                }
                Op::Unary(Unary::Abs, a) => {
                    let a = r[a as usize];
                    let slope = if choose(a.f < 0.0) { -1.0 } else { 1.0 };
                    a.chain(slope * a.f, slope)
                }
                Op::Unary(u, a) => {
                    let a = r[a as usize];
                    let (f, slope) = unary(u, a.f);
                    a.chain(f, slope)
                }
                Op::Power(a, n) => {
                    let a = r[a as usize];
                    let slope = if n == 0 {
                        0.0
                    } else {
                        f64::from(n) * whole_power(a.f, n - 1)
                    };
                    a.chain(whole_power(a.f, n), slope)
                }
                Op::Binary(b @ (Binary::Min | Binary::Max), x, y) => {
                    let (x, y) = (r[x as usize], r[y as usize]);
                    let second = if b == Binary::Min {
                        y.f < x.f
                    } else {
                        y.f > x.f
                    };
                    if choose(second) { y } else { x }
                }
                Op::Binary(b, x, y) => dual(b, r[x as usize], r[y as usize]),
            };
        }
        r[op]
    }

    /// Holds every value over a box. Wider than the true range where a variable occurs more than
    /// once.
    pub fn interval(&self, low: &Point3, high: &Point3) -> Interval {
        in_room!(self.ops.len(), N => self.interval_in::<N>(low, high))
    }

    fn interval_in<const N: usize>(&self, low: &Point3, high: &Point3) -> Interval {
        let mut r = [Interval::point(0.0); N];
        for (k, op) in self.ops.iter().enumerate() {
            r[k] = match *op {
                Op::Constant(c) => Interval::point(c),
                Op::Variable(v) => Interval {
                    low: low[v as usize],
                    high: high[v as usize],
                },
                Op::Unary(u, a) => r[a as usize].unary(u),
                Op::Binary(b, x, y) if x == y && b == Binary::Multiply => {
                    r[x as usize].whole_power(2)
                }
                Op::Binary(b, x, y) => Interval::binary(b, r[x as usize], r[y as usize]),
                Op::Power(a, n) => r[a as usize].whole_power(n),
            };
        }
        r[self.ops.len() - 1]
    }
}

/// Value and slope.
#[inline(always)]
fn unary(op: Unary, x: f64) -> (f64, f64) {
    match op {
        Unary::Negate => (-x, -1.0),
        Unary::Abs => (x.abs(), if x < 0.0 { -1.0 } else { 1.0 }),
        Unary::Sqrt => {
            let y = x.sqrt();
            (y, if y > 0.0 { 0.5 / y } else { 0.0 })
        }
        Unary::Sin => (libm::sin(x), libm::cos(x)),
        Unary::Cos => (libm::cos(x), -libm::sin(x)),
        Unary::Tan => {
            let y = libm::tan(x);
            (y, 1.0 + y * y)
        }
        Unary::Exp => {
            let y = libm::exp(x);
            (y, y)
        }
        Unary::Ln => (libm::log(x), 1.0 / x),
        Unary::Tanh => {
            let y = libm::tanh(x);
            (y, 1.0 - y * y)
        }
    }
}

#[inline(always)]
fn binary(op: Binary, a: f64, b: f64) -> f64 {
    match op {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        Binary::Power => libm::pow(a, b),
        Binary::Min => {
            if b < a {
                b
            } else {
                a
            }
        }
        Binary::Max => {
            if b > a {
                b
            } else {
                a
            }
        }
        Binary::Hypot => libm::hypot(a, b),
        Binary::Atan2 => libm::atan2(a, b),
    }
}

#[inline(always)]
fn dual(op: Binary, a: Dual, b: Dual) -> Dual {
    let f = binary(op, a.f, b.f);
    let (by_a, by_b) = match op {
        Binary::Add => (1.0, 1.0),
        Binary::Subtract => (1.0, -1.0),
        Binary::Multiply => (b.f, a.f),
        Binary::Divide => (1.0 / b.f, -f / b.f),
        Binary::Power => (b.f * libm::pow(a.f, b.f - 1.0), f * libm::log(a.f)),
        // Chosen between before.
        Binary::Min | Binary::Max => (1.0, 0.0),
        Binary::Hypot => {
            if f > 0.0 {
                (a.f / f, b.f / f)
            } else {
                (0.0, 0.0)
            }
        }
        Binary::Atan2 => {
            let square = a.f * a.f + b.f * b.f;
            if square > 0.0 {
                (b.f / square, -a.f / square)
            } else {
                (0.0, 0.0)
            }
        }
    };
    Dual::combine(a, b, f, by_a, by_b)
}

/// xⁿ by squaring: the same bits everywhere.
pub(super) fn whole_power(x: f64, n: i32) -> f64 {
    let (mut base, mut left, mut out) = (x, n.unsigned_abs(), 1.0);
    while left > 0 {
        if left & 1 == 1 {
            out *= base;
        }
        base *= base;
        left >>= 1;
    }
    if n < 0 { 1.0 / out } else { out }
}
