//! Buffers that the tick thread fills and other threads read.
//!
//! ```text
//! tick thread: Pool::fill ─▶ Arc<T> ═ring═▶ reader: reads, drops its Arc
//!      └─ a buffer without readers is filled again
//! ```
//! The pool keeps one reference to every buffer, so a reader never frees memory, and handing a
//! buffer to a second reader costs a count. Nothing is allocated after the start, nothing locked.

use std::sync::Arc;

/// A fixed number of buffers, filled by one thread.
#[derive(Debug)]
pub struct Pool<T> {
    buffers: Vec<Arc<T>>,
    /// Where the search for a free one begins: readers give buffers back in about the order in
    /// which they got them.
    next: usize,
}

impl<T> Pool<T> {
    /// `count` buffers.
    pub fn new(count: usize, mut make: impl FnMut() -> T) -> Self {
        Self {
            buffers: (0..count).map(|_| Arc::new(make())).collect(),
            next: 0,
        }
    }

    /// Fills a buffer that no one reads and gives it out; `None` when all are being read.
    pub fn fill(&mut self, fill: impl FnOnce(&mut T)) -> Option<&Arc<T>> {
        let count = self.buffers.len();
        let free = (0..count)
            .map(|k| (self.next + k) % count)
            .find(|&at| Arc::get_mut(&mut self.buffers[at]).is_some())?;
        self.next = free + 1;
        fill(Arc::get_mut(&mut self.buffers[free])?);
        Some(&self.buffers[free])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_is_filled_again_once_all_its_readers_are_done() {
        let mut pool = Pool::new(2, || 0);
        let first = pool.fill(|value| *value = 1).cloned().unwrap();
        let second = pool.fill(|value| *value = 2).cloned().unwrap();
        let reader = first.clone();
        assert!(pool.fill(|_| unreachable!()).is_none());
        drop(first);
        assert!(pool.fill(|_| unreachable!()).is_none(), "one still reads");
        assert_eq!((*reader, *second), (1, 2));
        drop(reader);
        assert_eq!(
            pool.fill(|value| *value += 10).map(|third| **third),
            Some(11)
        );
        assert!(Pool::new(0, || 0).fill(|_| ()).is_none());
    }

    #[test]
    fn buffers_come_back_from_another_thread_as_they_were_filled() {
        let mut pool = Pool::new(4, || vec![0; 100]);
        let (mut full, mut read) = rtrb::RingBuffer::<Arc<Vec<u64>>>::new(4);
        let reader = std::thread::spawn(move || {
            let mut seen = 0;
            while seen < 10_000 {
                let Ok(buffer) = read.pop() else {
                    std::thread::yield_now();
                    continue;
                };
                seen += 1;
                assert!(buffer.iter().all(|value| *value == seen));
            }
        });
        for k in 1..=10_000 {
            while full.slots() == 0 {
                std::thread::yield_now();
            }
            let buffer = loop {
                match pool.fill(|buffer| buffer.fill(k)) {
                    Some(buffer) => break buffer.clone(),
                    None => std::thread::yield_now(),
                }
            };
            full.push(buffer).unwrap();
        }
        reader.join().unwrap();
    }
}
