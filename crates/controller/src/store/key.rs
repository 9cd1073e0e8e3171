//! Public keys of which one must have signed a package; an input of the build.
//!
//! `PINTLE_MODEL_KEY=<64 hexadecimal digits> cargo xtask firmware` builds a firmware that trusts
//! that key only; two keys are separated by a comma, the older first. `model-quant key` creates
//! a pair and prints the digits. By default the firmware trusts the development key, whose secret
//! half is published with the sources (`model-quant/keys/development.key`), and reports this in
//! every [`link::update::UpdateStatus`].
//!
//! A second key is for the day when the first one is lost or known to others: a package that is
//! signed with the second one can revoke the first one ([`super::Trust`]).

use model_package::signature::{KEY_LENGTH, is_weak};

/// Public half of the development key.
pub const DEVELOPMENT_KEY: [u8; KEY_LENGTH] =
    key_at(b"127ceeac7c1a6778bc27ad771f8a0b51f16c7f5bf66c29d09a021b12a2c43b18", 0);

/// Maximum number of keys. A package is checked against each, and two checks at the lowest clock
/// (16 MHz, 0.2 s each) fit between two check-ins of the link.
pub const MAX_KEYS: usize = 2;

/// The keys that this build trusts, the older first.
pub const KEYS: &[[u8; KEY_LENGTH]] = LISTED.0.split_at(LISTED.1).0;

const LISTED: ([[u8; KEY_LENGTH]; MAX_KEYS], usize) = match option_env!("PINTLE_MODEL_KEY") {
    Some(text) => listed(text.as_bytes()),
    None => ([DEVELOPMENT_KEY; MAX_KEYS], 1),
};

/// Characters of a key.
const DIGITS: usize = 2 * KEY_LENGTH;

/// Reads a list of keys when the firmware is compiled. A wrong or weak key stops the build.
const fn listed(text: &[u8]) -> ([[u8; KEY_LENGTH]; MAX_KEYS], usize) {
    let count = (text.len() + 1) / (DIGITS + 1);
    assert!(
        count >= 1 && count <= MAX_KEYS && text.len() == count * (DIGITS + 1) - 1,
        "PINTLE_MODEL_KEY must be one or two keys of 64 hexadecimal digits, separated by a comma"
    );
    let mut keys = [[0; KEY_LENGTH]; MAX_KEYS];
    let mut index = 0;
    #[expect(clippy::indexing_slicing, reason = "run by the compiler, which would refuse to build")]
    while index < count {
        let start = index * (DIGITS + 1);
        assert!(index == 0 || text[start - 1] == b',', "the keys of PINTLE_MODEL_KEY need a comma");
        keys[index] = key_at(text, start);
        assert!(
            !is_weak(&keys[index]),
            "PINTLE_MODEL_KEY contains a point of small order: anyone can sign for such a key"
        );
        index += 1;
    }
    assert!(count < 2 || !is_same(&keys[0], &keys[1]), "PINTLE_MODEL_KEY lists one key twice");
    (keys, count)
}

/// Compares two keys.
const fn is_same(a: &[u8; KEY_LENGTH], b: &[u8; KEY_LENGTH]) -> bool {
    let mut index = 0;
    #[expect(clippy::indexing_slicing, reason = "run by the compiler, which would refuse to build")]
    while index < KEY_LENGTH {
        if a[index] != b[index] {
            return false;
        }
        index += 1;
    }
    true
}

/// Reads a key of hexadecimal digits.
pub(crate) const fn key_at(text: &[u8], start: usize) -> [u8; KEY_LENGTH] {
    let mut key = [0; KEY_LENGTH];
    let mut index = 0;
    #[expect(clippy::indexing_slicing, reason = "run by the compiler, which would refuse to build")]
    while index < KEY_LENGTH {
        key[index] = digit(text[start + 2 * index]) << 4 | digit(text[start + 2 * index + 1]);
        index += 1;
    }
    key
}

/// Decides whether a text consists of hexadecimal digits.
pub(crate) const fn is_hexadecimal(text: &[u8]) -> bool {
    let mut index = 0;
    #[expect(clippy::indexing_slicing, reason = "the index ends with the text")]
    while index < text.len() {
        if !text[index].is_ascii_hexdigit() {
            return false;
        }
        index += 1;
    }
    true
}

#[expect(clippy::panic, reason = "run by the compiler, which refuses to build")]
const fn digit(character: u8) -> u8 {
    match character {
        b'0'..=b'9' => character - b'0',
        b'a'..=b'f' => character - b'a' + 10,
        b'A'..=b'F' => character - b'A' + 10,
        _ => panic!("PINTLE_MODEL_KEY must consist of hexadecimal digits"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OTHER: &str = "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a";

    #[test]
    fn a_list_of_keys_is_read_in_its_order() {
        let (keys, count) = listed(format!("{OTHER},{}", OTHER.replace('d', "E")).as_bytes());
        assert_eq!((count, keys[0][0], keys[1][0], keys[1][31]), (2, 0xd7, 0xe7, 0x1a));
        assert_eq!(listed(OTHER.as_bytes()).1, 1);
    }

    #[test]
    fn wrong_and_weak_keys_stop_the_build() {
        let identity = format!("01{:062}", 0);
        for text in [
            String::new(),
            OTHER[1..].into(),
            format!("{OTHER};{OTHER}"),
            format!("{OTHER},"),
            format!("{OTHER},{}", OTHER.to_uppercase()),
            [OTHER, &OTHER.replace('d', "e"), &OTHER.replace('d', "f")].join(","),
            OTHER.replace('d', "g"),
            identity,
            format!("{OTHER},{:064}", 0),
        ] {
            assert!(std::panic::catch_unwind(|| listed(text.as_bytes())).is_err(), "{text}");
        }
    }
}
