//! All tests of the workspace, and a summary that names what was not compared or not run.

use crate::golden::Comparison;
use crate::run::{ChoreError, cargo, run, succeeds};
use crate::tally::Tally;
use crate::test_programs::{self, Choice};
use crate::{
    book, budget, c_check, cycles, firmware, fmu, golden, kernels, language, on_target, python, readme,
    setup, verify, workspace,
};
use std::time::Instant;

/// Ignored tests that write golden files: `--long` does not run them.
const WRITERS: &str = "write_the_exported_file";

/// Variable with which tests hide an effect twice.
const LONG: &str = "PINTLE_LONG";

/// Runs all checks and tests; with `is_long` also the ignored tests.
///
/// A wrong format or word ends the run at once. All tests run even if one of them or another check
/// fails. The last line has the format of cargo's own summary.
pub(crate) fn test(is_long: bool) -> Result<(), ChoreError> {
    let start = Instant::now();
    let mut skipped = build()?;
    let checks = std::thread::spawn(checks);
    let mut tally = Tally::default();
    let variables: &[_] = if is_long { &[(LONG, "1")] } else { &[] };
    let ran = test_programs::run_all(Choice::Usual, variables, &mut tally);
    let checked = checks.join().unwrap_or_else(|_| Err(ChoreError::ByHand("a check panicked".into())));
    ran?;
    // Separate, so that the first run tests `host-sim` without probes.
    tally.run(workspace::tests().args(["--features", "host-sim/fake-probe", "--test", "fake_probe"]))?;
    if is_long {
        let ignored = std::mem::take(&mut tally.ignored);
        let long = Instant::now();
        test_programs::run_all(Choice::IgnoredBut(WRITERS), variables, &mut tally)?;
        println!("\nran the ignored tests in {:.0} s", long.elapsed().as_secs_f64());
        tally.ignored.extend(ignored.into_iter().filter(|name| name.contains(WRITERS)));
    }
    match &checked {
        Ok(more) => skipped.extend_from_slice(more),
        Err(error) => {
            eprintln!("error: {error}");
            tally.failed_commands.push(error.to_string());
        }
    }
    for test in &tally.ignored {
        skipped.push(format!("ignored test: {test}"));
    }
    report(&skipped, is_long);
    println!("{}", tally.summary(start.elapsed().as_secs_f64()));
    match tally.failed_commands.first() {
        None => Ok(()),
        Some(line) => Err(ChoreError::Failed { line: line.clone(), status: "tests failed".into() }),
    }
}

/// Installs what is missing, and builds everything that the checks and tests need. Checks format,
/// language and kernels meanwhile. Returns what was skipped.
fn build() -> Result<Vec<String>, ChoreError> {
    let mut skipped = vec![];
    setup::setup()?;
    if !setup::browser() {
        skipped.push("pages in a browser: chromium is not installed".into());
    }
    // Firmware is linked on one core, so the tests are built beside it.
    let build = std::thread::spawn(|| run(workspace::tests().args(["--quiet", "--no-run"])));
    firmware::OTHER_CORE.build()?;
    firmware::DEFAULT.build_provoking()?;
    firmware::DEFAULT.build()?;
    if succeeds(cargo().args(["fmt", "--version"])) {
        run(cargo().args(["fmt", "--all", "--check"]))?;
    } else {
        skipped.push("format of the code: rustfmt is not installed".into());
    }
    language::check()?;
    kernels::kernels()?;
    build.join().unwrap_or_else(|_| Err(ChoreError::ByHand("the build of the tests panicked".into())))?;
    Ok(skipped)
}

/// Runs the checks that are no test programs: packages, golden figures, budgets. Returns what was
/// skipped.
fn checks() -> Result<Vec<String>, ChoreError> {
    verify::verify()?;
    let mut skipped = c_check::check()?;
    skipped.extend(fmu::check()?);
    skipped.extend(python::check()?);
    skipped.extend(book::check()?);
    on_target::emulated()?;
    for (figures, comparison) in [
        ("instruction counts", golden::check()?),
        ("cycles", cycles::check()?),
        ("sizes of the firmware", budget::check()?),
    ] {
        if comparison == Comparison::BudgetsOnly {
            skipped.push(format!(
                "golden {figures}: not the pinned compiler, so only the budgets were compared"
            ));
        }
    }
    readme::check()?;
    Ok(skipped)
}

/// Prints what was not compared or not run.
fn report(skipped: &[String], is_long: bool) {
    if skipped.is_empty() {
        println!("\neverything was compared and run");
        return;
    }
    println!("\nnot compared or not run ({}):", skipped.len());
    skipped.iter().for_each(|what| println!("  {what}"));
    if !is_long {
        println!("`cargo xtask test --long` runs the ignored tests, too");
    }
}
