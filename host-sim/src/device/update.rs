//! Transfer of a model package to a controller: begin, chunks, finish, over a line that may lose
//! frames.
//!
//! The next step depends only on the controller's last answer. A lost answer or a restart of the
//! controller or of this program therefore costs only repetitions. Attempts without progress are
//! limited; a refusal ends the update with the controller's reason.

use crate::controller::{ControllerError, RemoteController};
use link::update::{
    CHUNK_LENGTH, ModelSource, Receiving, RefusedPackage, UpdateAnswer, UpdateChunk, UpdateRefusal,
    UpdateRequest, UpdateStatus,
};
use model_quant::exchange::package::Package;

/// Maximum number of consecutive attempts without progress.
pub(crate) const ATTEMPTS: u32 = 5;

/// A connection that can ask a controller about models.
pub trait Ask {
    /// Sends a request and returns the answer.
    fn ask(&mut self, request: UpdateRequest) -> Result<UpdateAnswer, ControllerError>;
}

impl Ask for RemoteController {
    fn ask(&mut self, request: UpdateRequest) -> Result<UpdateAnswer, ControllerError> {
        self.update(request)
    }
}

/// Why an update failed.
#[derive(Debug, thiserror::Error)]
pub enum UpdateError {
    /// The controller refused the package.
    #[error("the controller refused the package: {0}")]
    Refused(UpdateRefusal),
    /// The line or the controller failed.
    #[error(
        "{0}; {ATTEMPTS} attempts without progress. What was sent is kept: \
         repeat the command to continue"
    )]
    Line(ControllerError),
    /// The controller refused the permission, or has another key.
    #[error(transparent)]
    NotPermitted(ControllerError),
    /// Requests were answered, but the update did not progress.
    #[error(
        "the update made no progress within {ATTEMPTS} attempts, the last at offset {next_offset} of {length}"
    )]
    Stuck {
        /// Offset of the next bytes.
        next_offset: u32,
        /// Total number of bytes.
        length: u32,
    },
}

/// Result of an update.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Updated {
    /// Status before.
    pub before: UpdateStatus,
    /// Status after.
    pub after: UpdateStatus,
    /// Bytes sent, repetitions included; 0 if the package was already running.
    pub sent_bytes: u32,
    /// Offset at which an interrupted update was resumed.
    pub resumed_at: u32,
    /// Repeated attempts.
    pub repeated: u32,
}

/// Transfers a package to a controller. `progress` receives the number of bytes that have arrived.
///
/// # Errors
///
/// The controller refuses the package, or the line fails too often.
pub fn update(
    line: &mut impl Ask,
    package: &Package,
    mut progress: impl FnMut(u32),
) -> Result<Updated, UpdateError> {
    let (mut request, mut before, mut resumed_at) = (UpdateRequest::Status, None, None);
    // Consecutive answers without progress, and consecutive requests without an answer.
    let (mut idle, mut lost) = (0, 0);
    let (mut sent_bytes, mut repeated) = (0, 0);
    let mut furthest: Option<Receiving> = None;
    let mut failed = None;
    while idle < ATTEMPTS && lost < ATTEMPTS {
        let status = match line.ask(request) {
            Ok(UpdateAnswer::Status(status)) => status,
            // The written bytes differ from the sent ones: erase the slot and start again. The same
            // after an update that the controller forgot.
            Ok(UpdateAnswer::Refused(
                UpdateRefusal::Hash | UpdateRefusal::NotBegun | UpdateRefusal::Unfinished { .. },
            )) => {
                (idle, repeated, request) = (idle + 1, repeated + 1, UpdateRequest::Begin(package.signed));
                lost = 0;
                continue;
            }
            Ok(UpdateAnswer::Refused(reason)) => return Err(UpdateError::Refused(reason)),
            Ok(UpdateAnswer::Record(_)) => continue,
            Err(
                error @ (ControllerError::Refused(_)
                | ControllerError::WrongKey
                | ControllerError::NeedlessKey),
            ) => {
                return Err(UpdateError::NotPermitted(error));
            }
            Err(error) => {
                (lost, repeated, request) = (lost + 1, repeated + 1, UpdateRequest::Status);
                failed = Some(error);
                continue;
            }
        };
        let before = *before.get_or_insert(status);
        if runs(&status, package) {
            let resumed_at = resumed_at.unwrap_or(0);
            return Ok(Updated { before, after: status, sent_bytes, resumed_at, repeated });
        }
        (failed, lost) = (None, 0);
        request = match status.receiving {
            Some(receiving) if receiving.version == package.manifest.version => {
                resumed_at.get_or_insert(receiving.next_offset);
                progress(receiving.next_offset);
                let moved = furthest.is_none_or(|before| receiving.next_offset > before.next_offset);
                idle = if moved { 0 } else { idle + 1 };
                furthest = if moved { Some(receiving) } else { furthest };
                if receiving.next_offset < receiving.length {
                    sent_bytes += CHUNK_LENGTH as u32;
                    chunk(package, receiving.next_offset)
                } else {
                    UpdateRequest::Finish
                }
            }
            _ => {
                idle += 1;
                UpdateRequest::Begin(package.signed)
            }
        };
    }
    let (next_offset, length) =
        furthest.map_or((0, package.manifest.length()), |furthest| (furthest.next_offset, furthest.length));
    Err(failed.map_or(UpdateError::Stuck { next_offset, length }, UpdateError::Line))
}

/// Returns the refused packages that the controller remembers, newest first.
///
/// # Errors
///
/// The line failed.
pub fn refusals(line: &mut impl Ask) -> Result<Vec<RefusedPackage>, ControllerError> {
    let mut records = Vec::new();
    for index in 0..link::update::REFUSALS as u8 {
        match line.ask(UpdateRequest::Refusals { index })? {
            UpdateAnswer::Record(Some(record)) => records.push(record),
            _ => break,
        }
    }
    Ok(records)
}

/// Decides whether a package is the running one.
pub fn runs(status: &UpdateStatus, package: &Package) -> bool {
    let [a, b, c, d, ..] = package.manifest.hash;
    matches!(status.running, ModelSource::Slot { version, hash, .. }
        if version == package.manifest.version && hash == [a, b, c, d])
}

fn chunk(package: &Package, offset: u32) -> UpdateRequest {
    let mut bytes = [[0; 32]; CHUNK_LENGTH / 32];
    let rest = package.payload.get(offset as usize..).unwrap_or_default();
    for (to, from) in bytes.as_flattened_mut().iter_mut().zip(rest) {
        *to = *from;
    }
    UpdateRequest::Chunk(UpdateChunk { offset, bytes })
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::{BearingMaterial, shipped};
    use link::Refusal;
    use link::update::ModelMemory;
    use model_quant::exchange::package::PackageProperties;
    use model_quant::quantise::image::AlignedImage;
    use proptest::prelude::*;

    fn package() -> Package {
        let key = model_quant::exchange::key::parse(model_quant::exchange::key::DEVELOPMENT).expect("key");
        let purpose =
            PackageProperties { board: 0x0405, version: 3, may_be_older: false, revokes_older_keys: false };
        Package::new(purpose, &[AlignedImage::copy(shipped(BearingMaterial::Babbitt))], &key)
            .expect("package")
    }

    /// A simulated controller on a line that loses the given requests and answers.
    struct Fake {
        package: Package,
        status: UpdateStatus,
        received: Vec<u8>,
        loses: Vec<bool>,
        asked: usize,
        refuses: Option<UpdateRefusal>,
        requires_key: bool,
    }

    fn fake(loses: Vec<bool>) -> Fake {
        let status = UpdateStatus {
            running: ModelSource::BuiltIn,
            memory: ModelMemory::Volatile,
            capacity: 20_000,
            receiving: None,
            refused: 0,
            corrupted: 0,
            development_key: true,
            ..UpdateStatus::default()
        };
        Fake {
            package: package(),
            status,
            received: Vec::new(),
            loses,
            asked: 0,
            refuses: None,
            requires_key: false,
        }
    }

    impl Ask for Fake {
        fn ask(&mut self, request: UpdateRequest) -> Result<UpdateAnswer, ControllerError> {
            self.asked += 1;
            let length = self.package.payload.len() as u32;
            match request {
                UpdateRequest::Begin(signed) => {
                    assert_eq!(signed, self.package.signed);
                    if self.requires_key {
                        return Err(ControllerError::Refused(Refusal::NotAuthenticated));
                    }
                    if let Some(reason) = self.refuses {
                        return Ok(UpdateAnswer::Refused(reason));
                    }
                    self.status.receiving.get_or_insert(Receiving { version: 3, next_offset: 0, length });
                }
                UpdateRequest::Chunk(UpdateChunk { offset, bytes }) => {
                    let receiving = self.status.receiving.as_mut().expect("begun");
                    if offset == receiving.next_offset {
                        let taken = (length - offset).min(CHUNK_LENGTH as u32);
                        self.received.extend(&bytes.as_flattened()[..taken as usize]);
                        receiving.next_offset += taken;
                    }
                }
                UpdateRequest::Finish => {
                    assert_eq!(self.received, self.package.payload.to_vec());
                    let hash = *self.package.manifest.hash.first_chunk().expect("hash");
                    self.status.running = ModelSource::Slot { slot: 0, version: 3, hash };
                    self.status.receiving = None;
                }
                _ => {}
            }
            let lost = self.loses.get(self.asked % self.loses.len().max(1)).copied().unwrap_or(false);
            if lost {
                return Err(ControllerError::TimedOut {
                    waiting_for: "the models",
                    timeout_s: 5,
                    last_sequence: None,
                    cause: "",
                });
            }
            Ok(UpdateAnswer::Status(self.status))
        }
    }

    #[test]
    fn every_byte_is_sent_once_on_a_line_that_loses_nothing() {
        let mut line = fake(Vec::new());
        let mut progress = Vec::new();
        let updated = update(&mut line, &package(), |offset| progress.push(offset)).expect("update");
        assert_eq!(
            updated.sent_bytes,
            (package().payload.len() as u32).next_multiple_of(CHUNK_LENGTH as u32)
        );
        assert_eq!((updated.repeated, updated.resumed_at), (0, 0));
        assert!(progress.is_sorted() && progress.last() == Some(&package().manifest.length()));
        // A second update changes nothing.
        let second = update(&mut line, &package(), |_| {}).expect("update");
        assert_eq!((second.sent_bytes, second.after), (0, updated.after));
    }

    #[test]
    fn a_refusal_and_a_dead_line_end_it() {
        let mut line = Fake { refuses: Some(UpdateRefusal::Signature), ..fake(Vec::new()) };
        let refused = update(&mut line, &package(), |_| {}).expect_err("refused");
        assert!(matches!(refused, UpdateError::Refused(UpdateRefusal::Signature)));
        let mut dead = fake(vec![true]);
        assert!(matches!(update(&mut dead, &package(), |_| {}), Err(UpdateError::Line(_))));
        assert_eq!(dead.asked, ATTEMPTS as usize);
    }

    #[test]
    fn a_missing_key_ends_it_at_once_and_is_an_input_error() {
        let mut line = Fake { requires_key: true, ..fake(Vec::new()) };
        let Err(UpdateError::NotPermitted(error)) = update(&mut line, &package(), |_| {}) else {
            panic!("expected the controller's refusal")
        };
        assert_eq!(line.asked, 2);
        assert_eq!(crate::cli::error::CliError::from(error).exit_code(), 2);
    }

    #[test]
    fn answers_lost_before_the_first_byte_are_not_held_against_a_line_that_moves() {
        let mut line = fake(vec![false, true, true, false, true, false, false]);
        assert!(update(&mut line, &package(), |_| {}).is_ok());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]
        #[test]
        fn a_line_that_loses_answers_only_costs_repetitions(
            loses in prop::collection::vec(prop::bool::weighted(0.3), 7..40)
                .prop_filter("three in a row are close to a dead line", |loses| {
                    let twice: Vec<_> = loses.iter().chain(loses).collect();
                    !twice.windows(3).any(|three| three.iter().all(|&&lost| lost))
                })
        ) {
            let mut line = fake(loses);
            let updated = update(&mut line, &package(), |_| {});
            prop_assert!(updated.is_ok(), "{:?}", updated);
        }
    }
}
