//! Reason of the start from the reset flags and the fault record, and the content of a fault
//! record.
//!
//! Flags: RM0090 section 7.3.21, RCC_CSR; RM0433 section 8.4.4, RCC_RSR. Power-on also sets the
//! pin's and the brown-out flag, and every internal reset pulls the pin. So the most specific flag
//! is taken. The emulator models none of them.

use link::start::{FaultKind, FaultRecord, ResetReason, StartReport};

/// Masks of the reset flags in a microcontroller's register.
#[derive(Clone, Copy, Debug)]
pub struct ResetFlags {
    low_power: u32,
    window_watchdog: u32,
    watchdog: u32,
    software: u32,
    power_on: u32,
    pin: u32,
    brown_out: u32,
}

impl ResetFlags {
    /// RCC_CSR of the STM32F405.
    pub const STM32F405: Self = Self {
        low_power: 1 << 31,
        window_watchdog: 1 << 30,
        watchdog: 1 << 29,
        software: 1 << 28,
        power_on: 1 << 27,
        pin: 1 << 26,
        brown_out: 1 << 25,
    };

    /// RCC_RSR of the STM32H743.
    pub const STM32H743: Self = Self {
        low_power: 1 << 30,
        window_watchdog: 1 << 28,
        watchdog: 1 << 26,
        software: 1 << 24,
        power_on: 1 << 23,
        pin: 1 << 22,
        brown_out: 1 << 21,
    };
}

/// Returns the reset reason from the register's value.
#[must_use]
pub const fn reason_of_flags(flags: &ResetFlags, value: u32) -> ResetReason {
    if value & flags.power_on != 0 {
        ResetReason::PowerOn
    } else if value & flags.low_power != 0 {
        ResetReason::LowPower
    } else if value & flags.window_watchdog != 0 {
        ResetReason::WindowWatchdog
    } else if value & flags.watchdog != 0 {
        ResetReason::Watchdog
    } else if value & flags.software != 0 {
        ResetReason::Software
    } else if value & flags.brown_out != 0 {
        ResetReason::BrownOut
    } else if value & flags.pin != 0 {
        ResetReason::Pin
    } else {
        ResetReason::Unknown
    }
}

/// Returns the report of this start. An unreported record is the reason of the start unless the
/// power was off since.
#[must_use]
pub fn report(flags: ResetReason, record: Option<(FaultRecord, bool)>) -> StartReport {
    let Some((fault, fresh)) = record else {
        return StartReport { reason: flags, ..StartReport::default() };
    };
    let reason = match (flags, fault.kind) {
        _ if !fresh => flags,
        (ResetReason::PowerOn, _) => flags,
        (_, FaultKind::Starved { .. }) => ResetReason::Starved,
        _ => ResetReason::Fault,
    };
    StartReport { reason, fault: Some(fault), ..StartReport::default() }
}

/// Count of starts that faulted with the kept configuration, and whether this start is watched. It
/// is a word in RAM that start-up does not clear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StartWatch {
    /// Number of faulted starts in a row.
    pub faulted: u8,
    /// True if a fault of this start counts.
    pub is_watched: bool,
}

impl StartWatch {
    /// Mark of a word.
    const MARK: u8 = 0xFA;

    /// Encodes the word.
    #[must_use]
    pub const fn to_word(self) -> u32 {
        u32::from_le_bytes([
            self.faulted,
            !self.faulted,
            if self.is_watched { 0x5A } else { 0xA5 },
            Self::MARK,
        ])
    }

    /// Decodes a word; nothing is counted by one that was not stored, as after power-on.
    #[must_use]
    pub const fn of_word(word: u32) -> Self {
        let [faulted, _, watched, _] = word.to_le_bytes();
        let read = Self { faulted, is_watched: watched == 0x5A };
        if word == read.to_word() { read } else { Self { faulted: 0, is_watched: false } }
    }

    /// Returns the count after a start for a reason. Only a fault, a missed check-in or the
    /// watchdog continue it.
    #[must_use]
    pub const fn after(self, reason: ResetReason) -> Self {
        let faulted = match reason {
            ResetReason::Fault | ResetReason::Starved | ResetReason::Watchdog => {
                self.faulted.saturating_add(self.is_watched as u8)
            }
            _ => 0,
        };
        Self { faulted, is_watched: false }
    }
}

/// Registers at the entry of a fault handler.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    /// Configurable fault status.
    pub cfsr: u32,
    /// Hard fault status.
    pub hfsr: u32,
    /// Memory management fault address, valid by its bit of `cfsr`.
    pub mmfar: u32,
    /// Bus fault address, valid by its bit of `cfsr`.
    pub bfar: u32,
    /// Main stack pointer after the core pushed its registers.
    pub msp: u32,
    /// Pushed link register and program counter; `None` if they are not available.
    pub pushed: Option<[u32; 2]>,
}

impl Status {
    /// Bits of `cfsr`: the core could not push its registers.
    const NOT_PUSHED: u32 = 1 << 4 | 1 << 12 | 1 << 20;
    const MMFAR_VALID: u32 = 1 << 7;
    const BFAR_VALID: u32 = 1 << 15;

    /// Decides whether the pushed registers are on a stack that spans `lowest..highest`.
    #[must_use]
    pub const fn is_pushed(&self, lowest: u32, highest: u32) -> bool {
        /// Eight registers.
        const FRAME: u32 = 32;
        let inside = self.msp >= lowest && self.msp <= highest.saturating_sub(FRAME);
        inside && self.msp & 3 == 0 && self.cfsr & Self::NOT_PUSHED == 0
    }

    /// Returns the fault record. `guard_end` is the lowest address that the stack may use.
    #[must_use]
    pub fn record(&self, guard_end: u32, build: u32, previous: Option<FaultRecord>) -> FaultRecord {
        const STACK_LIMIT: u32 = 1 << 20;
        let overflow = self.msp < guard_end || self.cfsr & STACK_LIMIT != 0;
        let [lr, pc] = self.pushed.unwrap_or_default();
        let address = if self.cfsr & Self::BFAR_VALID != 0 {
            Some(self.bfar)
        } else if self.cfsr & Self::MMFAR_VALID != 0 {
            Some(self.mmfar)
        } else {
            None
        };
        FaultRecord {
            kind: if overflow { FaultKind::StackOverflow } else { FaultKind::Core },
            pc,
            lr,
            cfsr: self.cfsr,
            hfsr: self.hfsr,
            address,
            msp: self.msp,
            build,
            count: count_after(previous),
        }
    }
}

/// Returns a record without registers, of a fault that the firmware itself detected.
#[must_use]
pub fn given_up(kind: FaultKind, msp: u32, build: u32, previous: Option<FaultRecord>) -> FaultRecord {
    let count = count_after(previous);
    FaultRecord { kind, pc: 0, lr: 0, cfsr: 0, hfsr: 0, address: None, msp, build, count }
}

fn count_after(previous: Option<FaultRecord>) -> u32 {
    previous.map_or(0, |fault| fault.count).saturating_add(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORCED: u32 = 1 << 30;
    const LOWEST: u32 = 0x2000_0000;
    const GUARD_END: u32 = 0x2000_0100;
    const HIGHEST: u32 = 0x2000_8000;

    #[test]
    fn the_most_specific_flag_is_the_reason() {
        for flags in [ResetFlags::STM32F405, ResetFlags::STM32H743] {
            let pin = flags.pin;
            let cases = [
                (0, ResetReason::Unknown),
                (flags.power_on | pin | flags.brown_out, ResetReason::PowerOn),
                (flags.brown_out | pin, ResetReason::BrownOut),
                (pin, ResetReason::Pin),
                (pin | flags.software, ResetReason::Software),
                (pin | flags.watchdog, ResetReason::Watchdog),
                (pin | flags.window_watchdog, ResetReason::WindowWatchdog),
                (pin | flags.low_power, ResetReason::LowPower),
            ];
            for (value, reason) in cases {
                assert_eq!(reason_of_flags(&flags, value), reason, "{value:#x}");
            }
        }
        // Flags of CPU and power domains (RM0433 table 51) give no reason.
        assert_eq!(reason_of_flags(&ResetFlags::STM32H743, 0x001A_0000), ResetReason::Unknown);
        assert_eq!(reason_of_flags(&ResetFlags::STM32H743, 0x00FA_0000), ResetReason::PowerOn);
    }

    #[test]
    fn a_new_record_is_the_reason_and_an_old_one_is_only_stored() {
        let fault = given_up(FaultKind::Starved { missing: 4 }, 0, 7, None);
        let core = given_up(FaultKind::Core, 0, 7, None);
        let cases = [
            (ResetReason::Software, Some((fault, true)), ResetReason::Starved),
            (ResetReason::Watchdog, Some((core, true)), ResetReason::Fault),
            (ResetReason::Unknown, Some((core, true)), ResetReason::Fault),
            (ResetReason::Pin, Some((core, false)), ResetReason::Pin),
            (ResetReason::PowerOn, Some((core, true)), ResetReason::PowerOn),
            (ResetReason::Watchdog, None, ResetReason::Watchdog),
        ];
        for (flags, record, reason) in cases {
            let report = report(flags, record);
            assert_eq!(report.reason, reason);
            assert_eq!(report.fault, record.map(|(fault, _)| fault));
        }
    }

    #[test]
    fn watched_starts_that_fault_count_in_a_row_and_random_ram_counts_none() {
        let watched = |faulted| StartWatch { faulted, is_watched: true };
        for reason in [ResetReason::Starved, ResetReason::Watchdog, ResetReason::Fault] {
            assert_eq!(watched(2).after(reason), StartWatch { faulted: 3, is_watched: false });
            assert_eq!(watched(2).after(reason).after(reason).faulted, 3, "not watched");
            assert_eq!(watched(u8::MAX).after(reason).faulted, u8::MAX);
        }
        assert_eq!(watched(2).after(ResetReason::Pin), StartWatch::default());
        for faulted in 0..=u8::MAX {
            for is_watched in [false, true] {
                let watch = StartWatch { faulted, is_watched };
                assert_eq!(StartWatch::of_word(watch.to_word()), watch);
                for flipped in 0..32 {
                    let found = StartWatch::of_word(watch.to_word() ^ 1 << flipped);
                    assert_eq!(found, StartWatch::default(), "bit {flipped}");
                }
            }
        }
        assert!([0, u32::MAX].into_iter().all(|word| StartWatch::of_word(word) == StartWatch::default()));
    }

    #[test]
    fn a_wild_load_is_recorded_with_its_address() {
        let status = Status {
            cfsr: 1 << 9 | 1 << 15,
            hfsr: FORCED,
            bfar: 0xD000_0000,
            mmfar: 5,
            msp: 0x2000_7000,
            pushed: Some([0x0800_0101, 0x0800_0200]),
        };
        assert!(status.is_pushed(LOWEST, HIGHEST));
        let previous = given_up(FaultKind::Core, 0, 7, None);
        let record = status.record(GUARD_END, 9, Some(previous));
        assert_eq!(record.cause(), "bus error, data");
        assert_eq!((record.address, record.pc, record.lr), (Some(0xD000_0000), 0x0800_0200, 0x0800_0101));
        assert_eq!((record.build, record.count), (9, 2));
    }

    #[test]
    fn a_store_into_the_guard_is_not_an_overflow_while_the_stack_is_elsewhere() {
        let status =
            Status { cfsr: 1 << 1 | 1 << 7, mmfar: 0x2000_0010, msp: 0x2000_7000, ..Status::default() };
        let record = status.record(GUARD_END, 0, None);
        assert_eq!((record.kind, record.address), (FaultKind::Core, Some(0x2000_0010)));
        assert_eq!(record.cause(), "memory protection, data");
    }

    #[test]
    fn a_stack_that_reached_the_guard_or_left_the_ram_has_overflowed() {
        for (msp, cfsr) in [(0x2000_00F8, 1 << 4), (0x1FFF_FF80, 1 << 12), (0x3800_0040, 1 << 20)] {
            let status = Status { msp, cfsr, hfsr: FORCED, ..Status::default() };
            assert!(!status.is_pushed(LOWEST, HIGHEST), "{msp:#x}: nothing to read there");
            let record = status.record(GUARD_END, 0, None);
            assert_eq!((record.kind, record.pc, record.msp), (FaultKind::StackOverflow, 0, msp));
        }
    }

    #[test]
    fn an_invalid_stack_pointer_is_not_followed() {
        for msp in [0, LOWEST - 4, HIGHEST - 28, HIGHEST, 0x2000_7002, u32::MAX] {
            assert!(!Status { msp, ..Status::default() }.is_pushed(LOWEST, HIGHEST), "{msp:#x}");
        }
        assert!(Status { msp: HIGHEST - 32, ..Status::default() }.is_pushed(LOWEST, HIGHEST));
    }
}
