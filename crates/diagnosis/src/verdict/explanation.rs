//! Explanations: the calibrated bench without a cause or with some, and the tests on its
//! residual.

use super::effect_name::EffectName;
use super::remaining_structure::{self, RemainingStructure};
use super::size_consistency::{Inconsistency, inconsistency};
use crate::data::logs::{Columns, Data};
use crate::data::noise::NoiseModel;
use crate::data::views::Views;
use crate::fit::held_out_gain::all_residuals;
use crate::fit::held_out_nuisances::simulate_all;
use crate::fit::least_squares::{Fit, fit};
use crate::fit::model::{Candidate, Model};
use crate::fit::standard_deviations::standard_deviations;
use crate::search::contender::Contender;
use crate::search::selection::Selection;
use bench::simulate::RespondError;
use nalgebra::DMatrix;

/// The calibrated bench with some of the selected causes.
pub(crate) struct Explanation {
    /// Causes with their probabilities.
    pub(crate) causes: Vec<(Candidate, f64)>,
    /// Residual of all samples if each cause is left out in turn and everything else is fitted
    /// again.
    pub(crate) without: Vec<Columns>,
    /// Effects that fit as well in the place of each cause, where each was compared.
    pub(crate) alternatives: Vec<Vec<EffectName>>,
    pub(crate) model: Model,
    /// Scaled parameters.
    pub(crate) z: Vec<f64>,
    /// Standard deviations in scaled units.
    pub(crate) deviations: Vec<f64>,
    /// Information of the data on the scaled parameters, without priors.
    pub(crate) fisher: DMatrix<f64>,
    /// Residual of all samples.
    pub(crate) residual: Columns,
    pub(crate) noise: NoiseModel,
    /// Structure that remains in the residual.
    pub(crate) remaining: Option<RemainingStructure>,
    /// Fit of the nuisance parameters of held-out logs.
    pub(crate) held_out: Option<Fit>,
    pub(crate) inconsistency: Inconsistency,
}

impl Explanation {
    /// Simulates a fit for all samples and tests its residual.
    pub(crate) fn new(
        views: &Views,
        floors: &NoiseModel,
        (fit, used): (&Fit, &NoiseModel),
        causes: Vec<(Candidate, f64)>,
        without: Vec<Columns>,
    ) -> Result<Self, RespondError> {
        let data = &views.all;
        let (simulation, held_out) = simulate_all(data, used, &fit.model, &fit.z)?;
        let residual = data.residual(&simulation.columns);
        let noise = floors.inflated(data, &residual);
        let remaining = remaining_structure::strongest_structure(data, &noise, &residual);
        let inconsistency = inconsistency(&views.fitted, floors, used, fit);
        let (deviations, fisher) = (standard_deviations(&views.fitted, used, fit), fit.fisher());
        let (model, z) = (fit.model.clone(), fit.z.clone());
        Ok(Self {
            causes,
            without,
            alternatives: Vec::new(),
            model,
            z,
            deviations,
            fisher,
            residual,
            noise,
            remaining,
            held_out,
            inconsistency,
        })
    }
}

/// Explanations without a cause, with the first selected cause and with both.
///
/// The first cause is dropped if the second one makes it unnecessary: if the second one, refitted
/// alone, leaves a chi-square that is higher by no more than the threshold.
pub(crate) fn explanations(
    views: &Views,
    floors: &NoiseModel,
    nominal: &Model,
    selection: &Selection,
) -> Result<Vec<Explanation>, RespondError> {
    let data = &views.fitted;
    let first = &selection.first;
    let mut out = vec![Explanation::new(views, floors, (&first.base, &first.noise), Vec::new(), Vec::new())?];
    let mut causes = Vec::new();
    let calibrated = out.first().map(|e| e.residual.clone()).unwrap_or_default();
    for (k, stage) in selection.stages().enumerate().filter(|(_, stage)| stage.has_cause) {
        let Some(best) = stage.contenders.first() else { break };
        causes.push((best.candidate.clone(), best.probability));
        let mut without: Vec<Columns> = out.last().map(|e| e.residual.clone()).into_iter().collect();
        if let [(_, first_probability), _] = causes.as_mut_slice() {
            let second_alone = fit_second_alone(data, &stage.noise, nominal, best)?;
            let loss = second_alone.objective - best.fit.objective;
            if loss <= stage.threshold {
                causes.remove(0);
                let fitted = (&second_alone, &stage.noise);
                let without = vec![calibrated.clone()];
                out.push(Explanation::new(views, floors, fitted, causes.clone(), without)?);
                continue;
            }
            without.insert(0, all_residuals(&views.all, &stage.noise, &second_alone)?);
            // Alone, the first cause may have lost to a rival. Beside the second one, the loss
            // without it counts.
            if loss.is_finite() {
                *first_probability = 1.0 / (1.0 + (0.5 * (stage.threshold - loss)).exp());
            }
        }
        // The next stage starts with the same model and may have left a local minimum where this
        // fit stopped.
        let next = selection.stages().nth(k + 1).filter(|next| next.improves_on_stuck(data, &best.fit));
        let fitted = next.map_or((&best.fit, &stage.noise), |next| (&next.base, &next.noise));
        out.push(Explanation::new(views, floors, fitted, causes.clone(), without)?);
    }
    Ok(out)
}

/// Fits the second of two causes without the first one, from its estimate beside the first one.
fn fit_second_alone(
    data: &Data,
    noise: &NoiseModel,
    nominal: &Model,
    second: &Contender,
) -> Result<Fit, RespondError> {
    let pair = (&second.fit.model, second.fit.z.as_slice());
    let last = pair.0.effects.len().checked_sub(1);
    let (model, z) = nominal.with_effects_of(pair, last, noise);
    fit(data, noise, model, z)
}
