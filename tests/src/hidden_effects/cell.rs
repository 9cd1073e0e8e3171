//! Cells of the matrix: hidden effects, their sizes, plant and seed.

use crate::generator::conditions::Conditions;
use crate::generator::plant::Plant;
use crate::generator::vocabulary::effects;
use crate::random::mix;
use serde::{Deserialize, Serialize};

/// Pairs by plant.
pub const PAIRS: &[(Plant, &str, &str)] = &[
    (Plant::Linear, "coulomb-level", "load-dependent-friction"),
    (Plant::Linear, "drive-lag", "sensor-delay"),
    (Plant::Linear, "inertia-mismatch", "spring-effort"),
    (Plant::Rotary, "coulomb-level", "load-dependent-friction"),
];
/// Changes, in the order of a cell's variants.
pub(crate) const CHANGES: [&str; 7] = ["units", "time", "order", "twice", "more", "shuffled", "counter"];

/// Kind of a cell: what is hidden, and what the diagnosis must find.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Arm {
    /// No effect: coloured noise, other operating points, parameters off by up to two deviations.
    Clean,
    /// One effect.
    Single,
    /// One effect that the engine's library lacks.
    Deleted,
    /// Two effects at once.
    Two,
    /// One effect that looks like another one on this motion.
    Pair,
    /// No effect or one, with the same log in another form: the result must not change.
    Changed,
    /// No effect or one, on an axis under hard conditions: standstill, a steep sign function of
    /// friction, coarse readings.
    Hard,
}

impl Arm {
    /// All arms.
    pub const ALL: [Self; 7] =
        [Self::Clean, Self::Single, Self::Deleted, Self::Two, Self::Pair, Self::Changed, Self::Hard];
}

/// One simulated diagnosis: effects, plant and seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Number in the campaign.
    pub index: usize,
    /// Kind.
    pub arm: Arm,
    /// Plant.
    pub plant: Plant,
    /// Effects; of a pair, the hidden one comes first.
    pub effects: Vec<String>,
    /// Requested sizes of the hidden effects.
    pub sizes: Vec<f64>,
    /// Variant, for arms that have several.
    pub variant: usize,
    /// Seed.
    pub seed: u64,
}

impl Cell {
    /// Describes the cell without its seed. The text determines the random draws, so it must not
    /// change.
    pub fn describe(&self) -> String {
        format!(
            "{:?} {} {} {:?} {}",
            self.arm,
            self.plant.name(),
            self.effects.join("+"),
            self.sizes,
            self.variant
        )
    }

    /// Returns the conditions of its logs.
    pub fn conditions(&self) -> Conditions {
        if self.arm == Arm::Hard { Conditions::Hard } else { Conditions::Usual }
    }

    /// Returns the seed of its random draws.
    pub fn stream(&self) -> u64 {
        hash(&self.describe(), self.seed)
    }
}

/// Returns a hash of a text and a seed.
pub(super) fn hash(text: &str, seed: u64) -> u64 {
    let start = 0x243f_6a88_85a3_08d3 ^ seed;
    text.bytes()
        .fold(start, |hash, byte| mix(hash.rotate_left(7) ^ u64::from(byte)).wrapping_add(0x9e37_79b9))
}

/// Selection of cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Campaign {
    /// Number of seeds of every cell on an axis.
    pub seeds: u64,
    /// Number of seeds of every cell on a transmission bench.
    pub bench_seeds: u64,
    /// Number of seeds to skip before the first.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub skipped_seeds: u64,
    /// Plants.
    pub plants: Vec<Plant>,
    /// Sizes of single effects.
    pub sizes: Vec<f64>,
    /// Arms.
    pub arms: Vec<Arm>,
    /// True if a transmission bench shows single effects only, and only those that no cheaper plant
    /// can show. One of its cells costs as much as fifty of an axis.
    #[serde(default, skip_serializing_if = "is_false")]
    pub bench_alone: bool,
    /// True if a third is left of the cells on a transmission bench, and of those that are neither
    /// a single effect, a pair nor under hard conditions.
    #[serde(default, skip_serializing_if = "is_false")]
    pub is_sample: bool,
}

fn is_false(alone: &bool) -> bool {
    !alone
}

fn is_zero(skipped: &u64) -> bool {
    *skipped == 0
}

/// Sizes of two effects at once: equal, and three to one.
const TWO: [[f64; 2]; 2] = [[1.0, 1.0], [1.5, 0.5]];
/// Size of a deleted cause, of one of a pair, and of a changed question.
const CLEAR: f64 = 1.0;
/// Minimum size of an effect. Play between stiff faces is never small, because the faces separate
/// at any play.
fn min_size(effect: &str) -> f64 {
    if effect == "fork-backlash" { 10.0 } else { 0.0 }
}

/// A sample takes one of so many cells.
const SAMPLED: usize = 3;
/// Clean logs for each seed.
const CLEAN: usize = 10;
/// Clean logs under hard conditions for each seed.
const CLEAN_HARD: usize = 6;

impl Campaign {
    /// Returns the campaign for a change of the engine: each effect once, and every question on the
    /// axes.
    pub fn quick() -> Self {
        Self {
            seeds: 1,
            bench_seeds: 1,
            skipped_seeds: 0,
            plants: Plant::ALL.to_vec(),
            sizes: vec![1.0],
            arms: Arm::ALL.to_vec(),
            bench_alone: true,
            is_sample: false,
        }
    }

    /// Returns the part of the quick campaign that is tested with every change.
    pub fn sample() -> Self {
        Self { is_sample: true, ..Self::quick() }
    }

    /// Returns whether a plant shows only effects that no cheaper plant can show.
    fn is_alone(&self, plant: Plant) -> bool {
        self.bench_alone && plant.is_transmission()
    }

    /// Returns the cells, seed by seed and shuffled within a seed. An interrupted campaign is then
    /// a fair sample.
    pub fn cells(&self) -> Vec<Cell> {
        let mut cells = Vec::new();
        for seed in 1..=self.seeds.max(self.bench_seeds) {
            for &plant in &self.plants {
                let seeds = if plant.is_transmission() { self.bench_seeds } else { self.seeds };
                let is_included =
                    |arm: &&Arm| seed <= seeds && (**arm == Arm::Single || !self.is_alone(plant));
                for &arm in self.arms.iter().filter(is_included) {
                    self.arm(&mut cells, arm, plant, self.skipped_seeds + seed);
                }
            }
        }
        cells.sort_by_cached_key(|c| (c.seed, c.stream()));
        cells.iter_mut().enumerate().for_each(|(i, c)| c.index = i);
        if self.is_sample {
            let is_always = |cell: &Cell| {
                matches!(cell.arm, Arm::Single | Arm::Pair | Arm::Hard) && !cell.plant.is_transmission()
            };
            cells.retain(|cell| is_always(cell) || cell.index.is_multiple_of(SAMPLED));
        }
        cells
    }

    fn arm(&self, cells: &mut Vec<Cell>, arm: Arm, plant: Plant, seed: u64) {
        let mut add = |effects: &[&str], sizes: &[f64], variant: usize| {
            let effects = effects.iter().map(|e| (*e).to_owned()).collect();
            cells.push(Cell { index: 0, arm, plant, effects, sizes: sizes.into(), variant, seed });
        };
        let mut all = effects(plant);
        if self.is_alone(plant) {
            let cheaper = Plant::ALL.into_iter().take_while(|p| *p != plant).flat_map(effects);
            let shown: Vec<&str> = cheaper.collect();
            all.retain(|effect| !shown.contains(effect));
        }
        match arm {
            Arm::Clean => (0..CLEAN).for_each(|variant| add(&[], &[], variant)),
            Arm::Single => {
                for effect in &all {
                    let mut sizes: Vec<f64> = self.sizes.iter().map(|s| s.max(min_size(effect))).collect();
                    sizes.dedup();
                    sizes.iter().filter(|s| **s > 0.0).for_each(|size| add(&[effect], &[*size], 0));
                }
            }
            Arm::Deleted => all.iter().for_each(|effect| add(&[effect], &[CLEAR.max(min_size(effect))], 0)),
            Arm::Two => {
                // The partner of an effect changes from seed to seed.
                for (i, effect) in all.iter().enumerate() {
                    let partner = all[(i + seed as usize) % all.len()];
                    if partner != *effect {
                        let [first, second] = TWO[(i + seed as usize / all.len()) % TWO.len()];
                        let sizes = [first.max(min_size(effect)), second.max(min_size(partner))];
                        add(&[effect, partner], &sizes, 0);
                    }
                }
            }
            Arm::Pair => {
                for pair in PAIRS.iter().filter(|p| p.0 == plant) {
                    add(&[pair.1, pair.2], &[CLEAR], 0);
                    add(&[pair.2, pair.1], &[CLEAR], 0);
                }
            }
            Arm::Hard => {
                if !plant.is_transmission() {
                    (0..CLEAN_HARD).for_each(|variant| add(&[], &[], variant));
                    all.iter().for_each(|effect| add(&[effect], &[CLEAR], 0));
                }
            }
            Arm::Changed => {
                if !plant.is_transmission() {
                    (0..CHANGES.len()).for_each(|variant| {
                        let effect =
                            ["viscous-friction", "sensor-delay", "coulomb-asymmetry", "position-ripple"]
                                [(seed as usize + variant) % 4];
                        let size = if CHANGES[variant] == "shuffled" { 0.3 } else { CLEAR };
                        add(&[effect], &[size], variant);
                    });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bench::Bench;

    #[test]
    fn the_generator_draws_with_the_declared_noise_and_deviations() {
        for plant in Plant::ALL {
            for conditions in [Conditions::Usual, Conditions::Hard] {
                let bench = Bench::parse("bench", conditions.description(plant)).unwrap();
                for reading in conditions.sensors(plant) {
                    // The inputs of the transmission bench are logged without a declared error.
                    let Some((_, sensor)) = bench.sensors().iter().find(|(c, _)| c.name() == reading.channel)
                    else {
                        assert!(plant.is_transmission() && !plant.outputs().contains(&reading.channel));
                        continue;
                    };
                    assert_eq!((sensor.noise, sensor.resolution), (reading.noise, reading.resolution));
                }
                let mut declared: Vec<f64> = bench.uncertain().values().copied().collect();
                let mut drawn = plant.deviations().to_vec();
                declared.sort_by(f64::total_cmp);
                drawn.sort_by(f64::total_cmp);
                assert_eq!(declared, drawn, "{plant:?}");
                let Bench::FrictionRig(rig) = bench else { continue };
                assert_eq!(rig.axis.regularisation_m_s, conditions.sign_width_m_s(plant));
                assert_eq!(rig.logging.sample_rate_hz, conditions.axis_rate_hz());
            }
        }
    }

    #[test]
    fn play_is_asked_for_once_if_all_sizes_are_below_its_minimum() {
        let campaign = Campaign { sizes: vec![0.1, 1.0, 5.0, 20.0], ..Campaign::quick() };
        let cells = campaign.cells();
        let of = |effect: &str| -> Vec<f64> {
            let mut sizes: Vec<f64> = cells
                .iter()
                .filter(|c| c.arm == Arm::Single && c.plant == Plant::Bench && c.effects == [effect])
                .flat_map(|c| c.sizes.clone())
                .collect();
            sizes.sort_by(f64::total_cmp);
            sizes
        };
        assert_eq!(of("fork-backlash"), [10.0, 20.0]);
        assert_eq!(of("squeeze-film"), [0.1, 1.0, 5.0, 20.0]);
    }

    #[test]
    fn a_sample_hides_every_effect_of_the_axes_and_asks_every_kind_of_question() {
        let (quick, sample) = (Campaign::quick().cells(), Campaign::sample().cells());
        assert!(sample.len() < quick.len() * 3 / 4 && sample.iter().all(|cell| quick.contains(cell)));
        let singles = |cells: &[Cell], is_transmission: bool| {
            let of = |cell: &&Cell| cell.plant.is_transmission() == is_transmission;
            cells.iter().filter(of).filter(|cell| cell.arm == Arm::Single).count()
        };
        assert_eq!(singles(&sample, false), singles(&quick, false));
        assert!(singles(&sample, true) >= 2, "{}", singles(&sample, true));
        assert!(Arm::ALL.iter().all(|arm| sample.iter().any(|cell| cell.arm == *arm)));
    }

    #[test]
    fn the_quick_campaign_hides_every_effect_and_each_on_the_cheapest_plant() {
        let cells = Campaign::quick().cells();
        let alone: Vec<&Cell> = cells.iter().filter(|c| c.arm == Arm::Single).collect();
        // Over the 0.8 rad of these records gravity is an offset with a spring; the test
        // `gravity_moment` hides it in wider swings.
        let is_shown = |name: &str| name != "gravity-moment";
        for kind in bench::effects::CATALOGUE.iter().filter(|kind| is_shown(kind.name)) {
            let plants: Vec<Plant> =
                alone.iter().filter(|c| c.effects == [kind.name]).map(|c| c.plant).collect();
            let on_bench = plants.iter().any(|p| p.is_transmission());
            assert!(!plants.is_empty() && (!on_bench || plants.len() == 1), "{}: {plants:?}", kind.name);
        }
        assert!(cells.iter().all(|c| !c.plant.is_transmission() || c.arm == Arm::Single));
        let on = |plant| cells.iter().filter(|c| c.plant == plant).count();
        assert_eq!((on(Plant::Bench), on(Plant::TwoPlane)), (10, 1));
    }
}
