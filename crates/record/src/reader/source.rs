//! Bytes of a recording by their offset, from a file or from memory.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Where the bytes of a recording are. Several threads may read at once.
#[derive(Debug)]
pub(super) enum Source {
    /// A file; its length is that at the moment of opening, so that one that is still being written
    /// ends where it ended then.
    File { file: Mutex<File>, len: u64 },
    /// All bytes.
    Memory(Arc<[u8]>),
}

impl Source {
    /// Opens a file. What is not a regular file, for example a pipe, is read to its end.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mut file = File::open(path)?;
        let metadata = file.metadata()?;
        if metadata.is_file() {
            let len = metadata.len();
            return Ok(Self::File {
                file: Mutex::new(file),
                len,
            });
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        Ok(Self::Memory(bytes.into()))
    }

    /// Length, bytes.
    pub fn len(&self) -> u64 {
        match self {
            Self::File { len, .. } => *len,
            Self::Memory(bytes) => bytes.len() as u64,
        }
    }

    /// Fills `buffer` from offset `at` on.
    ///
    /// # Errors
    /// The range does not lie within the recording, or the disk refuses.
    pub fn fill(&self, at: u64, buffer: &mut [u8]) -> io::Result<()> {
        let end = at.checked_add(buffer.len() as u64);
        if end.is_none_or(|end| end > self.len()) {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        match self {
            Self::File { file, .. } => {
                // Each reader seeks first: what a thread that panicked left does not matter.
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                file.seek(SeekFrom::Start(at))?;
                file.read_exact(buffer)
            }
            Self::Memory(bytes) => {
                let at = at as usize;
                buffer.copy_from_slice(&bytes[at..at + buffer.len()]);
                Ok(())
            }
        }
    }

    /// `len` bytes from offset `at` on. Callers bound `len`; memory is taken only for bytes that
    /// are there.
    ///
    /// # Errors
    /// As [`Source::fill`].
    pub fn read(&self, at: u64, len: usize) -> io::Result<Vec<u8>> {
        if at
            .checked_add(len as u64)
            .is_none_or(|end| end > self.len())
        {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let mut bytes = vec![0; len];
        self.fill(at, &mut bytes)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_and_memory_give_equal_bytes_and_nothing_beyond_their_end() {
        let path = std::env::temp_dir().join(format!("palpate-source-{}", std::process::id()));
        std::fs::write(&path, b"0123456789").unwrap();
        let sources = [
            Source::open(&path).unwrap(),
            Source::Memory(b"0123456789"[..].into()),
        ];
        std::fs::remove_file(&path).unwrap();
        for source in sources {
            assert_eq!(source.len(), 10);
            assert_eq!(source.read(3, 4).unwrap(), b"3456");
            assert_eq!(source.read(10, 0).unwrap(), b"");
            for (at, len) in [(3, 8), (11, 0), (u64::MAX, 1), (0, usize::MAX)] {
                assert!(source.read(at, len).is_err(), "{at} {len}");
            }
        }
    }
}
