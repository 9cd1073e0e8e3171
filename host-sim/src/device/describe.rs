//! Text for what a controller reports.

use inference::{BearingMaterial, Flags};
use link::authentication::Authentication;
use link::start::{FaultKind, KeptConfiguration, PARTIES, ResetReason, SupervisorReport};
use link::track::{FrictionState, SafeState, TrackReport, Wear};
use link::update::{ModelMemory, ModelSource, SlotState, UpdateStatus};
use link::{
    ClockSource, ControllerConfiguration, Counters, EstimateFrame, Hello, SamplingReport, SensorFrame, State,
    Target,
};

pub(crate) fn target(target: Target) -> &'static str {
    match target {
        Target::Native => "this process",
        Target::Emulator => "emulator",
        Target::Silicon => "microcontroller",
    }
}

pub(crate) fn clock(clock: ClockSource) -> &'static str {
    match clock {
        ClockSource::Host => "the host's",
        ClockSource::PllCrystal => "PLL on the crystal",
        ClockSource::PllInternal => "PLL on the internal oscillator: the crystal is missing or did not start",
        ClockSource::Crystal => "crystal without PLL: the PLL did not lock",
        ClockSource::Internal => "internal oscillator: neither crystal nor PLL (always so on the emulator)",
    }
}

pub(crate) fn state(state: State) -> &'static str {
    match state {
        State::Waiting => "waiting to be configured",
        State::Running => "estimating",
        State::Tripped => {
            "tripped: estimates were late; the last good one is held (host-sim link --clear-trip resumes)"
        }
    }
}

pub(crate) fn reset(reason: ResetReason) -> &'static str {
    match reason {
        ResetReason::Unknown => "unknown: nothing recorded it (always so on the emulator)",
        ResetReason::PowerOn => "power-on",
        ResetReason::BrownOut => "supply voltage dipped: check the power supply",
        ResetReason::Pin => "reset pin",
        ResetReason::Software => "restarted by the firmware, on command",
        ResetReason::Watchdog => "watchdog: the firmware stopped, and its supervisor too",
        ResetReason::WindowWatchdog => {
            "window watchdog, which this firmware does not use: another firmware was running"
        }
        ResetReason::LowPower => "low-power mode entered by mistake",
        ResetReason::Fault => "fault: see below",
        ResetReason::Starved => "a part of the firmware stopped working: see below",
    }
}

/// Meaning of a recorded fault for the user.
fn meaning(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::Core => "a defect in the firmware or in the memory; report it with the numbers above",
        FaultKind::StackOverflow => "the stack was too small; report it with the numbers above",
        FaultKind::Starved { .. } => {
            "the named parts did not check in within their time, so the supervisor restarted the controller"
        }
        FaultKind::Panic => "a check in the firmware failed; report it with the numbers above",
    }
}

/// Identity and last start: name and text per line.
pub(crate) fn identity(hello: &Hello, models: &UpdateStatus) -> Vec<(&'static str, String)> {
    let build = hello.build_id.as_str();
    let mut lines = vec![
        ("build", format!("{build}, protocol {}, on the {}", hello.protocol, target(hello.target))),
        ("clock", format!("{}; core at {} MHz", clock(hello.clock), f64::from(hello.core_hz) * 1e-6)),
        ("last reset", reset(hello.start.reason).into()),
    ];
    match hello.start.fault {
        None => lines.push(("last fault", "none recorded since power-on".into())),
        Some(fault) => {
            lines.push(("last fault", fault.to_string()));
            lines.push(("", meaning(fault.kind).into()));
        }
    }
    if let Some(text) = kept(hello.start.kept) {
        lines.push(("kept", text));
    }
    if let Authentication::Required { start, .. } = hello.authentication {
        lines.push(("commands", format!("only with the key of the link; start number {start}")));
    }
    lines.push(("state", state(hello.state).into()));
    for (bearing, model) in BearingMaterial::ALL.into_iter().zip(hello.models) {
        let text = match model.crc {
            0 => "refused at start-up: no estimates for this bearing".to_owned(),
            crc => format!("image {crc:08x}, training {:016x}", model.training_id),
        };
        lines.push(("model", format!("{}: {text}", bearing.title())));
    }
    lines.push(("models from", source(models)));
    let stack = hello.stack;
    lines.push(("stack", format!("{} of {} bytes used", stack.used_bytes, stack.reserved_bytes)));
    lines
}

/// Use of the kept configuration; none if there is none.
fn kept(kept: KeptConfiguration) -> Option<String> {
    match kept {
        KeptConfiguration::None => None,
        KeptConfiguration::Restored => Some("configuration, taken at the start".into()),
        KeptConfiguration::Refused => {
            Some("configuration, refused by this firmware: configure it again to see why".into())
        }
        KeptConfiguration::SetAside { faulted_starts } => Some(format!(
            "configuration, not used: {faulted_starts} starts in a row faulted with it; keep another one, \
             or reset the controller by its pin to try it again"
        )),
    }
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
        text += "; updates are lost without power";
    }
    if models.refused > 0 {
        text += &format!("; {} packages refused (reasons: host-sim update --status)", models.refused);
    }
    if models.corrupted > 0 {
        text += &format!("; weights found corrupted {} times: the memory is failing", models.corrupted);
    }
    if models.development_key {
        text += "; trusts the published development key";
    }
    if models.revoked_keys > 0 {
        text += &format!("; {} keys revoked, {} trusted", models.revoked_keys, models.trusted_keys);
    }
    text
}

/// Model slots and the last refused package, a line each.
pub(crate) fn slots(models: &UpdateStatus) -> Vec<(&'static str, String)> {
    let mut lines: Vec<_> = models
        .slots
        .iter()
        .zip(["slot 0", "slot 1"])
        .map(|(slot, name)| {
            let text = match slot {
                SlotState::Blank => "blank".into(),
                SlotState::Unfinished => "an incomplete package".into(),
                SlotState::Valid { version } => format!("version {version}, valid"),
                SlotState::Refused => "a refused package".into(),
            };
            (name, text)
        })
        .collect();
    lines.push(("next version", format!("{} or higher", models.min_version)));
    if let Some(refused) = models.last_refusal {
        lines.push(("last refusal", format!("version {}: {}", refused.version, refused.reason)));
    }
    lines
}

/// Report of the supervisor, a line each.
pub(crate) fn supervisor(known: &SupervisorReport) -> Vec<(&'static str, String)> {
    let mut lines = vec![("running for", format!("{:.1} s (of 4295 s)", seconds(known.uptime_us)))];
    for (party, name) in known.parties.iter().zip(PARTIES) {
        let text = if party.expected {
            format!(
                "checked in {:.4} s ago; {:.4} s at most, {:.4} s allowed: {:.4} s of margin",
                seconds(party.away_us),
                seconds(party.longest_us),
                seconds(party.period_us),
                seconds(party.margin_us())
            )
        } else {
            "not expected".into()
        };
        lines.push((name, text));
    }
    lines
}

fn seconds(us: u32) -> f64 {
    f64::from(us) * 1e-6
}

/// Tracked values, a line each.
pub(crate) fn track(track: &TrackReport) -> Vec<(&'static str, String)> {
    let times = |times: u32| if times == 0 { String::new() } else { format!(", raised {times} times") };
    let clearance = match track.radial_clearance_deviation_nm {
        u32::MAX => "no evidence yet".into(),
        deviation => format!(
            "{:.4} mm, deviation {:.4} mm",
            f64::from(track.radial_clearance_nm) * 1e-6,
            f64::from(deviation) * 1e-6
        ),
    };
    let friction = match track.friction_level_deviation_per_mille {
        u32::MAX => "no evidence yet".into(),
        deviation => format!(
            "{:.3}, deviation {:.3}",
            f64::from(track.friction_level_per_mille) * 1e-3,
            f64::from(deviation) * 1e-3
        ),
    };
    let wear = match track.wear {
        Wear::Unknown => "not enough evidence",
        Wear::Below => "below the limit",
        Wear::Alarm => "ALARM: above the limit",
    };
    let friction_alarm = match track.friction {
        FrictionState::NoLimit => "no limit",
        FrictionState::Unknown => "not enough evidence",
        FrictionState::Below => "below the limit",
        FrictionState::Alarm => "ALARM: above the limit",
    };
    let safe = match track.safe_state {
        SafeState::Starting => "starting: no trusted estimate yet",
        SafeState::Live => "live",
        SafeState::Held => "held: the last trusted estimate is repeated",
        SafeState::Lost => "lost: held for too long, the forces are 0",
    };
    vec![
        ("estimates", safe.into()),
        ("clearance", clearance),
        ("wear", format!("{wear}{}", times(track.wear_alarms))),
        ("friction level", friction),
        ("friction", format!("{friction_alarm}{}", times(track.friction_alarms))),
    ]
}

/// Names of an estimate's flags.
pub(crate) fn flags(estimate: &EstimateFrame) -> Vec<&'static str> {
    names(estimate.flags)
}

/// Names of flags.
pub(crate) fn names(flags: u32) -> Vec<&'static str> {
    let flags = Flags::from_bits(flags);
    controller::flags::NAMES.iter().filter(|(flag, _)| flags.contains(*flag)).map(|(_, name)| *name).collect()
}

/// A sample of the controller's own sensors, in one line.
pub(crate) fn sample(sample: &SensorFrame) -> String {
    format!(
        "before calibration: y {} nm, z {} nm, angle {} nrad, load {} mN",
        sample.journal_y_nm, sample.journal_z_nm, sample.shaft_angle_nrad, sample.load_force_mn
    )
}

/// Current state of a run, in one line.
pub(crate) fn live(estimate: &EstimateFrame, counters: &Counters, track: Option<&TrackReport>) -> String {
    let alarm = |raised: bool, name| if raised { name } else { "" };
    format!(
        "{:>9.3} s  {:>9} samples  {:>9.1} N  {:>8.2} N m  {:>8.3} um  late {}  lost {}{}{}  {}",
        seconds(estimate.time_us),
        counters.samples,
        estimate.normal_force_n,
        estimate.friction_torque_nm,
        f64::from(estimate.deformation_m) * 1e6,
        counters.deadline_overruns,
        counters.dropped_samples.saturating_add(counters.dropped_estimates),
        alarm(track.is_some_and(|track| track.wear == Wear::Alarm), "  WEAR ALARM"),
        alarm(track.is_some_and(|track| track.friction == FrictionState::Alarm), "  FRICTION ALARM"),
        flags(estimate).join(" ")
    )
}

/// Timing of the controller's own samples.
pub(crate) fn sampling(report: &SamplingReport) -> Vec<(&'static str, String)> {
    let SamplingReport { lost, halts, halted_us, early_ns, late_ns, input_interval_ns } = *report;
    let us = |ns: u32| f64::from(ns) * 1e-3;
    vec![
        (
            "samples lost",
            format!("{lost}; the core was halted {halts} times, {} s in all", seconds(halted_us)),
        ),
        ("sampling jitter", format!("at most {:.2} us early, {:.2} us late", us(early_ns), us(late_ns))),
        ("probe interval", format!("{:.2} us, taken into account", us(input_interval_ns))),
    ]
}

/// The configuration in one line.
pub(crate) fn configuration(configuration: Option<&ControllerConfiguration>) -> String {
    let Some(ControllerConfiguration { bench, limits, monitor, .. }) = configuration else {
        return "none".into();
    };
    let bearing = BearingMaterial::from_code(bench.bearing).map_or("unknown", BearingMaterial::name);
    let or_none = |value: u32, unit: &str| if value == 0 { "none".into() } else { format!("{value} {unit}") };
    format!(
        "{bearing}, radial clearance {} mm, every {} us; force limit {}, wear alarm at {} mm, \
         friction alarm at {}, trip after {}, slow telemetry every {}",
        f64::from(bench.radial_clearance_nm) * 1e-6,
        bench.sample_period_us,
        or_none(limits.force_limit_n, "N"),
        f64::from(monitor.wear_limit_nm) * 1e-6,
        or_none(limits.friction_level_limit_per_mille.into(), "thousandths of the trained friction"),
        or_none(limits.deadline_trip_count.into(), "late estimates"),
        or_none(limits.slow_every.into(), "samples"),
    )
}

/// Every counter with its meaning.
pub(crate) fn counters(counters: &Counters) -> [(&'static str, u32); 24] {
    let (bad, line) = (counters.bad_frames, counters.line_errors);
    [
        ("samples served", counters.samples),
        ("with a suspect sensor", counters.flagged),
        ("gaps in the sequence number", counters.sequence_gaps),
        ("time did not advance by the period", counters.time_faults),
        ("above the force limit", counters.over_force),
        ("estimated later than the period", counters.deadline_overruns),
        ("trips", counters.trips),
        ("estimates held after a trip", counters.held),
        ("timer ticks without a sample", counters.idle_ticks),
        ("samples dropped, queue full", counters.dropped_samples),
        ("estimates dropped", counters.dropped_estimates),
        ("impacts recorded", counters.impacts),
        ("records of impacts dropped", counters.dropped_impacts),
        ("other answers dropped", counters.dropped_answers),
        ("received bytes dropped, buffer full", counters.dropped_bytes),
        ("received bytes lost by the port", line.overruns),
        ("bytes without their stop bit", line.framing),
        ("bytes with noise", line.noise),
        ("repeated commands", counters.repeated_commands),
        ("commands refused", counters.refused_commands),
        ("frames with invalid COBS encoding", bad.cobs),
        ("frames with a wrong checksum", bad.crc),
        ("frames too long", bad.overlong),
        ("valid frames with an unknown message", bad.unknown),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use link::start::Presence;
    use link::update::{RefusedPackage, UpdateRefusal};

    #[test]
    fn the_timing_of_samples_is_in_microseconds() {
        let report = SamplingReport {
            lost: 3,
            halts: 1,
            halted_us: 900,
            early_ns: 60,
            late_ns: 1_190,
            input_interval_ns: 9_262,
        };
        let text: Vec<_> = sampling(&report).into_iter().map(|(_, text)| text).collect();
        let expected = [
            "3; the core was halted 1 times, 0.0009 s in all",
            "at most 0.06 us early, 1.19 us late",
            "9.26 us, taken into account",
        ];
        assert_eq!(text, expected);
    }

    #[test]
    fn alarms_stand_in_what_is_tracked_and_in_every_line_of_a_run() {
        let report = TrackReport {
            friction_level_per_mille: 1_820,
            friction_level_deviation_per_mille: 60,
            friction: FrictionState::Alarm,
            friction_alarms: 2,
            wear: Wear::Below,
            ..TrackReport::default()
        };
        let lines = track(&report);
        assert!(lines.contains(&("friction", "ALARM: above the limit, raised 2 times".into())), "{lines:?}");
        assert!(lines.contains(&("friction level", "1.820, deviation 0.060".into())), "{lines:?}");
        let line = live(&EstimateFrame::default(), &Counters::default(), Some(&report));
        assert!(line.contains("FRICTION ALARM") && !line.contains("WEAR"), "{line}");
    }

    #[test]
    fn a_party_is_shown_with_what_was_left_of_its_time() {
        let link = Presence { expected: true, away_us: 100, longest_us: 400_000, period_us: 500_000 };
        let known = SupervisorReport {
            parties: [Presence::default(), Presence::default(), link, Presence::default()],
            ..SupervisorReport::default()
        };
        let lines = supervisor(&known);
        assert_eq!(lines[1], ("sampling", "not expected".into()));
        assert!(lines[3].0 == "link" && lines[3].1.ends_with("0.1000 s of margin"), "{lines:?}");
    }

    #[test]
    fn a_configuration_that_was_set_aside_is_explained() {
        assert_eq!(kept(KeptConfiguration::None), None);
        let text = kept(KeptConfiguration::SetAside { faulted_starts: 3 }).unwrap_or_default();
        assert!(text.contains("3 starts in a row faulted with it"), "{text}");
    }

    #[test]
    fn slots_and_the_last_refusal_are_shown() {
        let reason = UpdateRefusal::Board { found: 0x405, expected: 0x505 };
        let models = UpdateStatus {
            slots: [SlotState::Valid { version: 7 }, SlotState::Unfinished],
            last_refusal: Some(RefusedPackage { number: 0, slot: None, version: 9, reason }),
            min_version: 8,
            ..UpdateStatus::default()
        };
        let lines = slots(&models);
        assert_eq!(lines[0].1, "version 7, valid");
        assert_eq!(lines[2].1, "8 or higher");
        assert_eq!(lines[3].1, "version 9: made for board 0x0405, this is board 0x0505");
    }
}
