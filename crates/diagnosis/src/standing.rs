//! Which causes stand, and what speaks against those that do not.
//!
//! * Where nothing is left over they have to explain everything: with the upper end of the share's interval below [`WHOLE_SHARE`] something was overlooked.
//!   Nor may a cause's size differ from place to place ([`crate::shape`]): it would be an imitation.
//! * Where something is left over they have to explain at least [`MAIN_SHARE`] of the repeatable residual on held-out samples (the second one: of what the
//!   first leaves), with the interval above 0 and up to [`LARGE_SHARE`]: a real bench always has structure beyond any library, and a cause that explains
//!   little is more often an imitation than a part. Beside such structure the size of a true cause seems to differ from place to place, but not while the
//!   speed rises from while it falls: what differs there lacks a memory.
//! * In any case: causes beside which a declared number of the bench is at the end of what calibration may move are not enough; an effect whose shape may be at the end
//!   of its range is another one in disguise. Where it is only the last cause with which that is so, the one before is judged alone.

use crate::gain::gains;
use crate::parameter::Parameter;
use crate::result::{Member, Refused};
use crate::select::{Doubt, Stage};
use crate::session::Data;
use crate::spread::NINETY_FIVE;
use crate::verdict::End;

/// Share of the repeatable held-out residual that causes have to explain where structure is left.
pub(crate) const MAIN_SHARE: f64 = 0.75;
/// Share that the upper end of its interval has to reach where structure is left.
const LARGE_SHARE: f64 = 0.9;
/// The same where nothing is left. True causes that stay below are slow ones that the turns named; of the wrong names in the place of a deleted cause many do.
const WHOLE_SHARE: f64 = 0.95;

/// What speaks against the causes of an end.
#[derive(Clone, Copy)]
enum Objection {
    Declared,
    Disguised,
    Memory,
    Misfit,
    Little,
}

impl Objection {
    fn name(self) -> &'static str {
        match self {
            Self::Declared => "declared-number-at-bound",
            Self::Disguised => "shape-at-bound",
            Self::Memory => "no-memory",
            Self::Misfit => "size-differs",
            Self::Little => "explains-too-little",
        }
    }

    /// The same as a clause, of the end that it speaks against.
    fn words(self, end: &End) -> String {
        match self {
            Self::Declared => {
                format!(
                    "{} would still be as far off as the description allows",
                    listed(stopped_of_bench(end))
                )
            }
            Self::Disguised => {
                format!(
                    "{} may be at the end of its range, where the effect is another one in disguise",
                    listed(flat(end))
                )
            }
            Self::Memory => "the size would differ while the speed rises and while it falls".into(),
            Self::Misfit => {
                "the size would differ with direction, load, speed, position, time or phase".into()
            }
            Self::Little => "too little of what was not fitted is explained".into(),
        }
    }
}

/// The number of stages that stand, and the causes that were accepted and do not.
pub(crate) fn standing(data: &Data, ends: &[End]) -> (usize, Option<Refused>) {
    let last = ends.len().saturating_sub(1);
    let of_last = ends.get(last).and_then(objection);
    let (stand, against) = match (1..=last).rev().find(|&k| objection(&ends[k]).is_none()) {
        None => (0, of_last),
        Some(2) if is_needless(data, ends) => (1, Some(Objection::Little)),
        Some(most) => match shortfall(data, &ends[0], &ends[most]) {
            None => (most, of_last),
            short => (0, of_last.or(short)),
        },
    };
    let members = |end: &End| -> Vec<Member> { end.causes.iter().map(|(c, _)| Member::from(c)).collect() };
    let refused = against.map(|objection| {
        let stands = members(&ends[stand]);
        let causes = members(&ends[last]).into_iter().filter(|c| !stands.contains(c)).collect();
        Refused { causes, reason: objection.name().into(), words: objection.words(&ends[last]) }
    });
    (stand, refused)
}

/// The best candidate of a first stage that accepts none, where its evidence is clear, and what speaks against it.
pub(crate) fn nearest(first: &Stage) -> Option<Refused> {
    let (candidate, doubt) = first.doubt()?;
    let (reason, words) = match doubt {
        Doubt::Size => {
            ("size-uncertain", "its size cannot be told from 0 beside the numbers that are uncertain")
        }
        Doubt::HeldOut => {
            ("held-out-uncertain", "the error of what was not fitted does not fall for certain")
        }
    };
    Some(Refused { causes: vec![Member::from(candidate)], reason: reason.into(), words: words.into() })
}

/// Whether beside structure that is left the first of two causes stands alone, and the second explains little of what it leaves.
fn is_needless(data: &Data, ends: &[End]) -> bool {
    let [described, first, second] = ends else { return false };
    second.left.is_some()
        && objection(first).is_none()
        && shortfall(data, described, first).is_none()
        && !explains_most(data, first, second)
}

/// What speaks against an end in any case.
fn objection(end: &End) -> Option<Objection> {
    if end.causes.is_empty() {
        None
    } else if stopped_of_bench(end).next().is_some() {
        Some(Objection::Declared)
    } else {
        flat(end).next().map(|_| Objection::Disguised)
    }
}

/// What an end lacks: what leaves nothing has to be all of it, and what leaves something the most of it.
fn shortfall(data: &Data, described: &End, end: &End) -> Option<Objection> {
    let (misfit, explains) = match end.left {
        None => (end.misfit.any.then_some(Objection::Misfit), explains_all(data, described, end)),
        Some(_) => (end.misfit.memory.then_some(Objection::Memory), explains_most(data, described, end)),
    };
    misfit.or((!explains).then_some(Objection::Little))
}

/// Declared numbers that have gone as far as calibration may move them.
pub(crate) fn stopped(end: &End) -> impl Iterator<Item = &Parameter> {
    let numbers = end.model.parameters.iter().zip(&end.z);
    numbers.filter(|(p, z)| p.is_declared() && p.bound_at(**z).is_some()).map(|(p, _)| p)
}

/// Those of the bench. What one session brings along beyond its declaration says nothing of a cause in all of them.
fn stopped_of_bench(end: &End) -> impl Iterator<Item = &str> {
    stopped(end).filter(|p| p.is_nominal()).map(Parameter::name)
}

/// Shapes of any order of magnitude that may be at the end of their range, within their 95 % interval: there an effect is another one in disguise, as static
/// friction that is never lost is a level.
fn flat(end: &End) -> impl Iterator<Item = &str> {
    let reaches = |((p, z), deviation): &((&Parameter, &f64), &f64)| {
        let ((least, most), reach) = (p.bounds(), NINETY_FIVE * **deviation);
        p.is_shape() && p.is_factor && (**z - reach <= least || **z + reach >= most)
    };
    end.model.parameters.iter().zip(&end.z).zip(&end.deviations).filter(reaches).map(|((p, _), _)| p.name())
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(" and ")
}

/// Whether `after` explains most of what `before` leaves, on held-out samples and beyond doubt.
fn explains_most(data: &Data, before: &End, after: &End) -> bool {
    let (_, (share, interval)) = gains(data, &after.noise, &before.residual, &after.residual);
    share.is_some_and(|s| s >= MAIN_SHARE)
        && interval.is_some_and(|[low, high]| low > 0.0 && high >= LARGE_SHARE)
}

/// Whether `after` may explain all that `before` leaves on held-out samples. A share that is lost in the noise contradicts nothing.
fn explains_all(data: &Data, before: &End, after: &End) -> bool {
    let (_, (_, interval)) = gains(data, &after.noise, &before.residual, &after.residual);
    interval.is_none_or(|[_, high]| high >= WHOLE_SHARE)
}
