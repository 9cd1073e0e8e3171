//! A unit of another program with the meaning of its variables on the bench.

use crate::cli::error::CliError;
use bench::Bench;
use bench::log::Expression;
use bench::schema::unit_of_name;
use clap::Args;
use pintle_fmu::{Import, ImportError, ImportedVariable};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// Plant of another program.
#[derive(Args, Clone, Debug, Default)]
pub struct PlantOptions {
    /// Functional mock-up unit (FMI 2.0 or 3.0, co-simulation) that moves the journal in place of
    /// the bench's equations. Loading it runs its code.
    #[arg(long, value_name = "FILE")]
    pub plant_fmu: Option<PathBuf>,
    /// Quantity of the bench as an expression of the unit's variables, as in `[columns]`; other
    /// names than letters, digits, `_` and points in backticks. May be repeated; a variable with
    /// the name of a quantity needs none.
    #[arg(long, value_name = "QUANTITY=EXPRESSION", requires = "plant_fmu")]
    pub plant_output: Vec<String>,
    /// Variable of the unit that takes `force_y_n`, `force_z_n` or `torque_nm`, the action of the
    /// bearing on the journal. May be repeated.
    #[arg(long, value_name = "FORCE=VARIABLE", requires = "plant_fmu")]
    pub plant_input: Vec<String>,
    /// Start value of a parameter or an input of the unit. May be repeated.
    #[arg(long, value_name = "VARIABLE=NUMBER", requires = "plant_fmu")]
    pub plant_set: Vec<String>,
}

/// Unit that was the plant of a run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PlantFigures {
    /// File of the unit.
    pub file: String,
    /// Name of the model.
    pub model: String,
    /// Version of the interface.
    pub fmi: &'static str,
    /// Quantities that the unit gives.
    pub outputs: Vec<&'static str>,
    /// Forces that the unit takes; empty: it moves without the bearing's force.
    pub inputs: Vec<&'static str>,
    /// Options `--plant-output`, `--plant-input` and `--plant-set` as given.
    pub settings: Vec<String>,
}

/// Quantities that a unit may give. The rates of the others follow from differences where they are
/// missing; everything else is then 0.
pub(super) const QUANTITIES: [&str; 10] = [
    "journal_y_m",
    "journal_z_m",
    "shaft_angle_rad",
    "drive_displacement_m",
    "journal_velocity_y_m_s",
    "journal_velocity_z_m_s",
    "shaft_speed_rad_s",
    "drive_velocity_m_s",
    "load_force_n",
    "drive_force_n",
];
/// Number of quantities whose rates follow them in [`QUANTITIES`].
pub(super) const WITH_RATE: usize = 4;
/// Forces that a unit may take.
const FORCES: [&str; 3] = ["force_y_n", "force_z_n", "torque_nm"];

/// A unit with the meaning of its variables.
pub(crate) struct PlantUnit {
    file: PathBuf,
    pub(super) import: Import,
    /// Variables that are read, in the order of the expressions' columns.
    pub(super) read: Vec<ImportedVariable>,
    pub(super) quantities: [Option<Expression>; QUANTITIES.len()],
    pub(super) forces: [Option<ImportedVariable>; FORCES.len()],
    pub(super) start: Vec<(ImportedVariable, f64)>,
    settings: Vec<String>,
}

impl From<ImportError> for CliError {
    fn from(error: ImportError) -> Self {
        match error {
            ImportError::Unusable { .. } => Self::Input(error.to_string()),
            ImportError::Failed { .. } => Self::Work(error.to_string()),
        }
    }
}

impl PlantUnit {
    /// Opens the unit of the options and resolves the names; none without a unit. All flaws are
    /// reported at once.
    pub(crate) fn open(
        options: &PlantOptions,
        described: &Bench,
        has_load_option: bool,
    ) -> Result<Option<Self>, CliError> {
        let Some(file) = &options.plant_fmu else { return Ok(None) };
        let refuse = |what: &str| Err(CliError::Input(format!("{what}; expected none with --plant-fmu")));
        if !described.effects().is_empty() {
            return refuse("effects: found some, which act on the equations that the unit replaces");
        }
        if has_load_option {
            return refuse("--load-kn: found a load, which the unit gives");
        }
        let import = Import::open(file)?;
        let mut unit = Self {
            file: file.clone(),
            read: import.variables().iter().filter(|v| v.kind.is_some()).cloned().collect(),
            import,
            quantities: [const { None }; QUANTITIES.len()],
            forces: [const { None }; FORCES.len()],
            start: Vec::new(),
            settings: [&options.plant_output[..], &options.plant_input, &options.plant_set].concat(),
        };
        let mut flaws = Vec::new();
        for given in &options.plant_output {
            flaws.extend(unit.add_output(given).err());
        }
        for given in &options.plant_input {
            flaws.extend(unit.add_input(given).err());
        }
        for given in &options.plant_set {
            flaws.extend(unit.add_start(given).err());
        }
        flaws.extend(unit.add_same_names());
        if unit.quantities[..2].iter().all(Option::is_none) {
            let names: Vec<&str> = unit.read.iter().map(|v| v.name.as_str()).take(40).collect();
            flaws.push(format!(
                "--plant-output: found no journal_y_m or journal_z_m; expected one of them, as an expression \
                 of {}",
                names.join(", ")
            ));
        }
        if flaws.is_empty() { Ok(Some(unit)) } else { Err(CliError::Input(flaws.join("\n"))) }
    }

    fn add_output(&mut self, given: &str) -> Result<(), String> {
        let refuse = |found: &str, expected: &str| {
            Err(format!("--plant-output {given}: found {found}; expected {expected}"))
        };
        let Some((name, text)) = given.split_once('=') else {
            return refuse("no `=`", "QUANTITY=EXPRESSION");
        };
        let Some(place) = QUANTITIES.iter().position(|known| *known == name.trim()) else {
            return refuse(&format!("the quantity `{name}`"), &format!("one of {}", QUANTITIES.join(", ")));
        };
        let locate = |name: &str| self.read.iter().position(|variable| variable.name == name);
        let expression = Expression::parse(text.trim(), &locate)
            .map_err(|error| format!("--plant-output {given}: expression: {error}"))?;
        if let Some(unknown) = expression.unknown.first() {
            return refuse(&format!("the variable `{unknown}`"), "a variable of the unit");
        }
        if self.quantities[place].replace(expression).is_some() {
            return refuse("the quantity twice", "it once");
        }
        Ok(())
    }

    /// Takes results of the unit that have the names of quantities, where none was given. Returns
    /// those whose unit is another one.
    fn add_same_names(&mut self) -> Vec<String> {
        let mut flaws = Vec::new();
        for (name, place) in QUANTITIES.iter().zip(&mut self.quantities) {
            let is_result = |v: &ImportedVariable| ["output", "local"].contains(&v.causality.as_str());
            let index = self.read.iter().position(|variable| variable.name == *name && is_result(variable));
            let (None, Some(index)) = (&place, index) else { continue };
            let (found, expected) = (&self.read[index].unit, unit_of_name(name));
            if found.is_empty() || found == expected {
                *place = Some(Expression::column(index));
            } else {
                flaws.push(format!(
                    "{name}: found the unit {found}; expected {expected}, or --plant-output with a factor"
                ));
            }
        }
        flaws
    }

    fn add_input(&mut self, given: &str) -> Result<(), String> {
        let known = given.split_once('=').and_then(|(name, variable)| {
            let place = FORCES.iter().position(|known| *known == name.trim())?;
            Some((place, self.read.iter().find(|v| v.name == variable.trim() && v.causality == "input")?))
        });
        let Some((place, variable)) = known else {
            let inputs = self.read.iter().filter(|v| v.causality == "input").map(|v| v.name.as_str());
            return Err(format!(
                "--plant-input: found {given}; expected FORCE=VARIABLE with one of {} and an input of the \
                 unit: {}",
                FORCES.join(", "),
                inputs.collect::<Vec<_>>().join(", ")
            ));
        };
        let variable = variable.clone();
        if self.forces[place].is_some() || self.forces.iter().flatten().any(|taken| *taken == variable) {
            return Err(format!("--plant-input: found {given} beside another of it; expected each once"));
        }
        self.forces[place] = Some(variable);
        Ok(())
    }

    fn add_start(&mut self, given: &str) -> Result<(), String> {
        let known = given.rsplit_once('=').and_then(|(name, number)| {
            let variable = self.import.variable(name.trim()).filter(|v| v.kind.is_some())?;
            let number = number.trim().parse::<f64>().ok().filter(|number| variable.admits(*number))?;
            let is_new = self.start.iter().all(|(known, _)| known.name != variable.name);
            is_new.then(|| (variable.clone(), number))
        });
        let refused = || {
            format!(
                "--plant-set: found {given}; expected VARIABLE=NUMBER with a variable of the unit and a \
                 number of its type, each once"
            )
        };
        self.start.push(known.ok_or_else(refused)?);
        Ok(())
    }

    /// Description of the unit for the results.
    pub(super) fn figures(&self) -> PlantFigures {
        let outputs = QUANTITIES.iter().zip(&self.quantities).filter(|(_, given)| given.is_some());
        let inputs = FORCES.iter().zip(&self.forces).filter(|(_, given)| given.is_some());
        PlantFigures {
            file: self.file.display().to_string(),
            model: self.import.name().into(),
            fmi: self.import.version(),
            outputs: outputs.map(|(name, _)| *name).collect(),
            inputs: inputs.map(|(name, _)| *name).collect(),
            settings: self.settings.clone(),
        }
    }
}
