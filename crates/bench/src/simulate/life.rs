//! Life of the bearing of a transmission bench: a settled duty cycle, its wear, a jump, repeated.
//!
//! The duty cycle runs with the analytic laws and the present clearance: the described one, its
//! thermal and swelling change, and the wear along the directions of the contact. The latter is the
//! mean over the time in contact of how much further the journal's centre gets before rigid
//! surfaces touch. The pressure is that of the worn profile ([`crate::life::foundation`]). The
//! plant itself knows a round clearance only, and is dry: a film carries a part of the force that
//! does not wear ([`crate::life::film`]) and changes neither motion nor friction.
//!
//! Directions of the contact in the last eight duties and the friction heat of the last one give
//! the clearance of the next.

use crate::description::{ThermalSection, TransmissionBench};
use crate::integrate::IntegrationError;
use crate::life::film::{FilmTable, MixedFilm};
use crate::life::foundation::{CELLS, Foundation, Unbalanced, layer_modulus_n_m3};
use crate::life::jump::{CyclicSystem, JumpControl, TooManyJumps, jump_cycles};
use crate::life::thermal::{Growth, Radii, clearance_change_m, uptake_share};
use crate::life::wear::{Load, Profile, Wear};
use crate::plants::transmission::Snapshot;
use crate::simulate::{DEFAULT_TOLERANCE, Run, run_bench_with_law};
use crate::statistics::mean;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

/// Samples of a cycle.
const SAMPLES_PER_CYCLE: f64 = 500.0;
/// Computed duties whose directions of the contact give the clearance. One alone would let the
/// clearance swing where the motion has two forms.
const RECENT_DUTIES: usize = 8;
/// Distance between the samples that give the directions.
const DIRECTION_STEP: usize = 8;
/// Smallest clearance with which a bench runs, m.
const MIN_CLEARANCE_M: f64 = 1e-6;
/// Error of a jump as a share of its largest change.
const TOLERATED: f64 = 0.1;
/// Jumps of a life at most.
const MAX_JUMPS: usize = 20_000;
/// Largest Poisson's ratio of a lining: a confined incompressible one does not yield.
const MAX_POISSON: f64 = 0.49;

/// Reason why a life cannot be computed.
#[derive(Clone, Debug, thiserror::Error)]
pub enum LifeError {
    /// The description does not allow a life: field, found, expected.
    #[error("{0}")]
    Description(String),
    /// A duty cycle failed.
    #[error("cycle {cycle:.0}: {source}")]
    Run {
        /// Cycle.
        cycle: f64,
        /// Error of the run.
        source: IntegrationError,
    },
    /// Heat or water have closed the clearance.
    #[error("cycle {cycle:.0}: the radial clearance is {clearance_m:e} m; expected at least 1e-6 m")]
    Seized {
        /// Cycle.
        cycle: f64,
        /// Clearance in m.
        clearance_m: f64,
    },
    /// The contact pressure was not found.
    #[error(transparent)]
    Unbalanced(#[from] Unbalanced),
    /// The jumps are too short.
    #[error(transparent)]
    TooManyJumps(#[from] TooManyJumps),
}

/// The bearing after a number of cycles.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize)]
pub struct LifePoint {
    /// Cycle.
    pub cycle: f64,
    /// Radial clearance in the directions of the contact.
    pub clearance_m: f64,
    /// Part of it by heat and water.
    pub thermal_change_m: f64,
    /// Largest depth of wear.
    pub largest_depth_m: f64,
    /// Worn volume of bearing and journal.
    pub wear_volume_m3: f64,
    /// Largest contact force at the samples of a duty.
    pub peak_force_n: f64,
    /// Largest friction torque at the samples of a duty.
    pub friction_torque_nm: f64,
    /// Friction heat of a cycle.
    pub heat_j: f64,
    /// Mean share of the contact force that the film carries.
    pub film_share: f64,
}

/// A simulated life.
#[derive(Clone, Debug)]
pub struct Life {
    /// Course over the cycles; ascending, from cycle 0 on.
    pub points: Vec<LifePoint>,
    /// Profile at every point.
    pub profiles: Vec<Profile>,
    /// Cycle at which the clearance reached its limit; none if the life did not reach it.
    pub limit_cycle: Option<f64>,
    /// Duties that were computed, of `life.duty_cycles` cycles each.
    pub computed: usize,
}

/// Loads of the cycles that count in a run, and their figures.
#[derive(Debug)]
struct Duty {
    loads: Vec<Load>,
    /// Clearance of the unworn bearing at its present temperature.
    base_m: f64,
    clearance_m: f64,
    peak_force_n: f64,
    friction_torque_nm: f64,
    heat_j: f64,
    film_share: f64,
}

/// The bearing of a bench over its life.
struct LifeModel {
    bench: TransmissionBench,
    settling: u32,
    duty_cycles: f64,
    wear: Wear,
    film: Option<MixedFilm>,
    thermal: Option<ThermalSection>,
    radii: Radii,
    /// Loads in contact of the last duties.
    recent: VecDeque<Vec<Load>>,
    /// Friction heat of a cycle of the last duty.
    heat_j: f64,
    computed: usize,
}

/// Radial clearance that ends the life of a bench, m.
pub fn limit_clearance_m(bench: &TransmissionBench) -> f64 {
    let described = bench.life.as_ref().and_then(|life| life.limit_clearance_m);
    described.unwrap_or(2.0 * bench.bearing.radial_clearance_m)
}

/// Computes the life of a bench for a number of cycles or up to its limit. `rate_factor` multiplies
/// the wear rates; `tick` gets the share of the life after every jump.
///
/// # Errors
///
/// The description does not allow a life, a duty cycle fails, or the clearance closes.
pub fn run_life(
    bench: &TransmissionBench,
    rate_factor: f64,
    mut tick: impl FnMut(f64),
) -> Result<Life, LifeError> {
    let mut model = LifeModel::new(bench, rate_factor)?;
    let section = bench.life.clone().unwrap_or_default();
    let (described_m, limit_m) = (bench.bearing.radial_clearance_m, limit_clearance_m(bench));
    let largest_change = section.jump_share * described_m;
    let control = JumpControl { largest_change, tolerance: TOLERATED * largest_change, max_jumps: MAX_JUMPS };
    let (mut points, mut profiles) = (Vec::new(), Vec::new());
    let (wear, end) = (model.wear.clone(), section.cycles);
    jump_cycles(&mut model, Profile::unworn(), end, &control, |cycle, profile, duty: &Duty| {
        points.push(LifePoint {
            cycle,
            clearance_m: duty.clearance_m,
            thermal_change_m: duty.base_m - described_m,
            largest_depth_m: profile.largest_depth_m(),
            wear_volume_m3: wear.volume_m3(profile),
            peak_force_n: duty.peak_force_n,
            friction_torque_nm: duty.friction_torque_nm,
            heat_j: duty.heat_j,
            film_share: duty.film_share,
        });
        profiles.push(profile.clone());
        let worn_share = (duty.clearance_m - described_m) / (limit_m - described_m).max(MIN_CLEARANCE_M);
        tick((cycle / end).max(worn_share).clamp(0.0, 1.0));
        duty.clearance_m < limit_m
    })?;
    Ok(Life { limit_cycle: crossing(&points, limit_m), points, profiles, computed: model.computed })
}

/// Cycle at which the clearance first reaches a value, between two points linearly.
fn crossing(points: &[LifePoint], limit_m: f64) -> Option<f64> {
    let after = points.iter().position(|point| point.clearance_m >= limit_m)?;
    let Some(before) = after.checked_sub(1) else { return Some(0.0) };
    let [from, to] = [&points[before], &points[after]];
    let share = (limit_m - from.clearance_m) / (to.clearance_m - from.clearance_m);
    Some(from.cycle + share * (to.cycle - from.cycle))
}

impl Life {
    /// Clearance in m at a cycle, between two points linearly; that of the last point beyond it.
    pub fn clearance_m(&self, cycle: f64) -> f64 {
        let after = self.points.partition_point(|point| point.cycle <= cycle);
        let at = |index: usize| self.points.get(index);
        match (after.checked_sub(1).and_then(at), at(after)) {
            (Some(from), Some(to)) => {
                let share = (cycle - from.cycle) / (to.cycle - from.cycle);
                from.clearance_m + share * (to.clearance_m - from.clearance_m)
            }
            (Some(point), None) | (None, Some(point)) => point.clearance_m,
            (None, None) => f64::NAN,
        }
    }
}

impl LifeModel {
    fn new(bench: &TransmissionBench, rate_factor: f64) -> Result<Self, LifeError> {
        let refuse = |text: String| Err(LifeError::Description(text));
        if bench.two_plane.is_some() {
            return refuse("two_plane: found a bench in two planes; expected a planar one for a life".into());
        }
        let bearing = &bench.bearing;
        if bearing.poisson_ratio > MAX_POISSON {
            let found = bearing.poisson_ratio;
            return refuse(format!("bearing.poisson_ratio: found {found}; expected at most {MAX_POISSON}"));
        }
        let section = bench.wear.clone().unwrap_or_default();
        let lining = bearing.material.lining();
        let journal_m = bearing.bearing_radius_m - bearing.radial_clearance_m;
        let lining_m = section.lining_thickness_m.unwrap_or(0.04 * 2.0 * journal_m + 2e-3);
        let modulus = layer_modulus_n_m3(bearing.youngs_modulus_pa, bearing.poisson_ratio, lining_m);
        let rate = section.specific_wear_rate_m3_nm.unwrap_or(lining.specific_wear_rate_m3_nm);
        let mut bench = bench.clone();
        let life = bench.life.clone().unwrap_or_default();
        bench.drive.cycles = life.settling_cycles.saturating_add(life.duty_cycles);
        Ok(Self {
            settling: life.settling_cycles,
            duty_cycles: f64::from(life.duty_cycles),
            wear: Wear {
                foundation: Foundation::new(modulus, bearing.bearing_radius_m, bearing.length_m),
                bearing_m3_nm: rate_factor * rate,
                journal_m3_nm: rate_factor * section.journal_wear_rate_m3_nm,
            },
            film: bench.film.as_ref().map(|film| MixedFilm {
                table: FilmTable::new(bearing.length_m / (2.0 * bearing.bearing_radius_m)),
                viscosity_pa_s: film.viscosity_pa_s,
                min_film_m: film.min_film_m,
                radius_m: bearing.bearing_radius_m,
                length_m: bearing.length_m,
            }),
            thermal: bench.thermal.clone(),
            radii: Radii { bearing_m: bearing.bearing_radius_m, journal_m, lining_m },
            bench,
            recent: VecDeque::new(),
            heat_j: 0.0,
            computed: 0,
        })
    }

    /// Clearance of the unworn bearing at a cycle: the described one with heat and water.
    fn base_m(&self, cycle: f64) -> f64 {
        let described_m = self.bench.bearing.radial_clearance_m;
        let Some(thermal) = &self.thermal else { return described_m };
        let period_s = self.bench.drive.period_s;
        let rise_k = thermal.ambient_rise_k + thermal.thermal_resistance_k_w * self.heat_j / period_s;
        let share = thermal
            .diffusivity_m2_s
            .map_or(1.0, |diffusivity| uptake_share(cycle * period_s, diffusivity, self.radii.lining_m));
        let expansion = self.bench.bearing.material.lining().expansion_per_k;
        let expansion = thermal.lining_expansion_per_k.unwrap_or(expansion);
        let growth = Growth {
            shaft: thermal.shaft_expansion_per_k * rise_k,
            housing: thermal.housing_expansion_per_k * thermal.ambient_rise_k,
            lining: expansion * rise_k + thermal.swelling * share,
        };
        described_m + clearance_change_m(&self.radii, &growth)
    }

    /// Runs a duty with the present clearance.
    fn compute(&mut self, profile: &Profile, cycle: f64) -> Result<Duty, LifeError> {
        let base_m = self.base_m(cycle);
        let clearance_m = base_m + self.worn_m(profile, base_m);
        if base_m.min(clearance_m) < MIN_CLEARANCE_M {
            return Err(LifeError::Seized { cycle, clearance_m: base_m.min(clearance_m) });
        }
        let mut bench = self.bench.clone();
        bench.bearing.radial_clearance_m = clearance_m;
        let times_s = bench.sample_times_s(SAMPLES_PER_CYCLE / bench.drive.period_s);
        let run = run_bench_with_law(&bench, &times_s, DEFAULT_TOLERANCE)
            .map_err(|source| LifeError::Run { cycle, source })?;
        let duty = self.duty(&run, (base_m, clearance_m));
        self.computed += 1;
        self.heat_j = duty.heat_j;
        let touching = duty.loads.iter().filter(|load| load.force_n != [0.0, 0.0]);
        self.recent.push_back(touching.step_by(DIRECTION_STEP).copied().collect());
        if self.recent.len() > RECENT_DUTIES {
            self.recent.pop_front();
        }
        Ok(duty)
    }

    /// Mean over the contact of how much further the journal gets in a worn bearing, m.
    fn worn_m(&self, profile: &Profile, base_m: f64) -> f64 {
        let mut gap_m = vec![0.0; CELLS];
        let further = |load: &Load| {
            let force_n = load.force_n[0].hypot(load.force_n[1]);
            profile.gap_m(base_m, load.shaft_angle_rad, &mut gap_m);
            let direction = load.force_n.map(|f| f / force_n);
            self.wear.foundation.rigid_displacement_m(&gap_m, direction) - base_m
        };
        let depths: Vec<f64> = self.recent.iter().flatten().map(further).collect();
        mean(&depths)
    }

    /// Loads and figures of the cycles after settling.
    fn duty(&self, run: &Run, (base_m, clearance_m): (f64, f64)) -> Duty {
        let skipped = (f64::from(self.settling) * SAMPLES_PER_CYCLE) as usize;
        let samples = run.samples.get(skipped..).unwrap_or_default();
        let step_s = self.bench.drive.period_s / SAMPLES_PER_CYCLE;
        let mut loads = Vec::with_capacity(samples.len());
        let (mut carried_n, mut total_n) = (0.0, 0.0);
        for (index, sample) in samples.iter().enumerate() {
            let before = index.checked_sub(1).and_then(|i| samples.get(i)).unwrap_or(sample);
            let force_n = sample.forces.normal_n;
            let whirl_rad_s = angle_between(before, sample) / step_s;
            let entrainment_rad_s = 0.5 * sample.speed_rad_s - whirl_rad_s;
            let share = self.film.as_ref().map_or(0.0, |f| f.share(force_n, clearance_m, entrainment_rad_s));
            let dry_n = if force_n > 0.0 { force_n * (1.0 - share) } else { 0.0 };
            (carried_n, total_n) = (carried_n + force_n - dry_n, total_n + force_n);
            let distance_m = sample.y_m.hypot(sample.z_m).max(f64::MIN_POSITIVE);
            loads.push(Load {
                force_n: [dry_n * sample.y_m / distance_m, dry_n * sample.z_m / distance_m],
                shaft_angle_rad: sample.angle_rad,
                sliding_m: sample.contact.sliding_speed_m_s.abs() * step_s,
            });
        }
        let largest = |read: fn(&Snapshot) -> f64| samples.iter().map(read).fold(0.0, f64::max);
        let settled_j = run.losses_j.get(skipped).map_or(0.0, |losses| losses[0]);
        Duty {
            loads,
            base_m,
            clearance_m,
            peak_force_n: largest(|s| s.forces.normal_n),
            friction_torque_nm: largest(|s| s.friction_torque_nm.abs()),
            heat_j: (run.energy.friction_heat_j - settled_j) / self.duty_cycles,
            film_share: if total_n > 0.0 { carried_n / total_n } else { 0.0 },
        }
    }
}

/// Angle in rad by which the direction of the contact turned between two samples.
fn angle_between(before: &Snapshot, after: &Snapshot) -> f64 {
    let turned = after.z_m.atan2(after.y_m) - before.z_m.atan2(before.y_m);
    (turned + PI).rem_euclid(TAU) - PI
}

impl CyclicSystem for LifeModel {
    type State = Profile;
    type Loads = Duty;
    type Error = LifeError;

    fn loads(&mut self, profile: &Profile, cycle: f64) -> Result<Duty, LifeError> {
        // The heat of the first duty is known after it.
        if self.computed == 0 && self.thermal.as_ref().is_some_and(|t| t.thermal_resistance_k_w > 0.0) {
            self.compute(profile, cycle)?;
        }
        self.compute(profile, cycle)
    }

    fn advance(&self, profile: &Profile, duty: &Duty, cycles: f64) -> Result<Profile, LifeError> {
        // The loads are those of all cycles of a duty.
        let repeats = cycles / self.duty_cycles;
        Ok(self.wear.advance(profile, duty.base_m, &duty.loads, repeats)?)
    }

    fn difference(&self, a: &Profile, b: &Profile) -> f64 {
        a.difference_m(b)
    }
}
