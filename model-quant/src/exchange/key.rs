//! Key files for signing packages and for the link.
//!
//! A key file is text: lines that begin with `#` are comments, and the only other line is the
//! secret key as 64 hexadecimal digits. The public key is compiled into a firmware
//! (`PINTLE_MODEL_KEY`). A key of the link is secret in the firmware, too.

use ed25519_dalek::SigningKey;

/// Published development key, which a firmware trusts if it is built without another one.
pub const DEVELOPMENT: &str = include_str!("../../keys/development.key");

/// Reason why a text is not a key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KeyError {
    /// A wrong number of lines that are no comment; the number of such lines.
    #[error("found {0} lines that do not begin with `#`, expected one")]
    Lines(usize),
    /// Content other than 64 hexadecimal digits.
    #[error("line {line}: found {found} characters, expected 64 hexadecimal digits")]
    Digits {
        /// Line in the text, from 1.
        line: usize,
        /// Characters found.
        found: usize,
    },
}

/// Parses a key file.
///
/// # Errors
///
/// The text is not a key. The message does not repeat its content.
pub fn parse(text: &str) -> Result<SigningKey, KeyError> {
    secret(text).map(|secret| SigningKey::from_bytes(&secret))
}

/// Parses the bytes of a key file.
///
/// # Errors
///
/// As [`parse`].
pub fn secret(text: &str) -> Result<[u8; 32], KeyError> {
    let lines: Vec<_> = text
        .lines()
        .zip(1..)
        .map(|(content, line)| (content.trim(), line))
        .filter(|(content, _)| !content.is_empty() && !content.starts_with('#'))
        .collect();
    let &[(content, line)] = &lines[..] else { return Err(KeyError::Lines(lines.len())) };
    let wrong = KeyError::Digits { line, found: content.chars().count() };
    let mut secret = [0; 32];
    if content.len() != 64 || !content.is_ascii() {
        return Err(wrong);
    }
    for (byte, digits) in secret.iter_mut().zip(content.as_bytes().chunks(2)) {
        let value = std::str::from_utf8(digits).ok().and_then(|digits| u8::from_str_radix(digits, 16).ok());
        *byte = value.ok_or_else(|| wrong.clone())?;
    }
    Ok(secret)
}

/// Formats a key file.
#[must_use]
pub(crate) fn text(key: &SigningKey) -> String {
    format!(
        "# Secret half of a key for model packages: it can sign models that controllers accept.\n\
         # Public half, for PINTLE_MODEL_KEY: {}\n{}\n",
        digits(key.verifying_key().as_bytes()),
        digits(key.as_bytes())
    )
}

/// Formats a key file of a link.
#[must_use]
pub(crate) fn link_text(secret: &[u8; 32]) -> String {
    format!(
        "# Key of a link, for PINTLE_LINK_KEY and --link-key. Its owner can command the controllers that\n\
         # were built with it.\n{}\n",
        digits(secret)
    )
}

/// Formats bytes as hexadecimal digits.
#[must_use]
pub fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_survives_its_file() {
        let key = SigningKey::from_bytes(&[7; 32]);
        assert_eq!(parse(&text(&key)).expect("key").to_bytes(), key.to_bytes());
    }

    #[test]
    fn the_development_key_is_the_one_whose_public_half_stands_in_its_file() {
        let public = digits(parse(DEVELOPMENT).expect("key").verifying_key().as_bytes());
        assert!(DEVELOPMENT.contains(&public));
    }

    #[test]
    fn other_texts_are_refused_without_repeating_them() {
        assert_eq!(parse("# nothing\n"), Err(KeyError::Lines(0)));
        assert_eq!(parse(&"ab\n".repeat(2)), Err(KeyError::Lines(2)));
        let wrong = parse(&format!("# key\n{}", "gg".repeat(32))).expect_err("not digits");
        assert_eq!(wrong, KeyError::Digits { line: 2, found: 64 });
        assert!(!wrong.to_string().contains("gg"));
        assert_eq!(parse("é".repeat(32).as_str()), Err(KeyError::Digits { line: 1, found: 32 }));
    }
}
