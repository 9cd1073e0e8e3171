//! Where in the controller's memory things are, from the image's symbols.

use super::CampaignError;
use object::{Object, ObjectSection, ObjectSymbol};
use std::ops::Range;
use std::path::Path;

/// Parts of the static memory that are no state of the controller in lockstep: what stands in for flash in the emulator, the serial port's and the
/// log's buffers, the stack of the fault handler.
const NO_STATE: [&str; 8] = [
    "RAM_SLOTS",
    "RAM_PLACES",
    "EMERGENCY",
    "BUFFER",
    "byte_queue",
    "shared_resource_samples",
    "shared_resource_estimates",
    "SEGGER_RTT",
];

/// Places in an image.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// Frames every answer but estimates.
    pub answering: u32,
    /// The networks of the bearing in use.
    pub weights: Range<u32>,
    /// Code and constants, without networks.
    pub code: Vec<Range<u32>>,
    /// The session: configuration, estimator, monitor, tracker, counters.
    pub session: Range<u32>,
    /// Other static memory that is read.
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
                Some((symbol.name().ok()?.to_owned(), begin..begin.saturating_add(symbol.size() as u32)))
            })
            .collect();
        // Of a name that is both a reference's and that of what it refers to, the latter.
        let find = |part: &str| {
            let named = symbols.iter().filter(|(name, _)| name.contains(part));
            named.max_by_key(|(_, range)| range.len()).map(|(_, range)| range.clone())
        };
        let section = |name: &str| {
            file.section_by_name(name).map(|s| s.address() as u32..(s.address() + s.size()) as u32)
        };
        let weights = find("9inference7bearing7BABBITT").ok_or_else(|| missing("the networks"))?;
        let others = find("9inference7bearing7PLASTIC").ok_or_else(|| missing("the other networks"))?;
        let text = section(".text").ok_or_else(|| missing("a section of code"))?;
        let constants = section(".rodata").ok_or_else(|| missing("a section of constants"))?;
        let (first, second) =
            if weights.start < others.start { (&weights, &others) } else { (&others, &weights) };
        let code =
            vec![text, constants.start..first.start, first.end..second.start, second.end..constants.end];
        let session = find("shared_resource_session").ok_or_else(|| missing("the session"))?;
        let ram = [".data", ".bss", ".uninit"].into_iter().filter_map(section).collect::<Vec<_>>();
        let other_state = symbols
            .iter()
            .filter(|(name, range)| {
                !range.is_empty()
                    && *range != session
                    && ram.iter().any(|ram| ram.contains(&range.start))
                    && !NO_STATE.iter().any(|part| name.contains(part))
            })
            .map(|(_, range)| range.clone())
            .collect();
        let answering =
            find("4link6encode6encode17h").ok_or_else(|| missing("the framing of answers"))?.start;
        let stack_top = find("_stack_start").ok_or_else(|| missing("a stack"))?.start;
        Ok(Self {
            answering,
            weights,
            code: code.into_iter().filter(|r| !r.is_empty()).collect(),
            session,
            other_state,
            stack_top,
        })
    }
}

/// The byte at a place in several ranges put together.
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

/// Bytes of several ranges.
pub fn length(ranges: &[Range<u32>]) -> u32 {
    ranges.iter().map(|range| range.len() as u32).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_counted_through_all_ranges() {
        let ranges = [10..12, 20..23];
        assert_eq!(length(&ranges), 5);
        let places: Vec<_> = (0..6).map(|place| pick(&ranges, place)).collect();
        assert_eq!(places, [Some(10), Some(11), Some(20), Some(21), Some(22), None]);
    }
}
