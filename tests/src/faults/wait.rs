//! Waits for the emulator, each with a timeout.

use super::CampaignError;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::os::fd::AsFd;
use std::time::Duration;

/// Waits until a stream is readable, or until the timeout.
pub(super) fn wait_for(stream: &impl AsFd, bound: Duration) -> Result<(), CampaignError> {
    wait(&mut [PollFd::new(stream, PollFlags::IN)], bound)
}

/// Waits until one of the streams is ready, or until the timeout.
pub(super) fn wait(watched: &mut [PollFd<'_>], bound: Duration) -> Result<(), CampaignError> {
    let bound = Timespec { tv_sec: 0, tv_nsec: bound.as_nanos() as i64 };
    match poll(watched, Some(&bound)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(system("waiting for the emulator")(error.into())),
    }
}

/// Returns the error of a request that the operating system refused.
pub(super) fn system(what: &'static str) -> impl Fn(std::io::Error) -> CampaignError {
    move |source| CampaignError::System { what, source }
}
