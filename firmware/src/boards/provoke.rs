//! Faults on demand for tests of the fault handling: only in an image with the feature `provoke`,
//! and only in the emulator.
//!
//! The emulator's command line (`-semihosting-config ...,arg=NAME`) names the fault. It is
//! committed once, after the first hello frame, unless that frame reports a fault. `with-kept` is
//! committed by every start that uses a kept configuration, and once by a start without one after
//! its messages. The code below is wrong on purpose.

use core::hint::black_box;

use cortex_m_semihosting::nr;
use link::start::{KeptConfiguration, ResetReason, StartReport};

use super::check_in::{check_in, keep_away};
use super::memory;
use controller::supervisor::{Attendance, Party};

/// A fault of every start with a kept configuration.
const WITH_KEPT: &[u8] = b"with-kept";

/// Commits the fault that the command line names, if any.
pub fn provoke(start: &StartReport, attendance: &Attendance) {
    let mut buffer = [0_u8; 64];
    let name = command_line(&mut buffer);
    if name == WITH_KEPT && start.kept == KeptConfiguration::Restored {
        load(0xD000_0000);
    }
    if matches!(start.reason, ResetReason::Fault | ResetReason::Starved) {
        return;
    }
    let away = |party: Party| starve(party, attendance);
    match name {
        b"wild-load" => load(0xD000_0000),
        b"store-below-ram" => store(memory::stack_lowest().wrapping_sub(16)),
        b"store-into-guard" => store(memory::stack_lowest().wrapping_add(16)),
        b"undefined-instruction" => undefined(),
        b"overflow" => overflow::<16>(u32::MAX),
        b"leaping-overflow" => overflow::<2_000>(u32::MAX),
        b"panic" => fail(),
        b"starve-sampling" => away(Party::Sampling),
        b"starve-inference" => away(Party::Inference),
        b"starve-link" => away(Party::Link),
        b"starve-self-test" => away(Party::SelfTest),
        _ => {}
    }
}

/// Provokes a fault at the end of the messages of a start that had no kept configuration.
pub fn provoke_at_end(start: &StartReport) {
    if command_line(&mut [0; 64]) == WITH_KEPT && start.kept == KeptConfiguration::None {
        load(0xD000_0000);
    }
}

/// Lets every party check in and then keeps one party from doing so.
fn starve(party: Party, attendance: &Attendance) {
    loop {
        for party in Party::ALL {
            check_in(attendance, party);
        }
        keep_away(party);
    }
}

fn command_line(buffer: &mut [u8; 64]) -> &[u8] {
    let mut block = [buffer.as_mut_ptr() as usize, buffer.len()];
    #[expect(
        unsafe_code,
        reason = "SYS_GET_CMDLINE with the buffer's address and length, and writes both back"
    )]
    let failed = unsafe { cortex_m_semihosting::syscall(nr::GET_CMDLINE, &mut block) };
    let [_, length] = block;
    if failed == 0 { buffer.get(..length).unwrap_or_default() } else { &[] }
}

#[inline(never)]
fn load(address: u32) {
    #[expect(unsafe_code, reason = "meant to fault")]
    let _ = unsafe { (address as *const u32).read_volatile() };
}

#[inline(never)]
fn store(address: u32) {
    #[expect(unsafe_code, reason = "meant to fault")]
    unsafe {
        (address as *mut u32).write_volatile(1);
    }
}

#[inline(never)]
fn undefined() {
    cortex_m::asm::udf();
}

#[inline(never)]
#[expect(clippy::panic, reason = "the panic handler is what is tried")]
fn fail() {
    panic!();
}

#[inline(never)]
#[expect(clippy::only_used_in_recursion, reason = "the depth is never reached")]
fn overflow<const WORDS: usize>(depth: u32) {
    let mut frame = [depth; WORDS];
    black_box(&mut frame);
    if frame.first().is_some_and(|&word| word > 0) {
        overflow::<WORDS>(depth.wrapping_sub(1));
    }
    black_box(&mut frame);
}
