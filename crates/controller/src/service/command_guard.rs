//! Check of the commands that change the state, for a firmware with a key of the link.
//!
//! The check runs outside the lock of the session, because it takes longer than a tick may wait.

use link::authentication::{Authentication, LINK_KEY_LENGTH, LinkKey, ManifestHash};
use link::update::UpdateRequest;
use link::{NumberedCommand, Refusal, ToController};

use crate::store::key::{is_hexadecimal, key_at};

/// Key that this build requires; none by default. It is an input of the build, as
/// [`crate::store::key`]: `PINTLE_LINK_KEY=<64 hexadecimal digits> cargo xtask firmware`. Any
/// reader of the image has the key.
pub const LINK_KEY: Option<LinkKey> = match option_env!("PINTLE_LINK_KEY") {
    Some(text) => Some(LinkKey::new(parsed(text.as_bytes()))),
    None => None,
};

/// Reads a key when the firmware is compiled. A wrong one stops the build.
const fn parsed(text: &[u8]) -> [u8; LINK_KEY_LENGTH] {
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
    /// Number of this start; `None` if it could not be kept, so that a later start may have it.
    start: Option<u32>,
    /// Package that an update may begin with.
    permitted: Option<ManifestHash>,
    /// Number of the command that permitted it.
    permitted_by: u32,
}

impl CommandGuard {
    /// Creates the check for a start with this number.
    #[must_use]
    pub const fn new(key: LinkKey, start: Option<u32>) -> Self {
        Self { key, start, permitted: None, permitted_by: 0 }
    }

    /// Returns the requirement for a hello frame with this number of the last command.
    #[must_use]
    pub fn requirement(&self, last_command: u32) -> Authentication {
        let start = self.start.unwrap_or(0);
        Authentication::Required { start, tag: self.key.hello_tag(start, last_command) }
    }

    /// Decides whether a message may be served.
    ///
    /// # Errors
    ///
    /// The command changes the state and has no valid tag, or the start's number is not kept. The
    /// number of the command is returned with the reason.
    pub fn admit(&self, message: &ToController) -> Result<(), (u32, Refusal)> {
        let (NumberedCommand { id, command }, tag) = match message {
            ToController::Command(numbered) => (numbered, None),
            ToController::Authenticated(numbered, tag) => (numbered, Some((numbered, tag))),
            _ => return Ok(()),
        };
        if !command.changes_state() {
            return Ok(());
        }
        let start = self.start.ok_or((*id, Refusal::NotKept))?;
        let is_valid = tag.is_some_and(|(numbered, tag)| self.key.accepts(start, numbered, tag));
        if is_valid { Ok(()) } else { Err((*id, Refusal::NotAuthenticated)) }
    }

    /// Notes the package that a command has permitted. Returns true if another one was permitted
    /// before. The repetition of a command permits nothing.
    pub(super) fn note_permission(&mut self, id: u32, package: ManifestHash) -> bool {
        if self.permitted_by == id {
            return false;
        }
        self.permitted_by = id;
        self.permitted.replace(package).is_some_and(|before| before != package)
    }

    /// Decides whether a request about models may be served.
    pub(super) fn permits(&self, request: &UpdateRequest) -> bool {
        match request {
            UpdateRequest::Begin(package) => self.permitted == Some(package.hash()),
            UpdateRequest::Chunk(_) | UpdateRequest::Finish | UpdateRequest::Abort => {
                self.permitted.is_some()
            }
            UpdateRequest::Status | UpdateRequest::Refusals { .. } => true,
        }
    }

    /// Ends the permission.
    pub(super) const fn end_permission(&mut self) {
        self.permitted = None;
    }
}
