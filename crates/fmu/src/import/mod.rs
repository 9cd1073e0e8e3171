//! Units of other programs: reading the model description, loading the library, taking steps.

mod library;
mod slave;

pub use slave::Slave;

use crate::package::Platform;
use crate::variable::Type;
use crate::xml::Version;
use roxmltree::{Document, Node};
use std::fs::File;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Limit of the unpacked size of a unit in bytes.
const MAX_UNPACKED: u64 = 1 << 30;
/// Limit of the size of a model description in bytes.
const MAX_DESCRIPTION: u64 = 64 << 20;

/// Error of a unit of another program.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file cannot be used: the reason.
    #[error("{file}: {reason}")]
    Unusable {
        /// Path of the unit.
        file: String,
        /// Reason: found and expected content.
        reason: String,
    },
    /// A call failed: the function, its status, and the messages of the unit.
    #[error("the unit's {function} returned status {status}{messages}")]
    Failed {
        /// Name of the function.
        function: &'static str,
        /// Status of the standard: 2 discard, 3 error, 4 fatal.
        status: i32,
        /// Messages that the unit logged, each after a colon or semicolon.
        messages: String,
    },
}

/// Variable of a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedVariable {
    /// Name.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// Type; none for one that is not supported.
    pub kind: Option<Type>,
    /// Causality as written: `input`, `output`, `parameter`, `local` and others.
    pub causality: String,
    /// Unit as written, also through a declared type; empty if there is none.
    pub unit: String,
}

impl ImportedVariable {
    /// Returns whether a number is one of the variable's type.
    pub fn admits(&self, value: f64) -> bool {
        self.kind.is_some_and(|kind| kind.admits(value))
    }
}

/// An unpacked unit for co-simulation.
#[derive(Debug)]
pub struct Import {
    folder: TempDir,
    file: String,
    description: Description,
}

/// Content of a model description.
#[derive(Clone, Debug)]
struct Description {
    version: Version,
    identifier: String,
    guid: String,
    name: String,
    variables: Vec<ImportedVariable>,
    internal_step_s: Option<f64>,
}

impl Import {
    /// Unpacks a unit into a temporary folder and reads its model description. Its library is not
    /// loaded yet.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let file = path.display().to_string();
        let unusable = |reason: String| ImportError::Unusable { file: file.clone(), reason };
        let folder = tempfile::tempdir().map_err(|error| unusable(error.to_string()))?;
        unpack(path, folder.path()).map_err(&unusable)?;
        let text = read_description(folder.path()).map_err(&unusable)?;
        let document =
            Document::parse(&text).map_err(|error| unusable(format!("modelDescription.xml: {error}")))?;
        let description = describe(&document).map_err(&unusable)?;
        Ok(Self { folder, file: file.clone(), description })
    }

    /// Name of the model.
    pub fn name(&self) -> &str {
        &self.description.name
    }

    /// Variables in the order of the model description.
    pub fn variables(&self) -> &[ImportedVariable] {
        &self.description.variables
    }

    /// Step of the unit's own solver in s, if it states one; FMI 2.0 cannot.
    pub fn internal_step_s(&self) -> Option<f64> {
        self.description.internal_step_s
    }

    /// Variable by its name.
    pub fn variable(&self, name: &str) -> Option<&ImportedVariable> {
        self.variables().iter().find(|variable| variable.name == name)
    }

    /// Version of the interface as text.
    pub const fn version(&self) -> &'static str {
        self.description.version.name()
    }

    fn unusable(&self, reason: impl Into<String>) -> ImportError {
        ImportError::Unusable { file: self.file.clone(), reason: reason.into() }
    }

    /// Path of the library for this machine.
    fn library(&self) -> Result<PathBuf, ImportError> {
        let platform = if cfg!(windows) { Platform::Windows } else { Platform::Linux };
        let folder = format!("binaries/{}", platform.folder(self.description.version));
        let ending = if cfg!(windows) { "dll" } else { "so" };
        let path = self.folder.path().join(&folder).join(format!("{}.{ending}", self.description.identifier));
        if path.is_file() {
            return Ok(path);
        }
        let known = std::fs::read_dir(self.folder.path().join("binaries"));
        let known = known.into_iter().flatten().flatten().map(|entry| entry.file_name());
        let mut known: Vec<String> = known.map(|name| name.to_string_lossy().into_owned()).collect();
        known.sort();
        Err(self.unusable(format!("binaries: found for [{}]; expected {folder}", known.join(", "))))
    }
}

fn unpack(path: &Path, folder: &Path) -> Result<(), String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    let not_zip = |error: zip::result::ZipError| format!("found no ZIP archive: {error}; expected an FMU");
    let mut archive = zip::ZipArchive::new(file).map_err(not_zip)?;
    let mut size = 0_u64;
    for index in 0..archive.len() {
        size = size.saturating_add(archive.by_index(index).map_err(not_zip)?.size());
    }
    if size > MAX_UNPACKED {
        return Err(format!("found {size} unpacked bytes; expected at most {MAX_UNPACKED}"));
    }
    archive.extract(folder).map_err(|error| format!("unpacking: {error}"))
}

fn read_description(folder: &Path) -> Result<String, String> {
    let path = folder.join("modelDescription.xml");
    let missing = |error: std::io::Error| format!("modelDescription.xml: {error}");
    let size = std::fs::metadata(&path).map_err(missing)?.len();
    if size > MAX_DESCRIPTION {
        return Err(format!("modelDescription.xml: found {size} bytes; expected at most {MAX_DESCRIPTION}"));
    }
    std::fs::read_to_string(&path).map_err(missing)
}

fn describe(document: &Document<'_>) -> Result<Description, String> {
    let root = document.root_element();
    let wrong = |field: &str, found: &str, expected: &str| {
        format!("modelDescription.xml: {field}: found {found}; expected {expected}")
    };
    let version = root.attribute("fmiVersion").unwrap_or("nothing");
    let (version, guid) = match version {
        "2.0" => (Version::Two, root.attribute("guid")),
        text if text.starts_with("3.") => (Version::Three, root.attribute("instantiationToken")),
        other => return Err(wrong("fmiVersion", other, "2.0 or 3.x")),
    };
    let slave = child(root, "CoSimulation");
    let slave = slave.ok_or_else(|| wrong("CoSimulation", "nothing", "a unit for co-simulation"))?;
    let identifier = slave.attribute("modelIdentifier").unwrap_or_default();
    let is_name = !identifier.is_empty() && identifier.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name {
        return Err(wrong("modelIdentifier", &format!("`{identifier}`"), "letters, digits and `_`"));
    }
    let variables = child(root, "ModelVariables");
    let variables = variables.ok_or_else(|| wrong("ModelVariables", "nothing", "variables"))?;
    let types = child(root, "TypeDefinitions");
    Ok(Description {
        version,
        identifier: identifier.into(),
        guid: guid.unwrap_or_default().into(),
        name: root.attribute("modelName").unwrap_or_default().into(),
        variables: variables
            .children()
            .filter(Node::is_element)
            .map(|node| variable(node, version, types))
            .collect::<Result<_, _>>()?,
        internal_step_s: slave.attribute("fixedInternalStepSize").and_then(|text| text.parse().ok()),
    })
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn variable(
    node: Node<'_, '_>,
    version: Version,
    types: Option<Node<'_, '_>>,
) -> Result<ImportedVariable, String> {
    let name = node.attribute("name").unwrap_or_default().to_owned();
    let typed = match version {
        Version::Two => node.children().find(Node::is_element).unwrap_or(node),
        Version::Three => node,
    };
    let kind = match typed.tag_name().name() {
        "Real" | "Float64" => Some(Type::Real),
        "Integer" | "Int32" => Some(Type::Integer),
        "Boolean" => Some(Type::Boolean),
        _ => None,
    };
    // An array of FMI 3.0 has more than one value for its reference.
    let kind = kind.filter(|_| child(node, "Dimension").is_none());
    let reference = node.attribute("valueReference").and_then(|text| text.parse().ok());
    let declared = typed.attribute("declaredType").and_then(|name| {
        let mut all = types.into_iter().flat_map(|types| types.children());
        all.find(|node| node.attribute("name") == Some(name))
    });
    let of_type = declared.and_then(|node| {
        let inner = node.children().find(Node::is_element);
        node.attribute("unit").or_else(|| inner?.attribute("unit"))
    });
    Ok(ImportedVariable {
        reference: reference.ok_or_else(|| {
            format!("modelDescription.xml: variable `{name}`: found no valueReference; expected a number")
        })?,
        kind,
        causality: node.attribute("causality").unwrap_or("local").into(),
        unit: typed.attribute("unit").or(of_type).unwrap_or_default().into(),
        name,
    })
}
