//! Operating points, and the worlds of each.

use crate::cli::error::CliError;
use crate::run::conditions::variant;
use ::worlds::random::subseed;
use ::worlds::{Bearing, Deviations, Parameter, Sensors, World};
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

/// Bearings that have a world, in the order of the paper.
const BEARINGS: [Bearing; 2] = [Bearing::Babbitt, Bearing::Plastic];
const CLEARANCES_MM: [f64; 2] = [0.1, 0.5];
const LOADS_KN: [f64; 2] = [10.0, -5.0];

/// Operating point of bench B.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OperatingPoint {
    /// Bearing of the world; written as the name of its material.
    #[serde(serialize_with = "by_material")]
    #[schemars(with = "String")]
    pub bearing: Bearing,
    /// Described radial clearance.
    pub clearance_mm: f64,
    /// Load along +Y.
    pub load_kn: f64,
}

fn by_material<S: Serializer>(bearing: &Bearing, serializer: S) -> Result<S::Ok, S::Error> {
    material_of(*bearing).serialize(serializer)
}

/// Returns the material of a world's bearing. A material without a world is not measured here.
const fn material_of(bearing: Bearing) -> BearingMaterial {
    match bearing {
        Bearing::Babbitt => BearingMaterial::Babbitt,
        Bearing::Plastic => BearingMaterial::Plastic,
    }
}

impl OperatingPoint {
    /// Every operating point.
    pub fn all() -> Vec<Self> {
        let loads = |bearing, clearance_mm| LOADS_KN.map(|load_kn| Self { bearing, clearance_mm, load_kn });
        let clearances = |bearing| CLEARANCES_MM.into_iter().flat_map(move |mm| loads(bearing, mm));
        BEARINGS.into_iter().flat_map(clearances).collect()
    }

    /// Describes the operating point.
    pub fn name(&self) -> String {
        format!("{}, {} mm, {:+} kN", self.material().name(), self.clearance_mm, self.load_kn)
    }

    /// Bearing material.
    pub const fn material(&self) -> BearingMaterial {
        material_of(self.bearing)
    }

    /// Returns the bench as the estimators know it. The clearance is as uncertain as the worlds are
    /// drawn: by 10 um at every clearance.
    pub(crate) fn described_bench(&self) -> Result<TransmissionBench, CliError> {
        let base = TransmissionBench::open("bench-b")?;
        let mut bench = variant(&base, self.material(), self.clearance_mm, self.load_kn).resolved();
        let drawn_m = Deviations::BENCH_B.clearance_m;
        bench.common.uncertain.insert("bearing.radial_clearance_m".into(), drawn_m);
        Ok(bench)
    }

    /// Returns the same bench as a world.
    pub(crate) const fn described_world(&self) -> World {
        World::bench_b(self.bearing, 1e-3 * self.clearance_mm, 1e3 * self.load_kn)
    }
}

/// Kind of world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Set {
    /// The described bench.
    Exact,
    /// Every uncertain parameter drawn from its declared distribution.
    Drawn,
    /// One uncertain parameter off by one declared deviation.
    SingleParameter,
    /// An effect that no description contains.
    Robustness,
}

/// A world with its sensors.
#[derive(Clone, Debug)]
pub struct RealWorld {
    /// Name, unique within an operating point.
    pub name: String,
    /// Kind.
    pub set: Set,
    /// Parameters.
    pub world: World,
    /// Sensors.
    pub sensors: Sensors,
}

/// Returns the worlds of an operating point, the exact one first.
pub fn worlds(point: &OperatingPoint, draws: u32, seed: u64) -> Vec<RealWorld> {
    let (exact, sensors) = (point.described_world(), Sensors::BENCH_B);
    let declared = Deviations::BENCH_B;
    let real = |name: String, set, world| RealWorld { name, set, world, sensors };
    let mut worlds = vec![real("exact".into(), Set::Exact, exact)];
    let seed = subseed(seed, &point.name());
    worlds.extend((1..=draws).map(|draw| {
        let name = format!("draw-{draw}");
        let world = exact.draw(subseed(seed, &name), &declared);
        real(name, Set::Drawn, world)
    }));
    worlds.extend(Parameter::ALL.into_iter().flat_map(|parameter| {
        [("+", 1.0), ("-", -1.0)].map(|(sign, count)| {
            let name = format!("{}{sign}", parameter.name());
            real(name, Set::SingleParameter, exact.moved(parameter, &declared, count))
        })
    }));
    let robust =
        |name: &str, world, sensors| RealWorld { sensors, ..real(name.into(), Set::Robustness, world) };
    worlds.extend([
        robust(STRIBECK_RISE, World { stribeck_rise: 0.06, stribeck_rise_speed_m_s: 0.01, ..exact }, sensors),
        robust(CORRELATED_NOISE, exact, Sensors { noise_correlation: 0.9, ..sensors }),
        robust(POSITION_DELAY, exact, Sensors { position_delay_s: 100e-6, ..sensors }),
        robust(LAW_EXPONENT, World { exponent_change: 0.15, ..exact }, sensors),
        robust(DRIVE_LAG, World { drive_lag_s: 1e-3, ..exact }, sensors),
    ]);
    worlds
}

/// Friction coefficient larger by .06 at standstill; the rise decays over 10 mm/s.
pub(crate) const STRIBECK_RISE: &str = "stribeck-rise";
/// Sensor noise with a correlation of .9 from reading to reading.
pub(crate) const CORRELATED_NOISE: &str = "correlated-noise";
/// Position probes late by 100 us.
pub(crate) const POSITION_DELAY: &str = "position-delay";
/// Exponent of the elastic force larger by .15.
pub(crate) const LAW_EXPONENT: &str = "law-exponent";
/// Drive late by 1 ms.
pub(crate) const DRIVE_LAG: &str = "drive-lag";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deviations_are_those_that_the_preset_declares() {
        let bench = TransmissionBench::open("bench-b").unwrap();
        let declared = |name: &str| bench.common.uncertain[name];
        let own = Deviations::BENCH_B;
        let pairs = [
            (own.clearance_m, declared("bearing.radial_clearance_m")),
            (own.modulus_share * 50e9, declared("bearing.youngs_modulus_pa")),
            (own.inertia_share * 60.0, declared("shaft.inertia_kg_m2")),
            (own.mass_share * 150.0, declared("shaft.mass_kg")),
            (own.friction_share, declared("friction.level")),
            (own.lever_share * 0.30, declared("geometry.drive_lever_radius_m")),
            (own.lever_share * 0.36, declared("geometry.load_lever_radius_m")),
        ];
        for (own, declared) in pairs {
            assert!((own / declared - 1.0).abs() < 1e-9, "{own} {declared}");
        }
        assert_eq!(bench.common.uncertain.len(), pairs.len());
        for point in OperatingPoint::all() {
            let described = point.described_bench().unwrap();
            assert_eq!(
                described.common.uncertain["bearing.radial_clearance_m"], own.clearance_m,
                "{point:?}"
            );
        }
    }

    #[test]
    fn every_world_of_an_operating_point_has_its_own_name_and_its_own_truth() {
        let worlds = worlds(&OperatingPoint::all()[0], 3, 1);
        assert_eq!(worlds.len(), 1 + 3 + 14 + 5);
        for (index, a) in worlds.iter().enumerate() {
            for b in &worlds[..index] {
                assert_ne!(a.name, b.name);
                assert!(a.world != b.world || a.sensors != b.sensors, "{} {}", a.name, b.name);
            }
        }
    }
}
