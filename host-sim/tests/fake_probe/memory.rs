//! A probe in software: the probe library's real session and its real RTT, over any [`Memory`]. The
//! memory of the library's own fake cannot be written.
//!
//! Its core can only be halted and resumed; its registers read 0.

use probe_rs::architecture::arm::ap::CSW;
use probe_rs::architecture::arm::dp::{DpAddress, DpRegisterAddress};
use probe_rs::architecture::arm::memory::ArmMemoryInterface;
use probe_rs::architecture::arm::sequences::ArmDebugSequence;
use probe_rs::architecture::arm::{
    ArmDebugInterface, ArmError, DapAccess, DapProbe, FullyQualifiedApAddress, SwdSequence, SwoAccess,
    SwoConfig,
};
use probe_rs::probe::{DebugProbe, DebugProbeError, Probe, WireProtocol};
use probe_rs::{Error, MemoryInterface};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

/// Debug halting control and status.
const DHCSR: u64 = 0xE000_EDF0;
const ENABLED: u32 = 1;
const HALT: u32 = 1 << 1;
const STEP: u32 = 1 << 2;
const IS_HALTED: u32 = 1 << 17;
const REGISTER_READY: u32 = 1 << 16;
/// Start address of the registers of the core.
const SYSTEM: u64 = 0xE000_0000;

/// Memory that the probe accesses. Both functions return false once the memory is out of reach.
pub(crate) trait Memory: Send {
    fn read(&mut self, address: u32, bytes: &mut [u8]) -> bool;
    fn write(&mut self, address: u32, bytes: &[u8]) -> bool;
}

/// Returns a probe at a memory, with a running or halted core.
pub(crate) fn probe_at(memory: impl Memory + 'static, runs: bool) -> Probe {
    let control = if runs { 0 } else { HALT | ENABLED };
    Probe::from_specific_probe(Box::new(Software { memory: Box::new(memory), control }))
}

struct Software {
    memory: Box<dyn Memory>,
    /// Last value written to the core's control register.
    control: u32,
}

impl std::fmt::Debug for Software {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a probe made of software")
    }
}

impl DebugProbe for Software {
    fn get_name(&self) -> &str {
        "software"
    }
    fn speed_khz(&self) -> u32 {
        1000
    }
    fn set_speed(&mut self, speed_khz: u32) -> Result<u32, DebugProbeError> {
        Ok(speed_khz)
    }
    fn attach(&mut self) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn detach(&mut self) -> Result<(), Error> {
        Ok(())
    }
    fn target_reset(&mut self) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn target_reset_assert(&mut self) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn target_reset_deassert(&mut self) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn select_protocol(&mut self, _protocol: WireProtocol) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn active_protocol(&self) -> Option<WireProtocol> {
        Some(WireProtocol::Swd)
    }
    fn has_arm_interface(&self) -> bool {
        true
    }
    fn try_get_arm_debug_interface<'probe>(
        self: Box<Self>,
        _sequence: Arc<dyn ArmDebugSequence>,
    ) -> Result<Box<dyn ArmDebugInterface + 'probe>, (Box<dyn DebugProbe>, ArmError)> {
        Ok(Box::new(Port(self)))
    }
    fn into_probe(self: Box<Self>) -> Box<dyn DebugProbe> {
        self
    }
}

/// The debug port.
struct Port(Box<Software>);

fn unused<T>() -> Result<T, ArmError> {
    Err(ArmError::Other("not there".into()))
}

impl ArmDebugInterface for Port {
    fn reinitialize(&mut self) -> Result<(), ArmError> {
        Ok(())
    }
    fn access_ports(&mut self, dp: DpAddress) -> Result<BTreeSet<FullyQualifiedApAddress>, ArmError> {
        Ok(BTreeSet::from([FullyQualifiedApAddress::v1_with_dp(dp, 0)]))
    }
    fn close(self: Box<Self>) -> Probe {
        Probe::from_specific_probe(self.0)
    }
    fn select_debug_port(&mut self, _dp: DpAddress) -> Result<(), ArmError> {
        Ok(())
    }
    fn current_debug_port(&self) -> Option<DpAddress> {
        Some(DpAddress::Default)
    }
    fn memory_interface(
        &mut self,
        _access_port: &FullyQualifiedApAddress,
    ) -> Result<Box<dyn ArmMemoryInterface + '_>, ArmError> {
        Ok(Box::new(Access(&mut self.0)))
    }
}

impl SwdSequence for Port {
    fn swj_sequence(&mut self, _bit_len: u8, _bits: u64) -> Result<(), DebugProbeError> {
        Ok(())
    }
    fn swj_pins(&mut self, _out: u32, _select: u32, _wait: u32) -> Result<u32, DebugProbeError> {
        Ok(0)
    }
}

impl SwoAccess for Port {
    fn enable_swo(&mut self, _config: &SwoConfig) -> Result<(), ArmError> {
        unused()
    }
    fn disable_swo(&mut self) -> Result<(), ArmError> {
        unused()
    }
    fn read_swo_timeout(&mut self, _timeout: Duration) -> Result<Vec<u8>, ArmError> {
        unused()
    }
}

impl DapAccess for Port {
    fn read_raw_dp_register(&mut self, _dp: DpAddress, _addr: DpRegisterAddress) -> Result<u32, ArmError> {
        unused()
    }
    fn write_raw_dp_register(
        &mut self,
        _dp: DpAddress,
        _addr: DpRegisterAddress,
        _value: u32,
    ) -> Result<(), ArmError> {
        unused()
    }
    fn read_raw_ap_register(&mut self, _ap: &FullyQualifiedApAddress, _addr: u64) -> Result<u32, ArmError> {
        unused()
    }
    fn write_raw_ap_register(
        &mut self,
        _ap: &FullyQualifiedApAddress,
        _addr: u64,
        _value: u32,
    ) -> Result<(), ArmError> {
        unused()
    }
    fn try_dap_probe(&self) -> Option<&dyn DapProbe> {
        None
    }
    fn try_dap_probe_mut(&mut self) -> Option<&mut dyn DapProbe> {
        None
    }
}

/// The memory's access port.
struct Access<'a>(&'a mut Software);

impl Access<'_> {
    fn get(&mut self, address: u64, bytes: &mut [u8]) -> Result<(), ArmError> {
        if address < SYSTEM {
            return reached(self.0.memory.read(address as u32, bytes));
        }
        // An unreachable memory shows here, too.
        reached(self.0.memory.read(0x2000_0000, &mut [0; 4]))?;
        bytes.fill(0);
        if let (DHCSR, Some(word)) = (address, bytes.first_chunk_mut()) {
            // A step completes at once.
            let halted = if self.0.control & (HALT | STEP) != 0 { IS_HALTED } else { 0 };
            *word = (REGISTER_READY | halted | self.0.control).to_le_bytes();
        }
        Ok(())
    }

    fn put(&mut self, address: u64, bytes: &[u8]) -> Result<(), ArmError> {
        if address < SYSTEM {
            return reached(self.0.memory.write(address as u32, bytes));
        }
        if let (DHCSR, Some(word)) = (address, bytes.first_chunk()) {
            self.0.control = u32::from_le_bytes(*word) & 0xFFFF;
        }
        Ok(())
    }
}

fn reached(reached: bool) -> Result<(), ArmError> {
    if reached { Ok(()) } else { Err(ArmError::Other("the software went".into())) }
}

macro_rules! access {
    ($read:ident, $write:ident, $word:ty) => {
        fn $read(&mut self, address: u64, data: &mut [$word]) -> Result<(), ArmError> {
            let mut bytes = vec![0; size_of_val(data)];
            self.get(address, &mut bytes)?;
            for (word, bytes) in data.iter_mut().zip(bytes.as_chunks().0) {
                *word = <$word>::from_le_bytes(*bytes);
            }
            Ok(())
        }
        fn $write(&mut self, address: u64, data: &[$word]) -> Result<(), ArmError> {
            let bytes: Vec<u8> = data.iter().flat_map(|word| word.to_le_bytes()).collect();
            self.put(address, &bytes)
        }
    };
}

impl MemoryInterface<ArmError> for Access<'_> {
    access!(read_8, write_8, u8);
    access!(read_16, write_16, u16);
    access!(read_32, write_32, u32);
    access!(read_64, write_64, u64);
    fn supports_native_64bit_access(&mut self) -> bool {
        false
    }
    fn supports_8bit_transfers(&self) -> Result<bool, ArmError> {
        Ok(true)
    }
    fn flush(&mut self) -> Result<(), ArmError> {
        Ok(())
    }
}

impl ArmMemoryInterface for Access<'_> {
    fn fully_qualified_address(&self) -> FullyQualifiedApAddress {
        FullyQualifiedApAddress::v1_with_default_dp(0)
    }
    fn base_address(&mut self) -> Result<u64, ArmError> {
        unused()
    }
    fn get_arm_debug_interface(&mut self) -> Result<&mut dyn ArmDebugInterface, DebugProbeError> {
        Err(DebugProbeError::Other("not there".into()))
    }
    fn generic_status(&mut self) -> Result<CSW, ArmError> {
        CSW::try_from(0).or_else(|_| unused())
    }
}
