//! Incremental writer of tables with f32 columns: CSV with one header line, or Parquet.
//!
//! CSV has the shortest decimals that parse to the same f32. Parquet has one required FLOAT column
//! for each name, one row group for each batch, a dictionary where values repeat (the axes of a
//! grid), and no compression. A file is written under a temporary name in its directory.
//! [`publish`] renames all files of a set together, so a failed set leaves no files.

use crate::data::file_io::{WriteError, temporary};
use parquet::data_type::FloatType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::NamedTempFile;

/// File format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// Comma-separated text.
    Csv,
    /// Apache Parquet.
    Parquet,
}

impl Format {
    /// File name extension.
    pub(crate) fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }
}

/// Formatted rows; CSV text is generated on all threads.
#[derive(Clone, Debug)]
pub enum FormattedRows {
    /// Lines of CSV.
    Text(Vec<u8>),
    /// Columns of equal length.
    Columns(Vec<Vec<f32>>),
}

impl FormattedRows {
    /// Formats columns.
    pub fn new(columns: Vec<Vec<f32>>, format: Format) -> Self {
        if format == Format::Parquet {
            return Self::Columns(columns);
        }
        let rows = columns.first().map_or(0, Vec::len);
        let mut text = Vec::with_capacity(12 * rows * columns.len());
        for row in 0..rows {
            for (index, column) in columns.iter().enumerate() {
                if index > 0 {
                    text.push(b',');
                }
                // Writing to memory does not fail.
                let _ = write!(text, "{}", column.get(row).copied().unwrap_or(f32::NAN));
            }
            text.push(b'\n');
        }
        Self::Text(text)
    }
}

/// An open file.
pub(crate) struct Sink {
    path: PathBuf,
    form: Form,
}

enum Form {
    Csv(BufWriter<NamedTempFile>),
    Parquet(Box<SerializedFileWriter<NamedTempFile>>),
}

/// A complete file that still has its temporary name.
#[derive(Debug)]
pub(crate) struct Complete {
    path: PathBuf,
    file: NamedTempFile,
}

fn parquet_error(error: ParquetError) -> io::Error {
    io::Error::other(error)
}

impl Sink {
    /// Opens a file and creates its directory if it is missing. `repeating` selects the columns
    /// with a dictionary.
    pub(crate) fn create(
        path: &Path,
        format: Format,
        names: &[String],
        repeating: impl Fn(usize) -> bool,
    ) -> Result<Self, WriteError> {
        let open = || -> io::Result<Form> {
            let file = ordinary(path)?;
            if format == Format::Csv {
                let mut file = BufWriter::with_capacity(1 << 20, file);
                writeln!(file, "{}", names.join(","))?;
                return Ok(Form::Csv(file));
            }
            let fields: String = names.iter().map(|name| format!("REQUIRED FLOAT {name};\n")).collect();
            let schema =
                parse_message_type(&format!("message rows {{\n{fields}}}")).map_err(parquet_error)?;
            let mut properties = WriterProperties::builder().set_dictionary_enabled(false);
            for (_, name) in names.iter().enumerate().filter(|(index, _)| repeating(*index)) {
                properties = properties.set_column_dictionary_enabled(name.as_str().into(), true);
            }
            let writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties.build()));
            Ok(Form::Parquet(Box::new(writer.map_err(parquet_error)?)))
        };
        let path = path.to_path_buf();
        match open() {
            Ok(form) => Ok(Self { path, form }),
            Err(source) => Err(WriteError { path, source }),
        }
    }

    /// Writes the parts of a batch.
    pub(crate) fn write(&mut self, parts: &[FormattedRows]) -> Result<(), WriteError> {
        let written = match &mut self.form {
            Form::Csv(file) => parts.iter().try_for_each(|part| match part {
                FormattedRows::Text(text) => file.write_all(text),
                FormattedRows::Columns(_) => Err(io::Error::other("columns for a file of text")),
            }),
            Form::Parquet(writer) => row_group(writer, parts).map_err(parquet_error),
        };
        written.map_err(|source| WriteError { path: self.path.clone(), source })
    }

    /// Finishes the file.
    pub(crate) fn complete(self) -> Result<Complete, WriteError> {
        let file = match self.form {
            Form::Csv(file) => file.into_inner().map_err(io::IntoInnerError::into_error),
            Form::Parquet(writer) => writer.into_inner().map_err(parquet_error),
        };
        match file {
            Ok(file) => Ok(Complete { path: self.path, file }),
            Err(source) => Err(WriteError { path: self.path, source }),
        }
    }
}

fn row_group(
    writer: &mut SerializedFileWriter<NamedTempFile>,
    parts: &[FormattedRows],
) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    let mut index = 0;
    while let Some(mut column) = group.next_column()? {
        for part in parts {
            let FormattedRows::Columns(columns) = part else {
                return Err(ParquetError::General("text for a file of columns".to_owned()));
            };
            let values = columns.get(index).map(Vec::as_slice).unwrap_or_default();
            column.typed::<FloatType>().write_batch(values, None, None)?;
        }
        column.close()?;
        index += 1;
    }
    group.close()?;
    Ok(())
}

/// Creates a temporary file with the permissions of an ordinary one (0644).
fn ordinary(path: &Path) -> io::Result<NamedTempFile> {
    let file = temporary(path)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    Ok(file)
}

/// Renames complete files to their final names.
pub(crate) fn publish(files: Vec<Complete>) -> Result<Vec<PathBuf>, WriteError> {
    (files.into_iter())
        .map(|Complete { path, file }| match file.persist(&path) {
            Ok(_) => Ok(path),
            Err(error) => Err(WriteError { path, source: error.error }),
        })
        .collect()
}
