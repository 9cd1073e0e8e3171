//! Comparison of the kernels between cores, and what the crate `inference` adds to an image.

use crate::cores::{CORES, COUNTED, EmulatedCore};
use crate::run::ChoreError;
use crate::setup;
use inference::kernel::{Native, Portable};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind};
use on_target::agreement::digest;
use on_target::network::Room;
use std::collections::BTreeSet;

/// Number of seeds that the image runs.
const SEEDS: u64 = 4;

/// Compares the digests of every core with those of the host, for every shape, mode and engine;
/// then checks the smallest image.
pub(crate) fn kernels() -> Result<(), ChoreError> {
    setup::setup()?;
    let mut room = Room([0; 20_000]);
    let mut expected = String::new();
    for seed in 1..=SEEDS {
        for found in [digest::<Portable>(seed, &mut room), digest::<Native>(seed, &mut room)] {
            expected += &format!("{seed} {:016x}\n", found.map_or(0, |digest| digest.0));
        }
    }
    let filter = format!("filter {:016x}\n", on_target::filter::digest().unwrap_or(0));
    for core in CORES {
        let found = core.run(&core.build("agree")?)?;
        let expected = if core.has_fpu() { format!("{expected}{filter}") } else { expected.clone() };
        if found != expected {
            return Err(ChoreError::Differs {
                what: format!("digests on {} ({})", core.board, core.name),
                found,
                expected,
            });
        }
        println!(
            "{:<14} {:<10} portable and SMLAD kernels{} agree with the host: {SEEDS} seeds",
            core.board,
            core.name,
            if core.has_fpu() { " and the filter" } else { "" }
        );
    }
    let image = SmallestImage::build(COUNTED)?;
    println!("smallest image: flash {} bytes, no reachable panic", image.flash_bytes);
    // On a core without FPU the compiler calls a routine for every float operation.
    SmallestImage::build(EmulatedCore { target: "thumbv7em-none-eabi", ..COUNTED })?.has_no_float()?;
    println!("smallest image without FPU: no floating-point routine");
    Ok(())
}

/// An image that only estimates.
pub(crate) struct SmallestImage {
    /// Bytes of code and constants, the model included.
    pub(crate) flash_bytes: u64,
    symbols: BTreeSet<String>,
}

impl SmallestImage {
    /// Builds the image for a core and rejects a reachable panic.
    pub(crate) fn build(core: EmulatedCore) -> Result<Self, ChoreError> {
        let file = core.build("estimate")?;
        let wrong = |found: String| ChoreError::File {
            file: file.clone(),
            found,
            expected: "an image without panics",
        };
        let bytes = std::fs::read(&file).map_err(|error| wrong(error.to_string()))?;
        let image = object::File::parse(&*bytes).map_err(|error| wrong(error.to_string()))?;
        let symbols: BTreeSet<String> =
            (image.symbols()).filter_map(|symbol| symbol.name().ok().map(str::to_owned)).collect();
        if symbols.contains("PINTLE_PANIC_MARKER") {
            return Err(wrong("a reachable panic".into()));
        }
        // If the compiler had evaluated the model at compile time, the image would not contain it.
        let weights = inference::shipped(inference::BearingMaterial::Babbitt).len() as u64;
        let loaded = [SectionKind::Text, SectionKind::ReadOnlyData, SectionKind::Data];
        let flash_bytes = image
            .sections()
            .filter(|section| loaded.contains(&section.kind()))
            .map(|section| section.size())
            .sum();
        if flash_bytes < weights {
            return Err(wrong(format!("{flash_bytes} bytes, less than the model's {weights}")));
        }
        Ok(Self { flash_bytes, symbols })
    }

    fn has_no_float(&self) -> Result<(), ChoreError> {
        let float = |name: &&String| {
            ["__aeabi_f", "__aeabi_d", "__aeabi_i2f", "__aeabi_ui2f", "__aeabi_l2f", "__aeabi_ul2f"]
                .iter()
                .any(|routine| name.starts_with(routine))
                || name.ends_with("sf3")
                || name.ends_with("df3")
        };
        match self.symbols.iter().find(float) {
            None => Ok(()),
            Some(name) => Err(ChoreError::Differs {
                what: "routines of the smallest image".into(),
                found: name.clone(),
                expected: "no floating point".into(),
            }),
        }
    }
}
