//! Tests on a board: time base, samples, sensor bus, flash, bits and cycles of a tick.
//!
//! `cargo xtask on-target --board NAME` runs them through a debug probe, and with `--emulated` on
//! the emulator. There a test of hardware that the emulator does not model says so and passes.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is for a microcontroller; run it with `cargo xtask on-target`");
}

#[cfg(target_os = "none")]
use firmware as _;

#[cfg(target_os = "none")]
#[defmt::panic_handler]
fn failed() -> ! {
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::nop();
    }
}

/// Interrupts that the memory map binds; none of them is enabled here but SysTick's.
#[cfg(target_os = "none")]
#[expect(unsafe_code, reason = "the names that the memory map binds to the vector table")]
mod handlers {
    #[unsafe(no_mangle)]
    extern "C" fn SERIAL() {}

    #[unsafe(no_mangle)]
    extern "C" fn SAMPLED() {}

    #[unsafe(no_mangle)]
    extern "C" fn SysTick() {}
}

#[cfg(target_os = "none")]
#[defmt_test::tests]
mod tests {
    use controller::sensors::SampleClock;
    use controller::session::{IDLE_PERIOD_US, Identity};
    use controller::store::Keeper;
    use controller::store::keeper::Kind;
    use defmt::{assert, assert_eq, info, unwrap};
    use firmware::boards::{BOARD, Board, Collector, Memory, Sensors, Watchdog, start};
    use link::Target;
    use link::start::ResetReason;
    use on_target::ticks::{DIGEST, TICKS, Ticks};

    /// Samples of a test.
    const SAMPLES: u32 = 1_000;
    /// Polls for a sample: several periods.
    const POLLS: u32 = 1_000_000;
    /// Largest deviation of a sample's end from its period, ns; polled, so that it contains the
    /// time of a poll.
    const MAX_JITTER_NS: u32 = 1_000;

    /// The parts of the started board that the tests use.
    struct Bench {
        identity: Identity,
        collector: Collector,
        sensors: Option<Sensors>,
        watchdog: Watchdog,
        places: Option<Memory>,
    }

    impl Bench {
        /// True on a board; a test that needs one says that it was skipped.
        fn is_silicon(&self) -> bool {
            let is_silicon = self.identity.target == Target::Silicon;
            if !is_silicon {
                info!("skipped: not modelled by the emulator");
            }
            is_silicon
        }
    }

    #[init]
    fn init() -> Bench {
        let core = unwrap!(cortex_m::Peripherals::take());
        #[expect(unsafe_code, reason = "nothing has taken the device's peripherals before")]
        let device = unsafe { firmware::boards::device::Peripherals::steal() };
        let Board { identity, collector, sensors, watchdog, storage, start: report, .. } =
            start(core, device);
        // A fault in a test restarts all of them.
        let is_restart =
            matches!(report.reason, ResetReason::Fault | ResetReason::Starved | ResetReason::Watchdog);
        assert!(!is_restart, "a test ended with a fault or took too long");
        Bench { identity, collector, sensors, watchdog, places: Some(storage.places) }
    }

    #[before_each]
    fn kick(bench: &mut Bench) {
        bench.watchdog.kick();
    }

    #[test]
    fn the_time_base_counts_microseconds_of_the_core(bench: &mut Bench) {
        if !bench.is_silicon() {
            return;
        }
        let before = bench.collector.now();
        cortex_m::asm::delay(bench.identity.core_hz / 100);
        let after = bench.collector.now();
        let passed_us = after.time_us.wrapping_sub(before.time_us);
        let cycles = after.cycles.wrapping_sub(before.cycles);
        let core_mhz = bench.identity.core_hz / 1_000_000;
        info!("{=u32} cycles in {=u32} us", cycles, passed_us);
        // The time base has steps of a microsecond.
        assert!(cycles.abs_diff(passed_us * core_mhz) <= 2 * core_mhz);
    }

    #[test]
    fn samples_are_as_regular_as_the_timer(bench: &mut Bench) {
        if !bench.is_silicon() {
            return;
        }
        assert!(bench.sensors.is_some(), "the first sequence did not end");
        // A sample that ended long ago, whose time is not known.
        let _ = bench.collector.collect();
        let next = |collector: &mut Collector| (0..POLLS).find_map(|_| collector.collect());
        assert!(next(&mut bench.collector).is_some(), "no sample ends");
        let mut clock = SampleClock::new(bench.identity.core_hz / 1_000_000, 0);
        for _ in 0..SAMPLES {
            let collected = unwrap!(next(&mut bench.collector));
            assert!(collected.answers.is_some(), "out of step");
            clock.advance(collected.run, collected.completion, IDLE_PERIOD_US);
        }
        let report = clock.report();
        info!("{=u32} ns early, {=u32} ns late", report.early_ns, report.late_ns);
        assert_eq!((report.lost, report.halts), (0, 0));
        assert!(report.early_ns.max(report.late_ns) <= MAX_JITTER_NS);
    }

    #[test]
    fn the_sensor_bus_answers_or_names_the_fault(bench: &mut Bench) {
        let Some(sensors) = &mut bench.sensors else {
            assert!(!bench.is_silicon(), "the first sequence did not end");
            return;
        };
        match sensors.configure() {
            Ok(()) => info!("the converter has accepted its configuration"),
            Err(fault) => {
                info!("no converter: {=str}", fault.name());
                assert!(fault.name() != "bus", "the port does not clock");
            }
        }
    }

    #[test]
    fn a_number_that_is_kept_reads_back(bench: &mut Bench) {
        // The number of a start, which may rise at any time.
        const LAYOUT: u8 = 1;
        let mut keeper = Keeper::start(unwrap!(bench.places.take()));
        let number = keeper.count_bound(Kind::Start, LAYOUT) + 1;
        assert!(keeper.keep(Kind::Start, LAYOUT, &number).is_ok());
        let mut keeper = Keeper::start(keeper.into_memory());
        assert_eq!(keeper.value::<u32>(Kind::Start, LAYOUT), Some(number));
    }

    #[test]
    fn ticks_estimate_the_bits_of_the_host_in_fewer_cycles_than_allowed(bench: &mut Bench) {
        let mut ticks = unwrap!(Ticks::new(bench.identity));
        let (mut longest, mut sum) = (0, 0_u64);
        for _ in 0..TICKS {
            let sample = ticks.sample();
            let before = bench.collector.now().cycles;
            assert!(ticks.tick(&sample).is_some());
            let cycles = bench.collector.now().cycles.wrapping_sub(before);
            longest = longest.max(cycles);
            sum += u64::from(cycles);
            bench.watchdog.kick();
        }
        assert_eq!(ticks.digest(), DIGEST);
        if bench.is_silicon() {
            let limit = unwrap!(BOARD.microcontroller.handler_cycles);
            let mean = (sum / u64::from(TICKS)) as u32;
            info!("{=u32} cycles on average, {=u32} at most; limit {=u32}", mean, longest, limit);
            assert!(longest < limit);
        }
    }
}
