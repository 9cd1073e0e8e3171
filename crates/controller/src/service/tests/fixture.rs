//! A service with its memories on a board of the test.

use super::*;

/// Addresses of the test's code.
pub(super) const SPANS: [std::ops::Range<usize>; crate::supervisor::code::SPANS] = {
    let mut spans = [const { 32..32 }; crate::supervisor::code::SPANS];
    [spans[0], spans[1], spans[2]] = [0..16, 16..32, 32..56];
    spans[crate::supervisor::code::SPANS - 1] = 60..64;
    spans
};

/// A transport whose received bytes are written beforehand and whose sent frames are recorded.
#[derive(Default)]
pub(super) struct Script {
    pub(super) received: VecDeque<u8>,
    pub(super) sent: Vec<u8>,
    /// Purposes of the sent frames.
    pub(super) purposes: Vec<Purpose>,
    pub(super) is_closed_at_end: bool,
    pub(super) is_blocked: bool,
    pub(super) line: LineReport,
}

impl Script {
    pub(super) fn write(&mut self, messages: &[ToController]) {
        for message in messages {
            self.received.extend(encode(message, &mut [0; MAX_FRAME]).unwrap());
        }
    }

    /// Takes what was sent.
    pub(super) fn replies(&mut self) -> Vec<ToHost> {
        let mut decoder = Decoder::new();
        let sent = std::mem::take(&mut self.sent);
        sent.iter().filter_map(|&byte| decoder.push(byte)).map(Result::unwrap).collect()
    }
}

impl Transport for &mut Script {
    fn receive(&mut self) -> Received {
        match self.received.pop_front() {
            Some(byte) => Received::Byte(byte),
            None if self.is_closed_at_end => Received::Closed,
            None => Received::Nothing,
        }
    }

    fn send(&mut self, frame: &[u8], purpose: Purpose) -> bool {
        if !self.is_blocked {
            self.sent.extend(frame);
            self.purposes.push(purpose);
        }
        !self.is_blocked
    }

    fn line(&self) -> LineReport {
        self.line
    }
}

/// Flash memory of two parts.
pub(super) struct Flash {
    pub(super) bytes: Box<[u8; 2 * 20 * 1024]>,
    pub(super) is_worn: bool,
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        bytes.copy_from_slice(&self.bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 4;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.bytes[from as usize..to as usize].fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        for (stored, byte) in self.bytes[offset as usize..].iter_mut().zip(bytes) {
            *stored &= byte;
        }
        if self.is_worn { Err(NorFlashErrorKind::Other) } else { Ok(()) }
    }
}

impl MultiwriteNorFlash for Flash {}

impl SlotMemory for Flash {
    fn kind(&self) -> ModelMemory {
        ModelMemory::Volatile
    }

    fn stalls_the_core(&self) -> bool {
        false
    }

    /// Returns a copy at an aligned address.
    fn in_place(&self, offset: u32, length: u32) -> &'static [u8] {
        let bytes = &self.bytes[offset as usize..][..length as usize];
        let words: Vec<u32> =
            bytes.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
        bytemuck::cast_slice(words.leak())
    }
}

/// A board with 16 words of code.
pub(super) struct Board {
    pub(super) attendance: Attendance,
    pub(super) uptime_us: u32,
    pub(super) code: [u32; 16],
    pub(super) ticks: NoTicks,
    pub(super) watch: Cell<StartWatch>,
    pub(super) lines: RefCell<Vec<LogEvent>>,
}

impl Platform for Board {
    type Ticks = NoTicks;

    fn ticks(&mut self) -> &mut NoTicks {
        &mut self.ticks
    }

    fn uptime_us(&self) -> u32 {
        self.uptime_us
    }

    fn attendance(&self) -> &Attendance {
        &self.attendance
    }

    fn start_watch(&self) -> StartWatch {
        self.watch.get()
    }

    fn set_start_watch(&self, watch: StartWatch) {
        self.watch.set(watch);
    }

    fn log(&self, event: &LogEvent) {
        self.lines.borrow_mut().push(*event);
    }

    fn code_word(&self, address: usize) -> u32 {
        self.code[address / 4]
    }

    fn search_stack(&self, mark: &mut Mark) -> StackReport {
        mark.search(100, |word| if word < 6 { PAINT } else { 0 });
        StackReport { reserved_bytes: 40, used_bytes: mark.used_bytes() as u32 }
    }
}

/// Everything but the transports.
pub(super) struct Fixture {
    pub(super) service: LinkService<Flash>,
    pub(super) shared: SharedSession<Infallible>,
    pub(super) board: Board,
}

pub(super) fn fixture(pacing: Pacing, places: Flash) -> Fixture {
    fixture_with(pacing, blank(), places)
}

/// A fixture with the memories of slots and kept values.
pub(super) fn fixture_with(pacing: Pacing, slots: Flash, places: Flash) -> Fixture {
    fixture_with_key(pacing, slots, places, None)
}

pub(super) fn fixture_with_key(pacing: Pacing, slots: Flash, places: Flash, key: Option<LinkKey>) -> Fixture {
    let periods = Periods { sampling_us: 1_000, inference_us: 1_000, link_us: 1_000, self_test_us: 1_000 };
    let board = Board {
        attendance: Attendance::new(periods),
        uptime_us: 0,
        code: std::array::from_fn(|index| index as u32),
        ticks: NoTicks,
        watch: Cell::default(),
        lines: RefCell::default(),
    };
    let identity = Identity {
        build_id: BuildId::new("test"),
        target: Target::Native,
        clock: ClockSource::Host,
        core_hz: 0,
    };
    let mut session = Session::new(identity);
    let (stores, models) = Stores::start(slots, places, package::BOARD, &[DEVELOPMENT_KEY]);
    session.switch_models(models);
    let code = CodeCheck::new(SPANS, crate::supervisor::code::UNSEALED);
    let background = Background::start(code, Mark::new(10), &mut session, &board);
    let service = LinkService::new(pacing, stores, key, background);
    Fixture { service, shared: SharedSession::new(session, None), board }
}

pub(super) fn blank() -> Flash {
    Flash { bytes: Box::new([0xFF; 2 * 20 * 1024]), is_worn: false }
}

impl Fixture {
    /// Runs passes over two scripted transports until the first one's script is read or the service
    /// ends.
    pub(super) fn run(&mut self, first: &mut Script, second: &mut Script, passes: usize) -> Result<(), Stop> {
        let mut ports = Ports::new(first, second);
        (0..passes).try_for_each(|_| {
            self.service.pass(&mut ports, &mut Exclusive(&mut self.shared), &mut self.board)
        })
    }

    pub(super) fn restore(&mut self) {
        self.service.restore(&mut Exclusive(&mut self.shared), &self.board);
    }

    pub(super) fn kept(&self) -> KeptConfiguration {
        self.shared.session.hello(0).start.kept
    }

    pub(super) fn ask(&mut self, message: ToController) -> Vec<ToHost> {
        let mut script = Script::default();
        script.write(&[message]);
        self.run(&mut script, &mut Script::default(), 2).unwrap();
        script.replies()
    }

    pub(super) fn order(&mut self, command: Command) -> Answer {
        let id = self.shared.session.hello(0).last_command + 1;
        match self.ask(ToController::Command(NumberedCommand { id, command }))[..] {
            [ToHost::Acknowledged(acknowledgement)] => acknowledgement.outcome.unwrap(),
            ref other => panic!("{other:?}"),
        }
    }
}
