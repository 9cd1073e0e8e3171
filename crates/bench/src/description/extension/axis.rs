//! Terms of a driven axis, with the efforts that they add.

use super::{BreakawayTerm, RippleTerm, StepTerm, StribeckTerm, ThermalTerm, ripples};
use crate::signals::Motion;

/// Terms of a driven axis; efforts in N or N m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisExtension {
    /// Viscous effort per speed that reverses its sign in backward motion.
    pub viscous_asymmetry: f64,
    /// Dry friction per displacement from the neutral position.
    pub friction_slope: f64,
    /// Effort that falls with speed.
    pub stribeck: Vec<StribeckTerm>,
    /// Changes of dry friction.
    pub friction_steps: Vec<StepTerm>,
    /// Static friction after a rest.
    pub breakaway: Option<BreakawayTerm>,
    /// Sliding distance over which friction reverses, m at the friction radius; 0: none.
    pub presliding_distance_m: f64,
    /// Friction over temperature.
    pub thermal: Option<ThermalTerm>,
    /// Temperature rise at the first sample, K: a per-log parameter that no effect sets.
    pub temperature_start_k: f64,
    /// Lag of the axis after its logged motion, s.
    pub drive_lag_s: f64,
    /// Ripple of the load over time, N.
    pub load_ripples: Vec<RippleTerm>,
    /// Effort over position.
    pub position_ripples: Vec<RippleTerm>,
}

/// Motion of the rubbing part, and the memory of its friction.
pub(crate) struct Rubbing {
    /// Time of the log, s.
    pub(crate) time_s: f64,
    /// Displacement from the neutral position, m or rad.
    pub(crate) displacement: f64,
    /// Speed, m/s or rad/s.
    pub(crate) rate: f64,
    /// Sliding speed, m/s.
    pub(crate) sliding_m_s: f64,
    /// Regularised sign of the speed.
    pub(crate) sign: f64,
    /// Share of the break-away excess that a standstill has built up.
    pub(crate) breakaway: f64,
    /// Temperature rise, K.
    pub(crate) rise_k: f64,
}

impl AxisExtension {
    /// Dry friction whose described level is `dry`, without the direction.
    #[inline]
    pub(crate) fn dry_friction(&self, dry: f64, at: &Rubbing) -> f64 {
        let mut dry = dry + self.friction_slope * at.displacement;
        for term in &self.stribeck {
            dry += term.rise * (-at.sliding_m_s.abs() / term.speed_m_s).exp();
        }
        if let Some(term) = &self.breakaway {
            dry += term.excess * at.breakaway;
        }
        for term in &self.friction_steps {
            dry += term.at(at.time_s);
        }
        if let Some(term) = &self.thermal {
            dry *= term.level(at.rise_k);
        }
        dry
    }

    /// Friction that depends on the speed, in addition to the described one.
    #[inline]
    pub(crate) fn viscous_friction(&self, at: &Rubbing) -> f64 {
        self.viscous_asymmetry * at.rate * at.sign
    }

    /// Effort without friction that the motion of the drive causes.
    #[inline]
    pub(crate) fn effort(&self, motion: &Motion) -> f64 {
        ripples(&self.position_ripples, motion.value)
    }
}
