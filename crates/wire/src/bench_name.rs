//! The name of a bench, which becomes part of service names and of file names.

use std::fmt;
use std::str::FromStr;

use crate::WireError;

/// 1 to 32 of `a-z A-Z 0-9 - _ .`, the first of them a letter or digit.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BenchName(String);

impl BenchName {
    /// The longest name, in characters.
    pub const MAX_LEN: usize = 32;

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Default for BenchName {
    /// The bench of those who name none: `default`.
    fn default() -> Self {
        Self("default".to_owned())
    }
}

impl fmt::Display for BenchName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

impl FromStr for BenchName {
    type Err = WireError;

    fn from_str(typed: &str) -> Result<Self, WireError> {
        let fits = (1..=Self::MAX_LEN).contains(&typed.len())
            && typed.starts_with(|c: char| c.is_ascii_alphanumeric())
            && typed.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c));
        if fits { Ok(Self(typed.to_owned())) } else { Err(WireError::BenchName(typed.to_owned())) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_and_plain() {
        for good in ["a", "default", "rig-2.b_c", "0"] {
            assert_eq!(good.parse::<BenchName>().unwrap().as_str(), good);
        }
        for bad in ["", "-a", ".", "a/b", "a b", "é", &"x".repeat(33)] {
            let told = bad.parse::<BenchName>().unwrap_err().to_string();
            assert!(told.contains("expected 1 to 32"), "{told}");
        }
    }
}
