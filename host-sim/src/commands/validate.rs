//! `host-sim validate`: compares the models with published known answers.

use crate::cli::error::CliError;
use crate::cli::{output, progress};
use crate::validation::{Case, Cases};
use clap::Args;
use report::text_table;
use std::path::PathBuf;

/// Arguments of `host-sim validate`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim validate\n  host-sim validate --json --out out/validate")]
pub struct ValidateArgs {
    /// Folder for validate.json; without it nothing is written.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the cases as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Computes every case. Fails if one does not hold.
pub fn run(args: &ValidateArgs) -> Result<(), CliError> {
    let bar = progress::bar(3);
    bar.set_message("known answers");
    let cases = Cases::compute(|| bar.inc(1))?;
    bar.finish_and_clear();
    let failed = cases.cases.iter().filter(|c| !c.ok).count();
    let total = cases.cases.len();
    let text = output::json(&cases)?;
    if let Some(folder) = &args.out {
        output::write(folder, "validate.json", &format!("{text}\n"))?;
    }
    if args.json {
        print_result!("{text}");
    } else {
        print_line!("{}", text_table(HEADER, cases.cases.iter().map(cells), 1));
        print_line!("{} of {total} hold", total - failed);
    }
    outcome(failed, total)
}

/// Fails if a case does not hold.
fn outcome(failed: usize, total: usize) -> Result<(), CliError> {
    if failed > 0 {
        return Err(CliError::Work(format!("{failed} of {total} known answers do not hold")));
    }
    Ok(())
}

const HEADER: [&str; 6] = ["case", "ours", "reference", "error", "tolerance", ""];

fn cells(c: &Case) -> [String; 6] {
    let number = |v: f64| {
        let plain = format!("{v:.9}");
        if v != 0.0 && v.abs() < 1e-3 { format!("{v:.8e}") } else { plain }
    };
    let mark = if c.ok { "ok" } else { "FAILED" };
    [
        c.name.clone(),
        number(c.value),
        number(c.reference),
        format!("{:.1e}", c.error),
        format!("{:.1e}", c.tolerance),
        mark.into(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_that_does_not_hold_is_marked_and_fails_the_command() {
        let case =
            Case { name: "x".into(), value: 1.003, reference: 1.0, error: 3e-3, tolerance: 2e-3, ok: false };
        assert_eq!(cells(&case)[5], "FAILED");
        assert_eq!(outcome(1, 117).unwrap_err().exit_code(), 1);
        assert!(outcome(0, 117).is_ok());
    }
}
