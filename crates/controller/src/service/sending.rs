//! Frames that the controller sends, and the counts of those that a transport does not take.

use link::{MAX_FRAME, ToHost, encode};
use rtic_core::Mutex;

use super::shared_session::{SampleSource, SharedSession};
use super::transport::{Ports, Transport};
use crate::impacts::MAX_WAITING;

/// Sends the estimates that the tick has queued, with their blocks.
pub(super) fn send_estimates<A: Transport, B: Transport, S: SampleSource>(
    ports: &mut Ports<A, B>,
    shared: &mut impl Mutex<T = SharedSession<S>>,
) {
    while let Some(estimate) = shared.lock(SharedSession::next_estimate) {
        if !ports.send_to_host(&estimate.frame) {
            shared.lock(|shared| shared.session.count_dropped_estimate());
        }
        let Some(mut block) = estimate.block else { continue };
        let (block, is_corrupted) = block.load();
        if is_corrupted || !send(&ToHost::Block(block), |frame| ports.send_to_host(frame)) {
            shared.lock(|shared| shared.session.count_dropped_answer());
        }
    }
}

/// Sends the impacts that have ended, at most as many as can wait.
pub(super) fn send_impacts<A: Transport, B: Transport, S: SampleSource>(
    ports: &mut Ports<A, B>,
    shared: &mut impl Mutex<T = SharedSession<S>>,
) {
    for _ in 0..MAX_WAITING {
        let Some(impact) = shared.lock(|shared| shared.session.take_impact()) else { break };
        if !send(&impact, |frame| ports.send_to_host(frame)) {
            shared.lock(|shared| shared.session.count_dropped_impact());
        }
    }
}

/// Encodes a message and passes it to a transport. Returns false if the transport does not take it.
pub(super) fn send(message: &ToHost, write: impl FnOnce(&[u8]) -> bool) -> bool {
    let mut buffer = [0; MAX_FRAME];
    encode(message, &mut buffer).is_ok_and(write)
}
