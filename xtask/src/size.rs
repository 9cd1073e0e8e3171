//! Flash and RAM of the image, and whether a panic is reachable in it.
//!
//! Flash is what the image loads, RAM what it claims statically; the stack comes on top. The panic handler refers to a marker
//! symbol: an image without the symbol contains no reachable panic.

use crate::run::ChoreError;
use crate::{firmware, setup};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, elf};
use serde::Serialize;

const PANIC_MARKER: &str = "PINTLE_PANIC_MARKER";
/// Start of the RAM in memory.x.
const RAM_START: u64 = 0x2000_0000;

#[derive(Serialize)]
struct Sizes {
    flash_bytes: u64,
    ram_bytes: u64,
    panic_symbol: bool,
}

/// Builds the image and prints its sizes.
pub(crate) fn size(json: bool) -> Result<(), ChoreError> {
    let way = setup::target(setup::TARGET)?;
    let path = firmware::build(&way)?;
    let wrong =
        |found: String| ChoreError::File { file: path.clone(), found, expected: "the firmware's image" };
    let bytes = std::fs::read(&path).map_err(|e| wrong(e.to_string()))?;
    let image = object::File::parse(&*bytes).map_err(|e| wrong(e.to_string()))?;
    let mut sizes = Sizes { flash_bytes: 0, ram_bytes: 0, panic_symbol: false };
    for section in image.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
        if sh_flags & u64::from(elf::SHF_ALLOC) == 0 {
            continue;
        }
        let in_ram = section.address() >= RAM_START;
        if in_ram {
            sizes.ram_bytes += section.size();
        }
        // Initialised data stand in flash too, from where they are copied.
        if !in_ram || section.kind() == object::SectionKind::Data {
            sizes.flash_bytes += section.size();
        }
    }
    sizes.panic_symbol = image.symbols().any(|symbol| symbol.name() == Ok(PANIC_MARKER));
    if json {
        println!("{}", serde_json::json!(sizes));
    } else {
        println!("flash {} bytes, static RAM {} bytes", sizes.flash_bytes, sizes.ram_bytes);
        println!("reachable panic: {}", if sizes.panic_symbol { "yes" } else { "none" });
    }
    Ok(())
}
