//! Cause of the controller's start: reason of the reset and record of the fault before it. The
//! hello frame carries [`StartReport`] and [`StackReport`].
//!
//! Addresses and registers are those of the core, as a debugger shows them. Bits of CFSR and HFSR:
//! Arm v7-M Architecture Reference Manual B3.2.15-18 (v8-M adds the bit of the stack limit).

use serde::{Deserialize, Serialize};

/// Reason why the core started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ResetReason {
    /// The reset controller states no reason (the emulator models none), and there is no record.
    #[default]
    Unknown,
    /// The supply was switched on.
    PowerOn,
    /// The supply dipped.
    BrownOut,
    /// Reset pin alone.
    Pin,
    /// The firmware requested the reset and left no record: after an update, or on command.
    Software,
    /// The independent watchdog: not even the supervisor could refresh it.
    Watchdog,
    /// The window watchdog, which this firmware never starts.
    WindowWatchdog,
    /// A forbidden low-power mode.
    LowPower,
    /// A fault; the record names it.
    Fault,
    /// The supervisor missed a check-in; the record names the task.
    Starved,
}

/// Kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FaultKind {
    /// Fault of the core; [`FaultRecord::cause`] reads the status registers.
    Core,
    /// Fault of the core with its stack at or below the lowest allowed address.
    StackOverflow,
    /// A supervised task did not check in. Bits: [`MISSING_SAMPLING`] and following.
    Starved {
        /// Tasks that were missing.
        missing: u8,
    },
    /// A panic was reached. A release image contains none.
    Panic,
}

/// [`FaultKind::Starved`]: no sample source was read.
pub const MISSING_SAMPLING: u8 = 1;
/// [`FaultKind::Starved`]: a sample was not estimated.
pub const MISSING_INFERENCE: u8 = 1 << 1;
/// [`FaultKind::Starved`]: the link was not served.
pub const MISSING_LINK: u8 = 1 << 2;
/// [`FaultKind::Starved`]: the self-test did not finish in time, or failed.
pub const MISSING_SELF_TEST: u8 = 1 << 3;

/// Names of the supervised tasks, lowest bit first.
pub const PARTIES: [&str; 4] = ["sampling", "inference", "link", "self-test"];

/// Record of a fault, written before the reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultRecord {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Program counter of the instruction; 0 if the core could not save it (stack lost).
    pub pc: u32,
    /// Link register at that instruction; 0 in the same case.
    pub lr: u32,
    /// Configurable fault status register.
    pub cfsr: u32,
    /// Hard fault status register.
    pub hfsr: u32,
    /// Address that was accessed, if the core knows it (MMFAR or BFAR).
    pub address: Option<u32>,
    /// Main stack pointer at the fault.
    pub msp: u32,
    /// CRC-32 of the name of the build that faulted. It can differ from the build that reports it.
    pub build: u32,
    /// Number of faults since power-on, this one included.
    pub count: u32,
}

/// Use of the configuration that was kept in flash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum KeptConfiguration {
    /// None is kept, or it has the layout of another firmware.
    #[default]
    None,
    /// It was in use from the start.
    Restored,
    /// This firmware refused it.
    Refused,
    /// It was not used, because starts in a row faulted with it.
    SetAside {
        /// Number of these starts in a row.
        faulted_starts: u8,
    },
}

/// Start-up as the hello frame reports it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartReport {
    /// Reason why the core started.
    pub reason: ResetReason,
    /// Fault that caused this start, or the last one since power-on.
    pub fault: Option<FaultRecord>,
    /// Use of the kept configuration.
    pub kept: KeptConfiguration,
}

/// Use of the stack so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StackReport {
    /// Size of the stack, bytes; 0 in the host's process.
    pub reserved_bytes: u32,
    /// Deepest use seen so far, bytes (overwritten paint).
    pub used_bytes: u32,
}

/// State of one supervised task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Presence {
    /// `true` if the task must check in. A suspended task need not.
    pub expected: bool,
    /// Time since its last check-in, us.
    pub away_us: u32,
    /// Longest time between two of its check-ins since the start, us.
    pub longest_us: u32,
    /// Time without check-in after which the controller restarts, us.
    pub period_us: u32,
}

impl Presence {
    /// Returns the smallest remaining time before a restart, us.
    #[must_use]
    pub const fn margin_us(&self) -> u32 {
        self.period_us.saturating_sub(self.longest_us)
    }
}

/// Report of the supervisor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SupervisorReport {
    /// Time since the start, us, modulo 2^32.
    pub uptime_us: u32,
    /// Tasks in the order of [`PARTIES`].
    pub parties: [Presence; PARTIES.len()],
    /// Cause of the last start, and the fault before it.
    pub start: StartReport,
    /// Use of the stack.
    pub stack: StackReport,
}

/// Meaning of the status bits of a core fault, most specific first.
const CAUSES: [(u32, &str); 17] = [
    (1 << 20, "stack limit"),
    (1 << 4, "memory protection, saving registers"),
    (1 << 12, "bus error, saving registers"),
    (1 << 1, "memory protection, data"),
    (1, "memory protection, instruction"),
    (1 << 9, "bus error, data"),
    (1 << 8, "bus error, instruction"),
    (1 << 10, "bus error, late write"),
    (1 << 16, "undefined instruction"),
    (1 << 17, "not in Thumb state"),
    (1 << 18, "bad return from an exception"),
    (1 << 19, "coprocessor missing"),
    (1 << 24, "unaligned access"),
    (1 << 25, "division by 0"),
    (1 << 3, "memory protection, restoring registers"),
    (1 << 11, "bus error, restoring registers"),
    (1 << 5 | 1 << 13, "fault while saving FPU registers"),
];

impl FaultRecord {
    /// Returns the cause as text.
    #[must_use]
    pub fn cause(&self) -> &'static str {
        const VECTOR: u32 = 1 << 1;
        match self.kind {
            FaultKind::StackOverflow => "stack overflow",
            FaultKind::Starved { .. } => "missed check-in",
            FaultKind::Panic => "panic",
            FaultKind::Core => {
                let named = CAUSES.iter().find(|(bits, _)| self.cfsr & bits != 0);
                match named {
                    Some((_, name)) => name,
                    None if self.hfsr & VECTOR != 0 => "vector table",
                    None => "hard fault",
                }
            }
        }
    }

    /// Returns the names of the tasks that did not check in.
    pub fn missing(&self) -> impl Iterator<Item = &'static str> {
        let mask = match self.kind {
            FaultKind::Starved { missing } => missing,
            _ => 0,
        };
        PARTIES
            .iter()
            .zip(0_u32..)
            .filter(move |(_, bit)| mask.checked_shr(*bit).is_some_and(|m| m & 1 == 1))
            .map(|(name, _)| *name)
    }
}

impl core::fmt::Display for FaultRecord {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.cause())?;
        for (index, name) in self.missing().enumerate() {
            write!(f, "{}{name}", if index == 0 { ": " } else { ", " })?;
        }
        if let Some(address) = self.address {
            write!(f, " at address {address:#010x}")?;
        }
        write!(
            f,
            " (pc {:#010x}, lr {:#010x}, msp {:#010x}, cfsr {:#010x}, hfsr {:#010x}, build {:08x}, fault {})",
            self.pc, self.lr, self.msp, self.cfsr, self.hfsr, self.build, self.count
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECORD: FaultRecord = FaultRecord {
        kind: FaultKind::Core,
        pc: 0x0800_1234,
        lr: 0x0800_1001,
        cfsr: 1 << 9 | 1 << 15,
        hfsr: 1 << 30,
        address: Some(0xD000_0000),
        msp: 0x2000_7F00,
        build: 0xDEAD_BEEF,
        count: 2,
    };

    #[test]
    fn a_record_reads_as_a_line() {
        assert_eq!(
            RECORD.to_string(),
            "bus error, data at address 0xd0000000 (pc 0x08001234, lr 0x08001001, msp 0x20007f00, \
             cfsr 0x00008200, hfsr 0x40000000, build deadbeef, fault 2)"
        );
        let kind = FaultKind::Starved { missing: MISSING_LINK | MISSING_INFERENCE };
        let starved = FaultRecord { kind, address: None, ..RECORD };
        assert!(starved.to_string().starts_with("missed check-in: inference, link (pc"), "{starved}");
    }

    #[test]
    fn every_cause_has_separate_bits() {
        let mut seen = 0;
        for (bits, name) in CAUSES {
            assert_eq!(seen & bits, 0, "{name}");
            seen |= bits;
            assert_eq!(FaultRecord { cfsr: bits, ..RECORD }.cause(), name);
        }
        assert_eq!(FaultRecord { cfsr: 0, hfsr: 2, ..RECORD }.cause(), "vector table");
        assert_eq!(FaultRecord { cfsr: 0, hfsr: 0, ..RECORD }.cause(), "hard fault");
    }

    #[test]
    fn the_longest_report_leaves_room_in_a_hello_frame() {
        let all = u32::MAX;
        let record = FaultRecord {
            kind: FaultKind::Starved { missing: 0xFF },
            pc: all,
            lr: all,
            cfsr: all,
            hfsr: all,
            address: Some(all),
            msp: all,
            build: all,
            count: all,
        };
        let kept = KeptConfiguration::SetAside { faulted_starts: u8::MAX };
        let report = StartReport { reason: ResetReason::Starved, fault: Some(record), kept };
        let mut bytes = [0; 64];
        assert_eq!(postcard::to_slice(&report, &mut bytes).map(|used| used.len()), Ok(47));
    }
}
