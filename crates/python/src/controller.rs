//! A controller that estimates the contact of samples in arrays.

use crate::arrays::{Numbers, columns};
use crate::error::{input, of_command, work};
use bench::Bench;
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use host_sim::controller::choice::read_link_key;
use host_sim::controller::{AttachedController, EmulatedController, NativeController};
use host_sim::controller::{ControllerError, RemoteController};
use host_sim::device::update::{UpdateError, update};
use host_sim::run::configuration::lockstep_configuration;
use host_sim::run::{estimates, impacts, sensing};
use link::authentication::LinkKey;
use link::track::{SensorChannel, SensorStatus};
use link::{Answer, Command, ContactSource, EstimateFrame, ImpactRecord};
use model_quant::exchange::package::Package;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::{Bound, PyErr, PyResult, Python, pyclass, pymethods};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number of samples between two looks for an interruption.
const LOOK_SAMPLES: usize = 256;

/// Way to a controller.
enum Way {
    Native(Box<NativeController>),
    Remote(Box<RemoteController>),
}

/// A controller with the state of its estimation.
struct Device {
    way: Way,
    /// Number of the next sample.
    sequence: u32,
    /// Time between two samples; none without a configuration.
    period_s: Option<f64>,
    /// Last good reading of every channel.
    last: [f64; 4],
}

/// A controller: the firmware's code in this process, its image in the emulator, or a board on a
/// serial port. Calls of several threads wait for each other.
#[pyclass(module = "pintle", frozen)]
pub(crate) struct Controller {
    device: Mutex<Device>,
}

/// Estimates: names with arrays, flags, and the ended impacts as CSV.
type Estimates<'py> = (Vec<(&'static str, Bound<'py, PyArray1<f32>>)>, Bound<'py, PyArray1<u32>>, String);

/// Reads the file of a key of the link.
fn key(path: Option<&str>) -> PyResult<Option<LinkKey>> {
    path.map(|path| read_link_key(path).map_err(|error| input(format!("{path}: {error}")))).transpose()
}

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
    fn emulated(elf: Option<PathBuf>, link_key: Option<&str>) -> PyResult<Self> {
        let elf = elf.unwrap_or_else(EmulatedController::default_elf);
        let key = key(link_key)?;
        Ok(Self::remote(EmulatedController::open(&elf).map_err(failed)?.with_key(key)))
    }

    /// Connects to a board on a serial port.
    #[staticmethod]
    fn attached(port: PathBuf, link_key: Option<&str>) -> PyResult<Self> {
        let key = key(link_key)?;
        Ok(Self::remote(AttachedController::open(&port).map_err(failed)?.with_key(key)))
    }

    /// Sends a signed package of networks, and returns the bytes that were sent.
    fn update(&self, py: Python<'_>, package: &[u8]) -> PyResult<u32> {
        let package =
            Package::parse(package).map_err(|error| input(format!("not a model package: {error}")))?;
        py.detach(|| {
            let mut device = self.device();
            if device.period_s.is_some() {
                return Err(input("update: found a controller that estimates; expected `stop` before"));
            }
            match &mut device.way {
                Way::Native(_) => {
                    Err(input("update: found the native controller; expected an emulated or attached one"))
                }
                Way::Remote(remote) => match update(&mut **remote, &package, |_| {}) {
                    Ok(updated) => Ok(updated.sent_bytes),
                    Err(UpdateError::NotPermitted(error)) => Err(failed(error)),
                    Err(error) => Err(work(error)),
                },
            }
        })
    }

    /// Configures the controller for a description, with the time between two samples in s.
    fn configure(&self, py: Python<'_>, description: &str, period_s: f64, contact: &str) -> PyResult<()> {
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
        py.detach(|| {
            let mut device = self.device();
            device.controller().order(Command::Configure(configuration)).map_err(failed)?;
            (device.sequence, device.period_s, device.last) = (0, Some(period_s), [0.0; 4]);
            Ok(())
        })
    }

    /// Estimates samples: journal along y and z in m, shaft angle in rad, load in N. `numbers`
    /// count them from 0 in ascending order; the controller notices a gap. A reading that is not
    /// finite is missing. Returns the estimates and the impacts that have ended.
    #[allow(clippy::too_many_arguments)]
    fn estimate<'py>(
        &self,
        py: Python<'py>,
        numbers: PyReadonlyArray1<'_, u32>,
        journal_y_m: Numbers<'_>,
        journal_z_m: Numbers<'_>,
        shaft_angle_rad: Numbers<'_>,
        load_force_n: Numbers<'_>,
    ) -> PyResult<Estimates<'py>> {
        let [y, z, angle, load] = columns([
            ("journal_y_m", &journal_y_m),
            ("journal_z_m", &journal_z_m),
            ("shaft_angle_rad", &shaft_angle_rad),
            ("load_force_n", &load_force_n),
        ])?;
        let rows = numbers.as_array().to_vec().into_iter().zip(y).zip(z).zip(angle).zip(load);
        let rows: Vec<Row> = rows.map(|((((n, y), z), a), l)| (n, [y, z, a, l])).collect();
        let (mut found, mut ended) = (Vec::with_capacity(rows.len()), Vec::new());
        let start = self.device().sequence;
        for part in rows.chunks(LOOK_SAMPLES) {
            py.check_signals()?;
            py.detach(|| self.device().exchange(start, part, &mut found, &mut ended))?;
        }
        let column =
            |(name, value): estimates::Column| (name, PyArray1::from_iter(py, found.iter().map(value)));
        let flags = PyArray1::from_iter(py, found.iter().map(|estimate| estimate.flags));
        Ok((estimates::COLUMNS.into_iter().map(column).collect(), flags, impacts::to_csv(&ended)))
    }

    /// Ends the estimation. Returns the controller's counters as JSON, and the impact that was open
    /// as CSV.
    fn stop(&self, py: Python<'_>) -> PyResult<(String, String)> {
        py.detach(|| {
            let mut device = self.device();
            let answer = device.controller().order(Command::Stop).map_err(failed)?;
            device.period_s = None;
            let ended = impacts::to_csv(&device.controller().take_impacts());
            match answer {
                Answer::Stopped(counters) => Ok((serde_json::to_string(&counters).map_err(work)?, ended)),
                other => Err(work(format!("unexpected answer {other:?}; expected the counters"))),
            }
        })
    }

    /// `native`, `emulated` or `attached`.
    #[getter]
    fn name(&self) -> &'static str {
        self.device().controller().name()
    }
}

impl Controller {
    fn new(way: Way) -> Self {
        Self { device: Mutex::new(Device { way, sequence: 0, period_s: None, last: [0.0; 4] }) }
    }

    fn remote(controller: RemoteController) -> Self {
        Self::new(Way::Remote(Box::new(controller)))
    }

    fn device(&self) -> MutexGuard<'_, Device> {
        self.device.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Number of a sample, and its readings.
type Row = (u32, [f64; 4]);

impl Device {
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
        start: u32,
        rows: &[Row],
        found: &mut Vec<EstimateFrame>,
        ended: &mut Vec<ImpactRecord>,
    ) -> PyResult<()> {
        let Some(period_s) = self.period_s else {
            let text = "estimate: found a controller without a configuration; expected `configure` first";
            return Err(input(text));
        };
        for (number, readings) in rows {
            let mut status = SensorStatus::GOOD;
            for ((channel, reading), last) in SensorChannel::ALL.into_iter().zip(readings).zip(&mut self.last)
            {
                if reading.is_finite() {
                    *last = *reading;
                } else {
                    status = status.missing(channel);
                }
            }
            let sequence = start.wrapping_add(*number);
            let frame = sensing::frame(sequence, f64::from(sequence) * period_s, self.last);
            found.push(self.controller().sample(&frame, status).map_err(failed)?);
            self.sequence = sequence.wrapping_add(1);
            ended.extend(self.controller().take_impacts());
        }
        Ok(())
    }
}
