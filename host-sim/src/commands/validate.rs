//! `host-sim validate`: the models against published known answers.

use crate::error::CliError;
use crate::force::{self, DEFAULT_STEP_S, ForceSource, SAMPLE_RATE_HZ};
use crate::summary::Figures;
use bench::integrate::integrate;
use bench::slider_crank_description::reference_problem;
use bench::{BearingMaterial, Bench};
use clap::Args;
use contact::{Dissipation, produced_restitution};
use serde::Serialize;

/// Arguments of `host-sim validate`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example:\n  host-sim validate --json")]
pub struct ValidateArgs {
    /// Print the cases as JSON.
    #[arg(long)]
    pub json: bool,
}

/// One known answer.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    /// What was computed.
    pub name: String,
    /// What came out.
    pub value: f64,
    /// What is known.
    pub reference: f64,
    /// Distance: relative, or in metres where the tolerance is.
    pub error: f64,
    /// What the distance may be.
    pub tolerance: f64,
    /// Whether it holds.
    pub ok: bool,
}

fn relative(name: String, value: f64, reference: f64, tolerance: f64) -> Case {
    let error = (value / reference - 1.0).abs();
    Case { name, value, reference, error, tolerance, ok: error <= tolerance }
}

#[derive(Serialize)]
struct Cases {
    cases: Vec<Case>,
}

/// Runs every case. Exit code 1 if one does not hold.
pub fn run(args: &ValidateArgs) -> Result<(), CliError> {
    let mut cases = restitution();
    cases.extend(slider_crank()?);
    cases.extend(bench_b()?);
    let failed = cases.iter().filter(|c| !c.ok).count();
    if args.json {
        let text =
            serde_json::to_string_pretty(&Cases { cases }).map_err(|e| CliError::Work(e.to_string()))?;
        say!("{text}");
    } else {
        say!("{:<52} {:>16} {:>16} {:>10} {:>10}", "case", "value", "reference", "error", "tolerance");
        for c in &cases {
            let mark = if c.ok { "" } else { "  FAILED" };
            say!(
                "{:<52} {:>16.8} {:>16.8} {:>10.1e} {:>10.1e}{mark}",
                c.name,
                c.value,
                c.reference,
                c.error,
                c.tolerance
            );
        }
    }
    if failed > 0 {
        return Err(CliError::Work(format!("{failed} known answers do not hold")));
    }
    Ok(())
}

fn restitution() -> Vec<Case> {
    let table = [
        ("Hunt-Crossley", Dissipation::HuntCrossley, 0.619736, 0.832870),
        ("Lankarani-Nikravesh", Dissipation::LankaraniNikravesh, 0.701635, 0.847102),
        ("Zhiying-Qishao", Dissipation::ZhiyingQishao, 0.398837, 0.787365),
    ];
    let case = |name: &str, law: Dissipation, e: f64, known: f64| {
        relative(
            format!("produced restitution, {name}, e = {e}"),
            produced_restitution(law.factor(e)),
            known,
            2e-6,
        )
    };
    table
        .iter()
        .flat_map(|&(name, law, at_04, at_08)| [case(name, law, 0.4, at_04), case(name, law, 0.8, at_08)])
        .collect()
}

fn slider_crank() -> Result<Vec<Case>, CliError> {
    let bench = reference_problem()?;
    let plant = bench.plant();
    let result = integrate(
        &plant,
        (0.0, bench.duration_s()),
        plant.initial_state(),
        false,
        &[],
        &plant.tolerances(1e-11),
        |_, _, _| {},
    )?;
    let first = result.impacts.first().map_or((0.0, 0.0), |i| (i.peak_force_n, i.onset_s));
    let position = result.state[1];
    let reference = 0.0754435223;
    let error = (position - reference).abs();
    Ok(vec![
        relative("slider-crank, first contact, s".into(), first.1, 227.286e-6, 5e-6),
        relative("slider-crank, first peak, N".into(), first.0, 45777.46, 1e-6),
        relative("slider-crank, contacts in .6 revolutions".into(), result.impacts.len() as f64, 20.0, 0.0),
        Case {
            name: "slider-crank, x(.6 rev), m".into(),
            value: position,
            reference,
            error,
            tolerance: 1e-6,
            ok: error <= 1e-6,
        },
    ])
}

fn bench_b() -> Result<Vec<Case>, CliError> {
    let table = [
        (
            BearingMaterial::Babbitt,
            [(0.10, 8067.0, 94.0), (0.25, 10137.0, 743.0), (0.5, 11755.0, 1034.0), (1.0, 13924.0, 1152.0)],
        ),
        (
            BearingMaterial::Plastic,
            [(0.10, 6004.0, 189.0), (0.25, 5952.0, 378.0), (0.5, 6244.0, 523.0), (1.0, 7173.0, 526.0)],
        ),
    ];
    let mut cases = Vec::new();
    for (material, rows) in table {
        for (clearance_mm, peak_n, oscillation_n) in rows {
            let Bench::Transmission(mut bench) = Bench::open("bench-b")? else {
                return Err(CliError::Work("bench-b is no transmission bench".into()));
            };
            bench.set_material(material);
            bench.set_radial_clearance(clearance_mm * 1e-3);
            let run = force::run_bench(&bench, ForceSource::Law, DEFAULT_STEP_S, || {})?;
            let figures = Figures::of(&bench, ForceSource::Law, &run, SAMPLE_RATE_HZ);
            let name = |what: &str| format!("bench B, {}, {clearance_mm} mm, {what}, N", material.name());
            cases.push(relative(name("peak contact force"), figures.peak_contact_force_n, peak_n, 0.02));
            cases.push(relative(name("oscillation rms"), figures.oscillation_rms_n, oscillation_n, 0.02));
        }
    }
    Ok(cases)
}
