//! Addresses of code and constants in flash for their check ([`controller::supervisor::code`]).
//!
//! The check covers everything from the vector table to the end of the constants except the
//! built-in networks and the seal. It does not cover the initial values of `.data` (the log's
//! control block).

use controller::supervisor::CodeCheck;
use controller::supervisor::code::{UNSEALED, spans};
use inference::{BearingMaterial, shipped};

/// Replaced by `cargo xtask firmware`.
#[expect(unsafe_code, reason = "the build looks for the symbol's name")]
#[unsafe(no_mangle)]
static PINTLE_CODE_SEAL: u32 = UNSEALED;

/// Address and length of a built-in model image. The build reads this layout from the ELF file.
#[repr(C)]
#[derive(Clone, Copy)]
struct ModelImage {
    start: &'static u8,
    length: usize,
}

/// Built-in model images in the order of the material codes. The build leaves them out of the CRC.
#[expect(unsafe_code, reason = "the build looks for the symbol's name")]
#[unsafe(no_mangle)]
static PINTLE_MODEL_IMAGES: [ModelImage; BearingMaterial::COUNT] = {
    let mut images = [ModelImage { start: &0, length: 0 }; BearingMaterial::COUNT];
    let mut place = 0;
    while place < images.len() {
        let image = shipped(BearingMaterial::ALL[place]);
        images[place] = ModelImage { start: &image[0], length: image.len() };
        place += 1;
    }
    images
};

#[expect(unsafe_code, reason = "the linker defines them; only their addresses are taken")]
unsafe extern "C" {
    static __vector_table: u32;
    static __etext: u32;
    static __srodata: u32;
    static __erodata: u32;
}

/// Creates the check of this image.
#[must_use]
pub fn code_check() -> CodeCheck {
    #[expect(unsafe_code, reason = "the compiler may not take the build's placeholder for the value")]
    let seal = unsafe { (&raw const PINTLE_CODE_SEAL).read_volatile() };
    #[expect(unsafe_code, reason = "the compiler may not leave the table out of the image")]
    let images = unsafe { (&raw const PINTLE_MODEL_IMAGES).read_volatile() };
    let constants = &raw const __srodata as usize..&raw const __erodata as usize;
    let images = images.map(|image| {
        let start = &raw const *image.start as usize;
        start..start.saturating_add(image.length)
    });
    let code = &raw const __vector_table as usize..&raw const __etext as usize;
    let place = &raw const PINTLE_CODE_SEAL as usize;
    CodeCheck::new(spans(code, &constants, &images, place), seal)
}

/// Reads a word of the flash.
#[must_use]
pub(super) fn code_word(address: usize) -> u32 {
    #[expect(unsafe_code, reason = "the check's addresses are those of flash, in whole words")]
    unsafe {
        (address as *const u32).read_volatile()
    }
}
