//! Behaviour that every command shares: amount of text, colours, completions, manual pages, exit
//! codes of verdicts, and outputs that cannot be written.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use std::path::Path;
use std::process::{Command, Output};

const LAW: [&str; 5] = ["run", "--force", "law", "--controller", "none"];

fn command(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command.current_dir(directory).args(arguments);
    command
}

fn host_sim(directory: &Path, arguments: &[&str]) -> Output {
    command(directory, arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn names(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap();
    entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
}

#[test]
fn a_quiet_command_prints_only_its_result_in_json() {
    let directory = tempfile::tempdir().unwrap();
    let quiet = host_sim(directory.path(), &[&LAW[..], &["--quiet"]].concat());
    assert!(quiet.status.success() && quiet.stdout.is_empty() && quiet.stderr.is_empty(), "{quiet:?}");
    let json = host_sim(directory.path(), &[&LAW[..], &["--quiet", "--json"]].concat());
    assert!(serde_json::from_slice::<serde_json::Value>(&json.stdout).is_ok(), "{json:?}");
    let wrong = host_sim(directory.path(), &["run", "--clearance-mm", "-1", "-q"]);
    assert!(text(&wrong.stderr).contains("radial_clearance_m"), "{wrong:?}");
}

#[test]
fn a_verbose_command_prints_its_steps_and_its_time_to_standard_error() {
    let directory = tempfile::tempdir().unwrap();
    let plain = host_sim(directory.path(), &["run"]);
    let verbose = host_sim(directory.path(), &["run", "--verbose"]);
    assert_eq!(text(&verbose.stdout).lines().next(), text(&plain.stdout).lines().next());
    let steps = text(&verbose.stderr);
    assert!(steps.contains("0 s: bench with quantised-net") && steps.contains("done in "), "{steps}");
    assert!(plain.stderr.is_empty(), "{plain:?}");
}

#[test]
fn an_error_is_coloured_where_that_is_asked_for_and_never_in_a_pipe() {
    let directory = tempfile::tempdir().unwrap();
    let error = |more: &[&str], no_color: bool| {
        let mut command = command(directory.path(), &[&["run", "--cycles", "0"], more].concat());
        if no_color {
            command.env("NO_COLOR", "1");
        }
        text(&command.output().unwrap().stderr)
    };
    assert!(error(&[], false).starts_with("error: "), "{:?}", error(&[], false));
    assert!(error(&["--color", "always"], false).starts_with("\u{1b}[1;31merror:\u{1b}[0m "));
    assert!(error(&["--color", "never"], false).starts_with("error: "));
    assert!(error(&[], true).starts_with("error: "));
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let directory = tempfile::tempdir().unwrap();
    let help = text(&host_sim(directory.path(), &["--help"]).stdout);
    let block = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap().to_owned();
    let commands: Vec<&str> = block
        .lines()
        .filter_map(|line| line.strip_prefix("  ").filter(|rest| !rest.starts_with(' '))?.split(' ').next())
        .collect();
    assert!(commands.len() > 15, "{commands:?}");
    for name in commands.iter().filter(|name| **name != "help") {
        let help = text(&host_sim(directory.path(), &[name, "--help"]).stdout);
        let wide = help.lines().find(|line| line.chars().count() > 100);
        assert!(!help.is_empty() && wide.is_none(), "{name}: {wide:?}");
    }
    for shell in ["bash", "zsh", "fish"] {
        let script = text(&host_sim(directory.path(), &["completions", shell]).stdout);
        commands.iter().for_each(|name| assert!(script.contains(name), "{shell}: {name}"));
        assert!(script.contains("fail-on"), "{shell}");
    }
    assert!(host_sim(directory.path(), &["man", "--out", "pages"]).status.success());
    let pages = names(&directory.path().join("pages"));
    for name in commands.iter().filter(|name| **name != "help") {
        assert!(pages.contains(&format!("host-sim-{name}.1")), "{name}: {pages:?}");
    }
}

#[test]
fn a_verdict_fails_the_command_where_that_is_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    // The example without the names of a foreign log.
    let example = include_str!("../../examples/servo-axis.toml");
    let (described, _) = example.split_once("[columns]").unwrap();
    let effect = "[[effects]]\nname = \"viscous-friction\"\nviscous_effort = 8.0\n";
    std::fs::write(directory.path().join("axis.toml"), described).unwrap();
    std::fs::write(directory.path().join("other.toml"), format!("{described}{effect}")).unwrap();
    let record = |bench: &str| {
        let output = host_sim(directory.path(), &["record", "--bench", bench, "--out", "log.csv"]);
        assert!(output.status.success(), "{output:?}");
    };
    let diagnose = |more: &[&str]| {
        let fixed = ["diagnose", "log.csv", "--bench", "axis.toml", "--json"];
        let output = host_sim(directory.path(), &[&fixed[..], more].concat());
        let diagnosis: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), diagnosis["verdict"].as_str().unwrap().to_owned(), text(&output.stderr))
    };
    record("axis.toml");
    // The log of the bench as described has no cause.
    assert_eq!(diagnose(&["--fail-on", "named,unknown"]).0, Some(0));
    record("other.toml");
    assert_eq!(diagnose(&[]).0, Some(0));
    assert_eq!(diagnose(&["--fail-on", "unknown"]).0, Some(0));
    let (code, verdict, message) = diagnose(&["--fail-on", "named"]);
    assert_eq!((code, verdict.as_str()), (Some(1), "named"));
    assert!(message.contains("--fail-on: the verdict is `named`"), "{message}");
    assert!(directory.path().join("out/diagnosis/report.html").exists());
}

#[test]
fn an_output_that_cannot_be_used_is_refused_before_the_work() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("taken"), "a file, not a folder").unwrap();
    let record = host_sim(directory.path(), &["record", "--bench", "bench-b", "--out", "log.csv"]);
    assert!(record.status.success(), "{record:?}");
    for arguments in [
        &["run", "--out", "taken"][..],
        &["run", "--out", "taken/below"],
        &["diagnose", "log.csv", "--out", "taken"],
        &["evaluate", "log.csv", "--out", "taken"],
        &["record", "--out", "taken/log.csv"],
        &["accuracy", "--worlds", "100", "--out", "taken"],
    ] {
        let output = host_sim(directory.path(), &[arguments, &["--verbose"]].concat());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        assert!(message.contains("taken: found a file; expected a folder"), "{arguments:?}: {message}");
        assert!(!message.contains(" s: "), "{arguments:?} worked first: {message}");
    }
    assert_eq!(std::fs::read(directory.path().join("taken")).unwrap(), b"a file, not a folder");
}

/// The limit of the size of a file is that of a full disk: the first files of a set fit, a later
/// one does not.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_no_part_of_a_result_and_exits_with_1() {
    let directory = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_host-sim");
    for (arguments, folder) in [
        ("run --force law --controller none --out small", "small"),
        ("record --out small/log.csv", "small"),
        ("sweep latch --out small", "small"),
    ] {
        // Blocks of 512 bytes.
        let script = format!("trap '' XFSZ; ulimit -f 32; exec '{program}' {arguments}");
        let output = Command::new("sh").args(["-c", &script]).current_dir(directory.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments}: {}", text(&output.stderr));
        assert!(text(&output.stderr).contains("cannot be written"), "{arguments}: {}", text(&output.stderr));
        assert_eq!(names(&directory.path().join(folder)), Vec::<String>::new(), "{arguments}");
    }
}

#[test]
fn no_file_of_an_earlier_run_stays_beside_a_new_one() {
    let directory = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| host_sim(directory.path(), &[&LAW[..], &["--out", "one"], more].concat());
    assert!(run(&["--cycles", "3"]).status.success());
    let folder = directory.path().join("one");
    assert!(folder.join("cycles.csv").exists());
    assert!(run(&[]).status.success());
    assert!(!folder.join("cycles.csv").exists() && folder.join("run.json").exists());
    // A folder in the way of one file keeps all the others as they were.
    let before = std::fs::read(folder.join("run.json")).unwrap();
    std::fs::remove_file(folder.join("report.html")).unwrap();
    std::fs::create_dir(folder.join("report.html")).unwrap();
    let refused = run(&["--load-kn", "5"]);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    assert!(text(&refused.stderr).contains("report.html: cannot be written: found a folder"), "{refused:?}");
    assert_eq!(std::fs::read(folder.join("run.json")).unwrap(), before);
}

#[test]
fn published_conditions_refuse_other_courses_of_the_drive() {
    let directory = tempfile::tempdir().unwrap();
    let (_, preset) = bench::PRESETS[0];
    for section in [
        "[drive_profile]\nkind = \"sine\"\nheight = 0.1\n",
        "[load_profile]\nkind = \"sine\"\nheight = 100.0\n",
        "[servo]\nkp = 10.0\nfull_speed_m_s = 0.4\ncompliance_m_n = 5e-8\n",
    ] {
        let other = preset.replacen("[logging]", &format!("{section}\n[logging]"), 1);
        std::fs::write(directory.path().join("other.toml"), other).unwrap();
        for command in [&["claims", "--runs", "1"][..], &["sweep", "clearance"], &["figures"]] {
            let output = host_sim(directory.path(), &[command, &["--bench", "other.toml"]].concat());
            let message = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{section}{command:?}: {message}");
            assert!(message.contains("expected the sine and the constant load"), "{command:?}: {message}");
        }
    }
}

#[test]
fn sweeps_do_not_mix_their_results_and_threads_are_bounded() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::create_dir(directory.path().join("results")).unwrap();
    std::fs::write(directory.path().join("results/sweep.json"), r#"{"sweep": "clearance"}"#).unwrap();
    for arguments in [
        &["sweep", "load", "--out", "results"][..],
        &["sweep", "latch", "--out", "results"],
        &["figures", "--out", "results"],
    ] {
        let output = host_sim(directory.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stderr));
        assert!(text(&output.stderr).contains("found the results of sweep `clearance`"), "{arguments:?}");
    }
    for command in [&["sweep", "clearance"][..], &["accuracy"], &["figures"], &["claims"]] {
        let output = host_sim(directory.path(), &[command, &["--threads", "99999"]].concat());
        assert_eq!(output.status.code(), Some(2), "{command:?}: {}", text(&output.stderr));
    }
}

#[test]
fn a_wrong_firmware_image_is_wrong_input() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("garbage.elf"), "no image").unwrap();
    for (elf, expected) in [("garbage.elf", "found no ELF image for ARM"), ("none.elf", "no firmware there")]
    {
        for arguments in [
            &["link", "--controller", "emulated", "--elf", elf][..],
            &["flash", "--board", "stm32f405", "--dry-run", "--elf", elf],
        ] {
            let output = host_sim(directory.path(), arguments);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stderr));
            if arguments[0] == "link" {
                assert!(text(&output.stderr).contains(expected), "{arguments:?}: {}", text(&output.stderr));
            }
            assert!(!text(&output.stderr).contains("os error"), "{arguments:?}: {}", text(&output.stderr));
        }
    }
}
