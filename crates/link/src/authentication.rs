//! Authentication of commands with a key that host and controller share.
//!
//! A controller whose firmware has a [`LinkKey`] executes a command that changes its state only
//! with a [`Tag`]: the first 16 bytes of HMAC-SHA-512 (RFC 2104, RFC 4231) over the number of the
//! controller's start and the numbered command. The number of the start is never used again, and
//! within a start a command's number is not (see [`crate::Command`]), so a recorded command has no
//! effect when it is repeated later. Commands that only read have no tag, and their numbers do not
//! count. The hello frame states the numbers of the start and of the last command with a tag, so a
//! forged frame cannot make the host sign commands for later.
//!
//! Every controller needs a separate key: with a common one, a command for one of them is valid for
//! another one that has the same numbers.
//!
//! Samples and estimates carry no tags. A package of models is signed
//! ([`crate::update`]); [`crate::Command::PermitUpdate`] lets the controller begin with it.

use hmac::{Hmac, Mac};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha512, digest::Output};

use crate::message::NumberedCommand;
use crate::update::SignedManifest;
use crate::{Command, MAX_PAYLOAD};

/// Length of a key in bytes.
pub const LINK_KEY_LENGTH: usize = 32;
/// Length of a tag in bytes.
pub const TAG_LENGTH: usize = 16;

/// Shared key of a host and one controller. Its `Debug` output does not contain it.
#[derive(Clone, Copy)]
pub struct LinkKey([u8; LINK_KEY_LENGTH]);

impl core::fmt::Debug for LinkKey {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("LinkKey")
    }
}

/// Authentication code of a command or of a hello frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tag(pub [u8; TAG_LENGTH]);

/// First bytes of the SHA-512 of a manifest. The manifest contains the hash of the package's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ManifestHash(pub [u8; TAG_LENGTH]);

/// Authentication that a controller requires.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Authentication {
    /// None: the firmware has no key.
    #[default]
    Open,
    /// Commands that change the state need a tag.
    Required {
        /// Number of the controller's start.
        start: u32,
        /// Tag of that number and of the number of the last command in the same frame.
        tag: Tag,
    },
}

impl LinkKey {
    /// Creates a key of random bytes.
    #[must_use]
    pub const fn new(bytes: [u8; LINK_KEY_LENGTH]) -> Self {
        Self(bytes)
    }

    /// Returns the tag of a hello frame: of the numbers of the start and of the last command.
    #[must_use]
    pub fn hello_tag(&self, start: u32, last_command: u32) -> Tag {
        truncated(self.mac(Purpose::Hello, start, &last_command.to_le_bytes()).finalize().into_bytes())
    }

    /// Returns the tag of a command in the start with a number; `None` if the command is longer
    /// than a frame.
    #[must_use]
    pub fn command_tag(&self, start: u32, command: &NumberedCommand) -> Option<Tag> {
        let mut buffer = [0; MAX_PAYLOAD];
        let encoded = postcard::to_slice(command, &mut buffer).ok()?;
        Some(truncated(self.mac(Purpose::Command, start, encoded).finalize().into_bytes()))
    }

    /// Decides in constant time whether a tag is that of a command in the start with a number.
    #[must_use]
    pub fn accepts(&self, start: u32, command: &NumberedCommand, tag: &Tag) -> bool {
        let mut buffer = [0; MAX_PAYLOAD];
        postcard::to_slice(command, &mut buffer).is_ok_and(|encoded| {
            self.mac(Purpose::Command, start, encoded).verify_truncated_left(&tag.0).is_ok()
        })
    }

    /// Decides in constant time whether a tag is that of a hello frame with these numbers.
    #[must_use]
    pub fn accepts_hello(&self, start: u32, last_command: u32, tag: &Tag) -> bool {
        self.mac(Purpose::Hello, start, &last_command.to_le_bytes()).verify_truncated_left(&tag.0).is_ok()
    }

    fn mac(&self, purpose: Purpose, start: u32, content: &[u8]) -> Hmac<Sha512> {
        let mut block = hmac::digest::Key::<Hmac<Sha512>>::default();
        for (to, from) in block.iter_mut().zip(self.0) {
            *to = from;
        }
        // A key shorter than a block is padded with zeros (RFC 2104).
        let mut code = <Hmac<Sha512> as hmac::digest::KeyInit>::new(&block);
        code.update(&[purpose as u8]);
        code.update(&start.to_le_bytes());
        code.update(content);
        code
    }
}

/// Purpose of a tag: one made for a purpose is not valid for another.
#[derive(Clone, Copy)]
enum Purpose {
    Hello = 1,
    Command = 2,
}

impl SignedManifest {
    /// Returns the hash that [`crate::Command::PermitUpdate`] carries.
    #[must_use]
    pub fn hash(&self) -> ManifestHash {
        ManifestHash(truncated(Sha512::digest(self.manifest.as_flattened())).0)
    }
}

impl Command {
    /// Decides whether the command changes the controller's state, so that it needs a tag.
    #[must_use]
    pub const fn changes_state(&self) -> bool {
        match self {
            Self::GetConfiguration | Self::GetCounters | Self::GetReport(_) => false,
            Self::Configure(_)
            | Self::Keep
            | Self::ClearTrip
            | Self::Stop
            | Self::SampleYourself
            | Self::PermitUpdate(_) => true,
        }
    }
}

fn truncated(hash: Output<Sha512>) -> Tag {
    let mut tag = Tag::default();
    for (to, from) in tag.0.iter_mut().zip(hash) {
        *to = from;
    }
    tag
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: LinkKey = LinkKey::new([0x5A; LINK_KEY_LENGTH]);
    const STOP: NumberedCommand = NumberedCommand { id: 7, command: Command::Stop };

    /// Tags of another implementation, `hmac.new(b"Z" * 32, message, "sha512").digest()[:16]` of
    /// Python 3, with the message of a purpose, the number of the start and the content.
    #[test]
    fn tags_are_those_of_another_implementation() {
        let command = KEY.command_tag(3, &STOP).unwrap();
        assert_eq!(u128::from_be_bytes(command.0), 0xcaec_59c3_a57f_8c35_c9c6_21fd_efb0_ddf4);
        let hello = KEY.hello_tag(3, 7);
        assert_eq!(u128::from_be_bytes(hello.0), 0x04b1_bb04_17d4_8950_7202_f871_1453_6529);
    }

    #[test]
    fn a_tag_is_valid_for_its_key_start_number_command_and_purpose_only() {
        let tag = KEY.command_tag(3, &STOP).unwrap();
        assert!(KEY.accepts(3, &STOP, &tag));
        let other_key = LinkKey::new([0x5B; LINK_KEY_LENGTH]);
        assert!(!other_key.accepts(3, &STOP, &tag));
        assert!(!KEY.accepts(4, &STOP, &tag));
        assert!(!KEY.accepts(3, &NumberedCommand { id: 8, ..STOP }, &tag));
        assert!(!KEY.accepts(3, &NumberedCommand { command: Command::Keep, ..STOP }, &tag));
        for bit in 0..8 * TAG_LENGTH {
            let mut flipped = tag;
            flipped.0[bit / 8] ^= 1 << (bit % 8);
            assert!(!KEY.accepts(3, &STOP, &flipped));
        }
        let hello = KEY.hello_tag(3, 7);
        assert!(KEY.accepts_hello(3, 7, &hello));
        assert!(!KEY.accepts_hello(4, 7, &hello) && !KEY.accepts_hello(3, 8, &hello));
        assert!(!KEY.accepts_hello(3, 7, &tag) && !KEY.accepts(3, &STOP, &hello));
    }

    #[test]
    fn a_key_is_not_shown() {
        assert_eq!(format!("{KEY:?}"), "LinkKey");
    }
}
