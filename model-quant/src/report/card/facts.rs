//! Content of a model card.

use crate::evaluate::bench_loop::BenchLoop;
use crate::evaluate::layers::LayerError;
use crate::evaluate::limits::Limits;
use crate::evaluate::verdict::Verdict;
use crate::network::checkpoint::Checkpoint;
use crate::quantise::mode::Plan;
use inference::Header;

/// Content of a card.
#[derive(Clone, Copy, Debug)]
pub struct Facts<'a> {
    /// Checkpoint that the image was made from.
    pub checkpoint: &'a Checkpoint,
    /// Options of the quantisation.
    pub plan: Plan,
    /// Header of the image.
    pub header: &'a Header,
    /// Bytes of the image.
    pub image: &'a [u8],
    /// Results of the verification.
    pub verdicts: &'a [Verdict],
    /// Error of each quantisation step.
    pub layers: &'a [LayerError],
    /// Errors beyond the training range.
    pub limits: &'a Limits,
    /// Accuracy in the bench's loop, if it was measured with this image.
    pub bench_loop: Option<&'a BenchLoop>,
}
