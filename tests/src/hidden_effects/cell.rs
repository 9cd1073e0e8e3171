//! The cells of the matrix: what is hidden, how large, on which plant, with which seed.

use super::pairs::PAIRS;
use crate::generator::conditions::Conditions;
use crate::generator::session::Plant;
use crate::generator::vocabulary::effects;
use serde::{Deserialize, Serialize};

/// What a cell asks.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Arm {
    /// No effect: coloured noise, another operating point, numbers off by up to two deviations.
    Clean,
    /// One effect.
    Single,
    /// One effect that the engine's library lacks.
    Deleted,
    /// Two effects at once.
    Two,
    /// An effect that looks like another one on this motion.
    Pair,
    /// The same question asked in another way.
    Changed,
    /// No effect or one, on an axis under hard conditions: rests, a narrow sign, coarse readings.
    Hard,
}

impl Arm {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Clean, Self::Single, Self::Deleted, Self::Two, Self::Pair, Self::Changed, Self::Hard];
}

/// One cell with one seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Number in its campaign.
    pub index: usize,
    /// What it asks.
    pub arm: Arm,
    /// Plant.
    pub plant: Plant,
    /// Effects; of a pair the hidden one first.
    pub effects: Vec<String>,
    /// Wanted sizes of the hidden effects.
    pub sizes: Vec<f64>,
    /// Which way a question is asked again.
    pub variant: usize,
    /// Seed.
    pub seed: u64,
}

impl Cell {
    /// What the cell is, in words; the same for every seed.
    pub fn words(&self) -> String {
        format!(
            "{:?} {} {} {:?} {}",
            self.arm,
            self.plant.name(),
            self.effects.join("+"),
            self.sizes,
            self.variant
        )
    }

    /// Under which conditions its logs are made.
    pub fn conditions(&self) -> Conditions {
        if self.arm == Arm::Hard { Conditions::Hard } else { Conditions::Usual }
    }

    /// The seed of its random draws.
    pub fn stream(&self) -> u64 {
        let name = super::seal::name_of(&self.words(), self.seed);
        u64::from_str_radix(name.get(..16).unwrap_or("0"), 16).unwrap_or(self.seed)
    }
}

/// A campaign: which cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Campaign {
    /// Seeds of every cell on an axis.
    pub seeds: u64,
    /// Seeds of every cell on the transmission bench.
    pub bench_seeds: u64,
    /// Seeds that are passed over before the first.
    #[serde(default, skip_serializing_if = "none")]
    pub skipped_seeds: u64,
    /// Plants.
    pub plants: Vec<Plant>,
    /// Sizes of single effects.
    pub sizes: Vec<f64>,
    /// Arms.
    pub arms: Vec<Arm>,
    /// Whether the transmission benches, a cell of which costs fifty times as much, show only what no plant before them can, one effect at a time.
    #[serde(default, skip_serializing_if = "no")]
    pub bench_alone: bool,
}

fn no(alone: &bool) -> bool {
    !alone
}

fn none(skipped: &u64) -> bool {
    *skipped == 0
}

/// Sizes of two effects at once: alike, and three to one.
const TWO: [[f64; 2]; 2] = [[1.0, 1.0], [1.5, 0.5]];
/// Size at which a cause is deleted, and of one of a pair.
const CLEAR: f64 = 1.0;
/// The least size of an effect: play between stiff faces is never small, for the faces give way to any of it.
fn least(effect: &str) -> f64 {
    if effect == "fork-backlash" { 10.0 } else { 0.0 }
}

/// Clean logs per seed.
const CLEAN: usize = 10;
/// The same under hard conditions.
const CLEAN_HARD: usize = 6;

impl Campaign {
    /// The part that runs with every change: each effect once, and each question on the axes.
    pub fn quick() -> Self {
        Self {
            seeds: 1,
            bench_seeds: 1,
            skipped_seeds: 0,
            plants: Plant::ALL.to_vec(),
            sizes: vec![1.0],
            arms: Arm::ALL.to_vec(),
            bench_alone: true,
        }
    }

    /// Whether of a plant only what no other one shows is asked for.
    fn is_alone(&self, plant: Plant) -> bool {
        self.bench_alone && plant.is_transmission()
    }

    /// The cells, seed by seed and shuffled within one, so that a campaign that is cut short is a fair sample.
    pub fn cells(&self) -> Vec<Cell> {
        let mut cells = Vec::new();
        for seed in 1..=self.seeds.max(self.bench_seeds) {
            for &plant in &self.plants {
                let seeds = if plant.is_transmission() { self.bench_seeds } else { self.seeds };
                let is_asked = |arm: &&Arm| seed <= seeds && (**arm == Arm::Single || !self.is_alone(plant));
                for &arm in self.arms.iter().filter(is_asked) {
                    self.arm(&mut cells, arm, plant, self.skipped_seeds + seed);
                }
            }
        }
        cells.sort_by_cached_key(|c| (c.seed, super::seal::name_of(&c.words(), c.seed)));
        cells.iter_mut().enumerate().for_each(|(i, c)| c.index = i);
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
                    let mut sizes: Vec<f64> = self.sizes.iter().map(|s| s.max(least(effect))).collect();
                    sizes.dedup();
                    sizes.iter().filter(|s| **s > 0.0).for_each(|size| add(&[effect], &[*size], 0));
                }
            }
            Arm::Deleted => all.iter().for_each(|effect| add(&[effect], &[CLEAR.max(least(effect))], 0)),
            Arm::Two => {
                // Each effect with a partner that moves on by one from seed to seed.
                for (i, effect) in all.iter().enumerate() {
                    let partner = all[(i + seed as usize) % all.len()];
                    if partner != *effect {
                        let [first, second] = TWO[(i + seed as usize / all.len()) % TWO.len()];
                        let sizes = [first.max(least(effect)), second.max(least(partner))];
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
                    (0..super::changed::CHANGES.len()).for_each(|variant| {
                        let effect =
                            ["viscous-friction", "sensor-delay", "coulomb-asymmetry", "position-ripple"]
                                [(seed as usize + variant) % 4];
                        let size = if super::changed::CHANGES[variant] == "shuffled" { 0.3 } else { CLEAR };
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
    fn what_a_description_declares_is_what_the_generator_reads_with() {
        for plant in Plant::ALL {
            for conditions in [Conditions::Usual, Conditions::Hard] {
                let bench = Bench::parse("bench", conditions.description(plant)).unwrap();
                for reading in conditions.sensors(plant) {
                    // What drives the transmission bench is read without an error worth declaring.
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
    fn play_is_asked_for_once_where_all_sizes_are_below_its_least() {
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
    fn the_quick_campaign_hides_every_effect_and_each_on_the_cheapest_plant() {
        let cells = Campaign::quick().cells();
        let alone: Vec<&Cell> = cells.iter().filter(|c| c.arm == Arm::Single).collect();
        for kind in bench::effects::CATALOGUE {
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
