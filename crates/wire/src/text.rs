//! A short text of fixed size, fit for shared memory.

use iceoryx2::prelude::ZeroCopySend;

/// One line of up to `N` bytes of UTF-8, padded with zeros. What does not fit is cut at a character, and control
/// characters, which could disturb a terminal, become spaces.
#[derive(Clone, Copy, PartialEq, Eq, ZeroCopySend)]
#[repr(C)]
pub struct Text<const N: usize> {
    bytes: [u8; N],
}

impl<const N: usize> Text<N> {
    /// The text, as much of it as fits.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let mut end = text.len().min(N);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let mut bytes = [0; N];
        bytes[..end].copy_from_slice(&text.as_bytes()[..end]);
        // Those of one byte, that is; in UTF-8 they are never a part of another character.
        bytes[..end].iter_mut().filter(|byte| byte.is_ascii_control()).for_each(|byte| *byte = b' ');
        Self { bytes }
    }

    /// The text. Bytes that are not UTF-8, which only a foreign writer can leave, end it.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let end = self.bytes.iter().position(|b| *b == 0).unwrap_or(N);
        match std::str::from_utf8(&self.bytes[..end]) {
            Ok(text) => text,
            Err(error) => std::str::from_utf8(&self.bytes[..error.valid_up_to()]).unwrap_or_default(),
        }
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self { bytes: [0; N] }
    }
}

impl<const N: usize> std::fmt::Debug for Text<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_at_a_character_and_survives_foreign_bytes() {
        assert_eq!(Text::<8>::new("whirl").as_str(), "whirl");
        assert_eq!(Text::<4>::new("abcé").as_str(), "abc");
        assert_eq!(Text::<5>::new("abcé").as_str(), "abcé");
        assert_eq!(Text::<8>::new("a\nb\u{1b}[").as_str(), "a b [");
        assert_eq!(Text::<3> { bytes: [b'a', 0xff, b'b'] }.as_str(), "a");
    }
}
