//! Error bars of peaks cover the true errors: at least 95 % of the peaks of every group lie within
//! their bars of a reference at a much tighter tolerance.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod normal_law;

use bench::Bench;
use bench::description::{SliderCrankBench, TransmissionBench};
use bench::integrate::integrate;
use bench::plants::transmission::Transmission;
use bench::simulate::peaks::{Peak, impacts_with_bars, peaks_with_bars};
use bench::simulate::{DEFAULT_TOLERANCE, run_with_held_force, snapshots};
use contact::{BearingMaterial, CompleteLawKind, Dissipation, FrictionKind, StiffnessKind};
use normal_law::parameters;

/// Share of the peaks that a bar must cover.
const COVERED: f64 = 0.95;
/// Tolerance of the references on the bench.
const REFERENCE: f64 = 1e-9;

/// Peaks within and outside their bars.
#[derive(Default)]
struct Coverage {
    inside: usize,
    outside: Vec<String>,
}

impl Coverage {
    fn add(&mut self, name: &str, value: f64, bar: f64, reference: f64) {
        if (value - reference).abs() <= bar {
            self.inside += 1;
        } else {
            self.outside.push(format!("{name}: {value} +- {bar:e}, reference {reference}"));
        }
    }

    fn add_peaks(&mut self, name: &str, peaks: &[Peak], reference: &[Peak]) {
        for (peak, reference) in peaks.iter().zip(reference) {
            self.add(&format!("{name} {}", peak.name), peak.value, peak.error_bar, reference.value);
        }
    }

    /// Requires the coverage of at least so many peaks.
    fn check(&self, least: usize) {
        let count = self.inside + self.outside.len();
        eprintln!("{} of {count} inside; outside: {:#?}", self.inside, self.outside);
        assert!(count >= least, "{count} peaks");
        assert!(self.inside as f64 >= COVERED * count as f64, "{:#?}", self.outside);
    }
}

/// Every dissipation factor on the slider-crank, at the accuracy of the command and at a wider one.
#[test]
fn bars_of_impacts_cover_the_errors_of_every_dissipation_factor() {
    let bench = SliderCrankBench::open("slider-crank").unwrap();
    let span = (0.0, bench.duration_s());
    for tolerance in [3.3e-8, 3.3e-10] {
        let mut coverage = Coverage::default();
        for kind in Dissipation::ALL {
            let mut plant = bench.plant();
            plant.normal_law.dissipation = kind;
            let initial = plant.initial_state();
            let tolerances = plant.tolerances(3e-14);
            let reference = integrate(&plant, span, initial, false, &[], &tolerances, |_, _, _| {}).unwrap();
            let found = impacts_with_bars(&plant, span, initial, &plant.tolerances(tolerance)).unwrap();
            assert_eq!(found.len(), reference.impacts.len(), "{kind:?}");
            for ((impact, bar), reference) in found.iter().zip(&reference.impacts) {
                coverage.add(&format!("{kind:?}"), impact.peak_force_n, *bar, reference.peak_force_n);
            }
        }
        coverage.check(200);
    }
}

/// Peaks of the located run at a tolerance, with their bars.
fn law_peaks(bench: &TransmissionBench, tolerance: f64) -> Vec<Peak> {
    peaks_with_bars((0.05, 1.0), tolerance, |tolerance, times| {
        snapshots(bench, (bench.drive_profile(), bench.load_profile()), 1.0, times, tolerance)
    })
    .unwrap()
}

/// Bench B with both materials at four clearances.
fn bearings() -> impl Iterator<Item = (String, TransmissionBench)> {
    BearingMaterial::ALL.into_iter().flat_map(|material| {
        [0.1, 0.25, 0.5, 1.0].into_iter().map(move |clearance_mm| {
            let mut bench = TransmissionBench::open("bench-b").unwrap();
            bench.set_material(material);
            bench.set_radial_clearance(clearance_mm * 1e-3);
            (format!("{material:?} {clearance_mm} mm"), bench)
        })
    })
}

/// Bench B with every law of the catalogue that carries it, one at a time.
fn laws() -> Vec<(String, TransmissionBench)> {
    const PRESET: &str = include_str!("../presets/bench-b.toml");
    let parse = |name: &str, from: &str, to: &str| {
        let Bench::Transmission(bench) = Bench::parse("x.toml", &PRESET.replace(from, to)).unwrap() else {
            panic!("bench-b")
        };
        (name.to_owned(), *bench)
    };
    let mut all = Vec::new();
    for kind in StiffnessKind::ALL {
        let name = kind.entry().name;
        let more = parameters(kind.parameters(), "5e8");
        let law = format!("stiffness = \"{name}\"\n{more}");
        all.push(parse(name, "stiffness = \"hybrid-as-printed\"", &law));
    }
    for kind in Dissipation::ALL {
        let name = kind.entry().name;
        let law = format!("dissipation = \"{name}\"");
        all.push(parse(name, "dissipation = \"zhiying-qishao\"", &law));
    }
    for kind in CompleteLawKind::ALL {
        let (name, more) = (kind.entry().name, parameters(kind.parameters(), "3e8"));
        all.push(parse(name, "[friction]", &format!("law = \"{name}\"\n{more}\n[friction]")));
    }
    for kind in FrictionKind::ALL.into_iter().filter(|kind| *kind != FrictionKind::SevenParameter) {
        let name = kind.entry().name;
        let law = format!("shape = \"tustin\"\nlaw = \"{name}\"\nbristle_stiffness_per_m = 1e4");
        all.push(parse(name, "shape = \"tustin\"", &law));
    }
    all
}

#[test]
fn bars_cover_the_errors_of_every_law_on_the_bench() {
    let mut coverage = Coverage::default();
    for (name, bench) in bearings().chain(laws()) {
        // A stiffness may refuse the bench's depth.
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        if bench::simulate::run_with_law(&plant, 1.0, &[], DEFAULT_TOLERANCE).is_err() {
            continue;
        }
        let peaks = law_peaks(&bench, DEFAULT_TOLERANCE);
        coverage.add_peaks(&name, &peaks, &law_peaks(&bench, REFERENCE));
        // Without damping the journal bounces for the whole run, and trajectories decorrelate.
        for peak in peaks.iter().filter(|_| name != "none") {
            assert!(peak.error_bar < 1e-3 * peak.value, "{name}: a useless bar, {peak:?}");
        }
    }
    coverage.check(180);
}

#[test]
fn bars_cover_the_errors_of_a_held_force() {
    let mut coverage = Coverage::default();
    for (name, bench) in bearings() {
        let reference = law_peaks(&bench, REFERENCE);
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let at = |step_s: f64| {
            let run = run_with_held_force(&plant, 1.0, &[], step_s, |view| plant.law(view)).ok()?;
            run.extremes
        };
        for step_s in [1e-5, 5e-6] {
            let [fine, middle, coarse] = [1.0, 2.0, 4.0].map(|factor| at(factor * step_s));
            let peaks = fine.unwrap().to_peaks([middle.as_ref(), coarse.as_ref()]);
            coverage.add_peaks(&format!("{name}, {step_s:e} s"), &peaks, &reference);
            for peak in &peaks {
                assert!(peak.error_bar < 0.1 * peak.value, "{name}: a useless bar, {peak:?}");
            }
        }
    }
    coverage.check(80);
}
