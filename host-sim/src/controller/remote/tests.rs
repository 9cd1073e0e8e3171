//! Repetitions on a line that loses requests.

use super::*;
use crate::controller::line::Timeouts;
use crate::controller::stream::Stream;
use link::update::UpdateRefusal;
use link::{Decoder, MAX_FRAME, encode};
use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::OwnedFd;

const TIMEOUTS: Timeouts = Timeouts { answer: Duration::from_millis(400), retry: Duration::from_millis(100) };

/// A line to a controller that answers requests about models, except the first ones, and nothing
/// else.
fn line_that_loses(mut requests: usize) -> Line {
    let (mut at_controller, to_controller) = std::io::pipe().unwrap();
    let (at_host, mut to_host) = std::io::pipe().unwrap();
    std::thread::spawn(move || {
        let mut decoder = Decoder::new();
        let mut byte = [0];
        while at_controller.read_exact(&mut byte).is_ok() {
            if let Some(Ok(ToController::Update(_))) = decoder.push(byte[0]) {
                if requests == 0 {
                    let answer = ToHost::Update(UpdateAnswer::Refused(UpdateRefusal::NoMemory));
                    to_host.write_all(encode(&answer, &mut [0; MAX_FRAME]).unwrap()).unwrap();
                }
                requests = requests.saturating_sub(1);
            }
        }
    });
    let at_host = OwnedFd::from(at_host);
    rustix::io::ioctl_fionbio(&at_host, true).unwrap();
    let to_controller = File::from(OwnedFd::from(to_controller));
    Line::new(Stream::Pipes { to_controller, to_host: File::from(at_host) }, None, TIMEOUTS)
}

#[test]
fn a_lost_request_is_repeated_itself_after_an_identify_without_an_answer() {
    let line = line_that_loses(1);
    let mut controller = RemoteController::new("test", line, Conversation::new(7), no_hello());
    let error = controller.identify().unwrap_err();
    assert!(matches!(error, ControllerError::TimedOut { .. }), "{error:?}");
    let repeated = controller.link_state().1.sent_again;
    let answer = controller.update(UpdateRequest::Status).unwrap();
    assert_eq!(answer, UpdateAnswer::Refused(UpdateRefusal::NoMemory));
    assert_eq!(controller.link_state().1.sent_again, repeated + 1);
}
