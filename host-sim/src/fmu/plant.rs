//! A unit of another program as the plant of a run: it moves the journal, and takes the force of
//! the bearing if it has inputs for that.

use crate::cli::error::CliError;
use crate::run::force::{ForceSource, ForcedRun, SAMPLE_RATE_HZ};
use crate::run::networks::Networks;
use bench::Bench;
use bench::description::TransmissionBench;
use bench::integrate::ContactAngles;
use bench::log::Expression;
use bench::plants::transmission::{
    BearingForces, ContactView, JointContact, JointMemory, JointMotion, Snapshot,
};
use bench::schema::unit_of_name;
use bench::signals::Motion;
use bench::simulate::Run;
use bench::simulate::peaks::Extremes;
use bench::simulate::stepped::HeldContact;
use clap::Args;
use inference::Flags;
use pintle_fmu::{Import, ImportError, ImportedVariable, Slave};
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
const QUANTITIES: [&str; 10] = [
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
const WITH_RATE: usize = 4;
/// Forces that a unit may take.
const FORCES: [&str; 3] = ["force_y_n", "force_z_n", "torque_nm"];

/// A unit with the meaning of its variables.
pub(crate) struct PlantUnit {
    file: PathBuf,
    import: Import,
    /// Variables that are read, in the order of the expressions' columns.
    read: Vec<ImportedVariable>,
    quantities: [Option<Expression>; QUANTITIES.len()],
    forces: [Option<ImportedVariable>; FORCES.len()],
    start: Vec<(ImportedVariable, f64)>,
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

    /// Runs the unit over the described duration in steps of `step_s`, with the contact of a
    /// resolved description.
    pub(crate) fn run(
        &self,
        bench: &TransmissionBench,
        source: ForceSource,
        step_s: f64,
        mut tick: impl FnMut(),
    ) -> Result<ForcedRun, CliError> {
        let contact = self.check(bench, step_s)?;
        let mut force = Force::new(source, bench)?;
        let started = std::time::Instant::now();
        let start: Vec<(&ImportedVariable, f64)> = self.start.iter().map(|(v, value)| (v, *value)).collect();
        let mut slave = Slave::start(&self.import, &start, 0.0)?;
        let (samples_s, end_s) = (bench.sample_times_s(SAMPLE_RATE_HZ), bench.duration_s());
        let count = (end_s / step_s).round() as usize;
        let every = (count / 100).max(1);
        let (mut memory, mut held) = (JointMemory::default(), HeldContact::default());
        let (mut samples, mut impacts, mut extremes) = (Vec::new(), Vec::new(), Extremes::default());
        let mut before = None;
        for step in 0..count {
            if step % every == 0 {
                tick();
            }
            let time_s = step as f64 * step_s;
            let values = self.read(&mut slave, before, step_s)?;
            before = Some(values);
            let motion = motion(&values).after(0.5 * step_s);
            let mut view = contact.view(&motion, &memory);
            let angles = || ContactAngles { crank_rad: values[2], contact_rad: values[1].atan2(values[0]) };
            impacts.extend(held.switch(time_s, &mut view, angles));
            memory.latched_m_s = (view.deformation_m > 0.0).then_some(held.latched_m_s());
            let forces = force.at(&contact, &view, &memory)?;
            held.measure((time_s, step_s), &view, forces.normal_n);
            let (force_n, torque_nm) = contact.on_journal(&motion, &forces);
            for (variable, value) in self.forces.iter().zip([force_n[0], force_n[1], torque_nm]) {
                if let Some(variable) = variable {
                    slave.set(variable, value)?;
                }
            }
            let snapshot = snapshot(time_s, &values, (view, forces), (force_n, torque_nm));
            extremes.update(&snapshot);
            while samples_s.get(samples.len()).is_some_and(|&t| t < time_s + 0.5 * step_s) {
                samples.push(snapshot);
            }
            slave.step(step_s)?;
            contact.advance(&mut memory, &view, step_s);
        }
        impacts.extend(held.impact);
        let peaks = extremes.to_peaks([None, None]);
        let losses_j = vec![[0.0; 3]; samples.len()];
        let run = Run {
            samples,
            impacts,
            energy_residual_rel: 0.0,
            energy: Default::default(),
            losses_j,
            steps: count,
            extremes: Some(extremes),
        };
        Ok(ForcedRun {
            wall_s: started.elapsed().as_secs_f64(),
            peaks,
            outside_training_share: force.outside_share(),
            without_contact_n: force.without_contact_n,
            plant: Some(self.figures()),
            ..ForcedRun::from_run(run)
        })
    }

    /// Contact of a description that a unit can move, with a step that the unit can take.
    fn check(&self, bench: &TransmissionBench, step_s: f64) -> Result<JointContact, CliError> {
        let refuse = |field: &str, found: &str, expected: &str| {
            Err(CliError::Input(format!("{field}: found {found}; expected {expected} with --plant-fmu")))
        };
        if bench.two_plane.is_some() {
            return refuse("two_plane", "a section", "a planar bench");
        }
        if bench.servo.is_some() {
            return refuse("servo", "a section", "none: the unit moves the drive");
        }
        if let Some(own_s) = self.import.internal_step_s().filter(|own_s| *own_s > 0.0) {
            let count = (step_s / own_s).round();
            if count < 1.0 || (count * own_s - step_s).abs() > 1e-9 * step_s {
                let expected = format!("a multiple of {}, the unit's internal step,", own_s * 1e6);
                return refuse("--step-us", &format!("{}", step_s * 1e6), &expected);
            }
        }
        match JointContact::new(bench) {
            Some(contact) => Ok(contact),
            None => refuse("friction.law", "one that sticks", "one without sticking"),
        }
    }

    /// Quantities at the present time. Missing rates are those since the step before.
    fn read(
        &self,
        slave: &mut Slave,
        before: Option<[f64; QUANTITIES.len()]>,
        step_s: f64,
    ) -> Result<[f64; QUANTITIES.len()], CliError> {
        let (mut values, mut stack) = ([0.0; QUANTITIES.len()], Vec::new());
        for (value, expression) in values.iter_mut().zip(&self.quantities) {
            let Some(expression) = expression else { continue };
            let mut readings = Vec::with_capacity(expression.columns.len());
            for column in &expression.columns {
                readings.push(match self.read.get(*column) {
                    Some(variable) => slave.get(variable)?,
                    None => f64::NAN,
                });
            }
            *value = expression.value(&readings, &mut stack);
        }
        for (i, before) in before.iter().flatten().take(WITH_RATE).enumerate() {
            if self.quantities[WITH_RATE + i].is_none() {
                values[WITH_RATE + i] = (values[i] - before) / step_s;
            }
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(i) => Err(CliError::Work(format!("the unit's {} is not finite", QUANTITIES[i]))),
            None => Ok(values),
        }
    }

    fn figures(&self) -> PlantFigures {
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

fn motion(values: &[f64; QUANTITIES.len()]) -> JointMotion {
    JointMotion {
        offset_m: [values[0], values[1]],
        velocity_m_s: [values[4], values[5]],
        speed_rad_s: values[6],
    }
}

fn snapshot(
    time_s: f64,
    values: &[f64; QUANTITIES.len()],
    (contact, forces): (ContactView, BearingForces),
    ([force_y_n, force_z_n], friction_torque_nm): ([f64; 2], f64),
) -> Snapshot {
    let [y_m, z_m, angle_rad, displacement_m, _, _, speed_rad_s, velocity_m_s, load_force_n, drive_force_n] =
        *values;
    Snapshot {
        time_s,
        angle_rad,
        speed_rad_s,
        y_m,
        z_m,
        contact,
        forces,
        force_y_n,
        force_z_n,
        friction_torque_nm,
        drive_force_n,
        load_force_n,
        drive: Motion { value: displacement_m, rate: velocity_m_s, acceleration: 0.0 },
    }
}

/// Source of the force with what a run counts about it.
struct Force {
    /// Networks; none with the laws.
    networks: Option<Networks>,
    contacts: usize,
    outside: usize,
    without_contact_n: f64,
}

impl Force {
    fn new(source: ForceSource, bench: &TransmissionBench) -> Result<Self, CliError> {
        let has_networks = matches!(source, ForceSource::FloatNet | ForceSource::QuantisedNet);
        let networks = has_networks.then(|| Networks::new(source, bench.bearing.material)).transpose()?;
        Ok(Self { networks, contacts: 0, outside: 0, without_contact_n: 0.0 })
    }

    fn at(
        &mut self,
        contact: &JointContact,
        view: &ContactView,
        memory: &JointMemory,
    ) -> Result<BearingForces, CliError> {
        let Some(networks) = &mut self.networks else {
            contact.check_deformation(view)?;
            return Ok(contact.law(view, memory));
        };
        let ([normal_n, friction_n], flags) = networks.push(view);
        if view.deformation_m > 0.0 {
            self.contacts += 1;
            self.outside += usize::from(flags.intersects(Flags::OUTSIDE_TRAINING));
        } else {
            self.without_contact_n = self.without_contact_n.max(normal_n.abs()).max(friction_n.abs());
        }
        Ok(BearingForces { normal_n, friction_n })
    }

    fn outside_share(&self) -> f64 {
        if self.contacts > 0 { self.outside as f64 / self.contacts as f64 } else { 0.0 }
    }
}
