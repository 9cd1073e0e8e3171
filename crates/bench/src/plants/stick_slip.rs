//! Friction laws that stick: which slip a contact has, and the friction of each.
//!
//! A contact slides with a sign or sticks. While it slides, friction is the law's for that sign,
//! also where a trial state of the integrator has the other one. The integrator locates the end of
//! a slip; these rules state it, and the slip that follows.
//!
//! * `coulomb`: sliding ends where the speed passes 0. The contact sticks if the force that would
//!   keep the speed at 0 is at most the static coefficient times the normal force. Otherwise it
//!   slides on, in the direction in which the other forces push. Sticking ends when the needed
//!   force exceeds that limit.
//! * `karnopp` (Karnopp 1985, J. Dyn. Sys. Meas. Control 107): speeds within the band count as 0.
//!   A contact that enters the band under no more than the limit is stopped: the speed becomes 0.
//!   Under more, friction is the static one until the speed has left the band.
//! * `seven-parameter`: sticking is a spring, so no force is sought. It begins where the sliding
//!   speed passes 0, and ends where the spring carries the break-away force of this dwell time.
//!
//! Speeds in m/s, forces in N. Sticking of several contacts at once is not covered: their forces
//! depend on each other.

use crate::description::{FrictionMemory, FrictionSection};
use crate::integrate::Slip;
use crate::plants::contact_laws::{bristle_stiffness, sliding_parameters};
use contact::{
    FrictionKind, Karnopp, LawError, SevenParameter, SevenParameterState, SlidingLaw, SlidingParameters,
};

#[cfg(test)]
mod block_tests;

/// Speed in m/s up to which a contact is at standstill; rounding of a sliding speed is smaller.
const STILL_M_S: f64 = 1e-12;
/// Share by which a force must differ from its limit, where both are equal at the start of a slip.
const ROUNDING: f64 = 1e-9;

/// Friction law that sticks.
#[derive(Clone, Copy, Debug)]
pub(crate) enum StickingLaw {
    /// Coulomb's coefficient while it slides, the static one at standstill.
    Coulomb(SlidingParameters),
    /// Karnopp's law.
    Karnopp(Karnopp),
    /// The seven-parameter law.
    SevenParameter(SevenParameter),
}

/// Balance of a contact at standstill.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    /// Friction that keeps the sliding speed constant, N.
    pub(crate) needed_n: f64,
    /// Largest friction in its direction, N.
    pub(crate) limit_n: f64,
}

impl Balance {
    /// Returns whether friction can hold the contact.
    fn holds(&self) -> bool {
        self.needed_n.abs() <= self.limit_n
    }
}

/// Slip that follows another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Next {
    pub(crate) slip: Slip,
    /// True if the slip begins at standstill: the remaining sliding speed is removed.
    pub(crate) is_stopped: bool,
}

impl StickingLaw {
    /// Builds a law from a section, and from that of its memory if it has one.
    pub(crate) fn from_section(
        kind: FrictionKind,
        section: &FrictionSection,
        memory: Option<&FrictionMemory>,
    ) -> Result<Self, LawError> {
        match (kind, memory) {
            (FrictionKind::Karnopp, _) => karnopp(section).map(Self::Karnopp),
            (FrictionKind::SevenParameter, Some(memory)) => {
                seven_parameter(section, memory).map(Self::SevenParameter)
            }
            _ => match SlidingLaw::new(kind, sliding_parameters(section))? {
                SlidingLaw::Coulomb(parameters) => Ok(Self::Coulomb(parameters)),
                _ => Err(LawError::UnknownName { group: "sticking friction" }),
            },
        }
    }

    /// Band of speeds in m/s that counts as standstill.
    fn band_m_s(&self) -> f64 {
        match self {
            Self::Karnopp(law) => law.band_m_s(),
            Self::Coulomb(_) | Self::SevenParameter(_) => 0.0,
        }
    }

    /// Returns whether friction at standstill follows from the other forces.
    pub(crate) const fn is_rigid(&self) -> bool {
        !matches!(self, Self::SevenParameter(_))
    }

    /// Largest friction of a rigid law at standstill, N.
    pub(crate) fn break_away_n(&self, normal_n: f64) -> f64 {
        match self {
            Self::Coulomb(p) => p.static_coefficient * normal_n,
            Self::Karnopp(law) => law.break_away_n(normal_n),
            Self::SevenParameter(_) => 0.0,
        }
    }

    /// Friction in N along the sliding direction. `memory` is that of [`Self::memory_rate`]. Of a
    /// rigid law at standstill it is 0: friction is then a [`Balance`].
    pub(crate) fn force_n(
        &self,
        slip: Slip,
        time_s: f64,
        normal_n: f64,
        sliding_m_s: f64,
        memory: f64,
    ) -> f64 {
        match (self, slip) {
            (Self::SevenParameter(law), _) => {
                state(slip, time_s, memory).map_or(0.0, |state| law.force_n(normal_n, &state, sliding_m_s))
            }
            (_, Slip::BreakingAway { direction }) => -direction * self.break_away_n(normal_n),
            (Self::Coulomb(p), Slip::Sliding { direction, .. }) => {
                -direction * p.coulomb_coefficient * normal_n
            }
            (Self::Karnopp(law), Slip::Sliding { direction, .. }) => {
                let speed = (direction * sliding_m_s).max(law.band_m_s());
                law.force_n(normal_n, direction * speed, 0.0)
            }
            (_, Slip::Smooth | Slip::Sticking { .. }) => 0.0,
        }
    }

    /// Stretch of the seven-parameter law's spring as a share, -1 to 1, of the stretch at which it
    /// breaks. Effects that depend on the direction of sliding take it while the contact sticks, so
    /// they do not jump at the break-away.
    pub(crate) fn elastic_sign(&self, slip: Slip, time_s: f64, memory: f64) -> f64 {
        let Self::SevenParameter(law) = self else { return 0.0 };
        let limit = state(slip, time_s, memory).map_or(0.0, |state| law.break_away_coefficient(&state));
        (law.stiffness_per_m * memory / limit.max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0)
    }

    /// Friction in N of steady sliding, for a contact whose history is unknown; 0 at standstill.
    pub(crate) fn steady_n(&self, normal_n: f64, sliding_m_s: f64) -> f64 {
        let slip = self.sliding(sliding_m_s);
        if sliding_m_s.abs() <= self.band_m_s() {
            return 0.0;
        }
        self.force_n(slip, 0.0, normal_n, sliding_m_s, sliding_m_s.abs())
    }

    /// Rate of the memory of the seven-parameter law: of the spring's displacement in m while the
    /// contact sticks, and of the lagging speed in m/s while it slides.
    pub(crate) fn memory_rate(&self, slip: Slip, sliding_m_s: f64, memory: f64) -> f64 {
        match (self, slip) {
            (Self::SevenParameter(_), Slip::Sticking { .. }) => sliding_m_s,
            (Self::SevenParameter(law), Slip::Sliding { direction, .. }) => {
                (direction * sliding_m_s - memory) / law.memory_s
            }
            _ => 0.0,
        }
    }

    /// Returns whether a slip has ended. `balance` is evaluated only where a law needs it.
    pub(crate) fn has_ended(
        &self,
        slip: Slip,
        time_s: f64,
        sliding_m_s: f64,
        memory: f64,
        balance: impl FnOnce() -> Balance,
    ) -> bool {
        match (slip, self) {
            (Slip::Smooth, _) => false,
            (Slip::Sliding { direction, .. }, _) => direction * sliding_m_s < self.band_m_s() - STILL_M_S,
            (Slip::BreakingAway { .. }, _) => {
                let Balance { needed_n, limit_n } = balance();
                sliding_m_s.abs() > self.band_m_s() || needed_n.abs() < (1.0 - ROUNDING) * limit_n
            }
            (Slip::Sticking { .. }, Self::SevenParameter(law)) => {
                let limit = state(slip, time_s, memory).map_or(0.0, |s| law.break_away_coefficient(&s));
                law.stiffness_per_m * memory.abs() > (1.0 + ROUNDING) * limit
            }
            (Slip::Sticking { .. }, _) => !balance().holds(),
        }
    }

    /// Chooses the slip after an onset ([`Slip::Smooth`]) or after the end of a slip.
    pub(crate) fn next(
        &self,
        slip: Slip,
        time_s: f64,
        sliding_m_s: f64,
        memory: &mut f64,
        balance: impl FnOnce() -> Balance,
    ) -> Next {
        let band_m_s = self.band_m_s();
        let is_moving = match slip {
            Slip::Smooth => sliding_m_s.abs() > band_m_s.max(STILL_M_S),
            Slip::BreakingAway { .. } => sliding_m_s.abs() > band_m_s,
            Slip::Sliding { .. } | Slip::Sticking { .. } => false,
        };
        if let Self::SevenParameter(law) = self {
            return Next {
                slip: next_elastic(law, (slip, is_moving), time_s, sliding_m_s, memory),
                is_stopped: false,
            };
        }
        if is_moving {
            return Next { slip: self.sliding(sliding_m_s), is_stopped: false };
        }
        let balance = balance();
        // The other forces push against the friction that is needed.
        let direction = -balance.needed_n.signum();
        if balance.holds() {
            Next { slip: Slip::Sticking { since_s: time_s, excess: 0.0 }, is_stopped: true }
        } else if band_m_s > 0.0 {
            Next { slip: Slip::BreakingAway { direction }, is_stopped: false }
        } else {
            Next { slip: Slip::Sliding { direction, excess: 0.0 }, is_stopped: true }
        }
    }

    /// Sliding of a contact whose history is unknown.
    fn sliding(&self, sliding_m_s: f64) -> Slip {
        let excess = match self {
            Self::SevenParameter(law) => law.long_rest_excess,
            Self::Coulomb(_) | Self::Karnopp(_) => 0.0,
        };
        Slip::Sliding { direction: sliding_m_s.signum(), excess }
    }
}

/// Builds Karnopp's law; its band is the width of the regularised sign of other laws. A joint that
/// leaves the band must not be stopped by its viscous part, so this may not exceed the static
/// excess there.
fn karnopp(f: &FrictionSection) -> Result<Karnopp, LawError> {
    let at_the_band = f.coulomb_coefficient + f.viscous_slope_s_m * f.regularisation_m_s;
    if f.static_coefficient < at_the_band {
        return Err(LawError::OutOfRange {
            quantity: "static coefficient",
            found: f.static_coefficient,
            expected: "at least the coefficient of sliding at the edge of the band",
        });
    }
    Karnopp::new(f.coulomb_coefficient, f.static_coefficient, f.viscous_slope_s_m, f.regularisation_m_s)
}

fn seven_parameter(f: &FrictionSection, memory: &FrictionMemory) -> Result<SevenParameter, LawError> {
    let law = SevenParameter {
        stiffness_per_m: bristle_stiffness(f, FrictionKind::SevenParameter)?,
        coulomb_coefficient: f.coulomb_coefficient,
        viscous_slope_s_m: f.viscous_slope_s_m,
        long_rest_excess: f.static_coefficient - f.coulomb_coefficient,
        stribeck_speed_m_s: f.stribeck_speed_m_s,
        memory_s: memory.lag_s,
        rise_s: memory.rise_s,
    };
    law.check()?;
    Ok(law)
}

/// State of the seven-parameter law; none before a slip is chosen.
fn state(slip: Slip, time_s: f64, memory: f64) -> Option<SevenParameterState> {
    match slip {
        Slip::Sliding { direction, excess } => {
            Some(SevenParameterState::Sliding { direction, lagging_speed_m_s: memory, excess })
        }
        Slip::Sticking { since_s, excess } => Some(SevenParameterState::Sticking {
            displacement_m: memory,
            rest_s: time_s - since_s,
            initial_excess: excess,
        }),
        Slip::Smooth | Slip::BreakingAway { .. } => None,
    }
}

/// Slip and memory of the seven-parameter law after an onset or after the end of a slip.
fn next_elastic(
    law: &SevenParameter,
    (slip, is_moving): (Slip, bool),
    time_s: f64,
    sliding_m_s: f64,
    memory: &mut f64,
) -> Slip {
    let next = match state(slip, time_s, *memory) {
        None if is_moving => SevenParameterState::Sliding {
            direction: sliding_m_s.signum(),
            lagging_speed_m_s: sliding_m_s.abs(),
            excess: law.long_rest_excess,
        },
        None => law.rested(),
        // The spring breaks in the direction in which it is stretched.
        Some(SevenParameterState::Sticking { displacement_m, .. }) => SevenParameterState::Sliding {
            direction: displacement_m.signum(),
            lagging_speed_m_s: 0.0,
            excess: law.break_away_coefficient(&state(slip, time_s, *memory).unwrap_or(law.rested()))
                - law.coulomb_coefficient,
        },
        Some(sliding) => law.advanced(sliding, 0.0, 0.0),
    };
    match next {
        SevenParameterState::Sticking { displacement_m, rest_s, initial_excess } => {
            *memory = displacement_m;
            Slip::Sticking { since_s: time_s - rest_s, excess: initial_excess }
        }
        SevenParameterState::Sliding { direction, lagging_speed_m_s, excess } => {
            *memory = lagging_speed_m_s;
            Slip::Sliding { direction, excess }
        }
    }
}
