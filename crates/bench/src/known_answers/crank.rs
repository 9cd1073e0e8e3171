//! The slider-crank with a clearance joint: onset, peaks of the laws, statistics of the run.

use super::{KnownAnswer, KnownAnswerError};
use crate::description::SliderCrankBench;
use crate::integrate::{Integration, integrate};
use crate::plants::slider_crank::SliderCrank;
use contact::{Dissipation, Material, NormalLaw, Stiffness, effective_modulus_pa};

/// Relative tolerance at which the error of the run is below the last printed digit of the
/// references.
const TOLERANCE: f64 = 1e-12;

fn run(plant: &SliderCrank, revolutions: f64) -> Result<Integration<4>, KnownAnswerError> {
    let end_s = revolutions * 2.0 * core::f64::consts::PI / plant.crank_speed_rad_s;
    let tolerances = plant.tolerances(TOLERANCE);
    Ok(integrate(plant, (0.0, end_s), plant.initial_state(), false, &[], &tolerances, |_, _, _| {})?)
}

pub(super) fn cases() -> Result<Vec<KnownAnswer>, KnownAnswerError> {
    let bench = SliderCrankBench::open("slider-crank")?;
    let plant = bench.plant();
    let result = run(&plant, 0.6)?;
    let missing = KnownAnswerError::Missing("the slider-crank's joint made no contact");
    let first = result.impacts.first().ok_or(missing)?;
    let name = |what: &str| format!("slider-crank, {what}");
    let separation = first.separation_s.unwrap_or(f64::NAN);
    let mut cases = vec![
        KnownAnswer::absolute(name("first contact, s"), first.onset_s, 227.286e-6, 5e-10),
        KnownAnswer::absolute(name("approach speed, m/s"), first.approach_speed_m_s, 4.385783, 5e-7),
        KnownAnswer::absolute(name("separation, s"), separation, 280.763e-6, 5e-10),
        KnownAnswer::absolute(name("contacts in .6 revolutions"), result.impacts.len() as f64, 20.0, 0.0),
        KnownAnswer::absolute(name("x(.6 rev), m"), result.state[1], 0.0754435223, 2e-9),
        // Impacts amplify errors: 1e-9 m in the position correspond to 1e-5 m/s in the speed.
        KnownAnswer::absolute(name("v(.6 rev), m/s"), result.state[3], 9.984871, 2e-5),
    ];
    for (i, (impact, known)) in
        result.impacts.iter().zip([45777.46, 20971.99, 25593.21, 6770.89, 13012.17]).enumerate()
    {
        let name = format!("slider-crank, Hunt-Crossley, peak {}, N", i + 1);
        // The independent codes agree to about 1e-6.
        cases.push(KnownAnswer::relative(name, impact.peak_force_n, known, 1e-6));
    }
    let revolution = run(&plant, 1.0)?;
    cases.push(KnownAnswer::absolute(name("x(1 rev), m"), revolution.state[1], 0.17032374, 1e-7));
    // The slider of an ideal joint decelerates most where crank and rod are in line.
    let (r, w) = (plant.crank_length_m, plant.crank_speed_rad_s);
    let ideal = r * w * w * (1.0 + r / plant.rod_length_m);
    let peak = result.impacts.iter().map(|i| i.peak_force_n).fold(0.0, f64::max);
    let ratio = peak / plant.slider_mass_kg / ideal;
    cases.push(KnownAnswer::absolute(name("peak acceleration over ideal"), ratio, 16.8, 0.05));

    let steel = Material {
        youngs_modulus_pa: bench.joint.youngs_modulus_pa,
        poisson_ratio: bench.joint.poisson_ratio,
    };
    let printed = Stiffness::HybridAsPrinted {
        effective_modulus_pa: effective_modulus_pa(&steel, &steel),
        radial_clearance_m: plant.radial_clearance_m,
    };
    let hertz = plant.normal_law.stiffness;
    for (law, stiffness, dissipation, known) in [
        ("Lankarani-Nikravesh", hertz, Dissipation::LankaraniNikravesh, 45872.27),
        ("Flores", hertz, Dissipation::Flores, 45448.01),
        ("Carvalho-Martins", hertz, Dissipation::CarvalhoMartins, 45577.94),
        ("Bai-Zhao as printed", printed, Dissipation::ZhiyingQishao, 50498.17),
    ] {
        let normal_law = NormalLaw { stiffness, dissipation, ..plant.normal_law };
        let result = run(&SliderCrank { normal_law, ..plant }, 0.05)?;
        let peak = result.impacts.first().map_or(f64::NAN, |i| i.peak_force_n);
        cases.push(KnownAnswer::absolute(format!("slider-crank, {law}, first peak, N"), peak, known, 0.01));
    }
    Ok(cases)
}
