//! Figs. 3, 6, 7, 12 and 13: friction laws and the friction experiment over the paper's own ranges,
//! 0 to 240 kN and 0 to 6 deg/s.

use super::chart;
use crate::cli::error::CliError;
use crate::cli::output::Picture;
use bench::description::{FrictionRig, ShapeName, TransmissionBench};
use bench::simulate::{LOADS_N, record};
use bench::{BearingMaterial, Channel};
use model_quant::report::claims::torque::{self, TorqueCurve};
use report::figure::{Series as Curve, Style, lines};
use report::heat::{self, Heat, Scale};

/// Seed of the rig's records.
const SEED: u64 = 1;
/// Normal force of Fig. 3, N.
const NORMAL_N: f64 = 10e3;
/// Largest relative speed of Fig. 3, m/s, and points to each side.
const MAX_SPEED_M_S: f64 = 0.1;
const POINTS: i32 = 400;
/// Highest speed of the paper's rig, deg/s, and points of the networks' curves.
const MAX_DEG_S: f64 = 6.0;
const NETWORK_POINTS: usize = 60;
const MAP: (u32, u32) = (760, 280);

/// Fig. 3: the traditional friction laws, with the Babbitt bearing's coefficients at 10 kN.
pub(in crate::reproduction) fn laws(base: &TransmissionBench) -> Result<Vec<Picture>, CliError> {
    let mut bench = base.clone();
    bench.set_material(BearingMaterial::Babbitt);
    let speeds: Vec<f64> = (-POINTS..=POINTS)
        .filter(|i| *i != 0)
        .map(|i| MAX_SPEED_M_S * f64::from(i) / f64::from(POINTS))
        .collect();
    let curve = |name: &str, force_n: &dyn Fn(f64) -> f64| {
        Curve::through(name, speeds.iter().map(|v| (1e3 * v, v.signum() * force_n(v.abs()))).collect())
    };
    let coulomb_n = bench.friction.coulomb_coefficient * NORMAL_N;
    let coulomb = curve("Coulomb", &|_| coulomb_n);
    let mut stribeck = Vec::new();
    for (name, shape) in [("exponent 1, Tustin", ShapeName::Tustin), ("exponent 2, Gauss", ShapeName::Gauss)]
    {
        bench.friction.shape = shape;
        let law = bench.friction_law();
        stribeck.push(curve(name, &|v| law.coefficient(v) * NORMAL_N));
    }
    let axes = ("relative velocity, mm/s", "friction force, N");
    Ok(vec![
        Picture::draw(
            lines,
            "friction-coulomb",
            &chart("Fig. 3 (a) Coulomb friction, Babbitt, 10 kN", axes.0, axes.1),
            &[coulomb],
            "The force depends on the direction alone.",
        )?,
        Picture::draw(
            lines,
            "friction-stribeck",
            &chart("Fig. 3 (b) Stribeck friction, Babbitt, 10 kN", axes.0, axes.1),
            &stribeck,
            "The force falls with the speed; both exponents end at Coulomb's force.",
        )?,
    ])
}

/// Figs. 6 and 7: angular velocity and friction torque over a record of the rig, by load.
pub(in crate::reproduction) fn records(
    bearing: BearingMaterial,
    number: u32,
) -> Result<Vec<Picture>, CliError> {
    let mut pictures = Vec::new();
    let loads = LOADS_N.into_iter().filter(|load| *load > 0.0);
    for (load_n, letter) in loads.zip(["a", "b", "c", "d"]) {
        let mut rig = FrictionRig::open(&format!("friction-rig-{}", bearing.name()))?;
        rig.load.force_n = load_n;
        rig.axis.cycles = 1;
        let log = record(&rig.into(), SEED)?;
        let channel = |channel: Channel, factor: f64| -> Vec<(f64, f64)> {
            let values = log.channels.get(&channel).map(Vec::as_slice).unwrap_or_default();
            log.time_s.iter().copied().zip(values.iter().map(|v| factor * v)).collect()
        };
        let kilonewtons = load_n * 1e-3;
        if letter == "a" {
            let speed = channel(Channel::SpindleSpeed, 1.0_f64.to_degrees());
            let title = format!("Fig. {number} Angular velocity of the spindle");
            pictures.push(Picture::draw(
                lines,
                &format!("rig-{}-speed", bearing.name()),
                &chart(&title, "time, s", "angular velocity, deg/s"),
                &[Curve::through("angular velocity", speed)],
                "The same at every load: a sine of 6 deg/s and 40 s.",
            )?);
        }
        let torque = channel(Channel::FrictionTorque, 1e-3);
        let title = format!("Fig. {number} ({letter}) Friction torque, {kilonewtons} kN, {}", bearing.name());
        pictures.push(Picture::draw(
            lines,
            &format!("rig-{}-torque-{kilonewtons}-kn", bearing.name()),
            &chart(&title, "time, s", "friction torque, kN m"),
            &[Curve::through("friction torque", torque)],
            "As logged, with outliers; the step is the break-away after the standstill.",
        )?);
    }
    Ok(pictures)
}

fn degrees(speed_m_s: f64, radius_m: f64) -> f64 {
    (speed_m_s / radius_m).to_degrees()
}

/// Figs. 12 and 13: friction torque over load and angular velocity, from the rig's records, and
/// from the shipped networks at the loads of the bench.
pub(in crate::reproduction) fn characteristics(radius_m: f64) -> Result<[Vec<Picture>; 2], CliError> {
    let failed = |e: &dyn std::fmt::Display| CliError::Work(e.to_string());
    let rigs = torque::measure_rigs_from_standstill().map_err(|e| failed(&e))?;
    let speeds: Vec<f64> = (1..=NETWORK_POINTS)
        .map(|i| radius_m * (MAX_DEG_S * i as f64 / NETWORK_POINTS as f64).to_radians())
        .collect();
    let networks = torque::network_curves(&speeds).map_err(|e| failed(&e))?;
    let (mut maps, mut curves) = (Vec::new(), Vec::new());
    let babbitt = (BearingMaterial::Babbitt, "a", &rigs.babbitt, &networks.babbitt);
    let plastic = (BearingMaterial::Plastic, "b", &rigs.plastic, &networks.plastic);
    let captions = [
        "Medians of the rig's records by load: the torque falls with the speed, further at higher load.",
        "Medians of the rig's records by load: level at low speed, rising at high speed.",
    ];
    for ((bearing, letter, measured, network), caption) in [babbitt, plastic].into_iter().zip(captions) {
        maps.push(map(measured, bearing, letter, radius_m)?);
        let series: Vec<Curve> =
            measured.iter().rev().map(|curve| line(curve, radius_m, 1e-3).styled(Style::Both)).collect();
        let title = format!("Fig. 13 ({letter}) Torque over angular velocity, {}", bearing.name());
        curves.push(Picture::draw(
            lines,
            &format!("torque-over-velocity-{}", bearing.name()),
            &chart(&title, "relative angular velocity, deg/s", "friction torque, kN m"),
            &series,
            caption,
        )?);
        let law = bearing.friction_law();
        let mut series: Vec<Curve> = network.iter().rev().map(|curve| line(curve, radius_m, 1.0)).collect();
        let points = network.iter().flat_map(|curve| {
            let at = |v: &f64| (degrees(*v, radius_m), radius_m * law.force_n(curve.load_n, *v).abs());
            speeds.iter().step_by(6).map(at).collect::<Vec<_>>()
        });
        series.push(Curve::through("law", points.collect()).styled(Style::Points));
        let title = format!("Fig. 13 ({letter}) from the shipped networks, {}", bearing.name());
        curves.push(Picture::draw(
            lines,
            &format!("torque-over-velocity-networks-{}", bearing.name()),
            &chart(&title, "relative angular velocity, deg/s", "friction torque, N m"),
            &series,
            "Loads of the bench. The torque rises at first: the sign of the friction is regularised over \
             1 mm/s, which is .8 deg/s.",
        )?);
    }
    Ok([maps, curves])
}

fn line(curve: &TorqueCurve, radius_m: f64, factor: f64) -> Curve {
    let points = curve.points.iter().map(|(v, t)| (degrees(*v, radius_m), factor * t)).collect();
    Curve::through(format!("{:.0} kN", curve.load_n * 1e-3), points)
}

/// Fig. 12: the torque as a map.
fn map(
    curves: &[TorqueCurve],
    bearing: BearingMaterial,
    letter: &str,
    radius_m: f64,
) -> Result<Picture, CliError> {
    let values: Vec<Vec<Option<f64>>> =
        curves.iter().rev().map(|c| c.points.iter().map(|p| Some(1e-3 * p.1)).collect()).collect();
    let largest = values.iter().flatten().flatten().fold(0.0_f64, |max, v| max.max(v.abs()));
    let title = format!("Fig. 12 ({letter}) Friction torque in kN m, {}", bearing.name());
    let columns = curves.first().map(|c| &c.points);
    let columns = columns.into_iter().flatten().map(|p| format!("{:.2}", degrees(p.0, radius_m))).collect();
    let heat = Heat {
        title: &title,
        x: "relative angular velocity, deg/s",
        y: "load, kN",
        columns,
        rows: curves.iter().rev().map(|c| format!("{:.0}", c.load_n * 1e-3)).collect(),
        values,
        scale: Scale::Limit(largest.max(f64::MIN_POSITIVE)),
        decimals: 2,
        size: MAP,
    };
    let drawing = heat::draw(&heat).map_err(CliError::Work)?;
    let caption = "Medians of the rig's records, both directions; darker is larger. Without load the torque \
                   is sensor drift.";
    Ok(Picture { name: format!("torque-map-{}", bearing.name()), caption: caption.into(), drawing })
}
