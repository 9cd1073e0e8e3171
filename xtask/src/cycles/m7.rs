//! Rough time of instructions on a Cortex-M7, with code and data in its tightly coupled memories or
//! with code and constants in flash that [`Caches`] serve.
//!
//! Arm publishes no table of cycles for this core. The upper bound issues one instruction at a
//! time; the lower bound issues two neighbours in one cycle if [`can_pair`] allows it. Both follow
//! the public description of the core (ARM DDI 0489, section 1): in-order issue of up to two
//! instructions, one multiplier, one FPU, 64 bits a cycle to the data memory, branch prediction.
//! The penalty of a wrong prediction is taken as 6 and 8 cycles (a pipeline of six stages), the
//! delay of a loaded word as 1 cycle for the next instruction. The latency of results of the FPU is
//! not public and left out, so the upper figure is no bound for chains of floats.

use super::bound::Bound;
use super::decode::{Instruction, Kind};
use super::m7_caches::Caches;
use super::trace::{Section, Step};
use std::collections::HashMap;

/// Core with its branch prediction: two bits for each branch, as if its table were never full.
#[derive(Clone, Debug)]
pub(super) struct CortexM7 {
    bound: Bound,
    taken: HashMap<u32, u8>,
    /// `None` if code and constants are in tightly coupled memory.
    caches: Option<Caches>,
}

/// Counter of a branch that is predicted as taken.
const LIKELY: u8 = 2;

impl CortexM7 {
    /// Creates a core.
    pub(super) fn new(bound: Bound, caches: Option<Caches>) -> Self {
        Self { bound, taken: HashMap::new(), caches }
    }

    /// Returns the cycles of a section. Branch prediction and caches are empty at its start.
    pub(super) fn price(&mut self, section: &Section) -> u64 {
        self.taken.clear();
        if let Some(caches) = &mut self.caches {
            caches.clear();
        }
        let mut now = 0;
        // The instruction that was issued last, unless it was the second of a pair.
        let mut first: Option<Instruction> = None;
        let mut previous: Option<Instruction> = None;
        for step in &section.steps {
            let instruction = step.instruction;
            let is_paired =
                self.bound == Bound::Lower && first.is_some_and(|first| can_pair(&first, &instruction));
            let has_waited =
                previous.is_some_and(|previous| is_load(&previous) && depends(&previous, &instruction));
            now += self.cycles(&instruction) - u64::from(is_paired) + u64::from(has_waited);
            let penalty = self.penalty(step);
            now += penalty;
            if let Some(caches) = &mut self.caches {
                now += caches.stall(step, section.accesses(step));
            }
            first = (!is_paired && penalty == 0).then_some(instruction);
            previous = Some(instruction);
        }
        now
    }

    const fn cycles(&self, instruction: &Instruction) -> u64 {
        match instruction.kind {
            Kind::LoadMultiple { words } | Kind::StoreMultiple { words } => {
                self.bound.pick((words as u64).div_ceil(2), 1 + words as u64)
            }
            Kind::Divide => self.bound.pick(3, 20),
            Kind::FloatDivide => self.bound.pick(14, 16),
            Kind::FloatMultiplyAdd => self.bound.pick(1, 3),
            Kind::Barrier => self.bound.pick(1, 8),
            _ => 1,
        }
    }

    /// Returns the cycles that a wrongly predicted branch costs, and learns from the branch.
    /// Returns are predicted correctly; calls and jumps are wrong the first time.
    fn penalty(&mut self, step: &Step) -> u64 {
        const BX_LR: u64 = 1 << 14;
        let instruction = &step.instruction;
        let is_return = instruction.reads == BX_LR;
        if instruction.kind != Kind::Branch && instruction.kind != Kind::TableBranch || is_return {
            return 0;
        }
        let counter = self.taken.entry(step.address).or_insert(0);
        let is_predicted = *counter >= LIKELY;
        *counter = match (step.has_jumped, *counter) {
            (true, 0) => LIKELY,
            (true, counter) => (counter + 1).min(3),
            (false, counter) => counter.saturating_sub(1),
        };
        if is_predicted == step.has_jumped { 0 } else { self.bound.pick(6, 8) }
    }
}

const fn is_load(instruction: &Instruction) -> bool {
    matches!(instruction.kind, Kind::Load | Kind::LoadMultiple { .. })
}

/// Decides whether the second of two instructions reads or writes a result of the first.
const fn depends(first: &Instruction, second: &Instruction) -> bool {
    first.writes & (second.reads | second.address | second.writes) != 0
}

/// Decides whether two neighbours are issued in one cycle: neither takes several cycles, they are
/// independent, and they use different units: memory, multiplier, FPU, branches.
fn can_pair(first: &Instruction, second: &Instruction) -> bool {
    use Kind::{Branch, Data, Float, FloatMove, FloatMultiplyAdd, It, Load, Multiply, Store};
    let unit = |instruction: &Instruction| match instruction.kind {
        Data | It => Some(0),
        Load | Store { .. } => Some(1),
        Multiply => Some(2),
        Float | FloatMove { words: 1 } | FloatMultiplyAdd => Some(3),
        Branch => Some(4),
        _ => None,
    };
    match (unit(first), unit(second)) {
        (Some(4), _) | (None, _) | (_, None) => false,
        (Some(one), Some(two)) => (one == 0 || one != two) && !depends(first, second),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Code, section};
    use super::*;

    fn price(code: &[Code]) -> [u64; 2] {
        [Bound::Lower, Bound::Upper].map(|bound| CortexM7::new(bound, None).price(&section(code)))
    }

    #[test]
    fn independent_neighbours_of_different_units_are_paired_in_the_lower_bound() {
        use Code::{Narrow, Wide};
        let (add, other_add, load) = (Narrow(0x1840, 0), Narrow(0x18D2, 0), Narrow(0x681C, 1));
        // adds r0, r1; adds r2, r3
        assert_eq!(price(&[add, other_add]), [1, 2]);
        // The second one reads the result of the first: adds r0, r1; adds r0, r1
        assert_eq!(price(&[add, add]), [2, 2]);
        // ldr r4, [r3]; adds r0, r1
        assert_eq!(price(&[load, add]), [1, 2]);
        // Two multiplications, then two loads, whose second overwrites the first's result.
        let multiply = Wide(0xFB21, 0x3002, 0);
        assert_eq!(price(&[multiply, Wide(0xFB25, 0x3406, 0)]), [2, 2]);
        assert_eq!(price(&[load, Narrow(0x6811, 1)]), [2, 2]);
        // ldr r4, [r3]; adds r4, #4: the word arrives a cycle later.
        assert_eq!(price(&[load, Narrow(0x3404, 0)]), [3, 3]);
        // ldm r0!, {r2-r7}
        assert_eq!(price(&[Narrow(0xC8FC, 6)]), [3, 7]);
    }

    #[test]
    fn a_branch_is_predicted_after_its_first_time() {
        use Code::{Back, Narrow};
        // A loop of `nop; bne` in three rounds: the first and the last branch are predicted
        // wrongly.
        let round = [Narrow(0xBF00, 0), Narrow(0xD1FD, 0)];
        let code = [&round[..], &[Back(4)], &round, &[Back(4)], &round, &[Narrow(0xBF00, 0)]].concat();
        assert_eq!(price(&code), [7 + 2 * 6, 7 + 2 * 8]);
    }
}
