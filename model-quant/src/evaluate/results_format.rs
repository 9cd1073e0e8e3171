//! Constants of a file of results, see `peers/README.md`. `xtask` includes this file as source.

use inference::BearingMaterial;

/// Materials whose networks are compared, in the order of the files. A material is added here
/// after the other runtimes have been measured with it.
pub(crate) const MATERIALS: [BearingMaterial; 2] = [BearingMaterial::Babbitt, BearingMaterial::Plastic];
// The programs on the emulated cores take the first ones of all materials.
const _: () = assert!(MATERIALS[0].code() == 0 && MATERIALS[1].code() == 1);

/// First bytes.
pub(crate) const MAGIC: [u8; 8] = *b"PINTLER\n";
/// Version of the format.
pub(crate) const VERSION: u32 = 1;
/// Length of the runtime's name, bytes.
pub(crate) const NAME_LENGTH: usize = 48;
