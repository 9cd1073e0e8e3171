//! Log files of every format as arrays.

use crate::arrays::Numbers;
use crate::error::{input, of_command, work};
use bench::log::{RawColumn, RawLog};
use bench::{Bench, Channel, MeasuredLog};
use host_sim::replay;
use numpy::PyArray1;
use pyo3::{Bound, PyResult, Python, pyfunction};
use std::path::PathBuf;

/// Column: name, unit, group, values.
type Column<'py> = (String, String, String, Bound<'py, PyArray1<f64>>);

/// Reads the columns of numbers of a log. Returns the file's format and the columns.
#[pyfunction]
pub(crate) fn read_log(py: Python<'_>, path: PathBuf) -> PyResult<(&'static str, Vec<Column<'_>>)> {
    let log = py.detach(|| RawLog::read(&path)).map_err(input)?;
    let column = |column: RawColumn| {
        let name = column.label();
        (name, column.unit, column.group, PyArray1::from_vec(py, column.values))
    };
    Ok((log.file_format, log.columns.into_iter().map(column).collect()))
}

/// Samples of a log: time between two in s, their numbers, and names with arrays in SI units.
type Samples<'py> = (f64, Bound<'py, PyArray1<u32>>, Vec<(&'static str, Bound<'py, PyArray1<f64>>)>);

/// Reads the time and the channels of a log as a description names them; missing readings are NaN.
#[pyfunction]
pub(crate) fn read_samples<'py>(py: Python<'py>, path: PathBuf, description: &str) -> PyResult<Samples<'py>> {
    let bench = Bench::parse("description", description).map_err(input)?;
    let log = py.detach(|| MeasuredLog::read_as_found(&path, &bench.log_format())).map_err(input)?;
    let period_s = replay::log::period_s(&log).map_err(of_command)?;
    let numbers = replay::log::numbers(&log, period_s).map_err(of_command)?;
    let time = ("t_s", PyArray1::from_vec(py, log.time_s));
    let channels = log.channels.into_iter();
    let channels = channels.map(|(channel, values)| (channel.name(), PyArray1::from_vec(py, values)));
    Ok((period_s, PyArray1::from_vec(py, numbers), std::iter::once(time).chain(channels).collect()))
}

/// Names of the channels with their units.
#[pyfunction]
pub(crate) fn channels() -> Vec<(&'static str, &'static str)> {
    Channel::ALL.iter().map(|channel| (channel.name(), channel.unit())).collect()
}

/// Writes columns with names and units: Parquet to `.parquet`, a MAT-file to `.mat`, else CSV.
#[pyfunction]
pub(crate) fn write_log(path: PathBuf, columns: Vec<(String, String, Numbers<'_>)>) -> PyResult<()> {
    let column = |(index, (name, unit, values)): (usize, (String, String, Numbers<'_>))| RawColumn {
        index,
        name,
        unit,
        group: String::new(),
        time: None,
        values: values.as_array().to_vec(),
    };
    let columns: Vec<RawColumn> = columns.into_iter().enumerate().map(column).collect();
    let source = path.display().to_string();
    RawLog::write(&source, &path, &columns.iter().collect::<Vec<_>>()).map_err(work)
}
