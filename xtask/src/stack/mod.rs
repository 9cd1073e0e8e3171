//! Stack of the image: a static bound, and the depth that a run in the emulator reached.
//!
//! The bound is the deepest chain of calls from the reset handler, plus for every other handler of
//! the vector table the core's frame and that handler's deepest chain. This assumes that each of
//! them interrupts the one before at its deepest point, whatever their priorities. Recursion and
//! calls through registers have no bound here and are refused; the image has neither. The fault
//! handler has a separate stack and is checked against that; the frame that the core pushes for it
//! is counted. The depth is what the controller's hello frame reports after a run of the estimator
//! in the emulator.

mod image;
mod paint;
pub(crate) mod thumb;

use crate::firmware::{DEFAULT, Firmware};
use crate::run::ChoreError;
use image::Functions;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Bytes that the core pushes for an exception, with FPU registers and alignment.
const EXCEPTION_FRAME: u32 = 26 * 4 + 4;
/// Indexes of the reset and hard fault handlers in the vector table.
const RESET: usize = 1;
const HARD_FAULT: usize = 3;
/// Largest stack, bytes: half of 128 KB.
const MAX_STACK: u32 = 64 * 1024;

/// The figures.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Stack {
    /// Upper bound of the stack, bytes.
    pub(crate) stack_bound_bytes: u32,
    /// Stack used in the emulator, bytes; `None` for a board that it does not model.
    pub(crate) stack_painted_bytes: Option<u32>,
    /// Bytes reserved for the stack.
    pub(crate) stack_reserved_bytes: u32,
    /// Upper bound of the fault handler's stack, bytes.
    pub(crate) emergency_bound_bytes: u32,
    /// Bytes reserved for the fault handler's stack.
    pub(crate) emergency_bytes: u32,
    /// Deepest chain of each handler: its bytes, then the functions.
    #[serde(skip)]
    chains: Vec<Chain>,
}

/// A deepest chain of calls.
#[derive(Clone, Debug, Default)]
struct Chain {
    bytes: u32,
    functions: Vec<(String, u32)>,
}

/// Builds and analyses a board's image, runs that of the default board, and refuses figures beyond
/// their limits. Returns the analysed image with the figures.
pub(crate) fn measure(board: Firmware) -> Result<(PathBuf, Stack), ChoreError> {
    let (image, stack) = figures(board)?;
    stack.check()?;
    Ok((image, stack))
}

fn figures(board: Firmware) -> Result<(PathBuf, Stack), ChoreError> {
    let path = board.build_with_stack_sizes()?;
    let functions = Functions::read(&path)?;
    let wrong = |found: String| ChoreError::File {
        file: path.clone(),
        found,
        expected: "an image whose stack has a bound",
    };
    let mut stack = bound(&functions).map_err(wrong)?;
    if board == DEFAULT {
        stack.stack_painted_bytes = Some(paint::run(&board.build()?)?);
    }
    Ok((path, stack))
}

impl Stack {
    fn check(&self) -> Result<(), ChoreError> {
        let limits = [
            (
                "the bound of the stack, bytes",
                self.stack_bound_bytes,
                self.stack_reserved_bytes.min(MAX_STACK),
            ),
            (
                "the bound of the fault handler's stack, bytes",
                self.emergency_bound_bytes,
                self.emergency_bytes,
            ),
        ];
        let painted = self.stack_painted_bytes;
        let used =
            painted.map(|bytes| ("the stack used in the emulator, bytes", bytes, self.stack_bound_bytes));
        for (what, found, most) in limits.into_iter().chain(used) {
            if found == 0 || found > most {
                return Err(ChoreError::Differs {
                    what: what.into(),
                    found: found.to_string(),
                    expected: format!("at most {most}, and not 0"),
                });
            }
        }
        Ok(())
    }
}

/// Returns the stack used in the emulator as the end of a sentence.
pub(crate) fn seen(painted_bytes: Option<u32>) -> String {
    painted_bytes.map_or_else(String::new, |bytes| format!(", {bytes} seen in the emulator"))
}

/// Prints the figures.
pub(crate) fn stack(board: Firmware, json: bool) -> Result<(), ChoreError> {
    let (_, stack) = figures(board)?;
    if json {
        println!("{}", serde_json::json!(stack));
        return stack.check();
    }
    for chain in &stack.chains {
        println!("{:>6} bytes", chain.bytes);
        for (name, frame) in &chain.functions {
            println!("  {frame:>6} {name}");
        }
    }
    println!(
        "bound {} bytes of {} reserved{}; fault handler {} bytes of its separate stack",
        stack.stack_bound_bytes,
        stack.stack_reserved_bytes,
        seen(stack.stack_painted_bytes),
        stack.emergency_bound_bytes
    );
    stack.check()
}

fn bound(functions: &Functions) -> Result<Stack, String> {
    let mut depths = Depths { functions, known: BTreeMap::new() };
    let vector = |index: usize| functions.vectors.get(index).map_or(0, |address| address & !1);
    let (reset, hard_fault) = (vector(RESET), vector(HARD_FAULT));
    let emergency_bound_bytes = depths.chain(hard_fault, &mut Vec::new())?.bytes;
    let is_default = |address: u32| {
        functions.by_address.get(&address).is_some_and(|function| function.name.starts_with("DefaultHandler"))
    };
    let mut handlers: Vec<u32> =
        functions.vectors.iter().skip(RESET + 1).map(|address| address & !1).collect();
    handlers.sort_unstable();
    handlers.dedup();
    // The default handler never returns: nothing is interrupted after it, and the watchdog ends it.
    handlers.retain(|&address| address != 0 && address != hard_fault && !is_default(address));
    let mut chains = vec![depths.chain(reset, &mut Vec::new())?];
    for handler in handlers {
        chains.push(depths.chain(handler, &mut Vec::new())?);
    }
    // A frame for every interrupt, and one for a fault in the innermost.
    let frames = EXCEPTION_FRAME * chains.len() as u32;
    Ok(Stack {
        stack_bound_bytes: chains.iter().map(|chain| chain.bytes).sum::<u32>() + frames,
        stack_painted_bytes: None,
        stack_reserved_bytes: functions.reserved,
        emergency_bound_bytes,
        emergency_bytes: functions.emergency,
        chains,
    })
}

/// Deepest chains found so far.
struct Depths<'a> {
    functions: &'a Functions,
    known: BTreeMap<u32, Chain>,
}

impl Depths<'_> {
    fn chain(&mut self, address: u32, callers: &mut Vec<u32>) -> Result<Chain, String> {
        if let Some(chain) = self.known.get(&address) {
            return Ok(chain.clone());
        }
        let function =
            self.functions.by_address.get(&address).ok_or_else(|| format!("no function at {address:#x}"))?;
        if callers.contains(&address) {
            return Err(format!("{} calls itself, by way of others perhaps", function.name));
        }
        callers.push(address);
        let mut deepest = Chain::default();
        for &callee in &function.callees {
            let chain = self.chain(callee, callers)?;
            if chain.bytes >= deepest.bytes {
                deepest = chain;
            }
        }
        callers.pop();
        deepest.bytes += function.frame;
        deepest.functions.insert(0, (function.name.clone(), function.frame));
        self.known.insert(address, deepest.clone());
        Ok(deepest)
    }
}

#[cfg(test)]
mod tests {
    use super::image::Function;
    use super::*;

    fn functions(list: &[(u32, &str, u32, &[u32])]) -> Functions {
        let by_address = list
            .iter()
            .map(|&(address, name, frame, callees)| {
                (address, Function { name: name.into(), frame, callees: callees.iter().copied().collect() })
            })
            .collect();
        // Stack pointer, reset, NMI, hard fault, two handlers of their own, one that is used twice.
        let vectors = vec![0x2000_8000, 0x101, 0x901, 0x301, 0x401, 0x501, 0x501, 0];
        Functions { by_address, vectors, reserved: 1000, emergency: 100 }
    }

    const LEAVES: [(u32, &str, u32, &[u32]); 5] = [
        (0x300, "HardFault", 0, &[0x200]),
        (0x400, "SysTick", 40, &[0x200, 0x600]),
        (0x500, "USART6", 12, &[]),
        (0x600, "deep", 90, &[]),
        (0x900, "DefaultHandler_", 7000, &[]),
    ];

    #[test]
    fn every_handler_adds_to_the_deepest_chain() {
        let mut list = LEAVES.to_vec();
        list.extend([(0x100, "Reset", 8, &[0x200, 0x600][..]), (0x200, "record", 16, &[][..])]);
        let stack = bound(&functions(&list)).unwrap();
        assert_eq!(stack.stack_bound_bytes, (8 + 90) + (108 + 40 + 90) + (108 + 12) + 108);
        assert_eq!(stack.emergency_bound_bytes, 16);
    }

    #[test]
    fn recursion_is_refused() {
        let mut list = LEAVES.to_vec();
        list.extend([(0x100, "Reset", 8, &[0x200][..]), (0x200, "record", 16, &[0x600, 0x100][..])]);
        let error = bound(&functions(&list)).unwrap_err();
        assert!(error.contains("calls itself"), "{error}");
    }
}
