//! Information of logs on the parameters that a description declares uncertain.

use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::fit::linear::{cholesky, gram};
use crate::fit::model::Model;
use crate::fit::sensitivities::sensitivities;
use crate::fit::simulation::simulate;
use crate::verdict::identifiability::{Determination, Identifiability, not_determined};
use bench::Bench;
use bench::simulate::RespondError;
use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::Serialize;

/// A parameter that the description declares uncertain.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct DeclaredParameter {
    /// Name in the description; of a nuisance parameter with its log.
    pub name: String,
    /// Described value.
    pub described: f64,
    /// Declared standard deviation.
    pub declared_deviation: f64,
    /// Standard deviation that remains with these logs, if the model and the noise are right.
    pub remaining_deviation: f64,
    /// Rms change of the outputs by one declared deviation, in units of their noise.
    pub change_over_noise: f64,
    /// True if the logs show the parameter and separate it from all others.
    pub is_determined: bool,
}

/// Information of logs on the declared parameters of the described bench.
pub(crate) struct Information {
    pub(crate) data: Data,
    pub(crate) noise: NoiseModel,
    pub(crate) model: Model,
    /// Information on the scaled parameters, without priors.
    fisher: DMatrix<f64>,
    /// Number of samples that the information comes from.
    samples: usize,
}

impl Information {
    pub(super) fn new(bench: &Bench, data: Data, noise: NoiseModel) -> Result<Self, RespondError> {
        let model = Model::nominal(bench, &data).with_nuisances(&data);
        let max = if bench.is_axis() { tuning::MAX_AXIS_SAMPLES } else { tuning::MAX_EXPENSIVE_SAMPLES };
        let count = |data: &Data| data.logs.iter().map(|log| log.uses.len()).sum::<usize>();
        let shorter = (count(&data) > max).then(|| data.first_cycle_view()).flatten();
        let used = shorter.as_ref().unwrap_or(&data);
        // Each further cycle adds as much information as the first.
        let factor = count(&data) as f64 / count(used).max(1) as f64;
        let fisher = factor * fisher(used, &noise, &model)?;
        let samples = data.blocks.iter().map(|block| block.measured.len()).sum();
        Ok(Self { data, noise, model, fisher, samples })
    }

    /// Remarks about parameters that the logs, with further ones, do not determine.
    pub(super) fn not_determined(&self, further: Option<&DMatrix<f64>>) -> Vec<Identifiability> {
        let fisher = further.map_or_else(|| self.fisher.clone(), |further| &self.fisher + further);
        let deviations = self.deviations(&fisher);
        let z = vec![0.0; self.model.parameters.len()];
        not_determined(Determination {
            parameters: &self.model.parameters,
            z: &z,
            deviations: &deviations,
            fisher: &fisher,
        })
    }

    /// The declared parameters with what the logs show of them.
    pub(super) fn parameters(&self) -> Vec<DeclaredParameter> {
        let deviations = self.deviations(&self.fisher);
        let remarks = self.not_determined(None);
        let declared = |(i, p): (usize, &crate::fit::parameter::Parameter)| DeclaredParameter {
            name: p.name().into(),
            described: p.centre,
            declared_deviation: p.scale,
            remaining_deviation: p.scale * deviations.get(i).copied().unwrap_or(1.0),
            change_over_noise: (self.fisher[(i, i)] / self.samples.max(1) as f64).sqrt(),
            is_determined: !remarks.iter().any(|r| r.parameters.iter().any(|name| name == p.name())),
        };
        self.model.parameters.iter().enumerate().map(declared).collect()
    }

    /// Standard deviations in scaled units, with the declared ones as priors.
    fn deviations(&self, fisher: &DMatrix<f64>) -> Vec<f64> {
        let mut information = fisher.clone();
        for (i, parameter) in self.model.parameters.iter().enumerate() {
            information[(i, i)] += parameter.precision;
        }
        let covariance = cholesky(&information).map(|factor| factor.inverse());
        covariance.map_or_else(Vec::new, |c| c.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect())
    }
}

/// Information of the fitted samples on the parameters of a model at their described values.
pub(super) fn fisher(data: &Data, noise: &NoiseModel, model: &Model) -> Result<DMatrix<f64>, RespondError> {
    let z = vec![0.0; model.parameters.len()];
    let here = simulate(data, &model.at(&z), None)?;
    let all: Vec<usize> = (0..z.len()).collect();
    Ok(gram(&sensitivities(data, noise, model, &z, &here, &all)?))
}
