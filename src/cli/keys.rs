//! Single keys of a terminal, without Enter.
//!
//! The crate `console` sets the terminal back only after a key, so a program that ends meanwhile
//! would leave it as it is.

use rustix::stdio::stdin;
use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcsetattr};
use std::io::Read as _;
use std::sync::OnceLock;

/// How the terminal was before.
static BEFORE: OnceLock<Termios> = OnceLock::new();

/// A key that means something to us.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A letter or the space bar.
    Letter(u8),
    /// Arrow.
    Up,
    /// Arrow.
    Down,
    /// Arrow.
    Left,
    /// Arrow.
    Right,
}

/// Puts the terminal back when dropped.
pub struct Keys;

impl Keys {
    /// Calls `take` on each key, on a thread of its own; `None` where stdin is not a terminal. Ctrl-C
    /// stays a signal.
    pub fn listen(mut take: impl FnMut(Key) + Send + 'static) -> Option<Self> {
        // Only a terminal has modes.
        let mut now = tcgetattr(stdin()).ok()?;
        BEFORE.get_or_init(|| now.clone());
        now.local_modes
            .remove(LocalModes::ICANON | LocalModes::ECHO);
        tcsetattr(stdin(), OptionalActions::Now, &now).ok()?;
        let listener = move || {
            let mut bytes = [0; 16];
            while let Ok(count) = std::io::stdin().lock().read(&mut bytes) {
                if count == 0 {
                    break;
                }
                keys(&bytes[..count]).for_each(&mut take);
            }
        };
        std::thread::Builder::new()
            .name("palpate-keys".into())
            .spawn(listener)
            .ok()?;
        Some(Self)
    }

    /// Puts the terminal back.
    pub fn restore() {
        if let Some(before) = BEFORE.get() {
            // A terminal that has gone away needs nothing.
            let _ = tcsetattr(stdin(), OptionalActions::Now, before);
        }
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        Self::restore();
    }
}

/// Arrows are three bytes: escape, bracket, letter.
fn keys(mut bytes: &[u8]) -> impl Iterator<Item = Key> + '_ {
    std::iter::from_fn(move || {
        let (key, used) = match bytes {
            [] => return None,
            [0x1b, b'[' | b'O', b'A', ..] => (Key::Up, 3),
            [0x1b, b'[' | b'O', b'B', ..] => (Key::Down, 3),
            [0x1b, b'[' | b'O', b'C', ..] => (Key::Right, 3),
            [0x1b, b'[' | b'O', b'D', ..] => (Key::Left, 3),
            [letter, ..] => (Key::Letter(*letter), 1),
        };
        bytes = &bytes[used..];
        Some(key)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_and_letters_are_told_apart() {
        let read: Vec<Key> = keys(b" \x1b[Cq\x1b[A\x1bOD").collect();
        assert_eq!(
            read,
            [
                Key::Letter(b' '),
                Key::Right,
                Key::Letter(b'q'),
                Key::Up,
                Key::Left
            ]
        );
    }
}
