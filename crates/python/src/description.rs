//! Bench descriptions as text, and their laws on arrays.

use crate::arrays::{Numbers, columns};
use crate::error::input;
use bench::description::TransmissionBench;
use bench::plants::transmission::{ContactView, Transmission};
use bench::{Bench, PRESETS};
use numpy::PyArray1;
use pyo3::types::{PyAnyMethods, PyBool, PyDict, PyDictMethods};
use pyo3::{Bound, PyAny, PyResult, Python, pyfunction};
use toml::{Table, Value};

/// Names of the presets.
#[pyfunction]
pub(crate) fn presets() -> Vec<&'static str> {
    PRESETS.iter().map(|(name, _)| *name).collect()
}

/// Opens a preset or a file. Returns the complete description and the name of its plant; paths in
/// it are absolute.
#[pyfunction]
pub(crate) fn open_description(name_or_file: &str) -> PyResult<(String, String)> {
    complete(&Bench::open(name_or_file).map_err(input)?)
}

/// The same for a text; `file` names it in messages, and its folder is that of relative paths.
#[pyfunction]
pub(crate) fn parse_description(text: &str, file: &str) -> PyResult<(String, String)> {
    complete(&Bench::parse(file, text).map_err(input)?)
}

fn complete(bench: &Bench) -> PyResult<(String, String)> {
    Ok((bench.to_toml().map_err(input)?, bench.plant_name().to_owned()))
}

/// Changes entries of a description, named by their path with dots: `bearing.radial_clearance_m`.
/// An entry of a list is named by its `name`, or by its number from 1. None removes an entry.
/// Checks the result.
#[pyfunction]
pub(crate) fn change_description(
    text: &str,
    changes: Vec<(String, Bound<'_, PyAny>)>,
) -> PyResult<(String, String)> {
    let mut table: Table = text.parse().map_err(|error: toml::de::Error| input(error))?;
    for (path, value) in changes {
        let (parent, key) = path.rsplit_once('.').map_or((None, path.as_str()), |(p, k)| (Some(p), k));
        let parent = match parent {
            None => &mut table,
            Some(names) => {
                names.split('.').try_fold(&mut table, |table, name| descend(&path, table, name))?
            }
        };
        if value.is_none() {
            parent.remove(key);
        } else {
            parent.insert(key.to_owned(), value_of(&path, &value)?);
        }
    }
    let changed = toml::to_string(&table).map_err(input)?;
    let bench = Bench::parse("changed description", &changed).map_err(input)?;
    complete(&bench)
}

/// Enters the table of a name, which is created if it is missing. The entry of a list follows the
/// list's name in brackets.
fn descend<'t>(path: &str, table: &'t mut Table, name: &str) -> PyResult<&'t mut Table> {
    let refuse = |found: &str| input(format!("{path}: found {found} at `{name}`; expected a table"));
    let (name, entry) =
        name.split_once('[').map_or((name, None), |(n, e)| (n, Some(e.trim_end_matches(']'))));
    let value = table.entry(name.to_owned()).or_insert_with(|| Value::Table(Table::new()));
    match (value, entry) {
        (Value::Table(table), None) => Ok(table),
        (Value::Array(entries), Some(entry)) => {
            let number = entry.parse::<usize>().ok();
            let is_named = |value: &Value| value.get("name").and_then(Value::as_str) == Some(entry);
            let index = entries.iter().position(is_named).or(number.and_then(|number| number.checked_sub(1)));
            match index.and_then(|index| entries.get_mut(index)) {
                Some(Value::Table(table)) => Ok(table),
                _ => Err(refuse(&format!("no entry `{entry}`"))),
            }
        }
        (Value::Array(_), None) => Err(refuse("a list, whose entries are `[name]` or `[number]`,")),
        (_, _) => Err(refuse("a value")),
    }
}

/// Converts a truth value, a number, a text, or a list or table of them.
fn value_of(path: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::Boolean(value.extract()?));
    }
    if let Ok(number) = value.extract::<i64>() {
        return Ok(Value::Integer(number));
    }
    if let Ok(number) = value.extract::<f64>() {
        return Ok(Value::Float(number));
    }
    if let Ok(text) = value.extract::<String>() {
        return Ok(Value::String(text));
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let entry = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok((key.extract::<String>()?, value_of(path, &value)?))
        };
        return Ok(Value::Table(table.iter().map(entry).collect::<PyResult<Table>>()?));
    }
    if let Ok(entries) = value.extract::<Vec<Bound<'_, PyAny>>>() {
        let entries = entries.iter().map(|entry| value_of(path, entry));
        return Ok(Value::Array(entries.collect::<PyResult<_>>()?));
    }
    Err(input(format!(
        "{path}: found {}; expected a number, text, truth value, list or table",
        value.get_type()
    )))
}

/// Arrays of normal and friction force.
type Forces<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Evaluates the contact and friction law of a transmission bench's description. Deformation in m,
/// its rate, the approach speed latched at onset and the sliding speed in m/s; returns the normal
/// and the friction force in N, NaN for a state that is not finite. A friction law with a state is
/// taken in its steady state.
#[pyfunction]
pub(crate) fn contact_forces<'py>(
    py: Python<'py>,
    text: &str,
    deformation_m: Numbers<'_>,
    rate_m_s: Numbers<'_>,
    approach_m_s: Numbers<'_>,
    sliding_m_s: Numbers<'_>,
) -> PyResult<Forces<'py>> {
    let bench = Bench::parse("description", text).map_err(input)?;
    let bench = TransmissionBench::from_bench(bench, "description").map_err(input)?;
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let [deformation, rate, approach, sliding] = columns([
        ("deformation_m", &deformation_m),
        ("rate_m_s", &rate_m_s),
        ("approach_m_s", &approach_m_s),
        ("sliding_m_s", &sliding_m_s),
    ])?;
    let rows = deformation.iter().zip(&rate).zip(&approach).zip(&sliding);
    let (normal, friction): (Vec<f64>, Vec<f64>) = rows
        .map(|(((deformation_m, rate_m_s), latched_m_s), sliding_speed_m_s)| {
            if ![deformation_m, rate_m_s, latched_m_s, sliding_speed_m_s].iter().all(|v| v.is_finite()) {
                return (f64::NAN, f64::NAN);
            }
            let forces = plant.law(&ContactView {
                radial_clearance_m: plant.radial_clearance_m(),
                deformation_m: *deformation_m,
                rate_m_s: *rate_m_s,
                latched_m_s: *latched_m_s,
                sliding_speed_m_s: *sliding_speed_m_s,
            });
            (forces.normal_n, forces.friction_n)
        })
        .unzip();
    Ok((PyArray1::from_vec(py, normal), PyArray1::from_vec(py, friction)))
}
