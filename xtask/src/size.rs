//! Flash, RAM and stack of the image, and whether a panic is reachable.
//!
//! Flash is what the image loads, RAM what it allocates statically; the stack has a separate region
//! below. The panic handler refers to a marker symbol: an image without the symbol contains no
//! reachable panic.

use crate::firmware::{DEFAULT, Firmware};
use crate::run::ChoreError;
use crate::stack;
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, elf};
use serde::{Deserialize, Serialize};
use std::path::Path;

const PANIC_MARKER: &str = "PINTLE_PANIC_MARKER";

/// Sizes of an image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Sizes {
    /// Bytes written to flash.
    pub(crate) flash_bytes: u64,
    /// Bytes of static RAM without the stack.
    pub(crate) ram_bytes: u64,
    /// True if a panic is reachable.
    pub(crate) panic_symbol: bool,
}

/// Sizes and use of the stack.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Figures {
    /// The sizes.
    #[serde(flatten)]
    pub(crate) sizes: Sizes,
    /// Upper bound of the stack, bytes.
    pub(crate) stack_bound_bytes: u32,
    /// Stack used in the emulator, bytes; `None` for a board that it does not model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) stack_painted_bytes: Option<u32>,
}

impl Sizes {
    /// Reads an image.
    pub(crate) fn read(path: &Path) -> Result<Self, ChoreError> {
        let wrong =
            |found: String| ChoreError::File { file: path.into(), found, expected: "the firmware's image" };
        let bytes = std::fs::read(path).map_err(|e| wrong(e.to_string()))?;
        let image = object::File::parse(&*bytes).map_err(|e| wrong(e.to_string()))?;
        let mut sizes = Self { flash_bytes: 0, ram_bytes: 0, panic_symbol: false };
        for section in image.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
            if sh_flags & u64::from(elf::SHF_ALLOC) == 0 {
                continue;
            }
            // Writable sections are in RAM. Initialised data are in flash as well, from where they
            // are copied.
            let in_ram = sh_flags & u64::from(elf::SHF_WRITE) != 0;
            if in_ram {
                sizes.ram_bytes += section.size();
            }
            if !in_ram || section.kind() == object::SectionKind::Data {
                sizes.flash_bytes += section.size();
            }
        }
        sizes.panic_symbol = image.symbols().any(|symbol| symbol.name() == Ok(PANIC_MARKER));
        Ok(sizes)
    }
}

/// Builds a board's image and measures it. Only the default board's image is run.
///
/// For another board one build suffices: the image with the sizes of its stack frames has the same
/// code.
pub(crate) fn measure(board: Firmware) -> Result<Figures, ChoreError> {
    let (image, stack) = stack::measure(board)?;
    let image = if board == DEFAULT { board.build()? } else { image };
    let sizes = Sizes::read(&image)?;
    let (stack_bound_bytes, stack_painted_bytes) = (stack.stack_bound_bytes, stack.stack_painted_bytes);
    Ok(Figures { sizes, stack_bound_bytes, stack_painted_bytes })
}

/// Prints the figures.
pub(crate) fn size(board: Firmware, json: bool) -> Result<(), ChoreError> {
    let figures = measure(board)?;
    if json {
        println!("{}", serde_json::json!(figures));
    } else {
        let Figures { sizes, stack_bound_bytes, stack_painted_bytes } = figures;
        println!("flash {} bytes, static RAM {} bytes", sizes.flash_bytes, sizes.ram_bytes);
        println!("stack at most {stack_bound_bytes} bytes{}", stack::seen(stack_painted_bytes));
        println!("reachable panic: {}", if sizes.panic_symbol { "yes" } else { "none" });
    }
    Ok(())
}
