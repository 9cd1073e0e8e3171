//! Times of the controller's own samples, from two counters that a debugger treats differently.
//!
//! The *time base* counts microseconds from the start, also while a debugger has halted the core.
//! The *cycle counter* of the core stops then. Both are read when a sample is complete, in an
//! interrupt that no task and no lock masks. From them follow
//!
//! * the samples that were lost, because the timer ran on and nothing took them;
//! * the halts of the core, and how long they were;
//! * how much earlier or later than the period a sample was complete, which bounds the jitter of
//!   the instants of sampling: it includes the latency of the interrupt.
//!
//! The time of a sample is a multiple of the period after the one before, without the jitter of the
//! reading.

use link::SamplingReport;

use super::Answers;

/// Shortest halt that is counted, us. The readings differ by less.
const MIN_HALT_US: u32 = 3;

/// Counters at the end of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Completion {
    /// Time base, us, modulo 2^32.
    pub time_us: u32,
    /// Cycle counter of the core, modulo 2^32.
    pub cycles: u32,
}

/// A complete sequence.
#[derive(Clone, Copy, Debug)]
pub struct Collected {
    /// Number of the run of the hardware.
    pub run: u32,
    /// Words from the sensors; `None` if the next sequence has overtaken them.
    pub answers: Option<Answers>,
    /// Counters at its end.
    pub completion: Completion,
}

/// A tick of the sample timer with what arrived.
#[derive(Clone, Copy, Debug)]
pub struct Acquired {
    /// Time of the sample, us, modulo 2^32.
    pub time_us: u32,
    /// Samples that were lost since the one before.
    pub lost: u32,
    /// Number of the run of the hardware.
    pub run: u32,
    /// Words from the sensors; `None` if there are none of a complete sequence.
    pub answers: Option<Answers>,
}

impl Acquired {
    /// A tick without samples of the board.
    #[must_use]
    pub const fn nothing(time_us: u32) -> Self {
        Self { time_us, lost: 0, run: 0, answers: None }
    }
}

/// Watch over the times of the samples.
#[derive(Clone, Debug)]
pub struct SampleClock {
    core_mhz: u32,
    /// Last sample, with the number of its run.
    last: Option<(u32, Completion)>,
    /// Time of the last sample, us.
    time_us: u32,
    /// Cycles by which a sample was complete earlier and later than its period.
    early_late: [u32; 2],
    report: SamplingReport,
}

/// Ticks of the sample timer since the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passed {
    /// Time of this tick, us, modulo 2^32.
    pub time_us: u32,
    /// Ticks without a sample between the last one and this.
    pub lost: u32,
}

impl SampleClock {
    /// Creates the clock for a frequency of the core in MHz, and the time between the samples of
    /// two successive inputs in ns.
    #[must_use]
    pub const fn new(core_mhz: u32, input_interval_ns: u32) -> Self {
        let report =
            SamplingReport { lost: 0, halts: 0, halted_us: 0, early_ns: 0, late_ns: 0, input_interval_ns };
        Self { core_mhz, last: None, time_us: 0, early_late: [0; 2], report }
    }

    /// Takes the end of a sequence of a run of the hardware. `period_us` is the period of the timer
    /// since the last one. A new run starts anew, but for the counts of lost samples and halts.
    pub fn advance(&mut self, run: u32, now: Completion, period_us: u32) -> Passed {
        let last = self.last.replace((run, now));
        let Some((_, last)) = last.filter(|(before, _)| *before == run) else {
            self.time_us = now.time_us;
            self.early_late = [0; 2];
            return Passed { time_us: now.time_us, lost: 0 };
        };
        let cycles = now.cycles.wrapping_sub(last.cycles);
        let ticks = ticks(now.time_us.wrapping_sub(self.time_us), period_us);
        let passed_us = ticks.wrapping_mul(period_us);
        let is_on_grid = self.is_near(now.time_us, passed_us, period_us);
        self.time_us = if is_on_grid { self.time_us.wrapping_add(passed_us) } else { now.time_us };
        let lost = ticks.saturating_sub(1);
        self.report.lost = self.report.lost.saturating_add(lost);
        let is_halted = self.watch_halt(now.time_us.wrapping_sub(last.time_us), cycles);
        if is_on_grid && !is_halted {
            self.watch_jitter(cycles, passed_us.wrapping_mul(self.core_mhz));
        }
        Passed { time_us: self.time_us, lost }
    }

    /// Counts a lost sample because the hardware has stopped; it starts anew.
    pub const fn count_stall(&mut self) {
        self.report.lost = self.report.lost.saturating_add(1);
    }

    /// Returns what was counted and measured since the start.
    #[must_use]
    pub fn report(&self) -> SamplingReport {
        let ns = |cycles: u32| cycles.saturating_mul(1_000).checked_div(self.core_mhz).unwrap_or_default();
        let [early, late] = self.early_late;
        SamplingReport { early_ns: ns(early), late_ns: ns(late), ..self.report }
    }

    /// Decides whether a time is a multiple of the period after the last sample.
    const fn is_near(&self, now_us: u32, passed_us: u32, period_us: u32) -> bool {
        let off = now_us.wrapping_sub(self.time_us).wrapping_sub(passed_us).cast_signed();
        passed_us != 0 && off.unsigned_abs() <= period_us / 4
    }

    /// Counts a halt if the core ran for a shorter time than has passed.
    fn watch_halt(&mut self, passed_us: u32, cycles: u32) -> bool {
        let expected = u64::from(passed_us).wrapping_mul(self.core_mhz.into());
        let missing = expected.saturating_sub(cycles.into());
        let is_halted = missing > u64::from(MIN_HALT_US.wrapping_mul(self.core_mhz));
        if is_halted {
            let halted_us = missing.checked_div(self.core_mhz.into()).unwrap_or_default();
            let halted_us = u32::try_from(halted_us).unwrap_or(u32::MAX);
            self.report.halts = self.report.halts.saturating_add(1);
            self.report.halted_us = self.report.halted_us.saturating_add(halted_us);
        }
        is_halted
    }

    /// Notes by how much the time between two ends of a sequence differs from the expected one.
    fn watch_jitter(&mut self, cycles: u32, expected: u32) {
        let [early, late] = &mut self.early_late;
        let off = cycles.wrapping_sub(expected).cast_signed();
        let side = if off < 0 { early } else { late };
        *side = (*side).max(off.unsigned_abs());
    }
}

/// Returns the number of periods in a time, rounded. Without a division in the usual case, because
/// its duration depends on the data.
const fn ticks(passed_us: u32, period_us: u32) -> u32 {
    let half = period_us / 2;
    if passed_us.wrapping_sub(half) < period_us {
        return 1;
    }
    match passed_us.saturating_add(half).checked_div(period_us) {
        Some(ticks) => ticks,
        None => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MHZ: u32 = 168;
    const PERIOD_US: u32 = 300;

    /// Hardware: a time base, a core that can be halted, and the latency of the interrupt.
    struct Hardware {
        time_us: f64,
        cycles: f64,
    }

    impl Hardware {
        /// Time passes, of which the core is halted for a part.
        fn pass(&mut self, time_us: f64, halted_us: f64) {
            self.time_us += time_us;
            self.cycles += (time_us - halted_us) * f64::from(MHZ);
        }

        fn complete(&self, latency_us: f64) -> Completion {
            Completion {
                time_us: (self.time_us + latency_us) as u64 as u32,
                cycles: (self.cycles + latency_us * f64::from(MHZ)) as u64 as u32,
            }
        }
    }

    fn started(start_us: f64) -> (Hardware, SampleClock) {
        let hardware = Hardware { time_us: start_us, cycles: start_us * 3.0 };
        let mut clock = SampleClock::new(MHZ, 0);
        clock.advance(0, hardware.complete(0.5), PERIOD_US);
        (hardware, clock)
    }

    proptest! {
        #[test]
        fn lost_samples_and_halts_are_counted_exactly_across_the_counters_ends(
            start_us in 4_290_000_000.0..4_295_000_000.0_f64,
            steps in prop::collection::vec((0_u32..3, 0.0..0.9_f64, any::<bool>()), 1..200),
        ) {
            let (mut hardware, mut clock) = started(start_us);
            let mut at_us = clock.time_us;
            let (mut lost, mut halts) = (0, 0);
            for (missed, latency_us, is_halted) in steps {
                let time_us = f64::from((missed + 1) * PERIOD_US);
                hardware.pass(time_us, if is_halted { time_us - 100.0 } else { 0.0 });
                let passed = clock.advance(0, hardware.complete(latency_us), PERIOD_US);
                at_us = at_us.wrapping_add((missed + 1) * PERIOD_US);
                prop_assert_eq!(passed, Passed { time_us: at_us, lost: missed });
                (lost, halts) = (lost + missed, halts + u32::from(is_halted));
            }
            let report = clock.report();
            prop_assert_eq!((report.lost, report.halts), (lost, halts));
            // Latencies of at most .9 us: a halt is no jitter.
            prop_assert!(report.early_ns.max(report.late_ns) < 1_000, "{:?}", report);
        }
    }

    #[test]
    fn a_halt_of_a_minute_is_measured() {
        let (mut hardware, mut clock) = started(5.0);
        hardware.pass(60e6, 60e6 - 300.0);
        assert_eq!(clock.advance(0, hardware.complete(0.5), PERIOD_US).lost, 199_999);
        let report = clock.report();
        assert!((59_999_600..=59_999_800).contains(&report.halted_us), "{report:?}");
    }

    #[test]
    fn early_and_late_samples_are_measured_in_nanoseconds() {
        let (mut hardware, mut clock) = started(5.0);
        // Latencies of .5, .6, .2 and .5 us.
        for latency_us in [0.6, 0.2, 0.5] {
            hardware.pass(f64::from(PERIOD_US), 0.0);
            clock.advance(0, hardware.complete(latency_us), PERIOD_US);
        }
        let report = clock.report();
        assert!(report.early_ns.abs_diff(400) < 12 && report.late_ns.abs_diff(300) < 12, "{report:?}");
        assert_eq!((report.lost, report.halts), (0, 0));
    }

    #[test]
    fn a_restart_of_the_hardware_costs_no_sample_and_starts_the_jitter_anew() {
        let (mut hardware, mut clock) = started(5.0);
        hardware.pass(f64::from(PERIOD_US), 0.0);
        clock.advance(0, hardware.complete(0.9), PERIOD_US);
        hardware.pass(1_234.0, 0.0);
        assert_eq!(clock.advance(1, hardware.complete(0.5), PERIOD_US), Passed { time_us: 1_539, lost: 0 });
        assert_eq!(clock.report(), SamplingReport::default());
    }

    #[test]
    fn a_sample_that_is_not_on_the_grid_starts_a_new_one() {
        let (mut hardware, mut clock) = started(5.0);
        hardware.pass(120.0, 0.0);
        let passed = clock.advance(0, hardware.complete(0.5), PERIOD_US);
        assert_eq!(passed, Passed { time_us: 125, lost: 0 });
        hardware.pass(f64::from(PERIOD_US), 0.0);
        assert_eq!(clock.advance(0, hardware.complete(0.5), PERIOD_US).time_us, 425);
    }
}
