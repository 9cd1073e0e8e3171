//! Runs of a mechanism in which networks give the forces of some contacts, held over the
//! communication step.

use super::RunArgs;
use super::arguments::communication_step_s;
use super::force::ForceSource;
use super::networks::{Networks, Readings};
use crate::cli::error::CliError;
use bench::BearingMaterial;
use bench::description::MechanismBench;
use bench::plants::mechanism::{HeldForces, MechanismRun};
use bench::plants::transmission::{BearingForces, ContactView};
use bench::simulate::RunWithBars;
use schemars::JsonSchema;
use serde::Serialize;

/// Networks of a run.
#[derive(Clone, Copy, Debug, JsonSchema, Serialize)]
pub(crate) struct NetworkFigures {
    /// Communication step of the networks.
    communication_step_s: f64,
    /// Share of their contact samples outside the networks' training range.
    outside_training_share: f64,
    /// Largest force of a network without contact.
    without_contact_n: f64,
}

/// Chooses the source of the contact forces and refuses one that the mechanism cannot have.
pub(crate) fn source(bench: &MechanismBench, args: &RunArgs) -> Result<ForceSource, CliError> {
    let has_networks = bench.networks().iter().any(Option::is_some);
    args.check_uncontrolled("mechanism", has_networks && args.force != Some(ForceSource::Law))?;
    let refuse = |source: ForceSource, expected: &str| {
        Err(CliError::Input(format!("--force: found {} on a mechanism; expected {expected}", source.name())))
    };
    match args.force {
        None if has_networks => Ok(ForceSource::QuantisedNet),
        None => Ok(ForceSource::Law),
        Some(source @ ForceSource::HeldLaw) => refuse(source, "law, float-net or quantised-net"),
        Some(source) if source != ForceSource::Law && !has_networks => {
            refuse(source, "law: no contact of its joints has a `network`")
        }
        Some(source) => Ok(source),
    }
}

/// Runs the mechanism with the networks of its contacts. The error bars come from runs at twice and
/// four times the communication step.
pub(crate) fn run(
    bench: &MechanismBench,
    (source, step_us): (ForceSource, f64),
    samples_s: &[f64],
) -> Result<(RunWithBars, NetworkFigures), CliError> {
    let step_s = communication_step_s(step_us)?;
    // A run that is too coarse to succeed leaves wider bars.
    let coarse = run_once(bench, source, 4.0 * step_s, &[]).ok().map(|(run, _)| run);
    let (middle, _) = run_once(bench, source, 2.0 * step_s, &[])?;
    let (run, figures) = run_once(bench, source, step_s, samples_s)?;
    Ok((RunWithBars::new(run, &middle, coarse.as_ref()), figures))
}

fn run_once(
    bench: &MechanismBench,
    source: ForceSource,
    step_s: f64,
    samples_s: &[f64],
) -> Result<(MechanismRun, NetworkFigures), CliError> {
    let materials = bench.networks();
    let of_contact =
        |material: &Option<BearingMaterial>| material.map(|m| Networks::new(source, m)).transpose();
    let mut networks = materials.iter().map(of_contact).collect::<Result<Vec<_>, _>>()?;
    let mut readings = Readings::default();
    let mut force = |contact: usize, view: &ContactView| {
        let Some(Some(network)) = networks.get_mut(contact) else { return BearingForces::default() };
        readings.count(view, network.push(view))
    };
    let contacts = materials.iter().map(Option::is_some).collect();
    let held = HeldForces { step_s, contacts, force: &mut force };
    let run = bench.simulate_held(samples_s, bench.run.tolerance, held)?;
    let figures = NetworkFigures {
        communication_step_s: step_s,
        outside_training_share: readings.outside_share(),
        without_contact_n: readings.without_contact_n,
    };
    Ok((run, figures))
}
