//! Verification of Ed25519 signatures (RFC 8032).
//!
//! `R = s B - k A` with `k = SHA-512(R, A, message)`, `s` below the group's order and `R` compared
//! as bytes. This is what `ed25519-dalek` checks, written with the curve arithmetic of the same
//! authors. Their own verification uses a table index that the compiler cannot bound, which would
//! link a panic. The arithmetic here takes constant time, although nothing on the controller is
//! secret.
//!
//! Measured in the emulator (Cortex-M4, opt-level 3): 3.04 million instructions per signature, 18
//! ms at 168 MHz; 57 KB of flash.

use curve25519_dalek::edwards::{CompressedEdwardsY, EdwardsPoint};
use curve25519_dalek::scalar::Scalar;
use link::update::SIGNATURE_LENGTH;
use sha2::{Digest, Sha512};

/// Bytes of a public key.
pub const KEY_LENGTH: usize = 32;

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
