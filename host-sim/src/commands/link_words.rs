//! What the controller says, in words.

use inference::Bearing;
use link::start::{FaultKind, ResetReason};
use link::update::{ModelMemory, ModelSource, UpdateStatus};
use link::{ClockSource, ControllerConfiguration, Counters, Hello, State, Target};

pub(super) fn target(target: Target) -> &'static str {
    match target {
        Target::Native => "this process",
        Target::Emulator => "emulator",
        Target::Silicon => "microcontroller",
    }
}

pub(super) fn clock(clock: ClockSource) -> &'static str {
    match clock {
        ClockSource::Host => "the host's",
        ClockSource::PllCrystal => "PLL on the crystal",
        ClockSource::PllInternal => "PLL on the internal oscillator: the crystal is missing or did not start",
        ClockSource::Crystal => "crystal without PLL: the PLL did not lock",
        ClockSource::Internal => "internal oscillator: neither crystal nor PLL (always so on the emulator)",
    }
}

pub(super) fn state(state: State) -> &'static str {
    match state {
        State::Waiting => "waiting to be configured",
        State::Running => "estimating",
        State::Tripped => {
            "tripped: estimates came late; the last good one is held (host-sim link --clear-trip lets it go on)"
        }
    }
}

pub(super) fn reset(reason: ResetReason) -> &'static str {
    match reason {
        ResetReason::Unknown => "unknown: nothing recorded it (always so on the emulator)",
        ResetReason::PowerOn => "power came on",
        ResetReason::BrownOut => "the supply dipped: look at the power supply",
        ResetReason::Pin => "reset pin",
        ResetReason::Software => "restarted by the firmware itself, on command",
        ResetReason::Watchdog => "watchdog: the firmware stood still, even its supervisor",
        ResetReason::WindowWatchdog => {
            "window watchdog, which this firmware does not use: another firmware was running"
        }
        ResetReason::LowPower => "low-power mode entered by mistake",
        ResetReason::Fault => "fault: see below",
        ResetReason::Starved => "a part of the firmware no longer did its work: see below",
    }
}

/// What a recorded fault means for whoever stands in front of the bench.
fn meaning(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::Core => "a defect in the firmware or in the memory; report it with the numbers above",
        FaultKind::StackOverflow => "the stack was too small; report it with the numbers above",
        FaultKind::Starved { .. } => {
            "the parties named did not check in within their time, so the supervisor restarted"
        }
        FaultKind::Panic => "a check in the firmware failed; report it with the numbers above",
    }
}

/// The greeting, a line each: what, text.
pub(super) fn greeting(hello: &Hello, models: &UpdateStatus) -> Vec<(&'static str, String)> {
    let build = hello.build_id.as_str();
    let mut lines = vec![
        ("build", format!("{build}, protocol {}, on the {}", hello.protocol, target(hello.target))),
        ("clock", format!("{}; core at {} MHz", clock(hello.clock), f64::from(hello.core_hz) * 1e-6)),
        ("last reset", reset(hello.start.reason).into()),
    ];
    match hello.start.fault {
        None => lines.push(("last fault", "none recorded since power came on".into())),
        Some(fault) => {
            lines.push(("last fault", fault.to_string()));
            lines.push(("", meaning(fault.kind).into()));
        }
    }
    lines.push(("state", state(hello.state).into()));
    for (bearing, model) in Bearing::ALL.into_iter().zip(hello.models) {
        let text = match model.crc {
            0 => "refused at start-up: no estimates for this bearing".into(),
            crc => format!("image {crc:08x}, training {:016x}", model.training_id),
        };
        lines.push((if bearing == Bearing::Babbitt { "model Babbitt" } else { "model plastic" }, text));
    }
    lines.push(("models from", source(models)));
    let stack = hello.stack;
    lines.push(("stack", format!("{} of {} bytes used", stack.used_bytes, stack.reserved_bytes)));
    lines
}

fn source(models: &UpdateStatus) -> String {
    let mut text = match models.running {
        ModelSource::BuiltIn => "the firmware itself".into(),
        ModelSource::Slot { slot, version, hash } => {
            let hash: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
            format!("slot {slot}, version {version}, hash {hash}")
        }
    };
    if models.memory == ModelMemory::Volatile {
        text += "; updates are forgotten without power";
    }
    if models.refused > 0 {
        text += &format!("; {} packages refused (host-sim update --status tells why)", models.refused);
    }
    if models.altered > 0 {
        text += &format!("; weights found altered {} times: the memory is failing", models.altered);
    }
    if models.development_key {
        text += "; trusts the published development key";
    }
    text
}

/// The configuration in a line.
pub(super) fn configuration(configuration: Option<&ControllerConfiguration>) -> String {
    let Some(ControllerConfiguration { bench, limits, monitor, .. }) = configuration else {
        return "none".into();
    };
    let bearing = Bearing::from_code(bench.bearing).map_or("unknown", Bearing::name);
    let or_none = |value: u32, unit: &str| if value == 0 { "none".into() } else { format!("{value} {unit}") };
    format!(
        "{bearing}, radial clearance {} mm, every {} us; force limit {}, wear alarm at {} mm, trip after {}, slow telemetry every {}",
        f64::from(bench.radial_clearance_nm) * 1e-6,
        bench.sample_period_us,
        or_none(limits.force_limit_n, "N"),
        f64::from(monitor.wear_limit_nm) * 1e-6,
        or_none(limits.deadline_trip_count.into(), "late estimates"),
        or_none(limits.slow_every.into(), "samples"),
    )
}

/// Every count with what it means.
pub(super) fn counters(counters: &Counters) -> [(&'static str, u32); 19] {
    let bad = counters.bad_frames;
    [
        ("samples served", counters.samples),
        ("with a doubt about a sensor", counters.flagged),
        ("sequence number did not follow", counters.sequence_gaps),
        ("time did not advance by the period", counters.time_faults),
        ("above the force limit", counters.over_force),
        ("estimated later than the period", counters.deadline_overruns),
        ("trips", counters.trips),
        ("held after a trip", counters.held),
        ("timer ticks without a sample", counters.idle_ticks),
        ("samples dropped, queue full", counters.dropped_samples),
        ("estimates dropped", counters.dropped_estimates),
        ("other answers dropped", counters.dropped_answers),
        ("received bytes dropped, buffer full", counters.dropped_bytes),
        ("commands repeated and answered again", counters.repeated_commands),
        ("commands refused", counters.refused_commands),
        ("frames with broken stuffing", bad.cobs),
        ("frames with a wrong check sum", bad.crc),
        ("frames too long", bad.overlong),
        ("sound frames without a known message", bad.unknown),
    ]
}
