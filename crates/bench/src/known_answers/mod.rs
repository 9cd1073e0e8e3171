//! Known answers: the plants against closed forms, benchmark libraries and independent codes.
//!
//! Each case computes a value with the library's own integrator and states its reference.
//! References: Hertz' impact and the bouncing ball in closed form; A01, A02, A03 of the IFToMM
//! multibody benchmark library (A03 from the test set for IVP solvers); the slider-crank with a
//! clearance joint, confirmed by three independent codes. [`known_answers`] takes about a second in
//! a release build. `host-sim validate` shows the cases; so they, and the multibody benchmarks with
//! them, belong to the library.

mod answer;
mod ball;
mod crank;
mod falling_ball;
mod multibody;

pub use answer::{KnownAnswer, KnownAnswerError};
use multibody::{four_bar, pendulum, squeezer};

/// Computes every case.
pub fn known_answers() -> Result<Vec<KnownAnswer>, KnownAnswerError> {
    let mut cases = ball::cases()?;
    cases.extend(mechanisms()?);
    cases.extend(crank::cases()?);
    Ok(cases)
}

fn mechanisms() -> Result<Vec<KnownAnswer>, KnownAnswerError> {
    let mut cases = vec![KnownAnswer::relative(
        "pendulum (A01), period, s",
        pendulum::period_s()?,
        2.367841947576,
        1e-11,
    )];
    let mut positions =
        |name: &str, times: [f64; 2], found: Vec<[f64; 2]>, known: [[f64; 2]; 2], tolerance| {
            for ((time, found), known) in times.iter().zip(found).zip(known) {
                for ((axis, value), reference) in ["x", "y"].iter().zip(found).zip(known) {
                    let name = format!("{name}, {axis}({time} s), m");
                    cases.push(KnownAnswer::absolute(name, value, reference, tolerance));
                }
            }
        };
    let times = [1.0, 10.0];
    let pendulum = [[0.986291751132, -0.165010853126], [-0.275087462576, -0.961419205099]];
    positions("pendulum (A01)", times, pendulum::positions_m(&times)?, pendulum, 1e-10);
    let four_bar = [[-0.1950203019, -0.9807992057], [0.3284581115, 0.9445185382]];
    positions("four-bar mechanism (A02), B0", times, four_bar::positions_m(&times)?, four_bar, 1e-7);
    let angles = squeezer::angles_rad(0.03)?;
    let names = ["beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"];
    let known = [
        15.81077119629904,
        -15.75637105984298,
        0.04082224013073101,
        -0.5347301163226948,
        0.5244099658805304,
        0.5347301163226948,
        1.048080741042263,
    ];
    for ((name, value), reference) in names.iter().zip(angles).zip(known) {
        let name = format!("Andrews' squeezer (A03), {name}(.03 s), rad");
        cases.push(KnownAnswer::absolute(name, value, reference, 1e-7));
    }
    Ok(cases)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_known_answer_is_within_its_tolerance() {
        let cases = known_answers().unwrap();
        let failed: Vec<&KnownAnswer> = cases.iter().filter(|c| !c.holds()).collect();
        for c in &cases {
            eprintln!(
                "{:<64} {:>20.12} {:>20.12} {:.1e} {:.0e}",
                c.name,
                c.value,
                c.reference,
                c.error(),
                c.tolerance
            );
        }
        assert!(failed.is_empty(), "{failed:#?}");
        assert!(cases.len() >= 39, "{}", cases.len());
    }

    #[test]
    fn a_wrong_value_is_outside_its_tolerance() {
        assert!(!KnownAnswer::relative("x", 1.001, 1.0, 1e-4).holds());
        assert!(!KnownAnswer::absolute("x", f64::NAN, 0.0, 1.0).holds());
    }
}
