//! Time of instructions on a Cortex-M4.
//!
//! Source: Cortex-M4 technical reference manual (ARM 100166), sections 3.3.1 (table of cycles),
//! 3.3.3 (pairing of loads and stores) and 7.2.3 (FPU). Where the manual gives a range or a
//! condition that a trace does not show, the two [`Bound`]s take its ends:
//!
//! | | lower | upper |
//! |---|---|---|
//! | refill of the pipeline after a branch | 1 | 3 |
//! | `SDIV`, `UDIV` (the trace has no operands) | 2 | 12 |
//! | `VDIV`, `VSQRT`: integers go on meanwhile | yes | no |
//! | `IT` is folded into the instruction before it | yes | no |
//! | wait for an address that was computed by the instruction before | 0 | 1 |
//! | wait for a float that was computed by the instruction before | 0 | 1 |
//! | barriers beyond their first cycle | 0 | 4 |
//! | registers of the FPU are saved and restored with an interrupt | no | yes |

use super::bound::Bound;
use super::decode::{Instruction, Kind};
use super::flash::Memory;
use super::trace::{Access, Section, Step};

/// Cycles of `VDIV` and `VSQRT`.
const FLOAT_DIVISION: u64 = 14;
/// Cycles from an interrupt to the first instruction of its handler, and from the handler's return
/// to the interrupted program.
const INTERRUPT: u64 = 12 + 10;
/// Cycles to save and to restore `s0` to `s15` and the status of the FPU.
const FLOAT_CONTEXT: u64 = 2 * 17;

/// Core with its memory.
#[derive(Clone, Debug)]
pub(super) struct CortexM4 {
    bound: Bound,
    memory: Memory,
}

/// Instruction before the current one, and the state of the FPU.
struct Past {
    instruction: Option<Instruction>,
    /// True if it was a load of one word that did not load the program counter.
    is_single_load: bool,
    /// Time at which the FPU has ended a division.
    float_free_at: u64,
}

impl CortexM4 {
    /// Creates a core.
    pub(super) const fn new(bound: Bound, memory: Memory) -> Self {
        Self { bound, memory }
    }

    /// Returns the cycles of a section. The caches are empty at its start.
    pub(super) fn price(&mut self, section: &Section) -> u64 {
        self.memory.reset();
        let mut past = Past { instruction: None, is_single_load: false, float_free_at: 0 };
        let mut now = 0;
        for step in &section.steps {
            now += self.memory.fetch(now, step.address, step.instruction.bytes.into());
            now += self.cycles(now, step, section.accesses(step), &mut past);
            for access in section.accesses(step) {
                now += self.memory.access(now, access.address, access.is_store) + misalignment(access);
            }
        }
        now
    }

    /// Returns the cycles of entering and leaving an interrupt handler.
    pub(super) const fn interrupt(bound: Bound) -> u64 {
        INTERRUPT + bound.pick(0, FLOAT_CONTEXT)
    }

    /// Returns the cycles of an instruction from memory without wait states.
    fn cycles(&self, now: u64, step: &Step, accesses: &[Access], past: &mut Past) -> u64 {
        let (bound, instruction) = (self.bound, &step.instruction);
        let refill = if step.has_jumped || instruction.loads_pc() { bound.pick(1, 3) } else { 0 };
        let previous = past.instruction.replace(*instruction);
        let is_after_load = std::mem::replace(&mut past.is_single_load, false);
        let written = previous.map_or(0, |previous| previous.writes);
        // Not executed: the condition of an IT block was false.
        if instruction.is_transfer() && accesses.is_empty() {
            return 1;
        }
        let is_pipelined = is_after_load && written & instruction.address == 0;
        past.is_single_load = instruction.kind == Kind::Load && !instruction.loads_pc();
        let base = self.base(instruction, is_pipelined);
        let mut wait = 0;
        if previous.is_some_and(|previous| !previous.is_transfer()) {
            let is_float_result = written >> 16 & instruction.reads >> 16 != 0;
            if written & instruction.address != 0 || is_float_result {
                wait += bound.pick(0, 1);
            }
        }
        if instruction.is_float() {
            wait += past.float_free_at.saturating_sub(now);
            if instruction.kind == Kind::FloatDivide {
                past.float_free_at = now + wait + FLOAT_DIVISION;
            }
        }
        wait + base + refill
    }

    /// Returns the cycles of an instruction by its kind alone.
    fn base(&self, instruction: &Instruction, is_pipelined: bool) -> u64 {
        let bound = self.bound;
        match instruction.kind {
            Kind::Load | Kind::Store { has_register_offset: true } if !is_pipelined => 2,
            Kind::LoadMultiple { words } | Kind::StoreMultiple { words } => 1 + u64::from(words),
            Kind::Divide => bound.pick(2, 12),
            Kind::TableBranch => bound.pick(2, 3),
            Kind::It => bound.pick(0, 1),
            Kind::Barrier => 1 + bound.pick(0, 4),
            Kind::FloatMove { words } => words.into(),
            Kind::FloatMultiplyAdd => 3,
            Kind::FloatDivide => bound.pick(1, FLOAT_DIVISION),
            _ => 1,
        }
    }
}

/// Returns the additional cycles of an access that is not aligned to its size.
const fn misalignment(access: &Access) -> u64 {
    match (access.bytes, access.address & 3) {
        (2, 1 | 3) | (4, 2) => 1,
        (4, 1 | 3) => 2,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Code, section};
    use super::*;

    /// Prices code in memory without wait states.
    fn price(code: &[Code]) -> [u64; 2] {
        [Bound::Lower, Bound::Upper]
            .map(|bound| CortexM4::new(bound, Memory::new(0, bound, None)).price(&section(code)))
    }

    #[test]
    fn loads_and_stores_take_the_cycles_of_the_manual() {
        use Code::{Narrow, Wide};
        // The examples of section 3.3.3.
        // ldr r0, [r1]; ldr r1, [r2]
        assert_eq!(price(&[Narrow(0x6808, 1), Narrow(0x6811, 1)]), [3, 3]);
        // ldr r0, [r1, r2]; str r0, [r3, #20]
        assert_eq!(price(&[Narrow(0x5888, 1), Narrow(0x6158, -1)]), [3, 3]);
        // ldr r0, [r1, r2]; str r1, [r3, r2]
        assert_eq!(price(&[Narrow(0x5888, 1), Narrow(0x5099, -1)]), [3, 3]);
        // ldr r0, [r1, r5]; ldr r1, [r2]; ldr r2, [r3, #4]
        assert_eq!(price(&[Narrow(0x5948, 1), Narrow(0x6811, 1), Narrow(0x685A, 1)]), [4, 4]);
        // The address of the second load is the result of the first one: ldr r0, [r1]; ldr r1, [r0]
        assert_eq!(price(&[Narrow(0x6808, 1), Narrow(0x6801, 1)]), [4, 4]);
        // Nothing is pipelined after a store: str r0, [r1]; ldr r2, [r3]
        assert_eq!(price(&[Narrow(0x6008, -1), Narrow(0x681A, 1)]), [3, 3]);
        // ldm r0!, {r2-r7}; push {r4-r7, lr}; ldrd r0, r1, [r2]
        assert_eq!(price(&[Narrow(0xC8FC, 6)]), [7, 7]);
        assert_eq!(price(&[Narrow(0xB5F0, -5)]), [6, 6]);
        assert_eq!(price(&[Wide(0xE9D2, 0x0100, 2)]), [3, 3]);
        // vldr s0, [r0]; vldr d0, [r0]; vpush {d8, d9}
        assert_eq!(price(&[Wide(0xED90, 0x0A00, 1)]), [2, 2]);
        assert_eq!(price(&[Wide(0xED90, 0x0B00, 2)]), [3, 3]);
        assert_eq!(price(&[Wide(0xED2D, 0x8B04, -4)]), [5, 5]);
        // adds r1, #4; ldr r0, [r1]: the address comes from the instruction before.
        assert_eq!(price(&[Narrow(0x3104, 0), Narrow(0x6808, 1)]), [3, 4]);
        // ldr r0, [r1] that an IT block skips
        assert_eq!(price(&[Narrow(0x6808, 0)]), [1, 1]);
    }

    #[test]
    fn arithmetic_and_branches_take_the_cycles_of_the_manual() {
        use Code::{Jump, Narrow, Wide};
        // adds r0, r1; muls r0, r1; smlad r0, r1, r2, r3; umlal r0, r1, r2, r3
        assert_eq!(price(&[Narrow(0x1840, 0), Narrow(0x4348, 0)]), [2, 2]);
        assert_eq!(price(&[Wide(0xFB21, 0x3002, 0), Wide(0xFBE2, 0x0103, 0)]), [2, 2]);
        // udiv r0, r1, r2; sdiv r0, r1, r2
        assert_eq!(price(&[Wide(0xFBB1, 0xF0F2, 0)]), [2, 12]);
        assert_eq!(price(&[Wide(0xFB91, 0xF0F2, 0)]), [2, 12]);
        // bne, taken and not; bl; bx lr
        assert_eq!(price(&[Narrow(0xD1FE, 0), Jump, Narrow(0xBF00, 0)]), [3, 5]);
        assert_eq!(price(&[Narrow(0xD1FE, 0), Narrow(0xBF00, 0)]), [2, 2]);
        assert_eq!(
            price(&[Wide(0xF000, 0xF800, 0), Jump, Narrow(0x4770, 0), Jump, Narrow(0xBF00, 0)]),
            [5, 9]
        );
        // pop {r4, pc}: 1 + 2 + P
        assert_eq!(price(&[Narrow(0xBD10, 2)]), [4, 6]);
        // ldr.w pc, [r0]: at least five by the text, 2 + P by the table; tbb [pc, r3]: 2 + P, six
        assert_eq!(price(&[Wide(0xF8D0, 0xF000, 1)]), [3, 5]);
        assert_eq!(price(&[Wide(0xE8DF, 0xF003, 1), Jump, Narrow(0xBF00, 0)]), [3 + 1, 6 + 1]);
        // it eq; isb
        assert_eq!(price(&[Narrow(0xBF08, 0)]), [0, 1]);
        assert_eq!(price(&[Wide(0xF3BF, 0x8F6F, 0)]), [1, 5]);
    }

    #[test]
    fn floats_take_the_cycles_of_the_manual() {
        use Code::{Narrow, Wide};
        // vadd s0, s1, s2, then vmul s3, s4, s5 or, waiting, vmul s3, s0, s5
        let add = Wide(0xEE30, 0x0A81, 0);
        assert_eq!(price(&[add, Wide(0xEE62, 0x1A22, 0)]), [2, 2]);
        assert_eq!(price(&[add, Wide(0xEE60, 0x1A22, 0)]), [2, 3]);
        // vmla s0, s1, s2; vfma s0, s1, s2
        assert_eq!(price(&[Wide(0xEE00, 0x0A81, 0)]), [3, 3]);
        assert_eq!(price(&[Wide(0xEEA0, 0x0A81, 0)]), [3, 3]);
        // vmov r0, s0; vmov r0, r1, d0
        assert_eq!(price(&[Wide(0xEE10, 0x0A10, 0)]), [1, 1]);
        assert_eq!(price(&[Wide(0xEC51, 0x0B10, 0)]), [2, 2]);
        // vdiv s3, s4, s5 and vsqrt s3, s4, then adds r0, r1, then vadd s0, s1, s2
        for division in [Wide(0xEEC2, 0x1A22, 0), Wide(0xEEF1, 0x1AC2, 0)] {
            assert_eq!(price(&[division, Narrow(0x1840, 0)]), [2, 15]);
            assert_eq!(price(&[division, Narrow(0x1840, 0), add]), [15, 16]);
        }
    }

    #[test]
    fn an_access_across_words_takes_longer() {
        let access = |address, bytes| misalignment(&Access { address, bytes, is_store: false });
        assert_eq!([access(0, 4), access(2, 4), access(1, 4), access(3, 4)], [0, 1, 2, 2]);
        assert_eq!([access(2, 2), access(1, 2), access(3, 1)], [0, 1, 0]);
    }
}
