//! The sweep to which the results of a folder belong, so that two sweeps do not mix their files.

use crate::cli::error::CliError;
use serde_json::Value;
use std::path::Path;

/// File that names its sweep.
pub(crate) const RESULT: &str = "sweep.json";

/// Refuses a folder with the results of another sweep than `sweep`.
pub(crate) fn check(folder: &Path, sweep: &str) -> Result<(), CliError> {
    let path = folder.join(RESULT);
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(()) };
    let value: Option<Value> = serde_json::from_str(&text).ok();
    match value.as_ref().and_then(|v| v.get("sweep")).and_then(Value::as_str) {
        Some(found) if found != sweep => Err(CliError::Input(format!(
            "{}: found the results of sweep `{found}`; expected those of `{sweep}`, or another folder with \
             --out",
            path.display()
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_with_results_of_another_sweep_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check(folder.path(), "load").is_ok());
        std::fs::write(folder.path().join(RESULT), r#"{"sweep": "clearance"}"#).unwrap();
        assert!(check(folder.path(), "clearance").is_ok());
        let message = check(folder.path(), "load").unwrap_err().to_string();
        assert!(message.contains("`clearance`") && message.contains("`load`"), "{message}");
    }
}
