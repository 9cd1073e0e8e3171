//! Check of the commands that change the state, for a firmware with a key of the link.
//!
//! The check runs outside the lock of the session, because it takes longer than a tick may wait.

use link::authentication::{Authentication, LINK_KEY_LENGTH, LinkKey, ManifestHash};
use link::update::SignedManifest;
use link::{Command, NumberedCommand, Refusal, ToController};

use crate::store::key::{is_hexadecimal, key_at};

/// Key that this build requires; none by default. It is an input of the build, as
/// [`crate::store::key`]: `PINTLE_LINK_KEY=<64 hexadecimal digits> cargo xtask firmware`. Any
/// reader of the image has the key.
pub const LINK_KEY: Option<LinkKey> = match option_env!("PINTLE_LINK_KEY") {
    Some(text) => Some(LinkKey::new(given(text.as_bytes()))),
    None => None,
};

/// Reads a key when the firmware is compiled. A wrong one stops the build.
const fn given(text: &[u8]) -> [u8; LINK_KEY_LENGTH] {
    assert!(
        text.len() == 2 * LINK_KEY_LENGTH && is_hexadecimal(text),
        "PINTLE_LINK_KEY must be a key of 64 hexadecimal digits"
    );
    key_at(text, 0)
}

/// State of the check.
#[derive(Debug)]
pub struct CommandGuard {
    key: LinkKey,
    /// Number of this start.
    start: u32,
    /// True once that number is kept, so that no later start has it.
    is_start_kept: bool,
    /// Package that an update may begin with.
    permitted: Option<ManifestHash>,
}

impl CommandGuard {
    /// Creates the check. `last_start` is the number that was kept last, 0 at first.
    #[must_use]
    pub const fn new(key: LinkKey, last_start: u32) -> Self {
        Self { key, start: last_start.saturating_add(1), is_start_kept: false, permitted: None }
    }

    /// Returns the requirement for the hello frame.
    #[must_use]
    pub fn requirement(&self) -> Authentication {
        Authentication::Required { start: self.start, tag: self.key.start_tag(self.start) }
    }

    /// Decides whether a message may be served. Before the first command of a start `keep` keeps
    /// the start's number; without power until then, the next start has the same number, and no
    /// command with it has been executed.
    ///
    /// # Errors
    ///
    /// The command changes the state and has no valid tag, or the start's number was not kept.
    pub fn admit(
        &mut self,
        message: &ToController,
        keep: impl FnOnce(u32) -> bool,
    ) -> Result<(), (u32, Refusal)> {
        let (NumberedCommand { id, command }, is_valid) = match message {
            ToController::Command(numbered) => (numbered, false),
            ToController::Authenticated(numbered, tag) => {
                (numbered, self.key.accepts(self.start, numbered, tag))
            }
            _ => return Ok(()),
        };
        if !command.changes_state() {
            return Ok(());
        }
        if !is_valid {
            return Err((*id, Refusal::NotAuthenticated));
        }
        self.is_start_kept = self.is_start_kept || keep(self.start);
        if self.is_start_kept { Ok(()) } else { Err((*id, Refusal::NotKept)) }
    }

    /// Notes that a command was executed.
    pub(super) const fn note_executed(&mut self, command: &Command) {
        if let Command::PermitUpdate(manifest) = command {
            self.permitted = Some(*manifest);
        }
    }

    /// Decides whether an update may begin with a package.
    pub(super) fn is_permitted(&self, package: &SignedManifest) -> bool {
        self.permitted == Some(package.hash())
    }

    /// Notes that the permitted package is installed.
    pub(super) const fn note_installed(&mut self) {
        self.permitted = None;
    }
}
