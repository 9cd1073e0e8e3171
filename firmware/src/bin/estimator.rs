//! The estimator as an image for a board.
//!
//! Tasks and their priorities:
//!
//! * `sampled`, 3: end of a sample that hardware takes. Stamps the sample and starts `tick`. No
//!   task and no lock masks it.
//! * `tick`, 2: SysTick. Reviews the check-ins and kicks the watchdog. Paced by a timer, it takes a
//!   sample, estimates and queues the estimate.
//! * `received`, 1: serial port. Counts receive errors; without DMA it also stores the received
//!   bytes.
//! * `idle`, 0: link service over the serial port and a debug probe, or over files of the host.
//!
//! Deadline: the work of a tick must end before the next tick; the session watches it. Received
//! bytes never preempt a tick: on silicon DMA stores them, in the emulator they wait for their
//! interrupt. Bytes without room are dropped and counted.
//!
//! In the emulator's lockstep each sample frame is a tick: `idle` estimates, and the lock of the
//! shared session keeps SysTick's task out, so that the instruction count of a tick repeats.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is for a microcontroller; build it with `cargo xtask firmware`");
}

#[cfg(target_os = "none")]
#[rtic::app(device = firmware::boards::device, peripherals = true)]
mod app {
    use controller::Session;
    use controller::sensors::Collected;
    use controller::service::{
        Background, LINK_KEY, LinkService, Pacing, Ports, SharedSession, Stop, Stores, Tick, Unconnected,
    };
    use controller::session::{Identity, OwnSampling};
    use controller::store::key;
    use controller::supervisor::light::{lit, shown};
    use controller::supervisor::{Attendance, Party, Verdict};
    use cortex_m::peripheral::SCB;
    use firmware::boards::{
        BOARD, Board, COLLECTED, Collector, Files, Light, Link, Memory, PACKAGES_FOR, Pacer, Platform, Probe,
        Receiver, Sensors, SerialTransport, Storage, Timer, Watchdog, check_in, code_check, give_up, leave,
        postpone, receive, stack_mark, start, started, uptime_us,
    };
    use heapless::spsc::{Consumer, Producer, Queue};
    use link::Target;
    use link::start::{FaultKind, MISSING_SELF_TEST, StartReport};

    /// Capacity for bytes received by interrupt, the same as that of the DMA buffer.
    const BYTES: usize = 1024;

    #[shared]
    struct Shared {
        #[expect(unsafe_code, reason = "the campaign of faults looks for the symbol's name")]
        #[unsafe(export_name = "PINTLE_SESSION")]
        exchange: SharedSession<Sensors>,
        attendance: Attendance,
    }

    #[local]
    struct Local {
        transports: Transports,
        service: LinkService<Memory>,
        idle_timer: Timer,
        tick_timer: Timer,
        pacer: Pacer,
        receiver: Receiver,
        bytes_in: Producer<'static, u8>,
        collector: Collector,
        samples_in: Producer<'static, Collected>,
        samples: Consumer<'static, Collected>,
        watchdog: Watchdog,
        light: Light,
        start: StartReport,
        pacing: Pacing,
    }

    /// Transports of the link.
    pub enum Transports {
        /// Files of the host, in lockstep.
        Files(Ports<Files, Unconnected>),
        /// Serial port and debug probe, paced by the timer.
        SerialAndProbe(Ports<SerialTransport, Probe>),
    }

    #[init(local = [
        #[expect(unsafe_code, reason = "the campaign of faults looks for the symbol's name")]
        #[unsafe(export_name = "PINTLE_RECEIVED_BYTES")]
        byte_queue: Queue<u8, BYTES> = Queue::new(),
        sample_queue: Queue<Collected, COLLECTED> = Queue::new(),
    ])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let Board {
            identity,
            start,
            link,
            receiver,
            inbox,
            timer,
            pacer,
            watchdog,
            light,
            attendance,
            storage,
            sensors,
            collector,
        } = start(cx.core, cx.device);
        let (bytes_in, bytes) = cx.local.byte_queue.split();
        let (samples_in, samples) = cx.local.sample_queue.split();
        let (pacing, transports) = match link {
            Link::Files(files) => (Pacing::Lockstep, Transports::Files(Ports::new(files, Unconnected))),
            Link::Serial(transmitter, probe) => {
                let serial = SerialTransport::new(inbox, bytes, transmitter);
                (Pacing::Timer, Transports::SerialAndProbe(Ports::new(serial, probe)))
            }
        };
        let mut session = Session::new(identity);
        session.set_start_report(start);
        let can_sample = pacing == Pacing::Timer && sensors.is_some();
        let input_interval_ns = pacer.sample_clock().map_or(0, |clock| clock.report().input_interval_ns);
        session.set_own_sampling(
            can_sample.then(|| OwnSampling {
                shortest_period_us: shortest_period_us(&identity),
                input_interval_ns,
            }),
        );
        let Storage { slots, places } = storage;
        let (stores, models) = Stores::start(slots, places, PACKAGES_FOR, key::KEYS);
        session.switch_models(models);
        let platform = Platform::new(&attendance, timer);
        let background = Background::start(code_check(), stack_mark(), &mut session, &platform);
        // Opaque, so that every image has the same code and the checks of one hold for all.
        let key = core::hint::black_box(LINK_KEY);
        let service = LinkService::new(pacing, stores, key, background);
        // Both are expected from now on; sampling and inference only when there is something to
        // estimate.
        check_in(&attendance, Party::Link);
        check_in(&attendance, Party::SelfTest);
        started(&start, &identity, can_sample);
        (
            Shared { exchange: SharedSession::new(session, sensors), attendance },
            Local {
                transports,
                service,
                idle_timer: timer,
                tick_timer: timer,
                pacer,
                receiver,
                bytes_in,
                collector,
                samples_in,
                samples,
                watchdog,
                light,
                start,
                pacing,
            },
        )
    }

    /// Counts receive errors of the serial port and stores the byte if bytes arrive by interrupt.
    #[task(binds = SERIAL, priority = 1, local = [receiver, bytes_in])]
    fn received(cx: received::Context) {
        receive(cx.local.receiver, cx.local.bytes_in);
    }

    /// Takes the words of a sample and starts the tick. Without room the tick is late by several
    /// periods; the sample is then missing in the numbers and counted.
    #[task(binds = SAMPLED, priority = 3, local = [collector, samples_in])]
    fn sampled(cx: sampled::Context) {
        if let Some(collected) = cx.local.collector.collect() {
            let _ = cx.local.samples_in.enqueue(collected);
            postpone();
            SCB::set_pendst();
        }
    }

    /// Runs the supervisor's review and, paced by a timer, one sample period.
    #[task(
        binds = SysTick,
        priority = 2,
        local = [tick_timer, pacer, samples, watchdog, light, start, pacing],
        shared = [exchange, &attendance]
    )]
    fn tick(mut cx: tick::Context) {
        let acquired = cx.local.pacer.tick(cx.local.samples);
        let now_us = uptime_us();
        let attendance = cx.shared.attendance;
        match attendance.review(now_us) {
            Verdict::Kick => cx.local.watchdog.kick(),
            Verdict::Starved { missing } => give_up(FaultKind::Starved { missing }),
        }
        let is_running = cx.shared.exchange.lock(|exchange| {
            let is_running = exchange.is_running();
            if *cx.local.pacing == Pacing::Timer {
                check_in(attendance, Party::Sampling);
                let is_paced = cx.local.pacer.set_period(exchange.sample_period_us());
                let mut timer = cx.local.pacer.timer(*cx.local.tick_timer);
                if let Some(clock) = cx.local.pacer.sample_clock() {
                    exchange.note_sampling(clock);
                }
                let is_stalled = cx.local.pacer.is_stalled();
                if is_stalled {
                    exchange.restart_samples();
                }
                match exchange.tick(&acquired, is_paced && !is_stalled, &mut timer) {
                    Tick::Sampled => check_in(attendance, Party::Inference),
                    Tick::Idle => attendance.stop_expecting(Party::Inference),
                }
            }
            is_running
        });
        cx.local.light.show(lit(shown(cx.local.start, is_running), now_us));
    }

    /// Returns the shortest period of own samples, us. The emulator's time is not that of a board.
    fn shortest_period_us(identity: &Identity) -> u32 {
        match identity.target {
            Target::Silicon => BOARD.microcontroller.shortest_period_us(identity.core_hz),
            _ => 0,
        }
    }

    /// Runs the link service.
    #[idle(local = [transports, service, idle_timer], shared = [exchange, &attendance])]
    fn idle(mut cx: idle::Context) -> ! {
        let mut platform = Platform::new(cx.shared.attendance, *cx.local.idle_timer);
        let (service, exchange) = (cx.local.service, &mut cx.shared.exchange);
        // Here and not in `init`: its large frame would lie below this one on the stack.
        service.restore(exchange, &platform);
        let _hello = match cx.local.transports {
            Transports::Files(ports) => service.announce(ports, exchange),
            Transports::SerialAndProbe(ports) => service.announce(ports, exchange),
        };
        #[cfg(feature = "provoke")]
        firmware::boards::provoke(&_hello.start, cx.shared.attendance);
        loop {
            let outcome = match cx.local.transports {
                Transports::Files(ports) => service.pass(ports, exchange, &mut platform),
                Transports::SerialAndProbe(ports) => service.pass(ports, exchange, &mut platform),
            };
            match outcome {
                Ok(()) => {}
                Err(Stop::Closed) => {
                    #[cfg(feature = "provoke")]
                    firmware::boards::provoke_at_end(&_hello.start);
                    leave()
                }
                Err(Stop::Corrupted) => give_up(FaultKind::Starved { missing: MISSING_SELF_TEST }),
            }
        }
    }
}
