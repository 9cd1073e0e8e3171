//! Known factors between a reading and its SI value.

use super::tuning;
use bench::{Bench, Channel};
use core::f64::consts::PI;

/// Returns whether a channel shows mostly friction, which a description may miss by far.
fn is_friction(bench: &Bench, channel: Channel) -> bool {
    channel == Channel::FrictionTorque || bench.is_axis()
}

/// Factors `reading = factor x SI` of wrong units, with their causes.
pub(super) fn units(bench: &Bench, channel: Channel) -> Vec<(f64, String)> {
    let degree = 180.0 / PI;
    let named: &[(f64, &str)] = match channel.unit() {
        "m" => &[(1e3, "mm"), (1e6, "um"), (1e2, "cm"), (1.0 / 0.0254, "inches")],
        "m/s" => &[(1e3, "mm/s"), (1e2, "cm/s"), (60.0, "m/min")],
        "rad" => &[(degree, "degrees"), (1e3, "mrad"), (1e6, "urad")],
        "rad/s" => &[(degree, "degrees per second"), (30.0 / PI, "revolutions per minute"), (1e3, "mrad/s")],
        "N" => &[(1e-3, "kN"), (1e-6, "MN"), (1e3, "mN"), (1.0 / 9.806_65, "kgf"), (1.0 / 4.448_222, "lbf")],
        "N m" => &[(1e-3, "kN m"), (1e3, "N mm"), (1e2, "N cm"), (1.0 / 9.806_65, "kgf m")],
        _ => &[],
    };
    let min =
        if is_friction(bench, channel) { tuning::MIN_LOG_FACTOR_FRICTION } else { tuning::MIN_LOG_FACTOR };
    let mut out: Vec<(f64, String)> = named
        .iter()
        .map(|(f, unit)| (*f, format!("the readings are in {unit}, not in {}", channel.unit())))
        .collect();
    for factor in [1e3, 1e-3, 1e6, 1e-6, degree, 1.0 / degree] {
        let is_angular = factor == degree || factor == 1.0 / degree;
        if (!is_angular || channel.unit().starts_with("rad"))
            && !out.iter().any(|(f, _)| f64::abs(f / factor - 1.0) < tuning::SAME_FACTOR_TOLERANCE)
        {
            out.push((factor, "the factor to SI was applied twice, or its inverse was".into()));
        }
    }
    out.retain(|(f, _)| f.ln().abs() > min);
    out
}

/// Factors of a wrong length or area in the conversion of a reading, with their causes.
pub(super) fn geometry(bench: &Bench) -> Vec<(f64, String)> {
    let mut out = vec![
        (2.0, "a diameter in place of a radius, or both halves of a bridge counted".to_owned()),
        (0.5, "a radius in place of a diameter, or half a bridge taken for a full one".to_owned()),
        (4.0 / PI, "the area of a square in place of a circle's (4/pi)".to_owned()),
        (PI / 4.0, "pi/4 applied twice to an area".to_owned()),
    ];
    if let Some(b) = bench.transmission() {
        let ratio = b.geometry.load_lever_radius_m / b.geometry.drive_lever_radius_m;
        out.push((ratio, "the ratio of the load crank to the drive crank: taken at the wrong lever".into()));
        out.push((
            1.0 / ratio,
            "the ratio of the drive crank to the load crank: taken at the wrong lever".into(),
        ));
    }
    out.retain(|(f, _)| f.ln().abs() > tuning::MIN_LOG_GEOMETRY);
    out
}

/// Factors of a load that was computed from a pressure with a wrong area, with their causes.
pub(super) fn areas() -> [(f64, String); 2] {
    [
        (4.0, "the cylinder's area from its diameter in place of its radius".into()),
        (0.25, "the cylinder's area from its radius in place of its diameter".into()),
    ]
}
