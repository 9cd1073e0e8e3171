//! `host-sim run`: one run of the bench with the estimator, its log, its figures and its report.

use crate::cli::error::CliError;
use crate::cli::output::{self, Files};
use crate::run::force::ForceSource;
use crate::run::{
    ControllerChoice, RunArgs, estimates, execute_live, impacts, mechanism, page, report, settled,
    slider_crank, tilt,
};
use crate::serve::Server;
use bench::Bench;
use bench::simulate::impact_table;

/// Runs the command.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    let bench = Bench::open(&args.bench.bench)?;
    output::check_folder(&args.out)?;
    if matches!(bench, Bench::SliderCrank(_) | Bench::Mechanism(_)) {
        args.bench.check_changes(&bench)?;
        if matches!(bench, Bench::SliderCrank(_)) {
            args.check_uncontrolled(bench.plant_name(), false)?;
            if args.force.is_some_and(|source| source != ForceSource::Law) {
                return Err(CliError::Input("--force: found plant `slider-crank`; expected law".into()));
            }
        }
    }
    match &bench.resolved() {
        Bench::SliderCrank(plant) => return slider_crank::run(plant, args),
        Bench::Mechanism(plant) => return mechanism::run(plant, args),
        _ => {}
    }
    let needing = [
        ("--watch", args.watch),
        ("--serve", args.serve.serve.is_some()),
        ("--record", args.record.is_some()),
    ];
    let needing = needing.into_iter().find(|(_, is_given)| *is_given);
    if let (ControllerChoice::None, Some((option, _))) = (args.controller, needing) {
        return Err(CliError::Input(format!("{option}: found --controller none; expected a controller")));
    }
    let server = Server::open(&args.serve)?;
    let result = run_transmission(args, server.as_ref());
    if let Some(server) = server {
        server.finish(result.as_ref().err());
    }
    result
}

/// Runs a bench with a controller, and writes and prints its results.
fn run_transmission(args: &RunArgs, server: Option<&Server>) -> Result<(), CliError> {
    let finished = execute_live(args, server)?;
    let contacts = impact_table::to_csv(&finished.forced.run.impacts, finished.bench.contact.latch_floor_m_s);
    let page = page::page(&finished).map_err(CliError::Work)?;
    let mut files = Files::new(&args.out);
    [tilt::FILE_NAME, settled::FILE_NAME, estimates::FILE_NAME, impacts::FILE_NAME]
        .into_iter()
        .for_each(|name| files.leave_out(name));
    files.add("log.csv", &finished.log(args.seed).to_csv())?;
    files.add(impact_table::FILE_NAME, &contacts)?;
    if !finished.forced.tilting.is_empty() {
        let table = tilt::to_csv(&finished.forced.tilting, finished.log_interval());
        files.add(tilt::FILE_NAME, &table)?;
    }
    if let (Some(path), Some(recording)) = (&args.record, &finished.recording) {
        recording.write(path).map_err(|e| CliError::output(path, &e))?;
    }
    if let Some(exchange) = &finished.exchange {
        let table = estimates::to_csv(&exchange.estimates);
        files.add(estimates::FILE_NAME, &table)?;
        files.add(impacts::FILE_NAME, &impacts::to_csv(&exchange.impacts))?;
    }
    if let Some(found) = &finished.summary.settled {
        files.add(settled::FILE_NAME, &found.cycles_csv())?;
    }
    let json = files.add_result("run.json", &finished.summary)?;
    files.add_page("report.html", page)?;
    files.publish()?;
    if args.json {
        print_result!("{json}");
    } else {
        for row in report::rows(&finished.summary) {
            print_line!("{:<44} {:>14}", row[0], row[1]);
        }
        report::print_audit(&finished);
        print_line!("\nreport: {}", args.out.join("report.html").display());
    }
    Ok(())
}
