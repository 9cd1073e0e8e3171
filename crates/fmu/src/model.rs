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
}

/// Numbers of the unit's own parameters, after those of the description.
mod own {
    pub(super) const USE_NETWORKS: usize = 0;
    pub(super) const NETWORK_STEP: usize = 1;
    pub(super) const TOLERANCE: usize = 2;
    pub(super) const EXTERNAL_DRIVE: usize = 3;
    pub(super) const EXTERNAL_LOAD: usize = 4;
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
    /// Index of the first variable that is not a number of the description.
    first_own: usize,
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
            collect(&table, &sections).into_iter().unzip();
        let time = Variable::real(Causality::Time, "time", "s", "Simulated time");
        variables.insert(0, time);
        let first_own = variables.len();
        variables.extend(own_parameters(kind, has_networks));
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
        let model = Self {
            kind,
            bench,
            folder,
            table,
            leaves,
            variables,
            first_own,
            first_input,
            first_output,
            images,
        };
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

    /// Image of a material's networks.
    pub(crate) fn image(&self, material: BearingMaterial) -> &[u8] {
        let own = self.images.iter().find(|(known, _)| *known == material);
        own.map_or_else(|| shipped(material), |(_, bytes)| bytes)
    }

    /// Materials whose networks the unit may use.
    pub(crate) fn materials(&self) -> Vec<BearingMaterial> {
        match &self.bench {
            Bench::Transmission(bench) => vec![bench.bearing.material],
            Bench::Mechanism(plant) => {
                let found: std::collections::BTreeSet<_> = plant.networks().into_iter().flatten().collect();
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
        let own = |i: usize| values.get(self.first_own + i).copied().unwrap_or_default();
        let has_networks = own(own::USE_NETWORKS) != 0.0;
        let network_step_s = own(own::NETWORK_STEP);
        let networks = |material| Networks::new(self.image(material));
        match (self.kind, self.with_parameters(values)?.resolved()) {
            (Kind::Contact, Bench::Transmission(bench)) => {
                let networks = has_networks.then(|| networks(bench.bearing.material)).transpose()?;
                let contact = JointContact::new(&bench).ok_or(STICKS)?;
                Ok(Simulator::Contact(ContactSimulator { contact, networks }))
            }
            (Kind::Bench, Bench::Transmission(bench)) => Ok(Simulator::Bench(Box::new(BenchSimulator {
                networks: has_networks.then(|| networks(bench.bearing.material)).transpose()?,
                bench: SteppedBench::new(&bench, own(own::TOLERANCE)),
                network_step_s,
                journal_radius_m: bench.bearing.bearing_radius_m - bench.bearing.radial_clearance_m,
                has_external_drive: own(own::EXTERNAL_DRIVE) != 0.0,
                has_external_load: own(own::EXTERNAL_LOAD) != 0.0,
                flags: Flags::NONE,
            }))),
            (Kind::Mechanism, Bench::Mechanism(plant)) => {
                let of_contact = |material: Option<BearingMaterial>| {
                    material.filter(|_| has_networks).map(networks).transpose()
                };
                let pairs = plant.networks().into_iter().map(of_contact).collect::<Result<_, _>>()?;
                let mut plant: MechanismBench = *plant;
                plant.run.tolerance = own(own::TOLERANCE);
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

/// Parameters of every unit: those of [`own`] in their order.
fn own_parameters(kind: Kind, has_networks: bool) -> Vec<Variable> {
    let fixed = |name, unit, meaning| Variable::real(Causality::Fixed, name, unit, meaning);
    let networks = fixed("use_networks", "", "True: the trained networks give the forces of their contacts");
    let step = Variable {
        range: Some((1e-7, 1e-3)),
        ..fixed("network_step_s", "s", "Longest communication step of networks within a step of the unit")
    };
    let tolerance = Variable {
        range: Some((1e-13, 1e-2)),
        ..fixed("tolerance", "", "Relative tolerance of the integrator")
    };
    let mut all = vec![
        networks.with(Type::Boolean, f64::from(u8::from(has_networks))),
        step.with(Type::Real, NETWORK_STEP_S),
        tolerance.with(Type::Real, DEFAULT_TOLERANCE),
    ];
    if kind == Kind::Bench {
        all.extend(simulator::bench::parameters());
    }
    all
}

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
