//! Thumb instructions as far as their time depends on them: kind, registers, words of a transfer.
//!
//! Encodings: Arm v7-M Architecture Reference Manual, chapters A5 to A7. The condition flags are
//! not followed. Registers 0 to 15 are those of the core, 16 to 47 are `s0` to `s31`.

use crate::stack::thumb::is_wide;

/// Kind of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Data processing of integers, multiplications excepted.
    Data,
    /// Multiplication, with or without accumulation.
    Multiply,
    /// `SDIV`, `UDIV`.
    Divide,
    /// Branch or call; the trace shows whether it was taken.
    Branch,
    /// `TBB`, `TBH`.
    TableBranch,
    /// Load of one word or less.
    Load,
    /// Store of one word or less.
    Store {
        /// True if the offset is in a register.
        has_register_offset: bool,
    },
    /// Load of several words.
    LoadMultiple {
        /// Their number.
        words: u8,
    },
    /// Store of several words.
    StoreMultiple {
        /// Their number.
        words: u8,
    },
    /// `IT`.
    It,
    /// `DMB`, `DSB`, `ISB`.
    Barrier,
    /// Access to a special register, and hints.
    System,
    /// Data processing of floats in one cycle.
    Float,
    /// Move between registers of the core and of the FPU.
    FloatMove {
        /// Number of words.
        words: u8,
    },
    /// Multiplication of floats with accumulation.
    FloatMultiplyAdd,
    /// `VDIV`, `VSQRT`.
    FloatDivide,
}

/// An instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Instruction {
    /// Length in bytes.
    pub(super) bytes: u8,
    /// Its kind.
    pub(super) kind: Kind,
    /// Registers that form an address.
    pub(super) address: u64,
    /// Other registers that are read.
    pub(super) reads: u64,
    /// Registers that are written.
    pub(super) writes: u64,
}

/// Bit of the program counter.
const PC: u64 = 1 << 15;
const SP: u32 = 13;
const LR: u32 = 14;

const fn bit(register: u32) -> u64 {
    1 << (register & 15)
}

/// Bit of a single-precision register; `number` has four upper bits, `low` is the lowest one.
const fn single(number: u32, low: u32) -> u64 {
    1 << (16 + ((number & 15) << 1 | low & 1))
}

/// Bits of `words` single-precision registers from one on.
const fn singles(first: u64, words: u32) -> u64 {
    let count = if words > 32 { 32 } else { words };
    first.wrapping_mul((1 << count) - 1)
}

/// Creates a narrow instruction.
const fn new(kind: Kind, address: u64, reads: u64, writes: u64) -> Instruction {
    Instruction { bytes: 2, kind, address, reads, writes }
}

impl Instruction {
    /// Decodes an instruction; `second` is read for wide ones only.
    pub(super) fn decode(first: u16, second: u16) -> Self {
        if is_wide(first) {
            Self { bytes: 4, ..wide(first.into(), second.into()) }
        } else {
            narrow(first.into())
        }
    }

    /// Decides whether the instruction accesses memory.
    pub(super) const fn is_transfer(&self) -> bool {
        use Kind::{Load, LoadMultiple, Store, StoreMultiple, TableBranch};
        matches!(self.kind, Load | Store { .. } | LoadMultiple { .. } | StoreMultiple { .. } | TableBranch)
    }

    /// Decides whether the FPU executes the instruction.
    pub(super) const fn is_float(&self) -> bool {
        use Kind::{Float, FloatDivide, FloatMove, FloatMultiplyAdd};
        matches!(self.kind, Float | FloatMove { .. } | FloatMultiplyAdd | FloatDivide)
            || (self.reads | self.writes) >> 16 != 0
    }

    /// Decides whether the instruction loads the program counter.
    pub(super) const fn loads_pc(&self) -> bool {
        self.is_transfer() && self.writes & PC != 0
    }
}

fn narrow(word: u32) -> Instruction {
    match word >> 10 {
        0b000000..=0b010000 => arithmetic(word),
        0b010001 => high_registers(word),
        0b010010..=0b100111 => narrow_transfer(word),
        0b101000..=0b101011 => {
            new(Kind::Data, 0, if word >> 11 & 1 == 1 { bit(SP) } else { 0 }, bit(word >> 8 & 7))
        }
        0b101100..=0b101111 => miscellaneous(word),
        0b110000..=0b110011 => {
            let base = bit(word >> 8 & 7);
            multiple(word >> 11 & 1 == 1, base, u64::from(word & 0xFF), base)
        }
        0b110100..=0b110111 if word >> 8 & 15 >= 14 => new(Kind::System, 0, 0, 0),
        // B with and without a condition
        _ => new(Kind::Branch, 0, 0, 0),
    }
}

/// Decodes narrow data processing of the lower eight registers.
fn arithmetic(word: u32) -> Instruction {
    let (low, middle, high) = (bit(word & 7), bit(word >> 3 & 7), bit(word >> 6 & 7));
    let wide_low = bit(word >> 8 & 7);
    match word >> 10 {
        // ADD and SUB of two registers; shifts and ADD or SUB of a constant
        0b000110 => new(Kind::Data, 0, middle | high, low),
        0b000000..=0b000111 => new(Kind::Data, 0, middle, low),
        // MOV, CMP, ADD and SUB of a constant
        0b001000 | 0b001001 => new(Kind::Data, 0, 0, wide_low),
        0b001010 | 0b001011 => new(Kind::Data, 0, wide_low, 0),
        0b001100..=0b001111 => new(Kind::Data, 0, wide_low, wide_low),
        _ => match word >> 6 & 15 {
            // TST, CMP, CMN
            8 | 10 | 11 => new(Kind::Data, 0, low | middle, 0),
            13 => new(Kind::Multiply, 0, low | middle, low),
            _ => new(Kind::Data, 0, low | middle, low),
        },
    }
}

/// Decodes narrow loads and stores of a word or less.
fn narrow_transfer(word: u32) -> Instruction {
    let (low, middle, high) = (bit(word & 7), bit(word >> 3 & 7), bit(word >> 6 & 7));
    let wide_low = bit(word >> 8 & 7);
    let (is_load, store) = (word >> 11 & 1 == 1, |has_register_offset| Kind::Store { has_register_offset });
    match word >> 12 {
        // Relative to the program counter
        0b0100 => new(Kind::Load, 0, 0, wide_low),
        // STR, STRH, STRB; LDRSB, LDR, LDRH, LDRB, LDRSH
        0b0101 if word >> 9 & 7 < 3 => new(store(true), middle | high, low, 0),
        0b0101 => new(Kind::Load, middle | high, 0, low),
        0b1001 if is_load => new(Kind::Load, bit(SP), 0, wide_low),
        0b1001 => new(store(false), bit(SP), wide_low, 0),
        _ if is_load => new(Kind::Load, middle, 0, low),
        _ => new(store(false), middle, low, 0),
    }
}

/// Decodes ADD, CMP and MOV of any two registers, and branches to a register.
fn high_registers(word: u32) -> Instruction {
    let (destination, source) = (bit(word & 7 | word >> 4 & 8), bit(word >> 3 & 15));
    match word >> 8 & 3 {
        3 => new(Kind::Branch, 0, source, if word & 0x80 == 0 { 0 } else { bit(LR) }),
        1 => new(Kind::Data, 0, destination | source, 0),
        _ if destination == PC => new(Kind::Branch, 0, source, 0),
        0 => new(Kind::Data, 0, destination | source, destination),
        _ => new(Kind::Data, 0, source, destination),
    }
}

fn miscellaneous(word: u32) -> Instruction {
    let (low, middle) = (bit(word & 7), bit(word >> 3 & 7));
    match word >> 8 & 15 {
        0b0000 => new(Kind::Data, 0, bit(SP), bit(SP)),
        0b0001 | 0b0011 | 0b1001 | 0b1011 => new(Kind::Branch, 0, low, 0),
        0b0010 | 0b1010 => new(Kind::Data, 0, middle, low),
        0b0100 | 0b0101 => {
            let list = u64::from(word & 0xFF) | u64::from(word >> 8 & 1) << LR;
            multiple(false, bit(SP), list, bit(SP))
        }
        0b1100 | 0b1101 => {
            multiple(true, bit(SP), u64::from(word & 0xFF) | u64::from(word >> 8 & 1) << 15, bit(SP))
        }
        0b1111 if word & 15 != 0 => new(Kind::It, 0, 0, 0),
        _ => new(Kind::System, 0, 0, 0),
    }
}

/// Returns a transfer of a list of registers that writes its address back to `base`.
const fn multiple(is_load: bool, address: u64, list: u64, base: u64) -> Instruction {
    let words = list.count_ones() as u8;
    if is_load {
        new(Kind::LoadMultiple { words }, address, 0, list | base)
    } else {
        new(Kind::StoreMultiple { words }, address, list, base)
    }
}

fn wide(first: u32, second: u32) -> Instruction {
    match (first >> 11 & 3, first >> 4 & 0x7F) {
        (_, code) if code & 0x40 != 0 && first >> 11 & 3 != 2 => coprocessor(first, second),
        (1, code) if code & 0x64 == 0 => {
            let base = bit(first & 15);
            let written = if first >> 5 & 1 == 1 { base } else { 0 };
            multiple(first >> 4 & 1 == 1, base, second.into(), written)
        }
        (1, code) if code & 0x60 == 0 => double_or_exclusive(first, second),
        (1, _) => data(first & 15, second >> 8 & 15, bit(second & 15)),
        (2, _) if second >> 15 == 0 => immediate(first, second),
        (2, _) => control(first, second),
        (_, code) if code & 0x60 == 0 => one_word(first, second),
        (_, code) if code & 0x70 == 0x20 => data(first & 15, second >> 8 & 15, bit(second & 15)),
        _ => multiply(first, second),
    }
}

/// Returns data processing of two registers; 15 stands for none.
const fn data(operand: u32, destination: u32, other: u64) -> Instruction {
    let reads = if operand == 15 { other } else { bit(operand) | other };
    let writes = if destination == 15 { 0 } else { bit(destination) };
    new(Kind::Data, 0, reads, writes)
}

fn immediate(first: u32, second: u32) -> Instruction {
    let destination = second >> 8 & 15;
    match first >> 4 & 0x3F {
        // MOVW has a part of its constant in place of a register.
        0x24 => data(15, destination, 0),
        // MOVT and BFI change a part of their destination.
        0x2C => data(15, destination, bit(destination)),
        0x36 => data(first & 15, destination, bit(destination)),
        _ => data(first & 15, destination, 0),
    }
}

/// Decodes wide branches, barriers and accesses to special registers.
fn control(first: u32, second: u32) -> Instruction {
    let is_call = second >> 14 & 1 == 1;
    if second >> 12 & 1 == 1 || first >> 6 & 15 < 14 && !is_call {
        return new(Kind::Branch, 0, 0, if is_call { bit(LR) } else { 0 });
    }
    match first {
        0xF3BF => new(Kind::Barrier, 0, 0, 0),
        0xF3E0..=0xF3FF => new(Kind::System, 0, 0, bit(second >> 8 & 15)),
        _ => new(Kind::System, 0, bit(first & 15), 0),
    }
}

fn double_or_exclusive(first: u32, second: u32) -> Instruction {
    let (base, is_load) = (bit(first & 15), first >> 4 & 1 == 1);
    let (one, two) = (bit(second >> 12), bit(second >> 8));
    if first >> 5 & 0b1001 != 0 {
        let written = if first >> 5 & 1 == 1 { base } else { 0 };
        return if is_load {
            new(Kind::LoadMultiple { words: 2 }, base, 0, one | two | written)
        } else {
            new(Kind::StoreMultiple { words: 2 }, base, one | two, written)
        };
    }
    let is_table = first & 0xFFF0 == 0xE8D0 && second >> 5 & 7 == 0;
    match (is_table, is_load) {
        (true, _) => new(Kind::TableBranch, base | bit(second), 0, PC),
        (false, true) => new(Kind::Load, base, 0, one),
        // The manual prices STREX as a load. The forms for bytes and half-words have their result
        // in another place.
        (false, false) => new(Kind::Load, base, one, if first >> 7 & 1 == 0 { two } else { bit(second) }),
    }
}

/// Decodes loads and stores of a word or less.
fn one_word(first: u32, second: u32) -> Instruction {
    let (base, value) = (bit(first & 15), bit(second >> 12));
    let has_long_offset = first >> 7 & 1 == 1 || first & 15 == 15;
    let has_register_offset = !has_long_offset && second >> 11 & 1 == 0;
    let address = base | if has_register_offset { bit(second) } else { 0 };
    let is_written = !has_long_offset && second >> 11 & 1 == 1 && second >> 8 & 1 == 1;
    let written = if is_written { base } else { 0 };
    // Bytes and half-words to register 15 are hints.
    let is_hint = first >> 5 & 3 != 2 && value == PC;
    match (first >> 4 & 1 == 1, is_hint) {
        (true, true) => new(Kind::System, 0, 0, 0),
        (true, false) => new(Kind::Load, address & !PC, 0, value | written),
        (false, _) => new(Kind::Store { has_register_offset }, address, value, written),
    }
}

fn multiply(first: u32, second: u32) -> Instruction {
    let factors = bit(first) | bit(second);
    let (low, high) = (second >> 12 & 15, second >> 8 & 15);
    match first >> 4 & 0xF {
        0x0..=0x7 => {
            let sum = if low == 15 { 0 } else { bit(low) };
            new(Kind::Multiply, 0, factors | sum, bit(high))
        }
        0x9 | 0xB => new(Kind::Divide, 0, factors, bit(high)),
        0x8 | 0xA => new(Kind::Multiply, 0, factors, bit(low) | bit(high)),
        _ => new(Kind::Multiply, 0, factors | bit(low) | bit(high), bit(low) | bit(high)),
    }
}

/// Decodes the instructions of the FPU.
fn coprocessor(first: u32, second: u32) -> Instruction {
    let width = if second >> 8 & 1 == 0 { 1 } else { 2 };
    let register = |number, low| singles(single(number, if width == 1 { low } else { 0 }), width);
    let destination = register(second >> 12, first >> 6);
    let (operand, other) = (register(first, second >> 7), register(second, second >> 5));
    let is_load = first >> 4 & 1 == 1;
    // VMOV of two registers of the core
    if first & 0xFFE0 == 0xEC40 {
        let (core, float) = (bit(second >> 12) | bit(first), singles(single(second, second >> 5), 2));
        let (reads, writes) = if is_load { (float, core) } else { (core, float) };
        return new(Kind::FloatMove { words: 2 }, 0, reads, writes);
    }
    if first >> 9 & 7 == 0b110 {
        return float_transfer(first, second, destination, width);
    }
    // VMOV of one register of the core, VMRS, VMSR
    if second >> 4 & 1 == 1 {
        let core = bit(second >> 12);
        let (reads, writes) = if is_load { (operand, core & !PC) } else { (core, operand) };
        return new(Kind::FloatMove { words: 1 }, 0, reads, writes);
    }
    match first >> 4 & 0b1011 {
        0 | 1 | 9 | 10 => new(Kind::FloatMultiplyAdd, 0, operand | other | destination, destination),
        2 | 3 => new(Kind::Float, 0, operand | other, destination),
        8 => new(Kind::FloatDivide, 0, operand | other, destination),
        // VSQRT
        _ if first & 15 == 1 && second >> 6 & 3 == 3 => new(Kind::FloatDivide, 0, other, destination),
        // VCMP
        _ if first & 14 == 4 => new(Kind::Float, 0, destination | other, 0),
        // VMOV of a constant
        _ if second >> 6 & 1 == 0 && first & 8 == 0 => new(Kind::Float, 0, 0, destination),
        _ => new(Kind::Float, 0, other, destination),
    }
}

/// Decodes loads and stores of the FPU; `width` is the number of words of `destination`.
fn float_transfer(first: u32, second: u32, destination: u64, width: u32) -> Instruction {
    let base = bit(first);
    let is_written = first >> 5 & 1 == 1;
    let is_multiple = first >> 8 & 1 == 0 || is_written;
    let words = if is_multiple { second & 0xFF } else { width };
    let list = singles(destination & destination.wrapping_neg(), words);
    let written = if is_written { base } else { 0 };
    let is_single = words == 1 && !is_multiple;
    let words = words as u8;
    match (first >> 4 & 1 == 1, is_single) {
        (true, true) => new(Kind::Load, base & !PC, 0, list | written),
        (true, false) => new(Kind::LoadMultiple { words }, base & !PC, 0, list | written),
        (false, true) => new(Kind::Store { has_register_offset: true }, base, list, written),
        (false, false) => new(Kind::StoreMultiple { words }, base, list, written),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits of registers; `s0` is 16.
    fn registers(numbers: &[u32]) -> u64 {
        numbers.iter().map(|number| 1 << number).sum()
    }

    /// Opcode; registers that form an address, that are read otherwise, that are written; text.
    type Case = (u16, u16, [&'static [u32]; 3], &'static str);

    #[test]
    fn registers_are_those_of_the_manual() {
        // As llvm-mc assembles them.
        let cases: [Case; 22] = [
            (0x1888, 0, [&[], &[1, 2], &[0]], "adds r0, r1, r2"),
            (0x4288, 0, [&[], &[0, 1], &[]], "cmp r0, r1"),
            (0x4498, 0, [&[], &[3, 8], &[8]], "add r8, r3"),
            (0x5888, 0, [&[1, 2], &[], &[0]], "ldr r0, [r1, r2]"),
            (0x9049, 0, [&[13], &[0], &[]], "str r0, [sp, #292]"),
            (0xB5F0, 0, [&[13], &[4, 5, 6, 7, 14], &[13]], "push {r4-r7, lr}"),
            (0xBD10, 0, [&[13], &[], &[4, 13, 15]], "pop {r4, pc}"),
            (0xE8BC, 0x01E0, [&[12], &[], &[5, 6, 7, 8, 12]], "ldm r12!, {r5-r8}"),
            (0xE9CD, 0x0147, [&[13], &[0, 1], &[]], "strd r0, r1, [sp, #284]"),
            (0xE840, 0x3501, [&[0], &[3], &[5]], "strex r5, r3, [r0, #4]"),
            (0xE8C2, 0x1F40, [&[2], &[1], &[0]], "strexb r0, r1, [r2]"),
            (0xEB01, 0x0082, [&[], &[1, 2], &[0]], "add.w r0, r1, r2, lsl #2"),
            (0xF240, 0x0901, [&[], &[], &[9]], "movw r9, #1"),
            (0xF2C2, 0x0900, [&[], &[9], &[9]], "movt r9, #8192"),
            (0xF36F, 0x201F, [&[], &[0], &[0]], "bfc r0, #8, #24"),
            (0xF851, 0x0B04, [&[1], &[], &[0, 1]], "ldr r0, [r1], #4"),
            (0xF841, 0x0022, [&[1, 2], &[0], &[]], "str.w r0, [r1, r2, lsl #2]"),
            (0xFB21, 0x3002, [&[], &[1, 2, 3], &[0]], "smlad r0, r1, r2, r3"),
            (0xFBA2, 0x0103, [&[], &[2, 3], &[0, 1]], "umull r0, r1, r2, r3"),
            (0xFBB1, 0xF0F2, [&[], &[1, 2], &[0]], "udiv r0, r1, r2"),
            (0xED2D, 0x8B04, [&[13], &[32, 33, 34, 35], &[13]], "vpush {d8, d9}"),
            (0xEE00, 0x0A81, [&[], &[16, 17, 18], &[16]], "vmla.f32 s0, s1, s2"),
        ];
        for (first, second, expected, text) in cases {
            let found = Instruction::decode(first, second);

            assert_eq!([found.address, found.reads, found.writes], expected.map(registers), "{text}");
        }
    }
}
