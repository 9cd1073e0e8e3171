//! Memory map of the controller, read from the symbols of its image.

use super::CampaignError;
use object::{Object, ObjectSection, ObjectSymbol};
use std::ops::Range;
use std::path::Path;

/// Symbol of the session, which the firmware exports.
const SESSION: &str = "PINTLE_SESSION";

/// Function that frames every message but estimates.
const ANSWERING: &str = "link::encode::encode";

/// Static memory that the controller does not use in lockstep: the emulator's replacement of flash,
/// the buffers of the serial port and of the log, the stack of the fault handler.
const UNUSED_STATE: [&str; 8] = [
    "firmware::boards::model_memory::RAM_SLOTS",
    "firmware::boards::model_memory::RAM_PLACES",
    "firmware::boards::memory::EMERGENCY",
    "firmware::boards::rtt::LOG_BUFFER",
    "firmware::boards::rtt::DOWN_BUFFER",
    "firmware::boards::rtt::UP_BUFFER",
    "PINTLE_RECEIVED_BYTES",
    "_SEGGER_RTT",
];

/// Addresses in an image.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Function that frames every message but estimates.
    pub answering: u32,
    /// Networks of the bearing in use.
    pub weights: Range<u32>,
    /// Code and constants without the networks.
    pub code: Vec<Range<u32>>,
    /// Session: configuration, estimator, monitor, counters.
    pub session: Range<u32>,
    /// Other static memory that the controller uses.
    pub other_state: Vec<Range<u32>>,
    /// First address above the stack.
    pub stack_top: u32,
}

impl Image {
    /// Reads an image's symbols.
    pub fn read(elf: &Path) -> Result<Self, CampaignError> {
        let missing = |what: &'static str| CampaignError::Image { path: elf.into(), expected: what };
        let bytes =
            std::fs::read(elf).map_err(|_| missing("the image that `cargo xtask firmware` builds"))?;
        let file = object::File::parse(&*bytes).map_err(|_| missing("an ELF image"))?;
        let symbols: Vec<(String, Range<u32>)> = file
            .symbols()
            .filter_map(|symbol| {
                let begin =
                    symbol.address() as u32 & if symbol.kind() == object::SymbolKind::Text { !1 } else { !0 };
                // The alternate form is the path without the compiler's hash.
                let name = format!("{:#}", rustc_demangle::demangle(symbol.name().ok()?));
                Some((name, begin..begin.saturating_add(symbol.size() as u32)))
            })
            .collect();
        let find =
            |wanted: &str| symbols.iter().find(|(name, _)| name == wanted).map(|(_, range)| range.clone());
        let section = |name: &str| {
            file.section_by_name(name).map(|s| s.address() as u32..(s.address() + s.size()) as u32)
        };
        let table = model_images(&file).ok_or_else(|| missing("the table of model images"))?;
        let weights = table.first().ok_or_else(|| missing("the image of a material"))?;
        let text = section(".text").ok_or_else(|| missing("a section of code"))?;
        let constants = section(".rodata").ok_or_else(|| missing("a section of constants"))?;
        let code = std::iter::once(text).chain(without(constants, &table)).collect();
        let session = find(SESSION).ok_or_else(|| missing("the session"))?;
        let ram = [".data", ".bss", ".uninit"].into_iter().filter_map(section).collect::<Vec<_>>();
        // A renamed one would silently be struck.
        let is_known = |name: &&str| find(name).is_some();
        if !UNUSED_STATE.iter().all(is_known) {
            return Err(missing("the static memory that lockstep does not use"));
        }
        let other_state = symbols
            .iter()
            .filter(|(name, range)| {
                !range.is_empty()
                    && *range != session
                    && ram.iter().any(|ram| ram.contains(&range.start))
                    && !UNUSED_STATE.contains(&name.as_str())
            })
            .map(|(_, range)| range.clone())
            .collect();
        let answering = find(ANSWERING).ok_or_else(|| missing("the function that frames answers"))?.start;
        let stack_top = find("_stack_start").ok_or_else(|| missing("a stack"))?.start;
        Ok(Self { answering, weights: weights.clone(), code, session, other_state, stack_top })
    }
}

/// Addresses of the built-in model images, from the table that the firmware keeps for this purpose.
fn model_images(file: &object::File<'_>) -> Option<Vec<Range<u32>>> {
    let symbol = file.symbols().find(|symbol| symbol.name() == Ok("PINTLE_MODEL_IMAGES"))?;
    let section = file.section_by_index(symbol.section_index()?).ok()?;
    let (rows, _) = section.data_range(symbol.address(), symbol.size()).ok()??.as_chunks::<8>();
    let range = |&[a, b, c, d, e, f, g, h]: &[u8; 8]| {
        let start = u32::from_le_bytes([a, b, c, d]);
        start..start.saturating_add(u32::from_le_bytes([e, f, g, h]))
    };
    Some(rows.iter().map(range).collect())
}

/// Returns the parts of a range outside of others, which lie within it.
fn without(range: Range<u32>, others: &[Range<u32>]) -> Vec<Range<u32>> {
    let mut others: Vec<&Range<u32>> = others.iter().collect();
    others.sort_by_key(|other| other.start);
    let starts = std::iter::once(range.start).chain(others.iter().map(|other| other.end));
    let ends = others.iter().map(|other| other.start).chain([range.end]);
    starts.zip(ends).map(|(start, end)| start..end).filter(|part| !part.is_empty()).collect()
}

/// Returns the address of a byte, counted through several ranges.
pub fn pick(ranges: &[Range<u32>], place: u32) -> Option<u32> {
    let mut left = place;
    for range in ranges {
        if left < range.len() as u32 {
            return Some(range.start + left);
        }
        left -= range.len() as u32;
    }
    None
}

/// Returns the total length of several ranges.
pub fn length(ranges: &[Range<u32>]) -> u32 {
    ranges.iter().map(|range| range.len() as u32).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_images_of_any_number_of_materials_are_cut_out_of_the_constants() {
        assert_eq!(without(10..20, &[]), [10..20]);
        assert_eq!(without(10..20, &[15..17, 10..12, 12..13]), [13..15, 17..20]);
        assert_eq!(without(10..20, &[18..20]), [10..18]);
    }

    #[test]
    fn a_place_is_counted_through_all_ranges() {
        let ranges = [10..12, 20..23];
        assert_eq!(length(&ranges), 5);
        let places: Vec<_> = (0..6).map(|place| pick(&ranges, place)).collect();
        assert_eq!(places, [Some(10), Some(11), Some(20), Some(21), Some(22), None]);
    }
}
