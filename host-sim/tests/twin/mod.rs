//! A simulated controller on a pseudo-terminal or on any other [`Port`]: the firmware's session,
//! served as the image serves its serial port, with faults on request.
#![allow(dead_code, reason = "every test file uses a part of it")]

use controller::configuration::BENCH_B;
use controller::service::CommandGuard;
use controller::{Identity, NoTicks, Session};
use link::authentication::LinkKey;
use link::{
    Acknowledgement, BuildId, ClockSource, ControllerConfiguration, Decoder, FrameError, MAX_FRAME,
    SensorFrame, State, Target, ToController, ToHost, encode,
};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::File;
use std::io::{Read, Result, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

pub(crate) const CONFIGURATION: ControllerConfiguration = BENCH_B;

/// A fault at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Trouble {
    /// The twin ends, and the port with it.
    Dies,
    /// It no longer answers.
    FallsSilent,
    /// It restarts and sends its hello.
    Restarts,
    /// It restarts, and its hello is lost.
    RestartsUnheard,
    /// It sends other messages and never answers.
    Raves,
    /// The sample does not arrive.
    SampleLost,
    /// The sample arrives damaged.
    SampleDamaged,
    /// The estimate does not arrive.
    EstimateLost,
    /// Noise on the line before the answer.
    Noise,
}

/// A trouble at a sample since the start, counted from 0, after so many bytes of its answer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub(crate) at: u32,
    pub(crate) bytes: usize,
    pub(crate) trouble: Trouble,
}

/// The port of the twin.
pub(crate) trait Port: Send {
    /// Waits until the controller may start.
    fn before_start(&mut self) {}
    /// Waits a moment for bytes; returns whether there are any.
    fn wait(&mut self, moment: Duration) -> bool;
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize>;
    /// Writes the bytes; those without a reader are dropped.
    fn write(&mut self, bytes: &[u8]);
    /// Resets the port with the controller.
    fn restart(&mut self) {}
}

/// A pseudo-terminal. The slave side stays open, so that the master sees no end of file between two
/// hosts.
struct Terminal {
    line: File,
    _slave: File,
    waits_for_host: bool,
}

impl Terminal {
    /// Opens a pseudo-terminal; returns it with the path of the slave side.
    fn open() -> (Self, PathBuf) {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let port = PathBuf::from(ptsname(&master, Vec::new()).unwrap().into_string().unwrap());
        // Raw, so that nothing is echoed before the first host connects.
        let slave = File::options().read(true).write(true).open(&port).unwrap();
        let mut settings = tcgetattr(&slave).unwrap();
        settings.make_raw();
        tcsetattr(&slave, OptionalActions::Now, &settings).unwrap();
        (Self { line: File::from(master), _slave: slave, waits_for_host: false }, port)
    }
}

impl Port for Terminal {
    fn before_start(&mut self) {
        if self.waits_for_host {
            poll(&mut [PollFd::new(&self.line, PollFlags::IN)], None).unwrap();
        }
    }

    fn wait(&mut self, moment: Duration) -> bool {
        let moment = Timespec { tv_sec: 0, tv_nsec: moment.as_nanos() as i64 };
        poll(&mut [PollFd::new(&self.line, PollFlags::IN)], Some(&moment)).unwrap() > 0
    }

    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        self.line.read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) {
        let _ = self.line.write_all(bytes);
    }
}

/// The twin, running on its own thread until it is dropped.
pub(crate) struct Twin {
    /// Path of the pseudo-terminal; empty at another port.
    pub(crate) port: PathBuf,
    /// Number of samples received so far.
    pub(crate) samples: Arc<AtomicU32>,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Twin {
    /// Starts a twin that sends every hello `hello_count` times, like a controller
    /// that was slow to answer the first request.
    ///
    /// The hello of its start is in the port's buffer when this returns.
    pub(crate) fn start(plan: Vec<Plan>, hello_count: usize) -> Self {
        Self::start_with_key(None, plan, hello_count)
    }

    /// Starts such a twin, which requires a key.
    pub(crate) fn start_with_key(key: Option<LinkKey>, plan: Vec<Plan>, hello_count: usize) -> Self {
        let (terminal, port) = Terminal::open();
        let slave = terminal._slave.try_clone().unwrap();
        let mut twin = Self::at_with_key(terminal, plan, hello_count, key);
        let hello = poll(&mut [PollFd::new(&slave, PollFlags::IN)], None);
        assert_eq!(hello, Ok(1));
        twin.port = port;
        twin
    }

    /// Starts a twin that sends its first hello when the first bytes of a host arrive.
    pub(crate) fn start_on_first_bytes() -> Self {
        let (mut terminal, port) = Terminal::open();
        terminal.waits_for_host = true;
        let mut twin = Self::at(terminal, vec![], 1);
        twin.port = port;
        twin
    }

    /// Starts a twin at any port.
    pub(crate) fn at(port: impl Port + 'static, plan: Vec<Plan>, hello_count: usize) -> Self {
        Self::at_with_key(port, plan, hello_count, None)
    }

    fn at_with_key(
        port: impl Port + 'static,
        plan: Vec<Plan>,
        hello_count: usize,
        key: Option<LinkKey>,
    ) -> Self {
        let (samples, end) = (Arc::new(AtomicU32::new(0)), Arc::new(AtomicBool::new(false)));
        let mut twin = Served {
            port: Box::new(port),
            session: session(),
            key,
            guard: None,
            starts: 0,
            plan,
            hello_count,
            samples: Arc::clone(&samples),
            end: Arc::clone(&end),
            mode: Mode::Serving,
        };
        twin.start();
        let thread = Some(std::thread::spawn(move || twin.serve()));
        Self { port: PathBuf::new(), samples, end, thread }
    }
}

impl Drop for Twin {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}

#[derive(PartialEq)]
enum Mode {
    Serving,
    Silent,
    Raving,
    Dead,
}

struct Served {
    port: Box<dyn Port>,
    session: Session,
    key: Option<LinkKey>,
    guard: Option<CommandGuard>,
    starts: u32,
    plan: Vec<Plan>,
    hello_count: usize,
    samples: Arc<AtomicU32>,
    end: Arc<AtomicBool>,
    mode: Mode,
}

fn session() -> Session {
    let build_id = BuildId::new("twin");
    Session::new(Identity { build_id, target: Target::Silicon, clock: ClockSource::Host, core_hz: 1 })
}

fn frame(message: &ToHost) -> Vec<u8> {
    encode(message, &mut [0; MAX_FRAME]).unwrap().to_vec()
}

impl Served {
    /// Starts the session, the first or another one.
    fn start(&mut self) {
        self.session = session();
        self.starts += 1;
        self.guard = self.key.map(|key| CommandGuard::new(key, Some(self.starts)));
        if let Some(guard) = &self.guard {
            self.session.set_authentication(guard.requirement(0));
        }
    }

    /// Answers a message as the link service does.
    fn answer(&mut self, message: &ToController) -> ToHost {
        if let Some(guard) = &self.guard
            && let Err((id, reason)) = guard.admit(message)
        {
            return ToHost::Acknowledged(Acknowledgement { id, outcome: Err(reason) });
        }
        let mut answer = self.session.handle(message, &mut NoTicks);
        if let (ToHost::Hello(hello), Some(guard)) = (&mut answer, &self.guard) {
            hello.authentication = guard.requirement(hello.last_command);
        }
        answer
    }

    fn serve(&mut self) {
        let mut decoder = Decoder::new();
        let mut buffer = [0; 1024];
        self.port.before_start();
        self.greet();
        while self.mode != Mode::Dead && !self.end.load(Ordering::Relaxed) {
            let ready = self.port.wait(Duration::from_millis(5));
            if self.mode == Mode::Raving {
                let hello = self.session.hello(77);
                self.write(&frame(&ToHost::Hello(hello)));
            }
            if !ready {
                continue;
            }
            let Ok(count) = self.port.read(&mut buffer) else { continue };
            for &byte in &buffer[..count] {
                match decoder.push::<ToController>(byte) {
                    None => {}
                    _ if self.mode != Mode::Serving => {}
                    Some(Ok(message)) => self.take(&message),
                    Some(Err(error)) => {
                        let fault = self.session.bad_frame(error);
                        self.write(&frame(&fault));
                    }
                }
            }
        }
    }

    fn take(&mut self, message: &ToController) {
        let mut plan = None;
        if let ToController::Sensor(..) = message {
            let index = self.samples.fetch_add(1, Ordering::Relaxed);
            plan = self.plan.iter().find(|plan| plan.at == index).copied();
            match plan.map(|plan| plan.trouble) {
                Some(Trouble::SampleLost) => return,
                Some(Trouble::SampleDamaged) => {
                    let fault = self.session.bad_frame(FrameError::Crc);
                    return self.write(&frame(&fault));
                }
                _ => {}
            }
            // As in the image: a sample before any configuration gets no answer.
            if self.session.state() == State::Waiting {
                return;
            }
        }
        let is_identify = matches!(message, ToController::Identify { .. });
        let answer = frame(&self.answer(message));
        while let Some(impact) = self.session.take_impact() {
            self.write(&frame(&impact));
        }
        let Some(plan) = plan else {
            for _ in 0..if is_identify { self.hello_count } else { 1 } {
                self.write(&answer);
            }
            if let Some(slow) = self.session.take_telemetry() {
                self.write(&frame(&slow));
            }
            return;
        };
        let begun = &answer[..plan.bytes.min(answer.len())];
        match plan.trouble {
            Trouble::EstimateLost => return,
            Trouble::Noise => {
                self.write(&[0x55; 20][..plan.bytes.min(20)]);
                return self.write(&[&[0], &answer[..]].concat());
            }
            _ => self.write(begun),
        }
        match plan.trouble {
            Trouble::Dies => self.mode = Mode::Dead,
            Trouble::FallsSilent => self.mode = Mode::Silent,
            Trouble::Raves => self.mode = Mode::Raving,
            trouble => {
                self.start();
                self.port.restart();
                if trouble == Trouble::Restarts {
                    self.greet();
                }
            }
        }
    }

    /// Sends the hello of a start after a delimiter, as the image does.
    fn greet(&mut self) {
        let hello = self.session.hello(0);
        self.write(&[0]);
        self.write(&frame(&ToHost::Hello(hello)));
    }

    fn write(&mut self, bytes: &[u8]) {
        self.port.write(bytes);
    }
}

/// SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (mixed ^ (mixed >> 31)) % end
    }
}

/// Samples of a journal that swings along the clearance circle and in and out of contact.
pub(crate) fn frames(count: u32, seed: u64) -> Vec<SensorFrame> {
    let mut random = Random(seed);
    let mut noise = move || random.below(801) as f64 - 400.0;
    let frame = |index: u32| {
        let t = f64::from(index) * 1e-4;
        let distance_nm = 515_000.0 + 30_000.0 * (207.0 * t).sin();
        let swing = (283.0 * t).sin() - 1.5;
        SensorFrame {
            sequence: index,
            time_us: index * 100,
            journal_y_nm: (distance_nm * swing.cos() + noise()) as i32,
            journal_z_nm: (distance_nm * swing.sin() + noise()) as i32,
            shaft_angle_nrad: (5e7 * (9.0 * t).sin() + 40.0 * noise()) as i32,
            load_force_mn: 10_000_000,
        }
    };
    (0..count).map(frame).collect()
}
