//! Findings about nuisance parameters of single logs that end at the limit of calibration.

use crate::check::{Finding, Severity};
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::digits::four_digits;
use crate::fit::least_squares::{Fit, fit};
use crate::fit::model::Model;
use crate::fit::parameter::Parameter;
use crate::fit::tuning::{BOUND_TOLERANCE, MAX_DEVIATIONS};
use bench::Channel;
use bench::simulate::RespondError;

/// Findings about nuisance parameters that end at the limit of calibration, with everything else
/// fixed as fitted.
///
/// Those of fitted logs are refitted at the noise floors, because a log far from the simulation
/// inflates the noise of the common fit so much that its nuisance parameters stay at their prior.
pub(crate) fn findings_at_bounds(
    data: &Data,
    floors: &NoiseModel,
    (model, z): (&Model, &[f64]),
    held_out: Option<&Fit>,
) -> Result<Vec<Finding>, RespondError> {
    let fitted = data.fitted_view();
    let (own, start) = (model.fixed_at(z).with_nuisances(&fitted), model.nuisance_values(z));
    let refitted = if start.is_empty() { None } else { Some(fit(&fitted, floors, own, start)?) };
    let finding = |(p, &z): (&Parameter, &f64)| {
        let nuisance = p.nuisance().filter(|_| z.abs() >= MAX_DEVIATIONS - BOUND_TOLERANCE)?;
        let source = data.logs.get(nuisance.log)?.source.as_str();
        let found = format!(
            "{} ends at {} {}, {MAX_DEVIATIONS:.0} of its declared standard deviations",
            nuisance.field(),
            four_digits(p.value(z)),
            p.unit
        );
        let channel = nuisance.channel().map_or("t_s", Channel::name);
        let finding = Finding::new(Severity::Doubtful, source, channel, "nuisance-at-bound", found)
            .cause("the declaration is too narrow, or another effect acts in this log alone")
            .evidence("value", p.value(z))
            .evidence("declared_deviation", p.scale);
        Some(finding)
    };
    let fits = refitted.iter().chain(held_out);
    Ok(fits.flat_map(|f| f.model.parameters.iter().zip(&f.z)).filter_map(finding).collect())
}
