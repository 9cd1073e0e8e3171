//! Lines of the controller's log. A debug probe shows them (`host-sim flash --follow`).

use controller::service::{LogEvent, LoggedState, Losses};
use controller::session::Identity;
use link::start::{FaultKind, FaultRecord, ResetReason, StartReport};
use link::{ClockSource, State};

/// Logs a start: reason, clock, source of the samples, and the fault that is stored.
pub fn started(start: &StartReport, identity: &Identity, can_sample: bool) {
    let clock = match identity.clock {
        ClockSource::PllCrystal => "the PLL on the crystal",
        ClockSource::PllInternal => "the PLL on the internal oscillator",
        ClockSource::Crystal => "the crystal alone",
        ClockSource::Internal => "the internal oscillator alone",
        ClockSource::Host => "the host",
    };
    let reason = match start.reason {
        ResetReason::Unknown => "an unknown reason",
        ResetReason::PowerOn => "power on",
        ResetReason::BrownOut => "a dip of the supply",
        ResetReason::Pin => "the reset pin",
        ResetReason::Software => "software or a probe",
        ResetReason::Watchdog | ResetReason::WindowWatchdog => "a watchdog",
        ResetReason::LowPower => "a return from low power",
        ResetReason::Fault => "a fault",
        ResetReason::Starved => "the supervisor",
    };
    defmt::info!("started by {=str}; core at {=u32} Hz from {=str}", reason, identity.core_hz, clock);
    if can_sample {
        defmt::info!("own samples are possible");
    } else {
        defmt::warn!("no own samples: no sensors, or their first sequence did not end");
    }
    if let Some(FaultRecord { kind, pc, .. }) = start.fault {
        let kind = match kind {
            FaultKind::Core => "fault of the core",
            FaultKind::StackOverflow => "stack overflow",
            FaultKind::Starved { .. } => "a task was missing",
            FaultKind::Panic => "panic",
        };
        defmt::error!("stored fault: {=str}, at {=u32:#010x}", kind, pc);
    }
}

/// Logs an event of the link service.
pub(super) fn event(event: &LogEvent) {
    match *event {
        LogEvent::State(LoggedState { state, is_sampling, period_us }) => {
            let state = match state {
                State::Waiting => "waiting for a configuration",
                State::Running if is_sampling => "estimating from own samples",
                State::Running => "estimating from the host's samples",
                State::Tripped => "tripped by late estimates",
            };
            defmt::info!("{=str}, every {=u32} us", state, period_us);
        }
        LogEvent::Losses(Losses { late, samples, estimates, received, commands }) => {
            defmt::warn!(
                "so far late {=u32}, lost: samples {=u32}, estimates {=u32}, bytes and frames {=u32}; \
                 commands refused {=u32}",
                late,
                samples,
                estimates,
                received,
                commands
            );
        }
        LogEvent::RefusedUpdate(count) => {
            defmt::warn!("request about models refused; packages refused so far: {=u16}", count);
        }
    }
}
