//! One declared order for everything a replay must restore: the same walk hashes, saves and
//! restores a state.

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
        fn floats(&mut self, values: &[f64]) {
            // A fixed block keeps this free of allocation and of unsafe casts.
            let mut block = [0u8; 2048];
            for chunk in values.chunks(256) {
                for (bytes, value) in block.chunks_exact_mut(8).zip(chunk) {
                    bytes.copy_from_slice(&value.to_le_bytes());
                }
                self.0.update(&block[..chunk.len() * 8]);
            }
        }
    }
    let mut hasher = Hasher(Xxh3::new());
    state.save(&mut hasher);
    hasher.0.digest()
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
