//! Requirements on the session and both decoders for arbitrary bytes. The fuzzer and the bounded
//! run both use them.
//!
//! The first byte of a case selects the meaning of the rest: bytes of the line, or payloads. A
//! payload gets the checksum and stuffing of a valid frame, so that a fuzzer gets past the CRC.
//!
//! * No panic.
//! * Every refused frame is counted once.
//! * Every answer fits a frame and is decoded unchanged.
//! * The next valid frame is accepted.

use controller::{Identity, NoTicks, Session};
use link::{
    Acknowledgement, Answer, BuildId, ClockSource, DELIMITER, Decoder, MAX_FRAME, Target, ToController,
    ToHost, crc32, encode,
};

/// A session as on a board, with a supervised deadline.
pub(crate) fn session() -> Session {
    let build_id = BuildId::new("fuzz");
    Session::new(Identity {
        build_id,
        target: Target::Silicon,
        clock: ClockSource::Internal,
        core_hz: 168_000_000,
    })
}

/// A controller with its decoder and the number of frames refused so far.
pub(crate) struct Subject {
    session: Session,
    decoder: Decoder,
    token: u32,
    refused: u32,
    /// Number of estimates and of accepted configurations.
    pub(crate) served: [u32; 2],
}

impl Default for Subject {
    fn default() -> Self {
        Self { session: session(), decoder: Decoder::new(), token: 0, refused: 0, served: [0; 2] }
    }
}

impl Subject {
    /// Number of the last command carried out.
    pub(crate) fn last_command(&self) -> u32 {
        self.session.hello(0).last_command
    }

    /// Handles the bytes of one case. Panics if a requirement is violated.
    pub(crate) fn survives(&mut self, data: &[u8]) {
        let Some((how, data)) = data.split_first() else { return };
        if how & 1 == 0 {
            self.line(data);
        } else {
            for payload in data.split(|&byte| byte == 0xFF) {
                self.line(&framed(payload));
            }
        }
        self.check_next_frame();
        check_host_decoder(data);
    }

    fn line(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let answer = match self.decoder.push::<ToController>(byte) {
                None => continue,
                Some(Ok(message)) => self.session.handle(&message, &mut NoTicks),
                Some(Err(error)) => {
                    self.refused = self.refused.saturating_add(1);
                    self.session.bad_frame(error)
                }
            };
            check_round_trip(&answer);
            let [estimates, configurations] = &mut self.served;
            match answer {
                ToHost::Estimate(_) => *estimates += 1,
                ToHost::Acknowledged(Acknowledgement { outcome: Ok(Answer::Configured(_)), .. }) => {
                    *configurations += 1;
                }
                _ => {}
            }
            if let Some(report) = self.session.take_telemetry() {
                check_round_trip(&report);
            }
        }
        assert_eq!(self.decoder.bad_frames().total(), self.refused, "the decoder's count");
        assert_eq!(self.session.counters().bad_frames.total(), self.refused, "the session's count");
    }

    /// Checks that the decoder is synchronised again after a delimiter.
    fn check_next_frame(&mut self) {
        self.line(&[DELIMITER]);
        self.token = self.token.wrapping_add(1);
        let before = self.session.hello(self.token);
        let mut frame = [0; MAX_FRAME];
        let frame = encode(&ToController::Identify { token: self.token }, &mut frame).expect("it is short");
        let messages: Vec<_> =
            frame.iter().filter_map(|&byte| self.decoder.push::<ToController>(byte)).collect();
        assert_eq!(messages, [Ok(ToController::Identify { token: self.token })]);
        let answer = self.session.handle(&ToController::Identify { token: self.token }, &mut NoTicks);
        assert_eq!(answer, ToHost::Hello(before));
    }
}

/// Checks that an answer is decoded from its frame unchanged.
fn check_round_trip(answer: &ToHost) {
    let (mut frame, mut again) = ([0; MAX_FRAME], [0; MAX_FRAME]);
    let frame = encode(answer, &mut frame).expect("every answer fits a frame");
    let mut decoder = Decoder::new();
    let back = frame.iter().find_map(|&byte| decoder.push::<ToHost>(byte));
    let back = back.expect("a delimiter ends it").expect("it is valid");
    assert_eq!(encode(&back, &mut again).expect("as before"), frame);
}

/// Checks the host's decoder with the same bytes.
fn check_host_decoder(data: &[u8]) {
    let mut decoder = Decoder::new();
    let refused = data.iter().filter_map(|&byte| decoder.push::<ToHost>(byte)).filter(Result::is_err).count();
    assert_eq!(decoder.bad_frames().total() as usize, refused);
}

/// A valid frame around a payload, which is truncated to the longest that fits.
pub(crate) fn framed(payload: &[u8]) -> Vec<u8> {
    let payload = &payload[..payload.len().min(link::MAX_PAYLOAD - 4)];
    let mut complete = payload.to_vec();
    complete.extend(crc32(payload).to_le_bytes());
    // From the end: a zero becomes the distance to the next zero.
    let mut frame = vec![DELIMITER];
    let mut distance = 1;
    for &byte in complete.iter().rev() {
        frame.push(if byte == 0 { std::mem::replace(&mut distance, 0) } else { byte });
        distance += 1;
    }
    frame.push(distance);
    frame.reverse();
    frame
}
