//! The estimator as an image for a board.
//!
//! | task | priority | does |
//! |---|---|---|
//! | `tick` | 2 | SysTick: reviews who has checked in and kicks the watchdog; paced (10 kHz) it takes the link's next sample, or one of the board's own sensors, estimates, queues the answer |
//! | `received` | 1 | the serial port: counts what it received wrongly; without DMA also keeps the bytes that come in |
//! | `idle` | 0 | the link, over the serial port and a debug probe: frames in, commands, answers out; the self-test; the stack's mark |
//!
//! Deadline: a tick's work must end before the next tick; the session watches it. Nothing that comes in preempts it: on silicon DMA
//! keeps the bytes, in the emulator they wait for their interrupt. What finds no room is lost and counted.
//!
//! In the emulator's lockstep a frame is a tick: `idle` estimates itself, with SysTick's task shut out by the session's lock, so the
//! instruction count of a tick repeats exactly.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is for a microcontroller; build it with `cargo xtask firmware`");
}

#[cfg(target_os = "none")]
#[rtic::app(device = firmware::boards::device, peripherals = true)]
mod app {
    use core::sync::atomic::{AtomicU32, Ordering};
    use firmware::boards::{
        Board, Inbox, Light, Link, Memory, PACKAGES_FOR, Receiver, Sensors, Storage, Timer, Watchdog,
        advance_uptime, check_in, code_check, code_word, give_up, leave, stack_mark, stack_used, start,
        uptime_us,
    };
    use firmware::store::{Keeper, Store, key};
    use firmware::supervisor::light::{lit, shown};
    use firmware::supervisor::paint::Mark;
    use firmware::supervisor::self_test::Progress;
    use firmware::supervisor::{Attendance, CodeCheck, Party, SelfTest, Verdict};
    use firmware::{NoTicks, Session};
    use heapless::Deque;
    use heapless::spsc::{Consumer, Producer, Queue};
    use link::start::{FaultKind, MISSING_SELF_TEST, PARTIES, Presence, StartReport};
    use link::track::SensorStatus;
    use link::update::{UpdateAnswer, UpdateRequest};
    use link::{
        CONFIGURATION_VERSION, DELIMITER, Decoder, ESTIMATE_FRAME, LineErrors, MAX_FRAME, SensorFrame, State,
        ToController, ToHost, encode,
    };

    /// Room for bytes received by interrupt: as much as DMA's buffer has.
    const BYTES: usize = 1024;
    /// Received bytes that one pass of the link's loop looks at.
    const BYTES_A_PASS: usize = 256;
    /// Room for samples and for answers: the host of a lockstep has one on the way.
    const SAMPLES: usize = 8;
    /// In lockstep the self-test goes on once in so many frames, so that it does not slow the exchange down.
    const FRAMES_A_STEP: u32 = 16;
    /// Words of code that one pass of the link's loop looks at, or one frame of a lockstep.
    const CODE_WORDS_A_PASS: usize = 64;

    /// Received bytes that found no room.
    static DROPPED_BYTES: AtomicU32 = AtomicU32::new(0);
    /// What the port itself found wrong.
    static OVERRUNS: AtomicU32 = AtomicU32::new(0);
    static FRAMING: AtomicU32 = AtomicU32::new(0);
    static NOISE: AtomicU32 = AtomicU32::new(0);

    #[shared]
    struct Shared {
        session: Session,
        samples: Deque<(SensorFrame, SensorStatus), SAMPLES>,
        estimates: Deque<[u8; ESTIMATE_FRAME], SAMPLES>,
        attendance: Attendance,
        sensors: Option<Sensors>,
    }

    #[local]
    struct Local {
        link: Link,
        idle_timer: Timer,
        tick_timer: Timer,
        receiver: Receiver,
        bytes_in: Producer<'static, u8>,
        bytes: Consumer<'static, u8>,
        inbox: Inbox,
        watchdog: Watchdog,
        light: Light,
        start: StartReport,
        paced: bool,
        background: Background,
        kept: Kept,
    }

    /// What outlives the power.
    pub struct Kept {
        store: Store<Memory>,
        keeper: Keeper<Memory>,
    }

    /// What is done beside the link.
    pub struct Background {
        self_test: SelfTest,
        /// Nothing if the code was altered from the start: then every run is refused.
        code: Option<CodeCheck>,
        mark: Mark,
    }

    #[init(local = [byte_queue: Queue<u8, BYTES> = Queue::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let Board {
            identity,
            start,
            link,
            receiver,
            inbox,
            timer,
            watchdog,
            light,
            attendance,
            storage,
            sensors,
        } = start(cx.core, cx.device);
        let (bytes_in, bytes) = cx.local.byte_queue.split();
        let mut session = Session::new(identity);
        session.report_start(start);
        let mut mark = stack_mark();
        session.report_stack(stack_used(&mut mark));
        let Storage { slots, places } = storage;
        let (store, models) = Store::start(slots, PACKAGES_FOR, key::KEY);
        session.switch(models);
        let mut code = code_check();
        let code = if code.pass(code_word) {
            session.distrust_code();
            None
        } else {
            Some(code)
        };
        let keeper = Keeper::start(places);
        // From here on both are expected; sampling and inference once there is something to estimate.
        check_in(&attendance, Party::Link);
        check_in(&attendance, Party::SelfTest);
        let paced = matches!(link, Link::Serial(..));
        session.report_sensors(paced && sensors.is_some());
        defmt::info!("started, core at {=u32} Hz", identity.core_hz);
        (
            Shared { session, samples: Deque::new(), estimates: Deque::new(), attendance, sensors },
            Local {
                link,
                idle_timer: timer,
                tick_timer: timer,
                receiver,
                bytes_in,
                bytes,
                inbox,
                watchdog,
                light,
                start,
                paced,
                background: Background { self_test: SelfTest::new(), code, mark },
                kept: Kept { store, keeper },
            },
        )
    }

    /// Counts what the serial port received wrongly and keeps the byte, where bytes come by interrupt; one without room is lost, counted, and
    /// its frame fails its check.
    #[task(binds = SERIAL, priority = 1, local = [receiver, bytes_in])]
    fn received(cx: received::Context) {
        let came = cx.local.receiver.fetch();
        if let Some(byte) = came.byte
            && cx.local.bytes_in.enqueue(byte).is_err()
        {
            DROPPED_BYTES.fetch_add(1, Ordering::Relaxed);
        }
        OVERRUNS.fetch_add(came.errors.overruns, Ordering::Relaxed);
        FRAMING.fetch_add(came.errors.framing, Ordering::Relaxed);
        NOISE.fetch_add(came.errors.noise, Ordering::Relaxed);
    }

    /// One timer tick: the supervisor's review, and on the serial link one sample period.
    #[task(binds = SysTick, priority = 2, local = [tick_timer, watchdog, light, start, paced], shared = [session, samples, estimates, sensors, &attendance])]
    fn tick(cx: tick::Context) {
        let now_us = advance_uptime();
        let attendance = cx.shared.attendance;
        match attendance.review(now_us) {
            Verdict::Kick => cx.local.watchdog.kick(),
            Verdict::Starved { missing } => give_up(FaultKind::Starved { missing }),
        }
        let running = (cx.shared.session, cx.shared.samples, cx.shared.estimates, cx.shared.sensors).lock(
            |session, samples, estimates, sensors| {
                let running = session.state() == State::Running;
                if !*cx.local.paced {
                    return running;
                }
                check_in(attendance, Party::Sampling);
                let came = samples.pop_front();
                let timer = cx.local.tick_timer;
                let estimate = match (sensors, came) {
                    (Some(sensors), came) if session.samples_itself() => {
                        if came.is_some() {
                            session.count_dropped_sample();
                        }
                        session.own_tick(|| sensors.sample(now_us), timer)
                    }
                    // A sample before any configuration is answered by silence: the state is in every greeting.
                    (_, Some((frame, status))) => session.tick(&frame, status, timer).ok(),
                    (_, None) => {
                        attendance.rest(Party::Inference);
                        session.count_idle_tick();
                        return running;
                    }
                };
                if let Some(estimate) = estimate
                    && estimates.push_back(estimate).is_err()
                {
                    session.count_dropped_estimate();
                }
                check_in(attendance, Party::Inference);
                running
            },
        );
        cx.local.light.show(lit(shown(cx.local.start, running), now_us));
    }

    /// The link.
    #[idle(local = [link, idle_timer, bytes, inbox, background, kept], shared = [session, samples, estimates, sensors, &attendance])]
    fn idle(mut cx: idle::Context) -> ! {
        let mut decoder = Decoder::new();
        // What a probe brings is apart from what the port does. Where the last sound frame came from, estimates and telemetry go.
        let mut at_probe = Decoder::new();
        let mut to_probe = false;
        let attendance = cx.shared.attendance;
        let background = cx.local.background;
        let kept = cx.local.kept;
        // A bench beside which the controller was left running goes on without a host. A refusal is a configuration of another build.
        // Here and not in `init`, on whose large frame it would come on top.
        if let Some(configuration) = kept.keeper.value(CONFIGURATION_VERSION.into()) {
            let _ = cx.shared.session.lock(|session| session.configure(&configuration));
            rewire(&mut cx.shared.session, &mut cx.shared.sensors);
            if configuration.wiring.sample_at_start {
                // A refusal is a board without sensors, or a bench of another period.
                let _ = cx.shared.session.lock(Session::sample_itself);
            }
        }
        // Unasked: a host that was in the middle of a run learns of the restart.
        let hello = cx.shared.session.lock(|session| session.hello(0));
        match cx.local.link {
            Link::Files(files) => send(&ToHost::Hello(hello), |bytes| files.write(bytes)),
            Link::Serial(port, probe) => {
                // A reset may have cut a frame short: what has come of it must not swallow the greeting.
                let by_port =
                    port.write(&[DELIMITER]) && send(&ToHost::Hello(hello), |bytes| port.write(bytes));
                let by_probe =
                    probe.write(&[DELIMITER]) && send(&ToHost::Hello(hello), |bytes| probe.write(bytes));
                by_port && by_probe
            }
        };
        #[cfg(feature = "provoke")]
        firmware::boards::provoke(&hello.start, attendance);
        match cx.local.link {
            Link::Files(files) => {
                let mut frames = 0_u32;
                loop {
                    let mut buffer = [0; MAX_FRAME];
                    let came = files.read(&mut buffer);
                    if came.is_empty() {
                        leave();
                    }
                    let parties = attendance.look(uptime_us());
                    check_in(attendance, Party::Link);
                    for &byte in came {
                        let Some(message) = decoder.push::<ToController>(byte) else { continue };
                        let answer = match message {
                            Ok(ToController::Update(request)) => {
                                Some(update(&mut kept.store, &request, &mut cx.shared.session))
                            }
                            Ok(ToController::Sensor(frame, status)) => {
                                let timer = &mut *cx.local.idle_timer;
                                match cx.shared.session.lock(|session| session.tick(&frame, status, timer)) {
                                    Ok(estimate) => {
                                        check_in(attendance, Party::Sampling);
                                        check_in(attendance, Party::Inference);
                                        if !files.write(&estimate) {
                                            cx.shared.session.lock(Session::count_dropped_estimate);
                                        }
                                        None
                                    }
                                    Err(refused) => Some(refused),
                                }
                            }
                            Ok(message) => {
                                tell(&mut cx.shared.session, &mut cx.shared.sensors, parties, &kept.store);
                                keep(&mut kept.keeper, &message, &mut cx.shared.session);
                                let answer =
                                    cx.shared.session.lock(|session| session.handle(&message, &mut NoTicks));
                                rewire(&mut cx.shared.session, &mut cx.shared.sensors);
                                Some(answer)
                            }
                            Err(error) => Some(cx.shared.session.lock(|session| session.bad_frame(error))),
                        };
                        if let Some(answer) = answer {
                            send(&answer, |bytes| files.write(bytes));
                        }
                        replace_altered(&mut kept.store, &mut cx.shared.session);
                        if cx.shared.session.lock(|session| session.slow_is_due()) {
                            tell(&mut cx.shared.session, &mut cx.shared.sensors, parties, &kept.store);
                            if let Some(report) = cx.shared.session.lock(Session::slow) {
                                send(&report, |bytes| files.write(bytes));
                            }
                        }
                        look_at_constants(background, &mut cx.shared.session);
                        frames = frames.wrapping_add(1);
                        if frames % FRAMES_A_STEP == 0 {
                            go_on(background, attendance, |stack| {
                                cx.shared.session.lock(|session| session.report_stack(stack));
                            });
                        }
                    }
                }
            }
            Link::Serial(port, probe) => loop {
                let parties = attendance.look(uptime_us());
                check_in(attendance, Party::Link);
                // A bounded number of bytes and one answer at most, so that a flood does not keep the estimates waiting.
                for _ in 0..BYTES_A_PASS {
                    let by_port = cx.local.inbox.take().or_else(|| cx.local.bytes.dequeue());
                    let by_probe = by_port.is_none();
                    let Some(byte) = by_port.or_else(|| probe.take()) else { break };
                    let decoder = if by_probe { &mut at_probe } else { &mut decoder };
                    let Some(message) = decoder.push::<ToController>(byte) else { continue };
                    if message.is_ok() {
                        to_probe = by_probe;
                    }
                    let answer = match message {
                        Ok(ToController::Sensor(frame, status)) => {
                            if cx.shared.samples.lock(|samples| samples.push_back((frame, status))).is_err() {
                                cx.shared.session.lock(Session::count_dropped_sample);
                            }
                            continue;
                        }
                        Ok(ToController::Update(request)) => {
                            update(&mut kept.store, &request, &mut cx.shared.session)
                        }
                        Ok(command) => {
                            tell(&mut cx.shared.session, &mut cx.shared.sensors, parties, &kept.store);
                            keep(&mut kept.keeper, &command, &mut cx.shared.session);
                            let answer =
                                cx.shared.session.lock(|session| session.handle(&command, &mut NoTicks));
                            rewire(&mut cx.shared.session, &mut cx.shared.sensors);
                            answer
                        }
                        Err(error) => cx.shared.session.lock(|session| session.bad_frame(error)),
                    };
                    if !send(&answer, |bytes| if by_probe { probe.write(bytes) } else { port.write(bytes) }) {
                        cx.shared.session.lock(Session::count_dropped_answer);
                    }
                    break;
                }
                while let Some(estimate) = cx.shared.estimates.lock(Deque::pop_front) {
                    if !(if to_probe { probe.tell(&estimate) } else { port.write(&estimate) }) {
                        cx.shared.session.lock(Session::count_dropped_estimate);
                    }
                }
                let is_due = cx.shared.session.lock(|session| {
                    let dropped = DROPPED_BYTES.load(Ordering::Relaxed);
                    session.report_line(dropped.saturating_add(cx.local.inbox.lost()), line_errors());
                    session.slow_is_due()
                });
                if is_due {
                    tell(&mut cx.shared.session, &mut cx.shared.sensors, parties, &kept.store);
                    if let Some(report) = cx.shared.session.lock(Session::slow)
                        && !send(
                            &report,
                            |bytes| if to_probe { probe.tell(bytes) } else { port.write(bytes) },
                        )
                    {
                        cx.shared.session.lock(Session::count_dropped_answer);
                    }
                }
                replace_altered(&mut kept.store, &mut cx.shared.session);
                look_at_constants(background, &mut cx.shared.session);
                go_on(background, attendance, |stack| cx.shared.session.lock(|s| s.report_stack(stack)));
            },
        }
    }

    /// What the port found wrong so far.
    fn line_errors() -> LineErrors {
        LineErrors {
            overruns: OVERRUNS.load(Ordering::Relaxed),
            framing: FRAMING.load(Ordering::Relaxed),
            noise: NOISE.load(Ordering::Relaxed),
        }
    }

    /// Goes on with the check of the code, and looks at what the run must not change. Neither may go on altered; the next start finds the code so, too,
    /// and refuses every run.
    fn look_at_constants(background: &mut Background, session: &mut impl rtic::Mutex<T = Session>) {
        let hold = session.lock(Session::constants_hold);
        if !hold || background.code.as_mut().is_some_and(|code| code.step(CODE_WORDS_A_PASS, code_word)) {
            give_up(FaultKind::Starved { missing: MISSING_SELF_TEST });
        }
    }

    /// Goes on with the self-test and the search for the stack's mark.
    fn go_on(
        background: &mut Background,
        attendance: &Attendance,
        report: impl FnOnce(link::start::StackReport),
    ) {
        if background.self_test.step() == Progress::Passed {
            check_in(attendance, Party::SelfTest);
        }
        report(stack_used(&mut background.mark));
    }

    /// Serves a request about models. New networks are switched to between two samples; everything before that is done while
    /// estimates go on.
    fn update(
        store: &mut Store<Memory>,
        request: &UpdateRequest,
        session: &mut impl rtic::Mutex<T = Session>,
    ) -> ToHost {
        let estimating = session.lock(|session| session.state() != State::Waiting);
        let served = store.serve(request, estimating);
        if let UpdateAnswer::Refused(_) = served.answer {
            defmt::warn!(
                "request about models refused; packages refused so far: {=u16}",
                store.status().refused
            );
        }
        if let Some(models) = served.models {
            session.lock(|session| session.switch(models));
        }
        ToHost::Update(served.answer)
    }

    /// Gives the board's sensors the wiring of a configuration that has just been accepted.
    fn rewire(
        session: &mut impl rtic::Mutex<T = Session>,
        sensors: &mut impl rtic::Mutex<T = Option<Sensors>>,
    ) {
        if let Some(wiring) = session.lock(Session::take_wiring) {
            sensors.lock(|sensors| {
                if let Some(sensors) = sensors {
                    sensors.rewire(wiring);
                }
            });
        }
    }

    /// Tells the session what it reports of others: who has checked in, how the models stand.
    fn tell(
        session: &mut impl rtic::Mutex<T = Session>,
        sensors: &mut impl rtic::Mutex<T = Option<Sensors>>,
        parties: [Presence; PARTIES.len()],
        store: &Store<Memory>,
    ) {
        let models = store.status();
        let sample = sensors.lock(|sensors| sensors.as_ref().map(Sensors::latest));
        session.lock(|session| session.report_beside(uptime_us(), parties, models, sample));
    }

    /// Keeps the configuration if that is what a message wants, before the session answers it.
    fn keep(
        keeper: &mut Keeper<Memory>,
        message: &ToController,
        session: &mut impl rtic::Mutex<T = Session>,
    ) {
        if let Some(configuration) = session.lock(|session| session.to_keep(message)) {
            let kept = keeper.keep(CONFIGURATION_VERSION.into(), &configuration).is_ok();
            session.lock(|session| session.take_kept(kept));
        }
    }

    /// Gives the session sound networks when it has found those in use altered.
    fn replace_altered(store: &mut Store<Memory>, session: &mut impl rtic::Mutex<T = Session>) {
        if session.lock(Session::take_altered) {
            let models = store.replace_altered();
            session.lock(|session| session.switch(models));
        }
    }

    /// Frames an answer and hands it to the link; false if the link did not take it. The host's wait is bounded.
    fn send(answer: &ToHost, write: impl FnOnce(&[u8]) -> bool) -> bool {
        let mut buffer = [0; MAX_FRAME];
        encode(answer, &mut buffer).is_ok_and(write)
    }
}
