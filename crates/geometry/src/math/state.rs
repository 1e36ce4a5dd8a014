//! What a replay must restore: saved, hashed, measured and restored in one declared order, which
//! [`stateful!`](crate::stateful) writes down once for a type.

use xxhash_rust::xxh3::Xxh3;

/// Takes a state apart, in declared order.
pub trait StateSink {
    /// An integer, flag or count.
    fn word(&mut self, word: u64);
    /// Floating state, bit for bit.
    fn floats(&mut self, values: &[f64]);
}

/// Puts a state together again, in the same order.
pub trait StateSource {
    /// The next integer.
    ///
    /// # Errors
    /// The source has ended.
    fn word(&mut self) -> Result<u64, StateError>;
    /// The next floats, as many as `out` holds.
    ///
    /// # Errors
    /// The source has ended.
    fn floats(&mut self, out: &mut [f64]) -> Result<(), StateError>;
}

/// A saved state that does not fit the scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// Too short, or longer than the scene's state.
    #[error(
        "the saved state does not fit this scene: it has {words} words and {floats} floats, the scene reads others"
    )]
    Size {
        /// Words of the source.
        words: usize,
        /// Floats of the source.
        floats: usize,
    },
    /// A value that this scene cannot hold.
    #[error("the saved state holds an impossible {what}: {value}")]
    Value {
        /// Name of the quantity.
        what: &'static str,
        /// The value given.
        value: u64,
    },
}

/// What can be hashed, saved and restored.
pub trait Stateful {
    /// Everything, in declared order.
    fn save(&self, sink: &mut impl StateSink);
    /// Reads in the order of [`Stateful::save`].
    ///
    /// # Errors
    /// The source is too short or holds an impossible value; `self` is then partly overwritten.
    fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError>;
}

/// 64-bit hash (XXH3) of all bits of a state.
pub fn state_hash(state: &impl Stateful) -> u64 {
    struct Hasher(Xxh3);
    impl StateSink for Hasher {
        fn word(&mut self, word: u64) {
            self.0.update(&word.to_le_bytes());
        }
        #[cfg(target_endian = "little")]
        fn floats(&mut self, values: &[f64]) {
            self.0.update(bytemuck::cast_slice(values));
        }
        #[cfg(target_endian = "big")]
        fn floats(&mut self, values: &[f64]) {
            for value in values {
                self.0.update(&value.to_le_bytes());
            }
        }
    }
    let mut hasher = Hasher(Xxh3::new());
    state.save(&mut hasher);
    hasher.0.digest()
}

/// How much there is of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StateSize {
    /// The integers of the state, in the order in which they were saved.
    pub words: usize,
    /// The floating-point numbers of the state, in the order in which they were saved.
    pub floats: usize,
}

impl StateSink for StateSize {
    fn word(&mut self, _word: u64) {
        self.words += 1;
    }
    fn floats(&mut self, values: &[f64]) {
        self.floats += values.len();
    }
}

/// How much there is of a state: what [`SavedState::save_from`] makes of it.
pub fn state_size(state: &impl Stateful) -> StateSize {
    let mut size = StateSize::default();
    state.save(&mut size);
    size
}

/// A saved state: integers and floats apart, each in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SavedState {
    /// Integer values.
    pub words: Vec<u64>,
    /// Floating-point values.
    pub floats: Vec<f64>,
}

impl SavedState {
    /// An empty one that takes in a state of this size without growing.
    pub fn with_capacity(size: StateSize) -> Self {
        Self {
            words: Vec::with_capacity(size.words),
            floats: Vec::with_capacity(size.floats),
        }
    }

    /// Overwrites `self`; allocates only while it grows.
    pub fn save_from(&mut self, state: &impl Stateful) {
        self.words.clear();
        self.floats.clear();
        state.save(self);
    }

    /// Restores a state.
    ///
    /// # Errors
    /// Sizes that do not fit, or an impossible value.
    pub fn restore_into(&self, state: &mut impl Stateful) -> Result<(), StateError> {
        let mut reader = StateReader {
            saved: self,
            word: 0,
            float: 0,
        };
        state.restore(&mut reader)?;
        if reader.word != self.words.len() || reader.float != self.floats.len() {
            return Err(reader.size_error());
        }
        Ok(())
    }
}

impl StateSink for SavedState {
    fn word(&mut self, word: u64) {
        self.words.push(word);
    }
    fn floats(&mut self, values: &[f64]) {
        self.floats.extend_from_slice(values);
    }
}

struct StateReader<'a> {
    saved: &'a SavedState,
    word: usize,
    float: usize,
}

impl StateReader<'_> {
    fn size_error(&self) -> StateError {
        StateError::Size {
            words: self.saved.words.len(),
            floats: self.saved.floats.len(),
        }
    }
}

impl StateSource for StateReader<'_> {
    fn word(&mut self) -> Result<u64, StateError> {
        let word = self
            .saved
            .words
            .get(self.word)
            .copied()
            .ok_or_else(|| self.size_error())?;
        self.word += 1;
        Ok(word)
    }
    fn floats(&mut self, out: &mut [f64]) -> Result<(), StateError> {
        let end = self.float + out.len();
        let values = self
            .saved
            .floats
            .get(self.float..end)
            .ok_or_else(|| self.size_error())?;
        out.copy_from_slice(values);
        self.float = end;
        Ok(())
    }
}
