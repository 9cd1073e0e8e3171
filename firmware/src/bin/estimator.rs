//! The estimator as an image for the STM32F405.
//!
//! | task | priority | does |
//! |---|---|---|
//! | `received` | 3 | USART3: keeps the bytes that come in |
//! | `tick` | 2 | SysTick, 10 kHz: takes the next sample, estimates, queues the answer |
//! | `idle` | 0 | the link: frames in, commands, answers out |
//!
//! Deadline: a tick's work must end before the next tick. If it does not, that is counted and reported at the end of the run.
//!
//! In the emulator's lockstep a frame is a tick: `idle` estimates itself, with SysTick's task shut out by the session's lock, so the
//! instruction count of a tick repeats exactly.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is for a microcontroller; build it with `cargo xtask firmware`");
}

#[cfg(target_os = "none")]
#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use firmware::boards::{Board, Link, Receiver, Timer, count_log_tick, leave, start, tick_is_pending};
    use firmware::{NoTicks, Session};
    use heapless::Deque;
    use heapless::spsc::{Consumer, Producer, Queue};
    use link::{Decoder, MAX_FRAME, SensorFrame, ToController, ToHost, encode};

    /// Room for received bytes: more than a tick's worth at the line speed.
    const BYTES: usize = 256;
    /// Room for samples and for answers: the host of a lockstep has one on the way.
    const SAMPLES: usize = 8;

    #[shared]
    struct Shared {
        session: Session,
        samples: Deque<SensorFrame, SAMPLES>,
        answers: Deque<ToHost, SAMPLES>,
    }

    #[local]
    struct Local {
        link: Link,
        idle_timer: Timer,
        tick_timer: Timer,
        receiver: Receiver,
        bytes_in: Producer<'static, u8>,
        bytes: Consumer<'static, u8>,
    }

    #[init(local = [byte_queue: Queue<u8, BYTES> = Queue::new()])]
    fn init(cx: init::Context) -> (Shared, Local) {
        let Board { identity, link, receiver, timer } = start(cx.core, cx.device);
        let (bytes_in, bytes) = cx.local.byte_queue.split();
        defmt::info!("started, core at {=u32} Hz", identity.core_hz);
        (
            Shared { session: Session::new(identity), samples: Deque::new(), answers: Deque::new() },
            Local { link, idle_timer: timer, tick_timer: timer, receiver, bytes_in, bytes },
        )
    }

    /// Keeps what the serial port received; a byte without room is lost and its frame fails its check.
    #[task(binds = USART3, priority = 3, local = [receiver, bytes_in])]
    fn received(cx: received::Context) {
        if let Some(byte) = cx.local.receiver.fetch() {
            let _ = cx.local.bytes_in.enqueue(byte);
        }
    }

    /// One sample period on the serial link. In lockstep no sample ever waits here.
    #[task(binds = SysTick, priority = 2, local = [tick_timer], shared = [session, samples, answers])]
    fn tick(cx: tick::Context) {
        count_log_tick();
        (cx.shared.session, cx.shared.samples, cx.shared.answers).lock(|session, samples, answers| {
            let Some(sample) = samples.pop_front() else { return session.count_idle_tick() };
            let answer = session.handle(&ToController::Sensor(sample), cx.local.tick_timer);
            if answers.push_back(answer).is_err() {
                session.count_dropped();
            }
            if tick_is_pending() {
                session.count_overrun();
            }
        });
    }

    /// The link.
    #[idle(local = [link, idle_timer, bytes], shared = [session, samples, answers])]
    fn idle(mut cx: idle::Context) -> ! {
        let mut decoder = Decoder::new();
        // Unasked: a host that was in the middle of a run learns of the restart.
        let hello = ToHost::Hello(cx.shared.session.lock(|session| session.hello()));
        match cx.local.link {
            Link::Files(files) => send(&hello, |bytes| files.write(bytes)),
            Link::Serial(port) => send(&hello, |bytes| port.write(bytes)),
        }
        match cx.local.link {
            Link::Files(files) => loop {
                let mut buffer = [0; MAX_FRAME];
                let came = files.read(&mut buffer);
                if came.is_empty() {
                    leave();
                }
                for &byte in came {
                    let Some(message) = decoder.push::<ToController>(byte) else { continue };
                    let answer = cx.shared.session.lock(|session| match message {
                        Ok(message) => session.handle(&message, cx.local.idle_timer),
                        Err(error) => session.bad_frame(error),
                    });
                    send(&answer, |bytes| files.write(bytes));
                }
            },
            Link::Serial(port) => loop {
                while let Some(byte) = cx.local.bytes.dequeue() {
                    let answer = match decoder.push::<ToController>(byte) {
                        None => continue,
                        Some(Ok(ToController::Sensor(sample))) => {
                            if cx.shared.samples.lock(|samples| samples.push_back(sample)).is_err() {
                                cx.shared.session.lock(Session::count_dropped);
                            }
                            continue;
                        }
                        Some(Ok(command)) => {
                            cx.shared.session.lock(|session| session.handle(&command, &mut NoTicks))
                        }
                        Some(Err(error)) => cx.shared.session.lock(|session| session.bad_frame(error)),
                    };
                    send(&answer, |bytes| port.write(bytes));
                }
                while let Some(answer) = cx.shared.answers.lock(Deque::pop_front) {
                    send(&answer, |bytes| port.write(bytes));
                }
            },
        }
    }

    /// Frames an answer and hands it to the link. A frame that the link does not take is lost, and the host's wait is bounded.
    fn send(answer: &ToHost, write: impl FnOnce(&[u8]) -> bool) {
        let mut buffer = [0; MAX_FRAME];
        let sent = encode(answer, &mut buffer).is_ok_and(write);
        if !sent {
            defmt::warn!("an answer was not taken");
        }
    }
}
