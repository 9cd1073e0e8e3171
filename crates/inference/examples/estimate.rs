//! Forces of a bearing from a table of samples.
//!
//! ```text
//! # a made-up press and release
//! cargo run -p inference --example estimate
//! # babbitt or plastic; `-` reads standard input
//! cargo run -p inference --example estimate -- plastic samples.csv
//! ```
//!
//! Columns of the table, in SI units: radial clearance, deformation, its rate, latched approach
//! speed, sliding speed. The first line is a heading. The output has one line per sample: normal
//! force and friction force in N, bits of the flags.

use inference::{BearingMaterial, ContactState, Model, Pair, shipped};
use std::error::Error;
use std::io::Write;

/// Returns a press at a clearance of 0.5 mm by 40 um and its release within 40 ms, sliding at 0.1
/// m/s.
fn press() -> Vec<ContactState> {
    let (depth_m, duration_s) = (4e-5_f32, 0.04_f32);
    let per_second = std::f32::consts::PI / duration_s;
    (0..=40_u8)
        .map(|step| {
            let phase = per_second * f32::from(step) * 1e-3;
            ContactState {
                radial_clearance_m: 0.5e-3,
                deformation_m: depth_m * phase.sin(),
                deformation_rate_m_s: depth_m * per_second * phase.cos(),
                approach_speed_m_s: depth_m * per_second,
                sliding_speed_m_s: 0.1,
            }
        })
        .collect()
}

fn parse(line: &str) -> Option<ContactState> {
    let mut numbers = line.split(',').map(|field| field.trim().parse().ok());
    let state = ContactState {
        radial_clearance_m: numbers.next()??,
        deformation_m: numbers.next()??,
        deformation_rate_m_s: numbers.next()??,
        approach_speed_m_s: numbers.next()??,
        sliding_speed_m_s: numbers.next()??,
    };
    numbers.next().is_none().then_some(state)
}

fn read(file: &str) -> Result<Vec<ContactState>, Box<dyn Error>> {
    let text = if file == "-" {
        std::io::read_to_string(std::io::stdin())?
    } else {
        std::fs::read_to_string(file).map_err(|error| format!("{file}: {error}"))?
    };
    (text.lines().enumerate().skip(1))
        .map(|(index, line)| {
            let wrong =
                || format!("{file}, line {}: found `{line}`, expected five numbers", index + 1).into();
            parse(line).ok_or_else(wrong)
        })
        .collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| BearingMaterial::Babbitt.name().to_owned());
    let bearing = BearingMaterial::ALL.into_iter().find(|bearing| bearing.name() == name);
    let bearing = bearing.ok_or_else(|| format!("found bearing `{name}`, expected babbitt or plastic"))?;
    let states = arguments.next().map_or_else(|| Ok(press()), |file| read(&file))?;

    let mut pair: Pair = Pair::new(Model::load(shipped(bearing))?);
    // `println!` panics if its reader has closed.
    let mut output = std::io::stdout().lock();
    writeln!(output, "normal_force_n,friction_force_n,flags")?;
    for state in &states {
        let estimate = pair.push(state);
        writeln!(
            output,
            "{:.3},{:.3},{:#x}",
            estimate.normal_force_n(),
            estimate.friction_force_n(),
            estimate.flags.bits()
        )?;
    }
    Ok(())
}
