//! A controller that estimates the contact of samples in arrays.

use crate::arrays::{Numbers, columns};
use crate::error::{input, of_command, work};
use bench::Bench;
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use host_sim::controller::{AttachedController, Controller as _, EmulatedController, NativeController};
use host_sim::controller::{ControllerError, RemoteController};
use host_sim::device::update::update;
use host_sim::run::configuration::lockstep_configuration;
use host_sim::run::{estimates, impacts, sensing};
use link::track::{SensorChannel, SensorStatus};
use link::{Answer, Command, ContactSource, EstimateFrame, ImpactRecord};
use model_quant::exchange::package::Package;
use numpy::PyArray1;
use pyo3::{Bound, PyErr, PyResult, Python, pyclass, pymethods};
use std::path::PathBuf;

/// Way to a controller.
enum Way {
    Native(Box<NativeController>),
    Remote(Box<RemoteController>),
}

/// A controller: the firmware's code in this process, its image in the emulator, or a board on a
/// serial port.
#[pyclass(module = "pintle", unsendable)]
pub(crate) struct Controller {
    way: Way,
    /// Samples estimated since the configuration.
    sequence: u32,
    period_s: f64,
}

/// Estimates: names with arrays, flags, and the ended impacts as CSV.
type Estimates<'py> = (Vec<(&'static str, Bound<'py, PyArray1<f32>>)>, Bound<'py, PyArray1<u32>>, String);

fn failed(error: ControllerError) -> PyErr {
    of_command(error.into())
}

#[pymethods]
impl Controller {
    /// Starts the firmware's code in this process.
    #[staticmethod]
    fn native() -> PyResult<Self> {
        Ok(Self::new(Way::Native(Box::new(NativeController::open().map_err(failed)?))))
    }

    /// Starts the firmware's image in the emulator.
    #[staticmethod]
    fn emulated(elf: Option<PathBuf>) -> PyResult<Self> {
        let elf = elf.unwrap_or_else(EmulatedController::default_elf);
        Ok(Self::new(Way::Remote(Box::new(EmulatedController::open(&elf).map_err(failed)?))))
    }

    /// Connects to a board on a serial port.
    #[staticmethod]
    fn attached(port: PathBuf) -> PyResult<Self> {
        Ok(Self::new(Way::Remote(Box::new(AttachedController::open(&port).map_err(failed)?))))
    }

    /// Sends a signed package of networks, and returns the bytes that were sent. The controller
    /// refuses it while it estimates.
    fn update(&mut self, package: &[u8]) -> PyResult<u32> {
        let Way::Remote(remote) = &mut self.way else {
            return Err(input("update: found the native controller; expected an emulated or attached one"));
        };
        let package =
            Package::parse(package).map_err(|error| input(format!("not a model package: {error}")))?;
        Ok(update(&mut **remote, &package, |_| {}).map_err(work)?.sent_bytes)
    }

    /// Configures the controller for a description, with the time between two samples in s.
    fn configure(&mut self, description: &str, period_s: f64, contact: &str) -> PyResult<()> {
        let bench = Bench::parse("description", description).map_err(input)?;
        let bench = TransmissionBench::from_bench(bench.resolved(), "description").map_err(input)?;
        let contact = match contact {
            "network" => ContactSource::Network,
            "law" => ContactSource::Law,
            other => return Err(input(format!("contact: found `{other}`; expected `network` or `law`"))),
        };
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let configuration =
            lockstep_configuration(&plant, &bench, 1.0 / period_s, contact).map_err(of_command)?;
        self.controller().order(Command::Configure(configuration)).map_err(failed)?;
        (self.sequence, self.period_s) = (0, period_s);
        Ok(())
    }

    /// Estimates samples: journal along y and z in m, shaft angle in rad, load in N. A reading that
    /// is not finite is missing. Returns the estimates and the impacts that have ended.
    fn estimate<'py>(
        &mut self,
        py: Python<'py>,
        journal_y_m: Numbers<'_>,
        journal_z_m: Numbers<'_>,
        shaft_angle_rad: Numbers<'_>,
        load_force_n: Numbers<'_>,
    ) -> PyResult<Estimates<'py>> {
        if self.period_s == 0.0 {
            return Err(input(
                "estimate: found a controller without a configuration; expected `configure` first",
            ));
        }
        let [y, z, angle, load] = columns([
            ("journal_y_m", &journal_y_m),
            ("journal_z_m", &journal_z_m),
            ("shaft_angle_rad", &shaft_angle_rad),
            ("load_force_n", &load_force_n),
        ])?;
        let rows: Vec<[f64; 4]> =
            y.iter().zip(&z).zip(&angle).zip(&load).map(|(((y, z), a), l)| [*y, *z, *a, *l]).collect();
        let (found, ended) = self.exchange(&rows).map_err(failed)?;
        let column =
            |(name, value): estimates::Column| (name, PyArray1::from_iter(py, found.iter().map(value)));
        let flags = PyArray1::from_iter(py, found.iter().map(|estimate| estimate.flags));
        Ok((estimates::COLUMNS.into_iter().map(column).collect(), flags, impacts::to_csv(&ended)))
    }

    /// Ends the estimation and returns the controller's counters as JSON.
    fn stop(&mut self) -> PyResult<String> {
        let answer = self.controller().order(Command::Stop).map_err(failed)?;
        self.period_s = 0.0;
        match answer {
            Answer::Stopped(counters) => serde_json::to_string(&counters).map_err(work),
            other => Err(work(format!("unexpected answer {other:?}; expected the counters"))),
        }
    }

    /// Impacts that ended since they were last asked for, as CSV.
    fn take_impacts(&mut self) -> String {
        impacts::to_csv(&self.controller().take_impacts())
    }

    /// `native`, `emulated` or `attached`.
    #[getter]
    fn name(&self) -> &'static str {
        match &self.way {
            Way::Native(controller) => controller.name(),
            Way::Remote(controller) => controller.name(),
        }
    }
}

impl Controller {
    fn new(way: Way) -> Self {
        Self { way, sequence: 0, period_s: 0.0 }
    }

    fn controller(&mut self) -> &mut dyn host_sim::controller::Controller {
        match &mut self.way {
            Way::Native(controller) => &mut **controller,
            Way::Remote(controller) => &mut **controller,
        }
    }

    /// Sends samples one after the other. A missing reading repeats the last good one of its
    /// channel, and the status marks it.
    fn exchange(
        &mut self,
        rows: &[[f64; 4]],
    ) -> Result<(Vec<EstimateFrame>, Vec<ImpactRecord>), ControllerError> {
        let (mut found, mut ended, mut last) = (Vec::with_capacity(rows.len()), Vec::new(), [0.0; 4]);
        for row in rows {
            let mut status = SensorStatus::GOOD;
            for ((channel, reading), last) in SensorChannel::ALL.into_iter().zip(row).zip(&mut last) {
                if reading.is_finite() {
                    *last = *reading;
                } else {
                    status = status.missing(channel);
                }
            }
            let frame = sensing::frame(self.sequence, f64::from(self.sequence) * self.period_s, last);
            found.push(self.controller().sample(&frame, status)?);
            self.sequence = self.sequence.wrapping_add(1);
            ended.extend(self.controller().take_impacts());
        }
        Ok((found, ended))
    }
}
