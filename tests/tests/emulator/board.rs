//! The image on the emulator with its serial port, paced by its timer.

use controller::emulator::MACHINE;
use host_sim::controller::EmulatedController;
use link::{
    Acknowledgement, Answer, Command, ControllerConfiguration, Counters, Decoder, MAX_FRAME, NumberedCommand,
    NumberedEstimate, Refusal, ToController, ToHost, encode,
};
use std::io::{Read, Write};
use std::process::{Child, Command as Process, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// Estimates of a board that samples itself within which it answers: 10 s of its time. Bytes that
/// were sent before a request may take seconds to arrive.
const ANSWER_ESTIMATES: usize = 5000;
/// Requests before a test gives up.
const MAX_REQUESTS: u32 = 5;

/// The image on the emulator, with USART6 on pipes. An instruction takes 4 ns, so that a tick takes
/// a third of its period.
pub(crate) struct Board {
    emulator: Child,
    received: Receiver<ToHost>,
    commands: u32,
    /// Estimates that arrived while a reply was awaited.
    pub(crate) estimates: Vec<NumberedEstimate>,
    _folder: tempfile::TempDir,
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.emulator.kill();
        let _ = self.emulator.wait();
    }
}

impl Board {
    pub(crate) fn start() -> Self {
        // Without the link's pipes in its folder, the image uses the serial port.
        let folder = tempfile::tempdir().unwrap();
        let elf = std::path::absolute(EmulatedController::default_elf()).unwrap();
        let mut emulator = Process::new("qemu-system-arm")
            .args(["-M", MACHINE, "-display", "none", "-monitor", "none", "-no-reboot"])
            .args(["-serial", "null"].repeat(5))
            .args(["-serial", "stdio", "-icount", "shift=2,sleep=off"])
            .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(elf)
            .current_dir(folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut out = emulator.stdout.take().unwrap();
        let (sender, received) = channel();
        std::thread::spawn(move || {
            let mut decoder = Decoder::new();
            let mut buffer = [0; 4096];
            while let Ok(count @ 1..) = out.read(&mut buffer) {
                for &byte in &buffer[..count] {
                    if let Some(Ok(message)) = decoder.push::<ToHost>(byte) {
                        let _ = sender.send(message);
                    }
                }
            }
        });
        let board = Self { emulator, received, commands: 0, estimates: vec![], _folder: folder };
        assert!(matches!(board.next(), ToHost::Hello(_)));
        board
    }

    pub(crate) fn next(&self) -> ToHost {
        self.received.recv_timeout(Duration::from_secs(30)).unwrap()
    }

    pub(crate) fn send(&mut self, message: &ToController) {
        let mut buffer = [0; MAX_FRAME];
        self.send_bytes(encode(message, &mut buffer).unwrap());
    }

    pub(crate) fn send_bytes(&mut self, bytes: &[u8]) {
        let input = self.emulator.stdin.as_mut().unwrap();
        input.write_all(bytes).and_then(|()| input.flush()).unwrap();
    }

    /// Returns the next estimate.
    pub(crate) fn estimate(&mut self) -> NumberedEstimate {
        if !self.estimates.is_empty() {
            return self.estimates.remove(0);
        }
        loop {
            match self.next() {
                ToHost::Estimate(estimate) => return estimate,
                ToHost::Hello(hello) => panic!("restarted: {:?}", hello.start),
                _ => {}
            }
        }
    }

    pub(crate) fn order(&mut self, command: Command) -> Result<Answer, Refusal> {
        self.try_order(command).unwrap_or_else(|| panic!("no answer to {command:?}"))
    }

    /// Sends a command; returns nothing if there was no answer within [`ANSWER_ESTIMATES`]. A board
    /// that samples itself sends estimates for ever, so silence alone does not end the wait. A
    /// command without an answer keeps its number for the next one, since the board expects it.
    fn try_order(&mut self, command: Command) -> Option<Result<Answer, Refusal>> {
        let id = self.commands + 1;
        self.send(&ToController::Command(NumberedCommand { id, command }));
        let last = self.estimates.len() + ANSWER_ESTIMATES;
        while self.estimates.len() < last {
            match self.next() {
                ToHost::Acknowledged(Acknowledgement { id: answered, outcome }) if answered == id => {
                    self.commands = id;
                    return Some(outcome);
                }
                ToHost::Estimate(estimate) => self.estimates.push(estimate),
                _ => {}
            }
        }
        None
    }

    pub(crate) fn configured(configuration: ControllerConfiguration) -> Self {
        let mut board = Self::start();
        assert!(matches!(board.order(Command::Configure(configuration)), Ok(Answer::Configured(_))));
        board
    }

    pub(crate) fn counters(&mut self) -> Counters {
        self.counters_of_full_line().0
    }

    /// Returns the counters and the number of requests that it took. A request after bytes that
    /// the board has no room for is lost with them; so may its answer be, and a repeated request
    /// is answered again.
    pub(crate) fn counters_of_full_line(&mut self) -> (Counters, u32) {
        for request in 1..=MAX_REQUESTS {
            match self.try_order(Command::GetCounters) {
                Some(Ok(Answer::Counters(counters))) => return (counters, request),
                None => {}
                other => panic!("{other:?}"),
            }
        }
        panic!("no answer to {MAX_REQUESTS} requests")
    }
}
