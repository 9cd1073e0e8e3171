//! Constants of a file of results, see `peers/README.md`. `xtask` includes this file as source.

/// First bytes.
pub(crate) const MAGIC: [u8; 8] = *b"PINTLER\n";
/// Version of the format.
pub(crate) const VERSION: u32 = 1;
/// Length of the runtime's name, bytes.
pub(crate) const NAME_LENGTH: usize = 48;
