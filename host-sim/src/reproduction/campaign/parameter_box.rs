//! The parameter box, and its draws by Latin hypercube sampling.
//!
//! The paper states none of these parameters for its bench. Ranges are logarithmic and contain the
//! default of bench B. Draws come in blocks of [`BLOCK`]: in every block, each `1/BLOCK` of a
//! parameter's range has exactly one draw (McKay, Beckman and Conover 1979). A block has its own
//! random streams, so a draw does not depend on the number of draws.

use crate::cli::error::CliError;
use bench::description::{StiffnessName, TransmissionBench};
use contact::StiffnessKind;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::{Deserialize, IntoDeserializer, value};

/// Draws of a block.
pub const BLOCK: usize = 50;
/// Number of parameters.
pub const PARAMETERS: usize = 9;

/// Values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Values {
    /// Any value between two, evenly by its logarithm.
    Between(f64, f64),
    /// One of some names, each equally often.
    OneOf(&'static [&'static str]),
}

/// A parameter of the box.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize)]
pub struct Parameter {
    /// Short name for tables and maps.
    pub name: &'static str,
    /// Description with unit.
    pub description: &'static str,
    /// Field of the bench description.
    pub field: &'static str,
    /// Values.
    pub values: Values,
}

const fn range(
    name: &'static str,
    description: &'static str,
    field: &'static str,
    from: f64,
    to: f64,
) -> Parameter {
    Parameter { name, description, field, values: Values::Between(from, to) }
}

const fn choice(
    name: &'static str,
    description: &'static str,
    field: &'static str,
    names: &'static [&'static str],
) -> Parameter {
    Parameter { name, description, field, values: Values::OneOf(names) }
}

/// The box.
pub(crate) const BOX: [Parameter; PARAMETERS] = [
    range("floor", "floor or reference of the damping, m/s", "contact.latch_floor_m_s", 1e-3, 0.2),
    choice("damping", "reference of the damping", "contact.damping", &["latched", "reference"]),
    choice(
        "stiffness",
        "stiffness law of the contact",
        "contact.stiffness",
        &["hybrid-as-printed", "liu-times-length", "pereira"],
    ),
    range("J", "moment of inertia of the shaft, kg m2", "shaft.inertia_kg_m2", 30.0, 120.0),
    range("m", "mass of the shaft, kg", "shaft.mass_kg", 75.0, 300.0),
    range("period", "period of the drive, s", "drive.period_s", 0.5, 2.0),
    range("ramp", "ramp of the load, s", "load.ramp_s", 0.02, 0.2),
    range("friction", "factor on the friction of both bearings", "friction.level", 0.5, 2.0),
    range("sign width", "width of the regularised sign, m/s", "friction.regularisation_m_s", 2e-4, 5e-3),
];

/// One point of the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// Number, from 0.
    pub index: usize,
    /// Values in the order of [`BOX`]; the number of the name for a choice.
    pub values: [f64; PARAMETERS],
}

impl Draw {
    /// Returns the draw of a number under a seed.
    pub fn new(seed: u64, index: usize) -> Self {
        let (block, place) = (index / BLOCK, index % BLOCK);
        let mut values = [0.0; PARAMETERS];
        for (number, (value, parameter)) in values.iter_mut().zip(BOX).enumerate() {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream((block * PARAMETERS + number) as u64);
            *value = parameter.values.at(stratified(&mut rng, place));
        }
        Self { index, values }
    }

    /// Applies the draw to a bench. It has to be the last change: a bearing material brings its own
    /// friction.
    pub fn apply(&self, bench: &mut TransmissionBench) -> Result<(), CliError> {
        let [floor, damping, stiffness, inertia, mass, period, ramp, friction, sign_width] = self.values;
        let name = |parameter: usize, value: f64| BOX.get(parameter).map_or("", |p| p.values.name(value));
        bench.contact.latch_floor_m_s = floor;
        bench.contact.damping = Deserialize::deserialize(name(1, damping).into_deserializer())
            .map_err(|e: value::Error| CliError::Work(e.to_string()))?;
        let stiffness = name(2, stiffness);
        let kind = StiffnessKind::from_name(stiffness);
        bench.contact.stiffness =
            StiffnessName(kind.ok_or_else(|| CliError::Work(format!("no stiffness `{stiffness}`")))?);
        bench.shaft.inertia_kg_m2 = inertia;
        bench.shaft.mass_kg = mass;
        bench.drive.period_s = period;
        bench.load.ramp_s = ramp;
        bench.friction.level = friction;
        bench.friction.regularisation_m_s = sign_width;
        Ok(())
    }
}

impl Values {
    /// Value at a share of the range from 0 to 1.
    fn at(self, share: f64) -> f64 {
        match self {
            Self::Between(from, to) => from * (to / from).powf(share),
            Self::OneOf(names) => (share * names.len() as f64).floor().min(names.len() as f64 - 1.0),
        }
    }

    /// Share of the range below a value, from 0 to 1.
    pub(crate) fn share(self, value: f64) -> f64 {
        match self {
            Self::Between(from, to) => (value / from).ln() / (to / from).ln(),
            Self::OneOf(names) => (value + 0.5) / names.len() as f64,
        }
    }

    /// Name of a choice's value; empty for a range.
    pub(crate) fn name(self, value: f64) -> &'static str {
        match self {
            Self::Between(..) => "",
            Self::OneOf(names) => names.get(value as usize).copied().unwrap_or_default(),
        }
    }
}

/// Draw number `place` of a block: its stratum from a random permutation, and a random place in it.
fn stratified(rng: &mut ChaCha8Rng, place: usize) -> f64 {
    let mut strata: Vec<usize> = (0..BLOCK).collect();
    for last in (1..BLOCK).rev() {
        let other = (uniform(rng) * (last + 1) as f64) as usize;
        strata.swap(last, other.min(last));
    }
    let within = (0..=place).fold(0.0, |_, _| uniform(rng));
    let stratum = strata.get(place).copied().unwrap_or_default();
    (stratum as f64 + within) / BLOCK as f64
}

fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_has_one_draw_in_every_stratum_and_blocks_differ() {
        let draws: Vec<Draw> = (0..2 * BLOCK).map(|index| Draw::new(7, index)).collect();
        for (number, parameter) in BOX.iter().enumerate() {
            for block in draws.chunks(BLOCK) {
                let shares: Vec<f64> =
                    block.iter().map(|d| parameter.values.share(d.values[number])).collect();
                match parameter.values {
                    Values::Between(..) => {
                        let mut strata: Vec<usize> =
                            shares.iter().map(|s| (s * BLOCK as f64) as usize).collect();
                        strata.sort_unstable();
                        assert_eq!(strata, (0..BLOCK).collect::<Vec<_>>(), "{}", parameter.name);
                    }
                    Values::OneOf(names) => {
                        for option in 0..names.len() {
                            let count = block.iter().filter(|d| d.values[number] == option as f64).count();
                            assert!(count.abs_diff(BLOCK / names.len()) <= 1, "{}: {count}", parameter.name);
                        }
                    }
                }
            }
        }
        assert!(draws.iter().take(BLOCK).zip(draws.iter().skip(BLOCK)).all(|(a, b)| a.values != b.values));
        assert_ne!(Draw::new(7, 3), Draw::new(8, 3));
    }

    /// Value of a dotted field in the description of a bench.
    fn field(bench: &TransmissionBench, path: &str) -> Option<toml::Value> {
        let table: toml::Table = bench::Bench::from(bench.clone()).to_toml().unwrap().parse().unwrap();
        let (section, name) = path.split_once('.').unwrap();
        table.get(section)?.get(name).cloned()
    }

    #[test]
    fn the_box_contains_bench_b() {
        let bench = TransmissionBench::open("bench-b").unwrap();
        for parameter in BOX {
            let found = field(&bench, parameter.field);
            match parameter.values {
                Values::Between(from, to) => {
                    let found = found.and_then(|value| value.as_float()).unwrap();
                    assert!(from <= found && found <= to, "{}: {found}", parameter.field);
                }
                // A description leaves out the latched damping.
                Values::OneOf(names) => {
                    let found = found.and_then(|value| value.as_str().map(str::to_owned));
                    assert_eq!(found.as_deref().unwrap_or("latched"), names[0]);
                }
            }
        }
    }

    #[test]
    fn every_value_reaches_its_field() {
        let draw = Draw { index: 0, values: [0.01, 1.0, 1.0, 31.0, 76.0, 0.6, 0.03, 0.7, 4e-4] };
        let mut bench = TransmissionBench::open("bench-b").unwrap();
        draw.apply(&mut bench).unwrap();
        for (parameter, value) in BOX.iter().zip(draw.values) {
            let found = field(&bench, parameter.field).unwrap();
            match parameter.values {
                Values::Between(..) => assert_eq!(found.as_float(), Some(value), "{}", parameter.field),
                Values::OneOf(_) => assert_eq!(found.as_str(), Some(parameter.values.name(value))),
            }
        }
    }
}
