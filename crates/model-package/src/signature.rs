//! Verification of Ed25519 signatures (RFC 8032).
//!
//! `R = s B - k A` with `k = SHA-512(R, A, message)`, `s` below the group's order and `R` compared
//! as bytes. This is what `ed25519-dalek` checks, written with the curve arithmetic of the same
//! authors. Their own verification uses a table index that the compiler cannot bound, which would
//! link a panic. The arithmetic here takes constant time, although nothing on the controller is
//! secret.
//!
//! Measured in the emulator (Cortex-M4, opt-level 3): 3.04 million instructions per signature, 18
//! ms at 168 MHz.

use curve25519_dalek::edwards::{CompressedEdwardsY, EdwardsPoint};
use curve25519_dalek::scalar::Scalar;
use link::update::SIGNATURE_LENGTH;
use sha2::{Digest, Sha512};

/// Bytes of a public key.
pub const KEY_LENGTH: usize = 32;

/// Encodings of the points of small order, without the sign bit. With such a key, signatures are
/// valid that were made without a private key.
const SMALL_ORDER: [[u8; KEY_LENGTH]; 7] = [
    number(0x00, 0x00, 0x00),
    number(0x01, 0x00, 0x00),
    [
        0x26, 0xe8, 0x95, 0x8f, 0xc2, 0xb2, 0x27, 0xb0, 0x45, 0xc3, 0xf4, 0x89, 0xf2, 0xef, 0x98, 0xf0, 0xd5,
        0xdf, 0xac, 0x05, 0xd3, 0xc6, 0x33, 0x39, 0xb1, 0x38, 0x02, 0x88, 0x6d, 0x53, 0xfc, 0x05,
    ],
    [
        0xc7, 0x17, 0x6a, 0x70, 0x3d, 0x4d, 0xd8, 0x4f, 0xba, 0x3c, 0x0b, 0x76, 0x0d, 0x10, 0x67, 0x0f, 0x2a,
        0x20, 0x53, 0xfa, 0x2c, 0x39, 0xcc, 0xc6, 0x4e, 0xc7, 0xfd, 0x77, 0x92, 0xac, 0x03, 0x7a,
    ],
    number(0xec, 0xff, 0x7f),
    number(0xed, 0xff, 0x7f),
    number(0xee, 0xff, 0x7f),
];

/// Returns a number of 32 bytes from its lowest, its middle and its highest ones.
const fn number(lowest: u8, middle: u8, highest: u8) -> [u8; KEY_LENGTH] {
    let mut bytes = [middle; KEY_LENGTH];
    bytes[0] = lowest;
    bytes[KEY_LENGTH - 1] = highest;
    bytes
}

/// Decides whether a public key is a point of small order, which no private key has. The compiler
/// can evaluate it.
#[must_use]
#[expect(clippy::indexing_slicing, reason = "the indices end with the arrays")]
pub const fn is_weak(key: &[u8; KEY_LENGTH]) -> bool {
    let mut point = 0;
    while point < SMALL_ORDER.len() {
        let (mut byte, mut is_same) = (0, true);
        while byte < KEY_LENGTH {
            let mask = if byte == KEY_LENGTH - 1 { 0x7f } else { 0xff };
            is_same &= key[byte] & mask == SMALL_ORDER[point][byte];
            byte += 1;
        }
        if is_same {
            return true;
        }
        point += 1;
    }
    false
}

/// Decides whether a message was signed with the private key of a public key.
#[must_use]
pub(crate) fn is_signed(message: &[u8], signature: &[u8; SIGNATURE_LENGTH], key: &[u8; KEY_LENGTH]) -> bool {
    let ([r, s], _) = signature.as_chunks::<32>() else { return false };
    let Some(s) = Option::<Scalar>::from(Scalar::from_canonical_bytes(*s)) else { return false };
    let Some(a) = CompressedEdwardsY(*key).decompress() else { return false };
    let hash = Sha512::new().chain_update(r).chain_update(key).chain_update(message).finalize();
    let k = Scalar::from_bytes_mod_order_wide(&hash.into());
    (EdwardsPoint::mul_base(&s) - a * k).compress().0 == *r
}

#[cfg(test)]
mod tests {
    use super::*;
    use curve25519_dalek::constants::EIGHT_TORSION;
    use ed25519_dalek::{Signature, Signer, SigningKey};
    use proptest::prelude::*;

    fn bytes<const N: usize>(hex: &str) -> [u8; N] {
        core::array::from_fn(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
    }

    /// RFC 8032, section 7.1, tests 1 to 3: key, message, signature.
    const KNOWN: [(&str, &[u8], &str); 3] = [
        (
            "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a",
            &[],
            "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e06522490155\
             5fb8821590a33bacc61e39701cf9b46bd25bf5f0595bbe24655141438e7a100b",
        ),
        (
            "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c",
            &[0x72],
            "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da\
             085ac1e43e15996e458f3613d0f11d8c387b2eaeb4302aeeb00d291612bb0c00",
        ),
        (
            "fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025",
            &[0xaf, 0x82],
            "6291d657deec24024827e69c3abe01a30ce548a284743a445e3680d7db5ac3ac\
             18ff9b538d16f290ae67f760984dc6594a7c15e9716ed28dc027beceea1ec40a",
        ),
    ];

    #[test]
    fn signatures_of_the_standard_are_accepted() {
        for (key, message, signature) in KNOWN {
            assert!(is_signed(message, &bytes(signature), &bytes(key)));
            assert!(!is_signed(b"another message", &bytes(signature), &bytes(key)));
        }
    }

    /// Order of the group, little-endian (RFC 8032, section 5.1): adding it to `s` must not give a
    /// second valid signature.
    #[test]
    fn a_signature_plus_the_group_order_is_refused() {
        let (key, message, signature) = KNOWN[1];
        let mut other: [u8; 64] = bytes(signature);
        let order: [u8; 32] = bytes("edd3f55c1a631258d69cf7a2def9de1400000000000000000000000000000010");
        let mut carry = 0_u16;
        for (to, more) in other[32..].iter_mut().zip(order) {
            carry += u16::from(*to) + u16::from(more);
            *to = carry as u8;
            carry >>= 8;
        }
        assert!(!is_signed(message, &other, &bytes(key)));
    }

    #[test]
    fn exactly_the_points_of_small_order_are_weak_keys() {
        for point in EIGHT_TORSION {
            assert!(is_weak(&point.compress().0), "{point:?}");
        }
        for mut key in SMALL_ORDER {
            for sign in [0, 0x80] {
                key[KEY_LENGTH - 1] = key[KEY_LENGTH - 1] & 0x7f | sign;
                assert!(is_weak(&key));
                let point = CompressedEdwardsY(key).decompress();
                assert!(point.is_none_or(|point| point.is_small_order()), "{key:?}");
            }
        }
        assert!(KNOWN.iter().all(|(key, ..)| !is_weak(&bytes(key))));
    }

    /// An attack that makes a weak key useless: `R = s B` satisfies the equation for every
    /// message.
    #[test]
    fn a_forged_signature_is_valid_under_the_neutral_point_which_is_weak() {
        let neutral = EIGHT_TORSION[0].compress().0;
        let mut forged = [0; SIGNATURE_LENGTH];
        forged[..32].copy_from_slice(&EdwardsPoint::mul_base(&Scalar::ONE).compress().0);
        forged[32] = 1;
        assert!(is_signed(b"any message", &forged, &neutral) && is_weak(&neutral));
    }

    proptest! {
        #[test]
        fn verification_agrees_with_ed25519_dalek(
            seed: [u8; 32], message: Vec<u8>, flipped in 0..512_usize, is_flipped: bool,
        ) {
            let key = SigningKey::from_bytes(&seed);
            let mut signature = key.sign(&message).to_bytes();
            if is_flipped {
                signature[flipped / 8] ^= 1 << (flipped % 8);
            }
            let public = key.verifying_key();
            let theirs = public.verify_strict(&message, &Signature::from_bytes(&signature)).is_ok();
            prop_assert_eq!(is_signed(&message, &signature, &public.to_bytes()), theirs);
            prop_assert_eq!(theirs, !is_flipped);
        }
    }
}
