//! Circular buffers between the link's loop and a DMA controller ([`dma_ring`]) or a debug probe
//! ([`rtt_channel`]).
//!
//! Both hold indices only, no addresses and no registers, so that they are tested on the host.

pub mod dma_ring;
pub mod rtt_channel;
