//! Principle of marginality: a refinement of an effect is selected after its main effect.

use super::contender::Contender;
use bench::simulate::RespondError;

/// Moves the main effect of the best contender to the front if it is a cause by itself, as
/// `is_cause` decides.
///
/// It stays in its place if a declared number lies on a bound of calibration with the main effect,
/// and not with the refinement: then the refinement alone explains the deviation. If the refinement
/// is the only cause, the next stage finds it, and the main effect is dropped as unnecessary.
pub(super) fn move_main_effect_first(
    contenders: &mut [Contender],
    is_cause: impl Fn(&Contender) -> Result<bool, RespondError>,
) -> Result<(), RespondError> {
    let main = contenders.first().and_then(|c| c.candidate.kind.refines);
    let index = contenders.iter().position(|c| Some(c.candidate.kind.name) == main);
    if let Some(better) = index.and_then(|i| contenders.get_mut(..=i))
        && let [refinement, .., main] = &*better
        && !main.fit.at_bound().iter().zip(refinement.fit.at_bound()).any(|(main, own)| *main && !own)
        && is_cause(main)?
    {
        better.rotate_right(1);
    }
    Ok(())
}
