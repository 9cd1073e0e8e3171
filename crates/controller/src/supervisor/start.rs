//! Reason of the start from the reset flags and the fault record, and the content of a fault
//! record.
//!
//! Flags: RM0090 section 7.3.21, RCC_CSR. Power-on also sets the pin's and the brown-out flag, and
//! every internal reset pulls the pin. So the most specific flag is taken. The emulator models none
//! of them.

use link::start::{FaultKind, FaultRecord, ResetReason, StartReport};

/// Bits of RCC_CSR of the STM32F405.
const LOW_POWER: u32 = 1 << 31;
const WINDOW_WATCHDOG: u32 = 1 << 30;
const WATCHDOG: u32 = 1 << 29;
const SOFTWARE: u32 = 1 << 28;
const POWER_ON: u32 = 1 << 27;
const PIN: u32 = 1 << 26;
const BROWN_OUT: u32 = 1 << 25;

/// Returns the reset reason from RCC_CSR.
#[must_use]
pub const fn reason_of_flags(csr: u32) -> ResetReason {
    if csr & POWER_ON != 0 {
        ResetReason::PowerOn
    } else if csr & LOW_POWER != 0 {
        ResetReason::LowPower
    } else if csr & WINDOW_WATCHDOG != 0 {
        ResetReason::WindowWatchdog
    } else if csr & WATCHDOG != 0 {
        ResetReason::Watchdog
    } else if csr & SOFTWARE != 0 {
        ResetReason::Software
    } else if csr & BROWN_OUT != 0 {
        ResetReason::BrownOut
    } else if csr & PIN != 0 {
        ResetReason::Pin
    } else {
        ResetReason::Unknown
    }
}

/// Returns the report of this start. An unreported record is the reason of the start unless the
/// power was off since.
#[must_use]
pub fn report(flags: ResetReason, record: Option<(FaultRecord, bool)>) -> StartReport {
    let Some((fault, fresh)) = record else { return StartReport { reason: flags, fault: None } };
    let reason = match (flags, fault.kind) {
        _ if !fresh => flags,
        (ResetReason::PowerOn, _) => flags,
        (_, FaultKind::Starved { .. }) => ResetReason::Starved,
        _ => ResetReason::Fault,
    };
    StartReport { reason, fault: Some(fault) }
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
        let cases = [
            (0, ResetReason::Unknown),
            (POWER_ON | PIN | BROWN_OUT, ResetReason::PowerOn),
            (BROWN_OUT | PIN, ResetReason::BrownOut),
            (PIN, ResetReason::Pin),
            (PIN | SOFTWARE, ResetReason::Software),
            (PIN | WATCHDOG, ResetReason::Watchdog),
            (PIN | WINDOW_WATCHDOG, ResetReason::WindowWatchdog),
            (PIN | LOW_POWER, ResetReason::LowPower),
        ];
        for (csr, reason) in cases {
            assert_eq!(reason_of_flags(csr), reason, "{csr:#x}");
        }
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
