//! Single keys of a terminal, without Enter.

use std::io::Read as _;
use std::sync::OnceLock;

/// How the terminal was before.
static BEFORE: OnceLock<libc::termios> = OnceLock::new();

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
    /// Calls `take` on each key, on a thread of its own; `None` where stdin is no terminal. Ctrl-C
    /// stays a signal.
    #[allow(unsafe_code)]
    pub fn listen(mut take: impl FnMut(Key) + Send + 'static) -> Option<Self> {
        if !std::io::IsTerminal::is_terminal(&std::io::stdin()) {
            return None;
        }
        // SAFETY: a termios is plain numbers; zeros are a valid one, and it is filled before it is
        // used.
        let mut now: libc::termios = unsafe { std::mem::zeroed() };
        // SAFETY: `now` is a valid termios of our own.
        if unsafe { libc::tcgetattr(libc::STDIN_FILENO, &mut now) } != 0 {
            return None;
        }
        BEFORE.get_or_init(|| now);
        now.c_lflag &= !(libc::ICANON | libc::ECHO);
        // SAFETY: `now` is a valid termios.
        if unsafe { libc::tcsetattr(libc::STDIN_FILENO, libc::TCSANOW, &now) } != 0 {
            return None;
        }
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
    #[allow(unsafe_code)]
    pub fn restore() {
        if let Some(before) = BEFORE.get() {
            // SAFETY: `before` was read from this terminal.
            unsafe { libc::tcsetattr(libc::STDIN_FILENO, libc::TCSANOW, before) };
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
