//! What became of messages that adapters took from other programs.

use std::sync::{Arc, Mutex, PoisonError};

/// What came of messages that an adapter took from other programs: tool, what became of them, how many.
pub type AdapterCount = (String, &'static str, u64);

type Source = Box<dyn Fn() -> Vec<AdapterCount> + Send>;

/// Counters of adapters, which come and go while the bus runs.
#[derive(Clone, Default)]
pub struct AdapterCounts(Arc<Mutex<Vec<Source>>>);

impl AdapterCounts {
    /// Adds counters; `read` is called ten times a second.
    pub fn add(&self, read: impl Fn() -> Vec<AdapterCount> + Send + 'static) {
        let mut sources = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        sources.push(Box::new(read));
    }

    /// All of them now.
    pub fn read(&self) -> Vec<AdapterCount> {
        let sources = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        sources.iter().flat_map(|read| read()).collect()
    }
}
