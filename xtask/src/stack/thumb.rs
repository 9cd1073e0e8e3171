//! Part of the Thumb instruction set that determines the use of the stack: branches, calls and
//! changes of the stack pointer.
//!
//! Encodings: Arm v7-M Architecture Reference Manual, chapters A5 and A7. In compiled code no other
//! instruction leaves the function or lowers the stack pointer.

/// Effect of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effect {
    /// Nothing of interest.
    None,
    /// Calls an address.
    Call(u32),
    /// Jumps to an address, within the function or out of it.
    Jump(u32),
    /// Calls or jumps to an address in a register. A branch table within a function does not count.
    Indirect,
    /// Lowers the stack pointer by this number of bytes.
    Lower(u32),
    /// Sets the stack pointer to an unknown value.
    Sets,
}

/// Decides whether a half-word is the first of two.
pub(crate) const fn is_wide(first: u16) -> bool {
    first >> 11 >= 0b11101
}

/// Returns the effect of an instruction at an address; `second` is read for wide ones only.
pub(super) fn effect(address: u32, first: u16, second: u16) -> Effect {
    let base = address.wrapping_add(4);
    if is_wide(first) { wide(base, first.into(), second.into()) } else { narrow(base, first.into()) }
}

fn narrow(base: u32, word: u32) -> Effect {
    let target = |bits: u32, width: u32| base.wrapping_add(sign_extend(bits << 1, width + 1));
    match word {
        // PUSH {registers, lr}
        _ if word >> 9 == 0b101_1010 => Effect::Lower(4 * (word & 0x1FF).count_ones()),
        // SUB sp, #imm7*4
        _ if word >> 7 == 0b1_0110_0001 => Effect::Lower(4 * (word & 0x7F)),
        // BLX register
        _ if word & 0xFF87 == 0x4780 => Effect::Indirect,
        // BX register other than lr
        _ if word & 0xFF87 == 0x4700 && word >> 3 & 15 != 14 => Effect::Indirect,
        // MOV or ADD with pc or sp as destination, high registers
        _ if word & 0xFF87 == 0x4687 || word & 0xFF87 == 0x4487 => Effect::Indirect,
        _ if word & 0xFF87 == 0x4685 || word & 0xFF87 == 0x4485 => Effect::Sets,
        // B<c> (condition 14 is undefined, 15 a supervisor call)
        _ if word >> 12 == 0b1101 && word >> 8 & 15 < 14 => Effect::Jump(target(word & 0xFF, 8)),
        // B
        _ if word >> 11 == 0b1_1100 => Effect::Jump(target(word & 0x7FF, 11)),
        // CBZ, CBNZ
        _ if word & 0xF500 == 0xB100 => {
            Effect::Jump(base.wrapping_add((word >> 3 & 31) << 1 | (word >> 9 & 1) << 6))
        }
        _ => Effect::None,
    }
}

fn wide(base: u32, first: u32, second: u32) -> Effect {
    const SP: u32 = 13;
    let (base_register, destination) = (first & 15, second >> 8 & 15);
    // BL and the branches
    if first >> 11 == 0b11110 && second >> 15 == 1 {
        let (sign, j1, j2) = (first >> 10 & 1, second >> 13 & 1, second >> 11 & 1);
        let (i1, i2) = (1 ^ j1 ^ sign, 1 ^ j2 ^ sign);
        let far = sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1;
        let far = base.wrapping_add(sign_extend(far, 25));
        let near = sign << 20 | j2 << 19 | j1 << 18 | (first & 0x3F) << 12 | (second & 0x7FF) << 1;
        return match (second >> 14 & 1, second >> 12 & 1) {
            (1, 1) => Effect::Call(far),
            (0, 1) => Effect::Jump(far),
            // B<c>.W; with condition 14 and 15 these are hints and system instructions.
            (0, 0) if first >> 6 & 15 < 14 => Effect::Jump(base.wrapping_add(sign_extend(near, 21))),
            // MSR to the main or process stack pointer
            (0, 0) if first & 0xFFE0 == 0xF380 && matches!(second & 0xFF, 8 | 9) => Effect::Sets,
            _ => Effect::None,
        };
    }
    match first {
        // STMDB sp!
        0xE92D => Effect::Lower(4 * second.count_ones()),
        // STR register, [sp, #-imm8]!
        0xF84D if second & 0x0D00 == 0x0D00 => Effect::Lower(second & 0xFF),
        // STRD register, register, [sp, #-imm8*4]!
        _ if first & 0xFFFF == 0xE96D => Effect::Lower(4 * (second & 0xFF)),
        // VPUSH, single and double: imm8 words
        _ if first & 0xFFBF == 0xED2D && second & 0x0E00 == 0x0A00 => Effect::Lower(4 * (second & 0xFF)),
        // SUB.W sp, sp, #modified immediate
        _ if first & 0xFBEF == 0xF1AD && destination == SP && second >> 15 == 0 => {
            Effect::Lower(modified_immediate(first, second))
        }
        // SUBW sp, sp, #imm12
        _ if first & 0xFBFF == 0xF2AD && destination == SP && second >> 15 == 0 => {
            Effect::Lower((first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF)
        }
        // SUB.W sp, sp, register
        _ if first & 0xFFEF == 0xEBAD && destination == SP => Effect::Sets,
        // LDR pc, [...], but for LDR pc, [sp], #4, which is a return
        _ if first & 0xFF7F == 0xF85F && second >> 12 == 15 => Effect::Indirect,
        _ if (first & 0xFFF0 == 0xF8D0 || first & 0xFFF0 == 0xF850)
            && second >> 12 == 15
            && base_register != SP =>
        {
            Effect::Indirect
        }
        _ => Effect::None,
    }
}

/// `ThumbExpandImm`: 12 bits that stand for a 32-bit constant.
fn modified_immediate(first: u32, second: u32) -> u32 {
    let bits = (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF;
    let byte = bits & 0xFF;
    match (bits >> 10, bits >> 8 & 3) {
        (0, 0) => byte,
        (0, 1) => byte << 16 | byte,
        (0, 2) => byte << 24 | byte << 8,
        (0, _) => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | bits & 0x7F).rotate_right(bits >> 7),
    }
}

fn sign_extend(bits: u32, width: u32) -> u32 {
    let unused = 32 - width;
    ((bits << unused).cast_signed() >> unused).cast_unsigned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_have_the_effect_that_the_manual_says() {
        // As llvm-mc assembles them at address 0x1000.
        let cases = [
            (0xB5F0, 0, Effect::Lower(20), "push {r4-r7, lr}"),
            (0xB08D, 0, Effect::Lower(52), "sub sp, #52"),
            (0xB00D, 0, Effect::None, "add sp, #52"),
            (0xE92D, 0x4FF0, Effect::Lower(36), "push.w {r4-r11, lr}"),
            (0xF84D, 0xBD04, Effect::Lower(4), "str r11, [sp, #-4]!"),
            (0xF84D, 0xB004, Effect::None, "str.w r11, [sp, r4]"),
            (0xED2D, 0x8B04, Effect::Lower(16), "vpush {d8, d9}"),
            (0xED2D, 0x8A03, Effect::Lower(12), "vpush {s16-s18}"),
            (0xF5AD, 0x7D84, Effect::Lower(0x108), "sub.w sp, sp, #264"),
            (0xF2AD, 0x4D04, Effect::Lower(0x404), "subw sp, sp, #1028"),
            (0xF1AD, 0x0D08, Effect::Lower(8), "sub.w sp, sp, #8"),
            (0xEBAD, 0x0D04, Effect::Sets, "sub.w sp, sp, r4"),
            (0x46A5, 0, Effect::Sets, "mov sp, r4"),
            (0xF382, 0x8808, Effect::Sets, "msr msp, r2"),
            (0xF3EF, 0x8008, Effect::None, "mrs r0, msp"),
            (0x4780, 0, Effect::Indirect, "blx r0"),
            (0x4770, 0, Effect::None, "bx lr"),
            (0x4718, 0, Effect::Indirect, "bx r3"),
            (0x4687, 0, Effect::Indirect, "mov pc, r0"),
            (0xF8DF, 0xF004, Effect::Indirect, "ldr.w pc, [pc, #4]"),
            (0xF850, 0xF021, Effect::Indirect, "ldr.w pc, [r0, r1, lsl #2]"),
            (0xF85D, 0xFB04, Effect::None, "ldr pc, [sp], #4"),
            (0xE8DF, 0xF003, Effect::None, "tbb [pc, r3]"),
            (0xF7FF, 0xFFFE, Effect::Call(0x1000), "bl ."),
            (0xF000, 0xF800, Effect::Call(0x1004), "bl .+4"),
            (0xF7FF, 0xBFFE, Effect::Jump(0x1000), "b.w ."),
            (0xF43F, 0xAFFE, Effect::Jump(0x1000), "beq.w ."),
            (0xE7FE, 0, Effect::Jump(0x1000), "b ."),
            (0xD1FE, 0, Effect::Jump(0x1000), "bne ."),
            (0xB108, 0, Effect::Jump(0x1006), "cbz r0, .+6"),
            (0xDF00, 0, Effect::None, "svc #0"),
            (0xF3BF, 0x8F6F, Effect::None, "isb"),
        ];
        for (first, second, expected, text) in cases {
            assert_eq!(effect(0x1000, first, second), expected, "{text}");
        }
    }
}
