//! Errors of one estimator in one world.

use super::cases::{OperatingPoint, RealWorld, Set};
use super::estimators::{Estimate, EstimatorKind};
use ::worlds::Row;
use bench::statistics::rms;
use schemars::JsonSchema;
use serde::Serialize;

/// Time from which on errors count, s: the load has its full size.
pub(crate) const START_S: f64 = 0.05;
/// Time before and after a reversal of sliding that belongs to it, s.
const REVERSAL_S: (f64, f64) = (3e-3, 13e-3);
/// Estimated force without contact that counts as none, as a share of full scale.
const ZERO_SHARE: f64 = 1e-3;
/// Sections of [`Case::course_n`].
pub(super) const SECTIONS: usize = 100;

/// Errors of an estimator in a world, from [`START_S`] on.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Case {
    /// Name of the world.
    pub world: String,
    /// Kind of world.
    pub set: Set,
    /// Estimator.
    pub estimator: EstimatorKind,
    /// Operating point.
    #[serde(flatten)]
    pub point: OperatingPoint,
    /// Rms of the length of the force vector's error.
    pub rms_n: f64,
    /// Largest length of that error.
    pub max_n: f64,
    /// Length of the largest true force vector.
    pub full_scale_n: f64,
    /// Share of the ticks whose force error is within two reported standard deviations.
    pub inside_2sd: Option<f64>,
    /// Smallest reported standard deviation of the force.
    pub min_sd_n: Option<f64>,
    /// Rms error of the friction torque.
    pub torque_rms_nm: f64,
    /// The same around reversals of sliding; none without a reversal.
    pub torque_reversal_rms_nm: Option<f64>,
    /// Largest true friction torque.
    pub torque_full_scale_nm: f64,
    /// Share of the ticks whose torque error is within two reported standard deviations.
    pub torque_inside_2sd: Option<f64>,
    /// Ticks without contact.
    pub ticks_without_contact: usize,
    /// Share of these whose estimated force is at most .1 % of full scale.
    pub zero_without_contact: Option<f64>,
    /// Rms of the force error in equal sections of the cycle, N.
    #[serde(skip)]
    pub course_n: Vec<f64>,
}

/// True values and estimate of a tick.
struct Tick<'a> {
    row: &'a Row,
    estimate: &'a Estimate,
    is_reversal: bool,
}

impl Tick<'_> {
    fn force_error_n(&self) -> f64 {
        force_error_n(self.row, self.estimate)
    }

    fn torque_error_nm(&self) -> f64 {
        self.estimate.torque_nm - self.row.friction_torque_nm
    }
}

/// Length of the force vector's error.
pub(super) fn force_error_n(row: &Row, estimate: &Estimate) -> f64 {
    (estimate.force_n[0] - row.force_y_n).hypot(estimate.force_n[1] - row.force_z_n)
}

impl Case {
    /// Evaluates the estimates of a run.
    pub fn new(
        point: &OperatingPoint,
        real: &RealWorld,
        estimator: EstimatorKind,
        rows: &[Row],
        estimates: &[Estimate],
    ) -> Self {
        let reversals = near_reversals(rows);
        let ticks: Vec<Tick> = rows
            .iter()
            .zip(estimates)
            .zip(reversals)
            .map(|((row, estimate), is_reversal)| Tick { row, estimate, is_reversal })
            .filter(|tick| tick.row.time_s >= START_S)
            .collect();
        let largest = |value: &dyn Fn(&Tick) -> f64| ticks.iter().map(value).fold(0.0, f64::max);
        let full_scale_n = largest(&|t| t.row.force_y_n.hypot(t.row.force_z_n));
        let inside = |error: fn(&Tick) -> f64, which: usize| {
            // A deviation that is infinite covers nothing.
            let is_inside = |t: &Tick| {
                let deviation = t.estimate.deviations[which];
                deviation.is_finite() && error(t).abs() <= 2.0 * deviation
            };
            share(ticks.iter().map(is_inside))
        };
        let open = || ticks.iter().filter(|t| t.row.deformation_m <= 0.0);
        let is_zero = |t: &Tick| {
            let [y, z] = t.estimate.force_n;
            y.hypot(z) <= ZERO_SHARE * full_scale_n
        };
        let at_reversals = || ticks.iter().filter(|t| t.is_reversal);
        Self {
            world: real.name.clone(),
            set: real.set,
            estimator,
            point: *point,
            rms_n: rms(ticks.iter().map(|t| t.force_error_n())),
            max_n: largest(&|t| t.force_error_n()),
            full_scale_n,
            inside_2sd: inside(|t| t.force_error_n(), 0),
            min_sd_n: ticks.iter().map(|t| t.estimate.deviations[0]).reduce(f64::min),
            torque_rms_nm: rms(ticks.iter().map(|t| t.torque_error_nm())),
            torque_reversal_rms_nm: at_reversals()
                .next()
                .map(|_| rms(at_reversals().map(|t| t.torque_error_nm()))),
            torque_full_scale_nm: largest(&|t| t.row.friction_torque_nm.abs()),
            torque_inside_2sd: inside(|t| t.torque_error_nm(), 1),
            ticks_without_contact: open().count(),
            zero_without_contact: share(open().map(is_zero)),
            course_n: ticks
                .chunks(ticks.len().div_ceil(SECTIONS).max(1))
                .map(|section| rms(section.iter().map(|t| t.force_error_n())))
                .collect(),
        }
    }

    /// Rms error of the force as a share of full scale.
    pub fn force_share(&self) -> f64 {
        self.rms_n / self.full_scale_n
    }

    /// Largest error of the force as a share of full scale.
    pub fn max_share(&self) -> f64 {
        self.max_n / self.full_scale_n
    }

    /// Rms error of the torque as a share of full scale.
    pub fn torque_share(&self) -> f64 {
        self.torque_rms_nm / self.torque_full_scale_nm
    }

    /// Rms error of the torque around reversals of sliding as a share of full scale.
    pub(crate) fn torque_reversal_share(&self) -> Option<f64> {
        Some(self.torque_reversal_rms_nm? / self.torque_full_scale_nm)
    }

    /// Describes world and operating point.
    pub fn place(&self) -> String {
        format!("{}, {}", self.point.name(), self.world)
    }
}

/// Share of the true values; none without values.
fn share(values: impl Iterator<Item = bool>) -> Option<f64> {
    let (count, hits) = values.fold((0_u64, 0_u64), |(n, hits), hit| (n + 1, hits + u64::from(hit)));
    (count > 0).then(|| hits as f64 / count as f64)
}

/// Times at which the sliding speed changes its sign, s.
pub(super) fn reversals_s(rows: &[Row]) -> impl Iterator<Item = f64> {
    let reverses = |pair: &&[Row]| pair[0].sliding_speed_m_s * pair[1].sliding_speed_m_s < 0.0;
    rows.windows(2).filter(reverses).map(|pair| pair[1].time_s)
}

/// Marks the rows around reversals of sliding.
fn near_reversals(rows: &[Row]) -> Vec<bool> {
    let reversals: Vec<f64> = reversals_s(rows).collect();
    let near = |row: &Row| {
        let (before, after) = REVERSAL_S;
        reversals.iter().any(|t| (-before..=after).contains(&(row.time_s - t)))
    };
    rows.iter().map(near).collect()
}

#[cfg(test)]
mod tests {
    use super::super::cases;
    use super::*;

    fn case(deviations: [f64; 2]) -> Case {
        let point = OperatingPoint::all()[0];
        let real = cases::worlds(&point, 0, 1).remove(0);
        let row = |index: u32| Row {
            time_s: f64::from(index) * 1e-3,
            force_y_n: if index == 90 { 1000.0 } else { 600.0 },
            friction_torque_nm: -10.0,
            deformation_m: if index < 95 { 1e-6 } else { -1e-6 },
            sliding_speed_m_s: if index < 70 { -1.0 } else { 1.0 },
            ..Row::default()
        };
        let rows: Vec<Row> = (0..100).map(row).collect();
        let estimate = |row: &Row| {
            let index = (row.time_s * 1e3).round() as u32;
            let off = if index < 50 { 1e6 } else { f64::from(index % 2) };
            let is_near = (66..=84).contains(&index);
            Estimate {
                force_n: match index {
                    95..98 => [0.5, 0.5],
                    _ => [row.force_y_n + 30.0 * off, 40.0 * off],
                },
                torque_nm: -10.0 + if is_near { 2.0 } else { 0.0 },
                deviations,
            }
        };
        let estimates: Vec<Estimate> = rows.iter().map(estimate).collect();
        Case::new(&point, &real, EstimatorKind::Network, &rows, &estimates)
    }

    #[test]
    fn errors_count_after_the_start_and_refer_to_the_largest_true_force() {
        let case = case([f64::INFINITY; 2]);
        assert_eq!((case.full_scale_n, case.torque_full_scale_nm), (1000.0, 10.0));
        let missed = 599.5_f64.hypot(0.5);
        assert!((case.max_n - missed).abs() < 1e-9, "{}", case.max_n);
        // Every second tick is off by 50 N, three without contact by nearly the complete force.
        let sum = 23.0 * 2500.0 + 3.0 * missed * missed;
        assert!((case.rms_n - (sum / 50.0).sqrt()).abs() < 1e-9, "{}", case.rms_n);
        assert!((case.torque_rms_nm - 2.0 * (19.0_f64 / 50.0).sqrt()).abs() < 1e-9);
        assert!((case.torque_reversal_share().unwrap() - 0.2).abs() < 1e-9);
        assert_eq!((case.inside_2sd, case.torque_inside_2sd), (Some(0.0), Some(0.0)));
    }

    #[test]
    fn coverage_counts_errors_within_two_deviations_and_zero_forces_count_without_contact() {
        let narrow = case([24.0, 0.5]);
        let wide = case([26.0, 1.5]);
        assert!(narrow.inside_2sd < wide.inside_2sd);
        assert_eq!(wide.inside_2sd, Some(47.0 / 50.0));
        assert_eq!((narrow.torque_inside_2sd, wide.torque_inside_2sd), (Some(31.0 / 50.0), Some(1.0)));
        assert_eq!(narrow.min_sd_n, Some(24.0));
        assert_eq!((narrow.ticks_without_contact, narrow.zero_without_contact), (5, Some(3.0 / 5.0)));
    }
}
