//! Public key that must have signed a package; an input of the build.
//!
//! `PINTLE_MODEL_KEY=<64 hexadecimal digits> cargo xtask firmware` builds a firmware that trusts
//! that key only. `model-quant key` creates a pair and prints the digits. By default the firmware
//! trusts the development key, whose secret half is published with the sources
//! (`model-quant/keys/development.key`), and reports this in every [`link::update::UpdateStatus`].

use model_package::signature::KEY_LENGTH;

/// Public half of the development key.
pub const DEVELOPMENT_KEY: [u8; KEY_LENGTH] =
    digits("127ceeac7c1a6778bc27ad771f8a0b51f16c7f5bf66c29d09a021b12a2c43b18");

/// The key that this build trusts.
pub const KEY: [u8; KEY_LENGTH] = match option_env!("PINTLE_MODEL_KEY") {
    Some(text) => digits(text),
    None => DEVELOPMENT_KEY,
};

/// Reads hexadecimal digits when the firmware is compiled.
const fn digits(text: &str) -> [u8; KEY_LENGTH] {
    let text = text.as_bytes();
    assert!(text.len() == 2 * KEY_LENGTH, "PINTLE_MODEL_KEY must be 64 hexadecimal digits");
    let mut key = [0; KEY_LENGTH];
    let mut index = 0;
    #[expect(clippy::indexing_slicing, reason = "run by the compiler, which would refuse to build")]
    while index < KEY_LENGTH {
        key[index] = digit(text[2 * index]) << 4 | digit(text[2 * index + 1]);
        index += 1;
    }
    key
}

#[expect(clippy::panic, reason = "run by the compiler, which refuses to build")]
const fn digit(character: u8) -> u8 {
    match character {
        b'0'..=b'9' => character - b'0',
        b'a'..=b'f' => character - b'a' + 10,
        b'A'..=b'F' => character - b'A' + 10,
        _ => panic!("PINTLE_MODEL_KEY must be 64 hexadecimal digits"),
    }
}
