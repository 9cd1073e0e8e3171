//! Networks of one contact: in floating point or quantised.

use super::force::ForceSource;
use crate::cli::error::CliError;
use bench::BearingMaterial;
use bench::plants::transmission::{BearingForces, ContactView};
use inference::{Flags, Model, Pair, shipped};
use model_quant::network::float_pair::FloatPair;
use pintle_fmu::contact_state;

/// Networks of one contact with their history.
pub(crate) enum Networks {
    /// In floating point.
    Float(Box<FloatPair>),
    /// Those of the controller.
    Quantised(Box<Pair<'static>>),
}

impl Networks {
    /// Networks of a source; the quantised ones unless it names those in floating point.
    pub(crate) fn new(source: ForceSource, bearing: BearingMaterial) -> Result<Self, CliError> {
        let refused = |error: String| CliError::Work(format!("shipped networks: {error}"));
        if source == ForceSource::FloatNet {
            let pair = FloatPair::new(bearing).map_err(|error| refused(error.to_string()))?;
            return Ok(Self::Float(Box::new(pair)));
        }
        let model = Model::load(shipped(bearing)).map_err(|error| refused(error.to_string()))?;
        Ok(Self::Quantised(Box::new(Pair::new(model))))
    }

    /// Normal and friction force in N, and the flags of the estimate.
    pub(crate) fn push(&mut self, view: &ContactView) -> ([f64; 2], Flags) {
        match self {
            Self::Float(pair) => {
                let found = pair.push(&contact_state(view));
                ([found.normal_force_n, found.friction_force_n].map(f64::from), found.flags)
            }
            Self::Quantised(pair) => {
                let found = pair.push(&contact_state(view));
                ([found.normal_force_n(), found.friction_force_n()].map(f64::from), found.flags)
            }
        }
    }
}

/// Counts over the forces that a run holds.
#[derive(Default)]
pub(crate) struct Readings {
    touching: usize,
    outside: usize,
    /// Largest force without contact in N.
    pub(crate) without_contact_n: f64,
}

impl Readings {
    /// Counts a reading and returns its forces.
    pub(crate) fn count(
        &mut self,
        view: &ContactView,
        ([normal_n, friction_n], flags): ([f64; 2], Flags),
    ) -> BearingForces {
        if view.deformation_m > 0.0 {
            self.touching += 1;
            self.outside += usize::from(flags.intersects(Flags::OUTSIDE_TRAINING));
        } else {
            self.without_contact_n = self.without_contact_n.max(normal_n.abs()).max(friction_n.abs());
        }
        BearingForces { normal_n, friction_n }
    }

    /// Share of the readings in contact that are outside the networks' training range.
    pub(crate) fn outside_share(&self) -> f64 {
        if self.touching > 0 { self.outside as f64 / self.touching as f64 } else { 0.0 }
    }
}
