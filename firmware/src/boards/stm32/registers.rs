//! Registers by address, for peripherals that both microcontrollers have in the same form.

/// Registers of a peripheral.
#[derive(Clone, Copy, Debug)]
pub(super) struct Registers(usize);

impl Registers {
    /// Takes the address of the first register.
    ///
    /// # Safety
    ///
    /// It is that of a peripheral with a clock, which nothing else uses; no access has an effect on
    /// memory other than buffers for DMA.
    #[expect(unsafe_code, reason = "what `read` and `write` rely on")]
    pub(super) const unsafe fn new(address: usize) -> Self {
        Self(address)
    }

    /// Reads the register at an offset in bytes.
    pub(super) fn read(self, offset: usize) -> u32 {
        #[expect(unsafe_code, reason = "a register, by the condition of `new`")]
        unsafe {
            (self.0.wrapping_add(offset) as *const u32).read_volatile()
        }
    }

    /// Writes the register at an offset in bytes.
    pub(super) fn write(self, offset: usize, value: u32) {
        #[expect(unsafe_code, reason = "a register, by the condition of `new`")]
        unsafe {
            (self.0.wrapping_add(offset) as *mut u32).write_volatile(value);
        }
    }

    /// Returns the address of the register at an offset.
    pub(super) const fn address(self, offset: usize) -> u32 {
        self.0.wrapping_add(offset) as u32
    }
}
