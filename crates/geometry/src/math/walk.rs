//! One walk over a state for everything that is done with it: saving, hashing, measuring, restoring.
//!
//! A type names its fields once, in [`stateful!`](crate::stateful). The text is compiled twice:
//! with a [`Saver`] and a shared reference, and with a [`Restorer`] and a mutable one. Both have
//! methods of the same names, and patterns bind fields as the reference does. A type that takes
//! itself apart with a pattern without `..` cannot forget a field: it would not compile.

use super::cholesky::Lane;
use super::state::{StateError, StateSink, StateSource, Stateful};
use super::{Point3, Rotation, Vector3};
use std::convert::Infallible;

/// Implements [`Stateful`] from one walk over a type's fields.
///
/// ```
/// use palpate_geometry::math::{SavedState, Vector3};
///
/// struct Ball { place: Vector3, bounces: u32 }
///
/// palpate_geometry::stateful!(Ball, |ball, walk| {
///     let Ball { place, bounces } = ball;
///     walk.vector(place)?;
///     walk.coded("number of bounces", bounces)
/// });
///
/// let ball = Ball { place: Vector3::x(), bounces: 3 };
/// let (mut saved, mut again) = (SavedState::default(), Ball { place: Vector3::zeros(), bounces: 0 });
/// saved.save_from(&ball);
/// saved.restore_into(&mut again)?;
/// assert_eq!((again.place, again.bounces), (ball.place, ball.bounces));
/// # Ok::<(), palpate_geometry::math::StateError>(())
/// ```
#[macro_export]
macro_rules! stateful {
    ($type:ty, |$this:ident, $walk:ident| $body:expr) => {
        impl $crate::math::Stateful for $type {
            fn save(&self, sink: &mut impl $crate::math::StateSink) {
                let $this = self;
                let $walk = &mut $crate::math::Saver::new(sink);
                let Ok(()) = (|| -> Result<(), std::convert::Infallible> { $body })();
            }

            fn restore(
                &mut self,
                source: &mut impl $crate::math::StateSource,
            ) -> Result<(), $crate::math::StateError> {
                let $this = self;
                let $walk = &mut $crate::math::Restorer::new(source);
                $body
            }
        }
    };
}

/// What is kept as an integer.
pub trait Coded {
    /// The integer.
    fn code(&self) -> u64;
    /// Takes the value with that integer; false if there is none.
    fn set_code(&mut self, code: u64) -> bool;
}

impl Coded for bool {
    fn code(&self) -> u64 {
        u64::from(*self)
    }
    fn set_code(&mut self, code: u64) -> bool {
        *self = code == 1;
        code <= 1
    }
}

/// Integers that fit.
macro_rules! coded {
    ($($type:ty),*) => {$(
        impl Coded for $type {
            fn code(&self) -> u64 {
                *self as u64
            }
            fn set_code(&mut self, code: u64) -> bool {
                <$type>::try_from(code).map(|value| *self = value).is_ok()
            }
        }
    )*};
}
coded!(u8, u32, u64, usize);

/// Three numbers.
pub trait Triple {
    /// x, y, z.
    fn triple(&self) -> &[f64];
    /// x, y, z, to be overwritten.
    fn triple_mut(&mut self) -> &mut [f64];
}

impl Triple for Vector3 {
    fn triple(&self) -> &[f64] {
        self.as_slice()
    }
    fn triple_mut(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }
}

impl Triple for Point3 {
    fn triple(&self) -> &[f64] {
        self.coords.as_slice()
    }
    fn triple_mut(&mut self) -> &mut [f64] {
        self.coords.as_mut_slice()
    }
}

/// The walk that gives a state away: to be saved, hashed or measured.
pub struct Saver<'a, S>(&'a mut S);

/// The walk that takes a state in.
pub struct Restorer<'a, S>(&'a mut S);

/// Result of a step of a [`Saver`], which cannot fail.
type Given = Result<(), Infallible>;
/// Result of a step of a [`Restorer`].
type Taken = Result<(), StateError>;

impl<'a, S: StateSink> Saver<'a, S> {
    /// Into a sink.
    pub fn new(sink: &'a mut S) -> Self {
        Self(sink)
    }

    /// An integer that may be anything.
    pub fn word(&mut self, value: &u64) -> Given {
        self.0.word(*value);
        Ok(())
    }

    /// The integer 0, where another state has something to say.
    pub fn nothing(&mut self) -> Given {
        self.word(&0)
    }

    /// An integer that says how the rest is laid out.
    pub fn constant(&mut self, _what: &'static str, value: u64) -> Given {
        self.word(&value)
    }

    /// A value with an integer of its own.
    pub fn coded(&mut self, what: &'static str, value: &dyn Coded) -> Given {
        self.packed(what, [(0, value)])
    }

    /// Several in one integer, each from the bit it names to where the next begins, the lowest
    /// first.
    pub fn packed<const N: usize>(
        &mut self,
        what: &'static str,
        parts: [(u32, &dyn Coded); N],
    ) -> Given {
        let mut word = 0;
        for (k, (shift, part)) in parts.iter().enumerate() {
            let code = part.code();
            debug_assert_eq!(
                code & mask(&parts, k),
                code,
                "{what}: part {k} is too large"
            );
            word |= code << shift;
        }
        self.word(&word)
    }

    /// A number.
    pub fn float(&mut self, value: &f64) -> Given {
        self.floats(&[*value])
    }

    /// Numbers, as many as the state has.
    pub fn floats(&mut self, values: &[f64]) -> Given {
        self.0.floats(values);
        Ok(())
    }

    /// Numbers in fours.
    pub fn lanes(&mut self, values: &[Lane]) -> Given {
        self.floats(values.as_flattened())
    }

    /// A vector.
    pub fn vector(&mut self, value: &Vector3) -> Given {
        self.floats(value.as_slice())
    }

    /// A point.
    pub fn point(&mut self, value: &Point3) -> Given {
        self.floats(value.coords.as_slice())
    }

    /// A rotation, to the bit.
    pub fn rotation(&mut self, value: &Rotation) -> Given {
        self.floats(value.coords.as_slice())
    }

    /// Vectors or points, as many as the state has.
    pub fn triples<T: Triple>(&mut self, items: &[T]) -> Given {
        // In blocks: a hash of thousands of short slices would cost more than the step's force pass.
        const BLOCK: usize = 64;
        let mut block = [0.0; 3 * BLOCK];
        for items in items.chunks(BLOCK) {
            for (slot, item) in block.chunks_exact_mut(3).zip(items) {
                slot.copy_from_slice(item.triple());
            }
            self.floats(&block[..3 * items.len()])?;
        }
        Ok(())
    }

    /// A part with a walk of its own.
    pub fn part<T: Stateful>(&mut self, value: &T) -> Given {
        value.save(self.0);
        Ok(())
    }

    /// Not part of the state now: a restore makes it the default.
    pub fn clear<T: Default>(&mut self, _value: &T) -> Given {
        Ok(())
    }

    /// What must hold before the walk goes on; `value` is what breaks it.
    pub fn ensure(&mut self, holds: bool, what: &'static str, value: u64) -> Given {
        debug_assert!(holds, "impossible {what}: {value}");
        Ok(())
    }
}

impl<'a, S: StateSource> Restorer<'a, S> {
    /// From a source.
    pub fn new(source: &'a mut S) -> Self {
        Self(source)
    }

    /// As [`Saver::word`].
    ///
    /// # Errors
    /// The source has ended.
    pub fn word(&mut self, value: &mut u64) -> Taken {
        *value = self.0.word()?;
        Ok(())
    }

    /// As [`Saver::nothing`]: what stands there is of no meaning.
    ///
    /// # Errors
    /// The source has ended.
    pub fn nothing(&mut self) -> Taken {
        self.0.word().map(drop)
    }

    /// As [`Saver::constant`].
    ///
    /// # Errors
    /// Another integer, or the source has ended.
    pub fn constant(&mut self, what: &'static str, value: u64) -> Taken {
        let found = self.0.word()?;
        self.ensure(found == value, what, found)
    }

    /// As [`Saver::coded`].
    ///
    /// # Errors
    /// No value has that integer, or the source has ended.
    pub fn coded(&mut self, what: &'static str, value: &mut dyn Coded) -> Taken {
        self.packed(what, [(0, value)])
    }

    /// As [`Saver::packed`].
    ///
    /// # Errors
    /// No values have that integer, or the source has ended.
    pub fn packed<const N: usize>(
        &mut self,
        what: &'static str,
        parts: [(u32, &mut dyn Coded); N],
    ) -> Taken {
        let word = self.0.word()?;
        for k in 0..N {
            let code = word >> parts[k].0 & mask(&parts, k);
            let fits = parts[k].1.set_code(code);
            self.ensure(fits, what, word)?;
        }
        Ok(())
    }

    /// As [`Saver::float`].
    ///
    /// # Errors
    /// The source has ended.
    pub fn float(&mut self, value: &mut f64) -> Taken {
        self.floats(std::slice::from_mut(value))
    }

    /// As [`Saver::floats`].
    ///
    /// # Errors
    /// The source has ended.
    pub fn floats(&mut self, values: &mut [f64]) -> Taken {
        self.0.floats(values)
    }

    /// As [`Saver::lanes`].
    ///
    /// # Errors
    /// The source has ended.
    pub fn lanes(&mut self, values: &mut [Lane]) -> Taken {
        self.floats(values.as_flattened_mut())
    }

    /// As [`Saver::vector`].
    ///
    /// # Errors
    /// The source has ended.
    pub fn vector(&mut self, value: &mut Vector3) -> Taken {
        self.floats(value.as_mut_slice())
    }

    /// As [`Saver::point`].
    ///
    /// # Errors
    /// The source has ended.
    pub fn point(&mut self, value: &mut Point3) -> Taken {
        self.floats(value.coords.as_mut_slice())
    }

    /// As [`Saver::rotation`].
    ///
    /// # Errors
    /// The source has ended.
    pub fn rotation(&mut self, value: &mut Rotation) -> Taken {
        let mut quaternion = [0.0; 4];
        self.floats(&mut quaternion)?;
        // Taken as saved: normalising again would change the last bit.
        *value = Rotation::new_unchecked(nalgebra::Quaternion::from(nalgebra::Vector4::from(
            quaternion,
        )));
        Ok(())
    }

    /// As [`Saver::triples`].
    ///
    /// # Errors
    /// The source has ended.
    pub fn triples<T: Triple>(&mut self, items: &mut [T]) -> Taken {
        items
            .iter_mut()
            .try_for_each(|item| self.floats(item.triple_mut()))
    }

    /// As [`Saver::part`].
    ///
    /// # Errors
    /// Those of the part.
    pub fn part<T: Stateful>(&mut self, value: &mut T) -> Taken {
        value.restore(self.0)
    }

    /// As [`Saver::clear`].
    ///
    /// # Errors
    /// It never fails; the result has the form of the other walks.
    pub fn clear<T: Default>(&mut self, value: &mut T) -> Taken {
        *value = T::default();
        Ok(())
    }

    /// As [`Saver::ensure`].
    ///
    /// # Errors
    /// It does not hold.
    pub fn ensure(&mut self, holds: bool, what: &'static str, value: u64) -> Taken {
        if holds {
            Ok(())
        } else {
            Err(StateError::Value { what, value })
        }
    }
}

/// Bits of the `k`-th part, before they are shifted to their place.
fn mask<T>(parts: &[(u32, T)], k: usize) -> u64 {
    let end = parts.get(k + 1).map_or(u64::BITS, |(shift, _)| *shift);
    u64::MAX >> (u64::BITS - (end - parts[k].0))
}

#[cfg(test)]
mod tests {
    use super::super::{SavedState, state_hash, state_size};
    use super::*;

    #[derive(Clone, Debug, Default, PartialEq)]
    struct Inner {
        way: Vector3,
        counts: (u8, u32, bool),
    }

    crate::stateful!(Inner, |this, walk| {
        let Inner { way, counts } = this;
        let (small, large, yes) = counts;
        walk.packed("counts", [(0, small), (8, large), (40, yes)])?;
        walk.vector(way)
    });

    #[derive(Clone, Debug, Default, PartialEq)]
    struct Outer {
        parts: Vec<Inner>,
        points: Vec<Point3>,
        number: f64,
        rest: Inner,
    }

    crate::stateful!(Outer, |this, walk| {
        let Outer {
            parts,
            points,
            number,
            rest,
        } = this;
        walk.constant("layout", 7)?;
        for part in parts {
            walk.part(part)?;
        }
        walk.triples(points)?;
        walk.float(number)?;
        if *number > 0.0 {
            walk.part(rest)
        } else {
            walk.clear(rest)
        }
    });

    fn outer(number: f64) -> Outer {
        let inner = |x: f64| Inner {
            way: Vector3::new(x, -x, 0.5),
            counts: (x as u8, u32::MAX, true),
        };
        Outer {
            parts: vec![inner(1.0), inner(255.0)],
            points: (0..100)
                .map(|k| Point3::new(f64::from(k), 0.25, -0.0))
                .collect(),
            number,
            rest: inner(3.0),
        }
    }

    #[test]
    fn what_is_saved_comes_back_to_the_bit_and_is_as_large_as_it_says() {
        for number in [1.5, -1.5] {
            let state = outer(number);
            let mut saved = SavedState::default();
            saved.save_from(&state);
            let size = state_size(&state);
            assert_eq!(
                [size.words, size.floats],
                [saved.words.len(), saved.floats.len()]
            );
            let mut again = outer(0.0);
            again.parts.fill(Inner::default());
            saved.restore_into(&mut again).unwrap();
            assert_eq!(state_hash(&again), state_hash(&state));
            assert_eq!(again.parts, state.parts);
            assert_eq!(again.rest == Inner::default(), number < 0.0);
        }
    }

    #[test]
    fn a_word_that_no_value_has_is_refused_by_name() {
        let mut saved = SavedState::default();
        saved.save_from(&outer(1.0));
        for (k, wrong, named) in [(0, 8, "layout"), (1, 1 << 41, "counts")] {
            let mut other = saved.clone();
            other.words[k] = wrong;
            let error = other.restore_into(&mut outer(1.0)).unwrap_err();
            assert!(error.to_string().contains(named), "{error}");
        }
        saved.words.pop();
        assert!(saved.restore_into(&mut outer(1.0)).is_err());
    }
}
