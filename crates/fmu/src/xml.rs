//! Model description of a unit: `modelDescription.xml` of FMI 2.0 and 3.0.

use crate::model::{Kind, Model};
use crate::units::base_attributes;
use crate::variable::{Causality, Type, Variable};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Name of the library's file without its ending.
pub(crate) const MODEL_IDENTIFIER: &str = "pintle_fmu";

/// Version of the Functional Mock-up Interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

impl Version {
    /// Version as text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Two => "2.0",
            Self::Three => "3.0",
        }
    }
}

/// Model description with an identifier. `tool` names the program that writes it.
pub(crate) fn description(model: &Model, version: Version, guid: &str, tool: &str) -> String {
    let (fmi, identifier, state) = match version {
        Version::Two => ("2.0", "guid", "FMUstate"),
        Version::Three => ("3.0", "instantiationToken", "FMUState"),
    };
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing to a string does not fail.
    let _ = write!(
        xml,
        "<fmiModelDescription fmiVersion=\"{fmi}\" modelName=\"pintle {kind}\" {identifier}=\"{guid}\"\n  \
         description=\"{meaning}\" generationTool=\"{tool}\"\n  variableNamingConvention=\"flat\">\n  \
         <CoSimulation modelIdentifier=\"{MODEL_IDENTIFIER}\"\n    \
         canHandleVariableCommunicationStepSize=\"true\"\n    \
         canGetAndSet{state}=\"true\" canSerialize{state}=\"true\"/>\n",
        kind = model.kind().name(),
        meaning = meaning(model.kind()),
        tool = escaped(tool),
    );
    units(&mut xml, model.variables());
    let _ = write!(
        xml,
        "  <LogCategories>\n    <Category name=\"logStatusError\" description=\"Errors\"/>\n  \
         </LogCategories>\n  <DefaultExperiment startTime=\"0\" stopTime=\"{}\" stepSize=\"{}\"/>\n  \
         <ModelVariables>\n",
        model.duration_s(),
        DEFAULT_STEP_S,
    );
    for (reference, variable) in model.variables().iter().enumerate() {
        match version {
            Version::Two => scalar_variable(&mut xml, reference, variable),
            Version::Three => typed_variable(&mut xml, reference, variable),
        }
    }
    xml.push_str("  </ModelVariables>\n");
    structure(&mut xml, model, version);
    xml.push_str("</fmiModelDescription>\n");
    xml
}

/// Communication step in s that a model description proposes.
const DEFAULT_STEP_S: f64 = 1e-4;

fn meaning(kind: Kind) -> &'static str {
    match kind {
        Kind::Contact => "Force of a clearance bearing on its journal",
        Kind::Bench => "Test bench of a rudder drive with its clearance bearing",
        Kind::Mechanism => "Planar mechanism with clearance joints",
    }
}

fn units(xml: &mut String, variables: &[Variable]) {
    let units: BTreeSet<&str> = variables.iter().map(|v| v.unit).filter(|unit| !unit.is_empty()).collect();
    if units.is_empty() {
        return;
    }
    xml.push_str("  <UnitDefinitions>\n");
    for unit in units {
        let _ = match base_attributes(unit) {
            Some(base) => writeln!(xml, "    <Unit name=\"{unit}\"><BaseUnit{base}/></Unit>"),
            None => writeln!(xml, "    <Unit name=\"{unit}\"/>"),
        };
    }
    xml.push_str("  </UnitDefinitions>\n");
}

/// Attributes that both versions share: name, reference, causality, variability, meaning.
fn common(reference: usize, variable: &Variable) -> String {
    let continuous = if variable.kind == Type::Real { "continuous" } else { "discrete" };
    let (causality, variability, initial) = match variable.causality {
        Causality::Time => ("independent", "continuous", ""),
        Causality::Fixed => ("parameter", "fixed", " initial=\"exact\""),
        Causality::Tunable => ("parameter", "tunable", " initial=\"exact\""),
        Causality::Input => ("input", continuous, ""),
        Causality::Output => ("output", continuous, " initial=\"calculated\""),
    };
    format!(
        "name=\"{}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\"\
         {initial} description=\"{}\"",
        escaped(&variable.name),
        escaped(&variable.meaning),
    )
}

/// Unit, range and start value of a variable.
fn values(variable: &Variable) -> String {
    let mut text = String::new();
    if !variable.unit.is_empty() {
        let _ = write!(text, " unit=\"{}\"", variable.unit);
    }
    if let Some((low, high)) = variable.range {
        let _ = write!(text, " min=\"{low}\" max=\"{high}\"");
    }
    if !matches!(variable.causality, Causality::Time | Causality::Output) {
        let _ = match variable.kind {
            Type::Boolean => write!(text, " start=\"{}\"", variable.start != 0.0),
            _ => write!(text, " start=\"{}\"", variable.start),
        };
    }
    text
}

fn scalar_variable(xml: &mut String, reference: usize, variable: &Variable) {
    let kind = match variable.kind {
        Type::Real => "Real",
        Type::Integer => "Integer",
        Type::Boolean => "Boolean",
    };
    let _ = writeln!(
        xml,
        "    <ScalarVariable {}>\n      <{kind}{}/>\n    </ScalarVariable>",
        common(reference, variable),
        values(variable)
    );
}

fn typed_variable(xml: &mut String, reference: usize, variable: &Variable) {
    let kind = match variable.kind {
        Type::Real => "Float64",
        Type::Integer => "Int32",
        Type::Boolean => "Boolean",
    };
    let _ = writeln!(xml, "    <{kind} {}{}/>", common(reference, variable), values(variable));
}

/// Lists the outputs. Those of a contact follow from its inputs at once, the others do not.
fn structure(xml: &mut String, model: &Model, version: Version) {
    let outputs = model.variables().iter().enumerate().filter(|(_, v)| v.causality == Causality::Output);
    let outputs: Vec<usize> = outputs.map(|(reference, _)| reference).collect();
    let dependencies = if model.kind() == Kind::Contact { "" } else { " dependencies=\"\"" };
    xml.push_str("  <ModelStructure>\n");
    structure_lists(xml, &outputs, dependencies, version);
    xml.push_str("  </ModelStructure>\n");
}

fn structure_lists(xml: &mut String, outputs: &[usize], dependencies: &str, version: Version) {
    for (list, element, names) in
        [("Outputs", "Output", dependencies), ("InitialUnknowns", "InitialUnknown", "")]
    {
        match version {
            Version::Two => {
                let _ = writeln!(xml, "    <{list}>");
                for reference in outputs {
                    let _ = writeln!(xml, "      <Unknown index=\"{}\"{names}/>", reference + 1);
                }
                let _ = writeln!(xml, "    </{list}>");
            }
            Version::Three => {
                for reference in outputs {
                    let _ = writeln!(xml, "    <{element} valueReference=\"{reference}\"{names}/>");
                }
            }
        }
    }
}

/// Text as the value of an attribute.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c if c.is_control() => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}
