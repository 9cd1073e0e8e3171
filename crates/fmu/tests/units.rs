//! Exported units, loaded and run as another program does.

use bench::description::{MechanismBench, TransmissionBench};
use bench::simulate::{run_bench_with_law, run_with_held_force};
use bench::{BearingMaterial, Bench};
use inference::{Pair, shipped};
use pintle_fmu::{
    Causality, Import, Kind, Library, Model, Platform, Slave, Type, Version, contact_state, pack,
};
use std::path::{Path, PathBuf};

/// Library that cargo builds with the crate.
fn library() -> Vec<u8> {
    let test = std::env::current_exe().unwrap();
    std::fs::read(test.parent().unwrap().join("libpintle_fmu.so")).unwrap()
}

fn model(kind: Kind, name: &str, has_networks: bool) -> Model {
    Model::new(kind, Bench::open(name).unwrap(), Path::new("."), has_networks, Vec::new()).unwrap()
}

/// Packs a model into a file of a folder.
fn file(folder: &Path, model: &Model, version: Version) -> PathBuf {
    let libraries = [Library { platform: Platform::Linux, bytes: library() }];
    let path = folder.join(format!("{}-{}.fmu", model.kind().name(), version.name()));
    std::fs::write(&path, pack(model, version, &libraries, &[], "test").unwrap()).unwrap();
    path
}

fn open(model: &Model, version: Version) -> Import {
    let folder = tempfile::tempdir().unwrap();
    Import::open(&file(folder.path(), model, version)).unwrap()
}

/// Values of some outputs after each step.
fn run(
    import: &Import,
    settings: &[(&str, f64)],
    names: &[&str],
    step_s: f64,
    steps: usize,
) -> Vec<Vec<f64>> {
    let variable = |name: &str| import.variable(name).unwrap_or_else(|| panic!("no variable {name}"));
    let settings: Vec<_> = settings.iter().map(|(name, value)| (variable(name), *value)).collect();
    let mut slave = Slave::start(import, &settings, 0.0).unwrap();
    let mut rows = Vec::new();
    for _ in 0..steps {
        slave.step(step_s).unwrap();
        rows.push(names.iter().map(|name| slave.get(variable(name)).unwrap()).collect());
    }
    rows
}

#[test]
fn a_bench_unit_follows_the_native_run_and_both_versions_agree_to_the_bit() {
    let model = model(Kind::Bench, "bench-b", false);
    let bench = TransmissionBench::from_bench(model.bench().resolved(), "bench-b").unwrap();
    let names = ["journal_y_m", "journal_z_m", "normal_force_n", "shaft_angle_rad"];
    let [two, three] = [Version::Two, Version::Three]
        .map(|version| run(&open(&model, version), &[("tolerance", 1e-9)], &names, 1e-3, 300));
    assert_eq!(two, three);
    let times: Vec<f64> = (0..=300).map(|i| f64::from(i) * 1e-3).collect();
    let native = run_bench_with_law(&bench, &times, 1e-9).unwrap();
    let scale_n = native.samples.iter().map(|s| s.forces.normal_n).fold(0.0, f64::max);
    for (row, sample) in two.iter().zip(&native.samples[1..]) {
        let expected = [sample.y_m, sample.z_m, sample.forces.normal_n, sample.angle_rad];
        for ((found, expected), tolerance) in row.iter().zip(expected).zip([1e-9, 1e-9, 1e-5 * scale_n, 1e-8])
        {
            assert!((found - expected).abs() < tolerance, "{} s: {row:?} {expected:?}", sample.time_s);
        }
    }
}

#[test]
fn a_bench_unit_with_networks_follows_the_native_run_with_networks() {
    let model = model(Kind::Bench, "bench-b", true);
    let bench = TransmissionBench::from_bench(model.bench().resolved(), "bench-b").unwrap();
    let rows = run(&open(&model, Version::Two), &[], &["journal_y_m", "journal_z_m"], 1e-4, 500);
    let plant =
        bench::plants::transmission::Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let mut pair: Pair = Pair::new(inference::Model::load(shipped(BearingMaterial::Babbitt)).unwrap());
    let times: Vec<f64> = (0..500).map(|i| f64::from(i) * 1e-4).collect();
    let native = run_with_held_force(&plant, 0.05, &times, 1e-5, |view| {
        let found = pair.push(&contact_state(view));
        let [normal_n, friction_n] = [found.normal_force_n(), found.friction_force_n()].map(f64::from);
        bench::plants::transmission::BearingForces { normal_n, friction_n }
    })
    .unwrap();
    // Times differ in rounding, which the integer inputs of the networks do not always hide.
    for (row, sample) in rows.iter().zip(&native.samples[1..]) {
        let distance_m = (row[0] - sample.y_m).hypot(row[1] - sample.z_m);
        assert!(distance_m < 1e-9, "{} s: {distance_m} m", sample.time_s);
    }
}

#[test]
fn a_mechanism_unit_follows_the_native_run_and_takes_forces() {
    let model = model(Kind::Mechanism, "four-bar", false);
    let bench = MechanismBench::from_bench(model.bench().clone(), "four-bar").unwrap();
    let names = ["coupler_x_m", "coupler_y_m", "coupler_angle_rad"];
    let import = open(&model, Version::Three);
    let rows = run(&import, &[("tolerance", 1e-9)], &names, 1e-3, 100);
    let times: Vec<f64> = (0..=100).map(|i| f64::from(i) * 1e-3).collect();
    let native = bench.simulate(&times, 1e-9).unwrap();
    let coupler = bench.body.iter().position(|body| body.name == "coupler").unwrap();
    for (row, sample) in rows.iter().zip(&native.samples[1..]) {
        let expected = sample.bodies[coupler].position;
        assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{row:?} {expected:?}");
    }
    let pushed = run(&import, &[("coupler_input_force_y_n", 800.0)], &names, 1e-3, 20);
    assert!((pushed[19][1] - rows[19][1]).abs() > 1e-8);
}

/// Mass under gravity on the bearing of bench B, with the force of a contact unit held over each
/// step for 0.3 s. Returns the largest normal force in N, and the height at the end in m; none if
/// the mass leaves the bench.
fn drop_on_contact(import: &Import, mass_kg: f64, step_s: f64) -> (f64, Option<f64>) {
    let variable = |name: &str| import.variable(name).unwrap();
    let mut slave = Slave::start(import, &[(variable("extrapolation_s"), 0.5 * step_s)], 0.0).unwrap();
    let (mut z_m, mut speed_m_s, mut peak_n) = (-0.49e-3, 0.0_f64, 0.0_f64);
    for _ in 0..(0.3 / step_s).round() as usize {
        slave.set(variable("journal_z_m"), z_m).unwrap();
        slave.set(variable("journal_velocity_z_m_s"), speed_m_s).unwrap();
        let force_n = slave.get(variable("force_z_n")).unwrap();
        peak_n = peak_n.max(slave.get(variable("normal_force_n")).unwrap());
        slave.step(step_s).unwrap();
        let acceleration = force_n / mass_kg - 9.806_65;
        z_m += step_s * (speed_m_s + 0.5 * step_s * acceleration);
        speed_m_s += step_s * acceleration;
        if z_m.abs() > 1.0 {
            return (peak_n, None);
        }
    }
    (peak_n, Some(z_m))
}

#[test]
fn a_contact_unit_catches_a_falling_mass_up_to_the_step_that_the_document_states() {
    let import = open(&model(Kind::Contact, "bench-b", false), Version::Two);
    // Errors of the peak by mass and step as in docs/fmi.md; none where the motion is unstable.
    let steps_s = [1e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3];
    let table = [
        (1.0, [Some(0.012), Some(0.070), Some(0.147), Some(0.913), None, None, None]),
        (10.0, [Some(0.005), Some(0.030), Some(0.066), Some(0.114), None, None, None]),
        (100.0, [Some(0.003), Some(0.015), Some(0.028), Some(0.051), Some(0.206), Some(0.304), None]),
    ];
    for (mass_kg, errors) in table {
        let (reference_n, rest_m) = drop_on_contact(&import, mass_kg, 1e-6);
        for (step_s, expected) in steps_s.into_iter().zip(errors) {
            let (peak_n, end_m) = drop_on_contact(&import, mass_kg, step_s);
            let error = peak_n / reference_n - 1.0;
            println!("{mass_kg} kg, {step_s:e} s: peak {:+.1} %, at rest at {end_m:?} m", 100.0 * error);
            let Some(expected) = expected else {
                assert_eq!(end_m, None, "{mass_kg} kg, {step_s} s");
                continue;
            };
            let distance_m = (end_m.unwrap() - rest_m.unwrap()).abs();
            assert!((error - expected).abs() < 0.02 * expected + 5e-4, "{mass_kg} kg, {step_s} s: {error}");
            assert!(distance_m < 1e-9, "{mass_kg} kg, {step_s} s: {distance_m} m from rest");
        }
    }
}

#[test]
fn outputs_of_a_contact_follow_the_inputs_without_a_step() {
    let import = open(&model(Kind::Contact, "bench-b", true), Version::Three);
    let variable = |name: &str| import.variable(name).unwrap();
    let mut slave = Slave::start(&import, &[], 0.0).unwrap();
    let mut force = |z_m: f64| {
        slave.set(variable("journal_z_m"), z_m).unwrap();
        slave.get(variable("force_z_n")).unwrap()
    };
    let [open, shallow, deep, again] = [-0.4e-3, -0.505e-3, -0.52e-3, -0.505e-3].map(&mut force);
    assert_eq!(open, 0.0);
    assert!(0.0 < shallow && shallow < deep, "{shallow} {deep}");
    assert_eq!(shallow, again, "reading does not change the networks");
}

#[test]
fn wrong_calls_are_refused_with_a_message() {
    let import = open(&model(Kind::Bench, "bench-b", false), Version::Two);
    let variable = |name: &str| import.variable(name).unwrap();
    let refused = |settings: &[(&str, f64)]| {
        let settings: Vec<_> = settings.iter().map(|(name, value)| (variable(name), *value)).collect();
        Slave::start(&import, &settings, 0.0).map(drop).unwrap_err().to_string()
    };
    for (settings, expected) in [
        (&[("shaft.mass_kg", -1.0)][..], "shaft.mass_kg"),
        (&[("load_n", f64::NAN)], "load_n"),
        (&[("tolerance", 1.0)], "tolerance: found 1; expected"),
        (&[("normal_force_n", 1.0)], "normal_force_n"),
        (&[("bearing.radial_clearance_m", 1.0)], "bearing.radial_clearance_m"),
    ] {
        let message = refused(settings);
        assert!(message.contains(expected) && message.contains("expected"), "{message}");
    }
    let mut slave = Slave::start(&import, &[], 0.0).unwrap();
    let late = slave.set(variable("shaft.mass_kg"), 120.0).unwrap_err().to_string();
    assert!(late.contains("fixed"), "{late}");
    assert!(slave.step(-1e-3).unwrap_err().to_string().contains("positive"));
    slave.step(1e-3).unwrap();
}

#[test]
fn combinations_that_a_unit_cannot_simulate_are_refused() {
    let open = |name: &str| Bench::open(name).unwrap();
    let model = |kind, bench, has_networks| Model::new(kind, bench, Path::new("."), has_networks, Vec::new());
    let servo = model(Kind::Bench, open("../../examples/rudder-servo.toml"), true).unwrap_err();
    assert!(servo.contains("servo: found"), "{servo}");
    let without = model(Kind::Mechanism, open("four-bar"), true).unwrap_err();
    assert!(without.contains("use_networks: found true"), "{without}");
    // A drive beyond its lever, and a contact beyond the range of its law.
    let import = self::open(&self::model(Kind::Bench, "bench-b", false), Version::Two);
    let variable = |name: &str| import.variable(name).unwrap();
    let settings = [(variable("external_drive"), 1.0), (variable("drive_speed_m_s"), 0.5)];
    let mut slave = Slave::start(&import, &settings, 0.0).unwrap();
    slave.set(variable("drive_m"), 5.0).unwrap();
    let far = slave.step(1e-3).unwrap_err().to_string();
    assert!(far.contains("drive_m: found 5") && far.contains("lever"), "{far}");
}

#[test]
fn parameters_are_the_numbers_of_the_description() {
    let changed = open(&model(Kind::Bench, "bench-b", false), Version::Two);
    let heavy = run(&changed, &[("shaft.mass_kg", 300.0)], &["journal_z_m"], 1e-3, 50);
    let mut bench = Bench::open("bench-b").unwrap();
    *bench.parameter_mut("shaft.mass_kg").unwrap() = 300.0;
    let model = Model::new(Kind::Bench, bench, Path::new("."), false, Vec::new()).unwrap();
    assert_eq!(heavy, run(&open(&model, Version::Two), &[], &["journal_z_m"], 1e-3, 50));
    let mass = model.variables().iter().find(|v| v.name == "shaft.mass_kg").unwrap();
    assert_eq!(
        (mass.causality, mass.kind, mass.unit, mass.start),
        (Causality::Fixed, Type::Real, "kg", 300.0)
    );
}

#[test]
fn inputs_replace_drive_and_load_only_where_a_parameter_says_so() {
    let import = open(&model(Kind::Bench, "bench-b", false), Version::Three);
    let names = ["load_force_n", "drive_displacement_m"];
    let inputs = [("load_n", -5e3), ("drive_m", 0.02)];
    let described = run(&import, &[], &names, 1e-3, 150);
    assert_eq!(run(&import, &inputs, &names, 1e-3, 150), described);
    let switches = [("external_load", 1.0), ("external_drive", 1.0)];
    let replaced = run(&import, &[inputs, switches].concat(), &names, 1e-3, 150);
    assert!(replaced.iter().all(|row| row[..] == [-5e3, 0.02]), "{:?}", replaced[149]);
}

#[test]
fn the_same_content_gives_the_same_bytes_and_another_content_another_identifier() {
    let packed = |clearance_m: f64| {
        let mut bench = Bench::open("bench-b").unwrap();
        *bench.parameter_mut("bearing.radial_clearance_m").unwrap() = clearance_m;
        let model = Model::new(Kind::Bench, bench, Path::new("."), false, Vec::new()).unwrap();
        pack(&model, Version::Two, &[], &[], "test").unwrap()
    };
    assert_eq!(packed(0.5e-3), packed(0.5e-3));
    assert_ne!(packed(0.5e-3), packed(0.6e-3));
}

#[test]
fn plants_without_a_unit_are_refused() {
    let refused = |kind, bench: &str| {
        let bench = Bench::open(bench).unwrap();
        Model::new(kind, bench, Path::new("."), false, Vec::new()).map(drop).unwrap_err()
    };
    for (kind, bench) in [
        (Kind::Bench, "friction-rig"),
        (Kind::Contact, "slider-crank"),
        (Kind::Mechanism, "bench-b"),
        (Kind::Bench, "four-bar"),
    ] {
        let message = refused(kind, bench);
        assert!(message.contains("plant: found") && message.contains("expected"), "{message}");
    }
}

#[test]
fn files_that_are_no_units_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let good = file(folder.path(), &model(Kind::Contact, "bench-b", false), Version::Two);
    let bytes = std::fs::read(&good).unwrap();
    let refused = |bytes: &[u8]| {
        let path = folder.path().join("bad.fmu");
        std::fs::write(&path, bytes).unwrap();
        Import::open(&path).map(drop).unwrap_err().to_string()
    };
    assert!(refused(b"no archive").contains("ZIP"));
    assert!(refused(&bytes[..bytes.len() / 2]).contains("ZIP"));
    let with = |name: &str, xml: &str| {
        let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        writer.start_file(name, zip::write::SimpleFileOptions::DEFAULT).unwrap();
        std::io::Write::write_all(&mut writer, xml.as_bytes()).unwrap();
        refused(&writer.finish().unwrap().into_inner())
    };
    assert!(with("readme.txt", "").contains("modelDescription.xml"));
    assert!(with("modelDescription.xml", "<a").contains("modelDescription.xml"));
    for (version, content, expected) in [
        ("1.0", "", "fmiVersion"),
        ("2.0", "", "CoSimulation"),
        ("2.0", "<CoSimulation modelIdentifier=\"../a\"/>", "modelIdentifier"),
    ] {
        let xml = format!("<fmiModelDescription fmiVersion=\"{version}\">{content}</fmiModelDescription>");
        assert!(with("modelDescription.xml", &xml).contains(expected), "{xml}");
    }
    // A path out of the folder is not written.
    with("../escaped.txt", "x");
    assert!(!folder.path().parent().unwrap().join("escaped.txt").exists());
}
