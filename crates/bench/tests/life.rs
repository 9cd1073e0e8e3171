//! Life of the bearing of bench B: wear, heat, water and film together.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::description::{FilmSection, LifeSection, TransmissionBench, WearSection};
use bench::simulate::life::{Life, LifeError, run_life};
use bench::{BearingMaterial, Bench};

fn bench(cycles: f64, sections: &str) -> TransmissionBench {
    let text = include_str!("../presets/bench-b.toml");
    let parsed = Bench::parse("x", &text.replace("[logging]", &format!("{sections}\n[logging]"))).unwrap();
    let mut bench = TransmissionBench::from_bench(parsed, "x").unwrap();
    let life = bench.life.take().unwrap_or_default();
    bench.life = Some(LifeSection { cycles, settling_cycles: 1, duty_cycles: 1, ..life });
    bench.set_material(BearingMaterial::Plastic);
    bench
}

fn life(bench: &TransmissionBench, factor: f64) -> Life {
    run_life(bench, factor, |_| {}).unwrap()
}

fn last(life: &Life) -> &bench::simulate::life::LifePoint {
    life.points.last().unwrap()
}

/// Archard's law knows only the product of rate and distance, so three times the rate is three
/// times the cycles.
#[test]
fn a_factor_on_the_rate_is_one_on_the_cycles() {
    let (fast, long) = (life(&bench(1e5, ""), 3.0), life(&bench(3e5, ""), 1.0));
    let [a, b] = [&fast, &long].map(|life| last(life).clearance_m - 0.5e-3);
    assert!(a > 20e-6 && (a / b - 1.0).abs() < 0.02, "{a} {b}");
    let [a, b] = [&fast, &long].map(|life| last(life).wear_volume_m3);
    assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
}

/// The worn volume is `k F s` of the run, times the ratio of the total pressure to the force, which
/// is 1 for a narrow contact and 4/pi for one over half of the circumference.
#[test]
fn the_worn_volume_is_that_of_force_and_sliding() {
    let bench = bench(1e5, "");
    let mut plain = bench.clone();
    plain.drive.cycles = 2;
    let times_s = plain.sample_times_s(1e3);
    let run = bench::simulate::run_bench_with_law(&plain, &times_s, 1e-7).unwrap();
    let product = |s: &bench::plants::transmission::Snapshot| {
        s.forces.normal_n * s.contact.sliding_speed_m_s.abs() * 1e-3
    };
    // The second cycle counts: the first one oscillates more.
    let work_nm: f64 = run.samples.iter().skip(1000).map(product).sum();
    let volume_m3 = 6.184e-15 * work_nm * 1e5;
    let ratio = last(&life(&bench, 1.0)).wear_volume_m3 / volume_m3;
    assert!((1.0..4.0 / std::f64::consts::PI).contains(&ratio), "{ratio}");
}

#[test]
fn a_life_ends_at_its_limit() {
    let limited = bench(1e6, "[life]\nlimit_clearance_m = 0.52e-3");
    let found = life(&limited, 3.0);
    let cycle = found.limit_cycle.unwrap();
    assert!(cycle < last(&found).cycle && last(&found).cycle < 1e6, "{cycle}");
    assert!((found.clearance_m(cycle) - 0.52e-3).abs() < 1e-12);
    assert_eq!(life(&bench(10.0, ""), 1.0).limit_cycle, None);
}

#[test]
fn heat_and_water_close_the_clearance_and_a_film_carries_a_part_of_the_force() {
    let start = |sections: &str| life(&bench(1.0, sections), 1.0).points[0];
    let dry = start("");
    assert_eq!((dry.clearance_m, dry.film_share), (0.5e-3, 0.0));
    // 40 K: shaft -33.36 um, housing 37.248 um, lining 7.56 mm * 90e-6/K * -40 K = -27.2 um.
    let warm = start("[thermal]\nambient_rise_k = 40.0");
    assert!((warm.clearance_m - 0.5e-3 + 23.33e-6).abs() < 0.1e-6, "{:e}", warm.clearance_m);
    let wet = start("[thermal]\nswelling = 0.02");
    assert!((wet.clearance_m - 0.5e-3 + 0.02 * 7.56e-3).abs() < 1e-9, "{:e}", wet.clearance_m);
    let slowly = life(&bench(1e4, "[thermal]\nswelling = 0.02\ndiffusivity_m2_s = 1e-10"), 1.0);
    let (first, end) = (slowly.points[0].thermal_change_m, last(&slowly).thermal_change_m);
    assert!(first == 0.0 && end < -15e-6 && end > -151e-6, "{first} {end}");
    // 1 K/W: shaft and lining follow the friction heat of a cycle of 1 s.
    let hot = start("[thermal]\nthermal_resistance_k_w = 1.0");
    let expected_m = -hot.heat_j * (12e-6 * 69.5e-3 + 90e-6 * 7.56e-3);
    assert!((hot.thermal_change_m / expected_m - 1.0).abs() < 0.05, "{:e}", hot.thermal_change_m);
    let film = |viscosity: &str| start(&format!("[film]\nviscosity_pa_s = {viscosity}")).film_share;
    let (water, oil, grease) = (film("1e-3"), film("0.05"), film("1.0"));
    assert!(0.05 < water && water < 0.3 && 0.9 < grease, "{water} {grease}");
    assert!(1.5 * water < oil && oil < grease, "{oil}");
}

#[test]
fn a_bearing_that_swells_shut_or_tilts_has_no_life() {
    let error = |bench: &TransmissionBench| run_life(bench, 1.0, |_| {}).unwrap_err();
    let shut = error(&bench(1.0, "[thermal]\nswelling = 0.1"));
    assert!(matches!(shut, LifeError::Seized { cycle: 0.0, clearance_m } if clearance_m < 0.0), "{shut}");
    let tilting = error(&bench(1.0, "[two_plane]"));
    assert!(tilting.to_string().starts_with("two_plane: found"), "{tilting}");
    let mut rubber = bench(1.0, "");
    rubber.bearing.poisson_ratio = 0.5;
    assert!(error(&rubber).to_string().contains("bearing.poisson_ratio: found 0.5"));
}

/// A journal that wears, too, shares the gap: both volumes follow their rates.
#[test]
fn bearing_and_journal_wear_by_their_rates() {
    let mut both = bench(1e5, "");
    let rate = Some(4e-15);
    both.wear = Some(WearSection {
        specific_wear_rate_m3_nm: rate,
        journal_wear_rate_m3_nm: 1e-15,
        ..WearSection::default()
    });
    both.film = None::<FilmSection>;
    let found = life(&both, 1.0);
    let profile = found.profiles.last().unwrap();
    let [bearing, journal] =
        [&profile.bearing_m, &profile.journal_m].map(|depths| depths.iter().sum::<f64>());
    assert!((journal / bearing - 0.25).abs() < 1e-9, "{journal} {bearing}");
}
