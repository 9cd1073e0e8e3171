//! Settled operation of the transmission bench: against figures of two independent codes, and
//! against the energy balance.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::BearingMaterial::{self, Babbitt, Plastic};
use bench::description::{Start, TransmissionBench};
use bench::plants::transmission::{Snapshot, Transmission};
use bench::simulate::settled::{Course, Settled};
use bench::simulate::{Run, run_with_law};

const RATE_HZ: f64 = 10_000.0;

fn bench_b(material: BearingMaterial, clearance_mm: f64, cycles: u32) -> TransmissionBench {
    let mut bench = TransmissionBench::open("bench-b").unwrap();
    bench.set_material(material);
    bench.set_radial_clearance(clearance_mm * 1e-3);
    bench.drive.cycles = cycles;
    bench
}

fn run(bench: &TransmissionBench) -> Run {
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    run_with_law(&plant, bench.duration_s(), &bench.sample_times_s(RATE_HZ), 1e-8).unwrap()
}

fn settled(bench: &TransmissionBench, run: &Run) -> Settled {
    let course = Course::new(run, RATE_HZ, bench.drive.period_s, bench.duration_s(), bench.load.ramp_s);
    Settled::from_course(&course, 1).unwrap()
}

/// Rms of the contact force less its 20 ms moving mean, from 20 ms before to 130 ms after the first
/// sign change of the crank's angular acceleration in a cycle.
fn oscillation_n(samples: &[Snapshot], cycle: usize) -> f64 {
    let reversal_s = (cycle - 1) as f64 + 0.266;
    let at = |time_s: f64| samples.partition_point(|s| s.time_s < time_s);
    let (low, high) = (at(reversal_s - 0.02), at(reversal_s + 0.13));
    let squares = (low..=high).map(|i| {
        let window = &samples[i - 100..=i + 100];
        let mean = window.iter().map(|s| s.forces.normal_n).sum::<f64>() / 201.0;
        (samples[i].forces.normal_n - mean).powi(2)
    });
    (squares.sum::<f64>() / (high - low + 1) as f64).sqrt()
}

/// Clearance in mm; peak force and oscillation in N of cycle 1, then of cycle 5 as a range.
type Row = (f64, f64, f64, (f64, f64), (f64, f64));

#[test]
fn peaks_and_oscillation_of_cycles_one_and_five_are_those_of_independent_codes() {
    let babbitt: [Row; 4] = [
        (0.1, 8067.0, 94.0, (7976.0, 7976.0), (860.0, 860.0)),
        // A motion of period two.
        (0.25, 10137.0, 743.0, (8241.0, 9589.0), (511.0, 621.0)),
        (0.5, 11755.0, 1034.0, (9671.0, 9671.0), (387.0, 387.0)),
        (1.0, 13924.0, 1152.0, (8038.0, 8038.0), (180.0, 180.0)),
    ];
    let plastic: [Row; 4] = [
        (0.1, 6004.0, 189.0, (5993.0, 5993.0), (88.0, 88.0)),
        (0.25, 5952.0, 378.0, (6019.0, 6019.0), (78.0, 78.0)),
        (0.5, 6245.0, 523.0, (5988.0, 5988.0), (66.0, 66.0)),
        (1.0, 7173.0, 526.0, (5960.0, 5960.0), (46.0, 46.0)),
    ];
    for (material, rows) in [(Babbitt, babbitt), (Plastic, plastic)] {
        for (clearance_mm, peak_1, rms_1, peak_5, rms_5) in rows {
            let bench = bench_b(material, clearance_mm, 5);
            let run = run(&bench);
            let settled = settled(&bench, &run);
            let peaks = settled.values("peak_contact_force_n").unwrap();
            let rms = [1, 5].map(|cycle| oscillation_n(&run.samples, cycle));
            eprintln!(
                "{material:?} {clearance_mm}: peaks {peaks:.1?}, rms {rms:.1?}, cut {} {}, whole cycles \
                 {:.1?}, losses {:.2?}",
                settled.transient_cycles,
                settled.is_settled,
                settled.values("oscillation_rms_n").unwrap(),
                settled.values("dissipated_j").unwrap()
            );
            let is_near = |found: f64, (low, high): (f64, f64), share: f64| {
                (low * (1.0 - share)..=high * (1.0 + share)).contains(&found)
            };
            assert!(is_near(peaks[0], (peak_1, peak_1), 1e-3), "{material:?} {clearance_mm}: {peaks:?}");
            assert!(is_near(peaks[4], peak_5, 1e-3), "{material:?} {clearance_mm}: {peaks:?}");
            assert!(is_near(rms[0], (rms_1, rms_1), 0.02), "{material:?} {clearance_mm}: {rms:?}");
            assert!(is_near(rms[1], rms_5, 0.02), "{material:?} {clearance_mm}: {rms:?}");
        }
    }
}

#[test]
fn the_losses_of_a_settled_cycle_are_the_work_of_drive_and_load() {
    let bench = bench_b(Plastic, 0.5, 6);
    let run = run(&bench);
    let settled = settled(&bench, &run);
    assert!(settled.is_settled && (1..=2).contains(&settled.transient_cycles), "{settled:?}");
    // An independent sum: power of fork and load over the last cycle, by the trapezoidal rule. In a
    // periodic motion nothing is stored, and gravity does no work.
    let last = &run.samples[run.samples.len() - 10_001..];
    let power_w = |s: &Snapshot| {
        let crank = |lever: f64| lever * s.angle_rad.cos() * s.speed_rad_s;
        // The fork has the speed of the drive; the load's pin that of the journal and its crank.
        let journal_m_s = s.drive.rate - crank(bench.geometry.drive_lever_radius_m);
        s.drive_force_n * s.drive.rate
            + s.load_force_n * (journal_m_s + crank(bench.geometry.load_lever_radius_m))
    };
    let work_j: f64 = last.windows(2).map(|w| 0.5e-4 * (power_w(&w[0]) + power_w(&w[1]))).sum();
    let losses_j = settled.quantity("dissipated_j").unwrap().mean.value;
    assert!((losses_j / work_j - 1.0).abs() < 2e-3, "{losses_j} {work_j}");
    let parts: f64 = ["friction_heat_j", "damping_loss_j", "load_friction_heat_j"]
        .map(|name| settled.quantity(name).unwrap().mean.value)
        .iter()
        .sum();
    assert!((parts / losses_j - 1.0).abs() < 1e-12);
}

#[test]
fn a_journal_lands_with_the_speed_that_is_set() {
    let mut bench = bench_b(Babbitt, 0.5, 1);
    for (gap_m, landing_m_s) in [(None, 0.010), (Some(0.5e-6), 0.0075), (Some(0.5e-6), 0.08)] {
        bench.start = Some(Start { gap_m, landing_speed_m_s: Some(landing_m_s) });
        let found = run(&bench).impacts[0].approach_speed_m_s;
        // The drive moves the journal sideways while it falls.
        assert!((found / landing_m_s - 1.0).abs() < 2e-3, "{gap_m:?} {landing_m_s}: {found}");
    }
}

#[test]
fn statistics_of_a_periodic_motion_have_narrow_intervals_and_one_range_per_cycle() {
    let bench = bench_b(Plastic, 0.5, 10);
    let run = run(&bench);
    let settled = settled(&bench, &run);
    let peak = settled.quantity("peak_contact_force_n").unwrap();
    let [low, high] = peak.mean.interval.unwrap();
    assert!(
        low <= peak.mean.value && peak.mean.value <= high && (high - low) / peak.mean.value < 2e-3,
        "{peak:?}"
    );
    assert!(peak.first_cycle > 1.03 * peak.largest, "{peak:?}");
    let torque = settled.rainflow.iter().find(|count| count.name == "friction_torque_nm").unwrap();
    // The shaft turns once in each direction per cycle: one large range of the torque.
    let large = torque.bins.last().unwrap();
    assert!((large.per_cycle.value - 1.0).abs() < 0.26, "{torque:?}");
    assert!(torque.equivalent_range_3.value >= 0.9 * torque.largest_range, "{torque:?}");
    assert!(torque.equivalent_range_5.value >= 0.9 * torque.largest_range, "{torque:?}");
}

#[test]
fn fewer_than_three_cycles_have_no_statistics() {
    let bench = bench_b(Plastic, 0.5, 2);
    let run = run(&bench);
    let course = Course::new(&run, RATE_HZ, bench.drive.period_s, bench.duration_s(), bench.load.ramp_s);
    assert!(Settled::from_course(&course, 1).is_none());
}
