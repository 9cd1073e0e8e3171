//! Model of a unit: its description, its table of variables, and its simulator.

use crate::networks::Networks;
use crate::parameters::{Leaf, collect};
use crate::simulator::bench::BenchSimulator;
use crate::simulator::contact::ContactSimulator;
use crate::simulator::mechanism::MechanismSimulator;
use crate::simulator::{self, Simulator};
use crate::variable::{Causality, Type, Variable};
use bench::description::{MechanismBench, TransmissionBench};
use bench::plants::transmission::JointContact;
use bench::simulate::DEFAULT_TOLERANCE;
use bench::simulate::stepped::{SteppedBench, SteppedMechanism};
use bench::{BearingMaterial, Bench};
use inference::{Flags, shipped};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use toml::Table;

/// File of the description in the resources of a unit.
pub(crate) const DESCRIPTION: &str = "description.toml";
/// File of the [`Settings`] in the resources of a unit.
pub(crate) const SETTINGS: &str = "settings.toml";

/// Content of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The bearing's force on a journal that another program moves.
    Contact,
    /// The whole transmission bench.
    Bench,
    /// A mechanism.
    Mechanism,
}

impl Kind {
    /// Name of the kind.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Contact => "contact",
            Self::Bench => "bench",
            Self::Mechanism => "mechanism",
        }
    }
}

/// Settings of a unit beside its description.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Settings {
    pub(crate) kind: Kind,
    /// Start value of the parameter `use_networks`.
    pub(crate) has_networks: bool,
    /// Identifier that the model description has, too.
    pub(crate) guid: String,
    /// Fingerprint of the table of variables, so that a library of another version is noticed.
    pub(crate) table: String,
}

/// A unit's model, not yet started.
#[derive(Clone, Debug)]
pub struct Model {
    kind: Kind,
    bench: Bench,
    /// Folder for the files that the description names.
    folder: PathBuf,
    table: Table,
    leaves: Vec<Leaf>,
    variables: Vec<Variable>,
    first_input: usize,
    first_output: usize,
    images: Vec<(BearingMaterial, Vec<u8>)>,
}

impl Model {
    /// Creates the model of a checked description; `folder` contains the files that it names.
    ///
    /// `images` replace the shipped networks of their materials. The error says why a description
    /// has no unit of the kind.
    pub fn new(
        kind: Kind,
        bench: Bench,
        folder: &Path,
        has_networks: bool,
        images: Vec<(BearingMaterial, Vec<u8>)>,
    ) -> Result<Self, String> {
        check_kind(kind, &bench)?;
        let text = bench.to_toml().map_err(|error| error.to_string())?;
        let table: Table = text.parse().map_err(|error: toml::de::Error| error.to_string())?;
        let sections = Bench::sections(bench.plant_name()).unwrap_or_default();
        let (leaves, mut variables): (Vec<Leaf>, Vec<Variable>) =
            collect(kind, &table, &sections).into_iter().unzip();
        let time = Variable::real(Causality::Time, "time", "s", "Simulated time");
        variables.insert(0, time);
        variables.extend(own_parameters(&bench, kind, has_networks));
        let first_input = variables.len();
        let (inputs, outputs) = match (kind, &bench) {
            (Kind::Mechanism, Bench::Mechanism(plant)) => {
                (simulator::mechanism::inputs(plant), simulator::mechanism::outputs(plant))
            }
            (Kind::Contact, _) => (simulator::contact::inputs(), simulator::contact::outputs()),
            _ => (simulator::bench::inputs(), simulator::bench::outputs()),
        };
        variables.extend(inputs);
        let first_output = variables.len();
        variables.extend(outputs);
        let folder = folder.to_owned();
        let model = Self { kind, bench, folder, table, leaves, variables, first_input, first_output, images };
        let mut names = BTreeSet::new();
        if let Some(twice) = model.variables.iter().find(|variable| !names.insert(&variable.name)) {
            return Err(format!("{}: found two variables of this name; expected one", twice.name));
        }
        model.simulator(&model.start_values())?;
        Ok(model)
    }

    /// Reads the model from the resources of a unit, with its identifier.
    pub(crate) fn read(resources: &Path) -> Result<(Self, String), String> {
        let read = |name: &str| {
            let path = resources.join(name);
            std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
        };
        let settings: Settings =
            toml::from_str(&read(SETTINGS)?).map_err(|error| format!("{SETTINGS}: {error}"))?;
        let path = resources.join(DESCRIPTION);
        let bench =
            Bench::parse(&path.to_string_lossy(), &read(DESCRIPTION)?).map_err(|error| error.to_string())?;
        let image = |material: &BearingMaterial| {
            let bytes = std::fs::read(resources.join(image_file(*material))).ok()?;
            Some((*material, bytes))
        };
        let images = BearingMaterial::ALL.iter().filter_map(image).collect();
        let model = Self::new(settings.kind, bench, resources, settings.has_networks, images)?;
        if model.fingerprint() != settings.table {
            return Err(
                "library: found another table of variables; expected that of the unit: the library is of \
                        another version"
                    .into(),
            );
        }
        Ok((model, settings.guid))
    }

    /// Content.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Description.
    pub fn bench(&self) -> &Bench {
        &self.bench
    }

    /// All variables; the value reference is the index.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Fingerprint of the table of variables.
    pub(crate) fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        for variable in &self.variables {
            hash.update(format!("{variable:?}\n"));
        }
        hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect()
    }

    /// Image of a material's networks.
    pub(crate) fn image(&self, material: BearingMaterial) -> &[u8] {
        let own = self.images.iter().find(|(known, _)| *known == material);
        own.map_or_else(|| shipped(material), |(_, bytes)| bytes)
    }

    /// Materials whose networks the unit may use.
    pub fn materials(&self) -> Vec<BearingMaterial> {
        match &self.bench {
            Bench::Transmission(bench) => vec![bench.bearing.material],
            Bench::Mechanism(plant) => {
                let found: BTreeSet<_> = plant.networks().into_iter().flatten().collect();
                found.into_iter().collect()
            }
            _ => Vec::new(),
        }
    }

    /// Length of the described run in s.
    pub(crate) fn duration_s(&self) -> f64 {
        self.bench.duration_s()
    }

    /// Values of all variables before anything is set.
    pub(crate) fn start_values(&self) -> Vec<f64> {
        self.variables.iter().map(|variable| variable.start).collect()
    }

    /// Values of the inputs among those of all variables.
    pub(crate) fn inputs<'a>(&self, values: &'a [f64]) -> &'a [f64] {
        values.get(self.first_input..self.first_output).unwrap_or_default()
    }

    /// Values of the outputs among those of all variables, for changes.
    pub(crate) fn outputs_mut<'a>(&self, values: &'a mut [f64]) -> &'a mut [f64] {
        values.get_mut(self.first_output..).unwrap_or_default()
    }

    /// Builds the simulator with the parameters among the values of all variables.
    pub(crate) fn simulator(&self, values: &[f64]) -> Result<Simulator, String> {
        let own = |name: &str| {
            let index = self.variables.iter().position(|variable| variable.name == name);
            index.and_then(|index| values.get(index)).copied().unwrap_or_default()
        };
        let has_networks = own(USE_NETWORKS) != 0.0;
        let network_step_s = own(NETWORK_STEP);
        let networks = |material| Networks::new(self.image(material));
        if has_networks && self.materials().is_empty() {
            return Err("use_networks: found true; expected false: no contact has a `network`".into());
        }
        if own(EXTERNAL_DRIVE) != 0.0 && self.bench.effects().iter().any(|effect| effect.name == LAG) {
            return Err(format!("external_drive: found true with the effect `{LAG}`; expected one of them"));
        }
        match (self.kind, self.with_parameters(values)?.resolved()) {
            (Kind::Contact, Bench::Transmission(bench)) => {
                let networks = has_networks.then(|| networks(bench.bearing.material)).transpose()?;
                let contact = JointContact::new(&bench).ok_or(STICKS)?;
                Ok(Simulator::Contact(ContactSimulator { contact, networks }))
            }
            (Kind::Bench, Bench::Transmission(bench)) if has_networks && bench.servo.is_some() => Err(
                "servo: found a section with use_networks; expected the laws: a held force is no part of \
                     its loop"
                    .into(),
            ),
            (Kind::Bench, Bench::Transmission(bench)) => Ok(Simulator::Bench(Box::new(BenchSimulator {
                networks: has_networks.then(|| networks(bench.bearing.material)).transpose()?,
                bench: SteppedBench::new(&bench, own(TOLERANCE)),
                network_step_s,
                largest_drive_m: bench.servo.is_none().then_some(bench.geometry.drive_lever_radius_m),
                has_external_drive: own(EXTERNAL_DRIVE) != 0.0,
                has_external_load: own(EXTERNAL_LOAD) != 0.0,
                flags: Flags::NONE,
            }))),
            (Kind::Mechanism, Bench::Mechanism(plant)) => {
                let of_contact = |material: Option<BearingMaterial>| {
                    material.filter(|_| has_networks).map(networks).transpose()
                };
                let pairs = plant.networks().into_iter().map(of_contact).collect::<Result<_, _>>()?;
                let mut plant: MechanismBench = *plant;
                plant.run.tolerance = own(TOLERANCE);
                let mechanism =
                    SteppedMechanism::new(&plant, has_networks).map_err(|error| error.to_string())?;
                Ok(Simulator::Mechanism(Box::new(MechanismSimulator {
                    mechanism,
                    networks: pairs,
                    network_step_s,
                    flags: Flags::NONE,
                })))
            }
            (_, bench) => {
                Err(format!("found plant `{}` in a unit `{}`", bench.plant_name(), self.kind.name()))
            }
        }
    }

    /// Description with the numbers among the values of all variables.
    fn with_parameters(&self, values: &[f64]) -> Result<Bench, String> {
        let changed = self.variables.iter().zip(values).skip(1).zip(&self.leaves);
        let mut changed = changed.filter(|((variable, value), _)| variable.start != **value).peekable();
        if changed.peek().is_none() {
            return Ok(self.bench.clone());
        }
        let mut table = self.table.clone();
        changed.for_each(|((_, value), leaf)| leaf.put(&mut table, *value));
        // The name of the file gives the folder of files that the description names.
        let file = self.folder.join(DESCRIPTION);
        Bench::parse(&file.to_string_lossy(), &table.to_string()).map_err(|error| error.to_string())
    }
}

/// Name of an image's file in the resources of a unit.
pub(crate) fn image_file(material: BearingMaterial) -> String {
    format!("{}.pintle", material.name())
}

/// Names of the parameters that are no numbers of the description.
pub(crate) const USE_NETWORKS: &str = "use_networks";
const NETWORK_STEP: &str = "network_step_s";
pub(crate) const TOLERANCE: &str = "tolerance";
pub(crate) const EXTERNAL_DRIVE: &str = "external_drive";
pub(crate) const EXTERNAL_LOAD: &str = "external_load";

/// Parameters that are no numbers of the description.
fn own_parameters(bench: &Bench, kind: Kind, has_networks: bool) -> Vec<Variable> {
    let fixed = |name, unit, meaning| Variable::real(Causality::Fixed, name, unit, meaning);
    let networks = fixed(USE_NETWORKS, "", "True: the trained networks give the forces of their contacts");
    let mut all = vec![networks.with(Type::Boolean, f64::from(u8::from(has_networks)))];
    if kind == Kind::Contact {
        return all;
    }
    let step = Variable {
        range: Some((1e-7, 1e-3)),
        ..fixed(NETWORK_STEP, "s", "Longest communication step of networks within a step of the unit")
    };
    let tolerance = Variable {
        range: Some((1e-13, 1e-2)),
        ..fixed(TOLERANCE, "", "Relative tolerance of the integrator")
    };
    let described = match bench {
        Bench::Mechanism(plant) => plant.run.tolerance,
        _ => DEFAULT_TOLERANCE,
    };
    all.push(step.with(Type::Real, NETWORK_STEP_S));
    all.push(tolerance.with(Type::Real, described));
    if kind == Kind::Bench {
        all.extend(simulator::bench::parameters());
    }
    all
}

/// Effect that delays the drive by reading its motion before the present step.
const LAG: &str = "drive-lag";

/// Default communication step of the networks in s, as in `host-sim run`.
const NETWORK_STEP_S: f64 = 1e-5;

const STICKS: &str = "friction.law: found one that sticks; expected one without sticking: the force at \
                      standstill follows from all forces on the journal, which a contact does not know";

/// Refuses a description that has no unit of a kind.
fn check_kind(kind: Kind, bench: &Bench) -> Result<(), String> {
    let refuse = |field: &str, found: &str, expected: &str| {
        Err(format!("{field}: found {found}; expected {expected}"))
    };
    let plant = bench.plant_name();
    match (kind, bench) {
        (Kind::Mechanism, Bench::Mechanism(_)) => Ok(()),
        (Kind::Mechanism, _) => refuse("plant", &format!("`{plant}`"), "`mechanism`"),
        (_, Bench::Transmission(bench)) => check_transmission(kind, bench),
        _ => refuse("plant", &format!("`{plant}`"), &format!("`{}`", TransmissionBench::PLANT)),
    }
}

fn check_transmission(kind: Kind, bench: &TransmissionBench) -> Result<(), String> {
    if bench.two_plane.is_some() {
        return Err("two_plane: found a section; expected a planar bench".into());
    }
    if kind == Kind::Contact && !bench.common.effects.is_empty() {
        return Err(
            "effects: found some; expected none: they act on the bench, not on the contact alone".into()
        );
    }
    if kind == Kind::Contact && bench.friction.law.is_some_and(|law| law.0.sticks()) {
        return Err(STICKS.into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_with_another_table_of_variables_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let bench = Bench::open("bench-b").unwrap();
        let model = Model::new(Kind::Bench, bench, folder.path(), false, Vec::new()).unwrap();
        std::fs::write(folder.path().join(DESCRIPTION), model.bench.to_toml().unwrap()).unwrap();
        let write = |table: String| {
            let settings = Settings { kind: Kind::Bench, has_networks: false, guid: "{a}".into(), table };
            std::fs::write(folder.path().join(SETTINGS), toml::to_string(&settings).unwrap()).unwrap();
        };
        write(model.fingerprint());
        assert_eq!(Model::read(folder.path()).unwrap().1, "{a}");
        write("0".into());
        assert!(Model::read(folder.path()).unwrap_err().contains("another version"));
    }
}
